// What `host-link` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    Port { doing: &'static str, source: io::Error },
    NoAnswer {
        doing: &'static str,
        tries: u32,
        waited: Duration,
        counters: Box<LinkCounters>,
    },
    Silent { doing: &'static str, silent: Duration, counters: Box<LinkCounters> },
    Deadline {
        doing: &'static str,
        waited: Duration,
        done: usize,
        total: usize,
        counters: Box<LinkCounters>,
    },
    Refused { doing: &'static str, refusal: Refusal },
    Version {
        robot_min: u8,
        robot_current: u8,
        host_min: u8,
        host_current: u8,
        firmware: String,
    },
    Schema { version: u8, robot_key: u64, host_key: u64, firmware: String },
    UnknownGreeting { firmware: String },
    UnknownAnswer { doing: &'static str },
    SessionLost { doing: &'static str, open: u16 },
    Dropped { doing: &'static str },
    NotConnected { doing: &'static str },
    NotSigned { doing: &'static str },
    WrongReply { doing: &'static str, reply: String },
    OutOfRange {
        doing: &'static str,
        quantity: &'static str,
        value: f64,
        low: f64,
        high: f64,
    },
    StoppedEarly {
        cause: StopCause,
        state: StateName,
        cycle: u32,
        cycles: u32,
        flags: Flags,
    },
    OutOfStep { played: usize, legs: usize },
    NotStored { doing: &'static str },
    Interrupted { doing: &'static str },
}
pub trait Port: Send {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize>;
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;
    fn now(&self) -> Duration;
}
pub struct Robot<P> {}
impl<P: Port> Robot<P> {
    pub fn connect(port: P, seed: u64) -> Result<Self, LinkError> {}
    pub fn connect_with(port: P, config: SessionConfig) -> Result<Self, LinkError> {}
    pub fn stop_at_once(
        port: P,
        seed: u64,
        estop: bool,
    ) -> Result<(P, StoppedBy), LinkError> {}
    pub fn reconnect(&mut self) -> Result<(), LinkError> {}
    pub fn replace_port(&mut self, port: P) -> Result<P, LinkError> {}
    pub fn info(&self) -> &HelloReply {}
    pub fn firmware(&self) -> String {}
    pub fn link_counters(&self) -> LinkCounters {}
    pub fn clock(&self) -> Option<ClockFit> {}
    pub fn answers_signed(&self) -> Option<bool> {}
    pub fn telemetry(&self) -> Option<&Telemetry> {}
    pub fn observe(&mut self, observer: Observer) {}
    pub fn port(&self) -> &P {}
    pub fn port_mut(&mut self) -> &mut P {}
    pub fn map_port<Q: Port>(self, wrap: impl FnOnce(P) -> Q) -> Robot<Q> {}
    pub fn into_port(self) -> P {}
    pub fn listen(
        &mut self,
        time: Duration,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<(), LinkError> {}
    pub fn upload(
        &mut self,
        table: &[u8],
        patience: Duration,
        mut progress: impl FnMut(UploadProgress) -> ControlFlow<()>,
    ) -> Result<TableInfo, LinkError> {}
    pub fn expected_upload(&self, bytes: usize) -> Duration {}
}
impl<P: Port> Robot<P> {
    pub fn wait_until_finished(
        &mut self,
        watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Status, LinkError> {}
    pub fn wait_while(
        &mut self,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Option<Status>, LinkError> {}
}
impl<P: Port> Robot<P> {
    pub fn status(&mut self) -> Result<Status, LinkError> {}
    pub fn counters(&mut self) -> Result<Counters, LinkError> {}
    pub fn configuration(&mut self) -> Result<Configuration, LinkError> {}
    pub fn configure(&mut self, configuration: Configuration) -> Result<(), LinkError> {}
    pub fn servo(&mut self, joint: Joint) -> Result<ServoSettings, LinkError> {}
    pub fn set_servo(
        &mut self,
        joint: Joint,
        settings: ServoSettings,
    ) -> Result<(), LinkError> {}
    pub fn trim(&mut self, joint: Joint, radians: f64) -> Result<(), LinkError> {}
    pub fn arm(&mut self, clear_estop: bool) -> Result<(), LinkError> {}
    pub fn play(
        &mut self,
        cycles: u32,
        period: Duration,
        detached: bool,
    ) -> Result<(), LinkError> {}
    pub fn pause(&mut self, detached: bool) -> Result<(), LinkError> {}
    pub fn resume(&mut self) -> Result<(), LinkError> {}
    pub fn stop(&mut self) -> Result<StoppedBy, LinkError> {}
    pub fn estop(&mut self) -> Result<StoppedBy, LinkError> {}
    pub fn clear_estop(&mut self) -> Result<(), LinkError> {}
    pub fn enter_boot_loader(&mut self) -> Result<(), LinkError> {}
    pub fn bench(&mut self) -> Result<BenchStatus, LinkError> {}
    pub fn pulse_range(&mut self, joint: Joint) -> Result<PulseRange, LinkError> {}
    pub fn set_pulse_range(
        &mut self,
        joint: Joint,
        range: PulseRange,
    ) -> Result<(), LinkError> {}
    pub fn clear_resets(&mut self) -> Result<(), LinkError> {}
    pub fn crash_message(&mut self) -> Result<String, LinkError> {}
    pub fn table(&mut self) -> Result<Option<TableInfo>, LinkError> {}
    pub fn set_key(&mut self, key: Option<Key>) -> Result<(), LinkError> {}
}
impl<P: Port> Robot<P> {
    pub fn expected_upload_while_playing(&self, bytes: usize) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    Request,
    Itself(StopCause),
}
impl std::fmt::Display for StoppedBy {}
pub mod hc05 {
    pub const AT_BAUD: u32 = 38_400;
    #[derive(Debug)]
    pub enum Action {
        Send(String),
        WaitUntil(Duration),
        Done(Result<Outcome, Hc05Error>),
    }
    pub const BAUDS: [u32; 7] = [
        9_600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800,
    ];
    #[derive(Debug)]
    pub struct Dialogue {}
    impl Dialogue {
        pub fn new(wanted: Wanted, only_check: bool) -> Self {}
        pub fn poll(&mut self, now: Duration) -> Action {}
        pub fn receive(&mut self, bytes: &[u8]) {}
    }
    #[derive(Debug, thiserror::Error)]
    pub enum Hc05Error {
        Port { source: io::Error },
        Silent { tries: u32 },
        Noise { bytes: usize },
        Echo,
        NoAtMode { code: String, tries: u32 },
        Stopped { command: String },
        Refused { command: String, code: String },
        NotKept { setting: &'static str, wanted: String, found: String },
    }
    #[derive(Debug, Clone, PartialEq, Eq, Default)]
    pub struct Module {
        pub version: Option<String>,
        pub role: Option<u8>,
        pub name: Option<String>,
        pub pin: Option<String>,
        pub uart: Option<Uart>,
    }
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct Outcome {
        pub before: Module,
        pub after: Module,
        pub differed: Vec<Setting>,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Setting {
        Role,
        Name,
        Pin,
        Uart,
    }
    impl Setting {
        pub fn word(self) -> &'static str {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct Uart {
        pub baud: u32,
        pub stop: u8,
        pub parity: u8,
    }
    impl Uart {
        pub const fn at(baud: u32) -> Self {}
    }
    impl fmt::Display for Uart {}
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct Wanted {}
    impl Wanted {
        pub fn new(
            baud: u32,
            name: Option<String>,
            pin: Option<String>,
        ) -> Result<Self, WantedError> {}
    }
    #[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
    pub enum WantedError {
        Baud { baud: u32 },
        Name(String),
        Pin(String),
    }
    pub fn converse(
        port: &mut impl Port,
        wanted: &Wanted,
        only_check: bool,
    ) -> Result<Outcome, Hc05Error> {}
}
pub mod port {
    #[derive(Debug)]
    pub struct BesidePort {}
    impl BesidePort {
        pub fn open(path: &Path) -> io::Result<Self> {}
    }
    impl Port for BesidePort {}
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct Character {
        pub byte: u8,
        pub framing: bool,
        pub silent: bool,
    }
    pub trait Device: Send {
        fn advance(&mut self, to: Duration);
        fn receive(&mut self, bytes: &[u8]);
        fn transmit(&mut self, room: usize, out: &mut Vec<u8>);
        fn expect_quiet(&mut self, until: Duration, travel: Duration) {}
        fn failure(&self) -> Option<&(dyn Error + Send + Sync + 'static)> {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub struct FaultCounts {
        pub frames: u64,
        pub dropped: u64,
        pub flipped: u64,
        pub duplicated: u64,
        pub detoured: u64,
        pub stale_bytes: u64,
        pub misread: u64,
        pub cut_off: u64,
        pub overflowed: u64,
    }
    #[derive(Debug)]
    pub struct FaultInjector {}
    impl FaultInjector {
        pub fn new(faults: Faults, rng: ChaCha8Rng) -> Self {}
        pub fn counts(&self) -> FaultCounts {}
        pub fn set_faults(&mut self, faults: Faults) {}
        pub fn disconnect(&mut self, outage: Outage) {}
        pub fn push(&mut self, now: Duration, bytes: &[u8]) {}
        pub fn next_release(&self) -> Option<Duration> {}
        pub fn pop(&mut self, now: Duration, out: &mut Vec<u8>) {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    pub struct FaultPlan {
        pub written: Faults,
        pub read: Faults,
    }
    impl FaultPlan {
        pub fn at_host(faults: Faults) -> Self {}
        pub fn at_robot(faults: Faults) -> Self {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    pub struct Faults {
        pub drop: f64,
        pub flip: f64,
        pub duplicate: f64,
        pub reorder: f64,
        pub delay: Duration,
        pub clump: usize,
        pub stale: usize,
        pub baud: Option<u32>,
        pub rate: Option<u32>,
        pub buffer: usize,
        pub disconnect: Option<Outage>,
    }
    impl Faults {
        pub const LONGEST_HOLD: Duration = Duration::from_secs(1);
        pub const LONGEST_DETOUR: Duration = Duration::from_millis(100);
        pub const QUIET: Duration = Duration::from_millis(300);
        pub const BAUD: u32 = 115_200;
        pub fn none() -> Self {}
    }
    impl FromStr for Faults {
        type Err = FaultsError;
    }
    #[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
    pub struct FaultsError {
        pub column: usize,
        pub problem: FaultsProblem,
    }
    #[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
    pub enum FaultsProblem {
        NotAPair(String),
        UnknownName(String),
        NotAChance { name: String, value: String },
        NotACount { name: String, value: String, unit: &'static str, most: u64 },
        NotARate(String),
        NotABaudRate(String),
        NotAnOutage(String),
        Twice(String),
    }
    #[derive(Debug)]
    pub struct FaultyPort<P> {}
    impl<P: Port> FaultyPort<P> {
        pub fn new(port: P, plan: FaultPlan, seed: u64) -> Self {}
        pub fn inner(&self) -> &P {}
        pub fn inner_mut(&mut self) -> &mut P {}
        pub fn counts(&self) -> (FaultCounts, FaultCounts) {}
        pub fn disconnect(&mut self, outage: Outage) {}
        pub fn set_plan(&mut self, plan: FaultPlan) {}
    }
    impl<P: Port> Port for FaultyPort<P> {}
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct ListedPort {
        pub path: String,
        pub about: String,
    }
    impl fmt::Display for ListedPort {}
    #[derive(Debug)]
    pub struct MockPort {}
    impl MockPort {
        pub fn pair() -> (Self, Self) {}
        pub fn pass(&self, time: Duration) {}
    }
    impl Drop for MockPort {}
    impl Port for MockPort {}
    #[derive(Debug, thiserror::Error)]
    pub enum OpenError {
        Busy { path: String },
        NoPermission { path: String, group: Option<String> },
        Missing { path: String },
        NoSerialPort { path: String },
        Other { path: String, reason: String },
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct Outage {
        pub from: Duration,
        pub lasting: Duration,
        pub every: Option<Duration>,
    }
    impl Outage {
        pub fn once(from: Duration, lasting: Duration) -> Self {}
        pub fn covers(&self, at: Duration) -> bool {}
    }
    pub use crate::Port;
    #[derive(Debug, thiserror::Error)]
    pub enum PtyError {
        NoTerminal(io::Error),
        Occupied(PathBuf),
        InUse { link: PathBuf, target: PathBuf },
        Link { link: PathBuf, source: io::Error },
    }
    #[derive(Debug)]
    pub struct PtyPort {}
    impl PtyPort {
        pub fn open(link: Option<&Path>) -> Result<Self, PtyError> {}
        pub fn path(&self) -> &Path {}
        pub fn client_present(&self) -> bool {}
    }
    impl Drop for PtyPort {}
    impl Port for PtyPort {}
    #[derive(Debug)]
    pub struct SerialPort {}
    impl SerialPort {
        pub fn open(path: &str, baud: u32) -> Result<Self, OpenError> {}
    }
    impl Port for SerialPort {}
    #[derive(Debug)]
    pub struct TcpPort {}
    impl TcpPort {
        pub fn listen(address: impl ToSocketAddrs) -> io::Result<Self> {}
        pub fn connect(address: impl ToSocketAddrs) -> io::Result<Self> {}
        pub fn local_addr(&self) -> Option<SocketAddr> {}
        pub fn client_present(&self) -> bool {}
    }
    impl Port for TcpPort {}
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct TracedFrame<'a> {
        pub at: Duration,
        pub direction: Direction,
        pub bytes: &'a [u8],
    }
    pub struct TracedPort<P, S> {}
    impl<P: Port, S: FnMut(TracedFrame<'_>) + Send> TracedPort<P, S> {
        pub fn new(port: P, sink: S) -> Self {}
        pub fn inner(&self) -> &P {}
        pub fn inner_mut(&mut self) -> &mut P {}
        pub fn into_parts(self) -> (P, S) {}
    }
    impl<P: Port, S: FnMut(TracedFrame<'_>) + Send> Port for TracedPort<P, S> {}
    #[derive(Debug)]
    pub struct VirtualPort<D> {}
    impl<D: Device> VirtualPort<D> {
        pub fn new(device: D, speed: WireSpeed) -> Self {}
        pub fn device(&self) -> &D {}
        pub fn device_mut(&mut self) -> &mut D {}
        pub fn map_device<E: Device>(self, wrap: impl FnOnce(D) -> E) -> VirtualPort<E> {}
        pub fn into_device(self) -> D {}
        pub fn pass(&mut self, time: Duration) {}
    }
    impl<D: Device> Port for VirtualPort<D> {}
    #[derive(Debug)]
    pub struct Wire {}
    impl Wire {
        pub fn new(speed: WireSpeed) -> Self {}
        pub fn push(&mut self, now: Duration, bytes: &[u8]) {}
        pub fn room(&self, until: Duration) -> usize {}
        pub fn latency(&self) -> Duration {}
        pub fn next_arrival(&self) -> Option<Duration> {}
        pub fn pop(&mut self, now: Duration, out: &mut Vec<u8>) {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct WireSpeed {
        pub baud: u32,
        pub latency: Duration,
    }
    impl WireSpeed {
        pub fn robot() -> Self {}
        pub fn hc05() -> Self {}
        pub fn byte_time(&self) -> Duration {}
    }
    pub fn heard(bytes: &[u8], sent_baud: u32, read_baud: u32) -> Vec<Character> {}
    pub fn serial_ports() -> Vec<ListedPort> {}
}
pub mod robot {
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct Leg {
        pub table: Vec<u8>,
        pub cycles: u32,
        pub period: Duration,
    }
    pub type Observer = Box<dyn FnMut(&Telemetry, Duration) + Send>;
    pub use crate::Robot;
    #[derive(Debug)]
    pub struct Sequence {}
    impl Sequence {
        pub fn playing_first(legs: Vec<Leg>) -> Self {}
        pub fn go_on<P: Port>(
            &mut self,
            robot: &mut Robot<P>,
            mut watch: impl FnMut(SequenceProgress<'_>) -> ControlFlow<()>,
        ) -> Result<Option<Status>, LinkError> {}
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SequenceProgress<'a> {
        pub leg: usize,
        pub telemetry: Option<&'a Telemetry>,
    }
    pub use crate::StoppedBy;
    pub fn time_left(status: &Status) -> Option<Duration> {}
    pub mod await_play {
        pub fn at_rest(state: StateName, cause: StopCause) -> bool {}
        pub fn finished(status: Status) -> Result<Status, LinkError> {}
        pub use crate::robot::time_left;
    }
    pub mod sequence {
        pub use crate::robot::Leg;
        pub use crate::robot::Sequence;
        pub use crate::robot::SequenceProgress;
    }
}
pub mod session {
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    pub struct ClockFit {
        pub origin: f64,
        pub robot_at_origin: f64,
        pub rate: f64,
        pub uncertainty: f64,
        pub pings: usize,
    }
    impl ClockFit {
        pub fn robot_time(&self, host: Duration) -> f64 {}
        pub fn host_time(&self, robot: f64) -> f64 {}
    }
    #[derive(Debug, Default)]
    pub struct ClockSamples {}
    impl ClockSamples {
        pub fn push(&mut self, pong: &Pong, now: Duration) -> Option<Duration> {}
        pub fn clear(&mut self) {}
        pub fn fit(&self) -> Option<ClockFit> {}
    }
    #[derive(Debug)]
    pub enum Event {
        Connected { ticket: Ticket, restarted: bool },
        Answered { ticket: Ticket, reply: Reply },
        StoppedByItself { ticket: Ticket, cause: StopCause },
        Uploaded { ticket: Ticket, table: TableInfo },
        Progress { ticket: Ticket, progress: UploadProgress },
        Failed { ticket: Ticket, error: LinkError },
        Telemetry { telemetry: Telemetry, at: Duration },
    }
    pub const KEEP_ALIVE: Duration = Duration::from_millis(50);
    pub const LONGEST_SILENCE: Duration = Duration::from_secs(5);
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub struct LinkCounters {
        pub frames_sent: u64,
        pub bytes_sent: u64,
        pub bytes_received: u64,
        pub received: DecodeCounters,
        pub retransmissions: u64,
        pub keep_alives: u64,
        pub echoed: u64,
        pub unsigned: u64,
        pub forged: u64,
        pub foreign: u64,
        pub unmatched: u64,
        pub telemetry: u64,
        pub late_telemetry: u64,
        pub sessions: u64,
        pub given_up: u64,
        pub round_trip: Option<Duration>,
    }
    impl fmt::Display for LinkCounters {}
    pub use crate::LinkError;
    #[derive(Debug)]
    pub struct Session {}
    impl Session {
        pub fn new(config: SessionConfig) -> Self {}
        pub fn connect(&mut self, now: Duration) -> Ticket {}
        pub fn request(&mut self, now: Duration, request: Request) -> Ticket {}
        pub fn upload(
            &mut self,
            now: Duration,
            slot: u8,
            table: &[u8],
            deadline: Duration,
        ) -> Ticket {}
        pub fn upload_follower(
            &mut self,
            now: Duration,
            table: &[u8],
            (cycles, period_us): (u32, u32),
            deadline: Duration,
        ) -> Ticket {}
        pub fn set_key(&mut self, key: Option<Key>) {}
        pub fn cancel_upload(&mut self) {}
        pub fn forget(&mut self, ticket: Ticket) {}
        pub fn take_outgoing(&mut self) -> Vec<u8> {}
        pub fn next_event(&mut self) -> Option<Event> {}
        pub fn hello(&self) -> Option<&HelloReply> {}
        pub fn clock(&self) -> Option<ClockFit> {}
        pub fn counters(&self) -> LinkCounters {}
        pub fn last_heard(&self) -> Duration {}
        pub fn answers_signed(&self) -> Option<bool> {}
    }
    impl Session {
        pub fn poll(&mut self, now: Duration) {}
        pub fn next_deadline(&self) -> Option<Duration> {}
    }
    impl Session {
        pub fn receive(&mut self, now: Duration, bytes: &[u8]) {}
    }
    impl Session {
        pub fn expected_upload(&self, bytes: usize) -> Option<Duration> {}
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SessionConfig {
        pub seed: u64,
        pub bytes_per_second: f64,
        pub key: Option<Key>,
    }
    impl SessionConfig {
        pub fn new(seed: u64) -> Self {}
    }
    pub const TRIES: u32 = 5;
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub struct Ticket(pub(super) _);
    impl Ticket {
        pub fn number(self) -> u64 {}
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum UploadPhase {
        Begin,
        Chunks,
        Commit,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct UploadProgress {
        pub phase: UploadPhase,
        pub done: usize,
        pub total: usize,
    }
    pub fn cause_in_words(cause: StopCause) -> &'static str {}
    pub fn cycles_in_words(cycle: u32, cycles: u32) -> String {}
}
