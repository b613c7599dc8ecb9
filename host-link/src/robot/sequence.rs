//! Several tables played one after the other without a pause. The robot has room for two: while one plays, the next is sent
//! into the other's place, and the robot goes over to it by itself when the last cycle is done, so that no timing of the link's
//! matters. Where the next table is not there by then, the robot comes to rest as after any play, and that is told.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Flags, Refusal, Status, Telemetry, crc32c};

use super::await_play::{at_rest, finished};
use super::{Robot, check_heard};
use crate::port::Port;
use crate::session::{Event, Follower, LinkError};

const DOING: &str = "uploading the next gait of the playlist";
/// Beyond the end of the play before, an upload is waited for no longer than this.
const GRACE: Duration = Duration::from_secs(5);

/// One table of a sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leg {
    /// Four bytes a knot; all tables of a sequence start at the same knot.
    pub table: Vec<u8>,
    /// Cycles, at least one.
    pub cycles: u32,
    /// Duration of a cycle.
    pub period: Duration,
}

impl Leg {
    fn duration(&self) -> Duration {
        self.period.saturating_mul(self.cycles)
    }

    fn period_us(&self) -> Result<u32, LinkError> {
        u32::try_from(self.period.as_micros()).map_err(|_| LinkError::OutOfRange {
            doing: DOING,
            quantity: "a period in seconds",
            value: self.period.as_secs_f64(),
            low: 1e-6,
            high: f64::from(u32::MAX) * 1e-6,
        })
    }
}

/// What a caller sees while a sequence plays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SequenceProgress<'a> {
    /// Number of the leg that plays, from 0.
    pub leg: usize,
    /// What the robot told last.
    pub telemetry: Option<&'a Telemetry>,
}

/// A sequence under way: its first leg plays already.
#[derive(Debug)]
pub struct Sequence {
    legs: Vec<Leg>,
    /// Legs that the robot holds or has played.
    accepted: usize,
    /// The leg that plays.
    playing: usize,
    /// Hash of the settings that all legs were checked for.
    settings_crc32: u32,
}

impl Sequence {
    /// Sequence of these legs, of which the first has been uploaded and plays. The settings that all were checked for are
    /// those of this hash ([`link_protocol::settings_crc32`]).
    pub fn playing_first(legs: Vec<Leg>, settings_crc32: u32) -> Self {
        Self {
            legs,
            accepted: 1,
            playing: 0,
            settings_crc32,
        }
    }

    /// Sends what is to follow, in time, and waits for the end of the last cycle of the last leg. `watch` is asked at least
    /// every 20 ms of the port's clock; breaking off returns `None` and leaves the robot as it is, and the sequence can be gone
    /// on with.
    ///
    /// # Errors
    /// [`LinkError::OutOfStep`] where a table was not there in time: the robot has come to rest after the leg before;
    /// [`LinkError::StoppedEarly`] and the link's own.
    pub fn go_on<P: Port>(
        &mut self,
        robot: &mut Robot<P>,
        mut watch: impl FnMut(SequenceProgress<'_>) -> ControlFlow<()>,
    ) -> Result<Option<Status>, LinkError> {
        while self.accepted < self.legs.len() {
            if self.wait_for_room(robot, &mut watch)?.is_break()
                || self.send_next(robot, &mut watch)?.is_break()
            {
                return Ok(None);
            }
        }
        let (last, mut leg) = (self.legs.len().saturating_sub(1), self.playing);
        let waited = robot.wait_while(|telemetry| {
            if telemetry.is_some_and(|told| !told.flags.contains(Flags::SWAP_PENDING)) {
                leg = last;
            }
            watch(SequenceProgress { leg, telemetry })
        })?;
        self.playing = leg;
        let Some(status) = waited else {
            return Ok(None);
        };
        let wanted = self.legs.last().map(|leg| crc32c(&leg.table));
        if status.table.map(|table| table.crc32) == wanted {
            return Ok(Some(status));
        }
        Err(self.out_of_step())
    }

    /// Until the robot has gone over to the leg that was sent last.
    fn wait_for_room<P: Port>(
        &mut self,
        robot: &mut Robot<P>,
        watch: &mut impl FnMut(SequenceProgress<'_>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, LinkError> {
        let mut over = false;
        let connection = &mut robot.connection;
        let flow = connection.wait(DOING, |connection, _| {
            if let Some(telemetry) = connection.latest {
                if at_rest(telemetry.state, telemetry.cause) {
                    over = true;
                    return Ok(ControlFlow::Break(ControlFlow::Continue(())));
                }
                if !telemetry.flags.contains(Flags::SWAP_PENDING) {
                    self.playing = self.accepted - 1;
                    return Ok(ControlFlow::Break(ControlFlow::Continue(())));
                }
            }
            if watch(self.progress(connection.latest.as_ref())).is_break() {
                return Ok(ControlFlow::Break(ControlFlow::Break(())));
            }
            check_heard(connection, DOING)?;
            Ok(ControlFlow::Continue(()))
        })?;
        if over {
            finished(robot.status()?)?;
            return Err(self.out_of_step());
        }
        Ok(flow)
    }

    fn progress<'a>(&self, telemetry: Option<&'a Telemetry>) -> SequenceProgress<'a> {
        SequenceProgress {
            leg: self.playing,
            telemetry,
        }
    }

