//! The ends of beads in thin places, and thin places that are all end.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━┓     An axis ends where a ball of the strip's width
//!                ╭  / ┃     reaches its end. A bead with a round end leaves
//!   ┄┄┄┄┄┄┄┄┄┄┄┄┄│┄c  ┃     two corners open there; the axis's branches
//!                ╰  \ ┃     lead into them. The bead follows one of them
//!   ━━━━━━━━━━━━━━━━━━┛     until it is half as wide, and crosses over to
//!                           the other.
//! ```
//!
//! At a square end of a strip 2·r thick that adds √2·(r² − r²/4) for the branch
//! and r² for the crossing, 2.06·r² in all. The end has a content of 2·r²,
//! which the length up to c does not include.
//!
//! Where a strip ends in a point or a round tip, the bead goes on as far as the
//! balls reach farther: an axis ends where they touch two sides that are less
//! than 120° apart, as it does not lead into corners.
//!
//! The axis of a post is only a point. The post gets a ring at a quarter of
//! its thickness, half its thickness wide, which has just its content.

use super::medial_axis::Axis;
use super::{Lay, shrink};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Rect, Solid, ring_length, signed_area};

/// Greatest length by which a bead may stick out of the part, mm.
const OUT: Mm = 0.005;
/// Distance up to which a ball is taken to touch the border, mm.
const TOUCHING: Mm = 0.03;

/// Leads axes of what an area is `depth` below its border into the corners
/// and tips at their ends. `grid` holds the area's edges, and nothing leads to
/// where it is thinner than `least`.
pub(super) fn lead_to_ends(
    axes: Vec<Axis>,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> Vec<Axis> {
    let thickest = axes.iter().map(Axis::thickest).fold(0.0, f64::max);
    let lines = axes.iter().map(|r| r.points.iter().copied());
    let beside = EdgeGrid::of_lines(lines, thickest);
    /// Axes that meet end nearer to each other than this share of the thickness.
    const NEAR: f64 = 0.5;
    // An end near to another axis is no tip but part of a junction.
    let junction = |i: usize, end: Option<&DVec2>, t: Option<&Mm>| {
        let (Some(&end), Some(&t)) = (end, t) else {
            return true;
        };
        let mut found = false;
        beside.visit_edges_near(end, end, NEAR * t, |edge| {
            found |= beside.owner(edge) != i;
        });
        found
    };
    let tips: Vec<[bool; 2]> = axes
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let (p, t) = (&r.points, &r.thickness);
            [(p.first(), t.first()), (p.last(), t.last())]
                .map(|(p, t)| !junction(i, p, t))
        })
        .collect();
    axes.into_iter()
        .zip(tips)
        .map(|(axis, tips)| lead(axis, tips, &beside, grid, depth, least))
        .collect()
}

