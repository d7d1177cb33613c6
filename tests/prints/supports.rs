//! Supports in whole runs: where they are wanted, and what is told of them.

use crate::common;
use crate::common::{
    MoveKind, SUPPORT, SUPPORT_INTERFACE, formula, parse, settings, slice,
};
use glam::DVec2;
use isoslice::pipeline::{self, Options, SliceError, Summary};
use std::collections::BTreeMap;

/// Coarse settings, which are quick.
const COARSE: [&str; 3] =
    ["sample_spacing=0.225", "accuracy=0.02", "layer_height=0.2"];
/// A stem of 8 mm, and from 10 mm on arms of 20 mm on both sides.
const TEE: &str = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 7) - 7), \
                   max(max(abs(x) - 24, abs(y) - 6), abs(z - 12) - 2))";
/// A trunk that widens by 45° from 8 mm on, which holds itself.
const CHALICE: &str = "max(max(abs(x), abs(y)) - 4 - max(0, min(z - 8, 6)), \
                       abs(z - 8) - 8)";

fn run(text: &str, set: &[&str]) -> (String, Summary) {
    let settings = settings(&[&COARSE, set].concat());
    slice(&formula(text, &settings), &settings, 2)
}

/// Ways from support to support leave no strings: what is not retracted in the air
/// beside the part, 3 mm a layer at most, and 2 mm at once.
#[test]
fn supports_are_not_strung_together() {
    let posts = "min(min(max(abs(abs(x) - 10) - 1.5, max(abs(y) - 1.5, \
                 abs(z - 4) - 4)), max(max(abs(x) - 17, abs(y) - 8), \
                 abs(z - 9) - 1)), max(max(abs(x) - 3, abs(y) - 3), \
                 abs(z - 5) - 5))";
    for part in [TEE, posts] {
        let (gcode, _) = run(part, &["supports=auto", "layer_height=0.3"]);
        let of_support =
            |role: &str| [SUPPORT, SUPPORT_INTERFACE].contains(&role);
        let layers = parse(&gcode);
        let (mut all, mut ways) = (0.0, 0);
        let mut role = "";
        for layer in &layers {
            for step in &layer.moves {
                let string = step.kind == MoveKind::Travel && step.back == 0.0;
                if string && of_support(role) {
                    assert!(step.length() < 2.0, "line {}", step.line);
                    (all, ways) = (all + step.length(), ways + 1);
                }
                if step.kind == MoveKind::Print {
                    role = step.role;
                }
            }
        }
        assert!(ways > 0 && all < 3.0 * layers.len() as f64, "{all}");
    }
}

/// Ends of what supports print, from the middle of the part, by layer.
fn supported(gcode: &str) -> Vec<Vec<DVec2>> {
    let middle = DVec2::splat(110.0);
    let of_support = |role: &str| [SUPPORT, SUPPORT_INTERFACE].contains(&role);
    let ends = |layer: common::Layer| {
        let moves = layer.prints().filter(|m| of_support(m.role));
        moves.map(|m| m.ends().1 - middle).collect()
    };
    parse(gcode).into_iter().map(ends).collect()
}

/// The heights to which supports reach, from below, with the filament that is
/// fed for them.
fn tops(gcode: &str) -> Vec<(f64, f64)> {
    let of_support = |role: &str| [SUPPORT, SUPPORT_INTERFACE].contains(&role);
    let top = |layer: common::Layer| {
        let moves = layer.prints().filter(|m| of_support(m.role));
        let moves: Vec<common::Move> = moves.copied().collect();
        let z = moves.first()?.to.z;
        // What lies at one height is one layer to viewers.
        assert!((layer.z - z).abs() < 1e-9, "{} in {}", z, layer.z);
        assert!(moves.iter().all(|m| m.to.z == z && m.from.z == z));
        Some((z, moves.iter().map(|m| m.fed).sum()))
    };
    let mut tops: Vec<(f64, f64)> =
        parse(gcode).into_iter().filter_map(top).collect();
    tops.sort_by(|a, b| a.0.total_cmp(&b.0));
    tops
}

