//! The middle of places too thin for two beads side by side.
//!
//! ```text
//!   ━━━━━━━━━━p━━━━━━━━━━━   From a point p of the border a ball grows
//!         ╭── │ ──╮           inwards until it touches the border elsewhere:
//!   ┄┄┄┄┄┄┄┄┄┄c┄┄┄┄┄┄┄┄┄┄┄    its centre c is on the medial axis of the
//!         ╰── │ ──╯           area, and its diameter
//!   ━━━━━━━━━━q━━━━━━━━━━━    is the local thickness.
//! ```
//!
//! In: an area and the thickness below which a place is thin. Out: the lines of
//! the medial axis there, each of which is called an axis, with the thickness at
//! each point. Balls that touch two sides of a corner, and not opposite sides, are
//! left out: the branches into corners are not places for a bead.
//!
//! Not guaranteed: that lines meet where three strips do; they end within
//! about a third of the thickness of each other.

use super::ball::Border;
use super::run::{Run, join, split_runs};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::Room;
use isoslice_planar::simplify::keep_farthest;
use isoslice_planar::{Solid, path_length};
use std::ops::Range;

/// A line along the middle of a thin place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Points of the line.
    pub points: Vec<DVec2>,
    /// Thickness of the area at each point.
    pub thickness: Vec<Mm>,
    /// The line returns to its first point: a thin ring.
    pub closed: bool,
}

/// The axes of an area where it is thinner than a limit.
#[derive(Debug, Default)]
pub(super) struct Axes {
    pub axes: Vec<Axis>,
    /// Where axes go on although others end there, or go on there as well.
    pub nodes: Vec<DVec2>,
    /// How far the area's edges can move inwards.
    pub room: Room,
}

/// The axes of an area where it is thinner than `limit`. Lines are thinned to
/// `tolerance`, in place and thickness.
pub(super) fn axes(solid: &Solid<'_>, limit: Mm, tolerance: Mm) -> Axes {
    let (area, grid) = (solid.area(), solid.grid());
    let mut border = Border::new(solid, 0.5 * limit);
    let mut runs: Vec<Run> = Vec::new();
    let mut first_edge = 0;
    for ring in &area.rings {
        let balls = border.balls(ring, first_edge);
        split_runs(&balls, grid, &mut runs);
        first_edge += EdgeGrid::numbers(std::slice::from_ref(ring));
    }
    let room = border.room();
    let nodes = join(&mut runs, grid);
    let axes = runs
        .into_iter()
        .filter(|run| run.closed || run.balls.len() > 1)
        .map(|run| {
            let balls = run.balls.iter();
            let axis = Axis {
                points: balls.clone().map(|b| b.centre).collect(),
                thickness: balls.map(|b| b.thickness).collect(),
                closed: run.closed,
            };
            axis.thinned(tolerance)
        })
        .collect();
    Axes { axes, nodes, room }
}

impl Axis {
    /// The axis's stroke, for a bead `extra` wider than the area is thick.
    pub(super) fn stroke(&self, extra: Mm) -> Stroke {
        let straight = self.without_hooks();
        let widths = self.thickness[straight.clone()].iter();
        let widths = widths.map(|t| t + extra).collect();
        let points = self.points[straight].to_vec();
        Stroke::varying(points, widths, self.closed)
    }

    /// The numbers of its points without those at its ends that lead back by less than
    /// half the thickness there, which the bead has covered.
    fn without_hooks(&self) -> Range<usize> {
        let (points, n) = (&self.points, self.points.len());
        let mut kept = 0..n;
        if self.closed {
            return kept;
        }
        let leads_back = |end: usize, next: usize, inner: usize| {
            let hook = points[end] - points[next];
            hook.dot(points[next] - points[inner]) < 0.0
                && hook.length() < 0.5 * self.thickness[end]
        };
        while kept.len() > 2
            && leads_back(kept.end - 1, kept.end - 2, kept.end - 3)
        {
            kept.end -= 1;
        }
        while kept.len() > 2
            && leads_back(kept.start, kept.start + 1, kept.start + 2)
        {
            kept.start += 1;
        }
        kept
    }

