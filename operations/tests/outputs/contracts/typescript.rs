//! TypeScript types from the schemas.

use serde_json::Value;

use super::schema::{
    Schemas, alternatives, fixed_length, plain_description, properties, reference,
};

/// Longest list of fixed length that becomes a tuple.
const LONGEST_TUPLE: usize = 6;

/// The file of all types.
pub(super) fn file(schemas: &Schemas) -> String {
    let mut text = String::from(
        "// JSON documents of the command. A test generates this file from the output types: change those, then run\n\
         // `SWIMMER_CONTRACTS=overwrite cargo test -p operations --test outputs contracts`.\n",
    );
    for name in schemas.names() {
        let schema = schemas.named(name);
        text.push('\n');
        text.push_str(&comment(schema, ""));
        text.push_str(&declaration(name, schema));
    }
    text
}

/// Doc comment of a type or a field.
fn comment(schema: &Value, indentation: &str) -> String {
    plain_description(schema)
        .map_or_else(String::new, |text| format!("{indentation}/** {text} */\n"))
}

fn declaration(name: &str, schema: &Value) -> String {
    if alternatives(schema).is_none()
        && let Some(fields) = fields(schema, "  ")
    {
        return format!("export interface {name} {{\n{fields}}}\n");
    }
    format!("export type {name} = {};\n", type_of(schema))
}

/// One line per field of an object, with its comment.
fn fields(schema: &Value, indentation: &str) -> Option<String> {
    let lines = properties(schema)?.into_iter().map(|property| {
        let optional = if property.required { "" } else { "?" };
        format!(
            "{}{indentation}{}{optional}: {};\n",
            comment(property.schema, indentation),
            property.key,
            type_of(property.schema)
        )
    });
    Some(lines.collect())
}

/// The type of a value.
pub(super) fn type_of(schema: &Value) -> String {
    if let Some(name) = reference(schema) {
        return match object(schema) {
            Some(object) => format!("({object} & {name})"),
            None => name.to_owned(),
        };
    }
    if let Some(constant) = schema.get("const") {
        return constant.to_string();
    }
    if let Some(words) = schema.get("enum").and_then(Value::as_array) {
        return union(words.iter().map(Value::to_string).collect());
    }
    if let Some(parts) = alternatives(schema) {
        let union = union(parts.iter().map(type_of).collect());
        return match object(schema) {
            Some(object) => format!("{object} & ({union})"),
            None => union,
        };
    }
    match schema.get("type") {
        Some(Value::String(name)) => of_name(name, schema),
        Some(Value::Array(names)) => union(
            names
                .iter()
                .filter_map(Value::as_str)
                .map(|name| of_name(name, schema))
                .collect(),
        ),
        _ => "unknown".to_owned(),
    }
}

fn union(mut types: Vec<String>) -> String {
    types.dedup();
    types.join(" | ")
}

fn of_name(name: &str, schema: &Value) -> String {
    match name {
        "number" | "integer" => "number".to_owned(),
        "object" => object(schema).unwrap_or_else(|| "Record<string, unknown>".to_owned()),
        "array" => list(schema),
        // string, boolean and null
        same => same.to_owned(),
    }
}

/// An object in one line.
fn object(schema: &Value) -> Option<String> {
    let fields = properties(schema)?.into_iter().map(|property| {
        let optional = if property.required { "" } else { "?" };
        format!("{}{optional}: {}", property.key, type_of(property.schema))
    });
    Some(format!("{{ {} }}", fields.collect::<Vec<_>>().join("; ")))
}

fn list(schema: &Value) -> String {
    if let Some(items) = schema.get("prefixItems").and_then(Value::as_array) {
        let items: Vec<String> = items.iter().map(type_of).collect();
        return format!("[{}]", items.join(", "));
    }
    let item = schema.get("items").map_or("unknown".to_owned(), type_of);
    match fixed_length(schema) {
        Some(length) if length <= LONGEST_TUPLE => {
            format!("[{}]", vec![item; length].join(", "))
        }
        _ if item.contains(' ') && !item.starts_with(['{', '[']) => format!("({item})[]"),
        _ => format!("{item}[]"),
    }
}
