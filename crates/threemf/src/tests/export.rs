//! Functions that are written and read again.

use super::*;
use crate::level::cuboid;
use crate::{ExportError, Part, write};
use fidget::context::{BinaryOpcode, Context, Tree, TreeOp, UnaryOpcode};
use fidget::var::Var;
use isocontour::{Data, call, nodes_of};
use isoslice_mesh::{Mesh, Strut, Struts, Triangles};
use isoslice_pictures::{
    Border, Interpolation, Numbers, Picture, PictureOptions, Volume,
    VolumeOptions,
};
use std::collections::BTreeMap;
use std::io::Read;
use std::sync::Arc;

const UNARY: [UnaryOpcode; 17] = [
    UnaryOpcode::Neg,
    UnaryOpcode::Abs,
    UnaryOpcode::Recip,
    UnaryOpcode::Sqrt,
    UnaryOpcode::Square,
    UnaryOpcode::Floor,
    UnaryOpcode::Ceil,
    UnaryOpcode::Round,
    UnaryOpcode::Sin,
    UnaryOpcode::Cos,
    UnaryOpcode::Tan,
    UnaryOpcode::Asin,
    UnaryOpcode::Acos,
    UnaryOpcode::Atan,
    UnaryOpcode::Exp,
    UnaryOpcode::Ln,
    UnaryOpcode::Not,
];

const BINARY: [BinaryOpcode; 11] = [
    BinaryOpcode::Add,
    BinaryOpcode::Sub,
    BinaryOpcode::Mul,
    BinaryOpcode::Div,
    BinaryOpcode::Atan,
    BinaryOpcode::Min,
    BinaryOpcode::Max,
    BinaryOpcode::Compare,
    BinaryOpcode::Mod,
    BinaryOpcode::And,
    BinaryOpcode::Or,
];

const AXES: [Var; 3] = [Var::X, Var::Y, Var::Z];

/// Each operation, of x or of x and y.
fn operations() -> impl Iterator<Item = TreeOp> {
    let [x, y, _] = AXES.map(|axis| Arc::new(TreeOp::Input(axis)));
    let of_x = x.clone();
    let unary = UNARY.map(|op| TreeOp::Unary(op, of_x.clone()));
    let binary = BINARY.map(|op| TreeOp::Binary(op, x.clone(), y.clone()));
    unary.into_iter().chain(binary)
}

/// An expression of `count` operations, one of the other.
fn long(count: usize) -> Tree {
    (0..count).fold(
        Tree::x(),
        |long, i| {
            if i % 2 == 0 { long.sin() } else { long.cos() }
        },
    )
}

/// A box that is as large as all that is tried.
const BOUNDS: Bounds = Bounds {
    min: DVec3::splat(-1e6),
    max: DVec3::splat(1e6),
};

fn written(tree: &Tree) -> Result<Vec<u8>, ExportError> {
    write(&Part {
        name: "part",
        tree,
        bounds: BOUNDS,
        origin: DVec3::ZERO,
    })
}

/// The model file of an archive.
fn text(bytes: &[u8]) -> String {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut text = String::new();
    let mut file = archive.by_name(ROOT).unwrap();
    file.read_to_string(&mut text).unwrap();
    text
}

/// The text between two others.
fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split_once(after)?.0)
}

/// What the specification says of a node's value.
fn by_specification(kind: &str, v: &[f64]) -> f64 {
    match kind {
        "addition" => v[0] + v[1],
        "subtraction" => v[0] - v[1],
        "multiplication" => v[0] * v[1],
        "division" => v[0] / v[1],
        "abs" => v[0].abs(),
        "sqrt" => v[0].sqrt(),
        "floor" => v[0].floor(),
        "ceil" => v[0].ceil(),
        "round" => v[0].round(),
        "sin" => v[0].sin(),
        "cos" => v[0].cos(),
        "tan" => v[0].tan(),
        "arcsin" => v[0].asin(),
        "arccos" => v[0].acos(),
        "arctan" => v[0].atan(),
        "arctan2" => v[0].atan2(v[1]),
        "exp" => v[0].exp(),
        "log" => v[0].ln(),
        "min" => v[0].min(v[1]),
        "max" => v[0].max(v[1]),
        "mod" => v[0] - v[1] * (v[0] / v[1]).floor(),
        "sign" if v[0] == 0.0 => 0.0,
        "sign" => v[0].signum(),
        "select" if v[0] < v[1] => v[2],
        "select" => v[3],
        _ => panic!("{kind} is no node of scalars"),
    }
}

