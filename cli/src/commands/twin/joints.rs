//! Joint angles as an observer at the bench sees them, reported when the joints have come to rest at other angles.

use std::time::Duration;

use twin::World;

/// Duration of standing still that counts as rest.
const AT_REST: Duration = Duration::from_millis(200);
/// Largest change of an angle that is not visible, rad.
const UNSEEN: f64 = 1e-3;

/// Observed joints.
#[derive(Debug, Default)]
pub(super) struct Joints {
    /// Present angles, and the time of the last change.
    now: [f64; 2],
    since: Duration,
    /// Angles of the last report.
    reported: Option<[f64; 2]>,
}

impl Joints {
    /// Observes the joints. Returns a line if they have come to rest at other angles.
    pub(super) fn look(&mut self, world: &World) -> Option<String> {
        let (at, angles) = (world.now(), world.angles());
        if apart(angles, self.now) {
            (self.now, self.since) = (angles, at);
        }
        let rests = at.saturating_sub(self.since) >= AT_REST;
        if !rests
            || self
                .reported
                .is_some_and(|reported| !apart(reported, angles))
        {
            return None;
        }
        self.reported = Some(angles);
        let [front, back] = angles.map(|angle| tidy(angle.to_degrees()));
        Some(format!(
            "{:9.2} s  joints  front {front:+.1}°  back {back:+.1}°",
            at.as_secs_f64()
        ))
    }
}

fn apart(one: [f64; 2], other: [f64; 2]) -> bool {
    one.iter()
        .zip(other)
        .any(|(one, other)| (one - other).abs() > UNSEEN)
}

/// Without a minus before zero.
fn tidy(degrees: f64) -> f64 {
    (degrees * 10.0).round() / 10.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use gait_player::servo::ServoMap;
    use swimmer_files::SwimmerFile;
    use twin::TwinConfig;

    #[test]
    fn a_line_for_each_rest() {
        let file = SwimmerFile::preset("robot").unwrap();
        let mut world = World::new(&TwinConfig::new(&file, 1).with_ideal_servos()).unwrap();
        let mut joints = Joints::default();
        let mut lines = Vec::new();
        for tick in 1..=100_u64 {
            if tick == 30 {
                let map = ServoMap::ROBOT;
                world.set_pulses(Some([map.pulse_ns(0.5), map.pulse_ns(-0.25)]));
            }
            world.advance(Duration::from_millis(20 * tick));
            lines.extend(joints.look(&world));
        }
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(lines[0].ends_with("front +0.0°  back +0.0°"), "{lines:?}");
        assert!(lines[1].ends_with("front +28.6°  back -14.3°"), "{lines:?}");
    }
}
