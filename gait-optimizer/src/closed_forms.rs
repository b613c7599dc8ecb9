//! Closed forms of the paper's Appendix B, corrected. They show that an efficiency gait is smooth at its ends.
//!
//! With a = W₁₁ and b = 2 W₁₂ they are 2a + b on φ₁ = φ₂ and 2a − b on φ₁ = −φ₂, for equal side links and one `c_t` for all links. In
//! D₂ the paper prints `8z³` instead of `8r³` and omits a factor χ before the last bracket.

use swimmer_model::Swimmer;

/// 2a + b at (φ, φ), over μ (equation B4).
pub fn along_the_symmetric_shapes(swimmer: &Swimmer<f64>, phi: f64) -> f64 {
    let (l0, l1, chi) = (swimmer.links.middle, swimmer.links.front, swimmer.chi);
    let drag = swimmer.side_drag();
    let nu = std::f64::consts::PI * swimmer.sphere_radius / drag;
    let sin2 = phi.sin().powi(2);
    let numerator = 4.0 * l1 * sin2 + 12.0 * nu + 2.0 * chi * l0 + (1.0 - sin2) * chi * l1;
    let denominator = 6.0 * l1 * sin2 + 18.0 * nu + 3.0 * chi * l0 + (1.0 - sin2) * 6.0 * chi * l1;
    chi * drag * l1.powi(3) * numerator / denominator
}

/// 2a − b at (−φ, φ), over μ (equation B9, corrected).
pub fn along_the_point_symmetric_shapes(swimmer: &Swimmer<f64>, phi: f64) -> f64 {
    let (l0, l1, chi) = (swimmer.links.middle, swimmer.links.front, swimmer.chi);
    let drag = swimmer.side_drag();
    let nu = std::f64::consts::PI * swimmer.sphere_radius.powi(3) / (drag * l0.powi(3));
    let (r, z) = (l1 / l0, phi.cos());
    let z2 = z * z;
    let numerator = 192.0 * nu + 2.0 * chi + (1.0 - z2) * 12.0 * r + 3.0 * chi * r * z2;
    let bracket = 6.0 * r * z2 + 12.0 * r * r * z + 8.0 * r.powi(3) + 1.0;
    let denominator = 96.0 * nu + (1.0 - z2) * 6.0 * r + chi * bracket;
    chi * drag * l1.powi(3) / 3.0 * numerator / denominator
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;
    use swimmer_model::Model;

    #[test]
    fn they_are_the_models() {
        for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
            let model = Model::new(&swimmer).unwrap();
            for phi in [0.1, 0.8, 1.6, 2.4, 3.1] {
                let w = model.power_matrix(&Vector2::new(phi, phi));
                let here = 2.0 * (w.m11 + w.m12) / along_the_symmetric_shapes(&swimmer, phi);
                assert!((here - 1.0).abs() < 1e-12, "{phi}: {here}");
                let w = model.power_matrix(&Vector2::new(-phi, phi));
                let here = 2.0 * (w.m11 - w.m12) / along_the_point_symmetric_shapes(&swimmer, phi);
                assert!((here - 1.0).abs() < 1e-12, "{phi}: {here}");
            }
        }
    }
}
