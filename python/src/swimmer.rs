//! A swimmer and its equations of motion over arrays of shapes.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use swimmer_files::{Fluid, Quantity, SwimmerFile};
use swimmer_model::{Medium, Model, TangentialDrag};

use crate::arrays::{Array, Numbers, Shapes};
use crate::errors::{BadInput, of_file};

/// A three-link swimmer: links, drag, sphere, and where known its fluid and servos. It never changes; `replace` gives another.
///
/// Lengths are in metres, angles in radians, drag and power over the viscosity.
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

    fn of(file: SwimmerFile) -> PyResult<Self> {
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

    /// A preset that `swimmer swimmers` lists, such as `purcell`, `robot` or `perfect-fluid`.
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

    /// A swimmer file (TOML), or a preset by its name, as `--swimmer` takes them.
    #[staticmethod]
    fn load(preset_or_path: PathBuf) -> PyResult<Self> {
        let found = match preset_or_path.to_str() {
            Some(text) => SwimmerFile::find(text),
            None => SwimmerFile::load(&preset_or_path),
        };
        Self::of(found.map_err(|error| of_file(&error))?)
    }

    /// The text of a swimmer file.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let read = SwimmerFile::parse(text, Path::new("swimmer.toml"));
        Self::of(read.map_err(|error| of_file(&error))?)
    }

    /// This swimmer with other values; what is not named stays. `side` is both side links; the last three are the forms of c_t, of
    /// which one holds; `sphere_radius=0` takes the sphere away.
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

    /// The local connection A(Φ), body velocity (v_x, v_y, θ̇) per joint rate: shape (…, 2) gives (…, 3, 2).
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

    /// The power matrix W(Φ) over the viscosity, power = Φ̇ᵀWΦ̇: shape (…, 2) gives (…, 2, 2).
    #[pyo3(name = "W")]
    fn power<'py>(&self, py: Python<'py>, phi: Numbers<'py>) -> PyResult<Array<'py>> {
        Shapes::copied(&phi)?.each(py, &[2, 2], |phi| {
            let w = self.model.power_matrix(phi);
            [w.m11, w.m12, w.m21, w.m22]
        })
    }

    /// The exact derivatives of A, the joint of the derivative last: [..., i, j, k] is ∂A_ij/∂φ_k; (…, 2) gives (…, 3, 2, 2).
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

    /// The exact derivatives of W over the viscosity: [..., i, j, k] is ∂W_ij/∂φ_k; (…, 2) gives (…, 2, 2, 2).
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

    /// The curvature dA + [A₁, A₂], rows (x, y, θ): the body displacement of a tiny counter-clockwise loop over its area; (…, 2)
    /// gives (…, 3).
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

    /// L, the length of all links [m].
    #[getter]
    fn length(&self) -> f64 {
        self.file.swimmer.total_length()
    }

    /// χ = c_n/c_t, of the middle link if the links have their own.
    #[getter]
    fn chi(&self) -> f64 {
        self.file.swimmer.chi
    }

    /// Radius of the sphere on the middle link [m]; 0 for none.
    #[getter]
    fn sphere_radius(&self) -> f64 {
        self.file.swimmer.sphere_radius
    }

    /// The form of c_t and its value, as in the swimmer file: {"log_aspect": 4.543}, {"half_thickness": …} or {"over_viscosity": …},
    /// the last with one number or with {"middle": …, "front": …, "back": …}.
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

    /// The fingerprint that gait files carry: SHA-256 of links, drag and sphere.
    #[getter]
    fn hash(&self) -> String {
        self.file.hash().to_string()
    }

    /// The text of its swimmer file.
    fn to_toml(&self) -> String {
        self.file.to_toml()
    }

    /// Writes its swimmer file, in the place of one that is there.
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
