//! `swimmer experiment run`: the trials that are left, one after the other.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use experiment::adaptive::{CampaignAdvice, Decision};
use experiment::unattended::{Entry, Journal, Plan, Request, Run, RunEnding};
use experiment::{Event, GaitOnRobot};
use forecast::{Planner, Played, PlaylistTable, Servos};
use gait_player::GaitTable;
use link_protocol::MAX_KNOTS;
use serde::Serialize;

use super::ExperimentPaths;
use super::adaptive::{Campaign, in_words, measure};
use super::folder::{DRIVE, Folder, JournalFile};
use crate::commands::plan::family_in;
use crate::commands::robot::{Access, Bench, Tracked, table_of};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};
use crate::progress::Progress;

/// Play the trials of a plan that are not finished yet, each from the start pose
///
/// For each trial the robot is driven to the start pose by what the cameras see, rests, and plays its gait; the cycles are measured and
/// the track is recorded. Every event is in the journal before the next begins, so this may be killed at any time: the same command goes
/// on, and repeats the trial that was under way. A low battery, an e-stop, a lost link or a lost track ends it with exit status 1; the
/// same command goes on. Ctrl-C stops the robot.
#[derive(Debug, clap::Args)]
pub(crate) struct RunPlan {
    #[command(flatten)]
    paths: ExperimentPaths,
    #[command(flatten)]
    access: Access,
    #[command(flatten)]
    tracked: Tracked,
}

/// Progress after a run.
#[derive(Debug, Serialize)]
pub(crate) struct RunOutput {
    folder: String,
    runs: usize,
    done: usize,
    given_up: usize,
    /// Trials that this run finished.
    finished_now: usize,
    duration_s: f64,
    /// Fit of an adaptive campaign.
    #[serde(skip_serializing_if = "Option::is_none")]
    adaptive: Option<CampaignAdvice>,
}

/// Gait ready to be played.
struct Playable {
    table: GaitTable,
    period_us: u32,
}

impl RunPlan {
    pub(super) fn run(self, output: Output) -> Outcome {
        let interrupt = Interrupt::install_with_a_robot()?;
        let (paths, access, tracked) = (&self.paths, &self.access, &self.tracked);
        output.print(&play(paths, access, tracked, interrupt)?);
        Ok(())
    }
}

