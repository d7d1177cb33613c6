//! Loops that lead into tips.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━╲      The loop of a wall turns back where its two sides
//!   ━━━━━━━━━━━━━━━━╲  ╲     meet, and leaves the tip open. A bead of its own
//!                    ╲  ╲    would cut the loop in two strokes. So both sides
//!   ──────────────────╮  ╲   become narrower, each half as wide as the tip,
//!   ──────────────────╰───╲  and turn back at its end.
//! ```
//!
//! In: the lines of the outer wall, and the tips as parts of the area's axes.
//! Out: the lines, led into the tips.
//!
//! A ball of the thickness t that moves by 1 along the axis while t changes by t′
//! touches the border in the directions −t′/2 along the axis and ±√(1 − t′²/4)
//! across it (the envelope of the balls, Blum and Nagel 1978).

use super::Lay;
use super::medial_axis::Axis;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;

/// Distance between where a loop should leave for a tip and where it runs, mm, up
/// to which the tip is the loop's.
const BESIDE: Mm = 0.06;
/// Length of a loop that a tip takes the place of, as a multiple of the way there
/// and back.
const SPARED: f64 = 1.5;

/// A place on a line: the number of a segment, and the share of the segment before
/// the place.
type Place = f64;

/// A way into a tip and back, which takes the place of a stretch of a line.
struct Way {
    from: Place,
    to: Place,
    points: Vec<DVec2>,
    widths: Vec<Mm>,
}

/// Leads lines of the outermost wall into tips, each an axis that begins in the tip.
pub(super) fn lead_into_tips(
    lines: Vec<Stroke>,
    tips: &[Axis],
    lay: &Lay,
) -> Vec<Stroke> {
    if tips.is_empty() {
        return lines;
    }
    let grid = EdgeGrid::of_lines(lines.iter().map(Stroke::path), lay.width);
    let mut first_edges = Vec::with_capacity(lines.len());
    let mut edges = 0;
    for line in &lines {
        first_edges.push(edges);
        edges += line.path().count();
    }
    let mut ways: Vec<Vec<Way>> = lines.iter().map(|_| Vec::new()).collect();
    for tip in tips {
        let (points, widths) = around(tip, lay);
        let (Some(&a), Some(&b)) = (points.first(), points.last()) else {
            continue;
        };
        let place = |p: DVec2| {
            let (edge, q) = grid.nearest_edge(p, BESIDE)?;
            let (a, b) = grid.edge(edge);
            let owner = grid.owner(edge);
            let along = a.distance(q) / a.distance(b).max(f64::MIN_POSITIVE);
            Some((owner, (edge - first_edges[owner]) as f64 + along.min(1.0)))
        };
        if let (Some((line, from)), Some((other, to))) = (place(a), place(b))
            && line == other
            && is_short(&lines[line], from, to, tip)
        {
            ways[line].push(Way {
                from,
                to,
                points,
                widths,
            });
        }
    }
    let all = lines.into_iter().zip(ways);
    all.map(|(line, ways)| with_ways(line, ways)).collect()
}

/// The way around a tip as a line goes that has the area to its left, and the
/// widths along the way.
fn around(tip: &Axis, lay: &Lay) -> (Vec<DVec2>, Vec<Mm>) {
    let n = tip.points.len();
    let [mut points, mut back] = [Vec::with_capacity(2 * n), Vec::new()];
    let mut widths = Vec::with_capacity(2 * n);
    for k in (0..n).rev() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(n - 1));
        let way = tip.points[after] - tip.points[before];
        let length = way.length().max(f64::MIN_POSITIVE);
        let along = way / length;
        let grows = (tip.thickness[after] - tip.thickness[before]) / length;
        let behind = (0.5 * grows).clamp(0.0, 0.9);
        let across = (1.0 - behind * behind).sqrt() * along.perp();
        let (p, t) = (tip.points[k], tip.thickness[k]);
        let width = lay.width + 0.5 * (t - 2.0 * lay.inner);
        let out = 0.5 * (t - width);
        widths.push(width);
        points.push(p + out * (across - behind * along));
        back.push(p + out * (-across - behind * along));
    }
    points.extend(back.into_iter().rev());
    widths.extend_from_within(..);
    widths[n..].reverse();
    (points, widths)
}

/// True if a line from one place on to another is about as long as the way into a
/// tip, and so runs around the tip and not around the rest of the part.
fn is_short(line: &Stroke, from: Place, to: Place, tip: &Axis) -> bool {
    let n = line.points.len();
    if !line.closed && to < from {
        return false;
    }
    let most = SPARED * 2.0 * tip.length() + tip.thickest();
    let to = if to < from { to + n as f64 } else { to };
    let mut length = 0.0;
    for k in from as usize..=to as usize {
        let (a, b) = (line.points[k % n], line.points[(k + 1) % n]);
        let low = from.max(k as f64);
        let high = to.min((k + 1) as f64);
        length += (high - low).max(0.0) * a.distance(b);
        if length > most {
            return false;
        }
    }
    true
}

