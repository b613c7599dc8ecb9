//! Sources of swimmers and gaits: names, paths, texts of files, samples.

use std::path::Path;

use nalgebra::Vector2;
use serde::Deserialize;
use serde_json::Value;
use swimmer_files::{AnyGait, GaitFile, GaitSpec, GaitSpecError, Provenance, SwimmerFile};
use swimmer_model::{InvalidSwimmer, Model};

use crate::passive::Response;
use crate::{Context, Error, Files};

/// A swimmer: the name of a preset, the path of a swimmer file, the text of one, or its content.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(from = "String")]
pub enum SwimmerSource {
    /// The name of a preset, a path, or the text of a file, which has several lines.
    Text(String),
    /// Content of a swimmer file that was loaded before.
    Loaded(Box<SwimmerFile>),
}

impl From<String> for SwimmerSource {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<&str> for SwimmerSource {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<SwimmerFile> for SwimmerSource {
    fn from(file: SwimmerFile) -> Self {
        Self::Loaded(Box::new(file))
    }
}

impl SwimmerSource {
    /// Reads the swimmer, if it is not loaded. Warns then of doubtful values, and if the file was fitted from data that changed
    /// since.
    ///
    /// # Errors
    /// The file cannot be read or is invalid.
    pub fn load(&self, context: &mut Context) -> Result<SwimmerFile, Error> {
        let text = match self {
            Self::Loaded(file) => return Ok(SwimmerFile::clone(file)),
            Self::Text(text) => text,
        };
        let file = if let Some(preset) = SwimmerFile::preset(text) {
            preset
        } else if text.contains('\n') || context.files == Files::Unavailable {
            SwimmerFile::parse(text, Path::new("swimmer.toml"))?
        } else {
            let file = SwimmerFile::find(text)?;
            warn_if_outdated(Path::new(text), context)?;
            file
        };
        warn_if_doubtful(&file, context);
        Ok(file)
    }
}

/// Warns of doubtful values of a swimmer.
pub fn warn_if_doubtful(file: &SwimmerFile, context: &mut Context) {
    for doubt in file.doubts() {
        context.warn(format!("warning: {}: {doubt}", file.name));
    }
}

/// Refuses a swimmer that is no robot: a robot, its twin and a fit know the paper's parameters only
/// ([`common_drag`](swimmer_model::Swimmer::common_drag)).
///
/// # Errors
/// The links have a drag of their own.
pub fn check_robots_drag(file: &SwimmerFile) -> Result<(), Error> {
    let reason = file.swimmer.common_drag();
    reason.map_err(|reason| Error::bad_input(&InvalidSwimmer::Uncommon(reason)))
}

/// Warns if the data from which a swimmer file was fitted have changed since.
///
/// # Errors
/// The file cannot be read.
pub fn warn_if_outdated(path: &Path, context: &mut Context) -> Result<(), Error> {
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let made = Provenance::load(path)?;
    for input in made.iter().flat_map(|made| made.changed(folder)) {
        context.warn(format!(
            "note: {} was fitted from {input}, which has changed since; calibrate again",
            path.display()
        ));
    }
    Ok(())
}

/// A gait: `circle:AMPLITUDE`, `square:AMPLITUDE`, the path of a gait file, the text of one, or samples.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Value")]
pub enum GaitSource {
    /// A closed form or a path.
    Spec(GaitSpec),
    /// The text of a gait file, which has several lines, or of a closed form or a path.
    Text(String),
    /// Samples at equal steps of the phase, φ₁ and φ₂ \[rad\] alternating, without the last, which equals the first.
    Even(Vec<f64>),
}

/// By way of a JSON value: an untagged enum buffers numbers, and how depends on features of `serde_json` that other crates enable.
impl TryFrom<Value> for GaitSource {
    type Error = &'static str;

    fn try_from(value: Value) -> Result<Self, Self::Error> {
        match value {
            Value::String(text) => Some(Self::Text(text)),
            Value::Array(phi) => phi
                .iter()
                .map(Value::as_f64)
                .collect::<Option<_>>()
                .map(Self::Even),
            _ => None,
        }
        .ok_or("a gait is a text or a list of angles")
    }
}

impl From<GaitSpec> for GaitSource {
    fn from(spec: GaitSpec) -> Self {
        Self::Spec(spec)
    }
}

/// Samples that describe a circle or a square as a gait file.
const SAMPLES: usize = 1024;

impl GaitSource {
    /// Reads the gait.
    ///
    /// # Errors
    /// The text is no gait, or the file cannot be read or is invalid.
    pub fn read(&self, files: Files) -> Result<AnyGait, Error> {
        match self.resolve(files)? {
            Resolved::Spec(spec) => Ok(spec.load()?),
            Resolved::Samples(file) => curve(&file),
        }
    }

