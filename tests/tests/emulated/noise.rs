//! R1 and R4 on the whole image: whatever frames come, no reset, no pulse outside the window, and Stop still works.

use std::time::Duration;

use emulator::{Board, BoardLine};
use gait_player::Limits;
use link_protocol::{DecodeCounters, Decoder, Message, Reply, Request, StateName, Status};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::frames::{Frames, encoded};
use crate::promise::{seen, seen_in_soak};
use crate::rig::{self, Image};

/// Frames that go to the board at once; they take about a tenth of a second on the line.
const BATCH: usize = 64;
/// Batches between greetings, since noise may have opened a session or used up numbers.
const GREETED_EVERY: usize = 4;
/// Batches between stops.
const STOPPED_EVERY: usize = 128;
const MS: Duration = Duration::from_millis(1);
/// Sequence number of the stops, by which their answers are known.
const STOP_NUMBER: u16 = 0x5709;
/// A character at 115 200 baud.
const BYTE: Duration = Duration::from_nanos(86_806);

#[test]
fn a_few_thousand_frames_of_noise_do_no_harm() {
    noise(4_000, 11, seen);
}

// A million in two halves, which two cores can take side by side.

#[test]
#[ignore = "half a million frames on the emulated UART: ten minutes"]
fn half_a_million_frames_of_noise_do_no_harm() {
    noise(500_000, 11, seen_in_soak);
}

#[test]
#[ignore = "half a million frames on the emulated UART: ten minutes"]
fn another_half_million_frames_of_noise_do_no_harm() {
    noise(500_000, 12, seen_in_soak);
}

/// Counts of the test.
#[derive(Default)]
struct Tally {
    bytes: usize,
    periods: usize,
    powered: usize,
    shortest_us: f64,
    longest_us: f64,
    stops: usize,
    /// Stops that were sent again, because the first came while flash was erased and no byte was received.
    again: usize,
}

struct Storm {
    board: Board,
    decoder: Decoder,
    frames: Frames,
    status: Option<Status>,
    stop_answered: bool,
    /// Bytes that the board has lost since it was switched on.
    lost: u64,
    /// The robot's counters since it was switched on: requests that acted, frames dropped for lack of buffer space.
    acted: u32,
    dropped: u32,
    /// Frames as the robot counts them, and as a decoder here does that takes the same bytes.
    frames_there: DecodeCounters,
    mirror: Decoder,
    tally: Tally,
}

/// Sends `count` frames; reports the counts at each tenth and at the end.
fn noise(count: usize, seed: u64, tell: fn(&str, &str)) {
    let board = rig::board(Image::Nano);
    let mut storm = Storm {
        board,
        decoder: Decoder::new(),
        frames: Frames::new(ChaCha8Rng::seed_from_u64(seed)),
        status: None,
        stop_answered: false,
        lost: 0,
        acted: 0,
        dropped: 0,
        frames_there: DecodeCounters::default(),
        mirror: Decoder::new(),
        tally: Tally {
            shortest_us: f64::INFINITY,
            ..Tally::default()
        },
    };
    storm.board.set_connected(true).unwrap();
    storm.live(100 * MS);
    let batches = count.div_ceil(BATCH);
    for batch in 0..batches {
        if batch % GREETED_EVERY == 0 {
            let hello = storm.frames.hello();
            storm.send(&hello);
            storm.live(10 * MS); // its answer has the session number
        }
        let bytes: Vec<u8> = (0..BATCH).flat_map(|_| storm.frames.next()).collect();
        storm.tally.bytes += bytes.len();
        storm.send(&bytes);
        if batch % STOPPED_EVERY == STOPPED_EVERY - 1 {
            storm.stop();
        }
        if batch % (batches / 10) == batches / 10 - 1 {
            println!(
                "{} frames: {}; {} answers found no room to leave",
                (batch + 1) * BATCH,
                storm.told(),
                storm.dropped
            );
        }
    }
    storm.stop();
    assert!(
        storm.tally.powered * 10 > storm.tally.periods,
        "{}",
        storm.told()
    );
    let bytes = storm.tally.bytes;
    tell(
        &format!(
            "R1, R4: {count} frames (seed {seed}), mutated, random in a whole frame, or valid"
        ),
        &format!("{bytes} bytes; {}", storm.told()),
    );
}

impl Storm {
    /// The counts so far, in words.
    fn told(&self) -> String {
        let Tally {
            periods,
            powered,
            shortest_us,
            longest_us,
            stops,
            again,
            ..
        } = self.tally;
        assert_eq!(
            self.decoder.counters().bad(),
            0,
            "the robot sent broken frames"
        );
        format!(
            "no reset; {} requests acted; pulses on in {:.0} % of {periods} periods, all between {shortest_us:.0} and \
             {longest_us:.0} µs; Stop answered and obeyed {stops} times of {stops}, {again} of them at the second sending",
            self.acted,
            100.0 * powered as f64 / periods as f64,
        )
    }

