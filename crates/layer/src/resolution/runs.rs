//! Beads of varying width as pieces of constant width, which is what a move
//! can lay.
//!
//! ```text
//!   width │   ╱──╲ ___      A move has one width, so a ramp becomes stairs. The
//!         │ _╱ ┄┄┄╲         steps are as long as the tolerances permit, and each
//!         │╱ ─     ┄┄┄      has the mean of what is meant along it.
//!         └──────────── way
//! ```
//!
//! In: a bead. Out: beads, each beginning where the one before ends.
//!
//! Guarantees:
//! - each piece has the mean of what is meant, or less on a steep ramp that shows
//!   (see `STEEP`). Where the width changes evenly, half of a piece has no more than
//!   3 % too much or too little; if the piece is short and does not show, the same
//!   share of what can be made up for;
//! - where a bead shows, each of its edges is within a tolerance of where it was
//!   meant; where it does not, its middle is. Only on lines shorter than
//!   `lines::shortest` the width may differ by more.
//!
//! Each line is chosen as long as its width and the path permit together. It
//! would otherwise be cut once for its width and once for its path.

use super::lines::{self, Joint, Lines};
use super::way::Way;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Stroke};
use std::ops::RangeInclusive;

/// By how much a piece of a steep ramp may be wider than its narrow end, mm, if
/// the bead shows: it sticks out by half of that on each side. Its wide end lies
/// under the round end of the piece beside it.
const STEEP: Mm = 0.04;

/// The bead in pieces of constant width. `off` is how far the middle of a piece
/// may be from the bead's; its edges, if they show. All of the bead lies at the
/// level of its first point. If there are to be arcs within a tolerance, a piece
/// may have many points along which one arc leads.
pub(super) fn pieces_within(
    bead: Bead,
    off: Mm,
    arcs: Option<Mm>,
) -> Vec<Bead> {
    let own = &bead.stroke;
    if own.widths.len() != own.points.len() || own.points.is_empty() {
        return vec![bead];
    }
    let way = Way::of(own, lines::step(bead.role), off, bead.role.shows());
    let lines = Lines::of(&way, &bead, off);
    let joints = lines.joints();
    let arcs = arcs.map_or_else(Vec::new, |off| lines.arcs(off));
    let pieces = if (1..joints.len()).contains(&arcs.len()) {
        let ends = arcs.windows(2).map(|ends| ends[0]..=ends[1]);
        ends.map(|p| (way.points[p.clone()].to_vec(), p)).collect()
    } else {
        merged(&joints, &lines)
    };
    // Beads that vary in width lie in one plane.
    let level = own.levels.first().copied();
    let piece = |(points, places): Piece| {
        let (i, j) = (*places.start(), *places.end());
        let mut width = way.width(i, j);
        if bead.role.shows() {
            width = width.min(way.extremes(i, j)[0] + STEEP);
        }
        let mut stroke = Stroke::new(points, false, width);
        stroke.levels = level
            .map_or_else(Vec::new, |level| vec![level; stroke.points.len()]);
        Bead { stroke, ..bead }
    };
    pieces.into_iter().map(piece).collect()
}

/// A piece's points, and the numbers of the places along which it leads.
type Piece = (Vec<DVec2>, RangeInclusive<usize>);

