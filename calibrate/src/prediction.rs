//! Prediction of a cycle: the model swims the gait that was played, and the result passes the same estimator as a measured
//! cycle.
//!
//! With ideal servos that is the gait itself, swum by [`swimmer_model::trajectory`]. With a `[servo]` table it is the path
//! that the joints really take ([`gait_player::playback`]: table of 512 knots in 1e-4 rad, pulses at 50 Hz, dead band, rate
//! limit) in the second cycle, when the servos have forgotten where they came from. That path depends on the gait, the period
//! and the servos, but not on the drag: it is computed once a run.

// Periods and pulses are bounded by what was checked; f32 is what the robot itself uses.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use gait_player::Limits;
use gait_player::playback::Playback;
use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use gait_player::table::TableError;
use nalgebra::{Matrix2, Rotation2, Vector2};
use swimmer_files::{AnyGait, ServoFile, SwimmerFile, UnplayablePeriod, check_playable_period};
use swimmer_model::{Gait, InvalidSwimmer, Model, Pose, Swimmer, Tolerance, trajectory};

use crate::cycles::{self, Curve, Cycles, Harmonics, Projection};
use crate::sides::Sides;

/// Knots of the table that a robot is given.
pub(crate) const KNOTS: usize = 512;
/// Periods that differ by less, as a share, are the same.
const SAME_PACE: f64 = 1e-3;
/// Pieces of a gait that becomes a path: chords cut off 1e-4 of its area.
const PIECES: usize = 256;

/// Error of the prediction of a cycle.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PredictionError {
    /// The parameters describe no swimmer.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// The gait fits in no table.
    #[error("the robot could not have played this gait: {0}")]
    Table(#[from] TableError),
    /// The gait leaves the servos' range.
    #[error(
        "the gait reaches {angle:.4} rad, beyond the servos' largest angle of {max_angle} rad in the swimmer file, so the robot \
         could not have played it"
    )]
    Range {
        /// The gait's largest angle \[rad\].
        angle: f64,
        /// The servos' \[rad\].
        max_angle: f64,
    },
    /// No robot plays cycles of this period.
    #[error(transparent)]
    Period(#[from] UnplayablePeriod),
}

/// A predicted cycle, in the frame of its first heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedCycle {
    /// X \[m\].
    pub x_m: f64,
    /// Y \[m\].
    pub y_m: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// ΔY \[m\].
    pub delta_y_m: f64,
    /// Δθ \[rad\].
    pub delta_theta_rad: f64,
}

impl PredictedCycle {
    /// Adds this share of a change.
    pub(crate) fn changed(self, change: &Self, share: f64) -> Self {
        Self {
            x_m: self.x_m + share * change.x_m,
            y_m: self.y_m + share * change.y_m,
            rotation_rad: self.rotation_rad + share * change.rotation_rad,
            delta_y_m: self.delta_y_m + share * change.delta_y_m,
            delta_theta_rad: self.delta_theta_rad + share * change.delta_theta_rad,
        }
    }
}

/// Predicts one cycle in steady state, with the servos of the file if it has any.
///
/// # Errors
/// [`PredictionError`]: no swimmer, or a gait that the servos cannot play.
///
/// ```
/// use calibrate::predict;
/// use swimmer_files::{AnyGait, SwimmerFile};
/// use swimmer_model::{Model, Tolerance, swim};
///
/// let robot = SwimmerFile::preset("robot").unwrap();
/// let circle = AnyGait::circle(1.2);
/// let cycle = predict(&robot, &circle, 30.0).unwrap();
/// // The preset has ideal servos: the difference is due to the robot's table.
/// let designed = swim(&Model::new(&robot.swimmer).unwrap(), &circle, &Tolerance::default());
/// assert!((cycle.x_m / designed.displacement.x - 1.0).abs() < 1e-3);
/// ```
pub fn predict(
    file: &SwimmerFile,
    gait: &AnyGait,
    period_s: f64,
) -> Result<PredictedCycle, PredictionError> {
    let path = JointPath::new(gait, file.servo.as_ref(), period_s)?;
    Ok(path.predict(&file.swimmer, &Projection::new())?.0)
}

