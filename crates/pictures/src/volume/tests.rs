use crate::testing::bounds_hold;
use crate::{
    Axes, Border, Interpolation, Numbers, Picture, PictureOptions, Volume,
    VolumeOptions,
};
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::DVec3;
use isocontour::{Bounds, Data};
use isoslice_base::problem::NamedProblem;
use std::io::Write;

const SIZE: [usize; 3] = [24, 20, 16];

/// The distance from a ball in coordinates of the lattice.
fn ball(i: usize, j: usize, k: usize) -> f64 {
    let p = DVec3::new(i as f64, j as f64, k as f64);
    (p - DVec3::new(11.0, 9.0, 8.0)).length() - 6.0
}

/// Its values, x running fastest.
fn values() -> Vec<f64> {
    let [a, b, c] = SIZE;
    let at = |n: usize| ball(n % a, n / a % b, n / (a * b));
    (0..a * b * c).map(at).collect()
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn nrrd(fields: &str, data: &[u8]) -> Vec<u8> {
    let mut file = format!("NRRD0004\n# by hand\n{fields}\n\n").into_bytes();
    file.extend_from_slice(data);
    file
}

fn read(file: &[u8]) -> Result<Volume, NamedProblem> {
    Volume::read("ct", file, &VolumeOptions::default())
}

/// Looks at samples of the ball, through the way from a sample's number to its
/// place.
fn is_ball(volume: &Volume, place: impl Fn(DVec3) -> DVec3, scale: f64) {
    assert_eq!(volume.samples(), SIZE);
    for [i, j, k] in [[0, 0, 0], [23, 19, 15], [5, 7, 3], [20, 2, 9]] {
        let p = place(DVec3::new(i as f64, j as f64, k as f64));
        let value = volume.value(p);
        let expected = ball(i, j, k) * scale;
        assert!((value - expected).abs() < 1e-5 * scale, "{value} {p}");
    }
}

fn floats(big: bool) -> Vec<u8> {
    let one = |v: &f64| {
        let v = *v as f32;
        if big {
            v.to_be_bytes()
        } else {
            v.to_le_bytes()
        }
    };
    values().iter().flat_map(one).collect()
}

#[test]
fn the_ends_of_a_nrrd_s_axes_tell_where_it_lies() {
    let head = "type: float\ndimension: 3\nsizes: 24 20 16\nendian: little\n\
        encoding: raw\naxis mins: 1 -2 0.5\n";
    let of = |more: &str, first: DVec3, step: DVec3| {
        let file = nrrd(&format!("{head}{more}"), &floats(false));
        is_ball(&read(&file).unwrap(), |u| first + step * u, 1.0);
    };
    let first = DVec3::new(1.0, -2.0, 0.5);
    of("spacings: 2 1 0.5", first, DVec3::new(2.0, 1.0, 0.5));
    // From sample to sample, or from side to side.
    let ends = "axis maxs: 24 17 8";
    of(ends, first, DVec3::new(1.0, 1.0, 0.5));
    let cells = format!("{ends}\ncenters: cell node cell");
    let step = DVec3::new(23.0 / 24.0, 1.0, 7.5 / 16.0);
    of(&cells, first + 0.5 * step * DVec3::new(1.0, 0.0, 1.0), step);
}

#[test]
fn nrrd_files_are_read() {
    let place = |u: DVec3| DVec3::new(10.0 - 0.5 * u.x, -20.0 + 2.0 * u.z, u.y);
    let fields = "type: float\ndimension: 3\nsizes: 24 20 16\nkey:=value\n\
        space: left-posterior-superior\n\
        space directions: (-0.5,0,0) (0,0,1) (0,2,0)\n\
        space origin: (10,-20,0)\n";
    let little = format!("{fields}endian: little\nencoding: raw");
    let big = format!("{fields}endian: big\nencoding: gzip");
    let text = format!("{fields}encoding: ascii");
    let written: String =
        values().iter().map(|v| format!("{v:.6}\n")).collect();
    for file in [
        nrrd(&little, &floats(false)),
        nrrd(&big, &gz(&floats(true))),
        nrrd(&text, written.as_bytes()),
        nrrd(
            &format!("{little}\nbyte skip: -1"),
            &[b"junk".to_vec(), floats(false)].concat(),
        ),
        nrrd(
            &format!("{little}\nline skip: 1\nbyte skip: 2"),
            &[b"a line\n--".to_vec(), floats(false)].concat(),
        ),
    ] {
        let volume = read(&file).unwrap();
        is_ball(&volume, place, 1.0);
        let Bounds { min, max } = volume.bounds();
        assert_eq!(min, DVec3::new(-1.5, -20.0, 0.0));
        assert_eq!(max, DVec3::new(10.0, 10.0, 19.0));
    }
    let metres = "type: float\ndimension: 4\nsizes: 1 24 20 16\n\
        space directions: none (0.001,0,0) (0,0.001,0) (0,0,0.002)\n\
        space units: \"m\" \"m\" \"m\"\nendian: little\nencoding: raw";
    let volume = read(&nrrd(metres, &floats(false))).unwrap();
    is_ball(&volume, |u| u * DVec3::new(1.0, 1.0, 2.0), 1.0);
}

fn nifti(zip: bool, version: usize, edit: impl Fn(&mut [u8])) -> Vec<u8> {
    let mut file = vec![0; [352, 544][version]];
    let mut put = |at: usize, bytes: &[u8]| {
        file[at..at + bytes.len()].copy_from_slice(bytes);
    };
    let shorts = [3_i16, 24, 20, 16];
    if version == 0 {
        put(0, &348_i32.to_le_bytes());
        put(344, b"n+1\0");
        for (i, n) in shorts.into_iter().enumerate() {
            put(40 + 2 * i, &n.to_le_bytes());
        }
        put(70, &16_i16.to_le_bytes());
        for (i, mm) in [1.0_f32, 0.5, 1.0, 2.0].into_iter().enumerate() {
            put(76 + 4 * i, &mm.to_le_bytes());
        }
        put(108, &352_f32.to_le_bytes());
        put(112, &10_f32.to_le_bytes());
    } else {
        put(0, &540_i32.to_le_bytes());
        put(4, b"n+2\0");
        for (i, n) in shorts.into_iter().enumerate() {
            put(16 + 8 * i, &i64::from(n).to_le_bytes());
        }
        put(12, &16_i16.to_le_bytes());
        for (i, mm) in [1.0_f64, 0.5, 1.0, 2.0].into_iter().enumerate() {
            put(104 + 8 * i, &mm.to_le_bytes());
        }
        put(168, &544_i64.to_le_bytes());
        put(176, &10_f64.to_le_bytes());
    }
    edit(&mut file);
    file.extend(floats(false));
    if zip { gz(&file) } else { file }
}

#[test]
fn nifti_files_are_read() {
    for zip in [false, true] {
        for version in [0, 1] {
            let file = nifti(zip, version, |_| {});
            let volume = read(&file).unwrap();
            is_ball(&volume, |u| u * DVec3::new(0.5, 1.0, 2.0), 10.0);
        }
        // Rows of a matrix, in µm.
        let rows = nifti(zip, 0, |file| {
            file[123] = 3;
            file[254] = 1;
            let rows = [
                0.0_f32, -500.0, 0.0, 7000.0, 1000.0, 0.0, 0.0, 0.0, 0.0, 0.0,
                250.0, 0.0,
            ];
            for (i, v) in rows.into_iter().enumerate() {
                file[280 + 4 * i..284 + 4 * i]
                    .copy_from_slice(&v.to_le_bytes());
            }
        });
        let place = |u: DVec3| DVec3::new(7.0 - 0.5 * u.y, u.x, 0.25 * u.z);
        is_ball(&read(&rows).unwrap(), place, 10.0);
        // A quarter of a turn about z, and z flipped.
        let turned = nifti(zip, 0, |file| {
            file[252] = 1;
            file[76..80].copy_from_slice(&(-1_f32).to_le_bytes());
            let d = std::f32::consts::FRAC_1_SQRT_2;
            file[264..268].copy_from_slice(&d.to_le_bytes());
            file[268..272].copy_from_slice(&3_f32.to_le_bytes());
        });
        let place = |u: DVec3| DVec3::new(3.0 - u.y, 0.5 * u.x, -2.0 * u.z);
        let volume = read(&turned).unwrap();
        let p = place(DVec3::new(5.0, 7.0, 3.0));
        assert!((volume.value(p) - 10.0 * ball(5, 7, 3)).abs() < 1e-4);
    }
}

fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!(
        "{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, \
         }}\n"
    );
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(data);
    file
}

