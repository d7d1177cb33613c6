//! Even strips of what the walls leave, which the walls beside them take in.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━━━━━   A part of 2 mm has room for four lines and a
//!   ══════════════════════   narrow bead. Where it is as thick all around a
//!   ┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄   hole, the inner walls on both sides become
//!   ══════════════════════   wider and share the place of the bead: four
//!   ━━━━━━━━━━━━━━━━━━━━━━   strokes take less time than five.
//! ```
//!
//! A strip is only shared if it is closed and even all around, and if no other one
//! meets it. Where a strip ends, its walls would have to become narrow again within
//! the length of its bead's round end. Where strips meet, walls would leave a hole.
//! Where the thickness changes, a narrow bead changes more quickly than walls on both
//! sides of it.
//!
//! In: the area that the walls leave, and how its lines are laid. Out: the
//! strips that are shared, as closed axes, and what is left without them.

use super::Lay;
use super::cell;
use super::line::AxisIndex;
use super::medial_axis::{Axis, axes};
use super::widen::across;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::Stroke;
use isoslice_planar::clip::difference;
use isoslice_planar::opening::is_wider;
use isoslice_planar::{Area, Solid, edges};

/// Length over which a strip has to be even, in lines.
const LONG: f64 = 10.0;
/// By how much its thickness may vary over this length, in lines.
const EVEN: f64 = 0.1;
/// Longest place between even ones at which the thickness may differ, in lines:
/// as in a corner.
const CORNER: f64 = 5.0;
/// Least length of a strip for each of its corners, in lines. The walls leave a pit
/// of about 0.05 mm² in a corner of 90°.
const EACH: f64 = 40.0;
/// Greatest thickness of a strip that is a line's or less in some place, as a share
/// of that bound.
const STAY: f64 = 1.12;
/// Least thickness of a strip, in lines.
const NOTHING: f64 = 0.1;
/// Distance of the places at which a strip is looked at, in lines.
const STRIP_STEP: f64 = 0.5;
/// Distance of the places at which strips are looked for, in lines.
const LOOK: f64 = 2.0;
/// How much farther than a strip reaches on each side its area is taken off, mm:
/// the borders of what is left are thinned, and must not reach back into
/// the strip.
const THINNED: Mm = 0.02;
/// Pieces of what is left are looked at if they are smaller than this, mm²:
/// some are remains that no bead fits into.
const SMALL: Mm2 = 1.0;

/// What is shared, as thicknesses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sharing {
    /// Width of a line.
    line: Mm,
    /// Thickness below which the walls take everything in anyway.
    taken: Mm,
    /// Thickness up to which a strip is shared: a whole line does not fit.
    whole: Mm,
    /// Thickness that two walls can take in before they are too wide.
    most: Mm,
    /// Slack in thicknesses that are equal but for thinning.
    slack: Mm,
}

impl Sharing {
    /// What two sides of a wall share before `line` fits between them, in areas that
    /// are thinned to `tolerance`.
    pub(super) fn new(wall: &Lay, line: &Lay, tolerance: Mm) -> Sharing {
        let most = 2.0 * (wall.limit + wall.extra - wall.width);
        Sharing {
            line: line.width,
            taken: line.least,
            whole: line.inner.min(most),
            most,
            slack: THINNED.max(tolerance),
        }
    }

    /// The greatest thickness at which an even strip goes on.
    fn stays(&self) -> Mm {
        (STAY * self.whole).min(self.most)
    }

    /// The greatest thickness of a corner. The walls leave open what is thicker than
    /// they can take in, which is less than a tenth of their width.
    fn corner(&self) -> Mm {
        STAY * self.most
    }

