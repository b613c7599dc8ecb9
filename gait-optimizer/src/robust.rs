//! Robust gaits: the best worst case, or the best mean, over the uncertainty of r_s and χ from a calibration and of the servos'
//! gain, compared with the nominal optimum.
//!
//! **Conditions.** For the mean with weights wₖ, Σ wₖ fₖ is stationary: on free arcs of a displacement gait the weighted
//! height h̄ = Σ wₖ μₖ·Fₖ vanishes and along bounds h̄ ≥ 0, each member with its own pose and body momentum (an ensemble
//! maximum principle: one control, many states); for the efficiency of a Fourier gait the weighted gradient vanishes; for speed the
//! costate is σ̄ = Σ wₖ σₖ, with the same switching functions, signs and integrals as of one swimmer. For the worst case the same
//! holds with multipliers λₖ in place of the weights, positive only for members that are the worst.
//!
//! **Families.** Displacement, free or with an upper bound: gaits with the arcs of the nominal optimum, any shape (spectral
//! collocation of h̄ = 0). Efficiency: doubly symmetric Fourier gaits of order N, one timing for all members. Speed: chains of
//! arcs, started at those of the fastest gait and corrected by an active-set update. No member may rotate: with a net rotation
//! the displacement of a cycle depends on its first sample. With equal side links no member rotates along a loop that is its own
//! image in φ₁ = −φ₂ or has the paper's symmetries, which the fastest gaits usually have; others are refused.
//!
//! **Gain.** A servo with gain g turns to g times the commanded angle, about the straight swimmer, as in a calibration. Bounds on
//! angles and rates apply to the commanded angles, which the robot limits.
//!
//! Values have the sign of the objective: for X < 0 the best gait has the least X.

#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: r_s, c_t"
)]

mod arcs;
mod certificate;
mod cycle;
mod ensemble;
mod error;
mod fourier;
mod newton;
mod nodes;
mod quarter;
mod speed;
#[cfg(test)]
mod tests;
mod uncertainty;
mod worst;

use swimmer_files::Bounds;
use swimmer_model::Swimmer;

use crate::certificate::{Certificate, Condition};
use crate::cycle::Cycle;
use crate::displacement::{DisplacementProblem, Heading, displacement_watched};
use crate::efficiency::Branch;
use crate::immobile::refuse_immobile;
use crate::member::Member;
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use arcs::Arcs;
use ensemble::{Ensemble, RobustSolution};
pub use error::RobustError;
use fourier::FourierFamily;
use newton::{Design, Family};
pub use speed::{RobustSpeed, robust_speed};
pub use uncertainty::Uncertainty;
use worst::find;

/// Statistic that a robust design maximises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Over {
    /// The worst case over box or ellipse.
    Worst,
    /// The mean over the normal distribution.
    Mean,
}

/// Values of a gait over the uncertainty: X/L per cycle, signed, ξ as timed, or |d|/(L T) \[1/s\].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "RobustValues")
)]
pub struct Values {
    /// For the estimates themselves.
    pub nominal: f64,
    /// Worst case: the least value in the required direction.
    pub worst: f64,
    /// In the mean.
    pub mean: f64,
}

impl Values {
    /// The value that a design maximises.
    fn of(&self, over: Over) -> f64 {
        match over {
            Over::Worst => self.worst,
            Over::Mean => self.mean,
        }
    }
}

/// A swimmer that holds the worst case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstCaseMember {
    /// r_s \[m\].
    pub sphere_radius: f64,
    /// χ.
    pub chi: f64,
    /// Gain of its servos: actual over commanded angle.
    pub gain: f64,
    /// λ, its share of the first-order condition.
    pub multiplier: f64,
}

/// Cost and benefit of robustness.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// Statistic that was maximised.
    pub over: Over,
    /// Values of the robust gait.
    pub values: Values,
    /// Values of the nominal optimum of the same family.
    pub nominal: Values,
    /// The swimmers that hold the worst case; none for a mean.
    pub held_by: Vec<WorstCaseMember>,
    /// Number of swimmers that the search for the worst case starts with, and number of swimmers in the mean.
    pub members: (usize, usize),
    /// `true` if the gait lies on another branch of optima than the nominal one and does not lead back to it: it is better for
    /// the estimates themselves, or another gait near it is best for them.
    pub off_branch: bool,
    /// Share of the cycle in which links cross, at most: of the gait over all gains, and of the nominal optimum with exact servos.
    pub links_cross: [f64; 2],
}

/// A robust gait, with cost and benefit of its robustness.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustGait {
    /// The gait; its numbers are those of the nominal swimmer.
    pub gait: OptimalGait,
    /// Cost and benefit of robustness.
    pub robustness: Robustness,
}

