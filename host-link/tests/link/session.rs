//! Session against a scripted robot, in virtual time: retransmissions, time-outs and errors.

use crate::scripted;

use std::time::Duration;

use host_link::session::{Event, LONGEST_WORK, Session, SessionConfig};
use link_protocol::{
    Checked, Message, Pong, Refusal, Reply, Request, StateName, StopCause, TableInfo,
};
use scripted::{MS, SESSION, Script};

fn times(script: &Script) -> Vec<u128> {
    script.sent.iter().map(|(at, ..)| at.as_millis()).collect()
}

#[test]
fn an_unanswered_greeting_is_repeated_and_given_up_with_advice() {
    let mut script = Script::new();
    let ticket = script.session.connect(script.now);
    script.run_to(MS * 20_000);
    // 200 ms before the first measurement, doubled each time, at most 3 s.
    assert_eq!(times(&script), [0, 200, 600, 1400, 3000]);
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(
        error.contains("connecting: no answer after 5 tries in 6000 ms"),
        "{error}"
    );
    assert!(
        error.contains("5 frames (") && error.contains("4 of them again"),
        "{error}"
    );
    assert!(error.contains("on and paired"), "{error}");
}

#[test]
fn noise_without_a_frame_asks_for_the_baud_rate() {
    let mut script = Script::new();
    let ticket = script.session.connect(script.now);
    script.session.receive(MS, &[0xE0, 0x1C, 0, 0xFF, 0, 3]);
    script.run_to(MS * 20_000);
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(error.contains("115200 baud"), "{error}");
}

#[test]
fn requests_are_repeated_at_twice_the_round_trip_with_the_same_number() {
    let mut script = Script::open(MS * 150);
    let ticket = script.session.request(script.now, Request::Status);
    script.collect();
    script.run_to(MS * 30_000);
    let requests = script.requests();
    // Round trip 150 ms: 300, 600, 1200, 2400 ms, then 3 s to the end.
    let at: Vec<u128> = requests.iter().map(|(at, ..)| at.as_millis()).collect();
    assert_eq!(at, [150, 450, 1050, 2250, 4650]);
    assert!(
        requests
            .iter()
            .all(|(_, sequence, _)| *sequence == requests[0].1)
    );
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(
        error.contains("asking for the status: no answer after 5 tries in 7500 ms"),
        "{error}"
    );
}

#[test]
fn a_quick_link_waits_80_ms_at_least() {
    let mut script = Script::open(MS * 4);
    script.session.request(script.now, Request::Status);
    script.collect();
    script.run_to(MS * 250);
    let at: Vec<u128> = script
        .requests()
        .iter()
        .map(|(at, ..)| at.as_millis())
        .collect();
    assert_eq!(at, [4, 84, 244]);
}

#[test]
fn a_robot_that_works_is_not_given_up() {
    let mut script = Script::open(MS * 10);
    let ticket = script.session.request(script.now, Request::Resume);
    script.collect();
    for round in 1..=20 {
        script.run_to(MS * 10 + MS * 500 * round);
        assert!(script.outcome(ticket).is_none());
        script.reply(Reply::Working);
    }
    script.reply(Reply::Done);
    assert_eq!(script.outcome(ticket), Some(Ok(())));
}

/// The request fails after the longest time that any request takes.
#[test]
fn a_robot_that_works_for_ever_ends_in_the_stated_time() {
    let mut script = Script::open(MS * 10);
    let ticket = script.session.request(script.now, Request::Resume);
    script.collect();
    let begun = script.now;
    while script.outcome(ticket).is_none() {
        script.run_to(script.now + MS * 500);
        assert!(script.now < begun + MS * 60_000, "it never ends");
        script.reply(Reply::Working);
    }
    let took = script.now.abs_diff(begun);
    assert!(
        took >= LONGEST_WORK && took < LONGEST_WORK + MS * 1000,
        "{took:?}"
    );
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(
        error.contains("resuming") && error.contains("still working at it"),
        "{error}"
    );
}

