//! The settings that several keys decide together.

use super::Outcome;
use crate::Slicer;
use crate::given::{Given, Value};
use crate::values::{parse, share};

/// Greatest distance of a bed's corner below 0 at which the bed counts as
/// beginning at 0, mm.
const ABOUT_ZERO: f64 = 15.0;
/// Flow that counts as unlimited, mm³/s.
const NO_LIMIT: f64 = 500.0;
/// Length of a wipe if none is given, mm.
const USUAL_WIPE: f64 = 2.0;

pub(super) fn lost(why: impl Into<String>) -> Outcome {
    Outcome::Lost(why.into())
}

pub(super) fn nothing(why: &str) -> Outcome {
    Outcome::Nothing(why.to_owned())
}

/// The value of the first of the keys that has one.
fn first<'a>(given: &'a Given<'_>, keys: &[&str]) -> Option<&'a str> {
    keys.iter().find_map(|key| given.values.first(key))
}

/// The value of the first of the keys that has one, as a whole.
fn text<'a>(given: &'a Given<'_>, keys: &[&str]) -> Option<&'a str> {
    keys.iter().find_map(|key| given.values.text(key))
}

/// The first number among the values of the keys, if it is above 0.
fn positive(given: &Given<'_>, keys: &[&str]) -> Option<f64> {
    number(given, keys).filter(|x| *x > 0.0)
}

/// The first number among the values of the keys.
fn number(given: &Given<'_>, keys: &[&str]) -> Option<f64> {
    keys.iter().find_map(|key| given.number(key))
}

/// The least positive number among the values of the keys.
fn least(given: &Given<'_>, keys: &[&str]) -> Option<f64> {
    let all = keys.iter().filter_map(|key| given.positive(key));
    all.reduce(f64::min)
}

pub(super) fn bed(given: &Given<'_>) -> Outcome {
    let key = if given.values.has("bed_shape") {
        "bed_shape"
    } else {
        "printable_area"
    };
    let mut corners = Vec::new();
    for corner in given.values.list(key) {
        let pair = corner
            .split_once('x')
            .and_then(|(x, y)| Some((parse(x)?, parse(y)?)));
        match pair {
            Some(pair) => corners.push(pair),
            None => {
                return lost(format!("{corner:?} is no corner, as 250x210"));
            }
        }
    }
    let all = |of: fn(&(f64, f64)) -> f64| corners.iter().map(of);
    let least = |of| all(of).fold(f64::INFINITY, f64::min);
    let most = |of| all(of).fold(f64::NEG_INFINITY, f64::max);
    let (x0, y0) = (least(|c| c.0), least(|c| c.1));
    let (x1, y1) = (most(|c| c.0), most(|c| c.1));
    if x0 < -ABOUT_ZERO || y0 < -ABOUT_ZERO {
        return lost(
            "the bed's zero is not at its front left corner, but isoslice's \
             is: G-code of this profile would print in the wrong place. Set \
             the firmware's zero, or shift it in gcode.start (G92)",
        );
    }
    if x1 <= 0.0 || y1 <= 0.0 {
        return lost("the bed has no size");
    }
    Outcome::of(vec![
        ("printer.bed_x", x1.into()),
        ("printer.bed_y", y1.into()),
    ])
}

/// The name by which the firmware of a Prusa printer knows the printer, from the
/// line of the start G-code that checks it.
fn model_checked(given: &Given<'_>) -> Option<String> {
    let start = text(given, &["start_gcode", "machine_start_gcode"])?;
    let line = start.lines().find(|line| {
        let line = line.trim_start();
        line.starts_with("M862.3") && line.contains('"')
    })?;
    let name = line.split('"').nth(1)?.trim_end_matches('\\');
    if name.contains(['[', '{']) {
        return given.values.first("printer_model").map(ToOwned::to_owned);
    }
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '.';
    name.chars().all(plain).then(|| name.to_owned())
}

/// True for Prusa's own printers.
fn is_prusas(given: &Given<'_>) -> bool {
    let model = given.values.first("printer_model").unwrap_or("");
    let start = ["MK2", "MK3", "MK4", "MINI", "XL", "COREONE"];
    start.iter().any(|known| model.starts_with(known))
        || model_checked(given).is_some()
}

/// True for Bambu Lab's own printers.
fn is_bambus(given: &Given<'_>) -> bool {
    let model = given.values.first("printer_model").unwrap_or("");
    model.starts_with("Bambu Lab ")
}

/// What the head needs beside finished parts.
pub(super) fn clearances(given: &Given<'_>) -> Outcome {
    let number = |key: &&str| given.positive(key);
    let radii = ["extruder_clearance_radius", "extruder_clearance_max_radius"];
    let heights = [
        "extruder_clearance_height",
        "extruder_clearance_height_to_rod",
    ];
    let radius = radii.iter().filter_map(number).reduce(f64::max);
    let height = heights.iter().filter_map(number).reduce(f64::min);
    Outcome::known([
        ("printer.head_clearance_radius", radius),
        ("printer.gantry_height", height),
    ])
}

