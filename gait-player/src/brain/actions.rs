//! What a request that may act does. Each arm of [`Brain::act`] is one request's whole meaning.

use super::requests::Asked;
use super::settings::Settings;
use super::state::State;
use super::work::Work;
use super::{Brain, Transport, settings};
use crate::route::Route;
use crate::servo::ServoMap;
use crate::table::check::Checker;
use link_protocol::{
    Arm, BenchStatus, Configuration, Follow, Joint, Play, PulseRange, Refusal, Reply, Request,
    ServoSettings,
};

/// What a request comes to.
type Outcome = Result<Option<Reply>, Refusal>;

const DONE: Outcome = Ok(Some(Reply::Done));
/// The answer comes when the work is done.
const LATER: Outcome = Ok(None);

impl Brain {
    /// Does what is asked; `None` where the answer comes later.
    pub(super) fn act(&mut self, now_us: u64, asked: Asked, request: &Request) -> Outcome {
        match request {
            Request::Status => Ok(Some(Reply::Status(self.status(now_us)))),
            Request::Counters => Ok(Some(Reply::Counters(self.counters()))),
            Request::Configuration => Ok(Some(Reply::Configuration(self.settings.configuration))),
            Request::Configure(configuration) => self.configure(now_us, asked, configuration),
            Request::Servo(joint) => Ok(Some(Reply::Servo(self.settings.servos[joint.index()]))),
            Request::SetServo { joint, settings } => {
                self.only_stopped()?;
                settings::check_servo(settings, &self.firmware_limits)?;
                self.change_servos(|servos| servos.servos[joint.index()] = *settings)?;
                DONE
            }
            Request::PulseRange(joint) => {
                let range = self.settings.window(joint.index(), &self.firmware_limits);
                Ok(Some(Reply::PulseRange(range)))
            }
            Request::SetPulseRange { joint, range } => {
                self.only_stopped()?;
                self.set_pulse_range(*joint, *range)
            }
            Request::Trim { joint, trim } => self.trim(*joint, *trim),
            Request::Begin(begin) => {
                self.only_idle()?;
                let upload = asked.header.sequence;
                let offset = self.tables.begin(upload, *begin)?;
                Ok(Some(Reply::Wanted { upload, offset }))
            }
            // Handled before the order of requests.
            Request::Chunk(_) => Err(Refusal::NoUpload),
            Request::Commit { upload } => self.commit(asked, *upload, None),
            Request::Follow(follow) => self.follow(asked, *follow),
            Request::Arm(arm) => self.arm(*arm),
            Request::Play(play) => self.play(asked, *play),
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
                // A key that holds already signed this: only the first one is anybody's.
                if self.settings.key.is_none() && key.is_some() {
                    self.only_present(now_us, asked)?;
                }
                self.settings.key = *key;
                self.persist.settings_changed();
                DONE
            }
            Request::Bench => Ok(Some(Reply::Bench(BenchStatus {
                window_s: self.bench.left_s(now_us),
                usb: asked.transport == Transport::Usb,
                short_starts: self.starts.runs,
                built: self.built,
            }))),
            Request::ClearEStop => match self.state {
                State::EStopped => {
                    self.resets.estop = false;
                    self.state = State::Stopped;
                    DONE
                }
                State::Stopped => DONE,
                state => Err(Refusal::WrongState(state.name())),
            },
            Request::EnterBootLoader => {
                self.only_stopped()?;
                self.only_present(now_us, asked)?;
                // This run ends early, but not by a fault.
                self.clear_starts();
                self.bench.leave(now_us);
                DONE
            }
        }
    }

    /// Somebody is at the robot: at the other end of its cable, or within the bench window.
    fn only_present(&self, now_us: u64, asked: Asked) -> Result<(), Refusal> {
        if asked.transport == Transport::Usb || self.bench.open(now_us) {
            Ok(())
        } else {
            Err(Refusal::NeedsPresence)
        }
    }

    fn configure(&mut self, now_us: u64, asked: Asked, wanted: &Configuration) -> Outcome {
        self.only_stopped()?;
        let model = settings::check_configuration(wanted, &self.firmware_limits)?;
        if settings::needs_presence(wanted, &self.settings.configuration, &self.built) {
            self.only_present(now_us, asked)?;
        }
        self.model = model;
        self.settings.configuration = *wanted;
        self.settings_changed();
        self.tables.forget_facts();
        DONE
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

    /// Changes maps or ranges of the servos, where they then still meet.
    fn change_servos(&mut self, change: impl FnOnce(&mut Settings)) -> Result<(), Refusal> {
        let mut changed = self.settings;
        change(&mut changed);
        changed.reach(&self.firmware_limits)?;
        self.settings = changed;
        self.settings_changed();
        Ok(())
    }

    fn settings_changed(&mut self) {
        self.limits = self.limits_now();
        self.persist.settings_changed();
    }

    /// The firmware's whole window is no range: with it the angles are not bounded by pulses.
    fn set_pulse_range(&mut self, joint: Joint, range: PulseRange) -> Outcome {
        let whole = PulseRange {
            shortest_ns: self.firmware_limits.pulse_min_ns,
            longest_ns: self.firmware_limits.pulse_max_ns,
        };
        let range = (range != whole).then_some(range);
        self.change_servos(|settings| settings.ranges[joint.index()] = range)?;
        DONE
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
        let change = |servos: &mut Settings| servos.servos[joint.index()] = settings;
        let mut trimmed = self.settings;
        change(&mut trimmed);
        trimmed
            .reach(&self.firmware_limits)
            .or(Err(Refusal::BadValue { field: 1 }))?;
        if let Some(pulses_ns) = self.clamp.last() {
            let angle = ServoMap::from(settings).angle(pulses_ns[joint.index()]);
            if libm::fabsf(angle) > self.limits.max_angle {
                return Err(Refusal::WrongState(self.state.name()));
            }
            self.commanded[joint.index()] = angle;
        }
        self.change_servos(change)?;
        DONE
    }

    /// The upload as what follows the play under way.
    fn follow(&mut self, asked: Asked, follow: Follow) -> Outcome {
        let Some(under_way) = self.state.play() else {
            return Err(Refusal::WrongState(self.state.name()));
        };
        let play = Play {
            cycles: follow.cycles,
            period_us: follow.period_us,
            detached: under_way.request.detached,
        };
        check_play(&play).map_err(|refusal| match refusal {
            // The period's place among the fields of this request.
            Refusal::BadValue { .. } => Refusal::BadValue { field: 2 },
            refusal => refusal,
        })?;
        self.commit(asked, follow.upload, Some(play))
    }

    fn commit(&mut self, asked: Asked, upload: u16, follow: Option<Play>) -> Outcome {
        self.only_idle()?;
        if let Err(refusal) = self.tables.complete(upload) {
            if matches!(refusal, Refusal::CrcMismatch { .. }) {
                self.tables.abandon();
            }
            return Err(refusal);
        }
        self.work = Work::Commit {
            reply_to: asked,
            checker: Checker::new(),
            follow,
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

    fn play(&mut self, asked: Asked, play: Play) -> Outcome {
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
        check_play(&play)?;
        if self.tables.active().is_none() {
            return Err(Refusal::NoTable);
        }
        self.work = Work::Play {
            reply_to: asked,
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
                // The minute of a detached pause begins when it is first asked for.
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
}

/// A period that is one, and an end where nobody would end it.
fn check_play(play: &Play) -> Result<(), Refusal> {
    if play.period_us < crate::TICK_US {
        return Err(Refusal::BadValue { field: 1 });
    }
    if play.detached && play.cycles == 0 {
        return Err(Refusal::DetachedEndless);
    }
    Ok(())
}
