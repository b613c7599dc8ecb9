//! Gaits for a swimmer that is not known exactly: the best worst case, or the best mean, over what a calibration leaves open
//! of r_s and χ, beside what the nominal optimum would bring there.
//!
//! **Conditions.** For the mean with weights wₖ, Σ wₖ fₖ is stationary: on free arcs of a displacement gait the weighted
//! height h̄ = Σ wₖ μₖ·Fₖ vanishes and along bounds h̄ ≥ 0, each member with its own pose and body momentum (an ensemble
//! maximum principle: one control, many states); for the efficiency of a Fourier gait the weighted gradient vanishes. For the
//! worst case the same holds with multipliers λₖ in place of the weights, positive only for members that are the worst.
//!
//! **Families.** Displacement, free or with an upper bound: gaits with the arcs of the nominal optimum, any shape (spectral
//! collocation of h̄ = 0). Efficiency: doubly symmetric Fourier gaits of order N, one timing for all members.
//!
//! Values are signed as the objective asks: a gait for X < 0 is best where X is least.

#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: r_s, c_t"
)]

mod arcs;
mod certificate;
mod cycle;
mod fourier;
mod newton;
mod nodes;
mod quarter;
#[cfg(test)]
mod tests;
mod uncertainty;
mod worst;

use nalgebra::DVector;
use swimmer_files::{Bounds, Objective};
use swimmer_model::{InvalidSwimmer, Model, Swimmer};

use crate::cycle::Cycle;
use crate::immobile::refuse_immobile;
use crate::optimal_gait::Solution;
use crate::{
    Branch, Certificate, DisplacementError, DisplacementProblem, Heading, Immobile, OptimalGait,
    displacement,
};
use arcs::Arcs;
use fourier::FourierFamily;
use newton::Design;
pub use uncertainty::Uncertainty;

/// What a robust design maximises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Over {
    /// The worst case over box or ellipse.
    Worst,
    /// The mean over the normal distribution.
    Mean,
}

/// Why there is no robust design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobustError {
    /// The nominal optimum does not exist.
    #[error("the nominal problem comes first, and there: {0}")]
    Nominal(#[from] DisplacementError),
    /// A member is no swimmer.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// Gaits do not move the swimmer of the estimates.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// The uncertainty makes no sense.
    #[error("the {name} of the fit is {value}; {problem}")]
    Uncertainty {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        problem: &'static str,
    },
    /// The order of the Fourier series.
    #[error("a Fourier gait of order {order}: give 1 to 12")]
    Order {
        /// The order.
        order: usize,
    },
    /// The nominal gait is not of the family.
    #[error("{problem}")]
    Structure {
        /// What stands against it.
        problem: &'static str,
    },
    /// The search did not end.
    #[error(
        "the robust gait did not converge (residual {residual:.1e}): its arcs are not those of the nominal optimum, or the \
         intervals are too wide for one gait; give narrower intervals, or optimise for their corners one by one"
    )]
    NotConverged {
        /// What was left.
        residual: f64,
    },
    /// A bound that the family does not know is broken.
    #[error(
        "the robust gait turns a joint to {reach:.4} rad, beyond {max_angle} rad; Fourier gaits are designed without bounds, so \
         take a lower order, the small gait, or leave the bound out"
    )]
    Bound {
        /// The largest angle \[rad\].
        reach: f64,
        /// The bound \[rad\].
        max_angle: f64,
    },
    /// A condition does not hold.
    #[error("a robust gait was found, but it does not hold: {failed}")]
    NotCertified {
        /// What failed.
        failed: String,
    },
}

/// What a gait brings over the uncertainty: X/L per cycle, signed, or ξ as timed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    /// For the estimates themselves.
    pub nominal: f64,
    /// In the worst case: the least gain in the direction asked for.
    pub worst: f64,
    /// In the mean.
    pub mean: f64,
}

