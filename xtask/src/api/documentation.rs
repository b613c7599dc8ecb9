//! What of the public side lacks an example, and which numbers lack a unit.

use std::collections::HashSet;
use std::fmt;

use quote::ToTokens as _;
use syn::{Attribute, FnArg, ImplItem, ImplItemFn, Item, ReturnType, Visibility};

use super::reach::{Named, Public};
use super::source::Source;
use crate::failure::{Failure, Outcome};

/// Names of what lacks something.
#[derive(Default)]
pub(super) struct Missing {
    /// Functions, and types with a function that makes one, at a crate's root.
    entry_points: usize,
    without_example: Vec<String>,
    /// Public fields, and functions, with numbers in them.
    numbers: usize,
    without_unit: Vec<String>,
}

/// Words that say what a number counts or is measured in; the first are units in brackets or in words.
const UNITS: [&str; 40] = [
    "\\[",
    "metre",
    "radian",
    "second",
    "hertz",
    "hz",
    "volt",
    "watt",
    "newton",
    " ns",
    " us",
    "µs",
    " ms",
    "m/s",
    "rad",
    "degree",
    "pixel",
    "bytes",
    "over l",
    "over_length",
    "fraction",
    "share",
    "ratio",
    "χ",
    "count",
    "number of",
    "how many",
    "per cent",
    "over μ",
    "/μ",
    "units of",
    "without unit",
    "of one",
    "efficiency",
    "λ",
    "ξ",
    "rmse",
    "standard deviation",
    "likelihood",
    "seed",
];

impl Missing {
    /// Adds what a library lacks. What it names at its root is where one enters; what lies in its modules is looked up.
    pub(super) fn look_at(&mut self, library: &str, source: &Source, public: &Public<'_>) {
        let mut shown = HashSet::new();
        add_words_of_examples(&docs(&source.attributes), &mut shown);
        add_words_of(public, &mut shown);
        for named in &public.items {
            if is_entry_point(named) {
                self.entry_points += 1;
                if !shown.contains(&named.name) {
                    self.without_example
                        .push(format!("{library}::{}", named.name));
                }
            }
        }
        self.look_at_module(library, public, &mut HashSet::new());
    }

    fn look_at_module(&mut self, path: &str, public: &Public<'_>, seen: &mut HashSet<*const Item>) {
        for named in &public.items {
            if seen.insert(std::ptr::from_ref(named.item)) {
                self.look_at_item(&format!("{path}::{}", named.name), named);
            }
        }
        for (name, inner) in &public.modules {
            self.look_at_module(&format!("{path}::{name}"), inner, seen);
        }
    }

    fn look_at_item(&mut self, path: &str, named: &Named<'_>) {
        match named.item {
            Item::Fn(function) => {
                self.number(path, &docs(&function.attrs), numeric(&function.sig));
            }
            Item::Struct(item) => {
                self.methods(path, named);
                for field in item
                    .fields
                    .iter()
                    .filter(|field| matches!(field.vis, Visibility::Public(_)))
                {
                    let name = field
                        .ident
                        .as_ref()
                        .map_or_else(String::new, ToString::to_string);
                    // A type may say the unit of all its fields.
                    let told = docs(&field.attrs) + &docs(&item.attrs) + &name_with_unit(&name);
                    self.number(&format!("{path}.{name}"), &told, numeric(&field.ty));
                }
            }
            Item::Enum(_) => self.methods(path, named),
            _ => {}
        }
    }

    fn methods(&mut self, path: &str, named: &Named<'_>) {
        for function in public_functions(named) {
            let name = function.sig.ident.to_string();
            let told = docs(&function.attrs) + &name_with_unit(&name);
            self.number(&format!("{path}::{name}"), &told, numeric(&function.sig));
        }
    }

    fn number(&mut self, path: &str, docs: &str, numeric: bool) {
        if !numeric {
            return;
        }
        self.numbers += 1;
        let docs = docs.to_lowercase();
        if !has_example(&docs) && !UNITS.iter().any(|unit| docs.contains(unit)) {
            self.without_unit.push(path.to_owned());
        }
    }

