//! Values of settings: what each type reads from TOML or from the command
//! line, and how it is written.
//!
//! In: a [`Raw`] value and the setting's [`Measure`]. Out: the field, changed
//! only if the value is of the right type and within the range.

use std::fmt;

/// Least and greatest allowed value, both inclusive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// True if 0 is allowed, too.
    pub or_zero: bool,
}

impl Range {
    /// All numbers between two.
    pub const fn between(min: f64, max: f64) -> Range {
        let or_zero = false;
        Range { min, max, or_zero }
    }

    /// True if `value` is a number within the range.
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value) || self.or_zero && value == 0.0
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.or_zero {
            f.write_str("0 or ")?;
        }
        write!(f, "{} to {}", self.min, self.max)
    }
}

/// What a number is measured by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// The number's unit; empty if it has none.
    pub unit: &'static str,
    /// The range of allowed values, if there is one.
    pub range: Option<Range>,
}

/// A value as given, before its setting's type is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Raw<'a> {
    /// A whole number in TOML.
    Integer(i64),
    /// A whole number in TOML beyond 64 bits, as written.
    Huge(&'a str),
    /// Any other number in TOML.
    Float(f64),
    /// A boolean in TOML.
    Bool(bool),
    /// A string in TOML.
    Text(&'a str),
    /// The text behind `key=` on the command line, which is read as the
    /// setting's type.
    Word(&'a str),
    /// Something that no setting takes.
    Other(&'static str),
}

impl Raw<'_> {
    /// The number of a length with its unit: `0.8` of `0.8 mm`.
    pub(super) fn length(&self) -> Option<&str> {
        let (Raw::Text(text) | Raw::Word(text)) = self else {
            return None;
        };
        text.trim().strip_suffix("mm").map(str::trim_end)
    }

    /// The number before letters or a degree sign: `210` of `210 °C`.
    pub(super) fn number_with_unit(&self) -> Option<&str> {
        let (Raw::Text(text) | Raw::Word(text)) = self else {
            return None;
        };
        /// The longest sign of a unit is `mm³/s`; longer ones are other words.
        const LONGEST: usize = 5;
        let of_unit = |c: char| c.is_alphabetic() || "°/²³".contains(c);
        let number = text.trim().trim_end_matches(of_unit);
        let unit = text.trim().strip_prefix(number).unwrap_or_default();
        let number = number.trim_end();
        let has_unit = (1..=LONGEST).contains(&unit.chars().count());
        (has_unit && number.parse::<f64>().is_ok()).then_some(number)
    }

    /// The value as it was given, for error messages.
    pub(super) fn describe(&self) -> String {
        match self {
            Raw::Integer(i) => i.to_string(),
            Raw::Float(x) => format!("{x:?}"),
            Raw::Bool(b) => b.to_string(),
            Raw::Text(s) => format!("{s:?}"),
            Raw::Word(s) | Raw::Huge(s) => (*s).to_owned(),
            Raw::Other(what) => (*what).to_owned(),
        }
    }
}

/// Why a value was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refused {
    /// The value is not of the setting's type, or not one of the setting's
    /// words.
    Type,
    /// The value is outside the setting's range, or not finite.
    Range,
}

/// The form of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// A form of one setting: an example, and a regular expression.
    Like(&'static str, &'static str),
    /// The path of a script.
    Script,
    /// The word `auto`.
    Auto,
    /// A length with its unit, such as `0.8 mm`.
    Length,
    /// A number with the sign for a share, such as `200%`.
    Share,
    /// Values by steps, such as `25: 50, 100: 100`.
    Steps,
    /// An expression, `expr: ...`.
    Expression,
}

impl Form {
    /// The form as lists of what may be assigned show it.
    pub(super) fn shown(self) -> &'static str {
        match self {
            Form::Like(example, _) => example,
            Form::Script => "a .rhai file",
            Form::Auto => "auto",
            Form::Length => "\"0.8 mm\"",
            Form::Share => "\"200%\"",
            Form::Steps => "\"25: 50, 100: 100\"",
            Form::Expression => "\"expr: ...\"",
        }
    }
}

