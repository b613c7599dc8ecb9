//! Promise R6, by exhaustion: breadth first over everything that can happen to a brain, until nothing new is reached. The
//! brains are real; two are the same where [`Shape`] is. Of every step it is asked that nothing but an arm that was granted
//! leads out of a stop.

use super::state::State;
use super::work::Work;
use super::{Boot, Brain, BrainConfig, Identity, Inputs};
use crate::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use crate::{GaitTable, TICK_US};
use link_protocol::*;
use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use std::convert::Infallible;
use std::vec::Vec;

use ResetReason::{Crash, Pin, PowerOn, Watchdog};

/// Something that happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    /// A request in the open session, under the next number.
    Ask(usize),
    /// The frame of the last request again, byte by byte.
    Repeat,
    /// A request under an old number.
    Late(usize),
    /// A request of a session before.
    Foreign(usize),
    /// Another host greets.
    Greet,
    /// The same host greets again.
    GreetAgain,
    KeepAlive,
    /// Time passes: ticks, with or without keep-alives.
    Pass {
        ticks: u32,
        kept_alive: bool,
    },
    /// One tick that comes late by so many seconds.
    Jump(u64),
    /// The battery has this voltage from now on.
    Battery(Option<u16>),
    Reset(ResetReason),
}

fn requests() -> Vec<Request> {
    let play = |cycles, detached| {
        Request::Play(Play {
            cycles,
            period_us: 1_000_000,
            detached,
        })
    };
    let (a, b) = (table(0.3), table(0.5));
    let begin = |table: &GaitTable| {
        Request::Begin(Begin {
            slot: 0,
            len: table.bytes().len() as u16,
            crc32: table.crc32(),
        })
    };
    let chunk = |table: &GaitTable, from: usize, to: usize| {
        Request::Chunk(Chunk {
            upload: 0, // filled in when it is sent
            offset: from as u16,
            data: heapless::Vec::from_slice(&table.bytes()[from..to]).unwrap(),
        })
    };
    let config = config();
    let servo = config.servos[0];
    std::vec![
        Request::Arm(Arm { clear_estop: false }),
        Request::Arm(Arm { clear_estop: true }),
        play(2, false),
        play(2, true),
        play(0, false),
        play(0, true),
        Request::Pause { detached: false },
        Request::Pause { detached: true },
        Request::Resume,
        Request::Stop,
        Request::EStop,
        begin(&a),
        begin(&b),
        chunk(&a, 0, 16),
        chunk(&a, 16, 32),
        chunk(&b, 0, 32),
        Request::Commit { upload: 0 },
        Request::ClearResets,
        Request::Configure(config.configuration),
        Request::SetServo {
            joint: Joint::Front,
            settings: servo
        },
        Request::Trim {
            joint: Joint::Back,
            trim: 100
        },
        Request::Status,
        Request::Counters,
        Request::Configuration,
        Request::Servo(Joint::Back),
        Request::CrashMessage,
        Request::Table,
    ]
}

fn events(requests: &[Request]) -> Vec<Event> {
    let mut events: Vec<_> = (0..requests.len()).map(Event::Ask).collect();
    for (index, request) in requests.iter().enumerate() {
        // What could move the robot, or stop it, from elsewhere or too late.
        if matches!(
            request,
            Request::Arm(_) | Request::Play(_) | Request::Resume | Request::Stop | Request::EStop
        ) {
            events.extend([Event::Late(index), Event::Foreign(index)]);
        }
    }
    events.extend([
        Event::Repeat,
        Event::Greet,
        Event::GreetAgain,
        Event::KeepAlive,
        Event::Battery(Some(5_000)),
        Event::Battery(Some(4_000)),
        Event::Battery(None),
        Event::Jump(6),
        Event::Jump(61),
    ]);
    for (ticks, kept_alive) in [(1, false), (7, true), (26, false), (26, true), (52, true)] {
        events.push(Event::Pass { ticks, kept_alive });
    }
    events.extend([PowerOn, Watchdog, Crash, Pin].map(Event::Reset));
    events
}

fn table(amplitude: f64) -> GaitTable {
    GaitTable::from_fn(8, |u| {
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        [amplitude * cos, amplitude * sin]
    })
    .unwrap()
}

fn config() -> BrainConfig {
    let firmware = FirmwareVersion {
        major: 0,
        minor: 1,
        patch: 0,
        commit: [0; 8],
    };
    let board = Board::Twin;
    BrainConfig::robot(Identity { firmware, board }, Boot::power_on(1, 100))
}

