//! The fastest gait of servos that give so much power.
//!
//! Under a limit on the power alone it is Lighthill's most efficient gait, run at constant power: `V = √(ξ P/(c_t L))` (paper,
//! definition of ξ). With a limit on the rate, too, each of the two problems that know one limit only bounds the speed from above;
//! where its gait respects the other limit, it is the answer. Where neither does, both limits bind on parts of the cycle, and what
//! is told is between which speeds the fastest gait lies.

use swimmer_files::Bounds;
use swimmer_model::{Gait, Model, Swimmer};

use super::{SpeedError, SpeedProblem};
use crate::{AtlasError, AtlasProblem, Objective, OptimalGait, Watch, atlas_watched};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerProblem {
    /// Whose gait.
    pub swimmer: Swimmer<f64>,
    /// Bounds on shapes; those of quarters (`min_angle`, `sector`) make no sense here.
    pub bounds: Bounds,
    /// The most that the joints may give at any instant, over the fluid's viscosity: P/μ \[m³/s²\].
    pub power_over_viscosity: f64,
    /// Largest |φ̇ᵢ| \[rad/s\], where the servos have one.
    pub rates: Option<[f64; 2]>,
    /// Threads to search with; the answer does not depend on it.
    pub threads: usize,
}

/// What keeps a gait from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Power.
    Power,
    /// Rate.
    Rate,
}

impl Limit {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Rate => "rate",
        }
    }
}

/// The fastest gait, and what limits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Limited {
    /// Which limit it runs at.
    pub limit: Limit,
    /// |d|/(L T) \[1/s\].
    pub speed_over_length: f64,
    /// |d|/L of a cycle.
    pub distance_over_length: f64,
    /// \[s\]
    pub period: f64,
    /// Most of P/μ that it takes at any instant \[m³/s²\].
    pub peak_power_over_viscosity: f64,
    /// Fastest turn of each joint \[rad/s\].
    pub peak_rates: [f64; 2],
    /// The gait, timed as it shall run, with the certificate of the problem that knows this limit alone.
    pub gait: OptimalGait,
}

/// Why there is no such gait.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PowerError {
    /// A power is none.
    #[error("servos cannot give at most {power} W for each Pa s; give a power above 0")]
    Power {
        /// P/μ as it was given \[m³/s²\].
        power: f64,
    },
    /// The search at constant power.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    /// The search at the servos' rates.
    #[error(transparent)]
    Speed(#[from] SpeedError),
    /// Nothing certified was found.
    #[error("no most efficient gait was found under these bounds ({bounds}); try other bounds")]
    NoGait {
        /// The bounds.
        bounds: Bounds,
    },
    /// Neither single limit tells the answer.
    #[error(
        "power and rate both limit the fastest gait, each on a part of the cycle, and such gaits are not searched for: it makes at \
         least {least:.6} and at most {most:.6} body lengths a second; leave out one limit, or raise one until the other alone binds"
    )]
    BothBind {
        /// |d|/(L T) of a gait within both limits \[1/s\].
        least: f64,
        /// Of the slower one of the two gaits that respect one limit each \[1/s\].
        most: f64,
    },
}

/// Starts of the search for the most efficient gait.
const STARTS: usize = 64;

/// A share by which rounding may take a gait beyond a limit.
const ROUNDING: f64 = 1e-9;

