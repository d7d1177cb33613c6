//! The shapes and operations beside fidget's, one row each.

use super::convex::{area, convex, corner, crossing, polygon};
use super::curved::curved;
use super::flush::flush;
use super::{Argument, ArgumentKind, Given, Row};
use crate::script::shape::union;
use fidget::context::Tree;
use fidget::shapes::Blend;
use std::f64::consts::TAU;

/// Greatest number of copies that an array makes.
const MOST_COPIES: f64 = 1000.0;
/// Greatest number of corners of a polygon.
const MOST_CORNERS: usize = 1000;

pub(super) const fn argument(
    name: &'static str,
    kind: ArgumentKind,
    default: Option<f64>,
) -> Argument {
    Argument {
        name,
        kind,
        default,
    }
}

pub(super) const fn positive(name: &'static str) -> Argument {
    argument(name, ArgumentKind::Positive, None)
}

const fn length(name: &'static str, default: Option<f64>) -> Argument {
    argument(name, ArgumentKind::Length, default)
}

pub(super) const fn number(
    name: &'static str,
    default: Option<f64>,
) -> Argument {
    argument(name, ArgumentKind::Number, default)
}

pub(super) const fn place(name: &'static str) -> Argument {
    argument(name, ArgumentKind::Place, None)
}

pub(super) const fn shape(name: &'static str) -> Argument {
    argument(name, ArgumentKind::Shape, None)
}

const POINTS: Argument = argument("points", ArgumentKind::Points, None);
pub(super) const CENTER: Argument =
    argument("center", ArgumentKind::Place, Some(0.0));

macro_rules! rows {
    ($($name:literal ($($argument:expr),* $(,)?) $example:literal
       $build:expr;)*) => {
        &[$(Row {
            name: $name,
            arguments: &[$($argument),*],
            example: $example,
            build: $build,
        }),*]
    };
}

pub(super) use rows;

