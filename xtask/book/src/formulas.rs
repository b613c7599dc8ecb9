//! Conversion of formulas to HTML at build time (`KaTeX`, run by `Node.js`), so that a page needs neither scripts nor a network.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::failure::{Failure, Outcome};
use crate::markdown::{formulas, replaced};
use crate::stage::Page;

/// Path of `KaTeX` as npm installs it, from the root.
const KATEX: &str = "xtask/book/node_modules/katex/dist";
/// Format of the copied fonts; every browser of the last ten years supports it.
const LETTERS: &str = "woff2";
const SCRIPT: &str = "xtask/book/katex.mjs";
/// First characters of a converted formula.
const MARK: &str = "<span class=\"katex";

/// Converts the formulas of all pages in one run of Node.js.
pub(crate) fn set(root: &Path, pages: &mut [Page]) -> Outcome {
    let found: Vec<Vec<_>> = pages.iter().map(|page| formulas(&page.text)).collect();
    let asked: Vec<_> = found
        .iter()
        .flatten()
        .map(|formula| serde_json::json!({ "tex": formula.tex, "display": formula.display }))
        .collect();
    if asked.is_empty() {
        return Ok(());
    }
    let answer = run(root, &serde_json::Value::from(asked).to_string())?;
    let answer: Vec<String> = serde_json::from_str(&answer)
        .map_err(|why| Failure::new("reading the formulas that were set", why))?;
    let mut answer = answer.into_iter();
    for (page, formulas) in pages.iter_mut().zip(found) {
        let changes: Vec<_> = formulas
            .into_iter()
            .zip(answer.by_ref())
            .map(|(formula, html)| (formula.range, harmless(&html)))
            .collect();
        page.text = replaced(&page.text, &changes);
    }
    Ok(())
}

/// Number of formulas in the pages.
pub(crate) fn count(pages: &[Page]) -> usize {
    let of = |page: &Page| page.text.matches("<math ").count();
    pages.iter().map(of).sum()
}

/// Copies fonts and style sheet of `KaTeX` next to the pages.
pub(crate) fn copy_style(root: &Path, pages: &Path) -> Outcome {
    let (from, to) = (root.join(KATEX), pages.join("katex"));
    let failed = |why: std::io::Error| Failure::new("copying KaTeX's letters", why);
    std::fs::create_dir_all(to.join("fonts")).map_err(failed)?;
    std::fs::copy(from.join("katex.min.css"), to.join("katex.min.css")).map_err(failed)?;
    for entry in std::fs::read_dir(from.join("fonts")).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if let Some(name) = path.file_name()
            && path.extension().is_some_and(|ending| ending == LETTERS)
        {
            std::fs::copy(&path, to.join("fonts").join(name)).map_err(failed)?;
        }
    }
    Ok(())
}

fn run(root: &Path, asked: &str) -> Outcome<String> {
    let failed = |why: &dyn std::fmt::Display| {
        Failure::new(
            "setting formulas with KaTeX",
            format!("{why}; `cargo xtask book` installs what that needs"),
        )
    };
    let mut node = Command::new("node")
        .arg(SCRIPT)
        .current_dir(root)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|why| failed(&why))?;
    if let Some(mut input) = node.stdin.take() {
        input
            .write_all(asked.as_bytes())
            .map_err(|why| failed(&why))?;
    }
    let output = node.wait_with_output().map_err(|why| failed(&why))?;
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr);
        let why = why
            .lines()
            .find(|line| line.contains("Error"))
            .unwrap_or(&why);
        return Err(failed(&why.trim()));
    }
    String::from_utf8(output.stdout).map_err(|why| failed(&why))
}

/// Escapes the characters of HTML that Markdown would interpret.
fn harmless(html: &str) -> String {
    debug_assert!(html.starts_with(MARK));
    let mut out = String::with_capacity(html.len());
    for letter in html.chars() {
        match letter {
            '\\' | '_' | '*' | '`' | '[' | ']' | '|' | '~' | '$' => {
                let _ = write!(out, "&#{};", u32::from(letter));
            }
            '\n' => out.push(' '),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_leaves_a_formula_alone() {
        let html = "<span class=\"katex\"><annotation>a_1 \\cdot |b| [c]</annotation></span>";
        let mut out = String::new();
        pulldown_cmark::html::push_html(
            &mut out,
            pulldown_cmark::Parser::new(&format!("x {} y", harmless(html))),
        );
        assert!(
            out.contains(r"<annotation>a_1 \cdot |b| [c]</annotation>"),
            "{out}"
        );
    }
}
