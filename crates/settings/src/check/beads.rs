//! Checks that a nozzle can print heights and widths, and that samples are fine
//! enough.

use super::{Conflict, conflict, round};
use crate::{ByNozzle, Settings, table};
use isoslice_base::units::Mm;

/// A share of the nozzle's diameter must be a length that the setting allows.
pub(super) fn shares(s: &Settings) -> Result<(), Conflict> {
    for (key, set, length) in s.by_nozzle() {
        let range = table::find(key).and_then(|key| key.range);
        if let (ByNozzle::Share(share), Some(range)) = (set, range)
            && !range.contains(length)
        {
            let nozzle = s.printer.nozzle_diameter;
            return Err(conflict(
                [key, "printer.nozzle_diameter"],
                format!(
                    "{key} = {share}% of printer.nozzle_diameter = {nozzle} \
                     mm is {} mm; {range} mm are allowed",
                    round(length),
                ),
            ));
        }
    }
    Ok(())
}

/// A layer must fit under the nozzle.
pub(super) fn heights(
    s: &Settings,
    warnings: &mut Vec<String>,
) -> Result<(), Conflict> {
    let nozzle = s.printer.nozzle_diameter;
    let (least, most) = (s.layer_height_min(), s.layer_height_max());
    if !s.is_uniform() && least > most {
        return Err(conflict(
            ["layer_height_min", "layer_height_max"],
            format!(
                "layer_height_min = {} mm is more than layer_height_max = {} \
                 mm; lower the one or raise the other",
                round(least),
                round(most),
            ),
        ));
    }
    for (key, height) in layer_heights(s) {
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
pub(super) fn widths(
    s: &Settings,
    warnings: &mut Vec<String>,
) -> Result<(), Conflict> {
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
        for (height_key, height) in layer_heights(s) {
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

fn layer_heights(s: &Settings) -> [(&'static str, Mm); 2] {
    let key = if s.layer_height() >= s.thickest_layer() {
        "layer_height"
    } else {
        "layer_height_max"
    };
    [
        (key, s.thickest_layer()),
        ("first_layer_height", s.first_layer_height()),
    ]
}

fn line_widths(
    s: &Settings,
) -> impl Iterator<Item = (&'static str, Mm)> + use<> {
    // An automatic width suits the nozzle, or is that of another setting.
    s.by_nozzle()
        .into_iter()
        .filter(|(key, set, _)| {
            key.ends_with("_width") && *set != ByNozzle::Auto
        })
        .map(|(key, _, width)| (key, width))
}

/// The lattice must be coarser than the accuracy.
pub(super) fn sampling(
    s: &Settings,
    warnings: &mut Vec<String>,
) -> Result<(), Conflict> {
    let (spacing, width) = (s.lattice_spacing(), s.outer_wall_width());
    if s.accuracy >= spacing {
        // A setting that is as large as it may be has no effect if it is raised.
        let (key, what) = if s.sample_spacing >= 0.5 * width {
            let what =
                format!("{spacing} mm, half of outer_wall_width = {width} mm");
            ("outer_wall_width", what)
        } else {
            ("sample_spacing", format!("sample_spacing = {spacing} mm"))
        };
        return Err(conflict(
            ["accuracy", key],
            format!(
                "accuracy = {} mm is not finer than the lattice that outlines \
                 are refined from, whose spacing is {what}; lower accuracy or \
                 raise {key}",
                s.accuracy,
            ),
        ));
    }
    // With a fine nozzle, nobody has to lower what is there by default.
    let is_less = spacing < s.sample_spacing;
    if is_less && s.sample_spacing != Settings::default().sample_spacing {
        warnings.push(format!(
            "sample_spacing = {} mm is more than half of outer_wall_width = \
             {width} mm: {spacing} mm is used, since a coarser lattice would \
             overlook what can be printed",
            s.sample_spacing,
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_to_be_raised_that_is_at_its_bound() {
        let remedy = |sample_spacing: Mm| {
            let s = Settings {
                sample_spacing,
                outer_wall_width: ByNozzle::Length(0.4),
                accuracy: 0.2,
                ..Settings::default()
            };
            let said = sampling(&s, &mut Vec::new()).unwrap_err().message;
            said.split("or raise ").last().map(str::to_owned).unwrap()
        };
        assert_eq!(remedy(0.15), "sample_spacing");
        assert_eq!(remedy(0.2), "outer_wall_width");
        assert_eq!(remedy(0.3), "outer_wall_width");
    }
}
