//! First set-up of a new robot: its servos and its body, over the link, with the bench jumper closed for a moment.

use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use host_link::port::{VirtualPort, WireSpeed};
use host_link::{LinkError, Robot};
use link_protocol::Joint;
use twin::TwinConfig;

use crate::EmulatedRobot;

/// Connects to a robot that was just switched on and sends it the settings of a twin of `config`: the maps of its servos and
/// its configuration. The robot stores both.
///
/// If the line counts as a radio ([`TwinConfig::is_by_radio`]), the robot is then switched off and on, which ends the two minutes
/// in which the closed jumper shows that somebody is at the robot.
///
/// # Errors
/// [`LinkError::Refused`] if the firmware's own limits are tighter, and the link's.
pub fn commission(
    mut robot: EmulatedRobot,
    config: &TwinConfig,
) -> Result<VirtualPort<EmulatedRobot>, LinkError> {
    let doing = "closing the bench jumper";
    let failed = |error| LinkError::Port {
        doing,
        source: io::Error::other(error),
    };
    robot.board_mut().set_jumper(true).map_err(failed)?;
    let port = VirtualPort::new(robot, WireSpeed::robot());
    // A seed that nobody who greets it afterwards is likely to use: two sessions of one seed would be taken for one.
    let mut robot = Robot::connect(port, !config.seed)?;
    let seen = Duration::from_millis(300);
    robot.listen(seen, |_| ControlFlow::Continue(()))?;
    let board = robot.port_mut().device_mut().board_mut();
    board.set_jumper(false).map_err(failed)?;
    for (joint, servo) in [Joint::Front, Joint::Back].into_iter().zip(config.servos) {
        robot.set_servo(joint, servo)?;
    }
    robot.configure(config.belief)?;
    if config.is_by_radio() {
        robot.wait_until_stored("storing the settings")?;
        let board = robot.port_mut().device_mut().board_mut();
        board.power_cycle().map_err(|error| LinkError::Port {
            doing: "switching the robot off and on",
            source: io::Error::other(error),
        })?;
    }
    Ok(robot.into_port())
}
