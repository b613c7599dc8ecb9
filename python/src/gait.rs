//! A gait: a closed curve of shapes, in closed form or from samples.

use std::path::{Path, PathBuf};

use nalgebra::Vector2;
use numpy::{PyArray1, PyArrayMethods as _};
use pyo3::prelude::*;
use swimmer_files::{AnyGait, FileError, GaitFile, GaitSpec};
use swimmer_model::Gait as _;

use crate::arrays::{Array, Numbers, Shapes};
use crate::errors::{BadInput, of_file};

/// One cycle of joint angles. It never changes.
///
/// Parameters
/// ----------
/// phi : array_like
///     Samples of one cycle [rad], shape (n, 2). If the last sample is not the first one, the cycle is closed.
/// u : sequence of float, optional
///     Fractions of the period of the samples; evenly spaced unless given.
/// corners : sequence of float, optional
///     Those of `u` at which the direction jumps.
///
/// Raises
/// ------
/// BadInput
///     If the samples are no closed curve.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import swimmer as sw
/// >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
/// >>> gait = sw.Gait(np.column_stack([np.cos(t), np.sin(t)]))
/// >>> gait.at(0.125).round(4)
/// array([0.7071, 0.7071])
#[pyclass(frozen, module = "swimmer")]
pub(crate) struct Gait {
    /// Its word on the command line; none for samples.
    closed_form: Option<String>,
    file: GaitFile,
    curve: AnyGait,
}

/// Samples of one in closed form.
const SAMPLES: usize = 200;

impl Gait {
    /// Its closed form; `None` for samples.
    pub(crate) fn word(&self) -> Option<&str> {
        self.closed_form.as_deref()
    }

    /// Its curve.
    pub(crate) fn curve(&self) -> &AnyGait {
        &self.curve
    }

    /// Its gait file; a closed form is sampled.
    pub(crate) fn file(&self) -> &GaitFile {
        &self.file
    }

    /// Name for messages.
    pub(crate) fn name(&self) -> &str {
        self.closed_form.as_deref().unwrap_or("the gait")
    }

    /// A gait from the content of its file.
    pub(crate) fn of_file(file: GaitFile) -> PyResult<Self> {
        let curve = AnyGait::from_file(&file)
            .map_err(|invalid| BadInput::new_err(format!("a gait from samples: {invalid}")))?;
        Ok(Self {
            closed_form: None,
            file,
            curve,
        })
    }

    fn of_spec(spec: &GaitSpec) -> PyResult<Self> {
        let mut file = None;
        let curve = spec
            .load_by(|path| GaitFile::load(path).inspect(|seen| file = Some(seen.clone())))
            .map_err(|error| of_file(&error))?;
        let reversed = matches!(spec, GaitSpec::File { reversed: true, .. });
        Ok(match file {
            Some(file) if reversed => Self::of_file(file.reversed())?,
            Some(file) => Self {
                closed_form: None,
                file,
                curve,
            },
            None => Self {
                closed_form: Some(spec.to_string()),
                file: GaitFile::sampled(&curve, SAMPLES),
                curve,
            },
        })
    }
}

#[pymethods]
impl Gait {
    #[new]
    #[pyo3(signature = (phi, u=None, corners=None))]
    fn new(phi: Numbers<'_>, u: Option<Vec<f64>>, corners: Option<Vec<f64>>) -> PyResult<Self> {
        let shapes = Shapes::copied(&phi)?;
        if shapes.leading.len() != 1 {
            return Err(BadInput::new_err(
                "a gait is an array of shape (n, 2), one row of joint angles for each sample of the cycle",
            ));
        }
        let mut phi = shapes.phi;
        let closed = match (phi.first(), phi.last()) {
            (Some(first), Some(last)) => (first - last).norm() <= GaitFile::CLOSURE,
            _ => false,
        };
        let mut u = u.unwrap_or_else(|| {
            let steps = if closed { phi.len() - 1 } else { phi.len() };
            (0..phi.len()).map(|k| k as f64 / steps as f64).collect()
        });
        if u.len() != phi.len() {
            return Err(BadInput::new_err(format!(
                "{} fractions of the period for {} samples; give one for each",
                u.len(),
                phi.len()
            )));
        }
        if u.last().is_some_and(|&last| last < 1.0) {
            u.push(1.0);
            phi.extend(phi.first().copied());
        }
        let file = GaitFile {
            u,
            phi,
            corners: corners.unwrap_or_default(),
            ..GaitFile::default()
        };
        // Read as a file is read: the same conditions, the same sentences.
        let read = GaitFile::parse(&file.to_text(), Path::new("samples")).map_err(|error| {
            BadInput::new_err(match error {
                FileError::Content { problem, .. } => format!("a gait from samples: {problem}"),
                other => other.to_string(),
            })
        })?;
        Self::of_file(read)
    }

