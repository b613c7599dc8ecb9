//! What else may not be as the files say: c_t/μ, where the joints' zero is, how far a servo's dead band reaches, where the
//! reflectors sit. Each can be fitted along with r_s and χ; where the data cannot tell two apart, the answer says so. A dead
//! band that nobody knew of is looked for in every fit (`dead_band.rs`).
//!
//! Cycles were cut where the heading matched the fitted model's; a model with other parameters has another heading, and its
//! cycles are cut in the same way before they are compared.

pub(crate) mod dead_band;
mod least;
mod setting;

use statrs::distribution::{ContinuousCDF, StudentsT};
use swimmer_files::{Campaign, SwimmerFile};
use swimmer_model::Swimmer;

use crate::campaign::{CalibrateError, CampaignData, CampaignFit};
use crate::fit::measured::RunValues;
use crate::fit::{FitError, Intervals};
pub(crate) use least::{Likeliest, likeliest};
pub(crate) use setting::Setting;

/// What can be fitted along with r_s and χ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Further {
    /// c_t/μ, common to all links.
    TangentialDrag,
    /// A constant offset of each joint.
    JointOffsets,
    /// The servos' dead band.
    DeadBand,
    /// Where the reflectors' middle sits on the middle link, along and across.
    MarkerOffset,
}

/// One number that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    SphereRadius,
    Chi,
    TangentialDrag,
    FrontOffset,
    BackOffset,
    DeadBand,
    MarkerAlong,
    MarkerAcross,
}

impl Slot {
    /// Least and largest value, as the fit takes it.
    fn bounds(self, length: f64, swimmer: &Swimmer<f64>) -> (f64, f64) {
        let reach = swimmer.links.middle / length;
        match self {
            Self::SphereRadius => (0.0, 1.0),
            Self::Chi => (0.05_f64.ln(), 50_f64.ln()),
            Self::TangentialDrag => (-(20_f64.ln()), 20_f64.ln()),
            Self::FrontOffset | Self::BackOffset => (-0.35, 0.35),
            Self::DeadBand => (0.0, 0.35),
            Self::MarkerAlong | Self::MarkerAcross => (-reach, reach),
        }
    }

    /// Half a difference's width. Paths have kinks in the dead band.
    fn step(self) -> f64 {
        if self == Self::DeadBand { 4e-3 } else { 1e-3 }
    }

    fn name(self) -> &'static str {
        match self {
            Self::SphereRadius => "r_s",
            Self::Chi => "chi",
            Self::TangentialDrag => "c_t/mu",
            Self::FrontOffset => "front joint offset",
            Self::BackOffset => "back joint offset",
            Self::DeadBand => "dead band",
            Self::MarkerAlong => "marker offset along",
            Self::MarkerAcross => "marker offset across",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::SphereRadius | Self::MarkerAlong | Self::MarkerAcross => "m",
            Self::Chi | Self::TangentialDrag => "",
            Self::FrontOffset | Self::BackOffset | Self::DeadBand => "rad",
        }
    }
}

impl Further {
    fn slots(self) -> &'static [Slot] {
        match self {
            Self::TangentialDrag => &[Slot::TangentialDrag],
            Self::JointOffsets => &[Slot::FrontOffset, Slot::BackOffset],
            Self::DeadBand => &[Slot::DeadBand],
            Self::MarkerOffset => &[Slot::MarkerAlong, Slot::MarkerAcross],
        }
    }
}

/// A parameter with its interval.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedParameter {
    /// What it is.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// What the files say, or the fit without the further parameters.
    pub before: f64,
    /// The estimate.
    pub value: f64,
    /// Its interval: Student's t, within the bounds.
    pub interval: [f64; 2],
    /// Where it was looked for.
    pub bounds: [f64; 2],
}

/// What to know about a fit of further parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum FurtherWarning {
    /// Two parameters that the data cannot tell apart.
    Alike {
        /// Their names.
        names: [&'static str; 2],
        /// Correlation of their errors.
        correlation: f64,
    },
    /// The interval is everything that was allowed.
    Unbounded {
        /// The parameter.
        name: &'static str,
    },
    /// The best value is the largest or least allowed.
    AtBound {
        /// The parameter.
        name: &'static str,
        /// The bound.
        bound: f64,
    },
    /// Some combination of parameters hardly shows in the data.
    IllConditioned {
        /// Condition number of the Jacobian with columns of length 1.
        condition: f64,
    },
    /// The data are explained no better than without.
    NoBetter {
        /// Gain in log-likelihood.
        gain: f64,
        /// Parameters more.
        parameters: usize,
    },
}

impl std::fmt::Display for FurtherWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Alike {
                names: [a, b],
                correlation,
            } => write!(
                f,
                "these runs cannot tell {a} from {b} (correlation {correlation:+.4}): believe their combination, neither alone"
            ),
            Self::Unbounded { name } => write!(
                f,
                "these runs say nothing about {name}: its interval is all that was allowed"
            ),
            Self::AtBound { name, bound } => {
                write!(
                    f,
                    "{name} ended at its bound {bound:.4}: something else is wrong"
                )
            }
            Self::IllConditioned { condition } => write!(
                f,
                "some combination of the parameters hardly shows in these runs (condition {condition:.0}): fit fewer, or measure other gaits"
            ),
            Self::NoBetter { gain, parameters } => write!(
                f,
                "{parameters} parameter(s) more explain the runs no better (log-likelihood +{gain:.1}): the files' values stand"
            ),
        }
    }
}

