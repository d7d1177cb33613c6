use super::*;
use crate::model::{self, BuildVolume, Model, Placement, SourceKind, load};
use crate::settings::Varying;

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
        infill_density: density.into(),
        infill: settings::Infill::Pattern(pattern),
        ..Settings::default()
    }
}

/// A box of 100 mm on the bed.
fn block() -> Model {
    let source = Source::Text {
        name: "block".into(),
        kind: SourceKind::Formula,
        text: "max(max(abs(x), abs(y)), abs(z)) - 50".into(),
    };
    let volume = BuildVolume {
        x: 220.0,
        y: 220.0,
        z: 250.0,
    };
    let loaded = load(&source, &[]).unwrap();
    model::place(&loaded, &Placement::default(), volume).unwrap()
}

const HERE: Site = Site {
    part: Rect {
        min: DVec2::splat(-50.0),
        max: DVec2::splat(50.0),
    },
    height: 100.0,
    bed: DVec2::ZERO,
};

/// Beads of layers of an area.
fn lay(
    settings: &Settings,
    site: Site,
    area: &Area,
    places: impl IntoIterator<Item = Place>,
) -> Vec<Vec<Bead>> {
    let block = block();
    let around = Surroundings::new(&block);
    let infill = Infill::new(settings, &around, site).unwrap();
    let layers = places.into_iter();
    layers
        .map(|p| infill.beads(area, p, None).unwrap())
        .collect()
}

fn layer(number: usize) -> Place {
    Place {
        number,
        z: 0.2 * number as f64 + 0.1,
        height: 0.2,
    }
}

/// A layer at one of the heights spread evenly, and out of step with any
/// period, over so many periods that their number need not be whole.
fn spread(number: usize) -> Place {
    Place {
        z: 3000.0 * (0.618_034 * number as f64).fract(),
        ..layer(number)
    }
}

/// Length of what the beads of some layers have inside a box.
fn length_within(layers: &[Vec<Bead>], middle: DVec2, half: DVec2) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let window = Area {
        rings: vec![
            corners
                .map(|(x, y)| middle + half * DVec2::new(x, y))
                .to_vec(),
        ],
    };
    let border = Border::new(&window);
    let mut cutter = crate::plane::border::Cutter::new(&border);
    for bead in layers.iter().flatten() {
        cutter.line(&bead.points, bead.closed);
    }
    let pieces = cutter.finish();
    let lengths = pieces.iter();
    lengths
        .map(|p| crate::plane::path_length(&p.points, p.closed))
        .sum()
}

/// Percentage of the volume of some layers, in such a box, that is in beads.
fn share_at(layers: &[Vec<Bead>], middle: DVec2, half: DVec2) -> f64 {
    let volume = length_within(layers, middle, half)
        * crate::bead::cross_section(0.45, 0.2);
    let whole = 4.0 * half.x * half.y * 0.2 * layers.len() as f64;
    100.0 * volume / whole
}

