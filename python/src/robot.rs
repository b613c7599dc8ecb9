//! A robot behind a port, and the cameras that see it. `python/swimmer/robot.py` makes the public class of it.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use serde::Serialize;
use swimmer_command::{Reply, RobotHandle, RobotOptions, Stopper};

use crate::errors::{BadInput, in_terms_of_python, of_reply};
use crate::gait::Gait;
use crate::keywords::Keywords;
use crate::signals::Signals;

/// Time, x, y, heading, and the deviations of position and heading.
type PoseNumbers = (f64, f64, f64, f64, f64, f64);

/// Value of a call with its messages.
pub(crate) type WithNotes<'py> = (Bound<'py, PyAny>, Vec<String>);

/// Port of a robot, and the cameras that see it.
#[pyclass(frozen, module = "swimmer._swimmer")]
pub(crate) struct RobotSettings {
    pub(crate) options: RobotOptions,
}

#[pymethods]
impl RobotSettings {
    #[new]
    fn new(ports: Vec<String>, keywords: Bound<'_, PyDict>) -> PyResult<Self> {
        let keywords = Keywords(keywords);
        let baud = keywords.count("baud", 1, u64::from(u32::MAX))?;
        Ok(Self {
            options: RobotOptions {
                ports,
                baud: baud.and_then(|baud| u32::try_from(baud).ok()),
                key: keywords.path("key")?,
                log: keywords.path("log")?,
                track: keywords.text("track")?,
                front: keywords.text("front")?,
                back: keywords.text("back")?,
                body: keywords.text("body")?,
                facing_rad: keywords.signed_angle("facing")?,
                scale: keywords.positive("scale", "give the metres per unit, above zero")?,
                axes: keywords.parsed("axes")?,
                swimmer: keywords.swimmer("swimmer")?,
                seed: keywords.count("seed", 0, u64::MAX)?.unwrap_or(1),
            },
        })
    }
}

/// A robot that was greeted. Calls release the interpreter's lock; Ctrl-C stops the robot and raises `KeyboardInterrupt`.
#[pyclass(frozen, module = "swimmer._swimmer")]
pub(crate) struct RobotLink {
    /// `None` once it is closed.
    robot: Mutex<Option<RobotHandle>>,
    stopper: Stopper,
    signals: Signals,
    /// Name of the port.
    #[pyo3(get)]
    port: String,
    /// Messages of the connection.
    #[pyo3(get)]
    notes: Vec<String>,
}

/// Value of a reply, with its messages.
pub(crate) fn value<T>(reply: Reply<T>) -> PyResult<(T, Vec<String>)> {
    let noted = reply.map_err(of_reply)?;
    let notes = noted.notes.iter();
    let notes = notes.map(|note| in_terms_of_python(note)).collect();
    Ok((noted.value, notes))
}

impl RobotLink {
    fn call<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut RobotHandle) -> Reply<T> + Send,
    ) -> PyResult<(T, Vec<String>)> {
        let reply = py.detach(|| {
            let mut robot = self.robot.lock().unwrap_or_else(PoisonError::into_inner);
            robot.as_mut().map(work)
        });
        self.signals.raised()?;
        let closed = || BadInput::new_err("this robot is closed; connect again");
        value(reply.ok_or_else(closed)?)
    }

    fn document<'py, T: Serialize + Send>(
        &self,
        py: Python<'py>,
        work: impl FnOnce(&mut RobotHandle) -> Reply<T> + Send,
    ) -> PyResult<WithNotes<'py>> {
        let (value, notes) = self.call(py, work)?;
        Ok((pythonize(py, &value)?, notes))
    }
}

#[pymethods]
impl RobotLink {
    /// Connects. `notes` holds the messages of the call.
    #[new]
    fn new(py: Python<'_>, settings: PyRef<'_, RobotSettings>) -> PyResult<Self> {
        let options = settings.options.clone();
        drop(settings);
        let signals = Signals::default();
        let polled = signals.clone();
        let reply = py.detach(|| RobotHandle::connect(&options, Box::new(move || polled.poll())));
        signals.raised()?;
        let (robot, notes) = value(reply)?;
        Ok(Self {
            stopper: robot.stopper(),
            port: robot.port().to_owned(),
            robot: Mutex::new(Some(robot)),
            signals,
            notes,
        })
    }

    /// State of the robot.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<WithNotes<'py>> {
        self.document(py, RobotHandle::status)
    }

    /// Checks, forecasts and uploads a gait.
    fn upload<'py>(
        &self,
        py: Python<'py>,
        gait: &Bound<'py, Gait>,
        period: f64,
    ) -> PyResult<WithNotes<'py>> {
        let gait = gait.get();
        self.document(py, |robot| {
            robot.upload(gait.name(), gait.curve().clone(), gait.file(), period)
        })
    }

    /// Begins a play.
    fn play(
        &self,
        py: Python<'_>,
        cycles: Option<u32>,
        period: f64,
    ) -> PyResult<((), Vec<String>)> {
        self.call(py, |robot| robot.play(cycles, period))
    }

    /// Waits for the end of a play.
    fn wait<'py>(&self, py: Python<'py>) -> PyResult<WithNotes<'py>> {
        self.document(py, RobotHandle::wait)
    }

    /// Stops, also while another thread is in a call, which then fails.
    fn stop<'py>(&self, py: Python<'py>) -> PyResult<WithNotes<'py>> {
        self.stopper.request();
        self.document(py, RobotHandle::stop)
    }

    /// Next report of the robot; None if none arrives within a second.
    fn next_telemetry<'py>(&self, py: Python<'py>) -> PyResult<WithNotes<'py>> {
        self.document(py, RobotHandle::next_telemetry)
    }

    /// Next poses by the cameras: time, x, y, heading, and the deviations of position and heading of each.
    fn next_poses(&self, py: Python<'_>) -> PyResult<(Vec<PoseNumbers>, Vec<String>)> {
        let (poses, notes) = self.call(py, RobotHandle::next_poses)?;
        let numbers = poses.iter().map(|pose| {
            (
                pose.time_s,
                pose.x_m,
                pose.y_m,
                pose.heading_rad,
                pose.sigma_position_m,
                pose.sigma_heading_rad,
            )
        });
        Ok((numbers.collect(), notes))
    }

    /// True if a play has begun and no report has shown its end.
    fn is_moving(&self) -> bool {
        self.stopper.is_moving()
    }

    /// Time on the port's clock [s].
    fn now(&self, py: Python<'_>) -> f64 {
        let now_s = py.detach(|| {
            let robot = self.robot.lock().unwrap_or_else(PoisonError::into_inner);
            robot.as_ref().map(RobotHandle::now_s)
        });
        now_s.unwrap_or(f64::NAN)
    }

    /// Stops the robot if it moves, and closes the port; nothing happens the second time.
    fn close(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let reply = py.detach(|| {
            let mut robot = self.robot.lock().unwrap_or_else(PoisonError::into_inner);
            robot.take().map(RobotHandle::close)
        });
        self.signals.raised()?;
        reply.map_or(Ok(Vec::new()), |reply| Ok(value(reply)?.1))
    }
}
