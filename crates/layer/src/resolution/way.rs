//! A bead's path as close places, with what is meant up to each of them.

use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::Stroke;

/// A segment is not divided into more parts than this: one of many metres, in a model
/// of any size, would take all memory.
const PARTS: f64 = 64.0;

/// Least turn at a place, in radians, for which it is a corner.
const CORNER: f64 = 0.45;

/// A bead's path as close places, and what is meant up to each of them.
pub(super) struct Way {
    pub(super) points: Vec<DVec2>,
    pub(super) widths: Vec<Mm>,
    /// Numbers of the places at which the path turns sharply, and of the last one.
    pub(super) corners: Vec<usize>,
    /// For each place the last one up to which what holds at both ends holds
    /// between them.
    even: Vec<usize>,
    /// Length and content from the beginning.
    length: Vec<Mm>,
    content: Vec<Mm2>,
}

impl Way {
    /// The way along a stroke, with places no farther apart than `step`, unless that
    /// were more than [`PARTS`] on a segment. From place to place the width changes by
    /// at most `tolerance`, unless the stroke has no length there. A corner stands out
    /// by more than that. If the stroke `shows`, it matters how wide it is meant to
    /// be at each place.
    pub(super) fn of(
        stroke: &Stroke,
        step: Mm,
        tolerance: Mm,
        shows: bool,
    ) -> Way {
        // As many places as there are if only the length divides the segments.
        let n = stroke.points.len();
        let steps = (stroke.length() / step).min(PARTS * n as f64);
        let room = steps as usize + n + 1;
        let list = || Vec::with_capacity(room);
        let mut way = Way {
            points: Vec::with_capacity(room),
            widths: list(),
            corners: Vec::new(),
            even: Vec::with_capacity(room),
            length: list(),
            content: list(),
        };
        way.points.extend(stroke.points.first());
        way.widths.push(stroke.width_at(0));
        way.length.push(0.0);
        way.content.push(0.0);
        let (mut length, mut content) = (0.0, 0.0);
        for (i, (a, b)) in stroke.segments().enumerate() {
            let (from, to) = (stroke.width_at(i), stroke.width_at(i + 1));
            let whole = a.distance(b);
            let count =
                (whole / step).max((to - from).abs() / tolerance).ceil();
            // Without a length the width jumps.
            let count = if whole > 0.0 { count.min(PARTS) } else { 0.0 };
            let step = whole / count;
            let last = way.last() + count as usize;
            for k in 1..=count as usize {
                let width = |k: usize| from + k as f64 / count * (to - from);
                length += step;
                content += 0.5 * (width(k - 1) + width(k)) * step;
                let even = !shows || from == to;
                way.even.push(if even { last } else { way.points.len() });
                way.points.push(a.lerp(b, k as f64 / count));
                way.widths.push(width(k));
                way.length.push(length);
                way.content.push(content);
            }
        }
        let corners = way.points.windows(3).map(|p| {
            let (u, v) = (p[1] - p[0], p[2] - p[1]);
            let along = u.dot(v);
            // The cosine decides, since the angle itself costs ten times as much.
            let bound = CORNER.cos().powi(2) * u.length_squared();
            let turns =
                along < 0.0 || along * along < bound * v.length_squared();
            let out = u.perp_dot(v).abs() > tolerance * (u + v).length();
            turns && (out || along < 0.0)
        });
        way.corners = (1..).zip(corners).filter(|c| c.1).map(|c| c.0).collect();
        way.corners.push(way.last());
        way.even.push(way.last());
        way
    }

    /// Number of the last place.
    pub(super) fn last(&self) -> usize {
        self.points.len() - 1
    }

    /// Length between two places.
    pub(super) fn length(&self, i: usize, j: usize) -> Mm {
        self.length[j] - self.length[i]
    }

    /// The place nearest to the middle between two others.
    pub(super) fn middle(&self, i: usize, j: usize) -> usize {
        let half = 0.5 * (self.length[i] + self.length[j]);
        self.length.partition_point(|l| *l < half)
    }

    /// Mean width between two places.
    pub(super) fn width(&self, i: usize, j: usize) -> Mm {
        (self.content[j] - self.content[i]) / self.length(i, j)
    }

    /// Places from one to another without those on a straight stretch, along which
    /// the width changes evenly: no room is less there than at both of its ends.
    pub(super) fn stops(
        &self,
        i: usize,
        j: usize,
    ) -> impl Iterator<Item = usize> {
        let next = move |k: &usize| (*k < j).then(|| self.even[*k].min(j));
        std::iter::successors(Some(i), next)
    }

    /// Least and greatest width between two places.
    pub(super) fn extremes(&self, i: usize, j: usize) -> [Mm; 2] {
        let all = self.stops(i, j).map(|k| self.widths[k]);
        all.fold([f64::INFINITY, 0.0], |[low, high], w| {
            [low.min(w), high.max(w)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stroke that becomes narrow and wide again, in steps and slowly.
    fn stroke() -> Stroke {
        let points = [0.0, 4.0, 4.05, 5.0, 9.0].map(|x| DVec2::new(x, 0.0));
        let mut stroke = Stroke::new(points.to_vec(), false, 0.45);
        stroke.widths = vec![0.45, 0.45, 0.25, 0.25, 0.4];
        stroke
    }

    #[test]
    fn stops_leave_out_what_no_bound_depends_on() {
        let way = Way::of(&stroke(), 0.1, 0.01, false);
        let last = way.last();
        assert!(last > 80);
        // One for each point of the stroke, wherever the stretch begins.
        assert_eq!(way.stops(0, last).count(), 5);
        assert_eq!(way.stops(7, last - 3).count(), 5);
        // If edges show, each place of a ramp has a bound of its own.
        let shown = Way::of(&stroke(), 0.1, 0.01, true);
        assert_eq!(shown.last(), last);
        let places = shown.stops(0, last).count();
        assert!((60..last).contains(&places), "{places}");
        for (i, j) in [(0, 5), (3, last), (last - 1, last), (30, 62)] {
            let all = way.widths[i..=j].iter().copied();
            let low = all.clone().fold(1.0, f64::min);
            let meant = [low, all.fold(0.0, f64::max)];
            assert_eq!(way.extremes(i, j), meant, "{i} {j}");
            assert_eq!(shown.extremes(i, j), meant, "{i} {j}");
        }
    }
}
