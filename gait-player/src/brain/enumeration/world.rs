//! A brain with all that surrounds it, and what it shows of each event.

use super::event::Event;
use crate::TICK_US;
use crate::brain::settings::Settings;
use crate::brain::{Boot, Brain, BrainConfig, Inputs};
use crate::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use link_protocol::*;
use std::convert::Infallible;
use std::vec::Vec;

/// A brain with all that surrounds it.
#[derive(Clone)]
pub(super) struct World {
    pub(super) brain: Brain,
    pub(super) flash: Flash,
    pub(super) now_us: u64,
    pub(super) battery_mv: Option<u16>,
    sequence: u16,
    pub(super) upload: u16,
    pub(super) begun: u32,
    nonce: u32,
    /// The last request's frame, and whether it could move the robot.
    last: Vec<u8>,
    pub(super) last_moves: bool,
    /// A request has been made in the open session.
    pub(super) asked: bool,
    /// Set where the open session began with a key.
    pub(super) seal: Option<Seal>,
    counter: u64,
}

#[derive(Clone)]
pub(super) struct Flash {
    slots: Vec<u8>,
    settings: Option<Vec<u8>>,
}

const SLOT: usize = PAGE * SLOT_PAGES;

impl Flash {
    /// The key that a brain finds there.
    pub(super) fn key(&self) -> Option<Key> {
        self.settings.as_deref().and_then(Settings::stored_key)
    }
}

impl Storage for Flash {
    type Error = Infallible;

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.copy_from_slice(&self.slots[slot * SLOT + offset..][..bytes.len()]);
        Ok(())
    }

    fn erase(&mut self, slot: usize) -> Result<(), Infallible> {
        self.slots[slot * SLOT..][..SLOT].fill(0xFF);
        Ok(())
    }

    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Infallible> {
        self.slots[slot * SLOT + page * PAGE..][..PAGE].copy_from_slice(bytes);
        Ok(())
    }

    fn load_settings(
        &mut self,
        bytes: &mut [u8; MAX_SETTINGS],
    ) -> Result<Option<usize>, Infallible> {
        Ok(self.settings.as_ref().map(|settings| {
            bytes[..settings.len()].copy_from_slice(settings);
            settings.len()
        }))
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        self.settings = Some(bytes.to_vec());
        Ok(())
    }
}

/// What a step showed.
#[derive(Default)]
pub(super) struct Seen {
    /// The state after each tick, in order, without repeats.
    pub(super) states: Vec<StateName>,
    /// An arm was granted.
    pub(super) armed: bool,
}

impl World {
    pub(super) fn new() -> Self {
        let mut world = Self {
            brain: Brain::new(BrainConfig::in_tests()),
            flash: Flash {
                slots: std::vec![0xFF; SLOT * SLOTS],
                settings: None,
            },
            now_us: 0,
            battery_mv: Some(5_000),
            sequence: 0,
            upload: 0,
            begun: 0,
            nonce: 1,
            last: Vec::new(),
            last_moves: false,
            asked: false,
            seal: None,
            counter: 0,
        };
        world.tick(&mut Seen::default());
        world
    }

    /// Whether it differs from all other events: where no signature is asked for, a request without one is nothing but a
    /// request.
    pub(super) fn can_meet(&self, event: Event) -> bool {
        self.seal.is_some() || !matches!(event, Event::Unsigned(_))
    }

    pub(super) fn step(&mut self, event: Event, requests: &[Request]) -> Seen {
        let mut seen = Seen::default();
        match event {
            Event::Ask(index) => {
                self.sequence = self.sequence.wrapping_add(1);
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                // A piece of a table has no place in the order.
                self.asked |= session != 0 && !matches!(requests[index], Request::Chunk(_));
                seen.armed = self.ask(session, sequence, &requests[index]);
            }
            // Only where there is a number to be late for, or none needed.
            Event::Late(index) if !self.asked && !requests[index].is_stop() => {}
            Event::Late(index) => {
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                let old = sequence.wrapping_sub(5);
                self.ask(session, old, &requests[index]);
            }
            Event::Foreign(index) => {
                let session = self.brain.session.number().wrapping_sub(1);
                let sequence = self.sequence.wrapping_add(1);
                self.ask(session, sequence, &requests[index]);
            }
            Event::Unsigned(index) => {
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                let message = Message::Request(requests[index].clone());
                self.receive(&frame(session, sequence.wrapping_add(1), &message));
            }
            Event::Repeat => {
                let frame = self.last.clone();
                // Not a new arm, whatever it is answered.
                self.receive(&frame);
            }
            Event::Greet => {
                self.nonce += 1;
                self.asked = false;
                self.greet();
            }
            Event::GreetAgain => self.greet(),
            Event::KeepAlive => self.keep_alive(),
            Event::Pass { ticks, kept_alive } => {
                for tick in 1..ticks {
                    if kept_alive && tick % 2 == 0 {
                        self.keep_alive();
                    }
                    self.tick(&mut seen);
                }
            }
            Event::Jump(seconds) => self.now_us += seconds * 1_000_000,
            Event::Battery(mv) => self.battery_mv = mv,
            Event::Reset(reset_reason) => {
                let boot = Boot {
                    reset_reason,
                    kept: self.brain.output.kept,
                    session_seed: self.brain.session.number().wrapping_add(7),
                    ..Boot::power_on(1, 0)
                };
                self.brain = Brain::new(BrainConfig {
                    boot,
                    ..BrainConfig::in_tests()
                });
                let Ok(()) = self.brain.load(&mut self.flash);
                self.now_us = 0;
                (self.asked, self.seal) = (false, None);
            }
        }
        self.tick(&mut seen);
        seen
    }