#[test]
fn gaps_are_as_asked_for_whatever_the_layer_height() {
    let filament = |tops: &[(f64, f64)]| tops.iter().map(|t| t.1).sum::<f64>();
    let (whole, _) = run(TEE, &["supports=auto"]);
    let whole = filament(&tops(&whole));
    for gap in [0.07, 0.13, 0.2, 0.28, 0.39] {
        let set = format!("support.z_gap={gap}");
        let (gcode, summary) = run(TEE, &["supports=auto", &set]);
        assert_eq!(summary.warnings, Vec::<String>::new());
        let tops = tops(&gcode);
        // The arms begin at 10 mm.
        let top = tops.last().unwrap().0;
        assert!((10.0 - gap - top).abs() < 1e-9, "{gap}: {top}");
        // Each layer of a support is as high as others and lies on the one
        // below, but for the first.
        let steps = tops.windows(2).map(|pair| pair[1].0 - pair[0].0);
        let uneven = steps.filter(|step| (step - 0.2).abs() > 1e-6).count();
        assert!(uneven <= 2, "{gap}: {uneven} of {}", tops.len());
        // So the supports take about as much filament as with the usual gap.
        let share = filament(&tops) / whole;
        assert!((share - 1.0).abs() < 0.06, "{gap}: {share}");
    }
}

#[test]
fn a_support_on_the_part_has_the_gap_below_it_too() {
    // The arms of the tee over a wide plate of 3 mm.
    let part = format!("min({TEE}, max(max(abs(x), abs(y)) - 40, z - 3))");
    let part = format!("max({part}, -z)");
    for below in [0.13, 0.2, 0.35] {
        let set = format!("support.z_gap_bottom={below}");
        let all = ["supports=auto", "support.z_gap=0.13", &set];
        let (gcode, _) = run(&part, &all);
        let layers = parse(&gcode);
        let first_of = |role: &str| {
            let has = |l: &&common::Layer| l.prints().any(|m| m.role == role);
            let layer = layers.iter().find(has).unwrap();
            let of = layer.prints().find(|m| m.role == role).copied();
            (layer.z, of.unwrap())
        };
        let (top, bead) = first_of(SUPPORT);
        let way = (bead.to - bead.from).truncate().length();
        let area = bead.fed * common::filament_area(1.75) / way;
        // (w - h) h + π (h/2)², solved for h by steps.
        let of = |h: f64| {
            (bead.width - h) * h + std::f64::consts::PI * (0.5 * h).powi(2)
        };
        let height = (0..4000).map(|k| f64::from(k) * 1e-4);
        let height = height.take_while(|&h| of(h) < area).last().unwrap();
        let air = top - height - 3.0;
        assert!((air - below).abs() < 0.01, "{below}: {air}");
    }
}

/// How far supports reach in each layer that has some, along x.
fn reach(gcode: &str) -> Vec<f64> {
    let far = |ends: Vec<DVec2>| {
        ends.iter().map(|p| p.x.abs()).reduce(f64::max).into_iter()
    };
    supported(gcode).into_iter().flat_map(far).collect()
}

#[test]
fn columns_go_straight_down() {
    let of = |style: &str| {
        let style = format!("support.style={style}");
        let (gcode, summary) = run(TEE, &["supports=auto", &style]);
        assert_eq!(summary.warnings, Vec::<String>::new());
        let filament: f64 = tops(&gcode).iter().map(|t| t.1).sum();
        (reach(&gcode), filament)
    };
    let (tree, of_tree) = of("tree");
    let (snug, of_snug) = of("snug");
    let (grid, of_grid) = of("grid");
    // The posts are far inside; 49 layers lie under the gap below the arms.
    assert!(tree[0] < 22.0, "{}", tree[0]);
    assert_eq!((snug.len(), grid.len()), (49, 49));
    // Snug supports reach as far as the arms, in squares of 4 mm.
    assert!(snug.iter().all(|x| (x - 24.0).abs() < 0.5), "{snug:?}");
    assert!(grid.iter().all(|x| (x - 28.0).abs() < 0.5), "{grid:?}");
    assert!(of_snug > 1.5 * of_tree && of_grid > of_snug);
}

