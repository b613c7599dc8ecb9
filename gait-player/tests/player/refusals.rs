//! Refusals of the brain and their numbers. A refusal changes nothing: plays, uploads, tables, configurations, trims.
#![allow(clippy::float_cmp)] // limits are compared to the last bit
use crate::bench;

use bench::*;
use gait_player::servo::ServoMap;
use gait_player::{GaitTable, Limits};
use link_protocol::*;

#[test]
fn every_refusal_of_a_play() {
    let mut bench = Bench::new();
    assert_eq!(bench.refused(play(1, 5_000_000)), Refusal::NotArmed);
    bench.done(ARM);
    assert_eq!(bench.refused(play(1, 5_000_000)), Refusal::NoTable);
    assert_eq!(
        bench.refused(play(1, 19_999)),
        Refusal::BadValue { field: 1 }
    );
    bench.upload(&circle(1.2));
    let endless = Request::Play(Play {
        cycles: 0,
        period_us: 5_000_000,
        detached: true,
        checked: AS_HELD,
    });
    assert_eq!(bench.refused(endless), Refusal::DetachedTooLong);
    assert!(matches!(
        bench.refused(play(1, 2_000_000)),
        Refusal::RateLimit { .. }
    ));
    // Promise R17: the robot plays only the table, with the settings, that its host checked.
    let held = bench.brain.held();
    let checked = |checked| {
        Request::Play(Play {
            cycles: 1,
            period_us: 5_000_000,
            detached: false,
            checked,
        })
    };
    assert_eq!(
        bench.refused(checked(Checked {
            table_crc32: !held.table_crc32,
            ..held
        })),
        Refusal::OtherTable {
            held: held.table_crc32
        }
    );
    let settings = Checked {
        settings_crc32: !held.settings_crc32,
        ..held
    };
    assert_eq!(
        bench.refused(checked(settings)),
        Refusal::OtherSettings {
            held: held.settings_crc32
        }
    );
    assert_eq!(bench.output.state, StateName::Holding);
    // Another program sets a trim between check and play.
    bench.done(Request::Trim {
        joint: Joint::Back,
        trim: 1,
    });
    assert!(matches!(
        bench.refused(checked(held)),
        Refusal::OtherSettings { .. }
    ));
    bench.done(play(1, 5_000_000));
    assert_eq!(
        bench.refused(play(1, 5_000_000)),
        Refusal::WrongState(StateName::Starting)
    );
    assert_eq!(
        bench.refused(Request::Pause { detached: false }),
        Refusal::WrongState(StateName::Starting)
    );
    assert_eq!(bench.refused(ARM), Refusal::WrongState(StateName::Starting));
    assert_eq!(
        bench.refused(Request::Trim {
            joint: Joint::Front,
            trim: 1
        }),
        Refusal::WrongState(StateName::Starting)
    );
}

#[test]
fn every_refusal_of_an_upload() {
    let mut bench = Bench::new();
    let begin = |slot, len| {
        Request::Begin(Begin {
            slot,
            len,
            crc32: 1,
        })
    };
    assert_eq!(bench.refused(begin(1, 8)), Refusal::NoSuchSlot(1));
    for len in [0, 4, 9, 2052] {
        assert_eq!(bench.refused(begin(0, len)), Refusal::BadLength(len));
    }
    let chunk = |upload, offset, len: usize| {
        let data = heapless::Vec::from_slice(&vec![0; len]).unwrap();
        Request::Chunk(Chunk {
            upload,
            offset,
            data,
        })
    };
    assert_eq!(bench.refused(chunk(9, 0, 4)), Refusal::NoUpload);
    assert_eq!(
        bench.refused(Request::Commit { upload: 9 }),
        Refusal::NoUpload
    );
    let Reply::Wanted { upload, offset: 0 } = bench.ask(begin(0, 16)) else {
        panic!()
    };
    assert_eq!(
        bench.refused(chunk(upload, 8, 9)),
        Refusal::ChunkOutOfRange { wanted: 0 }
    );
    // A chunk after a gap gets the expected offset; of an overlapping chunk only the new bytes count.
    assert_eq!(
        bench.ask(chunk(upload, 8, 8)),
        Reply::Wanted { upload, offset: 0 }
    );
    assert_eq!(
        bench.ask(chunk(upload, 0, 8)),
        Reply::Wanted { upload, offset: 8 }
    );
    assert_eq!(
        bench.ask(chunk(upload, 0, 4)),
        Reply::Wanted { upload, offset: 8 }
    );
    assert_eq!(
        bench.ask(chunk(upload, 4, 6)),
        Reply::Wanted { upload, offset: 10 }
    );
    assert_eq!(
        bench.refused(Request::Commit { upload }),
        Refusal::Incomplete { wanted: 10 }
    );
    assert_eq!(bench.status().upload, Some(10));
    // Another session resumes by length and checksum, under a new number.
    bench.greet(2);
    bench.sequence = 500;
    assert_eq!(
        bench.ask(begin(0, 16)),
        Reply::Wanted {
            upload: 501,
            offset: 10
        }
    );
    assert_eq!(bench.refused(chunk(upload, 10, 6)), Refusal::NoUpload);
    assert_eq!(
        bench.ask(chunk(501, 10, 6)),
        Reply::Wanted {
            upload: 501,
            offset: 16
        }
    );
    let refusal = bench.refused(Request::Commit { upload: 501 });
    assert!(
        matches!(refusal, Refusal::CrcMismatch { expected: 1, .. }),
        "{refusal:?}"
    );
    assert_eq!(
        bench.refused(Request::Commit { upload: 501 }),
        Refusal::NoUpload
    );
}