/// The joint angles of one cycle in steady state \[rad\], each with its fraction of the cycle, at the vertices of the played
/// path or at 512 points of an ideal one.
///
/// # Errors
/// As [`predict`].
///
/// ```
/// use swimmer_files::AnyGait;
///
/// let path = calibrate::joint_path(&AnyGait::circle(1.2), None, 30.0).unwrap();
/// assert!(path.iter().all(|(_, [one, two])| (one.hypot(*two) - 1.2).abs() < 2e-3));
/// ```
pub fn joint_path(
    gait: &AnyGait,
    servo: Option<&ServoFile>,
    period_s: f64,
) -> Result<Vec<(f64, [f64; 2])>, PredictionError> {
    Ok(match JointPath::new(gait, servo, period_s)? {
        JointPath::Played(vertices) => vertices
            .iter()
            .map(|(u, phi)| (*u, [phi.x, phi.y]))
            .collect(),
        JointPath::Ideal(gait) => (0..=KNOTS)
            .map(|i| i as f64 / KNOTS as f64)
            .map(|u| (u, gait.at(u).phi.into()))
            .collect(),
    })
}

/// The way of the joints through one cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum JointPath {
    /// The gait itself.
    Ideal(AnyGait),
    /// Vertices (u, Φ) between which both angles change evenly.
    Played(Vec<(f64, Vector2<f64>)>),
}

impl JointPath {
    pub(crate) fn new(
        gait: &AnyGait,
        servo: Option<&ServoFile>,
        period_s: f64,
    ) -> Result<Self, PredictionError> {
        match servo {
            None => Ok(Self::Ideal(gait.clone())),
            Some(servo) => played(gait, servo, period_s).map(Self::Played),
        }
    }

    /// The same way with each joint's angle multiplied, and elsewhere by a constant \[rad\]. A gait becomes a path of fine pieces.
    pub(crate) fn moved(&self, gain: Vector2<f64>, by: Vector2<f64>) -> Self {
        let place = |phi: &Vector2<f64>| phi.component_mul(&gain) + by;
        Self::Played(match self {
            Self::Ideal(gait) => (0..=PIECES)
                .map(|i| i as f64 / PIECES as f64)
                .map(|u| (u, place(&gait.at(u).phi)))
                .collect(),
            Self::Played(vertices) => vertices.iter().map(|(u, phi)| (*u, place(phi))).collect(),
        })
    }

    /// The same way where the front joint is later by a fraction of the cycle.
    pub(crate) fn with_front_later(&self, by: f64) -> Self {
        let places = (0..=PIECES).map(|i| i as f64 / PIECES as f64);
        let later = |u: f64| Vector2::new(self.angles(u - by).x, self.angles(u).y);
        Self::Played(places.map(|u| (u, later(u))).collect())
    }

    /// The same way with the back joint of another one.
    pub(crate) fn with_back_of(&self, other: &Self) -> Self {
        let places = (0..=KNOTS).map(|i| i as f64 / KNOTS as f64);
        let joined = |u: f64| Vector2::new(self.angles(u).x, other.angles(u).y);
        Self::Played(places.map(|u| (u, joined(u))).collect())
    }

    /// Both angles at any fraction of the cycle.
    fn angles(&self, u: f64) -> Vector2<f64> {
        let u = u.rem_euclid(1.0);
        match self {
            Self::Ideal(gait) => gait.at(u).phi,
            Self::Played(vertices) => {
                let next = vertices.partition_point(|(at, _)| *at <= u);
                let before = next.checked_sub(1).and_then(|i| vertices.get(i));
                match (before, vertices.get(next)) {
                    (Some((from, a)), Some((to, b))) => a.lerp(b, (u - from) / (to - from)),
                    (Some((_, phi)), None) | (None, Some((_, phi))) => *phi,
                    (None, None) => Vector2::zeros(),
                }
            }
        }
    }

    /// The same way with other angles at its vertices; a gait has none, and stays.
    pub(crate) fn with_vertices(&self, other: impl Fn(&Vector2<f64>) -> Vector2<f64>) -> Self {
        match self {
            Self::Ideal(gait) => Self::Ideal(gait.clone()),
            Self::Played(vertices) => {
                Self::Played(vertices.iter().map(|(u, phi)| (*u, other(phi))).collect())
            }
        }
    }

