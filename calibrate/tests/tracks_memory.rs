//! Memory of a survey of a file: constant for any length, with the same report as a complete reading.

use std::io::Read;
use std::path::Path;

use calibrate::{
    PoseOptions, TrackFile, TrackOptions, UsedPoints, poses, read_tracks_with, survey_tracks,
};

/// A table of `total` rows, made as it is read.
#[allow(clippy::struct_field_names)] // the rows of a table of rows
struct Rows {
    next: u64,
    total: u64,
    text: Vec<u8>,
    at: usize,
}

impl Rows {
    fn new(rows: u64) -> Self {
        let text = b"frame,t,front_x,front_y,back_x,back_y\n".to_vec();
        Self {
            next: 0,
            total: rows,
            text,
            at: 0,
        }
    }
}

impl Read for Rows {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.text.len() {
            self.text.clear();
            self.at = 0;
            for _ in 0..2000.min(self.total - self.next) {
                let (i, wobble) = (self.next, self.next * 7919 % 1_000_003);
                let back = if i % 97 < 3 {
                    ",".to_owned()
                } else {
                    format!("0.0{wobble:06},0.25{wobble:06}")
                };
                let row = format!(
                    "{i},{}.{:02},0.1{wobble:06},0.25{wobble:06},{back}\n",
                    i / 100,
                    i % 100
                );
                self.text.extend_from_slice(row.as_bytes());
                self.next += 1;
            }
        }
        let count = buffer.len().min(self.text.len() - self.at);
        buffer[..count].copy_from_slice(&self.text[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

fn survey(rows: u64) -> calibrate::TrackSurvey {
    survey_tracks(
        Rows::new(rows),
        Path::new("long.csv"),
        &TrackOptions::default(),
    )
    .unwrap()
}

#[test]
fn a_survey_says_what_a_reading_says() {
    let options = TrackOptions::default();
    let file = read_tracks_with(Rows::new(5000), Path::new("f"), &options).unwrap();
    let survey = survey(5000);
    assert_eq!(survey.frames, file.frames());
    assert!((survey.rate_hz - file.rate_hz).abs() < 1e-12 && (survey.rate_hz - 100.0).abs() < 1e-6);
    assert_eq!(survey.warnings, file.warnings);
    for (a, b) in survey.points.iter().zip(&file.points) {
        assert_eq!(a.name, b.name);
        assert_eq!(
            (a.present, a.gaps, a.longest_gap),
            (b.present(), b.gaps(), b.longest_gap())
        );
    }
    assert_eq!(
        (survey.points[1].gaps, survey.points[1].longest_gap),
        (52, 3)
    );
}

/// Peak memory of this process \[kB\], if the system reports it.
#[cfg(target_os = "linux")]
fn peak_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// Both in one test: the peak is the process's, and tests run side by side.
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_length() {
    survey(20_000);
    let short = peak_kb();
    survey(1_000_000);
    let long = peak_kb();
    println!("peak {short} kB after 20 thousand rows, {long} kB after a million");
    // Kept, they would be 56 MB of places and times.
    assert!(long < short + 8 * 1024, "{short} kB, then {long} kB");
}

/// Motive export of the robot's two markers among those of other objects, generated while it is read.
struct CrowdedExport {
    next: usize,
    rows: usize,
    text: Vec<u8>,
    at: usize,
}

/// Points other than Front and Back.
const OTHERS: usize = 60;

impl CrowdedExport {
    fn new(rows: usize) -> Self {
        let cells = |of: &dyn Fn(usize) -> String| -> String {
            (0..OTHERS + 2)
                .flat_map(|i| std::iter::repeat_n(of(i), 3))
                .collect::<Vec<_>>()
                .join(",")
        };
        let kind = |i: usize| {
            if i % 3 == 2 {
                "Rigid Body Marker"
            } else {
                "Marker"
            }
            .to_owned()
        };
        let name = |i: usize| match i {
            0 => "robot:Front".to_owned(),
            1 => "robot:Back".to_owned(),
            i => format!("head:Marker{i}"),
        };
        let text = format!(
            "Format Version,1.23,Take Name,a,Export Frame Rate,100.000000,Length Units,Meters,Coordinate Space,Global\n\n,Type,{}\n,Name,{}\n,ID,{}\n,,{}\nFrame,Time (Seconds),{}\n",
            cells(&kind),
            cells(&name),
            cells(&|i| format!("A{i}")),
            cells(&|_| "Position".to_owned()),
            vec!["X,Y,Z"; OTHERS + 2].join(",")
        );
        Self {
            next: 0,
            rows,
            text: text.into_bytes(),
            at: 0,
        }
    }
}

impl Read for CrowdedExport {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.text.len() && self.next < self.rows {
            use std::io::Write as _;
            self.text.clear();
            self.at = 0;
            let i = self.next;
            let t = i as f64 / 100.0;
            // 0.1 Hz: ten seconds a cycle, drifting by 5 mm a cycle.
            let (x, theta) = (0.4 + 5e-4 * t, 0.4 * (0.628_318_53 * t).sin());
            write!(self.text, "{i},{t:.6}")?;
            let (s, c) = theta.sin_cos();
            for along in [0.0355, -0.0355] {
                write!(
                    self.text,
                    ",{:.6},0.050000,{:.6}",
                    0.3 + along * s,
                    x + along * c
                )?;
            }
            for other in 0..OTHERS {
                let angle = t + other as f64;
                write!(
                    self.text,
                    ",{:.6},1.700000,{:.6}",
                    3.0 + angle.sin(),
                    2.0 + angle.cos()
                )?;
            }
            self.text.push(b'\n');
            self.next += 1;
        }
        let count = buffer.len().min(self.text.len() - self.at);
        buffer[..count].copy_from_slice(&self.text[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

/// Only the positions of the named reflectors are kept.
#[test]
fn unused_positions_are_dropped_while_reading() {
    let reflector = |name: &str, along| swimmer_files::Reflector {
        point: swimmer_files::PointName::Named(name.to_owned()),
        at: [along, 0.0],
    };
    let reflectors = swimmer_files::Reflectors {
        front: reflector("Front", 0.0355),
        back: reflector("Back", -0.0355),
        body: None,
        sides: None,
    };
    let read = |used| {
        let options = TrackOptions {
            used,
            ..TrackOptions::default()
        };
        read_tracks_with(CrowdedExport::new(2000), Path::new("crowded.csv"), &options).unwrap()
    };
    let (all, few) = (read(None), read(Some(UsedPoints::of(&reflectors))));
    let kept = |file: &TrackFile| {
        file.points
            .iter()
            .filter(|point| point.position(1000).is_some())
            .count()
    };
    assert_eq!((kept(&all), kept(&few)), (OTHERS + 2, 2));
    // Every point is still counted.
    assert!(few.points.iter().all(|point| point.present() == 2000));
    let of = |file| {
        poses(file, &reflectors, &PoseOptions::default())
            .unwrap()
            .samples
    };
    assert_eq!(of(&all), of(&few));
}

/// Writes a recording of 304 MB, to measure the command with: `CROWDED_EXPORT=FILE cargo test … --ignored crowded_export`.
#[test]
#[ignore = "a soak: writes 304 MB"]
fn crowded_export() {
    let path = std::env::var_os("CROWDED_EXPORT").unwrap();
    let mut file = std::fs::File::create(path).unwrap();
    std::io::copy(&mut CrowdedExport::new(181_000), &mut file).unwrap();
}

#[test]
#[ignore = "a soak: reads 2 GB"]
#[cfg(target_os = "linux")]
fn two_gigabytes_in_sixty_four_megabytes() {
    let began = std::time::Instant::now();
    let survey = survey(37_000_000);
    println!(
        "{} rows in {:?}, peak {} kB",
        survey.frames,
        began.elapsed(),
        peak_kb()
    );
    assert_eq!(survey.frames, 37_000_000);
    assert!(peak_kb() < 64 * 1024);
}
