//! Certificates for any gait from anywhere: the necessary conditions of an optimum, from the curve alone.
//!
//! A solver knows its multipliers; a file holds only samples. But the multipliers of an extremal follow from its curve: the
//! momentum p is parallel to the net displacement, and the conditions on the free arcs determine the multiplier of the rotation
//! (for gaits with the paper's symmetries it is −p y at a quarter). So every condition can be evaluated for every closed curve
//! ([`certify`]).
//!
//! Slopes come from the polynomials of degree eight through neighbouring samples, never across a corner or the end of an arc.
//! Polynomials of degree six estimate the uncertainty of the sampling. It is added to the tolerances, and a gait that is sampled
//! too coarsely fails the check of its sampling instead of passing the others by their width.

mod ascent;
mod bounds;
mod grid;
mod limits;
mod path;
mod regular;
mod resolution;
mod second_variation;
mod singular;
mod stencil;
mod subject;
mod symmetry;
mod variation;

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective};
use swimmer_model::{InvalidSamples, InvalidSwimmer, Model, Swimmer, Tolerance, swim};

use crate::certificate::{
    Certificate, Check, Condition, Dependence, SHARE, SWUM_AGAIN, Verdict, turning_number,
};
use crate::cycle::Cycle;
use crate::numerics::worse;
use crate::optimal_gait::OptimalGait;
use crate::region::Region;
use crate::speed::{certify_joined, certify_speed, turned_per_period};
pub(crate) use ascent::ways_up;
use grid::{Degree, Grid};
use resolution::with_uncertainty;
pub(crate) use second_variation::ascents_of_efficiency;
use subject::{Openness, Subject};
use symmetry::begun_on_the_diagonal;

/// Directions closer than this make no corner \[rad\].
const SMOOTH: f64 = 1e-6;
/// Tolerance of the difference between slopes of degree eight and six, over the slope, for objectives without a condition on
/// slopes.
const COARSEST_WEAKLY: f64 = 1e-2;

/// Reason why a gait cannot be certified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CertifyError {
    /// The swimmer's parameters are out of range.
    #[error("cannot certify a gait of this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// The samples are no closed curve.
    #[error("cannot certify this gait: {0}")]
    Samples(#[from] InvalidSamples),
    /// Too few samples for slopes.
    #[error(
        "cannot certify a gait of {samples} samples; give at least {}",
        GaitFile::FEWEST_SAMPLES
    )]
    TooFew {
        /// Number of samples.
        samples: usize,
    },
    /// Nothing is known of what the gait shall be optimal for.
    #[error(
        "cannot certify a gait without an objective: name displacement, efficiency, turning, sideways or speed"
    )]
    NoObjective,
}

/// Evaluates the necessary conditions of an optimum for `objective` within `bounds`.
///
/// `gait` is one cycle from any method, with or without a list of arcs; a clockwise gait is certified as its reverse, which is
/// optimal exactly when the gait is. The certificate has the same numbers for a gait that was written to a file and read again.
///
/// # Errors
/// [`CertifyError`] for an open curve, an invalid swimmer or an unsuitable objective. A gait that is not optimal is not an error:
/// its certificate does not pass.
///
/// ```
/// use gait_optimizer::{Bounds, DisplacementProblem, Objective, certify, displacement};
/// use swimmer_files::{AnyGait, GaitFile};
/// use swimmer_model::Swimmer;
///
/// let purcell = Swimmer::purcell();
/// let best = displacement(&DisplacementProblem::new(purcell)).unwrap().gait_file("purcell");
/// let circle = GaitFile::sampled(&AnyGait::circle(1.6331625), 400);
/// let asked = |gait| certify(&purcell, gait, Objective::Displacement, &Bounds::default());
/// assert!(asked(&best)?.pass() && !asked(&circle)?.pass());
/// # Ok::<(), gait_optimizer::CertifyError>(())
/// ```
pub fn certify(
    swimmer: &Swimmer<f64>,
    gait: &GaitFile,
    objective: Objective,
    bounds: &Bounds,
) -> Result<Certificate, CertifyError> {
    certify_swum((swimmer, objective, bounds), gait, None)
}

