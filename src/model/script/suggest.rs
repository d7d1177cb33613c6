//! Suggests what was meant by a name that scripts do not have.

use super::shapes;
use crate::model::param::nearest;

/// Functions of fidget and of this program, each with a call that works.
const FUNCTIONS: &[(&str, &str)] = &[
    ("sphere", "sphere(#{center: [0, 0, 0], radius: 10})"),
    ("box", "box(#{lower: [0, 0, 0], upper: [30, 20, 10]})"),
    ("circle", "circle(#{center: [0, 0], radius: 5})"),
    ("rectangle", "rectangle([0, 0], [30, 20])"),
    ("extrude_z", "extrude_z(circle(5), 0, 20)"),
    ("loft_z", "loft_z(circle(5), circle(8), 0, 20)"),
    ("union", "union(a, b)"),
    ("intersection", "intersection(a, b)"),
    ("difference", "difference(a, b)"),
    ("inverse", "inverse(f)"),
    ("blend", "blend(a, b, 3)"),
    ("move", "f.move([10, 0, 0])"),
    ("scale", "f.scale([1, 1, 2])"),
    ("scale_uniform", "f.scale_uniform(2)"),
    (
        "rotate",
        "f.rotate(#{axis: [1, 1, 0], angle: 30, center: [0, 0, 0]})",
    ),
    ("rotate_x", "f.rotate_x(90)"),
    ("rotate_y", "f.rotate_y(90)"),
    ("rotate_z", "f.rotate_z(90)"),
    ("reflect", "f.reflect(\"yz\")"),
    ("reflect_x", "f.reflect_x(0)"),
    ("reflect_y", "f.reflect_y(0)"),
    ("reflect_z", "f.reflect_z(0)"),
    ("repeat_x", "f.repeat_x(#{radius: 5, offset: 0})"),
    ("revolve_y", "f.revolve_z()"),
    ("remap", "f.remap(x, y, z / 2)"),
    ("draw", "draw(f)"),
    ("param", "param(\"radius\", 10.0, \"radius, mm\")"),
    ("axes", "axes()"),
    ("vec2", "vec2(1, 2)"),
    ("vec3", "vec3(1, 2, 3)"),
    ("min", "min(f, g)"),
    ("max", "max(f, g)"),
    ("compare", "compare(f, g)"),
    ("abs", "abs(x)"),
    ("sqrt", "sqrt(x)"),
    ("square", "square(x)"),
    ("pow", "pow(x, 3)"),
    ("sin", "sin(x)"),
    ("cos", "cos(x)"),
    ("tan", "tan(x)"),
    ("asin", "asin(x)"),
    ("acos", "acos(x)"),
    ("atan", "atan(x)"),
    ("atan2", "atan2(y, x)"),
    ("exp", "exp(x)"),
    ("ln", "ln(x)"),
    ("floor", "floor(x)"),
    ("ceil", "ceil(x)"),
    ("round", "round(x)"),
];

/// Words of other programs, each with its equivalent here.
const WORDS: &[(&str, &str)] = &[
    (
        "cube",
        "rounded_box(#{lower: [0, 0, 0], upper: [30, 20, 10], edge: 0})",
    ),
    ("cuboid", "box(#{lower: [0, 0, 0], upper: [30, 20, 10]})"),
    ("ball", "sphere(10)"),
    ("disc", "circle(10)"),
    ("rect", "rectangle([0, 0], [30, 20])"),
    ("square2d", "rectangle([0, 0], [20, 20])"),
    ("ring", "torus(#{radius: 15, tube: 4})"),
    ("pipe", "tube(#{radius: 8, inner: 6, height: 20})"),
    ("pill", "capsule([0, 0, 0], [0, 0, 20], 5)"),
    ("plane", "half_space(#{normal: [0, 0, 1], offset: 5})"),
    ("hexagon", "prism(#{sides: 6, radius: 10, height: 5})"),
    ("hex_prism", "prism(#{sides: 6, radius: 10, height: 5})"),
    ("linear_extrude", "extrude_z(f, 0, 20)"),
    ("extrude", "extrude_z(f, 0, 20)"),
    ("rotate_extrude", "f.revolve_z()"),
    ("revolve", "f.revolve_z()"),
    ("translate", "f.move([10, 0, 0])"),
    ("mirror", "f.reflect_x(0), or f.mirror_x() for both halves"),
    ("subtract", "difference(a, b)"),
    ("subtraction", "difference(a, b)"),
    ("intersect", "intersection(a, b)"),
    ("smooth_union", "blend(a, b, 3)"),
    ("smin", "blend(a, b, 3)"),
    ("smooth_min", "blend(a, b, 3)"),
    ("smooth_intersection", "blend_intersection(a, b, 3)"),
    ("smax", "blend_intersection(a, b, 3)"),
    ("smooth_difference", "blend_difference(a, b, 3)"),
    ("smooth_subtraction", "blend_difference(a, b, 3)"),
    ("offset", "f.grow(1)"),
    ("onion", "f.shell(2)"),
    ("hull", "blend(a, b, 3), which is no hull but joins softly"),
    ("length", "sqrt(x * x + y * y)"),
    ("norm", "sqrt(x * x + y * y)"),
    ("hypot", "sqrt(x * x + y * y)"),
    ("clamp", "max(min(x, upper), lower)"),
    ("mod", "x % 10"),
    ("fmod", "x % 10"),
    ("sqr", "square(x)"),
    ("log", "ln(x)"),
    ("if_", "compare(x, 0)"),
    ("step", "(compare(x, 0) + 1) / 2"),
    ("sign", "compare(x, 0)"),
    ("fract", "x - floor(x)"),
    ("mix", "a * (1 - t) + b * t"),
    ("lerp", "a * (1 - t) + b * t"),
];

