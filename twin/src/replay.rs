//! Replay of a link log: a new brain receives the host's frames at the robot's times, and its telemetry is compared with the
//! robot's. Equal set-points and pulses show that they depend only on the frames and the clock.
//!
//! A log has the time at which a frame left the host, not the tick in which the robot read it. The robot's counts of frames
//! bound that tick (`arrival`). Some frames move the robot (arm, play, pause, stop, commit, …), or decide the end of the lease
//! (the last keep-alive). For these, a clone of the brain tries each tick within the bounds, and the tick that fits the
//! telemetry until the next such frame is used. Every other frame (keep-alives, chunks, queries) is read within its bounds.
//!
//! If the brain differs, and the log does not show when the preceding frames arrived, or has too little to compare, the verdict
//! is [`Verdict::Undecided`].
//!
//! A signed log needs no key: the new brain has none, and skips the signatures of accepted frames.

mod arrival;
mod events;

use gait_player::storage::MemoryStorage;
use gait_player::{
    Boot, Brain, BrainConfig, GaitTable, Identity, Inputs, Limits, TICK_US, Transport,
};
use link_protocol::{
    Begin, Chunk, Configuration, Decoder, Header, Heartbeat, Hello, HelloReply, MAX_CHUNK,
    MAX_ENCODED, Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Request, SCHEMA_KEY, StateName,
    Telemetry, crc32c, encode,
};
use swimmer_files::LinkFrame;

use events::{Events, Moving, Placing};

/// Reason why a log cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The log contains no session.
    #[error(
        "the log holds no greeting that was answered, so no session to replay; record with --log from the start of a command"
    )]
    NoGreeting,
    /// The log contains no telemetry.
    #[error("the log holds no telemetry to compare with; record for longer than a second")]
    NoTelemetry,
    /// The relation of the two clocks is unknown.
    #[error(
        "the log holds no ping that came back, so the robot's clock is not known; record for longer than a second"
    )]
    NoClock,
    /// The robot has a key that the host did not have.
    #[error(
        "the robot turned the log's host away: it has a key that this host did not sign with, so nothing moved it and there is nothing to replay; record with --key FILE"
    )]
    TurnedAway,
    /// The robot was moving when the log began.
    #[error(
        "the log begins while the robot is {0:?}; only a log that begins at rest at neutral can be replayed"
    )]
    NotAtRest(StateName),
    /// The telemetry spans more than a day.
    #[error(
        "the log's telemetry spans more than 24 hours of the robot's clock; replay takes logs of a day at most, so record each session into a log of its own"
    )]
    TooLong,
    /// Telemetry is missing for longer than the longest detached play.
    #[error(
        "the log holds no telemetry for more than an hour after {:.1} s of the robot's clock, so nothing links what follows to what came before; record each session into a log of its own",
        *robot_us as f64 / 1e6
    )]
    Gap {
        /// Robot time of the last telemetry before the gap, µs.
        robot_us: u64,
    },
}

/// Result of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All telemetry is equal.
    Same,
    /// The brain behaves differently from the robot.
    Differs,
    /// The log does not contain enough to decide.
    Undecided(Reason),
}

/// Reason why a comparison is undecided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// No telemetry could be compared.
    NothingCompared,
    /// The robot held a gait that the log does not upload; its CRC.
    MissingTable(u32),
    /// A play refers to settings that the log does not contain; their hash.
    OtherSettings(u32),
    /// Frames were lost shortly before the first difference, so their arrival is unknown.
    LostFrames,
    /// More ticks fit the log than were tried.
    TooManyTicks,
}

/// Comparison of a log with the brain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replayed {
    /// Number of compared telemetry frames.
    pub compared: usize,
    /// Number of those that differ in state, set-point or pulses.
    pub different: usize,
    /// Requests that moved the robot.
    pub requests: usize,
    /// First difference.
    pub first: Option<Difference>,
    /// Robot time from the first to the last comparison, s.
    pub seconds: f64,
    /// CRC of the table that the robot held at the start and the replay did not; pass that table, or expect a refusal.
    pub missing_table: Option<u32>,
    /// Hash of the settings that a play of the log refers to, if the replay has others: the log does not contain all settings
    /// of the robot.
    pub other_settings: Option<u32>,
    /// The robot restarted later in the log; the comparison ends there.
    pub restarted: bool,
    /// Result of the comparison.
    pub verdict: Verdict,
}

/// Telemetry of robot and brain at the same tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Telemetry of the robot.
    pub logged: Telemetry,
    /// Telemetry of the brain; `None` if it sent none.
    pub replayed: Option<Telemetry>,
}

