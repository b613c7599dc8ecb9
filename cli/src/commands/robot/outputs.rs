//! Reports of the robot, as JSON keys and as lines for people.

use std::fmt;

use host_link::{LinkError, Robot};
use link_protocol::{Flags, StateName, Status, StopCause, TableInfo, Telemetry};
use serde::Serialize;

use super::port::AnyPort;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{self, Rows};

/// Output of a command that fails with exit status 1: its keys, with the reason as an additional one.
#[derive(Debug, Serialize)]
struct Failed<'a, A> {
    #[serde(flatten)]
    answer: &'a A,
    error: &'a str,
}

impl<A: fmt::Display> fmt::Display for Failed<'_, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.answer.fmt(f)
    }
}

/// Prints an output that reports a refusal, with the reason, and fails with that.
///
/// # Errors
/// Always, with [`Failure::AlreadyPrinted`].
pub(super) fn print_refusal(
    output: Output,
    answer: &(impl Serialize + fmt::Display),
    reason: String,
) -> Outcome {
    output.print(&Failed {
        answer,
        error: &reason,
    });
    Err(Failure::AlreadyPrinted(reason))
}

/// Output of a request that returns nothing but the robot's state.
#[derive(Debug, Serialize)]
pub(super) struct Done {
    /// State of the robot.
    pub(super) state: &'static str,
    #[serde(skip)]
    pub(super) sentence: String,
}

/// Message after a stop.
pub(super) const STOPPED: &str = "Stopped: the pulses are off.";
/// Message after an e-stop.
pub(super) const E_STOPPED: &str =
    "E-stopped: the pulses are off; `swimmer robot estop --clear` ends that.";

/// Message after a pause that needs no link.
pub(super) const PAUSED_DETACHED: &str = "Paused: the robot holds its pose for at most 60 s, then stops; `swimmer robot resume` goes on.";

impl Done {
    /// The pulses are off after a stop.
    pub(super) fn at_rest() -> Self {
        Self {
            state: "stopped",
            sentence: STOPPED.into(),
        }
    }

    /// The robot is at rest after a command that held it.
    pub(super) fn stopped() -> Self {
        Self {
            state: "stopped",
            sentence: "Stopped.".into(),
        }
    }
}

impl fmt::Display for Done {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

/// The table that is active, by its evidence.
#[derive(Debug, Serialize)]
pub(super) struct Gait {
    pub(super) knots: u16,
    pub(super) crc32: String,
    pub(super) stored: bool,
    pub(super) min_period_s: f64,
}

impl Gait {
    pub(super) fn new(table: &TableInfo) -> Self {
        Self {
            knots: table.knots,
            crc32: format!("{:08x}", table.crc32),
            stored: table.stored,
            min_period_s: f64::from(table.min_period_us) / 1e6,
        }
    }
}

pub(super) fn gait_line(gait: Option<&Gait>) -> String {
    gait.map_or_else(
        || "none".to_owned(),
        |gait| {
            let stored = if gait.stored {
                "stored"
            } else {
                "not stored yet"
            };
            format!(
                "{} knots, CRC {}, {stored}, period at least {:.2} s",
                gait.knots, gait.crc32, gait.min_period_s
            )
        },
    )
}

/// State of the robot.
#[derive(Debug, Serialize)]
pub(super) struct RobotState {
    pub(super) state: &'static str,
    /// Cause of the last stop, whatever the robot does now.
    cause: &'static str,
    /// `true` if that stop led to the state.
    #[serde(skip)]
    explained: bool,
    flags: Vec<&'static str>,
    cycle: u32,
    /// `null`: without end.
    cycles: Option<u32>,
    phase: f64,
    period_s: Option<f64>,
    setpoint_rad: [f64; 2],
    /// `null`: not measured.
    battery_v: Option<f64>,
    gait: Option<Gait>,
    robot_time_s: f64,
    /// Right to the requests that need a person at the robot; `null`: nobody has it.
    presence: Option<Presence>,
}

/// Evidence that a person is at the robot.
#[derive(Debug, Serialize)]
struct Presence {
    /// This session came over the USB cable.
    usb: bool,
    /// Remaining time of the bench window; 0: it is closed.
    window_s: u16,
}

impl fmt::Display for Presence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.usb, self.window_s) {
            (true, _) => write!(f, "over the USB cable"),
            (false, 0) => write!(f, "a moment ago"),
            (false, left) => write!(f, "the bench window is open for another {left} s"),
        }
    }
}

impl RobotState {
    /// Asks the robot for its status.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn of(robot: &mut Robot<AnyPort>) -> Result<Self, LinkError> {
        let status = robot.status()?;
        let mut doing = Self::new(&status);
        if status.flags.contains(Flags::PRESENT) {
            let bench = robot.bench()?;
            doing.presence = Some(Presence {
                usb: bench.usb,
                window_s: bench.window_s,
            });
        }
        Ok(doing)
    }

    /// From a status of any origin.
    pub(super) fn new(status: &Status) -> Self {
        Self {
            presence: None,
            state: state(status.state),
            cause: cause(status.cause),
            explained: is_explained(status.state),
            flags: flags(status.flags),
            cycle: status.cycle,
            cycles: (status.cycles > 0).then_some(status.cycles),
            phase: f64::from(status.phase) / 65_536.0,
            period_s: (status.period_us > 0).then(|| f64::from(status.period_us) / 1e6),
            setpoint_rad: status
                .setpoint
                .map(|units| f64::from(units) * f64::from(link_protocol::ANGLE_UNIT_RAD)),
            battery_v: status
                .battery_mv
                .map(|millivolts| f64::from(millivolts) / 1e3),
            gait: status.table.as_ref().map(Gait::new),
            robot_time_s: std::time::Duration::from_micros(status.robot_us).as_secs_f64(),
        }
    }
}

