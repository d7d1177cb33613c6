//! What the walls take of the area inside them.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━━┓     A part of 2 mm has room for four lines and a
//!   ═══════════════╗   ┃     narrow bead. The inner walls on both sides become
//!                  ╚═  ┗━━   wider and share the place of the bead: four
//!                  ╔═  ┏━━   strokes take less time than five. The walls are
//!   ═══════════════╝   ┃     narrow again where there is room for whole lines,
//!   ━━━━━━━━━━━━━━━━━━━┛     which begin where the walls end.
//! ```
//!
//! In: the area that the walls leave where they have their usual width, and the last
//! wall. Out: what is left of the area beside that wall.

use super::Lay;
use super::beading::NARROW;
use super::give::wider;
use super::medial_axis::Axis;
use super::widen::across;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::Stroke;
use isoslice_planar::clip::difference;
use isoslice_planar::opening::is_wider;
use isoslice_planar::{Area, BoxTree, Rect, Ring};

/// Pieces of what is left are looked at if they are smaller than this, mm²:
/// some are remains that no bead fits into.
const SMALL: Mm2 = 0.1;

/// What is left of an area beside a wall, some of whose lines are wider than usual. Lines
/// of `skin` are laid in what is left. Borders are off by `slack`.
pub(super) fn without(
    area: Area,
    walls: &[Stroke],
    (wall, skin): (&Lay, &Lay),
    slack: Mm,
) -> Area {
    if area.is_empty() {
        return area;
    }
    let wider = wider(walls, wall.width).into_iter();
    let band = |line: Axis| taken(&line.stroke(-wall.extra), -2.0 * slack);
    let taken: Vec<Ring> = wider.map(band).collect();
    if taken.is_empty() {
        return area;
    }
    let prints = |part: &Area| {
        part.content() > SMALL || is_wider(part, skin.least, slack)
    };
    cut_out(&area, &taken, prints)
}

/// What is left of an area without the slivers that the wall around it has become wider
/// for. Borders are off by `slack`. The ends of slivers stay: where strips meet, what is
/// left between them keeps its shape. What is thinner than a bead of the next `lay` ever
/// is stays as well.
pub(super) fn without_slivers(
    area: Area,
    slivers: &[Axis],
    lay: &Lay,
    slack: Mm,
) -> Area {
    let least = lay.least / NARROW - 2.0 * slack;
    let parts = slivers.iter().cloned().flat_map(|mut axis| {
        if axis.closed {
            axis.points.extend(axis.points.first().copied());
            axis.thickness.extend(axis.thickness.first().copied());
            axis.closed = false;
        } else {
            for _ in 0..2 {
                axis.points.reverse();
                axis.thickness.reverse();
                let end = axis.thickness.last().copied().unwrap_or(0.0);
                axis.shorten(2.0 * end.max(0.0));
            }
        }
        axis.split_at(least)
    });
    let long = |axis: &Axis| axis.thickest() > least && axis.points.len() > 1;
    let band = |axis: Axis| taken(&axis.stroke(2.0 * slack), 0.0);
    let taken: Vec<Ring> = parts.filter(long).map(band).collect();
    if taken.is_empty() {
        return area;
    }
    cut_out(&area, &taken, |_| true)
}

/// An area without others; of the islands that these meet, the parts that are `kept`.
fn cut_out(area: &Area, taken: &[Ring], kept: impl Fn(&Area) -> bool) -> Area {
    let boxes = taken.iter().map(Rect::around);
    let tree = BoxTree::new(boxes.enumerate());
    let mut left = Area::EMPTY;
    for island in area.islands() {
        let beside = tree.meeting(island.bounds());
        let beside: Area = beside.map(|k| taken[k].clone()).collect();
        if beside.is_empty() {
            left.rings.extend(island.rings);
            continue;
        }
        let parts = difference(&island, &beside).islands().into_iter();
        left.rings
            .extend(parts.filter(&kept).flat_map(|part| part.rings));
    }
    left
}

/// The share of the plane that a line takes, whose bead is wider by `extra`. It
/// ends square: the round end of a bead has no material of its own.
pub(crate) fn taken(line: &Stroke, extra: Mm) -> Ring {
    let side = |k: usize| {
        let across = across(line, k);
        let half = 0.5 * (line.width_at(k) - extra).max(0.0);
        (
            line.points[k] + across * half,
            line.points[k] - across * half,
        )
    };
    let (left, mut right): (Vec<_>, Vec<_>) =
        (0..line.points.len()).map(side).unzip();
    right.extend(left.into_iter().rev());
    right
}

