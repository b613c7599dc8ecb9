// What `link-protocol` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

pub const ANGLE_UNIT_RAD: f32 = 1e-4;
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Arm {
    pub clear_estop: bool,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Begin {
    pub slot: u8,
    pub len: u16,
    pub crc32: u32,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct BenchStatus {
    pub window_s: u16,
    pub usb: bool,
    pub short_starts: u8,
    pub built: Configuration,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    pub boot_nonce: u32,
    pub session: u16,
    pub host_nonce: u32,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Board {
    Twin,
    NanoRp2040Connect,
    Pico,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    Version(u8),
    UnknownKind(u8),
    Malformed,
    TrailingBytes(usize),
}
pub struct Checksum(_);
impl Checksum {
    pub fn new() -> Self {}
    pub fn update(&mut self, bytes: &[u8]) {}
    pub fn finish(self) -> u32 {}
}
impl Default for Checksum {}
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Chunk {
    pub upload: u16,
    pub offset: u16,
    pub data: Vec<u8, MAX_CHUNK>,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Configuration {
    pub middle_m: f32,
    pub front_m: f32,
    pub back_m: f32,
    pub chi: f32,
    pub tangential_drag: TangentialDrag,
    pub sphere_radius_m: f32,
    pub max_angle: f32,
    pub max_rate: f32,
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    pub frames: DecodeCounters,
    pub acted: u32,
    pub replayed: u32,
    pub superseded: u32,
    pub stale: u32,
    pub refused: u32,
    pub dropped: u32,
    pub late_ticks: u32,
    pub clamped: u32,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum CrossingPlace {
    Gait(u16),
    Ramp,
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct DecodeCounters {
    pub ok: u32,
    pub bad_crc: u32,
    pub overflow: u32,
    pub bad_cobs: u32,
    pub trailing_bytes: u32,
    pub not_understood: u32,
}
impl DecodeCounters {
    pub fn bad(&self) -> u32 {}
}
#[derive(Clone, Debug)]
pub struct Decoder {}
impl Decoder {
    pub const fn new() -> Self {}
    pub fn counters(&self) -> DecodeCounters {}
    pub fn signed_bytes(&self) -> &[u8] {}
    pub fn kind_and_body(&self) -> Option<(Kind, &[u8])> {}
    pub fn push(&mut self, byte: u8) -> Option<Received> {}
}
impl Default for Decoder {}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    ToRobot,
    ToHost,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    BodyTooLong,
    BufferTooShort,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FirmwareVersion {
    pub major: u8,
    pub minor: u8,
    pub patch: u8,
    pub commit: [u8; 8],
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Flags(pub u16);
impl Flags {
    pub const BATTERY_LOW: Self = Self(1);
    pub const RESET_LOOP: Self = Self(2);
    pub const LINK_SILENT: Self = Self(4);
    pub const DETACHED: Self = Self(8);
    pub const SWAP_PENDING: Self = Self(16);
    pub const UNSAVED: Self = Self(32);
    pub const CYCLE_FLASH: Self = Self(64);
    pub const STORAGE_FAILED: Self = Self(128);
    pub const KEY_SET: Self = Self(256);
    pub const PRESENT: Self = Self(512);
    pub const SHORT_STARTS: Self = Self(1024);
    pub fn contains(self, other: Self) -> bool {}
    #[must_use]
    pub fn with(self, other: Self, condition: bool) -> Self {}
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Follow {
    pub upload: u16,
    pub cycles: u32,
    pub period_us: u32,
}
pub const HEADER: usize = 6;
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    pub version: u8,
    pub session: u16,
    pub sequence: u16,
}
impl Header {
    pub fn new(session: u16, sequence: u16) -> Self {}
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Heartbeat {
    pub host_us: u64,
    pub heard_us: u64,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    pub protocol_min: u8,
    pub protocol_current: u8,
    pub schema_key: [u8; 8],
    pub host_nonce: u32,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct HelloReply {
    pub host_nonce: u32,
    pub protocol_min: u8,
    pub protocol_current: u8,
    pub schema_key: [u8; 8],
    pub firmware: FirmwareVersion,
    pub board: Board,
    pub reset_reason: ResetReason,
    pub crash_message: bool,
    pub session: u16,
    pub boot_nonce: u32,
    pub limits: RobotLimits,
    pub buffer: u16,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelloReplyStart {
    pub host_nonce: u32,
    pub protocol_min: u8,
    pub protocol_current: u8,
    pub schema_key: [u8; 8],
    pub firmware: FirmwareVersion,
}
impl HelloReplyStart {
    pub fn of_body(body: &[u8]) -> Option<Self> {}
}
impl From<&HelloReply> for HelloReplyStart {}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Joint {
    Front,
    Back,
}
impl Joint {
    pub fn index(self) -> usize {}
}
pub const KIND_SIGNED: u8 = 0x80;
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Key(pub [u8; Key::LEN]);
impl Key {
    pub const LEN: usize = 16;
}
impl core::fmt::Debug for Key {}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Hello = 1,
    HelloReply = 2,
    Request = 3,
    Reply = 4,
    Telemetry = 5,
    KeepAlive = 6,
    Ping = 7,
    Pong = 8,
    Heartbeat = 9,
}
impl Kind {
    pub fn from_byte(byte: u8) -> Option<Self> {}
}
pub const MAX_BODY: usize = MAX_RAW - HEADER - TRAILER;
pub const MAX_CHUNK: usize = 104;
pub const MAX_ENCODED: usize = MAX_RAW + 3;
pub const MAX_KNOTS: usize = 512;
pub const MAX_RAW: usize = 128;
pub const MAX_SIGNED_CHUNK: usize = MAX_CHUNK - Signature::LEN;
pub const MAX_TABLE: usize = 4 * MAX_KNOTS;
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    Hello(Hello),
    HelloReply(HelloReply),
    Request(Request),
    Reply(Reply),
    Telemetry(Telemetry),
    KeepAlive,
    Ping(Ping),
    Pong(Pong),
    Heartbeat(Heartbeat),
}
impl Message {
    pub fn kind(&self) -> Kind {}
    pub fn encode_body<'a>(
        &self,
        out: &'a mut [u8],
    ) -> Result<&'a mut [u8], postcard::Error> {}
    pub fn decode_body(version: u8, kind: u8, body: &[u8]) -> Result<Self, BodyError> {}
}
pub const POWER_SINCE: u8 = 2;
pub const PROTOCOL_CURRENT: u8 = 2;
pub const PROTOCOL_MIN: u8 = 1;
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Ping {
    pub host_us: u64,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Play {
    pub cycles: u32,
    pub period_us: u32,
    pub detached: bool,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pong {
    pub host_us: u64,
    pub received_us: u64,
    pub sent_us: u64,
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Pose {
    pub x: f32,
    pub y: f32,
    pub theta: f32,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct PulseRange {
    pub shortest_ns: u32,
    pub longest_ns: u32,
}
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    pub header: Header,
    pub message: Result<Message, BodyError>,
    pub signature: Option<Signature>,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    StaleSession { open: u16 },
    Superseded { last: u16 },
    Version { min: u8, current: u8 },
    NotUnderstood,
    NotArmed,
    EStopped,
    WrongState(StateName),
    BatteryLow { measured_mv: u16, limit_mv: u16 },
    ResetLoop { wait_s: u16 },
    NoTable,
    NoSuchSlot(u8),
    BadLength(u16),
    NoUpload,
    ChunkOutOfRange { wanted: u16 },
    Incomplete { wanted: u16 },
    CrcMismatch { expected: u32, received: u32 },
    AngleLimit { joint: Joint, knot: u16, angle: i32, limit: i32 },
    RateLimit { joint: Joint, knot: u16, min_period_us: u32 },
    NotClosed { joint: Joint, step: i32, largest: i32 },
    LinksCross { place: CrossingPlace, phi1: i16, phi2: i16 },
    DetachedEndless,
    SwapPending,
    BadValue { field: u8 },
    SlowToNeutral { needs_ms: u32 },
    Busy,
    KeyNeeded,
    WrongKey,
    NeedsPresence,
    NotFresh,
    NotJoined { joint: Joint, step: i32 },
}
impl Refusal {
    pub fn number(&self) -> u8 {}
}
impl core::fmt::Display for Refusal {}
impl core::error::Error for Refusal {}
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Reply {
    Done,
    Refused(Refusal),
    Working,
    Status(Status),
    Counters(Counters),
    Configuration(Configuration),
    Servo(ServoSettings),
    Wanted { upload: u16, offset: u16 },
    CrashMessage(String<96>),
    Table(Option<TableInfo>),
    Bench(BenchStatus),
    PulseRange(PulseRange),
}
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Request {
    Status,
    Counters,
    Configuration,
    Configure(Configuration),
    Servo(Joint),
    SetServo { joint: Joint, settings: ServoSettings },
    Trim { joint: Joint, trim: i16 },
    Begin(Begin),
    Chunk(Chunk),
    Commit { upload: u16 },
    Arm(Arm),
    Play(Play),
    Pause { detached: bool },
    Resume,
    Stop,
    EStop,
    ClearResets,
    CrashMessage,
    Table,
    SetKey(Option<Key>),
    Bench,
    PulseRange(Joint),
    SetPulseRange { joint: Joint, range: PulseRange },
    ClearEStop,
    EnterBootLoader,
    Follow(Follow),
}
impl Request {
    pub fn is_stop(&self) -> bool {}
    pub fn is_powering(&self) -> bool {}
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResetReason {
    PowerOn,
    Watchdog,
    Crash,
    Pin,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct RobotLimits {
    pub max_angle: f32,
    pub max_rate: f32,
    pub pulse_min_ns: u32,
    pub pulse_max_ns: u32,
    pub max_knots: u16,
    pub upload_window: u16,
}
pub const SCHEMA_KEY: [u8; 8] = [0xCF, 0x6C, 0x35, 0xBC, 0x8D, 0x1E, 0x81, 0xB9];
pub const SCHEMA_KEY_V1: [u8; 8] = [0xC7, 0x47, 0x8B, 0x1F, 0x03, 0x22, 0x6B, 0x44];
pub const SCHEMA_NOW: [u8; 8] = postcard_schema::key::Key::for_path::<
    message::Schemas,
>("swimmer/link/v2")
    .to_bytes();
pub const STOP_VERSION: u8 = 1;
#[derive(Clone)]
pub struct Seal {}
impl core::fmt::Debug for Seal {}
impl Seal {
    pub fn new(key: &Key, binding: Binding) -> Self {}
    pub fn sign(
        &self,
        header: Header,
        kind: Kind,
        body: &[u8],
        counter: u64,
    ) -> Signature {}
    pub fn verifies(&self, signed: &[u8], signature: &Signature) -> bool {}
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ServoSettings {
    pub centre_ns: u32,
    pub slope_rad_per_us: f32,
    pub reversed: bool,
    pub trim: i16,
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signature {
    pub counter: u64,
    pub tag: [u8; 8],
}
impl Signature {
    pub const LEN: usize = 14;
    pub const TAG: usize = 8;
}
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum StateName {
    Stopped,
    EStopped,
    Holding,
    Starting,
    Playing,
    Paused,
    Stopping,
    Settling,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Status {
    pub robot_us: u64,
    pub state: StateName,
    pub cause: StopCause,
    pub flags: Flags,
    pub cycle: u32,
    pub cycles: u32,
    pub period_us: u32,
    pub phase: u16,
    pub setpoint: [i16; 2],
    pub battery_mv: Option<u16>,
    pub table: Option<TableInfo>,
    pub upload: Option<u16>,
}
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    Schema
)]
pub enum StopCause {
    Boot,
    Finished,
    Requested,
    PauseExpired,
    LinkLost,
    BatteryLow,
    EStop,
}
pub const TRAILER: usize = 4;
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TableInfo {
    pub knots: u16,
    pub crc32: u32,
    pub stored: bool,
    pub min_period_us: u32,
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum TangentialDrag {
    LogAspect(f32),
    HalfThickness(f32),
    OverViscosity(f32),
}
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Telemetry {
    pub robot_us: u64,
    pub state: StateName,
    pub cause: StopCause,
    pub flags: Flags,
    pub cycle: u32,
    pub cycles: u32,
    pub phase: u16,
    pub setpoint: [i16; 2],
    pub pulse_ns: [u32; 2],
    pub battery_mv: Option<u16>,
    pub pose: Pose,
    pub frames_ok: u16,
    pub frames_bad: u16,
}
pub fn crc32c(bytes: &[u8]) -> u32 {}
pub fn encode(
    header: Header,
    message: &Message,
    out: &mut [u8],
) -> Result<usize, EncodeError> {}
pub fn encode_body(
    header: Header,
    kind: u8,
    body: &[u8],
    signature: Option<Signature>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {}
pub fn encode_signed(
    header: Header,
    message: &Message,
    seal: &Seal,
    counter: u64,
    out: &mut [u8],
) -> Result<usize, EncodeError> {}
