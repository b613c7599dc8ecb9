//! The socket of a held port, at both ends.

use std::borrow::Cow;
use std::fmt;
use std::fs::{self, DirBuilder};
use std::io::{self, BufRead, BufReader, Write};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::ValueEnum;
use host_link::Robot;
use link_protocol::crc32c;

use super::super::port::{AnyPort, fresh};
use super::relay::{Ask, Relayed};
use crate::failure::{Failure, Outcome};

/// A process that asks and says nothing is not waited for.
const PATIENCE_WITH_ASKER: Duration = Duration::from_millis(50);
/// The robot's answer may need its five tries.
const PATIENCE_WITH_HOLDER: Duration = Duration::from_secs(15);

/// Holds the port, and hears what others ask.
pub(in super::super) struct Holder {
    open: Option<(UnixListener, PathBuf)>,
    asked: Vec<(Ask, UnixStream)>,
}

impl Holder {
    /// Makes known that this process has the port, as `command`. Where no socket can be made (a system without a place for
    /// it), the port is held all the same and others are only told that it is busy.
    pub(in super::super) fn announce(port: &str, command: &str) -> Self {
        Self::announce_in(folder().as_deref(), port, command)
    }

    fn announce_in(folder: Option<&Path>, port: &str, command: &str) -> Self {
        let open = folder
            .zip(socket_name(port))
            .map(|(folder, name)| folder.join(name))
            .and_then(|path| Some((listen(&path, command).ok()?, path)));
        Self {
            open,
            asked: Vec::new(),
        }
    }

    /// Whether somebody waits for something.
    pub(in super::super) fn asked(&mut self) -> bool {
        if let Some((listener, _)) = &self.open {
            while let Ok((stream, _)) = listener.accept() {
                if let Some(ask) = hear(&stream) {
                    self.asked.push((ask, stream));
                }
            }
        }
        !self.asked.is_empty()
    }

    /// Does all that was asked, the most urgent first.
    pub(in super::super) fn serve(&mut self, robot: &mut Robot<AnyPort>) {
        if !self.asked() {
            return;
        }
        self.asked.sort_by_key(|(ask, _)| *ask as u8);
        for (ask, mut stream) in self.asked.drain(..) {
            let answer = ask.of(robot);
            // Whoever asked may have gone; what was asked is done.
            let _ = serde_json::to_string(&answer)
                .map_err(io::Error::other)
                .and_then(|line| writeln!(stream, "{line}"));
        }
    }
}

impl Drop for Holder {
    fn drop(&mut self) {
        if let Some((_, path)) = &self.open {
            let _ = fs::remove_file(path);
            let _ = fs::remove_file(note(path));
        }
    }
}

fn hear(stream: &UnixStream) -> Option<Ask> {
    stream.set_nonblocking(false).ok()?;
    stream.set_read_timeout(Some(PATIENCE_WITH_ASKER)).ok()?;
    stream.set_write_timeout(Some(PATIENCE_WITH_ASKER)).ok()?;
    let mut line = String::new();
    BufReader::new(stream).read_line(&mut line).ok()?;
    Ask::from_str(line.trim(), false).ok()
}

/// Listens at `path`, in place of a socket that nobody listens at any more.
fn listen(path: &Path, command: &str) -> io::Result<UnixListener> {
    if UnixStream::connect(path).is_err() {
        let _ = fs::remove_file(path);
    }
    fs::write(note(path), format!("{command}\n{}", std::process::id()))?;
    let listener = UnixListener::bind(path)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Another `swimmer` that has the port.
#[derive(Debug)]
pub(in super::super) struct HeldBy {
    port: String,
    socket: PathBuf,
    command: String,
    process: String,
}

impl HeldBy {
    /// Who has the port, where it is a `swimmer` of this user.
    pub(in super::super) fn of(port: &str) -> Option<Self> {
        Self::of_in(&folder()?, port)
    }

    fn of_in(folder: &Path, port: &str) -> Option<Self> {
        let socket = folder.join(socket_name(port)?);
        // Only a living process takes the connection.
        UnixStream::connect(&socket).ok()?;
        let told = fs::read_to_string(note(&socket)).unwrap_or_default();
        let mut told = told.lines();
        Some(Self {
            port: port.to_owned(),
            socket,
            command: told.next().unwrap_or("swimmer").to_owned(),
            process: told.next().unwrap_or("unknown").to_owned(),
        })
    }

    /// Has it done. `None`: the other process ended meanwhile, and the port is free.
    ///
    /// # Errors
    /// [`Failure::Tried`] with the robot's or the link's word, or when the other process does not answer.
    pub(in super::super) fn ask(&self, ask: Ask) -> Outcome<Option<Relayed>> {
        let Some(word) = ask.to_possible_value() else {
            return Ok(None);
        };
        let talk = || -> io::Result<String> {
            let mut stream = UnixStream::connect(&self.socket)?;
            stream.set_read_timeout(Some(PATIENCE_WITH_HOLDER))?;
            writeln!(stream, "{}", word.get_name())?;
            let mut line = String::new();
            BufReader::new(stream).read_line(&mut line)?;
            Ok(line)
        };
        match talk() {
            Ok(line) if line.is_empty() => Ok(None),
            Ok(line) => match serde_json::from_str::<Relayed>(&line) {
                Ok(relayed) if relayed.done => Ok(Some(relayed)),
                Ok(relayed) => Err(Failure::Tried(relayed.text)),
                Err(error) => Err(Failure::Tried(format!(
                    "`{}` (process {}), which has the port {} open, answers nonsense ({error}); end it and try again",
                    self.command, self.process, self.port
                ))),
            },
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) =>
            {
                Err(Failure::Tried(format!(
                    "`{}` (process {}) has the port {} open and does not answer; end it (kill {}), and the robot stops by itself half a second later unless it plays detached; then try again",
                    self.command, self.process, self.port, self.process
                )))
            }
            Err(_) => Ok(None),
        }
    }
}

