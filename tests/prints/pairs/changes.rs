//! The changes, and how much of a print each of them must keep.

use super::features::Feature;
use super::printed::{Laid, printed};
use crate::common::{
    join, model, part, settings, slice, slice_layers, text, wanted,
};
use isoslice::model::{Model, Placement, SourceKind};
use isoslice::pipeline::{Options, slice_plate};
use isoslice::plate::{Plate, Wanted};
use std::collections::BTreeMap;

/// A change.
pub enum How {
    /// The file is written otherwise. All beads stay.
    Written(&'static [&'static str]),
    /// The body's formula is written otherwise. All beads stay.
    Formula(fn(&str) -> String),
    /// The body is the union of two that share a face, where this is 0. The
    /// filament stays, since corners of outlines may be elsewhere.
    Cut(&'static str),
    /// The part is turned by a right angle. The filament stays.
    Turned,
    /// The part stands elsewhere. All beads stay where they are on the part.
    Moved,
    /// Three threads make the file. Its bytes stay.
    Threads,
    /// The file is made in ranges of layers. Its bytes stay.
    Ranges,
    /// Others stand on the plate. All beads stay, though not their order.
    Plate,
}

/// What a feature prints without a change.
pub struct Plain {
    gcode: String,
    laid: Vec<Laid>,
}

impl Plain {
    pub fn of(feature: &Feature) -> Plain {
        let gcode = sliced(feature.part, &asked(feature, &[]));
        let laid = printed(&gcode, None);
        assert!(laid.len() > 100, "{} prints nothing", feature.name);
        Plain { gcode, laid }
    }
}

/// The settings of thick layers. Firmwares differ in the moves that they take a
/// second, hence the number.
const BASE: &[&str] = &[
    "layer_height=0.3",
    "first_layer_height=0.3",
    "sample_spacing=0.225",
    "accuracy=0.02",
    "path_accuracy=0.05",
    "skirt.loops=0",
    "gcode.progress=off",
    "printer.max_moves_per_second=500",
];

/// A turn by a right angle.
const QUARTER: [f64; 3] = [0.0, 0.0, 90.0];

/// By how much filament may differ, as a share.
const SLACK: f64 = 0.005;

fn asked<'a>(feature: &Feature, more: &[&'a str]) -> Vec<&'a str> {
    [BASE, feature.set, more].concat()
}

fn placed(f: &str, placement: &Placement, asked: &[&str]) -> Model {
    model(SourceKind::Formula, f, &[], placement, &settings(asked))
}

fn sliced(f: &str, asked: &[&str]) -> String {
    let (model, settings) = part(f, asked);
    slice(&model, &settings, 1).0
}

impl How {
    /// What differs after the change, if anything does.
    pub fn differs(&self, feature: &Feature, plain: &Plain) -> Option<String> {
        let own = || asked(feature, &[]);
        let bytes = |gcode: &[u8]| {
            (gcode != plain.gcode.as_bytes()).then(|| "other bytes".into())
        };
        let same = |gcode: &str| beads(&plain.laid, &printed(gcode, None));
        let as_much = |gcode| filament(&plain.laid, &printed(gcode, None));
        match *self {
            How::Written(more) => {
                same(&sliced(feature.part, &asked(feature, more)))
            }
            How::Formula(f) => same(&sliced(&f(feature.part), &own())),
            How::Cut(face) => {
                let f = feature.part;
                let halves =
                    format!("min(max({f}, {face}), max({f}, -({face})))");
                as_much(&sliced(&halves, &own()))
            }
            How::Turned => {
                let angles = &["infill_angle=135", "skin_angle=135"][..];
                let more = [angles, feature.turned?].concat();
                let own = asked(feature, &more);
                let turned = Placement {
                    rotate: QUARTER,
                    ..Placement::default()
                };
                let turned = placed(feature.part, &turned, &own);
                as_much(&slice(&turned, &settings(&own), 1).0)
            }
            How::Moved => moved(feature, plain),
            How::Threads => {
                let (model, settings) = part(feature.part, &own());
                bytes(slice(&model, &settings, 3).0.as_bytes())
            }
            How::Ranges => {
                let (model, settings) = part(feature.part, &own());
                let of = |range| slice_layers(&model, &settings, range, 1).0;
                let parts = ["1..2", "3..7", "8.."].map(of);
                bytes(&join(&parts).unwrap())
            }
            How::Plate => in_company(feature),
        }
    }
}