#[test]
fn density_is_the_share_of_the_volume_in_beads() {
    let area = square(50.0);
    for kind in ALL {
        for density in [10.0, 15.0, 25.0, 60.0] {
            let settings = settings(kind, density);
            // Off the walls, where the joins are, and over several periods.
            let half = match kind {
                InfillPattern::Concentric => 50.0,
                _ => 43.0,
            };
            // A window has no whole number of cells: they are laid out from
            // places all over one.
            let layers: Vec<Vec<Bead>> = (0..16)
                .flat_map(|k| {
                    let turn = |step: f64| (step * f64::from(k)).fract();
                    let aside = 40.0 * DVec2::new(turn(0.755), turn(0.570));
                    let site = Site {
                        part: Rect {
                            min: HERE.part.min + aside,
                            max: HERE.part.max + aside,
                        },
                        ..HERE
                    };
                    // Both directions of alternating lines alike.
                    let places = (0..12).map(|i| spread(12 * k as usize + i));
                    lay(&settings, site, &area, places)
                })
                .collect();
            let share = share_at(&layers, DVec2::ZERO, DVec2::splat(half));
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
        lay(&settings, HERE, &area, [layer(0)]).remove(0)
    };
    assert!(!beads(5.0).is_empty());
    assert!(beads(0.0).is_empty());
    // An expression has the density that it has.
    for mode in [InfillMode::Surface, InfillMode::Solid] {
        let shape = |density: f64| {
            let settings = Settings {
                infill: settings::Infill::Expression("sin(x)".into()),
                infill_density: density.into(),
                infill_mode: mode,
                ..Settings::default()
            };
            assert!(!settings.is_hollow() && !settings.is_solid());
            lay(&settings, HERE, &area, [layer(0)]).remove(0)
        };
        assert!(!shape(0.0).is_empty());
        assert_eq!(shape(0.0), shape(15.0));
        assert_eq!(shape(0.0), shape(100.0));
    }
}

/// Squares inside one another, each a frame 3 mm thick and 3 mm from the next.
fn nested() -> Area {
    let rings = (0..6).map(|i| {
        let mut ring = square(40.0 - 3.0 * f64::from(i)).rings.remove(0);
        if i % 2 == 1 {
            ring.reverse();
        }
        ring
    });
    Area {
        rings: rings.collect(),
    }
}

#[test]
fn islands_in_each_other_s_boxes_are_filled_once() {
    let area = nested();
    // And islands that are apart.
    let aside = |x: f64, y: f64, half: f64| -> Vec<DVec2> {
        let ring = square(half).rings.remove(0);
        ring.into_iter().map(|p| p + DVec2::new(x, y)).collect()
    };
    let mut apart = Area::EMPTY;
    apart.rings.push(aside(-30.0, -30.0, 8.0));
    apart.rings.push(aside(-21.5, -10.0, 0.4));
    apart.rings.push(aside(30.0, 30.0, 8.0));
    let shape = |text: &str, mode| Settings {
        infill: settings::Infill::Expression(text.into()),
        infill_mode: mode,
        infill_walls: 0,
        ..Settings::default()
    };
    // Lines 2 mm apart, whatever the depth.
    let text = "sin(1.5707963*x) + 1e-9*d";
    let surface = shape(text, InfillMode::Surface);
    let solid = shape(text, InfillMode::Solid);
    // One that names d in vain is sampled just the same.
    let vain = shape("sin(1.5707963*x) + 0*d", InfillMode::Surface);
    let beads = |s: &Settings| lay(s, HERE, &area, [layer(7)]).remove(0);
    assert_eq!(beads(&vain).len(), beads(&surface).len());
    for area in [&area, &apart] {
        let content = area.content();
        let volume = |settings: &Settings| {
            let beads = lay(settings, HERE, area, [layer(7)]).remove(0);
            beads.iter().map(|b| b.area() * b.length()).sum::<f64>()
        };
        // The joins and the margin along the border come on top.
        let border = area.perimeter() * crate::bead::cross_section(0.45, 0.2);
        let lines = 0.5 * content * crate::bead::cross_section(0.45, 0.2);
        let found = volume(&surface);
        assert!((found - lines).abs() < 0.6 * border, "{found} {lines}");
        let found = volume(&solid) / 0.2;
        let wanted = 0.5 * content;
        // Its bands of 2 mm lose a quarter of a line's width on both sides.
        assert!((found / wanted - 0.85).abs() < 0.1, "{found} {wanted}");
    }
    // The same of a surface whose cells vary.
    let settings = graded(InfillPattern::Gyroid, "20 + 0*x");
    let places = || (0..24).map(spread);
    let length = |area: &Area| -> f64 {
        let layers = lay(&settings, HERE, area, places());
        layers.iter().flatten().map(Bead::length).sum()
    };
    let single: f64 = area.islands().iter().map(length).sum();
    let together = length(&area);
    assert!(
        (together / single - 1.0).abs() < 0.01,
        "{together} {single}"
    );
}

#[test]
fn triangles_stay_triangles_when_they_are_moved() {
    let area = square(30.0);
    let border = Border::new(&area);
    for phase in [0.0, 0.2, 0.5, 0.77] {
        let layer = Layer {
            border: &border,
            margin: 0.0,
            number: 3,
            z: 0.7,
            density: Density::Even(0.15),
            solid: 0.4,
            origin: DVec2::new(1.0, 2.0),
            angle: 10.0,
            phase,
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
                assert!(near < 1e-9, "{phase}: {near}");
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
    let grid = crate::plane::grid::EdgeGrid::new(&area, 1.0);
    for kind in ALL {
        let settings = settings(kind, 20.0);
        let places = [0, 7, 12].map(layer);
        for (i, beads) in lay(&settings, HERE, &area, places).iter().enumerate()
        {
            for p in beads.iter().flat_map(|b| &b.points) {
                assert!(grid.contains(*p), "{kind:?}: {p}");
                let (_, near) = grid.nearest(*p).unwrap();
                assert!(near.distance(*p) > 0.1, "{kind:?}: {p}");
            }
            // Without joins there would be some eighty.
            let open = beads.iter().filter(|b| !b.closed).count();
            assert!(open <= 20, "{kind:?}, layer {i}: {open} paths");
        }
    }
}

/// Points of the pattern far from any border.
fn points(settings: &Settings, site: Site, at: Place) -> Vec<DVec2> {
    let beads = lay(settings, site, &square(40.0), [at]).remove(0);
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
        let part_aside = Site {
            part: Rect {
                min: HERE.part.min + aside,
                max: HERE.part.max + aside,
            },
            ..HERE
        };
        let bed_aside = Site { bed: aside, ..HERE };
        for (what, other) in [
            ("angle", points(&turned, HERE, at)),
            ("phase", points(&moved, HERE, at)),
            ("part", points(&plain, part_aside, at)),
            ("bed", points(&bed, bed_aside, at)),
        ] {
            assert!(differs(&other), "{kind:?}: {what}");
        }
        let same = points(&plain, bed_aside, at);
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
    let first = |s: &Settings| points(s, HERE, at)[5].x;
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
        let beads = |area| lay(&settings, HERE, area, [layer(4)]).remove(0);
        let (whole, parts) = (beads(&square(40.0)), beads(&both));
        let all: Vec<(DVec2, DVec2)> = whole
            .iter()
            .flat_map(|b| b.segments().collect::<Vec<_>>())
            .collect();
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

/// Settings whose density is an expression.
fn graded(pattern: InfillPattern, density: &str) -> Settings {
    Settings {
        infill_density: Varying::Expression(density.into()),
        ..settings(pattern, 15.0)
    }
}

/// Patterns whose density may vary.
const GRADED: [InfillPattern; 10] = [
    InfillPattern::Rectilinear,
    InfillPattern::Grid,
    InfillPattern::Triangles,
    InfillPattern::Cubic,
    InfillPattern::Concentric,
    InfillPattern::Gyroid,
    InfillPattern::SchwarzP,
    InfillPattern::Diamond,
    InfillPattern::Neovius,
    InfillPattern::Lidinoid,
];

#[test]
fn a_varying_density_is_met_everywhere() {
    // From 10 % on the left to 60 % on the right.
    let density = |x: f64| 35.0 + 0.6 * x;
    let area = square(48.0);
    for kind in GRADED {
        let settings = graded(kind, "35 + 0.6*x");
        let places = (0..40).map(spread);
        let layers = lay(&settings, HERE, &area, places);
        let mut total = (0.0, 0.0);
        for x in [-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0] {
            let half = DVec2::new(5.0, 26.0);
            let found = share_at(&layers, DVec2::new(x, 0.0), half);
            let off = found / density(x) - 1.0;
            // A window has four rings or more, the same in every layer.
            let slack = match kind {
                InfillPattern::Concentric => 0.5,
                _ => 0.10,
            };
            assert!(off.abs() < slack, "{kind:?} at {x}: {found}");
            total = (total.0 + found, total.1 + density(x));
        }
        let off: f64 = total.0 / total.1 - 1.0;
        let slack = match kind {
            InfillPattern::Concentric => 0.06,
            _ => 0.03,
        };
        assert!(off.abs() < slack, "{kind:?}: {off}");
    }
}

#[test]
fn a_varying_density_has_no_steps() {
    // Over a narrow range of densities the lines must not change at once:
    // what there is in thin slices follows the density.
    let area = square(48.0);
    // Straight lines are there or not, eight or so in a slice.
    for (kind, slack) in [
        (InfillPattern::Gyroid, 0.08),
        (InfillPattern::Rectilinear, 0.13),
    ] {
        let settings = graded(kind, "18 + 0.1*x");
        let places = (0..60).map(spread);
        let layers = lay(&settings, HERE, &area, places);
        for k in -5..=5 {
            let x = 6.0 * f64::from(k);
            let half = DVec2::new(6.0, 30.0);
            let found = share_at(&layers, DVec2::new(x, 0.0), half);
            let off = found / (18.0 + 0.1 * x) - 1.0;
            assert!(off.abs() < slack, "{kind:?} at {x}: {found}");
        }
    }
}

#[test]
fn density_by_the_distance_from_the_surface() {
    // The example of the documentation.
    let area = square(48.0);
    for kind in [InfillPattern::Gyroid, InfillPattern::Rectilinear] {
        let settings = graded(kind, "10 + 60*exp(-d/3)");
        let places = (0..30).map(|i| layer(200 + 3 * i));
        let layers = lay(&settings, HERE, &area, places);
        let at = |h: f64| share_at(&layers, DVec2::ZERO, DVec2::splat(h));
        let middle = at(20.0);
        assert!((middle / 10.0 - 1.0).abs() < 0.05, "{kind:?}: {middle}");
        // Between 3 and 7 mm from the surface, along it.
        let strip = |from: f64, to: f64| {
            let (lo, hi) = (50.0 - to, 50.0 - from);
            let inside = |h: f64| at(h) * h * h / 100.0;
            100.0 * (inside(hi) - inside(lo)) / (hi * hi - lo * lo)
        };
        let expected = |from: f64, to: f64| {
            let n = 1000;
            let (mut sum, mut weight) = (0.0, 0.0);
            for i in 0..n {
                let d = from + (to - from) * (i as f64 + 0.5) / n as f64;
                sum += (50.0 - d) * (10.0 + 60.0 * (-d / 3.0).exp());
                weight += 50.0 - d;
            }
            sum / weight
        };
        let (found, wanted) = (strip(3.0, 7.0), expected(3.0, 7.0));
        assert!(
            (found / wanted - 1.0).abs() < 0.1,
            "{kind:?}: {found} {wanted}"
        );
    }
}

#[test]
fn an_expression_is_a_surface_or_a_solid() {
    let area = square(20.0);
    let surface = Settings {
        infill: settings::Infill::Expression(
            "sqrt(x*x + y*y) - 0.1*z - 9".into(),
        ),
        ..Settings::default()
    };
    let at = layer(24);
    let radius = 9.0 + 0.1 * at.z;
    let beads = lay(&surface, HERE, &area, [at]).remove(0);
    assert_eq!(beads.len(), 1);
    assert!(beads[0].closed);
    for p in &beads[0].points {
        assert!((p.length() - radius).abs() < 0.05, "{p}");
    }
    // The same as a solid: its volume is that of the disc.
    for walls in [0, 1, 3] {
        let solid = Settings {
            infill_mode: InfillMode::Solid,
            infill_walls: walls,
            ..surface.clone()
        };
        let beads = lay(&solid, HERE, &area, [at]).remove(0);
        let volume: f64 = beads.iter().map(|b| b.area() * b.length()).sum();
        let disc = std::f64::consts::PI * radius * radius * 0.2;
        // Without walls the lines' ends are round, and not counted.
        let slack = if walls == 0 { 0.05 } else { 0.03 };
        let off = volume / disc - 1.0;
        assert!(off.abs() < slack, "{walls}: {volume} {disc}");
        let rings = beads.iter().filter(|b| b.closed).count();
        assert_eq!(rings, walls as usize);
        let outermost = beads
            .iter()
            .flat_map(|b| &b.points)
            .fold(0.0, |far: f64, p| far.max(p.length()));
        assert!(outermost < radius - 0.05, "{outermost}");
        // Cut by a wall, it ends there.
        let beads = lay(&solid, HERE, &square(6.0), [at]).remove(0);
        let volume: f64 = beads.iter().map(|b| b.area() * b.length()).sum();
        let square = 144.0 * 0.2;
        assert!((volume / square - 1.0).abs() < slack, "{walls}: {volume}");
    }
}

#[test]
fn expressions_have_both_sides_of_a_sheet() {
    // The example of the documentation: |f| = 0.2 on both sides of f = 0.
    let text = "abs(sin(x/2)*cos(y/2) + sin(y/2)*cos(z/2) \
                + sin(z/2)*cos(x/2)) - 0.2";
    let settings = Settings {
        infill: settings::Infill::Expression(text.into()),
        ..Settings::default()
    };
    let area = square(20.0);
    let at = layer(30);
    let beads = lay(&settings, HERE, &area, [at]).remove(0);
    let border = Border::new(&area);
    assert!(beads.len() > 1 && beads.iter().all(|b| b.points.len() > 1));
    let f = |p: &DVec2| {
        let (x, y, z) = (0.5 * p.x, 0.5 * p.y, 0.5 * at.z);
        x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
    };
    for p in beads.iter().flat_map(|b| &b.points) {
        let inner = p.abs().max_element() < 19.5;
        assert!(border.contains(*p));
        assert!(!inner || (f(p).abs() - 0.2).abs() < 0.04, "{p}: {}", f(p));
    }
}

#[test]
fn an_expression_may_ask_for_the_distance_from_the_surface() {
    // 20 mm below the surface of a block of 100 mm: a square of 60 mm.
    let settings = |mode| Settings {
        infill: settings::Infill::Expression("20 - d".into()),
        infill_mode: mode,
        ..Settings::default()
    };
    let area = square(49.0);
    let at = layer(250);
    let lay = |mode| lay(&settings(mode), HERE, &area, [at]).remove(0);
    let beads = lay(InfillMode::Surface);
    assert_eq!(beads.len(), 1);
    assert!(beads[0].closed);
    for p in &beads[0].points {
        let off = p.abs().max_element() - 30.0;
        // Corners are rounded by as much as the distances' lattice is wide.
        assert!(off.abs() < 0.4, "{p}");
    }
    let length = beads[0].length();
    assert!((length - 240.0).abs() < 2.0, "{length}");
    let solid = lay(InfillMode::Solid);
    let volume: f64 = solid.iter().map(|b| b.area() * b.length()).sum();
    assert!((volume / (3600.0 * 0.2) - 1.0).abs() < 0.02, "{volume}");
}

#[test]
fn a_script_is_a_shape() {
    let path = std::env::temp_dir()
        .join(format!("isoslice-infill-{}.rhai", std::process::id()));
    std::fs::write(&path, "sqrt(x*x + y*y) - 12").unwrap();
    let settings = Settings {
        infill: settings::Infill::Script(path.display().to_string()),
        ..Settings::default()
    };
    let beads = lay(&settings, HERE, &square(20.0), [layer(3)]).remove(0);
    std::fs::remove_file(&path).unwrap();
    assert!(beads.len() == 1 && beads[0].closed);
    let length = beads[0].length();
    assert!(
        (length - 24.0 * std::f64::consts::PI).abs() < 0.3,
        "{length}"
    );
}

#[test]
fn mistakes_are_told() {
    let block = block();
    let around = Surroundings::new(&block);
    let error = |settings: &Settings| {
        let made = Infill::new(settings, &around, HERE);
        made.map(|_| ()).unwrap_err().to_string()
    };
    let text = |text: &str| Settings {
        infill: settings::Infill::Expression(text.into()),
        ..Settings::default()
    };
    let e = error(&text("sin(x"));
    assert!(e.starts_with("infill = \"expr: sin(x\""), "{e}");
    let script = Settings {
        infill: settings::Infill::Script("nowhere.rhai".into()),
        ..Settings::default()
    };
    assert!(error(&script).contains("nowhere.rhai"));
    let e = error(&graded(InfillPattern::Hexagons, "x"));
    assert!(e.contains("hexagons") && e.contains("gyroid"), "{e}");
    let e = error(&graded(InfillPattern::Gyroid, "10 +"));
    assert!(e.starts_with("infill_density"), "{e}");
}
