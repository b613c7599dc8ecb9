//! Promise R10 and the rules of sessions: duplicated, reordered and late requests act at most once. Stop and e-stop always act.
use crate::bench;

use bench::*;
use gait_player::{Brain, Transport};
use link_protocol::*;
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

fn counters(bench: &mut Bench) -> Counters {
    match bench.ask(Request::Counters) {
        Reply::Counters(counters) => counters,
        reply => panic!("{reply:?}"),
    }
}

#[test]
fn nothing_but_stops_acts_without_the_open_session() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    let open = bench.session;
    bench.keep_alive = false;
    for session in [0, open.wrapping_sub(1), open.wrapping_add(1)] {
        bench.session = session;
        for request in [
            play(1, 5_000_000),
            Request::Status,
            ARM,
            Request::Begin(Begin {
                slot: 0,
                len: 8,
                crc32: 0,
            }),
        ] {
            assert_eq!(bench.refused(request), Refusal::StaleSession);
        }
    }
    bench.session = open;
    assert_eq!(bench.status().state, StateName::Holding);
    assert_eq!(counters(&mut bench).stale, 12);
}

/// Greetings are short and their replies long, so a flood of them fills the transmit buffer.
#[test]
fn a_stop_is_answered_in_a_flood_that_drowns_all_other_answers() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    let dropped = counters(&mut bench).dropped;
    let mut encoded = [0; MAX_ENCODED];
    let mut send = |brain: &mut Brain, now_us, header, message: &Message| {
        let len = encode(header, message, &mut encoded).unwrap();
        brain.receive(now_us, Transport::Uart, &encoded[..len]);
    };
    let now_us = bench.now_us;
    for host_nonce in 0..100 {
        let hello = Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce,
        };
        let header = Header::new(0, 7);
        send(&mut bench.brain, now_us, header, &Message::Hello(hello));
    }
    assert!(bench.brain.counters().dropped > dropped + 80);
    let stop = Header::new(0, 4711);
    let message = Message::Request(Request::Stop);
    send(&mut bench.brain, now_us, stop, &message);
    bench.tick();
    assert!(
        bench.replies.contains(&(stop, Reply::Done)),
        "{:?}",
        bench.replies
    );
    assert_eq!(bench.output.state, StateName::Stopping);
}

#[test]
fn stops_act_whatever_their_session_and_number() {
    for stop in [Request::Stop, Request::EStop] {
        for (session, sequence) in [(0_i32, 0_u16), (1, 0), (-1, 9), (0, 0x8000), (1, 60_000)] {
            let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
            let header = Header::new(
                bench
                    .session
                    .wrapping_add_signed(i16::try_from(session).unwrap()),
                sequence,
            );
            bench.send(header, &Message::Request(stop.clone()));
            assert_eq!(bench.replies.last().unwrap(), &(header, Reply::Done));
            bench.tick();
            let expected = if stop == Request::Stop {
                StateName::Stopping
            } else {
                StateName::EStopped
            };
            assert_eq!(bench.output.state, expected);
        }
    }
    // Also before any greeting, and signed.
    let mut bench = Bench::with(config());
    let mut frame = [0; MAX_ENCODED];
    let mut body = [0; MAX_BODY];
    let body = Message::Request(Request::EStop)
        .encode_body(&mut body)
        .unwrap();
    let signature = Some(Signature {
        counter: 1,
        tag: [7; 8],
    });
    let len = encode_body(
        Header::new(9, 9),
        Kind::Request as u8,
        body,
        signature,
        &mut frame,
    )
    .unwrap();
    bench
        .brain
        .receive(bench.now_us, Transport::Uart, &frame[..len]);
    assert_eq!(bench.tick().state, StateName::EStopped);
}

#[test]
fn a_stop_supersedes_the_requests_before_it() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    let late = bench.sequence + 1;
    bench.sequence += 1;
    bench.done(Request::Stop);
    let stop = bench.sequence;
    assert_eq!(
        bench.send_request(late, ARM),
        Some(Reply::Refused(Refusal::Superseded { last: stop }))
    );
    bench.run(SECOND);
    assert_eq!(bench.output.state, StateName::Stopped);
    // A late stop of the same session acts too, but takes no number in the order.
    bench.done(ARM);
    let arm = bench.sequence;
    assert_eq!(bench.send_request(stop, Request::Stop), Some(Reply::Done));
    assert_eq!(bench.send_request(arm, ARM), Some(Reply::Done));
    bench.run(SECOND);
    assert_eq!(bench.output.state, StateName::Stopped);
}

