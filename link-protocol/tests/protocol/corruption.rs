//! Promises R1 and R2: corrupted frames are rejected and counted. Seeded; the long runs are `--ignored`.
use crate::samples;

use link_protocol::{Decoder, MAX_RAW, Message};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::HashSet;

/// Frames that the decoder accepts from `bytes`, closed by a zero.
fn accepted(
    decoder: &mut Decoder,
    bytes: &[u8],
    mut see: impl FnMut(Result<Message, link_protocol::BodyError>),
) {
    for &byte in bytes.iter().chain(&[0]) {
        if let Some(received) = decoder.push(byte) {
            see(received.message);
        }
    }
}

fn short_frames(most: usize) -> Vec<(&'static str, Vec<u8>)> {
    let frames = samples::messages()
        .into_iter()
        .map(|(name, message)| (name, samples::frame(&message)));
    frames.filter(|(_, frame)| frame.len() <= most).collect()
}

/// Flips every set of up to `left` bits from bit `from` on; returns the number of frames.
fn flip(frame: &mut [u8], from: usize, left: u32, decoder: &mut Decoder, name: &str) -> u64 {
    let mut tried = 0;
    for bit in from..8 * frame.len() {
        frame[bit / 8] ^= 1 << (bit % 8);
        accepted(decoder, frame, |message| {
            panic!("{name}: accepted {message:?} from {frame:02x?}")
        });
        tried += 1;
        if left > 1 {
            tried += flip(frame, bit + 1, left - 1, decoder, name);
        }
        frame[bit / 8] ^= 1 << (bit % 8);
    }
    tried
}

fn every_flip(bits: u32, most: usize) -> u64 {
    let mut decoder = Decoder::new();
    short_frames(most)
        .into_iter()
        .map(|(name, mut frame)| flip(&mut frame, 0, bits, &mut decoder, name))
        .sum()
}

#[test]
fn every_flip_of_one_or_two_bits_is_rejected() {
    println!(
        "R2: {} frames with 1 or 2 flipped bits, none accepted",
        every_flip(2, 48)
    );
}

#[test]
fn every_flip_of_three_bits_of_short_frames_is_rejected() {
    println!(
        "R2: {} frames of up to 16 bytes with 1 to 3 flipped bits, none accepted",
        every_flip(3, 16)
    );
}

#[test]
#[ignore = "minutes: part of the soak"]
fn every_flip_of_three_bits_is_rejected() {
    println!(
        "R2: {} frames of up to 48 bytes with 1 to 3 flipped bits, none accepted",
        every_flip(3, 48)
    );
}

/// Corrupts `frame` in one of the ways of a wire or a buffer.
fn corrupt(random: &mut ChaCha8Rng, frame: &[u8], other: &[u8], broken: &mut Vec<u8>) {
    broken.clear();
    broken.extend(frame);
    for _ in 0..random.random_range(1..=3) {
        let at = random.random_range(0..=broken.len());
        match random.random_range(0..6) {
            0 if at < broken.len() => broken[at] ^= 1 << random.random_range(0..8),
            1 => broken.insert(at, random.random()),
            2 if at < broken.len() => drop(broken.remove(at)),
            3 => broken.truncate(at),
            4 => {
                // The head of one frame joined to the tail of another.
                broken.truncate(at);
                broken.extend(&other[random.random_range(0..other.len())..]);
            }
            _ => {
                let len = random.random_range(0..MAX_RAW);
                broken.splice(at.., (0..len).map(|_| random.random::<u8>()));
            }
        }
    }
}

/// Decodes `frames` corrupted frames; panics if a message appears that was not sent.
fn corrupted_streams(seed: u64, frames: u64) -> link_protocol::DecodeCounters {
    let messages = samples::messages();
    let encoded: Vec<_> = messages
        .iter()
        .map(|(_, message)| samples::frame(message))
        .collect();
    let whole: HashSet<&[u8]> = encoded
        .iter()
        .map(|frame| &frame[..frame.len() - 1])
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut decoder = Decoder::new();
    let mut broken = Vec::new();
    let mut pieces = 0_u64;
    for _ in 0..frames {
        let frame = &encoded[random.random_range(0..encoded.len())];
        let other = &encoded[random.random_range(0..encoded.len())];
        corrupt(&mut random, frame, other, &mut broken);
        pieces += broken
            .split(|&byte| byte == 0)
            .filter(|piece| !piece.is_empty())
            .count() as u64;
        // A splice may contain an intact frame, so only sent messages may appear.
        let mut sent = broken
            .split(|&byte| byte == 0)
            .filter(|piece| whole.contains(piece))
            .count();
        accepted(&mut decoder, &broken, |message| {
            sent = sent
                .checked_sub(1)
                .unwrap_or_else(|| panic!("accepted {message:?} from {broken:02x?}"));
        });
        assert_eq!(sent, 0, "an unharmed frame was lost in {broken:02x?}");
    }
    let counters = decoder.counters();
    assert_eq!(
        u64::from(counters.ok) + u64::from(counters.bad()),
        pieces,
        "not all counted"
    );
    counters
}

#[test]
fn nothing_that_was_not_sent_comes_out_of_four_million_corrupted_streams() {
    println!(
        "R1: 4 M corrupted frames: {:?}",
        corrupted_streams(1, 4_000_000)
    );
}

#[test]
#[ignore = "a minute: part of the soak (SOAK_FRAMES sets the number)"]
fn nothing_that_was_not_sent_comes_out_of_a_hundred_million() {
    let frames = std::env::var("SOAK_FRAMES").map_or(100_000_000, |frames| frames.parse().unwrap());
    println!(
        "R1: {frames} corrupted frames: {:?}",
        corrupted_streams(2, frames)
    );
}