/// The check of an upload fails likewise, long before the upload's own deadline.
#[test]
fn a_check_that_lasts_for_ever_ends_the_upload() {
    let mut script = Script::open(MS * 10);
    let deadline = script.now + MS * 600_000;
    let ticket = script.session.upload(script.now, 0, &[0; 16], deadline);
    script.collect();
    script.reply(Reply::Wanted {
        upload: script.last_request().1,
        offset: 16,
    });
    while script.outcome(ticket).is_none() {
        script.run_to(script.now + MS * 500);
        assert!(script.now < MS * 60_000, "it never ends");
        script.reply(Reply::Working);
    }
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(error.contains("uploading the gait"), "{error}");
}

#[test]
fn one_request_at_a_time_in_the_order_asked() {
    let mut script = Script::open(MS * 10);
    let first = script.session.request(script.now, Request::Resume);
    let second = script.session.request(script.now, Request::Table);
    script.collect();
    assert_eq!(script.requests().len(), 1);
    script.reply(Reply::Done);
    assert_eq!(script.requests().len(), 2);
    assert_eq!(
        script.requests()[1].1,
        script.requests()[0].1.wrapping_add(1)
    );
    script.reply(Reply::Refused(Refusal::NoTable));
    assert_eq!(script.outcome(first), Some(Ok(())));
    let error = script.outcome(second).unwrap().unwrap_err();
    assert!(
        error.contains("robot refuses: the robot holds no gait"),
        "{error}"
    );
}

#[test]
fn replies_to_other_sessions_and_numbers_count_for_nothing() {
    let mut script = Script::open(MS * 10);
    let ticket = script.session.request(script.now, Request::Resume);
    script.collect();
    let sequence = script.last_request().1;
    script.say(SESSION + 1, sequence, &Message::Reply(Reply::Done));
    script.say(
        SESSION,
        sequence.wrapping_sub(1),
        &Message::Reply(Reply::Done),
    );
    assert!(script.outcome(ticket).is_none());
    let counters = script.session.counters();
    assert_eq!((counters.foreign, counters.unmatched), (1, 1));
    script.reply(Reply::Done);
    assert_eq!(script.outcome(ticket), Some(Ok(())));
}

#[test]
fn another_version_is_a_sentence_and_not_silence() {
    for (min, current, versions, advice) in [
        (0x30, 0x41, "3.0 to 4.1", "update this program"),
        (0, 0, "0.0 to 0.0", "update the robot's firmware"),
        (1, 2, "0.1 to 0.2", "update the robot's firmware"),
    ] {
        let mut script = Script::new();
        let ticket = script.session.connect(script.now);
        script.collect();
        script.greet(|reply| (reply.protocol_min, reply.protocol_current) = (min, current));
        let error = script.outcome(ticket).unwrap().unwrap_err();
        assert!(error.contains("1.2.3 (0123abcd)"), "{error}");
        assert!(
            error.contains(&format!("versions {versions}")) && error.contains(advice),
            "{error}"
        );
        assert!(script.session.hello().is_none());
    }
}

#[test]
fn another_schema_is_a_sentence_too() {
    let mut script = Script::new();
    let ticket = script.session.connect(script.now);
    script.collect();
    script.greet(|reply| reply.schema_key[0] ^= 1);
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(error.contains("build both from the same commit"), "{error}");
}

#[test]
fn an_idle_session_feeds_the_lease_every_50_ms_as_it_is_answered() {
    let mut script = Script::open(MS * 10);
    // The first one is sent with the greeting's reply; this one replaces it.
    script.run_to(MS * 90);
    let mut heard = Vec::new();
    for round in 1..60_u64 {
        let (at, header, message) = script.sent.last().cloned().unwrap();
        let Message::Heartbeat(heartbeat) = message else {
            panic!("{message:?}")
        };
        assert_eq!(heartbeat.host_us, u64::try_from(at.as_micros()).unwrap());
        heard.push(heartbeat.heard_us);
        script.run_to(at + MS * 10);
        let pong = Message::Pong(Pong {
            host_us: heartbeat.host_us,
            received_us: 1_000 * round,
            sent_us: 1_000 * round,
        });
        script.say(SESSION, header.sequence, &pong);
        script.run_to(at + MS * 50);
    }
    let gaps: Vec<u128> = times(&script)
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    assert!(gaps.iter().all(|&gap| gap == 50), "{gaps:?}");
    // Nothing at first, then the robot's latest report.
    assert!(
        heard
            .iter()
            .zip(0..)
            .all(|(&heard, before)| heard == 1_000 * before),
        "{heard:?}"
    );
}

