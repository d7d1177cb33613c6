//! Commands after which the head is where the check does not know.
//!
//! In: the command, and the moves after it. Out: a finding, if a bead begins
//! before the head was brought back. Parking and cleaning are usual between
//! two layers of a user's own template, which brings the head back.

use super::{Checker, FindingKind};
use glam::DVec3;
use isoslice_gcode_read::reader::{Move, Words};

/// A command that has moved the head.
pub(super) struct Away {
    word: String,
    line: u64,
    why: &'static str,
    /// A bit for each axis that was told a place since, from x.
    told: u8,
}

impl Away {
    pub(super) fn new(word: &str, line: u64, why: &'static str) -> Self {
        let word = word.to_owned();
        Away {
            word,
            line,
            why,
            told: 0,
        }
    }
}

impl Checker<'_> {
    /// Reports the command, if this move is a bead and the head was not brought
    /// back.
    pub(super) fn away(&mut self, step: &Move, words: &Words) {
        let Some(away) = &mut self.away else {
            return;
        };
        if step.prints() {
            if let Some(away) = self.away.take().filter(|a| a.told != 0b111) {
                let Away {
                    word, why, line, ..
                } = away;
                let kind = FindingKind::Harmful;
                self.verdict.add_about(kind, &word, line, DVec3::NAN, || {
                    format!("{word} {why}")
                });
            }
            return;
        }
        for (i, letter) in b"XYZ".iter().enumerate() {
            away.told |= u8::from(words.has(*letter)) << i;
        }
    }
}
