//! `swimmer twin`: a robot in a virtual tank, in real time, behind a pseudo-terminal or a TCP port.

mod joints;
mod servo_deviation;

use std::fmt;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use gait_player::Transport;
use host_link::Port;
use host_link::port::TcpPort;
use host_link::testing::{FaultPlan, Faults, FaultyPort};
use pose_source::natnet::{COMMAND_PORT, NatNetSocket, Scene, Server};
use pose_source::{TWIN_BODY, TWIN_REFLECTORS, twin_frame};
use serde::Serialize;
use twin::{TrackError, TwinConfig, VirtualRobot as _, World, serve};

use self::joints::Joints;
use crate::arguments::{dead_band, load_robots_swimmer};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::new_file::may_be_written;
use crate::output::{Output, aside};
use crate::virtual_robot::{Carrier, EmulatedBoard};

/// Fastest current of the fluid \[m/s\].
const FASTEST_CURRENT: f64 = 1.0;

/// Be a robot in a virtual tank, in real time, until Ctrl-C
///
/// The swimmer file is the truth that only the tank knows. Servos are those of the file, or have a rate limit of
/// 3.5 rad/s and a dead band of 0.017 rad.
#[derive(Debug, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: NatNet, not `NatNet`
#[command(group = clap::ArgGroup::new("door").args(["pty", "tcp"]).required(true).multiple(true))]
pub(crate) struct Twin {
    /// Make this symbolic link to a pseudo-terminal that any program can open as the robot's port
    #[arg(long, value_name = "LINK")]
    pty: Option<PathBuf>,
    /// Listen here for the robot's bytes over TCP, as 127.0.0.1:7000
    #[arg(long, value_name = "ADDR")]
    tcp: Option<String>,
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER", default_value = "robot")]
    swimmer: String,
    /// Faults of the link, both directions: drop=P,flip=P,duplicate=P,reorder=P (a chance per frame, 5% or 0.05),
    /// delay=MS, clump=BYTES, stale=BYTES (let out again after a silence), baud=RATE, rate=BYTES (a second, towards the robot),
    /// buffer=BYTES (that wait for that rate; more are lost), disconnect=START:LENGTH or START:LENGTH:EVERY (ms)
    #[arg(long, value_name = "FAULTS", default_value = "", hide_default_value = true, value_parser = faults)]
    faults: Faults,
    /// Seed of faults and cameras
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write what the virtual cameras see as a Motive file
    #[arg(long, value_name = "FILE.csv")]
    track: Option<PathBuf>,
    /// Stream what the virtual cameras see by NatNet, as Motive does, from this IPv4 address, as 127.0.0.1 or 127.0.0.1:1510
    #[arg(long, value_name = "ADDR", value_parser = natnet_address)]
    natnet: Option<SocketAddrV4>,
    /// Stream to Motive's multicast group instead of to each client
    #[arg(long, requires = "natnet")]
    multicast: bool,
    /// True properties of a servo that the robot does not know, as front:sign=-,centre=1512 (µs) or back:slope=0.0287 (rad a µs):
    /// for trying `swimmer robot setup`
    #[arg(long = "servo", value_name = "JOINT:KEY=VALUE,…", value_parser = servo_deviation::servo)]
    servos: Vec<servo_deviation::ServoDeviation>,
    /// Half width of the servos' dead band, in place of the swimmer file's
    #[arg(long, value_name = "ANGLE", value_parser = dead_band)]
    dead_band: Option<f64>,
    /// Velocity of the fluid along the tank and across it, m/s, which the robot does not know
    #[arg(long, value_name = "X,Y", value_parser = current, allow_hyphen_values = true)]
    current: Option<Current>,
    /// Take the port for a radio: whoever speaks there need not be at the robot. Else it is its USB cable
    #[arg(long)]
    radio: bool,
    /// Print both joint angles whenever they come to rest: what one would see at the bench
    #[arg(long)]
    show_joints: bool,
    /// Implementation of the robot
    #[arg(long, value_enum, value_name = "ROBOT", default_value = "twin")]
    robot: Carrier,
    #[command(flatten)]
    board: EmulatedBoard,
}

/// Velocity of the fluid \[m/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Current {
    x: f64,
    y: f64,
}

fn current(text: &str) -> Result<Current, String> {
    let part = |text: &str| text.trim().parse::<f64>().ok();
    let parts = text.split_once(',').map(|(x, y)| (part(x), part(y)));
    match parts {
        Some((Some(x), Some(y))) if x.hypot(y) <= FASTEST_CURRENT => Ok(Current { x, y }),
        _ => Err(format!(
            "`{text}` is no velocity of at most {FASTEST_CURRENT} m/s: write X,Y, as 0.0002,-0.0001"
        )),
    }
}

#[derive(Debug, Serialize)]
struct Lived {
    seconds: f64,
    /// `None` for an emulated robot, whose cycles show only in its LED, which has other signals as well.
    cycles: Option<usize>,
    track: Option<String>,
    frames: Option<u64>,
}

impl fmt::Display for Lived {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "The robot lived {:.1} s", self.seconds)?;
        if let Some(cycles) = self.cycles {
            write!(f, " and began {cycles} cycles")?;
        }
        write!(f, ".")?;
        if let (Some(track), Some(frames)) = (&self.track, self.frames) {
            write!(f, " {frames} frames are in {track}.")?;
        }
        Ok(())
    }
}

