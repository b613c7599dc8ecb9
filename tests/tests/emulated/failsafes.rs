//! End of motion, measured at the pins: a silent link in every state, Stop, e-stop.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::Period;
use host_link::{Port as _, Robot};
use link_protocol::{Message, Request, StateName, StopCause};

use crate::frames::encoded;
use crate::promise::seen;
use crate::rig::{self, Port};

const MS: Duration = Duration::from_millis(1);
const PERIOD: Duration = Duration::from_secs(10);
/// A tick comes this long before the period that shows it at the pins.
const LATCH: Duration = Duration::from_millis(12);
const TICK: Duration = Duration::from_millis(20);
/// Longest time from a frame's last byte to its decoding: the UART reports the last bytes of a burst after 32 bits of silence
/// (RP2040 datasheet, 4.2.6.5: receive timeout; 278 us at 115 200 baud).
const READ: Duration = Duration::from_micros(400);

/// State of a robot when its link falls silent.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Case {
    Stopped,
    EStopped,
    Holding,
    Starting,
    Playing,
    Paused,
    UploadWhileHolding,
    UploadWhilePlaying,
    Stopping,
    Settling,
    Detached,
}

/// Brings a stopped robot there.
fn bring(robot: &mut Robot<Port>, case: Case) {
    let play = |robot: &mut Robot<Port>| {
        robot.arm(true).unwrap();
        robot.play(0, PERIOD, false).unwrap();
        rig::live_until(robot, StateName::Playing);
    };
    match case {
        Case::Stopped => {}
        Case::EStopped => {
            robot.estop().unwrap();
        }
        Case::Starting => {
            robot.arm(true).unwrap();
            robot.play(0, PERIOD, false).unwrap();
            rig::live_until(robot, StateName::Starting);
        }
        Case::Detached => {
            robot.arm(true).unwrap();
            robot.play(1, MS * 4000, true).unwrap();
            rig::live_until(robot, StateName::Playing);
        }
        // Away from neutral, where there is a way to go.
        Case::Holding | Case::UploadWhileHolding => {
            play(robot);
            robot.estop().unwrap();
            robot.arm(true).unwrap();
        }
        _ => play(robot),
    }
    match case {
        Case::Paused => {
            robot.pause(false).unwrap();
            rig::live_until(robot, StateName::Paused);
        }
        Case::UploadWhileHolding | Case::UploadWhilePlaying => half_an_upload(robot),
        Case::Stopping => {
            robot.stop().unwrap();
            assert_eq!(robot.status().unwrap().state, StateName::Stopping);
        }
        Case::Settling => {
            robot.stop().unwrap();
            rig::live_until(robot, StateName::Settling);
        }
        _ => {}
    }
}