#[test]
fn an_upload_of_another_table_begins_at_its_first_byte() {
    let mut bench = Bench::new();
    let begin = |len, crc32| {
        Request::Begin(Begin {
            slot: 0,
            len,
            crc32,
        })
    };
    let from = |bench: &mut Bench, len, crc32| match bench.ask(begin(len, crc32)) {
        Reply::Wanted { upload, offset } => (upload, offset),
        reply => panic!("{reply:?}"),
    };
    let (upload, offset) = from(&mut bench, 16, 1);
    let data = heapless::Vec::from_slice(&[0; 8]).unwrap();
    bench.ask(Request::Chunk(Chunk {
        upload,
        offset,
        data,
    }));
    assert_eq!(from(&mut bench, 16, 1).1, 8);
    assert_eq!(from(&mut bench, 16, 2).1, 0);
    assert_eq!(bench.status().upload, Some(0));
}

#[test]
fn a_bad_table_leaves_the_old_one() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    let diagonal = |most: f64| {
        GaitTable::from_fn(64, |u| {
            let angle = most * (std::f64::consts::TAU * u).sin();
            [angle, angle]
        })
        .unwrap()
    };
    let crossing = bench.commit(&diagonal(1.9));
    assert!(
        matches!(crossing, Reply::Refused(Refusal::LinksCross { .. })),
        "{crossing:?}"
    );
    let spiral = bench.commit(&GaitTable::from_fn(64, |u| [u, 0.0]).unwrap());
    assert!(
        matches!(spiral, Reply::Refused(Refusal::NotClosed { .. })),
        "{spiral:?}"
    );
    let wide = GaitTable::from_fn(64, |u| [2.9 * (std::f64::consts::TAU * u).sin(), 0.0]).unwrap();
    let wide = bench.commit(&wide);
    assert!(
        matches!(
            wide,
            Reply::Refused(Refusal::AngleLimit {
                joint: Joint::Front,
                ..
            })
        ),
        "{wide:?}"
    );
    let status = bench.status();
    assert_eq!(
        (status.table.unwrap().crc32, status.upload),
        (circle(1.2).crc32(), None)
    );
}

#[test]
fn the_same_table_again_needs_no_bytes() {
    let mut bench = Bench::new();
    let table = circle(1.2);
    bench.upload(&table);
    let reply = bench.ask(Request::Begin(Begin {
        slot: 0,
        len: 2048,
        crc32: table.crc32(),
    }));
    let Reply::Wanted {
        upload,
        offset: 2048,
    } = reply
    else {
        panic!("{reply:?}")
    };
    assert!(matches!(
        bench.ask(Request::Commit { upload }),
        Reply::Table(Some(_))
    ));
}

type Change = fn(&mut Configuration);

