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

/// Steeper faces than this get the whole depth where level ones get none, degrees.
const ANGLE: f64 = 45.0;

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
        flag("tops", 1.0), number("angle", Some(ANGLE)), flag("inward", 0.0))
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
    let body = Body { field: g.shape(0) };
    let depth = g.number(1);
    let mut height = projected(g, &body)? * depth as f32;
    if let Some(part) = part(g, depth) {
        height *= part;
    } else if g.number(8) != 0.0 {
        return Err("blend is for where: it is how far from its border the \
                    depth is whole"
            .to_owned());
    }
    let inward = g.number(11) != 0.0;
    let way = if inward { -1.0 } else { 1.0 };
    let moved = body.field.clone() - height * way;
    let angle = g.number(10);
    if g.number(9) != 0.0 {
        if angle != ANGLE {
            return Err(
                "angle is for tops: false: steeper faces then get the \
                        whole depth"
                    .to_owned(),
            );
        }
        return Ok(moved);
    }
    if !(5.0..=85.0).contains(&angle) {
        return Err("angle must be from 5 to 85 degrees".to_owned());
    }
    let level = body.seen_from_the_side(depth, angle, way);
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

/// The field of a body, a distance near its surface.
struct Body {
    field: Tree,
}

impl Body {
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
        let least = p.clone().min(q.clone()).min(r.clone());
        let most = p.clone().max(q.clone()).max(r.clone());
        // A mean lies between the least and the most. The ranges of the shares do not
        // say so.
        (a * p + b * q + c * r).max(least).min(most)
    }

    /// The body as seen from a place that was moved level to just below the
    /// surface, or just above it if `way` is -1. Beside a steep face this is
    /// inside by so much that the face may move by the depth. At a level face it
    /// is the body itself. So level faces stay where they are, up to their
    /// rims.
    fn seen_from_the_side(&self, depth: f64, angle: f64, way: f32) -> Tree {
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

#[cfg(test)]
mod tests {
    use super::super::tests::{tree, value};
    use fidget::context::Context;
    use glam::DVec2;
    use isocontour::{Detail, Field, Rect, outlines};
    use std::f64::consts::{PI, TAU};

    #[test]
    fn a_surface_moves_by_the_picture() {
        for (text, at, wanted) in [
            // Values are distances beside the face, less depth times picture.
            ("b.textured(0.5, p)", [3.0, 0.0, 2.0], 1.0 - 0.5 * 0.3),
            (
                "b.textured(0.5, p, #{center: [1, 0, 0]})",
                [3.0, 0.0, 2.0],
                0.9,
            ),
            (
                "b.textured(0.5, p, #{projection: \"x\"})",
                [6.0, 3.0, 0.0],
                0.85,
            ),
            (
                "b.textured(0.5, p, #{projection: \"y\"})",
                [3.0, 6.0, 0.0],
                0.85,
            ),
            (
                "b.textured(0.5, z * 0.1, #{projection: \"solid\"})",
                [6.0, 0.0, 1.0],
                0.95,
            ),
            ("b.textured(0.5, p, #{inward: true})", [3.0, 0.0, 2.0], 1.15),
            ("b.textured(0.5, p, #{where: x})", [3.0, 0.0, 2.0], 1.0),
            (
                "b.textured(0.5, p, #{where: x - 3.5})",
                [3.0, 0.0, 2.0],
                0.85,
            ),
            (
                "b.textured(0.5, p, #{where: x - 4, blend: 2})",
                [3.0, 0.0, 2.0],
                0.925,
            ),
            (
                "b.textured(0.5, p, #{projection: \"triplanar\"})",
                [3.0, 0.0, 2.0],
                0.85,
            ),
            (
                "b.textured(0.5, p, #{projection: \"triplanar\"})",
                [6.0, 3.0, 0.0],
                0.85,
            ),
            (
                "b.textured(0.5, x * 0.1, #{projection: \"cylinder\", radius: 5})",
                [0.0, 5.5, 0.0],
                0.5 - 0.05 * PI * 2.5,
            ),
        ] {
            let text = format!(
                "let b = box([-5, -5, -1], [5, 5, 1]); let p = x * 0.1; {text}"
            );
            let [x, y, z] = at;
            let found = f64::from(value(&text, x, y, z));
            assert!((found - wanted).abs() < 1e-3, "{text}: {found}");
        }
    }

    #[test]
    fn level_faces_stay_where_they_are() {
        let way = "#{projection: \"cylinder\", radius: 10, tops: false}";
        let out = format!("cylinder(10, 6).textured(1, 1 + 0 * x, {way})");
        let at = |r: f32, z: f32| value(&out, -0.6 * r, 0.8 * r, z);
        for r in [0.0, 5.0, 9.9, 10.1, 10.9] {
            assert!(at(r, 2.99) < 0.0 && at(r, -2.99) < 0.0, "{r}");
            assert!(at(r, 3.01) > 0.0 && at(r, -3.01) > 0.0, "{r}");
        }
        assert!(at(11.01, 0.0) > 0.0 && at(11.01, 2.9) > 0.0);
        // Without it, they move.
        assert!(
            value("cylinder(10, 6).textured(1, 1 + 0 * x)", 0.0, 0.0, 3.9)
                < 0.0
        );
        let inward = out.replace("tops", "inward: true, tops");
        let at = |r: f32, z: f32| value(&inward, 0.8 * r, 0.6 * r, z);
        assert!(at(8.99, 0.0) < 0.0 && at(9.01, 0.0) > 0.0);
        assert!(at(5.0, 2.99) < 0.0 && at(5.0, 3.01) > 0.0);
    }

    /// For any size, on both sides of the half plane at -x.
    #[test]
    fn there_is_no_seam() {
        for pattern in ["knurl", "hexagons", "dots", "ribs", "scales"] {
            for (size, radius) in [(3.0, 15.0), (2.37, 11.1), (9.0, 1.0)] {
                for on in ["cylinder", "sphere"] {
                    let text = format!(
                        "sphere({radius}).textured(1, {pattern}(#{{size: \
                         {size}}}), #{{projection: \"{on}\", radius: \
                         {radius}, size: {size}}})"
                    );
                    let mut context = Context::new();
                    let root = context.import(&tree(&text).unwrap());
                    for i in 0..40 {
                        let z = radius as f32 * (i as f32 / 25.0 - 0.8);
                        let [a, b] = [-1e-7, 1e-7].map(|y| {
                            let x = -radius as f32;
                            context.eval_xyz(root, x, y, z).unwrap()
                        });
                        assert!((a - b).abs() < 1e-3, "{text}: {a}, {b}");
                    }
                }
            }
        }
    }

    /// The outline is that of the formula, to the 5 µm that are promised.
    #[test]
    fn outlines_are_those_of_the_formula() {
        let text = "cylinder(10, 20).textured(0.6, 0.5 + 0.5 * sin(x * 2) * \
            cos(y), #{projection: \"cylinder\", radius: 10, size: pi, tops: \
            false})";
        let rect = Rect {
            min: DVec2::splat(-12.0),
            max: DVec2::splat(12.0),
        };
        let detail = Detail {
            accuracy: 0.001,
            smallest: 0.1,
        };
        for z in [-4.0, 1.3] {
            let field =
                Field::new(&tree(text).unwrap(), 0.0, rect, 0.2).unwrap();
            let found = outlines(&field, &[z], detail).unwrap();
            let ring = &found[0].area.rings[0];
            assert!(ring.len() > 200, "{}", ring.len());
            for (i, p) in ring.iter().enumerate() {
                let next = ring[(i + 1) % ring.len()];
                for p in [*p, 0.5 * (*p + next)] {
                    let way = p.to_angle() * 10.0 * (20.0 * PI / TAU / 10.0);
                    let wanted = 10.3 + 0.3 * (way * 2.0).sin() * z.cos();
                    let off = p.length() - wanted;
                    assert!(off.abs() < 0.005, "{off} at {p}");
                }
            }
        }
    }

    #[test]
    fn drawings_are_wrapped() {
        let text = "extrude_z(rectangle([5, -2], [9, 2]), -1, 0.5).wrapped(8)";
        let at = |way: f32, z: f32, out: f32| {
            let (sin, cos) = (way / 8.0).sin_cos();
            value(text, (8.0 + out) * cos, (8.0 + out) * sin, z)
        };
        assert!((at(7.0, 0.0, 0.0) + 0.5).abs() < 1e-5);
        assert!((at(9.5, 0.0, -0.1) - 0.5).abs() < 1e-5);
        assert!((at(7.0, 2.25, 0.0) - 0.25).abs() < 1e-5);
        assert!((at(7.0, 0.0, 0.75) - 0.25).abs() < 1e-5);
    }

    #[test]
    fn mistakes_are_explained() {
        for (options, words) in [
            ("projection: \"cube\"", "one of \"planar\", \"x\", \"y\""),
            ("projection: \"cylinder\"", "radius is missing"),
            ("size: 4", "size and radius are for \"cylinder\""),
            ("tops: 1", "tops must be true or false"),
            ("angle: 30", "angle is for tops: false"),
            ("blend: 2", "blend is for where"),
            ("tops: false, angle: 90", "from 5 to 85"),
            ("top: false", "there is no \"top\""),
        ] {
            let text = format!("sphere(5).textured(1, ribs(), #{{{options}}})");
            let error = tree(&text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
        for (text, words) in [
            ("ribs(#{gap: 2})", "gap must be a number from 0 to 1"),
            ("voronoi(#{repeat: 1000})", "1 to 256"),
            ("knurl(#{angle: 0})", "from 5 to 85"),
            ("sphere(5).textured(1)", "picture is missing"),
        ] {
            let error = tree(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    /// Patterns are numbers to calculate with; what is textured is a body.
    #[test]
    fn patterns_are_no_bodies() {
        assert!(tree("ribs() + dots()").is_ok());
        assert!(tree("sphere(3).textured(1, ribs()) + sphere(2)").is_err());
    }
}