/// The value of the function in a model file at a place, and the number of its
/// nodes. Each node has a line of its own.
fn evaluated(text: &str, p: [f64; 3]) -> (f64, usize) {
    let mut values = BTreeMap::new();
    for (name, value) in ["axes.x", "axes.y", "axes.z"].iter().zip(p) {
        values.insert((*name).to_owned(), value);
    }
    let mut count = 0;
    for line in text.lines() {
        let Some(kind) = between(line, "<i:", " ") else {
            continue;
        };
        let Some(name) = between(line, "identifier=\"n", "\"") else {
            continue;
        };
        count += 1;
        if let Some(number) = between(line, "value=\"", "\"") {
            values.insert(format!("n{name}.value"), number.parse().unwrap());
            continue;
        }
        let inputs: Vec<f64> = line
            .split(" ref=\"")
            .skip(1)
            .map(|rest| values[rest.split_once('"').unwrap().0])
            .collect();
        let value = by_specification(kind, &inputs);
        values.insert(format!("n{name}.result"), value);
    }
    let shape = text.split_once("\"shape\" ref=\"").unwrap().1;
    (values[shape.split_once('"').unwrap().0], count)
}

/// Places with zeros, equal coordinates and numbers of both signs among them.
fn places() -> Vec<[f32; 3]> {
    let mut rng = fastrand::Rng::with_seed(7);
    let some = [0.0, 1.0, -1.0, 0.5, -2.5, 3.0];
    let mut places: Vec<[f32; 3]> = Vec::new();
    for x in some {
        places.extend(some.map(|y| [x, y, -x]));
    }
    for _ in 0..1000 {
        places.push([0; 3].map(|_| (6.0 * rng.f64() - 3.0) as f32));
    }
    places
}

fn values(tree: &Tree, places: &[[f32; 3]]) -> Vec<f32> {
    let [x, y, z] =
        [0, 1, 2].map(|k| places.iter().map(|p| p[k]).collect::<Vec<f32>>());
    let mut found = Vec::new();
    let values = Values::new(tree, None).unwrap();
    values.at(&[&x, &y, &z], &mut found).unwrap();
    found
}

/// Each operation has the values that the specification gives its nodes.
#[test]
fn operations_are_nodes_of_equal_values() {
    for op in operations() {
        let name = match op {
            TreeOp::Unary(op, _) => format!("{op:?}"),
            TreeOp::Binary(op, ..) => format!("{op:?}"),
            _ => String::new(),
        };
        let tree = Tree::from(op);
        let text = text(&written(&tree).unwrap());
        let places = places();
        for (p, wanted) in places.iter().zip(values(&tree, &places)) {
            let (found, _) = evaluated(&text, p.map(f64::from));
            let wanted = f64::from(wanted);
            if !wanted.is_finite() || !found.is_finite() {
                let both = !wanted.is_finite() && !found.is_finite();
                assert!(both, "{name} {p:?}: {found} {wanted}");
                continue;
            }
            // The remainder jumps where it is nearly zero.
            let off = (found - wanted).abs();
            let off = if name == "Mod" {
                off.min((off - f64::from(p[1]).abs()).abs())
            } else {
                off
            };
            let most = 1e-5 * (1.0 + wanted.abs());
            assert!(off <= most, "{name} {p:?}: {found} {wanted}");
        }
    }
}

