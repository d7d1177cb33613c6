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
//! - each piece has the mean of what is meant. Where the width changes evenly,
//!   half of a piece has no more than [`AREA`] too much or too little; if the
//!   piece is short and does not show, the same share of what [`evened`] holds;
//! - the middle of a piece is within `path` of the bead's, and the edges of a bead
//!   that shows are within `edge` of where they were meant;
//! - where the width changes so fast that a line would be shorter than
//!   [`shortest`], edges may be off by more. What
//!   shows sticks out by no more than half of [`STEEP`] there, and holds less.
//!
//! Each line is chosen as long as its width and the path permit together. It
//! would otherwise be cut once for its width and once for its path.

use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::{Bead, Role, Stroke, cross_section};
use isoslice_planar::simplify::simplify_path;

/// By how much of itself the volume of half a piece may differ from what is
/// meant.
const AREA: f64 = 0.03;

/// A length over which what is laid too early or too late along a bead of this
/// role may be made up for, mm. 3 mm take 50 ms at 60 mm/s, and the pressure in a
/// nozzle takes longer to change.
///
/// Inner walls lie against an outer wall, and have less: on a gyroid ball 1 % of
/// them are off by 0.040 mm or more with 0.8 mm, by 0.037 mm with 0.72 mm and by
/// 0.029 mm with 0.5 mm. From 0.72 to 0.5 mm it takes 2 % more moves, and the
/// width changes 9 % more often.
fn evened(role: Role) -> Mm {
    match role {
        role if role.shows() => 0.0,
        Role::InnerWall => 0.72,
        _ => 3.0,
    }
}

/// Distance of the places in which a piece may end, in lengths of the shortest
/// piece.
const ENDS: f64 = 0.25;

/// A segment is not divided into more parts than this.
const PARTS: f64 = 64.0;

/// By how much a piece of a steep ramp may be wider than its narrow end, mm, if
/// the bead shows: it sticks out by half of that on each side. With 0.025 mm, 1 %
/// of the outer walls of thin sheets are a third farther off, as they are too
/// narrow there.
const STEEP: Mm = 0.04;

/// Pieces of a role are not made shorter than this for their width, mm. 0.2 mm
/// are 5 ms at 40 mm/s, and the pressure in a nozzle takes longer to change.
/// Longer pieces of inner walls would lie on the wall beside them where strips
/// meet, with the mean of a narrow and a wide place: with 0.6 mm, 1 % of a
/// honeycomb's inner walls are 0.15 mm too near, with 0.2 mm 0.08 mm, and the
/// pieces are as many.
pub(super) fn shortest(role: Role) -> Mm {
    match role {
        role if role.shows() => 0.2,
        Role::InnerWall => 0.3,
        _ => 0.6,
    }
}

/// What counts as no distance, mm: numbers are not exact.
const EXACT: Mm = 1e-6;

/// Share of the tolerance up to which lines beside each other have one width:
/// that saves no moves but arcs, and is farther off.
const ALIKE: f64 = 0.5;

/// Share of the tolerance up to which lines are longer so that none of them is
/// shorter than [`shortest`]. With 1, half as many moves more of a gyroid block
/// are slowed; with 2, edges of thin sheets are a third farther off.
const HURRIED: f64 = 1.5;

/// A bead's path as close places, and what is meant up to each of them.
struct Way {
    points: Vec<DVec2>,
    widths: Vec<Mm>,
    /// Length and content from the beginning.
    length: Vec<Mm>,
    content: Vec<Mm2>,
}

impl Way {
    /// The way along a stroke, with places no farther apart than `step`.
    fn of(stroke: &Stroke, step: Mm) -> Way {
        let mut way = Way {
            points: stroke.points.first().copied().into_iter().collect(),
            widths: vec![stroke.width_at(0)],
            length: vec![0.0],
            content: vec![0.0],
        };
        let (mut length, mut content) = (0.0, 0.0);
        for (i, (a, b)) in stroke.segments().enumerate() {
            let (from, to) = (stroke.width_at(i), stroke.width_at(i + 1));
            // Without a length the width jumps.
            let count = (a.distance(b) / step).ceil().min(PARTS);
            let step = a.distance(b) / count;
            for k in 1..=count as usize {
                let width = |k: usize| from + k as f64 / count * (to - from);
                length += step;
                content += 0.5 * (width(k - 1) + width(k)) * step;
                way.points.push(a.lerp(b, k as f64 / count));
                way.widths.push(width(k));
                way.length.push(length);
                way.content.push(content);
            }
        }
        way
    }

    fn length(&self, i: usize, j: usize) -> Mm {
        self.length[j] - self.length[i]
    }

