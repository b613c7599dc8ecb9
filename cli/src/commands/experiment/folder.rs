//! Folder of an experiment: spec, swimmer, plan, gaits, journal, tracks, logs, report.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use experiment::unattended::{Entry, Journal, JournalError, Plan, PlannedGait, Spec};
use swimmer_files::{AnyGait, GaitFile, SwimmerFile, write_atomically};

use super::ExperimentPaths;
use crate::failure::{Failure, Outcome};

pub(super) const SPEC: &str = "spec.toml";
pub(super) const SWIMMER: &str = "swimmer.toml";
pub(super) const PLAN: &str = "plan.json";
pub(super) const JOURNAL: &str = "journal.jsonl";
pub(super) const DRIVE: &str = "drive";
pub(super) const REPORT: &str = "report.json";
/// Campaign of the finished trials.
pub(super) const CAMPAIGN: &str = "campaign.toml";
pub(super) const PAGE: &str = "report.html";

/// Planned experiment.
pub(super) struct Folder {
    pub(super) path: PathBuf,
    pub(super) spec: Spec,
    pub(super) plan: Plan,
    pub(super) swimmer: SwimmerFile,
}

/// Writes the plan of an experiment.
///
/// # Errors
/// As the disk.
pub(super) fn write_plan(path: &Path, plan: &Plan) -> Outcome {
    let text = serde_json::to_string_pretty(plan).map_err(|error| Failure::tried(&error))?;
    Ok(write_atomically(path, (text + "\n").as_bytes())?)
}

impl Folder {
    /// Opens the folder of a spec.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if it is not planned, or the spec has changed since.
    pub(super) fn of(paths: &ExperimentPaths) -> Outcome<Self> {
        let path = paths.folder();
        let shown = paths.spec.display();
        let text = read(&paths.spec)?;
        let folder = Self::load(&path)?;
        let now = Spec::parse(&text, &paths.spec)?;
        if now != folder.spec {
            return Err(Failure::BadInput(format!(
                "{shown} has changed since {} was planned: plan it into a new folder (-o DIR), or restore it from {}",
                path.display(),
                path.join(SPEC).display()
            )));
        }
        Ok(folder)
    }

    /// Opens a folder without its original spec.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if it is no planned experiment.
    pub(super) fn load(path: &Path) -> Outcome<Self> {
        let plan_path = path.join(PLAN);
        if !plan_path.is_file() {
            return Err(Failure::BadInput(format!(
                "{} holds no planned experiment; make one with `swimmer experiment plan SPEC.toml`",
                path.display()
            )));
        }
        let bad = |problem: String| {
            Failure::BadInput(format!("{}: {problem}; plan anew", plan_path.display()))
        };
        let plan: Plan =
            serde_json::from_str(&read(&plan_path)?).map_err(|error| bad(error.to_string()))?;
        if let Some(problem) = plan.problem() {
            return Err(bad(problem));
        }
        let mut folder = Self {
            spec: Spec::load(&path.join(SPEC))?,
            swimmer: SwimmerFile::load(&path.join(SWIMMER))?,
            plan,
            path: path.to_path_buf(),
        };
        if folder.plan.adaptive.is_some() {
            let journal = folder.journal()?;
            folder.plan = folder.plan.with_chosen(&journal);
        }
        Ok(folder)
    }

    /// Curve of a gait.
    ///
    /// # Errors
    /// If its file cannot be read.
    pub(super) fn curve(&self, gait: &PlannedGait) -> Outcome<AnyGait> {
        let path = self.path.join(&gait.file);
        let file = GaitFile::load(&path)?;
        AnyGait::from_file(&file)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
    }

    /// Events so far, without a lock.
    ///
    /// # Errors
    /// If the journal cannot be read, or is damaged.
    pub(super) fn journal(&self) -> Outcome<Journal> {
        let path = self.path.join(JOURNAL);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(source) => return Err(swimmer_files::FileError::Read { path, source }.into()),
        };
        self.checked(&bytes)
    }

    fn checked(&self, bytes: &[u8]) -> Outcome<Journal> {
        let journal = Journal::parse(bytes)?;
        journal.check(&self.plan)?;
        Ok(journal)
    }
}

/// Journal that is open for appending, by this process alone.
pub(super) struct JournalFile {
    path: PathBuf,
    file: File,
}

impl JournalFile {
    /// Opens the journal, removes a line that a crash cut off, and returns the events so far.
    ///
    /// # Errors
    /// If another process has it, or it is damaged.
    pub(super) fn open(folder: &Folder) -> Outcome<(Self, Journal)> {
        let path = folder.path.join(JOURNAL);
        let failed = |error: std::io::Error| {
            Failure::Tried(format!("cannot open {}: {error}", path.display()))
        };
        let mut file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&path)
            .map_err(failed)?;
        if file.try_lock().is_err() {
            return Err(Failure::Tried(format!(
                "another `swimmer experiment run` is at work in {}; wait for its end",
                folder.path.display()
            )));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let journal = folder.checked(&bytes)?;
        file.set_len(journal.valid_bytes as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok((Self { path, file }, journal))
    }

    /// Appends an event, and waits until it is on the disk.
    ///
    /// # Errors
    /// If the disk refuses.
    pub(super) fn append(&mut self, entry: &Entry) -> Outcome {
        let line = Journal::line(unix_s(), entry);
        let written = self
            .file
            .write_all(&line)
            .and_then(|()| self.file.sync_data());
        written.map_err(|error| {
            Failure::Tried(format!(
                "cannot write {}: {error}; free some space, then run again",
                self.path.display()
            ))
        })
    }
}

fn unix_s() -> f64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    (now.unwrap_or_default().as_secs_f64() * 1e3).round() / 1e3
}

pub(super) fn read(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path).map_err(|source| {
        swimmer_files::FileError::Read {
            path: path.to_path_buf(),
            source,
        }
        .into()
    })
}

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Self {
        Self::bad_input(&error)
    }
}
