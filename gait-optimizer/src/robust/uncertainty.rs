//! What is known of r_s and χ, as the swimmers that a robust gait is held against.
//!
//! A calibration fits r_s and ln χ: its interval of χ is χ·exp(±d), and its correlation is that of r_s and ln χ. So
//! everything here lives in the plane of r_s and ln χ, where χ stays above 0 by itself.

use statrs::distribution::{ContinuousCDF, Normal};
use swimmer_model::Swimmer;

use super::RobustError;

/// Estimates of r_s and χ with their intervals, as a calibration finds them.
///
/// Intervals need not be even: on each side of its estimate an interval has its own half width, in r_s and in ln χ. An
/// interval of r_s that begins at 0 was cut there: it is as wide below the estimate as above, and a sphere below nothing
/// counts as none.
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
    /// Correlation of r_s and ln χ where it is known; then the worst case is looked for on the ellipse that touches the
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
            if !(estimate.is_finite() && low.is_finite() && high.is_finite() && low <= high) {
                return wrong(name, low, "give two finite numbers, the lower one first");
            }
            // Files may round.
            let slack = 1e-6 * high.abs();
            if estimate < low - slack || estimate > high + slack {
                return wrong(name, low, "the estimate must lie within it");
            }
            Ok(())
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

    /// Half widths of the interval of r_s, below and above the estimate \[m\].
    fn radius_widths(&self) -> [f64; 2] {
        let [low, high] = self.sphere_radius_interval;
        let above = (high - self.sphere_radius).max(0.0);
        let below = (self.sphere_radius - low).max(0.0);
        [if low <= 0.0 { below.max(above) } else { below }, above]
    }

    /// The same of ln χ.
    fn log_chi_widths(&self) -> [f64; 2] {
        let [low, high] = self.chi_interval;
        [
            (self.chi / low).ln().max(0.0),
            (high / self.chi).ln().max(0.0),
        ]
    }

    /// Correlation, where there are two to correlate.
    fn rho(&self) -> Option<f64> {
        let open = |widths: [f64; 2]| widths[0] + widths[1] > 0.0;
        let both = open(self.radius_widths()) && open(self.log_chi_widths());
        self.correlation.map(|rho| if both { rho } else { 0.0 })
    }

    /// The swimmer so far from the estimates.
    fn off(&self, swimmer: &Swimmer<f64>, radius: f64, log_chi: f64) -> Swimmer<f64> {
        with(
            swimmer,
            self.sphere_radius + radius,
            self.chi * log_chi.exp(),
        )
    }

    /// Swimmers among which the worst is looked for: a grid of so many steps over the box, or as many times eight points of
    /// the ellipse's border and its centre. (With 32 points the worst of the border is met to half a per cent of the
    /// half widths.)
    pub(super) fn candidates(&self, swimmer: &Swimmer<f64>, steps: u32) -> Vec<Swimmer<f64>> {
        let mut candidates = vec![self.nominal(swimmer)];
        if let Some(rho) = self.rho() {
            for point in 0..8 * steps {
                let turn = std::f64::consts::TAU * f64::from(point) / f64::from(8 * steps);
                let (a, b) = correlated(rho, turn.cos(), turn.sin());
                candidates.push(self.off(
                    swimmer,
                    scaled(self.radius_widths(), a),
                    scaled(self.log_chi_widths(), b),
                ));
            }
        } else {
            let places = |widths: [f64; 2]| {
                let count = if widths[0] + widths[1] > 0.0 {
                    steps
                } else {
                    0
                };
                (0..=count).map(move |i| {
                    let share = f64::from(2 * i) / f64::from(steps.max(1)) - 1.0;
                    scaled(widths, if count > 0 { share } else { 0.0 })
                })
            };
            for radius in places(self.radius_widths()) {
                let logs = places(self.log_chi_widths());
                candidates.extend(logs.map(|log| self.off(swimmer, radius, log)));
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

    /// Swimmers with weights that integrate over a normal distribution of r_s and ln χ about the estimates: standard
    /// deviations from intervals and level, correlated where that is known. Of uneven sides the mean counts. A sphere below
    /// nothing counts as none.
    ///
    /// An interval does not tell its degrees of freedom, so the deviation is taken as if they were many: half width over the
    /// normal quantile. A calibration's intervals are Student's, wider for few runs: there the deviation comes out larger than the
    /// standard error, and the mean is taken over a wider spread than the fit's own.
    pub(super) fn normal(&self, swimmer: &Swimmer<f64>) -> Vec<Weighted> {
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.level);
        let deviation = |[below, above]: [f64; 2]| 0.5 * (below + above) / quantile;
        let (dr, dchi) = (
            deviation(self.radius_widths()),
            deviation(self.log_chi_widths()),
        );
        let one = [(0.0, 1.0)];
        let rule = |deviation: f64| {
            if deviation > 0.0 {
                HERMITE.as_slice()
            } else {
                one.as_slice()
            }
        };
        let rho = self.rho().unwrap_or(0.0);
        let mut weighted = Vec::with_capacity(HERMITE.len() * HERMITE.len());
        for &(z1, w1) in rule(dr) {
            for &(z2, w2) in rule(dchi) {
                let (a, b) = correlated(rho, z1, z2);
                weighted.push((self.off(swimmer, dr * a, dchi * b), w1 * w2));
            }
        }
        weighted
    }
}

/// A standard variable in units of the half width on its side.
fn scaled([below, above]: [f64; 2], z: f64) -> f64 {
    z * if z < 0.0 { below } else { above }
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
            chi_interval: [3.6 * (-0.15_f64).exp(), 3.6 * 0.15_f64.exp()],
            correlation: Some(0.7),
            ..Uncertainty::none(0.07, 3.6)
        }
    }

    /// As a calibration gives them: about χ by a factor, about r_s by a length, never below nothing.
    fn fitted(chi: f64, [low, high]: [f64; 2], correlation: Option<f64>) -> Uncertainty {
        Uncertainty {
            sphere_radius_interval: [0.0, 0.05],
            chi_interval: [low, high],
            correlation,
            ..Uncertainty::none(0.02, chi)
        }
    }

    #[test]
    fn the_rule_has_the_moments_of_the_normal_distribution() {
        let members = wide().normal(&Swimmer::robot());
        let mean = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            members
                .iter()
                .map(|(s, w)| w * f(s.sphere_radius - 0.07, (s.chi / 3.6).ln()))
                .sum()
        };
        let quantile = 1.959_963_984_540_054;
        let (dr, dchi) = (0.01 / quantile, 0.15 / quantile);
        assert!((mean(&|_, _| 1.0) - 1.0).abs() < 1e-14);
        assert!(mean(&|r, c| r + c).abs() < 1e-14);
        assert!((mean(&|r, _| r * r) / (dr * dr) - 1.0).abs() < 1e-8);
        assert!((mean(&|_, c| c * c) / (dchi * dchi) - 1.0).abs() < 1e-8);
        assert!((mean(&|r, c| r * c) / (0.7 * dr * dchi) - 1.0).abs() < 1e-8);
        assert!((mean(&|_, c| c.powi(4)) / (3.0 * dchi.powi(4)) - 1.0).abs() < 1e-8);
        // A χ known to a factor of three has no swimmers of no χ, nor any that a floor made.
        let open = fitted(5.16, [1.55, 17.1], Some(-0.9)).normal(&Swimmer::robot());
        let logs = open.iter().map(|(s, w)| w * s.chi.ln());
        assert!((logs.sum::<f64>() - 5.16_f64.ln()).abs() < 1e-12);
        // An exact r_s leaves χ its whole spread, whatever the correlation.
        let alone = Uncertainty {
            sphere_radius_interval: [0.07; 2],
            ..wide()
        };
        let spread = alone.normal(&Swimmer::robot());
        let spread = spread.iter().map(|(s, w)| w * (s.chi / 3.6).ln().powi(2));
        assert!((spread.sum::<f64>() / (dchi * dchi) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_swimmers_touch_the_intervals_and_never_leave_them() {
        let tilted = Uncertainty {
            sphere_radius_interval: [0.065, 0.09],
            chi_interval: [3.5, 6.0],
            ..wide()
        };
        let mut cases = vec![wide(), tilted];
        for correlation in [None, Some(0.0), Some(0.95), Some(-0.8), Some(1.0)] {
            cases.push(fitted(3.675, [2.437, 5.541], correlation));
            cases.push(fitted(5.16, [1.55, 17.1], correlation));
        }
        for case in cases {
            let points = case.candidates(&Swimmer::robot(), 64);
            let ends = |of: &dyn Fn(&Swimmer<f64>) -> f64| {
                let of = points.iter().map(of);
                of.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                    [low.min(v), high.max(v)]
                })
            };
            let close = |[low, high]: [f64; 2], [from, to]: [f64; 2]| {
                let slack = 1e-3 * (to - from);
                low >= from * (1.0 - 1e-12)
                    && high <= to * (1.0 + 1e-12)
                    && low < from + slack
                    && high > to - slack
            };
            let (r, chi) = (ends(&|s| s.sphere_radius), ends(&|s| s.chi));
            assert!(close(r, case.sphere_radius_interval), "{case:?} {r:?}");
            assert!(close(chi, case.chi_interval), "{case:?} {chi:?}");
        }
        let count = |case: Uncertainty| case.candidates(&Swimmer::robot(), 2).len();
        let box_only = Uncertainty {
            correlation: None,
            ..wide()
        };
        assert_eq!(count(box_only), 9);
        assert_eq!(count(Uncertainty::none(0.07, 3.6)), 1);
        let exact = Uncertainty::none(0.07, 3.6).normal(&Swimmer::robot());
        assert_eq!(exact.len(), 1);
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
            Uncertainty { chi: 9.0, ..wide() },
            Uncertainty {
                sphere_radius: 0.01,
                ..wide()
            },
        ] {
            assert!(wrong.validate().is_err(), "{wrong:?}");
        }
    }
}
