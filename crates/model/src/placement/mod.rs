//! Putting a model on the printer: scale, rotation, position.
//!
//! In: a loaded model, how to place it, the printer's build volume. Out: a
//! `Model`, whose `offset` takes its frame to the printer's (origin at the
//! front left corner of the bed, z = 0 on the bed, millimetres).
//!
//! Scale and rotation become part of the expression. The field's values are
//! scaled with the model (g(p) = s·f(p/s)), so that a distance stays a
//! distance. Translation does not become part of it: f32 is most accurate near
//! the origin that the author chose, and a plane at x = 10 stays there exactly.
//! Only a part that was drawn a metre or more away has its origin moved
//! (`shift`). Without scale, rotation and bounds the expression is exactly the
//! user's own.
//!
//! By default the part rests on the bed with its lowest point at z = 0 and is
//! centred in x and y. With `keep_position` model coordinates are printer
//! coordinates. Then whatever lies below z = 0 is not printed: the part is cut
//! by the bed. This is a warning and not an error, because sinking a part is a
//! way to flatten its foot.

mod error;
mod hull;
mod lay;
mod transform;

pub use error::PlaceError;

use super::param::Parameter;
use super::source::Loaded;
use fidget::context::Tree;
use glam::{DMat3, DVec3};
use isocontour::{
    Bounds, BoundsError, Data, FoundBounds, SearchOptions, Solid, digits,
    expand, is_flat, shifted, solid,
};
use isoslice_base::limits;
use isoslice_settings::Settings;
use lay::{down, largest_side};
use std::path::PathBuf;
use std::sync::Arc;
use transform::{box_field, mapped, rotation};

/// The space a printer can reach, from (0, 0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildVolume {
    /// Width of the bed, mm.
    pub x: f64,
    /// Depth of the bed, mm.
    pub y: f64,
    /// Height above the bed, mm.
    pub z: f64,
}

impl BuildVolume {
    /// A space larger than any part whose bounds can be found, for models that are
    /// not to be printed.
    pub const ANY: BuildVolume = BuildVolume {
        x: 1e9,
        y: 1e9,
        z: 1e9,
    };

    /// The space that the printer of these settings can reach.
    pub fn of(settings: &Settings) -> BuildVolume {
        let printer = &settings.printer;
        BuildVolume {
            x: printer.bed_x,
            y: printer.bed_y,
            z: printer.height,
        }
    }
}

/// How to place a model. The default rests it on the middle of the bed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Factor on all lengths. Default value: none (1).
    pub scale: Option<f64>,
    /// Length of the largest side of the box around the rotated part, mm, to
    /// which the model is scaled. Default value: none.
    pub size: Option<f64>,
    /// Lay a mesh on the largest flat side of its convex hull, before it is
    /// rotated. Default value: false.
    pub lay: bool,
    /// Angles about x, then y, then z, degrees, counter-clockwise seen from
    /// the axis' tip. Default value: no rotation.
    pub rotate: [f64; 3],
    /// Where on the bed the middle of the part's box goes, mm. Default value:
    /// the middle of the bed.
    pub at: Option<(f64, f64)>,
    /// Take the model's coordinates as the printer's. Default value: false.
    pub keep_position: bool,
    /// A box that cuts the model, in the model's own coordinates (before scale
    /// and rotation). Default value: none, the bounds are found.
    pub bounds: Option<Bounds>,
    /// Height of the part, mm, for a model that does not depend on z. Such a
    /// model is a drawing. `size` is then its larger side, and it is raised
    /// before it is turned. Default value: none.
    pub height: Option<f64>,
    /// How far what is printed reaches beyond the part on all sides in the
    /// plane, mm. It needs room on the bed. Default value: 0.
    pub margin: f64,
}

