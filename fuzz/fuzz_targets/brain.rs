//! Any story of requests, bytes, times, batteries and resets: promises R4 and R6 hold on every tick.
#![no_main]

use std::collections::VecDeque;

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use link_protocol::{
    Binding, Checked, Decoder, Flags, Header, HelloReply, Key, Message, Reply, Request,
    ResetReason, Seal, StateName,
};
use swimmer_fuzz::ask::{Ask, PIECE, table};
use swimmer_fuzz::robot::FuzzedRobot;
use swimmer_fuzz::wire;

#[derive(Arbitrary, Debug)]
enum Step {
    Greet {
        nonce: u8,
    },
    Ask(Ask),
    /// Without the signature that a robot with a key requires.
    Unsigned(Ask),
    /// One of the last signed frames, byte by byte.
    Recorded {
        back: u8,
    },
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
    Jumper {
        closed: bool,
    },
    Reset {
        reason: u8,
    },
}

/// The far end as the story sees it: numbers to use next, and the key.
#[derive(Default)]
struct Host {
    session: u16,
    sequence: u16,
    upload: u16,
    /// Checksum of the table that was begun last.
    begun: u32,
    decoder: Decoder,
    /// The robot's key, as far as a host can know it: the one that it granted last.
    key: Option<Key>,
    asked_key: Option<(u16, Option<Key>)>,
    /// The robot has some key for certain: it said so, and no request could have taken it away since.
    locked: bool,
    /// Binding of the open session, and its seal if it began with a key.
    bound: Option<(Binding, Option<Seal>)>,
    /// The open session began when the robot was locked: only what is signed moves it.
    guarded: bool,
    counter: u64,
    recorded: VecDeque<Vec<u8>>,
}

impl Host {
    fn hear(&mut self, robot: &mut FuzzedRobot) {
        let mut bytes = Vec::new();
        robot.transmit(&mut bytes);
        for byte in bytes {
            let Some(received) = self.decoder.push(byte) else {
                continue;
            };
            let message = received
                .message
                .expect("the robot says what no one understands");
            match message {
                Message::HelloReply(reply) => self.meet(&reply),
                Message::Reply(Reply::Wanted { upload, .. }) => self.upload = upload,
                Message::Reply(Reply::Done) => {
                    if let Some((sequence, key)) = self.asked_key
                        && sequence == received.header.sequence
                    {
                        // The session is closed: no telemetry is sent in it.
                        self.key = key;
                        self.locked = key.is_some();
                    }
                }
                Message::Telemetry(telemetry) => {
                    self.locked = telemetry.flags.contains(Flags::KEY_SET);
                }
                _ => {}
            }
        }
    }

    fn meet(&mut self, reply: &HelloReply) {
        self.session = reply.session;
        let binding = Binding {
            boot_nonce: reply.boot_nonce,
            session: reply.session,
            host_nonce: reply.host_nonce,
        };
        // A greeting that came twice is answered twice; it is one session.
        if self
            .bound
            .as_ref()
            .is_none_or(|(bound, _)| *bound != binding)
        {
            let seal = self.key.as_ref().map(|key| Seal::new(key, binding));
            self.bound = Some((binding, seal));
            self.guarded = self.locked;
        }
    }

    /// A message as this host says it: signed where the session began with a key.
    fn frame(&mut self, sequence: u16, message: &Message) -> Vec<u8> {
        let header = Header::new(self.session, sequence);
        let Some((_, Some(seal))) = &self.bound else {
            return wire::frame(header, message);
        };
        self.counter += 1;
        let frame = wire::signed(header, message, seal, self.counter);
        self.recorded.push_front(frame.clone());
        self.recorded.truncate(64);
        frame
    }
}

/// Progress of a polite host before the story begins: a fuzzer does not find a whole upload by chance.
#[derive(Arbitrary, Debug, PartialEq, PartialOrd)]
enum Start {
    Greeted,
    Locked,
    Uploaded,
    Armed,
    Playing,
}