/// Plays the trials that are left.
///
/// # Errors
/// A low battery, an e-stop, a lost link or track, an interrupt: the same call goes on.
pub(crate) fn play(
    paths: &ExperimentPaths,
    access: &Access,
    tracked: &Tracked,
    interrupt: Interrupt,
) -> Outcome<RunOutput> {
    let mut folder = Folder::of(paths)?;
    let (mut file, mut journal) = JournalFile::open(&folder)?;
    let campaign = Campaign::of(&folder)?;
    if let Some(campaign) = &campaign {
        measure(&folder, &mut file, &journal, tracked)?;
        journal = choose(&mut folder, &mut file, campaign)?;
    }
    let left = journal.remaining(&folder.plan).len();
    if left == 0 {
        return done(&folder, &journal, 0, 0.0);
    }
    let number = opened(&journal) + 1;
    let log = format!("logs/run-{number}.mcap");
    let log_path = folder.path.join(&log);
    // A log of this number may be left from a run that was killed before its first line.
    let _ = std::fs::remove_file(&log_path);
    let access = access.logging_to(log_path);
    let seed = folder.plan.seed.wrapping_add(number);
    let (command, cameras) = ("swimmer experiment run", tracked.cameras());
    let swimmer = &folder.swimmer;
    let mut bench = Bench::open(&access, command, cameras, swimmer, seed, interrupt)?;
    let servos = *bench.servos();
    let (gaits, playable) = gaits(&folder, &servos)?;
    let planner = planner(&folder, servos)?;
    file.append(&Entry::Opened {
        plan: folder.plan.sha256(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        log: Some(log),
    })?;
    journal = folder.journal()?;
    let began = bench.now_s();
    let mut finished = 0;
    let ending = loop {
        let mut executor = Executor {
            folder: &folder,
            file: &mut file,
            bench: &mut bench,
            planner: &planner,
            playable: &playable,
            is_adaptive: campaign.is_some(),
        };
        let (ending, finished_now) = executor.run(&journal, gaits.clone())?;
        finished += finished_now;
        let Some(campaign) = campaign.as_ref().filter(|_| ending == RunEnding::Complete) else {
            break ending;
        };
        journal = folder.journal()?;
        measure(&folder, &mut file, &journal, tracked)?;
        journal = choose(&mut folder, &mut file, campaign)?;
        if journal.remaining(&folder.plan).is_empty() {
            file.append(&Entry::Complete)?;
            break ending;
        }
    };
    let duration = bench.now_s() - began;
    let closed = bench.close();
    let journal = folder.journal()?;
    match ending {
        RunEnding::Complete => closed.and_then(|()| done(&folder, &journal, finished, duration)),
        RunEnding::Interrupted(reason) => {
            let left = match &campaign {
                Some(_) => "the campaign is not at its goal".to_owned(),
                None => format!("{} are left", journal.remaining(&folder.plan).len()),
            };
            Err(Failure::Tried(format!(
                "{reason}; {finished} trials were finished, {left}: the same command goes on"
            )))
        }
    }
}

/// Chooses the next trial of an adaptive campaign, unless one is left or the campaign has ended. Returns the journal with it.
fn choose(folder: &mut Folder, file: &mut JournalFile, campaign: &Campaign) -> Outcome<Journal> {
    let mut journal = folder.journal()?;
    if journal.remaining(&folder.plan).is_empty() {
        let advice = campaign.advice(folder, &journal)?;
        aside(&in_words(&advice));
        if let Decision::Play(next) = advice.decision {
            let last = folder.plan.trials.last().map_or(0, |trial| trial.number);
            file.append(&Entry::Chosen {
                trial: last + 1,
                gait: next.gait,
            })?;
            journal = folder.journal()?;
        }
    }
    folder.plan = folder.plan.with_chosen(&journal);
    Ok(journal)
}

/// Executor of requests.
struct Executor<'a> {
    folder: &'a Folder,
    file: &'a mut JournalFile,
    bench: &'a mut Bench,
    planner: &'a Planner,
    playable: &'a BTreeMap<String, Playable>,
    /// Trials are chosen one by one: the end of those that are chosen is not the end of the campaign.
    is_adaptive: bool,
}

impl Executor<'_> {
    /// Runs the trials that are left. Returns the ending, and the trials that were finished.
    fn run(
        &mut self,
        journal: &Journal,
        gaits: BTreeMap<String, GaitOnRobot>,
    ) -> Outcome<(RunEnding, usize)> {
        let (plan, spec) = (&self.folder.plan, &self.folder.spec);
        let left = journal.remaining(plan).len();
        let planner = self.planner.clone();
        let mut run = Run::new(plan, journal, planner, gaits, spec.start, spec.stop);
        let progress = Progress::of_steps(left as u64);
        loop {
            for event in self.bench.advance()? {
                run.event(event);
            }
            while let Some(request) = run.poll(self.bench.now_s()) {
                if let Some(event) = self.execute(request)? {
                    run.event(event);
                }
            }
            if let Some(trial) = run.trial() {
                progress.doing(format!("trial {}, {}", trial.number, trial.gait));
            }
            progress.at(run.finished() as u64);
            if let Some(ending) = run.ending() {
                return Ok((ending.clone(), run.finished()));
            }
        }
    }

    fn execute(&mut self, request: Request) -> Outcome<Option<Event>> {
        match request {
            Request::Write(Entry::Complete) if self.is_adaptive => {}
            Request::Write(entry) => self.file.append(&entry)?,
            Request::BeginTrack(name) => {
                let path: PathBuf = self.folder.path.join(name);
                self.bench.begin_track(&path)?;
            }
            Request::EndTrack => self.bench.end_track()?,
            Request::Stop => return Ok(self.bench.stop()),
            Request::Evaluate(evaluation) => self.bench.evaluate(evaluation)?,
            Request::Drive(step) => {
                let table = self.planner.checked_table(&step);
                let table = table.map_err(|error| Failure::tried(&error))?;
                return Ok(self.bench.play(step.member.word(false), &table));
            }
            Request::Play { gait, cycles } => {
                let Some(playable) = self.playable.get(&gait) else {
                    return Err(Failure::BadInput(format!("the plan has no gait `{gait}`")));
                };
                let table = PlaylistTable {
                    table: playable.table.clone(),
                    cycles,
                    period_us: playable.period_us,
                    step: 0,
                };
                return Ok(self.bench.play(&gait, &table));
            }
        }
        Ok(None)
    }
}

