//! Places too thin for a bead that get one all the same: webs and fins.
//!
//! ```text
//!   ━━━━━━━━╮        ╭━━━━━━━   Two teeth hang together by a web of 0.16 mm. No
//!           ╰╴━━━━━━╶╯          bead is as thin as that, so one that is a little
//!   ━━━━━━━━╮        ╭━━━━━━━   too wide runs along the web, from tooth to tooth.
//!           ╰────────╯          Without it the part would come in pieces, and a fin
//!                               or the hairline of a letter would be lost.
//! ```
//!
//! In: the axes of a part's outline, then their numbers of beads. Out: axes that reach
//! into what a web holds together, and numbers with one bead along each web and each fin.
//!
//! An axis ends where the sides of the area lie at an angle, as they do beside most
//! webs. In the tip of a wedge only a short way is too thin, unless the wedge is sharp:
//! that is no fin, and the bead ends where the wedge is as thin as a bead can be.

use super::medial_axis::Axis;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;

/// Least thickness of a web or a fin, as a share of the thinnest bead's width. With the
/// usual widths the bead sticks out by 0.075 mm on each side at most.
pub const LEAST: f64 = 0.45;
/// Least length of a thin place that does not lie between thicker ones, mm. In tips with
/// sides more than 14° apart it is shorter.
const FIN: Mm = 0.6;
/// Length of the axis that tells its direction, mm.
const STRAIGHT: Mm = 0.15;
/// Length of each step into what a web holds, mm.
const STEP: Mm = 0.05;
/// Greatest number of such steps: between sides 30° apart a place of 0.16 mm is as thick
/// as a wall after 0.6 mm.
const STEPS: usize = 20;
/// By how much the area may become thinner in a step, mm: borders are polygons.
const SLACK: Mm = 0.005;

/// An axis that has webs or fins, led on to where the area is thick if it is a web or ends
/// in one; nothing if it has none. Beads are laid from the thickness `bead` on, and walls close at `wall`.
pub(super) fn led_on(
    axis: &Axis,
    grid: &EdgeGrid,
    [bead, wall]: [Mm; 2],
) -> Option<Axis> {
    let least = LEAST * bead;
    let is_web = |a: Mm, b: Mm| a.min(b) < bead && a.max(b) > least;
    if !axis.segments().any(|(a, b)| is_web(a.1, b.1)) {
        return None;
    }
    let mut axis = axis.clone();
    if axis.closed || axis.points.len() < 2 {
        return Some(axis);
    }
    // A fin is not led on into what it stands on. Only what is thin from end to end and
    // opens at both is.
    let fin = axis
        .thickness
        .iter()
        .all(|t| *t < bead)
        .then(|| axis.clone());
    for _ in 0..2 {
        axis.points.reverse();
        axis.thickness.reverse();
        if axis.thickness.last().is_some_and(|t| *t >= bead) {
            continue;
        }
        // Where two lines of balls have met, the last one may lead back.
        while let [.., inner, next, end] = axis.points.as_slice()
            && (*end - *next).dot(*next - *inner) < 0.0
        {
            axis.points.pop();
            axis.thickness.pop();
        }
        let (&end, &t) = axis.points.last().zip(axis.thickness.last())?;
        if t >= bead {
            continue;
        }
        // The last points of an axis lie close together, and a little to the sides.
        let far = |p: &&DVec2| p.distance(end) >= STRAIGHT;
        let before = axis.points.iter().rev().find(far);
        let along = before.or(axis.points.first()).map(|p| end - *p)?;
        let along = along.normalize_or_zero();
        let more = way_out((end, along, t), [bead, wall], grid);
        if more.is_none() && fin.is_some() {
            return fin;
        }
        for (p, t) in more.into_iter().flatten() {
            axis.points.push(p);
            axis.thickness.push(t);
        }
    }
    Some(axis)
}

/// The way on from a place in a direction, to where the area is as thick as `wall`, or as
/// thick as it gets if that is enough for a bead; nothing if the area does not open there.
fn way_out(
    (mut at, mut along, mut thickness): (DVec2, DVec2, Mm),
    [bead, wall]: [Mm; 2],
    grid: &EdgeGrid,
) -> Option<Vec<(DVec2, Mm)>> {
    let mut way: Vec<(DVec2, Mm)> = Vec::new();
    for _ in 0..STEPS {
        at += STEP * along;
        let (_, q) = grid.nearest_edge(at, wall)?;
        let t = 2.0 * at.distance(q);
        if t < thickness - SLACK || !grid.contains(at) {
            break;
        }
        way.push((at, t));
        if t >= wall {
            break;
        }
        thickness = t;
        // Away from the nearer side, which keeps the way in the middle.
        along = (along + (at - q).normalize_or_zero()).normalize_or_zero();
    }
    (way.last()?.1 >= bead).then_some(way)
}