#[test]
fn arrays_are_read() {
    let same = |u: DVec3| u;
    let fortran = npy("<f4", "True", "(24, 20, 16)", &floats(false));
    is_ball(&read(&fortran).unwrap(), same, 1.0);
    let options = VolumeOptions {
        axes: Axes::Zyx,
        spacing_mm: Some(DVec3::new(0.5, 1.0, 2.0)),
        origin_mm: Some(DVec3::new(1.0, 2.0, 3.0)),
        ..VolumeOptions::default()
    };
    let stack = npy(">f4", "False", "(16, 20, 24)", &floats(true));
    let volume = Volume::read("ct.npy", &stack, &options).unwrap();
    let place =
        |u: DVec3| DVec3::new(1.0, 2.0, 3.0) + u * DVec3::new(0.5, 1.0, 2.0);
    is_ball(&volume, place, 1.0);
    let numbers: Vec<f32> = values().iter().map(|v| *v as f32).collect();
    let memory = Volume::from_numbers(
        "a",
        &[16, 20, 24],
        Numbers::F32(numbers),
        &options,
    )
    .unwrap();
    is_ball(&memory, place, 1.0);
    assert_eq!(memory.name(), "volume(\"a\")");
    // True is white in a picture, and 1 in a volume.
    let truths = npy("|b1", "False", "(1, 3)", &[0, 1, 1]);
    let picture = Picture::read("b.npy", &truths, &PictureOptions::default());
    let at = DVec3::new(1.5, 0.5, 0.0);
    assert_eq!(picture.unwrap().value(at), 1.0);
    assert_eq!(read(&truths).unwrap().value(DVec3::Y), 1.0);
    // Two axes: the same at all heights.
    let flat = npy("|u1", "False", "(2, 3)", &[1, 2, 3, 4, 5, 6]);
    let flat = read(&flat).unwrap();
    assert_eq!(flat.value(DVec3::new(1.0, 2.0, 50.0)), 6.0);
    assert_eq!(flat.value(DVec3::new(0.0, 1.5, -5.0)), 2.5);
}