/// A leaning plate with a hole, on a base that reaches so far that no branch of the
/// hole's ceiling comes past it but along the plate.
#[test]
fn no_branch_comes_down_as_a_sheet() {
    let stand = "min(max(max(abs(x - 12) - 40, abs(y) - 35), abs(z - 2) - 2), \
                 max(max(max(abs(x - 0.36*z) - 3, abs(y) - 30), abs(z - 30) - 30), \
                 7 - sqrt(y^2 + (z - 32)^2)))";
    let (gcode, _) = run(stand, &["supports=auto", "support.style=tree"]);
    let mut wide = 0;
    for layer in supported(&gcode) {
        let across = layer.iter().map(|p| p.y.abs()).fold(0.0, f64::max);
        assert!(across < 9.0, "{across}");
        wide += usize::from(across > 3.0);
    }
    // It is drawn together to a post.
    assert!((3..60).contains(&wide), "{wide}");
}

#[test]
fn low_wide_faces_are_held_by_columns() {
    // 864 mm² at a height of 4 mm, and of 14 mm.
    let plate = |height: f64| {
        format!(
            "min(max(max(abs(x), abs(y)) - 3, abs(z - {h}) - {h}), \
             max(max(abs(x), abs(y)) - 15, abs(z - {height} - 1) - 1))",
            h = 0.5 * height
        )
    };
    let of = |height: f64, style: &str| {
        let style = format!("support.style={style}");
        supported(&run(&plate(height), &["supports=auto", &style]).0)
    };
    let low = of(4.0, "auto");
    assert_eq!(low, of(4.0, "snug"));
    assert_ne!(low, of(4.0, "tree"));
    let high = of(14.0, "auto");
    assert_eq!(high, of(14.0, "tree"));
    assert_ne!(high, of(14.0, "snug"));
}

#[test]
fn supports_in_a_closed_cavity_are_told_of() {
    // A ball with walls of 3 mm, on a flat of its own, and the same with a
    // hole of 6 mm in its side.
    let ball = "max(abs(sqrt(x*x + y*y + z*z) - 13.5) - 1.5, -13 - z)";
    let vented =
        format!("max({ball}, min(x + 1, 3 - sqrt(y*y + (z + 5)*(z + 5))))");
    let warnings =
        |text: &str, set: &[&str]| run(text, set).1.warnings.join("\n");
    let told = warnings(ball, &["supports=auto"]);
    assert!(told.contains("mm³ stand in closed cavities"), "{told}");
    let told = warnings(&vented, &["supports=auto"]);
    assert!(!told.contains("cavities"), "{told}");
    // A bell is open below.
    let bell = "max(abs(sqrt(x*x + y*y + z*z) - 13.5) - 1.5, -z)";
    let (_, summary) = run(bell, &["supports=auto"]);
    assert!(summary.support_length > 0.0);
    let told = summary.warnings.join("\n");
    assert!(!told.contains("cavities"), "{told}");
}

#[test]
fn a_lip_gets_no_support_unless_it_is_asked_for() {
    // A wall with a rim around it from 8 mm on, 2 mm high.
    let rim = |by: f64| {
        format!(
            "min(max(max(abs(x) - 12, abs(y) - 4), abs(z - 7) - 7), \
             max(max(abs(x) - 12 - {by}, abs(y) - 4 - {by}), abs(z - 9) - 1))"
        )
    };
    // What a survey tells of is what is printed.
    let has_some = |by: f64, set: &[&str]| {
        let settings = settings(&[&COARSE, set].concat());
        let model = formula(&rim(by), &settings);
        let told = isoslice::survey(&model, &settings, Some(2)).unwrap();
        let (gcode, summary) = slice(&model, &settings, 2);
        assert_eq!(summary.warnings, Vec::<String>::new(), "{by}");
        let some = supported(&gcode).iter().any(|ends| !ends.is_empty());
        assert_eq!(!told.places.is_empty(), some, "{by}");
        some
    };
    assert!(!has_some(0.4, &["supports=auto"]));
    for by in [0.6, 0.7, 0.95] {
        assert!(has_some(by, &["supports=auto"]));
    }
    assert!(has_some(0.4, &["supports=auto", "support.where=1"]));
}

