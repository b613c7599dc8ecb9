//! Work that exceeds a tick: checks of a table or a route. It runs in pieces, and its request gets the reply at the end.

use super::Brain;
use super::requests::ReplyAddress;
use super::tables::{Swap, SwapWay};
use crate::ramp::Ramp;
use crate::route::{Decision, Route};
use crate::table::check::{CLEARANCE_WORK, Checker, Facts};
use link_protocol::{CrossingPlace, Joint, Play, Refusal, Reply};

use super::state::{Progress, State};

/// Units of work per tick while pulses are on. A unit takes up to 0.22 ms on the chip, and a tick without work up to 1 ms; the
/// sum stays below the promised 2 ms (measured on the emulated boards).
const POWERED_WORK: u32 = 3;
/// Units per tick while pulses are off: 16 ms.
const IDLE_WORK: u32 = 70;
/// Units of one clearance evaluation on a route.
const LOOK_WORK: u32 = CLEARANCE_WORK;

/// Work in progress.
#[derive(Clone, Debug)]
pub(crate) enum Work {
    /// No work.
    Idle,
    /// Check of a committed table, with the play to follow if there is one.
    Commit {
        reply_to: ReplyAddress,
        checker: Checker,
        follow: Option<Play>,
    },
    /// Route of a swap, from the first knot of the playing table to that of the new one.
    Swap {
        reply_to: ReplyAddress,
        facts: Facts,
        route: Route,
    },
    /// Check of a play's table, then of its route from the commanded angles.
    Play {
        reply_to: ReplyAddress,
        play: Play,
        route: Option<Route>,
    },
}

impl Brain {
    /// Does the work of one tick.
    pub(super) fn advance_work(&mut self) {
        let mut left = if self.state.powered() {
            POWERED_WORK
        } else {
            IDLE_WORK
        };
        let links = self.model.swimmer().links;
        match core::mem::replace(&mut self.work, Work::Idle) {
            Work::Idle => self.tables.check_active(&links, left),
            Work::Commit {
                reply_to,
                mut checker,
                follow,
            } => match (checker.advance(self.tables.staging(), &links, left), follow) {
                (None, _) => {
                    self.work = Work::Commit {
                        reply_to,
                        checker,
                        follow,
                    }
                }
                (Some(facts), None) => self.table_checked(reply_to, facts),
                (Some(facts), Some(play)) => self.follower_checked(reply_to, facts, play),
            },
            Work::Swap {
                reply_to,
                facts,
                mut route,
            } => {
                while left >= LOOK_WORK {
                    left -= LOOK_WORK;
                    match route.advance(&links) {
                        Decision::Unknown => {}
                        decision => return self.swap_decided(reply_to, facts, decision),
                    }
                }
                self.work = Work::Swap {
                    reply_to,
                    facts,
                    route,
                };
            }
            Work::Play {
                reply_to,
                play,
                route,
            } => {
                if let Some(facts) = self.tables.facts() {
                    return self.advance_play(reply_to, play, route, facts, left);
                }
                self.tables.check_active(&links, left);
                self.work = Work::Play {
                    reply_to,
                    play,
                    route,
                };
            }
        }
    }

    fn table_checked(&mut self, reply_to: ReplyAddress, facts: Facts) {
        let allowed = facts
            .allow(&self.limits)
            .and_then(|()| match self.state.play() {
                Some(play) => facts.allow_period(&self.limits, play.request.period_us),
                None => Ok(()),
            });
        match (allowed, self.state.play(), self.tables.active()) {
            (Err(refusal), _, _) => {
                self.tables.abandon();
                self.finish(reply_to, Reply::Refused(refusal));
            }
            (Ok(()), Some(_), Some(active)) => {
                let route = Route::new(active.knot_angles(0), self.tables.staging().knot_angles(0));
                self.work = Work::Swap {
                    reply_to,
                    facts,
                    route,
                };
            }
            (Ok(()), _, _) => self.activate(reply_to, facts),
        }
    }

    /// Schedules a follower for the end of the last cycle, if the play has not ended yet.
    fn follower_checked(&mut self, reply_to: ReplyAddress, facts: Facts, play: Play) {
        let allowed = facts
            .allow(&self.limits)
            .and_then(|()| facts.allow_period(&self.limits, play.period_us))
            .and_then(|()| self.check_held(play.checked, Some(self.tables.staging().crc32())))
            .and_then(|()| match (self.state.play(), self.tables.active()) {
                (Some(_), Some(active)) => joins(active.knot(0), self.tables.staging().knot(0)),
                _ => Err(Refusal::WrongState(self.state.name())),
            });
        match allowed {
            Ok(()) => self.wait_for_swap(reply_to, facts, SwapWay::Follow(play)),
            Err(refusal) => {
                self.tables.abandon();
                self.finish(reply_to, Reply::Refused(refusal));
            }
        }
    }

