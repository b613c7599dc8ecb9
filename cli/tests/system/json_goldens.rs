//! JSON documents of the commands, compared with those kept under `tests/golden/json`.
//!
//! `SWIMMER_JSON=overwrite cargo test -p swimmer --test system json_goldens` writes the documents anew. `git diff` then shows
//! every digit that changed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::binary::typed;

mod table;

use table::{Command, Session};

/// Numbers may differ by this share of the larger one. The C library has other sines on processors without fused
/// multiplication and addition: `GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA` runs these tests as such a processor does.
const RELATIVE: f64 = 1e-8;

/// Numbers may differ by this much whatever their size.
const ABSOLUTE: f64 = 1e-10;

/// Numbers under these keys may differ by [`ABSOLUTE_IF_ROUGH`]: those that measure errors or are in units of them, and the
/// paper's rows, some of which are places of flat maxima and so known to half the digits.
const ROUGH: [&str; 7] = [
    "deviation",
    "ours",
    "power_variation",
    "pull",
    "residual",
    "tolerance",
    "value",
];
const ABSOLUTE_IF_ROUGH: f64 = 1e-7;

/// Keys of times that the run took, of sizes and hashes of files that hold rounded numbers, and of what a version changes.
const FILTERED: [&str; 10] = [
    "bytes",
    "cold_s",
    "design_s",
    "firmware",
    "predicted_seconds",
    "robot_time_s",
    "schema_key",
    "seconds",
    "sha256",
    "warm_s",
];

#[test]
fn documents_are_those_kept() {
    compare(table::SESSIONS);
}

#[test]
#[ignore = "half a minute: `cargo xtask soak long_documents`"]
fn long_documents_are_those_kept() {
    compare(table::LONG_SESSIONS);
}

fn compare(sessions: &[Session]) {
    let overwrite = std::env::var("SWIMMER_JSON").is_ok_and(|value| value == "overwrite");
    let next = AtomicUsize::new(0);
    let differences = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(session) = sessions.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let found = run(session, overwrite);
                    differences.lock().unwrap().extend(found);
                }
            });
        }
    });
    let differences = differences.into_inner().unwrap();
    assert!(
        differences.is_empty(),
        "{} of the documents differ from those kept:\n\n{}\n\nSWIMMER_JSON=overwrite writes them anew",
        differences.len(),
        differences.join("\n\n")
    );
}

#[test]
fn every_kept_document_has_its_command() {
    let mut kept = Vec::new();
    for folder in fs::read_dir(golden("")).unwrap() {
        for file in fs::read_dir(folder.unwrap().path()).unwrap() {
            kept.push(file.unwrap().path());
        }
    }
    let mut named: Vec<_> = (table::SESSIONS.iter().chain(table::LONG_SESSIONS))
        .flat_map(|session| {
            session
                .commands
                .iter()
                .map(|command| document(session, command))
        })
        .collect();
    kept.sort();
    named.sort();
    assert_eq!(kept, named);
}

/// Runs the commands of a session; returns a text for each document that is not the kept one.
fn run(session: &Session, overwrite: bool) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    if let Some(files) = session.files {
        copy(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join(files),
            folder.path(),
        );
    }
    let mut differences = Vec::new();
    for command in session.commands {
        let line = format!("{} --json", command.words);
        let ran = typed(folder.path(), &line).with_status(command.status);
        let _ = ran.json();
        let printed = filtered(&ran.stdout, folder.path(), command.times);
        let path = document(session, command);
        if overwrite {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, &printed).unwrap();
        } else {
            let kept = fs::read_to_string(&path).unwrap_or_default();
            if let Some(difference) = difference(&kept, &printed) {
                differences.push(format!("swimmer {line}\n{}: {difference}", path.display()));
            }
        }
    }
    differences
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden/json")
        .join(name)
}

