//! Complete sessions of an operator who uploads, arms, plays and stops over lines with every fault, in virtual time. Each
//! request ends in success or a stated failure within its deadline and acts at most once, and the robot ends with the last
//! committed table.

use crate::tank_less;

use std::ops::ControlFlow;
use std::time::Duration;

use host_link::testing::{FaultPlan, Faults, Outage};
use host_link::{LinkError, Port, Robot};
use link_protocol::{StateName, crc32c};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tank_less::{FaultyLine, circle, faulty};

const MS: Duration = Duration::from_millis(1);
/// Longest request: five attempts, at most 3 s apart, one beat, and a check of a table in between.
const REQUEST: Duration = Duration::from_millis(5 * 3000 + 20 + 3000);
const UPLOAD: Duration = Duration::from_secs(40);
/// An upload checks its deadline once per beat, and follows a request of its own.
const BEAT: Duration = Duration::from_millis(25);
/// Tables of the operator: circles with these amplitudes.
const AMPLITUDES: [f64; 4] = [0.4, 0.7, 1.0, 1.3];
const PERIOD: Duration = Duration::from_secs(6);

/// Totals of 1000 sessions.
#[derive(Debug, Default)]
struct Tally {
    asked: u64,
    well: u64,
    failed: u64,
    uploads: u64,
    uploads_well: u64,
    plays_seen_to_their_end: u64,
    reconnected: u64,
    acts: u64,
    longest_request: Duration,
    longest_upload: Duration,
}

fn random_faults(rng: &mut ChaCha8Rng) -> Faults {
    let mut chance = |often: f64, most: f64| {
        if rng.random_bool(often) {
            rng.random_range(0.0..most)
        } else {
            0.0
        }
    };
    let mut faults = Faults {
        drop: chance(0.7, 0.35),
        flip: chance(0.7, 0.05),
        duplicate: chance(0.5, 0.2),
        reorder: chance(0.5, 0.1),
        ..Faults::none()
    };
    faults.delay = MS * [0, 10, 50, 200][rng.random_range(0..4)];
    faults.clump = [0, 0, 64, 230][rng.random_range(0..4)];
    faults.stale = [0, 0, 200, 600][rng.random_range(0..4)];
    if rng.random_bool(0.4) {
        faults.disconnect = Some(Outage {
            from: MS * rng.random_range(500..8000),
            duration: MS * rng.random_range(100..9000),
            every: Some(MS * rng.random_range(12_000..40_000)),
        });
    }
    faults
}

/// Operator, with the expected state of the robot.
struct Operator {
    seed: u64,
    robot: Robot<FaultyLine>,
    rng: ChaCha8Rng,
    tally: Tally,
    /// Active table according to the last successful upload.
    active: Option<u32>,
    /// An upload failed since; its commit may have acted.
    unsure: bool,
}

impl Operator {
    /// Runs an operation and checks its duration against the deadline.
    fn ask<T>(
        &mut self,
        deadline: Duration,
        what: &str,
        doing: impl FnOnce(&mut Robot<FaultyLine>) -> Result<T, LinkError>,
    ) -> Option<T> {
        let began = self.robot.port().now();
        let result = doing(&mut self.robot);
        let took = self.robot.port().now().abs_diff(began);
        let seed = self.seed;
        assert!(took <= deadline, "seed {seed}: {what} took {took:?}");
        if deadline == REQUEST {
            self.tally.longest_request = self.tally.longest_request.max(took);
        }
        self.tally.asked += 1;
        match result {
            Ok(value) => {
                self.tally.well += 1;
                Some(value)
            }
            Err(error) => {
                self.tally.failed += 1;
                let text = error.to_string();
                assert!(text.len() > 30, "seed {seed}: {what}: {text}");
                if matches!(
                    error,
                    LinkError::NoAnswer { .. }
                        | LinkError::SessionLost { .. }
                        | LinkError::Silent { .. }
                        | LinkError::NotConnected { .. }
                ) {
                    self.reconnect();
                }
                None
            }
        }
    }

    /// Reconnects until it succeeds, as an operator would; interruptions are shorter than this.
    fn reconnect(&mut self) {
        for _ in 0..12 {
            let began = self.robot.port().now();
            let result = self.robot.reconnect();
            let took = self.robot.port().now().abs_diff(began);
            assert!(
                took <= REQUEST,
                "seed {}: connecting took {took:?}",
                self.seed
            );
            if result.is_ok() {
                self.tally.reconnected += 1;
                return;
            }
        }
    }

    fn upload(&mut self) {
        let amplitude = AMPLITUDES[self.rng.random_range(0..AMPLITUDES.len())];
        let table = circle(amplitude);
        let began = self.robot.port().now();
        let info = self.ask(UPLOAD + BEAT, "an upload", |robot| {
            robot.upload(table.bytes(), UPLOAD, |_| ControlFlow::Continue(()))
        });
        let took = self.robot.port().now().abs_diff(began);
        self.tally.uploads += 1;
        if let Some(info) = info {
            assert_eq!(info.crc32, crc32c(table.bytes()), "seed {}", self.seed);
            self.tally.longest_upload = self.tally.longest_upload.max(took);
            self.tally.uploads_well += 1;
            (self.active, self.unsure) = (Some(info.crc32), false);
        } else {
            self.unsure = true;
        }
    }

