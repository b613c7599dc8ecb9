//! Predicted course of a play: shapes and poses over time.

use forecast::playlist::{PlaylistTable, steady_cycle, timed};
use forecast::{Servos, Tank};
use gait_player::playback::PlayedPoint;
use gait_player::ramp::{NEUTRAL, Ramp};
use gait_player::{GaitTable, Limits, TICK_US};
use nalgebra::Vector2;
use swimmer_model::{Model, Pose};

/// Longest piece of a joint path that is integrated in one step \[rad\]. The midpoint rule's error is then below 1e-6 of the
/// swimmer's length over a cycle.
const LONGEST_PIECE: f64 = 0.02;

/// Predicted shapes and poses over time, from the first set-point on. Poses are in the frame of the middle link at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    points: Vec<Point>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    time_s: f64,
    shape: Vector2<f64>,
    pose: Pose<f64>,
}

impl Course {
    /// A whole play of one table, from rest to rest. At `rest` the joints stand within their dead band of straight, where the play
    /// before left them \[rad\] ([`Self::last_shape`]).
    pub fn of_play(
        model: &Model<f64>,
        table: &PlaylistTable,
        servos: &Servos,
        rest: Vector2<f64>,
    ) -> Self {
        Self::of_points(
            model,
            timed(std::slice::from_ref(table), servos, rest.into()),
        )
    }

    /// Joint angles at the end \[rad\].
    pub fn last_shape(&self) -> Vector2<f64> {
        self.points
            .last()
            .map_or_else(Vector2::zeros, |point| point.shape)
    }

    /// One cycle of a play that goes on, in steady state.
    pub fn of_cycle(
        model: &Model<f64>,
        table: &GaitTable,
        period_us: u32,
        servos: &Servos,
    ) -> Self {
        Self::of_points(model, steady_cycle(table, period_us, servos))
    }

    /// The first cycles of a play, one by one. The robot sets its servos 50 times a second: at a period that is no whole number of
    /// these ticks each cycle begins at another share of a tick, with other joint angles.
    pub fn of_first_cycles(
        model: &Model<f64>,
        table: &GaitTable,
        period_us: u32,
        servos: &Servos,
        cycles: u32,
    ) -> Vec<Self> {
        #[allow(clippy::cast_possible_truncation)] // a rate as the robot stores it
        let limits = Limits {
            max_rate: servos.file.max_rate as f32,
            ..Limits::ROBOT
        };
        let start = Ramp::soft(NEUTRAL, table.knot_angles(0), false, &limits);
        let start_s = f64::from(start.duration_us().div_ceil(TICK_US) * TICK_US) * 1e-6;
        let play = PlaylistTable {
            table: table.clone(),
            cycles,
            period_us,
            step: 0,
        };
        let points = timed(std::slice::from_ref(&play), servos, [0.0; 2]);
        let whole = Self {
            points: points
                .into_iter()
                .map(|point| Point {
                    time_s: point.time_s,
                    shape: point.angles.into(),
                    pose: Pose::identity(),
                })
                .collect(),
        };
        let period_s = f64::from(period_us) * 1e-6;
        let cycle = |number: u32| {
            let from = start_s + f64::from(number) * period_s;
            whole.section(model, from, from + period_s)
        };
        (0..cycles).map(cycle).collect()
    }

    /// The course from one time to another \[s\], in the frame of the middle link at its start.
    fn section(&self, model: &Model<f64>, from_s: f64, to_s: f64) -> Self {
        let first = self.points.partition_point(|point| point.time_s <= from_s);
        let last = self.points.partition_point(|point| point.time_s < to_s);
        let inner = self.points.get(first..last).unwrap_or_default();
        let inner = inner
            .iter()
            .map(|point| (point.time_s - from_s, point.shape));
        let start = std::iter::once((0.0, self.shape_at(from_s)));
        let end = std::iter::once((to_s - from_s, self.shape_at(to_s)));
        Self::of_shapes(model, start.chain(inner).chain(end))
    }

    fn of_points(model: &Model<f64>, points: Vec<PlayedPoint>) -> Self {
        let shapes = points
            .into_iter()
            .map(|point| (point.time_s, Vector2::from(point.angles)));
        Self::of_shapes(model, shapes)
    }

    /// Joint angles \[rad\] at increasing times \[s\]; between two of them both angles change evenly.
    pub fn of_shapes(
        model: &Model<f64>,
        shapes: impl IntoIterator<Item = (f64, Vector2<f64>)>,
    ) -> Self {
        let mut points: Vec<Point> = Vec::new();
        for (time_s, shape) in shapes {
            let pose = points.last().map_or_else(Pose::identity, |last| {
                moved(model, &last.pose, last.shape, shape)
            });
            points.push(Point {
                time_s,
                shape,
                pose,
            });
        }
        Self { points }
    }

    /// The course of other joint angles at the same times.
    #[must_use]
    pub fn with_shapes(
        &self,
        model: &Model<f64>,
        of: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> Self {
        let shapes = self
            .points
            .iter()
            .map(|point| (point.time_s, of(point.shape)));
        Self::of_shapes(model, shapes)
    }

    /// The same course run through in another time \[s\].
    #[must_use]
    pub fn within(&self, duration_s: f64) -> Self {
        let stretch = duration_s / self.duration_s().max(f64::MIN_POSITIVE);
        let points = self.points.iter().map(|point| Point {
            time_s: point.time_s * stretch,
            ..*point
        });
        Self {
            points: points.collect(),
        }
    }

    /// Time from the first set-point to the last \[s\].
    pub fn duration_s(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.time_s)
    }

