//! What is wrong with a template, where, and what was meant.

use super::{END, LAYER};
use crate::PLACEHOLDERS;
use crate::placeholders::{self, Scope};
use minijinja::{Error, ErrorKind};

/// Why a template cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{template}, line {line}, column {column}: {message}")]
pub struct TemplateError {
    /// The setting that holds the template.
    pub template: &'static str,
    /// Line of the mistake, from 1.
    pub line: usize,
    /// Column of the mistake, in characters, from 1.
    pub column: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

/// The message for an unknown name.
pub(super) fn unknown_name(name: &str, scope: Scope) -> String {
    if let Some(place) = known_elsewhere(name, scope) {
        return format!("{name} is known in {place} only");
    }
    if name == "namespace" {
        return "there are no namespaces: what changes in a loop follows from \
                loop.index0"
            .to_owned();
    }
    let hint = meant(name, scope)
        .map(|known| format!(", did you mean {{{{ {known} }}}}?"))
        .unwrap_or_default();
    let all: Vec<&str> = PLACEHOLDERS
        .iter()
        .filter(|p| p.scope == Scope::All || p.scope == scope)
        .map(|p| p.name)
        .collect();
    format!(
        "there is no placeholder {{{{ {name} }}}}{hint}; there are {}, and \
         every setting by its name",
        all.join(", ")
    )
}

/// The only template that knows a name, if there is one.
pub(super) fn known_elsewhere(
    name: &str,
    scope: Scope,
) -> Option<&'static str> {
    let elsewhere = PLACEHOLDERS
        .iter()
        .find(|p| p.name == name && p.scope != scope);
    match elsewhere?.scope {
        Scope::Layer => Some(LAYER),
        Scope::End => Some(END),
        Scope::All => None,
    }
}

/// The known name that is most like an unknown one.
pub(super) fn meant(name: &str, scope: Scope) -> Option<&'static str> {
    // Names less alike than this have little more than a letter in common.
    const NEAR: f64 = 0.8;
    let like = |known: &str| {
        // The right name in the wrong group is near, so the group is not
        // compared.
        let leaf = known.rsplit('.').next().unwrap_or(known);
        let own = name.rsplit('.').next().unwrap_or(name);
        let whole = strsim::jaro_winkler(name, known);
        whole.max(0.95 * strsim::jaro_winkler(own, leaf))
    };
    placeholders::names(scope)
        .map(|known| (like(known), known))
        .filter(|(likeness, _)| *likeness >= NEAR)
        // If several names are equally near, the first one is taken.
        .fold(None::<(f64, &str)>, |best, this| match best {
            Some(best) if best.0 >= this.0 => Some(best),
            _ => Some(this),
        })
        .map(|(_, known)| known)
}

/// An error of the engine in this program's words, and its place in bytes.
pub(super) fn failure(failed: &Error) -> (Option<usize>, String) {
    let mut message = match failed.kind() {
        ErrorKind::OutOfFuel => {
            "it takes too much time or memory; make it shorter".to_owned()
        }
        ErrorKind::UndefinedError => "this has no value".to_owned(),
        kind => kind.to_string(),
    };
    if let Some(detail) = failed.detail() {
        message = format!("{message}: {detail}");
    }
    (failed.range().map(|r| r.start), message)
}

/// A mistake at a place in the source, in bytes.
pub(super) fn error(
    template: &'static str,
    source: &str,
    at: usize,
    message: String,
) -> TemplateError {
    let before = source.get(..at).unwrap_or(source);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    TemplateError {
        template,
        line,
        column: before[start..].chars().count() + 1,
        message,
    }
}
