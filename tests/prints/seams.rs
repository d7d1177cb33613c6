//! Where outer walls begin and end, read from the G-code.

use crate::common;
use crate::common::{
    Layer, MoveKind, OUTER_WALL, formula, parse, settings, slice,
};
use glam::DVec2;
use std::f64::consts::TAU;

/// One wall and nothing else, of a coarse lattice: quick.
const BARE: [&str; 7] = [
    "walls=1",
    "infill_density=0",
    "top_layers=0",
    "bottom_layers=0",
    "overhang_share=100",
    "sample_spacing=0.225",
    "skirt.loops=0",
];

const CYLINDER: &str = "max(sqrt(x^2 + y^2) - 15, abs(z) - 30)";
/// From 20 to 8 mm over 60.
const CONE: &str = "max((sqrt(x^2 + y^2) - 14 + 0.2*z), abs(z) - 30)";

fn layers(text: &str, assignments: &[&str]) -> Vec<Layer> {
    let all: Vec<&str> = BARE.iter().chain(assignments).copied().collect();
    let settings = settings(&all);
    let (gcode, _) = slice(&formula(text, &settings), &settings, 2);
    parse(&gcode)
}

/// Walls round thin pins keep their speed when a seam opens them, or an
/// overhang cuts them.
#[test]
fn walls_round_pins_are_slow_however_they_are_cut() {
    // 12.6 mm round; its upper half leans.
    let pin = "max(sqrt((x - max(0, 0.7*(z - 1)))^2 + y^2) - 2, abs(z-1) - 1)";
    for own in ["seam_gap=0.4", "seam_gap=1.5", "seam_scarf=4"] {
        let more = [
            own,
            "overhang_share=20",
            "cooling.min_layer_time=0",
            "speed.first_layer=25",
            "speed.overhang=60",
            "printer.max_moves_per_second=100000",
        ];
        let mut roles = std::collections::BTreeSet::new();
        for layer in &layers(pin, &more)[1..] {
            for m in layer.moves.iter().filter(|m| m.kind == MoveKind::Print) {
                assert_eq!(m.feed, 25.0 * 60.0, "{own} {}", m.role);
                roles.insert(m.role);
            }
        }
        assert!(roles.contains("Overhang perimeter"), "{own} {roles:?}");
        assert!(roles.contains(OUTER_WALL), "{own} {roles:?}");
    }
}

/// Where a layer's outer walls begin, from the middle of the bed.
fn begins(layer: &Layer) -> Vec<DVec2> {
    let wall = |i: usize| {
        let m = &layer.moves[i];
        m.kind == MoveKind::Print && m.role == OUTER_WALL
    };
    (0..layer.moves.len())
        .filter(|&i| wall(i) && (i == 0 || !wall(i - 1)))
        .map(|i| layer.moves[i].from.truncate() - DVec2::splat(110.0))
        .collect()
}

fn only_begins(layers: &[Layer]) -> Vec<DVec2> {
    let only = |l: &Layer| {
        let all = begins(l);
        assert_eq!(all.len(), 1, "{all:?}");
        all[0]
    };
    layers.iter().map(only).collect()
}

#[track_caller]
fn assert_steady(text: &str, assignments: &[&str]) {
    let seams = only_begins(&layers(text, assignments));
    // More than two blocks.
    assert!(seams.len() > 256, "{}", seams.len());
    for (i, pair) in seams.windows(2).enumerate() {
        let d = pair[0].distance(pair[1]);
        assert!(d <= 0.2, "layer {i}: {d} at {pair:?}");
    }
}

#[test]
fn seams_of_round_parts_are_straight_lines() {
    for text in [CYLINDER, CONE] {
        assert_steady(text, &[]);
        assert_steady(text, &["seam=rear"]);
        assert_steady(text, &["seam=expr: x - 2*y"]);
    }
    // The oval is off the axis, leans and grows, and its field is no distance.
    let oval = "max(((x - 0.1*z)^2/300 + y^2/90 - 1 - 0.004*z), abs(z) - 30)";
    assert_steady(oval, &[]);
}

