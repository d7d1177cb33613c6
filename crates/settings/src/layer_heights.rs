//! How high layers are.

use super::by_nozzle::ByNozzle;
use super::pair::without;
use super::value::{
    Form, Measure, Range, Raw, Refused, Value, ValueKind, formula,
    formula_to_toml,
};

/// The heights of the layers above the first.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerHeights {
    /// All layers above the first are alike.
    Uniform,
    /// As high as this greatest step on the surface allows.
    Adaptive(ByNozzle),
    /// A formula of z.
    Expression(String),
}

const ADAPTIVE: &str = "adaptive";

/// Steps on the surface that may be asked for.
const STEP_ERROR: Measure = Measure {
    unit: "mm",
    range: Some(Range::between(0.001, 2.0)),
};

/// Shares of the nozzle's diameter that may be a step, %.
const SHARES: std::ops::RangeInclusive<f64> = 0.5..=500.0;

impl Value for LayerHeights {
    fn read(raw: Raw<'_>, _: Measure) -> Result<Self, Refused> {
        Ok(match (formula(raw), raw) {
            (Some(formula), _) => LayerHeights::Expression(formula),
            (None, Raw::Text("uniform") | Raw::Word("uniform")) => {
                LayerHeights::Uniform
            }
            (None, Raw::Text(text) | Raw::Word(text)) => {
                let step = text.strip_prefix(ADAPTIVE).ok_or(Refused::Type)?;
                let step = without("mm", step)
                    .filter(|step| !step.ends_with('%'))
                    .unwrap_or(step.trim());
                let step = match step {
                    "" => ByNozzle::Auto,
                    step => Value::read(Raw::Word(step), STEP_ERROR)?,
                };
                if matches!(step, ByNozzle::Share(s) if !SHARES.contains(&s)) {
                    return Err(Refused::Range);
                }
                LayerHeights::Adaptive(step)
            }
            _ => return Err(Refused::Type),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            LayerHeights::Uniform => String::from("\"uniform\""),
            LayerHeights::Adaptive(ByNozzle::Auto) => format!("{ADAPTIVE:?}"),
            LayerHeights::Adaptive(ByNozzle::Length(step)) => {
                format!("\"{ADAPTIVE} {} mm\"", step.to_toml())
            }
            LayerHeights::Adaptive(ByNozzle::Share(step)) => {
                format!("\"{ADAPTIVE} {}%\"", step.to_toml())
            }
            LayerHeights::Expression(text) => formula_to_toml(text),
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::WordOrText(
            &["uniform", ADAPTIVE],
            &[
                Form::Like(
                    "\"adaptive 0.1 mm\" with 0.001 to 2 mm",
                    "^adaptive\\s*[0-9.eE+-]+\\s*(mm|%)?$",
                ),
                Form::Expression,
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Builder;

    #[test]
    fn heights_are_read_written_and_refused() {
        for (given, written) in [
            ("uniform", Some("\"uniform\"")),
            ("adaptive", Some("\"adaptive\"")),
            ("adaptive 0.1", Some("\"adaptive 0.1 mm\"")),
            ("adaptive 0.1 mm", Some("\"adaptive 0.1 mm\"")),
            ("adaptive 25%", Some("\"adaptive 25%\"")),
            ("expr: 0.1 + z/50", Some("\"expr: 0.1 + z/50\"")),
            ("adaptive 3 mm", None),
            ("adaptive 0.1 mmmm", None),
            ("adaptive 25% mm", None),
            ("adaptive 0%", None),
            ("adaptive x", None),
            ("0.2", None),
        ] {
            let mut builder = Builder::new();
            let taken = builder.set(&format!("layer_heights={given}"));
            assert_eq!(taken.is_ok(), written.is_some(), "{given}");
            let found = builder.settings().layer_heights.to_toml();
            assert_eq!(found, written.unwrap_or("\"uniform\""), "{given}");
        }
    }
}
