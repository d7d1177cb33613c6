//! The fingerprint that the files of ranges of one print have in common.
//!
//! In: the plate on its rafts, and the planned layers. Out: short words that are
//! equal if the plates and layers are equal, and that otherwise differ except in
//! one case of 10³⁸.

use super::SliceError;
use isoslice_gcode::{Fingerprint, version};
use isoslice_layer::infill::script_words;
use isoslice_plate::Plate;
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::{Infill, Key, keys};
use ring::digest::{Context, SHA256};

/// Number of bytes of a digest that are written.
const BYTES: usize = 16;

/// The fingerprint of a plate; `spans` are the layers of each part.
pub(super) fn fingerprint<'s>(
    plate: &Plate,
    spans: impl Iterator<Item = &'s [LayerSpan]>,
) -> Result<Fingerprint, SliceError> {
    let mut model = Digest::new();
    let mut settings = Digest::new();
    model.add(&plate.name);
    let of_plate = &plate.settings;
    settings.add_settings(|key| key.get(of_plate), &of_plate.infill)?;
    for part in &plate.parts {
        part.model
            .words(&mut |word| model.add(word))
            .map_err(|e| SliceError::of(plate, part, e.into()))?;
        for place in &part.places {
            let at = place.shift;
            model.add(&place.name);
            model.add(&format!("{:?} {:?}", at.x, at.y));
        }
        let own = &part.settings;
        settings
            .add_settings(|key| key.get(own), &own.infill)
            .map_err(|e| SliceError::of(plate, part, e))?;
    }
    let mut layers = Digest::new();
    for spans in spans {
        layers.add(&format!("{}", spans.len()));
        for span in spans {
            layers.add(&format!("{:?} {:?}", span.bottom, span.top));
        }
    }
    Ok(Fingerprint {
        version: version(),
        model: model.word(),
        settings: settings.word(),
        layers: layers.word(),
    })
}

/// Words that are turned into a digest.
struct Digest(Context);

impl Digest {
    fn new() -> Self {
        Digest(Context::new(&SHA256))
    }

    /// Adds a word. Its length keeps it apart from the next word.
    fn add(&mut self, word: &str) {
        self.0.update(&(word.len() as u64).to_le_bytes());
        self.0.update(word.as_bytes());
    }

    /// Adds the values of settings, and the text of the file that the infill
    /// names.
    fn add_settings(
        &mut self,
        value: impl Fn(&Key) -> String,
        infill: &Infill,
    ) -> Result<(), SliceError> {
        for key in keys() {
            self.add(key.name);
            self.add(&value(key));
        }
        script_words(infill, &mut |word| self.add(word))?;
        Ok(())
    }

    fn word(self) -> String {
        let digest = self.0.finish();
        let bytes = digest.as_ref().iter().take(BYTES);
        bytes.map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_model::{Placement, placed};
    use isoslice_settings::testing::settings;

    fn of(text: &str, assignments: &[&str], top: f64) -> Fingerprint {
        let model = placed(text, &Placement::default());
        let plate = Plate::of(&model, &settings(assignments));
        let spans = [LayerSpan {
            index: 0,
            bottom: 0.0,
            top,
        }];
        fingerprint(&plate, [&spans[..]].into_iter()).unwrap()
    }

    #[test]
    fn what_makes_other_text_makes_another_fingerprint() {
        let ball = "sqrt(x^2 + y^2 + z^2) - 3";
        let first = of(ball, &[], 0.2);
        assert_eq!(first, of("sqrt(x^2+y^2+z^2)  -  3.0", &[], 0.2));
        let model = of("sqrt(x^2 + y^2 + z^2) - 3.0001", &[], 0.2);
        // This is the next number above 3 in single precision.
        let close = of("sqrt(x^2 + y^2 + z^2) - 3.0000002", &[], 0.2);
        let swapped = of("sqrt(x^2 + y^2 - -z^2) - 3", &[], 0.2);
        for other in [model, close, swapped] {
            assert_ne!(other.model, first.model);
            assert_eq!(other.settings, first.settings);
        }
        let other = of(ball, &["walls=5"], 0.2);
        assert_eq!(other.model, first.model);
        assert_ne!(other.settings, first.settings);
        let other = of(ball, &[], 0.1 + 0.2);
        assert_eq!(other.settings, first.settings);
        assert_ne!(other.layers, first.layers);
    }
}
