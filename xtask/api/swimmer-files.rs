// What `swimmer-files` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AngleError {
    Unreadable { text: String },
    Degrees { text: String, radians: f64 },
}
#[derive(Debug, Clone, PartialEq)]
pub struct AnyGait {}
impl AnyGait {
    pub fn circle(amplitude: f64) -> Self {}
    pub fn square(amplitude: f64) -> Self {}
    pub fn from_file(file: &GaitFile) -> Result<Self, InvalidSamples> {}
    pub fn from_samples(
        u: &[f64],
        phi: &[Vector2<f64>],
        corners: &[usize],
    ) -> Result<Self, InvalidSamples> {}
    #[must_use]
    pub fn reversed_if(mut self, reverse: bool) -> Self {}
}
impl Gait<f64> for AnyGait {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ArcKind {
    Singular,
    Upper,
    Lower,
    Diagonal,
    Clearance,
    Regular,
    Extreme,
}
impl serde::Serialize for ArcKind {}
impl ArcKind {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axes {
    pub x: (usize, bool),
    pub y: (usize, bool),
}
impl Axes {
    pub const IMAGE: Self = Self {
        x: (0, false),
        y: (1, true),
    };
}
impl fmt::Display for Axes {}
impl FromStr for Axes {
    type Err = String;
}
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    pub max_angle: Option<f64>,
    pub min_angle: Option<f64>,
    pub sector: bool,
    pub no_overlap: bool,
    pub clearance: f64,
}
impl Bounds {
    pub fn within(max_angle: f64) -> Self {}
    #[must_use]
    pub fn apart(self, clearance: f64) -> Self {}
}
impl fmt::Display for Bounds {}
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    pub swimmer: SwimmerFile,
    pub swimmer_path: Option<PathBuf>,
    pub reflectors: Reflectors,
    pub tracks: TrackSettings,
    pub known: Known,
    pub runs: Vec<CampaignRun>,
}
impl Campaign {
    pub fn load(path: &Path) -> Result<Self, FileError> {}
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {}
    pub fn parse_with(
        text: &str,
        path: &Path,
        text_of: impl Fn(&Path) -> Option<String>,
    ) -> Result<Self, FileError> {}
    pub fn included(&self) -> impl Iterator<Item = usize> {}
    pub fn files(path: &Path) -> Result<Vec<PathBuf>, FileError> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignRun {
    pub track: PathBuf,
    pub told: Option<ToldRun>,
    pub gait: GaitSpec,
    pub period_s: f64,
    pub front: Option<PointName>,
    pub timing: RunTiming,
    pub exclude: Option<String>,
}
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    Read { path: PathBuf, source: std::io::Error },
    Write { path: PathBuf, source: std::io::Error },
    Content { path: PathBuf, line: usize, column: usize, problem: String },
}
impl FileError {
    pub fn at(
        path: &Path,
        line: usize,
        column: usize,
        problem: impl Into<String>,
    ) -> Self {}
    pub fn place(&self) -> Option<(usize, usize)> {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fluid {
    pub kinematic_viscosity: f64,
    pub density: f64,
}
impl Fluid {
    pub fn viscosity(&self) -> f64 {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaitArc {
    pub kind: ArcKind,
    pub from: f64,
    pub to: f64,
}
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GaitFile {
    pub objective: Objective,
    pub swimmer_name: Option<String>,
    pub swimmer_hash: Option<SwimmerHash>,
    pub bounds: Bounds,
    pub arcs: Vec<GaitArc>,
    pub corners: Vec<f64>,
    pub u: Vec<f64>,
    pub phi: Vec<Vector2<f64>>,
}
impl GaitFile {
    pub const VERSION: u32 = 1;
    pub const FEWEST_SAMPLES: usize = 9;
    pub const CLOSURE: f64 = 1e-9;
    pub fn load(path: &Path) -> Result<Self, FileError> {}
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {}
    pub fn to_text(&self) -> String {}
    pub fn save(&self, path: &Path) -> Result<(), FileError> {}
}
impl GaitFile {
    pub fn sampled(gait: &impl Gait<f64>, samples: usize) -> Self {}
    #[must_use]
    pub fn reversed(&self) -> Self {}
    #[must_use]
    pub fn begun_at(&self, sample: usize) -> Self {}
}
#[derive(Debug, Clone, PartialEq)]
pub enum GaitSpec {
    Circle { amplitude: f64, clockwise: bool },
    Square { amplitude: f64, clockwise: bool },
    File { path: PathBuf, reversed: bool },
}
impl FromStr for GaitSpec {
    type Err = GaitSpecError;
}
impl fmt::Display for GaitSpec {}
impl GaitSpec {
    #[must_use]
    pub fn from_folder(self, folder: &Path) -> Self {}
    pub fn readable(&self) -> String {}
    pub fn load(&self) -> Result<AnyGait, FileError> {}
    pub fn load_by<E: From<FileError>>(
        &self,
        read: impl FnOnce(&Path) -> Result<GaitFile, E>,
    ) -> Result<AnyGait, E> {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GaitSpecError {
    Amplitude { text: String, source: crate::AngleError },
    Size { text: String, amplitude: f64, largest: f64 },
    Misspelt { text: String, meant: String },
    Empty,
}
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct InputHash {
    pub file: String,
    pub sha256: String,
}
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Known {
    pub gain: Option<KnownValue>,
    pub camera_scale: Option<KnownValue>,
    pub reflector: Option<KnownValue>,
    pub reflector_angle: Option<KnownValue>,
    pub offset: Option<KnownValue>,
    pub dead_band: Option<KnownValue>,
    pub c_t: Option<KnownValue>,
    pub period: Option<KnownValue>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownValue {
    pub value: f64,
    pub width: f64,
}
impl FromStr for KnownValue {
    type Err = String;
}
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkFrame {
    pub direction: Direction,
    pub host_time_ns: u64,
    pub robot_time_us: Option<u64>,
    pub bytes: Vec<u8>,
}
impl LinkFrame {
    pub fn received(&self) -> Option<Received> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct LinkLog {
    pub frames: Vec<LinkFrame>,
    pub ended: bool,
}
#[derive(Debug, thiserror::Error)]
pub enum LinkLogError {
    File(FileError),
    NoLinkLog { path: PathBuf, what: &'static str },
    Container { path: PathBuf, problem: String },
    Message { path: PathBuf, index: usize, problem: String },
}
pub struct LinkLogWriter {}
impl LinkLogWriter {
    pub fn create(path: &Path) -> Result<Self, LinkLogError> {}
    pub fn write(&mut self, frame: &LinkFrame) -> Result<(), LinkLogError> {}
    pub fn finish(mut self) -> Result<(), LinkLogError> {}
}
impl Drop for LinkLogWriter {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Objective {
    Displacement,
    Efficiency,
    Turning,
    Sideways,
    Speed,
    JoinedForward,
    JoinedSideways,
    JoinedTurning,
    Unspecified,
}
impl Objective {
    pub fn is_joined(self) -> bool {}
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Play {
    pub period_s: f64,
    pub started_s: f64,
    pub ended_s: f64,
    pub cycle_starts: Vec<f64>,
    pub unsteady: Vec<f64>,
    pub told: Vec<(f64, [f64; 2])>,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Playlist {
    pub swimmer: Option<String>,
    pub steps: Vec<PlaylistStep>,
}
impl Playlist {
    pub fn load(path: &Path) -> Result<Self, FileError> {}
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {}
    pub fn to_text(&self) -> String {}
    pub fn save(&self, path: &Path) -> Result<(), FileError> {}
    pub fn duration(&self) -> f64 {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct PlaylistStep {
    pub gait: GaitSpec,
    pub curve: AnyGait,
    pub made_for: Option<(Option<String>, SwimmerHash)>,
    pub cycles: u32,
    pub period: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub enum PointName {
    Named(String),
    Columns(String, String),
    Auto,
    Near([f64; 2]),
}
impl std::str::FromStr for PointName {
    type Err = String;
}
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Provenance {
    pub made_by: String,
    pub inputs: Vec<InputHash>,
}
impl Provenance {
    pub fn of_files(
        made_by: &str,
        files: &[PathBuf],
        folder: &Path,
    ) -> Result<Self, FileError> {}
    pub fn save_with(
        &self,
        swimmer: &SwimmerFile,
        path: &Path,
    ) -> Result<(), FileError> {}
    pub fn load(path: &Path) -> Result<Option<Self>, FileError> {}
    pub fn changed(&self, folder: &Path) -> Vec<&str> {}
    pub fn to_toml(&self) -> String {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Reflector {
    pub point: PointName,
    pub at: [f64; 2],
}
#[derive(Debug, Clone, PartialEq)]
pub struct Reflectors {
    pub front: Reflector,
    pub back: Reflector,
    pub sides: Option<[Reflector; 2]>,
}
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunTiming {
    pub cycle_start_s: Option<f64>,
    pub log: Option<PathBuf>,
    pub play: Option<usize>,
    pub clock_offset_s: Option<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoFile {
    pub max_angle: f64,
    pub max_rate: f64,
    pub dead_band: f64,
    pub slope_rad_per_us: f64,
    pub centre_us: f64,
    pub torque: Option<f64>,
    pub no_load_rate: Option<f64>,
}
impl Default for ServoFile {}
#[derive(Debug, Clone, PartialEq)]
pub struct SwimmerFile {
    pub name: String,
    pub swimmer: Swimmer<f64>,
    pub fluid: Option<Fluid>,
    pub servo: Option<ServoFile>,
}
impl SwimmerFile {
    pub const PRESETS: [&'static str; 3] = ["purcell", "robot", "robot-slender"];
    pub fn preset(name: &str) -> Option<Self> {}
    pub fn find(preset_or_path: &str) -> Result<Self, FileError> {}
    pub fn find_from(preset_or_path: &str, folder: &Path) -> Result<Self, FileError> {}
    pub fn load(path: &Path) -> Result<Self, FileError> {}
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {}
    pub fn save(&self, path: &Path) -> Result<(), FileError> {}
    pub fn to_toml(&self) -> String {}
    pub fn doubts(&self) -> Vec<String> {}
    pub fn hash(&self) -> SwimmerHash {}
    #[must_use]
    pub fn fitted(&self, sphere_radius: f64, chi: f64) -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SwimmerHash(_);
impl SwimmerHash {
    pub fn of(swimmer: &Swimmer<f64>) -> Self {}
    pub fn as_bytes(&self) -> &[u8; 32] {}
}
impl fmt::Display for SwimmerHash {}
impl FromStr for SwimmerHash {
    type Err = &'static str;
}
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ToldRun {
    pub x: Option<ToldValue>,
    pub y: Option<ToldValue>,
    pub turn: Option<ToldValue>,
    pub delta_y: Option<ToldValue>,
    pub delta_theta: Option<ToldValue>,
    pub cycles: Option<usize>,
    pub table: Option<PathBuf>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToldValue {
    pub mean: f64,
    pub sd: Option<f64>,
    pub se: Option<f64>,
}
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackSettings {
    pub scale: Option<f64>,
    pub rate_hz: Option<f64>,
    pub axes: Option<Axes>,
    pub likelihood: Option<f64>,
}
pub fn hash_of(path: &Path) -> Result<String, FileError> {}
pub fn link_log_bytes(frames: &[LinkFrame]) -> Result<Vec<u8>, LinkLogError> {}
pub fn parse_angle(text: &str) -> Result<f64, AngleError> {}
pub fn parse_joint_angle(text: &str) -> Result<f64, AngleError> {}
pub fn parse_key(text: &str) -> Result<Key, String> {}
pub fn parse_link_log(bytes: &[u8], path: &Path) -> Result<LinkLog, LinkLogError> {}
pub fn read_link_log(path: &Path) -> Result<LinkLog, LinkLogError> {}
pub fn stream_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {}
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {}
pub mod plays {
    pub use crate::Play;
    pub fn plays(frames: &[LinkFrame]) -> Vec<Play> {}
}
