//! Frames for the tests.

use std::time::Duration;

use pose_source::{Frame, Received, Stream, twin_frame};
use swimmer_model::Pose;
use twin::{Camera, CameraConfig};

/// Frames of a robot that swims a curve under the twin's cameras, with their noise, drop-outs and ghosts.
pub(crate) fn seen(count: u32, seed: u64) -> Vec<Frame> {
    let config = CameraConfig {
        single_dropout: 0.05,
        ..CameraConfig::default()
    };
    let mut camera = Camera::new(config, 0.0355, seed, 0);
    (0..count)
        .map(|number| {
            let along = f64::from(number) * 1e-4;
            let pose = Pose::new(0.2 + along, 0.1 + 0.05 * (40.0 * along).sin(), 30.0 * along);
            let stamp = Duration::from_millis(u64::from(number) * 10 + 100);
            twin_frame(&camera.expose(&pose), stamp)
        })
        .collect()
}

/// Compares points and bodies; positions within `tolerance_m`.
#[track_caller]
pub(crate) fn assert_same(one: &Frame, other: &Frame, tolerance_m: f64) {
    let near = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance;
    assert!(near(one.stamp_s, other.stamp_s, 1e-6), "{one:?} {other:?}");
    assert_eq!(one.markers.len(), other.markers.len(), "{one:?} {other:?}");
    for marker in &one.markers {
        let same = other.markers.iter().any(|m| {
            let mut pairs = m.position().into_iter().zip(marker.position());
            m.name == marker.name && pairs.all(|(a, b)| near(a, b, tolerance_m))
        });
        assert!(same, "{marker:?} is not in {other:?}");
    }
    assert_eq!(one.bodies.len(), other.bodies.len(), "{one:?} {other:?}");
    for (a, b) in one.bodies.iter().zip(&other.bodies) {
        assert_eq!((a.id, &a.name), (b.id, &b.name));
        assert!(near(a.heading_rad(), b.heading_rad(), 1e-5), "{a:?} {b:?}");
    }
}

/// The next frame of a live stream.
#[track_caller]
pub(crate) fn next(stream: &Stream) -> Frame {
    match stream.next(Duration::from_secs(10)) {
        Received::Frame(frame) => frame,
        other => panic!("{other:?}, {:?}", stream.tallies()),
    }
}

/// All frames to the end.
#[track_caller]
pub(crate) fn all(stream: &Stream) -> Vec<Frame> {
    let mut frames = Vec::new();
    loop {
        match stream.next(Duration::from_secs(10)) {
            Received::Frame(frame) => frames.push(frame),
            Received::Ended(outcome) => {
                outcome.unwrap();
                return frames;
            }
            Received::Nothing => panic!("nothing in 10 s"),
        }
    }
}