/// A robust gait, with what robustness costs and brings.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustGait {
    /// The gait; its numbers are those of the nominal swimmer.
    pub gait: OptimalGait,
    /// What was maximised.
    pub over: Over,
    /// What it brings.
    pub values: Values,
    /// What the nominal optimum of the same family brings.
    pub nominal: Values,
    /// The members that hold the worst case, r_s \[m\], χ and multiplier; empty for a mean.
    pub held_by: Vec<[f64; 3]>,
    /// How many swimmers the worst case was looked for among, and how many the mean is taken of.
    pub members: (usize, usize),
}

impl RobustGait {
    /// Whether the gait is better than the nominal optimum for the estimates themselves: then that optimum was only the best
    /// of its neighbourhood, and the robust gait lies in another, where the nominal branch does not reach.
    pub fn off_branch(&self) -> bool {
        let sign = self.nominal.nominal.signum();
        sign * self.values.nominal > sign * self.nominal.nominal + 1e-6 * self.nominal.nominal.abs()
    }
}

/// Steps of the grid among which the worst case is looked for.
const GRID: u32 = 4;

/// All swimmers of a problem, measured in their own length.
struct Ensemble {
    nominal: Model<f64>,
    candidates: Vec<Model<f64>>,
    /// Of the candidates, as they are in metres.
    swimmers: Vec<Swimmer<f64>>,
    normal: Vec<Model<f64>>,
    weights: Vec<f64>,
}

/// A design found: parameters, the members that its first-order condition weighs, and who holds the worst case.
struct Found {
    x: DVector<f64>,
    held_by: Vec<[f64; 3]>,
    weighted: Vec<(Model<f64>, f64)>,
}

impl Ensemble {
    fn new(swimmer: &Swimmer<f64>, uncertainty: &Uncertainty) -> Result<Self, RobustError> {
        uncertainty.validate()?;
        let model = |swimmer: &Swimmer<f64>| Model::new(&swimmer.of_unit_length());
        let swimmers = uncertainty.candidates(swimmer, GRID);
        let normal = uncertainty.normal(swimmer);
        Ok(Self {
            nominal: model(&uncertainty.nominal(swimmer))?,
            candidates: swimmers.iter().map(model).collect::<Result<_, _>>()?,
            swimmers,
            weights: normal.iter().map(|(_, weight)| *weight).collect(),
            normal: normal
                .iter()
                .map(|(swimmer, _)| model(swimmer))
                .collect::<Result<_, _>>()?,
        })
    }

    fn find(&self, design: &impl Design, over: Over) -> Result<Found, RobustError> {
        match over {
            Over::Mean => {
                let weighted: Vec<(Model<f64>, f64)> = self
                    .normal
                    .iter()
                    .copied()
                    .zip(self.weights.iter().copied())
                    .collect();
                let x = design.solve(&design.start(), &borrowed(&weighted))?;
                Ok(Found {
                    x,
                    held_by: Vec::new(),
                    weighted,
                })
            }
            Over::Worst => {
                let held = worst::worst(design, &self.candidates)?;
                let active = || {
                    held.active.iter().filter_map(|&(member, weight)| {
                        Some((
                            self.candidates.get(member)?,
                            self.swimmers.get(member)?,
                            weight,
                        ))
                    })
                };
                Ok(Found {
                    held_by: active()
                        .map(|(_, swimmer, weight)| [swimmer.sphere_radius, swimmer.chi, weight])
                        .collect(),
                    weighted: active()
                        .map(|(model, _, weight)| (*model, weight))
                        .collect(),
                    x: held.x,
                })
            }
        }
    }

    /// Where the arcs of the nominal optimum do not lead to the best worst case, those of the worst swimmer's own may.
    fn find_around_worst(
        &self,
        problem: &DisplacementProblem,
        family: &Arcs,
        sign: f64,
    ) -> Result<(Arcs, Found), RobustError> {
        let values = family.values(&family.start(), &self.candidates);
        let worst = values
            .iter()
            .zip(self.swimmers.iter().zip(&self.candidates))
            .min_by(|a, b| a.0.total_cmp(b.0));
        let Some((_, (swimmer, model))) = worst else {
            return Err(RobustError::NotConverged { residual: f64::NAN });
        };
        let own = displacement(&DisplacementProblem {
            swimmer: *swimmer,
            ..*problem
        })?;
        let family = Arcs::around(&own, model, sign)?;
        let found = self.find(&family, Over::Worst)?;
        Ok((family, found))
    }

