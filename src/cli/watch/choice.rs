//! What the page's user has changed, on top of the command line.

use crate::cli::args::{ModelArgs, SettingsSource};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Greatest number of changes, and greatest length of a name or a value in
/// bytes: more than people ever make.
const MOST_CHANGES: usize = 1000;
const LONGEST: usize = 16 << 10;

/// Names that have been changed, and their values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Choice {
    /// Profiles by their kind: `printer`, `filament` or `preset`. A kind
    /// without a value has no profile.
    pub profiles: BTreeMap<String, Option<String>>,
    /// Parameters of the script.
    pub define: BTreeMap<String, String>,
    /// Values of settings, by their keys.
    pub set: BTreeMap<String, String>,
}

impl Choice {
    /// What the command line chooses, so that the page can show it.
    pub(super) fn of(model: &ModelArgs, settings: &SettingsSource) -> Choice {
        let profiles = [
            ("printer", &settings.printer),
            ("filament", &settings.filament),
            ("preset", &settings.preset),
        ];
        Choice {
            profiles: profiles.map(|(k, v)| (k.to_owned(), v.clone())).into(),
            define: model.defines.iter().cloned().collect(),
            set: BTreeMap::new(),
        }
    }

    /// Takes over changes from JSON such as `{"define": {"cell": "8"}, "set":
    /// {"walls": null}, "printer": "prusa-mk4"}`. A null undoes a change.
    ///
    /// # Errors
    /// If the JSON has another form, or too many changes. Then nothing is
    /// changed.
    pub(super) fn change(&mut self, json: &[u8]) -> Result<(), String> {
        let malformed = |error| format!("the change is no JSON: {error}");
        let given: BTreeMap<String, Value> =
            serde_json::from_slice(json).map_err(malformed)?;
        let mut changed = self.clone();
        for (key, value) in given {
            let map = match &*key {
                "define" => &mut changed.define,
                "set" => &mut changed.set,
                name if changed.profiles.contains_key(name) => {
                    let value = text(value)?;
                    let is_path = |v: &String| {
                        v.contains(['/', '\\']) || v.ends_with(".toml")
                    };
                    if value.as_ref().is_some_and(is_path) {
                        let why = "a page chooses profiles by their names";
                        return Err(why.to_owned());
                    }
                    changed.profiles.insert(key, value);
                    continue;
                }
                _ => return Err(format!("there is no change {key:?}")),
            };
            let Value::Object(values) = value else {
                return Err(format!("{key} must have names and values"));
            };
            for (name, value) in values {
                match text(value)? {
                    Some(_) if name.len() > LONGEST => {
                        return Err("a name is too long".to_owned());
                    }
                    Some(value) => map.insert(name, value),
                    None => map.remove(&name),
                };
            }
            if map.len() > MOST_CHANGES {
                return Err(format!(
                    "more than {MOST_CHANGES} changes at once"
                ));
            }
        }
        *self = changed;
        Ok(())
    }

    /// The model with these changes.
    pub(super) fn model(&self, given: &ModelArgs) -> ModelArgs {
        let mut model = given.clone();
        model.defines = self.define.clone().into_iter().collect();
        model
    }

    /// The settings with these changes.
    pub(super) fn settings(&self, given: &SettingsSource) -> SettingsSource {
        let mut settings = given.clone();
        let profile = |kind| self.profiles.get(kind).cloned().flatten();
        settings.printer = profile("printer");
        settings.filament = profile("filament");
        settings.preset = profile("preset");
        let set = self.set.iter().map(|(k, v)| format!("{k}={v}"));
        settings.set.extend(set);
        settings
    }
}

fn text(value: Value) -> Result<Option<String>, String> {
    match value {
        Value::Null => Ok(None),
        Value::String(text) if text.len() <= LONGEST => Ok(Some(text)),
        _ => Err("a value must be a text, and not too long".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice() -> Choice {
        Choice {
            profiles: [("printer".to_owned(), None)].into(),
            ..Choice::default()
        }
    }

    #[test]
    fn changes_are_made_and_taken_back() {
        let mut choice = choice();
        let json = br#"{"define":{"a":"1","b":"2"},"printer":"x"}"#;
        choice.change(json).unwrap();
        assert_eq!(choice.define["b"], "2");
        assert_eq!(choice.profiles["printer"].as_deref(), Some("x"));
        choice
            .change(br#"{"define":{"a":null},"printer":null}"#)
            .unwrap();
        assert_eq!(choice.define.len(), 1);
        assert_eq!(choice.profiles["printer"], None);
    }

    #[test]
    fn what_is_no_change_changes_nothing() {
        let deep = "[".repeat(100_000);
        let long = format!("{{\"set\":{{\"a\":\"{}\"}}}}", "1".repeat(20_000));
        let many: Vec<_> =
            (0..1001).map(|i| format!("\"{i}\":\"1\"")).collect();
        let many = format!("{{\"set\":{{{}}}}}", many.join(","));
        for bad in [
            "",
            "[]",
            "{\"set\":1}",
            "{\"set\":{\"a\":1}}",
            "{\"define\":{\"a\":\"1\"},\"other\":\"1\"}",
            "{\"profiles\":\"1\"}",
            &deep,
            &long,
            &many,
        ] {
            let mut changed = choice();
            assert!(changed.change(bad.as_bytes()).is_err(), "{bad:.60}");
            assert_eq!(changed, choice());
        }
    }
}
