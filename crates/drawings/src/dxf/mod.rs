//! DXF files as drawings.
//!
//! A DXF has lines and no areas: they are joined at their ends to rings, and what an
//! odd number of rings go round is the area.
//!
//! | file | what it does |
//! |---|---|
//! | `pairs` | group codes, values and records |
//! | `file` | units, layers, blocks and entities |
//! | `walk` | which entities are drawn, and where |
//! | `shape`, `spline`, `pen` | entities as curves |
//! | `join` | lines as rings |
//! | `same` | rings that are drawn twice |

mod cells;
mod file;
mod join;
mod pairs;
mod pen;
mod same;
mod shape;
mod spline;
#[cfg(test)]
mod tests;
mod walk;

use crate::drawing::{Drawing, small_enough};
use crate::left_out::not_drawn;
use crate::place::{Anchor, place_all};
use file::{File, folded, millimetres};
use isoslice_base::problem::{NamedProblem, Problem};
use isoslice_base::units::human_number;
use pairs::shown;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use walk::Walk;

/// How far ends of lines may be apart that are joined, mm. Numbers of 3 digits in
/// mm, and of 4 in inches, are rounded by so much that ends may be 3.6 µm apart.
/// Nothing that is printed is as small.
const GAP: f64 = 0.005;

/// The gaps that users may allow, mm.
const GAPS: RangeInclusive<f64> = 0.0..=1.0;

/// What is said of lines that hold no area.
const NO_AREA: &str = "what an odd number of outlines go round is solid, so close \
    the outlines, and draw each once";

/// The units that users may name, mm.
const UNITS: RangeInclusive<f64> = 1e-6..=1e6;

/// How a DXF is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DxfOptions {
    /// The width of the box around the area, mm. Without it, it follows from
    /// the height; without either, the file's own size counts.
    pub width_mm: Option<f64>,
    /// The height of the box around the area, mm.
    pub height_mm: Option<f64>,
    /// What lies at the origin.
    pub anchor: Anchor,
    /// How many mm the file's unit has, if the file does not say so.
    pub unit_mm: Option<f64>,
    /// The names of the layers to read, if not all that are on.
    pub layers: Option<Vec<String>>,
    /// How far ends of lines may be apart that are joined, mm: 0.005 if it is not
    /// said.
    pub gap_mm: Option<f64>,
}

impl Drawing {
    /// Reads a DXF file: lines, arcs, circles, ellipses, polylines, splines and
    /// blocks of them. What is no line, such as texts, is left out and named in the
    /// [warnings](Drawing::warnings).
    ///
    /// # Errors
    /// If the file is no DXF in text, broken, without an area or too large, if an
    /// outline is not closed, or if an option makes no sense.
    pub fn from_dxf(
        name: &str,
        bytes: &[u8],
        options: &DxfOptions,
    ) -> Result<Drawing, NamedProblem> {
        read(name, bytes, options)
            .map_err(|problem| NamedProblem::new(name, problem))
    }
}

fn read(name: &str, bytes: &[u8], options: &DxfOptions) -> Problem<Drawing> {
    let text = text(bytes)?;
    let file = File::read(&text)?;
    let layers = layers(&file, options)?;
    let (unit, note) = unit(&file, options)?;
    let gap = options.gap_mm.unwrap_or(GAP);
    if !GAPS.contains(&gap) {
        let gap = human_number(gap);
        return Err(format!("its gap is {gap} mm; give one from 0 to 1"));
    }
    let mut walk = Walk::new(&file, layers);
    walk.all(unit)?;
    let mut warnings = not_drawn(walk.left_out);
    if walk.lines.is_empty() {
        let all = warnings.join("; ");
        let left_out = if all.is_empty() { "" } else { "; " };
        return Err(format!("no line is drawn in it{left_out}{all}"));
    }
    let (outline, twice) = join::rings(walk.lines, gap)?;
    warnings.extend(twice);
    warnings.extend(note);
    let mut outlines = [outline];
    let sized = [options.width_mm, options.height_mm];
    place_all(&mut outlines, sized, options.anchor)?;
    Drawing::warned(format!("dxf({name:?})"), &outlines, warnings, NO_AREA)
}

/// The text of a file.
fn text(bytes: &[u8]) -> Problem<Cow<'_, str>> {
    small_enough(bytes)?;
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err("it is a binary DXF; save it as DXF in text (ASCII)".into());
    }
    if bytes.starts_with(b"AC10") {
        return Err("it is a DWG; save it as DXF in text (ASCII)".into());
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Old files are in one of Windows' encodings, which only names of layers and
    // blocks show.
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    })
}

/// The folded names of the layers to read, all of which are in the file.
fn layers(
    file: &File<'_>,
    options: &DxfOptions,
) -> Problem<Option<BTreeSet<String>>> {
    /// Layers that are named in a message.
    const NAMED: usize = 20;
    let Some(wanted) = &options.layers else {
        return Ok(None);
    };
    let names = file.layer_names()?;
    let known: BTreeSet<String> = names.iter().map(|n| folded(n)).collect();
    let is_known = |name: &&String| known.contains(&folded(name));
    if let Some(name) = wanted.iter().find(|name| !is_known(name)) {
        let all: Vec<String> =
            names.iter().take(NAMED).map(|name| shown(name)).collect();
        let more = if names.len() > NAMED { ", …" } else { "" };
        return Err(format!(
            "it has no layer {}; it has {}{more}",
            shown(name),
            all.join(", ")
        ));
    }
    Ok(Some(wanted.iter().map(|name| folded(name)).collect()))
}

/// How many mm the file's unit has, and what its user should know of it.
fn unit(
    file: &File<'_>,
    options: &DxfOptions,
) -> Problem<(f64, Option<String>)> {
    if let Some(unit) = options.unit_mm {
        if !UNITS.contains(&unit) {
            let unit = human_number(unit);
            return Err(format!(
                "its unit is {unit} mm; give one from 0.000001 to 1000000"
            ));
        }
        return Ok((unit, None));
    }
    if let Some(unit) = millimetres(file.unit)? {
        return Ok((unit, None));
    }
    let is_sized = options.width_mm.or(options.height_mm).is_some();
    let note = "it names no unit, so its numbers are taken as mm; unit says \
                how many mm its unit has (25.4 for inches)";
    Ok((1.0, (!is_sized).then(|| note.into())))
}
