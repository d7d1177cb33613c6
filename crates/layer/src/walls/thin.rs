//! How many beads lie side by side along a ridge.
//!
//! The thickness along a ridge decides: nothing fits up to the first bound, one
//! bead up to the second, then two walls, two walls with a bead between them,
//! and so on. In: a ridge. Out: the parts of the ridge, each with its number of
//! beads.
//!
//! A thickness that wavers around a bound would chop beads and walls into
//! pieces too short to print, and each change of number is a place where beads
//! end. A number of beads therefore goes on for a while beyond its bounds: the
//! beads become a little wider or narrower there. It is the hysteresis that
//! Kuipers and others describe in *A framework for adaptive width control of
//! dense contour-parallel toolpaths* (2020), decided for whole parts at a time.

use super::Lay;
use super::ridge::Ridge;
use isoslice_base::units::Mm;

/// By how much a single bead may be narrower than its bound for a while.
const NARROW: f64 = 1.25;
/// By how much a single bead may be wider than its bound. The wider a round bead
/// is, the more it leaves open in corners.
const WIDE: f64 = 1.12;
/// Share of their nominal thickness down to which two walls can stay side by
/// side for a while.
const SQUEEZE: f64 = 0.75;
/// By how much the sliver between two walls may pass its bound for a while.
const WIDEN: f64 = 1.25;
/// Parts shorter than this take the number of a neighbour, if its beads can
/// be made to fit, mm.
const SHORT: Mm = 4.0;
/// By how much a bead, alone or between two walls, may be wider where its place
/// has room for two beads, but only over a short length. Of two beads there, one
/// would be too short to print, and would leave a pit beside the other.
const BULGE: f64 = 1.25;
/// Longest bulge, as a share of its greatest width.
const BULGE_LENGTH: f64 = 1.1;
/// Longest bulge of a bead that lies between no others. Nothing is laid twice
/// there, however long it is.
const BEND_LENGTH: f64 = 1.6;
/// Parts are merged in so many rounds, the shortest ones first.
const ROUNDS: u32 = 5;

/// Thicknesses for which there is one number of beads.
#[derive(Clone, Copy, Debug)]
struct Count {
    /// The nominal upper bound; the lower one is that of the count before.
    upto: Mm,
    /// Least and greatest thickness to which this number of beads can be
    /// stretched.
    range: (Mm, Mm),
    /// Greatest thickness to which the beads can be stretched over a short
    /// length, as in a bend.
    bulge: Mm,
    /// Thickness that the walls outside of the innermost bead or pair take.
    taken: Mm,
}

/// Tells whether a bead along a part of a ridge leaves nothing open beside it.
pub(super) type Bends<'a> = &'a dyn Fn(&Ridge) -> bool;

/// The numbers of beads that thicknesses get.
#[derive(Debug)]
pub(super) struct Counts {
    /// An entry for each number of beads. Thicker places have these walls and
    /// more inside.
    counts: Vec<Count>,
}

impl Counts {
    /// The numbers for walls laid one inside the other. A bead in the middle can
    /// take the place of both sides of each wall. `inside` is what lies inside
    /// all of the walls, if anything does.
    pub(super) fn new(walls: &[Lay], inside: Option<Lay>) -> Counts {
        let mut counts = Vec::new();
        let mut depth = 0.0;
        // Narrowest place that the walls so far can be squeezed into.
        let mut squeezed = 0.0;
        for wall in walls.iter().copied().chain(inside) {
            let least = depth + wall.least;
            let sliver = if depth > 0.0 {
                WIDEN * wall.least
            } else {
                wall.least
            };
            counts.push(Count {
                upto: least,
                range: (squeezed, depth + sliver),
                bulge: depth + sliver,
                taken: depth,
            });
            let wide = wall.limit * WIDE;
            counts.push(Count {
                upto: depth + wall.limit,
                range: (depth + wall.least / NARROW, depth + wide),
                bulge: depth + BULGE * wide,
                taken: depth,
            });
            squeezed = depth + SQUEEZE * 2.0 * wall.inner;
            depth += 2.0 * wall.inner;
        }
        if inside.is_some() {
            // The area inside has a bead of its own: only its bound counts.
            counts.pop();
            if let Some(last) = counts.last_mut() {
                last.range.1 = last.upto;
            }
        }
        let mut bound: Mm = 0.0;
        for count in &mut counts {
            bound = bound.max(count.upto);
            count.upto = bound;
        }
        Counts { counts }
    }

