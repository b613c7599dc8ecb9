//! Common arguments of calls: a swimmer and a gait, parsed by the same crates as on the command line.

use std::cell::RefCell;
use std::path::Path;

use nalgebra::Vector2;
use serde::Deserialize;
use serde_json::Value;
use swimmer_files::{AnyGait, GaitFile, GaitSpec, SwimmerFile};
use swimmer_model::Model;

/// Swimmer: the name of a preset, or the text of a swimmer file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct SwimmerText(String);

thread_local! {
    /// Last parsed swimmer, since dragging a gait passes the same one at every step.
    static READ: RefCell<Option<(SwimmerText, SwimmerFile)>> = const { RefCell::new(None) };
}

impl SwimmerText {
    /// Parses the swimmer.
    pub(crate) fn read(&self) -> Result<SwimmerFile, String> {
        let known = READ.with_borrow(|last| {
            let same = last.as_ref().filter(|(text, _)| text == self);
            same.map(|(_, file)| file.clone())
        });
        if let Some(known) = known {
            return Ok(known);
        }
        let file = self.parse()?;
        READ.set(Some((self.clone(), file.clone())));
        Ok(file)
    }

    fn parse(&self) -> Result<SwimmerFile, String> {
        match SwimmerFile::preset(&self.0) {
            Some(preset) => Ok(preset),
            None => SwimmerFile::parse(&self.0, Path::new("swimmer.toml"))
                .map_err(|why| why.to_string()),
        }
    }

    /// Parses the swimmer and creates its model.
    pub(crate) fn model(&self) -> Result<(SwimmerFile, Model<f64>), String> {
        let file = self.read()?;
        let model = Model::new(&file.swimmer)
            .map_err(|why| format!("the swimmer `{}` cannot swim: {why}", file.name))?;
        Ok((file, model))
    }
}

/// Gait: `circle:AMPLITUDE`, `square:AMPLITUDE`, the text of a gait file, or samples.
#[derive(Debug, Deserialize)]
#[serde(try_from = "Value")]
pub(crate) enum GaitText {
    /// Name as on the command line, or the text of a file.
    Text(String),
    /// Cycle in equal steps, φ₁ and φ₂ \[rad\] in turn, without the last sample, which equals the first.
    Even(Vec<f64>),
}

/// Conversion from a value instead of an untagged enum, whose buffered numbers depend on features of `serde_json` that other crates
/// enable.
impl TryFrom<Value> for GaitText {
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

/// Number of samples of a circle or a square, as in `swimmer certify`.
#[cfg(feature = "explore")]
const SAMPLES: usize = 1024;

impl GaitText {
    /// Parses the gait.
    pub(crate) fn read(&self) -> Result<AnyGait, String> {
        match self {
            Self::Text(text) => match closed_form(text)? {
                Some(gait) => Ok(gait),
                None => of_file(&file(text)?),
            },
            Self::Even(phi) => of_file(&even(phi)),
        }
    }

    /// Parses the gait with the header of its file.
    #[cfg(feature = "explore")]
    pub(crate) fn file(&self) -> Result<GaitFile, String> {
        match self {
            Self::Text(text) => match closed_form(text)? {
                Some(gait) => Ok(GaitFile::sampled(&gait, SAMPLES)),
                None => file(text),
            },
            Self::Even(phi) => Ok(even(phi)),
        }
    }
}

fn of_file(file: &GaitFile) -> Result<AnyGait, String> {
    AnyGait::from_file(file).map_err(|why| format!("reading the gait: {why}"))
}

/// Parses a text of one line as a closed form. Returns `None` for several lines, which are the text of a file.
fn closed_form(text: &str) -> Result<Option<AnyGait>, String> {
    if text.contains('\n') {
        return Ok(None);
    }
    match text.parse::<GaitSpec>() {
        Ok(GaitSpec::File { path, .. }) => Err(format!(
            "`{}` is neither circle:ANGLE nor square:ANGLE; open a gait file instead",
            path.display()
        )),
        Ok(spec) => spec.load().map(Some).map_err(|why| why.to_string()),
        Err(why) => Err(why.to_string()),
    }
}

fn file(text: &str) -> Result<GaitFile, String> {
    GaitFile::parse(text, Path::new("gait file")).map_err(|why| why.to_string())
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
