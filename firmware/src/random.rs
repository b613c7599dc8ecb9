//! Numbers that no other start has, from the chip's one source of chance: the ring oscillator's random bit.
//!
//! Bits read one after the other are nearly the same, because the oscillator itself takes about 150 ns a period. So they
//! are taken far apart, many more than are needed, and hashed: what little each is worth adds up.

use core::hash::Hasher;

use embassy_rp::pac::ROSC;
use embassy_time::{Duration, block_for};
use siphasher::sip::SipHasher24;

/// Bits that are hashed; with [`APART`] they take 6 ms of every start.
const BITS: usize = 512;
/// From bit to bit: at least 10 µs, and up to one tick of the clock is already over when the wait begins.
const APART: Duration = Duration::from_micros(11);

/// 64 bits for this start. `starts` tells starts apart even where the oscillator does not.
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
