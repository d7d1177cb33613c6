//! Beads that are laid twice at one place and height.
//!
//! In: beads, in order. Out: where a stretch of beads begins that repeats beads
//! from before, one by one.
//!
//! No slicer lays a whole bead exactly over another one at the same height, so a
//! stretch of a few millimetres is enough to tell. The ends of a scarf lie over one
//! another, and are one bead together. Beads are known by the
//! micrometre at both ends. Only the last [`KEPT`] beads, or up to twice as many, are
//! kept, so that memory stays bounded: 131,072 beads are more than nearly all
//! layers have.

use isoslice_base::random::mix;
use isoslice_base::units::{Mm, Mm2};
use isoslice_gcode_read::reader::Move;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Number of beads after which those of the generation before are forgotten.
const KEPT: usize = 1 << 17;

/// Length of beads in a row that are known from before which is no chance, mm.
const STRETCH: Mm = 5.0;

/// Cross-section of two beads together that is too much for one, as a share of
/// that of a usual bead.
const MORE_THAN_ONE: f64 = 1.5;

/// Share of the greater one of two cross-sections that the lesser one has at least if
/// both beads are the same one. The two halves of a scarf are as alike only where they
/// cross, on a ninth of its length.
const ALIKE: f64 = 0.8;

/// The cross-section of each bead. The keys are mixed bits already.
type Keys = HashMap<u64, Mm2, BuildHasherDefault<Same>>;

/// A hash that is the number itself.
#[derive(Clone, Copy, Debug, Default)]
struct Same(u64);

impl Hasher for Same {
    fn write_u64(&mut self, key: u64) {
        self.0 = key;
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = mix(self.0 ^ u64::from(byte));
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

/// The beads that were laid last.
#[derive(Debug, Default)]
pub(super) struct Again {
    now: Keys,
    before: Keys,
    /// The line on which the stretch of repeated beads begins, and its length so
    /// far.
    stretch: Option<(u64, Mm)>,
}

impl Again {
    /// Takes a bead with a cross-section of `area`, where a usual one
    /// has `usual`. Returns the line of the first bead of a stretch that is now long
    /// enough to tell.
    pub(super) fn bead(
        &mut self,
        step: &Move,
        area: Mm2,
        usual: Mm2,
    ) -> Option<u64> {
        let key = key(step);
        let before = self.now.insert(key, area);
        let before = before.or_else(|| self.before.get(&key).copied());
        if self.now.len() >= KEPT {
            self.before = std::mem::take(&mut self.now);
        }
        let most = MORE_THAN_ONE * usual;
        let known = before.is_some_and(|before| {
            let alike = before.min(area) >= ALIKE * before.max(area);
            alike && before + area > most
        });
        if !known {
            self.stretch = None;
            return None;
        }
        let (line, length) = self.stretch.get_or_insert((step.line, 0.0));
        let short = *length < STRETCH;
        *length += step.length();
        (short && *length >= STRETCH).then_some(*line)
    }
}

/// What a bead is known by: its ends, in micrometres.
fn key(step: &Move) -> u64 {
    let ends = [step.from, step.to];
    let ends = ends.map(|p| (p * 1000.0).round().to_array().map(|v| v as i64));
    let all = ends.as_flattened().iter();
    all.fold(0, |key, &number| mix(key ^ number as u64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_gcode_read::reader::{Event, Reader};

    /// The lines on which stretches begin that repeat others, if each bead has
    /// a cross-section of `area`.
    fn with(area: f64, text: &str) -> Vec<u64> {
        let mut again = Again::default();
        let moves = Reader::new(text.as_bytes()).filter_map(|e| match e {
            Ok(Event::Move(step)) if step.prints() => Some(step),
            _ => None,
        });
        moves
            .filter_map(|step| again.bead(&step, area, 0.4 * 0.2))
            .collect()
    }

    fn found(text: &str) -> Vec<u64> {
        with(0.08, text)
    }

    #[test]
    fn beads_in_a_row_that_were_laid_before_are_told_once() {
        let square =
            "G1 X10 Y0\nG1 X10 Y10 E1\nG1 X0 E1\nG1 Y0 E1\nG1 X10 E1\n";
        let twice = format!("M83\nG1 Z0.2\n{square}{square}");
        assert_eq!(found(&twice), [9]);
        // The ends of a scarf are one bead together.
        assert!(with(0.04, &twice).is_empty());
        // So are the halves of one that is wide: one fades out as the other fades in.
        let mut again = Again::default();
        for round in 0..2 {
            for k in 0..20 {
                let text = format!("M83\nG1 X{k}\nG1 X{} E1\n", k + 1);
                let share = (f64::from(k) + 0.5) / 20.0;
                let share = if round == 0 { share } else { 1.0 - share };
                for event in Reader::new(text.as_bytes()) {
                    if let Ok(Event::Move(step)) = event
                        && step.prints()
                    {
                        let told = again.bead(&step, 0.25 * share, 0.08);
                        assert_eq!(told, None, "{k}");
                    }
                }
            }
        }
        // One layer higher, and the other way round, other beads lie.
        let higher = format!("M83\nG1 Z0.2\n{square}G1 Z0.4\n{square}");
        assert!(found(&higher).is_empty());
        let back = "M83\nG1 Z0.2\nG1 X10 E1\nG1 X0 E1\n";
        assert!(found(back).is_empty());
        // Short stretches are chance.
        let short = "M83\nG1 Z0.2\nG1 X4 E1\nG1 X0\nG1 X4 E1\nG1 X9 E1\n";
        assert!(found(short).is_empty());
    }

    #[test]
    fn memory_has_a_bound() {
        let mut again = Again::default();
        for k in 0..3 * KEPT as i32 {
            let text = format!("M83\nG1 X{k} E1\n");
            let step = Reader::new(text.as_bytes()).find_map(|e| match e {
                Ok(Event::Move(step)) => Some(step),
                _ => None,
            });
            if let Some(step) = step {
                again.bead(&step, 0.08, 0.08);
            }
        }
        assert!(again.now.len() + again.before.len() <= 2 * KEPT);
    }
}
