//! Templates: the user's own lines at the start and the end of a file and of
//! each layer.
//!
//! In: text in the syntax of Jinja, by minijinja: `{{ bed_temperature }}`,
//! `{{ (layer_height * 2) | round(2) }}`, `{% if bed_temperature > 90 %}`.
//! Out: G-code. [`PLACEHOLDERS`](super::PLACEHOLDERS) is the list of names.
//!
//! Guarantees: a name nobody knows is an error that says where, also in a
//! branch that is not taken, and so is a placeholder in another slicer's
//! brackets; nothing is left out silently. All templates are tried before the
//! first line is written. Numbers are written as firmware reads them. A
//! template can neither read files nor run for ever, nor take much memory
//! (see [`bounded`](super::bounded)).

use super::Header;
use super::bounded::{GivenUp, bounded};
use super::number::text;
use super::placeholders::{self, Known, Moment, Scope};
use super::{Totals, flavour};
use crate::settings::Settings;
use minijinja::value::{Rest, ValueKind};
use minijinja::{
    Environment, Error, ErrorKind, Output, State, UndefinedBehavior, Value,
    filters,
};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Steps a template may take: thousands of lines.
const FUEL: u64 = 200_000;

/// Longest text that a template may come to, bytes.
const LONGEST: usize = 1 << 20;

/// Filters that make room for as much as they are told, at once, whatever
/// there is; no G-code needs them.
const LEFT_OUT: [&str; 3] = ["batch", "indent", "slice"];

/// Decimals of numbers; templates that want fewer round.
const DECIMALS: u32 = 5;

/// Why a template cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{template}, line {line}, column {column}: {message}")]
pub struct TemplateError {
    /// The setting that holds the template.
    pub template: &'static str,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

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

fn engine() -> Environment<'static> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_fuel(Some(FUEL));
    // For the place of a mistake.
    engine.set_debug(true);
    // A line with nothing but a condition leaves no empty line.
    engine.set_trim_blocks(true);
    engine.set_lstrip_blocks(true);
    engine.set_formatter(write);
    engine.add_filter("format", format_within);
    for filter in LEFT_OUT {
        engine.remove_filter(filter);
    }
    engine
}

/// The filter `format` with plain conversions only, such as `%5.2f`, whose
/// widths and decimals have two digits at most: what is wider is made at
/// once, however wide, and names in brackets make the engine panic.
fn format_within(
    state: &State,
    form: &Value,
    values: Rest<Value>,
) -> Result<Value, Error> {
    let text = form.as_str().unwrap_or_default();
    let mut digits = text.split(|c: char| !c.is_ascii_digit());
    if digits.any(|run| run.len() > 2) {
        return Err(Error::new(
            ErrorKind::InvalidOperation,
            format!("{text:?} has a width of more than two digits"),
        ));
    }
    let without_signs = text.replace("%%", "");
    let mut parts = without_signs.as_str();
    let plain = loop {
        let Some(at) = parts.find('%') else {
            break true;
        };
        let flags = |c: char| c.is_ascii_digit() || "+-# .".contains(c);
        let rest = parts[at + 1..].trim_start_matches(flags);
        if !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
            break false;
        }
        parts = &rest[1..];
    };
    if !plain {
        return Err(Error::new(
            ErrorKind::InvalidOperation,
            format!(
                "{text:?} has a % that begins no conversion such as %.2f; \
                 write %% for the sign itself"
            ),
        ));
    }
    filters::format(state, form, values)
}

/// Writes a value as firmware reads it.
fn write(out: &mut Output, _: &State, value: &Value) -> Result<(), Error> {
    let written = match value.kind() {
        ValueKind::Number if !value.is_integer() => {
            let x = f64::try_from(value.clone())?;
            if super::number::scaled(x, DECIMALS).is_none() {
                return Err(Error::new(
                    ErrorKind::InvalidOperation,
                    format!("the result is {x}, which firmware cannot read"),
                ));
            }
            text(x, DECIMALS)
        }
        ValueKind::Undefined => {
            return Err(Error::from(ErrorKind::UndefinedError));
        }
        ValueKind::Seq | ValueKind::Map | ValueKind::Iterable => {
            return Err(Error::new(
                ErrorKind::InvalidOperation,
                "a list cannot be written; write its elements, as with \
                 | join(' ')",
            ));
        }
        _ => value.to_string(),
    };
    out.write_str(&written)
        .map_err(|_| Error::from(ErrorKind::WriteFailure))
}

