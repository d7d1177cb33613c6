//! Short beads that have a place to themselves.
//!
//! ```text
//!     ╲     ╱        Where strips meet, walls leave a place of a millimetre. Its
//!   ═══╲   ╱═══      bead has no material for its round ends, which are half of
//!    ╶──━━━──╴       it. So it goes on at both ends until it has as much as the
//!   ═══╱   ╲═══      place holds.
//!     ╱     ╲
//! ```
//!
//! In: the beads of a place. Out: these beads, longer if they are short.

use crate::walls::content_of;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::Stroke;

/// Length up to which beads are short, in widths. Of what is longer the ends are less
/// than an eighth.
const SHORT: f64 = 6.0;
/// Greatest length by which a bead goes on, in widths: its line ends where its place
/// does.
const ON: f64 = 0.5;
/// Length of an end that tells its direction, in widths.
const END: f64 = 0.5;

/// Beads that are as long as it takes to fill a place of a content, if all of them are
/// short. Their share of the plane is their width less `extra`.
pub(super) fn filling(
    beads: Vec<Stroke>,
    content: Mm2,
    extra: Mm,
) -> Vec<Stroke> {
    let short = |s: &Stroke| !s.closed && s.length() < SHORT * s.width;
    if !beads.iter().all(short) {
        return beads;
    }
    let laid: Mm2 = beads.iter().map(|s| content_of(s, extra)).sum();
    let ends = beads.iter().flat_map(|s| {
        [0, s.points.len().saturating_sub(1)].map(|k| s.width_at(k))
    });
    let wide: Mm2 = ends.map(|width| width * (width - extra)).sum();
    if laid >= content || wide <= 0.0 {
        return beads;
    }
    let on = ((content - laid) / wide).min(ON);
    let on_at_both = |s: Stroke| longer(longer(s, on), on);
    beads.into_iter().map(on_at_both).collect()
}

/// A line that goes on at its end by so many widths, and then runs the other way.
fn longer(mut line: Stroke, on: f64) -> Stroke {
    let last = line.points.len().saturating_sub(1);
    let width = line.width_at(last);
    let before = line.place(true, END * width);
    let before = before.or_else(|| line.points.first().copied());
    if let (Some(before), Some(end)) = (before, line.points.last_mut()) {
        *end += (*end - before).normalize_or_zero() * on * width;
    }
    line.reverse();
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const EXTRA: Mm = 0.043;

    fn bead(length: Mm) -> Stroke {
        Stroke::new(vec![DVec2::ZERO, DVec2::X * length], false, 0.64)
    }

    fn filled(beads: Vec<Stroke>, content: Mm2) -> (Mm2, Vec<Stroke>) {
        let beads = filling(beads, content, EXTRA);
        (beads.iter().map(|s| content_of(s, EXTRA)).sum(), beads)
    }

    #[test]
    fn a_short_bead_fills_its_place() {
        let (is, beads) = filled(vec![bead(0.6)], 0.6);
        assert!((is - 0.6).abs() < 1e-9, "{is}");
        let (from, to) = beads[0].ends().unwrap();
        assert!((from.x + to.x - 0.6).abs() < 1e-9 && from.y == 0.0);
        // Two of them in one place.
        let (is, _) = filled(vec![bead(0.6), bead(0.5)], 0.9);
        assert!((is - 0.9).abs() < 1e-9, "{is}");
        // Each end goes on as wide as the line is there, but for the taper between.
        let points = vec![DVec2::ZERO, DVec2::X * 0.6];
        let line = Stroke::varying(points, vec![0.5, 0.8], false);
        let (is, _) = filled(vec![line], 0.6);
        assert!((is - 0.6).abs() < 0.02, "{is}");
        // No end leaves the place.
        let (_, beads) = filled(vec![bead(0.6)], 2.0);
        assert!((beads[0].length() - 0.6 - 0.64).abs() < 1e-9);
    }

    #[test]
    fn beads_that_have_enough_or_are_long_stay() {
        for (length, content) in [(0.6, 0.3), (5.0, 4.0)] {
            let beads = vec![bead(length)];
            assert_eq!(filled(beads.clone(), content).1, beads);
        }
        let mut ring = bead(0.6);
        ring.closed = true;
        let beads = vec![ring, bead(0.6)];
        assert_eq!(filled(beads.clone(), 5.0).1, beads);
    }
}
