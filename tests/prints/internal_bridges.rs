//! Internal bridges: what they end on, and how far they reach.

use crate::common;
use crate::common::head::Head;
use glam::{DVec2, DVec3, IVec2};
use std::collections::HashMap;
use std::f64::consts::PI;

/// A move that extrudes, with its role.
struct Step {
    role: String,
    from: DVec2,
    to: DVec2,
    /// Filament, mm.
    fed: f64,
    /// Speed, mm/min.
    speed: f64,
    /// Speed of the fan, 0 to 255.
    fan: f64,
    /// Height of the layer, mm.
    height: f64,
    /// True if no other move lies between it and the one before.
    goes_on: bool,
}

impl Step {
    /// True for a way from line to line: as wide as high, it fills less of the layer
    /// than any line.
    fn is_way(&self) -> bool {
        let filament = 0.25 * PI * 1.75_f64.powi(2);
        let area = self.fed * filament / self.from.distance(self.to);
        area / self.height < 0.25
    }
}

const BASE: [&str; 4] = [
    "gcode.comments=orca",
    "gcode.relative_e=true",
    "gcode.progress=off",
    "skirt.loops=0",
];

fn asked<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&BASE[..], more].concat()
}

/// The moves of each layer of a part.
fn layers(formula: &str, more: &[&str]) -> Vec<Vec<Step>> {
    let (model, settings) = common::part(formula, &asked(more));
    let (gcode, _) = common::slice(&model, &settings, 2);
    let end = gcode.find("; end of layers").unwrap();
    let mut head = Head::new(DVec3::new(110.0, 110.0, 0.0));
    let (mut role, mut layers) = ("", Vec::new());
    let (mut goes_on, mut fan, mut height) = (false, 0.0, 0.0);
    for line in gcode[..end].lines() {
        if line.starts_with(";LAYER_CHANGE") {
            layers.push(Vec::new());
        }
        if let Some(name) = line.strip_prefix(";TYPE:") {
            role = name;
        }
        if let Some(value) = line.strip_prefix(";HEIGHT:") {
            height = value.parse().unwrap();
        }
        if let Some(value) = line.strip_prefix("M106 S") {
            fan = value.parse().unwrap();
        }
        let Some(step) = head.step(line) else {
            continue;
        };
        let prints = step.prints();
        if let Some(layer) = layers.last_mut().filter(|_| prints) {
            layer.push(Step {
                role: role.to_owned(),
                from: step.from.truncate(),
                to: step.to.truncate(),
                fed: step.fed,
                speed: step.speed,
                fan,
                height,
                goes_on,
            });
        }
        goes_on = prints;
    }
    layers
}

const BRIDGE: &str = "Internal Bridge";
const INFILL: &str = "Sparse infill";
const GAP: &str = "Gap infill";
/// The names of all walls end with this.
const WALL: &str = " wall";

/// Distance of a point from a move.
fn distance(p: DVec2, step: &Step) -> f64 {
    let way = step.to - step.from;
    let t = (p - step.from).dot(way) / way.length_squared();
    p.distance(step.from + t.clamp(0.0, 1.0) * way)
}

/// Moves by the cells of 1 mm that they run through.
#[derive(Default)]
struct Cells<'a> {
    cells: HashMap<IVec2, Vec<&'a Step>>,
}

impl<'a> Cells<'a> {
    fn new(steps: impl Iterator<Item = &'a Step>) -> Cells<'a> {
        let mut all = Cells::default();
        for step in steps {
            let count = (step.from.distance(step.to) / 0.2).ceil().max(1.0);
            for k in 0..=count as usize {
                let p = step.from.lerp(step.to, k as f64 / count);
                let cell = all.cells.entry(p.floor().as_ivec2()).or_default();
                if !cell.last().is_some_and(|last| std::ptr::eq(*last, step)) {
                    cell.push(step);
                }
            }
        }
        all
    }

    /// True if a move is nearer to a point than `reach`, which is less than
    /// 0.9 mm.
    fn near(&self, p: DVec2, reach: f64) -> bool {
        let cell = p.floor().as_ivec2();
        let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y)));
        let cells =
            around.filter_map(|d| self.cells.get(&(cell + IVec2::from(d))));
        cells.flatten().any(|step| distance(p, step) < reach)
    }
}