/// Finds the fastest gait that keeps within a power, and within the servos' rates where they are given.
///
/// # Errors
/// [`PowerError`]: what makes no sense, or why there is no answer.
///
/// ```
/// use gait_optimizer::{Bounds, Limit, PowerProblem, fastest_on_power};
/// use swimmer_model::Swimmer;
///
/// let problem = PowerProblem {
///     swimmer: Swimmer::purcell(),
///     bounds: Bounds { max_angle: Some(1.5), ..Bounds::default() },
///     power_over_viscosity: 1.0,
///     rates: None,
///     threads: 1,
/// };
/// let weak = fastest_on_power(&problem, &|_| ())?;
/// let strong = fastest_on_power(&PowerProblem { power_over_viscosity: 4.0, ..problem }, &|_| ())?;
/// assert_eq!(weak.limit, Limit::Power);
/// assert!((strong.speed_over_length / weak.speed_over_length - 2.0).abs() < 1e-9, "speed goes with the root of the power");
/// # Ok::<(), gait_optimizer::PowerError>(())
/// ```
pub fn fastest_on_power(problem: &PowerProblem, watch: Watch<'_>) -> Result<Limited, PowerError> {
    let power = problem.power_over_viscosity;
    if !(power > 0.0 && power.is_finite()) {
        return Err(PowerError::Power { power });
    }
    let on_power = problem.most_efficient(watch)?;
    let Some(rates) = problem.rates else {
        return Ok(on_power);
    };
    let too_fast = on_power.beyond(rates);
    if too_fast <= 1.0 + ROUNDING {
        return Ok(on_power);
    }
    let at_rate = problem.at_rate(rates, watch)?;
    let too_strong = (at_rate.peak_power_over_viscosity / power).sqrt();
    if too_strong <= 1.0 + ROUNDING {
        return Ok(at_rate);
    }
    let [weak, slow] = [&on_power, &at_rate].map(|found| found.speed_over_length);
    Err(PowerError::BothBind {
        least: (weak / too_fast).max(slow / too_strong),
        most: weak.min(slow),
    })
}

impl PowerProblem {
    /// Under the limit on the power alone.
    fn most_efficient(&self, watch: Watch<'_>) -> Result<Limited, PowerError> {
        let asked = AtlasProblem {
            bounds: self.bounds,
            starts: STARTS,
            threads: self.threads,
            ..AtlasProblem::new(self.swimmer, Objective::Efficiency)
        };
        let atlas = atlas_watched(&asked, watch)?;
        let no_gait = || PowerError::NoGait {
            bounds: self.bounds,
        };
        let best = atlas.optima.into_iter().next().ok_or_else(no_gait)?;
        let length = self.swimmer.total_length();
        let drag = self.swimmer.side_drag();
        let speed = (best.gait.efficiency * self.power_over_viscosity / (drag * length)).sqrt();
        let speed_over_length = speed / length;
        let period = best.distance_over_length / speed_over_length;
        self.limited(Limit::Power, best.gait, best.distance_over_length, period)
            .ok_or_else(no_gait)
    }

    /// Under the limits on the rates alone.
    fn at_rate(&self, rates: [f64; 2], watch: Watch<'_>) -> Result<Limited, PowerError> {
        let asked = SpeedProblem {
            bounds: self.bounds,
            threads: self.threads,
            ..SpeedProblem::new(self.swimmer, rates)
        };
        let found = asked.watched(watch)?;
        self.limited(
            Limit::Rate,
            found.gait,
            found.distance_over_length,
            found.period,
        )
        .ok_or(PowerError::NoGait {
            bounds: self.bounds,
        })
    }

    /// A gait with what it takes of either limit in this period.
    fn limited(
        &self,
        limit: Limit,
        gait: OptimalGait,
        distance_over_length: f64,
        period: f64,
    ) -> Option<Limited> {
        let model = Model::new(&self.swimmer).ok()?;
        let curve = gait.gait().ok()?;
        let (mut power, mut peaks) = (0.0_f64, [0.0_f64; 2]);
        // Between the samples: at a corner the rate jumps.
        for pair in gait.u().windows(2) {
            let &[from, to] = pair else { continue };
            for share in [0.02, 0.5, 0.98] {
                let point = curve.at(from + share * (to - from));
                let rate = point.rate / period;
                power = power.max((model.power_matrix(&point.phi) * rate).dot(&rate));
                for (peak, rate) in peaks.iter_mut().zip(rate.iter()) {
                    *peak = peak.max(rate.abs());
                }
            }
        }
        Some(Limited {
            limit,
            speed_over_length: distance_over_length / period,
            distance_over_length,
            period,
            peak_power_over_viscosity: power,
            peak_rates: peaks,
            gait,
        })
    }
}

