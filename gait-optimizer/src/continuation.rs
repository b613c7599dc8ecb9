//! Continuation (homotopy) of an optimum in a parameter: the largest angle, χ, the sphere, or the ratio of the links.
//!
//! Each step starts from the last gait and is halved if the next one is too far away, so that another branch is not taken for
//! this one. Events are reported with the parameter value: arcs that appear or vanish, folds, branches that meet or overtake each
//! other, extremals that cease to be optima.
//!
//! | module | contents |
//! |---|---|
//! | `parameter` | what changes |
//! | `follow` | step control, and the search for the places of events |
//! | `branch_point` | a gait on the way, and how far it is from another one |
//! | `efficiency` | the next gait by shooting from the last one's arcs; folds proven by the extremal beyond |
//! | `displacement` | the next gait as the nearest of all that the search finds |
//! | `branch_crossing` | two branches side by side |

mod branch_crossing;
mod branch_point;
mod displacement;
mod efficiency;
mod error;
mod follow;
mod parameter;
#[cfg(test)]
mod tests;

use serde::{Serialize, Serializer};
use swimmer_files::{ArcKind, Bounds, Objective};
use swimmer_model::Swimmer;

use crate::certificate::{Certificate, Condition};
use crate::displacement::Heading;
use crate::efficiency::Branch;
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use branch_point::BranchPoint;
pub use error::ContinuationError;
use follow::{Family, Track};
pub use parameter::Parameter;

/// Start of a branch.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// The small or large efficiency gait at the first value.
    Efficiency(Branch),
    /// A gait of most displacement at the first value, run counter-clockwise.
    Displacement {
        /// Sense of X.
        heading: Heading,
        /// 0 for the one that carries farthest, 1 for the next local optimum, and so on.
        rank: usize,
    },
    /// A gait at (or near) the first value, of an atlas for instance. A displacement gait must have the paper's two symmetries;
    /// an efficiency gait that has them is followed among such gaits only, any other as a closed curve.
    Gait(Box<OptimalGait>),
}

/// Inputs of a continuation.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuationProblem {
    /// The swimmer; the parameter's own value in it does not matter.
    pub swimmer: Swimmer<f64>,
    /// [`Objective::Efficiency`] or [`Objective::Displacement`].
    pub objective: Objective,
    /// The bounds; the largest angle does not matter where it is the parameter.
    pub bounds: Bounds,
    /// Parameter that changes.
    pub parameter: Parameter,
    /// Its first value (rad, metres or none).
    pub from: f64,
    /// Its last value.
    pub to: f64,
    /// The branches; several are compared with each other.
    pub starts: Vec<Start>,
    /// Equal steps whose ends all branches stop at; more points lie between them where steps must be smaller.
    pub steps: usize,
    /// Samples of each gait's cycle, at least.
    pub samples: usize,
}

impl ContinuationProblem {
    /// In 20 steps, without bounds.
    pub fn new(
        swimmer: Swimmer<f64>,
        parameter: Parameter,
        [from, to]: [f64; 2],
        start: Start,
    ) -> Self {
        let objective = match &start {
            Start::Efficiency(_) => Objective::Efficiency,
            Start::Displacement { .. } => Objective::Displacement,
            Start::Gait(gait) => gait.objective,
        };
        Self {
            swimmer,
            objective,
            bounds: Bounds::default(),
            parameter,
            from,
            to,
            starts: vec![start],
            steps: 20,
            samples: 512,
        }
    }
}

/// A gait on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Index of the start of this branch.
    pub branch: usize,
    /// The parameter.
    pub value: f64,
    /// The gait, with its numbers, arcs and certificate.
    pub gait: OptimalGait,
    /// Residual of the shooting (efficiency), or remaining λ₄ over L at the end of the quarter (displacement).
    pub residual: f64,
}

/// Something that happened on the way.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "ContinuationEvent")
)]
pub struct Event {
    /// Index of the start of the branch with this event.
    pub branch: usize,
    /// The parameter's value.
    pub value: f64,
    /// The value is as sure as this, either way.
    pub within: f64,
    /// Kind and data of the event.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// Kinds of event along a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum EventKind {
    /// An arc appeared or vanished.
    Structure {
        /// Arcs before.
        #[serde(rename = "arcs_before")]
        before: Vec<ArcKind>,
        /// Arcs after.
        #[serde(rename = "arcs_after")]
        after: Vec<ArcKind>,
    },
    /// The branch turns back.
    Fold(Fold),
    /// The nearest gait beyond, within `within`, is further off than a step may lead: it may be another branch's, or the same
    /// branch after a gap in the search. It is followed from here on.
    Jump {
        /// Power of the distance in the parameter that the gait changed with before; 1 where it changed evenly.
        #[serde(skip_serializing_if = "Option::is_none")]
        exponent: Option<f64>,
        /// Largest distance of the two curves \[rad\].
        #[serde(rename = "apart_rad")]
        apart: f64,
    },
    /// The gait of this branch becomes the gait of another branch.
    Merger {
        /// The other branch.
        #[serde(rename = "other_branch")]
        with: usize,
    },
    /// Another branch becomes the better one.
    Overtaken {
        /// The other branch.
        #[serde(rename = "other_branch")]
        by: usize,
    },
    /// From here on it is an optimum only among gaits with its symmetries (`alone`), or again one among all closed curves. The
    /// test uses a finite mesh and may detect the loss late.
    Symmetry {
        /// Only among those.
        #[serde(rename = "optimal_among_symmetric_alone")]
        alone: bool,
    },
    /// There is a gait, but it is no optimum any more.
    Lost {
        /// The conditions that it fails.
        #[serde(rename = "reason")]
        failed: String,
    },
    /// No gait is found beyond.
    Ended {
        /// Exponent, as for a jump.
        #[serde(skip_serializing_if = "Option::is_none")]
        exponent: Option<f64>,
        /// Why, as far as is known.
        reason: String,
    },
    /// The last value is reached.
    Reached,
}

