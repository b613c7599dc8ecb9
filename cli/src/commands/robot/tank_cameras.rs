//! Cameras over a fresh virtual robot: their frames pass from the robot's device to a queue that the command reads.

use std::collections::VecDeque;
use std::error::Error;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use host_link::port::Device;
use pose_source::{Frame, twin_frame};
use twin::VirtualRobot;

use crate::interrupt::locked;

/// Frames that wait to be read: ten seconds. Older ones are dropped.
const MOST: usize = 1000;

/// Queue of frames. Clones share it.
#[derive(Debug, Clone, Default)]
pub(super) struct TankCameras(Arc<Mutex<VecDeque<Frame>>>);

impl TankCameras {
    /// Frames since the last call. Their times are on the port's clock.
    pub(super) fn take(&self) -> VecDeque<Frame> {
        std::mem::take(&mut *locked(&self.0))
    }

    fn push(&self, frames: impl Iterator<Item = Frame>) {
        let mut queue = locked(&self.0);
        queue.extend(frames);
        let surplus = queue.len().saturating_sub(MOST);
        queue.drain(..surplus);
    }

    /// Switches the cameras over a robot on. Their frames come into this queue.
    pub(super) fn film(&self, mut robot: Box<dyn VirtualRobot>) -> Filmed {
        robot.world_mut().watch();
        Filmed {
            robot,
            cameras: self.clone(),
        }
    }
}

/// A virtual robot whose cameras are on.
pub(super) struct Filmed {
    robot: Box<dyn VirtualRobot>,
    cameras: TankCameras,
}

impl Device for Filmed {
    fn advance(&mut self, to: Duration) {
        self.robot.advance(to);
        let frames = self.robot.world_mut().take_frames();
        self.cameras
            .push(frames.map(|(stamp, seen)| twin_frame(&seen, stamp)));
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.robot.receive(bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        self.robot.transmit(room, out);
    }

    fn expect_quiet(&mut self, until: Duration, travel: Duration) {
        self.robot.expect_quiet(until, travel);
    }

    fn failure(&self) -> Option<&(dyn Error + Send + Sync + 'static)> {
        self.robot.failure()
    }
}
