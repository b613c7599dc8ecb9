//! Faults of the HC-05 and its wires at the UART: not connected, another baud rate, noise, bytes while the robot does not read.

use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::testing::{Character, FaultPlan, FaultyPort, heard};
use host_link::{Port as _, Robot};
use link_protocol::{
    Header, Heartbeat, Hello, MAX_ENCODED, Message, PROTOCOL_CURRENT, PROTOCOL_MIN, Request,
    SCHEMA_KEY, StateName, encode,
};

use crate::promise::seen;
use crate::rig::{self, Port};

const BAUD: u32 = 115_200;

/// Bytes that the board has sent in this time.
fn sent_within(robot: &mut Robot<Port>, time: Duration) -> usize {
    rig::pass(robot, time);
    let mut bytes = [0; 4096];
    robot.port_mut().read(&mut bytes, Duration::ZERO).unwrap()
}

fn frame(message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_ENCODED];
    let len = encode(Header::new(0, 1), message, &mut frame).unwrap();
    frame[..len].to_vec()
}

fn hello() -> Vec<u8> {
    frame(&Message::Hello(Hello {
        protocol_min: PROTOCOL_MIN,
        protocol_current: PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        host_nonce: 9,
    }))
}

/// An unconnected HC-05 takes bytes for AT commands: none must be sent. Received bytes still count.
#[test]
fn nothing_is_sent_while_the_radio_is_not_connected() {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    let board = robot.port_mut().device_mut().board_mut();
    board.set_connected(false).unwrap();
    // Bytes in the UART and on the line.
    sent_within(&mut robot, Duration::from_millis(20));
    let stop = frame(&Message::Request(Request::Stop));
    for bytes in [hello(), stop] {
        robot.port_mut().write(&bytes).unwrap();
        let sent = sent_within(&mut robot, Duration::from_secs(1));
        assert_eq!(sent, 0, "bytes to an unconnected radio");
    }
    assert!(!rig::events(&mut robot).periods.last().unwrap().powered());
    let board = robot.port_mut().device_mut().board_mut();
    board.set_connected(true).unwrap();
    robot.reconnect().unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    seen(
        "HC-05 not connected (STATE low)",
        "not a byte sent in 2 s, a greeting and a Stop received meanwhile (the Stop acted); answers again when it connects",
    );
}

/// Whatever arrives, nothing acts that was not sent, nothing resets, and the next frame is understood.
#[test]
fn a_wrong_baud_rate_and_a_broken_line_do_nothing() {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    rig::pass(&mut robot, Duration::from_millis(100));
    rig::events(&mut robot);
    let estop = frame(&Message::Request(Request::EStop)).repeat(20);
    let lines: Vec<(String, Vec<Character>)> = [9_600, 38_400, 57_600, 230_400]
        .map(|baud| (format!("{baud} baud"), heard(&estop, baud, BAUD)))
        .into_iter()
        .chain([
            ("framing errors".to_owned(), faulty(&estop, false)),
            ("breaks".to_owned(), faulty(&[0; 200], true)),
        ])
        .collect();
    for (name, characters) in lines {
        let board = robot.port_mut().device_mut().board_mut();
        board.feed_characters(&characters).unwrap();
        robot
            .listen(Duration::from_millis(300), |_| ControlFlow::Continue(()))
            .unwrap();
        // An e-stop that came through would show.
        let state = robot.status().unwrap().state;
        assert_eq!(state, StateName::Holding, "{name}");
        let events = rig::events(&mut robot);
        assert!(events.resets.is_empty(), "{name}");
        assert!(
            events.periods.iter().all(emulator::Period::powered),
            "{name}"
        );
    }
    seen(
        "UART at 9600, 38 400, 57 600 or 230 400 baud, framing errors, breaks",
        "no request acts (e-stops were sent), no reset, pulses go on; the next frame is answered",
    );
}

fn faulty(bytes: &[u8], silent: bool) -> Vec<Character> {
    let broken = |&byte| Character {
        byte,
        framing: true,
        silent,
    };
    bytes.iter().map(broken).collect()
}

/// Erasing flash stops the chip for 45 ms, in which 500 bytes can come: most are lost, and no harm is done.
#[test]
fn bytes_are_lost_while_flash_is_erased_and_the_link_goes_on() {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    let table = rig::circle(30.0);
    rig::upload(&mut robot, &table);
    rig::events(&mut robot);
    // It is stored as soon as the robot is stopped, while the line is never silent.
    robot.stop().unwrap();
    rig::pass(&mut robot, Duration::from_millis(400));
    let heartbeat = Heartbeat {
        host_us: 0,
        heard_us: 0,
    };
    let keep_alive = frame(&Message::Heartbeat(heartbeat)).repeat(200);
    robot.port_mut().write(&keep_alive).unwrap();
    rig::pass(&mut robot, Duration::from_millis(400));
    let events = rig::events(&mut robot);
    assert!(events.erased > 0 && events.lost > 0, "{events:?}");
    assert!(events.resets.is_empty());
    robot.reconnect().unwrap();
    rig::pass(&mut robot, Duration::from_secs(1));
    let held = robot.table().unwrap().unwrap();
    assert!(held.stored && held.crc32 == table.crc32());
    seen(
        "UART overrun: bytes come while a sector is erased",
        &format!(
            "{} of {} bytes lost, no reset, the table stored, the next frame is answered",
            events.lost,
            keep_alive.len()
        ),
    );
}

/// R9 through the real UART: lost and flipped frames.
#[test]
fn a_table_arrives_over_a_line_that_drops_and_flips() {
    let robot = rig::robot();
    let plan = FaultPlan::at_host("drop=10%,flip=5%,duplicate=2%".parse().unwrap());
    let mut robot = robot.map_port(|port| FaultyPort::new(port, plan, 5));
    let table: GaitTable = rig::circle(60.0);
    let start = robot.port().now();
    let info = robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    let took = robot.port().now().checked_sub(start).unwrap();
    assert_eq!(info.crc32, table.crc32());
    let (out, back) = robot.port().counts();
    assert!(
        out.dropped > 0 && back.dropped > 0 && out.flipped + back.flipped > 0,
        "{out:?} {back:?}"
    );
    seen(
        "R9, 2 kB table over 10 % of frames lost, 5 % with a flipped bit and 2 % twice, each way",
        &format!("arrived right after {:.1} s", took.as_secs_f64()),
    );
    assert!(took < Duration::from_mins(1));
}
