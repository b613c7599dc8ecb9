//! Uncertainty of r_s, χ and the servos' gain, and the set of swimmers that represents it.
//!
//! A calibration fits r_s and ln χ: its interval of χ is χ·exp(±d), and its correlation is that of r_s and ln χ. So the
//! uncertainty is defined in the plane of r_s and ln χ, where χ stays positive. The gain has an interval of its own.

#[cfg(test)]
mod tests;

use statrs::distribution::{ContinuousCDF, Normal};
use swimmer_model::{InvalidSwimmer, Swimmer};

use super::RobustError;
use crate::member::Member;

/// Estimates of r_s and χ with their intervals, as a calibration finds them, and what may be off about the servos.
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
    /// Interval about 1 of the servos' gain: actual over commanded angle. Shapes scale with it, while bounds on angles and rates
    /// apply to the commanded shapes. An estimate other than 1 belongs into the servo map.
    pub gain_interval: [f64; 2],
    /// Level of all.
    pub level: f64,
    /// Correlation of r_s and ln χ where it is known; then the worst case is looked for on the ellipse that touches the
    /// intervals' borders, else in their box.
    pub correlation: Option<f64>,
}

/// One coordinate of all that is left open.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    from: f64,
    to: f64,
    /// Steps of the grid; 0 if nothing is uncertain.
    steps: u32,
    /// `true` if both ends are the same point.
    round: bool,
}

impl Axis {
    const fn new(from: f64, to: f64, steps: u32) -> Self {
        let round = false;
        Self {
            from,
            to,
            steps,
            round,
        }
    }

    fn grid(self) -> impl Iterator<Item = f64> + Clone {
        let last = self.steps - u32::from(self.round);
        (0..=last).map(move |i| {
            let share = f64::from(i) / f64::from(self.steps.max(1));
            self.from + (self.to - self.from) * share
        })
    }

    /// Halfway to the grid's neighbour; 0 where nothing is open.
    pub(super) fn half_step(self) -> f64 {
        0.5 * (self.to - self.from) / f64::from(self.steps.max(1))
    }

