//! Areas put together and moved, judged by other libraries on random areas.
//!
//! `geo` judges what booleans give, whether the rings are valid, what is inside
//! and how far a point is from them. i_overlay's outline tells the content of
//! an offset. The contents are not quite an independent judgement: the booleans
//! of `geo` are an older i_overlay, on a grid of its own, and both this
//! folder's offset and the outline may end in i_overlay's sweep. What `geo`
//! says of points and of validity shares no code with this folder.

use super::clip::{difference, intersection, union, unite};
use super::offset::offset;
use super::{Area, Ring};
use fastrand::Rng;
use geo::{
    Area as _, BooleanOps, Contains, Distance, Euclidean, MultiLineString,
    MultiPolygon, Point, Polygon, Validation, unary_union,
};
use glam::DVec2;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};
use std::f64::consts::{PI, TAU};

/// The grid of `clip`, mm.
const CLIP_GRID: f64 = 1e-5;

/// The finest arcs that i_overlay's outline draws: a chord for each 1.8°.
const FINEST_ARC: f64 = 0.01 * PI;

/// A ring around a point, star-shaped as seen from there. Between two of its
/// corners the direction turns by 108° at most, so all of the ring is more than
/// 0.58 of `least` away from the point.
fn star(rng: &mut Rng, centre: DVec2, least: f64, most: f64) -> Ring {
    let corners = rng.usize(6..24);
    (0..corners)
        .map(|i| {
            let turn = (i as f64 + 0.8 * rng.f64()) * TAU / corners as f64;
            let radius = least + (most - least) * rng.f64();
            centre + DVec2::from_angle(turn) * radius
        })
        .collect()
}

/// Stars, some with a hole, which may overlap one another.
fn stars(rng: &mut Rng) -> Vec<Area> {
    let count = rng.usize(1..5);
    let star = |_| {
        let centre = DVec2::new(rng.f64(), rng.f64()) * 16.0 - 8.0;
        let size = 2.0 + 6.0 * rng.f64();
        let mut rings = vec![star(rng, centre, 0.5 * size, size)];
        if rng.bool() {
            let mut hole = star(rng, centre, 0.08 * size, 0.28 * size);
            hole.reverse();
            rings.push(hole);
        }
        Area { rings }
    };
    (0..count).map(star).collect()
}

/// All rings of the stars, overlaps included.
fn together(stars: Vec<Area>) -> Area {
    stars.into_iter().collect()
}

/// Why `geo` finds rings on the grid invalid, if it does. The unit is the
/// grid's step, so that a corner on another ring's edge lies there exactly.
fn invalid(area: &Area) -> Option<String> {
    let mut exact = area.clone();
    for p in exact.rings.iter_mut().flatten() {
        *p = (*p / CLIP_GRID).round();
    }
    let found = MultiPolygon::from(&exact).check_validation();
    found.err().map(|e| e.to_string())
}

fn point(rng: &mut Rng, half: f64) -> DVec2 {
    (DVec2::new(rng.f64(), rng.f64()) * 2.0 - 1.0) * half
}

/// How far a point is from the nearest ring.
fn clearance(area: &Area, p: DVec2) -> f64 {
    let polygons = MultiPolygon::from(area);
    let rings = polygons.iter().flat_map(|p| {
        let (outer, holes) = p.clone().into_inner();
        std::iter::once(outer).chain(holes)
    });
    let rings = MultiLineString(rings.collect());
    Euclidean.distance(&Point::new(p.x, p.y), &rings)
}