    /// Pose at the end.
    pub fn net(&self) -> Pose<f64> {
        self.points
            .last()
            .map_or_else(Pose::identity, |point| point.pose)
    }

    /// Pose at a time from the start; before it the first, after the end the last.
    pub fn at(&self, time_s: f64) -> Pose<f64> {
        let (from, to, share) = self.around(time_s);
        let between =
            |of: fn(&Pose<f64>) -> f64| of(&from.pose) + share * (of(&to.pose) - of(&from.pose));
        Pose::new(
            between(|pose| pose.x),
            between(|pose| pose.y),
            between(|pose| pose.theta),
        )
    }

    /// Joint angles at a time from the start \[rad\].
    pub fn shape_at(&self, time_s: f64) -> Vector2<f64> {
        let (from, to, share) = self.around(time_s);
        from.shape + (to.shape - from.shape) * share
    }

    fn around(&self, time_s: f64) -> (Point, Point, f64) {
        let rest = Point {
            time_s: 0.0,
            shape: Vector2::zeros(),
            pose: Pose::identity(),
        };
        let after = self.points.partition_point(|point| point.time_s <= time_s);
        let point = |index: usize| self.points.get(index).copied();
        let last = self.points.last().copied().unwrap_or(rest);
        let to = point(after).unwrap_or(last);
        let from = after.checked_sub(1).and_then(point).unwrap_or(to);
        let length = to.time_s - from.time_s;
        let share = if length > 0.0 {
            (time_s - from.time_s) / length
        } else {
            0.0
        };
        (from, to, share)
    }

    /// Root mean square of the motion about the straight line from start to end: position \[m\] and heading \[rad\].
    pub(crate) fn oscillation(&self) -> [f64; 2] {
        let (net, duration) = (self.net(), self.duration_s().max(f64::MIN_POSITIVE));
        let (mut position, mut heading) = (0.0, 0.0);
        for point in &self.points {
            let share = point.time_s / duration;
            position += (point.pose.position() - net.position() * share).norm_squared();
            heading += (point.pose.theta - net.theta * share).powi(2);
        }
        let count = self.points.len().max(1) as f64;
        [(position / count).sqrt(), (heading / count).sqrt()]
    }

    /// Smallest distance \[m\] of any part of the body to a wall at a time, with the middle link at `pose` in the tank's frame.
    pub(crate) fn distance_to_wall(
        &self,
        model: &Model<f64>,
        tank: &Tank,
        pose: &Pose<f64>,
        time_s: f64,
    ) -> f64 {
        distance_to_wall(model, tank, pose, &self.shape_at(time_s))
    }
}

/// Smallest distance \[m\] of any part of a body of these joint angles to a wall, with the middle link at `pose` in the tank's frame.
pub(crate) fn distance_to_wall(
    model: &Model<f64>,
    tank: &Tank,
    pose: &Pose<f64>,
    shape: &Vector2<f64>,
) -> f64 {
    let swimmer = model.swimmer();
    let free = |point: Vector2<f64>, radius: f64| {
        let along = 0.5 * tank.length - point.x.abs();
        along.min(0.5 * tank.width - point.y.abs()) - radius
    };
    let outline = swimmer.links.outline(shape);
    let links = outline.map(|end| free(pose.transform(&end), 0.0));
    let sphere = free(pose.position(), swimmer.sphere_radius);
    links.into_iter().fold(sphere, f64::min)
}

/// The pose after the joints have moved on a straight line: midpoint steps on SE(2).
fn moved(model: &Model<f64>, pose: &Pose<f64>, from: Vector2<f64>, to: Vector2<f64>) -> Pose<f64> {
    let way = to - from;
    let pieces = (way.norm() / LONGEST_PIECE).ceil();
    if !(pieces >= 1.0 && pieces.is_finite()) {
        return *pose;
    }
    let step = way / pieces;
    let (mut pose, mut piece) = (*pose, 0.0);
    while piece < pieces {
        let middle = from + step * (piece + 0.5);
        pose = pose * Pose::exp(&(model.local_connection(&middle) * step));
        piece += 1.0;
    }
    pose
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::{Circle, Gait, Swimmer, Tolerance, swim};

    #[test]
    fn a_circle_leads_where_the_model_swims() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let circle = Circle { amplitude: 1.2 };
        let shapes = (0..=2000).map(|i| {
            let u = f64::from(i) / 2000.0;
            (4.0 * u, circle.at(u).phi)
        });
        let course = Course::of_shapes(&model, shapes);
        let stroke = swim(&model, &circle, &Tolerance::default());
        let off = course.net().position() - stroke.displacement;
        assert!(off.norm() < 1e-5 * stroke.displacement.norm(), "{off}");
        assert!((course.duration_s() - 4.0).abs() < 1e-12);
        let quarter = course.within(2.0);
        assert_eq!(quarter.at(0.5), course.at(1.0));
    }
}
