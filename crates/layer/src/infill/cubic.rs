//! Cubes that stand on a corner: three families of planes at right angles to
//! each other, all equally steep, cut by the layer.
//!
//! ```text
//!    ╲  ╱ ╲  ╱       Lines in three directions, like those of triangles, which
//!   ──╲╱───╲╱──      move sideways from layer to layer. So the cells are
//!     ╱╲   ╱╲        closed upwards as well.
//! ```
//!
//! A plane whose normal has √⅔ across and √⅓ up moves across by √½ of the
//! height.

use super::families::{Family, lines};
use super::{Layer, Pattern};
use isoslice_planar::border::LinePiece;
use std::f64::consts::FRAC_1_SQRT_2;

/// Three families that move with the height.
pub(super) struct Cubic;

impl Pattern for Cubic {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        // The normals point in three directions, 120° apart: moving all lines
        // along them by one length moves the cubes upwards.
        let families = [0.0, 120.0, 240.0].map(|turn| Family {
            turn,
            shift: -layer.z * FRAC_1_SQRT_2,
        });
        lines(layer, &families)
    }
}