#[test]
fn unanswered_keep_alives_are_few() {
    let mut script = Script::open(MS * 10);
    script.run_to(MS * 60_010);
    // One, and the replacement of a lost one.
    assert!(script.sent.len() < 30, "{}", script.sent.len());
}

#[test]
fn a_line_that_echoes_is_named() {
    let mut session = Session::new(SessionConfig::new(1));
    let mut now = Duration::ZERO;
    session.connect(now);
    loop {
        let echo = session.take_outgoing();
        session.receive(now, &echo);
        if let Some(event) = session.next_event() {
            let Event::Failed { error, .. } = event else {
                panic!("{event:?}")
            };
            assert!(error.to_string().contains("the line echoes"), "{error}");
            return;
        }
        now = session.next_deadline().unwrap();
        session.poll(now);
    }
}

/// The stop waits behind other bytes, and telemetry reports the cause that ended the motion.
#[test]
fn a_stop_that_the_lease_overtook_ends_with_that() {
    let mut script = Script::open(MS * 10);
    script.tell(StateName::Playing, StopCause::Boot);
    let ticket = script.session.request(script.now, Request::Stop);
    script.collect();
    // Immediately after it was sent, the stop is not late.
    script.tell(StateName::Stopping, StopCause::LinkLost);
    script.run_to(MS * 600);
    assert_eq!(script.outcome(ticket), None);
    script.tell(StateName::Playing, StopCause::LinkLost);
    assert_eq!(script.outcome(ticket), None);
    script.tell(StateName::Stopping, StopCause::LinkLost);
    assert!(script.events.iter().any(
        |event| matches!(event, Event::StoppedByItself { ticket: stopped, cause: StopCause::LinkLost } if *stopped == ticket)
    ));
    // The stop itself ended the motion; its reply was lost.
    let ticket = script.session.request(script.now, Request::Stop);
    script.run_to(MS * 1_300);
    script.tell(StateName::Settling, StopCause::Requested);
    assert_eq!(script.outcome(ticket), Some(Ok(())));
    // An e-stop ends only with the latch.
    let ticket = script.session.request(script.now, Request::EStop);
    script.run_to(MS * 2_000);
    script.tell(StateName::Stopped, StopCause::LinkLost);
    assert_eq!(script.outcome(ticket), None);
    script.tell(StateName::EStopped, StopCause::EStop);
    assert_eq!(script.outcome(ticket), Some(Ok(())));
}

#[test]
fn an_idle_half_hour_does_not_age_the_next_request() {
    let mut script = Script::open(MS * 10);
    script.session.request(script.now, Request::Status);
    script.collect();
    script.reply(Reply::Done);
    let (_, before, _) = script.last_request();
    script.run_to(MS * 1_800_000);
    script.session.request(script.now, Request::Table);
    script.collect();
    let (_, after, _) = script.last_request();
    // Numbers beyond half the range would be older than the first, and the robot would ignore them.
    assert_eq!(after.wrapping_sub(before), 1);
}

#[test]
fn what_the_robot_works_at_does_not_lengthen_the_round_trip() {
    let mut script = Script::open(MS * 10);
    let play = Request::Play(link_protocol::Play {
        cycles: 1,
        period_us: 5_000_000,
        detached: false,
        checked: Checked {
            table_crc32: 1,
            settings_crc32: 2,
        },
    });
    script.session.request(script.now, play);
    script.collect();
    script.run_to(MS * 60);
    script.reply(Reply::Done);
    script.session.request(script.now, Request::Resume);
    script.collect();
    script.run_to(MS * 200);
    script.reply(Reply::Working);
    script.run_to(MS * 3_000);
    script.reply(Reply::Done);
    let trip = script.session.counters().round_trip;
    assert_eq!(trip, Some(MS * 10));
}