/// A piece of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Piece {
    /// Where it is, in bytes.
    at: Range<usize>,
    /// Whether it is an expression or a condition, and not plain text.
    code: bool,
}

/// The pieces of a template: plain text, and what is between braces.
/// Comments and raw text are left out.
fn pieces(source: &str) -> Vec<Piece> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(open) = source[at..]
        .match_indices('{')
        .map(|(i, _)| at + i)
        .find(|&i| source[i + 1..].starts_with(['{', '%', '#']))
    {
        all.push(Piece {
            at: at..open,
            code: false,
        });
        let close = match source.as_bytes().get(open + 1) {
            Some(b'{') => "}}",
            Some(b'%') => "%}",
            _ => "#}",
        };
        let inside = open + 2;
        let end = |from: usize, what: &str| {
            source[from..].find(what).map_or(source.len(), |i| from + i)
        };
        let to = end(inside, close);
        let tag = source[inside..to].trim_matches(['-', '+', ' ', '\t']);
        at = (to + close.len()).min(source.len());
        if close == "%}" && tag == "raw" {
            let over = end(at, "endraw");
            at = (end(over, "%}") + 2).min(source.len());
        } else if close != "#}" {
            all.push(Piece {
                at: inside..to,
                code: true,
            });
        }
    }
    all.push(Piece {
        at: at..source.len(),
        code: false,
    });
    all
}

/// Where `name` is used first.
fn find(source: &str, pieces: &[Piece], name: &str) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    pieces
        .iter()
        .filter(|p| p.code)
        .flat_map(|p| {
            let places = source[p.at.clone()].match_indices(name);
            places.map(|(i, _)| p.at.start + i)
        })
        .find(|&i| {
            let before = source[..i].chars().next_back();
            let after = source[i + name.len()..].chars().next();
            !before.is_some_and(|c| part(c) || c == '.')
                && !after.is_some_and(part)
        })
        .unwrap_or(0)
}

/// A placeholder in brackets of another kind, `{name}` or `[name]`, that
/// would reach the printer as it is.
fn foreign(
    source: &str,
    pieces: &[Piece],
    known: &[&str],
) -> Option<(usize, String)> {
    let text = pieces.iter().filter(|p| !p.code);
    let mut found = text.flat_map(|p| {
        let piece = &source[p.at.clone()];
        piece
            .match_indices(['{', '['])
            .filter_map(move |(i, open)| {
                // Comments may hold anything.
                let line = piece[..i].rsplit('\n').next().unwrap_or("");
                let close = if open == "{" { '}' } else { ']' };
                let (name, _) = piece[i + 1..].split_once(close)?;
                let name = name.trim();
                let plain = !name.is_empty()
                    && name.chars().all(|c| c.is_alphanumeric() || c == '_')
                    && !name.starts_with(|c: char| c.is_ascii_digit());
                let meant = plain && (open == "{" || known.contains(&name));
                (meant && !line.contains(';')).then(|| {
                    let at = p.at.start + i;
                    let shown = &piece[i..i + piece[i..].find(close)? + 1];
                    Some((
                        at,
                        format!(
                            "{shown} would reach the printer as it is; write \
                         {{{{ {name} }}}} for a placeholder"
                        ),
                    ))
                })?
            })
    });
    found.next()
}

/// What to say about a name that is not known.
fn unknown_name(name: &str, scope: Scope) -> String {
    let elsewhere = super::PLACEHOLDERS
        .iter()
        .find(|p| p.name == name && p.scope != scope);
    match elsewhere.map(|p| p.scope) {
        Some(Scope::Layer) => {
            return format!("{name} is known in {LAYER} only");
        }
        Some(Scope::End) => {
            return format!("{name} is known in {END} only");
        }
        _ => {}
    }
    // Below this two names have little more than a letter in common.
    const NEAR: f64 = 0.8;
    let like = |known: &str| {
        // The right name in the wrong group is near, too.
        let leaf = known.rsplit('.').next().unwrap_or(known);
        let own = name.rsplit('.').next().unwrap_or(name);
        let whole = strsim::jaro_winkler(name, known);
        whole.max(0.95 * strsim::jaro_winkler(own, leaf))
    };
    let hint = placeholders::names(scope)
        .map(|known| (like(known), known))
        .filter(|(likeness, _)| *likeness >= NEAR)
        // The first of several that are as near.
        .fold(None::<(f64, &str)>, |best, this| match best {
            Some(best) if best.0 >= this.0 => Some(best),
            _ => Some(this),
        })
        .map(|(_, known)| format!(", did you mean {{{{ {known} }}}}?"))
        .unwrap_or_default();
    let all: Vec<&str> = super::PLACEHOLDERS
        .iter()
        .filter(|p| p.scope == Scope::All || p.scope == scope)
        .map(|p| p.name)
        .collect();
    format!(
        "there is no placeholder {{{{ {name} }}}}{hint}; there are {}, and \
         every setting by its name",
        all.join(", ")
    )
}

