// What `twin` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

pub use host_link::port::VirtualPort;
pub use host_link::port::WireSpeed;
#[derive(Debug, Clone)]
pub struct Camera {}
impl Camera {
    pub const RATE_HZ: u32 = 100;
    pub fn new(config: CameraConfig, reach: f64, seed: u64, recording: u64) -> Self {}
    pub fn expose(&mut self, pose: &Pose<f64>) -> Frame {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct CameraConfig {
    pub noise_sd: f64,
    pub single_dropout: f64,
    pub burst_dropout: f64,
    pub height: f64,
    pub take: String,
    pub capture_start: String,
}
impl Default for CameraConfig {}
impl CameraConfig {
    pub fn perfect() -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleStart {
    pub at: Duration,
    pub pose: Pose<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    pub logged: Telemetry,
    pub replayed: Option<Telemetry>,
}
pub type Frame = [Point; 4];
#[derive(Debug)]
pub struct MotiveFile {}
impl MotiveFile {
    pub fn create(
        path: &Path,
        config: &CameraConfig,
        seed: u64,
    ) -> Result<Self, TrackError> {}
    pub fn path(&self) -> &Path {}
    pub fn frames(&self) -> u64 {}
    pub fn push(&mut self, frame: &Frame) -> Result<(), TrackError> {}
    pub fn finish(mut self) -> Result<u64, TrackError> {}
}
impl Drop for MotiveFile {}
pub type Point = Option<[f64; 3]>;
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub path: PathBuf,
    pub frames: u64,
    pub started: Duration,
    pub cycle_starts: Vec<CycleStart>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    NoGreeting,
    NoTelemetry,
    NoClock,
    TurnedAway,
    NotAtRest(StateName),
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replayed {
    pub compared: usize,
    pub different: usize,
    pub requests: usize,
    pub first: Option<Difference>,
    pub seconds: f64,
    pub missing_table: Option<u32>,
}
#[derive(Debug, Clone)]
pub struct Servos {}
impl Servos {
    pub fn new(maps: [ServoMap; 2], plant: PlantParameters) -> Self {}
    pub fn angles(&self) -> [f64; 2] {}
    pub fn set_pulses(&mut self, pulses_ns: Option<[u32; 2]>) {}
    pub fn advance(&mut self, seconds: f64, mut visit: impl FnMut(Vector2<f64>)) {}
}
#[derive(Debug, Clone)]
pub struct Tank {}
impl Tank {
    pub fn new(swimmer: &Swimmer<f64>, pose: Pose<f64>) -> Result<Self, InvalidSwimmer> {}
    pub fn pose(&self) -> Pose<f64> {}
    pub fn phi(&self) -> Vector2<f64> {}
    pub fn move_joints(&mut self, phi: Vector2<f64>) {}
}
#[derive(Debug, thiserror::Error)]
pub struct TrackError {
    pub path: PathBuf,
    pub source: io::Error,
}
pub struct Twin {}
impl std::fmt::Debug for Twin {}
impl Twin {
    pub fn new(config: TwinConfig) -> Result<Self, InvalidSwimmer> {}
    pub fn now(&self) -> Duration {}
    pub fn pose(&self) -> Pose<f64> {}
    pub fn angles(&self) -> [f64; 2] {}
    pub fn output(&self) -> Option<&Output> {}
    pub fn state(&self) -> StateName {}
    pub fn flash(&self) -> &MemoryStorage {}
    pub fn config(&self) -> &TwinConfig {}
    pub fn set_link_up(&mut self, link_up: bool) {}
    pub fn cycle_starts(&self) -> &[CycleStart] {}
    pub fn start_recording(&mut self, path: &Path) -> Result<(), TrackError> {}
    pub fn finish_recording(&mut self) -> Result<Option<Recording>, TrackError> {}
    pub fn advance(&mut self, to: Duration) {}
}
impl VirtualRobot for Twin {}
impl Device for Twin {}
#[derive(Debug, Clone)]
pub struct TwinConfig {
    pub swimmer: Swimmer<f64>,
    pub plant: PlantParameters,
    pub limits: Limits,
    pub belief: Configuration,
    pub servos: [ServoSettings; 2],
    pub shafts: [ServoMap; 2],
    pub battery_mv: u16,
    pub camera: CameraConfig,
    pub flash: MemoryStorage,
    pub transport: Transport,
    pub reset_reason: ResetReason,
    pub seed: u64,
}
impl TwinConfig {
    pub fn new(file: &SwimmerFile, seed: u64) -> Self {}
    pub fn from_parts(swimmer: Swimmer<f64>, servo: &ServoFile, seed: u64) -> Self {}
    #[must_use]
    pub fn with_ideal_servos(mut self) -> Self {}
}
pub type TwinPort = VirtualPort<Twin>;
pub trait VirtualRobot: Device {
    fn world(&self) -> &World;
    fn world_mut(&mut self) -> &mut World;
}
#[derive(Debug)]
pub struct World {}
impl World {
    pub fn new(config: &TwinConfig) -> Result<Self, InvalidSwimmer> {}
    pub fn now(&self) -> Duration {}
    pub fn pose(&self) -> Pose<f64> {}
    pub fn angles(&self) -> [f64; 2] {}
    pub fn set_pulses(&mut self, pulses_ns: Option<[u32; 2]>) {}
    pub fn begin_cycle(&mut self) {}
    pub fn cycle_starts(&self) -> &[CycleStart] {}
    pub fn start_recording(&mut self, path: &Path) -> Result<(), TrackError> {}
    pub fn recording_failed(&self) -> Option<&TrackError> {}
    pub fn finish_recording(&mut self) -> Result<Option<Recording>, TrackError> {}
    pub fn advance(&mut self, to: Duration) {}
}
pub fn configuration(swimmer: &Swimmer<f64>, servo: &ServoFile) -> Configuration {}
pub fn is_configured_as(present: &Configuration, swimmer: &Swimmer<f64>) -> bool {}
pub fn replay(
    frames: &[LinkFrame],
    table: Option<&GaitTable>,
) -> Result<Replayed, ReplayError> {}
pub fn serve<R: VirtualRobot + ?Sized>(
    robot: &mut R,
    ports: &mut [&mut dyn Port],
    mut go_on: impl FnMut(&R) -> bool,
) -> io::Result<()> {}
