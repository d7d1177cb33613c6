//! Bends: places where a strip is thicker for a while, and one bead still fills
//! it.
//!
//! ```text
//!     ━━━━━━━╮        The outer border of a bend often has no larger radius
//!     ━━━━╮ ◯ ╲       than the inner one, so the ball in the bend is larger
//!          ╲   ┃      than those before it and behind it. Two walls would be
//!           ┃  ┃      too short to print there.
//! ```
//!
//! In: a part of an axis, the border, and where axes end. Out: whether balls
//! along the part reach the border everywhere. In a corner balls do not reach
//! the border everywhere, and where strips meet they leave what lies between to
//! other axes.

use super::medial_axis::Axis;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::{EdgeGrid, nearest_on};

/// How far balls may stay away from the border beside them, mm: what is open
/// there is less than what short walls leave in a bend (measured on sheets of
/// noise; 0.06 opens corners of letters).
const OPEN: Mm = 0.03;

/// True if balls along the part of an axis fill the area beside it, up to the
/// border `grid`, and no other axis ends there, as one of `nodes`.
pub(super) fn is_bend(part: &Axis, grid: &EdgeGrid, nodes: &EdgeGrid) -> bool {
    let reach = 0.5 * part.thickest() + 2.0 * OPEN;
    let mut is_free = true;
    for w in part.points.windows(2) {
        nodes.visit_edges_near(w[0], w[1], reach, |_| is_free = false);
        grid.visit_edges_near(w[0], w[1], reach, |edge| {
            let (a, b) = grid.edge(edge);
            is_free = is_free && is_reached(a, part) && is_reached(b, part);
        });
        if !is_free {
            break;
        }
    }
    is_free
}

/// True if a ball along the part reaches the place, or if the place lies beyond
/// one of the part's ends, where other balls may reach it.
fn is_reached(p: DVec2, part: &Axis) -> bool {
    let n = part.points.len();
    let gaps = part.points.windows(2).enumerate().map(|(i, w)| {
        let q = nearest_on(p, w[0], w[1]);
        let length = w[0].distance(w[1]);
        let t = if length > 0.0 {
            q.distance(w[0]) / length
        } else {
            0.0
        };
        let (a, b) = (part.thickness[i], part.thickness[i + 1]);
        let gap = p.distance(q) - 0.5 * (a + t * (b - a));
        let is_beyond = (i == 0 && t <= 0.0) || (i + 2 == n && t >= 1.0);
        (gap, is_beyond)
    });
    gaps.min_by(|a, b| a.0.total_cmp(&b.0))
        .is_some_and(|(gap, is_beyond)| is_beyond || gap <= OPEN)
}

#[cfg(test)]
mod tests {
    use super::super::walls;
    use super::*;
    use crate::walls::WallPlan;
    use isoslice_planar::Area;
    use isoslice_settings::testing::usual_plan;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A strip, `thick` mm, that turns by a right angle, with round borders that
    /// are `inner` and `outer` mm from the middles of their arcs.
    fn bent(thick: f64, inner: f64, outer: f64) -> Area {
        let limb = 12.0;
        let arc = |centre: DVec2, radius: f64, from: f64, to: f64| {
            (0..=200).map(move |i| {
                let angle = from + (to - from) * f64::from(i) / 200.0;
                centre + DVec2::from_angle(angle) * radius
            })
        };
        let mut ring = vec![DVec2::new(-limb, -thick)];
        let corner = DVec2::new(-inner, -thick - inner);
        ring.extend(arc(corner, inner, FRAC_PI_2, 0.0));
        ring.extend([DVec2::new(0.0, -limb), DVec2::new(thick, -limb)]);
        let corner = DVec2::new(thick - outer, -outer);
        ring.extend(arc(corner, outer, 0.0, FRAC_PI_2));
        ring.push(DVec2::new(-limb, 0.0));
        Area::from(ring)
    }

    fn strokes(area: &Area) -> (usize, usize) {
        let w = walls(area, None, 0.2, &usual_plan(WallPlan::of));
        (w.lines[0].len(), w.thin[0].len())
    }

    #[test]
    fn one_bead_goes_through_a_bend() {
        // The ball in the bend is 0.99 mm large.
        let bend = bent(0.75, 0.4, 0.6);
        assert_eq!(strokes(&bend), (0, 1));
        let w = walls(&bend, None, 0.2, &usual_plan(WallPlan::of));
        let widest = w.thin[0][0].widths.iter().copied().fold(0.0, f64::max);
        assert!(widest > 0.9, "{widest}");
    }

    #[test]
    fn walls_go_into_a_corner_and_out_of_it() {
        // The ball in the corner is 0.92 mm large, too much for a single bead,
        // and 0.17 mm from the tip.
        let (lines, _) = strokes(&bent(0.8, 0.05, 0.05));
        assert!(lines > 0);
    }

    #[test]
    fn balls_reach_all_of_a_strip_but_not_its_corner() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let part = |points: Vec<DVec2>| Axis {
            thickness: vec![0.8; points.len()],
            points,
            closed: false,
        };
        let strip = bent(0.75, 3.0, 3.75);
        let border = EdgeGrid::new(&strip, 1.0);
        let centre = at(-3.0, -3.75);
        let ring = |i: u32| DVec2::from_angle(PI * f64::from(i) / 80.0);
        let arc = (5..35).map(|i| centre + ring(i) * 3.375).collect();
        let none = EdgeGrid::of(std::iter::empty(), 1.0);
        assert!(is_bend(&part(arc), &border, &none));
        let corner = vec![at(-2.0, -0.4), at(0.35, -0.4), at(0.35, -2.0)];
        let sharp = bent(0.75, 0.01, 0.01);
        let border = EdgeGrid::new(&sharp, 1.0);
        assert!(!is_bend(&part(corner.clone()), &border, &none));
        // A strip that ends beside the part makes it no bend.
        let node = EdgeGrid::of(
            [(0, (at(0.3, -0.4), at(0.3, -0.4)))].into_iter(),
            1.0,
        );
        let wide = Area::from(vec![
            at(-9.0, -9.0),
            at(9.0, -9.0),
            at(9.0, 9.0),
            at(-9.0, 9.0),
        ]);
        let border = EdgeGrid::new(&wide, 1.0);
        assert!(is_bend(&part(corner.clone()), &border, &none));
        assert!(!is_bend(&part(corner), &border, &node));
    }
}