    fn send_next<P: Port>(
        &mut self,
        robot: &mut Robot<P>,
        watch: &mut impl FnMut(SequenceProgress<'_>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, LinkError> {
        let Some(leg) = self.legs.get(self.accepted) else {
            return Ok(ControlFlow::Continue(()));
        };
        let before = self.legs.get(self.playing).map(Leg::duration);
        let now = robot.connection.now();
        let deadline = now + before.unwrap_or_default() + GRACE;
        let follower = Follower {
            cycles: leg.cycles,
            period_us: leg.period_us()?,
            settings_crc32: self.settings_crc32,
        };
        let wanted = robot
            .connection
            .session
            .upload_follower(now, &leg.table, follower, deadline);
        let sent = robot.connection.wait(DOING, |connection, event| {
            match event {
                Some(Event::Uploaded { ticket, .. }) if ticket == wanted => {
                    return Ok(ControlFlow::Break(Some(Ok(()))));
                }
                Some(Event::Failed { ticket, error }) if ticket == wanted => {
                    return Ok(ControlFlow::Break(Some(Err(error))));
                }
                _ => {}
            }
            if watch(self.progress(connection.latest.as_ref())).is_break() {
                connection.session.cancel_upload();
                return Ok(ControlFlow::Break(None));
            }
            Ok(ControlFlow::Continue(()))
        })?;
        match sent {
            None => Ok(ControlFlow::Break(())),
            // Space was seen: if a table waits, it is this one, and the reply was lost.
            Some(
                Ok(())
                | Err(LinkError::Refused {
                    refusal: Refusal::SwapPending,
                    ..
                }),
            ) => Ok(self.accept(robot)),
            Some(Err(LinkError::Refused {
                refusal: Refusal::WrongState(_),
                ..
            })) => {
                finished(robot.status()?)?;
                Err(self.out_of_step())
            }
            Some(Err(error)) => Err(error),
        }
    }

    /// Telemetry from before the robot took the table says nothing about whether it still waits.
    fn accept<P: Port>(&mut self, robot: &mut Robot<P>) -> ControlFlow<()> {
        self.accepted += 1;
        robot.connection.latest = None;
        ControlFlow::Continue(())
    }

    fn out_of_step(&self) -> LinkError {
        LinkError::OutOfStep {
            played: self.accepted,
            legs: self.legs.len(),
        }
    }
}

impl<P: Port> Robot<P> {
    /// What the robot takes at least, from asking for an upload of `bytes` of table until it has checked it, while it plays:
    /// checks are slower then, because the servos come first.
    pub fn expected_upload_while_playing(&self, bytes: usize) -> Duration {
        /// Of one knot; the brain's tests print it (`cargo test -p gait-player --test player follow -- --nocapture`).
        const CHECK_OF_A_KNOT: Duration = Duration::from_millis(9);
        let knots = u32::try_from(bytes / 4).unwrap_or(u32::MAX);
        self.expected_upload(bytes) + CHECK_OF_A_KNOT.saturating_mul(knots)
    }
}
