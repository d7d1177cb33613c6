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

use crate::units::{Mm, Mm2};
use glam::DVec2;

/// What a bead is for. The G-code dialect translates it to its reader's word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Loop around the part on the first layer, not touching it.
    Skirt,
    /// The wall one sees.
    OuterWall,
    /// Walls behind the outer wall.
    InnerWall,
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
}

impl Role {
    /// Every role, in the order summaries list them.
    pub const ALL: [Role; 8] = [
        Role::OuterWall,
        Role::InnerWall,
        Role::GapFill,
        Role::TopSkin,
        Role::BottomSkin,
        Role::InternalSkin,
        Role::SparseInfill,
        Role::Skirt,
    ];

    /// Plain name for summaries, pictures and tests.
    pub fn name(self) -> &'static str {
        match self {
            Role::Skirt => "skirt",
            Role::OuterWall => "outer wall",
            Role::InnerWall => "inner wall",
            Role::GapFill => "gap fill",
            Role::SparseInfill => "sparse infill",
            Role::InternalSkin => "internal skin",
            Role::TopSkin => "top skin",
            Role::BottomSkin => "bottom skin",
        }
    }

    /// True for the two kinds of wall.
    pub fn is_wall(self) -> bool {
        matches!(self, Role::OuterWall | Role::InnerWall)
    }

    /// True for the solid kinds of fill.
    pub fn is_skin(self) -> bool {
        matches!(self, Role::TopSkin | Role::BottomSkin | Role::InternalSkin)
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
}

impl Bead {
    /// Length of the centre line, with the closing segment of a closed bead.
    pub fn length(&self) -> Mm {
        let open: f64 =
            self.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        match (self.closed, self.points.first(), self.points.last()) {
            (true, Some(a), Some(b)) => open + b.distance(*a),
            _ => open,
        }
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
    /// before ends. Between two points the width is the mean of theirs.
    pub fn pieces(self) -> Vec<Bead> {
        /// Widths closer than this are the same, mm.
        const SAME: Mm = 1e-3;
        if self.widths.len() != self.points.len() {
            return vec![self];
        }
        let ends: Vec<DVec2> = self.path().collect();
        let n = self.points.len();
        let mut pieces: Vec<Bead> = Vec::new();
        for (i, pair) in ends.windows(2).enumerate() {
            let width = 0.5 * (self.widths[i] + self.widths[(i + 1) % n]);
            match pieces.last_mut() {
                Some(last) if (last.width - width).abs() < SAME => {
                    last.points.push(pair[1]);
                }
                _ => pieces.push(Bead {
                    points: pair.to_vec(),
                    width,
                    widths: Vec::new(),
                    closed: false,
                    ..self
                }),
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

/// Cross-section (w − h)·h + π(h/2)² of a bead `width` wide and `height` high.
/// A bead narrower than it is high is taken as an ellipse, π/4·w·h.
pub fn cross_section(width: Mm, height: Mm) -> Mm2 {
    use std::f64::consts::FRAC_PI_4;
    if width <= height {
        return FRAC_PI_4 * width * height;
    }
    (width - height) * height + FRAC_PI_4 * height * height
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
        };
        assert_eq!(b.length(), 12.0);
        assert_eq!(b.path().count(), 4);
        b.widths = vec![0.4, 0.4, 0.6];
        let pieces = b.clone().pieces();
        let widths: Vec<f64> = pieces.iter().map(|p| p.width).collect();
        assert_eq!(widths, [0.4, 0.5]);
        let length: f64 = pieces.iter().map(Bead::length).sum();
        assert_eq!(length, 12.0);
        b.closed = false;
        assert_eq!(b.length(), 7.0);
        assert_eq!(b.path().count(), 3);
    }
}
