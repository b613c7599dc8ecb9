//! Sequences of plays without a pause, each with its own table, cycles and period.
#![allow(clippy::float_cmp)] // set-points are compared to the last bit
use crate::bench;

use bench::*;
use gait_player::storage::MemoryStorage;
use gait_player::{Brain, GaitTable, TICK_US};
use link_protocol::*;

/// Circles that start at the common point (0.3, −0.2).
fn from_common(radius: f64, knots: usize) -> GaitTable {
    GaitTable::from_fn(knots, |u| {
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        [0.3 - radius * (1.0 - cos), -0.2 + radius * sin]
    })
    .unwrap()
}

fn follow(bench: &mut Bench, table: &GaitTable, cycles: u32, period_us: u32) -> Reply {
    let upload = bench.send_table(table);
    bench.ask(Request::Follow(Follow {
        upload,
        cycles,
        period_us,
        checked: AS_HELD,
    }))
}

/// Set-point of a table at a time.
fn at(table: &GaitTable, elapsed_us: u64, period_us: u32) -> [f32; 2] {
    let in_cycle = u32::try_from(elapsed_us % u64::from(period_us)).unwrap();
    table.at(table.phase(in_cycle, period_us)).angles
}

#[test]
fn three_plays_are_one_motion() {
    let tables = [(0.9, 512), (0.4, 200), (0.7, 128)].map(|(r, n)| from_common(r, n));
    // The second period is not a multiple of a tick; the remainder belongs to the third play.
    let plays = [(2, 6_000_000), (3, 3_333_333), (1, 4_000_000)];
    let mut bench = Bench::playing(&tables[0], play(plays[0].0, plays[0].1));
    let mut next = 1;
    let mut told = Vec::new();
    while bench.tick().state == StateName::Playing {
        let status = bench.status();
        told.push((status.cycles, status.period_us));
        // As a host does: the next table is sent as soon as the staging table is free.
        if next < 3 && !status.flags.contains(Flags::SWAP_PENDING) {
            let before = bench.now_us;
            let upload = bench.send_table(&tables[next]);
            let reply = bench.ask(Request::Follow(Follow {
                upload,
                cycles: plays[next].0,
                period_us: plays[next].1,
                checked: AS_HELD,
            }));
            assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
            println!(
                "{} knots: {} ms from Begin to the answer",
                tables[next].knots(),
                (bench.now_us - before) / 1000
            );
            next += 1;
        }
    }
    assert_eq!(next, 3);
    told.dedup();
    assert_eq!(told, plays);
    assert_eq!(bench.status().cause, StopCause::Finished);
}

/// Every set-point equals that of the concatenated tables.
#[test]
fn no_tick_is_lost_and_none_is_played_twice() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    let mut bench = Bench::playing(&first, play(2, 4_010_000));
    let start = bench.now_us;
    let reply = follow(&mut bench, &second, 3, 2_000_000);
    assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
    let over = 2 * 4_010_000;
    let mut compared = 0;
    loop {
        bench.tick();
        if bench.output.state != StateName::Playing {
            break;
        }
        let elapsed = bench.now_us - start;
        let expected = if elapsed < over {
            at(&first, elapsed, 4_010_000)
        } else {
            at(&second, elapsed - over, 2_000_000)
        };
        assert_eq!(bench.output.setpoint, expected, "{elapsed}");
        compared += 1;
    }
    assert!(compared > 600, "{compared}");
    let ends = (over + 3 * 2_000_000).next_multiple_of(u64::from(TICK_US));
    assert_eq!(bench.now_us - start, ends);
    assert_eq!(bench.output.setpoint, second.knot_angles(0));
}

/// A follower ends an endless play, and may be endless itself.
#[test]
fn a_play_without_end_is_followed_at_the_end_of_its_cycle() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    let mut bench = Bench::playing(&first, play(0, 5_000_000));
    let start = bench.now_us;
    bench.run(6 * SECOND);
    let reply = follow(&mut bench, &second, 0, 3_000_000);
    assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
    while bench.status().flags.contains(Flags::SWAP_PENDING) {
        bench.tick();
    }
    assert!((10 * SECOND..11 * SECOND).contains(&(bench.now_us - start)));
    bench.run(20 * SECOND);
    let status = bench.status();
    assert_eq!(
        (status.state, status.cycles, status.period_us),
        (StateName::Playing, 0, 3_000_000)
    );
}

#[test]
fn what_cannot_follow_is_refused_and_the_play_goes_on() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    let mut bench = Bench::playing(&first, play(20, 5_000_000));
    let apart = GaitTable::from_fn(128, |u| {
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        [0.3 - 0.4 * (1.0 - cos), -0.19 + 0.4 * sin]
    })
    .unwrap();
    let refused = |reply: Reply| match reply {
        Reply::Refused(refusal) => refusal,
        reply => panic!("{reply:?}"),
    };
    assert_eq!(
        refused(follow(&mut bench, &apart, 1, 3_000_000)),
        Refusal::NotJoined {
            joint: Joint::Back,
            step: 100
        }
    );
    assert!(matches!(
        refused(follow(&mut bench, &second, 1, 200_000)),
        Refusal::RateLimit { .. }
    ));
    assert_eq!(
        refused(follow(&mut bench, &second, 1, TICK_US - 1)),
        Refusal::BadValue { field: 2 }
    );
    let status = bench.status();
    assert_eq!(
        (status.state, status.cycles, status.table.unwrap().crc32),
        (StateName::Playing, 20, first.crc32())
    );
    // The follower of a detached play must have an end.
    let mut detached = Bench::playing(
        &first,
        Request::Play(Play {
            cycles: 20,
            period_us: 5_000_000,
            detached: true,
            checked: AS_HELD,
        }),
    );
    assert_eq!(
        refused(follow(&mut detached, &second, 0, 3_000_000)),
        Refusal::DetachedTooLong
    );
}