    /// The greatest thickness that matters. A bulge that is thicker is left out:
    /// to look farther around costs more than it gains.
    pub(super) fn limit(&self) -> Mm {
        let all = self.counts.iter().map(|c| c.upto.max(c.range.1));
        all.fold(0.0, f64::max)
    }

    /// The number of beads for a thickness.
    fn number(&self, thickness: Mm) -> usize {
        self.counts.partition_point(|c| c.upto < thickness)
    }

    /// True if a number of beads can be made to fit all along a ridge. If there
    /// are as many at both its ends, `between` them, they may bulge. What is
    /// left open beside a bulge at the surface would be seen, so there a ridge
    /// has to be one of `bends`.
    fn fits(
        &self,
        number: usize,
        ridge: &Ridge,
        between: bool,
        bends: Bends<'_>,
    ) -> bool {
        self.counts.get(number).is_some_and(|c| {
            let inside = c.taken > 0.0;
            let most = if inside { BULGE_LENGTH } else { BEND_LENGTH };
            let longest = most * (c.bulge - c.taken);
            let bulges = between
                && ridge.length() < longest
                && ridge.thickest() <= c.bulge
                && (inside || bends(ridge));
            let most = if bulges { c.bulge } else { c.range.1 };
            ridge.thinnest() >= c.range.0 && ridge.thickest() <= most
        })
    }

    /// The parts of a ridge and their numbers of beads, without those that are
    /// too thick to have one.
    pub(super) fn split(
        &self,
        ridge: &Ridge,
        bends: Bends<'_>,
    ) -> Vec<(usize, Ridge)> {
        let few = self.counts.len();
        let (thin, thick) = (ridge.thinnest(), ridge.thickest());
        let (low, high) = (self.number(thin), self.number(thick));
        if low == high {
            return if high < few {
                vec![(high, ridge.clone())]
            } else {
                Vec::new()
            };
        }
        let mut parts = vec![ridge.clone()];
        for count in &self.counts[low..high.min(few)] {
            parts = parts
                .into_iter()
                .flat_map(|part| part.split_at(count.upto))
                .collect();
        }
        let mut all: Vec<(usize, Ridge)> = parts
            .into_iter()
            .map(|part| (self.number(part.middle_thickness()), part))
            .collect();
        if ridge.closed && all.len() > 1 {
            // The line was opened at its first point, perhaps within a part:
            // let it begin with its longest one.
            let longest = (0..all.len())
                .max_by(|&i, &j| {
                    all[i].1.length().total_cmp(&all[j].1.length())
                })
                .unwrap_or(0);
            all.rotate_left(longest);
        }
        for round in (0..ROUNDS).rev() {
            let short = SHORT / f64::from(1 << round);
            all = self.merged(all, short, ridge.closed, bends);
        }
        for (number, part) in &mut all {
            // A bead needs some length, or it is but a widening of the walls.
            let single = *number % 2 == 1 && *number < few;
            if !single {
                continue;
            }
            let width = part.thickest() - self.counts[*number].taken;
            if part.length() < 0.5 * width {
                *number -= 1;
                let count = &self.counts[*number];
                let most = count.upto + 2.0 * (count.range.1 - count.upto);
                part.thickness.iter_mut().for_each(|t| *t = t.min(most));
            }
        }
        all.retain(|(number, _)| *number < few);
        all
    }

