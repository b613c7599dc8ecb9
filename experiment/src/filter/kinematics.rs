//! Kalman filter of one coordinate: position, velocity and an acceleration that decays (Singer's model of a manoeuvring target).

use nalgebra::{Matrix3, RowVector3, Vector3};

/// Typical acceleration of a coordinate, and how long it lasts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Agility {
    /// Standard deviation of the acceleration \[1/s²\].
    pub(super) acceleration: f64,
    /// Its correlation time \[s\].
    pub(super) lasts_s: f64,
}

impl Agility {
    /// Transition over `dt`.
    fn transition(&self, dt: f64) -> Matrix3<f64> {
        let tau = self.lasts_s;
        let decay = (-dt / tau).exp();
        let velocity = tau * (1.0 - decay);
        let position = tau * tau * (dt / tau - 1.0 + decay);
        #[rustfmt::skip]
        let transition = Matrix3::new(
            1.0, dt, position,
            0.0, 1.0, velocity,
            0.0, 0.0, decay,
        );
        transition
    }

    /// Process noise over `dt`, for white noise that keeps the acceleration's variance. Exact for short steps, and no less than that
    /// of a constant acceleration for long ones.
    fn noise(&self, dt: f64) -> Matrix3<f64> {
        let density = 2.0 * self.acceleration.powi(2) / self.lasts_s;
        let [d1, d2, d3, d4, d5] = [1, 2, 3, 4, 5].map(|power| dt.powi(power));
        #[rustfmt::skip]
        let shape = Matrix3::new(
            d5 / 20.0, d4 / 8.0, d3 / 6.0,
            d4 / 8.0, d3 / 3.0, d2 / 2.0,
            d3 / 6.0, d2 / 2.0, d1,
        );
        shape * density
    }
}

/// Estimate of one coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coordinate {
    agility: Agility,
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
}

impl Coordinate {
    /// At rest at `position`, known to within `variance`.
    pub(super) fn at(position: f64, variance: f64, agility: Agility) -> Self {
        let acceleration = agility.acceleration.powi(2);
        let velocity = acceleration * agility.lasts_s.powi(2);
        Self {
            agility,
            state: Vector3::new(position, 0.0, 0.0),
            covariance: Matrix3::from_diagonal(&Vector3::new(variance, velocity, acceleration)),
        }
    }

    /// The same after `dt` seconds without a measurement.
    #[must_use]
    pub(super) fn after(&self, dt: f64) -> Self {
        let transition = self.agility.transition(dt);
        Self {
            agility: self.agility,
            state: transition * self.state,
            covariance: transition * self.covariance * transition.transpose()
                + self.agility.noise(dt),
        }
    }

    /// Takes a measurement of the position.
    pub(super) fn measure(&mut self, position: f64, variance: f64) {
        let row = RowVector3::new(1.0, 0.0, 0.0);
        let gain: Vector3<f64> = self.covariance.column(0) / (self.covariance[(0, 0)] + variance);
        self.state += gain * (position - self.state.x);
        // Joseph's form stays symmetric and positive.
        let rest = Matrix3::identity() - gain * row;
        self.covariance =
            rest * self.covariance * rest.transpose() + gain * gain.transpose() * variance;
    }

    pub(super) fn position(&self) -> f64 {
        self.state.x
    }

    pub(super) fn velocity(&self) -> f64 {
        self.state.y
    }

    pub(super) fn variance(&self) -> f64 {
        self.covariance[(0, 0)]
    }

    /// Moves the position without a change of its uncertainty.
    pub(super) fn shift(&mut self, by: f64) {
        self.state.x += by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const AGILITY: Agility = Agility {
        acceleration: 0.5,
        lasts_s: 0.8,
    };

    /// The stated variance is that of the errors, for an oscillation that the model is made for.
    #[test]
    fn the_variance_is_honest() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let (omega, sd, dt) = (1.0 / 0.8_f64, 6e-3, 0.01);
        let truth = |t: f64| 0.5 * (omega * t).sin();
        let mut coordinate = Coordinate::at(0.0, 1.0, AGILITY);
        let (mut squares, mut ahead_squares, mut count) = (0.0, 0.0, 0.0);
        for step in 1..6000 {
            let t = f64::from(step) * dt;
            let noise: f64 = StandardNormal.sample(&mut rng);
            coordinate = coordinate.after(dt);
            coordinate.measure(truth(t) + sd * noise, sd * sd);
            if step > 500 {
                let ahead = coordinate.after(0.08);
                squares += (coordinate.position() - truth(t)).powi(2) / coordinate.variance();
                ahead_squares += (ahead.position() - truth(t + 0.08)).powi(2) / ahead.variance();
                count += 1.0;
            }
        }
        assert!(
            (0.5..1.5).contains(&(squares / count)),
            "{}",
            squares / count
        );
        assert!(
            (0.4..1.5).contains(&(ahead_squares / count)),
            "{}",
            ahead_squares / count
        );
        assert!(coordinate.variance().sqrt() < sd / 2.0);
    }

    #[test]
    fn two_short_steps_are_one_long_step() {
        let start = Coordinate::at(1.0, 0.1, AGILITY);
        let (whole, halves) = (start.after(0.02), start.after(0.01).after(0.01));
        assert!((whole.position() - halves.position()).abs() < 1e-12);
        assert!((whole.variance() / halves.variance() - 1.0).abs() < 1e-3);
    }
}
