//! A laboratory around the emulated board.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use emulator::{Board, BoardConfig, BoardKind, EmulatedRobot, Events, Period};
use gait_player::GaitTable;
use gait_player::servo::ServoMap;
use host_link::Robot;
use host_link::port::{Device as _, VirtualPort, WireSpeed};
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::Gait as _;
use twin::{TwinConfig, World, configuration};

pub(crate) type Port = VirtualPort<EmulatedRobot>;

/// What is needed, or none with a loud word about what is missing.
pub(crate) fn config() -> Option<BoardConfig> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let config = BoardConfig::of_checkout(
        Path::new(env!("CARGO_MANIFEST_DIR")),
        target.as_deref(),
        BoardKind::NanoConnect,
    );
    match config.missing() {
        None => Some(config),
        Some(missing) => {
            eprintln!("\n!!!! SKIPPED: {missing} !!!!\n");
            None
        }
    }
}

/// A board that was just switched on.
pub(crate) fn board() -> Option<Board> {
    Some(Board::start(&config()?).unwrap())
}

/// The robot of the paper with a board behind a line of 115 200 baud.
pub(crate) fn port() -> Option<Port> {
    let file = SwimmerFile::preset("robot").unwrap();
    let world = World::new(&TwinConfig::new(&file, 1)).unwrap();
    let robot = EmulatedRobot::new(board()?, world).unwrap();
    Some(VirtualPort::new(robot, WireSpeed::robot()))
}

/// The same, greeted and configured.
pub(crate) fn robot() -> Option<Robot<Port>> {
    let mut robot = Robot::connect(port()?, 1).unwrap();
    let file = SwimmerFile::preset("robot").unwrap();
    robot
        .configure(configuration(&file.swimmer, &ServoFile::default()))
        .unwrap();
    Some(robot)
}

/// 512 knots of a circle.
pub(crate) fn circle(degrees: f64) -> GaitTable {
    let gait = AnyGait::circle(degrees.to_radians());
    GaitTable::from_fn(512, |u| gait.at(u).phi.into()).unwrap()
}

pub(crate) fn upload(robot: &mut Robot<Port>, table: &GaitTable) {
    let info = robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(info.crc32, table.crc32());
}

/// Events since they were last taken.
pub(crate) fn events(robot: &mut Robot<Port>) -> Events {
    let device = robot.port_mut().device_mut();
    assert!(device.failure().is_none(), "{:?}", device.failure());
    device.take_events()
}

/// Lets emulated time pass with nobody at the line.
pub(crate) fn pass(robot: &mut Robot<Port>, time: Duration) {
    robot.port_mut().pass(time);
}

/// Angles that a period's pulses command \[rad\].
pub(crate) fn angles(period: &Period) -> [f64; 2] {
    let ServoMap { centre_ns, .. } = ServoMap::ROBOT;
    let slope = f64::from(ServoMap::ROBOT.slope_rad_per_us);
    period
        .pulses_us()
        .map(|us| (us - f64::from(centre_ns) * 1e-3) * slope)
}