/// The longest way over nothing, and how many ends nothing holds.
fn judged(layers: &[Vec<Step>]) -> (f64, usize, usize) {
    /// Half of a line's width, and what coordinates are rounded and lines are
    /// thinned by.
    const HALF: f64 = 0.225 + 0.03;
    let (mut longest, mut free, mut lines) = (0.0_f64, 0, 0);
    for pair in layers.windows(2) {
        let (below, own) = (&pair[0], &pair[1]);
        let bridges: Vec<&Step> =
            own.iter().filter(|s| s.role == BRIDGE).collect();
        if bridges.is_empty() {
            continue;
        }
        let is_infill = |s: &&Step| s.role == INFILL;
        let infill = Cells::new(below.iter().filter(is_infill));
        // What is solid holds a line beside it as well as one on it.
        let solid = Cells::new(below.iter().filter(|s| !is_infill(s)));
        // Where walls go on in one another, a way lies instead of their ends.
        let walls = own
            .iter()
            .filter(|s| s.role.ends_with(WALL) || s.role == GAP && s.is_way());
        let walls = Cells::new(walls);
        let held = |p: DVec2| {
            infill.near(p, HALF)
                || solid.near(p, HALF + 0.1)
                || walls.near(p, 2.0 * HALF)
        };
        // Lines go on in one another by ways, which may end what they begin.
        let begins = |i: usize| {
            let before = i.checked_sub(1).map(|i| bridges[i]);
            let step = bridges.get(i);
            step.zip(before).is_none_or(|(step, before)| {
                !step.goes_on || step.is_way() || before.is_way()
            })
        };
        let mut run = 0.0;
        for (i, step) in bridges.iter().enumerate() {
            let (first, last) = (begins(i), begins(i + 1));
            free += usize::from(first && !held(step.from));
            free += usize::from(last && !held(step.to));
            lines += usize::from(first && !step.is_way());
            if first {
                run = 0.0;
            }
            let length = step.from.distance(step.to);
            let count = (length / 0.05).ceil();
            for k in 0..count as usize {
                let p = step.from.lerp(step.to, k as f64 / count);
                run = if held(p) { 0.0 } else { run + length / count };
                longest = longest.max(run);
            }
        }
    }
    (longest, free, lines)
}

/// A box with a flat top.
const BOX: &str = "max(max(abs(x) - 12, abs(y) - 9), max(-z, z - 4))";
/// A cap of a ball on a short cylinder: its skin ends over infill.
const DOME: &str =
    "max(max(sqrt(x^2 + y^2) - 16, -z), sqrt(x^2 + y^2 + (z + 30)^2) - 37)";

#[test]
fn a_top_has_one_layer_across_the_infill() {
    let more = &["infill_density=15"];
    let layers = layers(BOX, more);
    let count = |l: &Vec<Step>| l.iter().filter(|s| s.role == BRIDGE).count();
    let with: Vec<usize> = (0..layers.len())
        .filter(|&i| count(&layers[i]) > 0)
        .collect();
    // Four solid layers of 20.
    assert_eq!(with, [16]);
    let (longest, free, lines) = judged(&layers);
    assert!(lines > 60 && free == 0, "{lines} {free}");
    // Lines of infill are 0.45/0.15 mm apart, less what they and what lies on
    // them is wide.
    assert!(longest < 0.45 / 0.15 - 0.45, "{longest}");
    // Bridges run across the lines of the layer below, and fill their plane.
    let along = |role: &str, layer: &[Step]| {
        let all = layer.iter().filter(|s| s.role == role);
        let longest = all.max_by(|a, b| {
            let length = |s: &Step| s.from.distance(s.to);
            length(a).total_cmp(&length(b))
        });
        let longest = longest.unwrap();
        (longest.to - longest.from).normalize()
    };
    let (own, below) = (along(BRIDGE, &layers[16]), along(INFILL, &layers[15]));
    assert!(own.dot(below).abs() < 0.01, "{own} {below}");
    // What is inside the walls: less two walls of 0.407 mm on each side.
    let inside = (24.0 - 4.0 * 0.407) * (18.0 - 4.0 * 0.407);
    let laid: f64 = layers[16]
        .iter()
        .filter(|s| s.role == BRIDGE && !s.is_way())
        .map(|s| s.from.distance(s.to) * 0.407)
        .sum();
    assert!((laid / inside - 1.0).abs() < 0.03, "{laid} {inside}");
}