pub(super) fn flavour(given: &Given<'_>) -> Outcome {
    let word = given.values.first("gcode_flavor").unwrap_or("");
    let word = word.to_ascii_lowercase();
    let ours = match word.as_str() {
        "marlin" | "marlin2" | "marlinfirmware" if is_prusas(given) => "prusa",
        "marlin" | "marlin2" | "marlinfirmware" if is_bambus(given) => "bambu",
        "marlin" | "marlin2" | "marlinfirmware" => "marlin",
        "klipper" => "klipper",
        "reprapfirmware" | "rrf" => "rrf",
        // Sprinter is the common ancestor.
        "reprap" => "marlin",
        _ => {
            return lost(format!(
                "isoslice does not write for {word}: choose the nearest of \
                 marlin, klipper, rrf, prusa and bambu"
            ));
        }
    };
    Outcome::set("gcode.flavour", ours)
}

pub(super) fn model(given: &Given<'_>) -> Outcome {
    if let Some(name) = model_checked(given).filter(|_| is_prusas(given)) {
        return Outcome::set("printer.model", name);
    }
    if let Some(name) = given.values.first("printer_model")
        && is_bambus(given)
    {
        return Outcome::set("printer.model", name);
    }
    nothing("the printer checks no model")
}

/// Lines of a template without marks that isoslice writes itself.
fn without_marks(text: &str) -> String {
    let keep = |line: &&str| {
        let code = line.split(';').next().unwrap_or("").trim();
        let reset = matches!(code, "G92 E0" | "G92 E0.0");
        !code.is_empty() && !reset
    };
    text.lines().filter(keep).collect::<Vec<_>>().join("\n")
}

pub(super) fn layer(given: &Given<'_>) -> Outcome {
    let keys = [
        "before_layer_gcode",
        "before_layer_change_gcode",
        "layer_gcode",
        "layer_change_gcode",
    ];
    let texts = keys.iter().filter_map(|key| given.values.text(key));
    let texts: Vec<String> =
        texts.map(without_marks).filter(|t| !t.is_empty()).collect();
    if texts.is_empty() {
        return nothing("isoslice writes such marks itself");
    }
    Outcome::set("gcode.layer", texts.join("\n"))
}

pub(super) fn accelerations(given: &Given<'_>) -> Outcome {
    let axes = ["machine_max_acceleration_x", "machine_max_acceleration_y"];
    let axes = least(given, &axes);
    let printing = given.positive("machine_max_acceleration_extruding");
    let travel = given.positive("machine_max_acceleration_travel");
    let limit = |of: Option<f64>| of.into_iter().chain(axes).reduce(f64::min);
    Outcome::known([
        ("printer.acceleration", limit(printing)),
        ("printer.travel_acceleration", limit(travel.or(printing))),
    ])
}

pub(super) fn max_speed(given: &Given<'_>) -> Outcome {
    let keys = [
        "machine_max_feedrate_x",
        "machine_max_feedrate_y",
        "machine_max_speed_x",
        "machine_max_speed_y",
    ];
    let speed = least(given, &keys).map(|v| ("printer.max_speed", v.into()));
    Outcome::of(speed.into_iter().collect())
}

pub(super) fn corner(given: &Given<'_>) -> Outcome {
    let jerk = least(given, &["machine_max_jerk_x", "machine_max_jerk_y"]);
    let deviation = given.positive("machine_max_junction_deviation");
    let acceleration = given.positive("machine_max_acceleration_extruding");
    let speed = match (deviation, acceleration) {
        // Marlin has v² = a J sin(θ/2) / (1 − sin(θ/2)), where θ is a right
        // angle.
        (Some(deviation), Some(a)) => {
            let half = std::f64::consts::FRAC_1_SQRT_2;
            let v = (a * deviation * half / (1.0 - half)).sqrt();
            Some((v * 10.0).round() / 10.0)
        }
        _ => jerk,
    };
    Outcome::known([("printer.square_corner_velocity", speed)])
}

