//! Damaged files: an error, or the remaining data with a warning, never a panic and never a wrong number without a warning.
//!
//! Every kind of damage meets every sample at several seeded places. The outcomes are a table that is compared with
//! `tests/mutilated/outcomes.txt`, so that a change of behaviour is a change of that file.

use crate::mutilated;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use calibrate::{TrackFile, TrackOptions, TrackPoint, read_tracks_with};
use mutilated::{DAMAGES, Text};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Sample, delimiter, lines of its header.
const SAMPLES: [(&str, char, usize); 23] = [
    ("motive-1.21.csv", ',', 7),
    ("motive-1.22.csv", ',', 7),
    ("motive-1.23.csv", ',', 7),
    ("motive-1.24.csv", ',', 7),
    ("motive-1.25.csv", ',', 8),
    ("motive-excel-eu.csv", ';', 7),
    ("motive-1.1.csv", ',', 7),
    ("trackingtools-1.0.csv", ',', 6),
    ("tracker-single.txt", '\t', 2),
    ("tracker-multi.txt", '\t', 3),
    ("tracker-side-by-side.csv", ',', 2),
    ("deeplabcut.csv", ',', 3),
    ("deeplabcut-multi.csv", ',', 4),
    ("tank.trc", '\t', 6),
    ("qtm.tsv", '\t', 11),
    ("vicon.csv", ',', 5),
    ("table-pixels.csv", ',', 1),
    ("table-spaces.txt", ' ', 2),
    ("cortex.trc", '\t', 6),
    ("vicon-objects.csv", ',', 5),
    ("sleap.csv", ',', 1),
    ("kinovea.txt", ' ', 3),
    ("kinovea.csv", ';', 1),
];
/// Places that each kind of damage is tried at.
const SEEDS: u64 = 6;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")
}

/// Options that a user must give for a sample, and no more: a rate overrides the file's own.
fn options(sample: &str) -> TrackOptions {
    TrackOptions {
        rate_hz: matches!(sample, s if s.starts_with("deeplabcut") || s.starts_with("sleap"))
            .then_some(50.0),
        ..TrackOptions::default()
    }
}

fn same_point(a: &TrackPoint, b: &TrackPoint) -> bool {
    (&a.name, a.kind) == (&b.name, b.kind)
}

/// `true` if every place of a point is one of the original's at the same time.
fn true_to(point: &TrackPoint, file: &TrackFile, other: &TrackPoint, original: &TrackFile) -> bool {
    // A unit that went missing leaves lengths as they stand in the file, and no poses are made of them.
    let metres = match (file.unit.metres(), original.unit.metres()) {
        (None, Some(metres)) => metres,
        _ => 1.0,
    };
    file.times.iter().enumerate().all(|(row, time)| {
        let Some(place) = point.position(row) else {
            return true;
        };
        let same_time = |t: &f64| (t - time).abs() < 1e-9;
        original
            .times
            .iter()
            .position(same_time)
            .and_then(|row| other.position(row))
            .is_some_and(|there| (there - place * metres).norm() < 1e-12)
    })
}

/// One letter for an outcome: E error, s the same, p less and a warning says so, l less because whole lines are gone,
/// r right places under other names, ! wrong.
fn outcome(bytes: &[u8], sample: &str, original: &TrackFile, whole_lines: bool) -> char {
    let Ok(file) = read_tracks_with(bytes, Path::new("f"), &options(sample)) else {
        return 'E';
    };
    let places = |file: &TrackFile| file.points.iter().map(TrackPoint::present).sum::<usize>();
    let mut renamed = false;
    for point in file.points.iter().filter(|point| point.present() > 0) {
        let mut by_name = original.points.iter().filter(|p| same_point(p, point));
        if by_name.any(|other| true_to(point, &file, other, original)) {
            continue;
        }
        let anyone = original
            .points
            .iter()
            .any(|other| true_to(point, &file, other, original));
        if !anyone || original.points.iter().any(|p| same_point(p, point)) {
            return '!';
        }
        renamed = true;
    }
    if file.unit.metres() != original.unit.metres() && file.unit.metres().is_some() {
        // Read as a plain table in metres: poses will miss the reflectors' distance.
        return 'r';
    }
    let less = places(&file) < places(original) || file.frames() < original.frames();
    match (renamed, less) {
        (true, _) => 'r',
        (false, false) => 's',
        (false, true) if file.warnings != original.warnings => 'p',
        (false, true) if whole_lines => 'l',
        (false, true) => '!',
    }
}

