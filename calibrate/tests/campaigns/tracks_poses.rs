//! One motion in every format that gives a pose, written by `writers`. Checked are the points, the rate, and the pose of the middle
//! link in every row.

use crate::writers;

use std::path::Path;

use calibrate::{PoseOptions, TrackOptions, poses, read_tracks_with};
use swimmer_files::{PointName, Reflector, Reflectors, RigidBody};
use writers::{Link, RATE_HZ, ROWS, WrittenFile, truth, written_files};

fn reflectors(link: &Link) -> Reflectors {
    let end = |name: Option<&str>, along| Reflector {
        point: name.map_or(PointName::Auto, |name| PointName::Named(name.to_owned())),
        at: [along, 0.0],
    };
    let (names, body) = match link {
        Link::Pair(front, back) => ([Some(*front), Some(*back)], None),
        Link::Body(name) => ([None, None], Some(RigidBody::named((*name).to_owned()))),
        Link::Offset(name, at, heading_rad) => {
            let body = RigidBody {
                at: *at,
                heading_rad: *heading_rad,
                ..RigidBody::named((*name).to_owned())
            };
            ([None, None], Some(body))
        }
    };
    Reflectors {
        front: end(names[0], writers::HALF),
        back: end(names[1], -writers::HALF),
        body,
        sides: None,
    }
}

fn check(written: &WrittenFile) {
    let name = written.name;
    let options = TrackOptions {
        rate_hz: written.rate_hz,
        metres_per_unit: written.scale,
        ..TrackOptions::default()
    };
    let file = read_tracks_with(written.text.as_bytes(), Path::new("run"), &options);
    let file = file.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(file.format.to_string(), written.format, "{name}");
    let points: Vec<&str> = file
        .points
        .iter()
        .map(|point| point.name.as_str())
        .collect();
    assert_eq!(points, written.points, "{name}");
    let rate = written.own_rate_hz.unwrap_or(RATE_HZ);
    assert!(
        (file.rate_hz / rate - 1.0).abs() < 1e-3,
        "{name}: {} Hz",
        file.rate_hz
    );
    assert_eq!(file.frames(), ROWS, "{name}");
    let track = poses(&file, &reflectors(&written.link), &PoseOptions::default());
    let track = track.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(track.samples.len(), ROWS, "{name}");
    for (row, sample) in track.samples.iter().enumerate() {
        let time_s = row as f64 / rate;
        let from = track.samples[0].time_s;
        assert!(
            (sample.time_s - from - time_s).abs() < 2e-3,
            "{name}, row {row}: {}",
            sample.time_s
        );
        let [x, y, theta] = truth(row);
        let pose = sample.pose;
        // An image's origin is anywhere.
        let [dx, dy] = written.origin;
        let off = (pose.x - x - dx).hypot(pose.y - y - dy);
        assert!(
            off < 2e-5,
            "{name}, row {row}: off by {off} m, {pose:?}, not {x} {y}"
        );
        assert!(
            (pose.theta - theta).abs() < 4e-4,
            "{name}, row {row}: {} rad, not {theta}",
            pose.theta
        );
    }
}

#[test]
fn every_format_gives_the_same_poses() {
    let written_files = written_files();
    assert!(written_files.len() > 20);
    for written in &written_files {
        check(written);
    }
}

/// The message about a format without a reader states how to export text.
#[test]
fn unreadable_formats_state_how_to_export() {
    let says = |bytes: &[u8]| {
        let read = read_tracks_with(bytes, Path::new("run"), &TrackOptions::default());
        read.err().unwrap().to_string()
    };
    for (bytes, words) in [
        (&b"<?xml version=\"1.0\"?>\n<Workbook/>\n"[..], vec!["run:2:1", "root `Workbook`", "save it as CSV"]),
        (b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>", vec!["root `svg`", "t,x1,y1,x2,y2"]),
        (b"<Tracks><particle>", vec!["run:", "XML cannot be read"]),
        (b"<Tracks frameInterval=\"0.02\" timeUnits=\"sec\"><particle><detection t=\"0\" x=\"1\"/></particle></Tracks>", vec!["`detection`", "`y`"]),
        (b"\x89HDF\r\n\x1a\n", vec!["hdf5", "save_as_csv", "sleap-convert"]),
        (b"\x02\x50\x01\0\0\0", vec!["c3d", "Motive", "TRC"]),
        (b"t,x,y,yaw\n0,1,2,3\n0.1,1,2,37.2\n", vec!["run:3:", "yaw_deg"]),
    ] {
        let message = says(bytes);
        for word in words {
            assert!(message.contains(word), "{message}");
        }
    }
}

/// A body that is missing or has no orientation is refused; the message lists the bodies with an orientation.
#[test]
fn unusable_bodies_are_refused() {
    let text = "t,x,y,yaw,a_x,a_y\n0,1,2,0.1,0,0\n0.1,1,2,0.2,0,0\n";
    let file =
        read_tracks_with(text.as_bytes(), Path::new("run"), &TrackOptions::default()).unwrap();
    let error = |name: &'static str, axis| {
        let mut reflectors = reflectors(&Link::Body(name));
        reflectors.body.as_mut().unwrap().axis = axis;
        poses(&file, &reflectors, &PoseOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert!(
        error("a", None).contains("those with one are x,y"),
        "{}",
        error("a", None)
    );
    assert!(
        error("x,y", Some((2, 1.0))).contains("z axis"),
        "{}",
        error("x,y", Some((2, 1.0)))
    );
}
