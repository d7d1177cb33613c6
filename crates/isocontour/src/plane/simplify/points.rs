//! The path that is thinned, and the corners of the result.

use crate::Length;
use glam::DVec2;

/// Least turn at a point, in radians, for which the point is a corner that
/// stays.
const CORNER: f64 = 0.45;

/// The points of a path. In a closed path numbers after the last point count on
/// from the first point, which is not repeated.
#[derive(Clone, Copy)]
pub(super) struct Points<'a> {
    pub all: &'a [DVec2],
    pub closed: bool,
}

impl Points<'_> {
    /// The number of point `k` among those that are not repeated.
    pub(super) fn number(&self, mut k: usize) -> usize {
        // A division would take longer than all else that is asked of a point.
        while k >= self.all.len() {
            k -= self.all.len();
        }
        k
    }

    pub(super) fn at(&self, k: usize) -> DVec2 {
        self.all[self.number(k)]
    }

    /// The place on the path at a number of points and a share of the next
    /// step.
    pub(super) fn place(&self, at: f64) -> DVec2 {
        let k = at as usize;
        self.at(k).lerp(self.at(k + 1), at - k as f64)
    }

    /// The ways to point `k` and on from it; none at an end of an open path.
    pub(super) fn ways(&self, k: usize) -> Option<(DVec2, DVec2)> {
        let n = self.all.len();
        if !self.closed && (k == 0 || k + 1 >= n) {
            return None;
        }
        let here = self.at(k);
        Some((here - self.at(k + n - 1), self.at(k + 1) - here))
    }

    /// True if the path turns sharply at point `k`.
    pub(super) fn turns(&self, k: usize) -> bool {
        let Some((u, v)) = self.ways(k) else {
            return true;
        };
        // The cosine decides, since the angle itself costs ten times as much.
        let along = u.dot(v);
        let bound = CORNER.cos().powi(2) * u.length_squared();
        along < 0.0 || along * along < bound * v.length_squared()
    }

    /// True if the line between the points beside point `k` is farther from it
    /// than the tolerance.
    pub(super) fn stands_out(&self, k: usize, tolerance: Length) -> bool {
        self.ways(k).is_none_or(|(u, v)| {
            let reach = tolerance * (u + v).length();
            u.dot(v) < 0.0 || u.perp_dot(v).abs() > reach
        })
    }

    /// The way from each point to the left end of a gate that reaches `half` to
    /// both sides; none at a corner. The gate has equal angles to the ways before
    /// and after the point.
    pub(super) fn gates(
        &self,
        half: Length,
        corner: impl Fn(usize) -> bool,
    ) -> Vec<Option<DVec2>> {
        let n = self.all.len();
        let way = |k: usize| (self.at(k + 1) - self.at(k)).normalize_or_zero();
        let mut before = way(n - 1);
        let gate = |k: usize| {
            let after = way(k);
            let along = std::mem::replace(&mut before, after) + after;
            let gate = || half * along.perp().normalize_or_zero();
            (!corner(k)).then(gate)
        };
        (0..n).map(gate).collect()
    }
}

/// A corner of the result.
#[derive(Clone, Copy)]
pub(super) struct Joint {
    pub at: DVec2,
    /// The place on the path beside the corner, as a number of points and a
    /// share of the next step.
    pub place: f64,
    /// True if the corner stays where it is.
    pub stays: bool,
}
