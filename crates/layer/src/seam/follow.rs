//! Where the seam of a wall is, given the seam below it or its planned place.
//!
//! A seam that may be in several corners takes the one nearest to that place.
//! Corners that hang are left to those that lie over solid ground.

use super::{BACK, Site, along};
use crate::view::LayerFace;
use crate::walls::hanging;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::{EdgeGrid, nearest_on};
use isoslice_planar::path_length;

/// Distance by which a corner may move for a seam to follow it, mm.
const REACH: Mm = 2.0;
/// By how much a seam that is not in a corner goes back to its own place
/// from one layer to the next, mm.
pub(super) const PULL: Mm = 0.1;
/// Overhangs, as shares of the layer's height, that differ by less count as
/// alike for a seam that has no place yet: 6° near the upright.
const ALIKE: f64 = 0.1;
/// A seam leaves a place whose overhang is greater by this than another's: 17°.
/// This is more than [`ALIKE`], so that seams do not go to and fro.
const STEEPER: f64 = 0.3;
/// A planned seam leaves a place whose overhang is greater by this than another's:
/// 45°. The look from which the seam comes has left
/// places that are steeper by [`STEEPER`], and each layer decides for itself. So
/// where the overhang is about that great, seams would go to and fro.
const MUCH_STEEPER: f64 = 1.0;
/// Number of places of a ring without corners that are looked at.
const LOOKS: usize = 64;

/// What holds a layer: the layer below, whose outline differs.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    here: LayerFace<'a>,
    below: LayerFace<'a>,
}

impl<'a> Ground<'a> {
    /// What holds a layer on the layer below; none if their outlines are equal,
    /// or if there is nothing below.
    pub fn of(here: LayerFace<'a>, below: LayerFace<'a>) -> Option<Ground<'a>> {
        let (area, lower) = (here.outline.area(), below.outline.area());
        let differs = !here.is_like(&below) && area != lower;
        (differs && !lower.is_empty()).then_some(Ground { here, below })
    }

    /// True if the layer below has the part at a point.
    pub fn holds(&self, p: DVec2) -> bool {
        self.below.outline.grid().contains(p)
    }

    /// True if the layer below holds no place of a stroke.
    pub fn hangs(&self, stroke: &Stroke) -> bool {
        let below = self.below.outline.grid();
        hanging(stroke, below).all(|(_, far)| far.is_some())
    }

    /// How far the outline beside a point reaches beyond the layer below, as a
    /// share of the layer's height. It is 0 where the outline recedes.
    fn overhang(&self, p: DVec2) -> f64 {
        let depth = |grid: &EdgeGrid| {
            let away = grid.nearest(p).map_or(0.0, |near| near.1.distance(p));
            if grid.contains(p) { away } else { -away }
        };
        let (here, below) = (self.here.outline.grid(), self.below.top.grid());
        let over = depth(here) - depth(below);
        (over / self.here.span.height()).max(0.0)
    }
}

/// Overhang at a point, which is 0 if the layer has the outline of that below.
fn overhang(ground: Option<Ground<'_>>, p: DVec2) -> f64 {
    ground.map_or(0.0, |ground| ground.overhang(p))
}

/// The seam below a ring.
#[derive(Clone, Copy, Debug)]
pub struct Below {
    /// The point of the ring nearest to that seam.
    pub at: DVec2,
    /// Distance up to which a corner is taken for the seam's.
    pub reach: Mm,
    /// By how much the seam goes back to its own place.
    pub pull: Mm,
    /// The seam leaves a place whose overhang is greater by this than another's.
    steeper: f64,
}

impl Below {
    /// A seam that was planned at the place `at`.
    pub fn planned(at: DVec2) -> Below {
        Below {
            steeper: MUCH_STEEPER,
            ..Below::lower(at, 0, 0.0)
        }
    }

    /// A seam this number of layers below, by the point nearest to where it
    /// would be after moving on evenly by `way`.
    pub(super) fn lower(at: DVec2, layers: usize, way: Mm) -> Below {
        Below {
            at,
            reach: reach(way),
            pull: layers as f64 * PULL,
            steeper: STEEPER,
        }
    }
}

