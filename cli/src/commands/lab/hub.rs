//! Hub between the robot's port and the pages: the robot's bytes go to all of them, bytes for it come from the one that has the
//! wheel. The others watch, and may stop the robot.
//!
//! Nothing in it waits: every inbox is bounded, the port takes what it takes, and stops have an inbox of their own that is emptied
//! first.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::time::{Duration, Instant};

use host_link::robot::Halt;
use serde::{Deserialize, Serialize};

use crate::commands::robot::{LinkMonitor, MonitorLine, MonitorReport, PortEvent, SharedPort};

/// Longest wait for bytes of the robot in one turn, and so the longest delay of a stop from a page.
const TURN: Duration = Duration::from_millis(2);
/// Most messages of one kind that are taken in a turn.
const MOST_A_TURN: usize = 64;
/// Places in an inbox.
const INBOX: usize = 256;
/// Longest wait for the robot to acknowledge the stop with which the hub ends.
const TO_STOP: Duration = Duration::from_millis(500);

/// Names a page while it is connected; never 0.
pub(super) type PageId = u64;

/// Message of a page that is no frame and no stop.
pub(super) enum FromPage {
    /// It came; messages to it go here.
    Came(SyncSender<ToPage>),
    /// It requests or leaves the wheel.
    Wheel { wanted: bool },
    /// It gives no sign of life.
    Frozen,
    /// It went.
    Left,
}

/// Stop that a page sends.
pub(super) enum FromPageStop {
    /// In words.
    Halt(Halt),
    /// Frames of its own session with a stop among them.
    Frames(Vec<u8>),
}

/// Message to a page.
#[derive(Clone)]
pub(super) enum ToPage {
    /// Bytes of the robot.
    Bytes(Arc<[u8]>),
    /// State of wheel and port.
    ServerMessage(ServerMessage),
}

/// Request of a page in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum PageMessage {
    /// Request for the wheel, granted if no page drives.
    Drive,
    /// To let others drive.
    Watch,
    /// The robot shall ramp to neutral.
    Stop,
    /// The robot shall drop its pulses.
    Estop,
    /// Sign of life of the page's script. A page that has sent one must go on: the browser answers pings for a page that hangs.
    Here,
}

/// State of wheel and port, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "told")]
pub(super) enum ServerMessage {
    /// Driver: this page, another one, or nobody.
    Wheel {
        /// This page drives.
        yours: bool,
        /// Nobody drives: a page may request the wheel.
        free: bool,
    },
    /// The robot's port.
    Port {
        /// Its name.
        name: String,
        /// It is open.
        open: bool,
        /// The system's words when it went away.
        why: Option<String>,
        /// Bytes per second that the line carries.
        bytes_per_second: f64,
    },
    /// Another page has requested a stop.
    Stopped,
    /// Pose of the middle link by the cameras.
    Tracked {
        /// x and y in the tank \[m\], heading \[rad\]; `null` while the robot is not seen.
        pose: Option<[f64; 3]>,
    },
    /// Comparison of the play with its prediction.
    Monitor {
        /// All lines about the present play, or the last one.
        lines: Vec<MonitorLine>,
    },
}

/// Sending ends of the hub's inboxes.
#[derive(Clone)]
pub(super) struct ToHub {
    stops: SyncSender<(PageId, FromPageStop)>,
    words: SyncSender<(PageId, FromPage)>,
    frames: SyncSender<(PageId, Vec<u8>)>,
    driver: Arc<AtomicU64>,
}

/// Receiving ends.
pub(super) struct Inbox {
    stops: Receiver<(PageId, FromPageStop)>,
    words: Receiver<(PageId, FromPage)>,
    frames: Receiver<(PageId, Vec<u8>)>,
    driver: Arc<AtomicU64>,
}