    /// Mean width between two places.
    fn width(&self, i: usize, j: usize) -> Mm {
        (self.content[j] - self.content[i]) / self.length(i, j)
    }

    /// Least and greatest width between two places.
    fn extremes(&self, i: usize, j: usize) -> [Mm; 2] {
        let all = self.widths[i..=j].iter();
        all.fold([f64::INFINITY, 0.0], |[low, high], w| {
            [low.min(*w), high.max(*w)]
        })
    }

    /// How far a straight line that fits best is from the path between two
    /// places.
    fn bend(&self, i: usize, j: usize) -> Mm {
        let (a, b) = (self.points[i], self.points[j]);
        let across = (b - a).perp().normalize_or_zero();
        let off = self.points[i..=j].iter().map(|p| across.dot(*p - a));
        let (least, most) =
            off.fold((0.0_f64, 0.0_f64), |(l, m), d| (l.min(d), m.max(d)));
        0.5 * (most - least)
    }
}

/// How far the widths of a bead's pieces may be from those that are meant.
struct Slack {
    height: Mm,
    /// The least width that counts: a share of next to nothing would be too
    /// little.
    narrowest: Mm,
    /// How far edges may be off, if they show.
    edge: Option<Mm>,
    short: Mm,
    evened: Mm,
}

impl Slack {
    fn of(bead: &Bead, edge: Mm) -> Slack {
        Slack {
            height: bead.height,
            narrowest: 0.5 * bead.stroke.width,
            edge: bead.role.shows().then_some(edge),
            short: shortest(bead.role),
            evened: evened(bead.role),
        }
    }

    /// True if all widths from `low` to `high` are near enough to each other for
    /// a piece of this length, or for that if `share` of the tolerance counts.
    /// `bend` is how far the piece is from the path.
    fn takes(
        &self,
        [low, high]: [Mm; 2],
        length: Mm,
        bend: Mm,
        share: f64,
    ) -> bool {
        let width = low.max(self.narrowest);
        // Where the width changes evenly by d along a piece, half of the piece
        // has d / 4 times its length too much or too little.
        let area = cross_section(width, self.height) / self.height;
        let by_area = AREA * area * (2.0 * self.evened / length).max(1.0);
        // A quarter of a difference is on each edge, as the piece has the mean.
        let by_edge = self.edge.map_or(by_area, |edge| (edge - bend).max(0.0));
        high - low <= 4.0 * share * by_area.min(by_edge)
    }
}

/// The bead in pieces of constant width. `edge` is how far the edges of a bead
/// that shows may be off, `path` how far the middle of a piece may be from the
/// bead's; without it, it is the bead's. All of the bead lies at the level of its first point.
pub(super) fn pieces_within(
    bead: Bead,
    edge: Mm,
    path: Option<Mm>,
) -> Vec<Bead> {
    let own = &bead.stroke;
    if own.widths.len() != own.points.len() || own.points.is_empty() {
        return vec![bead];
    }
    let slack = Slack::of(&bead, edge);
    let way = Way::of(own, ENDS * slack.short);
    let alike = path.map_or(1.0, |_| ALIKE);
    let path = path.unwrap_or(EXACT);
    let corners = simplify_path(&way.points, false, path, |i, j| {
        way.length(i, j - 1) < slack.short
            || slack.takes(
                way.extremes(i, j),
                way.length(i, j),
                way.bend(i, j),
                1.0,
            )
    });
    // The turns of skin reach as far as they were meant to.
    let wall = bead.role.shows() || bead.role == Role::InnerWall;
    let corners = if wall {
        evened_out(corners, &way, &slack, path)
    } else {
        corners
    };
    let mut pieces: Vec<Piece> = Vec::new();
    for line in corners.windows(2) {
        let [(from, i), (to, j)] = [line[0], line[1]];
        let here = way.extremes(i, j);
        if let Some(piece) = pieces.last_mut() {
            let all =
                [piece.widths[0].min(here[0]), piece.widths[1].max(here[1])];
            let length = way.length(piece.ends[0], j);
            if slack.takes(all, length, 0.0, alike) {
                piece.points.push(to);
                (piece.ends[1], piece.widths) = (j, all);
                continue;
            }
        }
        pieces.push(Piece {
            points: vec![from, to],
            ends: [i, j],
            widths: here,
        });
    }
    // Beads that vary in width lie in one plane.
    let level = own.levels.first().copied();
    let piece = |piece: Piece| {
        let [i, j] = piece.ends;
        let mut width = way.width(i, j);
        if bead.role.shows() {
            // The wide end of a steep ramp lies under the round end of the
            // piece beside it, so the narrow end matters.
            width = width.min(piece.widths[0] + STEEP);
        }
        let mut stroke = Stroke::new(piece.points, false, width);
        stroke.levels = level
            .map_or_else(Vec::new, |level| vec![level; stroke.points.len()]);
        Bead { stroke, ..bead }
    };
    pieces.into_iter().map(piece).collect()
}

