//! Models as rhai scripts, run where they can do nothing but describe a shape.
//!
//! In: the text of a script and the `-D` definitions. Out: an expression tree
//! and the script's parameters.
//!
//! The engine is fidget's, with all its shapes and transforms, and four
//! additions: `param`, `draw`, the power operator `**` (also `pow`), and
//! limits. The model is the union of what is passed to `draw`; without a
//! `draw`, the script's last value.
//!
//! `^` is not a power here: rhai binds it weaker than `+`, so `2*x^2` would
//! silently be (2x)². It is an error that says to write `**`. (rhai's `**`
//! binds weaker than a sign before it: `-x ** 2` is (-x)², write `-(x ** 2)`.)
//!
//! Guarantees, for any script: no file, network, environment or clock; no
//! `import` and no `eval`; operations, time, call depth, nesting and the sizes
//! of strings, arrays and maps are bounded; where the system tells it, memory
//! as well. The script runs on a thread of its own with a stack that its
//! bounded depth cannot exhaust.
//!
//! Not guaranteed: a script that is within a single long operation when its
//! time is up (or not even parsed) is not waited for, but its thread goes on
//! until that is done; so does what the operation takes of memory.

use super::param::{ParamError, Parameter, Table, Value};
use super::power::{power, power_of};
use crate::limits::{check, doing, resident_bytes};
use fidget::context::Tree;
use rhai::{
    Dynamic, Engine, EvalAltResult, ImmutableString, NativeCallContext,
    Position,
};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Bounds on what a script may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScriptLimits {
    /// Steps of the interpreter. Default: 10⁷; a lattice of 10,000 struts
    /// needs some 10⁶.
    pub operations: u64,
    /// Wall time. Default: 20 s, some ten times what the operations take.
    pub time: Duration,
    /// Growth of the process's memory while the script runs, where the
    /// system tells it. Other threads of the process count as well. Default: 192 MiB.
    pub memory_bytes: u64,
}

impl Default for ScriptLimits {
    fn default() -> Self {
        Self {
            operations: 10_000_000,
            time: Duration::from_secs(20),
            memory_bytes: 192 << 20,
        }
    }
}

/// Elements of an array, all levels together.
const MAX_ARRAY: usize = 50_000;
/// Entries of an object map, all levels together.
const MAX_MAP: usize = 20_000;
/// Bytes of a string.
const MAX_STRING: usize = 1 << 20;
/// Variables at one time in one function.
const MAX_VARIABLES: usize = 1000;
/// Functions of a script.
const MAX_FUNCTIONS: usize = 1000;
/// Calls inside each other.
const MAX_CALLS: usize = 100;
/// Nesting of expressions, outside and inside of functions.
const MAX_DEPTH: (usize, usize) = (200, 100);
/// Stack of the script's thread: reserved, not used, unless a script nests to
/// the limits (arrays of arrays are freed recursively: `MAX_ARRAY` levels).
const STACK_BYTES: usize = 512 << 20;

/// Why a script gives no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScriptError {
    /// rhai's own errors, and those of functions called.
    #[error("{}{message}", place(*.line, *.column))]
    Failed {
        /// Line from 1, if known.
        line: Option<usize>,
        /// Column from 1, if known.
        column: Option<usize>,
        /// What went wrong.
        message: String,
    },
    /// A limit was reached.
    #[error("{}the script {what}", place(*.line, None))]
    Limit {
        /// Line from 1, if known.
        line: Option<usize>,
        /// Which limit, and the remedy.
        what: String,
    },
    /// The script ran, but made no shape.
    #[error(
        "the script gives no model: its last value is {found} and it never \
         calls draw(); end it with an expression of x, y, z (without a `;` \
         after it), such as `sphere(10)`, or pass the shape to draw(shape)"
    )]
    NoModel {
        /// What the last value is.
        found: String,
    },
    /// A parameter is wrong.
    #[error("{}{error}", place(*.line, None))]
    Param {
        /// Line from 1, if it is the script's call that failed.
        line: Option<usize>,
        /// What is wrong.
        error: ParamError,
    },
    /// The interpreter itself broke.
    #[error(
        "the script made the interpreter fail ({message}); this is a bug: \
         please report it with the script"
    )]
    Bug {
        /// What is known.
        message: String,
    },
}

