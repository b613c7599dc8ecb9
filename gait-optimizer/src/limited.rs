//! The fastest gait of servos whose rates, power or torque are limited.
//!
//! Under a limit on the power alone it is Lighthill's most efficient gait, run at constant power: `V = √(ξ P/(c_t L))` (paper,
//! definition of ξ); under limits on the rates alone it is [`fastest`](crate::fastest())'s. A gait of either kind that keeps within
//! the other limits is the answer. Else several limits bind, each on its part of the cycle: rough polygons near many starts lead
//! to curves whose phases tell what binds (`speed::phases`), and the certificate works out the costate from the curve.

mod mixed;
#[cfg(test)]
mod tests;

use swimmer_files::{Bounds, Objective};
use swimmer_model::{Gait, Model, Swimmer};

use crate::atlas::{AtlasError, AtlasProblem, atlas_watched};
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::problem::{GaitClass, InvalidProblem, validated};
use crate::speed::gauge::Facet;
use crate::speed::{SpeedError, SpeedProblem, validate};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedProblem {
    /// Whose gait.
    pub swimmer: Swimmer<f64>,
    /// Bounds on shapes; those of quarters (`min_angle`, `sector`) make no sense here.
    pub bounds: Bounds,
    /// The most that the joints together may give at any instant, over the fluid's viscosity: P/μ \[m³/s²\].
    pub power_over_viscosity: Option<f64>,
    /// Largest |φ̇ᵢ| \[rad/s\].
    pub rates: Option<[f64; 2]>,
    /// The most that each joint may give.
    pub torque: Option<Torque>,
    /// Threads to search with; the answer does not depend on it.
    pub threads: usize,
}

/// What a servo can give: less the faster it turns, |τ| ≤ stall (1 − |φ̇|/no load).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    /// The torque of a servo that stands still, over the fluid's viscosity: τ/μ \[m³/s\].
    pub stall_over_viscosity: f64,
    /// The rate without a load \[rad/s\].
    pub no_load_rate: f64,
}

/// What keeps a gait from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Power.
    Power,
    /// Rate.
    Rate,
    /// Torque.
    Torque,
}

impl Limit {
    const ALL: [Self; 3] = [Self::Power, Self::Rate, Self::Torque];

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Rate => "rate",
            Self::Torque => "torque",
        }
    }
}

/// The fastest gait, and what limits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Limited {
    /// The limits that bind, each with its share of the period; several may bind at once.
    pub limits: Vec<(Limit, f64)>,
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
    /// Most of each joint's |τ|/μ \[m³/s\].
    pub peak_torques_over_viscosity: [f64; 2],
    /// By what share the speed differed on half as many elements, where several limits bind and it could be had on both.
    pub refinement: Option<f64>,
    /// |d|/(L T) of a faster gait that failed its certificate, or at least of what a faster polygon lies near where none was found:
    /// none where the answer is the fastest that was met.
    pub uncertified: Option<f64>,
    /// The gait, timed as it shall run, with its certificate.
    pub gait: OptimalGait,
}

/// Why there is no such gait.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitedError {
    /// A power is none.
    #[error("servos cannot give at most {power} W for each Pa s; give a power above 0")]
    Power {
        /// P/μ as it was given \[m³/s²\].
        power: f64,
    },
    /// A torque is none.
    #[error(
        "servos cannot give at most {} N m for each Pa s and turn at {} rad/s without a load; give both above 0",
        torque.stall_over_viscosity,
        torque.no_load_rate
    )]
    Torque {
        /// As it was given.
        torque: Torque,
    },
    /// Nothing limits the servos.
    #[error("without a limit no gait is the fastest; give a power, a rate or a torque")]
    Unlimited,
    /// The problem makes no sense.
    #[error(transparent)]
    Problem(#[from] InvalidProblem),
    /// The search at constant power.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    /// The search at the servos' rates.
    #[error(transparent)]
    Speed(#[from] SpeedError),
    /// Nothing certified was found.
    #[error(
        "no fastest gait was found and certified under these bounds ({bounds}){}{}; try other bounds, or leave out a limit",
        between.map_or_else(String::new, |[least, most]| format!(
            ": it makes at least {least:.6} and at most {most:.6} body lengths a second, but several limits bind, each on its part of \
             the cycle"
        )),
        uncertified.map_or_else(String::new, |speed| format!(" (the fastest that meets not all conditions makes {speed:.6})"))
    )]
    NoGait {
        /// The bounds.
        bounds: Bounds,
        /// Of gaits that know one limit each: the fastest, slowed down until it keeps within all limits, and the slowest, as it is
        /// \[1/s\].
        between: Option<[f64; 2]>,
        /// |d|/(L T) of the fastest gait that was found and failed its certificate \[1/s\].
        uncertified: Option<f64>,
    },
}

