//! `swimmer lab`: gives the lab page to a browser, and lends it the robot's port where the browser has no way of its own.

mod callers;
mod gate;
mod hub;
mod page;
mod visitor;

use std::fmt;
use std::io::{self, IsTerminal as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use serde::Serialize;
use swimmer_files::write_atomically;

use self::callers::{Caller, Callers};
use self::gate::{Gate, Token};
pub(crate) use self::page::{beside, own};
use self::visitor::Server;
use crate::commands::robot::{CamerasOverLink, LinkMonitorOptions, SharedPortOptions};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::new_file::may_be_written;
use crate::output::{Output, aside, for_scripts};

/// Interval at which the listening thread checks if it shall end.
const LOOK: Duration = Duration::from_millis(20);

/// Open the lab page: height map, gaits to drag, and the robot
///
/// The page works alone, opened from disk; served, it also reaches a robot that --port names, from any browser on this machine.
/// The address that is printed holds a token: who has it may drive. Ctrl-C ends it, and stops a robot that a page drives.
#[derive(Debug, clap::Args)]
pub(crate) struct Lab {
    /// Write the page to this file and end; it opens from disk, without a server
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["port", "listen", "no_browser"])]
    export: Option<PathBuf>,
    /// The page, in place of the one that `cargo xtask lab` made or that came with this program
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
    /// Serve here, in place of a free port of the loopback: other machines reach what is no loopback address
    #[arg(
        long,
        value_name = "HOST:PORT",
        default_value = "127.0.0.1:0",
        hide_default_value = true
    )]
    listen: String,
    /// Start no browser
    #[arg(long)]
    no_browser: bool,
    #[command(flatten)]
    port: SharedPortOptions,
    #[command(flatten)]
    monitor: LinkMonitorOptions,
}

#[derive(Debug, Serialize)]
struct Exported {
    page: String,
    bytes: usize,
}

impl fmt::Display for Exported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} ({} kB): open it in a browser.",
            self.page,
            self.bytes / 1000
        )
    }
}

#[derive(Debug, Serialize)]
struct Served {
    /// Connections of browsers.
    connections: u64,
}

impl fmt::Display for Served {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Served {} connections.", self.connections)
    }
}

impl Lab {
    /// Serves until Ctrl-C, or writes the page.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.export.as_deref().map_or(Ok(()), may_be_written)?;
        let page = page::load(self.page.as_deref())?;
        if let Some(path) = &self.export {
            write_atomically(path, &page)?;
            output.print(&Exported {
                page: path.display().to_string(),
                bytes: page.len(),
            });
            return Ok(());
        }
        let interrupt = Interrupt::install_with_a_robot()?;
        let listener = listen(&self.listen)?;
        let cameras = self.monitor.cameras(self.port.is_fresh())?;
        let mut port = self.port.open("swimmer lab", cameras.as_ref())?;
        let monitor = cameras.map(CamerasOverLink::start).transpose()?;
        let gate = Gate {
            token: Token::new()?,
            name: host_name(&self.listen),
            has_robot: port.is_some(),
        };
        let address = address(&listener, &gate)?;
        output.line(&format!("The lab page is at {address}\nCtrl-C ends it."));
        if !self.no_browser && !for_scripts() && io::stdout().is_terminal() {
            // Where there is no browser to start, the address stands there.
            let _ = open::that_detached(&address);
        }
        let (hub, inbox) = hub::inbox();
        let server = Server { gate, page, hub };
        let ended = interrupt.clone();
        let door = thread::Builder::new()
            .spawn(move || attend(&listener, server, &ended))
            .map_err(|error| {
                Failure::Tried(format!(
                    "the system gave no thread to listen with: {error}; try again"
                ))
            })?;
        match &mut port {
            Some(port) => hub::run(port, &inbox, monitor.as_ref(), || !interrupt.requested()),
            None => {
                while !interrupt.requested() {
                    thread::sleep(LOOK);
                }
            }
        }
        let connections = door.join().unwrap_or_default();
        output.print(&Served { connections });
        Ok(())
    }
}