/// Makes the inboxes.
pub(super) fn inbox() -> (ToHub, Inbox) {
    let (to_stops, stops) = sync_channel(INBOX);
    let (to_words, words) = sync_channel(INBOX);
    let (to_frames, frames) = sync_channel(INBOX);
    let driver = Arc::new(AtomicU64::new(0));
    let to_hub = ToHub {
        stops: to_stops,
        words: to_words,
        frames: to_frames,
        driver: Arc::clone(&driver),
    };
    let inbox = Inbox {
        stops,
        words,
        frames,
        driver,
    };
    (to_hub, inbox)
}

/// The hub has ended.
pub(super) struct Ended;

impl ToHub {
    /// Sends a stop. With a full inbox one that says the same is already there.
    pub(super) fn stop(&self, id: PageId, stop: FromPageStop) -> Result<(), Ended> {
        match self.stops.try_send((id, stop)) {
            Ok(()) | Err(TrySendError::Full(_)) => Ok(()),
            Err(TrySendError::Disconnected(_)) => Err(Ended),
        }
    }

    /// Sends frames if the page drives. Frames that do not fit into the inbox are lost, as on any link.
    pub(super) fn frames(&self, id: PageId, frames: Vec<u8>) -> Result<(), Ended> {
        if self.driver.load(Ordering::Relaxed) != id {
            return Ok(());
        }
        match self.frames.try_send((id, frames)) {
            Ok(()) | Err(TrySendError::Full(_)) => Ok(()),
            Err(TrySendError::Disconnected(_)) => Err(Ended),
        }
    }

    /// Sends another message; waits for a place in the inbox.
    pub(super) fn word(&self, id: PageId, word: FromPage) -> Result<(), Ended> {
        self.words.send((id, word)).map_err(|_| Ended)
    }
}

/// Connected pages, and the one that drives.
struct Pages {
    known: BTreeMap<PageId, SyncSender<ToPage>>,
    driver: Option<PageId>,
    /// The driver, for threads that send frames; 0 without a driver.
    shared: Arc<AtomicU64>,
    /// The cameras' last pose and lines, for a page that comes later.
    tracked: Option<[ServerMessage; 2]>,
}

/// Runs until `go_on` returns false, or until no page can connect any more. Then the robot is stopped if a page drove it.
/// `monitor` follows the traffic.
pub(super) fn run(
    port: &mut SharedPort,
    inbox: &Inbox,
    monitor: Option<&LinkMonitor>,
    go_on: impl Fn() -> bool,
) {
    let tracked = monitor.map(|_| {
        let lines = Vec::new();
        [
            ServerMessage::Tracked { pose: None },
            ServerMessage::Monitor { lines },
        ]
    });
    let mut pages = Pages {
        known: BTreeMap::new(),
        driver: None,
        shared: Arc::clone(&inbox.driver),
        tracked,
    };
    let mut buf = [0; 512];
    while go_on() {
        for (_, stop) in inbox.stops.try_iter().take(MOST_A_TURN) {
            pages.stop(stop, port);
        }
        let event = port.read(&mut buf, TURN);
        if let (Some(monitor), Some(now)) = (monitor, port.now()) {
            monitor.at(now);
        }
        match event {
            PortEvent::Bytes(0) => {}
            PortEvent::Bytes(count) => {
                let bytes = buf.get(..count).unwrap_or_default();
                pages.tell_all(&ToPage::Bytes(bytes.into()));
                if let Some(monitor) = monitor {
                    monitor.take_reply(bytes);
                }
            }
            PortEvent::Gone(why) => {
                pages.tell_all(&of_port(port, Some(why)));
                if let Some(monitor) = monitor {
                    monitor.port_gone();
                }
            }
            PortEvent::Back => pages.tell_all(&of_port(port, None)),
        }
        for _ in 0..MOST_A_TURN {
            match inbox.words.try_recv() {
                Ok((id, word)) => pages.take(id, word, port),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return,
            }
        }
        for (id, frames) in inbox.frames.try_iter().take(MOST_A_TURN) {
            // Another page may have got the wheel since.
            if pages.driver != Some(id) {
                continue;
            }
            if let Some(monitor) = monitor {
                monitor.take_request(&frames);
            }
            if let Some(PortEvent::Gone(why)) = port.write(&frames) {
                pages.tell_all(&of_port(port, Some(why)));
            }
        }
        for report in monitor.into_iter().flat_map(LinkMonitor::reports) {
            pages.monitored(report, port);
        }
    }
    if pages.driver.is_some() {
        port.stop(Halt::Stop);
        let begun = Instant::now();
        while !port.is_stopped() && begun.elapsed() < TO_STOP {
            port.read(&mut buf, TURN);
        }
    }
}

