//! A laboratory around the emulated board.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use emulator::{Board, BoardConfig, BoardKind, EmulatedRobot, Events, Period};
use gait_player::GaitTable;
use gait_player::servo::ServoMap;
use host_link::port::{Device as _, VirtualPort, WireSpeed};
use host_link::{LinkError, Port as _, Robot};
use link_protocol::{Refusal, StateName};
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::Gait as _;
use twin::{TwinConfig, World, configuration};

pub(crate) type Port = VirtualPort<EmulatedRobot>;

/// An image that `cargo xtask test` builds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Image {
    /// The Nano's.
    Nano,
    /// The Nano's with a divider of 4.7 at its battery pin.
    NanoDivider,
    /// The Pico's.
    Pico,
}

/// Configuration of the board. If a file is missing, the test fails with the sentence that says how to make it. A test that does
/// nothing instead would appear to pass.
fn config(image: Image) -> BoardConfig {
    let (kind, divider) = match image {
        Image::Nano => (BoardKind::NanoConnect, None),
        Image::NanoDivider => (BoardKind::NanoConnect, Some("divider-4700")),
        Image::Pico => (BoardKind::Pico, None),
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let mut config = BoardConfig::of_checkout(here, target.as_deref(), kind);
    if let Some(divider) = divider {
        let name = format!("swimmer-{}-{divider}.elf", kind.word());
        config.firmware.set_file_name(name);
    }
    if let Some(missing) = config.missing() {
        let advice = divider.map_or(
            "",
            |_| " (here with `--board nano-connect --battery-divider 4700`)",
        );
        panic!("{missing}{advice}");
    }
    config
}

/// A board that was just switched on.
pub(crate) fn board(image: Image) -> Board {
    Board::start(&config(image)).unwrap()
}

/// The robot of the paper with a board behind a line of 115 200 baud.
pub(crate) fn port(image: Image) -> Port {
    VirtualPort::new(device(image), WireSpeed::robot())
}

/// The robot of the paper with a board that was just switched on.
pub(crate) fn device(image: Image) -> EmulatedRobot {
    let file = SwimmerFile::preset("robot").unwrap();
    let world = World::new(&TwinConfig::new(&file, 1)).unwrap();
    let robot = EmulatedRobot::new(board(image), world).unwrap();
    // Output of a failing test.
    robot.with_log_reader(|line| eprintln!("firmware: {line}"))
}

/// The Nano's, greeted and configured.
pub(crate) fn robot() -> Robot<Port> {
    robot_of(Image::Nano)
}

/// Any image's, greeted and configured.
pub(crate) fn robot_of(image: Image) -> Robot<Port> {
    greeted(port(image))
}

/// The same with its flash behind the chip's cache.
pub(crate) fn robot_behind_cache(image: Image) -> Robot<Port> {
    let mut port = port(image);
    let board = port.device_mut().board_mut();
    board.put_flash_behind_cache().unwrap();
    greeted(port)
}

fn greeted(mut port: Port) -> Robot<Port> {
    set_pack(port.device_mut().board_mut(), 5.0);
    let mut robot = Robot::connect(port, 1).unwrap();
    let file = SwimmerFile::preset("robot").unwrap();
    robot
        .configure(configuration(&file.swimmer, &ServoFile::default()).unwrap())
        .unwrap();
    robot
}

/// The board under a robot.
pub(crate) fn board_of(robot: &mut Robot<Port>) -> &mut Board {
    robot.port_mut().device_mut().board_mut()
}

/// Closes the bench jumper for a moment: what needs presence may be set for two minutes.
pub(crate) fn come_near(robot: &mut Robot<Port>) {
    board_of(robot).set_jumper(true).unwrap();
    live(robot, Duration::from_millis(300));
    board_of(robot).set_jumper(false).unwrap();
}

/// The pack's voltage \[V\], through a divider of 4.7.
pub(crate) fn set_pack(board: &mut Board, volts: f64) {
    board.set_battery(volts / 4.7).unwrap();
}

/// Lets time pass with the session alive.
pub(crate) fn live(robot: &mut Robot<Port>, time: Duration) {
    robot.listen(time, |_| ControlFlow::Continue(())).unwrap();
}

/// Runs until telemetry reports a state.
pub(crate) fn live_until(robot: &mut Robot<Port>, state: StateName) {
    robot
        .listen(Duration::from_secs(20), |telemetry| match telemetry {
            Some(telemetry) if telemetry.state == state => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
        .unwrap();
    let told = robot.telemetry().map(|telemetry| telemetry.state);
    assert_eq!(told, Some(state));
}

/// Thumb's `b .`: a task whose first instruction this is hangs.
const BRANCH_TO_ITSELF: u16 = 0xe7fe;

/// Addresses of the firmware's tasks.
pub(crate) fn tasks(robot: &mut Robot<Port>) -> Vec<u32> {
    let symbols = board_of(robot).symbols("TaskStorage").unwrap();
    let polls = symbols
        .into_iter()
        .filter_map(|(name, address)| name.contains("4poll").then_some(address));
    polls.collect()
}

/// Hangs one task, and lets time pass until the watchdog has had its say.
pub(crate) fn hang(robot: &mut Robot<Port>, task: u32) {
    board_of(robot).patch(task, BRANCH_TO_ITSELF).unwrap();
    robot.port_mut().write(&[0; 4]).unwrap(); // something to do for a task that waits for bytes
    board_of(robot).feed_usb(&[0; 4]).unwrap();
    pass(robot, Duration::from_millis(600));
}

/// Hangs the first task whose hanging resets the chip: one that is polled all the time.
pub(crate) fn reset_by_hanging(robot: &mut Robot<Port>) {
    for task in tasks(robot) {
        hang(robot, task);
        if !events(robot).resets.is_empty() {
            return;
        }
    }
    panic!("no task whose hanging resets the chip");
}

/// Reason for which a request was refused.
pub(crate) fn refusal<T: std::fmt::Debug>(outcome: Result<T, LinkError>) -> Refusal {
    match outcome {
        Err(LinkError::Refused { refusal, .. }) => refusal,
        other => panic!("not refused: {other:?}"),
    }
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

/// Lets emulated time pass without a host.
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

/// Start of the pulses of a stop: they change faster than in any gait or soft start of these tests.
pub(crate) fn ramp_begins(periods: &[Period]) -> Duration {
    /// Largest step of an angle in 20 ms, except for those of a stop \[rad\].
    const GENTLE: f64 = 0.05;
    let moved = periods.windows(2).find(|pair| {
        let [then, now] = [angles(&pair[0]), angles(&pair[1])];
        pair[0].powered() && pair[1].powered() && (0..2).any(|i| (now[i] - then[i]).abs() > GENTLE)
    });
    moved.expect("no ramp")[1].at()
}
