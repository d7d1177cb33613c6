//! Cuts rings where they cross themselves or each other.
//!
//! ```text
//!    ──────╲ ╱──╲         Near a tip whose sides meet at a few degrees, the
//!           ╳    tip      points found on them may lie on the wrong side of
//!    ──────╱ ╲──╱         each other. The ring is led on at the crossing.
//! ```
//!
//! At each crossing the lines change partners: each goes on where the other one
//! would have gone on. A loop that results stays if it has the part on its left
//! and nothing on its right, by the rings' winding number. So rings that
//! overlap become one, and rings turned inside out are dropped.

use super::buckets::each_pair;
use super::link::Joined;
use crate::plane::edges;
use glam::DVec2;

/// Greatest number of crossings. Rings with more are not just a tip that went
/// wrong, and are left as they are.
const CROSSINGS: usize = 256;
/// Distance below which a line is the loop itself, mm.
const ITSELF: f64 = 1e-9;

/// A crossing on an edge: the edge's ring, its number in the ring, the place
/// along the edge from 0 to 1, and the crossing's number.
type On = (usize, usize, f64, usize);

/// The loops that result from rings that cross themselves or each other without
/// thinning. `None` if they do not cross, or cross in very many places.
/// `tangled` is true for each ring to look at. Loops are in the order of the
/// rings on which they begin.
pub(super) fn at_crossings(
    rings: &[Joined],
    tangled: &[bool],
) -> Option<Vec<Joined>> {
    let some = || (0..rings.len()).filter(|&n| tangled[n]);
    let list: Vec<(usize, usize, DVec2, DVec2)> = some()
        .flat_map(|n| {
            let numbered = edges(&rings[n].points).enumerate();
            numbered.map(move |(k, (a, b))| (n, k, a, b))
        })
        .collect();
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    each_pair(list.iter().map(|e| (e.2, e.3)), |m, n| {
        let [(.., a, b), (.., c, d)] = [m, n].map(|k| list[k as usize]);
        if places(a, b, c, d).is_some() {
            pairs.push((m, n));
        }
    });
    // Two edges may share several squares.
    pairs.sort_unstable();
    pairs.dedup();
    if pairs.is_empty() || pairs.len() > CROSSINGS {
        return None;
    }
    let mut points: Vec<DVec2> = Vec::new();
    let mut on: Vec<On> = Vec::new();
    for (m, n) in pairs {
        let (r, i, a, b) = list[m as usize];
        let (s, j, c, d) = list[n as usize];
        if let Some([t, u]) = places(a, b, c, d) {
            on.push((r, i, t, points.len()));
            on.push((s, j, u, points.len()));
            points.push(a.lerp(b, t));
        }
    }
    on.sort_by(|a, b| {
        (a.0, a.1)
            .cmp(&(b.0, b.1))
            .then(a.2.total_cmp(&b.2))
            .then(a.3.cmp(&b.3))
    });
    let mut out = loops(&pieces(rings, &on, &points), points.len());
    out.retain(|l| l.points.len() > 2 && bounds_part(&l.points, rings));
    // Rings without crossings stay as they are.
    let whole = some().filter(|&n| !on.iter().any(|o| o.0 == n));
    out.extend(whole.map(|n| rings[n].clone()));
    Some(out)
}