/// A model placed on the printer.
#[derive(Clone)]
pub struct Model {
    /// Name: the file's, without folder and extension.
    pub name: String,
    /// Field in the model's frame, scaled and rotated; negative inside.
    pub tree: Tree,
    /// The data that the field reads. It lives as long as somebody keeps it.
    pub data: Vec<Arc<dyn Data>>,
    /// The files that the data was read from, except for the model's own.
    pub files: Vec<PathBuf>,
    /// Box of the part in the model's frame, mm. Conservative by less than
    /// 10⁻⁴ mm.
    pub bounds: Bounds,
    /// Printer coordinates = coordinates of the model's frame + offset, mm.
    pub offset: DVec3,
    /// How much of the offset's height belongs to a raft and to the air above
    /// it, mm. Whatever lies below it is cut off.
    pub lift: f64,
    /// Place of the frame's origin in the coordinates in which the model was
    /// drawn (and turned and scaled), mm. It is 0, except for models that were
    /// drawn so far out that f32 has too few digits there.
    pub origin: DVec3,
    /// Area of the flat side on which the model was laid, mm², if it was.
    pub laid: Option<f64>,
    /// Parameters the script declares.
    pub parameters: Vec<Parameter>,
    /// What the user should know, in sentences.
    pub warnings: Vec<String>,
    /// Number of distinct operations, constants and variables.
    pub expression_size: usize,
}

impl Model {
    /// The box of the part in the coordinates in which it was drawn.
    pub fn drawn_bounds(&self) -> Bounds {
        self.bounds.moved(self.origin)
    }

    /// The model, higher above the bed.
    pub fn raised(&self, by: f64) -> Model {
        let mut raised = self.clone();
        raised.offset.z += by;
        raised.lift += by;
        raised
    }

    /// Height in the model's frame below which the model is cut off, mm: the
    /// bed, or the air above a raft.
    pub fn foot(&self) -> f64 {
        self.lift - self.offset.z
    }

    /// The box of the part on the printer.
    pub fn printed_bounds(&self) -> Bounds {
        self.bounds.moved(self.offset)
    }
}

/// How far a part may reach over the bed's edge. Bounds that were found may be
/// larger than the part by less than this.
const FIT_TOLERANCE_MM: f64 = 1e-3;

/// Bounds that may be off by more than this get a warning, mm: 0.05 of a usual
/// layer.
const SLACK_WARNING_MM: f64 = 0.01;

/// Parts smaller than this are most likely drawn in units other than mm.
const TINY_PART_MM: f64 = 3.0;

/// Places a model.
pub fn place(
    loaded: &Loaded,
    placement: &Placement,
    volume: BuildVolume,
) -> Result<Model, PlaceError> {
    check(placement)?;
    if let Some(height) = placement.height {
        let (raised, scale) = raised(loaded, placement, height)?;
        let placement = Placement {
            height: None,
            size: None,
            scale: Some(scale),
            ..*placement
        };
        return place(&raised, &placement, volume);
    }
    let mut warnings = loaded.notes.clone();

    // The size is that of the turned part, so the part is turned, then
    // measured, then scaled.
    let clipped = match &placement.bounds {
        None => loaded.tree.clone(),
        Some(bounds) => loaded.tree.max(box_field(bounds)),
    };
    let side = placement.lay.then(|| largest_side(&clipped)).transpose()?;
    let laid = side.map_or(DMat3::IDENTITY, |side| down(side.out));
    let turned = placement.rotate.iter().any(|a| a % 360.0 != 0.0)
        || laid != DMat3::IDENTITY;
    let rotation = rotation(placement.rotate) * laid;
    let found = if turned {
        let options = SearchOptions::default();
        find_bounds(&mapped(&clipped, rotation, 1.0), &options)?
    } else {
        let options = SearchOptions {
            within: placement.bounds,
            ..SearchOptions::default()
        };
        find_bounds(&loaded.tree, &options)?
    };
    let size = found.bounds.size();
    let scale = match (placement.scale, placement.size) {
        (Some(scale), _) => scale,
        (None, Some(wanted)) => wanted / size.max_element(),
        (None, None) => 1.0,
    };
    let mut tree = if turned || scale != 1.0 {
        mapped(&clipped, rotation, scale)
    } else {
        clipped
    };
    let bounds =
        Bounds::new(found.bounds.min * scale, found.bounds.max * scale);
    let expression_size = if tree.ptr_eq(&loaded.tree) {
        loaded.expression_size
    } else {
        expand(&tree)?.0.len()
    };
    if found.slack_mm * scale > SLACK_WARNING_MM {
        warnings.push(format!(
            "the part's extent is only known to {:.3} mm on its least \
             certain side: its size, and its place on the bed, may be off by \
             as much",
            found.slack_mm * scale
        ));
    }
    let largest = bounds.size().max_element();
    if largest < TINY_PART_MM
        && placement.scale.is_none()
        && placement.size.is_none()
    {
        warnings.push(format!(
            "the part is only {largest:.3} mm large; if it is drawn in other \
             units than millimetres, give --size or --scale (--scale 25.4 for \
             inches)"
        ));
    }
    if placement.keep_position && loaded.moved != DVec3::ZERO {
        return Err(PlaceError::TooFar {
            metres: loaded.moved.abs().max_element() / 1000.0,
        });
    }
    let offset = offset(&bounds, placement, volume)?;
    let origin = match far_out(&tree, &bounds, &mut warnings)? {
        Some((near, origin)) => {
            tree = near;
            origin
        }
        None => DVec3::ZERO,
    };
    if placement.keep_position {
        let foot = bounds.min.z;
        if foot < -FIT_TOLERANCE_MM {
            warnings.push(format!(
                "the part reaches {:.3} mm below the bed; that much of it is \
                 cut off (--keep-position)",
                -foot
            ));
        } else if foot > FIT_TOLERANCE_MM {
            warnings.push(format!(
                "the part floats {foot:.3} mm above the bed \
                 (--keep-position)"
            ));
        }
    }
    Ok(Model {
        name: loaded.name.clone(),
        tree,
        data: loaded.data.clone(),
        files: loaded.files.clone(),
        bounds: bounds.moved(-origin),
        offset: offset + origin,
        lift: 0.0,
        origin,
        laid: side.map(|side| side.area * scale * scale),
        parameters: loaded.parameters.clone(),
        warnings,
        expression_size,
    })
}

