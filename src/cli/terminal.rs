//! What people see on the error stream: errors, warnings, progress.
//!
//! Colours only on a terminal whose user has not set `NO_COLOR`
//! (<https://no-color.org>); a stream that cannot be written to is given up
//! silently, since there is nobody to tell.

use clap::builder::styling::{AnsiColor, Effects, Style};
use indicatif::{
    ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState,
    ProgressStyle,
};
use isoslice::limits::Watch;
use std::io::{IsTerminal, Write, stderr};
use std::time::Duration;

const ERROR: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const WARNING: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);

/// Shows an error and what caused it, one per line.
pub(crate) fn report_error(error: &anyhow::Error) {
    let mut chain = error.chain();
    if let Some(first) = chain.next() {
        say(ERROR, "error", &first.to_string());
    }
    for cause in chain {
        let _ = writeln!(stderr(), "  because: {cause}");
    }
}

/// Shows warnings, each once.
pub(super) fn warn(warnings: &[String]) {
    for (i, warning) in warnings.iter().enumerate() {
        if !warnings[..i].contains(warning) {
            say(WARNING, "warning", warning);
        }
    }
}

fn say(style: Style, what: &str, message: &str) {
    let (on, off) = if colours() {
        (style.render().to_string(), style.render_reset().to_string())
    } else {
        (String::new(), String::new())
    };
    let _ = writeln!(stderr(), "{on}{what}:{off} {message}");
}

fn colours() -> bool {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty())
        || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    stderr().is_terminal() && !refused
}

/// A bar that counts layers and says what is being done, drawn only on a
/// terminal.
pub(super) fn layer_progress(quiet: bool, watch: &Watch) -> ProgressBar {
    /// Time between looks: often enough to see it move.
    const EVERY: Duration = Duration::from_millis(200);
    if quiet || !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let target = ProgressDrawTarget::stderr();
    let bar = ProgressBar::with_draw_target(None, target);
    // A template that does not parse leaves the plain bar.
    if let Ok(style) = ProgressStyle::with_template(
        "slicing {bar:30} layer {pos} of {len}, {eta} left, {doing}",
    ) {
        let watch = watch.clone();
        let doing = move |_: &ProgressState, to: &mut dyn std::fmt::Write| {
            let _ = to.write_str(watch.activity().now.unwrap_or(""));
        };
        bar.set_style(style.with_key("doing", doing));
    }
    // Also when the work is stopped half-way.
    let bar = bar.with_finish(ProgressFinish::AndClear);
    bar.enable_steady_tick(EVERY);
    bar
}