/// Gives one bead to the webs and fins of an axis: places thinner than a bead of thickness
/// `bead` that lie between thicker ones or are long. Thicker places beside a web that have
/// no bead get one, too. Returns true if there are any webs or fins.
pub(super) fn lay(axis: &Axis, bead: Mm, numbers: &mut [usize]) -> bool {
    let segments: Vec<_> = axis.segments().collect();
    let thick = |k: usize| {
        let (a, b) = segments[k];
        0.5 * (a.1 + b.1) >= bead
    };
    let thin = |k: usize| {
        let (a, b) = segments[k];
        !thick(k) && a.1.min(b.1) >= LEAST * bead
    };
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    // A closed axis is looked at once round, from a place on that has a bead if there is
    // one: what gets beads here then ends before it.
    if axis.closed {
        let has_bead = |&k: &usize| numbers[k] > 0 && !thin(k);
        let first = order.iter().copied().find(has_bead);
        let first = first.or(order.iter().copied().find(|&k| !thin(k)));
        order.rotate_left(first.unwrap_or(0));
        order.extend(first);
    }
    let mut laid = false;
    let mut from = 0;
    while let Some(begin) = (from..order.len()).find(|&i| thin(order[i])) {
        let end = (begin..order.len()).find(|&i| !thin(order[i]));
        let end = end.unwrap_or(order.len());
        from = end;
        let place = order[begin..end].iter().map(|&k| &segments[k]);
        let length: Mm = place.map(|(a, b)| a.0.distance(b.0)).sum();
        let thick_at = |i: usize| order.get(i).is_some_and(|&k| thick(k));
        let is_web = begin > 0 && thick_at(begin - 1) && thick_at(end);
        if !is_web && length < FIN {
            continue;
        }
        // A fin ends at the wall of what it stands on, whose ring stays whole.
        let bare = |k: &&usize| is_web && thick(**k) && numbers[**k] == 0;
        let before = order[..begin].iter().rev().take_while(bare).count();
        let after = order[end..].iter().take_while(bare).count();
        for &k in &order[begin - before..end + after] {
            numbers[k] = 1;
        }
        laid = true;
    }
    laid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::{WallPlan, walls};
    use isoslice_planar::Area;
    use isoslice_planar::bead::Stroke;
    use isoslice_planar::clip::union;
    use isoslice_planar::rect;
    use isoslice_settings::testing::usual_plan;

    /// The number of pieces of the beads of an outline.
    fn pieces(outline: &Area) -> usize {
        let plan = usual_plan(WallPlan::of);
        let walls = walls(outline, None, 0.2, &plan);
        let strokes: Vec<&Stroke> =
            walls.lines.iter().chain(&walls.thin).flatten().collect();
        let touch = |a: &Stroke, b: &Stroke| {
            let reach = 0.5 * (a.width.max(0.2) + b.width.max(0.2));
            a.points.iter().any(|p| {
                b.segments().any(|(c, d)| {
                    isoslice_planar::grid::nearest_on(*p, c, d).distance(*p)
                        < reach
                })
            })
        };
        let mut piece: Vec<usize> = (0..strokes.len()).collect();
        for i in 0..strokes.len() {
            for k in 0..strokes.len() {
                if touch(strokes[i], strokes[k])
                    || touch(strokes[k], strokes[i])
                {
                    let (a, b) = (piece[i], piece[k]);
                    piece.iter_mut().filter(|p| **p == b).for_each(|p| *p = a);
                }
            }
        }
        piece.sort_unstable();
        piece.dedup();
        piece.len()
    }

    /// A tooth of 4 mm with its tip at a place, to the right or to the left.
    fn tooth(tip: f64, way: f64, half: f64) -> Area {
        let ring = [
            (tip, -half),
            (tip + 4.0 * way, -2.5),
            (tip + 4.0 * way, 2.5),
            (tip, half),
        ];
        let mut ring = ring.map(DVec2::from).to_vec();
        if way < 0.0 {
            ring.reverse();
        }
        Area::from(ring)
    }

    #[test]
    fn what_a_web_holds_together_is_printed_in_one_piece() {
        for thickness in [0.13, 0.16, 0.22, 0.26] {
            let half = 0.5 * thickness;
            for length in [0.3, 1.0, 2.0] {
                let web = rect(-0.1, -half, length + 0.1, half);
                let teeth =
                    union(&tooth(length, 1.0, half), &tooth(0.0, -1.0, half));
                let blocks = union(
                    &rect(length, -2.0, length + 4.0, 2.0),
                    &rect(-4.0, -2.0, 0.0, 2.0),
                );
                for ends in [teeth, blocks] {
                    let whole = union(&ends, &web);
                    assert_eq!(pieces(&whole), 1, "{thickness} {length}");
                }
            }
        }
    }

    /// A ring with one web, and a thicker place without a bead on both sides of it.
    #[test]
    fn a_web_of_a_ring_gets_its_bead_wherever_the_ring_begins() {
        const N: usize = 40;
        let at = |k: usize| {
            let turn = std::f64::consts::TAU * k as f64 / N as f64;
            2.0 * DVec2::from_angle(turn)
        };
        let thickness = |k: usize| match k % N {
            18..=21 => 0.16,
            15..=24 => 0.3,
            _ => 0.5,
        };
        let number = |k: usize| usize::from(!(16..23).contains(&(k % N)));
        for first in 0..N {
            let all = || first..first + N;
            let axis = Axis {
                points: all().map(at).collect(),
                thickness: all().map(thickness).collect(),
                closed: true,
            };
            let mut numbers: Vec<usize> = all().map(number).collect();
            lay(&axis, 0.27, &mut numbers);
            assert_eq!(numbers, vec![1; N], "{first}");
            // A ring that is as thin all around.
            let thin = Axis {
                thickness: vec![0.16; N],
                ..axis
            };
            let mut numbers = vec![0; N];
            lay(&thin, 0.27, &mut numbers);
            assert_eq!(numbers, vec![1; N]);
        }
    }

    #[test]
    fn fins_are_printed_and_tips_end_where_they_are_thin() {
        let block = rect(0.0, -2.0, 4.0, 2.0);
        let plan = usual_plan(WallPlan::of);
        let far = |area: &Area| {
            let walls = walls(area, None, 0.2, &plan);
            let all = walls.lines.iter().chain(&walls.thin).flatten();
            let points = all.flat_map(|s| s.points.clone());
            points.map(|p| p.x).fold(0.0, f64::max)
        };
        // Those of 0.13 and 0.16 mm are tabs if they are short.
        let tab = |half: f64| union(&block, &rect(3.9, -half, 4.3, half));
        assert!(far(&tab(0.065)) < 4.1 && far(&tab(0.08)) < 4.1);
        for thickness in [0.13, 0.16, 0.26] {
            let half = 0.5 * thickness;
            let fin = |to: f64| union(&block, &rect(3.9, -half, to, half));
            for to in [5.0, 20.0] {
                // It begins at the block's wall.
                let walls = walls(&fin(to), None, 0.2, &plan);
                let mut all = walls.lines.iter().chain(&walls.thin).flatten();
                let ends = |s: &Stroke| {
                    let x = |p: &DVec2| p.x;
                    let far = s.points.iter().map(x).fold(0.0, f64::max);
                    let near = s.points.iter().map(x).fold(far, f64::min);
                    near < 4.0 && (to - 0.3..to).contains(&far)
                };
                assert!(all.any(ends), "{thickness} {to}");
            }
            // One that stands on its own, and a long one between blocks.
            assert_eq!(pieces(&rect(0.0, 0.0, 1.5, thickness)), 1);
            let wide = union(&block, &rect(14.0, -2.0, 18.0, 2.0));
            assert_eq!(pieces(&union(&wide, &fin(14.1))), 1);
        }
        assert_eq!(pieces(&rect(0.0, 0.0, 1.5, 0.1)), 0);
        // A tip with sides 4° apart is 0.12 mm thick at 13.26, with one of its points
        // moved or not, and 0.27 mm at 11.13.
        for off in [0.0, 0.02] {
            let sharp = [(4.0, -0.384), (15.0, 0.0), (9.5, 0.192 + off)];
            let sharp = sharp.map(DVec2::from).to_vec();
            let end = [sharp, vec![DVec2::new(4.0, 0.384)]].concat();
            let end = far(&Area::from(end));
            assert!((12.5..13.6).contains(&end), "{off} {end}");
        }
        // Sides 20° apart: the tip is at 15, and 0.27 mm thick at 14.23.
        let wedge = Area::from(
            [(4.0, -1.94), (15.0, 0.0), (4.0, 1.94)]
                .map(DVec2::from)
                .to_vec(),
        );
        assert!((14.0..14.5).contains(&far(&wedge)), "{}", far(&wedge));
    }
}
