//! Pages of source code with numbered lines, as targets of the book's links. Links name items instead of lines, so they stay valid
//! if lines move.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use crate::failure::{Failure, Outcome};
use crate::stage::{read, write};

/// Source files that the book shows, from the root.
pub(crate) type Sources = BTreeSet<String>;

/// Words before the name of an item in Rust, or before a heading or a function in other files.
const BEFORE: [&str; 9] = [
    "fn ",
    "struct ",
    "enum ",
    "const ",
    "static ",
    "trait ",
    "type ",
    "mod ",
    "function ",
];

/// Line (from 1) of the declaration of an item: `name`, or `Type::name` for a member of `impl Type` or `enum Type`.
///
/// # Errors
/// The item is missing or ambiguous.
pub(crate) fn line_of(text: &str, item: &str) -> Result<usize, String> {
    let lines: Vec<&str> = text.lines().collect();
    let found: Vec<usize> = if let Some((within, name)) = item.split_once("::") {
        member(&lines, within, name).into_iter().collect()
    } else {
        let numbered = lines.iter().enumerate();
        let declaring = numbered.filter(|(_, line)| declares(line, item));
        declaring.map(|(number, _)| number + 1).collect()
    };
    match found.as_slice() {
        [line] => Ok(*line),
        [] => Err(format!("no item `{item}` there")),
        several => Err(format!(
            "`{item}` on lines {several:?}; name it as Type::item"
        )),
    }
}

/// Returns `true` if a line declares an item of this name.
fn declares(line: &str, name: &str) -> bool {
    BEFORE.iter().any(|word| {
        line.match_indices(word).any(|(at, _)| {
            let before = line[..at].trim_start();
            let rest = line[at + word.len()..].strip_prefix(name);
            let ends = rest.is_some_and(|rest| !rest.starts_with(is_of_a_name));
            ends && (before.is_empty() || before.ends_with(' ')) && !before.contains("//")
        })
    })
}

/// Line of a member of a type: declared by an `impl`, or a field or variant of the type.
fn member(lines: &[&str], within: &str, name: &str) -> Option<usize> {
    let opens = |line: &str| {
        let mut words = line.split(|letter: char| !is_of_a_name(letter));
        !line.starts_with([' ', '/']) && line.ends_with('{') && words.any(|word| word == within)
    };
    let mut fields = None;
    let (mut inside, mut of_impl) = (false, false);
    for (number, line) in lines.iter().enumerate() {
        if opens(line) {
            (inside, of_impl) = (true, line.starts_with("impl"));
        } else if *line == "}" {
            inside = false;
        } else if inside && of_impl && declares(line, name) {
            return Some(number + 1);
        } else if inside && !of_impl && is_field(line, name) {
            fields = fields.or(Some(number + 1));
        }
    }
    fields
}

/// Returns `true` if a line is the field or variant of this name.
fn is_field(line: &str, name: &str) -> bool {
    let Some(line) = line.strip_prefix("    ") else {
        return false;
    };
    let visible = ["pub(crate) ", "pub(super) ", "pub "];
    let bare = visible.iter().find_map(|word| line.strip_prefix(word));
    let rest = bare.unwrap_or(line).strip_prefix(name);
    rest.is_some_and(|rest| rest.starts_with([',', ':', '(', ' ']))
}

fn is_of_a_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Version-controlled files below a folder.
///
/// # Errors
/// Git fails.
pub(crate) fn files_below(root: &Path, folder: &str) -> Outcome<Vec<String>> {
    let failed = |why: &dyn std::fmt::Display| {
        Failure::new(format!("listing the files of {folder} with git"), why)
    };
    let output = Command::new("git")
        .args(["ls-files", folder])
        .current_dir(root)
        .output()
        .map_err(|why| failed(&why))?;
    if !output.status.success() {
        return Err(failed(&String::from_utf8_lossy(&output.stderr).trim()));
    }
    let list = String::from_utf8_lossy(&output.stdout).into_owned();
    Ok(list
        .lines()
        .filter(|line| is_text(line))
        .map(str::to_owned)
        .collect())
}

