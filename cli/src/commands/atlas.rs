//! `swimmer atlas`: every locally optimal gait that a seeded multi-start finds.

mod folder;
mod follow;
mod picture;
mod speed;

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use gait_optimizer::{
    Arc, Atlas as Found, AtlasError, AtlasProblem, Certificate, Condition, Objective, Optimum,
    atlas_watched,
};
use serde::Serialize;

use swimmer_files::SwimmerFile;

use crate::arguments::{load_swimmer, rate};
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::own_robot::{say_how_many_are_beyond, servo_rates};
use crate::progress::Progress;
use crate::quantity;
use crate::threads;

use super::optimize::answer::Figures;
use folder::{drawn_in, saved};
use speed::AtRate;

/// Find every locally optimal gait, with and without the paper's symmetries, each certified
///
/// Random closed curves are optimised, polished by the maximum principle and put together: images of a gait under the
/// swimmer's own symmetries (left for right, front for back, run backwards) count as one. The same seed gives the same
/// atlas. For displacement the curves are simple; best is the largest net displacement, whatever its direction.
#[derive(Debug, clap::Args)]
pub(crate) struct Atlas {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// What the gaits are optimal for
    #[arg(long, value_name = "OBJECTIVE")]
    objective: Aim,
    /// No servo turns faster than this angle a second, a second one is that of joint 2: needed for speed; for displacement and
    /// efficiency the table then tells how fast each gait is in its shortest period
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2)]
    max_rate: Vec<f64>,
    #[command(flatten)]
    bounds: WholeBounds,
    /// How many random starts; gaits that are found without a guess are starts, too, and not counted here
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// Seed of the starts
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Follow the gaits as a parameter changes from FROM to TO: max-angle (an angle), chi, sphere (radius in metres) or
    /// link-ratio (side link over middle link, at the same total length)
    ///
    /// Reported are the points on the way and what happens there: arcs that appear or vanish, folds, mergers, branches that
    /// overtake each other, optima that are lost. Efficiency: the atlas is made at FROM and its two best gaits are followed;
    /// with --gait the named ones instead, without an atlas. Displacement: the two gaits with the paper's symmetries that
    /// carry farthest (where there are two), without an atlas.
    #[arg(long = "continue", value_name = "PARAMETER=FROM..TO", value_parser = follow::way)]
    way: Option<follow::Way>,
    /// Efficiency gait to follow with --continue; may be given twice, to compare both
    #[arg(long, value_name = "GAIT", requires = "way")]
    gait: Vec<follow::Named>,
    /// Equal steps to follow gaits in; smaller ones are taken where they must be
    #[arg(long, value_name = "N", default_value_t = 20, requires = "way", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    steps: u32,
    /// Put every gait as a gait file and a picture of them all into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Aim {
    Displacement,
    Efficiency,
    Speed,
}

