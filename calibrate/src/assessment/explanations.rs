//! What explains the runs beside r_s and χ, each alone and free of what is known, with its likelihood beside the others': a wrong
//! explanation is told apart by it, or it is not.

use serde::Serialize;

use super::Plain;
use crate::evidence::Pair;
use crate::fit::parameter::Parameter;
use crate::fit::tangent::Tangent;

/// What is tried, and from where beside what the files say.
const TRIED: [(&str, &[Parameter], &[f64]); 8] = [
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
];

/// One parameter of an explanation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Explained {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// What the files say.
    pub before: f64,
    /// What would explain the runs.
    pub value: f64,
}

/// Something that may be off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// What.
    pub name: &'static str,
    /// Its parameters.
    pub parameters: Vec<Explained>,
    /// By how much the log-likelihood of X, ΔY, Δθ, Y and net turn grows over that of r_s and χ alone.
    pub gain: f64,
    /// r_s and χ if it is so.
    pub estimate: Pair,
}

/// All of them, the likeliest first.
pub(super) fn explanations(plain: &Plain) -> Vec<Explanation> {
    let explain = |(name, more, others): &(&'static str, &[Parameter], &[f64])| {
        let filed: Vec<f64> = more
            .iter()
            .map(|parameter| plain.filed(*parameter))
            .collect();
        let starts = std::iter::once(filed.clone()).chain(others.iter().map(|value| vec![*value]));
        let data = &plain.data;
        let even = data.weights(|_| 1.0);
        let found = starts.filter_map(|values| {
            let (model, start) = plain.with(more, &values);
            Some(Tangent::estimate(&model, data, &start, &even)?.0)
        });
        let best = found.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))?;
        let parameters = more.iter().zip(&filed).zip(&best.at[2..]);
        Some(Explanation {
            name,
            parameters: parameters
                .map(|((parameter, filed), value)| Explained {
                    name: parameter.name(),
                    unit: parameter.unit(),
                    before: plain.model.natural(*parameter, *filed),
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
    out.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    out
}
