//! `swimmer robot play --track`: a play under the monitor, each cycle against its prediction.

use std::{fmt, iter};

use experiment::{Evaluated, Event, GaitOnRobot, Interruption, TankWalls, TrackedPlay};
use forecast::PlaylistTable;
use serde::Serialize;

use super::Play;
use super::access::Access;
use super::bench::Bench;
use super::motion::Played;
use super::outputs::print_refusal;
use super::playing;
use super::tracked_report::{MonitorLine, TrackedMotion, cycle_lines};
use super::tracking::CamerasOf;
use super::upload::BeforePlay;
use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{CTRL_C, Interrupt};
use crate::output::{Output, aside};

/// Seed of a fresh virtual robot.
const SEED: u64 = 1;
/// A robot that is not seen for longer is stopped \[s\].
pub(super) const LONGEST_BLANK_S: f64 = 5.0;
/// Distance from the walls of `--tank` at which the robot is stopped \[m\].
pub(super) const MARGIN_M: f64 = 0.01;

/// Reason of a stop at a wall.
pub(super) const NEAR_WALL: &str = "the robot came nearer to a wall than 10 mm";

/// Reason of a stop after a blank of so many seconds.
pub(super) fn not_seen(seconds: f64) -> String {
    format!("the robot was not seen for {seconds:.1} s; check the cameras")
}

