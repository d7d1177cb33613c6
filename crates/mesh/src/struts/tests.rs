//! Struts against what is inside them by definition, and bounds against values.

use super::{Cap, Strut, Struts};
use fastrand::Rng;
use glam::{DAffine3, DMat3, DVec3};
use isocontour::{Bounds, Data};

const CAPS: [Cap; 3] = [Cap::Hemisphere, Cap::Sphere, Cap::Butt];

fn place(rng: &mut Rng, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| size * (rng.f64() - 0.5)))
}

/// Any strut. Those that are `long` are longer than they are thick.
fn strut(rng: &mut Rng, long: bool) -> Strut {
    let a = place(rng, 20.0);
    let way = place(rng, 1.0).normalize_or(DVec3::X);
    let thick = [0; 2].map(|_| 0.2 + 2.0 * rng.f64());
    let even = rng.u8(..3) == 0;
    let length = if long {
        3.0 + 4.0 * rng.f64()
    } else {
        0.1 + rng.f64()
    };
    Strut {
        ends: [a, a + length * way],
        radii: if even { [thick[0]; 2] } else { thick },
        caps: [0; 2].map(|_| CAPS[rng.usize(..3)]),
    }
}

/// True for what is inside the cone, or the balls and half balls at its ends.
fn is_inside(s: &Strut, p: DVec3) -> bool {
    let [a, b] = s.ends;
    let along = (b - a).normalize();
    let t = (p - a).dot(along) / a.distance(b);
    let away = (p - a - (p - a).dot(along) * along).length();
    let cone = s.radii[0] * (1.0 - t) + s.radii[1] * t;
    let in_cone = (0.0..=1.0).contains(&t) && away <= cone;
    in_cone
        || [0, 1].into_iter().any(|e| {
            let is_beyond = if e == 0 { t <= 0.0 } else { t >= 1.0 };
            let near = p.distance(s.ends[e]) <= s.radii[e];
            near && match s.caps[e] {
                Cap::Butt => false,
                Cap::Sphere => true,
                Cap::Hemisphere => is_beyond,
            }
        })
}

/// True if there are places inside and outside close to a place.
fn meets_surface(rng: &mut Rng, s: &Strut, p: DVec3) -> bool {
    let near: Vec<bool> = (0..200)
        .map(|_| is_inside(s, p + place(rng, 1e-6)))
        .collect();
    near.contains(&true) && near.contains(&false)
}

#[test]
fn distances_lead_to_the_surface_and_not_beyond() {
    let mut rng = Rng::with_seed(5);
    for _ in 0..5000 {
        let s = strut(&mut rng, true);
        let p = s.ends[rng.usize(..2)] + place(&mut rng, 10.0);
        let (d, gradient) = s.distance_and_gradient(p);
        assert!((d - s.distance(p)).abs() < 1e-12, "{s:?} {p}");
        if d.abs() < 1e-6 {
            continue;
        }
        assert_eq!(d < 0.0, is_inside(&s, p), "{s:?} {p} {d}");
        for _ in 0..20 {
            let way = place(&mut rng, 1.0).normalize_or(DVec3::Y);
            let near = p + way * d.abs() * (1.0 - 1e-9);
            assert_eq!(is_inside(&s, near), d < 0.0, "{s:?} {p} {d}");
        }
        let meets = meets_surface(&mut rng, &s, p - gradient * d);
        assert!(meets, "{s:?} {p} {d} {gradient}");
    }
}

#[test]
fn short_struts_are_exact_outside() {
    let mut rng = Rng::with_seed(6);
    let mut inside = 0;
    for _ in 0..5000 {
        let s = strut(&mut rng, false);
        let p = s.ends[rng.usize(..2)] + place(&mut rng, 6.0);
        let (d, gradient) = s.distance_and_gradient(p);
        if d.abs() < 1e-6 {
            continue;
        }
        assert_eq!(d < 0.0, is_inside(&s, p), "{s:?} {p} {d}");
        for _ in 0..20 {
            let way = place(&mut rng, 1.0).normalize_or(DVec3::Y);
            let near = p + way * d.abs() * (1.0 - 1e-9);
            assert_eq!(is_inside(&s, near), d < 0.0, "{s:?} {p} {d}");
        }
        inside += usize::from(d < 0.0);
        let meets = d < 0.0 || meets_surface(&mut rng, &s, p - gradient * d);
        assert!(meets, "{s:?} {p} {d}");
    }
    assert!(inside > 200);
}

/// Bounds over boxes stand on that.
#[test]
fn distances_change_by_no_more_than_the_way() {
    let mut rng = Rng::with_seed(11);
    for i in 0..3000 {
        let s = strut(&mut rng, i % 2 == 0);
        for _ in 0..40 {
            // Also across the planes of its ends.
            let end = s.ends[rng.usize(..2)];
            let p = end + place(&mut rng, 3.0);
            let q = p + place(&mut rng, 0.5);
            let change = (s.distance(p) - s.distance(q)).abs();
            assert!(change <= p.distance(q) + 1e-12, "{change} {p} {q} {s:?}");
        }
    }
}