/// A seam goes up with its corner, from block to block of layers.
#[test]
fn seams_follow_corners_that_wind_about_the_axis() {
    let square = |w: f64| {
        format!(
            "max(abs(x*cos({w}*z) - y*sin({w}*z)), \
             abs(x*sin({w}*z) + y*cos({w}*z))) - 8"
        )
    };
    let tooth = "sqrt(x^2 + y^2) - 9 + abs(2*sin(3*atan2(y, x) + z/5))";
    for (field, most) in
        [(&*square(0.04), 0.25), (&*square(-0.07), 0.3), (tooth, 0.4)]
    {
        let text = format!("max({field}, abs(z - 30) - 30)");
        let seams = only_begins(&layers(&text, &["accuracy=0.02"]));
        assert_eq!(seams.len(), 300);
        for (i, pair) in seams.windows(2).enumerate() {
            let way = pair[0].distance(pair[1]);
            assert!(way < most, "{field}: layer {i}: {way} at {pair:?}");
        }
    }
}

/// Where a wall hangs about as much as lets a seam leave its place, seams do not
/// go to and fro from layer to layer.
#[test]
fn seams_stay_on_walls_that_lean_a_little() {
    let star = "max(sqrt(x^2 + y^2) - 8 - 1.5*sin(5*atan2(y, x) + z/3), \
                abs(z - 12) - 12)";
    let seams = only_begins(&layers(star, &[]));
    assert_eq!(seams.len(), 120);
    for (i, pair) in seams.windows(2).enumerate() {
        let way = pair[0].distance(pair[1]);
        assert!(way < 1.0, "layer {i}: {way} at {pair:?}");
    }
}

/// Of equal places, those that hang are left to those over solid ground.
#[test]
fn seams_lie_over_solid_ground() {
    let box_at = |x: &str, y: &str| format!("max(abs({x}), abs({y})) - 8");
    let round_at = |x: &str, y: &str| format!("sqrt(({x})^2 + ({y})^2) - 8");
    for shape in [box_at, round_at] {
        for k in 0..8 {
            let lean = 1.3 * DVec2::from_angle(TAU * f64::from(k) / 8.0);
            let field = shape(
                &format!("x - ({})*z", lean.x),
                &format!("y - ({})*z", lean.y),
            );
            let text = format!("max({field}, abs(z - 3) - 3)");
            let all = layers(&text, &["accuracy=0.02"]);
            let seams = only_begins(&all);
            assert_eq!(seams.len(), 30);
            for (layer, seam) in all.iter().zip(&seams) {
                let middle = middle_of(layer, 0.0);
                // How far the wall moves outwards there.
                let out = match *seam - middle {
                    p if field.starts_with("max") => {
                        let [x, y] = p.abs().to_array();
                        // Both sides of a corner count.
                        let near = |a: f64, b: f64| a > b - 0.1;
                        let x = f64::from(u8::from(near(x, y))) * p.x.signum();
                        let y = f64::from(u8::from(near(y, p.x.abs())))
                            * p.y.signum();
                        (x * lean.x).max(y * lean.y)
                    }
                    p => p.normalize().dot(lean),
                };
                let least = if field.starts_with("max") && k % 2 == 0 {
                    // Two sides stay where they are.
                    1e-9
                } else {
                    // 17° from the upright.
                    0.3
                };
                assert!(out < least, "{field} at {seam}: {out}");
            }
        }
    }
}

/// A wall that is open at a tip goes round in one direction, whatever is printed
/// inside of it.
#[test]
fn walls_open_at_a_tip_keep_their_direction() {
    for side in ["x", "-x", "y", "-y"] {
        let across = if side.ends_with('x') { "y" } else { "x" };
        let wedge = format!("abs({across}) - 0.1*({side})");
        let text = format!("max({wedge}, max({side} - 40, abs(z - 2) - 2))");
        let settings = settings(&["sample_spacing=0.225", "skirt.loops=0"]);
        let (gcode, _) = slice(&formula(&text, &settings), &settings, 2);
        let all = parse(&gcode);
        let skins = |l: &Layer| l.length("Solid infill") > 0.0;
        assert!(all.iter().any(skins) && !all.iter().all(skins));
        for layer in &all {
            let wall = layer.prints().filter(|m| m.role == OUTER_WALL);
            let twice: f64 =
                wall.map(|m| m.ends().0.perp_dot(m.ends().1)).sum();
            let middle = layer.prints().find(|m| m.role == OUTER_WALL);
            let (first, last) = (middle.unwrap().ends().0, {
                let all = layer.prints().filter(|m| m.role == OUTER_WALL);
                all.last().unwrap().ends().1
            });
            assert!(first.distance(last) > 1.0, "{side}: the wall is open");
            assert!(twice + last.perp_dot(first) > 0.0, "{side} {}", layer.z);
        }
    }
}

