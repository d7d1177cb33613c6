//! What runs around a solid area: a ring, and beads in places too thin for
//! lines inside it.
//!
//! ```text
//!   ╭───────────────────╮
//!   │ ╭──────╮─ ─ ─ ─ ─ │   the ring; left, room for lines; right, one bead
//!   │ ╰──────╯─ ─ ─ ─ ─ │   as wide as what the ring leaves; where that is
//!   ╰───────────────────╯   too thin for a bead, the ring grows wider
//! ```
//!
//! In: an area. Out: the ring's lines, the beads in thin places, and what is
//! left for lines. Together they leave nothing open that is wider than the
//! thinnest bead.

use super::beading::Beadings;
use super::line::absorb;
use super::medial_axis::Axis;
use super::shared::without_slivers;
use super::{Lay, Skeleton, cell, joined, shrink};
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::{Area, Solid};

/// The beads around a solid area.
pub struct Patch {
    /// The ring, cut where a bead runs in the middle.
    pub rings: Vec<Stroke>,
    /// Beads in places too thin for two sides of the ring, or for lines
    /// between them.
    pub thin: Vec<Stroke>,
    /// The ring whole.
    pub whole: Area,
    /// What is between two sides of the ring, which are wider for it.
    slivers: Vec<Axis>,
}

/// Lays the beads around a solid area.
pub fn patch(area: &Area, plan: Lay, tolerance: Mm) -> Patch {
    let beadings = Beadings::new(&[plan, plan], None);
    let solid = Solid::of(area, cell(area));
    let skeleton = Skeleton::new(&solid, beadings.limit(), tolerance);
    let places = skeleton.thin_places(&beadings);
    let whole = skeleton.shrunk(plan.centre, tolerance);
    let single = places.beads(1, 0.0);
    let rings = places.cut(&whole, 0, 0.0, &plan);
    let slivers = places.beads(2, plan.inner);
    let core = places.beads(3, plan.inner);
    let away = plan.inner - plan.centre;
    let thin = single.iter().chain(&core);
    let (rings, thin) = joined(
        absorb(rings, &slivers, away, tolerance),
        thin.map(|r| r.stroke(plan.extra)).collect(),
        skeleton.solid,
        0.0,
        plan.extra,
        true,
    );
    Patch {
        rings,
        thin,
        whole,
        slivers,
    }
}

impl Patch {
    /// The area that lies more than `distance` inside the ring's centre line, and
    /// beside the ring where it is wider than it was laid.
    pub fn inside(&self, distance: Mm, lay: Lay, tolerance: Mm) -> Area {
        let inside = shrink(&self.whole, distance, tolerance);
        without_slivers(inside, &self.slivers, &lay, 0.0)
    }
}