/// A brain with all that surrounds it.
#[derive(Clone)]
struct World {
    brain: Brain,
    flash: Flash,
    now_us: u64,
    battery_mv: Option<u16>,
    sequence: u16,
    upload: u16,
    begun: u32,
    nonce: u32,
    /// The last request's frame, and whether it could move the robot.
    last: Vec<u8>,
    last_moves: bool,
    /// A request has been made in the open session.
    asked: bool,
}

#[derive(Clone)]
struct Flash {
    slots: Vec<u8>,
    settings: Option<Vec<u8>>,
}

const SLOT: usize = PAGE * SLOT_PAGES;

impl Storage for Flash {
    type Error = Infallible;

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.copy_from_slice(&self.slots[slot * SLOT + offset..][..bytes.len()]);
        Ok(())
    }

    fn erase(&mut self, slot: usize) -> Result<(), Infallible> {
        self.slots[slot * SLOT..][..SLOT].fill(0xFF);
        Ok(())
    }

    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Infallible> {
        self.slots[slot * SLOT + page * PAGE..][..PAGE].copy_from_slice(bytes);
        Ok(())
    }

    fn load_settings(
        &mut self,
        bytes: &mut [u8; MAX_SETTINGS],
    ) -> Result<Option<usize>, Infallible> {
        Ok(self.settings.as_ref().map(|settings| {
            bytes[..settings.len()].copy_from_slice(settings);
            settings.len()
        }))
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        self.settings = Some(bytes.to_vec());
        Ok(())
    }
}

/// What a step showed.
#[derive(Default)]
struct Seen {
    /// The state after each tick, in order, without repeats.
    states: Vec<StateName>,
    /// An arm was granted.
    armed: bool,
}

impl World {
    fn new() -> Self {
        let mut world = Self {
            brain: Brain::new(config()),
            flash: Flash {
                slots: std::vec![0xFF; SLOT * SLOTS],
                settings: None,
            },
            now_us: 0,
            battery_mv: Some(5_000),
            sequence: 0,
            upload: 0,
            begun: 0,
            nonce: 1,
            last: Vec::new(),
            last_moves: false,
            asked: false,
        };
        world.tick(&mut Seen::default());
        world
    }

    fn step(&mut self, event: Event, requests: &[Request]) -> Seen {
        let mut seen = Seen::default();
        match event {
            Event::Ask(index) => {
                self.sequence = self.sequence.wrapping_add(1);
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                // A piece of a table has no place in the order.
                self.asked |= session != 0 && !matches!(requests[index], Request::Chunk(_));
                seen.armed = self.ask(session, sequence, &requests[index]);
            }
            // Only where there is a number to be late for, or none needed.
            Event::Late(index)
                if !self.asked && !matches!(requests[index], Request::Stop | Request::EStop) => {}
            Event::Late(index) => {
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                let old = sequence.wrapping_sub(5);
                self.ask(session, old, &requests[index]);
            }
            Event::Foreign(index) => {
                let session = self.brain.session.number().wrapping_sub(1);
                let sequence = self.sequence.wrapping_add(1);
                self.ask(session, sequence, &requests[index]);
            }
            Event::Repeat => {
                let frame = self.last.clone();
                // Not a new arm, whatever it is answered.
                self.receive(&frame);
            }
            Event::Greet => {
                self.nonce += 1;
                self.asked = false;
                self.greet();
            }
            Event::GreetAgain => self.greet(),
            Event::KeepAlive => self.keep_alive(),
            Event::Pass { ticks, kept_alive } => {
                for tick in 1..ticks {
                    if kept_alive && tick % 2 == 0 {
                        self.keep_alive();
                    }
                    self.tick(&mut seen);
                }
            }
            Event::Jump(seconds) => self.now_us += seconds * 1_000_000,
            Event::Battery(mv) => self.battery_mv = mv,
            Event::Reset(reset_reason) => {
                let boot = Boot {
                    reset_reason,
                    kept: self.brain.output.kept,
                    session_seed: self.brain.session.number().wrapping_add(7),
                    ..Boot::power_on(1, 0)
                };
                self.brain = Brain::new(BrainConfig { boot, ..config() });
                let Ok(()) = self.brain.load(&mut self.flash);
                self.now_us = 0;
                self.asked = false;
            }
        }
        self.tick(&mut seen);
        seen
    }

    fn tick(&mut self, seen: &mut Seen) {
        self.now_us += u64::from(TICK_US);
        let inputs = Inputs {
            battery_mv: self.battery_mv,
            link_up: true,
        };
        let output = self.brain.tick(self.now_us, &inputs);
        let powered = !matches!(output.state, StateName::Stopped | StateName::EStopped);
        assert_eq!(output.pulses_ns.is_some(), powered, "{:?}", output.state);
        if output.storage_wanted {
            let Ok(()) = self.brain.serve_storage(self.now_us, &mut self.flash);
        }
        self.is_done_said();
        if seen.states.last() != Some(&output.state) {
            seen.states.push(output.state);
        }
    }