#[test]
fn a_stop_drops_everything_unanswered_and_goes_first() {
    let mut script = Script::open(MS * 10);
    let upload = script
        .session
        .upload(script.now, 0, &[1; 2048], MS * 60_000);
    let status = script.session.request(script.now, Request::Status);
    // Nothing was sent since, so the stop replaces the waiting bytes.
    let stop = script.session.request(script.now, Request::Stop);
    script.collect();
    assert_eq!(script.requests().len(), 1);
    assert!(matches!(script.last_request().2, Request::Stop));
    for dropped in [upload, status] {
        let error = script.outcome(dropped).unwrap().unwrap_err();
        assert!(error.contains("a stop was sent"), "{error}");
    }
    script.reply(Reply::Done);
    assert_eq!(script.outcome(stop), Some(Ok(())));
}

#[test]
fn a_stop_does_not_weaken_an_estop_that_is_not_answered_yet() {
    let mut script = Script::open(MS * 10);
    script.session.request(script.now, Request::EStop);
    // Its frame is lost, and the operator sends a stop too.
    script.collect();
    let stop = script.session.request(script.now, Request::Stop);
    script.collect();
    assert!(matches!(script.last_request().2, Request::EStop));
    script.reply(Reply::Done);
    assert_eq!(script.outcome(stop), Some(Ok(())));
    // After its reply, a stop is a plain stop again.
    script.session.request(script.now, Request::Stop);
    script.collect();
    assert!(matches!(script.last_request().2, Request::Stop));
}

#[test]
fn a_stop_needs_no_session_and_hurries() {
    let mut script = Script::new();
    let ticket = script.session.request(script.now, Request::EStop);
    script.run_to(MS * 10_000);
    let gaps: Vec<u128> = times(&script)
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    assert!(gaps.iter().all(|&gap| gap <= 200), "{gaps:?}");
    assert!(script.outcome(ticket).unwrap().is_err());
    let ticket = script.session.request(script.now, Request::Stop);
    script.collect();
    let sequence = script.last_request().1;
    script.say(SESSION, sequence, &Message::Reply(Reply::Done));
    assert_eq!(script.outcome(ticket), Some(Ok(())));
}

#[test]
fn a_lost_session_fails_requests_until_greeted_again() {
    let mut script = Script::open(MS * 10);
    let ticket = script.session.request(script.now, Request::Resume);
    let waiting = script.session.request(script.now, Request::Table);
    script.collect();
    script.reply(Reply::Refused(Refusal::StaleSession));
    let error = script.outcome(ticket).unwrap().unwrap_err();
    assert!(error.contains("another session"), "{error}");
    assert!(script.outcome(waiting).unwrap().is_err());
    script.session.connect(script.now);
    script.collect();
    script.greet(|reply| (reply.session, reply.boot_nonce) = (41, 100));
    assert!(matches!(
        script.events.last(),
        Some(Event::Connected {
            restarted: true,
            ..
        })
    ));
}