    /// Returns a circle in the plane of joint angles, at uniform speed from φ₁ = φ₂ > 0.
    ///
    /// Parameters
    /// ----------
    /// amplitude : float
    ///     Radius [rad].
    /// clockwise : bool, optional
    ///     With True, runs clockwise.
    ///
    /// Returns
    /// -------
    /// Gait
    ///     The gait.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the amplitude is no angle.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.circle(1.2)
    /// <Gait circle:1.2>
    #[staticmethod]
    #[pyo3(signature = (amplitude, *, clockwise=false))]
    fn circle(amplitude: f64, clockwise: bool) -> PyResult<Self> {
        Self::closed("circle", amplitude, clockwise)
    }

    /// Returns a square with corners (±`amplitude`, ±`amplitude`), at uniform speed along each edge from φ₁ = φ₂ > 0.
    ///
    /// Parameters
    /// ----------
    /// amplitude : float
    ///     Half edge [rad].
    /// clockwise : bool, optional
    ///     With True, runs clockwise.
    ///
    /// Returns
    /// -------
    /// Gait
    ///     The gait.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the amplitude is no angle.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.square(1.2, clockwise=True)
    /// <Gait square:1.2:cw>
    #[staticmethod]
    #[pyo3(signature = (amplitude, *, clockwise=false))]
    fn square(amplitude: f64, clockwise: bool) -> PyResult<Self> {
        Self::closed("square", amplitude, clockwise)
    }

    /// Reads a gait file, or returns a closed form.
    ///
    /// Parameters
    /// ----------
    /// gait : str or path
    ///     Path of a gait file, ``circle:70deg`` or ``square:1.2``; ``:cw`` at the end reverses it.
    ///
    /// Returns
    /// -------
    /// Gait
    ///     The gait.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the file cannot be read or is invalid.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.load("circle:70deg").phi.shape
    /// (201, 2)
    #[staticmethod]
    fn load(gait: PathBuf) -> PyResult<Self> {
        let spec = match gait.to_str() {
            Some(text) => text
                .parse()
                .map_err(|error: swimmer_files::GaitSpecError| {
                    BadInput::new_err(error.to_string())
                })?,
            None => GaitSpec::File {
                path: gait,
                reversed: false,
            },
        };
        Self::of_spec(&spec)
    }

    /// Reads the text of a gait file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     Content of a gait file.
    ///
    /// Returns
    /// -------
    /// Gait
    ///     The gait.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the text is invalid.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> best = sw.optimize.turning("purcell", max_angle=1.0).gait
    /// >>> sw.Gait.from_text(best.to_text()) == best
    /// True
    #[staticmethod]
    fn from_text(text: &str) -> PyResult<Self> {
        let read = GaitFile::parse(text, Path::new("gait.gait"));
        Self::of_file(read.map_err(|error| of_file(&error))?)
    }

