//! Cura: `.curaprofile` and `.inst.cfg`, whose values are in `[values]`, and
//! the definitions of printers, `.def.json`.

use crate::values::{Values, plain_text};
use crate::{Error, MOST_BYTES, archive, bytes_of};
use serde_json::Value;
use std::io::Cursor;
use std::path::Path;

/// Greatest number of files in a `.curaprofile`. Each has one or two per
/// extruder.
const MOST_PARTS: usize = 64;
/// Greatest length of one of these files, unpacked, bytes.
const MOST_PART: u64 = 1 << 20;
/// Greatest number of definitions that inherit from one another in a row.
const DEEPEST: usize = 32;
/// Greatest depth of a definition's nested settings.
const DEEPEST_NESTING: usize = 64;

/// The values in a `.curaprofile`.
///
/// # Errors
/// A sentence, if the file is not a `.curaprofile`, or is too large.
pub(crate) fn zipped(bytes: Vec<u8>) -> Result<Values, String> {
    let what = "a profile of Cura has";
    let mut archive = archive::open(Cursor::new(bytes), MOST_PARTS, what)?;
    let mut all = Values::default();
    // The file that belongs to no extruder comes first, then that of the first
    // extruder.
    let mut parts = Vec::new();
    for i in 0..archive.len() {
        let part = archive.by_index(i).map_err(archive::damaged)?;
        let text = archive::unpacked(part, MOST_PART, "a file in it")?;
        parts.push(instance(&String::from_utf8_lossy(&text)));
    }
    parts.sort_by_key(|(position, _)| *position);
    for (position, values) in parts {
        if position.is_none_or(|p| p == 0) {
            let mut merged = values;
            merged.inherit(&all);
            all = merged;
        }
    }
    if all.is_empty() {
        return Err("there are no values in it".to_owned());
    }
    Ok(all)
}

/// The extruder and the values of an instance's text.
pub(crate) fn instance(text: &str) -> (Option<u32>, Values) {
    let mut values = Values::default();
    let mut position = None;
    let mut section = "";
    let mut last: Option<(String, String)> = None;
    let mut keep = |last: &mut Option<(String, String)>| {
        if let Some((key, value)) = last.take() {
            values.set(&key, vec![value]);
        }
    };
    for line in text.lines() {
        // A value goes on in the lines that are indented.
        if line.starts_with([' ', '\t'])
            && let Some((_, value)) = &mut last
        {
            value.push('\n');
            value.push_str(line.trim());
            continue;
        }
        keep(&mut last);
        let line = line.trim();
        if let Some(head) = line.strip_prefix('[') {
            section = head.trim_end_matches(']');
        } else if let Some((key, value)) = line.split_once('=')
            && !line.starts_with(['#', ';'])
        {
            let (key, value) = (key.trim(), value.trim());
            match section {
                "values" => last = Some((key.to_owned(), value.to_owned())),
                "metadata" if key == "position" => {
                    position = value.parse().ok();
                }
                _ => {}
            }
        }
    }
    keep(&mut last);
    (position, values)
}

/// The values of a printer's definition and of those that it inherits from, in
/// its folder, and the printer's name.
///
/// # Errors
/// If a definition is missing or damaged, or if they inherit in a circle.
pub(crate) fn definition(
    path: &Path,
    json: &Value,
) -> Result<(Values, Option<String>), Error> {
    let name = json["name"].as_str().map(ToOwned::to_owned);
    let mut all = Values::default();
    let mut names = Vec::new();
    let mut current = json.clone();
    loop {
        let mut own = Values::default();
        gather(&current["overrides"], &mut own, 0);
        gather(&current["settings"], &mut own, 0);
        all.inherit(&own);
        let Some(parent) = current["inherits"].as_str() else {
            return Ok((all, name));
        };
        // These two definitions have the settings of all printers, which are
        // Cura's own defaults.
        if matches!(parent, "fdmprinter" | "fdmextruder") {
            return Ok((all, name));
        }
        let wrong = Error::wrong(path);
        if names.iter().any(|n| n == parent) {
            return Err(wrong(format!(
                "definitions inherit in a circle: {parent:?} inherits from \
                 itself"
            )));
        }
        names.push(parent.to_owned());
        if names.len() > DEEPEST || parent.contains(['/', '\\']) {
            return Err(wrong(format!(
                "it inherits {parent:?}, which is too far away"
            )));
        }
        let file = path.with_file_name(format!("{parent}.def.json"));
        if !file.is_file() {
            return Err(wrong(format!(
                "it inherits {parent:?}, and there is no {} beside it",
                file.display()
            )));
        }
        let text = bytes_of(&file, MOST_BYTES)?;
        current = serde_json::from_slice(&text)
            .map_err(|e| Error::wrong(&file)(format!("it is not JSON: {e}")))?;
    }
}

/// Takes the values out of nested settings. A formula, `value`, counts before
/// `default_value`.
fn gather(settings: &Value, into: &mut Values, depth: usize) {
    let Value::Object(settings) = settings else {
        return;
    };
    if depth > DEEPEST_NESTING {
        return;
    }
    for (key, setting) in settings {
        let of = |name: &str| setting.get(name).and_then(plain_text);
        if let Some(value) = of("value").or_else(|| of("default_value")) {
            into.set(key, vec![value]);
        }
        gather(&setting["children"], into, depth + 1);
    }
}