#[test]
fn chunks_in_flight_stay_below_the_window_and_at_the_line_s_pace() {
    let mut script = Script::open(MS * 150);
    script.tell(StateName::Stopped, StopCause::Boot);
    let upload = script
        .session
        .upload(script.now, 0, &[3; 2048], MS * 60_000);
    script.collect();
    let begin = script.last_request().1;
    script.run_to(MS * 300);
    script.sent.clear();
    script.say(
        SESSION,
        begin,
        &Message::Reply(Reply::Wanted {
            upload: begin,
            offset: 0,
        }),
    );
    script.run_to(MS * 450);
    let chunks: Vec<_> = script.requests();
    // 124 bytes each on the wire; nine would exceed 1024.
    assert_eq!(chunks.len(), 8);
    let gaps: Vec<u128> = chunks
        .windows(2)
        .map(|pair| pair[1].0.abs_diff(pair[0].0).as_micros())
        .collect();
    assert!(
        gaps.iter().all(|gap| (10_500..11_000).contains(gap)),
        "{gaps:?}"
    );
    // Two replies release two more.
    let second = chunks[1].1;
    script.say(
        SESSION,
        second,
        &Message::Reply(Reply::Wanted {
            upload: begin,
            offset: 208,
        }),
    );
    script.run_to(script.now + MS * 40);
    assert_eq!(script.requests().len(), 10);
    assert!(script.outcome(upload).is_none());
}

#[test]
fn an_upload_waits_five_seconds_of_silence_and_no_longer() {
    let mut script = Script::open(MS * 10);
    let upload = script.session.upload(script.now, 0, &[3; 400], MS * 60_000);
    script.collect();
    script.run_to(MS * 4_900);
    assert!(script.outcome(upload).is_none());
    script.run_to(MS * 5_100);
    let error = script.outcome(upload).unwrap().unwrap_err();
    assert!(error.contains("no valid frame for 5000 ms"), "{error}");
}

#[test]
fn an_upload_ends_at_its_deadline() {
    let mut script = Script::open(MS * 10);
    let upload = script.session.upload(script.now, 0, &[3; 400], MS * 2_000);
    script.collect();
    let begin = script.last_request().1;
    script.reply(Reply::Wanted {
        upload: begin,
        offset: 104,
    });
    script.run_to(MS * 2_000);
    let error = script.outcome(upload).unwrap().unwrap_err();
    assert!(error.contains("104 of 400 bytes arrived"), "{error}");
}

#[test]
fn an_upload_survives_a_restart_of_the_robot() {
    let mut script = Script::open(MS * 10);
    let table = [5; 300];
    let upload = script.session.upload(script.now, 0, &table, MS * 60_000);
    script.collect();
    let begin = script.last_request().1;
    script.reply(Reply::Wanted {
        upload: begin,
        offset: 0,
    });
    script.run_to(script.now + MS * 5);
    script.reply(Reply::Refused(Refusal::StaleSession));
    script.greet(|reply| (reply.session, reply.boot_nonce) = (SESSION, 100));
    let (_, again, request) = script.last_request();
    assert!(matches!(request, Request::Begin(_)) && again != begin);
    script.reply(Reply::Wanted {
        upload: again,
        offset: 208,
    });
    script.run_to(script.now + MS * 20);
    let (_, _, request) = script.last_request();
    assert!(
        matches!(&request, Request::Chunk(chunk) if chunk.offset == 208 && chunk.upload == again && chunk.data.len() == 92),
        "{request:?}"
    );
    script.reply(Reply::Wanted {
        upload: again,
        offset: 300,
    });
    assert!(matches!(script.last_request().2, Request::Commit { upload } if upload == again));
    script.reply(Reply::Table(Some(TableInfo {
        knots: 75,
        crc32: 1,
        stored: false,
        min_period_us: 1,
    })));
    assert_eq!(script.outcome(upload), Some(Ok(())));
}

#[test]
fn garbage_and_half_frames_never_panic_nor_answer() {
    use rand::{Rng, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
    let mut script = Script::open(MS * 10);
    let ticket = script.session.request(script.now, Request::Status);
    let mut noise = [0; 97];
    for _ in 0..2_000 {
        rng.fill_bytes(&mut noise);
        script.session.receive(script.now, &noise);
    }
    script.collect();
    assert!(script.outcome(ticket).is_none());
    assert_eq!(
        script.session.counters().bytes_received,
        2_000 * 97 + script_open_bytes()
    );
}

/// Bytes of the greeting's reply.
fn script_open_bytes() -> u64 {
    Script::open(Duration::from_millis(10))
        .session
        .counters()
        .bytes_received
}
