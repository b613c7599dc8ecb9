//! Access to the robot: the named port, or the one where a robot answers; other processes that hold it; the log.

use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use host_link::port::{ListedPort, TracedPort, serial_ports};
use host_link::robot::{Callbacks, Halt};
use host_link::session::SessionConfig;
use host_link::{LinkError, Port as _, Robot};
use link_protocol::{Flags, Joint, Telemetry};
use swimmer_files::SwimmerFile;

use super::find::{self, GreetingResult};
use super::key::KeyFile;
use super::port::{AnyPort, BAUD, Means, NotOpen, Opened, Pace, fresh, open, open_filmed};
use super::port_owner::{HeldBy, PortHolder, PortRequest, Relayed};
use super::tank_cameras::TankCameras;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::link_log::Recorder;
use crate::output::aside;
use crate::virtual_robot::EmulatedBoard;

/// Options that name the port, the log and the key.
#[derive(Debug, clap::Args)]
pub(crate) struct Access {
    /// Serial port, pseudo-terminal, tcp:HOST:PORT, `twin` or `emulator`; of several (A,B,C) the one where a robot answers. Left out:
    /// the one USB or Bluetooth serial port where a robot answers
    #[arg(long, value_name = "PORT", global = true, value_delimiter = ',')]
    port: Vec<String>,
    /// Also write every frame on the wire, both ways, to this MCAP file; nothing may be there yet
    #[arg(long, value_name = "FILE.mcap", global = true)]
    log: Option<PathBuf>,
    /// Speed of the serial line: that of the firmware's build (SWIMMER_LINK_BAUD) and of the robot's Bluetooth module
    #[allow(clippy::doc_markdown)] // shown as it stands
    #[arg(long, value_name = "BAUD", global = true, default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(1200..=4_000_000))]
    baud: u32,
    #[command(flatten)]
    key: KeyFile,
    #[command(flatten)]
    board: EmulatedBoard,
}

/// A greeted robot, with port name, log and requests of other processes.
pub(super) struct RobotConnection {
    pub(super) robot: Robot<AnyPort>,
    /// The port's name.
    name: String,
    holder: PortHolder,
    recorder: Option<Recorder>,
    /// The robot's clock at the telemetry seen last, µs.
    seen_us: Option<u64>,
}

/// Connection to the robot: its own line, or the process that holds the port.
pub(super) enum Contact {
    /// Over the robot's port, which this process holds.
    Direct(Box<RobotConnection>),
    /// Through the process that holds the port and has served the request.
    Relayed(Relayed),
}

/// State of a named port.
pub(super) enum PortState {
    /// Free, and now opened by this process.
    Free(Opened),
    /// Held by another `swimmer`.
    Held(HeldBy),
}

/// Usual time for which a short command of another process has the port.
pub(super) const A_MOMENT: Duration = Duration::from_secs(1);
/// Interval between two tries of a taken port.
pub(super) const LOOK_AGAIN: Duration = Duration::from_millis(50);
/// Interval at which a waiting command handles Ctrl-C, requests of other processes and its end.
pub(super) const BEAT: Duration = Duration::from_millis(20);

/// Storing takes a second at most, and is tried again after a failure.
const TO_STORE: Duration = Duration::from_secs(5);

impl Access {
    /// Access without options of the command line. `key` is the file of the robot's key, `log` a new link log.
    pub(crate) fn new(
        port: Vec<String>,
        baud: Option<u32>,
        key: Option<PathBuf>,
        log: Option<PathBuf>,
    ) -> Self {
        Self {
            port,
            log,
            baud: baud.unwrap_or(BAUD),
            key: KeyFile::of(key),
            board: EmulatedBoard::default(),
        }
    }

    /// `true` if a port was named.
    pub(super) fn names_a_port(&self) -> bool {
        !self.port.is_empty()
    }

    /// Returns `true` if the one port is a fresh virtual robot.
    pub(super) fn is_fresh(&self) -> bool {
        matches!(self.port.as_slice(), [name] if fresh(name).is_some())
    }