fn place(line: Option<usize>, column: Option<usize>) -> String {
    match (line, column) {
        (Some(l), Some(c)) => format!("line {l}, column {c}: "),
        (Some(l), None) => format!("line {l}: "),
        _ => String::new(),
    }
}

/// What a script describes.
#[derive(Debug)]
pub(super) struct Script {
    pub tree: Tree,
    pub parameters: Vec<Parameter>,
}

/// Runs a script.
pub(super) fn run_script(
    text: &str,
    defines: &[(String, String)],
    limits: &ScriptLimits,
) -> Result<Script, ScriptError> {
    let bug = |message: &str| ScriptError::Bug {
        message: message.to_owned(),
    };
    let stop = Arc::new(AtomicU8::new(GO_ON));
    let (sender, receiver) = channel();
    let work = {
        let (text, defines) = (text.to_owned(), defines.to_vec());
        let (limits, stop) = (*limits, stop.clone());
        move || {
            let result = run_here(&text, &defines, &limits, &stop);
            // Nobody listens any more if it took too long.
            let _ = sender.send(result);
        }
    };
    // Before the thread, whose stack is part of what it takes.
    let before = resident_bytes();
    std::thread::Builder::new()
        .name("script".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(work)
        .map_err(|e| bug(&format!("no thread: {e}")))?;
    /// Stops the script also if this thread is stopped.
    struct Leave<'a>(&'a AtomicU8);
    impl Drop for Leave<'_> {
        fn drop(&mut self) {
            self.0.store(Stop::Time.number(), Ordering::Relaxed);
        }
    }
    let _leave = Leave(&stop);
    let start = Instant::now();
    let mut stopped: Option<(Stop, Instant)> = None;
    doing("script", || {
        loop {
            match receiver.recv_timeout(EVERY) {
                Ok(result) => return result,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(bug("it panicked"));
                }
                Err(RecvTimeoutError::Timeout) => check(),
            }
            if let Some((why, since)) = stopped {
                if since.elapsed() > GRACE {
                    return Err(ScriptError::Limit {
                        line: None,
                        what: why.describe(limits),
                    });
                }
                continue;
            }
            let grown =
                |before| resident_bytes().map(|now| now.saturating_sub(before));
            let why = if start.elapsed() > limits.time {
                Stop::Time
            } else if before
                .and_then(grown)
                .is_some_and(|grown| grown > limits.memory_bytes)
            {
                Stop::Memory
            } else {
                continue;
            };
            stop.store(why.number(), Ordering::Relaxed);
            stopped = Some((why, Instant::now()));
        }
    })
}

/// Time between looks at the clock and the memory: some MB at the rate at
/// which a script can fill them.
const EVERY: Duration = Duration::from_millis(2);

/// Time that a script has to notice that it was stopped. One that is within a
/// single long operation then, or still being parsed, is left to itself: its
/// thread ends when that is done.
const GRACE: Duration = Duration::from_secs(1);

/// What a script hands out while it runs.
#[derive(Default)]
struct Shared {
    drawn: Vec<Tree>,
    parameters: Table,
    error: Option<ParamError>,
}

/// Why a script was stopped.
#[derive(Clone, Copy)]
enum Stop {
    Operations,
    Time,
    Memory,
}

/// What the flag holds while there is no reason to stop.
const GO_ON: u8 = 0;

impl Stop {
    /// As the flag holds it.
    fn number(self) -> u8 {
        match self {
            Stop::Operations => 1,
            Stop::Time => 2,
            Stop::Memory => 3,
        }
    }

    fn from_number(number: u8) -> Option<Stop> {
        let all = [Stop::Operations, Stop::Time, Stop::Memory];
        all.into_iter().find(|stop| stop.number() == number)
    }

    /// What happened, and the remedy.
    fn describe(self, limits: &ScriptLimits) -> String {
        match self {
            Stop::Time => format!(
                "ran longer than {} s and was stopped; build fewer parts in \
                 loops",
                limits.time.as_secs_f64()
            ),
            Stop::Memory => format!(
                "took more than {} MB of memory and was stopped; build fewer \
                 parts in loops",
                limits.memory_bytes >> 20
            ),
            Stop::Operations => format!(
                "took more than {} steps and was stopped; is there a loop \
                 that never ends? Repeat parts with `%` (modulo) of a \
                 coordinate instead of loops",
                limits.operations
            ),
        }
    }
}

