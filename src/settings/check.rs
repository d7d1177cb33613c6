//! Settings that are each within their range but do not work together.
//!
//! In: settings, and where they were given. Out: the first contradiction, or
//! warnings. What merely has no effect is only worth a warning if whoever
//! prints asked for it: a profile may well limit what a default asks for.

use super::read::Places;
use super::{Flavour, InfillMode, Settings, Varying};
use crate::units::{Mm, cross_section};

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
    places: &Places,
) -> Result<Vec<String>, Conflict> {
    let mut warnings = Vec::new();
    heights(s, &mut warnings)?;
    widths(s, &mut warnings)?;
    sampling(s, &mut warnings)?;
    something_is_printed(s)?;
    retraction(s, &mut warnings)?;
    temperatures(s, &mut warnings);
    total_flow(s, &mut warnings);
    let given =
        |key: &str| places.get(key).is_some_and(|place| place.is_given());
    for limited in limited_speeds(s) {
        if given(limited.key) {
            warnings.push(format!(
                "{} = {} mm/s takes {:.1} mm³/s of plastic, and \
                 filament.max_flow = {} mm³/s is what the hot end melts: it \
                 is printed at {:.0} mm/s; lower the speed, or raise \
                 filament.max_flow if yours melts more",
                limited.key,
                limited.set,
                limited.flow,
                s.filament.max_flow,
                limited.possible,
            ));
        }
    }
    without_effect(s, &given, &mut warnings);
    Ok(warnings)
}