/// Returns the period in which a gait is the farthest, as the angle \[rad\] by which the faster servo turns in it at its full rate. Returns
/// `None` if it passes for no period.
///
/// A fastest gait that is scaled down is often still the farthest in its own, shorter period, although a longer cycle is faster.
///
/// # Errors
/// As [`certify`].
pub fn farthest_in_period(
    swimmer: &Swimmer<f64>,
    gait: &GaitFile,
    bounds: &Bounds,
) -> Result<Option<f64>, CertifyError> {
    let timed = GaitFile {
        optimal_period: Some(1.0),
        bounds: *bounds,
        ..gait.clone()
    };
    if !certify(swimmer, &timed, Objective::Speed, bounds)?.pass() {
        return Ok(None);
    }
    let model = Model::new(&swimmer.of_unit_length())?;
    let region = Region::new(bounds, &swimmer.links);
    let curve = AnyGait::from_file(&timed)?;
    Ok(turned_per_period(&model, (&timed, &curve), &region))
}

/// [`certify`] for a gait with known displacement over L.
fn certify_swum(
    of @ (swimmer, objective, _): (&Swimmer<f64>, Objective, &Bounds),
    gait: &GaitFile,
    swum: Option<Vector2<f64>>,
) -> Result<Certificate, CertifyError> {
    let model = Model::new(&swimmer.of_unit_length())?;
    swimmer.check_regular()?;
    if objective == Objective::Efficiency {
        swimmer.check_efficiency()?;
    }
    let asked = |gait: &GaitFile, swum| of_samples(&model, of, gait, swum);
    AnyGait::from_file(gait)?;
    // The first sample matters only for sideways gaits, which have their heading there, and for joined gaits.
    let begun = (objective != Objective::Sideways && !objective.is_joined())
        .then(|| begun_on_the_diagonal(gait))
        .flatten();
    let swum = swum.filter(|_| begun.is_none());
    let gait = begun.as_ref().unwrap_or(gait);
    let efficiency = objective == Objective::Efficiency;
    let certificate = asked(gait, swum)?;
    Ok(with_uncertainty(certificate, gait, efficiency, |other| {
        asked(other, None).ok()
    }))
}

/// [`certify_swum`] without the uncertainty due to the samples.
fn of_samples(
    model: &Model<f64>,
    (swimmer, objective, bounds): (&Swimmer<f64>, Objective, &Bounds),
    gait: &GaitFile,
    swum: Option<Vector2<f64>>,
) -> Result<Certificate, CertifyError> {
    let curve = AnyGait::from_file(gait)?;
    if gait.u.len() < GaitFile::FEWEST_SAMPLES || gait.u.last() != Some(&1.0) {
        return Err(CertifyError::TooFew {
            samples: gait.u.len(),
        });
    }
    if objective == Objective::Speed || objective.is_joined() {
        let bounded = GaitFile {
            bounds: *bounds,
            ..gait.clone()
        };
        let region = Region::new(bounds, &swimmer.links);
        let timed = (&bounded, &curve);
        let joined = certify_joined(model, timed, &region, objective);
        return Ok(joined.unwrap_or_else(|| certify_speed(model, timed, &region)));
    }
    let clockwise = turning_number(&gait.phi) < 0.0;
    let reversed = clockwise.then(|| gait.reversed());
    let (gait, curve) = (
        reversed.as_ref().unwrap_or(gait),
        curve.reversed_if(clockwise),
    );
    let swum = swum.filter(|_| !clockwise);
    let swum = swum.unwrap_or_else(|| swim(model, &curve, &Tolerance::default()).displacement);
    certify_turned((model, swimmer, objective, bounds), gait, (&curve, swum))
}

impl OptimalGait {
    /// The certificate that its file has, from the samples alone; see [`certify()`](crate::certify()).
    ///
    /// # Errors
    /// Never for a gait that this crate made.
    ///
    /// ```
    /// use gait_optimizer::{DisplacementProblem, displacement};
    /// use swimmer_model::Swimmer;
    ///
    /// let gait = displacement(&DisplacementProblem::new(Swimmer::purcell()))?;
    /// assert!(gait.certify().unwrap().pass());
    /// # Ok::<(), gait_optimizer::DisplacementError>(())
    /// ```
    pub fn certify(&self) -> Result<Certificate, CertifyError> {
        let file = self.gait_file("");
        certify(&self.swimmer, &file, self.objective, &self.bounds)
    }
}