/// # Errors
/// [`Failure::BadInput`] for what is no address, [`Failure::Tried`] where the system refuses it.
fn listen(named: &str) -> Outcome<TcpListener> {
    let places: Vec<SocketAddr> = named
        .to_socket_addrs()
        .map_err(|error| {
            Failure::BadInput(format!(
                "--listen `{named}` is no address: {error}; write HOST:PORT, as 127.0.0.1:8080"
            ))
        })?
        .collect();
    let listener = TcpListener::bind(places.as_slice()).map_err(|error| {
        Failure::Tried(format!(
            "cannot serve the page at {named}: {error}; choose another address or port"
        ))
    })?;
    listener
        .set_nonblocking(true)
        .map_err(|error| Failure::Tried(format!("cannot wait for browsers at {named}: {error}")))?;
    Ok(listener)
}

/// The host name in `--listen`. Returns `None` for an address.
fn host_name(named: &str) -> Option<String> {
    let (host, _) = named.rsplit_once(':')?;
    let is_address = host.trim_matches(['[', ']']).parse::<IpAddr>().is_ok();
    (!is_address).then(|| host.to_owned())
}

/// URL for a browser.
fn address(listener: &TcpListener, gate: &Gate) -> Outcome<String> {
    let place = listener.local_addr().map_err(|error| {
        Failure::Tried(format!("cannot tell where the page is served: {error}"))
    })?;
    if !place.ip().is_loopback() {
        aside(
            "note: other machines reach this page at this one's address, and the token crosses the network in the clear: anyone who reads it may drive the robot",
        );
    }
    let host = typed(gate.name.as_deref(), place);
    Ok(if gate.has_robot {
        format!("http://{host}/#link={}", gate.token)
    } else {
        format!("http://{host}/")
    })
}

/// Host and port as they are typed on this machine.
fn typed(name: Option<&str>, place: SocketAddr) -> String {
    let port = place.port();
    match name {
        Some(name) => format!("{name}:{port}"),
        // All addresses at once, which cannot be typed.
        None if place.ip().is_unspecified() => format!("127.0.0.1:{port}"),
        None => place.to_string(),
    }
}

/// Accepts connections until the end; each has a thread.
fn attend(listener: &TcpListener, server: Server, ended: &Interrupt) -> u64 {
    let server = Arc::new(server);
    let callers = Callers::default();
    let mut connections = 0;
    while !ended.requested() {
        let Ok((stream, _)) = listener.accept() else {
            thread::sleep(LOOK);
            continue;
        };
        connections += 1;
        let caller = callers.add(connections, &stream);
        let server = Arc::clone(&server);
        // Without a thread the connection is closed. A browser that goes away in the middle needs no reply.
        let _ = thread::Builder::new().spawn(move || serve(&server, stream, caller));
    }
    connections
}

fn serve(server: &Server, stream: TcpStream, caller: Caller) -> io::Result<()> {
    // It may have inherited the listener's way.
    stream.set_nonblocking(false)?;
    server.serve(stream, caller)
}

#[cfg(test)]
mod tests {
    use super::typed;

    #[test]
    fn the_address_can_be_typed() {
        let typed = |name, place: &str| typed(name, place.parse().unwrap());
        assert_eq!(typed(None, "127.0.0.1:7070"), "127.0.0.1:7070");
        assert_eq!(typed(None, "[::1]:7070"), "[::1]:7070");
        assert_eq!(typed(None, "0.0.0.0:7070"), "127.0.0.1:7070");
        assert_eq!(typed(None, "[::]:7070"), "127.0.0.1:7070");
        assert_eq!(typed(Some("lab-pc"), "192.0.2.7:80"), "lab-pc:80");
    }
}
