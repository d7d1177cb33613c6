use crate::{Drawing, Fill, Outline, TextOptions};
use glam::{DAffine2, DAffine3, DVec2, DVec3};
use isocontour::{Bounds, Data};

/// Looks at random boxes: are values and gradients in their bounds?
pub(crate) fn bounds_hold(drawing: &Drawing, boxes: usize) {
    let [min, max] = drawing.bounds();
    let (centre, half) = (0.5 * (min + max), 0.8 * (max - min));
    let mut random = fastrand::Rng::with_seed(9);
    for _ in 0..boxes {
        let at = |random: &mut fastrand::Rng| {
            DVec2::new(random.f64() * 2.0 - 1.0, random.f64() * 2.0 - 1.0)
        };
        let middle = centre + half * at(&mut random);
        let size = half * 10_f64.powf(-5.0 * random.f64());
        let size = match random.u32(0..6) {
            0 => DVec2::ZERO,
            1 => DVec2::new(size.x, 0.0),
            _ => size,
        };
        let over = Bounds {
            min: (middle - size).extend(-1.0),
            max: (middle + size).extend(1.0),
        };
        let [least, most] = drawing.range(&over);
        let slopes = drawing.slopes(&over);
        for _ in 0..6 {
            let p = (middle + size * at(&mut random)).extend(0.5);
            let (value, slope) = drawing.at(p);
            assert!(least <= value && value <= most, "{value} {least} {most}");
            for (s, [a, b]) in slope.to_array().into_iter().zip(slopes) {
                assert!(
                    a <= s && s <= b,
                    "{slope} at {p}, {slopes:?} over {over:?}"
                );
            }
        }
    }
}

fn drawing(outlines: &[Outline]) -> Drawing {
    Drawing::new("test", outlines).unwrap()
}

fn points(n: usize, size: f64) -> impl Iterator<Item = DVec2> {
    let mut random = fastrand::Rng::with_seed(4);
    (0..n)
        .map(move |_| DVec2::new(random.f64() - 0.5, random.f64() - 0.5) * size)
}

#[test]
fn a_circle_is_a_circle() {
    let mut circle = Outline::new(Fill::NonZero);
    circle.ellipse(DVec2::new(3.0, -4.0), DVec2::splat(100.0));
    let circle = drawing(&[circle]);
    for p in points(20_000, 400.0) {
        let from = p - DVec2::new(3.0, -4.0);
        let (value, slope) = circle.at(p.extend(7.0));
        let expected = from.length() - 100.0;
        assert!((value - expected).abs() < 1e-5, "{value} {expected}");
        let away = slope.truncate() - from.normalize();
        assert!(from.length() < 1.0 || away.length() < 1e-3, "{p} {slope}");
    }
    bounds_hold(&circle, 20_000);
}

#[test]
fn an_ellipse_is_as_its_points_say() {
    let radii = DVec2::new(100.0, 37.0);
    let turn = DAffine2::from_angle(0.4);
    let mut ellipse = Outline::new(Fill::EvenOdd);
    ellipse.ellipse(DVec2::ZERO, radii);
    let ellipse = drawing(&[ellipse.mapped(turn)]);
    let on = |t: f64| {
        turn.transform_vector2(radii * DVec2::new(libm::cos(t), libm::sin(t)))
    };
    for p in points(200, 300.0) {
        let far = |t: f64| (p - on(t)).length();
        // The best of many, then closer and closer.
        let mut best = 0.0;
        let mut step = std::f64::consts::TAU / 4000.0;
        for i in 0..4000 {
            let t = f64::from(i) * step;
            if far(t) < far(best) {
                best = t;
            }
        }
        for _ in 0..60 {
            for t in [best - step, best + step] {
                if far(t) < far(best) {
                    best = t;
                }
            }
            step *= 0.6;
        }
        let value = ellipse.value(p.extend(0.0));
        assert!((value.abs() - far(best)).abs() < 1e-5, "{p}");
    }
    bounds_hold(&ellipse, 20_000);
}

