//! The host's session with the real brain over a faulty link: every ticket ends once, and the robot holds every upload that is
//! reported as complete.
#![no_main]

use std::collections::BTreeMap;
use std::time::Duration;

use arbitrary::Arbitrary;
use host_link::session::{Event, Session, SessionConfig, Ticket};
use libfuzzer_sys::fuzz_target;
use swimmer_fuzz::ask::{Ask, table};
use swimmer_fuzz::robot::FuzzedRobot;
use swimmer_fuzz::wire::Weather;

#[derive(Arbitrary, Debug)]
enum Step {
    Connect,
    Ask(Ask),
    Upload {
        which: u8,
        seconds: u8,
    },
    Cancel,
    Ticks {
        count: u8,
        there: Weather,
        back: Weather,
    },
    /// Seconds without clouds, so that an upload gets through.
    Summer,
    ToHost(Vec<u8>),
    ToRobot(Vec<u8>),
    Reset,
}

const TICK: Duration = Duration::from_millis(20);

struct Scene {
    session: Session,
    robot: FuzzedRobot,
    now: Duration,
    there: Vec<u8>,
    back: Vec<u8>,
    /// Open tickets with the checksum of an upload, until their events come.
    open: BTreeMap<Ticket, Option<u32>>,
}

fuzz_target!(|story: (u64, Vec<Step>)| {
    let (seed, steps) = story;
    let mut scene = Scene {
        session: Session::new(SessionConfig::new(seed)),
        robot: FuzzedRobot::default(),
        now: Duration::ZERO,
        there: Vec::new(),
        back: Vec::new(),
        open: BTreeMap::new(),
    };
    scene.open(|session, now| session.connect(now), None);
    for step in steps.iter().take(200) {
        scene.tell(step);
    }
    // Silence ends everything: no one waits for ever. The longest deadline of an upload is 255 s.
    for _ in 0..(260 * 50) {
        if scene.open.is_empty() {
            break;
        }
        scene.tick(Weather::Lost, Weather::Lost);
    }
    assert!(
        scene.open.is_empty(),
        "still waiting after 260 s of silence: {:?}",
        scene.open
    );
});

impl Scene {
    fn open(&mut self, ask: impl FnOnce(&mut Session, Duration) -> Ticket, crc32: Option<u32>) {
        let ticket = ask(&mut self.session, self.now);
        assert!(self.open.insert(ticket, crc32).is_none(), "a ticket twice");
        self.settle();
    }

    fn tell(&mut self, step: &Step) {
        match step {
            Step::Connect => self.open(|session, now| session.connect(now), None),
            Step::Ask(ask) => {
                let request = ask.request(0, self.robot.held());
                // The witness of the brain's target needs to know; here the link decides what arrives.
                self.robot.armed = true;
                self.robot.remapped = true;
                self.open(|session, now| session.request(now, request), None);
            }
            Step::Upload { which, seconds } => {
                let table = table(*which);
                let patience = Duration::from_secs(u64::from(*seconds));
                self.open(
                    |session, now| session.upload(now, 0, table.bytes(), now + patience),
                    Some(table.crc32()),
                );
            }
            Step::Cancel => {
                self.session.cancel_upload();
                self.settle();
                // A cancelled upload ends without an event.
                self.open.retain(|_, upload| upload.is_none());
            }
            Step::Ticks { count, there, back } => {
                (0..*count).for_each(|_| self.tick(*there, *back))
            }
            Step::Summer => (0..100).for_each(|_| self.tick(Weather::Fair, Weather::Fair)),
            Step::ToHost(bytes) => self.back.extend_from_slice(bytes),
            Step::ToRobot(bytes) => self.there.extend_from_slice(bytes),
            Step::Reset => self.robot.reset(link_protocol::ResetReason::PowerOn),
        }
    }

    fn tick(&mut self, there: Weather, back: Weather) {
        self.now += TICK;
        self.there.extend(self.session.take_outgoing());
        let arrived = there.pass(&mut self.there);
        self.robot.receive(&arrived);
        self.robot.armed = true;
        self.robot.tick(0);
        self.robot.transmit(&mut self.back);
        let arrived = back.pass(&mut self.back);
        self.session.receive(self.now, &arrived);
        self.session.poll(self.now);
        assert!(
            self.session
                .next_deadline()
                .is_none_or(|deadline| deadline > self.now),
            "a deadline that has passed already"
        );
        self.settle();
    }

    fn settle(&mut self) {
        while let Some(event) = self.session.next_event() {
            match event {
                Event::Connected { ticket, .. }
                | Event::Answered { ticket, .. }
                | Event::StoppedByItself { ticket, .. }
                | Event::Failed { ticket, .. } => {
                    assert!(
                        self.open.remove(&ticket).is_some(),
                        "an event for {ticket:?}, which is not open"
                    );
                }
                Event::Uploaded { ticket, table } => {
                    let crc32 = self.open.remove(&ticket);
                    assert_eq!(
                        crc32,
                        Some(Some(table.crc32)),
                        "another table than was sent"
                    );
                }
                Event::Progress { ticket, .. } => assert!(self.open.contains_key(&ticket)),
                Event::Telemetry { .. } => {}
            }
        }
    }
}
