//! `swimmer atlas --objective speed`: every locally fastest gait that the starts lead to.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use forecast::shortest_period;
use gait_optimizer::{Arc, Certificate, Fastest, OptimalGait, Optimum, SpeedAtlas, SpeedProblem};
use serde::Serialize;
use swimmer_files::SwimmerFile;

use super::Atlas;
use super::folder::{drawn_in, saved};
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity;
use crate::threads;

impl Atlas {
    pub(super) fn of_speed(self, file: &SwimmerFile, output: Output) -> Outcome {
        let Some(rates) = self.rates(file) else {
            return Err(Failure::BadInput(
                "the fastest gait depends on how fast servos turn: give --max-rate, or --playable for the robot's own"
                    .to_owned(),
            ));
        };
        if self.way.is_some() {
            return Err(Failure::BadInput(
                "--continue follows gaits for displacement and efficiency, none for speed: leave it out"
                    .to_owned(),
            ));
        }
        let begun = Instant::now();
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let starts = usize::try_from(self.starts).unwrap_or(usize::MAX);
        let progress = Progress::of_a_whole("looking for optima");
        let problem = SpeedProblem {
            bounds: self.bounds.of(file),
            starts,
            seed: self.seed,
            threads: threads::available(),
            ..SpeedProblem::new(file.swimmer, rates)
        };
        let found = problem.atlas(&|share| progress.at_share(share))?;
        drop(progress);
        let seconds = begun.elapsed().as_secs_f64();
        let mut answer = SpeedAnswer::new(&file.name, &found, starts, seconds);
        if let Some(folder) = folder {
            for (number, (fastest, line)) in found.optima.iter().zip(&mut answer.optima).enumerate()
            {
                line.gait = Some(saved(&folder, number, &fastest.gait, &file.name)?);
            }
            let value =
                |fastest: &Fastest| format!("|d|/(L T) = {:.6} 1/s", fastest.speed_over_length);
            let gaits = found.optima.iter();
            let drawn: Vec<_> = gaits
                .map(|fastest| (&fastest.gait, value(fastest)))
                .collect();
            answer.picture = Some(drawn_in(&folder, answer.title.clone(), &drawn)?);
            folder.publish()?;
        }
        output.answer(&answer);
        Ok(())
    }
}

/// A gait as fast as servos of a given rate can run it.
#[derive(Debug, Serialize)]
pub(super) struct AtRate {
    period_s: f64,
    pub(super) speed_over_length_per_s: f64,
}

impl AtRate {
    pub(super) fn new(optimum: &Optimum, rates: [f64; 2]) -> Outcome<Self> {
        let gait = optimum
            .gait
            .gait()
            .map_err(|error| Failure::tried(&error))?;
        let period_s = shortest_period(&gait, rates)?;
        Ok(Self {
            period_s,
            speed_over_length_per_s: optimum.distance_over_length / period_s,
        })
    }
}

/// What was found, fastest first.
#[derive(Debug, Serialize)]
struct SpeedAnswer {
    #[serde(skip)]
    title: String,
    optima: Vec<Line>,
    starts: usize,
    /// Certified cycles of more corners than are looked at.
    longer: usize,
    /// Chains of arcs that failed their certificate.
    uncertified: usize,
    /// |d|/(L T) of the fastest of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    best_uncertified: Option<f64>,
    seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Line {
    speed_over_length_per_s: f64,
    speed_m_per_s: f64,
    /// |d| of a cycle.
    displacement_over_length: f64,
    period_s: f64,
    heading_rad: f64,
    arcs: Vec<Arc>,
    corners: Vec<f64>,
    links_cross: f64,
    certificate: Certificate,
    found: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

impl SpeedAnswer {
    fn new(name: &str, found: &SpeedAtlas, starts: usize, seconds: f64) -> Self {
        Self {
            title: format!("{name}, atlas of speed"),
            optima: found.optima.iter().map(Line::new).collect(),
            starts,
            longer: found.longer,
            uncertified: found.uncertified,
            best_uncertified: found.best_uncertified,
            seconds,
            picture: None,
        }
    }
}

impl Line {
    fn new(fastest: &Fastest) -> Self {
        let gait: &OptimalGait = &fastest.gait;
        Self {
            speed_over_length_per_s: fastest.speed_over_length,
            speed_m_per_s: fastest.speed_over_length * gait.swimmer.total_length(),
            displacement_over_length: fastest.distance_over_length,
            period_s: fastest.period,
            heading_rad: fastest.heading,
            arcs: gait.arcs.clone(),
            corners: gait.corners().to_vec(),
            links_cross: gait.links_cross,
            certificate: gait.certificate.clone(),
            found: fastest.found,
            gait: None,
        }
    }
}

impl fmt::Display for SpeedAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} starts", self.title, self.starts)?;
        writeln!(
            f,
            "  no   |d|/(L T) 1/s    |d|/L          period s     leads       found  links cross"
        )?;
        for (number, line) in self.optima.iter().enumerate() {
            writeln!(
                f,
                "  {:<3}  {:.10}   {:.10}   {:<10.6}   {:<9}   {:<6} {}",
                number + 1,
                line.speed_over_length_per_s,
                line.displacement_over_length,
                line.period_s,
                quantity::angle(line.heading_rad),
                line.found,
                quantity::crossing(line.links_cross),
            )?;
        }
        write!(
            f,
            "  not listed: chains of arcs that could not be certified: {}",
            self.uncertified
        )?;
        if let Some(best) = self.best_uncertified {
            write!(f, " (the fastest |d|/(L T) = {best:.7} 1/s)")?;
        }
        write!(f, "; with too many corners: {}", self.longer)?;
        if let Some(picture) = &self.picture {
            write!(f, "\n  drawn in {}", picture.display())?;
        }
        Ok(())
    }
}