/// The box of {f < 0}, under the watch of this thread.
fn find_bounds(
    tree: &Tree,
    options: &SearchOptions,
) -> Result<FoundBounds, PlaceError> {
    let found = limits::doing("bounds", || {
        isocontour::find_bounds(tree, options, &limits::Watch::hook())
    });
    found.map_err(|error| alone(tree, &error).unwrap_or(error.into()))
}

/// Why data has no bounds if the model is nothing else. Of other models nobody
/// can tell that by what they are.
fn alone(tree: &Tree, error: &BoundsError) -> Option<PlaceError> {
    let is_vague = matches!(
        error,
        BoundsError::Undecided { .. }
            | BoundsError::Empty { .. }
            | BoundsError::EverythingInside { .. }
    );
    let Some(Solid::Data { data, place }) = solid(tree) else {
        return None;
    };
    let name = data.name().to_owned();
    let extent = data.extent(&place);
    match extent.map(|extent| extent.size().min_element()) {
        _ if !is_vague => None,
        Some(least) if least <= 0.0 => Some(PlaceError::FlatAlone { name }),
        None if !data.has_section() => Some(PlaceError::NumbersAlone { name }),
        _ => None,
    }
}

/// Moves the origin of a part that was drawn far from it, if that gives f32 the
/// digits that it lacks. Warns if there are still too few. `None` if the part
/// can stay as it is.
fn far_out(
    tree: &Tree,
    bounds: &Bounds,
    warnings: &mut Vec<String>,
) -> Result<Option<(Tree, DVec3)>, PlaceError> {
    /// Within this distance f32 tells 10⁻⁴ mm apart.
    const FAR_MM: f64 = 1000.0;
    /// The default accuracy of outlines, mm.
    const GOOD_MM: f64 = 0.005;
    let cancel = limits::Watch::hook();
    let far = bounds.min.abs().max(bounds.max.abs()).max_element();
    if far < FAR_MM {
        return Ok(None);
    }
    let here = digits(tree, bounds, &cancel).unwrap_or(0.0);
    // A whole number of millimetres is exact in f32, too.
    let origin = bounds.centre().round();
    let near = shifted(tree, origin)?;
    let moved = bounds.moved(-origin);
    let there = digits(&near, &moved, &cancel).unwrap_or(here);
    let gains = there < 0.5 * here;
    let left = if gains { there } else { here };
    if left > GOOD_MM {
        warnings.push(format!(
            "the part lies {:.0} m from the origin, where the 32 bits of a \
             number leave its surface uncertain by about {left:.3} mm: details \
             and thin places may be lost; draw it near the origin",
            far / 1000.0
        ));
    }
    Ok(gains.then_some((near, origin)))
}

