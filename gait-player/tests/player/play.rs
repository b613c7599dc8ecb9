//! A gait from upload to its last cycle (promise R15), pause and resume, the swap of tables, and every refusal on the way.
#![allow(clippy::float_cmp)] // set-points are compared to the last bit
use crate::bench;

use bench::*;
use gait_player::ramp::Ramp;
use gait_player::{GaitTable, Limits, TICK_US, Transport};
use link_protocol::*;
use swimmer_model::{Circle, Model, Swimmer, Tolerance, swim};

fn degrees(radians: f64) -> f64 {
    radians.to_degrees()
}

#[test]
fn three_cycles_from_upload_to_rest() {
    let table = circle(1.2);
    let mut bench = Bench::new();
    bench.upload(&table);
    assert_eq!(bench.output.pulses_ns, None);
    bench.done(ARM);
    let armed = bench.tick();
    assert_eq!(
        (armed.state, armed.pulses_ns),
        (StateName::Holding, Some([1_500_000; 2]))
    );
    let before = bench.now_us;
    bench.done(play(3, 5_000_000));
    bench.until(StateName::Playing, 2 * SECOND);
    println!(
        "soft start from neutral to 48.6 deg: {} ms",
        (bench.now_us - before) / 1000
    );
    assert!(bench.now_us - before <= 2 * SECOND);
    // The first tick of the play commands the first knot.
    let start = bench.now_us;
    let first = table.knot_angles(0);
    assert!((0..2).all(|joint| (bench.output.setpoint[joint] - first[joint]).abs() < 1e-6));
    assert!(bench.output.cycle_flash && bench.output.led);
    let took = bench.until(StateName::Stopping, 16 * SECOND);
    assert_eq!(took, 15 * SECOND);
    let status = bench.status();
    assert_eq!(
        (status.cycle, status.cycles, status.cause),
        (3, 3, StopCause::Finished)
    );
    assert_eq!(bench.output.setpoint, first);
    let to_rest = bench.until(StateName::Stopped, 2 * SECOND);
    // 0.849 rad at 3.5 rad/s, rounded to ticks, then half a second.
    assert_eq!(to_rest, 260_000 + 500_000);
    assert_eq!(
        (bench.output.pulses_ns, bench.output.setpoint),
        (None, [0.0; 2])
    );
    assert_eq!(bench.now_us - start, 15 * SECOND + to_rest);
    // The play is over, and nothing starts again.
    assert_eq!(bench.refused(play(1, 5_000_000)), Refusal::NotArmed);
    bench.done(ARM);
    bench.done(play(1, 5_000_000));
}

#[test]
fn r15_the_commanded_angles_are_the_tables_and_an_hour_does_not_drift() {
    let amplitude = 1.9_f64;
    // A period that is not a multiple of a tick.
    let period_us = 4_999_999;
    let mut bench = Bench::playing(&circle(amplitude), play(0, period_us));
    let map = gait_player::servo::ServoMap::ROBOT;
    let start = bench.now_us;
    let (mut sum, mut worst, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut last_cycle_start = start;
    let mut check = |bench: &mut Bench| {
        let elapsed = bench.now_us - start;
        let u = (elapsed % u64::from(period_us)) as f64 / f64::from(period_us);
        let angle = std::f64::consts::TAU * (u + 0.125);
        for (joint, wanted) in [amplitude * angle.cos(), amplitude * angle.sin()]
            .into_iter()
            .enumerate()
        {
            let pulse = bench.output.pulses_ns.unwrap()[joint];
            let error = degrees(f64::from(map.angle(pulse)) - wanted);
            sum += error * error;
            worst = worst.max(error.abs());
            count += 1.0;
        }
        if elapsed % u64::from(period_us) < u64::from(TICK_US) {
            assert!(bench.output.cycle_flash);
            last_cycle_start = bench.now_us;
        }
    };
    while bench.now_us - start <= 3600 * SECOND {
        check(&mut bench);
        bench.tick();
        bench.telemetry.clear();
    }
    let rms = (sum / count).sqrt();
    println!("R15: commanded against table over an hour: {rms:.5} deg RMS, {worst:.5} deg at most");
    assert!(rms < 0.02 && worst < 0.05, "{rms} {worst}");
    let cycles = 3600 * SECOND / u64::from(period_us);
    let exact = start + cycles * u64::from(period_us);
    println!(
        "R15: start of cycle {cycles} late by {} us (a tick is 20000 us)",
        last_cycle_start - exact
    );
    assert!(last_cycle_start - exact < u64::from(TICK_US));
    assert_eq!(bench.status().cycle, u32::try_from(cycles).unwrap());
    assert_eq!(bench.output.state, StateName::Playing);
}

#[test]
fn telemetry_tells_and_stays_below_five_kilobytes_a_second() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 10_000_000));
    bench.telemetry.clear();
    let (before, start) = (bench.bytes_out, bench.now_us);
    bench.run(10 * SECOND);
    let rate = (bench.bytes_out - before) as u64 / 10;
    println!(
        "telemetry: {} messages in 10 s, {rate} bytes/s",
        bench.telemetry.len()
    );
    assert_eq!(bench.telemetry.len(), 250);
    assert!(rate <= 5_000, "{rate}");
    let last = bench.telemetry.last().unwrap();
    assert_eq!(
        (last.state, last.cycles, last.battery_mv),
        (StateName::Playing, 0, Some(5_000))
    );
    assert!(
        bench
            .telemetry
            .windows(2)
            .all(|pair| pair[1].robot_us == pair[0].robot_us + 40_000)
    );
    let at = bench
        .telemetry
        .iter()
        .find(|telemetry| telemetry.robot_us >= start + 5 * SECOND)
        .unwrap();
    assert!((f64::from(at.phase) / 65_536.0 - 0.5).abs() < 0.01);
    // While the radio is disconnected nothing is sent, and pending bytes are dropped.
    bench.inputs.link_up = false;
    let before = bench.bytes_out;
    bench.keep_alive = false;
    bench.run(SECOND / 5);
    assert_eq!(bench.bytes_out, before);
}

