//! `swimmer lab --port`: the robot over a WebSocket, driven by the host's own session and by nothing of the server's.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle, sleep};
use std::time::{Duration, Instant};

#[cfg(unix)]
use host_link::port::PtyPort;
use host_link::{LinkError, Port, Robot};
use link_protocol::{Decoder, Header, Request, StateName};
use serde_json::{Value, json};
use swimmer_files::AnyGait;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Error, Message, WebSocket};

use crate::binary::{TwinProcess, command, interrupt, swimmer_in};

const PAGE: &str = concat!(
    "<!doctype html><meta name=\"swimmer-lab\" content=\"",
    env!("CARGO_PKG_VERSION"),
    " 0123456\"><title>the page</title>"
);
const PATIENCE: Duration = Duration::from_secs(20);

/// A served page, with a robot.
struct Lab {
    child: Child,
    host: String,
    token: String,
}

impl Lab {
    fn start(folder: &Path, port: &str) -> Self {
        std::fs::write(folder.join("page.html"), PAGE).unwrap();
        let words = ["lab", "--port", port, "--page", "page.html", "--no-browser"];
        let mut child = command(folder, &words)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut line)
            .unwrap();
        let address = line
            .trim()
            .rsplit_once("http://")
            .unwrap_or_else(|| panic!("no address in {line:?}"))
            .1;
        let (host, token) = address.split_once("/#link=").unwrap();
        Self {
            host: host.to_owned(),
            token: token.to_owned(),
            child,
        }
    }

    /// Opens the link as a page does; the status where it is refused.
    fn link(&self, changes: &[(&'static str, &str)]) -> Result<WebPort, u16> {
        let mut request = format!("ws://{}/link", self.host)
            .into_client_request()
            .unwrap();
        let protocols = format!("swimmer, {}", self.token);
        let origin = format!("http://{}", self.host);
        let usual = [
            ("Sec-WebSocket-Protocol", protocols.as_str()),
            ("Origin", &origin),
        ];
        for (name, value) in usual.into_iter().chain(changes.iter().copied()) {
            request
                .headers_mut()
                .insert(name, HeaderValue::from_str(value).unwrap());
        }
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_nodelay(true).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(WebPort::new(socket)),
            Err(tungstenite::HandshakeError::Failure(Error::Http(answer))) => {
                Err(answer.status().as_u16())
            }
            Err(error) => panic!("{error}"),
        }
    }

    fn drive(&self) -> Robot<WebPort> {
        Robot::connect(self.link(&[]).unwrap(), 7).unwrap()
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page's end of the WebSocket, as the host's session wants it.
struct WebPort {
    socket: WebSocket<TcpStream>,
    waiting: Vec<u8>,
    says: Vec<Value>,
    opened: Instant,
}

impl WebPort {
    fn new(socket: WebSocket<TcpStream>) -> Self {
        Self {
            socket,
            waiting: Vec::new(),
            says: Vec::new(),
            opened: Instant::now(),
        }
    }

    fn ask(&mut self, word: &str) {
        let text = json!({ "ask": word }).to_string();
        self.socket.send(Message::text(text)).unwrap();
    }

    /// Listens until the server says something that fits.
    fn until(&mut self, fits: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            if let Some(index) = self.says.iter().position(&fits) {
                return self.says.drain(..=index).next_back().unwrap();
            }
            assert!(
                begun.elapsed() < PATIENCE,
                "it never came, but {:?}",
                self.says
            );
            self.read(&mut [0; 512], Duration::from_millis(20)).unwrap();
        }
    }

    fn until_wheel(&mut self, yours: bool, free: bool) {
        self.until(|said| *said == json!({ "told": "wheel", "yours": yours, "free": free }));
    }
}

impl Port for WebPort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if self.waiting.is_empty() {
            self.socket
                .get_ref()
                .set_read_timeout(Some(timeout.max(Duration::from_millis(1))))?;
            match self.socket.read() {
                Ok(Message::Binary(bytes)) => self.waiting.extend_from_slice(&bytes),
                Ok(Message::Text(text)) => self.says.push(serde_json::from_str(&text)?),
                Ok(_) => {}
                Err(Error::Io(error))
                    if matches!(
                        error.kind(),
                        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                    ) => {}
                Err(error) => return Err(io::Error::other(error)),
            }
        }
        let count = self.waiting.len().min(buf.len());
        buf[..count].copy_from_slice(&self.waiting[..count]);
        self.waiting.drain(..count);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.socket
            .send(Message::binary(bytes.to_vec()))
            .map_err(io::Error::other)
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

/// A circle, as the robot takes it.
fn circle() -> Vec<u8> {
    let table = forecast::table(&AnyGait::circle(0.5), 64).unwrap();
    table.bytes().to_vec()
}

fn upload(robot: &mut Robot<WebPort>) {
    robot
        .upload(&circle(), PATIENCE, |_| std::ops::ControlFlow::Continue(()))
        .unwrap();
}

fn play(robot: &mut Robot<WebPort>) {
    robot.arm(false).unwrap();
    robot.play(0, Duration::from_secs(4), false).unwrap();
    until(robot, StateName::Playing);
}

fn until(robot: &mut Robot<WebPort>, state: StateName) {
    let begun = Instant::now();
    while robot.status().unwrap().state != state {
        assert!(
            begun.elapsed() < PATIENCE,
            "never {state:?}: {:?}",
            robot.status()
        );
        robot
            .listen(Duration::from_millis(50), |_| {
                std::ops::ControlFlow::Continue(())
            })
            .unwrap();
    }
}

#[test]
fn a_page_drives_the_robot_and_another_one_watches_and_stops_it() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let mut driver = lab.drive();
    upload(&mut driver);
    play(&mut driver);

    let mut watcher = lab.link(&[("Origin", "null")]).unwrap();
    watcher.until_wheel(false, false);
    // A watcher's frames are dropped; its requests in words are served.
    watcher.write(&[0; 64]).unwrap();
    watcher.ask("drive");
    watcher.until_wheel(false, false);
    until(&mut driver, StateName::Playing);
    watcher.ask("estop");
    until(&mut driver, StateName::EStopped);
    driver.clear_estop().unwrap();
    play(&mut driver);
    watcher.ask("stop");
    until(&mut driver, StateName::Stopped);

    // The one that drives goes: the next one may have the wheel.
    drop(driver);
    watcher.until_wheel(false, true);
    watcher.ask("drive");
    watcher.until_wheel(true, false);
    let mut driver = Robot::connect(watcher, 8).unwrap();
    assert_eq!(driver.status().unwrap().state, StateName::Stopped);
}