#[test]
fn a_formula_leaves_one_arm_of_a_tee_alone() {
    let set = ["supports=auto", "support.where=expr: min(x, 0)"];
    let (gcode, summary) = run(TEE, &set);
    assert_eq!(summary.warnings, Vec::<String>::new());
    let layers = supported(&gcode);
    let all: Vec<DVec2> = layers.concat();
    assert!(!all.is_empty());
    // A foot, or a branch that leans, is no wider than this beside the arm.
    let least = all.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
    assert!(least > 4.0, "{least}");
    let most = all.iter().map(|p| p.x).fold(0.0, f64::max);
    assert!((23.5..26.0).contains(&most), "{most}");
    // Without that setting both arms are held, also the one on the left.
    let (both, _) = run(TEE, &set[..1]);
    let least = supported(&both)
        .concat()
        .iter()
        .map(|p| p.x)
        .fold(0.0, f64::min);
    assert!(least < -23.5, "{least}");
}

#[test]
fn a_formula_asks_for_a_support_where_none_is_needed() {
    let (gcode, summary) = run(CHALICE, &["supports=auto"]);
    assert_eq!(summary.support_length, 0.0);
    assert_eq!(supported(&gcode).concat(), []);
    // Supports are wanted between 10 and 12 mm, to the right.
    let wanted = "support.where=expr: min(x - 2, 1 - abs(z - 11))";
    let (gcode, summary) = run(CHALICE, &["supports=auto", wanted]);
    let layers = supported(&gcode);
    let all = layers.concat();
    assert!(summary.support_length > 0.0);
    assert!(all.iter().all(|p| p.x > 1.0), "{all:?}");
    let highest = layers.iter().rposition(|l| !l.is_empty()).unwrap();
    // The face's upper end is 12 mm high, and the gap below it 0.2 mm.
    assert!((57..=59).contains(&highest), "{highest}");
    assert!(layers[..highest].iter().all(|l| !l.is_empty()));
    // The widest of them is under the face at that height: 8 mm.
    let most = all.iter().map(|p| p.x).fold(0.0, f64::max);
    assert!((7.5..9.5).contains(&most), "{most}");
}

#[test]
fn forbidding_all_of_them_is_as_if_they_were_off() {
    let lines = |set: &[&str]| {
        let (gcode, _) = run(TEE, set);
        let own = |line: &&str| {
            !["; support_material", "; isoslice "]
                .iter()
                .any(|start| line.starts_with(start))
        };
        gcode
            .lines()
            .filter(own)
            .map(String::from)
            .collect::<Vec<_>>()
    };
    let off = lines(&[]);
    assert!(off.len() > 1000);
    for wanted in ["-1", "expr: -1 - x^2", "expr: 0*x - 3"] {
        let set = format!("support.where={wanted}");
        assert_eq!(lines(&["supports=auto", &set]), off, "{wanted}");
    }
}

#[test]
fn a_formula_without_effect_or_value_is_told_of() {
    // This expression is neither positive nor negative where the part is.
    let (_, summary) = run(
        TEE,
        &["supports=auto", "support.where=expr: max(x - 99, 0)"],
    );
    let told = summary.warnings.join("\n");
    assert!(told.contains("support.where has no effect"), "{told}");
    assert!(summary.support_length > 0.0);
    // This column is too steep for a support beside it.
    let column = "max(max(abs(x) - 3 - z/3, abs(y) - 3), abs(z - 8) - 8)";
    let (_, summary) = run(column, &["supports=auto", "support.where=1"]);
    let told = summary.warnings.join("\n");
    assert!(told.contains("support.xy_gap leaves no room"), "{told}");
    for (wanted, named) in [
        ("expr: sqrt(x - 10)", "has no value at x = "),
        ("expr: x +", "column"),
    ] {
        let wanted = format!("support.where={wanted}");
        let set = [&COARSE[..], &["supports=auto", &wanted]].concat();
        let settings = settings(&set);
        let model = formula(TEE, &settings);
        let failed = pipeline::slice(
            &model,
            &settings,
            &Options::default(),
            &mut std::io::sink(),
        );
        let Err(SliceError::Vary(error)) = failed else {
            panic!("{wanted}: {failed:?}");
        };
        let text = error.to_string();
        assert!(text.starts_with("support.where = \"expr:"), "{text}");
        assert!(text.contains(named), "{text}");
    }
}

