//! What the tests of whole runs share: slicing from text, the examples, and
//! reading G-code back.
//!
//! The reader is written against what the firmware does with the file, not
//! against the writer: it follows the head and the filament word by word.

// Each test file is a crate of its own and uses its share of this.
#![allow(dead_code, reason = "no test file uses everything")]

pub mod edges;
pub mod head;
pub mod program;

use glam::{DVec2, DVec3};
use isocontour::SLAB;
use isocontour::{Detail, Field, Outline, outlines};
use isoslice::layers::{LayerRange, LayerSpan, plan};
use isoslice::model::{
    BuildVolume, Model, Placement, Source, SourceKind, load, place,
};
use isoslice::pipeline::{self, Options, Summary};
use isoslice::plate::Wanted;
use isoslice::settings::{Builder, Settings, keys};
use isoslice::{JoinError, Ranges};
use std::path::{Path, PathBuf};

/// Cross-section of a filament.
pub fn filament_area(diameter: f64) -> f64 {
    0.25 * std::f64::consts::PI * diameter * diameter
}

/// Settings from assignments as `--set` takes them, without pictures, which
/// cost more than many a test's part.
pub fn settings(assignments: &[&str]) -> Settings {
    let mut builder = Builder::new();
    builder.set("gcode.thumbnails=").unwrap();
    for assignment in assignments {
        builder.set(assignment).unwrap();
    }
    builder.finish().unwrap().0
}

/// The value of a setting that is a number.
#[track_caller]
pub fn number(settings: &Settings, name: &str) -> f64 {
    let value = text(settings, name);
    value.parse().unwrap_or_else(|_| panic!("{name} = {value}"))
}

/// The value of a setting, as TOML.
#[track_caller]
pub fn text(settings: &Settings, name: &str) -> String {
    let key = keys().iter().find(|key| key.name == name);
    key.unwrap_or_else(|| panic!("no {name}")).get(settings)
}

/// The model that a text describes, placed on the bed.
pub fn model(
    kind: SourceKind,
    text: &str,
    defines: &[(String, String)],
    placement: &Placement,
    settings: &Settings,
) -> Model {
    let source = Source::Text {
        name: "test".into(),
        kind,
        text: text.into(),
    };
    placed(&source, defines, placement, settings)
}

/// A model from anywhere, placed on the bed.
pub fn placed(
    source: &Source,
    defines: &[(String, String)],
    placement: &Placement,
    settings: &Settings,
) -> Model {
    let volume = BuildVolume::of(settings);
    let placement = Placement {
        margin: settings.reach(),
        ..*placement
    };
    place(&load(source, defines).unwrap(), &placement, volume).unwrap()
}

/// A formula's model as it is, on the bed.
pub fn formula(text: &str, settings: &Settings) -> Model {
    let placement = Placement::default();
    model(SourceKind::Formula, text, &[], &placement, settings)
}

/// A formula's model on the bed, and its settings.
pub fn part(text: &str, assignments: &[&str]) -> (Model, Settings) {
    let settings = settings(assignments);
    (formula(text, &settings), settings)
}

/// The middle of the settings' bed.
pub fn middle(settings: &Settings) -> DVec2 {
    let size = ["printer.bed_x", "printer.bed_y"];
    0.5 * DVec2::from_array(size.map(|name| number(settings, name)))
}

/// A formula's model as a part of a plate, where a place is found for it.
pub fn wanted(
    name: &str,
    text: &str,
    copies: u64,
    settings: &Settings,
) -> Wanted {
    Wanted {
        source: Source::formula(name, text),
        defines: Vec::new(),
        placement: Placement::default(),
        settings: settings.clone(),
        at: None,
        copies,
        asked: name.into(),
    }
}

/// The G-code of a model.
pub fn slice(
    model: &Model,
    settings: &Settings,
    threads: usize,
) -> (String, Summary) {
    slice_layers(model, settings, "..", threads)
}

/// The G-code of some of a model's layers.
pub fn slice_layers(
    model: &Model,
    settings: &Settings,
    layers: &str,
    threads: usize,
) -> (String, Summary) {
    let options = Options {
        threads: Some(threads),
        layers: layers.parse::<LayerRange>().unwrap(),
        ..Options::default()
    };
    let mut bytes = Vec::new();
    let summary =
        pipeline::slice(model, settings, &options, &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), summary)
}

/// The file that the files of ranges are joined to.
pub fn join(files: &[impl AsRef<[u8]>]) -> Result<Vec<u8>, JoinError> {
    let folder = tempfile::tempdir().unwrap();
    let write = |(k, file): (usize, &_)| {
        let path = folder.path().join(format!("{k}.gcode"));
        std::fs::write(&path, AsRef::<[u8]>::as_ref(file)).unwrap();
        path
    };
    let paths: Vec<PathBuf> = files.iter().enumerate().map(write).collect();
    let mut joined = Vec::new();
    Ranges::open(&paths)?.join(&mut joined)?;
    Ok(joined)
}

