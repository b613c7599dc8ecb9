//! The digital twin's cameras as a source.

use std::time::Duration;

use twin::{Twin, TwinConfig};

use crate::stream::{Outlet, Pace};
use crate::{Frame, Marker, RigidBody, SourceError};

/// Names of the twin's reflectors.
pub const TWIN_REFLECTORS: [&str; 2] = ["Front", "Back"];
/// Name of the body that carries them.
pub const TWIN_BODY: &str = "robot";

/// The frame that the twin's cameras took at `stamp`: named reflectors, unlabeled ghosts, and the body while both reflectors are seen.
///
/// ```
/// use std::time::Duration;
/// use swimmer_model::Pose;
/// use twin::{Camera, CameraConfig};
///
/// let seen = Camera::new(CameraConfig::perfect(), 0.1, 1, 0).expose(&Pose::new(0.2, 0.3, 0.5));
/// let frame = pose_source::twin_frame(&seen, Duration::from_millis(10));
/// assert_eq!(frame.stamp_s, 0.01);
/// assert!((frame.bodies[0].position[0] - 0.2).abs() < 1e-12 && (frame.bodies[0].heading_rad() - 0.5).abs() < 1e-12);
/// ```
pub fn twin_frame(seen: &twin::Frame, stamp: Duration) -> Frame {
    let place = |point: &twin::Point| {
        // Motive's axes: Y up.
        point.map(|source| crate::Mapping::Y_UP.position(source))
    };
    let mut markers = Vec::with_capacity(seen.len());
    for (index, point) in seen.iter().enumerate() {
        if let Some([x_m, y_m, z_m]) = place(point) {
            let name = TWIN_REFLECTORS.get(index);
            markers.push(Marker {
                name: name.map(ToString::to_string),
                id: i64::try_from(index + 1).ok(),
                x_m,
                y_m,
                z_m,
            });
        }
    }
    let body = match seen.each_ref().map(place) {
        [Some(front), Some(back), ..] => Some(body_of(front, back)),
        _ => None,
    };
    let stamp_s = stamp.as_secs_f64();
    Frame {
        stamp_s,
        received_s: stamp_s,
        latency_s: Some(0.0),
        markers,
        bodies: body.into_iter().collect(),
    }
}

fn body_of(front: [f64; 3], back: [f64; 3]) -> RigidBody {
    let half = (front[1] - back[1]).atan2(front[0] - back[0]) / 2.0;
    let mut position = [0.0; 3];
    for ((place, front), back) in position.iter_mut().zip(front).zip(back) {
        *place = f64::midpoint(front, back);
    }
    RigidBody {
        id: 1,
        name: Some(TWIN_BODY.to_owned()),
        position,
        quaternion: [0.0, 0.0, half.sin(), half.cos()],
    }
}

/// Streams the frames of a twin without a host, until the stream is stopped.
///
/// # Errors
/// [`SourceError::Twin`]: the lengths and drags are no swimmer.
pub fn watch_twin(outlet: &Outlet, config: TwinConfig, pace: Pace) -> Result<(), SourceError> {
    /// Frames are 10 ms apart.
    const STEP: Duration = Duration::from_millis(10);
    let mut twin = Twin::new(config).map_err(|error| SourceError::Twin(error.to_string()))?;
    twin.watch();
    outlet.describe("the digital twin, at rest".to_owned());
    while !outlet.is_stopped() {
        let next = twin.now() + STEP;
        if pace == Pace::Recorded && !outlet.wait_until(next.as_secs_f64()) {
            break;
        }
        twin.advance(next);
        for (stamp, seen) in twin.take_frames() {
            let mut frame = twin_frame(&seen, stamp);
            if pace == Pace::Recorded {
                frame.received_s = outlet.now_s();
            }
            outlet.send(frame);
        }
    }
    Ok(())
}
