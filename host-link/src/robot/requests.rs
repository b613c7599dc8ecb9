//! One method for each request: the numbers of the program turned into those of the wire, the answer's kind checked.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{
    ANGLE_UNIT_RAD, BenchStatus, Checked, Configuration, Counters, Flags, Joint, Key, Play,
    PulseRange, Reply, Request, ServoSettings, StateName, Status, TableInfo,
};

use super::{Halt, Robot, StoppedBy, stopped_by};
use crate::port::Port;
use crate::session::LinkError;

/// Times that a robot is asked whether it has stored something, and the time between.
const STORE_LOOKS: u32 = 25;
const STORE_LOOK: Duration = Duration::from_millis(200);

impl<P: Port> Robot<P> {
    /// What the robot is doing.
    ///
    /// # Errors
    /// The link's.
    pub fn status(&mut self) -> Result<Status, LinkError> {
        let doing = "asking for the status";
        match self.ask(Request::Status, doing)? {
            Reply::Status(status) => Ok(status),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// What the robot received, refused and dropped.
    ///
    /// # Errors
    /// The link's.
    pub fn counters(&mut self) -> Result<Counters, LinkError> {
        let doing = "asking for the robot's counters";
        match self.ask(Request::Counters, doing)? {
            Reply::Counters(counters) => Ok(counters),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// The configuration in force.
    ///
    /// # Errors
    /// The link's.
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
    /// [`LinkError::Refused`] for numbers that make no swimmer or loosen the firmware's limits, and the link's.
    pub fn configure(&mut self, configuration: Configuration) -> Result<(), LinkError> {
        self.order(Request::Configure(configuration), "configuring the robot")
    }

    /// The map of one servo.
    ///
    /// # Errors
    /// The link's.
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
    /// [`LinkError::Refused`] for pulses outside the window, and the link's.
    pub fn set_servo(&mut self, joint: Joint, settings: ServoSettings) -> Result<(), LinkError> {
        self.order(Request::SetServo { joint, settings }, "setting up a servo")
    }

    /// Sets the whole trim of one servo, radians; not while it moves.
    ///
    /// # Errors
    /// [`LinkError::OutOfRange`], [`LinkError::Refused`], and the link's.
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

    /// Turns pulses on, at the last commanded angles; the servos may jump there. With `clear_estop` a latched e-stop is
    /// cleared first.
    ///
    /// # Errors
    /// [`LinkError::Refused`] when an e-stop is latched and not cleared, when the battery is low or after three resets; and
    /// the link's.
    pub fn arm(&mut self, clear_estop: bool) -> Result<(), LinkError> {
        if clear_estop {
            let status = self.status()?;
            if status.state == StateName::EStopped {
                self.clear_estops(status.estops)?;
            }
        }
        self.order(Request::Arm, "arming")
    }

    /// Table and settings that the robot holds now.
    ///
    /// # Errors
    /// The link's. A robot without a table has a checksum of 0.
    pub fn held(&mut self) -> Result<Checked, LinkError> {
        Ok(self.status()?.held())
    }

    /// Starts to play the table that the robot holds: `cycles` cycles (0: without end) of `period` each. Returns when the robot
    /// has begun.
    ///
    /// # Errors
    /// [`LinkError::Refused`] when it is not armed, holds no table or the table is too fast at this period; and the link's.
    pub fn play(&mut self, cycles: u32, period: Duration, detached: bool) -> Result<(), LinkError> {
        let checked = self.held()?;
        self.play_checked(cycles, period, detached, checked)
    }

    /// [`play`](Self::play) of the table and with the settings that were checked.
    ///
    /// # Errors
    /// As [`play`](Self::play), and [`LinkError::Refused`] when the robot holds another table or other settings.
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

    /// Holds the pose within a play. Detached: without a link too, for at most 60 s in all, then the robot stops.
    ///
    /// # Errors
    /// [`LinkError::Refused`] when nothing plays, and the link's.
    pub fn pause(&mut self, detached: bool) -> Result<(), LinkError> {
        self.order(Request::Pause { detached }, "pausing")
    }

    /// Goes on after a pause.
    ///
    /// # Errors
    /// [`LinkError::Refused`] when nothing is paused, and the link's.
    pub fn resume(&mut self) -> Result<(), LinkError> {
        self.order(Request::Resume, "resuming")
    }

    /// Ramps to neutral and drops the pulses, from every state. Says what ended the motion.
    ///
    /// # Errors
    /// The link's.
    pub fn stop(&mut self) -> Result<StoppedBy, LinkError> {
        self.halt(Halt::Stop, "stopping")
    }

    /// Drops the pulses at once, latched until cleared. Says what ended the motion.
    ///
    /// # Errors
    /// The link's.
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

    /// Clears the e-stops that the robot counts now, to Stopped, without arming.
    ///
    /// # Errors
    /// [`LinkError::Refused`] while pulses are on, and the link's.
    pub fn clear_estop(&mut self) -> Result<(), LinkError> {
        let count = self.status()?.estops;
        self.clear_estops(count)
    }

    /// Clears as many e-stops as were counted in a status; another that came since stays latched.
    ///
    /// # Errors
    /// As [`clear_estop`](Self::clear_estop), and [`LinkError::Refused`] after another e-stop.
    pub fn clear_estops(&mut self, count: u32) -> Result<(), LinkError> {
        self.order(Request::ClearEStop { count }, "clearing the e-stop")
    }

    /// Sends the robot into its chip's boot loader. The answer comes before it leaves; then the port is dead.
    ///
    /// # Errors
    /// [`LinkError::Refused`] unless it is stopped and somebody is at it, and the link's.
    pub fn enter_boot_loader(&mut self) -> Result<(), LinkError> {
        self.order(Request::EnterBootLoader, "asking for the boot loader")
    }

    /// Presence, short starts and the configuration as built.
    ///
    /// # Errors
    /// The link's.
    pub fn bench(&mut self) -> Result<BenchStatus, LinkError> {
        let doing = "asking for presence and short starts";
        match self.ask(Request::Bench, doing)? {
            Reply::Bench(bench) => Ok(bench),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// The pulses that a servo's end stops allow.
    ///
    /// # Errors
    /// The link's.
    pub fn pulse_range(&mut self, joint: Joint) -> Result<PulseRange, LinkError> {
        let doing = "asking for a servo's pulse range";
        match self.ask(Request::PulseRange(joint), doing)? {
            Reply::PulseRange(range) => Ok(range),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Sets them; only while the robot is stopped. Angles beyond are refused with the gait that has them.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a range that leaves out neutral or the firmware's window, and the link's.
    pub fn set_pulse_range(&mut self, joint: Joint, range: PulseRange) -> Result<(), LinkError> {
        let request = Request::SetPulseRange { joint, range };
        self.order(request, "setting a servo's pulse range")
    }

    /// Allows arming again after three resets in 60 s.
    ///
    /// # Errors
    /// [`LinkError::Refused`] before 60 s of uptime, and the link's.
    pub fn clear_resets(&mut self) -> Result<(), LinkError> {
        self.order(Request::ClearResets, "clearing the latch of resets")
    }

    /// The message of the crash before the last start; empty where there is none.
    ///
    /// # Errors
    /// The link's.
    pub fn crash_message(&mut self) -> Result<String, LinkError> {
        let doing = "asking for the crash message";
        match self.ask(Request::CrashMessage, doing)? {
            Reply::CrashMessage(text) => Ok(text.as_str().to_owned()),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// The active table, named by its checksum.
    ///
    /// # Errors
    /// The link's.
    pub fn table(&mut self) -> Result<Option<TableInfo>, LinkError> {
        let doing = "asking for the table";
        match self.ask(Request::Table, doing)? {
            Reply::Table(table) => Ok(table),
            reply => Err(wrong(doing, &reply)),
        }
    }

    /// Sets, changes or removes the key that the robot asks for, waits until it is stored, and greets with it. The key
    /// crosses the wire in the clear: over a cable, at the bench.
    ///
    /// # Errors
    /// [`LinkError::Refused`] unless the robot is stopped, or where it has another key; [`LinkError::NotStored`] where it
    /// keeps the key only until its power is cut; and the link's.
    pub fn set_key(&mut self, key: Option<Key>) -> Result<(), LinkError> {
        let doing = "setting the key";
        self.order(Request::SetKey(key), doing)?;
        self.connection.session.set_key(key);
        self.reconnect()?;
        self.wait_until_stored(doing)
    }

    /// Waits until the robot has written its settings and its table to flash. `doing` is what was being stored, for the error.
    ///
    /// # Errors
    /// [`LinkError::NotStored`] if it has not within a few seconds, and the link's.
    pub fn wait_until_stored(&mut self, doing: &'static str) -> Result<(), LinkError> {
        for _ in 0..STORE_LOOKS {
            if !self.status()?.flags.contains(Flags::UNSAVED) {
                return Ok(());
            }
            self.listen(STORE_LOOK, |_| ControlFlow::Continue(()))?;
        }
        Err(LinkError::NotStored { doing })
    }

    /// A request that is answered by Done and nothing else.
    fn order(&mut self, request: Request, doing: &'static str) -> Result<(), LinkError> {
        match self.ask(request, doing)? {
            Reply::Done => {
                // What the robot told before it obeyed tells nothing of what it does now.
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
