//! Operations of the application library on values: swimmers, gaits and arrays in, documents and arrays out.

use std::path::PathBuf;

use gait_optimizer::HeightMap;
use numpy::{PyArray1, PyArrayMethods as _};
use operations::bounds::BoundsRequest;
use operations::height_map::{Component, NamedGait};
use operations::simulate::PlayedOptions;
use operations::{
    Context, Error, ErrorKind, Files, GaitSource, Subject, SwimmerSource, robot_limits,
    warn_if_for_another,
};
use pyo3::prelude::*;
use pythonize::pythonize;
use swimmer_files::{
    AnyGait, GaitFile, GaitSpec, GaitSpecError, Objective, SwimmerFile, parse_angle,
};
use swimmer_model::{Pose, Tolerance, trajectory};

use crate::arrays::Array;
use crate::commands::in_thread;
use crate::errors::{BadInput, Failed, in_terms_of_python};
use crate::gait::Gait;
use crate::robot::WithNotes;
use crate::swimmer::Swimmer;

/// Points of a trajectory in a cycle.
const POINTS_A_CYCLE: usize = 500;
/// Most cycles of a trajectory.
const MOST_CYCLES: u32 = 10_000;
/// Nodes of a height map in each direction.
const NODES: usize = 201;

/// A swimmer, or the name of a preset or of a file.
#[derive(FromPyObject)]
pub(crate) enum SwimmerArgument<'py> {
    Swimmer(PyRef<'py, Swimmer>),
    Path(PathBuf),
}

impl SwimmerArgument<'_> {
    fn load(&self, context: &mut Context) -> Result<SwimmerFile, Error> {
        match self {
            Self::Swimmer(swimmer) => {
                let file = swimmer.file().clone();
                let doubts = file.doubts();
                let doubts = doubts
                    .iter()
                    .map(|doubt| format!("warning: {}: {doubt}", file.name));
                context.warnings.extend(doubts);
                Ok(file)
            }
            Self::Path(path) => SwimmerSource::from(&*path.to_string_lossy()).load(context),
        }
    }
}

/// A gait, or what `--gait` takes.
#[derive(FromPyObject)]
pub(crate) enum GaitArgument<'py> {
    Gait(PyRef<'py, Gait>),
    Path(PathBuf),
}

/// A gait with all that its file says.
struct LoadedGait {
    name: String,
    curve: AnyGait,
    file: GaitFile,
}

impl GaitArgument<'_> {
    /// Reads the gait. Warns if it was made for another swimmer.
    fn load(&self, swimmer: &SwimmerFile, context: &mut Context) -> Result<LoadedGait, Error> {
        let loaded = match self {
            Self::Gait(gait) => LoadedGait {
                name: gait.name().to_owned(),
                curve: gait.curve().clone(),
                file: gait.file().clone(),
            },
            Self::Path(path) => {
                let text = path.to_string_lossy();
                let spec: GaitSpec = text
                    .parse()
                    .map_err(|error: GaitSpecError| Error::bad_input(&error))?;
                let name = match spec {
                    GaitSpec::File { .. } => spec.to_string(),
                    _ => spec.readable(),
                };
                let source = GaitSource::from(spec);
                LoadedGait {
                    name,
                    curve: source.read(Files::Disk)?,
                    file: source.file(Files::Disk)?,
                }
            }
        };
        warn_if_for_another(swimmer, &loaded.file, &loaded.name, context);
        Ok(loaded)
    }
}

/// A number of radians, or a text such as `70deg`.
#[derive(FromPyObject)]
pub(crate) enum Angle {
    Radians(f64),
    Text(String),
}

impl Angle {
    /// The angle above zero \[rad\].
    fn above_zero(&self, name: &str) -> PyResult<f64> {
        let text = match self {
            Self::Radians(radians) => format!("{radians:?}"),
            Self::Text(text) => text.clone(),
        };
        let bad = |problem: String| BadInput::new_err(format!("{name} = {text}: {problem}"));
        let radians = parse_angle(&text).map_err(|error| bad(error.to_string()))?;
        if radians > 0.0 {
            Ok(radians)
        } else {
            Err(bad("the angle must be above zero".to_owned()))
        }
    }
}