impl Robustness {
    /// Of the gait of this cycle, with the certificate of these checks and of what it brings, swum again.
    fn certified<D: Design>(
        ensemble: &Ensemble<'_>,
        design: &D,
        found: &RobustSolution<D::Point>,
        nominal: Values,
        [cycle, optimum]: [&Cycle; 2],
        certificate: Certificate,
    ) -> Result<(Self, Certificate), RobustError> {
        let crossing = |member: &Member| cycle.turned(member.gain).links_cross(&member.model);
        let holders = found.holders().iter();
        let holders = holders.map(|&(member, multiplier)| WorstCaseMember {
            sphere_radius: member.swimmer.sphere_radius,
            chi: member.swimmer.chi,
            gain: member.gain,
            multiplier,
        });
        let robustness = Self {
            over: found.over,
            values: ensemble.values(design, &found.point),
            nominal,
            held_by: holders.collect(),
            members: (ensemble.grid.len(), ensemble.normal.len()),
            off_branch: ensemble.is_off_branch(design, &found.point),
            links_cross: [
                ensemble.on_grid().map(crossing).fold(0.0, f64::max),
                optimum.links_cross(&ensemble.nominal.model),
            ],
        };
        let values = &robustness.values;
        let swum_again = certificate::swum_again(ensemble, design, found, cycle, values);
        let certificate = certificate.with(swum_again);
        if certificate.pass() {
            Ok((robustness, certificate))
        } else {
            Err(RobustError::NotCertified {
                failed: certificate.failures(),
            })
        }
    }
}

/// Returns the gait of most displacement, in the worst case or in the mean over the uncertainty, free or under an upper bound. r_s
/// and χ of the problem's swimmer give way to the estimates. Without a heading in the problem, the farther of both senses, swum
/// forwards. `watch` receives the progress of the searches, and 1 while the members are weighted.
///
/// # Errors
/// [`RobustError`] if no robust gait is found.
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
/// let robust = robust_displacement(&problem, &uncertainty, Over::Worst, &|_| ()).unwrap();
/// assert!(robust.robustness.values.worst >= robust.robustness.nominal.worst);
/// ```
pub fn robust_displacement(
    problem: &DisplacementProblem,
    uncertainty: &Uncertainty,
    over: Over,
    watch: Watch<'_>,
) -> Result<RobustGait, RobustError> {
    let of_sense = |heading| robust_of_sense(&problem.heading(heading), uncertainty, over, watch);
    let Some(heading) = problem.heading else {
        let both = [Heading::Forwards, Heading::Backwards].map(of_sense);
        return farther(both, over);
    };
    of_sense(heading)
}

/// The farther of two robust gaits, swum forwards; the reason if neither exists.
fn farther(
    [forwards, backwards]: [Result<RobustGait, RobustError>; 2],
    over: Over,
) -> Result<RobustGait, RobustError> {
    let carried = |found: &RobustGait| found.robustness.values.of(over);
    let found = match (forwards, backwards) {
        (Ok(forwards), Ok(backwards)) if carried(&backwards) > carried(&forwards) => backwards,
        (Ok(forwards), _) => forwards,
        (Err(_), Ok(backwards)) => backwards,
        (Err(RobustError::Nominal(forwards)), Err(RobustError::Nominal(backwards))) => {
            return Err(forwards.or_backwards(backwards).into());
        }
        (Err(RobustError::Nominal(_)), Err(closer)) | (Err(closer), _) => return Err(closer),
    };
    Ok(RobustGait {
        gait: found.gait.swum_forwards(),
        ..found
    })
}

/// The robust gait of the problem's heading, run counter-clockwise.
fn robust_of_sense(
    problem: &DisplacementProblem,
    uncertainty: &Uncertainty,
    over: Over,
    watch: Watch<'_>,
) -> Result<RobustGait, RobustError> {
    let ensemble = Ensemble::new(&problem.swimmer, &problem.bounds, uncertainty, watch)?;
    let of = |swimmer| {
        let problem = DisplacementProblem {
            swimmer,
            ..*problem
        };
        displacement_watched(&problem, watch)
    };
    let swimmer = ensemble.nominal.swimmer;
    let optimum = of(swimmer)?;
    let sign = optimum.displacement_over_length.signum();
    let mut family = Arcs::around(&optimum, sign)?;
    let start = family.solve(&family.start(), &[(ensemble.nominal, 1.0)])?;
    let nominal = ensemble.values(&family, &start);
    let found = match find(&family, &ensemble, over) {
        // Where the arcs of the nominal optimum do not lead to the best worst case, those of the worst swimmer's own may.
        Err(error @ RobustError::NotConverged { .. }) if over == Over::Worst => {
            let worst = ensemble.lowest(|member| family.value(&start, member));
            family = Arcs::around(&of(worst.ok_or(error)?.member.swimmer)?, sign)?;
            find(&family, &ensemble, over)?
        }
        found => found?,
    };
    let bounds = &problem.bounds;
    certified(&ensemble, &family, &found, nominal, bounds, &optimum.cycle)
}

