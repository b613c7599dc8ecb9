//! Cycles of a pose track: X, Y and rotation of each, ΔY and Δθ, with means and deviations.
//!
//! * Motion bounds the stretch in which the robot swam. The first whole cycle in it is start-up and is dropped. So are partial
//!   cycles at both ends, cycles with too many missing samples, and cycles unlike the others (the robot stopped or was pushed).
//! * The period is the commanded one, refined within ±2 % if the data clearly favour another.
//! * A cycle starts at the gait's first point, where φ₁ = φ₂ > 0. If the robot's link log or its flash gives the time, that is
//!   used ([`Timing`]). Otherwise the start is where the heading's harmonics match those of the model with the same gait, since
//!   the cameras do not see the joints. For the paper's gaits the match does not depend on the drag, by symmetry.
//! * X and Y are the step of SE(2) from one cycle to the next in the frame of the cycle's first heading. ΔY and Δθ are half
//!   of max − min of the cycle's harmonics about the drift from one cycle's mean to the next one's.

mod clock;
mod curve;
mod error;
mod fitted_cycle;
mod integral;
mod periodicity;
mod phase;
mod statistics;
mod warning;

use swimmer_files::{ReportedResults, ReportedValue};
use swimmer_model::Pose;

use crate::poses::{Jump, Origin, PoseSample, PoseTrack};
use clock::Bin;
pub(crate) use clock::shift;
pub(crate) use curve::{Curve, Harmonics, Projection};
pub use error::{CycleError, Loss};
use fitted_cycle::FittedCycle;
use periodicity::Judgement;
pub use periodicity::Periodicity;
use phase::CycleStarts;
pub use phase::{Phase, Timing};
pub use statistics::Statistics;
use warning::SAME_PHASE;
pub use warning::{CycleWarning, LeftOut};

/// Refinements of a start: each squares the error.
const REFINEMENTS: usize = 2;
/// Largest difference between the clocks of robot and cameras, as a share: far above that of crystals.
const CLOCKS_DIFFER: f64 = 1e-3;
/// Least number of samples in a cycle for a curve.
const FEWEST_SAMPLES: f64 = 24.0;
/// Largest share of a cycle's samples missing in gaps that affect its curve.
const MOST_MISSING: f64 = 0.1;
/// Largest share of a cycle's samples missing at all. Single lost frames widen the error of the curve, but do not bias it.
const MOST_LOST: f64 = 0.5;
/// Longest filled gap that does not affect the curve, as a share of a cycle: a twentieth of the highest harmonic's half wave.
/// A gap of one frame never does.
const SHORT_GAP: f64 = 0.005;

/// One cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// Start \[s\].
    pub start_s: f64,
    /// (X, Y) \[m\] and rotation \[rad\] to the next cycle, in the frame of this one's first heading; `None` where the next
    /// cycle was left out.
    pub step: Option<Pose<f64>>,
    /// ΔY \[m\].
    pub delta_y: f64,
    /// Δθ \[rad\].
    pub delta_theta: f64,
    /// Share of its samples that are missing: filled, or in gaps too long for that.
    pub missing: f64,
    /// Root mean square distance of the positions from the harmonic curve \[m\].
    pub residual_m: f64,
    curve: Curve,
}

impl Cycle {
    /// The pose of the cycle's harmonic curve at a fraction of it.
    pub fn at(&self, u: f64) -> Pose<f64> {
        self.curve.at(u)
    }
}

/// The cycles of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycles {
    /// The period \[s\], refined.
    pub period_s: f64,
    /// The cycles that count.
    pub cycles: Vec<Cycle>,
    /// Those that do not: when they start, and why.
    pub left_out: Vec<(f64, LeftOut)>,
    /// X \[m\].
    pub x: Statistics,
    /// Y \[m\].
    pub y: Statistics,
    /// Net rotation \[rad\].
    pub rotation: Statistics,
    /// ΔY \[m\].
    pub delta_y: Statistics,
    /// Δθ \[rad\].
    pub delta_theta: Statistics,
    /// Method by which their starts were determined.
    pub phase: Phase,
    /// Warnings.
    pub warnings: Vec<CycleWarning>,
    /// Mean harmonics of the heading, from the cycles' starts.
    pub(crate) heading: Harmonics,
}

