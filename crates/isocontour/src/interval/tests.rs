mod oracle;

use super::*;

/// Values that have broken interval arithmetic before.
const AWKWARD: [f64; 13] = [
    f64::NEG_INFINITY,
    -1e300,
    -7.5,
    -2.0,
    -1.0,
    -0.3,
    0.0,
    0.3,
    1.0,
    2.0,
    7.5,
    1e300,
    f64::INFINITY,
];

fn intervals() -> Vec<Interval> {
    let mut all = vec![Interval::EMPTY, Interval::ANYTHING];
    for (i, &lo) in AWKWARD.iter().enumerate() {
        for &hi in &AWKWARD[i..] {
            all.push(Interval::new(lo, hi));
        }
    }
    all
}

/// Points inside an interval: its ends and a few between.
fn members(i: Interval) -> Vec<f64> {
    AWKWARD
        .iter()
        .copied()
        .chain([i.lo, i.hi, 0.5 * (i.lo + i.hi)])
        .filter(|v| i.contains(*v))
        .collect()
}

fn check(name: &str, out: Interval, v: f64, of: &str) {
    if v.is_nan() {
        assert!(out.nan, "{name} of {of}: NaN, but {out:?}");
    } else {
        let slack = 1e-12 * v.abs().min(1e300) + 1e-12;
        assert!(
            out.lo - slack <= v && v <= out.hi + slack,
            "{name} of {of}: {v} is not in {out:?}"
        );
    }
}

#[test]
fn unary_results_hold_every_value() {
    type Unary = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64);
    let all: [Unary; 16] = [
        ("neg", Interval::neg, |v| -v),
        ("abs", Interval::abs, f64::abs),
        ("square", Interval::square, |v| v * v),
        ("recip", Interval::recip, f64::recip),
        ("sqrt", Interval::sqrt, f64::sqrt),
        ("ln", Interval::ln, f64::ln),
        ("exp", Interval::exp, f64::exp),
        ("floor", Interval::floor, f64::floor),
        ("ceil", Interval::ceil, f64::ceil),
        ("round", Interval::round, f64::round),
        ("sin", Interval::sin, f64::sin),
        ("cos", Interval::cos, f64::cos),
        ("tan", Interval::tan, f64::tan),
        ("asin", Interval::asin, f64::asin),
        ("acos", Interval::acos, f64::acos),
        ("atan", Interval::atan, f64::atan),
    ];
    for (name, f, exact) in all {
        for i in intervals() {
            let out = f(i);
            for v in members(i) {
                if v == 0.0 && name == "recip" {
                    continue; // ±inf: never a surface
                }
                if v.abs() >= 1e300 && matches!(name, "sin" | "cos") {
                    continue; // no argument reduction worth the name
                }
                check(name, out, exact(v), &format!("{v} in {i:?}"));
            }
        }
    }
}

#[test]
fn binary_results_hold_every_value() {
    type Binary = (
        &'static str,
        fn(Interval, Interval) -> Interval,
        fn(f64, f64) -> f64,
    );
    let all: [Binary; 8] = [
        ("add", Interval::add, |a, b| a + b),
        ("sub", Interval::sub, |a, b| a - b),
        ("mul", Interval::mul, |a, b| a * b),
        ("div", Interval::div, |a, b| a / b),
        ("min", Interval::min, f64::min),
        ("max", Interval::max, f64::max),
        ("atan2", Interval::atan2, f64::atan2),
        ("mod", Interval::modulo, f64::rem_euclid),
    ];
    for (name, f, exact) in all {
        for a in intervals() {
            for b in intervals() {
                let out = f(a, b);
                for v in members(a) {
                    for w in members(b) {
                        if name == "div" && w == 0.0 {
                            continue; // ±inf: never a surface
                        }
                        check(
                            name,
                            out,
                            exact(v, w),
                            &format!("{v}, {w} in {a:?}, {b:?}"),
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn sine_is_tight() {
    let s = Interval::new(0.1, 1.2).sin();
    assert_eq!((s.lo, s.hi), (0.1f64.sin(), 1.2f64.sin()));
    let s = Interval::new(1.0, 2.0).sin();
    assert_eq!((s.lo, s.hi), (1.0f64.sin(), 1.0));
    let s = Interval::new(100.0, 107.0).sin();
    assert_eq!((s.lo, s.hi), (-1.0, 1.0));
}

#[test]
fn a_root_of_a_negative_part_is_nan_beside_the_rest() {
    let s = Interval::new(-1.0, 4.0).sqrt();
    assert_eq!((s.lo, s.hi, s.nan), (0.0, 2.0, true));
    assert!(Interval::new(-4.0, -1.0).sqrt().is_empty());
}
