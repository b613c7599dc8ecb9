//! `swimmer sweep map`: a finished grid over two of its axes, drawn, exported, and looked over for odd designs.

use std::fmt;
use std::path::PathBuf;

use clap::ValueEnum;
use operations::sweep::{self as operation, MapOutput, MapRequest, field};
use sweep::{DoubtKind, Field};
use swimmer_files::write_atomically;

use super::picture;
use super::shown;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::{Output, document};
use crate::picture_file::{FigureOptions, FigureWidth, Kind};
use crate::quantity::{Rows, Table};

/// Draw a finished grid over two of its axes, with lines where the kind of gait changes
///
/// Also listed are designs that their neighbours cast doubt on: a tighter bound does better, both neighbours have a gait, or
/// what is best jumps. Designs without a gait stay white.
#[derive(Debug, clap::Args)]
pub(crate) struct Map {
    /// The folder of the plan
    folder: PathBuf,
    /// The axis to the right; by default the first one
    #[arg(long, value_name = "AXIS", value_parser = field)]
    across: Option<Field>,
    /// The axis upwards; by default the second one
    #[arg(long, value_name = "AXIS", value_parser = field)]
    up: Option<Field>,
    /// Value on another axis, as drag.chi=2 or objective=speed: the nearest one is taken; by default the first one
    #[arg(long, value_name = "AXIS=VALUE", value_parser = at)]
    at: Vec<(Field, f64)>,
    /// Quantity of the map
    #[arg(long, value_enum, default_value_t = MapQuantity::Displacement)]
    quantity: MapQuantity,
    /// Write the picture: .svg, .png in pixels, or .pdf for print
    #[arg(short, long, value_name = "FILE.svg|.png|.pdf")]
    output: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOptions,
    /// Write the map's numbers as JSON, which the lab page reads
    #[arg(long, value_name = "FILE.json")]
    export: Option<PathBuf>,
}

/// Quantity of the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MapQuantity {
    /// X/L of the best gait
    Displacement,
    /// Lighthill's efficiency
    Efficiency,
    /// Fastest, under the servos' rates of the spec
    Speed,
    /// Largest joint angle
    Amplitude,
    /// Rotation of a cycle
    Rotation,
    /// Y/L of a cycle
    Lateral,
    /// Arcs of the gait
    Structure,
    /// Speed against efficiency of all designs that no other one beats in both
    Pareto,
}

impl Map {
    pub(super) fn run(self, output: Output) -> Outcome {
        let files = MapFiles::new(self.quantity, self.output, self.figure, self.export)?;
        let mut found = operation::map(&MapRequest {
            folder: self.folder,
            across: self.across,
            up: self.up,
            at: self.at,
        })?;
        files.write(&mut found)?;
        output.rendered(&found, &Text(&found));
        Ok(())
    }
}

/// New files of a map: a picture, and the numbers.
#[derive(Debug)]
pub(crate) struct MapFiles {
    quantity: MapQuantity,
    picture: Option<(PathBuf, Kind)>,
    width: FigureWidth,
    export: Option<PathBuf>,
}

impl MapFiles {
    /// Files that do not exist yet.
    ///
    /// # Errors
    /// A file exists, the picture has another ending, or a width is given without a picture.
    pub(crate) fn new(
        quantity: MapQuantity,
        picture: Option<PathBuf>,
        figure: FigureOptions,
        export: Option<PathBuf>,
    ) -> Outcome<Self> {
        let picture = match picture {
            Some(path) => {
                may_be_written(&path)?;
                let kind = Kind::of(&path, &[Kind::Svg, Kind::Png, Kind::Pdf])?;
                Some((path, kind))
            }
            None => None,
        };
        let width = figure.width(picture.as_ref().map(|(_, kind)| *kind))?;
        if let Some(path) = &export {
            may_be_written(path)?;
        }
        Ok(Self {
            quantity,
            picture,
            width,
            export,
        })
    }

    /// Writes the files and names them in the output.
    ///
    /// # Errors
    /// No design of the map has the quantity, or the disk refuses.
    pub(crate) fn write(self, output: &mut MapOutput) -> Outcome {
        if let Some((path, kind)) = self.picture {
            let drawing = picture::drawn(&output.map, self.quantity, self.width)?;
            kind.write(&path, &drawing, self.width)?;
            output.picture = Some(path);
        }
        if let Some(path) = self.export {
            write_atomically(&path, document(&output.map).as_bytes())?;
            output.export = Some(path);
        }
        Ok(())
    }
}

/// Largest number of doubts that are listed singly.
const TOLD: usize = 12;

/// Output as text.
struct Text<'a>(&'a MapOutput);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(output) = self;
        let count = |kind| {
            output
                .doubts
                .iter()
                .filter(|doubt| doubt.kind == kind)
                .count()
        };
        let mut rows = Rows::default();
        rows.row("designs drawn", output.designs.to_string())
            .row("without a gait", output.without_gait.to_string())
            .row("not certified", output.uncertified.to_string())
            .row("kinds of gait", output.kinds.to_string())
            .row(
                "not beaten in speed and efficiency",
                output.pareto.to_string(),
            )
            .row(
                "unlike their neighbours",
                format!(
                    "{} beaten by a tighter bound, {} lost, {} jumps",
                    count(DoubtKind::Beaten),
                    count(DoubtKind::Lost),
                    count(DoubtKind::Jump)
                ),
            );
        for (what, path) in [("picture", &output.picture), ("numbers", &output.export)] {
            if let Some(path) = path {
                rows.row(what, shown(path));
            }
        }
        write!(f, "{rows}")?;
        if output.doubts.is_empty() {
            return Ok(());
        }
        let mut table = Table::new(["look at", "what", "its neighbour", "better by"]);
        for doubt in output.doubts.iter().take(TOLD) {
            table.line([
                doubt.key.to_string(),
                match doubt.kind {
                    DoubtKind::Beaten => "beaten",
                    DoubtKind::Lost => "lost",
                    DoubtKind::Jump => "jump",
                }
                .to_owned(),
                doubt.neighbour.to_string(),
                doubt
                    .share
                    .map_or_else(String::new, |share| format!("{:.3} %", 100.0 * share)),
            ]);
        }
        write!(f, "\n\n{table}")?;
        if output.doubts.len() > TOLD {
            write!(
                f,
                "\n  and {} more (--json lists all)",
                output.doubts.len() - TOLD
            )?;
        }
        Ok(())
    }
}

fn at(text: &str) -> Result<(Field, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| "write an axis and its value, as drag.chi=2".to_owned())?;
    let field = field(name)?;
    let value = field
        .parse(value)
        .ok_or_else(|| format!("{value} is no value of {field}"))?;
    Ok((field, value))
}
