//! The real brain behind a virtual wire, without servos or tank, to observe the link alone.
#![allow(dead_code)] // each test uses a part of it

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::storage::MemoryStorage;
use gait_player::{
    Boot, Brain, BrainConfig, GaitTable, Identity, Inputs, Limits, Output, TICK_US, Transport,
};
use host_link::port::{Device, VirtualPort, WireSpeed};
use host_link::testing::{FaultPlan, Faults, FaultyPort};
use host_link::{LinkError, Robot as HostRobot};
use link_protocol::{
    Board, Configuration, FirmwareVersion, MAX_ENCODED, Message, Reply, Request, ServoSettings,
    StateName, TableInfo, TangentialDrag,
};

/// Hash of the settings of a new robot.
pub(crate) fn settings_as_built() -> u32 {
    Robot::new(1).brain.held().settings_crc32
}

/// Brain with its clock.
pub(crate) struct Robot {
    brain: Brain,
    flash: MemoryStorage,
    now_us: u64,
    next_tick_us: u64,
    pub(crate) output: Option<Output>,
    /// Time at which pulses were last on.
    pub(crate) powered: Duration,
    /// Time at which the robot last began to stop.
    pub(crate) ramp: Duration,
    /// Time of the last fresh keep-alive, and the robot time that it echoed.
    pub(crate) fresh: Duration,
    heard: Duration,
    /// Time at which the first chunk of an upload first arrived, and the last one last.
    pub(crate) pieces: (Duration, Duration),
    /// Number of times that each request acted, by session and number, except for stops, which always act.
    pub(crate) acts: BTreeMap<(u16, u16), u32>,
    /// Checksums of the tables that commits activated or scheduled, in order.
    pub(crate) committed: Vec<u32>,
    /// Distances of the set-points from neutral during a play, in 0.01 rad; a circle has one.
    pub(crate) radii: BTreeSet<i64>,
    decoder: link_protocol::Decoder,
    said: link_protocol::Decoder,
}

impl Robot {
    pub(crate) fn new(nonce: u32) -> Self {
        let servo = ServoSettings {
            centre_ns: 1_500_000,
            slope_rad_per_us: 0.0274,
            reversed: false,
            trim: 0,
        };
        let mut flash = MemoryStorage::erased();
        let mut brain = Brain::new(BrainConfig {
            identity: Identity {
                firmware: FirmwareVersion {
                    major: 0,
                    minor: 1,
                    patch: 0,
                    commit: [0; 8],
                },
                board: Board::Twin,
            },
            limits: Limits::ROBOT,
            configuration: configuration(2.8),
            servos: [servo; 2],
            passive: None,
            buffer: 2048,
            boot: Boot::power_on(nonce, 100),
        });
        let Ok(()) = brain.load(&mut flash);
        Self {
            brain,
            flash,
            now_us: 0,
            next_tick_us: 0,
            output: None,
            powered: Duration::ZERO,
            ramp: Duration::ZERO,
            fresh: Duration::ZERO,
            heard: Duration::ZERO,
            pieces: (Duration::ZERO, Duration::ZERO),
            acts: BTreeMap::new(),
            committed: Vec::new(),
            radii: BTreeSet::new(),
            decoder: link_protocol::Decoder::new(),
            said: link_protocol::Decoder::new(),
        }
    }

    /// Inspects a complete frame before the brain replies.
    fn witness(&mut self, received: &link_protocol::Received, acted: bool) {
        if let Ok(Message::Heartbeat(heartbeat)) = &received.message {
            let (now, heard) = (
                Duration::from_micros(self.now_us),
                Duration::from_micros(heartbeat.heard_us),
            );
            if heard > self.heard && heard <= now && now <= heard + Duration::from_secs(1) {
                (self.fresh, self.heard) = (now, heard);
            }
        }
        let Ok(Message::Request(request)) = &received.message else {
            return;
        };
        if acted && !matches!(request, Request::Stop | Request::EStop) {
            let header = received.header;
            *self
                .acts
                .entry((header.session, header.sequence))
                .or_default() += 1;
        }
        if let Request::Chunk(chunk) = request {
            let now = Duration::from_micros(self.now_us);
            self.pieces.1 = now;
            if chunk.offset == 0 && self.pieces.0.is_zero() {
                self.pieces.0 = now;
            }
        }
    }
}