    fn values(&self, design: &impl Design, x: &DVector<f64>, sign: f64) -> Values {
        let first = |models: &[Model<f64>]| design.values(x, models).first().copied();
        let worst = design
            .values(x, &self.candidates)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let mean: f64 = design
            .values(x, &self.normal)
            .iter()
            .zip(&self.weights)
            .map(|(value, weight)| value * weight)
            .sum();
        Values {
            nominal: sign * first(std::slice::from_ref(&self.nominal)).unwrap_or(f64::NAN),
            worst: sign * worst,
            mean: sign * mean,
        }
    }
}

fn borrowed(weighted: &[(Model<f64>, f64)]) -> Vec<(&Model<f64>, f64)> {
    weighted
        .iter()
        .map(|(model, weight)| (model, *weight))
        .collect()
}

/// The gait whose displacement, in the worst case or in the mean over the uncertainty, is the most, free or under an upper
/// bound. r_s and χ of the problem's swimmer give way to the estimates.
///
/// # Errors
/// [`RobustError`]: why there is none.
///
/// ```
/// use gait_optimizer::{DisplacementProblem, Over, Uncertainty, robust_displacement};
/// use swimmer_model::Swimmer;
///
/// let robot = Swimmer::robot();
/// let uncertainty = Uncertainty {
///     chi_interval: [3.4, 3.8],
///     ..Uncertainty::none(robot.sphere_radius, robot.chi)
/// };
/// let problem = DisplacementProblem::new(robot).with_max_angle(1.5);
/// let robust = robust_displacement(&problem, &uncertainty, Over::Worst).unwrap();
/// assert!(robust.values.worst >= robust.nominal.worst);
/// ```
pub fn robust_displacement(
    problem: &DisplacementProblem,
    uncertainty: &Uncertainty,
    over: Over,
) -> Result<RobustGait, RobustError> {
    // Corners of a gait that touches its own images move with every swimmer of the ensemble.
    let problem = &DisplacementProblem {
        simple: true,
        ..*problem
    };
    let ensemble = Ensemble::new(&problem.swimmer, uncertainty)?;
    let swimmer = uncertainty.nominal(&problem.swimmer);
    let nominal = displacement(&DisplacementProblem {
        swimmer,
        ..*problem
    })?;
    let sign = if nominal.displacement_over_length < 0.0 {
        Heading::Backwards
    } else {
        Heading::Forwards
    }
    .sign();
    let family = Arcs::around(&nominal, &ensemble.nominal, sign)?;
    let start = family.solve(&family.start(), &[(&ensemble.nominal, 1.0)])?;
    let nominal = ensemble.values(&family, &start, sign);
    let (family, found) = match ensemble.find(&family, over) {
        Err(RobustError::NotConverged { .. }) if over == Over::Worst => {
            ensemble.find_around_worst(problem, &family, sign)?
        }
        found => (family, found?),
    };
    let values = ensemble.values(&family, &found.x, sign);
    let (cycle, arcs) = cycle::of_arcs(&ensemble.nominal, &family, &found.x);
    let mut checks = certificate::of_arcs(&family, &found.x, &borrowed(&found.weighted));
    checks.extend(certificate::of_curve(
        &cycle,
        &problem.bounds,
        &swimmer.links,
    ));
    checks.extend(certificate::of_displacement(
        &ensemble,
        &cycle,
        &values,
        sign,
        &found.held_by,
    ));
    finish(
        Objective::Displacement,
        (&swimmer, problem.bounds),
        &ensemble,
        (cycle, arcs),
        checks,
        RobustParts {
            over,
            values,
            nominal,
            held_by: found.held_by,
        },
    )
}

