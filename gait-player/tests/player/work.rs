//! Checks of tables that exceed a tick: their duration, and the requests that need not wait for them.
use crate::bench;

use bench::*;
use gait_player::{GaitTable, Transport};
use link_protocol::*;
use std::f64::consts::TAU;

/// Number of ticks from a commit to its reply.
fn ticks_to_check(bench: &mut Bench, amplitude: f64) -> usize {
    let upload = bench.send_table(&circle(amplitude));
    bench.sequence += 1;
    let commit = bench.sequence;
    assert_eq!(bench.send_request(commit, Request::Commit { upload }), None);
    let answered = |bench: &Bench| {
        let taken = |(header, reply): &(Header, Reply)| {
            header.sequence == commit && matches!(reply, Reply::Table(Some(_)))
        };
        bench.replies.iter().any(taken)
    };
    (1..=1000)
        .find(|_| {
            bench.tick();
            answered(bench)
        })
        .expect("no answer within 20 s")
}

#[test]
fn a_table_is_checked_at_full_pace_while_pulses_are_off_only() {
    let mut bench = Bench::new();
    let off = ticks_to_check(&mut bench, 1.2);
    bench.done(ARM);
    let on = ticks_to_check(&mut bench, 1.1);
    println!("ticks to check 512 knots: {off} with pulses off, {on} with them on");
    // 70 units of work per tick against 3.
    assert!(off < 25 && on > 20 * off, "{off}, {on}");
}

/// Gait of this size from a first knot on the diagonal, where the links are close to each other.
fn from_knot(first: f64, size: f64) -> GaitTable {
    GaitTable::from_fn(64, |u| {
        let angle = TAU * u;
        [
            first + size * (angle.cos() - 1.0),
            first + size * (angle.cos() - 1.0 + angle.sin()),
        ]
    })
    .unwrap()
}

/// A route with a small clearance takes many evaluations, one per tick while pulses are on.
#[test]
fn a_way_is_looked_at_once_a_tick_while_pulses_are_on() {
    // From neutral to a first knot.
    let ticks_to_start = |first: f64| {
        let mut bench = Bench::new();
        bench.upload(&from_knot(first, 0.1));
        bench.done(ARM);
        bench.sequence += 1;
        let number = bench.sequence;
        assert_eq!(bench.send_request(number, play(0, 30_000_000)), None);
        let ticks = (1..100).find(|_| bench.tick().state == StateName::Starting);
        ticks.expect("no start within 2 s")
    };
    let (near, far) = (ticks_to_start(1.6), ticks_to_start(0.3));
    // From the playing gait's first knot to that of the next table.
    let ticks_to_swap = |first: f64| {
        let mut bench = Bench::playing(&from_knot(first, 0.1), play(0, 30_000_000));
        let upload = bench.send_table(&from_knot(1.6, 0.2));
        bench.sequence += 1;
        let number = bench.sequence;
        assert_eq!(bench.send_request(number, Request::Commit { upload }), None);
        let ticks = (1..1000).find(|_| {
            bench.tick();
            bench.replies.iter().any(|(header, reply)| {
                header.sequence == number && matches!(reply, Reply::Table(Some(_)))
            })
        });
        ticks.expect("no answer within 20 s")
    };
    let (way, none) = (ticks_to_swap(0.3), ticks_to_swap(1.6));
    println!("ticks to a start {near} and {far}, to a swap {way} and {none}");
    assert!(
        near >= far + 3 && way >= none + 3,
        "{near} {far}, {way} {none}"
    );
}

#[test]
fn a_swap_goes_straight_where_the_way_is_clear() {
    let mut bench = Bench::playing(&circle(1.2), play(3, 5_000_000));
    bench.upload(&circle(0.5));
    bench.until(StateName::Starting, 6 * SECOND);
    let mut least = f32::INFINITY;
    while bench.output.state == StateName::Starting {
        let [phi1, phi2] = bench.output.setpoint;
        least = least.min(phi1.hypot(phi2));
        bench.tick();
    }
    assert!(least > 0.49, "{least} rad from neutral");
}

#[test]
fn a_check_ends_though_nobody_is_heard_any_more() {
    let mut bench = Bench::new();
    let table = circle(1.2);
    let upload = bench.send_table(&table);
    bench.keep_alive = false;
    bench.run(2 * SECOND);
    // The frame of the commit renews the lease once more; then the link fails for good.
    let commit = bench.sequence + 1;
    assert_eq!(bench.send_request(commit, Request::Commit { upload }), None);
    bench.inputs.link_up = false;
    bench.run(10 * SECOND);
    bench.inputs.link_up = true;
    bench.greet(2);
    assert_eq!(
        bench.status().table.map(|table| table.crc32),
        Some(table.crc32())
    );
}

#[test]
fn what_waits_when_the_radio_goes_is_not_sent_when_it_comes_back() {
    let mut bench = Bench::new();
    let mut frame = [0; MAX_ENCODED];
    let header = Header::new(bench.session, bench.sequence + 1);
    let len = encode(header, &Message::Request(Request::Status), &mut frame).unwrap();
    let waiting = |bench: &mut Bench| bench.brain.transmit(Transport::Uart, &mut [0; MAX_ENCODED]);
    bench
        .brain
        .receive(bench.now_us, Transport::Uart, &frame[..len]);
    assert!(waiting(&mut bench) > 0, "no answer to lose");
    let header = Header::new(bench.session, bench.sequence + 2);
    let len = encode(header, &Message::Request(Request::Status), &mut frame).unwrap();
    bench
        .brain
        .receive(bench.now_us, Transport::Uart, &frame[..len]);
    bench.now_us += 20_000;
    bench.inputs.link_up = false;
    bench.brain.tick(bench.now_us, &bench.inputs);
    assert_eq!(waiting(&mut bench), 0);
}
