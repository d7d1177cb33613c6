//! Solid fill: a ring around each skin area, and lines at ±45° inside it.
//!
//! ```text
//!   ╭────────────╮   the ring runs half a bead's spacing inside the area's
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   border, around holes as well; lines end half a nozzle
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   off the ring's centre line, one spacing apart, turned
//!   ╰────────────╯   by 90° from layer to layer
//! ```

use crate::bead::{Bead, Role, spacing};
use crate::plane::hatch::{Lines, hatch};
use crate::plane::{Area, Rect};
use crate::region::exposure::FillAreas;
use crate::region::shrink;
use crate::settings::Settings;
use crate::units::Mm;

/// A connected skin area's beads.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Closed beads around the area and its holes.
    pub rings: Vec<Bead>,
    /// Straight beads inside the rings.
    pub lines: Vec<Bead>,
}

/// Tolerance of the ring's offsets; nobody sees them.
const TOLERANCE: Mm = 0.01;

/// The beads of a layer's skin. Even layers get lines at `skin_angle`, odd
/// ones at right angles to it.
pub fn patches(
    areas: &FillAreas,
    layer: usize,
    height: Mm,
    settings: &Settings,
) -> Vec<Patch> {
    let width = settings.skin_width;
    let space = spacing(width, width, height);
    let lines = Lines {
        angle: settings.skin_angle - 90.0 * (layer % 2) as f64,
        spacing: space,
        phase: 0.0,
    };
    areas
        .skin
        .islands()
        .iter()
        .filter_map(|island| {
            let centre = shrink(island, 0.5 * space, TOLERANCE);
            if centre.is_empty() {
                return None;
            }
            let role = role(island, areas);
            let bead = |points, closed| Bead {
                role,
                points,
                closed,
                width,
                height,
            };
            let half_nozzle = 0.5 * settings.printer.nozzle_diameter;
            let inside = shrink(&centre, half_nozzle, TOLERANCE);
            let fill = hatch(&inside, lines, 0.5 * width);
            Some(Patch {
                rings: centre
                    .rings
                    .iter()
                    .map(|r| bead(r.clone(), true))
                    .collect(),
                lines: fill
                    .iter()
                    .map(|s| bead(vec![s.from, s.to], false))
                    .collect(),
            })
        })
        .collect()
}

/// What a skin island is: the side on which most of it faces the air.
fn role(island: &Area, areas: &FillAreas) -> Role {
    let frame = Rect::around(island.rings.iter().flatten());
    let share = |open: &Area| {
        let inside: f64 = open
            .rings
            .iter()
            .filter(|r| {
                r.first()
                    .is_some_and(|&p| frame.contains(p) && island.contains(p))
            })
            .map(|r| crate::plane::signed_area(r))
            .sum();
        inside / island.content()
    };
    if share(&areas.open_below) > 0.5 {
        Role::BottomSkin
    } else if share(&areas.open_above) > 0.5 {
        Role::TopSkin
    } else {
        Role::InternalSkin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn square(half: f64) -> Area {
        let ring = [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn a_square_gets_a_ring_and_lines_that_turn() {
        let settings = Settings::default();
        let areas = FillAreas {
            skin: square(10.0),
            open_above: square(10.0),
            ..FillAreas::default()
        };
        for layer in [0, 1] {
            let patches = patches(&areas, layer, 0.2, &settings);
            assert_eq!(patches.len(), 1);
            let p = &patches[0];
            assert_eq!(p.rings.len(), 1);
            assert_eq!(p.rings[0].role, Role::TopSkin);
            let length: f64 = p.lines.iter().map(Bead::length).sum();
            let space = spacing(0.45, 0.45, 0.2);
            let side = 20.0 - space - 0.4;
            assert!((length * space / (side * side) - 1.0).abs() < 0.01);
            let d = p.lines[9].points[1] - p.lines[9].points[0];
            let slope = d.y / d.x;
            let expected = if layer == 0 { 1.0 } else { -1.0 };
            assert!((slope - expected).abs() < 1e-9, "{slope}");
        }
    }

    #[test]
    fn too_narrow_for_a_ring_is_left_out() {
        let areas = FillAreas {
            skin: square(0.15),
            ..FillAreas::default()
        };
        assert!(patches(&areas, 0, 0.2, &Settings::default()).is_empty());
    }
}
