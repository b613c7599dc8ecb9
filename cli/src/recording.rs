//! Properties of a recording that its file does not state, as flags of the commands that read one.

use calibrate::TrackOptions;
use operations::tracks;
use swimmer_files::Axes;

/// Properties of a recording that its file does not state.
#[derive(Debug, Clone, Default, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: DeepLabCut, not `DeepLabCut`
pub(crate) struct Recording {
    /// Metres per unit of the recording (per pixel), where it does not say its unit
    #[arg(long, value_name = "METRES", value_parser = positive)]
    scale: Option<f64>,
    /// Frames a second, where the recording does not say or is wrong
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,
    /// The recording's axes that are the tank's x and y: x,-y for an image, z,x for Y up
    #[arg(long, value_name = "X,Y", value_parser = axes, allow_hyphen_values = true)]
    axes: Option<Axes>,
    /// The least likelihood that counts (DeepLabCut), 0.9 unless given
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    likelihood: Option<f64>,
}

/// Axes and unit of cameras that see the robot now.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct LiveAxes {
    /// Metres per unit of the source
    #[arg(long, value_name = "METRES", value_parser = positive)]
    scale: Option<f64>,
    /// Which of the source's axes are the tank's x and y: x,-y for an image, z,x for Y up
    #[arg(long, value_name = "X,Y", value_parser = axes, allow_hyphen_values = true)]
    axes: Option<Axes>,
}

impl LiveAxes {
    /// These axes, in this many metres per unit of the source.
    pub(crate) fn new(scale: Option<f64>, axes: Option<Axes>) -> Self {
        Self { scale, axes }
    }

    /// Options of the reader.
    pub(crate) fn options(&self) -> TrackOptions {
        TrackOptions {
            metres_per_unit: self.scale,
            axes: self.axes,
            ..TrackOptions::default()
        }
    }
}

impl Recording {
    /// The same as a part of a request.
    pub(crate) fn request(&self) -> tracks::Recording {
        tracks::Recording {
            scale: self.scale,
            rate: self.rate,
            axes: self.axes,
            likelihood: self.likelihood,
        }
    }

    /// Options of the reader.
    pub(crate) fn options(&self) -> TrackOptions {
        self.request().options()
    }

    /// The first flag that was given, for commands that know it from elsewhere.
    pub(crate) fn given(&self) -> Option<&'static str> {
        [
            ("--scale", self.scale.is_some()),
            ("--rate", self.rate.is_some()),
            ("--axes", self.axes.is_some()),
            ("--likelihood", self.likelihood.is_some()),
        ]
        .into_iter()
        .find_map(|(flag, given)| given.then_some(flag))
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a number above zero".to_owned()),
    }
}

fn axes(text: &str) -> Result<Axes, String> {
    text.parse()
}
