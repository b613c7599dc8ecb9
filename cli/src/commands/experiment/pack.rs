//! `swimmer experiment pack`: one archive that another laboratory or a journal can take.

use std::fmt::{self, Write as _};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use swimmer_files::{hash_of, stream_atomically};
use tar::{Builder, Header};

use super::folder::Folder;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::{Output, document};

/// List of the checksums in the archive, which `sha256sum -c` reads.
const CHECKSUMS: &str = "SHA256SUMS";
/// Origin of the archive.
const PROVENANCE: &str = "provenance.json";
/// Deepest folder that is packed.
const DEEPEST: usize = 8;

/// Pack an experiment into one archive: data, logs, swimmer file, plan, provenance, SHA-256 checksums
///
/// The archive is a gzipped tar; `sha256sum -c SHA256SUMS` checks what comes out of it. The same folder gives the same bytes.
#[derive(Debug, clap::Args)]
pub(crate) struct Pack {
    /// Folder of an experiment
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Archive; left out: DIR.tar.gz
    #[arg(short, long, value_name = "FILE.tar.gz")]
    output: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct PackOutput {
    archive: String,
    files: usize,
    bytes: u64,
    sha256: String,
}

#[derive(Debug, Serialize)]
struct Provenance {
    made_by: String,
    plan_sha256: String,
    spec_sha256: String,
    seed: u64,
    runs: usize,
    done: usize,
}

/// File of the archive: its path inside and its SHA-256.
struct Packed {
    name: String,
    sha256: String,
}

impl Pack {
    pub(super) fn run(self, output: Output) -> Outcome {
        let folder = Folder::load(&self.folder)?;
        let archive = match self.output {
            Some(archive) => archive,
            None => of_folder(&self.folder)?,
        };
        may_be_written(&archive)?;
        let journal = folder.journal()?;
        let mut names = Vec::new();
        files_in(&self.folder, Path::new(""), 0, &mut names)?;
        names.sort();
        let packed = names.into_iter().map(|name| {
            let sha256 = hash_of(&self.folder.join(&name))?;
            Ok(Packed { name, sha256 })
        });
        let packed: Vec<Packed> = packed.collect::<Outcome<_>>()?;
        let provenance = document(&Provenance {
            made_by: format!("swimmer {}", env!("CARGO_PKG_VERSION")),
            plan_sha256: folder.plan.sha256(),
            spec_sha256: folder.plan.spec_sha256.clone(),
            seed: folder.plan.seed,
            runs: folder.plan.trials.len(),
            done: journal.finished().len(),
        });
        let root = self.folder.canonicalize().ok();
        let root = root.as_deref().and_then(Path::file_name);
        let root = root.map_or_else(|| "experiment".into(), |name| name.to_string_lossy());
        stream_atomically(&archive, |file| {
            let encoder = GzEncoder::new(file, Compression::default());
            let mut tar = Builder::new(encoder);
            let mut checksums = String::new();
            for Packed { name, sha256 } in &packed {
                let mut data = File::open(self.folder.join(name))?;
                let mut header = header(data.metadata()?.len());
                tar.append_data(&mut header, format!("{root}/{name}"), &mut data)?;
                // Writing to a String cannot fail.
                let _ = writeln!(checksums, "{sha256}  {name}");
            }
            for (name, text) in [(PROVENANCE, &provenance), (CHECKSUMS, &checksums)] {
                let mut header = header(text.len() as u64);
                tar.append_data(&mut header, format!("{root}/{name}"), text.as_bytes())?;
            }
            tar.into_inner()?.finish()?.flush()
        })?;
        let bytes = std::fs::metadata(&archive).map_or(0, |data| data.len());
        output.print(&PackOutput {
            sha256: hash_of(&archive)?,
            archive: archive.display().to_string(),
            files: packed.len(),
            bytes,
        });
        Ok(())
    }
}

/// Head of a file, without owner and times: the same data give the same bytes.
fn header(size: u64) -> Header {
    let mut header = Header::new_gnu();
    header.set_size(size);
    header.set_mode(0o644);
    header.set_mtime(0);
    header
}

fn of_folder(folder: &Path) -> Outcome<PathBuf> {
    let named = folder.file_name().is_some();
    let mut name = folder.as_os_str().to_owned();
    name.push(".tar.gz");
    named.then(|| PathBuf::from(name)).ok_or_else(|| {
        Failure::BadInput(format!(
            "{} has no name to call the archive by; name it with -o FILE.tar.gz",
            folder.display()
        ))
    })
}

/// Every file in a folder, without hidden ones, by its path with `/` between folders.
fn files_in(root: &Path, inner: &Path, depth: usize, names: &mut Vec<String>) -> Outcome {
    let folder = root.join(inner);
    let failed = |error: std::io::Error| {
        Failure::Tried(format!("cannot read {}: {error}", folder.display()))
    };
    if depth > DEEPEST {
        return Err(Failure::BadInput(format!(
            "{} is nested more than {DEEPEST} folders deep; pack the folder of an experiment",
            folder.display()
        )));
    }
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name();
        if name.to_string_lossy().starts_with('.') {
            continue;
        }
        let path = inner.join(&name);
        let kind = entry.file_type().map_err(failed)?;
        if kind.is_dir() {
            files_in(root, &path, depth + 1, names)?;
        } else if kind.is_file() {
            let parts: Vec<_> = path
                .components()
                .map(|part| part.as_os_str().to_string_lossy().into_owned())
                .collect();
            names.push(parts.join("/"));
        }
    }
    Ok(())
}

impl fmt::Display for PackOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {} files, {:.1} MB, SHA-256 {}",
            self.archive,
            self.files,
            self.bytes as f64 / 1e6,
            self.sha256
        )
    }
}
