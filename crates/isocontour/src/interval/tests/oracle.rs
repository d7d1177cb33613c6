//! These intervals against those of the `maryada` crate, which rounds outwards
//! as IEEE 1788.1 asks. The oracle shares no code with these intervals.
//!
//! Random operands are tested in two ways: an interval must hold what the
//! oracle says of single points inside, and its ends must be the oracle's ends.
//!
//! The oracle has no `compare`, `modulo`, `and`, `or` and `not`. The first two
//! are put together from what it has. The last three only choose between their
//! operands, so there is no arithmetic to judge.

use super::Interval;
use fastrand::Rng;
use maryada::{self as oracle, IntervalOps};
use std::f64::consts::{FRAC_PI_2, PI};

/// How far an end may be from the oracle's, in units of its last digit. Our
/// ends are rounded to nearest, most of them once, quotients by the reciprocal
/// twice. The standard library's functions add another digit. The oracle's ends
/// are rounded outwards, and its own functions in several steps.
const ULPS: f64 = 16.0;

fn theirs(i: Interval) -> oracle::Interval {
    oracle::Interval::new(i.lo, i.hi)
}

fn ends(i: oracle::Interval) -> Option<(f64, f64)> {
    (!oracle::is_empty(i)).then(|| (oracle::inf(i), oracle::sup(i)))
}

/// One end of an interval: of any size, round, or infinite.
fn number(rng: &mut Rng, infinite: bool) -> f64 {
    let sign = if rng.bool() { 1.0 } else { -1.0 };
    let size = match rng.u8(0..8) {
        0 => 0.0,
        1 => f64::from(rng.u8(0..12)),
        2 if infinite => f64::INFINITY,
        2 | 3 => rng.f64(),
        4 | 5 => 10.0 * rng.f64(),
        6 => 500.0 * rng.f64(),
        _ => 10_f64.powf(rng.f64() * 12.0 - 6.0),
    };
    // This avoids a negative zero: to the oracle there is only one zero.
    sign * size + 0.0
}

fn interval(rng: &mut Rng) -> Interval {
    let a = number(rng, true);
    let b = match rng.u8(0..8) {
        0 if a.is_finite() => a,
        1..4 if a.is_finite() => a + number(rng, false) * 0.01,
        _ => number(rng, true),
    };
    // An infinity may be an end, but it is no number that an interval could
    // hold.
    let b = if a.is_infinite() && a == b { 0.0 } else { b };
    Interval::new(a.min(b), a.max(b))
}

/// Finite numbers inside an interval, its ends among them.
fn members(i: Interval, rng: &mut Rng) -> Vec<f64> {
    let (lo, hi) = (i.lo.max(-1e6), i.hi.min(1e6));
    let between = (0..4).map(|_| lo + (hi - lo) * rng.f64());
    [i.lo, i.hi, 0.0, lo, hi]
        .into_iter()
        .chain(between)
        .filter(|v| v.is_finite() && i.contains(*v))
        .collect()
}

/// Digits that may be lost at a value. `absolute` is what the rounding of the
/// operands themselves amounts to.
fn slack(v: f64, absolute: f64) -> f64 {
    ULPS * f64::EPSILON * (v.abs().min(f64::MAX / ULPS) + absolute)
        + f64::MIN_POSITIVE
}

/// True if an interval holds some of what the oracle says of a point. The
/// point's exact value is in there as well.
fn holds(ours: Interval, point: (f64, f64), absolute: f64) -> bool {
    ours.lo - slack(point.1, absolute) <= point.1
        && point.0 <= ours.hi + slack(point.0, absolute)
}

fn same(a: f64, b: f64, absolute: f64) -> bool {
    // Rounded inwards, what is too large is the largest number, and not
    // infinite.
    let overflow = |v: f64| v.abs() == f64::MAX;
    (overflow(b) && a.is_infinite() && a.signum() == b.signum())
        || a == b
        || (a - b).abs() <= slack(b, absolute)
}

/// How much a function's value `v` moves with its operand. Where it moves much,
/// the oracle's own operands have lost digits that its value shows.
fn slope(name: &str, v: f64) -> f64 {
    // f64 tells differences to 1 no more exactly than this, so no slope of the
    // arcs is steeper.
    let steepest = f64::EPSILON.sqrt().recip();
    match name {
        "tan" => 1.0 + v * v,
        "asin" => v.cos().abs().recip().min(steepest),
        "acos" => v.sin().abs().recip().min(steepest),
        _ => 1.0,
    }
}

type Theirs = fn(oracle::DecoratedInterval) -> oracle::DecoratedInterval;

