//! Lines in three directions, at equal places in every layer: tubes of
//! equilateral triangles, stiff in every direction of the plane.
//!
//! ```text
//!   ─╱╲──╱╲──╱╲─
//!   ╱──╲╱──╲╱──╲
//! ```

use super::families::{Family, lines};
use super::{Layer, Pattern};
use isoslice_planar::border::LinePiece;

/// Three families through common points.
pub(super) struct Triangles;

impl Pattern for Triangles {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        let families =
            [0.0, 60.0, 120.0].map(|turn| Family { turn, shift: 0.0 });
        lines(layer, &families)
    }
}
