//! What hosts, screens and web pages show of a print, as keys and values.
//!
//! In: the writer's plan, and what the print takes. Out: keys in the words of
//! PrusaSlicer, which other programs have taken over: Moonraker
//! (`metadata.py`), PrusaLink (`gcode_metadata`), RepRapFirmware
//! (`FileInfoParser.cpp`), the firmware of Prusa's printers (`gcode_info.cpp`).
//! A text file has the keys in its foot, a binary file in tables.

use super::number::text;
use super::plan::WriterPlan;
use super::{COARSE, Totals, WIDTH, XYZ};
use isoslice_base::units::human_time;

/// What a fact is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// The fact is about what the print takes.
    Print,
    /// The fact is about how the print was sliced.
    Slicer,
}

/// Something that hosts show.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fact {
    pub key: &'static str,
    pub value: String,
    pub of: Of,
    /// True if printers that read binary files ask for the fact.
    pub printer: bool,
}

/// The facts of a finished print.
pub(super) fn facts(plan: &WriterPlan<'_>, t: &Totals) -> Vec<Fact> {
    let mut all = Vec::new();
    let mut of = Of::Print;
    let mut add = |of: Of, printer: bool, key, value| {
        all.push(Fact {
            key,
            value,
            of,
            printer,
        });
    };
    let (printer, filament) = (plan.printer, plan.filament);
    let cost = t.filament_mass_g * 1e-3 * filament.cost;
    let time = human_time(t.time);
    add(of, true, "filament used [mm]", text(t.filament_length, 2));
    let cm3 = text(t.filament_volume * 1e-3, 2);
    add(of, true, "filament used [cm3]", cm3);
    let grams = text(t.filament_mass_g, 2);
    add(of, true, "filament used [g]", grams.clone());
    add(of, false, "total filament used [g]", grams);
    add(of, true, "filament cost", text(cost, 2));
    add(of, true, "estimated printing time (normal mode)", time);
    // RepRapFirmware knows this key.
    add(of, false, "total layers count", t.layers.to_string());
    add(of, false, "num_layers", t.layers.to_string());
    add(of, false, "total toolchanges", "0".to_owned());
    add(of, true, "max_layer_z", text(t.height, XYZ));

    of = Of::Slicer;
    let [first, above] = plan.layer_heights.map(|h| text(h, WIDTH));
    add(of, true, "layer_height", above);
    add(of, false, "first_layer_height", first);
    let nozzle = text(printer.nozzle_diameter, 3);
    add(of, true, "nozzle_diameter", nozzle);
    let diameter = text(filament.diameter, 3);
    add(of, false, "filament_diameter", diameter);
    let density = text(filament.density, 3);
    add(of, false, "filament_density", density);
    let material = plain(&filament.material);
    if !material.is_empty() {
        add(of, true, "filament_type", material.clone());
        add(of, false, "filament_settings_id", material);
    }
    if !printer.model.trim().is_empty() {
        add(of, true, "printer_model", plain(&printer.model));
    }
    // Some readers take only whole degrees and millimetres.
    if let Some(above) = filament.nozzle_temperature.constant() {
        add(of, true, "temperature", text(above.round(), COARSE));
    }
    let bed = text(filament.bed_temperature.round(), COARSE);
    add(of, true, "bed_temperature", bed);
    let first = text(plan.nozzle_temperatures.0.round(), COARSE);
    add(of, false, "first_layer_temperature", first);
    let first = text(plan.bed_temperatures[0].round(), COARSE);
    add(of, false, "first_layer_bed_temperature", first);
    let (x, y) = (text(printer.bed_x, XYZ), text(printer.bed_y, XYZ));
    add(of, false, "bed_shape", format!("0x0,{x}x0,{x}x{y},0x{y}"));
    if let Some(density) = plan.infill_density {
        let density = format!("{}%", text(density, COARSE));
        add(of, true, "fill_density", density);
    }
    add(of, true, "brim_width", text(plan.brim_width, 0));
    let yes = |is: bool| u8::from(is).to_string();
    add(of, true, "ironing", yes(plan.ironing));
    add(of, true, "support_material", yes(plan.supports));
    all
}

/// A name without the characters that would end its line.
fn plain(name: &str) -> String {
    name.trim().chars().filter(|c| !c.is_control()).collect()
}
