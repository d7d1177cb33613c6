//! Whether segments meet, exactly.
//!
//! In: segments. Out: whether they share a point. Touching counts as meeting:
//! an end on the other segment, two ends in one place, or a stretch in common.
//! The answer is that of exact arithmetic on the given coordinates (J. R.
//! Shewchuk, *Adaptive precision floating-point arithmetic and fast robust
//! geometric predicates*, 1997), and does not depend on the order of the
//! segments or of their ends.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;

/// How far around a segment edges are looked for, mm. It is more than rounding
/// errors.
const LOOK: Mm = 1e-6;

/// True if the segments a–b and c–d have a point in common.
pub(super) fn meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let apart = a.min(b).cmpgt(c.max(d)) | c.min(d).cmpgt(a.max(b));
    if apart.any() {
        return false;
    }
    let (c_side, d_side) = (side(a, b, c), side(a, b, d));
    if c_side * d_side > 0.0 {
        return false;
    }
    let (a_side, b_side) = (side(c, d, a), side(c, d, b));
    // If all points are on one line the products are zero, and the boxes have
    // decided.
    a_side * b_side <= 0.0
}

/// 1 if `p` is to the left of the line from `a` to `b`, −1 if to the right, 0
/// if on it.
fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    let turn = robust::orient2d(coord(a), coord(b), coord(p));
    if turn == 0.0 { 0.0 } else { turn.signum() }
}

/// True if an edge of the grid meets the way through `points`.
pub(super) fn meets(grid: &EdgeGrid, points: &[DVec2]) -> bool {
    points.windows(2).any(|p| {
        let mut found = false;
        grid.visit_edges_near(p[0], p[1], LOOK, |edge| {
            let (c, d) = grid.edge(edge);
            found = found || meet(p[0], p[1], c, d);
        });
        found
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    /// True if the segments meet. The answer must not depend on the order in
    /// which they are given.
    fn met(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
        let first = meet(a, b, c, d);
        for (p, q) in [(a, b), (b, a)] {
            for (r, s) in [(c, d), (d, c)] {
                assert_eq!(meet(p, q, r, s), first);
                assert_eq!(meet(r, s, p, q), first);
            }
        }
        first
    }

    #[test]
    fn crossing_touching_and_apart() {
        let (o, e) = (at(0.0, 0.0), at(4.0, 0.0));
        assert!(met(o, e, at(1.0, -1.0), at(2.0, 1.0)));
        // An end on the other segment's middle, and on its end.
        assert!(met(o, e, at(1.0, 0.0), at(2.0, 1.0)));
        assert!(met(o, e, at(4.0, 0.0), at(5.0, 7.0)));
        assert!(!met(o, e, at(1.0, 1e-15), at(2.0, 1.0)));
        // The line is met, the segment is not.
        assert!(!met(o, e, at(5.0, -1.0), at(5.0, 1.0)));
        assert!(!met(o, e, at(0.0, 1.0), at(4.0, 2.0)));
    }

    #[test]
    fn on_one_line() {
        let (o, e) = (at(0.0, 0.0), at(4.0, 2.0));
        assert!(met(o, e, at(2.0, 1.0), at(6.0, 3.0)));
        assert!(met(o, e, at(1.0, 0.5), at(2.0, 1.0)));
        assert!(met(o, e, e, at(6.0, 3.0)));
        assert!(met(o, e, o, e));
        assert!(!met(o, e, at(4.2, 2.1), at(6.0, 3.0)));
        // Points are segments, too.
        assert!(met(o, e, at(2.0, 1.0), at(2.0, 1.0)));
        assert!(!met(o, e, at(2.0, 1.1), at(2.0, 1.1)));
    }

    #[test]
    fn rounding_does_not_decide() {
        // 0.1 + 0.2 is not 0.3: a third point that is just off the line.
        let (a, b) = (at(0.0, 0.0), at(3.0, 3.0));
        let off = at(0.3, 0.1 + 0.2);
        assert!(off.x != off.y);
        assert!(!met(a, b, off, at(0.0, 3.0)));
        assert!(met(a, b, off, at(3.0, 0.0)));
    }
}