    /// The predicted cycle and its heading's harmonics.
    pub(crate) fn predict(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<(PredictedCycle, Harmonics), InvalidSwimmer> {
        let swum = self.swum(&Model::new(swimmer)?);
        let (curve, next) = swum.curves(projection, &Observation::exactly());
        Ok((cycle(&curve, &next, 0.0), curve.heading_harmonics()))
    }

    /// The poses of one cycle.
    pub(crate) fn swum(&self, model: &Model<f64>) -> SwumCycle {
        let (poses, end) = match self {
            Self::Ideal(gait) => swum(model, gait),
            Self::Played(vertices) => swum_along(model, vertices),
        };
        SwumCycle { poses, end }
    }
}

/// A cycle's poses at the projection's places, and at its end.
#[derive(Debug, Clone)]
pub(crate) struct SwumCycle {
    poses: Vec<Pose<f64>>,
    end: Pose<f64>,
}

/// The way that poses come to be measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Observation {
    /// The point on the middle link that is taken for its centre, and the turn of what is taken for its heading.
    pub(crate) marker: Pose<f64>,
    /// Lengths of the cameras over true ones, along and across the swimmer's first heading and sheared.
    pub(crate) stretch: Matrix2<f64>,
}

impl Observation {
    pub(crate) fn exactly() -> Self {
        Self {
            marker: Pose::identity(),
            stretch: Matrix2::identity(),
        }
    }

    fn pose(&self, pose: Pose<f64>) -> Pose<f64> {
        let pose = pose * self.marker;
        if self.stretch == Matrix2::identity() {
            return pose;
        }
        let place = self.stretch * pose.position();
        let (sin, cos) = pose.theta.sin_cos();
        let line = Vector2::new(cos, sin);
        let seen = self.stretch * line;
        let turn = line.perp(&seen).atan2(line.dot(&seen));
        Pose::new(place.x, place.y, pose.theta + turn)
    }
}

impl SwumCycle {
    /// The cycle as such cameras measure it, if another model determines the start of cycles, by these harmonics of its
    /// heading.
    pub(crate) fn as_cut(
        &self,
        projection: &Projection,
        seen: &Observation,
        cut_by: Option<&Harmonics>,
    ) -> PredictedCycle {
        let (curve, next) = self.curves(projection, seen);
        let shift = |cut_by: &Harmonics| cycles::shift(&curve.heading_harmonics(), cut_by);
        let start = cut_by.and_then(shift).unwrap_or(0.0);
        cycle(&curve, &next, start - start.round())
    }

    /// One cycle and the next.
    fn curves(&self, projection: &Projection, seen: &Observation) -> (Curve, Curve) {
        let here = self.poses.iter().map(|pose| seen.pose(*pose));
        let next = self.poses.iter().map(|pose| seen.pose(self.end * *pose));
        let (here, next) = (here.collect::<Vec<_>>(), next.collect::<Vec<_>>());
        let (curve, next) = (projection.curve(&here), projection.curve(&next));
        (curve.drifting(&curve, &next, 1.0), next)
    }
}

/// Direction and place of a run in the view of the cameras.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// Heading at the starts of its cycles \[rad\].
    pub(crate) heading: f64,
    /// Mean place of its cycles: in metres, or over the runs' mean distance from their centre.
    pub(crate) place: Vector2<f64>,
}

impl View {
    /// Of a run's cycles; `None` if it has none.
    pub(crate) fn of(cycles: &Cycles) -> Option<Self> {
        const PLACES: usize = 8;
        let count = cycles.cycles.len() as f64;
        let (mut place, mut line) = (Vector2::zeros(), Vector2::zeros());
        for cycle in &cycles.cycles {
            let (sin, cos) = cycle.at(0.0).theta.sin_cos();
            line += Vector2::new(cos, sin);
            for i in 0..PLACES {
                let at = cycle.at(i as f64 / PLACES as f64).position();
                place += at / (PLACES as f64 * count);
            }
        }
        (count > 0.0).then(|| Self {
            heading: line.y.atan2(line.x),
            place,
        })
    }

    /// The stretch of a view in the frame of this run's heading: that of cameras, and that of a lens by the distance.
    pub(crate) fn stretch(&self, cameras: Matrix2<f64>, distortion: f64) -> Matrix2<f64> {
        let place = self.place;
        let lens = Matrix2::identity() * (distortion * place.norm_squared())
            + place * place.transpose() * (2.0 * distortion);
        let turn = Rotation2::new(self.heading);
        turn.inverse() * (cameras + lens) * turn
    }
}