#[test]
fn a_ball_of_samples_is_a_ball() {
    for (interpolation, most) in
        [(Interpolation::Linear, 0.06), (Interpolation::Cubic, 0.01)]
    {
        let options = VolumeOptions {
            interpolation,
            axes: Axes::Zyx,
            ..VolumeOptions::default()
        };
        let numbers: Vec<f32> = values().iter().map(|v| *v as f32).collect();
        let volume = Volume::from_numbers(
            "ball",
            &[16, 20, 24],
            Numbers::F32(numbers),
            &options,
        )
        .unwrap();
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..2000 {
            let way =
                DVec3::from_array(std::array::from_fn(|_| random.f64() - 0.5))
                    .normalize();
            let p = DVec3::new(11.0, 9.0, 8.0) + 6.0 * way;
            let (value, slope) = volume.at(p);
            assert!(value.abs() < most, "{value}");
            assert!((slope - way).length() < 20.0 * most.max(0.01));
        }
    }
}

#[test]
fn bounds_of_volumes_hold_in_random_boxes() {
    let mut random = fastrand::Rng::with_seed(3);
    for interpolation in [
        Interpolation::Nearest,
        Interpolation::Linear,
        Interpolation::Cubic,
    ] {
        for border in [Border::Clamp, Border::Repeat, Border::Mirror] {
            let fields = "type: short\ndimension: 3\nsizes: 20 31 17\n\
                space directions: (0.3,0.1,0) (-0.1,0.4,0.05) (0,0.1,0.5)\n\
                space origin: (1,2,3)\nendian: little\nencoding: raw";
            let data: Vec<u8> =
                (0..20 * 31 * 17 * 2).map(|_| random.u8(..)).collect();
            let options = VolumeOptions {
                interpolation,
                border: [border; 3],
                ..VolumeOptions::default()
            };
            let file = nrrd(fields, &data);
            let volume = Volume::read("x", &file, &options).unwrap();
            let Bounds { min, max } = volume.bounds();
            let within = Bounds {
                min: min - 3.0,
                max: max + 3.0,
            };
            bounds_hold(&volume, within, 12_000);
        }
    }
}

