//! The first variation of a closed curve from the geometry: momentum times curvature.
//!
//! Pushing a curve by δΦ(u) while its first point stays changes its net motion by ∮ h (δφ₁ φ₂′ − δφ₂ φ₁′) du, with
//! h = μ · F(Φ), F = dA + [A₁, A₂], and for p · d + cΔθ the body momentum
//!
//! ```text
//! μ = (p_x cosθ + p_y sinθ, −p_x sinθ + p_y cosθ, p_x (y − Y) − p_y (x − X) + c)
//! ```
//!
//! With no net rotation the constant X, Y only shift c, and this is the height of the paper's `λ₄ = y − y_f`. Moving the
//! first point as well conjugates the motion by the body motion ζ = A(Φ₀) δΦ₀: `δd = (R(Δθ) − 1) ζ_xy − ζ_θ J d`,
//! J = (0 −1; 1 0).

use nalgebra::{DMatrix, Matrix3, Matrix3x2, Vector2, Vector3};

use super::Functional;
use super::basis::{PARTIAL, STAGES, WEIGHTS};
use super::functional::{Values, Workspace, column, turned};

/// Heights at the nodes for each of X, Y, Δθ, and the change by the first point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeightDensity {
    /// One column a node: the heights for X, Y and Δθ.
    pub(crate) heights: DMatrix<f64>,
    /// ∂(X, Y, Δθ)/∂Φ₀ with the loop conjugated by the motion of its first point.
    pub(crate) by_first_point: Matrix3x2<f64>,
}

impl Functional<'_> {
    /// Heights along the curve that [`Functional::gradients`] was asked for last.
    pub(crate) fn height_density(
        &self,
        coefficients: &DMatrix<f64>,
        work: &Workspace,
        values: &Values,
    ) -> HeightDensity {
        let first_point = self.basis.shape(coefficients, 0.0);
        let nodes = self.basis.nodes();
        let mut heights = DMatrix::zeros(3, nodes);
        let mut position = Vector2::zeros();
        for panel in 0..self.basis.panels() {
            let first = panel * STAGES;
            let moved: [Vector2<f64>; STAGES] =
                std::array::from_fn(|q| turned(work.heading[first + q], &work.motion[first + q]));
            for (q, row) in PARTIAL.iter().enumerate() {
                let node = first + q;
                let inside: Vector2<f64> = moved.iter().zip(row).map(|(m, part)| m * *part).sum();
                let left = position + inside - values.displacement;
                let f = work.derivatives[node].first.curvature();
                let ahead = turned(work.heading[node], &f);
                heights[(0, node)] = ahead.x + left.y * f.z;
                heights[(1, node)] = ahead.y - left.x * f.z;
                heights[(2, node)] = f.z;
            }
            position += moved.iter().sum::<Vector2<f64>>();
        }
        HeightDensity {
            heights,
            by_first_point: self.conjugation(first_point, values),
        }
    }

    fn conjugation(&self, first: Vector2<f64>, values: &Values) -> Matrix3x2<f64> {
        let connection = self.model.local_connection(&first);
        let (sin, cos) = values.rotation.sin_cos();
        let d = values.displacement;
        Matrix3::new(
            cos - 1.0,
            -sin,
            d.y, //
            sin,
            cos - 1.0,
            -d.x, //
            0.0,
            0.0,
            0.0,
        ) * connection
    }

    /// The gradients of X, Y, Δθ by the coefficients that the heights give; equal to [`Workspace::gradients`] up to the
    /// quadrature of the panels.
    pub(crate) fn gradients_of_heights(
        &self,
        work: &Workspace,
        density: &HeightDensity,
    ) -> DMatrix<f64> {
        let mut gradients = DMatrix::zeros(self.unknowns(), 3);
        for node in 0..self.basis.nodes() {
            let slope = column(&work.slope, node) * WEIGHTS[node % STAGES];
            let height: Vector3<f64> = density.heights.fixed_view::<3, 1>(0, node).into_owned();
            for (j, value) in self.basis.values.column(node).iter().enumerate() {
                for quantity in 0..3 {
                    gradients[(2 * j, quantity)] += height[quantity] * slope.y * value;
                    gradients[(2 * j + 1, quantity)] -= height[quantity] * slope.x * value;
                }
            }
        }
        let mut here = vec![(0.0, 0.0); self.basis.functions()];
        self.basis.at(0.0, &mut here);
        for (j, (value, _)) in here.iter().enumerate() {
            for joint in 0..2 {
                for quantity in 0..3 {
                    gradients[(2 * j + joint, quantity)] +=
                        density.by_first_point[(quantity, joint)] * value;
                }
            }
        }
        gradients
    }
}
