//! Distances and crossings of single segments.

use glam::DVec2;

/// True if the box around the segment from `c` to `d` meets the box from `lo`
/// to `hi`.
#[inline]
pub(super) fn box_meets(c: DVec2, d: DVec2, lo: DVec2, hi: DVec2) -> bool {
    (c.x <= hi.x || d.x <= hi.x)
        && (c.x >= lo.x || d.x >= lo.x)
        && (c.y <= hi.y || d.y <= hi.y)
        && (c.y >= lo.y || d.y >= lo.y)
}

/// True if two segments come closer to each other than the root of `limit`.
#[inline]
pub(super) fn closer(
    a: DVec2,
    b: DVec2,
    c: DVec2,
    d: DVec2,
    limit: f64,
) -> bool {
    let (u, v) = (b - a, d - c);
    let (ac, ad, cb) = (c - a, d - a, b - c);
    // One segment lies on one side of the other's line, and farther away than
    // asked. This is so for nearly all segments whose boxes are near each
    // other.
    let apart = |s: f64, t: f64, length: f64| {
        s * t > 0.0 && s * s > limit * length && t * t > limit * length
    };
    let (s0, s1) = (u.perp_dot(ac), u.perp_dot(ad));
    let uu = u.length_squared();
    if apart(s0, s1, uu) {
        return false;
    }
    let (t0, t1) = (ac.perp_dot(v), v.perp_dot(cb));
    let vv = v.length_squared();
    if apart(t0, t1, vv) {
        return false;
    }
    if s0 * s1 < 0.0 && t0 * t1 < 0.0 {
        return limit > 0.0;
    }
    // True if an end of one segment is near the other segment. `end` is the way
    // to it from the other's beginning, `along` the other segment, `length` the
    // square of its length, and `side` its length times the end's distance from
    // its line.
    let near = |end: DVec2, along: DVec2, side: f64, length: f64| {
        let t = end.dot(along);
        if t <= 0.0 {
            end.length_squared() < limit
        } else if t >= length {
            (end - along).length_squared() < limit
        } else {
            side * side < limit * length
        }
    };
    near(ac, u, s0, uu)
        || near(ad, u, s1, uu)
        || near(-ac, v, t0, vv)
        || near(cb, v, t1, vv)
}

/// True if `p` is strictly to the left of the line from `a` to `b`; exact (J.
/// R. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust
/// geometric predicates*, 1997).
pub(super) fn is_left(a: DVec2, b: DVec2, p: DVec2) -> bool {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(p)) > 0.0
}

/// Where on a–b (0 to 1) it meets c–d, if it does.
pub(super) fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<f64> {
    let (u, v) = (b - a, d - c);
    let det = u.perp_dot(v);
    if det == 0.0 {
        return None;
    }
    let t = (c - a).perp_dot(v) / det;
    let s = (c - a).perp_dot(u) / det;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
}
