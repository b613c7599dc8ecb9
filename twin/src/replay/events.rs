//! What a log tells, on the robot's ticks.

use std::collections::{BTreeMap, HashMap, HashSet};

use gait_player::TICK_US;
use link_protocol::{
    Configuration, Direction, HelloReply, Joint, Message, Received, Refusal, Reply, Request,
    ServoSettings, StateName, Telemetry,
};
use swimmer_files::LinkFrame;

use super::{BEFORE, ReplayError};

/// A request that moves the robot or changes how it moves.
pub(super) struct Moving {
    /// Its place among all frames of the log.
    pub(super) order: usize,
    pub(super) bytes: Vec<u8>,
    /// The first tick that may have seen it.
    pub(super) first: u64,
    /// The last one: its answer was heard then.
    pub(super) last: u64,
    /// It was answered; else it may never have come.
    pub(super) answered: bool,
}

/// Anything else that was sent.
pub(super) struct Still {
    /// Its place among all frames of the log.
    pub(super) order: usize,
    pub(super) bytes: Vec<u8>,
    /// The first tick that may have seen it.
    pub(super) tick: u64,
}

/// The log on the robot's ticks. Tick 0 is the first that is lived.
pub(super) struct Events {
    pub(super) hello: HelloReply,
    pub(super) moving: Vec<Moving>,
    pub(super) still: Vec<Still>,
    pub(super) telemetry: BTreeMap<u64, Telemetry>,
    pub(super) last_tick: u64,
    /// The robot's clock a period before tick 0, µs.
    pub(super) origin_us: u64,
    pub(super) configuration: Option<Configuration>,
    pub(super) servos: [Option<ServoSettings>; 2],
    pub(super) battery_at_start: Option<u16>,
    pub(super) state_at_start: StateName,
    pub(super) table_at_start: Option<u32>,
}

/// A frame with the message in it, at a time of the robot's clock \[µs\].
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
        // What was told before belongs to another session.
        let told: Vec<Telemetry> = read
            .iter()
            .skip(greeting)
            .filter(|read| read.frame.direction == Direction::ToHost)
            .filter_map(|read| match &read.received.message {
                Ok(Message::Telemetry(telemetry)) => Some(*telemetry),
                _ => None,
            })
            .collect();
        let first = told.first().ok_or(ReplayError::NoTelemetry)?;
        let (state, setpoint) = found(&read, greeting).unwrap_or((first.state, first.setpoint));
        if !matches!(state, StateName::Stopped | StateName::EStopped) || setpoint != [0; 2] {
            return Err(ReplayError::NotAtRest(state));
        }
        let clock = Ticks::new(first.robot_us, read.iter().map(|read| read.at_us));
        let (moving, still) = sent(&read, &clock);
        let telemetry: BTreeMap<u64, Telemetry> = told
            .iter()
            .map(|telemetry| (clock.at(telemetry.robot_us), *telemetry))
            .collect();
        let facts = Facts::of(&read);
        Ok(Self {
            hello,
            moving,
            still,
            last_tick: telemetry.keys().next_back().copied().unwrap_or_default(),
            origin_us: clock.origin_us,
            configuration: facts.configuration,
            servos: facts.servos,
            battery_at_start: first.battery_mv,
            state_at_start: state,
            table_at_start: facts.table,
            telemetry,
        })
    }

    /// Robot time from the first to the last telemetry \[s\].
    pub(super) fn seconds(&self) -> f64 {
        let first = self.telemetry.keys().next().copied().unwrap_or_default();
        (self.last_tick - first) as f64 * f64::from(TICK_US) * 1e-6
    }
}

/// How the robot was found: the first word on its state after the greeting, asked for or not.
fn found(read: &[Read<'_>], greeting: usize) -> Option<(StateName, [i16; 2])> {
    let mut heard = read
        .iter()
        .skip(greeting)
        .filter(|read| read.frame.direction == Direction::ToHost);
    heard.find_map(|read| match &read.received.message {
        Ok(Message::Reply(Reply::Status(status))) => Some((status.state, status.setpoint)),
        Ok(Message::Telemetry(telemetry)) => Some((telemetry.state, telemetry.setpoint)),
        _ => None,
    })
}

/// The robot's servo periods, counted from a little before the log.
struct Ticks {
    origin_us: u64,
}

impl Ticks {
    /// Telemetry goes out on even ticks since the start, and `first_us` was one of them.
    fn new(first_us: u64, times: impl Iterator<Item = f64>) -> Self {
        let tick = u64::from(TICK_US);
        let earliest = times.fold(first_us as f64, f64::min).max(0.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative
        let before = first_us.saturating_sub(earliest as u64) / tick + BEFORE;
        // The brain counts its first tick as number 1, so the first telemetry comes an odd number of ticks later.
        let before = before | 1;
        Self {
            origin_us: first_us.wrapping_sub(before * tick),
        }
    }

    /// The tick at a time of the robot's clock.
    fn at(&self, robot_us: u64) -> u64 {
        let tick = u64::from(TICK_US);
        (robot_us.wrapping_sub(self.origin_us) + tick / 2) / tick
    }

    /// The first tick after a time of the robot's clock.
    fn after(&self, at_us: f64) -> u64 {
        let ticks = (at_us - self.origin_us.cast_signed() as f64) / f64::from(TICK_US);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates at 0
        let ticks = ticks.ceil().max(0.0) as u64;
        ticks
    }
}

/// Every sound frame on the robot's clock: by the log's own estimate, and before the first ping came back by that ping.
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

/// What was sent: requests that move, each once with the ticks that may have seen it, and the rest.
fn sent(read: &[Read<'_>], clock: &Ticks) -> (Vec<Moving>, Vec<Still>) {
    let answers: HashMap<(u16, u16), f64> = read
        .iter()
        .rev()
        .filter(|read| read.frame.direction == Direction::ToHost)
        .filter(|read| {
            matches!(&read.received.message, Ok(Message::Reply(reply)) if !matches!(reply, Reply::Working))
        })
        // From the last to the first: what stays is the first answer.
        .map(|read| {
            let header = read.received.header;
            ((header.session, header.sequence), read.at_us)
        })
        .collect();
    let end = read.last().map_or(0.0, |read| read.at_us);
    let (mut moving, mut still, mut seen) = (Vec::new(), Vec::new(), HashSet::new());
    for (order, read) in read.iter().enumerate() {
        if read.frame.direction != Direction::ToRobot {
            continue;
        }
        let first = clock.after(read.at_us);
        let header = read.received.header;
        let moves =
            matches!(&read.received.message, Ok(Message::Request(request)) if moves(request));
        if !moves {
            still.push(Still {
                order,
                bytes: read.frame.bytes.clone(),
                tick: first,
            });
        } else if seen.insert((header.session, header.sequence)) {
            let answer = answers.get(&(header.session, header.sequence));
            moving.push(Moving {
                order,
                bytes: read.frame.bytes.clone(),
                first,
                last: clock.after(*answer.unwrap_or(&end)).max(first),
                answered: answer.is_some(),
            });
        }
    }
    (moving, still)
}

fn moves(request: &Request) -> bool {
    match request {
        Request::Configure(_)
        | Request::SetServo { .. }
        | Request::SetPulseRange { .. }
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

/// What the robot said of its settings before any was changed.
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
