use super::super::edges;
use super::*;

/// Square of the distance between two segments.
fn distance_squared(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
    if crossing(a, b, c, d).is_some() {
        return 0.0;
    }
    let to =
        |p: DVec2, q: DVec2, r: DVec2| p.distance_squared(nearest_on(p, q, r));
    to(a, c, d)
        .min(to(b, c, d))
        .min(to(c, a, b))
        .min(to(d, a, b))
}

#[test]
fn clearance_of_a_star() {
    let ring: Vec<DVec2> = (0..40)
        .map(|i| {
            let r = if i % 2 == 0 { 10.0 } else { 6.0 };
            let turn = std::f64::consts::TAU * f64::from(i) / 40.0;
            DVec2::from_angle(turn) * r
        })
        .collect();
    let area = Area {
        rings: vec![ring.clone()],
    };
    let grid = EdgeGrid::new(&area, 0.3);
    for i in 0..300 {
        let a = DVec2::new(f64::from(i % 20) - 10.0, f64::from(i / 15) - 9.7);
        let b = a + DVec2::new(1.3, 0.4);
        let exact = edges(&ring)
            .map(|(c, d)| distance_squared(a, b, c, d))
            .fold(f64::INFINITY, f64::min)
            .sqrt();
        for reach in [0.1, 0.5, 3.0] {
            assert_eq!(grid.clear(a, b, reach), exact >= reach);
        }
    }
}

#[test]
fn inside_crossings_and_nearest_agree_with_the_area() {
    let ring: Vec<DVec2> = (0..60)
        .map(|i| {
            let turn = std::f64::consts::TAU * f64::from(i) / 60.0;
            DVec2::from_angle(turn) * (8.0 + 2.0 * (5.0 * turn).sin())
        })
        .collect();
    let mut hole: Vec<DVec2> = ring.iter().map(|p| p * 0.4).collect();
    hole.reverse();
    let area = Area {
        rings: vec![ring, hole],
    };
    let grid = EdgeGrid::new(&area, 0.5);
    for i in 0..441 {
        let p = DVec2::new(f64::from(i % 21), f64::from(i / 21)) * 1.04 - 10.4;
        assert_eq!(grid.contains(p), area.contains(p), "{p}");
        let q = DVec2::new(-p.y, 0.7 * p.x);
        let mut found = grid.crossings(p, q);
        found.sort_by(f64::total_cmp);
        found.dedup();
        let crossed = found.len() % 2 == 1;
        assert_eq!(crossed, area.contains(p) != area.contains(q));
        let near = area
            .rings
            .iter()
            .flat_map(|r| edges(r))
            .map(|(a, b)| p.distance(nearest_on(p, a, b)))
            .fold(f64::INFINITY, f64::min);
        let (_, nearest) = grid.nearest(p).unwrap_or_default();
        assert!((p.distance(nearest) - near).abs() < 1e-9);
        let found = grid.nearest_within(p, 1.5);
        assert_eq!(found.is_some(), near <= 1.5);
        if let Some((_, q)) = found {
            assert!((p.distance(q) - near).abs() < 1e-9);
        }
    }
}

#[test]
fn nothing_is_near_an_empty_area() {
    let grid = EdgeGrid::new(&Area::EMPTY, 1.0);
    assert!(grid.clear(DVec2::ZERO, DVec2::ONE, 100.0));
}