#[test]
fn an_aligned_seam_is_in_the_concave_corner() {
    // A corner of a block cut out, up to (4, 3); turned, so that it is not
    // at the back.
    for angle in [0.0_f64, 2.0, 4.0] {
        let (c, s) = (angle.cos(), angle.sin());
        let text = format!(
            "max(max(max(abs(x*({c})+y*({s})) - 10, \
             abs(y*({c})-x*({s})) - 8), -max(4 - (x*({c})+y*({s})), \
             3 - (y*({c})-x*({s})))), abs(z) - 3)"
        );
        let all = layers(&text, &["sample_spacing=0.1"]);
        let seams = only_begins(&all);
        for p in &seams {
            assert!(p.distance(seams[0]) < 0.02, "{p} {}", seams[0]);
        }
        // The wall goes round the corner half its width from it; the part may
        // have been moved to the middle of the bed.
        let local = DVec2::from_angle(-angle).rotate(seams[3]);
        let middle = middle_of(&all[3], angle);
        let local = local - middle;
        assert!((local.x - (4.0 - 0.159)).abs() < 0.05, "{local}");
        assert!((local.y - (3.0 - 0.159)).abs() < 0.05, "{local}");
    }
}

/// The middle of a layer's outer wall, in directions turned by an angle.
fn middle_of(layer: &Layer, angle: f64) -> DVec2 {
    let turned = DVec2::from_angle(-angle);
    let points = layer.moves.iter().filter(|m| m.role == OUTER_WALL);
    let prints = points.filter(|m| m.kind == MoveKind::Print);
    let (low, high) = prints
        .map(|m| turned.rotate(m.to.truncate() - DVec2::splat(110.0)))
        .fold((DVec2::MAX, DVec2::MIN), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    0.5 * (low + high)
}

#[test]
fn rear_random_and_expressions_are_where_they_say() {
    let radius = 14.775;
    // The bed's layer has no settings of its own here.
    for p in only_begins(&layers(CYLINDER, &["seam=rear"])) {
        assert!(p.y > radius - 0.01 && p.x.abs() < 0.4, "{p}");
    }
    let low = DVec2::new(0.0, -radius);
    for p in only_begins(&layers(CYLINDER, &["seam=expr: y"])) {
        assert!(p.distance(low) < 0.05, "{p}");
    }
    // This seam turns with the height.
    let seams =
        only_begins(&layers(CYLINDER, &["seam=expr: x*cos(z/9) + y*sin(z/9)"]));
    // Each wall is a polygon of more than a hundred corners. One that lies 1 µm
    // off turns an edge of 0.7 mm by as much as the circle turns in 40 µm.
    let mut off: Vec<f64> = seams
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let z = 0.1 + 0.2 * i as f64;
            p.distance(-radius * DVec2::from_angle(z / 9.0))
        })
        .collect();
    off.sort_by(f64::total_cmp);
    let nearly_all = off[off.len() * 98 / 100];
    assert!(nearly_all < 0.05, "{nearly_all}");
    assert!(off.last().is_some_and(|d| *d < 0.06), "{off:?}");
    let seams = only_begins(&layers(CYLINDER, &["seam=random"]));
    let mut eighths = [0; 8];
    for p in &seams {
        eighths[(p.to_angle().rem_euclid(TAU) / TAU * 8.0) as usize % 8] += 1;
    }
    // 300 layers: 37 or 38 to an eighth, give or take six.
    assert!(eighths.iter().all(|n| (15..=62).contains(n)), "{eighths:?}");
    let near = seams.windows(2).filter(|w| w[0].distance(w[1]) < 5.0);
    assert!(near.count() < 60);
}

