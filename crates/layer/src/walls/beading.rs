//! How many beads lie side by side along an axis.
//!
//! ```text
//!   thickness   0 ── 1 bead ── 2 walls ── 2 and a bead ── 4 walls ── …
//!   ▁▂▃▄▅▆▇▇▇▆▅▆▇▇▇▆▅▄▃▂▁     The thickness wavers. Each change of the number costs
//!   0│1 │    2     │ 2 │1│0    as much as a stroke's end, and beads that are too
//!                             wide or too narrow cost by their length.
//! ```
//!
//! In: an axis. Out: the parts of the axis, each with its number of beads, so that
//! all costs together are the least.
//!
//! A number of beads goes on for a while beyond its bounds, and the beads become a
//! little wider or narrower there: the hysteresis that Kuipers and others describe
//! in *A framework for adaptive width control of dense contour-parallel toolpaths*
//! (2020), decided for whole axes at a time. Where a strip grows from two walls to
//! four, the loop of the inner walls closes, and no bead leads into it unless it
//! would be long.

use super::Lay;
use super::medial_axis::Axis;
use super::web;
use isoslice_base::units::Mm;
use std::cell::OnceCell;

/// Factor by which a single bead goes on narrower than its bound.
pub(crate) const NARROW: f64 = 1.25;
/// Factor by which a single bead goes on wider than its bound. The wider a round bead
/// is, the more it leaves open in corners.
const WIDE: f64 = 1.12;
/// Share of their nominal thickness down to which two walls go on side by side.
const SQUEEZE: f64 = 0.75;
/// Least thickness between two walls, as a share of a bead's width, from which on
/// a bead of its own lies there. Up to it both walls are wider by half of it: a
/// bead of 0.4 mm beside walls of 0.45 mm, and walls of at most 0.63 mm.
const BETWEEN: f64 = 0.8;
/// Factor by which the sliver between two walls goes on thicker than its bound.
const WIDEN: f64 = 1.25;
/// Factor by which what two sides of the innermost wall share goes on thicker than
/// its bound.
const STAY: f64 = 1.12;
/// By how much a bead, alone or between two walls, may be wider where its place
/// has room for two beads, but only over a short length. Of two beads there, one
/// would be too short to print, and would leave a pit beside the other.
const BULGE: f64 = 1.25;

/// By how much thicker the area may be where a loop that is but a dot lies in a bulge,
/// mm.
const ROUNDER: Mm = 0.06;

/// The cost of a stroke's end, by which the other costs are measured.
const END: f64 = 1.0;
/// The cost of an odd bead's end at an axis's end, where a loop would go on around it
/// or into another axis.
const STOP: f64 = 0.5;
/// The cost of a loop's end: the walls around it are not quite even.
const LOOP: f64 = 0.3;
/// The cost of 1 mm of beads that are as wide or as narrow as they may be. Parts of
/// less than 5 mm do not change the number of beads twice.
const STRETCHED: f64 = 0.4;
/// The cost of 1 mm of walls that share as much as they may: a tenth of a line more
/// than there is room for.
const WIDER: f64 = 0.1;
/// The cost of 1 mm of walls that are wider or narrower than they may be, beside the end
/// of a loop. A bead of 3 mm is not worth its ends.
const PINCHED: f64 = 0.6;
/// What 1 mm of walls costs more where they have no room any more. Through a neck as
/// thin as that they would lie on each other.
const TIGHT: f64 = 2.0;
/// The cost of 1 mm of a loop in a tip: it leads into corners of 35° or more. The end
/// of a bead comes nearer to sharper ones.
const LED: f64 = 3.0;
/// The cost of 1 mm of a single bead that is stretched farther, over a short length.
const BULGED: f64 = 1.0;
/// The cost of 1 mm that has room for a bead and has none. With 3.5, loops end where
/// their sides meet in corners of 45°: six times as many tips of a gyroid block are
/// more than 0.3 mm from a bead.
const OPEN: f64 = 6.0;
/// The cost of 1 mm that is too thin for a bead of its own, but not for one to go
/// on.
const FAINT: f64 = 0.1;
/// The cost of 1 mm of beads that do not fit.
const WRONG: f64 = 20.0;

