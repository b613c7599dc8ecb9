// The swimmer's board: an emulated RP2040 with its flash, the servos' pins, the battery's divider, the HC-05's STATE pin, the
// USB socket, jumper, button, and the mains switch. Time is emulated time in nanoseconds and never the machine's.

import fs from 'node:fs';
import { RP2040 } from 'rp2040js';
import { ringOscillator } from './chance.mjs';
import { MemoryFault, memoryProtection } from './mpu.mjs';
import { quicken } from './quick.mjs';
import { noise, paint, unpainted } from './ram.mjs';
import { Rtt } from './rtt.mjs';
import { fillGaps } from './shims.mjs';
import { Cable } from './usb.mjs';
import { FlashCache } from './xip.mjs';

const FLASH_START = 0x10000000;
const FLASH_SIZE = 2 << 20;
const SECTOR = 4096, PAGE = 256;
/** Typical times of the W25Q16 on both boards: 45 ms a sector erased (400 ms at most), 0.4 ms a page programmed. */
const ERASE_NS = 45e6, PROGRAM_NS = 0.4e6;
/** Both servos hang on PWM slice 0. */
const SLICE = 0;
/** The firmware's control task runs in this exception: 16 + SWI_IRQ_1. */
const CONTROL = 16 + 27;
/** A hard fault's number. */
const HARD_FAULT = 3;
/** Bit of WATCHDOG.REASON: its timer ran out. */
const TIMER = 1;
/** RESETS.RESET as a reset of the chip leaves it: every peripheral held in reset. */
const ALL_PERIPHERALS = 0x1ffffff;
/** Bits of VREG_AND_CHIP_RESET.CHIP_RESET: what the chip as a whole was last reset by. */
const HAD_POR = 0x100, HAD_RUN = 0x10000;
/** Of the ring oscillator's random bits, which go on over resets and power cycles. */
const CHANCE = 0x2545f491;
export const PINS = { front: 16, back: 17, presence: 5, state: { 'nano-connect': 25, pico: 22 }, led: { 'nano-connect': 6, pico: 25 } };

/** Thrown inside the emulation when the power goes. */
class PowerCut extends Error {}
/** Thrown inside the emulation when the program hands the chip over to the loader in its boot ROM. */
class HandedOver extends Error {}

export class Board {
  constructor(elf, kind) {
    this.kind = kind;
    this.flash = new Uint8Array(FLASH_SIZE).fill(0xff);
    for (const { address, bytes } of elf.segments) this.flash.set(bytes, address - FLASH_START);
    this.stack = { bottom: elf.symbols._stack_end, top: elf.symbols._stack_start };
    this.tick = entry(elf, 'firmware7control7Control4tick');
    this.logBlock = elf.symbols._SEGGER_RTT;
    this.randomBit = ringOscillator(CHANCE, () => this.now);
    this.connected = false;
    this.plugged = false;
    this.jumper = false;
    this.button = false;
    this.battery = 0;
    this.before = 0;
    this.cached = false;
    this.patched = null;
    this.events = emptyEvents();
    this.flashBytesLeft = Infinity;
    this.eraseNs = ERASE_NS;
    this.powered = true;
    this.loading = false;
    this.powerOn();
  }

  /** Emulated time since the first power-on [ns]; it goes on over resets and power cycles. */
  get now() { return this.before + this.mcu.clock.nanos; }

  /** What happened since the last call. */
  takeEvents() {
    const events = this.events;
    this.events = emptyEvents();
    return events;
  }

  /** Characters towards the board, at its baud rate; above the byte the error bits of the UART's data register. */
  feed(characters) { if (this.running) this.mcu.uart[0].feed(characters); }

  /** Bytes to the board's USB port; they wait until it is open. */
  feedUsb(bytes) { if (this.running) this.cable.feed(bytes); }

  /** A computer's cable in the USB socket, whose power does not matter here. */
  setPlugged(plugged) {
    this.plugged = plugged;
    if (plugged) this.cable.plug();
    else this.cable.unplug();
  }

  /** The presence jumper, from its pin to ground. */
  setJumper(closed) {
    this.jumper = closed;
    this.mcu.gpio[PINS.presence].setInputValue(!closed);
  }

  /** The BOOTSEL button. */
  setButton(pressed) { this.button = pressed; }

  /** The HC-05's STATE pin. */
  setConnected(connected) {
    this.connected = connected;
    this.mcu.gpio[PINS.state[this.kind]].setInputValue(connected);
  }

  /** Voltage at the battery's pin [V]. */
  setBattery(volts) {
    this.battery = volts;
    this.mcu.adc.channelValues[0] = Math.max(0, Math.min(4095, Math.round((volts / 3.3) * 4096)));
  }

