//! Serial port of the system: a cable, a Bluetooth module, or a pseudo-terminal opened by path.

#[cfg(not(unix))]
use std::io::Write;
use std::io::{self, Read};
#[cfg(unix)]
use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, SerialPort as _};

use super::Port;
#[cfg(unix)]
use super::tty;

/// Longest wait for a port that accepts no byte.
const STUCK: Duration = Duration::from_secs(1);

#[cfg(unix)]
type Native = serialport::TTYPort;
#[cfg(windows)]
type Native = serialport::COMPort;

/// Reason why a serial port could not be opened, with the next step.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another program holds the port.
    #[error(
        "opening {path}: another program has the port open; close it (a terminal or a second `swimmer`) and try again"
    )]
    Busy {
        /// Path of the port.
        path: String,
    },
    /// The user lacks permission.
    #[error("opening {path}: permission denied; {}", permission_advice(group.as_deref()))]
    NoPermission {
        /// Path of the port.
        path: String,
        /// Name or number of the group with permission; `None` if only the owner has it.
        group: Option<String>,
    },
    /// The port does not exist.
    #[error(
        "opening {path}: there is no such port; is the robot switched on and paired, and the path right?"
    )]
    Missing {
        /// Path of the port.
        path: String,
    },
    /// The file is no serial port.
    #[error(
        "opening {path}: it is there, but it is no serial port; name one (`swimmer robot info` without --port finds it)"
    )]
    NoSerialPort {
        /// Path of the port.
        path: String,
    },
    /// Any other error.
    #[error("opening {path} as a serial port: {reason}; is this path a serial port?")]
    Other {
        /// Path of the port.
        path: String,
        /// The operating system's message.
        reason: String,
    },
}

/// Serial port of the operating system, opened exclusively, with 8 data bits, no parity, 1 stop bit. Its clock starts when it
/// is opened.
///
/// On Unix the lock is advisory (`flock`), so [`super::OccupiedPort`] can bypass a hung program.
#[derive(Debug)]
pub struct SerialPort {
    port: Native,
    /// Second handle of the device, for non-blocking writes.
    #[cfg(unix)]
    writer: OwnedFd,
    opened: Instant,
}

impl SerialPort {
    /// Opens the port and discards its unread input.
    ///
    /// # Errors
    /// [`OpenError`], one variant per problem that an operator can fix.
    pub fn open(path: &str, baud: u32) -> Result<Self, OpenError> {
        #[cfg(unix)]
        let second = SecondOpening::of(path);
        let port = serialport::new(path, baud)
            .timeout(Duration::from_millis(10))
            .open_native()
            .map_err(|error| explain(path, &error))?;
        // Stale bytes are harmless (they carry a foreign session), but the decoder need not read them.
        let _ = port.clear(ClearBuffer::Input);
        Ok(Self {
            port,
            #[cfg(unix)]
            writer: second.into_writer().map_err(|error| OpenError::Other {
                path: path.to_owned(),
                reason: error.to_string(),
            })?,
            opened: Instant::now(),
        })
    }
}

fn explain(path: &str, error: &serialport::Error) -> OpenError {
    let path = path.to_owned();
    match error.kind() {
        serialport::ErrorKind::NoDevice => OpenError::Busy { path },
        serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) => OpenError::NoPermission {
            group: owning_group(&path),
            path,
        },
        serialport::ErrorKind::Io(io::ErrorKind::NotFound) => OpenError::Missing { path },
        _ if is_no_terminal(error) => OpenError::NoSerialPort { path },
        _ => OpenError::Other {
            path,
            reason: error.to_string(),
        },
    }
}

/// Returns true if the system reported that this is no terminal: a file, a folder, `/dev/null`.
fn is_no_terminal(error: &serialport::Error) -> bool {
    // The crate keeps only the C library's text for ENOTTY, not the error number.
    ["typewriter", "ioctl"]
        .iter()
        .any(|word| error.to_string().contains(word))
}

fn permission_advice(group: Option<&str>) -> String {
    match group {
        Some(group) => format!(
            "the port belongs to the group `{group}`: add yourself with `sudo usermod -aG {group} $USER`, then log out and in again"
        ),
        None => {
            "only its owner may open it: as that user, or after `sudo chmod a+rw` on it".to_owned()
        }
    }
}

