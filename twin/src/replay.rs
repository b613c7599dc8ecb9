//! A link log lived again: what the host sent goes to a fresh brain at the robot's times, and the brain's telemetry is held
//! against what the robot told. Equal set-points and pulses show that nothing but the frames and the clock decided them.
//!
//! A log knows when a frame left the host, not in which of the robot's ticks it was read. For what moves the robot (arm, play,
//! pause, stop, commit, …) each tick between the request and its answer is tried with a clone of the brain, and the one that
//! fits the telemetry until the next request is kept. Everything else (keep-alives, chunks, questions) is given to the tick
//! after it was sent.
//!
//! A signed log needs no key: the fresh brain has none, and reads past the signatures of what the robot let in.

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

use events::{Events, Moving};

/// Why a log cannot be lived again.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// There is no session in it.
    #[error(
        "the log holds no greeting that was answered, so no session to replay; record with --log from the start of a command"
    )]
    NoGreeting,
    /// The robot told nothing.
    #[error("the log holds no telemetry to compare with; record for longer than a second")]
    NoTelemetry,
    /// The two clocks were never tied.
    #[error(
        "the log holds no ping that came back, so the robot's clock is not known; record for longer than a second"
    )]
    NoClock,
    /// The robot has a key that the host did not have.
    #[error(
        "the robot turned the log's host away: it has a key that this host did not sign with, so nothing moved it and there is nothing to replay; record with --key FILE"
    )]
    TurnedAway,
    /// The robot was moving before the log began.
    #[error(
        "the log begins while the robot is {0:?}; only a log that begins at rest at neutral can be replayed"
    )]
    NotAtRest(StateName),
}

/// How a log and the brain compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replayed {
    /// Pieces of telemetry that were compared.
    pub compared: usize,
    /// Those of them in which state, set-point or pulses differ.
    pub different: usize,
    /// Requests that moved the robot.
    pub requests: usize,
    /// The first difference.
    pub first: Option<Difference>,
    /// Robot time from the first to the last comparison \[s\].
    pub seconds: f64,
    /// CRC of the table that the robot held at the start and the replay did not: name it, or expect a refusal.
    pub missing_table: Option<u32>,
    /// Hash of the settings that a play of the log names, if the replay has others: the log does not hold all that the robot
    /// was set to.
    pub other_settings: Option<u32>,
}

/// What the robot told and what the brain does at the same tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The robot's.
    pub logged: Telemetry,
    /// The brain's; `None`: it told nothing then.
    pub replayed: Option<Telemetry>,
}

/// What was granted then is granted again: over the cable nothing asks for more.
const VIA: Transport = Transport::Usb;
/// Ticks that are lived before the log begins.
const BEFORE: u64 = 10;
/// Ticks before and after the bracket of a request in which it may have been read too.
const SLACK: u64 = 1;
/// Ticks of telemetry that decide between two ticks in which a request may have been read.
const HORIZON: u64 = 150;
/// Most ticks that are tried for one request.
const MOST_TRIED: u64 = 100;

/// Lives a log again. `table` is what the robot held at the start, where the log does not upload it.
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
    let mut life = Life::new(&events, table);
    let mut counted = Count::default();
    for (index, moving) in events.moving.iter().enumerate() {
        let until = events
            .moving
            .get(index + 1)
            .map_or(u64::MAX, |next| next.first);
        let tick = life.best_tick(&events, moving, until);
        if let Some(tick) = tick {
            life.act(&events, moving, tick, &mut counted);
        }
    }
    life.run(&events, events.last_tick + 1, usize::MAX, &mut counted);
    Ok(Replayed {
        compared: counted.compared,
        different: counted.different,
        requests: events.moving.len(),
        first: counted.first,
        seconds: events.seconds(),
        missing_table: events
            .table_at_start
            .filter(|crc32| table.is_none_or(|table| crc32c(table.bytes()) != *crc32)),
        other_settings: life.other_settings,
    })
}

#[derive(Default)]
struct Count {
    compared: usize,
    different: usize,
    first: Option<Difference>,
}

/// A brain between two ticks.
#[derive(Clone)]
struct Life {
    brain: Brain,
    flash: MemoryStorage,
    decoder: Decoder,
    /// The robot's clock a period before tick 0, µs.
    origin_us: u64,
    /// The next tick to be lived.
    tick: u64,
    /// The next of the log's still frames.
    still: usize,
    /// The brain has told something.
    greeted: bool,
    battery_mv: Option<u16>,
    /// Hash of the settings that a play named, and that this brain does not have.
    other_settings: Option<u32>,
}

