//! What must hold for any print, checked on every example.
//!
//! The layers are thick and the lines wide, so that the whole suite runs in
//! a debug build; nothing checked here depends on that.

use crate::common;
use crate::common::edges::Edges;
use crate::common::filament_area;
use crate::common::{
    Example, INNER_WALL, Layer, Move, MoveKind, OUTER_WALL, SKIRT, example,
    examples, formula, number, parse, settings, slice,
};
use glam::{DVec2, DVec3};
use isocontour::Area;
use isoslice::layers::LayerSpan;
use isoslice::model::BuildVolume;
use isoslice::model::Model;
use isoslice::plate::Plate;
use std::sync::LazyLock;

const COARSE: &[&str] = &[
    "bridge_max=25",
    // The outlines to compare with are those of the field.
    "slit_closing=0",
    "layer_height=0.6",
    "first_layer_height=0.6",
    "printer.nozzle_diameter=0.8",
    "outer_wall_width=0.9",
    "inner_wall_width=0.9",
    "skin_width=0.9",
    "infill_width=0.9",
    "sample_spacing=0.2",
    // There have to be hops to check.
    "retract.z_hop=0.3",
];

/// Half a micrometre of rounding in x and in y, and of arithmetic.
const ROUNDING: f64 = 0.001;

/// An example's print, read back, beside the outlines it was made from.
struct Print {
    name: String,
    plate: Plate,
    spans: Vec<LayerSpan>,
    /// The outlines, on the bed.
    outlines: Vec<Area>,
    text: String,
    layers: Vec<Layer>,
}

static PRINTS: LazyLock<Vec<Print>> = LazyLock::new(|| {
    let examples = examples();
    assert!(examples.len() >= 8);
    examples.iter().map(Print::new).collect()
});

impl Print {
    fn new(example: &Example) -> Print {
        let (model, settings) = example.place(COARSE);
        let (text, summary) = slice(&model, &settings, 2);
        assert_eq!(summary.warnings, [""; 0], "{}", example.name);
        let (spans, outlines) = common::layers(&model, &settings);
        let by = model.offset.truncate();
        let outlines = outlines.into_iter().map(|o| moved(o.area, by));
        Print {
            name: example.name.clone(),
            outlines: outlines.collect(),
            layers: parse(&text),
            plate: Plate::of(&model, &settings),
            spans,
            text,
        }
    }

    /// The layers with their outlines.
    fn each_layer(&self) -> impl Iterator<Item = (&Layer, Edges)> + '_ {
        let outlines = self.outlines.iter().map(Edges::new);
        self.layers.iter().zip(outlines)
    }

    /// Where a move is, for messages.
    fn at(&self, m: &Move) -> String {
        format!("{}, line {}: {m:?}", self.name, m.line)
    }
}

fn moved(mut area: Area, by: DVec2) -> Area {
    area.rings.iter_mut().flatten().for_each(|p| *p += by);
    area
}

fn all_moves() -> impl Iterator<Item = (&'static Print, &'static Move)> {
    PRINTS.iter().flat_map(|print| {
        let layers = print.layers.iter();
        layers.flat_map(move |l| l.moves.iter().map(move |m| (print, m)))
    })
}

#[test]
fn every_planned_layer_is_written_at_its_height() {
    for print in PRINTS.iter() {
        assert_eq!(print.layers.len(), print.spans.len(), "{}", print.name);
        for (layer, span) in print.layers.iter().zip(&print.spans) {
            assert!((layer.z - span.top).abs() < ROUNDING, "{}", print.name);
            assert!((layer.height - span.height()).abs() < ROUNDING);
            for m in layer.prints() {
                assert_eq!(m.from.z, layer.z, "{}", print.at(m));
            }
        }
    }
}

#[test]
fn numbers_are_plain_decimals() {
    // The reader has refused what is not finite.
    for print in PRINTS.iter() {
        let code = print.text.lines().map(|l| l.split(';').next().unwrap());
        for line in code.filter(|l| l.starts_with("G1 ")) {
            for word in line.split_whitespace().skip(1) {
                let (whole, decimals) =
                    word[1..].split_once('.').unwrap_or((&word[1..], "0"));
                let digits = whole.strip_prefix('-').unwrap_or(whole);
                let plain = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
                assert!(plain(digits) && plain(decimals), "{line}");
                assert!(!digits.is_empty() && !decimals.is_empty(), "{line}");
            }
        }
        assert!(print.text.ends_with('\n'));
    }
}

