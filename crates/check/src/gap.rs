//! Moves without filament in the middle of a bead.
//!
//! In: moves, in order. Out: where the head goes on between two beads at their
//! speed and feeds nothing.
//!
//! A travel names its own speed, and so differs from such a move, unless travels
//! are as fast as beads. The speed of travels is known from the settings, and
//! from retracted travels of the same file; on the first layer it may be
//! another. Slicers that write G0 write it for all travels.
//!
//! Some files, mostly those of scripts, do everything at one speed. So nothing is
//! found until a file has shown a travel: a way that is as fast as neither the
//! bead before it nor the one after it.

use isoslice_base::units::{Mm, MmPerSec};
use isoslice_gcode_read::reader::{Move, Role};

/// Shortest way that counts, mm. Cura goes on by up to 0.25 mm at the ends of
/// lines, to wipe.
const SHORTEST: Mm = 0.5;

/// Number of speeds of travels that are kept, for the first layer and for all
/// others.
const SPEEDS: usize = 16;

/// A place at which filament is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// The line of its first move.
    pub line: u64,
    /// Its length.
    pub length: Mm,
}

/// What came before the next move.
#[derive(Debug, Default)]
pub(super) struct Gaps {
    /// Speed of travels by the settings.
    travel: MmPerSec,
    /// Speeds of retracted travels of the first layer, and of all others.
    retracted: [Vec<MmPerSec>; 2],
    /// Role and speed of the bead at whose end the head is, or was before the
    /// gap.
    bead: Option<(Role, MmPerSec)>,
    gap: Option<Gap>,
    /// Speed of the last bead, and of the last way after it.
    last: Option<MmPerSec>,
    way: Option<MmPerSec>,
    /// True if the file has shown that its travels have a speed of their own.
    shown: bool,
}

impl Gaps {
    /// Knows the speed of travels by the settings.
    pub(super) fn new(travel: MmPerSec) -> Gaps {
        Gaps {
            travel,
            ..Gaps::default()
        }
    }

    /// Takes a move; `back` is true if filament is pulled back. Returns a gap
    /// that ends with a bead.
    pub(super) fn step(&mut self, step: &Move, back: bool) -> Option<Gap> {
        let sideways = step.from.truncate() != step.to.truncate();
        if step.filament > 0.0 && sideways {
            let own = (step.role, step.speed);
            let goes_on = self.bead.replace(own) == Some(own);
            let gap = self.gap.take().filter(|gap| gap.length >= SHORTEST);
            self.look(step.speed);
            return gap.filter(|_| goes_on && self.shown);
        }
        let is_way = sideways && step.filament == 0.0;
        if is_way {
            self.way = Some(step.speed);
        }
        if is_way && back {
            self.learn(step);
        }
        let goes_on = self.bead.is_some_and(|(_, speed)| speed == step.speed);
        if is_way && !back && goes_on && !self.is_travel(step) {
            let (line, length) = (step.line, 0.0);
            let gap = self.gap.get_or_insert(Gap { line, length });
            gap.length += step.length();
        } else if step.filament != 0.0 || step.travels() {
            self.bead = None;
            self.gap = None;
        }
        None
    }

    fn is_travel(&self, step: &Move) -> bool {
        let known = &self.retracted[of(step)];
        step.rapid || step.speed == self.travel || known.contains(&step.speed)
    }

    /// Looks whether the way to a bead of some speed was a travel. The way to
    /// the first one is if it is as fast as travels are by the settings.
    fn look(&mut self, speed: MmPerSec) {
        let last = self.last.replace(speed);
        if let Some(way) = self.way.take() {
            let left = last.map_or(way == self.travel, |last| last != way);
            self.shown |= left && way != speed;
        }
    }

    /// Takes in the speed of a retracted travel.
    fn learn(&mut self, step: &Move) {
        let known = &mut self.retracted[of(step)];
        // A G0 is known without its speed, which beads may share.
        if !step.rapid && known.len() < SPEEDS && !known.contains(&step.speed) {
            known.push(step.speed);
        }
    }
}