#[test]
fn hostile_files_are_refused_with_words() {
    let fields = |rest: &str| {
        format!("type: float\ndimension: 3\nendian: little\n{rest}")
    };
    let raw = |sizes: &str| {
        nrrd(&fields(&format!("sizes: {sizes}\nencoding: raw")), &[0; 64])
    };
    let with = |rest: &str| {
        let sizes = "sizes: 2 2 2\nencoding: raw\n";
        nrrd(&fields(&format!("{sizes}{rest}")), &[0; 64])
    };
    let nan = [f32::NAN.to_le_bytes().to_vec(), vec![0; 60]].concat();
    let bomb = gz(&vec![0; 1 << 20]);
    let gzipped = |sizes: &str, data: &[u8]| {
        let text = format!("sizes: {sizes}\nencoding: gzip");
        nrrd(&fields(&text), data)
    };
    let header = |at: usize, bytes: &'static [u8]| {
        nifti(false, 0, move |file| {
            file[at..at + bytes.len()].copy_from_slice(bytes);
        })
    };
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("nothing", vec![], "neither NRRD"),
        ("text", b"solid x".to_vec(), "neither NRRD"),
        ("no end", b"NRRD0004\ntype: float".to_vec(), "does not end"),
        ("no type", nrrd("sizes: 2 2 2", &[0; 64]), "no `type`"),
        (
            "block",
            nrrd("type: block\nsizes: 2", &[0; 9]),
            "type: block",
        ),
        ("cut off", raw("5 5 5"), "says 125 numbers"),
        ("giant", raw("99999999999 99999999999 9"), "1 GiB"),
        ("overflow", raw("18446744073709551615 2 2"), "1 GiB"),
        ("negative", raw("-5 5 5"), "sizes: -5"),
        ("none", raw("0 5 5"), "empty"),
        ("five axes", raw("2 2 2 2 2"), "5 axes"),
        (
            "NaN",
            nrrd(&fields("sizes: 2 2 2\nencoding: raw"), &nan),
            "NaN",
        ),
        ("elsewhere", with("data file: /etc/passwd"), "another file"),
        (
            "bzip2",
            nrrd(&fields("sizes: 2 2 2\nencoding: bz2"), &[]),
            "bz2",
        ),
        (
            "flat",
            with("space directions: (1,0,0) (1,0,0) (0,0,1)"),
            "lattice",
        ),
        (
            "nowhere",
            with("space directions: (nan,0,0) (0,1,0) (0,0,1)"),
            "lattice",
        ),
        ("far", with("space origin: (1e300,0,0)"), "lattice"),
        (
            "few ways",
            with("space directions: (1,0,0)"),
            "1 space directions",
        ),
        ("odd ways", with("space directions: (1,0"), "vectors"),
        (
            "skip",
            with("byte skip: 9223372036854775807"),
            "0 bytes follow",
        ),
        (
            "words",
            nrrd("type: int\nsizes: 2\nencoding: txt", b"1 x"),
            "\"x\"",
        ),
        (
            "too few",
            nrrd("type: int\nsizes: 9\nencoding: txt", b"1 2"),
            "says 9",
        ),
        ("no gzip", gzipped("2 2 2", b"nothing"), "broken or cut off"),
        ("cut gzip", gzipped("64 64 64", &bomb[..200]), "cut off"),
        ("promise", gzipped("640 640 600", &bomb), "cut off"),
        (
            "wide",
            header(42, &[0xff, 0x7f, 0xff, 0x7f, 0xff, 0x7f]),
            "1 GiB",
        ),
        ("below none", header(42, &[0xff, 0xff]), "empty"),
        ("axes", header(40, &[9, 0]), "9 axes"),
        ("colours", header(70, &[128, 0]), "type 128"),
        ("pair", header(344, b"ni1"), ".img"),
        ("magic", header(344, b"abc"), "no NIfTI"),
        ("offset", header(108, &[0, 0, 0xc0, 0x7f]), "begin at NaN"),
        ("before", header(108, &[0, 0, 0, 0]), "begin at 0"),
        ("no spacing", header(80, &[0, 0, 0, 0]), "lattice"),
        (
            "four",
            header(40, &[4, 0, 2, 0, 2, 0, 2, 0, 9, 0]),
            "three axes",
        ),
        ("objects", npy("|O", "False", "(2, 2)", &[0; 64]), "\"|O\""),
        ("one axis", npy("<f4", "False", "(2,)", &[0; 64]), "1 axes"),
        ("no shape", npy("<f4", "False", "2", &[0; 64]), "shape"),
        (
            "vast",
            npy("<f4", "False", "(99999999, 99999999)", &[]),
            "1 GiB",
        ),
        ("short", npy("<f8", "False", "(9, 9)", &[0; 64]), "says 81"),
        ("header", b"\x93NUMPY\x01\x00\xff\xff".to_vec(), "header"),
        (
            "version",
            b"\x93NUMPY\x09\x00\xff\xff".to_vec(),
            "version 9",
        ),
    ];
    for (what, file, words) in cases {
        let error = read(&file).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.starts_with("ct: ") && error.contains(words),
            "{what}: {error}"
        );
    }
}

