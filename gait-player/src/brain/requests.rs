//! Frames from the link: authority, order and replies. The effect of each request is in [`super::actions`].

use super::config::Transport;
use super::outbox::What;
use super::session::{Admission, Order};
use super::{Brain, count};
use link_protocol::{
    BodyError, Header, Hello, Kind, MAX_BODY, Message, Needs, PROTOCOL_CURRENT, PROTOCOL_MIN, Pong,
    PulseRange, Received, Refusal, Reply, Request, SettingsHeld, StopCause, settings_crc32,
};

/// What a frame asks to be answered to: its header, its way, and whether it is of the open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
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
        let asked = Asked {
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
            // What only robots send is another robot, or an echo; an unknown kind asks for nothing known.
            Ok(
                Message::HelloReply(_)
                | Message::Reply(_)
                | Message::Telemetry(_)
                | Message::Pong(_),
            )
            | Err(BodyError::UnknownKind(_)) => {}
            Err(BodyError::Version(_)) => {
                // In ours: it may be one of those that the host understands.
                let header = Header {
                    version: PROTOCOL_CURRENT,
                    ..header
                };
                self.refuse(
                    Asked { header, ..asked },
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

    fn greet(&mut self, asked: Asked, hello: &Hello) {
        let understood =
            hello.protocol_min <= PROTOCOL_CURRENT && hello.protocol_current >= PROTOCOL_MIN;
        // Session 0: none. The reply says why.
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
        // Never signed: it comes before there is anything to sign with.
        self.send(asked.transport, header, &reply, false, What::Answer);
    }

    /// Counts a frame that is of no session of ours; true where it is of ours.
    fn count_stale(&mut self, asked: Asked) -> bool {
        if !asked.ours {
            count(&mut self.counted.stale);
        }
        asked.ours
    }

    fn pong(&mut self, now_us: u64, asked: Asked, host_us: u64) {
        let pong = Message::Pong(Pong {
            host_us,
            received_us: now_us,
            sent_us: now_us,
        });
        self.send(asked.transport, asked.header, &pong, true, What::Answer);
    }

    fn request(&mut self, now_us: u64, asked: Asked, request: &Request, admission: Admission) {
        let needs = request
            .class(|| self.settings_held().is_widened_by(request))
            .needs();
        if needs.signature && !self.count_stale(asked) {
            return self.turn_away(asked, request, admission);
        }
        // These act whatever else holds. If their number is the next one, it takes its place in the order.
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
            // Answered to whoever sent it; only ours has a place in the order, where its answer is kept.
            return self.answer(asked, Reply::Done, What::StopAnswer);
        }
        if let Request::Chunk(chunk) = request {
            // Acts by its offset, whatever the order, and keeps no reply.
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

    /// Enforces what the authority table demands of a request of the open session, before it is looked at further. The
    /// wear budget is enforced where the flash is written ([`super::persist`]).
    fn authorize(&self, now_us: u64, asked: Asked, needs: Needs) -> Result<(), Refusal> {
        let state = self.state.name();
        if !needs.state.includes(state) {
            return Err(Refusal::WrongState(state));
        }
        // Bytes that a buffer kept of a host that is gone do nothing.
        if needs.freshness && !self.session.attended(now_us) {
            return Err(Refusal::NotFresh);
        }
        if needs.presence && !self.is_present(now_us, asked) {
            return Err(Refusal::NeedsPresence);
        }
        Ok(())
    }

    /// Somebody is at the robot: at the other end of its cable, or within the bench window.
    fn is_present(&self, now_us: u64, asked: Asked) -> bool {
        asked.transport == Transport::Usb || self.bench.open(now_us)
    }

    /// The settings with which a new one is compared.
    pub(super) fn settings_held(&self) -> SettingsHeld {
        SettingsHeld {
            configuration: self.settings.configuration,
            built: self.built,
            servos: self.settings.servos,
            at_bench: self.settings.at_bench,
            ranges: self.ranges(),
            has_key: self.settings.key.is_some(),
        }
    }

    /// Hash of the settings that a play is checked for.
    pub(super) fn settings_crc32(&self) -> u32 {
        settings_crc32(
            &self.settings.configuration,
            &self.settings.servos,
            &self.ranges(),
        )
    }

    fn ranges(&self) -> [PulseRange; 2] {
        [0, 1].map(|joint| self.settings.window(joint, &self.firmware_limits))
    }

    /// The stored reply to a repeat.
    fn reply_again(&mut self, asked: Asked) {
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

    /// Refuses a request that is not of the open session. No reply tells the number of that one.
    fn turn_away(&mut self, asked: Asked, request: &Request, admission: Admission) {
        let refusal = match admission {
            // A frame that came twice was answered once: a second answer would only undo it.
            Admission::Ours | Admission::Replayed => return,
            // The request that closed the session, again: its reply was lost.
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

    fn closed_by(&self, asked: Asked, request: &Request) -> bool {
        matches!(request, Request::SetKey(key) if *key == self.settings.key)
            && self.session.is_last(asked.header.sequence)
    }

    /// The answer to a request, kept for its repeats.
    pub(super) fn finish(&mut self, asked: Asked, reply: Reply) {
        if matches!(reply, Reply::Refused(_)) {
            count(&mut self.counted.refused);
        }
        if asked.header.session == self.session.number() {
            self.session.keep(asked.header.sequence, &reply);
        }
        self.reply(asked, reply);
    }

    fn refuse(&mut self, asked: Asked, refusal: Refusal) {
        count(&mut self.counted.refused);
        self.reply(asked, Reply::Refused(refusal));
    }

    fn reply(&mut self, asked: Asked, reply: Reply) {
        self.answer(asked, reply, What::Answer);
    }

    /// Under session, number and version of what it answers, for whoever asked reads that version.
    fn answer(&mut self, asked: Asked, reply: Reply, what: What) {
        let message = Message::Reply(reply);
        self.send(asked.transport, asked.header, &message, asked.ours, what);
    }

    /// Sends a message; signed where it is `ours` and the open session asks for it.
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
