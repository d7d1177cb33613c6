//! How the value of one key becomes the value of one setting.

use crate::Slicer;
use crate::given::{Given, Value};
use crate::values::{parse, share};

/// Words of a key, each with isoslice's own. An empty one leaves it to isoslice.
pub type Pairs = &'static [(&'static str, &'static str)];

/// The word of isoslice for a word of any case.
fn ours(pairs: Pairs, text: &str) -> Option<&'static str> {
    let text = text.to_ascii_lowercase();
    let found = pairs.iter().find(|(theirs, _)| *theirs == text);
    found.map(|(_, ours)| *ours)
}

/// Pairs as documentation shows them.
fn shown(pairs: Pairs) -> String {
    let pairs = pairs
        .iter()
        .map(|(theirs, ours)| format!("{theirs} → {ours}"));
    pairs.collect::<Vec<_>>().join(", ")
}

/// A setting's value from a word; none if the word is empty.
fn value_of(word: &str) -> Option<Value> {
    match word {
        "" => None,
        "true" => Some(true.into()),
        "false" => Some(false.into()),
        word => Some(match parse(word) {
            Some(number) => number.into(),
            None => word.into(),
        }),
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
    Words(Pairs),
    /// One of a few patterns.
    Patterns {
        /// Patterns that isoslice has.
        same: Pairs,
        /// Patterns that isoslice does not have, each with the one most like it.
        like: Pairs,
    },
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
            As::Words(words) => shown(words),
            As::Patterns { same, like: [] } => shown(same),
            As::Patterns { same, like } => {
                format!("{}; only alike: {}", shown(same), shown(like))
            }
            As::Template => "its placeholders are translated".to_owned(),
        }
    }

    /// The word of isoslice for a word.
    fn word(self, text: &str) -> Option<&'static str> {
        match self {
            As::Words(words) => ours(words, text),
            As::Patterns { same, like } => {
                ours(same, text).or_else(|| ours(like, text))
            }
            _ => None,
        }
    }

    /// The pattern of isoslice that is the most like a key's, if isoslice does
    /// not have the key's own.
    pub(crate) fn alike(
        self,
        given: &Given<'_>,
        key: &str,
    ) -> Option<&'static str> {
        match self {
            As::Patterns { like, .. } => ours(like, given.values.first(key)?),
            _ => None,
        }
    }

    pub(crate) fn value(
        self,
        given: &Given<'_>,
        key: &str,
    ) -> Result<Option<Value>, String> {
        let text = match self {
            // G-code is one value, whatever commas and semicolons are in it.
            As::Template => given.values.text(key).filter(|t| !t.is_empty()),
            _ => given.values.first(key),
        };
        let Some(text) = text else {
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
            As::Words(_) | As::Patterns { .. } => {
                let word = self.word(text).ok_or_else(|| {
                    format!(
                        "isoslice has nothing like {text}; it keeps its own"
                    )
                })?;
                value_of(word)
            }
            As::Name | As::Template => Some(text.into()),
        })
    }
}
