//! Nuisance parameters: c_t/μ, zeros of the joints, dead bands of the servos, places of the reflectors. Each can be fitted along
//! with r_s and χ; a warning names parameters that the data cannot distinguish. Every fit scans for an unknown dead band
//! (`scan.rs`).

pub(crate) mod scan;

use serde::{Serialize, Serializer};
use swimmer_files::SwimmerFile;

use crate::error::FitError;
use crate::fit::intervals::half_width;
use crate::fit::likelihood::Estimate;
use crate::fit::parameter::Parameter;
use crate::fit::run_model::RunModel;
use crate::fit::{CampaignFit, Intervals};
use crate::least_squares::{Model as _, weighted};

/// Parameter that can be fitted along with r_s and χ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NuisanceParameter {
    /// c_t/μ, common to all links.
    TangentialDrag,
    /// A constant offset of each joint.
    JointOffsets,
    /// The servos' dead band.
    DeadBand,
    /// Offset of the reflectors' middle on the middle link, along and across.
    MarkerOffset,
    /// Gain of both servos (angle per commanded angle).
    Gain,
    /// The same of each servo.
    Gains,
    /// Lengths as the cameras give them over true ones.
    Scale,
    /// Lengths of the three links.
    Lengths,
    /// Rotational drag of the float over a sphere's.
    Float,
    /// Stretch of the cameras' view: tilt, pixels that are not square.
    Tilt,
    /// Distortion of the lens.
    Distortion,
    /// Effect of the tank's walls.
    Walls,
}

impl NuisanceParameter {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::TangentialDrag,
        Self::JointOffsets,
        Self::DeadBand,
        Self::MarkerOffset,
        Self::Gain,
        Self::Gains,
        Self::Scale,
        Self::Lengths,
        Self::Float,
        Self::Tilt,
        Self::Distortion,
        Self::Walls,
    ];

    /// Name on the command line: `swimmer calibrate --fit-also`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::TangentialDrag => "ct",
            Self::JointOffsets => "offsets",
            Self::DeadBand => "deadband",
            Self::MarkerOffset => "marker",
            Self::Gain => "gain",
            Self::Gains => "gains",
            Self::Scale => "scale",
            Self::Lengths => "lengths",
            Self::Float => "float",
            Self::Tilt => "tilt",
            Self::Distortion => "distortion",
            Self::Walls => "walls",
        }
    }

    /// The parameter of this word on the command line.
    ///
    /// ```
    /// use calibrate::NuisanceParameter;
    ///
    /// assert_eq!(NuisanceParameter::of_word("deadband"), Some(NuisanceParameter::DeadBand));
    /// assert!(NuisanceParameter::ALL.iter().all(|further| NuisanceParameter::of_word(further.word()) == Some(*further)));
    /// ```
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|further| further.word() == word)
    }

    fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::TangentialDrag => &[Parameter::TangentialDrag],
            Self::JointOffsets => &[Parameter::FrontOffset, Parameter::BackOffset],
            Self::DeadBand => &[Parameter::DeadBand],
            Self::MarkerOffset => &[Parameter::MarkerAlong, Parameter::MarkerAcross],
            Self::Gain => &[Parameter::Gain],
            Self::Gains => &[Parameter::FrontGain, Parameter::BackGain],
            Self::Scale => &[Parameter::Scale],
            Self::Lengths => &[
                Parameter::MiddleLength,
                Parameter::FrontLength,
                Parameter::BackLength,
            ],
            Self::Float => &[Parameter::FloatTurning],
            Self::Tilt => &[Parameter::StretchSquare, Parameter::StretchDiagonal],
            Self::Distortion => &[Parameter::Distortion],
            Self::Walls => &[Parameter::WallEffect],
        }
    }
}

/// A parameter with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedParameter {
    /// The parameter.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// Value by the files, or by the fit without the further parameters.
    pub before: f64,
    /// The estimate.
    pub value: f64,
    /// Its interval: Student's t, within the bounds.
    pub interval: [f64; 2],
    /// Bounds of the search.
    pub bounds: [f64; 2],
}

/// Warning about a fit of further parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum NuisanceWarning {
    /// Two parameters that the data cannot distinguish.
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

impl std::fmt::Display for NuisanceWarning {
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

impl Serialize for NuisanceWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// r_s, χ and further parameters, by likelihood. Serialised with the keys of `swimmer calibrate --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NuisanceFit {
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
    #[serde(skip)]
    pub swimmer: SwimmerFile,
    /// Warnings.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<String>"))]
    pub warnings: Vec<NuisanceWarning>,
}

