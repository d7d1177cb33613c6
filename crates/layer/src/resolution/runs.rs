//! Beads of varying width as pieces of constant width, which is what a move
//! can lay.
//!
//! In: a bead. Out: beads, each beginning where the one before ends.
//!
//! Guarantees:
//! - along a piece of a bead that shows, the cross-sections that are meant
//!   differ by no more than twice [`AREA`] of the least of them, twice that in
//!   pieces of up to [`FEW`] widths, and the edges by no more than twice
//!   `edge`. A ramp may be so steep that a piece would be shorter than
//!   [`shortest`]: its edges are then off by more;
//! - the cross-sections of other beads may differ by more in pieces shorter
//!   than four times [`evened`]. Where they change evenly, what is laid up to
//!   any place of such a piece is off by no more than [`AREA`] of what that
//!   length holds;
//! - each piece has the mean of what is meant, so that no volume is lost. On a
//!   very steep ramp a piece that shows is wider than its narrow end by no more
//!   than [`STEEP`];
//! - the middle of a piece is within `path` of the bead's.
//!
//! Each line is chosen as long as its width and the path permit together. It
//! would otherwise be cut once for its width and once for its path.

use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::{Bead, Role, Stroke, cross_section};
use isoslice_planar::simplify::simplify_path;

/// By how much of itself a bead's cross-section may differ, where its width
/// varies, from what is meant over any length of a width.
const AREA: f64 = 0.03;

/// A piece no longer than this many widths may be off by twice as much at its
/// ends: the neighbouring piece is off the other way, and so is its own other
/// half, so that most of it is made up for within a width or two.
const FEW: f64 = 3.0;

/// A length over which what is laid too early or too late along a bead of this
/// role may be made up for, mm. It counts for beads that do not show. 3 mm take
/// 50 ms at 60 mm/s, and the pressure in a nozzle takes longer to change.
///
/// Inner walls lie against an outer wall, and have less: on a gyroid ball 1 % of
/// them are off by 0.040 mm or more with 0.8 mm, by 0.037 mm with 0.72 mm and by
/// 0.029 mm with 0.5 mm. From 0.72 to 0.5 mm it takes 2 % more moves, and the
/// width changes 9 % more often.
fn evened(role: Role) -> Mm {
    match role {
        Role::InnerWall => 0.72,
        _ => 3.0,
    }
}

/// Distance of the places in which a piece of a bead that does not show may
/// end, in lengths of the shortest piece.
const ENDS: f64 = 1.0 / 3.0;

/// By how much a piece of a steep ramp may be wider than its narrow end, mm, if
/// the bead shows: it sticks out by half of that on each side.
const STEEP: Mm = 0.025;

/// Pieces of a role are not made shorter than this, mm. Shorter pieces of beads
/// that show would be nearer to the beads' edges, but would have to be printed
/// more slowly: at 0.05 mm a warped sheet takes a sixth longer than at 0.1 mm.
/// Longer pieces of inner walls would lie on the wall beside them where strips
/// meet, with the mean of a narrow and a wide place: with 0.6 mm, 1 % of a
/// honeycomb's inner walls are 0.15 mm too near, with 0.2 mm 0.08 mm, and the
/// pieces are as many. For other beads it is what no printer can follow:
/// 0.6 mm are 10 ms at 60 mm/s, and the pressure in a nozzle takes longer to
/// change.
pub(super) fn shortest(role: Role) -> Mm {
    match role {
        role if role.shows() => 0.07,
        Role::InnerWall => 0.2,
        _ => 0.6,
    }
}

/// The widths that are meant along a stretch of a bead.
#[derive(Clone, Copy)]
struct Stretch {
    /// Least and greatest width.
    low: Mm,
    high: Mm,
    length: Mm,
    /// Content of the stretch.
    content: Mm2,
}

impl Stretch {
    /// A straight ramp from a place and a width to others.
    fn ramp([a, b]: [DVec2; 2], [from, to]: [Mm; 2]) -> Stretch {
        let length = a.distance(b);
        Stretch {
            low: from.min(to),
            high: from.max(to),
            length,
            content: 0.5 * (from + to) * length,
        }
    }

