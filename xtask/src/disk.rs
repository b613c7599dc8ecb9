//! Files and folders, with errors that name them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};

/// Failure of an operation on a path.
pub(crate) fn failed(doing: &str, path: &Path, why: io::Error) -> Failure {
    Failure::new(
        format!("{doing} {}", path.display()),
        why,
        "check that the path is right, writable, and on a disk with space left",
    )
}

/// Creates a folder and its missing parents.
pub(crate) fn make_folder(path: &Path) -> Outcome {
    fs::create_dir_all(path).map_err(|why| failed("making the folder", path, why))
}

/// Removes a folder with its content; a missing folder is no error.
pub(crate) fn remove_folder(path: &Path) -> Outcome {
    match fs::remove_dir_all(path) {
        Err(why) if why.kind() != io::ErrorKind::NotFound => Err(failed("removing", path, why)),
        _ => Ok(()),
    }
}

/// Removes a file; a missing file is no error.
pub(crate) fn remove_file(path: &Path) -> Outcome {
    match fs::remove_file(path) {
        Err(why) if why.kind() != io::ErrorKind::NotFound => Err(failed("removing", path, why)),
        _ => Ok(()),
    }
}

/// Writes a file and creates its folder.
pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> Outcome {
    if let Some(folder) = path.parent() {
        make_folder(folder)?;
    }
    fs::write(path, content).map_err(|why| failed("writing", path, why))
}

/// Reads a whole file.
pub(crate) fn read_bytes(path: &Path) -> Outcome<Vec<u8>> {
    fs::read(path).map_err(|why| failed("reading", path, why))
}

/// Copies one file.
pub(crate) fn copy(from: &Path, to: &Path) -> Outcome {
    fs::copy(from, to)
        .map(drop)
        .map_err(|why| failed("copying to", to, why))
}

/// Copies all files of a folder and of those in it.
pub(crate) fn copy_folder(from: &Path, to: &Path) -> Outcome {
    for file in files_below(from)? {
        let copied = to.join(file.strip_prefix(from).unwrap_or(&file));
        copied.parent().map_or(Ok(()), make_folder)?;
        copy(&file, &copied)?;
    }
    Ok(())
}

/// Sorted paths of all files in a folder and in those in it.
pub(crate) fn files_below(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in entries(folder, |_| true)? {
        if entry.is_dir() {
            files.extend(files_below(&entry)?);
        } else {
            files.push(entry);
        }
    }
    Ok(files)
}

/// Sorted entries of a folder whose names satisfy `fits`.
pub(crate) fn entries(folder: &Path, fits: impl Fn(&str) -> bool) -> Outcome<Vec<PathBuf>> {
    let all = fs::read_dir(folder).map_err(|why| failed("listing", folder, why))?;
    let mut paths: Vec<_> = all
        .flatten()
        .filter(|entry| entry.file_name().to_str().is_some_and(&fits))
        .map(|entry| entry.path())
        .collect();
    paths.sort();
    Ok(paths)
}
