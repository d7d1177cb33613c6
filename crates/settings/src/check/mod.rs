//! Settings that are each within their range but do not work together.
//!
//! In: settings, and where they were given. Out: the first contradiction, or
//! warnings. A setting without effect is worth a warning only if it was given
//! for this print: a profile may limit what a default asks for.

mod beads;
mod heat;
mod speeds;

pub(super) use speeds::{flow_note, speed_note};

use super::error::{GivenIn, GivenPlaces};
use super::firmware::Retraction;
use super::idle::Reason;
use super::value::round;
use super::{BrimPlace, DraftShield, Flavour, Settings, WallOffset};
use super::{Key, keys};
use beads::{heights, sampling, shares, widths};
use heat::{first_layer, temperatures};
use speeds::too_fast;

/// Settings that cannot be printed with.
#[derive(Debug)]
pub(super) struct Conflict {
    /// What is wrong, with keys, values and the remedy.
    pub(super) message: String,
    /// The keys of these settings.
    pub(super) keys: Vec<&'static str>,
}

fn conflict<const N: usize>(
    keys: [&'static str; N],
    message: String,
) -> Conflict {
    Conflict {
        message,
        keys: keys.to_vec(),
    }
}

/// Checks the combinations; returns warnings about the unwise ones.
pub(super) fn conflicts(
    s: &Settings,
    places: &GivenPlaces,
) -> Result<Vec<String>, Conflict> {
    let mut warnings = Vec::new();
    shares(s)?;
    heights(s, &mut warnings)?;
    widths(s, &mut warnings)?;
    sampling(s, &mut warnings)?;
    something_is_printed(s)?;
    raft(s, &mut warnings)?;
    shield_beside_the_part(s)?;
    beside_a_vase(s)?;
    uneven_growth(s)?;
    retraction(s, &mut warnings)?;
    temperatures(s)?;
    first_layer(s, &mut warnings);
    arcs(s, places, &mut warnings);
    total_flow(s, &mut warnings);
    share_of_one(s, &mut warnings);
    let given =
        |key: &str| places.get(key).is_some_and(|place| place.is_given());
    too_fast(s, &given, &mut warnings);
    without_effect(s, places, &mut warnings);
    Ok(warnings)
}

/// Warns of arcs that a Klipper may not know. Whoever has made sure of it writes them
/// into the printer's profile.
fn arcs(s: &Settings, places: &GivenPlaces, warnings: &mut Vec<String>) {
    let given = places.get("gcode.arcs").is_some_and(|at| at.is_given());
    if s.gcode.arcs && given && s.gcode.flavour == Flavour::Klipper {
        warnings.push(
            "gcode.arcs = true needs [gcode_arcs] in printer.cfg, best with \
             resolution: 0.1; a Klipper without it leaves out every arc, and prints \
             what is between them"
                .to_owned(),
        );
    }
}

fn total_flow(s: &Settings, warnings: &mut Vec<String>) {
    let own = s.flow.constant().unwrap_or(100.0);
    let flow = own * s.filament.flow / 100.0;
    if !(75.0..=125.0).contains(&flow) {
        warnings.push(format!(
            "flow = {}% and filament.flow = {}% make {}% together: parts will \
             come out {}",
            own,
            s.filament.flow,
            round(flow),
            if flow < 100.0 { "weak" } else { "swollen" },
        ));
    }
}

/// Warns of shares below 1 %: other slicers write 15 % as 0.15.
fn share_of_one(s: &Settings, warnings: &mut Vec<String>) {
    if let Some(density) = s.infill_density.constant()
        && density > 0.0
        && density < 1.0
    {
        warnings.push(format!(
            "infill_density = {density}% is next to nothing; write {}% if \
             that was meant as a share of one",
            round(100.0 * density),
        ));
    }
}

/// A compensation that differs from place to place suits neither a climbing
/// wall, which is found on the surface, nor walls that are offsets of the
/// expression.
fn uneven_growth(s: &Settings) -> Result<(), Conflict> {
    if s.xy_compensation.constant().is_some() {
        return Ok(());
    }
    let (key, remedy) = if s.is_vase() {
        ("spiral", "spiral = true")
    } else if s.wall_offset == WallOffset::Field {
        ("wall_offset", "wall_offset = \"field\"")
    } else {
        return Ok(());
    };
    Err(conflict(
        ["xy_compensation", key],
        format!(
            "xy_compensation is an expression, which {remedy} does not take; \
             make it a number, or leave {remedy} out"
        ),
    ))
}

/// Refuses settings without walls, skin and infill: there would be nothing to
/// print.
fn something_is_printed(s: &Settings) -> Result<(), Conflict> {
    let solid = s.top_layers() + s.bottom_layers() > 0;
    if s.walls == 0 && !solid && s.is_hollow() {
        return Err(conflict(
            ["walls", "infill_density", "top_layers", "bottom_layers"],
            "with walls = 0, infill_density = 0% and neither top nor bottom \
             layers nothing is printed; set walls to 1 or more"
                .to_owned(),
        ));
    }
    Ok(())
}

/// Filament that is pulled back must be pushed forward again, and there must be
/// lengths of travels between those that never and those that always retract.
fn retraction(
    s: &Settings,
    warnings: &mut Vec<String>,
) -> Result<(), Conflict> {
    /// What rounding may add to a length of filament, mm.
    const ROUNDED: f64 = 1e-3;
    let retract = &s.retract;
    if retract.length == 0.0 {
        return Ok(());
    }
    if retract.length + retract.extra_prime < 0.0 {
        return Err(conflict(
            ["retract.extra_prime", "retract.length"],
            format!(
                "retract.extra_prime = {} mm takes off more than \
                 retract.length = {} mm: the filament would be pulled back \
                 twice; use at least {} mm",
                retract.extra_prime, retract.length, -retract.length,
            ),
        ));
    }
    if retract.firmware {
        match s.gcode.flavour.firmware().retraction {
            Retraction::Any => {}
            Retraction::Klipper => klipper_retraction(s)?,
            Retraction::None => {
                return Err(conflict(
                    ["retract.firmware", "gcode.flavour", "retract.length"],
                    format!(
                        "retract.firmware = true, and the firmware of \
                         gcode.flavour = {:?} has no retraction of its own \
                         (G10); set retract.firmware to false",
                        s.gcode.flavour.name(),
                    ),
                ));
            }
        }
    }
    if let Some(refuses) = s.gcode.flavour.firmware().refuses {
        // Rounding may add to a length that the file has as a difference.
        let most = refuses.feed - ROUNDED;
        let pushed = retract.length + retract.extra_prime.max(0.0);
        if pushed > most {
            return Err(conflict(
                ["retract.length", "retract.extra_prime", "gcode.flavour"],
                format!(
                    "retract.length = {} mm and retract.extra_prime = {} mm make \
                     {} mm at a time, and Klipper refuses {} mm and more while \
                     the head stands (max_extrude_only_distance); lower \
                     retract.length",
                    retract.length,
                    retract.extra_prime,
                    round(pushed),
                    refuses.feed,
                ),
            ));
        }
    }
    if retract.min_travel > retract.max_unretracted {
        warnings.push(format!(
            "retract.min_travel = {} mm is more than retract.max_unretracted \
             = {} mm: travels of lengths between are to retract always and \
             never; raise max_unretracted or lower min_travel",
            retract.min_travel, retract.max_unretracted,
        ));
    }
    Ok(())
}

/// Refuses what Klipper's `SET_RETRACTION` refuses.
fn klipper_retraction(s: &Settings) -> Result<(), Conflict> {
    /// Least speed of the filament, mm/s.
    const SLOWEST: f64 = 1.0;
    let retract = &s.retract;
    if retract.extra_prime < 0.0 {
        return Err(conflict(
            ["retract.extra_prime", "retract.firmware", "gcode.flavour"],
            format!(
                "retract.extra_prime = {} mm is negative, and Klipper's \
                 firmware retraction refuses to push less than it has pulled \
                 back (UNRETRACT_EXTRA_LENGTH); set retract.firmware = false, \
                 or retract.extra_prime to 0 or more",
                retract.extra_prime,
            ),
        ));
    }
    for (key, speed) in [
        ("retract.speed", retract.speed),
        ("retract.prime_speed", retract.prime_speed),
    ] {
        if speed < SLOWEST {
            return Err(conflict(
                [key, "retract.firmware", "gcode.flavour"],
                format!(
                    "{key} = {speed} mm/s is too slow for Klipper's firmware \
                     retraction, which refuses less than {SLOWEST} mm/s; \
                     raise it, or set retract.firmware = false",
                ),
            ));
        }
    }
    Ok(())
}

/// Refuses what does not go with a raft, and warns of what makes little sense.
fn raft(s: &Settings, warnings: &mut Vec<String>) -> Result<(), Conflict> {
    /// Rounding of lengths, mm.
    const ROUNDED: f64 = 1e-9;
    /// Air that hardly parts anything, mm.
    const THIN_AIR: f64 = 0.05;
    if s.raft.layers == 0 {
        return Ok(());
    }
    if s.is_vase() {
        return Err(conflict(
            ["raft.layers", "spiral"],
            "a climbing wall (spiral) stands on the bed and not on a \
             raft; set raft.layers = 0, or spiral = false"
                .to_owned(),
        ));
    }
    if s.brim.place != BrimPlace::None {
        return Err(conflict(
            ["raft.layers", "brim.place"],
            "a part on a raft does not touch the bed, so it can have no brim; \
             set brim.place = \"none\" and raft.expansion as wide as the brim, \
             or raft.layers = 0"
                .to_owned(),
        ));
    }
    if let Some(gap) = s.raft.gap
        && gap > s.raft_gap_most() + ROUNDED
    {
        return Err(conflict(
            [
                "raft.gap",
                "layer_height",
                "infill_width",
                "printer.nozzle_diameter",
            ],
            format!(
                "raft.gap = {gap} mm is too much: with layer_height = {} mm \
                 the part's first lines would hang in the air above the raft, \
                 instead of being pressed onto it, through a nozzle of \
                 printer.nozzle_diameter = {} mm, in supports of infill_width \
                 = {} mm; at most {} mm fit, so lower it or layer_height, or \
                 leave raft.gap to \"auto\"",
                round(s.layer_height()),
                s.printer.nozzle_diameter,
                round(s.infill_width()),
                // The figure is rounded down, so that it is accepted.
                (s.raft_gap_most() * 1000.0 + 1e-6).floor() / 1000.0,
            ),
        ));
    }
    if s.raft_gap() < THIN_AIR {
        warnings.push(format!(
            "the raft is only {} mm below the part, which will hardly come \
             off: raft.gap and layer_height = {} mm share what a nozzle of \
             printer.nozzle_diameter = {} mm bridges; lower layer_height, or \
             raise raft.gap",
            round(s.raft_gap()),
            round(s.layer_height()),
            s.printer.nozzle_diameter,
        ));
    }
    if s.raft.layers == 1 {
        warnings.push(
            "raft.layers = 1 has sparse lines only, between which the part's \
             underside sags; set it to 2 or more"
                .to_owned(),
        );
    }
    Ok(())
}

/// Refuses a draft shield that would touch the part.
fn shield_beside_the_part(s: &Settings) -> Result<(), Conflict> {
    /// Least distance of a shield from the part, mm: about a line's width.
    const LEAST: isoslice_base::units::Mm = 0.5;
    let near = s.skirt.distance.filter(|distance| *distance < LEAST);
    let shield = s.draft_shield != DraftShield::Off;
    match near.filter(|_| shield) {
        None => Ok(()),
        Some(distance) => Err(conflict(
            ["draft_shield", "skirt.distance"],
            format!(
                "the draft shield would touch the part at a skirt.distance of \
                 {distance} mm; set it to {LEAST} mm or more"
            ),
        )),
    }
}

/// Refuses what cannot stand beside a climbing wall: the nozzle would have to
/// leave the wall in every layer.
fn beside_a_vase(s: &Settings) -> Result<(), Conflict> {
    if !s.is_vase() {
        return Ok(());
    }
    if s.draft_shield != DraftShield::Off {
        return Err(conflict(
            ["draft_shield", "spiral"],
            "a climbing wall (spiral) goes on from turn to turn without \
             a stop, so no draft shield can be printed beside it; set \
             draft_shield = \"off\", or spiral = false"
                .to_owned(),
        ));
    }
    let flat = s.layers_on_bed().max(1);
    let skirt = s.skirt.layers;
    if s.is_uniform() && s.skirt.loops > 0 && skirt > flat {
        return Err(conflict(
            ["skirt.layers", "spiral", "bottom_layers"],
            format!(
                "skirt.layers = {skirt} would stand beside the climbing wall \
                 (spiral), which begins after {flat} flat layers and \
                 goes on without a stop; set skirt.layers to {flat} or less, \
                 or spiral = false"
            ),
        ));
    }
    Ok(())
}

/// Warns of settings that were given and have no effect. A file that has all settings,
/// as `isoslice settings` writes it, asks for nothing where it has the default.
fn without_effect(
    s: &Settings,
    places: &GivenPlaces,
    warnings: &mut Vec<String>,
) {
    let asked = |key: &&Key| match places.get(key.name) {
        Some(GivenIn::Set) => true,
        Some(place) => place.is_given() && key.get(s) != key.default(),
        None => false,
    };
    let told = |key: &'static Key| {
        let value = key.get(s);
        let rest = move |reason: &Reason| reason(s, value.trim_matches('"'));
        let rest = key.idle.iter().filter_map(rest);
        rest.map(|rest| format!("{}{rest}", key.name))
    };
    let asked = keys().iter().filter(asked);
    warnings.extend(asked.flat_map(told));
}
