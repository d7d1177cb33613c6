//! Joining pieces along the border into long paths.
//!
//! ```text
//!   ──┬───────────┬──        ──╮╭─────────╮╭──
//!     │  │  │  │  │      →     │╰─╮ │ ╭─╮ ││     no travel from line to line
//!   ──┴───────────┴──        ──╰──╰─╯─╯ ╰─╯──
//! ```
//!
//! In: the pieces of a layer's pattern, which know where on the area's border
//! they end. Two ends that follow each other on a ring of the border are joined
//! along it, unless the way is longer than it is worth, or would make a path
//! return to itself. Short ways come first, then the others. Each round makes as
//! many joins as can be, by the shortest ways ([`super::pairing`]). Joins add material beside the wall. It does not count for
//! the density, which is the pattern's.

use super::pairing::{Way, pairs};
use isoslice_base::sets::Sets;
use isoslice_base::units::Mm;
use isoslice_planar::border::{Border, BorderPlace, LinePiece};
use isoslice_planar::joints::{self, Joints};

/// An end of a piece on the border.
#[derive(Clone, Copy, Debug)]
struct End {
    foot: BorderPlace,
    number: joints::End,
}

/// The pieces, joined where the way along the border is at most `limit`.
pub(super) fn join(
    pieces: Vec<LinePiece>,
    border: &Border<'_>,
    limit: Mm,
) -> Vec<LinePiece> {
    let ends = ends(&pieces);
    let mut joints = Joints::new(pieces.len());
    // True for ends from which the way goes along the ring.
    let mut ahead = vec![false; 2 * pieces.len()];
    // Which pieces are on one path.
    let mut paths = Sets::new(pieces.len());
    // Short joins come first, so that a long join does not take an end away
    // from them. The last round is for ends that a refused join leaves.
    for limit in [0.4 * limit, limit, limit] {
        let mut found = Vec::new();
        for ring in ends.chunk_by(|a, b| a.foot.ring == b.foot.ring) {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            found.extend(joins(ring, &joints, &mut paths, border, limit));
        }
        // Of joins that would make a path return to itself, the longest is
        // refused.
        found.sort_unstable();
        for (_, a, b) in found {
            if paths.join(a / 2, b / 2) {
                joints.join(a, b);
                ahead[a] = true;
            }
        }
    }
    walk(pieces, &joints, &ahead, border)
}

/// The ends of pieces on the border, ring by ring and in the order along it.
fn ends(pieces: &[LinePiece]) -> Vec<End> {
    let mut ends: Vec<End> = Vec::with_capacity(2 * pieces.len());
    for (i, piece) in pieces.iter().enumerate() {
        let both = [(piece.from, 2 * i), (piece.to, 2 * i + 1)];
        for (foot, number) in both {
            ends.extend(foot.map(|foot| End { foot, number }));
        }
    }
    ends.sort_unstable_by(|a, b| {
        let by_ring = a.foot.ring.cmp(&b.foot.ring);
        let by_place = by_ring.then(a.foot.at.total_cmp(&b.foot.at));
        by_place.then(a.number.cmp(&b.number))
    });
    ends
}

/// The best joins of a ring's ends that have none yet and that are on different
/// paths, each with its way and the numbers of its ends.
fn joins(
    ring: &[End],
    joints: &Joints,
    paths: &mut Sets,
    border: &Border<'_>,
    limit: Mm,
) -> Vec<(Way, usize, usize)> {
    let next = |i: usize| &ring[(i + 1) % ring.len()];
    let mut way = |i: usize| {
        let (a, b) = (&ring[i], next(i));
        let free = [a, b].iter().all(|end| joints.is_free(end.number));
        let apart = paths.of(a.number / 2) != paths.of(b.number / 2);
        let way = border.way(a.foot, b.foot);
        let fits = free && apart && way <= limit;
        fits.then(|| (way * MICROMETRES).round() as Way)
    };
    let ways: Vec<Option<Way>> = (0..ring.len()).map(&mut way).collect();
    let found = pairs(&ways).into_iter();
    found
        .filter_map(|i| Some((ways[i]?, ring[i].number, next(i).number)))
        .collect()
}

/// Micrometres of a millimetre.
const MICROMETRES: f64 = 1e3;

