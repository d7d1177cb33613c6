//! The settings as a JSON Schema, by which editors complete and check settings
//! files while they are written.
//!
//! In: the table. Out: a schema of the 2020-12 draft. The schema has the
//! program's types, words and ranges. Only the program checks how settings fit
//! together. Profiles fit the schema as well.

use super::rows::Settings;
use super::table::{Key, keys};
use super::value::{Form, ValueKind};
use serde_json::{Map, Value, json};

/// Pattern of the beginning of an expression.
const EXPRESSION: &str = "^\\s*expr:";
/// Pattern of a share with its sign.
const SHARE: &str = "^\\s*[-+]?[0-9]*\\.?[0-9]+([eE][-+]?[0-9]+)?\\s*%\\s*$";

/// Pattern of a length with its unit.
const LENGTH: &str = "^\\s*[0-9]*\\.?[0-9]+([eE][-+]?[0-9]+)?\\s*mm\\s*$";
/// Pattern of values by steps.
const STEPS: &str = "^[^:]+:[^:]+(,[^:]+:[^:]+)*$";

impl Settings {
    /// The schema of a settings file.
    pub fn schema() -> Value {
        let mut top = Map::new();
        for (name, text) in [
            ("description", "What a profile is for; in profiles only."),
            (
                "inherits",
                "The profile that this one starts from; in profiles only.",
            ),
        ] {
            top.insert(
                name.to_owned(),
                json!({ "type": "string", "description": text }),
            );
        }
        for key in keys() {
            let group = match key.group() {
                "" => &mut top,
                group => {
                    let table = top.entry(group).or_insert_with(|| {
                        json!({
                            "type": "object",
                            "description": key.section(),
                            "additionalProperties": false,
                            "properties": {},
                        })
                    });
                    let Some(inner) = table["properties"].as_object_mut()
                    else {
                        continue;
                    };
                    inner
                }
            };
            group.insert(key.leaf().to_owned(), of(key));
        }
        json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "Settings of isoslice",
            "type": "object",
            "additionalProperties": false,
            "properties": top,
        })
    }
}

