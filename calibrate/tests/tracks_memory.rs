//! What a survey of a file costs: the same memory for any length of it, and what it says is what a whole reading says.

use std::io::Read;
use std::path::Path;

use calibrate::{TrackOptions, read_tracks_with, survey_tracks};

/// A table of so many rows, made as it is read.
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

/// The most memory that this process ever had \[kB\], where the system tells it.
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