/// Content that a line lays, whose bead is wider by `extra` than its share of the
/// plane.
pub(crate) fn content_of(line: &Stroke, extra: Mm) -> Mm2 {
    let width = |k: usize| 0.5 * (line.width_at(k) + line.width_at(k + 1));
    let pieces = line.segments().enumerate();
    pieces
        .map(|(k, (a, b))| a.distance(b) * (width(k) - extra))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::patch::concentric;
    use crate::walls::{ThinPlan, WallPlan, Walls, walls};
    use glam::DVec2;
    use isoslice_planar::bead::{cross_section, spacing};
    use isoslice_planar::clip::{intersection, union};
    use isoslice_planar::shapes::rect;
    use isoslice_settings::testing::{plan_with, usual_plan};
    use std::f64::consts::{PI, TAU};

    const HEIGHT: Mm = 0.2;
    const WIDTH: Mm = 0.45;
    /// Radius of the middle of a ring.
    const RADIUS: Mm = 30.0;

    /// A ring whose thickness depends on the angle.
    fn ring(thickness: impl Fn(f64) -> Mm) -> Area {
        let n = 4000;
        let side = |sign: f64| -> Vec<DVec2> {
            let angles = (0..n).map(|k| TAU * f64::from(k) / f64::from(n));
            let radius = |a: f64| RADIUS + sign * 0.5 * thickness(a);
            angles.map(|a| DVec2::from_angle(a) * radius(a)).collect()
        };
        let mut inside = side(-1.0);
        inside.reverse();
        Area::from_iter([side(1.0), inside])
    }

    fn laid(part: &Area) -> Walls {
        walls(part, None, HEIGHT, &usual_plan(WallPlan::of))
    }

    /// Radius and width of the strokes at an angle, from inside.
    fn across_ring(strokes: &[&Stroke], angle: f64) -> Vec<(Mm, Mm)> {
        let out = DVec2::from_angle(angle);
        let left = out.perp();
        let mut found = Vec::new();
        for stroke in strokes {
            for (k, (a, b)) in stroke.segments().enumerate() {
                let (v, w) = (a.dot(left), b.dot(left));
                if (v >= 0.0) != (w >= 0.0) && a.dot(out) > 0.0 {
                    let t = v / (v - w);
                    let widths = [k, k + 1].map(|i| stroke.width_at(i));
                    let width = widths[0] + t * (widths[1] - widths[0]);
                    found.push((a.lerp(b, t).dot(out), width));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }

    fn all(walls: &Walls) -> Vec<&Stroke> {
        walls.lines.iter().chain(&walls.thin).flatten().collect()
    }

    /// Thickness up to which so many strokes lie side by side: two outer walls,
    /// two inner ones, and rings that fill the rest.
    fn most_of(strokes: usize) -> Mm {
        let own = spacing(WIDTH, WIDTH, HEIGHT);
        let extra = WIDTH - own;
        let outer = WIDTH + own;
        let (least, limit) = (0.6 * WIDTH - extra, 1.8 * WIDTH - extra);
        match strokes {
            0 | 1 => 1.8 * WIDTH,
            3 => outer + limit,
            // The walls share a rest that is too thin for a whole line.
            4 => outer + 3.0 * own,
            n if n % 2 == 1 => outer + (n - 3) as f64 * own + limit,
            // The lines of each second pair share what is too thin for a good bead.
            n if n % 4 == 2 => outer + (n - 2) as f64 * own + 0.8 * WIDTH,
            n => outer + (n - 2) as f64 * own + least,
        }
    }

    /// A strip of each thickness has just as many strokes as it should, and they
    /// fill it exactly.
    #[test]
    fn strips_of_known_thickness_are_filled() {
        let plan = Lay::inside(WIDTH, HEIGHT, usual_plan(ThinPlan::of));
        for step in 0..=62 {
            let thick = 0.9 + 0.05 * f64::from(step);
            let walls = laid(&ring(|_| thick));
            let fill = concentric(&walls.fill, plan, 0.001);
            let strokes: Vec<&Stroke> =
                all(&walls).into_iter().chain(&fill).collect();
            let expected = (1..).find(|n| thick <= most_of(*n)).unwrap_or(0);
            for angle in [0.1, 1.3, 2.9, 4.4] {
                let found = across_ring(&strokes, angle);
                assert_eq!(found.len(), expected, "{thick:.2}: {found:?}");
                let section = |&(_, w): &(Mm, Mm)| cross_section(w, HEIGHT);
                let laid: f64 = found.iter().map(section).sum();
                // The surface's two round edges stay open.
                let edges = HEIGHT * HEIGHT * (1.0 - 0.25 * PI);
                let share = laid / (thick * HEIGHT - edges);
                // Walls may overlap by 0.03 mm before they become narrower.
                let more = if expected == 4 { 0.03 / thick } else { 0.0 };
                let range = 0.995..1.005 + more;
                assert!(range.contains(&share), "{thick:.2}: {share}");
                for pair in found.windows(2) {
                    let own: f64 = pair.iter().map(section).sum();
                    let room = HEIGHT * (pair[1].0 - pair[0].0);
                    assert!(0.5 * own / room < 1.1, "{thick:.2}: {found:?}");
                }
                // No wall is wider than a bead in a thin place.
                let widest = found.iter().map(|f| f.1).fold(0.0, f64::max);
                assert!(widest < 1.8 * WIDTH + 0.002, "{thick:.2}: {widest}");
            }
        }
    }

    /// The number of strokes all around a ring, and how often it changes.
    fn numbers(part: &Area) -> (Vec<usize>, usize) {
        let walls = laid(part);
        let plan = Lay::inside(WIDTH, HEIGHT, usual_plan(ThinPlan::of));
        let fill = concentric(&walls.fill, plan, 0.005);
        let strokes: Vec<&Stroke> =
            all(&walls).into_iter().chain(&fill).collect();
        let angles = (0..900).map(|k| 0.001 + TAU * f64::from(k) / 900.0);
        let found: Vec<usize> =
            angles.map(|a| across_ring(&strokes, a).len()).collect();
        let n = found.len();
        let changes = (0..n).filter(|&k| found[k] != found[(k + 1) % n]);
        let changes = changes.count();
        (found, changes)
    }

    #[test]
    fn a_thickness_that_drifts_does_not_change_the_number() {
        let bound = most_of(4);
        // It wavers below the bound, quickly, and about it, slowly.
        for (times, by, below) in [(60.0, 0.015, 0.02), (5.0, 0.04, 0.01)] {
            let part = ring(|a| bound - below + by * (times * a).sin());
            let (found, changes) = numbers(&part);
            assert_eq!((found[0], changes), (4, 0), "{times}");
        }
        // It wavers about the bound so quickly that no long strip is below it.
        let part = ring(|a| bound + 0.015 * (60.0 * a).sin());
        assert_eq!(numbers(&part).1, 0);
        // It drifts far across the bound: the thick half has a bead.
        let (found, changes) = numbers(&ring(|a| bound - 0.15 * a.cos()));
        assert_eq!((found[0], changes), (4, 2));
        // Above the bound all around, nothing is shared.
        let (found, changes) = numbers(&ring(|_| bound + 0.02));
        assert_eq!((found[0], changes), (5, 0));
    }

    /// Of a frame's four lines and a little more the inner walls take all, in
    /// corners as well.
    #[test]
    fn the_corners_of_a_frame_are_shared() {
        let four = most_of(4) - spacing(WIDTH, WIDTH, HEIGHT);
        let frame = |thick: f64| {
            let inside = rect(thick, thick, 30.0 - thick, 20.0 - thick);
            let part = difference(&rect(0.0, 0.0, 30.0, 20.0), &inside);
            (laid(&part), part)
        };
        for more in [0.25, 0.3, 0.35] {
            let (walls, part) = frame(four + more);
            assert!(walls.fill.is_empty(), "{more}: {:?}", walls.fill);
            assert!(walls.thin.iter().all(Vec::is_empty), "{more}");
            assert_eq!(walls.lines.iter().map(Vec::len).sum::<usize>(), 4);
            assert!(walls.gap < 0.01 * part.content(), "{more}: {}", walls.gap);
            // The outer walls are as wide as ever, the inner ones no wider than
            // a bead in a thin place.
            assert!(walls.lines[0].iter().all(|l| l.widths.is_empty()));
            let widths = || walls.lines[1].iter().flat_map(|l| &l.widths);
            let widest = widths().copied().fold(0.0, f64::max);
            assert!(widest < 1.8 * WIDTH + 0.002, "{more}: {widest}");
            let meant = WIDTH + 0.5 * more;
            let usual = widths().filter(|w| (*w - meant).abs() < 0.005);
            assert!(usual.count() >= 8, "{more}: {:?}", walls.lines[1]);
        }
        // Around a corner both walls stay wide, and the inner one bulges.
        for more in [0.25, 0.35] {
            let (walls, _) = frame(four + more);
            for step in 0..=20 {
                let p = DVec2::splat(0.8 + 0.03 * f64::from(step));
                let open = open(&walls, p);
                assert!(open < 0.09, "{more}, {p}: {open}");
            }
        }
        let (walls, _) = frame(four + WIDTH);
        assert!((walls.fill.content() - WIDTH * 92.0).abs() < 1.0);
    }

    /// The tooth of a comb: its inner walls are wide up to its root, where skin or
    /// infill begins.
    #[test]
    fn a_tooth_is_shared_up_to_its_root() {
        for thick in [1.95, 2.0, 2.05] {
            let half = 0.5 * thick;
            let tooth = rect(-half, -1.0, half, 20.0);
            let part = union(&rect(-9.0, -9.0, 9.0, 0.0), &tooth);
            let walls = laid(&part);
            assert!(walls.thin.iter().all(Vec::is_empty), "{thick}");
            let top = walls.fill.bounds().max.y;
            assert!(top < 0.0, "{thick}: {top}");
            // All of the tooth's middle belongs to a wall or to what is left.
            for step in 0..220 {
                let p = DVec2::Y * (18.0 - 0.1 * f64::from(step));
                let open = open(&walls, p);
                assert!(open < 0.06, "{thick}, {p}: {open}");
            }
            // No wall is laid where lines are.
            let wide = walls.lines[1].iter().map(|l| taken(l, 0.043));
            let twice = intersection(&walls.fill, &wide.collect());
            assert!(twice.content() < 0.05, "{thick}: {}", twice.content());
        }
    }

    /// Distance of a place from the next wall's edge, and from what the walls leave.
    fn open(walls: &Walls, p: DVec2) -> Mm {
        if walls.fill.contains(p) {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for stroke in all(walls) {
            for (k, (a, b)) in stroke.segments().enumerate() {
                let t = (p - a).dot(b - a) / (b - a).length_squared();
                let t = t.clamp(0.0, 1.0);
                let [v, w] = [k, k + 1].map(|i| stroke.width_at(i));
                let edge = 0.5 * (v + t * (w - v));
                least = least.min(p.distance(a.lerp(b, t)) - edge);
            }
        }
        least
    }

    /// Where three strips meet that have room for just four lines, the walls take
    /// what is between them.
    #[test]
    fn walls_take_what_is_too_small_for_a_line_where_strips_meet() {
        for thick in [1.72, 1.78] {
            let half = 0.5 * thick;
            let arm = |k: u32| {
                let turn = DVec2::from_angle(TAU * f64::from(k) / 3.0);
                let corners =
                    [(0.0, -half), (9.0, -half), (9.0, half), (0.0, half)];
                Area::from(
                    corners
                        .map(|(x, y)| turn.rotate(DVec2::new(x, y)))
                        .to_vec(),
                )
            };
            let part = union(&union(&arm(0), &arm(1)), &arm(2));
            let open = open(&laid(&part), DVec2::ZERO);
            assert!(open < 0.03, "{thick}: {open}");
        }
    }

    #[test]
    fn nothing_is_shared_where_walls_have_to_be_narrow_or_follow_faces() {
        let part = ring(|_| 2.0);
        let rest = |plan| walls(&part, None, HEIGHT, &plan).fill.content();
        assert_eq!(rest(usual_plan(WallPlan::of)), 0.0);
        assert!(rest(plan_with(WallPlan::of, |s| s.thin_max = 100.0)) > 50.0);
        assert!(
            rest(plan_with(WallPlan::of, |s| s.contour_z = 100.0.into()))
                > 50.0
        );
        // One wall is seen.
        assert!(rest(plan_with(WallPlan::of, |s| s.walls = 1)) > 50.0);
    }

    /// A single wall becomes wider for what is too thin for a line: no line has room
    /// there any more. The strip's thickness waves around that.
    #[test]
    fn what_a_single_wall_takes_is_not_left_for_lines() {
        let plan = plan_with(WallPlan::of, |s| s.walls = 1);
        let lay = plan.lay(0, HEIGHT);
        for thick in [1.05, 1.08, 1.11, 1.14] {
            let side = |x: f64| 0.5 * thick + 0.02 * x.sin();
            let x = |k: i32| 0.05 * f64::from(k);
            let upper = (0..=240).rev().map(|k| DVec2::new(x(k), side(x(k))));
            let lower = (0..=240).map(|k| DVec2::new(x(k), -side(x(k))));
            let part = Area::from(lower.chain(upper).collect::<Vec<_>>());
            let found = walls(&part, None, HEIGHT, &plan);
            let less = lay.width - spacing(lay.width, lay.width, HEIGHT);
            let beads =
                all(&found).into_iter().map(|l| content_of(l, 0.5 * less));
            let laid = beads.sum::<f64>() + found.fill.content();
            let share = laid / part.content();
            // What is thinner than any line stays, and is not laid.
            assert!((0.95..1.08).contains(&share), "{thick}: {share}");
        }
    }
}
