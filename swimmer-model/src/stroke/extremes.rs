//! Event location: the exact largest and smallest values of y and θ along a cycle.
//!
//! Within a panel the rate is a polynomial. Its zeros are bracketed between nodes. If the rate has an extremum near zero, that is
//! located first, so that a pair of close zeros is not missed.

use super::legendre::{N, Rule, Series};
use crate::Scalar;

/// Smallest and largest value so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range<T> {
    min: T,
    max: T,
}

impl<T: Scalar> Range<T> {
    pub(super) fn of(value: T) -> Self {
        Self {
            min: value,
            max: value,
        }
    }

    pub(super) fn half_width(&self) -> T {
        (self.max - self.min) * T::from_f64(0.5)
    }

    fn include(&mut self, value: T) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    /// Includes all values of start + half_width · ∫ rate ds on a panel.
    pub(super) fn extend(&mut self, start: T, half_width: T, rate: &Series<T>) {
        self.include(start);
        self.include(start + half_width * rate.whole_integral());
        if rate.keeps_its_sign() {
            return;
        }
        let value = |s: T| start + half_width * rate.integral(s);
        let place = |i: usize| match i {
            0 => -T::one(),
            i => Rule::<N>::NODES
                .get(i - 1)
                .map_or(T::one(), |&s| T::from_f64(s)),
        };
        let mut left = place(0);
        for i in 1..=N + 1 {
            let right = place(i);
            let (f, g) = (rate.value(left), rate.value(right));
            if differ(f, g) {
                self.include(value(zero(left, right, |s| rate.value(s))));
            } else if differ(f, rate.derivative(left)) && !differ(g, rate.derivative(right)) {
                let dip = zero(left, right, |s| rate.derivative(s));
                if differ(f, rate.value(dip)) {
                    self.include(value(zero(left, dip, |s| rate.value(s))));
                    self.include(value(zero(dip, right, |s| rate.value(s))));
                }
            }
            left = right;
        }
    }
}

/// Returns `true` if the signs are opposite.
fn differ<T: Scalar>(a: T, b: T) -> bool {
    (a > T::zero() && b < T::zero()) || (a < T::zero() && b > T::zero())
}

/// Returns a zero of `f` between two points of opposite sign, to rounding, by the Illinois variant of regula falsi: the value at
/// an end that is kept twice is halved, so that both ends converge.
pub(super) fn zero<T: Scalar>(mut left: T, mut right: T, f: impl Fn(T) -> T) -> T {
    let half = T::from_f64(0.5);
    let (mut at_left, mut at_right) = (f(left), f(right));
    let mut place = left;
    let mut moved_left = None;
    for _ in 0..100 {
        let last = place;
        place = (left * at_right - right * at_left) / (at_right - at_left);
        if !(place > left && place < right) {
            // The zero is at an end to rounding.
            return place.max(left).min(right);
        }
        let value = f(place);
        if value == T::zero() || (place - last).abs() <= T::EPSILON {
            break;
        }
        let moves_left = !differ(at_left, value);
        if moves_left {
            (left, at_left) = (place, value);
            at_right *= if moved_left == Some(true) {
                half
            } else {
                T::one()
            };
        } else {
            (right, at_right) = (place, value);
            at_left *= if moved_left == Some(false) {
                half
            } else {
                T::one()
            };
        }
        moved_left = Some(moves_left);
    }
    place
}

#[cfg(test)]
mod tests {
    use super::zero;

    #[test]
    fn zeros_are_found_to_rounding_also_at_an_end() {
        assert!((zero(0.0, 2.0, |s: f64| s * s * s - 2.0) - 2.0_f64.cbrt()).abs() < 1e-15);
        assert!((zero(-1.0, 0.9, |s: f64| s.exp() - 1.0)).abs() < 1e-15);
        // The nearest number to the zero is the end itself.
        assert!((zero(1.0, 2.0, |s: f64| (s - 1.0) - 1e-20) - 1.0).abs() < 1e-15);
        assert!((zero(1.0, 2.0, |s: f64| (s - 2.0) + 1e-20) - 2.0).abs() < 1e-15);
    }
}