/// A line with ways in place of some of its stretches.
fn with_ways(line: Stroke, mut ways: Vec<Way>) -> Stroke {
    let n = line.points.len();
    ways.sort_by(|a, b| a.from.total_cmp(&b.from));
    let Some(start) = ways.first().map(|way| way.from) else {
        return line;
    };
    // A closed line is done where the first way leaves it again.
    let count = n as f64;
    let end = if line.closed { start + count } else { count };
    let mut points = Vec::with_capacity(n + 8);
    let mut widths = Vec::with_capacity(n + 8);
    let mut done = if line.closed { start } else { -1.0 };
    let keep = |points: &mut Vec<DVec2>,
                widths: &mut Vec<Mm>,
                from: Place,
                to: Place| {
        let first = from.floor() as i64 + 1;
        for k in first..to.ceil() as i64 {
            let k = k as usize % n;
            points.push(line.points[k]);
            widths.push(line.width_at(k));
        }
    };
    for way in ways {
        let from = way.from;
        let round = line.closed && way.to < from;
        let to = if round { way.to + count } else { way.to };
        // It would take a part of the line that another way has taken.
        if from < done || to > end {
            continue;
        }
        keep(&mut points, &mut widths, done, from);
        points.extend(way.points);
        widths.extend(way.widths);
        done = to;
    }
    keep(&mut points, &mut widths, done, end);
    Stroke::varying(points, widths, line.closed)
}

#[cfg(test)]
mod tests {
    use super::super::{WallPlan, walls};
    use super::*;
    use isoslice_planar::Area;
    use isoslice_planar::Solid;
    use isoslice_planar::bead::cross_section;
    use isoslice_settings::testing::usual_plan;

    const HEIGHT: Mm = 0.2;

    /// A strip of 0.85 mm in a direction, cut off level at both ends.
    fn strip(degrees: f64) -> Area {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (wide, far) = (0.85 / sin, 8.0 * cos / sin);
        let ring = [(0.0, 0.0), (wide, 0.0), (far + wide, 8.0), (far, 8.0)];
        Area::from(ring.map(|(x, y)| DVec2::new(x, y)).to_vec())
    }

    #[test]
    fn a_loop_leads_into_both_tips_of_a_strip() {
        for degrees in [38.0, 45.0, 52.0, 128.0, 142.0] {
            let area = strip(degrees);
            let found = walls(&area, None, HEIGHT, &usual_plan(WallPlan::of));
            let all: Vec<&Stroke> = found.lines.iter().flatten().collect();
            assert!(found.thin.iter().all(Vec::is_empty), "{degrees}");
            assert_eq!(all.len(), 1, "{degrees}");
            let line = all[0];
            assert!(line.closed);
            let solid = Solid::of(&area, 1.0);
            let border = solid.grid();
            let corners = if degrees < 90.0 { [0, 2] } else { [1, 3] };
            let sharp = corners.map(|k| area.rings[0][k]);
            let mut off: Mm = 0.0;
            for (k, p) in line.points.iter().enumerate() {
                let (_, q) = border.nearest_edge(*p, 1.0).unwrap();
                let edge = q.distance(*p) - 0.5 * line.width_at(k);
                if sharp.iter().any(|tip| tip.distance(*p) < 0.75) {
                    off = off.max(edge.abs());
                }
            }
            // The outer side of the loop is on the border, into the tips.
            assert!(off < 0.006, "{degrees}: {off}");
            let reach = |tip: DVec2| {
                let far = line.points.iter().map(|p| p.distance(tip));
                far.fold(f64::INFINITY, f64::min)
            };
            // A loop that turns back where its sides meet stays 0.5 mm away.
            for tip in sharp {
                assert!(reach(tip) < 0.41, "{degrees}: {}", reach(tip));
            }
            let laid: f64 = line
                .segments()
                .enumerate()
                .map(|(k, (a, b))| {
                    let width = 0.5 * (line.width_at(k) + line.width_at(k + 1));
                    cross_section(width, HEIGHT) * a.distance(b)
                })
                .sum();
            // Edges are round, and the ends of the tips stay open.
            let share = laid / (HEIGHT * area.content());
            assert!((0.92..0.97).contains(&share), "{degrees}: {share}");
        }
    }

    #[test]
    fn a_way_takes_the_place_of_a_stretch_wherever_the_line_begins() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)];
        for first in 0..4 {
            let mut points = square.map(DVec2::from).to_vec();
            points.rotate_left(first);
            let at = |k: usize| ((k + 4 - first) % 4) as f64;
            let way = |corner: usize, out: f64| Way {
                from: (at(corner) + 3.5) % 4.0,
                to: at(corner) + 0.5,
                points: vec![DVec2::from(square[corner]) * out],
                widths: vec![0.2],
            };
            let line = Stroke::new(points, true, 0.45);
            let led = with_ways(line, vec![way(0, 0.0), way(2, 2.0)]);
            assert_eq!(led.points.len(), 4, "{led:?}");
            assert!(led.points.contains(&DVec2::splat(8.0)));
            assert!(led.length() > 20.0);
            let narrow = led.widths.iter().filter(|w| **w == 0.2);
            assert_eq!(narrow.count(), 2);
        }
    }

    #[test]
    fn ways_that_meet_are_not_laid_twice() {
        let points = [0.0, 1.0, 2.0, 3.0].map(|x| DVec2::new(x, 0.0));
        let line = Stroke::new(points.to_vec(), false, 0.45);
        let way = |from, to| Way {
            from,
            to,
            points: vec![DVec2::new(from, 1.0)],
            widths: vec![0.3],
        };
        let led = with_ways(line.clone(), vec![way(1.2, 2.5), way(0.5, 1.5)]);
        let meant = [(0.0, 0.0), (0.5, 1.0), (2.0, 0.0), (3.0, 0.0)];
        assert_eq!(led.points, meant.map(DVec2::from));
        // Around a ring, the second way ends beyond where the first one begins.
        let ring = Stroke {
            closed: true,
            ..line
        };
        let led = with_ways(ring, vec![way(0.5, 1.5), way(2.5, 1.0)]);
        let meant = [(0.5, 1.0), (2.0, 0.0), (3.0, 0.0), (0.0, 0.0)];
        assert_eq!(led.points, meant.map(DVec2::from));
    }
}
