//! Whether gaits move a swimmer at all.
//!
//! Where drag is the same in all directions nothing pushes the swimmer along: its centre of drag rests whatever the joints do,
//! and a gait without net rotation ends where it began. (It can still turn, as a falling cat does.) Then a multiplier that
//! makes the height vanish at one shape makes it vanish at all; level curves, and all that is found by following them, are
//! made of rounding. So the searches ask first how far the height's slope rises above its own rounding.

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Model;

use crate::momentum::Momentum;

/// The height's slope, over the largest terms that it is summed of, below which no search makes sense.
///
/// The terms are rounded to a few units of 1e-16, so a slope of this size is known to about six digits, and with it the direction
/// of singular arcs. The searches integrate these arcs to 1e-13 and ask for λ₄ = 0 to 1e-10 \[L\]: with fewer digits their steps
/// only follow the rounding.
const LEAST: f64 = 2e-10;
/// Shapes looked at along each joint.
const LOOKS: usize = 8;

/// A swimmer that no gait moves.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no gait moves this swimmer: its drag is the same in all directions (chi = {chi}, and what gaits could gain is {contrast:.1e} \
     of the terms that it is a difference of, mere rounding or near it); give a chi farther from 1"
)]
pub struct Immobile {
    /// χ.
    pub chi: f64,
    /// The largest slope of the height within the bounds, over the largest terms that it is summed of.
    pub contrast: f64,
}

/// Refuses a swimmer whose height is nothing but rounding within the bounds.
pub(crate) fn refuse_immobile(model: &Model<f64>, bounds: &Bounds) -> Result<(), Immobile> {
    let contrast = contrast(model, bounds);
    if contrast > LEAST {
        return Ok(());
    }
    Err(Immobile {
        chi: model.swimmer().chi,
        contrast,
    })
}

/// The largest slope of the height within the bounds over the largest terms that it is summed of. The multipliers are those that
/// make the height vanish at the shape, times the θ row of the curvature, so that none is infinite.
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

    /// Rounding, and nothing but rounding, is below the limit, with and without a sphere; the rest grows as χ − 1.
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
