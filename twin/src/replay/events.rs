//! Events of a log, assigned to the robot's ticks.

use std::collections::{BTreeMap, HashMap, HashSet};

use gait_player::TICK_US;
use link_protocol::{
    Configuration, Direction, Flags, HelloReply, Joint, Message, Received, Refusal, Reply, Request,
    ServoSettings, StateName, StopCause, Telemetry,
};
use swimmer_files::LinkFrame;

use super::arrival::{FrameCount, PingArrival, Window, windows};
use super::{BEFORE, ReplayError};

/// Longest replayed log, ticks: one day.
const MOST_TICKS: u64 = 24 * 3600 * 50;
/// Longest time without telemetry, ticks: the longest play without a host.
const LONGEST_GAP: u64 = 3600 * 50;
/// Longest time from a log's first frame to its first telemetry, ticks.
const LONGEST_START: u64 = 10 * 50;
/// Ticks before the end of a lease in which its last keep-alive was read: 460 ms, plus two ticks of the telemetry.
const LEASE: std::ops::RangeInclusive<u64> = 20..=27;
/// Upper bound of the same for a keep-alive whose arrival only the host estimates, ticks.
const LONGEST_LEASE: u64 = 50;

/// Frame whose tick must be determined: a request that starts or changes a motion, or a keep-alive that decides the end of the
/// lease.
pub(super) struct Moving {
    /// Index among all frames of the log.
    pub(super) order: usize,
    pub(super) bytes: Vec<u8>,
    /// First possible tick.
    pub(super) first: u64,
    /// Last possible tick: the reply was received then.
    pub(super) last: u64,
    /// Tick that is tried first.
    pub(super) likely: u64,
    /// The log shows that it arrived.
    pub(super) came: bool,
    pub(super) is_request: bool,
}

/// Any other sent frame.
pub(super) struct Still {
    /// Index among all frames of the log.
    pub(super) order: usize,
    pub(super) bytes: Vec<u8>,
    /// Possible ticks.
    pub(super) window: Window,
    /// First tick after it was sent, by the host's estimate.
    pub(super) sent: u64,
}

impl Still {
    pub(super) fn tick(&self, placing: Placing) -> u64 {
        match placing {
            Placing::Early if self.window.counted => self.window.first,
            Placing::Late if self.window.counted => self.window.last,
            Placing::AsSent | Placing::Early | Placing::Late => self.window.nearest(self.sent),
        }
    }
}

/// Tick within its window at which a still frame is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Placing {
    AsSent,
    Early,
    Late,
}

/// Log on the robot's ticks. Tick 0 is the first simulated one.
pub(super) struct Events {
    pub(super) hello: HelloReply,
    pub(super) moving: Vec<Moving>,
    pub(super) still: Vec<Still>,
    pub(super) telemetry: BTreeMap<u64, Telemetry>,
    pub(super) last_tick: u64,
    /// Robot time one period before tick 0, µs.
    pub(super) origin_us: u64,
    pub(super) configuration: Option<Configuration>,
    pub(super) servos: [Option<ServoSettings>; 2],
    pub(super) battery_at_start: Option<u16>,
    pub(super) state_at_start: StateName,
    pub(super) passive_at_start: Option<Joint>,
    pub(super) table_at_start: Option<u32>,
    /// First ticks of the windows that are not determined by the robot's counts, in order.
    pub(super) uncertain: Vec<u64>,
    /// The robot restarted later in the log.
    pub(super) restarted: bool,
}

/// Frame with its decoded message, at a time of the robot's clock \[µs\].
struct Read<'a> {
    frame: &'a LinkFrame,
    at_us: f64,
    received: Received,
}