/// Transport of the replay: over USB every request that the robot granted is granted again.
const VIA: Transport = Transport::Usb;
/// Number of simulated ticks before the log begins.
const BEFORE: u64 = 10;
/// Extra ticks on both sides of the window in which a request may have been read.
const SLACK: u64 = 1;
/// Ticks of telemetry that decide between two candidate ticks.
const HORIZON: u64 = 150;
/// Most candidate ticks for one request.
const MOST_TRIED: u64 = 100;
/// Most simulated ticks for trials: less than a minute of one core.
const MOST_WORK: u64 = 10_000_000;
/// Ticks before a difference in which a frame of unknown arrival may be its cause: the lease, and the work on a request.
const BEARING: u64 = 100;

/// Replays a log. `table` is the robot's gait at the start, if the log does not upload it.
///
/// # Errors
/// [`ReplayError`].
///
/// ```
/// use twin::{ReplayError, replay};
///
/// assert_eq!(replay(&[], None).unwrap_err(), ReplayError::NoClock);
/// ```
pub fn replay(frames: &[LinkFrame], table: Option<&GaitTable>) -> Result<Replayed, ReplayError> {
    let events = Events::read(frames)?;
    let missing_table = events
        .table_at_start
        .filter(|crc32| table.is_none_or(|table| crc32c(table.bytes()) != *crc32));
    let mut search = Search { left: MOST_WORK };
    // The last keep-alive determines the end of the lease, but the log shows its tick only within two ticks.
    let mut best: Option<Attempt> = None;
    for placing in [Placing::AsSent, Placing::Early, Placing::Late] {
        let attempt = attempt(&events, table, placing, &mut search);
        let fits = attempt.count.different == 0;
        if best.is_none_or(|best| attempt.count.different < best.count.different) {
            best = Some(attempt);
        }
        if fits || missing_table.is_some() {
            break;
        }
    }
    let Attempt {
        count,
        cut_short,
        other_settings,
    } = best.unwrap_or_default();
    Ok(Replayed {
        compared: count.compared,
        different: count.different,
        requests: events
            .moving
            .iter()
            .filter(|moving| moving.is_request)
            .count(),
        first: count.first,
        seconds: events.seconds(),
        other_settings,
        missing_table,
        restarted: events.restarted,
        verdict: verdict(
            &events,
            &count,
            cut_short,
            missing_table
                .map(Reason::MissingTable)
                .or(other_settings.map(Reason::OtherSettings)),
        ),
    })
}

fn verdict(
    events: &Events,
    count: &Count,
    cut_short: Option<u64>,
    missing: Option<Reason>,
) -> Verdict {
    if count.compared == 0 {
        return Verdict::Undecided(Reason::NothingCompared);
    }
    let Some(at) = count.first_tick else {
        return Verdict::Same;
    };
    if let Some(reason) = missing {
        return Verdict::Undecided(reason);
    }
    if cut_short.is_some_and(|tick| tick <= at) {
        return Verdict::Undecided(Reason::TooManyTicks);
    }
    let later = events
        .uncertain
        .partition_point(|tick| *tick + BEARING < at);
    match events.uncertain.get(later) {
        Some(tick) if *tick <= at => Verdict::Undecided(Reason::LostFrames),
        _ => Verdict::Differs,
    }
}

/// Remaining budget of trial ticks.
struct Search {
    left: u64,
}

/// Complete run of the brain.
#[derive(Clone, Copy, Default)]
struct Attempt {
    count: Count,
    /// First tick at which some fitting candidates were not tried.
    cut_short: Option<u64>,
    /// Same as [`Replayed::other_settings`].
    other_settings: Option<u32>,
}

fn attempt(
    events: &Events,
    table: Option<&GaitTable>,
    placing: Placing,
    search: &mut Search,
) -> Attempt {
    let mut life = Life::new(events, table, placing);
    let mut done = Attempt::default();
    for (index, moving) in events.moving.iter().enumerate() {
        let next = events.moving.get(index + 1);
        let until = next.map_or(u64::MAX, |next| next.first);
        let choice = life.choose(events, moving, until, &mut done.count, search);
        if choice.cut_short {
            done.cut_short.get_or_insert(life.tick);
        }
        if let Some(tick) = choice.tick {
            life.act(events, moving, tick, &mut done.count);
        }
    }
    life.run(events, events.last_tick + 1, usize::MAX, &mut done.count);
    done.other_settings = life.other_settings;
    done
}