fn random_tree(rng: &mut fastrand::Rng) -> Tree {
    let [x, y, z] = AXES.map(|axis| Arc::new(TreeOp::Input(axis)));
    let shift = Arc::new(TreeOp::Const(0.25));
    let shifted = Arc::new(TreeOp::Binary(BinaryOpcode::Add, x.clone(), shift));
    let mut all = vec![x, y.clone(), z];
    for constant in [0.0, 1.0, 2.5, -0.3, 1e-7, 1.0 / 3.0] {
        all.push(Arc::new(TreeOp::Const(constant)));
    }
    let mut last = TreeOp::Const(0.0);
    for _ in 0..rng.usize(2..24) {
        all.push(Arc::new(last));
        let a = all[rng.usize(..all.len())].clone();
        let b = all[rng.usize(..all.len())].clone();
        last = match rng.u8(..12) {
            0..4 => TreeOp::Unary(UNARY[rng.usize(..UNARY.len())], a),
            4 => TreeOp::RemapAxes {
                target: a,
                x: y.clone(),
                y: b,
                z: shifted.clone(),
            },
            _ => TreeOp::Binary(BINARY[rng.usize(..BINARY.len())], a, b),
        };
    }
    last.into()
}

/// What is read has the bits of what was written.
#[test]
fn what_is_written_comes_back_the_same() {
    let mut rng = fastrand::Rng::with_seed(52);
    let places = places();
    let grown = Bounds {
        min: BOUNDS.min - 1.0,
        max: BOUNDS.max + 1.0,
    };
    let (mut numbers, mut unwritten) = (0, 0);
    for _ in 0..1000 {
        let tree = random_tree(&mut rng);
        let bytes = match written(&tree) {
            Ok(bytes) => bytes,
            Err(ExportError::NotFinite(_)) => {
                unwritten += 1;
                continue;
            }
            Err(other) => panic!("{other}"),
        };
        let found = values(&of(&bytes).unwrap().tree, &places);
        // The box is left out where it surely cuts nothing off.
        let plain = values(&tree, &places);
        let boxed = values(&tree.max(cuboid(&grown)), &places);
        for (i, a) in found.into_iter().enumerate() {
            numbers += usize::from(a.is_finite());
            // The sign of zero says nothing of a shape.
            let is = |b: f32| a == b || a.is_nan() && b.is_nan();
            let is_same = is(plain[i]) || is(boxed[i]);
            let (p, b) = (places[i], plain[i]);
            assert!(is_same, "{tree:?} at {p:?}: {a} {b}");
        }
    }
    assert!(numbers > 500_000, "{numbers}");
    assert!(unwritten < 200, "{unwritten}");
}

/// An expression with 2⁶⁰ ways from its root to its leaf has 60 nodes.
#[test]
fn what_is_shared_is_one_node() {
    let mut tree = Tree::x();
    for i in 0..60 {
        let both = tree.clone() * tree.sin();
        tree = both + i as f32 * 0.5;
    }
    let text = text(&written(&tree).unwrap());
    let (_, count) = evaluated(&text, [0.5, 0.0, 0.0]);
    // A sine, a product, a sum and a constant each.
    assert!(count <= 4 * 60, "{count}");
}

#[test]
fn equal_functions_give_equal_bytes() {
    let make = || {
        let (x, y, z) = Tree::axes();
        written(&(x.square() + y.square() + z.square() - 1.0)).unwrap()
    };
    assert_eq!(make(), make());
}

/// Names are what the user calls files.
#[test]
fn names_are_escaped() {
    let tree = Tree::x();
    let part = Part {
        name: "a<b>&\"c\u{1}",
        tree: &tree,
        bounds: unit_cube(),
        origin: DVec3::ZERO,
    };
    let bytes = write(&part).unwrap();
    assert!(text(&bytes).contains("name=\"a&lt;b&gt;&amp;&quot;c\""));
    of(&bytes).unwrap();
}

/// The box around a part is no part of the function.
#[test]
fn a_box_that_cuts_nothing_off_is_left_out() {
    let (x, y, z) = Tree::axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 0.5;
    let of_bounds = |half: f64| {
        let bounds = Bounds {
            min: DVec3::splat(-half),
            max: DVec3::splat(half),
        };
        let part = Part {
            name: "ball",
            tree: &ball,
            bounds,
            origin: DVec3::ZERO,
        };
        of(&write(&part).unwrap()).unwrap()
    };
    let far = DVec3::new(30.0, 0.0, 0.0);
    assert_eq!(value(&of_bounds(0.5), far), 29.5);
    // The written box lies 1 mm around: it ends at 0.4 here.
    let cut = of_bounds(-0.6);
    assert!(value(&cut, DVec3::new(0.45, 0.0, 0.0)) > 0.0);
}

