//! Where layers begin, and how wide and high a bead is.
//!
//! In: what comments say, and moves that print. Out: a layer's number, and a
//! bead's width and height. In a file that marks its layers the marks count,
//! from the first one on. In any other file a layer begins where something is
//! printed at another height.

use super::comments::Tag;
use super::role::Role;
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
/// Share of the height of the layer before below which the first rise of a layer is
/// half a layer, in a file whose walls interlock.
const HALF: f64 = 0.75;
/// Greatest width of a bead. A wider one is a purge on the spot.
const WIDEST: Mm = 3.0;

/// The layer that is being printed.
#[derive(Clone, Debug, Default)]
pub(super) struct Layering {
    /// Number of the layer, from 1; 0 before the first.
    pub number: u32,
    marked: bool,
    /// Height at which the layer was first printed; none before that.
    z: Option<Mm>,
    /// True if the layer is marked, and only supports were printed in it.
    supports: bool,
    /// Height of what the first layer lies on.
    base: Mm,
    /// Heights of the layer before it, and of the one before that.
    below: Mm,
    below_that: Mm,
    height: Mm,
    /// True from the first bead on that lies half a layer lower than others.
    interlocked: bool,
    /// Height at which printing ended last.
    last: Mm,
    said_width: Option<Mm>,
    said_height: Option<Mm>,
}

impl Layering {
    pub(super) fn new() -> Self {
        Self {
            height: USUAL,
            ..Self::default()
        }
    }

