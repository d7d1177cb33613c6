//! Tools that a file takes in the middle of the print.
//!
//! The printers of the settings have one tool. A file for several tools, or for
//! several filaments through one nozzle, heats the others, or takes one of them
//! before it prints, or says that it has a tower or several filaments.

use super::{Checker, FindingKind, TOOLS, bit};
use glam::DVec3;
use std::collections::BTreeMap;

/// What is known of the tools.
#[derive(Debug)]
pub(super) struct Tools {
    /// A bit for the first tool, and for each that was heated, or taken before
    /// anything was printed.
    known: u64,
    /// Other tools, with the line on which each was taken first.
    taken: BTreeMap<u32, u64>,
    /// True if the file is for several filaments.
    pub several: bool,
}

impl Default for Tools {
    fn default() -> Self {
        Tools {
            known: bit(0),
            taken: BTreeMap::new(),
            several: false,
        }
    }
}

impl Tools {
    /// Takes in that a tool is heated, or is used from the start.
    pub(super) fn know(&mut self, tool: u32) {
        self.known |= bit(tool);
    }
}

impl Checker<'_> {
    /// Takes in that another tool is taken.
    pub(super) fn take_tool(&mut self, line: u64, tool: u32) {
        self.fresh_tool |= tool != self.tool;
        self.tool = tool;
        self.asleep &= !bit(tool);
        if !self.ending.has_printed() {
            self.tools.know(tool);
        } else if self.tools.known & bit(tool) == 0 {
            let taken = &mut self.tools.taken;
            if taken.len() < TOOLS as usize || taken.contains_key(&tool) {
                taken.entry(tool).or_insert(line);
            }
        }
    }

    /// Reports the tools that the printer does not have.
    pub(super) fn missing_tools(&mut self, filaments: usize) {
        if self.tools.several || filaments > 1 {
            return;
        }
        for (tool, line) in std::mem::take(&mut self.tools.taken) {
            let (kind, word) = (FindingKind::NoTool, format!("T{tool}"));
            self.verdict.add_about(kind, &word, line, DVec3::NAN, || {
                format!(
                    "{word} takes another tool in the middle of the print, \
                     which nothing has heated; the printer has one tool"
                )
            });
        }
    }
}
