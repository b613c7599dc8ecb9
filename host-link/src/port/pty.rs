//! Robot's end of a pseudo-terminal: other programs open the digital twin by path, like a serial port.
//!
//! The port keeps no slave end open. So the system reports if a client is present (the twin's STATE pin), and bytes without a
//! client are dropped, as a disconnected Bluetooth module drops them.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::pty::OpenptFlags;
use rustix::termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr};

use super::Port;

/// Reason why a pseudo-terminal could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum PtyError {
    /// The system provided no pseudo-terminal.
    #[error("making a pseudo-terminal: {0}; close some terminals and try again")]
    NoTerminal(#[source] io::Error),
    /// A foreign file exists at the path of the link.
    #[error(
        "linking {0} to the twin's terminal: a file of that name exists; remove it or choose another LINK"
    )]
    Occupied(PathBuf),
    /// The link leads to a terminal in use.
    #[error(
        "linking {link}: it leads to {target}, which is in use; end the twin that made it, or remove the link"
    )]
    InUse {
        /// Path of the link.
        link: PathBuf,
        /// Target of the link.
        target: PathBuf,
    },
    /// The link could not be created.
    #[error(
        "linking {link} to the twin's terminal: {source}; does its folder exist and may you write there?"
    )]
    Link {
        /// Path of the link.
        link: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// Device end of a pseudo-terminal in raw mode, with an optional symbolic link to the clients' end.
///
/// Clients may close and reopen it any number of times. Dropping the port removes the link.
#[derive(Debug)]
pub struct PtyPort {
    terminal: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    opened: Instant,
    client_present: bool,
}

/// Polling interval for an absent client.
const LOOK: Duration = Duration::from_millis(5);

impl PtyPort {
    /// Creates a pseudo-terminal, and the symbolic link `link` to it if given. A stale link, whose terminal is gone, is
    /// replaced.
    ///
    /// # Errors
    /// [`PtyError`].
    pub fn open(link: Option<&Path>) -> Result<Self, PtyError> {
        // Checked before the terminal is created: a stale link may point to the number that the system assigns next.
        if let Some(link) = link {
            check_vacant(link)?;
        }
        let (terminal, path) =
            raw_terminal().map_err(|errno| PtyError::NoTerminal(errno.into()))?;
        let port = Self {
            terminal,
            path,
            link: link.map(Path::to_path_buf),
            opened: Instant::now(),
            client_present: false,
        };
        port.point_link()?;
        Ok(port)
    }

    /// Path of the clients' end.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns true if a client had the terminal open at the last read or write.
    pub fn client_present(&self) -> bool {
        self.client_present
    }

    /// Creates or moves the link atomically, so that no client finds it missing.
    fn point_link(&self) -> Result<(), PtyError> {
        let Some(link) = &self.link else {
            return Ok(());
        };
        let fail = |source| PtyError::Link {
            link: link.clone(),
            source,
        };
        let mut beside = OsString::from(".");
        beside.push(link.file_name().unwrap_or_default());
        beside.push(format!(".{}", std::process::id()));
        let beside = link.with_file_name(beside);
        let _ = fs::remove_file(&beside);
        std::os::unix::fs::symlink(&self.path, &beside).map_err(fail)?;
        fs::rename(&beside, link).map_err(|source| {
            let _ = fs::remove_file(&beside);
            fail(source)
        })
    }

    /// Waits at most `timeout` for the terminal; returns the events that are ready.
    fn ready(&mut self, wanted: PollFlags, timeout: Duration) -> io::Result<PollFlags> {
        let mut fds = [PollFd::new(&self.terminal, wanted)];
        let timeout = Timespec {
            tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: timeout.subsec_nanos().into(),
        };
        match poll(&mut fds, Some(&timeout)) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(errno) => return Err(errno.into()),
        }
        let flags = fds[0].revents();
        let present = !flags.contains(PollFlags::HUP);
        if self.client_present && !present {
            self.after_client()?;
        }
        self.client_present = present;
        Ok(flags)
    }

    /// Cleans up after a client has closed. A client that locked the terminal leaves the lock: it is removed, or, if only the
    /// administrator may do that, the terminal is replaced.
    fn after_client(&mut self) -> io::Result<()> {
        match rustix::fs::open(
            &self.path,
            OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC,
            Mode::empty(),
        ) {
            Ok(slave) => Ok(ioctl_tiocnxcl(&slave)?),
            Err(Errno::BUSY) if self.hung_up() => {
                (self.terminal, self.path) = raw_terminal()?;
                self.point_link().map_err(io::Error::other)
            }
            // A new client has locked the terminal in the meantime.
            Err(Errno::BUSY) => Ok(()),
            Err(errno) => Err(errno.into()),
        }
    }

    fn hung_up(&self) -> bool {
        let mut fds = [PollFd::new(&self.terminal, PollFlags::IN)];
        poll(
            &mut fds,
            Some(&Timespec {
                tv_sec: 0,
                tv_nsec: 0,
            }),
        )
        .is_ok()
            && fds[0].revents().contains(PollFlags::HUP)
    }
}

