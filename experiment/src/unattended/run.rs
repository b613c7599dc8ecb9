//! State machine of a run: one trial after the other, each from the start pose.
//!
//! ```text
//!            trial left              reached             settled            began
//!  Between ─────────────► Going ──────────────► Settling ─────► Waiting ───────────► Playing
//!     ▲                     │ no way, lost, …      │ lost          │                    │ last cycle ended, evaluated
//!     │                     ▼                      ▼               ▼                    ▼
//!     │                   Ended ◄───────────────────────────────────── battery, e-stop, link, operator
//!     └───────────────────────────────────────── finished, or failed: again, or given up
//! ```
//!
//! Every request is executed before the next one is taken. A trial is finished by the request [`Request::Write`] of its
//! `finished` line, which follows [`Request::EndTrack`]: a finished trial has its data. Whatever ends a run leaves a journal from which
//! the next run goes on.

use std::collections::{BTreeMap, VecDeque};

use forecast::{Planner, Step};

use super::{Entry, Journal, MeasuredCycle, Plan, StartPose, StopRules, Trial};
use crate::{
    Controller, CycleReport, Ending, Evaluated, Evaluation, Event, GaitOnRobot, Goal, Interruption,
    Likeness, Options, Pose, Request as Drive, TankWalls, TrackedPlay,
};

/// Request to the caller, executed in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// Append this event to the journal and make it durable.
    Write(Entry),
    /// Play the cycles of this step, from rest to rest.
    Drive(Step),
    /// Start the track of a trial in this file.
    BeginTrack(String),
    /// Close the track and make it durable.
    EndTrack,
    /// Play a gait of the plan.
    Play {
        /// Its name.
        gait: String,
        /// Cycles, the run-in included.
        cycles: u32,
    },
    /// Stop at once.
    Stop,
    /// Evaluate a cycle; the result is the event [`Event::Evaluated`].
    Evaluate(Box<Evaluation>),
}

/// Reason for the end of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum RunEnding {
    /// All trials are finished or given up.
    Complete,
    /// It ended early; another run goes on.
    Interrupted(String),
}

/// Runs the remaining trials of a plan.
#[derive(Debug)]
pub struct Run {
    plan: Plan,
    planner: Planner,
    gaits: BTreeMap<String, GaitOnRobot>,
    start: StartPose,
    stop: StopRules,
    left: VecDeque<RemainingTrial>,
    failures_in_a_row: u32,
    phase: Phase,
    requests: VecDeque<Request>,
    last_seen_s: Option<f64>,
    ending: Option<RunEnding>,
    finished: usize,
}

/// Trial that is neither finished nor given up.
#[derive(Debug)]
struct RemainingTrial {
    trial: Trial,
    attempts: u32,
    failures: u32,
}

#[derive(Debug)]
enum Phase {
    Between,
    Going(Box<Controller>),
    Settling {
        until_s: f64,
    },
    Waiting,
    Playing(Box<TrackedPlay>),
    /// At rest after the last cycle; its evaluation is outstanding.
    Evaluating(Box<TrackedPlay>),
    /// Stopping after an event that fails the trial.
    Stopping {
        reason: String,
    },
    Ended,
}

impl Run {
    /// A run of the trials that a journal leaves. The robot rests with straight joints.
    pub fn new(
        plan: &Plan,
        journal: &Journal,
        planner: Planner,
        gaits: BTreeMap<String, GaitOnRobot>,
        start: StartPose,
        stop: StopRules,
    ) -> Self {
        let attempts = journal.attempts();
        let left = journal
            .remaining(plan)
            .into_iter()
            .map(|trial| RemainingTrial {
                trial: trial.clone(),
                attempts: attempts.get(&trial.number).copied().unwrap_or(0),
                failures: journal.failures(trial.number),
            });
        Self {
            left: left.collect(),
            plan: plan.clone(),
            planner,
            gaits,
            start,
            stop,
            failures_in_a_row: journal.failures_in_a_row(),
            phase: Phase::Between,
            requests: VecDeque::new(),
            last_seen_s: None,
            ending: None,
            finished: 0,
        }
    }