#[derive(Clone, Copy, Default)]
struct Count {
    compared: usize,
    different: usize,
    first: Option<Difference>,
    first_tick: Option<u64>,
}

/// Brain between two ticks.
#[derive(Clone)]
struct Life {
    brain: Brain,
    flash: MemoryStorage,
    decoder: Decoder,
    /// Robot time one period before tick 0, µs.
    origin_us: u64,
    /// Next tick to simulate.
    tick: u64,
    /// Index of the next still frame.
    still: usize,
    placing: Placing,
    /// The brain has sent telemetry.
    greeted: bool,
    battery_mv: Option<u16>,
    /// Hash of the settings that a play refers to and this brain does not have.
    other_settings: Option<u32>,
}

impl Life {
    /// Returns a robot after power-on in the state at the start of the log.
    fn new(events: &Events, table: Option<&GaitTable>, placing: Placing) -> Self {
        let mut flash = table.map_or_else(MemoryStorage::erased, |table| stored(table, events));
        let mut brain = brain(events, events.hello.session);
        let Ok(()) = brain.load(&mut flash);
        let mut life = Self {
            brain,
            flash,
            decoder: Decoder::new(),
            origin_us: events.origin_us,
            tick: 0,
            still: 0,
            placing,
            greeted: false,
            battery_mv: events.battery_at_start,
            other_settings: None,
        };
        if events.state_at_start == StateName::EStopped {
            life.receive(&frame(0, 0, &Message::Request(Request::EStop)));
        }
        life
    }

    /// Receives bytes midway between two ticks.
    fn receive(&mut self, bytes: &[u8]) {
        let now = time_of(self.tick) - u64::from(TICK_US) / 2;
        let bytes = on_this_clock(bytes, now, self.origin_us);
        let bytes = self.as_held_here(bytes);
        self.brain.receive(now, VIA, &bytes);
    }

    /// Replaces values in a frame that depend on the robot's history. A play with other settings than this brain's uses the
    /// brain's, and the difference is reported. A clear of e-stops uses this brain's count, because the log may lack some.
    fn as_held_here(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        let mut decoder = Decoder::new();
        let Some(mut received) = bytes.iter().find_map(|&byte| decoder.push(byte)) else {
            return bytes;
        };
        let checked = match &mut received.message {
            Ok(Message::Request(Request::Play(play))) => &mut play.checked,
            Ok(Message::Request(Request::Follow(follow))) => &mut follow.checked,
            Ok(Message::Request(Request::ClearEStop { .. })) => {
                let count = self.brain.estops();
                let clear = Message::Request(Request::ClearEStop { count });
                return frame(received.header.session, received.header.sequence, &clear);
            }
            _ => return bytes,
        };
        let settings = self.brain.held().settings_crc32;
        if checked.settings_crc32 == settings {
            return bytes;
        }
        self.other_settings.get_or_insert(checked.settings_crc32);
        checked.settings_crc32 = settings;
        let Ok(message) = received.message else {
            return bytes;
        };
        frame(received.header.session, received.header.sequence, &message)
    }

    /// Runs until a request is read just before a tick. The line preserves the order: earlier frames are read first.
    fn act(&mut self, events: &Events, moving: &Moving, tick: u64, count: &mut Count) {
        self.run(events, tick, moving.order, count);
        self.hear(events, u64::MAX, moving.order);
        self.receive(&moving.bytes);
    }

    /// Reads the still frames that are due by a tick and were sent before the frame of this order.
    fn hear(&mut self, events: &Events, by: u64, before: usize) {
        while let Some(still) = events.still.get(self.still)
            && still.tick(self.placing) <= by
            && still.order < before
        {
            self.receive(&still.bytes);
            self.still += 1;
        }
    }

    /// Runs until just before a tick, and compares telemetry.
    fn run(&mut self, events: &Events, until: u64, before: usize, count: &mut Count) {
        while self.tick < until {
            self.hear(events, self.tick, before);
            let live = self.live();
            let Some(logged) = events.telemetry.get(&(self.tick - 1)) else {
                continue;
            };
            self.battery_mv = logged.battery_mv;
            // The greeting may be read a tick later here than by the robot; until then no telemetry is sent.
            self.greeted |= live.is_some();
            if !self.greeted {
                continue;
            }
            count.compared += 1;
            if live.is_none_or(|live| !same(&live, logged)) {
                count.different += 1;
                count.first_tick.get_or_insert(self.tick - 1);
                count.first.get_or_insert(Difference {
                    logged: *logged,
                    replayed: live,
                });
            }
        }
    }

