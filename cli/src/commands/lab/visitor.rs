//! One connection: its request is judged, then it gets the page, or carries the robot's bytes until it closes.

use std::borrow::Cow;
use std::io::{self, Read as _, Write as _};
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use host_link::robot::Halt;
use link_protocol::Decoder;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::callers::{Caller, CallerAdmission};
use super::gate::{Gate, PROTOCOL, PageRequest, Refusal};
use super::hub::{Ended, FromPage, FromPageStop, PageId, PageMessage, ToHub, ToPage};

/// A head longer than this is no browser's.
const LONGEST_HEAD: usize = 8 << 10;
/// Longest time for a whole head, and longest wait for a caller that takes no byte of the page.
const PATIENCE: Duration = Duration::from_secs(2);
/// Longest wait for bytes of the page before the robot's are passed on.
const TURN: Duration = Duration::from_millis(2);
/// Pieces that wait for a page: about two seconds of a busy line.
const WAITING: usize = 1024;
/// No frame of the robot's is longer, and a page sends few at once.
const LONGEST_MESSAGE: usize = 8 << 10;
/// Most bytes that wait in a socket; a page that is further behind is let go.
const MOST_UNSENT: usize = 256 << 10;
/// Most messages for a page between two looks at what it sends.
const MOST_A_TURN: usize = 64;
/// Time between two pings.
const PING_EVERY: Duration = Duration::from_millis(500);
/// A page is frozen after this time without a sign of life: it loses the wheel within two seconds.
const FROZEN: Duration = Duration::from_millis(1250);

/// State that all connections share.
pub(super) struct Server {
    pub(super) gate: Gate,
    pub(super) page: Cow<'static, [u8]>,
    pub(super) hub: ToHub,
}

impl Server {
    /// Serves a connection to its end.
    ///
    /// # Errors
    /// Errors of the network; the page is gone then.
    pub(super) fn serve(&self, mut stream: TcpStream, mut caller: Caller) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let head = read_head(&mut stream)?;
        let here = stream.local_addr()?;
        match self.gate.judge(&head, here) {
            Ok(PageRequest::Page { head_only }) => {
                let body: &[u8] = if head_only { &[] } else { &self.page };
                let length = self.page.len();
                answer(&mut stream, "200 OK", "text/html", length, body)
            }
            Ok(PageRequest::Link { .. }) if caller.becomes_page() == CallerAdmission::None => {
                let body = "too many pages have the link open: close some\n";
                let (status, kind) = ("503 Service Unavailable", "text/plain; charset=utf-8");
                answer(&mut stream, status, kind, body.len(), body.as_bytes())
            }
            Ok(PageRequest::Link { accept }) => {
                write!(
                    stream,
                    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                     Sec-WebSocket-Accept: {accept}\r\nSec-WebSocket-Protocol: {PROTOCOL}\r\n\r\n"
                )?;
                self.carry(stream, caller.id())
            }
            Err(Refusal { status, reason }) => {
                let body = format!("{reason}\n");
                answer(
                    &mut stream,
                    status,
                    "text/plain; charset=utf-8",
                    body.len(),
                    body.as_bytes(),
                )
            }
        }
    }

    fn carry(&self, stream: TcpStream, id: PageId) -> io::Result<()> {
        stream.set_read_timeout(Some(TURN))?;
        // A page that does not read must not keep its own stops from being read.
        stream.set_write_timeout(Some(TURN))?;
        let config = WebSocketConfig::default()
            .write_buffer_size(0)
            .max_write_buffer_size(MOST_UNSENT)
            .max_message_size(Some(LONGEST_MESSAGE))
            .max_frame_size(Some(LONGEST_MESSAGE));
        let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
        let (page, messages) = sync_channel(WAITING);
        let ended = |_: Ended| io::Error::from(io::ErrorKind::BrokenPipe);
        self.hub.word(id, FromPage::Came(page)).map_err(ended)?;
        let mut life = Life::new(Instant::now());
        let carried = loop {
            if let Err(error) = self.turn(&mut socket, id, &messages, &mut life) {
                break error;
            }
        };
        let _ = self.hub.word(id, FromPage::Left);
        // It may have gone without a word.
        let _ = socket.close(None).and_then(|()| socket.flush());
        carried
    }

    /// Takes one message of the page and gives it those for it. `Err`: how the connection ends.
    fn turn(
        &self,
        socket: &mut WebSocket<TcpStream>,
        id: PageId,
        messages: &Receiver<ToPage>,
        life: &mut Life,
    ) -> Result<(), io::Result<()>> {
        let ended = |_: Ended| fails(io::ErrorKind::BrokenPipe);
        let now = Instant::now();
        match socket.read() {
            Ok(message) => {
                life.seen(now);
                match message {
                    Message::Binary(frames) if has_stop(&frames) => {
                        let stop = FromPageStop::Frames(frames.into());
                        self.hub.stop(id, stop).map_err(ended)?;
                    }
                    Message::Binary(frames) => {
                        self.hub.frames(id, frames.into()).map_err(ended)?;
                    }
                    Message::Text(text) => {
                        let ask = serde_json::from_str(&text)
                            .map_err(|_| fails(io::ErrorKind::InvalidData))?;
                        self.handle_message(id, ask, now, life).map_err(ended)?;
                    }
                    Message::Close(_) => return Err(Ok(())),
                    Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
                }
            }
            Err(Error::Io(error)) if is_nothing_yet(&error) => {}
            Err(Error::Io(error)) => return Err(fails(error)),
            Err(_) => return Err(Ok(())),
        }
        match life.due(now) {
            Due::Nothing => {}
            Due::Ping => send(socket, Message::Ping(Vec::new().into()))?,
            Due::Frozen => self.hub.word(id, FromPage::Frozen).map_err(ended)?,
        }
        for _ in 0..MOST_A_TURN {
            let message = match messages.try_recv() {
                Ok(ToPage::Bytes(bytes)) => Message::Binary(bytes.to_vec().into()),
                Ok(ToPage::ServerMessage(said)) => Message::Text(
                    serde_json::to_string(&said)
                        .map_err(|error| fails(io::Error::other(error)))?
                        .into(),
                ),
                Err(TryRecvError::Empty) => return Ok(()),
                // It did not keep up.
                Err(TryRecvError::Disconnected) => return Err(Ok(())),
            };
            send(socket, message)?;
        }
        Ok(())
    }

    fn handle_message(
        &self,
        id: PageId,
        ask: PageMessage,
        now: Instant,
        life: &mut Life,
    ) -> Result<(), Ended> {
        match ask {
            PageMessage::Stop => self.hub.stop(id, FromPageStop::Halt(Halt::Stop)),
            PageMessage::Estop => self.hub.stop(id, FromPageStop::Halt(Halt::EStop)),
            PageMessage::Drive => self.hub.word(id, FromPage::Wheel { wanted: true }),
            PageMessage::Watch => self.hub.word(id, FromPage::Wheel { wanted: false }),
            PageMessage::Here => {
                life.here(now);
                Ok(())
            }
        }
    }
}

