//! Meshes as models, alone and as parts of expressions.

use crate::common::{
    self, INNER_WALL, OUTER_WALL, formula, join, parse, placed, settings,
    slice, slice_layers,
};
use isoslice::model::{Placement, Source, load};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

type Point = [f32; 3];

/// The triangles of a box.
fn block(lo: Point, hi: Point) -> Vec<[Point; 3]> {
    let corner = |k: usize| {
        [0, 1, 2].map(|i| if k >> i & 1 == 0 { lo[i] } else { hi[i] })
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = faces.iter().flat_map(|f| {
        let [a, b, c, d] = f.map(corner);
        [[a, b, c], [a, c, d]]
    });
    halves.collect()
}

/// A binary STL of triangles.
fn stl(triangles: &[[Point; 3]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        for c in triangle.as_flattened() {
            bytes.extend(c.to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// A folder with the files `block.stl`, `pin.stl` and what else is given.
fn folder(others: &[(&str, Vec<u8>)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let own = [
        (
            "block.stl",
            stl(&block([-10.0, -6.0, 0.0], [10.0, 6.0, 4.0])),
        ),
        ("pin.stl", stl(&block([-3.0, -2.0, -1.0], [3.0, 2.0, 9.0]))),
    ];
    for (name, bytes) in own.iter().chain(others) {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// A script in a folder.
fn script(folder: &Path, text: &str) -> Source {
    let path = folder.join("part.rhai");
    fs::write(&path, text).unwrap();
    Source::File(path)
}

/// The outer and the inner walls of each layer, mm.
fn walls(gcode: &str) -> Vec<[f64; 2]> {
    let layers = parse(gcode);
    let of = |l: &common::Layer| [OUTER_WALL, INNER_WALL].map(|r| l.length(r));
    layers.iter().map(of).collect()
}

/// All filament, mm.
fn fed(gcode: &str) -> f64 {
    parse(gcode).iter().map(common::Layer::fed).sum()
}

#[track_caller]
fn assert_alike(a: &str, b: &str, within: f64) {
    // Lines of skin may lie elsewhere.
    assert!(
        (fed(a) / fed(b) - 1.0).abs() < 0.01,
        "{}, {}",
        fed(a),
        fed(b)
    );
    let (a, b) = (walls(a), walls(b));
    assert_eq!(a.len(), b.len());
    for (k, (a, b)) in a.iter().zip(&b).enumerate() {
        // Whether an inner wall reaches into a tip depends on a trifle.
        for (a, b, within) in [(a[0], b[0], within), (a[1], b[1], 0.1)] {
            assert!((a - b).abs() <= within * (1.0 + b), "{k}: {a}, {b}");
        }
    }
}

#[test]
fn triangles_print_as_the_formula_of_the_same_body() {
    const BLOCK: &str = "max(max(abs(x)-10, abs(y)-6), abs(z-2)-2)";
    const PIN: &str = "max(max(abs(x)-3, abs(y)-2), abs(z-4)-5)";
    let folder = folder(&[]);
    let settings = settings(&[]);
    let none = Placement::default();
    let of = |text: &str| {
        let model = placed(&script(folder.path(), text), &[], &none, &settings);
        slice(&model, &settings, 2).0
    };
    let as_formula =
        |text: String| slice(&formula(&text, &settings), &settings, 2).0;
    let file = Source::File(folder.path().join("block.stl"));
    let alone = slice(&placed(&file, &[], &none, &settings), &settings, 2).0;
    assert_alike(&alone, &as_formula(BLOCK.into()), 1e-3);
    for (text, same) in [
        ("mesh(\"block.stl\")", BLOCK.to_owned()),
        (
            "union([mesh(\"block.stl\"), mesh(\"pin.stl\")])",
            format!("min({BLOCK}, {PIN})"),
        ),
        (
            "max(mesh(\"block.stl\"), -mesh(\"pin.stl\"))",
            format!("max({BLOCK}, -({PIN}))"),
        ),
        // What is no solid of meshes and planes is sampled.
        (
            "max(mesh(\"block.stl\"), 2.5 - sqrt(x*x + y*y))",
            format!("max({BLOCK}, 2.5 - sqrt(x^2 + y^2))"),
        ),
        (
            "mesh(\"block.stl\").remap(x - y / 4, y, z)",
            "max(max(abs(x-y/4)-10, abs(y)-6), abs(z-2)-2)".to_owned(),
        ),
    ] {
        assert_alike(&of(text), &as_formula(same), 2e-3);
    }
}

#[test]
fn a_turned_mesh_prints_as_the_turned_formula() {
    let folder = folder(&[]);
    let settings = settings(&[]);
    let turned = Placement {
        rotate: [20.0, -35.0, 70.0],
        size: Some(24.0),
        ..Placement::default()
    };
    let file = Source::File(folder.path().join("block.stl"));
    let mesh = placed(&file, &[], &turned, &settings);
    let text = "max(max(abs(x)-10, abs(y)-6), abs(z-2)-2)";
    let formula = placed(&Source::formula("f", text), &[], &turned, &settings);
    let off = (mesh.bounds.min - formula.bounds.min).abs();
    assert!(off.max_element() < 1e-3, "{off}");
    let [a, b] = [&mesh, &formula].map(|m| slice(m, &settings, 2).0);
    assert_alike(&a, &b, 5e-3);
}

#[test]
fn a_laid_mesh_lies_on_its_largest_side() {
    let turn = glam::DMat3::from_axis_angle(
        glam::DVec3::new(1.0, -2.0, 0.5).normalize(),
        2.2,
    );
    let oblique = block([-10.0, -6.0, 0.0], [10.0, 6.0, 4.0])
        .iter()
        .map(|t| t.map(|p| turn * glam::DVec3::from(p.map(f64::from))))
        .map(|t| t.map(|p| p.as_vec3().to_array()))
        .collect::<Vec<_>>();
    let folder = folder(&[("oblique.stl", stl(&oblique))]);
    let settings = settings(&[]);
    let laid = Placement {
        lay: true,
        size: Some(40.0),
        ..Placement::default()
    };
    let file = Source::File(folder.path().join("oblique.stl"));
    let model = placed(&file, &[], &laid, &settings);
    let size = model.bounds.size();
    assert!((size.max_element() - 40.0).abs() < 1e-3, "{size}");
    // The block of 20 × 12 × 4 mm lies flat, at some angle about z.
    let scale = model.laid.unwrap() / (20.0 * 12.0);
    assert!((size.z - 4.0 * scale.sqrt()).abs() < 1e-3, "{size}");
    // Another side is a quarter turn away.
    let upright = Placement {
        rotate: [0.0, 90.0, 0.0],
        size: None,
        ..laid
    };
    let model = placed(&file, &[], &upright, &settings);
    assert!(model.bounds.size().z > 11.9, "{}", model.bounds.size());
    // A block that lies already is not turned, and functions have no sides.
    let still = Placement {
        lay: true,
        ..Placement::default()
    };
    let file = Source::File(folder.path().join("block.stl"));
    let size = placed(&file, &[], &still, &settings).bounds.size();
    assert!((size - glam::DVec3::new(20.0, 12.0, 4.0)).length() < 1e-3);
    let ball = load(&Source::formula("f", "sqrt(x*x+y*y+z*z)-5"), &[]).unwrap();
    let volume = isoslice::model::BuildVolume::ANY;
    let error = isoslice::model::place(&ball, &still, volume).err().unwrap();
    assert!(
        error.to_string().starts_with("--lay: flat sides"),
        "{error}"
    );
}

/// The layer in the middle of which the two bodies meet holds both.
#[test]
fn bodies_that_share_a_level_face_lose_no_layer() {
    let mut both = block([0.0; 3], [20.0, 20.0, 4.5]);
    both.extend(block([2.0, 2.0, 4.5], [18.0, 18.0, 10.0]));
    let folder = folder(&[("both.stl", stl(&both))]);
    let settings = settings(&["layer_height=0.2", "first_layer_height=0.2"]);
    let file = Source::File(folder.path().join("both.stl"));
    let model = placed(&file, &[], &Placement::default(), &settings);
    let layers = parse(&slice(&model, &settings, 2).0);
    assert_eq!(layers.len(), 50);
    for layer in layers {
        let length = layer.length(OUTER_WALL);
        assert!(length > 60.0, "{length} at {}", layer.z);
    }
}

/// A ring around the z axis, whose section is an octagon.
fn ring(around: usize) -> Vec<[Point; 3]> {
    let at = |i: usize, k: usize| {
        let turn = |i: usize, of: usize| {
            (i % of) as f64 / of as f64 * std::f64::consts::TAU
        };
        let (u, v) = (turn(i, around), turn(k, 8));
        let r = 12.0 + 4.0 * v.cos();
        [r * u.cos(), r * u.sin(), 4.0 * v.sin()].map(|c| c as f32)
    };
    let faces = (0..around).flat_map(|i| (0..8).map(move |k| (i, k)));
    faces
        .flat_map(|(i, k)| {
            let [a, b, c, d] =
                [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// The heights of adaptive layers are those that the formula of the same body has.
#[test]
fn adaptive_layers_are_those_of_the_formula() {
    // Eight half-planes, 4·cos(22.5°) from the middle of the section.
    let side = "(sqrt(x*x + y*y) - 12)";
    let turned = "max(abs(u)*0.92387953 + abs(z)*0.38268343, \
                  abs(u)*0.38268343 + abs(z)*0.92387953) - 3.69551813"
        .replace('u', side);
    let folder = folder(&[("ring.stl", stl(&ring(720)))]);
    let settings = settings(&["layer_heights=adaptive 0.1"]);
    let tilted = Placement {
        rotate: [0.0, 90.0, 0.0],
        size: Some(30.0),
        ..Placement::default()
    };
    let block = "max(max(abs(x)-10, abs(y)-6), abs(z-2)-2)";
    for (mesh, formula, placement) in [
        (
            "mesh(\"block.stl\")",
            block.to_owned(),
            Placement::default(),
        ),
        ("mesh(\"block.stl\")", block.to_owned(), tilted),
        ("mesh(\"ring.stl\")", turned.clone(), Placement::default()),
        (
            "max(mesh(\"ring.stl\"), z - 2)",
            format!("max({turned}, z - 2)"),
            Placement::default(),
        ),
    ] {
        let source = script(folder.path(), mesh);
        let a = placed(&source, &[], &placement, &settings);
        let source = Source::formula("f", &formula);
        let b = placed(&source, &[], &placement, &settings);
        let [a, b] = [a, b].map(|m| slice(&m, &settings, 2).1);
        let (n, m) = (a.layer_count, b.layer_count);
        // Bounds of the formula have a slack of 4 %.
        assert!(n <= m + 1 && m <= n + 1 + n / 25, "{mesh}: {n}, {m}");
        let [a, b] = [a, b].map(|s| s.steps.unwrap());
        assert_eq!((a.unproved_mm, a.missed_faces), (0.0, 0), "{mesh}");
        assert!((a.thickest_mm - b.thickest_mm).abs() < 0.01, "{mesh}");
        assert!(a.step_max_mm <= 0.1 + 1e-9, "{mesh}");
    }
}

/// Where nothing is proved, the summary says so.
#[test]
fn adaptive_layers_of_a_mesh_that_is_bent_are_thin() {
    let folder = folder(&[]);
    let settings = settings(&["layer_heights=adaptive"]);
    let text = "mesh(\"block.stl\").twist(400)";
    let source = script(folder.path(), text);
    let model = placed(&source, &[], &Placement::default(), &settings);
    let steps = slice(&model, &settings, 2).1.steps.unwrap();
    assert!(steps.unknown_mm > 3.0, "{steps:?}");
    assert!(steps.thickest_mm < 0.201, "{steps:?}");
}

#[test]
fn threads_and_ranges_give_the_same_bytes() {
    let folder = folder(&[]);
    let settings = settings(&["layer_height=0.25", "layer_heights=adaptive"]);
    for text in [
        "max(mesh(\"block.stl\"), -mesh(\"pin.stl\").remap(x, y, z + 0.1*x))",
        "max(mesh(\"block.stl\"), abs(sin(x)*cos(y) + sin(y)*cos(z) \
         + sin(z)*cos(x)) - 0.5)",
        "min(mesh(\"block.stl\") - 1, mesh(\"pin.stl\").remap(x, y, z + 0.1*x))",
    ] {
        let source = script(folder.path(), text);
        let none = Placement::default();
        let model = || placed(&source, &[], &none, &settings);
        let whole = slice(&model(), &settings, 2).0;
        assert_eq!(whole, slice(&model(), &settings, 1).0);
        let parts = ["..7", "8..12", "13.."];
        let of = |range: &&str| {
            // Another process would read the mesh again.
            slice_layers(&model(), &settings, range, 2).0
        };
        let files: Vec<String> = parts.iter().map(of).collect();
        assert!(join(&files).unwrap() == whole.as_bytes(), "{text}");
    }
}

#[test]
fn a_model_reads_only_files_beside_it() {
    let outside = folder(&[]);
    let own = folder(&[("broken.stl", b"solid\nnonsense".to_vec())]);
    let far = outside.path().join("block.stl");
    #[cfg(unix)]
    std::os::unix::fs::symlink(&far, own.path().join("link.stl")).unwrap();
    let far = far.display().to_string();
    for (name, words) in [
        ("../block.stl", "only what lies there or in folders below"),
        (&far[..], "only what lies there or in folders below"),
        ("", "only what lies there or in folders below"),
        #[cfg(unix)]
        ("link.stl", "a link that leads out"),
        ("absent.stl", "cannot read"),
        ("part.rhai", "is not known as a mesh"),
        ("broken.stl", "broken.stl"),
    ] {
        let text = format!("mesh({name:?})");
        let error = load(&script(own.path(), &text), &[]).err().unwrap();
        assert!(error.to_string().contains(words), "{name}: {error}");
    }
    // A formula is the command line's own; this one's folder has no such file.
    let formula = Source::formula("f", "mesh(\"absent.stl\") + 1");
    let error = load(&formula, &[]).err().unwrap().to_string();
    assert!(error.contains("column 1: cannot read"), "{error}");
    for (text, words) in [
        ("mesh(\"a.stl", "has no end"),
        ("abs(\"a.stl\")", "takes no text"),
        ("\"a.stl\" + x", "belongs in parentheses"),
    ] {
        let error = load(&Source::formula("f", text), &[]).err().unwrap();
        assert!(error.to_string().contains(words), "{text}: {error}");
    }
}

/// A box without its top, as a mesh: the top is where the walls end.
#[test]
fn a_mesh_with_a_hole_is_a_body() {
    let mut open = block([-10.0, -6.0, 0.0], [10.0, 6.0, 4.0]);
    open.drain(2..3);
    let folder = folder(&[("open.stl", stl(&open))]);
    let settings = settings(&[]);
    let of = |name: &str| {
        let file = Source::File(folder.path().join(name));
        let model = placed(&file, &[], &Placement::default(), &settings);
        let (gcode, summary) = slice(&model, &settings, 2);
        assert_eq!(summary.layer_count, 20);
        gcode
    };
    let (open, whole) = (walls(&of("open.stl")), walls(&of("block.stl")));
    for (open, whole) in open.iter().zip(&whole).take(15) {
        assert!((open[0] - whole[0]).abs() < 0.5, "{open:?}, {whole:?}");
    }
}
