//! Displacement and motor work of a limit cycle, with their derivatives by the adjoint method.
//!
//! Gauss–Legendre collocation is symplectic: the adjoint equations, solved by the same method, give the exact derivative of the
//! discrete values. Over a limit cycle the spring stores nothing, so the work of the motor is the drag power Φ̇ᵀWΦ̇ over the cycle.

use nalgebra::{DVector, Matrix3, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use crate::fixed_point::{CycleEnd, fixed_point};
use crate::gauss::{Drive, NODES, STAGES, Step, WEIGHTS, coefficients};
use crate::{PassiveError, PassiveJoint, Waveform};

/// Steps of a cycle.
const STEPS: usize = 192;
/// Length of a step in u.
const LENGTH: f64 = 1.0 / STEPS as f64;

/// Displacement and energy of a cycle with their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleValues {
    /// Displacement per cycle \[m\].
    pub displacement: f64,
    /// ∮ Φ′ᵀWΦ′ du \[m³\]: motor work per cycle × period / μ.
    pub energy: f64,
    /// Passive angle at u = 0 \[rad\].
    pub start: f64,
    /// Derivatives of the displacement with respect to the coefficients of the waveform, then κ.
    pub d_displacement: DVector<f64>,
    /// Derivatives of the energy, in the same order.
    pub d_energy: DVector<f64>,
}

/// Values at a stage that the adjoint equations need.
struct Stage {
    u: f64,
    /// φ_p \[rad\].
    angle: f64,
    /// Derivative of φ_p′ with respect to φ_p.
    slope: f64,
    rate: Vector2<f64>,
    first: FirstDerivatives<f64>,
    /// Position at the stage \[m\] and direction of the middle link there.
    position: Vector2<f64>,
    heading: f64,
}

/// Derivatives of an integrand with respect to shape and rate.
struct Integrand {
    by_shape: Vector2<f64>,
    by_rate: Vector2<f64>,
}

impl CycleValues {
    /// Values of the limit cycle of a waveform.
    ///
    /// # Errors
    /// [`PassiveError::NotConverged`] without a periodic motion, [`PassiveError::Unstable`] if disturbances grow.
    pub fn new(
        model: &Model<f64>,
        waveform: &Waveform,
        passive: &PassiveJoint,
    ) -> Result<Self, PassiveError> {
        let drives = drives(waveform);
        let (steps, start, multiplier) = periodic(model, passive, &drives)?;
        let (stages, end) = swum(model, passive, &drives, &steps);
        let displacement = end.norm();
        let along = end.try_normalize(0.0).unwrap_or_else(Vector2::x);
        let travel = |stage: &Stage| travel(stage, &along, &end);
        let sweep = |integrand: &dyn Fn(&Stage) -> Integrand| {
            gradient(passive, waveform, &stages, multiplier, integrand)
        };
        let energy = stages
            .iter()
            .enumerate()
            .map(|(index, stage)| {
                let power = (stage.rate.transpose() * stage.first.power * stage.rate)[0];
                LENGTH * WEIGHTS[index % STAGES] * power
            })
            .sum();
        Ok(Self {
            displacement,
            energy,
            start,
            d_displacement: sweep(&travel),
            d_energy: sweep(&work),
        })
    }
}

/// Angle and rate of the driven joint at the stages of each step.
fn drives(waveform: &Waveform) -> Vec<Drive> {
    (0..STEPS)
        .map(|step| NODES.map(|node| waveform.at((step as f64 + node) * LENGTH)))
        .collect()
}

/// Steps of the limit cycle, its start and its Floquet multiplier.
fn periodic(
    model: &Model<f64>,
    passive: &PassiveJoint,
    drives: &[Drive],
) -> Result<(Vec<Step>, f64, f64), PassiveError> {
    let mut steps = Vec::with_capacity(STEPS);
    let (start, multiplier) = fixed_point(|start| {
        steps.clear();
        let (mut angle, mut growth) = (start, 1.0);
        for drive in drives {
            let step = Step::new(model, passive, drive, angle, LENGTH)?;
            angle = step.end;
            growth *= step.growth;
            steps.push(step);
        }
        Some(CycleEnd { angle, growth })
    })?;
    Ok((steps, start, multiplier))
}