#[test]
fn the_head_stays_over_the_bed() {
    for (print, m) in all_moves() {
        let volume = BuildVolume::of(&print.plate.settings);
        let high = DVec3::new(volume.x, volume.y, volume.z);
        let to = m.to;
        // Before the first travel x and y are where the template left them.
        let across = to.truncate().is_nan_mask().any()
            || (to.truncate().cmpge(DVec2::ZERO).all()
                && to.truncate().cmple(high.truncate()).all());
        assert!(across && (0.0..=high.z).contains(&to.z), "{}", print.at(m));
    }
}

#[test]
fn filament_goes_back_only_to_retract() {
    for (print, m) in all_moves() {
        match m.kind {
            MoveKind::Print => {
                assert!(m.fed > 0.0, "{}", print.at(m));
                assert_eq!(m.back, 0.0, "not primed: {}", print.at(m));
            }
            MoveKind::Retract => {
                assert_eq!(m.back, 0.0, "retracted twice: {}", print.at(m));
                let length = number(&print.plate.settings, "retract.length");
                assert!((m.fed + length).abs() < 1e-4, "{}", print.at(m));
            }
            MoveKind::Prime => {
                assert!((m.fed - m.back).abs() < 1e-4, "{}", print.at(m));
            }
            MoveKind::Travel | MoveKind::Lift => assert_eq!(m.fed, 0.0),
        }
    }
}

#[test]
fn the_head_sinks_only_to_the_layer_it_prints() {
    for print in PRINTS.iter() {
        let mut hops = 0;
        let mut below = 0.0;
        for layer in &print.layers {
            assert!(layer.z > below, "{}: layer at {}", print.name, layer.z);
            below = layer.z;
            for m in layer.moves.iter().filter(|m| m.kind == MoveKind::Lift) {
                if m.to.z < m.from.z {
                    hops += 1;
                    assert_eq!(m.to.z, layer.z, "{}", print.at(m));
                }
            }
            for m in &layer.moves {
                let across =
                    matches!(m.kind, MoveKind::Print | MoveKind::Travel);
                if across && m.from.is_finite() {
                    assert_eq!(m.from.z, m.to.z, "{}", print.at(m));
                    assert!(m.to.z >= layer.z, "{}", print.at(m));
                }
            }
        }
        assert!(hops > 0, "{}: no hop to check", print.name);
    }
}

#[test]
fn no_layer_gets_more_material_than_it_has_room_for() {
    for print in PRINTS.iter() {
        let across =
            filament_area(number(&print.plate.settings, "filament.diameter"));
        for (layer, area) in print.layers.iter().zip(&print.outlines) {
            let fed = layer.fed() * across;
            let room = area.content() * layer.height;
            assert!(
                fed <= 1.05 * room,
                "{}, z = {}: {fed} mm³ into {room} mm³",
                print.name,
                layer.z
            );
        }
    }
}

#[test]
fn walls_stay_inside_the_outline() {
    for print in PRINTS.iter() {
        // Beads of the usual width, and those that become wider or narrower
        // on their way: how many there are, and how many stick out, by more than
        // printers step.
        const STEP: f64 = 0.0125;
        let (mut usual, mut tapers) = ((0, 0), (0, 0));
        for (layer, edges) in print.each_layer() {
            let walls = layer
                .prints()
                .filter(|m| [OUTER_WALL, INNER_WALL].contains(&m.role));
            for m in walls {
                let (a, b) = m.ends();
                let width = match m.role {
                    OUTER_WALL => print.plate.settings.outer_wall_width(),
                    _ => print.plate.settings.inner_wall_width(),
                };
                let sticks_out = |share: f64, by: f64| {
                    let p = a.lerp(b, share);
                    let least = 0.5 * m.width - by - ROUNDING;
                    edges.nearest_within(p, least).is_some()
                        || !edges.contains(p)
                };
                // Webs and fins may be 45 % as wide as their beads, the thinnest, and a
                // little less between two points of a thinned axis.
                let least = print.plate.settings.thin_min / 100.0 * width;
                let by = if m.width < 1.05 * least { 0.3 } else { 0.05 };
                assert!(!sticks_out(0.5, by * m.width), "{}", print.at(m));
                // Widths are written with four decimals.
                if (m.width - width).abs() < 5e-5 {
                    let out = [0.1, 0.5, 0.9].map(|s| sticks_out(s, STEP));
                    usual.0 += 1;
                    usual.1 += usize::from(out.contains(&true));
                } else {
                    // The width is the mean of those at the ends.
                    tapers.0 += 1;
                    tapers.1 += usize::from(sticks_out(0.5, STEP));
                }
            }
        }
        let name = &print.name;
        assert!(tapers.1 <= tapers.0 / 100, "{name}: {tapers:?}");
        // The mean may be just the usual width.
        assert!(usual.1 <= usual.0 / 80, "{name}: {usual:?}, {tapers:?}");
        assert!(usual.0 > 200, "{name}: {usual:?}");
    }
}

