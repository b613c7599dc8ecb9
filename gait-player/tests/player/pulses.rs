//! Promise R4 for the whole brain: for any input from link, storage or clock, no pulse leaves the window, and no step exceeds
//! the slew limit while pulses are on.
use crate::bench;

use bench::*;
use gait_player::storage::{MAX_SETTINGS, PAGE, Storage};
use gait_player::{Brain, Inputs, Limits, Output, ShortStarts, Transport};
use link_protocol::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Checks the pulses of every tick against the limits.
struct Witness {
    last: Option<[u32; 2]>,
    powered: u64,
}

impl Witness {
    fn new() -> Self {
        Self {
            last: None,
            powered: 0,
        }
    }

    fn see(&mut self, output: &Output, limits: &Limits) {
        if let (Some(last), Some(pulses)) = (self.last, output.pulses_ns) {
            for joint in 0..2 {
                // The slope as built, at most a tenth flatter; not the configured slope.
                let step = f64::from(limits.max_rate) * 0.02 / (0.9 * 0.0274) * 1000.0;
                let moved = f64::from(pulses[joint].abs_diff(last[joint]));
                assert!(moved <= step.ceil(), "step of {moved} ns, {step} allowed");
            }
        }
        if let Some(pulses) = output.pulses_ns {
            self.powered += 1;
            let window = limits.pulse_min_ns..=limits.pulse_max_ns;
            assert!(
                pulses.iter().all(|pulse| window.contains(pulse)),
                "{pulses:?}"
            );
        }
        self.last = output.pulses_ns;
    }
}

/// Values of a broken host or flash: valid, extreme, or NaN.
fn wild(random: &mut ChaCha8Rng, good: f32) -> f32 {
    match random.random_range(0..8) {
        0 => f32::from_bits(random.random()),
        1 => [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            0.0,
            -good,
            f32::MIN_POSITIVE,
        ][random.random_range(0..6)],
        2 => good * random.random_range(0.01..20.0),
        3 => good * random.random_range(0.7..1.0),
        _ => good,
    }
}

fn configuration(random: &mut ChaCha8Rng) -> Configuration {
    Configuration {
        middle_m: wild(random, 0.071),
        front_m: wild(random, 0.137),
        back_m: wild(random, 0.137),
        chi: wild(random, 3.0),
        tangential_drag: match random.random_range(0..3) {
            0 => TangentialDrag::LogAspect(wild(random, 4.5)),
            1 => TangentialDrag::HalfThickness(wild(random, 0.0025)),
            _ => TangentialDrag::OverViscosity(wild(random, 1.4)),
        },
        sphere_radius_m: wild(random, 0.07),
        max_angle: wild(random, 2.8),
        max_rate: wild(random, 3.5),
    }
}

fn servo(random: &mut ChaCha8Rng) -> ServoSettings {
    ServoSettings {
        centre_ns: match random.random_range(0..4) {
            0 => random.random(),
            1 => random.random_range(1_475_000..1_525_000),
            _ => 1_500_000,
        },
        slope_rad_per_us: wild(random, 0.0274),
        reversed: random.random(),
        trim: if random.random() { 0 } else { random.random() },
    }
}

/// Storage with another robot's content.
struct WildStorage {
    random: ChaCha8Rng,
    settings: Vec<u8>,
}

impl WildStorage {
    fn new(mut random: ChaCha8Rng) -> Self {
        let settings = if random.random_ratio(1, 3) {
            (0..random.random_range(0..MAX_SETTINGS))
                .map(|_| random.random())
                .collect()
        } else {
            let record = (
                configuration(&mut random),
                [servo(&mut random), servo(&mut random)],
            );
            postcard::to_slice(&record, &mut [0; 200]).unwrap().to_vec()
        };
        Self { random, settings }
    }
}

impl Storage for WildStorage {
    type Error = ();

    fn read(&mut self, _slot: usize, _offset: usize, bytes: &mut [u8]) -> Result<(), ()> {
        self.random.fill(bytes);
        if self.random.random_ratio(1, 10) {
            Err(())
        } else {
            Ok(())
        }
    }

    fn erase(&mut self, _slot: usize) -> Result<(), ()> {
        if self.random.random_ratio(1, 4) {
            Err(())
        } else {
            Ok(())
        }
    }