/// A late follower is refused, and the robot rests where the last play ended.
#[test]
fn a_follower_that_comes_too_late_does_not_move_the_robot() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 512));
    let mut bench = Bench::playing(&first, play(1, 5_000_000));
    bench.run(4 * SECOND + SECOND / 2);
    let reply = follow(&mut bench, &second, 3, 3_000_000);
    assert!(
        matches!(
            reply,
            Reply::Refused(Refusal::WrongState(
                StateName::Stopping | StateName::Settling | StateName::Stopped
            ))
        ),
        "{reply:?}"
    );
    bench.until(StateName::Stopped, 2 * SECOND);
    bench.run(10 * SECOND);
    assert_eq!(bench.output.state, StateName::Stopped);
    assert_eq!(bench.status().cause, StopCause::Finished);
}

/// A stop cancels the follower.
#[test]
fn a_stop_ends_what_waits_to_follow() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    let mut bench = Bench::playing(&first, play(5, 5_000_000));
    let reply = follow(&mut bench, &second, 3, 3_000_000);
    assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, 2 * SECOND);
    bench.run(10 * SECOND);
    assert_eq!(bench.output.state, StateName::Stopped);
}

/// A cancelled follower becomes neither the active nor the stored table.
#[test]
fn a_stop_leaves_the_table_that_was_played() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    for stop in [Request::Stop, Request::EStop] {
        let mut flash = MemoryStorage::erased();
        let mut bench = Bench::playing(&first, play(5, 5_000_000));
        let reply = follow(&mut bench, &second, 3, 3_000_000);
        assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
        bench.done(stop);
        bench.run(3 * SECOND);
        let status = bench.status();
        assert_eq!(status.table.unwrap().crc32, first.crc32());
        assert!(!status.flags.contains(Flags::SWAP_PENDING));
        bench.clear_estop();
        while bench.tick().storage_wanted {
            bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
        }
        let mut brain = Brain::new(config());
        brain.load(&mut flash).unwrap();
        let mut restarted = Bench::around(brain);
        restarted.greet(2);
        assert_eq!(restarted.status().table.unwrap().crc32, first.crc32());
    }
}

/// No chain of detached plays moves a robot for more than an hour without a host.
#[test]
fn a_detached_play_and_its_follower_last_an_hour_at_most() {
    let (first, second) = (from_common(0.9, 128), from_common(0.4, 128));
    let detached = |cycles, period_us| {
        Request::Play(Play {
            cycles,
            period_us,
            detached: true,
            checked: AS_HELD,
        })
    };
    let mut bench = Bench::new();
    bench.upload(&first);
    bench.done(ARM);
    for (cycles, period_us) in [
        (0, 5_000_000),
        (u32::MAX, 5_000_000),
        (u32::MAX, u32::MAX),
        (721, 5_000_000),
    ] {
        let refused = bench.refused(detached(cycles, period_us));
        assert_eq!(refused, Refusal::DetachedTooLong, "{cycles} {period_us}");
    }
    bench.done(detached(720, 5_000_000));
    bench.until(StateName::Playing, 3 * SECOND);
    // One hour is scheduled already; after ten minutes there is time for ten more.
    let too_long = Reply::Refused(Refusal::DetachedTooLong);
    assert_eq!(follow(&mut bench, &second, 1, 5_000_000), too_long);
    bench.run(600 * SECOND);
    assert_eq!(follow(&mut bench, &second, 125, 5_000_000), too_long);
    let reply = follow(&mut bench, &second, 119, 5_000_000);
    assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
    // An attended play may be endless.
    let mut attended = Bench::playing(&first, play(0, 5_000_000));
    attended.run(SECOND);
    assert_eq!(attended.output.state, StateName::Playing);
}

/// Promise R17: the follower must be the table, with the settings, that its host checked.
#[test]
fn a_follower_other_than_the_checked_one_is_refused() {
    let (first, second) = (from_common(0.9, 256), from_common(0.4, 128));
    let mut bench = Bench::playing(&first, play(20, 5_000_000));
    let upload = bench.send_table(&second);
    let held = Checked {
        table_crc32: second.crc32(),
        ..bench.brain.held()
    };
    let ask = |checked| {
        Request::Follow(Follow {
            upload,
            cycles: 1,
            period_us: 3_000_000,
            checked,
        })
    };
    let table = Checked {
        table_crc32: first.crc32(),
        ..held
    };
    let other = Refusal::OtherTable {
        held: second.crc32(),
    };
    assert_eq!(bench.refused(ask(table)), other);
    let settings = Checked {
        settings_crc32: held.settings_crc32 ^ 1,
        ..held
    };
    let other = Refusal::OtherSettings {
        held: held.settings_crc32,
    };
    assert_eq!(bench.refused(ask(settings)), other);
    assert!(matches!(bench.ask(ask(held)), Reply::Table(Some(_))));
}
