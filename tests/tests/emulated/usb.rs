//! The USB cable: a bare board and nothing else is a robot to try, and the way to the boot loader is open to who holds it.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::{BoardLine, EmulatedRobot, Period};
use host_link::port::{VirtualPort, WireSpeed};
use host_link::{Port as _, Robot};
use link_protocol::{
    Decoder, Hello, Message, PROTOCOL_CURRENT, Refusal, Reply, Request, ResetReason, SCHEMA_KEY,
    StateName,
};

use crate::frames::encoded;
use crate::promise::seen;
use crate::rig::{self, Image, Port};

const MS: Duration = Duration::from_millis(1);

/// A robot on a cable at full speed; its HC-05 was never built in.
fn on_a_cable(image: Image) -> Robot<Port> {
    let device: EmulatedRobot = rig::device(image).over_usb().unwrap();
    let speed = WireSpeed {
        baud: 8_000_000,
        latency: MS,
    };
    let mut port = VirtualPort::new(device, speed);
    port.pass(100 * MS); // the computer finds the device
    Robot::connect(port, 1).unwrap()
}

#[test]
fn a_bare_board_on_a_cable_is_a_robot() {
    for image in [Image::Pico, Image::Nano] {
        let mut robot = on_a_cable(image);
        let table = rig::circle(60.0);
        let begin = robot.port().now();
        rig::upload(&mut robot, &table);
        let took = robot.port().now().saturating_sub(begin);
        robot.arm(false).unwrap();
        robot.play(2, 2500 * MS, false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
        let events = rig::events(&mut robot);
        assert!(events.resets.is_empty(), "{:?}", events.resets);
        let powered: Vec<&Period> = events.periods.iter().filter(|p| p.powered()).collect();
        let widest = powered
            .iter()
            .flat_map(|p| rig::angles(p))
            .fold(0.0, f64::max);
        assert!(
            powered.len() >= 250 && (widest.to_degrees() - 60.0).abs() < 0.5,
            "{widest}"
        );
        let uneven = powered.windows(2).any(|pair| {
            let apart = pair[1].at().saturating_sub(pair[0].at());
            apart.abs_diff(20 * MS) > Duration::from_nanos(10)
        });
        assert!(!uneven, "the period shakes");

        // Endless, and stopped.
        robot.arm(false).unwrap();
        robot.play(0, 2500 * MS, false).unwrap();
        rig::live_until(&mut robot, StateName::Playing);
        robot.stop().unwrap();
        rig::live_until(&mut robot, StateName::Stopped);
        rig::live(&mut robot, 40 * MS); // to the pins
        assert!(!rig::events(&mut robot).periods.last().unwrap().powered());
        let mut bytes = Vec::new();
        let board = rig::board_of(&mut robot);
        board.take_sent(BoardLine::Uart, board.now(), usize::MAX, &mut bytes);
        assert!(bytes.is_empty(), "bytes to a radio that is not there");
        seen(
            &format!("USB, {image:?}, nothing but the cable (STATE open)"),
            &format!(
                "enumerated by rp2040js's CDC host; a table of 512 knots uploaded in {:.2} s, two cycles played, stopped; \
                 no byte to the UART, no jitter of the period",
                took.as_secs_f64()
            ),
        );
    }
}

/// R5 at the cable: pulled in full motion, it is a link that is silent.
#[test]
fn a_cable_that_is_pulled_ends_motion() {
    let mut robot = on_a_cable(Image::Pico);
    rig::upload(&mut robot, &rig::circle(60.0));
    robot.arm(false).unwrap();
    robot.play(0, 2500 * MS, false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    rig::events(&mut robot);
    let pulled = rig::board_of(&mut robot).now();
    rig::board_of(&mut robot).set_plugged(false).unwrap();
    rig::pass(&mut robot, 3000 * MS);
    let periods = rig::events(&mut robot).periods;
    let last = periods.iter().rev().find(|p| p.powered()).unwrap();
    let off = last.at().saturating_sub(pulled);
    assert!(off <= 2000 * MS, "{off:?}");
    rig::board_of(&mut robot).set_plugged(true).unwrap();
    rig::pass(&mut robot, 200 * MS);
    robot.reconnect().unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    seen(
        "R5, the USB cable pulled while playing, the board powered from the pack",
        &format!(
            "the last pulse {} ms after it; found again when it is back, Stopped",
            off.as_millis()
        ),
    );
}

/// Whichever way greeted last holds the session; Stop acts from both.
#[test]
fn who_greets_last_holds_the_session() {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    rig::board_of(&mut robot).set_plugged(true).unwrap();
    rig::live(&mut robot, 100 * MS);
    let hello = Message::Hello(Hello {
        protocol_min: PROTOCOL_CURRENT,
        protocol_current: PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        host_nonce: 77,
    });
    over_usb(&mut robot, &hello);
    let session = heard_over_usb(&mut robot)
        .into_iter()
        .find_map(|message| match message {
            Message::HelloReply(reply) => Some(reply.session),
            _ => None,
        })
        .expect("greeted");
    assert_ne!(session, robot.info().session);
    // The one over the radio is over.
    let refused = robot.play(1, 2500 * MS, false);
    assert!(refused.is_err(), "{refused:?}");
    over_usb(&mut robot, &Message::Request(Request::Stop));
    let stopped = heard_over_usb(&mut robot)
        .iter()
        .any(|message| matches!(message, Message::Reply(Reply::Done)));
    assert!(stopped, "no answer to a Stop over USB");
    rig::pass(&mut robot, 2000 * MS);
    robot.reconnect().unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
}

fn over_usb(robot: &mut Robot<Port>, message: &Message) {
    let board = rig::board_of(robot);
    board.feed_usb(&encoded(0, 1, message)).unwrap();
    rig::pass(robot, 50 * MS);
}

fn heard_over_usb(robot: &mut Robot<Port>) -> Vec<Message> {
    let mut bytes = Vec::new();
    let board = rig::board_of(robot);
    board.take_sent(BoardLine::Usb, board.now(), usize::MAX, &mut bytes);
    let mut decoder = Decoder::new();
    bytes
        .into_iter()
        .filter_map(|byte| decoder.push(byte)?.message.ok())
        .collect()
}

/// Asked for at the cable, the chip leaves for its loader; what that resets it by afterwards is no fault.
#[test]
fn the_boot_loader_is_entered_where_somebody_is_present() {
    let mut far = rig::robot();
    assert_eq!(
        rig::refusal(far.enter_boot_loader()),
        Refusal::NeedsPresence
    );
    for (image, led) in [(Image::Pico, 25), (Image::Nano, 6)] {
        let mut robot = on_a_cable(image);
        robot.arm(false).unwrap();
        assert!(matches!(
            rig::refusal(robot.enter_boot_loader()),
            Refusal::WrongState(_)
        ));
        robot.stop().unwrap();
        rig::live_until(&mut robot, StateName::Stopped);
        robot.enter_boot_loader().unwrap();
        rig::pass(&mut robot, 1000 * MS);
        let events = rig::events(&mut robot);
        let [loader] = events.loader[..] else {
            panic!("{:?}", events.loader)
        };
        // Drive and picotool's interface, and the LED shows its work.
        assert_eq!(
            (loader.activity_pins, loader.disabled_interfaces),
            (1 << led, 0)
        );
        rig::board_of(&mut robot).boot_rom_reset().unwrap();
        rig::pass(&mut robot, 200 * MS);
        robot.reconnect().unwrap();
        assert_eq!(robot.info().reset_reason, ResetReason::Pin);
        assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    }
    seen(
        "boot loader asked for over USB, both boards",
        "refused over the radio and while pulses are on; else the boot ROM is called with both its interfaces and the LED; \
         after its reset the reason is `reset pin`",
    );
}