#[test]
fn a_formula_may_ask_for_the_depth() {
    // The arms begin 0.07 mm below the bottom of a layer.
    let tee = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 7) - 7), \
               max(max(abs(x) - 24, abs(y) - 6), abs(z - 12) - 2.07))";
    let (plain, of_plain) = run(tee, &["supports=auto"]);
    let of = |wanted: &str| {
        let wanted = format!("support.where=expr: {wanted}");
        run(tee, &["supports=auto", &wanted])
    };
    let same = |gcode: &str| supported(gcode) == supported(&plain);
    assert!(of_plain.support_length > 100.0);
    assert!(same(&of("min(0, 0.3 - d)").0));
    // All but a thin rim is deeper than this.
    let left = of("min(0, 0.03 - d)").1.support_length;
    assert!(left < 0.15 * of_plain.support_length, "{left}");
    // No depth is below 0, so this has a value everywhere.
    assert!(same(&of("min(0, 1 - sqrt(d))").0));
}

#[test]
fn dense_layers_have_a_pattern_direction_and_spacing_of_their_own() {
    let interface = |set: &[&str]| {
        let all = [&["supports=auto"], set].concat();
        let (gcode, summary) = run(TEE, &all);
        assert_eq!(summary.warnings, Vec::<String>::new());
        let layers = parse(&gcode);
        let of = |m: &&common::Move| m.role == SUPPORT_INTERFACE;
        let layer = layers.iter().rfind(|l| l.prints().any(|m| of(&m)));
        let moves = layer.unwrap().prints().filter(of).copied();
        moves.collect::<Vec<common::Move>>()
    };
    // Millimetres along a direction, and in all, without the wall around.
    let along = |moves: &[common::Move], angle: f64| {
        let way = DVec2::from_angle(angle.to_radians());
        let is_along = |m: &&common::Move| {
            let (a, b) = m.ends();
            (b - a).normalize_or_zero().dot(way).abs() > 0.9999
        };
        moves
            .iter()
            .filter(is_along)
            .map(|m| m.length())
            .sum::<f64>()
    };
    let both = |moves: &[common::Move], angle: f64| {
        along(moves, angle).max(along(moves, angle + 90.0))
    };
    let plain = interface(&[]);
    let turned = interface(&["support.interface_pattern=20"]);
    assert!(both(&plain, 45.0) > 300.0 && both(&plain, 20.0) < 5.0);
    assert!(both(&turned, 20.0) > 300.0 && both(&turned, 45.0) < 5.0);
    let dense = ["supports=auto", "support.interface_density=0.2 mm"];
    let told = run(TEE, &dense).1.warnings.join("\n");
    assert!(
        told.contains("support.interface_density = \"0.2 mm\" is"),
        "{told}"
    );
    let wide = interface(&["support.interface_density=2mm"]);
    // 95 % in lines of 0.407 mm, against 2 mm.
    let ratio = both(&plain, 45.0) / both(&wide, 45.0);
    assert!((ratio / (2.0 / 0.407 * 0.95) - 1.0).abs() < 0.15, "{ratio}");
    let rings = interface(&["support.interface_pattern=concentric"]);
    assert!(both(&rings, 45.0) < 5.0 && both(&rings, 0.0) > 300.0);
}

