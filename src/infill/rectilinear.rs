//! Parallel lines, turned by 90° from layer to layer.
//!
//! ```text
//!   even  ╱ ╱ ╱ ╱      odd  ╲ ╲ ╲ ╲
//!         ╱ ╱ ╱ ╱           ╲ ╲ ╲ ╲
//! ```

use super::{Params, Pattern};
use crate::plane::Area;
use crate::plane::hatch::{Lines, Segment, hatch};

/// Parallel lines.
pub(super) struct Rectilinear;

impl Pattern for Rectilinear {
    fn lines(&self, area: &Area, params: &Params) -> Vec<Segment> {
        let lines = Lines {
            angle: params.angle + 90.0 * (params.layer % 2) as f64,
            spacing: params.spacing,
            phase: 0.0,
        };
        hatch(area, lines, params.shortest)
    }
}
