//! `certify`: holds a gait against the necessary conditions, under the keys of `swimmer certify --json`.

use gait_optimizer::{Bounds, Certificate, Objective};
use serde::{Deserialize, Serialize};

use super::bounds::{BoundsAsked, objective};
use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::{GaitText, SwimmerText};

#[derive(Deserialize)]
struct Asked {
    swimmer: SwimmerText,
    gait: GaitText,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsAsked,
}

/// The verdict and its conditions.
#[derive(Serialize)]
pub(super) struct Evidence {
    pass: bool,
    verdict: &'static str,
    checks: Vec<Check>,
}

#[derive(Serialize)]
struct Check {
    name: &'static str,
    value: f64,
    tolerance: f64,
    pass: bool,
}

impl From<&Certificate> for Evidence {
    fn from(certificate: &Certificate) -> Self {
        let check = |check: &gait_optimizer::Check| Check {
            name: check.name,
            value: check.value,
            tolerance: check.tolerance,
            pass: check.pass,
        };
        Self {
            pass: certificate.pass(),
            verdict: certificate.verdict().word(),
            checks: certificate.checks().iter().map(check).collect(),
        }
    }
}

/// Certifies a gait.
pub(super) fn certify(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let swimmer = asked.swimmer.read()?;
    let file = asked.gait.file()?;
    let objective = objective(asked.objective.as_deref())?.unwrap_or(file.objective);
    if objective == Objective::Unspecified {
        return Err("certifying the gait: say what it shall be optimal for".to_owned());
    }
    let told = asked.bounds.into();
    let bounds = if told == Bounds::default() {
        file.bounds
    } else {
        told
    };
    let certificate = gait_optimizer::certify(&swimmer.swimmer, &file, objective, &bounds)
        .map_err(|why| why.to_string())?;
    json(&Evidence::from(&certificate))
}
