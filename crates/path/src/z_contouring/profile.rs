//! How the height of the nozzle goes on along a path.
//!
//! In: knots along a path, some of which lie open to the surface and know how
//! high the nozzle has to be. Out: knots that all know it. Between stretches
//! that lie open the nozzle comes down to the layer's top, or goes over from
//! one height to the other, without a jump and without a bend of its way.

use isoslice_base::units::Mm;
use isoslice_planar::simplify::keep_farthest;

/// What a knot knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KnotKind {
    /// The knot lies open below the surface, which tells the height.
    Open,
    /// The knot lies open, but no height suits it: an edge, a cliff.
    Bare,
    /// The next layer covers the knot.
    Covered,
}

/// A place along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    /// Length of the path up to the place, mm.
    pub at: Mm,
    /// What the knot knows.
    pub kind: KnotKind,
    /// Height of the nozzle above the layer's top, mm.
    pub rise: Mm,
    /// By how much the material is higher than the layer, as a mean over the
    /// bead's width, mm.
    pub fill: Mm,
    /// True if the path has a point of its own here.
    pub corner: bool,
}

/// Greatest slope along a path. What is steeper is a cliff. The slope is a
/// little more than that of the steepest face which beads may follow in full.
const CLIFF: f64 = 0.75;

/// Height by which knots may differ at any distance, mm.
const HEIGHT_SLACK: Mm = 0.002;

/// Greatest slope with which a way over a gap begins and ends.
const STEEPEST: f64 = 0.5;

/// Knots of a ramp.
const STEPS: usize = 8;

/// Share of a ramp over which the material goes back to the layer's.
const FADE: f64 = 0.25;

/// Lengths that differ by less count as equal, mm.
const ALIKE: Mm = 1e-7;

/// One side of a gap: its place, the height there, the slope and the fill.
#[derive(Clone, Copy, Debug)]
struct GapSide {
    at: Mm,
    rise: Mm,
    slope: f64,
    fill: Mm,
}

/// Gives all knots of a path that ends where it begins their heights. It has no
/// jump and no bend there either.
pub(super) fn filled_round(mut knots: Vec<Knot>, ramp: Mm) -> Vec<Knot> {
    let open = |k: &Knot| k.kind == KnotKind::Open;
    let Some(first) = knots.iter().position(open) else {
        return filled(knots, ramp);
    };
    let last = knots.len() - 1;
    let length = knots[last].at;
    // One place, which the stretches on both sides of it know.
    if first == 0 || open(&knots[last]) {
        let known = if first == 0 { knots[0] } else { knots[last] };
        knots[0] = Knot { at: 0.0, ..known };
        let corner = knots[last].corner;
        knots[last] = Knot {
            at: length,
            corner,
            ..known
        };
        return filled(knots, ramp);
    }
    // The path from an open knot on, once round. The knot before tells the slope
    // at the end of a gap.
    let second = knots.windows(2).position(|w| w.iter().all(open));
    let start = second.map_or(first, |k| k + 1);
    let moved = |k: &Knot, by: Mm| Knot {
        at: k.at + by,
        ..*k
    };
    let before = knots[1..=start].iter().map(|k| moved(k, length));
    let turned = knots[start..].iter().copied().chain(before).collect();
    let turned = filled(turned, ramp);
    let seam = turned.partition_point(|k| k.at < length - ALIKE);
    let begin = turned[seam..].iter().map(|k| moved(k, -length));
    begin
        .chain(turned[1..=seam.min(turned.len() - 1)].iter().copied())
        .collect()
}

/// Gives all knots their heights. `ramp` is the length over which the nozzle
/// comes down to the layer's top.
pub(super) fn filled(mut knots: Vec<Knot>, ramp: Mm) -> Vec<Knot> {
    bare_cliffs(&mut knots, 0.5 * ramp);
    let n = knots.len();
    let mut out: Vec<Knot> = Vec::with_capacity(n);
    let mut i = 0;
    while i < n {
        if knots[i].kind == KnotKind::Open {
            out.push(knots[i]);
            i += 1;
            continue;
        }
        let end = (i..n)
            .find(|&k| knots[k].kind == KnotKind::Open)
            .unwrap_or(n);
        let before =
            i.checked_sub(1).map(|k| side(&knots, k, k.checked_sub(1)));
        let after = (end < n).then(|| {
            let next = Some(end + 1).filter(|&k| k < n);
            side(&knots, end, next)
        });
        out.extend(gap(&knots[i..end], before, after, ramp));
        i = end;
    }
    out
}