/// Thicknesses for which there is one number of beads.
#[derive(Clone, Copy, Debug)]
struct Beading {
    /// The nominal upper bound; the lower one is that of the beading before.
    upto: Mm,
    /// Least and greatest thickness to which this number of beads can be
    /// stretched.
    range: (Mm, Mm),
    /// Least and greatest thickness to which the beads can be stretched over a
    /// short length, as at a loop's end or in a bend.
    short: (Mm, Mm),
}

/// What is special about a place on an axis.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// A single bead there leaves nothing open.
    bends: bool,
    /// The loop of the first wall may lead into the tip there.
    tip: bool,
}

/// Tells whether a bead along a part of an axis leaves nothing open beside it.
pub(super) type Bends<'a> = &'a dyn Fn(&Axis) -> bool;

/// The numbers of beads that thicknesses get.
#[derive(Debug)]
pub(super) struct Beadings {
    /// An entry for each number of beads. Thicker places have these walls and
    /// more inside.
    beadings: Vec<Beading>,
    /// Thickness down to which the loop of the first wall leads into tips.
    tips: Option<Mm>,
    /// The number with which the innermost wall shares what is too thin for a whole
    /// line. What has more beads is not a matter of walls.
    shared: Option<usize>,
    /// The thicknesses at which costs change, in order.
    bounds: Vec<Mm>,
    /// For each stretch of thicknesses between bounds, the costs of the borders
    /// between numbers, once an axis has asked: it asks for each of them at each of
    /// its points.
    borders: OnceCell<Vec<Vec<f64>>>,
}

impl Beadings {
    /// The numbers for walls laid one inside the other. A bead in the middle can
    /// take the place of both sides of each wall. `inside` is what lies inside
    /// all of the walls, if anything does.
    pub(super) fn new(walls: &[Lay], inside: Option<Lay>) -> Beadings {
        let mut beadings = Vec::new();
        let mut depth = 0.0;
        // Narrowest places that the walls so far can be squeezed into, and in
        // which their loop closes.
        let (mut squeezed, mut closed) = (0.0, 0.0);
        let all = walls.iter().copied().chain(inside);
        for (k, wall) in all.enumerate() {
            // Skin fills what it can.
            let share = if (1..walls.len()).contains(&k) {
                wall.least.max(BETWEEN * wall.width)
            } else {
                wall.least
            };
            let closes = depth + 2.0 * wall.centre;
            let sliver = if depth > 0.0 { WIDEN * share } else { share };
            let bulge = if depth > 0.0 { closes + ROUNDER } else { depth };
            beadings.push(Beading {
                upto: depth + share,
                range: (squeezed, depth + sliver),
                short: (closed, bulge),
            });
            let wide = wall.limit * WIDE;
            beadings.push(Beading {
                upto: depth + wall.limit,
                range: (depth + wall.least / NARROW, depth + wide),
                short: (
                    depth + wall.least / NARROW,
                    depth + BULGE * wall.limit,
                ),
            });
            squeezed = depth + SQUEEZE * 2.0 * wall.inner;
            closed = closes;
            depth += 2.0 * wall.inner;
        }
        if inside.is_some() {
            // The area inside has a bead of its own: only its bound counts.
            beadings.pop();
            if let Some(last) = beadings.last_mut() {
                last.range.1 = last.upto;
                last.short.1 = last.upto;
            }
        }
        let mut bound: Mm = 0.0;
        for beading in &mut beadings {
            bound = bound.max(beading.upto);
            beading.upto = bound;
        }
        let of =
            |c: &Beading| [c.upto, c.range.0, c.range.1, c.short.0, c.short.1];
        let mut bounds: Vec<Mm> = beadings.iter().flat_map(of).collect();
        bounds.sort_by(f64::total_cmp);
        bounds.dedup();
        Beadings {
            beadings,
            tips: None,
            shared: None,
            bounds,
            borders: OnceCell::new(),
        }
    }

    /// The costs of all borders where the area has a thickness, those to the same number
    /// together.
    fn borders_at(&self, t: Mm) -> Vec<f64> {
        let all = 0..=self.beadings.len();
        let pairs = all.clone().flat_map(|n| all.clone().map(move |m| (m, n)));
        pairs.map(|(m, n)| self.border(m, n, t)).collect()
    }

