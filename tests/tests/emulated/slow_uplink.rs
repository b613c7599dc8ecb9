//! R5 behind a slow uplink with a deep buffer, on the image: whatever a dead host left there, the robot stops in time.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use emulator::Period;
use host_link::port::{TracedFrame, TracedPort};
use host_link::testing::{FaultPlan, Faults, FaultyPort};
use host_link::{Port as _, Robot, StoppedBy};
use link_protocol::{Decoder, Direction, Message, StateName};

use crate::haste::fill;
use crate::promise::seen;
use crate::rig::{self, Port};

const MS: Duration = Duration::from_millis(1);
/// Bytes a second, and bytes that the buffer holds.
const RATE: u32 = 200;
const BUFFER: usize = 8192;
const MOMENTS: u32 = 10;
/// From the host's end to the ramp, at the pins: what is fresh (1 s), the lease (460 ms), a tick, and the latch.
const TO_RAMP: Duration = Duration::from_millis(1_000 + 460 + 20 + 12);
/// From there to no pulses: the longest ramp of this gait, and half a second at neutral.
const TO_OFF: Duration = Duration::from_millis(800 + 500);

/// From the last fresh keep-alive to no pulses.
const FRESH_TO_OFF: Duration = Duration::from_secs(2);
/// Largest age of the time in a fresh keep-alive (docs/security.md).
const FRESH: Duration = Duration::from_secs(1);

type Witness = Box<dyn FnMut(TracedFrame<'_>) + Send>;
type Slow = FaultyPort<TracedPort<Port, Witness>>;

/// Keep-alives as they leave the buffer: time, and the robot's time in them.
#[derive(Clone, Default)]
struct Delivered(Arc<Mutex<Vec<(Duration, Duration)>>>);

impl Delivered {
    fn witness(&self) -> Witness {
        let delivered = self.clone();
        Box::new(move |frame| {
            let mut decoder = Decoder::new();
            let received = frame.bytes.iter().find_map(|&byte| decoder.push(byte));
            if frame.direction == Direction::ToRobot
                && let Some(Ok(Message::Heartbeat(told))) =
                    received.map(|received| received.message)
            {
                let heard = Duration::from_micros(told.heard_us);
                delivered.0.lock().unwrap().push((frame.at, heard));
            }
        })
    }

    /// Time of the last fresh one. The robot's clock and the port's both began when its power came on.
    fn last_fresh(&self) -> Duration {
        let (mut latest, mut last) = (Duration::ZERO, Duration::ZERO);
        for &(at, heard) in self.0.lock().unwrap().iter() {
            if heard > latest && at <= heard + FRESH {
                (latest, last) = (heard, at);
            }
        }
        last
    }
}

/// A robot that plays without end over a line that has become slow.
fn playing(moment: u32) -> (Robot<Slow>, Delivered) {
    let mut robot = rig::robot();
    rig::upload(&mut robot, &rig::circle(60.0));
    robot.arm(false).unwrap();
    robot.play(0, MS * 8000, false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    let slow = Faults {
        rate: Some(RATE),
        buffer: BUFFER,
        ..Faults::none()
    };
    let delivered = Delivered::default();
    let mut robot = robot.map_port(|port| {
        let port = TracedPort::new(port, delivered.witness());
        FaultyPort::new(port, FaultPlan::at_host(slow), u64::from(moment))
    });
    robot
        .listen(MS * 170 * moment, |_| ControlFlow::Continue(()))
        .unwrap();
    (robot, delivered)
}

/// Time from a moment to the ramp and to the last pulse, without a host for a minute: all waiting bytes have arrived.
fn left_alone(robot: Robot<Slow>, from: Duration) -> (Duration, Duration) {
    let mut port = robot.into_port();
    let mut bytes = [0; 512];
    let end = port.now() + Duration::from_mins(1);
    while port.now() < end {
        port.read(&mut bytes, MS * 20).unwrap();
    }
    let events = port.inner_mut().inner_mut().device_mut().take_events();
    let periods: Vec<Period> = events
        .periods
        .into_iter()
        .filter(|period| period.at() >= from)
        .collect();
    let last = periods.iter().rev().find(|period| period.powered());
    let ramp = rig::ramp_begins(&periods).saturating_sub(from);
    (ramp, last.unwrap().at().saturating_sub(from))
}

#[test]
fn what_a_dead_host_left_in_a_buffer_does_nothing() {
    let (mut ramps, mut offs, mut fresh_to_offs) = (Vec::new(), Vec::new(), Vec::new());
    for moment in 0..MOMENTS {
        let (mut robot, delivered) = playing(moment);
        fill(&mut robot, BUFFER);
        let from = robot.port().now();
        let (ramp, off) = left_alone(robot, from);
        assert!(
            ramp <= TO_RAMP && off <= TO_RAMP + TO_OFF,
            "{moment}: {ramp:?} {off:?}"
        );
        // Those behind the kill count too while they are fresh.
        let last_fresh = delivered.last_fresh();
        assert!(last_fresh > from, "{last_fresh:?} {from:?}");
        let fresh_to_off = (from + off).saturating_sub(last_fresh);
        assert!(fresh_to_off <= FRESH_TO_OFF, "{moment}: {fresh_to_off:?}");
        fresh_to_offs.push(fresh_to_off);
        ramps.push(ramp);
        offs.push(off);
    }
    seen(
        "R5, uplink of 200 B/s with 8 kB of buffer, host killed at ten moments behind a full buffer",
        &format!(
            "the ramp begins at most {} ms after it, the last pulse at most {} ms after it and {} ms after the last fresh keep-alive, and nothing that waited acts",
            ramps.iter().max().unwrap().as_millis(),
            offs.iter().max().unwrap().as_millis(),
            fresh_to_offs.iter().max().unwrap().as_millis()
        ),
    );
}

#[test]
fn a_stop_behind_a_full_buffer_ends_in_time_and_the_host_says_how() {
    let (mut robot, _) = playing(3);
    fill(&mut robot, BUFFER);
    let from = robot.port().now();
    let by = robot.stop().unwrap();
    assert!(matches!(by, StoppedBy::Itself(_)), "{by:?}");
    let (ramp, _) = left_alone(robot, from);
    assert!(ramp <= TO_RAMP, "{ramp:?}");
    seen(
        "R5, a Stop behind that buffer",
        &format!(
            "the ramp begins {} ms after it, by the lease; the host says: {by}",
            ramp.as_millis()
        ),
    );
}
