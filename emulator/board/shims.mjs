// What rp2040js 1.4.1 lacks for this firmware, each gap named where it is filled. Nothing here knows the swimmer.
//
// Left open: cache misses of the flash take no time, so that a count of cycles is a lower bound, unless a board is told to put
// its flash behind the cache of xip.mjs.

import { Pl011, combined } from './uart.mjs';

/** Registers that hold what is written: blocks whose settings nobody in the emulator minds. */
class Registers {
  constructor(initial) { this.values = { ...initial }; }
  readUint32(offset) { return this.values[offset & 0xfff] ?? 0; }
  writeUint32(offset, value) { this.values[offset & 0xfff] = value >>> 0; }
  writeUint32Atomic(offset, value, how) { this.writeUint32(offset, combined(this.readUint32(offset), value, how)); }
}

const RANDOMBIT = 0x1c;

/** A ring oscillator that is stable and enabled, and whose random bit somebody else makes. */
class RingOscillator extends Registers {
  constructor(randomBit) {
    super({ 0x18: 0x80001000 });
    this.randomBit = randomBit;
  }
  readUint32(offset) { return (offset & 0xfff) === RANDOMBIT ? this.randomBit() : super.readUint32(offset); }
}

const SELECT_STATUS = 0x08, SELECT_CONTROL = 0x0c, DRIVER_MASK = 0x3000, DRIVER_OFF = 0x2000, LEVEL_AT_PAD = 1 << 17;

/** The flash chip's pins. Its select line is pulled low by the BOOTSEL button where the chip does not drive it. */
class FlashPins extends Registers {
  constructor(pressed) {
    super({});
    this.pressed = pressed;
  }
  readUint32(offset) {
    if ((offset & 0xfff) !== SELECT_STATUS) return super.readUint32(offset);
    const floats = (super.readUint32(SELECT_CONTROL) & DRIVER_MASK) === DRIVER_OFF;
    return floats && this.pressed() ? 0 : LEVEL_AT_PAD;
  }
}

/**
 * Fills every gap of a fresh `mcu`. `flash` performs erase and program; `onReset` hears the watchdog, `onLoader` the boot ROM
 * asked for its loader; `randomBit` is the ring oscillator's, `button` whether BOOTSEL is pressed; returns code traps.
 */
export function fillGaps(mcu, { onByte, onReset, onLoader, flash, randomBit, button, warn }) {
  uarts(mcu, onByte);
  blocksThatAreMissing(mcu, randomBit, button);
  interruptController(mcu.core, mcu.ppb);
  sendEvent(mcu, warn);
  undefinedInstructions(mcu);
  watchdog(mcu.peripherals[0x40058], onReset);
  return bootRom(mcu, flash, onLoader);
}

// Gap: UART without FIFOs, bit times and a falling transmit interrupt (uart.mjs).
function uarts(mcu, onByte) {
  for (const [index, page] of [[0, 0x40034], [1, 0x40038]]) {
    const uart = new Pl011(mcu, 20 + index, index === 0 ? onByte : () => {});
    mcu.uart[index] = uart;
    mcu.peripherals[page] = uart;
  }
}

// Gap: ring oscillator, voltage regulator and XIP cache control do not answer; embassy waits for their ready bits. Nor do the
// flash chip's pins.
function blocksThatAreMissing(mcu, randomBit, button) {
  mcu.peripherals[0x40018] = new FlashPins(button);
  mcu.peripherals[0x40060] = new RingOscillator(randomBit);
  mcu.peripherals[0x40064] = new Registers({ 0: 0xb1, 8: 0x100 });         // VREG_AND_CHIP_RESET: had a power-on reset
  mcu.peripherals[0x14000] = new Registers({ 0: 3, 8: 3 });                // XIP_CTRL: flush ready, FIFO empty
}

// Gap: an interrupt that software pended never stops being pending, and a line that is still high after its handler does not
// pend again. The ARMv6-M rules: entry clears the pending bit; a high line pends again on return.
function interruptController(core, ppb) {
  core.lines = 0;
  core.setInterrupt = function setInterrupt(irq, high) {
    const bit = 1 << irq;
    if (!high) {
      this.lines &= ~bit;
    } else if (!(this.lines & bit)) {
      this.lines |= bit;
      this.pendingInterrupts |= bit;
      this.interruptsUpdated = true;
      if (this.waiting && this.checkForInterrupts()) this.waiting = false;
    }
  };
  const enter = core.exceptionEntry;
  core.exceptionEntry = function exceptionEntry(number) {
    if (number >= 16) this.pendingInterrupts &= ~(1 << (number - 16));
    enter.call(this, number);
  };
  const leave = core.exceptionReturn;
  core.exceptionReturn = function exceptionReturn(link) {
    const bit = this.IPSR >= 16 ? 1 << (this.IPSR - 16) : 0;
    leave.call(this, link);
    if (this.lines & bit) this.pendingInterrupts |= bit;
    this.interruptsUpdated = true;
  };
  const write = ppb.writeUint32.bind(ppb);
  const CLEAR_PENDING = 0x280;
  ppb.writeUint32 = (offset, value) => {
    if (offset !== CLEAR_PENDING) return write(offset, value);
    core.pendingInterrupts = (core.pendingInterrupts & ~value) | (core.lines & value);
    core.interruptsUpdated = true;
    return undefined;
  };
}