    /// Runs one tick; returns its telemetry.
    fn live(&mut self) -> Option<Telemetry> {
        let now = time_of(self.tick);
        let inputs = Inputs {
            battery_mv: self.battery_mv,
            usb_up: true,
            ..Inputs::default()
        };
        let output = self.brain.tick(now, &inputs);
        if output.storage_wanted {
            let Ok(()) = self.brain.serve_storage(now, &mut self.flash);
        }
        self.tick += 1;
        let mut live = None;
        let mut bytes = [0; MAX_ENCODED];
        loop {
            let length = self.brain.transmit(VIA, &mut bytes);
            if length == 0 {
                return live;
            }
            for &byte in bytes.get(..length).unwrap_or_default() {
                if let Some(received) = self.decoder.push(byte)
                    && let Ok(Message::Telemetry(telemetry)) = received.message
                {
                    live = Some(telemetry);
                }
            }
        }
    }

    /// Finds the tick before which a frame was read: the tick within its window that best fits the later telemetry.
    fn choose(
        &mut self,
        events: &Events,
        moving: &Moving,
        next: u64,
        count: &mut Count,
        search: &mut Search,
    ) -> Choice {
        let first = moving.first.saturating_sub(SLACK).max(self.tick);
        let wanted = (moving.last + SLACK).max(first);
        let last = wanted.min(first + MOST_TRIED);
        if first > events.last_tick {
            // No telemetry follows.
            return Choice {
                tick: None,
                cut_short: false,
            };
        }
        // All trials are equal up to there.
        self.run(events, first, moving.order, count);
        let horizon = if moving.is_request {
            next.clamp(last + 2, last + HORIZON)
        } else {
            last + HORIZON / 2
        };
        let mut candidates: Vec<Option<u64>> = (first..=last).map(Some).collect();
        candidates.sort_by_key(|tick| tick.map(|tick| tick.abs_diff(moving.likely)));
        if !moving.came {
            candidates.push(None);
        }
        let mut best: Option<(usize, Option<u64>)> = None;
        let mut cut_short = last < wanted;
        for tick in candidates {
            let cost = horizon - first;
            if search.left < cost {
                cut_short = true;
                break;
            }
            search.left -= cost;
            let different = self.misfit(events, moving, tick, horizon);
            if best.is_none_or(|(least, _)| different < least) {
                best = Some((different, tick));
            }
            if different == 0 {
                break;
            }
        }
        let likely = Some(moving.likely.clamp(first, last));
        Choice {
            tick: best.map_or(likely, |(_, tick)| tick),
            cut_short: cut_short && best.is_none_or(|(different, _)| different > 0),
        }
    }

    /// Number of differing telemetry frames until `horizon` if a frame is read just before a tick, or never.
    fn misfit(&self, events: &Events, moving: &Moving, tick: Option<u64>, horizon: u64) -> usize {
        let (mut life, mut count) = (self.clone(), Count::default());
        if let Some(tick) = tick {
            life.act(events, moving, tick, &mut count);
        }
        life.run(events, horizon, usize::MAX, &mut count);
        count.different
    }
}

/// Tick before which a frame was read; `None` if it never arrived.
struct Choice {
    tick: Option<u64>,
    /// Some candidates were not tried, and none of the tried ones fits the telemetry.
    cut_short: bool,
}

/// Clock of the brain at a tick, µs: its first tick is one period after its start.
fn time_of(tick: u64) -> u64 {
    (tick + 1) * u64::from(TICK_US)
}

/// Sent bytes, with the times of keep-alives converted to this brain's clock, so that their freshness is the same.
fn on_this_clock(bytes: &[u8], now_us: u64, origin_us: u64) -> Vec<u8> {
    let mut decoder = Decoder::new();
    let Some(received) = bytes.iter().find_map(|&byte| decoder.push(byte)) else {
        return bytes.to_vec();
    };
    let Header {
        session, sequence, ..
    } = received.header;
    let heartbeat = |heard_us| {
        let heartbeat = Heartbeat {
            host_us: 0,
            heard_us,
        };
        frame(session, sequence, &Message::Heartbeat(heartbeat))
    };
    match received.message {
        // Its host had not received the robot yet.
        Ok(Message::Heartbeat(live)) if live.heard_us == 0 => heartbeat(0),
        Ok(Message::Heartbeat(live)) => {
            // Frames are read here midway in a tick; a later time within it counts as the present one.
            let heard_us = live.heard_us.wrapping_sub(origin_us);
            let heard_us = heard_us.wrapping_add(u64::from(TICK_US));
            let ahead = heard_us.wrapping_sub(now_us) <= 2 * u64::from(TICK_US);
            heartbeat(if ahead { now_us } else { heard_us })
        }
        _ => bytes.to_vec(),
    }
}

