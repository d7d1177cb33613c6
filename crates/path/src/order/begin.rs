//! Where a closed bead begins.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Bead;
use isoslice_planar::grid::nearest_on;

/// A place that is nearer than this to one of a bead's points is taken for that
/// point, mm.
const SAME: Mm = 0.01;

/// A place on a bead: the index of a segment, and a point on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    segment: usize,
    pub at: DVec2,
}

/// The place of a bead nearest to `p`.
pub(super) fn nearest_spot(bead: &Bead, p: DVec2) -> Option<Spot> {
    best(bead, |a, b| [nearest_on(p, a, b); 1], |q| q.distance(p))
}

/// The place of a bead with the shortest way from `a` over it to `b`. Only the
/// bead's points and the places nearest to `a` and to `b` are tried.
pub(super) fn spot_between(bead: &Bead, a: DVec2, b: DVec2) -> Option<Spot> {
    best(
        bead,
        |p, q| [nearest_on(a, p, q), nearest_on(b, p, q), p],
        |q| q.distance(a) + q.distance(b),
    )
}

/// The point with the least cost, of some points of each segment.
fn best<const N: usize>(
    bead: &Bead,
    points: impl Fn(DVec2, DVec2) -> [DVec2; N],
    cost: impl Fn(DVec2) -> Mm,
) -> Option<Spot> {
    let spots =
        bead.stroke
            .segments()
            .enumerate()
            .flat_map(|(segment, (a, b))| {
                points(a, b).map(|at| Spot { segment, at })
            });
    spots
        .map(|spot| (cost(spot.at), spot))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, spot)| spot)
}

/// Lets a closed bead begin at its place nearest to `p`, which becomes a point
/// of it.
pub fn begin_near(bead: &mut Bead, p: DVec2) {
    if let Some(spot) = nearest_spot(bead, p) {
        begin_at(bead, spot);
    }
}

/// Lets a closed bead begin at a place on it.
pub(super) fn begin_at(bead: &mut Bead, spot: Spot) {
    let Spot { segment: i, at: p } = spot;
    let next = (i + 1) % bead.stroke.points.len();
    let (a, b) = (bead.stroke.points[i], bead.stroke.points[next]);
    if p.distance(a) < SAME {
        bead.stroke.begin_at(i);
    } else if p.distance(b) < SAME {
        bead.stroke.begin_at(next);
    } else {
        if let (Some(&u), Some(&v)) =
            (bead.stroke.widths.get(i), bead.stroke.widths.get(next))
        {
            let t = a.distance(p) / a.distance(b);
            bead.stroke.widths.insert(i + 1, u + t * (v - u));
        }
        if !bead.stroke.levels.is_empty() {
            let t = a.distance(p) / a.distance(b);
            let level = bead.stroke.level(i).lerp(bead.stroke.level(next), t);
            bead.stroke.levels.insert(i + 1, level);
        }
        bead.stroke.points.insert(i + 1, p);
        bead.stroke.begin_at(i + 1);
    }
}
