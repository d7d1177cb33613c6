//! What templates may name.
//!
//! In: the writer's plan and what is known of the print. Out: values for the
//! template engine. Besides [`PLACEHOLDERS`] a template may name every setting:
//! `layer_height`, `filament.diameter`.

use super::plan::WriterPlan;
use super::{Header, Totals};
use isoslice_base::units::{Mm, feed_rate, human_time};
use isoslice_settings::keys;
use minijinja::Value;
use std::collections::BTreeMap;

/// A name that a template may use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placeholder {
    /// The name.
    pub name: &'static str,
    /// The templates that know the name.
    pub scope: Scope,
    value: fn(&Known<'_>) -> Value,
}

/// Which templates know a placeholder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Every template.
    All,
    /// Only `gcode.layer`.
    Layer,
    /// Only `gcode.end`.
    End,
}

/// A layer that begins.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moment {
    /// The layer's number, from 1.
    pub number: usize,
    /// Height of the layer's bottom above the bed, which is the top of the layer
    /// below.
    pub bottom: Mm,
    /// Height of the layer's top above the bed.
    pub z: Mm,
    /// The layer's thickness.
    pub height: Mm,
}

impl Moment {
    /// The first layer, for trying a template.
    pub(super) fn of_trial(plan: &WriterPlan<'_>) -> Self {
        let [height, _] = plan.layer_heights;
        Moment {
            number: 1,
            bottom: 0.0,
            z: height,
            height,
        }
    }
}

/// What the values of placeholders are made of.
pub(super) struct Known<'a> {
    pub plan: &'a WriterPlan<'a>,
    pub header: &'a Header,
    pub moment: Moment,
    pub totals: Totals,
}

// Each row has the templates that know the placeholder, its name, what it
// stands for, and its value.
macro_rules! placeholders {
    ($($scope:ident $name:literal, $description:literal,
       |$k:pat_param| $value:expr;)*) => {
        &[$(Placeholder {
            name: $name,
            scope: Scope::$scope,
            value: |$k| $value,
        }),*]
    };
}

/// How far above the part the head is parked, mm: there is room for a hand
/// below.
const PARK_LIFT: f64 = 10.0;

/// Every placeholder, in the order documentation lists them.
pub(crate) const PLACEHOLDERS: &[Placeholder] = placeholders![
    All "nozzle_temperature", "nozzle temperature, °C",
        |k| {
            // An expression of the temperature holds above the first layer
            // only.
            let (first, above) = k.plan.nozzle_temperatures;
            number(above.unwrap_or(first))
        };
    All "first_layer_nozzle_temperature",
        "nozzle temperature of the first layer, °C",
        |k| number(k.plan.nozzle_temperatures.0);
    All "bed_temperature", "bed temperature, °C",
        |k| number(k.plan.bed_temperatures[1]);
    All "first_layer_bed_temperature", "bed temperature of the first layer, °C",
        |k| number(k.plan.bed_temperatures[0]);
    All "layer_count", "number of layers of the part",
        |k| number(k.header.layer_count as f64);
    All "bed_x", "width of the bed, mm",
        |k| number(k.plan.printer.bed_x);
    All "bed_y", "depth of the bed, mm",
        |k| number(k.plan.printer.bed_y);
    All "height", "greatest height the printer prints, mm",
        |k| number(k.plan.printer.height);
    All "nozzle_diameter", "diameter of the nozzle, mm",
        |k| number(k.plan.printer.nozzle_diameter);
    All "filament_diameter", "diameter of the filament, mm",
        |k| number(k.plan.filament.diameter);
    All "retract_length", "length of a retraction, mm",
        |k| number(k.plan.retract.length);
    All "feed_rate_travel", "travel speed as a feed rate, mm/min",
        |k| number(feed_rate(k.plan.travel_speed).round());
    All "feed_rate_z", "greatest speed of z as a feed rate, mm/min",
        |k| number(feed_rate(k.plan.printer.max_speed_z).round());
    All "part_min_x", "least x of the part, mm",
        |k| length(k.header.part_min.x);
    All "part_min_y", "least y of the part, mm",
        |k| length(k.header.part_min.y);
    All "part_min_z", "least z of the part, mm",
        |k| length(k.header.part_min.z);
    All "part_max_x", "greatest x of the part, mm",
        |k| length(k.header.part_max.x);
    All "part_max_y", "greatest y of the part, mm",
        |k| length(k.header.part_max.y);
    All "part_max_z", "greatest z of the part, mm",
        |k| length(k.header.part_max.z);
    All "park_z", "10 mm above the part, or as high as the printer goes, mm",
        |k| {
            let top = k.header.part_max.z;
            let park = (top + PARK_LIFT).min(k.plan.printer.height);
            length(park.max(top))
        };
    All "model_name", "name of the model, without folder and extension",
        |k| Value::from(one_line(&k.header.model_name));
    Layer "layer", "number of the layer, from 1",
        |k| number(k.moment.number as f64);
    Layer "layer_z", "height of the layer's top above the bed, mm",
        |k| length(k.moment.z);
    Layer "layer_bottom", "height of the layer's bottom above the bed, mm",
        |k| length(k.moment.bottom);
    Layer "layer_thickness", "thickness of this layer, mm",
        |k| length(k.moment.height);
    End "print_time", "estimated time, without heating and homing: 1h 2m 3s",
        |k| Value::from(human_time(k.totals.time));
    End "print_seconds", "estimated time in seconds, without heating and homing",
        |k| number(k.totals.time.round());
    End "filament_length", "filament used, mm",
        |k| length(k.totals.filament_length);
    End "filament_mass", "filament used, g",
        |k| length(k.totals.filament_mass_g);
];

