//! What a frame from the link does: who may ask, in which order, and what is answered. What a request means is in
//! [`super::actions`].

use super::session::{Admission, Order};
use super::{Brain, count};
use link_protocol::{
    BodyError, Header, Hello, Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Ping, Pong, Received,
    Refusal, Reply, Request, StopCause,
};

impl Brain {
    pub(super) fn handle(&mut self, now_us: u64, received: Received, admission: Admission) {
        let header = received.header;
        match received.message {
            Ok(Message::Hello(hello)) => self.greet(header, &hello),
            Ok(Message::Request(request)) => self.request(now_us, header, &request, admission),
            Ok(Message::KeepAlive) => {
                self.hear(now_us, admission);
            }
            Ok(Message::Ping(Ping { host_us })) => {
                if self.hear(now_us, admission) {
                    let pong = Pong {
                        host_us,
                        received_us: now_us,
                        sent_us: now_us,
                    };
                    self.outbox.send(
                        Header::new(header.session, header.sequence),
                        &Message::Pong(pong),
                    );
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
                self.refuse(
                    header,
                    Refusal::Version {
                        min: PROTOCOL_MIN,
                        current: PROTOCOL_CURRENT,
                    },
                );
            }
            Err(BodyError::Malformed | BodyError::TrailingBytes(_)) => {
                self.refuse(header, Refusal::NotUnderstood);
            }
        }
    }

    fn greet(&mut self, header: Header, hello: &Hello) {
        let understood =
            hello.protocol_min <= PROTOCOL_CURRENT && hello.protocol_current >= PROTOCOL_MIN;
        // Session 0: none. The reply says why.
        let session = if understood {
            self.session
                .greet(hello.host_nonce, self.settings.key.as_ref())
        } else {
            0
        };
        let reply = self.hello_reply(hello.host_nonce, session);
        self.outbox.send(
            Header::new(session, header.sequence),
            &Message::HelloReply(reply),
        );
    }

    /// True where the frame is ours, and so keeps the link alive.
    fn hear(&mut self, now_us: u64, admission: Admission) -> bool {
        let ours = admission == Admission::Ours;
        if ours {
            self.session.hear(now_us);
        } else {
            count(&mut self.counted.stale);
        }
        ours
    }

    fn request(&mut self, now_us: u64, header: Header, request: &Request, admission: Admission) {
        // These act whatever else holds. Where their number is the next one, it takes its place in the order.
        if request.is_stop() {
            if *request == Request::Stop {
                self.stop(StopCause::Requested);
            } else {
                self.estop();
            }
            let ours = admission == Admission::Ours;
            if ours {
                self.session.hear(now_us);
                self.session.order(header.sequence);
            }
            count(&mut self.counted.acted);
            return self.answer_stop(header, ours);
        }
        if !self.hear(now_us, admission) {
            return self.turn_away(header, admission);
        }
        if let Request::Chunk(chunk) = request {
            // Acts by its offset, whatever the order, and keeps no reply.
            return match self.tables.chunk(chunk) {
                Ok(offset) => self.reply(
                    header,
                    Reply::Wanted {
                        upload: chunk.upload,
                        offset,
                    },
                ),
                Err(refusal) => self.refuse(header, refusal),
            };
        }
        match self.session.order(header.sequence) {
            Order::Next => {}
            Order::Repeat => {
                count(&mut self.counted.replayed);
                return match self.session.kept() {
                    Some(body) => self.outbox.send_reply_body(answer(header), body),
                    None => self.reply(header, Reply::Working),
                };
            }
            Order::Superseded { last } => {
                count(&mut self.counted.superseded);
                return self.refuse(header, Refusal::Superseded { last });
            }
        }
        match self.act(now_us, header, request) {
            Ok(Some(reply)) => {
                count(&mut self.counted.acted);
                self.finish(header, reply);
            }
            Ok(None) => count(&mut self.counted.acted),
            Err(refusal) => self.finish(header, Reply::Refused(refusal)),
        }
    }

    /// A stop is answered to whoever sent it; only ours has a place in the order, where its answer is kept.
    fn answer_stop(&mut self, header: Header, ours: bool) {
        if ours {
            self.session.keep(header.sequence, &Reply::Done);
        }
        self.outbox
            .send_stop_answer(answer(header), &Message::Reply(Reply::Done));
    }

    /// Says why a request may not act.
    fn turn_away(&mut self, header: Header, admission: Admission) {
        let refusal = match admission {
            // What came twice was answered once: a second answer would only undo it.
            Admission::Ours | Admission::Replayed => return,
            Admission::Foreign => Refusal::StaleSession {
                open: self.session.number(),
            },
            Admission::Unsigned => Refusal::KeyNeeded,
            Admission::WrongKey => Refusal::WrongKey,
        };
        self.refuse(header, refusal);
    }

    /// The answer to a request, kept for its repeats.
    pub(super) fn finish(&mut self, header: Header, reply: Reply) {
        if matches!(reply, Reply::Refused(_)) {
            count(&mut self.counted.refused);
        }
        if header.session == self.session.number() {
            self.session.keep(header.sequence, &reply);
        }
        self.reply(header, reply);
    }

    fn refuse(&mut self, header: Header, refusal: Refusal) {
        count(&mut self.counted.refused);
        self.reply(header, Reply::Refused(refusal));
    }

    fn reply(&mut self, header: Header, reply: Reply) {
        self.outbox.send(answer(header), &Message::Reply(reply));
    }
}

/// The header of an answer: session and sequence of what it answers, in the version spoken here.
fn answer(header: Header) -> Header {
    Header::new(header.session, header.sequence)
}
