//! One experiment from its tracks to its drag: every run to cycles, all runs to one fit.

mod data;

use std::path::PathBuf;

use swimmer_files::{AnyGait, Campaign, FileError, LinkLogError, Reflectors, SwimmerFile};
use swimmer_model::{InvalidSwimmer, Swimmer};

use crate::cycles::{Clock, CycleError, Cycles, Projection};
use crate::fit::{self, Fit, FitError, FitOptions, Observation};
use crate::further::dead_band;
use crate::poses::{self, FrontRule, PoseError, PoseOptions, PoseTrack};
use crate::prediction::{JointPath, PredictionError};
use crate::tracks::TrackError;
pub use data::{CampaignData, RunData, load_run, load_tracks, track_options};

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    /// A tracking file cannot be opened.
    #[error("cannot read {}: {cause}; check the path and its permissions", file.display())]
    Open {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        cause: String,
    },
    /// A tracking file is broken, or in a format that is not read.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A gait file is wrong.
    #[error(transparent)]
    File(#[from] FileError),
    /// A link log is broken.
    #[error(transparent)]
    Log(#[from] LinkLogError),
    /// A link log does not say which of its plays a run was.
    #[error("{}: {problem}", log.display())]
    Play {
        /// The log.
        log: PathBuf,
        /// What is missing.
        problem: String,
    },
    /// A track gave no poses.
    #[error("{}: {cause}", file.display())]
    Poses {
        /// The tracking file.
        file: PathBuf,
        /// Why.
        cause: PoseError,
    },
    /// A track gave no cycles.
    #[error("{}: {cause}", file.display())]
    Cycles {
        /// The tracking file.
        file: PathBuf,
        /// Why.
        cause: CycleError,
    },
    /// A gait could not have been played.
    #[error("{}: {cause}", file.display())]
    Prediction {
        /// The tracking file of the run.
        file: PathBuf,
        /// Why.
        cause: PredictionError,
    },
    /// Nothing was fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}

impl CalibrateError {
    /// Whether the input is to blame (bad usage, exit 2) rather than the outcome (exit 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Open { .. }
            | Self::Track(_)
            | Self::File(_)
            | Self::Log(_)
            | Self::Play { .. }
            | Self::Prediction { .. } => true,
            Self::Poses { cause, .. } => {
                matches!(
                    cause,
                    PoseError::NoPoint { .. }
                        | PoseError::SamePlace
                        | PoseError::SamePoint { .. }
                        | PoseError::NoScale { .. }
                )
            }
            Self::Fit(cause) => matches!(cause, FitError::Level { .. } | FitError::Swimmer(_)),
            Self::Cycles { .. } => false,
        }
    }
}

impl From<InvalidSwimmer> for CalibrateError {
    fn from(cause: InvalidSwimmer) -> Self {
        Self::Fit(FitError::Swimmer(cause))
    }
}

/// One run's outcome.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// The tracking file.
    pub file: PathBuf,
    /// The gait as it was named.
    pub gait: String,
    /// The poses.
    pub poses: PoseTrack,
    /// The cycles: X, Y, rotation, ΔY, Δθ with deviations, the refined period.
    pub cycles: Cycles,
    /// What reader, poses and cycles had to say.
    pub warnings: Vec<String>,
    /// The way of the joints, as the starting swimmer's servos play the gait.
    pub(crate) path: JointPath,
}

/// A campaign's outcome.
#[derive(Debug, Clone)]
pub struct CampaignFit {
    /// The runs, in the campaign's order.
    pub runs: Vec<RunResult>,
    /// The fit.
    pub fit: Fit,
    /// The swimmer with the fitted parameters, ready to be saved.
    pub swimmer: SwimmerFile,
}

/// A run on its way: everything that does not change when the model does.
struct Run<'a> {
    data: &'a RunData,
    reflectors: Reflectors,
    poses: PoseTrack,
    clock: Clock,
    path: JointPath,
}

impl<'a> Run<'a> {
    fn begin(
        data: &'a RunData,
        common: &Reflectors,
        swimmer: &SwimmerFile,
    ) -> Result<Self, CalibrateError> {
        let file = || data.file.clone();
        let reflectors = data.reflectors(common);
        let options = PoseOptions::of_period(data.period_s);
        let poses = poses::poses(&data.track, &reflectors, &options).map_err(|cause| {
            CalibrateError::Poses {
                file: file(),
                cause,
            }
        })?;
        let clock = Clock::find(&poses, data.period_s, &data.timing).map_err(|cause| {
            CalibrateError::Cycles {
                file: file(),
                cause,
            }
        })?;
        let path =
            JointPath::new(&data.gait, swimmer.servo.as_ref(), data.period_s).map_err(|cause| {
                CalibrateError::Prediction {
                    file: file(),
                    cause,
                }
            })?;
        Ok(Self {
            data,
            reflectors,
            poses,
            clock,
            path,
        })
    }

