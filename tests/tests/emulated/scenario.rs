//! The same day in the laboratory (`tests/scenarios/*.toml`) on three robots: the brain alone on a line without delay, the
//! twin, and the booted firmware. From the first motion on they must command the same, tick for tick.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use gait_player::{Boot, Brain, BrainConfig, Identity, Inputs, TICK_US, Transport};
use host_link::port::{Device, VirtualPort, WireSpeed};
use host_link::{Port, Robot};
use link_protocol::{Board, FirmwareVersion, Joint, StateName};
use serde::Deserialize;
use swimmer_files::SwimmerFile;
use twin::{Twin, TwinConfig};

use crate::promise::seen;
use crate::rig::{self, Image};

/// Both pulses in steps of the PWM's counter; none: off.
type Pulses = Option<[u32; 2]>;

/// Sequence of steps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Scenario {
    step: Vec<Step>,
}

/// One request, `at_s` after the first cycle began, on the robot's clock; without it, at once.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
enum Step {
    /// A circle of this radius, 512 knots, becomes the gait.
    Upload {
        at_s: Option<f64>,
        radius_deg: f64,
    },
    Arm {
        at_s: Option<f64>,
    },
    Play {
        at_s: Option<f64>,
        cycles: u32,
        period_s: f64,
    },
    Pause {
        at_s: Option<f64>,
    },
    Resume {
        at_s: Option<f64>,
    },
    Stop {
        at_s: Option<f64>,
    },
    /// Waits until the last cycle is played and the pulses are off.
    Finish,
}

impl Step {
    fn at_s(self) -> Option<f64> {
        match self {
            Self::Upload { at_s, .. }
            | Self::Play { at_s, .. }
            | Self::Arm { at_s }
            | Self::Pause { at_s }
            | Self::Resume { at_s }
            | Self::Stop { at_s } => at_s,
            Self::Finish => None,
        }
    }
}

impl Scenario {
    fn read(path: &Path) -> Self {
        let scenario: Self = toml::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        for at_s in scenario.step.iter().filter_map(|step| step.at_s()) {
            // A request that comes in the middle of a tick comes there on every line, quick or slow.
            let ticks = at_s * 1e6 / f64::from(TICK_US);
            let middle = (ticks - ticks.floor() - 0.5).abs() < 1e-6;
            assert!(
                middle,
                "{}: {at_s} s is not the middle of a tick",
                path.display()
            );
        }
        scenario
    }

    fn play<P: Port>(&self, robot: &mut Robot<P>) {
        set_up(robot);
        let mut began_s = None;
        // Read once after each upload: a query before a timed play would delay it by the line's round trip.
        let mut held = robot.held().unwrap();
        for step in &self.step {
            if let Some(at_s) = step.at_s() {
                wait_until(robot, began_s.expect("at_s before a play") + at_s);
            }
            match *step {
                Step::Upload { radius_deg, .. } => {
                    let table = rig::circle(radius_deg);
                    robot
                        .upload(table.bytes(), Duration::from_mins(1), |_| {
                            ControlFlow::Continue(())
                        })
                        .unwrap();
                    held = robot.held().unwrap();
                }
                Step::Arm { .. } => robot.arm(false).unwrap(),
                Step::Play {
                    cycles, period_s, ..
                } => {
                    let period = Duration::from_secs_f64(period_s);
                    robot.play_checked(cycles, period, false, held).unwrap();
                    began_s = began_s.or(Some(first_cycle(robot, period_s)));
                }
                Step::Pause { .. } => robot.pause(false).unwrap(),
                Step::Resume { .. } => robot.resume().unwrap(),
                Step::Stop { .. } => {
                    robot.stop().unwrap();
                }
                Step::Finish => live_until(robot, StateName::Stopped),
            }
        }
    }
}

/// Servos and body of the paper's robot.
fn set_up<P: Port>(robot: &mut Robot<P>) {
    let config = TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1);
    for (joint, servo) in [Joint::Front, Joint::Back].into_iter().zip(config.servos) {
        robot.set_servo(joint, servo).unwrap();
    }
    robot.configure(config.belief).unwrap();
    // A few pings, so that the robot's clock is known.
    robot
        .listen(Duration::from_secs(3), |_| ControlFlow::Continue(()))
        .unwrap();
}