/// Rings inside one another that fill an area, the outermost first, and the
/// beads of places too thin for them.
pub fn concentric(area: &Area, plan: Lay, tolerance: Mm) -> Vec<Stroke> {
    let mut beadings = Beadings::new(&[plan, plan], Some(plan));
    let away = plan.inner - plan.centre;
    let mut area = area.clone();
    let mut strokes: Vec<Stroke> = Vec::new();
    loop {
        if isoslice_base::limits::is_stopped() {
            return strokes;
        }
        // Two rings at a time, as walls.
        let solid = Solid::of(&area, cell(&area));
        let skeleton = Skeleton::new(&solid, beadings.limit(), tolerance);
        let places = skeleton.thin_places(&beadings);
        let mut depth = 0.0;
        let mut shared = Vec::new();
        // Most areas are thin: where nothing is left, nothing lies deeper.
        let mut ends = false;
        let mut shrunk = |depth: Mm| {
            let inner = if ends {
                Area::EMPTY
            } else {
                skeleton.shrunk(depth, tolerance)
            };
            ends = inner.is_empty();
            inner
        };
        for k in 0..2 {
            let rings = shrunk(depth + plan.centre);
            let beads = places.beads(2 * k + 1, depth);
            let rings = places.cut(&rings, k, depth, &plan);
            let slivers = places.beads(2 * k + 2, depth + plan.inner);
            let (rings, thin) = joined(
                absorb(rings, &slivers, away, tolerance),
                beads.iter().map(|r| r.stroke(plan.extra)).collect(),
                skeleton.solid,
                depth,
                plan.extra,
                true,
            );
            strokes.extend(rings);
            strokes.extend(thin);
            depth += plan.inner;
            shared = slivers;
        }
        let left = shrunk(depth);
        let left = without_slivers(left, &shared, &plan, tolerance);
        // What a hole leaves on its own would grow, not shrink.
        if !(0.0..area.content()).contains(&left.content()) || left.is_empty() {
            return strokes;
        }
        area = left;
        beadings = Beadings::new(&[plan.after(tolerance), plan], Some(plan));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::ThinPlan;
    use crate::walls::content_of;
    use glam::DVec2;
    use isoslice_planar::shapes::{disc, rect};
    use isoslice_settings::testing::usual_plan;

    fn strip(thickness: f64) -> Patch {
        let ring = [(0.0, 0.0), (20.0, 0.0), (20.0, 1.0), (0.0, 1.0)]
            .map(|(x, y)| DVec2::new(x, y * thickness))
            .to_vec();
        let plan = Lay::inside(0.45, 0.2, usual_plan(ThinPlan::of));
        patch(&Area::from(ring), plan, 0.01)
    }

    #[test]
    fn rings_fill_a_disc() {
        let plan = Lay::inside(0.45, 0.2, usual_plan(ThinPlan::of));
        let area = disc(5.0, 400);
        let rings = concentric(&area, plan, 0.01);
        let space = 2.0 * plan.centre;
        let filled: f64 = rings
            .iter()
            .map(|l| l.length() * (l.width - plan.extra))
            .sum();
        assert_eq!(rings.len(), (5.0 / space) as usize);
        assert!((filled / area.content() - 1.0).abs() < 0.01, "{filled}");
    }

    /// What rings become wider for has no bead of its own, however thick the bar is.
    #[test]
    fn nothing_of_a_bar_is_filled_twice() {
        let plan = Lay::inside(0.45, 0.2, usual_plan(ThinPlan::of));
        for k in 0..120 {
            let half = 0.5 + 0.005 * f64::from(k);
            let bar = rect(-9.0, -half, 9.0, half);
            let rings = concentric(&bar, plan, 0.01);
            let laid: f64 =
                rings.iter().map(|l| content_of(l, plan.extra)).sum();
            let share = laid / bar.content();
            assert!((0.97..1.02).contains(&share), "{half}: {share}");
        }
    }

    /// Lines lie beside a ring where it is wider, and not on it.
    #[test]
    fn what_is_inside_a_ring_begins_beside_it() {
        let plan = Lay::inside(0.45, 0.2, usual_plan(ThinPlan::of));
        // Thinner slivers are left, but no line fits into them.
        for k in 0..50 {
            let half = 0.51 + 0.01 * f64::from(k);
            let bar = rect(-9.0, -half, 9.0, half);
            let around = patch(&bar, plan, 0.01);
            let inside = around.inside(plan.centre, plan, 0.01).content();
            let beads = around.rings.iter().chain(&around.thin);
            let laid: f64 = beads.map(|l| content_of(l, plan.extra)).sum();
            let cores: f64 =
                around.thin.iter().map(|l| content_of(l, plan.extra)).sum();
            let share = (laid + inside - cores) / bar.content();
            assert!((0.95..1.08).contains(&share), "{half}: {share}");
        }
    }

    #[test]
    fn a_hole_on_its_own_comes_to_an_end() {
        let hole = [(0.0, 0.0), (0.0, 2.0), (2.0, 2.0), (2.0, 0.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let plan = Lay::inside(0.45, 0.2, usual_plan(ThinPlan::of));
        let alone = Area::from(hole);
        assert!(concentric(&alone, plan, 0.01).len() < 9);
    }

    #[test]
    fn what_a_ring_leaves_of_a_strip_is_filled() {
        // The ring's two sides take 0.814 mm.
        let wide = strip(4.0);
        assert!(wide.thin.is_empty() && wide.rings[0].widths.is_empty());
        assert_eq!(wide.rings.len(), 1);
        // 0.486 mm are left: one bead as wide, and its round ends.
        let one = strip(1.3);
        assert_eq!(one.thin.len(), 1);
        assert!((one.thin[0].width - 0.486 - 0.043).abs() < 0.003);
        // 0.156 mm: the ring's sides share it.
        let shared = strip(0.97);
        assert!(shared.thin.is_empty());
        let widest = |l: &Stroke| l.widths.iter().copied().fold(0.0, f64::max);
        let width = widest(&shared.rings[0]);
        assert!((width - 0.45 - 0.078).abs() < 0.003, "{width}");
    }
}