    /// Whether it is an arm and was granted.
    fn ask(&mut self, session: u16, sequence: u16, request: &Request) -> bool {
        let mut request = request.clone();
        match &mut request {
            Request::Chunk(chunk) => chunk.upload = self.upload,
            Request::Commit { upload } => *upload = self.upload,
            Request::Begin(begin) => (self.upload, self.begun) = (sequence, begin.crc32),
            _ => {}
        }
        let arms = matches!(request, Request::Arm(_));
        let moves = arms || matches!(request, Request::Play(_) | Request::Resume);
        let frame = frame(session, sequence, &Message::Request(request));
        let done = self.receive(&frame);
        if session == self.brain.session.number() && sequence == self.sequence {
            (self.last, self.last_moves) = (frame, moves);
        }
        done && arms
    }

    fn greet(&mut self) {
        let hello = Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce: self.nonce,
        };
        self.receive(&frame(0, 0, &Message::Hello(hello)));
    }

    fn keep_alive(&mut self) {
        let session = self.brain.session.number();
        self.receive(&frame(session, 0, &Message::KeepAlive));
    }

    /// Whether the answer is Done.
    fn receive(&mut self, frame: &[u8]) -> bool {
        self.brain.receive(self.now_us, frame);
        self.is_done_said()
    }

    fn is_done_said(&mut self) -> bool {
        let (mut decoder, mut bytes) = (Decoder::new(), [0; 640]);
        let len = self.brain.transmit(&mut bytes);
        let heard = bytes[..len].iter().filter_map(|&byte| decoder.push(byte));
        heard
            .map(|received| received.message == Ok(Message::Reply(Reply::Done)))
            .fold(false, |any, done| any | done)
    }

    /// What makes two worlds the same.
    fn shape(&self, fine: bool) -> Shape {
        let brain = &self.brain;
        let state = &brain.state;
        let since = |tick: u64| (brain.tick - tick) * u64::from(TICK_US);
        let bucket = |us: u64, of: u64, parts: u64| (us * parts / of.max(1)).min(parts) as u8;
        let parts = if fine { 4 } else { 2 };
        let progress = match *state {
            State::Stopped | State::EStopped | State::Holding { .. } => 0,
            State::Starting {
                ramp, since: at, ..
            }
            | State::Stopping { ramp, since: at } => {
                bucket(since(at), u64::from(ramp.duration_us()), parts)
            }
            State::Settling { since: at } => bucket(since(at), 500_000, parts),
            State::Playing { .. } => brain.last_play.map_or(0, |play| {
                let endless = play.request.cycles == 0;
                let within = bucket(u64::from(play.in_cycle_us()), 1_000_000, parts);
                if endless {
                    within
                } else {
                    within + 8 * play.cycles_done() as u8
                }
            }),
            State::Paused { since_us, .. } => bucket(self.now_us - since_us, 60_000_000, 1),
        };
        let age = |since: Option<u64>, of: u64| {
            since.map(|since| bucket(self.now_us - since, of, if fine { 2 } else { 1 }))
        };
        let (word, resets) = (brain.resets.word(), &brain.resets);
        let aged = |shift: u32| fine && (word >> shift & 127) <= 60;
        Shape {
            state: state.name() as u8,
            cause: if fine { brain.cause as u8 } else { 0 },
            progress,
            detached: state.detached(),
            cycles: state.play().map_or(0, |play| play.request.cycles),
            at_neutral: brain.commanded.iter().all(|angle| angle.abs() < 1e-6),
            session: (
                brain.session.number() != 0,
                brain.session.silent(self.now_us),
                fine && age(brain.session.heard_us, 460_000) == Some(0),
            ),
            repeat: (self.last_moves, self.asked, brain.session.kept().is_some()),
            battery: (
                self.battery_mv,
                brain.battery.low(),
                brain.battery_stops,
                age(brain.battery.below_since, 1_000_000),
                age(brain.battery.well_since, 5_000_000),
            ),
            resets: (
                resets.estop,
                resets.wait_s().map(|left| left > 0),
                aged(17),
                aged(10),
            ),
            work: match brain.work {
                Work::Idle => 0,
                Work::Commit { .. } => 1,
                Work::Swap { .. } => 2,
                Work::Play { .. } => 3,
            },
            tables: (
                brain.tables.uploaded().map(|bytes| bytes / 16),
                // Which table was announced, and whether its bytes are those.
                (self.begun, brain.tables.complete(self.upload).is_ok()),
                brain.tables.swap().is_some(),
                brain
                    .tables
                    .active()
                    .map(|_| brain.tables.facts().is_some()),
            ),
            unsaved: (
                fine && brain.persist.unsaved(),
                !brain.persist.table_stored(),
            ),
        }
    }
}

