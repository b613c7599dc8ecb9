//! World of the model check: a brain with host, storage and inputs, and the observations of each step.

use super::event::{Event, FILLED_IN};
use crate::brain::session::FRESH_US;
use crate::brain::{Boot, Brain, BrainConfig, Inputs};
use crate::storage::MemoryStorage;
use crate::{TICK_US, Transport};
use link_protocol::*;
use std::vec::Vec;

/// Brain with its environment.
#[derive(Clone)]
pub(super) struct World {
    pub(super) brain: Brain,
    pub(super) flash: MemoryStorage,
    pub(super) now_us: u64,
    /// Seed of the session numbers of this boot, another for each boot: a robot draws it at random.
    session_seed: u16,
    pub(super) battery_mv: Option<u16>,
    sequence: u16,
    pub(super) upload: u16,
    pub(super) begun: u32,
    nonce: u32,
    /// Frame of the last request, and whether it could move the robot.
    last: Vec<u8>,
    pub(super) last_moves: bool,
    /// The open session has had a request.
    pub(super) asked: bool,
    /// Signer of the open session, if it began with a key.
    pub(super) seal: Option<Seal>,
    counter: u64,
    /// Transport of the last greeting.
    pub(super) via: Transport,
    last_beat: Vec<u8>,
    jumper: bool,
}

/// A request that acted, with its standing in the authority table just before.
#[derive(Debug)]
pub(super) struct Acted {
    pub(super) needs: Option<Needs>,
    pub(super) ours: bool,
    pub(super) attended: bool,
    pub(super) state: StateName,
}

/// Observations of one step.
#[derive(Default)]
#[allow(clippy::struct_excessive_bools)] // facts, not states
pub(super) struct StepObservations {
    /// State after each tick, in order, without repeats.
    pub(super) states: Vec<StateName>,
    /// Accepted request.
    pub(super) acted: Option<Acted>,
    /// An arm was granted.
    pub(super) armed: bool,
    /// The lease was valid before the step.
    pub(super) fresh: bool,
    /// The lease was renewed.
    pub(super) fed: bool,
    /// A first key was set, lengths far from those as built were set, or the boot loader was requested.
    pub(super) opened: bool,
    /// A person was present before the step.
    pub(super) present: bool,
}

impl World {
    pub(super) fn new() -> Self {
        let mut world = Self {
            brain: Brain::new(BrainConfig::in_tests()),
            flash: MemoryStorage::erased(),
            now_us: 0,
            session_seed: 100,
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
            via: Transport::Uart,
            last_beat: Vec::new(),
            jumper: false,
        };
        world.tick(&mut StepObservations::default());
        world
    }

    /// Returns false if the event equals another one: without a required signature, an unsigned request is an ordinary one.
    pub(super) fn can_meet(&self, event: Event) -> bool {
        self.seal.is_some() || !matches!(event, Event::Unsigned(_))
    }

