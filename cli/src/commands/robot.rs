//! `swimmer robot`: talks to a robot over a port, or to a fresh twin for the length of the command.

mod access;
mod bench;
mod configure;
mod dashboard;
mod evaluator;
mod find;
mod flash;
mod go;
mod handle;
mod hc05;
mod info;
mod key;
mod link_monitor;
mod log;
mod motion;
mod outputs;
mod passive;
mod playing;
mod playlist;
mod port;
mod port_owner;
pub(super) mod preflight;
mod rest;
pub(super) mod servo;
mod setup;
mod shared_port;
mod stop;
mod tank_cameras;
mod tracked_play;
mod tracked_report;
mod tracking;
mod trim;
mod upload;
mod watch;

use std::path::PathBuf;

use host_link::LinkError;
use link_protocol::StopCause;
use pose_source::SourceName;
use swimmer_files::GaitSpec;

pub(crate) use self::access::Access;
use self::access::Contact;
pub(crate) use self::bench::Bench;
pub use self::handle::{IsInterrupted, Reply, RobotHandle, RobotOptions, Stopper, TelemetryReport};
pub(crate) use self::link_monitor::{
    CamerasOverLink, LinkMonitor, LinkMonitorOptions, MonitorReport,
};
use self::outputs::RobotState;
use self::port::Pace;
use self::port_owner::PortRequest;
pub(crate) use self::shared_port::{PortEvent, SharedPort, SharedPortOptions};
pub(crate) use self::tracked_report::MonitorLine;
pub(crate) use self::tracking::Tracked;
pub(crate) use self::upload::table_of;
use crate::arguments::{gait, period, positive_angle, rate, seconds, time};
use crate::failure::{Failure, Outcome};
use crate::output::Output;

/// Talk to a robot over a serial port, or to a virtual one
///
/// PORT is a serial port, the link of `swimmer twin --pty`, tcp:HOST:PORT of `swimmer twin --tcp`, or a fresh robot in a
/// virtual tank for the length of this command: `twin`, or `emulator` with the real firmware on an emulated board, each
/// also with a swimmer, as `twin:purcell` or `twin:ours.toml`. It runs as fast as it can where the command ends by itself, and in real time where it waits for the operator (arm, pause,
/// watch, log, play without --cycles).
#[derive(Debug, clap::Args)]
#[command(subcommand_value_name = "ACTION", subcommand_help_heading = "Actions")]
pub(crate) struct Robot {
    #[command(flatten)]
    access: Access,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Say who is there: board, firmware, protocol, limits
    Info,
    /// Say what the robot is doing
    Status,
    /// Tell the robot its lengths and drag, and tighten its limits; stored on the robot
    Configure(Configure),
    /// Predict how the robot will play a gait, and send it
    Upload(Upload),
    /// Power the servos and hold the link until Ctrl-C (= stop)
    Arm(Arm),
    /// Play the active gait: arm, start softly, wait for the end of the last cycle
    Play(Play),
    Go(go::Go),
    /// Hold the pose, and the link until Ctrl-C (= stop)
    Pause(Pause),
    /// Go on from a pause
    Resume,
    /// Ramp to neutral and switch the pulses off; works in every state
    Stop(Stop),
    /// Switch the pulses off at once, latched; --clear ends it, and leaves the robot stopped
    Estop(Estop),
    /// Set the trim of the servos, or nudge it with keys on a terminal; stored on the robot
    Trim(Trim),
    Servo(servo::Servo),
    Setup(setup::Setup),
    Flash(flash::Flash),
    /// Show what the robot does, on a screen with keys to stop it; a line each second where the output is no terminal
    Watch(Watch),
    /// Write every frame on the wire, both ways, as MCAP, until Ctrl-C
    Log(Log),
    Hc05(hc05::Hc05),
    Key(key::KeyChange),
    /// Compare a log with the robot's brain: same frames at the same times, same set-points and pulses?
    ///
    /// The verdict is the same, differs, or undecided: frames were lost shortly before a difference, or the log holds too little.
    /// Exit status 0 for the same, 1 for the others.
    Replay(Replay),
}

