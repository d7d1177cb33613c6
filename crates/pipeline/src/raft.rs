//! A raft: layers of their own between the bed and the part.
//!
//! ```text
//!          █████████         part
//!          ┄┄┄┄┄┄┄┄┄         raft.gap
//!        ▓▓▓▓▓▓▓▓▓▓▓▓▓       solid layers, from the second on
//!        ░ ░ ░ ░ ░ ░ ░       a thick layer of wide lines, with air between them
//!   ─────────────────────
//! ```
//!
//! In: what the part and its supports have in the first layers above the raft.
//! Out: the beads of the raft's layers. They count as layers of the print from
//! the bed up, in which the part has no outline.

use super::supported::{Fills, SupportFill};
use isoslice_base::units::{Mm, Percent};
use isoslice_layer::infill::InfillError;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::clip::{crop, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Rect};
use isoslice_settings::layers::LayerSpan;

/// Share of the first layer that is printed.
const SPARSE: Percent = 50.0;
/// Tolerance of the raft's border, mm.
const TOLERANCE: Mm = 0.02;
/// Gaps in the raft narrower than this are closed, mm.
const CLOSED: Mm = 4.0;

/// The raft of a print.
pub(super) struct Raft<'a> {
    /// Where the raft is.
    pub area: Area,
    base: SupportFill<'a>,
    solid: SupportFill<'a>,
}

impl<'a> Raft<'a> {
    /// The raft under what a part and its supports have above it.
    pub(super) fn new(
        under: &Area,
        bed: Rect,
        fills: &Fills<'_, 'a>,
    ) -> Result<Raft<'a>, InfillError> {
        let plan = &fills.plans.raft;
        let reach = plan.expansion + 0.5 * CLOSED;
        let wide = offset(under, reach, TOLERANCE);
        let area = offset(&wide, -0.5 * CLOSED, TOLERANCE);
        // The raft keeps to the part of the bed that supports may use.
        let area = unite(&crop(&area.rings, bed));
        let [base, solid] = plan.widths;
        let base = fills.lines(base, SPARSE);
        let solid = fills.lines(solid, 100.0);
        Ok(Raft {
            area,
            base: fills.fill(base, Role::Support)?,
            solid: fills.fill(solid, Role::SupportInterface)?,
        })
    }

    /// The beads of one of the raft's layers.
    pub(super) fn beads(
        &self,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        let fill = match span.index {
            0 => &self.base,
            _ => &self.solid,
        };
        fill.beads(&self.area, span)
    }
}