/// The paper's robot, slender, within `max_angle`.
pub(crate) fn configuration(max_angle: f32) -> Configuration {
    Configuration {
        middle_m: 0.071,
        front_m: 0.137,
        back_m: 0.137,
        chi: 2.0,
        tangential_drag: TangentialDrag::LogAspect(4.543),
        sphere_radius_m: 0.0,
        max_angle,
        max_rate: 3.5,
    }
}

/// Circle in the largest table: 2 kB.
pub(crate) fn circle(amplitude: f64) -> GaitTable {
    GaitTable::from_fn(512, |u| {
        let (sin, cos) = (std::f64::consts::TAU * (u + 0.125)).sin_cos();
        [amplitude * cos, amplitude * sin]
    })
    .unwrap()
}

pub(crate) type FaultyLine = FaultyPort<VirtualPort<Robot>>;

/// Connects over any line: after five lost greetings an operator would try again.
pub(crate) fn connect(faults: &str, seed: u64) -> HostRobot<FaultyLine> {
    for attempt in 0..6 {
        let line = faulty(faults.parse().unwrap(), seed + 1000 * attempt);
        match HostRobot::connect(line, seed) {
            Ok(robot) => return robot,
            Err(LinkError::NoAnswer { .. }) => {}
            Err(error) => panic!("seed {seed}: {error}"),
        }
    }
    panic!("seed {seed}: six greetings of five tries each in vain");
}

pub(crate) fn upload(
    robot: &mut HostRobot<FaultyLine>,
    table: &[u8],
) -> Result<TableInfo, LinkError> {
    robot.upload(table, Duration::from_mins(1), |_| ControlFlow::Continue(()))
}

/// Host end of a faulty line to a new robot.
pub(crate) fn faulty(faults: Faults, seed: u64) -> FaultyPort<VirtualPort<Robot>> {
    let line = VirtualPort::new(Robot::new(5), WireSpeed::robot());
    FaultyPort::new(line, FaultPlan::at_host(faults), seed)
}

impl Device for Robot {
    fn advance(&mut self, to: Duration) {
        let to_us = u64::try_from(to.as_micros()).unwrap();
        while self.next_tick_us <= to_us {
            self.now_us = self.next_tick_us;
            let inputs = Inputs {
                link_up: true,
                // The bench window is open for the first two minutes.
                present: true,
                ..Inputs::default()
            };
            let output = self.brain.tick(self.now_us, &inputs);
            let before = self.output.map(|output| output.state);
            if output.state == StateName::Stopping && before != Some(StateName::Stopping) {
                self.ramp = Duration::from_micros(self.now_us);
            }
            if output.state == StateName::Playing {
                let [front, back] = output.setpoint.map(f64::from);
                #[allow(clippy::cast_possible_truncation)] // a few radians
                self.radii
                    .insert((front.hypot(back) * 100.0).round() as i64);
            }
            if output.pulses_ns.is_some() {
                self.powered = Duration::from_micros(self.now_us);
            }
            if output.storage_wanted {
                let Ok(()) = self.brain.serve_storage(self.now_us, &mut self.flash);
            }
            self.output = Some(output);
            self.next_tick_us += u64::from(TICK_US);
        }
        self.now_us = self.now_us.max(to_us);
    }

    fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let before = self.brain.counters().acted;
            self.brain.receive(self.now_us, Transport::Uart, &[byte]);
            if let Some(received) = self.decoder.push(byte) {
                let acted = self.brain.counters().acted != before;
                self.witness(&received, acted);
            }
        }
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        let mut bytes = [0; MAX_ENCODED];
        let room = room.min(bytes.len());
        let count = self.brain.transmit(Transport::Uart, &mut bytes[..room]);
        out.extend_from_slice(&bytes[..count]);
        for &byte in &bytes[..count] {
            if let Some(received) = self.said.push(byte)
                && let Ok(Message::Reply(Reply::Table(Some(table)))) = received.message
                && self.committed.last() != Some(&table.crc32)
            {
                self.committed.push(table.crc32);
            }
        }
    }
}