#[test]
fn a_stop_cancels_a_play_that_waits_for_its_check() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    let sequence = bench.sequence + 1;
    assert_eq!(bench.send_request(sequence, play(1, 5_000_000)), None);
    // A repeat during the check gets the interim reply.
    assert_eq!(
        bench.send_request(sequence, play(1, 5_000_000)),
        Some(Reply::Working)
    );
    bench.sequence = sequence;
    bench.done(Request::Stop);
    bench.run(2 * SECOND);
    assert_eq!(bench.output.state, StateName::Stopped);
}

#[test]
fn what_a_stop_from_elsewhere_cancels_is_answered_and_not_worked_at_for_ever() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    let stranger = Header::new(0, 9);
    // A play that another program stops: it was answered, and its repeat gets the same reply.
    let sequence = bench.sequence + 1;
    assert_eq!(bench.send_request(sequence, play(1, 5_000_000)), None);
    bench.send(stranger, &Message::Request(Request::Stop));
    let refused = Reply::Refused(Refusal::NotArmed);
    let answer = (Header::new(bench.session, sequence), refused.clone());
    assert!(bench.replies.contains(&answer));
    assert_eq!(
        bench.send_request(sequence, play(1, 5_000_000)),
        Some(refused)
    );
    bench.sequence = sequence;
    // A commit may be repeated.
    let table = circle(1.1);
    let upload = bench.send_table(&table);
    bench.until(StateName::Stopped, 2 * SECOND);
    bench.done(ARM);
    let sequence = bench.sequence + 1;
    assert_eq!(
        bench.send_request(sequence, Request::Commit { upload }),
        None
    );
    bench.send(stranger, &Message::Request(Request::EStop));
    assert_eq!(
        bench.send_request(sequence, Request::Commit { upload }),
        Some(Reply::Refused(Refusal::Busy))
    );
    bench.sequence = sequence;
    assert!(matches!(
        bench.ask(Request::Commit { upload }),
        Reply::Table(Some(info)) if info.crc32 == table.crc32()
    ));
}

#[test]
fn a_repeat_gets_the_stored_reply_and_does_nothing() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    bench.done(play(1, 5_000_000));
    let sequence = bench.sequence;
    bench.until(StateName::Playing, 2 * SECOND);
    let before = counters(&mut bench);
    assert_eq!(
        bench.send_request(sequence, play(1, 5_000_000)),
        Some(Reply::Refused(Refusal::Superseded {
            last: bench.sequence
        }))
    );
    bench.done(Request::Pause { detached: false });
    let pause = bench.sequence;
    bench.done(Request::Resume);
    let resume = bench.sequence;
    bench.run(SECOND);
    for _ in 0..3 {
        assert_eq!(
            bench.send_request(resume, Request::Resume),
            Some(Reply::Done)
        );
        let late = bench.send_request(pause, Request::Pause { detached: false });
        assert_eq!(
            late,
            Some(Reply::Refused(Refusal::Superseded { last: resume }))
        );
    }
    bench.tick();
    assert_eq!(bench.output.state, StateName::Playing);
    let after = counters(&mut bench);
    assert_eq!(
        (
            after.replayed - before.replayed,
            after.superseded - before.superseded
        ),
        (3, 4)
    );
}

#[test]
fn r10_duplicated_reordered_and_late_requests_act_at_most_once() {
    let mut random = ChaCha8Rng::seed_from_u64(10);
    let mut delivered = 0;
    for _ in 0..400 {
        let mut bench = Bench::new();
        let base: u16 = random.random();
        // Each request sets a different trim, which identifies the request that acted.
        let count = random.random_range(2..12_u16);
        let mut deliveries: Vec<u16> = (0..count)
            .flat_map(|index| vec![index; random.random_range(0..4)])
            .collect();
        // Reordered within a window; some arrive late.
        for start in (0..deliveries.len()).step_by(3) {
            let end = (start + 5).min(deliveries.len());
            deliveries[start..end].shuffle(&mut random);
        }
        let mut newest: Option<u16> = None;
        for &index in &deliveries {
            delivered += 1;
            let trim = i16::try_from(index).unwrap() + 1;
            let request = Request::Trim {
                joint: Joint::Front,
                trim,
            };
            let reply = bench
                .send_request(base.wrapping_add(index), request)
                .unwrap();
            let fresh = newest.is_none_or(|newest| index > newest);
            if fresh || newest == Some(index) {
                assert_eq!(reply, Reply::Done);
                newest = Some(index);
            } else {
                let last = base.wrapping_add(newest.unwrap());
                assert_eq!(reply, Reply::Refused(Refusal::Superseded { last }));
            }
        }
        let distinct = {
            let mut most = None;
            deliveries
                .iter()
                .filter(|&&index| {
                    most.is_none_or(|newest| index > newest) && {
                        most = Some(index);
                        true
                    }
                })
                .count()
        };
        bench.sequence = base.wrapping_add(count);
        // Except for the greeting and the status request, each acted once.
        assert_eq!(counters(&mut bench).acted as usize, distinct);
        let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Front)) else {
            panic!()
        };
        assert_eq!(
            servo.trim,
            newest.map_or(0, |newest| i16::try_from(newest).unwrap() + 1)
        );
    }
    println!("R10: {delivered} deliveries of 400 sessions, each request acted at most once");
}