    /// A coordinate, or where it ends.
    pub(super) fn within(self, at: f64) -> f64 {
        if self.round {
            at
        } else {
            at.clamp(self.from, self.to)
        }
    }
}

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
            gain_interval: [1.0; 2],
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
            "fit's interval of r_s [m]",
            self.sphere_radius,
            self.sphere_radius_interval,
        )?;
        interval("fit's interval of χ", self.chi, self.chi_interval)?;
        interval("interval of the gain, about 1,", 1.0, self.gain_interval)?;
        let ([gain, _], [chi, _]) = (self.gain_interval, self.chi_interval);
        let chi = chi.min(self.chi);
        let rho = self.correlation.unwrap_or(0.0);
        for (holds, name, value, problem) in [
            (
                gain > 0.0,
                "gain",
                gain,
                "its whole interval must be above 0",
            ),
            (
                chi > 0.0,
                "fit's χ",
                chi,
                "χ and its whole interval must be above 0",
            ),
            (
                self.level > 0.0 && self.level < 1.0,
                "fit's level",
                self.level,
                "give a share between 0 and 1, as 0.95",
            ),
            (
                rho.abs() <= 1.0,
                "fit's correlation",
                rho,
                "a correlation lies between -1 and 1",
            ),
        ] {
            if !holds {
                return wrong(name, value, problem);
            }
        }
        Ok(())
    }

    /// Half widths of the intervals, below and above the estimates: of r_s \[m\], of ln χ and of the gain.
    fn widths(&self) -> [[f64; 2]; 3] {
        let around = |estimate: f64, [low, high]: [f64; 2]| {
            [(estimate - low).max(0.0), (high - estimate).max(0.0)]
        };
        let [mut below, above] = around(self.sphere_radius, self.sphere_radius_interval);
        if self.sphere_radius_interval[0] <= 0.0 {
            below = below.max(above);
        }
        let [low, high] = self.chi_interval;
        let log_chi = [(self.chi / low).ln(), (high / self.chi).ln()];
        [
            [below, above],
            log_chi.map(|width| width.max(0.0)),
            around(1.0, self.gain_interval),
        ]
    }

    /// Correlation, if both parameters are uncertain.
    fn rho(&self) -> Option<f64> {
        let [radius, log_chi, _] = self.widths();
        let both = is_open(radius) && is_open(log_chi);
        self.correlation.map(|rho| if both { rho } else { 0.0 })
    }

    /// `true` if the gain is uncertain.
    pub(super) fn gain_is_open(&self) -> bool {
        is_open(self.widths()[2])
    }

    /// The swimmer at this offset from the estimates, in r_s \[m\], ln χ and gain. A negative sphere radius counts as 0.
    fn off(
        &self,
        swimmer: &Swimmer<f64>,
        [radius, log_chi, gain]: [f64; 3],
    ) -> Result<Member, InvalidSwimmer> {
        let swimmer = Swimmer {
            sphere_radius: (self.sphere_radius + radius).max(0.0),
            chi: self.chi * log_chi.exp(),
            ..*swimmer
        };
        Member::new(&swimmer, 1.0 + gain)
    }

    /// The coordinates of all that is left open: of the ellipse radius and turn, else both half widths; and the gain's.
    pub(super) fn axes(&self) -> [Axis; 3] {
        let side = |widths, steps| {
            if is_open(widths) {
                Axis::new(-1.0, 1.0, steps)
            } else {
                Axis::new(0.0, 0.0, 0)
            }
        };
        let [radius, log_chi, gain] = self.widths();
        let gain = side(gain, GAIN_STEPS);
        match self.rho() {
            Some(_) => {
                let turn = Axis {
                    round: true,
                    ..Axis::new(0.0, std::f64::consts::TAU, 8 * STEPS)
                };
                [Axis::new(0.0, 1.0, 1), turn, gain]
            }
            None => [side(radius, STEPS), side(log_chi, STEPS), gain],
        }
    }

    /// Half widths from the estimates at these coordinates.
    pub(super) fn half_widths(&self, [one, two, gain]: [f64; 3]) -> [f64; 3] {
        match self.rho() {
            Some(rho) => {
                let (a, b) = correlated(rho, one * two.cos(), one * two.sin());
                [a, b, gain]
            }
            None => [one, two, gain],
        }
    }

    /// The swimmer at these coordinates.
    ///
    /// # Errors
    /// The swimmer is invalid.
    pub(super) fn at(
        &self,
        swimmer: &Swimmer<f64>,
        place: [f64; 3],
    ) -> Result<Member, InvalidSwimmer> {
        let (by, widths) = (self.half_widths(place), self.widths());
        let scaled = |k: usize| by[k] * widths[k][usize::from(by[k] >= 0.0)];
        self.off(swimmer, [0, 1, 2].map(scaled))
    }

    /// A grid over all that is left open, the estimates first, to begin the search for the worst case from.
    pub(super) fn grid(&self) -> Vec<[f64; 3]> {
        let [one, two, gain] = self.axes().map(Axis::grid);
        let mut places = Vec::new();
        for first in one {
            // The middle of the ellipse is one place.
            let middle = self.rho().is_some() && first <= 0.0;
            let most = if middle { 1 } else { usize::MAX };
            for second in two.clone().take(most) {
                places.extend(gain.clone().map(|third| [first, second, third]));
            }
        }
        let estimates = |place: &[f64; 3]| place.iter().all(|off| off.abs() <= 0.0);
        places.retain(|place| !estimates(place));
        places.insert(0, [0.0; 3]);
        places
    }

    /// Swimmers with weights that integrate over a normal distribution of r_s and ln χ about the estimates: standard deviations
    /// from intervals and level, correlated if the correlation is known. Of unequal sides the mean counts. A negative sphere
    /// radius counts as 0.
    ///
    /// An interval does not state its degrees of freedom, so they are taken as infinite: the deviation is the half width over the
    /// normal quantile. A calibration's intervals are Student's and wider for few runs. For those the deviation is larger than
    /// the standard error, and the mean covers a wider spread than the fit's own.
    ///
    /// # Errors
    /// A swimmer is invalid.
    pub(super) fn normal(
        &self,
        swimmer: &Swimmer<f64>,
    ) -> Result<Vec<(Member, f64)>, InvalidSwimmer> {
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.level);
        let deviations = self.widths().map(|[a, b]| 0.5 * (a + b) / quantile);
        let rules = deviations.map(|deviation| {
            if deviation > 0.0 {
                HERMITE.as_slice()
            } else {
                &[(0.0, 1.0)]
            }
        });
        let rho = self.rho().unwrap_or(0.0);
        let mut weighted = Vec::new();
        for &(z1, w1) in rules[0] {
            for &(z2, w2) in rules[1] {
                for &(z3, w3) in rules[2] {
                    let (a, b) = correlated(rho, z1, z2);
                    let [radius, log_chi, gain] = deviations;
                    let by = [radius * a, log_chi * b, gain * z3];
                    weighted.push((self.off(swimmer, by)?, w1 * w2 * w3));
                }
            }
        }
        Ok(weighted)
    }
}

/// Steps of the grid over an interval, and over that of the gain; the ellipse's border has eight times as many.
const STEPS: u32 = 4;
const GAIN_STEPS: u32 = 2;

/// `true` if an interval with these half widths has a width.
fn is_open([below, above]: [f64; 2]) -> bool {
    below + above > 0.0
}

/// Two standard variables of this correlation from two independent ones.
fn correlated(rho: f64, z1: f64, z2: f64) -> (f64, f64) {
    (z1, rho * z1 + (1.0 - rho * rho).max(0.0).sqrt() * z2)
}