    /// What is meant along this stretch and `other`, which comes after it. The
    /// widths of this stretch do not count if it is shorter than `short` and
    /// `other` is not.
    fn and(self, other: Stretch, short: Mm) -> Stretch {
        let (low, high) = match (self.length < short, other.length < short) {
            (true, false) => (other.low, other.high),
            _ => (self.low.min(other.low), self.high.max(other.high)),
        };
        Stretch {
            low,
            high,
            length: self.length + other.length,
            content: self.content + other.content,
        }
    }

    /// Mean width of the stretch.
    fn width(&self) -> Mm {
        if self.length > 0.0 {
            self.content / self.length
        } else {
            0.5 * (self.low + self.high)
        }
    }
}

/// Greatest difference between the widths of a bead's pieces and those that are
/// meant.
struct Slack {
    /// Height of the bead, and the least width that counts.
    height: Mm,
    narrowest: Mm,
    /// The most that is permitted, whatever the width, of a bead that shows.
    most: Option<Mm>,
    /// Shortest piece.
    short: Mm,
    /// See the function of this name, mm.
    evened: Mm,
    /// The widths of a stretch shorter than this do not count if a longer one
    /// follows it.
    silent: Mm,
}

impl Slack {
    fn of(bead: &Bead, edge: Mm) -> Slack {
        Slack {
            height: bead.height,
            // A share of next to nothing would be too little to count.
            narrowest: 0.5 * bead.stroke.width,
            most: if bead.role.shows() {
                Some(2.0 * edge)
            } else {
                None
            },
            short: shortest(bead.role),
            evened: evened(bead.role),
            // A bead that shows must not stick out anywhere.
            silent: if bead.role.shows() {
                0.0
            } else {
                shortest(bead.role)
            },
        }
    }

    /// Greatest error of a piece's width, by its least width and its length.
    fn at(&self, width: Mm, length: Mm) -> Mm {
        let width = width.max(self.narrowest);
        let share = match self.most {
            // Evenly from d less than the mean to d more, the middle of the
            // piece has d · length / 4 less than it should.
            None => AREA * (4.0 * self.evened / length).max(1.0),
            Some(_) if length <= FEW * width => 2.0 * AREA,
            Some(_) => AREA,
        };
        let area = share * cross_section(width, self.height) / self.height;
        area.min(self.most.unwrap_or(f64::INFINITY))
    }

    /// True if a stretch may have one width, or is too short to be divided.
    fn takes(&self, all: &Stretch) -> bool {
        let slack = self.at(all.low, all.length);
        all.high - all.low <= 2.0 * slack || all.length < self.short
    }

    /// Number of parts into which a ramp is cut, so that pieces can end in it.
    fn parts(&self, ramp: &Stretch) -> usize {
        let parts = |slack: Mm, short: Mm| {
            let all = (ramp.high - ramp.low) / (2.0 * slack);
            let most = (ramp.length / short).floor();
            all.ceil().min(most).max(1.0)
        };
        let long = self.at(ramp.low, f64::INFINITY);
        let count = match self.most {
            None => parts(long, ENDS * self.short),
            // Parts may be so short that they have more slack.
            Some(_) => {
                let short = self.at(ramp.low, 0.0);
                let count = parts(short, self.short);
                if ramp.length / count > FEW * ramp.low {
                    parts(long, self.short)
                } else {
                    count
                }
            }
        };
        // If the number is NaN, there is one part.
        count as usize
    }
}

