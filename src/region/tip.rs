//! The ends of beads in thin places, and thin places that are all end.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━┓     A ridge ends where a ball of the strip's width
//!                ╭  / ┃     reaches its end. A bead with a round end leaves
//!   ┄┄┄┄┄┄┄┄┄┄┄┄┄│┄c  ┃     two corners open there; the ridge's branches
//!                ╰  \ ┃     lead into them. The bead follows one of them
//!   ━━━━━━━━━━━━━━━━━━┛     until it is half as wide, and crosses over to
//!                           the other.
//! ```
//!
//! At a square end of a strip 2·r thick that adds √2·(r² − r²/4) for the
//! branch and r² for the crossing, 2.06·r² in all: what is extruded for the
//! end of 2·r², which the length up to c does not include.
//!
//! A post has no ridge but a point: a ring at a quarter of its thickness,
//! half its thickness wide, has just its content.

use super::ridge::Ridge;
use super::{Lay, shrink};
use crate::bead::Stroke;
use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, Rect, Solid, ring_length, signed_area};
use crate::units::Mm;
use glam::DVec2;

/// By how much a bead may stick out of the part, mm.
const OUT: Mm = 0.005;
/// Distance up to which a ball is taken to touch the border, mm.
const TOUCHING: Mm = 0.03;

/// Leads a ridge of what an area is `depth` below its border into the corners
/// at its ends. `grid` holds the area's edges, and between the corners there
/// is to be at least the thickness `least`.
pub(super) fn square_ends(
    mut ridge: Ridge,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> Ridge {
    if ridge.closed {
        return ridge;
    }
    for _ in 0..2 {
        ridge.points.reverse();
        ridge.thickness.reverse();
        for (p, t) in corners(&ridge, grid, depth, least).into_iter().flatten()
        {
            ridge.points.push(p);
            ridge.thickness.push(t);
        }
    }
    ridge
}

/// Where a ridge goes on into the corners at its last point, and how thick
/// it is there.
fn corners(
    ridge: &Ridge,
    grid: &EdgeGrid,
    depth: Mm,
    least: Mm,
) -> [Option<(DVec2, Mm)>; 2] {
    let (Some(&c), Some(&t)) = (ridge.points.last(), ridge.thickness.last())
    else {
        return [None; 2];
    };
    let r = 0.5 * t;
    let narrow = (0.5 * r).max(0.5 * least);
    let back = ridge.points.iter().rev().find(|p| p.distance(c) > 0.5 * r);
    let (Some(&back), true) = (back, narrow < 0.85 * r) else {
        return [None; 2];
    };
    let ahead = (c - back).normalize_or_zero();
    let fits = |p: DVec2, radius: Mm| {
        grid.nearest_edge(p, (radius + depth - OUT).max(0.0))
            .is_none()
    };
    // How far it is from the area's own border.
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

/// Gives posts, islands about as long as they are wide that are too thin for
/// a wall and have no ridge, a ring that fills them.
pub(super) fn fill_posts(
    lines: &mut Vec<Stroke>,
    thin: &[Stroke],
    outline: &Solid<'_>,
    lay: Lay,
    tolerance: Mm,
) {
    let thickness = |ring: &[DVec2]| {
        4.0 * signed_area(ring) / ring_length(ring).max(f64::MIN_POSITIVE)
    };
    let rings = &outline.area().rings;
    let mut post: Vec<bool> = rings
        .iter()
        .map(|ring| {
            let bounds = Rect::around(ring);
            let size = (bounds.max - bounds.min).max_element();
            size < 2.0 * lay.limit
                && (lay.least..=lay.limit).contains(&thickness(ring))
        })
        .collect();
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
        let width = (0.5 * thickness(ring)).max(lay.least);
        let one = Area {
            rings: vec![ring.clone()],
        };
        let rings = shrink(&one, 0.5 * width, tolerance).rings;
        lines.extend(
            rings
                .into_iter()
                .map(|points| Stroke::new(points, true, width)),
        );
    }
}