    /// `true` if every frame is to be logged.
    pub(super) fn logs(&self) -> bool {
        self.log.is_some()
    }

    /// The same access with another log.
    pub(crate) fn logging_to(&self, log: PathBuf) -> Self {
        Self {
            port: self.port.clone(),
            log: Some(log),
            baud: self.baud,
            key: self.key.clone(),
            board: self.board.clone(),
        }
    }

    /// The same access for a stop, which needs no key and must not fail for one.
    pub(super) fn for_a_stop(&self) -> Self {
        Self {
            port: self.port.clone(),
            log: self.log.clone(),
            baud: self.baud,
            key: self.key.if_readable(),
            board: self.board.clone(),
        }
    }

    /// A session with the robot that has not begun yet.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the file that was named holds no key.
    pub(super) fn session(&self) -> Outcome<SessionConfig> {
        Ok(SessionConfig {
            // Ten bits a byte.
            bytes_per_second: f64::from(self.baud) / 10.0,
            ..self.key.session()?
        })
    }

    /// Speed of the serial line.
    pub(super) fn baud(&self) -> u32 {
        self.baud
    }

    fn means(&self, pace: Pace) -> Outcome<Means> {
        Ok(Means {
            pace,
            baud: self.baud,
            session: self.session()?,
            board: self.board.clone(),
        })
    }

    /// The one port that was named, where nothing is to be logged: for what is no robot and speaks no frames.
    pub(super) fn bare_port(&self) -> Option<&str> {
        match self.port.as_slice() {
            [name] if self.log.is_none() => Some(name),
            _ => None,
        }
    }

    /// Connects to the robot and greets it. Other processes see `command` as the holder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where no port was named and none or several can be meant, [`Failure::Tried`] when the port
    /// cannot be opened or no robot answers.
    pub(super) fn connect(&self, command: &str, pace: Pace) -> Outcome<RobotConnection> {
        let recorder = self.recorder()?;
        if let [name] = self.port.as_slice() {
            let means = self.means(pace)?;
            let opened = open_when_free(name, &means)?;
            return self.greeted(opened, means.session, recorder, command);
        }
        let (name, robot) = self.find(pace)?;
        let holder = PortHolder::announce(&name, command);
        let mut robot = robot.map_port(|port| traced(port, recorder.as_ref(), &name));
        robot.call_back(callbacks(&holder));
        if recorder.is_some() {
            // The greeting belongs to the log: it determines the session that follows.
            robot.reconnect()?;
        }
        let mut line = RobotConnection::new(name, robot, holder, recorder)?;
        line.say_what_the_key_is_worth(self.key.is_named())?;
        Ok(line)
    }

    /// Greets the robot behind an open port. From here on the port is ours: others learn so, also during the greeting.
    fn greeted(
        &self,
        opened: Opened,
        session: SessionConfig,
        recorder: Option<Recorder>,
        command: &str,
    ) -> Outcome<RobotConnection> {
        let port = traced(opened.port, recorder.as_ref(), &opened.name);
        let holder = PortHolder::announce(&opened.name, command);
        let callbacks = callbacks(&holder);
        let robot = Robot::connect_observed(port, session, callbacks)?;
        let mut line = RobotConnection::new(opened.name, robot, holder, recorder)?;
        line.say_what_the_key_is_worth(self.key.is_named())?;
        Ok(line)
    }

    /// Connects to a fresh virtual robot in whose tank the port's swimmer, otherwise `file`, is the truth, and keeps the frames of its cameras.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the port is another, and as [`connect`](Self::connect).
    pub(super) fn connect_filmed(
        &self,
        command: &str,
        file: &SwimmerFile,
        seed: u64,
        cameras: &TankCameras,
    ) -> Outcome<RobotConnection> {
        let name = match self.port.as_slice() {
            [name] => name.as_str(),
            _ => "",
        };
        let recorder = self.recorder()?;
        let means = self.means(Pace::AsFastAsPossible)?;
        let opened = open_filmed(name, &means, file, seed, cameras)?;
        self.greeted(opened, means.session, recorder, command)
    }

