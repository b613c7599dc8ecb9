//! Test bench: a correct host with clock and link around a brain. Tests deviate from its behaviour on purpose.
#![allow(dead_code, clippy::wildcard_imports)] // each test uses a part of it, and all messages of the protocol

pub(crate) mod stops;

use gait_player::{
    Boot, Brain, BrainConfig, GaitTable, Identity, Inputs, Output, TICK_US, Transport,
};
use heapless::Vec as Bytes;
use link_protocol::*;
use std::f64::consts::TAU;

pub(crate) const IDENTITY: Identity = Identity {
    firmware: FirmwareVersion {
        major: 0,
        minor: 1,
        patch: 0,
        commit: *b"01234567",
    },
    board: Board::Twin,
};
pub(crate) const SECOND: u64 = 1_000_000;

pub(crate) struct Bench {
    pub(crate) brain: Brain,
    pub(crate) now_us: u64,
    pub(crate) inputs: Inputs,
    pub(crate) output: Output,
    pub(crate) session: u16,
    pub(crate) sequence: u16,
    /// Send a keep-alive every 40 ms.
    pub(crate) keep_alive: bool,
    pub(crate) telemetry: Vec<Telemetry>,
    pub(crate) replies: Vec<(Header, Reply)>,
    pub(crate) others: Vec<(Header, Message)>,
    pub(crate) bytes_out: usize,
    /// Transport of this host.
    pub(crate) via: Transport,
    /// Checksum of the last table for which an upload began.
    begun: u32,
    decoder: Decoder,
}

pub(crate) fn config() -> BrainConfig {
    BrainConfig::robot(IDENTITY, Boot::power_on(0xCAFE, 0x1000))
}

pub(crate) fn circle(amplitude: f64) -> GaitTable {
    GaitTable::from_fn(512, |u| {
        let angle = TAU * (u + 0.125);
        [amplitude * angle.cos(), amplitude * angle.sin()]
    })
    .unwrap()
}

pub(crate) fn play(cycles: u32, period_us: u32) -> Request {
    Request::Play(Play {
        cycles,
        period_us,
        detached: false,
        checked: AS_HELD,
    })
}

/// Placeholder for table and settings; [`Bench::ask`] replaces it with the robot's own.
pub(crate) const AS_HELD: Checked = Checked {
    table_crc32: 0,
    settings_crc32: 0,
};

pub(crate) const ARM: Request = Request::Arm;

impl Bench {
    /// Returns a brain after a greeting.
    pub(crate) fn new() -> Self {
        let mut bench = Self::with(config());
        bench.greet(1);
        bench
    }

    pub(crate) fn with(config: BrainConfig) -> Self {
        Self::around(Brain::new(config))
    }

    pub(crate) fn around(mut brain: Brain) -> Self {
        let inputs = Inputs {
            battery_mv: Some(5_000),
            link_up: true,
            usb_up: true,
            ..Inputs::default()
        };
        let now_us = 123_456;
        let output = brain.tick(now_us, &inputs);
        Self {
            brain,
            now_us,
            inputs,
            output,
            session: 0,
            sequence: 0,
            keep_alive: true,
            telemetry: Vec::new(),
            replies: Vec::new(),
            others: Vec::new(),
            bytes_out: 0,
            via: Transport::Uart,
            begun: 0,
            decoder: Decoder::new(),
        }
    }

