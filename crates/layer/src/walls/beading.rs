//! How many beads lie side by side along an axis.
//!
//! The thickness along an axis decides: nothing fits up to the first bound, one
//! bead up to the second, then two walls, two walls with a bead between them,
//! and so on. In: an axis. Out: the parts of the axis, each with its number of
//! beads.
//!
//! A thickness that wavers around a bound would chop beads and walls into
//! pieces too short to print, and each change of number is a place where beads
//! end. A number of beads therefore goes on for a while beyond its bounds: the
//! beads become a little wider or narrower there. It is the hysteresis that
//! Kuipers and others describe in *A framework for adaptive width control of
//! dense contour-parallel toolpaths* (2020), decided for whole parts at a time.

use super::Lay;
use super::medial_axis::Axis;
use isoslice_base::units::Mm;

/// Factor by which a single bead goes on narrower than its bound.
const NARROW: f64 = 1.25;
/// Factor by which a single bead goes on wider than its bound. The wider a round bead
/// is, the more it leaves open in corners.
const WIDE: f64 = 1.12;
/// Share of their nominal thickness down to which two walls go on side by side.
const SQUEEZE: f64 = 0.75;
/// Least thickness between two walls, as a share of a bead's width, from which on
/// a bead of its own lies there. Up to it both walls are wider by half of it: a
/// bead of 0.4 mm beside walls of 0.45 mm, and walls of at most 0.63 mm.
const BETWEEN: f64 = 0.8;
/// Longest single bead that gives way to the end of a loop, mm. It would be a stroke
/// more for each end of a loop; the walls around are wider over that length.
const TAIL: Mm = 4.0;
/// Longest tip, from where two beads fit, that two walls lead into, mm: that of a
/// corner of 30°. A sharper one has a bead of its own, which reaches farther.
const TIP: Mm = 1.0;
/// Least change of the thickness along such a tip: twice the tangent of half of
/// 30°, less a little for tips that are rounded.
const TAPER: f64 = 0.5;
/// Factor by which the sliver between two walls goes on thicker than its bound.
const WIDEN: f64 = 1.25;
/// Parts shorter than this take the number of a neighbour, if its beads can
/// be made to fit, mm.
const SHORT: Mm = 4.0;
/// By how much a bead, alone or between two walls, may be wider where its place
/// has room for two beads, but only over a short length. Of two beads there, one
/// would be too short to print, and would leave a pit beside the other.
const BULGE: f64 = 1.25;
/// Longest bulge of two walls, mm, whose lines are wider there by up to half.
const PAIR_LENGTH: Mm = 3.0;
/// Longest bulge, as a share of its greatest width.
const BULGE_LENGTH: f64 = 1.1;
/// Longest bulge of a bead that lies between no others. Nothing is laid twice
/// there, however long it is.
const BEND_LENGTH: f64 = 1.6;
/// Parts are merged in so many rounds, the shortest ones first.
const ROUNDS: u32 = 5;

/// Thicknesses for which there is one number of beads.
#[derive(Clone, Copy, Debug)]
struct Beading {
    /// The nominal upper bound; the lower one is that of the beading before.
    upto: Mm,
    /// Least and greatest thickness to which this number of beads can be
    /// stretched.
    range: (Mm, Mm),
    /// Greatest thickness to which the beads can be stretched over a short
    /// length, as in a bend.
    bulge: Mm,
    /// Thickness that the walls outside of the innermost bead or pair take.
    taken: Mm,
    /// Thickness at which the ring of the innermost wall closes.
    closes: Mm,
}

/// Tells whether a bead along a part of an axis leaves nothing open beside it.
pub(super) type Bends<'a> = &'a dyn Fn(&Axis) -> bool;

/// The numbers of beads that thicknesses get.
#[derive(Debug)]
pub(super) struct Beadings {
    /// An entry for each number of beads. Thicker places have these walls and
    /// more inside.
    beadings: Vec<Beading>,
}

