//! Port over TCP: the digital twin listens, and a program on this or another machine connects.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::Port;

/// One end of a TCP connection. The listening end accepts one client at a time.
#[derive(Debug)]
pub struct TcpPort {
    listener: Option<TcpListener>,
    stream: Option<TcpStream>,
    opened: Instant,
}

/// Time-out of a connection attempt per address.
const TO_CONNECT: Duration = Duration::from_secs(3);
/// Polling interval for an absent client.
const LOOK: Duration = Duration::from_millis(5);

impl TcpPort {
    /// Listens at `address`; port 0 selects a free one.
    ///
    /// # Errors
    /// The system's error: the address is in use or not local.
    pub fn listen(address: impl ToSocketAddrs) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener: Some(listener),
            stream: None,
            opened: Instant::now(),
        })
    }

    /// Connects to a listening port.
    ///
    /// # Errors
    /// The system's error: refused, unreachable, unknown name.
    pub fn connect(address: impl ToSocketAddrs) -> io::Result<Self> {
        let mut last = io::ErrorKind::NotFound.into();
        let stream = address.to_socket_addrs()?.find_map(|address| {
            TcpStream::connect_timeout(&address, TO_CONNECT)
                .map_err(|error| last = error)
                .ok()
        });
        let stream = stream.ok_or(last)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(Duration::from_secs(1)))?;
        Ok(Self {
            listener: None,
            stream: Some(stream),
            opened: Instant::now(),
        })
    }

    /// Local address of a listening port.
    pub fn local_addr(&self) -> Option<SocketAddr> {
        self.listener
            .as_ref()
            .and_then(|listener| listener.local_addr().ok())
    }

    /// Returns true if a client is connected.
    pub fn client_present(&self) -> bool {
        self.stream.is_some()
    }

    fn accept(&mut self) -> io::Result<()> {
        let (None, Some(listener)) = (&self.stream, &self.listener) else {
            return Ok(());
        };
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                // A client that stops reading must not block the robot.
                stream.set_write_timeout(Some(Duration::from_millis(20)))?;
                self.stream = Some(stream);
                Ok(())
            }
            Err(error) if transient(&error) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Handles the end of a connection: the listening end waits for the next one, the other end fails.
    fn gone(&mut self, reason: io::Error) -> io::Result<()> {
        self.stream = None;
        if self.listener.is_some() {
            Ok(())
        } else {
            Err(reason)
        }
    }
}

fn transient(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock
            | io::ErrorKind::TimedOut
            | io::ErrorKind::Interrupted
            | io::ErrorKind::ConnectionAborted
    )
}

impl Port for TcpPort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let deadline = self.opened.elapsed() + timeout;
        loop {
            self.accept()?;
            let left = deadline.saturating_sub(self.opened.elapsed());
            if let Some(stream) = &mut self.stream {
                // A zero time-out would mean no limit.
                stream.set_read_timeout(Some(left.max(Duration::from_micros(100))))?;
                match stream.read(buf) {
                    Ok(0) => self.gone(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "the twin closed the connection",
                    ))?,
                    Ok(count) => return Ok(count),
                    Err(error) if transient(&error) => {}
                    Err(error) => self.gone(error)?,
                }
            } else {
                std::thread::sleep(left.min(LOOK));
            }
            if self.opened.elapsed() >= deadline {
                return Ok(0);
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.accept()?;
        let Some(stream) = &mut self.stream else {
            return Ok(());
        };
        match stream.write_all(bytes) {
            Ok(()) => Ok(()),
            Err(error) => self.gone(error),
        }
    }

    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.accept()?;
        let Some(stream) = &mut self.stream else {
            return Ok(bytes.len());
        };
        let written = stream
            .set_nonblocking(true)
            .and_then(|()| stream.write(bytes));
        stream.set_nonblocking(false)?;
        match written {
            Ok(count) => Ok(count),
            Err(error) if transient(&error) => Ok(0),
            Err(error) => self.gone(error).map(|()| bytes.len()),
        }
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOMENT: Duration = Duration::from_secs(2);

    #[test]
    fn a_client_may_leave_and_another_come() {
        let mut robot = TcpPort::listen("127.0.0.1:0").unwrap();
        let address = robot.local_addr().unwrap();
        let mut buf = [0; 8];
        robot.write(b"for nobody").unwrap();
        for round in 0..2u8 {
            let mut host = TcpPort::connect(address).unwrap();
            host.write(&[round, 1]).unwrap();
            assert_eq!(robot.read(&mut buf, MOMENT).unwrap(), 2);
            robot.write(&[round, 2, 3]).unwrap();
            assert_eq!(host.read(&mut buf, MOMENT).unwrap(), 3);
            assert_eq!(buf[..3], [round, 2, 3]);
            drop(host);
            assert_eq!(robot.read(&mut buf, Duration::from_millis(20)).unwrap(), 0);
            assert!(!robot.client_present());
        }
    }
}