fuzz_target!(|story: (Start, Vec<Step>)| {
    let (start, story) = story;
    let mut robot = FuzzedRobot::default();
    let mut host = Host::default();
    // The bench window is open at first: a first key needs it.
    robot.inputs.present = true;
    robot.tick(0);
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
        (Start::Locked, Step::Ask(Ask::SetKey { key: Some(1) })),
        (
            Start::Locked,
            Step::Ticks {
                count: 30,
                keep_alive: true,
            },
        ),
        (Start::Locked, Step::Greet { nonce: 2 }),
        (Start::Uploaded, Step::Upload { which: 1 }),
        (Start::Armed, Step::Ask(Ask::Arm)),
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
    // Each story chooses if the robot has a key: those that go further than the lock have none.
    let told = |from: &Start| match from {
        Start::Locked => *start == Start::Locked,
        from => start >= from && *start != Start::Locked,
    };
    for (_, step) in polite.iter().filter(|(from, _)| told(from)) {
        tell(robot, host, step);
        robot.tick(0);
        host.hear(robot);
    }
    assert_eq!(host.guarded, *start == Start::Locked);
    let state = robot.tick(0).state;
    let meant = match start {
        Start::Greeted | Start::Locked | Start::Uploaded => StateName::Stopped,
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
            let request = noted(robot, host, ask, false);
            if let Request::SetKey(key) = request {
                host.asked_key = Some((host.sequence, key));
            }
            // Requests that power the servos need a host that has just received a frame.
            let heartbeat = wire::heartbeat(robot.now_us());
            for (sequence, message) in [(0, heartbeat), (host.sequence, Message::Request(request))]
            {
                let frame = host.frame(sequence, &message);
                robot.receive(&frame);
            }
        }
        Step::Unsigned(ask) => {
            host.sequence = host.sequence.wrapping_add(1);
            let request = noted(robot, host, ask, host.guarded);
            let header = Header::new(host.session, host.sequence);
            robot.receive(&wire::frame(header, &Message::Request(request)));
        }
        Step::Recorded { back } => {
            if let Some(frame) = host.recorded.get(usize::from(*back)) {
                robot.armed |= !host.guarded;
                robot.remapped |= !host.guarded;
                host.locked = false;
                robot.receive(frame);
            }
        }
        Step::Upload { which } => {
            let which = *which;
            let pieces = table(which).bytes().len().div_ceil(PIECE);
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
        } => {
            let request = noted(robot, host, ask, false);
            let header = Header::new(*session, *sequence);
            robot.receive(&wire::frame(header, &Message::Request(request)));
        }
        Step::Sound { kind, body } => {
            // It may be an arm, a new map or a key, whatever the fuzzer found.
            robot.armed = true;
            robot.remapped = true;
            host.locked = false;
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
                    let frame = host.frame(0, &wire::heartbeat(robot.now_us()));
                    robot.receive(&frame);
                }
                robot.tick(0);
            }
        }
        Step::Late { us } => drop(robot.tick(*us)),
        Step::Battery { mv } => robot.inputs.battery_mv = *mv,
        Step::Jumper { closed } => robot.inputs.present = *closed,
        Step::Link { up } => robot.inputs.link_up = *up,
        Step::Reset { reason } => {
            let reasons = [
                ResetReason::PowerOn,
                ResetReason::Watchdog,
                ResetReason::Crash,
                ResetReason::Pin,
            ];
            robot.reset(reasons[usize::from(*reason) % reasons.len()]);
            (host.locked, host.guarded) = (false, false);
        }
    }
}

/// The request of an ask. Records its consequences for the checker, unless it is sure to be refused.
fn noted(robot: &mut FuzzedRobot, host: &mut Host, ask: &Ask, turned_away: bool) -> Request {
    let checked = match ask {
        Ask::Follow { .. } => Checked {
            table_crc32: host.begun,
            ..robot.held()
        },
        _ => robot.held(),
    };
    let request = ask.request(host.upload, checked);
    if let Request::Begin(begin) = &request {
        host.begun = begin.crc32;
    }
    if !turned_away {
        robot.armed |= matches!(request, Request::Arm);
        robot.remapped |= matches!(
            request,
            Request::SetServo { .. } | Request::Configure(_) | Request::Trim { .. }
        );
        host.locked &= !matches!(request, Request::SetKey(_));
    }
    request
}