#[test]
fn they_have_flow_and_fan_of_their_own() {
    let fed = |set: &[&str]| {
        let all = [&["supports=auto", "cooling.min_layer_time=0"], set];
        let (gcode, summary) = run(TEE, &all.concat());
        assert_eq!(summary.warnings, Vec::<String>::new());
        let of = |role: &str| -> f64 {
            let layers = parse(&gcode);
            let prints = layers.iter().flat_map(common::Layer::prints);
            prints.filter(|m| m.role == role).map(|m| m.fed).sum()
        };
        ([of(SUPPORT), of(SUPPORT_INTERFACE)], gcode)
    };
    let (plain, gcode) = fed(&[]);
    // 30 % of 255.
    let slow = "M106 S77";
    assert!(!gcode.contains(slow));
    let (own, gcode) = fed(&[
        "support.flow=80",
        "support.interface_flow=120",
        "cooling.support_interface_fan_speed=30",
    ]);
    let shares = [own[0] / plain[0], own[1] / plain[1]];
    for (share, asked) in shares.into_iter().zip([0.8, 1.2]) {
        assert!((share - asked).abs() < 2e-3, "{shares:?}");
    }
    let mut blown = 0;
    let mut fan = "";
    for line in gcode.lines() {
        if line.starts_with("M106") || line.starts_with("M107") {
            fan = line;
        } else if line.starts_with(";TYPE:") {
            let is = line.ends_with(SUPPORT_INTERFACE);
            blown += usize::from(is && fan.starts_with(slow));
        }
    }
    assert!(
        blown > 0,
        "the fan turns before the role is named, or never"
    );
}

/// A cone of 15° that hangs from an arm, its tip down at 6 mm.
const DROP: &str = "min(min(max(max(abs(x) - 12, abs(y) - 6), abs(z - 15) - 1), \
                    max(max(abs(x - 10) - 2, abs(y) - 6), abs(z - 8) - 8)), \
                    max(0.966*(sqrt(x^2 + y^2) - 0.268*(z - 6)), z - 15))";

#[test]
fn supports_of_a_tip_stay_out_of_it_with_wide_nozzles() {
    for (nozzle, height) in [(0.6, 0.3), (0.8, 0.2), (0.8, 0.4)] {
        let set = [
            "supports=auto",
            &format!("printer.nozzle_diameter={nozzle}"),
            &format!("layer_height={height}"),
            &format!("first_layer_height={height}"),
        ];
        let (gcode, summary) = run(DROP, &set);
        assert_eq!(summary.warnings, Vec::<String>::new());
        // By height: how near supports and part come to the cone's axis.
        let (mut support, mut part) = (Vec::new(), Vec::new());
        for layer in parse(&gcode) {
            for m in layer.prints() {
                let (a, b) = m.ends();
                let near = a.midpoint(b).distance(DVec2::splat(110.0));
                let is_support = [SUPPORT, SUPPORT_INTERFACE].contains(&m.role);
                let list = if is_support { &mut support } else { &mut part };
                list.push((m.to.z, near, 0.5 * m.width));
            }
        }
        let at_tip = part.iter().filter(|(_, near, _)| *near < 1.0);
        let first = at_tip.map(|t| t.0).fold(f64::INFINITY, f64::min);
        // Where the cone is about as thick as the narrowest bead of a tip.
        let thick = 2.0 * 0.268 * (first - 6.0);
        assert!(thick < 0.7 * nozzle + 0.1, "{nozzle}: {thick}");
        // The support that holds the tip ends a gap below it.
        let below = support
            .iter()
            .filter(|(z, near, _)| *near < 1.2 && *z < first);
        let top = below.map(|s| s.0).fold(0.0, f64::max);
        assert!((first - height - top - 0.2).abs() < 1e-6, "{nozzle}: {top}");
        // No support lies in the cone, be it printed there or not.
        for (z, near, half) in support {
            let cone = 0.268 * (z - 0.5 * height - 6.0);
            let free = near - half - cone;
            assert!(cone < 0.0 || free > 0.0, "{nozzle}: {free} at {z}");
        }
    }
}