    /// The strips of an area that are shared.
    pub(super) fn strips(&self, area: &Area, tolerance: Mm) -> Vec<Axis> {
        if area.is_empty() || self.whole <= self.taken {
            return Vec::new();
        }
        let solid = Solid::of(area, cell(area));
        if !self.may_have_strips(&solid) {
            return Vec::new();
        }
        let all = axes(&solid, self.corner(), tolerance).axes;
        let (closed, open): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|axis| axis.closed);
        let thick = |strip: &Axis| strip.thickest() > self.taken;
        let shared = closed.into_iter().filter(|strip| {
            thick(strip) && self.is_even(strip) && !self.meets(strip, &open)
        });
        shared.collect()
    }

    /// True if one of some open axes ends at a strip: walls that share the strip
    /// would leave a hole there.
    fn meets(&self, strip: &Axis, open: &[Axis]) -> bool {
        let strip = std::slice::from_ref(strip);
        let index = AxisIndex::new(strip, self.whole);
        let ends = open.iter().flat_map(|axis| {
            axis.points.first().into_iter().chain(axis.points.last())
        });
        let mut ends = ends.copied();
        ends.any(|end| index.nearest(end, self.whole).is_some())
    }

    /// What the walls beside strips take in of them.
    pub(super) fn shares(&self, strips: &[Axis]) -> Vec<Axis> {
        let mut shares = strips.to_vec();
        let all = shares.iter_mut().flat_map(|s| &mut s.thickness);
        all.for_each(|t| *t = t.min(self.most));
        shares
    }

    /// False if some places along an area's border tell that it has no strips. The
    /// area of a lattice has many axes, which take long to find.
    fn may_have_strips(&self, solid: &Solid<'_>) -> bool {
        // A strip's first and last place may lie between two of these places.
        let long = (LONG - 2.0 * LOOK) * self.line;
        let even = EVEN * self.line + self.slack;
        solid.area().rings.iter().any(|ring| {
            if isoslice_base::limits::is_stopped() {
                return false;
            }
            // The length of an even stretch, and its thicknesses.
            let mut stretch = None;
            let (mut at, mut next) = (0.0, 0.0);
            for (a, b) in edges(ring) {
                let length = a.distance(b);
                let left = (b - a).perp().normalize_or_zero();
                while next < at + length {
                    let p = a.lerp(b, (next - at) / length);
                    let (begin, low, high) =
                        stretch.unwrap_or((next, f64::INFINITY, 0.0));
                    stretch = self.thickness(p, left, solid).map(|t| {
                        let (low, high) = (t.min(low), t.max(high));
                        if high - low <= even {
                            (begin, low, high)
                        } else {
                            (next, t, t)
                        }
                    });
                    if stretch.is_some_and(|s| next - s.0 >= long) {
                        return true;
                    }
                    next += LOOK * self.line;
                }
                at += length;
            }
            false
        })
    }

    /// The thickness of an area at a place on its border, if it is that of a
    /// strip. The area is to the `left`.
    fn thickness(
        &self,
        p: DVec2,
        left: DVec2,
        solid: &Solid<'_>,
    ) -> Option<Mm> {
        let most = self.stays() + self.slack;
        // From here the other side of a strip is nearer than this one.
        let other = p + most * left;
        let (_, q) = solid.grid().nearest_edge(other, most - self.slack)?;
        let t = (q - p).dot(left);
        (self.slack..=most).contains(&t).then_some(t)
    }

    /// True if a closed axis is even all around, but for corners.
    fn is_even(&self, axis: &Axis) -> bool {
        let mut places = places(axis, STRIP_STEP * self.line);
        self.mark(&mut places);
        let Some(first) = places.iter().position(|p| p.even) else {
            return false;
        };
        places.rotate_left(first);
        let pieces = places.chunk_by(|a, b| a.even == b.even);
        let corners: Vec<_> = pieces.filter(|all| !all[0].even).collect();
        let least = EACH * self.line * corners.len() as f64;
        places.iter().any(|p| p.sure)
            && axis.length() >= least
            && corners.iter().all(|all| self.is_corner(all))
    }

    /// Marks the places of stretches that are long and even.
    fn mark(&self, places: &mut [Place]) {
        let n = places.len();
        let range = NOTHING * self.line..=self.stays();
        for first in 0..n {
            let mut length = 0.0;
            let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
            for k in first..first + n {
                let place = places[k % n];
                low = low.min(place.thickness);
                high = high.max(place.thickness);
                if !range.contains(&place.thickness)
                    || high - low > EVEN * self.line
                {
                    break;
                }
                if k > first {
                    length += place.at.distance(places[(k - 1) % n].at);
                }
                if length >= LONG * self.line {
                    for j in first..=k {
                        places[j % n].even = true;
                        places[j % n].sure |= high <= self.whole;
                    }
                    break;
                }
            }
        }
    }

    /// True if places between even ones are a corner that the walls can take in.
    fn is_corner(&self, places: &[Place]) -> bool {
        let steps = places.windows(2).map(|p| p[0].at.distance(p[1].at));
        let length = steps.sum::<Mm>() + 2.0 * STRIP_STEP * self.line;
        let range = NOTHING * self.line..=self.corner();
        length <= CORNER * self.line
            && places.iter().all(|p| range.contains(&p.thickness))
    }

    /// What is left of an area without its strips.
    pub(super) fn without(&self, area: Area, strips: &[Axis]) -> Area {
        if strips.is_empty() {
            return area;
        }
        let taken = strips.iter().flat_map(|s| borders(s, self.slack));
        let taken = taken.collect();
        let prints = |part: &Area| {
            part.content() > SMALL || is_wider(part, self.taken, self.slack)
        };
        let left = difference(&area, &taken).islands();
        let left = left.into_iter().filter(prints);
        left.flat_map(|part| part.rings).collect()
    }
}

