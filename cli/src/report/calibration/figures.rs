//! The charts of a calibration's report, each from the numbers it shows.

use calibrate::evidence::{Evidence, Profile};
use calibrate::{Cycle, PoseSample, RunResult};
use plotters::style::RGBColor;

use crate::failure::Outcome;
use crate::report::chart::{
    BOUND, Chart, INK, MEASURED, MEASURED_BAND, PREDICTED, Point, SINGULAR, SLENDER, Series,
};

const SQUARE: (i32, i32) = (520, 430);
const LOW: (i32, i32) = (520, 240);
const SMALL: (i32, i32) = (360, 250);
/// More points than a column has pixels show nothing more.
const MOST_POINTS: usize = 800;
/// Points that are drawn of each cycle, and of their mean.
const CYCLE_POINTS: usize = 100;

fn chart(labels: [&str; 2], size: (i32, i32), series: Vec<Series>) -> Chart {
    Chart {
        x_label: labels[0].into(),
        y_label: labels[1].into(),
        size,
        equal_axes: false,
        legend: Vec::new(),
        title: String::new(),
        series,
    }
}

/// Colours of exchanged names, and of points that are not reflectors.
const SWAP: RGBColor = RGBColor(0xc0, 0x39, 0x6b);
const GHOST: RGBColor = RGBColor(0xe0, 0xb0, 0x30);

/// Places \[mm\] of the samples that a predicate selects, at most [`MOST_POINTS`] of them, evenly spread.
fn places(samples: &[PoseSample], is_selected: impl Fn(&PoseSample) -> bool) -> Vec<Point> {
    let selected: Vec<Point> = samples
        .iter()
        .filter(|sample| is_selected(sample))
        .map(place)
        .collect();
    let every = selected.len().div_ceil(MOST_POINTS).max(1);
    selected.into_iter().step_by(every).collect()
}

/// Place of a sample \[mm\].
fn place(sample: &PoseSample) -> Point {
    (sample.pose.x * 1e3, sample.pose.y * 1e3)
}

/// Path of the link's centre, with its filled gaps, and the places where names were exchanged or ghosts appeared.
pub(super) fn track(run: &RunResult) -> Outcome<String> {
    let samples = &run.poses.samples;
    let jumps = run.poses.jumps.iter().filter_map(|jump| {
        let after = samples.iter().find(|sample| sample.time_s >= jump.after_s);
        after.map(place)
    });
    let within = |stretches: &[calibrate::Stretch]| -> Vec<Point> {
        let during = |time: f64| {
            let next = stretches.partition_point(|stretch| stretch.until_s < time);
            stretches.get(next).is_some_and(|s| s.from_s <= time)
        };
        places(samples, |sample| during(sample.time_s))
    };
    let report = &run.poses.report;
    let starts = run.cycles.cycles.iter().map(|cycle| {
        let pose = cycle.at(0.0);
        (pose.x * 1e3, pose.y * 1e3)
    });
    Chart {
        equal_axes: true,
        ..chart(
            ["x [mm]", "y [mm]"],
            SMALL,
            vec![
                Series::Line {
                    points: places(samples, |_| true),
                    color: MEASURED_BAND,
                    width: 1.2,
                },
                Series::Dots {
                    points: within(&report.ghosts),
                    color: GHOST,
                    radius: 1.8,
                },
                Series::Dots {
                    points: within(&report.swaps),
                    color: SWAP,
                    radius: 1.8,
                },
                Series::Dots {
                    points: places(samples, PoseSample::is_filled),
                    color: PREDICTED,
                    radius: 1.0,
                },
                Series::Dots {
                    points: starts.collect(),
                    color: INK,
                    radius: 2.6,
                },
                Series::Dots {
                    points: jumps.collect(),
                    color: BOUND,
                    radius: 4.0,
                },
            ],
        )
    }
    .svg()
}

/// Coordinate of a cycle.
#[derive(Clone, Copy)]
pub(super) enum Coordinate {
    /// Across the first heading.
    Y,
    /// The heading.
    Theta,
}

