//! `swimmer plan`: gaits of one family strung together to a target.

use std::path::{Path, PathBuf};

use forecast::{Family, Tank};
use operations::plan::{self, Request, Target};
use operations::{Files, SwimmerSource};
use swimmer_files::SwimmerFile;

use super::optimize::steer::Steer;
use crate::arguments::length;
use crate::context::perform;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::Output;
use crate::quantity::{self, Rows};

/// String the gaits of `optimize steer` together so that the swimmer comes to a target
///
/// Poses are those of the middle link with both joints straight: x and y from the tank's centre in metres, the heading from its
/// length. The way from the straight shape to the one at which the gaits join, and back, belongs to the plan. The plan is the
/// quickest that was found, of chains of three legs and, next to walls, of ways out to where they fit; a leg is a
/// number of cycles of one gait, drawn in a little so that the legs together meet the target as the robot plays it: soft start,
/// tables, servos with their dead band. Where no plan is found with the gaits whose joining costs least, because the swimmer has no
/// space to bend, gaits are searched that join at the straight shape.
///
/// `swimmer robot play --playlist` plays what -o writes.
#[derive(Debug, clap::Args)]
pub(crate) struct Plan {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    steer: Steer,
    /// Where to go, metres; with a heading or without
    #[arg(long, value_name = "X,Y[,ANGLE]", allow_hyphen_values = true)]
    to: Target,
    /// Where the swimmer is
    #[arg(
        long,
        value_name = "X,Y[,ANGLE]",
        allow_hyphen_values = true,
        default_value = "0,0,0"
    )]
    from: Target,
    /// Stay within the walls of this tank: length x width, m
    #[arg(long, value_name = "LENGTHxWIDTH")]
    tank: Option<Tank>,
    /// Come no nearer to a wall than this, m
    #[arg(long, value_name = "LENGTH_M", value_parser = length, default_value = "0.005")]
    margin: f64,
    /// Take the gaits from this folder, which `optimize steer -o` wrote, instead of looking for them
    #[arg(long, value_name = "DIR", conflicts_with = "shape")]
    gaits: Option<PathBuf>,
    /// Write the plan as a playlist, and its gaits next to it
    #[arg(short, long, value_name = "PLAYLIST")]
    output: Option<PathBuf>,
}

impl Plan {
    pub(crate) fn run(self, output: Output) -> Outcome {
        if let Some(path) = &self.output {
            may_be_written(path)?;
        }
        let request = Request {
            swimmer: SwimmerSource::from(self.swimmer.as_str()),
            steer: self.steer.options(),
            gaits: self.gaits,
            from: self.from,
            to: self.to,
            tank: self.tank,
            margin_m: self.margin,
        };
        let mut found = perform(|context| plan::run(&request, context))?;
        if let Some(path) = &self.output {
            write_playlist(path, &mut found)?;
        }
        output.rendered(&found, &text(&found));
        Ok(())
    }
}

/// Writes the playlist, and the gaits next to it.
///
/// # Errors
/// The path names no file, a gait file exists, or the disk refuses.
pub(crate) fn write_playlist(path: &Path, found: &mut plan::Output) -> Outcome {
    let playlist = found.name_files(path)?;
    for step in &found.steps {
        let file = path.with_file_name(&step.gait);
        may_be_written(&file)?;
        step.file.save(&file)?;
    }
    playlist.save(path)?;
    Ok(())
}

/// Output as text.
fn text(output: &plan::Output) -> String {
    let mut rows = Rows::default();
    for step in &output.steps {
        rows.row(
            step.gait.clone(),
            format!(
                "{} cycles of {:.3} s, at {:.2} % of its size",
                step.cycles,
                step.period_s,
                step.scale * 100.0
            ),
        );
    }
    let reached = &output.reached;
    rows.row(
        "reaches",
        format!(
            "({}, {}), heading {}: {:.1e} m off",
            quantity::length(reached.x_m),
            quantity::length(reached.y_m),
            quantity::angle(reached.heading_rad),
            output.off_m
        ),
    );
    for (label, off) in [
        ("χ 5 % lower", output.off_if_chi_is_5_percent_lower),
        ("χ 5 % higher", output.off_if_chi_is_5_percent_higher),
    ] {
        let Some(off) = off else { continue };
        rows.row(
            label,
            format!(
                "{} and {} off",
                quantity::length(off.distance_m),
                quantity::angle(off.angle_rad)
            ),
        );
    }
    rows.row(
        "found",
        format!(
            "{} chains meet the target, {} of them within the walls",
            output.chains, output.chains_within_walls
        ),
    );
    if let Some(path) = &output.playlist {
        rows.row("written to", path.display().to_string());
    }
    format!(
        "{}: the quickest plan found takes {:.1} s\n{rows}",
        output.name, output.duration_s
    )
}

/// The gaits of a folder that `optimize steer -o` wrote, as fast as servos of these rates \[rad/s\] turn.
///
/// # Errors
/// A gait is missing or cannot be read.
pub(crate) fn family_in(folder: &Path, rates: [f64; 2]) -> Outcome<Family> {
    Ok(plan::family_in(folder, rates, Files::Disk)?)
}

/// The gaits that a search finds.
///
/// # Errors
/// Those of the search.
pub(crate) fn family_of_search(steer: &Steer, file: &SwimmerFile) -> Outcome<Family> {
    perform(|context| plan::family_of_search(file, &steer.options(), context))
}
