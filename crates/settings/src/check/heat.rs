//! Checks that temperatures are hot enough to print, and not hotter than the
//! machine bears.
//!
//! In: settings. Out: the first temperature that would be a fault of the
//! finished file. The value of a formula is known only when its layer is
//! written.

use super::{Conflict, conflict};
use crate::Settings;
use isoslice_base::units::Celsius;

const FIRST_NOZZLE: &str = "filament.first_layer_nozzle_temperature";
const FIRST_BED: &str = "filament.first_layer_bed_temperature";

/// One temperature that is set.
struct Set {
    key: &'static str,
    value: Celsius,
    limit_key: &'static str,
    limit: Celsius,
    /// The heater whose limit is exceeded, in messages.
    part: &'static str,
}

pub(super) fn temperatures(s: &Settings) -> Result<(), Conflict> {
    let filament = &s.filament;
    let nozzle = |key, value| Set {
        key,
        value,
        limit_key: "printer.max_nozzle_temperature",
        limit: s.max_nozzle_temperature(),
        part: "hot end",
    };
    let bed = |key, value| Set {
        key,
        value,
        limit_key: "printer.max_bed_temperature",
        limit: s.max_bed_temperature(),
        part: "bed",
    };
    let above = filament.nozzle_temperature.constant();
    let above = above.map(|t| nozzle("filament.nozzle_temperature", t));
    // What is auto follows from the temperature above, if that is known.
    let first = nozzle(FIRST_NOZZLE, s.first_layer_nozzle_temperature());
    for set in above.iter().chain([&first]) {
        warm_enough(s, set)?;
        cool_enough(set)?;
    }
    if let Some(first) = filament.first_layer_bed_temperature {
        cool_enough(&bed(FIRST_BED, first))?;
    }
    cool_enough(&bed("filament.bed_temperature", filament.bed_temperature))
}

/// Warns of a first layer that is much hotter or colder than the others, as it is where
/// somebody sets one of the two and a profile the other.
pub(super) fn first_layer(s: &Settings, warnings: &mut Vec<String>) {
    /// The profiles that isoslice has ask for 5 °C more or less on the first layer.
    const MOST: Celsius = 15.0;
    let filament = &s.filament;
    let pairs = [
        (
            FIRST_NOZZLE,
            s.first_layer_nozzle_temperature(),
            "filament.nozzle_temperature",
            filament.nozzle_temperature.constant(),
        ),
        (
            FIRST_BED,
            s.first_layer_bed_temperature(),
            "filament.bed_temperature",
            Some(filament.bed_temperature),
        ),
    ];
    for (key, first, above_key, above) in pairs {
        if let Some(above) = above
            && above > 0.0
            && first > 0.0
            && (first - above).abs() > MOST
        {
            warnings.push(format!(
                "{key} = {first} °C is far from {above_key} = {above} °C, and holds \
                 on the first layer; set both, or the first to auto"
            ));
        }
    }
}

fn warm_enough(s: &Settings, set: &Set) -> Result<(), Conflict> {
    let Set { key, value, .. } = set;
    let least = s.min_nozzle_temperature();
    if *value >= least {
        return Ok(());
    }
    Err(conflict(
        [key, "filament.min_nozzle_temperature"],
        format!(
            "{key} = {value} °C melts hardly any plastic, and most firmware \
             refuses to push it below {least} °C \
             (filament.min_nozzle_temperature); PLA takes about 210 °C",
        ),
    ))
}

fn cool_enough(set: &Set) -> Result<(), Conflict> {
    let Set {
        key,
        value,
        limit_key,
        limit,
        part,
    } = set;
    if value <= limit {
        return Ok(());
    }
    Err(conflict(
        [key, limit_key],
        format!(
            "{key} = {value} °C is more than {limit_key} = {limit} °C: this \
             printer is not made for this filament; take another, lower the \
             temperature, or raise {limit_key} if your {part} bears more",
        ),
    ))
}

#[cfg(test)]
mod tests {
    use crate::Builder;

    /// The warnings of some settings that speak of one.
    fn warnings(of: &str, settings: &str) -> usize {
        let mut builder = Builder::new();
        builder.toml("own.toml", settings).unwrap();
        let (_, warnings) = builder.finish().unwrap();
        warnings.iter().filter(|text| text.contains(of)).count()
    }

    #[test]
    fn a_first_layer_far_from_the_others_is_warned_of() {
        let nozzle = "filament.nozzle_temperature = 250\n";
        let bed = "filament.bed_temperature = 100\n";
        let first = "filament.first_layer_";
        assert_eq!(warnings(first, &format!("{nozzle}{bed}")), 0);
        for (more, count) in [
            ("nozzle_temperature = 240", 0),
            ("nozzle_temperature = 215", 1),
            ("nozzle_temperature = 270", 1),
            ("bed_temperature = 90", 0),
            ("bed_temperature = 60", 1),
            ("bed_temperature = 0", 0),
        ] {
            let all = format!("{nozzle}{bed}{first}{more}");
            assert_eq!(warnings(first, &all), count, "{more}");
        }
    }

    #[test]
    fn what_the_first_layer_is_left_to_is_checked() {
        let mut builder = Builder::new();
        let cold = "filament.nozzle_temperature = \"expr: 190 + z\"\n\
                    printer.max_nozzle_temperature = 200";
        builder.toml("own.toml", cold).unwrap();
        let error = builder.finish().unwrap_err().to_string();
        assert!(
            error.contains("first_layer_nozzle_temperature = 215"),
            "{error}"
        );
    }

    #[test]
    fn arcs_are_warned_of_on_klipper_alone() {
        for (flavour, count) in [("klipper", 1), ("marlin", 0)] {
            let all =
                format!("gcode.arcs = true\ngcode.flavour = \"{flavour}\"");
            assert_eq!(warnings("[gcode_arcs]", &all), count, "{flavour}");
        }
    }
}
