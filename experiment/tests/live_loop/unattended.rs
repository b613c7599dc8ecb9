//! The unattended experiment: resumed after any cut of its journal, and honest about equal gaits.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::virtual_lab::{model, planner, servos};
use experiment::unattended::{
    Entry, Journal, Measure, MeasuredCycle, Plan, PlannedGait, Request, Run, RunEnding, StartPose,
    StopRules, compare, randomised,
};
use experiment::{Course, Evaluation, Event, GaitOnRobot, Interruption, Pose};
use forecast::playlist::PlaylistTable;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::AnyGait;

const START: StartPose = StartPose {
    x_m: 0.0,
    y_m: 0.0,
    heading_rad: 0.0,
    within_m: 0.01,
    within_rad: 0.035,
};
const STOP: StopRules = StopRules {
    attempts: 2,
    failures_in_a_row: 3,
    lost_s: 2.0,
};
const PERIOD_S: f64 = 8.0;

fn circle(degrees: f64) -> (PlannedGait, GaitOnRobot) {
    let gait = AnyGait::circle(degrees.to_radians());
    let table = forecast::table(&gait, 512).unwrap();
    let course = Course::of_cycle(&model(), &table, 8_000_000, &servos());
    let net = course.net();
    let planned = PlannedGait {
        name: format!("circle-{degrees}"),
        file: format!("gaits/circle-{degrees}.gait"),
        period_s: PERIOD_S,
        cycles: 1,
        predicted_xy_m: [net.x, net.y],
        predicted_turn_rad: net.theta,
        measure: Measure::Displacement,
        neighbour_of: None,
        size: 1.0,
    };
    let on_robot = GaitOnRobot::steady(course, PERIOD_S);
    (planned, on_robot)
}

fn plan(gaits: Vec<PlannedGait>, repeats: u32) -> Plan {
    let names: Vec<String> = gaits.iter().map(|gait| gait.name.clone()).collect();
    Plan {
        spec_sha256: String::new(),
        seed: 5,
        repeats,
        run_in: 1,
        settle_s: 1.0,
        level: 0.95,
        trials: randomised(&names, repeats, 5),
        gaits,
        left_out: Vec::new(),
        adaptive: None,
    }
}

/// A robot that does what the model predicts, under cameras with 20 frames a second. It keeps the journal.
struct Bench {
    now: f64,
    pose: swimmer_model::Pose<f64>,
    journal: Vec<u8>,
    /// Play under way with its start and its cycles.
    play: Option<(Course, f64, u32)>,
    rng: ChaCha8Rng,
    track: Option<String>,
    tracks: BTreeSet<String>,
    /// No frames from then on.
    dark_from: f64,
    /// Time that the evaluation of a cycle takes \[s\].
    evaluation_s: f64,
    /// Evaluations under way, with the times of their results.
    evaluations: VecDeque<(f64, Evaluation)>,
    /// The robot reports this once, at this time.
    interruption: Option<(f64, Interruption)>,
    stopped: bool,
}

impl Bench {
    fn new(journal: &[u8]) -> Self {
        Self {
            now: 0.0,
            pose: swimmer_model::Pose::new(0.05, 0.02, 0.2),
            journal: journal.to_vec(),
            play: None,
            rng: ChaCha8Rng::seed_from_u64(9),
            track: None,
            tracks: BTreeSet::new(),
            dark_from: f64::INFINITY,
            evaluation_s: 0.0,
            evaluations: VecDeque::new(),
            interruption: None,
            stopped: false,
        }
    }

    fn execute(&mut self, request: Request, gaits: &BTreeMap<String, GaitOnRobot>) -> Option<f64> {
        match request {
            Request::Write(entry) => {
                if let Entry::Finished { track, .. } = &entry {
                    assert!(self.tracks.contains(track), "a finished trial has its data");
                }
                self.journal.extend(Journal::line(self.now, &entry));
            }
            Request::Drive(step) => {
                let planner = planner();
                let table: PlaylistTable = planner.checked_table(&step).unwrap();
                let rest = nalgebra::Vector2::zeros();
                let course = Course::of_play(&model(), &table, &servos(), rest);
                self.play = Some((course, self.now, 1));
                return Some(self.now);
            }
            Request::Play { gait, cycles } => {
                self.play = Some((gaits[&gait].course.clone(), self.now, cycles));
                return Some(self.now);
            }
            Request::BeginTrack(name) => self.track = Some(name),
            Request::EndTrack => self.tracks.extend(self.track.take()),
            Request::Stop => self.stopped = true,
            Request::Evaluate(evaluation) => {
                let begins = self.evaluations.back().map_or(self.now, |(due, _)| *due);
                let due = begins.max(self.now) + self.evaluation_s;
                self.evaluations.push_back((due, *evaluation));
            }
        }
        None
    }

