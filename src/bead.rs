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
pub(crate) use crate::units::cross_section;
use crate::units::{Mm, Mm2};
use glam::DVec2;
use std::ops::{Deref, DerefMut};

/// What a bead is for. The G-code dialect translates it to its reader's word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Role {
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
    pub(crate) const ALL: [Role; 12] = [
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

    /// True if the edges of its beads are seen on the part.
    pub(crate) fn shows(self) -> bool {
        matches!(self, Role::OuterWall | Role::Overhang)
    }
}

/// Widths closer than this are the same, mm.
const SAME: Mm = 1e-3;

/// A line in the plane that is as wide as its bead.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Centre line, mm; a closed stroke does not repeat its first point.
    pub points: Vec<DVec2>,
    /// True if the stroke returns to its first point.
    pub closed: bool,
    /// Its width; where it varies, its mean.
    pub width: Mm,
    /// Width at each point where it varies; empty where it does not.
    pub widths: Vec<Mm>,
}

impl Stroke {
    /// A stroke of one width.
    pub(crate) fn new(points: Vec<DVec2>, closed: bool, width: Mm) -> Stroke {
        Stroke {
            points,
            closed,
            width,
            widths: Vec::new(),
        }
    }

    /// A stroke with a width for each point.
    pub(crate) fn varying(
        points: Vec<DVec2>,
        widths: Vec<Mm>,
        closed: bool,
    ) -> Stroke {
        let (mut sum, mut length) = (0.0, 0.0);
        for (p, w) in points.windows(2).zip(widths.windows(2)) {
            let step = p[0].distance(p[1]);
            sum += 0.5 * (w[0] + w[1]) * step;
            length += step;
        }
        let width = match length > 0.0 {
            true => sum / length,
            false => widths.first().copied().unwrap_or(0.0),
        };
        let same = widths.iter().all(|w| (w - width).abs() < SAME);
        Stroke {
            points,
            closed,
            width,
            widths: if same { Vec::new() } else { widths },
        }
    }

    /// Length of the centre line, with the closing segment of a closed stroke.
    pub(crate) fn length(&self) -> Mm {
        path_length(&self.points, self.closed)
    }

    /// The points in order, the first one repeated at the end of a closed
    /// stroke.
    pub(crate) fn path(&self) -> impl Iterator<Item = DVec2> + '_ {
        let back = self.closed.then(|| self.points.first().copied()).flatten();
        self.points.iter().copied().chain(back)
    }

    /// The segments of the centre line, the closing one included.
    pub(crate) fn segments(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.path().zip(self.path().skip(1))
    }

    /// The width at point `i`, counted round a closed stroke.
    pub(crate) fn width_at(&self, i: usize) -> Mm {
        let varying = self.widths.get(i % self.widths.len().max(1));
        varying.copied().unwrap_or(self.width)
    }

    /// Lets a closed stroke begin at its point `i`.
    pub(crate) fn begin_at(&mut self, i: usize) {
        if i < self.points.len() {
            self.points.rotate_left(i);
        }
        if i < self.widths.len() {
            self.widths.rotate_left(i);
        }
    }

    /// Turns the stroke round.
    pub(crate) fn reverse(&mut self) {
        self.points.reverse();
        self.widths.reverse();
    }

    /// The stroke as an open one, which ends where a closed one closes.
    pub(crate) fn opened(&self) -> Stroke {
        let mut open = self.clone();
        if self.closed {
            open.points.extend(self.points.first());
            open.widths.extend(self.widths.first());
            open.closed = false;
        }
        open
    }

    /// Goes on with an open stroke that begins where this one ends.
    pub(crate) fn append(&mut self, after: &Stroke) {
        self.points.extend(after.points.iter().skip(1));
        self.widths.extend(after.widths.iter().skip(1));
    }

    /// The part of an open stroke between two shares of its length.
    pub(crate) fn part(&self, from: f64, to: f64) -> Stroke {
        if from <= 0.0 && to >= 1.0 {
            return self.clone();
        }
        let length = self.length();
        let (from, to) = (from * length, to * length);
        let mut part = Stroke::new(Vec::new(), false, self.width);
        let mut done = 0.0;
        for i in 1..self.points.len() {
            let (a, b) = (self.points[i - 1], self.points[i]);
            let step = a.distance(b);
            let mut push = |at: Mm| {
                let t = ((at - done) / step.max(1e-12)).clamp(0.0, 1.0);
                part.points.push(a.lerp(b, t));
                if let Some(w) = self.widths.get(i - 1..=i) {
                    part.widths.push(w[0] + t * (w[1] - w[0]));
                }
            };
            let (low, high) = (from.max(done), to.min(done + step));
            if high > low {
                if done <= from {
                    push(low);
                }
                push(high);
            }
            done += step;
        }
        part
    }
}

