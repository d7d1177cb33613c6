//! Skin, bridges and overhangs of parts whose every layer is known: what each
//! place of a layer is printed as, against the function itself.

use crate::common::{
    Layer, Move, formula, middle, number, parse, settings, slice, slice_layers,
};
use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};
use std::f64::consts::{PI, TAU};

const TOP: &str = "Top solid infill";
const SOLID: &str = "Solid infill";
const BRIDGE: &str = "Bridge infill";
const SPARSE: &str = "Internal infill";
const OVERHANG: &str = "Overhang perimeter";

/// A part as a formula and as a function, negative inside.
struct Case {
    name: &'static str,
    formula: &'static str,
    f: fn(DVec3) -> f64,
}

fn block(p: DVec3, half: DVec3, centre: DVec3) -> f64 {
    ((p - centre).abs() - half).max_element()
}

const CASES: [Case; 8] = [
    Case {
        name: "arch",
        formula: "max(max(max(abs(x)-20, abs(y)-8), abs(z-9)-9), \
                  12 - sqrt(x^2 + z^2))",
        f: |p| {
            let b = DVec3::new(20.0, 8.0, 9.0);
            block(p, b, DVec3::Z * 9.0).max(12.0 - p.x.hypot(p.z))
        },
    },
    Case {
        name: "dome",
        formula: "max(sqrt(x^2 + y^2 + z^2) - 14, -z)",
        f: |p| (p.length() - 14.0).max(-p.z),
    },
    Case {
        name: "pyramid",
        formula: "max(max(abs(x), abs(y)) - 15*(1 - z/8), -z)",
        f: |p| {
            let side = p.x.abs().max(p.y.abs());
            (side - 15.0 * (1.0 - p.z / 8.0)).max(-p.z)
        },
    },
    Case {
        name: "U",
        formula: "max(max(max(abs(x)-18, abs(y)-10), abs(z-5)-5), \
                  -max(abs(x)-8, 4-z))",
        f: |p| {
            let b = DVec3::new(18.0, 10.0, 5.0);
            let slot = (p.x.abs() - 8.0).max(4.0 - p.z);
            block(p, b, DVec3::Z * 5.0).max(-slot)
        },
    },
    Case {
        name: "upside down U",
        formula: "max(max(max(abs(x)-18, abs(y)-10), abs(z-5)-5), \
                  -max(abs(x)-8, z-6))",
        f: |p| {
            let b = DVec3::new(18.0, 10.0, 5.0);
            let slot = (p.x.abs() - 8.0).max(p.z - 6.0);
            block(p, b, DVec3::Z * 5.0).max(-slot)
        },
    },
    Case {
        name: "staircase",
        formula: "max(max(max(abs(x)-16, abs(y)-12), -z), \
                  min(min(z-3, max(z-6, x-4)), max(z-9, x+6)))",
        f: |p| {
            let steps = (p.z - 3.0)
                .min((p.z - 6.0).max(p.x - 4.0))
                .min((p.z - 9.0).max(p.x + 6.0));
            let block = (p.x.abs() - 16.0).max(p.y.abs() - 12.0);
            block.max(-p.z).max(steps)
        },
    },
    Case {
        name: "closed cavity",
        formula: "max(max(max(abs(x)-15, abs(y)-15), abs(z-5)-5), \
                  -max(max(abs(x)-7, abs(y)-7), abs(z-5)-2))",
        f: |p| {
            let b = DVec3::new(15.0, 15.0, 5.0);
            let cavity = block(p, DVec3::new(7.0, 7.0, 2.0), DVec3::Z * 5.0);
            block(p, b, DVec3::Z * 5.0).max(-cavity)
        },
    },
    // One hole goes through, one is blind from above, one from below.
    Case {
        name: "holes",
        formula: "max(max(max(max(abs(x)-24, abs(y)-8), abs(z-4)-4), \
                  3 - sqrt((x+16)^2 + y^2)), \
                  max(-max(sqrt(x^2 + y^2) - 3, 4 - z), \
                  -max(sqrt((x-16)^2 + y^2) - 3, z - 4)))",
        f: |p| {
            let b = DVec3::new(24.0, 8.0, 4.0);
            let hole = |x: f64| (p.x - x).hypot(p.y) - 3.0;
            block(p, b, DVec3::Z * 4.0)
                .max(-hole(-16.0))
                .max(-hole(0.0).max(4.0 - p.z))
                .max(-hole(16.0).max(p.z - 4.0))
        },
    },
];