pub(super) fn thumbnails(given: &Given<'_>) -> Outcome {
    let key = if given.values.has("thumbnails") {
        "thumbnails"
    } else {
        "thumbnail_size"
    };
    let usual = given.values.first("thumbnails_format").unwrap_or("PNG");
    let usual = usual.to_ascii_uppercase();
    let mut sizes = Vec::new();
    let mut left = Vec::new();
    for item in given.values.list(key) {
        let (size, format) = match item.split_once('/') {
            Some((size, format)) => (size, format.to_ascii_uppercase()),
            None => (item, usual.clone()),
        };
        let pixels = size.split_once('x').and_then(|(x, y)| {
            Some((x.trim().parse::<u32>().ok()?, y.trim().parse::<u32>().ok()?))
        });
        let Some((x, y)) = pixels.filter(|(x, y)| *x > 0 && *y > 0) else {
            continue;
        };
        match format.as_str() {
            "PNG" => sizes.push(format!("{x}x{y}")),
            "QOI" | "JPG" => sizes.push(format!("{x}x{y}/{format}")),
            _ => left.push(format),
        }
    }
    if sizes.is_empty() {
        return match left.first() {
            Some(format) => lost(format!(
                "isoslice makes pictures as PNG, QOI and JPG, not as {format}"
            )),
            None => nothing("there are no pictures"),
        };
    }
    Outcome::set("gcode.thumbnails", sizes.join(", "))
}

/// The speeds of a retraction. `of` is what the keys begin with, nothing for those
/// of the printer.
pub(super) fn retract_speeds(given: &Given<'_>, of: &str) -> Outcome {
    let speed = |keys: &[&str]| {
        let mut all = keys.iter().map(|key| format!("{of}{key}"));
        all.find_map(|key| given.number(&key)).filter(|x| *x > 0.0)
    };
    let back = speed(&["retract_speed", "retraction_speed"]);
    let forward =
        speed(&["deretract_speed", "deretraction_speed", "detraction_speed"]);
    Outcome::known([
        ("retract.speed", back),
        ("retract.prime_speed", forward.or(back)),
    ])
}

/// How far the nozzle is lifted. The keys begin as in [`retract_speeds`].
pub(super) fn z_hop(given: &Given<'_>, of: &str) -> Outcome {
    let lift = |key| given.number(&format!("{of}{key}"));
    let ramps = given.on(&format!("{of}travel_ramping_lift"));
    let ramped = lift("travel_max_lift").filter(|l| ramps && *l > 0.0);
    let lift = ramped.or(lift("retract_lift")).or(lift("z_hop"));
    Outcome::known([("retract.z_hop", lift)])
}

/// How far the nozzle wipes. The keys begin as in [`retract_speeds`].
pub(super) fn wipe(given: &Given<'_>, of: &str) -> Outcome {
    let length = given.number(&format!("{of}wipe_distance"));
    match given.switch(&format!("{of}wipe")) {
        Some(true) => {
            Outcome::set("retract.wipe", length.unwrap_or(USUAL_WIPE))
        }
        Some(false) => Outcome::set("retract.wipe", 0.0),
        None => nothing("whether to wipe is not said"),
    }
}

pub(super) fn max_flow(given: &Given<'_>) -> Outcome {
    let Some(flow) = given.number("filament_max_volumetric_speed") else {
        return nothing("it has no value");
    };
    let flow = if flow > 0.0 { flow } else { NO_LIMIT };
    Outcome::set("filament.max_flow", flow)
}

pub(super) fn nozzle_temperatures(given: &Given<'_>) -> Outcome {
    let above = positive(given, &["temperature", "nozzle_temperature"]);
    let keys = [
        "first_layer_temperature",
        "nozzle_temperature_initial_layer",
        "nozzle_temperature_intial_layer",
    ];
    let first = positive(given, &keys);
    let found = [
        ("filament.nozzle_temperature", above.or(first)),
        ("filament.first_layer_nozzle_temperature", first.or(above)),
    ];
    let odd = keys.iter().find(|key| {
        given.values.first(key).is_some() && given.number(key).is_none()
    });
    let known = Outcome::known(found);
    match (odd, known) {
        (Some(key), Outcome::Set(settings)) => Outcome::Alike(
            settings,
            format!(
                "{} is not a number, so that of the other layers is taken: write \
                 it yourself",
                given.values.shown(key)
            ),
        ),
        (_, known) => known,
    }
}

/// The plates of OrcaSlicer: names in its lists, and the keys of their
/// temperatures. The hot plate comes first, since most printers have a smooth
/// or textured sheet that uses its temperatures.
const PLATES: [(&str, &str); 7] = [
    ("high temp plate", "hot_plate_temp"),
    ("textured pei plate", "textured_plate_temp"),
    ("cool plate", "cool_plate_temp"),
    ("engineering plate", "eng_plate_temp"),
    ("supertack plate", "supertack_plate_temp"),
    ("textured cool plate", "textured_cool_plate_temp"),
    ("epoxy resin plate", "epoxy_resin_plate_temp"),
];

