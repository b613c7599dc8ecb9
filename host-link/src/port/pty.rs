//! The robot's end of a pseudo-terminal, so that any program can open a twin by path as if it were a serial port.
//!
//! No slave end is held open here: the system then tells when a client is present (the twin's STATE pin), and bytes for
//! nobody are dropped as a disconnected Bluetooth module drops them.

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

/// Why a pseudo-terminal could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum PtyError {
    /// The system gave none.
    #[error("making a pseudo-terminal: {0}; close some terminals and try again")]
    NoTerminal(#[source] io::Error),
    /// Something that is not ours stands where the link should go.
    #[error(
        "linking {0} to the twin's terminal: a file of that name exists; remove it or choose another LINK"
    )]
    Occupied(PathBuf),
    /// The link leads to a terminal that is in use.
    #[error(
        "linking {link}: it leads to {target}, which is in use; end the twin that made it, or remove the link"
    )]
    InUse {
        /// The link.
        link: PathBuf,
        /// Where it leads.
        target: PathBuf,
    },
    /// The link could not be made.
    #[error(
        "linking {link} to the twin's terminal: {source}; does its folder exist and may you write there?"
    )]
    Link {
        /// The link.
        link: PathBuf,
        /// The system's words.
        source: io::Error,
    },
}

/// The device's end of a pseudo-terminal in raw mode, with an optional symbolic link to the clients' end.
///
/// Clients may close and open it again as often as they like. The link is removed when this is dropped.
#[derive(Debug)]
pub struct PtyPort {
    terminal: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    opened: Instant,
    client_present: bool,
}

/// How often an absent client is looked for.
const LOOK: Duration = Duration::from_millis(5);

impl PtyPort {
    /// Makes a pseudo-terminal; `link`, if any, becomes a symbolic link to it. A stale link, one whose terminal is
    /// gone, is replaced.
    ///
    /// # Errors
    /// [`PtyError`].
    pub fn open(link: Option<&Path>) -> Result<Self, PtyError> {
        // Before the terminal is made: a stale link may dangle from the very number that the system gives out next.
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

    /// Whether a client had the terminal open at the last read or write.
    pub fn client_present(&self) -> bool {
        self.client_present
    }

    /// Makes or moves the link in one step, so that no client ever finds it missing.
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

    /// What the terminal is ready for, after at most `timeout`.
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

    /// A client has closed. One that had locked the terminal leaves the lock behind: lift it, or where only the
    /// administrator could, take a new terminal.
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
            // A new client was quicker than we: leave it alone.
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

/// A terminal without echo, line discipline or translation, and its path. The settings stay when clients come and go.
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

/// Nothing stands at `link`, or a link that an earlier twin left behind.
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
    // A link is made after its terminal. Where the terminal is younger, the one it was made for is gone and the system
    // has given its number to another program since.
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

    /// Sends to the client; drops what is for nobody, or for a client that has stopped reading.
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
