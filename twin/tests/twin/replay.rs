//! Replay of a link log yields the robot's own set-points and pulses; a modified log does not.

use std::io;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use gait_player::GaitTable;
use host_link::port::{TracedFrame, TracedPort};
use host_link::session::{ClockSamples, SessionConfig};
use host_link::testing::{FaultPlan, Faults, FaultyPort};
use host_link::{Port, Robot};
use link_protocol::{
    Decoder, Direction, Header, Key, MAX_ENCODED, Message, Play, Request, StateName, StopCause,
    encode,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{LinkFrame, SwimmerFile};
use twin::{Reason, ReplayError, Twin, TwinConfig, TwinPort, Verdict, WireSpeed, replay};

fn table(amplitude: f64) -> GaitTable {
    GaitTable::from_fn(64, |u| {
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        [amplitude * cos, amplitude * sin]
    })
    .unwrap()
}

fn message(bytes: &[u8]) -> Option<(Header, Message)> {
    let mut decoder = Decoder::new();
    let received = bytes.iter().find_map(|&byte| decoder.push(byte))?;
    Some((received.header, received.message.ok()?))
}

/// Frames of a session, with both clocks as a recorder stores them.
fn recorded(
    port: impl Port + 'static,
    act: impl FnOnce(&mut Robot<Box<dyn Port>>),
) -> Vec<LinkFrame> {
    recorded_with(port, SessionConfig::new(7), act)
}

fn recorded_with(
    port: impl Port + 'static,
    session: SessionConfig,
    act: impl FnOnce(&mut Robot<Box<dyn Port>>),
) -> Vec<LinkFrame> {
    let frames: Arc<Mutex<Vec<LinkFrame>>> = Arc::default();
    let sink = Arc::clone(&frames);
    let mut samples = ClockSamples::default();
    let port: Box<dyn Port> = Box::new(TracedPort::new(port, move |frame: TracedFrame<'_>| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a few seconds
        let mut robot_time_us = samples
            .fit()
            .map(|fit| (fit.robot_time(frame.at).max(0.0) * 1e6) as u64);
        if let (Direction::ToHost, Some((_, Message::Pong(pong)))) =
            (frame.direction, message(frame.bytes))
        {
            samples.push(&pong, frame.at);
            robot_time_us = Some(pong.sent_us);
        }
        sink.lock().unwrap().push(LinkFrame {
            direction: frame.direction,
            host_time_ns: u64::try_from(frame.at.as_nanos()).unwrap(),
            robot_time_us,
            bytes: frame.bytes.to_vec(),
        });
    }));
    let mut robot = Robot::connect_with(port, session).unwrap();
    act(&mut robot);
    drop(robot);
    Arc::into_inner(frames).unwrap().into_inner().unwrap()
}

fn twin() -> TwinPort {
    let config = TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 3);
    TwinPort::new(Twin::new(config).unwrap(), WireSpeed::robot())
}

fn upload(robot: &mut Robot<Box<dyn Port>>, table: &GaitTable) {
    let patience = Duration::from_mins(2);
    robot
        .upload(table.bytes(), patience, |_| ControlFlow::Continue(()))
        .unwrap();
}

fn live(robot: &mut Robot<Box<dyn Port>>, seconds: f64) {
    let time = Duration::from_secs_f64(seconds);
    robot.listen(time, |_| ControlFlow::Continue(())).unwrap();
}