#[test]
fn the_predicted_pose_is_the_models() {
    let swimmer = Swimmer::<f64>::robot();
    let model = Model::new(&swimmer).unwrap();
    let amplitude = 70.0_f64.to_radians();
    let stroke = swim(&model, &Circle { amplitude }, &Tolerance::default());
    let mut bench = Bench::playing(&circle(amplitude), play(2, 30_000_000));
    let end = bench.now_us + 30 * SECOND;
    bench.run(31 * SECOND);
    // Telemetry comes every other tick; the mean is used if the cycle ends between two frames.
    let near: Vec<Pose> = (bench.telemetry.iter())
        .filter(|telemetry| telemetry.robot_us.abs_diff(end) <= u64::from(TICK_US))
        .map(|telemetry| telemetry.pose)
        .collect();
    let mean = |part: fn(&Pose) -> f32| near.iter().map(part).sum::<f32>() / near.len() as f32;
    let pose = Pose {
        x: mean(|pose| pose.x),
        y: mean(|pose| pose.y),
        theta: mean(|pose| pose.theta),
    };
    println!(
        "predicted {:.6} {:.6} m, model {:.6?} m",
        pose.x, pose.y, stroke.displacement
    );
    let length = swimmer.total_length();
    assert!((f64::from(pose.x) - stroke.displacement.x).abs() < 1e-4 * length);
    assert!((f64::from(pose.y) - stroke.displacement.y).abs() < 1e-4 * length);
    assert!((f64::from(pose.theta) - stroke.rotation).abs() < 1e-3);
}

#[test]
fn a_pause_holds_the_pose_and_resume_goes_on_from_it() {
    let mut bench = Bench::playing(&circle(1.2), play(1, 5_000_000));
    assert_eq!(
        bench.refused(Request::Resume),
        Refusal::WrongState(StateName::Playing)
    );
    bench.run(2 * SECOND);
    let pose = bench.output.setpoint;
    bench.done(Request::Pause { detached: false });
    for output in bench.run(70 * SECOND) {
        assert_eq!((output.state, output.setpoint), (StateName::Paused, pose));
    }
    bench.done(Request::Resume);
    let step = bench.tick();
    assert!((0..2).all(|joint| (step.setpoint[joint] - pose[joint]).abs() < 0.04));
    let rest = bench.until(StateName::Stopping, 4 * SECOND);
    assert_eq!(rest + u64::from(TICK_US) + 2 * SECOND, 5 * SECOND);
}

#[test]
fn late_and_early_ticks_change_no_setpoint() {
    let run = |jitter: fn(u64) -> i64| {
        let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
        let mut setpoints = Vec::new();
        for tick in 1..500_u64 {
            let at = bench.now_us + tick * u64::from(TICK_US);
            let now = at.checked_add_signed(jitter(tick)).unwrap();
            bench.send_keep_alive(now);
            setpoints.push(bench.brain.tick(now, &bench.inputs).setpoint);
            assert_eq!(
                bench.brain.tick(now + 100, &bench.inputs).setpoint,
                *setpoints.last().unwrap()
            );
        }
        setpoints
    };
    let exact = run(|_| 0);
    assert_eq!(
        exact,
        run(|tick| i64::try_from(tick * 7_919 % 19_000).unwrap() - 9_500)
    );
}

impl Bench {
    fn send_keep_alive(&mut self, now_us: u64) {
        let mut frame = [0; MAX_ENCODED];
        let len = encode(
            Header::new(self.session, 0),
            &Message::Heartbeat(Heartbeat {
                host_us: 0,
                heard_us: now_us,
            }),
            &mut frame,
        )
        .unwrap();
        self.brain.receive(now_us, Transport::Uart, &frame[..len]);
    }
}