    /// Takes an event.
    pub fn event(&mut self, event: Event) {
        match event {
            Event::Pose(pose) => self.pose(&pose),
            Event::Began(time_s) => self.began(time_s),
            Event::AtRest(time_s) => self.at_rest(time_s),
            Event::Evaluated(evaluated) => self.evaluated(*evaluated),
            Event::Interrupted(interruption) => self.interrupted(&interruption),
        }
    }

    /// The next request, if there is one. Call it after every event, and at least every 20 ms.
    pub fn poll(&mut self, now_s: f64) -> Option<Request> {
        if self.requests.is_empty() {
            self.act(now_s);
        }
        self.requests.pop_front()
    }

    /// Reason for the end. `None` while the run goes on, or has requests left.
    pub fn ending(&self) -> Option<&RunEnding> {
        self.ending.as_ref().filter(|_| self.requests.is_empty())
    }

    /// Trial under way, or the next one.
    pub fn trial(&self) -> Option<&Trial> {
        self.left.front().map(|left| &left.trial)
    }

    /// Trials that this run has finished.
    pub fn finished(&self) -> usize {
        self.finished
    }

    fn pose(&mut self, pose: &Pose) {
        if !pose.is_valid() {
            return;
        }
        let last = self.last_seen_s.unwrap_or(f64::NEG_INFINITY);
        self.last_seen_s = Some(pose.time_s.max(last));
        match &mut self.phase {
            Phase::Going(controller) => controller.pose(pose),
            Phase::Playing(playing) => playing.pose(pose),
            Phase::Between
            | Phase::Settling { .. }
            | Phase::Waiting
            | Phase::Evaluating(_)
            | Phase::Stopping { .. }
            | Phase::Ended => {}
        }
    }

    fn began(&mut self, time_s: f64) {
        match &mut self.phase {
            Phase::Going(controller) => controller.play_began(time_s),
            Phase::Waiting => {
                let Some(RemainingTrial { trial, .. }) = self.left.front() else {
                    return;
                };
                let (Some(gait), Some(planned)) =
                    (self.gaits.get(&trial.gait), self.plan.gait(trial))
                else {
                    return;
                };
                let (tank, margin_m) = self.planner.tank();
                let others = self.gaits.iter().filter(|(name, _)| **name != trial.gait);
                self.phase = Phase::Playing(Box::new(TrackedPlay::new(
                    self.planner.model(),
                    tank.map(|tank| TankWalls { tank, margin_m }),
                    gait.clone(),
                    others.map(|(name, other)| (name.as_str(), &other.course)),
                    time_s,
                    self.plan.run_in + planned.cycles,
                )));
            }
            _ => {}
        }
    }

    fn at_rest(&mut self, time_s: f64) {
        match std::mem::replace(&mut self.phase, Phase::Between) {
            Phase::Going(mut controller) => {
                controller.at_rest(time_s);
                self.phase = Phase::Going(controller);
            }
            Phase::Playing(mut playing) => {
                playing.at_rest();
                self.phase = Phase::Evaluating(playing);
            }
            Phase::Stopping { reason } => self.failed(&reason),
            phase => self.phase = phase,
        }
    }

    fn evaluated(&mut self, evaluated: Evaluated) {
        match &mut self.phase {
            Phase::Going(controller) => controller.evaluated(&evaluated),
            Phase::Playing(playing) | Phase::Evaluating(playing) => playing.evaluated(evaluated),
            Phase::Between
            | Phase::Settling { .. }
            | Phase::Waiting
            | Phase::Stopping { .. }
            | Phase::Ended => {}
        }
    }

