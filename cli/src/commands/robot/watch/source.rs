//! Source of a watcher's telemetry: its own line, or the process that has the port.

use std::thread::sleep;
use std::time::{Duration, Instant};

use host_link::robot::{SILENCE_REPORTED, Silence};
use host_link::session::{ClockFit, LinkCounters};
use host_link::{LinkError, Port as _};
use link_protocol::Telemetry;

use super::super::access::{Access, Contact, RobotConnection};
use super::super::outputs::RobotState;
use super::super::port::Pace;
use super::super::port_owner::{Introduction, LinkReport, PortRequest};
use super::super::status;
use crate::failure::Outcome;
use crate::output::{Output, aside};

const COMMAND: &str = "swimmer robot watch";
/// Time between two questions to the process that has the port.
const ASK_EVERY: Duration = Duration::from_millis(200);

/// Source of a watcher's telemetry.
pub(super) enum Source<'a> {
    Own(Box<RobotConnection>),
    PortHolder(Box<HolderConnection<'a>>),
}

/// Connection to the process that has the port.
pub(super) struct HolderConnection<'a> {
    access: &'a Access,
    introduction: Introduction,
    news: LinkReport,
    begun: Instant,
    /// The robot's clock at the telemetry seen last, µs.
    seen_us: Option<u64>,
    heard: Instant,
    /// `true` if the screen shows the time since the last frame.
    shows_silence: bool,
    /// Nothing more is to be said of the present silence.
    silence_reported: bool,
}

/// Result of listening for one beat.
pub(super) enum Beat {
    Telemetry(Telemetry),
    Nothing,
    /// Nothing comes through at present.
    OutOfReach(LinkError),
    /// The process that had the port let it go.
    LetGo,
}

impl<'a> Source<'a> {
    /// The process that has the port, or the port.
    ///
    /// # Errors
    /// As [`Access::contact`].
    pub(super) fn find(access: &'a Access) -> Outcome<Self> {
        let met = if access.logs() {
            // Frames are seen only by who has the port.
            Contact::Direct(Box::new(access.connect(COMMAND, Pace::RealTime)?))
        } else {
            access.contact(PortRequest::Introduce, COMMAND, Pace::RealTime)?
        };
        Ok(match met {
            Contact::Direct(line) => Self::Own(line),
            Contact::Relayed(relayed) => Self::PortHolder(Box::new(HolderConnection {
                access,
                introduction: relayed.read()?,
                news: LinkReport::default(),
                begun: Instant::now(),
                seen_us: None,
                heard: Instant::now(),
                shows_silence: false,
                silence_reported: false,
            })),
        })
    }

    /// Robot and port, for a title.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn introduction(&mut self) -> Outcome<(Introduction, String)> {
        Ok(match self {
            Self::Own(line) => (
                Introduction::of(&mut line.robot)?,
                format!("at {}", line.name()),
            ),
            Self::PortHolder(beside) => (
                beside.introduction.clone(),
                "through the program that has its port".to_owned(),
            ),
        })
    }

    /// Listens for a moment.
    ///
    /// # Errors
    /// The port's, or what the process that has it says.
    pub(super) fn beat(&mut self) -> Outcome<Beat> {
        match self {
            Self::Own(line) => Ok(match line.beat() {
                Ok(Some(telemetry)) => Beat::Telemetry(telemetry),
                Ok(None) => Beat::Nothing,
                Err(error @ LinkError::Port { .. }) => return Err(error.into()),
                Err(error) => Beat::OutOfReach(error),
            }),
            Self::PortHolder(beside) => beside.beat(),
        }
    }

    /// Greets again after [`Beat::OutOfReach`]; false where that came to nothing.
    pub(super) fn greet_again(&mut self) -> bool {
        match self {
            Self::Own(line) => line.robot.reconnect().is_ok(),
            // Its matter, not ours.
            Self::PortHolder(_) => false,
        }
    }

    /// Reports no silence: a screen shows it.
    pub(super) fn shows_silence(&mut self) {
        match self {
            Self::Own(line) => line.shows_silence(),
            Self::PortHolder(beside) => {
                (beside.shows_silence, beside.silence_reported) = (true, true);
            }
        }
    }

    /// Counters and clock of the link.
    pub(super) fn link(&self) -> (LinkCounters, Option<ClockFit>) {
        match self {
            Self::Own(line) => (line.robot.link_counters(), line.robot.clock()),
            Self::PortHolder(beside) => (beside.news.link, beside.news.clock),
        }
    }

    /// A clock that runs while the robot does.
    pub(super) fn now(&self) -> Duration {
        match self {
            Self::Own(line) => line.robot.port().now(),
            Self::PortHolder(beside) => beside.begun.elapsed(),
        }
    }

    /// Stops or e-stops the robot.
    ///
    /// # Errors
    /// The link's, or what the process that has the port says.
    pub(super) fn stop(&mut self, estop: bool) -> Outcome {
        match self {
            Self::Own(line) if estop => Ok(line.robot.estop().map(drop)?),
            Self::Own(line) => Ok(line.robot.stop().map(drop)?),
            Self::PortHolder(beside) => {
                let ask = if estop {
                    PortRequest::EStop
                } else {
                    PortRequest::Stop
                };
                beside
                    .access
                    .contact(ask, COMMAND, Pace::RealTime)
                    .and_then(|met| match met {
                        Contact::Relayed(_) => Ok(()),
                        // It let go of the port in this very moment.
                        Contact::Direct(mut line) if estop => Ok(line.robot.estop().map(drop)?),
                        Contact::Direct(mut line) => Ok(line.robot.stop().map(drop)?),
                    })
            }
        }
    }

    /// Lets the robot go.
    ///
    /// # Errors
    /// Where a log could not be written.
    pub(super) fn close(self) -> Outcome {
        match self {
            Self::Own(line) => line.close(),
            Self::PortHolder(_) => Ok(()),
        }
    }

    /// Tells at the end what the robot does, and lets it go.
    ///
    /// # Errors
    /// The link's, or where a log could not be written.
    pub(super) fn leave(self, output: Output) -> Outcome {
        match self {
            Self::Own(mut line) => {
                output.print(&RobotState::of(&mut line.robot)?);
                line.close()
            }
            Self::PortHolder(beside) => status(beside.access, output),
        }
    }
}

impl HolderConnection<'_> {
    fn beat(&mut self) -> Outcome<Beat> {
        sleep(ASK_EVERY);
        let Some(relayed) = self.access.request_holder(PortRequest::News)? else {
            return Ok(Beat::LetGo);
        };
        self.news = relayed.read()?;
        let news = self
            .news
            .telemetry
            .filter(|telemetry| self.seen_us.is_none_or(|seen| telemetry.robot_us > seen));
        if let Some(telemetry) = news {
            self.seen_us = Some(telemetry.robot_us);
            self.heard = Instant::now();
            self.silence_reported = self.shows_silence;
            return Ok(Beat::Telemetry(telemetry));
        }
        let silent = self.heard.elapsed();
        if silent >= SILENCE_REPORTED && !self.silence_reported {
            self.silence_reported = true;
            let doing = "watching through the program that has the port";
            aside(&format!("note: {}.", Silence::Began { doing, silent }));
        }
        Ok(Beat::Nothing)
    }
}
