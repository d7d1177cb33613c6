//! Settings that are each within their range but do not work together.
//!
//! In: settings, and where they were given. Out: the first contradiction, or
//! warnings. A setting without effect is worth a warning only if it was given
//! for this print: a profile may limit what a default asks for.

mod beads;
mod heat;
mod idle;
mod speeds;

pub(super) use speeds::{flow_note, speed_note};

use super::error::GivenPlaces;
use super::{Flavour, Settings};
use beads::{heights, sampling, shares, widths};
use heat::temperatures;
use idle::without_effect;
use speeds::too_fast;

/// Settings that cannot be printed with.
#[derive(Debug)]
pub(super) struct Conflict {
    /// What is wrong, with keys, values and the remedy.
    pub(super) message: String,
    /// The keys it is about.
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
    retraction(s, &mut warnings)?;
    temperatures(s)?;
    total_flow(s, &mut warnings);
    share_of_one(s, &mut warnings);
    let given =
        |key: &str| places.get(key).is_some_and(|place| place.is_given());
    too_fast(s, &given, &mut warnings);
    without_effect(s, &given, &mut warnings);
    Ok(warnings)
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

/// Other slicers write 15 % as 0.15.
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

/// Without walls, skin and infill there is nothing to print.
fn something_is_printed(s: &Settings) -> Result<(), Conflict> {
    let solid = s.top_layers() + s.bottom_layers() > 0;
    if s.walls == 0 && !solid && s.is_hollow() {
        return Err(conflict(
            [
                "walls",
                "infill_density",
                "top_layers",
                "top_thickness",
                "bottom_layers",
                "bottom_thickness",
            ],
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
    if s.gcode.flavour == Flavour::Klipper && retract.firmware {
        klipper_retraction(s)?;
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

/// Rounds to 3 decimals, for messages.
fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}