fn of_port(port: &SharedPort, why: Option<String>) -> ToPage {
    ToPage::ServerMessage(ServerMessage::Port {
        name: port.name().to_owned(),
        open: port.is_open(),
        why,
        bytes_per_second: port.bytes_per_second(),
    })
}

impl Pages {
    fn take(&mut self, id: PageId, word: FromPage, port: &SharedPort) {
        match word {
            FromPage::Came(page) => {
                self.known.insert(id, page);
                self.tell(id, &of_port(port, None));
                for message in self.tracked.clone().into_iter().flatten() {
                    self.tell(id, &ToPage::ServerMessage(message));
                }
                self.drive(id);
            }
            FromPage::Left => {
                self.known.remove(&id);
                self.leave_wheel(id);
            }
            FromPage::Wheel { wanted: true } => {
                if self.known.contains_key(&id) {
                    self.drive(id);
                }
            }
            FromPage::Wheel { wanted: false } | FromPage::Frozen => self.leave_wheel(id),
        }
    }

    fn stop(&mut self, stop: FromPageStop, port: &mut SharedPort) {
        match stop {
            FromPageStop::Halt(halt) => {
                port.stop(halt);
                self.tell_all(&ToPage::ServerMessage(ServerMessage::Stopped));
            }
            FromPageStop::Frames(frames) => {
                if let Some(PortEvent::Gone(why)) = port.write(&frames) {
                    self.tell_all(&of_port(port, Some(why)));
                }
            }
        }
    }

    /// Passes a report of the monitor on.
    fn monitored(&mut self, report: MonitorReport, port: &mut SharedPort) {
        let (place, message) = match report {
            MonitorReport::Pose(pose) => (0, ServerMessage::Tracked { pose }),
            MonitorReport::Lines(lines) => (1, ServerMessage::Monitor { lines }),
            MonitorReport::Stop => {
                port.stop(Halt::Stop);
                return;
            }
        };
        self.tell_all(&ToPage::ServerMessage(message.clone()));
        if let Some(kept) = self.tracked.as_mut().and_then(|kept| kept.get_mut(place)) {
            *kept = message;
        }
    }

    /// Gives the wheel to a page, if no page has it.
    fn drive(&mut self, id: PageId) {
        let driver = *self.driver.get_or_insert(id);
        self.shared.store(driver, Ordering::Relaxed);
        self.tell_of_wheel();
    }

    fn leave_wheel(&mut self, id: PageId) {
        if self.driver == Some(id) {
            self.driver = None;
            self.shared.store(0, Ordering::Relaxed);
            self.tell_of_wheel();
        }
    }

    fn tell_of_wheel(&mut self) {
        let free = self.driver.is_none();
        for id in self.known.keys().copied().collect::<Vec<_>>() {
            let yours = self.driver == Some(id);
            self.tell(
                id,
                &ToPage::ServerMessage(ServerMessage::Wheel { yours, free }),
            );
        }
    }

    fn tell_all(&mut self, message: &ToPage) {
        for id in self.known.keys().copied().collect::<Vec<_>>() {
            self.tell(id, message);
        }
    }

    /// A page that does not keep up is let go: its link would be older with each byte.
    fn tell(&mut self, id: PageId, message: &ToPage) {
        let Some(page) = self.known.get(&id) else {
            return;
        };
        match page.try_send(message.clone()) {
            Ok(()) => {}
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.known.remove(&id);
                self.leave_wheel(id);
            }
        }
    }
}
