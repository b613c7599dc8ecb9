//! Conformance of a document to the schema of its type.

use serde_json::{Map, Value, json};

use super::schema::{Schemas, alternatives, fixed_length, reference};

/// Checks a document: its keys are those of the type, and its values have their types.
///
/// # Errors
/// The first place that differs.
pub(super) fn check(schemas: &Schemas, name: &str, value: &Value) -> Result<(), String> {
    matches(schemas, schemas.named(name), value, name)
}

fn matches(schemas: &Schemas, schema: &Value, value: &Value, place: &str) -> Result<(), String> {
    // A kept document has the key in brackets in place of a value that differs from run to run.
    let key = place.rsplit('.').next().unwrap_or_default();
    if value.as_str() == Some(&format!("[{key}]")) {
        return Ok(());
    }
    let mut failure = None;
    for plain in expanded(schemas, schema) {
        match matches_plain(schemas, &plain, value, place) {
            Ok(()) => return Ok(()),
            // The failure that is deepest in the document says most.
            Err(error) => {
                let depth = |text: &String| text.split(':').next().map_or(0, str::len);
                if failure
                    .as_ref()
                    .is_none_or(|known| depth(&error) > depth(known))
                {
                    failure = Some(error);
                }
            }
        }
    }
    Err(failure.unwrap_or_else(|| format!("{place}: no type")))
}

/// The alternatives of a schema, each without references and unions at its top.
fn expanded(schemas: &Schemas, schema: &Value) -> Vec<Value> {
    if let Some(name) = reference(schema) {
        let parts = expanded(schemas, schemas.named(name));
        return parts.iter().map(|part| merged(schema, part)).collect();
    }
    let Some(parts) = alternatives(schema) else {
        return vec![schema.clone()];
    };
    let parts = parts.iter().flat_map(|part| expanded(schemas, part));
    parts.map(|part| merged(schema, &part)).collect()
}

/// A part of a union with the properties that all parts share.
fn merged(shared: &Value, part: &Value) -> Value {
    let mut whole = part.clone();
    let Some(properties) = shared.get("properties").and_then(Value::as_object) else {
        return whole;
    };
    let object = |value: &Value| value.as_object().cloned().unwrap_or_default();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut all: Map<String, Value> = object(&whole["properties"]);
    all.extend(properties.clone());
    let mut required = list(&shared["required"]);
    required.extend(list(&whole["required"]));
    whole["type"] = json!("object");
    whole["properties"] = Value::Object(all);
    whole["required"] = Value::Array(required);
    whole
}

fn matches_plain(
    schemas: &Schemas,
    schema: &Value,
    value: &Value,
    place: &str,
) -> Result<(), String> {
    let fails = |what: String| Err(format!("{place}: {what}"));
    if let Some(constant) = schema.get("const") {
        return if constant == value {
            Ok(())
        } else {
            fails(format!("{value} is not {constant}"))
        };
    }
    if let Some(words) = schema.get("enum").and_then(Value::as_array) {
        return if words.contains(value) {
            Ok(())
        } else {
            fails(format!("{value} is none of {words:?}"))
        };
    }
    let is_of = |name: &str| match name {
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    };
    let has_type = match &schema["type"] {
        Value::String(name) => is_of(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is_of),
        _ => false,
    };
    if !has_type {
        return fails(format!("{value} is no {}", schema["type"]));
    }
    match value {
        Value::Array(items) => {
            if fixed_length(schema).is_some_and(|length| length != items.len()) {
                return fails(format!("{} items", items.len()));
            }
            for (index, item) in items.iter().enumerate() {
                let of = match schema.get("prefixItems") {
                    Some(prefix) => &prefix[index],
                    None => &schema["items"],
                };
                matches(schemas, of, item, &format!("{place}[{index}]"))?;
            }
            Ok(())
        }
        Value::Object(keys) => {
            let Some(properties) = schema["properties"].as_object() else {
                return fails("an object without keys".to_owned());
            };
            let required = schema["required"].as_array().into_iter().flatten();
            for key in required.filter_map(Value::as_str) {
                if !keys.contains_key(key) {
                    return fails(format!("no key `{key}`"));
                }
            }
            for (key, value) in keys {
                let Some(of) = properties.get(key) else {
                    return fails(format!("the type has no key `{key}`"));
                };
                matches(schemas, of, value, &format!("{place}.{key}"))?;
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

#[test]
fn other_keys_and_types_do_not_conform() {
    let schemas = Schemas::new(
        json!({
            "Part": { "type": "object", "properties": { "a": { "type": ["number", "null"] } }, "required": ["a"] },
            "Union": {
                "type": "object",
                "properties": { "kind": { "type": "string" } },
                "required": ["kind"],
                "oneOf": [{ "$ref": "#/$defs/Part" }, { "type": "object", "properties": { "b": { "const": "x" } }, "required": ["b"] }],
            },
            "Tagged": {
                "type": "object",
                "properties": { "kind": { "const": "t" } },
                "required": ["kind"],
                "$ref": "#/$defs/Part",
            },
            "List": { "type": "array", "items": { "$ref": "#/$defs/Part" }, "minItems": 1, "maxItems": 1 },
        })
        .as_object()
        .cloned()
        .unwrap_or_default(),
    );
    for (name, value, conforms) in [
        ("Part", json!({ "a": 1.5 }), true),
        ("Part", json!({ "a": null }), true),
        ("Part", json!({ "a": "[a]" }), true),
        ("Part", json!({ "a": "b" }), false),
        ("Part", json!({}), false),
        ("Part", json!({ "a": 1, "c": 2 }), false),
        ("Union", json!({ "kind": "k", "a": 1 }), true),
        ("Union", json!({ "kind": "k", "b": "x" }), true),
        ("Union", json!({ "kind": "k", "b": "y" }), false),
        ("Union", json!({ "kind": "k", "a": 1, "b": "x" }), false),
        ("Union", json!({ "a": 1 }), false),
        ("Tagged", json!({ "kind": "t", "a": 1 }), true),
        ("Tagged", json!({ "a": 1 }), false),
        ("Tagged", json!({ "kind": "t" }), false),
        ("List", json!([{ "a": 1 }]), true),
        ("List", json!([]), false),
        ("List", json!([{ "b": 1 }]), false),
    ] {
        assert_eq!(
            check(&schemas, name, &value).is_ok(),
            conforms,
            "{name} {value}"
        );
    }
}