/// Stages with the pose of the swimmer, and the position after the cycle.
fn swum(
    model: &Model<f64>,
    passive: &PassiveJoint,
    drives: &[Drive],
    steps: &[Step],
) -> (Vec<Stage>, Vector2<f64>) {
    let matrix = coefficients();
    let weights = Vector3::from(WEIGHTS);
    let (mut heading, mut position) = (0.0, Vector2::zeros());
    let mut stages = Vec::with_capacity(STEPS * STAGES);
    for (index, (drive, step)) in drives.iter().zip(steps).enumerate() {
        let firsts: [FirstDerivatives<f64>; STAGES] = std::array::from_fn(|i| {
            model.first_derivatives(&passive.shape(drive[i][0], step.angles[i]))
        });
        let rates: [Vector2<f64>; STAGES] =
            std::array::from_fn(|i| passive.shape(drive[i][1], step.rates[i]));
        let bodies: [Vector3<f64>; STAGES] =
            std::array::from_fn(|i| firsts[i].connection * rates[i]);
        let turning = Vector3::from(bodies.map(|body| body.z));
        let headings = matrix * turning * LENGTH + Vector3::repeat(heading);
        let velocities: [Vector2<f64>; STAGES] =
            std::array::from_fn(|i| turned(&bodies[i].xy(), headings[i]));
        for i in 0..STAGES {
            let moved: Vector2<f64> = (0..STAGES)
                .map(|j| velocities[j] * (matrix[(i, j)] * LENGTH))
                .sum();
            stages.push(Stage {
                u: (index as f64 + NODES[i]) * LENGTH,
                angle: step.angles[i],
                slope: step.slopes[i],
                rate: rates[i],
                first: firsts[i],
                position: position + moved,
                heading: headings[i],
            });
        }
        heading += LENGTH * weights.dot(&turning);
        for i in 0..STAGES {
            position += velocities[i] * (WEIGHTS[i] * LENGTH);
        }
    }
    (stages, position)
}

fn turned(vector: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(
        cos * vector.x - sin * vector.y,
        sin * vector.x + cos * vector.y,
    )
}

/// Integrand of the displacement along a direction: the costate of the pose times A Φ′.
fn travel(stage: &Stage, along: &Vector2<f64>, end: &Vector2<f64>) -> Integrand {
    let rest = end - stage.position;
    let in_body = turned(along, -stage.heading);
    let costate = Vector3::new(in_body.x, in_body.y, rest.perp(along));
    let [one, two] = [0, 1].map(|k| costate.dot(&(stage.first.d_connection[k] * stage.rate)));
    Integrand {
        by_shape: Vector2::new(one, two),
        by_rate: stage.first.connection.transpose() * costate,
    }
}

/// Integrand of the energy, Φ′ᵀWΦ′.
fn work(stage: &Stage) -> Integrand {
    let [one, two] =
        [0, 1].map(|k| (stage.rate.transpose() * stage.first.d_power[k] * stage.rate)[0]);
    Integrand {
        by_shape: Vector2::new(one, two),
        by_rate: stage.first.power * stage.rate * 2.0,
    }
}

