//! Error budget: changes of r_s and χ for small errors of the assumptions.

use serde::Serialize;

use super::Plain;
use super::known::Known;
use crate::fit::parameter::Parameter;
use crate::least_squares::Model as _;

/// One line of the budget.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BudgetLine {
    /// Name of the assumption.
    pub name: &'static str,
    /// By how much: a share, m or rad.
    pub by: f64,
    /// m, rad, or nothing for a share.
    pub unit: &'static str,
    /// Change of the r_s of greatest likelihood \[m\].
    #[serde(rename = "sphere_radius_m")]
    pub sphere_radius: f64,
    /// Change of χ.
    pub chi: f64,
    /// Standard deviation of the prior, in the same unit; `None` if it is taken as exact.
    pub width: Option<f64>,
    /// `true` if the campaign states the prior.
    pub stated: bool,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const MILLIMETRE: f64 = 1e-3;
const PERCENT: f64 = 0.01;

/// Assumptions of the budget, each with the size of its error.
const LINES: [(Parameter, f64); 19] = [
    (Parameter::Gain, PERCENT),
    (Parameter::Scale, PERCENT),
    (Parameter::MarkerAlong, MILLIMETRE),
    (Parameter::MarkerAcross, MILLIMETRE),
    (Parameter::MarkerAngle, DEGREE),
    (Parameter::FrontOffset, DEGREE),
    (Parameter::BackOffset, DEGREE),
    (Parameter::FrontLink, DEGREE),
    (Parameter::BackLink, DEGREE),
    (Parameter::DeadBand, DEGREE),
    (Parameter::TangentialDrag, PERCENT),
    (Parameter::Period, PERCENT),
    (Parameter::MiddleLength, MILLIMETRE),
    (Parameter::FrontLength, MILLIMETRE),
    (Parameter::BackLength, MILLIMETRE),
    (Parameter::FloatTurning, PERCENT),
    (Parameter::StretchSquare, PERCENT),
    (Parameter::Distortion, PERCENT),
    (Parameter::WallEffect, 0.1),
];

/// The budget of the estimate of greatest likelihood.
pub(super) fn budget(plain: &Plain, known: &[Known]) -> Vec<BudgetLine> {
    let length = plain.length();
    let line = |(parameter, by): (Parameter, f64)| -> Option<BudgetLine> {
        let per = if parameter.unit() == "m" { length } else { 1.0 };
        let in_files = plain.value_in_files(parameter);
        let (model, _) = plain.with(&[parameter], &[]);
        let at = |value: f64| model.values(&[plain.telling.at.as_slice(), &[value]].concat());
        let (here, there) = (at(in_files)?, at(in_files + by / per)?);
        let change = nalgebra::DVector::from_iterator(
            here.len(),
            there.iter().zip(&here).map(|(there, here)| there - here),
        );
        let shift = &plain.telling.components.gain * change;
        let known = known
            .iter()
            .find(|known| known.prior.parameter == parameter);
        Some(BudgetLine {
            name: parameter.name(),
            by,
            unit: parameter.unit(),
            sphere_radius: shift[0] * length,
            chi: plain.telling.at[1].exp() * shift[1].exp_m1(),
            width: known.map(|known| known.prior.width * per),
            stated: known.is_some_and(|known| known.stated),
        })
    };
    LINES
        .into_iter()
        .filter(|(parameter, _)| plain.model.has_use_for(*parameter))
        .filter_map(line)
        .collect()
}
