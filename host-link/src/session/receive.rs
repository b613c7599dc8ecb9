//! Received bytes of a session: replies, telemetry, clock. [`super::greeting`] handles greetings.

use std::time::Duration;

use link_protocol::{
    Header, HelloReplyStart, Kind, Message, Received, Refusal, Reply, Request, StateName,
    StopCause, Telemetry,
};

use super::error::LinkError;
use super::upload::UploadPhase;
use super::{Event, Link, Owner, Pending, Session, describe};

/// Pause before a request to a busy robot is repeated.
const BUSY_WAIT: Duration = Duration::from_millis(100);
/// Most consecutive busy replies: the check of a table takes some seconds.
const BUSY_TRIES: u32 = 50;
/// Longest time for which a robot may report that it is working at a request. A check of the largest table takes 5 s.
pub const LONGEST_WORK: Duration = Duration::from_secs(20);
/// Longest time for which a robot may reply that no keep-alive is fresh.
const FRESH_PATIENCE: Duration = Duration::from_secs(3);
/// Time without a reply after which a stop must be waiting behind other bytes, and the lease may end first.
const STOP_QUEUES: Duration = Duration::from_millis(500);

impl Session {
    /// Processes bytes that arrived at `now`, in any split, then calls [`poll`](Self::poll).
    pub fn receive(&mut self, now: Duration, bytes: &[u8]) {
        self.counters.bytes_received += bytes.len() as u64;
        for &byte in bytes {
            if let Some(received) = self.decoder.push(byte) {
                self.take(received, now);
            }
        }
        self.poll(now);
    }

    fn take(&mut self, received: Received, now: Duration) {
        let header = received.header;
        let named = matches!(self.link, Link::Open(_)) && header.session == self.number;
        let ours = named && self.authentic(&received);
        let Ok(message) = received.message else {
            return self.take_unknown(header, ours, now);
        };
        match message {
            Message::HelloReply(reply) => self.greeted(reply, now),
            Message::Reply(reply) => {
                let stop = self.pending.as_ref().is_some_and(|pending| {
                    pending.sequence == header.sequence && pending.request.is_stop()
                });
                let counts = if stop {
                    // Accepted from any session, but nothing else is: a delayed reply must not end the repeats of a lost stop.
                    let forged = named && !ours;
                    if let Some(pending) = self.pending.as_mut().filter(|_| forged) {
                        pending.unsigned = true;
                    }
                    reply == Reply::Done && !forged
                } else {
                    // A request of a closed session gets a reply too.
                    ours || matches!(reply, Reply::Refused(Refusal::StaleSession))
                };
                if counts {
                    self.last_heard = now;
                    self.beats.reached();
                    self.answered(header.sequence, reply, now);
                } else if ours {
                    self.counters.unmatched += 1;
                } else {
                    self.counters.foreign += 1;
                }
            }
            // Only hosts send these: an echo.
            Message::Hello(_) | Message::Request(_) | Message::Heartbeat(_) => {
                self.counters.echoed += 1;
            }
            // Without a session, any robot on the line is the one to stop.
            Message::Telemetry(telemetry) if !ours && matches!(self.link, Link::Closed) => {
                self.counters.foreign += 1;
                self.last_heard = now;
                self.stopped_by_itself(&telemetry, now);
            }
            _ if !ours => self.counters.foreign += 1,
            Message::Telemetry(telemetry) => {
                self.last_heard = now;
                self.beats.heard(telemetry.robot_us);
                if self
                    .last_robot_us
                    .is_some_and(|last| telemetry.robot_us <= last)
                {
                    self.counters.late_telemetry += 1;
                    return;
                }
                self.last_robot_us = Some(telemetry.robot_us);
                self.counters.telemetry += 1;
                self.latest_telemetry = Some(telemetry);
                self.stopped_by_itself(&telemetry, now);
                self.events
                    .push_back(Event::Telemetry { telemetry, at: now });
            }
            Message::Pong(pong) => {
                self.last_heard = now;
                self.beats.heard(pong.sent_us);
                self.beats.answered(pong.host_us);
                if let Some(trip) = self.clock.push(&pong, now) {
                    self.trip.sample(trip);
                }
            }
        }
    }

    /// Returns true if a frame of the open session is authentic. A robot that has not yet proved that it has the key may have
    /// none. One that has signs everything except the reasons for refused frames.
    fn authentic(&mut self, received: &Received) -> bool {
        let Some(seal) = &self.seal else {
            return true;
        };
        let turned_away = matches!(
            received.message,
            Ok(Message::HelloReply(_)
                | Message::Reply(Reply::Refused(
                    Refusal::StaleSession
                        | Refusal::KeyNeeded
                        | Refusal::WrongKey
                        | Refusal::Version { .. }
                )))
        );
        match &received.signature {
            Some(signature)
                if signature.counter > self.proven
                    && seal.verifies(self.decoder.signed_bytes(), signature) =>
            {
                self.proven = signature.counter;
                true
            }
            None if turned_away => true,
            None if self.proven == 0 => {
                self.counters.unsigned += 1;
                true
            }
            _ => {
                self.counters.forged += 1;
                false
            }
        }
    }

