//! `isoslice info`: shows what a model is, without slicing it. Plate files are
//! the matter of `plate_info`.

use super::args::{Gathered, ModelArgs, SettingsSource};
use super::limits::LimitArgs;
use super::rows::{Rows, counted};
use super::{plain, print_json, terminal};
use anyhow::Context;
use clap::Args;
use glam::DVec3;
use isoslice::heights::{Heights, Steps, heights};
use isoslice::model::{Bounds, Model, Parameter};
use isoslice::{OverhangKind, Survey, Unsupported, survey};
use serde::Serialize;
use std::fmt::Write as _;

const EXAMPLES: &str = "\
Examples:
  isoslice info part.rhai
  isoslice info part.rhai --supports
  isoslice info plate.toml
  isoslice info part.vm --size 60 --set layer_height=0.1";

/// Arguments of `isoslice info`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice info [OPTIONS] <MODEL>\n       \
                      isoslice info [OPTIONS] -e <FORMULA>"
)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    pub(super) model: ModelArgs,
    #[command(flatten)]
    pub(super) settings: SettingsSource,
    #[command(flatten)]
    pub(super) limits: LimitArgs,

    /// Also list what would need supports, place by place
    #[arg(long, help_heading = "Output")]
    pub(super) supports: bool,

    /// Print JSON
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
}

/// Shows a model.
pub(super) fn show(args: &InfoArgs, gathered: &Gathered) -> anyhow::Result<()> {
    let settings = &gathered.settings;
    let model = args.model.load(settings)?;
    terminal::warn(&model.warnings);
    let survey = if args.supports {
        let found = survey(&model, settings, None).with_context(|| {
            format!("cannot look at what hangs in {}", model.name)
        })?;
        terminal::warn(&found.warnings(settings));
        Some(found)
    } else {
        None
    };
    if args.json {
        let mut warnings = [&gathered.warnings[..], &model.warnings].concat();
        if let Some(found) = &survey {
            warnings.extend(found.warnings(settings));
        }
        let mut json = Json::new(&model, gathered, warnings)?;
        json.needs_support = survey.as_ref().map(SupportsJson::new);
        return print_json(&json);
    }
    let mut rows = describe(&model, gathered)?;
    if let Some(found) = &survey {
        describe_supports(found, &mut rows);
    }
    plain::print(&rows.text)
}

/// The keys of `--json`.
#[derive(Serialize)]
struct Json<'a> {
    model: &'a str,
    size_mm: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    laid_mm2: Option<f64>,
    bounds_mm: [[f64; 3]; 2],
    on_the_bed_mm: [[f64; 3]; 2],
    /// Number of planned layers. A last layer in which nothing is as thick as a
    /// line is not printed.
    layer_count: usize,
    layer_height_mm: f64,
    first_layer_height_mm: f64,
    /// A summary of layers of different heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Steps>,
    operations: usize,
    parameters: Vec<JsonParameter<'a>>,
    /// The places that need supports, with `--supports`.
    #[serde(skip_serializing_if = "Option::is_none")]
    needs_support: Option<SupportsJson>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct JsonParameter<'a> {
    name: &'a str,
    value: serde_json::Value,
    default: serde_json::Value,
    #[serde(rename = "type")]
    kind: &'static str,
    description: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    choices: Vec<serde_json::Value>,
}

impl<'a> Json<'a> {
    fn new(
        model: &'a Model,
        Gathered { settings, .. }: &Gathered,
        warnings: Vec<String>,
    ) -> anyhow::Result<Self> {
        let corners = |b: Bounds| [b.min.to_array(), b.max.to_array()];
        let raised = model.raised(settings.raft_height());
        let Heights { spans, steps } = heights(&raised, settings)?;
        Ok(Json {
            model: &model.name,
            size_mm: model.bounds.size().to_array(),
            laid_mm2: model.laid,
            bounds_mm: corners(model.drawn_bounds()),
            on_the_bed_mm: corners(raised.printed_bounds()),
            layer_count: spans.len(),
            layer_height_mm: settings.thickest_layer(),
            first_layer_height_mm: settings.bed_layer_height(),
            steps,
            operations: model.expression_size,
            parameters: model.parameters.iter().map(parameter).collect(),
            needs_support: None,
            warnings,
        })
    }
}