/// A drawing raised to its height, and the scale at which the height is right.
fn raised(
    loaded: &Loaded,
    placement: &Placement,
    height: f64,
) -> Result<(Loaded, f64), PlaceError> {
    if !is_flat(&loaded.tree)? {
        return Err(PlaceError::HasHeight);
    }
    let up_to = |height: f64| {
        let z = Tree::z();
        let slab = (z.clone() - height as f32).max(-z);
        loaded.tree.max(slab)
    };
    let scale = match (placement.scale, placement.size) {
        (Some(scale), _) => scale,
        (None, Some(wanted)) => {
            let options = SearchOptions {
                within: placement.bounds,
                ..SearchOptions::default()
            };
            let size = find_bounds(&up_to(1.0), &options)?.bounds.size();
            wanted / size.x.max(size.y)
        }
        (None, None) => 1.0,
    };
    let raised = Loaded {
        tree: up_to(height / scale),
        ..loaded.clone()
    };
    Ok((raised, scale))
}

fn check(placement: &Placement) -> Result<(), PlaceError> {
    let positive = "must be a number above 0";
    for (option, value) in [
        ("--scale", placement.scale),
        ("--size", placement.size),
        ("--height", placement.height),
    ] {
        if let Some(value) = value
            && !(value > 0.0 && value.is_finite())
        {
            return Err(PlaceError::BadNumber {
                option,
                value,
                must: positive,
            });
        }
    }
    let finite = "must be a finite number";
    let angles = ["--rotate-x", "--rotate-y", "--rotate-z"];
    let at = placement.at.unwrap_or_default();
    for (option, value) in angles
        .into_iter()
        .zip(placement.rotate)
        .chain([("--at", at.0), ("--at", at.1)])
    {
        if !value.is_finite() {
            return Err(PlaceError::BadNumber {
                option,
                value,
                must: finite,
            });
        }
    }
    let conflict = |first, second| Err(PlaceError::Conflict { first, second });
    if placement.scale.is_some() && placement.size.is_some() {
        return conflict("--scale", "--size");
    }
    if placement.at.is_some() && placement.keep_position {
        return conflict("--at", "--keep-position");
    }
    Ok(())
}

fn offset(
    bounds: &Bounds,
    placement: &Placement,
    volume: BuildVolume,
) -> Result<DVec3, PlaceError> {
    let room = DVec3::new(volume.x, volume.y, volume.z);
    let offset = if placement.keep_position {
        DVec3::ZERO
    } else {
        let (x, y) = placement.at.unwrap_or((0.5 * room.x, 0.5 * room.y));
        let centre = bounds.centre();
        DVec3::new(x - centre.x, y - centre.y, -bounds.min.z)
    };
    let margin = DVec3::new(placement.margin, placement.margin, 0.0);
    let min = bounds.min + offset - margin;
    let max = bounds.max + offset + margin;
    if max.z <= 0.0 {
        return Err(PlaceError::BelowBed { top_mm: max.z });
    }
    let around = if placement.margin > FIT_TOLERANCE_MM {
        format!(
            ", with {:.2} mm around it for raft.expansion, xy_compensation and \
             fuzzy.thickness",
            placement.margin
        )
    } else {
        String::new()
    };
    // What lies below the bed is not printed and needs no room.
    let mut size = bounds.size() + 2.0 * margin;
    size.z = max.z - min.z.max(0.0);
    let too_large: Vec<String> = (0..3)
        .filter(|&i| size[i] > room[i] + FIT_TOLERANCE_MM)
        .map(|i| format!("{:.2} mm too {}", size[i] - room[i], LARGE[i]))
        .collect();
    if !too_large.is_empty() {
        return Err(PlaceError::TooLarge {
            size: sizes(size),
            volume: sizes(room),
            excess: too_large.join(", ") + &around,
        });
    }
    let mut beyond = Vec::new();
    for i in 0..3 {
        if i < 2 && min[i] < -FIT_TOLERANCE_MM {
            beyond.push(format!("{:.2} mm at -{}", -min[i], AXES[i]));
        }
        if max[i] > room[i] + FIT_TOLERANCE_MM {
            beyond.push(format!("{:.2} mm at +{}", max[i] - room[i], AXES[i]));
        }
    }
    if !beyond.is_empty() {
        return Err(PlaceError::OffBed {
            excess: beyond.join(", ") + &around,
        });
    }
    Ok(offset)
}

const AXES: [&str; 3] = ["x", "y", "z"];
const LARGE: [&str; 3] = ["wide (x)", "deep (y)", "high (z)"];

fn sizes(v: DVec3) -> String {
    format!("{:.2} × {:.2} × {:.2}", v.x, v.y, v.z)
}
