//! Poses and cycles from recordings with noise, drop-outs, exchanged labels and ghosts, against the truth that made them.

use crate::tank;

use std::fmt::Write;
use std::path::Path;

use calibrate::{
    CalibrateError, CycleError, CycleWarning, FrontRule, LeftOut, Origin, PoseError, PoseOptions,
    TrackOptions, calibrate_run, poses, read_tracks_with,
};
use nalgebra::Vector2;
use swimmer_files::{AnyGait, PointName};
use swimmer_model::{Model, Pose, Swimmer, Tolerance, swim};
use tank::{Tank, known};

fn robot(amplitude: f64) -> Tank {
    Tank::new(Swimmer::robot(), AnyGait::circle(amplitude))
}

fn file() -> swimmer_files::SwimmerFile {
    known(&Swimmer::robot(), None)
}

/// Largest position and heading error of poses that were seen or bridged.
fn errors(tank: &Tank, track: &calibrate::PoseTrack) -> (f64, f64) {
    let truth = tank.poses();
    let mut worst = (0.0_f64, 0.0_f64);
    for sample in &track.samples {
        let pose: &Pose<f64> = &truth[(sample.time_s * tank.rate_hz).round() as usize];
        let turn = (sample.pose.theta - pose.theta + 1.0).rem_euclid(std::f64::consts::TAU) - 1.0;
        worst = (
            worst
                .0
                .max((sample.pose.position() - pose.position()).norm()),
            worst.1.max(turn.abs()),
        );
    }
    worst
}

#[test]
fn poses_are_recovered_through_noise_ghosts_and_exchanged_labels() {
    let swaps = vec![(700, 40), (1500, 900), (4000, 3)];
    let gaps = vec![(900, 8), (2600, 25)];
    let tank = Tank {
        swaps,
        gaps,
        dropout: 0.02,
        ..robot(1.2)
    };
    let run = tank.run();
    let track = poses(&run.track, &tank.named(), &PoseOptions::default()).unwrap();
    let (place, heading) = errors(&tank, &track);
    // Five standard deviations: 0.3 mm each, heading √2 · 0.3/71.
    assert!(
        place < 5.0 * 3e-4 && heading < 5.0 * 6e-3,
        "{place} {heading}"
    );
    assert_eq!((track.report.swaps_repaired, track.report.segments), (3, 1));
    assert!(track.report.ghosts_rejected > 500 && track.front == FrontRule::Label);
    assert!(
        (track.report.distance_m - 0.071).abs() < 1e-4
            && (track.report.distance_sd_m / 4.2e-4 - 1.0).abs() < 0.1
    );
    assert!(track.warnings.is_empty(), "{:?}", track.warnings);
    assert_eq!(track.plane.map, "(x, y) = (Z, X), normal Y");
    // Short gaps are bridged and marked, the long one is not.
    let filled: Vec<f64> = track
        .samples
        .iter()
        .filter(|s| s.is_filled())
        .map(|s| s.time_s)
        .collect();
    let bridged = |from: f64, to: f64| {
        filled
            .iter()
            .filter(|t| **t > from - 0.005 && **t < to - 0.005)
            .count()
    };
    assert_eq!((bridged(9.0, 9.08), bridged(26.0, 26.25)), (8, 0));
    // Three samples on either side of two gaps at least are not trusted.
    let tails = track.with(Origin::Tail).count() + track.with(Origin::Smoothed).count();
    assert!((12..40).contains(&tails), "{tails}");
    assert_eq!(track.seen().count() + tails, track.report.followed);
}

