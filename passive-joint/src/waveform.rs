//! Waveforms of the driven joint: odd Fourier series, so that the second half cycle mirrors the first and the swimmer does not turn.

use link_protocol::Joint;
use nalgebra::Vector2;
use swimmer_model::{Fourier, Harmonic};

/// Waveform a(u) = Σ (cₙ cos(2πnu) + sₙ sin(2πnu)), n = 1, 3, 5, …, with s₁ = 0, which fixes its start.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform {
    /// c₁, then c₃, s₃, c₅, s₅, … \[rad\].
    coefficients: Vec<f64>,
}

/// Order of the harmonic of a coefficient.
fn order(index: usize) -> usize {
    2 * index.div_ceil(2) + 1
}

/// True for the coefficient of a sine.
fn is_sine(index: usize) -> bool {
    index > 0 && index.is_multiple_of(2)
}

/// One harmonic of a waveform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OddHarmonic {
    /// Order.
    pub order: usize,
    /// Coefficient of the cosine \[rad\].
    pub cos: f64,
    /// Coefficient of the sine \[rad\].
    pub sin: f64,
}

impl Waveform {
    /// `amplitude` cos 2πu \[rad\].
    pub fn sine(amplitude: f64) -> Self {
        Self {
            coefficients: vec![amplitude],
        }
    }

    /// Waveform with these coefficients c₁, c₃, s₃, c₅, s₅, … \[rad\].
    pub fn new(coefficients: Vec<f64>) -> Self {
        Self { coefficients }
    }

    /// Coefficients c₁, c₃, s₃, c₅, s₅, … \[rad\].
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Harmonics in increasing order.
    pub fn harmonics(&self) -> impl Iterator<Item = OddHarmonic> {
        let coefficient = |index: usize| self.coefficients.get(index).copied().unwrap_or(0.0);
        let count = self.coefficients.len() / 2 + 1;
        (0..count).map(move |n| OddHarmonic {
            order: 2 * n + 1,
            cos: coefficient((2 * n).saturating_sub(1)),
            sin: if n == 0 { 0.0 } else { coefficient(2 * n) },
        })
    }

    /// Number of coefficients of a waveform with this number of odd harmonics.
    pub(crate) fn count(harmonics: usize) -> usize {
        2 * harmonics - 1
    }

    /// Value and derivative of the basis function of a coefficient.
    pub(crate) fn basis(index: usize, u: f64) -> [f64; 2] {
        let speed = std::f64::consts::TAU * order(index) as f64;
        let (sin, cos) = (speed * u).sin_cos();
        if is_sine(index) {
            [sin, speed * cos]
        } else {
            [cos, -speed * sin]
        }
    }

    /// Angle \[rad\] and its derivative with respect to u.
    pub fn at(&self, u: f64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (index, coefficient) in self.coefficients.iter().enumerate() {
            let basis = Self::basis(index, u);
            sum[0] += coefficient * basis[0];
            sum[1] += coefficient * basis[1];
        }
        sum
    }

    /// Gait whose `driven` joint follows this waveform; the other joint is straight.
    pub fn driving(&self, driven: Joint) -> Fourier<f64, Vec<Harmonic<f64>>> {
        let along = match driven {
            Joint::Front => Vector2::x(),
            Joint::Back => Vector2::y(),
        };
        let last = self.coefficients.len().saturating_sub(1);
        let mut harmonics = vec![
            Harmonic {
                cos: Vector2::zeros(),
                sin: Vector2::zeros(),
            };
            order(last)
        ];
        for (index, coefficient) in self.coefficients.iter().enumerate() {
            if let Some(harmonic) = harmonics.get_mut(order(index) - 1) {
                if is_sine(index) {
                    harmonic.sin += along * *coefficient;
                } else {
                    harmonic.cos += along * *coefficient;
                }
            }
        }
        Fourier {
            mean: Vector2::zeros(),
            harmonics,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Gait as _;

    #[test]
    fn the_gait_is_the_waveform_and_its_second_half_mirrors_the_first() {
        let waveform = Waveform::new(vec![1.0, 0.2, -0.1, 0.05, 0.3]);
        let gait = waveform.driving(Joint::Back);
        for k in 0..20 {
            let u = f64::from(k) / 20.0;
            let point = gait.at(u);
            let [angle, rate] = waveform.at(u);
            assert!((point.phi - Vector2::new(0.0, angle)).norm() < 1e-14);
            assert!((point.rate - Vector2::new(0.0, rate)).norm() < 1e-12);
            assert!((waveform.at(u + 0.5)[0] + angle).abs() < 1e-13);
        }
    }
}
