//! `swimmer robot info`: who is there.

use link_protocol::{
    Board, Configuration, Counters, HelloReply, ResetReason, TableInfo, TangentialDrag, VersionName,
};

use super::access::Access;
use super::outputs::{Gait, gait_line};
use super::port::Pace;
use crate::document::{Document, object};
use crate::failure::Outcome;
use crate::output::Output;
use crate::quantity;

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
    output.print(&answer(
        robot.info(),
        crash_message,
        &configuration,
        table.as_ref(),
        &counters,
    ));
    line.close()
}

/// Output from the robot's replies.
fn answer(
    hello: &HelloReply,
    crash_message: Option<String>,
    body: &Configuration,
    table: Option<&TableInfo>,
    counters: &Counters,
) -> Document {
    let version = hello.firmware;
    let firmware = format!("{}.{}.{}", version.major, version.minor, version.patch);
    let commit = String::from_utf8_lossy(&version.commit)
        .trim_end_matches('\0')
        .to_owned();
    let commit = (!commit.is_empty() && commit != "00000000").then_some(commit);
    let of_commit = commit
        .as_deref()
        .map_or(String::new(), |commit| format!(", commit {commit}"));
    let reset_reason = match hello.reset_reason {
        ResetReason::PowerOn => "power on",
        ResetReason::Watchdog => "watchdog",
        ResetReason::Crash => "crash",
        ResetReason::Pin => "reset pin",
    };
    let limits = &hello.limits;
    let pulse_us = [limits.pulse_min_ns, limits.pulse_max_ns].map(|ns| f64::from(ns) / 1e3);
    let gait = table.map(Gait::new);
    let mut answer = Document::default();
    answer
        .row("board", board(hello.board))
        .row(
            "firmware",
            format!(
                "{firmware}{of_commit}, protocol {} to {}",
                VersionName(hello.protocol_min),
                VersionName(hello.protocol_current)
            ),
        )
        .row(
            "started by",
            match &crash_message {
                Some(message) => format!("{reset_reason}: {message}"),
                None => reset_reason.to_owned(),
            },
        )
        .row(
            "limits",
            format!(
                "{} and {}/s, pulses {} to {} µs, {} knots",
                quantity::angle(f64::from(limits.max_angle)),
                quantity::angle(f64::from(limits.max_rate)),
                pulse_us[0],
                pulse_us[1],
                limits.max_knots,
            ),
        )
        .key("board", board(hello.board))
        .key("firmware", firmware)
        .key("commit", commit)
        .key("protocol", [hello.protocol_min, hello.protocol_current])
        .key(
            "schema_key",
            format!("{:016x}", u64::from_be_bytes(hello.schema_key)),
        )
        .key("reset_reason", reset_reason)
        // Message of a crash before that start.
        .key("crash_message", crash_message)
        .key("session", hello.session)
        .key(
            "limits",
            object! {
                "max_angle_rad": limits.max_angle,
                "max_rate_rad_s": limits.max_rate,
                "pulse_us": pulse_us,
                "knots": limits.max_knots,
            },
        );
    add_body(&mut answer, body);
    answer
        .row("gait", gait_line(gait.as_ref()))
        .key("gait", gait);
    add_traffic(&mut answer, counters);
    answer
}

/// Adds the lengths and the drag that the robot counts with.
fn add_body(answer: &mut Document, body: &Configuration) {
    let c_t = match body.tangential_drag {
        TangentialDrag::LogAspect(value) => format!("2πμ / {value}"),
        TangentialDrag::HalfThickness(value) => format!("per link, half thickness {value} m"),
        TangentialDrag::OverViscosity(value) => format!("{value} μ"),
    };
    answer
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
                "χ = {}, c_t = {c_t}, sphere {} mm",
                body.chi,
                millimetres(body.sphere_radius_m)
            ),
        )
        .key(
            "configuration",
            object! {
                "middle_m": body.middle_m,
                "front_m": body.front_m,
                "back_m": body.back_m,
                "chi": body.chi,
                "c_t": c_t,
                "sphere_radius_m": body.sphere_radius_m,
            },
        );
}

/// Adds what came over the link.
fn add_traffic(answer: &mut Document, counters: &Counters) {
    let (good, bad) = (counters.frames.ok, counters.frames.bad());
    answer.row("frames", format!("{good} good, {bad} bad")).key(
        "counters",
        object! {
            "frames_ok": good,
            "frames_bad": bad,
            "acted": counters.acted,
            "replayed": counters.replayed,
            "superseded": counters.superseded,
            "stale": counters.stale,
            "refused": counters.refused,
            "dropped": counters.dropped,
            "late_ticks": counters.late_ticks,
            "clamped": counters.clamped,
        },
    );
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
