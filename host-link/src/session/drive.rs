//! Time-driven part of a session: retransmissions, time-outs, chunks and keep-alives.

use std::time::Duration;

use link_protocol::{
    Chunk, Flags, Heartbeat, Hello, Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Request, SCHEMA_KEY,
    StateName,
};
use rand::RngExt;

use super::error::LinkError;
use super::upload::UploadPhase;
use super::{
    Event, Greeting, LONGEST_SILENCE, Link, Owner, Pending, Session, TRIES, Ticket, UploadProgress,
    describe,
};

/// Longest wait between two attempts of a stop.
const STOP_WAIT: Duration = Duration::from_millis(200);
/// Shortest time for which a stop is repeated.
const STOP_PATIENCE: Duration = Duration::from_secs(3);
/// Number of times an upload may restart because the robot lost it.
const RENEWALS: u32 = 8;
/// Length of the longest chunk's frame on the wire, bytes.
pub(super) const CHUNK_COST: usize = 126;

impl Session {
    /// Does the actions due at `now`. Call it after [`receive`](Self::receive) and at [`next_deadline`](Self::next_deadline);
    /// then send [`take_outgoing`](Self::take_outgoing).
    pub fn poll(&mut self, now: Duration) {
        self.drive_greeting(now);
        self.drive_pending(now);
        self.drive_upload(now);
        self.feed_lease(now);
    }

    /// Next time at which [`poll`](Self::poll) has work, unless bytes arrive earlier.
    pub fn next_deadline(&self) -> Option<Duration> {
        let (greeting, lease, open) = match &self.link {
            Link::Greeting(greeting) => (Some(greeting.next_try), None, false),
            Link::Open(_) => (None, Some(self.beat_due()), true),
            Link::Closed => (None, None, false),
        };
        let request = match &self.pending {
            // Without a session only a stop is sent; other requests wait for the greeting.
            Some(pending) => (open || pending.request.is_stop()).then_some(pending.next_try),
            None if self.busy > 0 && open => Some(self.hold_until),
            None => None,
        };
        let upload = self
            .upload
            .as_ref()
            .map(|upload| upload.deadline.min(self.last_heard + LONGEST_SILENCE));
        let (repeat, piece) = match &self.upload {
            Some(upload) if open && upload.phase == UploadPhase::Chunks => {
                let repeat = upload
                    .window
                    .oldest()
                    .map(|sent| sent + self.trip.wait(upload.window.timeouts + 1));
                let sendable = upload.window.next_piece().is_some() && self.window_has_room();
                (repeat, sendable.then_some(self.line_free))
            }
            _ => (None, None),
        };
        [greeting, lease, request, upload, repeat, piece]
            .into_iter()
            .flatten()
            .min()
    }

    /// Sends a first greeting with a new nonce.
    pub(super) fn greet(&mut self, ticket: Option<Ticket>, now: Duration) {
        let nonce = self.rng.random();
        let sequence = self.next_sequence();
        self.link = Link::Greeting(Greeting {
            ticket,
            nonce,
            sequence,
            tries: 0,
            first_sent: now,
            next_try: now,
        });
        self.drive_greeting(now);
    }

    /// Sends a request for the first time and keeps it until it gets a reply.
    pub(super) fn put_under_way(&mut self, owner: Owner, request: Request, now: Duration) -> u16 {
        let sequence = self.next_sequence();
        self.pending = Some(Pending {
            owner,
            request,
            sequence,
            tries: 0,
            first_sent: now,
            last_sent: now,
            next_try: now,
            unsigned: false,
        });
        self.drive_pending(now);
        sequence
    }

