//! What shells offer while a command is typed: settings and their words,
//! printers, filaments, presets, hosts, and a script's parameters.
//!
//! A script of `isoslice completions` runs this program with the line so far,
//! and [`VARIABLE`] set. In: that line. Out: candidates. Completion may neither
//! fail nor take long: if something cannot be read, there are no candidates.

use super::Cli;
use super::folder::ProfilesSource;
use super::hosts::PrinterBook;
use anyhow::Context;
use clap::CommandFactory;
use clap_complete::CompleteEnv;
use clap_complete::engine::CompletionCandidate;
use clap_complete::env::Shells;
use isoslice::limits::{Limits, Watch};
use isoslice::model::{Source, load};
use isoslice::settings::{Key, ProfileKind, keys};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Says which shell asks.
const VARIABLE: &str = "ISOSLICE_COMPLETE";

/// How long a script may run for its parameters.
const PATIENCE: Duration = Duration::from_secs(2);

/// Answers a shell that asks, and ends the program then.
pub(crate) fn answer() {
    CompleteEnv::with_factory(Cli::command)
        .var(VARIABLE)
        .complete();
}

/// The script by which a shell asks this program.
pub(super) fn script(shell: &str) -> anyhow::Result<Vec<u8>> {
    let shells = Shells::builtins();
    let completer = shells
        .completer(shell)
        .with_context(|| format!("{shell} cannot complete"))?;
    let mut script = Vec::new();
    let name = "isoslice";
    completer.write_registration(VARIABLE, name, name, name, &mut script)?;
    if shell == "bash" {
        script.extend_from_slice(BASH.as_bytes());
    }
    Ok(script)
}

/// What bash needs as well: it cuts words at the characters in
/// `COMP_WORDBREAKS`, `=` among them, and takes completions only for the text
/// behind such a character. `_clap_complete_isoslice` is the function of the
/// script before.
const BASH: &str = include_str!("complete.bash");

/// Candidates that begin like what is typed.
fn beginning(
    typed: &OsStr,
    all: impl Iterator<Item = (String, String)>,
) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy();
    let alike = all.filter(|(word, _)| word.starts_with(&*typed));
    let candidate = |(word, help): (String, String)| {
        let help = (!help.is_empty()).then(|| help.into());
        CompletionCandidate::new(word).help(help)
    };
    alike.map(candidate).collect()
}

/// The keys of settings, as `--set` takes them, and their words behind the equals
/// sign.
pub(super) fn settings(typed: &OsStr) -> Vec<CompletionCandidate> {
    let text = typed.to_string_lossy();
    let words = |key: &Key| {
        let name = key.name;
        let words = key.some_words().iter();
        words.map(|word| format!("{name}={word}")).collect()
    };
    let found = match text.split_once('=') {
        Some((name, _)) => {
            let key = keys().iter().find(|key| key.name == name);
            let all: Vec<String> = key.map(words).unwrap_or_default();
            all.into_iter().map(|word| (word, String::new())).collect()
        }
        None => {
            let one = |key: &Key| (format!("{}=", key.name), brief(key));
            keys().iter().map(one).collect::<Vec<_>>()
        }
    };
    beginning(typed, found.into_iter())
}

/// The first sentence about a setting, and what it may be.
fn brief(key: &Key) -> String {
    let text = key.description();
    let first = text.split_once(". ").map_or(&*text, |(first, _)| first);
    format!("{} ({})", first.trim_end_matches('.'), key.allowed())
}

/// Profiles of a kind.
fn profiles(typed: &OsStr, kind: ProfileKind) -> Vec<CompletionCandidate> {
    let Ok(found) = source().find() else {
        return Vec::new();
    };
    let (all, _) = found.list(kind);
    let named = all
        .into_iter()
        .map(|profile| (profile.name, profile.description));
    beginning(typed, named)
}

pub(super) fn printers(typed: &OsStr) -> Vec<CompletionCandidate> {
    profiles(typed, ProfileKind::Printer)
}

pub(super) fn filaments(typed: &OsStr) -> Vec<CompletionCandidate> {
    profiles(typed, ProfileKind::Filament)
}

pub(super) fn presets(typed: &OsStr) -> Vec<CompletionCandidate> {
    profiles(typed, ProfileKind::Preset)
}

/// Printers that files are sent to.
pub(super) fn hosts(typed: &OsStr) -> Vec<CompletionCandidate> {
    let book = source().folder();
    let Some(Ok(book)) = book.map(|folder| PrinterBook::open(&folder)) else {
        return Vec::new();
    };
    let all = book.printers().map(|p| (p.name.clone(), String::new()));
    beginning(typed, all)
}

/// Parameters of the script that the line names, and their choices behind the
/// equals sign.
pub(super) fn parameters(typed: &OsStr) -> Vec<CompletionCandidate> {
    let Some(path) = line()
        .into_iter()
        .map(PathBuf::from)
        .find(|path| is_script(path))
    else {
        return Vec::new();
    };
    let limits = Limits {
        time: Some(PATIENCE),
        ..Limits::default()
    };
    let loaded = Watch::new(limits).run(|| load(&Source::File(path), &[]));
    let Ok(Ok(loaded)) = loaded else {
        return Vec::new();
    };
    let text = typed.to_string_lossy();
    let mut all = Vec::new();
    for parameter in loaded.parameters {
        let name = parameter.name;
        if text.starts_with(&format!("{name}=")) {
            let choices = parameter.allowed.choices.into_iter();
            all.extend(choices.map(|c| (format!("{name}={c}"), String::new())));
        } else {
            let mut help = parameter.description;
            if !help.is_empty() {
                help.push_str(", ");
            }
            help.push_str(&parameter.default);
            all.push((format!("{name}="), help));
        }
    }
    beginning(typed, all.into_iter())
}

fn is_script(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "rhai") && path.is_file()
}

/// The words of the line so far.
fn line() -> Vec<OsString> {
    let mut words = std::env::args_os();
    // The shell calls the program with `--` before the words of the line.
    words.by_ref().find(|word| word == "--");
    words.collect()
}

/// Where the profiles are, by the line so far.
fn source() -> ProfilesSource {
    let words = line();
    let joined = words.iter().find_map(|word| {
        word.to_str()?
            .strip_prefix("--profiles=")
            .map(PathBuf::from)
    });
    let mut named = words.iter().skip_while(|word| *word != "--profiles");
    let apart = named.nth(1).map(PathBuf::from);
    ProfilesSource::new(apart.or(joined))
}