    fn tick(&mut self, seen: &mut Seen) {
        self.now_us += u64::from(TICK_US);
        let inputs = Inputs {
            battery_mv: self.battery_mv,
            link_up: true,
        };
        let output = self.brain.tick(self.now_us, &inputs);
        let powered = !matches!(output.state, StateName::Stopped | StateName::EStopped);
        assert_eq!(output.pulses_ns.is_some(), powered, "{:?}", output.state);
        if output.storage_wanted {
            let Ok(()) = self.brain.serve_storage(self.now_us, &mut self.flash);
        }
        self.is_done_said();
        if seen.states.last() != Some(&output.state) {
            seen.states.push(output.state);
        }
    }

    /// Whether it is an arm and was granted.
    fn ask(&mut self, session: u16, sequence: u16, request: &Request) -> bool {
        let mut request = request.clone();
        match &mut request {
            Request::Chunk(chunk) => chunk.upload = self.upload,
            Request::Commit { upload } => *upload = self.upload,
            Request::Begin(begin) => (self.upload, self.begun) = (sequence, begin.crc32),
            _ => {}
        }
        let arms = matches!(request, Request::Arm(_));
        let moves = arms || matches!(request, Request::Play(_) | Request::Resume);
        let frame = self.signed(session, sequence, &Message::Request(request));
        let done = self.receive(&frame);
        if session == self.brain.session.number() && sequence == self.sequence {
            (self.last, self.last_moves) = (frame, moves);
        }
        done && arms
    }

    fn greet(&mut self) {
        let hello = Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce: self.nonce,
        };
        let before = self.brain.session.number();
        self.receive(&frame(0, 0, &Message::Hello(hello)));
        let session = &self.brain.session;
        if session.number() != before {
            let binding = Binding {
                boot_nonce: session.boot_nonce(),
                session: session.number(),
                host_nonce: self.nonce,
            };
            let key = self.brain.settings.key;
            self.seal = key.map(|key| Seal::new(&key, binding));
        }
    }

    /// A frame as the open session asks for it.
    fn signed(&mut self, session: u16, sequence: u16, message: &Message) -> Vec<u8> {
        let Some(seal) = &self.seal else {
            return frame(session, sequence, message);
        };
        self.counter += 1;
        let (header, mut frame) = (Header::new(session, sequence), [0; MAX_ENCODED]);
        let len = encode_signed(header, message, seal, self.counter, &mut frame).unwrap();
        frame[..len].to_vec()
    }

    fn keep_alive(&mut self) {
        let session = self.brain.session.number();
        let frame = self.signed(session, 0, &Message::KeepAlive);
        self.receive(&frame);
    }

    /// Whether the answer is Done.
    fn receive(&mut self, frame: &[u8]) -> bool {
        self.brain.receive(self.now_us, frame);
        self.is_done_said()
    }

    fn is_done_said(&mut self) -> bool {
        let (mut decoder, mut bytes) = (Decoder::new(), [0; 640]);
        let len = self.brain.transmit(&mut bytes);
        let heard = bytes[..len].iter().filter_map(|&byte| decoder.push(byte));
        heard
            .map(|received| received.message == Ok(Message::Reply(Reply::Done)))
            .fold(false, |any, done| any | done)
    }
}

fn frame(session: u16, sequence: u16, message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_ENCODED];
    let len = encode(Header::new(session, sequence), message, &mut frame).unwrap();
    frame[..len].to_vec()
}
