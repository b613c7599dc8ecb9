//! Servos that differ from the robot's map: mirrored, off-centre, of another slope. A set-up at the bench must find the
//! differences.

use std::str::FromStr;

use gait_player::servo::ServoMap;

use crate::commands::robot::servo::{centre_us, nanoseconds};

/// Deviations of one servo from those as built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ServoDeviation {
    joint: usize,
    reversed: Option<bool>,
    centre_ns: Option<u32>,
    slope_rad_per_us: Option<f32>,
}

impl ServoDeviation {
    /// Builds it in.
    pub(super) fn fit(&self, shafts: &mut [ServoMap; 2]) {
        let Some(shaft) = shafts.get_mut(self.joint) else {
            return;
        };
        shaft.reversed = self.reversed.unwrap_or(shaft.reversed);
        shaft.centre_ns = self.centre_ns.unwrap_or(shaft.centre_ns);
        shaft.slope_rad_per_us = self.slope_rad_per_us.unwrap_or(shaft.slope_rad_per_us);
    }
}

/// A servo on the command line.
pub(super) fn servo(text: &str) -> Result<ServoDeviation, String> {
    let advice = || {
        "write a joint and what is odd of its servo: front:sign=-,centre=1512,slope=0.0287"
            .to_owned()
    };
    let (joint, oddities) = text.split_once(':').ok_or_else(advice)?;
    let mut servo = ServoDeviation {
        joint: match joint.trim() {
            "front" => 0,
            "back" => 1,
            _ => return Err(advice()),
        },
        reversed: None,
        centre_ns: None,
        slope_rad_per_us: None,
    };
    for oddity in oddities.split(',') {
        let (key, value) = oddity.split_once('=').ok_or_else(advice)?;
        match (key.trim(), value.trim()) {
            ("sign", "-") => servo.reversed = Some(true),
            ("sign", "+") => servo.reversed = Some(false),
            ("centre", us) => servo.centre_ns = Some(nanoseconds(centre_us(us)?)),
            ("slope", slope) => {
                let slope = f32::from_str(slope).ok();
                let turns = slope.filter(|slope| (1e-4..1.0).contains(slope));
                servo.slope_rad_per_us =
                    Some(turns.ok_or("a slope is an angle in rad a µs, as 0.0274")?);
            }
            _ => return Err(advice()),
        }
    }
    Ok(servo)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_servos_are_read_and_built_in() {
        let mut shafts = [ServoMap::ROBOT; 2];
        servo("front:sign=-,centre=1512").unwrap().fit(&mut shafts);
        servo("back:slope=0.0287").unwrap().fit(&mut shafts);
        assert!(shafts[0].reversed && shafts[0].centre_ns == 1_512_000);
        assert!(!shafts[1].reversed && shafts[1].centre_ns == 1_500_000);
        assert!((shafts[1].slope_rad_per_us - 0.0287).abs() < 1e-7);
        for text in [
            "",
            "front",
            "front:",
            "middle:sign=-",
            "front:sign=x",
            "front:centre=1",
            "back:slope=-1",
        ] {
            assert!(servo(text).is_err(), "{text}");
        }
    }
}