    /// Lives for 50 ms; returns the pose that the cameras see, and the time of rest if a play ends.
    fn advance(&mut self) -> (Pose, Option<f64>) {
        self.now += 0.05;
        let mut rest = None;
        let mut seen = self.pose;
        if let Some((course, began, cycles)) = &self.play {
            let (period, time) = (course.duration_s(), self.now - began);
            let done = (time / period).floor().min(f64::from(*cycles));
            let mut pose = self.pose;
            let mut cycle = 0.0;
            while cycle < done {
                pose = pose * course.net();
                cycle += 1.0;
            }
            if time >= period * f64::from(*cycles) {
                self.pose = pose;
                self.play = None;
                rest = Some(self.now);
                seen = pose;
            } else {
                seen = pose * course.at(time - done * period);
            }
        }
        let [x, y, heading]: [f64; 3] =
            std::array::from_fn(|_| StandardNormal.sample(&mut self.rng));
        let pose = Pose {
            time_s: self.now,
            x_m: seen.x + 1e-4 * x,
            y_m: seen.y + 1e-4 * y,
            heading_rad: swimmer_model::wrapped_angle(seen.theta + 1e-3 * heading),
            sigma_position_m: 1e-4,
            sigma_heading_rad: 1e-3,
        };
        (pose, rest)
    }

    /// Runs what the journal leaves; returns the ending.
    fn run(&mut self, plan: &Plan, gaits: &BTreeMap<String, GaitOnRobot>) -> RunEnding {
        let journal = Journal::parse(&self.journal).unwrap();
        self.journal.truncate(journal.valid_bytes);
        journal.check(plan).unwrap();
        let mut run = Run::new(plan, &journal, planner(), gaits.clone(), START, STOP);
        while self.now < 20_000.0 {
            let (pose, rest) = self.advance();
            if self.now < self.dark_from {
                run.event(Event::Pose(pose));
            }
            if let Some(time) = rest {
                run.event(Event::AtRest(time));
            }
            while let Some((_, cycle)) = self.evaluations.pop_front_if(|(due, _)| *due <= self.now)
            {
                run.event(Event::Evaluated(Box::new(cycle.run())));
            }
            if self
                .interruption
                .as_ref()
                .is_some_and(|(at, _)| self.now >= *at)
            {
                let (_, interruption) = self.interruption.take().unwrap();
                run.event(Event::Interrupted(interruption));
            }
            while let Some(request) = run.poll(self.now) {
                if let Some(began) = self.execute(request, gaits) {
                    run.event(Event::Began(began));
                }
            }
            if let Some(ending) = run.ending() {
                return ending.clone();
            }
        }
        panic!("the run does not end");
    }
}

fn two_circles() -> (Plan, BTreeMap<String, GaitOnRobot>) {
    let (planned, on_robot): (Vec<_>, Vec<_>) = [50.0, 70.0].map(circle).into_iter().unzip();
    let names: Vec<String> = planned.iter().map(|gait| gait.name.clone()).collect();
    (plan(planned, 2), names.into_iter().zip(on_robot).collect())
}

/// Every finished trial of a journal, as often as it occurs.
fn finished(bytes: &[u8]) -> Vec<u32> {
    let journal = Journal::parse(bytes).unwrap();
    let numbers = journal
        .records
        .iter()
        .filter_map(|record| match record.entry {
            Entry::Finished { trial, .. } => Some(trial),
            _ => None,
        });
    numbers.collect()
}

#[test]
fn a_run_finishes_every_trial_as_predicted() {
    let (plan, gaits) = two_circles();
    let mut bench = Bench::new(&[]);
    assert_eq!(bench.run(&plan, &gaits), RunEnding::Complete);
    assert_eq!(finished(&bench.journal), [1, 2, 3, 4]);
    let journal = Journal::parse(&bench.journal).unwrap();
    for gait in compare(&plan, &journal).gaits {
        let (measured, half) = (gait.measured_m.unwrap(), gait.interval_m.unwrap());
        println!(
            "{}: {measured} ± {half} m, predicted {}",
            gait.gait, gait.predicted_m
        );
        assert!((measured - gait.predicted_m).abs() < 2e-4, "{gait:?}");
        assert_eq!(gait.runs, 2);
    }
}

/// Evaluations that take longer than a cycle delay the next trial, and change nothing that is measured.
#[test]
fn slow_evaluations_change_no_result() {
    let (plan, gaits) = two_circles();
    let mut bench = Bench::new(&[]);
    bench.evaluation_s = 1.3 * PERIOD_S;
    assert_eq!(bench.run(&plan, &gaits), RunEnding::Complete);
    assert!(bench.evaluations.is_empty(), "all results were waited for");
    let compared = |bytes: &[u8]| compare(&plan, &Journal::parse(bytes).unwrap());
    for (slow, quick) in compared(&bench.journal)
        .gaits
        .iter()
        .zip(compared(whole_journal()).gaits)
    {
        let (slow, quick) = (slow.measured_m.unwrap(), quick.measured_m.unwrap());
        assert!((slow - quick).abs() < 1e-4, "{slow} {quick}");
    }
}

