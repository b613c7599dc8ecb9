//! Frames from the link: authority, order and replies. The effect of each request is in [`super::actions`].

use super::config::Transport;
use super::outbox::What;
use super::session::{Admission, Order};
use super::{Brain, count};
use link_protocol::{
    BodyError, Header, Hello, Kind, MAX_BODY, Message, Needs, PROTOCOL_CURRENT, PROTOCOL_MIN, Pong,
    PulseRange, Received, Refusal, Reply, Request, SettingsHeld, StopCause, settings_crc32,
};

/// Reply address of a frame: its header, its transport, and whether it belongs to the open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReplyAddress {
    pub(super) header: Header,
    pub(super) transport: Transport,
    pub(super) ours: bool,
}

impl Brain {
    pub(super) fn handle(
        &mut self,
        now_us: u64,
        transport: Transport,
        received: Received,
        admission: Admission,
    ) {
        let header = received.header;
        let asked = ReplyAddress {
            header,
            transport,
            ours: admission == Admission::Ours,
        };
        match received.message {
            Ok(Message::Hello(hello)) => self.greet(asked, &hello),
            Ok(Message::Request(request)) => self.request(now_us, asked, &request, admission),
            Ok(Message::Heartbeat(heartbeat)) => {
                if self.count_stale(asked) {
                    self.session.feed(now_us, heartbeat);
                    self.pong(now_us, asked, heartbeat.host_us);
                }
            }
            // A message that only robots send comes from another robot or is an echo. An unknown kind gets no reply.
            Ok(
                Message::HelloReply(_)
                | Message::Reply(_)
                | Message::Telemetry(_)
                | Message::Pong(_),
            )
            | Err(BodyError::UnknownKind(_)) => {}
            Err(BodyError::Version(_)) => {
                // The reply uses our version, which the host may understand.
                let header = Header {
                    version: PROTOCOL_CURRENT,
                    ..header
                };
                self.refuse(
                    ReplyAddress { header, ..asked },
                    Refusal::Version {
                        min: PROTOCOL_MIN,
                        current: PROTOCOL_CURRENT,
                    },
                );
            }
            Err(BodyError::Malformed | BodyError::TrailingBytes(_)) => {
                self.refuse(asked, Refusal::NotUnderstood);
            }
        }
    }

    fn greet(&mut self, asked: ReplyAddress, hello: &Hello) {
        let understood =
            hello.protocol_min <= PROTOCOL_CURRENT && hello.protocol_current >= PROTOCOL_MIN;
        // Session 0 stands for a refused greeting; the reply states the reason.
        let session = if understood {
            self.session.greet(
                asked.transport,
                hello.host_nonce,
                self.settings.key.as_ref(),
            )
        } else {
            0
        };
        let reply = Message::HelloReply(self.hello_reply(hello.host_nonce, session));
        let header = Header {
            session,
            ..asked.header
        };
        // The reply to a greeting is never signed: the session key does not exist yet.
        self.send(asked.transport, header, &reply, false, What::Answer);
    }

    /// Counts a frame of another session. Returns true if the frame belongs to the open session.
    fn count_stale(&mut self, asked: ReplyAddress) -> bool {
        if !asked.ours {
            count(&mut self.counted.stale);
        }
        asked.ours
    }

    fn pong(&mut self, now_us: u64, asked: ReplyAddress, host_us: u64) {
        let pong = Message::Pong(Pong {
            host_us,
            received_us: now_us,
            sent_us: now_us,
        });
        self.send(asked.transport, asked.header, &pong, true, What::Answer);
    }

    fn request(
        &mut self,
        now_us: u64,
        asked: ReplyAddress,
        request: &Request,
        admission: Admission,
    ) {
        let needs = request
            .class(|| self.settings_held().is_widened_by(request))
            .needs();
        if needs.signature && !self.count_stale(asked) {
            return self.turn_away(asked, request, admission);
        }
        // Stops act unconditionally. If the sequence number is the next one, they take part in the order of requests.
        if request.is_stop() {
            if *request == Request::Stop {
                self.stop(StopCause::Requested);
            } else {
                self.estop();
            }
            if asked.ours {
                self.session.order(asked.header.sequence);
                self.session.keep(asked.header.sequence, &Reply::Done);
            }
            count(&mut self.counted.acted);
            // Every sender gets a reply. Only a request of the open session takes a sequence number and has its reply stored.
            return self.answer(asked, Reply::Done, What::StopAnswer);
        }
        if let Request::Chunk(chunk) = request {
            // A chunk acts by its offset, independent of the sequence number, and its reply is not stored.
            let taken = self
                .authorize(now_us, asked, needs)
                .and_then(|()| self.tables.chunk(chunk));
            return match taken {
                Ok(offset) => self.reply(
                    asked,
                    Reply::Wanted {
                        upload: chunk.upload,
                        offset,
                    },
                ),
                Err(refusal) => self.refuse(asked, refusal),
            };
        }
        match self.session.order(asked.header.sequence) {
            Order::Next => {}
            Order::Repeat => {
                count(&mut self.counted.replayed);
                return self.reply_again(asked);
            }
            Order::Superseded { last } => {
                count(&mut self.counted.superseded);
                return self.refuse(asked, Refusal::Superseded { last });
            }
        }
        let outcome = self
            .authorize(now_us, asked, needs)
            .and_then(|()| self.act(now_us, asked, request));
        match outcome {
            Ok(Some(reply)) => {
                count(&mut self.counted.acted);
                self.finish(asked, reply);
                if matches!(request, Request::SetKey(_)) {
                    self.session.close();
                } else if needs.wear && self.is_present(now_us, asked) {
                    self.settings.note_bench(request);
                    self.persist.grant();
                }
            }
            Ok(None) => count(&mut self.counted.acted),
            Err(refusal) => self.finish(asked, Reply::Refused(refusal)),
        }
    }

