// Gap: rp2040js has no memory protection unit. ARMv6-M's, as far as this firmware needs it: regions that nothing may access,
// modelled for the addresses just below the RAM. There a chip without the unit need not fault (the addresses belong to the flash
// controller's part of the map): here reads are zero and writes are lost.

const TYPE = 0xd90, CONTROL = 0xd94, NUMBER = 0xd98, BASE = 0xd9c, SIZE = 0xda0;
const EIGHT_REGIONS = 8 << 8;
const ENABLE = 1, IN_HARD_FAULT = 2;
const HARD_FAULT = 3, NMI = 2;
const RAM_START = 0x20000000, GUARDED = 32 << 10;
const PAGE = 1 << 14;

/** Thrown inside the emulation by an access that the unit refuses. */
export class MemoryFault extends Error {}

/** Gives `mcu` the unit, and the addresses below its RAM. */
export function memoryProtection(mcu) {
  const { ppb, core } = mcu;
  const regions = Array.from({ length: 8 }, () => ({ base: 0, size: 0 }));
  let control = 0, number = 0;

  const read = ppb.readUint32.bind(ppb), write = ppb.writeUint32.bind(ppb);
  ppb.readUint32 = (offset) => {
    switch (offset) {
      case TYPE: return EIGHT_REGIONS;
      case CONTROL: return control;
      case NUMBER: return number;
      case BASE: return (regions[number].base | number) >>> 0;
      case SIZE: return regions[number].size;
      default: return read(offset);
    }
  };
  ppb.writeUint32 = (offset, value) => {
    switch (offset) {
      case TYPE: return undefined;
      case CONTROL: control = value & 7; return undefined;
      case NUMBER: number = value & 7; return undefined;
      case BASE:
        if (value & 0x10) number = value & 7;
        regions[number].base = (value & 0xffffff00) >>> 0;
        return undefined;
      case SIZE: regions[number].size = value >>> 0; return undefined;
      default: return write(offset, value);
    }
  };

  const refused = (address) => {
    const always = core.IPSR !== HARD_FAULT && core.IPSR !== NMI;
    if (!(control & ENABLE) || !(always || control & IN_HARD_FAULT)) return false;
    // The region with the highest number counts.
    for (let region = 7; region >= 0; region--) {
      const { base, size } = regions[region];
      const length = 2 ** ((size >>> 1 & 31) + 1);
      if (size & 1 && address >= base && address < base + length) return (size >>> 24 & 7) === 0;
    }
    return false;
  };
  for (let start = RAM_START - GUARDED; start < RAM_START; start += PAGE) {
    const access = (offset) => {
      if (refused(start + offset)) throw new MemoryFault(`no access to 0x${(start + offset).toString(16)}`);
    };
    mcu.peripherals[start >>> 14 << 2] = {
      readUint32(offset) { access(offset); return 0; },
      // The part below a page's last 4 KiB says how to combine; nothing is kept, so it does not matter.
      writeUint32(offset) { access(offset); },
      writeUint32Atomic(offset) { access(offset); },
    };
  }
}
