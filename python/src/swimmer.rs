//! A swimmer and its equations of motion over arrays of shapes.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use swimmer_files::{Fluid, Quantity, SwimmerFile};
use swimmer_model::{Medium, Model, TangentialDrag};

use crate::arrays::{Array, Numbers, Shapes};
use crate::errors::{BadInput, of_file};

/// A three-link swimmer: links, drag, sphere, and where known its fluid and servos. It never changes; `replace` returns another one.
///
/// Lengths are in metres and angles in radians; drag and power are over the viscosity. `Swimmer(middle=0.07, side=0.14)` makes a viscous
/// swimmer; `preset` and `load` return others.
///
/// Parameters
/// ----------
/// middle : float
///     Length of the middle link [m].
/// side : float, optional
///     Length of both side links [m].
/// front, back : float, optional
///     Lengths of the side links [m], in place of `side`.
/// chi : float, optional
///     Ratio of normal to tangential drag.
/// sphere_radius : float, optional
///     Radius of the sphere on the middle link [m]; 0 for none.
/// log_aspect, half_thickness, over_viscosity : float, optional
///     Forms of the tangential drag coefficient, of which at most one is given: ln(l/a), a [m], or the coefficient over the viscosity. Without
///     them ``over_viscosity=1``.
/// kinematic_viscosity, density : float, optional
///     Fluid [m²/s, kg/m³], for torques and power.
/// name : str, optional
///     Name for people.
///
/// Raises
/// ------
/// BadInput
///     If a value is invalid or missing.
///
/// Examples
/// --------
/// >>> import swimmer as sw
/// >>> robot = sw.Swimmer(middle=0.071, side=0.137, chi=3.6, sphere_radius=0.069)
/// >>> round(robot.length, 3)
/// 0.345
/// >>> robot.A([0.5, -0.3]).shape
/// (3, 2)
#[pyclass(frozen, module = "swimmer")]
pub(crate) struct Swimmer {
    file: SwimmerFile,
    model: Model<f64>,
}

impl Swimmer {
    /// Its swimmer file.
    pub(crate) fn file(&self) -> &SwimmerFile {
        &self.file
    }

    /// A swimmer from the content of its file.
    pub(crate) fn of(file: SwimmerFile) -> PyResult<Self> {
        let model = Model::new(&file.swimmer).map_err(|error| {
            BadInput::new_err(format!("the swimmer `{}` cannot swim: {error}", file.name))
        })?;
        Ok(Self { file, model })
    }
}

