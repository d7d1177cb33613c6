//! Ways from one island to another: through the air once.
//!
//! ```text
//!     ╭────────╮       ╭────────╮   The way leads inside to a place at the
//!     │ a──╮   │       │        │   border, across to the place opposite, and on
//!     │    ╰───┿───────┿──╮     │   inside. It crosses both borders at right
//!     ╰────────╯       ╰──┊─────╯   angles, where they are nearest to each
//!                         b         other.
//! ```
//!
//! A straight way that crosses both borders once, and not at a slant, is as
//! good. If other islands are in between, there is no such way.

use super::comb::{Comb, Stop};
use glam::DVec2;
use isoslice_base::units::Mm;

/// Cosine of the angle to the border's normal up to which a straight way counts
/// as square to the border: 35°.
const SQUARE: f64 = 0.82;

/// How far from the place where the straight way leaves an island the other
/// island is looked for, mm.
const REACH: Mm = 5.0;

/// How often the nearest place on each border is looked for from the other one.
const ROUNDS: usize = 2;

/// A place on the border of an island.
#[derive(Clone, Copy, Debug)]
struct BorderPlace {
    at: DVec2,
    edge: usize,
}

/// A way from `a` to `b` in different islands, with both points. None if the
/// straight way is as good, or if there is no such way.
pub(super) fn way(
    comb: &Comb,
    a: DVec2,
    b: DVec2,
    longest: Mm,
) -> Option<Vec<DVec2>> {
    let from = comb.island(a)?;
    let to = comb.island(b)?;
    if from == to {
        return None;
    }
    let marks = comb.crossed(a, b);
    let of = |edge: usize| comb.island_of_edge(edge);
    let leaves = marks.iter().rposition(|m| of(m.edge) == Some(from))?;
    let enters = marks.get(leaves + 1)?;
    if of(enters.edge) != Some(to) {
        return None;
    }
    let (mut exit, mut entry) = (
        BorderPlace {
            at: marks[leaves].at,
            edge: marks[leaves].edge,
        },
        BorderPlace {
            at: enters.at,
            edge: enters.edge,
        },
    );
    let along = (b - a).normalize_or_zero();
    let square =
        |p: &BorderPlace| comb.normal(p.edge).dot(along).abs() >= SQUARE;
    if marks.len() == 2 && square(&exit) && square(&entry) {
        return None;
    }
    for _ in 0..ROUNDS {
        entry = nearest(comb, exit.at, entry, to);
        exit = nearest(comb, entry.at, exit, from);
    }
    let (out, into) = (inside(comb, exit), inside(comb, entry));
    if out.room <= 0.0 || into.room <= 0.0 || !once(comb, out.at, into.at) {
        return None;
    }
    let first = comb.way(a, out.at, longest)?;
    let last = comb.way(into.at, b, longest)?;
    let mut way = vec![a];
    way.extend(first);
    way.extend([out.at, into.at]);
    way.extend(last);
    way.push(b);
    way.dedup();
    Some(way)
}

/// The place of an island's border nearest to `p`, or `known` if `known` is
/// nearer.
fn nearest(
    comb: &Comb,
    p: DVec2,
    known: BorderPlace,
    island: usize,
) -> BorderPlace {
    let reach = p.distance(known.at).min(REACH);
    let mut best: Option<(Mm, BorderPlace)> = None;
    comb.visit_border(p, reach, |edge, at| {
        let d = p.distance(at);
        // Of equally near places the first one counts, in whatever order edges
        // are visited.
        let nearer = best.is_none_or(|(least, b)| {
            d < least || (d == least && edge < b.edge)
        });
        if nearer && comb.island_of_edge(edge) == Some(island) {
            best = Some((d, BorderPlace { at, edge }));
        }
    });
    best.map_or(known, |(_, place)| place)
}

fn inside(comb: &Comb, place: BorderPlace) -> Stop {
    comb.off_border(place.at, place.edge)
}

/// True if the line from one island to another leaves the first once and enters
/// the second once.
fn once(comb: &Comb, a: DVec2, b: DVec2) -> bool {
    comb.crossed(a, b).len() == 2
}
