//! Another process that has the port: requests to it, and the way around it if it hangs.

use std::borrow::Cow;
use std::fmt;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::ValueEnum;
use host_link::port::OccupiedPort;

use super::relay::{PortRequest, Relayed, Unanswered};
use super::socket::{HEARD, dial, folder, is_held, note, socket_name};
use super::take_over;
use crate::failure::{Failure, Outcome};

/// Longest wait for the acknowledgement of a live process.
const TO_BE_HEARD: Duration = Duration::from_millis(300);
/// The robot's answer may need its five tries.
const PATIENCE_WITH_HOLDER: Duration = Duration::from_secs(15);
/// A stop is not waited for as long.
const PATIENCE_WITH_A_STOP: Duration = Duration::from_secs(4);
/// An e-stop goes past a holder that is still at something else.
const PATIENCE_WITH_AN_ESTOP: Duration = Duration::from_millis(400);

/// Another `swimmer` that has the port.
#[derive(Debug)]
pub(in super::super) struct HeldBy {
    port: String,
    socket: PathBuf,
    command: String,
    process: String,
}

impl HeldBy {
    /// The process that has the port. Returns `None` unless it is a `swimmer` of this user.
    pub(in super::super) fn of(port: &str) -> Option<Self> {
        Self::of_in(&folder()?, port)
    }

    fn of_in(folder: &Path, port: &str) -> Option<Self> {
        let socket = folder.join(socket_name(port)?);
        // Only a living process takes the connection.
        if !is_held(&socket) {
            return None;
        }
        let note_text = fs::read_to_string(note(&socket)).unwrap_or_default();
        let mut note_text = note_text.lines();
        Some(Self {
            port: port.to_owned(),
            socket,
            command: note_text.next().unwrap_or("swimmer").to_owned(),
            process: note_text.next().unwrap_or("unknown").to_owned(),
        })
    }

    /// Has it done. `None`: the other process ended meanwhile, and the port is free.
    ///
    /// # Errors
    /// [`Failure::Tried`] with the robot's or the link's word, or when the other process does not answer.
    pub(in super::super) fn ask(&self, ask: PortRequest) -> Outcome<Option<Relayed>> {
        self.try_request(ask).map_err(|unanswered| match unanswered {
            Unanswered::Refused(failure) => failure,
            Unanswered::Hangs => Failure::Tried(format!(
                "{}. `swimmer robot estop --port {}` stops the robot all the same; for anything else end that process (kill -9 {})",
                self.hangs(),
                as_typed(&self.port),
                self.process
            )),
        })
    }

