//! Efficiency: doubly symmetric Fourier gaits of order N, timed as parametrised.
//!
//! One gait is played to all members, so all share its timing: ξₖ = c_t L Xₖ² / Eₖ with Eₖ = ∫ Φ′ᵀWₖΦ′ du. (For a single
//! member the best timing is constant power, which the series approaches as N grows.) Gradients are exact: that of X is the
//! height along the quarter, that of E the variation of the integrand with the model's own ∂W.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::{Model, SymmetricFourier};

use super::RobustError;
use super::newton::Design;
use super::nodes::Nodes;
use super::quarter::{ArcCurve, Trajectory};
use crate::Branch;
use crate::efficiency::starts;

/// Relative gradient norm, |∇ξ̄|/ξ̄ per radian, that counts as zero.
pub(super) const FLAT: f64 = 1e-9;
const STEPS: usize = 120;
const HALVINGS: usize = 30;
/// Longest step of the coefficients \[rad\].
const LONGEST: f64 = 0.05;
const DIFFERENCE: f64 = 1e-5;
/// Curvatures of the objective smaller than this share of the largest one are raised to it.
const FLATTEST: f64 = 1e-7;

/// Fourier gaits of an order, around a start.
#[derive(Debug)]
pub(super) struct FourierFamily {
    nodes: Nodes,
    /// Φ and dΦ/dt of each coefficient's term at the nodes, t = 4u.
    basis: Vec<[Vec<Vector2<f64>>; 2]>,
    start: DVector<f64>,
}

/// Objective and gradient of one member.
struct Valued {
    xi: f64,
    gradient: DVector<f64>,
}

impl FourierFamily {
    /// The family of this order around the nominal optimum of a branch, found from circles with no other guess.
    pub(super) fn around(
        nominal: &Model<f64>,
        order: usize,
        branch: Branch,
    ) -> Result<Self, RobustError> {
        let starts = starts(nominal, branch).unwrap_or_default();
        let ellipse = starts.first().ok_or(RobustError::Structure {
            problem: "no circle leads to a gait of this branch",
        })?;
        let mut x = DVector::from_column_slice(ellipse);
        let mut family = Self::new(1);
        for order in 1..=order {
            if order > 1 {
                x = x.resize_vertically(2 * order, 0.0);
                family = Self::new(order);
            }
            x = family.solve(&x, &[(nominal, 1.0)])?;
        }
        family.start = x;
        Ok(family)
    }

