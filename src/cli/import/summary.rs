//! What an import tells: what became of which keys.

use super::super::plain;
use super::super::rows::counted;
use super::words::{shortened, shown};
use super::{Import, Written, ours, own, without};
use slicerprofile::Left;
use std::fmt::Write as _;

/// Greatest number of keys that the summary names, of each kind.
const MOST_SHOWN: usize = 8;

/// A number with the word that follows it.
fn some(count: usize, one: &str, more: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { more })
}

impl Import {
    /// How many keys became what.
    pub(super) fn counts(&self) -> String {
        let t = &self.translation;
        let settings = counted(t.settings.len(), "setting");
        if self.maker == own::MAKER {
            let is_one = t.settings.len() == 1;
            let differ = if is_one { "differs" } else { "differ" };
            return format!("{settings} that {differ} from the defaults");
        }
        let is = |list: &[Left]| some(list.len(), "is", "are");
        format!(
            "{} became {settings}, {} not needed, {} no counterpart, {} not known",
            counted(t.mapped, "key"),
            is(&t.ignored),
            some(t.lost.len(), "has", "have"),
            is(&t.unknown)
        )
    }

    /// What was done, for people.
    pub(super) fn summary(&self, written: &[Written], all: bool) -> String {
        let t = &self.translation;
        let mut out = String::new();
        for (_, _, path) in written {
            let _ = writeln!(out, "wrote {}", plain::value(path.display()));
        }
        let _ = writeln!(out, "{}", self.counts());
        if all {
            for setting in &t.settings {
                let _ = writeln!(
                    out,
                    "  {} = {}{}",
                    setting.name,
                    plain::value(shown(&setting.value)),
                    match setting.from.as_slice() {
                        [] => String::new(),
                        keys => {
                            let keys = keys.join(", ");
                            format!(", from {}", plain::value(keys))
                        }
                    }
                );
            }
        }
        let lists = [
            ("no counterpart", &t.lost, true),
            ("only alike", &t.alike, true),
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
        for (_, template, _) in &self.kept {
            let _ = writeln!(
                out,
                "warning: {template} could not be translated and stands in the file \
                 as a comment only: until you mend it there, the print {}",
                without(template)
            );
        }
        if !written.is_empty() {
            let options: Vec<String> = written
                .iter()
                .map(|(kind, name, _)| {
                    let word = ours(*kind).name();
                    let word = if self.as_settings { "config" } else { word };
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
