//! fidget's shapes and operations, one row each, with the names and fields that
//! they have there.

use super::rows::{CENTER, argument, number, place, positive, rows, shape};
use super::{Argument, ArgumentKind, Given, Row};
use fidget::context::Tree;
use fidget::shapes as of;
use fidget::shapes::types::{Vec2, Vec3};
use glam::DVec3;

const SHAPE: Argument = shape("shape");
const INPUT: Argument = argument("input", ArgumentKind::Shapes, None);
const ANGLE: Argument = number("angle", None);
const OFFSET: Argument = number("offset", Some(0.0));
const LOWER: Argument = number("lower", Some(0.0));
const UPPER: Argument = number("upper", None);

pub(super) const ROWS: &[Row] = rows![
    "sphere" (CENTER, positive("radius"))
        "sphere(#{center: [0, 0, 0], radius: 10})"
        |g| Ok(of::Sphere { center: at(g, 0), radius: f(g, 1) }.into());
    "box" (place("lower"), place("upper"))
        "box(#{lower: [0, 0, 0], upper: [30, 20, 10]})"
        |g| {
            above(g.place(1) - g.place(0), 3)?;
            Ok(of::Box { lower: at(g, 0), upper: at(g, 1) }.into())
        };
    "circle" (
        argument("center", ArgumentKind::Spot, Some(0.0)),
        positive("radius"))
        "circle(#{center: [0, 0], radius: 5})"
        |g| Ok(of::Circle { center: spot(g, 0), radius: f(g, 1) }.into());
    "rectangle" (argument("lower", ArgumentKind::Spot, None), argument("upper", ArgumentKind::Spot, None))
        "rectangle([0, 0], [30, 20])"
        |g| {
            above(g.place(1) - g.place(0), 2)?;
            Ok(of::Rectangle { lower: spot(g, 0), upper: spot(g, 1) }.into())
        };
    "move" (SHAPE, place("offset"))
        "f.move([10, 0, 0])"
        |g| Ok(of::Move { shape: g.shape(0), offset: at(g, 1) }.into());
    "scale" (SHAPE, argument("scale", ArgumentKind::Factors, None))
        "f.scale([1, 1, 2])"
        |g| Ok(of::Scale { shape: g.shape(0), scale: at(g, 1) }.into());
    "scale_uniform" (SHAPE, positive("scale"))
        "f.scale_uniform(2)"
        |g| Ok(of::ScaleUniform { shape: g.shape(0), scale: f(g, 1) }.into());
    "reflect" (
        SHAPE,
        argument("plane", ArgumentKind::Plane, Some(0.0)))
        "f.reflect(\"yz\")"
        |g| Ok(of::Reflect { shape: g.shape(0), plane: g.plane(1) }.into());
    "reflect_x" (SHAPE, OFFSET) "f.reflect_x(0)"
        |g| Ok(of::ReflectX { shape: g.shape(0), offset: f(g, 1) }.into());
    "reflect_y" (SHAPE, OFFSET) "f.reflect_y(0)"
        |g| Ok(of::ReflectY { shape: g.shape(0), offset: f(g, 1) }.into());
    "reflect_z" (SHAPE, OFFSET) "f.reflect_z(0)"
        |g| Ok(of::ReflectZ { shape: g.shape(0), offset: f(g, 1) }.into());
    "reflect_xy" (SHAPE, OFFSET) "f.reflect_xy(0)"
        |g| Ok(of::ReflectXY { shape: g.shape(0), offset: f(g, 1) }.into());
    "repeat_x" (SHAPE, positive("radius"), OFFSET)
        "f.repeat_x(#{radius: 5, offset: 0})"
        |g| Ok(of::RepeatX {
            shape: g.shape(0), radius: f(g, 1), offset: f(g, 2)
        }.into());
    "repeat_y" (SHAPE, positive("radius"), OFFSET)
        "f.repeat_y(#{radius: 5, offset: 0})"
        |g| {
            let (x, y, z) = Tree::axes();
            Ok(g.shape(0).remap_xyz(x, repeated(g, &y), z))
        };
    "repeat_z" (SHAPE, positive("radius"), OFFSET)
        "f.repeat_z(#{radius: 5, offset: 0})"
        |g| {
            let (x, y, z) = Tree::axes();
            Ok(g.shape(0).remap_xyz(x, y, repeated(g, &z)))
        };
    "rotate" (
        SHAPE,
        argument("axis", ArgumentKind::Axis, Some(0.0)),
        ANGLE, CENTER)
        "f.rotate(#{axis: [1, 1, 0], angle: 30, center: [0, 0, 0]})"
        |g| Ok(of::Rotate {
            shape: g.shape(0), axis: g.axis(1), angle: f(g, 2), center: at(g, 3)
        }.into());
    "rotate_x" (SHAPE, ANGLE, CENTER) "f.rotate_x(90)"
        |g| Ok(of::RotateX {
            shape: g.shape(0), angle: f(g, 1), center: at(g, 2)
        }.into());
    "rotate_y" (SHAPE, ANGLE, CENTER) "f.rotate_y(90)"
        |g| Ok(of::RotateY {
            shape: g.shape(0), angle: f(g, 1), center: at(g, 2)
        }.into());
    "rotate_z" (SHAPE, ANGLE, CENTER) "f.rotate_z(90)"
        |g| Ok(of::RotateZ {
            shape: g.shape(0), angle: f(g, 1), center: at(g, 2)
        }.into());
    "revolve_y" (SHAPE, OFFSET) "f.revolve_y()"
        |g| Ok(of::RevolveY { shape: g.shape(0), offset: f(g, 1) }.into());
    "extrude_z" (SHAPE, LOWER, UPPER)
        "extrude_z(circle(5), 0, 20)"
        |g| {
            higher(g, 1)?;
            Ok(of::ExtrudeZ {
                shape: g.shape(0), lower: f(g, 1), upper: f(g, 2)
            }.into())
        };
    "loft_z" (shape("a"), shape("b"), LOWER, UPPER)
        "loft_z(circle(5), circle(8), 0, 20)"
        |g| {
            higher(g, 2)?;
            Ok(of::LoftZ {
                a: g.shape(0), b: g.shape(1), lower: f(g, 2), upper: f(g, 3)
            }.into())
        };
    "union" (INPUT) "union(a, b)"
        |g| Ok(of::Union { input: g.shapes(0) }.into());
    "intersection" (INPUT) "intersection(a, b)"
        |g| Ok(of::Intersection { input: g.shapes(0) }.into());
    "difference" (SHAPE, argument("cutout", ArgumentKind::Shapes, None)) "difference(a, b)"
        |g| {
            let cutout = of::Union { input: g.shapes(1) }.into();
            Ok(of::Difference { shape: g.shape(0), cutout }.into())
        };
    "inverse" (SHAPE) "inverse(f)"
        |g| Ok(of::Inverse { shape: g.shape(0) }.into());
];

