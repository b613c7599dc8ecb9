//! `swimmer paper`: every number and figure of the paper, computed.

use std::fmt;
use std::path::PathBuf;

use swimmer_files::write_atomically;
use validation::{Study, rows};

use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::paper::{deviation, figures, number, open, page, printed};
use crate::picture_file::{FigureOptions, Kind};
use crate::progress::Progress;
use crate::quantity::Table;

/// Compute every number and figure of the paper: the paper's value, ours, the deviation
///
/// A number that the paper's own definitions do not lead to is marked not reproducible, with the reason; any other that
/// differs ends with status 1.
#[derive(Debug, clap::Args)]
pub(crate) struct Paper {
    /// Write the figures (SVG and PNG), their points (CSV) and one page with everything into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOptions,
}

const PAGE: &str = "index.html";

impl Paper {
    /// Computes everything and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let width = self.figure.width(self.output.as_ref().map(|_| Kind::Svg))?;
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let progress = Progress::with_share("computing the paper's gaits");
        let study =
            Study::new(&|share| progress.at_share(share)).map_err(|why| Failure::tried(&why))?;
        progress.doing("drawing");
        let rows = rows(&study);
        let mut written = None;
        if let Some(folder) = folder {
            let drawn = figures(&study)?;
            for figure in &drawn {
                let place = |ending: &str| folder.draft().join(format!("{}.{ending}", figure.name));
                let drawing = figure.svg(width)?;
                for kind in [Kind::Svg, Kind::Png] {
                    kind.write(&place(kind.ending()), &drawing, width)?;
                }
                write_atomically(&place("csv"), figure.csv()?.as_bytes())?;
            }
            let html = page(&rows, &drawn)?;
            write_atomically(&folder.draft().join(PAGE), html.as_bytes())?;
            written = Some(folder.place().join(PAGE));
            folder.publish()?;
        }
        let differ: Vec<&str> = rows
            .iter()
            .filter(|row| row.pass == Some(false))
            .map(|row| row.id)
            .collect();
        let failure = (!differ.is_empty()).then(|| {
            Failure::AlreadyPrinted(format!("differ from the paper: {}", differ.join(", ")))
        });
        drop(progress);
        let compared = validation::Output {
            page: written,
            ..validation::Output::new(rows)
        };
        output.rendered(&compared, &Text(&compared));
        failure.map_or(Ok(()), Err)
    }
}

/// Output as text.
struct Text<'a>(&'a validation::Output);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(output) = self;
        let mut table = Table::new(["quantity", "paper", "ours", "deviation", ""]);
        for row in &output.rows {
            let verdict = match row.pass {
                Some(true) => "ok",
                Some(false) => "DIFFERS",
                None => open(row),
            };
            table.line([
                row.quantity.to_owned(),
                printed(row.paper),
                number(row.ours),
                deviation(row),
                verdict.to_owned(),
            ]);
        }
        write!(f, "{table}")?;
        for row in output.rows.iter().filter(|row| row.pass.is_none()) {
            write!(f, "\n  {}: {}", row.id, row.note)?;
        }
        let validation::Output {
            numbers,
            statements,
            ..
        } = output;
        write!(
            f,
            "\n  {} printed numbers: {} reproduced, {} differ, {} not reproducible",
            numbers.total(),
            numbers.reproduced,
            numbers.differ,
            numbers.open
        )?;
        write!(
            f,
            "\n  {} statements: {} hold, {} differ, {} that cannot be compared",
            statements.total(),
            statements.reproduced,
            statements.differ,
            statements.open
        )?;
        if let Some(page) = &output.page {
            write!(f, "\n  written to {}", page.display())?;
        }
        Ok(())
    }
}
