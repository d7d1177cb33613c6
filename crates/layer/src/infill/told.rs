//! What the user should know of infill of their own shape.
//!
//! In: what is counted in each layer. Out: warnings. Nobody needs to know of beads
//! that are left out of the shipped patterns, and these have lines everywhere.

use super::InfillPlan;
use isoslice_base::units::Mm2;
use isoslice_planar::bead::{Bead, Role};

/// Room for infill from which on it is told that a shape has no line there, mm² in all
/// layers together. Usual cells are smaller than 20 mm by 20 mm: less room may lie
/// between two lines.
const ROOM: Mm2 = 400.0;

/// What is counted of infill.
#[derive(Clone, Copy, Debug, Default)]
pub struct InfillCount {
    left_out: usize,
    beads: usize,
    room: Mm2,
}

impl InfillCount {
    /// Counts a layer's beads of infill, and the area that has room for them.
    /// `left_out` of them stand on nothing.
    pub fn new<'b>(
        left_out: usize,
        beads: impl Iterator<Item = &'b Bead>,
        room: Mm2,
    ) -> InfillCount {
        let infill = |bead: &&Bead| bead.role == Role::SparseInfill;
        InfillCount {
            left_out,
            beads: beads.filter(infill).count(),
            room,
        }
    }

    /// Adds what another layer has.
    pub fn add(&mut self, other: InfillCount) {
        self.left_out += other.left_out;
        self.beads += other.beads;
        self.room += other.room;
    }

    /// What the user should know. `whole` is true if all of a part's layers are counted.
    pub fn warnings(self, plan: &InfillPlan, whole: bool) -> Vec<String> {
        let mut all = Vec::new();
        if !plan.is_own() {
            return all;
        }
        if self.left_out > 0 {
            all.push(format!(
                "beads of the infill's shape that lie on nothing and touch \
                 nothing in their layer are left out: {}",
                self.left_out
            ));
        } else if whole && self.beads == 0 && self.room > ROOM {
            let nowhere = if plan.solid { "negative" } else { "0" };
            all.push(format!(
                "the infill's shape has no line anywhere in the part, which \
                 stays hollow: its expression is nowhere {nowhere}, or has no \
                 value, where there is room for infill ({:.0} mm² in all \
                 layers together)",
                self.room
            ));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::Stroke;
    use isoslice_settings::testing::usual_plan;

    #[test]
    fn an_own_shape_without_a_line_is_told() {
        let own = InfillPlan {
            pattern: isoslice_settings::Infill::Expression("0/0".into()),
            ..usual_plan(InfillPlan::of)
        };
        let bead = Bead::new(
            Role::SparseInfill,
            Stroke::new(Vec::new(), false, 0.45),
            0.2,
        );
        let told = |beads: &[Bead], room: f64, plan: &InfillPlan| {
            let mut all = InfillCount::new(0, beads.iter(), 0.5 * room);
            all.add(InfillCount::new(0, [].iter(), 0.5 * room));
            all.warnings(plan, true)
        };
        let [only] = &told(&[], 500.0, &own)[..] else {
            panic!("one warning");
        };
        assert!(only.contains("stays hollow") && only.contains("500"));
        assert!(told(&[bead], 500.0, &own).is_empty());
        assert!(told(&[], 300.0, &own).is_empty());
        assert!(told(&[], 500.0, &usual_plan(InfillPlan::of)).is_empty());
    }
}