/// Returns `true` if a file can be shown as a page.
fn is_text(path: &str) -> bool {
    let endings = [
        ".rs", ".toml", ".md", ".mjs", ".trycmd", ".x", ".json", ".css", ".snap", ".py", ".pyi",
        ".ipynb",
    ];
    endings.iter().any(|ending| path.ends_with(ending))
}

/// Writes a page for each file and a list for each folder.
///
/// # Errors
/// A file cannot be read or written.
pub(crate) fn write_pages(root: &Path, sources: &Sources, output: &Path) -> Outcome {
    let mut folders: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for path in sources {
        let text = read(root, path)?;
        write(
            output,
            &format!("source/{path}.html"),
            page(path, &text).as_bytes(),
        )?;
        let mut above = path.as_str();
        while let Some((folder, _)) = above.rsplit_once('/') {
            folders.entry(folder.to_owned()).or_default().push(path);
            above = folder;
        }
    }
    for (folder, files) in folders {
        let place = format!("source/{folder}/index.html");
        write(output, &place, list(&folder, &files).as_bytes())?;
    }
    Ok(())
}

fn page(path: &str, text: &str) -> String {
    let mut lines = String::new();
    for (number, line) in text.lines().enumerate() {
        let number = number + 1;
        // Writing to a string cannot fail.
        let _ = writeln!(
            lines,
            "<span id=\"L{number}\"><i>{number}</i>{}</span>",
            escaped(line)
        );
    }
    framed(path, &format!("<pre>{lines}</pre>"))
}

fn list(folder: &str, files: &[&str]) -> String {
    let mut items = String::new();
    for file in files {
        let name = file
            .strip_prefix(folder)
            .unwrap_or(file)
            .trim_start_matches('/');
        let _ = writeln!(items, "<li><a href=\"{name}.html\">{name}</a>");
    }
    framed(folder, &format!("<ul>{items}</ul>"))
}

fn framed(title: &str, body: &str) -> String {
    format!(
        "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>{title}</title>\
         <style>body{{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:70rem;padding:0 1rem;color:#1d242c}}\
         pre{{overflow-x:auto;line-height:1.45;font-size:13px}}pre span{{display:block}}\
         pre i{{display:inline-block;width:3.4em;color:#9aa5b1;font-style:normal;user-select:none}}\
         span:target{{background:#fff3c4}}</style><h1>{title}</h1>{body}</html>\n"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "//! fn one\n/// fn one\npub fn one() {}\nimpl<T> Two<T> {\n    pub(crate) const fn one(&self) {}\n    fn three() {}\n}\n\
                        pub struct Four<'a> {\n    /// a\n    pub five: u8,\n}\nfn oneself() {}\nfn three() {}\n";

    #[test]
    fn items_are_found_by_name() {
        assert_eq!(line_of(TEXT, "oneself"), Ok(12));
        assert_eq!(line_of(TEXT, "Two::one"), Ok(5));
        assert_eq!(line_of(TEXT, "Four::five"), Ok(10));
        assert_eq!(line_of(TEXT, "Four"), Ok(8));
    }

    #[test]
    fn what_is_not_there_or_not_alone_is_told() {
        assert!(line_of(TEXT, "six").unwrap_err().contains("no item"));
        assert!(line_of(TEXT, "one").unwrap_err().contains("[3, 5]"));
        assert!(line_of(TEXT, "Seven::one").is_err());
        assert!(line_of(TEXT, "Two::five").is_err());
    }

    #[test]
    fn lines_are_numbered_and_cannot_break_the_page() {
        let page = page("a.rs", "a < b\n</pre>");
        assert!(
            page.contains("<span id=\"L2\"><i>2</i>&lt;/pre></span>"),
            "{page}"
        );
    }
}