#[pymethods]
impl Swimmer {
    /// A viscous swimmer of these links and drag; `side` is both side links, or give `front` and `back`.
    #[new]
    #[pyo3(signature = (*, middle, side=None, front=None, back=None, chi=2.0, sphere_radius=0.0, log_aspect=None,
        half_thickness=None, over_viscosity=None, kinematic_viscosity=None, density=None, name="swimmer"))]
    #[allow(clippy::too_many_arguments)] // each is a keyword in Python
    fn new(
        middle: f64,
        side: Option<f64>,
        front: Option<f64>,
        back: Option<f64>,
        chi: f64,
        sphere_radius: f64,
        log_aspect: Option<f64>,
        half_thickness: Option<f64>,
        over_viscosity: Option<f64>,
        kinematic_viscosity: Option<f64>,
        density: Option<f64>,
        name: &str,
    ) -> PyResult<Self> {
        if side.is_none() && (front.is_none() || back.is_none()) {
            return Err(BadInput::new_err(
                "a swimmer has two side links: give side, or front and back",
            ));
        }
        // Every value but c_t is replaced, and c_t too where a form of it is given.
        Self::preset("purcell")?.replace(
            Some(name.to_owned()),
            Some(middle),
            side,
            front,
            back,
            Some(chi),
            Some(sphere_radius),
            log_aspect,
            half_thickness,
            over_viscosity,
            kinematic_viscosity,
            density,
        )
    }

    /// Returns a preset.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     ``purcell``, ``robot``, ``robot-slender``, ``perfect-fluid``, ``kinematic-snake`` or ``elastic-tail``.
    ///
    /// Returns
    /// -------
    /// Swimmer
    ///     The swimmer.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If there is no such preset.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("purcell").chi
    /// 2.0
    #[staticmethod]
    fn preset(name: &str) -> PyResult<Self> {
        let preset = SwimmerFile::preset(name).ok_or_else(|| {
            BadInput::new_err(format!(
                "there is no preset `{name}`: they are {}; Swimmer.load reads a file",
                SwimmerFile::PRESETS.join(", ")
            ))
        })?;
        Self::of(preset)
    }

    /// Reads a swimmer file, or returns a preset.
    ///
    /// Parameters
    /// ----------
    /// preset_or_path : str or path
    ///     Name of a preset, or path of a swimmer file (TOML).
    ///
    /// Returns
    /// -------
    /// Swimmer
    ///     The swimmer.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the file cannot be read or is invalid.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.load("robot").name
    /// 'robot'
    #[staticmethod]
    fn load(preset_or_path: PathBuf) -> PyResult<Self> {
        let found = match preset_or_path.to_str() {
            Some(text) => SwimmerFile::find(text),
            None => SwimmerFile::load(&preset_or_path),
        };
        Self::of(found.map_err(|error| of_file(&error))?)
    }

    /// Reads the text of a swimmer file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     Content of a swimmer file (TOML).
    ///
    /// Returns
    /// -------
    /// Swimmer
    ///     The swimmer.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the text is invalid.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> robot = sw.Swimmer.preset("robot")
    /// >>> sw.Swimmer.from_toml(robot.to_toml()) == robot
    /// True
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let read = SwimmerFile::parse(text, Path::new("swimmer.toml"));
        Self::of(read.map_err(|error| of_file(&error))?)
    }

    /// Returns this swimmer with other values; what is not named stays.
    ///
    /// Parameters
    /// ----------
    /// name : str, optional
    ///     Name for people.
    /// middle, side, front, back : float, optional
    ///     Lengths of the links [m]; `side` is both side links.
    /// chi : float, optional
    ///     Ratio of normal to tangential drag.
    /// sphere_radius : float, optional
    ///     Radius of the sphere [m]; 0 takes it away.
    /// log_aspect, half_thickness, over_viscosity : float, optional
    ///     Forms of the tangential drag coefficient, of which at most one is given.
    /// kinematic_viscosity, density : float, optional
    ///     Fluid [m²/s, kg/m³].
    ///
    /// Returns
    /// -------
    /// Swimmer
    ///     The other swimmer.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If a value is invalid.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("robot").replace(chi=2.6, name="slow").chi
    /// 2.6
    #[pyo3(signature = (*, name=None, middle=None, side=None, front=None, back=None, chi=None, sphere_radius=None,
        log_aspect=None, half_thickness=None, over_viscosity=None, kinematic_viscosity=None, density=None))]
    #[allow(clippy::too_many_arguments)] // each is a keyword in Python
    fn replace(
        &self,
        name: Option<String>,
        middle: Option<f64>,
        side: Option<f64>,
        front: Option<f64>,
        back: Option<f64>,
        chi: Option<f64>,
        sphere_radius: Option<f64>,
        log_aspect: Option<f64>,
        half_thickness: Option<f64>,
        over_viscosity: Option<f64>,
        kinematic_viscosity: Option<f64>,
        density: Option<f64>,
    ) -> PyResult<Self> {
        let mut file = self.file.clone();
        let set = |place: &mut f64, value: Option<f64>| {
            if let Some(value) = value {
                *place = value;
            }
        };
        for (key, value) in [
            ("middle", middle),
            ("side", side),
            ("front", front),
            ("back", back),
        ] {
            let checked = value.map_or(Ok(0.0), |value| Quantity::Length.checked(value));
            checked.map_err(|slip| BadInput::new_err(slip.of_key(key)))?;
        }
        if let Some(name) = name {
            file.name = name;
        }
        let swimmer = &mut file.swimmer;
        set(&mut swimmer.links.middle, middle);
        set(&mut swimmer.links.front, front.or(side));
        set(&mut swimmer.links.back, back.or(side));
        if chi.is_some() {
            swimmer.side_chi = None;
        }
        set(&mut swimmer.chi, chi);
        set(&mut swimmer.sphere_radius, sphere_radius);
        let forms = [
            log_aspect.map(TangentialDrag::LogAspect),
            half_thickness.map(TangentialDrag::HalfThickness),
            over_viscosity.map(TangentialDrag::OverViscosity),
        ];
        let mut forms = forms.into_iter().flatten();
        if let Some(form) = forms.next() {
            swimmer.tangential_drag = form;
        }
        if forms.next().is_some() {
            return Err(BadInput::new_err(
                "c_t has one form: give log_aspect, half_thickness or over_viscosity, not two of them",
            ));
        }
        file.fluid = fluid(file.fluid, kinematic_viscosity, density)?;
        Self::of(file)
    }

    /// Returns the local connection A(Φ): body velocity (v_x, v_y, θ̇) per joint rate.
    ///
    /// Parameters
    /// ----------
    /// phi : array_like
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (…, 3, 2).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the last dimension is not 2.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("purcell").A([[0.5, -0.3], [1.0, 1.0]]).shape
    /// (2, 3, 2)
    #[pyo3(name = "A")]
    fn connection<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[3, 2], |phi| {
            let a = self.model.local_connection(phi);
            [
                a.m11, a.m12, //
                a.m21, a.m22, //
                a.m31, a.m32,
            ]
        })
    }

    /// Returns the power matrix W(Φ) over the viscosity: power = Φ̇ᵀWΦ̇.
    ///
    /// Parameters
    /// ----------
    /// phi : array_like
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (…, 2, 2).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the last dimension is not 2.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> W = sw.Swimmer.preset("purcell").W([0.5, -0.3])
    /// >>> bool(W[0, 1] == W[1, 0])
    /// True
    #[pyo3(name = "W")]
    fn power<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[2, 2], |phi| {
            let w = self.model.power_matrix(phi);
            [w.m11, w.m12, w.m21, w.m22]
        })
    }

    /// Returns the exact derivatives of A: ``[..., i, j, k]`` is ∂A_ij/∂φ_k.
    ///
    /// Parameters
    /// ----------
    /// phi : array_like
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (…, 3, 2, 2).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the last dimension is not 2.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("purcell").dA([0.5, -0.3]).shape
    /// (3, 2, 2)
    #[pyo3(name = "dA")]
    fn d_connection<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[3, 2, 2], |phi| {
            let [one, two] = self.model.first_derivatives(phi).d_connection;
            [
                one.m11, two.m11, one.m12, two.m12, //
                one.m21, two.m21, one.m22, two.m22, //
                one.m31, two.m31, one.m32, two.m32,
            ]
        })
    }

    /// Returns the exact derivatives of W: ``[..., i, j, k]`` is ∂W_ij/∂φ_k.
    ///
    /// Parameters
    /// ----------
    /// phi : array_like
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (…, 2, 2, 2).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the last dimension is not 2.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("purcell").dW([0.5, -0.3]).shape
    /// (2, 2, 2)
    #[pyo3(name = "dW")]
    fn d_power<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[2, 2, 2], |phi| {
            let [one, two] = self.model.first_derivatives(phi).d_power;
            [
                one.m11, two.m11, one.m12, two.m12, //
                one.m21, two.m21, one.m22, two.m22,
            ]
        })
    }

    /// Returns the curvature dA + [A₁, A₂], rows (x, y, θ): body displacement of a small counter-clockwise loop over its area.
    ///
    /// Parameters
    /// ----------
    /// phi : array_like
    ///     Joint angles [rad], shape (…, 2).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (…, 3).
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     If the last dimension is not 2.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("purcell").F([0.5, -0.3]).shape
    /// (3,)
    #[pyo3(name = "F")]
    fn curvature<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[3], |phi| {
            self.model.first_derivatives(phi).curvature().into()
        })
    }

    /// Name of the swimmer for people.
    #[getter]
    fn name(&self) -> &str {
        &self.file.name
    }

    /// Length of the middle link [m].
    #[getter]
    fn middle(&self) -> f64 {
        self.file.swimmer.links.middle
    }

    /// Length of the front link [m].
    #[getter]
    fn front(&self) -> f64 {
        self.file.swimmer.links.front
    }

    /// Length of the back link [m].
    #[getter]
    fn back(&self) -> f64 {
        self.file.swimmer.links.back
    }

    /// Length of all links L [m].
    #[getter]
    fn length(&self) -> f64 {
        self.file.swimmer.total_length()
    }

    /// Ratio of normal to tangential drag, of the middle link if the links differ in it.
    #[getter]
    fn chi(&self) -> f64 {
        self.file.swimmer.chi
    }

    /// Radius of the sphere on the middle link [m]; 0 for none.
    #[getter]
    fn sphere_radius(&self) -> f64 {
        self.file.swimmer.sphere_radius
    }

    /// Form of the tangential drag coefficient with its value, as in the swimmer file: ``log_aspect``, ``half_thickness`` or ``over_viscosity``,
    /// the last as one number or with one for ``middle``, ``front`` and ``back``.
    #[getter]
    fn c_t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fields = PyDict::new(py);
        match self.file.swimmer.tangential_drag {
            TangentialDrag::LogAspect(value) => fields.set_item("log_aspect", value)?,
            TangentialDrag::HalfThickness(value) => fields.set_item("half_thickness", value)?,
            TangentialDrag::OverViscosity(value) => fields.set_item("over_viscosity", value)?,
            TangentialDrag::PerLink(values) => {
                let links = PyDict::new(py);
                links.set_item("middle", values.middle)?;
                links.set_item("front", values.front)?;
                links.set_item("back", values.back)?;
                fields.set_item("over_viscosity", links)?;
            }
        }
        Ok(fields)
    }

    /// Medium of the links: "viscous", "perfect" or "wheels".
    #[getter]
    fn medium(&self) -> &'static str {
        match self.file.swimmer.medium {
            Medium::Viscous => "viscous",
            Medium::Perfect { .. } => "perfect",
            Medium::Wheels => "wheels",
        }
    }

    /// Fingerprint that gait files carry: SHA-256 of links, drag and sphere.
    #[getter]
    fn hash(&self) -> String {
        self.file.hash().to_string()
    }

    /// Returns the text of the swimmer file.
    ///
    /// Returns
    /// -------
    /// str
    ///     Content of a swimmer file (TOML).
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> print(sw.Swimmer.preset("purcell").to_toml().splitlines()[0])
    /// name = "purcell"
    fn to_toml(&self) -> String {
        self.file.to_toml()
    }

    /// Writes the swimmer file. A file that exists is replaced.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     Path of the file (.toml).
    ///
    /// Raises
    /// ------
    /// Failed
    ///     If the file cannot be written.
    ///
    /// Examples
    /// --------
    /// >>> import swimmer as sw
    /// >>> sw.Swimmer.preset("robot").save("mine.toml")  # doctest: +SKIP
    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.file.save(&path).map_err(|error| of_file(&error))
    }

    fn __repr__(&self) -> String {
        let swimmer = &self.file.swimmer;
        let links = swimmer.links;
        format!(
            "<Swimmer {:?}: links {}, {}, {} m, chi {}, sphere {} m>",
            self.file.name,
            links.front,
            links.middle,
            links.back,
            swimmer.chi,
            swimmer.sphere_radius
        )
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.file == other.file
    }

    fn __hash__(&self) -> u64 {
        let bytes = *self.file.hash().as_bytes();
        bytes
            .into_iter()
            .take(8)
            .fold(0, |hash, byte| hash << 8 | u64::from(byte))
    }

    /// For `pickle` and `copy`.
    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String,))> {
        let make = slf.get_type().getattr("from_toml")?.unbind();
        Ok((make, (slf.get().to_toml(),)))
    }
}

fn fluid(
    before: Option<Fluid>,
    kinematic_viscosity: Option<f64>,
    density: Option<f64>,
) -> PyResult<Option<Fluid>> {
    if kinematic_viscosity.is_none() && density.is_none() {
        return Ok(before);
    }
    let wanted = kinematic_viscosity
        .or(before.map(|fluid| fluid.kinematic_viscosity))
        .zip(density.or(before.map(|fluid| fluid.density)));
    let Some((kinematic_viscosity, density)) = wanted else {
        return Err(BadInput::new_err(
            "a fluid has kinematic_viscosity in m²/s and density in kg/m³: give both",
        ));
    };
    for (name, value) in [
        ("kinematic_viscosity", kinematic_viscosity),
        ("density", density),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(BadInput::new_err(format!(
                "{name} = {value} must be a positive number"
            )));
        }
    }
    Ok(Some(Fluid {
        kinematic_viscosity,
        density,
    }))
}