/// What a place of a layer has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Outside,
    /// Not covered by the layer below, and not on the bed.
    Hanging,
    /// On the bed.
    Bottom,
    Top,
    /// Covered by the next layers, but not by all of the window.
    Internal,
    Sparse,
}

/// What tells a layer's skin.
#[derive(Clone, Copy)]
struct Shells {
    layer_height: f64,
    /// Numbers of solid layers.
    top: i64,
    bottom: i64,
}

/// What a point of layer `i` is, by the function.
fn place(
    f: fn(DVec3) -> f64,
    p: DVec2,
    i: i64,
    count: i64,
    shells: Shells,
) -> Place {
    let h = shells.layer_height;
    let solid = |k: i64| {
        let z = (k as f64 + 0.5) * h;
        (0..count).contains(&k) && f(p.extend(z)) < 0.0
    };
    let Shells { top, bottom, .. } = shells;
    match () {
        () if !solid(i) => Place::Outside,
        () if i == 0 => Place::Bottom,
        () if !solid(i - 1) => Place::Hanging,
        () if !solid(i + 1) => Place::Top,
        () if (1..=top).any(|k| !solid(i + k)) => Place::Internal,
        () if (1..=bottom).any(|k| !solid(i - k)) => Place::Internal,
        () => Place::Sparse,
    }
}

/// The place of a point, if all points within `margin` of it have that place.
fn clear_place(
    f: fn(DVec3) -> f64,
    p: DVec2,
    (i, count): (i64, i64),
    shells: Shells,
    margin: f64,
) -> Option<Place> {
    let own = place(f, p, i, count, shells);
    let around = (0..24).all(|k| {
        let turn = DVec2::from_angle(TAU * f64::from(k) / 12.0);
        let r = margin * if k < 12 { 1.0 } else { 0.5 };
        place(f, p + turn * r, i, count, shells) == own
    });
    around.then_some(own)
}

fn distance(m: &Move, p: DVec2) -> f64 {
    let (a, b) = m.ends();
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * t)
}

/// Lines farther from a place than this do not count there, mm: it is more than
/// half the width of any line.
const REACH: f64 = 0.9;

/// Internal bridges are left out: they go on to the infill that holds them.
fn roles_are_exact(case: &Case, assignments: &[&str]) {
    let assignments = [&["internal_bridges=false"], assignments].concat();
    let settings = settings(&assignments);
    let s = &settings;
    let model = formula(case.formula, s);
    let layers = parse(&slice(&model, s, 2).0);
    let count = layers.len() as i64;
    let shells = Shells {
        layer_height: s.layer_height(),
        top: i64::from(s.top_layers()),
        bottom: i64::from(s.bottom_layers()),
    };
    let mut seen = [0; 6];
    for (i, layer) in layers.iter().enumerate() {
        let line = |m: &Move| {
            let (a, b) = m.ends();
            Line::new(a.to_array(), b.to_array())
        };
        let prints = layer.prints().map(|m| GeomWithData::new(line(m), m));
        let prints = RTree::bulk_load(prints.collect());
        // The lines near a place, each with its distance from the place.
        let around = |p: DVec2| {
            let p = p + middle(s);
            let (low, high) = ((p - REACH).to_array(), (p + REACH).to_array());
            prints
                .locate_in_envelope_intersecting(&AABB::from_corners(low, high))
                .map(move |print| (print.data, distance(print.data, p)))
        };
        for k in 0..60 * 60 {
            let at = DVec2::new(f64::from(k % 60), f64::from(k / 60));
            let p = at * 0.83 - 25.0;
            let number = (i as i64, count);
            // The margin is more than skin reaches onto, and than short pieces
            // of its lines.
            let Some(own) = clear_place(case.f, p, number, shells, 2.4) else {
                continue;
            };
            let near = |roles: &[&str], reach: f64| {
                around(p).any(|(m, distance)| {
                    // Where lines are wider, they are farther apart.
                    let reach = reach.max(0.5 * m.width + 0.02);
                    assert!(reach < REACH);
                    roles.contains(&m.role) && distance < reach
                })
            };
            // Half a line's spacing and what lines overlap.
            let half = 0.5 * 0.45 + 0.02;
            let right = match own {
                Place::Outside => {
                    around(p).all(|(_, distance)| distance >= 0.5)
                }
                Place::Hanging => near(&[SOLID, BRIDGE], half),
                Place::Bottom | Place::Internal => near(&[SOLID], half),
                Place::Top => near(&[TOP], half),
                Place::Sparse => !near(&[TOP, SOLID, BRIDGE], 0.5),
            };
            assert!(
                right,
                "{} layer {}: {own:?} at {p}, {:?}",
                case.name,
                i + 1,
                around(p)
                    .map(|(m, distance)| (m.role, distance))
                    .collect::<Vec<_>>(),
            );
            seen[own as usize] += 1;
        }
    }
    assert!(seen[Place::Sparse as usize] > 50, "{}: {seen:?}", case.name);
    assert!(seen[Place::Bottom as usize] > 50, "{}: {seen:?}", case.name);
}

