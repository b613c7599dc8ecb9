//! The experiment's figure: a circle over a few cycles, by both models of the robot.

use swimmer_files::AnyGait;
use swimmer_model::{Model, Pose, Tolerance, TrajectoryPoint, trajectory};

use super::{Figure, LOW, WIDE};
use crate::report::chart::{INK, Point, SLENDER};
use validation::Study;

/// The experiment of the paper's figure: amplitude, period in seconds, cycles drawn.
const EXPERIMENT: (f64, f64, u32) = (70.0, 30.0, 5);

/// The 70° circle over a few cycles: y over x, and x, y, θ over time.
pub(super) fn experiment(study: &Study) -> Vec<Figure> {
    const CAPTION: &str = "70° circle, period 30 s: <i style='color:#1d242c'></i>fitted robot <i style='color:#3a9d5d'></i>slender links";
    let both = [
        (&study.robot, "fitted", INK),
        (&study.slender, "slender", SLENDER),
    ];
    let drawn = |mut figure: Figure, point: fn(f64, &Pose<f64>) -> Point| {
        for (model, name, color) in both {
            let points = swum(model)
                .iter()
                .map(|(time, pose)| point(*time, pose))
                .collect();
            figure = figure.line(name, color, points);
        }
        figure
    };
    vec![
        drawn(
            Figure::new(
                "circle70-track",
                "Track of the 70° circle",
                CAPTION,
                ["x [mm]", "y [mm]"],
                WIDE,
            ),
            |_, pose| (pose.x * 1e3, pose.y * 1e3),
        ),
        drawn(
            Figure::new(
                "circle70-x",
                "x of the 70° circle",
                CAPTION,
                ["time [s]", "x [mm]"],
                LOW,
            ),
            |time, pose| (time, pose.x * 1e3),
        ),
        drawn(
            Figure::new(
                "circle70-y",
                "y of the 70° circle",
                CAPTION,
                ["time [s]", "y [mm]"],
                LOW,
            ),
            |time, pose| (time, pose.y * 1e3),
        ),
        drawn(
            Figure::new(
                "circle70-theta",
                "θ of the 70° circle",
                CAPTION,
                ["time [s]", "θ [°]"],
                LOW,
            ),
            |time, pose| (time, pose.theta.to_degrees()),
        ),
    ]
}

/// Time and pose along a few cycles.
fn swum(model: &Model<f64>) -> Vec<(f64, Pose<f64>)> {
    let (amplitude, period, cycles) = EXPERIMENT;
    let gait = AnyGait::circle(amplitude.to_radians());
    let mut cycle: Vec<(f64, Pose<f64>)> = Vec::new();
    let mut keep = |point: TrajectoryPoint<f64>| cycle.push((point.u, point.pose));
    trajectory(model, &gait, &Tolerance::default(), 120, &mut keep);
    let mut start = Pose::identity();
    let mut path = Vec::new();
    for number in 0..cycles {
        path.extend(
            cycle
                .iter()
                .map(|(u, pose)| ((f64::from(number) + u) * period, start * *pose)),
        );
        start = path.last().map_or(start, |(_, pose)| *pose);
    }
    path
}