/// Compares the values that affect the tank, and during a play its progress (earlier telemetry still reports the play before
/// the log).
fn same(one: &Telemetry, other: &Telemetry) -> bool {
    let seen = |telemetry: &Telemetry| {
        let playing = matches!(
            telemetry.state,
            StateName::Starting | StateName::Playing | StateName::Paused
        );
        (
            telemetry.state,
            telemetry.setpoint,
            telemetry.pulse_ns,
            playing.then_some((telemetry.cycle, telemetry.phase)),
        )
    };
    seen(one) == seen(other)
}

/// Returns a brain like the robot's, whose first session has this number.
fn brain(events: &Events, session: u16) -> Brain {
    let HelloReply {
        firmware,
        board,
        reset_reason: _,
        limits,
        buffer,
        ..
    } = events.hello;
    let mut config = BrainConfig::robot(
        Identity { firmware, board },
        Boot::power_on(events.hello.boot_nonce, session),
    );
    config.limits = Limits {
        max_angle: limits.max_angle.max(Limits::ROBOT.max_angle),
        max_rate: limits.max_rate.max(Limits::ROBOT.max_rate),
        pulse_min_ns: limits.pulse_min_ns,
        pulse_max_ns: limits.pulse_max_ns,
        ..Limits::ROBOT
    };
    // A robot does not report the servo type for which it was built: the paper's servos are assumed, or those that were set up.
    let live = events.servos.iter().flatten().next();
    if let Some(servo) = live
        && !(config.limits.allows_centre(servo.centre_ns)
            && config.limits.allows_slope(servo.slope_rad_per_us))
    {
        config.limits.centre_ns = servo.centre_ns;
        config.limits.slope_rad_per_us = servo.slope_rad_per_us;
    }
    config.buffer = buffer;
    config.configuration = events.configuration.unwrap_or(Configuration {
        max_angle: limits.max_angle,
        max_rate: limits.max_rate,
        ..config.configuration
    });
    config.passive = events.passive_at_start;
    for (place, live) in config.servos.iter_mut().zip(events.servos) {
        if let Some(settings) = live {
            *place = settings;
        }
    }
    Brain::new(config)
}

/// Flash in which another brain has stored this table.
fn stored(table: &GaitTable, events: &Events) -> MemoryStorage {
    let mut brain = brain(events, 1);
    let mut flash = MemoryStorage::erased();
    let bytes = table.bytes();
    let mut sequence = 0;
    let mut now: u64 = 0;
    let inputs = Inputs {
        usb_up: true,
        ..Inputs::default()
    };
    let mut ask = |brain: &mut Brain, message: &Message| {
        sequence += 1;
        brain.receive(now, VIA, &frame(1, sequence, message));
        // Checking a table takes up to a second, storing it a little longer.
        for _ in 0..100 {
            now += u64::from(TICK_US);
            let output = brain.tick(now, &inputs);
            if output.storage_wanted {
                let Ok(()) = brain.serve_storage(now, &mut flash);
            }
        }
        sequence
    };
    ask(&mut brain, &Message::Hello(greeting()));
    let length = u16::try_from(bytes.len()).unwrap_or(u16::MAX);
    let upload = ask(
        &mut brain,
        &Message::Request(Request::Begin(Begin {
            slot: 0,
            len: length,
            crc32: crc32c(bytes),
        })),
    );
    for (piece, data) in (0u16..).zip(bytes.chunks(MAX_CHUNK)) {
        let offset = piece * u16::try_from(MAX_CHUNK).unwrap_or(u16::MAX);
        let data = heapless::Vec::from_slice(data).unwrap_or_default();
        ask(
            &mut brain,
            &Message::Request(Request::Chunk(Chunk {
                upload,
                offset,
                data,
            })),
        );
    }
    ask(&mut brain, &Message::Request(Request::Commit { upload }));
    flash
}

fn frame(session: u16, sequence: u16, message: &Message) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(Header::new(session, sequence), message, &mut bytes).unwrap_or(0);
    bytes.get(..length).unwrap_or_default().to_vec()
}

fn greeting() -> Hello {
    Hello {
        protocol_min: PROTOCOL_MIN,
        protocol_current: PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        host_nonce: 1,
    }
}
