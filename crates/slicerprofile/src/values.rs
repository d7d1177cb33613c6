//! The values of a profile, as its slicer wrote them.

use std::collections::BTreeMap;

/// Values by key. A value may have several items, one for each extruder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(BTreeMap<String, Vec<String>>);

impl Values {
    /// Sets the items of a key.
    pub fn set(&mut self, key: &str, items: Vec<String>) {
        self.0.insert(key.to_owned(), items);
    }

    /// Sets the items of a key that has none.
    pub(crate) fn set_missing(&mut self, key: &str, items: &[String]) {
        if !self.0.contains_key(key) {
            self.0.insert(key.to_owned(), items.to_vec());
        }
    }

    /// Takes over the values of `others` for keys that have no value here.
    pub(crate) fn inherit(&mut self, others: &Values) {
        for (key, items) in &others.0 {
            self.set_missing(key, items);
        }
    }

    /// Takes a key out.
    pub(crate) fn take(&mut self, key: &str) -> Option<Vec<String>> {
        self.0.remove(key)
    }

    /// The keys, sorted.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Number of keys.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there are no keys.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if the key has a value of its own.
    pub fn has(&self, key: &str) -> bool {
        self.text(key).is_some() && !self.is_nil(key)
    }

    /// True if the key says that it has no value of its own: `nil`, or
    /// `nil,nil` for two extruders, of which the first counts.
    pub(crate) fn is_nil(&self, key: &str) -> bool {
        let first = self.text(key).and_then(|text| text.split(',').next());
        first.is_some_and(|first| first.trim() == "nil")
    }

    /// The first item as a whole, for G-code or a name.
    pub fn text(&self, key: &str) -> Option<&str> {
        Some(self.0.get(key)?.first()?.trim())
    }

    /// The first item up to a comma or semicolon, which is the first
    /// extruder's. Empty values and `nil` count as no value.
    pub fn first(&self, key: &str) -> Option<&str> {
        let text = self.text(key)?;
        let first = text.split([',', ';']).next().unwrap_or("");
        let first = first.trim().trim_matches('"');
        (!first.is_empty() && first != "nil").then_some(first)
    }

    /// The first item as a number; none for a share such as `15%`.
    pub fn number(&self, key: &str) -> Option<f64> {
        parse(self.first(key)?)
    }

    /// All items of a list, or of a text with commas.
    pub fn list(&self, key: &str) -> Vec<&str> {
        let Some(items) = self.0.get(key) else {
            return Vec::new();
        };
        match items.as_slice() {
            [one] => one.split(',').map(str::trim).collect(),
            many => many.iter().map(|item| item.trim()).collect(),
        }
    }

    /// All items as one text, for messages.
    pub fn shown(&self, key: &str) -> String {
        self.0.get(key).map_or_else(String::new, |v| v.join(", "))
    }
}

/// A plain value of JSON as text; switches are `1` and `0`.
pub(crate) fn plain_text(value: &serde_json::Value) -> Option<String> {
    use serde_json::Value;
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Bool(yes) => Some(u8::from(*yes).to_string()),
        _ => None,
    }
}

/// The finite number that a text is, if it is one.
pub(crate) fn parse(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| x.is_finite())
}

/// The number before a percent sign.
pub(crate) fn share(text: &str) -> Option<f64> {
    parse(text.trim().strip_suffix('%')?)
}