    /// Fails where an entry point has no example.
    pub(super) fn verdict(&self) -> Outcome {
        if self.without_example.is_empty() {
            return Ok(());
        }
        Err(Failure::new(
            "looking for the examples of all entry points",
            format!("{} have none", self.without_example.len()),
            "give each of them one that checks a number",
        ))
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} entry points (at a crate's root: functions, and types with a function of their own that makes them); in no running example: {}",
            self.entry_points,
            self.without_example.len()
        )?;
        for path in &self.without_example {
            writeln!(f, "  {path}")?;
        }
        writeln!(
            f,
            "{} fields and functions with numbers; without a unit or an example: {}",
            self.numbers,
            self.without_unit.len()
        )?;
        for path in &self.without_unit {
            writeln!(f, "  {path}")?;
        }
        Ok(())
    }
}

fn docs(attributes: &[Attribute]) -> String {
    let mut text = String::new();
    for attribute in attributes {
        if let syn::Meta::NameValue(pair) = &attribute.meta
            && pair.path.is_ident("doc")
            && let syn::Expr::Lit(literal) = &pair.value
            && let syn::Lit::Str(line) = &literal.lit
        {
            text.push_str(&line.value());
            text.push('\n');
        }
    }
    text
}

/// A function, or a type with a function of its own that makes it.
fn is_entry_point(named: &Named<'_>) -> bool {
    match named.item {
        Item::Fn(_) => true,
        Item::Struct(_) | Item::Enum(_) => public_functions(named)
            .any(|function| !matches!(function.sig.inputs.first(), Some(FnArg::Receiver(_)))),
        _ => false,
    }
}

fn public_functions<'a>(named: &Named<'a>) -> impl Iterator<Item = &'a ImplItemFn> {
    named
        .implementations
        .iter()
        .filter(|one| one.trait_.is_none())
        .flat_map(|one| &one.items)
        .filter_map(|item| match item {
            ImplItem::Fn(function) if matches!(function.vis, Visibility::Public(_)) => {
                Some(function)
            }
            _ => None,
        })
}

/// Words of all running examples of what a module offers.
fn add_words_of(public: &Public<'_>, shown: &mut HashSet<String>) {
    for named in &public.items {
        let attributes = match named.item {
            Item::Fn(item) => &item.attrs,
            Item::Struct(item) => &item.attrs,
            Item::Enum(item) => &item.attrs,
            Item::Trait(item) => &item.attrs,
            _ => continue,
        };
        add_words_of_examples(&docs(attributes), shown);
        for function in public_functions(named) {
            add_words_of_examples(&docs(&function.attrs), shown);
        }
    }
    for (_, inner) in &public.modules {
        add_words_of(inner, shown);
    }
}

/// The words of code blocks that are compiled.
fn add_words_of_examples(docs: &str, shown: &mut HashSet<String>) {
    let mut running = None;
    for line in docs.lines().map(str::trim) {
        if let Some(language) = line.strip_prefix("```") {
            running = match running {
                None => Some(!["text", "ignore", "toml"].contains(&language)),
                Some(_) => None,
            };
        } else if running == Some(true) {
            let words = line.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            shown.extend(words.map(str::to_owned));
        }
    }
}

fn has_example(docs: &str) -> bool {
    let mut words = HashSet::new();
    add_words_of_examples(docs, &mut words);
    !words.is_empty()
}

/// The unit that a name carries, as words.
fn name_with_unit(name: &str) -> String {
    let carried = [
        ("_ns", " ns"),
        ("_us", " us"),
        ("_ms", " ms"),
        ("_s", " second"),
        ("_m", " metre"),
        ("_rad", " rad"),
        ("_hz", " hz"),
        ("_mv", " volt"),
        ("_milli", " share"),
        ("_over_length", " over_length"),
        ("_1e4", " rad"),
    ];
    carried
        .iter()
        .find(|(ending, _)| name.ends_with(ending))
        .map_or_else(String::new, |(_, unit)| (*unit).to_owned())
}

/// Whether floating-point numbers go in or come out.
trait Numeric {
    fn holds_numbers(&self) -> bool;
}

impl Numeric for syn::Type {
    fn holds_numbers(&self) -> bool {
        let text = self.to_token_stream().to_string();
        text.split(|c: char| !c.is_alphanumeric())
            .any(|word| ["f64", "f32", "T"].contains(&word))
    }
}

impl Numeric for syn::Signature {
    fn holds_numbers(&self) -> bool {
        let inputs = self.inputs.iter().any(|input| match input {
            FnArg::Typed(typed) => typed.ty.holds_numbers(),
            FnArg::Receiver(_) => false,
        });
        inputs || matches!(&self.output, ReturnType::Type(_, output) if output.holds_numbers())
    }
}

fn numeric(what: &impl Numeric) -> bool {
    what.holds_numbers()
}