    /// Variant of [`ask`](Self::ask) for a caller that can handle a process that hangs.
    ///
    /// # Errors
    /// [`Unanswered`].
    pub(in super::super) fn try_request(
        &self,
        ask: PortRequest,
    ) -> Result<Option<Relayed>, Unanswered> {
        let Some(word) = ask.to_possible_value() else {
            return Ok(None);
        };
        let talk = || -> io::Result<Option<String>> {
            let mut stream = dial(&self.socket)?;
            stream.set_read_timeout(Some(TO_BE_HEARD))?;
            stream.set_write_timeout(Some(TO_BE_HEARD))?;
            writeln!(stream, "{}", word.get_name())?;
            let mut reader = BufReader::new(stream);
            let mut line = String::new();
            reader.read_line(&mut line)?;
            if line.trim() != HEARD {
                // Of another version, it answers without that word.
                return Ok((!line.is_empty()).then_some(line));
            }
            reader.get_ref().set_read_timeout(Some(match ask {
                PortRequest::EStop => PATIENCE_WITH_AN_ESTOP,
                PortRequest::Stop => PATIENCE_WITH_A_STOP,
                _ => PATIENCE_WITH_HOLDER,
            }))?;
            line.clear();
            reader.read_line(&mut line)?;
            Ok((!line.is_empty()).then_some(line))
        };
        match talk() {
            Ok(Some(line)) => match serde_json::from_str::<Relayed>(&line) {
                Ok(relayed) if relayed.done => Ok(Some(relayed)),
                Ok(relayed) => Err(Unanswered::Refused(Failure::Tried(relayed.text))),
                Err(error) => Err(Unanswered::Refused(Failure::Tried(format!(
                    "`{}` (process {}), which has the port {} open, answers nonsense ({error}); end it and try again",
                    self.command, self.process, self.port
                )))),
            },
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) =>
            {
                Err(Unanswered::Hangs)
            }
            // It ended meanwhile.
            Ok(None) | Err(_) => Ok(None),
        }
    }

    /// That it hangs, as a sentence without its end.
    pub(in super::super) fn hangs(&self) -> String {
        format!(
            "`{}` (process {}) has the port {} open and does not answer: it is suspended (Ctrl-Z) or stuck",
            self.command, self.process, self.port
        )
    }

    /// Number of the process.
    pub(in super::super) fn process(&self) -> &str {
        &self.process
    }

    /// A second connection to the robot's device. Returns `None` if the port has none.
    pub(in super::super) fn occupied(&self) -> Option<OccupiedPort> {
        take_over::occupied(&self.port)
    }

    /// Ends that process, so that the port is free.
    ///
    /// # Errors
    /// [`Failure::Tried`] with the reason why it still has the port.
    pub(in super::super) fn end(&self) -> Outcome {
        take_over::end(&self.process, || !is_held(&self.socket)).map_err(|reason| {
            Failure::Tried(format!(
                "{}, and {reason}; end it yourself (kill -9 {}), or switch the robot's power off",
                self.hangs(),
                self.process
            ))
        })
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

#[cfg(test)]
mod tests {
    use super::super::holder::PortHolder;
    use super::*;
    use std::os::unix::net::UnixListener;

    #[test]
    fn a_holder_is_known_while_it_lives_and_a_dead_socket_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (place, port) = (folder.path(), "/dev/rfcomm7");
        assert!(HeldBy::of_in(place, port).is_none());
        // Remains of a killed process: a socket without a listener.
        let path = place.join(socket_name(port).unwrap());
        drop(UnixListener::bind(&path).unwrap());
        assert!(path.exists() && HeldBy::of_in(place, port).is_none());

        let holder = PortHolder::announce_in(Some(place), port, "swimmer robot play");
        let held = HeldBy::of_in(place, port).unwrap();
        let note_text = held.to_string();
        assert!(
            note_text.contains("`swimmer robot play` (process ")
                && note_text.contains("swimmer robot stop --port /dev/rfcomm7"),
            "{note_text}"
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
            PortHolder::announce_in(Some(folder.path()), "/tmp/my robot", "swimmer robot play");
        let note_text = HeldBy::of_in(folder.path(), "/tmp/my robot")
            .unwrap()
            .to_string();
        assert!(
            note_text.contains("`swimmer robot stop --port '/tmp/my robot'`"),
            "{note_text}"
        );
    }

    /// A suspended process accepts no request, and earlier ones fill its queue: the next one must not wait for a place in it.
    #[test]
    fn a_holder_with_a_full_queue_hangs_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(socket_name("/dev/rfcomm7").unwrap());
        let _listener = UnixListener::bind(&path).unwrap();
        while dial(&path).is_ok() {}
        let held = HeldBy::of_in(folder.path(), "/dev/rfcomm7").unwrap();
        let begun = std::time::Instant::now();
        let unanswered = held.try_request(PortRequest::EStop).unwrap_err();
        assert!(matches!(unanswered, Unanswered::Hangs), "{unanswered:?}");
        assert!(begun.elapsed() < TO_BE_HEARD, "{:?}", begun.elapsed());
    }

    /// A process that is alive but serves nobody is distinguished from one that hangs, and gives no reply.
    #[test]
    fn a_holder_that_hears_and_does_nothing_hangs_no_estop_for_long() {
        let folder = tempfile::tempdir().unwrap();
        let _holder = PortHolder::announce_in(Some(folder.path()), "/dev/rfcomm7", "x");
        let held = HeldBy::of_in(folder.path(), "/dev/rfcomm7").unwrap();
        let begun = std::time::Instant::now();
        let unanswered = held.try_request(PortRequest::EStop).unwrap_err();
        assert!(matches!(unanswered, Unanswered::Hangs), "{unanswered:?}");
        let waited = begun.elapsed();
        assert!(
            (PATIENCE_WITH_AN_ESTOP..PATIENCE_WITH_AN_ESTOP * 3).contains(&waited),
            "{waited:?}"
        );
    }
}