pub(super) fn bed_temperatures(given: &Given<'_>) -> Outcome {
    let both = |above: Option<f64>, first: Option<f64>| {
        Outcome::known([
            ("filament.bed_temperature", above.or(first)),
            ("filament.first_layer_bed_temperature", first.or(above)),
        ])
    };
    if given.slicer == Slicer::Prusa {
        return both(
            given.number("bed_temperature"),
            given.number("first_layer_bed_temperature"),
        );
    }
    let named =
        first(given, &["curr_bed_type", "default_bed_type", "bed_type"]);
    let named = named.map(str::to_lowercase).and_then(|name| {
        // Some profiles give a number instead, which does not tell the plate.
        let by_name = PLATES.iter().find(|(plate, _)| *plate == name);
        by_name.map(|(_, key)| *key)
    });
    let first_of = |key: &str| given.positive(&format!("{key}_initial_layer"));
    let usable =
        |key: &&str| given.positive(key).is_some() || first_of(key).is_some();
    let keys = named.into_iter().chain(PLATES.iter().map(|(_, key)| *key));
    let keys: Vec<&str> = keys.filter(usable).collect();
    let Some(key) = keys.first() else {
        // No plate has to be heated.
        return both(Some(0.0), Some(0.0));
    };
    both(given.number(key), first_of(key))
}

pub(super) fn advance(given: &Given<'_>) -> Outcome {
    match (
        given.switch("enable_pressure_advance"),
        given.number("pressure_advance"),
    ) {
        (Some(true), Some(k)) => Outcome::set("filament.pressure_advance", k),
        _ => nothing("it is off: the printer keeps its own"),
    }
}

/// The pressure advance that a line of G-code sets.
fn advance_of(line: &str) -> Option<f64> {
    let mut words = line.split_whitespace();
    let letter = match words.next()? {
        "M900" => "K",
        "M572" => "S",
        "SET_PRESSURE_ADVANCE" => "ADVANCE=",
        _ => return None,
    };
    words.find_map(|word| parse(word.strip_prefix(letter)?))
}

/// The commands of a template, without comments.
fn commands(text: &str) -> Vec<&str> {
    let code = text
        .lines()
        .map(|line| line.split(';').next().unwrap_or(""));
    code.map(str::trim)
        .filter(|line| !line.is_empty())
        .collect()
}

pub(super) fn filament_start(given: &Given<'_>) -> Outcome {
    let keys = ["start_filament_gcode", "filament_start_gcode"];
    match commands(text(given, &keys).unwrap_or("")).as_slice() {
        [] => nothing("it has no commands"),
        [only] if let Some(k) = advance_of(only) => {
            Outcome::set("filament.pressure_advance", k)
        }
        _ => lost(
            "isoslice has one start template, the printer's: add to gcode.start \
             what it does beyond filament.pressure_advance",
        ),
    }
}

pub(super) fn filament_end(given: &Given<'_>) -> Outcome {
    let keys = ["filament_end_gcode", "end_filament_gcode"];
    match commands(text(given, &keys).unwrap_or("")).as_slice() {
        [] => nothing("it has no commands"),
        _ => lost(
            "isoslice has one end template, the printer's: add to gcode.end \
             what it does",
        ),
    }
}

/// The fan's speed in long layers.
fn layers_fan(given: &Given<'_>) -> Option<f64> {
    let least = number(given, &["min_fan_speed", "fan_min_speed"])?;
    // In PrusaSlicer the fan of long layers may be off. In OrcaSlicer the
    // switch has its name from the fan's stops and starts.
    let always =
        !given.off("fan_always_on") && !given.off("reduce_fan_stop_start_freq");
    Some(if always { least } else { 0.0 })
}

pub(super) fn fan(given: &Given<'_>) -> Outcome {
    let most = number(given, &["max_fan_speed", "fan_max_speed"]);
    let time =
        number(given, &["fan_below_layer_time", "fan_cooling_layer_time"]);
    // Without automatic cooling the fan of short layers is that of other
    // layers.
    let most = most.filter(|_| !given.off("cooling"));
    Outcome::known([
        ("cooling.fan_speed", layers_fan(given)),
        ("cooling.short_layer_fan_speed", most),
        ("cooling.long_layer_time", time),
    ])
}

/// The fan of bridges and overhangs. Internal bridges have the fan of bridges,
/// unless the profile gives them one of their own, in a later row.
pub(super) fn overhang_fan(given: &Given<'_>) -> Outcome {
    let percent = |key: &str| given.number(key).filter(|v| *v >= 0.0);
    if given.slicer == Slicer::Prusa {
        let bridge = percent("bridge_fan_speed");
        // The keys' names tell how many quarters of a line lie on the layer below.
        let step = |quarters: usize| {
            let key = format!("overhang_fan_speed_{}", 4 - quarters);
            Some(format!("{}: {}", 25 * quarters, percent(&key)?.min(100.0)))
        };
        let steps: Vec<String> = (1..=4).filter_map(step).collect();
        let on = given.on("enable_dynamic_fan_speeds") && !steps.is_empty();
        // Without steps overhanging walls are printed like bridges.
        let bridge = bridge.map(Value::from);
        let overhang = on.then(|| steps.join(", ").into());
        return Outcome::known([
            ("cooling.bridge_fan_speed", bridge.clone()),
            ("cooling.internal_bridge_fan_speed", bridge.clone()),
            ("cooling.overhang_fan_speed", overhang.or(bridge)),
        ]);
    }
    let speed = if given.off("enable_overhang_bridge_fan") {
        layers_fan(given)
    } else {
        percent("overhang_fan_speed")
    };
    Outcome::known([
        ("cooling.bridge_fan_speed", speed),
        ("cooling.overhang_fan_speed", speed),
        ("cooling.internal_bridge_fan_speed", speed),
    ])
}

