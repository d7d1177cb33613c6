//! Interlocked walls: their heights and volumes, read from the G-code.

use crate::common;
use crate::common::{Layer, Move, parse, slice, slice_layers};
use glam::DVec2;

const HEIGHT: f64 = 0.2;
/// Radius of the upright cylinder, mm.
const RADIUS: f64 = 10.0;

/// Four walls and nothing else.
const BASE: [&str; 10] = [
    "walls=4",
    // With gaps at seams no wall goes on in the outer one, which lowered walls
    // cannot do either.
    "seam_gap=0.01",
    "infill_density=0",
    "top_layers=0",
    "bottom_layers=0",
    "first_layer_height=0.2",
    "sample_spacing=0.225",
    "skirt.loops=0",
    "gcode.relative_e=true",
    "gcode.progress=off",
];

fn asked<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&BASE[..], more].concat()
}

fn sliced(text: &str, more: &[&str]) -> Vec<Layer> {
    let (model, settings) = common::part(text, &asked(more));
    let (gcode, _) = slice(&model, &settings, 2);
    let rules = isoslice::check::Rules::new(&settings);
    let verdict = isoslice::check::check(gcode.as_bytes(), &rules).unwrap();
    // Without skin the upper half of a step begins in the air.
    assert!(verdict.is_safe(), "{:?}", verdict.counts);
    parse(&gcode)
}

/// The number of the wall that a move is on, round the upright cylinder, in a
/// layer of this height.
fn wall(m: &Move, height: f64) -> usize {
    let r = m.to.truncate().distance(DVec2::splat(110.0));
    let spacing = 0.45 - height * (1.0 - std::f64::consts::FRAC_PI_4);
    let wall = (RADIUS - 0.225 - r) / spacing;
    assert!((wall - wall.round()).abs() < 0.1, "{wall}");
    wall.round() as usize
}

fn fed(layers: &[Layer]) -> f64 {
    layers.iter().map(Layer::fed).sum()
}

const UPRIGHT: &str = "max(sqrt(x^2 + y^2) - 10, abs(z - 1) - 1)";

#[test]
fn every_other_inner_wall_is_half_a_layer_lower() {
    let plain = sliced(UPRIGHT, &[]);
    let layers = sliced(UPRIGHT, &["walls_interlocked=true"]);
    assert_eq!(layers.len(), 10);
    for (i, layer) in layers.iter().enumerate() {
        let mut of_wall = [0.0; 4];
        let mut above = false;
        for m in layer.prints() {
            let k = wall(m, HEIGHT);
            let low = k % 2 == 1 && i + 1 < layers.len();
            let z = layer.z - if low { 0.5 * HEIGHT } else { 0.0 };
            assert!((m.from.z - z).abs() < 1e-6, "{i} {k}: {}", m.from.z);
            assert!((m.to.z - z).abs() < 1e-6);
            // The nozzle never goes low beside what is higher.
            assert!(!(low && above));
            above |= k.is_multiple_of(2);
            of_wall[k] += m.fed;
        }
        let mut meant = [0.0; 4];
        for m in plain[i].prints() {
            meant[wall(m, HEIGHT)] += m.fed;
        }
        for k in 0..4 {
            let share = match (k % 2, i) {
                (0, _) => 1.0,
                (_, 0) => 0.5,
                (_, 9) => 1.5,
                _ => 1.0,
            };
            let is = of_wall[k] / meant[k];
            assert!((is - share).abs() < 0.003, "{i} {k}: {is}");
        }
    }
    assert!((fed(&layers) / fed(&plain) - 1.0).abs() < 0.001);
}

