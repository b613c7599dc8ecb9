// Gap of rp2040js 1.4.1: its UART has no FIFOs and no bit times, and its transmit interrupt never falls. This is the PL011 as
// the RP2040 has it (datasheet section 4.2): 32-deep FIFOs, levels, the receive timeout, overrun, characters that take time.

const SECOND = 1e9;
const RX = 0x10, TX = 0x20, RX_TIMEOUT = 0x40, OVERRUN = 0x400;
/** Error bits of a character in the data register (framing, parity, break), one place to the left of its interrupts'. */
const CHARACTER_ERRORS = 0x700;
const ENABLED_RX = 0x201;
const LEVELS = [4, 8, 16, 24, 28];
const IDENTITY = { 0xfe0: 0x11, 0xfe4: 0x10, 0xfe8: 0x34, 0xfec: 0, 0xff0: 0x0d, 0xff4: 0xf0, 0xff8: 0x05, 0xffc: 0xb1 };

export class Pl011 {
  constructor(mcu, irq, onByte) {
    this.mcu = mcu;
    this.irq = irq;
    this.onByte = onByte;
    this.registers = { 0x24: 0, 0x28: 0, 0x2c: 0, 0x30: 0x300, 0x34: 0x12, 0x38: 0, 0x48: 0 };
    this.raw = 0;
    this.received = [];
    this.sending = [];
    this.wire = [];
    this.lost = 0;
    this.overran = false;
    this.busy = { receive: false, send: false };
    this.arrived = mcu.clock.createAlarm(() => this.characterArrived());
    this.left = mcu.clock.createAlarm(() => this.characterLeft());
    this.idle = mcu.clock.createAlarm(() => this.received.length && this.raise(RX_TIMEOUT));
  }

  /** Characters on the wire towards the board, with the error bits of the data register; one character time apart. */
  feed(characters) {
    for (const character of characters) this.wire.push(character);
    this.nextArrival();
  }

  get baud() {
    const divisor = this.registers[0x24] + this.registers[0x28] / 64;
    return divisor ? this.mcu.clkPeri / (16 * divisor) : 115200;
  }
  get characterTime() {
    const line = this.registers[0x2c];
    const bits = 1 + 5 + ((line >> 5) & 3) + (line & 8 ? 2 : 1) + (line & 2 ? 1 : 0);
    return (bits * SECOND) / this.baud;
  }
  get depth() { return this.registers[0x2c] & 0x10 ? 32 : 1; }
  get receiveLevel() { return this.depth === 1 ? 1 : LEVELS[(this.registers[0x34] >> 3) & 7] ?? 16; }
  get sendLevel() { return this.depth === 1 ? 0 : LEVELS[this.registers[0x34] & 7] ?? 16; }

  raise(bits) { this.raw |= bits; this.signal(); }
  clear(bits) { this.raw &= ~bits; this.signal(); }
  signal() { this.mcu.setInterrupt(this.irq, !!(this.raw & this.registers[0x38])); }

  nextArrival() {
    if (this.busy.receive || !this.wire.length) return;
    this.busy.receive = true;
    this.arrived.schedule(this.characterTime);
  }
  characterArrived() {
    this.busy.receive = false;
    const byte = this.wire.shift();
    if ((this.registers[0x30] & ENABLED_RX) === ENABLED_RX) {
      if (this.received.length >= this.depth) {
        this.lost += 1;
        this.overran = true;
        this.raise(OVERRUN);
      } else {
        this.received.push(byte | (this.overran ? 0x800 : 0));
        this.overran = false;
        if (byte & CHARACTER_ERRORS) this.raise((byte & CHARACTER_ERRORS) >> 1);
      }
      if (this.received.length >= this.receiveLevel) this.raise(RX);
      this.idle.schedule((32 * SECOND) / this.baud);
    }
    this.nextArrival();
  }
  nextDeparture() {
    if (this.busy.send || !this.sending.length) return;
    this.busy.send = true;
    this.left.schedule(this.characterTime);
  }
  characterLeft() {
    this.busy.send = false;
    this.onByte(this.sending.shift());
    if (this.sending.length === this.sendLevel) this.raise(TX); // on the way down through the level
    this.nextDeparture();
  }

  takeReceived() {
    const value = this.received.shift() ?? 0;
    if (this.received.length < this.receiveLevel) this.raw &= ~RX;
    if (!this.received.length) {
      this.raw &= ~RX_TIMEOUT;
      this.idle.cancel();
    }
    this.signal();
    return value;
  }
  get flags() {
    const empty = !this.sending.length;
    return (empty ? 0x80 : 0) | (this.received.length >= this.depth ? 0x40 : 0) |
      (this.sending.length >= this.depth ? 0x20 : 0) | (this.received.length ? 0 : 0x10) |
      (this.busy.send || !empty ? 8 : 0) | 1;
  }

  readUint32(offset) {
    switch (offset) {
      case 0x00: return this.takeReceived();
      case 0x18: return this.flags;
      case 0x3c: return this.raw;
      case 0x40: return this.raw & this.registers[0x38];
      default: return this.registers[offset] ?? IDENTITY[offset] ?? 0;
    }
  }
  writeUint32(offset, value) {
    if (offset === 0x00) {
      if (this.sending.length < this.depth) this.sending.push(value & 0xff);
      this.nextDeparture();
    } else if (offset === 0x44) {
      this.clear(value);
    } else if (offset in this.registers) {
      this.registers[offset] = value & 0xffff;
      if (offset === 0x38) this.signal();
    }
  }
  writeUint32Atomic(offset, value, how) {
    // A plain write must not read first: reading the data register takes a character.
    const whole = how === 0 || offset === 0x44;
    this.writeUint32(offset, whole ? value : combined(this.readUint32(offset), value, how));
  }
  clkPeriChanged() {}
}

/** A register after a plain, XOR, set or clear write (the four aliases of every RP2040 register). */
export function combined(before, value, how) {
  return [value, before ^ value, before | value, before & ~value][how] >>> 0;
}
