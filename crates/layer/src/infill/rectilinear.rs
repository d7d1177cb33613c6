//! Parallel lines, turned by 90° from layer to layer.
//!
//! ```text
//!   even  ╱ ╱ ╱ ╱      odd  ╲ ╲ ╲ ╲
//!         ╱ ╱ ╱ ╱           ╲ ╲ ╲ ╲
//! ```

use super::families::{Family, lines};
use super::{Layer, Pattern};
use isoslice_planar::border::LinePiece;

/// Parallel lines.
pub(super) struct Rectilinear;

impl Pattern for Rectilinear {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        let turn = 90.0 * (layer.number % 2) as f64;
        lines(layer, &[Family { turn, shift: 0.0 }])
    }
}