fn document(session: &Session, command: &Command) -> PathBuf {
    golden(session.name).join(format!("{}.json", command.document))
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

/// The document with paths of this machine and values of [`FILTERED`] keys and of `times` replaced.
fn filtered(text: &str, folder: &Path, times: &[&str]) -> String {
    let text = text.replace(folder.to_str().unwrap(), "[folder]");
    let filter = |line: &str| {
        let JsonLine { before, value } = JsonLine::of(line);
        match JsonLine::of(line).key() {
            Some(key)
                if (FILTERED.contains(&key) || times.contains(&key))
                    && !value.starts_with(['{', '[']) =>
            {
                let comma = if line.ends_with(',') { "," } else { "" };
                format!("{before}\"[{key}]\"{comma}\n")
            }
            _ => format!("{line}\n"),
        }
    };
    text.lines().map(filter).collect()
}

/// First line in which two documents differ, with both texts. Returns `None` if they are equal.
fn difference(kept: &str, printed: &str) -> Option<String> {
    let (kept, printed): (Vec<_>, Vec<_>) = (kept.lines().collect(), printed.lines().collect());
    let at =
        (0..kept.len().max(printed.len())).find(|&at| match (kept.get(at), printed.get(at)) {
            (Some(kept), Some(printed)) => !agree(kept, printed),
            _ => true,
        })?;
    let line = |lines: &[&str]| {
        lines
            .get(at)
            .map_or("[no such line]", |line| line.trim())
            .to_owned()
    };
    Some(format!(
        "line {}\n  kept     {}\n  printed  {}",
        at + 1,
        line(&kept),
        line(&printed)
    ))
}

/// Compares two lines of indented JSON.
fn agree(kept: &str, printed: &str) -> bool {
    let (kept, printed) = (JsonLine::of(kept), JsonLine::of(printed));
    let is_rough = kept.key().is_some_and(|key| ROUGH.contains(&key));
    let absolute = if is_rough {
        ABSOLUTE_IF_ROUGH
    } else {
        ABSOLUTE
    };
    kept.before == printed.before
        && match (kept.fraction(), printed.fraction()) {
            (Some(a), Some(b)) => (a - b).abs() <= RELATIVE * a.abs().max(b.abs()) + absolute,
            _ => kept.value == printed.value,
        }
}

/// A line of indented JSON, which holds at most one value.
struct JsonLine<'a> {
    /// Indentation and key.
    before: &'a str,
    /// Value without the comma behind it.
    value: &'a str,
}

impl<'a> JsonLine<'a> {
    fn of(line: &'a str) -> Self {
        let start = line
            .find("\": ")
            .map_or_else(|| line.len() - line.trim_start().len(), |at| at + 3);
        let (before, value) = line.split_at(start);
        let value = value.strip_suffix(',').unwrap_or(value);
        Self { before, value }
    }

    fn key(&self) -> Option<&'a str> {
        self.before.split('"').nth(1)
    }

    /// The value if it is a number that is not written as a whole one.
    fn fraction(&self) -> Option<f64> {
        let number = self.value.parse().ok()?;
        self.value.contains(['.', 'e']).then_some(number)
    }
}

#[test]
fn a_changed_key_digit_or_word_is_a_difference() {
    let kept = "{\n  \"a\": 1.25,\n  \"b\": [\n    1e-13\n  ],\n  \"c\": \"x\"\n}\n";
    assert_eq!(difference(kept, kept), None);
    assert_eq!(difference(kept, &kept.replace("1e-13", "3e-13")), None);
    assert_eq!(
        difference(kept, &kept.replace("1.25", "1.2500000001")),
        None
    );
    for (from, to) in [
        ("\"a\"", "\"d\""),
        ("1.25", "1.2500001"),
        ("1.25", "null"),
        ("\"x\"", "\"y\""),
        ("1e-13", "1e-13,\n    0.0"),
        ("  \"c\": \"x\"\n", ""),
    ] {
        let changed = kept.replace(from, to);
        assert!(difference(kept, &changed).is_some(), "{changed}");
    }
}