/// An error of the engine's in our words.
fn failure(
    template: &'static str,
    source: &str,
    failed: &Error,
) -> TemplateError {
    let start = failed.range().map(|r| r.start);
    let mut message = match failed.kind() {
        ErrorKind::OutOfFuel => GivenUp::Time.to_string(),
        ErrorKind::UndefinedError => "this has no value".to_owned(),
        kind => kind.to_string(),
    };
    if let Some(detail) = failed.detail() {
        message = format!("{message}: {detail}");
    }
    match start {
        Some(at) => error(template, source, at, message),
        None => TemplateError {
            template,
            line: failed.line().unwrap_or(1),
            column: 1,
            message,
        },
    }
}

fn error(
    template: &'static str,
    source: &str,
    at: usize,
    message: String,
) -> TemplateError {
    let before = source.get(..at).unwrap_or(source);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    TemplateError {
        template,
        line,
        column: before[start..].chars().count() + 1,
        message,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn header() -> Header {
        Header {
            model_name: "gyroid\nball".to_owned(),
            layer_count: 12,
            layers: 0..12,
            timestamp: None,
            nozzle_temperature: 210.0,
            part_min: DVec3::new(95.0, 95.0, 0.0),
            part_max: DVec3::new(125.0, 125.0, 30.0),
            outline: Vec::new(),
            thumbnails: Vec::new(),
        }
    }

    fn filled(source: &str) -> Result<String, String> {
        let mut s = Settings::default();
        s.gcode.start = source.to_owned();
        let start = Templates::new(&s, &header()).and_then(|t| t.start());
        start.map_err(|e| {
            let s = e.to_string();
            s.split("; ").next().unwrap_or("").to_owned()
        })
    }

    #[track_caller]
    fn assert_filled(source: &str, expected: &str) {
        assert_eq!(filled(source).as_deref(), Ok(expected));
    }

    #[test]
    fn placeholders_are_filled_in() {
        assert_filled(
            "M104 S{{ nozzle_temperature }} \r\nG1 Z{{park_z}}",
            "M104 S210\nG1 Z40\n",
        );
        assert_filled(
            "M117 {{ '{' }}{{ model_name }}}",
            "M117 {gyroid ball}\n",
        );
        assert_filled("M117 {% raw %}{a}{% endraw %}", "M117 {a}\n");
        assert_filled("{{ speed.travel }} {{ printer.model }}", "150\n");
    }

    #[test]
    fn expressions_are_computed_and_written_plainly() {
        assert_filled("{{ (layer_height * 2) | round(2) }}", "0.4\n");
        assert_filled("{{ layer_height / 3 }} {{ 1/2 }}", "0.06667 0.5\n");
        assert_filled("{{ bed_temperature / 2 }}", "30\n");
        assert_filled("{{ 1e-9 }} {{ -layer_height }}", "0 -0.2\n");
        assert_filled(
            "G28\n{% if bed_temperature > 50 %}\nM190 S{{ bed_temperature }}\n\
             {% else %}\nG4 P1\n{% endif %}\nG29",
            "G28\nM190 S60\nG29\n",
        );
        assert_filled("{{ [part_max_x + 5, bed_x] | min }}", "130\n");
    }

    #[test]
    fn every_placeholder_has_a_value_and_its_own_name() {
        let all = super::super::PLACEHOLDERS;
        for p in all {
            assert_eq!(all.iter().filter(|q| q.name == p.name).count(), 1);
            let mut s = Settings::default();
            let text = format!("{{{{ {} }}}}", p.name);
            match p.scope {
                Scope::All => s.gcode.start = text,
                Scope::Layer => s.gcode.layer = text,
                Scope::End => s.gcode.end = text,
            }
            assert!(Templates::new(&s, &header()).is_ok(), "{}", p.name);
        }
        // All settings but the templates.
        for key in crate::settings::keys() {
            let template = key.name.starts_with("gcode.")
                && ["start", "end", "layer"].contains(&&key.name[6..]);
            let used = filled(&format!("{{{{ {} }}}}", key.name));
            assert_eq!(used.is_ok(), !template, "{}", key.name);
        }
    }

    #[track_caller]
    fn assert_refused(source: &str, expected: &str) {
        assert_eq!(filled(source), Err(format!("gcode.start, {expected}")));
    }

    #[test]
    fn errors_say_where() {
        assert_refused(
            "G28\nM104 Sé{{ nozle_temp }}",
            "line 2, column 11: there is no placeholder {{ nozle_temp }}, did \
             you mean {{ nozzle_temperature }}?",
        );
        // Also where it would not be reached.
        assert_refused(
            "{% if false %}\n{{ 1 + bed_q }}{% endif %}",
            "line 2, column 8: there is no placeholder {{ bed_q }}, did you \
             mean {{ bed_x }}?",
        );
        assert_refused(
            "{{ filament.diametre }}",
            "line 1, column 4: there is no placeholder \
             {{ filament.diametre }}, did you mean {{ filament.diameter }}?",
        );
        assert_refused(
            "{{ layer }}",
            "line 1, column 4: layer is known in gcode.layer only",
        );
        assert_refused(
            "G28\n\nM190 S{bed_temperature}",
            "line 3, column 7: {bed_temperature} would reach the printer as \
             it is",
        );
        assert_refused(
            "M190 S[bed_temperature]",
            "line 1, column 7: [bed_temperature] would reach the printer as \
             it is",
        );
        for broken in ["G28 {{ bed_x", "G28 {{ bed_x + }}", "{% if true %}"] {
            let error = filled(broken).unwrap_err();
            assert!(error.contains("line 1, column"), "{error}");
            assert!(error.contains("syntax error"), "{error}");
        }
        for wrong in ["G28\n{{ 1 // 0 }}", "G28\n{{ 1 / 0 }}", "\n{{ x.y }}"] {
            let error = filled(wrong).unwrap_err();
            assert!(error.contains("line 2, column 4"), "{error}");
        }
    }

    #[test]
    fn text_that_only_looks_like_a_placeholder_is_left_alone() {
        let plain = "G1 X1 ; {any} [thing]\nM117 [100] {1} [hi]\n";
        assert_filled(plain, plain);
    }

    #[test]
    fn a_template_that_goes_on_for_ever_is_stopped() {
        let bomb = "{% for i in range(9999) %}{% for j in range(9999) %}G4\n\
                    {% endfor %}{% endfor %}";
        assert!(filled(bomb).unwrap_err().contains("too long"));
    }

    #[test]
    fn a_template_that_grows_without_end_is_refused() {
        let doubled = "{% set ns = namespace(s='aaaaaaaaaaaaaaaa') %}\
            {% for i in range(60) %}{% set ns.s = ns.s ~ ns.s %}{% endfor %}";
        for (source, words) in [
            (doubled, "too much memory"),
            ("{{ 'a' * 9999999 }}", "more than 1 MB"),
            ("{{ '%999999999999999d' | format(3) }}", "two digits"),
            ("{{ '%.999999999999999f' | format(3.5) }}", "two digits"),
            ("{{ '%(\u{6c2}99' | format(5) }}", "no conversion"),
            ("{{ '5 %' | format(5) }}", "no conversion"),
            (
                "{{ 'a' | indent(999999999999999, true) }}",
                "unknown filter",
            ),
            ("{{ [1] | batch(999999999999999, 0) }}", "unknown filter"),
            ("{{ [1] | slice(999999999999999, 0) }}", "unknown filter"),
        ] {
            let error = filled(source).unwrap_err();
            assert!(error.contains(words), "{source}: {error}");
        }
        assert_filled("{{ '%03d' | format(7) }}", "007\n");
        assert_filled("{{ '%+.1f %d%%' | format(2.25, 7) }}", "+2.2 7%\n");
    }

    /// Some have no end: their elements are made as they are asked for.
    #[test]
    fn a_list_is_not_written() {
        for list in ["[0] * 99999999999999", "[1, 2]", "{'a': 1}", "range(3)"] {
            let error = filled(&format!("{{{{ {list} }}}}")).unwrap_err();
            assert!(error.contains("a list"), "{error}");
        }
        assert_filled("{{ [1, 2] | join(' ') }}", "1 2\n");
    }
}
