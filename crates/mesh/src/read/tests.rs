//! Files of all formats, sound ones and hostile ones.

use super::{Format, read};
use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::triangles::Triangles;
use glam::DVec3;
use isocontour::Data;
use std::io::Cursor;

fn of(format: Format, bytes: &[u8]) -> Result<Triangles, MeshError> {
    read(Cursor::new(bytes), format)
}

/// A unit cube's quadrilaterals.
const SIDES: [[usize; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

fn corner(i: usize) -> [f32; 3] {
    [0, 1, 2].map(|k| (i >> k & 1) as f32)
}

fn faces() -> Vec<[usize; 3]> {
    let halves = |&[a, b, c, d]: &[usize; 4]| [[a, b, c], [a, c, d]];
    SIDES.iter().flat_map(halves).collect()
}

fn stl_binary(head: &[u8]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12u32.to_le_bytes());
    for face in faces() {
        bytes.extend([0; 12]);
        for i in face {
            bytes.extend(corner(i).into_iter().flat_map(f32::to_le_bytes));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_text() -> String {
    let mut text = "solid a vertex of names\n".to_owned();
    for face in faces() {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in face.map(corner) {
            text += &format!("vertex {x:e} {y} {z}\r\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid facet\n"
}

fn obj() -> String {
    let mut text = "# a cube\no one\nvt 0 0\n".to_owned();
    for i in 0..8 {
        let [x, y, z] = corner(i);
        text += &format!("v {x} {y} {z} 1 0.5 0.5\n");
    }
    for (i, [a, b, c, d]) in SIDES.into_iter().enumerate() {
        text += &if i % 2 == 0 {
            format!(
                "g side{i}\nf {}/1 {}//2 {}/1/1 {}\n",
                a + 1,
                b + 1,
                c + 1,
                d + 1
            )
        } else {
            let [a, b, c, d] = [a, b, c, d].map(|i| i as i32 - 8);
            format!("f {a} {b} \\\n {c} {d}  \n")
        };
    }
    text
}

fn ply(encoding: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {encoding} 1.0\ncomment none\nelement vertex 8\n\
         property float x\nproperty double y\nproperty uchar red\n\
         property short z\nelement face 6\nproperty list uchar int vertex_indices\n\
         property float quality\nelement edge 1\nproperty int a\nend_header\n"
    )
    .into_bytes();
    let is_little = encoding.contains("little");
    let text = encoding == "ascii";
    let put = |bytes: &mut Vec<u8>, x: f64, mut raw: Vec<u8>| {
        if text {
            bytes.extend(format!("{x} ").bytes());
        } else {
            if !is_little {
                raw.reverse();
            }
            bytes.extend(raw);
        }
    };
    for i in 0..8 {
        let [x, y, z] = corner(i);
        put(&mut bytes, x.into(), x.to_le_bytes().into());
        put(&mut bytes, y.into(), f64::from(y).to_le_bytes().into());
        put(&mut bytes, 200.0, vec![200]);
        put(&mut bytes, z.into(), (z as i16).to_le_bytes().into());
    }
    for side in SIDES {
        put(&mut bytes, 4.0, vec![4]);
        for i in side {
            put(&mut bytes, i as f64, (i as i32).to_le_bytes().into());
        }
        put(&mut bytes, 0.5, 0.5f32.to_le_bytes().into());
    }
    put(&mut bytes, 7.0, 7i32.to_le_bytes().into());
    bytes
}

#[test]
fn a_cube_is_a_cube_in_all_formats() {
    for (format, bytes) in [
        (Format::Stl, stl_binary(b"name")),
        (Format::Stl, stl_binary(b"solid name")),
        (Format::Stl, stl_text().into_bytes()),
        (Format::Obj, obj().into_bytes()),
        (Format::Ply, ply("ascii")),
        (Format::Ply, ply("binary_little_endian")),
        (Format::Ply, ply("binary_big_endian")),
    ] {
        let triangles = of(format, &bytes).unwrap();
        assert_eq!(triangles.corners.len(), 12, "{format:?}");
        assert_eq!(triangles.vertices.len(), 8, "{format:?}");
        let mesh = Mesh::new("cube", triangles).unwrap();
        assert!(mesh.facts().is_sound(), "{format:?}");
        assert_eq!(mesh.value(DVec3::splat(0.5)), -0.5, "{format:?}");
        assert_eq!(mesh.facts().turned, 0, "{format:?}");
    }
}

#[test]
fn faces_that_are_not_convex_keep_their_shape() {
    let text = "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 1 1 0\nv 1 4 0\nv 0 4 0\n\
        f 1 2 3 4 5 6\nf 3 4 5 6 1 2\nf 6 5 4 3 2 1\n";
    let triangles = of(Format::Obj, text.as_bytes()).unwrap();
    assert_eq!(triangles.corners.len(), 12);
    for face in triangles.corners.chunks(4) {
        let area: f64 = face
            .iter()
            .map(|c| {
                let [a, b, c] = c.map(|i| triangles.vertices[i as usize]);
                0.5 * (b - a).cross(c - a).length()
            })
            .sum();
        assert!((area - 7.0).abs() < 1e-12, "{area}");
    }
}

#[test]
fn hostile_files_are_refused_with_the_reason() {
    let long = "9".repeat(5000);
    let cube = stl_binary(b"");
    let with = |at: usize, value: f32| {
        let mut bytes = cube.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let promising = |count: u32| {
        let mut bytes = cube.clone();
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        bytes
    };
    let ply_head = |body: &str| format!("ply\nformat ascii 1.0\n{body}");
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let list = "element face 1\nproperty list int int vertex_index\n";
    let vertices = |n: u64| format!("element vertex {n}\n{xyz}");
    use Format::{Obj, Ply, Stl};
    let cases: Vec<(Format, Vec<u8>, &str)> = vec![
        (Stl, vec![], "too short"),
        (Stl, b"solid".to_vec(), "no triangles"),
        (Stl, b"solid \nfacet\n".to_vec(), "no triangles"),
        (Stl, vec![0; 84], "no triangles"),
        (Stl, promising(13), "promises 13 triangles and holds 12"),
        (Stl, promising(u32::MAX), "promises 4294967295"),
        (Stl, cube[..300].to_vec(), "cut off"),
        (
            Stl,
            with(96, f32::NAN),
            "triangle 1: this coordinate is not",
        ),
        (Stl, with(146, f32::INFINITY), "triangle 2: this coordinate"),
        (Stl, with(96, 1e30), "farther than 100 km"),
        (Stl, b"solid\nvertex 1 2".to_vec(), "line 2: the file ends"),
        (
            Stl,
            b"solid\nvertex 1 2 x\n".to_vec(),
            "line 2: \"x\" is no",
        ),
        (Stl, b"solid\nvertex 1 2 nan\n".to_vec(), "not a finite"),
        (Stl, b"solid\nvertex 1 2 3\n".to_vec(), "within a facet"),
        (
            Stl,
            b"solid\n vertex 1 2 3 endloop".to_vec(),
            "fewer than three",
        ),
        (
            Stl,
            format!("solid\n{}", "vertex 1 2 3\n".repeat(4)).into_bytes(),
            "more than three",
        ),
        (Stl, format!("solid\nvertex {long}").into_bytes(), "4,096"),
        (
            Stl,
            format!("solid\n{} endloop", "vertex 1 2 3\n".repeat(3))
                .into_bytes(),
            "no triangles",
        ),
        (Obj, vec![], "no triangles"),
        (Obj, b"v 1 2\nv 1 2 3\n".to_vec(), "\"v\" is no number"),
        (
            Obj,
            b"v 1 2 1e999\n".to_vec(),
            "line 1: this coordinate is not",
        ),
        (Obj, b"f 1 2 3\n".to_vec(), "no vertex 1; 0 are above"),
        (
            Obj,
            b"v 1 2 3\nf 0 1 1\n".to_vec(),
            "line 2: there is no vertex 0",
        ),
        (Obj, b"v 1 2 3\nf -2 1 1\n".to_vec(), "no vertex -2"),
        (
            Obj,
            b"v 1 2 3\nf 9223372036854775807 1 1\n".to_vec(),
            "no vertex 9223372036854775807",
        ),
        (
            Obj,
            b"v 1 2 3\nf -9223372036854775808 1 1\n".to_vec(),
            "no vertex -9223372036854775808",
        ),
        (Obj, b"v 1 2 3\nf a 1 1\n".to_vec(), "\"a\" is no number of"),
        (Obj, b"v 1 2 3\nf 1 1 1\n".to_vec(), "no triangles"),
        (Obj, vec![0xff; 300], "no triangles"),
        (Obj, vec![b'v'; 5000], "4,096 letters"),
        (Ply, vec![], "does not begin with `ply`"),
        (Ply, b"ply\n".to_vec(), "no end"),
        (Ply, b"ply\nformat zip 1.0\n".to_vec(), "unknown format"),
        (Ply, ply_head("element vertex\n").into(), "without a number"),
        (
            Ply,
            ply_head("element vertex -1\n").into(),
            "without a number",
        ),
        (Ply, ply_head("property float x\n").into(), "of no element"),
        (
            Ply,
            ply_head("element vertex 1\nproperty tiny x\n").into(),
            "unknown type",
        ),
        (
            Ply,
            ply_head("element vertex 99999999999\nend_header\n").into(),
            "has no properties",
        ),
        (
            Ply,
            ply_head("element face 0\nend_header\n").into(),
            "no x, y and z",
        ),
        (
            Ply,
            ply_head(&format!("{}end_header\n1 2", vertices(9))).into(),
            "the file ends",
        ),
        (
            Ply,
            ply_head(&format!(
                "{}{list}end_header\n1 2 3 3 0 0 1",
                vertices(1)
            ))
            .into(),
            "face 1: there is no vertex 1",
        ),
        (
            Ply,
            ply_head(&format!("{}{list}end_header\n1 2 3 3 -1", vertices(1)))
                .into(),
            "there is no vertex -1",
        ),
        (
            Ply,
            ply_head(&format!("{}{list}end_header\n1 2 3 -3", vertices(1)))
                .into(),
            "a list of ",
        ),
        (
            Ply,
            ply_head(&format!("{}{list}end_header\n1 2 3 nan", vertices(1)))
                .into(),
            "a list of ",
        ),
        (
            Ply,
            ply_head(&format!("{}end_header\n1 2 nan", vertices(1))).into(),
            "vertex 1: this coordinate",
        ),
        (
            Ply,
            format!(
                "ply\nformat binary_little_endian 1.0\n{}end_header\nabc",
                vertices(u64::MAX)
            )
            .into(),
            "vertex 1: the file ends here",
        ),
        (
            Ply,
            ply_head(&"comment\n".repeat(2000)).into(),
            "its head has no end",
        ),
    ];
    for (format, bytes, why) in cases {
        let said = match of(format, &bytes) {
            Ok(triangles) => format!("{} triangles", triangles.corners.len()),
            Err(e) => e.to_string(),
        };
        assert!(said.contains(why), "{format:?} {why:?}: {said:?}");
    }
}

/// Any bytes end in a mesh or an error.
#[test]
fn changed_files_never_panic() {
    let mut rng = fastrand::Rng::with_seed(11);
    let files = [
        (Format::Stl, stl_binary(b"solid")),
        (Format::Stl, stl_text().into_bytes()),
        (Format::Obj, obj().into_bytes()),
        (Format::Ply, ply("ascii")),
        (Format::Ply, ply("binary_big_endian")),
    ];
    for (format, bytes) in files {
        for _ in 0..400 {
            let mut changed = bytes.clone();
            for _ in 0..rng.usize(1..6) {
                let at = rng.usize(..changed.len());
                match rng.u8(..4) {
                    0 => changed[at] = rng.u8(..),
                    1 => changed[at] ^= 1 << rng.u8(..8),
                    2 => changed.truncate(at + 1),
                    _ => changed.insert(at, b"0 -\n.e/\""[rng.usize(..8)]),
                }
            }
            if let Ok(triangles) = of(format, &changed) {
                let mesh = Mesh::new("changed", triangles).unwrap();
                let (d, gradient) = mesh.at(DVec3::splat(0.3));
                assert!(d.is_finite() && gradient.is_finite());
                let _ = mesh.section(&glam::DAffine3::IDENTITY, 0.5);
            }
        }
    }
}