/// What makes two worlds the same.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Shape {
    state: u8,
    cause: u8,
    progress: u8,
    detached: bool,
    cycles: u32,
    at_neutral: bool,
    session: (bool, bool, bool),
    repeat: (bool, bool, bool),
    battery: (Option<u16>, bool, bool, Option<u8>, Option<u8>),
    resets: (bool, Option<bool>, bool, bool),
    work: u8,
    tables: (Option<u16>, (u32, bool), bool, Option<bool>),
    unsaved: (bool, bool),
}

fn frame(session: u16, sequence: u16, message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_ENCODED];
    let len = encode(Header::new(session, sequence), message, &mut frame).unwrap();
    frame[..len].to_vec()
}

const OFF: [StateName; 2] = [StateName::Stopped, StateName::EStopped];

/// What no step may do.
fn judge(before: StateName, event: Event, requests: &[Request], seen: &Seen) {
    use StateName::{EStopped, Settling, Stopped, Stopping};
    let (all, after) = (&seen.states, *seen.states.last().unwrap());
    let asked = match event {
        Event::Ask(index) | Event::Late(index) | Event::Foreign(index) => Some(&requests[index]),
        _ => None,
    };
    let told = || std::format!("{before:?}, {event:?} {asked:?}: {all:?}");
    let only = |allowed: &[StateName]| all.iter().all(|state| allowed.contains(state));
    if let Some(Request::EStop) = asked {
        assert!(only(&[EStopped]), "{}", told());
    }
    if let Some(Request::Stop) = asked {
        assert!(only(&[Stopping, Settling, Stopped, EStopped]), "{}", told());
    }
    if let Event::Reset(reason) = event {
        let latched = before == EStopped && reason != ResetReason::PowerOn;
        let expected = if latched { EStopped } else { Stopped };
        assert!(only(&[expected]), "{}", told());
        return;
    }
    if seen.armed {
        // An e-stop needs its flag.
        let cleared = matches!(asked, Some(Request::Arm(arm)) if arm.clear_estop);
        assert!(before != EStopped || cleared, "{}", told());
        return;
    }
    match before {
        EStopped => assert!(only(&[EStopped]), "{}", told()),
        Stopped => assert!(only(&OFF), "{}", told()),
        Stopping | Settling => {
            assert!(only(&[Stopping, Settling, Stopped, EStopped]), "{}", told());
        }
        _ => {
            // Once a step has brought a powered robot to a stop, the same step does not take it out again.
            let stopped = all.iter().position(|state| OFF.contains(state));
            let rest = stopped.map_or(&[][..], |at| &all[at..]);
            assert!(
                rest.iter().all(|state| OFF.contains(state)),
                "{} {after:?}",
                told()
            );
        }
    }
}

fn enumerate(fine: bool) -> (usize, u64) {
    let requests = requests();
    let events = events(&requests);
    let first = World::new();
    let mut known = HashSet::from([first.shape(fine)]);
    let mut frontier = VecDeque::from([first]);
    let mut transitions = 0_u64;
    let mut reached: BTreeMap<u8, BTreeSet<u8>> = BTreeMap::new();
    let mut causes = BTreeSet::new();
    while let Some(world) = frontier.pop_front() {
        let before = world.brain.output.state;
        for &event in &events {
            let mut next = world.clone();
            let seen = next.step(event, &requests);
            judge(before, event, &requests, &seen);
            transitions += 1;
            causes.insert(next.brain.cause as u8);
            let after = next.brain.output.state as u8;
            reached.entry(before as u8).or_default().insert(after);
            if known.insert(next.shape(fine)) {
                frontier.push_back(next);
            }
        }
    }
    assert_eq!(reached.len(), 8, "not every state was reached");
    assert_eq!(causes.len(), 7, "not every cause of stopping was met");
    (known.len(), transitions)
}

#[test]
fn no_path_leads_from_a_latched_stop_to_motion_without_an_arm() {
    let (states, transitions) = enumerate(false);
    println!(
        "R6: {states} states of the brain, {transitions} transitions, to a fixed point: nothing but an arm leads out of a stop"
    );
}

#[test]
#[ignore = "minutes: part of the soak"]
fn no_path_leads_from_a_latched_stop_to_motion_without_an_arm_in_finer_steps() {
    let (states, transitions) = enumerate(true);
    println!(
        "R6: {states} states of the brain, {transitions} transitions, to a fixed point: nothing but an arm leads out of a stop"
    );
}