#[test]
fn functions_of_one_interval_are_the_oracles() {
    type Unary = (&'static str, fn(Interval) -> Interval, Theirs);
    let all: [Unary; 16] = [
        ("neg", Interval::neg, oracle::neg),
        ("abs", Interval::abs, oracle::abs),
        ("square", Interval::square, oracle::sqr),
        ("recip", Interval::recip, oracle::recip),
        ("sqrt", Interval::sqrt, oracle::sqrt),
        ("ln", Interval::ln, oracle::log),
        ("exp", Interval::exp, oracle::exp),
        ("floor", Interval::floor, oracle::floor),
        ("ceil", Interval::ceil, oracle::ceil),
        ("round", Interval::round, oracle::round_ties_to_away),
        ("sin", Interval::sin, oracle::sin),
        ("cos", Interval::cos, oracle::cos),
        ("tan", Interval::tan, oracle::tan),
        ("asin", Interval::asin, oracle::asin),
        ("acos", Interval::acos, oracle::acos),
        ("atan", Interval::atan, oracle::atan),
    ];
    let mut rng = Rng::with_seed(17);
    for (name, f, exact) in all {
        let mut compared = 0;
        for _ in 0..3000 {
            let i = interval(&mut rng);
            let out = f(i);
            let value = exact(oracle::new_dec(theirs(i)));
            // A cosine is the sine of a sum, whose last digit is lost. So is
            // the last digit of an angle that the oracle reduces to less than a
            // turn. Its logarithms and arcs are sums of numbers near 1.
            let absolute = match name {
                "sin" | "cos" | "tan" if i.is_finite() => {
                    i.magnitude() + FRAC_PI_2
                }
                "ln" | "asin" | "acos" => 1.0,
                _ => 0.0,
            };
            // Only these four functions are NaN somewhere.
            let undefined = oracle::decoration_part(value)
                == oracle::Decoration::Trv
                && matches!(name, "sqrt" | "ln" | "asin" | "acos");
            // At 0 itself our result is the logarithm's limit.
            if i.lo != 0.0 || name != "ln" {
                let periodic = matches!(name, "sin" | "cos" | "tan");
                let nan = undefined || periodic && !i.is_finite();
                assert_eq!(out.nan, nan, "{name} of {i:?}: {out:?}");
            }
            for v in members(i, &mut rng) {
                let point = oracle::Interval::new(v, v);
                let value = exact(oracle::new_dec(point));
                let value = oracle::interval_part(value, &mut ());
                let Some(value) = ends(value) else { continue };
                assert!(
                    holds(out, value, absolute * slope(name, value.1)),
                    "{name} of {v} in {i:?}: {value:?} is not in {out:?}"
                );
            }
            let value = oracle::interval_part(value, &mut ());
            let Some((lo, hi)) = ends(value) else {
                continue;
            };
            assert!(
                same(out.lo, lo, absolute * slope(name, lo))
                    && same(out.hi, hi, absolute * slope(name, hi)),
                "{name} of {i:?}: {out:?} for {lo}, {hi}"
            );
            compared += 1;
        }
        assert!(compared > 500, "{name}: {compared}");
    }
}

type Pair<T> = fn(T, T) -> T;

#[test]
fn functions_of_two_intervals_are_the_oracles() {
    type Binary = (&'static str, Pair<Interval>, Pair<oracle::Interval>);
    let all: [Binary; 8] = [
        ("add", Interval::add, oracle::add),
        ("sub", Interval::sub, oracle::sub),
        ("mul", Interval::mul, oracle::mul),
        ("div", Interval::div, oracle::div),
        ("min", Interval::min, oracle::min),
        ("max", Interval::max, oracle::max),
        ("hull", Interval::hull, oracle::convex_hull),
        ("atan2", Interval::atan2, oracle::atan2),
    ];
    let mut rng = Rng::with_seed(18);
    for (name, f, exact) in all {
        let mut compared = 0;
        for _ in 0..3000 {
            let (a, b) = (interval(&mut rng), interval(&mut rng));
            let out = f(a, b);
            for v in members(a, &mut rng) {
                for w in members(b, &mut rng) {
                    let [v, w] = [v, w].map(|p| oracle::Interval::new(p, p));
                    let Some(value) = ends(exact(v, w)) else {
                        continue;
                    };
                    assert!(
                        name == "hull" || holds(out, value, 0.0),
                        "{name} of {v:?}, {w:?} in {a:?}, {b:?}: \
                         {value:?} is not in {out:?}"
                    );
                }
            }
            let Some((lo, hi)) = ends(exact(theirs(a), theirs(b))) else {
                continue;
            };
            // At the origin the angle is 0 here, and undefined for the oracle.
            if name == "atan2" && a.contains(0.0) && b == Interval::ZERO {
                continue;
            }
            // Where the angle jumps, our result is the whole turn, though only
            // one of the two sides may occur.
            if name == "atan2" && a.contains(0.0) && b.lo < 0.0 {
                assert_eq!((out.lo, out.hi), (-PI, PI), "{a:?}, {b:?}");
                continue;
            }
            assert!(
                same(out.lo, lo, 0.0) && same(out.hi, hi, 0.0),
                "{name} of {a:?}, {b:?}: {out:?} for {lo}, {hi}"
            );
            compared += 1;
        }
        assert!(compared > 1000, "{name}: {compared}");
    }
}

/// What the oracle lacks is put together from what it has, at points inside.
#[test]
fn remainders_and_comparisons_hold_what_the_oracle_says_of_points() {
    let mut rng = Rng::with_seed(19);
    let mut compared = 0;
    for _ in 0..3000 {
        let (a, b) = (interval(&mut rng), interval(&mut rng));
        let (remainder, order) = (a.modulo(b), a.compare(b));
        for v in members(a, &mut rng) {
            for w in members(b, &mut rng) {
                let [x, y] = [v, w].map(|p| oracle::Interval::new(p, p));
                let sign = oracle::sign(oracle::sub(x, y));
                let (lo, hi) = ends(sign).unwrap();
                assert_eq!(lo, hi, "{v}, {w}");
                assert!(order.contains(lo), "{v}, {w} in {a:?}, {b:?}");
                // A quotient that may be on either side of a whole number says
                // nothing.
                let turns = oracle::floor(oracle::div(x, oracle::abs(y)));
                if ends(turns).is_none_or(|(lo, hi)| lo != hi) {
                    continue;
                }
                let whole = oracle::mul(oracle::abs(y), turns);
                let value = ends(oracle::sub(x, whole)).unwrap();
                assert!(
                    holds(remainder, value, v.abs()),
                    "{v} mod {w} in {a:?}, {b:?}: {value:?}, {remainder:?}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}
