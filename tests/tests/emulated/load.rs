//! R11 and R13: busy time of the chip in a servo period under every load, with its flash behind the cache of the chip, and the
//! depth of its stack.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::Period;
use host_link::Robot;
use host_link::session::UploadPhase;
use link_protocol::{Flags, StateName};

use crate::promise::seen;
use crate::rig::{self, Image, Port};

/// Longest times in a period \[ms\]: of a tick, and awake for whatever reason.
#[derive(Debug, Clone, Copy)]
struct Busiest {
    tick: f64,
    awake: f64,
}

/// Longest times in the servo periods since the last call, and the number of periods.
fn busiest(robot: &mut Robot<Port>) -> (Busiest, usize) {
    let periods = rig::events(robot).periods;
    let longest = |time: fn(&Period) -> f64| periods.iter().map(time).fold(0.0, f64::max);
    let busiest = Busiest {
        tick: longest(Period::tick_ms),
        awake: longest(Period::busy_ms),
    };
    (busiest, periods.len())
}

#[test]
fn no_tick_takes_more_than_two_milliseconds_while_pulses_are_on() {
    for image in [Image::Nano, Image::Pico] {
        let mut robot = rig::robot_behind_cache(image);
        measure(&mut robot, image);
    }
}

fn measure(robot: &mut Robot<Port>, image: Image) {
    rig::upload(robot, &rig::circle(60.0));
    let (stopped, _) = busiest(robot);
    assert!(stopped.tick > 2.0 && stopped.awake <= 20.0, "{stopped:?}");
    robot.arm(false).unwrap();
    busiest(robot);
    robot.play(0, Duration::from_secs(10), false).unwrap();
    rig::live_until(robot, StateName::Playing);
    let (way, _) = busiest(robot);
    rig::live(robot, Duration::from_secs(10));
    let (playing, _) = busiest(robot);

    // 512 more knots come while the others play: first nearly all, then the rest and the request to check them.
    let table = rig::circle(50.0);
    let patience = Duration::from_mins(1);
    let _ = robot.upload(table.bytes(), patience, |progress| {
        if progress.phase == UploadPhase::Chunks && progress.done + 200 > progress.total {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    let (arriving, _) = busiest(robot);
    robot
        .upload(table.bytes(), patience, |_| ControlFlow::Continue(()))
        .unwrap();
    let status = robot.status().unwrap();
    assert_eq!(status.state, StateName::Playing);
    assert!(status.flags.contains(Flags::SWAP_PENDING));
    let (checking, ticks) = busiest(robot);

    let powered = [way, playing, arriving, checking];
    for Busiest { tick, awake } in powered {
        assert!(tick > 0.5 && tick <= 2.0 && awake > tick, "{powered:?}");
    }
    let longest = powered
        .iter()
        .map(|busiest| busiest.awake)
        .fold(0.0, f64::max);
    seen(
        &format!("R11, longest tick at 125 MHz, {image:?}, flash behind its cache"),
        &format!(
            "{:.2} ms while playing, {:.2} ms while the way to the first knot is checked, {:.2} ms while 512 more knots \
             arrive, {:.2} ms while they are checked (which takes {ticks} ticks); all that a servo period does (tick, UART, \
             telemetry) at most {longest:.2} ms; {:.0} ms while a table is checked with pulses off",
            playing.tick, way.tick, arriving.tick, checking.tick, stopped.tick
        ),
    );
    if image != Image::Nano {
        return;
    }
    let stack = rig::board_of(robot).stack().unwrap();
    assert!(stack.left >= 1024, "{stack:?}");
    seen(
        "R13, deepest stack in that session (painted at power-up)",
        &format!("{} of {} bytes", stack.used(), stack.size),
    );
}