/// Begins to send another gait, and breaks off.
fn half_an_upload(robot: &mut Robot<Port>) {
    let broken_off = robot.upload(rig::circle(50.0).bytes(), PERIOD, |progress| {
        if progress.done > progress.total / 2 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert!(broken_off.is_err());
}

/// Time of the last period with pulses. Returns `None` without pulses.
fn last_pulse(periods: &[Period]) -> Option<Duration> {
    let powered = periods.iter().rev().find(|period| period.powered());
    powered.map(Period::at)
}

fn span(times: &[Duration]) -> String {
    let (least, most) = (times.iter().min().unwrap(), times.iter().max().unwrap());
    format!("{} to {}", least.as_millis(), most.as_millis())
}

/// R5 and R6: the ramp starts within 500 ms of silence and takes the largest angle over the largest rate, pulses go 0.5 s
/// later; latched.
#[test]
fn a_silent_link_ends_motion_in_every_state() {
    let mut robot = rig::robot();
    rig::upload(&mut robot, &rig::circle(60.0));
    let (mut ramps, mut offs) = (Vec::new(), Vec::new());
    for case in [
        Case::Stopped,
        Case::Holding,
        Case::Starting,
        Case::Playing,
        Case::Paused,
        Case::UploadWhileHolding,
        Case::UploadWhilePlaying,
        Case::Stopping,
        Case::Settling,
        Case::Detached,
        Case::EStopped,
    ] {
        bring(&mut robot, case);
        rig::pass(&mut robot, 10 * MS); // what is on the line still
        rig::events(&mut robot);
        rig::pass(&mut robot, PERIOD);
        let silent = robot.port().device().last_heard();
        let periods = rig::events(&mut robot).periods;
        let after = |time: Duration| time.saturating_sub(silent);
        let off = last_pulse(&periods).map(after);
        robot.reconnect().unwrap();
        let status = robot.status().unwrap();
        let stopped = match case {
            Case::EStopped => StateName::EStopped,
            _ => StateName::Stopped,
        };
        assert_eq!(status.state, stopped, "{case:?}");
        match case {
            Case::Stopped | Case::EStopped => assert_eq!(off, None, "{case:?}"),
            Case::Detached => {
                assert_eq!(status.cause, StopCause::Finished);
                assert!(off.unwrap() > 3000 * MS, "{off:?}");
            }
            // Already on their way, which needs nobody to hear from.
            Case::Stopping | Case::Settling => {
                assert_eq!(status.cause, StopCause::Requested, "{case:?}");
                assert!(off.unwrap() < 1300 * MS, "{case:?}: {off:?}");
            }
            _ => {
                let ramp = after(rig::ramp_begins(&periods));
                assert_eq!(status.cause, StopCause::LinkLost, "{case:?}");
                assert!(ramp <= 500 * MS, "{case:?}: {ramp:?}");
                // 60 degrees at most are gone; 3.5 rad/s.
                let longest = ramp + 800 * MS + 500 * MS + LATCH;
                assert!(off.unwrap() <= longest, "{case:?}: {off:?}");
                ramps.push(ramp);
                offs.extend(off);
            }
        }
        // A link that comes back resumes nothing.
        rig::live(&mut robot, 500 * MS);
        let later = rig::events(&mut robot).periods;
        assert!(!later.iter().any(Period::powered), "{case:?}");
    }
    seen(
        "R5, link silent while holding, starting, playing, paused, uploading (holding, playing)",
        &format!(
            "the ramp begins {} ms after the last byte, the last pulse {} ms after it; Stopped, latched",
            span(&ramps),
            span(&offs)
        ),
    );
    seen(
        "R5, link silent while stopped, e-stopped, stopping, settling; while one cycle is played detached",
        "goes on as it was; plays to its end",
    );
}

/// Sends a stop as a stranger does: no session, no number. Returns the periods after it, and when its last byte arrived.
fn stranger(robot: &mut Robot<Port>, request: Request) -> (Vec<Period>, Duration) {
    let frame = encoded(0, 0, &Message::Request(request));
    rig::events(robot);
    robot.port_mut().write(&frame).unwrap();
    rig::pass(robot, 60 * MS);
    (
        rig::events(robot).periods,
        robot.port().device().last_heard(),
    )
}

/// R5: an e-stop takes the pulses away within a tick, Stop begins its ramp within one; whenever in a tick they come, and in
/// the middle of an upload.
#[test]
fn stop_and_estop_act_within_a_tick() {
    let mut robot = rig::robot();
    rig::upload(&mut robot, &rig::circle(85.0));
    bring(&mut robot, Case::Holding);
    let (mut ramps, mut offs) = (Vec::new(), Vec::new());
    for phase in 0..5 {
        rig::live(&mut robot, 100 * MS + phase * 4 * MS);
        let (periods, arrived) = stranger(&mut robot, Request::EStop);
        let last = last_pulse_after(&periods, arrived);
        assert!(last <= TICK, "{last:?}");
        offs.push(last);
        robot.reconnect().unwrap();
        assert!(robot.arm(false).is_err(), "latched");
        robot.arm(true).unwrap();

        rig::live(&mut robot, 100 * MS + phase * 4 * MS);
        let (periods, arrived) = stranger(&mut robot, Request::Stop);
        let ramp = rig::ramp_begins(&periods).checked_sub(arrived).unwrap();
        assert!(ramp <= READ + TICK + LATCH, "{ramp:?}");
        ramps.push(ramp);
        robot.arm(false).unwrap();
    }
    robot.stop().unwrap();
    rig::live_until(&mut robot, StateName::Stopped);
    for case in [Case::UploadWhilePlaying, Case::UploadWhileHolding] {
        bring(&mut robot, case);
        let (periods, arrived) = stranger(&mut robot, Request::EStop);
        let last = last_pulse_after(&periods, arrived);
        assert!(last <= TICK, "{case:?}: {last:?}");
        offs.push(last);
    }
    // Where in a tick the bytes of these five moments end is the image's affair, so the rows say what held for all.
    println!("{ramps:?} {offs:?}");
    seen(
        "R5, Stop, whenever in a tick it arrives",
        "the ramp begins within 32.4 ms of its last byte, at the pins (0.4 ms until it is read, 20 ms of the tick, 12 ms to the next period)",
    );
    seen(
        "R5, e-stop, whenever in a tick it arrives, and in the middle of an upload",
        "the last pulse begins within 20 ms of its last byte; latched",
    );
}

/// Time from `arrived` to the start of the last pulse; zero if no pulse began after it.
fn last_pulse_after(periods: &[Period], arrived: Duration) -> Duration {
    assert!(!periods.last().unwrap().powered());
    last_pulse(periods).map_or(Duration::ZERO, |last| last.saturating_sub(arrived))
}
