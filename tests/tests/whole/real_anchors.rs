//! Figures that real recordings give, computed beforehand with other programs. Read in place, never committed; where the
//! folder is missing, the tests are ignored (`build.rs`).

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use calibrate::{
    FrontRule, PointKind, PoseOptions, PoseTrack, TrackFile, TrackPoint, poses, read_tracks,
};
use nalgebra::Vector3;
use swimmer_files::{PointName, Reflector, Reflectors, RigidBody};
use swimmer_model::wrapped_angle;

fn text(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/optitrack")
        .join(name);
    match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => panic!("{} cannot be read: {error}", path.display()),
    }
}

fn read(text: &str) -> TrackFile {
    read_tracks(text.as_bytes(), Path::new("run.csv")).unwrap()
}

fn reflectors(front: &str, back: &str, distance: f64) -> Reflectors {
    let reflector = |name: &str, x| Reflector {
        point: PointName::Named(name.to_owned()),
        at: [x, 0.0],
    };
    Reflectors {
        front: reflector(front, distance / 2.0),
        back: reflector(back, -distance / 2.0),
        body: None,
        sides: None,
    }
}

fn follow(file: &TrackFile, front: &str, back: &str, distance: f64, tolerance_m: f64) -> PoseTrack {
    let options = PoseOptions {
        distance_tolerance: tolerance_m / distance,
        ..PoseOptions::default()
    };
    poses(file, &reflectors(front, back, distance), &options).unwrap()
}

const MARKERS: [&str; 5] = [
    "rbt:Marker1",
    "rbt:Marker2",
    "rbt:Marker3",
    "rbt:Marker4",
    "rbt:Marker5",
];

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..5).flat_map(|i| (i + 1..5).map(move |j| (i, j)))
}

fn named<'f>(file: &'f TrackFile, name: &str) -> &'f TrackPoint {
    let measured = |point: &&TrackPoint| point.name == name && point.kind == PointKind::Marker;
    file.points.iter().find(measured).unwrap()
}

/// The raw list of every frame, without any identity, and both names in the first frame only.
fn unnamed(file: &TrackFile, front: &TrackPoint, back: &TrackPoint) -> (String, f64) {
    let slots: Vec<&TrackPoint> = file
        .points
        .iter()
        .filter(|point| point.kind == PointKind::Unlabeled)
        .collect();
    let mut out = String::from("t,front_x,front_y,front_z,back_x,back_y,back_z");
    for slot in 0..slots.len() {
        write!(out, ",s{slot}_x,s{slot}_y,s{slot}_z").unwrap();
    }
    out.push('\n');
    let both = |row| Some((front.position(row)?, back.position(row)?));
    let first = (0..file.frames()).find(|row| both(*row).is_some()).unwrap();
    let cell = |place: Option<Vector3<f64>>| match place {
        Some(p) => format!(",{:?},{:?},{:?}", p.x, p.y, p.z),
        None => ",,,".to_owned(),
    };
    for row in first..file.frames() {
        let named = |point: &TrackPoint| cell(point.position(row).filter(|_| row == first));
        write!(out, "{:?}{}{}", file.times[row], named(front), named(back)).unwrap();
        for slot in &slots {
            out.push_str(&cell(slot.position(row)));
        }
        out.push('\n');
    }
    let (a, b) = both(first).unwrap();
    (out, (a - b).norm())
}