#[test]
fn every_place_is_printed_as_what_it_is() {
    for case in &CASES {
        roles_are_exact(case, &[]);
    }
}

#[test]
fn widths_patterns_and_thicknesses_of_their_own_change_no_area() {
    let own = [
        "top_skin_width=0.4",
        "skin_pattern=top: concentric",
        "top_layers=2",
        "bottom_layers=5",
    ];
    for case in CASES
        .iter()
        .filter(|c| ["staircase", "holes", "closed cavity"].contains(&c.name))
    {
        roles_are_exact(case, &own);
    }
}

/// Content printed in some roles: what is fed over the layer's height.
fn content(layer: &Layer, roles: &[&str]) -> f64 {
    let fed: f64 = layer
        .prints()
        .filter(|m| roles.contains(&m.role))
        .map(|m| m.fed)
        .sum();
    fed * PI * 0.25 * 1.75_f64.powi(2) / layer.height
}

#[test]
fn a_closed_cavity_has_a_floor_and_a_roof_of_exact_layers() {
    // Internal bridges go on to the infill that holds them.
    let s = settings(&["internal_bridges=false"]);
    let cavity = &CASES[6];
    let layers = parse(&slice(&formula(cavity.formula, &s), &s, 2).0);
    let skin = |i: usize| content(&layers[i], &[TOP, SOLID, BRIDGE]);
    // The cavity is layers 15 to 34 (from 0) of 50.
    let solid: Vec<usize> =
        (0..layers.len()).filter(|&i| skin(i) > 1.0).collect();
    let expected: Vec<usize> = [0..3, 11..15, 35..38, 46..50]
        .into_iter()
        .flatten()
        .collect();
    assert_eq!(solid, expected);
    let grown = |by: f64| 14.0 * 14.0 + 4.0 * 14.0 * by + PI * by * by;
    // Skin reaches as far as the walls of what rises around the cavity.
    let width = s.outer_wall_width();
    let walls = 0.5 * width + 1.5 * (width - 0.2 * (1.0 - 0.25 * PI));
    for i in 11..15 {
        let is = skin(i);
        assert!((is / grown(walls) - 1.0).abs() < 0.02, "{is}");
    }
    let roof = grown(number(&s, "bridge_anchor"));
    assert!((skin(35) / roof - 1.0).abs() < 0.02, "{}", skin(35));
    assert!(content(&layers[35], &[BRIDGE]) > 0.9 * roof);
    assert_eq!(content(&layers[36], &[BRIDGE]), 0.0);
}

