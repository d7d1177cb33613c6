//! The bead: one extruded line, the only currency after the regions.
//!
//! ```text
//!        ┌───────── width ─────────┐
//!      ╭─────────────────────────────╮ ┬
//!      │   rectangle with round ends │ height
//!      ╰─────────────────────────────╯ ┴
//! ```
//!
//! A bead squeezed between nozzle and layer below has a cross-section of
//! (w − h)·h + π(h/2)². Neighbours overlap at their round ends so that they
//! fill the plane: their spacing is w − h·(1 − π/4), at which area per
//! spacing is exactly h.

use crate::plane::path_length;
pub use crate::units::cross_section;
use crate::units::{Mm, Mm2};
use glam::DVec2;

/// What a bead is for. The G-code dialect translates it to its reader's word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Loop around the part on the lowest layers, not touching it.
    Skirt,
    /// Loops on the bed beside the part's first layer that hold it down.
    Brim,
    /// The wall one sees.
    OuterWall,
    /// Walls behind the outer wall.
    InnerWall,
    /// A wall, or a part of one, that hangs over the layer below.
    Overhang,
    /// A bead as wide as the gap between walls that it fills.
    GapFill,
    /// Sparse fill of covered areas.
    SparseInfill,
    /// Solid area that neither faces the air above nor below directly.
    InternalSkin,
    /// Solid area facing upwards.
    TopSkin,
    /// Solid area facing downwards.
    BottomSkin,
    /// Solid area over nothing, its lines held at both ends.
    Bridge,
    /// A pass over a finished top that makes it smooth.
    Ironing,
}

impl Role {
    /// Every role, in the order summaries list them.
    pub const ALL: [Role; 12] = [
        Role::OuterWall,
        Role::InnerWall,
        Role::Overhang,
        Role::GapFill,
        Role::TopSkin,
        Role::BottomSkin,
        Role::InternalSkin,
        Role::Bridge,
        Role::Ironing,
        Role::SparseInfill,
        Role::Skirt,
        Role::Brim,
    ];

    /// Plain name for summaries, pictures and tests.
    pub fn name(self) -> &'static str {
        match self {
            Role::Skirt => "skirt",
            Role::Brim => "brim",
            Role::OuterWall => "outer wall",
            Role::InnerWall => "inner wall",
            Role::Overhang => "overhang",
            Role::GapFill => "gap fill",
            Role::SparseInfill => "sparse infill",
            Role::InternalSkin => "internal skin",
            Role::TopSkin => "top skin",
            Role::BottomSkin => "bottom skin",
            Role::Bridge => "bridge",
            Role::Ironing => "ironing",
        }
    }
}

/// One extruded line in a layer's plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Bead {
    /// What it is for.
    pub role: Role,
    /// Centre line, mm, in print order; a closed bead does not repeat its
    /// first point.
    pub points: Vec<DVec2>,
    /// True if the bead returns to its first point.
    pub closed: bool,
    /// Width of the squeezed bead; where it varies, its mean.
    pub width: Mm,
    /// Width at each point where it varies; empty where it does not.
    pub widths: Vec<Mm>,
    /// Height, which is the layer's.
    pub height: Mm,
    /// True for a wall that goes round something small, a thin pin or a hole,
    /// and stays true for what it is cut into.
    pub small: bool,
}

impl Bead {
    /// Length of the centre line, with the closing segment of a closed bead.
    pub fn length(&self) -> Mm {
        path_length(&self.points, self.closed)
    }

    /// The segments of the centre line, the closing one included.
    pub fn segments(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.path().zip(self.path().skip(1))
    }

    /// Lets a closed bead begin at its point `i`.
    pub fn begin_at(&mut self, i: usize) {
        if i < self.points.len() {
            self.points.rotate_left(i);
        }
        if i < self.widths.len() {
            self.widths.rotate_left(i);
        }
    }

    /// Turns the bead round.
    pub fn reverse(&mut self) {
        self.points.reverse();
        self.widths.reverse();
    }