/// What a setting takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ValueKind {
    Number,
    Whole,
    WholeOrAuto,
    /// A number or an expression.
    Varying,
    NumberOrAuto,
    /// A length, a share of the nozzle's diameter, or auto.
    ByNozzle,
    Switch,
    Text,
    /// Sizes of pictures.
    Sizes,
    /// A number, or text of these forms. The first text says what may be
    /// assigned.
    NumberOrText(&'static str, &'static [Form]),
    /// A whole number, or text of these forms. The first text says what may be
    /// assigned.
    WholeOrText(&'static str, &'static [Form]),
    /// True, false or a whole number.
    SwitchOrWhole,
    /// True, false or a number.
    SwitchOrNumber,
    Word(&'static [&'static str]),
    /// A word, or text of these forms.
    WordOrText(&'static [&'static str], &'static [Form]),
    /// A word, or a number.
    WordOrNumber(&'static [&'static str]),
    /// A word, or a whole number.
    WordOrWhole(&'static [&'static str]),
}

/// A field of the settings.
pub(super) trait Value {
    /// The value that a user gives.
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused>
    where
        Self: Sized;
    /// The value as TOML that `read` reads back as the same value.
    fn to_toml(&self) -> String;
    fn kind(&self) -> ValueKind;
}

impl Value for f64 {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        let parsed = match raw {
            Raw::Integer(i) => Some(i as f64),
            Raw::Float(x) => Some(x),
            Raw::Huge(_) => return Err(Refused::Range),
            Raw::Text(s) if measure.unit == "%" => percent(s),
            Raw::Word(s) if measure.unit == "%" => {
                percent(s).or(s.parse().ok())
            }
            Raw::Word(s) => s.parse().ok(),
            _ => None,
        };
        in_range(parsed.ok_or(Refused::Type)?, measure)
    }

    fn to_toml(&self) -> String {
        // Both forms print the shortest digits that read back exactly; the
        // plain one would write out all zeros of very great or small numbers,
        // past what a TOML integer holds.
        let plain = self.abs() < 1e15 && (self.abs() > 1e-5 || *self == 0.0);
        if plain {
            format!("{self}")
        } else {
            format!("{self:?}")
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::Number
    }
}

/// `25%` as 25.
fn percent(s: &str) -> Option<f64> {
    s.strip_suffix('%')?.trim_end().parse().ok()
}

fn in_range(value: f64, measure: Measure) -> Result<f64, Refused> {
    let inside = measure.range.is_none_or(|range| range.contains(value));
    if value.is_finite() && inside {
        Ok(value)
    } else {
        Err(Refused::Range)
    }
}

/// A number with 3 decimals, for messages.
pub(super) fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}

/// A number, or another choice, that may differ from place to place.
///
/// Settings keep an expression as text; the crate `isoslice-model` knows what it means.
#[derive(Clone, Debug, PartialEq)]
pub enum Varying<T = f64> {
    /// One value everywhere.
    Constant(T),
    /// A formula of x, y, z and d.
    Expression(String),
}

/// The formula of an expression, if a value is one.
pub(super) fn formula(raw: Raw<'_>) -> Option<String> {
    let (Raw::Text(text) | Raw::Word(text)) = raw else {
        return None;
    };
    let formula = text.trim().strip_prefix(<Varying>::PREFIX)?;
    Some(formula.trim().to_owned())
}

/// A formula as TOML that [`formula`] reads back.
pub(super) fn formula_to_toml(text: &str) -> String {
    format!("{} {text}", <Varying>::PREFIX).to_toml()
}

impl Varying {
    /// The beginning of an expression, which tells it from other text.
    pub(crate) const PREFIX: &str = "expr:";

    /// The number, if there is one number for all places.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Varying::Constant(value) => Some(*value),
            Varying::Expression(_) => None,
        }
    }

    /// True if the value is this number everywhere.
    pub fn is(&self, value: f64) -> bool {
        self.constant() == Some(value)
    }
}

impl<T> Varying<T> {
    /// The formula, if there is one.
    pub fn expression(&self) -> Option<&str> {
        match self {
            Varying::Constant(_) => None,
            Varying::Expression(text) => Some(text),
        }
    }
}

impl From<f64> for Varying {
    fn from(value: f64) -> Self {
        Varying::Constant(value)
    }
}

impl<T: Value + Default> Value for Varying<T> {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        Ok(match formula(raw) {
            Some(formula) => Varying::Expression(formula),
            None => Varying::Constant(T::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            Varying::Constant(value) => value.to_toml(),
            Varying::Expression(text) => formula_to_toml(text),
        }
    }

    fn kind(&self) -> ValueKind {
        match T::default().kind() {
            ValueKind::Word(words) => {
                ValueKind::WordOrText(words, &[Form::Expression])
            }
            _ => ValueKind::Varying,
        }
    }
}

impl Value for u32 {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        let whole = match raw {
            Raw::Integer(i) => Some(i.into()),
            Raw::Huge(_) => return Err(Refused::Range),
            // A number that overflows an i128 is hardly meant as one.
            Raw::Word(s) => s.parse::<i128>().ok(),
            _ => None,
        };
        let whole = whole.ok_or(Refused::Type)?;
        in_range(whole as f64, measure)?;
        u32::try_from(whole).map_err(|_| Refused::Range)
    }

