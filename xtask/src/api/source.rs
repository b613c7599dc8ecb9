//! A crate's source as modules, and what a path in it means.

use std::fs;
use std::path::Path;

use syn::{Attribute, Item, UseTree, Visibility};

use crate::disk::failed;
use crate::failure::{Failure, Outcome};

/// A crate, its root first.
pub(super) struct Source {
    /// Attributes of the root: its documentation.
    pub(super) attributes: Vec<Attribute>,
    modules: Vec<Module>,
}

/// One module, whether it stands in a file of its own or not.
pub(super) struct Module {
    name: String,
    parent: Option<usize>,
    pub(super) items: Vec<Item>,
}

/// Where something is defined: the number of its module, and its name there.
pub(super) type Definition = (usize, String);

/// What a path leads to.
pub(super) enum Target {
    Module(usize),
    Item(Definition),
}

/// One name that a `use` brings in.
pub(super) struct Leaf {
    pub(super) path: Vec<String>,
    pub(super) name: String,
}

/// The crate's root.
pub(super) const ROOT: usize = 0;

impl Source {
    /// Reads a crate from its `src/lib.rs` on.
    ///
    /// # Errors
    /// A file cannot be read, or holds no Rust.
    pub(super) fn read(crate_folder: &Path) -> Outcome<Self> {
        let mut source = Self {
            attributes: Vec::new(),
            modules: Vec::new(),
        };
        let root = crate_folder.join("src/lib.rs");
        source.add_file("crate", None, &root, &crate_folder.join("src"))?;
        Ok(source)
    }

    fn add_file(
        &mut self,
        name: &str,
        parent: Option<usize>,
        file: &Path,
        folder: &Path,
    ) -> Outcome {
        let text = fs::read_to_string(file).map_err(|why| failed("reading", file, why))?;
        let parsed = syn::parse_file(&text).map_err(|why| {
            Failure::new(
                format!("reading {}", file.display()),
                why,
                "mend what does not compile",
            )
        })?;
        if parent.is_none() {
            self.attributes = parsed.attrs;
        }
        self.add(name, parent, parsed.items, folder)
    }

    fn add(
        &mut self,
        name: &str,
        parent: Option<usize>,
        items: Vec<Item>,
        folder: &Path,
    ) -> Outcome {
        let number = self.modules.len();
        let items: Vec<Item> = items.into_iter().filter(|item| !only_tests(item)).collect();
        let children: Vec<_> = items
            .iter()
            .filter_map(|item| match item {
                Item::Mod(module) => Some(module.clone()),
                _ => None,
            })
            .collect();
        self.modules.push(Module {
            name: name.to_owned(),
            parent,
            items,
        });
        for child in children {
            let name = child.ident.to_string();
            let inner = folder.join(&name);
            if let Some((_, items)) = child.content {
                self.add(&name, Some(number), items, &inner)?;
                continue;
            }
            let beside = folder.join(format!("{name}.rs"));
            let file = if beside.is_file() {
                beside
            } else {
                inner.join("mod.rs")
            };
            self.add_file(&name, Some(number), &file, &inner)?;
        }
        Ok(())
    }

    pub(super) fn module(&self, number: usize) -> &Module {
        &self.modules[number]
    }

    /// All modules with their numbers.
    pub(super) fn modules(&self) -> impl Iterator<Item = (usize, &Module)> {
        self.modules.iter().enumerate()
    }

    /// What a path means where it stands in a module; none for what comes from another crate.
    pub(super) fn resolve(&self, module: usize, path: &[String]) -> Option<Target> {
        self.resolve_within(module, path, 16)
    }

    fn resolve_within(&self, module: usize, path: &[String], patience: usize) -> Option<Target> {
        let (first, rest) = path.split_first()?;
        let target = match first.as_str() {
            "crate" => Target::Module(ROOT),
            "self" => Target::Module(module),
            "super" => Target::Module(self.modules[module].parent?),
            name => self.named(module, name, patience.checked_sub(1)?)?,
        };
        match (target, rest) {
            (target, []) => Some(target),
            (Target::Module(inner), rest) => self.resolve_within(inner, rest, patience),
            // A variant of an enum is told with it.
            (Target::Item(_), _) => None,
        }
    }

    fn named(&self, module: usize, name: &str, patience: usize) -> Option<Target> {
        let child = self
            .modules()
            .find(|(_, child)| child.parent == Some(module) && child.name == name);
        if let Some((number, _)) = child {
            return Some(Target::Module(number));
        }
        let items = &self.modules[module].items;
        if items
            .iter()
            .any(|item| name_of(item).as_deref() == Some(name))
        {
            return Some(Target::Item((module, name.to_owned())));
        }
        let leaves = || {
            items.iter().filter_map(|item| match item {
                Item::Use(used) => Some(leaves(&used.tree)),
                _ => None,
            })
        };
        leaves().flatten().find_map(|leaf| {
            if leaf.name == name {
                self.resolve_within(module, &leaf.path, patience)
            } else if leaf.name == "*" {
                match self.resolve_within(module, &leaf.path, patience)? {
                    Target::Module(inner) if inner != module => {
                        self.named(inner, name, patience.checked_sub(1)?)
                    }
                    _ => None,
                }
            } else {
                None
            }
        })
    }
}

/// The names that a `use` brings in; `*` for all of a module.
pub(super) fn leaves(tree: &UseTree) -> Vec<Leaf> {
    match tree {
        UseTree::Path(path) => leaves(&path.tree)
            .into_iter()
            .map(|mut leaf| {
                leaf.path.insert(0, path.ident.to_string());
                leaf
            })
            .collect(),
        UseTree::Name(name) => {
            let name = name.ident.to_string();
            vec![Leaf {
                path: vec![name.clone()],
                name,
            }]
        }
        UseTree::Rename(renamed) => vec![Leaf {
            path: vec![renamed.ident.to_string()],
            name: renamed.rename.to_string(),
        }],
        UseTree::Glob(_) => vec![Leaf {
            path: Vec::new(),
            name: "*".to_owned(),
        }],
        UseTree::Group(group) => group.items.iter().flat_map(leaves).collect(),
    }
}

/// The name of an item that can be named.
pub(super) fn name_of(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}

/// Whether an item can be named outside its module.
pub(super) fn is_public(item: &Item) -> bool {
    let visibility = match item {
        Item::Const(item) => &item.vis,
        Item::Enum(item) => &item.vis,
        Item::Fn(item) => &item.vis,
        Item::Mod(item) => &item.vis,
        Item::Static(item) => &item.vis,
        Item::Struct(item) => &item.vis,
        Item::Trait(item) => &item.vis,
        Item::Type(item) => &item.vis,
        Item::Use(item) => &item.vis,
        _ => return false,
    };
    matches!(visibility, Visibility::Public(_))
}

fn only_tests(item: &Item) -> bool {
    let attributes = match item {
        Item::Mod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => return false,
    };
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Ident>()
                .is_ok_and(|ident| ident == "test")
    })
}
