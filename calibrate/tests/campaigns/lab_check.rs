//! The laboratory of `lab/` against printed numbers, against the model, and through the calibration.

use crate::lab;

use calibrate::{FitOptions, calibrate_campaign, read_tracks};
use lab::{Body, Joint, Lab, Loop, Play};
use nalgebra::Vector2;
use std::path::Path;
use swimmer_model::{Model, Swimmer};

/// Purcell's swimmer: angles, connection by rows, power matrix.
type Printed = ([f64; 2], [[f64; 2]; 3], [f64; 3]);

const PURCELL: [Printed; 4] = [
    (
        [0.5, -0.3],
        [
            [0.092_985, 0.077_454],
            [-0.149_731, -0.151_491],
            [-0.259_598, 0.268_328],
        ],
        [0.203_711, 0.126_545, 0.191_995],
    ),
    (
        [1.2, 0.7],
        [
            [0.128_795, -0.012_972],
            [-0.107_664, -0.123_586],
            [-0.199_351, 0.285_965],
        ],
        [0.338_593, 0.209_762, 0.263_784],
    ),
    (
        [-0.9, 2.1],
        [
            [-0.145_393, -0.214_942],
            [-0.032_719, 0.063_733],
            [-0.387_777, 0.184_558],
        ],
        [0.153_397, 0.051_648, 0.372_500],
    ),
    (
        [2.5, -2.2],
        [
            [0.135_801, 0.158_156],
            [0.130_256, 0.092_926],
            [-0.334_049, 0.402_311],
        ],
        [0.392_151, -0.062_046, 0.334_284],
    ),
];

#[test]
fn the_balance_gives_purcells_numbers() {
    for (phi, connection, power) in PURCELL {
        let a = Body::PURCELL.connection(phi);
        for (mine, printed) in a.iter().flatten().zip(connection.iter().flatten()) {
            assert!((mine - printed).abs() < 6e-7, "{phi:?}: {a:?}");
        }
        let (one, two) = ([1.0, 0.0], [0.0, 1.0]);
        for ((left, right), printed) in [(one, one), (one, two), (two, two)].into_iter().zip(power)
        {
            let mine = Body::PURCELL.power(phi, left, right);
            assert!((mine - printed).abs() < 6e-7, "{phi:?}: {mine} {printed}");
        }
    }
}

/// Two whole cycles at exact joints, the second alone: its displacement over the length.
fn stroke(body: &Body, gait: Loop) -> f64 {
    let play = Play {
        gait,
        clockwise: false,
        period_s: 10.0,
        cycles: 2,
        rest_s: 1.0,
        soft_s: 1.0,
    };
    let exact = Joint {
        max_rate: 1e9,
        ..Joint::EXACT
    };
    let states = lab::swim::swim(body, &[exact; 2], &play, (1.0, None), 400.0, [0.0; 3]);
    let (from, until) = (states[12 * 400], states[22 * 400]);
    let (dx, dy) = (until[0] - from[0], until[1] - from[1]);
    // Along the heading at the symmetric shape.
    (dx * from[2].cos() + dy * from[2].sin()) / body.length()
}

#[test]
fn swimming_gives_purcells_strokes() {
    for (gait, printed) in [
        (Loop::Circle(1.633_162_5), 0.082_285_393_1),
        (Loop::Circle(3.647_415), -0.214_965_8),
        (Loop::Square(1.390_607_7), 0.078_260_826_4),
    ] {
        let mine = stroke(&Body::PURCELL, gait);
        println!("{gait:?}: {mine:.9}");
        assert!(
            (mine / printed - 1.0).abs() < 3e-6,
            "{gait:?}: {mine} {printed}"
        );
    }
}

#[test]
fn the_model_agrees_on_a_robot_with_a_sphere() {
    let body = Body::ROBOT;
    let swimmer = Swimmer {
        chi: body.chi,
        sphere_radius: body.sphere,
        ..Swimmer::robot_slender()
    };
    let model = Model::new(&swimmer).unwrap();
    for step in 0..400 {
        let phi = [
            2.5 * f64::from(step % 20 - 10) / 10.0,
            2.5 * f64::from(step / 20 - 10) / 10.0,
        ];
        let (a, b) = (
            body.connection(phi),
            model.local_connection(&Vector2::from(phi)),
        );
        for (row, mine) in a.iter().enumerate() {
            for (joint, mine) in mine.iter().enumerate() {
                let theirs = b[(row, joint)];
                assert!((mine - theirs).abs() < 1e-12, "{phi:?}: {a:?} {b}");
            }
        }
    }
    let mine = stroke(&body, Loop::Circle(1.0));
    let swum = swimmer_model::swim(
        &model,
        &swimmer_files::AnyGait::circle(1.0),
        &swimmer_model::Tolerance::default(),
    );
    let theirs = swum.displacement.x / body.length();
    println!("X/L {mine:.9} {theirs:.9}");
    assert!((mine / theirs - 1.0).abs() < 3e-6);
}

