// The cable to a computer: rp2040js's own USB host for a CDC port, on a device controller that keeps the datasheet's rules.
//
// Gaps of rp2040js 1.4.1 (RP2040 datasheet 4.1.2.5 and 4.1.2.6):
// - A buffer is handed over the moment it is marked available. On the chip the mark stays until the transfer is complete, and
//   drivers that wait for it to fall (embassy's) would take old bytes for new ones.
// - The host answers a buffer that waits for data at once, with nothing where it has nothing. A host with nothing to say is silent.
// - The host names the wrong recipient when it raises DTR (the device; it is the interface, USB CDC PSTN 6.3.12).
// - The mark of a suspended bus cannot be cleared.

import { USBCDC } from 'rp2040js';

/** A full packet of 64 bytes at 12 Mbit/s, with its token, handshake and gaps. */
const PACKET_NS = 60e3;
/** A bus that is silent for so long is suspended. */
const SUSPEND_NS = 3e6;
const MOST = 64;
const AVAILABLE = 1 << 10, FULL = 1 << 15, LENGTH = 0x3ff;
/** Of the memory that controller and program share: the buffers' control words, IN and OUT of each endpoint in turn. */
const FIRST_BUFFER = 0x80, LAST_BUFFER = 0xfc, OUT = 4;
const SIE_STATUS = 0x50, SUSPENDED = 1 << 4;
const CLASS_REQUEST_TO_INTERFACE = 0x21, SET_CONTROL_LINE_STATE = 0x22, DTR_AND_RTS = 3;

/** What hangs on the board's USB socket. The program's controller is `mcu.usbCtrl`. */
export class Cable {
  /** `onBytes` takes what the board sends to the port. */
  constructor(mcu, onBytes) {
    this.mcu = mcu;
    this.controller = mcu.usbCtrl;
    this.onBytes = onBytes;
    this.plugged = false;
    this.waiting = [];
    this.enabled = false;
    this.alarms = new Map();
    this.silent = mcu.clock.createAlarm(() => this.suspend());
    this.controller.DPRAMUpdated = (offset, value) => this.marked(offset, value);
    this.controller.onUSBEnabled = () => { this.enabled = true; this.greet(); };
    const write = this.controller.writeUint32.bind(this.controller);
    this.controller.writeUint32 = (offset, value) => {
      if (offset === SIE_STATUS && this.controller.rawWriteValue & SUSPENDED) this.controller.sieStatus &= ~SUSPENDED;
      write(offset, value);
    };
  }

  /** Whether the port is open: enumerated, with DTR raised. */
  get open() { return this.plugged && !!this.host?.initialized; }

  /** The plug goes in: the computer finds a device and opens its port. */
  plug() {
    if (this.plugged) return;
    this.plugged = true;
    this.silent.cancel();
    this.greet();
  }

  /** The plug comes out. The board has other power; all that it sees is a bus that is silent. */
  unplug() {
    this.plugged = false;
    this.host = null;
    this.waiting = [];
    this.silent.schedule(SUSPEND_NS);
  }

  /** Bytes from the computer's program to the board, once the port is open. */
  feed(bytes) {
    if (!this.plugged) return;
    for (const byte of bytes) this.waiting.push(byte);
    this.offer();
  }

  greet() {
    if (!this.plugged || !this.enabled) return;
    const { controller } = this;
    const enabled = controller.onUSBEnabled;
    this.host = new USBCDC(controller);
    controller.onUSBEnabled = enabled;
    controller.onEndpointRead = () => {};
    this.host.onSerialData = (bytes) => this.onBytes(bytes);
    this.host.cdcSetControlLineState = () => {
      controller.sendSetupPacket(Uint8Array.of(CLASS_REQUEST_TO_INTERFACE, SET_CONTROL_LINE_STATE, DTR_AND_RTS, 0, 0, 0, 0, 0));
      this.host.initialized = true;
      this.offer();
    };
    controller.resetDevice();
  }

  suspend() {
    this.controller.sieStatus |= SUSPENDED;
    this.controller.sieStatusUpdated();
  }

  /** The program has marked a buffer available, to be sent or to be filled. */
  marked(offset, value) {
    if (offset < FIRST_BUFFER || offset > LAST_BUFFER || !(value & AVAILABLE) || !this.plugged) return;
    if (!(offset & OUT)) {
      const endpoint = (offset - FIRST_BUFFER) >> 3;
      const at = this.controller.getEndpointBufferOffset(endpoint, false);
      const bytes = this.mcu.usbDPRAM.slice(at, at + (value & LENGTH));
      this.after(offset, () => {
        this.complete(offset, (control) => control & ~FULL);
        this.controller.onEndpointWrite?.(endpoint, bytes);
      });
    } else if (offset === FIRST_BUFFER + OUT) {
      // The computer ends a control request that it has read the answer of.
      this.after(offset, () => this.complete(offset, (control) => (control & ~LENGTH) | FULL));
    } else {
      this.offer();
    }
  }

  /** The next packet for the port, if there is one, the port is open and the program is ready for it. */
  offer() {
    if (!this.open || !this.waiting.length) return;
    const offset = FIRST_BUFFER + 8 * this.host.outEndpoint + OUT;
    if (!(this.mcu.usbDPRAMView.getUint32(offset, true) & AVAILABLE) || this.alarms.get(offset)?.busy) return;
    this.after(offset, () => {
      const bytes = this.waiting.splice(0, MOST);
      this.mcu.usbDPRAM.set(bytes, this.controller.getEndpointBufferOffset(this.host.outEndpoint, true));
      this.complete(offset, (control) => (control & ~LENGTH) | FULL | bytes.length);
    });
  }

  /** A packet's time later; a cable that was pulled, or a program that took its mark back, ends it. */
  after(offset, act) {
    if (!this.alarms.has(offset)) {
      const slot = { busy: false, act: null };
      slot.alarm = this.mcu.clock.createAlarm(() => {
        slot.busy = false;
        if (this.plugged && this.mcu.usbDPRAMView.getUint32(offset, true) & AVAILABLE) slot.act();
      });
      this.alarms.set(offset, slot);
    }
    const slot = this.alarms.get(offset);
    slot.busy = true;
    slot.act = act;
    slot.alarm.schedule(PACKET_NS);
  }

  complete(offset, change) {
    const { usbDPRAMView: memory } = this.mcu;
    memory.setUint32(offset, change(memory.getUint32(offset, true)) & ~AVAILABLE, true);
    this.controller.indicateBufferReady((offset - FIRST_BUFFER) >> 3, !!(offset & OUT));
  }
}