/// Derivatives of an integral over the cycle with respect to the coefficients of the waveform and κ.
fn gradient(
    passive: &PassiveJoint,
    waveform: &Waveform,
    stages: &[Stage],
    multiplier: f64,
    integrand: &dyn Fn(&Stage) -> Integrand,
) -> DVector<f64> {
    let (p, d) = (passive.joint.index(), passive.driven().index());
    let integrands: Vec<Integrand> = stages.iter().map(integrand).collect();
    // The costate λ of φ_p runs backwards: λ′ = −(∂ψ/∂φ_p + (∂ψ/∂φ_p′ + λ) ∂φ_p′/∂φ_p), and it is periodic.
    let sources: Vec<f64> = stages
        .iter()
        .zip(&integrands)
        .map(|(stage, at)| at.by_shape[p] + at.by_rate[p] * stage.slope)
        .collect();
    let mut costates = vec![0.0; stages.len()];
    let particular = backwards(stages, &sources, 0.0, &mut costates);
    backwards(
        stages,
        &sources,
        particular / (1.0 - multiplier),
        &mut costates,
    );
    let count = waveform.coefficients().len();
    let mut sum = DVector::zeros(count + 1);
    for (index, stage) in stages.iter().enumerate() {
        let at = &integrands[index];
        let weight = LENGTH * WEIGHTS[index % STAGES];
        let pull = at.by_rate[p] + costates[index];
        let power = &stage.first.power;
        let along = &stage.first.d_power[d];
        let by_angle = at.by_shape[d]
            - pull * (along[(p, d)] * stage.rate[d] + along[(p, p)] * stage.rate[p])
                / power[(p, p)];
        let by_rate = at.by_rate[d] - pull * power[(p, d)] / power[(p, p)];
        for coefficient in 0..count {
            let [angle, rate] = Waveform::basis(coefficient, stage.u);
            sum[coefficient] += weight * (by_angle * angle + by_rate * rate);
        }
        sum[count] -= weight * pull * stage.angle / power[(p, p)];
    }
    sum
}

/// Solves the costate equation backwards from its value at u = 1; returns its value at u = 0.
fn backwards(stages: &[Stage], sources: &[f64], end: f64, costates: &mut [f64]) -> f64 {
    let weights = Vector3::from(WEIGHTS);
    let from_end = Matrix3::from_fn(|_, j| WEIGHTS[j]) - coefficients();
    let mut costate = end;
    for step in (0..STEPS).rev() {
        let at = step * STAGES;
        let slopes = Vector3::from_fn(|i, _| stages[at + i].slope);
        let source = Vector3::from_fn(|i, _| sources[at + i]);
        // Falling rates g = −λ′ at the stages, λ there being costate + LENGTH · from_end · g.
        let system = Matrix3::identity() - Matrix3::from_diagonal(&slopes) * from_end * LENGTH;
        let right = source + slopes * costate;
        // The matrix is regular: it is that of the converged step.
        let falling = system.lu().solve(&right).unwrap_or(right);
        let values = from_end * falling * LENGTH + Vector3::repeat(costate);
        costates[at..at + STAGES].copy_from_slice(values.as_slice());
        costate += LENGTH * weights.dot(&falling);
    }
    costate
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::Joint;
    use swimmer_model::Swimmer;

    /// Central differences of the values alone.
    #[test]
    fn derivatives_are_those_of_the_values() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let scale = crate::spring::straight_resistance(&model, Joint::Front);
        let coefficients = vec![0.9, -0.15, 0.2, 0.05, 0.03];
        for joint in [Joint::Front, Joint::Back] {
            let values = |shift: usize, by: f64| {
                let mut coefficients = coefficients.clone();
                let mut kappa = 5.0 * scale;
                match coefficients.get_mut(shift) {
                    Some(coefficient) => *coefficient += by,
                    None => kappa += by * scale,
                }
                let passive = PassiveJoint::new(joint, kappa).unwrap();
                CycleValues::new(&model, &Waveform::new(coefficients), &passive).unwrap()
            };
            let here = values(0, 0.0);
            for shift in 0..=coefficients.len() {
                let unit = if shift < coefficients.len() {
                    1.0
                } else {
                    scale
                };
                let (up, down) = (values(shift, 1e-5), values(shift, -1e-5));
                let pairs = [
                    (
                        up.displacement - down.displacement,
                        here.d_displacement[shift],
                        here.displacement,
                    ),
                    (up.energy - down.energy, here.d_energy[shift], here.energy),
                ];
                for (difference, derivative, size) in pairs {
                    let error = difference / 2e-5 - derivative * unit;
                    assert!(
                        error.abs() < 2e-8 * size.abs(),
                        "{joint:?} {shift}: {error:e} of {size:e}"
                    );
                }
            }
        }
    }
}
