//! `swimmer twin`: a robot in a virtual tank, in real time, behind a pseudo-terminal or a TCP port.

use std::fmt;
use std::path::{Path, PathBuf};

use host_link::Port;
use host_link::port::{FaultPlan, Faults, FaultyPort, TcpPort};
use serde::Serialize;
use swimmer_files::SwimmerFile;
use twin::{TrackError, TwinConfig, TwinPort, WireSpeed, serve};

use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Be a robot in a virtual tank, in real time, until Ctrl-C
///
/// The swimmer file is the truth that only the tank knows. Servos are those of the file, or have a rate limit of
/// 3.5 rad/s and a dead band of 0.017 rad.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("door").args(["pty", "tcp"]).required(true).multiple(true))]
pub(crate) struct Twin {
    /// Make this symbolic link to a pseudo-terminal that any program can open as the robot's port
    #[arg(long, value_name = "LINK")]
    pty: Option<PathBuf>,
    /// Listen here for the robot's bytes over TCP, as 127.0.0.1:7000
    #[arg(long, value_name = "ADDR")]
    tcp: Option<String>,
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER", default_value = "robot")]
    swimmer: String,
    /// Faults of the link, both directions: drop=P,flip=P,duplicate=P,reorder=P (a chance per frame, 5% or 0.05),
    /// delay=MS, clump=BYTES, stale=BYTES (let out again after a silence), baud=RATE, disconnect=START:LENGTH[:EVERY] (ms)
    #[arg(long, value_name = "FAULTS", default_value = "", hide_default_value = true, value_parser = faults)]
    faults: Faults,
    /// Seed of faults and cameras
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write what the virtual cameras see as a Motive file
    #[arg(long, value_name = "FILE.csv")]
    track: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Lived {
    seconds: f64,
    cycles: usize,
    track: Option<String>,
    frames: Option<u64>,
}

impl fmt::Display for Lived {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "The twin lived {:.1} s and began {} cycles.",
            self.seconds, self.cycles
        )?;
        if let (Some(track), Some(frames)) = (&self.track, self.frames) {
            write!(f, " {frames} frames are in {track}.")?;
        }
        Ok(())
    }
}

impl Twin {
    /// Lives until Ctrl-C.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let mut robot = virtual_robot(&file, self.seed)?;
        let interrupt = Interrupt::install()?;
        let mut ports: Vec<Box<dyn Port>> = Vec::new();
        if let Some(link) = &self.pty {
            ports.push(self.faulty(open_terminal(link)?));
            output.line(&format!(
                "{} lives at {}; Ctrl-C ends it.",
                file.name,
                link.display()
            ));
        }
        if let Some(address) = &self.tcp {
            let port = TcpPort::listen(address.as_str()).map_err(|error| {
                Failure::Tried(format!(
                    "cannot listen at {address}: {error}; choose another address or port"
                ))
            })?;
            let heard_at = port
                .local_addr()
                .map_or_else(|| address.clone(), |address| address.to_string());
            ports.push(self.faulty(port));
            output.line(&format!(
                "{} listens at tcp:{heard_at}; Ctrl-C ends it.",
                file.name
            ));
        }
        if let Some(track) = &self.track {
            robot.start_recording(track)?;
        }
        let mut borrowed: Vec<&mut dyn Port> = ports
            .iter_mut()
            .map(|port| port.as_mut() as &mut dyn Port)
            .collect();
        serve(&mut robot, &mut borrowed, |_| !interrupt.requested()).map_err(|error| {
            Failure::Tried(format!("the twin's port failed: {error}; start it again"))
        })?;
        let recording = robot.finish_recording()?;
        output.answer(&Lived {
            seconds: robot.now().as_secs_f64(),
            cycles: robot.cycle_starts().len(),
            track: recording
                .as_ref()
                .map(|recording| recording.path.display().to_string()),
            frames: recording.map(|recording| recording.frames),
        });
        Ok(())
    }

    fn faulty(&self, port: impl Port + 'static) -> Box<dyn Port> {
        if self.faults == Faults::none() {
            return Box::new(port);
        }
        Box::new(FaultyPort::new(
            port,
            FaultPlan::at_robot(self.faults),
            self.seed,
        ))
    }
}

/// A robot in a virtual tank, just switched on.
///
/// # Errors
/// [`Failure::BadInput`] when the file describes no swimmer.
pub(crate) fn virtual_robot(file: &SwimmerFile, seed: u64) -> Outcome<twin::Twin> {
    twin::Twin::new(TwinConfig::new(file, seed)).map_err(|error| {
        Failure::BadInput(format!("the swimmer `{}` cannot swim: {error}", file.name))
    })
}

/// A fresh twin of the paper's robot in virtual time, for commands that want a robot for their own length.
///
/// # Errors
/// None that happens: the preset swims.
pub(crate) fn fresh_twin() -> Outcome<TwinPort> {
    let file = load_swimmer("robot")?;
    Ok(TwinPort::new(virtual_robot(&file, 1)?, WireSpeed::robot()))
}

#[cfg(unix)]
fn open_terminal(link: &Path) -> Outcome<host_link::port::PtyPort> {
    use host_link::port::{PtyError, PtyPort};

    PtyPort::open(Some(link)).map_err(|error| match error {
        PtyError::Occupied(_) | PtyError::InUse { .. } => Failure::bad_input(&error),
        _ => Failure::tried(&error),
    })
}

#[cfg(not(unix))]
fn open_terminal(link: &Path) -> Outcome<TcpPort> {
    Err(Failure::BadInput(format!(
        "cannot make {}: this system has no pseudo-terminals; use --tcp",
        link.display()
    )))
}

fn faults(text: &str) -> Result<Faults, String> {
    text.parse()
        .map_err(|error: host_link::port::FaultsError| error.to_string())
}

impl From<TrackError> for Failure {
    fn from(error: TrackError) -> Self {
        Self::tried(&error)
    }
}
