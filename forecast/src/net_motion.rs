//! Net motion of a cycle, as the JSON documents report it.

use serde::Serialize;
use swimmer_model::Stroke;

/// The net motion of one cycle, what it sways and turns in between, and its efficiency.
///
/// ```
/// use forecast::NetMotion;
/// use swimmer_model::{Circle, Model, Swimmer, Tolerance, swim};
///
/// let model = Model::new(&Swimmer::<f64>::robot())?;
/// let net = NetMotion::from(&swim(&model, &Circle { amplitude: 1.2 }, &Tolerance::default()));
/// assert!((net.displacement_m - net.displacement_over_length * 0.345).abs() < 1e-12);
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NetMotion {
    /// X/L.
    pub displacement_over_length: f64,
    /// X \[m\].
    pub displacement_m: f64,
    /// Y/L.
    pub lateral_over_length: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// ΔY/L.
    pub delta_y_over_length: f64,
    /// Δθ \[rad\].
    pub delta_theta_rad: f64,
    /// Efficiency in the gait's own time parametrisation.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub efficiency: f64,
    /// At constant power.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub efficiency_constant_power: f64,
}

impl From<&Stroke<f64>> for NetMotion {
    fn from(stroke: &Stroke<f64>) -> Self {
        let over_length = stroke.displacement_over_length();
        Self {
            displacement_over_length: over_length.x,
            displacement_m: stroke.displacement.x,
            lateral_over_length: over_length.y,
            rotation_rad: stroke.rotation,
            delta_y_over_length: stroke.delta_y / stroke.total_length,
            delta_theta_rad: stroke.delta_theta,
            efficiency: stroke.efficiency(),
            efficiency_constant_power: stroke.efficiency_constant_power(),
        }
    }
}
