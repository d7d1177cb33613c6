//! Walls that hang over the layer below: their speed, fan and order, against
//! how far a leaning cylinder's walls reach by its formula.

use crate::common;
use crate::common::{
    INNER_WALL, Layer, Move, MoveKind, OUTER_WALL, formula, parse,
};
use glam::DVec2;

/// A cylinder that leans by 1.5 mm for each mm of its height: each layer of 0.2
/// mm reaches 0.3 mm farther than the one below.
const LEANING: &str = "max(sqrt((x - 1.5*z)^2 + y^2) - 8, abs(z - 2) - 2)";
const LEAN: f64 = 1.5;
/// How much farther each layer reaches, mm.
const SHIFT: f64 = 0.3;
const WIDTH: f64 = 0.45;
const OVERHANG: &str = "Overhang perimeter";

/// Walls only, at the speeds asked for.
const BARE: [&str; 12] = [
    "infill_density=0",
    "top_layers=0",
    "bottom_layers=0",
    "sample_spacing=0.225",
    "skirt.loops=0",
    "cooling.min_layer_time=0",
    "printer.max_moves_per_second=100000",
    "speed.outer_wall=40",
    "speed.inner_wall=60",
    "speed.first_layer=100",
    "gcode.progress=off",
    "cooling.fan_speed=20",
];

fn sliced(text: &str, more: &[&str]) -> String {
    let all: Vec<&str> = BARE.iter().chain(more).copied().collect();
    let settings = common::settings(&all);
    common::slice(&formula(text, &settings), &settings, 2).0
}

/// The layers that lie on another one.
fn upper(gcode: &str) -> Vec<Layer> {
    parse(gcode).split_off(1)
}

/// A move's middle, from the middle of its layer.
fn middle(m: &Move, layers: &[Layer], z: f64) -> DVec2 {
    // That of the layers above the first is at a height of 2.1 mm.
    let all = layers.iter().flat_map(|l| l.prints());
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for m in all.filter(|m| m.role != INNER_WALL) {
        low = low.min(m.to.x);
        high = high.max(m.to.x);
    }
    let axis = 0.5 * (low + high) + LEAN * (z - 0.1 - 2.1);
    let (a, b) = m.ends();
    0.5 * (a + b) - DVec2::new(axis, 110.0)
}

/// The share of a wall's width that reaches beyond the layer below, and whether
/// it is the outer wall; nothing of moves that are no walls.
fn reach(at: DVec2) -> (f64, bool) {
    let outer = at.length() > 7.6;
    let out = SHIFT * at.x / at.length();
    let depth = 8.0 - at.length();
    (((out - depth + 0.5 * WIDTH) / WIDTH).clamp(0.0, 1.0), outer)
}

/// The speed that steps of 50 % at 20 mm/s and 100 % at a quarter make.
fn meant(share: f64, own: f64) -> f64 {
    if share < 0.5 {
        own + share / 0.5 * (20.0 - own)
    } else {
        20.0 + (share - 0.5) / 0.5 * (0.25 * own - 20.0)
    }
}

#[test]
fn walls_are_slower_the_farther_they_reach() {
    let steps = "speed.overhang=50: 20, 100: 25%";
    let fan = "cooling.overhang_fan_speed=60: 80";
    let gcode = sliced(LEANING, &[steps, fan]);
    let layers = upper(&gcode);
    let (mut least, mut speeds) = (f64::INFINITY, Vec::new());
    for layer in &layers {
        // Between walls there are short ways.
        for m in layer.prints().filter(|m| m.role != "Gap fill") {
            assert!([OUTER_WALL, INNER_WALL, OVERHANG].contains(&m.role));
            let (share, outer) = reach(middle(m, &layers, layer.z));
            let own = if outer { 40.0 } else { 60.0 };
            let (is, should) = (m.feed / 60.0, meant(share, own));
            // The wall is cut where its speed has changed by 5 %. A move may be
            // 0.6 mm long, over which the reach changes by 3 % of the width.
            let slack = 0.05 * should + 2.0;
            assert!((is - should).abs() <= slack, "{is} {should} {share}");
            least = least.min(is);
            speeds.push((1000.0 * is).round() as i64);
        }
    }
    // The farthest wall reaches 67 % of its width.
    assert!((least - meant(0.667, 40.0)).abs() < 1.0, "{least}");
    // No threshold shows: many speeds, and no gap between them.
    speeds.sort_unstable();
    speeds.dedup();
    let walls: Vec<i64> = speeds.into_iter().filter(|s| *s <= 40_000).collect();
    assert!(walls.len() > 10, "{walls:?}");
    for pair in walls.windows(2) {
        assert!(pair[1] as f64 <= 1.13 * pair[0] as f64, "{pair:?}");
    }
    // The fan comes up to 80 %, by no more than some steps of 5 %.
    let fans: Vec<f64> = gcode
        .lines()
        .filter_map(|l| l.strip_prefix("M106 S"))
        .map(|s| s.parse::<f64>().unwrap() / 255.0)
        .collect();
    let most = fans.iter().copied().fold(0.0, f64::max);
    assert!((0.75..=0.81).contains(&most), "{most}");
    let between = fans.iter().filter(|f| (0.3..0.7).contains(*f)).count();
    assert!(between > layers.len(), "{between}");
}