#[test]
fn travels_that_leave_the_part_are_retracted() {
    for print in PRINTS.iter() {
        let own = 0.5 * print.plate.settings.outer_wall_width() + 0.01;
        let mut retracted = 0;
        for (layer, edges) in print.each_layer() {
            let walls = Edges::new(&outer_walls(layer));
            // Travels by way points count as one, and so do hops on them.
            let runs = layer
                .moves
                .chunk_by(|a, b| !is_print(a) && !is_print(b))
                .filter(|run| !is_print(&run[0]));
            for run in runs {
                let legs: Vec<&Move> = run
                    .iter()
                    .filter(|m| {
                        m.kind == MoveKind::Travel && m.from.is_finite()
                    })
                    .collect();
                let length: f64 = legs.iter().map(|m| m.length()).sum();
                if length <= 2.0 {
                    continue;
                }
                for m in legs {
                    if m.back > 0.0 {
                        retracted += 1;
                        continue;
                    }
                    let (a, b) = m.ends();
                    let whole = m.length();
                    let outside = !edges.contains(a)
                        || !edges.contains(b)
                        || !edges.crossings(a, b).is_empty();
                    // Leaving the wall just printed is no crossing, nor is
                    // grazing a corner that rounding has moved.
                    let mut walls: Vec<f64> = walls.crossings(a, b);
                    walls.sort_by(f64::total_cmp);
                    walls.iter_mut().for_each(|t| *t *= whole);
                    walls.retain(|t| (own..whole - own).contains(t));
                    let wall = walls.chunks(2).any(|pair| match pair {
                        [into, out] => out - into > 0.05,
                        _ => true,
                    });
                    assert!(!outside, "leaves the part: {}", print.at(m));
                    assert!(!wall, "crosses a wall: {}", print.at(m));
                }
            }
        }
        assert!(retracted > 0, "{}: no retraction", print.name);
    }
}

fn is_print(m: &Move) -> bool {
    m.kind == MoveKind::Print
}

/// The lines of a layer's outer walls.
fn outer_walls(layer: &Layer) -> Area {
    let mut rings: Vec<Vec<DVec2>> = Vec::new();
    let mut at = None;
    for m in layer.prints().filter(|m| m.role == OUTER_WALL) {
        let (a, b) = m.ends();
        match rings.last_mut() {
            Some(ring) if at == Some(a) => ring.push(b),
            _ => rings.push(vec![a, b]),
        }
        at = Some(b);
    }
    // What is not closed goes back the way it came.
    for ring in &mut rings {
        if ring.first() != ring.last() {
            ring.extend(ring.clone().iter().rev());
        }
    }
    Area { rings }
}

