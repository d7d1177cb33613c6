//! The walk through gates that finds the corners.

use super::fit::settle;
use super::points::{Joint, Points};
use crate::Length;
use glam::DVec2;

/// Half the width of the gates of a ring, as a share of the tolerance.
pub(super) const GATE: f64 = 0.72;
/// Half the width of the gates of a path, as a share of the tolerance. The
/// corners of a path hardly move when they are fitted: the middles of its edges
/// are then a little farther inside a curve than the corners are outside it.
/// Wider gates save points, but half of a circle's path was then more than half
/// of the tolerance beside the circle.
pub(super) const PATH_GATE: f64 = 0.7;
/// Number of gates that are looked at together in the first try.
const WINDOW: usize = 16;
/// All directions between two, which are less than half a turn apart: a gate as
/// it is seen from a point, or the directions that lead through several gates.
#[derive(Clone, Copy)]
struct Gate {
    right: DVec2,
    left: DVec2,
}

impl Gate {
    /// True if edges end in the gate.
    fn is_point(&self) -> bool {
        self.right == self.left
    }

    /// The gate's direction that is nearest to another direction.
    fn nearest_to(&self, along: DVec2) -> DVec2 {
        if self.left.perp_dot(along) > 0.0 {
            self.left
        } else if self.right.perp_dot(along) < 0.0 {
            self.right
        } else {
            along
        }
    }
}

/// The directions through a gate that also lead through others, if there are
/// any.
fn narrowed(others: Option<Gate>, gate: Gate) -> Option<Gate> {
    let mut wedge = others.unwrap_or(gate);
    if wedge.right.perp_dot(gate.right) > 0.0 {
        wedge.right = gate.right;
    }
    if wedge.left.perp_dot(gate.left) < 0.0 {
        wedge.left = gate.left;
    }
    // If a gate is crossed the wrong way, its right end is on the left.
    let right_way = gate.right.perp_dot(gate.left) >= 0.0;
    (right_way && wedge.right.perp_dot(wedge.left) >= 0.0).then_some(wedge)
}

/// The gates through which one edge leads.
struct Reach {
    /// Directions that lead through all of these gates.
    wedge: Gate,
    /// The last of these gates, and its number.
    gate: Gate,
    last: usize,
    /// The next gate, if no direction leads through it as well.
    beyond: Option<Gate>,
}

/// Where a ray from the origin meets the line through two points, as a share of
/// the way from the first point to the second.
fn meet(along: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = along.perp_dot(a) / along.perp_dot(a - b);
    if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// A way to walk along a path.
pub(super) struct Walk<'a, F> {
    pub points: Points<'a>,
    /// Half the width of a gate.
    pub half: Length,
    /// The points' gates ([`Points::gates`]).
    pub gates: Vec<Option<DVec2>>,
    /// Greatest distance of the result from the path.
    pub tolerance: Length,
    /// Tells whether one edge may lead along the path from one point to
    /// another.
    pub fits: F,
    /// True if edges may meet between two gates; otherwise they meet in gates.
    pub between: bool,
}