/// A gait that an optimiser made, with the certificate that its file has.
pub(crate) fn certified(gait: OptimalGait) -> OptimalGait {
    // Of what makes no closed curve nothing holds.
    let nothing = |_| Certificate::new(vec![Condition::Closed.check(f64::NAN)]);
    let file = gait.gait_file("");
    let of = (&gait.swimmer, gait.objective, &gait.bounds);
    let certificate = certify_swum(of, &file, Some(gait.swum)).unwrap_or_else(nothing);
    OptimalGait {
        certificate,
        ..gait
    }
}

/// Certifies a gait with `samples` samples, then with twice as many up to 16 times, until it is decided if the gait is an optimum
/// among those of its symmetry. Returns the first certificate if no number of samples decides, `None` if the gait cannot be made.
pub(crate) fn decided(
    samples: usize,
    make: impl Fn(usize) -> Option<OptimalGait>,
) -> Option<OptimalGait> {
    /// Largest number of doublings.
    const FINEST: u32 = 4;
    let is_decided = |gait: &OptimalGait| {
        let without = [Condition::NoAscentWithoutSymmetry];
        gait.certificate.verdict_but(&without) != Verdict::Undecided
    };
    let first = certified(make(samples)?);
    if is_decided(&first) {
        return Some(first);
    }
    let mut finer = (1..=FINEST).filter_map(|times| Some(certified(make(samples << times)?)));
    finer.find(is_decided).or(Some(first))
}

/// Largest difference of the slopes of degree eight and six along an efficiency cycle, over the tolerance of [`certify`].
pub(crate) fn slopes_open(cycle: &Cycle) -> f64 {
    let file = cycle.file(Bounds::default());
    let (grid, shapes) = Grid::new(&file, &grid::along_arcs(&file));
    let [fine, coarse] = [Degree::Fine, Degree::Coarse].map(|degree| grid.slopes(&shapes, degree));
    let slopes = fine.iter().zip(&coarse);
    let apart = slopes.map(|(fine, coarse)| (fine - coarse).norm() / fine.norm());
    apart.fold(0.0, worse) / Condition::SlopesKnown.tolerance()
}

/// Checks of the uncertainty due to the sampling.
fn sampling(objective: Objective, open: Openness) -> [Check; 2] {
    let coarsest = if objective == Objective::Efficiency {
        Condition::SlopesKnown.tolerance()
    } else {
        COARSEST_WEAKLY
    };
    [
        Condition::SlopesKnown.within(open.slope, coarsest),
        Condition::PosesKnown.check(open.pose),
    ]
    .map(|check| check.depends_on(Dependence::Spacing))
}

/// [`certify`] for a counter-clockwise gait, with its curve and its displacement.
fn certify_turned(
    (model, swimmer, objective, bounds): (&Model<f64>, &Swimmer<f64>, Objective, &Bounds),
    gait: &GaitFile,
    (curve, swum): (&AnyGait, Vector2<f64>),
) -> Result<Certificate, CertifyError> {
    let subject = Subject::new(model, gait, (bounds, &swimmer.links));
    let open = subject.openness();
    let sampling = sampling(objective, open);
    let coarse = sampling.iter().any(|check| !check.pass);
    let mut checks = subject.of_the_curve(gait, curve, coarse);
    // Where effort counts a loop that turns back costs what it is, and a curve may cross itself.
    if objective != Objective::Efficiency {
        checks.extend(subject.of_its_loop(gait));
    }
    checks.extend(sampling);
    let [x, y, theta] = subject.path.end();
    let apart = |[a, b]: [f64; 2]| (a - x).hypot(b - y);
    let again = path::stepped(model, &subject.grid, &subject.shapes);
    let mut tolerance = SWUM_AGAIN + open.pose;
    if objective != Objective::Turning {
        tolerance = tolerance.min(SHARE * x.hypot(y));
    }
    checks.push(Condition::DisplacementSwumAgain.within(apart(swum.into()), tolerance));
    checks.push(Condition::DisplacementSteppedAgain.within(apart([again[0], again[1]]), tolerance));
    if objective != Objective::Turning {
        checks.push(Condition::NoRotation.open(theta.abs(), open.pose));
    }
    match objective {
        Objective::Displacement | Objective::Turning | Objective::Sideways => {
            checks.extend(subject.of_weak_optimum(objective, open));
        }
        Objective::Efficiency => checks.extend(subject.of_efficiency(open)),
        Objective::Speed
        | Objective::JoinedForward
        | Objective::JoinedSideways
        | Objective::JoinedTurning
        | Objective::Unspecified => return Err(CertifyError::NoObjective),
    }
    Ok(Certificate::new(checks))
}
