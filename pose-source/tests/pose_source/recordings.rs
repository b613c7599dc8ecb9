//! Recordings: written by the recorder and by the twin, read as frames.

use std::path::Path;
use std::time::Duration;

use calibrate::TrackOptions;
use pose_source::{
    Frame, Pace, Recorder, Settings, SourceName, Stream, recording_frames, twin_frame,
};
use swimmer_model::Pose;
use twin::{Camera, CameraConfig, MotiveFile};

use crate::frames::{all, assert_same, next, seen};

fn written(path: &Path, frames: &[Frame]) {
    let mut recorder = Recorder::create(path).unwrap().unwrap();
    for frame in frames {
        recorder.write(frame).unwrap();
    }
    assert_eq!(recorder.finish().unwrap(), frames.len() as u64);
}

fn read(path: &Path) -> Vec<Frame> {
    recording_frames(path, &TrackOptions::default())
        .unwrap()
        .collect()
}

/// A name that needs quotes, and points that come and go.
#[test]
fn a_csv_recording_is_read_by_calibrate() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("live.csv");
    let mut frames = seen(300, 7);
    for frame in &mut frames {
        for marker in &mut frame.markers {
            if marker.name.as_deref() == Some("Back") {
                marker.name = Some("Back, left".to_owned());
            }
        }
    }
    written(&path, &frames);
    let again = read(&path);
    assert_eq!(again.len(), 300);
    for (frame, again) in frames.iter().zip(&again) {
        let mut frame = frame.clone();
        frame.bodies.clear();
        assert_same(&frame, again, 1e-6);
    }
    let file = calibrate::read_tracks(&std::fs::read(&path).unwrap(), &path).unwrap();
    assert!((file.rate_hz - 100.0).abs() < 1e-6, "{}", file.rate_hz);
    let body = file.points.iter().find(|point| point.name == "robot");
    let tracked = frames
        .iter()
        .filter(|frame| !frame.bodies.is_empty())
        .count();
    assert_eq!(body.unwrap().present(), tracked);
}

#[test]
fn an_mcap_recording_is_read_back_whole_and_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("live.mcap");
    let frames = seen(230, 8);
    written(&path, &frames);
    let again = read(&path);
    assert_eq!(again.len(), 230);
    for (frame, again) in frames.iter().zip(&again) {
        assert_same(frame, again, 1e-12);
    }
    let bytes = std::fs::read(&path).unwrap();
    let cut = folder.path().join("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let kept = read(&cut);
    assert!((50..200).contains(&kept.len()), "{}", kept.len());
    std::fs::write(&cut, &bytes[..20]).unwrap();
    let error = recording_frames(&cut, &TrackOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no frames"), "{error}");
}

#[test]
fn other_extensions_are_no_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("live.txt");
    assert!(Recorder::create(&path).unwrap().is_none() && !path.exists());
    Recorder::create(folder.path().join("no/live.csv").as_path())
        .err()
        .unwrap();
}

/// Motive's file with Y up: the same frames as straight from the camera.
#[test]
fn motives_axes_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motive.csv");
    let mut file = MotiveFile::create(&path, &CameraConfig::default(), 1).unwrap();
    let mut camera = Camera::new(CameraConfig::default(), 0.0355, 1, 0);
    let mut frames = Vec::new();
    for number in 0..200_u32 {
        let pose = Pose::new(f64::from(number) * 1e-3, 0.1, f64::from(number) * 0.01);
        let exposed = camera.expose(&pose);
        file.push(&exposed).unwrap();
        let stamp = Duration::from_millis(u64::from(number) * 10);
        frames.push(twin_frame(&exposed, stamp));
    }
    file.finish().unwrap();
    for (mut frame, again) in frames.into_iter().zip(read(&path)) {
        frame.bodies.clear();
        assert_same(&frame, &again, 1e-6);
    }
}

#[test]
fn pixels_need_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("video.csv");
    std::fs::write(&path, "t,Front_x_px,Front_y_px\n0,10,20\n0.1,11,21\n").unwrap();
    let error = recording_frames(&path, &TrackOptions::default()).unwrap_err();
    assert!(error.to_string().contains("--scale"), "{error}");
    let options = TrackOptions {
        metres_per_unit: Some(0.001),
        ..TrackOptions::default()
    };
    let frames: Vec<Frame> = recording_frames(&path, &options).unwrap().collect();
    assert_eq!(frames.len(), 2);
    assert!(
        (frames[0].markers[0].y_m.abs() - 0.02).abs() < 1e-12,
        "{frames:?}"
    );
}

/// At its own pace a recording takes as long as it took; fast it does not, and both give the same frames.
#[test]
fn a_recording_has_two_paces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("live.csv");
    written(&path, &seen(60, 9));
    let run = |pace| {
        let settings = Settings {
            pace,
            ..Settings::default()
        };
        let stream = Stream::open(&SourceName::File(path.clone()), &settings).unwrap();
        let begun = std::time::Instant::now();
        let frames = all(&stream);
        (frames, begun.elapsed())
    };
    let (slow, took) = run(Pace::Recorded);
    assert!(took >= Duration::from_millis(580), "{took:?}");
    let (fast, _) = run(Pace::Fast);
    assert_eq!(slow.len(), 60);
    for (slow, fast) in slow.iter().zip(&fast) {
        assert_same(slow, fast, 0.0);
    }
}

#[test]
fn the_twin_is_a_source() {
    let settings = Settings {
        pace: Pace::Fast,
        ..Settings::default()
    };
    let stream = Stream::open(&SourceName::Twin, &settings).unwrap();
    let stamps: Vec<f64> = (0..200).map(|_| next(&stream).stamp_s).collect();
    for pair in stamps.windows(2) {
        assert!((pair[1] - pair[0] - 0.01).abs() < 1e-9);
    }
}
