//! Fills in the parts of a profile's G-code that depend on the profile alone:
//! placeholders that name one of its values, and conditions that match a
//! pattern against one.
//!
//! `{if printer_notes=~/.*MK3.*/}` is decided once the notes are known. So the
//! slicer that reads the template later needs neither notes nor patterns.

use crate::template::FIRST_TOOL;
use crate::values::{Values, parse};
use regex_lite::RegexBuilder;

/// Greatest length of a template, before and after it is filled in, bytes.
const LONGEST: usize = 1 << 19;
/// Number of bytes within which a bracket, a quote or a slash has to be closed.
const FARTHEST: usize = 2048;
/// Greatest number of patterns in a template; a few are usual.
const MOST_PATTERNS: usize = 100;
/// Greatest length of a pattern, and of the text that is searched. The time for
/// a search grows with the product of the pattern's size and the text's length.
const LONGEST_PATTERN: usize = 200;
const LONGEST_TEXT: usize = 10_000;
/// Greatest size of a compiled pattern, bytes.
const PATTERN_SIZE: usize = 1 << 14;

/// Names that a printer's profile need not have, each with its value in a print
/// of one plain part.
const DEFAULTS: [(&str, &str); 17] = [
    ("printer_notes", ""),
    ("filament_notes", ""),
    ("filament_vendor", ""),
    ("filament_settings_id", ""),
    ("print_settings_id", ""),
    ("filament_abrasive", "0"),
    ("filament_soluble", "0"),
    ("nozzle_high_flow", "0"),
    ("idle_temperature", "0"),
    ("timelapse_type", "0"),
    ("enable_prime_tower", "0"),
    ("print_sequence", "by layer"),
    ("chamber_temperature", "0"),
    ("chamber_temperatures", "0"),
    ("chamber_minimal_temperature", "0"),
    ("overall_chamber_temperature", "0"),
    ("support_material", "0"),
];

/// A template with values put in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filled {
    /// The template.
    pub text: String,
    /// Names for which the profile has no value, and what was put in.
    pub assumed: Vec<(&'static str, &'static str)>,
    /// Why nothing was filled in. The text is then the template as it was.
    pub refused: Option<String>,
}

/// The template with the profile's own values in place of names that
/// `understood` does not know.
pub fn fill(
    template: &str,
    values: &Values,
    understood: &dyn Fn(&str) -> bool,
) -> Filled {
    let mut filler = Filler {
        values,
        understood,
        assumed: Vec::new(),
        patterns: 0,
    };
    match filler.whole(template) {
        Ok(text) => Filled {
            text,
            assumed: filler.assumed,
            refused: None,
        },
        Err(why) => Filled {
            text: template.to_owned(),
            assumed: Vec::new(),
            refused: Some(why),
        },
    }
}

/// Place of the first `sign` in a text, if it is near.
fn near(text: &str, sign: char) -> Option<usize> {
    let mut all = text.char_indices().take_while(|(i, _)| *i < FARTHEST);
    all.find(|(_, c)| *c == sign).map(|(i, _)| i)
}

/// Length of the text in braces at the beginning of `text`, if the braces are
/// closed near.
fn closing(text: &str) -> Option<usize> {
    let mut quoted = false;
    let all = text.char_indices().take_while(|(i, _)| *i < FARTHEST);
    all.skip(1).find_map(|(i, c)| {
        quoted ^= c == '"';
        (c == '}' && !quoted).then_some(i + 1)
    })
}

struct Filler<'a> {
    values: &'a Values,
    understood: &'a dyn Fn(&str) -> bool,
    assumed: Vec<(&'static str, &'static str)>,
    /// Number of patterns met so far.
    patterns: usize,
}

impl<'v> Filler<'v> {
    /// Fills in a template.
    ///
    /// # Errors
    /// A sentence, if the template is or becomes too long, or has too many
    /// patterns.
    fn whole(&mut self, template: &str) -> Result<String, String> {
        let mut out = String::with_capacity(template.len().min(LONGEST));
        let mut rest = template;
        loop {
            if out.len() + rest.len() > LONGEST {
                return Err(format!(
                    "it is longer than {} kB with its placeholders filled in",
                    LONGEST >> 10
                ));
            }
            if self.patterns > MOST_PATTERNS {
                return Err(format!(
                    "it has more than {MOST_PATTERNS} patterns (=~)"
                ));
            }
            let Some(at) = rest.find(['{', '[', ';']) else {
                out.push_str(rest);
                return Ok(out);
            };
            out.push_str(&rest[..at]);
            rest = &rest[at..];
            let end = match &rest[..1] {
                // A comment stays as it is.
                ";" => rest.find('\n').unwrap_or(rest.len()),
                "{" => match closing(rest) {
                    Some(end) => {
                        out.push_str(&self.expression(&rest[..end]));
                        rest = &rest[end..];
                        continue;
                    }
                    None => 1,
                },
                _ => match self.bracketed(rest) {
                    Some((text, end)) => {
                        out.push_str(text);
                        rest = &rest[end..];
                        continue;
                    }
                    None => 1,
                },
            };
            out.push_str(&rest[..end]);
            rest = &rest[end..];
        }
    }