    fn recorder(&self) -> Outcome<Option<Recorder>> {
        let recorder = self.log.as_deref().map(Recorder::create).transpose()?;
        Ok(recorder.map(Recorder::announced))
    }

    /// Sends a request to the process that holds the robot's port, or takes the port.
    ///
    /// # Errors
    /// As [`Self::request_holder`] and [`Self::connect`].
    pub(super) fn contact(&self, ask: PortRequest, command: &str, pace: Pace) -> Outcome<Contact> {
        let begun = Instant::now();
        loop {
            if let Some(relayed) = self.request_holder(ask)? {
                return Ok(Contact::Relayed(relayed));
            }
            match self.connect(command, pace) {
                Ok(line) => return Ok(Contact::Direct(Box::new(line))),
                // Another process took the port in between: the request can go to it.
                Err(_) if self.held_by().is_some() && begun.elapsed() < 3 * A_MOMENT => {}
                Err(failure) => return Err(failure),
            }
        }
    }

    /// The port that was named, without a greeting; `None` where it must be looked for.
    ///
    /// # Errors
    /// [`Failure::Tried`] when the port cannot be opened.
    pub(super) fn open_named(&self, pace: Pace) -> Outcome<Option<PortState>> {
        match self.port.as_slice() {
            [name] => try_open(name, &self.means(pace)?).map(Some),
            _ => Ok(None),
        }
    }

    /// Passes a request on to the process that holds the robot's port. Returns `None` if the port is free.
    ///
    /// # Errors
    /// The reply of that process.
    pub(super) fn request_holder(&self, ask: PortRequest) -> Outcome<Option<Relayed>> {
        match self.held_by() {
            Some(held_by) => held_by.ask(ask),
            None => Ok(None),
        }
    }

    /// The process that holds the robot's port.
    pub(super) fn held_by(&self) -> Option<HeldBy> {
        if let [name] = self.port.as_slice() {
            return HeldBy::of(name);
        }
        let candidates = self.candidates().into_iter();
        let mut held = candidates.filter_map(|port| HeldBy::of(&port.path));
        // With several it is unclear which one is meant.
        held.next().filter(|_| held.next().is_none())
    }

    fn candidates(&self) -> Vec<ListedPort> {
        if self.port.is_empty() {
            // Where the system does not know what is behind a port, nothing is sent there unasked.
            let known = serial_ports().into_iter();
            return known.filter(|port| !port.about.is_empty()).collect();
        }
        let named = self.port.iter().map(|path| ListedPort {
            path: path.clone(),
            about: String::new(),
        });
        named.collect()
    }

    /// The one candidate where a robot answers, greeted; says which.
    pub(super) fn find(&self, pace: Pace) -> Outcome<(String, Robot<AnyPort>)> {
        let (port, robot) = find::choose(find::greet_all(self.candidates(), &self.means(pace)?))?;
        aside(&format!("The robot is at {port}."));
        Ok((port.path, robot))
    }
}

/// Opens what was named, unless another `swimmer` has it. A port that somebody has only for a moment is waited for.
///
/// # Errors
/// [`Failure::Tried`] when it cannot be opened.
fn try_open(name: &str, means: &Means) -> Outcome<PortState> {
    let begun = Instant::now();
    loop {
        if let Some(held_by) = HeldBy::of(name) {
            return Ok(PortState::Held(held_by));
        }
        match open(name, means) {
            Ok(opened) => return Ok(PortState::Free(opened)),
            Err(NotOpen::Busy(_)) if begun.elapsed() < A_MOMENT => sleep(LOOK_AGAIN),
            Err(NotOpen::Busy(failure) | NotOpen::Failed(failure)) => return Err(failure),
        }
    }
}

