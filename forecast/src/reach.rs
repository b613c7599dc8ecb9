//! Largest angles of a gait.

use swimmer_model::Gait;

use crate::timing::cuts;

/// Place at which a gait turns a joint furthest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The fraction of the period.
    pub u: f64,
    /// The joint: 0 for φ₁, 1 for φ₂.
    pub joint: usize,
    /// Its angle there, signed \[rad\].
    pub angle: f64,
}

/// Steps of the golden section that refines the best look: 1e-9 of two looks.
const REFINEMENTS: usize = 44;

/// The largest |φᵢ| of a gait, with its place: the best of 2048 looks and of all ends of pieces, refined by golden section.
///
/// ```
/// use swimmer_files::AnyGait;
///
/// let reach = forecast::reach(&AnyGait::circle(1.2));
/// assert!((reach.angle.abs() - 1.2).abs() < 1e-6);
/// ```
pub fn reach<G: Gait<f64> + ?Sized>(gait: &G) -> Reach {
    let mut best = at(gait, 0.0);
    let mut width = 0.0;
    for [start, end] in cuts(gait).array_windows() {
        let there = at(gait, *start);
        if there.angle.abs() > best.angle.abs() {
            (best, width) = (there, end - start);
        }
    }
    let joint = best.joint;
    let angle = |u: f64| gait.at(u).phi[joint];
    let (mut low, mut high) = (best.u - width, best.u + width);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..REFINEMENTS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if angle(a).abs() > angle(b).abs() {
            high = b;
        } else {
            low = a;
        }
    }
    let u = 0.5 * (low + high);
    // A plateau or a corner is as well served by the look itself.
    if angle(u).abs() > best.angle.abs() {
        best = Reach {
            u: u - u.floor(),
            joint,
            angle: angle(u),
        };
    }
    best
}

fn at<G: Gait<f64> + ?Sized>(gait: &G, u: f64) -> Reach {
    let phi = gait.at(u).phi;
    let joint = phi.iamax();
    Reach {
        u,
        joint,
        angle: phi[joint],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::AnyGait;
    use swimmer_model::SymmetricFourier;

    #[test]
    fn a_circle_reaches_its_radius() {
        let found = reach(&AnyGait::circle(1.3));
        assert!((found.angle.abs() - 1.3).abs() < 1e-12, "{found:?}");
        let square = reach(&AnyGait::square(1.3));
        assert!((square.angle.abs() - 1.3).abs() < 1e-12, "{square:?}");
    }

    #[test]
    fn a_maximum_between_looks_is_found() {
        let gait = SymmetricFourier {
            coefficients: [[1.0, 0.7], [0.21, -0.17], [0.03, 0.05]],
        };
        let found = reach(&gait);
        let dense = (0..1_000_000)
            .map(|i| gait.at(f64::from(i) * 1e-6).phi.amax())
            .fold(0.0, f64::max);
        assert!((found.angle.abs() - dense).abs() < 1e-11 && found.angle.abs() >= dense - 1e-14);
        let there = gait.at(found.u).phi;
        assert!((there[found.joint] - found.angle).abs() < 1e-12);
    }
}