    /// The bead as beads of constant width, each beginning where the one
    /// before ends. Where the width changes between two points the segment is
    /// cut so short that no piece is more than 10 µm wider to a side than the
    /// bead is meant to be there.
    pub fn pieces(self) -> Vec<Bead> {
        /// Widths closer than this are the same, mm.
        const SAME: Mm = 1e-3;
        /// By how much the width may change along a piece, whose own is the
        /// mean: a quarter of it to a side.
        const CHANGE: Mm = 0.04;
        /// Pieces are not made shorter than this, mm: their ends are round,
        /// and a printer sees no difference.
        const SHORT: Mm = 0.05;
        if self.widths.len() != self.points.len() {
            return vec![self];
        }
        let ends: Vec<DVec2> = self.path().collect();
        let n = self.points.len();
        let mut pieces: Vec<Bead> = Vec::new();
        for (i, pair) in ends.windows(2).enumerate() {
            let (from, to) = (self.widths[i], self.widths[(i + 1) % n]);
            let cuts = ((to - from).abs() / CHANGE)
                .min(pair[0].distance(pair[1]) / SHORT)
                .ceil()
                .max(1.0);
            for k in 0..cuts as usize {
                let at = |k: usize| match k as f64 / cuts {
                    t if t < 1.0 => pair[0].lerp(pair[1], t),
                    _ => pair[1],
                };
                // Its wide end lies under the round end of the piece beside
                // it: the narrow end matters, if the piece had to be long.
                let change = ((to - from).abs() / cuts).min(CHANGE);
                let narrow = match to > from {
                    true => k as f64,
                    false => (k + 1) as f64,
                };
                let width = from + narrow / cuts * (to - from) + 0.5 * change;
                match pieces.last_mut() {
                    Some(last) if (last.width - width).abs() < SAME => {
                        last.points.push(at(k + 1));
                    }
                    _ => pieces.push(Bead {
                        points: vec![at(k), at(k + 1)],
                        width,
                        widths: Vec::new(),
                        closed: false,
                        ..self
                    }),
                }
            }
        }
        pieces
    }

    /// Cross-section of the bead.
    pub fn area(&self) -> Mm2 {
        cross_section(self.width, self.height)
    }

    /// The points in print order, the first one repeated at the end of a
    /// closed bead.
    pub fn path(&self) -> impl Iterator<Item = DVec2> + '_ {
        let back = self.closed.then(|| self.points.first().copied()).flatten();
        self.points.iter().copied().chain(back)
    }
}

/// Distance between the centre lines of two beads side by side that fill the
/// plane between them: the mean width less h·(1 − π/4).
pub fn spacing(width_a: Mm, width_b: Mm, height: Mm) -> Mm {
    0.5 * (width_a + width_b) - height * (1.0 - std::f64::consts::FRAC_PI_4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beads_at_their_spacing_fill_the_plane() {
        let (w, h) = (0.45, 0.2);
        assert!((cross_section(w, h) - spacing(w, w, h) * h).abs() < 1e-12);
    }

    #[test]
    fn a_closed_bead_counts_its_closing_side() {
        let mut b = Bead {
            role: Role::OuterWall,
            points: vec![
                DVec2::new(0.0, 0.0),
                DVec2::new(3.0, 0.0),
                DVec2::new(3.0, 4.0),
            ],
            closed: true,
            width: 0.4,
            widths: Vec::new(),
            height: 0.2,
            small: false,
        };
        assert_eq!(b.length(), 12.0);
        assert_eq!(b.path().count(), 4);
        b.widths = vec![0.4, 0.4, 0.6];
        let pieces = b.clone().pieces();
        let widths: Vec<f64> = pieces.iter().map(|p| p.width).collect();
        // 3 mm of 0.4, then 4 mm to 0.6 and 5 mm back, five steps each.
        assert_eq!(widths.len(), 1 + 5 + 4, "{widths:?}");
        assert_eq!(widths[0], 0.4);
        let steps = widths[1..].windows(2).map(|w| (w[1] - w[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.0401, "{widths:?}");
        let length: f64 = pieces.iter().map(Bead::length).sum();
        assert!((length - 12.0).abs() < 1e-12);
        b.closed = false;
        assert_eq!(b.length(), 7.0);
        assert_eq!(b.path().count(), 3);
    }
}
