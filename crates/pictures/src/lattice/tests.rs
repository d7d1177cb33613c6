use super::*;
use crate::testing::bounds_hold;
use crate::{Picture, PictureOptions};
use glam::DVec3;
use isocontour::{Bounds, Data};

const WAYS: [Interpolation; 3] = [
    Interpolation::Nearest,
    Interpolation::Linear,
    Interpolation::Cubic,
];
const BORDERS: [Border; 3] = [Border::Clamp, Border::Repeat, Border::Mirror];

fn noise(n: usize) -> Numbers {
    let mut random = fastrand::Rng::with_seed(3);
    Numbers::U8((0..n).map(|_| random.u8(..)).collect())
}

#[test]
fn bounds_of_pictures_hold_in_random_boxes() {
    for how in WAYS {
        for border in BORDERS {
            for size in [[37, 53], [1, 20], [3, 1], [1, 1]] {
                let options = PictureOptions {
                    width_mm: Some(10.0),
                    interpolation: how,
                    border: [border, Border::Clamp],
                    ..PictureOptions::default()
                };
                let numbers = noise(size[0] * size[1]);
                let picture =
                    Picture::from_numbers("x", size, numbers, &options)
                        .unwrap();
                let within = Bounds {
                    min: DVec3::new(-15.0, -3.0, -1.0),
                    max: DVec3::new(25.0, 16.0, 1.0),
                };
                bounds_hold(&picture, within, 12_000);
            }
        }
    }
}

#[test]
fn bounds_close_in_on_values() {
    for how in [Interpolation::Linear, Interpolation::Cubic] {
        let options = PictureOptions {
            interpolation: how,
            ..PictureOptions::default()
        };
        let picture =
            Picture::from_numbers("x", [40, 40], noise(1600), &options)
                .unwrap();
        for i in 0..100 {
            let p = DVec3::new(0.4 * f64::from(i), 20.03, 0.0);
            let by = DVec3::splat(1e-6);
            let over = Bounds {
                min: p - by,
                max: p + by,
            };
            let [a, b] = picture.range(&over);
            assert!(b - a < 1e-4, "{p} {a} {b}");
            let (_, slope) = picture.at(p);
            let slopes = picture.slopes(&over);
            for axis in 0..2 {
                let [a, b] = slopes[axis];
                // At creases there are two slopes.
                assert!(b - a < 4.1 && a <= slope[axis] && slope[axis] <= b);
            }
        }
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    for how in [Interpolation::Linear, Interpolation::Cubic] {
        let options = PictureOptions {
            interpolation: how,
            border: [Border::Mirror, Border::Repeat],
            width_mm: Some(3.0),
            ..PictureOptions::default()
        };
        let picture =
            Picture::from_numbers("x", [9, 7], noise(63), &options).unwrap();
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..1000 {
            let p = DVec3::new(random.f64() * 9.0, random.f64() * 9.0, 1.0);
            let (_, slope) = picture.at(p);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let by = 1e-7 * axis;
                let rise = picture.value(p + by) - picture.value(p - by);
                let measured = rise / 2e-7;
                // Creases are 3 / 9 apart: few points are that near to one.
                let near_crease = how == Interpolation::Linear && {
                    let u = (p * 3.0 - 0.5).fract();
                    u.min_element() < 1e-5 || u.max_element() > 1.0 - 1e-5
                };
                assert!(
                    near_crease || (measured - slope.dot(axis)).abs() < 1e-5,
                    "{p} {measured} {slope}"
                );
            }
        }
    }
}

/// A ramp along x and a parabola along y come back exactly.
#[test]
fn ramps_and_parabolas_are_exact() {
    let [w, h] = [30, 20];
    let ramp = |x: f64| 0.125 + 0.03125 * x;
    let bow = |y: f64| 0.25 * y * y - y;
    let pixels = |f: &dyn Fn(f64, f64) -> f64| {
        let rows = (0..h).rev();
        let all = rows.flat_map(|y| (0..w).map(move |x| (x, y)));
        Numbers::F32(
            all.map(|(x, y)| f(x as f64 + 0.5, y as f64 + 0.5) as f32)
                .collect(),
        )
    };
    let read = |numbers, interpolation| {
        let options = PictureOptions {
            interpolation,
            ..PictureOptions::default()
        };
        Picture::from_numbers("x", [w, h], numbers, &options).unwrap()
    };
    let straight = read(pixels(&|x, y| ramp(x) + y), Interpolation::Linear);
    let bowed = read(pixels(&|x, y| ramp(x) + bow(y)), Interpolation::Cubic);
    for i in 0..50 {
        let (x, y) = (2.0 + 0.5 * f64::from(i), 2.0 + 0.3 * f64::from(i));
        let p = DVec3::new(x, y, 9.0);
        let (value, slope) = straight.at(p);
        assert!((value - ramp(x) - y).abs() < 1e-12);
        assert!((slope - DVec3::new(0.03125, 1.0, 0.0)).length() < 1e-12);
        let (value, slope) = bowed.at(p);
        assert!((value - ramp(x) - bow(y)).abs() < 1e-11, "{value}");
        let expected = DVec3::new(0.03125, 0.5 * y - 1.0, 0.0);
        assert!((slope - expected).length() < 1e-11);
    }
    // Beyond the border it stays.
    let far = DVec3::new(-1e300, 5.5, 0.0);
    assert_eq!(straight.value(far), ramp(0.5) + 5.5);
    assert_eq!(straight.at(far).1, DVec3::Y);
}

#[test]
fn many_places_are_as_one() {
    let options = PictureOptions {
        interpolation: Interpolation::Cubic,
        ..PictureOptions::default()
    };
    let picture =
        Picture::from_numbers("x", [9, 7], noise(63), &options).unwrap();
    let [x, y] = [[1.5_f32, 2.25, f32::NAN], [3.5, 9.0, 1.0]];
    let mut out = vec![7.0];
    picture.values([&x, &y, &[0.0; 3]], &mut out);
    let one = |i: usize| {
        picture.value(DVec3::new(x[i].into(), y[i].into(), 0.0)) as f32
    };
    assert_eq!(out[..3], [7.0, one(0), one(1)]);
    assert!(out[3].is_nan());
}

#[test]
fn infinite_and_far_boxes_are_answered() {
    for border in BORDERS {
        for how in WAYS {
            let options = PictureOptions {
                interpolation: how,
                border: [border; 2],
                ..PictureOptions::default()
            };
            let numbers = noise(60 * 60);
            let picture =
                Picture::from_numbers("x", [60, 60], numbers, &options)
                    .unwrap();
            for over in [
                [f64::NEG_INFINITY, f64::INFINITY],
                [1e15, f64::INFINITY],
                [-1e300, 1e300],
                [1e13, 1e13 + 5.0],
                [-3e12, -3e12 + 1.0],
            ] {
                let [from, to] = over;
                let over = Bounds {
                    min: DVec3::splat(from),
                    max: DVec3::splat(to),
                };
                let [a, b] = picture.range(&over);
                for t in 0..20 {
                    let x = (from.max(-1e100)
                        + f64::from(t) / 20.0 * (to - from).min(9e3))
                    .min(to);
                    let (value, slope) = picture.at(DVec3::new(x, x, 0.0));
                    assert!(a <= value && value <= b, "{over:?}");
                    for (s, [a, b]) in
                        slope.to_array().into_iter().zip(picture.slopes(&over))
                    {
                        assert!(a <= s && s <= b, "{over:?} {s} {a} {b}");
                    }
                }
            }
        }
    }
}