    /// Handles telemetry of a stop in progress while the stop has been unanswered for longer than a round trip.
    fn stopped_by_itself(&mut self, telemetry: &Telemetry, now: Duration) {
        let at_rest = |request: &Request| match telemetry.state {
            StateName::EStopped => true,
            StateName::Stopped | StateName::Stopping | StateName::Settling => {
                *request == Request::Stop
            }
            _ => false,
        };
        let meant = |pending: &mut Pending| {
            pending.request.is_stop()
                && at_rest(&pending.request)
                && now >= pending.first_sent + STOP_QUEUES
        };
        if let Some(pending) = self.pending.take_if(meant)
            && let Owner::Ticket(ticket) = pending.owner
        {
            self.events.push_back(match telemetry.cause {
                // Caused by the stop itself: only its reply was lost.
                StopCause::Requested | StopCause::EStop => Event::Answered {
                    ticket,
                    reply: Reply::Done,
                },
                cause => Event::StoppedByItself { ticket, cause },
            });
        }
    }

    /// Handles a complete frame with a message of newer firmware. Its request fails with that reason.
    fn take_unknown(&mut self, header: Header, ours: bool, now: Duration) {
        match self.decoder.kind_and_body() {
            Some((Kind::HelloReply, body)) => {
                if let Some(start) = HelloReplyStart::of_body(body) {
                    self.greeted_by_unknown(header.sequence, &start, now);
                }
            }
            Some((Kind::Reply, _)) if ours => {
                self.last_heard = now;
                self.answered_by_unknown(header.sequence);
            }
            _ => {}
        }
    }

    /// Ends a request whose reply is unknown; a repeat would give the same reply. A stop is repeated, because it may not have
    /// acted.
    fn answered_by_unknown(&mut self, sequence: u16) {
        let meant =
            |pending: &mut Pending| pending.sequence == sequence && !pending.request.is_stop();
        if let Some(pending) = self.pending.take_if(meant) {
            self.busy = 0;
            let doing = describe(&pending.request);
            match pending.owner {
                Owner::Ticket(ticket) => self.fail(ticket, LinkError::UnknownAnswer { doing }),
                Owner::Upload => self.end_upload(LinkError::UnknownAnswer { doing }),
            }
        } else if self.upload.as_ref().is_some_and(|upload| {
            upload.phase == UploadPhase::Chunks && upload.window.knows(sequence)
        }) {
            let doing = "uploading the gait";
            self.end_upload(LinkError::UnknownAnswer { doing });
        }
    }

    fn answered(&mut self, sequence: u16, reply: Reply, now: Duration) {
        if let Some(pending) = self.pending.take_if(|pending| pending.sequence == sequence) {
            // The round trip is known only for a single attempt without interim replies.
            let once = pending.tries == 1 && pending.last_sent == pending.first_sent;
            let since_first = now.saturating_sub(pending.first_sent);
            match pending.request {
                Request::Commit { .. } | Request::Play(_) => {}
                _ if once => self.trip.sample(since_first),
                _ => self.trip.bound(since_first),
            }
            if !matches!(reply, Reply::Refused(Refusal::Busy)) {
                self.busy = 0;
            }
            match (reply, pending.owner) {
                (Reply::Working, owner) if since_first >= LONGEST_WORK => {
                    let doing = describe(&pending.request);
                    let waited = since_first;
                    match owner {
                        Owner::Ticket(ticket) => {
                            self.fail(ticket, LinkError::StillWorking { doing, waited });
                        }
                        Owner::Upload => self.end_upload(LinkError::StillWorking { doing, waited }),
                    }
                }
                (Reply::Working, _) => {
                    // The robot is working at the request: the count of attempts restarts.
                    let next_try = now + self.trip.wait(2);
                    self.pending = Some(Pending {
                        tries: 0,
                        next_try,
                        ..pending
                    });
                }
                (Reply::Refused(Refusal::StaleSession), owner) => {
                    self.session_lost(owner, &pending.request, now);
                }
                // The first keep-alives of the session are still in flight, so the request did not act and is repeated under a
                // new number. This attempt does not count, but lost ones do.
                (Reply::Refused(Refusal::NotFresh), _) if since_first < FRESH_PATIENCE => {
                    let sequence = self.next_sequence();
                    self.pending = Some(Pending {
                        sequence,
                        tries: pending.tries.saturating_sub(1),
                        next_try: now + BUSY_WAIT,
                        ..pending
                    });
                }
                (Reply::Refused(Refusal::Busy), owner) if self.busy < BUSY_TRIES => {
                    self.ask_later(owner, pending.request, now);
                }
                (reply, Owner::Upload) => self.upload_answered(&pending.request, reply),
                (Reply::Refused(refusal), Owner::Ticket(ticket)) => {
                    let doing = describe(&pending.request);
                    self.fail(ticket, LinkError::Refused { doing, refusal });
                }
                (reply, Owner::Ticket(ticket)) => {
                    self.events.push_back(Event::Answered { ticket, reply });
                }
            }
        } else {
            self.piece_answered(sequence, &reply, now);
        }
    }