#[derive(Debug, clap::Args)]
struct Configure {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// Largest joint angle; may tighten the robot's own limit, never loosen it
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    /// Largest joint rate per second, as 3.5 or 200deg; may tighten the robot's own limit, never loosen it
    #[arg(long, value_name = "ANGLE", value_parser = rate)]
    max_rate: Option<f64>,
}

#[derive(Debug, clap::Args)]
struct Upload {
    /// circle:AMPLITUDE, square:AMPLITUDE or a gait file; add :cw to reverse it
    #[arg(value_name = "GAIT", value_parser = gait)]
    gait: GaitSpec,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    preflight: preflight::Arguments,
    /// Send nothing: only predict the robot's play of the gait. Without --port no robot is contacted, and the swimmer is that of
    /// --swimmer; exit status 1 if the gait must not be played
    #[arg(long)]
    dry_run: bool,
}

/// Swimmer that the gait is for.
#[derive(Debug, clap::Args)]
struct Owner {
    /// The swimmer that this robot is, where no preset describes it: a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: Option<String>,
    /// Upload although the gait file was made for another swimmer
    #[arg(long)]
    force: bool,
}

#[derive(Debug, clap::Args)]
struct Arm {
    /// Also end a latched emergency stop
    #[arg(long)]
    clear_estop: bool,
}

#[derive(Debug, clap::Args)]
struct Play {
    /// Upload this gait first
    #[arg(long, value_name = "GAIT", value_parser = gait)]
    gait: Option<GaitSpec>,
    /// Play the gaits of this playlist, which `swimmer plan -o` writes, one after the other without a pause
    #[arg(long, value_name = "FILE", conflicts_with_all = ["gait", "cycles", "period", "detach", "at_most", "attach"])]
    playlist: Option<PathBuf>,
    #[command(flatten)]
    room: preflight::TankOptions,
    #[command(flatten)]
    owner: Owner,
    /// End after this many cycles; left out, the robot plays until Ctrl-C
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    cycles: Option<u32>,
    /// Seconds a cycle takes
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = period)]
    period: f64,
    /// Return once the robot plays; it plays on to its end without the link
    #[arg(long, requires = "cycles")]
    detach: bool,
    /// Refuse a detached play that is longer than this, as 30min or seconds; an hour at most
    #[arg(long = "for", value_name = "TIME", value_parser = time, requires = "detach")]
    at_most: Option<f64>,
    /// Start nothing: wait for the end of the play that goes on detached, as if it had not been; Ctrl-C stops it
    #[arg(long, conflicts_with_all = ["gait", "cycles", "period", "detach", "at_most", "swimmer", "force"])]
    attach: bool,
    /// Compare each cycle with the prediction by what cameras see: natnet[:HOST[,LOCAL]] (Motive), tcp:HOST:PORT (JSON lines), -
    /// (JSON lines on standard input), or `twin` for the cameras of --port twin or emulator. With --tank the robot is stopped 10 mm
    /// from a wall
    #[arg(long, value_name = "SOURCE", requires = "gait", conflicts_with_all = ["playlist", "detach", "attach"], help_heading = "Tracking")]
    track: Option<SourceName>,
    #[command(flatten)]
    visible: tracking::Visible,
}

#[derive(Debug, clap::Args)]
struct Pause {
    /// Return at once; the robot holds the pose for at most 60 s, then stops
    #[arg(long)]
    detach: bool,
}

#[derive(Debug, clap::Args)]
struct Stop {
    /// If another `swimmer` has the port and hangs: stop the robot past it, without asking
    #[arg(long)]
    take_over: bool,
}

#[derive(Debug, clap::Args)]
struct Estop {
    /// If another `swimmer` has the port and hangs: leave it alone, and fail
    #[arg(long)]
    no_take_over: bool,
    /// End a latched e-stop instead, and leave the robot stopped; asks first
    #[arg(long, conflicts_with = "no_take_over")]
    clear: bool,
    /// Clear without asking
    #[arg(long, requires = "clear")]
    yes: bool,
}

