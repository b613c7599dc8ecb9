//! Two transports to one robot, and the lease: only fresh keep-alives renew it.
use crate::bench;

use bench::*;
use gait_player::Transport::{Uart, Usb};
use gait_player::{Boot, Brain, BrainConfig};
use link_protocol::*;

/// Returns a robot that holds its pose, with a full lease of 460 ms.
fn holding() -> Bench {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    bench.run(SECOND);
    bench.keep_alive = false;
    bench
}

/// Time until the robot stops while `every_tick` runs, µs.
fn lives(bench: &mut Bench, mut every_tick: impl FnMut(&mut Bench)) -> u64 {
    let start = bench.now_us;
    while bench.output.state == StateName::Holding {
        assert!(bench.now_us - start < 5 * SECOND, "it never stops");
        every_tick(bench);
        bench.tick();
    }
    let took = bench.now_us - start;
    bench.run(100_000);
    assert_eq!(bench.telemetry.last().unwrap().cause, StopCause::LinkLost);
    took
}

type Way = Box<dyn FnMut(&mut Bench)>;

#[test]
fn r5_nothing_but_a_fresh_keep_alive_feeds_the_lease() {
    let asked = |bench: &mut Bench, request| {
        bench.sequence += 1;
        bench.send_request(bench.sequence, request);
    };
    let mut bench = holding();
    let ways: [Way; 5] = [
        Box::new(|_| {}),
        Box::new(move |bench| asked(bench, Request::Status)),
        Box::new(move |bench| asked(bench, ARM)),
        // Too old, and in the future.
        Box::new(|bench| bench.beat_that_heard(bench.now_us - 1_000_001)),
        Box::new(|bench| bench.beat_that_heard(bench.now_us + 1)),
    ];
    for (number, mut way) in ways.into_iter().enumerate() {
        let took = lives(&mut bench, &mut way);
        assert!(took <= 500_000, "way {number}: {took} µs");
        bench.until(StateName::Stopped, 2 * SECOND);
        bench.beat();
        bench.done(ARM);
        bench.tick();
    }
    // A recorded keep-alive: fresh for a second, and counted once.
    let heard = bench.now_us;
    let took = lives(&mut bench, |bench| bench.beat_that_heard(heard));
    assert!(took <= 500_000, "{took}");
}

#[test]
fn r5_a_dead_hosts_queue_feeds_the_lease_for_a_second_at_most() {
    let mut bench = holding();
    bench.greet(7);
    // All robot times up to the host's death, in steps of one microsecond, on an endless link.
    let died = bench.now_us;
    let mut heard = died - 10_000;
    let took = lives(&mut bench, |bench| {
        heard += 1;
        bench.beat_that_heard(heard);
    });
    println!(
        "R5: the ramp began {} ms after the host last heard the robot",
        took / 1000
    );
    assert!((1_400_000..=1_480_000).contains(&took), "{took}");
    // Its buffered requests have no effect.
    bench.until(StateName::Stopped, 2 * SECOND);
    for request in [ARM, play(1, 8_000_000), Request::Resume] {
        assert_eq!(bench.refused(request), Refusal::NotFresh);
    }
    assert_eq!(bench.tick().pulses_ns, None);
}

#[test]
fn r5_a_slow_but_living_link_is_no_silence() {
    let mut bench = holding();
    // A new session, because the previous one had less delay.
    bench.greet(7);
    // 200 ms each way, a lump of 160 ms, 100 ms between keep-alives.
    for tick in 0..1000_u64 {
        if tick % 5 == 0 {
            bench.beat_that_heard(bench.now_us - 660_000);
        }
        assert_eq!(bench.tick().state, StateName::Holding, "tick {tick}");
    }
}

#[test]
fn stops_of_any_version_act_and_are_answered_in_it() {
    for version in [0, 1, 2, 0x10, 0x11, 255] {
        for (request, state) in [
            // The robot is at neutral, where the ramp ends immediately.
            (Request::Stop, StateName::Settling),
            (Request::EStop, StateName::EStopped),
        ] {
            let mut bench = holding();
            let header = Header {
                version,
                session: 0xFFFF,
                sequence: 77,
            };
            bench.replies.clear();
            bench.send(header, &Message::Request(request));
            assert_eq!(bench.replies, [(header, Reply::Done)]);
            assert_eq!(bench.tick().state, state, "version {version}");
        }
    }
}

#[test]
fn whoever_greeted_last_holds_the_session_and_a_stop_is_answered_where_it_came() {
    let mut bench = holding();
    let sequence = bench.sequence;
    // The radio's session over the cable is foreign; only its stop acts.
    bench.via = Usb;
    let reply = bench.send_request(sequence + 1, Request::Status);
    assert_eq!(reply, Some(Reply::Refused(Refusal::StaleSession)));
    bench.beat();
    assert_eq!(bench.send_request(9, Request::Stop), Some(Reply::Done));
    assert_eq!(bench.tick().state, StateName::Settling);
    bench.via = Uart;
    bench.telemetry.clear();
    bench.run(SECOND);
    assert!(
        !bench.telemetry.is_empty(),
        "the radio still has the session"
    );
    // The cable greets: the motion continues; session and telemetry move to the cable.
    bench.via = Usb;
    bench.keep_alive = true;
    bench.greet(5);
    bench.done(ARM);
    bench.telemetry.clear();
    bench.run(SECOND);
    assert_eq!(bench.output.state, StateName::Holding);
    assert!(
        bench
            .telemetry
            .iter()
            .all(|told| told.flags.contains(Flags::PRESENT))
    );
    assert!(!bench.telemetry.is_empty());
    bench.via = Uart;
    let before = bench.telemetry.len();
    bench.keep_alive = false;
    bench.run(200_000);
    assert_eq!(
        bench.telemetry.len(),
        before,
        "telemetry on a way without a session"
    );
    // The radio takes the session back.
    bench.greet(6);
    bench.beat();
    bench.keep_alive = true;
    bench.run(SECOND);
    assert_eq!(bench.output.state, StateName::Holding);
}