    /// The line with as few points as the tolerance permits (Douglas and
    /// Peucker 1973), half the thickness counting as a third coordinate.
    pub(super) fn thinned(&self, tolerance: Mm) -> Axis {
        if isoslice_base::limits::is_stopped() {
            return self.clone();
        }
        let at = |i: usize| self.points[i].extend(0.5 * self.thickness[i]);
        let mut keep = vec![false; self.points.len()];
        keep_farthest(&mut keep, |i, j| {
            let (a, b) = (at(i), at(j));
            let along = b - a;
            let length = along.length_squared();
            // Squares of distances, times that of the length, if any.
            let scale = if length > 0.0 { length } else { 1.0 };
            let mut worst = (tolerance * tolerance * scale, None);
            for k in i + 1..j {
                let from_a = at(k) - a;
                let t = from_a.dot(along);
                let off = if t <= 0.0 {
                    from_a.length_squared() * scale
                } else if t >= length {
                    (from_a - along).length_squared() * scale
                } else {
                    from_a.length_squared() * length - t * t
                };
                if off > worst.0 {
                    worst = (off, Some(k));
                }
            }
            worst.1
        });
        let kept = || (0..keep.len()).filter(|&i| keep[i]);
        Axis {
            points: kept().map(|i| self.points[i]).collect(),
            thickness: kept().map(|i| self.thickness[i]).collect(),
            closed: self.closed,
        }
    }

    /// The axis cut where its thickness passes `limit`: each part is above
    /// or below it all along.
    pub(super) fn split_at(self, limit: Mm) -> Vec<Axis> {
        let above = |t: Mm| t > limit;
        let n = self.points.len();
        let first = self.thickness.first().copied().unwrap_or(0.0);
        if self.thickness.iter().all(|&t| above(t) == above(first)) {
            return vec![self];
        }
        let mut parts: Vec<Axis> = Vec::new();
        let segments = if self.closed { n } else { n - 1 };
        let begun = |p: DVec2, thickness: Mm| {
            let mut part = Axis {
                points: Vec::with_capacity(16),
                thickness: Vec::with_capacity(16),
                closed: false,
            };
            part.points.push(p);
            part.thickness.push(thickness);
            part
        };
        let mut part = begun(self.points[0], first);
        for k in 0..segments {
            let (i, j) = (k, (k + 1) % n);
            let (a, b) = (self.thickness[i], self.thickness[j]);
            if above(a) != above(b) {
                let t = (limit - a) / (b - a);
                let p = self.points[i].lerp(self.points[j], t);
                // Each part ends with a thickness on its own side of the limit.
                let hair = 1e-9 * limit;
                let (end, begin) = if above(a) {
                    (limit + hair, limit)
                } else {
                    (limit, limit + hair)
                };
                part.points.push(p);
                part.thickness.push(end);
                let next = begun(p, begin);
                parts.push(std::mem::replace(&mut part, next));
            }
            part.points.push(self.points[j]);
            part.thickness.push(b);
        }
        parts.push(part);
        parts
    }

    /// Length of the line.
    pub(super) fn length(&self) -> Mm {
        path_length(&self.points, self.closed)
    }

    /// Takes a length from the end of the line, but no more than leaves a
    /// point.
    pub(super) fn shorten(&mut self, mut length: Mm) {
        while let [.., a, b] = *self.points.as_slice() {
            let n = self.points.len();
            let (last, edge) = (n - 1, a.distance(b));
            if edge > length {
                let t = length / edge;
                let (v, w) = (self.thickness[last - 1], self.thickness[last]);
                self.points[last] = b.lerp(a, t);
                self.thickness[last] = w + t * (v - w);
                return;
            }
            self.points.pop();
            self.thickness.pop();
            length -= edge;
        }
    }