    /// Lets parts shorter than `short` take the number of a neighbour, if it
    /// fits, and joins neighbours of one number.
    fn merged(
        &self,
        parts: Vec<(usize, Ridge)>,
        short: Mm,
        closed: bool,
        bends: Bends<'_>,
    ) -> Vec<(usize, Ridge)> {
        let first = parts.first().map(|p| p.0).filter(|_| closed);
        let mut merged: Vec<(usize, Ridge)> = Vec::with_capacity(parts.len());
        let mut rest = parts.into_iter().peekable();
        while let Some((mut number, part)) = rest.next() {
            let before = merged.last().map(|p| p.0);
            let after = rest.peek().map(|p| p.0).or(first);
            if part.length() < short && Some(number) != before {
                let same = before == after;
                let fits = |n: &usize| self.fits(*n, &part, same, bends);
                // Where the numbers of both neighbours fit, the one nearer to
                // this number is taken.
                let mut beside: Vec<usize> =
                    before.into_iter().chain(after).filter(fits).collect();
                beside.sort_by_key(|n| n.abs_diff(number));
                if let Some(&n) = beside.first()
                    && (same
                        || before.is_none()
                        || after.is_none()
                        || part.length() < 0.25 * SHORT)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::WallPlan;
    use glam::DVec2;
    use isoslice_settings::Settings;

    /// Two walls, and skin inside them.
    fn counts() -> Counts {
        let [outer, inner] =
            [0, 1].map(|k| WallPlan::of(&Settings::default()).lay(k, 0.2));
        Counts::new(&[outer, inner], Some(inner))
    }

    /// A straight ridge with a point each 0.1 mm.
    fn ridge(length: f64, thickness: impl Fn(f64) -> f64) -> Ridge {
        let n = (length / 0.1).round() as usize;
        let x: Vec<f64> = (0..=n).map(|i| 0.1 * i as f64).collect();
        Ridge {
            points: x.iter().map(|&x| DVec2::X * x).collect(),
            thickness: x.iter().map(|&x| thickness(x)).collect(),
            closed: false,
        }
    }

    fn numbers(parts: &[(usize, Ridge)]) -> Vec<usize> {
        parts.iter().map(|p| p.0).collect()
    }

    #[test]
    fn the_thicker_the_more_beads() {
        // Each number of beads goes on for longer than parts have to be.
        let wedge = ridge(60.0, |x| 0.05 + x / 28.0);
        let parts = counts().split(&wedge, &|_| false);
        assert_eq!(numbers(&parts), [0, 1, 2, 3, 4]);
        // One bead from thin_min, 60 %, to thin_max, 180 % of 0.45 mm.
        let one = &parts[1].1;
        assert!((one.thinnest() - 0.27).abs() < 1e-6);
        assert!((one.thickest() - 0.81).abs() < 1e-6);
        // Two walls and the least bead between them: 2·0.428 + 0.227.
        assert!((parts[3].1.thinnest() - 1.084).abs() < 1e-3);
        // Where a bead fits inside four walls, skin takes over.
        assert!((parts[4].1.thickest() - 1.898).abs() < 1e-3);
    }

    #[test]
    fn a_thickness_that_wavers_keeps_its_number() {
        let wavers = |middle: f64, by: f64| {
            let t = move |x: f64| middle + by * (2.0 * x).sin();
            counts().split(&ridge(30.0, t), &|_| false)
        };
        for (middle, by) in [(0.83, 0.1), (1.084, 0.05), (1.65, 0.15)] {
            let parts = wavers(middle, by);
            assert_eq!(parts.len(), 1, "{middle}: {:?}", numbers(&parts));
        }
        // No number of beads fits all of this ridge.
        assert!(wavers(1.0, 0.6).len() > 8);
    }

    #[test]
    fn what_is_long_has_the_number_that_fits_best() {
        let step = |x: f64| if x < 10.0 { 0.78 } else { 0.87 };
        let parts = counts().split(&ridge(20.0, step), &|_| false);
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
            numbers(&counts().split(&ridge(20.0, t), &|_| false))
        };
        // Wider than a bead may be for long, 1.716 mm.
        assert_eq!(bend(1.85, 2.6), [3]);
        assert_eq!(bend(1.85, 8.0), [3, 4, 3]);
        // Wider than two walls and a bulge.
        assert!(bend(2.0, 2.6).contains(&4));
        // One bead alone bulges in a bend only.
        let t = |x: f64| 0.6 + 0.4 * (1.0 - (x - 10.0).abs()).max(0.0);
        assert_eq!(
            numbers(&counts().split(&ridge(20.0, t), &|_| false)),
            [1, 2, 1]
        );
        let bent = counts().split(&ridge(20.0, t), &|_| true);
        assert_eq!(numbers(&bent), [1]);
    }

    #[test]
    fn a_closed_ridge_may_begin_anywhere() {
        let n = 300;
        let all = |shift: usize| Ridge {
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
            let parts = counts().split(&all(shift), &|_| false);
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