/// What differs if the part stands elsewhere on the bed.
fn moved(feature: &Feature, plain: &Plain) -> Option<String> {
    let own = asked(feature, &[]);
    let [here, there] = [None, Some((123.0, 87.0))].map(|at| {
        let placement = Placement {
            at,
            ..Placement::default()
        };
        placed(feature.part, &placement, &own)
    });
    let shift = (there.offset - here.offset).truncate();
    let mut laid = printed(&slice(&there, &settings(&own), 1).0, None);
    laid.iter_mut().for_each(|l| l.shift(-shift));
    beads(&plain.laid, &laid)
}

/// What differs if a copy, and the part turned, stand on the plate.
fn in_company(feature: &Feature) -> Option<String> {
    // Supports may use half of the room between parts.
    let plate = &[
        "gcode.flavour=klipper",
        "gcode.labels=on",
        "plate.spacing=30",
    ][..];
    let together = settings(&asked(feature, plate));
    if text(&together, "spiral") != "false" {
        // A vase has its plate for itself.
        return None;
    }
    // A skirt and a shield belong to the plate.
    let own = [plate, &["skirt.loops=0", "draft_shield=off"]].concat();
    let own = settings(&asked(feature, &own));
    let alone = vec![wanted("part", feature.part, 1, &own)];
    let mut all = vec![wanted("part", feature.part, 2, &together)];
    // All parts of a plate have the same layers.
    if text(&together, "layer_heights") == "\"uniform\"" {
        let mut turned = wanted("turned", feature.part, 1, &together);
        turned.placement.rotate = QUARTER;
        all.push(turned);
    }
    let (_, alone) = on_plate(&alone);
    let alone = printed(&alone, Some("part"));
    assert!(!alone.is_empty());
    let (plate, gcode) = on_plate(&all);
    let part = plate.parts.iter().find(|p| p.model.name == "part").unwrap();
    assert_eq!(part.places.len(), 2);
    part.places.iter().find_map(|place| {
        let mut laid = printed(&gcode, Some(&place.name));
        laid.iter_mut().for_each(|l| l.shift(-place.shift));
        beads_in_any_order(&alone, &laid)
    })
}

fn on_plate(all: &[Wanted]) -> (Plate, String) {
    let plate = Plate::new("plate", all, &all[0].settings).unwrap();
    let options = Options {
        threads: Some(1),
        ..Options::default()
    };
    let mut out = Vec::new();
    slice_plate(&plate, &options, &mut out).unwrap();
    (plate, String::from_utf8(out).unwrap())
}

/// The first bead that differs, if any does.
fn beads(before: &[Laid], after: &[Laid]) -> Option<String> {
    let mut pairs = before.iter().zip(after);
    let first = pairs.find(|(a, b)| !a.is_like(b));
    let count = [before, after].map(<[_]>::len);
    match first {
        Some((a, b)) => Some(format!("{a:?} is {b:?}")),
        None if count[0] == count[1] => None,
        None => Some(format!("{} beads are {}", count[0], count[1])),
    }
}

/// What is laid in one of them only, if anything is. The order of beads, and
/// their directions, may depend on where the head comes from.
fn beads_in_any_order(before: &[Laid], after: &[Laid]) -> Option<String> {
    // A bead that feeds one unit of what a file resolves feeds none elsewhere.
    let counts = |laid: &&Laid| laid.fed > 1.5e-5;
    let mut left: Vec<&Laid> = after.iter().filter(counts).collect();
    for a in before.iter().filter(counts) {
        let back = a.reversed();
        let like = |b: &&Laid| a.is_like(b) || back.is_like(b);
        match left.iter().position(like) {
            Some(k) => drop(left.swap_remove(k)),
            None => return Some(format!("nothing is {a:?}")),
        }
    }
    left.first().map(|b| format!("there is {b:?} as well"))
}

/// By how much the filament differs, if it does: all of it, or that of a role,
/// as a share of all.
fn filament(before: &[Laid], after: &[Laid]) -> Option<String> {
    let mut more: BTreeMap<&str, f64> = BTreeMap::new();
    let mut all = 0.0;
    for laid in before {
        *more.entry(&laid.role).or_default() -= laid.fed;
        all += laid.fed;
    }
    for laid in after {
        *more.entry(&laid.role).or_default() += laid.fed;
    }
    *more.entry("all").or_default() = more.values().sum();
    let off: Vec<String> = more
        .iter()
        .filter(|(_, fed)| fed.abs() > SLACK * all)
        .map(|(role, fed)| format!("{role} {:+.2} %", 100.0 * fed / all))
        .collect();
    (!off.is_empty()).then(|| off.join(", "))
}
