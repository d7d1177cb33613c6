//! From a profile's values to isoslice's settings.

use crate::Picked;
use crate::given::{Given, Value};
use crate::table::{Outcome, PresetKind, Row, Rule, row_of, rows};
use std::collections::BTreeSet;

/// A setting that follows from the profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The kind of isoslice's profile to which the setting belongs.
    pub kind: PresetKind,
    /// The setting's name.
    pub name: &'static str,
    /// The setting's value.
    pub value: Value,
    /// The keys from which the setting was made.
    pub from: Vec<String>,
}

/// A key from which no setting was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Left {
    /// The key.
    pub key: String,
    /// The key's value.
    pub value: String,
    /// Why no setting was made from the key, or what to do.
    pub why: String,
}

/// What a profile means to isoslice.
#[derive(Clone, Debug, Default)]
pub struct Translation {
    /// The settings, in the order of the table.
    pub settings: Vec<Setting>,
    /// Keys that isoslice does not need, because of what they are or of their
    /// value.
    pub ignored: Vec<Left>,
    /// Keys that would change the print and have no counterpart.
    pub lost: Vec<Left>,
    /// Keys whose pattern isoslice does not have: they got the one most like it.
    pub alike: Vec<Left>,
    /// Keys that are not in the table.
    pub unknown: Vec<Left>,
    /// Number of keys from which settings were made.
    pub mapped: usize,
}

/// Translates a profile.
pub fn translate(picked: &Picked) -> Translation {
    let given = Given {
        values: &picked.values,
        slicer: picked.slicer,
    };
    let mut out = Translation::default();
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    for row in rows().filter(|row| row.of.contains(&picked.slicer)) {
        let present: Vec<&str> = row
            .keys
            .iter()
            .copied()
            .filter(|key| picked.values.text(key).is_some())
            .filter(|key| !seen.contains(key))
            .collect();
        seen.extend(&present);
        if !present.is_empty() {
            out.take(row, &present, &given);
        }
    }
    for key in picked.values.keys().filter(|key| !seen.contains(key)) {
        // A key with an empty list has no value of its own.
        if row_of(picked.slicer, key).is_some() {
            out.ignored.push(given.left(key, "it is empty"));
        } else {
            let why = "isoslice does not know this key";
            out.unknown.push(given.left(key, why));
        }
    }
    out
}

impl Translation {
    fn take(&mut self, row: &'static Row, present: &[&str], given: &Given<'_>) {
        let all = |why: &str| -> Vec<Left> {
            present.iter().map(|key| given.left(key, why)).collect()
        };
        if present.iter().all(|key| given.values.is_nil(key)) {
            let why = "nil: what the printer's profile says holds";
            self.ignored.extend(all(why));
            return;
        }
        let outcome = match &row.rule {
            Rule::Ignored(why) => Outcome::Nothing((*why).to_owned()),
            Rule::Lost(neutral, why) => {
                for key in present {
                    let shown = given.values.shown(key);
                    let is_neutral = shown.split(',').all(|item| {
                        let item = item.trim().trim_matches('"');
                        item.is_empty() || neutral.contains(&item)
                    });
                    if is_neutral {
                        let why = "off, as in isoslice";
                        self.ignored.push(given.left(key, why));
                    } else {
                        self.lost.push(given.left(key, why));
                    }
                }
                return;
            }
            Rule::To(setting, how) => {
                Outcome::to(setting, *how, given, present[0])
            }
            Rule::Made { make, .. } => (make.0)(given),
        };
        if let Outcome::Alike(_, why) = &outcome
            && let Some(key) = given.first_of(present)
        {
            self.alike.push(given.left(key, why));
        }
        match outcome {
            Outcome::Set(settings) | Outcome::Alike(settings, _) => {
                self.mapped += present.len();
                for (name, value) in settings {
                    let mut setting = Setting {
                        kind: row.kind,
                        name,
                        value,
                        from: present.iter().map(|k| (*k).into()).collect(),
                    };
                    let same =
                        |s: &Setting| s.name == name && s.kind == row.kind;
                    if let Some(at) = self.settings.iter().position(same) {
                        setting.follow(self.settings.remove(at));
                    }
                    self.settings.push(setting);
                }
            }
            Outcome::Nothing(why) => {
                self.ignored.extend(all(&why));
            }
            Outcome::Lost(why) => {
                self.lost.extend(all(&why));
            }
        }
    }
}

/// The settings that are lists of parts, each from a row of the table.
const OF_PARTS: [&str; 1] = ["skin_pattern"];

impl Setting {
    /// Takes the place of the same setting from an earlier row. Later rows of the
    /// table are more specific, and win.
    fn follow(&mut self, earlier: Setting) {
        if let (true, Value::Text(before), Value::Text(text)) = (
            OF_PARTS.contains(&self.name),
            earlier.value,
            &mut self.value,
        ) {
            *text = format!("{before}, {text}");
            self.from.splice(0..0, earlier.from);
        }
    }
}

impl Given<'_> {
    fn left(&self, key: &str, why: &str) -> Left {
        Left {
            key: key.to_owned(),
            value: self.values.shown(key),
            why: why.to_owned(),
        }
    }
}