/// The bead in pieces of constant width. `edge` is how far the edges of a bead
/// that shows may be off, `path` how far the middle of a piece may be from the
/// bead's. All of the bead lies at the level of its first point.
pub(super) fn pieces_within(bead: Bead, edge: Mm, path: Mm) -> Vec<Bead> {
    let own = &bead.stroke;
    if own.widths.len() != own.points.len() || own.points.is_empty() {
        return vec![bead];
    }
    let slack = Slack::of(&bead, edge);
    // Beads that vary in width lie in one plane.
    let level: Vec<_> = own.levels.first().copied().into_iter().collect();
    // The bead in parts, each from a point to the next one.
    let mut points = vec![own.points[0]];
    let mut parts: Vec<Stretch> = Vec::new();
    for (i, (a, b)) in own.segments().enumerate() {
        let widths = [own.width_at(i), own.width_at(i + 1)];
        let ramp = Stretch::ramp([a, b], widths);
        // Without a length the width jumps.
        if ramp.length <= 0.0 {
            continue;
        }
        let count = slack.parts(&ramp);
        for k in 0..count {
            let [s, t] = [k, k + 1].map(|k| k as f64 / count as f64);
            let width = |t: f64| widths[0] + t * (widths[1] - widths[0]);
            let ends = [a.lerp(b, s), a.lerp(b, t)];
            parts.push(Stretch::ramp(ends, [width(s), width(t)]));
            points.push(ends[1]);
        }
    }
    let all = |i: usize, j: usize| {
        let mut parts = parts[i..j].iter().copied();
        let first = parts.next();
        first.map(|p| parts.fold(p, |all, p| all.and(p, slack.silent)))
    };
    let fits =
        |i: usize, j: usize| all(i, j).is_some_and(|all| slack.takes(&all));
    let corners = simplify_path(&points, false, path, fits);
    let mut pieces: Vec<(Vec<DVec2>, Stretch)> = Vec::new();
    for ends in corners.windows(2) {
        let Some(edge) = all(ends[0].1, ends[1].1) else {
            continue;
        };
        let and = pieces.last().map(|p| p.1.and(edge, slack.silent));
        match (pieces.last_mut(), and) {
            (Some(piece), Some(and)) if slack.takes(&and) => {
                piece.0.push(ends[1].0);
                piece.1 = and;
            }
            _ => pieces.push((vec![ends[0].0, ends[1].0], edge)),
        }
    }
    let piece = |(points, all): (Vec<DVec2>, Stretch)| {
        let mut width = all.width();
        if bead.role.shows() {
            // The wide end of a steep ramp lies under the round end of the
            // piece beside it, so the narrow end matters.
            let slack = slack.at(all.low, all.length).max(STEEP);
            width = width.min(all.low + slack);
        }
        let mut stroke = Stroke::new(points, false, width);
        stroke.levels = level.repeat(stroke.points.len());
        Bead { stroke, ..bead }
    };
    pieces.into_iter().map(piece).collect()
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
            (Role::OuterWall, 0.002, 45, 55),
            (Role::InnerWall, 0.001, 6, 10),
        ] {
            let pieces = pieces_within(bead(role), edge, 0.0);
            let n = pieces.len();
            assert!((least..=most).contains(&n), "{role:?} {edge}: {n}");
            for pair in pieces.windows(2) {
                assert_eq!(
                    pair[0].stroke.points.last(),
                    Some(&pair[1].stroke.points[0])
                );
                // Each piece spans no more than four edges, two to a side.
                let step = (pair[0].stroke.width - pair[1].stroke.width).abs();
                let limit = if role.shows() { 8.0 * edge } else { 1.0 };
                assert!(step <= limit.min(0.1) + 1e-9, "{step}");
            }
            let length: f64 = pieces.iter().map(|p| p.stroke.length()).sum();
            assert!((length - 12.0).abs() < 1e-9);
            let content: f64 = pieces
                .iter()
                .map(|p| p.stroke.width * p.stroke.length())
                .sum();
            let meant = 3.0 * 0.4 + 9.0 * 0.5;
            assert!((content / meant - 1.0).abs() < 0.003, "{content}");
        }
    }

    /// A bead along an arc of 10 mm that grows from 0.4 to 0.6 mm.
    fn arc(role: Role) -> Bead {
        let share = |i: usize| i as f64 / 400.0;
        let points = (0..=400).map(|i| 5.0 * DVec2::from_angle(2.0 * share(i)));
        let mut stroke = Stroke::new(points.collect(), false, 0.5);
        stroke.widths = (0..=400).map(|i| 0.4 + 0.2 * share(i)).collect();
        Bead::new(role, stroke, 0.2)
    }

    #[test]
    fn each_line_is_as_long_as_width_and_path_permit_together() {
        let path = 0.015;
        for role in [Role::OuterWall, Role::InnerWall] {
            let bead = arc(role);
            let pieces = pieces_within(bead.clone(), 0.008, path);
            let lines: usize =
                pieces.iter().map(|p| p.stroke.segments().count()).sum();
            let of_path =
                simplify_path(&bead.stroke.points, false, path, |_, _| true);
            let more = of_path.len() - 1;
            // Hardly more than the worse of both needs alone.
            let worse = more.max(pieces.len());
            assert!(lines <= worse + worse / 4, "{lines} {more}");
            let content: Mm2 = pieces
                .iter()
                .map(|p| p.stroke.width * p.stroke.length())
                .sum();
            assert!((content / (10.0 * 0.5) - 1.0).abs() < 0.005, "{content}");
            for piece in &pieces {
                for (a, b) in piece.stroke.segments() {
                    for share in [0.0, 0.25, 0.5, 0.75] {
                        let off = a.lerp(b, share).length() - 5.0;
                        assert!(off.abs() <= 1.01 * path, "{off}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_laid_up_to_any_place_of_a_hidden_bead_is_nearly_what_is_meant() {
        let meant = |x: Mm| 0.5 + 0.12 * (1.3 * x).sin();
        let points: Vec<DVec2> = (0..=1000)
            .map(|i| DVec2::X * (0.02 * f64::from(i)))
            .collect();
        let mut stroke = Stroke::new(points, false, 0.5);
        stroke.widths = stroke.points.iter().map(|p| meant(p.x)).collect();
        let bead = Bead::new(Role::GapFill, stroke, 0.2);
        let pieces = pieces_within(bead, 0.005, 0.01);
        // A wave of 4.8 mm in some pieces of 0.6 mm and more.
        assert!((9..=16).contains(&pieces.len()), "{}", pieces.len());
        let sum = |x: Mm| 0.5 * x - 0.12 / 1.3 * ((1.3 * x).cos() - 1.0);
        let most = AREA * 0.62 * evened(Role::GapFill);
        let (mut laid, mut worst) = (0.0, 0.0_f64);
        for piece in &pieces {
            let (from, to) = (
                piece.stroke.points[0].x,
                piece.stroke.path().last().unwrap().x,
            );
            for k in 1..=20 {
                let x = from + (to - from) * f64::from(k) / 20.0;
                let here = laid + piece.stroke.width * (x - from);
                worst = worst.max((here - sum(x)).abs());
            }
            laid += piece.stroke.width * (to - from);
        }
        assert!(worst < 1.2 * most, "{worst} {most}");
    }

    /// A bead that is narrow on 0.6 mm in its middle, as in a crotch.
    #[test]
    fn inner_walls_follow_a_narrow_place() {
        let nearest = |role: Role| {
            let points = (0..=40).map(|i| DVec2::X * (0.05 * f64::from(i)));
            let mut stroke = Stroke::new(points.collect(), false, 0.5);
            let meant = |x: Mm| 0.3 + 0.2 * ((x - 1.0).abs() / 0.3).min(1.0);
            stroke.widths = stroke.points.iter().map(|p| meant(p.x)).collect();
            let pieces =
                pieces_within(Bead::new(role, stroke, 0.2), 0.005, 0.01);
            let widths = pieces.iter().map(|p| p.stroke.width);
            widths.fold(1.0, f64::min) - 0.3
        };
        let inner = nearest(Role::InnerWall);
        let gap = nearest(Role::GapFill);
        assert!(inner < 0.09 && gap > inner + 0.01, "{inner} {gap}");
    }

    #[test]
    fn steep_ramps_have_no_tiny_pieces() {
        let mut steep = bead(Role::OuterWall);
        steep.stroke.closed = false;
        steep.stroke.points = [(0.0, 0.0), (1.0, 0.0), (1.02, 0.0)]
            .map(DVec2::from)
            .to_vec();
        let pieces = pieces_within(steep, 0.005, 0.0);
        assert_eq!(pieces.len(), 2);
        // The last one hardly sticks out at its narrow end.
        assert!(
            pieces[1].stroke.width < 0.4251,
            "{}",
            pieces[1].stroke.width
        );
    }

    #[test]
    fn constant_and_odd_beads_stay() {
        let mut even = bead(Role::GapFill);
        even.stroke.widths = vec![0.4; 3];
        assert_eq!(pieces_within(even.clone(), 0.005, 0.0).len(), 1);
        even.stroke.widths.clear();
        assert_eq!(pieces_within(even.clone(), 0.005, 0.0), [even.clone()]);
        even.stroke.points[1] = DVec2::NAN;
        even.stroke.widths = vec![0.4, f64::NAN, 0.5];
        assert!(!pieces_within(even, 0.005, 0.0).is_empty());
    }
}