  /** The power goes when so many more bytes of flash have been erased or programmed. */
  cutPowerAfter(flashBytes) { this.flashBytesLeft = flashBytes; }

  /** How long a sector takes to erase [ns], from now on. */
  setEraseTime(ns) { this.eraseNs = ns; }

  /** Off and on again: RAM and scratch registers are lost, flash stays. */
  powerCycle() {
    this.before = this.now;
    this.powered = true;
    this.flashBytesLeft = Infinity;
    this.powerOn();
  }

  /** The reset pin: the scratch registers are lost, RAM is not, and the chip knows. */
  pinReset() {
    this.before = this.now;
    this.start({ reason: 0, scratch: new Uint32Array(8), ram: this.mcu.sram, chipReset: HAD_RUN });
  }

  /**
   * The flash was written over USB: the boot ROM ends that with a reset by the watchdog. The way there led through the reset
   * pin; and where a program asked for it, the ROM left its pin mask and interface mask in scratch registers 0 and 1.
   */
  bootRomReset() {
    this.before = this.now;
    const scratch = Uint32Array.of(1 << PINS.led[this.kind], 1, 0, 0, 0, 0, 0, 0);
    this.start({ reason: TIMER, scratch, ram: this.mcu.sram });
  }

  /**
   * A debugger resets the core and nothing else (SYSRESETREQ): the watchdog's registers stay, a reason from long ago too, and no
   * peripheral is held in reset. What the peripherals' other registers held is not kept here: the firmware resets them first.
   */
  debuggerReset() {
    this.before = this.now;
    const { reason, scratchData } = this.mcu.peripherals[0x40058];
    this.start({ reason, scratch: Uint32Array.from(scratchData), ram: this.mcu.sram, heldInReset: 0 });
  }

  powerOn() { this.start({ reason: 0, scratch: new Uint32Array(8), ram: null }); }

  /** The whole flash chip, to a file. */
  saveFlash(path) { fs.writeFileSync(path, this.flash); }

  /** Another flash chip is soldered in, with what such a file holds; then the power comes on. */
  loadFlash(path) {
    const image = fs.readFileSync(path);
    if (image.length !== FLASH_SIZE) throw new Error(`${path}: ${image.length} bytes instead of ${FLASH_SIZE}`);
    this.flash.set(image);
    this.powerCycle();
  }

  /** Comes up anew with the flash behind its cache, whose misses take time; without it every read is a hit. */
  putFlashBehindCache() {
    this.cached = true;
    this.powerCycle();
  }

  /** Bytes of the stack that were never written since the power came on, and its size. */
  stackLeft() {
    const { bottom, top } = this.stack;
    return { left: unpainted(this.mcu.sram, bottom, top), size: top - bottom };
  }

  /** Two bytes of code in flash, as a fault would change them: the copy that runs, not the one that survives. */
  patch(address, halfword) {
    this.patched = address & ~1;
    new DataView(this.mcu.flash.buffer, this.mcu.flash.byteOffset).setUint16((address & ~1) - FLASH_START, halfword, true);
  }

  /** The program runs: there is power, and it has not handed the chip over. */
  get running() { return this.powered && !this.loading; }

  /** Runs until emulated time `until` [ns], or until the power is cut, or for `afterByte` from the first byte that it sends. */
  run(until, afterByte = Infinity) {
    this.until = until;
    this.afterByte = afterByte;
    while (this.running && this.now < this.until) {
      try {
        this.runUntilReset();
      } catch (thrown) {
        if (thrown instanceof PowerCut) {
          this.powered = false;
          this.events.power_cuts.push({ at: this.now });
        } else if (thrown instanceof HandedOver) {
          this.loading = true;
        } else throw thrown;
      }
      this.takeLog();
      if (this.reset) {
        this.events.resets.push({ at: this.now, reason: this.reset.reason });
        this.before = this.now;
        this.start({ ...this.reset, ram: this.mcu.sram });
      }
    }
    if (!this.running) this.before += Math.max(0, this.until - this.now);
  }

  /** A character has left the UART. */
  send(byte) {
    this.until = Math.min(this.until, this.now + this.afterByte);
    this.events.uart.push(byte);
    this.events.uart_at.push(this.now);
  }

  /** A packet has reached the computer's port. */
  sendUsb(bytes) {
    this.until = Math.min(this.until, this.now + this.afterByte);
    for (const byte of bytes) {
      this.events.usb.push(byte);
      this.events.usb_at.push(this.now);
    }
  }

  /** The program has asked the boot ROM for its loader: the chip belongs to the computer until that resets it. */
  handOver({ activityPins, disabledInterfaces }) {
    this.events.loader.push({ at: this.now, activity_pins: activityPins >>> 0, disabled_interfaces: disabledInterfaces >>> 0 });
    throw new HandedOver();
  }

