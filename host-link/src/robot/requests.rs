//! One method per request: converts units to those of the wire and checks the kind of the reply.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{
    ANGLE_UNIT_RAD, BenchStatus, Checked, Configuration, Counters, Flags, Joint, Key, Play,
    PulseRange, Reply, Request, ServoSettings, StateName, Status, TableInfo,
};

use super::{Halt, Robot, StoppedBy, stopped_by};
use crate::port::Port;
use crate::session::LinkError;

/// Number of status requests before storing counts as failed; their interval follows.
const STORE_LOOKS: u32 = 25;
const STORE_LOOK: Duration = Duration::from_millis(200);

impl<P: Port> Robot<P> {
    /// Status of the robot.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn status(&mut self) -> Result<Status, LinkError> {
        let doing = "asking for the status";
        match self.ask(Request::Status, doing)? {
            Reply::Status(status) => Ok(status),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Counts of received, refused and dropped frames at the robot.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn counters(&mut self) -> Result<Counters, LinkError> {
        let doing = "asking for the robot's counters";
        match self.ask(Request::Counters, doing)? {
            Reply::Counters(counters) => Ok(counters),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Configuration in force.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn configuration(&mut self) -> Result<Configuration, LinkError> {
        let doing = "asking for the configuration";
        match self.ask(Request::Configuration, doing)? {
            Reply::Configuration(configuration) => Ok(configuration),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Sets geometry, drag and limits; only while the robot is stopped.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if the values form no valid swimmer or exceed the firmware's limits, and errors of the link.
    pub fn configure(&mut self, configuration: Configuration) -> Result<(), LinkError> {
        self.order(Request::Configure(configuration), "configuring the robot")
    }

    /// Map of one servo.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn servo(&mut self, joint: Joint) -> Result<ServoSettings, LinkError> {
        let doing = "asking for a servo's settings";
        match self.ask(Request::Servo(joint), doing)? {
            Reply::Servo(settings) => Ok(settings),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Sets the map of one servo; only while the robot is stopped.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for pulses outside the window, and errors of the link.
    pub fn set_servo(&mut self, joint: Joint, settings: ServoSettings) -> Result<(), LinkError> {
        self.order(Request::SetServo { joint, settings }, "setting up a servo")
    }

    /// Sets the total trim of one servo, rad; not during a motion.
    ///
    /// # Errors
    /// [`LinkError::OutOfRange`], [`LinkError::Refused`], and errors of the link.
    pub fn trim(&mut self, joint: Joint, radians: f64) -> Result<(), LinkError> {
        let doing = "trimming a servo";
        let unit = f64::from(ANGLE_UNIT_RAD);
        let largest = f64::from(i16::MAX) * unit;
        let within = radians.abs() <= largest;
        if !within {
            return Err(LinkError::OutOfRange {
                doing,
                quantity: "a trim in radians",
                value: radians,
                low: -largest,
                high: largest,
            });
        }
        #[allow(clippy::cast_possible_truncation)] // checked above
        let trim = (radians / unit).round() as i16;
        self.order(Request::Trim { joint, trim }, doing)
    }

    /// Switches the pulses on at the last commanded angles; the servos may jump there. `clear_estop` clears a latched e-stop
    /// first.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if an e-stop stays latched, the battery is low, or after three resets; and errors of the link.
    pub fn arm(&mut self, clear_estop: bool) -> Result<(), LinkError> {
        if clear_estop {
            let status = self.status()?;
            if status.state == StateName::EStopped {
                self.clear_estops(status.estops)?;
            }
        }
        self.order(Request::Arm, "arming")
    }

    /// Table and settings that the robot holds. Without a table, its checksum is 0.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn held(&mut self) -> Result<Checked, LinkError> {
        Ok(self.status()?.held())
    }

    /// Plays the robot's table: `cycles` cycles (0: endless) of `period` each. Returns when the play has begun.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if the robot is not armed, has no table or the table is too fast at this period; and errors of
    /// the link.
    pub fn play(&mut self, cycles: u32, period: Duration, detached: bool) -> Result<(), LinkError> {
        let checked = self.held()?;
        self.play_checked(cycles, period, detached, checked)
    }

    /// [`play`](Self::play) with the table and settings that were checked.
    ///
    /// # Errors
    /// As for [`play`](Self::play), and [`LinkError::Refused`] if the robot holds another table or other settings.
    pub fn play_checked(
        &mut self,
        cycles: u32,
        period: Duration,
        detached: bool,
        checked: Checked,
    ) -> Result<(), LinkError> {
        let doing = "starting to play";
        let Some(period_us) = u32::try_from(period.as_micros()).ok().filter(|&us| us > 0) else {
            return Err(LinkError::OutOfRange {
                doing,
                quantity: "a period in seconds",
                value: period.as_secs_f64(),
                low: 1e-6,
                high: f64::from(u32::MAX) * 1e-6,
            });
        };
        let play = Play {
            cycles,
            period_us,
            detached,
            checked,
        };
        self.order(Request::Play(play), doing)
    }

    /// Pauses a play at its pose. Detached: also without a link, for at most 60 s in total; then the robot stops.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if nothing plays, and errors of the link.
    pub fn pause(&mut self, detached: bool) -> Result<(), LinkError> {
        self.order(Request::Pause { detached }, "pausing")
    }

    /// Resumes a paused play.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if nothing is paused, and errors of the link.
    pub fn resume(&mut self) -> Result<(), LinkError> {
        self.order(Request::Resume, "resuming")
    }

    /// Ramps to neutral and switches the pulses off, from every state. Returns the cause that ended the motion.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn stop(&mut self) -> Result<StoppedBy, LinkError> {
        self.halt(Halt::Stop, "stopping")
    }

    /// Switches the pulses off at once, latched until cleared. Returns the cause that ended the motion.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn estop(&mut self) -> Result<StoppedBy, LinkError> {
        self.halt(Halt::EStop, "e-stopping")
    }

    fn halt(&mut self, halt: Halt, doing: &'static str) -> Result<StoppedBy, LinkError> {
        let by = stopped_by(&self.connection.halt(halt, doing)?);
        if by == StoppedBy::Request {
            self.connection.latest = None;
        }
        Ok(by)
    }

    /// Clears the present count of e-stops; the robot enters Stopped, without arming.
    ///
    /// # Errors
    /// [`LinkError::Refused`] while pulses are on, and errors of the link.
    pub fn clear_estop(&mut self) -> Result<(), LinkError> {
        let count = self.status()?.estops;
        self.clear_estops(count)
    }

    /// Clears the number of e-stops in a status; a later e-stop stays latched.
    ///
    /// # Errors
    /// As for [`clear_estop`](Self::clear_estop), and [`LinkError::Refused`] after another e-stop.
    pub fn clear_estops(&mut self, count: u32) -> Result<(), LinkError> {
        self.order(Request::ClearEStop { count }, "clearing the e-stop")
    }

    /// Enters the chip's boot loader. The reply is sent first; afterwards the port is dead.
    ///
    /// # Errors
    /// [`LinkError::Refused`] unless the robot is stopped and a person is present, and errors of the link.
    pub fn enter_boot_loader(&mut self) -> Result<(), LinkError> {
        self.order(Request::EnterBootLoader, "asking for the boot loader")
    }

    /// Presence, short starts and the configuration as built.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn bench(&mut self) -> Result<BenchStatus, LinkError> {
        let doing = "asking for presence and short starts";
        match self.ask(Request::Bench, doing)? {
            Reply::Bench(bench) => Ok(bench),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Pulses that a servo's end stops allow.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn pulse_range(&mut self, joint: Joint) -> Result<PulseRange, LinkError> {
        let doing = "asking for a servo's pulse range";
        match self.ask(Request::PulseRange(joint), doing)? {
            Reply::PulseRange(range) => Ok(range),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Declares the joint that has a spring in place of a servo, or, with `None`, that both joints have servos; only while the
    /// robot is stopped. The output of a passive joint stays low.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if a passive joint shall be driven again and nobody is present, or if the firmware is older than
    /// this request; and errors of the link.
    pub fn set_passive(&mut self, joint: Option<Joint>) -> Result<(), LinkError> {
        self.order(Request::SetPassive(joint), "setting the passive joint")
    }

    /// Sets the pulse range of a servo; only while the robot is stopped. Gaits beyond it are refused.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a range that excludes neutral or exceeds the firmware's window, and errors of the link.
    pub fn set_pulse_range(&mut self, joint: Joint, range: PulseRange) -> Result<(), LinkError> {
        let request = Request::SetPulseRange { joint, range };
        self.order(request, "setting a servo's pulse range")
    }

    /// Allows arming again after three resets in 60 s.
    ///
    /// # Errors
    /// [`LinkError::Refused`] before 60 s of uptime, and errors of the link.
    pub fn clear_resets(&mut self) -> Result<(), LinkError> {
        self.order(Request::ClearResets, "clearing the latch of resets")
    }

    /// Message of the crash before the last start; empty without a crash.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn crash_message(&mut self) -> Result<String, LinkError> {
        let doing = "asking for the crash message";
        match self.ask(Request::CrashMessage, doing)? {
            Reply::CrashMessage(text) => Ok(text.as_str().to_owned()),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Active table, identified by its checksum.
    ///
    /// # Errors
    /// Errors of the link.
    pub fn table(&mut self) -> Result<Option<TableInfo>, LinkError> {
        let doing = "asking for the table";
        match self.ask(Request::Table, doing)? {
            Reply::Table(table) => Ok(table),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Sets, changes or removes the robot's key, waits until it is stored, and greets with it. The key crosses the wire
    /// unencrypted: use a cable at the bench.
    ///
    /// # Errors
    /// [`LinkError::Refused`] if the robot is not stopped or has another key; [`LinkError::NotStored`] if the key would be lost
    /// at a power cut; and errors of the link.
    pub fn set_key(&mut self, key: Option<Key>) -> Result<(), LinkError> {
        let doing = "setting the key";
        self.order(Request::SetKey(key), doing)?;
        self.connection.session.set_key(key);
        self.reconnect()?;
        self.wait_until_stored(doing)
    }

    /// Waits until the robot has written its settings and its table to flash. `doing` describes the operation for the error.
    ///
    /// # Errors
    /// [`LinkError::NotStored`] after a few seconds, and errors of the link.
    pub fn wait_until_stored(&mut self, doing: &'static str) -> Result<(), LinkError> {
        for _ in 0..STORE_LOOKS {
            if !self.status()?.flags.contains(Flags::UNSAVED) {
                return Ok(());
            }
            self.listen(STORE_LOOK, |_| ControlFlow::Continue(()))?;
        }
        Err(LinkError::NotStored { doing })
    }

    /// Sends a request whose only valid reply is Done.
    fn order(&mut self, request: Request, doing: &'static str) -> Result<(), LinkError> {
        match self.ask(request, doing)? {
            Reply::Done => {
                // Telemetry from before the request does not describe the present state.
                self.connection.latest = None;
                Ok(())
            }
            reply => Err(wrong(doing, &reply)),
        }
    }
}

fn wrong(doing: &'static str, reply: &Reply) -> LinkError {
    LinkError::WrongReply {
        doing,
        reply: format!("{reply:?}"),
    }
}