/// A: two markers followed through a list that has no order, against what the tracking program itself knew.
#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn anchor_a_pairs_are_followed_through_a_list_without_identity() {
    let text = text("tt_v1.0_olin.csv");
    let file = read(&text);
    let mut good = 0;
    for (i, j) in pairs() {
        let (front, back) = (named(&file, MARKERS[i]), named(&file, MARKERS[j]));
        let (table, distance) = unnamed(&file, front, back);
        let raw = read(&table);
        let track = follow(&raw, "front", "back", distance, 0.010);
        let (mut right, mut wrong, mut lost) = (0, 0, 0);
        for (row, time) in file.times.iter().enumerate() {
            let (Some(a), Some(b)) = (front.position(row), back.position(row)) else {
                continue;
            };
            let sample = track
                .seen()
                .find(|sample| (sample.time_s - time).abs() < 1e-9);
            let Some(sample) = sample else {
                lost += 1;
                continue;
            };
            let (a, b) = (track.plane.project(&a), track.plane.project(&b));
            let ahead = nalgebra::Vector2::new(sample.pose.theta.cos(), sample.pose.theta.sin());
            let middle = sample.pose.position() - (a + b) / 2.0;
            let along = (a - b).normalize().dot(&ahead);
            // Two other markers of the body are centimetres away.
            if middle.norm() < 1e-3 && along > 0.999 {
                right += 1;
            } else {
                wrong += 1;
            }
        }
        println!(
            "{} and {}: {right} right, {wrong} wrong, {lost} lost",
            MARKERS[i], MARKERS[j]
        );
        good += usize::from((1662..=1663).contains(&right) && wrong == 0 && lost == 0);
    }
    assert_eq!(good, 10);
}

/// Time, heading about +Y by the quaternion, tilt of the body's Y axis and the Euler yaw, of body 4, from the frame lines.
fn body_motion(text: &str) -> Vec<(f64, f64, f64, f64)> {
    let mut out = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("frame,")) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |index: usize| cells[index].parse::<f64>().unwrap();
        let bodies: usize = cells[3].parse().unwrap();
        for body in 0..bodies {
            let at = 4 + 11 * body;
            if cells[at] == "4" {
                let [qx, qy, qz, qw] = [4, 5, 6, 7].map(|k| number(at + k));
                let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
                    qw, qx, qy, qz,
                ));
                let (ahead, up) = (turn * Vector3::z(), turn * Vector3::y());
                out.push((
                    number(2),
                    ahead.x.atan2(ahead.z),
                    up.y.clamp(-1.0, 1.0).acos(),
                    number(at + 8).to_radians(),
                ));
            }
        }
    }
    out
}

/// B and C: the heading by two markers follows the body's, in the sense that the map (x, y) = (Z, X) gives and no other; the
/// body itself is the worse instrument.
#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn anchors_b_and_c_two_markers_tell_the_heading_better_than_the_body() {
    let text = text("tt_v1.0_olin.csv");
    let file = read(&text);
    let body = body_motion(&text);
    let (mut off, mut mirrored, mut spread, mut distances) = (vec![], vec![], vec![], vec![]);
    let mut swept = Vec::new();
    for (i, j) in pairs() {
        let (front, back) = (named(&file, MARKERS[i]), named(&file, MARKERS[j]));
        let distance = (0..file.frames())
            .find_map(|row| Some((front.position(row)? - back.position(row)?).norm()))
            .unwrap();
        let track = follow(&file, MARKERS[i], MARKERS[j], distance, 0.010);
        assert_eq!(track.plane.map, "(x, y) = (Z, X), normal Y");
        // C: the markers stay flat.
        println!(
            "plane rms {:.2} mm, {:?}",
            1e3 * track.plane.rms_m,
            track.report
        );
        let (mut same, mut other) = (Vec::new(), Vec::new());
        for sample in track.seen() {
            let there = body.iter().find(|b| (b.0 - sample.time_s).abs() < 1e-9);
            if let Some((_, heading, ..)) = there {
                same.push(wrapped_angle(sample.pose.theta - heading));
                other.push(wrapped_angle(-sample.pose.theta - heading));
            }
        }
        let deviation = |angles: &[f64]| {
            let (sin, cos) = angles
                .iter()
                .fold((0.0, 0.0), |(s, c), a| (s + a.sin(), c + a.cos()));
            let mean = f64::atan2(sin, cos);
            let squares: f64 = angles.iter().map(|a| wrapped_angle(a - mean).powi(2)).sum();
            (squares / angles.len() as f64).sqrt().to_degrees()
        };
        // Where markers are near each other, a fraction of a millimetre is a degree.
        if distance > 0.07 {
            off.push(deviation(&same));
            let headings = track.samples.iter().map(|sample| sample.pose.theta);
            let (low, high) = headings.fold((f64::MAX, f64::MIN), |(a, b), t| (a.min(t), b.max(t)));
            swept.push((high - low).to_degrees());
        }
        mirrored.push(deviation(&other));
        spread.push(1e3 * track.report.distance_sd_m);
        distances.push(1e3 * track.report.distance_m);
    }
    println!(
        "headings off by {off:.2?} deg (mirrored {mirrored:.0?}) over {swept:.0?} deg; distances {distances:.0?} mm, sd {spread:.2?} mm"
    );
    let within = |values: &[f64], low: f64, high: f64| {
        values.iter().all(|value| (low..=high).contains(value))
    };
    assert_eq!(off.len(), 5);
    assert!(within(&off, 0.545, 0.745), "{off:?}");
    assert!(mirrored.iter().all(|angle| *angle > 20.0), "{mirrored:?}");
    assert!(within(&swept, 134.0, 140.0), "{swept:?}");
    assert!(within(&spread, 0.235, 0.565), "{spread:?}");
    assert!(within(&distances, 30.0, 114.5), "{distances:?}");
    let tilt = body.iter().map(|b| b.2).fold(0.0, f64::max).to_degrees();
    let yaw_off = body
        .iter()
        .filter(|(_, heading, _, yaw)| wrapped_angle(yaw - heading).abs() > 1_f64.to_radians())
        .count();
    println!("the body tilts by {tilt:.0} deg, its yaw is off in {yaw_off} frames");
    assert!((131.5..132.5).contains(&tilt), "{tilt}");
    assert_eq!(yaw_off, 78);
}