/// The schema of a setting's value.
fn of(key: &Key) -> Value {
    let mut number = json!({ "type": "number" });
    if let Some(range) = key.range {
        let least = if range.or_zero { 0.0 } else { range.min };
        number["minimum"] = least.into();
        number["maximum"] = range.max.into();
        if range.or_zero {
            number["not"] = json!({
                "exclusiveMinimum": 0.0,
                "exclusiveMaximum": range.min,
            });
        }
    }
    let mut whole = number.clone();
    whole["type"] = "integer".into();
    let share = json!({ "type": "string", "pattern": SHARE });
    let expression = json!({ "type": "string", "pattern": EXPRESSION });
    let auto = json!({ "const": "auto" });
    let text = json!({ "type": "string" });
    let words = |words: &[&str]| json!({ "enum": words });
    let mut all = match key.kind() {
        ValueKind::Number => vec![number],
        ValueKind::Whole => vec![whole],
        ValueKind::WholeOrAuto => vec![whole, auto],
        ValueKind::NumberOrAuto => vec![number, auto],
        ValueKind::Varying => vec![number, expression],
        ValueKind::ByNozzle => vec![number, auto, share.clone()],
        ValueKind::Switch => vec![json!({ "type": "boolean" })],
        ValueKind::Text | ValueKind::Sizes => vec![text],
        ValueKind::NumberOrText(_, forms) => with_texts(number, forms),
        ValueKind::WholeOrText(_, forms) => with_texts(whole, forms),
        ValueKind::SwitchOrWhole => vec![json!({ "type": "boolean" }), whole],
        ValueKind::SwitchOrNumber => vec![json!({ "type": "boolean" }), number],
        ValueKind::Word(all) => vec![words(all)],
        ValueKind::WordOrText(all, forms) => with_texts(words(all), forms),
        ValueKind::WordOrNumber(all) => vec![words(all), number],
        ValueKind::WordOrWhole(all) => vec![words(all), whole],
    };
    if key.unit == "%" && takes_shares(key.kind()) {
        all.push(share);
    }
    let mut out = match <[Value; 1]>::try_from(all) {
        Ok([only]) => only,
        Err(all) => json!({ "anyOf": all }),
    };
    let unit = match key.unit {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    out["description"] = format!("{}{unit}", key.description()).into();
    // Editors show the default. It is written in TOML, which is also JSON for
    // all of these values.
    if let Ok(default) = serde_json::from_str::<Value>(&key.default()) {
        out["default"] = default;
    }
    out
}

/// True if numbers of a setting in % may have their sign.
fn takes_shares(kind: ValueKind) -> bool {
    matches!(
        kind,
        ValueKind::Number | ValueKind::Varying | ValueKind::SwitchOrNumber
    )
}

/// A value of another schema, or texts of these forms.
fn with_texts(other: Value, forms: &[Form]) -> Vec<Value> {
    let text = |form: &Form| match form {
        Form::Like(_, pattern) => {
            json!({ "type": "string", "pattern": pattern })
        }
        Form::Script => json!({ "type": "string", "pattern": "\\.rhai$" }),
        Form::Auto => json!({ "const": "auto" }),
        Form::Length => json!({ "type": "string", "pattern": LENGTH }),
        Form::Share => json!({ "type": "string", "pattern": SHARE }),
        Form::Steps => json!({ "type": "string", "pattern": STEPS }),
        Form::Expression => json!({ "type": "string", "pattern": EXPRESSION }),
    };
    std::iter::once(other)
        .chain(forms.iter().map(text))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped::SHIPPED;

    /// True if a value fits a schema. Only what this schema uses of the
    /// language is known.
    fn fits(schema: &Value, value: &toml::Value) -> bool {
        if let Some(any) = schema["anyOf"].as_array() {
            return any.iter().any(|one| fits(one, value));
        }
        if let Some(words) = schema["enum"].as_array() {
            return words.iter().any(|w| w.as_str() == value.as_str());
        }
        if let Some(word) = schema["const"].as_str() {
            return value.as_str() == Some(word);
        }
        let number = match value {
            toml::Value::Integer(i) => Some(*i as f64),
            toml::Value::Float(f) => Some(*f),
            _ => None,
        };
        let within = || {
            let least = schema["minimum"].as_f64().unwrap_or(f64::NEG_INFINITY);
            let most = schema["maximum"].as_f64().unwrap_or(f64::INFINITY);
            number.is_some_and(|n| (least..=most).contains(&n))
        };
        match schema["type"].as_str() {
            Some("number") => within(),
            Some("integer") => value.is_integer() && within(),
            Some("boolean") => value.is_bool(),
            Some("string") => value.as_str().is_some_and(|text| {
                let text = text.trim();
                match schema["pattern"].as_str() {
                    None => true,
                    Some(EXPRESSION) => text.starts_with("expr:"),
                    Some(SHARE) => {
                        let number = text.strip_suffix('%').map(str::trim);
                        number.is_some_and(|n| n.parse::<f64>().is_ok())
                    }
                    Some(LENGTH) => {
                        let number = text.strip_suffix("mm").map(str::trim);
                        number.is_some_and(|n| n.parse::<f64>().is_ok())
                    }
                    Some(STEPS) => {
                        text.split(',').all(|step| step.split(':').count() == 2)
                    }
                    Some(_) => text.ends_with(".rhai"),
                }
            }),
            Some("object") => value.as_table().is_some_and(|table| {
                table.iter().all(|(name, value)| {
                    let inner = &schema["properties"][name];
                    !inner.is_null() && fits(inner, value)
                })
            }),
            _ => false,
        }
    }

    fn check(text: &str) -> bool {
        let table: toml::Table = text.parse().unwrap();
        fits(&Settings::schema(), &toml::Value::Table(table))
    }

    #[test]
    fn what_the_program_writes_and_ships_fits() {
        assert!(check(&crate::Settings::default().to_toml()));
        for (_, name, text) in SHIPPED {
            assert!(check(text), "{name}");
        }
    }

    #[test]
    fn mistakes_do_not_fit() {
        for (good, bad) in [
            ("walls = 3", "walls = 2.5"),
            ("layer_height = 0.2", "layer_height = 200"),
            ("infill = \"gyroid\"", "infill = \"gyriod\""),
            ("infill = \"expr: x\"", "infill = 3"),
            ("top_layers = \"auto\"", "top_layers = \"some\""),
            ("top_layers = \"0.8 mm\"", "top_layers = 0.8"),
            (
                "[speed]\noverhang = \"25: 30\"",
                "[speed]\noverhang = \"fast\"",
            ),
            (
                "[support]\ninterface_density = \"0.8 mm\"",
                "[support]\ninterface_density = \"dense\"",
            ),
            (
                "[cooling]\noverhang_fan_speed = \"25: 50, 100: 100\"",
                "[cooling]\noverhang_fan_speed = \"off\"",
            ),
            ("[speed]\nouter_wall = 30", "[speed]\nouter_wal = 30"),
            ("spiral = 2", "spiral = \"on\""),
            ("seam_scarf = \"20 mm\"", "seam_scarf = \"20 m\""),
            ("bridge_flow = \"90%\"", "bridge_flow = \"90\""),
        ] {
            assert!(check(good), "{good}");
            assert!(!check(bad), "{bad}");
        }
    }

    #[test]
    fn every_setting_is_told_of() {
        let schema = Settings::schema();
        for key in keys() {
            let properties = &schema["properties"];
            let of_key = match key.group() {
                "" => &properties[key.leaf()],
                group => &properties[group]["properties"][key.leaf()],
            };
            let told = of_key["description"].as_str();
            assert!(told.is_some_and(|t| t.len() > 10), "{}", key.name);
        }
    }
}
