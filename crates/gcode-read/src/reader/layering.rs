//! Where layers begin, and how wide and high a bead is.
//!
//! In: what comments say, and moves that print. Out: a layer's number, and a
//! bead's width and height. In a file that marks its layers the marks count,
//! from the first one on. In any other file a layer begins where something is
//! printed at another height.

use super::comments::Tag;
use glam::DVec3;
use isoslice_base::units::{Mm, Mm2};

/// Heights that differ by less belong to one layer.
const SAME: Mm = 1e-3;
/// Rise that counts as a layer in a spiral, which has no layers of its own.
const SPIRAL: Mm = 0.2;
/// Heights a layer can have.
const HEIGHTS: std::ops::RangeInclusive<Mm> = 0.01..=2.0;
/// Height of a bead if the file does not tell it.
const USUAL: Mm = 0.2;
/// Greatest width of a bead. A wider one is a purge on the spot.
const WIDEST: Mm = 3.0;

/// The layer that is being printed.
#[derive(Clone, Debug)]
pub(super) struct Layering {
    /// Number of the layer, from 1; 0 before the first.
    pub number: u32,
    marked: bool,
    /// Height at which the layer was first printed; none before that.
    z: Option<Mm>,
    /// Height of the layer before it.
    below: Mm,
    height: Mm,
    /// Height at which printing ended last.
    last: Mm,
    said_width: Option<Mm>,
    said_height: Option<Mm>,
}

impl Layering {
    pub(super) fn new() -> Self {
        Self {
            number: 0,
            marked: false,
            z: None,
            last: 0.0,
            below: 0.0,
            height: USUAL,
            said_width: None,
            said_height: None,
        }
    }

    /// Takes in a comment. True if a layer begins.
    pub(super) fn tag(&mut self, tag: Tag) -> bool {
        match tag {
            Tag::Width(width) => self.said_width = Some(width),
            Tag::Height(height) => self.said_height = Some(height),
            Tag::Layer if !self.marked => {
                // What was printed before the first mark is no layer.
                self.marked = true;
                self.number = 1;
                self.z = None;
                self.below = 0.0;
                return true;
            }
            // Several marks of one layer count as one.
            Tag::Layer if self.z.is_some() => {
                self.next();
                return true;
            }
            _ => {}
        }
        false
    }

    /// Takes in a move that prints. True if a layer begins with it.
    pub(super) fn print(&mut self, from: DVec3, to: DVec3) -> bool {
        // In a spiral the height changes while it prints.
        let lifted = (from.z - self.last).abs() > SAME;
        self.last = to.z;
        // Walls that interlock lie at two heights of one layer, so that only a
        // layer's height downwards is another part. If the lower ones come first,
        // the higher ones seem to be a layer of half the height, and the print
        // goes back from there.
        let leaves = |z: Mm| {
            let goes_back = (to.z - self.below).abs() < SAME;
            let half = goes_back && to.z > z - USUAL + SAME;
            let down = to.z < z - self.height + SAME && !half;
            to.z > z + SAME || down
        };
        let begins = !self.marked
            && match self.z {
                None => true,
                Some(z) if lifted => leaves(z),
                Some(z) => from.z > z + SPIRAL - SAME,
            };
        if begins {
            self.next();
        }
        if self.z.is_none() {
            self.z = Some(to.z);
            let rise = to.z - self.below;
            if HEIGHTS.contains(&rise) {
                self.height = rise;
            } else if self.number <= 1 && HEIGHTS.contains(&to.z) {
                self.height = to.z;
            }
        }
        begins
    }

    fn next(&mut self) {
        self.number += 1;
        self.below = self.z.take().unwrap_or(self.below);
    }

    /// Height of a bead printed now.
    pub(super) fn height(&self) -> Mm {
        self.said_height.unwrap_or(self.height)
    }

    /// Width of a bead printed now, whose cross-section is `area`.
    pub(super) fn width(&self, area: Mm2) -> Mm {
        self.said_width
            .unwrap_or_else(|| bead_width(area, self.height()))
    }
}

/// Width of a bead with this cross-section: (w − h)·h + π(h/2)² solved for w.
fn bead_width(area: Mm2, height: Mm) -> Mm {
    use std::f64::consts::FRAC_PI_4;
    let width = area / height + height * (1.0 - FRAC_PI_4);
    width.clamp(0.02, WIDEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(z: f64) -> DVec3 {
        DVec3::new(1.0, 2.0, z)
    }

    #[test]
    fn layers_without_marks_follow_the_height_of_prints() {
        let mut l = Layering::new();
        let numbers: Vec<u32> = [0.3, 0.3, 0.5, 0.7, 0.7, 0.3]
            .map(|z| {
                l.print(at(z), at(z));
                l.number
            })
            .into();
        assert_eq!(numbers, [1, 1, 2, 3, 3, 4]);
        assert!((l.height() - 0.2).abs() < 1e-9);
    }

    #[test]
    fn a_layer_has_lower_beads_beside_higher_ones() {
        let mut l = Layering::new();
        let numbers: Vec<u32> = [0.3, 0.2, 0.3, 0.5, 0.4, 0.2, 0.4]
            .map(|z| {
                l.print(at(z), at(z));
                l.number
            })
            .into();
        assert_eq!(numbers, [1, 1, 1, 2, 2, 3, 4]);
    }

    #[test]
    fn lower_beads_may_come_first() {
        let mut l = Layering::new();
        let numbers: Vec<u32> = [0.2, 0.3, 0.4, 0.3, 0.4, 0.5, 0.6, 0.5, 0.6]
            .map(|z| {
                l.print(at(z), at(z));
                l.number
            })
            .into();
        assert_eq!(numbers, [1, 2, 3, 3, 3, 4, 5, 5, 5]);
        // A whole layer down is another part.
        let mut l = Layering::new();
        for z in [0.2, 0.4, 0.2] {
            l.print(at(z), at(z));
        }
        assert_eq!(l.number, 3);
    }

    #[test]
    fn marks_win_and_what_was_before_them_is_no_layer() {
        let mut l = Layering::new();
        l.print(at(0.4), at(0.4));
        assert_eq!(l.number, 1);
        assert!(l.tag(Tag::Layer));
        assert!(!l.tag(Tag::Layer));
        assert!(!l.print(at(0.3), at(0.3)));
        assert!(!l.print(at(0.9), at(0.9)));
        assert_eq!((l.number, l.height()), (1, 0.3));
        assert!(l.tag(Tag::Layer));
        l.print(at(0.5), at(0.5));
        assert_eq!(l.number, 2);
        assert!((l.height() - 0.2).abs() < 1e-9);
    }

    #[test]
    fn a_spiral_is_cut_into_layers() {
        let mut l = Layering::new();
        for i in 0..1000 {
            let z = 0.2 + 0.001 * f64::from(i);
            l.print(at(z), at(z + 0.001));
        }
        assert_eq!(l.number, 5);
    }

    #[test]
    fn widths_come_from_comments_or_from_the_filament() {
        let mut l = Layering::new();
        l.print(at(0.2), at(0.2));
        let bead = (0.45 - 0.2) * 0.2 + std::f64::consts::PI * 0.01;
        assert!((l.width(bead) - 0.45).abs() < 1e-9);
        l.tag(Tag::Width(0.6));
        assert_eq!(l.width(bead), 0.6);
    }
}
