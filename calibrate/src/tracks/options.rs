//! Options of the reader: facts about a recording that its file does not state.

use swimmer_files::{Axes, PointName, Reflectors};

use super::{TrackError, TrackPoint, TrackProblem, TrackWarning, Unit};
use crate::tracks::lines::TextLine;
use std::path::Path;

/// Facts about a recording that its file does not state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackOptions {
    /// Metres per unit of the file (per pixel); `None` where the file says its unit.
    pub metres_per_unit: Option<f64>,
    /// Rows a second: needed for files with frame numbers and no times, and wins over what any file says.
    pub rate_hz: Option<f64>,
    /// The file's axes that are the tank's x and y.
    pub axes: Option<Axes>,
    /// The least likelihood that counts (`DeepLabCut`); 0.9 unless said.
    pub likelihood: Option<f64>,
    /// Further points of a table by the names of their x and y columns; each is named `x,y`.
    pub pairs: Vec<[String; 2]>,
    /// Points that the poses will be taken from: positions of other points need not be kept. `None` keeps all.
    pub used: Option<UsedPoints>,
}

/// The points that poses are taken from.
///
/// ```
/// use calibrate::{TrackOptions, UsedPoints, read_tracks_with};
///
/// let mut text = "t,Front_x,Front_y,Back_x,Back_y,wall_x,wall_y\n".to_owned();
/// for frame in 0..5 {
///     text += &format!("{:.2},0.07,0.3,0.0,0.3,5.0,5.0\n", 0.01 * f64::from(frame));
/// }
/// let options = TrackOptions { used: Some(UsedPoints::usual(0.07)), ..TrackOptions::default() };
/// let file = read_tracks_with(text.as_bytes(), "run.csv".as_ref(), &options)?;
/// assert!(file.points[1].position(3).is_some());
/// // What is far from both is counted, and not kept.
/// assert_eq!((file.points[2].present(), file.points[2].position(3)), (5, None));
/// # Ok::<(), calibrate::TrackError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct UsedPoints {
    /// Names of the reflectors on the middle link, or of the rigid body alone.
    pub middle: Vec<PointName>,
    /// `true` if the middle link is a rigid body.
    pub is_body: bool,
    /// `true` if the names are only the usual ones, so that other points are needed if they are missing.
    pub is_guess: bool,
    /// Names of the reflectors on the side links.
    pub sides: Vec<PointName>,
    /// Distance of the reflectors on the middle link \[m\].
    pub distance_m: f64,
}

impl UsedPoints {
    /// The points of these reflectors.
    pub fn of(reflectors: &Reflectors) -> Self {
        let [front, back] = [&reflectors.front, &reflectors.back];
        let middle = match &reflectors.body {
            Some(body) => vec![PointName::Named(body.name.clone())],
            None => vec![front.point.clone(), back.point.clone()],
        };
        let sides = reflectors.sides.iter().flatten();
        Self {
            middle,
            is_body: reflectors.body.is_some(),
            is_guess: false,
            sides: sides.map(|side| side.point.clone()).collect(),
            distance_m: (front.at[0] - back.at[0]).hypot(front.at[1] - back.at[1]),
        }
    }

    /// The usual names of two reflectors at this distance \[m\].
    pub fn usual(distance_m: f64) -> Self {
        let named = |name: &str| PointName::Named(name.to_owned());
        Self {
            middle: vec![named("Front"), named("Back")],
            is_body: false,
            is_guess: true,
            sides: Vec::new(),
            distance_m,
        }
    }

    /// Returns `true` if the point has one of the names.
    pub(super) fn names(&self, point: &TrackPoint) -> bool {
        let mut names = self.middle.iter().chain(&self.sides);
        names.any(|name| point.goes_by(name))
    }

    /// Returns `true` if the point's positions may be needed.
    pub(super) fn may_need(&self, point: &TrackPoint) -> bool {
        let measured = point.kind.is_measured() && !(self.is_body && self.sides.is_empty());
        self.names(point) || measured || (self.is_guess && point.is_oriented())
    }

    /// Returns `true` if each of these points is in the file, so that others matter only close to them.
    pub(super) fn are_in(&self, points: &[TrackPoint]) -> bool {
        let mut names = self.middle.iter().chain(&self.sides);
        names.all(|name| points.iter().any(|point| point.goes_by(name)))
    }
}

impl TrackOptions {
    /// The unit that applies, its metres (1 if unknown), and a warning if the user's overrides the file's.
    pub(super) fn unit(&self, own: Unit) -> (Unit, f64, Option<TrackWarning>) {
        let given = self
            .metres_per_unit
            .filter(|metres| metres.is_finite() && *metres > 0.0);
        match given {
            Some(metres) => {
                let overridden = own.metres().map(|_| TrackWarning::UnitOverridden {
                    unit: own.to_string(),
                });
                (Unit::Scaled(metres), metres, overridden)
            }
            None => (own, own.metres().unwrap_or(1.0), None),
        }
    }

    /// The rate that the user gave.
    pub(super) fn rate(&self) -> Option<f64> {
        self.rate_hz.filter(|rate| *rate > 0.0 && rate.is_finite())
    }

    /// The rate that holds where a header says this one, and a warning where the user's is another.
    pub(super) fn rate_over(&self, header_hz: f64) -> (f64, Option<TrackWarning>) {
        let Some(used_hz) = self.rate() else {
            return (header_hz, None);
        };
        let file_hz = header_hz;
        let other = (used_hz / file_hz - 1.0).abs() > 1e-4;
        let warning = other.then_some(TrackWarning::RateOverridden { file_hz, used_hz });
        (used_hz, warning)
    }

    /// The user's rate, or an error if nothing states one.
    pub(super) fn need_rate(&self, line: &TextLine<'_>, file: &Path) -> Result<f64, TrackError> {
        self.rate()
            .ok_or_else(|| line.error(file, 0, TrackProblem::NoRate))
    }

    pub(super) fn least_likelihood(&self) -> f64 {
        self.likelihood.unwrap_or(0.9)
    }
}