#[test]
fn walls_fill_the_height_whatever_the_layers_heights() {
    // Thicker and thinner from layer to layer, each wall's beads lie on one
    // another without a gap, from the bed to the part's top.
    for heights in ["0.1 + 0.08*z", "0.25 - 0.07*z", "0.17 + 0.08*sin(5*z)"] {
        let heights = format!("layer_heights=expr: {heights}");
        let more = [heights.as_str(), "layer_height_max=0.26"];
        let plain = sliced(UPRIGHT, &more);
        let more = [&more[..], &["walls_interlocked=true"]].concat();
        let layers = sliced(UPRIGHT, &more);
        assert_eq!(layers.len(), plain.len());
        let mut ends = [0.0; 4];
        let mut bottom = 0.0;
        for (i, (layer, plain)) in layers.iter().zip(&plain).enumerate() {
            let fed = |layer: &Layer| {
                let mut of_wall = [0.0; 4];
                for m in layer.prints() {
                    of_wall[wall(m, layer.z - bottom)] += m.fed;
                }
                of_wall
            };
            let (is, meant) = (fed(layer), fed(plain));
            let own = layer.z - bottom;
            for k in 0..4 {
                let low = k % 2 == 1 && i + 1 < layers.len();
                let top = layer.z - if low { 0.5 * own } else { 0.0 };
                let on_wall = |m: &&Move| wall(m, own) == k;
                for m in layer.prints().filter(on_wall) {
                    assert!((m.to.z - top).abs() < 6e-4, "{i} {k} {m:?}");
                }
                let height = own * is[k] / meant[k];
                let gap = top - height - ends[k];
                assert!(gap.abs() < 1e-3, "{i} {k}: {gap}");
                ends[k] = top;
            }
            bottom = layer.z;
        }
        assert!(ends.iter().all(|end| (end - 2.0).abs() < 1e-6));
    }
}

#[test]
fn ledges_slopes_and_thin_places_keep_their_volume() {
    for (text, most) in [
        // A step, a cone that leans by up to 0.1 mm a layer and one by more.
        (
            "max(sqrt(x^2 + y^2) - (10 - 2.5*(1 + min(1, max(-1, \
             999*(z-1))))), abs(z - 1) - 1)",
            0.005,
        ),
        ("max(sqrt(x^2 + y^2) - 8 - 0.4*z, abs(z - 1) - 1)", 0.005),
        ("max(sqrt(x^2 + y^2) - 8 - 1.2*z, abs(z - 1) - 1)", 0.005),
        // A wedge: from nothing to eight walls.
        (
            "max(max(abs(y) - 0.1*(x + 20), abs(x) - 20), abs(z - 1) - 1)",
            0.005,
        ),
        // Half a layer lower, walls are as long as half a layer higher. What
        // becomes so much smaller in a few layers has a little less.
        ("max(sqrt(x^2 + y^2 + z^2) - 6, -z)", 0.011),
    ] {
        // Layers of one and a half heights have to suit the nozzle.
        let adaptive = ["layer_heights=adaptive", "layer_height_max=0.26"];
        for more in [&["layer_heights=uniform"][..], &adaptive] {
            let plain = fed(&sliced(text, more));
            let more: Vec<&str> = more
                .iter()
                .copied()
                .chain(["walls_interlocked=true"])
                .collect();
            let share = fed(&sliced(text, &more)) / plain;
            assert!((share - 1.0).abs() < most, "{share} {text} {more:?}");
        }
    }
}

#[test]
fn ranges_of_layers_have_the_same_bytes() {
    let more = ["walls_interlocked=true", "retract.z_hop=0.3"];
    let text = "max(sqrt(x^2 + y^2) - 8 - 0.3*z + 0.02*z^2, abs(z - 14) - 14)";
    let (model, settings) = common::part(text, &asked(&more));
    let body = |range: &str, threads: usize| {
        let (gcode, _) = slice_layers(&model, &settings, range, threads);
        let from = gcode.find(";LAYER_CHANGE\n").unwrap();
        let to = gcode.find("; end of layers\n").unwrap();
        gcode[from..to].to_owned()
    };
    let parts = body("..60", 1) + &body("61..130", 2) + &body("131..", 3);
    assert!(body("..", 2) == parts);
}
