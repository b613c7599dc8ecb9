//! Optimal gaits: one function for the objectives of `operations::optimize`, and those for gaits to steer by and for a passive joint.

use operations::best_waveform::{self, RequestedSpring};
use operations::optimize::displacement::Sign;
use operations::optimize::efficiency::{Method, Optimum};
use operations::optimize::speed::Heading;
use operations::optimize::{
    self, Output, Request, displacement, efficiency, sideways, speed, steer, turning,
};
use passive_joint::Objective;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use swimmer_command::{NewFront, ResultsFolder};
use swimmer_files::Spring;

use crate::arguments::SwimmerArgument;
use crate::computation::{compute, context};
use crate::errors::{BadInput, of_operation};
use crate::gait::Gait;
use crate::keywords::{Keywords, text_of};
use crate::swimmer::Swimmer;

/// Document, gaits, swimmer and messages.
pub(crate) type WithGaits<'py> = (Bound<'py, PyAny>, Vec<Gait>, Swimmer, Vec<String>);
/// The same with one gait.
type WithGait<'py> = (Bound<'py, PyAny>, Gait, Swimmer, Vec<String>);

/// The best gait of an objective.
#[pyfunction]
#[pyo3(name = "optimize")]
pub(crate) fn best_gait<'py>(
    py: Python<'py>,
    objective: &str,
    swimmer: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithGait<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let keywords = Keywords(keywords);
    let front = new_front(&keywords)?;
    let mut request = request(objective, &keywords, front.is_some())?;
    let ((output, file), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        match &mut request {
            Request::Displacement(request) => request.swimmer = file.clone().into(),
            Request::Efficiency(request) => request.swimmer = file.clone().into(),
            Request::Turning(request) => request.swimmer = file.clone().into(),
            Request::Sideways(request) => request.swimmer = file.clone().into(),
            Request::Speed(request) => request.swimmer = file.clone().into(),
        }
        let mut output = optimize::run(&request, context)?;
        if let (Some(front), Output::Speed(output)) = (front, &mut output) {
            front.write(output)?;
        }
        Ok((output, file))
    })?;
    let gait = Gait::of_file(output.gait().file.clone())?;
    Ok((pythonize(py, &output)?, gait, Swimmer::of(file)?, notes))
}

fn request(objective: &str, keywords: &Keywords<'_>, front: bool) -> PyResult<Request> {
    // Replaced by the loaded swimmer.
    let swimmer = || "".into();
    Ok(match objective {
        "displacement" => Request::Displacement(displacement::Request {
            swimmer: swimmer(),
            bounds: keywords.bounds()?,
            sign: keywords.word("sign", &[("+", Sign::Plus), ("-", Sign::Minus)])?,
            robust: keywords.robust()?,
            timing: keywords.timing()?,
        }),
        "efficiency" => Request::Efficiency(efficiency::Request {
            swimmer: swimmer(),
            optimum: keywords.word("gait", &OPTIMA)?.unwrap_or_default(),
            method: keywords.word("method", &METHODS)?.unwrap_or_default(),
            bounds: keywords.bounds()?,
            robust: keywords.robust()?,
            order: keywords
                .count("order", 1, u64::from(u32::MAX))?
                .map(|order| usize::try_from(order).unwrap_or(usize::MAX)),
            timing: keywords.timing()?,
        }),
        "turning" => Request::Turning(turning::Request {
            swimmer: swimmer(),
            bounds: keywords.bounds()?,
        }),
        "sideways" => Request::Sideways(sideways::Request {
            swimmer: swimmer(),
            bounds: keywords.bounds()?,
        }),
        "speed" => Request::Speed(speed::Request {
            swimmer: swimmer(),
            max_rate: keywords.rates("max_rate")?,
            heading: keywords.word("heading", &HEADINGS)?.unwrap_or_default(),
            period: keywords.seconds("period")?,
            bounds: keywords.bounds()?,
            robust: keywords.robust()?,
            front,
        }),
        _ => return Err(PyValueError::new_err(format!("no objective {objective}"))),
    })
}