/// A piece of a bead.
struct Piece {
    points: Vec<DVec2>,
    /// Numbers of the places at its ends.
    ends: [usize; 2],
    /// Least and greatest width that is meant.
    widths: [Mm; 2],
}

/// The corners without those beside a line shorter than `short`, as far as the
/// path permits: they are left out, or move to where both lines are as long.
fn evened_out(
    corners: Vec<(DVec2, usize)>,
    way: &Way,
    slack: &Slack,
    path: Mm,
) -> Vec<(DVec2, usize)> {
    let short = slack.short;
    let fits = |i: usize, j: usize| {
        let (widths, length) = (way.extremes(i, j), way.length(i, j));
        way.bend(i, j) <= path && slack.takes(widths, length, 0.0, HURRIED)
    };
    let mut out: Vec<(DVec2, usize)> = Vec::with_capacity(corners.len());
    let mut rest = corners.into_iter().peekable();
    while let Some(b) = rest.next() {
        let (Some(a), Some(c)) = (out.last(), rest.peek()) else {
            out.push(b);
            continue;
        };
        let (i, k) = (a.1, c.1);
        let least = way.length(i, b.1).min(way.length(b.1, k));
        let whole = way.length(i, k);
        if least >= short {
            out.push(b);
        } else if whole < 2.0 * short {
            if !fits(i, k) {
                out.push(b);
            }
        } else {
            let half = way.length[i] + 0.5 * whole;
            let j = way.length.partition_point(|l| *l < half);
            let fits = i < j && j < k && fits(i, j) && fits(j, k);
            out.push(if fits { (way.points[j], j) } else { b });
        }
    }
    out
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
            (Role::OuterWall, 0.008, 12, 15),
            (Role::OuterWall, 0.004, 24, 29),
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
                assert!(step <= limit + 1e-9, "{step}");
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

    /// A ring whose thickness waves nine times, laid as one bead. Its edges are
    /// within a printer's step.
    #[test]
    fn edges_and_content_of_a_ring_that_waves() {
        let (edge, path) = (0.011, 0.0095);
        let width = |t: f64| 0.5 + 0.12 * (9.0 * t).sin();
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / 3000.0;
        let points = (0..3000).map(|i| 6.0 * DVec2::from_angle(angle(i)));
        let mut stroke = Stroke::new(points.collect(), true, 0.5);
        stroke.widths = (0..3000).map(|i| width(angle(i))).collect();
        let bead = Bead::new(Role::OuterWall, stroke, 0.2);
        let pieces = pieces_within(bead, edge, Some(path));
        let lines = pieces.iter().map(|p| p.stroke.segments().count());
        // 37.7 mm, along which the width goes up and down by 4.3 mm in all.
        let lines: usize = lines.sum();
        assert!((90..=120).contains(&lines), "{lines}");
        let (mut off, mut worst, mut short) = (Vec::new(), 0.0_f64, 0);
        for piece in &pieces {
            let half = 0.5 * piece.stroke.width;
            let (mut laid, mut meant) = (0.0, 0.0);
            for (a, b) in piece.stroke.segments() {
                short += usize::from(a.distance(b) < 0.1);
                for k in 0..20 {
                    let p = a.lerp(b, (f64::from(k) + 0.5) / 20.0);
                    let t = p.to_angle();
                    let own = 0.5 * width(t);
                    off.push((p.length() + half - 6.0 - own).abs());
                    off.push((p.length() - half - 6.0 + own).abs());
                    laid += half * a.distance(b);
                    meant += own * a.distance(b);
                }
            }
            worst = worst.max((laid / meant - 1.0).abs());
        }
        off.sort_by(f64::total_cmp);
        let p99 = off[off.len() * 99 / 100];
        assert!(p99 <= 0.0125 && short == 0, "{p99} {short}");
        assert!(worst <= 0.005, "{worst}");
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
            let pieces = pieces_within(bead.clone(), 0.008, Some(path));
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
        let pieces = pieces_within(bead, 0.005, Some(0.01));
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
                pieces_within(Bead::new(role, stroke, 0.2), 0.005, Some(0.01));
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
        // The last one hardly sticks out at its narrow end.
        assert!(
            pieces[1].stroke.width < 0.4 + STEEP + 1e-9,
            "{}",
            pieces[1].stroke.width
        );
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
