//! What a frame from the link does. Each arm of [`Brain::act`] is one request's whole meaning.

use super::state::State;
use super::work::Work;
use super::{Brain, count, settings};
use crate::route::Route;
use crate::servo::ServoMap;
use crate::table::check::Checker;
use link_protocol::{
    Arm, BodyError, Header, Hello, Joint, Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Ping, Play,
    Pong, Received, Refusal, Reply, Request, ServoSettings, StopCause,
};

use super::session::{Admission, Order};

/// What a request comes to.
type Outcome = Result<Option<Reply>, Refusal>;

const DONE: Outcome = Ok(Some(Reply::Done));
/// The answer comes when the work is done.
const LATER: Outcome = Ok(None);

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
        if matches!(request, Request::Stop | Request::EStop) {
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

    fn act(&mut self, now_us: u64, header: Header, request: &Request) -> Outcome {
        match request {
            Request::Status => Ok(Some(Reply::Status(self.status(now_us)))),
            Request::Counters => Ok(Some(Reply::Counters(self.counters()))),
            Request::Configuration => Ok(Some(Reply::Configuration(self.settings.configuration))),
            Request::Configure(configuration) => {
                self.only_stopped()?;
                self.model = settings::check_configuration(configuration, &self.firmware_limits)?;
                self.settings.configuration = *configuration;
                self.limits = self.firmware_limits.tightened(configuration);
                self.tables.forget_facts();
                self.persist.settings_changed();
                DONE
            }
            Request::Servo(joint) => Ok(Some(Reply::Servo(self.settings.servos[joint.index()]))),
            Request::SetServo { joint, settings } => {
                self.only_stopped()?;
                settings::check_servo(settings, &self.firmware_limits)?;
                self.set_servo(*joint, *settings);
                DONE
            }
            Request::Trim { joint, trim } => self.trim(*joint, *trim),
            Request::Begin(begin) => {
                self.only_idle()?;
                let offset = self.tables.begin(header.sequence, *begin)?;
                Ok(Some(Reply::Wanted {
                    upload: header.sequence,
                    offset,
                }))
            }
            // Handled before the order of requests.
            Request::Chunk(_) => Err(Refusal::NoUpload),
            Request::Commit { upload } => self.commit(header, *upload),
            Request::Arm(arm) => self.arm(*arm),
            Request::Play(play) => self.play(header, *play),
            Request::Pause { detached } => self.pause(now_us, *detached),
            Request::Resume => match self.state {
                State::Paused { play, .. } => {
                    self.state = State::Playing {
                        since: self.tick,
                        play,
                    };
                    DONE
                }
                state => Err(Refusal::WrongState(state.name())),
            },
            // Handled before everything else.
            Request::Stop | Request::EStop => DONE,
            Request::ClearResets => match self.resets.wait_s() {
                Some(wait_s) if wait_s > 0 => Err(Refusal::ResetLoop { wait_s }),
                _ => {
                    self.resets.clear();
                    DONE
                }
            },
            Request::CrashMessage => Ok(Some(Reply::CrashMessage(self.boot.crash_message.clone()))),
            Request::Table => Ok(Some(Reply::Table(self.table_info()))),
            Request::SetKey(key) => {
                self.only_stopped()?;
                self.settings.key = *key;
                self.persist.settings_changed();
                DONE
            }
        }
    }

    fn only_stopped(&self) -> Result<(), Refusal> {
        match self.state {
            State::Stopped => self.only_idle(),
            state => Err(Refusal::WrongState(state.name())),
        }
    }

    fn only_idle(&self) -> Result<(), Refusal> {
        if matches!(self.work, Work::Idle) {
            Ok(())
        } else {
            Err(Refusal::Busy)
        }
    }

    fn set_servo(&mut self, joint: Joint, settings: ServoSettings) {
        self.settings.servos[joint.index()] = settings;
        self.persist.settings_changed();
    }

    /// Sets a trim. While the pulses are on they stand for another angle from then on, and the joint moves back from there
    /// no faster than allowed; where that angle would lie beyond the largest, no stop could reach neutral in its time.
    fn trim(&mut self, joint: Joint, trim: i16) -> Outcome {
        if !matches!(
            self.state,
            State::Stopped | State::EStopped | State::Holding { .. } | State::Paused { .. }
        ) {
            return Err(Refusal::WrongState(self.state.name()));
        }
        settings::check_trim(trim)?;
        let settings = ServoSettings {
            trim,
            ..self.settings.servos[joint.index()]
        };
        if let Some(pulses_ns) = self.clamp.last() {
            let angle = ServoMap::from(settings).angle(pulses_ns[joint.index()]);
            if libm::fabsf(angle) > self.limits.max_angle {
                return Err(Refusal::WrongState(self.state.name()));
            }
            self.commanded[joint.index()] = angle;
        }
        self.set_servo(joint, settings);
        DONE
    }

    fn commit(&mut self, header: Header, upload: u16) -> Outcome {
        self.only_idle()?;
        if let Err(refusal) = self.tables.complete(upload) {
            if matches!(refusal, Refusal::CrcMismatch { .. }) {
                self.tables.abandon();
            }
            return Err(refusal);
        }
        self.work = Work::Commit {
            reply_to: header,
            checker: Checker::new(),
        };
        LATER
    }

    fn arm(&mut self, arm: Arm) -> Outcome {
        if self.state == State::EStopped && !arm.clear_estop {
            return Err(Refusal::EStopped);
        }
        if matches!(
            self.state,
            State::Starting { .. } | State::Playing { .. } | State::Paused { .. }
        ) {
            return Err(Refusal::WrongState(self.state.name()));
        }
        if self.battery.low() {
            let measured_mv = self.battery.mv().unwrap_or_default();
            return Err(Refusal::BatteryLow {
                measured_mv,
                limit_mv: self.limits.battery_limit_mv,
            });
        }
        if let Some(wait_s) = self.resets.wait_s() {
            return Err(Refusal::ResetLoop { wait_s });
        }
        self.resets.estop = false;
        if !matches!(self.state, State::Holding { .. }) {
            self.state = State::Holding {
                pose: self.commanded,
            };
        }
        DONE
    }

    fn play(&mut self, header: Header, play: Play) -> Outcome {
        match self.state {
            State::Holding { .. } => {}
            State::EStopped => return Err(Refusal::EStopped),
            State::Stopped | State::Stopping { .. } | State::Settling { .. } => {
                return Err(Refusal::NotArmed);
            }
            State::Starting { .. } | State::Playing { .. } | State::Paused { .. } => {
                return Err(Refusal::WrongState(self.state.name()));
            }
        }
        self.only_idle()?;
        if play.period_us < crate::TICK_US {
            return Err(Refusal::BadValue { field: 1 });
        }
        if play.detached && play.cycles == 0 {
            return Err(Refusal::DetachedEndless);
        }
        if self.tables.active().is_none() {
            return Err(Refusal::NoTable);
        }
        self.work = Work::Play {
            reply_to: header,
            play,
            route: None::<Route>,
        };
        LATER
    }

    fn pause(&mut self, now_us: u64, detached: bool) -> Outcome {
        match self.state {
            State::Playing { play, .. } => {
                let play = self.last_play.unwrap_or(play);
                self.state = State::Paused {
                    pose: self.commanded,
                    since_us: now_us,
                    detached,
                    play,
                };
                DONE
            }
            State::Paused {
                pose,
                since_us,
                detached: before,
                play,
            } => {
                // The minute without a link begins when it is first asked for.
                let since_us = if detached && !before {
                    now_us
                } else {
                    since_us
                };
                self.state = State::Paused {
                    pose,
                    since_us,
                    detached,
                    play,
                };
                DONE
            }
            state => Err(Refusal::WrongState(state.name())),
        }
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