  /** What the firmware has logged; it has a ring for no more than a kilobyte. */
  takeLog() {
    const bytes = this.log.take();
    if (bytes) this.events.log.push({ at: this.now, bytes });
  }

  runUntilReset() {
    const { core, clock } = this.mcu;
    let cycle = 1e9 / this.mcu.clkSys;
    while (!this.reset) {
      const end = this.until - this.before;
      if (clock.nanosCounter >= end) break;
      if (clock.nanosCounter < this.stalledUntil) {
        this.sleep(Math.min(this.stalledUntil, end));
        continue;
      }
      if (core.waiting || this.lockedUp) {
        this.takeLog();
        this.sleep(Math.min(clock.nextAlarm?.nanos ?? end, end));
        continue;
      }
      if (this.asleep) this.wake(cycle);
      if (core.registers[15] < 0x4000) this.trap(core);
      if (core.registers[15] === this.patched) this.reachPatch();
      const inControl = core.IPSR === CONTROL;
      let cycles = this.execute(core);
      if (this.cache) cycles += this.fills();
      this.busy += cycles;
      if (inControl) {
        this.control += cycles;
        this.watchTick(core);
      }
      const now = clock.nanosCounter + cycles * cycle, alarm = clock.nextAlarm;
      if (alarm !== null && alarm.nanos <= now) clock.tick(cycles * cycle);
      else clock.nanosCounter = now; // what a tick without an alarm does
      // Counted over all runs, so that how they are cut shows nowhere.
      this.count = (this.count + 1) & 0x3ff;
      if (this.count === 0) {
        cycle = 1e9 / this.mcu.clkSys; // the firmware sets its clock up once, early
        this.takeLog();
      }
    }
  }

  /** One instruction; one that the memory protection unit refuses is a hard fault at its own address. */
  execute(core) {
    const at = core.registers[15];
    try {
      return core.executeInstruction();
    } catch (thrown) {
      if (!(thrown instanceof MemoryFault)) throw thrown;
      core.registers[15] = at;
      this.takeFault(core);
      return 1;
    }
  }

  /** Where the stack has no room for the registers either, the core locks up: it does nothing more until a reset. */
  takeFault(core) {
    try {
      core.exceptionEntry(HARD_FAULT);
    } catch (thrown) {
      if (!(thrown instanceof MemoryFault)) throw thrown;
      this.lockedUp = true;
    }
  }

  /** The core stands still until this time [ns], and whatever is due by then happens. */
  sleep(until) {
    const { clock } = this.mcu;
    this.asleep = true;
    clock.tick(Math.max(until - clock.nanosCounter, 0));
    clock.nanosCounter = Math.max(clock.nanosCounter, until);
  }

  /**
   * It goes on with an edge of its clock, as a chip does. Times in between are sums of fractions, and their last digits tell how
   * the way there was cut into runs: a program that reads its clock just then would see it.
   */
  wake(cycle) {
    const { clock } = this.mcu;
    this.asleep = false;
    clock.nanosCounter = Math.ceil((clock.nanosCounter - 1e-3) / cycle) * cycle;
  }

  /** How long the control task's tick itself takes, from its first instruction to where it returns to. */
  watchTick(core) {
    const pc = core.registers[15];
    if (pc === this.tick) {
      this.tickReturn = core.registers[14] & ~1;
      this.tickFrom = this.control;
    } else if (pc === this.tickReturn) {
      this.ticking += this.control - this.tickFrom;
      this.tickReturn = null;
    }
  }

  /** Cycles that the last instruction waited for lines of flash. */
  fills() {
    const { misses, fill } = this.cache;
    this.cache.misses = 0;
    this.misses += misses;
    return misses * fill;
  }

  /** The patched code runs for the first time. */
  reachPatch() {
    this.patched = null;
    this.events.patch_reached.push({ at: this.now });
  }

  trap(core) {
    const trap = this.traps.get(core.registers[15] & ~1);
    if (!trap) return;
    trap(core.registers);
    core.registers[15] = core.registers[14] & ~1;
  }