/// The fan's speed at one kind of beads; less than 0 leaves it.
pub(super) fn fan_unless_negative(
    given: &Given<'_>,
    keys: &[&str],
    name: &'static str,
) -> Outcome {
    let speed = number(given, keys).filter(|v| *v >= 0.0);
    Outcome::known([(name, speed)])
}

/// The flows of supports, which OrcaSlicer uses only if flows are set one by
/// one.
pub(super) fn support_flow(given: &Given<'_>) -> Outcome {
    let one_by_one = given.on("set_other_flow_ratios");
    let flow = |key| Some(100.0 * given.number(key).filter(|_| one_by_one)?);
    Outcome::known([
        ("support.flow", flow("support_flow_ratio")),
        (
            "support.interface_flow",
            flow("support_interface_flow_ratio"),
        ),
    ])
}

pub(super) fn min_layer_time(given: &Given<'_>) -> Outcome {
    let keys = ["slowdown_below_layer_time", "slow_down_layer_time"];
    if given.off("slow_down_for_layer_cooling") || given.off("cooling") {
        return Outcome::set("cooling.min_layer_time", 0.0);
    }
    let time = number(given, &keys);
    Outcome::known([("cooling.min_layer_time", time)])
}

/// The width of lines of one kind, or of all lines; none if the slicer chooses.
fn width(given: &Given<'_>, own: &[&str]) -> Result<Option<Value>, String> {
    for key in own.iter().chain(&["extrusion_width", "line_width"]) {
        let Some(text) = given.values.first(key) else {
            continue;
        };
        if let Some(percent) = share(text)
            && given.slicer != Slicer::Prusa
        {
            if percent > 0.0 {
                return Ok(Some(text.into()));
            }
            continue;
        }
        if let Some(width) = given.amount(key)?.filter(|w| *w > 0.0) {
            return Ok(Some(width.into()));
        }
    }
    Ok(None)
}

pub(super) fn widths(given: &Given<'_>) -> Outcome {
    // Each with the beginnings of PrusaSlicer's and of OrcaSlicer's keys.
    let all = [
        ("outer_wall_width", "external_perimeter", "outer_wall"),
        ("inner_wall_width", "perimeter", "inner_wall"),
        ("infill_width", "infill", "sparse_infill"),
        ("skin_width", "solid_infill", "internal_solid_infill"),
        ("top_skin_width", "top_infill", "top_surface"),
    ];
    let mut out = Vec::new();
    for (name, prusa, orca) in all {
        let prusa = format!("{prusa}_extrusion_width");
        let orca = format!("{orca}_line_width");
        match width(given, &[&prusa, &orca]) {
            Ok(Some(value)) => out.push((name, value)),
            Ok(None) => {}
            Err(why) => return lost(why),
        }
    }
    Outcome::of(out)
}

/// A number of solid layers, or their thickness.
pub(super) fn shell(
    given: &Given<'_>,
    layers: &[&str],
    thickness: &[&str],
    name: &'static str,
) -> Outcome {
    let thick = |t: f64| Outcome::set(name, format!("{t} mm"));
    let layers = number(given, layers);
    let thickness = positive(given, thickness);
    let height = given.positive("layer_height");
    match (layers, thickness) {
        (Some(0.0), _) => Outcome::set(name, 0.0),
        (Some(n), Some(t)) if height.is_none_or(|h| n * h < t - 1e-9) => {
            // Without a number of layers the profile is for layers of many
            // heights, for which the thickness counts.
            thick(t)
        }
        (Some(n), _) => Outcome::set(name, n),
        (None, Some(t)) => thick(t),
        (None, None) => nothing("it leaves the choice to the slicer"),
    }
}

pub(super) fn angle(given: &Given<'_>) -> Outcome {
    let Some(angle) = number(given, &["fill_angle", "infill_direction"]) else {
        return nothing("it has no value");
    };
    Outcome::of(vec![
        ("infill_angle", angle.into()),
        ("skin_angle", angle.into()),
    ])
}