#[test]
fn boxes_are_tight() {
    let mut rng = Rng::with_seed(7);
    for i in 0..100 {
        let s = strut(&mut rng, i % 2 == 0);
        let seen = DAffine3 {
            matrix3: DMat3::from_cols(
                place(&mut rng, 4.0),
                place(&mut rng, 4.0),
                place(&mut rng, 4.0),
            ),
            translation: place(&mut rng, 9.0),
        };
        let around = s.extent(&seen);
        let mut found = Bounds::EMPTY;
        // Places on the edges of its ends, and on its balls.
        for _ in 0..20_000 {
            let e = rng.usize(..2);
            let out = (s.ends[e] - s.ends[1 - e]).normalize();
            let mut way = place(&mut rng, 1.0).normalize_or(DVec3::X);
            if s.caps[e] == Cap::Butt
                || (s.caps[e] == Cap::Hemisphere && way.dot(out) < 0.0)
            {
                way = (way - way.dot(out) * out).normalize_or(DVec3::ZERO);
            }
            let p = seen.transform_point3(s.ends[e] + s.radii[e] * way);
            found = found.with(p);
        }
        let size = around.size().max_element();
        assert!(around.min.cmple(found.min + 1e-9).all(), "{s:?}");
        assert!(around.max.cmpge(found.max - 1e-9).all(), "{s:?}");
        assert!((around.min - found.min).abs().max_element() < 0.01 * size);
        assert!((around.max - found.max).abs().max_element() < 0.01 * size);
    }
}

fn many(rng: &mut Rng, count: usize) -> Vec<Strut> {
    (0..count)
        .map(|i| {
            let s = strut(rng, i % 4 > 0);
            let radii = if i % 2 == 0 { [s.radii[0]; 2] } else { s.radii };
            let by = place(rng, 60.0);
            Strut {
                ends: s.ends.map(|e| e + by),
                radii: radii.map(|r| 0.4 * r),
                ..s
            }
        })
        .chain([Strut::ball(DVec3::splat(50.0), 3.0)])
        .collect()
}

#[test]
fn values_are_the_least_of_all() {
    let mut rng = Rng::with_seed(8);
    let all = many(&mut rng, 700);
    let struts = Struts::new("lattice", all.clone()).unwrap();
    let places: Vec<DVec3> =
        (0..3000).map(|_| place(&mut rng, 120.0)).collect();
    let at = [0, 1, 2]
        .map(|k| -> Vec<f32> { places.iter().map(|p| p[k] as f32).collect() });
    let mut values = Vec::new();
    struts.values([&at[0], &at[1], &at[2]], &mut values);
    for (i, value) in values.into_iter().enumerate() {
        let p = DVec3::from_array([0, 1, 2].map(|k| f64::from(at[k][i])));
        let least = all.iter().map(|s| s.distance(p));
        let least = least.fold(f64::INFINITY, f64::min);
        assert_eq!(struts.value(p), least);
        assert_eq!(struts.at(p).0, least);
        assert_eq!(value, least as f32);
    }
    let far = DVec3::new(1e20, 0.0, 0.0);
    assert!((struts.value(far) / 1e20 - 1.0).abs() < 1e-9);
}

#[test]
fn ranges_hold_all_values() {
    let mut rng = Rng::with_seed(9);
    let struts = Struts::new("lattice", many(&mut rng, 700)).unwrap();
    let (mut width, mut spread) = (0.0, 0.0);
    for i in 0..4000 {
        let min = place(&mut rng, 110.0);
        let size = 10f64.powf(rng.f64() * 4.0 - 2.0);
        let mut size = size * (place(&mut rng, 2.0).abs());
        if i % 5 == 0 {
            size[rng.usize(..3)] = 0.0;
        }
        let over = Bounds {
            min,
            max: min + size,
        };
        let [low, high] = struts.range(&over);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..100 {
            let t = place(&mut rng, 1.0) + 0.5;
            let value = struts.value(min + t * size);
            assert!(low <= value && value <= high, "{value} {low} {high}");
            (least, most) = (least.min(value), most.max(value));
        }
        if size.length() < 1.0 {
            width += high - low;
            spread += most - least;
        }
    }
    // They are no wider than one would expect of 100 values.
    assert!(width < 1.7 * spread, "{width} {spread}");
    let everywhere = Bounds {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };
    let [low, high] = struts.range(&everywhere);
    assert!(low < -1.0 && high == f64::INFINITY);
}

#[test]
fn slopes_hold_all_gradients() {
    let mut rng = Rng::with_seed(10);
    let struts = Struts::new("lattice", many(&mut rng, 300)).unwrap();
    let mut narrow = 0;
    for _ in 0..4000 {
        let min = place(&mut rng, 90.0);
        let size = 10f64.powf(rng.f64() * 3.0 - 2.0) * place(&mut rng, 2.0);
        let size = size.abs();
        let over = Bounds {
            min,
            max: min + size,
        };
        let slopes = struts.slopes(&over);
        narrow += usize::from(slopes.iter().any(|[a, b]| b - a < 0.5));
        for _ in 0..30 {
            let p = min + (place(&mut rng, 1.0) + 0.5) * size;
            let (_, out) = struts.at(p);
            for k in 0..3 {
                let [low, high] = slopes[k];
                assert!(low <= out[k] && out[k] <= high, "{out} {slopes:?}");
            }
        }
    }
    assert!(narrow > 600, "{narrow}");
}

#[test]
fn what_is_no_strut_is_refused() {
    let good = Strut::ball(DVec3::ZERO, 1.0);
    let wrong = [
        Strut::ball(DVec3::new(f64::NAN, 0.0, 0.0), 1.0),
        Strut::ball(DVec3::new(1e9, 0.0, 0.0), 1.0),
        Strut::ball(DVec3::ZERO, f64::NAN),
        Strut::ball(DVec3::ZERO, 0.0),
        Strut::ball(DVec3::ZERO, -1.0),
        Strut::ball(DVec3::ZERO, f64::INFINITY),
        Strut {
            radii: [1.0, -1.0],
            ..good
        },
    ];
    for wrong in wrong {
        let error = Struts::new("lattice", vec![good, wrong]).unwrap_err();
        assert!(error.to_string().starts_with("strut 1:"), "{error}");
    }
    assert!(Struts::new("lattice", vec![]).is_err());
}