/// Runs that a journal has seen.
fn opened(journal: &Journal) -> u64 {
    let is_opened = |entry: &Entry| matches!(entry, Entry::Opened { .. });
    let opened = journal
        .records
        .iter()
        .filter(|record| is_opened(&record.entry));
    opened.count() as u64
}

fn done(
    folder: &Folder,
    journal: &Journal,
    finished_now: usize,
    duration_s: f64,
) -> Outcome<RunOutput> {
    let campaign = Campaign::of(folder)?;
    Ok(RunOutput {
        folder: folder.path.display().to_string(),
        runs: folder.plan.trials.len(),
        done: journal.finished().len(),
        given_up: journal.given_up().len(),
        finished_now,
        duration_s,
        adaptive: campaign
            .map(|campaign| campaign.advice(folder, journal))
            .transpose()?,
    })
}

fn gaits(
    folder: &Folder,
    servos: &Servos,
) -> Outcome<(BTreeMap<String, GaitOnRobot>, BTreeMap<String, Playable>)> {
    let model = crate::arguments::model(&folder.swimmer)?;
    let Plan { gaits, .. } = &folder.plan;
    let (mut courses, mut playable) = (BTreeMap::new(), BTreeMap::new());
    for gait in gaits {
        let curve = folder.curve(gait)?;
        let table = table_of(&curve).map_err(|error| Failure::tried(&error))?;
        let played = Played {
            servos: *servos,
            period: gait.period_s,
            knots: MAX_KNOTS,
        };
        let period_us = played.period_us();
        let cycles = folder.plan.run_in + gait.cycles;
        let on_robot = GaitOnRobot::new(&model, &table, period_us, servos, cycles);
        courses.insert(gait.name.clone(), on_robot);
        playable.insert(gait.name.clone(), Playable { table, period_us });
    }
    Ok((courses, playable))
}

fn planner(folder: &Folder, servos: Servos) -> Outcome<Planner> {
    let model = crate::arguments::model(&folder.swimmer)?;
    let rates = [servos.file.max_rate; 2];
    let family = family_in(&folder.path.join(DRIVE), rates)?;
    let (tank, margin) = (folder.spec.tank, folder.spec.margin_m);
    let planner = Planner::new(model, family, servos, Some(tank), margin);
    planner.map_err(|error| Failure::tried(&error))
}

impl fmt::Display for RunOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} trials are finished in {}",
            self.done, self.runs, self.folder
        )?;
        if self.given_up > 0 {
            write!(f, ", {} were given up", self.given_up)?;
        }
        write!(
            f,
            "; {} of them now, in {:.2} h of tank time.",
            self.finished_now,
            self.duration_s / 3600.0
        )?;
        match &self.adaptive {
            Some(advice) => write!(f, "\n{}", in_words(advice)),
            None => Ok(()),
        }
    }
}
