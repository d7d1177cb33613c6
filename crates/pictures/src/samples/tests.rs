use super::{Between, Samples, SamplesOptions};
use crate::testing::bounds_hold;
use glam::DVec3;
use isocontour::{Bounds, Data};

fn options(between: Between) -> SamplesOptions {
    SamplesOptions {
        between,
        ..SamplesOptions::default()
    }
}

fn scattered(n: usize, f: impl Fn(DVec3) -> f64, between: Between) -> Samples {
    let mut random = fastrand::Rng::with_seed(4);
    let points: Vec<DVec3> = (0..n)
        .map(|_| {
            DVec3::from_array(std::array::from_fn(|_| random.f64() * 10.0))
        })
        .collect();
    let values = points.iter().map(|p| f(*p)).collect();
    Samples::from_points("s", points, values, &options(between)).unwrap()
}

fn places(n: usize) -> impl Iterator<Item = DVec3> {
    let mut random = fastrand::Rng::with_seed(6);
    (0..n).map(move |_| {
        DVec3::from_array(std::array::from_fn(|_| random.f64() * 14.0 - 2.0))
    })
}

#[test]
fn linear_functions_come_back() {
    let f = |p: DVec3| 3.0 + p.dot(DVec3::new(1.0, -2.0, 0.5));
    let samples = scattered(500, f, Between::Linear);
    for p in places(2000) {
        let (value, slope) = samples.at(p);
        assert!((value - f(p)).abs() < 1e-6, "{p} {value}");
        assert!((slope - DVec3::new(1.0, -2.0, 0.5)).length() < 1e-5);
    }
}

#[test]
fn samples_are_met_and_gradients_true() {
    let f = |p: DVec3| libm::sin(p.x) + 0.1 * p.y * p.z;
    let samples = scattered(3000, f, Between::Linear);
    for (p, v) in samples.points.iter().zip(&samples.values) {
        assert_eq!(samples.value(*p), *v);
    }
    for p in places(500) {
        let (_, slope) = samples.at(p);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let by = 1e-6 * axis;
            let rise = samples.value(p + by) - samples.value(p - by);
            let measured = rise / 2e-6;
            assert!((measured - slope.dot(axis)).abs() < 1e-3, "{p} {slope}");
        }
    }
}

#[test]
fn bounds_hold_in_random_boxes() {
    let f = |p: DVec3| libm::sin(p.x * 2.0) + 0.1 * p.y * p.z;
    let within = Bounds {
        min: DVec3::splat(-3.0),
        max: DVec3::splat(13.0),
    };
    for between in [Between::Nearest, Between::Linear] {
        for n in [1, 3, 13, 700] {
            let samples = scattered(n, f, between);
            bounds_hold(&samples, within, 15_000);
            let all = Bounds {
                min: DVec3::NEG_INFINITY,
                max: DVec3::INFINITY,
            };
            let [a, b] = samples.range(&all);
            assert!(a <= samples.value(DVec3::ONE) && b >= a);
        }
    }
}

#[test]
fn files_are_read() {
    let sample = |text: &str, column: Option<&str>| {
        let options = SamplesOptions {
            column: column.map(str::to_owned),
            between: Between::Nearest,
            ..SamplesOptions::default()
        };
        let samples = Samples::read("s.csv", text.as_bytes(), &options);
        samples.unwrap().value(DVec3::new(1.0, 2.0, 3.1))
    };
    assert_eq!(sample("1,2,3,40\n5,6,7,80\n", None), 40.0);
    assert_eq!(
        sample("# by hand\n\nx y z s\n1 2 3 40\n5 6 7 80", None),
        40.0
    );
    assert_eq!(sample("\u{feff}z;y;x;v\r\n3,0;2;1;4,5\r\n", None), 4.5);
    let ansys = "Node Number\tX Location (mm)\tY Location (mm)\tZ Location \
        (mm)\tEquivalent (von-Mises) Stress (MPa)\n7\t1\t2\t3\t40,5\n";
    assert_eq!(sample(ansys, None), 40.5);
    let paraview = "\"stress\",\"strain\",\"Points:0\",\"Points:1\",\
        \"Points:2\"\n40,1e-3,1,2,3\n80,2e-3,5,6,7\n";
    assert_eq!(sample(paraview, Some("Stress")), 40.0);
    assert_eq!(sample(paraview, Some("str")), 40.0);
    // In the plane, at all heights.
    assert_eq!(sample("x,y,v\n1,2,40\n1,9,50", None), 40.0);
    // Without a value.
    assert_eq!(sample("1,2,3,\n1,2,3,nan\n1,2,4,9\n", None), 9.0);
    let metres = SamplesOptions {
        unit_mm: 1000.0,
        between: Between::Nearest,
        ..SamplesOptions::default()
    };
    let text = b"0.001,0,0,4\n1,1,1,5";
    let samples = Samples::read("s", text, &metres).unwrap();
    assert_eq!(samples.bounds().min, DVec3::X);
}

#[test]
fn what_is_no_sample_is_refused() {
    for (text, words) in [
        ("", "no samples"),
        ("# only\n", "no samples"),
        ("x,y,z,v\n", "0 places"),
        ("1,2", "2 columns"),
        ("1,2,3,4,5", "5 columns"),
        ("a,b,c\n1,2,3", "no x"),
        ("x,y,z\n1,2,3", "no values"),
        ("x,y,z,a,b\n1,2,3,4,5", "which of its columns"),
        ("x,y,z,v\n1,2,3,4\n1,q,3,4", "line 3: column 2 is \"q\""),
        ("x,y,z,v\n1,2,3,4\n1,nan,3,4", "line 3"),
        ("x,y,z,v\n1,2", "column 3 is \"\""),
        ("x,y,z,v\n1,2,3,four", "column 4"),
        ("1e300,2,3,4", "far too large"),
        ("1,2,3,1e300", "far too large"),
    ] {
        let options = SamplesOptions::default();
        let error = Samples::read("s.csv", text.as_bytes(), &options)
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("s.csv: ") && error.contains(words),
            "{text:?}: {error}"
        );
    }
    let options = SamplesOptions::default();
    let error = Samples::read("s", b"1,2,3,4\xff", &options).unwrap_err();
    assert!(error.problem().contains("UTF-8"));
    // All at one place, in a line, in a plane, equally far.
    for points in [
        vec![DVec3::ONE; 40],
        (0..40).map(|i| DVec3::X * f64::from(i)).collect(),
        (0..40)
            .map(|i| DVec3::new(f64::from(i % 7), f64::from(i / 7), 0.0))
            .collect(),
        (0..40)
            .map(|i| {
                let t = f64::from(i) / 40.0 * std::f64::consts::TAU;
                DVec3::new(libm::cos(t), libm::sin(t), 0.0)
            })
            .collect(),
    ] {
        let values = (0..40).map(f64::from).collect();
        let samples =
            Samples::from_points("s", points, values, &options).unwrap();
        for p in places(300).chain([DVec3::ZERO, DVec3::ONE]) {
            let (value, slope) = samples.at(p);
            assert!(value.is_finite() && slope.is_finite(), "{p}");
        }
    }
}
