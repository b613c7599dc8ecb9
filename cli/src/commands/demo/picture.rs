//! Figures of the report from the results of a round.

use calibrate::{CycleError, RunResult, joint_path, predict};
use operations::calibrate::RunOutput;
use swimmer_files::{AnyGait, GaitSpec, SwimmerFile};
use swimmer_model::{Gait as _, Pose};
use twin::Tank;

use super::{BEST, BEST_TRACK, CAMPAIGN, FITTED, Finished, LAB, LINK_LOG, START};
use crate::failure::{Failure, Outcome};
use crate::report::swimming::{Moment, Swimming};
use crate::report::{GaitPicture, MeasuredCircle, ModelCircle, Parameter, Report, Track};

/// The curves over the amplitude, degrees.
const CURVE: std::ops::RangeInclusive<u32> = 20..=120;
const CURVE_STEP: usize = 2;
/// The circle whose track is shown, degrees: the paper's example.
const SHOWN: f64 = 70.0;
/// One in this number of the 512 uploaded knots is drawn.
const KNOTS_DRAWN: u32 = 64;
/// Points of an arc that are drawn.
const ARC_POINTS: u32 = 120;
/// Instants of a cycle at which the swimmer is known to its picture.
const MOMENTS: usize = 240;
/// Poses within this of a cycle's start give the frame in which the track is drawn, s.
const START_WINDOW_S: f64 = 0.5;

/// Gathers the report.
///
/// # Errors
/// [`Failure::Tried`] when a model cannot swim what it is shown with.
pub(super) fn report(round: &Finished, lab: Option<String>) -> Outcome<Report> {
    let [radius, chi] = [round.fit.output.sphere_radius_m, round.fit.output.chi];
    let intervals = &round.fit.output.intervals;
    let parameters = vec![
        Parameter {
            name: "r_s".into(),
            unit: " mm",
            start: round.start.swimmer.sphere_radius * 1e3,
            fitted: radius * 1e3,
            interval: intervals.sphere_radius.map(|metres| metres * 1e3),
            truth: round.truth.swimmer.sphere_radius * 1e3,
        },
        Parameter {
            name: "χ".into(),
            unit: "",
            start: round.start.swimmer.chi,
            fitted: chi,
            interval: intervals.chi,
            truth: round.truth.swimmer.chi,
        },
    ];
    let (shown, shown_gait) = shown_run(round)?;
    let swum = track("tracked".into(), &round.swum.result)?;
    Ok(Report {
        swimmer: round.truth.name.clone(),
        seed: round.seed,
        period_s: round.period_s,
        parameters,
        level: intervals.level,
        rmse: round.fit.output.rmse,
        c_t_form: round.fit.output.c_t_form.clone(),
        circles: measured(round),
        fitted_curve: curve(round, &round.fitted)?,
        start_curve: curve(round, &round.start)?,
        track: track(shown_gait.readable(), shown)?,
        gait: gait(round)?,
        swimming: swimming(round, &swum)?,
        swum,
        predicted: predicted(round)?,
        displacement_predicted_m: round.predicted.x_m,
        fastest: (
            round.race.fastest.speed_tracked_m_per_s,
            round.race.times_as_fast,
        ),
        displacement_tracked_m: (round.swum.output.x_m, round.swum.output.x_sd_m),
        bounds: round.bounds,
        files: files(lab.is_some()),
        lab,
    })
}

fn measured(round: &Finished) -> Vec<MeasuredCircle> {
    let circle = |(gait, run): (&GaitSpec, &RunOutput)| match gait {
        GaitSpec::Circle { amplitude, .. } => Some(MeasuredCircle {
            amplitude: *amplitude,
            cycles: run.cycles.unwrap_or(0),
            x: (run.x_m, run.x_sd_m),
            delta_y: (run.delta_y_m, run.delta_y_sd_m),
            delta_theta: (run.delta_theta_rad, run.delta_theta_sd_rad),
        }),
        _ => None,
    };
    let gaits = round.fit.campaign.runs.iter().map(|run| &run.gait);
    gaits
        .zip(&round.fit.output.runs)
        .filter_map(circle)
        .collect()
}