/// With skin at the ends alone, steps and cavities get none.
#[test]
fn skin_at_the_ends_is_of_the_parts_first_and_last_layers() {
    let s = settings(&["skin_where=ends"]);
    for case in CASES
        .iter()
        .filter(|c| ["staircase", "closed cavity"].contains(&c.name))
    {
        let layers = parse(&slice(&formula(case.formula, &s), &s, 2).0);
        let last = layers.len() - 4;
        for (i, layer) in layers.iter().enumerate() {
            let skin = content(layer, &[TOP, SOLID, BRIDGE]);
            let sparse = content(layer, &[SPARSE]);
            if i < 3 || i >= last {
                assert!(skin > 1.0 && sparse == 0.0, "{i}")
            } else {
                assert!(skin == 0.0 && sparse > 1.0, "{i}")
            }
        }
    }
    // Lines that one range of layers has are those of the whole part.
    let part = formula(CASES[5].formula, &s);
    let whole = slice(&part, &s, 1).0;
    let range = slice_layers(&part, &s, "30..44", 2).0;
    let text = |text: &str, layer: usize| -> Vec<String> {
        let part = text.split(";LAYER_CHANGE").nth(layer).unwrap();
        let lines = part.lines().filter(|l| !l.starts_with("M73"));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(text(&whole, 43), text(&range, 14));
}

/// The lines of a square's skin end half a nozzle from the middle of the ring
/// around it, and by the gap farther.
#[test]
fn lines_of_skin_keep_the_gap_to_its_ring() {
    let square = "max(max(abs(x) - 12, abs(y) - 12), abs(z - 0.3) - 0.3)";
    let reach = |assignments: &[&str]| {
        let s = settings(assignments);
        let layers = parse(&slice(&formula(square, &s), &s, 1).0);
        let ends = layers[1].prints().filter(|m| m.role == SOLID);
        let far = |p: DVec2| (p - middle(&s)).abs().max_element();
        // The ring is parallel to the sides, the lines are at 45°; what is
        // short leads from one to the other.
        let slanted = |m: &&Move| {
            let (a, b) = m.ends();
            (b - a).abs().min_element() > 1.0
        };
        let lines = ends.filter(slanted);
        lines.map(|m| far(m.ends().0)).fold(0.0, f64::max)
    };
    let touching = reach(&["skin_angle=45"]);
    assert!((touching - reach(&["skin_ring_gap=0"])).abs() < 1e-9);
    for gap in [0.1, 0.5] {
        let apart = reach(&[&format!("skin_ring_gap={gap}")]);
        let off = touching - apart - gap;
        assert!(off.abs() < 0.003, "{gap}: {off}");
    }
    let walls = 0.45 + 2.0 * 0.407 - 0.0215;
    let exact = 12.0 - walls - 0.2;
    assert!((touching - exact).abs() < 0.25, "{touching} {exact}");
}

#[test]
fn bridges_run_from_pillar_to_pillar() {
    for degrees in [0.0, 25.0, 90.0] {
        let s = settings(&[]);
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let text = format!(
            "max(max(max(abs(x*{cos}+y*{sin})-18, abs(y*{cos}-x*{sin})-10), \
             abs(z-5)-5), -max(abs(x*{cos}+y*{sin})-8, z-6))"
        );
        let layers = parse(&slice(&formula(&text, &s), &s, 2).0);
        let roof = &layers[30];
        let along = DVec2::new(cos, sin);
        let spans: Vec<&Move> = roof
            .prints()
            .filter(|m| m.role == BRIDGE && m.length() > 10.0)
            .collect();
        // There is a line for each spacing in 20 mm less walls and ring.
        assert!(spans.len() > 40, "{degrees}: {}", spans.len());
        let reach = 8.0 + number(&s, "bridge_anchor");
        for m in spans {
            let (a, b) = m.ends();
            let d = (b - a).normalize();
            assert!(d.perp_dot(along).abs() < 0.02, "{degrees}: {d}");
            // The line runs over the gap, and is anchored on both sides.
            for p in [a, b] {
                let u = (p - middle(&s)).dot(along).abs();
                assert!(u > reach - 0.7 && u < reach + 0.1, "{degrees}: {u}");
            }
        }
        // The free sides' walls hang, and no others.
        let hangs = roof.length(OVERHANG);
        assert!((hangs - 4.0 * 16.0).abs() < 0.2, "{degrees}: {hangs}");
        let others = layers.iter().enumerate().filter(|(i, _)| *i != 30);
        for (i, layer) in others {
            assert_eq!(layer.length(OVERHANG), 0.0, "layer {}", i + 1);
        }
    }
}

#[test]
fn walls_hang_from_the_slope_that_is_asked_for() {
    // Cones upside down: the outer wall's centre line leaves the layer below
    // where the outline grows by more than half its width a layer.
    let hangs = |slope: f64, share: &str| {
        let s = settings(&[
            &format!("overhang_share={share}"),
            // 3 % of the growth that is looked for are 4 µm.
            "accuracy=0.001",
        ]);
        let text = format!("max(sqrt(x^2+y^2) - 8 - z*{slope}, abs(z-2)-2)");
        let layers = parse(&slice(&formula(&text, &s), &s, 2).0);
        let middle = &layers[10];
        middle.length(OVERHANG) > 0.0
    };
    let growth = |share: f64| (share - 0.5) * 0.45 + 0.225;
    for (share, text) in [(0.5, "50"), (0.3, "30"), (0.8, "80")] {
        let least = growth(share) / 0.2;
        assert!(!hangs(least * 0.97, text), "{share}");
        assert!(hangs(least * 1.03, text), "{share}");
    }
    assert!(!hangs(5.0, "100"));
}

#[test]
fn tops_are_swept_one_way() {
    let s = settings(&["seam=rear"]);
    let plate = "max(max(max(abs(x)-15, abs(y)-15), abs(z-1)-1), \
                 4 - sqrt(x^2 + y^2))";
    let layers = parse(&slice(&formula(plate, &s), &s, 2).0);
    let top = layers.last().unwrap();
    let lines: Vec<(DVec2, DVec2)> = top
        .prints()
        // Edges of the ring around the hole are shorter.
        .filter(|m| m.role == TOP && m.length() > 2.0)
        .map(Move::ends)
        .filter(|(a, b)| {
            let d = (*b - *a).normalize();
            (d.x.abs() - d.y.abs()).abs() < 0.05
        })
        .collect();
    assert!(lines.len() > 60, "{}", lines.len());
    let along = (lines[0].1 - lines[0].0).normalize();
    let mut backwards: i32 = 0;
    for (i, (a, b)) in lines.iter().enumerate() {
        let side = |p: DVec2| along.perp_dot(p);
        let span = |a: DVec2, b: DVec2| {
            let (u, v) = (along.dot(a), along.dot(b));
            (u.min(v), u.max(v))
        };
        let own = span(*a, *b);
        for (c, d) in &lines[..i] {
            let other = span(*c, *d);
            let beside = own.0 < other.1 && other.0 < own.1;
            let step = side(*a) - side(*c);
            if beside && step.abs() < 0.6 && step.abs() > 0.2 {
                backwards += if step > 0.0 { 1 } else { -1 };
            }
        }
    }
    // Each line but the first ones has one before it, on the same side.
    let neighbours = i32::try_from(lines.len()).unwrap();
    assert!(
        backwards.abs() >= neighbours - 4,
        "{backwards} of {neighbours}"
    );
}

#[test]
fn everything_solid_has_the_volume_of_the_part() {
    let parts = [
        ("sqrt(x^2+y^2+(z-12)^2) - 12", 4.0 / 3.0 * PI * 1728.0),
        ("max(max(abs(x)-10, abs(y)-10), abs(z-4)-4)", 3200.0),
        (
            "max(sqrt(x^2+y^2) - 12*(1-z/15), -z)",
            PI / 3.0 * 144.0 * 15.0,
        ),
        (
            "max(max(max(abs(x)-15, abs(y)-15), abs(z-2)-2), \
             6 - sqrt(x^2 + y^2))",
            4.0 * (900.0 - PI * 36.0),
        ),
    ];
    let s = settings(&["infill_density=100"]);
    for (text, volume) in parts {
        let layers = parse(&slice(&formula(text, &s), &s, 2).0);
        let fed: f64 = layers.iter().map(Layer::fed).sum();
        let is = fed * PI * 0.25 * 1.75_f64.powi(2);
        let off = is / volume - 1.0;
        assert!(off.abs() < 0.015, "{text}: {off}");
        assert!(layers.iter().all(|l| l.length(SPARSE) == 0.0));
    }
}

/// A wall just thicker than its lines leaves a hair between them. Nothing is laid
/// in a hair, and nothing across the bore.
#[test]
fn a_tube_as_thick_as_its_lines_is_filled_once() {
    let s = settings(&[]);
    for step in 0..12 {
        let thick = 1.66 + 0.006 * f64::from(step);
        let text = format!(
            "max(abs(sqrt(x^2+y^2) - 20) - {}, abs(z - 0.4) - 0.4)",
            0.5 * thick
        );
        let layers = parse(&slice(&formula(&text, &s), &s, 2).0);
        let fed: f64 = layers.iter().map(Layer::fed).sum();
        let volume = fed * PI * 0.25 * 1.75_f64.powi(2);
        let filled = volume / (PI * 40.0 * thick * 0.8);
        assert!((0.9..1.05).contains(&filled), "{thick}: {filled}");
        for m in layers.iter().flat_map(Layer::prints) {
            let (a, b) = m.ends();
            let r = a.midpoint(b).distance(middle(&s));
            assert!(r > 20.0 - thick, "{thick}: {m:?}");
        }
    }
}

/// The least thickness of solid below a dome's surface, along its normal,
/// over slopes from `from` to `to` degrees.
fn shell(from: f64, to: f64, assignments: &[&str]) -> f64 {
    let s = &settings(assignments);
    const R: f64 = 30.0;
    let dome = format!("max(sqrt(x^2+y^2+z^2) - {R}, -(z-15))");
    let layers = parse(&slice(&formula(&dome, s), s, 2).0);
    let base = 15.0;
    let mut least = f64::INFINITY;
    for k in 0..400 {
        // Slope at a point of the surface: its angle from the axis.
        let slope = (from + (to - from) * f64::from(k) / 400.0).to_radians();
        let side = DVec2::from_angle(2.4 * f64::from(k));
        let normal = (side * slope.sin()).extend(slope.cos());
        let mut depth = 0.03;
        while depth < 3.0 {
            let p = normal * (R - depth);
            let layer = ((p.z - base) / s.layer_height()).floor();
            let Some(layer) = layers.get(layer.max(0.0) as usize) else {
                break;
            };
            let at = p.truncate() + middle(s);
            let solid = layer.prints().any(|m| {
                m.role != SPARSE && distance(m, at) < 0.5 * m.width + 0.05
            });
            // Steps stand out of the slope.
            if !solid && depth > 0.25 {
                break;
            }
            depth += 0.02;
        }
        least = least.min(depth);
    }
    least
}

#[test]
fn shells_of_slopes_are_as_thick_as_asked_for() {
    // The shell is thick enough whatever walls and anchors of lines add to it.
    for own in [
        ["infill_density=5", "walls=2", "skin_overlap=0.6"],
        ["infill_density=5", "walls=1", "skin_overlap=0"],
        ["infill_density=5", "walls=3", "skin_overlap=0.6"],
    ] {
        let s = settings(&own);
        for (from, to) in [(10.0, 20.0), (20.0, 30.0), (30.0, 45.0)] {
            let least = shell(from, to, &own);
            // On a slope nearly level half a layer's step shows.
            let step = if from < 20.0 {
                0.5 * s.layer_height()
            } else {
                0.0
            };
            assert!(
                least >= s.top_thickness() - step,
                "{from} to {to}, {own:?}: {least}"
            );
        }
    }
}

#[test]
fn what_hangs_in_a_cavity_is_told_with_its_place() {
    let s = settings(&[]);
    let told = |text: &str| slice(&formula(text, &s), &s, 2).1.warnings;
    // This cavity is an arch inside, so there is nothing to tell.
    let cavity = "max(max(max(abs(x)-10, abs(y)-10), abs(z-10)-10), \
                  5 - sqrt(x^2 + y^2 + (z-10)^2))";
    assert!(told(cavity).is_empty(), "{:?}", told(cavity));
    // A drop that hangs from a thread in it, 2 mm above the floor.
    let drop = format!(
        "min({cavity}, min(sqrt((x-1)^2 + y^2 + (z-9)^2) - 2, \
         max(sqrt((x-1)^2 + y^2) - 0.5, abs(z-12)-4)))"
    );
    let warnings = told(&drop);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("in a cavity"), "{warnings:?}");
    assert!(warnings[0].contains("z = 7.0 on the bed"), "{warnings:?}");
    // A drop hangs under a table, outside of any cavity.
    let table = "min(max(max(abs(x)-8, abs(y)-8), abs(z-9)-1), \
                 min(max(max(abs(x)-1, abs(y)-1), abs(z-5)-5), \
                 max(max(abs(x-7)-1, abs(y)-1), abs(z-6)-2)))";
    // Supports can take care of such a drop.
    let warnings = told(table);
    assert!(warnings[0].contains("begins on nothing"), "{warnings:?}");
    assert!(
        warnings.iter().all(|w| !w.contains("cavity")),
        "{warnings:?}"
    );
}