/// The index of the layers that a move belongs to.
fn of(step: &Move) -> usize {
    usize::from(step.layer > 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_gcode_read::reader::{Event, Reader};

    /// A travel to the first bead, as fast as travels are by the settings.
    const SHOWS: &str = "G1 X1 F9000\nG1 F1200\n";

    /// The line and the length of each gap.
    fn found(text: &str) -> Vec<(u64, f64)> {
        let mut gaps = Gaps::new(150.0);
        let moves = Reader::new(text.as_bytes()).filter_map(|e| match e {
            Ok(Event::Move(step)) => Some(step),
            _ => None,
        });
        let mut back = 0.0_f64;
        moves
            .filter_map(|step| {
                back = (back - step.filament).max(0.0);
                let gap = gaps.step(&step, back > 0.1)?;
                Some((gap.line, gap.length))
            })
            .collect()
    }

    #[test]
    fn a_move_at_the_speed_of_its_bead_lays_something() {
        let with = |way: &str| {
            found(&format!(
                "M83\n{SHOWS}G1 X10 E1 F1200\n{way}G1 F1200\nG1 X50 E1\n"
            ))
        };
        assert_eq!(with("G1 X11\nG1 X13\n"), [(5, 3.0)]);
        // A climbing wall rises on its way.
        assert_eq!(with("G1 X20 Z0.1\n"), [(5, f64::hypot(10.0, 0.1))]);
        for travel in [
            "",
            "G1 X20 F3000\n",
            "G1 X20 F9000\n",
            "G0 X20\n",
            "G1 X10.2\n",
            "G1 X20\nG1 X30 F9000\n",
            "G1 X20\nG1 Z1\n",
            "G1 E-1\nG1 X20\nG1 E1\n",
        ] {
            assert!(with(travel).is_empty(), "{travel}");
        }
        let other = "M83\n;TYPE:FILL\nG1 X10 E1 F1200\nG1 X20\n;TYPE:SKIN\n\
                     G1 X30 E1\n";
        assert!(
            found(&other.replace("M83\n", &format!("M83\n{SHOWS}"))).is_empty()
        );
    }

    #[test]
    fn nothing_is_known_of_a_file_with_one_speed() {
        let square = |at: u32, first: &str| {
            format!(
                "G1 X{at} Y{at}{first}\nG1 X{to} E1\nG1 Y{to} E1\n\
                 G1 X{at} E1\nG1 Y{at} E1\n",
                to = 90 - at,
            )
        };
        let both = format!("{}{}", square(20, ""), square(30, ""));
        let layers = |speed: &str| {
            let z = |z: u32| format!("G1 Z0.{z}\n{both}");
            format!("M83\nG1 F{speed}\n{}{}{}", z(2), z(4), z(6))
        };
        assert!(found(&layers("1200")).is_empty());
        assert!(found(&layers("9000")).is_empty());
        // A speed that a way names for the beads after it is none of travels.
        let faster = format!("{}{both}", square(20, " F1800"));
        assert!(found(&format!("{}{faster}", layers("1200"))).is_empty());
        // Once a travel has another speed, all have.
        let travel = "G1 X50 Y50 F6000\nG1 X52 E1 F1200\n";
        let shown = format!("{}{travel}{}", layers("1200"), layers("1200"));
        assert_eq!(found(&shown).len(), 3);
    }

    #[test]
    fn travels_may_be_as_fast_as_beads() {
        // One travel at that speed is retracted, so that others are travels, too.
        let bead = "G1 X10 E1 F1200\nG1 X20\n";
        let text = format!(
            "M83\n{SHOWS}{bead}{bead}G1 E-1\nG1 X50\nG1 E1\n{bead}{bead}"
        );
        assert_eq!(found(&text), [(5, 10.0)]);
        let faster = text.replace("F1200", "F9000");
        assert!(found(&faster).is_empty());
    }
}