/// Root mean square distance of filled poses from the truth, and that of straight lines between the same neighbours \[m\].
fn fill_errors(tank: &Tank, origin: Origin) -> (f64, f64, usize) {
    let track = poses(&tank.run().track, &tank.named(), &PoseOptions::default()).unwrap();
    let truth = tank.poses();
    let unfilled = PoseOptions {
        longest_fill_s: 0.0,
        ..PoseOptions::default()
    };
    let measured = poses(&tank.run().track, &tank.named(), &unfilled)
        .unwrap()
        .samples;
    let (mut cubic, mut straight, mut count) = (0.0, 0.0, 0);
    for sample in track.with(origin) {
        let pose = &truth[(sample.time_s * tank.rate_hz).round() as usize];
        let after = measured.partition_point(|s| s.time_s < sample.time_s);
        let (a, b) = (&measured[after - 1], &measured[after]);
        let share = (sample.time_s - a.time_s) / (b.time_s - a.time_s);
        let line = a.pose.position() + (b.pose.position() - a.pose.position()) * share;
        cubic += (sample.pose.position() - pose.position()).norm_squared();
        straight += (line - pose.position()).norm_squared();
        count += 1;
    }
    let rms = |sum: f64| (sum / count as f64).sqrt();
    (rms(cubic), rms(straight), count)
}

#[test]
fn a_cubic_through_means_fills_gaps_better_than_lines_do() {
    // Sixteen gaps of 0.1 s; a line joins the samples next to the gap, the cubic trusts them not.
    let tank = |noise, period_s, tails| Tank {
        noise,
        period_s,
        tails,
        gaps: (0..16).map(|i| (400 + 53 * i, 10)).collect(),
        dropout: 0.0,
        ghosts: false,
        ..robot(1.2)
    };
    for (noise, period_s, tails, most) in [
        (3e-4, 30.0, 0.0, 0.65),
        (3e-4, 10.0, 0.0, 0.65),
        (1e-3, 10.0, 0.0, 0.65),
        (1e-3, 2.0, 0.0, 0.8),
        (3e-4, 10.0, 2e-3, 0.15),
        // Without noise a line between untrusted samples is as good as it gets: both are well below a noise of 0.3 mm.
        (0.0, 10.0, 0.0, 1.5),
    ] {
        let (cubic, straight, count) = fill_errors(&tank(noise, period_s, tails), Origin::Filled);
        println!(
            "noise {:.1} mm, period {period_s} s, tails off by {:.0} mm, {count} rows: cubic {:.3} mm, lines {:.3} mm",
            1e3 * noise,
            1e3 * tails,
            1e3 * cubic,
            1e3 * straight
        );
        assert_eq!(count, 160);
        assert!(cubic < most * straight, "{cubic} {straight}");
    }
}

#[test]
fn one_reflector_in_a_gap_holds_the_pose() {
    // Each reflector is missing in one frame of ten, so most lost rows show the other.
    let tank = |noise| Tank {
        dropout: 0.1,
        noise,
        period_s: 2.0,
        ..robot(1.2)
    };
    for noise in [0.0, 3e-4] {
        let (one, straight, count) = fill_errors(&tank(noise), Origin::OneSeen);
        let line = format!(
            "{count} rows with one reflector: {:.3} mm, lines {:.3} mm",
            1e3 * one,
            1e3 * straight
        );
        println!("noise {:.1} mm, {line}", 1e3 * noise);
        // No better than the one reflector that was seen, √2 · 0.3 mm, and the heading's error half a link away.
        assert!(
            count > 80 && one < 2e-4 + 1.2 * 2f64.sqrt() * noise,
            "{one}"
        );
    }
    // A single lost frame is the cubic's.
    let (_, _, single) = fill_errors(&tank(3e-4), Origin::Filled);
    assert!(single > 100, "{single}");
}

#[test]
fn short_gaps_cost_a_gait_with_corners_next_to_nothing() {
    // A square's corners are beyond five harmonics. Where a hundred rows of each cycle were not there at all, what the harmonics
    // leave would not average out.
    let tank = |gaps: bool| Tank {
        gait: AnyGait::square(1.2),
        gaps: (0..if gaps { 50 } else { 0 })
            .map(|i| (600 + 83 * i, 8))
            .collect(),
        dropout: 0.0,
        noise: 1e-5,
        ghosts: false,
        ..robot(1.2)
    };
    let [whole, holes] = [false, true].map(|gaps| {
        let tank = tank(gaps);
        calibrate_run(&tank.run(), &tank.named(), &file())
            .unwrap()
            .cycles
    });
    let spread = |cycles: &calibrate::Cycles| (1e6 * cycles.x.sd, 1e6 * cycles.delta_y.sd);
    println!(
        "sd of X and ΔY without gaps {:?} µm, with {:?} µm",
        spread(&whole),
        spread(&holes)
    );
    assert_eq!(holes.cycles.len(), whole.cycles.len());
    assert!(
        holes.x.sd < 3e-6 && (holes.x.mean - whole.x.mean).abs() < 3e-6,
        "{:?}",
        holes.x
    );
}

