//! Slits, closed: two bodies that all but touch are printed as one.
//!
//! ```text
//!   ████████╲             Where two edges of the outline face each other
//!   █████████│┄┄╱█████    across less than the limit, what lies between
//!   █████████│▒▒│█████    them is filled (▒). Where the gap is wider, the
//!   █████████│▒▒│█████    outline stays as it is, corners and all.
//! ```
//!
//! In: an outline. Out: the outline with its slits filled, or nothing if there
//! are none, as on most layers. Edges face each other if they are parallel to
//! within 30°. A notch that opens wider than that is no slit, however narrow
//! its end is. On an island with slits, holes that are no wider than a slit are
//! filled as well: where two slits cross, or where the edges of one touch.
//!
//! Guarantees: whatever is filled lies between edges that are nearer to each
//! other than the limit, or is a hole that is hardly wider. Otherwise a slit as
//! wide as the limit would become a row of holes. Elsewhere the outline does
//! not change, except within the tolerance on islands with slits.

use crate::cover::{Covered, Islands};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::clip::{union, unite};
use isoslice_planar::nest::Nest;
use isoslice_planar::offset::offset;
use isoslice_planar::opening::is_wider;
use isoslice_planar::simplify::simplify_area;
use isoslice_planar::{Area, Ring, Solid, edges, signed_area};

/// Cosine of the angle between the directions of two edges, each with the
/// area to its left, from which on they face each other.
const FACING: f64 = -0.866;

/// Least length of a slit that gets wider, in multiples of the limit.
const LENGTH: f64 = 4.0;

/// By how much the pieces of a slit grow so that they touch, in multiples of the
/// limit. In a slit that bends each piece is turned a little against the next one,
/// which leaves a gap between them.
const GROWN: f64 = 0.25;

/// Greatest overlap of edges that touch, due to rounding, mm.
const ROUNDING: Mm = 1e-6;

/// Share of the tolerance that goes to leaving out points that hardly matter.
const TIDY: f64 = 0.1;

/// By how much a hole may be wider than a slit, in multiples of the tolerance.
const HARDLY: f64 = 10.0;

/// The places in which an outline's slits are filled, each a little larger than
/// the slit: what is narrower than `width` between facing edges, but not the
/// ends of notches. They reach into the area by `tolerance` at most.
pub(super) fn slits(outline: &Solid<'_>, width: Mm, tolerance: Mm) -> Area {
    let grid = outline.grid();
    let mut found: Vec<Ring> = Vec::new();
    // The middles of those pieces that end where the gap gets too wide.
    let mut opening: Vec<DVec2> = Vec::new();
    let mut facing: Vec<usize> = Vec::new();
    let mut first = 0;
    for ring in &outline.area().rings {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        for (number, (a, b)) in (first..).zip(edges(ring)) {
            let Some(along) = (b - a).try_normalize() else {
                continue;
            };
            // The middle of whatever is that near outside of the edge.
            let out = -0.5 * width * along.perp();
            let reach = 0.5 * width + ROUNDING;
            facing.clear();
            grid.visit_edges_near(a + out, b + out, reach, |edge| {
                let (c, d) = grid.edge(edge);
                let v = d - c;
                // Each pair of edges is found once. The two may be neighbours,
                // in the corner of a notch.
                if edge > number
                    && v.dot(along) < FACING * v.length()
                    && !facing.contains(&edge)
                {
                    facing.push(edge);
                }
            });
            for &edge in &facing {
                let other = grid.edge(edge);
                let Some((piece, opens)) =
                    between((a, b), other, width, tolerance)
                else {
                    continue;
                };
                if opens {
                    opening.push(piece.iter().sum::<DVec2>() / 4.0);
                }
                found.push(piece);
            }
        }
        first += ring.len() + usize::from(!ring.is_empty());
    }
    if found.is_empty() {
        return Area::EMPTY;
    }
    let slits = unite(&Area { rings: found });
    without_notches(slits, &opening, width, tolerance)
}

