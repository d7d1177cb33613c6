//! `isoslice info` of plate files: what is on a plate, and where.

use super::info::{
    self, InfoArgs, SupportsJson, describe_supports, dimensions,
};
use super::limits::watched;
use super::plates::{self, PlateArgs};
use super::rows::Rows;
use super::{plain, print_json, terminal};
use anyhow::Context;
use isoslice::heights::heights;
use isoslice::plate::{Part, Plate};
use isoslice::{Survey, survey};
use serde::Serialize;

/// Shows what a plate file or a model is.
pub(super) fn run(args: &InfoArgs) -> anyhow::Result<()> {
    // Only a survey makes outlines, which tell whether it makes progress.
    let watch = if args.supports {
        args.limits.slicing_watch()
    } else {
        args.limits.watch()
    };
    watched(&watch, || {
        let gathered = args.settings.gather()?;
        let alone = PlateArgs::default();
        let sets = &args.settings.set;
        let file = plates::file(&args.model, &alone, &gathered, sets)?;
        if file.is_none() {
            return info::show(args, &gathered);
        }
        let job = alone.job(&args.model, file, &gathered)?;
        let mut warnings = job.warnings;
        warnings.retain(|w| !gathered.warnings.contains(w));
        show(args, &job.plate, &gathered.warnings, warnings)
    })
}

/// Shows a plate. `told` are warnings that the user knows.
fn show(
    args: &InfoArgs,
    plate: &Plate,
    told: &[String],
    mut warnings: Vec<String>,
) -> anyhow::Result<()> {
    let mut parts = Vec::new();
    for part in &plate.parts {
        let of_model = part.model.warnings.iter();
        warnings.extend(of_model.map(|w| format!("{}: {w}", part.model.name)));
        let found = args.supports.then(|| survey_of(part)).transpose()?;
        if let Some(found) = &found {
            let all = found.warnings(&part.settings);
            let named = |w| format!("{}: {w}", part.model.name);
            warnings.extend(all.into_iter().map(named));
        }
        parts.push((PartJson::new(part)?, found));
    }
    terminal::warn(&warnings);
    let order = plate.order();
    if args.json {
        let parts = parts.into_iter().map(|(mut json, found)| {
            json.needs_support = found.as_ref().map(SupportsJson::new);
            json
        });
        return print_json(&Json {
            plate: &plate.name,
            size_mm: plate.size().to_array(),
            parts: parts.collect(),
            order,
            warnings: [told, &warnings].concat(),
        });
    }
    let mut rows = Rows::default();
    rows.plain(plain::line(&plate.name));
    rows.add("size", dimensions(plate.size()));
    rows.add("parts", plate.place_count());
    if let Some(order) = order {
        let order = order.join(", ");
        rows.add("one by one", plain::line(&order));
    }
    for ((json, found), part) in parts.iter().zip(&plate.parts) {
        let copies = match part.places.len() {
            1 => String::new(),
            count => format!(", {count} times"),
        };
        rows.plain(plain::line(json.model) + &*copies);
        rows.add("size", dimensions(part.model.bounds.size()));
        rows.add("layers", format!("{} planned", json.layer_count));
        rows.add("expression", format!("{} operations", json.operations));
        for place in &json.places {
            let [x, y] = place.at_mm;
            let name = plain::line(place.name);
            rows.plain(format!("  at          {x:.2}, {y:.2} mm  {name}"));
        }
        if let Some(found) = found {
            describe_supports(found, &mut rows);
        }
    }
    plain::print(&rows.text)
}

fn survey_of(part: &Part) -> anyhow::Result<Survey> {
    survey(&part.model, &part.settings, None)
        .with_context(|| format!("cannot look at {}", part.model.name))
}

/// The keys of `--json`.
#[derive(Serialize)]
struct Json<'a> {
    plate: &'a str,
    size_mm: [f64; 3],
    parts: Vec<PartJson<'a>>,
    /// Names in the order in which they are printed one by one.
    #[serde(skip_serializing_if = "Option::is_none")]
    order: Option<Vec<&'a str>>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct PartJson<'a> {
    model: &'a str,
    size_mm: [f64; 3],
    layer_count: usize,
    operations: usize,
    places: Vec<PlaceJson<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    needs_support: Option<SupportsJson>,
}

#[derive(Serialize)]
struct PlaceJson<'a> {
    name: &'a str,
    /// The middle of the part's box on the bed.
    at_mm: [f64; 2],
}

impl<'a> PartJson<'a> {
    fn new(part: &'a Part) -> anyhow::Result<Self> {
        let model = &part.model;
        let raised = model.raised(part.settings.raft_height());
        let layers = heights(&raised, &part.settings)
            .with_context(|| model.name.clone())?;
        let bounds = model.printed_bounds();
        let middle = bounds.centre().truncate();
        let rounded = |x: f64| (x * 1e3).round() / 1e3;
        let places = part.places.iter().map(|place| PlaceJson {
            name: &place.name,
            at_mm: (middle + place.shift).to_array().map(rounded),
        });
        Ok(PartJson {
            model: &model.name,
            size_mm: model.bounds.size().to_array(),
            layer_count: layers.spans.len(),
            operations: model.expression_size,
            places: places.collect(),
            needs_support: None,
        })
    }
}