impl Beadings {
    /// The numbers for walls laid one inside the other. A bead in the middle can
    /// take the place of both sides of each wall. `inside` is what lies inside
    /// all of the walls, if anything does.
    pub(super) fn new(walls: &[Lay], inside: Option<Lay>) -> Beadings {
        let mut beadings = Vec::new();
        let mut depth = 0.0;
        // Narrowest place that the walls so far can be squeezed into.
        let mut squeezed = 0.0;
        let all = walls.iter().copied().chain(inside);
        for (k, wall) in all.enumerate() {
            // Skin fills what it can.
            let share = if (1..walls.len()).contains(&k) {
                wall.least.max(BETWEEN * wall.width)
            } else {
                wall.least
            };
            let least = depth + share;
            let sliver = if depth > 0.0 { WIDEN * share } else { share };
            beadings.push(Beading {
                upto: least,
                range: (squeezed, depth + sliver),
                bulge: depth + 2.0 * (wall.centre + super::DOT),
                taken: depth,
                closes: 0.0,
            });
            let wide = wall.limit * WIDE;
            beadings.push(Beading {
                upto: depth + wall.limit,
                range: (depth + wall.least / NARROW, depth + wide),
                bulge: depth + BULGE * wide,
                taken: depth,
                closes: depth + 2.0 * wall.centre,
            });
            squeezed = depth + SQUEEZE * 2.0 * wall.inner;
            depth += 2.0 * wall.inner;
        }
        if inside.is_some() {
            // The area inside has a bead of its own: only its bound counts.
            beadings.pop();
            if let Some(last) = beadings.last_mut() {
                last.range.1 = last.upto;
            }
        }
        let mut bound: Mm = 0.0;
        for beading in &mut beadings {
            bound = bound.max(beading.upto);
            beading.upto = bound;
        }
        Beadings { beadings }
    }

    /// The greatest thickness that matters. A bulge that is thicker is left out:
    /// to look farther around costs more than it gains.
    pub(super) fn limit(&self) -> Mm {
        let all = self.beadings.iter().map(|c| c.upto.max(c.range.1));
        all.fold(0.0, f64::max)
    }

    /// The number of beads for a thickness.
    fn number(&self, thickness: Mm) -> usize {
        self.beadings.partition_point(|c| c.upto < thickness)
    }

    /// True if a number of beads can be made to fit all along an axis. If there
    /// are as many at both its ends, `between` them, they may bulge. What is
    /// left open beside a bulge at the surface would be seen, so there an axis
    /// has to be one of `bends`.
    fn fits(
        &self,
        number: usize,
        axis: &Axis,
        between: bool,
        bends: Bends<'_>,
    ) -> bool {
        self.beadings.get(number).is_some_and(|c| {
            let inside = c.taken > 0.0;
            let thick = c.bulge - c.taken;
            let longest = match (number % 2, inside) {
                (0, _) => PAIR_LENGTH,
                (_, true) => BULGE_LENGTH * thick,
                (_, false) => BEND_LENGTH * thick,
            };
            let bulges = between
                && axis.length() < longest
                && axis.thickest() <= c.bulge
                && (inside || bends(axis));
            let most = if bulges { c.bulge } else { c.range.1 };
            axis.thinnest() >= c.range.0 && axis.thickest() <= most
        })
    }

    /// The parts of an axis and their numbers of beads, without those that are
    /// too thick to have one.
    pub(super) fn split(
        &self,
        axis: &Axis,
        bends: Bends<'_>,
    ) -> Vec<(usize, Axis)> {
        let few = self.beadings.len();
        let (thin, thick) = (axis.thinnest(), axis.thickest());
        let (low, high) = (self.number(thin), self.number(thick));
        if low == high {
            return if high < few {
                vec![(high, axis.clone())]
            } else {
                Vec::new()
            };
        }
        let mut parts = vec![axis.clone()];
        for beading in &self.beadings[low..high.min(few)] {
            parts = parts
                .into_iter()
                .flat_map(|part| part.split_at(beading.upto))
                .collect();
        }
        let mut all: Vec<(usize, Axis)> = parts
            .into_iter()
            .map(|part| (self.number(part.middle_thickness()), part))
            .collect();
        if axis.closed && all.len() > 1 {
            // The line was opened at its first point, perhaps within a part:
            // let it begin with its longest one.
            let longest = (0..all.len())
                .max_by(|&i, &j| {
                    all[i].1.length().total_cmp(&all[j].1.length())
                })
                .unwrap_or(0);
            all.rotate_left(longest);
        }
        all = self.without_tails(all, axis.closed);
        for round in (0..ROUNDS).rev() {
            let short = SHORT / f64::from(1 << round);
            all = self.merged(all, short, axis.closed, bends);
        }
        for (number, part) in &mut all {
            // A bead needs some length, or it is but a widening of the walls.
            let single = *number % 2 == 1 && *number < few;
            if !single {
                continue;
            }
            let width = part.thickest() - self.beadings[*number].taken;
            if part.length() < 0.5 * width {
                *number -= 1;
                let beading = &self.beadings[*number];
                let most =
                    beading.upto + 2.0 * (beading.range.1 - beading.upto);
                part.thickness.iter_mut().for_each(|t| *t = t.min(most));
            }
        }
        all.retain(|(number, _)| *number < few);
        all
    }

