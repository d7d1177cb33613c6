//! Distances from convex outlines in a plane.
//!
//! Inside, the distance is that from the line of the nearest side. Outside, it
//! is the greatest of the distances from the lines, unless the nearest point is
//! a corner. Beyond a corner, let u be the greater of the distances from the
//! lines of its two sides, and v how far the foot on that line lies past the
//! corner: the distance is √(u² + v²). If the foot lies past both ends, v is
//! the lesser of the two ways; if it lies on the side, v is 0. Written as u +
//! v² / (√(u² + v²) + |u|) the distance has a gradient everywhere, where √
//! alone would have none on the outline.

use fidget::context::Tree;
use glam::DVec2;
use isoslice_planar::hull;

/// The distance for the `u` and `v` of the module's head.
fn cornered(u: &Tree, v: &Tree) -> Tree {
    /// Keeps the root away from zero. It is far less than what f32 tells apart.
    const LEAST: f32 = 1e-12;
    let v2 = v.square();
    let root = (u.square() + v2.clone() + LEAST).sqrt();
    u.clone() + v2 / (root + u.abs())
}

/// What is in both of two bodies. It is exact if their faces are at right
/// angles.
pub(super) fn corner(a: Tree, b: Tree) -> Tree {
    let u = a.max(b.clone());
    let v = a.min(b).max(0.0);
    cornered(&u, &v)
}

/// Distance from the region on the left of a line through `points`, which turns
/// left only. A line that is open begins and ends on a line of symmetry.
pub(super) fn convex(
    points: &[[f64; 2]],
    closed: bool,
    x: &Tree,
    y: &Tree,
) -> Tree {
    let count = points.len();
    let mut sides = Vec::new();
    for i in 0..if closed { count } else { count - 1 } {
        let ([ax, ay], [bx, by]) = (points[i], points[(i + 1) % count]);
        let (dx, dy) = (bx - ax, by - ay);
        let length = dx.hypot(dy);
        if length > 0.0 {
            let (tx, ty) = (dx / length, dy / length);
            let along = |px: f64, py: f64| -> Tree {
                let k = tx * px + ty * py;
                x.clone() * tx as f32 + y.clone() * ty as f32 - k as f32
            };
            sides.push(PolygonSide {
                off: x.clone() * ty as f32
                    - y.clone() * tx as f32
                    - (ty * ax - tx * ay) as f32,
                before: -along(ax, ay),
                after: along(bx, by),
            });
        }
    }
    let off = sides.iter().map(|side| side.off.clone());
    let u = off.reduce(|a, b| a.max(b));
    let mut past = Vec::new();
    for (i, side) in sides.iter().enumerate() {
        match sides.get(i + 1).or(closed.then(|| &sides[0])) {
            Some(next) => past.push(side.after.min(next.before.clone())),
            None => past.push(side.after.clone()),
        }
    }
    let v = past.into_iter().reduce(|a, b| a.max(b));
    match (u, v) {
        (Some(u), Some(v)) => cornered(&u, &v.max(0.0)),
        _ => Tree::constant(f32::INFINITY),
    }
}

struct PolygonSide {
    /// Distance from the side's line, positive on its right.
    off: Tree,
    /// How far a point lies before the side's beginning, and past its end, along
    /// the side.
    before: Tree,
    after: Tree,
}

/// Twice the area of a polygon, positive if the polygon turns left.
pub(super) fn area(points: &[[f64; 2]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    let cross = |(a, b): (&[f64; 2], &[f64; 2])| a[0] * b[1] - a[1] * b[0];
    points.iter().zip(next).map(cross).sum()
}

/// Two sides of a polygon that cross, by the numbers of their first corners.
pub(super) fn crossing(points: &[[f64; 2]]) -> Option<[usize; 2]> {
    let n = points.len();
    let side = |i: usize| (points[i % n], points[(i + 1) % n]);
    // On which side of a line a point is: 1, -1, or 0.
    let turn = |([ax, ay], [bx, by]): ([f64; 2], [f64; 2]),
                [x, y]: [f64; 2]| {
        let cross = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
        // What rounding may make of a point on the line.
        let far = ax.abs().max(ay.abs()).max(x.abs()).max(y.abs());
        let off = 1e-12 * (bx - ax).hypot(by - ay) * far;
        i32::from(cross > off) - i32::from(cross < -off)
    };
    let cross = |i: usize, j: usize| {
        let (a, b) = (side(i), side(j));
        turn(a, b.0) * turn(a, b.1) < 0 && turn(b, a.0) * turn(b, a.1) < 0
    };
    let pairs = (0..n).flat_map(|i| (i + 2..n).map(move |j| [i, j]));
    pairs.into_iter().find(|[i, j]| cross(*i, *j))
}

/// The region within a simple polygon that turns left: its hull without its
/// pockets, each of which is a polygon, too. The field is a distance only where
/// the polygon is convex. (S. Tor, A. Middleditch: Convex decomposition of
/// simple polygons, ACM Transactions on Graphics 3(4), 1984.)
pub(super) fn polygon(
    points: &[[f64; 2]],
    x: &Tree,
    y: &Tree,
    depth: usize,
) -> Result<Tree, String> {
    /// Greatest depth of pockets within pockets.
    const DEEPEST: usize = 16;
    if depth > DEEPEST {
        return Err("the polygon is wound up too deeply".to_owned());
    }
    let hull = corners_of_hull(points);
    if hull.len() < 3 {
        return Err("the polygon crosses itself, or has no area".to_owned());
    }
    let corners: Vec<_> = hull.iter().map(|&i| points[i]).collect();
    let mut body = convex(&corners, true, x, y);
    for (k, &from) in hull.iter().enumerate() {
        let to = hull[(k + 1) % hull.len()];
        let between = (to + points.len() - from) % points.len();
        if between < 2 {
            continue;
        }
        let mut pocket: Vec<_> = (0..=between)
            .map(|i| points[(from + i) % points.len()])
            .collect();
        // The pocket is on the other side of the line, so it turns the other
        // way.
        pocket.reverse();
        if area(&pocket) > 0.0 {
            let pocket = polygon(&pocket, x, y, depth + 1)?;
            body = body.max(-pocket);
        }
    }
    Ok(body)
}

/// The corners of the hull in the polygon's own order.
fn corners_of_hull(points: &[[f64; 2]]) -> Vec<usize> {
    let hull = hull(points.iter().map(|&p| p.into()));
    let index =
        |corner: &DVec2| points.iter().position(|p| *p == corner.to_array());
    let mut all: Vec<usize> = hull.iter().filter_map(index).collect();
    all.sort_unstable();
    all.dedup();
    all
}
