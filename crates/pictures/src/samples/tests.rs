use super::{Between, Read, Samples, SamplesOptions};
use crate::testing::bounds_hold;
use glam::DVec3;
use isocontour::{Bounds, Data};
use isoslice_base::problem::Problem;

fn options(between: Between) -> SamplesOptions {
    SamplesOptions {
        between,
        ..SamplesOptions::default()
    }
}

/// Samples in memory.
fn of_points(
    name: &str,
    points: Vec<DVec3>,
    values: Vec<f64>,
    options: &SamplesOptions,
) -> Problem<Samples> {
    let read = Read {
        points,
        values,
        flat: false,
    };
    Samples::new(name, read, options)
}

fn scattered(n: usize, f: impl Fn(DVec3) -> f64, between: Between) -> Samples {
    let mut random = fastrand::Rng::with_seed(4);
    let points: Vec<DVec3> = (0..n)
        .map(|_| {
            DVec3::from_array(std::array::from_fn(|_| random.f64() * 10.0))
        })
        .collect();
    let values = points.iter().map(|p| f(*p)).collect();
    of_points("s", points, values, &options(between)).unwrap()
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
        let samples = of_points("s", points, values, &options).unwrap();
        for p in places(300).chain([DVec3::ZERO, DVec3::ONE]) {
            let (value, slope) = samples.at(p);
            assert!(value.is_finite() && slope.is_finite(), "{p}");
        }
    }
}

/// How a VTU file keeps its arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kept {
    Text,
    Base64,
    Appended,
    AppendedBase64,
}

/// Bytes with the header that says how many they are.
fn with_header(bytes: &[u8], zip: bool, base64: bool) -> Vec<u8> {
    use base64::Engine;
    use std::io::Write;
    let encode = |b: &[u8]| {
        let engine = base64::engine::general_purpose::STANDARD;
        if base64 {
            engine.encode(b).into_bytes()
        } else {
            b.to_vec()
        }
    };
    let word = |n: usize| (n as u64).to_le_bytes();
    if !zip {
        return encode(&[&word(bytes.len())[..], bytes].concat());
    }
    // Blocks of 40 bytes.
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(40)
        .map(|block| {
            let fast = flate2::Compression::fast();
            let mut zip = flate2::write::ZlibEncoder::new(Vec::new(), fast);
            zip.write_all(block).unwrap();
            zip.finish().unwrap()
        })
        .collect();
    let mut header = word(blocks.len()).to_vec();
    header.extend(word(40));
    header.extend(word(bytes.len() % 40));
    blocks.iter().for_each(|b| header.extend(word(b.len())));
    [encode(&header), encode(&blocks.concat())].concat()
}

/// Two tetrahedra with values at points (x + y) and in cells (7 and 9), and a
/// vector.
fn vtu(kept: Kept, zip: bool) -> Vec<u8> {
    let points = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.0, 0.0, 4.0],
        [4.0, 4.0, 4.0],
    ];
    let mut appended = Vec::new();
    let mut array = |name: &str, kind: &str, n: usize, values: &[f64]| {
        let mut bytes = Vec::new();
        for v in values {
            match kind {
                "Float64" => bytes.extend(v.to_le_bytes()),
                "Float32" => bytes.extend((*v as f32).to_le_bytes()),
                _ => bytes.extend((*v as i64).to_le_bytes()),
            }
        }
        let base64 = kept != Kept::Appended;
        let (format, offset, inner) = match kept {
            Kept::Text => {
                let words: Vec<String> =
                    values.iter().map(f64::to_string).collect();
                ("ascii", String::new(), words.join(" "))
            }
            Kept::Base64 => {
                let text = with_header(&bytes, zip, true);
                let text = String::from_utf8(text).unwrap();
                ("binary", String::new(), text)
            }
            _ => {
                let offset = format!("offset='{}'", appended.len());
                appended.extend(with_header(&bytes, zip, base64));
                ("appended", offset, String::new())
            }
        };
        format!(
            "<DataArray Name='{name}' type='{kind}' NumberOfComponents='{n}' \
             format='{format}' {offset}>\n{inner}\n</DataArray>"
        )
    };
    let flat = points.concat();
    let sums: Vec<f64> = points.iter().map(|p| p[0] + p[1]).collect();
    let inner = [
        "<PointData>".into(),
        array("sum", "Float32", 1, &sums),
        array("where", "Float64", 3, &flat),
        "</PointData><CellData>".into(),
        array("cell", "Float64", 1, &[7.0, 9.0]),
        "</CellData><Points>".into(),
        array("Points", "Float32", 3, &flat),
        "</Points><Cells>".into(),
        array(
            "connectivity",
            "Int64",
            1,
            &[0.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0],
        ),
        array("offsets", "Int64", 1, &[4.0, 8.0]),
        "</Cells>".into(),
    ]
    .concat();
    let zipped = if zip {
        "compressor='vtkZLibDataCompressor'"
    } else {
        ""
    };
    let mut file = format!(
        "<?xml version='1.0'?><VTKFile type='UnstructuredGrid' \
         byte_order='LittleEndian' header_type='UInt64' {zipped}>\
         <UnstructuredGrid><Piece NumberOfPoints='5' NumberOfCells='2'>{inner}\
         </Piece></UnstructuredGrid>"
    )
    .into_bytes();
    if !appended.is_empty() {
        let encoding = match kept {
            Kept::Appended => "raw",
            _ => "base64",
        };
        file.extend(format!("<AppendedData encoding='{encoding}'>\n_").bytes());
        file.extend(appended);
        file.extend(b"\n</AppendedData>");
    }
    file.extend(b"</VTKFile>");
    file
}

