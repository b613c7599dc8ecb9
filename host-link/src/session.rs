//! Host's side of the link as a state machine without I/O (sans-IO): bytes and times in; bytes, events and the next deadline
//! out.
//!
//! ```text
//!             connect                 HelloReply, versions meet
//!  Closed ──────────────► Greeting ─────────────────────────────► Open ──┐ requests, upload, keep-alive
//!    ▲                     │   ▲                                   │     │ as they are answered, telemetry
//!    │   no answer,        │   └──── upload goes on ───────────────┤ ◄───┘
//!    └── other version ────┘                StaleSession           │
//!    ▲                                                             │
//!    └───────────────── StaleSession without an upload ────────────┘
//! ```
//!
//! Glossary. *Request*: acts at most once on the robot; requests are sent one at a time, in order. *Ticket*: identifies a
//! request; every ticket ends in exactly one event. *Upload*: a table as Begin, a window of chunks, Commit. *Lease*: the robot
//! stops without a fresh keep-alive for half a second. A keep-alive is fresh if it echoes a recent time of the robot.
//!
//! Stop and e-stop end every unanswered request and the upload (their tickets fail with [`LinkError::Dropped`]). They are sent
//! at once, ahead of chunks, and even without an open session.

mod beats;
mod clock_fit;
mod counters;
mod drive;
mod error;
mod event;
mod greeting;
mod in_flight;
mod receive;
mod round_trip;
mod upload;
mod upload_time;

use std::collections::VecDeque;
use std::time::Duration;

use link_protocol::{
    Begin, Decoder, Header, HelloReply, Key, MAX_CHUNK, MAX_ENCODED, MAX_SIGNED_CHUNK, Message,
    Request, Seal, Telemetry, crc32c, encode, encode_signed,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub use beats::KEEP_ALIVE;
pub use clock_fit::{ClockFit, ClockSamples};
pub use counters::LinkCounters;
pub use error::{LinkError, cause_in_words, cycles_in_words};
pub use event::{Event, Ticket};
pub(crate) use greeting::firmware_name;
pub use in_flight::Follower;
pub use receive::LONGEST_WORK;
pub use upload::{UploadPhase, UploadProgress};

use beats::Beats;
use in_flight::{Greeting, Link, Owner, Pending, Upload, describe};
use round_trip::RoundTrip;
use upload::Window;

/// Number of attempts of a request.
pub const TRIES: u32 = 5;
/// Silence after which an upload fails.
pub const LONGEST_SILENCE: Duration = Duration::from_secs(5);

/// Configuration of a session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SessionConfig {
    /// Source of the nonces. Two programs that start at the same moment need different seeds.
    pub seed: u64,
    /// Bytes per second of the slowest part of the link. Chunks are not sent faster, so that a stop waits behind at most one.
    pub bytes_per_second: f64,
    /// Key shared with the robot. Every frame except the greeting is signed with it.
    pub key: Option<Key>,
}

impl SessionConfig {
    /// Configuration for the robot's 115 200 baud.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            bytes_per_second: 11_520.0,
            key: None,
        }
    }
}

/// A session with one robot.
#[derive(Debug)]
pub struct Session {
    config: SessionConfig,
    rng: ChaCha8Rng,
    decoder: Decoder,
    outgoing: Vec<u8>,
    link: Link,
    /// Number of the last open session, used for stops.
    number: u16,
    /// Signer and verifier of that session.
    seal: Option<Seal>,
    /// Number of frames signed in it.
    signed: u64,
    /// Counter of the last frame that the robot signed in it; 0 before the first one.
    proven: u64,
    sequence: u16,
    next_ticket: u64,
    queue: VecDeque<(Ticket, Request)>,
    pending: Option<Pending>,
    upload: Option<Upload>,
    trip: RoundTrip,
    clock: ClockSamples,
    beats: Beats,
    last_heard: Duration,
    /// Latest telemetry of this session.
    latest_telemetry: Option<Telemetry>,
    /// Time at which the line has sent the chunks so far.
    line_free: Duration,
    /// No new request before this time: the robot is busy.
    hold_until: Duration,
    /// Consecutive busy replies.
    busy: u32,
    last_robot_us: Option<u64>,
    boot_nonce: Option<u32>,
    counters: LinkCounters,
    events: VecDeque<Event>,
}

