//! Robot with a shared key: only frames signed for its session act, each once. Stops always act.
use crate::bench;

use bench::*;
use gait_player::storage::MemoryStorage;
use gait_player::{Boot, Brain, BrainConfig, Transport};
use link_protocol::*;

const KEY: Key = Key(*b"sixteen letters!");

/// Host with a key, and an adversary's recording of its frames.
struct Host {
    bench: Bench,
    seal: Seal,
    counter: u64,
    recorded: Vec<Vec<u8>>,
}

impl Host {
    /// Returns a greeted robot with a key and a table.
    fn new() -> Self {
        let mut bench = Bench::new();
        bench.upload(&circle(1.2));
        bench.come_near();
        bench.done(Request::SetKey(Some(KEY)));
        Self::greet(bench, &KEY, 9)
    }

    fn greet(mut bench: Bench, key: &Key, host_nonce: u32) -> Self {
        bench.keep_alive = false;
        let reply = bench.greet(host_nonce);
        let binding = Binding {
            boot_nonce: reply.boot_nonce,
            session: reply.session,
            host_nonce,
        };
        Self {
            seal: Seal::new(key, binding),
            counter: 0,
            recorded: Vec::new(),
            bench,
        }
    }

    fn say(&mut self, sequence: u16, message: &Message) {
        self.counter += 1;
        let mut frame = [0; MAX_ENCODED];
        let header = Header::new(self.bench.session, sequence);
        let len = encode_signed(header, message, &self.seal, self.counter, &mut frame).unwrap();
        self.recorded.push(frame[..len].to_vec());
        self.bench
            .brain
            .receive(self.bench.now_us, Transport::Uart, &frame[..len]);
        self.bench.drain();
    }

    fn ask(&mut self, request: Request) -> Reply {
        if request.class(|| true).needs().freshness {
            self.beat();
        }
        let before = self.bench.replies.len();
        self.bench.sequence = self.bench.sequence.wrapping_add(1);
        let request = self.bench.filled_in(request);
        self.say(self.bench.sequence, &Message::Request(request));
        for _ in 0..200 {
            if let Some((_, reply)) = self.bench.replies.get(before) {
                return reply.clone();
            }
            self.run(TICK);
        }
        panic!("no reply within 4 s");
    }

    fn beat(&mut self) {
        let heartbeat = Heartbeat {
            host_us: 0,
            heard_us: self.bench.now_us,
        };
        self.say(0, &Message::Heartbeat(heartbeat));
    }

    /// Runs ticks with signed keep-alives.
    fn run(&mut self, us: u64) {
        for tick in 0..us / TICK {
            if tick % 2 == 0 {
                self.beat();
            }
            self.bench.tick();
        }
    }

    fn state(&self) -> StateName {
        self.bench.output.state
    }
}

const TICK: u64 = gait_player::TICK_US as u64;

#[test]
fn what_is_signed_acts_and_what_is_not_is_refused_with_advice() {
    let mut host = Host::new();
    assert_eq!(host.ask(ARM), Reply::Done);
    host.run(SECOND);
    assert_eq!(host.state(), StateName::Holding);
    for request in [
        ARM,
        play(1, 5_000_000),
        Request::Status,
        Request::SetKey(None),
    ] {
        assert_eq!(host.bench.refused(request), Refusal::KeyNeeded);
    }
    // Signed keep-alives came for a second, so the link is alive; unsigned ones do not renew the lease.
    host.bench.keep_alive = true;
    host.bench.run(SECOND);
    assert_eq!(
        host.bench.telemetry.last().unwrap().cause,
        StopCause::LinkLost
    );
    let Reply::Counters(counters) = host.ask(Request::Counters) else {
        panic!()
    };
    // Four requests and 25 keep-alives.
    assert_eq!(counters.stale, 29);
}

#[test]
fn stops_need_no_signature_and_take_no_place() {
    for (stop, state) in [
        (Request::Stop, StateName::Stopping),
        (Request::EStop, StateName::EStopped),
    ] {
        let mut host = Host::new();
        assert_eq!(host.ask(ARM), Reply::Done);
        assert_eq!(host.ask(play(0, 5_000_000)), Reply::Done);
        host.run(2 * SECOND);
        assert_eq!(host.state(), StateName::Playing);
        // A number far ahead does not affect the next request of the host.
        let header = Header::new(host.bench.session, host.bench.sequence + 1000);
        host.bench.send(header, &Message::Request(stop));
        host.bench.tick();
        assert_eq!(host.state(), state);
        assert!(matches!(host.ask(Request::Status), Reply::Status(_)));
    }
}

#[test]
fn another_key_is_told_to_be_wrong() {
    let host = Host::new();
    let mut stranger = Host::greet(host.bench, &Key([0; 16]), 10);
    for request in [ARM, Request::Status, Request::SetKey(None)] {
        assert_eq!(stranger.ask(request), Reply::Refused(Refusal::WrongKey));
    }
    assert_eq!(stranger.ask(Request::Stop), Reply::Done);
}