#[test]
fn overlapping_shapes_have_one_border() {
    let square = |x: f64, y: f64, size: f64| {
        let mut square = Outline::new(Fill::NonZero);
        let at = DVec2::new(x, y);
        square.rectangle(at, at + size);
        square
    };
    // Two squares that overlap, and one that shares a part of a side.
    let union = drawing(&[
        square(0.0, 0.0, 10.0),
        square(5.0, 0.0, 10.0),
        square(15.0, 2.0, 6.0),
    ]);
    let value = |x: f64, y: f64| union.value(DVec3::new(x, y, 0.0));
    assert_eq!(value(5.0, 5.0), -5.0);
    assert_eq!(value(9.0, 4.0), -4.0);
    assert_eq!(value(15.0, 5.0), -3.0);
    assert_eq!(value(15.0, 9.5), 0.0);
    assert_eq!(value(18.0, 5.0), -3.0);
    assert_eq!(value(25.0, 5.0), 4.0);
    bounds_hold(&union, 20_000);
    // The same as one ring with holes.
    let mut rings = Outline::new(Fill::EvenOdd);
    rings.append(&square(0.0, 0.0, 10.0));
    rings.append(&square(5.0, 5.0, 10.0));
    let odd = drawing(&[rings]);
    let value = |x: f64, y: f64| odd.value(DVec3::new(x, y, 0.0));
    assert_eq!(value(7.5, 7.5), 2.5);
    assert_eq!(value(4.0, 4.0), -libm::sqrt(2.0));
    bounds_hold(&odd, 20_000);
    // Cut away by what is on top.
    let mut hole = square(2.0, 2.0, 6.0);
    hole.cuts = true;
    let cut = drawing(&[square(0.0, 0.0, 10.0), hole]);
    assert_eq!(cut.value(DVec3::new(5.0, 5.0, 0.0)), 3.0);
    assert_eq!(cut.value(DVec3::new(1.0, 5.0, 0.0)), -1.0);
    // Twice the same, and a curve on itself.
    let twice = drawing(&[square(0.0, 0.0, 10.0), square(0.0, 0.0, 10.0)]);
    assert_eq!(twice.value(DVec3::new(4.0, 5.0, 0.0)), -4.0);
    let mut circles = Outline::new(Fill::NonZero);
    circles.ellipse(DVec2::ZERO, DVec2::splat(5.0));
    circles.ellipse(DVec2::ZERO, DVec2::splat(5.0));
    let circles = drawing(&[circles]);
    assert!((circles.value(DVec3::ZERO) + 5.0).abs() < 1e-6);
}

/// Two circles that overlap: the union's distance is known.
#[test]
fn circles_are_joined_as_curves() {
    let circle = |x: f64| {
        let mut circle = Outline::new(Fill::NonZero);
        circle.ellipse(DVec2::new(x, 0.0), DVec2::splat(50.0));
        circle
    };
    let union = drawing(&[circle(-30.0), circle(30.0)]);
    for p in points(20_000, 300.0) {
        let [a, b] = [-30.0, 30.0].map(|x| (p - DVec2::new(x, 0.0)).length());
        let tip = DVec2::new(0.0, 40.0);
        let to_tip = (p.abs() - tip).length();
        let outside = a.min(b) - 50.0;
        let expected = if outside > 0.0 {
            outside
        } else {
            // Inside, the border is a circle where that is not in the other.
            let arc = |x: f64, far: f64| {
                let from = p - DVec2::new(x, 0.0);
                let on = DVec2::new(x, 0.0) + from / far * 50.0;
                let free = (on - DVec2::new(-x, 0.0)).length() >= 50.0;
                if free {
                    (far - 50.0).abs()
                } else {
                    f64::INFINITY
                }
            };
            -arc(-30.0, a).min(arc(30.0, b)).min(to_tip)
        };
        let value = union.value(p.extend(0.0));
        assert!((value - expected).abs() < 1e-5, "{p} {value} {expected}");
    }
    bounds_hold(&union, 20_000);
}

