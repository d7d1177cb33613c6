//! Placeholders of other slicers: `[first_layer_temperature]`,
//! `{bed_temperature[0]}`, `{if layer_num == 1}`.
//!
//! In: a template's text. Out: the template in minijinja's syntax, line for
//! line. Text outside comments that looks like a placeholder and has no
//! counterpart is an error, since it would reach the printer unchanged. In a
//! comment it does no harm and stays.

mod expression;
mod names;
#[cfg(test)]
mod tests;

use super::error::{known_elsewhere, meant};
use super::pieces::TemplatePiece;
use crate::placeholders::Scope;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::ops::Range;

/// What to write for text that only looks like a placeholder.
const AS_IT_IS: &str = "if it is meant for the printer, put it between {% raw \
                        %} and {% endraw %}";

/// Greatest length of a placeholder, bytes.
const LONGEST: usize = 2048;

/// A template in minijinja's syntax. The error is a place in bytes and what is
/// wrong there.
pub(super) fn translated<'a>(
    source: &'a str,
    pieces: &[TemplatePiece],
    scope: Scope,
) -> Result<Cow<'a, str>, (usize, String)> {
    let mut work = Translation {
        source,
        scope,
        out: String::new(),
        copied: 0,
        open: 0,
        looked: 0,
        comment: false,
        lines: None,
    };
    for piece in pieces.iter().filter(|p| !p.code) {
        work.plain(piece.at.start, piece.at.end)?;
    }
    work.out.push_str(&source[work.copied..]);
    let ours = match work.copied {
        0 => Cow::Borrowed(source),
        _ => Cow::Owned(work.out),
    };
    Ok(with_line_ends(ours))
}

struct Translation<'a> {
    source: &'a str,
    scope: Scope,
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
    fn plain(&mut self, from: usize, to: usize) -> Result<(), (usize, String)> {
        let mut at = from;
        while let Some(found) = self.source[at..to].find(['{', '[']) {
            let start = at + found;
            let text = &self.source[start..to];
            let comment = self.is_comment(start);
            let Some(length) = extent(text) else {
                if text.starts_with('{') && !comment {
                    return Err((
                        start,
                        format!(
                            "{{ has no }} within {LONGEST} bytes; {AS_IT_IS}"
                        ),
                    ));
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
                        "{given} is another slicer's placeholder, and would \
                         reach the printer as it is: {why}; {AS_IT_IS}"
                    );
                    return Err((start, message));
                }
            }
        }
        Ok(())
    }

    /// A placeholder in minijinja's syntax, or nothing if the text is no
    /// placeholder.
    fn tag(
        &mut self,
        start: usize,
        end: usize,
    ) -> Result<Option<String>, String> {
        let inside = self.source[start + 1..end - 1].trim();
        if self.source[start..].starts_with('[') {
            let ours = expression::translated(inside, self.scope)?;
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
                let ours = expression::translated(rest, self.scope)?;
                self.open += 1;
                format!("if {ours}")
            }
            ("elsif", rest) if self.open > 0 => {
                let ours = expression::translated(rest, self.scope)?;
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
                let ours = expression::translated(inside, self.scope)?;
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

/// Keeps the end of a line that has a block at its end and other text before
/// it. minijinja drops the line's end after a block, which would make two
/// commands one.
fn with_line_ends(source: Cow<'_, str>) -> Cow<'_, str> {
    let eats = |line: &str| {
        line.ends_with("%}")
            && !line.ends_with("-%}")
            && !line.ends_with("+%}")
            && line.contains("{%")
            && has_text(line)
    };
    let line_of = |line: &'_ str| -> bool {
        line.ends_with('\n') && eats(line.trim_end_matches(['\r', '\n']))
    };
    if !source.split_inclusive('\n').any(line_of) {
        return source;
    }
    let mut out = String::with_capacity(source.len() + 16);
    for line in source.split_inclusive('\n') {
        if line_of(line) {
            let end = line.rfind("%}").unwrap_or(0);
            let _ = write!(out, "{}+{}", &line[..end], &line[end..]);
        } else {
            out.push_str(line);
        }
    }
    Cow::Owned(out)
}

/// True if a line has text beside blocks and comments.
fn has_text(mut line: &str) -> bool {
    loop {
        line = line.trim_start();
        let close = match line.get(..2) {
            Some("{%") => "%}",
            Some("{#") => "#}",
            _ => return !line.is_empty(),
        };
        match line.find(close) {
            Some(at) => line = &line[at + 2..],
            None => return false,
        }
    }
}

/// The byte of `source` that byte `at` of its translation comes from.
pub(super) fn origin(source: &str, translated: &str, at: usize) -> usize {
    let before = translated.get(..at).unwrap_or(translated);
    let line = before.matches('\n').count();
    let start_of = |text: &str| {
        let ends = text.match_indices('\n').map(|(i, _)| i + 1);
        [0].into_iter().chain(ends).nth(line).unwrap_or(0)
    };
    let (ours, theirs) = (start_of(translated), start_of(source));
    let rest = |text: &'_ str, from: usize| -> String {
        text[from..].lines().next().unwrap_or("").to_owned()
    };
    let (of_ours, of_source) = (rest(translated, ours), rest(source, theirs));
    let column = at.saturating_sub(ours).min(of_ours.len());
    // Finds the range in which the lines differ.
    let same = |a: (char, char)| a.0 == a.1;
    let head: usize = of_ours
        .chars()
        .zip(of_source.chars())
        .take_while(|a| same(*a))
        .map(|(c, _)| c.len_utf8())
        .sum();
    let tail: usize = of_ours
        .chars()
        .rev()
        .zip(of_source.chars().rev())
        .take_while(|a| same(*a))
        .map(|(c, _)| c.len_utf8())
        .sum();
    let from_end = of_ours.len() - column;
    theirs
        + match () {
            () if column < head => column,
            () if from_end <= tail => of_source.len() - from_end,
            () => head.min(of_source.len()),
        }
}

/// True if a foreign name stands for something here.
pub(super) fn understands(name: &str) -> bool {
    !matches!(names::ours(name), None | Some(names::Ours::None(_)))
}

/// The message for an unknown name.
fn unknown(name: &str, scope: Scope) -> String {
    if let Some(place) = known_elsewhere(name, scope) {
        return format!("{name} is known in {place} only");
    }
    match meant(name, scope) {
        Some(near) => format!(
            "isoslice does not know it, and the nearest of ours is \
             {{{{ {near} }}}}"
        ),
        None => "isoslice does not know it; docs/gcode.md lists what there is"
            .to_owned(),
    }
}