    fn play(&mut self) {
        let detached = self.rng.random_bool(0.5);
        let armed = self.ask(REQUEST, "arming", |robot| robot.arm(false));
        if armed.is_none() {
            return;
        }
        let cycles = self.rng.random_range(1..3);
        let Some(held) = self.ask(REQUEST, "the status", Robot::held) else {
            return;
        };
        let begun = self.ask(REQUEST, "play", |robot| {
            robot.play_checked(cycles, PERIOD, detached, held)
        });
        if begun.is_none() {
            return;
        }
        // Soft start, the cycles, the longest search and one more greeting.
        let most = PERIOD * cycles + Duration::from_secs(3 + 30) + REQUEST * 2;
        let ended = self.ask(most, "waiting", |robot| {
            robot.wait_until_finished(|_| ControlFlow::Continue(()))
        });
        self.tally.plays_seen_to_their_end += u64::from(ended.is_some());
    }

    fn stop(&mut self) {
        if self.ask(REQUEST, "a stop", Robot::stop).is_some() {
            // Ramp of at most 0.8 s and half a second at neutral; the reply arrived later than the stop.
            self.robot.port_mut().inner_mut().pass(MS * 1340);
            let device = self.robot.port().inner().device();
            let off = device
                .output
                .is_some_and(|output| output.pulses_ns.is_none());
            assert!(off, "seed {}: pulses after a stop", self.seed);
        }
    }

    fn act(&mut self) {
        match self.rng.random_range(0..10) {
            0..=2 => self.upload(),
            3..=5 => self.play(),
            6 => self.stop(),
            7 => {
                let trim = f64::from(self.rng.random_range(-150..150)) * 1e-4;
                self.ask(REQUEST, "a trim", |robot| {
                    robot.trim(link_protocol::Joint::Front, trim)
                });
            }
            8 => {
                let time = MS * self.rng.random_range(10..3000);
                self.ask(time + Duration::from_secs(6), "listening", |robot| {
                    robot.listen(time, |_| ControlFlow::Continue(()))
                });
            }
            _ => {
                self.ask(REQUEST, "the status", Robot::status);
            }
        }
    }
}

fn session(seed: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let faults = random_faults(&mut rng);
    let line = faulty(Faults::none(), seed);
    let mut robot = Robot::connect(line, seed).unwrap();
    robot.port_mut().set_plan(FaultPlan::at_host(faults));
    let mut operator = Operator {
        seed,
        robot,
        rng,
        tally: Tally::default(),
        active: None,
        unsure: false,
    };
    for _ in 0..10 {
        operator.act();
    }
    operator.settle()
}

impl Operator {
    /// Removes the faults and compares the robot's state and history with the expected ones.
    fn settle(mut self) -> Tally {
        let seed = self.seed;
        let clean = FaultPlan::at_host(Faults::none());
        self.robot.port_mut().set_plan(clean);
        self.robot.port_mut().inner_mut().pass(MS * 1500);
        self.robot.reconnect().unwrap();
        self.robot.stop().unwrap();
        self.robot.port_mut().inner_mut().pass(MS * 1500);
        let _ = self.robot.reconnect();
        let status = self.robot.status().unwrap();
        assert_eq!(status.state, StateName::Stopped, "seed {seed}");
        let held = status.table.map(|table| table.crc32);
        let device = self.robot.port().inner().device();
        assert_eq!(held, device.committed.last().copied(), "seed {seed}");
        if !self.unsure {
            assert_eq!(held, self.active, "seed {seed}");
        }
        for (request, times) in &device.acts {
            assert_eq!(*times, 1, "seed {seed}: {request:?} acted more than once");
        }
        // Every set-point of every play was on a committed table.
        for radius in &device.radii {
            let of_a_table = AMPLITUDES.iter().any(|amplitude| {
                (amplitude * 100.0 - *radius as f64).abs() < 0.5
                    && device.committed.contains(&circle(*amplitude).crc32())
            });
            assert!(
                of_a_table,
                "seed {seed}: played a circle of {radius}/100 rad"
            );
        }
        self.tally.acts = device.acts.len() as u64;
        self.tally
    }
}

fn sessions(seeds: std::ops::Range<u64>) {
    let count = seeds.end - seeds.start;
    let mut sum = Tally::default();
    for tally in seeds.map(session) {
        sum.asked += tally.asked;
        sum.well += tally.well;
        sum.failed += tally.failed;
        sum.uploads += tally.uploads;
        sum.uploads_well += tally.uploads_well;
        sum.plays_seen_to_their_end += tally.plays_seen_to_their_end;
        sum.reconnected += tally.reconnected;
        sum.acts += tally.acts;
        sum.longest_request = sum.longest_request.max(tally.longest_request);
        sum.longest_upload = sum.longest_upload.max(tally.longest_upload);
    }
    println!(
        "{count} sessions with faults: {} things asked, {} done, {} failed with a sentence; {} of {} uploads, {} plays seen to \
         their end, {} connected anew; {} requests acted, none twice; longest request {:.1} s, longest upload {:.1} s",
        sum.asked,
        sum.well,
        sum.failed,
        sum.uploads_well,
        sum.uploads,
        sum.plays_seen_to_their_end,
        sum.reconnected,
        sum.acts,
        sum.longest_request.as_secs_f64(),
        sum.longest_upload.as_secs_f64(),
    );
    assert_eq!(sum.asked, sum.well + sum.failed);
    // Most operations succeed; otherwise the faults would hide the behaviour under test.
    assert!(sum.well > 6 * count && sum.uploads_well > count, "{sum:?}");
}

#[test]
fn a_thousand_sessions_end_in_success_or_a_stated_failure() {
    sessions(0..1000);
}