/// The slits without those that have a piece in `opening` and are shorter than
/// [`LENGTH`] limits, ends of notches.
fn without_notches(
    mut slits: Area,
    opening: &[DVec2],
    width: Mm,
    tolerance: Mm,
) -> Area {
    if opening.is_empty() {
        return slits;
    }
    let joined = offset(&slits, GROWN * width, tolerance).islands();
    let nest = Nest::new(joined.iter().filter_map(|slit| slit.rings.first()));
    let mut opens = vec![false; joined.len()];
    for &place in opening {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        if let Some(slit) = nest.around(place) {
            opens[slit] = true;
        }
    }
    let longest = (LENGTH + 2.0 * GROWN) * width;
    let rings = joined.into_iter().zip(opens).filter_map(|(slit, opens)| {
        let bounds = slit.bounds();
        let is_notch = opens && bounds.min.distance(bounds.max) < longest;
        (!is_notch).then_some(slit.rings)
    });
    let joined: Area = rings.flatten().collect();
    let joined = Solid::of(&joined, width);
    slits.rings.retain(|ring| {
        ring.first().is_some_and(|&p| joined.grid().contains(p))
    });
    slits
}

/// What lies between two edges that face each other, where that is narrower
/// than `width`; on both sides it reaches by `margin` into the area. Also
/// returns whether the gap gets wider at one of its ends.
fn between(
    (a, b): (DVec2, DVec2),
    (c, d): (DVec2, DVec2),
    width: Mm,
    margin: Mm,
) -> Option<(Ring, bool)> {
    // `u` leads along the slit in the direction of the first edge, `v` across
    // it to the second edge.
    let u = ((b - a).normalize_or_zero() - (d - c).normalize_or_zero())
        .try_normalize()?;
    let v = -u.perp();
    let at = |p: DVec2| DVec2::new((p - a).dot(u), (p - a).dot(v));
    let ([a1, b1], [a2, b2]) = ([at(a), at(b)], [at(d), at(c)]);
    let gap = |x: f64| height(a2, b2, x) - height(a1, b1, x);
    let (mut low, mut high) = (a1.x.max(a2.x), b1.x.min(b2.x));
    let opens = gap(low).max(gap(high)) > width;
    // The gap is linear: each bound cuts off one end.
    for (sign, bound) in [(1.0, width), (-1.0, ROUNDING)] {
        let over = |x: f64| sign * gap(x) - bound;
        let (l, h) = (over(low), over(high));
        if low >= high || (l > 0.0 && h > 0.0) {
            return None;
        }
        let cut = low + (high - low) * l / (l - h);
        if l > 0.0 {
            low = cut;
        } else if h > 0.0 {
            high = cut;
        }
    }
    // A pointed end of the area has edges that all but touch at its tip.
    let length = high - low;
    if length.is_nan() || length <= margin {
        return None;
    }
    let corner = |x: f64, y: f64| a + u * x + v * y;
    let piece = vec![
        corner(low, height(a2, b2, low) + margin),
        corner(high, height(a2, b2, high) + margin),
        corner(high, height(a1, b1, high) - margin),
        corner(low, height(a1, b1, low) - margin),
    ];
    Some((piece, opens))
}

/// The y of the line through two points at an x.
fn height(p: DVec2, q: DVec2, x: f64) -> f64 {
    let t = (x - p.x) / (q.x - p.x);
    p.y + t * (q.y - p.y)
}

/// The area with its slits filled, as [`slits`] has found them.
pub(super) fn filled(
    area: &Area,
    slits: &Area,
    width: Mm,
    tolerance: Mm,
) -> Area {
    let places = Solid::of(slits, width);
    let islands = area.islands();
    let covered = Islands::new(&islands).covered(&places);
    let (mut touched, mut left) = (Area::EMPTY, Area::EMPTY);
    for (island, covered) in islands.into_iter().zip(covered) {
        match covered {
            Covered::Not => left.rings.extend(island.rings),
            _ => touched.rings.extend(island.rings),
        }
    }
    let mut all = union(&touched, slits);
    all.rings.retain(|ring| {
        signed_area(ring) > 0.0 || !narrow(ring, width, tolerance)
    });
    all = simplify_area(&all, TIDY * tolerance);
    all.rings.extend(left.rings);
    all
}

