//! Sequence of tables without pauses. The robot holds two: while one plays, the next is uploaded to the staging table, and the
//! robot changes to it at the end of the last cycle, independent of link timing. If the next table is late, the robot comes to
//! rest as after any play, and the sequence fails.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Flags, Refusal, Status, Telemetry, crc32c};

use super::await_play::{at_rest, finished};
use super::{Robot, check_heard};
use crate::port::Port;
use crate::session::{Event, Follower, LinkError};

const DOING: &str = "uploading the next gait of the playlist";
/// Longest wait for an upload beyond the end of the previous play.
const GRACE: Duration = Duration::from_secs(5);

/// One table of a sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leg {
    /// Bytes of the table, four per knot. All tables of a sequence start at the same knot.
    pub table: Vec<u8>,
    /// Number of cycles, at least one.
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

/// Progress report of a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SequenceProgress<'a> {
    /// Index of the playing leg, from 0.
    pub leg: usize,
    /// Latest telemetry.
    pub telemetry: Option<&'a Telemetry>,
}

/// Sequence in progress; its first leg already plays.
#[derive(Debug)]
pub struct Sequence {
    legs: Vec<Leg>,
    /// Number of legs that the robot holds or has played.
    accepted: usize,
    /// Index of the playing leg.
    playing: usize,
    /// Hash of the settings for which all legs were checked.
    settings_crc32: u32,
}

impl Sequence {
    /// Returns a sequence of these legs, the first of which has been uploaded and plays. `settings_crc32`
    /// ([`link_protocol::settings_crc32`]) identifies the settings for which all were checked.
    pub fn playing_first(legs: Vec<Leg>, settings_crc32: u32) -> Self {
        Self {
            legs,
            accepted: 1,
            playing: 0,
            settings_crc32,
        }
    }

    /// Uploads the next legs in time and waits for the end of the last cycle of the last leg. `watch` runs at least every 20 ms
    /// of the port's clock. If it breaks, the call returns `None`, leaves the robot unchanged, and the sequence can be
    /// continued.
    ///
    /// # Errors
    /// [`LinkError::OutOfStep`] if a table was late and the robot came to rest after the previous leg;
    /// [`LinkError::StoppedEarly`] and errors of the link.
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
            if telemetry.is_some_and(|telemetry| !telemetry.flags.contains(Flags::SWAP_PENDING)) {
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

    /// Waits until the robot has changed to the leg that was uploaded last.
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
            // The staging table was free before, so a waiting table is this one, and its reply was lost.
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

    /// Discards telemetry from before the robot accepted the table: it does not show if the table still waits.
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
    /// Shortest time from the request for an upload of `bytes` until the table is checked, during a play. Checks are slower
    /// then, because the servos have priority.
    pub fn expected_upload_while_playing(&self, bytes: usize) -> Duration {
        /// Time per knot; a test prints it (`cargo test -p gait-player --test player follow -- --nocapture`).
        const CHECK_OF_A_KNOT: Duration = Duration::from_millis(9);
        let knots = u32::try_from(bytes / 4).unwrap_or(u32::MAX);
        self.expected_upload(bytes) + CHECK_OF_A_KNOT.saturating_mul(knots)
    }
}
