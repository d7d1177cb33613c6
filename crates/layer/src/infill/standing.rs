//! Infill that stands on nothing, left out.
//!
//! ```text
//!   ─┃ ○ ╭──────┃─   Where cells of two sizes blend into each other, some are
//!   ─┃   ╰──────┃─   closed like bubbles: seen from below they begin as a
//!   ─┃ ─────────┃─   ring (○) that neither lies on anything nor touches
//!   ─┃──────────┃─   anything in its layer. It would fall into the infill.
//! ```
//!
//! In: layers from below, as they are printed. Out: their infill without the
//! beads that nothing holds. A bubble is left out up to the layer where it
//! meets something that stands. Where cells blend, there are also rings and
//! lines hardly longer than they are wide. Each would be a dot beside its
//! travel, so a dot that touches nothing in its layer is left out, even if
//! something is below it. Dots of a user's own pattern are kept: they may be
//! meant.
//!
//! Patterns of one density have no such places. Patterns whose density varies,
//! and users' own patterns, may have them.

use super::InfillPlan;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Bead;
use isoslice_planar::grid::EdgeGrid;

/// Beads whose middles are within this share of their width of each other
/// hold each other.
const HELD: f64 = 0.75;
/// Beads shorter than this many widths are dots.
const DOT: f64 = 2.0;

/// What a layer's infill may stand on.
#[derive(Clone)]
pub struct Standing {
    reach: Mm,
    /// The beads of the layer below, if it is known.
    below: Option<EdgeGrid>,
    /// True if the pattern is a user's own.
    own: bool,
}

impl Standing {
    /// A check of infill, if the infill is of a kind that needs it.
    pub fn new(plan: &InfillPlan) -> Option<Standing> {
        let own = plan.is_own();
        let graded = plan.density.constant().is_none();
        (own || graded).then_some(Standing {
            reach: HELD * plan.width,
            below: None,
            own,
        })
    }

    /// Forgets the layer below. Everything in the next layer then counts as
    /// standing.
    pub fn forget(&mut self) {
        self.below = None;
    }