fn run_here(
    text: &str,
    defines: &[(String, String)],
    limits: &ScriptLimits,
    stop: &Arc<AtomicU8>,
) -> Result<Script, ScriptError> {
    let shared = Arc::new(Mutex::new(Shared {
        parameters: Table::new(defines),
        ..Shared::default()
    }));
    let mut engine = fidget::rhai::engine();
    add_limits(&mut engine, limits.operations, stop.clone());
    add_replace(&mut engine);
    add_powers(&mut engine);
    add_draw(&mut engine, &shared);
    add_param(&mut engine, &shared);

    let result = engine.eval::<Dynamic>(text);
    let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
    let last = match result {
        Ok(value) => value,
        Err(error) => {
            return Err(explain(&error, state.error.take(), limits));
        }
    };
    let drawn = std::mem::take(&mut state.drawn);
    // An unknown -D explains a missing model better than the reverse.
    let parameters = std::mem::take(&mut state.parameters)
        .finish()
        .map_err(|error| ScriptError::Param { line: None, error })?;
    let tree = match union(drawn) {
        Some(tree) => tree,
        None => shape(&last).ok_or_else(|| ScriptError::NoModel {
            found: describe(&last),
        })?,
    };
    Ok(Script { tree, parameters })
}

/// The smallest of all fields, as a balanced tree: a chain of 10,000 bodies
/// would make a deep one.
fn union(mut trees: Vec<Tree>) -> Option<Tree> {
    while trees.len() > 1 {
        trees = trees
            .chunks(2)
            .map(|pair| match pair {
                [a, b] => a.min(b.clone()),
                _ => pair[0].clone(),
            })
            .collect();
    }
    trees.pop()
}

/// A shape, or the union of an array of shapes.
fn shape(value: &Dynamic) -> Option<Tree> {
    if let Some(tree) = value.clone().try_cast::<Tree>() {
        return Some(tree);
    }
    let mut trees = Vec::new();
    // A stack of its own: arrays may nest to any depth.
    let mut todo = vec![value.clone()];
    while let Some(value) = todo.pop() {
        if let Some(tree) = value.clone().try_cast::<Tree>() {
            trees.push(tree);
        } else {
            todo.extend(value.try_cast::<rhai::Array>()?.into_iter().rev());
        }
    }
    union(trees)
}

/// A value as the user knows it.
fn describe(value: &Dynamic) -> String {
    if value.is_unit() {
        "nothing".to_owned()
    } else if let Ok(v) = value.as_int() {
        format!("the number {v}")
    } else if let Ok(v) = value.as_float() {
        format!("the number {v}")
    } else if value.is_array() {
        "an array that does not hold shapes only".to_owned()
    } else {
        format!("a {}", value.type_name())
    }
}

fn add_limits(engine: &mut Engine, most: u64, stop: Arc<AtomicU8>) {
    engine
        .set_max_array_size(MAX_ARRAY)
        .set_max_map_size(MAX_MAP)
        .set_max_string_size(MAX_STRING)
        .set_max_variables(MAX_VARIABLES)
        .set_max_functions(MAX_FUNCTIONS)
        .set_max_call_levels(MAX_CALLS)
        .set_max_expr_depths(MAX_DEPTH.0, MAX_DEPTH.1)
        .set_max_modules(0)
        .set_module_resolver(rhai::module_resolvers::DummyModuleResolver::new())
        .disable_symbol("eval")
        .disable_symbol("import")
        .on_print(|_| {})
        .on_debug(|_, _, _| {});

    engine.on_progress(move |operations| {
        let why = match operations > most {
            true => Some(Stop::Operations),
            false => Stop::from_number(stop.load(Ordering::Relaxed)),
        };
        why.map(Dynamic::from)
    });

    // rhai calls these from its standard library; ours come first.
    const NO_CLOCK: &str = "models have no access to the clock: the same \
                            script must always give the same part";
    engine.register_fn("timestamp", || -> Outcome<()> { Err(NO_CLOCK.into()) });
    engine
        .register_fn("sleep", |_: i64| -> Outcome<()> { Err(NO_CLOCK.into()) });
    engine
        .register_fn("sleep", |_: f64| -> Outcome<()> { Err(NO_CLOCK.into()) });
}

