// The board, driven from outside: one JSON command a line on standard input, one JSON answer a line on standard output. It does
// nothing between commands, so whoever drives it owns the time. Usage: node serve.mjs FIRMWARE.elf nano-connect|pico

import fs from 'node:fs';
import readline from 'node:readline';
import { Board, PINS } from './board.mjs';
import { readElf } from './elf.mjs';

const [path, kind] = process.argv.slice(2);
if (!path || !(kind in PINS.state)) {
  console.error('usage: node serve.mjs FIRMWARE.elf nano-connect|pico');
  process.exit(2);
}
const elf = readElf(fs.readFileSync(path));
const board = new Board(elf, kind);

/** Each command: what it does; its result is merged into the answer. */
const commands = {
  run: ({ until, afterByte }) => { board.run(until, afterByte); },
  feed: ({ characters }) => { board.feed(characters); },
  connected: ({ up }) => { board.setConnected(up); },
  plugged: ({ in: plugged }) => { board.setPlugged(plugged); },
  feed_usb: ({ bytes }) => { board.feedUsb(bytes); },
  jumper: ({ closed }) => { board.setJumper(closed); },
  button: ({ pressed }) => { board.setButton(pressed); },
  battery: ({ volts }) => { board.setBattery(volts); },
  cut: ({ flashBytes }) => { board.cutPowerAfter(flashBytes); },
  erase_time: ({ ns }) => { board.setEraseTime(ns); },
  save_flash: ({ path }) => { board.saveFlash(path); },
  load_flash: ({ path }) => { board.loadFlash(path); },
  stack: () => ({ stack: board.stackLeft() }),
  cache: () => { board.putFlashBehindCache(); },
  power_cycle: () => { board.powerCycle(); },
  boot_rom_reset: () => { board.bootRomReset(); },
  debugger_reset: () => { board.debuggerReset(); },
  pin_reset: () => { board.pinReset(); },
  patch: ({ address, halfword }) => { board.patch(address, halfword); },
  symbols: ({ containing }) => ({
    symbols: Object.fromEntries(Object.entries(elf.symbols).filter(([name]) => name.includes(containing))),
  }),
  peek: ({ address, count }) => ({
    bytes: Array.from({ length: count }, (_, i) => board.mcu.readUint8(address + i)),
  }),
};

readline.createInterface({ input: process.stdin }).on('line', (line) => {
  let answer;
  try {
    const command = JSON.parse(line);
    const result = commands[command.do](command);
    answer = { now: board.now, powered: board.powered, lost: board.mcu.uart[0].lost, ...board.takeEvents(), ...result };
  } catch (error) {
    answer = { error: String(error?.stack ?? error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
});
