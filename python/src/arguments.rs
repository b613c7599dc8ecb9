//! Swimmers and gaits as the functions take them: objects, names and paths.

use std::path::PathBuf;

use operations::passive::Drive;
use operations::{
    Context, Error, Files, GaitSource, SwimmerSource, warn_if_doubtful, warn_if_for_another,
};
use pyo3::prelude::*;
use swimmer_files::{AnyGait, GaitFile, GaitSpec, GaitSpecError, SwimmerFile};

use crate::errors::BadInput;
use crate::gait::Gait;
use crate::swimmer::Swimmer;

/// A swimmer, or the name of a preset or of a file.
#[derive(FromPyObject)]
enum AnySwimmer<'py> {
    Swimmer(PyRef<'py, Swimmer>),
    Path(PathBuf),
}

/// A value of another type, by the name of its argument.
fn refused(name: &str, value: &Bound<'_, PyAny>, form: &str) -> PyErr {
    let shown = value.repr().map(|text| text.to_string());
    let shown = shown.unwrap_or_else(|_| "…".to_owned());
    BadInput::new_err(format!("{name}={shown}: give {form}"))
}

/// Source of a swimmer that an operation loads.
#[derive(Clone)]
pub(crate) struct SwimmerArgument(AnySource);

#[derive(Clone)]
enum AnySource {
    Object(Box<SwimmerFile>),
    Text(String),
}

impl SwimmerArgument {
    /// Reads the argument `swimmer`.
    pub(crate) fn of(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let form = "a Swimmer, the name of a preset, or the path of a swimmer file";
        let swimmer = value
            .extract()
            .map_err(|_| refused("swimmer", value, form))?;
        Ok(Self(match swimmer {
            AnySwimmer::Swimmer(swimmer) => AnySource::Object(Box::new(swimmer.file().clone())),
            AnySwimmer::Path(path) => AnySource::Text(path.to_string_lossy().into_owned()),
        }))
    }

    /// Loads the swimmer. Warns of doubtful values.
    pub(crate) fn load(&self, context: &mut Context) -> Result<SwimmerFile, Error> {
        match &self.0 {
            AnySource::Object(file) => {
                warn_if_doubtful(file, context);
                Ok(SwimmerFile::clone(file))
            }
            AnySource::Text(text) => SwimmerSource::from(text.as_str()).load(context),
        }
    }
}

/// A gait, or what `Gait.load` takes.
#[derive(FromPyObject)]
enum AnyGaitArgument<'py> {
    Gait(PyRef<'py, Gait>),
    Path(PathBuf),
}

/// A gait that is not loaded yet.
pub(crate) enum GaitArgument {
    /// Samples.
    Samples(Box<GaitFile>),
    /// A closed form or a path.
    Text(String),
}

/// A gait with all that its file says.
pub(crate) struct LoadedGait {
    pub(crate) name: String,
    pub(crate) curve: AnyGait,
    pub(crate) file: GaitFile,
}

impl GaitArgument {
    /// Reads the argument `gait`.
    pub(crate) fn of(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let form = "a Gait, a closed form such as \"circle:70deg\", or the path of a gait file";
        let gait = value.extract().map_err(|_| refused("gait", value, form))?;
        Ok(match gait {
            AnyGaitArgument::Gait(gait) => match gait.word() {
                Some(word) => Self::Text(word.to_owned()),
                None => Self::Samples(Box::new(gait.file().clone())),
            },
            AnyGaitArgument::Path(path) => Self::Text(path.to_string_lossy().into_owned()),
        })
    }

    fn spec(text: &str) -> Result<GaitSpec, Error> {
        text.parse()
            .map_err(|error: GaitSpecError| Error::bad_input(&error))
    }

    /// Loads the gait. Warns if it was made for another swimmer.
    pub(crate) fn load(
        self,
        swimmer: &SwimmerFile,
        context: &mut Context,
    ) -> Result<LoadedGait, Error> {
        let loaded = match self {
            Self::Samples(file) => LoadedGait {
                name: "the gait".to_owned(),
                curve: AnyGait::from_file(&file).map_err(|error| Error::bad_input(&error))?,
                file: *file,
            },
            Self::Text(text) => {
                let spec = Self::spec(&text)?;
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

    /// The same as the motion of servos, which may be `sine:AMPLITUDE`.
    pub(crate) fn drive(self) -> Result<Drive, Error> {
        match self {
            Self::Samples(file) => Ok(Drive::Samples(file)),
            Self::Text(text) => text.parse().map_err(Error::refused),
        }
    }

    /// The same as a closed form or a path; `None` for samples.
    pub(crate) fn into_spec(self) -> Result<Result<GaitSpec, Box<GaitFile>>, Error> {
        match self {
            Self::Samples(file) => Ok(Err(file)),
            Self::Text(text) => Self::spec(&text).map(Ok),
        }
    }
}
