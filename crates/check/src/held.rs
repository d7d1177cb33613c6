//! Findings that count only if something is printed after them. End codes unload
//! filament, measure the bed and turn the printer off.

use super::{Checker, FindingKind};
use glam::DVec3;

/// Greatest number of findings that wait to see whether something is printed
/// after them.
const HELD: usize = 32;

/// A finding that waits.
pub(super) struct Held {
    kind: FindingKind,
    about: String,
    line: u64,
    at: DVec3,
    why: String,
}

impl Checker<'_> {
    /// Keeps a finding that counts only if something is printed after it.
    pub(super) fn hold(
        &mut self,
        kind: FindingKind,
        about: &str,
        line: u64,
        at: DVec3,
        why: String,
    ) {
        if self.held.len() == HELD {
            self.let_go();
        }
        let about = about.to_owned();
        self.held.push(Held {
            kind,
            about,
            line,
            at,
            why,
        });
    }

    /// Makes the findings that were held count, as something is printed.
    pub(super) fn let_go(&mut self) {
        for held in self.held.drain(..) {
            let Held { kind, line, at, .. } = held;
            self.verdict
                .add_about(kind, &held.about, line, at, || held.why);
        }
    }
}