impl Twin {
    /// Lives until Ctrl-C.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let file = load_robots_swimmer(&self.swimmer)?;
        self.track.as_deref().map_or(Ok(()), may_be_written)?;
        let places = self.tcp.as_deref().map_or(Ok(Vec::new()), addresses)?;
        let mut config = TwinConfig::new(&file, self.seed);
        for servo in &self.servos {
            servo.fit(&mut config.shafts);
        }
        if let Some(dead_band) = self.dead_band {
            config.plant.dead_band = dead_band.abs();
        }
        if let Some(Current { x, y }) = self.current {
            config.current = [x, y];
        }
        if self.radio {
            config.transport = Transport::Uart;
        }
        let mut robot = self
            .robot
            .line_with(&file, &config, &self.board)?
            .into_device();
        let interrupt = Interrupt::install()?;
        let mut ports: Vec<Box<dyn Port>> = Vec::new();
        if let Some(link) = &self.pty {
            ports.push(self.faulty(open_terminal(link)?));
            output.line(&format!(
                "{} runs at {}; Ctrl-C ends it.",
                file.name,
                link.display()
            ));
        }
        if let Some(address) = &self.tcp {
            let port = TcpPort::listen(places.as_slice()).map_err(|error| {
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
            robot.world_mut().start_recording(track)?;
        }
        let mut cameras = self.cameras(output)?;
        if cameras.is_some() {
            robot.world_mut().watch();
        }
        let mut borrowed: Vec<&mut dyn Port> = ports
            .iter_mut()
            .map(|port| port.as_mut() as &mut dyn Port)
            .collect();
        let mut is_reported = false;
        let mut joints = self.show_joints.then(Joints::default);
        serve(&mut robot, &mut borrowed, |robot| {
            if let Some(joints) = &mut joints
                && let Some(line) = joints.look(robot.world())
            {
                output.line(&line);
            }
            if let Some(cameras) = &mut cameras {
                cameras.stream(robot.world_mut());
            }
            if let Some(error) = robot.world().recording_failed().filter(|_| !is_reported) {
                is_reported = true;
                aside(&format!(
                    "warning: {error}; the recording ends here, the robot continues"
                ));
            }
            !interrupt.requested()
        })
        .map_err(|error| Failure::Tried(format!("the robot ended: {error}; start it again")))?;
        let recording = robot.world_mut().finish_recording()?;
        output.print(&Lived {
            seconds: robot.world().now().as_secs_f64(),
            cycles: (self.robot == Carrier::Twin).then(|| robot.world().cycle_starts().len()),
            track: recording
                .as_ref()
                .map(|recording| recording.path.display().to_string()),
            frames: recording.map(|recording| recording.frames),
        });
        Ok(())
    }

    /// The stream of the virtual cameras, if there is to be one.
    fn cameras(&self, output: Output) -> Outcome<Option<CameraStream>> {
        let Some(address) = self.natnet else {
            return Ok(None);
        };
        let scene = Scene {
            body: TWIN_BODY.to_owned(),
            markers: TWIN_REFLECTORS.map(str::to_owned).to_vec(),
        };
        let socket = NatNetSocket::bind(address, Server::new(scene, self.multicast))
            .map_err(|error| Failure::Tried(format!("{error}; choose another address or port")))?;
        let place = socket
            .local_addr()
            .map_or_else(|_| address.to_string(), |address| address.to_string());
        output.line(&format!("Its cameras stream NatNet at natnet:{place}."));
        Ok(Some(CameraStream {
            socket,
            opened: Instant::now(),
        }))
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

/// The virtual cameras behind a socket.
struct CameraStream {
    socket: NatNetSocket,
    opened: Instant,
}

impl CameraStream {
    /// Replies to requests, and sends the frames that were taken since.
    fn stream(&mut self, world: &mut World) {
        let now_s = self.opened.elapsed().as_secs_f64();
        self.socket.reply(now_s);
        let sent_s = world.now().as_secs_f64();
        for (stamp, seen) in world.take_frames() {
            self.socket.send(&twin_frame(&seen, stamp), sent_s, now_s);
        }
    }
}

/// An IPv4 address with or without a port.
fn natnet_address(text: &str) -> Result<SocketAddrV4, String> {
    text.parse()
        .or_else(|_| {
            text.parse::<Ipv4Addr>()
                .map(|address| SocketAddrV4::new(address, COMMAND_PORT))
        })
        .map_err(|_| {
            "write an IPv4 address of this computer, as 127.0.0.1 or 127.0.0.1:1510".to_owned()
        })
}

#[cfg(unix)]
fn open_terminal(link: &Path) -> Outcome<host_link::port::PtyPort> {
    use host_link::port::{PtyError, PtyPort};

    PtyPort::open(Some(link)).map_err(|error| match error {
        PtyError::Occupied(_) | PtyError::InUse { .. } | PtyError::Link { .. } => {
            Failure::bad_input(&error)
        }
        PtyError::NoTerminal(_) => Failure::tried(&error),
    })
}

#[cfg(not(unix))]
fn open_terminal(link: &Path) -> Outcome<TcpPort> {
    Err(Failure::BadInput(format!(
        "cannot make {}: this system has no pseudo-terminals; use --tcp",
        link.display()
    )))
}

/// Socket addresses of a text; listening there may still fail.
fn addresses(text: &str) -> Outcome<Vec<SocketAddr>> {
    text.to_socket_addrs()
        .map(Iterator::collect)
        .map_err(|error| {
            Failure::BadInput(format!(
                "cannot listen at {text}: {error}; write the address as 127.0.0.1:7000"
            ))
        })
}

fn faults(text: &str) -> Result<Faults, String> {
    text.parse()
        .map_err(|error: host_link::testing::FaultsError| error.to_string())
}

impl From<TrackError> for Failure {
    fn from(error: TrackError) -> Self {
        Self::tried(&error)
    }
}