    pub(crate) fn greet(&mut self, host_nonce: u32) -> HelloReply {
        let hello = Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce,
        };
        self.send(Header::new(0, 7), &Message::Hello(hello));
        let replies = self
            .others
            .drain(..)
            .filter_map(|(header, message)| match message {
                Message::HelloReply(reply) => Some((header, reply)),
                _ => None,
            });
        let (header, reply) = replies.collect::<Vec<_>>().pop().unwrap();
        assert_eq!((header.session, header.sequence), (reply.session, 7));
        self.session = reply.session;
        if self.keep_alive {
            self.beat();
        }
        reply
    }

    /// Sends a keep-alive of a host that has just received a frame of the robot.
    pub(crate) fn beat(&mut self) {
        self.beat_that_heard(self.now_us);
    }

    pub(crate) fn beat_that_heard(&mut self, heard_us: u64) {
        let heartbeat = Heartbeat {
            host_us: 0,
            heard_us,
        };
        self.send(Header::new(self.session, 0), &Message::Heartbeat(heartbeat));
    }

    /// Closes the bench jumper.
    pub(crate) fn come_near(&mut self) {
        self.inputs.present = true;
        self.tick();
        self.inputs.present = false;
    }

    pub(crate) fn send(&mut self, header: Header, message: &Message) {
        let mut frame = [0; MAX_ENCODED];
        let len = encode(header, message, &mut frame).unwrap();
        self.brain.receive(self.now_us, self.via, &frame[..len]);
        self.drain();
    }

    pub(crate) fn drain(&mut self) {
        let mut bytes = [0; 64];
        loop {
            let len = self.brain.transmit(self.via, &mut bytes);
            if len == 0 {
                break;
            }
            self.bytes_out += len;
            for &byte in &bytes[..len] {
                let Some(received) = self.decoder.push(byte) else {
                    continue;
                };
                match received.message.unwrap() {
                    Message::Telemetry(telemetry) => self.telemetry.push(telemetry),
                    Message::Reply(reply) => self.replies.push((received.header, reply)),
                    other => self.others.push((received.header, other)),
                }
            }
        }
    }

    /// Runs one tick, with a keep-alive every 40 ms if enabled.
    pub(crate) fn tick(&mut self) -> Output {
        self.now_us += u64::from(TICK_US);
        if self.keep_alive && (self.now_us / u64::from(TICK_US)).is_multiple_of(2) {
            self.beat();
        }
        self.output = self.brain.tick(self.now_us, &self.inputs);
        self.drain();
        self.output
    }

    pub(crate) fn run(&mut self, us: u64) -> Vec<Output> {
        (0..us / u64::from(TICK_US)).map(|_| self.tick()).collect()
    }

    /// Runs ticks until a state is reached; returns the duration, µs.
    pub(crate) fn until(&mut self, state: StateName, at_most_us: u64) -> u64 {
        let start = self.now_us;
        while self.output.state != state {
            assert!(
                self.now_us - start <= at_most_us,
                "{state:?} not reached, still {:?}",
                self.output.state
            );
            self.tick();
        }
        self.now_us - start
    }

    /// Sends a request under a number; returns an immediate reply.
    pub(crate) fn send_request(&mut self, sequence: u16, request: Request) -> Option<Reply> {
        let request = self.filled_in(request);
        let before = self.replies.len();
        self.send(
            Header::new(self.session, sequence),
            &Message::Request(request),
        );
        let mut replies = self.replies.iter().skip(before);
        replies
            .find(|(header, _)| header.sequence == sequence)
            .map(|(_, reply)| reply.clone())
    }

    pub(crate) fn filled_in(&self, mut request: Request) -> Request {
        match &mut request {
            Request::Play(play) if play.checked == AS_HELD => play.checked = self.brain.held(),
            Request::Follow(follow) if follow.checked == AS_HELD => {
                follow.checked = Checked {
                    table_crc32: self.begun,
                    ..self.brain.held()
                };
            }
            _ => {}
        }
        request
    }

    /// Sends a request and waits for the reply.
    pub(crate) fn ask(&mut self, request: Request) -> Reply {
        self.sequence = self.sequence.wrapping_add(1);
        let sequence = self.sequence;
        if self.keep_alive && request.class(|| true).needs().freshness {
            self.beat();
        }
        if let Some(reply) = self.send_request(sequence, request) {
            return reply;
        }
        let before = self.replies.len();
        for _ in 0..200 {
            self.tick();
            if let Some((header, reply)) = self.replies.get(before) {
                assert_eq!((header.session, header.sequence), (self.session, sequence));
                return reply.clone();
            }
        }
        panic!("no reply within 4 s");
    }

    pub(crate) fn done(&mut self, request: Request) {
        assert_eq!(self.ask(request), Reply::Done);
    }

    pub(crate) fn refused(&mut self, request: Request) -> Refusal {
        match self.ask(request) {
            Reply::Refused(refusal) => refusal,
            reply => panic!("{reply:?} where a refusal was due"),
        }
    }

    pub(crate) fn status(&mut self) -> Status {
        match self.ask(Request::Status) {
            Reply::Status(status) => status,
            reply => panic!("{reply:?}"),
        }
    }

    /// Clears the present count of e-stops.
    pub(crate) fn clear_estop(&mut self) {
        let count = self.status().estops;
        self.done(Request::ClearEStop { count });
    }

    /// Sends Begin and all chunks; returns the upload's number.
    pub(crate) fn send_table(&mut self, table: &GaitTable) -> u16 {
        let len = u16::try_from(table.bytes().len()).unwrap();
        self.begun = table.crc32();
        let reply = self.ask(Request::Begin(Begin {
            slot: 0,
            len,
            crc32: table.crc32(),
        }));
        let Reply::Wanted { upload, mut offset } = reply else {
            panic!("{reply:?}")
        };
        while offset < len {
            let piece = &table.bytes()[usize::from(offset)..];
            let data = Bytes::from_slice(&piece[..piece.len().min(MAX_CHUNK)]).unwrap();
            let reply = self.ask(Request::Chunk(Chunk {
                upload,
                offset,
                data,
            }));
            let Reply::Wanted { offset: next, .. } = reply else {
                panic!("{reply:?}")
            };
            assert!(next > offset);
            offset = next;
        }
        upload
    }

    pub(crate) fn commit(&mut self, table: &GaitTable) -> Reply {
        let upload = self.send_table(table);
        self.ask(Request::Commit { upload })
    }

    pub(crate) fn upload(&mut self, table: &GaitTable) {
        let reply = self.commit(table);
        let Reply::Table(Some(info)) = reply else {
            panic!("{reply:?}")
        };
        assert_eq!(
            (usize::from(info.knots), info.crc32),
            (table.knots(), table.crc32())
        );
    }

    /// Returns a bench that plays this table.
    pub(crate) fn playing(table: &GaitTable, request: Request) -> Self {
        let mut bench = Self::new();
        bench.upload(table);
        bench.done(ARM);
        bench.done(request);
        bench.until(StateName::Playing, 3 * SECOND);
        bench
    }
}
