// What an ELF file puts into flash, and where its symbols are. Node has no reader of its own, and of the whole format only
// two tables are needed.

const LOAD = 1;
const SYMBOL_TABLE = 2;

/** {segments: [{address, bytes}], symbols: {name: address}} of a 32-bit little-endian ELF. */
export function readElf(file) {
  const view = new DataView(file.buffer, file.byteOffset, file.length);
  if (file.length < 52 || view.getUint32(0) !== 0x7f454c46 || file[4] !== 1 || file[5] !== 1) {
    throw new Error('not a 32-bit little-endian ELF file');
  }
  const word = (at) => view.getUint32(at, true);
  const half = (at) => view.getUint16(at, true);
  const table = (start, size, count) => Array.from({ length: count }, (_, i) => start + i * size);

  const segments = table(word(28), half(42), half(44))
    .filter((at) => word(at) === LOAD && word(at + 16) > 0)
    .map((at) => ({ address: word(at + 12), bytes: file.subarray(word(at + 4), word(at + 4) + word(at + 16)) }));

  const sections = table(word(32), half(46), half(48));
  const symbols = {};
  for (const section of sections.filter((at) => word(at + 4) === SYMBOL_TABLE)) {
    const names = word(sections[word(section + 24)] + 16);
    for (const at of table(word(section + 16), 16, word(section + 20) / 16)) {
      const start = names + word(at);
      const name = file.toString('latin1', start, file.indexOf(0, start));
      if (name) symbols[name] = word(at + 4);
    }
  }
  return { segments, symbols };
}
