//! `swimmer atlas`: every locally optimal gait that a seeded multi-start finds.

mod folder;
mod follow;
mod picture;
mod speed;

use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use forecast::shortest_period;
use gait_optimizer::{
    Atlas as Found, AtlasError, AtlasProblem, Condition, Objective, Optimum, atlas_watched,
};
use swimmer_files::SwimmerFile;

use crate::arguments::{load_swimmer, rate};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::own_robot::{say_how_many_are_beyond, servo_rates};
use crate::progress::Progress;
use crate::quantity;
use crate::threads;

use super::optimize::output::add_figures;
use folder::fill;

/// Find every locally optimal gait, with and without the paper's symmetries, each certified
///
/// Random closed curves are optimised, polished by the maximum principle and put together: images of a gait under the
/// swimmer's own symmetries (left for right, front for back, run backwards) count as one. The same seed gives the same
/// atlas. For displacement the curves are simple; best is the largest net displacement, whatever its direction.
#[derive(Debug, clap::Args)]
pub(crate) struct Atlas {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// Objective of the gaits
    #[arg(long, value_name = "OBJECTIVE")]
    objective: Aim,
    /// No servo turns faster than this angle a second, a second one is that of joint 2: needed for speed; for displacement and
    /// efficiency the table then has the speed of each gait in its shortest period
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2)]
    max_rate: Vec<f64>,
    #[command(flatten)]
    bounds: CycleBounds,
    /// Number of random starts; known gaits are additional starts and not counted here
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
    /// Computes the atlas, lists it and writes its files.
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
                let mut answer = Document::new(format!("{}, {objective}: {followed}", file.name));
                answer
                    .key("continuation", followed)
                    .key("seconds", begun.elapsed().as_secs_f64());
                output.print(&answer);
                return Ok(());
            }
        }
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let starts = usize::try_from(self.starts).unwrap_or(usize::MAX);
        let progress = Progress::with_share("looking for optima");
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
        let (most, value): (_, fn(&Optimum) -> String) = match objective {
            Objective::Efficiency => ("efficiency", |one| {
                format!("ξ = {:.4e}", one.gait.efficiency)
            }),
            _ => ("displacement", |one| {
                format!("|d|/L = {:.5}", one.distance_over_length)
            }),
        };
        let title = format!("{}, atlas of {most}", file.name);
        let (mut answer, mut optima) = listed(&title, &found, &asked, (rates, seconds))?;
        let continuation = order.map(|order| order.best(&found)).transpose()?;
        if let Some(continuation) = &continuation {
            answer.line(continuation.to_string());
        }
        let picture = fill(
            folder,
            (&file.name, &title),
            found.optima.iter().map(|one| (&one.gait, value(one))),
            &mut optima,
            &mut answer,
        )?;
        answer
            .key("optima", optima)
            .key("starts", starts)
            // Further ones, from gaits that the quarter solvers find without a guess.
            .key("known_starts", found.starts.saturating_sub(starts))
            .key("unsettled", found.unsettled)
            .key("left", found.left)
            .key("uncertified", found.uncertified)
            // |d| over L or ξ of the best of these, by its curve of low order.
            .key_if("best_uncertified", found.best_uncertified)
            .key("seconds", seconds)
            .key_if("continuation", continuation)
            .key_if("picture", picture);
        output.print(&answer);
        Ok(())
    }

    /// Rate limit of each servo: the given one, or the robot's own for playable gaits; `None` without either.
    fn rates(&self, file: &SwimmerFile) -> Option<[f64; 2]> {
        servo_rates(&self.max_rate, self.bounds.playable(), file)
    }
}

/// Text of an atlas, and the keys of its gaits.
fn listed(
    title: &str,
    found: &Found,
    asked: &AtlasProblem,
    (rates, seconds): (Option<[f64; 2]>, f64),
) -> Outcome<(Document, Vec<Document>)> {
    let starts = asked.starts;
    let known = match found.starts.saturating_sub(starts) {
        0 => String::new(),
        count => format!(" and {count} from known gaits"),
    };
    let mut answer = Document::new(format!("{title}: {starts} random starts{known}"));
    let speed = rates.map_or("", |_| "|d|/(L T) 1/s  ");
    answer.line(format!(
        "  no   |d|/L          efficiency ξ     {speed}simple symmetric found  links cross"
    ));
    let mut optima = Vec::new();
    for (number, optimum) in found.optima.iter().enumerate() {
        let (keys, cells) = document_of(optimum, rates, seconds)?;
        answer.line(format!("  {:<3}  {cells}", number + 1));
        optima.push(keys);
    }
    let best = found.best_uncertified.map_or_else(String::new, |best| {
        let of = match asked.objective {
            Objective::Efficiency => "ξ",
            _ => "|d|/L",
        };
        format!(" (the best of these {of} = {best:.7}, uncertified)")
    });
    answer.line(format!(
        "  not listed: {} starts settled nowhere, {} left the shapes searched, {} ended where no gait could be certified{best}",
        found.unsettled, found.left, found.uncertified
    ));
    Ok((answer, optima))
}

/// Keys of a gait, and its cells of the table.
fn document_of(
    optimum: &Optimum,
    rates: Option<[f64; 2]>,
    seconds: f64,
) -> Outcome<(Document, String)> {
    let gait = &optimum.gait;
    let mut keys = Document::default();
    keys.key("efficiency", gait.efficiency)
        .key("displacement_over_length", gait.displacement_over_length)
        .key("displacement_m", gait.displacement)
        .key("lateral_over_length", gait.lateral_over_length)
        .key("distance_over_length", optimum.distance_over_length)
        .key("rotation_rad", gait.rotation)
        .key("start_angle_rad", gait.start_angle)
        .key("end_angle_rad", gait.end_angle)
        // Of the quarter where the gait is symmetric, else of the cycle.
        .key("arcs", gait.arcs.clone())
        .key("links_cross", gait.links_cross);
    add_figures(&mut keys, gait, Condition::ShootingResidual, |gait| {
        gait.certificate.value(Condition::ConstantPower)
    });
    keys.key("certificate", gait.certificate.clone())
        .key("simple", optimum.simple)
        .key("symmetric", gait.symmetric)
        .key("found", optimum.found)
        .key("seconds", seconds);
    let mut at_rate = String::new();
    if let Some(rates) = rates {
        // As fast as servos of these rates run it.
        let curve = gait.gait().map_err(|error| Failure::tried(&error))?;
        let period = shortest_period(&curve, rates)?;
        let speed = optimum.distance_over_length / period;
        keys.key("period_s", period)
            .key("speed_over_length_per_s", speed);
        at_rate = format!("{speed:.10}   ");
    }
    let yes = |value: bool| if value { "yes" } else { "no" };
    let cells = format!(
        "{:.10}   {:.10}     {at_rate}{:<6} {:<9} {:<6} {}",
        optimum.distance_over_length,
        gait.efficiency,
        yes(optimum.simple),
        yes(gait.symmetric),
        optimum.found,
        quantity::crossing(gait.links_cross),
    );
    Ok((keys, cells))
}

impl From<AtlasError> for Failure {
    /// Every way to fail is a problem that makes no sense.
    fn from(error: AtlasError) -> Self {
        Self::bad_input(&error)
    }
}