    fn interrupted(&mut self, interruption: &Interruption) {
        if self.ending.is_some() {
            return;
        }
        let reason = match interruption {
            Interruption::Operator => {
                self.requests.clear();
                self.requests.push_back(Request::Stop);
                "the operator stopped".to_owned()
            }
            Interruption::Robot(reason) => format!("the robot stopped: {reason}"),
            Interruption::Link(reason) => format!("the link was lost: {reason}"),
        };
        self.end(RunEnding::Interrupted(reason));
    }

    fn end(&mut self, ending: RunEnding) {
        if matches!(
            self.phase,
            Phase::Waiting | Phase::Playing(_) | Phase::Evaluating(_) | Phase::Stopping { .. }
        ) {
            self.requests.push_back(Request::EndTrack);
        }
        self.requests.push_back(Request::Write(match &ending {
            RunEnding::Complete => Entry::Complete,
            RunEnding::Interrupted(reason) => Entry::Interrupted {
                reason: reason.clone(),
            },
        }));
        self.phase = Phase::Ended;
        self.ending = Some(ending);
    }

    /// Acts on the passage of time.
    fn act(&mut self, now_s: f64) {
        let age = self.last_seen_s.map(|last| now_s - last);
        let lost = age.filter(|age| *age > self.stop.lost_s);
        match &mut self.phase {
            Phase::Between => self.next_trial(now_s),
            Phase::Going(controller) => match controller.poll(now_s) {
                Some(Drive::Play(step)) => self.requests.push_back(Request::Drive(step)),
                Some(Drive::Stop) => self.requests.push_back(Request::Stop),
                Some(Drive::Evaluate(evaluation)) => {
                    self.requests.push_back(Request::Evaluate(evaluation));
                }
                None if controller.is_over() => {
                    let ending = controller.ending().cloned();
                    self.arrived(ending, now_s);
                }
                None => {}
            },
            Phase::Settling { until_s } => {
                if let Some(seconds) = lost {
                    self.lost(seconds);
                } else if now_s >= *until_s {
                    self.play();
                }
            }
            Phase::Evaluating(playing) => {
                let outstanding = std::iter::from_fn(|| playing.take_evaluation());
                self.requests
                    .extend(outstanding.map(|cycle| Request::Evaluate(Box::new(cycle))));
                if playing.is_evaluated() {
                    self.finish();
                }
            }
            Phase::Playing(playing) => {
                if let Some(evaluation) = playing.take_evaluation() {
                    self.requests
                        .push_back(Request::Evaluate(Box::new(evaluation)));
                }
                let departed = playing.reports().last().and_then(blocking);
                let reason = if playing.is_outside() {
                    "the robot came nearer to a wall than the margin".to_owned()
                } else if let Some(likeness) = departed {
                    format!("the robot departs from the prediction: {likeness}")
                } else if let Some(seconds) = lost {
                    self.requests.push_back(Request::Stop);
                    self.lost(seconds);
                    return;
                } else {
                    return;
                };
                self.phase = Phase::Stopping { reason };
                self.requests.push_back(Request::Stop);
            }
            Phase::Waiting | Phase::Stopping { .. } | Phase::Ended => {}
        }
    }

    fn lost(&mut self, seconds: f64) {
        let reason =
            format!("the robot was not seen for {seconds:.1} s; check the cameras, then run again");
        self.end(RunEnding::Interrupted(reason));
    }

    fn next_trial(&mut self, now_s: f64) {
        let Some(RemainingTrial {
            trial, attempts, ..
        }) = self.left.front_mut()
        else {
            self.end(RunEnding::Complete);
            return;
        };
        *attempts += 1;
        self.requests.push_back(Request::Write(Entry::Started {
            trial: trial.number,
            attempt: *attempts,
        }));
        let options = Options {
            within_m: self.start.within_m,
            within_rad: self.start.within_rad,
            ..Options::default()
        };
        let goal = Goal::Reach(vec![self.start.target()]);
        let controller = Controller::new(self.planner.clone(), goal, options, now_s);
        self.phase = Phase::Going(Box::new(controller));
    }

