//! Matching of replies to requests: replies of newer firmware, replies of another session that a Bluetooth module held back,
//! and requests that an earlier session may have executed.

use crate::scripted;

use host_link::session::Ticket;
use link_protocol::{
    Board, Checked, Header, HelloReply, Kind, Message, PROTOCOL_CURRENT, Play, Refusal, Reply,
    Request,
};
use scripted::{MS, SESSION, Script, body};

const TABLE: [u8; 400] = [3; 400];

fn play() -> Request {
    Request::Play(Play {
        cycles: 1,
        period_us: 5_000_000,
        detached: false,
        checked: Checked {
            table_crc32: 1,
            settings_crc32: 2,
        },
    })
}

/// A refusal that was appended after this program was built.
fn newer_refusal() -> Vec<u8> {
    let mut refusal = body(&Message::Reply(Reply::Refused(Refusal::NotUnderstood)));
    *refusal.last_mut().unwrap() = 120;
    refusal
}

/// A greeting's reply with a board that was appended after this program was built.
fn newer_board(reply: HelloReply) -> Vec<u8> {
    let of = |board| body(&Message::HelloReply(HelloReply { board, ..reply }));
    let (mut answer, other) = (of(Board::Twin), of(Board::Pico));
    let place = answer.iter().zip(&other).position(|(a, b)| a != b);
    answer[place.unwrap()] = 120;
    answer
}

fn error(script: &Script, ticket: Ticket) -> String {
    script.outcome(ticket).unwrap().unwrap_err()
}

#[test]
fn an_answer_that_this_program_does_not_know_fails_its_request_at_once() {
    let done = body(&Message::Reply(Reply::Done));
    let longer = [&done[..], &[1]].concat();
    for (version, answer) in [
        (PROTOCOL_CURRENT, newer_refusal()),
        (PROTOCOL_CURRENT, longer),
        (PROTOCOL_CURRENT + 1, body(&Message::Reply(Reply::Working))),
    ] {
        let mut script = Script::open(MS * 10);
        let asked = script.session.request(script.now, Request::Status);
        let next = script.session.request(script.now, Request::Table);
        script.collect();
        let header = Header {
            version,
            ..Header::new(SESSION, script.last_request().1)
        };
        script.say_body(header, Kind::Reply, &answer);
        let error = error(&script, asked);
        assert!(
            error.contains("asking for the status") && error.contains("update this program"),
            "{error}"
        );
        // The session continues.
        assert!(matches!(script.last_request().2, Request::Table));
        script.reply(Reply::Done);
        assert_eq!(script.outcome(next), Some(Ok(())));
    }
}

#[test]
fn a_frame_that_this_program_does_not_know_fails_nothing_that_it_does_not_answer() {
    let mut script = Script::open(MS * 10);
    let asked = script.session.request(script.now, Request::Status);
    script.collect();
    let sequence = script.last_request().1;
    for (session, sequence, kind) in [
        (SESSION + 1, sequence, Kind::Reply),
        (SESSION, sequence.wrapping_sub(1), Kind::Reply),
        (SESSION, sequence, Kind::Telemetry),
        (SESSION, sequence, Kind::HelloReply),
        (SESSION, sequence, Kind::Request),
    ] {
        script.say_body(Header::new(session, sequence), kind, &newer_refusal());
    }
    assert_eq!(script.session.counters().received.bad(), 5);
    assert_eq!(script.outcome(asked), None);
    script.reply(Reply::Done);
    assert_eq!(script.outcome(asked), Some(Ok(())));
}

#[test]
fn an_upload_ends_at_once_at_an_answer_that_this_program_does_not_know() {
    for at_a_chunk in [false, true] {
        let mut script = Script::open(MS * 10);
        let upload = script.session.upload(script.now, 0, &TABLE, MS * 60_000);
        script.collect();
        if at_a_chunk {
            let begin = script.last_request().1;
            script.reply(Reply::Wanted {
                upload: begin,
                offset: 0,
            });
            assert!(matches!(script.last_request().2, Request::Chunk(_)));
        }
        let answered = Header::new(SESSION, script.last_request().1);
        script.say_body(answered, Kind::Reply, &newer_refusal());
        let error = error(&script, upload);
        assert!(
            error.contains("uploading the gait") && error.contains("update this program"),
            "{error}"
        );
    }
}

#[test]
fn a_greeting_answered_by_an_unknown_board_names_the_firmware() {
    let mut script = Script::new();
    let connecting = script.session.connect(script.now);
    script.collect();
    let (sequence, reply) = script.greeting();
    // Neither a delayed reply to another host's greeting, nor one under another number.
    let mut held = reply;
    held.host_nonce ^= 1;
    let header = |sequence| Header::new(SESSION, sequence);
    script.say_body(header(sequence), Kind::HelloReply, &newer_board(held));
    let other = header(sequence.wrapping_sub(1));
    script.say_body(other, Kind::HelloReply, &newer_board(reply));
    assert_eq!(script.outcome(connecting), None);
    script.say_body(header(sequence), Kind::HelloReply, &newer_board(reply));
    let newer = error(&script, connecting);
    assert!(
        newer.contains("1.2.3 (0123abcd)") && newer.contains("update this program"),
        "{newer}"
    );
    assert!(script.session.hello().is_none());
    // If the versions are incompatible too, that is the reported reason.
    let connecting = script.session.connect(script.now);
    script.collect();
    let (sequence, mut reply) = script.greeting();
    (reply.protocol_min, reply.protocol_current) = (0x30, 0x41);
    script.say_body(header(sequence), Kind::HelloReply, &newer_board(reply));
    let version = error(&script, connecting);
    assert!(version.contains("versions 3.0 to 4.1"), "{version}");
}