/// Gait and joint path of one run, as played.
#[derive(Debug, Clone)]
pub(crate) struct Played {
    pub(crate) gait: AnyGait,
    /// One cycle as commanded \[s\].
    pub(crate) period_s: f64,
    /// The way of the joints, as the starting swimmer's servos play the gait.
    pub(crate) path: JointPath,
    /// The heading by which its cycles were cut, if that is not each model's own.
    pub(crate) cut_by: Option<Harmonics>,
    /// Direction and place of its cycles, if it was tracked.
    pub(crate) view: Option<View>,
    /// Change of its cycle by the tank's walls to first order, if the tank is known.
    pub(crate) walls: Option<PredictedCycle>,
    /// Measured angles of `path`, if reflectors showed it: it is valid for its cycles as they were cut, and the servo model is
    /// not used.
    pub(crate) sides: Option<Sides>,
}

impl Played {
    /// The commanded path, without measured angles.
    ///
    /// # Errors
    /// As [`JointPath::new`].
    pub(crate) fn commanded(
        gait: &AnyGait,
        servo: Option<&ServoFile>,
        period_s: f64,
    ) -> Result<Self, PredictionError> {
        Ok(Self {
            gait: gait.clone(),
            period_s,
            path: JointPath::new(gait, servo, period_s)?,
            cut_by: None,
            view: None,
            walls: None,
            sides: None,
        })
    }
}

/// The first run that played the same gait at the same pace, for each run. Measured joint angles are each run's own.
pub(crate) fn first_of_repeats<P: std::borrow::Borrow<Played>>(runs: &[P]) -> Vec<usize> {
    let same = |a: &Played, b: &Played| {
        let slow = (a.period_s / b.period_s - 1.0).abs() < SAME_PACE;
        slow && a.sides.is_none() && b.sides.is_none() && a.gait == b.gait
    };
    let first = |(run, played): (usize, &P)| {
        let mut before = runs[..run].iter();
        before
            .position(|other| same(other.borrow(), played.borrow()))
            .unwrap_or(run)
    };
    runs.iter().enumerate().map(first).collect()
}

fn cycle(curve: &Curve, next: &Curve, start: f64) -> PredictedCycle {
    let step = curve.step_to(next, start);
    let (delta_y_m, delta_theta_rad) = curve.amplitudes(start);
    PredictedCycle {
        x_m: step.x,
        y_m: step.y,
        rotation_rad: step.theta,
        delta_y_m,
        delta_theta_rad,
    }
}

/// Poses at the projection's places, and at the cycle's end.
fn swum(model: &Model<f64>, gait: &AnyGait) -> (Vec<Pose<f64>>, Pose<f64>) {
    let count = Projection::places().count();
    let mut poses = Vec::with_capacity(count);
    let mut end = Pose::identity();
    let mut index = 0;
    // Odd points of a grid twice as fine are the middles of its stretches.
    trajectory(model, gait, &Tolerance::new(1e-10), 2 * count, |point| {
        if index % 2 == 1 {
            poses.push(point.pose);
        }
        end = point.pose;
        index += 1;
    });
    (poses, end)
}

/// The same along straight pieces: each is short, so the connection in its middle serves for all of it (second order; the
/// longest piece is a tick's motion).
fn swum_along(model: &Model<f64>, vertices: &[(f64, Vector2<f64>)]) -> (Vec<Pose<f64>>, Pose<f64>) {
    let mut poses = Vec::new();
    let mut pose = Pose::identity();
    let mut places = Projection::places().peekable();
    for pair in vertices.windows(2) {
        let [(from, phi), (until, next)] = pair else {
            continue;
        };
        let change = next - phi;
        let twist = if change == Vector2::zeros() {
            nalgebra::Vector3::zeros()
        } else {
            model.local_connection(&((phi + next) / 2.0)) * change
        };
        while let Some(u) = places.next_if(|u| u < until) {
            poses.push(pose * Pose::exp(&(twist * ((u - from) / (until - from)))));
        }
        pose = pose * Pose::exp(&twist);
    }
    poses.extend(places.map(|_| pose));
    (poses, pose)
}

