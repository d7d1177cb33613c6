//! Rafts in whole runs: the part stands on them as it stands on the bed.

use crate::common;
use crate::common::{
    Layer, OUTER_WALL, SKIRT, SUPPORT, SUPPORT_INTERFACE, formula, parse,
    settings, slice,
};
use glam::DVec2;
use isoslice::pipeline::{self, Options, SliceError, Summary};
use isoslice::settings::Builder;

/// Coarse settings, which are quick.
const COARSE: [&str; 3] =
    ["sample_spacing=0.225", "accuracy=0.02", "layer_height=0.2"];
/// A block of 20 mm with a hole, 6 mm high.
const BLOCK: &str =
    "max(max(max(abs(x), abs(y)) - 10, 3 - sqrt(x^2+y^2)), abs(z - 3) - 3)";
/// A stem with arms, which need supports.
const TEE: &str = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 5) - 5), \
                   max(max(abs(x) - 14, abs(y) - 6), abs(z - 9) - 1))";

fn run(text: &str, set: &[&str]) -> (Vec<Layer>, Summary, String) {
    let settings = settings(&[&COARSE, set].concat());
    let (gcode, summary) = slice(&formula(text, &settings), &settings, 2);
    (parse(&gcode), summary, gcode)
}

/// Roles printed in a layer, skirt aside.
fn roles(layer: &Layer) -> Vec<&'static str> {
    let mut all: Vec<_> = layer.prints().map(|m| m.role).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The corners of what a layer prints in a role.
fn bounds(layer: &Layer, role: &str) -> [DVec2; 2] {
    let of_role = layer.moves.iter().filter(|m| m.role == role);
    let prints = of_role.filter(|m| m.kind == common::MoveKind::Print);
    let ends: Vec<DVec2> = prints.map(|m| m.ends().1).collect();
    let least = ends.iter().copied().reduce(DVec2::min).unwrap();
    [least, ends.iter().copied().reduce(DVec2::max).unwrap()]
}

#[test]
fn the_part_stands_on_its_raft_with_the_gap_between() {
    let (plain, _, _) = run(BLOCK, &[]);
    let set = ["raft.layers=3", "raft.gap=0.15", "raft.expansion=4"];
    let (layers, summary, gcode) = run(BLOCK, &set);
    assert_eq!(summary.warnings, Vec::<String>::new());
    assert_eq!(summary.raft_layers, 3);
    assert_eq!(summary.layer_count, 3 + plain.len());
    // 75 % of the nozzle, then two layers, the air, and the part.
    let z: Vec<f64> = layers.iter().map(|l| l.z).collect();
    assert_eq!(z[..5], [0.3, 0.5, 0.7, 1.05, 1.25]);
    assert_eq!(layers[3].height, 0.2);
    assert!(gcode.contains("; max_layer_z = 6.85\n"));
    assert_eq!(roles(&layers[0]), [SUPPORT]);
    assert_eq!(roles(&layers[1]), [SUPPORT_INTERFACE]);
    assert_eq!(roles(&layers[2]), [SUPPORT_INTERFACE]);
    let of_part = layers[3..].iter().flat_map(roles);
    let supports = [SUPPORT, SUPPORT_INTERFACE];
    assert!(of_part.into_iter().all(|role| !supports.contains(&role)));
    // The raft reaches 4 mm beyond the part, less half a line.
    for (layer, half) in [(0, 0.3), (1, 0.225), (2, 0.225)] {
        let [least, most] = bounds(&layers[layer], roles(&layers[layer])[0]);
        let side = 10.0 + 4.0 - half;
        let off = (most - least - 2.0 * side).abs().max_element();
        assert!(off < 0.06, "{layer}: {} for {side}", most - least);
    }
    // The skirt goes round the raft.
    let [least, most] = bounds(&layers[0], SKIRT);
    assert!((most - least).min_element() > 2.0 * (14.0 + 6.0));
    // Solid layers are solid, the first one is not.
    let volume = |layer: &Layer| {
        let area = common::filament_area(1.75);
        layer.prints().map(|m| m.fed).sum::<f64>() * area / layer.height
    };
    let raft = 28.0 * 28.0;
    for layer in &layers[1..3] {
        assert!((volume(layer) / raft - 1.0).abs() < 0.03);
    }
    let share = volume(&layers[0]) / raft;
    assert!((0.45..0.62).contains(&share), "{share}");
}