/// All cycles of a run over one another in the frame of their first pose, and the mean of their harmonic curves.
pub(super) fn cycles(run: &RunResult, coordinate: Coordinate) -> Outcome<String> {
    let cycles = &run.cycles.cycles;
    let period = run.cycles.period_s;
    let in_frame = |cycle: &Cycle, pose: &swimmer_model::Pose<f64>| {
        let local = cycle.at(0.0).inverse() * *pose;
        match coordinate {
            Coordinate::Y => local.y * 1e3,
            Coordinate::Theta => local.theta.to_degrees(),
        }
    };
    let mut series = Vec::new();
    for cycle in cycles {
        let within = |s: &&calibrate::PoseSample| {
            s.time_s >= cycle.start_s && s.time_s < cycle.start_s + period
        };
        let samples: Vec<_> = run.poses.seen().filter(within).collect();
        let every = samples.len().div_ceil(CYCLE_POINTS).max(1);
        let point = |s: &&calibrate::PoseSample| {
            (
                (s.time_s - cycle.start_s) / period,
                in_frame(cycle, &s.pose),
            )
        };
        series.push(Series::Line {
            points: samples.iter().step_by(every).map(point).collect(),
            color: MEASURED_BAND,
            width: 1.0,
        });
    }
    let mean = (0..=CYCLE_POINTS).map(|i| {
        let u = i as f64 / CYCLE_POINTS as f64;
        let sum: f64 = cycles
            .iter()
            .map(|cycle| in_frame(cycle, &cycle.at(u)))
            .sum();
        (u, sum / cycles.len().max(1) as f64)
    });
    series.push(Series::Line {
        points: mean.collect(),
        color: INK,
        width: 1.5,
    });
    let label = match coordinate {
        Coordinate::Y => "y [mm]",
        Coordinate::Theta => "θ [°]",
    };
    chart(["fraction of the cycle", label], SMALL, series).svg()
}

/// `r_s` and χ with systematics, next to the statistical intervals, as bars: (estimate, low, high) each.
pub(super) fn bars(rows: &[(&str, [f64; 3])], label: &str) -> Outcome<String> {
    let mut series = Vec::new();
    let names: Vec<String> = rows.iter().map(|(name, _)| (*name).to_owned()).collect();
    for (place, (_, [value, low, high])) in rows.iter().enumerate() {
        let at = place as f64 + 1.0;
        let color = if place + 1 == rows.len() {
            PREDICTED
        } else {
            MEASURED
        };
        series.push(Series::Line {
            points: vec![(at, *low), (at, *high)],
            color,
            width: 3.0,
        });
        series.push(Series::Dots {
            points: vec![(at, *value)],
            color,
            radius: 4.5,
        });
    }
    let count = rows.len() as f64;
    series.push(Series::Line {
        points: rows.first().map_or_else(Vec::new, |(_, [value, ..])| {
            vec![(0.5, *value), (count + 0.5, *value)]
        }),
        color: SINGULAR,
        width: 1.0,
    });
    series.push(Series::Names(names));
    chart(["", label], LOW, series).svg()
}

/// The ridge: joint regions, draws of the bootstrap, both estimates.
pub(super) fn ridge(evidence: &Evidence, paper: (f64, f64)) -> Outcome<String> {
    let point = |(radius, chi): (f64, f64)| (radius * 1e3, chi);
    let draws = evidence
        .bootstrap
        .as_ref()
        .map_or(&[][..], |bootstrap| &bootstrap.points);
    let every = draws.len().div_ceil(400).max(1);
    let mut series = vec![Series::Dots {
        points: draws
            .iter()
            .step_by(every)
            .map(|p| point((p.sphere_radius, p.chi)))
            .collect(),
        color: SINGULAR,
        radius: 1.3,
    }];
    for contour in &evidence.ridge.contours {
        let closed = contour.corners.iter().chain(contour.corners.first());
        let points: Vec<Point> = closed.map(|corner| point(*corner)).collect();
        let top = points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
        series.push(Series::Line {
            points,
            color: MEASURED,
            width: 1.4,
        });
        if let Some(at) = top {
            series.push(Series::Word {
                at,
                text: format!("{:.0} %", contour.level * 100.0),
                color: MEASURED,
            });
        }
    }
    let likelihood = evidence.likelihood.estimate;
    let dot = |at: (f64, f64), color: RGBColor| Series::Dots {
        points: vec![point(at)],
        color,
        radius: 4.5,
    };
    series.push(dot((likelihood.sphere_radius, likelihood.chi), PREDICTED));
    series.push(dot(paper, INK));
    chart(["sphere radius r_s [mm]", "drag ratio χ"], SQUARE, series).svg()
}