// Gap: SEV is only logged; it must set the event register, or an executor that signals itself sleeps through it.
function sendEvent(mcu, warn) {
  mcu.logger = {
    debug() {},
    info(_, message) { if (message === 'SEV') mcu.core.eventRegistered = true; },
    warn: (part, message) => warn(`${part}: ${message}`),
    error: (part, message) => warn(`${part}: error: ${message}`),
  };
}

// Gap: an undefined instruction waits for a debugger; without one it is a hard fault, at its own address.
function undefinedInstructions(mcu) {
  const HARD_FAULT = 3;
  mcu.onBreak = () => {
    mcu.core.registers[15] -= mcu.core.breakRewind;
    mcu.core.exceptionEntry(HARD_FAULT);
  };
}

// Gap: a watchdog that fires only calls back. The board resets the chip; reason and scratch registers live on.
function watchdog(dog, onReset) {
  dog.onWatchdogTrigger = () => {
    dog.alarm.enable = false;
    dog.timer.enable = false;
    onReset({ reason: dog.reason, scratch: Uint32Array.from(dog.scratchData) });
  };
}

// Gap: no boot ROM. A stub with the header and function table that programs look into; its functions trap into the emulator.
const RETURN = 0x4770; // bx lr
const TABLE = 0x100, LOOK_UP = 0x80, FIRST_FUNCTION = 0x400, ROM_SIZE = 16384;

function bootRom(mcu, flash, onLoader) {
  const rom = Buffer.alloc(ROM_SIZE);
  for (let at = 0x80; at < 0x2000; at += 2) rom.writeUInt16LE(RETURN, at);
  rom.writeUInt32LE(0x20041f00, 0x00);
  rom.write('Mu\u0001\u0002', 0x10, 'latin1');
  rom.writeUInt16LE(TABLE, 0x14);
  rom.writeUInt16LE(0x200, 0x16);
  rom.writeUInt16LE(LOOK_UP | 1, 0x18);
  rom.fill(0, TABLE, 0x200 + 4);

  const copy = (to, from, count) => {
    for (let i = 0; i < count; i++) mcu.writeUint8(to + i, mcu.readUint8(from + i));
  };
  const fill = (to, value, count) => {
    for (let i = 0; i < count; i++) mcu.writeUint8(to + i, value);
  };
  const nothing = () => {};
  const functions = {
    IF: nothing, EX: nothing, FC: nothing, CX: nothing, // connect, leave XIP, flush, enter XIP: the flash is always there
    RE: ([offset, count]) => flash.erase(offset, count),
    RP: ([offset, source, count]) =>
      flash.program(offset, Uint8Array.from({ length: count }, (_, i) => mcu.readUint8(source + i))),
    UB: ([activityPins, disabledInterfaces]) => onLoader({ activityPins, disabledInterfaces }),
    C4: ([to, from, count]) => copy(to, from, count), MC: ([to, from, count]) => copy(to, from, count),
    S4: ([to, value, count]) => fill(to, value, count), MS: ([to, value, count]) => fill(to, value, count),
  };
  const traps = new Map();
  Object.entries(functions).forEach(([name, perform], index) => {
    const address = FIRST_FUNCTION + 16 * index;
    rom.write(name, TABLE + 4 * index, 'latin1');
    rom.writeUInt16LE(address | 1, TABLE + 4 * index + 2);
    traps.set(address, (registers) => { perform(registers); });
  });
  traps.set(LOOK_UP, (registers) => {
    let found = 0;
    for (let at = registers[0]; mcu.readUint16(at) && !found; at += 4) {
      if (mcu.readUint16(at) === (registers[1] & 0xffff)) found = mcu.readUint16(at + 2);
    }
    registers[0] = found;
  });
  mcu.loadBootrom(new Uint32Array(rom.buffer, rom.byteOffset, ROM_SIZE / 4));
  return traps;
}
