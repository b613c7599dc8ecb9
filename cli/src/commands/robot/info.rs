//! `swimmer robot info`: who is there.

use std::fmt;

use link_protocol::{
    Board, Configuration, Counters, HelloReply, ResetReason, TableInfo, TangentialDrag, VersionName,
};
use serde::Serialize;

use super::access::Access;
use super::outputs::{Gait, gait_line};
use super::port::Pace;
use crate::failure::Outcome;
use crate::output::Output;
use crate::quantity::{self, Rows};

/// Asks the robot who it is.
pub(super) fn run(access: &Access, output: Output) -> Outcome {
    let mut line = access.connect("swimmer robot info", Pace::AsFastAsPossible)?;
    let robot = &mut line.robot;
    let (configuration, table, counters) =
        (robot.configuration()?, robot.table()?, robot.counters()?);
    let crash_message = if robot.info().crash_message {
        Some(robot.crash_message()?)
    } else {
        None
    };
    output.print(&InfoOutput::new(
        robot.info(),
        crash_message,
        &configuration,
        table.as_ref(),
        &counters,
    ));
    line.close()
}

/// Board, firmware, settings and counters of a robot. The JSON document of `swimmer robot info`.
#[derive(Debug, Serialize)]
pub(crate) struct InfoOutput {
    /// Board.
    board: &'static str,
    /// Version of the firmware.
    firmware: String,
    /// Commit of the firmware; null if it is unknown.
    commit: Option<String>,
    /// Lowest and present version of the protocol.
    protocol: [u8; 2],
    /// Hash of the protocol's messages.
    schema_key: String,
    /// Cause of the last start: power on, watchdog, crash or reset pin.
    reset_reason: &'static str,
    /// Message of a crash before that start.
    crash_message: Option<String>,
    /// Number of the session.
    session: u16,
    /// Limits in force.
    limits: LimitsOutput,
    /// Lengths and drag with which the robot computes its pose.
    configuration: ConfigurationOutput,
    /// Table of the gait; null without one.
    gait: Option<Gait>,
    /// Counters since the start.
    counters: CountersOutput,
}

/// Limits of a robot.
#[derive(Debug, Serialize)]
struct LimitsOutput {
    /// Largest angle of a joint \[rad\].
    max_angle_rad: f32,
    /// Largest rate of a joint \[rad/s\].
    max_rate_rad_s: f32,
    /// Shortest and longest pulse of a servo \[µs\].
    pulse_us: [f64; 2],
    /// Largest number of knots of a table.
    knots: u16,
}

/// Lengths and drag of a robot.
#[derive(Debug, Serialize)]
struct ConfigurationOutput {
    /// Length of the middle link \[m\].
    middle_m: f32,
    /// Length of the front link \[m\].
    front_m: f32,
    /// Length of the back link \[m\].
    back_m: f32,
    /// Drag ratio.
    chi: f32,
    /// Tangential drag coefficient, as a formula.
    c_t: String,
    /// Radius of the sphere \[m\].
    sphere_radius_m: f32,
}

/// Counters of a robot.
#[derive(Debug, Serialize)]
struct CountersOutput {
    /// Valid frames.
    frames_ok: u32,
    /// Invalid frames.
    frames_bad: u32,
    /// Requests that acted.
    acted: u32,
    /// Repeated requests, which got the stored reply.
    replayed: u32,
    /// Requests older than the last that acted.
    superseded: u32,
    /// Frames of another session.
    stale: u32,
    /// Requests that were refused.
    refused: u32,
    /// Frames dropped because the transmit buffer was full.
    dropped: u32,
    /// Ticks that came more than one and a half periods after the previous one.
    late_ticks: u32,
    /// Ticks in which the limits changed a pulse.
    clamped: u32,
}