    /// Repeats a request later under a new number, because the robot was busy and did not act.
    fn ask_later(&mut self, owner: Owner, request: Request, now: Duration) {
        self.busy += 1;
        self.hold_until = now + BUSY_WAIT;
        match owner {
            Owner::Ticket(ticket) => self.queue.push_front((ticket, request)),
            Owner::Upload => {
                if let Some(upload) = &mut self.upload {
                    upload.due = true;
                }
            }
        }
    }

    /// Handles a restart or takeover of the robot. An upload greets again; other requests fail.
    fn session_lost(&mut self, owner: Owner, request: &Request, now: Duration) {
        let doing = describe(request);
        if self.upload.is_some() {
            self.renew_upload(LinkError::SessionLost { doing });
        }
        if let Owner::Ticket(ticket) = owner {
            self.fail(ticket, LinkError::SessionLost { doing });
        }
        if self.upload.is_some() {
            self.greet(None, now);
        } else {
            self.link = Link::Closed;
            self.fail_waiting();
        }
    }

    /// Handles a reply to Begin or Commit.
    fn upload_answered(&mut self, request: &Request, reply: Reply) {
        let Some(total) = self.upload.as_ref().map(|upload| upload.table.len()) else {
            return;
        };
        let window = |wanted: u16| self.window(total, wanted.into());
        let window = match &reply {
            Reply::Wanted { offset, .. } => window(*offset),
            Reply::Refused(Refusal::Incomplete { wanted }) => window(*wanted),
            _ => window(0),
        };
        let Some(upload) = &mut self.upload else {
            return;
        };
        let doing = "uploading the gait";
        match (request, reply) {
            (Request::Begin(_), Reply::Wanted { upload: number, .. }) => {
                upload.number = number;
                upload.window = window;
                self.chunks_or_commit();
            }
            (Request::Commit { .. } | Request::Follow(_), Reply::Table(Some(table))) => {
                let ticket = upload.ticket;
                self.upload = None;
                self.events.push_back(Event::Uploaded { ticket, table });
            }
            (
                Request::Commit { .. } | Request::Follow(_),
                Reply::Refused(Refusal::Incomplete { .. }),
            ) => {
                upload.window = window;
                self.chunks_or_commit();
            }
            (
                Request::Commit { .. } | Request::Follow(_),
                Reply::Refused(refusal @ Refusal::NoUpload),
            ) => {
                self.renew_upload(LinkError::Refused { doing, refusal });
            }
            (_, Reply::Refused(refusal)) => self.end_upload(LinkError::Refused { doing, refusal }),
            (_, reply) => {
                let reply = format!("{reply:?}");
                self.end_upload(LinkError::WrongReply { doing, reply });
            }
        }
    }

    fn chunks_or_commit(&mut self) {
        if let Some(upload) = &mut self.upload {
            let complete = upload.window.complete();
            upload.phase = if complete {
                UploadPhase::Commit
            } else {
                UploadPhase::Chunks
            };
            upload.due = complete;
        }
        self.report_progress();
    }

    /// Handles a reply to a chunk, or to no pending request.
    fn piece_answered(&mut self, sequence: u16, reply: &Reply, now: Duration) {
        let Some(upload) = self
            .upload
            .as_mut()
            .filter(|upload| upload.phase == UploadPhase::Chunks)
        else {
            self.counters.unmatched += 1;
            return;
        };
        let doing = "uploading the gait";
        let known = upload.window.knows(sequence);
        let before = upload.window.wanted();
        let wanted = match reply {
            // A late reply counts too: its number belongs to this upload.
            Reply::Wanted {
                upload: number,
                offset,
            } if *number == upload.number => *offset,
            Reply::Refused(Refusal::ChunkOutOfRange { wanted }) if known => *wanted,
            Reply::Refused(Refusal::StaleSession) if known => {
                self.renew_upload(LinkError::SessionLost { doing });
                if self.upload.is_some() {
                    self.greet(None, now);
                }
                return;
            }
            Reply::Refused(refusal @ Refusal::NoUpload) if known => {
                let refusal = *refusal;
                self.renew_upload(LinkError::Refused { doing, refusal });
                return;
            }
            // The time-out repeats it.
            Reply::Working | Reply::Refused(Refusal::Busy) if known => return,
            Reply::Refused(refusal) if known => {
                let refusal = *refusal;
                self.end_upload(LinkError::Refused { doing, refusal });
                return;
            }
            _ => {
                self.counters.unmatched += 1;
                return;
            }
        };
        if let Some(trip) = upload.window.answered(sequence, wanted.into(), now) {
            self.trip.sample(trip);
        }
        if upload.window.wanted() > before {
            self.chunks_or_commit();
        }
    }
}