/// The lines between joints in pieces; lines that may have one width are in one.
fn merged(joints: &[Joint], lines: &Lines<'_>) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut of_piece = [0.0, f64::INFINITY];
    for ends in joints.windows(2) {
        let (from, to) = (ends[0], ends[1]);
        let own = lines.widths([from, to]);
        let [low, high] = [of_piece[0].max(own[0]), of_piece[1].min(own[1])];
        if let Some((points, places)) = pieces.last_mut() {
            let width = lines.way.width(*places.start(), to.place);
            if low <= width && width <= high {
                points.push(to.at);
                *places = *places.start()..=to.place;
                of_piece = [low, high];
                continue;
            }
        }
        pieces.push((vec![from.at, to.at], from.place..=to.place));
        of_piece = own;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resolution::lines::{AREA, evened};
    use isoslice_base::units::Mm2;
    use isoslice_planar::bead::Role;
    use isoslice_planar::simplify::simplify_path;

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
            (Role::OuterWall, 0.008, 12, 15),
            (Role::OuterWall, 0.004, 24, 30),
            (Role::InnerWall, 0.001, 5, 9),
        ] {
            let pieces = pieces_within(bead(role), edge, None);
            let n = pieces.len();
            assert!((least..=most).contains(&n), "{role:?} {edge}: {n}");
            for pair in pieces.windows(2) {
                assert_eq!(
                    pair[0].stroke.points.last(),
                    Some(&pair[1].stroke.points[0])
                );
                let step = (pair[0].stroke.width - pair[1].stroke.width).abs();
                let limit = if role.shows() { 6.0 * edge } else { 0.1 };
                assert!(step <= limit + 1e-9, "{step} {pieces:?}");
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

    /// Rings whose thickness waves, laid as one bead. Nowhere is an edge off by
    /// more than the bound, no matter how tight the ring and how steep the wave is.
    #[test]
    fn edges_and_content_of_rings_that_wave() {
        let edge = 0.01;
        for (radius, waves, most) in
            [(6.0, 9.0, 125), (1.5, 5.0, 70), (0.3, 1.0, 18)]
        {
            let width = |t: f64| 0.5 + 0.12 * (waves * t).sin();
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / 3000.0;
            let points = (0..3000).map(|i| DVec2::from_angle(angle(i)));
            let points = points.map(|p| radius * p).collect();
            let mut stroke = Stroke::new(points, true, 0.5);
            stroke.widths = (0..3000).map(|i| width(angle(i))).collect();
            let pieces = pieces_within(
                Bead::new(Role::OuterWall, stroke, 0.2),
                edge,
                None,
            );
            let lines: usize =
                pieces.iter().map(|p| p.stroke.segments().count()).sum();
            assert!(lines <= most, "{radius}: {lines}");
            let (mut off, mut worst) = (0.0_f64, 0.0_f64);
            for piece in &pieces {
                let half = 0.5 * piece.stroke.width;
                let (mut laid, mut meant) = (0.0, 0.0);
                for (a, b) in piece.stroke.segments() {
                    for k in 0..20 {
                        let p = a.lerp(b, (f64::from(k) + 0.5) / 20.0);
                        let own = 0.5 * width(p.to_angle());
                        let beside = (p.length() - radius).abs();
                        off = off.max(beside + (half - own).abs());
                        laid += half * a.distance(b);
                        meant += own * a.distance(b);
                    }
                }
                worst = worst.max((laid / meant - 1.0).abs());
            }
            assert!(off <= 1.05 * edge, "{radius}: {off}");
            assert!(worst <= 0.01, "{radius}: {worst}");
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
            let pieces = pieces_within(bead.clone(), path, None);
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
        let pieces = pieces_within(bead, 0.01, None);
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
                pieces_within(Bead::new(role, stroke, 0.2), 0.01, None);
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
        let pieces = pieces_within(steep, 0.005, None);
        assert_eq!(pieces.len(), 2);
    }

    #[test]
    fn constant_and_odd_beads_stay() {
        let mut even = bead(Role::GapFill);
        even.stroke.widths = vec![0.4; 3];
        assert_eq!(pieces_within(even.clone(), 0.005, None).len(), 1);
        even.stroke.widths.clear();
        assert_eq!(pieces_within(even.clone(), 0.005, None), [even.clone()]);
        even.stroke.points[1] = DVec2::NAN;
        even.stroke.widths = vec![0.4, f64::NAN, 0.5];
        let _ = pieces_within(even, 0.005, None);
    }
}