/// A parameter as JSON.
pub(super) fn parameter(of_model: &Parameter) -> JsonParameter<'_> {
    // Numbers and booleans are written alike in Rhai and JSON; all else is
    // text.
    let json = |text: &str| {
        serde_json::from_str(text)
            .unwrap_or_else(|_| serde_json::Value::from(text))
    };
    JsonParameter {
        name: &of_model.name,
        value: json(&of_model.value),
        default: json(&of_model.default),
        kind: match json(&of_model.default) {
            serde_json::Value::Bool(_) => "boolean",
            _ if of_model.counts => "integer",
            _ => "number",
        },
        description: &of_model.description,
        min: of_model.allowed.min,
        max: of_model.allowed.max,
        step: of_model.allowed.step,
        choices: of_model.allowed.choices.iter().map(|c| json(c)).collect(),
    }
}

/// Adds the lines about layers of different heights. If their `count` is given, it is
/// compared with that of uniform layers.
pub(super) fn describe_steps(
    steps: &Steps,
    count: Option<usize>,
    rows: &mut Rows,
) {
    let line = format!(
        "{:.3} to {:.3} mm, steps of up to {:.3} mm (99 % of the layers: {:.3}), \
         first layer aside",
        steps.thinnest_mm,
        steps.thickest_mm,
        steps.step_max_mm,
        steps.step_p99_mm,
    );
    rows.add("heights", line);
    let uniform = steps.uniform_layers;
    let count = count.unwrap_or(uniform);
    let change = count.abs_diff(uniform);
    let share = 100.0 * change as f64 / uniform as f64;
    let word = if count < uniform { "fewer" } else { "more" };
    if change > 0 {
        let line = format!(
            "{change} layers {word} than with layer_heights = \"uniform\" \
             ({share:.0} %)"
        );
        rows.add("", line);
    }
    if steps.missed_faces > 0 {
        let line = format!(
            "{} level faces lie too close to another one for a layer to end \
             there; lower layer_height_min",
            steps.missed_faces
        );
        rows.add("", line);
    }
    let unknown = steps.unknown_mm;
    if unknown > 0.0 {
        let line = format!(
            "over {unknown:.2} mm of the height layers are as thin as for a level \
             surface, since nothing is proved of the surface there: that takes more \
             work than is spent on it, or the surface is one of a mesh that stays \
             open, is bent or blended, or of a function with kinks; layer_heights = \
             \"expr: …\" gives heights instead"
        );
        rows.add("", line);
    }
    let doubtful = steps.unproved_mm - unknown;
    if doubtful > 0.0 {
        let line = format!(
            "over {doubtful:.2} mm of the height too little is proved of the \
             surface: layers may be thinner than they need to be, or steps smaller \
             than said"
        );
        rows.add("", line);
    }
}

/// The places that would need supports.
#[derive(Serialize)]
pub(super) struct SupportsJson {
    area_mm2: f64,
    begins_on_nothing_mm2: f64,
    leans_mm2: f64,
    long_bridges_mm2: f64,
    places: Vec<PlaceJson>,
}

#[derive(Serialize)]
struct PlaceJson {
    kind: &'static str,
    area_mm2: f64,
    from_z_mm: f64,
    to_z_mm: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    reach_mm: Option<f64>,
    at_mm: [f64; 3],
}

impl SupportsJson {
    pub(super) fn new(survey: &Survey) -> SupportsJson {
        let place = |place: &Unsupported| PlaceJson {
            kind: match place.kind {
                OverhangKind::Begins => "begins_on_nothing",
                OverhangKind::Leans => "leans",
                OverhangKind::Bridge => "long_bridge",
            },
            area_mm2: place.area,
            from_z_mm: place.from,
            to_z_mm: place.to,
            reach_mm: (place.kind != OverhangKind::Begins)
                .then_some(place.reach),
            at_mm: place.at.to_array(),
        };
        SupportsJson {
            area_mm2: survey.places.iter().map(|place| place.area).sum(),
            begins_on_nothing_mm2: area_of(survey, OverhangKind::Begins),
            leans_mm2: area_of(survey, OverhangKind::Leans),
            long_bridges_mm2: area_of(survey, OverhangKind::Bridge),
            places: survey.places.iter().map(place).collect(),
        }
    }
}

/// Content of the places of a kind.
fn area_of(survey: &Survey, kind: OverhangKind) -> f64 {
    let places = survey.places.iter().filter(|place| place.kind == kind);
    places.map(|place| place.area).sum()
}

