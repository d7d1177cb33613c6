//! Plate files as a JSON Schema, by which editors complete and check them.

use super::shared::is_shared;
use super::{Plate, PlateFile};
use isoslice_settings::Settings;
use serde_json::{Map, Value, json};

impl PlateFile {
    /// The schema of a plate file, of the 2020-12 draft. The schema has the
    /// program's types, words and ranges.
    pub fn schema() -> Value {
        let all = properties(|_| true);
        let of_part = properties(|key| !is_shared(key));
        let positive = json!({ "type": "number", "exclusiveMinimum": 0 });
        let number = json!({ "type": "number" });
        let several = |count: u32| {
            json!({
                "type": "array",
                "items": number,
                "minItems": count,
                "maxItems": count,
            })
        };
        let described = |mut value: Value, text: &str| {
            value["description"] = text.into();
            value
        };
        let part = json!({
            "type": "object",
            "required": ["model"],
            "additionalProperties": false,
            "not": { "required": ["scale", "size"] },
            "properties": {
                "model": {
                    "type": "string",
                    "minLength": 1,
                    "description": "The model's file, from the plate file's folder.",
                },
                "copies": {
                    "type": "integer",
                    "minimum": 1,
                    "maximum": Plate::MOST_PARTS,
                    "description": "How many.",
                },
                "params": {
                    "type": "object",
                    "additionalProperties": {
                        "type": ["number", "string", "boolean"],
                    },
                    "description": "Parameters of the script.",
                },
                "at": described(
                    several(2),
                    "Where the middle of its box stands on the bed, mm.",
                ),
                "lay": {
                    "type": "boolean",
                    "description": "Whether it is laid on its largest flat side.",
                },
                "rotate": {
                    "anyOf": [number, several(3)],
                    "description": "Degrees about z, or about x, y and z.",
                },
                "scale": described(positive.clone(), "A factor."),
                "size": described(positive, "Its largest side, mm."),
                "settings": described(of_part, "Settings of this part alone."),
            },
        });
        json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "Plate file of isoslice",
            "type": "object",
            "required": ["part"],
            "additionalProperties": false,
            "properties": {
                "settings": described(all, "Settings of all parts."),
                "part": {
                    "type": "array",
                    "items": part,
                    "minItems": 1,
                    "maxItems": Plate::MOST_PARTS,
                    "description": "The parts, each below a line [[part]].",
                },
            },
        })
    }
}

/// The settings that a table may hold.
fn properties(holds: impl Fn(&str) -> bool) -> Value {
    let mut schema = Settings::schema();
    let all = match schema["properties"].take() {
        Value::Object(all) => all,
        _ => Map::new(),
    };
    let mut kept = Map::new();
    for (name, mut value) in all {
        let Some(inner) = value["properties"].as_object_mut() else {
            // `description` and `inherits` are for profiles.
            let known =
                isoslice_settings::keys().iter().any(|key| key.name == name);
            if known && holds(&name) {
                kept.insert(name, value);
            }
            continue;
        };
        inner.retain(|leaf, _| holds(&format!("{name}.{leaf}")));
        if !inner.is_empty() {
            kept.insert(name, value);
        }
    }
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": kept,
    })
}
