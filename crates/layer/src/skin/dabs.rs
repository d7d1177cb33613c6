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
//! In: the beads of a place. Out: these beads, longer if they are short, or one in the
//! middle of a place that has none.

use crate::walls::{Lay, NARROW, content_of};
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::Area;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;

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

/// Beads of a place, or one in its middle if they lay next to nothing: a place that is
/// about as wide as it is long, as where three walls meet, has no middle line, and the
/// ring in it may be but a dot.
pub(super) fn or_dab(
    beads: Vec<Stroke>,
    place: &Area,
    lay: &Lay,
) -> Vec<Stroke> {
    /// Share of the content below which beads are next to nothing.
    const NOTHING: f64 = 0.3;
    /// Extent of the place, in widths of a line, from which on it is no dab.
    const LONG: f64 = 4.0;
    /// Content below which a place stays open, in squares of the width: the beads
    /// around it flow in.
    const LEAST: f64 = 0.5;
    let content = place.content();
    let size = place.bounds().size().max_element();
    let laid: Mm2 = beads.iter().map(|s| content_of(s, lay.extra)).sum();
    if laid >= NOTHING * content
        || size >= LONG * lay.width
        || content < LEAST * lay.width * lay.width
    {
        return beads;
    }
    dab(place, lay).map_or(beads, |dab| vec![dab])
}

/// A bead in the middle of a place that has the place's content, as wide as a ball in its
/// middle, along its longest way; none if the place is too thin for it.
fn dab(place: &Area, lay: &Lay) -> Option<Stroke> {
    /// Number of places tried in each direction.
    const TRIED: usize = 16;
    let [ring] = place.rings.as_slice() else {
        return None;
    };
    let border = EdgeGrid::new(place, lay.width);
    let bounds = place.bounds();
    let at = |k: usize| (k as f64 + 0.5) / TRIED as f64;
    let places = (0..TRIED * TRIED).map(|k| {
        let share = DVec2::new(at(k % TRIED), at(k / TRIED));
        bounds.min + share * bounds.size()
    });
    let balls = places.filter(|p| place.contains(*p)).filter_map(|p| {
        let (_, q) = border.nearest(p)?;
        Some((p, 2.0 * p.distance(q)))
    });
    let (middle, thickness) = balls.max_by(|a, b| a.1.total_cmp(&b.1))?;
    if thickness < lay.least / NARROW {
        return None;
    }
    let share = thickness.min(lay.limit);
    let away = |p: &&DVec2| p.distance_squared(middle);
    let far = ring.iter().max_by(|a, b| away(a).total_cmp(&away(b)))?;
    let along = (*far - middle).try_normalize()?;
    let ways = ring.iter().map(|p| (*p - middle).dot(along));
    let [low, high] = ways.fold([0.0_f64; 2], |[low, high], way| {
        [low.min(way), high.max(way)]
    });
    let half = 0.5 * (place.content() / share).min(high - low);
    let ends = [-half, half].map(|way| 0.5 * (low + high) + way);
    let points = ends.map(|way| middle + way * along).to_vec();
    Some(Stroke::new(points, false, share + lay.extra))
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

    /// The place that three walls around holes leave, and one that is too small.
    #[test]
    fn a_place_without_a_middle_line_gets_one_bead_with_its_content() {
        let plan =
            isoslice_settings::testing::usual_plan(crate::walls::ThinPlan::of);
        let lay = Lay::inside(0.45, 0.2, plan);
        let place = |inside: Mm| {
            let corner = |k: u32| {
                let angle = std::f64::consts::TAU * f64::from(k) / 3.0;
                2.0 * inside * DVec2::from_angle(angle)
            };
            Area::from((0..3).map(corner).collect::<Vec<_>>())
        };
        for inside in [0.15, 0.2, 0.25] {
            let place = place(inside);
            let all = or_dab(Vec::new(), &place, &lay);
            assert_eq!(all.len(), 1, "{inside}");
            let laid = content_of(&all[0], lay.extra);
            assert!((laid / place.content() - 1.0).abs() < 0.01, "{inside}");
            // What is there stays.
            assert_eq!(or_dab(all.clone(), &place, &lay), all);
        }
        assert!(or_dab(Vec::new(), &place(0.13), &lay).is_empty());
    }
}