#[test]
fn a_configuration_tightens_limits_and_is_held_against_the_active_table() {
    let mut bench = Bench::new();
    let table = circle(1.2);
    bench.upload(&table);
    let Reply::Configuration(robot) = bench.ask(Request::Configuration) else {
        panic!()
    };
    let with = |change: Change| {
        let mut wanted = robot;
        change(&mut wanted);
        Request::Configure(wanted)
    };
    // Field by field; a refused value changes nothing.
    bench.come_near();
    let bad: [(u8, Change); 9] = [
        (0, |c| c.middle_m = f32::NAN),
        (1, |c| c.front_m = 0.0),
        (2, |c| c.back_m = f32::INFINITY),
        (3, |c| c.chi = -1.0),
        (4, |c| {
            c.tangential_drag = TangentialDrag::OverViscosity(0.0);
        }),
        (4, |c| {
            c.tangential_drag = TangentialDrag::HalfThickness(0.08);
        }),
        (5, |c| c.sphere_radius_m = -0.01),
        (6, |c| c.max_angle = Limits::ROBOT.max_angle + 0.01),
        (7, |c| c.max_rate = Limits::ROBOT.max_rate * 1.01),
    ];
    for (field, change) in bad {
        assert_eq!(bench.refused(with(change)), Refusal::BadValue { field });
    }
    assert_eq!(
        bench.refused(with(|c| c.max_rate = 2.0)),
        Refusal::SlowToNeutral { needs_ms: 1_400 }
    );
    assert_eq!(
        bench.ask(Request::Configuration),
        Reply::Configuration(robot)
    );
    // Under smaller limits the active table is refused before any pulse, with the excess in the reply.
    bench.done(with(|c| c.max_angle = 1.0));
    assert_eq!(bench.greet(9).limits.max_angle, 1.0);
    bench.done(ARM);
    let refusal = bench.refused(play(1, 30_000_000));
    assert!(
        matches!(refusal, Refusal::AngleLimit { limit: 10_000, .. }),
        "{refusal:?}"
    );
    assert_eq!(
        bench.refused(with(|_| ())),
        Refusal::WrongState(StateName::Holding)
    );
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, 2 * SECOND);
    // In another geometry the links of a valid gait may cross.
    bench.done(with(|c| {
        c.middle_m = 0.03;
        c.front_m = 0.3;
        c.back_m = 0.3;
        c.max_angle = 2.8;
    }));
    // The gait begins at neutral, where the servos are, so the route cannot cross.
    let long = GaitTable::from_fn(512, |u| [1.7 * (std::f64::consts::TAU * u).sin(); 2]).unwrap();
    let reply = bench.commit(&long);
    assert!(
        matches!(reply, Reply::Refused(Refusal::LinksCross { .. })),
        "{reply:?}"
    );
    bench.done(with(|_| ()));
    bench.upload(&long);
    bench.done(with(|c| {
        c.middle_m = 0.03;
        c.front_m = 0.3;
        c.back_m = 0.3;
    }));
    bench.done(ARM);
    let refusal = bench.refused(play(1, 30_000_000));
    let Refusal::LinksCross { place, .. } = refusal else {
        panic!("{refusal:?}")
    };
    assert!(matches!(place, CrossingPlace::Gait(_)), "{place:?}");
}

#[test]
fn trim_moves_the_pulse_not_the_setpoint_and_not_faster_than_allowed() {
    let mut bench = Bench::new();
    bench.come_near();
    bench.done(ARM);
    bench.tick();
    bench.done(Request::Trim {
        joint: Joint::Back,
        trim: 5_000,
    });
    let mut last = 1_500_000;
    for output in bench.run(SECOND) {
        let [front, back] = output.pulses_ns.unwrap();
        assert_eq!(front, 1_500_000);
        assert!(back >= last && back - last <= 2_555);
        last = back;
    }
    assert_eq!(last, 1_500_000 + 18_248);
    assert_eq!(bench.output.setpoint, [0.0; 2]);
    assert_eq!(
        bench.refused(Request::Trim {
            joint: Joint::Back,
            trim: 5_001
        }),
        Refusal::BadValue { field: 1 }
    );
    let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Back)) else {
        panic!()
    };
    assert_eq!(servo.trim, 5_000);
    let wanted = ServoSettings {
        reversed: true,
        ..servo
    };
    let set = Request::SetServo {
        joint: Joint::Back,
        settings: wanted,
    };
    assert_eq!(
        bench.refused(set.clone()),
        Refusal::WrongState(StateName::Holding)
    );
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, 2 * SECOND);
    bench.done(set);
    assert_eq!(bench.ask(Request::Servo(Joint::Back)), Reply::Servo(wanted));
    for (field, bad) in [
        (
            0,
            ServoSettings {
                centre_ns: 1_520_001,
                ..wanted
            },
        ),
        (
            1,
            ServoSettings {
                slope_rad_per_us: f32::NAN,
                ..wanted
            },
        ),
        (
            3,
            ServoSettings {
                trim: -5_001,
                ..wanted
            },
        ),
    ] {
        let set = Request::SetServo {
            joint: Joint::Back,
            settings: bad,
        };
        assert_eq!(bench.refused(set), Refusal::BadValue { field });
    }
}

