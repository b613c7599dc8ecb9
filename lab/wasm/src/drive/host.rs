//! Host's session with a robot to which the page has a connection.

use std::sync::mpsc;
use std::time::Duration;

use forecast::table;
use host_link::Port as _;
use host_link::port::{TracedFrame, TracedPort};
use host_link::session::{Session, SessionConfig, Ticket};
use link_protocol::{MAX_KNOTS, Request};
use operations::{Files, GaitSource};
use serde::Deserialize;
use serde_json::json;
use swimmer_files::{LinkFrame, link_log_bytes, parse_key};

use super::memory_port::MemoryPort;
use super::{Numbered, Opened, events as event_document, seconds_of, step_of};
use crate::calls::{CallOutput, Lab, Outcome, json, parsed};

/// Largest number of frames in a log, about two hours of play; older frames are dropped.
const LONGEST_LOG: usize = 400_000;
/// Time limit of an upload.
const PATIENCE: Duration = Duration::from_secs(30);

/// Receiver of each traced frame.
type Sink = Box<dyn FnMut(TracedFrame<'_>) + Send>;

/// Session with the log of its frames.
struct Host {
    session: Session,
    port: TracedPort<MemoryPort, Sink>,
    passed: mpsc::Receiver<LinkFrame>,
    log: Vec<LinkFrame>,
    /// Number of dropped frames.
    forgotten: usize,
    /// Start of the page's clock, since 1970.
    epoch: Duration,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Open {
    /// Seed, different for each page and session.
    seed: u64,
    /// Capacity of the line.
    bytes_per_second: f64,
    /// Start of the page's clock in seconds since 1970.
    epoch_s: f64,
    /// Text of a key file.
    key: Option<String>,
}

/// Opens a session without sending the greeting.
pub(super) fn open(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: Open = parsed(bytes)?;
    let key = request
        .key
        .as_deref()
        .map(|text| parse_key(text).map_err(|problem| format!("reading the key{problem}")))
        .transpose()?;
    let epoch = seconds_of(request.epoch_s)?;
    let (passes, passed) = mpsc::channel();
    let sink: Sink = Box::new(move |frame| {
        let at = epoch + frame.at;
        // The receiver exists as long as this sink.
        let _ = passes.send(LinkFrame {
            direction: frame.direction,
            host_time_ns: u64::try_from(at.as_nanos()).unwrap_or(u64::MAX),
            robot_time_us: None,
            bytes: frame.bytes.to_vec(),
        });
    });
    let host = Host {
        session: Session::new(SessionConfig {
            bytes_per_second: request.bytes_per_second,
            key,
            ..SessionConfig::new(request.seed)
        }),
        port: TracedPort::new(MemoryPort::default(), sink),
        passed,
        log: Vec::new(),
        forgotten: 0,
        epoch,
    };
    json(&Opened {
        number: lab.kept.keep(host),
    })
}

/// Passes received bytes and the time to the session. Returns `[u32][bytes to send][JSON events]`; the number is the count of
/// bytes to send.
pub(super) fn step(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let (number, now, received) = step_of(bytes)?;
    let host: &mut Host = lab.kept.get(number)?;
    let sent = host.step(now, received)?;
    let mut events = Vec::new();
    while let Some(event) = host.session.next_event() {
        events.push(event_document::event_json(&event, host.session.hello()));
    }
    let next = host
        .session
        .next_deadline()
        .map(|deadline| deadline.as_secs_f64());
    let document = json!({ "events": events, "next_s": next }).to_string();
    let count = u32::try_from(sent.len())
        .map_err(|_| "stepping: too much to be sent at once".to_owned())?;
    Ok(CallOutput::Bytes(
        [&count.to_le_bytes(), sent.as_slice(), document.as_bytes()].concat(),
    ))
}

impl Host {
    fn step(&mut self, now: Duration, received: &[u8]) -> Result<Vec<u8>, String> {
        let port = self.port.inner_mut();
        port.now = now;
        port.received.extend(received);
        let trace = |why| format!("carrying bytes: {why}");
        let mut buf = [0; 512];
        loop {
            let count = self.port.read(&mut buf, Duration::ZERO).map_err(trace)?;
            if count == 0 {
                break;
            }
            self.session
                .receive(now, buf.get(..count).unwrap_or_default());
        }
        self.session.poll(now);
        let outgoing = self.session.take_outgoing();
        self.port.write(&outgoing).map_err(trace)?;
        self.log.extend(self.passed.try_iter());
        let beyond = self.log.len().saturating_sub(LONGEST_LOG);
        if beyond > LONGEST_LOG / 10 {
            self.log.drain(..beyond);
            self.forgotten += beyond;
        }
        Ok(std::mem::take(&mut self.port.inner_mut().sent))
    }
}

/// Session and time of a request.
#[derive(Deserialize)]
struct SessionTime {
    number: u32,
    now_s: f64,
}

fn ticket(ticket: Ticket) -> Outcome {
    json(&json!({ "ticket": ticket.number() }))
}

/// Greets the robot.
pub(super) fn connect(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let SessionTime { number, now_s } = parsed(bytes)?;
    let host: &mut Host = lab.kept.get(number)?;
    ticket(host.session.connect(seconds_of(now_s)?))
}

#[derive(Deserialize)]
struct RobotRequest {
    number: u32,
    now_s: f64,
    request: Request,
}

/// Sends a request to the robot, given as JSON of the link protocol (`"Stop"`, `{"ClearEStop": {"count": 1}}`).
pub(super) fn request(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let RobotRequest {
        number,
        now_s,
        request,
    } = parsed(bytes)?;
    let host: &mut Host = lab.kept.get(number)?;
    ticket(host.session.request(seconds_of(now_s)?, request))
}

#[derive(Deserialize)]
struct Upload {
    number: u32,
    now_s: f64,
    gait: GaitSource,
}

/// Uploads a gait as the same table as `swimmer robot upload`.
pub(super) fn upload(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Upload {
        number,
        now_s,
        gait,
    } = parsed(bytes)?;
    if let Some(spring) = gait.file(Files::Unavailable)?.passive {
        return Err(format!(
            "this gait leaves the {} joint to a spring; `swimmer robot upload` sends it and switches the pulses of that joint off",
            spring.joint
        ));
    }
    let table = table(&gait.read(Files::Unavailable)?, MAX_KNOTS)
        .map_err(|why| format!("making a table of the gait for the robot: {why}"))?;
    let host: &mut Host = lab.kept.get(number)?;
    let now = seconds_of(now_s)?;
    ticket(host.session.upload(now, 0, table.bytes(), now + PATIENCE))
}

/// Cancels an upload.
pub(super) fn cancel_upload(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let SessionTime { number, .. } = parsed(bytes)?;
    lab.kept.get::<Host>(number)?.session.cancel_upload();
    json(&json!({}))
}

/// Statistics of the link.
pub(super) fn link(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let host: &mut Host = lab.kept.get(number)?;
    let counters = host.session.counters();
    json(&json!({
        "counters": counters,
        "round_trip_s": counters.round_trip.map(|trip| trip.as_secs_f64()),
        "last_heard_s": host.session.last_heard().as_secs_f64(),
        "answers_signed": host.session.answers_signed(),
        "frames": host.log.len(),
        "forgotten": host.forgotten,
    }))
}

#[derive(Deserialize)]
struct LogRequest {
    number: u32,
    /// Time of the first frame on the page's clock; `None` for the whole log.
    from_s: Option<f64>,
}

/// Logged frames as MCAP, as `swimmer robot log` writes them.
pub(super) fn log(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let LogRequest { number, from_s } = parsed(bytes)?;
    let host: &mut Host = lab.kept.get(number)?;
    let from = host.epoch + seconds_of(from_s.unwrap_or_default())?;
    let from_ns = u64::try_from(from.as_nanos()).unwrap_or(u64::MAX);
    let begin = host
        .log
        .partition_point(|frame| frame.host_time_ns < from_ns);
    link_log_bytes(host.log.get(begin..).unwrap_or_default())
        .map(CallOutput::Bytes)
        .map_err(|why| why.to_string())
}