    /// The numbers where both sides of the innermost wall become wider until a whole
    /// line of what is `inside` fits between them. That line has a number of its own,
    /// as its ends cost as much as others.
    pub(super) fn with_shared(mut self, wall: &Lay, inside: &Lay) -> Beadings {
        // Thickness that the two sides can take in before they are too wide.
        let most = 2.0 * (wall.limit + wall.extra - wall.width);
        let whole = inside.inner.min(most);
        let shared = self.beadings.len().saturating_sub(1);
        let Some(last) = self.beadings.last_mut() else {
            return self;
        };
        if whole <= inside.least || inside.limit <= whole {
            return self;
        }
        let (least, depth) = (last.upto, last.upto - inside.least);
        let upto = depth + inside.limit;
        let stays = depth + (STAY * whole).min(most);
        let corner = stays.max(depth + most).min(upto);
        last.upto = depth + whole;
        last.range.1 = stays;
        last.short.1 = corner;
        self.beadings.push(Beading {
            upto,
            range: (least, upto),
            short: (least, upto),
        });
        self.shared = Some(shared);
        self.bounds.extend([depth + whole, stays, corner, upto]);
        self.bounds.sort_by(f64::total_cmp);
        self
    }

    /// The numbers where the loop of the first wall leads into tips, down to a
    /// thickness.
    pub(super) fn with_tips(mut self, least: Mm) -> Beadings {
        self.tips = Some(least);
        let at = self.bounds.partition_point(|b| *b < least);
        self.bounds.insert(at, least);
        self
    }