impl fmt::Display for RobotState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        let state = if self.explained {
            format!("{} ({})", self.state, self.cause)
        } else {
            self.state.to_owned()
        };
        rows.row("state", state);
        // Presence has a row of its own, and a robot at rest need not hear from anybody.
        let is_shown = |flag: &&&str| {
            **flag != "present" && (**flag != "link silent" || self.state != "stopped")
        };
        let flags: Vec<&str> = self.flags.iter().filter(is_shown).copied().collect();
        if !flags.is_empty() {
            rows.row("flags", flags.join(", "));
        }
        if let Some(period) = self.period_s {
            let of = self
                .cycles
                .map_or_else(|| "without end".to_owned(), |cycles| format!("of {cycles}"));
            rows.row(
                "cycle",
                format!(
                    "{:.2} {of}, {period} s each",
                    f64::from(self.cycle) + self.phase
                ),
            );
        }
        rows.row(
            "set-point",
            format!(
                "{}, {}",
                quantity::angle(self.setpoint_rad[0]),
                quantity::angle(self.setpoint_rad[1])
            ),
        )
        .row("battery", battery(self.battery_v))
        .row("gait", gait_line(self.gait.as_ref()))
        .row("up for", format!("{:.1} s", self.robot_time_s));
        if let Some(presence) = &self.presence {
            rows.row("presence", presence.to_string());
        }
        write!(f, "{rows}")
    }
}

pub(super) fn battery(volts: Option<f64>) -> String {
    volts.map_or_else(
        || "not measured".to_owned(),
        |volts| format!("{volts:.2} V"),
    )
}

/// The set-points of a piece of telemetry, φ₁ and φ₂ in radians.
pub(super) fn telemetry_angles(telemetry: &Telemetry) -> [f64; 2] {
    telemetry
        .setpoint
        .map(|units| f64::from(units) * f64::from(link_protocol::ANGLE_UNIT_RAD))
}

/// One line of telemetry.
pub(super) fn telemetry_line(telemetry: &Telemetry) -> String {
    let [front, back] = telemetry_angles(telemetry).map(f64::to_degrees);
    format!(
        "{:9.2} s  {:<9} cycle {:8.2}  φ {:+7.1}° {:+7.1}°  x {:+8.2} mm  y {:+7.2} mm  θ {:+6.1}°  {}  {} bad frames",
        std::time::Duration::from_micros(telemetry.robot_us).as_secs_f64(),
        state(telemetry.state),
        f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0,
        front,
        back,
        f64::from(telemetry.pose.x) * 1e3,
        f64::from(telemetry.pose.y) * 1e3,
        f64::from(telemetry.pose.theta).to_degrees(),
        battery(
            telemetry
                .battery_mv
                .map(|millivolts| f64::from(millivolts) / 1e3)
        ),
        telemetry.frames_bad,
    )
}

pub(super) fn state(state: StateName) -> &'static str {
    match state {
        StateName::Stopped => "stopped",
        StateName::EStopped => "e-stopped",
        StateName::Holding => "holding",
        StateName::Starting => "starting",
        StateName::Playing => "playing",
        StateName::Paused => "paused",
        StateName::Stopping => "stopping",
        StateName::Settling => "settling",
    }
}

/// `true` during a play: it has begun and neither ended nor been stopped.
pub(super) fn is_under_way(state: StateName) -> bool {
    matches!(
        state,
        StateName::Starting | StateName::Playing | StateName::Paused
    )
}

/// `true` if the cause of the last stop explains the state; in other states that stop is history.
pub(super) fn is_explained(state: StateName) -> bool {
    !is_under_way(state) && state != StateName::Holding
}

pub(super) fn cause(cause: StopCause) -> &'static str {
    match cause {
        StopCause::Boot => "boot",
        StopCause::Finished => "finished",
        StopCause::Requested => "requested",
        StopCause::PauseExpired => "pause expired",
        StopCause::LinkLost => "link lost",
        StopCause::BatteryLow => "battery low",
        StopCause::EStop => "e-stop",
    }
}

pub(super) fn flags(flags: Flags) -> Vec<&'static str> {
    [
        (Flags::BATTERY_LOW, "battery low"),
        (Flags::RESET_LOOP, "reset loop"),
        (Flags::LINK_SILENT, "link silent"),
        (Flags::DETACHED, "detached"),
        (Flags::SWAP_PENDING, "swap pending"),
        (Flags::UNSAVED, "unsaved"),
        (Flags::STORAGE_FAILED, "storage failed"),
        (Flags::KEY_SET, "key set"),
        (Flags::PRESENT, "present"),
        (Flags::SHORT_STARTS, "short starts"),
        (Flags::FRONT_PASSIVE, "front joint passive"),
        (Flags::BACK_PASSIVE, "back joint passive"),
    ]
    .into_iter()
    .filter_map(|(flag, name)| flags.contains(flag).then_some(name))
    .collect()
}

/// The trim of both servos.
#[derive(Debug, Serialize)]
pub(super) struct Trims {
    front_rad: f64,
    back_rad: f64,
}

impl Trims {
    pub(super) fn new(front: i16, back: i16) -> Self {
        let radians = |units: i16| f64::from(units) * f64::from(link_protocol::ANGLE_UNIT_RAD);
        Self {
            front_rad: radians(front),
            back_rad: radians(back),
        }
    }
}

impl fmt::Display for Trims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "  trim  front {}, back {}",
            quantity::angle(self.front_rad),
            quantity::angle(self.back_rad)
        )
    }
}
