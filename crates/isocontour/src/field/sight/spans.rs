//! Lines of sight through a solid whose data knows where lines cross it.
//!
//! In: a solid, parallel lines. Out: where each line goes into the solid and out
//! of it, without a sample.
//!
//! ```text
//!   a        ────███████──────███──▶        one line: where it is inside
//!   b        ───────███████────────▶
//!   a ∪ b    ────██████████───███──▶        the last end is what is seen
//!   a ∩ b    ───────████───────────▶
//! ```

use super::{Grid, Hit};
use crate::data::Crossing;
use crate::solid::Solid;
use glam::{DAffine3, DVec3};

/// Where lines cross the surface of a solid; none if some of its data does not
/// know it. As for [`Crossing`], but a line that is always inside, or from the
/// beginning on, enters at −∞.
pub(super) fn crossings(solid: &Solid, lines: &Grid) -> Option<Vec<Crossing>> {
    Some(match solid {
        Solid::Data { data, place } => {
            let mut found = data.crossings(&placed(lines, place))?;
            let back = place.matrix3.transpose();
            for crossing in &mut found {
                crossing.gradient = back * crossing.gradient;
            }
            found
        }
        Solid::HalfSpace { normal, level } => (0..count(lines))
            .flat_map(|line| half_line(lines, line, *normal, *level))
            .collect(),
        Solid::Constant(false) => Vec::new(),
        Solid::Constant(true) => (0..count(lines)).map(always).collect(),
        Solid::Union(both) | Solid::Common(both) => {
            let [a, b] = &**both;
            let [a, b] = [crossings(a, lines)?, crossings(b, lines)?];
            match solid {
                Solid::Union(_) => joined(&a, &b, |a, b| a || b),
                _ => joined(&a, &b, |a, b| a && b),
            }
        }
        Solid::Outside(of) => {
            let all: Vec<_> = (0..count(lines)).map(always).collect();
            let mut found =
                joined(&all, &crossings(of, lines)?, |all, of| all && !of);
            for crossing in &mut found {
                crossing.gradient = -crossing.gradient;
            }
            found
        }
    })
}

/// What each of some lines meets first, seen from its end. `found` is where they
/// cross the surface.
pub(super) fn hits(
    found: &[Crossing],
    lines: &Grid,
    hits: &mut dyn FnMut(usize, Hit),
) {
    let last = (lines.size[2] - 1) as f64;
    for of_line in found.chunk_by(|a, b| a.line == b.line) {
        // What begins behind the last sample is not in sight.
        let Some(span) = of_line.chunks(2).rfind(|s| s[0].depth <= last) else {
            continue;
        };
        let (depth, gradient) = match span.get(1) {
            Some(end) => (end.depth, end.gradient),
            None => (f64::INFINITY, lines.steps[2]),
        };
        if depth >= 0.0 {
            let hit = Hit {
                depth: depth.min(last + 1.0) as f32,
                gradient: gradient.as_vec3(),
            };
            hits(of_line[0].line as usize, hit);
        }
    }
}

fn count(lines: &Grid) -> u32 {
    (lines.size[0] * lines.size[1]) as u32
}

/// Lines in the coordinates to which `place` leads.
fn placed(lines: &Grid, place: &DAffine3) -> Grid {
    Grid {
        origin: place.transform_point3(lines.origin),
        steps: lines.steps.map(|step| place.transform_vector3(step)),
        size: lines.size,
    }
}

/// A line that is inside from its beginning on.
fn always(line: u32) -> Crossing {
    Crossing {
        line,
        depth: f64::NEG_INFINITY,
        gradient: DVec3::ZERO,
    }
}

/// Where a line is on the side of a plane on which normal · p is below a level.
fn half_line(
    lines: &Grid,
    line: u32,
    normal: DVec3,
    level: f64,
) -> impl Iterator<Item = Crossing> {
    let width = lines.size[0];
    let [i, j] = [line as usize % width, line as usize / width];
    let start =
        lines.origin + lines.steps[0] * i as f64 + lines.steps[1] * j as f64;
    let (below, slope) =
        (level - normal.dot(start), normal.dot(lines.steps[2]));
    let is_inside = slope > 0.0 || slope == 0.0 && below > 0.0;
    let crossing = (slope != 0.0).then_some(Crossing {
        line,
        depth: below / slope,
        gradient: normal,
    });
    is_inside.then(|| always(line)).into_iter().chain(crossing)
}

/// Where lines cross the surface of what `is_inside` says, of being in one solid
/// and in another.
fn joined(
    a: &[Crossing],
    b: &[Crossing],
    is_inside: impl Fn(bool, bool) -> bool,
) -> Vec<Crossing> {
    let mut out: Vec<Crossing> = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    let (mut in_a, mut in_b) = (false, false);
    let mut line = None;
    loop {
        let is_a = match (a.peek(), b.peek()) {
            (Some(a), Some(b)) => (a.line, a.depth) <= (b.line, b.depth),
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (None, None) => return out,
        };
        let next = if is_a { a.next() } else { b.next() };
        let Some(next) = next else { return out };
        if line != Some(next.line) {
            line = Some(next.line);
            (in_a, in_b) = (false, false);
        }
        let before = is_inside(in_a, in_b);
        if is_a {
            in_a = !in_a;
        } else {
            in_b = !in_b;
        }
        if before != is_inside(in_a, in_b) {
            // A span without a length is none.
            let is_same = |last: &&Crossing| {
                (last.line, last.depth) == (next.line, next.depth)
            };
            if out.last().filter(is_same).is_some() {
                out.pop();
            } else {
                out.push(*next);
            }
        }
    }
}
