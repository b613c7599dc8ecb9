//! Presence: the settings that require a person at the robot, and the ways to prove presence.
use crate::bench;

use bench::*;
use gait_player::{Brain, GaitTable, Limits, ShortStarts, Transport};
use link_protocol::*;

const KEY: Key = Key(*b"not a secret key");

fn at(via: Transport) -> Bench {
    let mut bench = Bench::with(config());
    bench.via = via;
    bench.greet(1);
    bench
}

fn configured(change: impl Fn(&mut Configuration)) -> Request {
    let mut wanted = config().configuration;
    change(&mut wanted);
    Request::Configure(wanted)
}

/// `square:2.3`: at its corners the side links of the robot cross.
fn square() -> GaitTable {
    GaitTable::from_fn(64, |u| {
        let side =
            |u: f64| 2.3 * (4.0 * (u.rem_euclid(1.0) - 0.5).abs() - 1.0).clamp(-0.5, 0.5) * 2.0;
        [side(u), side(u + 0.25)]
    })
    .unwrap()
}

#[test]
fn the_crossing_check_cannot_be_talked_away_from_across_the_room() {
    let far = || configured(|wanted| wanted.middle_m = 9.0);
    let crosses = |reply| matches!(reply, Reply::Refused(Refusal::LinksCross { .. }));
    let mut bench = at(Transport::Uart);
    assert!(crosses(bench.commit(&square())));
    assert_eq!(bench.refused(far()), Refusal::NeedsPresence);
    assert!(crosses(bench.commit(&square())));
    // With presence it is allowed: an owner may build a robot with nine metres between the joints.
    bench.come_near();
    bench.done(far());
    assert!(matches!(bench.commit(&square()), Reply::Table(Some(_))));
    let mut bench = at(Transport::Usb);
    bench.done(far());
}

#[test]
fn a_tenth_of_a_length_is_anybodys_and_what_holds_is_no_change() {
    let mut bench = at(Transport::Uart);
    let lengths: [fn(&mut Configuration) -> &mut f32; 3] =
        [|c| &mut c.middle_m, |c| &mut c.front_m, |c| &mut c.back_m];
    for length in lengths {
        for share in [0.901, 1.0, 1.099] {
            bench.done(configured(|wanted| *length(wanted) *= share));
        }
        for share in [0.5, 0.899, 1.101, 2.0] {
            let wanted = configured(|wanted| *length(wanted) *= share);
            assert_eq!(bench.refused(wanted), Refusal::NeedsPresence, "{share}");
        }
    }
    // Drag affects only the estimated pose.
    bench.done(configured(|wanted| wanted.chi = 2.0));
    bench.come_near();
    bench.done(configured(|wanted| wanted.front_m *= 1.5));
    bench.run(121 * SECOND);
    bench.done(configured(|wanted| {
        (wanted.front_m, wanted.chi) = (wanted.front_m * 1.5, 3.0);
    }));
    let wanted = configured(|wanted| wanted.front_m *= 1.6);
    assert_eq!(bench.refused(wanted), Refusal::NeedsPresence);
}

#[test]
fn limits_beyond_those_as_built_need_presence_and_never_pass_the_firmwares() {
    let mut config = config();
    config.configuration.max_angle = 1.5;
    let mut bench = Bench::with(config.clone());
    bench.greet(1);
    let with = |max_angle| {
        Request::Configure(Configuration {
            max_angle,
            ..config.configuration
        })
    };
    bench.done(with(1.0));
    bench.done(with(1.5));
    assert_eq!(bench.refused(with(1.6)), Refusal::NeedsPresence);
    bench.come_near();
    bench.done(with(1.6));
    let beyond = with(Limits::ROBOT.max_angle * 1.01);
    assert_eq!(bench.refused(beyond), Refusal::BadValue { field: 6 });
}

#[test]
fn a_first_key_needs_presence_and_the_window_is_two_minutes_long() {
    let mut bench = at(Transport::Uart);
    bench.done(Request::SetKey(None));
    bench.greet(2);
    assert_eq!(
        bench.refused(Request::SetKey(Some(KEY))),
        Refusal::NeedsPresence
    );
    let flags = |bench: &mut Bench| bench.status().flags.contains(Flags::PRESENT);
    assert!(!flags(&mut bench));
    // The jumper closes and is forgotten there.
    bench.inputs.present = true;
    bench.run(SECOND);
    let Reply::Bench(told) = bench.ask(Request::Bench) else {
        panic!()
    };
    assert_eq!(
        (told.window_s, told.usb, told.short_starts),
        (120, false, 1)
    );
    assert_eq!(told.built, config().configuration);
    assert!(flags(&mut bench));
    let lit = bench
        .run(10 * SECOND)
        .iter()
        .filter(|output| output.led)
        .count();
    assert!((440..=460).contains(&lit), "{lit} of 500");
    bench.run(110 * SECOND);
    assert!(!flags(&mut bench));
    assert_eq!(
        bench.refused(Request::SetKey(Some(KEY))),
        Refusal::NeedsPresence
    );
    let mut bench = at(Transport::Usb);
    assert!(flags(&mut bench));
    bench.done(Request::SetKey(Some(KEY)));
}

