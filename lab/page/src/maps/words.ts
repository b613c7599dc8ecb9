// Names and units of axes and quantities of a sweep in words.

interface Words {
  words: string;
  /** Unit of the printed numbers. */
  unit: string;
  /** Printed number of one unit of the file. */
  per: number;
}

const DEGREES = 180 / Math.PI;

/** Axis or quantity of an export; an older one has no words. */
export interface Named {
  name: string;
  words?: string;
  unit: string;
}

/** Words, unit and factor of an axis or a quantity. */
export function wordsOf({ name, words: given, unit }: Named): Words {
  const words = given?.replaceAll("r_s", "rₛ") ?? name.replace(/(_per_s|_rad|_s|_m)$/, "").replaceAll(/[_.]/g, " ");
  if (unit === "m") return { words, unit: "mm", per: 1000 };
  if (unit === "rad") return { words, unit: "°", per: DEGREES };
  if (unit === "rad/s") return { words, unit: "°/s", per: DEGREES };
  return { words, unit, per: 1 };
}

/** Name with unit, as at an axis. */
export function labelOf(of: Named): string {
  const { words, unit } = wordsOf(of);
  return unit ? `${words} [${unit}]` : words;
}

/** Number with the digits that distinguish it: at most `digits` significant ones, without trailing zeros. */
export const printed = (value: number, digits = 4) => String(Number(value.toPrecision(digits))).replace("-", "−");

/** Number of an axis or quantity in its printed unit. */
export function valueOf(of: Named, value: number, digits = 4): string {
  const { unit, per } = wordsOf(of);
  const number = printed(value * per, digits);
  return unit === "°" ? `${number}°` : unit ? `${number} ${unit}` : number;
}
