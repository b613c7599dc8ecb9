//! Runs with faults, from a laboratory that shares no code with the project: the warnings about each, and that identity follows
//! geometry and travel.

use crate::lab;

use calibrate::{FrontRule, PoseWarning, RunResult, calibrate_run};
use lab::{Body, Bump, Faults, Lab};
use swimmer_files::SwimmerFile;

/// One run of 85 degrees with these faults.
fn lab(faults: Faults) -> Lab {
    let mut lab = Lab::new(3).with_runs(&[85.0]);
    lab.runs[0].faults = faults;
    lab
}

/// The run as the calibration sees it, with the true drag.
fn run(lab: &Lab) -> RunResult {
    let (campaign, data) = lab.campaign();
    let mut swimmer: SwimmerFile = campaign.swimmer.clone();
    swimmer.swimmer.sphere_radius = Body::ROBOT.sphere;
    swimmer.swimmer.chi = Body::ROBOT.chi;
    calibrate_run(&data.runs[0], &campaign.reflectors, &swimmer).unwrap()
}

/// That X is the clean run's.
#[track_caller]
fn same_as_clean(found: &RunResult) {
    let clean = run(&lab(Faults::default()));
    let (x, truth) = (found.cycles.x.mean, clean.cycles.x.mean);
    assert!((x / truth - 1.0).abs() < 0.01, "X {x} m, clean {truth} m");
}

#[test]
fn swaps_are_told_by_their_times() {
    let swaps = vec![[12.0, 1.5], [30.0, 0.4]];
    let found = run(&lab(Faults {
        swaps: swaps.clone(),
        ..Faults::default()
    }));
    let report = &found.poses.report;
    assert_eq!(
        (report.swaps_repaired, found.poses.front),
        (2, FrontRule::Label)
    );
    for (stretch, [from, long]) in report.swaps.iter().zip(swaps) {
        assert!(
            (stretch.from_s - from).abs() < 0.011 && (stretch.until_s - from - long).abs() < 0.021
        );
    }
    same_as_clean(&found);
}

#[test]
fn names_that_change_sides_in_the_middle_turn_no_run_round() {
    // From here to the end: two fifths of the run, then three.
    for from in [40.0, 25.0] {
        let found = run(&lab(Faults {
            swaps: vec![[from, 1000.0]],
            ..Faults::default()
        }));
        assert_eq!(found.poses.front, FrontRule::Travel, "from {from} s");
        let contested = |w: &&PoseWarning| matches!(w, PoseWarning::LabelsContested { .. });
        let warning = found.poses.warnings.iter().find(contested).unwrap();
        assert!(
            warning.to_string().contains(&format!("{from:.2} s")) || from < 30.0,
            "{warning}"
        );
        same_as_clean(&found);
    }
}

#[test]
fn names_that_change_sides_in_a_gap_turn_no_run_round() {
    // Long enough that the reflectors could have changed places, too short for the robot to turn.
    let found = run(&lab(Faults {
        gaps: vec![[28.0, 2.2]],
        swaps: vec![[29.0, 1000.0]],
        ..Faults::default()
    }));
    assert!(found.poses.report.segments > 1, "the gap is no gap");
    same_as_clean(&found);
}

#[test]
fn front_and_back_exchanged_throughout_is_what_the_names_say() {
    // Nothing contradicts them within the run; that X has the wrong sign is for the campaign to notice.
    let found = run(&lab(Faults {
        exchanged: true,
        ..Faults::default()
    }));
    assert_eq!(found.poses.front, FrontRule::Label);
    assert!(found.cycles.x.mean < 0.0);
}

#[test]
fn a_drifting_fluid_shows_while_the_robot_rests() {
    for drift in [[0.0, 0.0], [5e-4, -2e-4]] {
        let found = run(&lab(Faults {
            drift,
            ..Faults::default()
        }));
        let rest = found.poses.drift.unwrap();
        println!("{rest:?}");
        assert!(rest.rest_s > 1.0 && rest.error_m_s < 2e-4, "{rest:?}");
        for (measured, truth) in rest.velocity_m_s.iter().zip(drift) {
            assert!((measured - truth).abs() < 4.0 * rest.error_m_s, "{rest:?}");
        }
    }
}

#[test]
fn bumps_ghosts_and_distances_are_told() {
    let mut wrong = lab(Faults {
        bumps: vec![Bump {
            at_s: 33.0,
            shift: [0.02, -0.01],
            turn: 0.05,
        }],
        reflections: vec![[0.9, 0.9]],
        ..Faults::default()
    });
    wrong.cameras.scale = 1.01;
    let found = run(&wrong);
    let jumps = &found.poses.jumps;
    assert_eq!(jumps.len(), 1);
    // Each heading has √2 · 0.3/71 of noise.
    let turned = (jumps[0].turned_rad - 0.05).abs();
    assert!(
        (jumps[0].after_s - 33.0).abs() < 0.02 && turned < 0.03,
        "{jumps:?}"
    );
    let report = &found.poses.report;
    assert!((report.distance_m / report.expected_m - 1.01).abs() < 1e-3);
    // The reflection is there from the first row to the last.
    let rows: usize = report.ghosts.iter().map(|stretch| stretch.rows).sum();
    assert_eq!(
        (rows, report.ghosts_rejected),
        (report.followed, report.followed)
    );
}
