//! What a laboratory does once with a new robot: tell it its servos and its body, over the link like anybody.

use host_link::port::{VirtualPort, WireSpeed};
use host_link::{LinkError, Robot};
use link_protocol::Joint;
use twin::TwinConfig;

use crate::EmulatedRobot;

/// Greets a robot that was just switched on and tells it what a twin of `config` is made with: the maps of its servos and
/// its configuration. The robot keeps both.
///
/// # Errors
/// [`LinkError::Refused`] where the firmware's own limits are tighter, and the link's.
pub fn commission(
    robot: EmulatedRobot,
    config: &TwinConfig,
) -> Result<VirtualPort<EmulatedRobot>, LinkError> {
    let port = VirtualPort::new(robot, WireSpeed::robot());
    // A seed that nobody who greets it afterwards is likely to use: two sessions of one seed would be taken for one.
    let mut robot = Robot::connect(port, !config.seed)?;
    for (joint, servo) in [Joint::Front, Joint::Back].into_iter().zip(config.servos) {
        robot.set_servo(joint, servo)?;
    }
    robot.configure(config.belief)?;
    Ok(robot.into_port())
}
