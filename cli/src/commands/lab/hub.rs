//! Between the robot's port and the pages: bytes from the robot go to all of them, bytes to it come from the one that drives. The
//! others watch, and may stop the robot.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::commands::robot::{Heard, LentPort};

/// How long a turn waits for bytes of the robot: what a stop of a page waits at most before it leaves.
const TURN: Duration = Duration::from_millis(2);

/// Names a page while it is connected.
pub(super) type PageId = u64;

/// What a page wants.
pub(super) enum FromPage {
    /// It came; what it is told goes here.
    Came(SyncSender<ToPage>),
    /// Whole frames for the robot.
    Frames(Vec<u8>),
    /// Something in words.
    Asks(Ask),
    /// It went.
    Left,
}

/// What a page is told.
#[derive(Clone)]
pub(super) enum ToPage {
    /// What the robot sent.
    Bytes(Arc<[u8]>),
    /// How things stand.
    Says(Says),
}

/// What a page may ask in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Ask {
    /// To drive, where nobody does.
    Drive,
    /// To let others drive.
    Watch,
    /// The robot shall ramp to neutral.
    Stop,
    /// The robot shall drop its pulses.
    Estop,
}

/// How things stand, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "told")]
pub(super) enum Says {
    /// Who drives: this page, another one, or nobody.
    Wheel {
        /// This page drives.
        yours: bool,
        /// Nobody does: ask for it.
        free: bool,
    },
    /// The robot's port.
    Port {
        /// What it is called.
        name: String,
        /// Whether it is there.
        open: bool,
        /// What was said when it went away.
        why: Option<String>,
        /// What the line carries.
        bytes_per_second: f64,
    },
    /// Another page has asked the robot to stop.
    Stopped,
}

/// Who is connected, and who drives.
#[derive(Default)]
struct Pages {
    known: BTreeMap<PageId, SyncSender<ToPage>>,
    driver: Option<PageId>,
}

/// Lives until the interrupt, or until nobody can come any more.
pub(super) fn run(
    port: &mut LentPort,
    inbox: &Receiver<(PageId, FromPage)>,
    go_on: impl Fn() -> bool,
) {
    let mut pages = Pages::default();
    let mut buf = [0; 512];
    while go_on() {
        match port.read(&mut buf, TURN) {
            Heard::Bytes(0) => {}
            Heard::Bytes(count) => {
                let bytes = buf.get(..count).unwrap_or_default();
                pages.tell_all(&ToPage::Bytes(bytes.into()));
            }
            Heard::Gone(why) => pages.tell_all(&of_port(port, Some(why))),
            Heard::Back => pages.tell_all(&of_port(port, None)),
        }
        loop {
            match inbox.try_recv() {
                Ok((id, wanted)) => pages.take(id, wanted, port),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return,
            }
        }
    }
    // Nobody will hear of what the robot does next.
    if pages.driver.is_some() {
        port.stop(false);
        let mut buf = [0; 512];
        port.read(&mut buf, TURN);
    }
}

fn of_port(port: &LentPort, why: Option<String>) -> ToPage {
    ToPage::Says(Says::Port {
        name: port.name().to_owned(),
        open: port.is_open(),
        why,
        bytes_per_second: port.bytes_per_second(),
    })
}

impl Pages {
    fn take(&mut self, id: PageId, wanted: FromPage, port: &mut LentPort) {
        match wanted {
            FromPage::Came(page) => {
                self.known.insert(id, page);
                self.tell(id, &of_port(port, None));
                self.driver.get_or_insert(id);
                self.tell_of_wheel();
            }
            FromPage::Left => {
                self.known.remove(&id);
                self.leave_wheel(id);
            }
            FromPage::Frames(frames) if self.driver == Some(id) => {
                if let Some(Heard::Gone(why)) = port.write(&frames) {
                    self.tell_all(&of_port(port, Some(why)));
                }
            }
            // It drove a moment ago, and does not know yet.
            FromPage::Frames(_) => {}
            FromPage::Asks(Ask::Drive) => {
                if self.known.contains_key(&id) {
                    self.driver.get_or_insert(id);
                    self.tell_of_wheel();
                }
            }
            FromPage::Asks(Ask::Watch) => self.leave_wheel(id),
            FromPage::Asks(ask @ (Ask::Stop | Ask::Estop)) => {
                port.stop(ask == Ask::Estop);
                self.tell_all(&ToPage::Says(Says::Stopped));
            }
        }
    }

    fn leave_wheel(&mut self, id: PageId) {
        if self.driver == Some(id) {
            self.driver = None;
            self.tell_of_wheel();
        }
    }

    fn tell_of_wheel(&mut self) {
        let free = self.driver.is_none();
        for id in self.known.keys().copied().collect::<Vec<_>>() {
            let yours = self.driver == Some(id);
            self.tell(id, &ToPage::Says(Says::Wheel { yours, free }));
        }
    }

    fn tell_all(&mut self, told: &ToPage) {
        for id in self.known.keys().copied().collect::<Vec<_>>() {
            self.tell(id, told);
        }
    }

    /// A page that does not keep up is let go: its link would be older with each byte.
    fn tell(&mut self, id: PageId, told: &ToPage) {
        let Some(page) = self.known.get(&id) else {
            return;
        };
        match page.try_send(told.clone()) {
            Ok(()) => {}
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.known.remove(&id);
                self.leave_wheel(id);
            }
        }
    }
}