fn wild() -> Outline {
    let mut random = fastrand::Rng::with_seed(8);
    let mut at = || DVec2::new(random.f64(), random.f64()) * 200.0;
    let mut wild = Outline::new(Fill::EvenOdd);
    wild.move_to(at());
    for _ in 0..12 {
        wild.cubic_to(at(), at(), at());
        wild.quad_to(at(), at());
        wild.line_to(at());
    }
    wild
}

/// Wild curves: against many points of them.
#[test]
fn curves_that_cross_have_their_distance() {
    let wild = wild();
    let drawn = drawing(std::slice::from_ref(&wild));
    let n = 40_000;
    let dense: Vec<DVec2> = wild
        .curves()
        .iter()
        .flat_map(|c| (0..n).map(|i| c.at(f64::from(i) / f64::from(n))))
        .collect();
    for p in points(60, 300.0) {
        let p = p + 100.0;
        let value = drawn.value(p.extend(0.0));
        let nearest = dense
            .iter()
            .map(|q| (p - *q).length_squared())
            .fold(f64::INFINITY, f64::min)
            .sqrt();
        // Of even-odd areas each curve is border.
        assert!(
            value.abs() <= nearest + 1e-9 && value.abs() > nearest - 1e-4,
            "{p} {value} {nearest}"
        );
    }
    bounds_hold(&drawn, 30_000);
    // Non-zero: parts of the curves are inside.
    let mut whole = wild;
    whole.fill = Fill::NonZero;
    bounds_hold(&drawing(&[whole]), 30_000);
}

#[test]
fn many_places_are_as_one() {
    let drawn = drawing(&[wild()]);
    let mut random = fastrand::Rng::with_seed(2);
    let mut at = (100.0_f32, 100.0_f32);
    let [mut x, mut y] = [vec![], vec![]];
    for i in 0..5000 {
        let step = if i % 100 == 0 { 100.0 } else { 0.5 };
        at.0 = (at.0 + step * (random.f32() - 0.5)).clamp(-50.0, 250.0);
        at.1 = (at.1 + step * (random.f32() - 0.5)).clamp(-50.0, 250.0);
        x.push(if i == 77 { f32::NAN } else { at.0 });
        y.push(at.1);
    }
    let mut out = Vec::new();
    drawn.values([&x, &y, &vec![0.0; x.len()]], &mut out);
    for ((x, y), v) in x.iter().zip(&y).zip(&out) {
        let p = DVec3::new((*x).into(), (*y).into(), 0.0);
        if p.is_finite() {
            let value = drawn.value(p) as f32;
            assert!((value - v).abs() < 1e-6, "{p} {value} {v}");
        } else {
            assert!(v.is_nan());
        }
    }
}

#[test]
fn what_is_no_area_is_refused() {
    let error = |outline: Outline| {
        Drawing::new("logo", &[outline]).unwrap_err().to_string()
    };
    assert!(error(Outline::default()).contains("nothing in it is an area"));
    let mut line = Outline::default();
    line.line_to(DVec2::new(5.0, 5.0));
    assert!(error(line).contains("nothing in it"));
    let mut nan = Outline::default();
    nan.line_to(DVec2::new(f64::NAN, 5.0));
    assert!(error(nan).contains("no number"));
    let mut far = Outline::default();
    far.rectangle(DVec2::ZERO, DVec2::splat(1e9));
    assert!(error(far).contains("1 km"));
}

#[test]
fn infinite_boxes_are_answered() {
    let drawn = drawing(&[wild()]);
    let over = Bounds {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };
    let [a, b] = drawn.range(&over);
    assert!(a < 0.0 && a > -110.0 && b == f64::INFINITY);
    assert_eq!(drawn.slopes(&over)[0], [-1.0, 1.0]);
    let beside = Bounds {
        min: DVec3::new(500.0, f64::NEG_INFINITY, 0.0),
        ..over
    };
    let [min, max] = drawn.bounds();
    assert!(drawn.range(&beside)[0] > 499.0 - max.x);
    assert!(min.x >= 0.0);
}

