//! The charts of the report, each from the numbers it shows.

use super::chart::{
    BOUND, Chart, INK, MEASURED, MEASURED_BAND, PREDICTED, Point, SINGULAR, SLENDER, Series,
};
use super::{GaitPicture, MeasuredCircle, ModelCircle, Report, Track};
use crate::failure::Outcome;

const WIDE: (i32, i32) = (520, 404);
const LOW: (i32, i32) = (520, 200);
/// More points than a column has pixels show nothing more.
const MOST_POINTS: usize = 1200;

/// X over the amplitude: measured, fitted, and by the model that the fit started from.
pub(super) fn displacement(
    measured: &[MeasuredCircle],
    fitted: &[ModelCircle],
    start: &[ModelCircle],
) -> Outcome<String> {
    over_amplitude(
        [fitted, start],
        measured,
        "X [mm per cycle]",
        WIDE,
        |circle| circle.x,
        |circle| circle.x,
        1e3,
    )
}

/// ΔY over the amplitude.
pub(super) fn delta_y(
    measured: &[MeasuredCircle],
    fitted: &[ModelCircle],
    start: &[ModelCircle],
) -> Outcome<String> {
    over_amplitude(
        [fitted, start],
        measured,
        "ΔY [mm]",
        LOW,
        |circle| circle.delta_y,
        |circle| circle.delta_y,
        1e3,
    )
}

/// Δθ over the amplitude.
pub(super) fn delta_theta(
    measured: &[MeasuredCircle],
    fitted: &[ModelCircle],
    start: &[ModelCircle],
) -> Outcome<String> {
    let degrees = 1_f64.to_degrees();
    over_amplitude(
        [fitted, start],
        measured,
        "Δθ [°]",
        LOW,
        |circle| circle.delta_theta,
        |circle| circle.delta_theta,
        degrees,
    )
}

fn over_amplitude(
    [fitted, start]: [&[ModelCircle]; 2],
    circles: &[MeasuredCircle],
    y_label: &str,
    size: (i32, i32),
    measured: impl Fn(&MeasuredCircle) -> (f64, f64),
    model: impl Fn(&ModelCircle) -> f64,
    unit: f64,
) -> Outcome<String> {
    let curve = |circles: &[ModelCircle]| -> Vec<Point> {
        circles
            .iter()
            .map(|circle| (circle.amplitude.to_degrees(), model(circle) * unit))
            .collect()
    };
    // Reported results may lack one.
    let there = circles
        .iter()
        .filter(|circle| measured(circle).0.is_finite());
    let bars = there.map(|circle| {
        let (mean, deviation) = measured(circle);
        (circle.amplitude.to_degrees(), mean * unit, deviation * unit)
    });
    Chart {
        x_label: "amplitude ε [°]".into(),
        y_label: y_label.into(),
        size,
        equal_axes: false,
        legend: Vec::new(),
        title: String::new(),
        series: vec![
            Series::Line {
                points: curve(start),
                color: SLENDER,
                width: 1.6,
            },
            Series::Line {
                points: curve(fitted),
                color: INK,
                width: 1.8,
            },
            Series::Bars {
                points: bars.collect(),
                color: MEASURED,
            },
        ],
    }
    .svg()
}

/// The track in the plane of the tank.
pub(super) fn track(track: &Track) -> Outcome<String> {
    Chart {
        x_label: "x [mm]".into(),
        y_label: "y [mm]".into(),
        size: WIDE,
        equal_axes: true,
        legend: Vec::new(),
        title: String::new(),
        series: vec![Series::Line {
            points: thinned(track, |[_, x, y, _]| (x * 1e3, y * 1e3)),
            color: MEASURED,
            width: 1.3,
        }],
    }
    .svg()
}

/// x over time.
pub(super) fn x_over_time(track: &Track) -> Outcome<String> {
    over_time(
        "x [mm]",
        vec![Series::Line {
            points: thinned(track, |[t, x, ..]| (t, x * 1e3)),
            color: MEASURED,
            width: 1.4,
        }],
    )
}

/// The heading over time.
pub(super) fn heading_over_time(track: &Track) -> Outcome<String> {
    over_time(
        "θ [°]",
        vec![Series::Line {
            points: thinned(track, |[t, _, _, theta]| (t, theta.to_degrees())),
            color: MEASURED,
            width: 1.4,
        }],
    )
}

/// x over time for the optimised gait: tracked, and as predicted.
pub(super) fn prediction(report: &Report) -> Outcome<String> {
    let line = |track: &Track| thinned(track, |[t, x, ..]| (t, x * 1e3));
    Chart {
        x_label: "time [s]".into(),
        y_label: "x [mm]".into(),
        size: (520, 290),
        equal_axes: false,
        legend: Vec::new(),
        title: String::new(),
        series: vec![
            Series::Line {
                points: line(&report.swum),
                color: MEASURED_BAND,
                width: 4.5,
            },
            Series::Line {
                points: line(&report.predicted),
                color: PREDICTED,
                width: 1.3,
            },
        ],
    }
    .svg()
}

fn over_time(y_label: &str, series: Vec<Series>) -> Outcome<String> {
    Chart {
        x_label: "time [s]".into(),
        y_label: y_label.into(),
        size: LOW,
        equal_axes: false,
        legend: Vec::new(),
        title: String::new(),
        series,
    }
    .svg()
}

/// The gait in the plane of the joint angles: arcs, true joint angles, uploaded set-points, the bound.
pub(super) fn gait(gait: &GaitPicture) -> Outcome<String> {
    let degrees = |shape: &[f64; 2]| (shape[0].to_degrees(), shape[1].to_degrees());
    let bound = gait.bound.to_degrees();
    let corners = [
        (bound, bound),
        (-bound, bound),
        (-bound, -bound),
        (bound, -bound),
        (bound, bound),
    ];
    let mut series = Vec::new();
    if bound > 0.0 {
        series.push(Series::Dashes {
            points: corners.into(),
            color: BOUND,
            width: 0.9,
        });
    }
    for (kind, shapes) in &gait.arcs {
        let color = if kind == "singular" { SINGULAR } else { BOUND };
        series.push(Series::Line {
            points: shapes.iter().map(degrees).collect(),
            color,
            width: 8.0,
        });
    }
    series.push(Series::Line {
        points: gait.played.iter().map(degrees).collect(),
        color: PREDICTED,
        width: 1.3,
    });
    series.push(Series::Arrows {
        points: gait.played.iter().map(degrees).collect(),
        color: PREDICTED,
    });
    series.push(Series::Dots {
        points: gait.set_points.iter().map(degrees).collect(),
        color: MEASURED,
        radius: 2.6,
    });
    if let Some(first) = gait.set_points.first() {
        series.push(Series::Word {
            at: degrees(first),
            text: "start".into(),
            color: INK,
        });
    }
    Chart {
        x_label: "φ₁ [°]".into(),
        y_label: "φ₂ [°]".into(),
        size: (520, 470),
        equal_axes: true,
        legend: Vec::new(),
        title: String::new(),
        series,
    }
    .svg()
}

fn thinned(track: &Track, point: impl Fn([f64; 4]) -> Point) -> Vec<Point> {
    let every = track.poses.len().div_ceil(MOST_POINTS).max(1);
    track
        .poses
        .iter()
        .step_by(every)
        .map(|pose| point(*pose))
        .collect()
}
