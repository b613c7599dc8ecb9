//! Collects the pages that `docs/SUMMARY.md` lists, from anywhere in the checkout. Replaces their links to other files by links to
//! numbered lines of source.

use std::collections::BTreeSet;
use std::path::Path;

use crate::failure::{Failure, Outcome};
use crate::markdown::{Link, links, replaced};
use crate::path::{joined, relative};
use crate::source::{self, Sources};

const SUMMARY: &str = "docs/SUMMARY.md";
/// Page that mdBook generates from the summary.
const CONTENTS: &str = "toc.html";
const STYLE: &str = "docs/book.css";
/// Suffixes of files that a page displays.
const PICTURES: [&str; 4] = [".png", ".gif", ".svg", ".jpg"];

/// Page of the book.
#[derive(Debug)]
pub(crate) struct Page {
    /// Path from the root.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// Input of mdBook, and the source files that are added to its output.
#[derive(Debug)]
pub(crate) struct Staged {
    pub(crate) pages: Vec<Page>,
    pub(crate) sources: Sources,
    summary: String,
    pictures: BTreeSet<String>,
}

impl Staged {
    /// Reads the pages and resolves their links.
    pub(crate) fn gather(root: &Path) -> Outcome<Self> {
        let summary = read(root, SUMMARY)?;
        let mut paths = Vec::new();
        let mut changes = Vec::new();
        for link in links(&summary) {
            let path = joined(SUMMARY, &link.target).ok_or_else(|| {
                Failure::new(
                    format!("reading {SUMMARY}"),
                    format!("{} leads out", link.target),
                )
            })?;
            changes.push((link.range, path.clone()));
            paths.push(path);
        }
        let mut staged = Self {
            pages: Vec::new(),
            sources: BTreeSet::new(),
            summary: replaced(&summary, &changes),
            pictures: BTreeSet::new(),
        };
        let mut lost = Vec::new();
        for path in &paths {
            let text = read(root, path)?;
            let mut changes = Vec::new();
            for link in links(&text) {
                match staged.followed(root, &paths, path, &link) {
                    Ok(Some(target)) => changes.push((link.range, target)),
                    Ok(None) => {}
                    Err(why) => lost.push(why.to_string()),
                }
            }
            changes.sort_by_key(|(range, _)| range.start);
            staged.pages.push(Page {
                text: replaced(&text, &changes),
                path: path.clone(),
            });
        }
        Failure::all("following the pages' links", &lost)?;
        Ok(staged)
    }

    /// Replacement of a link. Returns `None` if the link stays as it is.
    fn followed(
        &mut self,
        root: &Path,
        pages: &[String],
        page: &str,
        link: &Link,
    ) -> Outcome<Option<String>> {
        let target = link.target.as_str();
        if target.contains("://") || target.starts_with("mailto:") || target.starts_with('#') {
            return Ok(None);
        }
        let (file, item) = match target.split_once('#') {
            Some((file, item)) => (file, Some(item)),
            None => (target, None),
        };
        let lost = |why: &str| Failure::new(format!("{page} links to {target}"), why);
        let place = joined(page, file).ok_or_else(|| lost("that lies outside"))?;
        if place == SUMMARY {
            return Ok(Some(relative(page, CONTENTS)));
        }
        if pages.contains(&place) {
            // mdBook calls a README's page index, but not in links to it.
            let renamed = file.strip_suffix("README.md");
            return Ok(renamed.map(|folder| match item {
                Some(item) => format!("{folder}index.md#{item}"),
                None => format!("{folder}index.md"),
            }));
        }
        let on_disk = root.join(&place);
        if PICTURES.iter().any(|ending| place.ends_with(ending)) && on_disk.is_file() {
            self.pictures.insert(place);
            return Ok(None);
        }
        if on_disk.is_dir() {
            for file in source::files_below(root, &place)? {
                self.sources.insert(file);
            }
            let list = format!("source/{place}/index.html");
            return Ok(Some(relative(page, &list)));
        }
        if !on_disk.is_file() {
            return Err(lost("there is no such file"));
        }
        let text = read(root, &place)?;
        self.sources.insert(place.clone());
        let shown = relative(page, &format!("source/{place}.html"));
        Ok(Some(match item {
            Some(item) => {
                let line = source::line_of(&text, item).map_err(|why| lost(&why))?;
                // The text after the address becomes the tooltip of the link.
                format!("{shown}#L{line} \"{place}:{line}\"")
            }
            None => shown,
        }))
    }

    /// Writes the pages, their pictures and the table of contents into a folder for mdBook.
    pub(crate) fn write(&self, root: &Path, folder: &Path) -> Outcome {
        for page in &self.pages {
            write(folder, &page.path, page.text.as_bytes())?;
        }
        write(folder, "SUMMARY.md", self.summary.as_bytes())?;
        write(folder, "book.css", read(root, STYLE)?.as_bytes())?;
        for picture in &self.pictures {
            let failed = |why| Failure::new(format!("reading {picture}"), why);
            let bytes = std::fs::read(root.join(picture)).map_err(failed)?;
            write(folder, picture, &bytes)?;
        }
        Ok(())
    }
}

/// Reads a file of the checkout.
pub(crate) fn read(root: &Path, path: &str) -> Outcome<String> {
    std::fs::read_to_string(root.join(path))
        .map_err(|why| Failure::new(format!("reading {path}"), why))
}

/// Writes a file and creates its parent folders.
pub(crate) fn write(folder: &Path, path: &str, bytes: &[u8]) -> Outcome {
    let place = folder.join(path);
    let failed = |why: std::io::Error| Failure::new(format!("writing {}", place.display()), why);
    if let Some(above) = place.parent() {
        std::fs::create_dir_all(above).map_err(failed)?;
    }
    std::fs::write(&place, bytes).map_err(failed)
}
