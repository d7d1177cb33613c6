//! Solid fill: a ring around each skin area, and lines at ±45° inside it.
//!
//! ```text
//!   ╭────────────╮   the ring runs half a bead's spacing inside the area's
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   border, around holes as well; lines end half a nozzle
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   off the ring's centre line, one spacing apart, turned
//!   ╰────────────╯   by 90° from layer to layer
//! ```

use crate::bead::{Bead, Role, spacing};
use crate::plane::Area;
use crate::plane::grid::EdgeGrid;
use crate::plane::hatch::{Lines, Segment, hatch};
use crate::region::{Lay, lay, shrink};
use crate::settings::Settings;
use crate::units::Mm;
use glam::DVec2;

/// A connected skin area's beads.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Beads around the area and its holes, and those in the middle of
    /// places too thin for them.
    pub rings: Vec<Bead>,
    /// Straight beads inside the rings.
    pub lines: Vec<Bead>,
}

/// The solids directly above and below a layer, if there are any.
#[derive(Clone, Copy, Debug)]
pub struct Faces<'a> {
    /// The next layer's.
    pub above: Option<&'a EdgeGrid>,
    /// The layer's below.
    pub below: Option<&'a EdgeGrid>,
}

/// Tolerance of the ring's offsets; nobody sees them.
const TOLERANCE: Mm = 0.01;

/// The beads of a layer's skin. Even layers get lines at `skin_angle`, odd
/// ones at right angles to it.
pub fn patches(
    skin: &Area,
    faces: Faces<'_>,
    layer: usize,
    height: Mm,
    settings: &Settings,
) -> Vec<Patch> {
    let width = settings.skin_width;
    let space = spacing(width, width, height);
    let plan = Lay::inside(width, height, settings);
    let lines = Lines {
        angle: settings.skin_angle - 90.0 * (layer % 2) as f64,
        spacing: space,
        phase: 0.0,
    };
    skin.islands()
        .iter()
        .filter_map(|island| {
            let laid = lay(island, plan, TOLERANCE);
            let half_nozzle = 0.5 * settings.printer.nozzle_diameter;
            let inside = shrink(&laid.rings, half_nozzle, TOLERANCE);
            let fill = hatch(&inside, lines, 0.5 * width);
            let role = faces.role(island, &fill);
            let bead = |points, closed| Bead {
                role,
                points,
                closed,
                width,
                widths: Vec::new(),
                height,
            };
            let rings = laid.lines.into_iter().map(|l| Bead {
                widths: l.widths,
                ..bead(l.points, l.closed)
            });
            let thin = laid.thin.into_iter().map(|l| Bead {
                role: Role::GapFill,
                width: l.width,
                widths: l.widths,
                ..bead(l.points, l.closed)
            });
            let rings: Vec<Bead> = rings.chain(thin).collect();
            (!rings.is_empty()).then(|| Patch {
                rings,
                lines: fill
                    .iter()
                    .map(|s| bead(vec![s.from, s.to], false))
                    .collect(),
            })
        })
        .collect()
}

impl Faces<'_> {
    /// What a skin island is: the side on which most of it faces the air, as
    /// points along its lines (where there are none, its ring's) tell.
    fn role(&self, island: &Area, lines: &[Segment]) -> Role {
        /// Distance between probes, mm.
        const STEP: f64 = 1.0;
        let along = lines.iter().flat_map(|s| {
            let count = (s.from.distance(s.to) / STEP).ceil().max(1.0);
            (0..count as usize)
                .map(move |i| s.from.lerp(s.to, (i as f64 + 0.5) / count))
        });
        let probes: Vec<DVec2> = match lines.is_empty() {
            true => island.rings.iter().flatten().copied().collect(),
            false => along.collect(),
        };
        let share = |solid: &EdgeGrid| {
            let open = probes.iter().filter(|p| !solid.contains(**p)).count();
            open as f64 / probes.len() as f64
        };
        if self.below.is_none_or(|solid| share(solid) > 0.5) {
            Role::BottomSkin
        } else if self.above.is_none_or(|solid| share(solid) > 0.5) {
            Role::TopSkin
        } else {
            Role::InternalSkin
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(half: f64) -> Area {
        let ring = [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn a_square_gets_a_ring_and_lines_that_turn() {
        let settings = Settings::default();
        let below = EdgeGrid::new(&square(12.0), 1.0);
        let faces = Faces {
            above: None,
            below: Some(&below),
        };
        for layer in [0, 1] {
            let patches = patches(&square(10.0), faces, layer, 0.2, &settings);
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
    fn the_role_is_that_of_the_open_side() {
        let settings = Settings::default();
        let wide = EdgeGrid::new(&square(12.0), 1.0);
        let narrow = EdgeGrid::new(&square(3.0), 1.0);
        let role = |above, below| {
            let faces = Faces { above, below };
            patches(&square(10.0), faces, 0, 0.2, &settings)[0].rings[0].role
        };
        assert_eq!(role(Some(&wide), Some(&wide)), Role::InternalSkin);
        assert_eq!(role(Some(&narrow), Some(&wide)), Role::TopSkin);
        assert_eq!(role(Some(&wide), Some(&narrow)), Role::BottomSkin);
        assert_eq!(role(Some(&wide), None), Role::BottomSkin);
    }

    #[test]
    fn too_narrow_for_a_ring_is_left_out() {
        let faces = Faces {
            above: None,
            below: None,
        };
        let settings = Settings::default();
        assert!(patches(&square(0.15), faces, 0, 0.2, &settings).is_empty());
    }
}
