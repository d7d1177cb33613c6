//! Checks that temperatures are hot enough to print, and not hotter than the
//! machine bears.
//!
//! In: settings. Out: the first temperature that would be a fault of the
//! finished file. The value of a formula is known only when its layer is
//! written.

use super::{Conflict, conflict};
use crate::Settings;
use isoslice_base::units::Celsius;

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
    let first = filament.first_layer_nozzle_temperature;
    let first = nozzle("filament.first_layer_nozzle_temperature", first);
    let above = filament.nozzle_temperature.constant();
    let above = above.map(|t| nozzle("filament.nozzle_temperature", t));
    for set in [&first].into_iter().chain(&above) {
        warm_enough(s, set)?;
        cool_enough(set)?;
    }
    cool_enough(&bed(
        "filament.first_layer_bed_temperature",
        filament.first_layer_bed_temperature,
    ))?;
    cool_enough(&bed("filament.bed_temperature", filament.bed_temperature))
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