/// By how much of itself a bead's cross-section may differ, where its width
/// varies, from what is meant over any length of a width.
const AREA: f64 = 0.03;

/// A piece no longer than this many widths may be off by twice as much at its
/// ends: the neighbouring piece is off the other way, so that over a length of
/// a width half of it is made up for.
const FEW: f64 = 2.0;

/// Pieces of constant width are not made shorter than this, mm: their ends are
/// round, and a printer sees no difference.
const SHORT: Mm = 0.05;

/// A straight piece of a bead whose width changes evenly.
struct Ramp {
    from: DVec2,
    to: DVec2,
    /// Least and greatest width.
    low: Mm,
    high: Mm,
}

/// A stretch of a bead that gets one width.
struct Run {
    points: Vec<DVec2>,
    /// Least and greatest width that is meant.
    low: Mm,
    high: Mm,
    length: Mm,
    /// Content of the stretch.
    content: Mm2,
}

impl Run {
    fn of(ramp: &Ramp) -> Run {
        let length = ramp.from.distance(ramp.to);
        Run {
            points: vec![ramp.from, ramp.to],
            low: ramp.low,
            high: ramp.high,
            length,
            content: 0.5 * (ramp.low + ramp.high) * length,
        }
    }

    /// Appends a ramp, unless some widths would then be farther from the mean
    /// than the slack of the mean.
    fn grow(&mut self, ramp: &Ramp, slack: impl Fn(Mm, Mm) -> Mm) -> bool {
        let before = (self.low, self.high, self.length, self.content);
        let length = ramp.from.distance(ramp.to);
        self.low = self.low.min(ramp.low);
        self.high = self.high.max(ramp.high);
        self.length += length;
        self.content += 0.5 * (ramp.low + ramp.high) * length;
        let mean = self.width();
        let off = (self.high - mean).max(mean - self.low);
        let fits = off <= slack(mean, self.length);
        if fits {
            self.points.push(ramp.to);
        } else {
            (self.low, self.high, self.length, self.content) = before;
        }
        fits
    }

    /// Its mean width.
    fn width(&self) -> Mm {
        match self.length > 0.0 {
            true => self.content / self.length,
            false => 0.5 * (self.low + self.high),
        }
    }
}

/// One extruded line in a layer's plane: a stroke, in print order, with a
/// height and a role. It gives access to the stroke's fields and methods as if
/// they were its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bead {
    /// What it is for.
    pub role: Role,
    /// Where it lies.
    pub stroke: Stroke,
    /// Height, which is the layer's.
    pub height: Mm,
    /// True for a wall that goes round something small, a thin pin or a hole,
    /// and stays true for what it is cut into.
    pub small: bool,
}

impl Deref for Bead {
    type Target = Stroke;

    fn deref(&self) -> &Stroke {
        &self.stroke
    }
}

impl DerefMut for Bead {
    fn deref_mut(&mut self) -> &mut Stroke {
        &mut self.stroke
    }
}

impl Bead {
    /// A bead that goes round nothing small.
    pub(crate) fn new(role: Role, stroke: Stroke, height: Mm) -> Bead {
        Bead {
            role,
            stroke,
            height,
            small: false,
        }
    }

    /// The bead as beads of constant width, each beginning where the one
    /// before ends, and as few as possible: along each the area that the bead
    /// is meant to have is within [`AREA`] of the piece's own, and, if the bead
    /// shows, its edges are within `edge`. A segment is cut only if its own
    /// ramp asks for it. Each piece has the volume that was meant.
    pub(crate) fn pieces(self, edge: Mm) -> Vec<Bead> {
        if self.widths.len() != self.points.len() {
            return vec![self];
        }
        let mut runs: Vec<Run> = Vec::new();
        for ramp in self.ramps(edge) {
            let slack = |width, length| self.slack(width, length, edge);
            if !runs.last_mut().is_some_and(|run| run.grow(&ramp, slack)) {
                runs.push(Run::of(&ramp));
            }
        }
        let piece = |run: Run| {
            let width = run.width();
            let stroke = Stroke::new(run.points, false, width);
            Bead { stroke, ..self }
        };
        runs.into_iter().map(piece).collect()
    }