impl<F: Fn(usize, usize) -> bool> Walk<'_, F> {
    /// The corners of the result. Those of a closed path begin anywhere.
    pub(super) fn joints(&self) -> Vec<Joint> {
        let n = self.points.all.len();
        let fixed = |k: usize| Joint {
            at: self.points.at(k),
            place: k as f64,
            stays: true,
        };
        let (mut from, mut end) = (fixed(0), fixed(n));
        if !self.points.closed {
            end = fixed(n - 1);
        } else if self.gates[0].is_some() {
            // Any point would do. One at which an edge ends is a good
            // beginning.
            from = self.next(&from, &end);
            from.place %= n as f64;
            end = Joint {
                place: from.place + n as f64,
                ..from
            };
        }
        let mut joints = vec![from];
        while from.place < end.place {
            from = self.next(&from, &end);
            joints.push(from);
            if from.stays || from.place >= end.place {
                self.share_last(&mut joints, &end);
            }
        }
        let tolerance = self.tolerance;
        settle(&self.points, &mut joints, tolerance, tolerance - self.half);
        if self.points.closed {
            joints.pop();
        }
        joints
    }

    /// Makes the last two edges about equally long if the last one is short and
    /// both still lead through all gates.
    fn share_last(&self, joints: &mut [Joint], end: &Joint) {
        let [.., a, b, c] = joints else {
            return;
        };
        let (before, rest) = (a.at.distance(b.at), b.at.distance(c.at));
        if b.stays || rest >= 0.5 * before {
            return;
        }
        let half = 0.5 * (before + rest);
        let off = |k: &usize| (a.at.distance(self.points.at(*k)) - half).abs();
        let (start, last) = (a.place as usize, c.place.ceil() as usize);
        let inner = start + 1..b.place.ceil() as usize;
        let Some(k) = inner.min_by(|i, j| off(i).total_cmp(&off(j))) else {
            return;
        };
        let middle = Joint {
            at: self.points.at(k),
            place: k as f64,
            stays: false,
        };
        let leads = |from: &Joint, to: &Joint, last: usize| {
            let along = to.at - from.at;
            let reach = self.reach(from, end, last, None);
            reach.is_some_and(|reach| {
                reach.last == last && reach.wedge.nearest_to(along) == along
            }) && (self.fits)(from.place as usize, last)
        };
        if leads(a, &middle, k) && leads(&middle, c, last) {
            *b = middle;
        }
    }

    /// The ends of the gate `k` as seen from a point. Both are one point where
    /// edges end. The last gate is the end of the path.
    fn gate(&self, k: usize, end: &Joint, from: DVec2) -> Gate {
        let (p, to_left) = if k as f64 >= end.place {
            (end.at, DVec2::ZERO)
        } else {
            let gate = self.gates[self.points.number(k)];
            (self.points.at(k), gate.unwrap_or(DVec2::ZERO))
        };
        Gate {
            right: p - to_left - from,
            left: p + to_left - from,
        }
    }

    /// The gates through which one edge from a corner of the result leads, up
    /// to gate `most`; none if it reaches no gate. The search goes on from what is
    /// `known` to be reached.
    fn reach(
        &self,
        from: &Joint,
        end: &Joint,
        most: usize,
        known: Option<Reach>,
    ) -> Option<Reach> {
        let start = known.as_ref().map_or(from.place as usize, |r| r.last);
        let mut reach = known;
        for k in start + 1..=most {
            let gate = self.gate(k, end, from.at);
            let step = self.points.at(k) - self.points.at(k - 1);
            let wedge = narrowed(reach.as_ref().map(|r| r.wedge), gate);
            // An edge must not lead back along the path.
            let on = wedge.filter(|w| {
                w.right.dot(step) >= 0.0 || w.left.dot(step) >= 0.0
            });
            let Some(wedge) = on else {
                if let Some(reach) = &mut reach {
                    reach.beyond = Some(gate);
                }
                break;
            };
            reach = Some(Reach {
                wedge,
                last: k,
                gate,
                beyond: None,
            });
            if gate.is_point() {
                break;
            }
        }
        reach
    }

    /// The end of the longest edge from a corner of the result.
    fn next(&self, from: &Joint, end: &Joint) -> Joint {
        let start = from.place as usize;
        let point = |k: usize| {
            if k as f64 >= end.place {
                *end
            } else {
                Joint {
                    at: self.points.at(k),
                    place: k as f64,
                    stays: self.gates[self.points.number(k)].is_none(),
                }
            }
        };
        // A long straight piece may fit no farther than its first points. A
        // piece that fits all along may soon turn away.
        let all = end.place.ceil() as usize;
        let mut most = all.min(start + WINDOW);
        let mut found = self.reach(from, end, most, None);
        let goes_on =
            |reach: &Reach, most| reach.last == most && !reach.gate.is_point();
        while found.as_ref().is_some_and(|reach| goes_on(reach, most))
            && most < all
            && (self.fits)(start, most)
        {
            most = all.min(2 * most - start);
            found = self.reach(from, end, most, found);
        }
        let Some(mut reach) = found else {
            // These gates cross. The path is rough where points are closer to
            // each other than the tolerance.
            return point(start + 1);
        };
        let fit = |k: usize| (self.fits)(start, k).then_some(());
        let (fitting, _) = longest(start, reach.last, 2, fit);
        if fitting < reach.last
            && let Some(nearer) = self.reach(from, end, fitting, None)
        {
            reach = nearer;
        }
        let Reach {
            wedge,
            last,
            gate,
            beyond,
        } = reach;
        if gate.is_point() {
            return point(last);
        }
        // The direction, and the ends of both gates on the side on which the
        // edge leaves the strip between them.
        let (along, border) = match beyond {
            Some(next) if wedge.left.perp_dot(next.right) > 0.0 => {
                (wedge.left, Some((gate.right, next.right)))
            }
            Some(next) if wedge.right.perp_dot(next.left) < 0.0 => {
                (wedge.right, Some((gate.left, next.left)))
            }
            _ => (wedge.nearest_to(self.points.at(last) - from.at), None),
        };
        let border = border.filter(|_| self.between);
        let (a, b) = border.unwrap_or((gate.right, gate.left));
        let share = meet(along, a, b);
        let on = if border.is_some() { share } else { 0.0 };
        Joint {
            at: from.at + a.lerp(b, share),
            place: (last as f64 + on).min(end.place),
            stays: false,
        }
    }
}

/// The farthest end, up to `last`, of a piece that begins at the point `start`,
/// and the value of `fit` for the piece that ends there. None if the piece has
/// only two points. `fit` is none for a piece that is too long.
///
/// The piece is lengthened in growing steps until it no longer fits, then the
/// rest is halved. The first try is as long as `like`, the length of the piece
/// before.
pub fn longest<T>(
    start: usize,
    last: usize,
    like: usize,
    fit: impl Fn(usize) -> Option<T>,
) -> (usize, Option<T>) {
    let mut best = (start + 1, None);
    let mut bad = last + 1;
    let (mut end, mut step) = (start + like.max(2), 1);
    while best.0 < last {
        end = end.min(last);
        match fit(end) {
            Some(line) => best = (end, Some(line)),
            None => {
                bad = end;
                break;
            }
        }
        end += step;
        step *= 2;
    }
    while bad - best.0 > 1 && best.0 < last {
        let middle = best.0 + (bad - best.0) / 2;
        match fit(middle) {
            Some(line) => best = (middle, Some(line)),
            None => bad = middle,
        }
    }
    best
}