impl Limited {
    /// The largest share of these rates that it takes.
    fn beyond(&self, rates: [f64; 2]) -> f64 {
        let shares = self.peak_rates.iter().zip(rates);
        shares.map(|(peak, rate)| peak / rate).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::{Circle, Stroke, Tolerance, swim};

    fn asked(power_over_viscosity: f64, rates: Option<[f64; 2]>) -> PowerProblem {
        PowerProblem {
            swimmer: Swimmer::robot(),
            bounds: Bounds {
                max_angle: Some(2.0),
                ..Bounds::default()
            },
            power_over_viscosity,
            rates,
            threads: 1,
        }
    }

    fn swum<G: Gait<f64>>(gait: &G) -> Stroke<f64> {
        let model = Model::new(&Swimmer::robot()).unwrap();
        swim(&model, gait, &Tolerance::default())
    }

    /// By the model's own integration of what is played: the power is used up and constant, and no circle is as fast on it.
    #[test]
    fn the_power_is_used_up() {
        let found = fastest_on_power(&asked(2e-3, None), &|_| ()).unwrap();
        assert_eq!(found.limit, Limit::Power);
        assert!(found.gait.certificate.pass());
        let stroke = swum(&found.gait.gait().unwrap());
        let mean = stroke.energy / found.period.powi(2);
        assert!((mean / 2e-3 - 1.0).abs() < 1e-6, "{mean}");
        assert!(
            (found.peak_power_over_viscosity / 2e-3 - 1.0).abs() < 1e-3,
            "{found:?}"
        );
        let speed = stroke.displacement.norm() / stroke.total_length / found.period;
        assert!(
            (speed / found.speed_over_length - 1.0).abs() < 1e-7,
            "{speed}"
        );
        for tenths in 1..20 {
            let circle = swum(&Circle {
                amplitude: f64::from(tenths) * 0.1,
            });
            let period = circle.power_length / 2e-3_f64.sqrt();
            let speed = circle.displacement.norm() / circle.total_length / period;
            assert!(speed < found.speed_over_length, "{tenths}: {speed}");
        }
    }

    /// Each limit is the answer's where the other is far; between them, what is told holds for either, and wider rates are no slower.
    #[test]
    fn one_limit_binds_or_both() {
        let rates = [1.0; 2];
        let at_rate = crate::fastest(&SpeedProblem {
            bounds: asked(1.0, None).bounds,
            ..SpeedProblem::new(Swimmer::robot(), rates)
        });
        let at_rate = at_rate.unwrap().speed_over_length;
        let on_power = |power| {
            let found = fastest_on_power(&asked(power, None), &|_| ()).unwrap();
            found.speed_over_length
        };
        let mut kinds = Vec::new();
        let mut before = 0.0;
        for exponent in -8..=2 {
            let power = 10.0_f64.powf(f64::from(exponent) * 0.5);
            let (kind, least) = match fastest_on_power(&asked(power, Some(rates)), &|_| ()) {
                Ok(found) => {
                    let alone = match found.limit {
                        Limit::Power => on_power(power),
                        Limit::Rate => at_rate,
                    };
                    assert_eq!(found.speed_over_length.to_bits(), alone.to_bits());
                    assert!(found.beyond(rates) <= 1.0 + 1e-6);
                    assert!(found.peak_power_over_viscosity <= power * (1.0 + 1e-3));
                    (found.limit.word(), found.speed_over_length)
                }
                Err(PowerError::BothBind { least, most }) => {
                    assert!(least < most && most <= at_rate.min(on_power(power)) * (1.0 + 1e-12));
                    ("both", least)
                }
                Err(other) => panic!("{other}"),
            };
            assert!(least >= before, "{power}: {least} after {before}");
            before = least;
            kinds.push(kind);
        }
        kinds.dedup();
        assert_eq!(kinds, ["power", "both", "rate"]);
    }

    #[test]
    fn no_power_is_refused() {
        for power in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = fastest_on_power(&asked(power, None), &|_| ());
            assert!(matches!(refused, Err(PowerError::Power { .. })));
        }
    }
}