#[test]
fn every_end_is_held_whatever_the_infill() {
    for infill in [
        "infill=rectilinear",
        "infill=grid",
        "infill=triangles",
        "infill=gyroid",
        "infill=cubic",
        "infill=hexagons",
        "infill_density=expr: 10 + 20*exp(-d/4)",
    ] {
        for part in [BOX, DOME] {
            let layers = layers(part, &[infill]);
            let (longest, free, lines) = judged(&layers);
            assert!(lines > 20, "{infill} {lines}");
            assert_eq!(free, 0, "{infill} {part}: of {lines} lines");
            // Lines of triangles are 3·0.45/0.15 = 9 mm apart.
            assert!(longest < 9.0, "{infill} {part}: {longest}");
        }
    }
}

/// Parts whose skin lies over infill in many layers: a plate that leans, waves, a
/// cone, stairs, and a bar that twists.
const STEEP: [&str; 5] = [
    "max(sqrt(x^2 + y^2) - 13, abs(z - 5 - 0.2*x) - 3)",
    "max(max(abs(x) - 14, abs(y) - 9), max(-z, z - 5 - 1.5*sin(0.5*x)))",
    "max(sqrt(x^2 + y^2) - 14 + 2.5*max(z - 2, 0), -z)",
    "max(max(abs(x) - 15 + 3*floor((z + 1.6)/2), abs(y) - 9), max(-z, z - 7))",
    "max(max(abs(x*cos(0.2*z) + y*sin(0.2*z)) - 12, \
     abs(y*cos(0.2*z) - x*sin(0.2*z)) - 7), max(-z, z - 6))",
];

#[test]
fn every_end_is_held_whatever_the_part_and_the_density() {
    let mut all = 0;
    for (infill, density) in [
        ("gyroid", "expr: 5 + 25*exp(-(x^2 + y^2)/60)"),
        ("rectilinear", "expr: 10 + 6*sin(y/5)"),
        ("cubic", "expr: 7 + 20*exp(-d/2)"),
        ("grid", "expr: 10 + 6*sin(y/5)"),
        ("rectilinear", "6"),
        ("hexagons", "14"),
    ] {
        for part in STEEP {
            let layers = layers(
                part,
                &[
                    &format!("infill={infill}"),
                    &format!("infill_density={density}"),
                ],
            );
            let (longest, free, lines) = judged(&layers);
            let case = format!("{infill} {density} {part}");
            assert_eq!(free, 0, "{case}: of {lines} lines");
            // Lines of infill that are all 0.45/0.06 mm apart.
            if density == "6" {
                assert!(longest < 0.45 / 0.06, "{case}: {longest}");
            }
            all += lines;
        }
    }
    assert!(all > 5000, "{all}");
}

/// A ramp, whose skin lies over infill in each layer.
const RAMP: &str =
    "max(max(abs(x) - 36, abs(y) - 7), max(-z, z - 1 - 0.2*(x + 36)))";

#[test]
fn none_rests_on_infill_that_is_left_out() {
    let mut lines = 0;
    // Where the density varies, infill that stands on nothing is left out.
    for density in ["10 + 20*exp(-d/4)", "8 + 6*sin(0.9*x)*cos(0.8*y)"] {
        let more = &[
            // Layers of two blocks, each of which begins anew.
            "layer_height=0.1",
            "infill=gyroid",
            &format!("infill_density=expr: {density}"),
        ];
        let layers = layers(RAMP, more);
        assert!(layers.len() > 140);
        let (_, free, own) = judged(&layers);
        assert_eq!(free, 0, "{density}: of {own} lines");
        lines += own;
    }
    assert!(lines > 20, "{lines}");
}

/// The layers of the box that have bridges, and the direction of these.
fn directions(layers: &[Vec<Step>]) -> Vec<(usize, DVec2)> {
    let all = layers.iter().enumerate();
    all.filter_map(|(i, layer)| {
        let longest =
            layer.iter().filter(|s| s.role == BRIDGE).max_by(|a, b| {
                let length = |s: &Step| s.from.distance(s.to);
                length(a).total_cmp(&length(b))
            })?;
        Some((i, (longest.to - longest.from).normalize()))
    })
    .collect()
}