/// A complete journal of four trials, made once.
fn whole_journal() -> &'static [u8] {
    static WHOLE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    WHOLE.get_or_init(|| {
        let (plan, gaits) = two_circles();
        let mut bench = Bench::new(&[]);
        bench.run(&plan, &gaits);
        bench.journal
    })
}

/// For every byte at which a crash may cut the journal: the finished trials are those whose line is whole, and the rest is left.
#[test]
fn any_cut_keeps_the_trials_that_were_finished() {
    let (plan, _) = two_circles();
    let whole = whole_journal();
    for cut in 0..=whole.len() {
        let bytes = &whole[..cut];
        let ends = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        let lines = String::from_utf8(bytes[..ends].to_vec()).unwrap();
        let expected = lines
            .lines()
            .filter(|line| line.contains("\"finished\""))
            .count();
        let journal = Journal::parse(bytes).unwrap();
        assert_eq!(
            (journal.valid_bytes, journal.finished().len()),
            (ends, expected),
            "cut at {cut}"
        );
        assert_eq!(journal.remaining(&plan).len(), 4 - expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// A run that is killed up to three times, at any byte, finishes the same trials as one that is not, each once.
    #[test]
    fn a_run_goes_on_after_any_cut(cuts in proptest::collection::vec(0..=1000_usize, 1..4)) {
        let (plan, gaits) = two_circles();
        let mut kept = whole_journal().to_vec();
        for cut in cuts {
            let length = kept.len() * cut / 1000;
            let mut bench = Bench::new(&kept[..length]);
            let before = finished(&kept[..Journal::parse(&kept[..length]).unwrap().valid_bytes]);
            prop_assert_eq!(bench.run(&plan, &gaits), RunEnding::Complete);
            let after = finished(&bench.journal);
            prop_assert!(after.starts_with(&before), "{:?} {:?}", before, after);
            prop_assert_eq!(&after, &[1, 2, 3, 4]);
            kept = bench.journal;
        }
    }
}

#[test]
fn interruptions_leave_a_journal_that_goes_on() {
    let (plan, gaits) = two_circles();
    let cases = [
        Interruption::Operator,
        Interruption::Robot("the battery is low".to_owned()),
        Interruption::Link("no reply for 2 s".to_owned()),
    ];
    for (number, interruption) in cases.into_iter().enumerate() {
        let mut bench = Bench::new(&[]);
        bench.interruption = Some((20.0 + 15.0 * number as f64, interruption.clone()));
        let ending = bench.run(&plan, &gaits);
        assert!(matches!(&ending, RunEnding::Interrupted(_)), "{ending:?}");
        assert_eq!(bench.stopped, interruption == Interruption::Operator);
        let mut again = Bench::new(&bench.journal);
        assert_eq!(again.run(&plan, &gaits), RunEnding::Complete);
        assert_eq!(finished(&again.journal), [1, 2, 3, 4]);
    }
}

#[test]
fn a_lost_track_stops_the_robot_and_ends_the_run() {
    let (plan, gaits) = two_circles();
    // During a drive, at rest, and during plays.
    for dark_from in [1.0, 8.0, 15.0, 22.0, 29.0, 36.0, 43.0] {
        let mut bench = Bench::new(&[]);
        bench.dark_from = dark_from;
        let ending = bench.run(&plan, &gaits);
        let RunEnding::Interrupted(reason) = ending else {
            panic!("complete without cameras");
        };
        assert!(reason.contains("not seen"), "{reason}");
        assert!(bench.now - dark_from < 20.0, "{} {dark_from}", bench.now);
        let mut again = Bench::new(&bench.journal);
        assert_eq!(again.run(&plan, &gaits), RunEnding::Complete);
    }
}

/// A journal of simulated trials: the displacement of each is its gait's, plus its block's, plus noise.
fn simulated(plan: &Plan, displacement: impl Fn(&str) -> f64, seed: u64) -> Journal {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = |sigma: f64| -> f64 {
        let number: f64 = StandardNormal.sample(&mut rng);
        sigma * number
    };
    let blocks: Vec<f64> = (0..plan.repeats).map(|_| normal(4e-4)).collect();
    let mut bytes = Vec::new();
    for trial in &plan.trials {
        let x = displacement(&trial.gait) + blocks[trial.block as usize - 1] + normal(2e-4);
        let cycle = MeasuredCycle {
            x_m: x,
            y_m: normal(2e-4),
            turn_rad: 0.0,
            interval_m: 1e-4,
        };
        let entry = Entry::Finished {
            trial: trial.number,
            attempt: 1,
            track: String::new(),
            began_s: 0.0,
            cycles: vec![cycle],
            departure: None,
        };
        bytes.extend(Journal::line(0.0, &entry));
    }
    Journal::parse(&bytes).unwrap()
}

/// Three optima with two neighbours each, and five circles: the experiment of the example.
fn example_plan() -> Plan {
    let gait = |name: &str, neighbour_of: Option<&str>| PlannedGait {
        name: name.to_owned(),
        file: String::new(),
        period_s: 12.0,
        cycles: 3,
        predicted_xy_m: [0.02, 0.0],
        predicted_turn_rad: 0.0,
        measure: Measure::Displacement,
        neighbour_of: neighbour_of.map(str::to_owned),
        size: 1.0,
    };
    let mut gaits = Vec::new();
    for optimum in ["a", "b", "fastest"] {
        gaits.push(gait(optimum, None));
        for size in ["-10", "+10"] {
            gaits.push(gait(&format!("{optimum}{size}"), Some(optimum)));
        }
    }
    gaits.extend(
        (50..=90)
            .step_by(10)
            .map(|degrees| gait(&format!("circle-{degrees}"), None)),
    );
    plan(gaits, 5)
}

/// Share of experiments of equal gaits in which any optimum is shown to be better, and share of intervals that cover the truth.
fn false_better(experiments: u64, first_seed: u64) -> (f64, f64) {
    let plan = example_plan();
    let (mut wrong, mut covered, mut intervals) = (0.0, 0.0, 0.0);
    for seed in 0..experiments {
        let result = compare(&plan, &simulated(&plan, |_| 0.02, first_seed + seed));
        wrong += f64::from(u8::from(result.comparisons.iter().any(|one| one.shown)));
        for gait in &result.gaits {
            let off = (gait.measured_m.unwrap() - 0.02).abs();
            covered += f64::from(u8::from(off <= gait.interval_m.unwrap()));
            intervals += 1.0;
        }
    }
    (wrong / experiments as f64, covered / intervals)
}

#[test]
fn equal_gaits_are_seldom_called_better() {
    let (wrong, covered) = false_better(200, 0);
    println!(
        "200 experiments of equal gaits: false \"better\" in {:.1} %, intervals cover in {:.1} %",
        100.0 * wrong,
        100.0 * covered
    );
    assert!((0.02..=0.08).contains(&wrong), "{wrong}");
    assert!((0.93..=0.97).contains(&covered), "{covered}");
}

/// The rate itself, with twenty times as many experiments.
#[test]
#[ignore = "soak: the rate within a quarter of a per cent"]
fn the_rate_of_false_better_is_that_of_the_level() {
    let (wrong, covered) = false_better(4000, 1_000_000);
    println!(
        "4000 experiments: {:.2} % false, {:.2} % covered",
        100.0 * wrong,
        100.0 * covered
    );
    assert!((0.03..=0.06).contains(&wrong), "{wrong}");
}

#[test]
fn a_better_optimum_is_shown() {
    let plan = example_plan();
    let is_optimum = |name: &str| ["a", "b", "fastest"].contains(&name);
    let truth = |name: &str| if is_optimum(name) { 0.0215 } else { 0.02 };
    let result = compare(&plan, &simulated(&plan, truth, 3));
    assert_eq!(result.comparisons.len(), 6);
    for one in &result.comparisons {
        assert!(one.shown, "{one:?}");
        assert!((one.difference_m.unwrap() - 0.0015).abs() < 4e-4, "{one:?}");
        assert!(one.p.unwrap() >= one.p_alone.unwrap());
    }
    // Half of a trial's data missing: fewer blocks, still a p-value; none at all: no value.
    let mut journal = simulated(&plan, truth, 3);
    journal.records.retain(|record| match &record.entry {
        Entry::Finished { trial, .. } => plan.trial(*trial).unwrap().gait != "a-10",
        _ => true,
    });
    let result = compare(&plan, &journal);
    let missing = result
        .comparisons
        .iter()
        .find(|one| one.than == "a-10")
        .unwrap();
    assert_eq!((missing.p, missing.shown, missing.blocks), (None, false, 0));
}

/// The order depends on the seed alone, and another seed gives another order.
#[test]
fn a_plan_is_a_fixed_point_of_its_seed() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..50 {
        let seed: u64 = rng.random();
        let plan = example_plan();
        let names: Vec<String> = plan.gaits.iter().map(|gait| gait.name.clone()).collect();
        let again = randomised(&names, 5, seed);
        assert_eq!(again, randomised(&names, 5, seed));
        let text = serde_json::to_string(&plan).unwrap();
        let read: Plan = serde_json::from_str(&text).unwrap();
        assert_eq!((read.sha256(), read.problem()), (plan.sha256(), None));
    }
}
