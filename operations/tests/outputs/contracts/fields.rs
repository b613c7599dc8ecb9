//! List of all fields of the JSON documents, for the book.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde_json::Value;

use super::Document;
use super::schema::{Schemas, alternatives, description, fixed_length, properties, reference};

const HEAD: &str = "\
# Fields of the JSON documents

Every key of the documents that `--json` prints, with its type and meaning. [JSON keys](json.md) states what they have in common.
An optional key is missing if there is nothing to report. Units are SI: the key or brackets name them.

A test generates this page from the output types of the program.
";

/// The page of the book.
pub(super) fn page(documents: &[Document], schemas: &Schemas) -> String {
    let mut text = HEAD.to_owned();
    let mut parts = BTreeSet::new();
    for document in documents {
        let title = match document.words {
            "" => document.title.to_owned(),
            _ => format!("`swimmer {}`", document.title),
        };
        let _ = write!(text, "\n## {title}\n");
        let schema = schemas.named(&document.name);
        section(&mut text, schema);
        collect(schemas, schema, &mut parts);
    }
    for document in documents {
        parts.remove(&document.name);
    }
    text.push_str("\n## Parts\n");
    for name in parts {
        let _ = write!(text, "\n### {name}\n");
        section(&mut text, schemas.named(&name));
    }
    text
}

/// Collects the names of all types to which a schema leads.
fn collect(schemas: &Schemas, schema: &Value, names: &mut BTreeSet<String>) {
    if let Some(name) = reference(schema)
        && names.insert(name.to_owned())
    {
        collect(schemas, schemas.named(name), names);
    }
    match schema {
        Value::Object(keys) => keys
            .values()
            .for_each(|value| collect(schemas, value, names)),
        Value::Array(items) => items.iter().for_each(|item| collect(schemas, item, names)),
        _ => (),
    }
}

/// Description and fields of a type.
fn section(text: &mut String, schema: &Value) {
    if let Some(line) = description(schema) {
        let _ = write!(text, "\n{line}\n");
    }
    if let Some(properties) = properties(schema) {
        text.push_str("\n| key | type | meaning |\n|---|---|---|\n");
        for property in properties {
            let optional = if property.required { "" } else { ", optional" };
            let meaning = description(property.schema).unwrap_or_default();
            let _ = writeln!(
                text,
                "| `{}` | {}{optional} | {} |",
                property.key,
                type_of(property.schema),
                meaning.replace('|', "\\|")
            );
        }
    }
    let Some(alternatives) = alternatives(schema) else {
        return;
    };
    text.push_str("\nOne of:\n\n");
    for alternative in alternatives {
        let meaning = description(alternative);
        let meaning = meaning.map_or_else(String::new, |line| format!(": {line}"));
        let _ = writeln!(text, "- {}{meaning}", type_of(alternative));
    }
}

/// The type of a value, in words.
fn type_of(schema: &Value) -> String {
    if let Some(name) = reference(schema) {
        let link = format!("[{name}](#{})", name.to_lowercase());
        return match object(schema) {
            shared if shared.is_empty() => link,
            shared => format!("{shared}, and the keys of {link}"),
        };
    }
    if let Some(constant) = schema.get("const") {
        return word(constant);
    }
    if let Some(words) = schema.get("enum").and_then(Value::as_array) {
        return words.iter().map(word).collect::<Vec<_>>().join(" or ");
    }
    if let Some(parts) = alternatives(schema) {
        return parts.iter().map(type_of).collect::<Vec<_>>().join(" or ");
    }
    match schema.get("type") {
        Some(Value::String(name)) => of_name(name, schema),
        Some(Value::Array(names)) => {
            let names = names.iter().filter_map(Value::as_str);
            let types: Vec<String> = names.map(|name| of_name(name, schema)).collect();
            types.join(" or ")
        }
        _ => "any".to_owned(),
    }
}

fn word(value: &Value) -> String {
    format!("`{}`", value.as_str().unwrap_or_default())
}

fn of_name(name: &str, schema: &Value) -> String {
    match name {
        "integer" => "whole number".to_owned(),
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        "array" => list(schema),
        "object" => object(schema),
        // number and null
        same => same.to_owned(),
    }
}

/// An object without a name of its own.
fn object(schema: &Value) -> String {
    let keys = properties(schema).unwrap_or_default().into_iter();
    let keys: Vec<String> = keys
        .map(|property| format!("`{}` ({})", property.key, type_of(property.schema)))
        .collect();
    keys.join(", ")
}

fn list(schema: &Value) -> String {
    let brackets = |items: Vec<String>| format!("\\[{}\\]", items.join(", "));
    if let Some(items) = schema.get("prefixItems").and_then(Value::as_array) {
        return brackets(items.iter().map(type_of).collect());
    }
    let item = schema.get("items").map_or("any".to_owned(), type_of);
    match fixed_length(schema) {
        Some(length) => brackets(vec![item; length]),
        None => format!("list of {item}"),
    }
}