/// [`try_open`], for what needs the port for itself: another `swimmer` may be about to end.
pub(super) fn open_when_free(name: &str, means: &Means) -> Outcome<Opened> {
    let begun = Instant::now();
    loop {
        match try_open(name, means)? {
            PortState::Free(opened) => return Ok(opened),
            PortState::Held(_) if begun.elapsed() < A_MOMENT => sleep(LOOK_AGAIN),
            PortState::Held(held_by) => return Err(Failure::Tried(held_by.to_string())),
        }
    }
}

/// Greets whoever is behind a candidate.
pub(super) fn greet(name: &str, means: &Means) -> GreetingResult {
    let greeted = open_when_free(name, means)
        .and_then(|opened| Ok(Robot::connect_with(opened.port, means.session)?));
    greeted.map_err(|failure| failure.to_string())
}

/// Reports of a silent link on standard error, and stops that other processes request while the robot is waited for.
fn callbacks(holder: &PortHolder) -> Callbacks {
    let halts = holder.halts();
    Callbacks {
        halt: Some(Box::new(move || halts.take())),
        ..report_silence()
    }
}

/// Reports of a silent link on standard error.
pub(super) fn report_silence() -> Callbacks {
    Callbacks {
        silence: Some(Box::new(|silence| aside(&format!("note: {silence}.")))),
        halt: None,
    }
}

fn traced(port: AnyPort, recorder: Option<&Recorder>, name: &str) -> AnyPort {
    let Some(recorder) = recorder else {
        return port;
    };
    let epoch = if fresh(name).is_some() {
        Duration::ZERO
    } else {
        let today = SystemTime::now().duration_since(UNIX_EPOCH);
        today.unwrap_or_default().saturating_sub(port.now())
    };
    Box::new(TracedPort::new(port, recorder.sink(epoch)))
}

impl RobotConnection {
    /// Returns `true` if the robot is a virtual one that ends with the command.
    pub(super) fn is_fresh(&self) -> bool {
        fresh(&self.name).is_some()
    }

    fn new(
        name: String,
        robot: Robot<AnyPort>,
        holder: PortHolder,
        recorder: Option<Recorder>,
    ) -> Outcome<Self> {
        let mut line = Self {
            robot,
            name,
            holder,
            recorder,
            seen_us: None,
        };
        if line.recorder.is_some() {
            line.introduce()?;
        }
        Ok(line)
    }

    /// Says where a key was named and does not protect: what the operator takes for locked stands open, or is not shown to be.
    fn say_what_the_key_is_worth(&mut self, key_named: bool) -> Outcome {
        if key_named {
            let has_key = self.robot.status()?.flags.contains(Flags::KEY_SET);
            let signs = self.robot.answers_signed() == Some(true);
            doubt(has_key, signs).into_iter().for_each(aside);
        }
        Ok(())
    }

    /// Has the robot say what it is made of, so that a log alone is enough to live it again.
    fn introduce(&mut self) -> Outcome {
        let robot = &mut self.robot;
        robot.configuration()?;
        robot.servo(Joint::Front)?;
        robot.servo(Joint::Back)?;
        robot.status()?;
        Ok(())
    }

    /// Greets the robot again. If that fails, the port is opened again: its name may lead to another device by now.
    ///
    /// # Errors
    /// [`Failure::LinkLost`] if the robot is still out of reach; others as the greeting.
    pub(super) fn regain(&mut self, access: &Access) -> Outcome {
        let Err(error) = self.robot.reconnect() else {
            return Ok(());
        };
        let failure = Failure::from(error);
        if !matches!(failure, Failure::LinkLost(_)) || self.is_fresh() {
            return Err(failure);
        }
        let Ok(opened) = open(&self.name, &access.means(Pace::RealTime)?) else {
            return Err(failure);
        };
        let port = traced(opened.port, self.recorder.as_ref(), &self.name);
        self.robot.replace_port(port)?;
        Ok(())
    }

