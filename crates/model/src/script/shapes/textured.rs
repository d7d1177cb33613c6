//! Bodies whose surface is moved out or in by a picture, and drawings wrapped
//! round an axis.
//!
//! In: a field that is a distance near its surface, a depth, and a picture, a
//! function from 0 to 1. Out: the field less the depth times the picture at the
//! place's coordinates on the surface.

use super::rows::{argument, number, positive, rows};
use super::{Argument, ArgumentKind, Given, Row};
use fidget::context::{Tree, TreeOp};
use std::f64::consts::TAU;

/// How a picture is laid on a body.
const PROJECTIONS: &[&str] = &[
    "planar",
    "x",
    "y",
    "z",
    "cylinder",
    "sphere",
    "triplanar",
    "solid",
];

/// Step of a body's slopes, mm: a hundred times what f32 resolves at 100 mm, and
/// less than what is printed.
const STEP: f32 = 0.02;

const fn flag(name: &'static str, default: f64) -> Argument {
    argument(name, ArgumentKind::Flag, Some(default))
}

pub(super) const ROWS: &[Row] = rows![
    "textured" (
        argument("shape", ArgumentKind::Shape, None), positive("depth"),
        argument("picture", ArgumentKind::Shape, None),
        argument("projection", ArgumentKind::Word(PROJECTIONS), Some(0.0)),
        argument("size", ArgumentKind::Length, Some(0.0)),
        argument("radius", ArgumentKind::Length, Some(0.0)),
        argument("center", ArgumentKind::Place, Some(0.0)),
        argument("where", ArgumentKind::Shape, Some(f64::NEG_INFINITY)),
        argument("blend", ArgumentKind::Length, Some(0.0)),
        flag("tops", 1.0), number("angle", Some(45.0)), flag("inward", 0.0))
        "f.textured(0.4, knurl(2), #{projection: \"cylinder\", radius: 10, size: 2})"
        textured;
    "wrapped" (
        argument("shape", ArgumentKind::Shape, None), positive("radius"))
        "extrude_z(circle(3), -1, 1).wrapped(20)"
        |g| {
            let (x, y, z) = Tree::axes();
            let radius = g.number(1) as f32;
            let out = (x.square() + y.square()).sqrt() - radius;
            Ok(g.shape(0).remap_xyz(y.atan2(x) * radius, z, out))
        };
];

fn textured(g: &Given) -> Result<Tree, String> {
    let body = Body::of(g.shape(0));
    let depth = g.number(1);
    let mut height = projected(g, &body)? * depth as f32;
    if let Some(part) = part(g, depth) {
        height = height * part;
    }
    let inward = g.number(11) != 0.0;
    let way = if inward { -1.0 } else { 1.0 };
    let moved = body.field.clone() - height * way;
    if g.number(9) != 0.0 {
        return Ok(moved);
    }
    let angle = g.number(10);
    if !(5.0..=85.0).contains(&angle) {
        return Err("angle must be from 5 to 85 degrees".to_owned());
    }
    let level = body.from_the_side(depth, angle, way);
    Ok(if inward {
        moved.min(level)
    } else {
        moved.max(level)
    })
}

/// The share of the depth at each place, if it is not all of it.
fn part(g: &Given, depth: f64) -> Option<Tree> {
    let only = g.shape(7);
    if matches!(*only, TreeOp::Const(_)) {
        return None;
    }
    let blend = match g.number(8) {
        0.0 => depth,
        blend => blend,
    };
    Some((only * (-1.0 / blend) as f32).max(0.0).min(1.0))
}

/// The picture on the body.
fn projected(g: &Given, body: &Body) -> Result<Tree, String> {
    let picture = g.shape(2);
    let center = g.place(6).to_array().map(|v| v as f32);
    let (x, y, z) = Tree::axes();
    let [x, y, z] = [x - center[0], y - center[1], z - center[2]];
    let flat = |u: &Tree, v: &Tree| {
        picture.remap_xyz(u.clone(), v.clone(), Tree::constant(0.0))
    };
    let name = PROJECTIONS.get(g.number(3) as usize).copied();
    let name = name.unwrap_or_default();
    let round = matches!(name, "cylinder" | "sphere");
    let (size, radius) = (g.number(4), g.number(5));
    if round && radius == 0.0 {
        return Err(format!(
            "radius is missing: on a {name}, coordinates of the picture are \
             mm at this radius"
        ));
    }
    if !round && (size != 0.0 || radius != 0.0) {
        return Err(
            "size and radius are for \"cylinder\" and \"sphere\"; elsewhere \
             the picture has its own size"
                .to_owned(),
        );
    }
    // Once round is a whole number of repeats.
    let turn = TAU * radius;
    let way = match size {
        0.0 => turn,
        size => (turn / size).round().max(1.0) * size,
    };
    let around = || y.atan2(x.clone()) * (way / TAU) as f32;
    Ok(match name {
        "x" => flat(&y, &z),
        "y" => flat(&x, &z),
        "cylinder" => flat(&around(), &z),
        "sphere" => {
            let ring = (x.square() + y.square()).sqrt();
            flat(&around(), &(z.atan2(ring) * radius as f32))
        }
        "triplanar" => body.blended([flat(&y, &z), flat(&x, &z), flat(&x, &y)]),
        "solid" => picture.remap_xyz(x, y, z),
        _ => flat(&x, &y),
    })
}

/// A body and how it changes along each axis, in one step.
struct Body {
    field: Tree,
}

impl Body {
    fn of(field: Tree) -> Body {
        Body { field }
    }

    /// The change in one step along each axis: differences, since data such as
    /// a mesh has no formula of its slope.
    fn changes(&self) -> [Tree; 3] {
        [0, 1, 2].map(|axis| {
            let (x, y, z) = Tree::axes();
            let mut at = [x, y, z];
            at[axis] = at[axis].clone() + STEP;
            let [x, y, z] = at;
            self.field.remap_xyz(x, y, z) - self.field.clone()
        })
    }

    /// Pictures seen along x, y and z, each where the surface looks that way.
    fn blended(&self, pictures: [Tree; 3]) -> Tree {
        // The fourth power leaves a border of some 20 degrees.
        let looks =
            self.changes().map(|c| (c * STEP.recip()).square().square());
        let [a, b, c] = looks.clone();
        let all = (a + b + c).max(1e-6);
        let shares = looks.map(|look| (look / all.clone()).min(1.0));
        let [a, b, c] = shares;
        let [p, q, r] = pictures;
        a * p + b * q + c * r
    }

    /// The body as seen from a place that was moved level to just below the
    /// surface, or just above it if `way` is -1. Beside a steep face this is
    /// inside by so much that the face may move by the depth. At a level face it
    /// is the body itself. So level faces stay where they are, up to their
    /// rims.
    fn from_the_side(&self, depth: f64, angle: f64, way: f32) -> Tree {
        // At an angle a, a place at a distance d comes to
        // d cos²a - below sin²a. This is 0 for the depth at the angle that is
        // given.
        let below = (depth / angle.to_radians().tan().powi(2)) as f32;
        let out = (self.field.clone() * way).max(0.0).min(depth as f32);
        let go = (out + below) * way;
        let [across, along, _] = self
            .changes()
            .map(|c| (c * STEP.recip()).max(-1.0).min(1.0));
        let (x, y, z) = Tree::axes();
        self.field
            .remap_xyz(x - across * go.clone(), y - along * go, z)
    }
}