fn f(g: &Given, at: usize) -> f32 {
    g.number(at) as f32
}

fn at(g: &Given, at: usize) -> Vec3 {
    let [x, y, z] = g.place(at).as_vec3().to_array();
    Vec3 { x, y, z }
}

fn spot(g: &Given, at: usize) -> Vec2 {
    let place = g.place(at).as_vec3();
    Vec2 {
        x: place.x,
        y: place.y,
    }
}

/// The coordinate that comes again every two radii, as fidget's `RepeatX` has
/// it.
fn repeated(g: &Given, axis: &Tree) -> Tree {
    let (radius, offset) = (f(g, 1), f(g, 2));
    let r = radius - offset;
    (axis.clone() + r).modulo(radius * 2.0) - r
}

fn above(size: DVec3, axes: usize) -> Result<(), String> {
    if size
        .to_array()
        .iter()
        .take(axes)
        .all(|length| *length > 0.0)
    {
        Ok(())
    } else {
        Err("upper must be above lower in every coordinate".to_owned())
    }
}

/// The number of argument `lower` and the one after it are in order.
fn higher(g: &Given, lower: usize) -> Result<(), String> {
    if g.number(lower + 1) > g.number(lower) {
        Ok(())
    } else {
        Err("upper must be above lower".to_owned())
    }
}