/// Sends a message; one that the page does not take now waits in the socket, up to [`MOST_UNSENT`] bytes.
fn send(socket: &mut WebSocket<TcpStream>, message: Message) -> Result<(), io::Result<()>> {
    match socket.write(message).and_then(|()| socket.flush()) {
        Ok(()) => Ok(()),
        Err(Error::Io(error)) if is_nothing_yet(&error) => Ok(()),
        Err(error) => Err(fails(io::Error::other(error))),
    }
}

/// End of a connection by an error.
fn fails(error: impl Into<io::Error>) -> io::Result<()> {
    Err(error.into())
}

/// Frames with a stop among them.
fn has_stop(frames: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    frames.iter().any(|&byte| {
        decoder.push(byte).is_some_and(|received| {
            matches!(received.message, Ok(link_protocol::Message::Request(request)) if request.is_stop())
        })
    })
}

/// Signs of life of a page.
#[derive(Debug)]
struct Life {
    /// Its last message, replies to pings included.
    seen: Instant,
    /// The last sign of its script, once it has sent one.
    here: Option<Instant>,
    pinged: Instant,
    frozen: bool,
}

/// Action that is due for the sake of a page's life.
#[derive(Debug, PartialEq, Eq)]
enum Due {
    Nothing,
    Ping,
    /// It has given no sign of life for [`FROZEN`]; due once.
    Frozen,
}

impl Life {
    fn new(now: Instant) -> Self {
        Self {
            seen: now,
            here: None,
            pinged: now,
            frozen: false,
        }
    }

    fn seen(&mut self, now: Instant) {
        self.seen = now;
    }

    fn here(&mut self, now: Instant) {
        self.here = Some(now);
    }

    fn due(&mut self, now: Instant) -> Due {
        let sign = self.here.unwrap_or(self.seen).min(self.seen);
        let frozen = now.saturating_duration_since(sign) >= FROZEN;
        if frozen && !self.frozen {
            self.frozen = true;
            return Due::Frozen;
        }
        self.frozen = frozen;
        if now.saturating_duration_since(self.pinged) < PING_EVERY {
            return Due::Nothing;
        }
        self.pinged = now;
        Due::Ping
    }
}

fn is_nothing_yet(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

/// Reads to the empty line; what a browser sends after it waits for our answer.
fn read_head(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let begun = Instant::now();
    let mut head = Vec::new();
    let mut piece = [0; 1024];
    while !head.ends_with(b"\r\n\r\n") {
        let left = PATIENCE.saturating_sub(begun.elapsed());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut piece)?;
        head.extend_from_slice(piece.get(..count).unwrap_or_default());
        if count == 0 || head.len() > LONGEST_HEAD {
            return Err(io::ErrorKind::InvalidData.into());
        }
    }
    Ok(head)
}

fn answer(
    stream: &mut TcpStream,
    status: &str,
    kind: &str,
    length: usize,
    body: &[u8],
) -> io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nContent-Security-Policy: frame-ancestors 'none'\r\n\r\n"
    )?;
    stream.write_all(body)?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// The time from `start` at which a page that stops to give signs of life is found frozen.
    fn frozen_after(mut sign: impl FnMut(&mut Life, Instant, u32)) -> Option<u32> {
        let start = Instant::now();
        let mut life = Life::new(start);
        (0..10_000).find(|&ms| {
            let now = start + MS * ms;
            sign(&mut life, now, ms);
            life.due(now) == Due::Frozen
        })
    }

    #[test]
    fn a_page_that_answers_pings_lives_and_one_that_stops_is_frozen_within_two_seconds() {
        let alive = frozen_after(|life, now, ms| {
            if ms % 500 == 0 {
                life.seen(now);
            }
        });
        assert_eq!(alive, None);
        let frozen = frozen_after(|life, now, ms| {
            if ms % 500 == 0 && ms <= 3000 {
                life.seen(now);
            }
        });
        assert_eq!(frozen, Some(4250));
    }

    /// The browser answers pings for a script that hangs.
    #[test]
    fn pings_do_not_stand_in_for_a_script_that_has_given_signs() {
        let frozen = frozen_after(|life, now, ms| {
            life.seen(now);
            if ms % 500 == 0 && ms <= 2000 {
                life.here(now);
            }
        });
        assert_eq!(frozen, Some(3250));
    }
}