impl Session {
    /// Returns a session before its greeting.
    pub fn new(config: SessionConfig) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        let sequence = rng.random();
        Self {
            config,
            rng,
            decoder: Decoder::new(),
            outgoing: Vec::new(),
            link: Link::Closed,
            number: 0,
            seal: None,
            signed: 0,
            proven: 0,
            sequence,
            next_ticket: 0,
            queue: VecDeque::new(),
            pending: None,
            upload: None,
            trip: RoundTrip::default(),
            clock: ClockSamples::default(),
            beats: Beats::default(),
            last_heard: Duration::ZERO,
            latest_telemetry: None,
            line_free: Duration::ZERO,
            hold_until: Duration::ZERO,
            busy: 0,
            last_robot_us: None,
            boot_nonce: None,
            counters: LinkCounters::default(),
            events: VecDeque::new(),
        }
    }

    /// Greets the robot. Ends in [`Event::Connected`] or [`Event::Failed`]. An upload continues afterwards. A pending request
    /// fails, because the robot does not answer it in a new session.
    pub fn connect(&mut self, now: Duration) -> Ticket {
        let ticket = self.ticket();
        self.abandon_greeting();
        if let Some(pending) = self.pending.take()
            && let Owner::Ticket(owner) = pending.owner
        {
            let doing = describe(&pending.request);
            self.fail(owner, LinkError::Dropped { doing });
        }
        self.greet(Some(ticket), now);
        ticket
    }

    /// Sends a request. Ends in [`Event::Answered`] or [`Event::Failed`].
    pub fn request(&mut self, now: Duration, request: Request) -> Ticket {
        let ticket = self.ticket();
        if request.is_stop() {
            let estop_unanswered = self
                .pending
                .as_ref()
                .is_some_and(|pending| matches!(pending.request, Request::EStop));
            // The e-stop may have been lost, and a plain stop must not replace it.
            let request = if estop_unanswered {
                Request::EStop
            } else {
                request
            };
            self.drop_unanswered();
            self.outgoing.clear();
            self.put_under_way(Owner::Ticket(ticket), request, now);
        } else if matches!(self.link, Link::Closed) {
            let doing = describe(&request);
            self.fail(ticket, LinkError::NotConnected { doing });
        } else {
            self.queue.push_back((ticket, request));
            self.poll(now);
        }
        ticket
    }

    /// Uploads a gait table of at most 2048 bytes to slot `slot`. Ends in [`Event::Uploaded`] or [`Event::Failed`], at the
    /// latest at `deadline` (on the host's clock). An earlier upload fails.
    pub fn upload(&mut self, now: Duration, slot: u8, table: &[u8], deadline: Duration) -> Ticket {
        self.send_table(now, slot, table, None, deadline)
    }

    /// Uploads a table that does not become active, but follows the present play as `follower`.
    pub fn upload_follower(
        &mut self,
        now: Duration,
        table: &[u8],
        follower: Follower,
        deadline: Duration,
    ) -> Ticket {
        self.send_table(now, 0, table, Some(follower), deadline)
    }

    fn send_table(
        &mut self,
        now: Duration,
        slot: u8,
        table: &[u8],
        follows: Option<Follower>,
        deadline: Duration,
    ) -> Ticket {
        let ticket = self.ticket();
        let doing = "uploading the gait";
        let len = match u16::try_from(table.len()) {
            Ok(len) if table.len() <= link_protocol::MAX_TABLE => len,
            _ => {
                self.fail(
                    ticket,
                    LinkError::OutOfRange {
                        doing,
                        quantity: "a table length in bytes",
                        value: table.len() as f64,
                        low: 0.0,
                        high: link_protocol::MAX_TABLE as f64,
                    },
                );
                return ticket;
            }
        };
        if matches!(self.link, Link::Closed) {
            self.fail(ticket, LinkError::NotConnected { doing });
            return ticket;
        }
        self.end_upload(LinkError::Dropped { doing });
        let begin = Begin {
            slot,
            len,
            crc32: crc32c(table),
        };
        self.upload = Some(Upload {
            ticket,
            begin,
            follows,
            table: table.to_vec(),
            started: now,
            deadline,
            phase: UploadPhase::Begin,
            due: true,
            number: 0,
            window: self.window(table.len(), 0),
            renewed: 0,
        });
        self.last_heard = now;
        self.poll(now);
        ticket
    }

    /// Uses another key, or no key, from the next session on.
    pub fn set_key(&mut self, key: Option<Key>) {
        self.config.key = key;
    }

    /// Bytes per chunk: the most that fits a frame.
    fn piece(&self) -> usize {
        if self.config.key.is_some() {
            MAX_SIGNED_CHUNK
        } else {
            MAX_CHUNK
        }
    }

    fn window(&self, total: usize, wanted: usize) -> Window {
        Window::new(total, wanted, self.piece())
    }

    /// Cancels the upload, without an event. The robot keeps the received bytes and its active table.
    pub fn cancel_upload(&mut self) {
        self.upload = None;
        self.pending
            .take_if(|pending| pending.owner == Owner::Upload);
    }

    /// Abandons a request: it no longer delays later ones, and ends without an event. It may still act.
    pub fn forget(&mut self, ticket: Ticket) {
        self.queue.retain(|(queued, _)| *queued != ticket);
        self.pending
            .take_if(|pending| pending.owner == Owner::Ticket(ticket));
    }

    /// Returns the bytes to send now, in order.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// Returns the next event, oldest first.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// The robot's reply to the greeting, while a session is open.
    pub fn hello(&self) -> Option<&HelloReply> {
        match &self.link {
            Link::Open(hello) => Some(hello),
            Link::Closed | Link::Greeting(_) => None,
        }
    }

    /// Fit of the robot's clock to the host's clock. Returns `None` before the first reply to a ping.
    pub fn clock(&self) -> Option<ClockFit> {
        self.clock.fit()
    }

    /// Counts of this session's link.
    pub fn counters(&self) -> LinkCounters {
        LinkCounters {
            received: self.decoder.counters(),
            round_trip: self.trip.smoothed(),
            ..self.counters
        }
    }

    /// Time of the last valid frame of the open session.
    pub fn last_heard(&self) -> Duration {
        self.last_heard
    }

    /// Returns true if the robot has proved in this session that it has the key, by signed replies. `None` without a key. A
    /// robot that does not sign has no key, older firmware, or is an impostor.
    pub fn answers_signed(&self) -> Option<bool> {
        self.seal.as_ref().map(|_| self.proven > 0)
    }

    fn ticket(&mut self) -> Ticket {
        self.next_ticket += 1;
        Ticket(self.next_ticket)
    }

    fn next_sequence(&mut self) -> u16 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    /// Encodes a message into the outgoing bytes; returns its length on the wire.
    fn send(&mut self, sequence: u16, message: &Message) -> usize {
        let mut frame = [0; MAX_ENCODED];
        let header = Header::new(self.number, sequence);
        let encoded = match &self.seal {
            Some(seal) if !matches!(message, Message::Hello(_)) => {
                self.signed += 1;
                encode_signed(header, message, seal, self.signed, &mut frame)
            }
            _ => encode(header, message, &mut frame),
        };
        // Every message of the protocol fits a frame. One that did not would be lost and repeated.
        let Ok(len) = encoded else {
            return 0;
        };
        self.outgoing
            .extend_from_slice(frame.get(..len).unwrap_or_default());
        self.counters.frames_sent += 1;
        self.counters.bytes_sent += len as u64;
        len
    }

    fn fail(&mut self, ticket: Ticket, error: LinkError) {
        self.counters.given_up += 1;
        self.events.push_back(Event::Failed { ticket, error });
    }

    fn end_upload(&mut self, error: LinkError) {
        if let Some(upload) = self.upload.take() {
            self.fail(upload.ticket, error);
        }
        if self
            .pending
            .as_ref()
            .is_some_and(|pending| pending.owner == Owner::Upload)
        {
            self.pending = None;
        }
    }

    /// Fails everything unanswered, because of a stop.
    fn drop_unanswered(&mut self) {
        self.end_upload(LinkError::Dropped {
            doing: "uploading the gait",
        });
        self.fail_unanswered(|_| true, |doing| LinkError::Dropped { doing });
    }

    /// Fails the queue, and the pending request if it is `meant`.
    fn fail_unanswered(
        &mut self,
        meant: impl Fn(&Request) -> bool,
        error: impl Fn(&'static str) -> LinkError,
    ) {
        let under_way = self
            .pending
            .take_if(|pending| meant(&pending.request))
            .map(|pending| (pending.owner, pending.request));
        let queued = std::mem::take(&mut self.queue);
        let queued = queued
            .into_iter()
            .map(|(ticket, request)| (Owner::Ticket(ticket), request));
        for (owner, request) in under_way.into_iter().chain(queued) {
            if let Owner::Ticket(ticket) = owner {
                self.fail(ticket, error(describe(&request)));
            }
        }
    }

    /// Replaces a pending greeting by a newer one.
    fn abandon_greeting(&mut self) {
        if let Link::Greeting(Greeting {
            ticket: Some(ticket),
            ..
        }) = std::mem::replace(&mut self.link, Link::Closed)
        {
            self.fail(
                ticket,
                LinkError::Dropped {
                    doing: "connecting",
                },
            );
        }
    }
}
