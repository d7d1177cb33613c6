//! Beads of varying width as pieces of constant width, which is what a move
//! can lay.
//!
//! In: a bead. Out: beads, each beginning where the one before ends.
//!
//! Guarantees: the cross-sections that are meant along a piece differ by no more
//! than twice [`AREA`] of the least of them, twice that in pieces of up to
//! [`FEW`] widths, and the edges of a bead that shows by no more than twice
//! `edge`. The piece has their mean, so that no volume is lost. A ramp may be so
//! steep that a piece would be shorter than [`shortest`]: a bead that shows is
//! then hardly wider than the ramp's narrow end. A piece ends where the next
//! width would break this, and nowhere else.

use crate::bead::{Bead, Role, Stroke, cross_section};
use crate::units::{Mm, Mm2};
use glam::DVec2;

/// By how much of itself a bead's cross-section may differ, where its width
/// varies, from what is meant over any length of a width.
const AREA: f64 = 0.03;

/// A piece no longer than this many widths may be off by twice as much at its
/// ends: the neighbouring piece is off the other way, so that over a length of
/// a width half of it is made up for.
const FEW: f64 = 2.0;

/// By how much a piece of a steep ramp is wider than its narrow end, mm, if the
/// bead shows: 10 µm on each side.
const STEEP: Mm = 0.02;

/// Pieces of a role are not made shorter than this, mm. Of beads that show it is
/// what their round ends hide. Of others it is what no printer can follow: at
/// 40 mm/s 0.15 mm are 4 ms, and the pressure in a nozzle takes longer to change.
pub(super) fn shortest(role: Role) -> Mm {
    match role.shows() {
        true => 0.05,
        false => 0.15,
    }
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
    /// A run that begins at a point with a width.
    fn new(at: DVec2, width: Mm) -> Run {
        Run {
            points: vec![at],
            low: width,
            high: width,
            length: 0.0,
            content: 0.0,
        }
    }

    /// Goes on to a point on a ramp from one width to another.
    fn push(&mut self, to: DVec2, from_width: Mm, to_width: Mm) {
        let length = self.points.last().map_or(0.0, |p| p.distance(to));
        self.points.push(to);
        self.low = self.low.min(to_width);
        self.high = self.high.max(to_width);
        self.length += length;
        self.content += 0.5 * (from_width + to_width) * length;
    }

    /// The share of a ramp of this length that the run has room for.
    fn room(
        &self,
        length: Mm,
        [from, to]: [Mm; 2],
        slack: impl Fn(Mm, Mm) -> Mm,
    ) -> f64 {
        let span = |slack: Mm| match to > from {
            true => self.low + 2.0 * slack - from,
            false => from - self.high + 2.0 * slack,
        };
        let change = (to - from).abs();
        let within = |slack: Mm| {
            let (least, most) =
                (self.high - 2.0 * slack, self.low + 2.0 * slack);
            if from < least || from > most {
                0.0
            } else if change > 0.0 {
                span(slack) / change
            } else {
                1.0
            }
        };
        let share = within(slack(self.low, self.length + length));
        if share >= 1.0 || self.length + length <= 0.0 {
            return share;
        }
        // A part of the ramp may be short enough for more slack.
        let few = FEW * self.low - self.length;
        let short = within(slack(self.low, 0.0)).min(few / length);
        share.max(short).max(0.0)
    }

    /// Its mean width.
    fn width(&self) -> Mm {
        match self.length > 0.0 {
            true => self.content / self.length,
            false => 0.5 * (self.low + self.high),
        }
    }
}

