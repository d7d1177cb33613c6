//! Suggests what was meant by a name that scripts do not have.

use super::limits::MOST_VALUES;
use super::shapes;
use crate::functions;
use crate::param::nearest;
use isoslice_base::pairs;

/// Functions of scripts alone, each with a call that works.
const FUNCTIONS: &[(&str, &str)] = &[
    ("remap", "f.remap(x, y, z / 2)"),
    ("draw", "draw(f)"),
    ("param", "param(\"radius\", 10.0, \"radius, mm\")"),
    ("axes", "axes()"),
    ("vec2", "vec2(1, 2)"),
    ("vec3", "vec3(1, 2, 3)"),
];

/// Words of other programs, each with its equivalent here.
const WORDS: &[(&str, &str)] = pairs! {
    "cube" => "rounded_box(#{lower: [0, 0, 0], upper: [30, 20, 10], edge: 0})";
    "cuboid" => "box(#{lower: [0, 0, 0], upper: [30, 20, 10]})";
    "ball" => "sphere(10)";
    "disc" => "circle(10)";
    "rect" => "rectangle([0, 0], [30, 20])";
    "square2d" => "rectangle([0, 0], [20, 20])";
    "ring" => "torus(#{radius: 15, tube: 4})";
    "pipe" => "tube(#{radius: 8, inner: 6, height: 20})";
    "pill" => "capsule([0, 0, 0], [0, 0, 20], 5)";
    "plane" => "half_space(#{normal: [0, 0, 1], offset: 5})";
    "hexagon", "hex_prism" => "prism(#{sides: 6, radius: 10, height: 5})";
    "linear_extrude", "extrude" => "extrude_z(f, 0, 20)";
    "rotate_extrude", "revolve" => "f.revolve_z()";
    "translate" => "f.move([10, 0, 0])";
    "mirror" => "f.reflect_x(0), or f.mirror_x() for both halves";
    "subtract", "subtraction" => "difference(a, b)";
    "intersect" => "intersection(a, b)";
    "smooth_union", "smin", "smooth_min" => "blend(a, b, 3)";
    "smooth_intersection", "smax" => "blend_intersection(a, b, 3)";
    "smooth_difference", "smooth_subtraction" => "blend_difference(a, b, 3)";
    "offset" => "f.grow(1)";
    "onion" => "f.shell(2)";
    "hull" => "blend(a, b, 3), which is no hull but joins softly";
    "norm" => "length(x, y)";
    "fmod", "rem" => "x % 10";
    "sqr", "sq" => "square(x)";
    "power" => "x ** 3";
    "lerp" => "mix(a, b, t)";
    "saturate" => "clamp(x, 0, 1)";
    "if_", "heaviside" => "step(0, x)";
    "frac" => "fract(x)";
    "ceiling" => "ceil(x)";
    "arcsin" => "asin(x)";
    "arccos" => "acos(x)";
    "arctan" => "atan(x)";
    "arctan2" => "atan2(y, x)";
};

/// A call of a function of that name that works.
fn example(name: &str) -> Option<&'static str> {
    let found = FUNCTIONS.iter().find(|(known, _)| *known == name);
    found
        .map(|(_, call)| *call)
        .or_else(|| shapes::example(name))
        .or_else(|| functions::function(name).map(|f| f.example))
}

/// A call of a function that takes any number of values, with an array of them.
fn of_array(name: &str) -> Option<String> {
    let named = functions::function(name).filter(|f| f.takes.1 > MOST_VALUES);
    let named = named.map(|_| format!("{name}([f, g])"));
    named.or_else(|| shapes::of_array(name))
}

/// The names of all functions.
fn names() -> impl Iterator<Item = &'static str> {
    let own = FUNCTIONS.iter().map(|(name, _)| *name);
    let named = functions::FUNCTIONS.iter().map(|f| f.name);
    own.chain(shapes::names()).chain(named)
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
    let count = types.split(", ").count();
    if let Some(call) = of_array(name).filter(|_| count > MOST_VALUES) {
        return format!(
            "{name} takes {MOST_VALUES} values at most at once, and {count} are \
             given; write an array, as in {call}"
        );
    }
    if let Some(call) = example(name) {
        return format!("{takes}; write for example {call}");
    }
    if own.iter().any(|n| n == name) {
        return format!("the script's {takes}");
    }
    let known = names().map(|known| -> &str { known });
    let known = known.chain(own.iter().map(|n| &**n));
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
    let known = ["x", "y", "z", "pi", "tau", "PI", "TAU"];
    let known = known.into_iter().chain(own.iter().map(|n| &**n));
    let hint = match name {
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
                "x, y, z and pi are there; declare others, as in let \
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

/// True if a text that is no script may be one for OpenSCAD.
pub(super) fn looks_like_openscad(text: &str) -> bool {
    /// What only OpenSCAD has, without blanks.
    const PARTS: &[&str] = &[
        "union(){",
        "difference(){",
        "intersection(){",
        "hull(){",
        "minkowski(){",
        "$fn",
        "$fa",
        "$fs",
        "sphere(r=",
        "sphere(d=",
        "circle(r=",
        "circle(d=",
        "cylinder(r=",
        "cylinder(d=",
        "cylinder(h=",
        "linear_extrude(height=",
        ",center=true",
    ];
    /// What only OpenSCAD has on one line, without blanks. On two lines a script
    /// has it that lacks a semicolon.
    const IN_LINE: &[&str] = &[
        ")cube(",
        ")sphere(",
        ")cylinder(",
        ")circle(",
        ")square(",
        ")polygon(",
        ")translate(",
        ")rotate(",
        ")linear_extrude(",
    ];
    // Nobody would read more of it.
    const MOST_BYTES_READ: usize = 100_000;
    let text = text.chars().take(MOST_BYTES_READ).collect::<String>();
    let without_blanks = |text: &str| -> String {
        text.chars().filter(|c| !c.is_whitespace()).collect()
    };
    let in_line = text.lines().any(|line| {
        let start = line.trim_start();
        let dense = without_blanks(line);
        start.starts_with("module ")
            || start.starts_with("use <")
            || IN_LINE.iter().any(|part| dense.contains(part))
    });
    let dense = without_blanks(&text);
    in_line
        || PARTS.iter().any(|part| dense.contains(part))
        || dense.split("for(").skip(1).any(counts)
}

/// True if what follows a loop's bracket is OpenSCAD's way to count: `i=[0:5])`.
fn counts(rest: &str) -> bool {
    let name = |c: char| c.is_alphanumeric() || c == '_';
    let after = rest.trim_start_matches(name);
    after.len() < rest.len() && after.starts_with("=[")
}
