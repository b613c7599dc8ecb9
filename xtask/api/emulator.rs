// What `emulator` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug)]
pub struct Board {}
impl Board {
    pub fn start(config: &BoardConfig) -> Result<Self, EmulatorError> {}
    pub fn now(&self) -> Duration {}
    pub fn powered(&self) -> bool {}
    pub fn run(&mut self, until: Duration) -> Result<(), EmulatorError> {}
    pub fn run_past_byte(
        &mut self,
        until: Duration,
        after_byte: Duration,
    ) -> Result<(), EmulatorError> {}
    pub fn feed(&mut self, bytes: &[u8]) -> Result<(), EmulatorError> {}
    pub fn feed_usb(&mut self, bytes: &[u8]) -> Result<(), EmulatorError> {}
    pub fn feed_characters(
        &mut self,
        characters: &[Character],
    ) -> Result<(), EmulatorError> {}
    pub fn save_flash(&mut self, path: &Path) -> Result<(), EmulatorError> {}
    pub fn load_flash(&mut self, path: &Path) -> Result<(), EmulatorError> {}
    pub fn stack(&mut self) -> Result<Stack, EmulatorError> {}
    pub fn put_flash_behind_cache(&mut self) -> Result<(), EmulatorError> {}
    pub fn patch(&mut self, address: u32, halfword: u16) -> Result<(), EmulatorError> {}
    pub fn symbols(
        &mut self,
        containing: &str,
    ) -> Result<BTreeMap<String, u32>, EmulatorError> {}
    pub fn peek(&mut self, address: u32, count: u32) -> Result<Vec<u8>, EmulatorError> {}
    pub fn take_events(&mut self) -> Events {}
    pub fn take_sent(
        &mut self,
        line: Line,
        now: Duration,
        room: usize,
        out: &mut Vec<u8>,
    ) {}
}
impl Drop for Board {}
impl Board {
    pub fn set_connected(&mut self, up: bool) -> Result<(), EmulatorError> {}
    pub fn set_battery(&mut self, volts: f64) -> Result<(), EmulatorError> {}
    pub fn cut_power_after(&mut self, flash_bytes: u32) -> Result<(), EmulatorError> {}
    pub fn set_erase_time(&mut self, time: Duration) -> Result<(), EmulatorError> {}
    pub fn set_plugged(&mut self, plugged: bool) -> Result<(), EmulatorError> {}
    pub fn set_jumper(&mut self, closed: bool) -> Result<(), EmulatorError> {}
    pub fn set_button(&mut self, pressed: bool) -> Result<(), EmulatorError> {}
    pub fn power_cycle(&mut self) -> Result<(), EmulatorError> {}
    pub fn pin_reset(&mut self) -> Result<(), EmulatorError> {}
    pub fn boot_rom_reset(&mut self) -> Result<(), EmulatorError> {}
    pub fn debugger_reset(&mut self) -> Result<(), EmulatorError> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct BoardConfig {
    pub scripts: PathBuf,
    pub firmware: PathBuf,
    pub kind: BoardKind,
}
impl BoardConfig {
    pub fn missing(&self) -> Option<EmulatorError> {}
}
impl BoardConfig {
    pub fn of_checkout(place: &Path, target: Option<&Path>, kind: BoardKind) -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardKind {
    NanoConnect,
    Pico,
}
impl BoardKind {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Edge {
    pub pin: Servo,
    pub high: bool,
}
impl Edge {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug)]
pub struct EmulatedRobot {}
impl EmulatedRobot {
    pub fn new(mut board: Board, world: World) -> Result<Self, EmulatorError> {}
    pub fn over_usb(mut self) -> Result<Self, EmulatorError> {}
    #[must_use]
    pub fn with_log_reader(
        mut self,
        reader: impl FnMut(&LogLine) + Send + 'static,
    ) -> Self {}
    #[must_use]
    pub fn without_events(mut self) -> Self {}
    pub fn board_mut(&mut self) -> &mut Board {}
    pub fn take_events(&mut self) -> Events {}
    pub fn last_heard(&self) -> Duration {}
}
impl Device for EmulatedRobot {}
impl VirtualRobot for EmulatedRobot {}
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    Missing { what: &'static str, path: PathBuf, advice: &'static str },
    Node(std::io::Error),
    Gone { command: String, why: String },
    Failed { command: String, why: String },
}
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct Events {
    pub periods: Vec<Period>,
    pub edges: Vec<Edge>,
    pub led: Vec<Led>,
    pub resets: Vec<Reset>,
    pub power_cuts: Vec<PowerCut>,
    pub loader: Vec<Loader>,
    pub patch_reached: Vec<PatchReached>,
    pub erased: u32,
    pub programmed: u32,
    pub lost: u64,
    pub warnings: BTreeMap<String, u32>,
    pub log: Vec<LogLine>,
}
impl Events {
    pub fn append(&mut self, later: Self) {}
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Led {
    pub on: bool,
}
impl Led {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Line {
    Uart,
    Usb,
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Loader {
    pub activity_pins: u32,
    pub disabled_interfaces: u32,
}
impl Loader {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    Trace,
    Debug,
    Info,
    Warn,
    Error,
}
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    pub at: Duration,
    pub level: LogLevel,
    pub text: String,
}
impl fmt::Display for LogLine {}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PatchReached {}
impl PatchReached {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Period {
    pub misses: u64,
}
impl Period {
    pub fn at(&self) -> Duration {}
    pub fn compares(&self) -> [u32; 2] {}
    pub fn pulses_us(&self) -> [f64; 2] {}
    pub fn length_us(&self) -> f64 {}
    pub fn busy_ms(&self) -> f64 {}
    pub fn control_ms(&self) -> f64 {}
    pub fn tick_ms(&self) -> f64 {}
    pub fn powered(&self) -> bool {}
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PowerCut {}
impl PowerCut {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Reset {
    pub reason: u32,
}
impl Reset {
    pub fn at(&self) -> Duration {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Servo {
    Front,
    Back,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub struct Stack {
    pub left: u32,
    pub size: u32,
}
impl Stack {
    pub fn used(&self) -> u32 {}
}
pub fn commission(
    robot: EmulatedRobot,
    config: &TwinConfig,
) -> Result<VirtualPort<EmulatedRobot>, LinkError> {}
