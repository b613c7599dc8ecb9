// What is left to chance on a real chip, here the same at every run: a stream of numbers from a seed.

/** Marsaglia's xorshift of 32 bits; `seed` is not 0. */
export function scrambler(seed) {
  let state = seed;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return state >>> 0;
  };
}

/**
 * A ring oscillator's random bit. The oscillator drifts against the crystal slowly: what is read less than `settled` [ns] after
 * the last new bit is that bit again. That is harsher than the chip, and catches a program that reads too fast.
 */
export function ringOscillator(seed, now, settled = 10e3) {
  const next = scrambler(seed);
  let since = -Infinity, bit = 0;
  return () => {
    if (now() - since >= settled) {
      since = now();
      bit = next() >>> 31;
    }
    return bit;
  };
}
