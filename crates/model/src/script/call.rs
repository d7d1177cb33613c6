//! Calls of a script's functions by programs in other languages.
//!
//! In: a function's name and its arguments. Out: the shape that a script would
//! get. So a program has every shape that scripts have, with equal results and
//! equal messages, and no list of its own.

use super::bodies::Bodies;
use super::error::{ScriptError, explain};
use super::functions::add_data;
use super::limits::{GO_ON, ScriptLimits};
use super::shape::describe;
use super::{Arc, AtomicU8, Dynamic, Engine, Tree, engine};
use crate::data::Files;
use rhai::{Map, Scope};
use std::sync::LazyLock;

/// An argument of a function.
#[derive(Clone, Debug)]
pub enum Argument {
    /// A whole number.
    Whole(i64),
    /// Any number.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A text, such as the name of a file.
    Text(String),
    /// A field.
    Field(Tree),
    /// A place, or several fields or places.
    List(Vec<Argument>),
    /// Values with names. It comes last.
    Named(Vec<(String, Argument)>),
}

impl Argument {
    /// A script's number or field.
    fn of_value(value: Dynamic) -> Option<Self> {
        if let Ok(whole) = value.as_int() {
            return Some(Argument::Whole(whole));
        }
        if let Ok(number) = value.as_float() {
            return Some(Argument::Number(number));
        }
        value.try_cast::<Tree>().map(Argument::Field)
    }

    /// The argument as a script has it.
    fn into_value(self) -> Dynamic {
        match self {
            Argument::Whole(number) => number.into(),
            Argument::Number(number) => number.into(),
            Argument::Flag(flag) => flag.into(),
            Argument::Text(text) => text.into(),
            Argument::Field(tree) => Dynamic::from(tree),
            Argument::List(all) => {
                let all = all.into_iter().map(Argument::into_value);
                Dynamic::from_array(all.collect())
            }
            Argument::Named(all) => {
                let one = |(name, value): (String, Argument)| {
                    (name.into(), value.into_value())
                };
                let all: Map = all.into_iter().map(one).collect();
                Dynamic::from_map(all)
            }
        }
    }
}

/// The data of programs' expressions. It stays as long as the program runs,
/// since nobody knows what a program still holds.
static FILES: LazyLock<Arc<Files>> =
    LazyLock::new(|| Arc::new(Files::anywhere()));

/// Calls a function of docs/shapes.md, docs/textures.md, docs/functions.md or
/// docs/data.md. A relative name is one of a file in the current folder, and any
/// file may be read. The result is a field or a number.
///
/// ```
/// use isoslice_model::{Argument, call};
///
/// let ball = call("sphere", vec![Argument::Number(5.0)])?;
/// let far = vec![Argument::Whole(20), Argument::Whole(0), Argument::Whole(0)];
/// call("move", vec![ball, Argument::List(far)])?;
/// # Ok::<(), isoslice_model::ScriptError>(())
/// ```
///
/// # Errors
/// If there is no such function, or it does not take these arguments, in the
/// words that a script's author reads, but without a line.
pub fn call(
    name: &str,
    arguments: Vec<Argument>,
) -> Result<Argument, ScriptError> {
    thread_local! {
        /// Making one takes as long as many calls.
        static ENGINE: Engine = {
            let bodies = Bodies::default();
            let mut engine = engine(
                ScriptLimits::default().operations,
                &Arc::new(AtomicU8::new(GO_ON)),
                &bodies,
            );
            add_data(&mut engine, &FILES, &bodies);
            engine
        };
    }
    let failed = |message| ScriptError::Failed {
        line: None,
        column: None,
        message,
    };
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if name.is_empty() || !name.chars().all(letter) {
        return Err(failed(format!("{name:?} is no name of a function")));
    }
    let names: Vec<String> =
        (0..arguments.len()).map(|i| format!("a{i}")).collect();
    let mut scope = Scope::new();
    for (name, argument) in names.iter().zip(arguments) {
        scope.push_dynamic(name.as_str(), argument.into_value());
    }
    // As a method, a word of the language such as `move` is a name.
    let text = match names.split_first() {
        Some((first, others)) => {
            format!("{first}.{name}({})", others.join(", "))
        }
        None => format!("{name}()"),
    };
    let result = ENGINE
        .with(|engine| engine.eval_with_scope::<Dynamic>(&mut scope, &text));
    match result {
        Ok(value) => {
            let found = describe(&value);
            Argument::of_value(value).ok_or_else(|| {
                failed(format!("{name} makes {found}, and no shape"))
            })
        }
        Err(error) => {
            let limits = ScriptLimits::default();
            Err(match explain(&error, None, &limits, &text) {
                ScriptError::Failed { message, .. } => failed(message),
                other => other,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Context;

    fn value(made: &Argument, x: f32, y: f32, z: f32) -> f32 {
        let Argument::Field(tree) = made else {
            panic!("{made:?} is no field");
        };
        let mut context = Context::new();
        let node = context.import(tree);
        context.eval_xyz(node, x, y, z).unwrap()
    }

    #[test]
    fn a_call_makes_what_a_script_makes() {
        let radius = vec![("radius".to_owned(), Argument::Number(2.5))];
        let ball = call("sphere", vec![Argument::Named(radius)]).unwrap();
        assert_eq!(value(&ball, 4.0, 0.0, 0.0), 1.5);
        let at = [10, 0, 0].map(Argument::Whole).to_vec();
        let moved = call("move", vec![ball, Argument::List(at)]);
        assert_eq!(value(&moved.unwrap(), 4.0, 0.0, 0.0), 3.5);
        let cube = vec![Argument::Field(Tree::x()), Argument::Whole(3)];
        assert_eq!(value(&call("pow", cube).unwrap(), -2.0, 0.0, 0.0), -8.0);
        let half = call("fract", vec![Argument::Number(2.5)]).unwrap();
        assert!(matches!(half, Argument::Number(0.5)), "{half:?}");
        let about = vec![
            Argument::Field(Tree::x()),
            Argument::Number(1.0),
            call("checker", Vec::new()).unwrap(),
            Argument::Named(vec![
                ("projection".to_owned(), Argument::Text("z".to_owned())),
                ("inward".to_owned(), Argument::Flag(true)),
            ]),
        ];
        let deep = call("textured", about).unwrap();
        assert_eq!(value(&deep, -2.0, 2.0, 0.0), -2.0);
        assert_eq!(value(&deep, 2.0, 2.0, 0.0), 3.0);
        let two = call("floor", vec![Argument::Number(2.5)]).unwrap();
        assert!(matches!(two, Argument::Whole(2)), "{two:?}");
    }

    #[test]
    fn mistakes_are_explained_without_a_line() {
        let message = |name: &str, arguments: Vec<Argument>| {
            call(name, arguments).unwrap_err().to_string()
        };
        let flat = message("cone", vec![Argument::Number(-1.0)]);
        assert!(flat.starts_with("cone: "), "{flat}");
        let unknown = message("sphare", vec![Argument::Number(1.0)]);
        assert!(unknown.contains("sphere"), "{unknown}");
        let text = message("1 + x; draw", Vec::new());
        assert!(text.contains("is no name"), "{text}");
        let missing = message("cylinder", Vec::new());
        assert!(missing.contains("cylinder"), "{missing}");
    }
}
