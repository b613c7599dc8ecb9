//! One run from its track to its cycles: everything that a fit takes from it.

mod diagnoses;
mod either;
mod reported;
mod same;

use std::path::PathBuf;

use swimmer_files::{Reflectors, SwimmerFile};
use swimmer_model::{Gait as _, Swimmer};

use crate::cycles::{Clock, Cycles, Phase, Projection};
use crate::data::RunData;
use crate::error::CalibrateError;
use crate::fit::errors::RunErrors;
use crate::joints::{self, MeasuredJoints};
use crate::poses::{self, FrontRule, PoseOptions, PoseTrack, PoseWarning};
use crate::prediction::Played;
use crate::quantities::{QUANTITIES, predicted};

pub(crate) use either::EitherRun;
pub(crate) use reported::ReportedRun;
pub(crate) use same::same_recordings;

/// One run's outcome.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// Its place in the campaign.
    pub index: usize,
    /// The tracking file, or the place of its stated results.
    pub file: PathBuf,
    /// The gait as it was named.
    pub gait: String,
    /// The poses; empty for a run with stated results.
    pub poses: PoseTrack,
    /// The cycles: X, Y, rotation, ΔY, Δθ with deviations, the refined period.
    pub cycles: Cycles,
    /// Warnings of reader, poses and cycles.
    pub warnings: Vec<String>,
    /// Distance of the reflectors by the campaign \[m\].
    pub reflector_distance_m: f64,
    /// Its joint angles, where reflectors on the side links showed them.
    pub joints: Option<MeasuredJoints>,
    /// Gait that was played, as measured or as stated.
    pub(crate) played: Played,
    /// Variances that the scatter between its cycles does not show.
    pub(crate) errors: RunErrors,
}

impl RunResult {
    /// Returns `true` if results were stated, and there is no track.
    pub fn is_reported(&self) -> bool {
        self.cycles.phase == Phase::Reported
    }
}

/// A run that swims against the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Opposed {
    pub(crate) measured_m: f64,
    pub(crate) predicted_m: f64,
    /// Returns `true` if its gait is named with `:cw`.
    pub(crate) is_clockwise: bool,
}

/// The direction that a gait ran in if it swam against the model, and the change of its name.
pub(crate) fn other_direction(is_clockwise: bool) -> &'static str {
    if is_clockwise {
        "counter-clockwise (take :cw off"
    } else {
        "clockwise (add :cw to"
    }
}

impl std::fmt::Display for Opposed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "it swims against the model (X {:.3} mm, model {:.3} mm): the gait ran {} `gait`), or front and back are exchanged (say so \
             by `front` in its [[run]])",
            1e3 * self.measured_m,
            1e3 * self.predicted_m,
            other_direction(self.is_clockwise)
        )
    }
}

/// X over the model's, of a run that swam the other way: the model may be that of the search, which is not the robot yet.
const REVERSED: std::ops::Range<f64> = -8.0..-0.12;

/// A run on its way: everything that does not change when the model does.
pub(crate) struct Run<'a> {
    pub(crate) data: &'a RunData,
    index: usize,
    reflectors: Reflectors,
    poses: PoseTrack,
    pub(crate) clock: Clock,
    /// Commanded gait, by which its cycles are cut.
    commanded: Played,
    joints: Option<MeasuredJoints>,
}

impl<'a> Run<'a> {
    pub(crate) fn begin(
        data: &'a RunData,
        index: usize,
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
        let commanded = Played::commanded(&data.gait, swimmer.servo.as_ref(), data.period_s);
        Ok(Self {
            data,
            index,
            reflectors,
            poses,
            clock,
            commanded: commanded.map_err(|cause| CalibrateError::Prediction {
                file: file(),
                cause,
            })?,
            joints: None,
        })
    }