#[test]
fn the_boot_loader_is_entered_only_stopped_and_with_presence_and_after_the_answer() {
    let mut bench = at(Transport::Uart);
    assert_eq!(
        bench.refused(Request::EnterBootLoader),
        Refusal::NeedsPresence
    );
    bench.come_near();
    bench.done(ARM);
    bench.tick();
    assert_eq!(
        bench.refused(Request::EnterBootLoader),
        Refusal::WrongState(StateName::Holding)
    );
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, SECOND);
    assert!(!bench.output.boot_loader);
    bench.done(Request::EnterBootLoader);
    // Not before the reply is sent and everything is stored, including the cleared count of starts.
    assert!(bench.run(SECOND).iter().all(|output| !output.boot_loader));
    let mut flash = gait_player::storage::MemoryStorage::erased();
    bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    assert!(bench.tick().boot_loader);
    assert_eq!(flash.starts, Some(ShortStarts { runs: 0 }.encode()));
    // An arm cancels the jump.
    bench.done(ARM);
    assert!(!bench.tick().boot_loader);
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, SECOND);
    assert!(bench.run(SECOND).iter().all(|output| !output.boot_loader));
}

#[test]
fn an_estop_is_cleared_without_arming() {
    let mut bench = at(Transport::Uart);
    bench.done(Request::EStop);
    bench.tick();
    let stale = Header::new(bench.session.wrapping_sub(1), 9);
    let clear = |count| Request::ClearEStop { count };
    bench.send(stale, &Message::Request(clear(1)));
    assert_eq!(bench.tick().state, StateName::EStopped);
    assert_eq!(bench.refused(ARM), Refusal::EStopped);
    bench.done(clear(1));
    assert_eq!(bench.tick().state, StateName::Stopped);
    assert_eq!(bench.output.kept & 1, 0);
    bench.done(clear(1));
    bench.done(ARM);
    assert_eq!(
        bench.refused(clear(1)),
        Refusal::WrongState(StateName::Holding)
    );
}

/// A clear that was sent before another e-stop does not clear that one, and a clear of a silent host has no effect.
#[test]
fn a_clear_names_the_estops_that_it_clears() {
    let mut bench = at(Transport::Uart);
    bench.done(Request::EStop);
    assert_eq!(bench.status().estops, 1);
    bench.done(Request::EStop);
    let clear = |count| Request::ClearEStop { count };
    assert_eq!(bench.refused(clear(1)), Refusal::EStopCount { count: 2 });
    assert_eq!(bench.tick().state, StateName::EStopped);
    bench.keep_alive = false;
    bench.run(10 * SECOND);
    assert_eq!(bench.refused(clear(2)), Refusal::NotFresh);
    assert_eq!(bench.tick().state, StateName::EStopped);
    bench.beat();
    bench.done(clear(2));
    assert_eq!(bench.tick().state, StateName::Stopped);
}

/// Attack: the shape (2.1, 2.1), at which links cross, written as (2.1, −2.1) for a reversed servo.
#[test]
fn the_direction_of_a_servo_is_set_at_the_robot() {
    let mut bench = at(Transport::Uart);
    let reversed = Request::SetServo {
        joint: Joint::Back,
        settings: ServoSettings {
            reversed: true,
            ..config().servos[1]
        },
    };
    assert_eq!(bench.refused(reversed.clone()), Refusal::NeedsPresence);
    bench.come_near();
    bench.done(reversed.clone());
    // Repeating the present value requires no presence; reverting it does.
    bench.run(121 * SECOND);
    bench.done(reversed);
    let back = Request::SetServo {
        joint: Joint::Back,
        settings: config().servos[1],
    };
    assert_eq!(bench.refused(back), Refusal::NeedsPresence);
}

