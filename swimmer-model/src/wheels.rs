//! Singular shapes of the kinematic snake: shapes at which the constraints of the three wheels are dependent.
//!
//! The wheels leave no freedom but the joints' unless their axles meet in one point or are parallel. At such a shape A is
//! infinite. The determinant of the three constraints,
//!
//! ```text
//! D(Φ) = (h cos φ₂ + b₂) sin φ₁ − (h cos φ₁ + b₁) sin φ₂,   h = l₀/2, bᵢ = lᵢ/2,
//! ```
//!
//! is odd, D(−Φ) = −D(Φ): the straight shape is singular, and so is a curve through it. With equal side links the curve is the
//! line φ₁ = φ₂.

use crate::{Gait, InvalidSwimmer, Medium, Scalar, Swimmer};
use nalgebra::Vector2;

/// Shapes that are inspected over a cycle.
const SHAPES: usize = 1024;
/// |D| over its scale below which a shape counts as singular: A is then larger than 1e6 body lengths per radian.
const SINGULAR: f64 = 1e-6;

impl<T: Scalar> Swimmer<T> {
    /// Determinant of the wheels' constraints over half the total length, between −1 and 1; zero at a singular shape. Returns `None`
    /// if the swimmer has no wheels.
    pub fn wheel_determinant(&self, phi: &Vector2<T>) -> Option<T> {
        if self.medium != Medium::Wheels {
            return None;
        }
        let half = T::from_f64(0.5);
        let h = self.links.middle * half;
        let (sin1, cos1) = phi.x.sin_cos();
        let (sin2, cos2) = phi.y.sin_cos();
        let front = h * cos1 + self.links.front * half;
        let back = h * cos2 + self.links.back * half;
        Some((back * sin1 - front * sin2) / (self.total_length() * half))
    }

    /// Checks that A is finite about the straight shape, which all bounds contain.
    ///
    /// # Errors
    /// [`InvalidSwimmer::Singular`] on wheels: D is odd, so the straight shape is singular whatever the lengths.
    pub fn check_regular(&self) -> Result<(), InvalidSwimmer> {
        let straight = Vector2::zeros();
        match self.wheel_determinant(&straight) {
            Some(d) if d.abs() <= T::from_f64(SINGULAR) => Err(InvalidSwimmer::Singular {
                phi: [straight.x, straight.y].map(T::to_f64),
            }),
            _ => Ok(()),
        }
    }

    /// First singular shape of a gait. Returns `None` if it has none, or if the swimmer has no wheels.
    ///
    /// ```
    /// use swimmer_model::{Circle, Medium, Swimmer};
    ///
    /// let snake = Swimmer { medium: Medium::Wheels, ..Swimmer::<f64>::purcell() };
    /// let shape = snake.singular_shape(&Circle { amplitude: 1.0 }).unwrap();
    /// assert!((shape.x - shape.y).abs() < 1e-6, "axles of equal links meet in a point on φ₁ = φ₂");
    /// ```
    pub fn singular_shape<G: Gait<T> + ?Sized>(&self, gait: &G) -> Option<Vector2<T>> {
        let place = |i: usize| T::from_f64(i as f64 / SHAPES as f64);
        let at = |u: T| self.wheel_determinant(&gait.at(u).phi);
        let tiny = T::from_f64(SINGULAR).max(T::EPSILON);
        let [mut before, mut here] = [at(place(0))?; 2];
        for i in 0..SHAPES {
            let (from, to) = (place(i), place(i + 1));
            let next = at(to)?;
            if here.abs() <= tiny {
                return Some(gait.at(from).phi);
            }
            if (here < T::zero()) != (next < T::zero()) {
                return Some(gait.at(self.root(gait, [from, to], here)).phi);
            }
            // A curve that touches the singular one without crossing it.
            if i > 0 && here.abs() <= before.abs() && here.abs() <= next.abs() {
                let u = self.least(gait, [place(i - 1), to]);
                if at(u)?.abs() <= tiny {
                    return Some(gait.at(u).phi);
                }
            }
            before = here;
            here = next;
        }
        None
    }

    /// Bisection of a change of sign.
    fn root<G: Gait<T> + ?Sized>(&self, gait: &G, [mut from, mut to]: [T; 2], at_from: T) -> T {
        for _ in 0..60 {
            let middle = (from + to) * T::from_f64(0.5);
            let value = self.wheel_determinant(&gait.at(middle).phi);
            if value.is_some_and(|value| (value < T::zero()) == (at_from < T::zero())) {
                from = middle;
            } else {
                to = middle;
            }
        }
        from
    }

    /// Ternary search of the least |D|.
    fn least<G: Gait<T> + ?Sized>(&self, gait: &G, [mut from, mut to]: [T; 2]) -> T {
        let size = |u: T| {
            let value = self.wheel_determinant(&gait.at(u).phi);
            value.map_or(T::zero(), Scalar::abs)
        };
        for _ in 0..60 {
            let third = (to - from) / T::from_f64(3.0);
            if size(from + third) < size(to - third) {
                to -= third;
            } else {
                from += third;
            }
        }
        (from + to) * T::from_f64(0.5)
    }
}