impl Cycles {
    /// Result of a run with stated values: means and their errors, and no cycle.
    pub(crate) fn reported(reported: &ReportedResults, period_s: f64) -> Self {
        let of =
            |value: &Option<ReportedValue>| Statistics::reported(value.as_ref(), reported.cycles);
        Self {
            period_s,
            cycles: Vec::new(),
            left_out: Vec::new(),
            x: of(&reported.x),
            y: of(&reported.y),
            rotation: of(&reported.turn),
            delta_y: of(&reported.delta_y),
            delta_theta: of(&reported.delta_theta),
            phase: Phase::Reported,
            warnings: Vec::new(),
            heading: Harmonics::default(),
        }
    }

    /// Number of cycles in the means; `None` if it is not stated.
    pub fn count(&self) -> Option<usize> {
        match self.phase {
            Phase::Reported => {
                let counts = [self.x, self.delta_y, self.delta_theta].map(|s| s.count);
                counts.into_iter().max().filter(|count| *count > 1)
            }
            _ => Some(self.cycles.len()),
        }
    }
}

/// Timing of a run that does not depend on the start of a cycle; computed once per run.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    period_s: f64,
    active_s: (f64, f64),
    /// Time of the first motion.
    motion_s: f64,
    steady: Vec<Bin>,
    starts: CycleStarts,
    warnings: Vec<CycleWarning>,
}

impl Clock {
    pub(crate) fn find(
        track: &PoseTrack,
        commanded_s: f64,
        timing: &Timing,
    ) -> Result<Self, CycleError> {
        // The log of the commands is surer than the campaign file.
        let commanded_s = timing
            .play
            .as_ref()
            .map_or(commanded_s, |play| play.period_s);
        let bins = clock::bins(track, commanded_s);
        let lever = track.report.distance_m;
        let active_s = clock::active(&bins, lever, clock::REST)
            .ok_or_else(|| no_motion(track, commanded_s))?;
        // However long the robot rested in between.
        let motion = clock::active(&bins, lever, bins.len());
        // Motion is looked for over four hundredths of a cycle: the last of them may be rest.
        let until = active_s.1 - 0.04 * commanded_s;
        let within = |from: f64| {
            bins.iter()
                .flatten()
                .copied()
                .filter(|bin| bin.time_s >= from && bin.time_s <= until)
                .collect::<Vec<Bin>>()
        };
        let after_start = within(active_s.0 + commanded_s);
        let long = active_s.1 - active_s.0 > 2.0 * commanded_s;
        let steady = if long {
            after_start
        } else {
            within(active_s.0)
        };
        let mut warnings = Vec::new();
        let mut period = clock::refine_period(&steady, commanded_s);
        let off = (period.seconds / commanded_s - 1.0).abs();
        if timing.play.is_some() && (period.at_border || off > CLOCKS_DIFFER) {
            // The robot played by its own clock: what else seems better is noise.
            period = clock::Period {
                seconds: commanded_s,
                at_border: false,
            };
        }
        if period.at_border {
            warnings.push(CycleWarning::PeriodNotFound { commanded_s });
        }
        if (period.seconds / commanded_s - 1.0).abs() > 0.005 {
            warnings.push(CycleWarning::Period {
                commanded_s,
                found_s: period.seconds,
            });
        }
        match periodicity::judge(&steady, period.seconds, timing.play.is_some()) {
            Judgement::Fine => {}
            Judgement::Doubtful(repeats) => warnings.push(CycleWarning::Repeats(repeats)),
            Judgement::Hopeless(repeats) => return Err(CycleError::OtherPeriod(repeats)),
        }
        Ok(Self {
            period_s: period.seconds,
            active_s,
            motion_s: motion.map_or(active_s.0, |(first, _)| first),
            steady,
            starts: CycleStarts::new(timing, period.seconds),
            warnings,
        })
    }

