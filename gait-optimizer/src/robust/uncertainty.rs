//! What is known of r_s and χ, as the swimmers that a robust gait is held against.

use statrs::distribution::{ContinuousCDF, Normal};
use swimmer_model::Swimmer;

use super::RobustError;

/// Estimates of r_s and χ with their intervals, as a calibration finds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// r_s \[m\].
    pub sphere_radius: f64,
    /// χ.
    pub chi: f64,
    /// Interval of r_s \[m\].
    pub sphere_radius_interval: [f64; 2],
    /// Interval of χ.
    pub chi_interval: [f64; 2],
    /// Level of both.
    pub level: f64,
    /// Correlation between both where it is known; then the worst case is looked for on the ellipse that touches the
    /// intervals' borders, else in their box.
    pub correlation: Option<f64>,
}

/// A swimmer with its weight in a mean.
pub(super) type Weighted = (Swimmer<f64>, f64);

/// Gauss–Hermite nodes and weights for a standard normal variable, exact for polynomials of degree 5; the nodes are ±√3.
const HERMITE: [(f64, f64); 3] = [
    (-1.732_050_807_568_877_2, 1.0 / 6.0),
    (0.0, 2.0 / 3.0),
    (1.732_050_807_568_877_2, 1.0 / 6.0),
];

impl Uncertainty {
    /// Exactly these values.
    pub fn none(sphere_radius: f64, chi: f64) -> Self {
        Self {
            sphere_radius,
            chi,
            sphere_radius_interval: [sphere_radius; 2],
            chi_interval: [chi; 2],
            level: 0.95,
            correlation: None,
        }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first that makes no sense.
    pub fn validate(&self) -> Result<(), RobustError> {
        let wrong = |name, value, problem| {
            Err(RobustError::Uncertainty {
                name,
                value,
                problem,
            })
        };
        let interval = |name, estimate: f64, [low, high]: [f64; 2]| {
            if estimate.is_finite() && low.is_finite() && high.is_finite() && low <= high {
                Ok(())
            } else {
                wrong(name, low, "give two finite numbers, the lower one first")
            }
        };
        interval(
            "interval of r_s [m]",
            self.sphere_radius,
            self.sphere_radius_interval,
        )?;
        interval("interval of χ", self.chi, self.chi_interval)?;
        let [low, _] = self.chi_interval;
        if low <= 0.0 || self.chi <= 0.0 {
            return wrong(
                "χ",
                low.min(self.chi),
                "χ and its whole interval must be above 0",
            );
        }
        if !(self.level > 0.0 && self.level < 1.0) {
            return wrong("level", self.level, "give a share between 0 and 1, as 0.95");
        }
        match self.correlation {
            Some(rho) if rho.is_nan() || rho.abs() > 1.0 => {
                wrong("correlation", rho, "a correlation lies between -1 and 1")
            }
            _ => Ok(()),
        }
    }

    /// The swimmer with the estimates themselves.
    pub(super) fn nominal(&self, swimmer: &Swimmer<f64>) -> Swimmer<f64> {
        with(swimmer, self.sphere_radius, self.chi)
    }

    /// Swimmers among which the worst is looked for: a grid of so many steps over the box, or as many times eight points of
    /// the ellipse's border and its centre. (With 32 points the worst of the border is met to half a per cent of the
    /// half-widths.)
    pub(super) fn candidates(&self, swimmer: &Swimmer<f64>, steps: u32) -> Vec<Swimmer<f64>> {
        let [r_low, r_high] = self.sphere_radius_interval;
        let [chi_low, chi_high] = self.chi_interval;
        let mut candidates = vec![self.nominal(swimmer)];
        if let Some(rho) = self.correlation {
            let (dr, dchi) = (0.5 * (r_high - r_low), 0.5 * (chi_high - chi_low));
            for point in 0..8 * steps {
                let turn = std::f64::consts::TAU * f64::from(point) / f64::from(8 * steps);
                let (a, b) = correlated(rho, turn.cos(), turn.sin());
                candidates.push(with(
                    swimmer,
                    self.sphere_radius + dr * a,
                    self.chi + dchi * b,
                ));
            }
        } else {
            let places = |low: f64, high: f64| {
                let count = if high > low { steps } else { 0 };
                (0..=count)
                    .map(move |i| low + (high - low) * f64::from(i) / f64::from(count.max(1)))
            };
            for r in places(r_low, r_high) {
                candidates.extend(places(chi_low, chi_high).map(|chi| with(swimmer, r, chi)));
            }
        }
        let mut distinct: Vec<Swimmer<f64>> = Vec::new();
        for candidate in candidates {
            if !distinct.contains(&candidate) {
                distinct.push(candidate);
            }
        }
        distinct
    }

    /// Swimmers with weights that integrate over the normal distribution of r_s and χ: standard deviations from intervals
    /// and level, correlated where that is known. A sphere below nothing counts as none.
    pub(super) fn normal(&self, swimmer: &Swimmer<f64>) -> Vec<Weighted> {
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.level);
        let deviation = |[low, high]: [f64; 2]| 0.5 * (high - low) / quantile;
        let (dr, dchi) = (
            deviation(self.sphere_radius_interval),
            deviation(self.chi_interval),
        );
        let one = [(0.0, 1.0)];
        let rule = |deviation: f64| {
            if deviation > 0.0 {
                HERMITE.as_slice()
            } else {
                one.as_slice()
            }
        };
        let rho = self.correlation.unwrap_or(0.0);
        let mut weighted = Vec::with_capacity(HERMITE.len() * HERMITE.len());
        for &(z1, w1) in rule(dr) {
            for &(z2, w2) in rule(dchi) {
                let (a, b) = correlated(rho, z1, z2);
                let chi = (self.chi + dchi * b).max(1e-3 * self.chi);
                weighted.push((with(swimmer, self.sphere_radius + dr * a, chi), w1 * w2));
            }
        }
        weighted
    }
}