#[test]
fn a_commits_answer_goes_where_it_was_asked_though_the_other_way_greets_meanwhile() {
    let mut bench = Bench::new();
    let upload = bench.send_table(&circle(1.2));
    bench.sequence += 1;
    assert_eq!(
        bench.send_request(bench.sequence, Request::Commit { upload }),
        None
    );
    let asked = (bench.session, bench.sequence);
    bench.via = Usb;
    bench.greet(5);
    bench.replies.clear();
    bench.keep_alive = false;
    for _ in 0..200 {
        bench.now_us += 20_000;
        bench.brain.tick(bench.now_us, &bench.inputs);
    }
    bench.via = Uart;
    bench.drain();
    let (header, reply) = bench.replies.pop().unwrap();
    assert_eq!((header.session, header.sequence), asked);
    assert!(matches!(reply, Reply::Table(Some(_))), "{reply:?}");
}

#[test]
fn answers_and_telemetry_of_a_robot_with_a_key_verify_and_count_up() {
    let key = Key(*b"not a secret key");
    let mut bench = Bench::with(config());
    bench.via = Usb;
    bench.greet(1);
    bench.done(Request::SetKey(Some(key)));
    let mut decoder = Decoder::new();
    let mut listen = |brain: &mut Brain| {
        let (mut bytes, mut all) = ([0; 640], Vec::new());
        let len = brain.transmit(Usb, &mut bytes);
        for &byte in &bytes[..len] {
            if let Some(received) = decoder.push(byte) {
                all.push((received, decoder.signed_bytes().to_vec()));
            }
        }
        all
    };
    let hello = Message::Hello(Hello {
        protocol_min: PROTOCOL_MIN,
        protocol_current: PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        host_nonce: 2,
    });
    let say = |bench: &mut Bench, header, message: &Message, seal: Option<&Seal>, counter| {
        let mut frame = [0; MAX_ENCODED];
        let len = match seal {
            Some(seal) => encode_signed(header, message, seal, counter, &mut frame),
            None => encode(header, message, &mut frame),
        };
        bench
            .brain
            .receive(bench.now_us, Usb, &frame[..len.unwrap()]);
    };
    say(&mut bench, Header::new(0, 1), &hello, None, 0);
    let (greeted, _) = listen(&mut bench.brain).pop().unwrap();
    let Ok(Message::HelloReply(reply)) = greeted.message else {
        panic!()
    };
    assert_eq!(greeted.signature, None);
    let seal = Seal::new(
        &key,
        Binding {
            boot_nonce: reply.boot_nonce,
            session: reply.session,
            host_nonce: 2,
        },
    );
    let status = Message::Request(Request::Status);
    for number in 1..20 {
        let header = Header::new(reply.session, number);
        say(&mut bench, header, &status, Some(&seal), u64::from(number));
        bench.now_us += 20_000;
        bench.brain.tick(bench.now_us, &bench.inputs);
    }
    let heard = listen(&mut bench.brain);
    assert!(heard.len() > 3);
    let mut last = 0;
    for (received, signed) in heard {
        assert_eq!(received.header.version, PROTOCOL_CURRENT);
        let signature = received.signature.expect("unsigned");
        assert!(seal.verifies(&signed, &signature), "{received:?}");
        assert!(signature.counter > last);
        last = signature.counter;
    }
    // A refusal of a foreign frame is unsigned, because its sender could not verify a signature.
    say(&mut bench, Header::new(reply.session, 99), &status, None, 0);
    let (refused, _) = listen(&mut bench.brain).pop().unwrap();
    assert_eq!(refused.signature, None);
    assert_eq!(
        refused.message,
        Ok(Message::Reply(Reply::Refused(Refusal::KeyNeeded)))
    );
    // The same for a stop from outside the session.
    let outside = Header::new(0xFFFF, 7);
    let stop = Message::Request(Request::Stop);
    say(&mut bench, outside, &stop, None, 0);
    let (stopped, _) = listen(&mut bench.brain).pop().unwrap();
    assert_eq!(
        (stopped.header, stopped.message),
        (outside, Ok(Message::Reply(Reply::Done)))
    );
    assert_eq!(stopped.signature, None);
}

/// Without storage, the count of starts comes from the RAM, or begins at one.
#[test]
fn a_start_without_storage_is_the_first_short_one() {
    let brain = Brain::new(BrainConfig::robot(IDENTITY, Boot::power_on(1, 1)));
    assert_eq!(Bench::around(brain).tick().starts.runs, 1);
}