const KEPT: [(Kept, bool); 7] = [
    (Kept::Text, false),
    (Kept::Base64, false),
    (Kept::Base64, true),
    (Kept::Appended, false),
    (Kept::Appended, true),
    (Kept::AppendedBase64, false),
    (Kept::AppendedBase64, true),
];

#[test]
fn vtu_files_are_read() {
    for (kept, zip) in KEPT {
        let file = vtu(kept, zip);
        let value = |column: &str, p: DVec3| {
            let options = SamplesOptions {
                column: Some(column.into()),
                between: Between::Nearest,
                ..SamplesOptions::default()
            };
            let samples = Samples::read("a.vtu", &file, &options);
            samples
                .unwrap_or_else(|e| panic!("{kept:?} {zip}: {e}"))
                .value(p)
        };
        assert_eq!(value("sum", DVec3::splat(4.0)), 8.0);
        assert_eq!(value("Sum", DVec3::new(4.1, 0.0, 0.0)), 4.0);
        assert_eq!(value("where:2", DVec3::new(0.0, 0.0, 4.0)), 4.0);
        // At the centres, (1, 1, 1) and (2, 2, 2).
        assert_eq!(value("cell", DVec3::splat(1.4)), 7.0);
        assert_eq!(value("cell", DVec3::splat(1.6)), 9.0);
    }
}

#[test]
fn broken_vtu_files_are_refused_with_words() {
    let good = String::from_utf8(vtu(Kept::Text, false)).unwrap();
    let error = |text: &str, column: Option<&str>| {
        let options = SamplesOptions {
            column: column.map(str::to_owned),
            ..SamplesOptions::default()
        };
        let read = Samples::read("a.vtu", text.as_bytes(), &options);
        read.map(|_| ()).unwrap_err().to_string()
    };
    let sum = Some("sum");
    for (from, to, column, words) in [
        ("x", "x", None, "which of its values"),
        ("x", "x", Some("none"), "there are sum, where, cell"),
        ("x", "x", Some("where"), "where:0"),
        ("x", "x", Some("where:3"), "where:0"),
        ("UnstructuredGrid", "PolyData", sum, "PolyData"),
        ("'5'", "'-5'", sum, "NumberOfPoints"),
        ("'5'", "'999999999999'", sum, "NumberOfPoints"),
        ("'5'", "'9000000'", sum, "fewer numbers"),
        ("0 4 4 0 8", "0 4 4 0", sum, "fewer numbers"),
        ("0 4 4 0 8", "0 4 4 0 x", sum, "no number"),
        ("0 1 2 3", "0 1 2 93", Some("cell"), "cell 0"),
        ("4 8\n", "4 1e9\n", Some("cell"), "points"),
        (
            "8\n</DataArray></Cells>",
            "0\n</DataArray></Cells>",
            Some("cell"),
            "cell",
        ),
        ("'ascii'", "'binary'", sum, "array"),
        ("'ascii'", "'appended' offset='0'", sum, "there is not"),
        ("</Piece>", "", sum, "no XML"),
        ("type='Unst", "compressor='vtkLZ4' type='Unst", sum, "zlib"),
    ] {
        let error = error(&good.replace(from, to), column);
        assert!(error.contains(words), "{from} {to}: {error}");
    }
    let mut random = fastrand::Rng::with_seed(2);
    for (kept, zip) in KEPT {
        let good = vtu(kept, zip);
        for _ in 0..600 {
            let mut bad = good.clone();
            for _ in 0..random.usize(1..4) {
                let at = random.usize(..bad.len());
                bad[at] = random.u8(..);
            }
            bad.truncate(random.usize(bad.len() / 2..=bad.len()));
            for column in ["sum", "cell"] {
                let options = SamplesOptions {
                    column: Some(column.into()),
                    ..SamplesOptions::default()
                };
                let _ = Samples::read("a.vtu", &bad, &options);
            }
        }
    }
}