/// Adds the lines about what would need supports.
pub(super) fn describe_supports(survey: &Survey, rows: &mut Rows) {
    /// Greatest number of places that are listed. Lattices have thousands of
    /// small ones.
    const TOLD: usize = 30;
    let area: f64 = survey.places.iter().map(|place| place.area).sum();
    if survey.places.is_empty() {
        return rows.add("supports", "nothing needs any");
    }
    let count = survey.places.len();
    let places = counted(count, "place");
    rows.add("supports", format!("{area:.1} mm² in {places} need some"));
    // The largest ones, in the order of their heights.
    let mut order: Vec<usize> = (0..count).collect();
    let content = |k: &usize| survey.places[*k].area;
    order.sort_by(|a, b| content(b).total_cmp(&content(a)));
    order.truncate(TOLD);
    order.sort_unstable();
    for k in order {
        let unsupported = &survey.places[k];
        let Unsupported {
            area,
            from,
            to,
            reach,
            ..
        } = *unsupported;
        let what = match unsupported.kind {
            OverhangKind::Begins => "begins on nothing".to_owned(),
            OverhangKind::Leans => format!("leans, reach {reach:.1} mm"),
            OverhangKind::Bridge => format!("bridge of {reach:.1} mm"),
        };
        let heights = if to > from {
            format!("z = {from:.2} to {to:.2}")
        } else {
            format!("z = {from:.2}")
        };
        let at = place(unsupported.at);
        rows.plain(format!("    {area:>8.1} mm²  {heights}, {what}, at {at}"));
    }
    if count > TOLD {
        rows.plain(format!("    and {} smaller ones (--json)", count - TOLD));
    }
    if let Some(set) = survey.supports {
        rows.add(
            "",
            format!(
                "supports = \"{set}\" is set: slice the part to learn what \
                 supports cost, and what none reaches"
            ),
        );
    }
}

fn describe(
    model: &Model,
    Gathered { settings, .. }: &Gathered,
) -> anyhow::Result<Rows> {
    let raised = model.raised(settings.raft_height());
    let Heights { spans, steps } = heights(&raised, settings)?;
    let layers = spans.len();
    let mut rows = Rows::default();
    rows.plain(plain::line(&model.name));
    rows.add("size", dimensions(model.bounds.size()));
    if let Some(area) = model.laid {
        rows.add("lies on", flat_side(area));
    }
    rows.add("bounds", corners(&model.drawn_bounds()));
    rows.add("on the bed", corners(&raised.printed_bounds()));
    let planned = format!("{layers} planned");
    match steps {
        None => {
            let height = settings.layer_height();
            rows.add("layers", format!("{planned}, of {height} mm"));
        }
        Some(steps) => {
            rows.add("layers", planned);
            describe_steps(&steps, Some(layers), &mut rows);
        }
    }
    let operations = model.expression_size;
    rows.add("expression", format!("{operations} operations"));
    if !model.parameters.is_empty() {
        rows.plain("  parameters (set with -D name=value)");
    }
    let names: Vec<_> = model
        .parameters
        .iter()
        .map(|p| plain::line(&p.name))
        .collect();
    let width = names.iter().map(|name| name.chars().count()).max();
    let width = width.unwrap_or(0);
    for (name, parameter) in names.iter().zip(&model.parameters) {
        let mut line = format!("    {name:<width$} = {}", parameter.value);
        if parameter.value != parameter.default {
            write!(line, " (default {})", parameter.default)?;
        }
        if !parameter.allowed.is_anything() {
            write!(line, " ({})", parameter.allowed)?;
        }
        match &*plain::line(&parameter.description) {
            "" => {}
            description => write!(line, "  {description}")?,
        }
        rows.plain(line);
    }
    Ok(rows)
}

/// Writes `60.00 × 40.00 × 12.50 mm`.
pub(super) fn dimensions(size: DVec3) -> String {
    format!("{:.2} × {:.2} × {:.2} mm", size.x, size.y, size.z)
}

/// The flat side on which a part was laid.
pub(super) fn flat_side(area: f64) -> String {
    format!("a flat side of {area:.1} mm²")
}

/// A place, as lines of results name it.
pub(super) fn place(p: DVec3) -> String {
    format!("x = {:.1}, y = {:.1}, z = {:.2} mm", p.x, p.y, p.z)
}

fn corners(bounds: &Bounds) -> String {
    let corner = |p: DVec3| {
        // Adding zero makes −0 a plain 0. Rounding first does so for −0.001,
        // too.
        let p = (p * 100.0).round() / 100.0 + 0.0;
        format!("({:.2}, {:.2}, {:.2})", p.x, p.y, p.z)
    };
    format!("{} to {} mm", corner(bounds.min), corner(bounds.max))
}
