//! Placeholders of other slicers: `[first_layer_temperature]`,
//! `{bed_temperature[0]}`, `{if layer_num == 1}`.
//!
//! In: a template's text. Out: the template in isoslice's own syntax, that of
//! Jinja, line for line. Text outside comments that looks like a placeholder and
//! has no counterpart is an error, since it would reach the printer unchanged. In
//! a comment it does no harm and stays.

mod expression;
mod names;

pub(crate) use expression::FIRST_TOOL;
use std::ops::Range;

/// What to write for text that only looks like a placeholder.
const AS_IT_IS: &str = "if it is meant for the printer, put it between {% raw \
                        %} and {% endraw %}";

/// Which of isoslice's templates a template becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// `gcode.start`.
    Start,
    /// `gcode.layer`.
    Layer,
    /// `gcode.end`.
    End,
}

impl Place {
    /// The place of a setting that is a template.
    pub fn of_setting(name: &str) -> Option<Place> {
        match name {
            "gcode.start" => Some(Place::Start),
            "gcode.layer" => Some(Place::Layer),
            "gcode.end" => Some(Place::End),
            _ => None,
        }
    }
}

/// Why a template cannot be translated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
pub struct NotTranslated {
    /// Line of the placeholder, from 1.
    pub line: usize,
    /// Column of the placeholder, in characters, from 1.
    pub column: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

/// Greatest length of a placeholder, bytes.
const LONGEST: usize = 2048;

/// A template in isoslice's own syntax. Code in that syntax stays as it is. `own`
/// tells isoslice's own names of placeholders.
///
/// # Errors
/// The first placeholder that has no counterpart.
pub fn translated(
    source: &str,
    place: Place,
    own: &dyn Fn(&str) -> bool,
) -> Result<String, NotTranslated> {
    let mut work = Translation {
        source,
        names: Names { place, own },
        out: String::new(),
        copied: 0,
        open: 0,
        looked: 0,
        comment: false,
        lines: None,
    };
    let mut at = 0;
    while let Some((code, end)) = own_code(source, at) {
        work.plain(at, code)?;
        at = end;
    }
    work.plain(at, source.len())?;
    work.out.push_str(&source[work.copied..]);
    Ok(work.out)
}

/// The next code in isoslice's own syntax: where it begins and ends.
fn own_code(source: &str, from: usize) -> Option<(usize, usize)> {
    let mut braces = source[from..].match_indices('{').map(|(i, _)| from + i);
    braces.find_map(|at| {
        let close = match source.as_bytes().get(at + 1)? {
            b'{' => "}}",
            b'%' if is_raw(&source[at + 2..]) => "endraw",
            b'%' => "%}",
            b'#' => "#}",
            _ => return None,
        };
        // Code without an end is the rest.
        let length = source[at..].find(close);
        let end = length.map_or(source.len(), |i| at + i + close.len());
        Some((at, end))
    })
}

/// True if a tag begins text that is left alone.
fn is_raw(tag: &str) -> bool {
    tag.trim_start_matches(['-', '+', ' ']).starts_with("raw")
}

/// The mistake at a place in bytes.
fn wrong(source: &str, at: usize, message: String) -> NotTranslated {
    let before = &source[..at];
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    NotTranslated {
        line: before.matches('\n').count() + 1,
        column: before[start..].chars().count() + 1,
        message,
    }
}

/// What names mean in a template.
#[derive(Clone, Copy)]
struct Names<'a> {
    place: Place,
    own: &'a dyn Fn(&str) -> bool,
}

struct Translation<'a> {
    source: &'a str,
    names: Names<'a>,
    out: String,
    /// How many bytes of the source have been copied to `out`.
    copied: usize,
    /// Number of foreign conditions that are open.
    open: usize,
    /// Up to where the source has been searched for comments, and whether one
    /// is open there.
    looked: usize,
    comment: bool,
    /// The lines that `is_alone` was last asked about, and its answer.
    lines: Option<(Range<usize>, bool)>,
}