    /// Sets the height of what the first layer lies on.
    pub(super) fn set_base(&mut self, base: Mm) {
        (self.base, self.below) = (base, base);
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
                self.below = self.base;
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
    pub(super) fn print(&mut self, from: DVec3, to: DVec3, role: Role) -> bool {
        // In a spiral the height changes while it prints.
        let lifted = (from.z - self.last).abs() > SAME;
        self.last = to.z;
        let begins = !self.marked
            && match self.z {
                None => true,
                Some(z) if lifted => self.leaves(z, to.z),
                Some(z) => from.z > z + SPIRAL - SAME,
            };
        if begins {
            self.next();
        }
        // Supports have heights of their own, which say nothing of the part's.
        let support = role.is_support();
        if self.z.is_none() || (self.supports && !support) {
            self.start(to.z);
            self.supports = support && self.marked;
        }
        begins
    }

    /// True if a print at height `to` is no part of the layer that was first printed
    /// at height `z`.
    ///
    /// Walls that interlock lie at two heights of one layer, so that only a layer's
    /// height downwards is another part.
    fn leaves(&mut self, z: Mm, to: Mm) -> bool {
        if to > z + SAME {
            return true;
        }
        // A rise from which the print goes back to the height below was no layer.
        // Parts of two layers that are printed one by one go back to the bed.
        if is_same(to, self.below) && self.below_that > 0.0 {
            self.below = self.below_that;
            self.height = z - self.below;
        }
        self.interlocked |= is_same(to, 0.5 * (self.below + z));
        let down = to < z - self.height + SAME;
        // The next part begins on the bed. Its first layer is at most twice as high.
        if down && to < 2.0 * self.height + SAME {
            self.z = Some(0.0);
        }
        down
    }

    /// Begins to print a layer at a height.
    fn start(&mut self, z: Mm) {
        let rise = z - self.below;
        // The lower walls of a layer come first.
        let half = self.interlocked && rise < HALF * self.height;
        let rise = if half { 2.0 * rise } else { rise };
        self.z = Some(if half { self.below + rise } else { z });
        if HEIGHTS.contains(&rise) {
            self.height = rise;
        } else if self.number <= 1 && HEIGHTS.contains(&z) {
            self.height = z;
        }
    }

    fn next(&mut self) {
        self.number += 1;
        self.below_that = self.below;
        self.below = self.z.take().unwrap_or(self.below);
    }

    /// Height of a bead printed now.
    pub(super) fn height(&self) -> Mm {
        self.said_height.unwrap_or(self.height)
    }

    /// True if comments say how wide beads printed now are.
    pub(super) fn says_width(&self) -> bool {
        self.said_width.is_some()
    }

    /// Width of a bead printed now, whose cross-section is `area`.
    pub(super) fn width(&self, area: Mm2) -> Mm {
        self.said_width
            .unwrap_or_else(|| bead_width(area, self.height()))
    }
}

fn is_same(a: Mm, b: Mm) -> bool {
    (a - b).abs() < SAME
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

    fn print(l: &mut Layering, z: f64) -> bool {
        l.print(at(z), at(z), Role::OuterWall)
    }

    #[test]
    fn layers_without_marks_follow_the_height_of_prints() {
        let mut l = Layering::new();
        let numbers: Vec<u32> = [0.3, 0.3, 0.5, 0.7, 0.7, 0.3]
            .map(|z| {
                print(&mut l, z);
                l.number
            })
            .into();
        assert_eq!(numbers, [1, 1, 2, 3, 3, 4]);
        assert!((l.height() - 0.3).abs() < 1e-9);
    }

    #[test]
    fn a_layer_has_lower_beads_beside_higher_ones() {
        let mut l = Layering::new();
        let numbers: Vec<u32> = [0.3, 0.2, 0.3, 0.5, 0.4, 0.2, 0.4]
            .map(|z| {
                print(&mut l, z);
                l.number
            })
            .into();
        assert_eq!(numbers, [1, 1, 1, 2, 2, 3, 4]);
    }

    /// The numbers of the layers of prints at these heights.
    fn numbers(heights: &[f64]) -> Vec<u32> {
        let mut l = Layering::new();
        let number = |&z: &f64| {
            print(&mut l, z);
            l.number
        };
        heights.iter().map(number).collect()
    }

    #[test]
    fn lower_beads_may_come_first() {
        // What went before is known when the print goes back.
        let heights = [0.2, 0.3, 0.4, 0.3, 0.4, 0.5, 0.6, 0.5, 0.6];
        assert_eq!(numbers(&heights), [1, 2, 3, 3, 3, 4, 4, 4, 4]);
        let thick = [0.4, 0.2, 0.4, 0.6, 0.8, 0.6, 0.8, 1.0, 1.2];
        assert_eq!(numbers(&thick), [1, 1, 1, 2, 2, 2, 2, 3, 3]);
        // The first layer is higher than the others.
        let fine = [0.2, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.35, 0.5, 0.6];
        assert_eq!(numbers(&fine), [1, 1, 1, 2, 2, 3, 3, 3, 4, 5]);
    }

    #[test]
    fn parts_that_are_printed_one_by_one_begin_on_the_bed() {
        for height in [0.05, 0.1, 0.2, 0.3] {
            for layers in [2, 3, 5] {
                let part = (1..=layers).map(|k| height * f64::from(k));
                let parts: Vec<f64> =
                    part.cycle().take(4 * layers as usize).collect();
                let all: Vec<u32> = (1..=4 * layers).collect();
                assert_eq!(numbers(&parts), all, "{height} {layers}");
            }
        }
    }

    #[test]
    fn marks_win_and_what_was_before_them_is_no_layer() {
        let mut l = Layering::new();
        print(&mut l, 0.4);
        assert_eq!(l.number, 1);
        assert!(l.tag(Tag::Layer));
        assert!(!l.tag(Tag::Layer));
        assert!(!print(&mut l, 0.3));
        assert!(!print(&mut l, 0.9));
        assert_eq!((l.number, l.height()), (1, 0.3));
        assert!(l.tag(Tag::Layer));
        print(&mut l, 0.5);
        assert_eq!(l.number, 2);
        assert!((l.height() - 0.2).abs() < 1e-9);
    }

    #[test]
    fn supports_between_the_layers_of_the_part_say_nothing_of_its_heights() {
        let mut l = Layering::new();
        let mut heights = Vec::new();
        for layer in 1..=9 {
            let z = 0.25 * f64::from(layer);
            l.tag(Tag::Layer);
            for support in [z - 0.2, z - 0.05, z + 0.1] {
                l.print(at(support), at(support), Role::Support);
            }
            print(&mut l, z);
            heights.push((100.0 * l.height()).round());
        }
        assert_eq!((l.number, heights), (9, vec![25.0; 9]));
    }

    #[test]
    fn a_file_that_continues_a_part_lies_on_its_base() {
        for marked in [false, true] {
            let mut l = Layering::new();
            l.set_base(1.6);
            if marked {
                l.tag(Tag::Layer);
            }
            print(&mut l, 1.8);
            assert!((l.height() - 0.2).abs() < 1e-9, "{marked}");
        }
    }

    #[test]
    fn a_spiral_is_cut_into_layers() {
        let mut l = Layering::new();
        for i in 0..1000 {
            let z = 0.2 + 0.001 * f64::from(i);
            l.print(at(z), at(z + 0.001), Role::Unknown);
        }
        assert_eq!(l.number, 5);
    }

    #[test]
    fn widths_come_from_comments_or_from_the_filament() {
        let mut l = Layering::new();
        print(&mut l, 0.2);
        let bead = (0.45 - 0.2) * 0.2 + std::f64::consts::PI * 0.01;
        assert!((l.width(bead) - 0.45).abs() < 1e-9);
        l.tag(Tag::Width(0.6));
        assert_eq!(l.width(bead), 0.6);
    }
}
