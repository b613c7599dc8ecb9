//! `cargo xtask api`: what each library offers, under version control, so that a change of it is seen; and what of it has no
//! example or no unit in its documentation.
//!
//! It reads the source and asks no compiler: what a macro writes is not seen.

mod documentation;
mod reach;
mod source;
mod stub;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use syn::Item;

use crate::disk::{failed, make_folder};
use crate::failure::{Failure, Outcome};
use crate::run::{cargo, read};
use reach::Public;
use source::Source;

/// The steps of `cargo xtask test`: nothing is written.
///
/// # Errors
/// As [`list`] and [`packages_are_lean`].
pub(crate) fn check() -> Outcome {
    list(Path::new("."), true)?;
    packages_are_lean()
}

/// Crates that others may build on.
const LIBRARIES: [&str; 13] = [
    "swimmer-model",
    "swimmer-files",
    "gait-optimizer",
    "collocation",
    "forecast",
    "sweep",
    "calibrate",
    "gait-player",
    "link-protocol",
    "host-link",
    "twin",
    "emulator",
    "validation",
];

/// Where the lists stand.
const LISTS: &str = "xtask/api";

/// Writes every library's list, or with `check` holds them against the source; tells what lacks an example or a unit.
///
/// # Errors
/// A source cannot be read; with `check`, a list is not that of the source, or an entry point has no example.
pub(crate) fn list(root: &Path, check: bool) -> Outcome {
    let mut stale = Vec::new();
    let mut missing = documentation::Missing::default();
    for library in LIBRARIES {
        let source = Source::read(&root.join(library))?;
        let public = reach::public(&source);
        let text = text_of(library, &public);
        let path = root.join(LISTS).join(format!("{library}.rs"));
        if check {
            if fs::read_to_string(&path).unwrap_or_default() != text {
                stale.push(library);
            }
        } else {
            make_folder(&root.join(LISTS))?;
            fs::write(&path, text).map_err(|why| failed("writing", &path, why))?;
        }
        missing.look_at(library, &source, &public);
    }
    println!("{missing}");
    if !stale.is_empty() {
        return Err(Failure::new(
            format!("holding what {} offer against {LISTS}", stale.join(", ")),
            "it is not the same any more",
            "run `cargo xtask api`, look at the difference, and tell users of it in CHANGELOG.md where it breaks their code",
        ));
    }
    missing.verdict()
}

fn text_of(library: &str, public: &Public<'_>) -> String {
    let mut text = format!(
        "// What `{library}` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.\n\n"
    );
    let file = syn::File {
        shebang: None,
        frontmatter: None,
        attrs: Vec::new(),
        items: items(public, "crate", &mut HashMap::new()),
    };
    let _ = write!(text, "{}", prettyplease::unparse(&file));
    text
}

/// What a module offers; what has been told under another path is only named.
fn items(public: &Public<'_>, here: &str, told: &mut HashMap<*const Item, String>) -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    for path in &public.foreign {
        items.extend(syn::parse_str(&format!("pub use {path};")));
    }
    for named in &public.items {
        let path = format!("{here}::{}", named.name);
        match told.entry(std::ptr::from_ref(named.item)) {
            Entry::Occupied(before) => {
                items.extend(syn::parse_str(&format!("pub use {};", before.get())));
                continue;
            }
            Entry::Vacant(free) => free.insert(path),
        };
        items.push(stub::of_item(named.item));
        items.extend(
            named
                .implementations
                .iter()
                .filter_map(|one| stub::of_impl(one))
                .map(Item::Impl),
        );
    }
    for (name, inner) in &public.modules {
        if let Ok(Item::Mod(mut module)) = syn::parse_str(&format!("pub mod {name} {{}}")) {
            module.content = module
                .content
                .map(|(brace, _)| (brace, self::items(inner, &format!("{here}::{name}"), told)));
            items.push(Item::Mod(module));
        }
    }
    items
}

/// Holds every library's package against what it should leave out: tests, their data, benches and snapshots.
///
/// # Errors
/// Cargo cannot list a package, or a package holds such a file.
pub(crate) fn packages_are_lean() -> Outcome {
    for library in LIBRARIES {
        let next = "mend the package's manifest";
        let listed = read(
            &mut cargo([
                "package",
                "--list",
                "--allow-dirty",
                "--offline",
                "-p",
                library,
            ]),
            next,
        )?;
        if let Some(unwanted) = listed.lines().find(|file| is_test_data(file)) {
            return Err(Failure::new(
                format!("looking into the package of {library}"),
                format!("it holds {unwanted}"),
                "add it to `exclude` in its Cargo.toml",
            ));
        }
    }
    Ok(())
}

fn is_test_data(file: &str) -> bool {
    let mut parts = file.split(['/', '\\']);
    let first = parts.clone().next();
    first == Some("tests") || first == Some("benches") || parts.any(|part| part == "snapshots")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crate with this root and these modules beside it.
    fn crate_of(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join("src").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    const ROOT: &str = "//! ```\n//! made();\n//! ```\nmod inner;\npub mod open;\npub use inner::{made, Thing as Named};\npub use other::Foreign;\n\
                        pub(crate) fn hidden() {}\n#[cfg(test)]\nmod tests { pub fn tested() {} }\n";
    const INNER: &str = "/// Told.\npub fn made() -> Thing { todo!() }\n#[derive(Clone)]\npub struct Thing { pub x: f64, y: f64 }\n\
                         impl Thing { pub fn new(x: f64) -> Self { todo!() } fn private() {} }\nimpl Drop for Thing { fn drop(&mut self) {} }\n";
    const OPEN: &str =
        "pub use super::inner::Thing;\n/// In metres.\npub fn length() -> f64 { 1.0 }\n";

    #[test]
    fn the_list_holds_what_can_be_named_and_nothing_else() {
        let folder = crate_of(&[("lib.rs", ROOT), ("inner.rs", INNER), ("open.rs", OPEN)]);
        let source = Source::read(folder.path()).unwrap();
        let text = text_of("one", &reach::public(&source));
        for told in [
            "pub use other::Foreign;",
            "pub struct Thing {\n    pub x: f64,\n}",
            "impl Thing {\n    pub fn new(x: f64) -> Self {}\n}",
            "impl Drop for Thing {}",
            "pub fn made() -> Thing {}",
            "pub mod open {\n    pub use crate::Named;",
        ] {
            assert!(text.contains(told), "{told} is not in\n{text}");
        }
        for hidden in ["hidden", "private", "y: f64", "todo", "Told", "tested"] {
            assert!(!text.contains(hidden), "{hidden} is in\n{text}");
        }
    }

    #[test]
    fn what_lacks_an_example_or_a_unit_is_named() {
        let folder = crate_of(&[("lib.rs", ROOT), ("inner.rs", INNER), ("open.rs", OPEN)]);
        let source = Source::read(folder.path()).unwrap();
        let mut missing = documentation::Missing::default();
        missing.look_at("one", &source, &reach::public(&source));
        let told = missing.to_string();
        assert!(
            told.starts_with("2 entry points")
                && told.contains("no running example: 1\n  one::Named\n"),
            "{told}"
        );
        assert!(
            told.contains("one::Named.x") && !told.contains("length"),
            "{told}"
        );
        assert!(missing.verdict().is_err());
    }

    #[test]
    fn test_data_is_told_from_source() {
        assert!(is_test_data("tests/formats/a.csv") && is_test_data("src/one/snapshots/a.snap"));
        assert!(!is_test_data("src/tests.rs") && !is_test_data("examples/a.rs"));
    }
}