    fn to_toml(&self) -> String {
        self.to_string()
    }

    fn kind(&self) -> ValueKind {
        ValueKind::Whole
    }
}

/// A value, or `auto`.
macro_rules! or_auto {
    ($value:ty, $kind:expr) => {
        impl $crate::value::Value for Option<$value> {
            fn read(
                raw: $crate::value::Raw<'_>,
                measure: $crate::value::Measure,
            ) -> Result<Self, $crate::value::Refused> {
                use $crate::value::Raw;
                Ok(match raw {
                    Raw::Text("auto") | Raw::Word("auto") => None,
                    _ => Some(<$value>::read(raw, measure)?),
                })
            }

            fn to_toml(&self) -> String {
                self.map_or_else(
                    || "\"auto\"".to_owned(),
                    |value| value.to_toml(),
                )
            }

            fn kind(&self) -> $crate::value::ValueKind {
                $kind
            }
        }
    };
}
pub(super) use or_auto;

or_auto!(u32, ValueKind::WholeOrAuto);
or_auto!(f64, ValueKind::NumberOrAuto);

impl Value for bool {
    fn read(raw: Raw<'_>, _: Measure) -> Result<Self, Refused> {
        Ok(match raw {
            Raw::Bool(b) => b,
            Raw::Word("true") => true,
            Raw::Word("false") => false,
            _ => return Err(Refused::Type),
        })
    }

    fn to_toml(&self) -> String {
        self.to_string()
    }

    fn kind(&self) -> ValueKind {
        ValueKind::Switch
    }
}

impl Value for String {
    fn read(raw: Raw<'_>, _: Measure) -> Result<Self, Refused> {
        Ok(match raw {
            Raw::Text(s) | Raw::Word(s) => s.to_owned(),
            _ => return Err(Refused::Type),
        })
    }

    fn to_toml(&self) -> String {
        let lines = self.contains('\n');
        let quotes = if lines { "\"\"\"" } else { "\"" };
        let mut text = String::from(quotes);
        if lines {
            // TOML drops a line break directly after the opening quotes.
            text.push('\n');
        }
        for c in self.chars() {
            match c {
                '"' => text.push_str("\\\""),
                '\\' => text.push_str("\\\\"),
                '\n' => text.push('\n'),
                '\t' => text.push('\t'),
                c if c.is_control() => {
                    text.push_str(&format!("\\u{:04X}", u32::from(c)));
                }
                c => text.push(c),
            }
        }
        text + quotes
    }

    fn kind(&self) -> ValueKind {
        ValueKind::Text
    }
}

/// Declares a setting's type that is one of a few words.
macro_rules! words {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident {
            $($(#[doc = $variant_doc:literal])+ $variant:ident = $word:literal,)+
        }
    )+) => {$(
        isoslice_base::named! {
            $(#[doc = $doc])+
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub enum $name {
                $($(#[doc = $variant_doc])+ $variant = $word,)+
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::ALL[0]
            }
        }

        impl $crate::value::Value for $name {
            fn read(raw: $crate::value::Raw<'_>, _: $crate::value::Measure) -> Result<Self, $crate::value::Refused> {
                use $crate::value::{Raw, Refused};
                Ok(match raw {
                    $(Raw::Text($word) | Raw::Word($word) => Self::$variant,)+
                    _ => return Err(Refused::Type),
                })
            }

            fn to_toml(&self) -> String {
                format!("\"{}\"", self.name())
            }

            fn kind(&self) -> $crate::value::ValueKind {
                $crate::value::ValueKind::Word(&[$($word),+])
            }
        }
    )+};
}
pub(super) use words;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_printed_exactly() {
        for exact in [0.1 + 0.2, 1.0 / 3.0, 5e-324, 1e-7, 123456.789, 1e300] {
            let text = exact.to_toml();
            assert_eq!(text.parse(), Ok(exact));
            let table: Result<toml::Table, _> = format!("x = {text}").parse();
            assert!(table.is_ok(), "{text} is not TOML");
        }
    }
}
