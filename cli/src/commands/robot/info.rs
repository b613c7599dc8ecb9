//! `swimmer robot info`: who is there.

use std::fmt;

use link_protocol::{
    Board, Configuration, Counters, HelloReply, ResetReason, TableInfo, TangentialDrag,
};
use serde::Serialize;

use super::access::Access;
use super::answers::{Gait, gait_line};
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
    output.answer(&Info::new(
        robot.info(),
        crash_message,
        &configuration,
        table.as_ref(),
        &counters,
    ));
    line.close()
}

/// Who is there.
#[derive(Debug, Serialize)]
struct Info {
    board: &'static str,
    firmware: String,
    commit: Option<String>,
    protocol: [u8; 2],
    schema_key: String,
    reset_reason: &'static str,
    /// What a crash before that start left to tell.
    crash_message: Option<String>,
    session: u16,
    limits: Limits,
    configuration: Body,
    gait: Option<Gait>,
    counters: Traffic,
}

#[derive(Debug, Serialize)]
struct Limits {
    max_angle_rad: f32,
    max_rate_rad_s: f32,
    pulse_us: [f64; 2],
    knots: u16,
}

#[derive(Debug, Serialize)]
struct Body {
    middle_m: f32,
    front_m: f32,
    back_m: f32,
    chi: f32,
    c_t: String,
    sphere_radius_m: f32,
}

#[derive(Debug, Serialize)]
struct Traffic {
    frames_ok: u32,
    frames_bad: u32,
    acted: u32,
    replayed: u32,
    superseded: u32,
    stale: u32,
    refused: u32,
    dropped: u32,
    late_ticks: u32,
    clamped: u32,
}

impl Info {
    fn new(
        hello: &HelloReply,
        crash_message: Option<String>,
        configuration: &Configuration,
        table: Option<&TableInfo>,
        counters: &Counters,
    ) -> Self {
        let version = hello.firmware;
        let commit = String::from_utf8_lossy(&version.commit)
            .trim_end_matches('\0')
            .to_owned();
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
            limits: Limits {
                max_angle_rad: hello.limits.max_angle,
                max_rate_rad_s: hello.limits.max_rate,
                pulse_us: [
                    f64::from(hello.limits.pulse_min_ns) * 1e-3,
                    f64::from(hello.limits.pulse_max_ns) * 1e-3,
                ],
                knots: hello.limits.max_knots,
            },
            configuration: Body {
                middle_m: configuration.middle_m,
                front_m: configuration.front_m,
                back_m: configuration.back_m,
                chi: configuration.chi,
                c_t: match configuration.tangential_drag {
                    TangentialDrag::LogAspect(value) => format!("2πμ / {value}"),
                    TangentialDrag::HalfThickness(value) => {
                        format!("per link, half thickness {value} m")
                    }
                    TangentialDrag::OverViscosity(value) => format!("{value} μ"),
                },
                sphere_radius_m: configuration.sphere_radius_m,
            },
            gait: table.map(Gait::new),
            counters: Traffic {
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

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let body = &self.configuration;
        let commit = self
            .commit
            .as_deref()
            .map_or(String::new(), |commit| format!(", commit {commit}"));
        let mut rows = Rows::default();
        rows.row("board", self.board)
            .row(
                "firmware",
                format!(
                    "{}{commit}, protocol {} to {}",
                    self.firmware, self.protocol[0], self.protocol[1]
                ),
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
                    quantity::angle(f64::from(self.limits.max_angle_rad)),
                    quantity::angle(f64::from(self.limits.max_rate_rad_s)),
                    self.limits.pulse_us[0],
                    self.limits.pulse_us[1],
                    self.limits.knots,
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
                format!(
                    "{} good, {} bad",
                    self.counters.frames_ok, self.counters.frames_bad
                ),
            );
        write!(f, "{rows}")
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
