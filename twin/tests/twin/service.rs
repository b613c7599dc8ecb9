//! Twin in real time, opened by path like a real port, and its memory over a power cut.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::play::{circle, robot, table};
use gait_player::storage::MemoryStorage;
use host_link::port::{Device, PtyPort, SerialPort, TcpPort};
use host_link::testing::{FaultPlan, FaultyPort};
use host_link::{LinkError, Port, Robot};
use link_protocol::StateName;
use twin::{Twin, TwinConfig, TwinPort, VirtualRobot, WireSpeed, World, serve};

/// Ends the service even if the host's part panics.
struct End<'a>(&'a AtomicBool);
impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs `host` while a twin is served behind a pseudo-terminal and a TCP port with these faults.
fn with_twin(faults: &str, host: impl FnOnce(&str, std::net::SocketAddr)) -> Twin {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let pty = PtyPort::open(Some(&link)).unwrap();
    let tcp = TcpPort::listen("127.0.0.1:0").unwrap();
    let address = tcp.local_addr().unwrap();
    let plan = FaultPlan::at_robot(faults.parse().unwrap());
    let (mut pty, mut tcp) = (FaultyPort::new(pty, plan, 1), FaultyPort::new(tcp, plan, 2));
    let mut twin = Twin::new(TwinConfig::new(&robot(), 3)).unwrap();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let served = scope.spawn(|| {
            let mut ports: [&mut dyn Port; 2] = [&mut pty, &mut tcp];
            serve(&mut twin, &mut ports, |_| !done.load(Ordering::Relaxed)).unwrap();
        });
        let end = End(&done);
        host(link.to_str().unwrap(), address);
        drop(end);
        served.join().unwrap();
    });
    twin
}

#[test]
fn programs_open_upload_play_stop_close_and_open_again() {
    let gait = table(512, &circle(1.0));
    let twin = with_twin("drop=5%,flip=1%", |path, _| {
        let mut robot = Robot::connect(SerialPort::open(path, 115_200).unwrap(), 1).unwrap();
        let info = robot
            .upload(gait.bytes(), Duration::from_mins(1), |_| {
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(info.crc32, gait.crc32());
        robot.arm(false).unwrap();
        robot.play(0, Duration::from_secs(8), false).unwrap();
        robot
            .listen(Duration::from_millis(300), |_| ControlFlow::Continue(()))
            .unwrap();
        assert!(matches!(
            robot.telemetry().unwrap().state,
            StateName::Starting | StateName::Playing
        ));
        robot.stop().unwrap();
        drop(robot);
        // The port is free again; another program finds the robot at rest, or ramping to neutral.
        let mut again = Robot::connect(SerialPort::open(path, 115_200).unwrap(), 2).unwrap();
        let status = again.status().unwrap();
        assert!(matches!(
            status.state,
            StateName::Stopping | StateName::Settling | StateName::Stopped
        ));
        assert_eq!(status.table.unwrap().crc32, gait.crc32());
    });
    assert!(twin.now() > Duration::from_millis(300));
}

#[test]
fn tcp_serves_the_same_robot() {
    with_twin("", |path, address| {
        let mut near = Robot::connect(SerialPort::open(path, 115_200).unwrap(), 1).unwrap();
        near.trim(link_protocol::Joint::Back, 0.01).unwrap();
        let mut far = Robot::connect(TcpPort::connect(address).unwrap(), 2).unwrap();
        assert_eq!(far.servo(link_protocol::Joint::Back).unwrap().trim, 100);
        // The first session has ended, and reports it.
        assert!(matches!(near.status(), Err(LinkError::SessionLost { .. })));
    });
}

#[test]
fn a_table_survives_a_power_cut_with_its_flash() {
    let gait = table(128, &circle(0.9));
    let mut robot = Robot::connect(
        TwinPort::new(
            Twin::new(TwinConfig::new(&robot(), 3)).unwrap(),
            WireSpeed::robot(),
        ),
        1,
    )
    .unwrap();
    robot
        .upload(gait.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot
        .listen(Duration::from_secs(3), |_| ControlFlow::Continue(()))
        .unwrap();
    assert!(robot.table().unwrap().unwrap().stored);
    let twin = robot.into_port().into_device();
    assert_ne!(*twin.flash(), MemoryStorage::erased());
    let mut config = twin.config().clone();
    config.flash = twin.flash().clone();
    config.seed += 1;
    let mut robot = Robot::connect(
        TwinPort::new(Twin::new(config).unwrap(), WireSpeed::robot()),
        1,
    )
    .unwrap();
    assert_eq!(robot.table().unwrap().unwrap().crc32, gait.crc32());
}

/// Robot on a slow machine: its simulation takes four times as long.
struct Slow(Twin);

impl Device for Slow {
    fn advance(&mut self, to: Duration) {
        std::thread::sleep(4 * to.saturating_sub(self.0.now()));
        self.0.advance(to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.0.receive(bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        self.0.transmit(room, out);
    }
}

impl VirtualRobot for Slow {
    fn world(&self) -> &World {
        self.0.world()
    }

    fn world_mut(&mut self) -> &mut World {
        self.0.world_mut()
    }
}

#[test]
fn a_robot_slower_than_its_clock_lags_and_does_not_lose_its_lease() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let mut pty = PtyPort::open(Some(&link)).unwrap();
    let mut slow = Slow(Twin::new(TwinConfig::new(&robot(), 3)).unwrap());
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let served = scope.spawn(|| {
            let mut ports: [&mut dyn Port; 1] = [&mut pty];
            serve(&mut slow, &mut ports, |_| !done.load(Ordering::Relaxed)).unwrap();
        });
        let end = End(&done);
        let port = SerialPort::open(link.to_str().unwrap(), 115_200).unwrap();
        let mut robot = Robot::connect(port, 1).unwrap();
        robot.arm(false).unwrap();
        robot
            .listen(Duration::from_secs(2), |_| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!(robot.status().unwrap().state, StateName::Holding);
        drop(end);
        served.join().unwrap();
    });
}
