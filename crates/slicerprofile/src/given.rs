//! What a profile gives, as conversions read it: numbers, switches, and shares
//! of other values.

use crate::Slicer;
use crate::values::{Values, parse, share};

/// The value of a setting.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, in the setting's unit.
    Number(f64),
    /// Yes or no.
    Switch(bool),
    /// A word, a share of the nozzle such as `110%`, or G-code.
    Text(String),
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        // Binary arithmetic leaves digits that nobody has written, such as the
        // last ones of 0.30000000000000004.
        Value::Number((x * 1e6).round() / 1e6)
    }
}

impl From<bool> for Value {
    fn from(yes: bool) -> Self {
        Value::Switch(yes)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Value::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Value::Text(text)
    }
}

/// A profile's values, as conversions read them.
pub(crate) struct Given<'a> {
    pub(crate) values: &'a Values,
    pub(crate) slicer: Slicer,
}

/// Greatest number of times that a share of a share is followed.
const DEEPEST: usize = 6;

impl Given<'_> {
    /// The first of the keys that has a value.
    pub(crate) fn first_of<'k>(&self, keys: &[&'k str]) -> Option<&'k str> {
        keys.iter()
            .copied()
            .find(|k| self.values.first(k).is_some())
    }

    /// A number, if the key has one.
    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        self.values.number(key)
    }

    /// A number above 0, if the key has one.
    pub(crate) fn positive(&self, key: &str) -> Option<f64> {
        self.number(key).filter(|x| *x > 0.0)
    }

    /// A switch, if the key has one.
    pub(crate) fn switch(&self, key: &str) -> Option<bool> {
        match self.values.first(key)?.to_ascii_lowercase().as_str() {
            "1" | "true" | "yes" | "enabled" | "on" => Some(true),
            "0" | "false" | "no" | "disabled" | "off" => Some(false),
            _ => None,
        }
    }

    pub(crate) fn on(&self, key: &str) -> bool {
        self.switch(key) == Some(true)
    }

    pub(crate) fn off(&self, key: &str) -> bool {
        self.switch(key) == Some(false)
    }

    /// A number, or the value of a share such as `50%`; none if the key has no
    /// value.
    ///
    /// # Errors
    /// If the value is neither, or a share of something that is not in the
    /// profile.
    pub(crate) fn amount(&self, key: &str) -> Result<Option<f64>, String> {
        self.amount_within(key, DEEPEST)
    }

    fn amount_within(
        &self,
        key: &str,
        depth: usize,
    ) -> Result<Option<f64>, String> {
        let Some(text) = self.values.first(key) else {
            return Ok(None);
        };
        if let Some(number) = parse(text) {
            return Ok(Some(number));
        }
        let Some(percent) = share(text) else {
            return Err(format!("{text} is not a number: write it yourself"));
        };
        let base = share_of(self, key);
        if depth == 0 || base.is_empty() {
            return Err(format!("it is not known what {text} is a share of"));
        }
        for base in base {
            if let Some(whole) = self.amount_within(base, depth - 1)?
                && whole > 0.0
            {
                return Ok(Some(whole * percent / 100.0));
            }
        }
        Err(format!(
            "{text} is a share of {}, which the profile does not have",
            base[0]
        ))
    }
}

/// True if the profile has keys of SuperSlicer alone, which shares most of its
/// words with PrusaSlicer.
fn is_superslicers(given: &Given<'_>) -> bool {
    let keys = ["extrusion_spacing", "perimeter_extrusion_spacing"];
    keys.iter().any(|key| given.values.has(key))
}

/// Keys of PrusaSlicer with those that a percentage in their values refers to.
const OF_PRUSA: &[(&str, &[&str])] = pairs! {
    "first_layer_height" => &["layer_height"];
    "external_perimeter_speed", "small_perimeter_speed"
        => &["perimeter_speed"];
    "solid_infill_speed" => &["infill_speed"];
    "top_solid_infill_speed" => &["solid_infill_speed", "infill_speed"];
    "support_material_interface_speed" => &["support_material_speed"];
    "first_layer_speed" => &["external_perimeter_speed", "perimeter_speed"];
    "bridge_speed_internal", "over_bridge_speed", "overhangs_speed"
        => &["bridge_speed"];
    "support_material_xy_spacing"
        => &["external_perimeter_extrusion_width", "extrusion_width",
             "nozzle_diameter"];
    "infill_anchor", "infill_anchor_max", "infill_overlap"
        => &["infill_extrusion_width", "extrusion_width"];
};

/// The same for OrcaSlicer.
const OF_ORCA: &[(&str, &[&str])] = pairs! {
    "small_perimeter_speed" => &["outer_wall_speed"];
    "internal_bridge_speed", "ineternal_bridge_speed" => &["bridge_speed"];
    "support_interface_speed" => &["support_speed"];
    "bridge_acceleration"
        => &["outer_wall_acceleration", "default_acceleration"];
    "seam_gap" => &["nozzle_diameter"];
    "support_object_xy_distance"
        => &["outer_wall_line_width", "line_width", "nozzle_diameter"];
    "initial_layer_travel_speed", "skirt_speed" => &["travel_speed"];
};

/// The keys that a percentage in the value of `key` refers to. The first of
/// them that the profile has counts.
fn share_of(given: &Given<'_>, key: &str) -> &'static [&'static str] {
    let own = match given.slicer {
        Slicer::Prusa => OF_PRUSA,
        Slicer::Orca => OF_ORCA,
        Slicer::Cura => &[],
    };
    if let Some((_, base)) = own.iter().find(|(known, _)| *known == key) {
        return base;
    }
    match given.slicer {
        Slicer::Prusa if !key.ends_with("extrusion_width") => &[],
        Slicer::Prusa if is_superslicers(given) => &["nozzle_diameter"],
        Slicer::Prusa => &["layer_height"],
        Slicer::Orca if key.ends_with("acceleration") => {
            &["default_acceleration"]
        }
        Slicer::Orca if key.ends_with("line_width") => &["nozzle_diameter"],
        _ => &[],
    }
}