#[test]
fn the_skirt_keeps_off_the_part() {
    for print in PRINTS.iter() {
        let (layer, area) = (&print.layers[0], &print.outlines[0]);
        let edges = Edges::new(area);
        let skirt = layer.moves.iter().filter(|m| m.role == SKIRT);
        let skirt: Vec<&Move> = skirt.filter(|m| is_print(m)).collect();
        assert!(!skirt.is_empty(), "{}", print.name);
        for m in skirt {
            let (a, b) = m.ends();
            // The hull is offset with arcs of chords, good to 10 µm.
            let gap =
                print.plate.settings.skirt_distance() + 0.5 * m.width - 0.02;
            for p in [a, a.midpoint(b), b] {
                assert!(!area.contains(p), "{}", print.at(m));
                let near = edges.nearest_within(p, gap);
                assert!(near.is_none(), "{near:?} {}", print.at(m));
            }
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let by_name = |name: &str| example(name).place(COARSE);
    let fine = settings(&["sample_spacing=0.2", "retract.z_hop=0.2"]);
    let vase = "max(abs(sqrt(x^2+y^2) - 4 - sin(z/2) - 0.1*x) - 0.6, \
                abs(z) - 10)";
    for (name, (model, settings)) in [
        ("bracket", by_name("blended-bracket")),
        ("knob", by_name("threaded-knob")),
        ("lychee", by_name("weekend")),
        // A hundred layers: several slabs, and more of them than threads.
        ("vase", (formula(vase, &fine), fine)),
    ] {
        let (first, summary) = slice(&model, &settings, 1);
        assert!(name != "vase" || summary.layers.len() > 64);
        for threads in [1, 2, 4] {
            let (again, _) = slice(&model, &settings, threads);
            // Not assert_eq: nobody wants to see both files.
            assert!(again == first, "{name} differs on {threads} threads");
        }
    }
}

#[test]
fn a_solid_print_has_the_volume_of_the_part() {
    for (text, exact) in [
        (
            "max(max(abs(x) - 9, abs(y) - 7), abs(z) - 1.5)",
            18.0 * 14.0 * 3.0,
        ),
        (
            "max(sqrt(x^2 + y^2) - 8, abs(z) - 1.5)",
            64.0 * 3.0 * std::f64::consts::PI,
        ),
    ] {
        for skin in ["top_layers=0", "top_layers=50"] {
            let bottom = skin.replace("top", "bottom");
            let settings = settings(&[
                "infill_density=100%",
                "skirt.loops=0",
                skin,
                &bottom,
            ]);
            let across = filament_area(number(&settings, "filament.diameter"));
            let (gcode, _) = slice(&formula(text, &settings), &settings, 2);
            let fed: f64 = parse(&gcode).iter().map(Layer::fed).sum();
            let share = fed * across / exact;
            assert!((0.97..1.03).contains(&share), "{text} {skin}: {share}");
        }
    }
}

/// Points on the walls of a print, in the plane of the model.
fn wall_points(model: &Model, layer: &Layer) -> Vec<DVec2> {
    layer
        .prints()
        .filter(|m| [OUTER_WALL, INNER_WALL].contains(&m.role))
        .map(|m| m.ends().1 - model.offset.truncate())
        .collect()
}

/// Layers of a formula with walls offset in the plane and by the field.
fn both_ways(text: &str, more: &[&str]) -> [(Model, Vec<Layer>); 2] {
    ["distance", "field"].map(|way| {
        let way = format!("wall_offset={way}");
        // Both ways are thinned by themselves, and each as finely as outlines.
        let exact = [way.as_str(), "walls=3", "path_accuracy=0.005"];
        let settings = settings(&[&exact[..], more].concat());
        let model = formula(text, &settings);
        let (gcode, _) = slice(&model, &settings, 2);
        (model, parse(&gcode))
    })
}

#[test]
fn walls_by_field_are_walls_by_distance_on_a_cylinder() {
    let cylinder = |height: &str| {
        format!("max(sqrt(x^2 + y^2) - 9, abs(z - {height}) - {height})")
    };
    let both = both_ways(&cylinder("3"), &[]);
    // The layer is between the skins: near the part's ends the field measures
    // in z.
    let middle = both[0].1.len() / 2;
    walls_are_the_same(&both, middle);
    // Layers of different heights, whose walls are at different distances.
    let both = both_ways(
        &cylinder("5"),
        &["layer_heights=expr: 0.1 + z/50", "layer_height_min=0.1"],
    );
    let count = both[0].1.len();
    for layer in [count / 3, count / 2, 2 * count / 3] {
        walls_are_the_same(&both, layer);
    }
}

fn walls_are_the_same(both: &[(Model, Vec<Layer>); 2], layer: usize) {
    let [(model, distance), (_, field)] = both;
    let [a, b] = [&distance[layer], &field[layer]];
    let rings = |layer| {
        let mut radii: Vec<f64> = wall_points(model, layer)
            .iter()
            .map(|p| p.length())
            .collect();
        radii.sort_by(f64::total_cmp);
        radii
    };
    let (a, b) = (rings(a), rings(b));
    assert!(a.len() > 100 && b.len() > 100);
    for (from, to) in [(&a, &b), (&b, &a)] {
        for r in from {
            let off = to.iter().map(|s| (r - s).abs()).fold(1.0, f64::min);
            assert!(off < 0.015, "{r} is off by {off}");
        }
    }
}

#[test]
fn walls_by_field_are_not_walls_by_distance_on_a_sphere() {
    let [(model, distance), (_, field)] =
        both_ways("sqrt(x^2 + y^2 + z^2) - 6", &[]);
    let outer = |layer: &Layer| {
        wall_points(&model, layer)
            .iter()
            .map(|p| p.length())
            .fold(0.0, f64::max)
    };
    let apart = |i: usize| outer(&distance[i]) - outer(&field[i]);
    // At the equator the field is a distance in the plane.
    let middle = distance.len() / 2;
    assert!(apart(middle).abs() < 0.015, "{}", apart(middle));
    // At two thirds up to the pole its slope in the plane is 3/4.
    let high = distance.len() * 5 / 6;
    assert!(apart(high) > 0.05, "{}", apart(high));
}