    fn drive_greeting(&mut self, now: Duration) {
        let Link::Greeting(greeting) = &mut self.link else {
            return;
        };
        if now < greeting.next_try {
            return;
        }
        let patient = greeting.ticket.is_none() && self.upload.is_some();
        if greeting.tries >= TRIES && !patient {
            let (ticket, tries) = (greeting.ticket, greeting.tries);
            let waited = now.saturating_sub(greeting.first_sent);
            self.link = Link::Closed;
            if let Some(ticket) = ticket {
                let counters = Box::new(self.counters());
                self.fail(
                    ticket,
                    LinkError::NoAnswer {
                        doing: "connecting",
                        tries,
                        waited,
                        counters,
                    },
                );
            }
            self.fail_waiting();
            return;
        }
        greeting.tries += 1;
        greeting.next_try = now + self.trip.wait(greeting.tries);
        let (sequence, nonce, again) = (greeting.sequence, greeting.nonce, greeting.tries > 1);
        self.counters.retransmissions += u64::from(again);
        let hello = Message::Hello(Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce: nonce,
        });
        self.send(sequence, &hello);
    }

    /// Fails all waiting requests because there is no session. A stop needs none and stays.
    pub(super) fn fail_waiting(&mut self) {
        self.fail_unanswered(
            |request| !request.is_stop(),
            |doing| LinkError::NotConnected { doing },
        );
        self.end_upload(LinkError::NotConnected {
            doing: "uploading the gait",
        });
    }

    fn drive_pending(&mut self, now: Duration) {
        let open = matches!(self.link, Link::Open(_));
        if self.pending.is_none() && open {
            self.next_under_way(now);
            return;
        }
        let Some(pending) = &mut self.pending else {
            return;
        };
        let stop = pending.request.is_stop();
        if now < pending.next_try || !(open || stop) {
            return;
        }
        let waited = now.saturating_sub(pending.first_sent);
        let given_up = match pending.owner {
            Owner::Upload => false,
            Owner::Ticket(_) => pending.tries >= TRIES && (!stop || waited >= STOP_PATIENCE),
        };
        if given_up {
            let (tries, unsigned) = (pending.tries, pending.unsigned);
            let doing = describe(&pending.request);
            let owner = pending.owner;
            self.pending = None;
            let counters = Box::new(self.counters());
            if let Owner::Ticket(ticket) = owner {
                let error = if unsigned {
                    LinkError::NotSigned { doing }
                } else {
                    LinkError::NoAnswer {
                        doing,
                        tries,
                        waited,
                        counters,
                    }
                };
                self.fail(ticket, error);
            }
            return;
        }
        pending.tries += 1;
        pending.last_sent = now;
        if pending.request.is_powering() {
            self.latest_telemetry = None;
        }
        let wait = self.trip.wait(pending.tries);
        pending.next_try = now + if stop { wait.min(STOP_WAIT) } else { wait };
        self.counters.retransmissions += u64::from(pending.tries > 1);
        let (sequence, message) = (pending.sequence, Message::Request(pending.request.clone()));
        self.send(sequence, &message);
    }

    /// Sends the next request: Begin or Commit of an upload first, then the oldest in the queue.
    fn next_under_way(&mut self, now: Duration) {
        if now < self.hold_until {
            return;
        }
        if let Some(upload) = &mut self.upload
            && upload.due
        {
            upload.due = false;
            let request = match upload.phase {
                UploadPhase::Begin => Request::Begin(upload.begin),
                UploadPhase::Chunks | UploadPhase::Commit => upload.last_request(),
            };
            self.put_under_way(Owner::Upload, request, now);
        } else if let Some((ticket, request)) = self.queue.pop_front() {
            self.put_under_way(Owner::Ticket(ticket), request, now);
        } else {
            self.busy = 0;
        }
    }

    fn drive_upload(&mut self, now: Duration) {
        let Some(upload) = &mut self.upload else {
            return;
        };
        let doing = "uploading the gait";
        if now >= upload.deadline {
            let (waited, done, total) = (
                upload.deadline.saturating_sub(upload.started),
                upload.window.wanted(),
                upload.table.len(),
            );
            let counters = Box::new(self.counters());
            self.end_upload(LinkError::Deadline {
                doing,
                waited,
                done,
                total,
                counters,
            });
            return;
        }
        let silent = now.saturating_sub(self.last_heard);
        if silent >= LONGEST_SILENCE {
            let counters = Box::new(self.counters());
            self.end_upload(LinkError::Silent {
                doing,
                silent,
                counters,
            });
            return;
        }
        if upload.phase != UploadPhase::Chunks || !matches!(self.link, Link::Open(_)) {
            return;
        }
        if let Some(sent) = upload.window.oldest()
            && now >= sent + self.trip.wait(upload.window.timeouts + 1)
        {
            upload.window.timeouts += 1;
            upload.window.go_back();
        }
        self.send_pieces(now);
    }

    /// Fills the window of chunks at the speed of the line.
    fn send_pieces(&mut self, now: Duration) {
        while self.line_free <= now && self.window_has_room() {
            let Some(upload) = &self.upload else {
                return;
            };
            let Some(piece) = upload.window.next_piece() else {
                return;
            };
            let data = upload.table.get(piece.clone()).unwrap_or_default();
            let (Ok(data), Ok(offset)) =
                (heapless::Vec::from_slice(data), u16::try_from(piece.start))
            else {
                return;
            };
            let chunk = Message::Request(Request::Chunk(Chunk {
                upload: upload.number,
                offset,
                data,
            }));
            let sequence = self.next_sequence();
            let cost = self.send(sequence, &chunk);
            self.line_free = self.line_free.max(now)
                + Duration::from_secs_f64(cost as f64 / self.config.bytes_per_second.max(1.0));
            if let Some(upload) = &mut self.upload {
                self.counters.retransmissions += u64::from(upload.window.sent(sequence, cost, now));
            }
        }
    }

    /// Returns true if another chunk fits the robot's buffer. While pulses are on, or may be, only one is in flight, so that a
    /// stop waits behind no other.
    fn window_has_room(&self) -> bool {
        let (Link::Open(hello), Some(upload)) = (&self.link, &self.upload) else {
            return false;
        };
        let room = usize::from(hello.limits.upload_window.min(hello.buffer));
        let in_flight = upload.window.in_flight();
        // One chunk is always allowed, even if the robot reports no buffer.
        in_flight == 0 || (self.pulses_off() && in_flight + CHUNK_COST <= room)
    }

    /// Returns true if the latest report of the robot shows pulses off.
    fn pulses_off(&self) -> bool {
        self.latest_telemetry.is_some_and(|latest_telemetry| {
            matches!(
                latest_telemetry.state,
                StateName::Stopped | StateName::EStopped
            )
        })
    }

    /// Earliest time of the next keep-alive.
    fn beat_due(&self) -> Duration {
        let uploading = self
            .upload
            .as_ref()
            .is_some_and(|upload| upload.phase == UploadPhase::Chunks);
        self.beats.due(&self.trip, self.unwatched(), uploading)
    }

    /// Returns true if the robot continues without a link, so no lease has to be kept.
    fn unwatched(&self) -> bool {
        self.latest_telemetry
            .is_some_and(|latest_telemetry| latest_telemetry.flags.contains(Flags::DETACHED))
    }

    fn feed_lease(&mut self, now: Duration) {
        if !matches!(self.link, Link::Open(_)) || now < self.beat_due() {
            return;
        }
        self.counters.keep_alives += 1;
        let host_us = u64::try_from(now.as_micros()).unwrap_or(u64::MAX);
        self.beats.sent(&self.trip, self.unwatched(), now, host_us);
        let beat = Message::Heartbeat(Heartbeat {
            host_us,
            heard_us: self.beats.heard_us(),
        });
        // A keep-alive takes no sequence number: an hour of them would make the next request look old.
        self.send(self.sequence, &beat);
    }

    /// Restarts an upload that the robot lost, from the offset that it reports, a limited number of times.
    pub(super) fn renew_upload(&mut self, error: LinkError) {
        let Some(upload) = &mut self.upload else {
            return;
        };
        upload.renewed += 1;
        if upload.renewed > RENEWALS {
            self.end_upload(error);
            return;
        }
        upload.phase = UploadPhase::Begin;
        upload.due = true;
        upload.window.go_back();
        if self
            .pending
            .as_ref()
            .is_some_and(|pending| pending.owner == Owner::Upload)
        {
            self.pending = None;
        }
    }

    pub(super) fn report_progress(&mut self) {
        if let Some(upload) = &self.upload {
            self.events.push_back(Event::Progress {
                ticket: upload.ticket,
                progress: UploadProgress {
                    phase: upload.phase,
                    done: upload.window.wanted(),
                    total: upload.table.len(),
                },
            });
        }
    }
}
