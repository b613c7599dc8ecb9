//! X(ε), ΔY(ε), Δθ(ε) of circles, as in the paper's figure: what the model does between the amplitudes that were measured.

use swimmer_files::{AnyGait, SwimmerFile};

use crate::cycles::Projection;
use crate::prediction::{JointPath, PredictedCycle};

/// Spacing of points in degrees.
const STEP_DEG: u32 = 2;
/// The largest circle \[deg\].
const LARGEST_DEG: u32 = 120;

/// One circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// The amplitude ε \[rad\].
    pub amplitude_rad: f64,
    /// Cycle by the model.
    pub cycle: PredictedCycle,
}

/// Circles up to 120°, as far as the servos reach.
pub fn circle_curve(file: &SwimmerFile, period_s: f64) -> Vec<CurvePoint> {
    let projection = Projection::new();
    let point = |step: u32| {
        let amplitude_rad = f64::from(step * STEP_DEG).to_radians();
        let path = JointPath::new(
            &AnyGait::circle(amplitude_rad),
            file.servo.as_ref(),
            period_s,
        )
        .ok()?;
        let cycle = path.predict(&file.swimmer, &projection).ok()?.0;
        Some(CurvePoint {
            amplitude_rad,
            cycle,
        })
    };
    (1..=LARGEST_DEG / STEP_DEG).filter_map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::ServoFile;

    #[test]
    fn a_curve_ends_where_the_servos_do() {
        let mut file = SwimmerFile::preset("robot").unwrap();
        assert_eq!(circle_curve(&file, 10.0).len(), 60);
        file.servo = Some(ServoFile {
            max_angle: 1.0,
            ..ServoFile::default()
        });
        let curve = circle_curve(&file, 10.0);
        assert_eq!(curve.len(), 28);
        assert!(
            curve
                .windows(2)
                .all(|w| w[1].cycle.delta_theta_rad > w[0].cycle.delta_theta_rad)
        );
    }
}
