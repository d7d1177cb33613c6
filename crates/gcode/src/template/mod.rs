//! Templates: the user's own lines at the start and the end of a file and of
//! each layer.
//!
//! In: text in the syntax of Jinja, by minijinja: `{{ bed_temperature }}`,
//! `{{ (layer_height * 2) | round(2) }}`, `{% if bed_temperature > 90 %}`.
//! Out: G-code. [`PLACEHOLDERS`](super::PLACEHOLDERS) is the list of names.
//!
//! Guarantees: an unknown name is an error with its place, also in a branch
//! that is not taken, and so are a control character and a placeholder of another
//! slicer. All templates are tried before the first line is written. Numbers
//! are written as firmware reads them. A template can neither read files nor
//! run for ever, nor take much memory.

mod control;
mod depth;
mod engine;
mod error;
mod foreign;
mod line_ends;
mod pieces;
#[cfg(test)]
mod tests;
mod tokens;

pub use error::TemplateError;

use super::Header;
use super::placeholders::{self, Known, Moment, Scope};
use super::plan::WriterPlan;
use super::{Totals, flavour};
use control::control;
use depth::too_deep;
use engine::engine;
use error::{error, failure, unknown_name};
use foreign::foreign;
use line_ends::with_line_ends;
use minijinja::{Environment, Value};
use pieces::{find, pieces};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Stack on which templates are filled in. It is reserved, but used only by
/// lists of lists: `FUEL` of `engine` pays for 200,000 levels, each of which takes
/// 400 bytes when the list is dropped, and up to 1 kB when it is compared.
const STACK_BYTES: usize = 256 << 20;

/// Greatest length of a filled-in template, bytes.
const LONGEST: usize = 1 << 20;

/// Names of the settings that hold templates.
const START: &str = "gcode.start";
const END: &str = "gcode.end";
const LAYER: &str = "gcode.layer";

/// A print's templates.
#[derive(Debug)]
pub(super) struct Templates<'a> {
    engine: Environment<'static>,
    plan: WriterPlan<'a>,
    header: Header,
    /// Values that every template knows.
    known: BTreeMap<String, Value>,
    start: Source<'a>,
    end: Source<'a>,
    layer: Source<'a>,
}

/// A template's text.
#[derive(Debug)]
struct Source<'a> {
    name: &'static str,
    scope: Scope,
    /// The text, with marks that keep the ends of its lines.
    text: Cow<'a, str>,
}

impl<'a> Source<'a> {
    fn new(
        name: &'static str,
        scope: Scope,
        written: &'a str,
    ) -> Result<Self, TemplateError> {
        if let Some((at, message)) = control(written) {
            return Err(error(name, written, at, message));
        }
        if let Some((at, message)) = foreign(written, &pieces(written), scope) {
            return Err(error(name, written, at, message));
        }
        Ok(Source {
            name,
            scope,
            text: with_line_ends(written),
        })
    }

    /// The error for a mistake at the byte `at` of the text.
    fn error(&self, at: usize, message: String) -> TemplateError {
        error(self.name, &self.text, at, message)
    }

    /// The error for an error of the engine.
    fn failure(&self, failed: &minijinja::Error) -> TemplateError {
        match failure(failed) {
            (Some(at), message) => self.error(at, message),
            (None, message) => TemplateError {
                template: self.name,
                line: failed.line().unwrap_or(1),
                column: 1,
                message,
            },
        }
    }
}

impl<'a> Templates<'a> {
    /// Reads and tries the templates of `plan`.
    pub(super) fn new(
        plan: &WriterPlan<'a>,
        header: &Header,
    ) -> Result<Self, TemplateError> {
        let [start, end, layer] = plan.templates;
        let own = |text: &'a str, default| {
            // The text may have been pasted with a file's byte-order mark.
            let text = text.trim_start_matches('\u{feff}');
            if text.trim().is_empty() {
                default
            } else {
                text
            }
        };
        let start = own(start, flavour::START);
        let end = own(end, flavour::END);
        let layer = own(layer, "");
        let mut known = placeholders::of_settings(plan);
        let of_all = Known {
            plan,
            header,
            moment: Moment::default(),
            totals: Totals::default(),
        };
        known.extend(placeholders::of(Scope::All, &of_all));
        let start = Source::new(START, Scope::All, start)?;
        let engine = engine().map_err(|e| start.failure(&e))?;
        let mut templates = Self {
            engine,
            plan: plan.clone(),
            header: Header {
                thumbnails: Vec::new(),
                parts: Vec::new(),
                ..header.clone()
            },
            known,
            start,
            end: Source::new(END, Scope::End, end)?,
            layer: Source::new(LAYER, Scope::Layer, layer)?,
        };
        for source in [&templates.start, &templates.end, &templates.layer] {
            add(&mut templates.engine, source)?;
        }
        templates.try_end()?;
        templates.layer(Moment::of_trial(plan))?;
        Ok(templates)
    }

    /// The start template.
    pub(super) fn start_source(&self) -> &str {
        &self.start.text
    }

    /// The start template, filled in.
    pub(super) fn start(&self) -> Result<String, TemplateError> {
        self.render(&self.start, Moment::default(), Totals::default())
    }

    /// The layer template, filled in; nothing if there is none.
    pub(super) fn layer(
        &self,
        moment: Moment,
    ) -> Result<Option<String>, TemplateError> {
        let layer = &self.layer;
        (!layer.text.is_empty())
            .then(|| self.render(layer, moment, Totals::default()))
            .transpose()
    }

    /// The end template, filled in with made-up totals, none of which is 0: a
    /// template may divide by them.
    pub(super) fn try_end(&self) -> Result<String, TemplateError> {
        self.end(Totals {
            filament_length: 1000.0,
            filament_volume: 2400.0,
            filament_mass_g: 3.0,
            time: 600.0,
            layers: self.header.layer_count.max(1),
            height: 1.0,
        })
    }

    /// The end template, filled in.
    pub(super) fn end(&self, totals: Totals) -> Result<String, TemplateError> {
        self.render(&self.end, Moment::default(), totals)
    }

    fn render(
        &self,
        source: &Source<'_>,
        moment: Moment,
        totals: Totals,
    ) -> Result<String, TemplateError> {
        let (name, scope) = (source.name, source.scope);
        let now = Known {
            plan: &self.plan,
            header: &self.header,
            moment,
            totals,
        };
        let mut values = self.known.clone();
        if scope != Scope::All {
            values.extend(placeholders::of(scope, &now));
        }
        // An error of the engine holds values, so it must not leave the thread.
        let fill_in = || {
            let template = self.engine.get_template(name);
            let rendered = template.and_then(|t| t.render(values));
            rendered.map_err(|e| source.failure(&e))
        };
        let rendered = on_deep_stack(fill_in)
            .unwrap_or_else(|message| Err(source.error(0, message)))?;
        if rendered.len() > LONGEST {
            let message = format!(
                "it comes to more than {} MB of text; make it shorter",
                LONGEST >> 20
            );
            return Err(source.error(0, message));
        }
        // The value of an expression may hold a control character, too.
        if let Some((at, message)) = control(&rendered) {
            let line = rendered[..at].matches('\n').count() + 1;
            let message =
                format!("line {line} of the filled-in text: {message}");
            return Err(source.error(0, message));
        }
        let mut out = String::with_capacity(rendered.len() + 1);
        for line in rendered.lines() {
            out.push_str(line.trim_end());
            out.push('\n');
        }
        Ok(out)
    }
}