    /// A cycle's start by this model's heading, as a fraction of the period.
    fn start(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<f64, CalibrateError> {
        let (_, heading) = self.path.predict(swimmer, projection)?;
        self.clock
            .start(&self.poses, &heading)
            .map_err(|cause| CalibrateError::Cycles {
                file: self.data.file.clone(),
                cause,
            })
    }

    fn cycles(&self, start_s: f64) -> Result<Cycles, CalibrateError> {
        self.clock
            .cycles(&self.poses, start_s)
            .map_err(|cause| CalibrateError::Cycles {
                file: self.data.file.clone(),
                cause,
            })
    }

    /// Where no label tells front from back, the direction of travel does: X has the model's sign. And where log or flash told
    /// when cycles began, the heading may object.
    fn settled(
        &mut self,
        start_s: f64,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<Cycles, CalibrateError> {
        let (predicted, heading) = self.path.predict(swimmer, projection)?;
        let mut cycles = self.cycles(start_s)?;
        if self.poses.front == FrontRule::Travel && predicted.x_m * cycles.x.mean < 0.0 {
            self.poses.turn_round(&self.reflectors);
            cycles = self.cycles(start_s)?;
        }
        self.clock
            .check_heading(&mut cycles, &heading)
            .map_err(|cause| CalibrateError::Cycles {
                file: self.data.file.clone(),
                cause,
            })?;
        Ok(cycles)
    }

    fn finish(self, cycles: Cycles) -> RunResult {
        let reader = self.data.track.warnings.iter().map(ToString::to_string);
        let poses = self.poses.warnings.iter().map(ToString::to_string);
        let own = cycles.warnings.iter().map(ToString::to_string);
        let mut warnings: Vec<String> = reader.chain(poses).chain(own).collect();
        if self.poses.front == FrontRule::Travel {
            warnings.push("no label tells the front reflector from the back one; the direction of travel was taken for forwards".to_owned());
        }
        RunResult {
            file: self.data.file.clone(),
            gait: self.data.gait_name.clone(),
            cycles,
            poses: self.poses,
            warnings,
            path: self.path,
        }
    }
}

/// The cycles of a single run.
///
/// # Errors
/// [`CalibrateError`]: no poses, no cycles, or a gait that the swimmer's servos cannot play.
pub fn calibrate_run(
    run: &RunData,
    reflectors: &Reflectors,
    swimmer: &SwimmerFile,
) -> Result<RunResult, CalibrateError> {
    let projection = Projection::new();
    let mut begun = Run::begin(run, reflectors, swimmer)?;
    let start_s = begun.start(&swimmer.swimmer, &projection)?;
    let cycles = begun.settled(start_s, &swimmer.swimmer, &projection)?;
    Ok(begun.finish(cycles))
}

/// Rounds of fit and phase: the phase of a gait without the paper's symmetries hangs on the drag, a little.
const ROUNDS: usize = 4;
/// Phases that differ by less are the same, as a fraction of the period.
const SAME_PHASE: f64 = 1e-5;

/// All runs of a campaign and the fit of r_s and χ. The campaign's swimmer gives lengths, servos, the c_t form and a start.
///
/// # Errors
/// [`CalibrateError`]: the first run that fails, or a fit that does.
pub fn calibrate_campaign(
    campaign: &Campaign,
    data: &CampaignData,
    options: FitOptions,
) -> Result<CampaignFit, CalibrateError> {
    let projection = Projection::new();
    let reflectors = &campaign.reflectors;
    let begin = |run| Run::begin(run, reflectors, &campaign.swimmer);
    let mut runs: Vec<Run<'_>> = data.runs.iter().map(begin).collect::<Result<_, _>>()?;
    let gaits: Vec<AnyGait> = data.runs.iter().map(|run| run.gait.clone()).collect();
    let mut swimmer = campaign.swimmer.swimmer;
    let mut starts = starts(&runs, &swimmer, &projection)?;
    let mut round = 0;
    loop {
        round += 1;
        let mut cycles = Vec::with_capacity(runs.len());
        for (run, start_s) in runs.iter_mut().zip(&starts) {
            cycles.push(run.settled(*start_s, &swimmer, &projection)?);
        }
        let observations: Vec<Observation> = runs
            .iter()
            .zip(&cycles)
            .map(|(run, cycles)| Observation::new(run.path.clone(), cycles))
            .collect();
        fit::check_signs(&swimmer, &observations)?;
        let fit = fit::fit(&swimmer, &observations, &gaits, options.level)?;
        swimmer = Swimmer {
            sphere_radius: fit.sphere_radius,
            chi: fit.chi,
            ..swimmer
        };
        let next = self::starts(&runs, &swimmer, &projection)?;
        let moved = |(run, (a, b)): (&Run<'_>, (&f64, &f64))| {
            let cycles = (b - a) / run.clock.period_s();
            (cycles - cycles.round()).abs() > SAME_PHASE
        };
        let settled = !runs.iter().zip(starts.iter().zip(&next)).any(moved);
        if settled || round == ROUNDS {
            let finished = runs.into_iter().zip(cycles);
            let mut found = CampaignFit {
                runs: finished.map(|(run, cycles)| run.finish(cycles)).collect(),
                swimmer: campaign.swimmer.fitted(fit.sphere_radius, fit.chi),
                fit,
            };
            let dead_band = dead_band::noticed(campaign, data, &found);
            found.fit.warnings.extend(dead_band);
            return Ok(found);
        }
        starts = next;
    }
}

fn starts(
    runs: &[Run<'_>],
    swimmer: &Swimmer<f64>,
    projection: &Projection,
) -> Result<Vec<f64>, CalibrateError> {
    runs.iter()
        .map(|run| run.start(swimmer, projection))
        .collect()
}