/// The pose of a rigid body is the tracking program's own, but for the frames in which its solver tipped it over.
#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn a_body_has_the_heading_of_its_quaternion() {
    let text = text("tt_v1.0_olin.csv");
    let file = read(&text);
    let reflectors = Reflectors {
        body: Some(RigidBody::named("rbt".to_owned())),
        ..reflectors("auto", "auto", 0.1)
    };
    let track = poses(&file, &reflectors, &PoseOptions::default()).unwrap();
    assert_eq!(track.front, FrontRule::Body);
    assert_eq!(track.plane.map, "(x, y) = (Z, X), normal Y");
    let body = body_motion(&text);
    let mut off: Vec<f64> = Vec::new();
    for sample in track.seen() {
        let there = body.iter().find(|b| (b.0 - sample.time_s).abs() < 1e-9);
        let (_, heading, tilt, _) = there.unwrap();
        assert!(*tilt < 20_f64.to_radians(), "{tilt}");
        off.push(
            wrapped_angle(sample.pose.theta - heading)
                .abs()
                .to_degrees(),
        );
    }
    off.sort_by(f64::total_cmp);
    let upright = body.iter().filter(|b| b.2 < 10_f64.to_radians()).count();
    println!(
        "{} poses of {}, {upright} upright, median {:.3} deg off, worst {:.3}",
        off.len(),
        body.len(),
        off[off.len() / 2],
        off[off.len() - 1]
    );
    assert!(off.len() >= upright.min(body.len() - 100) && off.len() < body.len());
    assert!(off[off.len() / 2] < 0.1 && off[off.len() - 1] < 3.0);
}

/// D: thirteen reflectors under 313 numbers. Any two of the first frame are followed through all their numbers.
#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn anchor_d_reflectors_are_followed_through_their_numbers() {
    let text = text("motive_v1.1_tensegrity_unlabeled13.csv");
    let file = read(&text);
    let here: Vec<&TrackPoint> = file
        .points
        .iter()
        .filter(|point| point.position(7).is_some())
        .collect();
    assert_eq!(here.len(), 13);
    // One of them gets its second number after 196 frames; all get new ones when the structure gives way.
    let shortest = here.iter().map(|point| point.present()).min();
    assert_eq!(shortest, Some(196));
    let mut followed = Vec::new();
    for (i, front) in here.iter().enumerate() {
        for back in &here[i + 1..] {
            let distance = (front.position(7).unwrap() - back.position(7).unwrap()).norm();
            let track = follow(&file, &front.name, &back.name, distance, 0.010);
            followed.push(track.seen().count());
        }
    }
    followed.sort_unstable();
    println!(
        "78 pairs followed through {followed:?} of {} frames",
        file.frames()
    );
    assert!(followed.len() == 78 && followed[0] > 950);
}