/// The knots without those that lie on the line between others: the rises to
/// `tolerance`, the fills to twice of it. Corners stay.
pub(super) fn thinned(knots: &[Knot], tolerance: Mm) -> Vec<Knot> {
    let mut keep: Vec<bool> = knots.iter().map(|k| k.corner).collect();
    keep_farthest(&mut keep, |from, to| {
        let (a, b) = (knots[from], knots[to]);
        let length = (b.at - a.at).max(f64::MIN_POSITIVE);
        let off = |k: &Knot| {
            let t = (k.at - a.at) / length;
            let rise = a.rise + t * (b.rise - a.rise);
            let fill = a.fill + t * (b.fill - a.fill);
            (k.rise - rise).abs().max(0.5 * (k.fill - fill).abs())
        };
        let mut inside = (from + 1..to).map(|i| (i, off(&knots[i])));
        let worst = inside.clone().map(|k| k.1).fold(0.0, f64::max);
        // Of several that are as far off, the first one, whatever the rounding.
        let first = inside.find(|k| k.1 >= worst - ALIKE);
        first.filter(|_| worst > tolerance).map(|k| k.0)
    });
    let all = knots.iter().zip(keep);
    all.filter(|k| k.1).map(|k| *k.0).collect()
}

/// Makes knots bare that are nearer to a cliff than `reach`, since no height suits
/// them.
fn bare_cliffs(knots: &mut [Knot], reach: Mm) {
    let open = |k: &Knot| k.kind == KnotKind::Open;
    let cliffs: Vec<Mm> = knots
        .windows(2)
        .filter(|w| w.iter().all(open))
        .filter(|w| {
            let most = CLIFF * (w[1].at - w[0].at) + HEIGHT_SLACK;
            (w[1].rise - w[0].rise).abs() > most
        })
        .map(|w| 0.5 * (w[0].at + w[1].at))
        .collect();
    for at in cliffs {
        let from = knots.partition_point(|k| k.at < at - reach);
        let near = knots[from..].iter_mut();
        for knot in near.take_while(|k| k.at <= at + reach) {
            if knot.kind == KnotKind::Open {
                knot.kind = KnotKind::Bare;
            }
        }
    }
}

/// The side of a gap at knot `k`; `next` is the knot farther from the gap.
fn side(knots: &[Knot], k: usize, next: Option<usize>) -> GapSide {
    let own = knots[k];
    let slope = next
        .map(|i| knots[i])
        .filter(|other| other.kind == KnotKind::Open && other.at != own.at)
        .map_or(0.0, |other| (other.rise - own.rise) / (other.at - own.at));
    GapSide {
        at: own.at,
        rise: own.rise,
        slope: slope.clamp(-STEEPEST, STEEPEST),
        fill: own.fill,
    }
}

/// The knots of a gap, and some more, with their heights.
fn gap(
    knots: &[Knot],
    before: Option<GapSide>,
    after: Option<GapSide>,
    ramp: Mm,
) -> Vec<Knot> {
    let bare = knots.iter().all(|k| k.kind == KnotKind::Bare);
    let narrow = match (before, after) {
        (Some(a), Some(b)) => b.at - a.at <= 2.0 * ramp,
        _ => false,
    };
    let ground = |at: Mm| GapSide {
        at,
        rise: 0.0,
        slope: 0.0,
        fill: 0.0,
    };
    let rise = |s: Mm| match (before, after) {
        (Some(a), Some(b)) if narrow => way(a, b, s),
        (Some(a), _) if s - a.at < ramp => way(a, ground(a.at + ramp), s),
        (_, Some(b)) if b.at - s < ramp => way(ground(b.at - ramp), b, s),
        _ => 0.0,
    };
    let fade = |side: Option<GapSide>, s: Mm| {
        let left = |side: GapSide| 1.0 - (s - side.at).abs() / (FADE * ramp);
        side.map_or(0.0, |side| side.fill * left(side).max(0.0))
    };
    let mut all = knots.to_vec();
    let (low, high) = (
        before.map_or(f64::NEG_INFINITY, |side| side.at),
        after.map_or(f64::INFINITY, |side| side.at),
    );
    let (first, last) = match knots {
        [first, .., last] => (first.at, last.at),
        [only] => (only.at, only.at),
        [] => return all,
    };
    for k in 1..=STEPS {
        let step = ramp * k as f64 / STEPS as f64;
        let both = [before.map(|a| a.at + step), after.map(|b| b.at - step)];
        // Not beyond the path's ends.
        let (from, to) =
            (before.map_or(first, |_| low), after.map_or(last, |_| high));
        let inside =
            both.into_iter().flatten().filter(|s| *s > from && *s < to);
        all.extend(inside.map(|at| Knot {
            at,
            kind: KnotKind::Covered,
            rise: 0.0,
            fill: 0.0,
            corner: false,
        }));
    }
    all.sort_by(|a, b| a.at.total_cmp(&b.at));
    for knot in &mut all {
        knot.rise = rise(knot.at);
        knot.fill = if bare {
            knot.rise
        } else {
            fade(before, knot.at) + fade(after, knot.at)
        };
        if bare {
            knot.kind = KnotKind::Bare;
        }
    }
    all
}

