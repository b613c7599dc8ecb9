//! Height functions in minimum-perturbation coordinates, which show the area that a gait should enclose (paper, section IV.B).
//!
//! The curvature of the connection, F = dA + \[A₁, A₂\], is the displacement of an infinitesimal loop in the plane of joint angles
//! over its area, in the frame of the middle link. Over a large loop the middle link rotates, and these displacements do not add
//! up. They almost do in a frame that rotates and sways as little as possible: p′ = p + R(θ) b(Φ),
//! θ′ = θ + b_θ(Φ), where b_θ minimises ∫|A^θ + ∇b_θ|² with b_θ(0) = 0, and b = (b_x, b_y) then minimises
//! ∫|A^v + ∇b + A^θ ⊗ J b|², J = (0 −1; 1 0), both over the square \[−D, D\]² with natural boundary conditions (Hatton and
//! Choset's minimum-perturbation coordinates). The height function is the curvature carried into that frame, over L:
//! (H_x, H_y) = R(−b_θ)(F_v + F_θ J b), H_θ = F_θ.
//!
//! **Accuracy.** b is expanded in products of Legendre polynomials, whose order is raised until b no longer changes
//! ([`Convergence`]). Convergence is geometric inside the square. At the corners the frame is not smooth: the natural conditions
//! of the two edges contradict each other unless the curvature vanishes, and b has a term r² ln r. There, convergence is
//! algebraic. Both figures are part of the result.
//!
//! **The height function depends on D**, which is not limited to π. The connection has period 2π in each angle and is smooth
//! beyond π, but the frame is not periodic, since its boundary conditions are those of the square. A large square needs a higher
//! order.

#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: b_x, H_x"
)]

mod area_rule;
mod error;
mod galerkin;
pub(crate) mod legendre;
mod level;
mod level_curve;
mod space;
mod zeros;

use nalgebra::{DMatrix, Rotation2, Vector2, Vector3};
use swimmer_model::{Model, Swimmer};

use crate::batch::{Batch, First};

pub use area_rule::AreaRule;
pub use error::HeightMapError;
pub(crate) use level::{End, Level, OnCurve, Stride};
pub use level_curve::LevelCurve;
use level_curve::level_curves;
pub(crate) use level_curve::{LevelSearch, level_seeds, passes};

use galerkin::Coefficients;
use legendre::polynomials;
use space::table;

/// Component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Row {
    /// Along the frame, over L.
    X,
    /// Across the frame, to the left, over L.
    Y,
    /// Rotation, counter-clockwise. It is the same in every frame.
    Theta,
}

/// Change of the frame at the last increase of the order.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "FrameConvergence")
)]
pub struct Convergence {
    /// Number of polynomials in each direction, of degrees 0 to `order` − 1.
    pub order: usize,
    /// Previous order.
    pub order_before: usize,
    /// Largest change of b_x, b_y (over L) and b_θ (rad) between the two orders for |φᵢ| ≤ 0.8 D.
    pub inner_change: f64,
    /// The same on the whole square, corners included.
    pub change: f64,
}

/// Frame at one shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// (b_x, b_y, b_θ): position over L and heading \[rad\] of the frame relative to the middle link.
    pub b: Vector3<f64>,
    /// ∂b/∂φ₁ and ∂b/∂φ₂.
    pub slopes: [Vector3<f64>; 2],
}

/// Height functions of a swimmer on one square.
///
/// ```
/// use gait_optimizer::{HeightMap, Row};
/// use nalgebra::Vector2;
/// use swimmer_model::Swimmer;
///
/// let map = HeightMap::new(&Swimmer::purcell(), 2.5)?;
/// assert!((map.height(Row::X, &Vector2::zeros()) - 0.0205761317).abs() < 1e-9);
/// assert!((map.zeros_on_diagonal(Row::X)[0] - 1.41638).abs() < 1e-5);
/// # Ok::<(), gait_optimizer::HeightMapError>(())
/// ```
#[derive(Debug, Clone)]
pub struct HeightMap {
    /// Model of the swimmer scaled to L = 1.
    model: Model<f64>,
    half_width: f64,
    coefficients: Coefficients,
    convergence: Convergence,
}

