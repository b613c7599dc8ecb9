//! Buffer content of a host that dies while it sends as fast as it can. The tests of the emulated board include this file.

use host_link::{Port, Robot};
use link_protocol::{Header, Heartbeat, MAX_ENCODED, Message, Request, encode};

/// Writes keep-alives of this session, each with a later time, and requests that would start a motion, up to `buffer` bytes.
pub(crate) fn fill<P: Port>(robot: &mut Robot<P>, buffer: usize) {
    let session = robot.info().session;
    let now_us = u64::try_from(robot.port().now().as_micros()).unwrap();
    let mut sent = 0;
    for number in 0_u16.. {
        let heartbeat = Message::Heartbeat(Heartbeat {
            host_us: now_us,
            // Each echoes a time one microsecond later than the one before.
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