#[test]
fn any_bytes_do_no_harm() {
    let good = [
        nifti(false, 0, |_| {}),
        nifti(false, 1, |_| {}),
        nrrd("type: float\nsizes: 2 2 2\nencoding: raw", &[0; 64]),
        npy("<f4", "False", "(2, 2)", &[0; 64]),
    ];
    let mut random = fastrand::Rng::with_seed(2);
    for file in good {
        for _ in 0..1500 {
            let mut bad = file.clone();
            for _ in 0..random.usize(1..5) {
                let at = random.usize(..bad.len().min(560));
                bad[at] = random.u8(..);
            }
            bad.truncate(random.usize(..=bad.len()));
            if let Ok(volume) = read(&bad) {
                let over = Bounds {
                    min: DVec3::splat(-1e6),
                    max: DVec3::splat(1e6),
                };
                let _ = (volume.range(&over), volume.slopes(&over));
            }
        }
    }
}

#[test]
fn numbers_that_are_missing_are_filled() {
    let options = VolumeOptions {
        missing: Some(-1000.0),
        ..VolumeOptions::default()
    };
    let data = [1.0, f32::NAN, f32::INFINITY, 4.0];
    let volume =
        Volume::from_numbers("a", &[2, 2], Numbers::F32(data.into()), &options)
            .unwrap();
    assert_eq!(volume.value(DVec3::new(0.0, 1.0, 0.0)), -1000.0);
    assert_eq!(volume.value(DVec3::new(1.0, 1.0, 0.0)), 4.0);
}