#[test]
fn a_joint_is_what_it_says() {
    let play = Lab::new(1).play(&lab::Run::of(60.0));
    let joint = Joint {
        gain: 0.9,
        offset: 0.05,
        dead_band: 0.1,
        lag_s: 0.5,
        ..Joint::EXACT
    };
    let states = lab::swim::swim(
        &Body::ROBOT,
        &[joint; 2],
        &play,
        (1.0, None),
        100.0,
        [0.0; 3],
    );
    let last_cycle = &states[states.len() - 1200..states.len() - 150];
    let reach = |sign: f64| {
        last_cycle
            .iter()
            .map(|s| sign * s[3])
            .fold(f64::MIN, f64::max)
    };
    // gain · 60° + offset − dead band, either way.
    let amplitude = 0.9 * 60_f64.to_radians();
    assert!((reach(1.0) - (amplitude + 0.05 - 0.1)).abs() < 1e-4);
    assert!((reach(-1.0) - (amplitude - 0.05 - 0.1)).abs() < 1e-4);
}

#[test]
fn the_same_seed_records_the_same() {
    let mut lab = Lab::sparse(5);
    lab.cameras.dropout = 0.01;
    lab.cameras.ghosts = 0.01;
    let text = lab.motive(0);
    assert_eq!(text, lab.motive(0));
    let other = Lab { seed: 6, ..lab };
    assert_ne!(text, other.motive(0));
}

#[test]
fn table_and_motive_hold_the_same_places() {
    let lab = Lab::sparse(3);
    let read = |text: String| read_tracks(text.as_bytes(), Path::new("f")).unwrap();
    let (table, motive) = (read(lab.table(2)), read(lab.motive(2)));
    assert_eq!(table.frames(), motive.frames());
    assert!((table.rate_hz / motive.rate_hz - 1.0).abs() < 1e-6);
    for (flat, high) in table.points.iter().zip(&motive.points) {
        assert_eq!(flat.name, high.name);
        for row in 0..table.frames() {
            let (p, q) = (flat.position(row).unwrap(), high.position(row).unwrap());
            assert!((p.x - q.z).abs() < 1e-12 && (p.y - q.x).abs() < 1e-12);
        }
    }
}

#[test]
fn a_clean_campaign_gives_its_truth() {
    for lab in [Lab::sparse(1), Lab::new(1)] {
        let began = std::time::Instant::now();
        let (campaign, data) = lab.campaign();
        let generated = began.elapsed();
        let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
            .unwrap()
            .fit;
        let (r, chi) = (fit.sphere_radius / 0.0545 - 1.0, fit.chi / 2.93 - 1.0);
        println!(
            "{} Hz: r_s {:+.3} %, chi {:+.3} %; generated in {generated:?}",
            lab.cameras.rate_hz,
            100.0 * r,
            100.0 * chi,
        );
        assert!(r.abs() < 0.01 && chi.abs() < 0.01);
        let intervals = &fit.intervals;
        assert!(intervals.sphere_radius[0] < 0.0545 && intervals.sphere_radius[1] > 0.0545);
        assert!(intervals.chi[0] < 2.93 && intervals.chi[1] > 2.93);
    }
}

#[test]
fn a_campaign_on_disk_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = Lab::sparse(2).write(folder.path()).unwrap();
    let campaign = swimmer_files::Campaign::load(&path).unwrap();
    let data = calibrate::CampaignData::load(&campaign).unwrap();
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    assert!((fit.sphere_radius / 0.0545 - 1.0).abs() < 0.01, "{fit:?}");
}

#[test]
fn three_percent_of_gain_is_what_the_issue_saw() {
    let lab = Lab::sparse(1).with_gain(0.97).with_noise(1e-3);
    let (campaign, data) = lab.campaign();
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    println!("r_s {:.5} m, chi {:.4}", fit.sphere_radius, fit.chi);
    assert!((fit.sphere_radius - 0.0574).abs() < 1e-3 && (fit.chi - 3.08).abs() < 0.05);
}
#[test]
#[ignore = "prints a time"]
fn how_long_a_campaign_takes() {
    for lab in [Lab::sparse(1), Lab::new(1)] {
        let began = std::time::Instant::now();
        let runs: usize = (0..20)
            .map(|seed| {
                Lab {
                    seed,
                    ..lab.clone()
                }
                .campaign()
                .1
                .runs
                .len()
            })
            .sum();
        let each = began.elapsed() / 20;
        println!(
            "{} Hz: {each:?} for {} runs",
            lab.cameras.rate_hz,
            runs / 20
        );
    }
}

/// Writes a campaign with measured joints, swaps, ghosts and a reported run into a folder, for inspection.
#[test]
#[ignore = "writes where LAB_FOLDER says"]
fn a_campaign_for_eyes() {
    let Some(folder) = std::env::var_os("LAB_FOLDER") else {
        return;
    };
    let folder = Path::new(&folder);
    let mut lab = Lab::sparse(4).with_side_reflectors();
    lab.cameras.ghosts = 0.002;
    lab.runs[2].faults.swaps = vec![[15.0, 3.0], [31.0, 1.0]];
    lab.joints[0].gain = 0.96;
    let path = lab.write(folder).unwrap();
    let told = "[[run]]\ngait = \"circle:60deg\"\nperiod_s = 10.0\nx_mm = 6.3\nx_se_mm = 0.3\n";
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(path, text + told).unwrap();
}
