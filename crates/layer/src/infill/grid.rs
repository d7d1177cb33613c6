//! Lines in two directions, at equal places in every layer: square tubes.
//!
//! ```text
//!   ╱╲╱╲╱╲
//!   ╲╱╲╱╲╱
//! ```

use super::families::{Family, lines};
use super::{Layer, Pattern};
use isoslice_planar::border::LinePiece;

/// Crossing lines.
pub(super) struct Grid;

impl Pattern for Grid {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        let families = [0.0, 90.0].map(|turn| Family { turn, shift: 0.0 });
        lines(layer, &families)
    }
}
