//! Uploads to the real brain over faulty lines, in virtual time: correct, at most once, resumable, and in time.

use crate::tank_less;

use std::ops::ControlFlow;
use std::time::Duration;

use host_link::session::{LinkCounters, UploadPhase};
use host_link::testing::Outage;
use host_link::{LinkError, Port, Robot};
use link_protocol::crc32c;
use tank_less::{FaultyLine, circle, connect, upload};

const MS: Duration = Duration::from_millis(1);
const MINUTE: Duration = Duration::from_mins(1);

#[test]
fn a_clean_line_uploads_at_four_fifths_of_its_pace() {
    let mut robot = connect("", 1);
    let table = circle(1.2);
    let began = robot.port().now();
    let info = upload(&mut robot, table.bytes()).unwrap();
    let committed = robot.port().now().abs_diff(began);
    assert_eq!((info.knots, info.crc32), (512, table.crc32()));
    // Time for the chunks on the wire, from the first to the last.
    let pieces = robot.port().inner().device().pieces;
    let goodput = 1944.0 / pieces.1.abs_diff(pieces.0).as_secs_f64();
    println!(
        "2048 bytes over a clean line: committed after {} ms; pieces at {goodput:.0} of 11520 bytes/s (limit of their frames: {:.0})",
        committed.as_millis(),
        11520.0 * 104.0 / 124.0
    );
    assert!(goodput > 0.8 * 11520.0, "{goodput}");
    // The check of the table takes up to a second, during which the status is polled.
    assert!(committed < MS * 1500, "{committed:?}");
    assert!(robot.link_counters().retransmissions <= 10);
}

#[test]
fn uploads_arrive_right_and_act_once_whatever_the_line_does() {
    for (loss, seeds) in [("0%", 4), ("5%", 20), ("20%", 30)] {
        let (mut worst, mut total) = (Duration::ZERO, LinkCounters::default());
        for seed in 0..seeds {
            let faults = format!("drop={loss},flip=1%,duplicate=3%,delay=40,clump=230");
            let mut robot = connect(&faults, seed);
            let before = settled(&mut robot, Robot::counters).0.acted;
            let began = robot.port().now();
            let table = circle(0.5 + 0.02 * seed as f64);
            let info = upload(&mut robot, table.bytes())
                .unwrap_or_else(|error| panic!("{loss}, seed {seed}: {error}"));
            worst = worst.max(robot.port().now().abs_diff(began));
            assert_eq!(
                (info.knots, info.crc32),
                (512, crc32c(table.bytes())),
                "{loss}, seed {seed}"
            );
            let (counters, in_vain) = settled(&mut robot, Robot::counters);
            // Begin, Commit and the earlier request for the counters (which does not count itself), each once.
            let acted = counters.acted - before;
            assert!(
                (3..=3 + in_vain).contains(&acted),
                "{loss}, seed {seed}: {acted} with {in_vain} in vain"
            );
            let (status, _) = settled(&mut robot, Robot::status);
            assert_eq!(status.table.map(|table| table.crc32), Some(info.crc32));
            let link = robot.link_counters();
            total.retransmissions += link.retransmissions;
            total.frames_sent += link.frames_sent;
        }
        println!(
            "uploads with {loss} of the frames lost each way, {seeds} seeds: {} ms at most, {} of {} frames repeated",
            worst.as_millis(),
            total.retransmissions,
            total.frames_sent
        );
    }
}

/// Repeats a request after five failed attempts, as an operator would; returns the number of repeats.
fn settled<T>(
    robot: &mut Robot<FaultyLine>,
    mut ask: impl FnMut(&mut Robot<FaultyLine>) -> Result<T, LinkError>,
) -> (T, u32) {
    for in_vain in 0..6 {
        match ask(robot) {
            Ok(answer) => return (answer, in_vain),
            Err(LinkError::NoAnswer { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
    panic!("six questions of five tries each in vain");
}

#[test]
fn a_disconnection_in_the_middle_of_an_upload_is_bridged() {
    let mut robot = connect("", 5);
    let table = circle(1.1);
    let from = robot.port().now() + MS * 120;
    robot.port_mut().disconnect(Outage::once(from, MS * 4000));
    let mut done = Vec::new();
    let info = robot
        .upload(table.bytes(), MINUTE, |progress| {
            done.push(progress.done);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(info.crc32, table.crc32());
    assert!(
        done.windows(2).all(|pair| pair[1] >= pair[0]),
        "nothing that had arrived is sent again"
    );
    assert!(robot.port().now() > from + MS * 4000);
}

#[test]
fn a_long_disconnection_is_an_error_and_the_next_upload_resumes() {
    let mut robot = connect("", 6);
    let table = circle(1.1);
    let from = robot.port().now() + MS * 150;
    robot.port_mut().disconnect(Outage::once(from, MS * 9000));
    let error = upload(&mut robot, table.bytes()).unwrap_err();
    assert!(matches!(error, LinkError::Silent { .. }), "{error}");
    let text = error.to_string();
    assert!(
        text.contains("no valid frame for 50") && text.contains("frames"),
        "{text}"
    );
    robot.port_mut().inner_mut().pass(MS * 5000);
    robot.reconnect().unwrap();
    let mut first = None;
    let info = robot
        .upload(table.bytes(), MINUTE, |progress| {
            if progress.phase == UploadPhase::Chunks {
                first.get_or_insert(progress.done);
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(info.crc32, table.crc32());
    assert!(
        first.is_some_and(|done| done >= 520),
        "resumed at {first:?}"
    );
}

/// Promise R9.
#[test]
fn r9_a_2_kb_table_in_under_a_minute_for_100_seeds() {
    let mut times: Vec<Duration> = Vec::new();
    for seed in 0..100 {
        let mut robot = connect("drop=10%,flip=1%,delay=200,clump=230", seed);
        let table = circle(1.2);
        let began = robot.port().now();
        let info = upload(&mut robot, table.bytes())
            .unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!(
            (info.knots, info.crc32),
            (512, table.crc32()),
            "seed {seed}"
        );
        times.push(robot.port().now().abs_diff(began));
    }
    times.sort();
    println!(
        "R9: 2 kB over 10 % of frames lost each way, 1 % flipped, 200 ms each way, lumps of 230 bytes: 100 of 100 seeds, median {:.1} s, at most {:.1} s",
        times[50].as_secs_f64(),
        times[99].as_secs_f64()
    );
    assert!(times[99] < MINUTE, "{:?}", times[99]);
}
