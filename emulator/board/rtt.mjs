// The firmware's log as a debug probe reads it: bytes that it leaves in a ring in RAM, which SEGGER's RTT control block describes.

const RAM_START = 0x20000000;
const MARK = 'SEGGER RTT\0\0\0\0\0\0';
/** The first channel upwards in the block: where its ring is, how long, how far it is written and read. */
const BUFFER = 28, SIZE = 32, WRITTEN = 36, READ = 40;

export class Rtt {
  /** `block`: where the control block is; undefined for a firmware without a log. */
  constructor(mcu, block) {
    this.ram = mcu.sram;
    this.view = mcu.sramView;
    this.at = block - RAM_START;
    this.ready = false;
    this.read = 0;
  }

  /** The firmware has set the block up since the chip came out of reset: before, RAM holds anything. */
  isReady() {
    if (!this.ready && Number.isInteger(this.at)) {
      const mark = String.fromCharCode(...this.ram.subarray(this.at, this.at + MARK.length));
      this.ready = mark === MARK && this.word(WRITTEN) === 0 && this.word(READ) === 0;
    }
    return this.ready;
  }

  word(offset) { return this.view.getUint32(this.at + offset, true); }

  /** Takes what was written since it was last asked; undefined for nothing. */
  take() {
    if (!this.isReady()) return undefined;
    const written = this.word(WRITTEN);
    if (written === this.read) return undefined;
    const ring = this.ram.subarray(this.word(BUFFER) - RAM_START).subarray(0, this.word(SIZE));
    const bytes = written > this.read
      ? [...ring.subarray(this.read, written)]
      : [...ring.subarray(this.read), ...ring.subarray(0, written)];
    this.read = written;
    this.view.setUint32(this.at + READ, written, true);
    return bytes;
  }
}
