//! Requests to the holder of a port, and the line of its reply.

use std::fmt;

use clap::ValueEnum;
use host_link::robot::Halt;
use host_link::session::{ClockFit, LinkCounters};
use host_link::{LinkError, Robot};
use link_protocol::{Board, Configuration, Status, Telemetry};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::super::outputs::{Done, E_STOPPED, PAUSED_DETACHED, RobotState, state};
use super::super::port::AnyPort;
use crate::failure::{Failure, Outcome};

/// Something that the holder of the port does for another process. The word is the line on the socket.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "lowercase")]
pub(in super::super) enum PortRequest {
    /// Drop the pulses.
    EStop,
    /// Ramp to neutral.
    Stop,
    /// Hold the pose for as long as the holder keeps the link.
    Pause,
    /// Hold the pose for a minute at most.
    #[value(name = "pause-detached")]
    PauseDetached,
    /// Go on.
    Resume,
    /// Say what the robot does.
    Status,
    /// Say which robot it is: [`Introduction`].
    Introduce,
    /// Report the last received state of the robot, without a request to the robot: [`LinkReport`].
    News,
}

/// The holder's robot and its state: the start of a screen in another process.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in super::super) struct Introduction {
    pub(in super::super) board: Board,
    pub(in super::super) firmware: String,
    pub(in super::super) configuration: Configuration,
    pub(in super::super) status: Status,
}

impl Introduction {
    /// The robot's own.
    ///
    /// # Errors
    /// The link's.
    pub(in super::super) fn of(robot: &mut Robot<AnyPort>) -> Result<Self, LinkError> {
        Ok(Self {
            board: robot.info().board,
            firmware: robot.firmware(),
            configuration: robot.configuration()?,
            status: robot.status()?,
        })
    }
}

/// State of a robot and its link.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(in super::super) struct LinkReport {
    pub(in super::super) telemetry: Option<Telemetry>,
    pub(in super::super) link: LinkCounters,
    pub(in super::super) clock: Option<ClockFit>,
}

impl LinkReport {
    fn of(robot: &Robot<AnyPort>) -> Self {
        Self {
            telemetry: robot.telemetry().copied(),
            link: robot.link_counters(),
            clock: robot.clock(),
        }
    }
}

impl PortRequest {
    /// The stop that this requests. Returns `None` for other requests.
    pub(in super::super) fn halt(self) -> Option<Halt> {
        match self {
            Self::Stop => Some(Halt::Stop),
            Self::EStop => Some(Halt::EStop),
            _ => None,
        }
    }

    /// Does it; the robot's word comes back.
    pub(super) fn of(self, robot: &mut Robot<AnyPort>) -> Relayed {
        let done = |robot: &mut Robot<AnyPort>, sentence: &str| {
            let state = state(robot.status()?.state);
            Ok(Relayed::of(&Done {
                state,
                sentence: sentence.to_owned(),
            }))
        };
        let answered: Result<Relayed, LinkError> = match self {
            Self::EStop => robot.estop().and_then(|_| done(robot, E_STOPPED)),
            Self::Stop => robot.stop().and_then(|_| {
                done(
                    robot,
                    "Stopping: the robot ramps to neutral, then the pulses go off.",
                )
            }),
            Self::Pause => robot.pause(false).and_then(|()| {
                done(
                    robot,
                    "Paused: the program that has the port keeps the link, and the robot holds its pose until `swimmer robot resume` or `swimmer robot stop`; this one need not wait.",
                )
            }),
            Self::PauseDetached => robot
                .pause(true)
                .and_then(|()| done(robot, PAUSED_DETACHED)),
            Self::Resume => robot.resume().and_then(|()| done(robot, "Resumed.")),
            Self::Status => RobotState::of(robot).map(|doing| Relayed::of(&doing)),
            Self::Introduce => Introduction::of(robot).map(|introduction| Relayed::data(&introduction)),
            Self::News => Ok(Relayed::data(&LinkReport::of(robot))),
        };
        answered.unwrap_or_else(|error| Relayed::refused(error.to_string()))
    }
}

/// Reason for a missing reply of the holder of a port.
#[derive(Debug)]
pub(in super::super) enum Unanswered {
    /// It did, and it is no.
    Refused(Failure),
    /// It lives, has the port, and says nothing.
    Hangs,
}

/// Reply over the socket: for people and for scripts, or the reason of a failure.
#[derive(Debug, Serialize, Deserialize)]
pub(in super::super) struct Relayed {
    pub(super) done: bool,
    pub(super) text: String,
    pub(super) answer: Value,
}

impl Relayed {
    /// An answer, to be sent.
    pub(in super::super) fn of(answer: &(impl Serialize + fmt::Display)) -> Self {
        Self {
            done: true,
            text: answer.to_string(),
            answer: serde_json::to_value(answer).unwrap_or(Value::Null),
        }
    }

    /// No, and why.
    pub(in super::super) fn refused(reason: String) -> Self {
        Self {
            done: false,
            text: reason,
            answer: Value::Null,
        }
    }

    /// An answer that only a program reads.
    fn data(answer: &impl Serialize) -> Self {
        Self {
            done: true,
            text: String::new(),
            answer: serde_json::to_value(answer).unwrap_or(Value::Null),
        }
    }

    /// Contents of the reply.
    ///
    /// # Errors
    /// [`Failure::Tried`] if it has another form: another version of this program has the port.
    pub(in super::super) fn read<T: DeserializeOwned>(self) -> Outcome<T> {
        serde_json::from_value(self.answer).map_err(|error| {
            Failure::Tried(format!(
                "the program that holds the port sent an unexpected reply ({error}); is it of another version? End it and try again"
            ))
        })
    }

    /// The state that the robot is in, by the answer.
    pub(in super::super) fn state(&self) -> &str {
        self.answer
            .get("state")
            .and_then(Value::as_str)
            .unwrap_or_default()
    }

    /// The holder's output, to be printed by this process.
    pub(in super::super) fn into_output(self) -> RelayedOutput {
        RelayedOutput {
            answer: self.answer,
            text: self.text,
        }
    }
}

/// Output of a request that another process has served.
#[derive(Debug, Serialize)]
pub(in super::super) struct RelayedOutput {
    #[serde(flatten)]
    answer: Value,
    #[serde(skip)]
    text: String,
}

impl fmt::Display for RelayedOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