#[test]
fn booleans_of_random_areas_are_those_of_geo() {
    let mut rng = Rng::with_seed(17);
    let (mut compared, mut asked) = (0, 0);
    for case in 0..300 {
        let [a, b] = [(); 2].map(|()| stars(&mut rng));
        let [in_a, in_b] = [&a, &b].map(|stars| {
            let all = stars.iter().map(MultiPolygon::from);
            all.flatten().collect::<Vec<Polygon>>()
        });
        // geo gets each operand united; ours gets what overlaps.
        let judged = [&in_a, &in_b].map(unary_union);
        let [a, b] = [a, b].map(together);
        // Rounding to the grid moves an edge by less than a step: on both
        // sides, since geo has a grid of its own.
        let tolerance = 2.0 * CLIP_GRID * (a.perimeter() + b.perimeter());
        type Rule = fn(bool, bool) -> bool;
        let all: [(&str, Area, MultiPolygon, Rule); 3] = [
            (
                "union",
                union(&a, &b),
                judged[0].union(&judged[1]),
                |a, b| a || b,
            ),
            (
                "difference",
                difference(&a, &b),
                judged[0].difference(&judged[1]),
                |a, b| a && !b,
            ),
            (
                "intersection",
                intersection(&a, &b),
                judged[0].intersection(&judged[1]),
                |a, b| a && b,
            ),
        ];
        for (name, ours, exact, rule) in all {
            let off = (ours.content() - exact.unsigned_area()).abs();
            assert!(off < tolerance, "{name} {case}: {off} > {tolerance}");
            assert_eq!(invalid(&ours), None, "{name} {case}");
            for _ in 0..20 {
                let p = point(&mut rng, 14.0);
                if clearance(&a, p).min(clearance(&b, p)) < 3.0 * CLIP_GRID {
                    continue;
                }
                let at = Point::new(p.x, p.y);
                let [in_a, in_b] = [&in_a, &in_b]
                    .map(|stars| stars.iter().any(|s| s.contains(&at)));
                let inside = rule(in_a, in_b);
                assert_eq!(ours.contains(p), inside, "{name} {case}: {p}");
                asked += 1;
            }
            compared += usize::from(!ours.is_empty());
        }
    }
    assert!(compared > 800 && asked > 15_000, "{compared} {asked}");
}

/// What i_overlay's outline makes of an area, with its finest arcs.
fn outline(area: &Area, distance: f64) -> Area {
    let rings: Vec<Vec<[f64; 2]>> = area
        .rings
        .iter()
        .map(|r| r.iter().map(|p| p.to_array()).collect())
        .collect();
    let style =
        OutlineStyle::new(distance).line_join(LineJoin::Round(FINEST_ARC));
    let shapes = rings.outline(&style);
    let ring =
        |r: Vec<[f64; 2]>| -> Ring { r.into_iter().map(DVec2::from).collect() };
    shapes.into_iter().flatten().map(ring).collect()
}

#[test]
fn offsets_of_random_areas_are_those_of_i_overlay_and_geo() {
    const TOLERANCE: f64 = 1e-3;
    let mut rng = Rng::with_seed(18);
    let (mut compared, mut asked) = (0, 0);
    for case in 0..300 {
        let area = unite(&together(stars(&mut rng)));
        let judged = MultiPolygon::from(&area);
        let size = 0.05 + 1.5 * rng.f64() * rng.f64();
        for distance in [-size, size] {
            let ours = offset(&area, distance, TOLERANCE);
            let theirs = outline(&area, distance);
            // Our offset is within its tolerance of the true border, all along
            // it. The outline cuts arcs short by a chord's height and rounds to
            // a grid of its own.
            let height = size * (1.0 - (0.5 * FINEST_ARC).cos());
            let length = ours.perimeter().max(theirs.perimeter());
            let bound = (TOLERANCE + height + 2.0 * CLIP_GRID) * length;
            let off = (ours.content() - theirs.content()).abs();
            assert!(off <= bound, "{case} by {distance}: {off} > {bound}");
            compared += usize::from(!ours.is_empty());
            // An offset is defined by the distance from the area, or from what
            // is around it, so geo is the judge of points. Points that the
            // tolerance may put on either side are left out.
            for _ in 0..40 {
                let p = point(&mut rng, 14.0);
                let away = clearance(&area, p);
                if (away - size).abs() < 2.0 * TOLERANCE {
                    continue;
                }
                let within = judged.contains(&Point::new(p.x, p.y));
                let inside = if distance > 0.0 {
                    within || away < size
                } else {
                    within && away > size
                };
                assert_eq!(ours.contains(p), inside, "{case} {distance}: {p}");
                asked += 1;
            }
        }
    }
    assert!(compared > 550 && asked > 20_000, "{compared} {asked}");
}