    /// The profile's own value of a name, or the usual one.
    fn value(&mut self, name: &str) -> Option<&'v str> {
        if self.values.has(name) {
            return self.values.text(name);
        }
        let usual = DEFAULTS.iter().find(|(key, _)| *key == name)?;
        if !self.assumed.contains(usual) {
            self.assumed.push(*usual);
        }
        Some(usual.1)
    }

    /// The value of `[name]`, if the name is the profile's own, and the length
    /// of the text.
    fn bracketed(&mut self, text: &str) -> Option<(&'v str, usize)> {
        let end = near(text, ']')?;
        let name = text[1..end].trim();
        if (self.understood)(name) || !is_name(name) {
            return None;
        }
        let first = first_of(self.value(name)?);
        let plain =
            first.len() <= FARTHEST && !first.contains(['{', '[', '\n']);
        plain.then_some((first, end + 1))
    }

    /// An expression in braces.
    fn expression(&mut self, text: &str) -> String {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(c) = rest.chars().next() {
            if c == '"' {
                let end = rest[1..].find('"').map_or(rest.len(), |i| i + 2);
                out.push_str(&rest[..end]);
                rest = &rest[end..];
                continue;
            }
            if !(c.is_ascii_alphabetic() || c == '_') {
                // The rest of a number is not a name.
                let number = c.is_ascii_digit() || c == '.';
                let end = if number {
                    rest.find(|c: char| {
                        !(c.is_ascii_alphanumeric() || c == '.')
                    })
                    .unwrap_or(rest.len())
                } else {
                    c.len_utf8()
                };
                out.push_str(&rest[..end]);
                rest = &rest[end..];
                continue;
            }
            let end = rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .unwrap_or(rest.len());
            let (name, after) = rest.split_at(end);
            match self.named(name, after) {
                Some((text, behind)) => {
                    out.push_str(&text);
                    rest = behind;
                }
                None => {
                    out.push_str(name);
                    rest = after;
                }
            }
        }
        out
    }

    /// The value of a name with its index and a pattern after it, and the text
    /// after them.
    fn named<'t>(
        &mut self,
        name: &str,
        after: &'t str,
    ) -> Option<(String, &'t str)> {
        if name == "is_nil"
            && let Some(inner) = after.strip_prefix('(')
        {
            let end = near(inner, ')')?;
            let of = inner[..end].split('[').next().unwrap_or("").trim();
            let nil = !self.values.has(of);
            let known = is_name(of) && !(self.understood)(of);
            return known.then(|| (nil.to_string(), &inner[end + 1..]));
        }
        // A name that `understood` knows is filled in only where a pattern
        // follows.
        if !self.values.has(name) && (self.understood)(name) {
            return None;
        }
        let value = self.value(name)?;
        let mut behind = after;
        if let Some(inner) = after.strip_prefix('[') {
            let end = near(inner, ']')?;
            if !is_first(inner[..end].trim()) {
                return None;
            }
            behind = &inner[end + 1..];
        }
        let operator = behind.trim_start();
        for (sign, wanted) in [("=~", true), ("!~", false)] {
            if let Some(pattern) = operator.strip_prefix(sign) {
                let pattern = pattern.trim_start().strip_prefix('/')?;
                let end = near(pattern, '/')?;
                self.patterns += 1;
                if self.patterns > MOST_PATTERNS {
                    return None;
                }
                let found = matches(value, &pattern[..end])?;
                let yes = if found == wanted { "true" } else { "false" };
                return Some((yes.to_owned(), &pattern[end + 1..]));
            }
        }
        if (self.understood)(name) {
            return None;
        }
        let first = first_of(value);
        let text = if first.len() > FARTHEST {
            return None;
        } else if parse(first).is_some() {
            first.to_owned()
        } else if first.contains(['"', '\n', '{', '}']) {
            return None;
        } else {
            format!("\"{first}\"")
        };
        Some((text, behind))
    }
}

