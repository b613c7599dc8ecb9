//! Motion per tick: set-points of every state, and the failsafes that end a motion.

use super::Brain;
use super::state::{Progress, State};
use super::tables::{Swap, SwapWay};
use super::work::Work;
use crate::TICK_US;
use crate::ramp::{NEUTRAL, Ramp};
use link_protocol::{Play, Refusal, Reply, StopCause};

/// Time with pulses on at neutral before they go off, µs.
const SETTLE_US: u64 = 500_000;
/// Longest detached pause, µs.
const DETACHED_PAUSE_US: u64 = 60_000_000;

impl Brain {
    /// Failsafes: stops a motion that must end. The most severe cause is reported.
    pub(super) fn watch(&mut self, now_us: u64) {
        if let State::Paused {
            since_us,
            detached: true,
            ..
        } = self.state
            && now_us.saturating_sub(since_us) >= DETACHED_PAUSE_US
        {
            self.stop(StopCause::PauseExpired);
        }
        // A robot that is already stopping does not need a live link.
        let stopping = matches!(self.state, State::Stopping { .. } | State::Settling { .. });
        if self.state.powered()
            && !stopping
            && !self.state.detached()
            && self.session.silent(now_us)
        {
            self.stop(StopCause::LinkLost);
        }
        if self.battery_stops && self.state.powered() {
            self.stop(StopCause::BatteryLow);
        }
    }

    /// Starts the ramp to neutral from the commanded angles; latched. A robot that is already stopping keeps the more severe
    /// cause.
    pub(super) fn stop(&mut self, cause: StopCause) {
        self.drop_work();
        match self.state {
            State::Stopped | State::EStopped => {}
            State::Stopping { .. } | State::Settling { .. } => {
                self.cause = self.cause.max(cause);
            }
            State::Holding { .. }
            | State::Starting { .. }
            | State::Playing { .. }
            | State::Paused { .. } => {
                let ramp = Ramp::to_neutral(self.commanded, &self.limits);
                self.leave_play(State::Stopping {
                    ramp,
                    since: self.tick,
                });
                self.cause = cause;
            }
        }
    }

    /// Switches the pulses off from the next tick on; latched.
    pub(super) fn estop(&mut self) {
        self.drop_work();
        self.leave_play(State::EStopped);
        self.cause = StopCause::EStop;
        self.estops = self.estops.wrapping_add(1);
        self.resets.estop = true;
    }

    /// Cancels a request that waits for its check, and sends its refusal: the host that stops may be another one. A commit may
    /// be repeated.
    fn drop_work(&mut self) {
        let (reply_to, refusal) = match core::mem::replace(&mut self.work, Work::Idle) {
            Work::Idle => return,
            Work::Commit { reply_to, .. } | Work::Swap { reply_to, .. } => {
                (reply_to, Refusal::Busy)
            }
            Work::Play { reply_to, .. } => (reply_to, Refusal::NotArmed),
        };
        self.finish(reply_to, Reply::Refused(refusal));
    }

    /// Ends a play early. A committed table becomes active at once; a follower is dropped, because it never played.
    fn leave_play(&mut self, state: State) {
        self.state = state;
        match self.tables.swap() {
            None => {}
            Some(Swap {
                facts,
                way: SwapWay::Ramp { .. },
            }) => {
                self.tables.activate_staging(facts);
                self.persist.table_changed();
            }
            Some(Swap {
                way: SwapWay::Follow(_),
                ..
            }) => self.tables.abandon(),
        }
    }