    /// Fractions of the period of the samples, from 0 to 1: shape (n,).
    #[getter]
    fn u<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.file.u)
    }

    /// Joint angles of the samples [rad], the last the first again: shape (n, 2).
    #[getter]
    fn phi<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        rows(py, &self.file.phi, &[self.file.phi.len(), 2])
    }

    /// Returns the joint angles at fractions of the period, also between the samples.
    ///
    /// Parameters
    /// ----------
    /// u : array_like
    ///     Fractions of the period; 1.25 is 0.25 of the second cycle.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If a fraction is not finite.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.circle(1.0).at([0.0, 0.5]).round(6)
    /// array([[ 0.707107,  0.707107],
    ///        [-0.707107, -0.707107]])
    fn at<'py>(&self, py: Python<'py>, u: Numbers<'py>) -> PyResult<Array<'py>> {
        let u = u.as_array();
        if let Some(odd) = u.iter().find(|u| !u.is_finite()) {
            return Err(BadInput::new_err(format!(
                "u = {odd} is no fraction of the period"
            )));
        }
        let phi: Vec<_> = u
            .iter()
            .map(|u| self.curve.at(u.rem_euclid(1.0)).phi)
            .collect();
        rows(py, &phi, &[u.shape(), &[2]].concat())
    }

    /// Objective of the optimisation: `displacement`, `efficiency`, `turning`, `sideways`, `speed`, or `unspecified`.
    #[getter]
    fn objective(&self) -> &'static str {
        self.file.objective.word()
    }

    /// Fractions of the period where the direction jumps.
    #[getter]
    fn corners(&self) -> Vec<f64> {
        self.file.corners.clone()
    }

    /// Returns the same cycle, run the other way from the same start.
    ///
    /// Returns
    /// -------
    /// Gait
    ///     The reversed gait.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.circle(1.2).reversed()
    /// <Gait circle:1.2:cw>
    fn reversed(&self) -> PyResult<Self> {
        match &self.closed_form {
            None => Self::of_file(self.file.reversed()),
            Some(word) => {
                let turned = word
                    .strip_suffix(":cw")
                    .map_or_else(|| format!("{word}:cw"), str::to_owned);
                Self::load(PathBuf::from(turned))
            }
        }
    }

    /// Closed form as `load` reads it, ``circle:1.2`` or ``square:1.2:cw``; None for samples.
    #[getter]
    fn closed_form(&self) -> Option<&str> {
        self.closed_form.as_deref()
    }

    /// Returns the text of the gait file; a closed form is sampled.
    ///
    /// Returns
    /// -------
    /// str
    ///     Content of a gait file.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> "u,phi1,phi2" in sw.Gait.circle(1.2).to_text()
    /// True
    fn to_text(&self) -> String {
        self.file.to_text()
    }

    /// Writes the gait file. A file that exists is replaced.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     Path of the file.
    ///
    /// Raises
    /// ------
    /// Failed
    ///     If the file cannot be written.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Gait.circle(1.2).save("mine.gait")  # doctest: +SKIP
    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.file.save(&path).map_err(|error| of_file(&error))
    }

    fn __repr__(&self) -> String {
        match &self.closed_form {
            Some(word) => format!("<Gait {word}>"),
            None => format!(
                "<Gait of {} samples, {}>",
                self.file.u.len(),
                self.file.objective
            ),
        }
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.file == other.file && self.closed_form == other.closed_form
    }

    fn __hash__(&self) -> u64 {
        let bits = |phi: &Vector2<f64>| phi.x.to_bits() ^ phi.y.to_bits().rotate_left(32);
        self.file
            .phi
            .iter()
            .fold(0, |hash: u64, phi| hash.rotate_left(5) ^ bits(phi))
    }

    /// For `pickle` and `copy`.
    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String,))> {
        let gait = slf.get();
        let (make, from) = match &gait.closed_form {
            Some(word) => ("load", word.clone()),
            None => ("from_text", gait.to_text()),
        };
        Ok((slf.get_type().getattr(make)?.unbind(), (from,)))
    }
}

impl Gait {
    fn closed(shape: &str, amplitude: f64, clockwise: bool) -> PyResult<Self> {
        let end = if clockwise { ":cw" } else { "" };
        Self::load(PathBuf::from(format!("{shape}:{amplitude:?}{end}")))
    }
}

fn rows<'py>(py: Python<'py>, phi: &[Vector2<f64>], dimensions: &[usize]) -> PyResult<Array<'py>> {
    let numbers: Vec<f64> = phi.iter().flat_map(|phi| [phi.x, phi.y]).collect();
    PyArray1::from_vec(py, numbers).reshape(dimensions.to_vec())
}
