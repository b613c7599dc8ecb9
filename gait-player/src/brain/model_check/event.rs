//! Events of the model check.

use crate::{BrainConfig, GaitTable, Transport};
use link_protocol::*;
use std::vec::Vec;

use ResetReason::{Crash, Pin, PowerOn, Watchdog};

/// One event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// Request in the open session with the next sequence number.
    Ask(usize),
    /// Byte-exact repeat of the last request's frame.
    Repeat,
    /// Request with an old sequence number.
    Late(usize),
    /// Request of an earlier session.
    Foreign(usize),
    /// Request in the open session without the required signature.
    Unsigned(usize),
    /// Request with number and signature of the open session, over the other transport.
    Elsewhere(usize),
    /// Greeting of another host over this transport. It takes over a session of the other transport.
    Greet(Transport),
    /// Repeated greeting of the same host.
    GreetAgain,
    /// Keep-alive of a host that has just received a frame of the robot.
    KeepAlive,
    /// Byte-exact repeat of the last keep-alive, then one whose host received the robot too long ago.
    OldKeepAlive,
    /// The bench jumper closes for a moment.
    Jumper,
    /// Time passes in ticks, with or without keep-alives.
    Pass {
        ticks: u32,
        kept_alive: bool,
    },
    /// One tick that comes late by this many seconds.
    Jump(u64),
    /// The battery voltage changes to this value.
    Battery(Option<u16>),
    Reset(ResetReason),
}

/// Replaced by the robot's own values when the request is sent.
pub(super) const FILLED_IN: Checked = Checked {
    table_crc32: 0,
    settings_crc32: 0,
};
const OTHER: Checked = Checked {
    table_crc32: 1,
    settings_crc32: 1,
};

#[allow(clippy::too_many_lines)] // a plain list
pub(super) fn requests() -> Vec<Request> {
    let play = |cycles, detached| {
        Request::Play(Play {
            cycles,
            period_us: 1_000_000,
            detached,
            checked: FILLED_IN,
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
            upload: 0, // replaced when it is sent
            offset: from as u16,
            data: heapless::Vec::from_slice(&table.bytes()[from..to]).unwrap(),
        })
    };
    let config = BrainConfig::in_tests();
    let servo = config.servos[0];
    std::vec![
        Request::Arm,
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
        Request::SetKey(Some(Key([7; Key::LEN]))),
        Request::SetKey(None),
        Request::Bench,
        Request::Configure(Configuration {
            middle_m: 2.0 * config.configuration.middle_m,
            ..config.configuration
        }),
        Request::SetPulseRange {
            joint: Joint::Front,
            range: PulseRange {
                shortest_ns: 1_390_000,
                longest_ns: 1_610_000,
            },
        },
        // The current count of e-stops, and a count one too low.
        Request::ClearEStop { count: 0 },
        Request::ClearEStop { count: 1 },
        Request::EnterBootLoader,
        Request::Follow(Follow {
            upload: 0,
            cycles: 2,
            period_us: 1_000_000,
            checked: FILLED_IN,
        }),
        // A table other than the robot's.
        Request::Play(Play {
            cycles: 2,
            period_us: 1_000_000,
            detached: false,
            checked: OTHER,
        }),
        Request::SetServo {
            joint: Joint::Back,
            settings: ServoSettings {
                reversed: true,
                ..servo
            },
        },
        Request::Trim {
            joint: Joint::Back,
            trim: 400,
        },
        Request::SetPassive(Some(Joint::Back)),
        Request::SetPassive(None),
    ]
}

pub(super) fn events(requests: &[Request]) -> Vec<Event> {
    let mut events: Vec<_> = (0..requests.len()).map(Event::Ask).collect();
    for (index, request) in requests.iter().enumerate() {
        // Requests that could move, stop or unlock the robot, sent over the wrong transport, too late or without authority.
        if matches!(
            request,
            Request::Arm
                | Request::Play(_)
                | Request::Resume
                | Request::Stop
                | Request::EStop
                | Request::SetKey(_)
                | Request::ClearEStop { .. }
                | Request::EnterBootLoader
        ) {
            events.extend([
                Event::Late(index),
                Event::Foreign(index),
                Event::Unsigned(index),
                Event::Elsewhere(index),
            ]);
        }
    }
    events.extend([
        Event::Repeat,
        // USB first: the shape ignores presence, so the stored world should be one whose session may set a key.
        Event::Greet(Transport::Usb),
        Event::Greet(Transport::Uart),
        Event::GreetAgain,
        Event::KeepAlive,
        Event::OldKeepAlive,
        Event::Jumper,
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
