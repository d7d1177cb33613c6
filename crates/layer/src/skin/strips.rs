//! What straight lines cover that lie side by side.
//!
//! ```text
//!      ┌────────┐          A sweep compares all edges whose boxes meet, and
//!    ┌─┘        └───┐      those of two slanting strips do, however far apart
//!    └──┐         ┌─┘      they are. So strips of which each lies beside the one
//!       └─────────┘        before it are one ring of steps from the beginning.
//! ```
//!
//! In: lines, row by row, and the direction of most of them. Out: all that is
//! within a distance of one of them, square to it.

use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::clip::unite;
use isoslice_planar::{Area, signed_area};

/// How far a strip reaches beyond its line's beginning, mm. Strips that end there
/// surely meet it.
const BACK: Mm = 0.02;

/// Lines that differ less than this from the direction run in it, mm.
const LEVEL: Mm = 1e-9;

/// Number of stacks on which a strip is tried: the last ones that were begun. A row
/// of more pieces makes more rings than it needs.
const TRIED: usize = 16;

/// A strip around a line in the direction: where it lies along it and across it.
#[derive(Clone, Copy)]
struct Strip {
    from: Mm,
    to: Mm,
    row: Mm,
}

/// What lines cover that reach `half` to both sides.
pub(super) fn covered(lines: &[Vec<DVec2>], angle: Degrees, half: Mm) -> Area {
    let along = DVec2::from_angle(angle.to_radians());
    let level = |p: DVec2| DVec2::new(along.dot(p), along.perp_dot(p));
    let mut stacks: Vec<Vec<Strip>> = Vec::new();
    let mut area = Area::EMPTY;
    for way in lines.iter().flat_map(|line| line.windows(2)) {
        let [a, b] = [level(way[0]), level(way[1])];
        if (a.y - b.y).abs() > LEVEL || a.x >= b.x {
            area.rings.extend(strip(way[0], way[1], half));
            continue;
        }
        let own = Strip {
            from: a.x - BACK,
            to: b.x,
            row: a.y,
        };
        let mut tried = stacks.iter_mut().rev().take(TRIED);
        match tried.find(|stack| own.is_beside(stack.last(), half)) {
            Some(stack) => stack.push(own),
            None => stacks.push(vec![own]),
        }
    }
    let rings = stacks.iter().map(|stack| steps(stack, half));
    let back = |p: DVec2| along.rotate(p);
    area.rings
        .extend(rings.map(|ring| ring.into_iter().map(back).collect()));
    unite(&area)
}

impl Strip {
    /// True if this strip lies on the next row, and overlaps the other one.
    fn is_beside(&self, other: Option<&Strip>, half: Mm) -> bool {
        other.is_some_and(|other| {
            let apart = self.row - other.row;
            let meets = self.from < other.to && other.from < self.to;
            meets && (half..2.0 * half).contains(&apart)
        })
    }
}

/// The ring around strips of which each overlaps the one before it. Where they
/// overlap, the longer one counts.
fn steps(stack: &[Strip], half: Mm) -> Vec<DVec2> {
    let side = |end: fn(&Strip) -> Mm, out: f64| {
        let mut points = Vec::with_capacity(2 * stack.len());
        let mut low = stack.first().map_or(0.0, |s| s.row - half);
        for (k, strip) in stack.iter().enumerate() {
            let high = match stack.get(k + 1) {
                Some(next) if out * (end(next) - end(strip)) > 0.0 => {
                    next.row - half
                }
                _ => strip.row + half,
            };
            points.push(DVec2::new(end(strip), low));
            points.push(DVec2::new(end(strip), high));
            low = high;
        }
        points
    };
    let mut ring = side(|strip| strip.to, 1.0);
    ring.extend(side(|strip| strip.from, -1.0).into_iter().rev());
    ring
}

/// The rectangle on both sides of a way; nothing if it has no length.
pub(super) fn strip(from: DVec2, to: DVec2, half: Mm) -> Option<Vec<DVec2>> {
    let along = (to - from).try_normalize()?;
    let side = half * along.perp();
    let back = BACK * along;
    let mut ring =
        vec![from - back - side, to - side, to + side, from - back + side];
    if signed_area(&ring) < 0.0 {
        ring.reverse();
    }
    Some(ring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_base::random::{mix, share};
    use isoslice_planar::clip::difference;

    /// Rows of a comb with teeth of any length, some with a gap, some askew.
    fn rows(angle: Degrees) -> Vec<Vec<DVec2>> {
        let along = DVec2::from_angle(angle.to_radians());
        let mut lines = Vec::new();
        for k in 0..40_u32 {
            let at =
                |n: u64, most: f64| most * share(mix(4 * u64::from(k) + n));
            let row = 0.4 * f64::from(k);
            let (from, to) = (at(0, 9.0), 10.0 + at(1, 9.0));
            let (gap, skew) = (at(2, 30.0), at(3, 0.3));
            let point = |u: Mm, v: Mm| along.rotate(DVec2::new(u, v));
            if k % 7 == 3 {
                lines.push(vec![point(from, row), point(to, row + skew)]);
            } else if from < gap && gap + 0.5 < to {
                lines.push(vec![point(from, row), point(gap, row)]);
                lines.push(vec![point(gap + 0.5, row), point(to, row)]);
            } else {
                lines.push(vec![point(from, row), point(to, row)]);
            }
        }
        lines
    }

    #[test]
    fn steps_cover_what_their_strips_do() {
        for angle in [0.0, 45.0, 61.0, 135.0] {
            let lines = rows(angle);
            let found = covered(&lines, angle, 0.22);
            let ways = lines.iter().map(|line| (line[0], line[1]));
            let strips = ways.filter_map(|(a, b)| strip(a, b, 0.22)).collect();
            let meant = unite(&strips);
            for (a, b) in [(&found, &meant), (&meant, &found)] {
                let off = difference(a, b).content();
                assert!(off < 1e-4 * meant.content(), "{angle}: {off}");
            }
        }
    }

    #[test]
    fn lines_side_by_side_make_one_ring() {
        let line = |k: i32| {
            let (x, y) = (0.3 * f64::from(k % 3), 0.4 * f64::from(k));
            vec![DVec2::new(-x, y), DVec2::new(9.0 + x, y)]
        };
        let lines: Vec<Vec<DVec2>> = (0..9).map(line).collect();
        let ring = |line: &Vec<DVec2>| {
            let [a, b] = [line[0], line[1]];
            let (from, to) = (a.x, b.x);
            Strip { from, to, row: a.y }
        };
        let stack: Vec<Strip> = lines.iter().map(ring).collect();
        let ring = steps(&stack, 0.22);
        assert_eq!(ring.len(), 4 * lines.len());
        assert!(signed_area(&ring) > 0.0);
        assert_eq!(covered(&lines, 0.0, 0.22).rings.len(), 1);
    }
}