#[test]
fn damage_is_told_and_never_read_as_truth() {
    let mut table = String::new();
    let mut wrong = Vec::new();
    for (index, (sample, ..)) in SAMPLES.iter().enumerate() {
        writeln!(table, "{:>2} {sample}", index + 1).unwrap();
    }
    for (kind, (name, damage)) in (0_u64..).zip(DAMAGES) {
        write!(table, "\n{name:<30}").unwrap();
        for (index, (sample, delimiter, header)) in SAMPLES.iter().enumerate() {
            let path = folder().join("formats").join(sample);
            let bytes = std::fs::read(&path).unwrap();
            let original = read_tracks_with(bytes.as_slice(), &path, &options(sample)).unwrap();
            let text = Text {
                lines: String::from_utf8(bytes)
                    .unwrap()
                    .split_inclusive('\n')
                    .map(str::to_owned)
                    .collect(),
                header: *header,
                delimiter: *delimiter,
            };
            let mut outcomes = BTreeSet::new();
            for seed in 0..SEEDS {
                let seed = seed + 100 * (index as u64 + 100 * kind);
                let damaged = damage(&mut ChaCha8Rng::seed_from_u64(seed), text.clone());
                // Whole lines that are gone leave nothing to notice.
                // So does a cut right behind the last digit of a line.
                let last = damaged.rsplit(|byte| *byte == b'\n').next().unwrap_or(&[]);
                let ends = |line: &String| line.trim_end().as_bytes() == last;
                let at_end = last.is_empty() || text.lines.iter().any(ends);
                let whole = at_end && (name.starts_with("cut") || name == "row lost");
                let letter = outcome(&damaged, sample, &original, whole);
                if letter == '!' {
                    wrong.push(format!(
                        "{name}, {sample}, seed {seed}:\n{}",
                        String::from_utf8_lossy(&damaged[..damaged.len().min(3000)])
                    ));
                }
                outcomes.insert(letter);
            }
            let letters: String = outcomes.into_iter().collect();
            write!(table, " {letters:<4}").unwrap();
        }
    }
    let table: String = table
        .lines()
        .map(|line| line.trim_end().to_owned() + "\n")
        .collect();
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}\n{table}",
        wrong.len(),
        wrong.join("\n")
    );
    let golden = folder().join("campaigns/mutilated/outcomes.txt");
    if std::env::var_os("UPDATE_OUTCOMES").is_some() {
        std::fs::write(&golden, &table).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap_or_default();
    assert!(
        table == expected,
        "outcomes changed; look at them, then run with UPDATE_OUTCOMES=1:\n{table}"
    );
}

/// A stream that is made up while it is read: a head, then one row after another, with a marker that comes and goes.
struct Endless {
    pending: Vec<u8>,
    row: u64,
    rows: u64,
}

impl Read for Endless {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.pending.is_empty() && self.row < self.rows {
            for _ in 0..100 {
                let (row, blank) = (self.row, ",".repeat(2999));
                let text = format!(
                    "{row},{:.6},1.000000,0.050000,{row}.5{blank}\n",
                    row as f64 / 100.0
                );
                self.pending.extend(text.bytes());
                self.row += 1;
            }
        }
        let count = out.len().min(self.pending.len());
        for (to, from) in out.iter_mut().zip(self.pending.drain(..count)) {
            *to = from;
        }
        Ok(count)
    }
}

/// Peak memory of this process \[bytes\], if the system reports it.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

#[test]
fn memory_grows_with_places_and_not_with_bytes() {
    let markers = 1000;
    let row = |cell: &dyn Fn(usize) -> String| {
        (0..3 * markers)
            .map(|i| ",".to_owned() + &cell(i))
            .collect::<String>()
    };
    let head = format!(
        "Format Version,1.23,Export Frame Rate,100,Length Units,Meters\n\n,Type{}\n,Name{}\n,{}\nFrame,Time{}\n",
        row(&|_| "Marker".into()),
        row(&|i| format!("Unlabeled {}", i / 3)),
        row(&|_| "Position".into()),
        row(&|i| ["X", "Y", "Z"][i % 3].into())
    );
    let rows = 60_000;
    let stream = Endless {
        pending: head.into_bytes(),
        row: 0,
        rows,
    };
    let before = peak();
    let file = read_tracks_with(stream, Path::new("endless"), &TrackOptions::default()).unwrap();
    assert_eq!((file.frames() as u64, file.points.len()), (rows, markers));
    assert_eq!(file.points[0].present() as u64, rows);
    assert_eq!(file.points[999].present(), 0);
    let (Some(before), Some(after)) = (before, peak()) else {
        eprintln!("SKIPPED: this system does not tell a process's peak memory");
        return;
    };
    // 180 MB of text; 60 000 places, frame numbers and times are 2.4 MB.
    assert!(after - before < 24 << 20, "{} MB", (after - before) >> 20);
}

#[test]
fn a_gigabyte_in_one_line_is_refused_at_once() {
    let stream = io::repeat(b'1').take(1 << 30);
    let error = read_tracks_with(stream, Path::new("f"), &TrackOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "f:1:1: this line is longer than 4 MiB; no tracking file has such lines"
    );
    let later = b"t,x,y\n0,1,2\n".chain(io::repeat(b'1').take(1 << 30));
    let error = read_tracks_with(later, Path::new("f"), &TrackOptions::default()).unwrap_err();
    assert!(
        error.to_string().starts_with("f:3:1: this line is longer"),
        "{error}"
    );
    let breaks = io::BufReader::new(Breaks).take(1 << 20);
    let error = read_tracks_with(breaks, Path::new("f"), &TrackOptions::default()).unwrap_err();
    assert!(error.to_string().contains("the cable fell out"), "{error}");
}

struct Breaks;

impl Read for Breaks {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::Error::other("the cable fell out"))
    }
}