    /// True if all infill of a layer stands, whatever lies below it. `others` are
    /// the layer's other beads.
    pub fn is_needless<'a>(
        mut self,
        infill: &[Bead],
        others: impl Iterator<Item = &'a Bead> + Clone,
    ) -> bool {
        let nothing =
            EdgeGrid::of_lines(std::iter::empty::<Vec<DVec2>>(), self.reach);
        let mut count = |below: Option<EdgeGrid>| {
            self.below = below;
            self.kept(infill.to_vec(), others.clone()).len()
        };
        count(Some(nothing)) == count(None)
    }

    /// Takes the next layer, and leaves out the infill that stands on nothing.
    /// `others` are the layer's other beads.
    pub fn kept<'a>(
        &mut self,
        mut infill: Vec<Bead>,
        others: impl Iterator<Item = &'a Bead>,
    ) -> Vec<Bead> {
        if isoslice_base::limits::is_stopped() {
            return infill;
        }
        let below = self.below.take();
        let held = |bead: &Bead, by: &EdgeGrid| {
            let mut edges = bead.stroke.segments();
            edges.any(|(a, b)| !by.clear(a, b, self.reach))
        };
        let dot = |bead: &Bead| {
            !self.own && bead.stroke.length() < DOT * bead.stroke.width
        };
        let stands = |bead: &Bead| {
            !dot(bead) && below.as_ref().is_none_or(|below| held(bead, below))
        };
        let grid = |beads: &[&Bead]| {
            EdgeGrid::of_lines(
                beads.iter().map(|b| b.stroke.path()),
                self.reach,
            )
        };
        let mut kept: Vec<&Bead> = others.collect();
        let mut stays: Vec<bool> = infill.iter().map(stands).collect();
        kept.extend(infill.iter().zip(&stays).filter(|b| *b.1).map(|b| b.0));
        let mut here = grid(&kept);
        // A bead that touches a standing bead is held by it, and may hold more
        // beads.
        loop {
            let mut found = false;
            for (bead, stays) in infill.iter().zip(&mut stays) {
                if !*stays && held(bead, &here) {
                    (*stays, found) = (true, true);
                    kept.push(bead);
                }
            }
            if !found {
                break;
            }
            here = grid(&kept);
        }
        self.below = Some(here);
        let mut stays = stays.into_iter();
        infill.retain(|_| stays.next().unwrap_or(true));
        infill
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Ring;
    use isoslice_planar::bead::{Role, Stroke};
    use isoslice_planar::shapes::{self, circle, moved};
    use isoslice_settings::testing::{plan_with, usual_plan};
    use isoslice_settings::{Infill, Varying};

    fn graded() -> InfillPlan {
        InfillPlan {
            density: Varying::Expression("9+d".into()),
            ..usual_plan(InfillPlan::of)
        }
    }

    fn along(points: Ring, closed: bool) -> Bead {
        Bead::new(Role::SparseInfill, Stroke::new(points, closed, 0.45), 0.2)
    }

    fn bead(points: &[(f64, f64)]) -> Bead {
        along(shapes::ring(points), false)
    }

    fn ring(x: f64, radius: f64) -> Bead {
        along(moved(circle(radius, 40), x, 0.0), true)
    }

    #[test]
    fn a_bubble_begins_where_it_meets_something() {
        let mut standing = Standing::new(&graded()).unwrap();
        let wall = bead(&[(0.0, -9.0), (0.0, 9.0)]);
        let line = bead(&[(0.3, 5.0), (20.0, 5.0)]);
        let mut layer = |beads: &[Bead]| {
            let infill = [std::slice::from_ref(&line), beads].concat();
            let others = [&wall].into_iter();
            standing.kept(infill, others).len() - 1
        };
        // All of the first layer stands on the bed.
        assert_eq!(layer(&[ring(15.0, 1.0)]), 1);
        // The second ring stands on nothing, and what is printed above it does
        // not stand, either.
        assert_eq!(layer(&[ring(15.0, 1.2), ring(7.0, 0.3)]), 1);
        assert_eq!(layer(&[ring(15.0, 1.4), ring(7.0, 0.6)]), 1);
        // The ring stands once it meets the line.
        assert_eq!(layer(&[ring(15.0, 1.4), ring(7.0, 4.8)]), 2);
        assert_eq!(layer(&[ring(15.0, 1.4), ring(7.0, 4.9)]), 2);
        // A bead that begins at a wall is held by the wall, and holds what it
        // touches.
        let from_wall = bead(&[(0.3, -4.0), (3.0, -4.0)]);
        let beside = bead(&[(3.2, -4.0), (3.2, -8.0)]);
        let alone = bead(&[(13.2, -4.0), (13.2, -8.0)]);
        assert_eq!(layer(&[beside, from_wall, alone.clone()]), 2);
        standing.forget();
        let kept = standing.kept(vec![alone], [&wall].into_iter());
        assert_eq!(kept.len(), 1);
        assert!(Standing::new(&usual_plan(InfillPlan::of)).is_none());
    }

    #[test]
    fn a_dot_is_left_out_unless_it_touches_something() {
        let own = plan_with(InfillPlan::of, |s| {
            s.infill = Infill::Expression("x".into())
        });
        let line = bead(&[(0.0, 5.0), (20.0, 5.0)]);
        // On the line below: a ring, a short line and one that is longer.
        let ring = ring(5.0, 0.1);
        let raised = |mut bead: Bead| {
            bead.stroke.points.iter_mut().for_each(|p| p.y += 5.0);
            bead
        };
        let short = bead(&[(10.0, 4.9), (10.0, 5.5)]);
        let longer = bead(&[(15.0, 4.5), (15.0, 5.5)]);
        let dots = vec![raised(ring), short.clone(), longer.clone()];
        for (plan, left) in [(graded(), 1), (own, 3)] {
            let mut standing = Standing::new(&plan).unwrap();
            standing.kept(vec![line.clone()], [].into_iter());
            let kept = standing.kept(dots.clone(), [].into_iter());
            assert_eq!(kept.len(), left);
            // Beside a longer line, the short one is not alone.
            let beside = bead(&[(15.0, 4.0), (15.0, 6.0)]);
            let near = bead(&[(15.3, 4.9), (15.3, 5.5)]);
            let both = vec![beside, near];
            assert_eq!(standing.kept(both, [].into_iter()).len(), 2);
        }
    }
}
