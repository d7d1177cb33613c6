//! How much solid material lies behind a face: a number of layers, or a
//! thickness.

use super::by_nozzle::ByNozzle;
use super::value::{Form, Measure, Range, Raw, Refused, Value, ValueKind};
use isoslice_base::units::Mm;

/// The solid layers behind a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shell {
    /// A number of layers.
    Layers(u32),
    /// As many layers as this thickness takes.
    Thickness(ByNozzle),
}

/// A thickness of solid material.
const THICKNESS: Measure = Measure {
    unit: "mm",
    range: Some(Range::between(0.0, 1000.0)),
};

impl Shell {
    /// As thick as usual.
    pub(super) const AUTO: Shell = Shell::Thickness(ByNozzle::Auto);

    /// The number of layers, if it was given.
    pub fn layers(self) -> Option<u32> {
        match self {
            Shell::Layers(count) => Some(count),
            Shell::Thickness(_) => None,
        }
    }

    /// The thickness with a nozzle of this diameter; `usual` is what `auto`
    /// stands for.
    pub(super) fn thickness(self, nozzle: Mm, usual: Mm) -> Mm {
        match self {
            Shell::Layers(_) => usual,
            Shell::Thickness(thickness) => thickness.with(nozzle, usual),
        }
    }
}

impl Value for Shell {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        Ok(match (raw, raw.length()) {
            (_, Some(length)) if length.trim().parse::<f64>().is_ok() => {
                Shell::Thickness(Value::read(Raw::Word(length), THICKNESS)?)
            }
            (Raw::Text(text) | Raw::Word(text), None)
                if text == "auto" || text.ends_with('%') =>
            {
                Shell::Thickness(Value::read(raw, THICKNESS)?)
            }
            _ => Shell::Layers(Value::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            Shell::Layers(count) => count.to_toml(),
            Shell::Thickness(ByNozzle::Length(length)) => {
                format!("{} mm", length.to_toml()).to_toml()
            }
            Shell::Thickness(thickness) => thickness.to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::WholeOrText(
            "auto, a number of layers, 0 to 50000, or a thickness, such as \
             \"0.8 mm\", or \"200%\" of the nozzle",
            &[Form::Auto, Form::Length, Form::Share],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Builder;

    #[test]
    fn layers_and_thicknesses_are_read_and_written() {
        for (given, written) in [
            ("5", Some("5")),
            ("0", Some("0")),
            ("0.8 mm", Some("\"0.8 mm\"")),
            ("1mm", Some("\"1 mm\"")),
            ("150%", Some("\"150%\"")),
            ("auto", Some("\"auto\"")),
            ("0.8", None),
            ("-1", None),
            ("2000 mm", None),
            ("x mm", None),
        ] {
            let mut builder = Builder::new();
            let taken = builder.set(&format!("top_layers={given}"));
            let found = builder.settings().top_layers.to_toml();
            assert_eq!(taken.is_ok(), written.is_some(), "{given}");
            assert_eq!(found, written.unwrap_or("\"auto\""), "{given}");
        }
    }
}