impl Events {
    pub(super) fn read(frames: &[LinkFrame]) -> Result<Self, ReplayError> {
        let read = on_the_robots_clock(frames)?;
        let greeted = read.iter().enumerate().find_map(|(index, read)| {
            match (read.frame.direction, &read.received.message) {
                (Direction::ToHost, Ok(Message::HelloReply(hello))) => Some((index, *hello)),
                _ => None,
            }
        });
        let (greeting, hello) = greeted.ok_or(ReplayError::NoGreeting)?;
        let whole = read.len();
        let read = until_restart(read, greeting, &hello);
        let restarted = read.len() < whole;
        // Telemetry before the greeting belongs to another session.
        let messages: Vec<Telemetry> = telemetry(&read, greeting).copied().collect();
        let first = messages.first().ok_or(ReplayError::NoTelemetry)?;
        let start = AtStart::of(&read, greeting).unwrap_or_else(|| first.into());
        if !matches!(start.state, StateName::Stopped | StateName::EStopped)
            || start.setpoint != [0; 2]
        {
            return Err(ReplayError::NotAtRest(start.state));
        }
        let clock = Ticks::new(first.robot_us, read.iter().map(|read| read.at_us));
        let telemetry: BTreeMap<u64, Telemetry> = messages
            .iter()
            .map(|telemetry| (clock.at(telemetry.robot_us), *telemetry))
            .collect();
        let last_tick = telemetry.keys().next_back().copied().unwrap_or_default();
        check_span(&telemetry, last_tick)?;
        let Sent {
            moving,
            still,
            uncertain,
        } = sent(&read, &clock, &telemetry, last_tick);
        let facts = Facts::of(&read);
        Ok(Self {
            hello,
            moving,
            still,
            last_tick,
            uncertain,
            restarted,
            origin_us: clock.origin_us,
            configuration: facts.configuration,
            servos: facts.servos,
            battery_at_start: first.battery_mv,
            state_at_start: start.state,
            passive_at_start: start.flags.passive(),
            table_at_start: facts.table,
            telemetry,
        })
    }

    /// Robot time from the first to the last telemetry, s.
    pub(super) fn seconds(&self) -> f64 {
        let first = self.telemetry.keys().next().copied().unwrap_or_default();
        (self.last_tick - first) as f64 * f64::from(TICK_US) * 1e-6
    }
}

fn telemetry<'a>(read: &'a [Read<'_>], from: usize) -> impl Iterator<Item = &'a Telemetry> {
    read.iter()
        .skip(from)
        .filter(|read| read.frame.direction == Direction::ToHost)
        .filter_map(|read| match &read.received.message {
            Ok(Message::Telemetry(telemetry)) => Some(telemetry),
            _ => None,
        })
}

/// Log up to a restart of the robot: a greeting with another boot nonce, or a clock that goes back.
fn until_restart<'a>(
    mut read: Vec<Read<'a>>,
    greeting: usize,
    hello: &HelloReply,
) -> Vec<Read<'a>> {
    /// Delayed telemetry does not count as a restart.
    const OVERTAKEN_US: u64 = 1_000_000;
    let mut latest_us = 0;
    let restart = read.iter().skip(greeting).position(|read| {
        match (read.frame.direction, &read.received.message) {
            (Direction::ToHost, Ok(Message::HelloReply(again))) => {
                again.boot_nonce != hello.boot_nonce
            }
            (Direction::ToHost, Ok(Message::Telemetry(telemetry))) => {
                latest_us = latest_us.max(telemetry.robot_us);
                telemetry.robot_us.saturating_add(OVERTAKEN_US) < latest_us
            }
            _ => false,
        }
    });
    if let Some(restart) = restart {
        read.truncate(greeting + restart);
    }
    read
}

/// Refuses logs with implausible telemetry times, because each tick between them would be simulated.
fn check_span(telemetry: &BTreeMap<u64, Telemetry>, last_tick: u64) -> Result<(), ReplayError> {
    if last_tick > MOST_TICKS {
        return Err(ReplayError::TooLong);
    }
    let ticks = telemetry.keys().zip(telemetry.keys().skip(1));
    match ticks.clone().find(|(one, next)| *next - *one > LONGEST_GAP) {
        Some((one, _)) => Err(ReplayError::Gap {
            robot_us: telemetry.get(one).map_or(0, |telemetry| telemetry.robot_us),
        }),
        None => Ok(()),
    }
}

