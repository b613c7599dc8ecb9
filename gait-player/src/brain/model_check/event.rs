//! Events of the model check.

use crate::{BrainConfig, GaitTable, Transport};
use link_protocol::*;
use std::vec::Vec;

use ResetReason::{Crash, Pin, PowerOn, Watchdog};

/// Something that happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// A request in the open session, under the next number.
    Ask(usize),
    /// The frame of the last request again, byte by byte.
    Repeat,
    /// A request under an old number.
    Late(usize),
    /// A request of a session before.
    Foreign(usize),
    /// A request in the open session without the signature that it asks for.
    Unsigned(usize),
    /// A request under number and signature of the open session, by the other way.
    Elsewhere(usize),
    /// Another host greets, by this way: where the session was of the other one, it takes over.
    Greet(Transport),
    /// The same host greets again.
    GreetAgain,
    /// A keep-alive of a host that has just heard the robot.
    KeepAlive,
    /// The last keep-alive again, byte by byte, and one whose host heard the robot too long ago.
    OldKeepAlive,
    /// Somebody closes the bench jumper for a moment.
    Jumper,
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

/// Filled in with what the robot holds when the request is sent.
pub(super) const FILLED_IN: Checked = Checked {
    table_crc32: 0,
    settings_crc32: 0,
};
const OTHER: Checked = Checked {
    table_crc32: 1,
    settings_crc32: 1,
};

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
            upload: 0, // filled in when it is sent
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
        // Of the e-stops that there were, and of one less.
        Request::ClearEStop { count: 0 },
        Request::ClearEStop { count: 1 },
        Request::EnterBootLoader,
        Request::Follow(Follow {
            upload: 0,
            cycles: 2,
            period_us: 1_000_000,
            checked: FILLED_IN,
        }),
        // Of another table than the robot's.
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
    ]
}

pub(super) fn events(requests: &[Request]) -> Vec<Event> {
    let mut events: Vec<_> = (0..requests.len()).map(Event::Ask).collect();
    for (index, request) in requests.iter().enumerate() {
        // What could move the robot, stop it or open it, from elsewhere, too late or without leave.
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
        // First over the cable: where presence is not told apart, the session that is kept is one that may set a key.
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
