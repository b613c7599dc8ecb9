//! `swimmer optimize steer`: the fastest gaits to steer by, from one common shape.

use std::path::{Path, PathBuf};

use gait_optimizer::Steering;
use operations::SwimmerSource;
use operations::optimize::steer::{self, JoinedOutput, Options, Request, named};
use swimmer_files::SwimmerFile;

use crate::arguments::{angle, rate};
use crate::bounds::CycleBounds;
use crate::context::perform;
use crate::failure::Outcome;
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::quantity::{self, Rows};

/// Find the fastest gaits forward, backward, to either side and round, all through one common shape at which they join
///
/// Backward, right and the turn to the right are the others run backwards, which undoes them exactly. Of
/// the shapes tried, the one at which joining costs the three least is chosen. The cost and a certificate of each gait are printed.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Steer {
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present = "playable")]
    max_rate: Vec<f64>,
    #[command(flatten)]
    bounds: CycleBounds,
    /// The shape at which the gaits shall join: φ₁ and φ₂
    #[arg(long, value_name = "ANGLE,ANGLE", value_parser = shape, allow_hyphen_values = true)]
    shape: Option<[f64; 2]>,
}

fn shape(text: &str) -> Result<[f64; 2], String> {
    let (one, two) = text
        .split_once(',')
        .ok_or_else(|| format!("`{text}` is no shape: give ANGLE,ANGLE, as 80deg,32deg"))?;
    Ok([angle(one.trim())?, angle(two.trim())?])
}

impl Steer {
    /// Playable gaits that join at the straight shape.
    pub(crate) fn straight() -> Self {
        Self {
            max_rate: Vec::new(),
            bounds: CycleBounds::for_playing(),
            shape: Some([0.0; 2]),
        }
    }

    /// Options of the search.
    pub(crate) fn options(&self) -> Options {
        Options {
            max_rate: self.max_rate.clone(),
            bounds: self.bounds.into(),
            shape: self.shape,
        }
    }

    /// Rates of the servos \[rad/s\].
    ///
    /// # Errors
    /// No rate is given, and the gaits need not be playable.
    pub(crate) fn rates(&self, file: &SwimmerFile) -> Outcome<[f64; 2]> {
        Ok(self.options().rates(file)?)
    }

    /// Finds the gaits.
    ///
    /// # Errors
    /// Those of the search.
    fn find(&self, file: &SwimmerFile) -> Outcome<Steering> {
        let (steering, _) = perform(|context| steer::find(file, &self.options(), context))?;
        Ok(steering)
    }
}

/// Searches the gaits that join at the straight shape, and writes them into a folder.
///
/// # Errors
/// Those of the search and of the disk.
pub(crate) fn write_straight(file: &SwimmerFile, folder: &Path) -> Outcome {
    let steering = Steer::straight().find(file)?;
    for (name, joined, backwards) in named(&steering) {
        let gait = joined.gait_file(&file.name, backwards);
        gait.save(&folder.join(format!("{name}.gait")))?;
    }
    Ok(())
}

// Its help is that of the options.
#[derive(Debug, clap::Args)]
pub(crate) struct Search {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    steer: Steer,
    /// Write the six gaits into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Search {
    pub(super) fn run(self, output: Output) -> Outcome {
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let request = Request {
            swimmer: SwimmerSource::from(self.swimmer.as_str()),
            options: self.steer.options(),
        };
        let mut found = perform(|context| steer::run(&request, context))?;
        if let Some(folder) = folder {
            write_gaits(&mut found, folder)?;
        }
        output.rendered(&found, &text(&found));
        Ok(())
    }
}

/// Writes the gaits into a folder, and names their files in the output.
pub(crate) fn write_gaits(output: &mut steer::Output, folder: NewFolder) -> Outcome {
    for gait in &mut output.gaits {
        let name = format!("{}.gait", gait.name);
        gait.file.save(&folder.draft().join(&name))?;
        gait.gait = Some(folder.place().join(name));
    }
    folder.publish()
}

/// Output as text.
fn text(output: &steer::Output) -> String {
    let [one, two] = output.shape_rad.map(quantity::angle);
    let mut rows = Rows::default();
    for gait in &output.gaits {
        rows.row(gait.name, described(gait));
    }
    format!(
        "{}: six gaits that join at ({one}, {two}), the best of {} shapes\n{rows}",
        output.name, output.shapes
    )
}

/// Motion of a gait, and its certificate.
fn described(gait: &JoinedOutput) -> String {
    let checks = gait.certificate.checks();
    let verdict = match checks.iter().filter(|check| !check.pass).count() {
        0 => format!("{} conditions hold", checks.len()),
        fails => format!("{fails} of {} conditions fail", checks.len()),
    };
    format!(
        "({}, {}, {}) in {:.3} s; joining costs {:.2} %; {verdict}",
        quantity::length(gait.x_m),
        quantity::length(gait.y_m),
        quantity::angle(gait.rotation_rad),
        gait.period_s,
        gait.joining_costs * 100.0
    )
}