/// Does work that may recurse deeply, on a thread of its own.
fn on_deep_stack<T: Send>(
    work: impl FnOnce() -> T + Send,
) -> Result<T, String> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new()
            .name("template".to_owned())
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, work)
            .map_err(|_| {
                format!(
                    "it needs a thread and {} MB of address space for its \
                     stack; raise what the system allows (ulimit -v, ulimit -u)",
                    STACK_BYTES >> 20
                )
            })?;
        thread
            .join()
            .or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Number of unknown names among which the first one in the text is looked for.
const FEW: usize = 100;

/// Reads a template and looks for unknown names.
fn add(
    engine: &mut Environment<'static>,
    source: &Source<'_>,
) -> Result<(), TemplateError> {
    let failed = |e| source.failure(&e);
    let (name, text) = (source.name, &*source.text);
    let pieces = pieces(text);
    if let Some((at, message)) = too_deep(text, &pieces) {
        return Err(source.error(at, message));
    }
    engine
        .add_template_owned(name, text.to_owned())
        .map_err(failed)?;
    let template = engine.get_template(name).map_err(failed)?;
    let globals: Vec<&str> = engine.globals().map(|(name, _)| name).collect();
    let known: Vec<&str> = placeholders::names(source.scope).collect();
    let is_known = |used: &str| {
        let group = |k: &&str| k.split('.').next() == Some(used);
        globals.contains(&used)
            || known.contains(&used)
            || known.iter().any(group)
    };
    let mut unknown: Vec<String> = template
        .undeclared_variables(true)
        .into_iter()
        .filter(|used| !is_known(used))
        .collect();
    // The error is about the first unknown name in the text. Each name is
    // searched for in the whole text. So if there are very many, only the first
    // ones of the alphabet are searched for.
    unknown.sort();
    unknown.truncate(FEW);
    let place = |used: &String| (find(text, &pieces, used), used.clone());
    let first = unknown.iter().map(place).min();
    match first {
        Some((at, used)) => {
            Err(source.error(at, unknown_name(&used, source.scope)))
        }
        None => Ok(()),
    }
}

/// Tries the templates of a plan on a part in the middle of the bed: what is
/// wrong with each of them.
pub fn try_templates(plan: &WriterPlan<'_>) -> Vec<TemplateError> {
    let (x, y) = (plan.printer.bed_x / 2.0, plan.printer.bed_y / 2.0);
    let header = Header {
        model_name: String::from("part"),
        layer_count: 100,
        layers: 0..100,
        timestamp: None,
        nozzle_temperature: plan.nozzle_temperatures.0,
        part_min: glam::DVec3::new(x - 10.0, y - 10.0, 0.0),
        part_max: glam::DVec3::new(x + 10.0, y + 10.0, 20.0),
        parts: Vec::new(),
        thumbnails: Vec::new(),
        format: super::Format::Text,
        fingerprint: None,
        one_by_one: false,
    };
    let alone = |i: usize| {
        let mut one = plan.clone();
        one.templates = [""; 3];
        one.templates[i] = plan.templates[i];
        let filled = Templates::new(&one, &header).and_then(|t| t.start());
        filled.err()
    };
    (0..plan.templates.len()).filter_map(alone).collect()
}

/// True if a template of this setting knows a placeholder.
pub fn is_placeholder(template: &str, name: &str) -> bool {
    let scope = match template {
        LAYER => Scope::Layer,
        END => Scope::End,
        _ => Scope::All,
    };
    placeholders::names(scope).any(|known| known == name)
}
