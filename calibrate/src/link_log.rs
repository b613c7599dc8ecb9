//! Link log of a run: the play that the run was, and contradictions of the campaign.

use std::path::Path;

use swimmer_files::{AnyGait, CampaignRun, LinkLog, Play, plays};
use swimmer_model::Gait as _;

use crate::cycles::Timing;
use crate::error::CalibrateError;
use crate::median::median;

/// A joint commanded further off than this belongs to another gait \[rad\]: dead bands and rounding are far smaller.
const OFF: f64 = 0.035;
/// A period that differs by more is another one, as a share.
const OTHER_PERIOD: f64 = 0.01;

/// Plays of a link log, computed once for all runs that name it.
pub(crate) struct Logged {
    ended: bool,
    frames: usize,
    plays: Vec<Play>,
}

impl From<LinkLog> for Logged {
    fn from(log: LinkLog) -> Self {
        Self {
            ended: log.ended,
            frames: log.frames.len(),
            plays: plays(&log.frames),
        }
    }
}

impl Logged {
    /// The run's play.
    pub(crate) fn timing(&self, path: &Path, run: &CampaignRun) -> Result<Timing, CalibrateError> {
        let plays = &self.plays;
        let play = match (run.timing.play, plays.as_slice()) {
            (Some(number), plays) => number.checked_sub(1).and_then(|index| plays.get(index)),
            (None, [only]) => Some(only),
            (None, _) => None,
        };
        let play = play.ok_or_else(|| {
            let periods: Vec<String> = plays
                .iter()
                .map(|play| format!("{} cycles of {} s", play.cycle_starts.len(), play.period_s))
                .collect();
            let number = run.timing.play;
            let asked = number.map_or(String::new(), |number| format!(", and no number {number}"));
            CalibrateError::Play {
                log: path.to_owned(),
                problem: format!(
                    "the log holds {} plays ({}){asked}; say by `play = 1`, 2, … which one this run was",
                    plays.len(),
                    periods.join(", ")
                ),
            }
        })?;
        Ok(Timing {
            cycle_start_s: run.timing.cycle_start_s,
            play: Some(play.clone()),
            clock_offset_s: run.timing.clock_offset_s,
        })
    }

    /// Contradictions of the campaign, and a missing end.
    pub(crate) fn doubts(&self, play: &Play, run: &CampaignRun, gait: &AnyGait) -> Vec<String> {
        let mut said = Vec::new();
        if !self.ended {
            said.push(format!(
                "its link log has no end: its writer was killed or its disk was full; the {} frames before were used",
                self.frames
            ));
        }
        if (play.period_s / run.period_s - 1.0).abs() > OTHER_PERIOD {
            said.push(format!(
                "the link log says otherwise: a cycle took {} s, not {} s",
                play.period_s, run.period_s
            ));
        }
        if let Some([commanded, named]) = commanded_another(play, gait) {
            said.push(format!(
                "the link log says otherwise: its joints were commanded up to {:.3}°, and {} turns them up to {:.3}°{}",
                commanded.to_degrees(),
                run.gait.readable(),
                named.to_degrees(),
                if (commanded - named).abs() < OFF {
                    " the same way round or not: add or remove :cw"
                } else {
                    ""
                }
            ));
        }
        said
    }
}

/// The largest commanded and stated angles, if half of the commands do not belong to this gait.
fn commanded_another(play: &Play, gait: &AnyGait) -> Option<[f64; 2]> {
    let named = |fraction: f64| -> [f64; 2] { gait.at(fraction).phi.into() };
    let largest = |angles: [f64; 2]| angles[0].abs().max(angles[1].abs());
    let off = play.setpoints.iter().map(|(fraction, commanded)| {
        let named = named(*fraction);
        largest([commanded[0] - named[0], commanded[1] - named[1]])
    });
    (median(off)? > OFF).then(|| {
        play.setpoints
            .iter()
            .fold([0.0, 0.0], |[a, b], (fraction, commanded)| {
                [
                    f64::max(a, largest(*commanded)),
                    f64::max(b, largest(named(*fraction))),
                ]
            })
    })
}