pub(super) const ROWS: &[Row] = rows![
    // These fields are distances.
    "cylinder" (CENTER, positive("radius"), positive("height"))
        "cylinder(#{radius: 5, height: 20})"
        |g| {
            let [x, y, z] = from(g, 0);
            let h = half(g, 2);
            Ok(corner(ring(&x, &y) - g.number(1) as f32, z.abs() - h))
        };
    "rounded_cylinder" (
        CENTER, positive("radius"), positive("height"), length("edge", None))
        "rounded_cylinder(#{radius: 5, height: 20, edge: 1})"
        |g| {
            let (r, h, edge) = (g.number(1), g.number(2) / 2.0, g.number(3));
            fits(edge, r.min(h))?;
            let [x, y, z] = from(g, 0);
            let side = ring(&x, &y) - (r - edge) as f32;
            Ok(corner(side, z.abs() - (h - edge) as f32) - edge as f32)
        };
    "cone" (
        CENTER, positive("radius"), length("top", Some(0.0)),
        positive("height"))
        "cone(#{radius: 10, top: 4, height: 20})"
        |g| {
            let (r, top, h) = (g.number(1), g.number(2), g.number(3) / 2.0);
            let profile = [[0.0, -h], [r, -h], [top, h], [0.0, h]];
            let [x, y, z] = from(g, 0);
            Ok(convex(&profile, false, &ring(&x, &y), &z))
        };
    "tube" (
        CENTER, positive("radius"), positive("inner"), positive("height"))
        "tube(#{radius: 8, inner: 6, height: 20})"
        |g| {
            let (r, inner) = (g.number(1), g.number(2));
            if inner >= r {
                return Err("inner must be less than radius".to_owned());
            }
            let [x, y, z] = from(g, 0);
            let middle = ring(&x, &y) - (0.5 * (r + inner)) as f32;
            let wall = middle.abs() - (0.5 * (r - inner)) as f32;
            Ok(corner(wall, z.abs() - half(g, 3)))
        };
    "torus" (CENTER, positive("radius"), positive("tube"))
        "torus(#{radius: 15, tube: 4})"
        |g| {
            let [x, y, z] = from(g, 0);
            let out = ring(&x, &y) - g.number(1) as f32;
            Ok(ring(&out, &z) - g.number(2) as f32)
        };
    "capsule" (place("start"), place("end"), positive("radius"))
        "capsule(#{start: [0, 0, 0], end: [0, 0, 20], radius: 5})"
        |g| {
            let (a, b) = (g.place(0), g.place(1));
            let d = b - a;
            let [x, y, z] = from(g, 0);
            let [dx, dy, dz] = d.to_array().map(|v| v as f32);
            let t = match d.length_squared() {
                0.0 => Tree::constant(0.0),
                l => (x.clone() * dx + y.clone() * dy + z.clone() * dz)
                    * (1.0 / l) as f32,
            };
            let t = t.max(0.0).min(1.0);
            let (x, y) = (x - t.clone() * dx, y - t.clone() * dy);
            let out = x.square() + y.square() + (z - t * dz).square();
            Ok(out.sqrt() - g.number(2) as f32)
        };
    "rounded_box" (place("lower"), place("upper"), length("edge", None))
        "rounded_box(#{lower: [0, 0, 0], upper: [30, 20, 10], edge: 2})"
        |g| {
            let (lower, upper) = (g.place(0), g.place(1));
            let size = upper - lower;
            let edge = g.number(2);
            fits(edge, 0.5 * size.min_element())?;
            if size.min_element() <= 0.0 {
                return Err("upper must be above lower".to_owned());
            }
            let middle = (0.5 * (lower + upper)).to_array();
            let half = (0.5 * size - edge).to_array();
            let [x, y, z] = around(middle);
            let out = |of: Tree, k: usize| of.abs() - half[k] as f32;
            let plan = corner(out(x, 0), out(y, 1));
            Ok(corner(plan, out(z, 2)) - edge as f32)
        };
    "prism" (
        CENTER, positive("sides"), positive("radius"), positive("height"))
        "prism(#{sides: 6, radius: 10, height: 5})"
        |g| {
            let n = whole(g.number(1), "sides", 3.0, 64.0)?;
            let corners: Vec<_> = (0..n).map(|i| {
                let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
                [g.number(2) * cos, g.number(2) * sin]
            }).collect();
            let [x, y, z] = from(g, 0);
            let plan = convex(&corners, true, &x, &y);
            Ok(corner(plan, z.abs() - half(g, 3)))
        };
    "wedge" (place("lower"), place("upper"))
        "wedge(#{lower: [0, 0, 0], upper: [30, 20, 10]})"
        |g| {
            let (a, b) = (g.place(0), g.place(1));
            if (b - a).min_element() <= 0.0 {
                return Err("upper must be above lower".to_owned());
            }
            let (x, y, z) = Tree::axes();
            let side = [[a.x, a.z], [b.x, a.z], [a.x, b.z]];
            let plan = convex(&side, true, &x, &z);
            let across = (y - (0.5 * (a.y + b.y)) as f32).abs();
            Ok(corner(plan, across - (0.5 * (b.y - a.y)) as f32))
        };
    "half_space" (place("normal"), number("offset", Some(0.0)))
        "half_space(#{normal: [0, 0, 1], offset: 5})"
        |g| {
            let n = g.place(0);
            let Some(n) = n.try_normalize() else {
                return Err("normal has no direction".to_owned());
            };
            let (x, y, z) = Tree::axes();
            Ok(x * n.x as f32 + y * n.y as f32 + z * n.z as f32
                - g.number(1) as f32)
        };
    "rounded_rectangle" (
        argument("lower", ArgumentKind::Spot, None),
        argument("upper", ArgumentKind::Spot, None), length("edge", None))
        "rounded_rectangle(#{lower: [0, 0], upper: [30, 20], edge: 2})"
        |g| {
            let (lower, upper) = (g.place(0), g.place(1));
            let size = upper - lower;
            let edge = g.number(2);
            if size.x.min(size.y) <= 0.0 {
                return Err("upper must be above lower".to_owned());
            }
            fits(edge, 0.5 * size.x.min(size.y))?;
            let [x, y, _] = around((0.5 * (lower + upper)).to_array());
            let plan = corner(
                x.abs() - (0.5 * size.x - edge) as f32,
                y.abs() - (0.5 * size.y - edge) as f32,
            );
            Ok(plan - edge as f32)
        };
    // This field is a distance if the polygon is convex.
    "polygon" (POINTS)
        "polygon([[0, 0], [20, 0], [20, 5], [5, 5], [5, 15], [0, 15]])"
        |g| {
            let mut points = g.points(0).to_vec();
            points.dedup();
            if points.len() > MOST_CORNERS {
                return Err(format!("at most {MOST_CORNERS} corners"));
            }
            if let Some([i, j]) = crossing(&points) {
                let [a, b] = [points[i], points[j]];
                return Err(format!(
                    "the polygon crosses itself: the sides from {a:?} and from \
                     {b:?} do"
                ));
            }
            if area(&points) < 0.0 {
                points.reverse();
            }
            let (x, y, _) = Tree::axes();
            polygon(&points, &x, &y, 0)
        };
    // This field is not a distance.
    "ellipsoid" (place("radii"), CENTER)
        "ellipsoid(#{radii: [20, 12, 8]})"
        |g| {
            let radii = g.place(0);
            if radii.min_element() <= 0.0 {
                return Err("radii must be above 0".to_owned());
            }
            let [x, y, z] = from(g, 1);
            let part = |of: Tree, r: f64| (of * (1.0 / r) as f32).square();
            let out = part(x, radii.x) + part(y, radii.y) + part(z, radii.z);
            Ok((out.sqrt() - 1.0) * radii.min_element() as f32)
        };
    // These surfaces have no end.
    "gyroid" (positive("cell"), positive("thickness"))
        "gyroid(#{cell: 10, thickness: 1})"
        |g| Ok(sheet(g, 1.5, |[x, y, z]| {
            x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
        }));
    "schwarz_p" (positive("cell"), positive("thickness"))
        "schwarz_p(#{cell: 10, thickness: 1})"
        |g| Ok(sheet(g, 1.5, |[x, y, z]| x.cos() + y.cos() + z.cos()));
    "diamond" (positive("cell"), positive("thickness"))
        "diamond(#{cell: 10, thickness: 1})"
        |g| Ok(sheet(g, 1.0, |[x, y, z]| {
            x.sin() * y.sin() * z.sin()
                + x.sin() * y.cos() * z.cos()
                + x.cos() * y.sin() * z.cos()
                + x.cos() * y.cos() * z.sin()
        }));
    // These are operations.
    "blend" (shape("a"), shape("b"), length("radius", None))
        "blend(a, b, 3)"
        |g| Ok(blend(g.shape(0), g.shape(1), g.number(2)));
    "blend_intersection" (shape("a"), shape("b"), length("radius", None))
        "blend_intersection(a, b, 3)"
        |g| Ok(-blend(-g.shape(0), -g.shape(1), g.number(2)));
    "blend_difference" (shape("shape"), shape("cutout"), length("radius", None))
        "blend_difference(a, b, 3)"
        |g| Ok(-blend(-g.shape(0), g.shape(1), g.number(2)));
    "shell" (shape("shape"), positive("thickness"))
        "sphere(10).shell(2)"
        |g| {
            let half = (0.5 * g.number(1)) as f32;
            Ok((g.shape(0) + half).abs() - half)
        };
    "grow" (shape("shape"), number("distance", None))
        "sphere(10).grow(1)"
        |g| Ok(g.shape(0) - g.number(1) as f32);
    "twist" (shape("shape"), number("pitch", None))
        "f.twist(40)"
        |g| {
            let pitch = g.number(1);
            if pitch == 0.0 {
                return Err("pitch is the height of a turn, not 0".to_owned());
            }
            let (x, y, z) = Tree::axes();
            let turn = z.clone() * (TAU / pitch) as f32;
            let (sin, cos) = (turn.sin(), turn.cos());
            Ok(g.shape(0).remap_xyz(
                x.clone() * cos.clone() + y.clone() * sin.clone(),
                y * cos - x * sin,
                z,
            ))
        };
    "mirror_x" (shape("shape")) "f.mirror_x()" |g| {
        let (x, y, z) = Tree::axes();
        Ok(g.shape(0).remap_xyz(x.abs(), y, z))
    };
    "mirror_y" (shape("shape")) "f.mirror_y()" |g| {
        let (x, y, z) = Tree::axes();
        Ok(g.shape(0).remap_xyz(x, y.abs(), z))
    };
    "mirror_z" (shape("shape")) "f.mirror_z()" |g| {
        let (x, y, z) = Tree::axes();
        Ok(g.shape(0).remap_xyz(x, y, z.abs()))
    };
    "revolve_z" (shape("shape")) "circle([10, 0], 3).revolve_z()" |g| {
        let (x, y, z) = Tree::axes();
        Ok(g.shape(0).remap_xyz(ring(&x, &y), z, Tree::constant(0.0)))
    };
    "linear_array" (shape("shape"), place("step"), positive("count"))
        "f.linear_array([12, 0, 0], 5)"
        |g| {
            let n = whole(g.number(2), "count", 1.0, MOST_COPIES)?;
            let (x, y, z) = Tree::axes();
            let copies = (0..n).map(|i| {
                let [a, b, c] =
                    (g.place(1) * i as f64).to_array().map(|v| v as f32);
                g.shape(0).remap_xyz(x.clone() - a, y.clone() - b, z.clone() - c)
            });
            Ok(all(copies.collect()))
        };
    "polar_array" (shape("shape"), positive("count"))
        "f.polar_array(6)"
        |g| {
            let n = whole(g.number(1), "count", 1.0, MOST_COPIES)?;
            let (x, y, z) = Tree::axes();
            let copies = (0..n).map(|i| {
                let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
                let (sin, cos) = (sin as f32, cos as f32);
                g.shape(0).remap_xyz(
                    x.clone() * cos + y.clone() * sin,
                    y.clone() * cos - x.clone() * sin,
                    z.clone(),
                )
            });
            Ok(all(copies.collect()))
        };
];