/// Heaters that are too cold to print, or hotter than the machine bears.
fn temperatures(s: &Settings, warnings: &mut Vec<String>) {
    // Marlin and Klipper alike refuse to extrude below it, unless told.
    const COLD: f64 = 170.0;
    let filament = &s.filament;
    let first = filament.first_layer_nozzle_temperature;
    let above = filament.nozzle_temperature.constant().unwrap_or(first);
    if above < COLD || first < COLD {
        warnings.push(format!(
            "a nozzle at {first} °C (filament.first_layer_nozzle_temperature) \
             or {above} °C (filament.nozzle_temperature) melts hardly any \
             plastic, and most firmware refuses to extrude below {COLD} °C; \
             PLA takes about 210 °C",
        ));
    }
    for (limit_key, limit, heaters) in [
        (
            "printer.max_nozzle_temperature",
            s.printer.max_nozzle_temperature,
            [
                ("filament.first_layer_nozzle_temperature", first),
                ("filament.nozzle_temperature", above),
            ],
        ),
        (
            "printer.max_bed_temperature",
            s.printer.max_bed_temperature,
            [
                (
                    "filament.first_layer_bed_temperature",
                    filament.first_layer_bed_temperature,
                ),
                ("filament.bed_temperature", filament.bed_temperature),
            ],
        ),
    ] {
        for (key, value) in heaters {
            if let Some(limit) = limit
                && value > limit
            {
                warnings.push(format!(
                    "{key} = {value} °C is more than {limit_key} = {limit} \
                     °C: this printer is not made for this filament; take \
                     another, lower the temperature, or raise {limit_key} if \
                     yours was rebuilt",
                ));
            }
        }
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

/// A layer must fit under the nozzle.
fn heights(s: &Settings, warnings: &mut Vec<String>) -> Result<(), Conflict> {
    let nozzle = s.printer.nozzle_diameter;
    for (key, height) in [
        ("layer_height", s.layer_height),
        ("first_layer_height", s.first_layer_height),
    ] {
        if height > nozzle {
            return Err(conflict(
                [key, "printer.nozzle_diameter"],
                format!(
                    "{key} = {height} mm is more than printer.nozzle_diameter \
                     = {nozzle} mm: the bead would not touch what is below; \
                     use at most {} mm",
                    round(0.8 * nozzle),
                ),
            ));
        }
        // Room for rounding: 0.8 × 0.4 is not 0.32 in binary.
        if height > 0.8 * nozzle + 1e-9 {
            warnings.push(format!(
                "{key} = {height} mm is more than 0.8 × \
                 printer.nozzle_diameter = {nozzle} mm: layers will bond \
                 badly; use at most {} mm",
                round(0.8 * nozzle),
            ));
        }
        if height > s.printer.height {
            return Err(conflict(
                [key, "printer.height"],
                format!(
                    "{key} = {height} mm is more than printer.height = {} mm; \
                     nothing can be printed",
                    s.printer.height,
                ),
            ));
        }
    }
    Ok(())
}

/// A line's width is bounded by the nozzle that squeezes it, and a bead with
/// round ends must be wider than high.
fn widths(s: &Settings, warnings: &mut Vec<String>) -> Result<(), Conflict> {
    let nozzle = s.printer.nozzle_diameter;
    for (key, width) in line_widths(s) {
        if !(0.3 * nozzle..=5.0 * nozzle).contains(&width) {
            return Err(conflict(
                [key, "printer.nozzle_diameter"],
                format!(
                    "{key} = {width} mm cannot come out of a nozzle of \
                     printer.nozzle_diameter = {nozzle} mm: {} to {} mm can; \
                     use about {} mm",
                    round(0.3 * nozzle),
                    round(5.0 * nozzle),
                    round(1.1 * nozzle),
                ),
            ));
        }
        if !(0.5 * nozzle..=2.5 * nozzle).contains(&width) {
            warnings.push(format!(
                "{key} = {width} mm is hard to print with a nozzle of \
                 printer.nozzle_diameter = {nozzle} mm: better stay within \
                 {} to {} mm",
                round(0.5 * nozzle),
                round(2.5 * nozzle),
            ));
        }
        for (height_key, height) in [
            ("layer_height", s.layer_height),
            ("first_layer_height", s.first_layer_height),
        ] {
            if width <= height {
                return Err(conflict(
                    [key, height_key],
                    format!(
                        "{key} = {width} mm is not more than {height_key} = \
                         {height} mm, but a bead must be wider than high; \
                         raise {key} or lower {height_key}"
                    ),
                ));
            }
        }
    }
    Ok(())
}

fn line_widths(
    s: &Settings,
) -> impl Iterator<Item = (&'static str, f64)> + use<> {
    let own = [
        ("outer_wall_width", s.outer_wall_width),
        ("inner_wall_width", s.inner_wall_width),
        ("skin_width", s.skin_width),
        ("infill_width", s.infill_width),
    ];
    let auto = [
        ("top_skin_width", s.top_skin_width),
        ("bottom_skin_width", s.bottom_skin_width),
    ];
    let given = auto.into_iter().filter_map(|(key, w)| Some((key, w?)));
    own.into_iter().chain(given)
}

/// The lattice must be coarser than the accuracy asked of its vertices, and
/// should be finer than what is printed.
fn sampling(s: &Settings, warnings: &mut Vec<String>) -> Result<(), Conflict> {
    if s.accuracy >= s.sample_spacing {
        return Err(conflict(
            ["accuracy", "sample_spacing"],
            format!(
                "accuracy = {} mm is not finer than sample_spacing = {} mm, \
                 which outlines are refined from; lower accuracy or raise \
                 sample_spacing",
                s.accuracy, s.sample_spacing,
            ),
        ));
    }
    if s.sample_spacing > s.outer_wall_width {
        warnings.push(format!(
            "sample_spacing = {} mm is coarser than outer_wall_width = {} mm: \
             details that could be printed may be missed; lower it",
            s.sample_spacing, s.outer_wall_width,
        ));
    }
    Ok(())
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

/// What is pulled back must be pushed forward again, and lengths must leave
/// something between never and always.
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

/// What Klipper's `SET_RETRACTION` refuses.
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

/// A speed at which the hot end does not melt fast enough.
struct Limited {
    /// The speed's key.
    key: &'static str,
    /// The speed as set, and as it will be, mm/s.
    set: f64,
    possible: f64,
    /// Plastic that the set speed takes, mm³/s.
    flow: f64,
}

/// What `filament.max_flow` does to the speeds, if anything.
pub(super) fn flow_note(s: &Settings) -> Option<String> {
    let limited: Vec<String> = limited_speeds(s)
        .iter()
        .map(|l| format!("{} from {} to {:.0}", l.key, l.set, l.possible))
        .collect();
    (!limited.is_empty()).then(|| {
        format!(
            "filament.max_flow = {} mm³/s slows {} mm/s",
            s.filament.max_flow,
            limited.join(", "),
        )
    })
}

/// What `printer.max_speed` does to the speeds, if anything.
pub(super) fn speed_note(s: &Settings) -> Option<String> {
    let speed = &s.speed;
    let most = s.printer.max_speed;
    let asked = [
        ("speed.outer_wall", speed.outer_wall.constant()),
        ("speed.inner_wall", speed.inner_wall.constant()),
        ("speed.gap_fill", speed.gap_fill.constant()),
        ("speed.sparse_infill", speed.sparse_infill.constant()),
        ("speed.internal_skin", speed.internal_skin.constant()),
        ("speed.top_skin", speed.top_skin.constant()),
        ("speed.bottom_skin", speed.bottom_skin.constant()),
        ("speed.bridge", speed.bridge.constant()),
        ("speed.overhang", speed.overhang.constant()),
        ("speed.ironing", speed.ironing.constant()),
        ("speed.skirt", Some(speed.skirt)),
        ("speed.travel", Some(speed.travel)),
    ];
    let limited: Vec<String> = asked
        .iter()
        .filter_map(|&(key, asked)| Some((key, asked?)))
        .filter(|&(_, asked)| asked > most)
        .map(|(key, asked)| format!("{key} ({asked})"))
        .collect();
    (!limited.is_empty()).then(|| {
        format!(
            "printer.max_speed = {most} mm/s is less than {}, and is used \
             instead",
            limited.join(", ")
        )
    })
}

/// The speeds that `filament.max_flow` does not allow.
fn limited_speeds(s: &Settings) -> Vec<Limited> {
    let share = |v: &Varying| v.constant().map(|percent| percent / 100.0);
    let (Some(flow), Some(widened)) = (share(&s.flow), share(&s.bead_width))
    else {
        return Vec::new();
    };
    let flow = flow * s.filament.flow / 100.0;
    let most = s.filament.max_flow;
    let limited = |(key, speed, width): (&'static str, &Varying, Mm)| {
        let speed = speed.constant()?;
        let area = flow * cross_section(width * widened, s.layer_height);
        // To the tenth that is shown.
        (speed * area > most + 0.05).then(|| Limited {
            key,
            set: speed,
            possible: most / area,
            flow: speed * area,
        })
    };
    let speed = &s.speed;
    [
        ("speed.outer_wall", &speed.outer_wall, s.outer_wall_width),
        ("speed.inner_wall", &speed.inner_wall, s.inner_wall_width),
        ("speed.sparse_infill", &speed.sparse_infill, s.infill_width),
        ("speed.internal_skin", &speed.internal_skin, s.skin_width),
        ("speed.top_skin", &speed.top_skin, s.top_skin_width()),
        (
            "speed.bottom_skin",
            &speed.bottom_skin,
            s.bottom_skin_width(),
        ),
    ]
    .into_iter()
    .filter_map(limited)
    .collect()
}

/// Settings that were asked for and that others deprive of their effect.
fn without_effect(
    s: &Settings,
    given: &dyn Fn(&str) -> bool,
    warnings: &mut Vec<String>,
) {
    let mut warn = |key: &str, idle: bool, message: String| {
        if idle && given(key) {
            warnings.push(message);
        }
    };
    let speed = &s.speed;
    let fastest = [
        &speed.outer_wall,
        &speed.inner_wall,
        &speed.gap_fill,
        &speed.sparse_infill,
        &speed.internal_skin,
        &speed.top_skin,
        &speed.bottom_skin,
        &Varying::Constant(speed.skirt),
    ]
    .into_iter()
    .map(|speed| speed.constant().unwrap_or(f64::INFINITY))
    .fold(0.0, f64::max);
    warn(
        "speed.first_layer",
        speed.first_layer > fastest,
        format!(
            "speed.first_layer = {} mm/s is more than any printing speed, so \
             it limits nothing: the first layer is printed at up to {fastest} \
             mm/s; lower it, or raise the others",
            speed.first_layer,
        ),
    );
    warn(
        "cooling.min_speed",
        s.cooling.min_speed > fastest && s.cooling.min_layer_time > 0.0,
        format!(
            "cooling.min_speed = {} mm/s is more than any printing speed, so \
             no layer can be slowed down to take cooling.min_layer_time; \
             lower it",
            s.cooling.min_speed,
        ),
    );
    let cooling = &s.cooling;
    warn(
        "cooling.full_fan_layer",
        (1..=cooling.fan_off_layers).contains(&cooling.full_fan_layer),
        format!(
            "cooling.full_fan_layer = {} has no effect, since the fan is off \
             on the first cooling.fan_off_layers = {} layers; set it to a \
             later one",
            cooling.full_fan_layer, cooling.fan_off_layers,
        ),
    );
    warn(
        "cooling.long_layer_time",
        cooling.long_layer_time <= cooling.min_layer_time,
        format!(
            "cooling.long_layer_time = {} s is not more than \
             cooling.min_layer_time = {} s, so there is nothing between short \
             and long layers; raise it",
            cooling.long_layer_time, cooling.min_layer_time,
        ),
    );
    for (key, value) in [
        ("retract.z_hop", s.retract.z_hop),
        ("retract.extra_prime", s.retract.extra_prime),
    ] {
        warn(
            key,
            s.retract.length == 0.0 && value != 0.0,
            format!(
                "{key} = {value} mm has no effect, since retract.length = 0 \
                 turns retraction off; give it a length, 0.8 mm say"
            ),
        );
    }
    warn(
        "gcode.set_limits",
        !s.gcode.set_limits && s.acceleration.by_role(),
        "gcode.set_limits = false keeps the accelerations by role from the \
         printer: they only count for the estimate; set it to true, or the \
         accelerations to 0"
            .to_owned(),
    );
    warn(
        "ironing",
        s.ironing && s.top_layers() == 0,
        "ironing = true has no effect without solid tops; set top_layers or \
         top_thickness to more than 0"
            .to_owned(),
    );
    infill_without_effect(s, &mut warn);
}

/// What is for patterns only, or for expressions only.
fn infill_without_effect(
    s: &Settings,
    warn: &mut dyn FnMut(&str, bool, String),
) {
    warn(
        "infill_mode",
        s.infill_is_pattern() && s.infill_mode != InfillMode::Surface,
        format!(
            "infill_mode = {} has no effect: it says what an expression of \
             infill is, and infill is a pattern; set infill to \"expr: ...\"",
            s.infill_mode.word(),
        ),
    );
    let surface = s.infill_mode == InfillMode::Surface;
    for (key, idle, remedy) in [
        (
            "infill_density",
            true,
            "make its lines lie closer or farther apart",
        ),
        ("infill_angle", surface, "turn x and y in it"),
        ("infill_phase", true, "add to x and y in it"),
        ("infill_centre", true, "add to x and y in it"),
    ] {
        warn(
            key,
            idle && !s.infill_is_pattern(),
            format!(
                "{key} has no effect: it is for patterns, and infill is an \
                 expression of its own; {remedy}, or set infill to a pattern",
            ),
        );
    }
}

/// For messages: three decimals at most.
fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}
