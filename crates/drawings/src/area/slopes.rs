//! Bounds of the distance and its gradient over boxes.

use super::{Area, Edge, SMOOTH};
use glam::DVec2;
use isocontour::Rect;
use std::cell::Cell;

type Range = [f64; 2];

/// No number.
const NONE: Range = [f64::INFINITY, f64::NEG_INFINITY];

/// Ways, by the ranges of their two coordinates.
#[derive(Clone, Copy, Debug)]
struct Ways([Range; 2]);

impl Ways {
    const ALL: Ways = Ways([[-1.0, 1.0]; 2]);

    fn with(self, way: DVec2) -> Ways {
        let [x, y] = self.0;
        let with = |[a, b]: Range, v: f64| [a.min(v), b.max(v)];
        Ways([with(x, way.x), with(y, way.y)])
    }

    fn both(self, other: Ways) -> Ways {
        let both = |i: usize| {
            let ([a, b], [c, d]) = (self.0[i], other.0[i]);
            [a.min(c), b.max(d)]
        };
        Ways([both(0), both(1)])
    }

    /// Ways between vectors which are all on one side of a line through the
    /// origin.
    fn between(vectors: &[DVec2]) -> Ways {
        let mut ways = Ways([NONE; 2]);
        for v in vectors {
            ways = ways.with(v.normalize_or_zero());
        }
        // Along an axis the coordinate is greatest, if the ways are on both of
        // its sides.
        for axis in [DVec2::X, DVec2::Y] {
            for axis in [axis, -axis] {
                let ahead = vectors.iter().any(|v| v.dot(axis) > 0.0);
                let sides = |side: f64| {
                    vectors.iter().any(|v| v.perp_dot(axis) * side >= 0.0)
                };
                if ahead && sides(1.0) && sides(-1.0) {
                    ways = ways.with(axis);
                }
            }
        }
        ways
    }

    fn turned(self, sign: f64) -> Ways {
        Ways(
            self.0
                .map(|[a, b]| if sign < 0.0 { [-b, -a] } else { [a, b] }),
        )
    }

    fn wider(self, by: f64) -> Ways {
        Ways(self.0.map(|[a, b]| [(a - by).max(-1.0), (b + by).min(1.0)]))
    }
}

impl Area {
    /// The range of the distance in a box: it changes by at most 1 per mm.
    pub(crate) fn range(&self, over: Rect) -> Range {
        let outlines = self.bounds();
        // Nothing inside is farther from the border than half the width.
        let deepest = -0.5 * outlines.size().min_element();
        let apart = over.gap(outlines);
        let least = if apart > 0.0 { apart } else { deepest };
        let least = least - 1e-12 * (1.0 + least.abs());
        let centre = over.centre();
        let half = 0.5 * over.size().length();
        if !(centre.is_finite() && half.is_finite()) {
            return [least, f64::INFINITY];
        }
        let value = self.at(centre).0;
        let size = value.abs() + half + centre.abs().max_element();
        let half = half + 1e-14 * size;
        [least.max(value - half), value + half]
    }

    /// The ranges of the gradient's coordinates in a box.
    pub(crate) fn slopes(&self, over: Rect) -> [Range; 2] {
        let centre = over.centre();
        let half = 0.5 * over.size().length();
        if !(centre.is_finite() && half.is_finite()) {
            return Ways::ALL.0;
        }
        let value = self.at(centre).0;
        // No nearest point of a point of the box is farther from the box.
        let far = (value.abs() + half) * (1.0 + 1e-9) + 1e-9;
        let sign = if value.abs() > half * (1.0 + 1e-9) + 1e-9 {
            value.signum()
        } else {
            0.0
        };
        let mut ways = Ways([NONE; 2]);
        let met = Cell::new(0);
        let near = |b: &Rect| met.get() <= MOST_EDGES && b.gap(over) <= far;
        self.tree.each(near, |edge| {
            met.set(met.get() + 1);
            let of = self.edges[edge].ways(over, far, sign);
            ways = ways.both(of);
        });
        if met.get() > MOST_EDGES {
            return Ways::ALL.0;
        }
        ways.wider(4.0 * SMOOTH).0
    }
}

/// The most edges whose ways are looked at, of which few leave a way out.
const MOST_EDGES: usize = 64;

impl Edge {
    /// The gradients at points of a box that have their nearest point on this
    /// edge, within a distance. The sign says on which side they are; 0 for
    /// both.
    fn ways(&self, over: Rect, far: f64, sign: f64) -> Ways {
        let curve = &self.piece.curve;
        let (slope, n) = curve.slope();
        // Across the border, outwards.
        let across: [DVec2; 3] = slope.map(|s| -s.perp() * self.out);
        let mut ways = Ways([NONE; 2]);
        if curve.degree() > 1 || within_reach(curve.start(), slope[0], over) {
            ways = ways.both(Ways::between(&across[..n]));
        }
        for (end, p) in [curve.start(), curve.end()].into_iter().enumerate() {
            if self.smooth[end] || over.distance2(p) > far * far {
                continue;
            }
            if over.grown(1e-9).distance2(p) == 0.0 {
                return Ways::ALL;
            }
            let from = Ways::between(&over.corners().map(|c| c - p));
            for side in [1.0, -1.0] {
                if sign != -side {
                    ways = ways.both(from.turned(side));
                }
            }
        }
        ways
    }
}

/// Whether any point of a box is beside a line.
fn within_reach(start: DVec2, way: DVec2, over: Rect) -> bool {
    let centre = over.centre();
    let half = 0.5 * over.size();
    let along = (centre - start).dot(way);
    let reach = half.dot(way.abs()) + 1e-9 * way.length();
    along + reach >= 0.0 && along - reach <= way.length_squared()
}