/// r_s, χ and further parameters, by likelihood.
#[derive(Debug, Clone, PartialEq)]
pub struct FurtherFit {
    /// r_s \[m\], χ, then the others.
    pub parameters: Vec<FittedParameter>,
    /// Level of the intervals.
    pub level: f64,
    /// Correlations between all of them.
    pub correlations: Vec<Vec<f64>>,
    /// Condition number of the Jacobian with columns of length 1.
    pub condition: f64,
    /// By how much the log-likelihood grows over that of r_s and χ alone.
    pub log_likelihood_gain: f64,
    /// The swimmer with all that it can hold: r_s, χ, c_t/μ, dead band.
    pub swimmer: SwimmerFile,
    /// What to know about it.
    pub warnings: Vec<FurtherWarning>,
}

/// Fits further parameters along with r_s and χ.
///
/// # Errors
/// [`CalibrateError`]: [`FitError::Undetermined`] where the data say nothing about some combination of them.
pub fn fit_further(
    campaign: &Campaign,
    data: &CampaignData,
    found: &CampaignFit,
    further: &[Further],
) -> Result<FurtherFit, CalibrateError> {
    let mut wanted = further.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    let mut slots = vec![Slot::SphereRadius, Slot::Chi];
    slots.extend(wanted.iter().flat_map(|further| further.slots()));
    let measured = RunValues::of(&found.runs);
    let plain = vec![Slot::SphereRadius, Slot::Chi];
    let plain = Setting::new(&campaign.swimmer, data, found, plain, measured.scales)?;
    let setting = plain.with_slots(slots);
    let undetermined = || {
        let names: Vec<&str> = setting.slots.iter().map(|slot| slot.name()).collect();
        CalibrateError::Fit(FitError::Undetermined {
            parameters: names.join(", "),
        })
    };
    let before = likeliest(&plain, &measured, &[plain.begin(found)]).ok_or_else(undetermined)?;
    let after = likeliest(&setting, &measured, &setting.starts(found)).ok_or_else(undetermined)?;
    let gain = after.log_likelihood - before.log_likelihood;
    let begun = setting.begin(found);
    summary(&setting, &begun, &after, gain, found.fit.intervals.level).ok_or_else(undetermined)
}

/// Beyond these, a correlation or a condition number is worth a warning.
const ALIKE: f64 = 0.99;
const ILL_CONDITIONED: f64 = 300.0;
/// Gain in log-likelihood that one parameter brings by chance in one of fifty cases.
const BY_CHANCE: f64 = 2.7;

fn summary(
    setting: &Setting<'_>,
    begun: &[f64],
    found: &Likeliest,
    gain: f64,
    level: f64,
) -> Option<FurtherFit> {
    let at = &found.minimum.at;
    let covariance = found.components.covariance();
    let mut parameters = Vec::with_capacity(at.len());
    let mut warnings = Vec::new();
    for (i, (slot, (low, high))) in setting.slots.iter().zip(setting.bounds()).enumerate() {
        let variance = found.components.of_parameter(i);
        let student = StudentsT::new(0.0, 1.0, variance.freedom).ok()?;
        let half = student.inverse_cdf(0.5 + level / 2.0) * variance.value.sqrt();
        let natural = |value: f64| setting.natural(*slot, value);
        let (from, to) = ((at[i] - half).max(low), (at[i] + half).min(high));
        if from <= low && to >= high {
            warnings.push(FurtherWarning::Unbounded { name: slot.name() });
        } else if at[i] >= high || (at[i] <= low && low < 0.0) {
            warnings.push(FurtherWarning::AtBound {
                name: slot.name(),
                bound: natural(at[i]),
            });
        }
        parameters.push(FittedParameter {
            name: slot.name(),
            unit: slot.unit(),
            before: natural(begun[i]),
            value: natural(at[i]),
            interval: [natural(from), natural(to)],
            bounds: [natural(low), natural(high)],
        });
    }
    let correlation =
        |i: usize, j: usize| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    let count = at.len();
    for i in 0..count {
        for j in 0..i {
            let correlation = correlation(i, j);
            if correlation.abs() > ALIKE {
                warnings.push(FurtherWarning::Alike {
                    names: [setting.slots[j].name(), setting.slots[i].name()],
                    correlation,
                });
            }
        }
    }
    let condition = condition(found)?;
    if condition > ILL_CONDITIONED {
        warnings.push(FurtherWarning::IllConditioned { condition });
    }
    if count > 2 && gain < BY_CHANCE * (count - 2) as f64 {
        warnings.push(FurtherWarning::NoBetter {
            gain,
            parameters: count - 2,
        });
    }
    let mut swimmer = setting.file(at);
    swimmer = swimmer.fitted(swimmer.swimmer.sphere_radius, swimmer.swimmer.chi);
    Some(FurtherFit {
        parameters,
        level,
        correlations: (0..count)
            .map(|i| (0..count).map(|j| correlation(i, j)).collect())
            .collect(),
        condition,
        log_likelihood_gain: gain,
        swimmer,
        warnings,
    })
}

/// Of the weighted Jacobian, each column scaled to length 1.
fn condition(found: &Likeliest) -> Option<f64> {
    let mut weighted = found.minimum.jacobian.clone();
    for (mut row, weight) in weighted.row_iter_mut().zip(&found.weights) {
        row *= weight.sqrt();
    }
    for mut column in weighted.column_iter_mut() {
        let norm = column.norm();
        if norm <= 0.0 {
            return None;
        }
        column /= norm;
    }
    let singular = weighted.svd(false, false).singular_values;
    Some(singular.max() / singular.min())
}

impl FurtherFit {
    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&FittedParameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Intervals of r_s and χ.
    pub fn intervals(&self) -> Option<Intervals> {
        Some(Intervals {
            sphere_radius: self.parameter(Slot::SphereRadius.name())?.interval,
            chi: self.parameter(Slot::Chi.name())?.interval,
            level: self.level,
        })
    }
}