    pub(super) fn step(&mut self, event: Event, requests: &[Request]) -> StepObservations {
        let mut seen = StepObservations {
            fresh: !self.brain.session.silent(self.now_us),
            present: self.via == Transport::Usb || self.brain.bench.open(self.now_us),
            ..StepObservations::default()
        };
        let standing = self.standing(event, requests);
        let acted_before = self.brain.counted.acted;
        let (fed_before, guarded_before) = (self.brain.session.fed_us, self.guarded());
        match event {
            Event::Ask(index) => {
                self.sequence = self.sequence.wrapping_add(1);
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                // A chunk has no sequence number.
                self.asked |= session != 0 && !matches!(requests[index], Request::Chunk(_));
                seen.armed = self.ask(session, sequence, &requests[index]);
            }
            // Only if a later number exists, or the request requires no number.
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
            Event::Elsewhere(index) => {
                let (session, sequence) = (self.brain.session.number(), self.sequence);
                let message = Message::Request(requests[index].clone());
                let frame = self.signed(session, sequence.wrapping_add(1), &message);
                let other = match self.via {
                    Transport::Uart => Transport::Usb,
                    Transport::Usb => Transport::Uart,
                };
                self.brain.receive(self.now_us, other, &frame);
                self.is_done_said();
            }
            Event::Repeat => {
                let frame = self.last.clone();
                // A repeat is no new arm, whatever the reply.
                self.receive(&frame);
            }
            Event::Greet(via) => {
                self.nonce += 1;
                self.asked = false;
                self.via = via;
                self.greet();
            }
            Event::GreetAgain => self.greet(),
            Event::KeepAlive => self.keep_alive(),
            Event::OldKeepAlive => {
                let again = self.last_beat.clone();
                self.receive(&again);
                self.beat(self.now_us.saturating_sub(2 * FRESH_US));
            }
            Event::Jumper => self.jumper = true,
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
                self.session_seed = self.session_seed.wrapping_add(1_000);
                let boot = Boot {
                    reset_reason,
                    kept: self.brain.output.kept,
                    // A power cut clears the RAM but not the flash.
                    starts: (reset_reason != ResetReason::PowerOn)
                        .then_some(self.brain.output.starts),
                    session_seed: self.session_seed,
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
        let has_acted = self.brain.counted.acted > acted_before;
        seen.acted = standing.filter(|_| has_acted);
        self.tick(&mut seen);
        seen.opened = self.guarded() > guarded_before && !matches!(event, Event::Reset(_));
        seen.fed = self.brain.session.fed_us != fed_before && self.brain.session.fed_us.is_some();
        seen
    }

    /// Standing of the event's request in the authority table. Returns `None` if the event is no request.
    fn standing(&self, event: Event, requests: &[Request]) -> Option<Acted> {
        let (index, ours) = match event {
            Event::Ask(index) => (index, true),
            Event::Late(index)
            | Event::Foreign(index)
            | Event::Unsigned(index)
            | Event::Elsewhere(index) => (index, false),
            _ => return None,
        };
        let request = &requests[index];
        let held = self.brain.settings_held();
        Some(Acted {
            needs: Some(request.class(|| held.is_widened_by(request)).needs()),
            ours,
            attended: self.brain.session.attended(self.now_us),
            state: self.brain.state.name(),
        })
    }

    /// Count of past effects that require presence.
    fn guarded(&self) -> u8 {
        let brain = &self.brain;
        let far = brain.settings.configuration.middle_m > 1.5 * brain.built.middle_m;
        let servo = &brain.settings.servos[1];
        u8::from(brain.settings.key.is_some())
            + u8::from(far)
            + u8::from(servo.reversed)
            + u8::from(servo.trim == 400)
            + u8::from(brain.settings.passive.is_none())
            + u8::from(brain.bench.leaves(u64::MAX))
    }

    fn tick(&mut self, seen: &mut StepObservations) {
        self.now_us += u64::from(TICK_US);
        let inputs = Inputs {
            battery_mv: self.battery_mv,
            link_up: true,
            usb_up: true,
            present: core::mem::take(&mut self.jumper),
        };
        let output = self.brain.tick(self.now_us, &inputs);
        let powered = !matches!(output.state, StateName::Stopped | StateName::EStopped);
        assert_eq!(output.pulses_ns.is_some(), powered, "{:?}", output.state);
        if let Some(pulses_ns) = output.pulses_ns {
            let passive = self.brain.settings.passive.map(Joint::index);
            for (joint, pulse_ns) in pulses_ns.into_iter().enumerate() {
                assert_eq!(pulse_ns == 0, passive == Some(joint), "{:?}", output.state);
            }
        }
        if output.storage_wanted {
            let Ok(()) = self.brain.serve_storage(self.now_us, &mut self.flash);
        }
        self.is_done_said();
        if seen.states.last() != Some(&output.state) {
            seen.states.push(output.state);
        }
    }

    /// Sends a request; returns true if it is an arm and was granted.
    fn ask(&mut self, session: u16, sequence: u16, request: &Request) -> bool {
        let mut request = request.clone();
        match &mut request {
            Request::Chunk(chunk) => chunk.upload = self.upload,
            Request::Commit { upload } => *upload = self.upload,
            Request::Follow(follow) => {
                follow.upload = self.upload;
                follow.checked = Checked {
                    table_crc32: self.begun,
                    ..self.brain.held()
                };
            }
            Request::Play(play) if play.checked == FILLED_IN => {
                play.checked = self.brain.held();
            }
            Request::ClearEStop { count } => *count = self.brain.estops.wrapping_sub(*count),
            Request::Begin(begin) => (self.upload, self.begun) = (sequence, begin.crc32),
            _ => {}
        }
        let arms = matches!(request, Request::Arm);
        let moves = arms
            || matches!(
                request,
                Request::Play(_) | Request::Resume | Request::Follow(_)
            );
        let frame = self.signed(session, sequence, &Message::Request(request));
        let open = self.brain.session.number();
        let done = self.receive(&frame);
        if session == open && sequence == self.sequence {
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
            // After a key was set, the same greeting opens another session.
            self.asked = false;
            let binding = Binding {
                boot_nonce: session.boot_nonce(),
                session: session.number(),
                host_nonce: self.nonce,
            };
            let key = self.brain.settings.key;
            self.seal = key.map(|key| Seal::new(&key, binding));
        }
    }

    /// Encodes a frame, signed if the open session requires it.
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
        self.beat(self.now_us);
    }

    fn beat(&mut self, heard_us: u64) {
        let session = self.brain.session.number();
        let beat = Message::Heartbeat(Heartbeat {
            host_us: 0,
            heard_us,
        });
        let frame = self.signed(session, 0, &beat);
        self.receive(&frame);
        self.last_beat = frame;
    }

    /// Passes a frame to the brain; returns true if the reply is Done.
    fn receive(&mut self, frame: &[u8]) -> bool {
        self.brain.receive(self.now_us, self.via, frame);
        self.is_done_said()
    }

    fn is_done_said(&mut self) -> bool {
        Transport::ALL.into_iter().fold(false, |any, transport| {
            let (mut decoder, mut bytes) = (Decoder::new(), [0; 640]);
            let len = self.brain.transmit(transport, &mut bytes);
            let heard = bytes[..len].iter().filter_map(|&byte| decoder.push(byte));
            heard
                .map(|received| received.message == Ok(Message::Reply(Reply::Done)))
                .fold(any, |any, done| any | done)
        })
    }
}

fn frame(session: u16, sequence: u16, message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_ENCODED];
    let len = encode(Header::new(session, sequence), message, &mut frame).unwrap();
    frame[..len].to_vec()
}