/// A place on an axis.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: DVec2,
    thickness: Mm,
    /// True in a strip.
    even: bool,
    /// True where the strip alone would be shared.
    sure: bool,
}

/// Places along a closed axis that are no farther than `step` from each other.
fn places(axis: &Axis, step: Mm) -> Vec<Place> {
    let n = axis.points.len();
    let mut places = Vec::new();
    for k in 0..n {
        let next = (k + 1) % n;
        let (a, b) = (axis.points[k], axis.points[next]);
        let (v, w) = (axis.thickness[k], axis.thickness[next]);
        let count = (a.distance(b) / step).ceil().clamp(1.0, 1e6);
        places.extend((0..count as usize).map(|i| {
            let t = i as f64 / count;
            Place {
                at: a.lerp(b, t),
                thickness: v + t * (w - v),
                even: false,
                sure: false,
            }
        }));
    }
    places
}

/// The borders of a closed strip, `slack` beyond it.
fn borders(strip: &Axis, slack: Mm) -> [Vec<DVec2>; 2] {
    let way = Stroke::new(strip.points.clone(), true, 0.0);
    let side = |sign: f64| -> Vec<DVec2> {
        let all = strip.points.iter().zip(&strip.thickness).enumerate();
        all.map(|(k, (p, t))| *p + sign * (0.5 * t + slack) * across(&way, k))
            .collect()
    };
    let (left, mut right) = (side(1.0), side(-1.0));
    right.reverse();
    [left, right]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::patch::concentric;
    use crate::walls::{ThinPlan, WallPlan, Walls, walls};
    use isoslice_planar::bead::{cross_section, spacing};
    use isoslice_planar::clip::union;
    use isoslice_planar::shapes::{circle, rect};
    use isoslice_settings::testing::{plan_with, usual_plan};
    use std::f64::consts::{PI, TAU};

    const HEIGHT: Mm = 0.2;
    const WIDTH: Mm = 0.45;
    /// Radius of the middle of a ring.
    const RADIUS: Mm = 30.0;

    /// A ring whose thickness depends on the angle.
    fn ring(thickness: impl Fn(f64) -> Mm) -> Area {
        let n = 4000;
        let side = |sign: f64| -> Vec<DVec2> {
            let angles = (0..n).map(|k| TAU * f64::from(k) / f64::from(n));
            let radius = |a: f64| RADIUS + sign * 0.5 * thickness(a);
            angles.map(|a| DVec2::from_angle(a) * radius(a)).collect()
        };
        let mut inside = side(-1.0);
        inside.reverse();
        Area::from_iter([side(1.0), inside])
    }

    fn laid(part: &Area) -> Walls {
        walls(part, None, HEIGHT, &usual_plan(WallPlan::of))
    }

    /// Radius and width of the strokes at an angle, from inside.
    fn across_ring(strokes: &[&Stroke], angle: f64) -> Vec<(Mm, Mm)> {
        let out = DVec2::from_angle(angle);
        let left = out.perp();
        let mut found = Vec::new();
        for stroke in strokes {
            for (k, (a, b)) in stroke.segments().enumerate() {
                let (v, w) = (a.dot(left), b.dot(left));
                if (v >= 0.0) != (w >= 0.0) && a.dot(out) > 0.0 {
                    let t = v / (v - w);
                    let widths = [k, k + 1].map(|i| stroke.width_at(i));
                    let width = widths[0] + t * (widths[1] - widths[0]);
                    found.push((a.lerp(b, t).dot(out), width));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }

    fn all(walls: &Walls) -> Vec<&Stroke> {
        walls.lines.iter().chain(&walls.thin).flatten().collect()
    }

    /// Thickness up to which so many strokes lie side by side: two outer walls,
    /// two inner ones, and rings that fill the rest.
    fn most_of(strokes: usize) -> Mm {
        let own = spacing(WIDTH, WIDTH, HEIGHT);
        let extra = WIDTH - own;
        let outer = WIDTH + own;
        let (least, limit) = (0.6 * WIDTH - extra, 1.8 * WIDTH - extra);
        match strokes {
            0 | 1 => 1.8 * WIDTH,
            3 => outer + limit,
            // The walls share a rest that is too thin for a whole line.
            4 => outer + 3.0 * own,
            n if n % 2 == 1 => outer + (n - 3) as f64 * own + limit,
            // The lines of each second pair share what is too thin for a good bead.
            n if n % 4 == 2 => outer + (n - 2) as f64 * own + 0.8 * WIDTH,
            n => outer + (n - 2) as f64 * own + least,
        }
    }

    /// A strip of each thickness has just as many strokes as it should, and they
    /// fill it exactly.
    #[test]
    fn strips_of_known_thickness_are_filled() {
        let plan = Lay::inside(WIDTH, HEIGHT, usual_plan(ThinPlan::of));
        for step in 0..=62 {
            let thick = 0.9 + 0.05 * f64::from(step);
            let walls = laid(&ring(|_| thick));
            let fill = concentric(&walls.fill, plan, 0.001);
            let strokes: Vec<&Stroke> =
                all(&walls).into_iter().chain(&fill).collect();
            let expected = (1..).find(|n| thick <= most_of(*n)).unwrap_or(0);
            for angle in [0.1, 1.3, 2.9, 4.4] {
                let found = across_ring(&strokes, angle);
                assert_eq!(found.len(), expected, "{thick:.2}: {found:?}");
                let section = |&(_, w): &(Mm, Mm)| cross_section(w, HEIGHT);
                let laid: f64 = found.iter().map(section).sum();
                // The surface's two round edges stay open.
                let edges = HEIGHT * HEIGHT * (1.0 - 0.25 * PI);
                let share = laid / (thick * HEIGHT - edges);
                // Walls may overlap by 0.03 mm before they become narrower.
                let more = if expected == 4 { 0.03 / thick } else { 0.0 };
                let range = 0.995..1.005 + more;
                assert!(range.contains(&share), "{thick:.2}: {share}");
                for pair in found.windows(2) {
                    let own: f64 = pair.iter().map(section).sum();
                    let room = HEIGHT * (pair[1].0 - pair[0].0);
                    assert!(0.5 * own / room < 1.1, "{thick:.2}: {found:?}");
                }
                // No wall is wider than a bead in a thin place.
                let widest = found.iter().map(|f| f.1).fold(0.0, f64::max);
                assert!(widest < 1.8 * WIDTH + 0.002, "{thick:.2}: {widest}");
            }
        }
    }

    /// The number of strokes all around a ring, and how often it changes.
    fn numbers(part: &Area) -> (Vec<usize>, usize) {
        let walls = laid(part);
        let plan = Lay::inside(WIDTH, HEIGHT, usual_plan(ThinPlan::of));
        let fill = concentric(&walls.fill, plan, 0.005);
        let strokes: Vec<&Stroke> =
            all(&walls).into_iter().chain(&fill).collect();
        let angles = (0..900).map(|k| 0.001 + TAU * f64::from(k) / 900.0);
        let found: Vec<usize> =
            angles.map(|a| across_ring(&strokes, a).len()).collect();
        let n = found.len();
        let changes = (0..n).filter(|&k| found[k] != found[(k + 1) % n]);
        let changes = changes.count();
        (found, changes)
    }

    #[test]
    fn a_thickness_that_drifts_does_not_change_the_number() {
        let bound = most_of(4);
        // It wavers below the bound, quickly, and about it, slowly.
        for (times, by, below) in [(60.0, 0.015, 0.02), (5.0, 0.04, 0.01)] {
            let part = ring(|a| bound - below + by * (times * a).sin());
            let (found, changes) = numbers(&part);
            assert_eq!((found[0], changes), (4, 0), "{times}");
        }
        // It wavers about the bound so quickly that no long strip is below it.
        let part = ring(|a| bound + 0.015 * (60.0 * a).sin());
        assert_eq!(numbers(&part).1, 0);
        // It drifts far across the bound: all of it has a bead.
        let (found, changes) = numbers(&ring(|a| bound + 0.15 * a.sin()));
        assert_eq!((found[0], changes), (5, 0));
        // Above the bound all around, nothing is shared.
        let (found, changes) = numbers(&ring(|_| bound + 0.02));
        assert_eq!((found[0], changes), (5, 0));
    }

    #[test]
    fn only_even_strips_are_shared() {
        let plan = Lay::inside(WIDTH, HEIGHT, usual_plan(ThinPlan::of));
        let sharing = Sharing::new(&plan, &plan, 0.005);
        let strips = |part: &Area| sharing.strips(part, 0.005);
        let length = |part: &Area| -> f64 {
            strips(part).iter().map(Axis::length).sum()
        };
        // The whole of a ring; what is left of it is nothing.
        let even = ring(|_| 0.33);
        let found = strips(&even);
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
        assert!((found[0].length() - TAU * RADIUS).abs() < 0.1);
        assert!(sharing.without(even, &found).is_empty());
        // A twelfth of it is thick.
        let part = ring(|a| if a < TAU / 12.0 { 2.0 } else { 0.33 });
        assert_eq!(length(&part), 0.0);
        // A strip that ends, and one that meets others.
        let beam = rect(-RADIUS, -0.165, RADIUS, 0.165);
        assert_eq!(length(&beam), 0.0);
        assert_eq!(length(&union(&ring(|_| 0.33), &beam)), 0.0);
        // As on a gyroid: the thickness changes by a tenth of a line in 2 mm.
        assert_eq!(length(&ring(|a| 0.33 + 0.06 * (20.0 * a).sin())), 0.0);
        // Too thin, too thick, and no ring.
        assert_eq!(length(&ring(|_| 0.2)), 0.0);
        assert_eq!(length(&ring(|_| 0.42)), 0.0);
        assert_eq!(length(&Area::from(circle(5.0, 400))), 0.0);
    }

    /// Of a frame's four lines and a little more the inner walls take all, in
    /// corners as well.
    #[test]
    fn the_corners_of_a_frame_are_shared() {
        let four = most_of(4) - spacing(WIDTH, WIDTH, HEIGHT);
        let frame = |thick: f64| {
            let inside = rect(thick, thick, 30.0 - thick, 20.0 - thick);
            let part = difference(&rect(0.0, 0.0, 30.0, 20.0), &inside);
            (laid(&part), part)
        };
        for more in [0.25, 0.3, 0.35] {
            let (walls, part) = frame(four + more);
            assert!(walls.fill.is_empty(), "{more}: {:?}", walls.fill);
            assert!(walls.thin.iter().all(Vec::is_empty), "{more}");
            assert_eq!(walls.lines.iter().map(Vec::len).sum::<usize>(), 4);
            assert!(walls.gap < 0.01 * part.content(), "{more}: {}", walls.gap);
            // The outer walls are as wide as ever, the inner ones no wider than
            // a bead in a thin place.
            assert!(walls.lines[0].iter().all(|l| l.widths.is_empty()));
            let widths = || walls.lines[1].iter().flat_map(|l| &l.widths);
            let widest = widths().copied().fold(0.0, f64::max);
            assert!(widest < 1.8 * WIDTH + 0.002, "{more}: {widest}");
            let meant = WIDTH + 0.5 * more;
            let usual = widths().filter(|w| (*w - meant).abs() < 0.005);
            assert!(usual.count() >= 8, "{more}: {:?}", walls.lines[1]);
        }
        let (walls, _) = frame(four + WIDTH);
        assert!((walls.fill.content() - WIDTH * 92.0).abs() < 1.0);
    }

    #[test]
    fn nothing_is_shared_where_walls_have_to_be_narrow_or_follow_faces() {
        let part = ring(|_| 2.0);
        let rest = |plan| walls(&part, None, HEIGHT, &plan).fill.content();
        assert_eq!(rest(usual_plan(WallPlan::of)), 0.0);
        assert!(rest(plan_with(WallPlan::of, |s| s.thin_max = 100.0)) > 50.0);
        assert!(
            rest(plan_with(WallPlan::of, |s| s.contour_z = 100.0.into()))
                > 50.0
        );
        // One wall is seen.
        assert!(rest(plan_with(WallPlan::of, |s| s.walls = 1)) > 50.0);
    }
}