/// Puts the pieces together. `ahead` tells from which ends the way goes along the ring.
fn walk(
    pieces: Vec<LinePiece>,
    joints: &Joints,
    ahead: &[bool],
    border: &Border<'_>,
) -> Vec<LinePiece> {
    let mut pieces: Vec<Option<LinePiece>> =
        pieces.into_iter().map(Some).collect();
    let mut joined = Vec::new();
    for chain in joints.chains() {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let mut path: Option<LinePiece> = None;
        for (i, reversed) in chain.pieces {
            let Some(next) = pieces[i].take() else {
                continue;
            };
            let next = if reversed { turned(next) } else { next };
            let Some(path) = &mut path else {
                path = Some(next);
                continue;
            };
            if let (Some(a), Some(b)) = (path.to, next.from) {
                // The way leads to the piece's end that it begins with.
                let back = ahead[2 * i + usize::from(reversed)];
                let way = if back {
                    let mut way = border.between(b, a);
                    way.reverse();
                    way
                } else {
                    border.between(a, b)
                };
                path.points.extend(way);
            }
            path.points.extend(next.points);
            path.to = next.to;
        }
        if let Some(mut path) = path {
            path.points.dedup();
            joined.push(path);
        }
    }
    joined
}

/// A piece from its last point to its first.
fn turned(mut piece: LinePiece) -> LinePiece {
    piece.points.reverse();
    std::mem::swap(&mut piece.from, &mut piece.to);
    piece
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::hatch::{Lines, hatch_border};
    use isoslice_planar::shapes::square_ring;
    use isoslice_planar::{Area, path_length};

    fn joined(area: &Area, angle: f64, limit: f64) -> (usize, Vec<LinePiece>) {
        let border = Border::new(area);
        let lines = Lines {
            angle,
            spacing: 2.0,
            phase: 0.5,
        };
        let pieces: Vec<LinePiece> = hatch_border(&border, lines, 0.1)
            .into_iter()
            .map(|p| p.1)
            .collect();
        let count = pieces.len();
        (count, join(pieces, &border, limit))
    }

    #[test]
    fn lines_across_a_square_become_one_zigzag() {
        let area = Area::from(square_ring(10.0));
        for angle in [0.0, 30.0, 45.0, 90.0] {
            let (count, paths) = joined(&area, angle, 8.0);
            assert!(count > 8);
            assert!(paths.len() <= 2, "{angle}: {}", paths.len());
        }
        let (count, paths) = joined(&area, 0.0, 8.0);
        assert_eq!(paths.len(), 1);
        let length = path_length(&paths[0].points, false);
        assert!((length - 20.0 * 10.0 - 2.0 * 9.0).abs() < 1e-9, "{length}");
        assert_eq!(count, 10);
        let (count, paths) = joined(&area, 0.0, 1.9);
        assert_eq!(paths.len(), count);
    }

    #[test]
    fn islands_are_not_joined() {
        let at = |x: f64| -> Vec<DVec2> {
            square_ring(5.0)
                .iter()
                .map(|p| *p + DVec2::new(x, 0.0))
                .collect()
        };
        let area = Area::from_iter([at(-20.0), at(0.0), at(20.0), at(40.0)]);
        for angle in [0.0, 45.0, 90.0] {
            let (count, paths) = joined(&area, angle, 8.0);
            assert!(paths.len() >= 4 && paths.len() < count);
            for path in &paths {
                let island = |p: &DVec2| ((p.x + 10.0) / 20.0).floor();
                let first = island(&path.points[0]);
                assert!(
                    path.points.iter().all(|p| island(p) == first),
                    "{angle}: {:?}",
                    path.points
                );
            }
        }
    }

    #[test]
    fn joins_follow_the_border_and_never_cross_a_hole() {
        let mut hole = square_ring(4.0);
        hole.reverse();
        let area = Area::from_iter([square_ring(10.0), hole]);
        let (count, paths) = joined(&area, 45.0, 8.0);
        assert!(paths.len() <= 3 && count > 14, "{} of {count}", paths.len());
        let border = Border::new(&area);
        for path in &paths {
            for p in path.points.windows(2) {
                // Points that are not on the border are a hair inside.
                let middle = p[0].midpoint(p[1]);
                let near = area.rings.iter().flat_map(|r| {
                    isoslice_planar::edges(r).map(|(a, b)| {
                        let q = isoslice_planar::grid::nearest_on(middle, a, b);
                        q.distance(middle)
                    })
                });
                let d = near.fold(f64::INFINITY, f64::min);
                assert!(border.contains(middle) || d < 1e-9, "{p:?}");
            }
        }
    }
}
