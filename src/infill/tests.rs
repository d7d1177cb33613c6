use super::*;

fn square(half: f64) -> Area {
    let ring = [(-half, -half), (half, -half), (half, half), (-half, half)]
        .map(|(x, y)| DVec2::new(x, y))
        .to_vec();
    Area { rings: vec![ring] }
}

const ALL: [InfillPattern; 11] = [
    InfillPattern::Rectilinear,
    InfillPattern::Grid,
    InfillPattern::Triangles,
    InfillPattern::Hexagons,
    InfillPattern::Cubic,
    InfillPattern::Concentric,
    InfillPattern::Gyroid,
    InfillPattern::SchwarzP,
    InfillPattern::Diamond,
    InfillPattern::Neovius,
    InfillPattern::Lidinoid,
];

fn settings(pattern: InfillPattern, density: f64) -> Settings {
    Settings {
        infill_density: density,
        infill_pattern: pattern,
        ..Settings::default()
    }
}

fn layer(number: usize) -> Place {
    Place {
        number,
        z: 0.2 * number as f64 + 0.1,
        height: 0.2,
    }
}

/// Length of what the beads have inside a window, by its own clipping.
fn length_within(beads: &[Bead], half: f64) -> f64 {
    let window = square(half);
    let border = Border::new(&window);
    let mut cutter = crate::plane::border::Cutter::new(&border);
    for bead in beads {
        cutter.line(&bead.points, bead.closed);
    }
    let pieces = cutter.finish();
    let lengths = pieces.iter();
    lengths
        .map(|p| crate::plane::path_length(&p.points, p.closed))
        .sum()
}

#[test]
fn density_is_the_share_of_the_volume_in_beads() {
    let area = square(50.0);
    for kind in ALL {
        for density in [10.0, 15.0, 25.0, 60.0] {
            let settings = settings(kind, density);
            let infill = Infill::new(&settings, DVec2::ZERO, DVec2::ZERO);
            // Off the walls, where the joins are, and over several periods.
            let half = if kind == InfillPattern::Concentric { 50.0 } else { 42.0 };
            let layers = 240;
            let step = 3;
            let volume: f64 = (0..layers)
                .map(|i| {
                    // Both directions of alternating lines alike.
                    let i = step * i;
                    let beads = infill.beads(&area, layer(i), &settings);
                    length_within(&beads, half)
                })
                .sum::<f64>()
                * crate::bead::cross_section(0.45, 0.2);
            let whole = 4.0 * half * half * 0.2 * f64::from(layers as u32);
            let share = 100.0 * volume / whole;
            assert!(
                (share / density - 1.0).abs() < 0.03,
                "{kind:?} {density}: {share}"
            );
        }
    }
}

#[test]
fn no_density_no_beads() {
    let area = square(15.0);
    let beads = |density| {
        let settings = settings(InfillPattern::Rectilinear, density);
        let infill = Infill::new(&settings, DVec2::ZERO, DVec2::ZERO);
        infill.beads(&area, layer(0), &settings)
    };
    assert!(!beads(5.0).is_empty());
    assert!(beads(0.0).is_empty());
}

#[test]
fn paths_are_long_and_stay_inside() {
    let mut area = square(20.0);
    let mut hole = square(6.0).rings.remove(0);
    hole.reverse();
    area.rings.push(hole);
    let grid = crate::plane::grid::EdgeGrid::new(&area, 1.0);
    for kind in ALL {
        let settings = settings(kind, 20.0);
        let infill = Infill::new(&settings, DVec2::ZERO, DVec2::ZERO);
        for i in [0, 7, 12] {
            let beads = infill.beads(&area, layer(i), &settings);
            for p in beads.iter().flat_map(|b| &b.points) {
                assert!(grid.contains(*p), "{kind:?}: {p}");
                let (_, near) = grid.nearest(*p).unwrap();
                assert!(near.distance(*p) > 0.1, "{kind:?}: {p}");
            }
            let open = beads.iter().filter(|b| !b.closed).count();
            assert!(open <= 14, "{kind:?}, layer {i}: {open} paths");
        }
    }
}