fn played(
    gait: &AnyGait,
    servo: &ServoFile,
    period_s: f64,
) -> Result<Vec<(f64, Vector2<f64>)>, PredictionError> {
    check_playable_period(period_s)?;
    let table = forecast::table(gait, KNOTS)?;
    let angle = (0..KNOTS)
        .map(|knot| gait.at(knot as f64 / KNOTS as f64).phi.amax())
        .fold(0.0, f64::max);
    // The table's own rounding is no trespass.
    if angle > servo.max_angle + 1e-4 {
        return Err(PredictionError::Range {
            angle,
            max_angle: servo.max_angle,
        });
    }
    let single = |value: f64| value as f32;
    let map = ServoMap {
        centre_ns: (servo.centre_us * 1000.0).round() as u32,
        slope_rad_per_us: single(servo.slope_rad_per_us),
        ..ServoMap::ROBOT
    };
    let playback = Playback {
        table: &table,
        period_us: (period_s * 1e6).round() as u32,
        maps: [map; 2],
        limits: Limits {
            max_angle: single(servo.max_angle),
            max_rate: single(servo.max_rate),
            ..Limits::ROBOT
        },
        plant: PlantParameters {
            max_rate: servo.max_rate,
            dead_band: servo.dead_band,
            pulse_step_ns: 0,
        },
    };
    let mut vertices: Vec<(f64, Vector2<f64>)> = Vec::new();
    playback.cycle(1, |point| {
        let (u, phi) = (point.time_s / period_s, Vector2::from(point.angles));
        // Ticks in which nothing moves, and the ends that neighbouring ticks share, add nothing.
        if vertices
            .last()
            .is_none_or(|(last, at)| u > *last || phi != *at)
        {
            vertices.push((u, phi));
        }
    });
    Ok(vertices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::swim;

    fn file(servo: Option<ServoFile>) -> SwimmerFile {
        SwimmerFile {
            servo,
            ..SwimmerFile::preset("robot").unwrap()
        }
    }

    #[test]
    fn an_ideal_prediction_is_the_stroke() {
        for gait in [AnyGait::circle(1.2), AnyGait::circle(0.5).reversed_if(true)] {
            let cycle = predict(&file(None), &gait, 30.0).unwrap();
            let stroke = swim(
                &Model::new(&Swimmer::robot()).unwrap(),
                &gait,
                &Tolerance::default(),
            );
            assert!(
                (cycle.x_m - stroke.displacement.x).abs() < 1e-6 * stroke.displacement.x.abs(),
                "{cycle:?} {stroke:?}"
            );
            // The first heading is the harmonic curve's: Y is off by X times what five harmonics miss of it.
            assert!(
                (cycle.y_m - stroke.displacement.y).abs() < 1e-4 * stroke.displacement.x.abs(),
                "{cycle:?}"
            );
            assert!((cycle.delta_y_m / stroke.delta_y - 1.0).abs() < 2e-3);
            assert!((cycle.delta_theta_rad / stroke.delta_theta - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn good_servos_play_the_gait_itself() {
        let servo = ServoFile {
            dead_band: 0.0,
            max_rate: 1e6,
            ..ServoFile::default()
        };
        let gait = AnyGait::circle(1.0);
        let (ideal, played) = (
            predict(&file(None), &gait, 30.0).unwrap(),
            predict(&file(Some(servo)), &gait, 30.0).unwrap(),
        );
        assert!(
            (played.x_m / ideal.x_m - 1.0).abs() < 2e-3,
            "{played:?} {ideal:?}"
        );
        assert!((played.delta_theta_rad / ideal.delta_theta_rad - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_dead_band_makes_the_gait_smaller() {
        let servo = ServoFile {
            dead_band: 0.1,
            ..ServoFile::default()
        };
        let gait = AnyGait::circle(1.0);
        let (wide, narrow) = (
            predict(&file(None), &gait, 30.0).unwrap(),
            predict(&file(Some(servo)), &gait, 30.0).unwrap(),
        );
        assert!(narrow.x_m < 0.92 * wide.x_m, "{narrow:?} {wide:?}");
        let path = joint_path(&gait, Some(&servo), 30.0).unwrap();
        let reach = path.iter().flat_map(|(_, phi)| *phi).fold(0.0, f64::max);
        assert!((reach - 0.9).abs() < 2e-3, "{reach}");
    }

    #[test]
    fn what_servos_cannot_play() {
        let small = ServoFile {
            max_angle: 1.0,
            ..ServoFile::default()
        };
        assert!(matches!(
            predict(&file(Some(small)), &AnyGait::circle(1.2), 30.0),
            Err(PredictionError::Range { .. })
        ));
        assert!(matches!(
            predict(&file(Some(small)), &AnyGait::circle(0.5), 1e9),
            Err(PredictionError::Period(_))
        ));
        assert!(matches!(
            predict(&file(Some(small)), &AnyGait::circle(4.0), 30.0),
            Err(PredictionError::Table(_))
        ));
    }
}