/// Attack: 20 µs of centre and half a radian of trim move a joint by 1.05 rad, beyond π at a command of 2.8 rad.
#[test]
fn centre_and_trim_move_a_joint_by_a_degree_without_presence() {
    let degree = 1_f32.to_radians();
    for steps in [
        [20_000, 5_000],
        [-20_000, -5_000],
        [20_000, 0],
        [0, 5_000],
        [300, 100],
    ] {
        let mut bench = at(Transport::Uart);
        let [centre, trim] = steps;
        let built = config().servos[1];
        let settings = ServoSettings {
            centre_ns: built.centre_ns.saturating_add_signed(centre),
            ..built
        };
        // In small steps: each is measured from the bench value, not from the previous step.
        for share in 1..=20 {
            let settings = ServoSettings {
                centre_ns: built.centre_ns.saturating_add_signed(centre * share / 20),
                ..settings
            };
            let joint = Joint::Back;
            bench.ask(Request::SetServo { joint, settings });
            let trim = i16::try_from(trim * share / 20).unwrap();
            bench.ask(Request::Trim { joint, trim });
            let Reply::Servo(held) = bench.ask(Request::Servo(joint)) else {
                panic!()
            };
            let map = gait_player::servo::ServoMap::from(held);
            let moved = gait_player::servo::ServoMap::ROBOT.angle(map.pulse_ns(0.0));
            assert!(moved.abs() <= degree + 1e-4, "{steps:?}: {moved} rad");
        }
        // With presence the whole change is accepted, and later steps are measured from it.
        bench.come_near();
        let joint = Joint::Back;
        bench.done(Request::SetServo { joint, settings });
        let trim = i16::try_from(trim).unwrap();
        bench.done(Request::Trim { joint, trim });
        bench.run(121 * SECOND);
        bench.done(Request::Trim {
            joint,
            trim: trim - trim.signum() * 170,
        });
    }
}

/// After a restart too, changes are measured from the maps set with presence.
#[test]
fn the_bench_is_remembered_over_a_restart() {
    let mut flash = gait_player::storage::MemoryStorage::erased();
    let mut bench = at(Transport::Usb);
    let trim = |trim| Request::Trim {
        joint: Joint::Front,
        trim,
    };
    bench.done(trim(1_000));
    while bench.tick().storage_wanted {
        bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    }
    let mut brain = Brain::new(config());
    brain.load(&mut flash).unwrap();
    let mut bench = Bench::around(brain);
    bench.greet(2);
    bench.done(trim(1_170));
    bench.done(trim(830));
    assert_eq!(bench.refused(trim(1_180)), Refusal::NeedsPresence);
    assert_eq!(bench.refused(trim(0)), Refusal::NeedsPresence);
}

/// Settings of a silent host have no effect, nor has a clear of the reset latch.
#[test]
fn settings_of_a_silent_host_do_nothing() {
    let mut bench = at(Transport::Usb);
    bench.keep_alive = false;
    bench.run(10 * SECOND);
    let servo = config().servos[0];
    for request in [
        configured(|wanted| wanted.chi = 2.0),
        Request::SetServo {
            joint: Joint::Front,
            settings: ServoSettings { trim: 9, ..servo },
        },
        Request::Trim {
            joint: Joint::Front,
            trim: 9,
        },
        Request::SetPulseRange {
            joint: Joint::Front,
            range: PulseRange {
                shortest_ns: 1_400_000,
                longest_ns: 1_600_000,
            },
        },
        Request::SetKey(Some(KEY)),
        Request::ClearResets,
        Request::EnterBootLoader,
    ] {
        assert_eq!(bench.refused(request), Refusal::NotFresh);
    }
    assert_eq!(bench.ask(Request::Servo(Joint::Front)), Reply::Servo(servo));
}