    /// The parts with loops that close where a short bead would lead to them: from
    /// a tip, or from between the walls around.
    fn without_tails(
        &self,
        parts: Vec<(usize, Axis)>,
        closed: bool,
    ) -> Vec<(usize, Axis)> {
        let n = parts.len();
        let number = |k: usize| parts.get(k).map(|part| part.0);
        let around = |k: usize| {
            let before = k.checked_sub(1).or(closed.then_some(n - 1));
            let after = if closed { (k + 1) % n } else { k + 1 };
            [before.and_then(number), number(after)]
        };
        let beside: Vec<_> = (0..n).map(around).collect();
        let mut left: Vec<(usize, Axis)> = Vec::with_capacity(n);
        let mut add = |number: usize, part: Axis| match left.last_mut() {
            Some((last, whole)) if *last == number => whole.append(part),
            _ => left.push((number, part)),
        };
        for ((number, part), beside) in parts.into_iter().zip(beside) {
            if !is_tail(number, &part, beside) {
                add(number, part);
                continue;
            }
            let closes = self.beadings[number].closes;
            for piece in part.split_at(closes) {
                let thick = piece.middle_thickness() > closes;
                add(if thick { number + 1 } else { number - 1 }, piece);
            }
        }
        left
    }

    /// Lets parts shorter than `short` take the number of a neighbour, if it
    /// fits, and joins neighbours of one number.
    fn merged(
        &self,
        parts: Vec<(usize, Axis)>,
        short: Mm,
        closed: bool,
        bends: Bends<'_>,
    ) -> Vec<(usize, Axis)> {
        let first = parts.first().map(|p| p.0).filter(|_| closed);
        let mut merged: Vec<(usize, Axis)> = Vec::with_capacity(parts.len());
        let mut rest = parts.into_iter().peekable();
        while let Some((mut number, part)) = rest.next() {
            let before = merged.last().map(|p| p.0);
            let after = rest.peek().map(|p| p.0).or(first);
            if part.length() < short && Some(number) != before {
                let same = before == after;
                let ends = before.is_none() || after.is_none();
                let between = same || ends;
                let fits = |n: &usize| {
                    self.fits(
                        *n,
                        &part,
                        same || ends && n.is_multiple_of(2),
                        bends,
                    )
                };
                // Where the numbers of both neighbours fit, the one nearer to
                // this number is taken.
                let mut beside: Vec<usize> =
                    before.into_iter().chain(after).filter(fits).collect();
                beside.sort_by_key(|n| n.abs_diff(number));
                if let Some(&n) = beside.first()
                    && (between || part.length() < 0.25 * SHORT)
                {
                    number = n;
                }
            }
            match merged.last_mut() {
                Some((n, whole)) if *n == number => whole.append(part),
                _ => merged.push((number, part)),
            }
        }
        let ends = (merged.first(), merged.last());
        if closed
            && merged.len() > 1
            && let (Some((a, _)), Some((b, _))) = ends
            && a == b
        {
            let (_, start) = merged.remove(0);
            if let Some((_, end)) = merged.last_mut() {
                end.append(start);
            }
            merged.rotate_right(1);
        }
        merged
    }
}