    /// Reads the gait for this swimmer. Warns if the gait file names another one.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn load_for(&self, swimmer: &SwimmerFile, context: &mut Context) -> Result<AnyGait, Error> {
        match self.resolve(context.files)? {
            Resolved::Spec(spec) => spec.load_by(|path| {
                let file = GaitFile::load(path)?;
                warn_if_for_another(swimmer, &file, &spec.to_string(), context);
                Ok(file)
            }),
            Resolved::Samples(file) => {
                warn_if_for_another(swimmer, &file, "the gait", context);
                curve(&file)
            }
        }
    }

    /// Reads the gait with all that its file says; a circle or a square becomes samples.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn file(&self, files: Files) -> Result<GaitFile, Error> {
        match self.resolve(files)? {
            Resolved::Spec(GaitSpec::File { path, reversed }) => {
                let file = GaitFile::load(&path)?;
                Ok(if reversed { file.reversed() } else { file })
            }
            Resolved::Spec(closed_form) => Ok(GaitFile::sampled(&closed_form.load()?, SAMPLES)),
            Resolved::Samples(file) => Ok(*file),
        }
    }

    fn resolve(&self, files: Files) -> Result<Resolved, Error> {
        let spec = match self {
            Self::Even(phi) => return Ok(Resolved::Samples(Box::new(even(phi)))),
            Self::Text(text) if text.contains('\n') => {
                let file = GaitFile::parse(text, Path::new("gait file"))?;
                return Ok(Resolved::Samples(Box::new(file)));
            }
            Self::Text(text) => text
                .parse()
                .map_err(|error: GaitSpecError| Error::bad_input(&error))?,
            Self::Spec(spec) => spec.clone(),
        };
        match spec {
            GaitSpec::File { path, .. } if files == Files::Unavailable => {
                Err(Error::refused(format!(
                    "`{}` is neither circle:ANGLE nor square:ANGLE; open a gait file instead",
                    path.display()
                )))
            }
            spec => Ok(Resolved::Spec(spec)),
        }
    }
}

/// A gait before its curve is made.
enum Resolved {
    /// A closed form, or a path that is still to be read.
    Spec(GaitSpec),
    /// Samples, from the text of a file or given as such.
    Samples(Box<GaitFile>),
}

pub(crate) fn curve(file: &GaitFile) -> Result<AnyGait, Error> {
    AnyGait::from_file(file).map_err(|why| Error::refused(format!("reading the gait: {why}")))
}

fn even(phi: &[f64]) -> GaitFile {
    let mut shapes: Vec<Vector2<f64>> = phi
        .chunks_exact(2)
        .map(|pair| Vector2::new(pair[0], pair[1]))
        .collect();
    let count = shapes.len();
    shapes.extend(shapes.first().copied());
    GaitFile {
        u: (0..=count)
            .map(|k| k as f64 / count.max(1) as f64)
            .collect(),
        phi: shapes,
        ..GaitFile::default()
    }
}

/// Warns if a gait file was made for another swimmer. `name` is what the user calls the gait.
pub fn warn_if_for_another(
    swimmer: &SwimmerFile,
    file: &GaitFile,
    name: &str,
    context: &mut Context,
) {
    if file.swimmer_hash.is_some_and(|hash| hash != swimmer.hash()) {
        let named = file
            .swimmer_name
            .as_ref()
            .map_or_else(String::new, |name| format!(" (it names {name})"));
        context.warn(format!(
            "warning: {name} was made for another swimmer than {}{named}",
            swimmer.name
        ));
    }
}

/// A swimmer, its model and a gait.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The swimmer file.
    pub file: SwimmerFile,
    /// Its model.
    pub model: Model<f64>,
    /// The gait.
    pub gait: AnyGait,
    /// The same as samples, if it was computed as the response of a passive joint.
    pub samples: Option<GaitFile>,
    /// The passive joint and its limit cycle; `None` if both joints are driven.
    pub response: Option<Response>,
}

impl Subject {
    /// Reads a swimmer and a gait for it.
    ///
    /// # Errors
    /// A source cannot be read or is invalid, or the swimmer has no valid model.
    pub fn load(
        swimmer: &SwimmerSource,
        gait: &GaitSource,
        context: &mut Context,
    ) -> Result<Self, Error> {
        let file = swimmer.load(context)?;
        let gait = gait.load_for(&file, context)?;
        let model = model(&file)?;
        Ok(Self {
            file,
            model,
            gait,
            samples: None,
            response: None,
        })
    }
}

/// The model of a swimmer.
///
/// # Errors
/// The swimmer's lengths or drag are invalid.
pub fn model(file: &SwimmerFile) -> Result<Model<f64>, Error> {
    Model::new(&file.swimmer).map_err(|error| {
        Error::refused(format!("the swimmer `{}` cannot swim: {error}", file.name))
    })
}