/// Two standard variables of this correlation from two independent ones.
fn correlated(rho: f64, z1: f64, z2: f64) -> (f64, f64) {
    (z1, rho * z1 + (1.0 - rho * rho).max(0.0).sqrt() * z2)
}

fn with(swimmer: &Swimmer<f64>, sphere_radius: f64, chi: f64) -> Swimmer<f64> {
    Swimmer {
        sphere_radius: sphere_radius.max(0.0),
        chi,
        ..*swimmer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide() -> Uncertainty {
        Uncertainty {
            sphere_radius_interval: [0.06, 0.08],
            chi_interval: [3.0, 4.2],
            correlation: Some(0.7),
            ..Uncertainty::none(0.07, 3.6)
        }
    }

    #[test]
    fn the_rule_has_the_moments_of_the_normal_distribution() {
        let members = wide().normal(&Swimmer::robot());
        let mean = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            members
                .iter()
                .map(|(s, w)| w * f(s.sphere_radius - 0.07, s.chi - 3.6))
                .sum()
        };
        let (dr, dchi) = (0.01 / 1.959_963_985, 0.6 / 1.959_963_985);
        assert!((mean(&|_, _| 1.0) - 1.0).abs() < 1e-14);
        assert!(mean(&|r, c| r + c).abs() < 1e-14);
        assert!((mean(&|r, _| r * r) / (dr * dr) - 1.0).abs() < 1e-8);
        assert!((mean(&|_, c| c * c) / (dchi * dchi) - 1.0).abs() < 1e-8);
        assert!((mean(&|r, c| r * c) / (0.7 * dr * dchi) - 1.0).abs() < 1e-8);
        assert!((mean(&|_, c| c.powi(4)) / (3.0 * dchi.powi(4)) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_ellipse_touches_the_intervals() {
        let points = wide().candidates(&Swimmer::robot(), 64);
        let (mut r, mut chi) = (0.0_f64, 0.0_f64);
        for point in &points {
            r = r.max(point.sphere_radius);
            chi = chi.max(point.chi);
        }
        assert!(
            (r - 0.08).abs() < 1e-12 && (chi - 4.2).abs() < 1e-3,
            "{r} {chi}"
        );
        let box_only = Uncertainty {
            correlation: None,
            ..wide()
        };
        assert_eq!(box_only.candidates(&Swimmer::robot(), 2).len(), 9);
        assert_eq!(
            Uncertainty::none(0.07, 3.6)
                .candidates(&Swimmer::robot(), 2)
                .len(),
            1
        );
        assert_eq!(
            Uncertainty::none(0.07, 3.6).normal(&Swimmer::robot()).len(),
            1
        );
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(wide().validate().is_ok());
        for wrong in [
            Uncertainty {
                chi_interval: [-1.0, 4.0],
                ..wide()
            },
            Uncertainty {
                chi_interval: [4.0, 3.0],
                ..wide()
            },
            Uncertainty {
                sphere_radius_interval: [f64::NAN, 0.1],
                ..wide()
            },
            Uncertainty {
                level: 1.0,
                ..wide()
            },
            Uncertainty {
                correlation: Some(1.5),
                ..wide()
            },
        ] {
            assert!(wrong.validate().is_err(), "{wrong:?}");
        }
    }
}
