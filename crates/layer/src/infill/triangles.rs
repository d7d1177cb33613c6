//! Lines in three directions, at equal places in every layer: tubes of
//! equilateral triangles, stiff in every direction of the plane.
//!
//! ```text
//!   ─╱╲──╱╲──╱╲─
//!   ╱──╲╱──╲╱──╲
//! ```

use super::families::{Family, lines};
use super::{Layer, Pattern};
use isoslice_planar::border::Piece;

/// Three families through common points.
pub(super) struct Triangles;

impl Pattern for Triangles {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<Piece> {
        // The ways across the first and the last family add up to the way
        // across the second. So families moved by 1, 1 and 0 still pass common
        // points.
        let ways = [(0.0, 1.0), (60.0, 1.0), (120.0, 0.0)];
        let families = ways.map(|(turn, phase)| Family {
            turn,
            shift: 0.0,
            phase,
        });
        lines(layer, &families)
    }
}
