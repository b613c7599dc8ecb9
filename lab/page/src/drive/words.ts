// Messages between page and worker, and the JSON messages of the link.

export type StateName = "Stopped" | "EStopped" | "Holding" | "Starting" | "Playing" | "Paused" | "Stopping" | "Settling";

/** Telemetry of the robot; units as in link-protocol's `Telemetry`. */
export interface Telemetry {
  robot_us: number;
  state: StateName;
  cause: string;
  flags: number;
  cycle: number;
  cycles: number;
  phase: number;
  setpoint: [number, number];
  pulse_ns: [number, number];
  battery_mv: number | null;
  pose: { x: number; y: number; theta: number };
  frames_ok: number;
  frames_bad: number;
}

export interface Hello {
  board: string;
  firmware: { major: number; minor: number; patch: number };
  reset_reason: string;
  limits: { max_angle: number; max_rate: number };
}

export interface TableInfo {
  knots: number;
  crc32: number;
  stored: boolean;
  min_period_us: number;
}

/** Values that a play and a clearing of e-stops must name. */
export interface Held {
  settings_crc32: number;
  estops: number;
}

export interface Status extends Held {
  table: TableInfo | null;
}

export type Reply = string | Record<string, unknown>;

/** Events of the session; tickets are used between worker and module. */
export type Event =
  | { event: "telemetry"; telemetry: Telemetry; at_s: number }
  | { event: "connected"; ticket: number; restarted: boolean; hello: Hello }
  | { event: "answered"; ticket: number; reply: Reply }
  | { event: "stopped_by_itself"; ticket: number; cause: string }
  | { event: "uploaded"; ticket: number; table: TableInfo }
  | { event: "progress"; ticket: number; phase: string; done: number; total: number }
  | { event: "failed"; ticket: number; reason: string };

/** Transport to a robot. */
export type WireOptions =
  | { kind: "twin"; swimmer: string; seed: number }
  | { kind: "serial"; baud: number }
  | { kind: "socket"; url: string; token: string };

export type Request = string | Record<string, unknown>;

/** Messages from the page to the worker. */
export type Order =
  | { do: "open"; wire: WireOptions; key: string | null }
  | { do: "close" }
  | { do: "request"; request: Request; what: string }
  | { do: "upload"; gait: string | number[]; of: number }
  | { do: "cancel upload" }
  | { do: "stop" }
  | { do: "estop" }
  | { do: "drive" }
  | { do: "watch" }
  | { do: "preflight"; question: object; of: number }
  | { do: "log" }
  /** Reads the plays of a link log from disk. */
  | { do: "read recording"; name: string; bytes: ArrayBuffer }
  /** The page's main thread is alive. */
  | { do: "alive" };

/** Statistics of the link. */
export type LinkState = "closed" | "opening" | "greeting" | "open" | "watching" | "gone";

export interface Health {
  counters: { frames_sent: number; retransmissions: number; received: { ok: number; bad_crc: number } };
  round_trip_s: number | null;
  answers_signed: boolean | null;
  frames: number;
  forgotten: number;
}

/** True pose of the robot in the page. */
export interface Stands {
  now_s: number;
  pose: [number, number, number];
  angles: [number, number];
  state: StateName;
  pulses_ns: [number, number] | null;
  cycles: number;
}

/** Pose of the middle link in the tank by the cameras of `swimmer lab --track`; null while the robot is not seen. */
export type TrackedPose = [number, number, number] | null;

/** Line of the monitor about a play; `warns` if it names a departure or the reason of a stop. */
export interface MonitorLine {
  text: string;
  warns: boolean;
}

/** Telemetry of a recorded play; the pose is that of the robot's own model, from the start of the play. */
export interface RecordedSample {
  t_s: number;
  phi_rad: [number, number];
  pose: [number, number, number];
}

/** Play of a link log. */
export interface RecordedPlay {
  /** Seconds since 1970. */
  began_s: number;
  cycles: number;
  ended: boolean;
  /** Pose at the end of the last cycle. */
  end: [number, number, number];
  samples: RecordedSample[];
}

export interface Forecast {
  /** Checksum of the table that an upload of this gait sends. */
  crc32: number;
  period_s: number;
  min_period_s: number;
  displacement_m: [number, number] | null;
  rotation_rad: number | null;
  loss_share: number | null;
  /** One cycle as played: x, y, θ from its start, and both joint angles. */
  path: [number, number, number, number, number][];
  refused: string | null;
  warnings: string[];
  servo_assumed: boolean;
  configured_as: boolean | null;
}

/** Messages from the worker to the page. */
export type News =
  | { kind: "link"; state: LinkState; name: string; reason: string }
  | { kind: "events"; events: Event[] }
  | { kind: "done"; what: string; reason: string | null }
  | { kind: "hello"; hello: Hello; configuration: object | null }
  | { kind: "table"; table: TableInfo | null }
  | { kind: "held"; held: Held }
  /** The gait of the upload `of` is the robot's table. */
  | { kind: "uploaded"; of: number; table: TableInfo }
  | { kind: "progress"; done: number; total: number }
  | { kind: "health"; health: Health }
  | { kind: "stands"; stands: Stands }
  | { kind: "wheel"; yours: boolean; free: boolean }
  | { kind: "stopped by another" }
  | { kind: "tracked"; pose: TrackedPose }
  | { kind: "monitor"; lines: MonitorLine[] }
  | { kind: "forecast"; of: number; forecast: Forecast | null; reason: string }
  /** The worker checks that the main thread is alive. */
  | { kind: "alive?" }
  | { kind: "log"; bytes: ArrayBuffer }
  /** Plays of a log: of an opened file with its name, or the play that has just ended, with its log. */
  | { kind: "recording"; name: string; plays: RecordedPlay[]; log: ArrayBuffer | null; reason: string };
