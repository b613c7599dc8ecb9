//! `swimmer optimize steer`: the fastest gaits to steer by, from one common shape.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use gait_optimizer::{Certificate, Joined, SpeedProblem, SteerProblem, Steering, steer};
use serde::Serialize;
use swimmer_files::SwimmerFile;
use swimmer_model::Pose;

use crate::arguments::{joint_angle, load_swimmer, rate};
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::own_robot::servo_rates;
use crate::progress::Progress;
use crate::quantity::{self, Rows};
use crate::threads;

/// Find the fastest gaits forward, backward, to either side and round, all through one common shape at which they join
///
/// Backward, right and the turn to the right are the others run backwards, which undoes them exactly. The shape is the one of
/// those tried at which joining costs the three least; what it costs each is told, and so is a certificate of each.
#[derive(Debug, clap::Args)]
pub(crate) struct Steer {
    #[command(flatten)]
    pub(crate) problem: SteerArguments,
    /// Write the six gaits into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// What decides which gaits are found.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct SteerArguments {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    pub(crate) swimmer: String,
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present = "playable")]
    max_rate: Vec<f64>,
    #[command(flatten)]
    bounds: WholeBounds,
    /// The shape at which the gaits shall join: φ₁ and φ₂
    #[arg(long, value_name = "ANGLE,ANGLE", value_parser = shape, allow_hyphen_values = true)]
    pub(crate) shape: Option<[f64; 2]>,
}

fn shape(text: &str) -> Result<[f64; 2], String> {
    let (one, two) = text
        .split_once(',')
        .ok_or_else(|| format!("`{text}` is no shape: give ANGLE,ANGLE, as 80deg,32deg"))?;
    Ok([joint_angle(one.trim())?, joint_angle(two.trim())?])
}

impl SteerArguments {
    /// The rates of the servos \[rad/s\].
    ///
    /// # Errors
    /// [`Failure::BadInput`] where there is none.
    pub(crate) fn rates(&self, file: &SwimmerFile) -> Outcome<[f64; 2]> {
        servo_rates(&self.max_rate, self.bounds.playable(), file)
            .ok_or_else(|| Failure::BadInput("give --max-rate or --playable".to_owned()))
    }

    /// The gaits.
    ///
    /// # Errors
    /// Those of the search.
    pub(crate) fn find(&self, file: &SwimmerFile) -> Outcome<Steering> {
        let progress = Progress::of_a_whole("looking for gaits that join");
        let problem = SteerProblem {
            of: SpeedProblem {
                bounds: self.bounds.of(file),
                threads: threads::available(),
                ..SpeedProblem::new(file.swimmer, self.rates(file)?)
            },
            shape: self.shape,
        };
        Ok(steer(&problem, &|share| progress.at_share(share))?)
    }
}

/// The gaits with their names: each kind, and the same run backwards.
pub(crate) fn named(steering: &Steering) -> [(&'static str, &Joined, bool); 6] {
    let Steering {
        forward,
        left,
        turn,
        ..
    } = steering;
    [
        ("forward", forward, false),
        ("backward", forward, true),
        ("left", left, false),
        ("right", left, true),
        ("turn-left", turn, false),
        ("turn-right", turn, true),
    ]
}

impl Steer {
    pub(super) fn run(self, output: Output) -> Outcome {
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let file = load_swimmer(&self.problem.swimmer)?;
        let begun = Instant::now();
        let steering = self.problem.find(&file)?;
        let seconds = begun.elapsed().as_secs_f64();
        if let Some(folder) = folder {
            for (name, joined, backwards) in named(&steering) {
                let path = folder.draft().join(format!("{name}.gait"));
                joined.gait_file(&file.name, backwards).save(&path)?;
            }
            folder.publish()?;
        }
        output.answer(&Answer::new(
            &file,
            &steering,
            seconds,
            self.output.as_deref(),
        ));
        Ok(())
    }
}

/// One of the six.
#[derive(Debug, Serialize)]
struct GaitAnswer {
    name: &'static str,
    /// What a cycle brings in the frame of the middle link at the common shape.
    x_m: f64,
    y_m: f64,
    rotation_rad: f64,
    period_s: f64,
    /// |d|/(L T); `null` for the gaits that turn.
    speed_over_length_per_s: Option<f64>,
    /// |Δθ|/T of those.
    rotation_rad_per_s: Option<f64>,
    /// Share of the fastest gait's speed that joining takes.
    joining_costs: f64,
    certificate: Certificate,
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    /// Where the gaits join.
    shape_rad: [f64; 2],
    /// How many were tried.
    shapes: usize,
    /// The largest angle that the gait that turns was given, where it is kept from where the side links come near each other.
    turning_max_angle_rad: Option<f64>,
    gaits: Vec<GaitAnswer>,
    seconds: f64,
}

impl Answer {
    fn new(file: &SwimmerFile, steering: &Steering, seconds: f64, folder: Option<&Path>) -> Self {
        let length = file.swimmer.total_length();
        let of = |(name, joined, backwards): (&'static str, &Joined, bool)| {
            let turns = name.starts_with("turn");
            let [x, y, theta] = joined.net;
            let there = Pose::new(x, y, theta);
            let net = if backwards { there.inverse() } else { there };
            GaitAnswer {
                name,
                x_m: net.x * length,
                y_m: net.y * length,
                rotation_rad: net.theta,
                period_s: joined.period,
                speed_over_length_per_s: (!turns).then_some(joined.rate),
                rotation_rad_per_s: turns.then_some(joined.rate),
                joining_costs: joined.cost(),
                certificate: joined.gait.certificate.clone(),
                gait: folder.map(|folder| folder.join(format!("{name}.gait"))),
            }
        };
        Self {
            name: file.name.clone(),
            shape_rad: steering.shape,
            shapes: steering.shapes,
            turning_max_angle_rad: steering.turning_angle,
            gaits: named(steering).map(of).into_iter().collect(),
            seconds,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        for gait in &self.gaits {
            let fails = gait
                .certificate
                .checks()
                .iter()
                .filter(|check| !check.pass)
                .count();
            let certificate = match fails {
                0 => format!("{} conditions hold", gait.certificate.checks().len()),
                _ => format!(
                    "{fails} of {} conditions fail",
                    gait.certificate.checks().len()
                ),
            };
            rows.row(
                gait.name,
                format!(
                    "({}, {}, {}) in {:.3} s; joining costs {:.2} %; {certificate}",
                    quantity::length(gait.x_m),
                    quantity::length(gait.y_m),
                    quantity::angle(gait.rotation_rad),
                    gait.period_s,
                    gait.joining_costs * 100.0
                ),
            );
        }
        if let Some(angle) = self.turning_max_angle_rad {
            rows.row(
                "turns within",
                format!("{}, where side links stay apart", quantity::angle(angle)),
            );
        }
        let [one, two] = self.shape_rad.map(quantity::angle);
        write!(
            f,
            "{}: six gaits that join at ({one}, {two}), the best of {} shapes\n{rows}",
            self.name, self.shapes
        )
    }
}