/// Opens a terminal without echo, line discipline or translation; returns it with its path. The settings persist when clients
/// come and go.
fn raw_terminal() -> rustix::io::Result<(OwnedFd, PathBuf)> {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let terminal = rustix::pty::openpt(flags)?;
    rustix::pty::grantpt(&terminal)?;
    rustix::pty::unlockpt(&terminal)?;
    let name = rustix::pty::ptsname(&terminal, Vec::new())?;
    let path = PathBuf::from(OsString::from_vec(name.into_bytes()));
    let slave = rustix::fs::open(
        &path,
        OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC,
        Mode::empty(),
    )?;
    let mut settings = tcgetattr(&slave)?;
    settings.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &settings)?;
    rustix::io::ioctl_fionbio(&terminal, true)?;
    Ok((terminal, path))
}

/// Checks that `link` does not exist, or is a stale link of an earlier twin.
fn check_vacant(link: &Path) -> Result<(), PtyError> {
    let Ok(metadata) = fs::symlink_metadata(link) else {
        return Ok(());
    };
    if !metadata.file_type().is_symlink() {
        return Err(PtyError::Occupied(link.to_path_buf()));
    }
    let Ok(terminal) = fs::metadata(link) else {
        return Ok(());
    };
    let target = fs::read_link(link).unwrap_or_default();
    // A link is created after its terminal. If the terminal is younger, the original one is gone and the system has reassigned
    // its number.
    let linked = (metadata.mtime(), metadata.mtime_nsec());
    let born = (terminal.ctime(), terminal.ctime_nsec());
    if target.starts_with("/dev/pts") && born > linked {
        return Ok(());
    }
    Err(PtyError::InUse {
        link: link.to_path_buf(),
        target,
    })
}

impl Drop for PtyPort {
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            let _ = fs::remove_file(link);
        }
    }
}

impl Port for PtyPort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let deadline = self.opened.elapsed() + timeout;
        loop {
            let left = deadline.saturating_sub(self.opened.elapsed());
            let flags = self.ready(PollFlags::IN, left)?;
            if flags.contains(PollFlags::IN) {
                match rustix::io::read(&self.terminal, &mut *buf) {
                    Ok(count) => return Ok(count),
                    // The last client closed between the two calls.
                    Err(Errno::IO | Errno::AGAIN | Errno::INTR) => {}
                    Err(errno) => return Err(errno.into()),
                }
            }
            let left = deadline.saturating_sub(self.opened.elapsed());
            if left.is_zero() {
                return Ok(0);
            }
            if flags.contains(PollFlags::HUP) {
                std::thread::sleep(left.min(LOOK));
            }
        }
    }

    /// Sends to the client. Drops bytes without a client, or if the client has stopped reading.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let flags = self.ready(PollFlags::OUT, Duration::ZERO)?;
            if flags.contains(PollFlags::HUP) || !flags.contains(PollFlags::OUT) {
                return Ok(());
            }
            match rustix::io::write(&self.terminal, rest) {
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(Errno::INTR) => {}
                Err(Errno::IO | Errno::AGAIN) => return Ok(()),
                Err(errno) => return Err(errno.into()),
            }
        }
        Ok(())
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}