/// True if a part is a short bead, or the tip of one, between walls that have a
/// loop on one side of it. `beside` are the numbers of the parts around it.
fn is_tail(number: usize, part: &Axis, beside: [Option<usize>; 2]) -> bool {
    let loops = |k: Option<usize>| k == Some(number + 1);
    let ends = |k: Option<usize>| k.is_none_or(|k| k + 1 == number);
    let length = part.length();
    let short = if number > 1 {
        length < TAIL
    } else {
        // A tooth as thin as a bead has no room for two.
        length < TIP && part.thickest() - part.thinnest() > TAPER * length
    };
    let [before, after] = beside;
    number % 2 == 1
        && short
        && (loops(before) && ends(after) || ends(before) && loops(after))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::WallPlan;
    use glam::DVec2;
    use isoslice_settings::testing::usual_plan;

    /// Two walls, and skin inside them.
    fn beadings() -> Beadings {
        let [outer, inner] =
            [0, 1].map(|k| usual_plan(WallPlan::of).lay(k, 0.2));
        Beadings::new(&[outer, inner], Some(inner))
    }

    /// A straight axis with a point each 0.1 mm.
    fn axis(length: f64, thickness: impl Fn(f64) -> f64) -> Axis {
        let n = (length / 0.1).round() as usize;
        let x: Vec<f64> = (0..=n).map(|i| 0.1 * i as f64).collect();
        Axis {
            points: x.iter().map(|&x| DVec2::X * x).collect(),
            thickness: x.iter().map(|&x| thickness(x)).collect(),
            closed: false,
        }
    }

    fn numbers(parts: &[(usize, Axis)]) -> Vec<usize> {
        parts.iter().map(|p| p.0).collect()
    }

    #[test]
    fn the_thicker_the_more_beads() {
        // Each number of beads goes on for longer than parts have to be.
        let wedge = axis(60.0, |x| 0.05 + x / 28.0);
        let parts = beadings().split(&wedge, &|_| false);
        assert_eq!(numbers(&parts), [0, 1, 2, 3, 4]);
        // One bead from thin_min, 60 %, to thin_max, 180 % of 0.45 mm.
        let one = &parts[1].1;
        assert!((one.thinnest() - 0.27).abs() < 1e-6);
        assert!((one.thickest() - 0.81).abs() < 1e-6);
        // Two walls and the least bead between them: 2·0.428 + 0.8·0.45.
        assert!((parts[3].1.thinnest() - 1.217).abs() < 1e-3);
        // Where a bead fits inside four walls, skin takes over.
        assert!((parts[4].1.thickest() - 1.898).abs() < 1e-3);
    }

    #[test]
    fn a_thickness_that_wavers_keeps_its_number() {
        let wavers = |middle: f64, by: f64| {
            let t = move |x: f64| middle + by * (2.0 * x).sin();
            beadings().split(&axis(30.0, t), &|_| false)
        };
        for (middle, by) in [(0.83, 0.1), (1.084, 0.05), (1.65, 0.15)] {
            let parts = wavers(middle, by);
            assert_eq!(parts.len(), 1, "{middle}: {:?}", numbers(&parts));
        }
        // No number of beads fits all of this axis.
        assert!(wavers(1.0, 0.6).len() > 8);
    }

    #[test]
    fn what_is_long_has_the_number_that_fits_best() {
        let step = |x: f64| if x < 10.0 { 0.78 } else { 0.87 };
        let parts = beadings().split(&axis(20.0, step), &|_| false);
        assert_eq!(numbers(&parts), [1, 2]);
    }

    #[test]
    fn a_bead_between_walls_bulges_where_it_is_too_wide_for_a_while() {
        // As in a bend: from 1.3 mm to more, and back within some length.
        let bend = |most: f64, length: f64| {
            let t = move |x: f64| {
                let share = (2.0 * (x - 10.0) / length).abs();
                1.3 + (most - 1.3) * (1.0 - share).max(0.0)
            };
            numbers(&beadings().split(&axis(20.0, t), &|_| false))
        };
        // Wider than a bead may be for long, 1.716 mm.
        assert_eq!(bend(1.85, 2.6), [3]);
        assert_eq!(bend(1.85, 8.0), [3, 4, 3]);
        // Wider than two walls and a bulge.
        assert!(bend(2.0, 2.6).contains(&4));
        // One bead alone bulges in a bend only.
        let t = |x: f64| 0.6 + 0.4 * (1.0 - (x - 10.0).abs()).max(0.0);
        assert_eq!(
            numbers(&beadings().split(&axis(20.0, t), &|_| false)),
            [1, 2, 1]
        );
        let bent = beadings().split(&axis(20.0, t), &|_| true);
        assert_eq!(numbers(&bent), [1]);
    }

    #[test]
    fn a_closed_axis_may_begin_anywhere() {
        let n = 300;
        let all = |shift: usize| Axis {
            points: (0..n)
                .map(|i| {
                    let a = (i + shift) as f64 / n as f64;
                    DVec2::from_angle(std::f64::consts::TAU * a) * 10.0
                })
                .collect(),
            thickness: (0..n)
                .map(|i| if (i + shift) % n < n / 2 { 0.6 } else { 1.3 })
                .collect(),
            closed: true,
        };
        for shift in [0, 70, 150, 260] {
            let parts = beadings().split(&all(shift), &|_| false);
            let by = |number| -> f64 {
                let own = parts.iter().filter(|p| p.0 == number);
                own.map(|p| p.1.length()).sum()
            };
            assert!((by(1) - 31.4).abs() < 0.5, "{shift}: {}", by(1));
            assert!((by(3) - 31.4).abs() < 0.5, "{shift}: {}", by(3));
            assert!(parts.iter().all(|p| p.1.length() < 40.0));
        }
    }
}