#[test]
fn over_sparse_infill_there_are_more_layers_each_across_the_other() {
    for (more, expected) in [
        (&["infill_density=8"][..], &[16, 17][..]),
        (&["infill_density=10"], &[16]),
        (&["infill_density=8", "internal_bridges=1"], &[16]),
        (&["infill_density=15", "internal_bridges=3"], &[16, 17, 18]),
        // A density of 8 % has lines as far apart as the first case.
        (&["infill_density=expr: 8"], &[16, 17]),
        (&["infill_density=expr: 15"], &[16]),
    ] {
        let layers = layers(BOX, more);
        let found = directions(&layers);
        let with: Vec<usize> = found.iter().map(|f| f.0).collect();
        assert_eq!(with, expected, "{more:?}");
        for pair in found.windows(2) {
            assert!(pair[0].1.dot(pair[1].1).abs() < 0.01, "{more:?}");
        }
        let (_, free, lines) = judged(&layers);
        assert!(lines > 60 * expected.len() && free == 0, "{lines} {free}");
        // Each layer of bridges fills its area.
        let laid = expected.iter().map(|&i| {
            let all = layers[i].iter().filter(|s| s.role == BRIDGE);
            all.map(|s| s.from.distance(s.to)).sum::<f64>()
        });
        let laid: Vec<f64> = laid.collect();
        for own in &laid {
            assert!((own / laid[0] - 1.0).abs() < 0.03, "{laid:?}");
        }
    }
    // Ends are held also where skin grows from layer to layer, and where infill
    // bends.
    for infill in ["infill=rectilinear", "infill=gyroid", "infill=cubic"] {
        let layers = layers(DOME, &[infill, "infill_density=8"]);
        let (_, free, lines) = judged(&layers);
        assert!(lines > 20, "{infill} {lines}");
        assert_eq!(free, 0, "{infill}: of {lines} lines");
    }
}

#[test]
fn they_have_speed_flow_and_fan_of_their_own() {
    let moves = |more: &[&str]| {
        let mut all = vec!["cooling.min_layer_time=0", "cooling.fan_speed=50"];
        all.extend(more);
        let mut layers = layers(BOX, &all);
        let mut bridge = layers.swap_remove(16);
        bridge.retain(|s| s.role == BRIDGE && s.from.distance(s.to) > 5.0);
        bridge
    };
    // The fan runs as it does for bridges.
    let usual = moves(&["cooling.bridge_fan_speed=60"]);
    let own = moves(&[
        "speed.internal_bridge=23",
        "internal_bridge_flow=110",
        "cooling.internal_bridge_fan_speed=80",
    ]);
    assert!(!own.is_empty() && own.len() == usual.len());
    for (a, b) in own.iter().zip(&usual) {
        assert_eq!((a.speed, a.fan), (23.0 * 60.0, 204.0));
        assert_eq!((b.speed, b.fan), (40.0 * 60.0, 153.0));
        assert!((a.fed / b.fed - 1.1).abs() < 1e-3);
    }
}

#[test]
fn there_are_none_in_solid_parts_nor_without_walls() {
    let off = ["internal_bridges=false"];
    let layers_of = |more: &[&str]| layers(BOX, more);
    let has =
        |all: &[Vec<Step>]| all.iter().flatten().any(|s| s.role == BRIDGE);
    assert!(!has(&layers_of(&off)));
    assert!(!has(&layers_of(&["infill_density=100"])));
    // At the outline nothing would hold their ends.
    assert!(!has(&layers_of(&["walls=0"])));
    assert!(has(&layers_of(&[])));
}

#[test]
fn bridges_over_gaps_keep_what_they_are_anchored_on() {
    // Blocks over a tunnel, over two, and over a closed hollow.
    for part in [
        "max(max(max(abs(x) - 12, abs(y) - 8), max(-z, z - 6)), \
         -max(abs(y) - 3, abs(z - 3) - 0.2))",
        "max(max(max(abs(x) - 14, abs(y) - 8), max(-z, z - 6)), \
         -max(abs(abs(x) - 6) - 2.5, abs(z - 2.9) - 0.7))",
        "max(max(max(abs(x) - 12, abs(y) - 12), max(-z, z - 8)), \
         -max(max(abs(x) - 5, abs(y) - 5), abs(z - 4) - 1.4))",
    ] {
        let laid = |more: &[&str]| {
            let all = layers(part, more);
            let all = all.iter().flatten().filter(|s| s.role == "Bridge");
            all.map(|s| s.from.distance(s.to)).sum::<f64>()
        };
        let (with, without) = (laid(&[]), laid(&["internal_bridges=false"]));
        assert!(without > 100.0, "{part}: {without}");
        assert!((with - without).abs() < 0.1, "{part}: {with} {without}");
    }
}