/// True if all of the text matches the pattern; none if the pattern is not
/// understood.
fn matches(text: &str, pattern: &str) -> Option<bool> {
    if pattern.len() > LONGEST_PATTERN || text.len() > LONGEST_TEXT {
        return None;
    }
    let whole = format!("^(?:{pattern})$");
    let regex = RegexBuilder::new(&whole)
        .dot_matches_new_line(true)
        .size_limit(PATTERN_SIZE)
        .build()
        .ok()?;
    Some(regex.is_match(text))
}

/// The first extruder's part of a value.
fn first_of(value: &str) -> &str {
    let first = value.split([',', ';']).next().unwrap_or("");
    first.trim().trim_matches('"')
}

fn is_name(text: &str) -> bool {
    let of = |c: char| c.is_ascii_alphanumeric() || c == '_';
    !text.is_empty() && text.chars().all(of)
}

/// True if an index names the only extruder.
fn is_first(index: &str) -> bool {
    FIRST_TOOL.contains(&index) || index == "filament_extruder_id"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(template: &str) -> String {
        let mut values = Values::default();
        for (key, value) in [
            ("printer_notes", "PRINTER_MODEL_MK3\nPRINTER_HAS_BOWDEN"),
            ("wipe_speed", "40"),
            ("nozzle_diameter", "0.4,0.4"),
            ("filament_vendor", "Generic"),
            ("evil", "}{endif}\nM112"),
        ] {
            values.set(key, vec![value.to_owned()]);
        }
        fill(template, &values, &|name| name == "nozzle_diameter").text
    }

    #[test]
    fn the_profiles_own_values_are_put_in() {
        for (template, expected) in [
            ("G1 F{wipe_speed*60}", "G1 F{40*60}"),
            ("G1 F[wipe_speed] ; [wipe_speed]", "G1 F40 ; [wipe_speed]"),
            (
                "{if filament_vendor[0]==\"wipe_speed\"}",
                "{if \"Generic\"==\"wipe_speed\"}",
            ),
            ("{if printer_notes=~/.*MK3.*/ and 1}", "{if true and 1}"),
            ("{if printer_notes!~/.*MK3.*/}", "{if false}"),
            ("{if printer_notes=~/MK3/}", "{if false}"),
            // This name is understood, so it is looked up later.
            ("{nozzle_diameter[0]}", "{nozzle_diameter[0]}"),
            ("{nozzle_diameter[0]=~/0.4.*/}", "{true}"),
            ("{wipe_speed[1]} [other] {x}", "{wipe_speed[1]} [other] {x}"),
            (
                "{is_nil(idle_temperature[0]) ? 150 : idle_temperature[0]}",
                "{true ? 150 : 0}",
            ),
            ("M141 S[chamber_temperature]", "M141 S0"),
            // A value cannot bring commands with it.
            ("{evil} [evil]", "{evil} [evil]"),
            (
                "{printer_notes=~/((((a{9}){9}){9}){9}){9}/}",
                "{printer_notes=~/((((a{9}){9}){9}){9}){9}/}",
            ),
        ] {
            assert_eq!(filled(template), expected, "{template}");
        }
    }

    #[test]
    fn templates_that_would_be_long_or_take_long_stay_as_they_are() {
        let mut values = Values::default();
        values.set("long", vec!["x".repeat(2000)]);
        values.set("text", vec!["a".repeat(10_000)]);
        let all = |unit: &str| unit.repeat(400_000 / unit.len());
        for (template, refused) in [
            (all("[long]"), true),
            (all("{long}"), true),
            (all("{text=~/(a*)*b/}"), true),
            (all("{a {a {a").repeat(2), true),
            (all("["), false),
            (all("{"), false),
            (format!("{{{}}}", all("is_nil(")), false),
            (format!("{{{}", all("text[")), false),
            (format!("{{{}", all("text=~/")), false),
        ] {
            // Other programs may hold this one up, so its own time counts.
            let started = cpu_time::ThreadTime::now();
            let filled = fill(&template, &values, &|_| false);
            let start = &template[..16];
            assert!(filled.text == template, "{start}");
            assert_eq!(filled.refused.is_some(), refused, "{start}");
            assert!(started.elapsed().as_secs() < 5, "{start}");
        }
    }
}