/// The places along a b and c d, from 0 to 1, where they cross. `None` if they
/// do not cross, or only touch.
fn places(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<[f64; 2]> {
    let (v, w) = (b - a, d - c);
    let [p, q] = [v.perp_dot(c - a), v.perp_dot(d - a)];
    let [r, s] = [w.perp_dot(a - c), w.perp_dot(b - c)];
    (p * q < 0.0 && r * s < 0.0).then(|| [r / (r - s), p / (p - q)])
}

/// A ring's line from one crossing to the next.
struct RingPiece {
    /// The crossing where the piece begins.
    from: usize,
    /// The piece that follows in the ring.
    next: usize,
    /// The crossing, and the vertices up to the next crossing.
    line: Joined,
}

/// The rings' pieces, from the places of crossings in the order of rings, edges
/// and places on the edges.
fn pieces(rings: &[Joined], on: &[On], points: &[DVec2]) -> Vec<RingPiece> {
    let mut list = Vec::with_capacity(on.len());
    for same in on.chunk_by(|a, b| a.0 == b.0) {
        let ring = &rings[same[0].0];
        let (first, count) = (list.len(), ring.points.len());
        for (k, from) in same.iter().enumerate() {
            let after = (k + 1) % same.len();
            let mut steps = (same[after].1 + count - from.1) % count;
            if steps == 0 && after == 0 {
                steps = count;
            }
            let mut line = Joined::default();
            line.push(points[from.3], true);
            for i in from.1 + 1..=from.1 + steps {
                line.push(ring.points[i % count], ring.fixed[i % count]);
            }
            list.push(RingPiece {
                from: from.3,
                next: first + after,
                line,
            });
        }
    }
    list
}

/// The closed loops that pieces make where they change partners at each
/// crossing.
fn loops(pieces: &[RingPiece], crossings: usize) -> Vec<Joined> {
    // For each crossing, the sum of the numbers of the two pieces that begin
    // there. Less the number of one piece it is the number of the other.
    let mut begin = vec![0; crossings];
    for (n, piece) in pieces.iter().enumerate() {
        begin[piece.from] += n;
    }
    let mut seen = vec![false; pieces.len()];
    let mut out = Vec::new();
    for first in 0..pieces.len() {
        let mut joined = Joined::default();
        let mut n = first;
        while !seen[n] {
            seen[n] = true;
            let line = &pieces[n].line;
            for (&point, &fixed) in line.points.iter().zip(&line.fixed) {
                joined.push(point, fixed);
            }
            let next = pieces[n].next;
            n = begin[pieces[next].from] - next;
        }
        out.push(joined);
    }
    out
}

/// True if the part is on the left of a loop, and nothing on its right.
fn bounds_part(line: &[DVec2], rings: &[Joined]) -> bool {
    let longest = edges(line).max_by(|a, b| {
        let length = |e: &(DVec2, DVec2)| e.0.distance_squared(e.1);
        length(a).total_cmp(&length(b))
    });
    let Some((a, b)) = longest else { return false };
    let middle = a.midpoint(b);
    let Some(left) = (b - a).perp().try_normalize() else {
        return false;
    };
    // Adds up the lines that the way to the left meets, by the side from which
    // they come.
    let mut winding = 0;
    for (c, d) in rings.iter().flat_map(|r| edges(&r.points)) {
        let [p, q] = [left.perp_dot(c - middle), left.perp_dot(d - middle)];
        if (p < 0.0) == (q < 0.0) {
            continue;
        }
        let place = c.lerp(d, p / (p - q));
        if (place - middle).dot(left) > ITSELF {
            winding += if p < 0.0 { 1 } else { -1 };
        }
    }
    winding == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::signed_area;

    fn ring(points: &[(f64, f64)]) -> Joined {
        let points = points.iter().map(|&(x, y)| DVec2::new(x, y));
        let points: Vec<DVec2> = points.collect();
        let fixed = vec![true; points.len()];
        Joined { points, fixed }
    }

    fn contents(rings: &[Joined]) -> Vec<f64> {
        let all = vec![true; rings.len()];
        let cut = at_crossings(rings, &all).unwrap();
        cut.iter().map(|r| signed_area(&r.points)).collect()
    }

    #[test]
    fn a_crossed_tip_ends_at_the_crossing() {
        // The tip's sides cross at (2, 0), a quarter of their length before its
        // end.
        let tip = ring(&[(0.0, 2.0), (0.0, -2.0), (3.0, 1.0), (3.0, -1.0)]);
        assert_eq!(contents(&[tip]), vec![4.0]);
    }

    #[test]
    fn rings_that_overlap_become_one() {
        let square = |x: f64| {
            ring(&[(x, x), (x + 2.0, x), (x + 2.0, x + 2.0), (x, x + 2.0)])
        };
        assert_eq!(contents(&[square(0.0), square(1.0)]), vec![7.0]);
        // The holes are two holes of a plate.
        let hole = |x: f64| {
            let mut hole = square(x);
            hole.points.reverse();
            hole
        };
        let plate = ring(&[(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)]);
        let rings = [plate, hole(0.0), hole(1.0)];
        assert_eq!(contents(&rings), vec![-7.0, 324.0]);
        assert!(at_crossings(&rings, &[true, true, false]).is_none());
    }
}
