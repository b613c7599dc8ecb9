//! Output of a command: the keys of its JSON document, and the lines for people, added in the order of computation.

use std::fmt;

use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};

use crate::quantity::Rows;

/// An answer, or an object within one.
#[derive(Default)]
pub(crate) struct Document {
    /// Text before the rows.
    text: String,
    keys: Vec<(&'static str, Box<dyn erased_serde::Serialize>)>,
    rows: Rows,
}

/// An object within an answer, from its keys: `object! { "x_m": x, "y_m": y }`.
macro_rules! object {
    ($($name:literal: $value:expr),* $(,)?) => {{
        let mut object = $crate::document::Document::default();
        $(object.key($name, $value);)*
        object
    }};
}
pub(crate) use object;

impl Document {
    /// Without keys; for people this stands first.
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }

    /// Adds a JSON key, behind those that are there.
    pub(crate) fn key(&mut self, name: &'static str, value: impl Serialize + 'static) -> &mut Self {
        self.keys.push((name, Box::new(value)));
        self
    }

    /// Adds a JSON key where there is a value; else it is left out.
    pub(crate) fn key_if(
        &mut self,
        name: &'static str,
        value: Option<impl Serialize + 'static>,
    ) -> &mut Self {
        if let Some(value) = value {
            self.key(name, value);
        }
        self
    }

    /// Adds a line for people, of a label and a value.
    pub(crate) fn row(&mut self, label: impl Into<String>, value: impl Into<String>) -> &mut Self {
        self.rows.row(label, value);
        self
    }
}

impl Serialize for Document {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.keys.len()))?;
        for (name, value) in &self.keys {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

impl fmt::Display for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = if self.text.is_empty() || self.rows.is_empty() {
            ""
        } else {
            "\n"
        };
        write!(f, "{}{end}{}", self.text, self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_lines_stay_in_order() {
        let mut document = Document::new("title");
        assert_eq!(document.to_string(), "title");
        document
            .key("z", object! { "b": 0.1_f32, "a": f64::NAN })
            .row("label", "value")
            .key_if("y", None::<u8>)
            .key_if("x", Some([1, 2]));
        assert_eq!(
            serde_json::to_string(&document).unwrap(),
            r#"{"z":{"b":0.1,"a":null},"x":[1,2]}"#
        );
        assert_eq!(document.to_string(), "title\n  label  value");
    }
}