    /// The part of an open line at one of its ends along which it grows thicker all
    /// the way, up to a thickness. It begins at the line's end.
    pub(super) fn tip(&self, last: bool, upto: Mm) -> Axis {
        /// Least growth along the way: the sides of a tip are 14° apart.
        const GROWS: f64 = 0.25;
        let mut tip = Axis {
            points: Vec::new(),
            thickness: Vec::new(),
            closed: false,
        };
        let n = self.points.len();
        for k in 0..if self.closed { 0 } else { n } {
            let i = if last { n - 1 - k } else { k };
            let (p, t) = (self.points[i], self.thickness[i]);
            let before = tip.points.last().zip(tip.thickness.last());
            if let Some((&q, &thinner)) = before {
                if t < thinner + GROWS * p.distance(q) {
                    break;
                }
                if t > upto {
                    if thinner < upto {
                        let share = (upto - thinner) / (t - thinner);
                        tip.points.push(q.lerp(p, share));
                        tip.thickness.push(upto);
                    }
                    break;
                }
            }
            tip.points.push(p);
            tip.thickness.push(t);
        }
        tip
    }

    /// The line's segments, with the thickness at their ends.
    pub(super) fn segments(
        &self,
    ) -> impl Iterator<Item = ((DVec2, Mm), (DVec2, Mm))> + '_ {
        let n = self.points.len();
        let at = move |i: usize| (self.points[i % n], self.thickness[i % n]);
        let count = if self.closed { n } else { n.saturating_sub(1) };
        (0..count).map(move |i| (at(i), at(i + 1)))
    }

    /// The line as an open one, which ends at its first point if it was closed.
    pub(super) fn opened(&self) -> Axis {
        let mut open = self.clone();
        if std::mem::take(&mut open.closed) {
            open.points.extend(self.points.first());
            open.thickness.extend(self.thickness.first());
        }
        open
    }

    /// The line with points where its thickness passes some bounds, which ascend.
    pub(super) fn refined(&self, bounds: &[Mm]) -> Axis {
        let mut fine = Axis {
            points: Vec::with_capacity(self.points.len() + 8),
            thickness: Vec::with_capacity(self.points.len() + 8),
            closed: self.closed,
        };
        let mut add = |p: DVec2, t: Mm| {
            fine.points.push(p);
            fine.thickness.push(t);
        };
        for ((p, v), (q, w)) in self.segments() {
            add(p, v);
            let first = bounds.partition_point(|b| *b <= v.min(w));
            let last = bounds.partition_point(|b| *b < v.max(w));
            let between = &bounds[first..last.max(first)];
            let mut pass = |b: Mm| add(p.lerp(q, (b - v) / (w - v)), b);
            if v < w {
                between.iter().for_each(|b| pass(*b));
            } else {
                between.iter().rev().for_each(|b| pass(*b));
            }
        }
        if let (false, Some(p), Some(t)) =
            (self.closed, self.points.last(), self.thickness.last())
        {
            add(*p, *t);
        }
        fine
    }

    /// The line cut wherever the number of its segments changes: each part with its
    /// number. `numbers` has one for each segment.
    pub(super) fn parts(&self, numbers: &[usize]) -> Vec<(usize, Axis)> {
        let n = numbers.len();
        let changes = |i: &usize| numbers[(i + n - 1) % n] != numbers[*i];
        // A closed line is cut from a change on, if there is one.
        let first = match (0..n).find(changes) {
            Some(first) if self.closed => first,
            None if self.closed => {
                let whole = numbers.first().map(|k| (*k, self.clone()));
                return whole.into_iter().collect();
            }
            _ => 0,
        };
        let at = |i: usize| i % self.points.len();
        let mut parts: Vec<(usize, Axis)> = Vec::new();
        for i in first..first + n {
            let number = numbers[i % n];
            if parts.last().is_none_or(|part| part.0 != number) {
                let begins = Axis {
                    points: vec![self.points[at(i)]],
                    thickness: vec![self.thickness[at(i)]],
                    closed: false,
                };
                parts.push((number, begins));
            }
            if let Some((_, part)) = parts.last_mut() {
                part.points.push(self.points[at(i + 1)]);
                part.thickness.push(self.thickness[at(i + 1)]);
            }
        }
        parts
    }

    /// The thickness of the thinnest place.
    pub(super) fn thinnest(&self) -> Mm {
        self.thickness.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The thickness of the thickest place.
    pub(super) fn thickest(&self) -> Mm {
        self.thickness.iter().copied().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Area;
    use isoslice_planar::shapes::{self, circle};

    fn area(points: &[(f64, f64)]) -> Area {
        Area::from(shapes::ring(points))
    }

    fn axes_of(area: &Area, limit: f64) -> Vec<Axis> {
        axes(&Solid::of(area, limit), limit, 0.005).axes
    }

    fn total(r: &Axis) -> f64 {
        r.points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    #[test]
    fn a_strip_has_one_straight_axis() {
        let strip = area(&[(0.0, 0.0), (20.0, 0.0), (20.0, 0.5), (0.0, 0.5)]);
        let found = axes_of(&strip, 0.8);
        assert_eq!(found.len(), 1, "{found:?}");
        let r = &found[0];
        assert_eq!(r.points.len(), 2);
        assert!(r.thickness.iter().all(|t| (t - 0.5).abs() < 1e-4));
        assert!(r.points.iter().all(|p| (p.y - 0.25).abs() < 1e-4));
        // The axis ends where a round end of that width reaches the strip's
        // end.
        assert!((total(r) - 19.5).abs() < 0.3, "{}", total(r));
        assert!(axes_of(&strip, 0.4).is_empty());
    }

    #[test]
    fn a_wedge_is_followed_until_it_is_thick() {
        let wedge = area(&[(0.0, 0.0), (20.0, -1.0), (20.0, 1.0)]);
        let found = axes_of(&wedge, 0.8);
        assert_eq!(found.len(), 1, "{found:?}");
        for (p, t) in found[0].points.iter().zip(&found[0].thickness) {
            assert!(p.y.abs() < 0.01);
            assert!((t / p.x - 0.1).abs() < 0.002, "{t} at {}", p.x);
        }
        let thickest = found[0].thickness.iter().copied().fold(0.0, f64::max);
        assert!((thickest - 0.8).abs() < 0.03, "{thickest}");
    }

    #[test]
    fn a_thin_ring_has_a_closed_axis() {
        let circle = |r: f64| circle(r, 400);
        let mut hole = circle(4.4);
        hole.reverse();
        let ring = Area::from_iter([circle(5.0), hole]);
        let found = axes_of(&ring, 0.8);
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
        for (p, t) in found[0].points.iter().zip(&found[0].thickness) {
            assert!((p.length() - 4.7).abs() < 0.005);
            assert!((t - 0.6).abs() < 0.005);
        }
    }

    #[test]
    fn a_neck_between_small_holes_has_one_axis() {
        // Holes as an outline of 5 µm accuracy has them: few edges, each of which
        // gets one ball. The centres of these are 0.3 mm apart and more.
        for (radius, n) in [(0.5, 22), (0.65, 27), (0.65, 22), (0.9, 34)] {
            let apart = 2.0 * radius + 1.3;
            let mut area = shapes::rect(-6.0, -6.0, 6.0, 6.0);
            for x in [-0.5, 0.5] {
                let mut hole = shapes::moved(circle(radius, n), x * apart, 0.0);
                hole.reverse();
                area.rings.push(hole);
            }
            let found = axes_of(&area, 2.1);
            assert_eq!(found.len(), 1, "{radius}: {found:?}");
            // It leads to where both sides are 120° apart, or the neck is as wide as
            // the limit, but for a ball at each end.
            let wide = ((radius + 1.05).powi(2) - 0.25 * apart * apart).sqrt();
            let exact = 2.0 * wide.min(0.5 * apart / 3.0_f64.sqrt());
            let length = total(&found[0]);
            assert!(length > 0.6 * exact, "{radius}, {n}: {length} {exact}");
            let thinnest = found[0].thinnest();
            assert!((thinnest - 1.3).abs() < 0.03, "{radius}: {thinnest}");
        }
    }

    #[test]
    fn an_axis_through_a_crossing_does_not_lead_back() {
        // The upper side's last ball in the left arm is one of the lower side's again,
        // and is a run by itself. It does not go on in the end of the axis that it
        // lies on.
        let crossing = area(&[
            (-4.0, 2.98586),
            (-4.0, 1.5),
            (-1.0, 1.5),
            (-1.0, -4.0),
            (-0.14306, -4.0),
            (-0.14306, 1.5),
            (0.78467, 1.5),
            (0.78467, 2.98586),
            (-0.14306, 2.98586),
            (-0.14306, 4.0),
            (-1.0, 4.0),
            (-1.0, 2.98586),
        ]);
        let found = axes_of(&crossing, 2.05);
        assert!(!found.is_empty());
        for axis in &found {
            let ways = axis.points.windows(2).map(|w| w[1] - w[0]);
            let ways: Vec<DVec2> = ways.collect();
            let ahead = |w: &[DVec2]| w[0].dot(w[1]) > 0.0;
            assert!(ways.windows(2).all(ahead), "{axis:?}");
        }
    }

    /// More runs than can be compared each with each.
    #[test]
    fn runs_are_joined_however_many_there_are() {
        // Thin squares: their borders begin in the middle of a strip, which
        // cuts each axis in two.
        let frame = |x: f64, y: f64| {
            let ring = |h: f64| -> Vec<DVec2> {
                [(0.0, -h), (h, -h), (h, h), (-h, h), (-h, -h)]
                    .map(|(a, b)| DVec2::new(x + a, y + b))
                    .to_vec()
            };
            let mut hole = ring(1.0);
            hole.reverse();
            [ring(1.5), hole]
        };
        let area: Area = (0..2500)
            .flat_map(|i| {
                let (x, y) = (f64::from(i % 50), f64::from(i / 50));
                frame(4.0 * x, 4.0 * y)
            })
            .collect();
        let alone = Area {
            rings: frame(0.0, 0.0).to_vec(),
        };
        let each = axes_of(&alone, 0.8).len();
        assert_eq!(axes_of(&area, 0.8).len(), 2500 * each);
    }

    #[test]
    fn joined_axes_are_as_thick_as_the_area_and_do_not_cross() {
        // Four strips of 0.6 mm meet: the ball in the middle touches four
        // corners.
        let (h, l) = (0.3, 5.0);
        let cross = area(&[
            (-l, -h),
            (-h, -h),
            (-h, -l),
            (h, -l),
            (h, -h),
            (l, -h),
            (l, h),
            (h, h),
            (h, l),
            (-h, l),
            (-h, h),
            (-l, h),
        ]);
        let found = axes_of(&cross, 1.2);
        // Only one axis leads through the middle, as thick as the area. Others
        // may end there.
        let middle: Vec<f64> = found
            .iter()
            .filter_map(|r| {
                let near = |p: &&DVec2| p.length() < 0.03;
                let k = r.points.iter().position(|p| near(&p))?;
                let through = 0 < k && k + 1 < r.points.len();
                through.then(|| r.thickness[k])
            })
            .collect();
        assert_eq!(middle.len(), 1, "{middle:?}");
        let ball = 2.0 * 2.0_f64.sqrt() * h;
        assert!((middle[0] - ball).abs() < 0.01, "{middle:?}");
    }

    #[test]
    fn odd_rings_do_no_harm() {
        let strip = [(0.0, 0.0), (20.0, 0.0), (20.0, 0.5), (0.0, 0.5)];
        // Every point three times, and spikes without width.
        let mut odd: Vec<(f64, f64)> =
            strip.iter().flat_map(|&p| [p; 3]).collect();
        odd.insert(3, (10.0, 0.0));
        odd.insert(4, (10.0, -3.0));
        odd.insert(5, (10.0, 0.0));
        let found = axes_of(&area(&odd), 0.8);
        let long: f64 = found.iter().map(total).sum();
        assert!((long - 19.5).abs() < 1.2, "{long}");
        // Not a number, nowhere, no points, one point, all the same.
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut ring = area(&strip).rings.remove(0);
            ring[2].x = bad;
            let all = vec![ring, Vec::new(), vec![DVec2::ZERO]];
            axes_of(&Area { rings: all }, 0.8);
        }
        assert!(axes_of(&area(&[(1.0, 1.0); 9]), 0.8).is_empty());
    }

    #[test]
    fn corners_of_thick_parts_have_none() {
        let block = area(&[(0.0, 0.0), (9.0, 0.0), (9.0, 5.0), (4.0, 9.0)]);
        assert!(axes_of(&block, 0.8).is_empty());
        assert!(axes_of(&Area::EMPTY, 0.8).is_empty());
    }
}