/// Efficiency gaits by name.
pub(crate) const OPTIMA: [(&str, Optimum); 2] =
    [("small", Optimum::Small), ("large", Optimum::Large)];
const METHODS: [(&str, Method); 4] = [
    ("auto", Method::Auto),
    ("fourier", Method::Fourier),
    ("collocation", Method::Collocation),
    ("shooting", Method::Shooting),
];
const HEADINGS: [(&str, Heading); 3] = [
    ("any", Heading::Any),
    ("forward", Heading::Forward),
    ("sideways", Heading::Sideways),
];

/// The file of the farthest gaits, if one is requested.
fn new_front(keywords: &Keywords<'_>) -> PyResult<Option<NewFront>> {
    let width = keywords.width("front")?;
    let Some(path) = keywords.path("front")? else {
        return Ok(None);
    };
    for other in ["period", "robust", "gain"] {
        if keywords.has(other)? {
            return Err(BadInput::new_err(format!(
                "front shows the farthest gaits of all periods, without uncertainty: leave out {other}"
            )));
        }
    }
    NewFront::new(&text_of(&path), width)
        .map(Some)
        .map_err(of_operation)
}

/// The gaits to steer by: document, gaits, swimmer and messages.
#[pyfunction]
pub(crate) fn steer_gaits<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithGaits<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let keywords = Keywords(keywords);
    let options = steer::Options {
        max_rate: keywords.rates("max_rate")?,
        bounds: keywords.bounds()?,
        shape: keywords.shape("shape")?,
    };
    let folder = keywords.path("output")?;
    let folder = folder.map(|path| ResultsFolder::start(&path));
    let folder = folder.transpose().map_err(of_operation)?;
    let ((output, file), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        let request = steer::Request {
            swimmer: file.clone().into(),
            options,
        };
        let mut output = steer::run(&request, context)?;
        if let Some(folder) = folder {
            folder.write_steering(&mut output)?;
        }
        Ok((output, file))
    })?;
    let gaits = output.gaits.iter();
    let gaits = gaits
        .map(|gait| Gait::of_file(gait.file.clone()))
        .collect::<PyResult<_>>()?;
    Ok((pythonize(py, &output)?, gaits, Swimmer::of(file)?, notes))
}

/// The best waveform of one servo: document, gait, swimmer and messages.
#[pyfunction]
pub(crate) fn passive_waveform<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithGait<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let keywords = Keywords(keywords);
    let joint = keywords.joint("passive")?;
    let given = |spring| Some(RequestedSpring::Given(spring));
    let spring = match keywords.stiffness()? {
        Some(stiffness) => given(Spring::Stiffness(stiffness)),
        None if keywords.text("relaxation").ok().flatten().as_deref() == Some("free") => {
            Some(RequestedSpring::Free)
        }
        None => keywords
            .seconds_or("relaxation", "\"free\"")?
            .and_then(|time| given(Spring::Relaxation(time))),
    };
    let objectives = Objective::ALL.map(|objective| (objective.word(), objective));
    let objective = keywords.word("most", &objectives)?;
    let period_s = keywords.seconds("period")?;
    let max_angle = keywords.angle("max_angle")?;
    let max_rate = keywords.rate("max_rate")?;
    let harmonics = keywords.count("harmonics", 1, 8)?;
    let harmonics = harmonics.map_or(best_waveform::HARMONICS, |count| {
        usize::try_from(count).unwrap_or(best_waveform::HARMONICS)
    });
    let path = keywords.new_file("output")?;
    let ((output, file), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        let request = best_waveform::Request {
            swimmer: file.clone().into(),
            joint,
            spring,
            objective: objective.unwrap_or(Objective::Displacement),
            period_s,
            max_angle,
            max_rate,
            harmonics,
        };
        let mut output = best_waveform::run(&request, context)?;
        if let Some(path) = path {
            output.file.save(&path)?;
            output.gait = Some(path);
        }
        Ok((output, file))
    })?;
    let gait = Gait::of_file(output.file.clone())?;
    Ok((pythonize(py, &output)?, gait, Swimmer::of(file)?, notes))
}
