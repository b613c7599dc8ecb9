//! Random numbers that identify a start, from the random bit of the ring oscillator.
//!
//! Consecutive bits are strongly correlated, because the oscillator's period is about 150 ns. So the bits are sampled far
//! apart, many more than needed, and hashed to accumulate their entropy.

use core::hash::Hasher;

use embassy_rp::pac::ROSC;
use embassy_time::{Duration, block_for};
use siphasher::sip::SipHasher24;

/// Number of hashed bits; with [`APART`] they take 6 ms of every start.
const BITS: usize = 512;
/// Interval between bits: at least 10 µs, because up to one tick of the clock may have passed before the wait.
const APART: Duration = Duration::from_micros(11);

/// 64 random bits of this start. `starts` distinguishes starts even without entropy.
pub(crate) fn bits_of_start(starts: u32) -> u64 {
    let mut drawn = [0; 4 + BITS / 8];
    let (count, bits) = drawn.split_at_mut(4);
    count.copy_from_slice(&starts.to_le_bytes());
    for byte in bits {
        for _ in 0..8 {
            block_for(APART);
            *byte = *byte << 1 | u8::from(ROSC.randombit().read().randombit());
        }
    }
    let mut hasher = SipHasher24::new();
    hasher.write(&drawn);
    hasher.finish()
}