/// The slope converts a rate into pulse steps, so settings of another servo type are refused.
#[test]
fn a_servo_may_be_set_up_as_one_of_its_kind_only() {
    let mut bench = Bench::new();
    bench.come_near();
    let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Front)) else {
        panic!()
    };
    let with = |centre_ns: u32, slope: f32| Request::SetServo {
        joint: Joint::Front,
        settings: ServoSettings {
            centre_ns,
            slope_rad_per_us: slope * servo.slope_rad_per_us,
            ..servo
        },
    };
    for (centre_ns, slope) in [(1_480_000, 0.901), (1_520_000, 1.099), (1_500_000, 1.0)] {
        bench.done(with(centre_ns, slope));
    }
    for (field, request) in [
        (0, with(1_479_999, 1.0)),
        (0, with(1_520_001, 1.0)),
        (0, with(1_300_000, 1.0)),
        (1, with(1_500_000, 0.899)),
        (1, with(1_500_000, 1.101)),
        (1, with(1_500_000, 0.004)),
        (1, with(1_500_000, -1.0)),
        (1, with(1_500_000, f32::NAN)),
    ] {
        assert_eq!(bench.refused(request), Refusal::BadValue { field });
    }
}

#[test]
fn a_trim_may_put_a_joint_at_its_limit_and_not_beyond() {
    let mut bench = Bench::new();
    bench.come_near();
    let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Back)) else {
        panic!()
    };
    let trim = 4_000;
    let away = ServoMap::from(ServoSettings { trim, ..servo }).angle(servo.centre_ns);
    for (max_angle, taken) in [(away.abs(), true), (away.abs().next_down(), false)] {
        let Reply::Configuration(mut wanted) = bench.ask(Request::Configuration) else {
            panic!()
        };
        wanted.max_angle = max_angle;
        bench.done(Request::Configure(wanted));
        bench.done(ARM);
        bench.tick();
        let joint = Joint::Back;
        let reply = bench.ask(Request::Trim { joint, trim });
        assert_eq!(reply == Reply::Done, taken, "{reply:?}");
        bench.done(Request::Stop);
        bench.until(StateName::Stopped, 2 * SECOND);
        bench.done(Request::Trim { joint, trim: 0 });
    }
}

/// During a check, requests that affect it are refused as busy: uploads, configuration, servos, key and plays.
#[test]
fn while_a_table_is_checked_nothing_that_hangs_on_it_begins() {
    let mut bench = Bench::new();
    let upload = bench.send_table(&circle(1.1));
    let commit = bench.sequence + 1;
    assert_eq!(bench.send_request(commit, Request::Commit { upload }), None);
    let configuration =
        gait_player::BrainConfig::robot(IDENTITY, gait_player::Boot::power_on(1, 1));
    for (later, request) in (1..).zip([
        Request::Begin(Begin {
            slot: 0,
            len: 8,
            crc32: 0,
        }),
        Request::Commit { upload },
        Request::Configure(configuration.configuration),
        Request::SetKey(None),
    ]) {
        assert_eq!(
            bench.send_request(commit + later, request.clone()),
            Some(Reply::Refused(Refusal::Busy)),
            "{request:?}"
        );
    }
    // The original request still gets its reply: the table is checked and accepted.
    bench.sequence = commit + 4;
    bench.run(4 * SECOND);
    let taken = |(header, reply): &(Header, Reply)| {
        header.sequence == commit && matches!(reply, Reply::Table(Some(_)))
    };
    assert!(bench.replies.iter().any(taken), "{:?}", bench.replies);
}