#[test]
fn a_nearest_seam_is_nearest_to_where_the_nozzle_was() {
    // A pillar and a block beside it.
    let two = "min(max(sqrt((x+12)^2 + y^2) - 6, abs(z) - 3), \
               max(max(abs(x-12) - 5, abs(y) - 5), abs(z) - 3))";
    for layer in &layers(two, &["seam=nearest", "seam_wipe=0"])[1..] {
        let mut was = layer.moves[0].from.truncate();
        let (mut walls, mut begun) = (Vec::new(), false);
        for m in &layer.moves {
            let (from, to) = m.ends();
            if m.kind == MoveKind::Print && !begun {
                walls.push((was, Vec::new()));
            }
            begun = m.kind == MoveKind::Print;
            if begun {
                walls.last_mut().unwrap().1.push(from);
                was = to;
            }
        }
        assert_eq!(walls.len(), 2);
        // What is printed last begins where the nozzle is expected to come from.
        walls.pop();
        for (was, points) in walls {
            let own = was.distance(points[0]);
            let least = points.iter().map(|p| was.distance(*p));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(own < least + 0.02, "{own} {least}");
        }
    }
}

/// A wavy box, and settings that cut, move and vary its walls.
const ROUGH: &str = "max(max(abs(x) - 12, abs(y) - 6 - 2*sin(z)), abs(z) - 4)";
const COMBINATIONS: [&[&str]; 4] = [
    &[],
    &["fuzzy.thickness=0.2"],
    &["overhang_share=30", "walls=3", "wall_order=outer-first"],
    &["outer_wall_width=0.6", "thin_max=150", "flow=expr: 100 + x"],
];

/// Filament in outer walls, of which some are overhangs.
fn in_walls(layers: &[Layer]) -> f64 {
    let all = layers.iter().flat_map(Layer::prints);
    all.map(|m| m.fed).sum()
}

#[test]
fn loops_end_in_a_wipe_inwards() {
    for more in COMBINATIONS {
        let mut all = vec!["seam_wipe=0.4"];
        all.extend(more);
        let layers = layers(ROUGH, &all);
        let (mut ends, mut wipes) = (0, 0);
        for layer in &layers {
            for pair in layer.moves.windows(2) {
                let ended = pair[0].kind == MoveKind::Print
                    && pair[0].role == OUTER_WALL
                    && pair[1].kind != MoveKind::Print;
                if !ended {
                    continue;
                }
                ends += 1;
                // The wipe comes before anything is pulled back.
                let wipe = &pair[1];
                if wipe.kind != MoveKind::Travel || wipe.length() > 0.41 {
                    continue;
                }
                wipes += 1;
                let (from, to) = wipe.ends();
                let middle = DVec2::splat(110.0);
                let (a, b) = (from - middle, to - middle);
                // A rough wall need not run along its side.
                let slack = if more.contains(&"fuzzy.thickness=0.2") {
                    0.2
                } else {
                    0.02
                };
                let inside = b.abs().cmple(a.abs() + slack).all();
                assert!(inside && wipe.length() > 0.09, "{a} {b}");
            }
        }
        assert!(10 * wipes >= 9 * ends, "{wipes} of {ends} {more:?}");
        assert!(2 * wipes >= layers.len(), "{wipes} {more:?}");
    }
}

#[test]
fn gaps_and_scarfs_go_with_everything() {
    for more in COMBINATIONS {
        let fed = |own: &[&str]| {
            let mut all = own.to_vec();
            all.extend(more);
            in_walls(&layers(ROUGH, &all))
        };
        let plain = fed(&[]);
        // What is printed twice adds up to what was printed once.
        let scarf = fed(&["seam_scarf=8"]) / plain;
        assert!((scarf - 1.0).abs() < 0.003, "{scarf} {more:?}");
        // Half a millimetre of about 70, of one wall of several.
        let gap = 1.0 - fed(&["seam_gap=0.5"]) / plain;
        assert!(gap > 0.001 && gap < 0.012, "{gap} {more:?}");
    }
}