#[test]
fn a_page_that_vanishes_takes_its_lease_along() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let mut driver = lab.drive();
    upload(&mut driver);
    play(&mut driver);
    let mut watcher = lab.link(&[]).unwrap();
    watcher.until_wheel(false, false);
    // Silent, but still connected: no other page feeds the lease in its place.
    sleep(Duration::from_secs(1));
    until(&mut driver, StateName::Stopped);
}

/// A page that hangs answers no pings, keeps its connection, and loses the wheel.
#[test]
fn a_frozen_page_loses_the_wheel_within_two_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let mut driver = lab.drive();
    let mut watcher = lab.link(&[]).unwrap();
    watcher.until_wheel(false, false);
    driver.status().unwrap();
    let frozen = Instant::now();
    watcher.until_wheel(false, true);
    let lost = frozen.elapsed();
    assert!(lost < Duration::from_secs(2), "after {lost:?}");
    watcher.ask("drive");
    watcher.until_wheel(true, false);
    drop(driver);
}

/// Its browser answers pings all the same: the page gives signs of life by itself.
#[test]
fn a_page_whose_script_hangs_loses_the_wheel_within_two_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let mut driver = lab.link(&[]).unwrap();
    driver.until_wheel(true, false);
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(3) {
        driver.ask("here");
        driver
            .read(&mut [0; 512], Duration::from_millis(200))
            .unwrap();
    }
    assert!(
        driver.says.iter().all(|said| said["told"] != "wheel"),
        "{:?}",
        driver.says
    );
    let hangs = Instant::now();
    driver.until_wheel(false, true);
    let lost = hangs.elapsed();
    assert!(lost < Duration::from_secs(2), "after {lost:?}");
}

/// Most bytes before a stop. The line discipline at the robot's end of a terminal has up to 4096: they have arrived. Without the
/// stop's lane there are ten times as many, in the terminal and in the queue.
#[cfg(unix)]
const ARRIVED: usize = 4096 + 512;

/// A robot's end of a pseudo-terminal that reads nothing until it is allowed to.
#[cfg(unix)]
struct SilentRobot(PtyPort);

#[cfg(unix)]
impl SilentRobot {
    fn at(folder: &Path) -> Self {
        Self(PtyPort::open(Some(&folder.join("robot"))).unwrap())
    }