    /// The number of beads from which on a place is too thick to matter.
    fn few(&self) -> usize {
        self.shared.map_or(self.beadings.len(), |n| n + 1)
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

    /// The cost of 1 mm with a number of beads where the area has a thickness, which has
    /// a `nominal` number of them.
    fn cost(
        &self,
        (nominal, number): (usize, usize),
        thickness: Mm,
        Place { bends, tip }: Place,
    ) -> f64 {
        let Some(c) = self.beadings.get(number) else {
            return if nominal == number { 0.0 } else { WRONG };
        };
        if number == 0 {
            // What is too thin by itself may still continue a bead.
            let narrow = self.beadings.get(1).map_or(0.0, |c| c.range.0);
            return match nominal {
                0 if thickness > narrow => FAINT,
                0 => 0.0,
                _ => OPEN,
            };
        }
        if nominal == number {
            return 0.0;
        }
        let lower = self.beadings[number - 1].upto;
        let (beyond, stretch, short) = if nominal < number {
            (lower - thickness, lower - c.range.0, lower - c.short.0)
        } else {
            let [most, short] = [c.range.1, c.short.1];
            (thickness - c.upto, most - c.upto, short - c.upto)
        };
        if beyond <= stretch {
            let shares = nominal > number && self.shared == Some(number);
            (if shares { WIDER } else { STRETCHED }) * beyond / stretch
        } else if tip && number == 2 && self.tips.is_some_and(|t| t < thickness)
        {
            LED
        } else if beyond > short || (number == 1 && !bends) {
            WRONG
        } else if self.is_single(number) {
            BULGED
        } else if nominal > number {
            PINCHED
        } else {
            let stretch = stretch.max(0.0);
            let depth = (beyond - stretch) / (short - stretch);
            PINCHED + TIGHT * depth.powi(4)
        }
    }

    /// True if one of so many beads lies in the middle.
    fn is_single(&self, number: usize) -> bool {
        number < self.beadings.len() && !number.is_multiple_of(2)
    }

    /// The cost of the border between two parts with these numbers of beads, where
    /// the area has a thickness.
    fn border(&self, a: usize, b: usize, thickness: Mm) -> f64 {
        let closes = |n: usize| {
            let loops = self.beadings.get(n);
            loops.is_none_or(|c| thickness <= c.short.0)
        };
        let single = [a, b].into_iter().filter(|&n| self.is_single(n));
        match single.count() {
            _ if a == b => 0.0,
            1 if a.min(b) == 0 && self.number(thickness) == 0 => STOP,
            // Elsewhere the loop would be cut open.
            0 if !closes(a.max(b)) => 2.0 * END,
            0 => LOOP,
            ends => END * ends as f64,
        }
    }

    /// Does what [`Beadings::split`] does for an axis that may have webs ([`web`]);
    /// nothing if it has none.
    pub(super) fn split_at_webs(
        &self,
        axis: &Axis,
        bends: Bends<'_>,
    ) -> Option<Vec<(usize, Axis)>> {
        let [bead, _] = self.of_webs()?;
        let axis = axis.refined(&[web::LEAST * bead]).refined(&self.bounds);
        let mut numbers = self.numbers(&axis, bends);
        web::lay(&axis, bead, &mut numbers)
            .then(|| self.parts(&axis, &numbers, true))
    }

    /// The parts of an axis and their numbers of beads, without those that are
    /// too thick to have one.
    pub(super) fn split(
        &self,
        axis: &Axis,
        bends: Bends<'_>,
    ) -> Vec<(usize, Axis)> {
        let few = self.few();
        let (thin, thick) = (axis.thinnest(), axis.thickest());
        let (low, high) = (self.number(thin), self.number(thick));
        if low == high
            && (high < 2
                || high >= few
                || axis.closed
                || high.is_multiple_of(2))
        {
            let whole = (high < few).then(|| (high, axis.clone()));
            return whole.into_iter().collect();
        }
        let axis = axis.refined(&self.bounds);
        let numbers = self.numbers(&axis, bends);
        self.parts(&axis, &numbers, false)
    }

    /// The parts of an axis with these numbers of beads. `webs` is true if single beads
    /// may be wider than their place: as wide as the thinnest bead.
    fn parts(
        &self,
        axis: &Axis,
        numbers: &[usize],
        webs: bool,
    ) -> Vec<(usize, Axis)> {
        let few = self.few();
        let thinnest = self.beadings.first().map_or(0.0, |none| none.upto);
        let mut parts = axis.parts(numbers);
        for (number, part) in &mut parts {
            if let Some(c) = self.beadings.get(*number) {
                let most = c.range.1.max(c.short.1);
                let web = webs && *number == 1;
                let least = if web { thinnest } else { 0.0 };
                let fits = |t: &mut Mm| *t = t.max(least).min(most);
                part.thickness.iter_mut().for_each(fits);
            }
        }
        parts.retain(|(number, _)| *number < few);
        parts
    }

    /// The number of beads along each segment of an axis (dynamic programming, as
    /// in Viterbi 1967).
    fn numbers(&self, axis: &Axis, bends: Bends<'_>) -> Vec<usize> {
        let bent = self.bent(axis, bends);
        let tips = self.tips(axis);
        let places = bent.into_iter().zip(tips.iter().copied());
        let costs: Vec<f64> = axis
            .segments()
            .zip(places)
            .flat_map(|((a, b), (bends, tip))| {
                let [length, t] = [a.0.distance(b.0), 0.5 * (a.1 + b.1)];
                let place = Place { bends, tip };
                let all = 0..=self.beadings.len();
                let nominal = self.number(t);
                all.map(move |n| length * self.cost((nominal, n), t, place))
            })
            .collect();
        if !axis.closed {
            // A bead alone is no more of a stroke than a loop is.
            let alone = self.number(axis.thickest()) < 2;
            let stops = |n: usize| self.is_single(n) && !alone;
            let stop = |n: usize| if stops(n) { STOP } else { 0.0 };
            let mut numbers = self.cheapest(axis, &costs, stop, stop).1;
            self.lead_on(axis, &tips, &mut numbers);
            return numbers;
        }
        // The way round ends with the number that it begins with.
        let round = (0..=self.beadings.len()).map(|first| {
            let begin = |n: usize| if n == first { 0.0 } else { f64::INFINITY };
            let t = axis.thickness.first().copied().unwrap_or_default();
            self.cheapest(axis, &costs, begin, |n| self.border(n, first, t))
        });
        round
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or_else(Vec::new, |best| best.1)
    }

    /// Thicknesses from which on a single bead is laid, and the loop of the first wall
    /// closes; nothing inside of that wall, where nothing falls apart.
    pub(super) fn of_webs(&self) -> Option<[Mm; 2]> {
        self.tips?;
        let [none, _, two] = self.beadings.first_chunk()?;
        Some([none.upto, two.short.0])
    }

    /// The numbers whose costs together are the least, and these costs.
    fn cheapest(
        &self,
        axis: &Axis,
        costs: &[f64],
        begin: impl Fn(usize) -> f64,
        end: impl Fn(usize) -> f64,
    ) -> (f64, Vec<usize>) {
        let all = 0..=self.beadings.len();
        let count = self.beadings.len() + 1;
        let mut sums: Vec<f64> = all.clone().map(&begin).collect();
        let mut next = Vec::with_capacity(count);
        let mut from: Vec<usize> = Vec::with_capacity(costs.len());
        for (costs, &t) in costs.chunks_exact(count).zip(&axis.thickness) {
            next.clear();
            let borders = self.borders(t).chunks_exact(count);
            for (borders, cost) in borders.zip(costs) {
                let (least, before) = cheapest_before(&sums, borders);
                next.push(least + cost);
                from.push(before);
            }
            std::mem::swap(&mut sums, &mut next);
        }
        let last = |n: &usize| sums[*n] + end(*n);
        let mut n = all
            .min_by(|a, b| last(a).total_cmp(&last(b)))
            .unwrap_or_default();
        let sum = last(&n);
        let mut numbers: Vec<usize> = from
            .chunks_exact(count)
            .rev()
            .map(|before| {
                let number = n;
                n = before[number];
                number
            })
            .collect();
        numbers.reverse();
        (sum, numbers)
    }

    /// What `borders_at` gives.
    fn borders(&self, thickness: Mm) -> &[f64] {
        // What lies between two bounds costs the same as its end does.
        let all = self.borders.get_or_init(|| {
            let ends = self.bounds.iter().copied().chain([f64::INFINITY]);
            ends.map(|t| self.borders_at(t)).collect()
        });
        let between = self.bounds.partition_point(|b| *b < thickness);
        all.get(between).map_or(&[], Vec::as_slice)
    }

    /// For each segment of an axis, true if it is in a tip that the loop of the first
    /// wall may lead into.
    fn tips(&self, axis: &Axis) -> Vec<bool> {
        let count = axis.segments().count();
        let (Some(_), Some(two)) = (self.tips, self.beadings.get(2)) else {
            return vec![false; count];
        };
        // Where the area is thicker, the loop lies as it is.
        let closes = two.short.0;
        let [first, last] =
            [false, true].map(|last| axis.tip(last, closes).points.len());
        // A stretch of so many points has one segment less.
        (0..count)
            .map(|k| k + 1 < first || count - k < last)
            .collect()
    }

    /// Lets the loop of the first wall go on into a tip down to the least thickness
    /// of tips.
    fn lead_on(&self, axis: &Axis, tips: &[bool], numbers: &mut [usize]) {
        let Some(least) = self.tips else {
            return;
        };
        let fits: Vec<bool> = axis
            .segments()
            .zip(tips)
            .map(|((a, b), &tip)| tip && a.1.min(b.1) >= least)
            .collect();
        let n = numbers.len();
        for last in [false, true] {
            let at = |k: usize| if last { n - 1 - k } else { k };
            let begins = (0..n).find(|&k| numbers[at(k)] != 0);
            let Some(begins) = begins.filter(|&k| numbers[at(k)] == 2) else {
                continue;
            };
            for k in (0..begins).rev().take_while(|&k| fits[at(k)]) {
                numbers[at(k)] = 2;
            }
        }
    }

    /// For each segment of an axis, true if a single bead that bulges there leaves
    /// nothing open.
    fn bent(&self, axis: &Axis, bends: Bends<'_>) -> Vec<bool> {
        let wide = self.beadings.get(1).map(|c| (c.range.1, c.short.1));
        let bulges = |((_, v), (_, w)): &((_, Mm), (_, Mm))| {
            let t = 0.5 * (v + w);
            wide.is_some_and(|(from, to)| from < t && t <= to)
        };
        let kinds: Vec<usize> =
            axis.segments().map(|s| usize::from(bulges(&s))).collect();
        let mut bent = Vec::with_capacity(kinds.len());
        for (kind, part) in axis.opened().parts(&kinds) {
            let count = part.points.len() - 1;
            bent.resize(bent.len() + count, kind == 1 && bends(&part));
        }
        bent
    }
}

/// The least of some sums, each with the cost of the border after it, and its place.
fn cheapest_before(sums: &[f64], borders: &[f64]) -> (f64, usize) {
    let mut least = (f64::INFINITY, 0);
    for (place, (sum, border)) in sums.iter().zip(borders).enumerate() {
        if sum + border < least.0 {
            least = (sum + border, place);
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::WallPlan;
    use glam::DVec2;
    use isoslice_planar::bead::spacing;
    use isoslice_settings::testing::{plan_with, usual_plan};

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
    fn borders_cost_the_same_all_along_a_stretch() {
        let beadings = beadings().with_tips(0.2);
        let between = (0..300).map(|k| 0.01 * f64::from(k) + 0.005);
        for t in beadings.bounds.iter().copied().chain(between) {
            let found = beadings.borders(t);
            assert_eq!(found, beadings.borders_at(t), "{t}");
            assert!(found.iter().any(|cost| *cost > 0.0), "{t}");
        }
    }

    #[test]
    fn the_thicker_the_more_beads() {
        // Each number of beads goes on for longer than parts have to be.
        let wedge = axis(60.0, |x| 0.05 + x / 28.0);
        let parts = beadings().split(&wedge, &|_| false);
        assert_eq!(numbers(&parts), [0, 1, 2, 3, 4]);
        // One bead from thin_min, 60 %, to thin_max, 180 % of 0.45 mm; it goes on a
        // little into the tip.
        let one = &parts[1].1;
        assert!((0.27 / NARROW..0.2701).contains(&one.thinnest()));
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
        let step = |x: f64| if x < 10.0 { 0.7 } else { 0.9 };
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
        assert_eq!(bend(1.8, 2.6), [3]);
        assert_eq!(bend(1.8, 14.0), [3, 4, 3]);
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

    #[test]
    fn a_loop_closes_where_a_strip_grows() {
        // From two walls to four, slowly and fast.
        let grows = |length: f64| {
            let t = move |x: f64| 1.0 + 0.8 * (x / length).min(1.0);
            beadings().split(&axis(40.0, t), &|_| false)
        };
        let fast = grows(3.0);
        assert_eq!(numbers(&fast), [2, 4]);
        // As thick as the ring's depth on both sides, an outer wall and a half of
        // a spacing.
        let closes = 0.45 + 2.0 * spacing(0.45, 0.45, 0.2);
        assert!((fast[1].1.thickness[0] - closes).abs() < 1e-3);
        assert_eq!(numbers(&grows(30.0)), [2, 3, 4]);
    }

    /// Wherever the bounds lie, no number costs less than nothing, and a strip that
    /// has just one number's thickness has this number.
    #[test]
    fn a_strip_has_the_number_of_its_thickness() {
        for most in [100.0, 120.0, 145.0, 180.0, 200.0] {
            let plan = plan_with(WallPlan::of, |s| s.thin_max = most);
            let [outer, inner] = [0, 1].map(|k| plan.lay(k, 0.2));
            let beadings = Beadings::new(&[outer, inner], Some(inner));
            for i in 0..90 {
                let t = 0.2 + 0.02 * f64::from(i);
                let bends = Place {
                    bends: true,
                    tip: false,
                };
                for number in 0..6 {
                    let numbers = (beadings.number(t), number);
                    assert!(beadings.cost(numbers, t, bends) >= 0.0);
                }
                let strip = axis(12.0, |_| t);
                let one = t > outer.least && t <= outer.limit;
                let found = numbers(&beadings.split(&strip, &|_| false));
                assert_eq!(found == [1], one, "{most} {t}: {found:?}");
            }
        }
    }

    #[test]
    fn two_walls_lead_into_blunt_tips_and_a_bead_into_sharp_ones() {
        let tip = |degrees: f64| {
            let slope = 2.0 * (0.5 * degrees).to_radians().tan();
            let wedge = axis(6.0, |x| (slope * x).min(1.0));
            numbers(&beadings().split(&wedge, &|_| false))
        };
        assert_eq!(tip(70.0), [0, 2]);
        assert_eq!(tip(45.0), [0, 1, 2]);
        // The first wall's loop leads into a tip from some angle on.
        let led = |degrees: f64| {
            let slope = 2.0 * (0.5 * degrees).to_radians().tan();
            let wedge = axis(6.0, |x| (slope * x).min(1.0));
            let beadings = beadings().with_tips(0.2);
            let parts = beadings.split(&wedge, &|_| false);
            let thinnest =
                parts.iter().find(|p| p.0 == 2).unwrap().1.thinnest();
            (numbers(&parts), thinnest)
        };
        let (sharp, begins) = led(25.0);
        assert_eq!(sharp, [0, 1, 2]);
        assert!(begins > 0.6, "{begins}");
        for degrees in [45.0, 55.0] {
            let (blunt, begins) = led(degrees);
            assert_eq!(blunt, [0, 2]);
            assert!((0.2..0.21).contains(&begins), "{degrees}: {begins}");
        }
        // A tooth as thin as a bead has no room for two.
        let tooth = axis(6.0, |x| if x < 1.0 { 0.4 } else { 1.0 });
        let all = beadings().split(&tooth, &|_| false);
        assert_eq!(numbers(&all), [1, 2]);
    }
}