/// Replays the whole recording: in the same session, in a later one, after a reset.
#[test]
fn a_recording_moves_nothing() {
    let mut host = Host::new();
    assert_eq!(host.ask(ARM), Reply::Done);
    assert_eq!(host.ask(play(0, 5_000_000)), Reply::Done);
    host.run(3 * SECOND);
    assert_eq!(host.ask(Request::Stop), Reply::Done);
    host.run(3 * SECOND);
    assert_eq!(host.state(), StateName::Stopped);
    let recorded = host.recorded.clone();
    assert!(recorded.len() > 100);
    let mut bench = host.bench;
    let mut stored = MemoryStorage::erased();
    bench
        .brain
        .serve_storage(bench.now_us, &mut stored)
        .unwrap();
    for round in 0..3 {
        if round == 1 {
            bench.greet(77);
        }
        if round == 2 {
            // A reset with another nonce, but the same session numbers.
            let boot = Boot::power_on(0xBEEF, bench.session);
            let mut brain = Brain::new(BrainConfig::robot(IDENTITY, boot));
            brain.load(&mut stored).unwrap();
            bench = Bench::around(brain);
            let reply = bench.greet(9);
            assert_eq!(reply.session, bench.session);
        }
        for frame in &recorded {
            bench.brain.receive(bench.now_us, Transport::Uart, frame);
            bench.tick();
            assert_eq!(bench.output.pulses_ns, None, "round {round}");
            assert_eq!(bench.output.state, StateName::Stopped, "round {round}");
        }
    }
}

#[test]
fn a_key_is_set_only_while_stopped_and_changed_only_with_the_old_one() {
    let mut bench = Bench::new();
    bench.done(ARM);
    let refused = bench.refused(Request::SetKey(Some(KEY)));
    assert_eq!(refused, Refusal::WrongState(StateName::Holding));
    let mut host = Host::new();
    let new = Key([5; 16]);
    assert_eq!(host.ask(Request::SetKey(Some(new))), Reply::Done);
    let mut host = Host::greet(host.bench, &new, 11);
    assert_eq!(host.ask(Request::SetKey(None)), Reply::Done);
    // Without a key, signatures are skipped.
    let mut host = Host::greet(host.bench, &KEY, 12);
    assert_eq!(host.ask(ARM), Reply::Done);
    assert!(!host.bench.status().flags.contains(Flags::KEY_SET));
}

#[test]
fn a_key_outlives_a_power_cut_and_limits_that_have_changed() {
    let mut memory = MemoryStorage::erased();
    let mut bench = Bench::new();
    bench.done(Request::SetServo {
        joint: Joint::Front,
        settings: config().servos[0],
    });
    bench.run(SECOND);
    bench
        .brain
        .serve_storage(bench.now_us, &mut memory)
        .unwrap();
    let before = memory.settings.clone().unwrap();
    bench.come_near();
    bench.done(Request::SetKey(Some(KEY)));
    bench.run(SECOND);
    bench
        .brain
        .serve_storage(bench.now_us, &mut memory)
        .unwrap();
    for max_angle in [2.8, 1.0] {
        let mut config = config();
        config.limits.max_angle = max_angle;
        let mut brain = Brain::new(config);
        brain.load(&mut memory).unwrap();
        let mut bench = Bench::around(brain);
        bench.greet(3);
        assert_eq!(bench.refused(ARM), Refusal::KeyNeeded, "{max_angle}");
    }
    memory.settings = Some(before);
    let mut brain = Brain::new(config());
    brain.load(&mut memory).unwrap();
    let mut bench = Bench::around(brain);
    bench.greet(3);
    bench.done(ARM);
}

/// Attack: the session in which a key was set, and the number of the open one, are useless to a stranger.
#[test]
fn setting_a_key_closes_the_session() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.come_near();
    bench.done(Request::SetKey(Some(KEY)));
    let (session, number) = (bench.session, bench.sequence);
    for request in [
        ARM,
        Request::Status,
        Request::SetKey(Some(KEY)),
        Request::SetKey(Some(Key([1; 16]))),
        Request::SetKey(None),
    ] {
        assert_eq!(bench.refused(request), Refusal::StaleSession);
    }
    for other in [0, session.wrapping_add(1), session.wrapping_sub(1)] {
        bench.session = other;
        assert_eq!(bench.refused(Request::Status), Refusal::StaleSession);
    }
    bench.session = session;
    // The reply was lost, and the host repeats the request; another key under that number is another request.
    let again = |key| Request::SetKey(key);
    let reply = bench.send_request(number, again(Some(KEY)));
    assert_eq!(reply, Some(Reply::Done));
    for other in [None, Some(Key([1; 16]))] {
        let reply = bench.send_request(number, again(other));
        assert_eq!(reply, Some(Reply::Refused(Refusal::StaleSession)));
    }
    // No lease and no telemetry, but a stop acts.
    bench.telemetry.clear();
    bench.run(SECOND);
    assert!(bench.telemetry.is_empty());
    assert_eq!(bench.ask(Request::Stop), Reply::Done);
    // The same greeting opens a session that requires the key.
    let reply = bench.greet(1);
    assert_ne!(reply.session, session);
    assert_eq!(bench.refused(Request::Status), Refusal::KeyNeeded);
    let mut host = Host::greet(bench, &KEY, 3);
    assert_eq!(host.ask(ARM), Reply::Done);
}

/// A closed signed session repeats its last reply, signed with the key that the session began with.
#[test]
fn the_repeat_in_a_closed_session_is_signed_with_its_own_key() {
    let mut host = Host::new();
    assert_eq!(host.ask(Request::SetKey(None)), Reply::Done);
    let again = Message::Request(Request::SetKey(None));
    host.bench.replies.clear();
    host.say(host.bench.sequence, &again);
    assert_eq!(
        host.bench.replies.pop().map(|(_, reply)| reply),
        Some(Reply::Done)
    );
    // An unsigned frame belongs to no session.
    let (header, none) = (
        Header::new(host.bench.session, host.bench.sequence),
        Message::Request(Request::SetKey(None)),
    );
    host.bench.send(header, &none);
    assert_eq!(
        host.bench.replies.pop().map(|(_, reply)| reply),
        Some(Reply::Refused(Refusal::KeyNeeded))
    );
}