    /// Reads until a stop of this kind comes; the bytes before it.
    fn until_stop(&mut self, wanted: &Request, patience: Duration) -> Option<usize> {
        let (begun, mut decoder, mut before) = (Instant::now(), Decoder::new(), 0);
        let mut buf = [0; 512];
        while begun.elapsed() < patience {
            let count = self.0.read(&mut buf, Duration::from_millis(1)).unwrap();
            for byte in &buf[..count] {
                before += 1;
                let received = decoder.push(*byte);
                if received.is_some_and(|received| {
                    received.message == Ok(link_protocol::Message::Request(wanted.clone()))
                }) {
                    return Some(before);
                }
            }
        }
        None
    }
}

/// Sends frames for the robot as fast as the connection takes them, until its end flag is set.
#[cfg(unix)]
fn flood(mut page: WebPort) -> (Arc<AtomicBool>, JoinHandle<()>) {
    let end = Arc::new(AtomicBool::new(false));
    let ended = Arc::clone(&end);
    let mut frame = [0; link_protocol::MAX_ENCODED];
    let message = link_protocol::Message::Request(Request::Status);
    let len = link_protocol::encode(Header::new(7, 1), &message, &mut frame).unwrap();
    let frames = frame[..len].repeat(100);
    let flooding =
        thread::spawn(
            move || {
                while !ended.load(Ordering::Relaxed) && page.write(&frames).is_ok() {}
            },
        );
    (end, flooding)
}

/// Resident memory of a process, bytes.
#[cfg(target_os = "linux")]
fn memory(process: &Child) -> usize {
    let status = std::fs::read_to_string(format!("/proc/{}/status", process.id())).unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmRSS"))
        .unwrap();
    let kib: usize = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kib << 10
}

/// A page that sends without end to a port that takes nothing delays no stop of another page, eats no memory, and keeps
/// Ctrl-C from nothing.
#[cfg(target_os = "linux")]
#[test]
fn a_saturated_port_delays_no_stop_and_no_ctrl_c() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = SilentRobot::at(folder.path());
    let mut lab = Lab::start(folder.path(), "robot");
    let mut driver = lab.link(&[]).unwrap();
    driver.until_wheel(true, false);
    let mut watcher = lab.link(&[]).unwrap();
    watcher.until_wheel(false, false);
    let at_first = memory(&lab.child);
    let (end, flooding) = flood(driver);
    sleep(Duration::from_secs(3));
    for (word, request) in [("stop", Request::Stop), ("estop", Request::EStop)] {
        let asked = Instant::now();
        watcher.ask(word);
        // The robot reads again only now; what lay in the terminal was discarded for the stop.
        sleep(Duration::from_millis(100));
        let before = robot.until_stop(&request, Duration::from_secs(5));
        let took = asked.elapsed();
        assert!(
            before.is_some_and(|before| before < ARRIVED),
            "{word}: behind {before:?} bytes"
        );
        assert!(took < Duration::from_millis(200), "{word}: {took:?}");
        sleep(Duration::from_secs(1));
    }
    let grown = memory(&lab.child).saturating_sub(at_first);
    assert!(grown < 16 << 20, "grown by {grown} bytes");
    let pressed = Instant::now();
    interrupt(&lab.child);
    assert_eq!(lab.child.wait().unwrap().code(), Some(0));
    let took = pressed.elapsed();
    assert!(took < Duration::from_secs(2), "Ctrl-C took {took:?}");
    end.store(true, Ordering::Relaxed);
    flooding.join().unwrap();
}

/// The page that floods is the one that stops.
#[cfg(unix)]
#[test]
fn a_stop_of_the_driver_itself_passes_its_own_frames() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = SilentRobot::at(folder.path());
    let lab = Lab::start(folder.path(), "robot");
    let mut driver = lab.link(&[]).unwrap();
    driver.until_wheel(true, false);
    let frame = |request: Request| {
        let mut bytes = [0; link_protocol::MAX_ENCODED];
        let message = link_protocol::Message::Request(request);
        let len = link_protocol::encode(Header::new(7, 1), &message, &mut bytes).unwrap();
        bytes[..len].to_vec()
    };
    let status = frame(Request::Status).repeat(100);
    for _ in 0..2000 {
        driver.write(&status).unwrap();
    }
    let pressed = Instant::now();
    driver.write(&frame(Request::EStop)).unwrap();
    sleep(Duration::from_millis(100));
    let before = robot.until_stop(&Request::EStop, Duration::from_secs(5));
    let took = pressed.elapsed();
    assert!(
        before.is_some_and(|before| before < ARRIVED),
        "behind {before:?} bytes"
    );
    assert!(took < Duration::from_millis(200), "{took:?}");
}

