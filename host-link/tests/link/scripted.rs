//! Scripted robot: it decodes what a session sends, and the test writes the replies.
#![allow(dead_code)] // each test uses a part of it

use std::time::Duration;

use host_link::session::{Event, Session, SessionConfig, Ticket};
use link_protocol::{
    Board, Decoder, FirmwareVersion, Flags, Header, Hello, HelloReply, Kind, MAX_BODY, MAX_ENCODED,
    Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Pose, Reply, Request, ResetReason, RobotLimits,
    SCHEMA_KEY, StateName, StopCause, Telemetry, encode_body,
};

pub(crate) const MS: Duration = Duration::from_millis(1);
pub(crate) const SESSION: u16 = 7;

/// Time, header and message of a sent frame.
pub(crate) type Sent = (Duration, Header, Message);

pub(crate) struct Script {
    pub(crate) session: Session,
    pub(crate) now: Duration,
    decoder: Decoder,
    robot_us: u64,
    pub(crate) sent: Vec<Sent>,
    pub(crate) events: Vec<Event>,
}

impl Script {
    pub(crate) fn new() -> Self {
        Self {
            session: Session::new(SessionConfig::new(1)),
            now: Duration::ZERO,
            decoder: Decoder::new(),
            robot_us: 0,
            sent: Vec::new(),
            events: Vec::new(),
        }
    }

    /// Opens a session with a round trip of `trip`.
    pub(crate) fn open(trip: Duration) -> Self {
        let mut script = Self::new();
        script.session.connect(script.now);
        script.collect();
        script.run_to(trip);
        script.greet(|_| {});
        assert!(matches!(script.events.pop(), Some(Event::Connected { .. })));
        script.sent.clear();
        script
    }

    /// Collects the frames and events of the session.
    pub(crate) fn collect(&mut self) {
        for byte in self.session.take_outgoing() {
            if let Some(received) = self.decoder.push(byte) {
                self.sent
                    .push((self.now, received.header, received.message.unwrap()));
            }
        }
        while let Some(event) = self.session.next_event() {
            self.events.push(event);
        }
    }

    /// Runs the session until `end`, deadline by deadline.
    pub(crate) fn run_to(&mut self, end: Duration) {
        loop {
            self.session.poll(self.now);
            self.collect();
            let next = self.session.next_deadline().map_or(end, |at| at.min(end));
            if self.now >= end {
                return;
            }
            assert!(
                next > self.now || next == end,
                "a deadline that stands still at {next:?}"
            );
            self.now = next.max(self.now);
        }
    }

    /// Sends a message of the robot.
    pub(crate) fn say(&mut self, session: u16, sequence: u16, message: &Message) {
        self.say_body(
            Header::new(session, sequence),
            message.kind(),
            &body(message),
        );
    }

    /// Sends a body of the robot, valid or not.
    pub(crate) fn say_body(&mut self, header: Header, kind: Kind, body: &[u8]) {
        let mut frame = [0; MAX_ENCODED];
        let len = encode_body(header, kind as u8, body, None, &mut frame).unwrap();
        self.session.receive(self.now, &frame[..len]);
        self.collect();
    }

    /// Sends telemetry with this state.
    pub(crate) fn tell(&mut self, state: StateName, cause: StopCause) {
        self.robot_us += 40_000;
        let telemetry = Telemetry {
            robot_us: self.robot_us,
            state,
            cause,
            flags: Flags::default(),
            cycle: 0,
            cycles: 0,
            phase: 0,
            setpoint: [0; 2],
            pulse_ns: [0; 2],
            battery_mv: None,
            pose: Pose::default(),
            frames_ok: 0,
            frames_bad: 0,
        };
        self.say(SESSION, 0, &Message::Telemetry(telemetry));
    }

    /// Replies to the last request.
    pub(crate) fn reply(&mut self, reply: Reply) {
        let sequence = self.last_request().1;
        self.say(SESSION, sequence, &Message::Reply(reply));
    }

    /// Replies to the last greeting, modified by `change`.
    pub(crate) fn greet(&mut self, change: impl FnOnce(&mut HelloReply)) {
        let (sequence, mut reply) = self.greeting();
        change(&mut reply);
        self.say(reply.session, sequence, &Message::HelloReply(reply));
    }

    /// Number of the last greeting, and its regular reply.
    pub(crate) fn greeting(&self) -> (u16, HelloReply) {
        let (sequence, hello) = self
            .sent
            .iter()
            .rev()
            .find_map(|(_, header, message)| match message {
                Message::Hello(hello) => Some((header.sequence, *hello)),
                _ => None,
            })
            .unwrap();
        (sequence, hello_reply(&hello))
    }

    /// Last request, with its time and number.
    pub(crate) fn last_request(&self) -> (Duration, u16, Request) {
        self.requests().pop().unwrap()
    }

    /// All requests so far.
    pub(crate) fn requests(&self) -> Vec<(Duration, u16, Request)> {
        self.sent
            .iter()
            .filter_map(|(at, header, message)| match message {
                Message::Request(request) => Some((*at, header.sequence, request.clone())),
                _ => None,
            })
            .collect()
    }

    /// Outcome of a ticket: `Ok` for a reply, otherwise the error's text.
    pub(crate) fn outcome(&self, wanted: Ticket) -> Option<Result<(), String>> {
        self.events.iter().find_map(|event| match event {
            Event::Answered { ticket, .. }
            | Event::Connected { ticket, .. }
            | Event::Uploaded { ticket, .. }
                if *ticket == wanted =>
            {
                Some(Ok(()))
            }
            Event::Failed { ticket, error } if *ticket == wanted => Some(Err(error.to_string())),
            _ => None,
        })
    }
}

/// Encoded body of a message.
pub(crate) fn body(message: &Message) -> Vec<u8> {
    message.encode_body(&mut [0; MAX_BODY]).unwrap().to_vec()
}

fn hello_reply(hello: &Hello) -> HelloReply {
    HelloReply {
        host_nonce: hello.host_nonce,
        protocol_min: PROTOCOL_MIN,
        protocol_current: PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        firmware: FirmwareVersion {
            major: 1,
            minor: 2,
            patch: 3,
            commit: *b"0123abcd",
        },
        board: Board::Pico,
        reset_reason: ResetReason::PowerOn,
        crash_message: false,
        session: SESSION,
        boot_nonce: 99,
        limits: RobotLimits {
            max_angle: 2.8,
            max_rate: 3.5,
            pulse_min_ns: 1_300_000,
            pulse_max_ns: 1_700_000,
            max_knots: 512,
            upload_window: 1024,
        },
        buffer: 2048,
    }
}
