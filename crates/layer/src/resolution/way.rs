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
    /// Length and content from the beginning.
    length: Vec<Mm>,
    content: Vec<Mm2>,
}

impl Way {
    /// The way along a stroke, with places no farther apart than `step`, unless that
    /// were more than [`PARTS`] on a segment. From place to place the width changes by
    /// at most `tolerance`, unless the stroke has no length there. A corner stands out
    /// by more than that.
    pub(super) fn of(stroke: &Stroke, step: Mm, tolerance: Mm) -> Way {
        let mut way = Way {
            points: stroke.points.first().copied().into_iter().collect(),
            widths: vec![stroke.width_at(0)],
            corners: Vec::new(),
            length: vec![0.0],
            content: vec![0.0],
        };
        let (mut length, mut content) = (0.0, 0.0);
        for (i, (a, b)) in stroke.segments().enumerate() {
            let (from, to) = (stroke.width_at(i), stroke.width_at(i + 1));
            let whole = a.distance(b);
            let count =
                (whole / step).max((to - from).abs() / tolerance).ceil();
            // Without a length the width jumps.
            let count = if whole > 0.0 { count.min(PARTS) } else { 0.0 };
            let step = whole / count;
            for k in 1..=count as usize {
                let width = |k: usize| from + k as f64 / count * (to - from);
                length += step;
                content += 0.5 * (width(k - 1) + width(k)) * step;
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

    /// Least and greatest width between two places.
    pub(super) fn extremes(&self, i: usize, j: usize) -> [Mm; 2] {
        let all = self.widths[i..=j].iter();
        all.fold([f64::INFINITY, 0.0], |[low, high], w| {
            [low.min(*w), high.max(*w)]
        })
    }
}
