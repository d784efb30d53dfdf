//! A place in a JSON result that knows its own address.

use serde::de::DeserializeOwned;
use serde_json::Value;

/// A value inside a result, with the JSON pointer (RFC 6901) that leads to it.
#[derive(Clone, Debug)]
pub struct Place<'a> {
    value: &'a Value,
    pointer: String,
}

impl<'a> Place<'a> {
    /// The whole result.
    pub fn root(value: &'a Value) -> Self {
        Place {
            value,
            pointer: String::new(),
        }
    }

    /// The value under `path`, keys and indices separated by `/`; `None` when it is absent or null.
    pub fn get(&self, path: &str) -> Option<Place<'a>> {
        let value = self.value.pointer(&format!("/{path}"))?;
        (!value.is_null()).then(|| Place {
            value,
            pointer: self.pointer_to(path),
        })
    }

    /// The JSON pointer to something below this place.
    pub fn pointer_to(&self, path: &str) -> String {
        format!("{}/{path}", self.pointer)
    }

    /// The JSON pointer to this place.
    pub fn pointer(&self) -> &str {
        &self.pointer
    }

    /// The elements of the array under `path`; none when there is no array.
    pub fn items(&self, path: &str) -> Vec<Place<'a>> {
        let length = self.get(path).and_then(|place| place.value.as_array());
        (0..length.map_or(0, Vec::len))
            .filter_map(|k| self.get(&format!("{path}/{k}")))
            .collect()
    }

    /// The text under `path`; empty when there is none.
    pub fn text(&self, path: &str) -> &'a str {
        let text = self.get(path).and_then(|place| place.value.as_str());
        text.unwrap_or_default()
    }

    /// The value under `path` as one of a type's own; `None` when it is absent or of no such kind.
    pub fn read<T: DeserializeOwned>(&self, path: &str) -> Option<T> {
        T::deserialize(self.get(path)?.value).ok()
    }

    /// This value as text; empty when it is not text.
    pub fn as_text(&self) -> &'a str {
        self.value.as_str().unwrap_or_default()
    }

    /// The number under `path`.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.get(path)?.value.as_f64()
    }

    /// Whether the value under `path` is `true`.
    pub fn is_true(&self, path: &str) -> bool {
        self.get(path).and_then(|place| place.value.as_bool()) == Some(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_place_remembers_its_address() {
        let value =
            json!({"rows": [{"r": [1.0, 2.5]}, null, {"r": [3.0]}], "name": "x", "none": null});
        let root = Place::root(&value);
        let rows = root.items("rows");
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[1].pointer(), "/rows/2");
        let deep = rows[0].pointer_to("r/1");
        assert_eq!(value.pointer(&deep), Some(&json!(2.5)));
        assert_eq!(rows[0].number("r/1"), Some(2.5));
        assert_eq!(root.text("name"), "x");
        assert!(root.get("none").is_none() && root.text("none").is_empty());
        assert!(root.items("name").is_empty());
    }
}