/// Heights at the nodes of a square grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Nodes of either angle, from −D to D \[rad\].
    pub angles: Vec<f64>,
    /// Heights; the row index runs along φ₁, the column index along φ₂.
    pub heights: DMatrix<f64>,
}

/// Orders, tried in turn.
const ORDERS: [usize; 8] = [16, 24, 36, 48, 64, 80, 96, 128];
const HIGHEST: usize = 128;
/// Change of the frame inside the square at which the order is sufficient.
const STILL: f64 = 1e-9;
/// Change of the frame at the highest order above which it is rejected.
const USELESS: f64 = 1e-4;
/// Half width of the inner part of the square, over D.
const INNER: f64 = 0.8;

impl HeightMap {
    /// Largest half width of the square \[rad\].
    pub const WIDEST: f64 = 2.0 * std::f64::consts::TAU;
    /// Smallest half width of the square \[rad\].
    pub const NARROWEST: f64 = 1e-3;

    /// Solves for the minimum-perturbation coordinates on \[−D, D\]², D = `half_width` \[rad\]. Side links may differ.
    ///
    /// # Errors
    /// [`HeightMapError`] if the swimmer or the square is out of range, or if the frame does not converge.
    pub fn new(swimmer: &Swimmer<f64>, half_width: f64) -> Result<Self, HeightMapError> {
        swimmer.check_regular()?;
        let model = Model::new(&swimmer.of_unit_length())?;
        if !(Self::NARROWEST..=Self::WIDEST).contains(&half_width) {
            return Err(HeightMapError::HalfWidth { value: half_width });
        }
        let mut order_before = ORDERS[0];
        let mut before = galerkin::solve(&model, half_width, order_before);
        let mut result = None;
        for order in ORDERS.into_iter().skip(1) {
            let coefficients = galerkin::solve(&model, half_width, order);
            let (inner_change, change) = coefficients.change_from(&before);
            let convergence = Convergence {
                order,
                order_before,
                inner_change,
                change,
            };
            result = Some(Self {
                model,
                half_width,
                coefficients: coefficients.clone(),
                convergence,
            });
            if inner_change <= STILL {
                break;
            }
            (before, order_before) = (coefficients, order);
        }
        result
            .filter(|map| map.convergence.inner_change <= USELESS)
            .ok_or(HeightMapError::NotConverged {
                half_width,
                order: HIGHEST,
            })
    }

    /// D \[rad\].
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Convergence of the frame.
    pub fn convergence(&self) -> Convergence {
        self.convergence
    }

    /// The minimum-perturbation frame at a shape of the square.
    pub fn frame(&self, phi: &Vector2<f64>) -> Frame {
        let order = self.coefficients.order();
        let s = phi / self.half_width;
        let ([mut p1, mut d1], [mut p2, mut d2]) = ([[0.0; HIGHEST]; 2], [[0.0; HIGHEST]; 2]);
        let n = order.min(HIGHEST);
        polynomials(s.x, &mut p1[..n], &mut d1[..n]);
        polynomials(s.y, &mut p2[..n], &mut d2[..n]);
        let mut frame = Frame {
            b: Vector3::zeros(),
            slopes: [Vector3::zeros(); 2],
        };
        for (k, row) in self.coefficients.rows.iter().enumerate() {
            let mut sums = [0.0; 3];
            for ((column, p2), d2) in row.as_slice().chunks_exact(n).zip(&p2).zip(&d2) {
                let [value, slope] = both(column, [&p1[..n], &d1[..n]]);
                sums[0] += value * p2;
                sums[1] += slope * p2;
                sums[2] += value * d2;
            }
            frame.b[k] = sums[0];
            frame.slopes[0][k] = sums[1] / self.half_width;
            frame.slopes[1][k] = sums[2] / self.half_width;
        }
        frame
    }

    /// (H_x, H_y, H_θ) at a shape of the square, over L and rad per rad².
    pub fn heights(&self, phi: &Vector2<f64>) -> Vector3<f64> {
        let curvature = self.model.first_derivatives(phi).curvature();
        carried(&curvature, &self.frame(phi).b)
    }

    /// Height function of one row at a shape of the square.
    pub fn height(&self, row: Row, phi: &Vector2<f64>) -> f64 {
        self.heights(phi)[row.index()]
    }

