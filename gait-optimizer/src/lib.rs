//! Optimal control of the three-link swimmer: give it a swimmer, and it returns the best gaits, with their proof.
//!
//! [`displacement()`] finds the gaits of most net displacement by Pontryagin's maximum principle (paper, section IV): arcs on
//! which the control is singular, arcs along bounds of the joint angles, and the order of both, with no initial guess.
//! [`efficiency()`] finds the gaits of most Lighthill efficiency (section V), small and large.
//! Each result is an [`OptimalGait`] and carries its [`Certificate`]: the necessary conditions, each with its number.
//!
//! Modules:
//!
//! | module | contents |
//! |---|---|
//! | `problem` | checks of the inputs, common to all searches |
//! | `immobile` | swimmers that no gait moves, refused before anything is searched |
//! | `optimal_gait` | what every search returns: a gait with its figures and its certificate |
//! | `displacement` | the problem, the search for the quarter gait, the result |
//! | `momentum` | the multipliers as a momentum that the body carries, and the height: what a push of the curve gains; the flow of an arc |
//! | `height_map` | height functions in minimum-perturbation coordinates, their zero-level curves, the area rule |
//! | `atlas` | multi-start over closed curves of any symmetry, and which of them are one gait |
//! | `batch` | A and W at many shapes at once |
//! | `continuation` | an optimum followed in a parameter: folds, meetings, changes of its arcs |
//! | `closed_curve` | displacement, rotation and cost of any closed curve, with exact first and second derivatives |
//! | `loops` | closed loops of singular arcs and bounds, without any symmetry |
//! | `sideways` | the gait of most displacement across the heading at its start |
//! | [`region`] | the bounds: straight ones of the joint angles, and the curved one that keeps the side links apart |
//! | `arcs` | an arc of most displacement, integrated until an event ends it, and chains followed once more; of quarters and of closed curves |
//! | `displacement::flow` | what follows an arc of a quarter, and where quarters end |
//! | `displacement::start_family` | where singular arcs may begin: φ₁ = φ₂, and chains of bounds from there |
//! | `efficiency` | the small and the large Lighthill gait: Fourier series, then `extremal`, bounds followed |
//! | `extremal` | extremals of the efficiency as curves of shapes: reduced flow, shooting over arcs, second-order test |
//! | `cycle` | a full cycle at constant power, of a closed curve or of a quarter mirrored twice |
//! | `speed` | the fastest gait of servos with a limit on their rates |
//! | `turning` | the simple closed gait that turns most: round a region of the curvature |
//! | `robust` | gaits for a swimmer that is not known exactly: best worst case, best mean |
//! | `member` | one swimmer of an uncertain family, with the gain of its servos: actual over commanded angle |
//! | `certificate` | every condition with its key and tolerance, and checks |
//! | `certify` | conditions of any closed curve, from its samples alone: the certificate of turning, sideways and atlas gaits |
//! | [`closed_forms`] | formulas of the paper's appendix, with its misprints corrected |
//! | `simple_shapes` | circles and squares over their amplitude |
//! | `numerics` | bisection, root search, line search (damped steps), reductions that propagate NaN |
//! | `parallel` | jobs over threads, with a progress callback |
//! | `runge_kutta` | the integrator: order 8, steps that end where an event is |
//!
//! ```
//! use gait_optimizer::{Branch, DisplacementProblem, EfficiencyProblem, displacement, efficiency};
//! use swimmer_model::Swimmer;
//!
//! let farthest = displacement(&DisplacementProblem::new(Swimmer::purcell()))?;
//! assert!((farthest.displacement_over_length - 0.1035322400).abs() < 1e-10);
//! assert!(farthest.certificate.pass());
//!
//! let small = efficiency(&EfficiencyProblem::new(Swimmer::purcell(), Branch::Small)).unwrap();
//! assert!((small.efficiency - 0.012364154624).abs() < 1e-12);
//! # Ok::<(), gait_optimizer::DisplacementError>(())
//! ```
//!
//! Servos with a rate limit make time a part of it:
//!
//! ```
//! use gait_optimizer::{SpeedProblem, fastest};
//! use swimmer_model::Swimmer;
//!
//! let slow = fastest(&SpeedProblem { starts: 2, ..SpeedProblem::new(Swimmer::purcell(), [1.0; 2]) })?;
//! let quick = fastest(&SpeedProblem { starts: 2, ..SpeedProblem::new(Swimmer::purcell(), [2.0; 2]) })?;
//! assert!((quick.speed_over_length / slow.speed_over_length - 2.0).abs() < 1e-6, "time is a scale");
//! # Ok::<(), gait_optimizer::SpeedError>(())
//! ```

mod arcs;
mod atlas;
mod batch;
mod certificate;
mod certify;
mod closed_curve;
pub mod closed_forms;
mod continuation;
mod cycle;
mod displacement;
mod efficiency;
mod extremal;
mod height_map;
mod immobile;
mod loops;
mod member;
mod momentum;
mod numerics;
mod optimal_gait;
mod parallel;
mod problem;
pub mod region;
mod robust;
mod runge_kutta;
mod sideways;
mod simple_shapes;
mod speed;
mod turning;

pub use atlas::{Atlas, AtlasError, AtlasProblem, Optimum, StartCurves, atlas, atlas_watched};
pub use batch::{Batch, ConnectionsAndPowers};
pub use certificate::{Certificate, Check, Condition, Verdict};
pub use certify::{CertifyError, certify, farthest_in_period};
pub use continuation::{
    Continuation, ContinuationError, ContinuationProblem, Event, EventKind, Fold, OtherSide,
    Parameter, Point, Start, continuation,
};
pub use cycle::Arc;
pub use displacement::{
    DisplacementError, DisplacementProblem, ExtremalOutcomes, Heading, displacement,
    displacement_near, displacement_watched,
};
pub use efficiency::{
    Branch, Direct, EfficiencyError, EfficiencyProblem, EfficiencySeed, Method, ReachedBounds,
    efficiency, efficiency_by_order, efficiency_from, efficiency_watched,
};
pub use height_map::{
    AreaRule, Convergence, Frame, Grid, HeightMap, HeightMapError, LevelCurve, Row,
};
pub use immobile::Immobile;
pub use optimal_gait::{EfficiencyFigures, OptimalGait};
pub use parallel::Watch;
pub use problem::InvalidProblem;
pub use robust::{
    Over, RobustError, RobustGait, RobustSpeed, Robustness, Uncertainty, Values, WorstCaseMember,
    robust_displacement, robust_efficiency, robust_speed,
};
pub use sideways::{Sideways, SidewaysError, SidewaysProblem, sideways};
pub use simple_shapes::{BestAmplitude, SimpleShape, best_amplitudes};
pub use speed::{
    Fastest, Front, HeadingRule, Joined, SpeedAtlas, SpeedError, SpeedProblem, SteerProblem,
    Steering, fastest, front, steer,
};
pub use swimmer_files::{ArcKind, Bounds, GaitArc, Objective};
pub use turning::{Turning, TurningError, TurningProblem, turning};