/// The layers of a model, and their outlines in the model's coordinates.
pub fn layers(
    model: &Model,
    settings: &Settings,
) -> (Vec<LayerSpan>, Vec<Outline>) {
    let spans = plan(
        model.bounds.max.z + model.offset.z,
        settings.first_layer_height(),
        settings.layer_height(),
    )
    .unwrap();
    let rect = model.bounds.from_above();
    let field =
        Field::new(&model.tree, 0.0, rect, settings.lattice_spacing()).unwrap();
    let detail = Detail {
        // What the program leaves to outlines.
        accuracy: 0.7 * number(settings, "accuracy"),
        smallest: 0.25 * settings.outer_wall_width(),
    };
    let found = spans
        .chunks(SLAB)
        .flat_map(|slab| {
            let z: Vec<f64> =
                slab.iter().map(|s| s.sample_z() - model.offset.z).collect();
            outlines(&field, &z, detail).unwrap()
        })
        .collect();
    (spans, found)
}

/// A script in `examples/` and how its head says to slice it.
pub struct Example {
    pub name: String,
    text: String,
    defines: Vec<(String, String)>,
    placement: Placement,
    assignments: Vec<String>,
}

/// Every example, in the order of their names.
pub fn examples() -> Vec<Example> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "rhai"))
        .collect();
    files.sort();
    files.iter().map(|file| Example::read(file)).collect()
}

/// The example of this name.
pub fn example(name: &str) -> Example {
    let named = |e: &Example| e.name == name;
    examples().into_iter().find(named).unwrap()
}

impl Example {
    /// Gives a parameter of its script another value.
    pub fn define(&mut self, name: &str, value: &str) {
        self.defines.push((name.into(), value.into()));
    }

    fn read(file: &Path) -> Example {
        let text = std::fs::read_to_string(file).unwrap();
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        // The first such line is the one to follow, as in .ci/run.
        let usage = text
            .lines()
            .filter_map(|line| line.strip_prefix("//"))
            .find_map(|line| line.trim().strip_prefix("isoslice slice "))
            .unwrap_or_else(|| panic!("{name} does not say how to slice it"));
        let mut example = Example {
            name,
            text: text.clone(),
            defines: Vec::new(),
            placement: Placement::default(),
            assignments: Vec::new(),
        };
        let mut words = usage.split_whitespace().skip(1);
        while let Some(word) = words.next() {
            let value = words.next().unwrap_or_default();
            match word {
                "-D" => {
                    let (name, value) = value.split_once('=').unwrap();
                    example.defines.push((name.into(), value.into()));
                }
                "--size" => example.placement.size = value.parse().ok(),
                "--scale" => example.placement.scale = value.parse().ok(),
                "--set" => example.assignments.push(value.into()),
                _ => panic!("{}: teach the tests {word}", example.name),
            }
        }
        example
    }

    /// The example with its own settings and, on top of them, others.
    pub fn place(&self, assignments: &[&str]) -> (Model, Settings) {
        let own = self.assignments.iter().map(String::as_str);
        let all: Vec<&str> = own.chain(assignments.iter().copied()).collect();
        let settings = settings(&all);
        let model = model(
            SourceKind::Script,
            &self.text,
            &self.defines,
            &self.placement,
            &settings,
        );
        (model, settings)
    }
}

/// Names of roles in the G-code.
pub const SKIRT: &str = "Skirt/Brim";
pub const OUTER_WALL: &str = "External perimeter";
pub const INNER_WALL: &str = "Perimeter";
pub const SUPPORT: &str = "Support material";
pub const SUPPORT_INTERFACE: &str = "Support material interface";
pub const ROLES: [&str; 13] = [
    SKIRT,
    OUTER_WALL,
    INNER_WALL,
    "Overhang perimeter",
    "Gap fill",
    "Top solid infill",
    "Solid infill",
    "Bridge infill",
    "Ironing",
    "Internal infill",
    SUPPORT,
    SUPPORT_INTERFACE,
    "Custom",
];

/// What a line of G-code makes the machine do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoveKind {
    /// Across the plane, feeding filament.
    Print,
    /// Across the plane, feeding none.
    Travel,
    /// Up or down only.
    Lift,
    /// Filament only, backwards.
    Retract,
    /// Filament only, forwards.
    Prime,
}

