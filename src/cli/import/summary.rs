//! What an import tells: what became of which keys.

use super::super::plain;
use super::words::{shortened, shown};
use super::{Import, Written, ours};
use std::fmt::Write as _;

/// Greatest number of keys that the summary names, of each kind.
const MOST_SHOWN: usize = 8;
impl Import {
    /// What was done, for people.
    pub(super) fn summary(&self, written: &[Written], all: bool) -> String {
        let t = &self.translation;
        let mut out = String::new();
        for (_, _, path) in written {
            let _ = writeln!(out, "wrote {}", plain::value(path.display()));
        }
        let _ = writeln!(
            out,
            "{} keys became {} settings, {} are not needed, {} have no \
             counterpart, {} are not known",
            t.mapped,
            t.settings.len(),
            t.ignored.len(),
            t.lost.len(),
            t.unknown.len()
        );
        if all {
            for setting in &t.settings {
                let _ = writeln!(
                    out,
                    "  {} = {}, from {}",
                    setting.name,
                    plain::value(shown(&setting.value)),
                    plain::value(setting.from.join(", "))
                );
            }
        }
        let lists = [
            ("no counterpart", &t.lost, true),
            ("not known", &t.unknown, true),
            ("not needed", &t.ignored, false),
        ];
        for (title, list, always) in lists {
            if list.is_empty() || !(always || all) {
                continue;
            }
            let _ = writeln!(out, "{title}:");
            let most = if all { list.len() } else { MOST_SHOWN };
            for left in list.iter().take(most) {
                let _ = writeln!(
                    out,
                    "  {} = {}: {}",
                    plain::value(&left.key),
                    plain::value(shortened(&left.value)),
                    plain::value(&left.why)
                );
            }
            if list.len() > most {
                let more = list.len() - most;
                let _ = writeln!(out, "  and {more} more: --all names them");
            }
        }
        for remark in &self.remarks {
            let _ = writeln!(out, "note: {}", plain::line(remark));
        }
        if !written.is_empty() {
            let options: Vec<String> = written
                .iter()
                .map(|(kind, name, _)| {
                    let word = ours(*kind).word();
                    format!("--{word} {}", plain::value(name))
                })
                .collect();
            let _ = writeln!(
                out,
                "slice with it: isoslice slice part.rhai {}",
                options.join(" ")
            );
        }
        out
    }
}
