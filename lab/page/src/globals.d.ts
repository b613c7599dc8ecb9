/** The workspace's version and the commit that page and module were built from. */
declare const VERSION: string;
declare const HASH: string;

declare module "worker:*" {
  /** The bundled worker's script. */
  const source: string;
  export default source;
}

declare module "*.css";
