//! Builds the book; `cargo xtask book` runs it. Collects the pages that `docs/SUMMARY.md` lists, typesets their formulas, replaces
//! links to source code by links to numbered lines, generates HTML with mdBook, and checks every link of the result.
//!
//! It is a package of its own because mdBook depends on a hundred crates, which would delay every `cargo xtask`.

mod check;
mod failure;
mod formulas;
mod markdown;
mod path;
mod source;
mod stage;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mdbook_driver::MDBook;
use mdbook_driver::config::Config;

use failure::{Failure, Outcome};
use stage::Staged;

/// Folder of the collected pages, next to the output folder.
const STAGE: &str = "book-pages";

fn main() -> ExitCode {
    let output = std::env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| PathBuf::from("target/book"));
    match build(Path::new("."), &output) {
        Ok(told) => {
            println!("{told}");
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Builds the book of the checkout at `root`. Returns a summary for the user.
fn build(root: &Path, output: &Path) -> Outcome<String> {
    let pages = output.with_file_name(STAGE);
    empty(&pages)?;
    empty(output)?;
    let mut staged = Staged::gather(root)?;
    formulas::set(root, &mut staged.pages)?;
    staged.write(root, &pages)?;
    formulas::copy_style(root, &pages)?;
    render(&pages, output)?;
    source::write_pages(root, &staged.sources, output)?;
    let seen = check::follow_links(output)?;
    Ok(format!(
        "{}: {} pages, {} formulas, {} files of source, {seen} links followed",
        output.join("index.html").display(),
        staged.pages.len(),
        formulas::count(&staged.pages),
        staged.sources.len()
    ))
}

/// Generates HTML from the collected pages with mdBook.
fn render(pages: &Path, output: &Path) -> Outcome {
    let failed = |why: String| Failure::new("making HTML of the pages", why);
    let absolute = |path: &Path| {
        std::path::absolute(path)
            .map_err(|why| failed(why.to_string()))
            .map(|path| path.display().to_string())
    };
    let config = format!(
        "[book]\ntitle = \"Swimmer\"\nlanguage = \"en\"\nsrc = \".\"\n\
         [build]\nbuild-dir = {:?}\ncreate-missing = false\n\
         [output.html]\nadditional-css = [\"katex/katex.min.css\", \"book.css\"]\nno-section-label = true\n\
         [output.html.print]\nenable = false\n[output.html.fold]\nenable = true\nlevel = 0\n",
        absolute(output)?
    );
    let config: Config = config.parse().map_err(|why| failed(format!("{why:#}")))?;
    let book = MDBook::load_with_config(pages, config).map_err(|why| failed(format!("{why:#}")))?;
    book.build().map_err(|why| failed(format!("{why:#}")))
}

/// Creates a folder or empties an existing one.
fn empty(folder: &Path) -> Outcome {
    let failed = |why: std::io::Error| Failure::new(format!("emptying {}", folder.display()), why);
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(failed)?;
    }
    std::fs::create_dir_all(folder).map_err(failed)
}
