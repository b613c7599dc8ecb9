//! The full connection G(Φ, θ) = D(θ) A(Φ) and its derivatives, θ included.
//!
//! D(θ) turns the middle link's own frame into the world's: (ẋ, ẏ, θ̇) = G Φ̇ (paper, the equation of motion). Since θ
//! enters by D alone, every derivative of G is a rotation of a derivative of A.

use crate::{FirstDerivatives, Model, Scalar, SecondDerivatives};
use nalgebra::{Matrix3x2, Vector2};

/// G and its first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullFirstDerivatives<T> {
    /// G(Φ, θ), rows (x, y, θ) in the world's frame.
    pub connection: Matrix3x2<T>,
    /// ∂G/∂φ₁, ∂G/∂φ₂.
    pub d_phi: [Matrix3x2<T>; 2],
    /// ∂G/∂θ.
    pub d_theta: Matrix3x2<T>,
}

/// G and its first and second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullSecondDerivatives<T> {
    /// Values and first derivatives.
    pub first: FullFirstDerivatives<T>,
    /// ∂²G/∂φ₁², ∂²G/∂φ₁∂φ₂, ∂²G/∂φ₂².
    pub d2_phi: [Matrix3x2<T>; 3],
    /// ∂²G/∂φ₁∂θ, ∂²G/∂φ₂∂θ.
    pub d_phi_d_theta: [Matrix3x2<T>; 2],
    /// ∂²G/∂θ².
    pub d2_theta: Matrix3x2<T>,
}

/// D(θ), by its sine and cosine.
#[derive(Clone, Copy)]
struct Heading<T> {
    sin: T,
    cos: T,
}

impl<T: Scalar> Heading<T> {
    fn new(theta: T) -> Self {
        let (sin, cos) = theta.sin_cos();
        Self { sin, cos }
    }

    /// D a
    fn turn(&self, a: &Matrix3x2<T>) -> Matrix3x2<T> {
        let Self { sin, cos } = *self;
        Matrix3x2::new(
            cos * a.m11 - sin * a.m21,
            cos * a.m12 - sin * a.m22,
            sin * a.m11 + cos * a.m21,
            sin * a.m12 + cos * a.m22,
            a.m31,
            a.m32,
        )
    }
}

/// ∂(D a)/∂θ from D a: a quarter turn of the rows x and y; the row θ does not depend on θ.
fn quarter_turn<T: Scalar>(g: &Matrix3x2<T>) -> Matrix3x2<T> {
    Matrix3x2::new(-g.m21, -g.m22, g.m11, g.m12, T::zero(), T::zero())
}

impl<T: Scalar> Model<T> {
    /// G(Φ, θ) = D(θ) A(Φ): velocity (ẋ, ẏ, θ̇) in the world's frame per joint rate.
    pub fn full_connection(&self, phi: &Vector2<T>, theta: T) -> Matrix3x2<T> {
        Heading::new(theta).turn(&self.local_connection(phi))
    }
}

impl<T: Scalar> FirstDerivatives<T> {
    /// The same for G at heading θ.
    pub fn at_heading(&self, theta: T) -> FullFirstDerivatives<T> {
        let heading = Heading::new(theta);
        let connection = heading.turn(&self.connection);
        FullFirstDerivatives {
            connection,
            d_phi: self.d_connection.map(|d| heading.turn(&d)),
            d_theta: quarter_turn(&connection),
        }
    }
}

impl<T: Scalar> SecondDerivatives<T> {
    /// The same for G at heading θ.
    pub fn at_heading(&self, theta: T) -> FullSecondDerivatives<T> {
        let heading = Heading::new(theta);
        let first = self.first.at_heading(theta);
        FullSecondDerivatives {
            first,
            d2_phi: self.d2_connection.map(|d| heading.turn(&d)),
            d_phi_d_theta: first.d_phi.map(|d| quarter_turn(&d)),
            d2_theta: quarter_turn(&first.d_theta),
        }
    }
}
