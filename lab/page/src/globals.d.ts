/** Version of the workspace and commit of page and module. */
declare const VERSION: string;
declare const HASH: string;

declare module "worker:*" {
  /** Bundled script of the worker. */
  const source: string;
  export default source;
}

declare module "*.css";

declare module "gifenc" {
  type Palette = [number, number, number][];
  export function quantize(rgba: Uint8ClampedArray, most: number): Palette;
  export function applyPalette(rgba: Uint8ClampedArray, palette: Palette): Uint8Array;
  /** `delay` is in ms. */
  export function GIFEncoder(): {
    writeFrame(indices: Uint8Array, width: number, height: number, how: { palette?: Palette | undefined; delay: number }): void;
    finish(): void;
    bytes(): Uint8Array;
  };
}