#[test]
fn a_raft_does_not_change_the_part() {
    // An even number of raft layers leaves the directions of lines.
    let raft = ["raft.layers=2", "gcode.progress=off"];
    let (on_raft, ..) = run(BLOCK, &raft);
    let (plain, ..) = run(BLOCK, &raft[1..]);
    let walls = |layer: &Layer| {
        let length = layer.length(OUTER_WALL);
        let [least, most] = bounds(layer, OUTER_WALL);
        (length, least, most)
    };
    for (k, layer) in plain.iter().enumerate() {
        let other = &on_raft[2 + k];
        let (a, b) = (walls(layer), walls(other));
        assert!((a.0 - b.0).abs() < 0.5, "layer {k}: {a:?} {b:?}");
        let moved = (a.1 - b.1).abs().max((a.2 - b.2).abs());
        assert!(moved.max_element() < 2e-3, "layer {k}");
        assert!((layer.fed() / other.fed() - 1.0).abs() < 0.03, "layer {k}");
    }
    // The part's underside is printed as a bridge.
    assert!(roles(&on_raft[2]).contains(&"Bridge infill"));
    assert!(!roles(&plain[0]).contains(&"Bridge infill"));
}

#[test]
fn supports_stand_on_the_raft() {
    let set = ["raft.layers=3", "supports=auto"];
    let (layers, summary, _) = run(TEE, &set);
    assert_eq!(summary.warnings, Vec::<String>::new());
    let (plain, of_plain, _) = run(TEE, &set[1..]);
    assert_eq!(layers.len(), plain.len() + 3);
    // The posts are those without a raft, and the raft lies beneath all of
    // them.
    for k in [5, 20, 38] {
        let [a, b] = [&plain[k], &layers[k + 3]].map(|l| l.length(SUPPORT));
        assert!((a - b).abs() < 0.02 * a + 0.1, "layer {k}: {a} {b}");
    }
    let [low, high] = bounds(&layers[2], SUPPORT_INTERFACE);
    let [from, to] = bounds(&layers[4], SUPPORT);
    assert!(low.cmplt(from - 2.5).all() && high.cmpgt(to + 2.5).all());
    assert!(summary.support_length > of_plain.support_length);
    // The posts reach down to the raft, so they are higher by as much as the
    // air is.
    let per_length = |layer: &Layer| {
        let of = layer.prints().filter(|m| m.role == SUPPORT);
        let (fed, length) =
            of.fold((0.0, 0.0), |(f, l), m| (f + m.fed, l + m.length()));
        fed / length
    };
    let more = per_length(&layers[3]) / per_length(&layers[4]);
    assert!((1.6..2.05).contains(&more), "{more}");
}

#[test]
fn the_bottom_of_a_part_on_a_raft_is_skin() {
    let set = ["raft.layers=3", "skin_where=ends", "bottom_layers=2"];
    let (layers, ..) = run(BLOCK, &set);
    let sparse: Vec<bool> = layers[3..9]
        .iter()
        .map(|l| roles(l).contains(&"Internal infill"))
        .collect();
    assert_eq!(sparse, [false, false, true, true, true, true]);
}

#[test]
fn a_part_on_its_tip_has_a_raft() {
    let cone = "max(sqrt(x^2 + y^2) - 0.3*z, z - 10)";
    let (layers, ..) = run(cone, &["raft.layers=3"]);
    for (layer, role) in
        layers
            .iter()
            .zip([SUPPORT, SUPPORT_INTERFACE, SUPPORT_INTERFACE])
    {
        assert!(roles(layer).contains(&role), "{:?}", roles(layer));
        // The raft reaches about 3 mm beyond the tip on all sides.
        let [least, most] = bounds(layer, role);
        let size = most - least;
        assert!(size.cmpgt(DVec2::splat(5.0)).all(), "{size}");
        assert!(size.cmplt(DVec2::splat(8.0)).all(), "{size}");
    }
}

