// The cache between the core and its flash, which the emulator does without: every read from flash costs it nothing, so its
// cycle counts are those of code that lies in RAM. With this cache in place a miss holds the core up, as on the chip.

/** RP2040 datasheet 2.6.3: 16 kB, two ways, lines of 8 bytes. What is replaced is not told there; here it is the older way. */
const LINE = 8, SETS = 1024;
const FLASH_START = 0x10000000, FLASH_END = 0x11000000;

/**
 * Cycles of the system clock to fill a line, as two words by the board's second-stage loader, whose serial clock is a quarter
 * of the system's: 03h sends 8 bits of command, 24 of address and takes 32 of data on one line; EBh sends address and mode in
 * 8 clocks, waits 4 and takes the data in 8, on four lines.
 */
const FILL = { 'nano-connect': 2 * 4 * (8 + 24 + 32), pico: 2 * 4 * (8 + 4 + 8) };

export class FlashCache {
  constructor(kind) {
    this.fill = FILL[kind];
    this.tags = new Int32Array(2 * SETS);
    this.misses = 0;
    this.flush();
  }

  /** Empty, as after the boot ROM's flush. */
  flush() { this.tags.fill(-1); }

  /** Stands between the chip and its flash: instructions and data alike. */
  watch(mcu) {
    for (const name of ['readUint8', 'readUint16', 'readUint32']) {
      const read = mcu[name].bind(mcu);
      mcu[name] = (address) => {
        this.touch(address >>> 0);
        return read(address);
      };
    }
  }

  /** The newer way of a set comes first. */
  touch(address) {
    if (address < FLASH_START || address >= FLASH_END) return;
    const line = (address - FLASH_START) / LINE | 0;
    const first = 2 * (line % SETS);
    const { tags } = this;
    if (tags[first] === line) return;
    if (tags[first + 1] !== line) this.misses += 1;
    tags[first + 1] = tags[first];
    tags[first] = line;
  }
}
