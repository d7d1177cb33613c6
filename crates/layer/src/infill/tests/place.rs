//! Where a pattern's lines lie, and what becomes of them in an area.

use super::*;

#[test]
fn triangles_stay_triangles_when_they_are_moved() {
    let area = square(30.0);
    let border = Border::new(&area);
    for x in [0.0, 0.2, 0.5, 0.77] {
        let layer = Layer {
            border: &border,
            margin: 0.0,
            number: 3,
            z: 0.7,
            density: Density::Even(0.15),
            solid: 0.4,
            origin: DVec2::new(x, 2.0),
            angle: 10.0,
            shortest: 0.4,
        };
        let lines: Vec<(DVec2, DVec2)> = triangles::Triangles
            .pieces(&layer)
            .iter()
            .map(|p| (p.points[0], p.points[1]))
            .collect();
        let way = |(a, b): (DVec2, DVec2)| (b - a).normalize();
        let along = |turn: f64| {
            let turn = DVec2::from_angle((10.0 + turn).to_radians());
            let own = lines.iter().copied();
            let own = own.filter(|&l| way(l).perp_dot(turn).abs() < 1e-9);
            own.collect::<Vec<_>>()
        };
        let [first, second, third] = [0.0, 60.0, 120.0].map(along);
        let mut met = 0;
        for &a in &first {
            for &b in &second {
                // Where the two meet, a line of the third passes.
                let t = (b.0 - a.0).perp_dot(way(b)) / way(a).perp_dot(way(b));
                let p = a.0 + way(a) * t;
                if p.abs().max_element() > 29.0 {
                    continue;
                }
                let off = |&c: &(DVec2, DVec2)| way(c).perp_dot(p - c.0).abs();
                let near = third.iter().map(off).fold(1e9, f64::min);
                assert!(near < 1e-9, "{x}: {near}");
                met += 1;
            }
        }
        assert!(met > 20, "{met}");
    }
}

#[test]
fn paths_are_long_and_stay_inside() {
    let mut area = square(20.0);
    let mut hole = square(6.0).rings.remove(0);
    hole.reverse();
    area.rings.push(hole);
    let grid = isoslice_planar::grid::EdgeGrid::new(&area, 1.0);
    for kind in InfillPattern::ALL {
        let plan = even(kind, 20.0);
        let places = [0, 7, 12].map(layer);
        for (i, beads) in lay(&plan, HERE, &area, places).iter().enumerate() {
            for p in beads.iter().flat_map(|b| &b.stroke.points) {
                assert!(grid.contains(*p), "{kind:?}: {p}");
                let (_, near) = grid.nearest(*p).unwrap();
                assert!(near.distance(*p) > 0.1, "{kind:?}: {p}");
            }
            // Without joins there would be about 80 paths.
            let open = beads.iter().filter(|b| !b.stroke.closed).count();
            assert!(open <= 20, "{kind:?}, layer {i}: {open} paths");
        }
    }
}

/// Points of the pattern far from any border.
fn points(plan: &InfillPlan, site: Site, at: LayerSpan) -> Vec<DVec2> {
    let beads = lay(plan, site, &square(40.0), [at]).remove(0);
    // Where the lines cross the middle row.
    let mut on_row: Vec<DVec2> = beads
        .iter()
        .flat_map(|b| b.stroke.segments().collect::<Vec<_>>())
        .filter(|(a, b)| (a.y > 0.3) != (b.y > 0.3))
        .map(|(a, b)| a.lerp(b, (0.3 - a.y) / (b.y - a.y)))
        .filter(|p| p.x.abs() < 30.0)
        .collect();
    on_row.sort_by(|a, b| a.x.total_cmp(&b.x));
    on_row
}

#[test]
fn angle_and_part_move_the_pattern() {
    for kind in InfillPattern::ALL {
        let plain = even(kind, 20.0);
        let at = layer(5);
        let here = points(&plain, HERE, at);
        assert!(here.len() > 8, "{kind:?}");
        if kind == InfillPattern::Concentric {
            continue;
        }
        let differs = |other: &[DVec2]| {
            let near = |p: &DVec2| {
                let d = other.iter().map(|q| q.distance(*p));
                d.fold(f64::INFINITY, f64::min)
            };
            here.iter().filter(|p| near(p) > 0.05).count() * 2 > here.len()
        };
        let turned = InfillPlan {
            angle: 20.0,
            ..plain.clone()
        };
        let aside = DVec2::new(0.7, 0.4);
        let part_aside = Site {
            part: HERE.part.moved(aside),
            ..HERE
        };
        for (what, other) in [
            ("angle", points(&turned, HERE, at)),
            ("part", points(&plain, part_aside, at)),
        ] {
            assert!(differs(&other), "{kind:?}: {what}");
        }
    }
}
