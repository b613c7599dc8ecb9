//! Exact derivatives of A and W, and the curvature of the connection.

use crate::Scalar;
use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

/// A, W and their first derivatives at one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstDerivatives<T> {
    /// A(Φ), rows (x, y, θ).
    pub connection: Matrix3x2<T>,
    /// W(Φ)/μ.
    pub power: Matrix2<T>,
    /// ∂A/∂φ₁, ∂A/∂φ₂.
    pub d_connection: [Matrix3x2<T>; 2],
    /// ∂W/∂φ₁, ∂W/∂φ₂, over μ.
    pub d_power: [Matrix2<T>; 2],
}

/// A, W and their first and second derivatives at one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondDerivatives<T> {
    /// Values and first derivatives.
    pub first: FirstDerivatives<T>,
    /// ∂²A/∂φ₁², ∂²A/∂φ₁∂φ₂, ∂²A/∂φ₂².
    pub d2_connection: [Matrix3x2<T>; 3],
    /// ∂²W/∂φ₁², ∂²W/∂φ₁∂φ₂, ∂²W/∂φ₂², over μ.
    pub d2_power: [Matrix2<T>; 3],
}

/// A, W and the curvature F of the connection at one shape, with the derivatives of F along a covector. An arc of greatest
/// displacement needs no more, and this costs much less than all second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeighedCurvature<T> {
    /// A(Φ), rows (x, y, θ).
    pub connection: Matrix3x2<T>,
    /// W(Φ)/μ.
    pub power: Matrix2<T>,
    /// F(Φ), as of [`FirstDerivatives::curvature`].
    pub curvature: Vector3<T>,
    /// The covector times ∂F/∂φ₁ and ∂F/∂φ₂.
    pub slope: Vector2<T>,
}

/// Bracket of two body velocities in se(2), the matrix commutator: (ω₁ J v₂ − ω₂ J v₁, 0) with J = (0 −1; 1 0).
#[inline(always)]
fn bracket<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(b.z * a.y - a.z * b.y, a.z * b.x - b.z * a.x, T::zero())
}

impl<T: Scalar> FirstDerivatives<T> {
    /// Curvature of the connection, ∂₁A₂ − ∂₂A₁ + \[A₁, A₂\]: the body displacement of a tiny counter-clockwise loop
    /// over its area. (The paper prints a minus before the bracket; with q̇ = D A Φ̇ it is a plus.)
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let model = Model::new(&Swimmer::<f64>::purcell())?;
    /// // A small loop about the straight swimmer moves it along, and neither across nor round.
    /// let f = model.first_derivatives(&Vector2::zeros()).curvature();
    /// assert!(f.x > 0.0 && f.y.abs() < 1e-15 && f.z.abs() < 1e-15);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    #[inline]
    pub fn curvature(&self) -> Vector3<T> {
        let [d1, d2] = &self.d_connection;
        let (a1, a2) = (
            self.connection.column(0).into_owned(),
            self.connection.column(1).into_owned(),
        );
        d1.column(1) - d2.column(0) + bracket(&a1, &a2)
    }

    /// The derivative of \[A₁, A₂\] along an angle.
    #[inline(always)]
    pub(crate) fn d_bracket(&self, angle: usize) -> Vector3<T> {
        let column = |matrix: &Matrix3x2<T>, k: usize| matrix.column(k).into_owned();
        let (a, d) = (&self.connection, &self.d_connection[angle]);
        bracket(&column(d, 0), &column(a, 1)) + bracket(&column(a, 0), &column(d, 1))
    }
}

impl<T: Scalar> SecondDerivatives<T> {
    /// Derivatives of [`FirstDerivatives::curvature`] with respect to φ₁ and φ₂.
    pub fn d_curvature(&self) -> [Vector3<T>; 2] {
        let [d11, d12, d22] = &self.d2_connection;
        [
            d11.column(1) - d12.column(0) + self.first.d_bracket(0),
            d12.column(1) - d22.column(0) + self.first.d_bracket(1),
        ]
    }
}