#[test]
fn a_swap_waits_for_the_end_of_the_cycle_and_goes_by_a_ramp() {
    let (old, new) = (circle(1.2), circle(0.5));
    let mut bench = Bench::playing(&old, play(3, 5_000_000));
    bench.run(SECOND);
    bench.upload(&new);
    assert!(bench.status().flags.contains(Flags::SWAP_PENDING));
    assert_eq!(
        bench.refused(Request::Begin(Begin {
            slot: 0,
            len: 8,
            crc32: 0
        })),
        Refusal::SwapPending
    );
    assert_eq!(bench.status().table.unwrap().crc32, old.crc32());
    bench.until(StateName::Starting, 5 * SECOND);
    let at_swap = bench.output.setpoint;
    // The route was checked from the old gait's first knot, so the ramp starts there, not in the tick before.
    assert!((0..2).all(|joint| (at_swap[joint] - old.knot_angles(0)[joint]).abs() < 1e-4));
    let status = bench.status();
    assert_eq!(
        (status.table.unwrap().crc32, status.cycle),
        (new.crc32(), 1)
    );
    bench.until(StateName::Playing, 2 * SECOND);
    assert!(
        (0..2).all(|joint| (bench.output.setpoint[joint] - new.knot_angles(0)[joint]).abs() < 1e-6)
    );
    // Two whole cycles of the new table.
    assert_eq!(bench.until(StateName::Stopping, 11 * SECOND), 10 * SECOND);
}

/// Cycles finished before the swap stay counted.
#[test]
fn a_swap_in_a_later_cycle_waits_for_the_end_of_that_one_and_counts_on() {
    let period = 10 * SECOND;
    let mut bench = Bench::playing(&circle(1.2), play(4, 10_000_000));
    bench.run(2 * period + SECOND);
    bench.upload(&circle(0.5));
    let status = bench.status();
    assert_eq!((status.state, status.cycle), (StateName::Playing, 2));
    bench.until(StateName::Starting, period);
    assert_eq!(bench.status().cycle, 3);
    bench.until(StateName::Playing, 2 * SECOND);
    assert_eq!(bench.until(StateName::Stopping, 2 * period), period);
    let status = bench.status();
    assert_eq!((status.cycle, status.cycles), (4, 4));
}

/// The tick in which the ramp ends is the first of the play, so no tick is lost at the first knot.
#[test]
fn a_start_takes_its_ramp_and_not_a_tick_more() {
    let mut bench = Bench::new();
    let table = circle(1.2);
    bench.upload(&table);
    bench.done(ARM);
    bench.tick();
    let ramp = Ramp::soft([0.0; 2], table.knot_angles(0), false, &Limits::ROBOT);
    bench.done(play(1, 5_000_000));
    // The motion begins in the tick that accepts the play.
    assert_eq!(bench.output.state, StateName::Starting);
    let left = bench.until(StateName::Playing, 2 * SECOND);
    assert_eq!(left + u64::from(TICK_US), u64::from(ramp.duration_us()));
}

#[test]
fn the_shortest_period_is_a_tick() {
    let mut bench = Bench::new();
    let still = GaitTable::from_fn(64, |_| [0.1, -0.1]).unwrap();
    bench.upload(&still);
    bench.done(ARM);
    assert_eq!(
        bench.refused(play(50, TICK_US - 1)),
        Refusal::BadValue { field: 1 }
    );
    bench.done(play(50, TICK_US));
    bench.until(StateName::Playing, 2 * SECOND);
    assert_eq!(bench.until(StateName::Stopping, 2 * SECOND), SECOND);
}

#[test]
fn a_swap_that_is_too_fast_leaves_the_old_gait_playing() {
    let mut bench = Bench::playing(&circle(1.0), play(0, 2_000_000));
    let reply = bench.commit(&circle(1.9));
    let Reply::Refused(Refusal::RateLimit { min_period_us, .. }) = reply else {
        panic!("{reply:?}")
    };
    assert!(
        (3_300_000..3_500_000).contains(&min_period_us),
        "{min_period_us}"
    );
    bench.run(5 * SECOND);
    let status = bench.status();
    assert_eq!(
        (status.state, status.table.unwrap().crc32),
        (StateName::Playing, circle(1.0).crc32())
    );
}

#[test]
fn a_table_that_waited_is_active_once_the_play_is_over() {
    for stop in [Request::Stop, Request::EStop] {
        let mut bench = Bench::playing(&circle(1.2), play(3, 5_000_000));
        bench.upload(&circle(0.5));
        bench.done(stop);
        let status = bench.status();
        assert_eq!(status.table.unwrap().crc32, circle(0.5).crc32());
        assert!(!status.flags.contains(Flags::SWAP_PENDING));
    }
}

#[test]
fn ticks_that_are_left_out_are_counted_each_gap_once() {
    let mut bench = Bench::new();
    let late = |bench: &Bench| bench.brain.counters().late_ticks;
    bench.run(SECOND);
    assert_eq!(late(&bench), 0);
    // A tick within its period is not late, and neither is a second call in the same period.
    bench.now_us += 9_000;
    bench.brain.tick(bench.now_us, &bench.inputs);
    bench.now_us += 11_000;
    bench.brain.tick(bench.now_us, &bench.inputs);
    assert_eq!(late(&bench), 0);
    for (gap, counted) in [(2, 1), (3, 2), (1, 2), (50, 3)] {
        bench.now_us += gap * u64::from(TICK_US);
        bench.brain.tick(bench.now_us, &bench.inputs);
        assert_eq!(late(&bench), counted, "after {gap} periods");
    }
}
