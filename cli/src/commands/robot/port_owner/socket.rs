//! Socket of a held port: its path, and the connection to it.

use std::fs::{self, DirBuilder};
use std::io;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use link_protocol::crc32c;

use super::super::port::fresh;

/// Acknowledgement of the holder, sent at once.
pub(super) const HEARD: &str = "heard";

/// Connects. Fails at once if the listener's queue is full, which means that it accepts nothing. (The standard library would wait
/// for that.)
pub(super) fn dial(path: &Path) -> io::Result<UnixStream> {
    use rustix::net::{AddressFamily, SocketAddrUnix, SocketType, connect, socket};
    let socket = socket(AddressFamily::UNIX, SocketType::STREAM, None)?;
    rustix::io::fcntl_setfd(&socket, rustix::io::FdFlags::CLOEXEC)?;
    rustix::io::ioctl_fionbio(&socket, true)?;
    connect(&socket, &SocketAddrUnix::new(path)?)?;
    let stream = UnixStream::from(socket);
    stream.set_nonblocking(false)?;
    Ok(stream)
}

/// `true` if a process listens there, busy or not.
pub(super) fn is_held(path: &Path) -> bool {
    match dial(path) {
        Ok(_) => true,
        Err(error) => error.kind() == io::ErrorKind::WouldBlock,
    }
}

/// Beside the socket: who listens.
pub(super) fn note(socket: &Path) -> PathBuf {
    socket.with_extension("holder")
}

/// A short name for a port, the same for all its aliases. A fresh virtual robot has no other user.
pub(super) fn socket_name(port: &str) -> Option<String> {
    if fresh(port).is_some() {
        return None;
    }
    let path = Path::new(port);
    let one_name = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let tail = one_name.file_name()?.to_str()?.replace(':', "-");
    let tail: String = tail.chars().take(32).collect();
    let number = crc32c(one_name.to_str()?.as_bytes());
    Some(format!("{tail}-{number:08x}.sock"))
}

/// Rights of all users but the owner.
const OTHERS: u32 = 0o077;

/// Folder of this user's sockets, which no other user may enter.
pub(super) fn folder() -> Option<PathBuf> {
    let (base, name) = match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(runtime) if Path::new(&runtime).is_dir() => {
            (PathBuf::from(runtime), "swimmer".to_owned())
        }
        _ => (
            std::env::temp_dir(),
            format!("swimmer-{}", rustix::process::getuid().as_raw()),
        ),
    };
    let folder = base.join(name);
    let _ = DirBuilder::new().mode(0o700).create(&folder);
    let metadata = fs::symlink_metadata(&folder).ok()?;
    let private = metadata.is_dir()
        && metadata.uid() == rustix::process::getuid().as_raw()
        && metadata.permissions().mode() & OTHERS == 0;
    private.then_some(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aliases_of_a_port_have_one_socket_and_a_fresh_robot_has_none() {
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("port");
        fs::write(&port, "").unwrap();
        let alias = folder.path().join("alias");
        std::os::unix::fs::symlink(&port, &alias).unwrap();
        let name = |path: &Path| socket_name(path.to_str().unwrap());
        assert!(name(&port).is_some());
        assert_eq!(name(&port), name(&alias));
        assert_ne!(socket_name("/dev/rfcomm0"), socket_name("/dev/rfcomm1"));
        assert_eq!(socket_name("twin"), None);
        assert_eq!(socket_name("emulator"), None);
    }
}
