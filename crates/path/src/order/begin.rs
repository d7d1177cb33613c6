//! Where a closed stroke begins.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::nearest_on;

/// A place that is nearer than this to one of a stroke's points is taken for that
/// point, mm.
const SAME: Mm = 0.01;

/// A place on a stroke: the index of a segment, and a point on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    segment: usize,
    pub at: DVec2,
}

/// The place of a stroke nearest to `p`.
pub(super) fn nearest_spot(stroke: &Stroke, p: DVec2) -> Option<Spot> {
    best(stroke, |a, b| [nearest_on(p, a, b); 1], |q| q.distance(p))
}

/// The place of a stroke with the shortest way from `a` over it to `b`. Only the
/// stroke's points and the places nearest to `a` and to `b` are tried.
pub(super) fn spot_between(
    stroke: &Stroke,
    a: DVec2,
    b: DVec2,
) -> Option<Spot> {
    best(
        stroke,
        |p, q| [nearest_on(a, p, q), nearest_on(b, p, q), p],
        |q| q.distance(a) + q.distance(b),
    )
}

/// The point with the least cost, of some points of each segment.
fn best<const N: usize>(
    stroke: &Stroke,
    points: impl Fn(DVec2, DVec2) -> [DVec2; N],
    cost: impl Fn(DVec2) -> Mm,
) -> Option<Spot> {
    let spots = stroke.segments().enumerate().flat_map(|(segment, (a, b))| {
        points(a, b).map(|at| Spot { segment, at })
    });
    spots
        .map(|spot| (cost(spot.at), spot))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, spot)| spot)
}

/// Lets a closed stroke begin at its place nearest to `p`, which becomes a point
/// of it.
pub fn begin_near(stroke: &mut Stroke, p: DVec2) {
    if let Some(spot) = nearest_spot(stroke, p) {
        begin_at(stroke, spot);
    }
}

/// Lets a closed stroke begin at a place on it.
pub(super) fn begin_at(stroke: &mut Stroke, spot: Spot) {
    let Spot { segment: i, at: p } = spot;
    let next = (i + 1) % stroke.points.len();
    let (a, b) = (stroke.points[i], stroke.points[next]);
    if p.distance(a) < SAME {
        stroke.begin_at(i);
    } else if p.distance(b) < SAME {
        stroke.begin_at(next);
    } else {
        if let (Some(&u), Some(&v)) =
            (stroke.widths.get(i), stroke.widths.get(next))
        {
            let t = a.distance(p) / a.distance(b);
            stroke.widths.insert(i + 1, u + t * (v - u));
        }
        if !stroke.levels.is_empty() {
            let t = a.distance(p) / a.distance(b);
            let level = stroke.level(i).lerp(stroke.level(next), t);
            stroke.levels.insert(i + 1, level);
        }
        stroke.points.insert(i + 1, p);
        stroke.begin_at(i + 1);
    }
}