#[test]
fn what_stands_upright_keeps_its_bytes() {
    let upright = "max(sqrt(x^2 + y^2) - 8, abs(z - 2) - 2)";
    let plain = sliced(upright, &[]);
    let body = |gcode: &str| {
        let from = gcode.find(";LAYER_CHANGE").unwrap();
        let to = gcode.find("; end of layers").unwrap();
        gcode[from..to].to_owned()
    };
    for own in [
        "speed.overhang=10: 5, 100: 1",
        "cooling.overhang_fan_speed=10: 100",
        "overhang_reverse=true",
    ] {
        assert!(body(&sliced(upright, &[own])) == body(&plain), "{own}");
    }
}

/// Twice the area that a layer's outer wall goes round, positive if
/// counter-clockwise.
fn turn(layer: &Layer) -> f64 {
    let shows = |m: &&Move| [OUTER_WALL, OVERHANG].contains(&m.role);
    let all = layer.prints().filter(shows).map(Move::ends);
    all.map(|(a, b)| (a - DVec2::splat(110.0)).perp_dot(b - a))
        .sum()
}

#[test]
fn walls_that_hang_are_turned_round_on_every_other_layer() {
    let turned = upper(&sliced(LEANING, &["walls=1", "overhang_reverse=true"]));
    for (i, layer) in turned.iter().enumerate() {
        // The first of these layers is layer 1.
        assert!(turn(layer) * if i % 2 == 0 { -1.0 } else { 1.0 } > 100.0);
    }
    let plain = upper(&sliced(LEANING, &["walls=1"]));
    assert!(plain.iter().all(|layer| turn(layer) > 100.0));
    // Turned walls begin where the others do, and end with a wipe inwards.
    for (a, b) in turned.iter().zip(&plain) {
        let wipe = |layer: &Layer| {
            let last =
                layer.moves.iter().rposition(|m| m.kind == MoveKind::Print);
            let end = layer.moves[last.unwrap()].to.truncate();
            let next = &layer.moves[last.unwrap() + 1];
            (end, next.to.truncate())
        };
        let ((end, to), (_, plain)) = (wipe(a), wipe(b));
        assert!((to - plain).length() < 0.02, "{to} {plain}");
        assert!((to - end).length() > 0.25);
    }
}

#[test]
fn walls_that_hang_begin_with_the_innermost() {
    let first = |more: &[&str]| -> Vec<bool> {
        let mut all = vec!["wall_order=outer-first"];
        all.extend(more);
        let inner = |l: &Layer| l.prints().next().unwrap().role == INNER_WALL;
        parse(&sliced(LEANING, &all)).iter().map(inner).collect()
    };
    assert!(first(&[]).iter().all(|inner| !inner));
    let hanging = first(&["wall_order=outer-first-unless-overhang"]);
    // The first layer lies on the bed.
    assert!(!hanging[0] && hanging[1..].iter().all(|inner| *inner));
    let held = [
        "wall_order=outer-first-unless-overhang",
        "overhang_share=70",
    ];
    assert!(first(&held).iter().all(|inner| !inner));
}

#[test]
fn what_lies_over_a_support_counts_half() {
    // A plate on a post, with a support under it that leaves no gap.
    let half = "(7.5 + 4.5*min(1, max(-1, 1000*(z - 3))))";
    let tee = format!("max(max(abs(x) - {half}, abs(y) - 6), abs(z - 2) - 2)");
    let speeds = |more: &[&str]| {
        let mut all = vec![
            "speed.overhang=50: 20, 100: 10",
            "overhang_share=100",
            "walls=1",
        ];
        all.extend(more);
        let layers = parse(&sliced(&tee, &all));
        let plate = layers.iter().find(|l| l.z > 3.1).unwrap();
        // The plate's far ends.
        let far = |m: &&Move| {
            let ((a, b), mid) = (m.ends(), 110.0);
            m.role == OUTER_WALL
                && (a.x - mid).abs() > 11.0
                && (b.x - mid).abs() > 11.0
                && (0.5 * (a.y + b.y) - mid).abs() < 5.0
        };
        let speeds = plate.prints().filter(far).map(|m| m.feed / 60.0);
        speeds.collect::<Vec<f64>>()
    };
    let alone = speeds(&[]);
    assert!(!alone.is_empty() && alone.iter().all(|s| (s - 10.0).abs() < 0.1));
    let held = speeds(&["supports=auto"]);
    let half = |s: &f64| (19.0..21.0).contains(s);
    assert!(!held.is_empty() && held.iter().all(half), "{held:?}");
}