/// rhai's own looks at the length only afterwards, and a text of a million
/// letters with each replaced by a million more does not fit any machine.
fn add_replace(engine: &mut Engine) {
    fn replaced(
        text: &mut ImmutableString,
        find: &str,
        by: &str,
    ) -> Outcome<()> {
        let count = text.matches(find).count();
        let most = text.len().saturating_add(count.saturating_mul(by.len()));
        if most > 2 * MAX_STRING {
            return Err(EvalAltResult::ErrorDataTooLarge(
                "Length of string".to_owned(),
                Position::NONE,
            )
            .into());
        }
        *text = text.replace(find, by).into();
        Ok(())
    }
    type Text = ImmutableString;
    engine
        .register_fn("replace", |text: &mut Text, find: Text, by: Text| {
            replaced(text, &find, &by)
        })
        .register_fn("replace", |text: &mut Text, find: Text, by: char| {
            replaced(text, &find, &by.to_string())
        })
        .register_fn("replace", |text: &mut Text, find: char, by: Text| {
            replaced(text, &find.to_string(), &by)
        })
        .register_fn("replace", |text: &mut Text, find: char, by: char| {
            replaced(text, &find.to_string(), &by.to_string())
        });
}

type Outcome<T> = Result<T, Box<EvalAltResult>>;

fn add_powers(engine: &mut Engine) {
    for name in ["**", "pow"] {
        engine
            .register_fn(name, |a: Tree, b: i64| power(&a, b as f64))
            .register_fn(name, |a: Tree, b: f64| power(&a, b))
            .register_fn(name, |a: Tree, b: Tree| power_of(&a, &b))
            .register_fn(name, |a: f64, b: Tree| {
                power_of(&Tree::constant(a as f32), &b)
            })
            .register_fn(name, |a: i64, b: Tree| {
                power_of(&Tree::constant(a as f32), &b)
            });
    }
    const NOT_A_POWER: &str = "`^` is not a power in scripts (it would bind \
                               weaker than `+`): write x ** 2 or square(x)";
    engine
        .register_fn("^", |_: Tree, _: i64| -> Outcome<Tree> {
            Err(NOT_A_POWER.into())
        })
        .register_fn("^", |_: Tree, _: f64| -> Outcome<Tree> {
            Err(NOT_A_POWER.into())
        })
        .register_fn("^", |_: Tree, _: Tree| -> Outcome<Tree> {
            Err(NOT_A_POWER.into())
        })
        .register_fn("^", |_: f64, _: Tree| -> Outcome<Tree> {
            Err(NOT_A_POWER.into())
        })
        .register_fn("^", |_: i64, _: Tree| -> Outcome<Tree> {
            Err(NOT_A_POWER.into())
        });
}

fn add_draw(engine: &mut Engine, shared: &Arc<Mutex<Shared>>) {
    /// Shapes drawn at most: keeps a `draw` in an endless loop small.
    const MAX_DRAWN: usize = 100_000;
    let shared = shared.clone();
    engine.register_fn("draw", move |value: Dynamic| -> Outcome<()> {
        let Some(tree) = shape(&value) else {
            return Err(format!(
                "draw() takes a shape or an array of shapes, not {}",
                describe(&value)
            )
            .into());
        };
        let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
        if state.drawn.len() >= MAX_DRAWN {
            return Err(format!(
                "draw() was called more than {MAX_DRAWN} times"
            )
            .into());
        }
        state.drawn.push(tree);
        Ok(())
    });
}