pub(super) fn overlap(given: &Given<'_>) -> Outcome {
    let keys = ["infill_overlap", "infill_wall_overlap"];
    let Some(key) = given.first_of(&keys) else {
        return nothing("it has no value");
    };
    let text = given.values.first(key).unwrap_or("");
    let percent = match (share(text), parse(text)) {
        (Some(percent), _) => percent,
        // OrcaSlicer's value is always a share.
        (None, Some(x)) if given.slicer == Slicer::Orca => x,
        (None, Some(length)) => {
            let keys = ["infill_extrusion_width", "extrusion_width"];
            let width = given.first_of(&keys);
            let width = width.and_then(|key| given.amount(key).ok().flatten());
            match width.filter(|w| *w > 0.0) {
                Some(width) => 100.0 * length / width,
                None => {
                    return lost(
                        "it is a length, and the profile does not say how \
                         wide the infill's lines are",
                    );
                }
            }
        }
        (None, None) => return lost(format!("{text} is not a number")),
    };
    Outcome::set("infill_overlap", percent.clamp(0.0, 100.0))
}

/// A length, and a second number behind a word.
fn pair(length: f64, word: &str, second: f64, unit: &str) -> Value {
    let round = |x: f64| (x * 1e6).round() / 1e6;
    let (length, second) = (round(length), round(second));
    format!("{length} mm {word} {second}{unit}").into()
}

pub(super) fn elephant_foot(given: &Given<'_>) -> Outcome {
    let Some(drawn) = given.number("elefant_foot_compensation") else {
        return nothing("it leaves the choice to the slicer");
    };
    let layers = given.positive("elefant_foot_compensation_layers");
    let value = match layers.filter(|n| *n > 1.0) {
        Some(layers) => pair(drawn, "over", layers, " layers"),
        None => drawn.into(),
    };
    Outcome::set("elephant_foot", value)
}

pub(super) fn scarf(given: &Given<'_>) -> Outcome {
    let on = first(given, &["seam_slope_type", "scarf_seam_placement"])
        .is_some_and(|word| !matches!(word, "none" | "nowhere"));
    // OrcaSlicer's own, if the profile has none.
    const USUAL: f64 = 20.0;
    let length = number(given, &["seam_slope_min_length", "scarf_seam_length"])
        .or_else(|| given.values.has("seam_slope_type").then_some(USUAL));
    let Some(length) = length.filter(|l| on && *l > 0.0) else {
        return nothing("seams have no slope");
    };
    let keys = ["seam_slope_start_height", "scarf_seam_start_height"];
    let percent = first(given, &keys).and_then(|text| {
        let height = given.positive("layer_height");
        let of_height = || Some(100.0 * parse(text)? / height?);
        share(text).or_else(of_height)
    });
    // Scarfs of other slicers rise. If a profile does not say from where, they
    // begin at 10 % of the layer's height, as low as isoslice advises.
    const BEGINNING: f64 = 10.0;
    let start = percent.map_or(BEGINNING, |p| p.clamp(0.0, 90.0));
    Outcome::of(vec![("seam_scarf", pair(length, "from", start, "%"))])
}

pub(super) fn wall_order(given: &Given<'_>) -> Outcome {
    let outer = if let Some(first) = given.switch("external_perimeters_first") {
        first
    } else {
        let keys = ["wall_sequence", "wall_infill_order"];
        let Some(word) = first(given, &keys) else {
            return nothing("it has no value");
        };
        let word = word.to_ascii_lowercase();
        if word.matches("inner").count() > 1 {
            return lost(
                "walls are laid from one side to the other: set wall_order",
            );
        }
        let place = |name: &str| word.find(name);
        match (place("outer"), place("inner")) {
            (Some(outer), Some(inner)) => outer < inner,
            _ => return lost(format!("{word:?} is not understood")),
        }
    };
    let order = if outer { "outer-first" } else { "inner-first" };
    Outcome::set("wall_order", order)
}

const IRONING_FLOW: [&str; 2] = ["ironing_flowrate", "ironing_flow"];

/// Whether tops are ironed, or with how much material.
pub(super) fn ironed(given: &Given<'_>, on: bool, flow: &[&str]) -> Value {
    /// Least flow that isoslice takes, %.
    const LEAST: f64 = 0.1;
    let mut percent = flow.iter().filter_map(|key| {
        let text = given.values.first(key)?;
        share(text).or_else(|| parse(text))
    });
    match percent.next().filter(|_| on) {
        Some(percent) => percent.max(LEAST).into(),
        None => on.into(),
    }
}

pub(super) fn ironing(given: &Given<'_>) -> Outcome {
    let word = given.values.first("ironing_type");
    let on = match given.switch("ironing") {
        Some(on) => on,
        // In PrusaSlicer the type only says which tops would be ironed.
        None if given.slicer == Slicer::Prusa => {
            return nothing("whether to iron is not said");
        }
        None => word.is_some_and(|word| word != "no ironing"),
    };
    let value = vec![("ironing", ironed(given, on, &IRONING_FLOW))];
    match word {
        Some("topmost" | "solid") if on => {
            let why = "isoslice irons every top, and nothing else";
            Outcome::Alike(value, why.to_owned())
        }
        _ => Outcome::Set(value),
    }
}