/// Joint angles and poses of a trajectory, with cycle and phase of each row.
type Trajectory<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Array<'py>,
    Array<'py>,
);

/// One cycle of a gait, and the trajectory of all `cycles`. With `played` also a forecast on the robot.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // each is a keyword in Python
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    swimmer: SwimmerArgument<'py>,
    gait: GaitArgument<'py>,
    cycles: u32,
    period: Option<f64>,
    played: bool,
    knots: Option<usize>,
    pulse_step: Option<u32>,
) -> PyResult<(Bound<'py, PyAny>, Trajectory<'py>, Vec<String>)> {
    if !(1..=MOST_CYCLES).contains(&cycles) {
        return Err(BadInput::new_err(format!(
            "cycles = {cycles}: give a number from 1 to {MOST_CYCLES}"
        )));
    }
    let period = period.unwrap_or(robot_limits::PERIOD_S);
    if !period.is_finite() || period <= 0.0 {
        return Err(BadInput::new_err(format!(
            "period = {period:?}: give a number of seconds above zero, as 30 or 2.5"
        )));
    }
    let mut context = Context::on_disk();
    let file = swimmer.load(&mut context).map_err(exception)?;
    let gait = gait.load(&file, &mut context).map_err(exception)?;
    let options = operations::simulate::Options {
        period_s: period,
        played: played.then(|| {
            let usual = PlayedOptions::default();
            PlayedOptions {
                knots: knots.unwrap_or(usual.knots),
                pulse_step_ns: pulse_step.unwrap_or(usual.pulse_step_ns),
            }
        }),
    };
    let subject = Subject {
        model: operations::model(&file).map_err(exception)?,
        file,
        gait: gait.curve,
        samples: None,
        response: None,
    };
    let (output, rows, context) = in_thread(py, move || {
        let output = operations::simulate::run(&subject, &options, &mut context)?;
        Ok((output, rows(&subject, cycles), context))
    })?
    .map_err(exception)?;
    let count = rows.len();
    let column = |of: fn(&Row) -> f64| PyArray1::from_iter(py, rows.iter().map(of));
    let table = |width: usize, of: fn(&Row) -> Vec<f64>| {
        PyArray1::from_iter(py, rows.iter().flat_map(of)).reshape([count, width].as_slice())
    };
    let trajectory = (
        PyArray1::from_iter(py, rows.iter().map(|row| i64::from(row.cycle))),
        column(|row| row.u),
        table(2, |row| row.phi.to_vec())?,
        table(3, |row| row.pose.to_vec())?,
    );
    Ok((pythonize(py, &output)?, trajectory, context.warnings))
}

/// An instant of a trajectory.
struct Row {
    cycle: u32,
    u: f64,
    phi: [f64; 2],
    pose: [f64; 3],
}

/// Trajectory of the middle link, from the origin along x and on from cycle to cycle.
fn rows(subject: &Subject, cycles: u32) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut start = Pose::identity();
    for cycle in 0..cycles {
        let mut end = start;
        trajectory(
            &subject.model,
            &subject.gait,
            &Tolerance::default(),
            POINTS_A_CYCLE,
            |point| {
                end = start * point.pose;
                // The last instant of a cycle is the first of the next.
                if point.u < 1.0 || cycle + 1 == cycles {
                    rows.push(Row {
                        cycle,
                        u: point.u,
                        phi: point.phi.into(),
                        pose: [end.x, end.y, end.theta],
                    });
                }
            },
        );
        start = end;
    }
    rows
}

