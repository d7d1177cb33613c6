//! Templates: the user's own lines at the start and the end of a file and of
//! each layer.
//!
//! In: text in the syntax of Jinja, by minijinja: `{{ bed_temperature }}`,
//! `{{ (layer_height * 2) | round(2) }}`, `{% if bed_temperature > 90 %}`.
//! Out: G-code. [`PLACEHOLDERS`](super::PLACEHOLDERS) is the list of names.
//!
//! Guarantees: a name nobody knows is an error that says where, also in a
//! branch that is not taken, and so is a placeholder in another slicer's
//! brackets, and a control character; nothing is left out silently. All templates are tried before the
//! first line is written. Numbers are written as firmware reads them. A
//! template can neither read files nor run for ever, nor take much memory
//! (see [`bounded`](super::bounded)).

mod control;
mod engine;
mod error;
mod pieces;
#[cfg(test)]
mod tests;

pub use error::TemplateError;

use super::Header;
use super::bounded::bounded;
use super::placeholders::{self, Known, Moment, Scope};
use super::{Totals, flavour};
use crate::settings::Settings;
use control::control;
use engine::engine;
use error::{error, failure, unknown_name};
use minijinja::{Environment, Value};
use pieces::{find, foreign, pieces};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Longest text that a template may come to, bytes.
const LONGEST: usize = 1 << 20;

/// Names of the settings that hold templates.
const START: &str = "gcode.start";
const END: &str = "gcode.end";
const LAYER: &str = "gcode.layer";

/// A print's templates.
#[derive(Debug)]
pub(super) struct Templates<'a> {
    engine: Arc<Environment<'static>>,
    settings: &'a Settings,
    header: Header,
    /// Values that every template knows.
    known: BTreeMap<String, Value>,
    /// The start's text, as the user wrote it.
    pub start: &'a str,
    end: &'a str,
    has_layer: bool,
}

impl<'a> Templates<'a> {
    /// Reads and tries the templates of `settings`.
    pub(super) fn new(
        settings: &'a Settings,
        header: &Header,
    ) -> Result<Self, TemplateError> {
        let gcode = &settings.gcode;
        let own = |text: &'a str, default| match text.trim().is_empty() {
            true => default,
            false => text,
        };
        let start = own(&gcode.start, flavour::default_start(gcode.flavour));
        let end = own(&gcode.end, flavour::default_end(gcode.flavour));
        let mut known = placeholders::of_settings(settings);
        let of_all = Known {
            settings,
            header,
            moment: Moment::default(),
            totals: Totals::default(),
        };
        known.extend(placeholders::of(Scope::All, &of_all));
        let mut templates = Self {
            engine: Arc::new(engine()),
            settings,
            header: Header {
                thumbnails: Vec::new(),
                outline: Vec::new(),
                ..header.clone()
            },
            known,
            start,
            end,
            has_layer: !gcode.layer.trim().is_empty(),
        };
        templates.add(START, start, Scope::All)?;
        templates.add(END, end, Scope::End)?;
        templates.add(LAYER, &gcode.layer, Scope::Layer)?;
        templates.try_end()?;
        if templates.has_layer {
            templates.layer(Moment::of_trial(settings))?;
        }
        Ok(templates)
    }

    /// What stands at the file's start.
    pub(super) fn start(&self) -> Result<String, TemplateError> {
        self.render(START, Scope::All, Moment::default(), Totals::default())
    }

    /// What stands at a layer's beginning, if anything.
    pub(super) fn layer(
        &self,
        moment: Moment,
    ) -> Result<Option<String>, TemplateError> {
        self.has_layer
            .then(|| {
                self.render(LAYER, Scope::Layer, moment, Totals::default())
            })
            .transpose()
    }

    /// What might stand at the file's end: a print takes something of
    /// everything, so nothing is divided by zero.
    pub(super) fn try_end(&self) -> Result<String, TemplateError> {
        self.end(Totals {
            filament_length: 1000.0,
            filament_volume: 2400.0,
            filament_mass_g: 3.0,
            time: 600.0,
            layers: self.header.layer_count.max(1),
        })
    }

    /// What stands at the file's end.
    pub(super) fn end(&self, totals: Totals) -> Result<String, TemplateError> {
        self.render(END, Scope::End, Moment::default(), totals)
    }

    /// Reads a template and looks for names that are not known.
    fn add(
        &mut self,
        name: &'static str,
        source: &'a str,
        scope: Scope,
    ) -> Result<(), TemplateError> {
        if let Some((at, message)) = control(source) {
            return Err(error(name, source, at, message));
        }
        let failed = |e| failure(name, source, &e);
        Arc::make_mut(&mut self.engine)
            .add_template_owned(name, source.to_owned())
            .map_err(failed)?;
        let template = self.engine.get_template(name).map_err(failed)?;
        let globals: Vec<&str> =
            self.engine.globals().map(|(name, _)| name).collect();
        let known: Vec<&str> = placeholders::names(scope).collect();
        let is_known = |used: &str| {
            let group = |k: &&str| k.split('.').next() == Some(used);
            globals.contains(&used)
                || known.contains(&used)
                || known.iter().any(group)
        };
        let pieces = pieces(source);
        let mut unknown: Vec<(usize, String)> = template
            .undeclared_variables(true)
            .into_iter()
            .filter(|used| !is_known(used))
            .map(|used| (find(source, &pieces, &used), used))
            .collect();
        unknown.sort();
        if let Some((at, used)) = unknown.first() {
            return Err(error(name, source, *at, unknown_name(used, scope)));
        }
        match foreign(source, &pieces, &known) {
            Some((at, message)) => Err(error(name, source, at, message)),
            None => Ok(()),
        }
    }

    fn render(
        &self,
        name: &'static str,
        scope: Scope,
        moment: Moment,
        totals: Totals,
    ) -> Result<String, TemplateError> {
        let now = Known {
            settings: self.settings,
            header: &self.header,
            moment,
            totals,
        };
        let mut values = self.known.clone();
        if scope != Scope::All {
            values.extend(placeholders::of(scope, &now));
        }
        let engine = self.engine.clone();
        let source = self.source(name);
        let too_much = |message| error(name, source, 0, message);
        let rendered = bounded(move || {
            engine
                .get_template(name)
                .and_then(|t| t.render(Value::from_iter(values)))
        })
        .map_err(|why| too_much(why.to_string()))?
        .map_err(|e| failure(name, source, &e))?;
        if rendered.len() > LONGEST {
            return Err(too_much(format!(
                "it comes to more than {} MB of text; make it shorter",
                LONGEST >> 20
            )));
        }
        // What an expression comes to may have one as well.
        if let Some((at, message)) = control(&rendered) {
            let line = rendered[..at].matches('\n').count() + 1;
            let message = format!("line {line} of what it comes to: {message}");
            return Err(error(name, source, 0, message));
        }
        let mut out = String::with_capacity(rendered.len() + 1);
        for line in rendered.lines() {
            out.push_str(line.trim_end());
            out.push('\n');
        }
        Ok(out)
    }

    fn source(&self, name: &str) -> &'a str {
        match name {
            START => self.start,
            LAYER => &self.settings.gcode.layer,
            _ => self.end,
        }
    }
}