    /// Ctrl-C stops the robot from now on, whatever request is waited for.
    pub(super) fn stops_on(&mut self, interrupt: &Interrupt) {
        let halts = self.holder.halts();
        let (interrupt, mut acted) = (interrupt.clone(), false);
        self.robot.halt_when(Box::new(move || {
            let pressed =
                interrupt.requested() && !std::mem::replace(&mut acted, interrupt.requested());
            halts.take().or_else(|| pressed.then_some(Halt::Stop))
        }));
    }

    /// Reports no silence any more: a screen that is drawn shows it itself.
    pub(super) fn shows_silence(&mut self) {
        let halts = self.holder.halts();
        self.robot.call_back(Callbacks {
            silence: None,
            halt: Some(Box::new(move || halts.take())),
        });
    }

    /// Returns `true` if another process has requested a stop since the port was opened.
    pub(super) fn was_stopped(&self) -> bool {
        self.holder.halts().was_set()
    }

    /// Name of the port.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Waits for one beat: listens, and serves requests of other processes. Returns new telemetry.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn beat(&mut self) -> Result<Option<Telemetry>, LinkError> {
        self.robot
            .listen(BEAT, |_| std::ops::ControlFlow::Continue(()))?;
        self.holder.serve(&mut self.robot);
        let news = self
            .robot
            .telemetry()
            .copied()
            .filter(|telemetry| self.seen_us.is_none_or(|seen| telemetry.robot_us > seen));
        if let Some(telemetry) = &news {
            self.seen_us = Some(telemetry.robot_us);
        }
        Ok(news)
    }

    /// Waits until the robot has stored its settings. `what`: that which was set, with its verb.
    ///
    /// # Errors
    /// The link's, and [`Failure::Tried`] where the robot could not.
    pub(super) fn stored(&mut self, what: &str) -> Outcome {
        let mut waited = Duration::ZERO;
        loop {
            let status = self.robot.status()?;
            if !status.flags.contains(Flags::UNSAVED) {
                return Ok(());
            }
            if status.flags.contains(Flags::STORAGE_FAILED) || waited > TO_STORE {
                return Err(Failure::Tried(format!(
                    "{what} in force, but the robot could not store that: it lasts until its power goes; try again"
                )));
            }
            self.beat()?;
            waited += BEAT;
        }
    }

    /// The robot and the queue of requests, for calls that cannot [`beat`](Self::beat).
    pub(super) fn split(&mut self) -> (&mut Robot<AnyPort>, &mut PortHolder) {
        (&mut self.robot, &mut self.holder)
    }

    /// Lets the robot go and closes the log, if there is one.
    ///
    /// # Errors
    /// Where the log could not be written.
    pub(super) fn close(self) -> Outcome {
        self.close_log().map(|_| ())
    }

    /// [`close`](Self::close), and how many frames the log holds.
    ///
    /// # Errors
    /// As there.
    pub(super) fn close_log(self) -> Outcome<Option<u64>> {
        let Self {
            robot, recorder, ..
        } = self;
        drop(robot);
        match recorder {
            Some(recorder) => recorder.finish().map(Some),
            None => Ok(None),
        }
    }
}

/// Note about a named key, according to the robot's reply.
fn doubt(has_key: bool, signs: bool) -> Option<&'static str> {
    match (has_key, signs) {
        (false, _) => Some(
            "note: --key names a key, but the robot has none: anyone who reaches its port can drive it. `swimmer robot key make FILE` gives it one",
        ),
        (true, false) => Some(
            "note: the robot reports a key but does not sign its replies, so they are not authenticated. Its firmware may be older: `swimmer robot flash` installs the current one",
        ),
        (true, true) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::doubt;

    #[test]
    fn a_key_that_does_not_protect_is_doubted() {
        assert!(doubt(false, false).unwrap().contains("has none"));
        assert!(doubt(true, false).unwrap().contains("does not sign"));
        assert_eq!(doubt(true, true), None);
    }
}
