//! Builds the book: gathers the pages that `docs/SUMMARY.md` names where they lie, sets their formulas, turns links to source
//! code into links to numbered lines, lets mdBook make HTML of it, and follows every link of that. `cargo xtask book` runs it.
//!
//! A package of its own, because mdBook brings a hundred crates and `cargo xtask` shall be there at once.

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

/// Where the pages are gathered before they become HTML, below the output folder's parent.
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

/// Builds the book of the checkout at `root`, and says what there is.
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

/// Lets mdBook make HTML of the gathered pages.
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

/// A folder with nothing in it.
fn empty(folder: &Path) -> Outcome {
    let failed = |why: std::io::Error| Failure::new(format!("emptying {}", folder.display()), why);
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(failed)?;
    }
    std::fs::create_dir_all(folder).map_err(failed)
}