/// Starts of each search.
const STARTS: usize = 64;
/// A share by which rounding may take a gait beyond a limit.
const ROUNDING: f64 = 1e-9;
/// A limit binds where the gait takes this share of it.
const BINDS: f64 = 1.0 - 1e-6;
/// Finds the fastest gait that keeps within limits on power, rates and torque, as far as they are given.
///
/// # Errors
/// [`LimitedError`]: what makes no sense, or why there is no answer.
///
/// ```
/// use gait_optimizer::{Bounds, Limit, LimitedProblem, fastest_within};
/// use swimmer_model::Swimmer;
///
/// let problem = LimitedProblem {
///     swimmer: Swimmer::purcell(),
///     bounds: Bounds { max_angle: Some(1.5), ..Bounds::default() },
///     power_over_viscosity: Some(1.0),
///     rates: None,
///     torque: None,
///     threads: 1,
/// };
/// let weak = fastest_within(&problem, &|_| ())?;
/// let strong = fastest_within(&LimitedProblem { power_over_viscosity: Some(4.0), ..problem }, &|_| ())?;
/// assert_eq!(weak.limits[0].0, Limit::Power);
/// assert!((strong.speed_over_length / weak.speed_over_length - 2.0).abs() < 1e-9, "speed goes with the root of the power");
/// # Ok::<(), gait_optimizer::LimitedError>(())
/// ```
pub fn fastest_within(problem: &LimitedProblem, watch: Watch<'_>) -> Result<Limited, LimitedError> {
    problem.validate()?;
    let mut singles = Vec::new();
    if let Some(power) = problem.power_over_viscosity {
        singles.push((Limit::Power, problem.most_efficient(power, watch)?));
    }
    if let Some(rates) = problem.rates {
        singles.push((Limit::Rate, problem.at_rate(rates, watch)?));
    }
    // Who keeps within all limits though one alone was asked for is the fastest of all.
    let within = |(own, found): &&(Limit, Limited)| {
        problem.beyond(found, |limit| limit != *own) <= 1.0 + ROUNDING
    };
    if let Some((_, found)) = singles.iter().find(within) {
        return Ok(found.clone());
    }
    let singles: Vec<Limited> = singles.into_iter().map(|(_, found)| found).collect();
    problem.mixed(&singles, watch)
}

impl LimitedProblem {
    fn validate(&self) -> Result<(), LimitedError> {
        let is_one = |value: f64| value > 0.0 && value.is_finite();
        if let Some(power) = self.power_over_viscosity.filter(|power| !is_one(*power)) {
            return Err(LimitedError::Power { power });
        }
        if let Some(torque) = self.torque
            && !(is_one(torque.stall_over_viscosity) && is_one(torque.no_load_rate))
        {
            return Err(LimitedError::Torque { torque });
        }
        if (self.power_over_viscosity, self.rates, self.torque) == (None, None, None) {
            return Err(LimitedError::Unlimited);
        }
        validate(&SpeedProblem {
            bounds: self.bounds,
            ..SpeedProblem::new(self.swimmer, self.rates.unwrap_or([1.0; 2]))
        })?;
        validated(&self.swimmer, &self.bounds, GaitClass::Closed)?;
        Ok(())
    }

    /// The limits, in the model's own units, each with its kind.
    fn facets(&self) -> Vec<(Limit, Facet)> {
        let kind = |kind: Limit| move |facet: Facet| (kind, facet);
        let mut all = Vec::new();
        if let Some(rates) = self.rates {
            all.extend(Facet::of_rates(rates).map(kind(Limit::Rate)));
        }
        if let Some(power) = self.power_over_viscosity {
            all.push((Limit::Power, Facet::Power { power }));
        }
        if let Some(torque) = self.torque {
            let facets = Facet::of_torque(torque.stall_over_viscosity, torque.no_load_rate);
            all.extend(facets.map(kind(Limit::Torque)));
        }
        all
    }