#[test]
fn labels_wrong_for_most_of_the_time_win_and_that_is_said_nowhere_else() {
    // Labels are the only information about the ends: if they are wrong throughout, so is the heading, by half a turn.
    let tank = Tank {
        swaps: vec![(0, 100_000)],
        ..robot(1.2)
    };
    let track = poses(&tank.run().track, &tank.named(), &PoseOptions::default()).unwrap();
    let first = track.samples[0].pose.theta;
    assert!(
        ((first - 0.8).abs() - std::f64::consts::PI).abs() < 0.05,
        "{first}"
    );
}

#[test]
fn reflectors_without_names_are_found() {
    for text in [robot(1.2).motive(), robot(1.2).table()] {
        let tank = robot(1.2);
        let run = tank.run_of(&text);
        let result = calibrate_run(&run, &tank.auto(), &file()).unwrap();
        let (place, heading) = errors(&tank, &result.poses);
        assert!(
            place < 5.0 * 3e-4 && heading < 5.0 * 6e-3,
            "{place} {heading}"
        );
        assert!(result.poses.front == FrontRule::Travel && result.cycles.x.mean > 0.0);
    }
}

#[test]
fn a_place_tells_front_from_back() {
    // The first frame's reflectors are at (0.4, -0.2) ± 35.5 mm along 0.8 rad. The swimmer is made to run backwards, so that the
    // direction of travel would be wrong.
    let tank = robot(1.2);
    let mut run = tank.run_of(&tank.table());
    run.gait = AnyGait::circle(1.2).reversed_if(true);
    let (ahead, behind) = ([0.45, -0.15], [0.35, -0.25]);
    let near = PointName::Near;
    for (front, back) in [
        (near(ahead), PointName::Auto),
        (PointName::Auto, near(behind)),
    ] {
        let result = calibrate_run(&run, &tank.reflectors(front, back), &file()).unwrap();
        assert_eq!(result.poses.front, FrontRule::Place);
        assert!(errors(&tank, &result.poses).1 < 5.0 * 6e-3 && result.cycles.x.mean > 0.0);
    }
    let travel = calibrate_run(&run, &tank.auto(), &file()).unwrap();
    assert!(errors(&tank, &travel.poses).1 > 3.0 && travel.cycles.x.mean < 0.0);
    // One run may say it for itself.
    run.front = Some(near(ahead));
    let result = calibrate_run(&run, &tank.auto(), &file()).unwrap();
    assert_eq!(result.poses.front, FrontRule::Place);
    run.front = Some(near(behind));
    let turned = calibrate_run(&run, &tank.auto(), &file()).unwrap();
    assert!(errors(&tank, &turned.poses).1 > 3.0);
}

#[test]
fn an_ambiguous_gap_needs_labels() {
    // Three seconds, in which the robot could have turned round.
    let tank = Tank {
        gaps: vec![(2500, 700)],
        ghosts: false,
        ..robot(1.2)
    };
    let run = tank.run();
    let track = poses(&run.track, &tank.named(), &PoseOptions::default()).unwrap();
    assert_eq!(track.report.segments, 2);
    assert!(errors(&tank, &track).1 < 0.04);
}