    /// Returns the set-point of this tick, rad; `None` if pulses are off.
    pub(super) fn advance_motion(&mut self, tick: u64, last: u64) -> Option<[f32; 2]> {
        let since_start = |since: u64| tick.saturating_sub(since) * u64::from(TICK_US);
        match self.state {
            State::Stopped | State::EStopped => None,
            State::Holding { pose } | State::Paused { pose, .. } => Some(pose),
            State::Starting { ramp, since, play } => {
                let elapsed_us = since_start(since);
                if elapsed_us < u64::from(ramp.duration_us()) {
                    return Some(ramp.at(elapsed_us));
                }
                self.state = State::Playing { since: tick, play };
                Some(self.advance_play_by(play, 0, 0))
            }
            State::Playing { since, play } => {
                let before = last.saturating_sub(since) * u64::from(TICK_US);
                Some(self.advance_play_by(play, before, since_start(since)))
            }
            State::Stopping { ramp, since } => {
                let elapsed_us = since_start(since);
                if elapsed_us >= u64::from(ramp.duration_us()) {
                    self.state = State::Settling { since: tick };
                }
                Some(ramp.at(elapsed_us))
            }
            State::Settling { since } => {
                if since_start(since) < SETTLE_US {
                    return Some(NEUTRAL);
                }
                self.state = State::Stopped;
                None
            }
        }
    }

    /// Angles of the table `elapsed_us` after the state `play`; `before_us` is the same for the previous tick.
    fn advance_play_by(&mut self, play: Progress, before_us: u64, elapsed_us: u64) -> [f32; 2] {
        let before = Progress {
            elapsed_us: play.elapsed_us.saturating_add(before_us),
            ..play
        };
        let mut now = Progress {
            elapsed_us: play.elapsed_us.saturating_add(elapsed_us),
            ..play
        };
        let Some(table) = self.tables.active() else {
            // Defensive: a play without a table cannot begin.
            self.stop(StopCause::Requested);
            return self.commanded;
        };
        let end = table.knot_angles(0);
        let swap = self.tables.swap();
        let cycle_done = now.cycles_done() > before.cycles_done();
        if let Some(Swap {
            facts,
            way: SwapWay::Follow(next),
        }) = swap
            && (now.finished() || now.request.cycles == 0 && cycle_done)
        {
            self.tables.activate_staging(facts);
            self.persist.table_changed();
            return self.begin_follower(now, next);
        }
        if now.finished() {
            now.elapsed_us = now.period_us() * u64::from(now.request.cycles);
            self.last_play = Some(now);
            let ramp = Ramp::to_neutral(end, &self.limits);
            self.leave_play(State::Stopping {
                ramp,
                since: self.tick,
            });
            self.cause = StopCause::Finished;
            return end;
        }
        if let Some(Swap {
            facts,
            way: SwapWay::Ramp { via_neutral },
        }) = swap
            && cycle_done
        {
            self.tables.activate_staging(facts);
            self.persist.table_changed();
            let first = self
                .tables
                .active()
                .map_or(NEUTRAL, |table| table.knot_angles(0));
            // Starts at the end of this cycle, where the route was checked.
            let ramp = Ramp::soft(end, first, via_neutral, &self.limits);
            now.elapsed_us = now.period_us() * now.cycles_done();
            self.last_play = Some(now);
            self.state = State::Starting {
                ramp,
                since: self.tick,
                play: now,
            };
            return end;
        }
        let angles = table
            .at(table.phase(now.in_cycle_us(), now.request.period_us))
            .angles;
        self.last_play = Some(now);
        angles
    }

    /// First set-point of the follower. Both tables share this knot, so the play continues within this tick.
    fn begin_follower(&mut self, done: Progress, next: Play) -> [f32; 2] {
        let cycles = match done.request.cycles {
            0 => done.cycles_done(),
            cycles => u64::from(cycles),
        };
        let play = Progress {
            request: next,
            elapsed_us: done.elapsed_us.saturating_sub(done.period_us() * cycles),
        };
        self.state = State::Playing {
            since: self.tick,
            play,
        };
        self.last_play = Some(play);
        self.tables.active().map_or(NEUTRAL, |table| {
            table
                .at(table.phase(play.in_cycle_us(), next.period_us))
                .angles
        })
    }
}