/// One move of the machine.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    pub kind: MoveKind,
    /// NaN where the start template left the head somewhere.
    pub from: DVec3,
    pub to: DVec3,
    /// Filament fed, mm; negative if pulled back.
    pub fed: f64,
    /// Filament that is pulled back when the move begins.
    pub back: f64,
    pub role: &'static str,
    pub width: f64,
    /// Feed rate, mm/min.
    pub feed: f64,
    /// Line in the file, from 1.
    pub line: usize,
}

impl Move {
    /// Length in the plane.
    pub fn length(&self) -> f64 {
        self.from.truncate().distance(self.to.truncate())
    }

    /// Both ends in the plane.
    pub fn ends(&self) -> (DVec2, DVec2) {
        (self.from.truncate(), self.to.truncate())
    }
}

/// What stands between two layer changes.
pub struct Layer {
    pub z: f64,
    pub height: f64,
    pub moves: Vec<Move>,
}

impl Layer {
    /// Filament fed into the part, skirt not included, mm.
    pub fn fed(&self) -> f64 {
        self.prints().map(|m| m.fed).sum()
    }

    /// Moves that print the part.
    pub fn prints(&self) -> impl Iterator<Item = &Move> {
        self.moves
            .iter()
            .filter(|m| m.kind == MoveKind::Print && m.role != SKIRT)
    }

    fn has_printed(&self) -> bool {
        self.moves.iter().any(|m| m.kind == MoveKind::Print)
    }

    /// Length printed in a role.
    pub fn length(&self, role: &str) -> f64 {
        let of_role = self.moves.iter().filter(|m| m.role == role);
        let prints = of_role.filter(|m| m.kind == MoveKind::Print);
        prints.map(Move::length).sum()
    }
}

/// Follows a file; what the start and end templates do is left out.
pub fn parse(text: &str) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    let mut at = DVec3::NAN;
    let (mut relative, mut e, mut back) = (false, 0.0, 0.0_f64);
    let (mut role, mut width) = ("Custom", f64::NAN);
    let mut feed = f64::NAN;
    for (i, line) in text.lines().enumerate() {
        let line_number = i + 1;
        let number = |text: &str| -> f64 {
            let value: f64 = text.parse().unwrap_or(f64::NAN);
            assert!(value.is_finite(), "line {line_number}: {line}");
            value
        };
        if line == ";LAYER_CHANGE" {
            layers.push(Layer {
                z: f64::NAN,
                height: f64::NAN,
                moves: Vec::new(),
            });
        } else if let Some(name) = line.strip_prefix(";TYPE:") {
            let known = ROLES.iter().find(|r| **r == name);
            role = known.unwrap_or_else(|| panic!("{name} is no role"));
        } else if let Some(value) = line.strip_prefix(";WIDTH:") {
            width = number(value);
        } else if let Some(value) = line.strip_prefix(";Z:") {
            layers.last_mut().unwrap().z = number(value);
        } else if let Some(value) = line.strip_prefix(";HEIGHT:") {
            layers.last_mut().unwrap().height = number(value);
        }
        let code = line.split(';').next().unwrap_or_default();
        let mut words = code.split_whitespace();
        match words.next() {
            Some("M82") => relative = false,
            Some("M83") => relative = true,
            Some("G92") => {
                assert_eq!(words.next(), Some("E0"), "line {line_number}");
                e = 0.0;
            }
            Some("G0" | "G1") => {
                let (mut to, mut fed) = (at, 0.0);
                for word in words {
                    let (axis, value) = word.split_at(1);
                    let value = number(value);
                    match axis {
                        "X" => to.x = value,
                        "Y" => to.y = value,
                        "Z" => to.z = value,
                        "E" if relative => fed = value,
                        "E" => {
                            fed = value - e;
                            e = value;
                        }
                        "F" => {
                            assert!(value > 0.0, "line {line_number}");
                            feed = value;
                        }
                        _ => panic!("line {line_number}: {line}"),
                    }
                }
                let across = to.x != at.x || to.y != at.y;
                let kind = match (across, fed) {
                    (true, 0.0) => MoveKind::Travel,
                    (true, _) => MoveKind::Print,
                    (false, 0.0) => MoveKind::Lift,
                    (false, f) if f < 0.0 => MoveKind::Retract,
                    (false, _) => MoveKind::Prime,
                };
                let between = layers.is_empty() || role == "Custom";
                // When the head leaves the template, no role has been named.
                let begins = layers.iter().all(|l| !l.has_printed());
                if let Some(layer) = layers.last_mut()
                    && (!between || begins)
                {
                    layer.moves.push(Move {
                        kind,
                        from: at,
                        to,
                        fed,
                        back,
                        role,
                        width,
                        feed,
                        line: line_number,
                    });
                }
                if kind != MoveKind::Print {
                    back = (back - fed).max(0.0);
                }
                at = to;
            }
            _ => {}
        }
    }
    layers
}
