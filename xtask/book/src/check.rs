//! Checks every link of the finished book to its own pages and anchors; external links are only counted.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};
use crate::path::joined;

/// Checks the links of every page below a folder. Returns their number.
///
/// # Errors
/// All broken links.
pub(crate) fn follow_links(folder: &Path) -> Outcome<usize> {
    let mut files = BTreeSet::new();
    let mut pages = BTreeMap::new();
    for path in files_below(folder)? {
        let name = path.strip_prefix(folder).unwrap_or(&path);
        let name = name.to_string_lossy().replace('\\', "/");
        if path.extension().is_some_and(|ending| ending == "html") {
            let failed = |why| Failure::new(format!("reading {name}"), why);
            let text = std::fs::read_to_string(&path).map_err(failed)?;
            pages.insert(name.clone(), text);
        }
        files.insert(name);
    }
    let (seen, dead) = dead_links(&files, &pages);
    Failure::all("following the book's links", &dead)?;
    Ok(seen)
}

fn dead_links(files: &BTreeSet<String>, pages: &BTreeMap<String, String>) -> (usize, Vec<String>) {
    let places: BTreeMap<&str, BTreeSet<&str>> = pages
        .iter()
        .map(|(name, text)| (name.as_str(), values(text, "id").collect()))
        .collect();
    let (mut seen, mut dead) = (0, Vec::new());
    for (page, text) in pages {
        for target in values(text, "href").chain(values(text, "src")) {
            let outside = ["http:", "https:", "mailto:", "data:", "javascript:"];
            // mdBook's "not found" page links from the root of the site.
            if target.is_empty()
                || page == "404.html"
                || outside.iter().any(|kind| target.starts_with(kind))
            {
                continue;
            }
            seen += 1;
            let (file, place) = target.split_once('#').unwrap_or((target, ""));
            let file = if file.is_empty() {
                Some(page.clone())
            } else {
                joined(page, file.split('?').next().unwrap_or(file))
            };
            let file = file.filter(|file| files.contains(file));
            let there = file.as_deref().is_some_and(|file| {
                let known = places.get(file);
                place.is_empty() || known.is_some_and(|known| known.contains(place))
            });
            if !there {
                dead.push(format!("{page} links to {target}"));
            }
        }
    }
    (seen, dead)
}

/// Values of an attribute, in single or double quotes.
fn values<'a>(html: &'a str, attribute: &str) -> impl Iterator<Item = &'a str> {
    let written = format!(" {attribute}=");
    let places: Vec<usize> = html
        .match_indices(&written)
        .map(|(at, _)| at + written.len())
        .collect();
    places.into_iter().filter_map(move |at| {
        let rest = &html[at..];
        let quote = rest
            .chars()
            .next()
            .filter(|quote| ['"', '\''].contains(quote))?;
        rest[1..].split(quote).next()
    })
}

fn files_below(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let failed = |why: std::io::Error| Failure::new(format!("listing {}", folder.display()), why);
    let (mut found, mut left) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = left.pop() {
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.is_dir() {
                left.push(path);
            } else {
                found.push(path);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_links_and_dead_places_are_named() {
        let pages = BTreeMap::from(
            [
                ("a.html", "<h1 id=\"top\"><a href=\"b/c.html#here\"> <a href='#top'> <a href=\"https://x.org\">"),
                ("b/c.html", "<p id=\"here\"><a href=\"../a.html#gone\"><img src=\"../p.png\"><a href=\"../no.html\">"),
            ]
            .map(|(name, text)| (name.to_owned(), text.to_owned())),
        );
        let files = ["a.html", "b/c.html", "p.png"].map(str::to_owned).into();
        let (seen, dead) = dead_links(&files, &pages);
        assert_eq!(seen, 5);
        assert_eq!(
            dead,
            [
                "b/c.html links to ../a.html#gone",
                "b/c.html links to ../no.html"
            ]
        );
    }
}