/// Name of the group that may open a device, or its number if it has no name.
#[cfg(unix)]
fn owning_group(path: &str) -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    const GROUP_MAY_WRITE: u32 = 0o020;
    let Ok(metadata) = std::fs::metadata(path) else {
        return Some("dialout".to_owned());
    };
    if metadata.mode() & GROUP_MAY_WRITE == 0 {
        return None;
    }
    let number = metadata.gid().to_string();
    let groups = std::fs::read_to_string("/etc/group").unwrap_or_default();
    let name = groups
        .lines()
        .map(|line| line.split(':').collect::<Vec<_>>())
        .find(|fields| fields.get(2) == Some(&number.as_str()))
        .and_then(|fields| fields.first().map(|name| (*name).to_owned()));
    Some(name.unwrap_or(number))
}

#[cfg(not(unix))]
fn owning_group(_path: &str) -> Option<String> {
    None
}

/// Handle opened before the port itself, without waiting. Opening the port sets two locks: `flock`, and an exclusive mark on
/// the device. The mark affects every later opening, even if our own fails at `flock`, and outlives the open file. This handle
/// removes the mark in every case.
#[cfg(unix)]
struct SecondOpening(rustix::io::Result<OwnedFd>);

#[cfg(unix)]
impl SecondOpening {
    fn of(path: &str) -> Self {
        use rustix::fs::{Mode, OFlags};
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
        Self(rustix::fs::open(path, flags, Mode::empty()))
    }

    /// Keeps the handle for writes.
    fn into_writer(mut self) -> io::Result<OwnedFd> {
        self.unmark();
        let taken = std::mem::replace(&mut self.0, Err(rustix::io::Errno::BADF));
        Ok(taken?)
    }

    fn unmark(&self) {
        if let Ok(device) = &self.0 {
            let _ = rustix::termios::ioctl_tiocnxcl(device);
        }
    }
}

#[cfg(unix)]
impl Drop for SecondOpening {
    fn drop(&mut self) {
        self.unmark();
    }
}

impl Port for SerialPort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if buf.is_empty() {
            return Ok(0);
        }
        // The system counts whole milliseconds; rounding up prevents a busy loop for a caller with 0.3 ms left.
        let whole = Duration::from_millis(
            u64::try_from(timeout.as_micros().div_ceil(1000)).unwrap_or(u64::MAX),
        );
        self.port.set_timeout(whole)?;
        match self.port.read(buf) {
            Ok(0) => Err(io::Error::new(
                io::ErrorKind::UnexpectedEof,
                "the serial port has gone away",
            )),
            Ok(count) => Ok(count),
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::TimedOut
                        | io::ErrorKind::WouldBlock
                        | io::ErrorKind::Interrupted
                ) =>
            {
                Ok(0)
            }
            Err(error) => Err(error),
        }
    }

    /// A port that accepts no byte for a second has failed: 128 bytes need 11 ms at 115 200 baud.
    #[cfg(unix)]
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        tty::write_all(&self.writer, bytes, STUCK)
    }

    #[cfg(unix)]
    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        tty::write_ready(&self.writer, bytes)
    }

    #[cfg(not(unix))]
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(STUCK)?;
        self.port.write_all(bytes)
    }

    #[cfg(not(unix))]
    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.port.set_timeout(Duration::from_millis(20))?;
        match self.port.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::TimedOut => Ok(0),
            written => written,
        }
    }

    fn discard_unsent(&mut self) {
        // A driver that cannot discard sends the bytes.
        let _ = self.port.clear(ClearBuffer::Output);
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_port_says_so() {
        let error = SerialPort::open("/dev/no-such-port-here", 115_200).unwrap_err();
        assert!(matches!(error, OpenError::Missing { .. }), "{error:?}");
        assert!(error.to_string().contains("switched on"));
    }

    #[test]
    fn a_file_that_is_no_port_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plain.txt");
        std::fs::write(&path, "x").unwrap();
        let error = SerialPort::open(path.to_str().unwrap(), 115_200).unwrap_err();
        assert!(matches!(error, OpenError::NoSerialPort { .. }), "{error:?}");
    }

    #[cfg(unix)]
    #[test]
    fn a_forbidden_port_names_the_group_that_may() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("port");
        std::fs::write(&path, "").unwrap();
        let modes = |mode: u32| {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
            let denied = serialport::Error::new(
                serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied),
                "denied",
            );
            explain(path.to_str().unwrap(), &denied).to_string()
        };
        let open_to_group = modes(0o660);
        assert!(
            open_to_group.contains("sudo usermod -aG ") && open_to_group.contains("$USER"),
            "{open_to_group}"
        );
        let owner_only = modes(0o600);
        assert!(
            owner_only.contains("only its owner") && !owner_only.contains("usermod"),
            "{owner_only}"
        );
    }
}