  /** The chip comes out of reset as its boot ROM leaves it: at the second-stage loader. RAM outlives all but the power. */
  start({ reason, scratch, ram, chipReset = HAD_POR, heldInReset = ALL_PERIPHERALS }) {
    this.reset = null;
    this.loading = false;
    this.busy = 0;
    this.control = 0;
    this.count = 0;
    this.ticking = 0;
    this.tickReturn = null;
    this.misses = 0;
    this.stalledUntil = 0;
    this.asleep = false;
    this.lockedUp = false;
    const mcu = new RP2040();
    this.mcu = mcu;
    if (ram) {
      mcu.sram.set(ram);
    } else {
      noise(mcu.sram);
      paint(mcu.sram, this.stack.bottom, this.stack.top);
    }
    this.traps = fillGaps(mcu, {
      onByte: (byte) => this.send(byte),
      onReset: (reset) => { this.reset = reset; },
      flash: { erase: (at, count) => this.erase(at, count), program: (at, bytes) => this.program(at, bytes) },
      onLoader: (asked) => this.handOver(asked),
      randomBit: this.randomBit,
      button: () => this.button,
      warn: (text) => { this.events.warnings[text] = (this.events.warnings[text] ?? 0) + 1; },
    });
    memoryProtection(mcu);
    mcu.flash.set(this.flash, 0);
    this.cache = this.cached ? new FlashCache(this.kind) : null;
    this.cache?.watch(mcu);
    const dog = mcu.peripherals[0x40058];
    dog.reason = reason;
    dog.scratchData.set(scratch);
    mcu.peripherals[0x40064].writeUint32(8, chipReset);
    mcu.peripherals[0x4000c].reset = heldInReset;
    this.cable = new Cable(mcu, (bytes) => this.sendUsb(bytes));
    if (this.plugged) this.cable.plug();
    this.setConnected(this.connected);
    this.setJumper(this.jumper);
    this.setBattery(this.battery);
    this.watchPulses();
    quicken(mcu);
    this.log = new Rtt(mcu, this.logBlock);
    mcu.core.VTOR = 0;
    mcu.core.PC = FLASH_START;
    mcu.core.LR = 0;
  }

  /** Every PWM period as latched at its wrap, and every edge of both pins. */
  watchPulses() {
    const { mcu } = this;
    const slice = mcu.pwm.channels[SLICE];
    const wrap = slice.wrap.bind(slice);
    const latched = () => {
      wrap();
      const [front, back] = [slice.alarmA.target, slice.alarmB.target];
      this.events.periods.push({
        at: this.now, front, back, top: slice.timer.top, divider: slice.timer.prescaler, clock: mcu.clkSys,
        busy: this.busy, control: this.control, tick: this.ticking, misses: this.misses,
      });
      this.busy = 0;
      if (this.tickReturn) this.tickFrom -= this.control;
      this.control = 0;
      this.ticking = 0;
      this.misses = 0;
    };
    slice.wrap = latched;
    slice.alarmBottom.callback = latched;
    for (const [name, pin] of [['front', PINS.front], ['back', PINS.back]]) {
      mcu.gpio[pin].addListener((level) => this.events.edges.push({ at: this.now, pin: name, high: level === 1 }));
    }
    mcu.gpio[PINS.led[this.kind]].addListener((level) => this.events.led.push({ at: this.now, on: level === 1 }));
  }

  erase(offset, count) {
    for (let at = offset; at < offset + count; at += SECTOR) {
      // The cells of a sector that loses power while it is erased may hold anything: here they are half done.
      this.spend(SECTOR, (done) => this.store(at, new Uint8Array(done).fill(0xff)));
      this.stall(this.eraseNs);
      this.events.erased += 1;
    }
  }

  program(offset, bytes) {
    for (let start = 0; start < bytes.length; start += PAGE) {
      const page = bytes.subarray(start, start + PAGE);
      // Programming only clears bits.
      const cleared = page.map((byte, i) => byte & this.flash[offset + start + i]);
      this.spend(page.length, (done) => this.store(offset + start, cleared.subarray(0, done)));
      this.stall(PROGRAM_NS * (page.length / PAGE));
      this.events.programmed += 1;
    }
  }

  /** The program stands still while its flash is busy; everything else goes on, the UART too. */
  stall(ns) { this.stalledUntil = Math.max(this.stalledUntil, this.mcu.clock.nanos) + ns; }

  /** Does a flash operation of so many bytes, or as much of it as the power lasts for. */
  spend(count, perform) {
    const done = Math.min(count, this.flashBytesLeft);
    perform(done);
    this.flashBytesLeft -= done;
    if (done < count) throw new PowerCut();
  }

  store(at, bytes) {
    this.flash.set(bytes, at);
    this.mcu.flash.set(bytes, at);
    this.cache?.flush();
  }
}

/** Where the function begins whose mangled name holds `part`. */
function entry(elf, part) {
  const found = Object.entries(elf.symbols).find(([name]) => name.includes(part));
  return found ? found[1] & ~1 : -1;
}

function emptyEvents() {
  return {
    uart: [], uart_at: [], usb: [], usb_at: [], log: [], periods: [], edges: [], led: [], resets: [], power_cuts: [], loader: [],
    patch_reached: [], warnings: {}, erased: 0, programmed: 0,
  };
}