/// Report of the robot at the start of the log: its first after the greeting, requested or not.
struct AtStart {
    state: StateName,
    setpoint: [i16; 2],
    flags: Flags,
}

impl From<&Telemetry> for AtStart {
    fn from(telemetry: &Telemetry) -> Self {
        Self {
            state: telemetry.state,
            setpoint: telemetry.setpoint,
            flags: telemetry.flags,
        }
    }
}

impl AtStart {
    fn of(read: &[Read<'_>], greeting: usize) -> Option<Self> {
        let mut received = read
            .iter()
            .skip(greeting)
            .filter(|read| read.frame.direction == Direction::ToHost);
        received.find_map(|read| match &read.received.message {
            Ok(Message::Reply(Reply::Status(status))) => Some(Self {
                state: status.state,
                setpoint: status.setpoint,
                flags: status.flags,
            }),
            Ok(Message::Telemetry(telemetry)) => Some(telemetry.into()),
            _ => None,
        })
    }
}

/// Grid of the robot's servo periods, from shortly before the log.
struct Ticks {
    origin_us: u64,
}

impl Ticks {
    /// Telemetry is sent on even ticks since the start, and `first_us` was one of them.
    fn new(first_us: u64, times: impl Iterator<Item = f64>) -> Self {
        let tick = u64::from(TICK_US);
        let earliest = times.fold(first_us as f64, f64::min).max(0.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative
        let before = first_us.saturating_sub(earliest as u64) / tick;
        let before = before.min(LONGEST_START) + BEFORE;
        // The brain counts its first tick as number 1, so the first telemetry comes an odd number of ticks later.
        let before = before | 1;
        Self {
            origin_us: first_us.wrapping_sub(before * tick),
        }
    }

    /// Tick at a time of the robot's clock.
    fn at(&self, robot_us: u64) -> u64 {
        let tick = i128::from(TICK_US);
        // The origin may be before the robot's start.
        let since = i128::from(robot_us) - i128::from(self.origin_us.cast_signed());
        u64::try_from((since.max(0) + tick / 2) / tick).unwrap_or(u64::MAX)
    }

    /// First tick after a time of the robot's clock.
    fn after(&self, at_us: f64) -> u64 {
        let ticks = (at_us - self.origin_us.cast_signed() as f64) / f64::from(TICK_US);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates at 0
        let ticks = ticks.ceil().max(0.0) as u64;
        ticks
    }
}

/// Assigns robot times to all valid frames: by the log's own estimate, and before the first reply to a ping by that ping.
fn on_the_robots_clock(frames: &[LinkFrame]) -> Result<Vec<Read<'_>>, ReplayError> {
    let host_us = |frame: &LinkFrame| frame.host_time_ns as f64 * 1e-3;
    let known = frames.iter().find_map(|frame| {
        let robot_us = frame.robot_time_us?;
        let pong = matches!(frame.received()?.message, Ok(Message::Pong(_)));
        pong.then(|| robot_us as f64 - host_us(frame))
    });
    let turned_away = || {
        frames
            .iter()
            .filter_map(LinkFrame::received)
            .any(|received| {
                matches!(
                    received.message,
                    Ok(Message::Reply(Reply::Refused(
                        Refusal::KeyNeeded | Refusal::WrongKey
                    )))
                )
            })
    };
    let offset = known.ok_or_else(|| {
        if turned_away() {
            ReplayError::TurnedAway
        } else {
            ReplayError::NoClock
        }
    })?;
    Ok(frames
        .iter()
        .filter_map(|frame| {
            Some(Read {
                at_us: frame
                    .robot_time_us
                    .map_or_else(|| host_us(frame) + offset, |robot_us| robot_us as f64),
                received: frame.received()?,
                frame,
            })
        })
        .collect())
}

/// Frames that were sent.
struct Sent {
    moving: Vec<Moving>,
    still: Vec<Still>,
    uncertain: Vec<u64>,
}

/// Splits the sent frames into those whose tick must be determined, each once, and the rest.
fn sent(read: &[Read<'_>], clock: &Ticks, telemetry: &BTreeMap<u64, Telemetry>, end: u64) -> Sent {
    let answers = answers(read);
    let windows = arrivals(read, clock, telemetry, end);
    let ends = lease_ends(telemetry);
    let mut sent = Sent {
        moving: Vec::new(),
        still: Vec::new(),
        uncertain: Vec::new(),
    };
    let mut seen = HashSet::new();
    let frames = read
        .iter()
        .enumerate()
        .filter(|(_, read)| read.frame.direction == Direction::ToRobot);
    for ((order, read), window) in frames.zip(windows) {
        // Nothing is compared after the last telemetry.
        let after = clock.after(read.at_us).min(end + 1);
        let header = read.received.header;
        let is_request =
            matches!(&read.received.message, Ok(Message::Request(request)) if moves(request));
        let (from, to) = if window.counted {
            (window.first + LEASE.start(), window.last + LEASE.end())
        } else {
            (after, after + LONGEST_LEASE)
        };
        let ends_lease = matches!(read.received.message, Ok(Message::Heartbeat(_)))
            && ends
                .get(ends.partition_point(|end| *end < from))
                .is_some_and(|end| *end <= to);
        let bytes = read.frame.bytes.clone();
        if matches!(
            read.received.message,
            Ok(Message::Request(Request::SetKey(_)))
        ) {
            // The key is not in the log. A brain without a key skips the signatures.
            continue;
        }
        if !window.counted {
            sent.uncertain.push(window.nearest(after));
        }
        if ends_lease {
            sent.moving.push(Moving {
                order,
                bytes,
                first: window.first,
                last: window.last,
                likely: window.nearest(after),
                came: window.counted,
                is_request: false,
            });
        } else if !is_request {
            sent.still.push(Still {
                order,
                bytes,
                window,
                sent: after,
            });
        } else if seen.insert((header.session, header.sequence)) {
            let answer = answers.get(&(header.session, header.sequence));
            let (first, last) = if window.counted {
                (window.first, window.last)
            } else {
                let last = answer.map_or(end, |at_us| clock.after(*at_us).min(end + 1));
                (after, last.max(after))
            };
            sent.moving.push(Moving {
                order,
                bytes,
                first,
                last,
                likely: after.clamp(first, last),
                came: answer.is_some(),
                is_request: true,
            });
        }
    }
    sent.uncertain.sort_unstable();
    sent
}

/// Time of the first reply to each request, on the robot's clock.
fn answers(read: &[Read<'_>]) -> HashMap<(u16, u16), f64> {
    read.iter()
        .rev()
        .filter(|read| read.frame.direction == Direction::ToHost)
        .filter(|read| {
            matches!(&read.received.message, Ok(Message::Reply(reply)) if !matches!(reply, Reply::Working))
        })
        // In reverse order, so that the first reply remains.
        .map(|read| {
            let header = read.received.header;
            ((header.session, header.sequence), read.at_us)
        })
        .collect()
}

fn arrivals(
    read: &[Read<'_>],
    clock: &Ticks,
    telemetry: &BTreeMap<u64, Telemetry>,
    end: u64,
) -> Vec<Window> {
    let received: HashMap<u64, u64> = read
        .iter()
        .filter_map(|read| match &read.received.message {
            Ok(Message::Pong(pong)) => Some((pong.host_us, pong.received_us)),
            _ => None,
        })
        .collect();
    let frames = || {
        read.iter()
            .filter(|read| read.frame.direction == Direction::ToRobot)
    };
    let pings: Vec<PingArrival> = frames()
        .enumerate()
        .filter_map(|(index, read)| match &read.received.message {
            Ok(Message::Heartbeat(beat)) => Some(PingArrival {
                index,
                tick: received
                    .get(&beat.host_us)
                    .map(|received_us| clock.after(*received_us as f64)),
            }),
            _ => None,
        })
        .collect();
    let counts: Vec<FrameCount> = telemetry
        .iter()
        .map(|(tick, telemetry)| FrameCount {
            tick: *tick,
            frames_ok: telemetry.frames_ok,
        })
        .collect();
    let sent: Vec<u64> = frames()
        .map(|read| clock.after(read.at_us).min(end + 1))
        .collect();
    windows(&sent, &pings, &counts, end)
}

/// Ticks of the telemetry that first reports each loss of the link.
fn lease_ends(telemetry: &BTreeMap<u64, Telemetry>) -> Vec<u64> {
    let stops = |telemetry: &Telemetry| {
        matches!(telemetry.state, StateName::Stopping | StateName::Settling)
            && telemetry.cause == StopCause::LinkLost
    };
    telemetry
        .iter()
        .zip(telemetry.values().skip(1))
        .zip(telemetry.keys().skip(1))
        .filter(|(((_, before), after), _)| !stops(before) && stops(after))
        .map(|(_, tick)| *tick)
        .collect()
}

fn moves(request: &Request) -> bool {
    match request {
        Request::Configure(_)
        | Request::SetServo { .. }
        | Request::SetPulseRange { .. }
        | Request::SetPassive(_)
        | Request::Trim { .. }
        | Request::Commit { .. }
        | Request::Follow(_)
        | Request::ClearEStop { .. }
        | Request::Arm
        | Request::Play(_)
        | Request::Pause { .. }
        | Request::Resume
        | Request::Stop
        | Request::EStop => true,
        Request::Status
        | Request::Counters
        | Request::Configuration
        | Request::Servo(_)
        | Request::Begin(_)
        | Request::Chunk(_)
        | Request::ClearResets
        | Request::CrashMessage
        | Request::SetKey(_)
        | Request::Bench
        | Request::PulseRange(_)
        | Request::EnterBootLoader
        | Request::Table => false,
    }
}

/// Settings that the robot reported before any change.
#[derive(Default)]
struct Facts {
    configuration: Option<Configuration>,
    servos: [Option<ServoSettings>; 2],
    table: Option<u32>,
}

impl Facts {
    fn of(read: &[Read<'_>]) -> Self {
        let mut facts = Self::default();
        let mut asked = HashMap::new();
        for Read {
            frame, received, ..
        } in read
        {
            let number = received.header.sequence;
            match (frame.direction, &received.message) {
                (
                    Direction::ToRobot,
                    Ok(Message::Request(
                        Request::Configure(_)
                        | Request::SetServo { .. }
                        | Request::Trim { .. }
                        | Request::Commit { .. },
                    )),
                ) => break,
                (Direction::ToRobot, Ok(Message::Request(Request::Play(play)))) => {
                    facts.table = facts.table.or(Some(play.checked.table_crc32));
                }
                (Direction::ToRobot, Ok(Message::Request(Request::Servo(joint)))) => {
                    asked.insert(number, *joint);
                }
                (Direction::ToHost, Ok(Message::Reply(reply))) => match reply {
                    Reply::Configuration(configuration) => {
                        facts.configuration.get_or_insert(*configuration);
                    }
                    Reply::Servo(settings) => match asked.get(&number) {
                        Some(Joint::Front) => facts.servos[0] = Some(*settings),
                        Some(Joint::Back) => facts.servos[1] = Some(*settings),
                        None => {}
                    },
                    Reply::Status(status) => {
                        facts.table = facts.table.or(status.table.map(|table| table.crc32));
                    }
                    Reply::Table(table) => {
                        facts.table = facts.table.or(table.map(|table| table.crc32));
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        facts
    }
}
