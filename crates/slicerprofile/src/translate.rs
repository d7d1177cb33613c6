//! From a profile's values to isoslice's settings.

use crate::table::{Kind, Outcome, Row, Rule, row_of, rows};
use crate::values::{Values, parse, share};
use crate::{Picked, Slicer};
use std::collections::BTreeSet;

/// The value of a setting.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, in the setting's unit.
    Number(f64),
    /// Yes or no.
    Switch(bool),
    /// A word, a share of the nozzle such as `110%`, or G-code.
    Text(String),
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        // Computing in binary leaves digits that are not meant, such as those
        // of 0.30000000000000004.
        Value::Number((x * 1e6).round() / 1e6)
    }
}

impl From<bool> for Value {
    fn from(yes: bool) -> Self {
        Value::Switch(yes)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Value::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Value::Text(text)
    }
}

/// A setting that follows from the profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The kind of isoslice's profile to which the setting belongs.
    pub kind: Kind,
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
        // An empty list has no value yet.
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
                let key = present[0];
                match how.value(given, key) {
                    Ok(Some(value)) => Outcome::Set(vec![(*setting, value)]),
                    Ok(None) => Outcome::Nothing(
                        "it leaves the choice to the slicer".to_owned(),
                    ),
                    Err(why) => Outcome::Lost(why),
                }
            }
            Rule::Made { make, .. } => (make.0)(given),
        };
        match outcome {
            Outcome::Set(settings) => {
                self.mapped += present.len();
                for (name, value) in settings {
                    // Later rows of the table are more particular.
                    self.settings
                        .retain(|s| s.name != name || s.kind != row.kind);
                    self.settings.push(Setting {
                        kind: row.kind,
                        name,
                        value,
                        from: present.iter().map(|k| (*k).into()).collect(),
                    });
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

/// A profile's values, as conversions read them.
pub(crate) struct Given<'a> {
    pub(crate) values: &'a Values,
    pub(crate) slicer: Slicer,
}

/// Greatest number of times that a share of a share is followed.
const DEEPEST: usize = 6;

impl Given<'_> {
    fn left(&self, key: &str, why: &str) -> Left {
        Left {
            key: key.to_owned(),
            value: self.values.shown(key),
            why: why.to_owned(),
        }
    }

    /// The first of the keys that has a value.
    pub(crate) fn first_of<'k>(&self, keys: &[&'k str]) -> Option<&'k str> {
        keys.iter()
            .copied()
            .find(|k| self.values.first(k).is_some())
    }

    /// A number, if the key has one.
    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        self.values.number(key)
    }

    /// A number above 0, if the key has one.
    pub(crate) fn positive(&self, key: &str) -> Option<f64> {
        self.number(key).filter(|x| *x > 0.0)
    }

    /// A switch, if the key has one.
    pub(crate) fn switch(&self, key: &str) -> Option<bool> {
        match self.values.first(key)?.to_ascii_lowercase().as_str() {
            "1" | "true" | "yes" | "enabled" | "on" => Some(true),
            "0" | "false" | "no" | "disabled" | "off" => Some(false),
            _ => None,
        }
    }

    pub(crate) fn on(&self, key: &str) -> bool {
        self.switch(key) == Some(true)
    }

    pub(crate) fn off(&self, key: &str) -> bool {
        self.switch(key) == Some(false)
    }

    /// A number, or the value of a share such as `50%`; none if the key has no
    /// value.
    ///
    /// # Errors
    /// If the value is neither, or a share of something that is not in the
    /// profile.
    pub(crate) fn amount(&self, key: &str) -> Result<Option<f64>, String> {
        self.amount_within(key, DEEPEST)
    }

    fn amount_within(
        &self,
        key: &str,
        depth: usize,
    ) -> Result<Option<f64>, String> {
        let Some(text) = self.values.first(key) else {
            return Ok(None);
        };
        if let Some(number) = parse(text) {
            return Ok(Some(number));
        }
        let Some(percent) = share(text) else {
            return Err(format!("{text} is not a number: write it yourself"));
        };
        let base = crate::table::share_of(self, key);
        if depth == 0 || base.is_empty() {
            return Err(format!("it is not known what {text} is a share of"));
        }
        for base in base {
            if let Some(whole) = self.amount_within(base, depth - 1)?
                && whole > 0.0
            {
                return Ok(Some(whole * percent / 100.0));
            }
        }
        Err(format!(
            "{text} is a share of {}, which the profile does not have",
            base[0]
        ))
    }
}