/// The doubly symmetric Fourier gait of this order whose efficiency ξ, as timed, is the most in the worst case or in the mean.
/// r_s and χ of the swimmer give way to the estimates. Bounds are not designed for, only kept: a gait
/// beyond them is refused. `watch` receives 1 before each step, as their number is unknown.
///
/// # Errors
/// [`RobustError`] if no robust gait is found.
///
/// ```
/// use gait_optimizer::{Bounds, Branch, Over, Uncertainty, robust_efficiency};
/// use swimmer_model::Swimmer;
///
/// let purcell = Swimmer::purcell();
/// let uncertainty = Uncertainty { chi_interval: [1.9, 2.1], ..Uncertainty::none(0.0, 2.0) };
/// let small = (Branch::Small, 3);
/// let robust = robust_efficiency(&purcell, small, &Bounds::default(), &uncertainty, Over::Mean, &|_| ()).unwrap();
/// assert!((robust.gait.efficiency / 0.0123641546 - 1.0).abs() < 1e-2);
/// ```
pub fn robust_efficiency(
    swimmer: &Swimmer<f64>,
    (branch, order): (Branch, usize),
    bounds: &Bounds,
    uncertainty: &Uncertainty,
    over: Over,
    watch: Watch<'_>,
) -> Result<RobustGait, RobustError> {
    if !(1..=MOST_ORDER).contains(&order) {
        return Err(RobustError::Order { order });
    }
    if !swimmer.is_symmetric() {
        return Err(RobustError::Structure {
            problem: "the class of doubly symmetric gaits wants side links of one length",
        });
    }
    if bounds.min_angle.is_some() || bounds.sector {
        return Err(RobustError::Structure {
            problem: "efficiency knows no lower bound and no sector; leave them out",
        });
    }
    let ensemble = Ensemble::new(swimmer, bounds, uncertainty, watch)?;
    refuse_immobile(&ensemble.nominal.model, bounds)?;
    let family = FourierFamily::around(&ensemble.nominal, order, branch)?;
    let found = find(&family, &ensemble, over)?;
    let cycle = |x| family.cycle(&ensemble.nominal.model, x);
    let by = certificate::overstepped(&cycle(&found.point), bounds, &swimmer.links);
    if by > 1e-10 {
        let bounds = *bounds;
        return Err(RobustError::Bound { by, bounds });
    }
    let start = family.start();
    let nominal = ensemble.values(&family, &start);
    certified(&ensemble, &family, &found, nominal, bounds, &cycle(&start))
}

/// Highest order of a Fourier gait.
const MOST_ORDER: usize = 12;

/// Certifies a gait and compares it with the nominal `optimum`. Fails if its certificate does not pass.
fn certified<F: Family>(
    ensemble: &Ensemble<'_>,
    family: &F,
    found: &RobustSolution<F::Point>,
    nominal: Values,
    bounds: &Bounds,
    optimum: &Cycle,
) -> Result<RobustGait, RobustError> {
    let Member { swimmer, model, .. } = &ensemble.nominal;
    let cycle = family.cycle(model, &found.point);
    let stroke = cycle.swum(model).ok_or(RobustError::Structure {
        problem: "the robust gait's samples cannot be swum",
    })?;
    let mut checks = family.conditions(&found.point, &found.weighted);
    checks.extend(certificate::of_curve(&cycle, bounds, &swimmer.links));
    // Gaits with the paper's symmetries move along the heading only.
    checks.push(Condition::NoLateral.check(stroke.displacement.y.abs()));
    checks.push(Condition::NoRotation.check(stroke.rotation.abs()));
    let certificate = Certificate::new(checks);
    let cycles = [&cycle, optimum];
    let (robustness, certificate) =
        Robustness::certified(ensemble, family, found, nominal, cycles, certificate)?;
    let of = (F::OBJECTIVE, swimmer, bounds);
    Ok(RobustGait {
        gait: OptimalGait {
            certificate,
            ..OptimalGait::of_cycle(of, true, cycle, &stroke)
        },
        robustness,
    })
}
