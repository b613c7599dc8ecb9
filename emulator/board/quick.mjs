// The same answers sooner. rp2040js finds the block that an address belongs to by a list of comparisons and a sparse table; a
// program's reads and writes are nearly all of flash and RAM, so those are asked first. Nothing here changes what is read or written.

const FLASH_START = 0x10000000;
const RAM_START = 0x20000000;
const BLOCK_BITS = 14;

/** Shortens the ways of a `mcu` whose blocks are all in place. */
export function quicken(mcu) {
  const { core, flash, flashView, sram, sramView } = mcu;
  const { readUint16, readUint32, writeUint32 } = Object.getPrototypeOf(mcu);

  const blocks = [];
  for (const [key, block] of Object.entries(mcu.peripherals)) blocks[key >>> 2] = block;
  const dense = Array.from(blocks); // no holes: looked up by index, not by hash
  mcu.findPeripheral = (address) => dense[address >>> BLOCK_BITS];

  core.readUint16 = mcu.readUint16 = (address) => {
    const at = address - FLASH_START;
    return at >= 0 && at + 1 < flash.length ? flashView.getUint16(at, true) : readUint16.call(mcu, address);
  };
  core.readUint32 = mcu.readUint32 = (address) => {
    const at = (address >>> 0) - RAM_START;
    // What is not aligned has a word to say.
    return at >= 0 && at + 3 < sram.length && (at & 3) === 0 ? sramView.getUint32(at, true) : readUint32.call(mcu, address);
  };
  core.writeUint32 = mcu.writeUint32 = (address, value) => {
    const at = (address >>> 0) - RAM_START;
    if (at >= 0 && at + 3 < sram.length) sramView.setUint32(at, value, true);
    else writeUint32.call(mcu, address, value);
  };
}