/// A fold: the branch meets another one and neither goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    /// The other extremal, shortly before: the proof. Without it the fold rests on `exponent` alone.
    pub other: Option<OtherSide>,
    /// Power of the distance to the fold that the gait changed with before; ½ at a fold.
    pub exponent: Option<f64>,
}

/// JSON form of a fold.
#[derive(Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Fold")
)]
struct FoldDocument {
    /// The other extremal was found.
    proven: bool,
    /// The other extremal, shortly before.
    #[serde(skip_serializing_if = "Option::is_none")]
    other_side: Option<OtherSide>,
    /// Power of the distance to the fold that the gait changed with before; ½ at a fold.
    #[serde(skip_serializing_if = "Option::is_none")]
    exponent: Option<f64>,
}

impl Serialize for Fold {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let document = FoldDocument {
            proven: self.other.is_some(),
            other_side: self.other,
            exponent: self.exponent,
        };
        document.serialize(serializer)
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Fold {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        FoldDocument::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        FoldDocument::json_schema(generator)
    }
}

/// The extremal that a branch meets in a fold: its Jacobian has the other orientation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "FoldOtherSide")
)]
pub struct OtherSide {
    /// Parameter value of the fold.
    pub value: f64,
    /// Its efficiency.
    pub efficiency: f64,
    /// φ₁ at its start \[rad\].
    #[serde(rename = "start_angle_rad")]
    pub start_angle: f64,
    /// Along how many directions its efficiency grows to second order; 0 for an optimum.
    pub ascent_directions: Option<usize>,
}

/// All branches with all that happened to them.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuation {
    /// Branch by branch, in the order in which they were followed.
    pub points: Vec<Point>,
    /// Branch by branch; events between branches come last.
    pub events: Vec<Event>,
}

impl ContinuationProblem {
    fn swimmer_at(&self, value: f64) -> Swimmer<f64> {
        self.parameter.swimmer(&self.swimmer, value)
    }

    fn bounds_at(&self, value: f64) -> Bounds {
        self.parameter.bounds(&self.bounds, value)
    }
}

/// Follows every start from the first value of the parameter to the last, or to the end of its branch, with a progress callback.
///
/// # Errors
/// [`ContinuationError`]: what is wrong with the problem, or that there is no gait to begin with. A branch that ends on the
/// way is no error but an event.
///
/// ```
/// use std::sync::Mutex;
/// use gait_optimizer::{Branch, ContinuationProblem, Parameter, Start, continuation};
/// use swimmer_model::Swimmer;
///
/// let way = [2.0, 2.1];
/// let start = Start::Efficiency(Branch::Small);
/// let problem = ContinuationProblem { steps: 2, ..ContinuationProblem::new(Swimmer::purcell(), Parameter::Chi, way, start) };
/// let shares = Mutex::new(Vec::new());
/// let followed = continuation(&problem, &|share| shares.lock().unwrap().push(share)).unwrap();
/// let ends: Vec<f64> = followed.points.iter().map(|point| point.value).collect();
/// assert!(ends.contains(&2.0) && ends.contains(&2.1), "{ends:?}");
/// assert!(shares.into_inner().unwrap().is_sorted());
/// ```
pub fn continuation(
    problem: &ContinuationProblem,
    watch: Watch<'_>,
) -> Result<Continuation, ContinuationError> {
    problem.validate()?;
    match problem.objective {
        Objective::Efficiency => all(problem, &efficiency::Efficiency { problem }, watch),
        _ => all(problem, &displacement::Displacement { problem }, watch),
    }
}

fn all<F: Family>(
    problem: &ContinuationProblem,
    family: &F,
    watch: Watch<'_>,
) -> Result<Continuation, ContinuationError> {
    let mut tracks: Vec<Track> = Vec::with_capacity(problem.starts.len());
    for (branch, start) in problem.starts.iter().enumerate() {
        let first: BranchPoint =
            family
                .start(start)
                .map_err(|reason| ContinuationError::NoStart {
                    parameter: problem.parameter,
                    from: problem.from,
                    branch,
                    reason,
                })?;
        let branches = problem.starts.len() as f64;
        let watch = |share: f64| watch((branch as f64 + share) / branches);
        tracks.push(follow::follow(problem, family, branch, first, &watch));
    }
    let meetings = branch_crossing::meetings(problem, family, &tracks);
    let mut found = Continuation {
        points: Vec::new(),
        events: Vec::new(),
    };
    for (branch, track) in tracks.into_iter().enumerate() {
        let points = track.kept.into_iter();
        found.points.extend(points.map(|kept| Point {
            branch,
            value: kept.value,
            residual: residual(&kept.gait.certificate),
            gait: kept.gait,
        }));
        found.events.extend(track.events);
    }
    found.events.extend(meetings);
    Ok(found)
}

/// Largest residual among the conditions that a gait of the branch is solved from.
fn residual(certificate: &Certificate) -> f64 {
    let residuals = [Condition::ShootingResidual, Condition::FinalLambda4];
    let mut residual = residuals.into_iter().filter_map(|of| certificate.value(of));
    residual.next().unwrap_or(f64::NAN)
}