#[test]
fn an_upload_that_greets_an_unknown_board_says_so() {
    let mut script = Script::open(MS * 10);
    let upload = script.session.upload(script.now, 0, &TABLE, MS * 60_000);
    script.collect();
    script.reply(Reply::Refused(Refusal::StaleSession));
    let (sequence, reply) = script.greeting();
    let header = Header::new(9, sequence);
    script.say_body(header, Kind::HelloReply, &newer_board(reply));
    let error = error(&script, upload);
    assert!(error.contains("1.2.3 (0123abcd)"), "{error}");
}

#[test]
fn a_stop_goes_on_past_an_answer_that_this_program_does_not_know() {
    let mut script = Script::new();
    let stop = script.session.request(script.now, Request::Stop);
    script.collect();
    let header = Header::new(0, script.last_request().1);
    script.say_body(header, Kind::Reply, &newer_refusal());
    assert_eq!(script.outcome(stop), None);
    script.run_to(MS * 10_000);
    assert!(script.requests().len() >= 5);
    let error = error(&script, stop);
    assert!(
        error.contains("no answer") && error.contains("update this program"),
        "{error}"
    );
}

#[test]
fn a_stop_goes_on_past_such_an_answer_in_an_open_session_too() {
    let mut script = Script::open(MS * 10);
    let stop = script.session.request(script.now, Request::EStop);
    script.collect();
    let header = Header::new(SESSION, script.last_request().1);
    script.say_body(header, Kind::Reply, &newer_refusal());
    assert_eq!(script.outcome(stop), None);
    script.run_to(MS * 1_000);
    assert!(script.requests().len() >= 5);
    script.reply(Reply::Done);
    assert_eq!(script.outcome(stop), Some(Ok(())));
}

#[test]
fn a_stop_sent_while_greeting_goes_on_in_the_new_session() {
    let mut script = Script::new();
    script.session.connect(script.now);
    script.collect();
    let stop = script.session.request(script.now, Request::Stop);
    script.collect();
    script.greet(|_| {});
    assert_eq!(script.outcome(stop), None);
    script.sent.clear();
    script.run_to(MS * 1_000);
    assert!(script.requests().len() >= 4);
    script.reply(Reply::Done);
    assert_eq!(script.outcome(stop), Some(Ok(())));
}

#[test]
fn only_done_is_the_answer_to_a_stop() {
    for (request, session) in [
        (Request::Stop, SESSION),
        (Request::EStop, SESSION),
        (Request::Stop, SESSION + 1),
    ] {
        let mut script = Script::open(MS * 10);
        let stop = script.session.request(script.now, request);
        script.collect();
        let sequence = script.last_request().1;
        for stale in [
            Reply::Table(None),
            Reply::Working,
            Reply::Refused(Refusal::StaleSession),
            Reply::Refused(Refusal::Busy),
        ] {
            script.say(session, sequence, &Message::Reply(stale));
        }
        assert_eq!(script.outcome(stop), None);
        let before = script.requests().len();
        script.run_to(MS * 1_000);
        assert!(script.requests().len() >= before + 4, "it is sent again");
        script.say(session, sequence, &Message::Reply(Reply::Done));
        assert_eq!(script.outcome(stop), Some(Ok(())));
    }
}

/// Returns an upload with a chunk in flight and a play in progress at the robot; another host's greeting makes both stale, and
/// the session greets again.
fn taken_over_at_work() -> (Script, Ticket, Ticket) {
    let mut script = Script::open(MS * 10);
    let upload = script.session.upload(script.now, 0, &TABLE, MS * 60_000);
    script.collect();
    let begin = script.last_request().1;
    script.reply(Reply::Wanted {
        upload: begin,
        offset: 0,
    });
    let (_, chunk, request) = script.last_request();
    assert!(matches!(request, Request::Chunk(_)));
    let playing = script.session.request(script.now, play());
    script.collect();
    assert!(matches!(script.last_request().2, Request::Play(_)));
    script.reply(Reply::Working);
    script.sent.clear();
    let stale = Reply::Refused(Refusal::StaleSession);
    script.say(SESSION, chunk, &Message::Reply(stale));
    (script, upload, playing)
}

#[test]
fn what_the_robot_worked_at_is_not_asked_again_in_another_session() {
    let (mut script, upload, playing) = taken_over_at_work();
    script.greet(|reply| reply.session = 41);
    let lost = error(&script, playing);
    assert!(
        lost.contains("starting to play") && lost.contains("another session"),
        "{lost}"
    );
    script.run_to(MS * 2_000);
    let again = |(.., request): &(_, _, Request)| matches!(request, Request::Play(_));
    assert!(!script.requests().iter().any(again));
    // The upload continues.
    assert!(matches!(script.last_request().2, Request::Begin(_)));
    assert_eq!(script.outcome(upload), None);
}

#[test]
fn a_session_that_greets_sleeps_until_the_greeting_is_due() {
    let (mut script, ..) = taken_over_at_work();
    // Past the next attempt of the play: run_to asserts that deadlines advance.
    script.run_to(MS * 3_000);
    let next = script.session.next_deadline().unwrap();
    assert!(next > script.now, "{next:?}");
    let greetings = script.sent.len();
    assert!((3..10).contains(&greetings), "{greetings}");
}
