//! `swimmer atlas --objective speed`: every locally fastest gait that the starts lead to.

use std::time::Instant;

use gait_optimizer::{Fastest, SpeedProblem};
use swimmer_files::SwimmerFile;

use super::Atlas;
use super::folder::fill;
use crate::document::Document;
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
        let progress = Progress::with_share("looking for optima");
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
        let title = format!("{}, atlas of speed", file.name);
        let mut answer = Document::new(format!("{title}: {starts} starts"));
        answer.line(
            "  no   |d|/(L T) 1/s    |d|/L          period s     leads       found  links cross",
        );
        for (number, fastest) in found.optima.iter().enumerate() {
            answer.line(format!(
                "  {:<3}  {:.10}   {:.10}   {:<10.6}   {:<9}   {:<6} {}",
                number + 1,
                fastest.speed_over_length,
                fastest.distance_over_length,
                fastest.period,
                quantity::angle(fastest.heading),
                fastest.found,
                quantity::crossing(fastest.gait.links_cross),
            ));
        }
        let best = found.best_uncertified.map_or_else(String::new, |best| {
            format!(" (the fastest |d|/(L T) = {best:.7} 1/s)")
        });
        answer.line(format!(
            "  not listed: chains of arcs that could not be certified: {}{best}; with too many corners: {}",
            found.uncertified, found.longer
        ));
        let value = |one: &Fastest| format!("|d|/(L T) = {:.6} 1/s", one.speed_over_length);
        let mut optima: Vec<_> = found.optima.iter().map(keys).collect();
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
            // Certified cycles of more corners than are looked at.
            .key("longer", found.longer)
            // Chains of arcs that failed their certificate, and the fastest of them.
            .key("uncertified", found.uncertified)
            .key_if("best_uncertified", found.best_uncertified)
            .key("seconds", seconds)
            .key_if("picture", picture);
        output.print(&answer);
        Ok(())
    }
}

fn keys(fastest: &Fastest) -> Document {
    let gait = &fastest.gait;
    let length = gait.swimmer.total_length();
    let mut keys = Document::default();
    keys.key("speed_over_length_per_s", fastest.speed_over_length)
        .key("speed_m_per_s", fastest.speed_over_length * length)
        .key("displacement_over_length", fastest.distance_over_length)
        .key("period_s", fastest.period)
        .key("heading_rad", fastest.heading)
        .key("arcs", gait.arcs.clone())
        .key("corners", gait.corners().to_vec())
        .key("links_cross", gait.links_cross)
        .key("certificate", gait.certificate.clone())
        .key("found", fastest.found);
    keys
}