/// A function that was drawn far out keeps its place.
#[test]
fn the_origin_is_a_transform() {
    let (x, y, z) = Tree::axes();
    let tree = (x.square() + y.square() + z.square()).sqrt() - 0.5;
    let part = Part {
        name: "ball",
        tree: &tree,
        bounds: unit_cube(),
        origin: DVec3::new(2000.0, 0.0, -30.0),
    };
    let body = of(&write(&part).unwrap()).unwrap();
    assert_eq!(value(&body, DVec3::new(2000.0, 0.0, -30.0)), -0.5);
    assert_eq!(value(&body, DVec3::new(2000.0, 2.0, -30.0)), 1.5);
}

fn cube() -> Arc<dyn Data> {
    let triangles = Triangles {
        vertices: (0..8).map(|i| corner(i).map(f64::from).into()).collect(),
        corners: faces(),
        ..Triangles::default()
    };
    Arc::new(Mesh::new("mesh(\"cube.stl\")", triangles).unwrap())
}

/// What is in any of some meshes.
fn of_meshes(meshes: &[Arc<dyn Data>]) -> Tree {
    let (x, y, z) = Tree::axes();
    let at = [x, y, z];
    let all = meshes.iter().map(|mesh| call(mesh, at.clone()));
    all.reduce(|a, b| a.min(b)).unwrap()
}

#[test]
fn meshes_are_objects_of_the_file() {
    let cube = cube();
    let (x, y, z) = Tree::axes();
    let plain = call(&cube, [x.clone(), y.clone(), z.clone()]);
    let turned = call(&cube, [y, x * 0.5, z + 0.25]);
    let tree = plain.max(-turned + 0.125);
    let bytes = written(&tree).unwrap();
    // The box and the mesh, and the part.
    assert_eq!(text(&bytes).matches("<object ").count(), 3);
    let body = of(&bytes).unwrap();
    assert_eq!(body.data.len(), 1);
    let places = places();
    assert_eq!(values(&body.tree, &places), values(&tree, &places));
}

const BORDERS: [Border; 3] = [Border::Clamp, Border::Repeat, Border::Mirror];

/// A picture of 4 × 3 pixels, 6 mm wide.
fn picture(numbers: Numbers, how: Interpolation, border: Border) -> Picture {
    let options = PictureOptions {
        width_mm: Some(6.0),
        interpolation: how,
        border: [border, Border::Mirror],
        ..PictureOptions::default()
    };
    Picture::from_numbers("p.png", [4, 3], numbers, &options).unwrap()
}

/// A turned volume of 2 × 3 × 4 samples.
fn volume(interpolation: Interpolation, border: Border) -> Volume {
    let header = "NRRD0005\ntype: int16\ndimension: 3\nsizes: 2 3 4\n\
        encoding: raw\nendian: little\nspace dimension: 3\n\
        space origin: (-1, 0.5, 2)\n\
        space directions: (0.6,0.8,0) (-0.8,0.6,0) (0,0.25,1.5)\n\n";
    let numbers = (0..24).flat_map(|n: i16| (731 * n - 9000).to_le_bytes());
    let bytes: Vec<u8> = header.bytes().chain(numbers).collect();
    let options = VolumeOptions {
        interpolation,
        border: [border; 3],
        ..VolumeOptions::default()
    };
    Volume::read("v.nrrd", &bytes, &options).unwrap()
}