/// Leads an axis into the corners at its ends, and where there are `tips`, at
/// its first point and at its last one, into those. `lines` holds all axes.
fn lead(
    mut axis: Axis,
    tips: [bool; 2],
    lines: &EdgeGrid,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> Axis {
    if axis.closed {
        return axis;
    }
    for is_tip in tips {
        axis.points.reverse();
        axis.thickness.reverse();
        let square = corners(&axis, grid, depth, least);
        let more: Vec<(DVec2, Mm)> = match square[0] {
            Some(_) => square.into_iter().flatten().collect(),
            None if is_tip => tip(&axis, lines, grid, depth, least),
            None => Vec::new(),
        };
        for (p, t) in more {
            axis.points.push(p);
            axis.thickness.push(t);
        }
    }
    axis
}

/// Where an axis goes on into a point or a round tip behind its last point,
/// and how thick it is there: no thinner than `least`, or than the axis's last
/// point if that is thinner still. `lines` holds all axes.
fn tip(
    axis: &Axis,
    lines: &EdgeGrid,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> Vec<(DVec2, Mm)> {
    /// Distance of the balls, mm.
    const BALL_STEP: Mm = 0.04;
    /// Length of the longest tip, as a share of the thickness where it begins:
    /// its sides are at least 60° apart.
    const LONG: f64 = 1.2;
    /// Least share of its way by which a ball reaches farther than the last.
    const GAIN: f64 = 0.05;
    let mut balls = Vec::new();
    let (Some(&end), Some(&t)) = (axis.points.last(), axis.thickness.last())
    else {
        return balls;
    };
    let far = 0.5 * t;
    let back = axis
        .points
        .iter()
        .rev()
        .find(|p| p.distance(end) > BALL_STEP);
    let Some(mut ahead) = back.and_then(|b| (end - *b).try_normalize()) else {
        return balls;
    };
    let radius = |p: DVec2| match grid.nearest_edge(p, 2.0 * far + depth) {
        Some((_, q)) => p.distance(q) - depth,
        None => f64::INFINITY,
    };
    let (mut c, mut r) = (end, far);
    while c.distance(end) < LONG * t {
        // The middle between the sides is where a ball is largest.
        let side = ahead.perp() * BALL_STEP;
        let at = |share: f64| c + BALL_STEP * ahead + share * side;
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..8 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if radius(at(a)) < radius(at(b)) {
                low = a
            } else {
                high = b
            }
        }
        let next = at(0.5 * (low + high));
        let reach = radius(next).min(r);
        let way = next.distance(c);
        // A strip that becomes wider ends in a junction, not in a tip.
        let widens = radius(next) > r + 0.1 * BALL_STEP;
        let done = way + reach - r < GAIN * way;
        // An axis that has turned back there leads nowhere.
        let mut back = false;
        let away = 0.7 * next.distance(end);
        lines.visit_edges_near(next, next, away, |_| back = true);
        if widens || done || back || reach < 0.5 * least {
            break;
        }
        ahead = (next - c).normalize_or(ahead);
        (c, r) = (next, reach);
        balls.push((c, 2.0 * r));
    }
    // Moves as short as these steps gain nothing: every other ball will do,
    // counted from the last, without the first.
    let count = balls.len();
    let mut i = 0;
    balls.retain(|_| {
        i += 1;
        i == count || (i > 1 && (count - i).is_multiple_of(2))
    });
    balls
}

/// Where an axis goes on into the corners at its last point, and how thick
/// it is there.
fn corners(
    axis: &Axis,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> [Option<(DVec2, Mm)>; 2] {
    let (Some(&c), Some(&t)) = (axis.points.last(), axis.thickness.last())
    else {
        return [None; 2];
    };
    let r = 0.5 * t;
    let narrow = (0.5 * r).max(0.5 * least);
    let back = axis.points.iter().rev().find(|p| p.distance(c) > 0.5 * r);
    let (Some(&back), true) = (back, narrow < 0.85 * r) else {
        return [None; 2];
    };
    let ahead = (c - back).normalize_or_zero();
    let fits = |p: DVec2, radius: Mm| {
        grid.nearest_edge(p, (radius + depth - OUT).max(0.0))
            .is_none()
    };
    // The distance of the axis's end from the area's own border.
    let whole = r + depth;
    let touch = |towards: DVec2| {
        let half = 0.5 * whole;
        let (_, q) = grid.nearest_edge(c + half * towards, half + TOUCHING)?;
        let facing = (q - c).dot(towards) > 0.7 * q.distance(c);
        (facing && q.distance(c) < whole + TOUCHING).then_some(q - c)
    };
    let Some(front) = touch(ahead) else {
        return [None; 2];
    };
    let corner = |sideways: DVec2| {
        let side = touch(sideways)?;
        // The corner is where the border's tangents at both touches meet.
        let det = front.perp_dot(side);
        let (f, s) = (front.length_squared(), side.length_squared());
        let corner =
            DVec2::new(f * side.y - s * front.y, s * front.x - f * side.x)
                / det;
        let far = corner.length() / whole;
        if !(1.1..2.1).contains(&far) {
            return None;
        }
        let at = |radius: Mm| c + corner * ((r - radius) / whole);
        let clear = fits(at(narrow), narrow)
            && fits(at(0.5 * (narrow + r)), 0.5 * (narrow + r));
        clear.then(|| (at(narrow), 2.0 * narrow))
    };
    match (corner(ahead.perp()), corner(-ahead.perp())) {
        (Some(a), Some(b)) if fits(a.0.midpoint(b.0), narrow) => {
            [Some(a), Some(b)]
        }
        (a, b) => [a.or(b), None],
    }
}

/// Approximate thickness of an island that is about as long as it is wide.
fn thickness(ring: &[DVec2]) -> Mm {
    4.0 * signed_area(ring) / ring_length(ring).max(f64::MIN_POSITIVE)
}

/// True if an island is a post in which a wall has room for its bead only, if
/// that may be as narrow as `least`.
fn is_post(ring: &[DVec2], lay: Lay, least: Mm) -> bool {
    let bounds = Rect::around(ring);
    let size = bounds.size().max_element();
    size < 2.0 * lay.limit && (least..=lay.limit).contains(&thickness(ring))
}

/// Gives posts, islands about as long as they are wide that are too thin for
/// a wall and have no axis, a ring that fills them. The ring is no narrower
/// than `least`.
pub(super) fn fill_posts(
    lines: &mut Vec<Stroke>,
    thin: &[Stroke],
    outline: &Solid<'_>,
    lay: Lay,
    least: Mm,
    tolerance: Mm,
) {
    let rings = &outline.area().rings;
    let mut post: Vec<bool> =
        rings.iter().map(|r| is_post(r, lay, least)).collect();
    if !post.contains(&true) {
        return;
    }
    let ring_of = |line: &Stroke| {
        let p = *line.points.first()?;
        outline
            .grid()
            .nearest_within(p, lay.limit)
            .map(|(ring, _)| ring)
    };
    for ring in thin.iter().filter_map(ring_of) {
        post[ring] = false;
    }
    lines.retain(|line| ring_of(line).is_none_or(|ring| !post[ring]));
    for (ring, _) in rings.iter().zip(&post).filter(|(_, p)| **p) {
        let width = (0.5 * thickness(ring)).max(least);
        let one = Area::from(ring.clone());
        let rings = shrink(&one, 0.5 * width, tolerance).rings;
        lines.extend(
            rings
                .into_iter()
                .map(|points| Stroke::new(points, true, width)),
        );
    }
}