    /// Enforces the authority table for a request of the open session, before the request is evaluated. [`super::persist`]
    /// enforces the wear budget.
    fn authorize(&self, now_us: u64, asked: ReplyAddress, needs: Needs) -> Result<(), Refusal> {
        let state = self.state.name();
        if !needs.state.includes(state) {
            return Err(Refusal::WrongState(state));
        }
        // Buffered bytes of a dead host have no effect.
        if needs.freshness && !self.session.attended(now_us) {
            return Err(Refusal::NotFresh);
        }
        if needs.presence && !self.is_present(now_us, asked) {
            return Err(Refusal::NeedsPresence);
        }
        Ok(())
    }

    /// Returns true if a person is at the robot: the request came over USB, or the bench window is open.
    fn is_present(&self, now_us: u64, asked: ReplyAddress) -> bool {
        asked.transport == Transport::Usb || self.bench.open(now_us)
    }

    /// Settings in force, with which a request is compared.
    pub(super) fn settings_held(&self) -> SettingsHeld {
        SettingsHeld {
            configuration: self.settings.configuration,
            built: self.built,
            servos: self.settings.servos,
            at_bench: self.settings.at_bench,
            ranges: self.ranges(),
            passive: self.settings.passive,
            has_key: self.settings.key.is_some(),
        }
    }

    /// Hash of the settings that a play must match.
    pub(super) fn settings_crc32(&self) -> u32 {
        settings_crc32(
            &self.settings.configuration,
            &self.settings.servos,
            &self.ranges(),
            self.settings.passive,
        )
    }

    fn ranges(&self) -> [PulseRange; 2] {
        [0, 1].map(|joint| self.settings.window(joint, &self.firmware_limits))
    }

    /// Sends the stored reply to a repeated request.
    fn reply_again(&mut self, asked: ReplyAddress) {
        let mut body = [0; MAX_BODY];
        let kept = self.session.kept().and_then(|kept| {
            let place = body.get_mut(..kept.len())?;
            place.copy_from_slice(kept);
            Some(&*place)
        });
        match kept {
            Some(body) => {
                let (to, header) = (asked.transport, asked.header);
                self.send_body(to, header, Kind::Reply, body, true, What::Answer);
            }
            None => self.reply(asked, Reply::Working),
        }
    }

    /// Refuses a request that is not of the open session. The reply does not reveal the number of that session.
    fn turn_away(&mut self, asked: ReplyAddress, request: &Request, admission: Admission) {
        let refusal = match admission {
            // A byte-exact copy was answered once; a second reply would contradict the first.
            Admission::Ours | Admission::Replayed => return,
            // Repeat of the request that closed the session, because its reply was lost.
            Admission::Closed if self.closed_by(asked, request) => {
                count(&mut self.counted.replayed);
                return self.reply_again(asked);
            }
            Admission::Foreign | Admission::Closed => Refusal::StaleSession,
            Admission::Unsigned => Refusal::KeyNeeded,
            Admission::WrongKey => Refusal::WrongKey,
        };
        self.refuse(asked, refusal);
    }

    fn closed_by(&self, asked: ReplyAddress, request: &Request) -> bool {
        matches!(request, Request::SetKey(key) if *key == self.settings.key)
            && self.session.is_last(asked.header.sequence)
    }

    /// Sends the reply to a request and stores it for repeats.
    pub(super) fn finish(&mut self, asked: ReplyAddress, reply: Reply) {
        if matches!(reply, Reply::Refused(_)) {
            count(&mut self.counted.refused);
        }
        if asked.header.session == self.session.number() {
            self.session.keep(asked.header.sequence, &reply);
        }
        self.reply(asked, reply);
    }

    fn refuse(&mut self, asked: ReplyAddress, refusal: Refusal) {
        count(&mut self.counted.refused);
        self.reply(asked, Reply::Refused(refusal));
    }

    fn reply(&mut self, asked: ReplyAddress, reply: Reply) {
        self.answer(asked, reply, What::Answer);
    }

    /// Sends a reply under session, number and version of its request, because the sender reads that version.
    fn answer(&mut self, asked: ReplyAddress, reply: Reply, what: What) {
        let message = Message::Reply(reply);
        self.send(asked.transport, asked.header, &message, asked.ours, what);
    }

    /// Sends a message, signed if it is `ours` and the open session requires it.
    pub(super) fn send(
        &mut self,
        to: Transport,
        header: Header,
        message: &Message,
        ours: bool,
        what: What,
    ) {
        let mut body = [0; MAX_BODY];
        if let Ok(body) = message.encode_body(&mut body) {
            self.send_body(to, header, message.kind(), body, ours, what);
        }
    }

    fn send_body(
        &mut self,
        to: Transport,
        header: Header,
        kind: Kind,
        body: &[u8],
        ours: bool,
        what: What,
    ) {
        let signature = if ours {
            self.session.sign(header, kind, body)
        } else {
            None
        };
        self.outboxes[to.index()].send(header, kind, body, signature, what);
    }
}
