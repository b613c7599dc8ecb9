//! `swimmer atlas`: every locally optimal gait that a seeded multi-start finds.

mod continuation;
mod folder;
mod picture;
mod text;

use std::path::PathBuf;

use clap::ValueEnum;
use operations::atlas::{self, OptimumOutput, Request, speed};
use operations::{SwimmerSource, optimize};
use swimmer_files::Objective;

use crate::arguments::rate;
use crate::bounds::CycleBounds;
use crate::context::perform;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::picture_file::{FigureOptions, FigureWidth, Kind};

use folder::{Entry, fill};

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
    #[arg(long, value_name = "N", default_value_t = atlas::STARTS, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// Seed of the starts
    #[arg(long, value_name = "N", default_value_t = atlas::SEED)]
    seed: u64,
    /// Follow the gaits as a parameter changes from FROM to TO: max-angle (an angle), chi, sphere (radius in metres) or
    /// link-ratio (side link over middle link, at the same total length)
    ///
    /// Reported are the points on the way and what happens there: arcs that appear or vanish, folds, mergers, branches that
    /// overtake each other, optima that are lost. Efficiency: the atlas is made at FROM and its two best gaits are followed;
    /// with --gait the named ones instead, without an atlas. Displacement: the two gaits with the paper's symmetries that
    /// carry farthest (where there are two), without an atlas.
    #[arg(long = "continue", value_name = "PARAMETER=FROM..TO")]
    way: Option<atlas::continuation::Range>,
    /// Efficiency gait to follow with --continue; may be given twice, to compare both
    #[arg(long, value_name = "GAIT", requires = "way")]
    gait: Vec<continuation::Named>,
    /// Equal steps to follow gaits in; smaller ones are taken where they must be
    #[arg(long, value_name = "N", default_value_t = atlas::continuation::STEPS, requires = "way", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    steps: u32,
    /// Put every gait as a gait file and a picture of them all into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOptions,
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
        let request = self.request();
        if request.is_without_atlas() && self.output.is_some() {
            return Err(Failure::BadInput(
                "--output holds the gaits of an atlas, and none is made here: leave it out"
                    .to_owned(),
            ));
        }
        let width = self.figure.width(self.output.as_ref().map(|_| Kind::Svg))?;
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let mut found = perform(|context| atlas::run(&request, context))?;
        if let Some(folder) = folder {
            write(folder, &mut found, width)?;
        }
        let text = match &found {
            atlas::Output::Atlas(found) => text::atlas(found),
            atlas::Output::Speed(found) => text::of_speed(found),
            atlas::Output::Followed(found) => text::followed(found),
        };
        output.rendered(&found, &text);
        Ok(())
    }

    fn request(&self) -> Request {
        let count = |number: u32| usize::try_from(number).unwrap_or(usize::MAX);
        let gaits = self.gait.iter().map(|gait| match gait {
            continuation::Named::Small => optimize::efficiency::Optimum::Small,
            continuation::Named::Large => optimize::efficiency::Optimum::Large,
        });
        Request {
            swimmer: SwimmerSource::from(self.swimmer.as_str()),
            objective: match self.objective {
                Aim::Displacement => atlas::Aim::Displacement,
                Aim::Efficiency => atlas::Aim::Efficiency,
                Aim::Speed => atlas::Aim::Speed,
            },
            max_rate: self.max_rate.clone(),
            bounds: self.bounds.into(),
            starts: count(self.starts),
            seed: self.seed,
            continuation: self.way.map(|way| atlas::continuation::Request {
                parameter: way.parameter,
                from: way.from,
                to: way.to,
                steps: count(self.steps),
                gaits: gaits.collect(),
            }),
        }
    }
}

/// Writes gaits and picture, and names them in the output.
fn write(folder: NewFolder, found: &mut atlas::Output, width: FigureWidth) -> Outcome {
    match found {
        atlas::Output::Atlas(found) => {
            let (name, title, objective) =
                (found.name.clone(), text::title(found), found.objective);
            let optima = found.optima.iter_mut();
            let entries = optima.map(|optimum| entry(objective, optimum)).collect();
            found.picture = Some(fill(folder, &name, title, entries, width)?);
        }
        atlas::Output::Speed(found) => {
            let (name, title) = (found.name.clone(), text::speed_title(found));
            let entries = found.optima.iter_mut().map(fastest).collect();
            found.picture = Some(fill(folder, &name, title, entries, width)?);
        }
        atlas::Output::Followed(_) => {}
    }
    Ok(())
}

fn entry(objective: Objective, optimum: &mut OptimumOutput) -> Entry<'_> {
    Entry {
        value: text::value(objective, optimum),
        gait: &optimum.optimal,
        path: &mut optimum.gait,
    }
}

fn fastest(optimum: &mut speed::FastestOutput) -> Entry<'_> {
    Entry {
        value: format!("|d|/(L T) = {:.6} 1/s", optimum.speed_over_length_per_s),
        gait: &optimum.optimal,
        path: &mut optimum.gait,
    }
}