impl Atlas {
    /// Makes the atlas that was asked for.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let begun = Instant::now();
        let objective = match self.objective {
            Aim::Displacement => Objective::Displacement,
            Aim::Efficiency => Objective::Efficiency,
            Aim::Speed => return self.of_speed(&file, output),
        };
        let rates = self.rates(&file);
        let mut bounds = self.bounds.of(&file);
        let order = self.way.map(|way| follow::Order {
            swimmer: file.swimmer,
            objective,
            bounds,
            way,
            steps: usize::try_from(self.steps).unwrap_or(usize::MAX),
        });
        let mut swimmer = file.swimmer;
        if let Some(order) = &order {
            if self.gait.is_empty() && objective == Objective::Efficiency {
                (swimmer, bounds) = order.at_first();
            } else if self.output.is_some() {
                return Err(Failure::BadInput(
                    "--output holds the gaits of an atlas, and none is made here: leave it out"
                        .to_owned(),
                ));
            } else {
                let followed = order.named(&self.gait)?;
                output.answer(&follow::Alone::new(
                    format!("{}, {objective}", file.name),
                    followed,
                    begun.elapsed().as_secs_f64(),
                ));
                return Ok(());
            }
        }
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let starts = usize::try_from(self.starts).unwrap_or(usize::MAX);
        let progress = Progress::of_a_whole("looking for optima");
        let asked = AtlasProblem {
            bounds,
            starts,
            seed: self.seed,
            threads: threads::available(),
            ..AtlasProblem::new(swimmer, objective)
        };
        let found = atlas_watched(&asked, &|share| progress.at_share(share))?;
        drop(progress);
        let seconds = begun.elapsed().as_secs_f64();
        say_how_many_are_beyond(&file, found.optima.iter().map(|optimum| &optimum.gait));
        let mut answer = Answer::new(&file.name, objective, &found, starts, seconds);
        if let Some(rates) = rates {
            for (line, optimum) in answer.optima.iter_mut().zip(&found.optima) {
                line.speed = Some(AtRate::new(optimum, rates)?);
            }
        }
        answer.continuation = order.map(|order| order.best(&found)).transpose()?;
        if let Some(folder) = folder {
            for (number, (optimum, line)) in found.optima.iter().zip(&mut answer.optima).enumerate()
            {
                line.gait = Some(saved(&folder, number, &optimum.gait, &file.name)?);
            }
            let value = |optimum: &Optimum| match objective {
                Objective::Efficiency => format!("ξ = {:.4e}", optimum.gait.efficiency),
                _ => format!("|d|/L = {:.5}", optimum.distance_over_length),
            };
            let gaits = found.optima.iter();
            let drawn: Vec<_> = gaits
                .map(|optimum| (&optimum.gait, value(optimum)))
                .collect();
            answer.picture = Some(drawn_in(&folder, answer.title(), &drawn)?);
            folder.publish()?;
        }
        output.answer(&answer);
        Ok(())
    }

    /// The limit of each servo: what was told, and the robot's own where gaits shall be playable; none where nothing was told.
    fn rates(&self, file: &SwimmerFile) -> Option<[f64; 2]> {
        servo_rates(&self.max_rate, self.bounds.playable(), file)
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    #[serde(skip)]
    objective: Objective,
    /// Best first.
    optima: Vec<Line>,
    /// Random ones, as asked for.
    starts: usize,
    /// Further starts, from gaits that the quarter solvers find without a guess.
    known_starts: usize,
    /// Starts that settled nowhere.
    unsettled: usize,
    /// Starts that left the shapes searched.
    left: usize,
    /// Starts whose end could not be polished to a certified gait.
    uncertified: usize,
    /// |d| over L or ξ of the best of these, by its curve of low order.
    #[serde(skip_serializing_if = "Option::is_none")]
    best_uncertified: Option<f64>,
    seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    continuation: Option<follow::Followed>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Line {
    efficiency: f64,
    displacement_over_length: f64,
    displacement_m: f64,
    lateral_over_length: f64,
    /// |d| over L.
    distance_over_length: f64,
    rotation_rad: f64,
    start_angle_rad: f64,
    end_angle_rad: f64,
    /// Of the quarter where the gait is symmetric, else of the cycle.
    arcs: Vec<Arc>,
    links_cross: f64,
    /// Of gaits for efficiency.
    #[serde(flatten)]
    figures: Option<Figures>,
    certificate: Certificate,
    simple: bool,
    symmetric: bool,
    found: usize,
    seconds: f64,
    /// As fast as servos of the given rate run it.
    #[serde(flatten)]
    speed: Option<AtRate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

impl Answer {
    /// `asked` random starts were asked for.
    fn new(name: &str, objective: Objective, found: &Found, asked: usize, seconds: f64) -> Self {
        Self {
            name: name.to_owned(),
            objective,
            optima: found
                .optima
                .iter()
                .map(|optimum| Line::new(optimum, seconds))
                .collect(),
            starts: asked,
            known_starts: found.starts.saturating_sub(asked),
            unsettled: found.unsettled,
            left: found.left,
            uncertified: found.uncertified,
            best_uncertified: found.best_uncertified,
            seconds,
            continuation: None,
            picture: None,
        }
    }

    fn title(&self) -> String {
        let most = match self.objective {
            Objective::Efficiency => "efficiency",
            _ => "displacement",
        };
        format!("{}, atlas of {most}", self.name)
    }
}

impl Line {
    fn new(optimum: &Optimum, seconds: f64) -> Self {
        let gait = &optimum.gait;
        Self {
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            lateral_over_length: gait.lateral_over_length,
            distance_over_length: optimum.distance_over_length,
            rotation_rad: gait.rotation,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.clone(),
            links_cross: gait.links_cross,
            figures: Figures::of(gait, Condition::ShootingResidual, |gait| {
                gait.certificate.value(Condition::ConstantPowerOfSamples)
            }),
            certificate: gait.certificate.clone(),
            simple: optimum.simple,
            symmetric: gait.symmetric,
            found: optimum.found,
            seconds,
            speed: None,
            gait: None,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} random starts", self.title(), self.starts)?;
        if self.known_starts > 0 {
            write!(f, " and {} from known gaits", self.known_starts)?;
        }
        writeln!(f)?;
        let timed = self.optima.iter().any(|line| line.speed.is_some());
        let speed = if timed { "|d|/(L T) 1/s  " } else { "" };
        writeln!(
            f,
            "  no   |d|/L          efficiency ξ     {speed}simple symmetric found  links cross"
        )?;
        for (number, line) in self.optima.iter().enumerate() {
            let yes = |value: bool| if value { "yes" } else { "no" };
            writeln!(
                f,
                "  {:<3}  {:.10}   {:.10}     {}{:<6} {:<9} {:<6} {}",
                number + 1,
                line.distance_over_length,
                line.efficiency,
                line.speed
                    .as_ref()
                    .map_or_else(String::new, |speed| format!(
                        "{:.10}   ",
                        speed.speed_over_length_per_s
                    )),
                yes(line.simple),
                yes(line.symmetric),
                line.found,
                quantity::crossing(line.links_cross),
            )?;
        }
        write!(
            f,
            "  not listed: {} starts settled nowhere, {} left the shapes searched, {} ended where no gait could be certified",
            self.unsettled, self.left, self.uncertified
        )?;
        if let Some(best) = self.best_uncertified {
            let of = match self.objective {
                Objective::Efficiency => format!("ξ = {best:.7}"),
                _ => format!("|d|/L = {best:.7}"),
            };
            write!(f, " (the best of these {of}, uncertified)")?;
        }
        if let Some(continuation) = &self.continuation {
            write!(f, "\n{continuation}")?;
        }
        if let Some(picture) = &self.picture {
            write!(f, "\n  drawn in {}", picture.display())?;
        }
        Ok(())
    }
}

impl From<AtlasError> for Failure {
    /// Every way to fail is a problem that makes no sense.
    fn from(error: AtlasError) -> Self {
        Self::bad_input(&error)
    }
}