#[cfg(unix)]
#[test]
fn sixty_slow_connections_delay_no_stop() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = SilentRobot::at(folder.path());
    let lab = Lab::start(folder.path(), "robot");
    let mut driver = lab.link(&[]).unwrap();
    driver.until_wheel(true, false);
    let slow: Vec<TcpStream> = (0..60)
        .map(|_| {
            let mut stream = TcpStream::connect(&lab.host).unwrap();
            stream.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
            stream
        })
        .collect();
    let arrived = Instant::now();
    let mut watcher = lab.link(&[]).unwrap();
    watcher.ask("estop");
    assert!(
        robot
            .until_stop(&Request::EStop, Duration::from_secs(5))
            .is_some()
    );
    let took = arrived.elapsed();
    assert!(
        took < Duration::from_millis(200),
        "with its connection {took:?}"
    );
    drop(slow);
}

#[test]
fn strangers_are_turned_away() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let port = lab.host.rsplit_once(':').unwrap().1;
    let wrong = format!("swimmer, {}", "0".repeat(32));
    let rebound = format!("rebound.example:{port}");
    for (changes, status) in [
        (vec![("Origin", "http://evil.example")], 403),
        (
            vec![("Origin", "null"), ("Sec-WebSocket-Protocol", "swimmer")],
            403,
        ),
        (vec![("Sec-WebSocket-Protocol", wrong.as_str())], 403),
        (vec![("Host", rebound.as_str())], 421),
    ] {
        assert_eq!(lab.link(&changes).err(), Some(status), "{changes:?}");
    }
    let get = |host: &str| {
        let mut stream = TcpStream::connect(&lab.host).unwrap();
        write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let page = get(&lab.host);
    assert!(
        page.starts_with("HTTP/1.1 200 OK") && page.ends_with(PAGE),
        "{page}"
    );
    assert!(!page.contains(&lab.token));
    assert!(get(&rebound).starts_with("HTTP/1.1 421"), "a rebound name");
}

#[test]
fn words_that_are_none_end_the_connection_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Lab::start(folder.path(), "twin");
    let mut driver = lab.drive();
    let mut other = lab.link(&[]).unwrap();
    other.ask("dance");
    let begun = Instant::now();
    while other.read(&mut [0; 512], Duration::from_millis(20)).is_ok() {
        assert!(begun.elapsed() < PATIENCE, "it is still connected");
    }
    driver.status().unwrap();
}

#[cfg(unix)]
#[test]
fn another_swimmer_stops_the_robot_and_ctrl_c_does() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let mut lab = Lab::start(folder.path(), "robot");
    let mut driver = lab.drive();
    upload(&mut driver);
    play(&mut driver);
    let stop = command(folder.path(), &["robot", "stop", "--port", "robot"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    until(&mut driver, StateName::Stopped);
    let stopped = stop.wait_with_output().unwrap();
    assert!(stopped.status.success());
    assert!(
        String::from_utf8(stopped.stdout)
            .unwrap()
            .contains("Stopped")
    );

    play(&mut driver);
    interrupt(&lab.child);
    assert_eq!(lab.child.wait().unwrap().code(), Some(0));
    assert!(matches!(driver.status(), Err(LinkError::Port { .. })));
    let status = swimmer_in(
        folder.path(),
        &["robot", "status", "--port", "robot", "--json"],
    )
    .with_status(0)
    .json();
    assert_ne!(status["state"], "playing");
}

#[cfg(unix)]
#[test]
fn a_cable_that_is_pulled_and_plugged_again_is_told_and_found() {
    let folder = tempfile::tempdir().unwrap();
    let mut twin = TwinProcess::start(folder.path(), &[]);
    let lab = Lab::start(folder.path(), "robot");
    let mut page = lab.link(&[]).unwrap();
    let of_port = |open: bool| move |said: &Value| said["told"] == "port" && said["open"] == open;
    page.until(of_port(true));
    twin.interrupt();
    let gone = page.until(of_port(false));
    assert!(gone["why"].as_str().unwrap().contains("gone"), "{gone}");
    let _twin = TwinProcess::start(folder.path(), &[]);
    page.until(of_port(true));
    let mut driver = Robot::connect(page, 9).unwrap();
    assert_eq!(driver.status().unwrap().state, StateName::Stopped);
}
