//! One connection: its request judged, then the page given, or the robot's bytes carried until it closes.

use std::io::{self, Read as _, Write as _};
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::gate::{Gate, PROTOCOL, Refusal, Wanted};
use super::hub::{FromPage, PageId, ToPage};

/// A head longer than this is no browser's.
const LONGEST_HEAD: usize = 8 << 10;
/// Who says nothing for so long is let go.
const PATIENCE: Duration = Duration::from_secs(2);
/// Longest wait for bytes of the page before the robot's are passed on.
const TURN: Duration = Duration::from_millis(2);
/// Pieces that wait for a page: about two seconds of a busy line.
const WAITING: usize = 1024;
/// No frame of the robot's is longer, and a page sends few at once.
const LONGEST_MESSAGE: usize = 8 << 10;

/// What all connections share.
pub(super) struct House {
    pub(super) gate: Gate,
    pub(super) page: Vec<u8>,
    pub(super) hub: Sender<(PageId, FromPage)>,
}

impl House {
    /// Serves a connection to its end.
    ///
    /// # Errors
    /// The network's: nobody is left to be told.
    pub(super) fn serve(&self, mut stream: TcpStream, id: PageId) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let head = read_head(&mut stream)?;
        let here = stream.local_addr()?;
        match self.gate.judge(&head, here) {
            Ok(Wanted::Page { head_only }) => {
                let body: &[u8] = if head_only { &[] } else { &self.page };
                let length = self.page.len();
                answer(&mut stream, "200 OK", "text/html", length, body)
            }
            Ok(Wanted::Link { accept }) => {
                write!(
                    stream,
                    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                     Sec-WebSocket-Accept: {accept}\r\nSec-WebSocket-Protocol: {PROTOCOL}\r\n\r\n"
                )?;
                self.carry(stream, id)
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
        let config = WebSocketConfig::default()
            .max_message_size(Some(LONGEST_MESSAGE))
            .max_frame_size(Some(LONGEST_MESSAGE));
        let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
        let (page, told) = sync_channel(WAITING);
        let tell = |wanted| {
            self.hub
                .send((id, wanted))
                .map_err(|_| io::ErrorKind::BrokenPipe.into())
        };
        tell(FromPage::Came(page))?;
        let carried = carry(&mut socket, &told, tell);
        let _ = self.hub.send((id, FromPage::Left));
        // It may have gone without a word.
        let _ = socket.close(None).and_then(|()| socket.flush());
        carried
    }
}

fn carry(
    socket: &mut WebSocket<TcpStream>,
    told: &Receiver<ToPage>,
    tell: impl Fn(FromPage) -> io::Result<()>,
) -> io::Result<()> {
    loop {
        match socket.read() {
            Ok(Message::Binary(frames)) => tell(FromPage::Frames(frames.into()))?,
            Ok(Message::Text(text)) => match serde_json::from_str(&text) {
                Ok(ask) => tell(FromPage::Asks(ask))?,
                Err(_) => return Err(io::ErrorKind::InvalidData.into()),
            },
            Ok(Message::Close(_)) => return Ok(()),
            Ok(_) => {}
            Err(Error::Io(error)) if is_nothing_yet(&error) => {}
            Err(Error::Io(error)) => return Err(error),
            Err(_) => return Ok(()),
        }
        loop {
            let message = match told.try_recv() {
                Ok(ToPage::Bytes(bytes)) => Message::Binary(bytes.to_vec().into()),
                Ok(ToPage::Says(said)) => Message::Text(
                    serde_json::to_string(&said)
                        .map_err(io::Error::other)?
                        .into(),
                ),
                Err(TryRecvError::Empty) => break,
                // It did not keep up.
                Err(TryRecvError::Disconnected) => return Ok(()),
            };
            socket.write(message).map_err(io::Error::other)?;
        }
        match socket.flush() {
            Ok(()) => {}
            Err(Error::Io(error)) if is_nothing_yet(&error) => {}
            Err(error) => return Err(io::Error::other(error)),
        }
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
        let count = stream.read(&mut piece)?;
        head.extend_from_slice(piece.get(..count).unwrap_or_default());
        if count == 0 || head.len() > LONGEST_HEAD || begun.elapsed() > PATIENCE {
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