#[test]
fn pictures_and_volumes_are_stacks_of_sheets() {
    let narrow: Vec<u8> = (0..12).map(|n| n * 21).collect();
    let wide = narrow.iter().map(|n| 200 * u16::from(*n)).collect();
    let all = [Numbers::U8(narrow), Numbers::U16(wide)];
    let (x, y, z) = Tree::axes();
    // Nothing is half-way between samples there, where the nearest one may
    // be either.
    let place =
        |i: u32| [7, 13, 29].map(|k| (i * k % 101) as f32 / 4.07 - 11.03);
    let places: Vec<[f32; 3]> = (0..101).map(place).collect();
    for (how, border) in [Interpolation::Linear, Interpolation::Nearest]
        .into_iter()
        .flat_map(|how| BORDERS.map(|border| (how, border)))
    {
        for (data, span) in [
            (
                Arc::new(picture(all[0].clone(), how, border)) as Arc<dyn Data>,
                1.0,
            ),
            (Arc::new(picture(all[1].clone(), how, border)), 1.0),
            (Arc::new(volume(how, border)), 16_813.0),
        ] {
            let here = call(&data, [x.clone(), y.clone(), z.clone()]);
            let there = call(&data, [y.clone() * 0.5, z.clone(), x.clone()]);
            let tree = here - there;
            let bytes = written(&tree).unwrap();
            assert_eq!(bytes, written(&tree).unwrap());
            let body = of(&bytes).unwrap();
            // Both calls read the same sheets.
            assert_eq!(body.data.len(), 1);
            let (own, read) =
                (values(&tree, &places), values(&body.tree, &places));
            for (i, (a, b)) in own.into_iter().zip(read).enumerate() {
                let [a, b] = [a, b].map(f64::from);
                assert!(
                    (a - b).abs() < 1e-5 * span,
                    "{how:?} {border:?} {span} {:?}: {a} {b}",
                    places[i]
                );
            }
        }
    }
}

#[test]
fn pictures_for_which_there_is_no_stack_are_refused_with_the_reason() {
    let whole = Numbers::U8(vec![1; 12]);
    let floats = Numbers::F32(vec![0.5; 12]);
    for (numbers, how, why) in [
        (
            whole,
            Interpolation::Cubic,
            "which is cubic between its samples",
        ),
        (
            floats,
            Interpolation::Linear,
            "which has numbers with fractions",
        ),
    ] {
        let data: Arc<dyn Data> =
            Arc::new(picture(numbers, how, Border::Clamp));
        let (x, y, z) = Tree::axes();
        let said = written(&call(&data, [x, y, z])).unwrap_err().to_string();
        let begins = format!("it reads image(\"p.png\"), {why}");
        assert!(said.starts_with(&begins), "{said}");
    }
    // As many sheets as an archive may have files.
    let tall = |count: usize| {
        let numbers = Numbers::U8(vec![7; count]);
        let options = VolumeOptions::default();
        let shape = [1, 1, count];
        Volume::from_numbers("v", &shape, numbers, &options).unwrap()
    };
    let (x, y, z) = Tree::axes();
    for (count, fits) in [(9996, true), (9997, false)] {
        let data: Arc<dyn Data> = Arc::new(tall(count));
        let bytes = written(&call(&data, [x.clone(), y.clone(), z.clone()]));
        assert_eq!(
            bytes.as_ref().ok().map(|b| of(b).is_ok()),
            fits.then_some(true)
        );
    }
}

