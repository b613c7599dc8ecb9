//! Calls over a link that becomes silent: reports, the end of each call, and a stop during a wait.

use crate::tank_less;

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use host_link::robot::{Callbacks, Halt, Silence};
use host_link::session::SessionConfig;
use host_link::testing::{FaultPlan, Faults, Outage};
use host_link::{LinkError, Port, Robot};
use tank_less::{FaultyLine, circle, connect, faulty, upload};

const MS: Duration = Duration::from_millis(1);
const FOR_EVER: Duration = Duration::from_hours(1);

/// Reports of silences, in order.
type Reports = Arc<Mutex<Vec<Silence>>>;

fn reporting() -> (Reports, Callbacks) {
    let reports = Reports::default();
    let sink = Arc::clone(&reports);
    let callbacks = Callbacks {
        silence: Some(Box::new(move |silence| sink.lock().unwrap().push(silence))),
        halt: None,
    };
    (reports, callbacks)
}

fn robot() -> (Robot<FaultyLine>, Reports) {
    let mut robot = connect("", 12);
    let (reports, callbacks) = reporting();
    robot.call_back(callbacks);
    (robot, reports)
}

/// Checks the single report of a silence, which must come after two seconds.
#[track_caller]
fn began(reports: &Reports, doing: &str) {
    let reports = reports.lock().unwrap();
    let Some(Silence::Began {
        doing: said,
        silent,
    }) = reports.first()
    else {
        panic!("{reports:?}")
    };
    assert_eq!(*said, doing);
    assert!((MS * 2000..MS * 2100).contains(silent), "{silent:?}");
    let begins = |silence: &&Silence| matches!(silence, Silence::Began { .. });
    assert_eq!(reports.iter().filter(begins).count(), 1, "{reports:?}");
}

fn cut(robot: &mut Robot<FaultyLine>, after: Duration, duration: Duration) {
    let from = robot.port().now() + after;
    robot.port_mut().disconnect(Outage::once(from, duration));
}

type Call = (
    &'static str,
    fn(&mut Robot<FaultyLine>) -> Result<(), LinkError>,
);

/// Every kind of call against a silent robot is reported after two seconds and ends in the stated time.
#[test]
fn every_call_reports_silence_after_two_seconds_and_gives_up() {
    let calls: [(Call, Duration); 7] = [
        (
            ("asking for the status", |robot| robot.status().map(drop)),
            MS * 8_000,
        ),
        (("arming", |robot| robot.arm(false)), MS * 8_000),
        (("stopping", |robot| robot.stop().map(drop)), MS * 8_000),
        (("connecting", Robot::reconnect), MS * 8_000),
        (
            ("listening to the robot", |robot| {
                robot.listen(MS * 60_000, |_| ControlFlow::Continue(()))
            }),
            MS * 5_100,
        ),
        (
            ("uploading the gait", |robot| {
                upload(robot, circle(1.0).bytes()).map(drop)
            }),
            MS * 5_100,
        ),
        (
            ("waiting for the end of the play", |robot| {
                robot
                    .wait_until_finished(|_| ControlFlow::Continue(()))
                    .map(drop)
            }),
            MS * 15_000,
        ),
    ];
    for ((doing, call), at_most) in calls {
        let (mut robot, reports) = robot();
        // A fast line has a short round trip; without a measurement each attempt waits longest.
        robot
            .listen(MS * 200, |_| ControlFlow::Continue(()))
            .unwrap();
        cut(&mut robot, Duration::ZERO, FOR_EVER);
        let begun = robot.port().now();
        let error = call(&mut robot).unwrap_err();
        let took = robot.port().now().abs_diff(begun);
        assert!(took < at_most, "{doing}: {took:?}");
        assert!(
            matches!(error, LinkError::NoAnswer { .. } | LinkError::Silent { .. }),
            "{doing}: {error}"
        );
        began(&reports, doing);
    }
}

/// Regression: `play` against a frozen robot returned nothing for 34.6 s.
#[test]
fn a_play_that_freezes_is_given_up_within_ten_seconds() {
    let (mut robot, reports) = robot();
    upload(&mut robot, circle(1.0).bytes()).unwrap();
    robot.arm(false).unwrap();
    robot.play(3, MS * 8000, false).unwrap();
    cut(&mut robot, MS * 3000, FOR_EVER);
    let begun = robot.port().now();
    let error = robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap_err();
    assert!(matches!(error, LinkError::NoAnswer { .. }), "{error}");
    let silent = robot.port().now().abs_diff(begun).saturating_sub(MS * 3000);
    assert!((MS * 5_000..MS * 10_000).contains(&silent), "{silent:?}");
    began(&reports, "waiting for the end of the play");
}

#[test]
fn a_link_that_comes_back_is_reported_too() {
    let (mut robot, reports) = robot();
    cut(&mut robot, MS * 1000, MS * 3000);
    robot
        .listen(MS * 10_000, |_| ControlFlow::Continue(()))
        .unwrap();
    began(&reports, "listening to the robot");
    let ended = reports.lock().unwrap().get(1).copied();
    let Some(Silence::Ended { silent }) = ended else {
        panic!("{reports:?}")
    };
    assert!((MS * 2900..MS * 3600).contains(&silent), "{silent:?}");
    // A short silence is not reported.
    let (mut robot, reports) = self::robot();
    cut(&mut robot, MS * 1000, MS * 1500);
    robot
        .listen(MS * 10_000, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(*reports.lock().unwrap(), []);
}

/// Time in which the program did something else is no silence of the robot.
#[test]
fn a_program_that_did_not_listen_reports_nothing() {
    let (mut robot, reports) = robot();
    robot.port_mut().inner_mut().pass(MS * 4000);
    robot.status().unwrap();
    assert_eq!(*reports.lock().unwrap(), []);
}

#[test]
fn a_robot_that_never_answers_a_greeting_is_reported() {
    let mut line = faulty(Faults::default(), 1);
    line.disconnect(Outage::once(Duration::ZERO, FOR_EVER));
    let (reports, callbacks) = reporting();
    let failed = Robot::connect_observed(line, SessionConfig::new(1), callbacks);
    assert!(matches!(failed, Err(LinkError::NoAnswer { .. })));
    began(&reports, "connecting");
}

/// The stop is sent while a request waits for a reply that never comes.
#[test]
fn a_stop_ends_the_wait_for_a_reply() {
    for halt in [Halt::Stop, Halt::EStop] {
        let (mut robot, _) = robot();
        upload(&mut robot, circle(1.0).bytes()).unwrap();
        robot.arm(false).unwrap();
        robot.play(3, MS * 8000, false).unwrap();
        robot
            .listen(MS * 3000, |_| ControlFlow::Continue(()))
            .unwrap();
        let deaf = Faults {
            drop: 1.0,
            ..Faults::default()
        };
        robot.port_mut().set_plan(FaultPlan {
            written: Faults::default(),
            read: deaf,
        });
        let begun = robot.port().now();
        let mut looks = 0;
        robot.halt_when(Box::new(move || {
            looks += 1;
            (looks == 5).then_some(halt)
        }));
        robot.status().unwrap_err();
        // The lease would end the motion half a second later.
        let device = robot.port().inner().device();
        let stopped = match halt {
            Halt::Stop => device.ramp,
            Halt::EStop => device.powered,
        };
        let took = stopped.saturating_sub(begun);
        assert!(!took.is_zero() && took < MS * 200, "{halt:?}: {took:?}");
    }
}