/// Plays a gait, and compares each tracked cycle with its prediction.
pub(super) fn play(
    access: &Access,
    play: &Play,
    cameras: CamerasOf<'_>,
    interrupt: &Interrupt,
    output: Output,
) -> Outcome {
    let Some(gait) = &play.gait else {
        return Err(Failure::BadInput(
            "--track compares with the prediction for a gait: name it by --gait".to_owned(),
        ));
    };
    let upload = BeforePlay::new(gait, &play.owner)?;
    if upload.has_passive_joint() {
        return Err(Failure::BadInput(
            "--track compares with the prediction for two servos, and this gait leaves a joint to a spring; play it without --track"
                .to_owned(),
        ));
    }
    let named = play.owner.swimmer.as_deref();
    let file = load_swimmer(named.unwrap_or("robot"))?;
    let command = "swimmer robot play --track";
    let mut bench = Bench::open(access, command, cameras, &file, SEED, interrupt.clone())?;
    upload.check(&bench.configuration()?)?;
    let (name, table) = upload.table();
    let table = PlaylistTable {
        table: table.clone(),
        cycles: play.cycles.unwrap_or(0),
        period_us: microseconds(play.period),
        step: 0,
    };
    let cycles = play.cycles.unwrap_or(u32::MAX);
    let (model, servos) = (bench.model(), bench.servos());
    let mut monitored = Monitored {
        gait: GaitOnRobot::new(model, &table.table, table.period_us, servos, cycles),
        cycles,
        walls: play.room.tank.map(|tank| TankWalls {
            tank,
            margin_m: MARGIN_M,
        }),
        play: None,
        shown: 0,
        reason: None,
        output,
    };
    if let Some(event) = bench.play(name, &table) {
        return Err(Failure::Tried(interrupted(&event)));
    }
    output.line(&playing::announcement(play.cycles, play.period));
    monitored.run(&mut bench)?;
    let status = bench.status()?;
    let result = TrackedOutput {
        played: Played::new(&status, false),
        tracked: monitored
            .play
            .as_ref()
            .map_or_else(TrackedMotion::default, |play| {
                TrackedMotion::of(play, bench.camera_delay_s())
            }),
    };
    bench.close()?;
    match monitored.reason {
        None => {}
        Some(Reason::Operator) if status.cycles == 0 && interrupt.pressed() == CTRL_C => {}
        Some(reason) => {
            let cycles = status.cycle;
            return print_refusal(output, &result, reason.after(cycles, interrupt));
        }
    }
    output.print(&result);
    Ok(())
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a period of the command line: positive, minutes
fn microseconds(seconds: f64) -> u32 {
    (seconds * 1e6).round() as u32
}

/// Reason for the end of a play before its last cycle.
enum Reason {
    Operator,
    Wall,
    Lost(f64),
    Robot(String),
}

impl Reason {
    fn after(&self, cycles: u32, interrupt: &Interrupt) -> String {
        let why = match self {
            Self::Operator if interrupt.requested() => interrupt.pressed().to_owned(),
            Self::Operator => "another process stopped it".to_owned(),
            Self::Wall => NEAR_WALL.to_owned(),
            Self::Lost(seconds) => not_seen(*seconds),
            Self::Robot(reason) => reason.clone(),
        };
        format!("{why}: the robot was stopped after {cycles} whole cycles")
    }
}

fn interrupted(event: &Event) -> String {
    match event {
        Event::Interrupted(Interruption::Robot(reason) | Interruption::Link(reason)) => {
            reason.clone()
        }
        _ => "the play was interrupted".to_owned(),
    }
}

/// A play and what was reported of it.
struct Monitored {
    gait: GaitOnRobot,
    cycles: u32,
    walls: Option<TankWalls>,
    play: Option<TrackedPlay>,
    /// Cycles whose report was printed.
    shown: usize,
    reason: Option<Reason>,
    output: Output,
}

impl Monitored {
    /// Waits for the end of the play; stops the robot if it is lost, comes too near to a wall, or if the operator stops.
    fn run(&mut self, bench: &mut Bench) -> Outcome {
        let begun_s = bench.now_s();
        let mut is_at_rest = false;
        while !(is_at_rest && self.is_evaluated()) {
            for event in bench.advance()? {
                match event {
                    Event::Evaluated(evaluated) => self.evaluated(*evaluated),
                    Event::Pose(pose) => {
                        if let Some(play) = &mut self.play {
                            play.pose(&pose);
                        }
                    }
                    Event::Began(began_s) => {
                        self.play = Some(TrackedPlay::new(
                            bench.model(),
                            self.walls,
                            self.gait.clone(),
                            std::iter::empty(),
                            began_s,
                            self.cycles,
                        ));
                    }
                    Event::AtRest(_) => {
                        if let Some(play) = self.play.as_mut().filter(|_| self.reason.is_none()) {
                            play.at_rest();
                        }
                        is_at_rest = true;
                    }
                    Event::Interrupted(Interruption::Operator) => {
                        self.stop(bench, Reason::Operator)?;
                    }
                    Event::Interrupted(
                        Interruption::Robot(reason) | Interruption::Link(reason),
                    ) => {
                        self.reason.get_or_insert(Reason::Robot(reason));
                        self.pass_evaluations(bench)?;
                        for event in bench.remaining_evaluations()? {
                            if let Event::Evaluated(evaluated) = event {
                                self.evaluated(*evaluated);
                            }
                        }
                        return Ok(());
                    }
                }
            }
            let now_s = bench.now_s();
            self.pass_evaluations(bench)?;
            let Some(play) = self.play.as_ref().filter(|_| !is_at_rest) else {
                continue;
            };
            let blank_s = now_s - play.last_seen_s().unwrap_or(begun_s);
            if play.is_outside() {
                self.stop(bench, Reason::Wall)?;
            } else if blank_s > LONGEST_BLANK_S {
                self.stop(bench, Reason::Lost(blank_s))?;
            }
        }
        Ok(())
    }

    fn is_evaluated(&self) -> bool {
        self.play.as_ref().is_none_or(TrackedPlay::is_evaluated)
    }

    /// Has the cycles evaluated that have ended.
    fn pass_evaluations(&mut self, bench: &mut Bench) -> Outcome {
        let cycles = self.play.iter_mut();
        for evaluation in cycles.flat_map(|play| iter::from_fn(|| play.take_evaluation())) {
            bench.evaluate(Box::new(evaluation))?;
        }
        Ok(())
    }

    /// Takes the report of a cycle, and prints it.
    fn evaluated(&mut self, evaluated: Evaluated) {
        if let Some(play) = &mut self.play {
            play.evaluated(evaluated);
            self.show();
        }
    }

    /// Stops the robot once.
    fn stop(&mut self, bench: &mut Bench, reason: Reason) -> Outcome {
        if self.reason.is_some() {
            return Ok(());
        }
        self.reason = Some(reason);
        match bench.stop() {
            Some(event) => Err(Failure::Tried(interrupted(&event))),
            None => Ok(()),
        }
    }

    /// Prints the cycles that were evaluated since, and departures when they are found.
    fn show(&mut self) {
        let Some(play) = &self.play else { return };
        for MonitorLine { text, warns } in cycle_lines(play.reports(), self.shown) {
            if warns {
                aside(&format!("warning: {text}."));
            } else {
                self.output.line(&text);
            }
        }
        self.shown = play.reports().len();
    }
}

/// Result of a tracked play.
#[derive(Debug, Serialize)]
struct TrackedOutput {
    #[serde(flatten)]
    played: Played,
    tracked: TrackedMotion,
}

impl fmt::Display for TrackedOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n{}", self.played, self.tracked)?;
        for departure in &self.tracked.departures {
            write!(f, "\n  note: {departure}")?;
        }
        Ok(())
    }
}
