//! UDP sockets of client and server.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs as _, UdpSocket};
use std::time::Duration;

use socket2::{Domain, Protocol, Socket, Type};

use super::{COMMAND_PORT, Client, DATA_PORT, GROUP, NatNetError, Server, short};
use crate::source::NatNetAddress;
use crate::stream::Outlet;
use crate::{Frame, Mapping, SourceError};

/// Largest datagram over IPv4.
const LARGEST: usize = 65_507;
/// A read waits at most so long: until the stop flag is looked at, and until the next keep-alive.
const WAIT: Duration = Duration::from_millis(20);
/// Longest wait for a reply or a multicast frame \[s\].
const PATIENCE_S: f64 = 5.0;
/// Datagrams that a server takes in one turn.
const TURN: usize = 64;
/// Bytes that the system keeps for a reader that is late: a second of 240 frames of 4 kB.
const RECEIVE_BUFFER: usize = 1 << 20;

fn failed(doing: impl Into<String>, advice: &'static str) -> impl FnOnce(io::Error) -> SourceError {
    let doing = doing.into();
    move |cause| SourceError::Socket {
        doing,
        cause,
        advice,
    }
}

/// Returns `true` if a read only found nothing; Windows reports an unreachable peer of an earlier send as a reset.
fn is_quiet(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock
            | io::ErrorKind::TimedOut
            | io::ErrorKind::Interrupted
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionRefused
    )
}

/// A socket in a multicast group, next to others at the same port.
fn group_socket(group: Ipv4Addr, port: u16, local: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.set_reuse_address(true)?;
    // Smaller where the system's limit is.
    let _ = socket.set_recv_buffer_size(RECEIVE_BUFFER);
    socket.bind(&SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, port).into())?;
    socket.join_multicast_v4(&group, &local)?;
    socket.set_read_timeout(Some(WAIT))?;
    Ok(socket.into())
}

/// Reads a stream until it is stopped.
pub(crate) fn receive(
    outlet: &Outlet,
    address: &NatNetAddress,
    mapping: Mapping,
) -> Result<(), SourceError> {
    let local = address.local.unwrap_or(Ipv4Addr::UNSPECIFIED);
    let mut buffer = vec![0; LARGEST];
    let server = match &address.host {
        Some(host) => resolved(host)?,
        None => match discovered(outlet, local, &mut buffer)? {
            Some(server) => server,
            None => return Ok(()),
        },
    };
    let socket = UdpSocket::bind(SocketAddrV4::new(local, 0))
        .and_then(|socket| socket.set_read_timeout(Some(WAIT)).map(|()| socket))
        .map_err(failed(
            format!("opening a UDP socket at {local}"),
            "name the address of a local interface: natnet:HOST,LOCAL",
        ))?;
    let mut connection = Connection {
        server,
        local,
        socket,
        group: None,
        client: Client::new(mapping),
        buffer,
    };
    let outcome = connection.run(outlet);
    let goodbye = natnet::command::disconnect_datagram();
    let _ = connection.socket.send_to(&goodbye, connection.server);
    outcome
}

struct Connection {
    server: SocketAddr,
    local: Ipv4Addr,
    socket: UdpSocket,
    /// Frames of a multicast server.
    group: Option<UdpSocket>,
    client: Client,
    buffer: Vec<u8>,
}

impl Connection {
    fn run(&mut self, outlet: &Outlet) -> Result<(), SourceError> {
        let begun_s = outlet.now_s();
        while !outlet.is_stopped() {
            while let Some(request) = self.client.due(outlet.now_s()) {
                // A server that is not there yet is greeted again.
                let _ = self.socket.send_to(&request, self.server);
            }
            if self.group.is_some() {
                self.read(outlet, true)?;
            }
            self.read(outlet, false)?;
            if self.client.server().is_none() && outlet.now_s() - begun_s > PATIENCE_S {
                let server = self.server.to_string();
                return Err(NatNetError::NoReply { server }.into());
            }
        }
        Ok(())
    }

    /// Takes one datagram from one of the sockets, if there is one.
    fn read(&mut self, outlet: &Outlet, of_group: bool) -> Result<(), SourceError> {
        let socket = match (&self.group, of_group) {
            (Some(group), true) => group,
            _ => &self.socket,
        };
        let (count, from) = match socket.recv_from(&mut self.buffer) {
            Ok(read) => read,
            Err(error) if is_quiet(&error) => return Ok(()),
            Err(error) => {
                let doing = format!("reading NatNet datagrams from {}", self.server);
                return Err(failed(doing, "check the network")(error));
            }
        };
        if from.ip() != self.server.ip() {
            return Ok(());
        }
        let greeted = self.client.server().is_some();
        let datagram = self.buffer.get(..count).unwrap_or_default();
        if let Some(frame) = self.client.receive(datagram, outlet.now_s())? {
            outlet.send(frame);
        }
        outlet.note_malformed(self.client.malformed(), || "a NatNet datagram".to_owned());
        if !greeted {
            self.begin(outlet)?;
        }
        Ok(())
    }

