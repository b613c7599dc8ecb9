//! What is known of r_s, χ and the servos' gain, as the swimmers that a robust gait is held against.
//!
//! A calibration fits r_s and ln χ: its interval of χ is χ·exp(±d), and its correlation is that of r_s and ln χ. So
//! everything here lives in the plane of r_s and ln χ, where χ stays above 0 by itself. The gain has an interval of its own.

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
    /// Interval about 1 of the servos' gain, what both turn over what they are told: shapes are so many times the told ones,
    /// while bounds on angles and the servos' rates are about what is told. An estimate other than 1 belongs into the servo map.
    pub gain_interval: [f64; 2],
    /// Level of all.
    pub level: f64,
    /// Correlation of r_s and ln χ where it is known; then the worst case is looked for on the ellipse that touches the
    /// intervals' borders, else in their box.
    pub correlation: Option<f64>,
}

/// A swimmer that is left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Possible {
    pub(super) swimmer: Swimmer<f64>,
    pub(super) gain: f64,
}

impl Possible {
    pub(super) fn member(&self) -> Result<Member, InvalidSwimmer> {
        Member::new(&self.swimmer, self.gain)
    }
}

/// One coordinate of all that is left open.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    from: f64,
    to: f64,
    /// Steps of the grid; none where there is nothing open.
    steps: u32,
    /// Whether both ends are one.
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
        let last = if self.round {
            self.steps - 1
        } else {
            self.steps
        };
        (0..=last).map(move |i| {
            let share = f64::from(i) / f64::from(self.steps.max(1));
            self.from + (self.to - self.from) * share
        })
    }

    /// Halfway to the grid's neighbour; none where nothing is open.
    pub(super) fn half_step(self) -> Option<f64> {
        (self.steps > 0).then(|| 0.5 * (self.to - self.from) / f64::from(self.steps))
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
        if self.gain_interval[0] <= 0.0 {
            let [low, _] = self.gain_interval;
            return wrong("gain", low, "its whole interval must be above 0");
        }
        let [low, _] = self.chi_interval;
        if low <= 0.0 || self.chi <= 0.0 {
            return wrong(
                "fit's χ",
                low.min(self.chi),
                "χ and its whole interval must be above 0",
            );
        }
        if !(self.level > 0.0 && self.level < 1.0) {
            return wrong(
                "fit's level",
                self.level,
                "give a share between 0 and 1, as 0.95",
            );
        }
        match self.correlation {
            Some(rho) if rho.is_nan() || rho.abs() > 1.0 => wrong(
                "fit's correlation",
                rho,
                "a correlation lies between -1 and 1",
            ),
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

    fn gain_widths(&self) -> [f64; 2] {
        let [low, high] = self.gain_interval;
        [(1.0 - low).max(0.0), (high - 1.0).max(0.0)]
    }

    /// Whether nobody knows how far the servos turn.
    pub(super) fn gain_is_open(&self) -> bool {
        self.gain_widths().iter().any(|width| *width > 0.0)
    }

    /// The swimmer so many half widths from the estimates.
    fn off(&self, swimmer: &Swimmer<f64>, [radius, log_chi, gain]: [f64; 3]) -> Possible {
        let log_chi = scaled(self.log_chi_widths(), log_chi);
        Possible {
            swimmer: with(
                swimmer,
                self.sphere_radius + scaled(self.radius_widths(), radius),
                self.chi * log_chi.exp(),
            ),
            gain: 1.0 + scaled(self.gain_widths(), gain),
        }
    }

    /// The coordinates of all that is left open: of the ellipse radius and turn, else both half widths; and the gain's.
    pub(super) fn axes(&self) -> [Axis; 3] {
        let side = |widths: [f64; 2], steps| {
            let open = widths[0] + widths[1] > 0.0;
            if open {
                Axis::new(-1.0, 1.0, steps)
            } else {
                Axis::new(0.0, 0.0, 0)
            }
        };
        let gain = side(self.gain_widths(), GAIN_STEPS);
        match self.rho() {
            Some(_) => {
                let turn = Axis {
                    round: true,
                    ..Axis::new(0.0, std::f64::consts::TAU, 8 * STEPS)
                };
                [Axis::new(0.0, 1.0, 1), turn, gain]
            }
            None => [
                side(self.radius_widths(), STEPS),
                side(self.log_chi_widths(), STEPS),
                gain,
            ],
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
    pub(super) fn at(&self, swimmer: &Swimmer<f64>, place: [f64; 3]) -> Possible {
        self.off(swimmer, self.half_widths(place))
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

    /// Swimmers with weights that integrate over a normal distribution of r_s and ln χ about the estimates: standard
    /// deviations from intervals and level, correlated where that is known. Of uneven sides the mean counts. A sphere below
    /// nothing counts as none.
    ///
    /// An interval does not tell its degrees of freedom, so the deviation is taken as if they were many: half width over the
    /// normal quantile. A calibration's intervals are Student's, wider for few runs: there the deviation comes out larger than the
    /// standard error, and the mean is taken over a wider spread than the fit's own.
    pub(super) fn normal(&self, swimmer: &Swimmer<f64>) -> Vec<(Possible, f64)> {
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.level);
        let deviation = |[below, above]: [f64; 2]| 0.5 * (below + above) / quantile;
        let deviations = [
            self.radius_widths(),
            self.log_chi_widths(),
            self.gain_widths(),
        ]
        .map(deviation);
        let one = [(0.0, 1.0)];
        let rule = |deviation: f64| {
            if deviation > 0.0 {
                HERMITE.as_slice()
            } else {
                one.as_slice()
            }
        };
        let [radius, log_chi, gain] = deviations.map(rule);
        let rho = self.rho().unwrap_or(0.0);
        let mut weighted = Vec::with_capacity(radius.len() * log_chi.len() * gain.len());
        for &(z1, w1) in radius {
            for &(z2, w2) in log_chi {
                for &(z3, w3) in gain {
                    let (a, b) = correlated(rho, z1, z2);
                    let [radius, log_chi, gain] = deviations;
                    let possible = Possible {
                        swimmer: with(
                            swimmer,
                            self.sphere_radius + radius * a,
                            self.chi * (log_chi * b).exp(),
                        ),
                        gain: 1.0 + gain * z3,
                    };
                    weighted.push((possible, w1 * w2 * w3));
                }
            }
        }
        weighted
    }
}

/// Steps of the grid over an interval, and over that of the gain; the ellipse's border has eight times as many.
const STEPS: u32 = 4;
const GAIN_STEPS: u32 = 2;

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