/// True if a hole is nowhere wider than a slit, or hardly.
fn narrow(hole: &[DVec2], width: Mm, tolerance: Mm) -> bool {
    let width = width + HARDLY * tolerance;
    let inside: Ring = hole.iter().rev().copied().collect();
    !is_wider(&Area::from(inside), width, tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;
    use isoslice_planar::shapes::{self, moved, turned};
    use std::f64::consts::TAU;

    const WIDTH: Mm = 0.1;
    const TOLERANCE: Mm = 0.001;

    /// The area as it is printed.
    fn closed(area: &Area) -> Area {
        let found = slits(&Solid::of(area, 1.0), WIDTH, TOLERANCE);
        if found.is_empty() {
            area.clone()
        } else {
            filled(area, &found, WIDTH, TOLERANCE)
        }
    }

    fn all(areas: impl IntoIterator<Item = Area>) -> Area {
        areas.into_iter().collect()
    }

    fn circle(x: f64, radius: f64) -> Ring {
        let count = (TAU * radius / 0.02).ceil();
        moved(shapes::circle(radius, count as usize), x, 0.0)
    }

    fn hole(mut area: Area) -> Area {
        area.rings.iter_mut().for_each(|r| r.reverse());
        area
    }

    #[test]
    fn bodies_that_all_but_touch_become_one() {
        for gap in [0.0, 1e-6, 1e-4, 0.001, 0.01, 0.05, 0.09, 0.0999] {
            for angle in [0.0, 0.1, 0.5, TAU / 8.0] {
                let both = all([
                    rect(-5.0, 0.0, -0.5 * gap, 4.0),
                    rect(0.5 * gap, -1.0, 5.0, 4.0),
                    rect(20.0, 0.0, 21.0, 1.0),
                ]);
                let got = closed(&turned(&both, angle));
                assert_eq!(got.rings.len(), 2, "{gap} {angle}");
                let exact = 4.0 * 5.0 + 5.0 * 5.0 - 0.5 * gap + 1.0;
                let off = got.content() - exact;
                assert!(off.abs() < 1e-3, "{gap} {angle}: {off}");
                // The step at the slit's end stays a step.
                assert!(got.rings.iter().all(|r| r.len() <= 8), "{got:?}");
            }
        }
    }

    #[test]
    fn what_is_no_slit_stays_as_it_is() {
        let wide = |gap: f64| {
            all([
                rect(-5.0, 0.0, -0.5 * gap, 4.0),
                rect(0.5 * gap, -1.0, 5.0, 4.0),
            ])
        };
        // A star whose notches open by 40°, a square hole, thin walls and
        // corners that point at each other.
        let star: Ring = (0..18)
            .map(|i| {
                let r = if i % 2 == 0 { 9.0 } else { 3.0 };
                DVec2::from_angle(TAU * f64::from(i) / 18.0) * r
            })
            .collect();
        let square = turned(&rect(-1.0, -1.0, 1.0, 1.0), TAU / 8.0);
        let beside = {
            let mut other = square.clone();
            let step = DVec2::new(2.0 * 2.0_f64.sqrt() + 0.05, 0.0);
            other.rings[0].iter_mut().for_each(|p| *p += step);
            other
        };
        // The end of a notch that opens by 20° is 0.28 mm long where it is
        // as narrow as a slit.
        let notch = {
            let at = |x: f64, y: f64| DVec2::new(x, y);
            let open = (0.5 * 20.0_f64.to_radians()).tan() * 3.0;
            Area::from(vec![
                at(-3.0, -3.0),
                at(3.0, -3.0),
                at(3.0, -open),
                at(0.0, 0.0),
                at(3.0, open),
                at(3.0, 3.0),
                at(-3.0, 3.0),
            ])
        };
        let areas = [
            wide(0.1001),
            wide(0.3),
            notch,
            Area::from(star),
            all([rect(0.0, 0.0, 9.0, 9.0), hole(rect(2.0, 2.0, 7.0, 7.0))]),
            all([rect(0.0, 0.0, 9.0, 9.0), hole(rect(0.02, 0.02, 8.9, 8.9))]),
            rect(0.0, 0.0, 0.05, 9.0),
            all([square, beside]),
            Area::EMPTY,
        ];
        for area in areas {
            assert_eq!(closed(&area), area);
        }
    }

    #[test]
    fn a_gap_that_tapers_closes_up_to_where_it_is_too_wide() {
        // From 0 at x = 0 to 0.3 mm at x = 6.
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let lower =
            vec![at(0.0, -2.0), at(6.0, -2.0), at(6.0, -0.15), at(0.0, 0.0)];
        let upper =
            vec![at(0.0, 0.0), at(6.0, 0.15), at(6.0, 2.0), at(0.0, 2.0)];
        let got = closed(&Area::from_iter([lower, upper]));
        assert_eq!(got.rings.len(), 1);
        let exact = 24.0 - 0.5 * 0.3 * 6.0 + 0.5 * 0.1 * 2.0;
        assert!((got.content() - exact).abs() < 1e-3, "{}", got.content());
        assert!(got.contains(at(1.99, 0.04)) && !got.contains(at(2.01, 0.04)));
    }

    #[test]
    fn discs_join_by_a_neck_as_long_as_the_gap_is_narrow() {
        for radius in [1.0, 4.0] {
            let gap = 0.02;
            let both = Area::from_iter([
                circle(-radius - 0.5 * gap, radius),
                circle(radius + 0.5 * gap, radius),
            ]);
            let got = closed(&both);
            assert_eq!(got.rings.len(), 1);
            // Half the neck: up to where the gap is 0.1 mm, or opens by 30°.
            let slope = (TAU / 24.0).sin() * radius;
            let narrow = (radius.powi(2) - (radius - 0.04).powi(2)).sqrt();
            let neck = narrow.min(slope);
            assert!(got.contains(DVec2::new(0.0, neck - 0.03)), "{radius}");
            assert!(!got.contains(DVec2::new(0.0, neck + 0.03)), "{radius}");
        }
    }

    #[test]
    fn a_pin_fuses_with_its_sleeve() {
        for gap in [0.005, 0.05, 0.099] {
            let area = Area::from_iter([
                circle(0.0, 3.0),
                circle(0.0, 3.0 + gap).into_iter().rev().collect(),
                circle(0.0, 6.0),
            ]);
            let got = closed(&area);
            assert_eq!(got.rings.len(), 1, "{gap}");
            let exact = signed_area(&circle(0.0, 6.0));
            assert!((got.content() - exact).abs() < 1e-3, "{gap}");
        }
    }

    #[test]
    fn grooves_and_crossings_close_to_their_ends() {
        let block = rect(-5.0, -5.0, 5.0, 5.0);
        let slot = |x0, y0, x1, y1| rect(x0, y0, x1, y1);
        let cross =
            union(&slot(-3.0, -0.04, 3.0, 0.04), &slot(0.5, -3.0, 0.58, 9.0));
        for angle in [0.0, 0.3] {
            let area = isoslice_planar::clip::difference(&block, &cross);
            let got = closed(&turned(&area, angle));
            assert_eq!(got.rings.len(), 1, "{got:?}");
            assert!((got.content() - 100.0).abs() < 1e-3);
        }
        // A keyhole keeps its round end.
        let hole = Area::from(circle(0.0, 0.5));
        let key = union(&hole, &slot(0.0, -0.04, 9.0, 0.04));
        let got = closed(&isoslice_planar::clip::difference(&block, &key));
        assert_eq!(got.rings.len(), 2);
        let exact = 100.0 - std::f64::consts::PI * 0.25;
        assert!((got.content() - exact).abs() < 2e-3);
    }
}