#[test]
fn cycles_agree_with_the_stroke() {
    for amplitude in [0.5, 1.2, 1.9] {
        let tank = robot(amplitude);
        let result = calibrate_run(&tank.run(), &tank.named(), &file()).unwrap();
        let stroke = swim(
            &Model::new(&tank.swimmer).unwrap(),
            &tank.gait,
            &Tolerance::default(),
        );
        let cycles = &result.cycles;
        assert_eq!((cycles.cycles.len(), cycles.x.count), (4, 3));
        assert!(
            matches!(cycles.left_out[..], [(_, LeftOut::StartUp)]),
            "{:?}",
            cycles.left_out
        );
        // 0.3 mm over 1000 samples a cycle: 10 µm for a mean of two; ends of a harmonic curve and the phase add some.
        assert!(
            (cycles.x.mean - stroke.displacement.x).abs() < 3e-5,
            "{} {}",
            cycles.x.mean,
            stroke.displacement.x
        );
        assert!((cycles.y.mean - stroke.displacement.y).abs() < 6e-5);
        assert!(
            (cycles.delta_y.mean / stroke.delta_y - 1.0).abs() < 0.01,
            "{} {}",
            cycles.delta_y.mean,
            stroke.delta_y
        );
        assert!((cycles.delta_theta.mean / stroke.delta_theta - 1.0).abs() < 0.01);
        assert!(cycles.rotation.mean.abs() < 1e-3);
        assert!(
            (cycles.period_s / 10.0 - 1.0).abs() < 1e-3,
            "{amplitude}: {}",
            cycles.period_s
        );
        assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    }
}

#[test]
fn noise_does_not_widen_the_amplitude() {
    // 200 samples a cycle and 1 mm of noise: the range of the samples is 3 mm too wide for a range of 41 mm.
    let mut sum = [0.0; 2];
    for seed in 0..20 {
        let tank = Tank {
            period_s: 2.0,
            noise: 1e-3,
            cycles: 8,
            dropout: 0.0,
            seed,
            ..robot(1.2)
        };
        let result = calibrate_run(&tank.run(), &tank.named(), &file()).unwrap();
        let raw = |cycle: &calibrate::Cycle| {
            let heading = 0.8 + tank.poses()[0].theta * 0.0;
            let across = result
                .poses
                .seen()
                .filter(|s| s.time_s >= cycle.start_s && s.time_s < cycle.start_s + 2.0);
            let y: Vec<f64> = across
                .map(|s| s.pose.y * heading.cos() - s.pose.x * heading.sin())
                .collect();
            (y.iter().copied().fold(f64::MIN, f64::max)
                - y.iter().copied().fold(f64::MAX, f64::min))
                / 2.0
        };
        let cycles = &result.cycles.cycles;
        sum[0] += result.cycles.delta_y.mean / 20.0;
        sum[1] += cycles.iter().map(raw).sum::<f64>() / cycles.len() as f64 / 20.0;
    }
    let tank = robot(1.2);
    let truth = swim(
        &Model::new(&tank.swimmer).unwrap(),
        &tank.gait,
        &Tolerance::default(),
    )
    .delta_y;
    println!(
        "ΔY true {truth:.6}, harmonic {:.6}, raw {:.6}",
        sum[0], sum[1]
    );
    assert!((sum[0] / truth - 1.0).abs() < 0.005, "{} {truth}", sum[0]);
    assert!(sum[1] - truth > 5e-4, "{} {truth}", sum[1]);
}

#[test]
fn the_period_is_refined() {
    let tank = robot(1.2);
    let mut run = tank.run();
    run.period_s = 10.08;
    let result = calibrate_run(&run, &tank.named(), &file()).unwrap();
    assert!(
        (result.cycles.period_s - 10.0).abs() < 2e-3,
        "{}",
        result.cycles.period_s
    );
    assert!(matches!(
        result.cycles.warnings[..],
        [CycleWarning::Period { .. }]
    ));
    // Five per cent off, cycles would be cut out of step: the heading says which period it is.
    run.period_s = 10.5;
    let error = calibrate_run(&run, &tank.named(), &file()).unwrap_err();
    assert!(error.to_string().contains("about every 10.00 s"), "{error}");
}

/// Warnings about a good recording whose period was written down wrongly.
fn said_of_period(tank: &Tank, times: f64) -> (bool, String) {
    let mut run = tank.run();
    run.period_s = times * tank.period_s;
    match calibrate_run(&run, &tank.named(), &file()) {
        Ok(result) => (false, result.warnings.join("; ")),
        Err(error) => (true, error.to_string()),
    }
}

