//! What hosts, screens and web pages show of a print, as keys and values.
//!
//! In: the settings, and what the print takes. Out: keys in the words of
//! PrusaSlicer, which other programs have taken over: Moonraker
//! (`metadata.py`), PrusaLink (`gcode_metadata`), RepRapFirmware
//! (`FileInfoParser.cpp`), the firmware of Prusa's printers (`gcode_info.cpp`).
//! A text file has the keys in its foot, a binary file in tables.

use super::number::text;
use super::{COARSE, Totals, WIDTH, XYZ};
use isoslice_base::units::human_time;
use isoslice_settings::{BrimPlace, Settings, Supports};

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
pub(super) fn facts(s: &Settings, t: &Totals) -> Vec<Fact> {
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
    let cost = t.filament_mass_g * 1e-3 * s.filament.cost;
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
    let first = text(s.bed_layer_height(), WIDTH);
    add(of, true, "layer_height", text(s.layer_height(), WIDTH));
    add(of, false, "first_layer_height", first);
    let nozzle = text(s.printer.nozzle_diameter, 3);
    add(of, true, "nozzle_diameter", nozzle);
    let diameter = text(s.filament.diameter, 3);
    add(of, false, "filament_diameter", diameter);
    let density = text(s.filament.density, 3);
    add(of, false, "filament_density", density);
    let material = plain(&s.filament.material);
    if !material.is_empty() {
        add(of, true, "filament_type", material.clone());
        add(of, false, "filament_settings_id", material);
    }
    if !s.printer.model.trim().is_empty() {
        add(of, true, "printer_model", plain(&s.printer.model));
    }
    // Some readers take only whole degrees and millimetres.
    let f = &s.filament;
    if let Some(above) = f.nozzle_temperature.constant() {
        add(of, true, "temperature", text(above.round(), COARSE));
    }
    let bed = text(f.bed_temperature.round(), COARSE);
    add(of, true, "bed_temperature", bed);
    let first = text(f.first_layer_nozzle_temperature.round(), COARSE);
    add(of, false, "first_layer_temperature", first);
    let first = text(f.first_layer_bed_temperature.round(), COARSE);
    add(of, false, "first_layer_bed_temperature", first);
    let (x, y) = (text(s.printer.bed_x, XYZ), text(s.printer.bed_y, XYZ));
    add(of, false, "bed_shape", format!("0x0,{x}x0,{x}x{y},0x{y}"));
    if let Some(density) = s.infill_density.constant() {
        let density = format!("{}%", text(density, COARSE));
        add(of, true, "fill_density", density);
    }
    let brim = match s.brim.place {
        BrimPlace::None => 0.0,
        BrimPlace::Ears => s.brim.width.ceil(),
        _ => s.brim.width.ceil(),
    };
    add(of, true, "brim_width", text(brim, 0));
    add(of, true, "ironing", u8::from(s.ironing.is_on()).to_string());
    add(
        of,
        true,
        "support_material",
        u8::from(s.supports != Supports::Off).to_string(),
    );
    all
}

/// A name without the characters that would end its line.
fn plain(name: &str) -> String {
    name.trim().chars().filter(|c| !c.is_control()).collect()
}
