// What RAM holds when the power comes on, and how far the stack has grown since.

import { scrambler } from './chance.mjs';

const RAM_START = 0x20000000;
const PAINT = 0x57ac57ac;

/** Real RAM comes up with anything in it: a program that reads what it never wrote must not find zeros here. */
export function noise(ram) {
  const words = new Uint32Array(ram.buffer, ram.byteOffset, ram.length / 4);
  const next = scrambler(0x9e3779b9);
  for (let i = 0; i < words.length; i++) words[i] = next();
}

const region = (ram, bottom, top) => new Uint32Array(ram.buffer, ram.byteOffset + bottom - RAM_START, (top - bottom) / 4);

/** Marks the stack's words as never used. */
export function paint(ram, bottom, top) { region(ram, bottom, top).fill(PAINT); }

/** Bytes at the stack's far end that still bear the mark. */
export function unpainted(ram, bottom, top) {
  const words = region(ram, bottom, top);
  const used = words.findIndex((word) => word !== PAINT);
  return 4 * (used < 0 ? words.length : used);
}