    /// After the server's reply: joins the group of a multicast server.
    fn begin(&mut self, outlet: &Outlet) -> Result<(), SourceError> {
        let Some(info) = self.client.server() else {
            return Ok(());
        };
        let transmission = if info.connection.multicast {
            "multicast"
        } else {
            "unicast"
        };
        outlet.describe(format!(
            "{} {} at {}, NatNet {}, {transmission}",
            info.application_name,
            short(info.server_version),
            self.server,
            short(info.protocol_version),
        ));
        if info.connection.multicast {
            let (group, port) = (info.multicast_group(), info.connection.data_port);
            let joined = group_socket(group, port, self.local).map_err(failed(
                format!("joining the multicast group {group}:{port}"),
                "name the local interface: natnet:HOST,LOCAL",
            ))?;
            // Replies are rare from now on, and must not hold up frames.
            self.socket
                .set_nonblocking(true)
                .map_err(failed("setting up the command socket", "start again"))?;
            self.group = Some(joined);
        }
        Ok(())
    }
}

/// The command port of a host, by default 1510.
fn resolved(host: &str) -> Result<SocketAddr, SourceError> {
    let has_port = host.rsplit_once(':').is_some();
    let found = if has_port {
        host.to_socket_addrs()
    } else {
        (host, COMMAND_PORT).to_socket_addrs()
    };
    let advice = "write it as natnet:192.168.1.10, or natnet:192.168.1.10,LOCAL with the address of the local interface";
    found
        .map_err(failed(format!("finding the NatNet server {host}"), advice))?
        .find(SocketAddr::is_ipv4)
        .ok_or_else(|| {
            failed(format!("finding the NatNet server {host}"), advice)(io::Error::other(
                "it has no IPv4 address",
            ))
        })
}

/// The sender of the first multicast frame; `None` if the stream is stopped before.
fn discovered(
    outlet: &Outlet,
    local: Ipv4Addr,
    buffer: &mut [u8],
) -> Result<Option<SocketAddr>, SourceError> {
    let group = Ipv4Addr::from(GROUP);
    let place = format!("{group}:{DATA_PORT}");
    let socket = group_socket(group, DATA_PORT, local).map_err(failed(
        format!("joining the multicast group {place}"),
        "name server and local interface: natnet:HOST,LOCAL",
    ))?;
    let begun_s = outlet.now_s();
    while !outlet.is_stopped() {
        if let Ok((count, from)) = socket.recv_from(buffer) {
            let datagram = buffer.get(..count).unwrap_or_default();
            let is_frame = natnet::MessageHeader::parse(datagram)
                .is_ok_and(|header| header.message_id == natnet::NAT_FRAMEOFDATA);
            if is_frame {
                return Ok(Some(SocketAddr::new(from.ip(), COMMAND_PORT)));
            }
        }
        if outlet.now_s() - begun_s > PATIENCE_S {
            return Err(NatNetError::NoStream { group: place }.into());
        }
    }
    Ok(None)
}

/// A socket that failed for good.
#[derive(Debug, thiserror::Error)]
#[error("{doing}: {cause}")]
pub struct SocketFailure {
    /// The operation and its address.
    pub doing: String,
    /// The system's words.
    pub cause: io::Error,
}

/// A [`Server`] behind a UDP socket; never blocks.
#[derive(Debug)]
pub struct NatNetSocket {
    socket: UdpSocket,
    server: Server,
    buffer: Vec<u8>,
}

impl NatNetSocket {
    /// Binds the command port; frames of a multicast server leave by the interface of `address`.
    ///
    /// # Errors
    /// The address is not local, or its port is in use.
    pub fn bind(address: SocketAddrV4, server: Server) -> Result<Self, SocketFailure> {
        let bind = || {
            let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
            socket.bind(&address.into())?;
            socket.set_nonblocking(true)?;
            if server.info().connection.multicast {
                socket.set_multicast_if_v4(address.ip())?;
                socket.set_multicast_loop_v4(true)?;
            }
            Ok(socket.into())
        };
        let socket = bind().map_err(|cause| SocketFailure {
            doing: format!("opening the NatNet command port {address}"),
            cause,
        })?;
        Ok(Self {
            socket,
            server,
            buffer: vec![0; LARGEST],
        })
    }

    /// Address of the command port.
    ///
    /// # Errors
    /// The system's, if it does not know.
    pub fn local_addr(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Clients at the moment.
    pub fn clients(&self) -> usize {
        self.server.clients()
    }

    /// Replies to requests that have come. `now_s` is the host clock.
    pub fn reply(&mut self, now_s: f64) {
        for _ in 0..TURN {
            let Ok((count, from)) = self.socket.recv_from(&mut self.buffer) else {
                return;
            };
            let datagram = self.buffer.get(..count).unwrap_or_default();
            if let Some(reply) = self.server.receive(datagram, from, now_s) {
                // A client that is gone needs no reply.
                let _ = self.socket.send_to(&reply, from);
            }
        }
    }

    /// Sends a frame to every client, or to the group; `sent_s` is the camera clock, `now_s` the host clock.
    pub fn send(&mut self, frame: &Frame, sent_s: f64, now_s: f64) {
        let group = SocketAddr::from((GROUP, DATA_PORT));
        for datagram in self.server.frame(frame, sent_s, now_s) {
            // UDP: what the network does not take is lost.
            let to = datagram.to.unwrap_or(group);
            let _ = self.socket.send_to(&datagram.bytes, to);
        }
    }
}
