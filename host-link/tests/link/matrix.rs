//! Durations of uploads over loss, latency and lumps, in virtual time, as a snapshot under version control; and their ratio to
//! the capacity of the line.

use crate::tank_less;

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Duration;

use host_link::port::{VirtualPort, WireSpeed};
use host_link::testing::{FaultPlan, Faults, FaultyPort};
use host_link::{Port, Robot};
use tank_less::{circle, faulty};

const MS: Duration = Duration::from_millis(1);
const PATIENCE: Duration = Duration::from_mins(3);
const SEEDS: u64 = 9;

/// Time from the request for an upload of 2 kB until the table is checked. Returns `None` if it failed.
fn upload_time(faults: Faults, seed: u64) -> Option<Duration> {
    let mut robot = Robot::connect(faulty(Faults::none(), seed), seed).unwrap();
    robot.port_mut().set_plan(FaultPlan::at_host(faults));
    timed(&mut robot)
}

fn timed(robot: &mut Robot<impl Port>) -> Option<Duration> {
    let table = circle(1.2);
    let began = robot.port().now();
    let info = robot
        .upload(table.bytes(), PATIENCE, |_| ControlFlow::Continue(()))
        .ok()?;
    assert_eq!(info.crc32, table.crc32());
    Some(robot.port().now().abs_diff(began))
}

#[test]
fn the_matrix_of_upload_times() {
    let mut text = String::from(
        "2048 bytes at 115200 baud, check included; median and worst of 9 seeds, seconds; loss per frame, each way; latency each way\n",
    );
    for clump in [0, 230] {
        let _ = writeln!(text, "\nclumps of {clump} bytes towards the host");
        let _ = writeln!(
            text,
            "{:>6} {:>12} {:>12} {:>12} {:>12} {:>12}",
            "loss", "0 ms", "50 ms", "100 ms", "200 ms", "500 ms"
        );
        for loss in [0, 1, 5, 10, 20] {
            let _ = write!(text, "{loss:>5}%");
            for latency in [0, 50, 100, 200, 500] {
                let faults = Faults {
                    drop: f64::from(loss) * 0.01,
                    delay: MS * latency,
                    clump,
                    ..Faults::none()
                };
                let mut times: Vec<_> = (0..SEEDS).map(|seed| upload_time(faults, seed)).collect();
                // Failed uploads sort last.
                times.sort_by_key(|time| time.unwrap_or(Duration::MAX));
                let seconds = |time: Option<Duration>| {
                    time.map_or("failed".to_owned(), |time| {
                        format!("{:.1}", time.as_secs_f64())
                    })
                };
                let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
                let _ = write!(text, " {:>5}–{:<6}", seconds(median), seconds(worst));
            }
            let _ = writeln!(text);
        }
    }
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let text = lines.join(
        "
",
    );
    insta::assert_snapshot!(text);
}

#[test]
fn what_an_upload_takes_is_foretold() {
    for latency in [0, 5, 20, 50, 100, 200, 500] {
        let slow = Faults {
            delay: MS * latency,
            ..Faults::none()
        };
        let mut robot = Robot::connect(faulty(slow, 1), 1).unwrap();
        // A first request measures the round trip of a slow line.
        robot.status().unwrap();
        let foretold = robot.expected_upload(2048).as_secs_f64();
        let took = timed(&mut robot).unwrap().as_secs_f64();
        println!("{latency} ms each way: {foretold:.2} s foretold, {took:.2} s taken");
        assert!((foretold / took - 1.0).abs() < 0.1, "{latency} ms each way");
    }
}

/// Capacity of a line that is kept full, bytes per second.
fn poured(speed: WireSpeed) -> f64 {
    let mut wire = host_link::port::Wire::new(speed);
    let mut out = Vec::new();
    wire.push(Duration::ZERO, &vec![0x55; 60_000]);
    let second = Duration::from_secs(1);
    // One second of it, after the first byte has arrived.
    let first = wire.next_arrival().unwrap();
    wire.pop(first, &mut out);
    out.clear();
    wire.pop(first + second, &mut out);
    out.len() as f64
}

/// Table bytes per second, from the first chunk of a 2 kB table to the last.
fn goodput(speed: WireSpeed, faults: &str) -> f64 {
    let line = VirtualPort::new(tank_less::Robot::new(5), speed);
    let line = FaultyPort::new(line, FaultPlan::at_host(faults.parse().unwrap()), 1);
    let mut robot = Robot::connect(line, 1).unwrap();
    let table = circle(1.2);
    robot
        .upload(table.bytes(), PATIENCE, |_| ControlFlow::Continue(()))
        .unwrap();
    let pieces = robot.port().inner().device().pieces;
    // The first chunk arrived before the measured time.
    (table.bytes().len() - 104) as f64 / pieces.1.abs_diff(pieces.0).as_secs_f64()
}

#[test]
fn uploads_fill_four_fifths_of_the_line() {
    // A chunk of 104 bytes is a frame of 124.
    let share = 104.0 / 124.0;
    for (name, speed, faults) in [
        ("clean wire", WireSpeed::robot(), ""),
        ("HC-05", WireSpeed::hc05(), "clump=230"),
    ] {
        let (line, goodput) = (poured(speed), goodput(speed, faults));
        println!(
            "{name}: {goodput:.0} bytes of table a second (read off to 1 ms), {:.1} % of the {line:.0} that the line passes (limit of the frames: {:.0}, {:.1} %)",
            goodput / line * 100.0,
            line * share,
            share * 100.0
        );
        assert!(goodput >= 0.8 * line, "{name}");
    }
}
