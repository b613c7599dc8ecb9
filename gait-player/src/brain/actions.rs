//! Effects of authorised requests. Each arm of [`Brain::act`] is the whole effect of one request; [`super::requests`] has
//! checked its authority.

use super::requests::ReplyAddress;
use super::settings::Settings;
use super::state::State;
use super::work::Work;
use super::{Brain, Transport, settings};
use crate::route::Route;
use crate::servo::ServoMap;
use crate::table::check::Checker;
use link_protocol::{
    BenchStatus, Checked, Configuration, Follow, Joint, MAX_DETACHED_US, Play, PulseRange, Refusal,
    Reply, Request, ServoSettings,
};

/// Outcome of a request: its reply, or `None` if that comes later.
type Outcome = Result<Option<Reply>, Refusal>;

const DONE: Outcome = Ok(Some(Reply::Done));
/// The reply follows when the work is done.
const LATER: Outcome = Ok(None);

impl Brain {
    /// Applies a request. Returns `None` if the reply comes later.
    pub(super) fn act(&mut self, now_us: u64, asked: ReplyAddress, request: &Request) -> Outcome {
        match request {
            Request::Status => Ok(Some(Reply::Status(self.status(now_us)))),
            Request::Counters => Ok(Some(Reply::Counters(self.counters()))),
            Request::Configuration => Ok(Some(Reply::Configuration(self.settings.configuration))),
            Request::Configure(configuration) => self.configure(configuration),
            Request::Servo(joint) => Ok(Some(Reply::Servo(self.settings.servos[joint.index()]))),
            Request::SetServo { joint, settings } => {
                self.only_idle()?;
                settings::check_servo(settings, &self.firmware_limits)?;
                self.change_servos(|servos| servos.servos[joint.index()] = *settings)?;
                DONE
            }
            Request::PulseRange(joint) => {
                let range = self.settings.window(joint.index(), &self.firmware_limits);
                Ok(Some(Reply::PulseRange(range)))
            }
            Request::SetPulseRange { joint, range } => {
                self.only_idle()?;
                self.set_pulse_range(*joint, *range)
            }
            Request::SetPassive(joint) => {
                self.only_idle()?;
                self.settings.passive = *joint;
                self.persist.settings_changed();
                DONE
            }
            Request::Trim { joint, trim } => self.trim(*joint, *trim),
            Request::Begin(begin) => {
                self.only_idle()?;
                let upload = asked.header.sequence;
                let offset = self.tables.begin(upload, *begin)?;
                Ok(Some(Reply::Wanted { upload, offset }))
            }
            // Handled before the check of the sequence number.
            Request::Chunk(_) => Err(Refusal::NoUpload),
            Request::Commit { upload } => self.commit(asked, *upload, None),
            Request::Follow(follow) => self.follow(asked, *follow),
            Request::Arm => self.arm(),
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
            // Handled before all other checks.
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
                self.only_idle()?;
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
            Request::ClearEStop { count } => match self.state {
                State::EStopped if *count != self.estops => {
                    Err(Refusal::EStopCount { count: self.estops })
                }
                State::EStopped => {
                    self.resets.estop = false;
                    self.state = State::Stopped;
                    DONE
                }
                State::Stopped => DONE,
                state => Err(Refusal::WrongState(state.name())),
            },
            Request::EnterBootLoader => {
                self.only_idle()?;
                // This run ends early, but not by a fault, so it is not a short run.
                self.clear_starts();
                self.bench.leave(now_us);
                DONE
            }
        }
    }

    fn configure(&mut self, wanted: &Configuration) -> Outcome {
        self.only_idle()?;
        let model = settings::check_configuration(wanted, &self.firmware_limits)?;
        self.model = model;
        self.settings.configuration = *wanted;
        self.settings_changed();
        self.tables.forget_facts();
        DONE
    }

    fn only_idle(&self) -> Result<(), Refusal> {
        if matches!(self.work, Work::Idle) {
            Ok(())
        } else {
            Err(Refusal::Busy)
        }
    }

    /// Changes maps or ranges of the servos. Refuses the change if map and range no longer overlap.
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

    /// Sets the pulse range of a servo. The firmware's whole window is stored as no range, because it does not bound the
    /// angles.
    fn set_pulse_range(&mut self, joint: Joint, range: PulseRange) -> Outcome {
        let whole = PulseRange {
            shortest_ns: self.firmware_limits.pulse_min_ns,
            longest_ns: self.firmware_limits.pulse_max_ns,
        };
        let range = (range != whole).then_some(range);
        self.change_servos(|settings| settings.ranges[joint.index()] = range)?;
        DONE
    }

    /// Sets a trim. While pulses are on they then correspond to another angle, from which the joint returns within the rate
    /// limit. The trim is refused if that angle lies beyond the largest one: a stop could not reach neutral in time.
    fn trim(&mut self, joint: Joint, trim: i16) -> Outcome {
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

    /// Schedules the uploaded table to play after the present play.
    fn follow(&mut self, asked: ReplyAddress, follow: Follow) -> Outcome {
        let Some(under_way) = self.state.play() else {
            return Err(Refusal::WrongState(self.state.name()));
        };
        let play = Play {
            cycles: follow.cycles,
            period_us: follow.period_us,
            detached: under_way.request.detached,
            checked: follow.checked,
        };
        let left_us = self.last_play.unwrap_or(*under_way).left_us();
        check_play(&play, left_us).map_err(|refusal| match refusal {
            // Position of the period among the fields of this request.
            Refusal::BadValue { .. } => Refusal::BadValue { field: 2 },
            refusal => refusal,
        })?;
        self.check_held(play.checked, Some(self.tables.staging().crc32()))?;
        self.commit(asked, follow.upload, Some(play))
    }

    fn commit(&mut self, asked: ReplyAddress, upload: u16, follow: Option<Play>) -> Outcome {
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

    /// Refuses a play unless table and settings are those that its host checked.
    pub(super) fn check_held(&self, checked: Checked, table: Option<u32>) -> Result<(), Refusal> {
        let table = table.ok_or(Refusal::NoTable)?;
        if checked.table_crc32 != table {
            return Err(Refusal::OtherTable { held: table });
        }
        let settings = self.settings_crc32();
        if checked.settings_crc32 != settings {
            return Err(Refusal::OtherSettings { held: settings });
        }
        Ok(())
    }

    fn arm(&mut self) -> Outcome {
        if self.state == State::EStopped {
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
        if !matches!(self.state, State::Holding { .. }) {
            self.state = State::Holding {
                pose: self.commanded,
            };
        }
        DONE
    }

    fn play(&mut self, asked: ReplyAddress, play: Play) -> Outcome {
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
        check_play(&play, 0)?;
        self.check_held(play.checked, self.tables.active_crc32())?;
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
                // A repeated request does not extend the minute of a detached pause.
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

/// Refuses a period below one tick, and a detached play that could move the robot too long without a host. `before_us` is the
/// remaining motion ahead of it, µs.
fn check_play(play: &Play, before_us: u64) -> Result<(), Refusal> {
    if play.period_us < crate::TICK_US {
        return Err(Refusal::BadValue { field: 1 });
    }
    let duration_us = u64::from(play.cycles) * u64::from(play.period_us);
    let endless = play.cycles == 0;
    if play.detached && (endless || before_us.saturating_add(duration_us) > MAX_DETACHED_US) {
        return Err(Refusal::DetachedTooLong);
    }
    Ok(())
}