fn add_param(engine: &mut Engine, shared: &Arc<Mutex<Shared>>) {
    let declare = {
        let shared = shared.clone();
        move |name: &str, default: &Dynamic, text: &str| -> Outcome<Dynamic> {
            let value = if let Ok(v) = default.as_int() {
                Value::Int(v)
            } else if let Ok(v) = default.as_float() {
                Value::Float(v)
            } else if let Ok(v) = default.as_bool() {
                Value::Bool(v)
            } else {
                return Err(format!(
                    "the default of the parameter `{name}` must be a number, \
                     true or false, not {}",
                    describe(default)
                )
                .into());
            };
            let mut state =
                shared.lock().unwrap_or_else(PoisonError::into_inner);
            match state.parameters.declare(name, value, text) {
                Ok(Value::Int(v)) => Ok(v.into()),
                Ok(Value::Float(v)) => Ok(v.into()),
                Ok(Value::Bool(v)) => Ok(v.into()),
                Err(error) => {
                    let message = error.to_string();
                    state.error = Some(error);
                    Err(message.into())
                }
            }
        }
    };
    let with_text = declare.clone();
    engine.register_fn(
        "param",
        move |name: ImmutableString, default: Dynamic| {
            declare(&name, &default, "")
        },
    );
    engine.register_fn(
        "param",
        move |name: ImmutableString,
              default: Dynamic,
              text: ImmutableString| {
            with_text(&name, &default, &text)
        },
    );
    // The likeliest mistakes with these two, said plainly.
    engine.register_fn(
        "param",
        |_: NativeCallContext, _: ImmutableString| -> Outcome<Dynamic> {
            Err("param() needs a default: param(\"name\", 10.0, \
                 \"description\")"
                .into())
        },
    );
}

/// Turns rhai's error into ours.
fn explain(
    error: &EvalAltResult,
    parameter: Option<ParamError>,
    limits: &ScriptLimits,
) -> ScriptError {
    let innermost = unwrapped(error);
    let position = innermost.position();
    let position = if position.is_none() {
        error.position()
    } else {
        position
    };
    let line = position.line();
    if let Some(error) = parameter {
        return ScriptError::Param { line, error };
    }
    let limit = |what: String| ScriptError::Limit { line, what };
    match innermost {
        EvalAltResult::ErrorTerminated(token, _) => {
            let why = token.clone().try_cast::<Stop>();
            limit(why.unwrap_or(Stop::Operations).describe(limits))
        }
        EvalAltResult::ErrorDataTooLarge(what, _) => limit(format!(
            "made something too large ({what}); at most {MAX_ARRAY} array \
             elements, {MAX_MAP} map entries and {MAX_STRING} bytes of text"
        )),
        EvalAltResult::ErrorStackOverflow(_) => limit(format!(
            "calls functions more than {MAX_CALLS} deep; use a loop instead \
             of recursion"
        )),
        EvalAltResult::ErrorTooManyModules(_)
        | EvalAltResult::ErrorModuleNotFound(..) => ScriptError::Failed {
            line,
            column: position.position(),
            message: "models cannot import other files; copy the functions \
                      into the script"
                .to_owned(),
        },
        EvalAltResult::ErrorRuntime(value, _) => ScriptError::Failed {
            line,
            column: position.position(),
            message: shortened(value.to_string()),
        },
        other => {
            let mut plain = rhai_message(other);
            for (symbol, remedy) in [
                ("'import'", "; models cannot import other files"),
                ("'eval'", "; models cannot run text as code"),
            ] {
                if plain.contains(symbol) {
                    plain.push_str(remedy);
                }
            }
            ScriptError::Failed {
                line,
                column: position.position(),
                message: shortened(plain),
            }
        }
    }
}

/// No longer than people read: it may quote a text of a million letters.
fn shortened(mut message: String) -> String {
    const LONGEST: usize = 400;
    if let Some((end, _)) = message.char_indices().nth(LONGEST) {
        message.truncate(end);
        message.push('…');
    }
    message
}

/// The error inside of function-call wrappers.
fn unwrapped(mut error: &EvalAltResult) -> &EvalAltResult {
    while let EvalAltResult::ErrorInFunctionCall(_, _, inner, _) = error {
        error = inner;
    }
    error
}

