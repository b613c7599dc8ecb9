//! Whole files or none: written next to their place and renamed into it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::FileError;

/// Longest chain of symbolic links that is followed, as the kernel's.
const LONGEST_CHAIN: usize = 40;

/// Writes a file so that a reader sees either what was there before or all of `bytes`, never a part.
///
/// The bytes go to a temporary file in the same folder, are flushed to the disk, and the file is renamed into place. A
/// missing folder is made. A symbolic link stays, and what it leads to is replaced. A device or a pipe stays too, and is
/// written to: there is nothing in it that could be half new.
///
/// # Errors
/// [`FileError::Write`] when the folder cannot be made or written to, or `path` is a folder; the temporary file is removed.
///
/// ```
/// use swimmer_files::write_atomically;
///
/// # let path = std::env::temp_dir().join(format!("atomic-{}", std::process::id()));
/// write_atomically(&path, b"all of it")?;
/// write_atomically(&path, b"and all of this")?;
/// assert_eq!(std::fs::read(&path).unwrap(), b"and all of this");
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let fail = |source| FileError::Write {
        path: path.to_path_buf(),
        source,
    };
    match destination(path).map_err(fail)? {
        Destination::Stream => OpenOptions::new()
            .write(true)
            .open(path)
            .and_then(|mut stream| stream.write_all(bytes))
            .map_err(fail),
        Destination::File(place) => replace(&place, bytes).map_err(fail),
    }
}

/// [`write_atomically`] for large contents: `write` receives the temporary file, which replaces the target when it is complete.
///
/// # Errors
/// As [`write_atomically`], and whatever `write` says; nothing is left behind then.
///
/// ```
/// use std::io::Write as _;
/// use swimmer_files::stream_atomically;
///
/// # let path = std::env::temp_dir().join(format!("streamed-{}", std::process::id()));
/// stream_atomically(&path, |file| (0..1000).try_for_each(|row| writeln!(file, "{row}")))?;
/// assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 1000);
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
pub fn stream_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let through = |file: File| {
        let mut buffered = BufWriter::new(file);
        write(&mut buffered)?;
        buffered.flush()
    };
    match destination(path) {
        Ok(Destination::Stream) => OpenOptions::new().write(true).open(path).and_then(through),
        Ok(Destination::File(place)) => replace_with(&place, through),
        Err(error) => Err(error),
    }
    .map_err(|source| FileError::Write {
        path: path.to_path_buf(),
        source,
    })
}

fn replace(place: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_with(place, |mut file| file.write_all(bytes))
}

fn replace_with(place: &Path, write: impl FnOnce(File) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(place)?;
    let mut name = std::ffi::OsString::from(".");
    name.push(place.file_name().unwrap_or_default());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&name).suffix(".partial");
    // The umask takes its share, as of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder)?;
    write(temporary.as_file().try_clone()?)?;
    temporary.as_file().sync_all()?;
    temporary.persist(place)?;
    Ok(())
}

/// Returns the folder of a file, and makes it if it is missing.
pub(crate) fn folder_of(place: &Path) -> io::Result<&Path> {
    match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => {
            fs::create_dir_all(folder)?;
            Ok(folder)
        }
        _ => Ok(Path::new(".")),
    }
}

/// Kind of target of a path to write.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Destination {
    /// A file, there or not yet, under the name that no symbolic link stands at.
    File(PathBuf),
    /// A device, pipe or socket, which no file may take the place of.
    Stream,
}

/// Resolves `path` for writing: a rename would replace the symbolic link or the device itself.
pub(crate) fn destination(path: &Path) -> io::Result<Destination> {
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => {
            return Err(io::Error::new(
                io::ErrorKind::IsADirectory,
                "it is a folder; name a file",
            ));
        }
        Ok(there) if !there.is_file() => return Ok(Destination::Stream),
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let mut place = path.to_path_buf();
    for _ in 0..LONGEST_CHAIN {
        match fs::read_link(&place) {
            // The target of a link is relative to the link's own folder.
            Ok(target) => place = place.with_file_name("").join(target),
            Err(_) => break,
        }
    }
    Ok(Destination::File(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_and_leaves_nothing_beside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/gait.txt");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(
            std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
            1
        );
    }

    #[test]
    fn a_failure_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        // A folder stands where the file should go.
        let path = folder.path().join("taken");
        std::fs::create_dir_all(path.join("inside")).unwrap();
        let refused = write_atomically(&path, b"x").unwrap_err();
        assert!(
            matches!(&refused, FileError::Write { source, .. } if source.to_string().contains("it is a folder")),
            "{refused}"
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt as _;

        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| {
            let there = std::fs::metadata(folder.path().join(name)).unwrap();
            there.permissions().mode()
        };
        std::fs::write(folder.path().join("plain"), "x").unwrap();
        write_atomically(&folder.path().join("whole"), b"x").unwrap();
        assert_eq!(mode("whole"), mode("plain"));
    }

    #[test]
    fn threads_that_write_one_file_leave_one_of_their_texts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shared");
        std::thread::scope(|scope| {
            for byte in b"ab" {
                scope.spawn(|| {
                    for _ in 0..50 {
                        write_atomically(&path, &vec![*byte; 100_000]).unwrap();
                    }
                });
            }
        });
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes.len(), 100_000);
        assert!(bytes.iter().all(|byte| *byte == bytes[0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_and_what_it_leads_to_is_replaced() {
        use std::os::unix::fs::symlink;

        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("data")).unwrap();
        std::fs::write(at("data/one.csv"), "old").unwrap();
        symlink("data/one.csv", at("inner")).unwrap();
        symlink("inner", at("outer")).unwrap();
        symlink("data/new.csv", at("dangling")).unwrap();
        write_atomically(&at("outer"), b"new").unwrap();
        write_atomically(&at("dangling"), b"made").unwrap();
        for link in ["inner", "outer", "dangling"] {
            assert!(at(link).is_symlink(), "{link}");
        }
        assert_eq!(std::fs::read(at("data/one.csv")).unwrap(), b"new");
        assert_eq!(std::fs::read(at("data/new.csv")).unwrap(), b"made");
        assert_eq!(std::fs::read_dir(at("data")).unwrap().count(), 2);

        symlink("round", at("round")).unwrap();
        write_atomically(&at("round"), b"x").unwrap_err();
        assert!(at("round").is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_never_replaced() {
        use std::os::unix::fs::FileTypeExt as _;

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let _socket = std::os::unix::net::UnixListener::bind(&path).unwrap();
        // A socket cannot be opened as a file.
        write_atomically(&path, b"x").unwrap_err();
        assert!(std::fs::metadata(&path).unwrap().file_type().is_socket());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