fn live_until<P: Port>(robot: &mut Robot<P>, state: StateName) {
    robot
        .listen(Duration::from_mins(2), |telemetry| match telemetry {
            Some(telemetry) if telemetry.state == state => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
        .unwrap();
    assert_eq!(robot.telemetry().unwrap().state, state);
}

/// Start of the first cycle \[s on the robot's clock\].
fn first_cycle<P: Port>(robot: &mut Robot<P>, period_s: f64) -> f64 {
    live_until(robot, StateName::Playing);
    let telemetry = robot.telemetry().unwrap();
    assert_eq!(telemetry.cycle, 0);
    telemetry.robot_us as f64 * 1e-6 - f64::from(telemetry.phase) / 65_536.0 * period_s
}

/// Lives until what is sent then reaches the robot at this time of its clock.
fn wait_until<P: Port>(robot: &mut Robot<P>, robot_s: f64) {
    let clock = robot.clock().unwrap();
    let there = Duration::from_secs_f64(clock.host_time(robot_s) - clock.uncertainty);
    let wait = there.checked_sub(robot.port().now());
    let wait = wait.unwrap_or_else(|| panic!("{robot_s} s is over: {there:?}"));
    robot.listen(wait, |_| ControlFlow::Continue(())).unwrap();
}

/// A brain and nothing else.
struct Alone {
    brain: Brain,
    now_us: u64,
    pulses: Vec<Pulses>,
}

impl Alone {
    fn new() -> Self {
        let identity = Identity {
            firmware: FirmwareVersion {
                major: 0,
                minor: 1,
                patch: 0,
                commit: [0; 8],
            },
            board: Board::Twin,
        };
        let config = BrainConfig::robot(identity, Boot::power_on(1, 1));
        Self {
            brain: Brain::new(config),
            now_us: 0,
            pulses: Vec::new(),
        }
    }
}

impl Device for Alone {
    fn advance(&mut self, to: Duration) {
        let to_us = u64::try_from(to.as_micros()).unwrap();
        let inputs = Inputs {
            link_up: true,
            ..Inputs::default()
        };
        let tick_us = u64::from(TICK_US);
        while (self.now_us / tick_us + 1) * tick_us <= to_us {
            self.now_us = (self.now_us / tick_us + 1) * tick_us;
            let output = self.brain.tick(self.now_us, &inputs);
            self.pulses.push(counts(output.pulses_ns));
        }
        self.now_us = self.now_us.max(to_us);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.brain.receive(self.now_us, Transport::Uart, bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        let mut bytes = vec![0; room.min(512)];
        let count = self.brain.transmit(Transport::Uart, &mut bytes);
        out.extend_from_slice(&bytes[..count]);
    }
}

/// A twin whose pulses are written down at every tick.
struct Watched {
    twin: Twin,
    pulses: Vec<Pulses>,
}

impl Device for Watched {
    fn advance(&mut self, to: Duration) {
        let tick = |time: Duration| time.as_micros() / u128::from(TICK_US);
        let before = tick(self.twin.now());
        self.twin.advance(to);
        // A port advances by a millisecond.
        if tick(self.twin.now()) > before {
            let output = self.twin.output().unwrap();
            self.pulses.push(counts(output.pulses_ns));
        }
    }

    fn receive(&mut self, bytes: &[u8]) {
        Device::receive(&mut self.twin, bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        Device::transmit(&mut self.twin, room, out);
    }
}

/// Rounds as the firmware's PWM does: to the nearest step of 320 ns.
fn counts(pulses_ns: Option<[u32; 2]>) -> Pulses {
    pulses_ns.map(|pulses| pulses.map(|ns| (ns + 160) / 320))
}

/// From the first motion to the last pulse.
fn motion(pulses: &[Pulses]) -> &[Pulses] {
    let first = pulses.iter().position(Option::is_some).unwrap();
    let begin = pulses
        .iter()
        .position(|at| at.is_some() && *at != pulses[first]);
    let end = pulses.iter().rposition(Option::is_some).unwrap();
    &pulses[begin.unwrap()..=end]
}

#[test]
fn three_robots_command_the_same() {
    let (mut ticks, mut scenarios) = (0, 0);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let scenario = Scenario::read(&path);

        let instant = WireSpeed {
            baud: 1_000_000_000,
            latency: Duration::ZERO,
        };
        let mut alone = Robot::connect(VirtualPort::new(Alone::new(), instant), 1).unwrap();
        scenario.play(&mut alone);
        let alone = alone.into_port().into_device().pulses;

        let twin = Twin::new(TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1)).unwrap();
        let watched = Watched {
            twin,
            pulses: Vec::new(),
        };
        let mut twin = Robot::connect(VirtualPort::new(watched, WireSpeed::robot()), 1).unwrap();
        scenario.play(&mut twin);
        let twin = twin.into_port().into_device().pulses;
        same(&path, "the twin", motion(&alone), motion(&twin));

        let port = rig::port(Image::Nano);
        let mut robot = Robot::connect(port, 1).unwrap();
        rig::come_near(&mut robot);
        scenario.play(&mut robot);
        rig::pass(&mut robot, Duration::from_millis(100));
        let events = rig::events(&mut robot);
        let board: Vec<Pulses> = events
            .periods
            .iter()
            .map(|period| period.powered().then(|| period.compares()))
            .collect();
        same(&path, "the firmware", motion(&alone), motion(&board));
        ticks += motion(&alone).len();
        scenarios += 1;
    }
    assert!(scenarios >= 2);
    seen(
        "the same scenarios on the brain alone, on the twin and on this image",
        &format!(
            "{ticks} set-points of {scenarios} scenarios, equal to the step of the PWM's counter (0.32 µs)"
        ),
    );
}

fn same(path: &Path, whose: &str, alone: &[Pulses], other: &[Pulses]) {
    let differ = alone
        .iter()
        .zip(other)
        .position(|(one, other)| one != other);
    assert!(
        differ.is_none() && alone.len() == other.len(),
        "{}: the brain alone commands {} set-points, {whose} {}; the first that differ: {differ:?}, {:?} and {:?}",
        path.display(),
        alone.len(),
        other.len(),
        differ.map(|at| alone[at]),
        differ.map(|at| other[at]),
    );
}
