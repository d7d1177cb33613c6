//! Looks for what Klipper refuses to extrude, in the user's templates and in
//! the settings of beads.
//!
//! In: a template's lines, as they will be written; the writer's plan. Out: warnings. By default
//! Klipper stops a print at a move that lays a line thicker than
//! 4·nozzle² (0.64 mm² for 0.4 mm), or that pushes more than 50 mm of filament
//! without moving: purge lines made for other firmware often do.
//!
//! Not seen: what macros do, and moves from an unknown position.

use super::WriterPlan;
use super::number::text;
use glam::DVec2;
use isoslice_settings::Refusals;

/// The position of the head and of the filament.
#[derive(Clone, Copy, Debug)]
struct Position {
    at: DVec2,
    e: f64,
    relative: bool,
    relative_e: bool,
}

/// Warnings about the template `name`.
pub(super) fn warnings(
    name: &str,
    rendered: &str,
    plan: &WriterPlan<'_>,
) -> Vec<String> {
    let Some(refuses) = plan.flavour.firmware().refuses else {
        return Vec::new();
    };
    let mut state = Position {
        at: DVec2::NAN,
        e: 0.0,
        relative: false,
        relative_e: plan.relative_e,
    };
    let lines = rendered.lines().enumerate();
    lines
        .filter_map(|(i, line)| {
            let fault = step(&mut state, line, plan, refuses)?;
            Some(format!(
                "{name}, line {} as written ({}): {fault}",
                i + 1,
                line.trim()
            ))
        })
        .collect()
}

impl WriterPlan<'_> {
    /// A warning about beads that are too thick.
    pub fn thick_beads(&self) -> Option<String> {
        let refuses = self.flavour.firmware().refuses?;
        let nozzle = self.printer.nozzle_diameter;
        let most = refuses.section * nozzle * nozzle;
        (self.thickest > most).then(|| {
            format!(
                "the thickest beads may have {} mm², but Klipper by default \
                 refuses more than {} mm² (max_extrude_cross_section); lower \
                 line widths, thin_max or flow, or raise it in your printer.cfg",
                text(self.thickest, 2),
                text(most, 2)
            )
        })
    }
}

fn step(
    state: &mut Position,
    line: &str,
    plan: &WriterPlan<'_>,
    refuses: Refusals,
) -> Option<String> {
    let code = line.split(';').next().unwrap_or("");
    let mut words = code.split_whitespace();
    let command = words.next()?.to_uppercase();
    let number = |letter: char| {
        let mut words = code.split_whitespace().skip(1);
        let word = words.find(|w| w.to_uppercase().starts_with(letter))?;
        word.get(1..)?.parse::<f64>().ok()
    };
    match command.as_str() {
        "G90" => state.relative = false,
        "G91" => state.relative = true,
        "M82" => state.relative_e = false,
        "M83" => state.relative_e = true,
        "G28" => state.at = DVec2::NAN,
        "G92" => {
            state.e = number('E').unwrap_or(state.e);
            state.at.x = number('X').unwrap_or(state.at.x);
            state.at.y = number('Y').unwrap_or(state.at.y);
        }
        "G0" | "G1" => return extrusion(state, plan, refuses, number),
        _ => {}
    }
    None
}

fn extrusion(
    state: &mut Position,
    plan: &WriterPlan<'_>,
    refuses: Refusals,
    number: impl Fn(char) -> Option<f64>,
) -> Option<String> {
    let [x, y] = ['X', 'Y'].map(&number);
    let moves = x.is_some() || y.is_some();
    let from = state.at;
    let axis = |word: Option<f64>, at: f64| match (word, state.relative) {
        (Some(by), true) => at + by,
        (Some(to), false) => to,
        (None, _) => at,
    };
    let to = DVec2::new(axis(x, from.x), axis(y, from.y));
    let fed = match (number('E'), state.relative_e || state.relative) {
        (Some(by), true) => by,
        (Some(to), false) => to - std::mem::replace(&mut state.e, to),
        (None, _) => 0.0,
    };
    state.at = to;
    if !moves {
        return (fed.abs() > refuses.feed).then(|| {
            format!(
                "Klipper by default refuses to move more than {} mm of \
                 filament at a time (max_extrude_only_distance); split it",
                refuses.feed
            )
        });
    }
    let nozzle = plan.printer.nozzle_diameter;
    let most = refuses.section * nozzle * nozzle;
    let section = fed * plan.filament_area / from.distance(to);
    // Where the length of the move is not known, `section` is NaN and the
    // comparison is false.
    (fed > 0.0 && section > most).then(|| {
        format!(
            "a line of {} mm², but Klipper by default refuses more than {} \
             mm² (max_extrude_cross_section); feed less, or go farther",
            text(section, 2),
            text(most, 2)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::Flavour;

    fn found(lines: &str) -> Vec<String> {
        let plan = WriterPlan::with(|s| s.gcode.flavour = Flavour::Klipper);
        warnings("gcode.start", lines, &plan)
    }

    #[test]
    fn a_purge_line_of_the_usual_kind_is_fine() {
        assert_eq!(
            found(
                "G28\nG1 X2 Y20 Z0.3\nG1 X2 Y200 E15\nG1 X2.4\nG1 Y20 E30\n\
                 G92 E0\nG1 E-1\nM83\nG1 E1"
            ),
            [""; 0]
        );
    }

    #[test]
    fn beads_are_too_thick_above_four_squares_of_the_nozzle() {
        let klipper = |width: f64, flow| {
            WriterPlan::with(|s| {
                s.gcode.flavour = Flavour::Klipper;
                s.layer_height = 0.3.into();
                s.outer_wall_width = width.into();
                s.filament.flow = flow;
            })
        };
        assert_eq!(klipper(0.45, 100.0).thick_beads(), None);
        // 1.8 mm wide: (1.8 − 0.3)·0.3 + π·0.15² = 0.52 mm².
        assert_eq!(klipper(1.0, 100.0).thick_beads(), None);
        let mut thick = klipper(1.0, 125.0);
        let warning = thick.thick_beads().unwrap();
        assert!(warning.contains("0.65 mm², but"), "{warning}");
        thick.flavour = Flavour::Marlin;
        assert_eq!(thick.thick_beads(), None);
    }

    #[test]
    fn too_much_is_found_in_every_mode() {
        let thick = found("G1 X0 Y0\nG1 X10 E5");
        assert_eq!(thick.len(), 1);
        assert!(thick[0].starts_with("gcode.start, line 2 as written"));
        assert!(thick[0].contains("1.2 mm², but"), "{}", thick[0]);
        assert_eq!(found("M83\nG1 X0 Y0\nG91\nG1 X10 E5").len(), 1);
        assert_eq!(found("G92 E0\nG1 E60 F300").len(), 1);
        assert_eq!(found("M83\nG1 E40 F300\nG1 E40").len(), 0);
        // A move from an unknown position, and other firmware.
        assert_eq!(found("G1 X10 Y10 E50").len(), 0);
        let marlin = WriterPlan::with(|_| ());
        assert!(warnings("x", "G1 E60", &marlin).is_empty());
    }
}