/// A plate with a pocket for the head of a screw from below, and a bore for the
/// screw.
const COUNTERBORE: &str = "max(max(max(abs(x), abs(y)) - 12, abs(z - 4) - 4), \
    -min(sqrt(x^2 + y^2) - 1.7, max(sqrt(x^2 + y^2) - 4, z - 3)))";

#[test]
fn the_ceiling_of_a_pocket_is_laid_from_its_rim_to_the_bore() {
    const BRIDGE: &str = "Bridge infill";
    for order in ["outer-first", "inner-first"] {
        let settings = common::settings(&[&format!("wall_order={order}")]);
        let model = formula(COUNTERBORE, &settings);
        let gcode = common::slice(&model, &settings, 2).0;
        let layers = parse(&gcode);
        let above = |l: &&Layer| (l.z - 3.2).abs() < 1e-6;
        let ceiling = layers.iter().find(above).unwrap();
        // What hangs: its role, and how far its middle is from the bore's.
        let hangs: Vec<(&str, f64)> = ceiling
            .prints()
            .map(|m| {
                let (a, b) = m.ends();
                let out = 0.5 * (a + b) - DVec2::splat(110.0);
                (m.role, out.length())
            })
            .filter(|(_, out)| *out < 3.8)
            .collect();
        let walls = hangs.iter().position(|h| h.0 == OVERHANG).unwrap();
        let (skin, walls) = hangs.split_at(walls);
        let laid = |role: &'static str| move |h: &&(&str, f64)| h.0 == role;
        assert!(walls.iter().all(|h| h.0 != BRIDGE), "{order}: {hangs:?}");
        assert!(skin.iter().filter(laid(BRIDGE)).count() > 20, "{skin:?}");
        // Ring after ring, each nearer to the bore; then its walls, the outer one
        // last.
        for part in [
            skin.iter().filter(laid(BRIDGE)).collect::<Vec<_>>(),
            walls.iter().filter(laid(OVERHANG)).collect(),
        ] {
            for pair in part.windows(2) {
                assert!(pair[1].1 < pair[0].1 + 0.1, "{order}: {part:?}");
            }
        }
        let (_, last) = walls.last().unwrap();
        assert!((last - 1.925).abs() < 0.05, "{order}: {last}");
    }
}

/// What hangs around a stem is laid from the stem outwards, its walls last. What stands on
/// supports has its walls first.
#[test]
fn a_cap_is_laid_from_its_stem_outwards() {
    const BRIDGE: &str = "Bridge infill";
    const CAP: &str = "min(max(sqrt(x^2 + y^2) - 4, abs(z - 3) - 3), \
        max(sqrt(x^2 + y^2) - 9, abs(z - 7) - 1))";
    let hangs = |set: &[&str]| {
        let settings = common::settings(set);
        let gcode = common::slice(&formula(CAP, &settings), &settings, 2).0;
        let layers = parse(&gcode);
        let above = |l: &&Layer| (l.z - 6.2).abs() < 1e-6;
        let cap = layers.iter().find(above).unwrap();
        let moves = cap.prints().map(|m| {
            let (a, b) = m.ends();
            let out = 0.5 * (a + b) - DVec2::splat(110.0);
            (m.role, out.length())
        });
        moves.filter(|m| m.1 > 4.4).collect::<Vec<_>>()
    };
    let alone = hangs(&[]);
    let skin = alone.iter().filter(|m| m.0 == BRIDGE).count();
    assert!(skin > 100, "{alone:?}");
    for pair in alone[..skin].windows(2) {
        assert!(pair[1].1 > pair[0].1 - 0.15, "{pair:?}");
    }
    assert!(alone[skin..].iter().all(|m| m.0 != BRIDGE), "{alone:?}");
    assert!(alone[skin..].iter().any(|m| m.0 == OVERHANG), "{alone:?}");
    let held = hangs(&["supports=auto"]);
    assert!(held.iter().all(|m| m.0 != BRIDGE), "{held:?}");
    assert!(held[0].1 > 8.0, "{held:?}");
}

/// All corners of a square hang over an octagon, and none of its sides does.
#[test]
fn walls_that_are_held_between_their_corners_come_first() {
    const TOWER: &str = "min(max(max(max(abs(x), abs(y)) - 8, abs(x) + abs(y) - 13), \
        abs(z - 3) - 3), max(max(abs(x), abs(y)) - 8, abs(z - 8) - 2))";
    let settings = common::settings(&[]);
    let gcode = common::slice(&formula(TOWER, &settings), &settings, 2).0;
    let layers = parse(&gcode);
    let above = |l: &&Layer| (l.z - 6.2).abs() < 1e-6;
    let square = layers.iter().find(above).unwrap();
    let roles: Vec<&str> = square.prints().map(|m| m.role).collect();
    let is_wall = |role: &&str| role.contains("erimeter");
    let walls = roles.iter().rposition(is_wall).unwrap();
    let first = roles
        .iter()
        .position(|role| !is_wall(role) && *role != "Gap fill");
    assert!(first.unwrap() > walls, "{roles:?}");
}