    fn program(&mut self, _slot: usize, _page: usize, _bytes: &[u8; PAGE]) -> Result<(), ()> {
        if self.random.random_ratio(1, 4) {
            Err(())
        } else {
            Ok(())
        }
    }

    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, ()> {
        if self.random.random_ratio(1, 2) {
            *bytes = ShortStarts {
                runs: self.random.random_range(0..5),
            }
            .encode();
        }
        self.read(0, 0, &mut []).map(|()| true)
    }

    fn save_starts(&mut self, _bytes: &[u8; ShortStarts::LEN]) -> Result<(), ()> {
        self.erase(0)
    }

    fn load_settings(&mut self, bytes: &mut [u8; MAX_SETTINGS]) -> Result<Option<usize>, ()> {
        let len = self.settings.len().min(MAX_SETTINGS);
        bytes[..len].copy_from_slice(&self.settings[..len]);
        // A length that no record has is possible too.
        Ok(Some(if self.random.random_ratio(1, 20) {
            usize::MAX
        } else {
            len
        }))
    }

    fn save_settings(&mut self, _bytes: &[u8]) -> Result<(), ()> {
        if self.random.random_ratio(1, 4) {
            Err(())
        } else {
            Ok(())
        }
    }
}

fn request(random: &mut ChaCha8Rng, upload: u16) -> Request {
    let joint = if random.random() {
        Joint::Front
    } else {
        Joint::Back
    };
    let period_us =
        [5_000_000, 700_000, 100_000, 20_000, 0, random.random()][random.random_range(0..6)];
    match random.random_range(0..20) {
        0 => Request::Configure(configuration(random)),
        1 => Request::SetServo {
            joint,
            settings: servo(random),
        },
        2 => Request::Trim {
            joint,
            trim: random.random_range(-6_000..6_000),
        },
        3 => Request::Trim {
            joint,
            trim: random.random(),
        },
        4 => Request::Begin(Begin {
            slot: 0,
            len: 4 * random.random_range(0..515),
            crc32: random.random(),
        }),
        5 => {
            let data = (0..random.random_range(0..=MAX_CHUNK))
                .map(|_| random.random())
                .collect();
            Request::Chunk(Chunk {
                upload,
                offset: random.random_range(0..2_100),
                data,
            })
        }
        6 => Request::Commit { upload },
        7 => Request::Pause {
            detached: random.random(),
        },
        8 => Request::Resume,
        9 => Request::Stop,
        10 if random.random_ratio(1, 4) => Request::EStop,
        11 => Request::ClearResets,
        12 => Request::ClearEStop {
            count: random.random_range(0..3),
        },
        13..=15 => ARM,
        _ => Request::Play(Play {
            cycles: random.random_range(0..4),
            period_us,
            detached: random.random(),
            checked: AS_HELD,
        }),
    }
}

/// A small table that a random commit can complete.
fn table(random: &mut ChaCha8Rng) -> gait_player::GaitTable {
    let amplitude = random.random_range(0.05..2.5);
    let knots = random.random_range(2..40);
    gait_player::GaitTable::from_fn(knots, |u| {
        let angle = std::f64::consts::TAU * u;
        [amplitude * angle.cos(), amplitude * angle.sin()]
    })
    .unwrap()
}