/// How a setting's value is made from a key's value.
#[derive(Clone, Copy, Debug)]
pub enum As {
    /// The number.
    Number,
    /// The number; 0 leaves it to the slicer.
    Positive,
    /// Yes or no.
    Switch,
    /// A percentage, with or without its sign.
    Percent,
    /// A ratio, of which 1 is 100 %; with a percent sign it is a percentage.
    Ratio,
    /// A length, or a share of the nozzle or of the layer's height; 0 leaves it
    /// to the slicer.
    Width,
    /// A length, speed or acceleration, or a share of another one; 0 leaves it
    /// to the slicer.
    Amount,
    /// A length or a share of another one; 0 is 0.
    Length,
    /// One of a few words.
    Words(&'static [(&'static str, &'static str)]),
    /// A name.
    Name,
    /// G-code.
    Template,
}

impl As {
    /// What documentation says of the conversion; empty if there is nothing to
    /// say.
    pub fn says(self) -> String {
        match self {
            As::Number | As::Switch | As::Percent | As::Name => String::new(),
            As::Positive => "0 leaves it to isoslice".to_owned(),
            As::Ratio => "1 becomes 100 %".to_owned(),
            As::Width => "shares become shares of the nozzle".to_owned(),
            As::Amount => "shares become numbers; 0 leaves it".to_owned(),
            As::Length => "shares become lengths".to_owned(),
            As::Words(words) => {
                let pairs = words
                    .iter()
                    .map(|(theirs, ours)| format!("{theirs} → {ours}"));
                pairs.collect::<Vec<_>>().join(", ")
            }
            As::Template => "its placeholders are translated".to_owned(),
        }
    }

    fn value(
        self,
        given: &Given<'_>,
        key: &str,
    ) -> Result<Option<Value>, String> {
        let Some(text) = given.values.first(key) else {
            return Ok(None);
        };
        let number = || {
            parse(text).ok_or_else(|| {
                format!("{text} is not a number: write it yourself")
            })
        };
        let above = |x: f64| (x > 0.0).then(|| x.into());
        Ok(match self {
            As::Number => Some(number()?.into()),
            As::Positive => above(number()?),
            As::Switch => Some(
                given
                    .switch(key)
                    .ok_or_else(|| format!("{text} is neither 0 nor 1"))?
                    .into(),
            ),
            As::Percent => Some(match share(text) {
                Some(percent) => percent.into(),
                None => number()?.into(),
            }),
            As::Ratio => Some(match share(text) {
                Some(percent) => percent.into(),
                None => (number()? * 100.0).into(),
            }),
            As::Width => match (share(text), given.slicer) {
                (Some(0.0), _) => None,
                (Some(_), Slicer::Prusa) => given.amount(key)?.and_then(above),
                (Some(_), _) => Some(text.into()),
                (None, _) => above(number()?),
            },
            As::Amount => given.amount(key)?.and_then(above),
            As::Length => given.amount(key)?.map(Value::from),
            As::Words(words) => {
                let lower = text.to_ascii_lowercase();
                let found = words.iter().find(|(theirs, _)| *theirs == lower);
                let Some((_, ours)) = found else {
                    return Err(format!(
                        "isoslice has nothing like {text}; it keeps its own"
                    ));
                };
                match *ours {
                    "" => None,
                    "true" => Some(true.into()),
                    "false" => Some(false.into()),
                    word => Some(match parse(word) {
                        Some(number) => number.into(),
                        None => word.into(),
                    }),
                }
            }
            As::Name => Some(text.into()),
            As::Template => {
                let whole = given.values.text(key).unwrap_or("");
                let whole = whole.trim();
                (!whole.is_empty()).then(|| whole.into())
            }
        })
    }
}