#[test]
fn an_edge_in_the_air_or_on_the_bed_is_held_from_both_sides() {
    // Wedges of 28° and of 53° that stand on their edges, one of them below the arms
    // of a T.
    let hung = format!(
        "min({TEE}, max(max(abs(x - 14) - 0.25*(z - 4), abs(y) - 5), z - 11))"
    );
    let stands = "max(max(abs(x) - z/2, abs(y) - 5), z - 3)";
    let wedges = [(&*hung, 14.0, 4.0, 0.25), (stands, 0.0, 0.0, 0.5)];
    for (text, x, edge, slope) in wedges {
        let (gcode, _) = run(text, &["supports=auto"]);
        let middle = DVec2::new(110.0 + x, 110.0);
        // By height: where lines cross the middle, from which side to which.
        let (mut support, mut part) = (Vec::new(), Vec::new());
        for layer in parse(&gcode) {
            for m in layer.prints() {
                let (a, b) = m.ends();
                let [a, b] = [a - middle, b - middle];
                if a.y * b.y > 0.0 || a.x.abs().max(b.x.abs()) > 2.0 {
                    continue;
                }
                let (at, half) = (0.5 * (a.x + b.x), 0.5 * m.width);
                let line = (m.to.z, at - half, at + half);
                let is_support = [SUPPORT, SUPPORT_INTERFACE].contains(&m.role);
                let list = if is_support { &mut support } else { &mut part };
                list.push(line);
            }
        }
        let first = part.iter().map(|l| l.0).fold(f64::INFINITY, f64::min);
        assert!(first > edge + 0.2, "{edge}: {first}");
        // No support is in the wedge, be it printed there or not.
        for (z, from, to) in &support {
            let half = slope * (z - 0.1 - edge);
            let is_free = half < 0.0 || *from > half || *to < -half;
            assert!(is_free, "{edge}: {from} to {to} at {z}");
        }
        // The first line lies above supports on both sides.
        let gap = if edge > 0.0 { 0.2 } else { 0.0 };
        let top = first - 0.2 - gap;
        let below = support.iter().filter(|l| (l.0 - top).abs() < 1e-6);
        let below: Vec<_> = below.collect();
        let away = |p: f64| {
            let off = |l: &&(f64, f64, f64)| (l.1 - p).max(p - l.2).max(0.0);
            below.iter().map(off).fold(f64::INFINITY, f64::min)
        };
        let line = part.iter().find(|l| l.0 == first).unwrap();
        let far = [line.1, line.2].map(away);
        assert!(far.iter().all(|far| *far < 0.1), "{edge}: {far:?}");
    }
}

#[test]
fn what_is_forbidden_or_has_no_room_is_told_of() {
    let warnings = |set: &[&str]| {
        let (gcode, summary) = run(TEE, &[&["supports=auto"], set].concat());
        assert!(supported(&gcode).iter().all(Vec::is_empty), "{set:?}");
        summary.warnings
    };
    // Nothing is higher than 14 mm; undersides are no depth below the surface.
    for wanted in ["-1", "expr: z - 20", "expr: d - 1"] {
        let set = format!("support.where={wanted}");
        let [warning] = &warnings(&[&set])[..] else {
            panic!("{wanted}");
        };
        let says = "support.where is negative under every face that needs";
        assert!(warning.starts_with(says), "{warning}");
    }
    // The arms begin at 10 mm.
    for gap in ["9.95", "10"] {
        let set = format!("support.z_gap={gap}");
        let [warning] = &warnings(&[&set])[..] else {
            panic!("{gap}");
        };
        let says = format!("support.z_gap = {gap} mm leaves no room");
        assert!(warning.contains(&says), "{warning}");
        assert!(warning.starts_with("4"), "{warning}");
    }
}

#[test]
fn gaps_through_which_the_part_sags_are_told_of() {
    for (gap, wide) in [("0.4", false), ("0.45", true), ("3", true)] {
        let set = format!("support.z_gap={gap}");
        let (_, summary) = run(TEE, &["supports=auto", &set]);
        let says =
            format!("support.z_gap = {gap} mm is more than the nozzle's");
        let told = summary.warnings.iter().any(|w| w.starts_with(&says));
        assert_eq!(told, wide, "{:?}", summary.warnings);
    }
}

/// The height of an underside above the bed, where it counts.
type Under<'a> = &'a dyn Fn(DVec2) -> Option<f64>;