/// Points of the pattern far from any border.
fn points(settings: &Settings, part: DVec2, bed: DVec2, at: Place) -> Vec<DVec2> {
    let infill = Infill::new(settings, part, bed);
    let beads = infill.beads(&square(40.0), at, settings);
    // Where the lines cross the middle row.
    let mut on_row: Vec<DVec2> = beads
        .iter()
        .flat_map(|b| b.segments().collect::<Vec<_>>())
        .filter(|(a, b)| (a.y > 0.3) != (b.y > 0.3))
        .map(|(a, b)| a.lerp(b, (0.3 - a.y) / (b.y - a.y)))
        .filter(|p| p.x.abs() < 30.0)
        .collect();
    on_row.sort_by(|a, b| a.x.total_cmp(&b.x));
    on_row
}

#[test]
fn angle_phase_and_centre_move_the_pattern() {
    for kind in ALL {
        let plain = settings(kind, 20.0);
        let at = layer(5);
        let here = points(&plain, DVec2::ZERO, DVec2::ZERO, at);
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
        let turned = Settings {
            infill_angle: 20.0,
            ..plain.clone()
        };
        let moved = Settings {
            infill_phase: 30.0,
            ..plain.clone()
        };
        let bed = Settings {
            infill_centre: InfillCentre::Bed,
            ..plain.clone()
        };
        let aside = DVec2::new(0.7, 0.4);
        for (what, other) in [
            ("angle", points(&turned, DVec2::ZERO, DVec2::ZERO, at)),
            ("phase", points(&moved, DVec2::ZERO, DVec2::ZERO, at)),
            ("part", points(&plain, aside, DVec2::ZERO, at)),
            ("bed", points(&bed, DVec2::ZERO, aside, at)),
        ] {
            assert!(differs(&other), "{kind:?}: {what}");
        }
        let same = points(&plain, DVec2::ZERO, aside, at);
        assert!(!differs(&same), "{kind:?}");
    }
}

#[test]
fn concentric_rings_move_by_the_phase() {
    let plain = settings(InfillPattern::Concentric, 20.0);
    let moved = Settings {
        infill_phase: 25.0,
        ..plain.clone()
    };
    let at = layer(0);
    let first = |s: &Settings| points(s, DVec2::ZERO, DVec2::ZERO, at)[5].x;
    let step = spacing(0.45, 0.45, 0.2) / 0.2;
    assert!((first(&moved) - first(&plain) - 0.25 * step).abs() < 1e-6);
}

#[test]
fn islands_continue_each_other() {
    // Two squares beside each other have what one around both has.
    let shifted = |x: f64| Area {
        rings: square(12.0)
            .rings
            .into_iter()
            .map(|r| r.into_iter().map(|p| p + DVec2::new(x, 0.0)).collect())
            .collect(),
    };
    let mut both = shifted(-20.0);
    both.rings.extend(shifted(20.0).rings);
    for kind in ALL {
        if kind == InfillPattern::Concentric {
            continue;
        }
        let settings = settings(kind, 25.0);
        let infill = Infill::new(&settings, DVec2::ZERO, DVec2::ZERO);
        let whole = infill.beads(&square(40.0), layer(4), &settings);
        let parts = infill.beads(&both, layer(4), &settings);
        let all: Vec<(DVec2, DVec2)> =
            whole.iter().flat_map(|b| b.segments().collect::<Vec<_>>()).collect();
        let grid = crate::plane::grid::EdgeGrid::of(
            all.into_iter().map(|s| (0, s)),
            0.5,
        );
        for p in parts.iter().flat_map(|b| &b.points) {
            // Off the joins.
            if (p.x.abs() - 20.0).abs() > 11.5 || p.y.abs() > 11.5 {
                continue;
            }
            let near = grid.nearest(*p).unwrap().1;
            assert!(near.distance(*p) < 1e-6, "{kind:?}: {p}");
        }
    }
}