#[test]
fn a_wrong_period_is_no_answer() {
    let tank = Tank {
        cycles: 9,
        ..robot(1.2)
    };
    for times in [0.5, 2.0 / 3.0, 0.75, 4.0 / 3.0, 1.5, 2.0, 3.0] {
        let (refused, said) = said_of_period(&tank, times);
        println!("{times:.3}: {said}");
        let names_both = said.contains(&format!("every {:.3} s", 10.0 * times))
            || said.contains(&format!("cycle of {:.3} s", 10.0 * times));
        assert!(refused && names_both, "{times}: {said}");
        let found = said
            .split("every ")
            .filter_map(|part| part.split(' ').next()?.parse::<f64>().ok())
            .any(|found| (found / 10.0 - 1.0).abs() < 0.01);
        assert!(found && said.contains("check period_s"), "{times}: {said}");
    }
    // A little off, it is no other period; and the true one is not spoken of.
    assert!(!said_of_period(&tank, 1.0).1.contains("repeat"));
    for amplitude in [0.15, 0.5, 1.9] {
        let noisy = Tank {
            noise: 1e-3,
            ..robot(amplitude)
        };
        let (refused, said) = said_of_period(&noisy, 1.0);
        assert!(!refused && !said.contains("repeat"), "{amplitude}: {said}");
    }
}

#[test]
fn cycles_with_too_little_in_them_are_left_out() {
    // Two seconds of ten are missing in the third cycle (it begins at 1.3 + 1.5 + 20 s), in stretches that can be followed.
    let gaps = (0..20).map(|i| (2400 + 30 * i, 10)).collect();
    let tank = Tank {
        gaps,
        ghosts: false,
        ..robot(1.2)
    };
    let cycles = calibrate_run(&tank.run(), &tank.named(), &file())
        .unwrap()
        .cycles;
    assert_eq!(cycles.cycles.len(), 3);
    let missing: Vec<f64> = cycles
        .left_out
        .iter()
        .filter_map(|(_, why)| {
            if let LeftOut::Missing(share) = why {
                Some(*share)
            } else {
                None
            }
        })
        .collect();
    assert!(
        matches!(missing[..], [share] if (share - 0.2).abs() < 0.02),
        "{:?}",
        cycles.left_out
    );
    // A step across the hole is no step.
    assert_eq!(cycles.x.count, 1);
}