impl Translation<'_> {
    /// Translates plain text, a range of bytes.
    fn plain(&mut self, from: usize, to: usize) -> Result<(), NotTranslated> {
        let mut at = from;
        while let Some(found) = self.source[at..to].find(['{', '[']) {
            let start = at + found;
            let text = &self.source[start..to];
            let comment = self.is_comment(start);
            let Some(length) = extent(text) else {
                if text.starts_with('{') && !comment {
                    let message = format!(
                        "{{ has no }} within {LONGEST} bytes; {AS_IT_IS}"
                    );
                    return Err(wrong(self.source, start, message));
                }
                at = start + 1;
                continue;
            };
            let end = start + length;
            match self.tag(start, end) {
                Ok(Some(tag)) => {
                    self.out.push_str(&self.source[self.copied..start]);
                    self.out.push_str(&tag);
                    self.copied = end;
                    at = end;
                }
                // A placeholder inside this one may be known.
                Ok(None) => at = start + 1,
                Err(_) if comment => at = start + 1,
                Err(why) => {
                    let given = &self.source[start..end];
                    let given: String = given.chars().take(60).collect();
                    let message = format!(
                        "{given} would reach the printer as it is: {why}; \
                         {AS_IT_IS}"
                    );
                    return Err(wrong(self.source, start, message));
                }
            }
        }
        Ok(())
    }

    /// A placeholder in isoslice's syntax, or nothing if the text is no
    /// placeholder.
    fn tag(
        &mut self,
        start: usize,
        end: usize,
    ) -> Result<Option<String>, String> {
        let inside = self.source[start + 1..end - 1].trim();
        if self.source[start..].starts_with('[') {
            let ours = expression::translated(inside, self.names)?;
            return Ok(Some(format!("{{{{ {ours} }}}}")));
        }
        // The text that follows keeps its line number.
        let lines = self.source[start..end].matches('\n').count();
        let lines = "\n".repeat(lines);
        let (word, rest) = match inside.find(|c: char| !c.is_alphabetic()) {
            Some(at) => inside.split_at(at),
            None => (inside, ""),
        };
        let condition = match (word, rest.trim()) {
            ("if", rest) => {
                let ours = expression::translated(rest, self.names)?;
                self.open += 1;
                format!("if {ours}")
            }
            ("elsif", rest) if self.open > 0 => {
                let ours = expression::translated(rest, self.names)?;
                format!("elif {ours}")
            }
            ("else", "") if self.open > 0 => "else".to_owned(),
            ("endif", "") if self.open > 0 => {
                self.open -= 1;
                "endif".to_owned()
            }
            ("elsif" | "else" | "endif", _) => {
                return Err("it belongs to no {if …}".to_owned());
            }
            ("local" | "global", _) => {
                return Err("a name of your own is set by {% set name = … %}"
                    .to_owned());
            }
            _ => {
                let ours = expression::translated(inside, self.names)?;
                return Ok(Some(format!("{{{{ {ours}{lines} }}}}")));
            }
        };
        // A condition within a line leaves the text around it alone.
        Ok(Some(if self.is_alone(start, end) {
            format!("{{% {condition}{lines} %}}")
        } else {
            format!("{{%+ {condition}{lines} +%}}")
        }))
    }

    /// True if a place is in a comment. Each place must be behind the one asked
    /// about before.
    fn is_comment(&mut self, at: usize) -> bool {
        for byte in &self.source.as_bytes()[self.looked..at] {
            match byte {
                b';' => self.comment = true,
                b'\n' => self.comment = false,
                _ => {}
            }
        }
        self.looked = at;
        self.comment
    }

    /// True if there are only conditions in the lines of a range. The lines are
    /// searched once, however many conditions are in them.
    fn is_alone(&mut self, start: usize, end: usize) -> bool {
        if let Some((lines, alone)) = &self.lines
            && lines.start <= start
            && end <= lines.end
        {
            return *alone;
        }
        let from = self.source[..start].rfind('\n').map_or(0, |i| i + 1);
        let to = self.source[end..].find('\n');
        let to = to.map_or(self.source.len(), |i| end + i);
        let alone = only_conditions(&self.source[from..to]);
        self.lines = Some((from..to, alone));
        alone
    }
}

/// True if a text has nothing but conditions.
fn only_conditions(mut rest: &str) -> bool {
    loop {
        rest = rest.trim_start();
        let word = rest.strip_prefix('{').map(str::trim_start);
        let words = ["if", "elsif", "else", "endif"];
        match word {
            Some(w) if words.iter().any(|word| w.starts_with(word)) => {
                match extent(rest) {
                    Some(length) => rest = &rest[length..],
                    None => return false,
                }
            }
            _ => return rest.is_empty(),
        }
    }
}

/// Length of the bracketed text at the beginning of `text`; nothing if it
/// cannot be a placeholder.
fn extent(text: &str) -> Option<usize> {
    // An unlimited search would take minutes for 100,000 brackets that are
    // never closed.
    let text = &text[..text.floor_char_boundary(LONGEST)];
    if text.starts_with('[') {
        let length = text.find(']')? + 1;
        let name = text[1..length - 1].trim();
        let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_')
            && name.starts_with(|c: char| c.is_alphabetic() || c == '_');
        return is_name.then_some(length);
    }
    let mut quoted = false;
    text.char_indices().skip(1).find_map(|(i, c)| {
        quoted ^= c == '"';
        (c == '}' && !quoted).then_some(i + 1)
    })
}

/// True if a foreign name stands for something in isoslice.
pub fn understands(name: &str) -> bool {
    !matches!(names::ours(name), None | Some(names::Ours::None(_)))
}

/// The names of other slicers that isoslice knows, also those that have no
/// counterpart.
pub fn foreign_names() -> impl Iterator<Item = &'static str> {
    names::NAMES.iter().map(|(name, _)| *name)
}
