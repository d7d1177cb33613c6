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
//! then hardly wider than the ramp's narrow end. Pieces end at the bead's points
//! where that is possible: each cut elsewhere is a move more.

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
/// 60 mm/s 0.3 mm are 5 ms, and the pressure in a nozzle takes longer to change.
pub(super) fn shortest(role: Role) -> Mm {
    match role.shows() {
        true => 0.03,
        false => 0.3,
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
    /// A straight ramp from a place and a width to others.
    fn ramp([a, b]: [DVec2; 2], [from, to]: [Mm; 2]) -> Run {
        let length = a.distance(b);
        Run {
            points: vec![a, b],
            low: from.min(to),
            high: from.max(to),
            length,
            content: 0.5 * (from + to) * length,
        }
    }

    /// Goes on in a run that begins where this one ends. What is too short for
    /// a width of its own has no say if the other one is not.
    fn extend(&mut self, other: Run, short: Mm) {
        let low = self.low.min(other.low);
        let high = self.high.max(other.high);
        (self.low, self.high) = match self.length < short {
            true if other.length >= short => (other.low, other.high),
            _ => (low, high),
        };
        self.length += other.length;
        self.content += other.content;
        self.points.extend(other.points.into_iter().skip(1));
    }

    /// True if what follows has to have the same width, as this is too short
    /// for one of its own, or may have it, as it differs little enough.
    fn takes(
        &self,
        other: &Run,
        short: Mm,
        slack: impl Fn(Mm, Mm) -> Mm,
    ) -> bool {
        let low = self.low.min(other.low);
        let high = self.high.max(other.high);
        let length = self.length + other.length;
        high - low <= 2.0 * slack(low, length) || self.length < short
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
    let mut runs: Vec<Run> = Vec::new();
    for (i, (a, b)) in bead.segments().enumerate() {
        let widths = [bead.width_at(i), bead.width_at(i + 1)];
        let ramp = Run::ramp([a, b], widths);
        // Without a length the width jumps.
        if ramp.length <= 0.0 {
            continue;
        }
        let most = (ramp.length / short).floor();
        let parts = |slack: Mm| {
            let all = (ramp.high - ramp.low) / (2.0 * slack);
            all.ceil().min(most).max(1.0)
        };
        // Parts may be so short that they have more slack.
        let mut count = parts(slack(ramp.low, 0.0));
        if ramp.length / count > FEW * ramp.low {
            count = parts(slack(ramp.low, ramp.length));
        }
        // Of what is no number there is one part.
        for k in 0..count as usize {
            let [s, t] = [k, k + 1].map(|k| k as f64 / count);
            let width = |t: f64| widths[0] + t * (widths[1] - widths[0]);
            let part =
                Run::ramp([a.lerp(b, s), a.lerp(b, t)], [width(s), width(t)]);
            match runs.last_mut() {
                Some(run) if run.takes(&part, short, slack) => {
                    run.extend(part, short);
                }
                _ => runs.push(part),
            }
        }
    }
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
    runs.into_iter().map(piece).collect()
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
