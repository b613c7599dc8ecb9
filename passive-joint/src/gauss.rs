//! Gauss–Legendre collocation of order six for the passive angle: A-stable, so a stiff spring needs no small steps.

use nalgebra::{Matrix3, Vector3};
use swimmer_model::{GaussLegendre, Model};

use crate::PassiveJoint;
use crate::spring::straight_resistance;

/// Stages of the method.
pub(crate) const STAGES: usize = 3;

/// Nodes of the stages, as shares of a step.
pub(crate) const NODES: [f64; STAGES] = {
    let [first, middle, last] = GaussLegendre::<STAGES>::NODES;
    [0.5 + 0.5 * first, 0.5 + 0.5 * middle, 0.5 + 0.5 * last]
};
/// Weights of the stages: rational, as the coefficients.
pub(crate) const WEIGHTS: [f64; STAGES] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];

/// Coefficients of the stages (Butcher matrix).
pub(crate) fn coefficients() -> Matrix3<f64> {
    let root = 15.0_f64.sqrt();
    Matrix3::new(
        5.0 / 36.0,
        2.0 / 9.0 - root / 15.0,
        5.0 / 36.0 - root / 30.0,
        5.0 / 36.0 + root / 24.0,
        2.0 / 9.0,
        5.0 / 36.0 - root / 24.0,
        5.0 / 36.0 + root / 30.0,
        2.0 / 9.0 + root / 15.0,
        5.0 / 36.0,
    )
}

/// Angle and rate of the driven joint at the three stages of a step.
pub(crate) type Drive = [[f64; 2]; STAGES];

/// One step of the passive angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// Passive angles at the stages \[rad\].
    pub(crate) angles: [f64; STAGES],
    /// Their derivatives with respect to u.
    pub(crate) rates: [f64; STAGES],
    /// Derivatives of the rates with respect to the angles.
    pub(crate) slopes: [f64; STAGES],
    /// Passive angle at the end of the step \[rad\].
    pub(crate) end: f64,
    /// Derivative of the end with respect to the start.
    pub(crate) growth: f64,
}

/// Rate φ_p′ of the passive joint, and its derivative with respect to φ_p.
fn passive_rate(
    model: &Model<f64>,
    passive: &PassiveJoint,
    [driven, driven_rate]: [f64; 2],
    angle: f64,
) -> [f64; 2] {
    let first = model.first_derivatives(&passive.shape(driven, angle));
    let (p, d) = (passive.joint.index(), passive.driven().index());
    let along = &first.d_power[p];
    let resistance = first.power[(p, p)];
    let rate = passive.rate(&first.power, driven_rate, angle);
    let slope = -(passive.kappa + along[(p, d)] * driven_rate + rate * along[(p, p)]) / resistance;
    [rate, slope]
}

/// Largest number of Newton steps for the stages.
const NEWTON_STEPS: u32 = 30;
/// Relative accuracy of the stages.
const ACCURACY: f64 = 1e-13;
/// Largest passive angle that is followed \[rad\].
const LARGEST_ANGLE: f64 = 20.0;

impl Step {
    /// Advances the passive angle by `length` in u. Returns `None` if the stages do not converge.
    pub(crate) fn new(
        model: &Model<f64>,
        passive: &PassiveJoint,
        drive: &Drive,
        start: f64,
        length: f64,
    ) -> Option<Self> {
        let matrix = coefficients();
        let at_stages = |rates: &Vector3<f64>| matrix * rates * length + Vector3::repeat(start);
        let evaluate = |angles: &Vector3<f64>| {
            let values: [[f64; 2]; STAGES] =
                std::array::from_fn(|i| passive_rate(model, passive, drive[i], angles[i]));
            let [rates, slopes] = [0, 1].map(|k| Vector3::from(values.map(|value| value[k])));
            (rates, slopes)
        };
        let mut rates = evaluate(&Vector3::repeat(start)).0;
        // The rate at the start says little about a stiff joint, so the first Newton step starts from rest.
        if passive.kappa * length > straight_resistance(model, passive.joint) {
            rates = Vector3::zeros();
        }
        for _ in 0..NEWTON_STEPS {
            let angles = at_stages(&rates);
            if angles.amax().is_nan() || angles.amax() > LARGEST_ANGLE {
                return None;
            }
            let (values, slopes) = evaluate(&angles);
            let system = Matrix3::identity() - Matrix3::from_diagonal(&slopes) * matrix * length;
            let update = system.lu().solve(&(values - rates))?;
            rates += update;
            if update.amax() <= ACCURACY * (1.0 + rates.amax()) {
                let growth = system.lu().solve(&slopes)?;
                let weights = Vector3::from(WEIGHTS);
                return Some(Self {
                    angles: at_stages(&rates).into(),
                    rates: rates.into(),
                    slopes: slopes.into(),
                    end: start + length * weights.dot(&rates),
                    growth: 1.0 + length * weights.dot(&growth),
                });
            }
        }
        None
    }
}