    /// Height function of one row and its exact gradient at a shape of the square.
    pub fn height_and_gradient(&self, row: Row, phi: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let second = self.model.second_derivatives(phi);
        let curvature = second.first.curvature();
        let along = second.d_curvature();
        let frame = self.frame(phi);
        let height = carried(&curvature, &frame.b);
        let slope = |k: usize| {
            // Product rule for R(−b_θ)(F_v + F_θ J b): derivatives of the curvature, of b, and of the rotation by −b_θ.
            let of_curvature = carried(&along[k], &frame.b);
            let step = frame.slopes[k];
            let sideways = Vector2::new(-step.y, step.x) * curvature.z;
            let of_place = Rotation2::new(-frame.b.z) * sideways;
            let of_turn = Vector2::new(height.y, -height.x) * step.z;
            of_curvature + Vector3::new(of_place.x + of_turn.x, of_place.y + of_turn.y, 0.0)
        };
        let row = row.index();
        (height[row], Vector2::new(slope(0)[row], slope(1)[row]))
    }

    /// Heights at `count` × `count` evenly spaced nodes, both ends included.
    pub fn grid(&self, row: Row, count: usize) -> Grid {
        let step = 2.0 / count.saturating_sub(1).max(1) as f64;
        let places: Vec<f64> = (0..count)
            .map(|i| (step * i as f64 - 1.0).min(1.0))
            .collect();
        Grid {
            heights: self.on_nodes(row, &places, &places),
            angles: places.iter().map(|s| s * self.half_width).collect(),
        }
    }

    /// Heights on the tensor grid of nodes, given over D.
    fn on_nodes(&self, row: Row, first: &[f64], second: &[f64]) -> DMatrix<f64> {
        let order = self.coefficients.order();
        let (p1, _) = table(first, order);
        let p2 = table(second, order).0.transpose();
        let [x, y, theta] = &self.coefficients.rows;
        let b = [&p1 * x * &p2, &p1 * y * &p2, &p1 * theta * &p2];
        let mut heights = DMatrix::zeros(first.len(), second.len());
        // Column-major, as matrices are stored.
        let phi = second.iter().flat_map(|&s2| {
            let shape = move |&s1: &f64| Vector2::new(s1, s2) * self.half_width;
            first.iter().map(shape)
        });
        Batch::of(&self.model).each(First, phi, |number, derivatives| {
            let frame = Vector3::new(b[0][number], b[1][number], b[2][number]);
            heights[number] = carried(&derivatives.curvature(), &frame)[row.index()];
        });
        heights
    }

    /// Zero-level curves of a height on the square: every component, each vertex with |H| ≤ 1e-12.
    pub fn zero_curves(&self, row: Row) -> Vec<LevelCurve> {
        level_curves(
            &Level(|phi: &Vector2<f64>| self.height_and_gradient(row, phi)),
            &LevelSearch::new(self.half_width),
            |first, second| self.on_nodes(row, first, second),
        )
    }

    /// Model of the swimmer scaled to L = 1.
    pub(crate) fn model(&self) -> &Model<f64> {
        &self.model
    }
}

impl Row {
    /// Index of this component in (x, y, θ).
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Theta => 2,
        }
    }
}

/// Dot products of a column with the values and the slopes of the polynomials. Every order is a multiple of the number of lanes,
/// whose sums are independent.
fn both(column: &[f64], [values, slopes]: [&[f64]; 2]) -> [f64; 2] {
    const LANES: usize = 4;
    let (mut value, mut slope) = ([0.0; LANES], [0.0; LANES]);
    let fours = |all| <[f64]>::chunks_exact(all, LANES);
    for ((c, p), d) in fours(column).zip(fours(values)).zip(fours(slopes)) {
        for lane in 0..LANES {
            value[lane] += c[lane] * p[lane];
            slope[lane] += c[lane] * d[lane];
        }
    }
    [value, slope].map(|[a, b, c, d]| (a + b) + (c + d))
}

/// Transforms a velocity of the middle link to the frame (b_x, b_y, b_θ) fixed to it.
fn carried(velocity: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    let moved = Vector2::new(velocity.x - velocity.z * b.y, velocity.y + velocity.z * b.x);
    let turned = Rotation2::new(-b.z) * moved;
    Vector3::new(turned.x, turned.y, velocity.z)
}
