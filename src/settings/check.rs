//! Settings that are each within their range but do not work together.

use super::Settings;

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
pub(super) fn conflicts(s: &Settings) -> Result<Vec<String>, Conflict> {
    let mut warnings = Vec::new();
    heights(s, &mut warnings)?;
    widths(s, &mut warnings)?;
    sampling(s, &mut warnings)?;
    something_is_printed(s)?;
    let first = s.filament.first_layer_nozzle_temperature;
    let above = s.filament.nozzle_temperature.constant().unwrap_or(first);
    if above < 150.0 || first < 150.0 {
        warnings.push(format!(
            "a nozzle at {} °C (filament.first_layer_nozzle_temperature) or \
             {} °C (filament.nozzle_temperature) melts hardly any plastic, and \
             most firmware refuses to extrude",
            first, above,
        ));
    }
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
    Ok(warnings)
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
        if !(0.5 * nozzle..=3.0 * nozzle).contains(&width) {
            warnings.push(format!(
                "{key} = {width} mm is hard to print with a nozzle of \
                 printer.nozzle_diameter = {nozzle} mm: better stay within \
                 {} to {} mm",
                round(0.5 * nozzle),
                round(3.0 * nozzle),
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
    if s.walls == 0 && !solid && s.infill_density.is(0.0) {
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

/// For messages: three decimals at most.
fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}