    fn wait_for_swap(&mut self, reply_to: ReplyAddress, facts: Facts, way: SwapWay) {
        self.tables.wait_for_swap(Swap { facts, way });
        let info = link_protocol::TableInfo {
            knots: self.tables.staging().knots() as u16,
            crc32: self.tables.staging().crc32(),
            stored: false,
            min_period_us: facts.min_period_us(&self.limits),
        };
        self.finish(reply_to, Reply::Table(Some(info)));
    }

    fn swap_decided(&mut self, reply_to: ReplyAddress, facts: Facts, decision: Decision) {
        if self.state.play().is_none() {
            return self.activate(reply_to, facts);
        }
        match decision {
            Decision::Crosses(shape) => {
                self.tables.abandon();
                self.finish(reply_to, Reply::Refused(on_the_way(shape)));
            }
            decision => {
                let via_neutral = decision == Decision::ViaNeutral;
                self.wait_for_swap(reply_to, facts, SwapWay::Ramp { via_neutral });
            }
        }
    }

    fn activate(&mut self, reply_to: ReplyAddress, facts: Facts) {
        self.tables.activate_staging(facts);
        self.persist.table_changed();
        let info = self.table_info();
        self.finish(reply_to, Reply::Table(info));
    }

    fn advance_play(
        &mut self,
        reply_to: ReplyAddress,
        play: Play,
        route: Option<Route>,
        facts: Facts,
        work: u32,
    ) {
        // A trim may have changed the limits since the request.
        let allowed = facts
            .allow(&self.limits)
            .and_then(|()| facts.allow_period(&self.limits, play.period_us))
            .and_then(|()| self.check_held(play.checked, self.tables.active_crc32()));
        if let Err(refusal) = allowed {
            return self.finish(reply_to, Reply::Refused(refusal));
        }
        let (State::Holding { .. }, Some(table)) = (self.state, self.tables.active()) else {
            return self.finish(reply_to, Reply::Refused(Refusal::NotArmed));
        };
        let first = table.knot_angles(0);
        // The ramp begins at the commanded angles. After a trim they differ from the held ones.
        let mut route = route
            .filter(|route| route.begins_at(self.commanded))
            .unwrap_or(Route::new(self.commanded, first));
        let mut left = work;
        while left >= LOOK_WORK {
            left -= LOOK_WORK;
            let via_neutral = match route.advance(&self.model.swimmer().links) {
                Decision::Unknown => continue,
                Decision::Crosses(shape) => {
                    return self.finish(reply_to, Reply::Refused(on_the_way(shape)));
                }
                Decision::Straight => false,
                Decision::ViaNeutral => true,
            };
            let ramp = Ramp::soft(self.commanded, first, via_neutral, &self.limits);
            let progress = Progress {
                request: play,
                elapsed_us: 0,
            };
            self.last_play = Some(progress);
            self.state = State::Starting {
                ramp,
                since: self.tick,
                play: progress,
            };
            return self.finish(reply_to, Reply::Done);
        }
        self.work = Work::Play {
            reply_to,
            play,
            route: Some(route),
        };
    }
}

/// Checks that two tables start at the same knot.
fn joins(active: [i16; 2], next: [i16; 2]) -> Result<(), Refusal> {
    for joint in [Joint::Front, Joint::Back] {
        let step = i32::from(next[joint.index()]) - i32::from(active[joint.index()]);
        if step != 0 {
            return Err(Refusal::NotJoined { joint, step });
        }
    }
    Ok(())
}

fn on_the_way(shape: [f32; 2]) -> Refusal {
    let [phi1, phi2] = shape.map(|angle| (angle / link_protocol::ANGLE_UNIT_RAD) as i16);
    Refusal::LinksCross {
        place: CrossingPlace::Ramp,
        phi1,
        phi2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_on_the_way_is_told_in_the_units_of_the_wire() {
        let Refusal::LinksCross { place, phi1, phi2 } = on_the_way([1.25, -2.0]) else {
            panic!("another refusal")
        };
        assert_eq!(place, CrossingPlace::Ramp);
        assert!((phi1 - 12_500).abs() <= 1 && (phi2 + 20_000).abs() <= 1);
    }
}