/// Distance up to which a seam is looked for that moves by `way`.
pub(super) fn reach(way: Mm) -> Mm {
    REACH + 0.5 * way
}

/// Where the seam of a ring is. `below` is the seam below, if there is one, and
/// `ground` what holds the layer, if that differs from the layer.
pub fn follow(
    site: &Site,
    ring: &[DVec2],
    below: Option<Below>,
    ground: Option<Ground<'_>>,
) -> Option<DVec2> {
    if !site.follows {
        return site.at.or(below.map(|below| below.at));
    }
    let Some(below) = below else {
        return own(site, ring, ground);
    };
    if site.corners.is_empty() {
        let own = own(site, ring, ground)?;
        return if steeper(below.at, own, below.steeper, ground) {
            Some(own)
        } else {
            toward(ring, below.at, own, below.pull)
        };
    }
    let held = held(&site.corners, ground, below.steeper);
    let near = held.map(|c| (c.distance(below.at), c));
    let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((away, corner)) if away <= below.reach => Some(corner),
        _ => own(site, ring, ground),
    }
}

/// True if the overhang at `p` is greater by `more` than that at `q`, and than
/// none.
fn steeper(p: DVec2, q: DVec2, more: f64, ground: Option<Ground<'_>>) -> bool {
    ground.is_some_and(|ground| {
        let at = ground.overhang(p);
        at > more && at > ground.overhang(q) + more
    })
}

/// The points whose overhang exceeds the least of all by `more` at most.
fn held<'p>(
    points: &'p [DVec2],
    ground: Option<Ground<'_>>,
    more: f64,
) -> impl Iterator<Item = DVec2> + 'p {
    let overhangs: Vec<f64> =
        points.iter().map(|&p| overhang(ground, p)).collect();
    let least = overhangs.iter().copied().fold(f64::INFINITY, f64::min);
    let all = points.iter().copied().zip(overhangs);
    all.filter(move |(_, over)| *over <= least + more)
        .map(|held| held.0)
}

/// Where the seam of a ring is if it follows none. Of several sharp corners it
/// is the rearmost one over the ground, so that the next layer takes it, too.
fn own(
    site: &Site,
    ring: &[DVec2],
    ground: Option<Ground<'_>>,
) -> Option<DVec2> {
    if !site.sharp.is_empty() {
        return held(&site.sharp, ground, ALIKE)
            .max_by(|a, b| BACK.dot(*a).total_cmp(&BACK.dot(*b)));
    }
    let at = site.at?;
    if overhang(ground, at) <= STEEPER {
        return Some(at);
    }
    // From the own place to both sides, as far as the ring's other end.
    let (from, length) = place(ring, at);
    let step = length / LOOKS as f64;
    let around = (0..LOOKS).map(|k| {
        let steps = k.div_ceil(2) as f64;
        let way = if k % 2 == 1 { steps } else { -steps } * step;
        along(ring, (from + way).rem_euclid(length)).unwrap_or(at)
    });
    let around: Vec<DVec2> = around.collect();
    let nearest = held(&around, ground, ALIKE).next();
    Some(
        nearest
            .filter(|p| steeper(at, *p, STEEPER, ground))
            .unwrap_or(at),
    )
}

/// The length along a ring at which it passes a point, and the ring's length.
fn place(ring: &[DVec2], p: DVec2) -> (Mm, Mm) {
    let mut length = 0.0;
    let mut best = (f64::INFINITY, 0.0);
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let q = nearest_on(p, a, b);
        let d = q.distance_squared(p);
        if d < best.0 {
            best = (d, length + a.distance(q));
        }
        length += a.distance(b);
    }
    (best.1, length)
}

/// The point reached from `from` on the shorter way along the ring to `to`, at
/// most `pull` away.
fn toward(ring: &[DVec2], from: DVec2, to: DVec2, pull: Mm) -> Option<DVec2> {
    if from.distance(to) <= pull {
        return Some(to);
    }
    let all = path_length(ring, true);
    let (a, b) = (place(ring, from).0, place(ring, to).0);
    let ahead = (b - a).rem_euclid(all);
    let step = if ahead < 0.5 * all {
        pull.min(ahead)
    } else {
        -pull.min(all - ahead)
    };
    along(ring, (a + step).rem_euclid(all))
}
