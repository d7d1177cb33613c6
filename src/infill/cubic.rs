//! Cubes that stand on a corner: three families of planes at right angles to
//! each other, all equally steep, cut by the layer.
//!
//! ```text
//!    ╲  ╱ ╲  ╱       lines in three directions, as of triangles, which move
//!   ──╲╱───╲╱──      sideways from layer to layer; so the closed cells are
//!     ╱╲   ╱╲        closed upwards as well
//! ```
//!
//! A plane whose normal is √⅔ across and √⅓ up moves across by √½ of the
//! height.

use super::families::{Family, lines};
use super::{Layer, Pattern};
use crate::plane::border::Piece;
use std::f64::consts::FRAC_1_SQRT_2;

/// Three families that move with the height.
pub(super) struct Cubic;

impl Pattern for Cubic {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<Piece> {
        // The normals point three ways, 120° apart: to move all of them alike
        // is to move the cubes upwards.
        let families = [0.0, 120.0, 240.0].map(|turn| Family {
            turn,
            of: 3.0,
            shift: -layer.z * FRAC_1_SQRT_2,
            phase: 1.0,
        });
        lines(layer, &families)
    }
}