/// Fits further parameters along with r_s and χ.
///
/// # Errors
/// [`FitError::Undetermined`] where the data say nothing about some combination of them.
pub fn fit_nuisance(
    found: &CampaignFit,
    further: &[NuisanceParameter],
) -> Result<NuisanceFit, FitError> {
    let mut wanted = further.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    let plain = vec![Parameter::SphereRadius, Parameter::Chi];
    let mut parameters = plain.clone();
    parameters.extend(wanted.iter().flat_map(|further| further.parameters()));
    let mut data = found.values()?;
    // Y and the net turn distinguish front and back; symmetric parameters do not change them.
    if wanted.iter().any(|further| {
        matches!(
            further,
            NuisanceParameter::JointOffsets
                | NuisanceParameter::Gains
                | NuisanceParameter::Lengths
                | NuisanceParameter::Tilt
                | NuisanceParameter::Walls
        )
    }) {
        data = data.with_all();
    }
    let plain = found.model(&data, plain)?;
    if let Some(idle) = parameters.iter().find(|p| !plain.has_use_for(**p)) {
        if idle.is_of_view() || *idle == Parameter::WallEffect {
            return Err(FitError::Undetermined {
                parameters: idle.name().to_owned(),
            });
        }
        return Err(FitError::Measured {
            parameter: idle.name(),
        });
    }
    let model = plain.with(parameters);
    let undetermined = || {
        let names: Vec<&str> = model.parameters.iter().map(|p| p.name()).collect();
        FitError::Undetermined {
            parameters: names.join(", "),
        }
    };
    let begun = begin(&model, found);
    let before = Estimate::of(&plain, &data, &begun[..2]).ok_or_else(undetermined)?;
    let after =
        Estimate::best_of(&model, &data, &starts(&model, &begun)).ok_or_else(undetermined)?;
    let gain = after.log_likelihood - before.log_likelihood;
    summary(&model, &begun, &after, gain, found.fit.intervals.level).ok_or_else(undetermined)
}

/// Values of the parameters by the files, and the fit of r_s and χ.
fn begin(model: &RunModel, found: &CampaignFit) -> Vec<f64> {
    let [radius, chi] = found.optimum();
    let of = |parameter: &Parameter| match parameter {
        Parameter::SphereRadius => radius,
        Parameter::Chi => chi,
        Parameter::DeadBand => found.start.servo.map_or(0.0, |servo| servo.dead_band),
        _ => 0.0,
    };
    model.parameters.iter().map(of).collect()
}

/// Dead bands to start from \[rad\], in addition to the files'.
const DEAD_BANDS: [f64; 3] = [0.03, 0.09, 0.18];
/// Offsets of the reflectors' middle to start from, as shares of the largest: seen from the wrong side of the joints' middle a link
/// sways nearly as much, so that there are two minima.
const MARKERS: [f64; 2] = [-0.5, 0.5];

/// Starting points of the search, several for parameters with more than one minimum.
fn starts(model: &RunModel, begun: &[f64]) -> Vec<Vec<f64>> {
    let mut starts = vec![begun.to_vec()];
    for (place, (parameter, (_, high))) in model.parameters.iter().zip(model.bounds()).enumerate() {
        let others: &[f64] = match parameter {
            Parameter::DeadBand => &DEAD_BANDS,
            Parameter::MarkerAlong | Parameter::MarkerAcross => &MARKERS.map(|share| share * high),
            _ => &[],
        };
        starts.extend(others.iter().map(|value| {
            let mut start = begun.to_vec();
            start[place] = *value;
            start
        }));
    }
    starts
}

/// Beyond these, a correlation or a condition number is worth a warning.
const ALIKE: f64 = 0.99;
const ILL_CONDITIONED: f64 = 300.0;
/// Gain in log-likelihood that one parameter reaches by chance in one of fifty cases.
const BY_CHANCE: f64 = 2.7;

fn summary(
    model: &RunModel,
    begun: &[f64],
    found: &Estimate,
    gain: f64,
    level: f64,
) -> Option<NuisanceFit> {
    let at = &found.at;
    let mut parameters = Vec::with_capacity(at.len());
    let mut warnings = Vec::new();
    for (i, (slot, (low, high))) in model.parameters.iter().zip(model.bounds()).enumerate() {
        let half = half_width(found.components.of_parameter(i), level)?;
        let natural = |value: f64| model.natural(*slot, value);
        let (from, to) = ((at[i] - half).max(low), (at[i] + half).min(high));
        if from <= low && to >= high {
            warnings.push(NuisanceWarning::Unbounded { name: slot.name() });
        } else if at[i] >= high || (at[i] <= low && low < 0.0) {
            warnings.push(NuisanceWarning::AtBound {
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
    let correlation = |i: usize, j: usize| found.components.correlation(i, j);
    let count = at.len();
    for i in 0..count {
        for j in 0..i {
            let correlation = correlation(i, j);
            if correlation.abs() > ALIKE {
                warnings.push(NuisanceWarning::Alike {
                    names: [model.parameters[j].name(), model.parameters[i].name()],
                    correlation,
                });
            }
        }
    }
    let condition = condition(found)?;
    if condition > ILL_CONDITIONED {
        warnings.push(NuisanceWarning::IllConditioned { condition });
    }
    if count > 2 && gain < BY_CHANCE * (count - 2) as f64 {
        warnings.push(NuisanceWarning::NoBetter {
            gain,
            parameters: count - 2,
        });
    }
    let mut swimmer = model.file(at);
    swimmer = swimmer.fitted(swimmer.swimmer.sphere_radius, swimmer.swimmer.chi);
    Some(NuisanceFit {
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

/// Condition number of the weighted Jacobian, each column scaled to length 1.
fn condition(found: &Estimate) -> Option<f64> {
    let roots: Vec<f64> = found.weights.iter().map(|weight| weight.sqrt()).collect();
    let mut weighted = weighted(&found.jacobian, &roots);
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

impl NuisanceFit {
    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&FittedParameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Intervals of r_s and χ.
    pub fn intervals(&self) -> Option<Intervals> {
        Some(Intervals {
            sphere_radius: self.parameter(Parameter::SphereRadius.name())?.interval,
            chi: self.parameter(Parameter::Chi.name())?.interval,
            level: self.level,
        })
    }
}