/// The bead in pieces of constant width. `edge` is how far the edges of a bead
/// that shows may be off.
pub(crate) fn pieces(bead: Bead, edge: Mm) -> Vec<Bead> {
    if bead.widths.len() != bead.points.len() || bead.points.is_empty() {
        return vec![bead];
    }
    let slack = |width: Mm, length: Mm| {
        // A share of next to nothing would be too little to count.
        let width = width.max(0.5 * bead.width);
        let share = match length <= FEW * width {
            true => 2.0 * AREA,
            false => AREA,
        };
        let area = share * cross_section(width, bead.height) / bead.height;
        match bead.role.shows() {
            true => area.min(2.0 * edge),
            false => area,
        }
    };
    let short = shortest(bead.role);
    let mut runs = Vec::new();
    let mut run = Run::new(bead.points[0], bead.widths[0]);
    for (i, (from, to)) in bead.segments().enumerate() {
        let widths = [bead.width_at(i), bead.width_at(i + 1)];
        let whole = from.distance(to);
        if whole <= 0.0 {
            // The width jumps.
            if run.length <= 0.0 {
                run = Run::new(from, widths[1]);
            }
            continue;
        }
        let mut done = 0.0;
        loop {
            let here = widths[0] + done * (widths[1] - widths[0]);
            let length = (1.0 - done) * whole;
            let mut room = run.room(length, [here, widths[1]], slack);
            if run.length <= 0.0 {
                room = room.max(short / length);
            }
            // A length that is no number cannot be cut.
            if room >= 1.0 || !length.is_finite() {
                run.push(to, here, widths[1]);
                break;
            }
            // A cut a hair behind a point is one at the point.
            let next = match room * length < short && run.length > 0.0 {
                true => done,
                false => done + room * (1.0 - done),
            };
            let width = widths[0] + next * (widths[1] - widths[0]);
            let at = from.lerp(to, next);
            if next > done {
                run.push(at, here, width);
            }
            let before = std::mem::replace(&mut run, Run::new(at, width));
            runs.push(before);
            done = next;
        }
    }
    runs.push(run);
    let piece = |run: Run| {
        let mut width = run.width();
        if bead.role.shows() {
            // Of a steep ramp the wide end lies under the round end of the
            // piece beside it: the narrow end matters.
            let slack = slack(run.low, run.length).max(STEEP);
            width = width.min(run.low + slack);
        }
        let stroke = Stroke::new(run.points, false, width);
        Bead { stroke, ..bead }
    };
    let all = runs.into_iter().filter(|run| run.points.len() > 1);
    all.map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle of 3, 4 and 5 mm that is 0.4 mm wide along its first side and
    /// grows to 0.6 mm and shrinks again along the others.
    fn bead(role: Role) -> Bead {
        let points = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)];
        let points = points.map(DVec2::from).to_vec();
        let mut stroke = Stroke::new(points, true, 0.5);
        stroke.widths = vec![0.4, 0.4, 0.6];
        Bead::new(role, stroke, 0.2)
    }

    #[test]
    fn pieces_are_as_long_as_the_width_allows() {
        for (role, edge, least, most) in [
            (Role::OuterWall, 0.008, 10, 21),
            (Role::OuterWall, 0.001, 95, 105),
            (Role::InnerWall, 0.001, 10, 21),
        ] {
            let pieces = pieces(bead(role), edge);
            let n = pieces.len();
            assert!((least..=most).contains(&n), "{role:?} {edge}: {n}");
            for pair in pieces.windows(2) {
                assert_eq!(pair[0].points.last(), Some(&pair[1].points[0]));
                // Each piece spans no more than four edges, two to a side.
                let step = (pair[0].width - pair[1].width).abs();
                let limit = if role.shows() { 8.0 * edge } else { 1.0 };
                assert!(step <= limit.min(0.07) + 1e-9, "{step}");
            }
            let length: f64 = pieces.iter().map(|p| p.length()).sum();
            assert!((length - 12.0).abs() < 1e-9);
            let content: f64 =
                pieces.iter().map(|p| p.width * p.length()).sum();
            let meant = 3.0 * 0.4 + 9.0 * 0.5;
            assert!((content / meant - 1.0).abs() < 0.003, "{content}");
        }
    }

    #[test]
    fn steep_ramps_have_no_tiny_pieces() {
        let mut steep = bead(Role::OuterWall);
        steep.closed = false;
        steep.points = [(0.0, 0.0), (1.0, 0.0), (1.02, 0.0)]
            .map(DVec2::from)
            .to_vec();
        let pieces = pieces(steep, 0.005);
        assert_eq!(pieces.len(), 2);
        // No wider than the narrow end allows.
        assert!(pieces[1].width < 0.4201, "{}", pieces[1].width);
    }

    #[test]
    fn constant_and_odd_beads_stay() {
        let mut even = bead(Role::GapFill);
        even.widths = vec![0.4; 3];
        assert_eq!(pieces(even.clone(), 0.005).len(), 1);
        even.widths.clear();
        assert_eq!(pieces(even.clone(), 0.005), [even.clone()]);
        even.points[1] = DVec2::NAN;
        even.widths = vec![0.4, f64::NAN, 0.5];
        assert!(!pieces(even, 0.005).is_empty());
    }
}