    /// Joint path for the model: the measured angles of the last cycles, else the stated gait.
    pub(crate) fn played(&self) -> Played {
        match &self.joints {
            None => self.commanded.clone(),
            Some(joints) => Played {
                path: joints.path.clone(),
                sides: Some(joints.sides),
                ..self.commanded.clone()
            },
        }
    }

    /// Variances that the scatter between its cycles does not show: of the model's values by measured angles, as the jackknife
    /// over cycles has them, and by the noise of the cameras.
    pub(crate) fn errors(
        &self,
        cycles: &Cycles,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<RunErrors, CalibrateError> {
        Ok(RunErrors {
            path: self.path_variances(swimmer, projection)?,
            noise: self.noise_variances(cycles),
        })
    }

    /// Variances of the values of one cycle by the noise of the cameras alone: twice that of a mean over its samples.
    fn noise_variances(&self, cycles: &Cycles) -> [f64; QUANTITIES] {
        let count = cycles.cycles.len().max(1) as f64;
        let squares = cycles.cycles.iter().map(|cycle| cycle.residual_m.powi(2));
        let samples = (cycles.period_s * self.poses.rate_hz).max(1.0);
        // Both coordinates of the middle of the reflectors.
        let length = squares.sum::<f64>() / count / samples;
        let angle = length * (2.0 / self.poses.report.distance_m).powi(2);
        [length, length, angle, length, angle]
            .map(|variance| if variance.is_finite() { variance } else { 0.0 })
    }

    fn path_variances(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<[f64; QUANTITIES], CalibrateError> {
        let paths = self.joints.iter().flat_map(|joints| &joints.without);
        let values: Vec<[f64; QUANTITIES]> = paths
            .map(|path| Ok(predicted(&path.predict(swimmer, projection)?.0)))
            .collect::<Result<_, CalibrateError>>()?;
        let count = values.len() as f64;
        Ok(std::array::from_fn(|q| {
            let mean = values.iter().map(|values| values[q]).sum::<f64>() / count.max(1.0);
            let squares = values.iter().map(|values| (values[q] - mean).powi(2));
            squares.sum::<f64>() * (count - 1.0).max(0.0) / count.max(1.0)
        }))
    }

    /// A cycle's start by this model's heading, as a fraction of the period.
    pub(crate) fn start(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<f64, CalibrateError> {
        let (_, heading) = self.commanded.path.predict(swimmer, projection)?;
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

    /// Without labels for front and back, the direction of travel decides: X has the model's sign. If log or flash give the
    /// starts of cycles, the heading may contradict.
    pub(crate) fn settled(
        &mut self,
        start_s: f64,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<Cycles, CalibrateError> {
        let (predicted, heading) = self.commanded.path.predict(swimmer, projection)?;
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
        let command = |u: f64| self.data.gait.at(u).phi;
        self.joints = joints::measure(
            &self.data.track,
            &self.poses,
            &cycles,
            &self.reflectors,
            swimmer,
            command,
        );
        Ok(cycles)
    }

    pub(crate) fn finish(self, cycles: Cycles, errors: RunErrors) -> RunResult {
        let reader = self.data.track.warnings.iter().map(ToString::to_string);
        let poses = self.poses.warnings.iter().map(ToString::to_string);
        let own = cycles.warnings.iter().map(ToString::to_string);
        let mut warnings: Vec<String> = reader.chain(poses).chain(own).collect();
        let contested =
            |warning: &PoseWarning| matches!(warning, PoseWarning::LabelsContested { .. });
        let commanded = self.poses.warnings.iter().any(contested);
        if self.poses.front == FrontRule::Travel && !commanded {
            warnings.push("no label distinguishes the front reflector from the back one; the direction of travel was taken as forwards".to_owned());
        }
        if self.reflectors.sides.is_some() && self.joints.is_none() {
            warnings.push("the reflectors on the side links were not seen in all parts of the cycle: the angles are the commanded ones".to_owned());
        }
        let played = self.played();
        let [front, back] = [self.reflectors.front.at, self.reflectors.back.at];
        RunResult {
            index: self.index,
            file: self.data.file.clone(),
            gait: self.data.gait_name.clone(),
            cycles,
            poses: self.poses,
            warnings,
            reflector_distance_m: (front[0] - back[0]).hypot(front[1] - back[1]),
            played,
            joints: self.joints,
            errors,
        }
    }
}

/// Returns `true` if X has the opposite sign of the model's, and about its size.
fn opposed(cycles: &Cycles, predicted_m: f64, is_clockwise: bool) -> Option<Opposed> {
    let measured_m = cycles.x.mean;
    let reversed = REVERSED.contains(&(measured_m / predicted_m));
    // A lone cycle has no error, and its word counts.
    let sure = cycles.x.se.is_nan() || measured_m.abs() > 3.0 * cycles.x.se;
    (reversed && sure).then_some(Opposed {
        measured_m,
        predicted_m,
        is_clockwise,
    })
}

/// The cycles of a single run.
///
/// # Errors
/// [`CalibrateError`]: no poses, no cycles, or a gait that the swimmer's servos cannot play.
///
/// ```
/// use std::fmt::Write;
/// use calibrate::{PoseOptions, TrackOptions, calibrate_run, load_run, load_tracks, poses, survey_file, usual_reflectors};
/// use swimmer_files::{AnyGait, SwimmerFile};
/// use swimmer_model::{Model, Tolerance, trajectory};
///
/// // Three cycles of a circle as cameras over the tank see two reflectors on the middle link, 71 mm apart.
/// let robot = SwimmerFile::preset("robot").unwrap();
/// let model = Model::new(&robot.swimmer).unwrap();
/// let mut text = "t,x_front,y_front,x_back,y_back\n".to_owned();
/// let mut start = swimmer_model::Pose::identity();
/// for cycle in 0..4 {
///     let mut end = start;
///     trajectory(&model, &AnyGait::circle(1.2), &Tolerance::default(), 1000, |point| {
///         end = start * point.pose;
///         if point.u < 1.0 {
///             let (sin, cos) = end.theta.sin_cos();
///             let (t, x, y) = (10.0 * (f64::from(cycle) + point.u), 0.0355 * cos, 0.0355 * sin);
///             writeln!(text, "{t:.2},{:.6},{:.6},{:.6},{:.6}", end.x + x, end.y + y, end.x - x, end.y - y).unwrap();
///         }
///     });
///     start = end;
/// }
/// # let file = std::env::temp_dir().join(format!("calibrate-run-{}.csv", std::process::id()));
/// std::fs::write(&file, text)?;
///
/// let options = TrackOptions::default();
/// assert_eq!(survey_file(&file, &options)?.frames, load_tracks(&file, &options)?.frames());
/// let run = load_run(&file, &"circle:1.2".parse()?, 10.0, &options)?;
/// let reflectors = usual_reflectors(&run.track, &robot.swimmer);
/// assert_eq!(poses(&run.track, &reflectors, &PoseOptions::of_period(10.0))?.samples.len(), 4000);
/// let result = calibrate_run(&run, &reflectors, &robot)?;
/// let x = swimmer_model::swim(&model, &AnyGait::circle(1.2), &Tolerance::default()).displacement.x;
/// assert!((result.cycles.x.mean / x - 1.0).abs() < 0.01);
/// # std::fs::remove_file(&file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn calibrate_run(
    run: &RunData,
    reflectors: &Reflectors,
    swimmer: &SwimmerFile,
) -> Result<RunResult, CalibrateError> {
    let projection = Projection::new();
    let mut begun = Run::begin(run, 0, reflectors, swimmer)?;
    let start_s = begun.start(&swimmer.swimmer, &projection)?;
    let cycles = begun.settled(start_s, &swimmer.swimmer, &projection)?;
    let errors = begun.errors(&cycles, &swimmer.swimmer, &projection)?;
    Ok(begun.finish(cycles, errors))
}
