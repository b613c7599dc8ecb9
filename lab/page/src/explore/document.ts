// State of the Explore tab as one value, for undo and for links.

import { signal } from "@preact/signals";

export type Point = readonly [number, number];

export const OPTIMA = ["displacement", "efficiency-small", "efficiency-large", "turning", "sideways", "speed"] as const;
export type Optimum = (typeof OPTIMA)[number];

/** Closed curve of shapes: dragged by control points, computed by the optimiser, or read from a file. */
export type Gait =
  | { kind: "drawn"; points: readonly Point[]; symmetric: boolean }
  | { kind: "optimum"; what: Optimum }
  | { kind: "text"; name: string; text: string };

/** Values of the sliders that replace those of the swimmer file; with units in the names, as in the module's call `swimmer`. */
export interface With {
  chi?: number;
  sphere_radius_m?: number;
  middle_m?: number;
  front_m?: number;
  back_m?: number;
  max_rate_rad_s?: number;
}

export type Row = "x" | "y" | "theta";
export const ROWS: readonly Row[] = ["x", "y", "theta"];

export interface Document {
  /** Preset, or the text of a swimmer file. */
  swimmer: string;
  with: With;
  /** Bound on the joints for the optimiser and the certificate \[rad\]; undefined for no bound. */
  maxAngle: number | null;
  noOverlap: boolean;
  row: Row;
  /** Half width of the map \[rad\]. */
  halfWidth: number;
  /** Period of a cycle \[s\]. */
  period: number;
  /** Length and width \[m\]. */
  tank: readonly [number, number];
  /** Objective of the certificate. */
  objective: "displacement" | "efficiency";
  /** Two side by side; the second may be missing. */
  gaits: readonly [Gait, Gait | null];
  active: 0 | 1;
  /** Optima laid over the map. */
  overlaid: readonly Optimum[];
}

export const CIRCLE: Gait = { kind: "drawn", points: circle(1.2, 12), symmetric: true };

export const FIRST: Document = {
  swimmer: "robot",
  with: {},
  maxAngle: 2.3,
  noOverlap: false,
  row: "x",
  halfWidth: 2.8,
  period: 30,
  tank: [2, 1],
  objective: "displacement",
  gaits: [CIRCLE, null],
  active: 0,
  overlaid: [],
};

export const shown = signal<Document>(FIRST);
const past = signal<readonly Document[]>([]);
const future = signal<readonly Document[]>([]);
let gesture: string | undefined;
/** Number of steps that can be undone. */
const DEPTH = 200;

export const canUndo = () => past.value.length > 0;
export const canRedo = () => future.value.length > 0;

/** Changes the state. Changes of one gesture (dragging a point or a slider) are one step. */
export function edit(change: Partial<Document>, partOf?: string): void {
  if (!partOf || partOf !== gesture) past.value = [...past.value.slice(1 - DEPTH), shown.value];
  gesture = partOf;
  future.value = [];
  shown.value = { ...shown.value, ...change };
}

/** Ends the gesture: the next change is a new step. */
export function endGesture(): void {
  gesture = undefined;
}

export function undo(): void {
  const before = past.value.at(-1);
  if (!before) return;
  past.value = past.value.slice(0, -1);
  future.value = [...future.value, shown.value];
  shown.value = before;
  endGesture();
}

export function redo(): void {
  const after = future.value.at(-1);
  if (!after) return;
  future.value = future.value.slice(0, -1);
  past.value = [...past.value, shown.value];
  shown.value = after;
  endGesture();
}

export function activeGait(document: Document): Gait {
  return document.gaits[document.active] ?? document.gaits[0];
}

/** Replaces the active gait. */
export function editGait(gait: Gait, partOf?: string): void {
  const [first, second] = shown.value.gaits;
  edit({ gaits: shown.value.active === 0 ? [gait, second] : [first, gait] }, partOf);
}

/** Control points on a circle, from φ₁ = φ₂ > 0, counter-clockwise. */
export function circle(amplitude: number, count: number): Point[] {
  return Array.from({ length: count }, (_, k) => {
    const angle = Math.PI / 4 + (2 * Math.PI * k) / count;
    return [amplitude * Math.cos(angle), amplitude * Math.sin(angle)] as const;
  });
}
