//! Agreement of gait and robot on the passive joint: a joint that the gait leaves to a spring gets no pulses, and a gait of two
//! servos needs both.

use host_link::LinkError;
use link_protocol::{Joint, Refusal};

use super::access::RobotConnection;
use super::servo::name_of;
use crate::failure::{Failure, Outcome};
use crate::output::aside;

/// Sets the robot's passive joint to that of a gait, which gives the servos less to do and never more. With `force`, a robot that
/// differs is left as it is.
///
/// # Errors
/// [`Failure::Tried`] if robot and gait differ otherwise, and the link's.
pub(super) fn agree(
    line: &mut RobotConnection,
    gait: &str,
    passive: Option<Joint>,
    force: bool,
) -> Outcome {
    let held = line.robot.status()?.flags.passive();
    match (passive, held) {
        (Some(joint), None) => declare(line, gait, joint, force),
        _ => match refusal(gait, passive, held) {
            Some(reason) if !force => Err(Failure::Tried(reason)),
            _ => Ok(()),
        },
    }
}

/// Reason why a robot whose passive joint is `held` cannot play a gait. Returns `None` if it can, or becomes able to by a setting
/// that needs nobody at the robot.
pub(super) fn refusal(gait: &str, passive: Option<Joint>, held: Option<Joint>) -> Option<String> {
    let held = held.filter(|held| passive != Some(*held))?;
    let has = name_of(held);
    Some(match passive {
        None => format!(
            "the {has} joint of this robot is passive and gets no pulses, and {gait} drives both joints; if it has its servo again, \
             run `swimmer robot servo {has} --driven`, or upload anyway with --force"
        ),
        Some(joint) => {
            let wants = name_of(joint);
            format!(
                "{gait} leaves the {wants} joint to a spring, and the passive joint of this robot is the {has} one; name the right joint \
                 by `swimmer robot servo {wants} --passive`, or upload anyway with --force"
            )
        }
    })
}

fn declare(line: &mut RobotConnection, gait: &str, joint: Joint, force: bool) -> Outcome {
    let name = name_of(joint);
    match line.robot.set_passive(Some(joint)) {
        Ok(()) => {
            aside(&format!(
                "note: {gait} leaves the {name} joint to a spring: from now on the robot sends no pulses there, whatever it plays; \
                 `swimmer robot servo {name} --driven` ends that"
            ));
            Ok(())
        }
        // Firmware from before this request drives both joints.
        Err(LinkError::Refused {
            refusal: Refusal::NotUnderstood,
            ..
        }) if force => {
            aside(&format!(
                "note: the robot's firmware is too old to leave the {name} joint without pulses: unplug its servo"
            ));
            Ok(())
        }
        Err(LinkError::Refused {
            refusal: Refusal::NotUnderstood,
            ..
        }) => Err(Failure::Tried(format!(
            "{gait} leaves the {name} joint to a spring, and the robot's firmware is too old to send it no pulses; update it \
             (`swimmer robot flash`), or unplug that servo and upload with --force"
        ))),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gait_needs_the_joints_that_it_drives() {
        let (front, back) = (Some(Joint::Front), Some(Joint::Back));
        for (passive, held) in [(None, None), (back, None), (back, back)] {
            assert_eq!(refusal("a.gait", passive, held), None);
        }
        let both = refusal("a.gait", None, back).unwrap();
        assert!(both.contains("back --driven"), "{both}");
        let other = refusal("a.gait", back, front).unwrap();
        assert!(other.contains("back --passive"), "{other}");
    }
}