    /// Sends bytes and lives until they have arrived.
    fn send(&mut self, bytes: &[u8]) {
        self.board.feed(bytes).unwrap();
        for &byte in bytes {
            self.mirror.push(byte);
        }
        self.live(BYTE * u32::try_from(bytes.len() + 4).unwrap());
    }

    fn live(&mut self, time: Duration) {
        let until = self.board.now() + time;
        self.board.run(until).unwrap();
        let events = self.board.take_events();
        assert!(events.resets.is_empty(), "reset: {:?}", events.resets);
        self.lost = events.lost;
        let window =
            [Limits::ROBOT.pulse_min_ns, Limits::ROBOT.pulse_max_ns].map(|ns| f64::from(ns) * 1e-3);
        for period in &events.periods {
            self.tally.periods += 1;
            // Both or none.
            let [front, back] = period.pulses_us();
            assert_eq!(front > 0.0, back > 0.0, "{period:?}");
            if !period.powered() {
                continue;
            }
            self.tally.powered += 1;
            for us in [front, back] {
                // Half a step of the counter.
                assert!(us >= window[0] - 0.16 && us <= window[1] + 0.16, "{us} µs");
                self.tally.shortest_us = self.tally.shortest_us.min(us);
                self.tally.longest_us = self.tally.longest_us.max(us);
            }
        }
        let mut bytes = Vec::new();
        let now = self.board.now();
        self.board
            .take_sent(BoardLine::Uart, now, usize::MAX, &mut bytes);
        for byte in bytes {
            if let Some(received) = self.decoder.push(byte) {
                let header = received.header;
                self.stop_answered |= header.session == 0 && header.sequence == STOP_NUMBER;
                self.hear(&received.message.expect("a whole message"));
            }
        }
    }

    fn hear(&mut self, message: &Message) {
        match message {
            Message::HelloReply(reply) if reply.session != 0 => self.frames.greeted(reply.session),
            Message::Telemetry(telemetry) => self.frames.heard(telemetry.robot_us),
            Message::Reply(Reply::Status(status)) => {
                self.frames.reported(status);
                self.status = Some(*status);
            }
            Message::Reply(Reply::Wanted { upload, .. }) => self.frames.upload(*upload),
            Message::Reply(Reply::Counters(counters)) => {
                (self.acted, self.dropped) = (counters.acted, counters.dropped);
                self.frames_there = counters.frames;
            }
            _ => {}
        }
    }

    /// Lives until a Stop is answered: in a tick, or, while sectors are erased (pulses are off then), a few times 45 ms later.
    fn await_stop(&mut self) {
        for _ in 0..10 {
            self.live(20 * MS);
            if self.stop_answered {
                return;
            }
        }
    }

    /// Stop, of no session at all: within a tick the robot is on its way, and the pulses go in time.
    fn stop(&mut self) {
        self.stop_answered = false;
        let (stop, lost) = (Message::Request(Request::Stop), self.lost);
        self.send(&encoded(0, STOP_NUMBER, &stop));
        self.await_stop();
        if !self.stop_answered {
            assert!(
                self.lost > lost,
                "no answer to a Stop that was heard: {}",
                self.told()
            );
            self.tally.again += 1;
            self.send(&encoded(0, STOP_NUMBER, &stop));
            self.await_stop();
            assert!(self.stop_answered, "no answer to the second Stop");
        }
        let hello = self.frames.hello();
        self.send(&hello);
        self.live(20 * MS);
        self.status = None;
        let asked =
            [Request::Status, Request::Counters].map(|request| self.frames.request(request));
        self.send(&asked.concat());
        self.live(20 * MS);
        if self.lost == 0 {
            assert_eq!(
                self.frames_there,
                self.mirror.counters(),
                "the robot saw other bytes than were sent"
            );
        }
        let state = self
            .status
            .as_ref()
            .expect("no answer after the noise")
            .state;
        let stopped = matches!(
            state,
            StateName::Stopped | StateName::EStopped | StateName::Stopping | StateName::Settling
        );
        assert!(stopped, "{state:?} after a Stop");
        self.live(1_600 * MS);
        let before = self.tally.powered;
        self.live(100 * MS);
        assert_eq!(self.tally.powered, before, "pulses 1.6 s after a Stop");
        self.tally.stops += 1;
    }
}