/// The air between the highest beads of supports and an underside, less
/// `support.z_gap`, for each cell of a grid, where `under` gives a height.
/// Lines of the dense layers lie nearer to each other than a cell is wide.
fn airs(gcode: &str, under: Under<'_>) -> Vec<f64> {
    const CELL: f64 = 0.6;
    let middle = DVec2::splat(110.0);
    let mut highest: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for layer in parse(gcode) {
        let of_top = |m: &&common::Move| m.role == SUPPORT_INTERFACE;
        for m in layer.prints().filter(of_top) {
            let steps = (m.length() / 0.05).ceil().max(1.0);
            let mut k = 0.0;
            while k <= steps {
                let at = m.from.lerp(m.to, k / steps);
                let place = at.truncate() - middle;
                if let Some(height) = under(place) {
                    let air = height - at.z - 0.2;
                    let cell = (place / CELL).floor();
                    let cell = (cell.x as i64, cell.y as i64);
                    let least = highest.entry(cell).or_insert(air);
                    *least = least.min(air);
                }
                k += 1.0;
            }
        }
    }
    highest.into_values().collect()
}

/// The value that `share` of some values, without their signs, are below.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    values.sort_by(f64::total_cmp);
    values[(share * (values.len() - 1) as f64) as usize]
}

#[test]
fn tops_of_supports_follow_the_underside_if_they_are_to() {
    let foot = "max(max(abs(x + 30) - 3, abs(y) - 3), abs(z - 5) - 5)";
    let slope = 8_f64.to_radians().tan();
    let plane = move |p: DVec2| 8.0 + slope * p.x;
    let slab = format!(
        "max(max(abs(x) - 12, abs(y) - 8), \
         max(8 + x*{slope} - z, z - 12 - x*{slope}))"
    );
    let inside = move |p: DVec2| {
        let inside = p.x.abs() < 11.0 && p.y.abs() < 7.0;
        inside.then(|| plane(p))
    };
    let ball = "sqrt(x^2 + y^2 + (z - 26)^2) - 20";
    // The cap counts up to a slope of 8°.
    let cap = |p: DVec2| {
        let r = p.length();
        (r < 2.8).then(|| 26.0 - (400.0 - r * r).sqrt())
    };
    let parts: [(&str, Under<'_>); 2] = [(&slab, &inside), (ball, &cap)];
    for (part, under) in parts {
        // A second foot keeps the part's middle where it is: at that of its
        // box.
        let part =
            format!("min({part}, min({foot}, {}))", foot.replace('+', "-"));
        let of = |shape: &str| {
            let shape = format!("support.interface_shape={shape}");
            let (gcode, _) = run(&part, &["supports=auto", &shape]);
            (airs(&gcode, under), parse(&gcode).len())
        };
        let ((flat, layers), (follow, same)) = (of("flat"), of("follow"));
        // What rises and falls is one layer to viewers.
        assert_eq!(layers, same);
        assert!(flat.len() > 80 && follow.len() > 80);
        // A flat interface is off by up to half a layer, one that follows is
        // not.
        let of = |airs: &[f64]| [0.5, 0.9].map(|q| quantile(airs, q));
        assert!(of(&flat)[1] > 0.05, "{:?}", of(&flat));
        assert!(of(&follow)[0] < 0.002, "{:?}", of(&follow));
        assert!(of(&follow)[1] < 0.003, "{:?}", of(&follow));
    }
}

#[test]
fn an_empty_layer_is_told_of_unless_it_is_the_first_with_a_pad_in_it() {
    let told = |text: &str, supports: &str| {
        let warnings = run(text, &[supports]).1.warnings;
        warnings.iter().any(|w| w.contains("nothing to print"))
    };
    let stands = "max(max(abs(x) - z/2, abs(y) - 5), z - 3)";
    assert!(told(stands, "supports=off"));
    assert!(!told(stands, "supports=auto"));
    // One of 90° is a fin in the first layer.
    let wide = "max(max(abs(x) - z, abs(y) - 5), z - 3)";
    assert!(!told(wide, "supports=off"));
    // A plate on a neck that is too thin to print, held by supports.
    let block = |half: f64, from: f64, to: f64| {
        let (middle, high) = (0.5 * (from + to), 0.5 * (to - from));
        format!("max(max(abs(x), abs(y)) - {half}, abs(z - {middle}) - {high})")
    };
    let [foot, neck] = [block(5.0, 0.0, 3.0), block(0.05, 2.9, 3.5)];
    let plate = block(9.0, 3.4, 5.0);
    let necked = format!("min(min({foot}, {neck}), {plate})");
    assert!(told(&necked, "supports=auto"));
}