/// Every request that moves a robot, at moments off the tick grid: a pause within a cycle, a swap during a play, a stop, a
/// second play to its end, an e-stop and its clearing.
fn everything(robot: &mut Robot<Box<dyn Port>>) {
    live(robot, 1.003);
    upload(robot, &table(1.0));
    robot.arm(false).unwrap();
    robot.play(0, Duration::from_millis(4321), false).unwrap();
    live(robot, 5.137);
    robot.pause(false).unwrap();
    live(robot, 0.777);
    robot.resume().unwrap();
    live(robot, 1.501);
    upload(robot, &table(0.7));
    live(robot, 6.0);
    robot.stop().unwrap();
    live(robot, 2.513);
    robot.arm(false).unwrap();
    robot.play(2, Duration::from_secs(3), false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    live(robot, 2.0);
    robot.arm(false).unwrap();
    live(robot, 0.5);
    robot.estop().unwrap();
    live(robot, 0.5);
    robot.arm(true).unwrap();
    live(robot, 0.3);
    robot.stop().unwrap();
    live(robot, 2.0);
}

#[test]
fn a_log_gives_the_same_pulses() {
    let frames = recorded(twin(), everything);
    let told = replay(&frames, None).unwrap();
    assert_eq!(told.different, 0, "{told:#?}");
    assert!(told.compared > 600 && told.requests == 14, "{told:?}");
    assert_eq!((told.missing_table, told.verdict), (None, Verdict::Same));
}

/// Loaded machine: bytes leave later than the log says, and arrive before they are read.
struct Loaded<P> {
    port: P,
    held: Vec<u8>,
    random: ChaCha8Rng,
}

impl<P: Port> Loaded<P> {
    fn new(port: P, seed: u64) -> Self {
        Self {
            port,
            held: Vec::new(),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// One time in ten, up to 150 ms, which does not endanger the lease.
    fn stall(&mut self) -> io::Result<()> {
        if !self.random.random_bool(0.1) {
            return Ok(());
        }
        let until = self.port.now() + Duration::from_millis(self.random.random_range(10..150));
        while self.port.now() < until {
            let mut bytes = [0; 256];
            let left = until.saturating_sub(self.port.now());
            let count = self.port.read(&mut bytes, left)?;
            self.held.extend_from_slice(&bytes[..count]);
        }
        Ok(())
    }
}

impl<P: Port> Port for Loaded<P> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if self.held.is_empty() {
            let mut bytes = [0; 256];
            let count = self.port.read(&mut bytes, timeout)?;
            self.held.extend_from_slice(&bytes[..count]);
            self.stall()?;
        }
        let count = buf.len().min(self.held.len());
        for (place, byte) in buf.iter_mut().zip(self.held.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stall()?;
        self.port.write(bytes)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

#[test]
fn so_does_one_of_a_loaded_machine() {
    for seed in 0..10 {
        let frames = recorded(Loaded::new(twin(), seed), everything);
        let told = replay(&frames, None).unwrap();
        assert_eq!(told.verdict, Verdict::Same, "seed {seed}: {told:#?}");
        assert!(told.compared > 600 && told.requests == 14, "{told:?}");
    }
}

/// The tick in which a lease ends depends on the last keep-alive.
#[test]
fn a_play_that_lost_its_link_is_the_same() {
    let mut same = 0;
    for seed in 0..6 {
        let faults: Faults = format!("disconnect={}:1500", 6000 + 37 * seed)
            .parse()
            .unwrap();
        let faulty = FaultyPort::new(twin(), FaultPlan::at_host(faults), seed);
        let frames = recorded(faulty, |robot| {
            live(robot, 1.003);
            upload(robot, &table(1.0));
            robot.arm(false).unwrap();
            robot.play(0, Duration::from_millis(4321), false).unwrap();
            live(robot, 8.0);
        });
        let stops = frames.iter().filter_map(|frame| message(&frame.bytes));
        let lost = stops.filter(|(_, message)| {
            matches!(message, Message::Telemetry(told) if told.cause == StopCause::LinkLost)
        });
        assert!(lost.count() > 10);
        let told = replay(&frames, None).unwrap();
        assert_ne!(told.verdict, Verdict::Differs, "seed {seed}: {told:#?}");
        same += u32::from(told.verdict == Verdict::Same);
    }
    println!("replay: {same} of 6 plays that lost their link are the same, the others undecided");
    assert!(same > 0);
}

/// Telemetry, pongs and requests with implausible numbers, in frames with correct checksums.
#[test]
fn absurd_numbers_end_in_a_verdict() {
    let frames = recorded(twin(), |robot| {
        live(robot, 1.0);
        upload(robot, &table(1.0));
        robot.arm(false).unwrap();
        robot.play(1, Duration::from_secs(3), false).unwrap();
        live(robot, 5.0);
    });
    let with = |change: &dyn Fn(usize, &mut Message)| -> Vec<LinkFrame> {
        let mut frames = frames.clone();
        for (index, frame) in frames.iter_mut().enumerate() {
            if let Some((header, mut message)) = message(&frame.bytes) {
                change(index, &mut message);
                let mut bytes = [0; MAX_ENCODED];
                let length = encode(header, &message, &mut bytes).unwrap();
                frame.bytes = bytes[..length].to_vec();
            }
        }
        frames
    };
    let late = frames.len() - 20;
    for absurd in [u64::MAX, u64::MAX / 2, 1 << 60, 1 << 45] {
        let jumping = with(&|index, message| match message {
            Message::Telemetry(told) if index >= late => told.robot_us = absurd,
            _ => {}
        });
        let told = replay(&jumping, None);
        assert!(
            matches!(told, Err(ReplayError::TooLong | ReplayError::Gap { .. })),
            "{told:?}"
        );
        let pongs = with(&|_, message| {
            if let Message::Pong(pong) = message {
                (pong.received_us, pong.sent_us) = (absurd, absurd);
            }
        });
        let _ = replay(&pongs, None);
        let beats = with(&|_, message| {
            if let Message::Heartbeat(beat) = message {
                (beat.heard_us, beat.host_us) = (absurd, absurd);
            }
        });
        assert_ne!(replay(&beats, None).unwrap().verdict, Verdict::Same);
    }
    let mut clocks = frames.clone();
    for (index, frame) in clocks.iter_mut().enumerate() {
        frame.host_time_ns = frame
            .host_time_ns
            .wrapping_mul(1 + index as u64 % 7 * (1 << 40));
        frame.robot_time_us = frame
            .robot_time_us
            .map(|us| us.wrapping_mul(1 << (index % 50)));
    }
    let _ = replay(&clocks, None);
    // A hundred thousand stops during the play, which the robot of this log did not execute.
    let is_playing = |frame: &LinkFrame| matches!(message(&frame.bytes), Some((_, Message::Telemetry(telemetry))) if telemetry.state == StateName::Playing);
    let middle = frames.iter().position(is_playing).unwrap() + 20;
    let at = frames[middle].clone();
    let numbers =
        (0..2_u16).flat_map(|session| (0..50_000_u16).map(move |sequence| (session, sequence)));
    let stops = numbers.map(|(session, sequence)| {
        let header = Header::new(session, sequence);
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(header, &Message::Request(Request::Stop), &mut bytes).unwrap();
        LinkFrame {
            direction: Direction::ToRobot,
            bytes: bytes[..length].to_vec(),
            ..at.clone()
        }
    });
    let (before, after) = frames.split_at(middle);
    let many: Vec<LinkFrame> = before
        .iter()
        .cloned()
        .chain(stops)
        .chain(after.iter().cloned())
        .collect();
    let told = replay(&many, None).unwrap();
    assert_ne!(told.verdict, Verdict::Same, "{told:?}");
}

/// A restart of the robot ends the comparison, not the program.
#[test]
fn a_restart_ends_the_comparison() {
    let first = recorded(twin(), |robot| live(robot, 2.0));
    let mut both = recorded(twin(), |robot| live(robot, 2.0));
    let mut frames = first;
    frames.append(&mut both);
    let told = replay(&frames, None).unwrap();
    assert!(told.restarted && told.verdict == Verdict::Same, "{told:?}");
    assert!(told.seconds < 2.5, "{told:?}");
}

#[test]
fn nothing_compared_is_not_the_same() {
    let frames = recorded(twin(), |robot| live(robot, 1.0));
    // Without the greeting, the brain has no session and sends no telemetry.
    let mute: Vec<LinkFrame> = frames
        .into_iter()
        .filter(|frame| !matches!(message(&frame.bytes), Some((_, Message::Hello(_)))))
        .collect();
    let told = replay(&mute, None).unwrap();
    assert_eq!(
        (told.compared, told.verdict),
        (0, Verdict::Undecided(Reason::NothingCompared))
    );
}

#[test]
fn so_does_one_of_a_link_that_drops_and_delays() {
    let faults: Faults = "drop=5%,delay=60".parse().unwrap();
    let faulty = FaultyPort::new(twin(), FaultPlan::at_host(faults), 5);
    let frames = recorded(faulty, everything);
    let told = replay(&frames, None).unwrap();
    assert_eq!(told.different, 0, "{told:#?}");
    assert!(told.compared > 500, "{told:?}");
}

/// Robot that shares a key with its hosts.
fn keyed_twin() -> TwinPort {
    let mut robot = Robot::connect(twin(), 1).unwrap();
    robot.set_key(Some(KEY)).unwrap();
    robot.into_port()
}

const KEY: Key = Key(*b"sixteen letters!");

fn with_key(key: Key) -> SessionConfig {
    SessionConfig {
        key: Some(key),
        ..SessionConfig::new(7)
    }
}

/// The log lacks the key and does not need it: the robot has checked the authority, and replay repeats the accepted requests.
#[test]
fn so_does_one_that_was_signed_without_the_key() {
    let frames = recorded_with(keyed_twin(), with_key(KEY), everything);
    let signed = |frame: &&LinkFrame| {
        let received = frame.received().unwrap();
        frame.direction == Direction::ToRobot && received.signature.is_some()
    };
    assert!(frames.iter().filter(signed).count() > 300);
    let told = replay(&frames, None).unwrap();
    assert_eq!(told.different, 0, "{told:#?}");
    assert!(told.compared > 600 && told.requests == 14, "{told:?}");
}

/// A key set during the log is recorded as zeros, and later frames are signed with the true one.
#[test]
fn a_log_in_which_a_key_is_set_is_the_same() {
    let frames = recorded(twin(), |robot| {
        live(robot, 1.0);
        robot.set_key(Some(KEY)).unwrap();
        live(robot, 1.0);
        upload(robot, &table(1.0));
        robot.arm(false).unwrap();
        robot.play(1, Duration::from_secs(3), false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
    });
    let holds_key = |frame: &LinkFrame| frame.bytes.windows(4).any(|window| KEY.0[..4] == *window);
    assert!(!frames.iter().any(holds_key));
    let told = replay(&frames, None).unwrap();
    assert_eq!(told.verdict, Verdict::Same, "{told:#?}");
}

/// A host without the correct key moves nothing, not even the clock, so there is nothing to compare.
#[test]
fn a_log_of_a_host_that_was_turned_away_says_so() {
    for session in [SessionConfig::new(7), with_key(Key([0; 16]))] {
        let frames = recorded_with(keyed_twin(), session, |robot| {
            live(robot, 1.0);
            assert!(robot.arm(false).is_err());
            robot.stop().unwrap();
            live(robot, 1.0);
        });
        let error = replay(&frames, None).unwrap_err();
        assert_eq!(error, ReplayError::TurnedAway);
        assert!(error.to_string().contains("--key FILE"), "{error}");
    }
}

/// With another period in the log's Play, the brain plays differently from the robot.
#[test]
fn a_log_that_was_tampered_with_does_not() {
    let mut frames = recorded(twin(), everything);
    for frame in &mut frames {
        let Some((header, Message::Request(Request::Play(play)))) = message(&frame.bytes) else {
            continue;
        };
        let play = Play {
            period_us: play.period_us + 10_000,
            ..play
        };
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(header, &Message::Request(Request::Play(play)), &mut bytes).unwrap();
        frame.bytes = bytes[..length].to_vec();
    }
    let told = replay(&frames, None).unwrap();
    assert!(told.different > 100, "{told:?}");
    assert_eq!(told.verdict, Verdict::Differs);
    let first = told.first.unwrap();
    assert_ne!(Some(first.logged), first.replayed);
}

/// A gait from before the log must be passed to the replay.
#[test]
fn a_gait_from_before_the_log_is_named_from_outside() {
    let mut port = Robot::connect(Box::new(twin()) as Box<dyn Port>, 1).unwrap();
    upload(&mut port, &table(1.0));
    let frames = recorded(port.into_port(), |robot| {
        robot.status().unwrap();
        robot.arm(false).unwrap();
        robot.play(1, Duration::from_secs(4), false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
    });
    let told = replay(&frames, Some(&table(1.0))).unwrap();
    assert_eq!((told.different, told.missing_table), (0, None), "{told:#?}");
    for wrong in [None, Some(table(0.9))] {
        let told = replay(&frames, wrong.as_ref()).unwrap();
        assert!(
            told.different > 50 && told.missing_table.is_some(),
            "{told:?}"
        );
        assert!(
            matches!(told.verdict, Verdict::Undecided(Reason::MissingTable(_))),
            "{told:?}"
        );
    }
}

/// A play refers to the robot's settings; a replay with others reports that the log lacks them.
#[test]
fn settings_from_before_the_log_are_reported() {
    let mut robot = Robot::connect(Box::new(twin()) as Box<dyn Port>, 1).unwrap();
    robot.trim(link_protocol::Joint::Front, 0.1).unwrap();
    let frames = recorded(robot.into_port(), |robot| {
        live(robot, 1.0);
        upload(robot, &table(1.0));
        robot.arm(false).unwrap();
        robot.play(1, Duration::from_secs(4), false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
    });
    let told = replay(&frames, None).unwrap();
    assert!(
        told.different > 50 && told.other_settings.is_some(),
        "{told:?}"
    );
}

#[test]
fn logs_without_a_session_say_what_they_lack() {
    assert_eq!(replay(&[], None), Err(ReplayError::NoClock));
    let frames = recorded(twin(), |robot| live(robot, 1.0));
    let without = |unwanted: fn(&Message) -> bool| -> Vec<LinkFrame> {
        frames
            .iter()
            .filter(|frame| message(&frame.bytes).is_none_or(|(_, message)| !unwanted(&message)))
            .cloned()
            .collect()
    };
    let ungreeted = without(|message| matches!(message, Message::HelloReply(_)));
    assert_eq!(replay(&ungreeted, None), Err(ReplayError::NoGreeting));
    let silent = without(|message| matches!(message, Message::Telemetry(_)));
    assert_eq!(replay(&silent, None), Err(ReplayError::NoTelemetry));
}

#[test]
fn a_log_that_begins_in_motion_is_refused() {
    let mut robot = Robot::connect(Box::new(twin()) as Box<dyn Port>, 1).unwrap();
    upload(&mut robot, &table(1.0));
    robot.arm(false).unwrap();
    robot.play(20, Duration::from_secs(4), true).unwrap();
    live(&mut robot, 3.0);
    let frames = recorded(robot.into_port(), |robot| live(robot, 1.0));
    assert!(matches!(
        replay(&frames, None),
        Err(ReplayError::NotAtRest(_))
    ));
}
