//! What stands beside a part, in whole runs: brim ears and the draft shield.

use crate::common::{
    Layer, Move, MoveKind, SKIRT, formula, parse, settings, slice_layers,
};
use glam::DVec2;
use isoslice::pipeline::Summary;

/// Coarse settings, which are quick.
const COARSE: [&str; 4] = [
    "sample_spacing=0.225",
    "accuracy=0.02",
    "layer_height=0.2",
    "gcode.progress=off",
];
/// A stem with arms, whose shadow is 28 by 12 mm.
const TEE: &str = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 2.5) - 2.5), \
                   max(max(abs(x) - 14, abs(y) - 6), abs(z - 5.6) - 1))";

fn run(
    text: &str,
    set: &[&str],
    layers: &str,
) -> (Vec<Layer>, Summary, String) {
    let settings = settings(&[&COARSE, set].concat());
    let model = formula(text, &settings);
    let (gcode, summary) = slice_layers(&model, &settings, layers, 2);
    (parse(&gcode), summary, gcode)
}

fn skirt(layer: &Layer) -> Vec<&Move> {
    let moves = layer.moves.iter();
    moves
        .filter(|m| m.role == SKIRT && m.kind == MoveKind::Print)
        .collect()
}

/// The skirt's extent from the middle of the bed.
fn extent(layer: &Layer) -> Option<DVec2> {
    let ends = skirt(layer).into_iter().map(|m| m.ends().1);
    let away = ends.map(|p| (p - DVec2::splat(110.0)).abs());
    away.reduce(DVec2::max)
}

#[test]
fn a_shield_stands_around_the_whole_part_in_every_layer() {
    for (set, count) in [("full", 33), ("3", 15), ("3.1", 15), ("99", 33)] {
        let shield = format!("draft_shield={set}");
        let all = ["skirt.distance=4", &shield];
        let (layers, summary, _) = run(TEE, &all, "..");
        assert_eq!(summary.warnings.len(), 1, "{:?}", summary.warnings);
        assert!(summary.warnings[0].contains("undersides"));
        assert_eq!(layers.len(), 33);
        for (k, layer) in layers.iter().enumerate() {
            let Some(extent) = extent(layer) else {
                assert!(k >= count, "{set}: none in layer {k}");
                continue;
            };
            assert!(k < count, "{set}: one in layer {k}");
            // The arms' shadow, the gap and half a line, in a stem's layer.
            let exact = DVec2::new(14.0, 6.0) + 4.0 + 0.225;
            // The shadow is known to 0.01 of the part's size.
            let off = extent - exact;
            assert!(off.min_element() > -0.02, "{set}, {k}: {extent}");
            assert!(off.max_element() < 0.3, "{set}, {k}: {extent}");
            // One line: about its ring's length.
            let length: f64 = skirt(layer).iter().map(|m| m.length()).sum();
            assert!((85.0..115.0).contains(&length), "{length}");
        }
    }
}

#[test]
fn a_shield_is_outside_of_supports_and_rafts_and_of_any_range() {
    let set = ["draft_shield=full", "supports=auto", "raft.layers=2"];
    let (layers, summary, whole) = run(TEE, &set, "..");
    assert_eq!(summary.warnings, Vec::<String>::new());
    let of: Vec<DVec2> = layers.iter().filter_map(extent).collect();
    assert_eq!(of.len(), 35);
    assert!(of.iter().all(|e| e.distance(of[0]) < 2e-3));
    // The raft reaches 3 mm farther than the supports, or the part.
    assert!(of[0].x > 14.0 + 3.0 + 10.0, "{}", of[0]);
    let (_, _, part) = run(TEE, &set, "20..22");
    let body = |text: &str| {
        let from = text.find(";LAYER_CHANGE\n").unwrap();
        let to = text.find("; end of layers\n").unwrap();
        text[from..to].to_owned()
    };
    let part = body(&part);
    let lines: Vec<&str> = part.lines().take(3).collect();
    let from = whole.find(&lines.join("\n")).unwrap();
    let shield = |text: &str| {
        let from = text.find(";TYPE:Skirt/Brim").unwrap();
        let rest = &text[from..];
        rest[..rest[1..].find(";TYPE:").unwrap()].to_owned()
    };
    assert_eq!(shield(&part), shield(&whole[from..]));
}

#[test]
fn ears_are_at_the_corners_of_the_first_layer() {
    let block = "max(max(abs(x) - 20, abs(y) - 10), abs(z - 2) - 2)";
    let set = ["brim.place=ears", "brim.width=4", "skirt.loops=0"];
    let (layers, summary, _) = run(block, &set, "..");
    assert_eq!(summary.warnings, Vec::<String>::new());
    let ears = skirt(&layers[0]);
    assert!(ears.len() > 100);
    assert!(layers[1..].iter().all(|layer| skirt(layer).is_empty()));
    for step in ears {
        let p = (step.ends().1 - DVec2::splat(110.0)).abs();
        let corner = DVec2::new(20.0, 10.0);
        assert!(p.distance(corner) < 4.0, "{p}");
        // The gap of 0.1 mm and half a line, round at the corner.
        let away = (p - corner).max(DVec2::ZERO).length();
        assert!(away > 0.3, "{p}");
    }
    // A round part has no corners.
    let disc = "max(sqrt(x^2 + y^2) - 12, abs(z - 1) - 1)";
    let (_, summary, _) = run(disc, &set, "..");
    let told = summary.warnings.join("\n");
    assert!(told.contains("there are no brim ears"), "{told}");
}

#[test]
fn what_cannot_stand_beside_a_vase_is_refused_and_a_low_shield_told_of() {
    let built = |set: &[&str]| {
        let mut builder = isoslice::settings::Builder::new();
        set.iter().for_each(|s| builder.set(s).unwrap());
        builder.finish()
    };
    for (other, remedy) in [
        ("draft_shield=full", "set draft_shield = \"off\""),
        ("skirt.layers=4", "set skirt.layers to 3 or less"),
    ] {
        let failed = built(&["spiral=true", other]).unwrap_err().to_string();
        assert!(failed.contains(remedy), "{failed}");
        assert!(built(&[other]).is_ok());
    }
    assert!(built(&["spiral=true", "skirt.layers=3"]).is_ok());
    assert!(built(&["spiral=true", "bottom_layers=0"]).is_ok());
    let told = |set: &str| built(&[set]).unwrap().1.join("\n");
    let low = told("draft_shield=0.1");
    assert!(low.contains("draft_shield = 0.1 mm has no effect"), "{low}");
    assert_eq!(told("draft_shield=0.2"), "");
}
