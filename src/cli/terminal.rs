//! What people see on the error stream: errors, warnings, notes, progress.
//!
//! The level is set once, before the first message: `-q` leaves out progress
//! and summaries, `-qq` warnings as well; `-v` adds notes, `-vv` where the time
//! went. Errors are always shown.
//!
//! Every message goes through [`plain`], since parts of it may be a stranger's
//! words.
//!
//! Colours are used only on a terminal whose user has not set `NO_COLOR`
//! (<https://no-color.org>). A stream that cannot be written to is given up
//! silently.

use super::plain;
use clap::builder::styling::{AnsiColor, Effects, Style};
use clap::{ArgAction, Args};
use indicatif::{
    ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState,
    ProgressStyle,
};
use isoslice::limits::Watch;
use isoslice::pipeline::SliceError;
use std::collections::BTreeSet;
use std::error::Error;
use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicBool, AtomicI8, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use terminal_size::terminal_size_of;

const ERROR: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const WARNING: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);

const NOTE: Style = AnsiColor::Cyan.on_default().effects(Effects::BOLD);

/// How much is shown: 0 is usual, less is quieter.
static LEVEL: AtomicI8 = AtomicI8::new(0);

/// True if a bar shows how far the run has come.
static BAR: AtomicBool = AtomicBool::new(false);

/// The warnings that were shown.
static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// How much is shown.
#[derive(Args, Debug)]
#[command(next_help_heading = "Messages")]
pub(super) struct Verbosity {
    /// Show neither progress nor summary, only warnings and errors; twice
    /// (-qq), only errors
    #[arg(
        short,
        long,
        global = true,
        action = ArgAction::Count,
        conflicts_with = "verbose"
    )]
    quiet: u8,

    /// Show notes as well; twice (-vv), also where the time went
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
}

impl Verbosity {
    /// Sets the level for the whole run.
    pub(super) fn apply(&self) {
        let of = |count: u8| i8::try_from(count).unwrap_or(i8::MAX);
        let level = of(self.verbose).saturating_sub(of(self.quiet));
        LEVEL.store(level, Ordering::Relaxed);
    }
}

/// How much is shown: from -1 down there is no summary, from 1 up there are
/// notes.
fn level() -> i8 {
    LEVEL.load(Ordering::Relaxed)
}

/// True if summaries and progress are not to be shown.
pub(super) fn is_quiet() -> bool {
    level() < 0
}

/// True if the user asks where the time went.
pub(super) fn wants_timings() -> bool {
    level() > 1
}

/// Shows an error and what caused it, one per line.
pub(crate) fn report_error(error: &anyhow::Error) {
    let texts = causes(error);
    let mut texts = texts.iter();
    if let Some(first) = texts.next() {
        say(ERROR, "error", first);
    }
    for cause in texts {
        let _ = writeln!(stderr(), "  because: {cause}");
    }
}

/// The texts of an error and of its causes. Some errors tell their cause
/// themselves, with a remedy, and then the cause is left out.
pub(super) fn causes(error: &anyhow::Error) -> Vec<String> {
    let mut texts: Vec<String> = error.chain().map(shown).collect();
    texts.dedup_by(|cause, effect| effect.contains(&**cause));
    texts
}

/// An error as it is shown: in one line, unless it lists faults.
fn shown(error: &(dyn Error + 'static)) -> String {
    let text = error.to_string();
    match error.downcast_ref::<SliceError>() {
        Some(SliceError::Unsafe(_)) => {
            let lines: Vec<_> = text.lines().map(plain::line).collect();
            lines.join("\n")
        }
        _ => plain::line(&text).into_owned(),
    }
}

/// Shows warnings, each once in a run of the program.
pub(super) fn warn(warnings: &[String]) {
    if level() < -1 {
        return;
    }
    let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    for warning in warnings {
        if said.insert(warning.clone()) {
            say(WARNING, "warning", &wrapped(warning, "warning"));
        }
    }
}

/// A message of one line after a word and a colon, in lines that fit into the
/// terminal. Files and other programs get one line.
fn wrapped(message: &str, word: &str) -> String {
    let message = plain::line(message);
    match terminal_size_of(stderr()) {
        Some((width, _)) => wrap(&message, word.len() + 2, width.0.into()),
        None => message.into_owned(),
    }
}

/// A text in lines of at most `width` characters, unless a word is longer. The
/// first line begins at `column`, and the others are indented.
fn wrap(text: &str, mut column: usize, width: usize) -> String {
    /// The next line, indented by two characters.
    const NEXT: &str = "\n  ";
    let mut lines = String::new();
    for word in text.split(' ') {
        let length = word.chars().count();
        let gap = if lines.is_empty() {
            ""
        } else if column + 1 + length > width {
            column = NEXT.len() - 1;
            NEXT
        } else {
            column += 1;
            " "
        };
        lines += gap;
        lines += word;
        column += length;
    }
    lines
}

/// Shows how far the run has come, unless a bar does.
pub(super) fn progress(word: &str) {
    if !BAR.load(Ordering::Relaxed) {
        say(NOTE, "note", &plain::line(word));
    }
}

/// Shows notes, if they are asked for.
pub(super) fn note(notes: &[String]) {
    if level() > 0 {
        for note in notes {
            say(NOTE, "note", &wrapped(note, "note"));
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

/// A bar that counts layers and names the stage. It is drawn only on a
/// terminal.
pub(super) fn layer_progress(quiet: bool, watch: &Watch) -> ProgressBar {
    /// Time between updates, short enough to see the bar move.
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
    // The bar also goes away when the work is stopped half-way.
    let bar = bar.with_finish(ProgressFinish::AndClear);
    bar.enable_steady_tick(EVERY);
    BAR.store(true, Ordering::Relaxed);
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_wrapped_between_words() {
        let text = "six long words are said in lines";
        let lines = "six long\n  words are\n  said in\n  lines";
        assert_eq!(wrap(text, 3, 11), lines);
        assert_eq!(wrap(text, 9, 100), text);
        // A word that does not fit stays whole.
        assert_eq!(wrap("a-long-word b", 9, 5), "a-long-word\n  b");
        assert_eq!(wrap("", 9, 5), "");
        // Each line is as long as it may be, in characters.
        let dots = "···· ".repeat(50);
        let lines = wrap(dots.trim_end(), 0, 22);
        assert!(lines.lines().all(|line| line.chars().count() <= 22));
        assert_eq!(lines.lines().count(), 13);
    }
}
