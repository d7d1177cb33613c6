//! Rings that follow the area's border at equal distances.
//!
//! ```text
//!   ╭──────────────╮
//!   │ ╭──────────╮ │
//!   │ │ ╭──────╮ │ │
//!   │ │ ╰──────╯ │ │
//!   │ ╰──────────╯ │
//!   ╰──────────────╯
//! ```
//!
//! The first ring is half a spacing inside the border, so that every bead has
//! its share of the area on both sides.

use super::families::threshold;
use super::{Density, Layer, Pattern};
use isoslice_planar::Area;
use isoslice_planar::border::LinePiece;
use isoslice_planar::offset::offset;

/// Offsets of the border.
pub(super) struct Concentric;

/// Tolerance of the offsets, mm. Nobody sees where exactly the rings are.
const TOLERANCE: f64 = 0.02;

impl Pattern for Concentric {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        let spacing = match layer.density {
            Density::Even(share) => layer.solid / share,
            Density::Graded(_) => layer.solid,
        };
        let mut pieces = Vec::new();
        // Distances count from the border of the sparse area, not from the
        // border that lines end at.
        let first = 0.5 * spacing - layer.margin;
        let area = layer.border.area();
        let mut area: Area = offset(area, -first.max(0.0), TOLERANCE);
        for number in 0.. {
            if area.is_empty() {
                break;
            }
            for ring in &area.rings {
                match layer.density {
                    Density::Even(_) => {
                        pieces.push(LinePiece::inner(ring.clone(), true))
                    }
                    Density::Graded(grading) => {
                        grading.above(ring, threshold(number), &mut pieces);
                    }
                }
            }
            area = offset(&area, -spacing, TOLERANCE);
        }
        pieces.retain(|p| {
            isoslice_planar::path_length(&p.points, p.closed) >= layer.shortest
        });
        pieces
    }
}
