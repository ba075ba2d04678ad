//! Stored form of a result.

use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use serde_json::value::RawValue;

/// The document of a result as JSON text. It never changes, so copies of a session share it: that of an
/// identification grows with the poses, and as JSON values it would take several times the memory.
#[derive(Debug, Clone)]
pub struct ResultDocument {
    text: Arc<RawValue>,
    format: Option<Arc<str>>,
}

/// The part of a document that is needed to identify it.
#[derive(Deserialize)]
struct Head {
    #[serde(default)]
    format: Value,
}

impl ResultDocument {
    /// The document in the form written with `--json`.
    ///
    /// # Errors
    /// If it has keys that are not strings.
    pub fn of(document: &impl Serialize) -> serde_json::Result<Self> {
        serde_json::value::to_raw_value(document).map(Self::from)
    }

    /// Its `format`, if stated.
    #[must_use]
    pub fn format(&self) -> Option<&str> {
        self.format.as_deref()
    }

    /// Its values, parsed anew at each call.
    #[must_use]
    pub fn value(&self) -> Value {
        // The text was valid JSON when it was stored.
        serde_json::from_str(self.text.get()).unwrap_or_default()
    }
}

impl Default for ResultDocument {
    /// An empty document.
    fn default() -> Self {
        Self::from(Box::<RawValue>::default())
    }
}

impl From<Box<RawValue>> for ResultDocument {
    fn from(text: Box<RawValue>) -> Self {
        // Documents that are not objects state no format.
        let head: Option<Head> = serde_json::from_str(text.get()).ok();
        let format = head.and_then(|head| head.format.as_str().map(Arc::from));
        Self {
            text: text.into(),
            format,
        }
    }
}

impl PartialEq for ResultDocument {
    /// Compares by content: the order of keys and white space do not matter.
    fn eq(&self, other: &Self) -> bool {
        self.text.get() == other.text.get() || self.value() == other.value()
    }
}

impl Serialize for ResultDocument {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.text.serialize(to)
    }
}

impl<'de> Deserialize<'de> for ResultDocument {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Box::<RawValue>::deserialize(from).map(Self::from)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn it_is_kept_and_compared_by_what_it_says() {
        let value = json!({"format": "tautline-identification", "chi2": 0.1, "poses": [1, null]});
        let document = ResultDocument::of(&value).expect("JSON");
        assert_eq!(document.format(), Some("tautline-identification"));
        assert_eq!(document.value(), value);
        let spaced = r#"{"poses": [1, null], "chi2": 1e-1, "format": "tautline-identification"}"#;
        let read: ResultDocument = serde_json::from_str(spaced).expect("JSON");
        assert_eq!(read, document);
        let of_values: ResultDocument = serde_json::from_value(value).expect("a document");
        assert_eq!(of_values, document);
        for none in [json!([1]), json!({"format": 3}), json!(null)] {
            assert_eq!(ResultDocument::of(&none).expect("JSON").format(), None);
        }
        assert_ne!(ResultDocument::of(&json!({})).expect("JSON"), document);
    }
}
