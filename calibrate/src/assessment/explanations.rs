//! Alternative explanations of the runs in addition to r_s and χ, each alone and without its prior. Their likelihoods show
//! which of them the runs distinguish.

use serde::Serialize;

use super::Plain;
use crate::evidence::Pair;
use crate::fit::likelihood::Estimate;
use crate::fit::parameter::Parameter;
use crate::fit::run_model::RunModel;
use crate::fit::tangent::Tangent;

/// Explanations that are tried: name, parameters, and starts relative to the files.
const TRIED: [(&str, &[Parameter], &[f64]); 16] = [
    ("gain", &[Parameter::Gain], &[]),
    (
        "gain of each servo",
        &[Parameter::FrontGain, Parameter::BackGain],
        &[],
    ),
    ("dead band", &[Parameter::DeadBand], &[0.06, 0.14]),
    (
        "joint offsets",
        &[Parameter::FrontOffset, Parameter::BackOffset],
        &[],
    ),
    (
        "reflectors' place",
        &[
            Parameter::MarkerAlong,
            Parameter::MarkerAcross,
            Parameter::MarkerAngle,
        ],
        &[],
    ),
    (
        "side reflectors' place",
        &[Parameter::FrontLink, Parameter::BackLink],
        &[],
    ),
    ("camera scale", &[Parameter::Scale], &[]),
    ("c_t/mu", &[Parameter::TangentialDrag], &[]),
    (
        "dead band of each servo",
        &[Parameter::DeadBand, Parameter::DeadBandDifference],
        &[],
    ),
    ("lag of one joint", &[Parameter::FrontLag], &[]),
    ("middle link's length", &[Parameter::MiddleLength], &[]),
    (
        "side links' lengths",
        &[Parameter::FrontLength, Parameter::BackLength],
        &[],
    ),
    ("float's shape", &[Parameter::FloatTurning], &[]),
    (
        "cameras' tilt",
        &[Parameter::StretchSquare, Parameter::StretchDiagonal],
        &[],
    ),
    ("lens distortion", &[Parameter::Distortion], &[]),
    ("tank's walls", &[Parameter::WallEffect], &[]),
];

/// Growth of the log-likelihood along a tangent from which on an explanation is followed by the model itself.
const WORTH_WHILE: f64 = 2.0;

/// One parameter of an explanation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Explained {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// Value by the files.
    pub before: f64,
    /// Value that would explain the runs.
    pub value: f64,
}

/// Something that may be off.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Explanation {
    /// Name.
    pub name: &'static str,
    /// Its parameters.
    pub parameters: Vec<Explained>,
    /// By how much the log-likelihood of X, ΔY, Δθ, Y and net turn grows over that of r_s and χ alone.
    pub gain: f64,
    /// r_s and χ if it is so.
    pub estimate: Pair,
}

impl Explanation {
    /// Gain minus the gain that as many parameters have by chance.
    pub(super) fn worth(&self) -> f64 {
        self.gain - self.parameters.len() as f64
    }
}

/// All of them, the likeliest first.
pub(super) fn explanations(plain: &Plain) -> Vec<Explanation> {
    let explain = |(name, more, others): &(&'static str, &[Parameter], &[f64])| {
        let in_files: Vec<f64> = more
            .iter()
            .map(|parameter| plain.value_in_files(*parameter))
            .collect();
        let data = &plain.data;
        let along = |model: &RunModel, tangent: &Tangent, start: &[f64]| {
            let rough = Estimate::of(tangent, data, start)?;
            if rough.log_likelihood - plain.all.log_likelihood < WORTH_WHILE {
                return Some(rough);
            }
            let found = Tangent::estimate(model, data, &rough.at, &rough.weights)?.0;
            Some(found)
        };
        let (model, start) = plain.with(more, &in_files);
        let first = plain.tangent_with(&model, &start);
        let first = first.and_then(|tangent| along(&model, &tangent, &start));
        let found = others.iter().filter_map(|value| {
            let (model, start) = plain.with(more, &[*value]);
            along(&model, &Tangent::of(&model, &start)?, &start)
        });
        let found = first.into_iter().chain(found);
        let best = found.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))?;
        let parameters = more.iter().zip(&in_files).zip(&best.at[2..]);
        Some(Explanation {
            name,
            parameters: parameters
                .map(|((parameter, in_files), value)| Explained {
                    name: parameter.name(),
                    unit: parameter.unit(),
                    before: plain.model.natural(*parameter, *in_files),
                    value: plain.model.natural(*parameter, *value),
                })
                .collect(),
            gain: best.log_likelihood - plain.all.log_likelihood,
            estimate: Pair {
                sphere_radius: best.at[0] * plain.length(),
                chi: best.at[1].exp(),
            },
        })
    };
    let mut out: Vec<Explanation> = TRIED
        .iter()
        .filter(|(_, more, _)| more.iter().all(|p| plain.model.has_use_for(*p)))
        .filter_map(explain)
        .collect();
    // By Akaike's criterion: more parameters explain more by chance.
    out.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    out
}