impl fmt::Display for HeldBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            port,
            command,
            process,
            ..
        } = self;
        let typed = as_typed(port);
        write!(
            f,
            "opening {port}: `{command}` (process {process}) has the port open. Through it, `swimmer robot stop --port {typed}` (or \
             estop, pause, resume, status, watch) works now; for anything else end it first, with Ctrl-C there"
        )
    }
}

/// A word as a shell takes it for one.
fn as_typed(word: &str) -> Cow<'_, str> {
    let is_plain = |sign: char| sign.is_alphanumeric() || "/._-+:=@%,".contains(sign);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.into();
    }
    format!("'{}'", word.replace('\'', r"'\''")).into()
}

/// Beside the socket: who listens.
fn note(socket: &Path) -> PathBuf {
    socket.with_extension("holder")
}

/// A short name for a port, the same for all its aliases. A fresh virtual robot has no other user.
fn socket_name(port: &str) -> Option<String> {
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

/// Rights of anybody but the owner.
const OTHERS: u32 = 0o077;

/// Where this user's sockets lie: a folder that nobody else may enter.
fn folder() -> Option<PathBuf> {
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

    #[test]
    fn a_holder_is_known_while_it_lives_and_a_dead_socket_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (place, port) = (folder.path(), "/dev/rfcomm7");
        assert!(HeldBy::of_in(place, port).is_none());
        // What a killed process leaves: a socket that nobody listens at.
        let path = place.join(socket_name(port).unwrap());
        drop(UnixListener::bind(&path).unwrap());
        assert!(path.exists() && HeldBy::of_in(place, port).is_none());

        let holder = Holder::announce_in(Some(place), port, "swimmer robot play");
        let held = HeldBy::of_in(place, port).unwrap();
        let told = held.to_string();
        assert!(
            told.contains("`swimmer robot play` (process ")
                && told.contains("swimmer robot stop --port /dev/rfcomm7"),
            "{told}"
        );
        drop(holder);
        assert!(HeldBy::of_in(place, port).is_none());
        assert_eq!(fs::read_dir(place).unwrap().count(), 0);
    }

    #[test]
    fn a_suggested_command_can_be_typed_as_it_stands() {
        for (port, typed) in [
            ("/dev/rfcomm0", "/dev/rfcomm0"),
            ("tcp:127.0.0.1:7000", "tcp:127.0.0.1:7000"),
            ("/tmp/my robot", "'/tmp/my robot'"),
            ("/tmp/o'hara;$x", r"'/tmp/o'\''hara;$x'"),
        ] {
            assert_eq!(as_typed(port), typed);
        }
        let folder = tempfile::tempdir().unwrap();
        let _holder =
            Holder::announce_in(Some(folder.path()), "/tmp/my robot", "swimmer robot play");
        let told = HeldBy::of_in(folder.path(), "/tmp/my robot")
            .unwrap()
            .to_string();
        assert!(
            told.contains("`swimmer robot stop --port '/tmp/my robot'`"),
            "{told}"
        );
    }

    #[test]
    fn a_word_that_is_no_ask_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let mut holder = Holder::announce_in(Some(folder.path()), "/dev/rfcomm7", "x");
        let socket = folder.path().join(socket_name("/dev/rfcomm7").unwrap());
        for word in ["dance\n", "", "STOP\n"] {
            let mut stream = UnixStream::connect(&socket).unwrap();
            stream.write_all(word.as_bytes()).unwrap();
        }
        assert!(!holder.asked());
        let mut stream = UnixStream::connect(&socket).unwrap();
        stream.write_all(b"estop\n").unwrap();
        assert!(holder.asked());
    }
}
