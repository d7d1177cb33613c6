//! Settings that are a number, and a second one behind a word if it is not as
//! usual: `0.2`, or `0.2 mm over 3 layers`.

use super::value::{
    Form, Measure, Range, Raw, Refused, Value, ValueKind, or_auto,
};
use isoslice_base::units::{Mm, Percent};

/// The number in a text that ends in this unit.
pub(super) fn without<'a>(unit: &str, text: &'a str) -> Option<&'a str> {
    Some(text.trim().strip_suffix(unit)?.trim_end())
}

/// Declares the types.
macro_rules! pairs {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident is $kind:expr;
            $(#[doc = $first_doc:literal])+
            $first:ident: Mm,
            $word:literal
            $(#[doc = $second_doc:literal])+
            $second:ident: $ty:ident
                = $usual:literal $unit:literal, in $min:literal..=$max:literal;
    )+) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name {
            $(#[doc = $first_doc])+
            pub $first: Mm,
            $(#[doc = $second_doc])+
            pub $second: $ty,
        }

        impl From<Mm> for $name {
            fn from($first: Mm) -> Self {
                Self { $first, $second: $usual }
            }
        }

        impl Value for $name {
            fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
                let (first, second) = match raw {
                    Raw::Text(text) | Raw::Word(text) => {
                        match text.split_once($word) {
                            Some((first, second)) => (first, Some(second)),
                            None => (text, None),
                        }
                    }
                    _ => ("", None),
                };
                let first = match without("mm", first) {
                    Some(length) => Raw::Word(length),
                    None if second.is_some() => Raw::Word(first.trim()),
                    None => raw,
                };
                let mut pair = Self::from(Mm::read(first, measure)?);
                if let Some(second) = second {
                    let number =
                        without($unit, second).unwrap_or(second.trim());
                    let range = Range::between($min as f64, $max as f64);
                    let measure = Measure { unit: $unit, range: Some(range) };
                    pair.$second = Value::read(Raw::Word(number), measure)?;
                }
                Ok(pair)
            }

            fn to_toml(&self) -> String {
                let first = self.$first.to_toml();
                if self.$second == $usual {
                    return first;
                }
                let second = self.$second.to_toml();
                let gap = if $unit == "%" { "" } else { " " };
                format!("\"{first} mm {} {second}{gap}{}\"", $word, $unit)
            }

            fn kind(&self) -> ValueKind {
                $kind
            }
        }
    )+};
}

/// Two numbers with a word between them, as a pattern.
const PAIR: &str =
    "^\\s*[0-9.eE+-]+\\s*(mm)?\\s*(over|from|above)\\s*[0-9.eE+-]+";

pairs! {
    /// How the first layers are drawn in.
    ElephantFoot is ValueKind::NumberOrText(
        "0 to 2 mm, or with the number of layers, 1 to 1000, such as \"0.2 mm \
         over 3 layers\"",
        &[Form::Length, Form::Like("\"0.2 mm over 3 layers\"", PAIR)],
    );
        /// How much the first layer is drawn in on all sides.
        drawn: Mm,
        "over"
        /// Number of layers, from the bed, that are drawn in.
        layers: u32 = 1 "layers", in 1..=1000;

    /// How the ends of an outer wall overlap.
    Scarf is ValueKind::NumberOrText(
        "0 to 200 mm, or with the height at which it begins, 0 to 100% of its \
         layer's, such as \"20 mm from 10%\"",
        &[Form::Length, Form::Like("\"20 mm from 10%\"", PAIR)],
    );
        /// Length over which the flow grows and shrinks.
        length: Mm,
        "from"
        /// Height at which the scarf begins, as a share of its layer's height.
        start: Percent = 100.0 "%", in 0.0..=100.0;

    /// The room that the printer's head needs around the nozzle.
    HeadClearance is ValueKind::NumberOrText("", &[]);
        /// Radius of the circle around the nozzle that holds the head.
        radius: Mm,
        "above"
        /// Height above the nozzle's tip up to which there is nothing but the
        /// nozzle.
        free_below: Mm = 0.0 "mm", in 0.0..=500.0;
}

or_auto!(
    HeadClearance,
    ValueKind::NumberOrText(
        "auto, 1 to 500 mm, or with the height at which the head begins, 0 to \
         500 mm, such as \"45 mm above 7 mm\"",
        &[
            Form::Auto,
            Form::Length,
            Form::Like("\"45 mm above 7 mm\"", PAIR)
        ],
    )
);

#[cfg(test)]
mod tests {
    use crate::{Builder, keys};

    #[test]
    fn completions_know_auto() {
        for name in ["printer.head_clearance_radius", "top_layers"] {
            let key = keys().iter().find(|key| key.name == name).unwrap();
            assert_eq!(key.some_words(), ["auto"], "{name}");
        }
    }

    #[test]
    fn pairs_are_read_written_and_refused() {
        for (name, given, written) in [
            ("elephant_foot", "0.2", Some("0.2")),
            ("elephant_foot", "0.2 mm", Some("0.2")),
            ("elephant_foot", "0.2 over 1", Some("0.2")),
            (
                "elephant_foot",
                "0.2 mm over 3 layers",
                Some("\"0.2 mm over 3 layers\""),
            ),
            (
                "elephant_foot",
                ".2over 3",
                Some("\"0.2 mm over 3 layers\""),
            ),
            ("elephant_foot", "0.2 over 0", None),
            ("elephant_foot", "0.2 over 1.5 layers", None),
            ("elephant_foot", "3 over 1", None),
            ("elephant_foot", "over 3", None),
            ("elephant_foot", "0.2 from 3", None),
            ("seam_scarf", "20 from 10", Some("\"20 mm from 10%\"")),
            ("seam_scarf", "20 mm from 100%", Some("20")),
            ("seam_scarf", "20 from 101%", None),
            ("printer.head_clearance_radius", "auto", Some("\"auto\"")),
            ("printer.head_clearance_radius", "45", Some("45")),
            (
                "printer.head_clearance_radius",
                "45 above 7.5",
                Some("\"45 mm above 7.5 mm\""),
            ),
            ("printer.head_clearance_radius", "0.5 above 7", None),
        ] {
            let key = keys().iter().find(|key| key.name == name).unwrap();
            for assignment in [
                format!("{name}={given}"),
                // In a file texts have quotes.
                format!("{name}={given:?}"),
            ] {
                let mut builder = Builder::new();
                let taken = builder.set(&assignment);
                let bare = given.parse::<f64>().is_ok();
                if bare && assignment.ends_with('"') {
                    continue;
                }
                assert_eq!(taken.is_ok(), written.is_some(), "{assignment}");
                let found = key.get(builder.settings());
                let usual = key.default();
                assert_eq!(found, written.unwrap_or(&usual), "{assignment}");
                builder.set(&format!("{name}={}", found)).unwrap();
                assert_eq!(key.get(builder.settings()), found);
            }
        }
    }
}