/// How often rings go round a point.
fn rounds(rings: &[Vec<DVec2>], p: DVec2) -> i32 {
    let mut rounds = 0;
    for ring in rings {
        let next = ring.iter().cycle().skip(1);
        for (a, b) in ring.iter().zip(next) {
            let left = (*b - *a).perp_dot(p - *a) > 0.0;
            if a.y <= p.y && b.y > p.y && left {
                rounds += 1;
            } else if a.y > p.y && b.y <= p.y && !left {
                rounds -= 1;
            }
        }
    }
    rounds
}

#[test]
fn sections_go_round_what_is_inside() {
    let mut whole = wild();
    whole.fill = Fill::NonZero;
    let mut hole = Outline::new(Fill::NonZero);
    hole.ellipse(DVec2::splat(100.0), DVec2::splat(30.0));
    hole.cuts = true;
    let mut circle = Outline::new(Fill::NonZero);
    circle.ellipse(DVec2::splat(150.0), DVec2::splat(40.0));
    let shapes = [whole, circle, hole];
    let places = [
        DAffine3::IDENTITY,
        DAffine3::from_rotation_z(0.7),
        DAffine3::from_scale(DVec3::new(-0.5, 2.0, 1.0)),
        DAffine3::from_rotation_x(0.4),
    ];
    for drawn in [drawing(&shapes), drawing(&[wild()])] {
        for place in places {
            let rings = drawn.section(&place, 3.0).unwrap();
            let back = place.inverse();
            let mut random = fastrand::Rng::with_seed(3);
            for _ in 0..3000 {
                let q = DVec2::new(random.f64(), random.f64()) * 240.0 - 20.0;
                // A place at the height that is asked at q.
                let p = back.transform_point3(q.extend(0.0)).with_z(3.0);
                let value = drawn.value(place.transform_point3(p));
                let inside = rounds(&rings, p.truncate()) == 1;
                assert!(inside == (value < 0.0) || value.abs() < 0.002, "{p}");
            }
        }
        let side = DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2);
        let flat = DAffine3 {
            matrix3: side.matrix3
                * glam::DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0)),
            ..side
        };
        assert!(drawn.section(&flat, 0.0).is_none());
    }
}

/// Rays are cast along y in what is wide, and along x in what is high.
#[test]
fn wide_and_high_areas_are_one_function() {
    for fill in [Fill::NonZero, Fill::EvenOdd] {
        let mut row = Outline::new(fill);
        for i in 0..30 {
            let centre = DVec2::new(7.0 * f64::from(i), f64::from(i % 3));
            row.ellipse(centre, DVec2::new(5.0, 3.0));
            row.rectangle(centre, centre + DVec2::new(2.0, 9.0));
        }
        let mirror = DAffine2::from_cols(DVec2::Y, DVec2::X, DVec2::ZERO);
        let wide = drawing(&[row.clone()]);
        let high = drawing(&[row.mapped(mirror)]);
        let [min, max] = wide.bounds();
        let mut inside = 0;
        for p in points(20_000, 1.0) {
            let p = min + (p + 0.5) * (max - min);
            let [a, b] = [(&wide, p), (&high, DVec2::new(p.y, p.x))]
                .map(|(of, p)| of.value(p.extend(0.0)));
            assert!((a - b).abs() < 1e-9, "{p}: {a} {b}");
            inside += usize::from(a < 0.0);
        }
        assert!((4000..16_000).contains(&inside), "{inside}");
    }
}

#[test]
fn stopped_work_makes_no_drawing() {
    use isoslice_base::limits::{Limits, Watch};
    let watch = Watch::new(Limits::default());
    watch.cancel();
    let made = std::cell::Cell::new(true);
    let stopped = watch.run(|| {
        let text = Drawing::from_text("a", None, &TextOptions::default());
        made.set(text.is_ok());
    });
    assert!(stopped.is_err() && !made.get());
}