#[test]
fn samples_at_one_place_count_as_their_mean() {
    let place = DVec3::new(1.0, 2.0, 3.0);
    let far = DVec3::new(9.0, 2.0, 3.0);
    // All of them would be the nearest of each.
    let mut points = vec![place; 200_000];
    points.push(far);
    let mut values: Vec<f64> = (0..200_000).map(|i| f64::from(i % 2)).collect();
    values.push(4.0);
    for (between, wanted) in [(Between::Linear, 0.5), (Between::Nearest, 0.0)] {
        let (points, values) = (points.clone(), values.clone());
        let samples = of_points("x", points, values, &options(between));
        let samples = samples.unwrap();
        assert_eq!(samples.len(), 2);
        assert_eq!(samples.value(place), wanted);
        assert_eq!(samples.value(far), 4.0);
    }
}

#[test]
fn stopped_work_makes_no_samples() {
    use isoslice_base::limits::{Limits, Watch};
    let watch = Watch::new(Limits::default());
    watch.cancel();
    let made = std::cell::Cell::new(true);
    let stopped = watch.run(|| {
        let text = b"0,0,0,1\n1,0,0,2\n";
        let read = Samples::read("x", text, &options(Between::Linear));
        made.set(read.is_ok());
    });
    assert!(stopped.is_err() && !made.get());
}

/// Cells must not tell in what is near to a place. Asking for each place alone is the
/// simple way.
#[test]
fn values_in_a_row_are_those_of_single_places() {
    for between in [Between::Linear, Between::Nearest] {
        // Many samples are equally far away.
        let mut even = Vec::new();
        for i in 0..1000 {
            let part = |k: i32| f64::from(i / k % 10);
            even.push(DVec3::new(part(1), part(10), part(100)));
        }
        let values: Vec<f64> =
            (0..1000).map(|i| f64::from(i * 7 % 31)).collect();
        let even = of_points("e", even, values, &options(between));
        let f = |p: DVec3| libm::sin(p.x) + 0.1 * p.y * p.z;
        let few = scattered(5, f, between);
        let many = scattered(3000, f, between);
        for samples in [even.unwrap(), few, many] {
            // Ways of small steps, with leaps between them.
            let steps = places(60)
                .flat_map(|p| (0..20).map(move |k| p + 0.13 * f64::from(k)));
            let all: Vec<DVec3> =
                steps.map(|p| p.as_vec3().as_dvec3()).collect();
            let list = |axis: usize| -> Vec<f32> {
                all.iter().map(|p| p[axis] as f32).collect()
            };
            let [mut x, y, z] = [0, 1, 2].map(list);
            x[30] = f32::NAN;
            let mut found = Vec::new();
            samples.values([&x, &y, &z], &mut found);
            assert!(found[30].is_nan());
            for (i, p) in all.iter().enumerate().filter(|(i, _)| *i != 30) {
                assert_eq!(found[i], samples.value(*p) as f32, "{p}");
            }
        }
    }
}