impl Life {
    /// A robot just switched on as the log found it.
    fn new(events: &Events, table: Option<&GaitTable>) -> Self {
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
            greeted: false,
            battery_mv: events.battery_at_start,
            other_settings: None,
        };
        if events.state_at_start == StateName::EStopped {
            life.receive(&frame(0, 0, &Message::Request(Request::EStop)));
        }
        life
    }

    /// Takes bytes in the middle between two ticks.
    fn receive(&mut self, bytes: &[u8]) {
        let now = time_of(self.tick) - u64::from(TICK_US) / 2;
        let bytes = on_this_clock(bytes, now, self.origin_us);
        let bytes = self.as_held_here(bytes);
        self.brain.receive(now, VIA, &bytes);
    }

    /// A play names the settings of the robot. If this brain has others, it plays with its own, and that is reported. A clear of
    /// e-stops names how many the robot had, of which the log may not hold all.
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

    /// Lives until a request is read just before a tick. A line keeps the order: what was sent before is read before.
    fn act(&mut self, events: &Events, moving: &Moving, tick: u64, count: &mut Count) {
        self.run(events, tick, moving.order, count);
        self.hear(events, u64::MAX, moving.order);
        self.receive(&moving.bytes);
    }

    /// Reads the still frames that are due by a tick and were sent before the frame of this order.
    fn hear(&mut self, events: &Events, by: u64, before: usize) {
        while let Some(still) = events.still.get(self.still)
            && still.tick <= by
            && still.order < before
        {
            self.receive(&still.bytes);
            self.still += 1;
        }
    }

    /// Lives until just before a tick, and compares on the way.
    fn run(&mut self, events: &Events, until: u64, before: usize, count: &mut Count) {
        while self.tick < until {
            self.hear(events, self.tick, before);
            let told = self.live();
            let Some(logged) = events.telemetry.get(&(self.tick - 1)) else {
                continue;
            };
            self.battery_mv = logged.battery_mv;
            // The greeting may be read here a tick later than it was: until then nobody is told anything.
            self.greeted |= told.is_some();
            if !self.greeted {
                continue;
            }
            count.compared += 1;
            if told.is_none_or(|told| !same(&told, logged)) {
                count.different += 1;
                count.first.get_or_insert(Difference {
                    logged: *logged,
                    replayed: told,
                });
            }
        }
    }

    /// One tick; what the brain tells in it.
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
        let mut told = None;
        let mut bytes = [0; MAX_ENCODED];
        loop {
            let length = self.brain.transmit(VIA, &mut bytes);
            if length == 0 {
                return told;
            }
            for &byte in bytes.get(..length).unwrap_or_default() {
                if let Some(received) = self.decoder.push(byte)
                    && let Ok(Message::Telemetry(telemetry)) = received.message
                {
                    told = Some(telemetry);
                }
            }
        }
    }

    /// The tick before which a request was read, by what the robot told afterwards; `None`: it was never read.
    fn best_tick(&self, events: &Events, moving: &Moving, next: u64) -> Option<u64> {
        let first = moving.first.saturating_sub(SLACK).max(self.tick);
        let last = (moving.last + SLACK).max(first).min(first + MOST_TRIED);
        let horizon = next.clamp(last + 2, last + HORIZON);
        let misfit = |read_before: Option<u64>| {
            let (mut life, mut count) = (self.clone(), Count::default());
            if let Some(tick) = read_before {
                life.act(events, moving, tick, &mut count);
            }
            life.run(events, horizon, usize::MAX, &mut count);
            count.different
        };
        let never = (!moving.answered).then_some(None);
        let candidates = (first..=last).map(Some).chain(never);
        candidates
            .map(|tick| (misfit(tick), tick))
            .min_by_key(|(different, _)| *different)
            .and_then(|(_, tick)| tick)
    }
}

/// The brain's clock at a tick: its first is one period after its start.
fn time_of(tick: u64) -> u64 {
    (tick + 1) * u64::from(TICK_US)
}

/// Bytes that were sent, with the times of keep-alives moved to this brain's clock: as fresh as they were.
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
        // Its host had heard nothing yet.
        Ok(Message::Heartbeat(told)) if told.heard_us == 0 => heartbeat(0),
        Ok(Message::Heartbeat(told)) => {
            // Frames are read here in the middle of a tick: what was heard later in it counts as heard just now.
            let heard_us = told.heard_us.wrapping_sub(origin_us);
            let heard_us = heard_us.wrapping_add(u64::from(TICK_US));
            let ahead = heard_us.wrapping_sub(now_us) <= 2 * u64::from(TICK_US);
            heartbeat(if ahead { now_us } else { heard_us })
        }
        _ => bytes.to_vec(),
    }
}

/// What the tank sees is the same; and, while a play is under way, its place in it (before, the robot still tells of the play
/// before the log).
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

/// A brain like the robot's, whose first session has this number.
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
    // A robot does not tell for which servos it was built: the paper's, or else those that it was set up with.
    let told = events.servos.iter().flatten().next();
    if let Some(servo) = told
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
    for (place, told) in config.servos.iter_mut().zip(events.servos) {
        if let Some(settings) = told {
            *place = settings;
        }
    }
    Brain::new(config)
}

/// A flash in which another brain has stored this table.
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