/// The height at `s` of the cubic from one side to another that has the slopes
/// of both (Hermite's).
fn way(a: GapSide, b: GapSide, s: Mm) -> Mm {
    let length = b.at - a.at;
    if length <= 0.0 {
        return b.rise;
    }
    let t = (s - a.at) / length;
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * a.rise
        + (t3 - 2.0 * t2 + t) * length * a.slope
        + (3.0 * t2 - 2.0 * t3) * b.rise
        + (t3 - t2) * length * b.slope
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(at: Mm, kind: KnotKind, rise: Mm) -> Knot {
        Knot {
            at,
            kind,
            rise,
            fill: rise,
            corner: false,
        }
    }

    /// Open up to 2 mm with a slope of 0.1, covered from there to `end`, and
    /// open again with the slope reversed.
    fn valley(end: Mm) -> Vec<Knot> {
        let mut knots: Vec<Knot> = (0..=20)
            .map(|i| 0.1 * f64::from(i))
            .map(|s| knot(s, KnotKind::Open, 0.1 * (s - 1.0)))
            .collect();
        knots.push(knot(0.5 * (2.0 + end), KnotKind::Covered, 9.0));
        let back = knots[..21].iter().rev();
        let back: Vec<Knot> = back
            .map(|k| knot(end + 2.0 - k.at, KnotKind::Open, k.rise))
            .collect();
        knots.extend(back);
        knots
    }

    #[test]
    fn ways_over_gaps_have_neither_jump_nor_bend() {
        for end in [2.2, 2.7, 3.2, 9.0] {
            let knots = filled(valley(end), 0.45);
            assert!(knots.is_sorted_by(|a, b| a.at < b.at));
            let slopes: Vec<f64> = knots
                .windows(2)
                .map(|w| (w[1].rise - w[0].rise) / (w[1].at - w[0].at))
                .collect();
            assert!(slopes.iter().all(|s| s.abs() < 0.5), "{slopes:?}");
            // A cubic with a slope of 0.1 that goes down by 0.1 mm over 0.45 mm
            // bends by (6·0.1 + 4·0.045)/0.45² = 3.9 a millimetre at its
            // beginning, and has 8 parts.
            let bend = slopes.windows(2).map(|w| (w[1] - w[0]).abs());
            assert!(bend.fold(0.0, f64::max) < 0.23, "{end} {slopes:?}");
            let middle = knots.iter().find(|k| k.kind == KnotKind::Covered);
            assert!(middle.unwrap().rise < 0.11);
            // What lies open keeps its heights.
            for k in knots.iter().filter(|k| k.at <= 2.0) {
                assert!((k.rise - 0.1 * (k.at - 1.0)).abs() < 1e-12);
            }
        }
        // A wide gap is at the layer's top, with the layer's material.
        let knots = filled(valley(9.0), 0.45);
        let deep = knots.iter().filter(|k| k.at > 2.46 && k.at < 8.54);
        let mut deep = deep.peekable();
        assert!(deep.peek().is_some());
        assert!(deep.all(|k| k.rise == 0.0 && k.fill == 0.0));
    }

    #[test]
    fn a_path_may_begin_and_end_under_cover() {
        let knots = vec![
            knot(0.0, KnotKind::Covered, 7.0),
            knot(0.2, KnotKind::Open, 0.1),
            knot(0.3, KnotKind::Open, 0.1),
            knot(2.0, KnotKind::Covered, 7.0),
        ];
        let knots = filled(knots, 0.4);
        assert_eq!(knots[0].at, 0.0);
        // Halfway down a ramp of 0.4 mm.
        assert!((knots[0].rise - 0.05).abs() < 1e-12, "{knots:?}");
        let last = knots.last().unwrap();
        assert_eq!((last.at, last.rise, last.fill), (2.0, 0.0, 0.0));
    }

    #[test]
    fn a_path_round_goes_on_where_it_ends() {
        // A valley whose middle is the place at which the path begins and ends.
        for width in [0.3, 0.6, 2.0] {
            let far = valley(2.0 + width);
            let middle = 0.5 * (2.0 + (2.0 + width));
            let end = far.last().unwrap().at;
            let (left, right): (Vec<Knot>, Vec<Knot>) =
                far.iter().partition(|k| k.at < middle);
            let at = |k: &Knot, at: Mm| Knot { at, ..*k };
            // The two ends of the valley are one place, at half of the way.
            let mut round: Vec<Knot> =
                right.iter().map(|k| at(k, k.at - middle)).collect();
            assert_eq!(round[0].kind, KnotKind::Covered);
            round.extend(
                left.iter().skip(1).map(|k| at(k, k.at + end - middle)),
            );
            round.push(knot(end, KnotKind::Covered, 9.0));
            let straight = filled(far, 0.45);
            let round = filled_round(round, 0.45);
            assert!(round.is_sorted_by(|a, b| a.at < b.at), "{round:?}");
            assert_eq!(round.first().unwrap().at, 0.0);
            assert_eq!(round.last().unwrap().at, end);
            for k in &straight {
                let own = (k.at - middle).rem_euclid(end);
                let same = round.iter().find(|r| (r.at - own).abs() < 1e-9);
                let same = same.unwrap_or_else(|| panic!("{k:?} {round:?}"));
                assert!((same.rise - k.rise).abs() < 1e-9, "{k:?} {same:?}");
                assert!((same.fill - k.fill).abs() < 1e-9);
            }
            let ends = [round[0], *round.last().unwrap()];
            assert!((ends[0].rise - ends[1].rise).abs() < 1e-12);
            assert_eq!(ends[0].fill, ends[1].fill);
        }
        // The seam at a border that only one side knows of.
        for (first, last) in [
            (KnotKind::Open, KnotKind::Covered),
            (KnotKind::Covered, KnotKind::Open),
        ] {
            let mut knots = valley(3.0);
            let end = knots.last().unwrap().at;
            let rise = knots[0].rise;
            knots[0].kind = first;
            knots.last_mut().unwrap().kind = last;
            let knots = filled_round(knots, 0.45);
            let ends = [knots[0], *knots.last().unwrap()];
            assert_eq!(ends.map(|k| k.rise), [rise; 2]);
            assert_eq!(ends.map(|k| k.at), [0.0, end]);
        }
    }

    #[test]
    fn a_cliff_becomes_a_slope_with_all_of_its_material() {
        let knots: Vec<Knot> = (0..40)
            .map(|i| 0.1 * f64::from(i))
            .map(|s| knot(s, KnotKind::Open, if s < 2.0 { 0.0 } else { 0.1 }))
            .collect();
        let knots = filled(knots, 0.45);
        let steepest = knots
            .windows(2)
            .map(|w| (w[1].rise - w[0].rise) / (w[1].at - w[0].at));
        assert!(steepest.fold(0.0, f64::max) < 0.5);
        assert!(knots.iter().all(|k| k.fill == k.rise));
    }

    #[test]
    fn thinned_knots_are_near_to_all() {
        let height = |s: Mm| 0.1 * (0.8 * s).sin();
        let knots: Vec<Knot> = (0..=200)
            .map(|i| 0.05 * f64::from(i))
            .map(|s| knot(s, KnotKind::Open, height(s)))
            .collect();
        let few = thinned(&knots, 0.0015);
        // A chord of length l is off by l²·0.8²·0.1/8: l is 0.43 mm where the
        // way bends most.
        assert!((15..35).contains(&few.len()), "{}", few.len());
        for pair in few.windows(2) {
            for k in &knots {
                if k.at < pair[0].at || k.at > pair[1].at {
                    continue;
                }
                let t = (k.at - pair[0].at) / (pair[1].at - pair[0].at);
                let rise = pair[0].rise + t * (pair[1].rise - pair[0].rise);
                assert!((rise - k.rise).abs() <= 0.0015);
            }
        }
        // Of a straight way only ends and corners stay.
        let mut line: Vec<Knot> = (0..=20)
            .map(|i| knot(f64::from(i), KnotKind::Open, 0.01 * f64::from(i)))
            .collect();
        line[7].corner = true;
        let few: Vec<Mm> =
            thinned(&line, 0.0015).iter().map(|k| k.at).collect();
        assert_eq!(few, [0.0, 7.0, 20.0]);
    }
}
