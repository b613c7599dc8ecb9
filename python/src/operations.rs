//! Simulation, certificate and height map: swimmers, gaits and arrays in, documents and arrays out.

use gait_optimizer::HeightMap;
use numpy::{PyArray1, PyArrayMethods as _};
use operations::height_map::{Component, NamedGait};
use operations::passive::Options as PassiveOptions;
use operations::simulate::PlayedOptions;
use operations::{Error, Subject, SwimmerSource, robot_limits};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use swimmer_command::NewPicture;
use swimmer_files::{Objective, Spring};
use swimmer_model::{Pose, Tolerance, trajectory};

use crate::arguments::{GaitArgument, LoadedGait, SwimmerArgument};
use crate::arrays::Array;
use crate::computation::{compute, context};
use crate::errors::{BadInput, of_operation};
use crate::keywords::Keywords;
use crate::robot::WithNotes;

/// Points of a trajectory in a cycle.
const POINTS_A_CYCLE: usize = 500;
/// Most cycles of a trajectory.
const MOST_CYCLES: u32 = 10_000;
/// Nodes of a height map in each direction.
const NODES: usize = 201;

/// Joint angles and poses of a trajectory, with cycle and phase of each row.
type Trajectory<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Array<'py>,
    Array<'py>,
);

/// One cycle of a gait, and the trajectory of all cycles.
#[pyfunction]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    gait: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<(Bound<'py, PyAny>, Trajectory<'py>, Vec<String>)> {
    let (swimmer, gait) = (SwimmerArgument::of(swimmer)?, GaitArgument::of(gait)?);
    let keywords = Keywords(keywords);
    let cycles = keywords.count("cycles", 1, u64::from(MOST_CYCLES))?;
    let cycles = u32::try_from(cycles.unwrap_or(1)).unwrap_or(MOST_CYCLES);
    let period_s = keywords
        .seconds("period")?
        .unwrap_or(robot_limits::PERIOD_S);
    let options = operations::simulate::Options {
        period_s,
        played: played(&keywords)?,
    };
    let passive = passive(&keywords)?;
    let width = keywords.width("picture")?;
    let picture = keywords.path("picture")?;
    let picture = picture.map(|path| NewPicture::new(path, width));
    let picture = picture.transpose().map_err(of_operation)?;
    let limit_cycle = keywords.new_file("output")?;
    let ((output, rows), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        let drive = gait.drive()?;
        let source = SwimmerSource::from(file);
        let subject = Subject::load_driven(&source, &drive, &passive, period_s, context)?;
        let mut output = operations::simulate::run(&subject, &options, context)?;
        if let Some(path) = limit_cycle {
            let Some(samples) = &subject.samples else {
                return Err(Error::refused(
                    "output is the limit cycle of a passive joint: name the joint by --passive, and its spring",
                ));
            };
            samples.save(&path)?;
            output.gait = Some(path);
        }
        if let Some(picture) = picture {
            picture.draw(&subject, &drive.readable(), cycles, &mut output)?;
        }
        Ok((output, rows(&subject, cycles)))
    })?;
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
    Ok((pythonize(py, &output)?, trajectory, notes))
}

/// Settings of the play on the robot, if it shall be forecast.
fn played(keywords: &Keywords<'_>) -> PyResult<Option<PlayedOptions>> {
    let knots = keywords.count("knots", 1, u64::from(u32::MAX))?;
    let pulse_step = keywords.count("pulse_step", 0, u64::from(u32::MAX))?;
    if !keywords.flag("played")? {
        let alone = "this belongs to a forecast on the robot: add played=True";
        keywords.refuse("knots", alone)?;
        keywords.refuse("pulse_step", alone)?;
        return Ok(None);
    }
    let usual = PlayedOptions::default();
    Ok(Some(PlayedOptions {
        knots: knots.map_or(usual.knots, |knots| {
            usize::try_from(knots).unwrap_or(usize::MAX)
        }),
        pulse_step_ns: pulse_step.map_or(usual.pulse_step_ns, |step| {
            u32::try_from(step).unwrap_or(u32::MAX)
        }),
    }))
}

/// The passive joint, and its spring.
fn passive(keywords: &Keywords<'_>) -> PyResult<PassiveOptions> {
    Ok(PassiveOptions {
        joint: keywords.joint("passive")?,
        spring: keywords
            .stiffness()?
            .map(Spring::Stiffness)
            .or(keywords.seconds("relaxation")?.map(Spring::Relaxation)),
    })
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
pub(crate) fn certify<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    gait: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithNotes<'py>> {
    let (swimmer, gait) = (SwimmerArgument::of(swimmer)?, GaitArgument::of(gait)?);
    let keywords = Keywords(keywords);
    let objectives = [
        Objective::Displacement,
        Objective::Efficiency,
        Objective::Turning,
        Objective::Sideways,
        Objective::Speed,
    ];
    let options = operations::certify::Options {
        objective: keywords.word("objective", &objectives.map(|one| (one.word(), one)))?,
        fixed_period: keywords.flag("fixed_period")?,
        bounds: keywords.bounds()?,
    };
    let (output, notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        let gait = gait.load(&file, context)?.file;
        operations::certify::run(&file, gait, &options, context)
    })?;
    Ok((pythonize(py, &output)?, notes))
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
    swimmer: &Bound<'py, PyAny>,
    gaits: Vec<Bound<'py, PyAny>>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<Map<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let gaits: Vec<GaitArgument> = gaits
        .iter()
        .map(GaitArgument::of)
        .collect::<PyResult<_>>()?;
    let keywords = Keywords(keywords);
    let rows = [
        ("x", Component::X),
        ("y", Component::Y),
        ("theta", Component::Theta),
    ];
    let component = keywords.word("row", &rows)?.unwrap_or(Component::X);
    let missing = || BadInput::new_err("max_angle is the half width of the map: give an angle");
    let max_angle = keywords.angle("max_angle")?.ok_or_else(missing)?;
    let ((output, grid), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        let mut named = Vec::with_capacity(gaits.len());
        for gait in gaits {
            let LoadedGait { name, curve, .. } = gait.load(&file, context)?;
            named.push(NamedGait { name, gait: curve });
        }
        for NamedGait { gait, .. } in &named {
            let warning = robot_limits::warning(&file, gait, robot_limits::PERIOD_S);
            context.warnings.extend(warning);
        }
        let map = HeightMap::new(&file.swimmer, max_angle)?;
        let output = operations::height_map::run(&map, component, &named)?;
        Ok((output, map.grid(component.row(), NODES)))
    })?;
    // A column of the grid has one φ₂, and its numbers follow each other.
    let by_phi2 = PyArray1::from_iter(py, grid.heights.transpose().iter().copied());
    let heights = by_phi2.reshape([NODES, NODES].as_slice())?;
    let angles = PyArray1::from_vec(py, grid.angles);
    Ok((pythonize(py, &output)?, angles, heights, notes))
}