/// The names that a template of a scope may use, with settings by their whole
/// names.
pub(super) fn names(scope: Scope) -> impl Iterator<Item = &'static str> {
    PLACEHOLDERS
        .iter()
        .filter(move |p| p.scope == Scope::All || p.scope == scope)
        .map(|p| p.name)
        .chain(setting_names())
}

/// Names of the settings, without the templates.
fn setting_names() -> impl Iterator<Item = &'static str> {
    const TEMPLATES: [&str; 3] = ["gcode.start", "gcode.end", "gcode.layer"];
    let all = keys().iter().map(|k| k.name);
    all.filter(|name| !TEMPLATES.contains(name))
}

/// The values of all settings, by their names.
pub(super) fn of_settings(plan: &WriterPlan<'_>) -> BTreeMap<String, Value> {
    let mut values = BTreeMap::new();
    let mut groups: BTreeMap<&str, BTreeMap<&str, Value>> = BTreeMap::new();
    let names: Vec<_> = setting_names().collect();
    for key in keys().iter().filter(|k| names.contains(&k.name)) {
        let value = plan
            .number(key)
            .map_or_else(|| from_toml(&plan.value(key)), number);
        match key.name.split_once('.') {
            Some((group, leaf)) => {
                groups.entry(group).or_default().insert(leaf, value);
            }
            None => {
                values.insert(key.name.to_owned(), value);
            }
        }
    }
    for (group, members) in groups {
        values.insert(group.to_owned(), Value::from(members));
    }
    values
}

/// The placeholders that only templates of `scope` know.
pub(super) fn of(
    scope: Scope,
    known: &Known<'_>,
) -> impl Iterator<Item = (String, Value)> {
    PLACEHOLDERS
        .iter()
        .filter(move |p| p.scope == scope)
        .map(move |p| (p.name.to_owned(), (p.value)(known)))
}

/// A value that is written as TOML.
fn from_toml(text: &str) -> Value {
    let table = toml::from_str::<toml::Table>(&format!("v = {text}"));
    match table.ok().and_then(|mut t| t.remove("v")) {
        Some(toml::Value::Boolean(b)) => Value::from(b),
        Some(toml::Value::Integer(i)) => Value::from(i),
        Some(toml::Value::Float(x)) => number(x),
        Some(toml::Value::String(s)) => Value::from(s),
        _ => Value::from(text),
    }
}

/// A value that is an integer if the number is whole: what templates compute
/// from it stays whole.
fn number(x: f64) -> Value {
    // An f64 holds every whole number up to this one.
    const WHOLE: f64 = 9e15;
    if x.fract() == 0.0 && x.abs() < WHOLE {
        Value::from(x as i64)
    } else {
        Value::from(x)
    }
}

/// A length to the micrometre.
fn length(x: Mm) -> Value {
    number((x * 1e3).round() / 1e3)
}

/// `name` without the characters that would end its line or hide in it.
fn one_line(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
