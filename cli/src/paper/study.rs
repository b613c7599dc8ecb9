//! What is computed once and used by both the table and the figures.

use gait_optimizer::{
    BestAmplitude, Bounds, Branch, DisplacementError, DisplacementProblem, EfficiencyProblem,
    HeightMap, Objective, OptimalGait, SimpleShape, best_amplitudes, displacement, efficiency,
};
use swimmer_model::{Model, Stroke, Swimmer};

use crate::failure::{Failure, Outcome};

/// The paper's upper bound on the joints, rad.
pub(crate) const UPPER: f64 = 2.8;
/// Its lower one.
const LOWER: f64 = 1.5;
/// The largest amplitude of its figures, rad.
pub(crate) const LARGEST: f64 = 4.5;

/// One swimmer's circles and squares.
#[derive(Debug)]
pub(crate) struct Simple {
    /// Best amplitudes for |X|: circles, squares.
    pub(crate) displacement: [Vec<BestAmplitude>; 2],
    /// Best amplitudes for ξ: circles, squares.
    pub(crate) efficiency: [Vec<BestAmplitude>; 2],
    /// Amplitude and stroke, evenly spaced: circles, squares.
    pub(crate) curves: [Vec<(f64, Stroke<f64>)>; 2],
}

/// The free Lighthill gaits of one swimmer.
#[derive(Debug)]
pub(crate) struct Lighthill {
    pub(crate) small: OptimalGait,
    pub(crate) large: OptimalGait,
}

/// Everything that the paper shows, computed.
#[derive(Debug)]
pub(crate) struct Study {
    pub(crate) purcell: Model<f64>,
    pub(crate) robot: Model<f64>,
    pub(crate) slender: Model<f64>,
    pub(crate) purcell_simple: Simple,
    pub(crate) robot_simple: Simple,
    pub(crate) slender_simple: Simple,
    /// Purcell's swimmer without bounds, the gait that the paper builds on.
    pub(crate) purcell_displacement: OptimalGait,
    /// Gaits (b), (c), (d) of the robot.
    pub(crate) robot_displacement: [OptimalGait; 3],
    /// Whether the robot has an optimum without bounds.
    pub(crate) robot_unbounded: bool,
    pub(crate) purcell_lighthill: Lighthill,
    pub(crate) robot_lighthill: Lighthill,
    pub(crate) robot_map: HeightMap,
    pub(crate) purcell_map: HeightMap,
}

/// Steps that are told while a study is made.
const STEPS: f64 = 8.0;

impl Study {
    /// Computes everything; `watch` is told the share that is done.
    ///
    /// # Errors
    /// [`Failure::Tried`] names the gait that could not be found.
    pub(crate) fn new(watch: &dyn Fn(f64)) -> Outcome<Self> {
        let [purcell, robot, slender] = [
            Swimmer::purcell(),
            Swimmer::robot(),
            Swimmer::robot_slender(),
        ];
        let model = |swimmer| Model::new(swimmer).map_err(|why| Failure::tried(&why));
        let (purcell_model, robot_model, slender_model) =
            (model(&purcell)?, model(&robot)?, model(&slender)?);
        let bounded = |min_angle, sector| DisplacementProblem {
            bounds: Bounds {
                max_angle: Some(UPPER),
                min_angle,
                sector,
                ..Bounds::default()
            },
            simple: true,
            ..DisplacementProblem::new(robot)
        };
        let robot_displacement = [
            found(displacement(&bounded(None, false)), "gait (b)")?,
            found(displacement(&bounded(Some(LOWER), false)), "gait (c)")?,
            found(displacement(&bounded(None, true)), "gait (d)")?,
        ];
        let robot_unbounded = match displacement(&DisplacementProblem::new(robot)) {
            Ok(_) => true,
            Err(DisplacementError::NoUnboundedOptimum { .. }) => false,
            Err(other) => return found(Err(other), "the robot's gait without bounds"),
        };
        let map = |swimmer: &Swimmer<f64>, width| {
            HeightMap::new(swimmer, width).map_err(|why| Failure::tried(&why))
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
        let robot_map = map(&robot, UPPER)?;
        step();
        let purcell_map = map(&purcell, 2.5)?;
        Ok(Self {
            purcell_simple,
            robot_simple,
            slender_simple,
            purcell_displacement: found(
                displacement(&DisplacementProblem::new(purcell)),
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

fn found<T, E: std::error::Error>(outcome: Result<T, E>, what: &str) -> Outcome<T> {
    outcome.map_err(|why| Failure::Tried(format!("{what} was not found: {why}")))
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
    fn of(swimmer: &Swimmer<f64>, name: &str) -> Outcome<Self> {
        let gait = |branch: Branch| {
            found(
                efficiency(&EfficiencyProblem::new(*swimmer, branch)),
                &format!("the {branch} Lighthill gait of {name}"),
            )
        };
        Ok(Self {
            small: gait(Branch::Small)?,
            large: gait(Branch::Large)?,
        })
    }
}
