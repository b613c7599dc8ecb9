//! Holder of the port: a socket, a thread that acknowledges requests at once, and a queue that is served at the next beat.

use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use clap::ValueEnum;
use host_link::Robot;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::super::port::AnyPort;
use super::halt_signal::HaltSignal;
use super::relay::{PortRequest, Relayed};
use super::socket::{HEARD, folder, is_held, note, socket_name};

/// Longest wait for the request of a process that has connected.
const PATIENCE_WITH_ASKER: Duration = Duration::from_millis(50);
/// Interval at which the listening thread checks if the holder has ended.
const LISTEN: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};

/// Holds the port, and receives the requests of other processes.
pub(in super::super) struct PortHolder {
    open: Option<Open>,
    asked: Vec<(PortRequest, Requester)>,
    halts: HaltSignal,
}

/// Another process, which waits for an answer.
pub(in super::super) struct Requester(UnixStream);

impl Requester {
    /// Sends the reply. The other process may have ended; its request has been served.
    pub(in super::super) fn answer(mut self, answer: &Relayed) {
        let _ = serde_json::to_string(answer)
            .map_err(io::Error::other)
            .and_then(|line| writeln!(self.0, "{line}"));
    }
}

/// A socket at which a thread listens.
struct Open {
    path: PathBuf,
    heard: mpsc::Receiver<(PortRequest, Requester)>,
    ended: Arc<AtomicBool>,
}

impl PortHolder {
    /// Announces that this process has the port, as `command`. If no socket can be made (on a system without a place for it), the
    /// port is held nevertheless, and other processes only see that it is busy.
    pub(in super::super) fn announce(port: &str, command: &str) -> Self {
        Self::announce_in(folder().as_deref(), port, command)
    }

    pub(super) fn announce_in(folder: Option<&Path>, port: &str, command: &str) -> Self {
        let halts = HaltSignal::default();
        let open = folder
            .zip(socket_name(port))
            .and_then(|(folder, name)| Open::new(folder.join(name), command, halts.clone()).ok());
        Self {
            open,
            asked: Vec::new(),
            halts,
        }
    }

    /// Stops that other processes have requested, for a caller that waits for the robot and serves nobody meanwhile.
    pub(in super::super) fn halts(&self) -> HaltSignal {
        self.halts.clone()
    }

    /// `true` if a request is waiting.
    pub(in super::super) fn asked(&mut self) -> bool {
        if let Some(open) = &self.open {
            self.asked.extend(open.heard.try_iter());
        }
        !self.asked.is_empty()
    }

    /// Requests with their senders, the most urgent first.
    pub(in super::super) fn take_requests(&mut self) -> Vec<(PortRequest, Requester)> {
        self.asked();
        self.asked.sort_by_key(|(ask, _)| *ask as u8);
        if self.asked.iter().any(|(ask, _)| ask.halt().is_some()) {
            self.halts.take();
        }
        std::mem::take(&mut self.asked)
    }

    /// Serves all requests.
    pub(in super::super) fn serve(&mut self, robot: &mut Robot<AnyPort>) {
        for (ask, requester) in self.take_requests() {
            requester.answer(&ask.of(robot));
        }
    }
}

impl Open {
    /// Listens at `path` in a thread, which acknowledges every request at once, whatever the process is doing.
    fn new(path: PathBuf, command: &str, halts: HaltSignal) -> io::Result<Self> {
        let listener = listen(&path, command)?;
        let (hears, heard) = mpsc::channel();
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        thread::Builder::new().spawn(move || {
            while !end.load(Ordering::SeqCst) {
                let _ = poll(&mut [PollFd::new(&listener, PollFlags::IN)], Some(&LISTEN));
                while let Ok((stream, _)) = listener.accept() {
                    if let Some(ask) = hear(&stream) {
                        if let Some(halt) = ask.halt() {
                            halts.set(halt);
                        }
                        // The holder may be ending; then the stream is closed, and the sender tries again.
                        let _ = hears.send((ask, Requester(stream)));
                    }
                }
            }
        })?;
        Ok(Self { path, heard, ended })
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::SeqCst);
        let _ = fs::remove_file(&self.path);
        let _ = fs::remove_file(note(&self.path));
    }
}

fn hear(mut stream: &UnixStream) -> Option<PortRequest> {
    stream.set_nonblocking(false).ok()?;
    stream.set_read_timeout(Some(PATIENCE_WITH_ASKER)).ok()?;
    stream.set_write_timeout(Some(PATIENCE_WITH_ASKER)).ok()?;
    let mut line = String::new();
    BufReader::new(stream).read_line(&mut line).ok()?;
    let ask = PortRequest::from_str(line.trim(), false).ok()?;
    writeln!(stream, "{HEARD}").ok()?;
    Some(ask)
}

/// Listens at `path`, in place of a socket without a listener.
fn listen(path: &Path, command: &str) -> io::Result<UnixListener> {
    if !is_held(path) {
        let _ = fs::remove_file(path);
    }
    fs::write(note(path), format!("{command}\n{}", std::process::id()))?;
    let listener = UnixListener::bind(path)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_is_no_ask_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let mut holder = PortHolder::announce_in(Some(folder.path()), "/dev/rfcomm7", "x");
        let socket = folder.path().join(socket_name("/dev/rfcomm7").unwrap());
        for word in ["dance\n", "", "STOP\n"] {
            let mut stream = UnixStream::connect(&socket).unwrap();
            stream.write_all(word.as_bytes()).unwrap();
        }
        let mut stream = UnixStream::connect(&socket).unwrap();
        stream.write_all(b"estop\n").unwrap();
        let mut said = String::new();
        BufReader::new(&stream).read_line(&mut said).unwrap();
        // They were acknowledged in order: none of the earlier ones is waiting either.
        assert_eq!(said.trim(), HEARD);
        while !holder.asked() {
            thread::yield_now();
        }
        assert_eq!(holder.asked.len(), 1);
    }
}
