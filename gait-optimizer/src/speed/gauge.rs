//! What limits the velocities of the joints at a shape: rates, the power of both servos together, the torque of each.
//!
//! Each limit says how long a small turn of the joints takes at least, `G(Φ, dΦ)`, convex and of degree one in dΦ. The longest of
//! these times is a norm that changes with the shape, the gauge of the velocities that all limits allow; a cycle takes its length
//! by this norm.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use swimmer_model::SecondDerivatives;

/// One limit, `G(Φ, Φ̇) ≤ 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Facet {
    /// `rate φ̇ᵢ + torque (W Φ̇)ᵢ`: flat, as velocities go.
    Flat {
        joint: usize,
        rate: f64,
        torque: f64,
    },
    /// `√(Φ̇ᵀ W Φ̇ / power)`.
    Power { power: f64 },
}

/// A limit, or a bound, with its derivatives by φ₁, φ₂ and both velocities.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Level {
    pub(crate) value: f64,
    pub(crate) slope: Vector4<f64>,
    pub(crate) curved: Matrix4<f64>,
}

impl Facet {
    /// |φ̇ᵢ| ≤ Rᵢ, up and down.
    pub(crate) fn of_rates(rates: [f64; 2]) -> [Self; 4] {
        std::array::from_fn(|k| Self::Flat {
            joint: k / 2,
            rate: if k % 2 == 0 { 1.0 } else { -1.0 } / rates[k / 2],
            torque: 0.0,
        })
    }

    /// |τᵢ| ≤ stall (1 − |φ̇ᵢ|/`no_load`) with τ = W Φ̇.
    pub(crate) fn of_torque(stall: f64, no_load: f64) -> [Self; 8] {
        std::array::from_fn(|k| Self::Flat {
            joint: k / 4,
            rate: if k % 2 == 0 { 1.0 } else { -1.0 } / no_load,
            torque: if k / 2 % 2 == 0 { 1.0 } else { -1.0 } / stall,
        })
    }

    /// The least time for a turn `v` where W is this.
    pub(crate) fn value(&self, power: &Matrix2<f64>, v: &Vector2<f64>) -> f64 {
        match *self {
            Self::Flat {
                joint,
                rate,
                torque,
            } => rate * v[joint] + torque * (power * v)[joint],
            Self::Power { power: most } => (v.dot(&(power * v)) / most).max(0.0).sqrt(),
        }
    }

    /// The same with its derivatives.
    pub(crate) fn level(&self, at: &SecondDerivatives<f64>, v: &Vector2<f64>) -> Level {
        // Value and derivatives of a sum over the entries of W with these weights.
        let weigh = |of: &dyn Fn(&Matrix2<f64>) -> f64| {
            let by_phi = at.first.d_power.each_ref().map(of);
            let [a, b, d] = at.d2_power.each_ref().map(of);
            (of(&at.first.power), by_phi, Matrix2::new(a, b, b, d))
        };
        let mut slope = Vector4::zeros();
        let mut curved = Matrix4::zeros();
        match *self {
            Self::Flat {
                joint,
                rate,
                torque,
            } => {
                let (value, by_phi, twice) = weigh(&|w| torque * (w * v)[joint]);
                for k in 0..2 {
                    slope[k] = by_phi[k];
                    slope[2 + k] = torque * at.first.power[(joint, k)];
                    for l in 0..2 {
                        curved[(k, 2 + l)] = torque * at.first.d_power[k][(joint, l)];
                        curved[(2 + l, k)] = curved[(k, 2 + l)];
                    }
                }
                slope[2 + joint] += rate;
                curved.fixed_view_mut::<2, 2>(0, 0).copy_from(&twice);
                Level {
                    value: value + rate * v[joint],
                    slope,
                    curved,
                }
            }
            Self::Power { power } => {
                // Of the square first.
                let (square, by_phi, twice) = weigh(&|w| v.dot(&(w * v)) / power);
                for k in 0..2 {
                    slope[k] = by_phi[k];
                    slope[2 + k] = 2.0 * (at.first.power * v)[k] / power;
                    for l in 0..2 {
                        curved[(k, 2 + l)] = 2.0 * (at.first.d_power[k] * v)[l] / power;
                        curved[(2 + l, k)] = curved[(k, 2 + l)];
                        curved[(2 + k, 2 + l)] = 2.0 * at.first.power[(k, l)] / power;
                    }
                }
                curved.fixed_view_mut::<2, 2>(0, 0).copy_from(&twice);
                let value = square.max(f64::MIN_POSITIVE).sqrt();
                Level {
                    value,
                    slope: slope / (2.0 * value),
                    curved: curved / (2.0 * value)
                        - slope * slope.transpose() / (4.0 * value.powi(3)),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::{Model, Swimmer};

    #[test]
    fn derivatives_are_those_of_the_values() {
        let model = Model::new(&Swimmer::<f64>::robot().of_unit_length()).unwrap();
        let x = Vector4::new(0.8, -1.1, 0.7, 0.4);
        let all = Facet::of_torque(2.0, 3.0).into_iter();
        let all = all.chain(Facet::of_rates([1.0, 2.0]));
        for limit in all.chain([Facet::Power { power: 0.3 }]) {
            let level = |x: Vector4<f64>| {
                let phi = Vector2::new(x[0], x[1]);
                let v = Vector2::new(x[2], x[3]);
                let level = limit.level(&model.second_derivatives(&phi), &v);
                let value = limit.value(&model.power_matrix(&phi), &v);
                assert!((value - level.value).abs() < 1e-14);
                level
            };
            let here = level(x);
            // Of degree one in the velocities.
            let along = here.slope[2] * x[2] + here.slope[3] * x[3];
            assert!((along - here.value).abs() < 1e-13);
            for k in 0..4 {
                let mut step = Vector4::zeros();
                step[k] = 1e-5;
                let (up, down) = (level(x + step), level(x - step));
                let slope = (up.value - down.value) / 2e-5;
                assert!((slope - here.slope[k]).abs() < 1e-8, "{limit:?} {k}");
                let curved = (up.slope - down.slope) / 2e-5 - here.curved.column(k);
                assert!(curved.norm() < 1e-7, "{limit:?} {k} {curved}");
            }
        }
    }
}