#[test]
fn greetings_open_sessions_and_change_no_state() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    let first = bench.session;
    assert_eq!(bench.greet(1).session, first);
    let second = bench.greet(2);
    assert_eq!(
        (second.session, second.boot_nonce, second.buffer),
        (first + 1, 0xCAFE, 2048)
    );
    assert_eq!(second.schema_key, SCHEMA_KEY);
    bench.tick();
    assert_eq!(bench.output.state, StateName::Playing);
    // A delayed old greeting opens another session. The host is refused with StaleSession and greets again.
    assert_eq!(bench.greet(1).session, first + 2);
}

#[test]
fn a_host_of_another_version_is_told() {
    let mut bench = Bench::with(config());
    let hello = |min, current| {
        Message::Hello(Hello {
            protocol_min: min,
            protocol_current: current,
            schema_key: [0; 8],
            host_nonce: 5,
        })
    };
    for (min, current, opens) in [
        (0x11, 0x19, false),
        (0, 0, false),
        // Versions before the first release.
        (1, 2, false),
        (0x10, 0x10, true),
        (0x10, 0x19, true),
        (2, 0x10, true),
    ] {
        bench.send(
            Header {
                version: current,
                session: 0,
                sequence: 1,
            },
            &hello(min, current),
        );
        let Some((header, Message::HelloReply(reply))) = bench.others.pop() else {
            panic!()
        };
        assert_eq!(
            (header.version, reply.protocol_min, reply.protocol_current),
            (current, 0x10, 0x10)
        );
        assert_eq!(reply.session != 0, opens);
    }
    bench.send(
        Header {
            version: 3,
            session: 0x1000,
            sequence: 3,
        },
        &Message::Request(Request::Status),
    );
    assert_eq!(
        bench.replies.pop().unwrap().1,
        Reply::Refused(Refusal::Version {
            min: 0x10,
            current: 0x10
        })
    );
}

#[test]
fn requests_of_the_future_are_answered() {
    let mut bench = Bench::new();
    let mut frame = [0; MAX_ENCODED];
    let len = encode_body(
        Header::new(bench.session, 3),
        Kind::Request as u8,
        &[99],
        None,
        &mut frame,
    )
    .unwrap();
    bench
        .brain
        .receive(bench.now_us, Transport::Uart, &frame[..len]);
    bench.drain();
    assert_eq!(
        bench.replies.pop().unwrap(),
        (
            Header::new(bench.session, 3),
            Reply::Refused(Refusal::NotUnderstood)
        )
    );
}

#[test]
fn keep_alives_are_answered_with_the_robots_clock() {
    let mut bench = Bench::new();
    bench.others.clear();
    bench.send(
        Header::new(bench.session, 321),
        &Message::Heartbeat(Heartbeat {
            host_us: 77,
            heard_us: 0,
        }),
    );
    let pong = Pong {
        host_us: 77,
        received_us: bench.now_us,
        sent_us: bench.now_us,
    };
    assert_eq!(
        bench.others,
        [(Header::new(bench.session, 321), Message::Pong(pong))]
    );
}

#[test]
fn a_crash_message_waits_for_its_reader() {
    let mut config = config();
    config.boot.crash_message = heapless::String::try_from("panicked at 42").unwrap();
    let mut bench = Bench::with(config);
    assert!(bench.greet(1).crash_message);
    let told = heapless::String::try_from("panicked at 42").unwrap();
    assert_eq!(bench.ask(Request::CrashMessage), Reply::CrashMessage(told));
}
