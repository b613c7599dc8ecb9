//! `swimmer completions` and `swimmer man`: what a shell and `man` know of the command, made from the command line itself.

use std::fmt;
use std::path::PathBuf;

use clap_complete::Shell;
use serde::Serialize;
use swimmer_files::write_atomically;

use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::{Output, write_all};

/// Print what a shell needs to complete the command
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// Shell of the completions
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Write the manual pages, one for each command
#[derive(Debug, clap::Args)]
pub(crate) struct Man {
    /// Folder of the pages; `man` searches a folder named man1
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

impl Completions {
    pub(crate) fn run(self, output: Output) {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut super::command(), "swimmer", &mut script);
        let script = String::from_utf8_lossy(&script).into_owned();
        if output.json {
            output.print(&Script { script });
        } else {
            write_all(&script);
        }
    }
}

#[derive(Debug, Serialize)]
struct Script {
    script: String,
}

impl fmt::Display for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.script)
    }
}

#[derive(Debug, Serialize)]
struct Pages {
    folder: PathBuf,
    pages: Vec<String>,
}

impl fmt::Display for Pages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, folder) = (self.pages.len(), self.folder.display());
        write!(f, "{count} manual pages are in {folder}.")
    }
}

impl Man {
    pub(crate) fn run(self, output: Output) -> Outcome {
        let folder = NewFolder::start(&self.output)?;
        let mut command = super::command();
        command.build();
        let mut pages = Vec::new();
        let mut left = vec![command];
        while let Some(command) = left.pop() {
            left.extend(
                command
                    .get_subcommands()
                    .filter(|command| command.get_name() != "help")
                    .cloned(),
            );
            let name = command.get_bin_name().unwrap_or(command.get_name());
            let page = format!("{}.1", name.replace(' ', "-"));
            let title = page.trim_end_matches(".1").to_owned();
            let mut text = Vec::new();
            clap_mangen::Man::new(command)
                .title(title)
                .render(&mut text)
                .map_err(|error| {
                    Failure::Tried(format!("cannot write the page {page}: {error}"))
                })?;
            write_atomically(&folder.draft().join(&page), &text)?;
            pages.push(page);
        }
        pages.sort();
        folder.publish()?;
        output.print(&Pages {
            folder: self.output,
            pages,
        });
        Ok(())
    }
}
