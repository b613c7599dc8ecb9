//! JSON Schema of the output types, in the form of the generator.

use std::borrow::Cow;

use serde_json::{Map, Value};

/// Schemas by the names of their types.
pub(super) struct Schemas(Map<String, Value>);

/// A property of an object.
pub(super) struct Property<'a> {
    /// Key.
    pub(super) key: &'a str,
    /// Schema of the value.
    pub(super) schema: &'a Value,
    /// The key is always there.
    pub(super) required: bool,
}

impl Schemas {
    pub(super) fn new(definitions: Map<String, Value>) -> Self {
        Self(definitions)
    }

    /// Names of the types, in alphabetical order.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Schema of a type.
    pub(super) fn named(&self, name: &str) -> &Value {
        self.0.get(name).unwrap_or(&Value::Null)
    }
}

/// Name of the type that a schema refers to.
pub(super) fn reference(schema: &Value) -> Option<&str> {
    let path = schema.get("$ref")?.as_str()?;
    path.rsplit('/').next()
}

/// Alternatives of a union.
pub(super) fn alternatives(schema: &Value) -> Option<&[Value]> {
    let union = schema.get("anyOf").or_else(|| schema.get("oneOf"))?;
    union.as_array().map(Vec::as_slice)
}

/// Properties of an object: first those that are always there, in the order of their declaration, then the others by name. Returns
/// `None` if the schema is not that of an object with known keys.
pub(super) fn properties(schema: &Value) -> Option<Vec<Property<'_>>> {
    let all = schema.get("properties")?.as_object()?;
    let required: Vec<&str> = schema
        .get("required")
        .and_then(Value::as_array)
        .map(|keys| keys.iter().filter_map(Value::as_str).collect())
        .unwrap_or_default();
    let property = |key: &'_ str, required| {
        all.get_key_value(key).map(|(key, schema)| Property {
            key,
            schema,
            required,
        })
    };
    let optional = all.keys().filter(|key| !required.contains(&key.as_str()));
    let first = required.iter().filter_map(|key| property(key, true));
    Some(
        first
            .chain(optional.filter_map(|key| property(key, false)))
            .collect(),
    )
}

/// Description from the doc comment, in one line and without links to code.
pub(super) fn description(schema: &Value) -> Option<String> {
    let text = schema.get("description")?.as_str()?;
    let mut line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    while let Some(start) = line.find("[`") {
        let end = line[start..].find("`]").map(|at| start + at)?;
        let mut after = &line[end + 2..];
        if after.starts_with('(') {
            after = after.split_once(')').map_or("", |(_, after)| after);
        }
        line = format!("{}`{}`{after}", &line[..start], &line[start + 2..end]);
    }
    Some(line)
}

/// The same with rustdoc's escapes removed, for text that is not Markdown.
pub(super) fn plain_description(schema: &Value) -> Option<Cow<'static, str>> {
    let line = description(schema)?;
    Some(line.replace("\\[", "[").replace("\\]", "]").into())
}

/// Number of items of a list of fixed length.
pub(super) fn fixed_length(schema: &Value) -> Option<usize> {
    let bound = |key| schema.get(key).and_then(Value::as_u64);
    let length = bound("minItems").filter(|least| Some(*least) == bound("maxItems"))?;
    usize::try_from(length).ok()
}
