use super::*;
use isoslice_planar::shapes::{circle, ring};
use isoslice_planar::{Area, path_length};
use std::f64::consts::{PI, TAU};

fn moved(ring: Vec<DVec2>, by: (f64, f64)) -> Vec<DVec2> {
    ring.into_iter().map(|p| DVec2::from(by) + p).collect()
}

fn hole(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.reverse();
    ring
}

fn way(
    rings: Vec<Vec<DVec2>>,
    a: (f64, f64),
    b: (f64, f64),
) -> Option<(f64, Vec<DVec2>)> {
    let area = Area { rings };
    let solid = Solid::of(&area, 0.5);
    let comb = Comb::new(Cow::Borrowed(&solid), 0.5);
    let (a, b) = (a.into(), b.into());
    let points = comb.way(a, b, 1e3)?;
    let all: Vec<DVec2> = [&[a], &points[..], &[b]]
        .into_iter()
        .flatten()
        .copied()
        .collect();
    for pair in all.windows(2) {
        assert!(
            solid.grid().crossings(pair[0], pair[1]).is_empty(),
            "{all:?}"
        );
    }
    Some((path_length(&all, false), points))
}

const SQUARE: [(f64, f64); 4] =
    [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)];

#[test]
fn a_clear_way_is_straight() {
    let (_, points) =
        way(vec![ring(&SQUARE)], (-15.0, 3.0), (15.0, -8.0)).unwrap();
    assert!(points.is_empty());
}

#[test]
fn round_a_hole_by_the_shorter_side() {
    // The shortest way has two tangents to the clearance's circle and the arc
    // between them.
    let rings = vec![ring(&SQUARE), hole(moved(circle(5.0, 400), (0.0, 1.0)))];
    let (length, points) = way(rings, (-15.0, 0.0), (15.0, 0.0)).unwrap();
    assert!(points.iter().all(|p| p.y < 0.0), "{points:?}");
    let (r, d) = (5.5_f64, 226.0_f64.sqrt());
    let tangent = (d * d - r * r).sqrt();
    let turn = PI - 2.0 * (r / d).acos() - 2.0 * (1.0 / 15.0_f64).atan();
    let shortest = 2.0 * tangent + r * turn;
    assert!(
        (0.995..1.01).contains(&(length / shortest)),
        "{length} {shortest}"
    );
    assert!(points.len() < 12, "{points:?}");
}

#[test]
fn through_a_spiral() {
    // A corridor 3 mm wide that winds inwards.
    let mut left = Vec::new();
    let mut right = Vec::new();
    for i in 0..=600 {
        let angle = TAU * 3.0 * f64::from(i) / 600.0;
        let r = 4.0 + 6.0 * angle / TAU;
        left.push((r - 1.5) * DVec2::from_angle(angle));
        right.push((r + 1.5) * DVec2::from_angle(angle));
    }
    left.reverse();
    right.extend(left);
    let (length, points) = way(vec![right], (4.0, 0.1), (22.0, -0.1)).unwrap();
    let middle: f64 = TAU * 3.0 * 13.0;
    assert!((0.8..1.0).contains(&(length / middle)), "{length} {middle}");
    assert!(points.len() < 90, "{}", points.len());
}

#[test]
fn between_many_holes() {
    let mut rings = vec![ring(&SQUARE)];
    for i in -4..=4 {
        for j in -4..=4 {
            let at = (4.0 * f64::from(i), 4.0 * f64::from(j));
            rings.push(hole(moved(circle(1.4, 60), at)));
        }
    }
    let (length, points) = way(rings, (-18.5, -17.0), (18.0, 18.5)).unwrap();
    let straight = (36.5_f64 * 36.5 + 35.5 * 35.5).sqrt();
    assert!(length < 1.25 * straight, "{length} {straight}");
    assert!(points.len() < 60, "{}", points.len());
}

#[test]
fn a_neck_narrower_than_the_clearance_is_passed() {
    let rings = vec![ring(&[
        (-10.0, -5.0),
        (-0.2, -5.0),
        (-0.2, -0.15),
        (0.2, -0.15),
        (0.2, -5.0),
        (10.0, -5.0),
        (10.0, 5.0),
        (0.2, 5.0),
        (0.2, 0.15),
        (-0.2, 0.15),
        (-0.2, 5.0),
        (-10.0, 5.0),
    ])];
    let (length, _) = way(rings, (-8.0, -4.0), (8.0, 4.0)).unwrap();
    assert!(length < 18.2, "{length}");
}

#[test]
fn islands_are_not_left() {
    let rings = vec![circle(5.0, 90), moved(circle(5.0, 90), (20.0, 0.0))];
    assert!(way(rings, (0.0, 0.0), (20.0, 0.0)).is_none());
    // An island in a hole is not the island around the hole.
    let rings = vec![circle(20.0, 90), hole(circle(10.0, 90)), circle(5.0, 90)];
    assert!(way(rings.clone(), (0.0, 0.0), (15.0, 0.0)).is_none());
    // There is a way past it.
    let (length, _) = way(rings, (-15.0, 0.1), (15.0, 0.1)).unwrap();
    assert!(length < 15.0 * PI, "{length}");
}
