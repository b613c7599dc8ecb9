//! Promises R6 and R8 in virtual time: a stop is latched, and only a granted arm ends it.
use crate::bench;

use bench::stops::*;
use bench::*;
use gait_player::{Boot, BrainConfig};
use link_protocol::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[test]
fn r8_a_low_battery_stops_and_refuses_until_it_is_well() {
    for mut bench in powered() {
        bench.inputs.battery_mv = Some(4_399);
        bench.tick();
        assert!(bench.status().flags.contains(Flags::BATTERY_LOW));
        let took = until_stopping(&mut bench, 2 * SECOND);
        assert!((SECOND - 2 * TICK..=SECOND).contains(&took), "{took}");
        follow_stop(&mut bench, StopCause::BatteryLow);
        let refused = Refusal::BatteryLow {
            measured_mv: 4_399,
            limit_mv: 4_400,
        };
        assert_eq!(bench.refused(ARM), refused);
        bench.inputs.battery_mv = Some(4_400);
        bench.run(5 * SECOND - 2 * TICK);
        assert_eq!(
            bench.refused(ARM),
            Refusal::BatteryLow {
                measured_mv: 4_400,
                limit_mv: 4_400
            }
        );
        assert!(
            bench
                .run(4 * TICK)
                .iter()
                .all(|output| output.pulses_ns.is_none())
        );
        bench.done(ARM);
    }
}

/// A weak pack recovers between two strokes, so no single dip lasts a second.
#[test]
fn r8_a_pack_that_dips_on_every_stroke_stops_the_robot() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 20_000_000));
    let mut dips = 0;
    while bench.output.state == StateName::Playing {
        // Two dips of 100 ms per cycle, 10 s apart.
        bench.inputs.battery_mv = Some(4_399);
        bench.run(5 * TICK);
        bench.inputs.battery_mv = Some(5_000);
        bench.run(10 * SECOND - 5 * TICK);
        dips += 1;
        assert!(dips <= 10, "the dips do not add up");
    }
    println!("R8: a pack that dips for 100 ms on every stroke stops the robot at dip {dips}");
    assert_eq!((dips, bench.status().cause), (10, StopCause::BatteryLow));
    bench.done(ARM);
}

#[test]
fn r8_no_divider_is_never_low() {
    let mut bench = Bench::new();
    bench.inputs.battery_mv = None;
    bench.run(10 * SECOND);
    let status = bench.status();
    assert_eq!(
        (status.battery_mv, status.flags.contains(Flags::BATTERY_LOW)),
        (None, false)
    );
    bench.done(ARM);
}

/// Returns a brain after a reset with this stored word.
fn restarted(kept: u32, reset_reason: ResetReason) -> Bench {
    let boot = Boot {
        reset_reason,
        kept,
        ..Boot::power_on(2, 0x2000)
    };
    let mut bench = Bench::with(BrainConfig::robot(IDENTITY, boot));
    bench.greet(5);
    bench
}

#[test]
fn r6_a_reset_restarts_nothing_and_an_estop_survives_it() {
    for mut bench in powered() {
        bench.tick();
        for reason in [
            ResetReason::Watchdog,
            ResetReason::Crash,
            ResetReason::Pin,
            ResetReason::PowerOn,
        ] {
            let mut after = restarted(bench.output.kept, reason);
            assert_eq!(after.greet(6).reset_reason, reason);
            assert!(
                after
                    .run(2 * SECOND)
                    .iter()
                    .all(|output| output.pulses_ns.is_none())
            );
            assert_eq!(after.status().state, StateName::Stopped);
        }
        bench.done(Request::EStop);
        bench.tick();
        for reason in [ResetReason::Watchdog, ResetReason::Crash, ResetReason::Pin] {
            let mut after = restarted(bench.output.kept, reason);
            assert_eq!(after.status().state, StateName::EStopped);
            assert_eq!(after.refused(ARM), Refusal::EStopped);
            after.clear_estop();
            after.done(ARM);
            after.tick();
            assert_eq!(
                restarted(after.output.kept, reason).status().state,
                StateName::Stopped
            );
        }
        assert_eq!(
            restarted(bench.output.kept, ResetReason::PowerOn)
                .status()
                .state,
            StateName::Stopped
        );
    }
}

/// The shell stores the word before it sends the reply: a reset before the next tick does not lose an acknowledged e-stop.
#[test]
fn r6_an_estop_is_in_the_word_to_keep_before_its_answer_is_sent() {
    let mut bench = Bench::new();
    bench.done(ARM);
    bench.tick();
    assert_eq!(bench.brain.kept(), bench.output.kept);
    assert_eq!(
        bench.send_request(bench.sequence + 1, Request::EStop),
        Some(Reply::Done)
    );
    let mut after = restarted(bench.brain.kept(), ResetReason::Watchdog);
    assert_eq!(after.status().state, StateName::EStopped);
}