/// Certificate of a gait.
#[pyfunction]
#[allow(clippy::too_many_arguments, clippy::fn_params_excessive_bools)] // each is a keyword in Python
pub(crate) fn certify<'py>(
    py: Python<'py>,
    swimmer: SwimmerArgument<'py>,
    gait: GaitArgument<'py>,
    objective: Option<&str>,
    fixed_period: bool,
    max_angle: Option<Angle>,
    min_angle: Option<Angle>,
    sector: bool,
    no_overlap: bool,
    clearance: Option<f64>,
    playable: bool,
) -> PyResult<WithNotes<'py>> {
    let clearance = clearance.unwrap_or(0.0);
    if !clearance.is_finite() || clearance < 0.0 {
        return Err(BadInput::new_err(format!(
            "clearance = {clearance:?}: give a length in metres, zero or above, as 0.005"
        )));
    }
    let angle = |angle: Option<Angle>, name| angle.map(|angle| angle.above_zero(name)).transpose();
    let bounds = BoundsRequest {
        max_angle: angle(max_angle, "max_angle")?,
        min_angle: angle(min_angle, "min_angle")?,
        sector,
        no_overlap,
        clearance,
        playable,
    };
    let options = operations::certify::Options {
        objective: objective.map(objective_of).transpose()?,
        fixed_period,
        bounds,
    };
    let mut context = Context::on_disk();
    let file = swimmer.load(&mut context).map_err(exception)?;
    let gait = gait.load(&file, &mut context).map_err(exception)?.file;
    let (output, context) = in_thread(py, move || {
        let output = operations::certify::run(&file, gait, &options, &mut context)?;
        Ok((output, context))
    })?
    .map_err(exception)?;
    Ok((pythonize(py, &output)?, context.warnings))
}

fn objective_of(word: &str) -> PyResult<Objective> {
    let all = [
        Objective::Displacement,
        Objective::Efficiency,
        Objective::Turning,
        Objective::Sideways,
        Objective::Speed,
    ];
    all.into_iter()
        .find(|objective| objective.word() == word)
        .ok_or_else(|| {
            BadInput::new_err(format!(
                "objective = {word:?}: choose displacement, efficiency, turning, sideways or speed"
            ))
        })
}

/// Document, angles of the nodes, heights and messages of a height map.
type Map<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyArray1<f64>>,
    Array<'py>,
    Vec<String>,
);

/// A component of the height function: document, angles of the nodes, and heights \[i, j\] at φ₁ = angle i, φ₂ = angle j.
#[pyfunction]
pub(crate) fn height_map<'py>(
    py: Python<'py>,
    swimmer: SwimmerArgument<'py>,
    row: &str,
    max_angle: Angle,
    gaits: Vec<GaitArgument<'py>>,
) -> PyResult<Map<'py>> {
    let component = match row {
        "x" => Component::X,
        "y" => Component::Y,
        "theta" => Component::Theta,
        _ => {
            return Err(BadInput::new_err(format!(
                "row = {row:?}: choose x, y or theta"
            )));
        }
    };
    let max_angle = max_angle.above_zero("max_angle")?;
    let mut context = Context::on_disk();
    let file = swimmer.load(&mut context).map_err(exception)?;
    let mut named = Vec::with_capacity(gaits.len());
    for gait in gaits {
        let LoadedGait { name, curve, .. } = gait.load(&file, &mut context).map_err(exception)?;
        named.push(NamedGait { name, gait: curve });
    }
    for NamedGait { gait, .. } in &named {
        let warning = robot_limits::warning(&file, gait, robot_limits::PERIOD_S);
        context.warnings.extend(warning);
    }
    let (output, grid) = in_thread(py, move || {
        let map = HeightMap::new(&file.swimmer, max_angle)?;
        let output = operations::height_map::run(&map, component, &named)?;
        Ok((output, map.grid(component.row(), NODES)))
    })?
    .map_err(exception)?;
    // A column of the grid has one φ₂, and its numbers follow each other.
    let by_phi2 = PyArray1::from_iter(py, grid.heights.transpose().iter().copied());
    let heights = by_phi2.reshape([NODES, NODES].as_slice())?;
    let angles = PyArray1::from_vec(py, grid.angles);
    Ok((pythonize(py, &output)?, angles, heights, context.warnings))
}

fn exception(error: Error) -> PyErr {
    let text = in_terms_of_python(&error.message);
    match error.kind {
        ErrorKind::BadInput => BadInput::new_err(text),
        ErrorKind::Failed => Failed::new_err(text),
    }
}