#[test]
fn scarfs_rise_from_the_layer_below_and_not_from_a_rafts_air() {
    let set = [
        "raft.layers=3",
        "seam_scarf=10 mm from 10%",
        "gcode.progress=off",
    ];
    let (layers, ..) = run(BLOCK, &set);
    // Heights at which a layer's outer walls are printed.
    let level = |layer: &Layer| {
        let walls = layer.prints().filter(|m| m.role == OUTER_WALL);
        walls.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), m| {
            let z = [m.from.z, m.to.z];
            (a.min(z[0]).min(z[1]), b.max(z[0]).max(z[1]))
        })
    };
    let (low, high) = level(&layers[3]);
    assert_eq!(low, high);
    let (low, high) = level(&layers[4]);
    assert!(high - low > 0.05, "{low} {high}");
}

#[test]
fn adaptive_layers_begin_on_the_raft() {
    let dome = "max(sqrt(x^2 + y^2 + z^2) - 10, -z)";
    let set = ["layer_heights=adaptive", "raft.layers=2"];
    let (layers, summary, _) = run(dome, &set);
    assert_eq!(summary.raft_layers, 2);
    let last = layers.last().unwrap();
    // 0.3 + 0.2 mm of raft, 0.2 mm of air, and 10 mm.
    assert!((last.z - 10.7).abs() < 1e-9, "{}", last.z);
    let (plain, ..) = run(dome, &set[..1]);
    assert_eq!(layers.len(), plain.len() + 2);
    for (a, b) in plain.iter().zip(&layers[2..]) {
        assert!((a.z + 0.7 - b.z).abs() < 2.1e-3, "{} {}", a.z, b.z);
    }
}

#[test]
fn what_does_not_go_with_a_raft_is_refused_or_told_of() {
    let built = |set: &[&str]| {
        let mut builder = Builder::new();
        set.iter().for_each(|s| builder.set(s).unwrap());
        builder.finish()
    };
    for (other, word) in [
        ("brim.place=outer", "no brim"),
        ("spiral=true", "climbing wall"),
    ] {
        let text = built(&["raft.layers=2", other]).unwrap_err().to_string();
        assert!(text.contains(word), "{text}");
    }
    for (set, most) in [
        (["layer_height=0.2", "raft.gap=0.3"], "at most 0.2 mm fit"),
        (["layer_height=0.28", "raft.gap=0.2"], "at most 0.12 mm fit"),
        (["infill_width=0.3", "raft.gap=0.1"], "at most 0.07 mm fit"),
    ] {
        let all = [&["raft.layers=3"], &set[..]].concat();
        let text = built(&all).unwrap_err().to_string();
        assert!(text.contains(most), "{text}");
    }
    for (set, word) in [
        (
            ["raft.layers=1", "walls=2"],
            "raft.layers = 1 has sparse lines",
        ),
        (["raft.layers=0", "raft.gap=0.3"], "raft.gap has no effect"),
        (
            ["raft.layers=3", "layer_height=0.38"],
            "only 0.02 mm below the part",
        ),
        (
            ["raft.layers=3", "elephant_foot=0.2"],
            "elephant_foot has no",
        ),
    ] {
        let told = built(&set).unwrap().1.join("\n");
        assert!(told.contains(word), "{told}");
    }
    let tall = ["raft.layers=3", "printer.height=6.5"];
    let settings = settings(&[&COARSE[..], &tall[..]].concat());
    let model = formula(BLOCK, &settings);
    let options = Options::default();
    let out = &mut std::io::sink();
    let failed = pipeline::slice(&model, &settings, &options, out);
    let Err(error @ SliceError::RaftTooHigh { .. }) = failed else {
        panic!("{failed:?}");
    };
    assert!(error.to_string().contains("0.400 mm too high"), "{error}");
}
