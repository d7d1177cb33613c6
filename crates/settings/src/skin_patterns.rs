//! The pattern of each kind of skin.

use super::SkinPattern;
use super::value::{Form, Measure, Raw, Refused, Value, ValueKind};
use std::collections::BTreeSet;

/// The patterns of skin, by which way it faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SkinPatterns {
    /// Skin that faces upwards.
    pub top: SkinPattern,
    /// Skin that faces downwards.
    pub bottom: SkinPattern,
    /// Skin that the layers above and below cover.
    pub internal: SkinPattern,
}

impl SkinPatterns {
    /// One pattern for all skin.
    pub fn all(pattern: SkinPattern) -> SkinPatterns {
        SkinPatterns {
            top: pattern,
            bottom: pattern,
            internal: pattern,
        }
    }

    fn of_face(&mut self, face: &str) -> Option<&mut SkinPattern> {
        match face {
            "top" => Some(&mut self.top),
            "bottom" => Some(&mut self.bottom),
            "internal" => Some(&mut self.internal),
            _ => None,
        }
    }
}

impl Value for SkinPatterns {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        let (Raw::Text(text) | Raw::Word(text)) = raw else {
            return Err(Refused::Type);
        };
        if !text.contains(':') {
            return Ok(SkinPatterns::all(Value::read(raw, measure)?));
        }
        let mut patterns = SkinPatterns::default();
        let mut faces = BTreeSet::new();
        for part in text.split(',') {
            let (face, word) = part.split_once(':').ok_or(Refused::Type)?;
            let pattern = patterns.of_face(face.trim());
            let pattern = pattern.filter(|_| faces.insert(face.trim()));
            let pattern = pattern.ok_or(Refused::Type)?;
            *pattern = Value::read(Raw::Word(word.trim()), measure)?;
        }
        Ok(patterns)
    }

    fn to_toml(&self) -> String {
        if *self == SkinPatterns::all(self.top) {
            return self.top.to_toml();
        }
        let all = [
            ("top", self.top),
            ("bottom", self.bottom),
            ("internal", self.internal),
        ];
        let other = all
            .into_iter()
            .filter(|(_, pattern)| *pattern != SkinPattern::default())
            .map(|(face, pattern)| format!("{face}: {}", pattern.name()));
        other.collect::<Vec<_>>().join(", ").to_toml()
    }

    fn kind(&self) -> ValueKind {
        match SkinPattern::default().kind() {
            ValueKind::Word(words) => ValueKind::WordOrText(
                words,
                &[Form::Like(
                    "\"top: concentric, bottom: lines\"",
                    "^\\s*(top|bottom|internal)\\s*:",
                )],
            ),
            kind => kind,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Builder;

    #[test]
    fn patterns_are_read_written_and_refused() {
        for (given, written) in [
            ("concentric", Some("\"concentric\"")),
            ("top: concentric", Some("\"top: concentric\"")),
            (
                "internal:concentric , top: unordered-lines",
                Some("\"top: unordered-lines, internal: concentric\""),
            ),
            ("bottom: lines", Some("\"lines\"")),
            ("side: lines", None),
            ("top: concentric, top: lines", None),
            ("top: waves", None),
            ("top: lines, concentric", None),
        ] {
            let mut builder = Builder::new();
            let taken = builder.set(&format!("skin_pattern={given}"));
            assert_eq!(taken.is_ok(), written.is_some(), "{given}");
            let found = builder.settings().skin_pattern.to_toml();
            assert_eq!(found, written.unwrap_or("\"lines\""), "{given}");
        }
    }
}
