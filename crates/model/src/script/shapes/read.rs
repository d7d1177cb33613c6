//! What a script's values stand for in a call of a shape.

use super::{ArgumentKind, Value};
use crate::script::shape::{components, number, shape};
use fidget::context::{Tree, TreeOp};
use fidget::shapes::types::{Axis, Plane, Vec3};
use fidget::var::Var;
use glam::DVec3;
use rhai::Dynamic;

/// True if a value without a name is of this kind, whether or not it is
/// allowed.
pub(super) fn may_be(kind: ArgumentKind, value: &Dynamic) -> bool {
    let number = value.is_int() || value.is_float();
    match kind {
        ArgumentKind::Shape => !number && shape(value).is_some(),
        ArgumentKind::Shapes => {
            value.is_array() || !number && shape(value).is_some()
        }
        ArgumentKind::Place | ArgumentKind::Spot => place(value).is_some(),
        // A factor alone is a likely mistake, which has a message.
        ArgumentKind::Factors => number || place(value).is_some(),
        ArgumentKind::Axis => axis(value).is_some(),
        ArgumentKind::Plane => plane(value).is_some(),
        ArgumentKind::Points => value.is_array(),
        ArgumentKind::Positive
        | ArgumentKind::Size
        | ArgumentKind::Length
        | ArgumentKind::Share
        | ArgumentKind::Number => number,
        ArgumentKind::Flag => value.is_bool(),
        ArgumentKind::Word(_) => value.is_string(),
    }
}

/// The value as one of this kind, if it is allowed.
pub(super) fn read(kind: ArgumentKind, value: &Dynamic) -> Option<Value> {
    let allowed = |of: fn(f64) -> bool| {
        let number = number(value).filter(|n| of(*n));
        number.map(Value::Number)
    };
    match kind {
        ArgumentKind::Shape => shape(value).map(Value::Shape),
        ArgumentKind::Shapes => shapes(value).map(Value::Shapes),
        ArgumentKind::Place => place(value).map(Value::Place),
        ArgumentKind::Spot => {
            place(value).filter(|p| p.z == 0.0).map(Value::Place)
        }
        ArgumentKind::Factors => factors(value).map(Value::Place),
        ArgumentKind::Axis => axis(value).map(Value::Axis),
        ArgumentKind::Plane => plane(value).map(Value::Plane),
        ArgumentKind::Points => points(value).map(Value::Points),
        ArgumentKind::Positive => allowed(|n| n > 0.0),
        ArgumentKind::Size => allowed(|n| (1e-3..=1e6).contains(&n)),
        ArgumentKind::Length => allowed(|n| n >= 0.0),
        ArgumentKind::Number => allowed(|_| true),
        ArgumentKind::Share => allowed(|n| (0.0..=1.0).contains(&n)),
        ArgumentKind::Flag => {
            let flag = value.as_bool().ok();
            flag.map(|flag| Value::Number(f64::from(u8::from(flag))))
        }
        ArgumentKind::Word(words) => {
            let given = word(value)?;
            let at = words.iter().position(|word| *word == given);
            at.map(|at| Value::Number(at as f64))
        }
    }
}

fn numbers(value: &Dynamic) -> Option<Vec<f64>> {
    components(value)?.iter().map(number).collect()
}

fn place(value: &Dynamic) -> Option<DVec3> {
    match numbers(value)?.as_slice() {
        [x, y] => Some(DVec3::new(*x, *y, 0.0)),
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        _ => None,
    }
}

fn factors(value: &Dynamic) -> Option<DVec3> {
    let factors = match numbers(value)?.as_slice() {
        [x, y] => DVec3::new(*x, *y, 1.0),
        [x, y, z] => DVec3::new(*x, *y, *z),
        _ => return None,
    };
    factors
        .to_array()
        .iter()
        .all(|f| *f != 0.0)
        .then_some(factors)
}

fn points(value: &Dynamic) -> Option<Vec<[f64; 2]>> {
    let list = value.as_array_ref().ok()?;
    let all = list.iter().map(|p| place(p).map(|p| [p.x, p.y]));
    let all: Vec<_> = all.collect::<Option<_>>()?;
    (all.len() >= 3).then_some(all)
}

fn shapes(value: &Dynamic) -> Option<Vec<Tree>> {
    match value.as_array_ref() {
        Ok(list) => list.iter().map(shape).collect(),
        Err(_) => shape(value).map(|one| vec![one]),
    }
}

fn word(value: &Dynamic) -> Option<String> {
    let text = value.clone().into_immutable_string().ok();
    let text = text.map(|text| text.to_lowercase());
    text.or_else(|| value.as_char().ok().map(|c| c.to_lowercase().to_string()))
}

fn axis(value: &Dynamic) -> Option<Axis> {
    if let Some(axis) = value.clone().try_cast::<Axis>() {
        return Some(axis);
    }
    if let Some(tree) = value.clone().try_cast::<Tree>() {
        return match &*tree {
            TreeOp::Input(Var::X) => Some(Axis::X),
            TreeOp::Input(Var::Y) => Some(Axis::Y),
            TreeOp::Input(Var::Z) => Some(Axis::Z),
            _ => None,
        };
    }
    if let Some(word) = word(value) {
        return match word.as_str() {
            "x" => Some(Axis::X),
            "y" => Some(Axis::Y),
            "z" => Some(Axis::Z),
            _ => None,
        };
    }
    let [x, y, z] = place(value)?.as_vec3().to_array();
    Axis::try_from(Vec3 { x, y, z }).ok()
}

fn plane(value: &Dynamic) -> Option<Plane> {
    if let Some(plane) = value.clone().try_cast::<Plane>() {
        return Some(plane);
    }
    match word(value).as_deref() {
        Some("xy") => Some(Plane::XY),
        Some("yz") => Some(Plane::YZ),
        Some("zx" | "xz") => Some(Plane::ZX),
        _ => axis(value).map(|axis| Plane { axis, offset: 0.0 }),
    }
}