impl InfoOutput {
    /// Output from the robot's replies.
    fn new(
        hello: &HelloReply,
        crash_message: Option<String>,
        body: &Configuration,
        table: Option<&TableInfo>,
        counters: &Counters,
    ) -> Self {
        let version = hello.firmware;
        let commit = String::from_utf8_lossy(&version.commit)
            .trim_end_matches('\0')
            .to_owned();
        let limits = &hello.limits;
        Self {
            board: board(hello.board),
            firmware: format!("{}.{}.{}", version.major, version.minor, version.patch),
            commit: (!commit.is_empty() && commit != "00000000").then_some(commit),
            protocol: [hello.protocol_min, hello.protocol_current],
            schema_key: format!("{:016x}", u64::from_be_bytes(hello.schema_key)),
            reset_reason: match hello.reset_reason {
                ResetReason::PowerOn => "power on",
                ResetReason::Watchdog => "watchdog",
                ResetReason::Crash => "crash",
                ResetReason::Pin => "reset pin",
            },
            crash_message,
            session: hello.session,
            limits: LimitsOutput {
                max_angle_rad: limits.max_angle,
                max_rate_rad_s: limits.max_rate,
                pulse_us: [limits.pulse_min_ns, limits.pulse_max_ns].map(|ns| f64::from(ns) / 1e3),
                knots: limits.max_knots,
            },
            configuration: ConfigurationOutput {
                middle_m: body.middle_m,
                front_m: body.front_m,
                back_m: body.back_m,
                chi: body.chi,
                c_t: match body.tangential_drag {
                    TangentialDrag::LogAspect(value) => format!("2πμ / {value}"),
                    TangentialDrag::HalfThickness(value) => {
                        format!("per link, half thickness {value} m")
                    }
                    TangentialDrag::OverViscosity(value) => format!("{value} μ"),
                },
                sphere_radius_m: body.sphere_radius_m,
            },
            gait: table.map(Gait::new),
            counters: CountersOutput {
                frames_ok: counters.frames.ok,
                frames_bad: counters.frames.bad(),
                acted: counters.acted,
                replayed: counters.replayed,
                superseded: counters.superseded,
                stale: counters.stale,
                refused: counters.refused,
                dropped: counters.dropped,
                late_ticks: counters.late_ticks,
                clamped: counters.clamped,
            },
        }
    }
}

impl fmt::Display for InfoOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            limits,
            configuration: body,
            counters,
            ..
        } = self;
        let commit = self.commit.as_deref();
        let commit = commit.map_or(String::new(), |commit| format!(", commit {commit}"));
        let [lowest, present] = self.protocol.map(VersionName);
        let mut rows = Rows::default();
        rows.row("board", self.board)
            .row(
                "firmware",
                format!("{}{commit}, protocol {lowest} to {present}", self.firmware),
            )
            .row(
                "started by",
                match &self.crash_message {
                    Some(message) => format!("{}: {message}", self.reset_reason),
                    None => self.reset_reason.to_owned(),
                },
            )
            .row(
                "limits",
                format!(
                    "{} and {}/s, pulses {} to {} µs, {} knots",
                    quantity::angle(f64::from(limits.max_angle_rad)),
                    quantity::angle(f64::from(limits.max_rate_rad_s)),
                    limits.pulse_us[0],
                    limits.pulse_us[1],
                    limits.knots,
                ),
            )
            .row(
                "links",
                format!(
                    "{} / {} / {} mm",
                    millimetres(body.front_m),
                    millimetres(body.middle_m),
                    millimetres(body.back_m)
                ),
            )
            .row(
                "drag",
                format!(
                    "χ = {}, c_t = {}, sphere {} mm",
                    body.chi,
                    body.c_t,
                    millimetres(body.sphere_radius_m)
                ),
            )
            .row("gait", gait_line(self.gait.as_ref()))
            .row(
                "frames",
                format!("{} good, {} bad", counters.frames_ok, counters.frames_bad),
            );
        rows.fmt(f)
    }
}

fn millimetres(metres: f32) -> f64 {
    (f64::from(metres) * 1e5).round() / 1e2
}

pub(super) fn board(board: Board) -> &'static str {
    match board {
        Board::Twin => "twin",
        Board::NanoRp2040Connect => "Arduino Nano RP2040 Connect",
        Board::Pico => "Raspberry Pi Pico",
    }
}
