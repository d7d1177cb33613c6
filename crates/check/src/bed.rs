//! The rules about heights that need no cells: beads of the first layer lie on
//! the bed, and nothing else leads the nozzle into what is printed.

use super::cells::cell_of;
use super::ground::{depth, strand};
use super::rules::ROUNDING;
use super::{Checker, FindingKind, place, sideways};
use isoslice_base::units::{Mm, Mm2};
use isoslice_gcode_read::reader::{Move, Role};

/// Least height of the nozzle above the bed while it prints. No layer is
/// thinner.
const THINNEST: Mm = 0.02;

/// Greatest air below a bead of the first layer: what unevenness of beds and
/// offsets in files make up. A bead that falls farther does not stick.
const AIR: Mm = 0.1;

/// Length of beads in the air, one after another, that tell something if the file does
/// not say how wide they are, mm. What leads from line to line is shorter: it is narrow,
/// and may be as high as it is wide.
const TELLING: Mm = 1.0;

impl Checker<'_> {
    /// Reports a bead of the first layer for which the nozzle scrapes over the
    /// bed, or which lies above it.
    pub(super) fn on_bed(&mut self, step: &Move, area: Mm2) {
        let rules = self.rules;
        // Beads that rise follow a surface, or begin a climbing wall.
        let level = step.from.z == step.to.z;
        let first = step.layer == self.lowest_layer && rules.base == 0.0;
        let before = std::mem::take(&mut self.air_below);
        if !level || !first || step.role == Role::Ironing {
            return;
        }
        let z = step.to.z;
        if z < THINNEST {
            self.verdict.add(FindingKind::OffBed, step.line, step.to, || {
                format!(
                    "the first layer is printed at z = {z:.3}, with the nozzle \
                     on the bed"
                )
            });
        }
        let nozzle = rules.nozzle;
        let air = z - depth(step, area, nozzle).min(strand(area, nozzle));
        if air <= AIR + ROUNDING {
            return;
        }
        self.air_below = before + step.length();
        if step.says_width || self.air_below > TELLING {
            self.verdict.add(FindingKind::OffBed, step.line, step.to, || {
                format!(
                    "a bead of the first layer at z = {z:.3} has {air:.2} mm of \
                     air between it and the bed"
                )
            });
        }
    }

    /// Reports a nozzle that goes down into what is printed.
    pub(super) fn dive(&mut self, step: &Move) {
        if sideways(step) || step.to.z >= step.from.z || !self.within(step) {
            return;
        }
        // Only the layers below count: a scarf begins where they end.
        let cell = cell_of(step.to.truncate());
        let Some((top, _)) = self.ground.below(cell) else {
            return;
        };
        let depth = top - step.to.z;
        // Beads side by side may differ in height, and share cells.
        if depth < 0.5 * self.rules.nozzle {
            return;
        }
        let why = format!(
            "the nozzle goes down into what is printed: to {}, where that \
             reaches up to {top:.3}",
            place(step.to)
        );
        self.verdict
            .add(self.ploughs(depth), step.line, step.to, || why);
    }

    /// What a nozzle does that is this deep in what is printed. Its width is more than
    /// any layer. A smaller depth leaves a mark.
    pub(super) fn ploughs(&self, depth: Mm) -> FindingKind {
        if depth > self.rules.nozzle + ROUNDING {
            FindingKind::Dive
        } else {
            FindingKind::Low
        }
    }
}