fn wild_run(seed: u64) -> u64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut config = config();
    config.configuration = configuration(&mut random);
    config.boot.kept = random.random();
    config.boot.session_seed = random.random();
    let limits = config.limits;
    let mut brain = Brain::new(config);
    let mut storage = WildStorage::new(ChaCha8Rng::seed_from_u64(seed ^ 0xF1A5));
    let _ = brain.load(&mut storage);
    let mut bench = Bench::around(brain);
    bench.keep_alive = random.random_ratio(9, 10);
    bench.greet(1);
    let mut witness = Witness::new();
    for _ in 0..60 {
        if random.random_ratio(1, 6) {
            let garbage: Vec<u8> = (0..random.random_range(0..300))
                .map(|_| random.random())
                .collect();
            bench.brain.receive(bench.now_us, Transport::Uart, &garbage);
            bench.brain.receive(bench.now_us, Transport::Uart, &[0]);
        }
        let sequence = bench.sequence.wrapping_add(1);
        bench.sequence = sequence;
        if random.random_ratio(1, 6) && bench.output.state != StateName::EStopped {
            let table = table(&mut random);
            let begin = Begin {
                slot: 0,
                len: u16::try_from(table.bytes().len()).unwrap(),
                crc32: table.crc32(),
            };
            if let Some(Reply::Wanted { upload, .. }) =
                bench.send_request(sequence, Request::Begin(begin))
            {
                for (index, piece) in table.bytes().chunks(MAX_CHUNK).enumerate() {
                    let offset = u16::try_from(index * MAX_CHUNK).unwrap();
                    let data = heapless::Vec::from_slice(piece).unwrap();
                    bench.send_request(
                        sequence,
                        Request::Chunk(Chunk {
                            upload,
                            offset,
                            data,
                        }),
                    );
                }
                bench.sequence = sequence.wrapping_add(1);
                bench.send_request(bench.sequence, Request::Commit { upload });
            }
        } else {
            let request = request(&mut random, sequence.wrapping_sub(1));
            bench.send_request(sequence, request);
        }
        for _ in 0..random.random_range(1..40) {
            bench.inputs = Inputs {
                link_up: random.random_ratio(19, 20),
                ..bench.inputs
            };
            bench.inputs.battery_mv = Some(5_000);
            if random.random_ratio(1, 30) {
                bench.inputs.battery_mv = Some(random.random());
                bench.now_us += random.random_range(0..300_000);
            }
            let output = bench.tick();
            witness.see(&output, &limits);
            if output.storage_wanted {
                let _ = bench.brain.serve_storage(bench.now_us, &mut storage);
            }
        }
    }
    witness.powered
}

#[test]
fn r4_no_pulse_outside_the_window_and_no_step_above_the_slew_limit() {
    let powered: u64 = (0..1_500).map(wild_run).sum();
    println!(
        "R4: 1500 runs, {powered} ticks with pulses on, every one within the window and the slew limit"
    );
    assert!(
        powered > 100_000,
        "the runs hardly ever armed: {powered} ticks"
    );
}

#[test]
#[ignore = "minutes: part of the soak"]
fn r4_for_a_hundred_thousand_runs() {
    let powered: u64 = (2_000..102_000).map(wild_run).sum();
    println!("R4: 100000 runs, {powered} ticks with pulses on");
}

#[test]
fn r4_whatever_the_clock_does() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    for _ in 0..200 {
        let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
        let mut witness = Witness::new();
        for _ in 0..100 {
            bench.now_us = match random.random_range(0..40) {
                0 => bench
                    .now_us
                    .saturating_add(random.random::<u64>() >> random.random_range(0..64)),
                1 => bench.now_us.saturating_sub(random.random_range(0..SECOND)),
                _ => bench.now_us.saturating_add(random.random_range(0..40_000)),
            };
            if random.random() {
                let sequence = random.random();
                let request = request(&mut random, 3);
                bench.send_request(sequence, request);
            }
            bench.beat();
            let output = bench.brain.tick(bench.now_us, &bench.inputs);
            witness.see(&output, &Limits::ROBOT);
        }
    }
}

#[test]
fn random_and_mutated_frames_never_move_a_stopped_robot_that_no_arm_reached() {
    let mut random = ChaCha8Rng::seed_from_u64(44);
    let mut bench = Bench::new();
    for _ in 0..20_000 {
        let mut frame = [0; MAX_ENCODED];
        let message = Message::Request(request(&mut random, 3));
        let header = Header::new(bench.session, random.random());
        let len = encode(header, &message, &mut frame).unwrap();
        let at = random.random_range(1..len - 1);
        frame[at] ^= 1 << random.random_range(0..8);
        bench
            .brain
            .receive(bench.now_us, Transport::Uart, &frame[..len]);
        bench.brain.receive(bench.now_us, Transport::Uart, &[0]);
    }
    bench.drain();
    let output = bench.tick();
    assert_eq!((output.state, output.pulses_ns), (StateName::Stopped, None));
    assert!(bench.replies.is_empty());
}