    fn arrived(&mut self, ending: Option<Ending>, now_s: f64) {
        match ending {
            Some(Ending::Reached) | None => {
                self.phase = Phase::Settling {
                    until_s: now_s + self.plan.settle_s,
                };
            }
            Some(other) => {
                let reason = format!("on the way to the start pose: {other}");
                self.end(RunEnding::Interrupted(reason));
            }
        }
    }

    fn play(&mut self) {
        let Some(RemainingTrial {
            trial, attempts, ..
        }) = self.left.front()
        else {
            return;
        };
        let Some(gait) = self.plan.gait(trial) else {
            return;
        };
        self.requests
            .push_back(Request::BeginTrack(track_name(trial, *attempts)));
        self.requests.push_back(Request::Play {
            gait: gait.name.clone(),
            cycles: self.plan.run_in + gait.cycles,
        });
        self.phase = Phase::Waiting;
    }

    /// A play is evaluated: the trial is finished if all counted cycles were measured.
    fn finish(&mut self) {
        let Phase::Evaluating(playing) = std::mem::replace(&mut self.phase, Phase::Between) else {
            return;
        };
        let departure = playing.reports().last().and_then(blocking);
        if let Some(likeness) = departure {
            self.failed(&format!(
                "the robot departs from the prediction: {likeness}"
            ));
            return;
        }
        let counted = playing.reports().iter().skip(self.plan.run_in as usize);
        let cycles: Option<Vec<MeasuredCycle>> = counted
            .map(|report| {
                report.measured.map(|motion| MeasuredCycle {
                    x_m: motion.x_m,
                    y_m: motion.y_m,
                    turn_rad: motion.turn_rad,
                    interval_m: motion.interval_m,
                })
            })
            .collect();
        let Some(cycles) = cycles.filter(|_| playing.is_whole()) else {
            self.failed("a start or an end of a counted cycle was not seen");
            return;
        };
        let Some(RemainingTrial {
            trial, attempts, ..
        }) = self.left.pop_front()
        else {
            return;
        };
        let departure = playing
            .reports()
            .iter()
            .rev()
            .find_map(|report| report.departure.as_ref())
            .map(|departure| departure.likeness.to_string());
        self.requests.push_back(Request::EndTrack);
        self.requests.push_back(Request::Write(Entry::Finished {
            trial: trial.number,
            attempt: attempts,
            track: track_name(&trial, attempts),
            began_s: playing.began_s(),
            cycles,
            departure,
        }));
        self.failures_in_a_row = 0;
        self.finished += 1;
        self.phase = Phase::Between;
    }

    /// The attempt failed: the trial is repeated, or given up.
    fn failed(&mut self, reason: &str) {
        self.requests.push_back(Request::EndTrack);
        self.failures_in_a_row += 1;
        self.phase = Phase::Between;
        if let Some(RemainingTrial {
            trial,
            attempts,
            failures,
        }) = self.left.front_mut()
        {
            *failures += 1;
            let number = trial.number;
            self.requests.push_back(Request::Write(Entry::Failed {
                trial: number,
                attempt: *attempts,
                reason: reason.to_owned(),
            }));
            if self.stop.gives_up_after(*failures) {
                self.left.pop_front();
                self.requests
                    .push_back(Request::Write(Entry::GivenUp { trial: number }));
            }
        }
        if self.failures_in_a_row >= self.stop.failures_in_a_row {
            let reason = format!(
                "{} attempts in a row failed, the last one because {reason}; look at the robot, then run again",
                self.failures_in_a_row
            );
            self.end(RunEnding::Interrupted(reason));
        }
    }
}

/// Departure that makes a trial invalid. Gains, drifts and another drag are results.
fn blocking(report: &CycleReport) -> Option<Likeness> {
    let departure = report.departure.as_ref()?;
    (!departure.likeness.is_correctable()).then(|| departure.likeness.clone())
}

/// Track file of an attempt.
fn track_name(trial: &Trial, attempt: u32) -> String {
    format!("tracks/{:04}-{}-{attempt}.csv", trial.number, trial.gait)
}