/// Circles as a model with the same servos swims them.
fn curve(round: &Finished, model: &SwimmerFile) -> Outcome<Vec<ModelCircle>> {
    let largest = model.servo.map_or(f64::INFINITY, |servo| servo.max_angle);
    CURVE
        .step_by(CURVE_STEP)
        .map(|degrees| f64::from(degrees).to_radians())
        .filter(|amplitude| *amplitude <= largest)
        .map(|amplitude| {
            let circle = predict(model, &AnyGait::circle(amplitude), round.period_s)
                .map_err(|error| Failure::tried(&error))?;
            Ok(ModelCircle {
                amplitude,
                x: circle.x_m,
                delta_y: circle.delta_y_m,
                delta_theta: circle.delta_theta_rad,
            })
        })
        .collect()
}

/// The run of the paper's example, or the one nearest to it.
fn shown_run(round: &Finished) -> Outcome<(&RunResult, &GaitSpec)> {
    let distance = |gait: &GaitSpec| match gait {
        GaitSpec::Circle { amplitude, .. } => (amplitude.to_degrees() - SHOWN).abs(),
        _ => f64::INFINITY,
    };
    let gaits = round.fit.campaign.runs.iter().map(|run| &run.gait);
    round
        .fit
        .result
        .runs
        .iter()
        .zip(gaits)
        .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| Failure::Tried("the campaign has no runs to show".into()))
}

/// The cycles that count, in the frame of the first one's start: x along the heading at the symmetric shape.
fn track(label: String, run: &RunResult) -> Outcome<Track> {
    let cycles = &run.cycles.cycles;
    let (Some(first), Some(last)) = (cycles.first(), cycles.last()) else {
        return Err(Failure::tried(&CycleError::NoMotion));
    };
    let near: Vec<&Pose<f64>> = run
        .poses
        .seen()
        .filter(|sample| (sample.time_s - first.start_s).abs() < START_WINDOW_S)
        .map(|sample| &sample.pose)
        .collect();
    // Noise of a single frame would turn the whole track.
    let count = near.len().max(1) as f64;
    let mean =
        |value: fn(&Pose<f64>) -> f64| near.iter().map(|pose| value(pose)).sum::<f64>() / count;
    let origin = Pose::new(
        mean(|pose| pose.x),
        mean(|pose| pose.y),
        mean(|pose| pose.theta),
    )
    .inverse();
    let end_s = last.start_s + run.cycles.period_s;
    let poses = run
        .poses
        .samples
        .iter()
        .filter(|sample| sample.time_s >= first.start_s && sample.time_s <= end_s)
        .map(|sample| {
            let pose = origin * sample.pose;
            [sample.time_s - first.start_s, pose.x, pose.y, pose.theta]
        })
        .collect();
    Ok(Track { label, poses })
}

/// The fitted model along the path that its servos really take, for as many cycles as were tracked.
fn predicted(round: &Finished) -> Outcome<Track> {
    let path = joint_path(
        &round.best_gait,
        round.fitted.servo.as_ref(),
        round.period_s,
    )
    .map_err(|error| Failure::tried(&error))?;
    let mut tank = Tank::new(&round.fitted.swimmer, Pose::identity())
        .map_err(|error| Failure::tried(&error))?;
    let place = |angles: &[f64; 2]| (*angles).into();
    if let Some((_, first)) = path.first() {
        tank.move_joints(place(first));
    }
    let origin = tank.pose().inverse();
    let mut poses = Vec::new();
    for cycle in 0..round.swum.output.cycles.unwrap_or(0) {
        for (u, angles) in &path {
            tank.move_joints(place(angles));
            let pose = origin * tank.pose();
            let time = (cycle as f64 + u) * round.period_s;
            poses.push([time, pose.x, pose.y, pose.theta]);
        }
    }
    Ok(Track {
        label: "predicted".into(),
        poses,
    })
}

