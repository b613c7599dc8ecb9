//! Frames seen on a port, as the link log keeps them.

use host_link::port::{Direction, TracedFrame};
use swimmer_files::{LinkFrame, LinkLogError};

use crate::failure::Failure;

/// A frame as it crossed the port.
pub(crate) fn link_frame(frame: &TracedFrame<'_>) -> LinkFrame {
    LinkFrame {
        direction: match frame.direction {
            Direction::ToRobot => swimmer_files::Direction::ToRobot,
            Direction::ToHost => swimmer_files::Direction::FromRobot,
        },
        host_time_ns: u64::try_from(frame.at.as_nanos()).unwrap_or(u64::MAX),
        robot_time_us: None,
        bytes: frame.bytes.to_vec(),
    }
}

impl From<LinkLogError> for Failure {
    fn from(error: LinkLogError) -> Self {
        match error {
            LinkLogError::File(error) => error.into(),
            other => Self::tried(&other),
        }
    }
}