/// rhai's message without its position, which we print in front.
fn rhai_message(error: &EvalAltResult) -> String {
    let text = error.to_string();
    let position = error.position();
    if position == Position::NONE {
        return text;
    }
    match text.strip_suffix(&format!(" ({position})")) {
        Some(bare) => bare.to_owned(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Context;

    /// Without the memory limit: other tests' memory would count.
    fn run(text: &str) -> Result<Script, ScriptError> {
        let limits = ScriptLimits {
            memory_bytes: u64::MAX,
            ..ScriptLimits::default()
        };
        run_script(text, &[], &limits)
    }

    fn value(text: &str, x: f32, y: f32, z: f32) -> f32 {
        let mut context = Context::new();
        let node = context.import(&run(text).unwrap().tree);
        context.eval_xyz(node, x, y, z).unwrap()
    }

    fn error(text: &str) -> String {
        run(text).unwrap_err().to_string()
    }

    #[test]
    fn the_model_is_the_last_value_or_what_is_drawn() {
        assert_eq!(value("sqrt(x*x + y*y) - 2", 3.0, 4.0, 0.0), 3.0);
        assert_eq!(value("draw(x); y", 3.0, 4.0, 0.0), 3.0);
        assert_eq!(value("draw(x); draw([y, z]); 7", 3.0, 4.0, 1.0), 1.0);
        assert_eq!(value("[x, [y, [z]]]", 3.0, 4.0, 1.0), 1.0);
        assert_eq!(value("sphere([0, 0, 0], 2)", 3.0, 0.0, 0.0), 1.0);
        assert_eq!(
            value("fn f(r) { sphere(r) } f(2).move([1, 0, 0])", 3.0, 0.0, 0.0),
            0.0
        );
    }

    #[test]
    fn without_a_shape_the_error_says_how_to_make_one() {
        for (text, found) in [
            ("", "nothing"),
            ("let a = sphere(2);", "nothing"),
            ("7", "the number 7"),
            ("7.5", "the number 7.5"),
            ("[]", "array"),
            ("[x, 1]", "array"),
            ("\"x\"", "a string"),
        ] {
            let e = error(text);
            assert!(e.contains("draw("), "{e}");
            assert!(e.contains(found), "{text}: {e}");
        }
        assert!(error("draw(3)").contains("not the number 3"));
    }

    #[test]
    fn powers() {
        assert_eq!(value("x ** 2", 3.0, 0.0, 0.0), 9.0);
        assert_eq!(value("2 * x ** 2", 3.0, 0.0, 0.0), 18.0);
        assert_eq!(value("x ** 0.5", 9.0, 0.0, 0.0), 3.0);
        assert_eq!(value("x.pow(3)", 2.0, 0.0, 0.0), 8.0);
        assert!((value("2.0 ** x", 3.0, 0.0, 0.0) - 8.0).abs() < 1e-5);
        assert_eq!(value("x + 2 ** 3", 1.0, 0.0, 0.0), 9.0);
        // rhai's rule, which the module's header warns of.
        assert_eq!(value("-x ** 2", 3.0, 0.0, 0.0), 9.0);
        assert!(error("x^2").contains("x ** 2"));
        assert!(error("x + 2*y^2.0").contains("x ** 2"));
        // No panic, no endless product.
        run("x ** -9223372036854775808").unwrap();
    }

    #[test]
    fn errors_have_their_line() {
        let e = error("let a = 1;\nlet b = foo(a);\nx");
        assert!(e.starts_with("line 2, column 9: "), "{e}");
        assert!(!e.ends_with(')') || !e.contains("(line"), "{e}");
        let e = error("let a = 1;\nlet b = ;\nx");
        assert!(e.starts_with("line 2, column 9: "), "{e}");
        let e = error("fn f() { throw \"no\" }\nf()");
        assert!(e.contains("no"), "{e}");
        assert!(error("x < 1").contains("compare"));
    }

    #[test]
    fn parameters_are_set_and_listed() {
        let text = "let cell = param(\"cell\", 10.0, \"cell, mm\");
                    let n = param(\"n\", 3);
                    let open = param(\"open\", true);
                    if open { x * cell * n } else { y }";
        let set = |d: &[(&str, &str)]| {
            let d: Vec<_> = d
                .iter()
                .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
                .collect();
            run_script(text, &d, &ScriptLimits::default())
        };
        let all = set(&[("cell", "8")]).unwrap().parameters;
        assert_eq!(all.len(), 3);
        assert_eq!(all[0].default, "10.0");
        assert_eq!(all[0].value, "8.0");
        assert_eq!(all[0].description, "cell, mm");
        assert_eq!(all[1].value, "3");
        let e = set(&[("n", "2.5")]).unwrap_err().to_string();
        assert!(e.starts_with("line 2: -D n=2.5"), "{e}");
        let e = set(&[("cel", "1")]).unwrap_err().to_string();
        assert!(e.contains("did you mean `cell`"), "{e}");
        assert!(e.contains("cell, n, open"), "{e}");
        let e = error("param(\"a\", \"text\")");
        assert!(e.contains("must be a number"), "{e}");
        let e = error("param(\"a\")");
        assert!(e.contains("needs a default"), "{e}");
        let e = error("param(\"a\", 1) + param(\"a\", 2)");
        assert!(e.contains("declared twice"), "{e}");
    }

    #[test]
    fn scripts_reach_nothing_outside() {
        for (text, words) in [
            ("import \"a\" as a; x", "import"),
            ("eval(\"x\")", "eval"),
            ("sleep(100); x", "clock"),
            ("sleep(100.0); x", "clock"),
            ("timestamp(); x", "clock"),
            ("open_file(\"/etc/passwd\")", "open_file"),
        ] {
            let e = error(text);
            assert!(e.contains(words), "{text}: {e}");
        }
        // Printing is allowed, and goes nowhere.
        run("print(\"a\"); debug(\"b\"); x").unwrap();
    }

    #[test]
    fn endless_scripts_are_stopped() {
        let limits = ScriptLimits {
            operations: 200_000,
            ..ScriptLimits::default()
        };
        for text in [
            "loop {}",
            "let a = 0; while true { a += 1; } x",
            "let t = x; loop { t = t + 1; }",
            "fn f(n) { for i in 0..1000000 { n += i; } n } f(1); x",
        ] {
            let e = run_script(text, &[], &limits).unwrap_err();
            assert!(matches!(e, ScriptError::Limit { .. }), "{text}: {e}");
            assert!(e.to_string().contains("200000 steps"), "{e}");
        }
        let limits = ScriptLimits {
            time: Duration::from_millis(50),
            // A fast machine may take its default within the time.
            operations: u64::MAX,
            ..ScriptLimits::default()
        };
        let e = run_script("loop {}", &[], &limits).unwrap_err();
        assert!(e.to_string().contains("0.05 s"), "{e}");
    }

    #[test]
    fn growing_scripts_are_stopped() {
        for text in [
            "let s = \"a\"; loop { s += s; }",
            "let a = [1]; loop { a += a; }",
            "let a = []; a.pad(1000000000, 0); x",
            "let s = \"\"; s.pad(1000000000, \"a\"); x",
            "fn f(n) { f(n + 1) } f(0); x",
        ] {
            let e = run(text).unwrap_err();
            assert!(matches!(e, ScriptError::Limit { .. }), "{text}: {e}");
        }
        let e = error(&format!("{}x{}", "(".repeat(5000), ")".repeat(5000)));
        assert!(e.contains("complex") || e.contains("depth"), "{e}");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn memory_is_limited() {
        let limits = ScriptLimits {
            memory_bytes: 24 << 20,
            ..ScriptLimits::default()
        };
        // Small operations and one that makes many nodes.
        for text in [
            "let t = x; loop { t = t ** 1023; }",
            "let a = []; a.pad(20000, x); loop { draw(union(a)); }",
        ] {
            let e = run_script(text, &[], &limits).unwrap_err();
            assert!(e.to_string().contains("24 MB of memory"), "{e}");
        }
    }

    #[test]
    fn deep_values_do_not_overflow_the_stack() {
        run("let t = x; for i in 0..100000 { t = t + sin(t * 0.001); } t")
            .unwrap();
        run("let t = x; for i in 0..100000 { t = min(t, y + i); } t").unwrap();
        // Nested arrays are measured and freed by rhai, recursively.
        let e = run("let a = []; for i in 0..1000 { a = [a]; } a");
        assert!(matches!(e, Err(ScriptError::NoModel { .. })));
    }
}