#[test]
fn what_gives_no_cycles_says_why() {
    let tank = robot(1.2);
    let still = Tank {
        cycles: 0,
        rest_s: 20.0,
        noise: 0.0,
        ghosts: false,
        ..robot(1e-9)
    };
    let error = calibrate_run(&still.run(), &still.named(), &file()).unwrap_err();
    assert!(
        matches!(
            error,
            CalibrateError::Cycles {
                cause: CycleError::NoMotion
                    | CycleError::NoCycle { .. }
                    | CycleError::NoPhase { .. },
                ..
            }
        ),
        "{error}"
    );
    let short = Tank {
        cycles: 1,
        period_s: 10.0,
        ..robot(1.2)
    };
    let mut run = short.run();
    run.period_s = 30.0;
    let error = calibrate_run(&run, &short.named(), &file()).unwrap_err();
    assert!(
        matches!(
            error,
            CalibrateError::Cycles {
                cause: CycleError::NoCycle { .. },
                ..
            }
        ),
        "{error}"
    );

    let missing = tank.reflectors(PointName::Named("Nose".into()), PointName::Auto);
    let error = calibrate_run(&tank.run(), &missing, &file()).unwrap_err();
    assert!(
        error.is_bad_input()
            && error.to_string().contains("`Nose`")
            && error.to_string().contains("Front, Back"),
        "{error}"
    );
    let mut wrong = tank.named();
    wrong.front.at = [0.0555, 0.0];
    let error = calibrate_run(&tank.run(), &wrong, &file()).unwrap_err();
    assert!(
        matches!(
            error,
            CalibrateError::Poses {
                cause: PoseError::Distance { .. },
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn reflectors_may_sit_anywhere_on_the_link() {
    // The same points, declared a quarter of the way along and aside: the pose is that of another body, rigidly shifted.
    let tank = Tank {
        noise: 0.0,
        dropout: 0.0,
        ghosts: false,
        ..robot(0.9)
    };
    let mut shifted = tank.named();
    let by = Vector2::new(0.01, -0.02);
    shifted.front.at = [0.0355 + by.x, by.y];
    shifted.back.at = [-0.0355 + by.x, by.y];
    let (a, b) = (
        poses(&tank.run().track, &tank.named(), &PoseOptions::default()).unwrap(),
        poses(&tank.run().track, &shifted, &PoseOptions::default()).unwrap(),
    );
    for (a, b) in a.samples.iter().zip(&b.samples) {
        assert!((b.pose.transform(&by) - a.pose.position()).norm() < 1e-12);
    }
}

#[test]
fn one_cycle_is_enough_for_an_answer_with_a_warning() {
    let tank = Tank {
        cycles: 2,
        ..robot(1.2)
    };
    let cycles = calibrate_run(&tank.run(), &tank.named(), &file())
        .unwrap()
        .cycles;
    assert_eq!(cycles.warnings, [CycleWarning::OneCycle]);
    let stroke = swim(
        &Model::new(&tank.swimmer).unwrap(),
        &tank.gait,
        &Tolerance::default(),
    );
    assert!((cycles.x.mean - stroke.displacement.x).abs() < 2e-4);
    assert!(cycles.x.sd.is_nan() && cycles.delta_y.se.is_nan() && cycles.x.count == 1);
}

#[test]
fn a_recording_that_ends_with_the_play_keeps_its_last_cycle() {
    let tank = Tank {
        rest_s: 0.05,
        ..robot(1.2)
    };
    let cycles = calibrate_run(&tank.run(), &tank.named(), &file())
        .unwrap()
        .cycles;
    assert_eq!((cycles.cycles.len(), cycles.left_out.len()), (4, 1));
}

/// File of one camera over the tank: pixels of half a millimetre, y down, the origin in a corner.
fn pixels(tank: &Tank) -> String {
    let table = tank.table();
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    let mut out = header
        .split(',')
        .map(|name| {
            if name == "t" {
                name.to_owned()
            } else {
                format!("{name}_px")
            }
        })
        .collect::<Vec<_>>()
        .join(",");
    for line in lines {
        out.push('\n');
        let cells = line.split(',').enumerate().map(|(column, cell)| {
            let Ok(metres) = cell.parse::<f64>() else {
                return cell.to_owned();
            };
            match column {
                0 => cell.to_owned(),
                _ if column % 2 == 1 => format!("{:?}", metres / 0.0005),
                _ => format!("{:?}", 800.0 - metres / 0.0005),
            }
        });
        out += &cells.collect::<Vec<_>>().join(",");
    }
    out + "\n"
}

#[test]
fn one_camera_gives_poses_once_its_scale_is_known() {
    let tank = robot(1.2);
    let text = pixels(&tank);
    let read = |metres_per_unit| {
        let options = TrackOptions {
            metres_per_unit,
            ..TrackOptions::default()
        };
        read_tracks_with(text.as_bytes(), Path::new("run.csv"), &options).unwrap()
    };
    let reflectors = tank.reflectors(
        PointName::Columns("x1_px".into(), "y1_px".into()),
        PointName::Columns("x2_px".into(), "y2_px".into()),
    );
    // Without a scale there are no poses; the error proposes the scale that the reflectors' distance implies.
    let error = poses(&read(None), &reflectors, &PoseOptions::default()).unwrap_err();
    let PoseError::NoScale {
        scale: Some(scale), ..
    } = error
    else {
        panic!("{error}")
    };
    assert!((scale / 0.0005 - 1.0).abs() < 1e-3, "{scale}");
    // The image's y runs down: the heading turns the right way round all the same.
    let mut track = poses(&read(Some(0.0005)), &reflectors, &PoseOptions::default()).unwrap();
    assert_eq!(track.plane.map, "(x, y) = (X, -Y), normal -Z");
    for sample in &mut track.samples {
        sample.pose.y += 800.0 * 0.0005;
    }
    let (place, heading) = errors(&tank, &track);
    assert!(
        place < 5.0 * 3e-4 && heading < 5.0 * 6e-3,
        "{place} {heading}"
    );
}

/// The table with everything turned and moved from a time on.
fn bumped(tank: &Tank, from_s: f64, turn: f64, by: Vector2<f64>) -> String {
    let frame = Pose::new(by.x, by.y, turn);
    let table = tank.table();
    let row = |line: &str| {
        let cells: Vec<Option<f64>> = line.split(',').map(|cell| cell.parse().ok()).collect();
        let mut out = line.split(',').next().unwrap_or("").to_owned();
        for point in cells[1..].chunks(2) {
            match point {
                [Some(x), Some(y)] if cells[0].is_some_and(|time_s| time_s >= from_s) => {
                    let place = frame.transform(&Vector2::new(*x, *y));
                    write!(out, ",{:?},{:?}", place.x, place.y).unwrap();
                }
                [Some(x), Some(y)] => write!(out, ",{x:?},{y:?}").unwrap(),
                _ => out += ",,",
            }
        }
        out
    };
    let lines = table.lines().enumerate();
    lines.fold(String::new(), |out, (i, line)| {
        out + &if i == 0 { line.to_owned() } else { row(line) } + "\n"
    })
}

#[test]
fn a_frame_that_jumps_between_two_cycles_costs_one_step() {
    let tank = Tank {
        cycles: 9,
        ..robot(1.2)
    };
    let names = |x: &str, y: &str| PointName::Columns(x.into(), y.into());
    let reflectors = tank.reflectors(names("x1", "y1"), names("x2", "y2"));
    let answer = |text: &str| calibrate_run(&tank.run_of(text), &reflectors, &file()).unwrap();
    let whole = answer(&tank.table());
    assert!(whole.poses.jumps.is_empty() && whole.warnings.is_empty());
    assert_eq!((whole.cycles.cycles.len(), whole.cycles.x.count), (8, 7));
    let begins_s = whole.cycles.cycles[4].start_s;
    let close = |a: &calibrate::Statistics, b: &calibrate::Statistics| {
        (a.mean - b.mean).abs() < 3e-5 && a.sd < 2e-4
    };
    for (turn, by, jumps) in [
        // A large jump; one below the limit of following from frame to frame; one so small that only the step shows it.
        (std::f64::consts::FRAC_PI_2, Vector2::new(0.1, 0.2), true),
        (0.0, Vector2::new(0.012, 0.005), true),
        (0.0, Vector2::new(0.003, 0.0), false),
    ] {
        let result = answer(&bumped(&tank, begins_s, turn, by));
        let cycles = &result.cycles;
        println!(
            "{turn:.2} {by:?}: {:?} {:?}",
            result.warnings, cycles.left_out
        );
        assert_eq!(cycles.x.count, 6, "{turn} {by}: {:?}", cycles.left_out);
        assert!(
            close(&cycles.x, &whole.cycles.x)
                && close(&cycles.y, &whole.cycles.y)
                && close(&cycles.delta_y, &whole.cycles.delta_y),
            "{turn} {by}: {cycles:?}"
        );
        assert_eq!(result.poses.jumps.len(), usize::from(jumps));
        let step = |(_, why): &(f64, LeftOut)| matches!(why, LeftOut::Step { .. });
        assert_eq!(cycles.left_out.iter().any(step), !jumps);
        if let [jump] = result.poses.jumps[..] {
            assert!((jump.before_s - begins_s).abs() < 0.02);
            assert!((jump.turned_rad - turn).abs() < 0.5);
            assert!(result.warnings.iter().any(|w| w.contains("the pose jumps")));
        }
    }
    // In the middle of a cycle it costs that cycle.
    let result = answer(&bumped(&tank, begins_s + 4.0, 0.3, Vector2::new(0.1, 0.0)));
    let jump = |(_, why): &&(f64, LeftOut)| *why == LeftOut::Jump;
    assert_eq!(result.cycles.left_out.iter().filter(jump).count(), 1);
    assert!(close(&result.cycles.x, &whole.cycles.x));
}

/// The table with all points held for some rows, again and again.
fn held(text: &str, from: usize, every: usize, rows: usize) -> String {
    let mut kept = String::new();
    let row = |(i, line): (usize, &str)| {
        let place = (i + every).wrapping_sub(from) % every;
        let cells = line.split_once(',').map_or("", |(_, cells)| cells);
        if i < from || place == 0 || place > rows {
            cells.clone_into(&mut kept);
        }
        let time = line.split(',').next().unwrap_or("");
        format!("{time},{kept}\n")
    };
    let (header, lines) = text.split_once('\n').unwrap();
    let lines: String = lines.lines().enumerate().map(row).collect();
    format!("{header}\n{lines}")
}

#[test]
fn rows_that_repeat_are_no_measurements() {
    let names = |x: &str, y: &str| PointName::Columns(x.into(), y.into());
    for (noise, rest_s) in [(3e-4, 1.3), (0.0, 4.0)] {
        let tank = Tank {
            cycles: 9,
            dropout: 0.0,
            ghosts: false,
            noise,
            rest_s,
            ..robot(1.2)
        };
        let reflectors = tank.reflectors(names("x1", "y1"), names("x2", "y2"));
        let answer = |text: &str| calibrate_run(&tank.run_of(text), &reflectors, &file()).unwrap();
        let whole = answer(&tank.table());
        // A robot at rest repeats its rows if there is no noise; they are not held.
        assert_eq!(whole.poses.report.frozen, 0);
        assert!(whole.warnings.is_empty(), "{:?}", whole.warnings);
        let result = answer(&held(&tank.table(), 1700, 1000, 20));
        let report = &result.poses.report;
        println!("{:?}", result.warnings);
        assert_eq!((report.frozen, report.missing), (8 * 20, 8 * 20));
        let said = "160 rows in 8 stretches repeat";
        assert!(result.warnings.iter().any(|w| w.contains(said)));
        let off = (result.cycles.x.mean - whole.cycles.x.mean).abs();
        assert!(off < 5e-6 + 0.05 * noise, "{noise}: {off}");
    }
    // Coarse digits repeat by themselves: a camera's pixels.
    let coarse = Tank {
        noise: 0.0,
        ghosts: false,
        ..robot(1.2)
    };
    let text = pixels(&coarse);
    let mut rounded = String::new();
    for (i, line) in text.lines().enumerate() {
        let cell = |(column, cell): (usize, &str)| match cell.parse::<f64>() {
            Ok(pixel) if i > 0 && column > 0 => format!("{pixel:.0}"),
            _ => cell.to_owned(),
        };
        let cells: Vec<String> = line.split(',').enumerate().map(cell).collect();
        writeln!(rounded, "{}", cells.join(",")).unwrap();
    }
    let options = TrackOptions {
        metres_per_unit: Some(0.0005),
        ..TrackOptions::default()
    };
    let track = read_tracks_with(rounded.as_bytes(), Path::new("run.csv"), &options).unwrap();
    let reflectors = coarse.reflectors(names("x1_px", "y1_px"), names("x2_px", "y2_px"));
    let track = poses(&track, &reflectors, &PoseOptions::default()).unwrap();
    assert_eq!(track.report.frozen, 0);
}

#[test]
fn what_was_written_down_wrongly_is_named() {
    let tank = robot(1.2);
    let twice = tank.reflectors(
        PointName::Named("Front".into()),
        PointName::Named("Front".into()),
    );
    let error = calibrate_run(&tank.run(), &twice, &file()).unwrap_err();
    let said = error.to_string();
    assert!(
        error.is_bad_input() && said.contains("both name `Front`"),
        "{said}"
    );
    for (period_s, why) in [
        (1e6, "less than two cycles of 1000000 s"),
        (1e-3, "0.10 samples in a cycle of 0.001 s"),
    ] {
        let mut run = tank.run();
        run.period_s = period_s;
        let said = calibrate_run(&run, &tank.named(), &file())
            .unwrap_err()
            .to_string();
        assert!(
            said.contains(why) && said.contains("check period_s"),
            "{said}"
        );
    }
}