#[test]
fn a_servos_end_stops_bound_its_pulses_and_the_gaits() {
    let mut bench = at(Transport::Uart);
    bench.come_near();
    bench.upload(&circle(2.0));
    let map = gait_player::servo::ServoMap::ROBOT;
    let range = |reach: f32| PulseRange {
        shortest_ns: map.pulse_ns(-reach),
        longest_ns: map.pulse_ns(reach),
    };
    let set = |joint, range| Request::SetPulseRange { joint, range };
    let whole = PulseRange {
        shortest_ns: Limits::ROBOT.pulse_min_ns,
        longest_ns: Limits::ROBOT.pulse_max_ns,
    };
    assert_eq!(
        bench.ask(Request::PulseRange(Joint::Back)),
        Reply::PulseRange(whole)
    );
    for bad in [
        PulseRange {
            shortest_ns: whole.shortest_ns - 1,
            ..whole
        },
        PulseRange {
            longest_ns: whole.longest_ns + 1,
            ..whole
        },
        PulseRange {
            shortest_ns: map.pulse_ns(0.1),
            ..whole
        },
        PulseRange {
            longest_ns: map.pulse_ns(-0.1),
            ..whole
        },
        range(0.001),
    ] {
        assert!(
            matches!(
                bench.refused(set(Joint::Back, bad)),
                Refusal::BadValue { .. }
            ),
            "{bad:?}"
        );
    }
    bench.done(set(Joint::Back, range(1.5)));
    assert_eq!(
        bench.ask(Request::PulseRange(Joint::Back)),
        Reply::PulseRange(range(1.5))
    );
    assert_eq!(
        bench.ask(Request::PulseRange(Joint::Front)),
        Reply::PulseRange(whole)
    );
    bench.done(ARM);
    assert!(matches!(
        bench.refused(play(1, 8_000_000)),
        Refusal::AngleLimit { .. }
    ));
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, SECOND);
    // The range is stored, and only another range request changes it.
    let mut flash = gait_player::storage::MemoryStorage::erased();
    for _ in 0..20 {
        bench.tick();
        bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    }
    let mut brain = Brain::new(config());
    brain.load(&mut flash).unwrap();
    let mut bench = Bench::around(brain);
    bench.greet(2);
    assert_eq!(
        bench.ask(Request::PulseRange(Joint::Back)),
        Reply::PulseRange(range(1.5))
    );
    assert_eq!(
        bench.refused(set(Joint::Back, range(1.6))),
        Refusal::NeedsPresence
    );
    bench.done(set(Joint::Back, range(1.4)));
    assert_eq!(
        bench.refused(set(Joint::Back, range(1.5))),
        Refusal::NeedsPresence
    );
    bench.come_near();
    bench.done(set(Joint::Back, whole));
    bench.done(ARM);
    bench.done(play(1, 8_000_000));
}

/// A supply that collapses under the servos looks like a switch to the chip; only a counter reveals it (promise R8).
#[test]
fn r8_three_short_runs_lock_arming_whether_power_was_off_or_not() {
    for power_off in [true, false] {
        let mut flash = gait_player::storage::MemoryStorage::erased();
        let mut ram = None;
        let start = |flash: &mut _, ram: Option<ShortStarts>| {
            let mut config = config();
            config.boot.starts = ram.filter(|_| !power_off);
            let mut brain = Brain::new(config);
            brain.load(flash).unwrap();
            let mut bench = Bench::around(brain);
            bench.greet(1);
            bench
        };
        for run in 1..=3 {
            let mut bench = start(&mut flash, ram);
            bench.done(ARM);
            bench.run(10 * SECOND);
            assert_eq!(bench.output.starts, ShortStarts { runs: run });
            ram = Some(bench.output.starts);
        }
        let mut bench = start(&mut flash, ram);
        assert_eq!(bench.refused(ARM), Refusal::ResetLoop { wait_s: 60 });
        let flags = bench.status().flags;
        assert!(flags.contains(Flags::RESET_LOOP) && flags.contains(Flags::SHORT_STARTS));
        let Reply::CrashMessage(message) = bench.ask(Request::CrashMessage) else {
            panic!()
        };
        assert!(
            message.contains("weak supply") && message.contains("plug-ins"),
            "{message}"
        );
        // Three blinks of 100 ms every two seconds.
        let led: Vec<bool> = bench
            .run(20 * SECOND)
            .iter()
            .map(|output| output.led)
            .collect();
        let blinks = led.windows(2).filter(|pair| !pair[0] && pair[1]).count();
        assert!((29..=31).contains(&blinks), "{blinks}");
        let lit = led.iter().filter(|led| **led).count();
        assert_eq!(lit, 10 * 3 * 5, "ticks that the LED was on");
        bench.run(41 * SECOND);
        assert_eq!(bench.output.starts, ShortStarts { runs: 0 });
        assert_eq!(bench.refused(ARM), Refusal::ResetLoop { wait_s: 0 });
        bench.done(Request::ClearResets);
        bench.done(ARM);
        // Stored once stopped, so that the next start follows a run of full length.
        assert!(!bench.tick().storage_wanted);
        bench.done(Request::Stop);
        bench.until(StateName::Stopped, SECOND);
        assert!(bench.tick().storage_wanted);
        bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
        assert!(!bench.tick().storage_wanted);
        assert_eq!(
            start(&mut flash, Some(bench.output.starts))
                .tick()
                .starts
                .runs,
            1
        );
    }
}