    /// By how much the width of a piece may differ from what is meant.
    fn slack(&self, width: Mm, length: Mm, edge: Mm) -> Mm {
        let share = match length <= FEW * width {
            true => 2.0 * AREA,
            false => AREA,
        };
        let area = share * cross_section(width, self.height) / self.height;
        match self.role.shows() {
            true => area.min(2.0 * edge),
            false => area,
        }
    }

    /// The segments, cut where their ramp asks for it.
    fn ramps(&self, edge: Mm) -> impl Iterator<Item = Ramp> + '_ {
        self.segments().enumerate().flat_map(move |(i, (a, b))| {
            let (from, to) = (self.width_at(i), self.width_at(i + 1));
            let change = (to - from).abs();
            let length = a.distance(b);
            let slack = self.slack(from.min(to), length, edge);
            let count =
                (0.5 * change / slack).min(length / SHORT).ceil().max(1.0);
            let place = move |k: usize| match k as f64 / count {
                t if t < 1.0 => (a.lerp(b, t), from + t * (to - from)),
                _ => (b, to),
            };
            (0..count as usize).map(move |k| {
                let ((from, w0), (to, w1)) = (place(k), place(k + 1));
                // The wide end of a steep ramp lies under the round end of the
                // piece beside it: the narrow end matters.
                let (low, high) = (w0.min(w1), w0.max(w1));
                let high = high.min(low + 2.0 * slack);
                Ramp {
                    from,
                    to,
                    low,
                    high,
                }
            })
        })
    }
    /// Cross-section of the bead.
    pub(crate) fn area(&self) -> Mm2 {
        cross_section(self.width, self.height)
    }
}

/// Distance between the centre lines of two beads side by side that fill the
/// plane between them: the mean width less h·(1 − π/4).
pub(crate) fn spacing(width_a: Mm, width_b: Mm, height: Mm) -> Mm {
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
        let mut b = Bead::new(
            Role::OuterWall,
            Stroke::new(
                vec![
                    DVec2::new(0.0, 0.0),
                    DVec2::new(3.0, 0.0),
                    DVec2::new(3.0, 4.0),
                ],
                true,
                0.4,
            ),
            0.2,
        );
        assert_eq!(b.length(), 12.0);
        assert_eq!(b.path().count(), 4);
        b.widths = vec![0.4, 0.4, 0.6];
        let pieces = b.clone().pieces(0.008);
        let widths: Vec<f64> = pieces.iter().map(|p| p.width).collect();
        // 3 mm of 0.4, then 4 mm to 0.6 and 5 mm back, each in steps of about
        // twice 3 % of a cross-section of 0.07 mm².
        // The topmost two are one.
        assert_eq!(widths.len(), 1 + 10 + 10 - 1, "{widths:?}");
        assert_eq!(widths[0], 0.4);
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].points.last(), Some(&pair[1].points[0]));
            assert!((pair[0].width - pair[1].width).abs() < 0.0215);
        }
        let length: f64 = pieces.iter().map(|p| p.length()).sum();
        assert!((length - 12.0).abs() < 1e-12);
        let content: f64 = pieces.iter().map(|p| p.width * p.length()).sum();
        assert!((content - (3.0 * 0.4 + 9.0 * 0.5)).abs() < 1e-12);
        // The edges of a bead that does not show do not matter, and pieces of
        // twice a width may be off by twice as much.
        assert!(b.clone().pieces(0.001).len() > 80);
        b.role = Role::GapFill;
        let hidden = b.clone().pieces(0.001).len();
        assert!((10..=11).contains(&hidden), "{hidden}");
        b.closed = false;
        assert_eq!(b.length(), 7.0);
        assert_eq!(b.path().count(), 3);
    }

    #[test]
    fn a_part_of_a_stroke_keeps_its_widths() {
        let points = vec![DVec2::ZERO, DVec2::X * 4.0, DVec2::X * 10.0];
        let mut path = Stroke::new(points, false, 0.5);
        path.widths = vec![0.4, 0.4, 0.7];
        let part = path.part(0.2, 0.6);
        let x: Vec<f64> = part.points.iter().map(|p| p.x).collect();
        assert_eq!(x, [2.0, 4.0, 6.0]);
        assert!((part.widths[2] - 0.5).abs() < 1e-9);
        assert_eq!(path.part(0.0, 1.0), path);
    }
}