#[test]
fn what_files_cannot_say_is_refused_with_the_reason() {
    let (x, y, z) = Tree::axes();
    let strut = Strut::ball(DVec3::ZERO, 1.0);
    let struts: Arc<dyn Data> =
        Arc::new(Struts::new("mesh(\"l.3mf\")", vec![strut]).unwrap());
    let lattice = call(&struts, [x.clone(), y.clone(), z.clone()]);
    let meshes: Vec<Arc<dyn Data>> = (0..1001).map(|_| cube()).collect();
    let many = of_meshes(&meshes);
    let cases = [
        (x.rand(), "it calls rand"),
        (x.mix(y.clone()), "it calls rand"),
        (x.clone() + f32::INFINITY, "one of its numbers is inf"),
        (x.clone() + f32::NAN, "one of its numbers is NaN"),
        (lattice, "it reads mesh(\"l.3mf\"), and functions"),
        (long(200_000), "more than 200000 nodes"),
        (many, "more than 1000 meshes"),
    ];
    for (tree, why) in cases {
        let said = written(&tree).unwrap_err().to_string();
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}

/// As many nodes as may be written are read.
#[test]
fn the_largest_function_is_read() {
    // One node takes the place apart.
    let bytes = written(&long(199_999)).unwrap();
    let (_, count) = evaluated(&text(&bytes), [0.5, 0.0, 0.0]);
    assert_eq!(1 + count, 200_000);
    of(&bytes).unwrap();
}

/// A ball of `rings` rings of corners, and one more corner in a face of it if
/// `split`.
fn ball(rings: u32, around: u32, split: bool) -> Triangles {
    let at = |ring: u32, k: u32| {
        let up = std::f64::consts::PI * f64::from(ring) / f64::from(rings + 1);
        let turn = std::f64::consts::TAU * f64::from(k) / f64::from(around);
        let out = up.sin();
        DVec3::new(out * turn.cos(), out * turn.sin(), up.cos())
    };
    let mut ball = Triangles {
        vertices: vec![DVec3::Z, DVec3::NEG_Z],
        ..Triangles::default()
    };
    let number = |ring: u32, k: u32| match ring {
        0 => 0,
        ring if ring > rings => 1,
        ring => 2 + (ring - 1) * around + k % around,
    };
    for ring in 1..=rings {
        ball.vertices.extend((0..around).map(|k| at(ring, k)));
    }
    for (ring, k) in (0..=rings).flat_map(|r| (0..around).map(move |k| (r, k)))
    {
        let [a, b] = [k, k + 1].map(|k| number(ring, k));
        let [c, d] = [k, k + 1].map(|k| number(ring + 1, k));
        let both = [[a, c, d], [a, d, b]];
        let is_face =
            |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        ball.corners.extend(both.into_iter().filter(is_face));
    }
    if split && let Some([a, b, c]) = ball.corners.pop() {
        let middle = ball.vertices.len() as u32;
        let corners = [a, b, c].map(|v| ball.vertices[v as usize]);
        ball.vertices.push(corners.iter().sum::<DVec3>() / 3.0);
        let parts = [[a, b, middle], [b, c, middle], [c, a, middle]];
        ball.corners.extend(parts);
    }
    ball
}

/// As many vertices and triangles as may be written are read, those of several
/// meshes together.
#[test]
fn the_largest_meshes_are_read() {
    // A closed mesh of n vertices has 2 n - 4 triangles. Four meshes and the box
    // have a million in all.
    let four = |split: bool| -> Vec<Arc<dyn Data>> {
        let one = |i: u32| -> Arc<dyn Data> {
            let triangles = ball(197, 423, split && i == 0);
            Arc::new(Mesh::new("mesh(\"a.stl\")", triangles).unwrap())
        };
        (0..4).map(one).collect()
    };
    let meshes = four(false);
    let bytes = written(&of_meshes(&meshes)).unwrap();
    let text = text(&bytes);
    let count = |what: &str| text.matches(what).count();
    assert_eq!(count("<vertex ") + count("<triangle "), 1_000_000);
    of(&bytes).unwrap();
    let meshes = four(true);
    let said = written(&of_meshes(&meshes)).unwrap_err().to_string();
    assert!(
        said.contains("more than 1 million vertices and tri"),
        "{said}"
    );
}

/// The reader makes single operations of what stands for them.
#[test]
fn no_operation_is_added() {
    let size = |tree: &Tree| {
        let mut context = Context::new();
        let root = context.import(tree);
        nodes_of(&context, root).len()
    };
    let plain = |tree: &Tree| tree.max(cuboid(&BOUNDS));
    for tree in operations().map(Tree::from) {
        let read = of(&written(&tree).unwrap()).unwrap().tree;
        // `and`, `not` and `mod` ask whether an absolute value is 0.
        let is_sized = matches!(
            &*tree,
            TreeOp::Unary(UnaryOpcode::Not, _)
                | TreeOp::Binary(BinaryOpcode::And | BinaryOpcode::Mod, ..)
        );
        let most = size(&plain(&tree)) + usize::from(is_sized);
        assert!(size(&read) <= most, "{tree:?}: {} {most}", size(&read));
    }
}