    fn new(order: usize) -> Self {
        let nodes = Nodes::new(16 + 10 * order);
        // Coefficients A₁, B₁, A₂, B₂, …: (cos, 0) and (0, sin) turned by 45°.
        let term = |index: usize| {
            let rate = (2 * (index / 2) + 1) as f64 * FRAC_PI_2;
            let along = if index.is_multiple_of(2) {
                Vector2::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2)
            } else {
                Vector2::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2)
            };
            let values = |of: fn(f64) -> f64, scale: f64| -> Vec<Vector2<f64>> {
                nodes
                    .place
                    .iter()
                    .map(|t| along * (scale * of(rate * t)))
                    .collect()
            };
            if index.is_multiple_of(2) {
                [values(f64::cos, 1.0), values(f64::sin, -rate)]
            } else {
                [values(f64::sin, 1.0), values(f64::cos, rate)]
            }
        };
        Self {
            basis: (0..2 * order).map(term).collect(),
            nodes,
            start: DVector::zeros(2 * order),
        }
    }

    /// The gait of these coefficients.
    pub(super) fn gait(x: &DVector<f64>) -> SymmetricFourier<Vec<[f64; 2]>> {
        let pairs = x.as_slice().chunks_exact(2);
        SymmetricFourier {
            coefficients: pairs
                .map(|pair| {
                    [
                        pair.first().copied().unwrap_or(0.0),
                        pair.last().copied().unwrap_or(0.0),
                    ]
                })
                .collect(),
        }
    }

    fn curve(&self, x: &DVector<f64>) -> ArcCurve {
        let count = self.nodes.count();
        let mut curve = ArcCurve {
            phi: vec![Vector2::zeros(); count],
            slope: vec![Vector2::zeros(); count],
        };
        for ([phi, slope], coefficient) in self.basis.iter().zip(x.iter()) {
            for (sum, term) in curve.phi.iter_mut().zip(phi) {
                *sum += term * *coefficient;
            }
            for (sum, term) in curve.slope.iter_mut().zip(slope) {
                *sum += term * *coefficient;
            }
        }
        curve
    }

    fn valued(&self, x: &DVector<f64>, model: &Model<f64>) -> Valued {
        let curve = self.curve(x);
        let swum = Trajectory::new(model, &self.nodes, std::slice::from_ref(&curve));
        // At each node: height, what E gains by Φ and by Φ′ there.
        let mut power = Vec::with_capacity(curve.phi.len());
        let (mut by_phi, mut by_slope) = (Vec::new(), Vec::new());
        for (index, (phi, slope)) in curve.phi.iter().zip(&curve.slope).enumerate() {
            let first = model.first_derivatives(phi);
            let force = first.power * slope;
            power.push(slope.dot(&force));
            let height = swum.height(model, index, phi);
            // A push δΦ sweeps δφ₁φ₂′ − δφ₂φ₁′ to the right of the curve.
            by_phi.push((
                Vector2::new(slope.y, -slope.x) * (4.0 * height),
                Vector2::from(first.d_power.map(|d| slope.dot(&(d * slope)))) * 16.0,
            ));
            by_slope.push(force * 32.0);
        }
        let energy = 16.0 * self.nodes.whole(power.into_iter());
        let x_net = swum.displacement;
        let xi = model.side_drag() * x_net * x_net / energy;
        let gradient = DVector::from_iterator(
            x.len(),
            self.basis.iter().map(|[term, term_slope]| {
                let dx = self
                    .nodes
                    .whole(by_phi.iter().zip(term).map(|((dx, _), t)| dx.dot(t)));
                let parts = by_phi
                    .iter()
                    .zip(&by_slope)
                    .zip(term.iter().zip(term_slope));
                let de = self
                    .nodes
                    .whole(parts.map(|(((_, de), force), (t, ts))| de.dot(t) + force.dot(ts)));
                xi * (2.0 * dx / x_net - de / energy)
            }),
        );
        Valued { xi, gradient }
    }

    /// Weighted ξ̄ and ∇ξ̄/ξ̄.
    fn weighted(&self, x: &DVector<f64>, members: &[(&Model<f64>, f64)]) -> (f64, DVector<f64>) {
        let (mut xi, mut gradient) = (0.0, DVector::zeros(x.len()));
        for (model, weight) in members.iter().filter(|(_, weight)| *weight != 0.0) {
            let valued = self.valued(x, model);
            xi += weight * valued.xi;
            gradient += valued.gradient * *weight;
        }
        (xi, gradient / xi)
    }

    /// |∇ξ̄|/ξ̄ at a design.
    pub(super) fn gradient_norm(&self, x: &DVector<f64>, members: &[(&Model<f64>, f64)]) -> f64 {
        self.weighted(x, members).1.norm()
    }

    /// Largest curvature of ln ξ̄ at a design, over the magnitude of the steepest: negative at a strict maximum.
    pub(super) fn largest_curvature(
        &self,
        x: &DVector<f64>,
        members: &[(&Model<f64>, f64)],
    ) -> f64 {
        let eigen = self.hessian(x, members).symmetric_eigen();
        eigen.eigenvalues.max() / eigen.eigenvalues.amax()
    }

    /// Of ln ξ̄: at a stationary point that of ξ̄ over ξ̄.
    fn hessian(&self, x: &DVector<f64>, members: &[(&Model<f64>, f64)]) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = (0..x.len())
            .map(|i| {
                let at = |step: f64| {
                    let mut x = x.clone();
                    if let Some(component) = x.get_mut(i) {
                        *component += step;
                    }
                    self.weighted(&x, members).1
                };
                (at(DIFFERENCE) - at(-DIFFERENCE)) / (2.0 * DIFFERENCE)
            })
            .collect();
        let matrix = DMatrix::from_columns(&columns);
        (&matrix + matrix.transpose()) * 0.5
    }
}

impl Design for FourierFamily {
    fn start(&self) -> DVector<f64> {
        self.start.clone()
    }

    fn values(&self, x: &DVector<f64>, members: &[Model<f64>]) -> Vec<f64> {
        members
            .iter()
            .map(|model| self.valued(x, model).xi)
            .collect()
    }

    /// Newton's ascent on ln ξ̄: along each principal direction uphill, by the distance that its curvature tells.
    fn solve(
        &self,
        start: &DVector<f64>,
        members: &[(&Model<f64>, f64)],
    ) -> Result<DVector<f64>, RobustError> {
        let mut x = start.clone();
        let (mut xi, mut gradient) = self.weighted(&x, members);
        for _ in 0..STEPS {
            if gradient.norm() <= FLAT {
                return Ok(x);
            }
            let eigen = self.hessian(&x, members).symmetric_eigen();
            let floor = FLATTEST * eigen.eigenvalues.amax();
            let along = eigen.eigenvectors.transpose() * &gradient;
            let step = DVector::from_iterator(
                x.len(),
                along
                    .iter()
                    .zip(eigen.eigenvalues.iter())
                    .map(|(slope, curvature)| slope / curvature.abs().max(floor)),
            );
            let step = &eigen.eigenvectors * step;
            let mut share = (LONGEST / step.norm().max(f64::MIN_POSITIVE)).min(1.0);
            let mut moved = false;
            for _ in 0..HALVINGS {
                let trial = &x + &step * share;
                let (there, slope) = self.weighted(&trial, members);
                // Near the top the value is rounding, and the gradient tells.
                let gains =
                    there > xi || (there > xi * (1.0 - 1e-13) && slope.norm() < gradient.norm());
                if gains {
                    (x, xi, gradient, moved) = (trial, there, slope, true);
                    break;
                }
                share *= 0.5;
            }
            if !moved {
                break;
            }
        }
        if gradient.norm() <= 10.0 * FLAT {
            return Ok(x);
        }
        Err(RobustError::NotConverged {
            residual: gradient.norm(),
        })
    }
}