    /// A start of a cycle \[s\], matched with the model's heading: roughly from averages, then from the cycles' own curves,
    /// which are drawn as the model's is.
    pub(crate) fn start(&self, track: &PoseTrack, model: &Harmonics) -> Result<f64, CycleError> {
        if let Some(known) = self.starts.known(self.motion_s) {
            return Ok(known);
        }
        let lost = |cause| Loss::of_most(track).map_or(cause, CycleError::Lost);
        let rough = self.rough_start(model).map_err(lost)?;
        let mut start = self.starts.nearest(rough, self.motion_s, self.period_s);
        for _ in 0..REFINEMENTS {
            // The caller gets the reason when it requests the cycles.
            let Ok(cycles) = self.cycles(track, start) else {
                break;
            };
            start += self.phase_error(&cycles, model);
        }
        Ok(start)
    }

    /// Delay of the cycles' start by the heading, relative to these cycles \[s\].
    pub(crate) fn phase_error(&self, cycles: &Cycles, model: &Harmonics) -> f64 {
        let shift = clock::shift(&cycles.heading, model).unwrap_or(0.0);
        (shift - shift.round()) * self.period_s
    }

    /// Warns if the heading contradicts a stated start.
    ///
    /// # Errors
    /// [`CycleError::OtherPeriod`] where it goes through several cycles of the model in one period.
    pub(crate) fn check_heading(
        &self,
        cycles: &mut Cycles,
        model: &Harmonics,
    ) -> Result<(), CycleError> {
        if let Some(repeats) = periodicity::several_times(&cycles.heading, model, self.period_s) {
            return Err(CycleError::OtherPeriod(repeats));
        }
        let by_s = self.phase_error(cycles, model);
        if cycles.phase != Phase::Heading && by_s.abs() > SAME_PHASE * self.period_s {
            let period_s = self.period_s;
            cycles
                .warnings
                .push(CycleWarning::PhaseDiffers { by_s, period_s });
        }
        Ok(())
    }

    /// Interval in which whole cycles may lie \[s\].
    fn window(&self, track: &PoseTrack) -> (f64, f64) {
        let ends = track.samples.first().zip(track.samples.last());
        match ends.filter(|_| self.starts.has_log()) {
            Some((first, last)) => (first.time_s, last.time_s),
            None => self.active_s,
        }
    }

    fn rough_start(&self, model: &Harmonics) -> Result<f64, CycleError> {
        let none = CycleError::NoPhase {
            period_s: self.period_s,
        };
        let swings = model.iter().flatten().any(|value| value.abs() > 1e-9);
        clock::cycle_start(&self.steady, self.period_s, model)
            .filter(|start| swings && start.is_finite())
            .ok_or(none)
    }

    pub(crate) fn period_s(&self) -> f64 {
        self.period_s
    }