    /// The largest share of any of these limits that a gait takes.
    fn beyond(&self, found: &Limited, of: impl Fn(Limit) -> bool) -> f64 {
        let mut most = 0.0_f64;
        let facets = self.facets();
        if let (Ok(model), Ok(gait)) = (Model::new(&self.swimmer), found.gait.gait()) {
            each_place(&found.gait, |u, _| {
                let point = gait.at(u);
                let (power, rate) = (model.power_matrix(&point.phi), point.rate / found.period);
                for (_, facet) in facets.iter().filter(|(limit, _)| of(*limit)) {
                    most = most.max(facet.value(&power, &rate));
                }
            });
        }
        most
    }

    /// Under the limit on the power alone.
    fn most_efficient(&self, power: f64, watch: Watch<'_>) -> Result<Limited, LimitedError> {
        let asked = AtlasProblem {
            bounds: self.bounds,
            starts: STARTS,
            threads: self.threads,
            ..AtlasProblem::new(self.swimmer, Objective::Efficiency)
        };
        let best = atlas_watched(&asked, watch)?.optima.into_iter().next();
        let best = best.ok_or_else(|| self.no_gait(&[], None))?;
        let length = self.swimmer.total_length();
        let speed = (best.gait.efficiency * power / (self.swimmer.side_drag() * length)).sqrt();
        let period = best.distance_over_length * length / speed;
        self.limited(best.gait, best.distance_over_length, period)
    }

    /// Under the limits on the rates alone.
    fn at_rate(&self, rates: [f64; 2], watch: Watch<'_>) -> Result<Limited, LimitedError> {
        let asked = SpeedProblem {
            bounds: self.bounds,
            threads: self.threads,
            ..SpeedProblem::new(self.swimmer, rates)
        };
        let found = asked.watched(watch)?;
        self.limited(found.gait, found.distance_over_length, found.period)
    }

    fn no_gait(&self, singles: &[Limited], uncertified: Option<f64>) -> LimitedError {
        let within = |one: &Limited| one.speed_over_length / self.beyond(one, |_| true).max(1.0);
        let least = singles.iter().map(within).fold(0.0, f64::max);
        let speeds = singles.iter().map(|one| one.speed_over_length);
        LimitedError::NoGait {
            bounds: self.bounds,
            between: (!singles.is_empty()).then(|| [least, speeds.fold(f64::INFINITY, f64::min)]),
            uncertified,
        }
    }

    /// A gait with what it takes of each limit in this period.
    fn limited(
        &self,
        gait: OptimalGait,
        distance_over_length: f64,
        period: f64,
    ) -> Result<Limited, LimitedError> {
        let (Ok(model), Ok(curve)) = (Model::new(&self.swimmer), gait.gait()) else {
            return Err(self.no_gait(&[], None));
        };
        let facets = self.facets();
        let (mut most, mut rates, mut torques) = (0.0_f64, [0.0_f64; 2], [0.0_f64; 2]);
        let mut shares = Limit::ALL.map(|limit| (limit, 0.0));
        each_place(&gait, |u, share| {
            let point = curve.at(u);
            let rate = point.rate / period;
            let power = model.power_matrix(&point.phi);
            let torque = power * rate;
            most = most.max(torque.dot(&rate));
            for joint in 0..2 {
                rates[joint] = rates[joint].max(rate[joint].abs());
                torques[joint] = torques[joint].max(torque[joint].abs());
            }
            for (limit, taken) in &mut shares {
                let mut own = facets.iter().filter(|(kind, _)| kind == limit);
                if own.any(|(_, facet)| facet.value(&power, &rate) >= BINDS) {
                    *taken += share;
                }
            }
        });
        Ok(Limited {
            limits: shares
                .into_iter()
                .filter(|(_, share)| *share > 0.0)
                .collect(),
            speed_over_length: distance_over_length / period,
            distance_over_length,
            period,
            peak_power_over_viscosity: most,
            peak_rates: rates,
            peak_torques_over_viscosity: torques,
            refinement: None,
            uncertified: None,
            gait,
        })
    }
}

/// Places between the samples of a gait, as at a corner the rate jumps, each with the share of the period that it stands for.
fn each_place(gait: &OptimalGait, mut then: impl FnMut(f64, f64)) {
    for pair in gait.u().windows(2) {
        let &[from, to] = pair else { continue };
        for (share, weight) in [(0.02, 0.25), (0.5, 0.5), (0.98, 0.25)] {
            then(from + share * (to - from), weight * (to - from));
        }
    }
}
