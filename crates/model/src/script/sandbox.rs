//! The sandbox: what the interpreter may not do.

use super::limits::{
    MAX_ARRAY, MAX_CALLS, MAX_DEPTH, MAX_FUNCTIONS, MAX_MAP, MAX_STRING,
    MAX_VARIABLES, Stop,
};
use super::shape::Outcome;
use rhai::{Dynamic, Engine, EvalAltResult, ImmutableString, Position};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Takes away what reaches outside, and ends scripts that take more than `most`
/// operations or that `stop` tells to end.
pub(super) fn add_limits(engine: &mut Engine, most: u64, stop: Arc<AtomicU8>) {
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
        let why = if operations > most {
            Some(Stop::Operations)
        } else {
            Stop::from_number(stop.load(Ordering::Relaxed))
        };
        why.map(Dynamic::from)
    });

    // rhai calls these from its standard library, but functions registered here
    // come first.
    const NO_CLOCK: &str = "models have no access to the clock: the same \
                            script must always give the same part";
    engine.register_fn("timestamp", || -> Outcome<()> { Err(NO_CLOCK.into()) });
    engine
        .register_fn("sleep", |_: i64| -> Outcome<()> { Err(NO_CLOCK.into()) });
    engine
        .register_fn("sleep", |_: f64| -> Outcome<()> { Err(NO_CLOCK.into()) });
}

/// A `replace` for texts. rhai's own checks the length only afterwards, and a
/// text of a million letters, each replaced by a million more, does not fit any
/// machine.
pub(super) fn add_replace(engine: &mut Engine) {
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