/// The axes from the place that is argument `at`.
fn from(g: &Given, at: usize) -> [Tree; 3] {
    around(g.place(at).to_array())
}

fn around(middle: [f64; 3]) -> [Tree; 3] {
    let (x, y, z) = Tree::axes();
    let [a, b, c] = middle.map(|v| v as f32);
    [x - a, y - b, z - c]
}

fn half(g: &Given, at: usize) -> f32 {
    (0.5 * g.number(at)) as f32
}

/// Distance from the z axis.
fn ring(x: &Tree, y: &Tree) -> Tree {
    (x.square() + y.square()).sqrt()
}

/// fidget's `blend`, whose documentation names its source, up to the faces that
/// both have in common.
fn blend(a: Tree, b: Tree, radius: f64) -> Tree {
    let mut faces = flush(&a, &b);
    faces.extend(curved(&a, &b));
    let radius = radius as f32;
    let soft = Tree::from(Blend { a, b, radius });
    faces.into_iter().fold(soft, |part, face| part.max(face))
}

/// A sheet of about the given thickness around the places where a function is
/// 0. The function's slope there is about `slope` per radian.
fn sheet(g: &Given, slope: f64, f: fn([Tree; 3]) -> Tree) -> Tree {
    let k = TAU / g.number(0);
    let (x, y, z) = Tree::axes();
    let f = f([x * k as f32, y * k as f32, z * k as f32]);
    f.abs() * (1.0 / (slope * k)) as f32 - half(g, 1)
}

fn all(copies: Vec<Tree>) -> Tree {
    union(copies).unwrap_or_else(|| Tree::constant(f32::INFINITY))
}

fn fits(edge: f64, most: f64) -> Result<(), String> {
    if edge <= most {
        Ok(())
    } else {
        Err(format!("edge is {edge}, but must be {most} at most to fit"))
    }
}

pub(super) fn whole(
    n: f64,
    what: &str,
    least: f64,
    most: f64,
) -> Result<usize, String> {
    if n.fract() == 0.0 && (least..=most).contains(&n) {
        Ok(n as usize)
    } else {
        Err(format!("{what} must be a whole number, {least} to {most}"))
    }
}