/// The tracked poses, each with the shape that the servos had then.
fn swimming(round: &Finished, swum: &Track) -> Outcome<Swimming> {
    let path = joint_path(
        &round.best_gait,
        round.fitted.servo.as_ref(),
        round.period_s,
    )
    .map_err(|error| Failure::tried(&error))?;
    let cycles = round.swum.output.cycles.unwrap_or(0).max(1);
    let moment = |place: usize| {
        let cycle_u = place as f64 / MOMENTS as f64;
        let u = cycle_u - cycle_u.floor();
        let after = path.partition_point(|(at, _)| *at < u);
        let (_, phi) = path.get(after).or_else(|| path.first())?;
        let time_s = cycle_u * round.period_s;
        let after = swum.poses.partition_point(|[at, ..]| *at < time_s);
        let [_, x, y, theta] = swum.poses.get(after).or_else(|| swum.poses.last())?;
        Some(Moment {
            phi: *phi,
            pose: Pose::new(*x, *y, *theta),
        })
    };
    Ok(Swimming {
        title: String::new(),
        links: round.fitted.swimmer.links,
        sphere_radius: round.fitted.swimmer.sphere_radius,
        sphere_on: round.fitted.swimmer.sphere_on,
        cycles: u32::try_from(cycles).unwrap_or(1),
        moments: (0..=cycles * MOMENTS).filter_map(moment).collect(),
    })
}

fn gait(round: &Finished) -> Outcome<GaitPicture> {
    let at = |u: f64| -> [f64; 2] { round.best_gait.at(u).phi.into() };
    let arc = |arc: &gait_optimizer::GaitArc| {
        let points = (0..=ARC_POINTS).map(|point| {
            let u = arc.from + (arc.to - arc.from) * f64::from(point) / f64::from(ARC_POINTS);
            at(u.clamp(0.0, 1.0 - 1e-12))
        });
        (arc.kind.word().to_owned(), points.collect())
    };
    let played = joint_path(
        &round.best_gait,
        round.fitted.servo.as_ref(),
        round.period_s,
    )
    .map_err(|error| Failure::tried(&error))?;
    Ok(GaitPicture {
        arcs: round.best.cycle_arcs().iter().map(arc).collect(),
        set_points: (0..KNOTS_DRAWN)
            .map(|knot| at(f64::from(knot) / f64::from(KNOTS_DRAWN)))
            .collect(),
        played: played.into_iter().map(|(_, angles)| angles).collect(),
        bound: round.bounds.0,
    })
}

fn files(with_lab: bool) -> Vec<(String, String)> {
    let lab = (LAB, "the lab page: height map, gaits to drag, the robot");
    let others = [
        (
            CAMPAIGN,
            "the circles; swimmer calibrate campaign.toml fits them again",
        ),
        ("circle-….csv", "track of each circle (Motive 1.23)"),
        (
            START,
            "the swimmer as the fit was given it: lengths, servos, no drag",
        ),
        (FITTED, "the swimmer with the fitted drag"),
        (BEST, "the optimised gait"),
        (BEST_TRACK, "its track"),
        (
            "fastest.gait, fastest.csv",
            "the gait made for speed, at the servos' full rate",
        ),
        (
            "farthest-at-full-rate.gait, farthest-at-full-rate.csv",
            "the optimised gait at that rate",
        ),
        (
            LINK_LOG,
            "every frame on the link, both ways (MCAP, for Foxglove)",
        ),
    ];
    let all = others.into_iter().chain(with_lab.then_some(lab));
    all.map(|(name, what)| (name.to_owned(), what.to_owned()))
        .collect()
}
