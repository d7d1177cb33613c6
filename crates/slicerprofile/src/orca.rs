//! The `.json` of OrcaSlicer and Bambu Studio. A file has one profile, which
//! may inherit from another profile in a file beside it.

use crate::parents::Parents;
use crate::values::{Values, plain_text};
use crate::{Error, MOST_BYTES, PresetKind, bytes_of};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Greatest number of profiles that inherit from one another in a row.
const DEEPEST: usize = 32;

/// One file's own values.
pub(crate) struct Own {
    pub(crate) kind: Option<PresetKind>,
    pub(crate) name: Option<String>,
    inherits: Option<String>,
    pub(crate) values: Values,
}

/// Reads a file's text.
///
/// # Errors
/// A sentence, if the text is not such a profile.
pub(crate) fn read(text: &str) -> Result<Own, String> {
    let json: Value = serde_json::from_str(text)
        .map_err(|e| format!("it is not JSON: {e}"))?;
    let Value::Object(entries) = json else {
        return Err("it is not a profile: an object is expected".to_owned());
    };
    let mut values = Values::default();
    for (key, value) in &entries {
        let items = match value {
            Value::Array(items) => {
                items.iter().filter_map(plain_text).collect()
            }
            one => plain_text(one).into_iter().collect(),
        };
        values.set(key, items);
    }
    let mut head = |key: &str| {
        let text = values.take(key)?.into_iter().next()?;
        (!text.is_empty()).then_some(text)
    };
    let kind = head("type").and_then(|word| PresetKind::of_word(&word));
    Ok(Own {
        kind,
        name: head("name"),
        inherits: head("inherits"),
        values,
    })
}

/// A file's values with those that it inherits. Each parent is looked for
/// beside the file that inherits from it, in the folders of the same kind, and
/// in `beside`.
///
/// # Errors
/// If a file is missing or cannot be read, or if files inherit in a circle.
pub(crate) fn resolve(
    path: &Path,
    own: Own,
    beside: &[PathBuf],
) -> Result<Own, Error> {
    let wrong = Error::wrong(path);
    let mut all = own;
    let mut names: Vec<String> = all.name.clone().into_iter().collect();
    let mut heir =
        std::path::absolute(path).map_err(Error::unreadable(path))?;
    let mut parents = Parents::new(heir.clone(), beside);
    while let Some(parent) = all.inherits.take() {
        if names.contains(&parent) {
            names.push(parent);
            return Err(wrong(format!(
                "profiles inherit in a circle: {}",
                names.join(", which inherits ")
            )));
        }
        if names.len() > DEEPEST {
            return Err(wrong(format!(
                "more than {DEEPEST} profiles inherit from one another"
            )));
        }
        let found = parents.find(&heir, &parent)?;
        let Some(found) = found else {
            return Err(wrong(format!(
                "it inherits {parent:?}, which is not in the files beside \
                 it; name the folder where the slicer keeps its own profiles \
                 with --beside, often …/system/VENDOR"
            )));
        };
        let text = bytes_of(&found, MOST_BYTES)?;
        let text = String::from_utf8_lossy(&text);
        let text = text.trim_start_matches('\u{feff}');
        let from = read(text).map_err(Error::wrong(&found))?;
        all.values.inherit(&from.values);
        all.kind = all.kind.or(from.kind);
        all.inherits = from.inherits;
        names.push(parent);
        heir = found;
    }
    Ok(all)
}
