//! Settings of the robot: geometry and drag for the on-board pose, limits, servo maps and pulse ranges.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// One of the two joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Joint {
    /// φ₁, between middle and front link.
    Front,
    /// φ₂, between middle and back link.
    Back,
}

impl Joint {
    /// 0 for φ₁, 1 for φ₂.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Parametrisation of the tangential drag coefficient `c_t`: the three forms of the model, SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum TangentialDrag {
    /// Common `c_t = 2πμ / value`; the value is ln(l/a).
    LogAspect(f32),
    /// Per link `c_t = 2πμ / ln(l / value)`; the value is the half thickness a in metres.
    HalfThickness(f32),
    /// Common `c_t = value · μ`.
    OverViscosity(f32),
}

/// Geometry and drag for the on-board pose, and limits. It may tighten the firmware's limits, never loosen them. Limits with
/// which a ramp to neutral takes more than one second (`max_angle / max_rate > 1 s`) are refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Configuration {
    /// Length of the middle link l₀, m.
    pub middle_m: f32,
    /// Length of the front link l₁, m.
    pub front_m: f32,
    /// Length of the back link l₂, m.
    pub back_m: f32,
    /// Ratio of normal to tangential drag χ = `c_n/c_t`.
    pub chi: f32,
    /// Tangential drag.
    pub tangential_drag: TangentialDrag,
    /// Radius of the sphere on the middle link, m; 0 for no sphere.
    pub sphere_radius_m: f32,
    /// Largest |φ|, rad.
    pub max_angle: f32,
    /// Largest |dφ/dt|, rad/s.
    pub max_rate: f32,
}

/// Map of one servo from joint angle to pulse: `pulse = centre ± (angle + trim) / slope`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ServoSettings {
    /// Pulse of the straight joint, ns.
    pub centre_ns: u32,
    /// Angle per pulse, rad/µs, positive.
    pub slope_rad_per_us: f32,
    /// The angle grows as the pulse gets shorter.
    pub reversed: bool,
    /// Added to every angle, in units of 1e-4 rad; set by [`crate::Request::Trim`].
    pub trim: i16,
}

/// Pulse range within a servo's end stops. The robot sends no pulse outside it. It tightens the firmware's own window, never
/// loosens it; gaits with joint angles beyond it are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct PulseRange {
    /// Shortest pulse, ns.
    pub shortest_ns: u32,
    /// Longest pulse, ns.
    pub longest_ns: u32,
}

/// Hash of the settings on which a host's checks of a play depend: CRC-32C over the postcard bytes of the configuration, the
/// maps of front and back servo and their pulse ranges, in this order, and of the passive joint if there is one.
/// [`crate::Request::PulseRange`] reports the range in force, which is the firmware's window if no range is set.
pub fn settings_crc32(
    configuration: &Configuration,
    servos: &[ServoSettings; 2],
    ranges: &[PulseRange; 2],
    passive: Option<Joint>,
) -> u32 {
    let mut bytes = [0; 128];
    // At most 33 bytes, twice 13, twice 10 and 1.
    let mut len = postcard::to_slice(&(configuration, servos, ranges), &mut bytes)
        .map_or(0, |written| written.len());
    // The hash of a robot with two servos is that of earlier firmware.
    if let (Some(joint), Some(last)) = (passive, bytes.get_mut(len)) {
        *last = joint as u8;
        len += 1;
    }
    crate::crc32c(&bytes[..len])
}
