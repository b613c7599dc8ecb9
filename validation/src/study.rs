//! Results that are computed once for the table and the figures of the paper.

use gait_optimizer::{
    BestAmplitude, Bounds, Branch, DisplacementError, DisplacementProblem, EfficiencyProblem,
    Heading, HeightMap, HeightMapError, Method, Objective, OptimalGait, SimpleShape,
    best_amplitudes, displacement, efficiency, efficiency_by_order,
};
use swimmer_model::{InvalidSwimmer, Model, Stroke, Swimmer};

/// Failure of a study.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StudyError {
    /// A gait of the paper was not found.
    #[error("{gait} was not found: {reason}")]
    NoGait {
        /// Name of the gait.
        gait: String,
        /// Reason.
        reason: String,
    },
    /// A swimmer of the paper is invalid.
    #[error(transparent)]
    Swimmer(#[from] InvalidSwimmer),
    /// A height map could not be computed.
    #[error(transparent)]
    HeightMap(#[from] HeightMapError),
}

/// Upper bound on the joint angles in the paper \[rad\].
pub const UPPER: f64 = 2.8;
/// Lower bound on the joint angles in the paper \[rad\].
const LOWER: f64 = 1.5;
/// Largest amplitude in the paper's figures \[rad\].
pub const LARGEST: f64 = 4.5;

/// Circles and squares of one swimmer.
#[derive(Debug)]
pub struct Simple {
    /// Best amplitudes for |X|: circles, squares.
    pub displacement: [Vec<BestAmplitude>; 2],
    /// Best amplitudes for ξ: circles, squares.
    pub efficiency: [Vec<BestAmplitude>; 2],
    /// Amplitude \[rad\] and stroke, evenly spaced: circles, squares.
    pub curves: [Vec<(f64, Stroke<f64>)>; 2],
}

/// Gaits of highest Lighthill efficiency of one swimmer, without bounds.
#[derive(Debug)]
pub struct Lighthill {
    /// Small gait, X > 0.
    pub small: OptimalGait,
    /// Large gait, X < 0.
    pub large: OptimalGait,
    /// ξ of the small and of the large gait by other methods.
    pub others: [OtherMethods; 2],
}

/// ξ of a Lighthill gait by methods other than shooting from a series of low order.
#[derive(Debug, Clone)]
pub struct OtherMethods {
    /// Direct collocation alone.
    pub collocation: f64,
    /// Fourier series alone, of the order at which it has converged.
    pub fourier: f64,
    /// Collocation's gait after the polish by shooting.
    pub polished: f64,
    /// Fourier series of orders 1, 2 and 3.
    pub orders: Vec<f64>,
}

/// Computed results of the paper.
#[derive(Debug)]
pub struct Study {
    /// Purcell's swimmer.
    pub purcell: Model<f64>,
    /// Robot with its head.
    pub robot: Model<f64>,
    /// Robot as slender links.
    pub slender: Model<f64>,
    /// Circles and squares.
    pub purcell_simple: Simple,
    /// Circles and squares.
    pub robot_simple: Simple,
    /// Circles and squares.
    pub slender_simple: Simple,
    /// Displacement gait of Purcell's swimmer without bounds.
    pub purcell_displacement: OptimalGait,
    /// Gaits (b), (c), (d) of the robot.
    pub robot_displacement: [OptimalGait; 3],
    /// `true` if the robot has an optimum without bounds.
    pub robot_unbounded: bool,
    /// Gaits of most efficiency.
    pub purcell_lighthill: Lighthill,
    /// Gaits of most efficiency.
    pub robot_lighthill: Lighthill,
    /// Height map of the robot within the paper's bound.
    pub robot_map: HeightMap,
    /// Height map of Purcell's swimmer within 2.5 rad.
    pub purcell_map: HeightMap,
}

/// Number of steps in the reported progress.
const STEPS: f64 = 8.0;

impl Study {
    /// Computes all results; `watch` receives the completed fraction.
    ///
    /// # Errors
    /// [`StudyError`] names the gait that could not be found.
    pub fn new(watch: &dyn Fn(f64)) -> Result<Self, StudyError> {
        let [purcell, robot, slender] = [
            Swimmer::purcell(),
            Swimmer::robot(),
            Swimmer::robot_slender(),
        ];
        let (purcell_model, robot_model, slender_model) = (
            Model::new(&purcell)?,
            Model::new(&robot)?,
            Model::new(&slender)?,
        );
        let bounded = |min_angle, sector, heading| {
            displacement(&DisplacementProblem {
                bounds: Bounds {
                    max_angle: Some(UPPER),
                    min_angle,
                    sector,
                    ..Bounds::default()
                },
                heading: Some(heading),
                ..DisplacementProblem::new(robot)
            })
        };
        let robot_displacement = [
            found(bounded(None, false, Heading::Forwards), "gait (b)")?,
            found(bounded(Some(LOWER), false, Heading::Backwards), "gait (c)")?,
            found(bounded(None, true, Heading::Backwards), "gait (d)")?,
        ];
        let robot_unbounded = match displacement(&DisplacementProblem::new(robot)) {
            Ok(_) => true,
            Err(DisplacementError::NoUnboundedOptimum { .. }) => false,
            Err(other) => return found(Err(other), "the robot's gait without bounds"),
        };
        let mut done = 0.0;
        let mut step = || {
            done += 1.0;
            watch(done / STEPS);
        };
        let mut simple = |model| {
            step();
            Simple::of(model)
        };
        let (purcell_simple, robot_simple, slender_simple) = (
            simple(&purcell_model),
            simple(&robot_model),
            simple(&slender_model),
        );
        let mut lighthill = |swimmer, name| {
            step();
            Lighthill::of(swimmer, name)
        };
        let purcell_lighthill = lighthill(&purcell, "Purcell's swimmer")?;
        let robot_lighthill = lighthill(&robot, "the robot")?;
        step();
        let robot_map = HeightMap::new(&robot, UPPER)?;
        step();
        let purcell_map = HeightMap::new(&purcell, 2.5)?;
        Ok(Self {
            purcell_simple,
            robot_simple,
            slender_simple,
            purcell_displacement: found(
                displacement(&DisplacementProblem::new(purcell).heading(Heading::Forwards)),
                "the displacement gait of Purcell's swimmer",
            )?,
            robot_displacement,
            robot_unbounded,
            purcell_lighthill,
            robot_lighthill,
            robot_map,
            purcell_map,
            purcell: purcell_model,
            robot: robot_model,
            slender: slender_model,
        })
    }
}

fn found<T, E: std::error::Error>(outcome: Result<T, E>, gait: &str) -> Result<T, StudyError> {
    outcome.map_err(|why| StudyError::NoGait {
        gait: gait.to_owned(),
        reason: why.to_string(),
    })
}

impl Simple {
    fn of(model: &Model<f64>) -> Self {
        const POINTS: u32 = 150;
        let shapes = [SimpleShape::Circle, SimpleShape::Square];
        let curve = |shape: SimpleShape| {
            (1..=POINTS)
                .map(|i| {
                    let amplitude = LARGEST * f64::from(i) / f64::from(POINTS);
                    (amplitude, shape.swum(model, amplitude))
                })
                .collect()
        };
        let best =
            |objective| shapes.map(|shape| best_amplitudes(model, shape, objective, LARGEST));
        Self {
            displacement: best(Objective::Displacement),
            efficiency: best(Objective::Efficiency),
            curves: shapes.map(curve),
        }
    }
}

impl Lighthill {
    fn of(swimmer: &Swimmer<f64>, name: &str) -> Result<Self, StudyError> {
        let gait = |branch: Branch| {
            found(
                efficiency(&EfficiencyProblem::new(*swimmer, branch)),
                &format!("the {branch} Lighthill gait of {name}"),
            )
        };
        let others = |branch: Branch| OtherMethods::of(swimmer, branch, name);
        Ok(Self {
            small: gait(Branch::Small)?,
            large: gait(Branch::Large)?,
            others: [others(Branch::Small)?, others(Branch::Large)?],
        })
    }
}

/// Highest order of the series in the table.
const HIGHEST_ORDER: usize = 3;

impl OtherMethods {
    fn of(swimmer: &Swimmer<f64>, branch: Branch, name: &str) -> Result<Self, StudyError> {
        let problem = EfficiencyProblem::new(*swimmer, branch);
        let by_fourier = EfficiencyProblem {
            method: Method::Fourier,
            ..problem
        };
        let called = |method: &str| format!("the {branch} Lighthill gait of {name} by {method}");
        let collocated = found(
            collocation::efficiency(&problem, &|_| ()),
            &called("collocation"),
        )?;
        let fourier = found(efficiency(&by_fourier), &called("Fourier series"))?;
        let direct = |gait: &OptimalGait| {
            let figures = gait.efficiency_figures;
            let direct = figures.and_then(|figures| figures.direct_efficiency);
            direct.unwrap_or(f64::NAN)
        };
        Ok(Self {
            collocation: direct(&collocated),
            fourier: direct(&fourier),
            polished: collocated.efficiency,
            orders: found(
                efficiency_by_order(&problem, HIGHEST_ORDER),
                &called("Fourier series of low order"),
            )?,
        })
    }
}
