//! Lines in both directions in every layer, the same in all: square tubes.
//!
//! ```text
//!   ╱╲╱╲╱╲
//!   ╲╱╲╱╲╱
//! ```

use super::{Params, Pattern};
use crate::plane::Area;
use crate::plane::hatch::{Lines, Segment, hatch};

/// Crossing lines.
pub(super) struct Grid;

impl Pattern for Grid {
    fn lines(&self, area: &Area, params: &Params) -> Vec<Segment> {
        // Half the lines in each direction.
        let along = |angle| Lines {
            angle,
            spacing: 2.0 * params.spacing,
            phase: 0.0,
        };
        let mut lines = hatch(area, along(params.angle), params.shortest);
        let across = along(params.angle + 90.0);
        lines.extend(hatch(area, across, params.shortest));
        lines
    }
}
