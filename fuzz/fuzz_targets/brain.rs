//! Any story of requests, bytes, times, batteries and resets: promises R4 and R6 hold on every tick.
#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use link_protocol::{Decoder, Header, MAX_CHUNK, Message, Reply, Request, ResetReason, StateName};
use swimmer_fuzz::ask::{Ask, table};
use swimmer_fuzz::robot::FuzzedRobot;
use swimmer_fuzz::wire;

#[derive(Arbitrary, Debug)]
enum Step {
    Greet {
        nonce: u8,
    },
    Ask(Ask),
    /// Begin, chunks, commit, and the time that the check takes.
    Upload {
        which: u8,
    },
    /// Under another session and sequence number.
    Stray {
        ask: Ask,
        session: u16,
        sequence: u16,
    },
    Sound {
        kind: u8,
        body: Vec<u8>,
    },
    Bytes(Vec<u8>),
    Ticks {
        count: u8,
        keep_alive: bool,
    },
    Late {
        us: u32,
    },
    Battery {
        mv: Option<u16>,
    },
    Link {
        up: bool,
    },
    Reset {
        reason: u8,
    },
}

/// The far end as the story sees it: numbers to use next.
#[derive(Default)]
struct Host {
    session: u16,
    sequence: u16,
    upload: u16,
    decoder: Decoder,
}

impl Host {
    fn hear(&mut self, robot: &mut FuzzedRobot) {
        let mut bytes = Vec::new();
        robot.transmit(&mut bytes);
        for byte in bytes {
            let received = self.decoder.push(byte);
            match received.map(|received| {
                received
                    .message
                    .expect("the robot says what no one understands")
            }) {
                Some(Message::HelloReply(reply)) => self.session = reply.session,
                Some(Message::Reply(Reply::Wanted { upload, .. })) => self.upload = upload,
                _ => {}
            }
        }
    }
}

/// How far a polite host has come before the story begins: a fuzzer does not find a whole upload by chance.
#[derive(Arbitrary, Debug, PartialEq, PartialOrd)]
enum Start {
    Greeted,
    Uploaded,
    Armed,
    Playing,
}

fuzz_target!(|story: (Start, Vec<Step>)| {
    let (start, story) = story;
    let mut robot = FuzzedRobot::default();
    let mut host = Host::default();
    robot.receive(&wire::frame(Header::new(0, 1), &wire::hello(1)));
    host.hear(&mut robot);
    prelude(&mut robot, &mut host, &start);
    for step in story.iter().take(400) {
        tell(&mut robot, &mut host, step);
        robot.tick(0);
        host.hear(&mut robot);
    }
});

fn prelude(robot: &mut FuzzedRobot, host: &mut Host, start: &Start) {
    let polite = [
        (Start::Uploaded, Step::Upload { which: 1 }),
        (Start::Armed, Step::Ask(Ask::Arm { clear_estop: false })),
        (
            Start::Playing,
            Step::Ask(Ask::Play {
                cycles: 3,
                tenths: 40,
                detached: false,
            }),
        ),
        (
            Start::Playing,
            Step::Ticks {
                count: 120,
                keep_alive: true,
            },
        ),
    ];
    for (_, step) in polite.iter().filter(|(from, _)| start >= from) {
        tell(robot, host, step);
    }
    let state = robot.tick(0).state;
    let meant = match start {
        Start::Greeted | Start::Uploaded => StateName::Stopped,
        Start::Armed => StateName::Holding,
        Start::Playing => StateName::Playing,
    };
    assert_eq!(
        state, meant,
        "the polite host of {start:?} is not understood"
    );
}

fn tell(robot: &mut FuzzedRobot, host: &mut Host, step: &Step) {
    match step {
        Step::Greet { nonce } => {
            host.sequence = host.sequence.wrapping_add(1);
            robot.receive(&wire::frame(
                Header::new(0, host.sequence),
                &wire::hello(u32::from(*nonce)),
            ));
        }
        Step::Ask(ask) => {
            host.sequence = host.sequence.wrapping_add(1);
            ask_under(robot, host, ask, Header::new(host.session, host.sequence));
        }
        Step::Upload { which } => {
            let which = *which;
            let pieces = table(which).bytes().len().div_ceil(MAX_CHUNK);
            let mut asks = vec![Ask::Begin { which }];
            asks.extend((0..pieces).map(|piece| Ask::Chunk {
                which,
                piece: piece as u8,
                upload: 0,
            }));
            asks.push(Ask::Commit { upload: 0 });
            for ask in asks {
                tell(robot, host, &Step::Ask(ask));
                tell(
                    robot,
                    host,
                    &Step::Ticks {
                        count: 1,
                        keep_alive: true,
                    },
                );
                host.hear(robot);
            }
            tell(
                robot,
                host,
                &Step::Ticks {
                    count: 30,
                    keep_alive: true,
                },
            );
        }
        Step::Stray {
            ask,
            session,
            sequence,
        } => ask_under(robot, host, ask, Header::new(*session, *sequence)),
        Step::Sound { kind, body } => {
            // It may be an arm or a new map, whatever the fuzzer found.
            robot.armed = true;
            robot.remapped = true;
            robot.receive(&wire::sound(
                Header::new(host.session, host.sequence),
                *kind,
                body,
            ));
        }
        // Bytes with a right checksum by chance: not within the age of a tank.
        Step::Bytes(bytes) => robot.receive(bytes),
        Step::Ticks { count, keep_alive } => {
            for _ in 0..*count {
                if *keep_alive {
                    robot.receive(&wire::frame(
                        Header::new(host.session, 0),
                        &Message::KeepAlive,
                    ));
                }
                robot.tick(0);
            }
        }
        Step::Late { us } => drop(robot.tick(*us)),
        Step::Battery { mv } => robot.inputs.battery_mv = *mv,
        Step::Link { up } => robot.inputs.link_up = *up,
        Step::Reset { reason } => {
            let reasons = [
                ResetReason::PowerOn,
                ResetReason::Watchdog,
                ResetReason::Crash,
                ResetReason::Pin,
            ];
            robot.reset(reasons[usize::from(*reason) % reasons.len()]);
        }
    }
}

fn ask_under(robot: &mut FuzzedRobot, host: &Host, ask: &Ask, header: Header) {
    let request = ask.request(host.upload);
    robot.armed |= matches!(request, Request::Arm(_));
    robot.remapped |= matches!(
        request,
        Request::SetServo { .. } | Request::Configure(_) | Request::Trim { .. }
    );
    robot.receive(&wire::frame(header, &Message::Request(request)));
}
