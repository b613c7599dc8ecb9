//! What of a crate can be named from outside, and where.

use syn::{Item, ItemImpl, Type};

use super::source::{Definition, ROOT, Source, Target, is_public, leaves, name_of};

/// A public module with what can be named in it, by name.
#[derive(Default)]
pub(super) struct Public<'a> {
    /// Modules in it.
    pub(super) modules: Vec<(String, Self)>,
    /// Items with the implementations of each.
    pub(super) items: Vec<Named<'a>>,
    /// Paths into other crates.
    pub(super) foreign: Vec<String>,
}

/// One item under its public name.
pub(super) struct Named<'a> {
    pub(super) name: String,
    pub(super) item: &'a Item,
    pub(super) implementations: Vec<&'a ItemImpl>,
}

/// The public side of a crate.
pub(super) fn public(source: &Source) -> Public<'_> {
    let implementations = implementations(source);
    let mut root = visit(source, ROOT, &implementations, 16);
    sort(&mut root);
    root
}

type Implementations<'a> = Vec<(Definition, &'a ItemImpl)>;

fn visit<'a>(
    source: &'a Source,
    module: usize,
    implementations: &Implementations<'a>,
    patience: usize,
) -> Public<'a> {
    let mut public = Public::default();
    if patience == 0 {
        return public;
    }
    for item in source
        .module(module)
        .items
        .iter()
        .filter(|item| is_public(item))
    {
        let targets = match item {
            Item::Use(used) => {
                let mut targets = Vec::new();
                for leaf in leaves(&used.tree) {
                    match source.resolve(module, &leaf.path) {
                        Some(target) => targets.push((leaf.name, target)),
                        None => public.foreign.push(shown(&leaf.path, &leaf.name)),
                    }
                }
                targets
            }
            Item::Mod(inner) => {
                let name = inner.ident.to_string();
                source
                    .resolve(module, std::slice::from_ref(&name))
                    .map(|target| (name, target))
                    .into_iter()
                    .collect()
            }
            _ => name_of(item)
                .map(|name| (name.clone(), Target::Item((module, name))))
                .into_iter()
                .collect(),
        };
        for (name, target) in targets {
            match target {
                Target::Module(inner) if name == "*" => {
                    let all = visit(source, inner, implementations, patience - 1);
                    public.modules.extend(all.modules);
                    public.items.extend(all.items);
                    public.foreign.extend(all.foreign);
                }
                Target::Module(inner) => {
                    let inside = visit(source, inner, implementations, patience - 1);
                    public.modules.push((name, inside));
                }
                Target::Item(definition) => {
                    public
                        .items
                        .extend(named(source, &name, &definition, implementations));
                }
            }
        }
    }
    public
}

/// All items of that name: a type and a function may share one.
fn named<'a>(
    source: &'a Source,
    name: &str,
    definition: &Definition,
    implementations: &Implementations<'a>,
) -> Vec<Named<'a>> {
    let (module, original) = definition;
    source
        .module(*module)
        .items
        .iter()
        .filter(|item| is_public(item) && name_of(item).as_ref() == Some(original))
        .map(|item| Named {
            name: name.to_owned(),
            item,
            implementations: match item {
                Item::Struct(_) | Item::Enum(_) => implementations
                    .iter()
                    .filter(|(of, _)| of == definition)
                    .map(|(_, implementation)| *implementation)
                    .collect(),
                _ => Vec::new(),
            },
        })
        .collect()
}

fn implementations(source: &Source) -> Implementations<'_> {
    let mut found = Vec::new();
    for (number, module) in source.modules() {
        for item in &module.items {
            let Item::Impl(implementation) = item else {
                continue;
            };
            let Type::Path(path) = implementation.self_ty.as_ref() else {
                continue;
            };
            let segments: Vec<String> = path
                .path
                .segments
                .iter()
                .map(|segment| segment.ident.to_string())
                .collect();
            if let Some(Target::Item(definition)) = source.resolve(number, &segments) {
                found.push((definition, implementation));
            }
        }
    }
    found
}

fn shown(path: &[String], name: &str) -> String {
    let last = path.last().is_some_and(|last| last == name);
    let path = path.join("::");
    match (name, last) {
        ("*", _) => format!("{path}::*"),
        (_, true) => path,
        (_, false) => format!("{path} as {name}"),
    }
}

fn sort(public: &mut Public<'_>) {
    public
        .modules
        .sort_by(|(one, _), (other, _)| one.cmp(other));
    // Stable: a type stays before a function of its name.
    public.items.sort_by(|one, other| one.name.cmp(&other.name));
    public.foreign.sort();
    for (_, inner) in &mut public.modules {
        sort(inner);
    }
}