    /// The cycles from a known start of one of them.
    pub(crate) fn cycles(&self, track: &PoseTrack, start_s: f64) -> Result<Cycles, CycleError> {
        let period = self.period_s;
        let (from, to) = self.window(track);
        let mut drawn: Vec<FittedCycle> = Vec::new();
        let mut left_out = Vec::new();
        let mut warnings = self.warnings.clone();
        let listed = self.starts.listed(start_s, period, (from, to));
        left_out.extend(listed.unsteady.iter().map(|s| (*s, LeftOut::Unsteady)));
        let starts = listed.starts;
        if listed.with_start_up && starts.len() == 1 {
            warnings.push(CycleWarning::StartUpKept);
        }
        for (index, start) in starts.iter().copied().enumerate() {
            if index == 0 && listed.with_start_up && starts.len() > 1 {
                left_out.push((start, LeftOut::StartUp));
                continue;
            }
            let samples = window(track, start, period);
            let jumps_in_it = |jump: &Jump| jump.before_s >= start && jump.after_s < start + period;
            if track.jumps.iter().any(jumps_in_it) {
                left_out.push((start, LeftOut::Jump));
                continue;
            }
            let segment = track.jumps.partition_point(|jump| jump.before_s < start);
            let whole = period * track.rate_hz;
            let tracked = samples.iter().filter(|s| !s.is_filled()).count();
            let missing = (1.0 - tracked as f64 / whole).max(0.0);
            let shown =
                missing - in_short_gaps(samples, (SHORT_GAP * whole).max(1.0)) as f64 / whole;
            let trusted = samples.iter().filter(|s| s.origin != Origin::Tail);
            let curve = Curve::fit(
                trusted.map(|s| ((s.time_s - start) / period, s.pose)),
                1.0 / (period * track.rate_hz),
            );
            match curve.filter(|_| shown <= MOST_MISSING && missing <= MOST_LOST) {
                Some((curve, residual_m)) => drawn.push(FittedCycle {
                    start_s: start,
                    missing,
                    curve,
                    residual_m,
                    segment,
                }),
                None => left_out.push((start, LeftOut::Missing(missing))),
            }
        }
        fitted_cycle::drop_unlike(&mut drawn, &mut left_out);
        let drawn = fitted_cycle::settle(drawn, period, track.report.distance_m, &mut left_out);
        let Some(FittedCycle { curve: lone, .. }) = drawn.first() else {
            let (from_s, active_s) = (from, to - from);
            return Err(CycleError::NoCycle {
                from_s,
                active_s,
                period_s: period,
                left_out: left_out.len(),
                loss: Loss::of(track, &left_out),
            });
        };
        let lone = lone.own_step();
        let heading = fitted_cycle::mean_heading(&drawn);
        let cycles: Vec<Cycle> = drawn
            .iter()
            .enumerate()
            .map(|(i, cycle)| cycle.cycle(drawn.get(i + 1), period))
            .collect();
        let mut steps: Vec<Pose<f64>> = cycles.iter().filter_map(|cycle| cycle.step).collect();
        if steps.is_empty() {
            warnings.push(CycleWarning::OneCycle);
            steps.push(lone);
        }
        left_out.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Cycles {
            period_s: period,
            x: Statistics::of(steps.iter().map(|step| step.x)),
            y: Statistics::of(steps.iter().map(|step| step.y)),
            rotation: Statistics::of(steps.iter().map(|step| step.theta)),
            delta_y: Statistics::of(cycles.iter().map(|cycle| cycle.delta_y)),
            delta_theta: Statistics::of(cycles.iter().map(|cycle| cycle.delta_theta)),
            cycles,
            left_out,
            phase: self.starts.phase(),
            warnings,
            heading,
        })
    }
}

/// Error for a recording without motion: with a very wrong period, its bins of hundredths show none.
fn no_motion(track: &PoseTrack, period_s: f64) -> CycleError {
    let ends = track.samples.first().zip(track.samples.last());
    let track_s = ends.map_or(0.0, |(first, last)| last.time_s - first.time_s);
    let samples = period_s * track.rate_hz;
    if let Some(loss) = Loss::of_most(track) {
        CycleError::Lost(loss)
    } else if track_s < 2.0 * period_s {
        CycleError::TooShort { track_s, period_s }
    } else if samples < FEWEST_SAMPLES {
        CycleError::TooQuick { samples, period_s }
    } else {
        CycleError::NoMotion
    }
}

/// Number of samples in filled gaps of at most `longest` rows.
fn in_short_gaps(samples: &[PoseSample], longest: f64) -> usize {
    let gaps = samples.chunk_by(|a, b| a.is_filled() == b.is_filled());
    let short = gaps.filter(|gap| gap.first().is_some_and(PoseSample::is_filled));
    short
        .map(<[PoseSample]>::len)
        .filter(|rows| *rows as f64 <= longest)
        .sum()
}

/// Samples in \[start, start + period).
fn window(track: &PoseTrack, start: f64, period: f64) -> &[PoseSample] {
    let from = track
        .samples
        .partition_point(|sample| sample.time_s < start);
    let until = track
        .samples
        .partition_point(|sample| sample.time_s < start + period);
    track.samples.get(from..until).unwrap_or(&[])
}