/// A call of a function of that name that works.
fn example(name: &str) -> Option<&'static str> {
    let found = FUNCTIONS.iter().find(|(known, _)| *known == name);
    found
        .map(|(_, call)| *call)
        .or_else(|| shapes::example(name))
}

/// The advice about a function that does not exist, or does not take these
/// values. `signature` is rhai's, `name (type, type)`.
pub(super) fn function(signature: &str, own: &[String]) -> String {
    let (name, types) = match signature.split_once('(') {
        Some((name, types)) => (name.trim(), types.trim_end_matches(')')),
        None => (signature, ""),
    };
    let takes = match types.trim() {
        "" => format!("{name} needs values"),
        types => format!("{name} does not take {}", plain_types(types)),
    };
    if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return format!("`{name}` does not work on {}", plain_types(types));
    }
    if let Some(call) = example(name) {
        return format!("{takes}; write for example {call}");
    }
    if own.iter().any(|n| n == name) {
        return format!("the script's {takes}");
    }
    let known = FUNCTIONS.iter().map(|(known, _)| -> &str { known });
    let known = known
        .chain(shapes::names().map(|known| -> &str { known }))
        .chain(own.iter().map(|n| &**n));
    let word = WORDS.iter().find(|(word, _)| *word == name.to_lowercase());
    let hint = match (word, nearest(name, known)) {
        (Some((_, call)), _) => format!("write {call}"),
        (None, Some(near)) => match example(near) {
            Some(call) => format!("did you mean {near}, as in {call}?"),
            None => format!("did you mean {near}?"),
        },
        _ => "docs/shapes.md lists the shapes: sphere, box, cylinder, cone, \
              torus and others"
            .to_owned(),
    };
    format!("there is no function {name}; {hint}")
}

/// The advice about a variable that does not exist.
pub(super) fn variable(name: &str, text: &str) -> String {
    let own = declared(text, &["let", "const"]);
    let known = ["x", "y", "z", "PI", "TAU", "E"];
    let known = known.into_iter().chain(own.iter().map(|n| &**n));
    let hint = match name {
        "pi" => "write PI".to_owned(),
        "tau" => "write TAU".to_owned(),
        _ if example(name).is_some() => {
            format!("{name} is a function: write {name}(…)")
        }
        _ if own.iter().any(|n| n == name) => format!(
            "it is declared elsewhere, and functions and blocks know only \
             their own variables: pass it as an argument, as in fn \
             f({name}) {{ … }}"
        ),
        _ => match nearest(name, known) {
            Some(near) => format!("did you mean {near}?"),
            None => format!(
                "x, y, z and PI are there; declare others, as in let \
                 {name} = 5;"
            ),
        },
    };
    format!("there is no variable {name}; {hint}")
}

/// Names that a script declares after one of these words.
pub(super) fn declared(text: &str, words: &[&str]) -> Vec<String> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let mut all = text.split(|c| !part(c)).filter(|word| !word.is_empty());
    let mut found = Vec::new();
    // Nobody would look through more names.
    while found.len() < 1000
        && let Some(word) = all.next()
    {
        if words.contains(&word)
            && let Some(name) = all.next()
        {
            found.push(name.to_owned());
        }
    }
    found
}

/// rhai's names of types in words.
fn plain_types(types: &str) -> String {
    let all: Vec<_> = types.split(", ").take(9).map(plain_type).collect();
    format!("({})", all.join(", "))
}

/// rhai's name of a type in words.
pub(super) fn plain_type(name: &str) -> &'static str {
    let name = name.trim();
    match name.rsplit("::").next().unwrap_or(name) {
        "i64" | "f64" | "f32" => "a number",
        "Tree" | "tree" => "a shape",
        "Vec2" => "a point such as [1, 2]",
        "Vec3" => "a point such as [1, 2, 3]",
        "array" => "an array",
        "map" => "a map",
        "bool" => "true or false",
        "string" | "char" => "text",
        "()" => "nothing",
        // The type of text in quotes has several names at once.
        other if other.contains("String") => "text",
        other if other.contains("Range") || other.contains("range") => {
            "a range"
        }
        _ => "another value",
    }
}