/// The doubly symmetric Fourier gait of this order whose efficiency ξ, as timed, is the most in the worst case or in the mean.
/// r_s and χ of the swimmer give way to the estimates. Bounds are not designed for, only kept: a gait
/// beyond them is refused.
///
/// # Errors
/// [`RobustError`]: why there is none.
///
/// ```
/// use gait_optimizer::{Bounds, Branch, Over, Uncertainty, robust_efficiency};
/// use swimmer_model::Swimmer;
///
/// let purcell = Swimmer::purcell();
/// let uncertainty = Uncertainty { chi_interval: [1.9, 2.1], ..Uncertainty::none(0.0, 2.0) };
/// let small = (Branch::Small, 3);
/// let robust = robust_efficiency(&purcell, small, &Bounds::default(), &uncertainty, Over::Mean).unwrap();
/// assert!((robust.gait.efficiency / 0.0123641546 - 1.0).abs() < 1e-2);
/// ```
pub fn robust_efficiency(
    swimmer: &Swimmer<f64>,
    (branch, order): (Branch, usize),
    bounds: &Bounds,
    uncertainty: &Uncertainty,
    over: Over,
) -> Result<RobustGait, RobustError> {
    if !(1..=MOST_ORDER).contains(&order) {
        return Err(RobustError::Order { order });
    }
    let links = swimmer.links;
    if (links.front - links.back).abs() > 1e-12 * links.front.abs() {
        return Err(RobustError::Structure {
            problem: "the class of doubly symmetric gaits wants side links of one length",
        });
    }
    if bounds.min_angle.is_some() || bounds.sector {
        return Err(RobustError::Structure {
            problem: "efficiency knows no lower bound and no sector; leave them out",
        });
    }
    let ensemble = Ensemble::new(swimmer, uncertainty)?;
    let swimmer = uncertainty.nominal(swimmer);
    refuse_immobile(&ensemble.nominal, bounds)?;
    let family = FourierFamily::around(&ensemble.nominal, order, branch)?;
    let found = ensemble.find(&family, over)?;
    let values = ensemble.values(&family, &found.x, 1.0);
    let (cycle, arcs) = cycle::of_series(&FourierFamily::gait(&found.x));
    let reach = cycle
        .phi
        .iter()
        .map(nalgebra::Matrix::amax)
        .fold(0.0, f64::max);
    if let Some(max_angle) = bounds.max_angle
        && reach > max_angle
    {
        return Err(RobustError::Bound { reach, max_angle });
    }
    let mut checks = certificate::of_series(&family, &found.x, &borrowed(&found.weighted));
    checks.extend(certificate::of_curve(&cycle, bounds, &swimmer.links));
    checks.extend(certificate::of_efficiency(
        &ensemble,
        &cycle,
        &values,
        &found.held_by,
    ));
    finish(
        Objective::Efficiency,
        (&swimmer, *bounds),
        &ensemble,
        (cycle, arcs),
        checks,
        RobustParts {
            over,
            values,
            nominal: ensemble.values(&family, &family.start(), 1.0),
            held_by: found.held_by,
        },
    )
}

/// Highest order of a Fourier gait.
const MOST_ORDER: usize = 12;

struct RobustParts {
    over: Over,
    values: Values,
    nominal: Values,
    held_by: Vec<[f64; 3]>,
}

fn finish(
    objective: Objective,
    (swimmer, bounds): (&Swimmer<f64>, Bounds),
    ensemble: &Ensemble,
    (cycle, arcs): (Cycle, Vec<crate::Arc>),
    checks: Vec<crate::Check>,
    parts: RobustParts,
) -> Result<RobustGait, RobustError> {
    let stroke = cycle
        .swum(&ensemble.nominal)
        .ok_or(RobustError::Structure {
            problem: "the robust gait's samples cannot be swum",
        })?;
    let certificate = Certificate::new(checks);
    if !certificate.pass() {
        return Err(RobustError::NotCertified {
            failed: certificate.failures(),
        });
    }
    let links_cross = cycle.links_cross(&ensemble.nominal);
    Ok(RobustGait {
        gait: OptimalGait::new(Solution {
            objective,
            swimmer: *swimmer,
            bounds,
            symmetric: true,
            arcs,
            cycle,
            stroke,
            links_cross,
            certificate,
        }),
        over: parts.over,
        values: parts.values,
        nominal: parts.nominal,
        held_by: parts.held_by,
        members: (ensemble.candidates.len(), ensemble.normal.len()),
    })
}