/// Two settings of one value.
pub(super) fn same_for(
    given: &Given<'_>,
    keys: &[&str],
    names: [&'static str; 2],
) -> Outcome {
    let Some(key) = given.first_of(keys) else {
        return nothing("it has no value");
    };
    match given.amount(key) {
        Ok(Some(x)) if x > 0.0 => {
            Outcome::of(names.map(|name| (name, x.into())).to_vec())
        }
        Ok(_) => nothing("it leaves the choice to the slicer"),
        Err(why) => Outcome::Lost(why),
    }
}

pub(super) fn small_length(given: &Given<'_>) -> Outcome {
    let radius = given.number("small_perimeter_threshold");
    let length = radius.map(|r| {
        let length = r * std::f64::consts::TAU;
        (length * 100.0).round() / 100.0
    });
    let length = length.or(given.number("small_perimeter_max_length"));
    match length.filter(|l| *l >= 0.0) {
        Some(l) => Outcome::set("speed.small_wall_length", l),
        None => nothing("it leaves the choice to the slicer"),
    }
}

pub(super) fn overhang_speed(given: &Given<'_>) -> Outcome {
    let prusa = given.slicer == Slicer::Prusa;
    // The speeds of PrusaSlicer count only if they are switched on.
    let on = if prusa {
        given.on("enable_dynamic_overhang_speeds")
    } else {
        !given.off("enable_overhang_speed")
    };
    if !on {
        return nothing("overhangs have no speed of their own");
    }
    let mut steps = Vec::new();
    for quarters in 1..=4 {
        // PrusaSlicer's keys tell how much of a line lies on the layer below.
        let key = if prusa {
            format!("overhang_speed_{}", 4 - quarters)
        } else {
            format!("overhang_{quarters}_4_speed")
        };
        let Some(text) = given.values.first(&key) else {
            continue;
        };
        let speed = match (parse(text), share(text)) {
            // This is the speed of the wall itself.
            (Some(0.0), _) | (_, Some(0.0)) => "100%".to_owned(),
            (Some(v), _) => v.to_string(),
            (None, Some(percent)) => format!("{}%", percent.clamp(1.0, 100.0)),
            (None, None) => return lost(format!("{text} is not a speed")),
        };
        steps.push(format!("{}: {speed}", 25 * quarters));
    }
    if steps.is_empty() {
        return nothing("it leaves the choice to the slicer");
    }
    Outcome::set("speed.overhang", steps.join(", "))
}

pub(super) fn raft(given: &Given<'_>) -> Outcome {
    let Some(layers) = given.positive("raft_layers") else {
        return nothing("there is no raft");
    };
    Outcome::known([
        ("raft.layers", Some(layers)),
        ("raft.gap", given.number("raft_contact_distance")),
        ("raft.expansion", given.number("raft_expansion")),
    ])
}

pub(super) fn draft_shield(given: &Given<'_>) -> Outcome {
    match given.values.first("draft_shield") {
        Some("1" | "enabled") => {}
        Some("limited") => return nothing("skirt.layers says how high it is"),
        _ => return nothing("there is no draft shield"),
    }
    let mut out = vec![("draft_shield", "full".into())];
    // Nearer it would touch the part, and isoslice refuses it.
    if given.number("skirt_distance").is_some_and(|d: f64| d < 0.5) {
        out.push(("skirt.distance", 0.5.into()));
    }
    Outcome::of(out)
}

pub(super) fn brim(given: &Given<'_>) -> Outcome {
    let width = given.number("brim_width").unwrap_or(0.0);
    let word = given.values.first("brim_type").unwrap_or("outer_only");
    let none = || Outcome::set("brim.place", "none");
    if given.positive("raft_layers").is_some() {
        return none();
    }
    let place = match word {
        "auto_brim" | "painted" => {
            return lost(format!(
                "isoslice has no brim that is {}: set brim.place where a part \
                 may tip",
                if word == "painted" { word } else { "automatic" }
            ));
        }
        "no_brim" => return none(),
        _ if width <= 0.0 => return none(),
        "brim_ears" => "ears",
        _ if given.on("brim_ears") => "ears",
        "inner_only" => "inner",
        "outer_and_inner" => "both",
        _ => "outer",
    };
    let mut out =
        vec![("brim.place", place.into()), ("brim.width", width.into())];
    if place == "ears"
        && let Some(angle) = given.number("brim_ears_max_angle")
    {
        out.push(("brim.ear_angle", angle.into()));
    }
    Outcome::of(out)
}

pub(super) fn supports(given: &Given<'_>) -> Outcome {
    let by_hand = given.off("support_material_auto")
        || given
            .values
            .first("support_type")
            .is_some_and(|word| word.contains("manual"));
    let on = given.on("support_material") || given.on("enable_support");
    let plate = given.on("support_material_buildplate_only")
        || given.on("support_on_build_plate_only");
    let said = given.values.has("support_material")
        || given.values.has("enable_support");
    if !said {
        return nothing("whether to print supports is not said");
    }
    if on && by_hand {
        let why = "its supports stand only where they are painted or enforced, \
                   which isoslice does not read; set supports = \"auto\", and \
                   support.where for the places";
        return Outcome::Alike(
            vec![("supports", "off".into())],
            why.to_owned(),
        );
    }
    supported(on, plate)
}

/// Supports, if there are some, on the bed only or anywhere.
pub(super) fn supported(on: bool, plate_only: bool) -> Outcome {
    let word = match (on, plate_only) {
        (false, _) => "off",
        (true, true) => "plate",
        (true, false) => "auto",
    };
    Outcome::set("supports", word)
}

pub(super) fn support_angle(given: &Given<'_>) -> Outcome {
    let keys = ["support_material_threshold", "support_threshold_angle"];
    match number(given, &keys) {
        Some(angle) if angle > 0.0 && angle <= 90.0 => {
            Outcome::set("support.angle", 90.0 - angle)
        }
        _ => nothing("it leaves the choice to the slicer"),
    }
}

/// OrcaSlicer advises a very large length to those who want no bridge
/// supported, and 0 to those who want all of them supported.
pub(super) fn bridge_max(given: &Given<'_>) -> Outcome {
    /// What the setting takes, mm.
    const SHORTEST: f64 = 0.1;
    const LONGEST: f64 = 1000.0;
    match number(given, &["max_bridge_length"]) {
        Some(length) if length >= 0.0 => {
            Outcome::set("bridge_max", length.clamp(SHORTEST, LONGEST))
        }
        _ => nothing("no length is given"),
    }
}

pub(super) fn support_density(given: &Given<'_>) -> Outcome {
    let keys = [
        "support_material_extrusion_width",
        "support_line_width",
        "extrusion_width",
        "line_width",
        "nozzle_diameter",
    ];
    let above_zero = |key: &&str| {
        let amount = given.amount(key);
        amount.map(|w| w.filter(|w| *w > 0.0)).transpose()
    };
    let width = match keys.iter().find_map(above_zero).transpose() {
        Ok(width) => width,
        Err(why) => return lost(why),
    };
    let mut out = Vec::new();
    let both: [(_, [&str; 2]); 2] = [
        (
            "support.density",
            ["support_material_spacing", "support_base_pattern_spacing"],
        ),
        (
            "support.interface_density",
            [
                "support_material_interface_spacing",
                "support_interface_spacing",
            ],
        ),
    ];
    for (name, keys) in both {
        let Some(gap) = number(given, &keys).filter(|g| *g >= 0.0) else {
            continue;
        };
        let Some(width) = width else {
            return lost(
                "it is a distance of lines, and the profile does not say how \
                 wide they are",
            );
        };
        let percent = 100.0 * width / (width + gap);
        out.push((name, ((percent * 10.0).round() / 10.0).into()));
    }
    Outcome::of(out)
}

/// The greatest length of a travel in isoslice, mm: no bound.
pub(super) const ANY_LENGTH: f64 = 10_000.0;

pub(super) fn hidden_travels(given: &Given<'_>) -> Outcome {
    let keys = [
        "only_retract_when_crossing_perimeters",
        "reduce_infill_retraction",
    ];
    let hidden = given.first_of(&keys).and_then(|key| given.switch(key));
    let Some(hidden) = hidden else {
        return lost("it is neither 0 nor 1");
    };
    let most = hidden.then(|| Value::from(ANY_LENGTH));
    Outcome::known([
        ("retract.when_crossing", Some(hidden.into())),
        ("retract.max_unretracted", most),
    ])
}

pub(super) fn fuzzy(given: &Given<'_>) -> Outcome {
    let word = given.values.first("fuzzy_skin").unwrap_or("none");
    if matches!(word, "none" | "disabled_fuzzy" | "0") {
        return nothing("walls are smooth");
    }
    let thickness = given.positive("fuzzy_skin_thickness");
    let grain = ["fuzzy_skin_point_dist", "fuzzy_skin_point_distance"];
    let grain = positive(given, &grain);
    let holes = matches!(word, "all" | "allwalls" | "hole");
    Outcome::known([
        ("fuzzy.thickness", thickness.map(Value::from)),
        ("fuzzy.grain", grain.map(Value::from)),
        ("fuzzy.holes", Some(holes.into())),
    ])
}
