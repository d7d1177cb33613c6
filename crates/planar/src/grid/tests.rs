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
    let area = Area::from(ring.clone());
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

/// Borders and corners lie on those of the cells.
#[test]
fn what_is_inside_is_known_anywhere_among_many_islands() {
    let islands = (0..400).map(|i| {
        let at = 3.0 * DVec2::new(f64::from(i % 20), f64::from(i / 20));
        crate::rect(at.x, at.y, at.x + 2.0, at.y + 1.0)
    });
    let area: Area = islands.collect();
    let grid = EdgeGrid::new(&area, 0.5);
    for i in 0..124 * 124 {
        let k = DVec2::new(f64::from(i % 124), f64::from(i / 124));
        let p = 0.5 * k - 0.75;
        let island = p.rem_euclid(DVec2::splat(3.0));
        let meant = (p.cmpge(DVec2::ZERO).all()
            && p.cmplt(DVec2::splat(60.0)).all())
            && island.x < 2.0
            && island.y < 1.0;
        assert_eq!(grid.contains(p), meant, "{p}");
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
    let area = Area::from_iter([ring, hole]);
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

/// Edges of all lengths, far from the origin, and one without length.
fn uneven_edges() -> Vec<(DVec2, DVec2)> {
    let corner = DVec2::new(1200.0, -700.0);
    (0..400)
        .map(|i| {
            let i = f64::from(i);
            let a = DVec2::new((37.0 * i) % 19.3, (53.0 * i) % 17.9);
            let by = DVec2::from_angle(i) * 10f64.powf(i % 9.0 - 7.0);
            (corner + a, corner + a + by)
        })
        .chain([(corner, corner)])
        .collect()
}

#[test]
fn no_edge_is_missed_however_short_it_is() {
    let edges = uneven_edges();
    for cell in [0.05, 0.6, 7.0] {
        let grid = EdgeGrid::of(edges.iter().copied().enumerate(), cell);
        for i in 0..200 {
            let place = DVec2::new(f64::from(i % 20), f64::from(i / 20 * 2));
            let p = edges[400].0 + place - 0.3;
            let far =
                |&(a, b): &(DVec2, DVec2)| p.distance(nearest_on(p, a, b));
            let least = edges.iter().map(far).fold(f64::INFINITY, f64::min);
            // Whether a place on an edge is within a reach of 0 is left open.
            for reach in [0.9 * least, 1.1 * least + 1e-6, 3.0] {
                if reach == 0.0 {
                    continue;
                }
                let found =
                    grid.nearest_edge(p, reach).map(|f| p.distance(f.1));
                let expected = (least < reach).then_some(least);
                assert_eq!(found, expected, "{p} {reach}");
                let mut near = vec![false; edges.len()];
                grid.visit_near(p, p, reach, |owner| near[owner] = true);
                let (lo, hi) = (p - reach, p + 0.7 * reach);
                let mut boxed = vec![false; edges.len()];
                grid.visit_box(lo, hi, |edge| boxed[grid.owner(edge)] = true);
                for (k, edge) in edges.iter().enumerate() {
                    assert_eq!(near[k], far(edge) < reach, "{edge:?} {p}");
                    let Rect { min, max } = Rect::around(&[edge.0, edge.1]);
                    let apart = min.cmpgt(hi) | max.cmplt(lo);
                    assert!(!boxed[k] || !apart.any(), "{edge:?} {p}");
                    let q = nearest_on(p, edge.0, edge.1);
                    let meets = q.cmpge(lo) & q.cmple(hi);
                    assert!(boxed[k] || !meets.all(), "{edge:?} {p}");
                }
            }
        }
    }
}

/// Chains of very different lengths; looking through all of them is the simple way.
#[test]
fn every_edge_has_the_owner_of_its_chain() {
    let edge =
        |x: u32| (DVec2::splat(f64::from(x)), DVec2::splat(f64::from(x + 1)));
    let lengths = [
        1, 1, 40, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 16, 15, 17, 1, 33, 1,
    ];
    let mut all = Vec::new();
    let mut owners = Vec::new();
    for (chain, &length) in lengths.iter().enumerate() {
        let owner = 7 * chain + 3;
        all.extend((0..length).map(|x| (owner, edge(x))));
        owners.push((owner, length as usize));
    }
    let grid = EdgeGrid::of(all.into_iter(), 1.0);
    let mut first = 0;
    for (owner, length) in owners {
        for number in first..first + length {
            assert_eq!(grid.owner(number), owner, "{number}");
        }
        first += length + 1;
    }
}
