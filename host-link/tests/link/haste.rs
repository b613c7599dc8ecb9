//! What a host in haste leaves in a buffer before it dies. The tests of the emulated board include this file too.

use host_link::{Port, Robot};
use link_protocol::{Header, Heartbeat, MAX_ENCODED, Message, Request, encode};

/// Writes keep-alives of this session, each later than the one before, and requests that would set the robot in motion again,
/// as many as `buffer` holds.
pub(crate) fn fill<P: Port>(robot: &mut Robot<P>, buffer: usize) {
    let session = robot.info().session;
    let now_us = u64::try_from(robot.port().now().as_micros()).unwrap();
    let mut sent = 0;
    for number in 0_u16.. {
        let heartbeat = Message::Heartbeat(Heartbeat {
            host_us: now_us,
            // A millisecond of the robot's time lies in 20 of them.
            heard_us: now_us - 10_000 + u64::from(number),
        });
        let arm = Message::Request(Request::Arm);
        for (sequence, message) in [(0, heartbeat), (30_000 + number, arm)] {
            let mut frame = [0; MAX_ENCODED];
            let header = Header::new(session, sequence);
            let len = encode(header, &message, &mut frame).unwrap();
            robot.port_mut().write(&frame[..len]).unwrap();
            sent += len;
        }
        if sent > buffer {
            return;
        }
    }
}