#[test]
fn r8_three_resets_in_a_minute_refuse_arming_until_cleared() {
    let mut kept = Bench::new().output.kept;
    for _ in 0..3 {
        let mut bench = restarted(kept, ResetReason::Watchdog);
        bench.run(10 * SECOND);
        kept = bench.output.kept;
    }
    let mut bench = restarted(kept, ResetReason::Pin);
    let flags = bench.status().flags;
    assert!(flags.contains(Flags::RESET_LOOP) && !flags.contains(Flags::SHORT_STARTS));
    assert!(matches!(
        bench.refused(ARM),
        Refusal::ResetLoop { wait_s: 60 }
    ));
    bench.run(30 * SECOND);
    assert!(matches!(
        bench.refused(Request::ClearResets),
        Refusal::ResetLoop { wait_s: 30 }
    ));
    bench.run(30 * SECOND);
    // Time alone does not clear it.
    assert_eq!(bench.refused(ARM), Refusal::ResetLoop { wait_s: 0 });
    bench.done(Request::ClearResets);
    bench.done(ARM);
}

/// Sends a random event other than an arm.
fn disturb(bench: &mut Bench, random: &mut ChaCha8Rng) {
    let requests = [
        play(0, 5_000_000),
        Request::Play(Play {
            cycles: 2,
            period_us: 5_000_000,
            detached: true,
            checked: AS_HELD,
        }),
        Request::Pause { detached: false },
        Request::Pause { detached: true },
        Request::Resume,
        Request::Stop,
        Request::Status,
        Request::ClearResets,
        Request::Trim {
            joint: Joint::Front,
            trim: 100,
        },
        Request::Commit { upload: 3 },
    ];
    match random.random_range(0..16) {
        0 => drop(bench.greet(random.random())),
        1 => bench.keep_alive = random.random(),
        2 => bench.inputs.battery_mv = [None, Some(4_000), Some(5_000)][random.random_range(0..3)],
        3 => bench.inputs.link_up = true,
        4 => bench.now_us += random.random_range(0..SECOND),
        5 => drop(bench.ask(Request::EStop)),
        6 => bench.upload_if_it_can(&circle(f64::from(random.random_range(1..15_u8)) / 10.0)),
        _ => drop(bench.ask(requests[random.random_range(0..requests.len())].clone())),
    }
}

impl Bench {
    fn upload_if_it_can(&mut self, table: &gait_player::GaitTable) {
        let len = u16::try_from(table.bytes().len()).unwrap();
        let begin = Request::Begin(Begin {
            slot: 0,
            len,
            crc32: table.crc32(),
        });
        if matches!(self.ask(begin), Reply::Wanted { .. }) {
            drop(self.commit(table));
        }
    }
}

#[test]
fn r6_no_path_from_a_latched_stop_to_motion_without_an_arm() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut stops = [0; 2];
    for run in 0..300 {
        let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
        // Enters a latched stop in a random way.
        for _ in 0..random.random_range(0..6) {
            disturb(&mut bench, &mut random);
            bench.tick();
        }
        bench.done(if run % 2 == 0 {
            Request::Stop
        } else {
            Request::EStop
        });
        bench.run(3 * SECOND);
        let stopped = bench.output.state;
        assert!(
            matches!(stopped, StateName::Stopped | StateName::EStopped),
            "{stopped:?}"
        );
        stops[usize::from(stopped == StateName::EStopped)] += 1;
        // Nothing but an arm leaves it.
        for _ in 0..40 {
            disturb(&mut bench, &mut random);
            let ticks = random.random_range(1..30);
            for output in bench.run(ticks * TICK) {
                assert_eq!(output.pulses_ns, None);
                assert!(matches!(
                    output.state,
                    StateName::Stopped | StateName::EStopped
                ));
                assert!(stopped != StateName::EStopped || output.state == StateName::EStopped);
            }
        }
        bench.inputs.battery_mv = Some(5_000);
        bench.keep_alive = true;
        bench.run(6 * SECOND);
        if bench.output.state == StateName::EStopped {
            bench.clear_estop();
        }
        bench.done(ARM);
        assert!(bench.tick().pulses_ns.is_some());
    }
    println!(
        "R6: {} stops and {} e-stops, 40 events each, no motion without an arm",
        stops[0], stops[1]
    );
}