#[derive(Debug, clap::Args)]
struct Trim {
    /// Trim of the front joint, φ₁
    #[arg(long, value_name = "ANGLE", value_parser = trim::angle_of_trim, allow_hyphen_values = true)]
    front: Option<f64>,
    /// Trim of the back joint, φ₂
    #[arg(long, value_name = "ANGLE", value_parser = trim::angle_of_trim, allow_hyphen_values = true)]
    back: Option<f64>,
}

#[derive(Debug, clap::Args)]
struct Watch {
    /// End after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f64>,
    /// Draw what cameras see over the robot's own prediction: natnet[:HOST[,LOCAL]] (Motive), tcp:HOST:PORT (JSON lines), - (JSON
    /// lines on standard input)
    #[arg(long, value_name = "SOURCE", help_heading = "Tracking")]
    track: Option<SourceName>,
    #[command(flatten)]
    visible: tracking::Visible,
}

#[derive(Debug, clap::Args)]
struct Log {
    /// File to write; it must not exist
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,
    /// End after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f64>,
}

#[derive(Debug, clap::Args)]
struct Replay {
    /// A link log: of `log`, or of any command with --log, from its start
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,
    /// The gait that the robot held when the log began, where the log does not upload it
    #[arg(long, value_name = "GAIT", value_parser = gait)]
    gait: Option<GaitSpec>,
}

impl Robot {
    /// Runs the subcommand.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let access = &self.access;
        match &self.action {
            Action::Info => info::run(access, output),
            Action::Status => status(access, output),
            Action::Configure(arguments) => configure::configure(access, arguments, output),
            Action::Upload(arguments) => upload::run(access, arguments, output),
            Action::Arm(arguments) => motion::arm(access, arguments, output),
            Action::Play(arguments) => motion::play(access, arguments, output),
            Action::Go(arguments) => go::go(access, arguments, output),
            Action::Pause(arguments) => motion::pause(access, arguments, output),
            Action::Resume => motion::resume(access, output),
            Action::Stop(arguments) => stop::stop(access, arguments, output),
            Action::Estop(arguments) => stop::estop(access, arguments, output),
            Action::Trim(arguments) => trim::trim(access, arguments, output),
            Action::Servo(arguments) => servo::run(access, arguments, output),
            Action::Setup(arguments) => setup::run(access, arguments, output),
            Action::Flash(arguments) => flash::run(access, arguments, output),
            Action::Watch(arguments) => watch::watch(access, arguments, output),
            Action::Log(arguments) => log::log(access, arguments, output),
            Action::Hc05(arguments) => hc05::run(access, arguments, output),
            Action::Key(arguments) => key::run(access, arguments, output),
            Action::Replay(arguments) => log::replay_log(arguments, output),
        }
    }
}

fn status(access: &Access, output: Output) -> Outcome {
    match access.contact(
        PortRequest::Status,
        "swimmer robot status",
        Pace::AsFastAsPossible,
    )? {
        Contact::Relayed(relayed) => {
            output.print(&relayed.into_output());
            Ok(())
        }
        Contact::Direct(mut line) => {
            output.print(&RobotState::of(&mut line.robot)?);
            line.close()
        }
    }
}

impl From<LinkError> for Failure {
    /// Whatever the link or the robot says no to was tried; a number that no frame can carry was never sent.
    fn from(error: LinkError) -> Self {
        match error {
            LinkError::OutOfRange { .. } => Self::bad_input(&error),
            LinkError::Port { .. }
            | LinkError::NoAnswer { .. }
            | LinkError::Silent { .. }
            | LinkError::SessionLost { .. }
            | LinkError::NotConnected { .. }
            | LinkError::StoppedEarly {
                cause: StopCause::LinkLost,
                ..
            } => Self::LinkLost(Self::tried(&error).to_string()),
            _ => Self::tried(&error),
        }
    }
}