#[test]
fn seams_depend_neither_on_threads_nor_on_the_range() {
    let twisted = "max(max(abs(x*cos(z/9) + y*sin(z/9)) - 9, \
                   abs(y*cos(z/9) - x*sin(z/9)) - 6), abs(z) - 14)";
    for seam in ["aligned", "random", "expr: abs(x) + d", "nearest"] {
        let seam = format!("seam={seam}");
        let mut all = BARE.to_vec();
        all.extend([seam.as_str(), "seam_scarf=3", "fuzzy.thickness=0.1"]);
        // A file of some layers cannot tell how far the print has come.
        all.push("gcode.progress=off");
        let settings = settings(&all);
        let model = formula(twisted, &settings);
        let (one, _) = slice(&model, &settings, 1);
        let (three, _) = slice(&model, &settings, 3);
        assert!(one == three, "{seam}");
        let (upper, _) = common::slice_layers(&model, &settings, "129..140", 2);
        let body = |text: &str, skip: usize| {
            let end = text.find("; end of layers").unwrap();
            let mut parts = text[..end].split(";LAYER_CHANGE");
            parts.by_ref().take(skip + 1).count();
            parts.collect::<String>()
        };
        assert!(body(&upper, 0).len() > 1000);
        assert!(body(&upper, 0) == body(&one, 128), "{seam}");
    }
}

/// A scarf that rises: at each angle as much is laid as at any other, and every
/// move lies between the layer below and its own.
#[test]
fn a_scarf_that_rises_lays_the_same_at_each_angle() {
    let own = [
        "seam_scarf=20 mm from 10%",
        "gcode.relative_e=true",
        "cooling.min_layer_time=0",
    ];
    let all: Vec<&str> = BARE.iter().chain(&own).copied().collect();
    let settings = settings(&all);
    let short = CYLINDER.replace("30", "2");
    let (gcode, _) = slice(&formula(&short, &settings), &settings, 2);
    let rules = isoslice::check::Rules::new(&settings);
    let verdict = isoslice::check::check(gcode.as_bytes(), &rules).unwrap();
    assert!(verdict.counts.is_empty(), "{:?}", verdict.counts);
    for layer in &parse(&gcode)[1..] {
        const BINS: usize = 180;
        let mut laid = [0.0; BINS];
        let (mut low, mut rises) = (f64::INFINITY, 0);
        for m in layer.prints() {
            let below = layer.z - 0.2;
            for z in [m.from.z, m.to.z] {
                assert!(z > below && z <= layer.z + 1e-9, "{z} {below}");
                low = low.min(z);
            }
            assert!(m.to.z >= m.from.z);
            rises += usize::from(m.to.z > m.from.z);
            let (a, b) = m.ends();
            let middle = DVec2::splat(110.0);
            // The scarf comes in short parts, and the ramp grows along it.
            let count = 200;
            for k in 0..count {
                let t = (f64::from(k) + 0.5) / f64::from(count);
                let turn = (a.lerp(b, t) - middle).to_angle() / TAU;
                let bin = (turn.rem_euclid(1.0) * BINS as f64) as usize;
                laid[bin.min(BINS - 1)] += m.fed / f64::from(count);
            }
        }
        // 20 mm of 93, in steps of less than a millimetre.
        assert!(rises > 15, "{rises}");
        assert!((low - (layer.z - 0.18)).abs() < 0.0011, "{low}");
        let mean = laid.iter().sum::<f64>() / BINS as f64;
        let area = common::filament_area(1.75);
        let meant = TAU * 14.775 * (0.25 * 0.2 + 0.01 * TAU / 2.0);
        let all = mean * BINS as f64 * area / meant;
        assert!((all - 1.0).abs() < 1e-3, "{all}");
        for (i, laid) in laid.iter().enumerate() {
            assert!((laid / mean - 1.0).abs() < 0.01, "{i}: {}", laid / mean);
        }
    }
    // The first layer has nothing to rise from.
    let first = &parse(&gcode)[0];
    let level = |m: &common::Move| m.from.z == m.to.z;
    assert!(first.prints().all(level));
}
