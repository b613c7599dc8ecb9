//! Detection of swimmers that no gait can move.
//!
//! With isotropic drag the centre of drag is at rest for any motion of the joints, and a gait without net rotation has no net
//! displacement. (The swimmer can still turn, like a falling cat.) A multiplier that makes the height vanish at one shape then makes
//! it vanish at all shapes, and its level curves consist of rounding errors. Every search therefore compares the slope of the height
//! with its rounding first.

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Model;

use crate::momentum::Momentum;

/// Least slope of the height, relative to the largest terms of its sum, for which a search is meaningful.
///
/// The terms have rounding errors of a few 1e-16, so a slope of this size, and the direction of singular arcs, has about six digits.
/// The searches integrate these arcs to 1e-13 and require λ₄ = 0 to 1e-10 \[L\]; with fewer digits their steps would follow the
/// rounding.
const LEAST: f64 = 2e-10;
/// Number of shapes along each joint.
const LOOKS: usize = 8;

/// Swimmer that no gait moves.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no gait moves this swimmer: its {} the same in all directions ({}what gaits could gain is {contrast:.1e} \
     of the terms that it is a difference of, mere rounding or near it); give {}",
    if chi.is_some() { "drag is" } else { "masses are" },
    chi.map_or(String::new(), |chi| format!("chi = {chi}, and ")),
    if chi.is_some() { "a chi farther from 1" } else { "a smaller aspect" }
)]
pub struct Immobile {
    /// χ; `None` in a perfect fluid.
    pub chi: Option<f64>,
    /// Largest slope of the height within the bounds, relative to the largest terms of its sum.
    pub contrast: f64,
}

/// Refuses a swimmer whose height within the bounds consists of rounding errors.
pub(crate) fn refuse_immobile(model: &Model<f64>, bounds: &Bounds) -> Result<(), Immobile> {
    let contrast = contrast(model, bounds);
    if contrast > LEAST {
        return Ok(());
    }
    Err(Immobile {
        chi: model.swimmer().is_viscous().then_some(model.swimmer().chi),
        contrast,
    })
}

/// Largest slope of the height within the bounds, relative to the largest terms of its sum. The multipliers make the height vanish at
/// the shape, times the θ row of the curvature to keep them finite.
fn contrast(model: &Model<f64>, bounds: &Bounds) -> f64 {
    let reach = bounds.max_angle.unwrap_or(std::f64::consts::PI);
    let reach = reach.min(std::f64::consts::PI);
    let place = |look: usize| reach * ((2 * look + 1) as f64 / LOOKS as f64 - 1.0);
    let (mut slope, mut terms) = (0.0_f64, 0.0_f64);
    for (i, j) in (0..LOOKS).flat_map(|i| (0..LOOKS).map(move |j| (i, j))) {
        let second = model.second_derivatives(&Vector2::new(place(i), place(j)));
        let first = &second.first;
        let curvature = first.curvature();
        for p in [Vector2::x(), Vector2::y()] {
            let momentum = Momentum {
                p: p * curvature.z,
                c: -p.dot(&curvature.xy()),
            };
            slope = slope.max(momentum.height(&second, &[0.0; 3]).gradient.norm());
        }
        let connection = first.connection.norm();
        let rates: f64 = first.d_connection.iter().map(nalgebra::Matrix::norm).sum();
        let bends: f64 = second
            .d2_connection
            .iter()
            .map(nalgebra::Matrix::norm)
            .sum();
        let of_curvature = rates + connection * connection;
        terms = terms.max(of_curvature * (bends + connection * (rates + of_curvature)));
    }
    slope / terms
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    fn of(swimmer: Swimmer<f64>, max_angle: f64) -> f64 {
        let bounds = Bounds::within(max_angle);
        contrast(&Model::new(&swimmer.of_unit_length()).unwrap(), &bounds)
    }

    /// Only rounding is below the limit, with and without a sphere; the contrast grows as χ − 1.
    #[test]
    fn the_contrast_is_that_of_the_drag() {
        for base in [Swimmer::purcell(), Swimmer::robot()] {
            for max_angle in [0.05, 1.2, 2.8] {
                let at = |chi: f64| of(Swimmer { chi, ..base }, max_angle);
                let rounding = at(1.0);
                println!(
                    "{max_angle} {rounding:e} {:e} {:e} {:e}",
                    at(1.0 + 1e-10),
                    at(1.001),
                    at(2.0)
                );
                assert!(rounding < 1e-14, "{rounding:e}");
                assert!(at(1.0 + 1e-10) < LEAST && at(1.0 - 1e-10) < LEAST);
                assert!((at(1.002) / at(1.001) - 2.0).abs() < 0.02);
                assert!(at(1.001) > 100.0 * LEAST && at(2.0) > 1e5 * LEAST);
            }
        }
    }
}