/// Both fits without each run, by its name.
pub(super) fn without_run(
    evidence: &Evidence,
    paper: (f64, f64),
    names: &[String],
) -> Outcome<String> {
    let mut series = Vec::new();
    for without in &evidence.without_run {
        let at = (without.paper.sphere_radius * 1e3, without.paper.chi);
        if let Some(other) = without.likelihood {
            series.push(Series::Dots {
                points: vec![(other.sphere_radius * 1e3, other.chi)],
                color: PREDICTED,
                radius: 3.0,
            });
        }
        series.push(Series::Dots {
            points: vec![at],
            color: MEASURED,
            radius: 3.0,
        });
        series.push(Series::Word {
            at,
            text: names.get(without.run).cloned().unwrap_or_default(),
            color: MEASURED,
        });
    }
    series.push(Series::Dots {
        points: vec![(paper.0 * 1e3, paper.1)],
        color: INK,
        radius: 4.5,
    });
    chart(["sphere radius r_s [mm]", "drag ratio χ"], SQUARE, series).svg()
}

/// A profile likelihood with the threshold of its interval; `unit` turns the parameter into the axis' unit.
pub(super) fn profile(profile: &Profile, label: &str, unit: f64) -> Outcome<String> {
    let points: Vec<Point> = profile.points.iter().map(|(p, l)| (p * unit, *l)).collect();
    let ends = points
        .iter()
        .fold(None, |ends: Option<(f64, f64)>, (x, _)| {
            Some(ends.map_or((*x, *x), |(low, high)| (low.min(*x), high.max(*x))))
        });
    let mut series = vec![Series::Line {
        points,
        color: INK,
        width: 1.7,
    }];
    if let Some((low, high)) = ends {
        series.push(Series::Dashes {
            points: vec![(low, profile.threshold), (high, profile.threshold)],
            color: BOUND,
            width: 1.4,
        });
        let inside = profile.interval.map(|end| (end * unit, profile.threshold));
        series.push(Series::Dots {
            points: inside.to_vec(),
            color: PREDICTED,
            radius: 3.2,
        });
    }
    chart([label, "log-likelihood ratio"], LOW, series).svg()
}

/// Residuals of each run over their standard errors, by the run's name.
pub(super) fn residuals(evidence: &Evidence, names: &[String]) -> Outcome<String> {
    let count = evidence.run_errors.len() as f64;
    let band = |at: f64| Series::Dashes {
        points: vec![(0.5, at), (count + 0.5, at)],
        color: BOUND,
        width: 1.2,
    };
    let mut series = vec![
        band(2.0),
        band(-2.0),
        Series::Line {
            points: vec![(0.5, 0.0), (count + 0.5, 0.0)],
            color: SINGULAR,
            width: 1.0,
        },
    ];
    for (quantity, (color, aside)) in [(MEASURED, -0.12), (SLENDER, 0.0), (PREDICTED, 0.12)]
        .into_iter()
        .enumerate()
    {
        let points = evidence
            .run_errors
            .iter()
            .enumerate()
            .filter_map(|(run, errors)| {
                let error = errors.get(quantity)?;
                let point = (run as f64 + 1.0 + aside, error.standardised);
                point.1.is_finite().then_some(point)
            });
        series.push(Series::Dots {
            points: points.collect(),
            color,
            radius: 3.6,
        });
    }
    series.push(Series::Names(names.to_vec()));
    chart(["", "residual / standard error"], LOW, series).svg()
}

#[cfg(test)]
mod tests {
    use calibrate::Origin;
    use swimmer_model::Pose;

    use super::*;

    #[test]
    fn filled_places_are_thinned() {
        let sample = |i: u32| PoseSample {
            time_s: f64::from(i) * 0.01,
            pose: Pose::new(f64::from(i) * 1e-3, 0.0, 0.0),
            origin: if i.is_multiple_of(2) {
                Origin::Filled
            } else {
                Origin::Seen
            },
        };
        let samples: Vec<PoseSample> = (0..20_000).map(sample).collect();
        let filled = places(&samples, PoseSample::is_filled);
        assert!(filled.len() <= MOST_POINTS && filled.len() > MOST_POINTS / 2);
        // To both ends, and filled samples only.
        assert!(filled.first().unwrap().0 < 1.0 && filled.last().unwrap().0 > 19_900.0);
        assert!(filled.iter().all(|(x, _)| x.round() % 2.0 == 0.0));
        // A few are all kept.
        assert_eq!(places(&samples[..10], PoseSample::is_filled).len(), 5);
    }
}
