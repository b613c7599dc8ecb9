// What `sweep` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Aim {
    Displacement,
    EfficiencySmall,
    EfficiencyLarge,
    Speed,
    Turning,
    Sideways,
    Stub,
}
impl Aim {
    pub const ALL: [Self; 7] = [
        Self::Displacement,
        Self::EfficiencySmall,
        Self::EfficiencyLarge,
        Self::Speed,
        Self::Turning,
        Self::Sideways,
        Self::Stub,
    ];
    pub fn of_word(word: &str) -> Option<Self> {}
    pub fn word(self) -> &'static str {}
    pub fn quantity(self) -> &'static str {}
}
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    pub name: Field,
    pub values: Values,
}
impl Axis {
    pub fn count(&self) -> u64 {}
    pub fn value(&self, index: u64) -> f64 {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Design {
    Grid,
    Random { count: u64, seed: u64 },
    Sobol { count: u64, seed: u32 },
}
impl Design {
    pub const MOST_SOBOL: u64 = 1 << 16;
}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Doubt {
    pub kind: DoubtKind,
    pub key: u64,
    pub neighbour: u64,
    pub share: Option<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub enum DoubtKind {
    Beaten,
    Lost,
    Jump,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Field {
    Middle,
    Side,
    Front,
    Back,
    Ratio,
    Chi,
    LogAspect,
    HalfThickness,
    OverViscosity,
    Sphere,
    MaxAngle,
    MinAngle,
    Clearance,
    Sector,
    NoOverlap,
    MaxRate,
    Objective,
}
impl Field {
    pub const ALL: [Self; 17] = [
        Self::Middle,
        Self::Side,
        Self::Front,
        Self::Back,
        Self::Ratio,
        Self::Chi,
        Self::LogAspect,
        Self::HalfThickness,
        Self::OverViscosity,
        Self::Sphere,
        Self::MaxAngle,
        Self::MinAngle,
        Self::Clearance,
        Self::Sector,
        Self::NoOverlap,
        Self::MaxRate,
        Self::Objective,
    ];
    pub fn name(self) -> &'static str {}
    pub fn unit(self) -> &'static str {}
    pub fn parse(self, text: &str) -> Option<f64> {}
}
impl fmt::Display for Field {}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Map {
    pub format: &'static str,
    pub plan: String,
    pub objective: &'static str,
    pub axes: [MapAxis; 2],
    pub quantities: Vec<Quantity>,
    pub structure: Vec<Vec<Option<String>>>,
    pub status: Vec<Vec<&'static str>>,
    pub folds: Vec<Vec<[f64; 2]>>,
    pub pareto: Vec<Pareto>,
    pub designs_without_gait: u64,
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapAxis {
    pub name: &'static str,
    pub unit: &'static str,
    pub values: Vec<f64>,
}
impl MapAxis {
    pub fn borders(&self) -> Vec<f64> {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Merged {
    pub tasks: u64,
    pub failed: u64,
    pub certified: u64,
}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pareto {
    pub key: u64,
    pub speed: f64,
    pub efficiency: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {}
impl Plan {
    pub const FILE: &'static str = "plan.toml";
    pub fn of_spec(text: &str, path: &Path) -> Result<Self, SweepError> {}
    pub fn save(&self, folder: &Path) -> Result<PathBuf, SweepError> {}
    pub fn load(folder: &Path) -> Result<Self, SweepError> {}
    pub fn hash(&self) -> String {}
    pub fn objectives(&self) -> Vec<Aim> {}
    pub fn swimmer_name(&self) -> &str {}
    pub fn axes(&self) -> &[Axis] {}
    pub fn design(&self) -> Design {}
    pub fn tasks(&self) -> u64 {}
    pub fn block_size(&self) -> u64 {}
    pub fn blocks(&self) -> u64 {}
    pub fn keys(&self, block: u64) -> std::ops::Range<u64> {}
    pub fn indices(&self, key: u64) -> Vec<u64> {}
    pub fn point(&self, key: u64) -> Vec<f64> {}
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    pub name: &'static str,
    pub unit: &'static str,
    pub values: Vec<Vec<Option<f64>>>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Ran {
    pub tasks: u64,
    pub failed: u64,
    pub blocks: u64,
    pub done: u64,
    pub skipped: u64,
}
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Row {
    pub key: u64,
    pub reason: Option<String>,
    pub warm: bool,
    pub objective: Option<f64>,
    pub displacement_over_length: Option<f64>,
    pub lateral_over_length: Option<f64>,
    pub rotation_rad: Option<f64>,
    pub efficiency: Option<f64>,
    pub speed_over_length_per_s: Option<f64>,
    pub period_s: Option<f64>,
    pub amplitude_rad: Option<f64>,
    pub start_angle_rad: Option<f64>,
    pub end_angle_rad: Option<f64>,
    pub links_cross: Option<f64>,
    pub arcs: Option<String>,
    pub certified: Option<bool>,
}
impl Row {
    pub fn status(&self) -> &'static str {}
}
#[derive(Clone, Copy)]
pub struct Running<'a> {
    pub shard: Shard,
    pub threads: usize,
    pub seconds: &'a (dyn Fn() -> f64 + Sync),
    pub watch: &'a (dyn Fn(Ran) + Sync),
}
impl std::fmt::Debug for Running<'_> {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scale {
    Lin,
    Log,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {}
impl Shard {
    pub const WHOLE: Self = Self { number: 1, of: 1 };
    pub fn new(number: u64, of: u64) -> Option<Self> {}
    pub fn blocks(self, plan: &Plan) -> u64 {}
}
impl std::fmt::Display for Shard {}
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slice {
    pub axes: [usize; 2],
    pub at: Vec<u64>,
}
impl Slice {
    pub fn first(plan: &Plan) -> Option<Self> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Slurm<'a> {
    pub shards: u64,
    pub cores: u64,
    pub minutes: u64,
    pub program: &'a Path,
    pub folder: &'a Path,
    pub options: &'a [String],
}
impl Slurm<'_> {
    pub fn script(&self, plan: &Plan) -> String {}
}
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Status {
    pub plan: String,
    pub tasks: u64,
    pub done: u64,
    pub failed: u64,
    pub uncertified: u64,
    pub warm: u64,
    pub blocks: u64,
    pub blocks_done: u64,
    pub blocks_broken: u64,
    pub bytes: u64,
    pub cold_s: Option<f64>,
    pub warm_s: Option<f64>,
    pub design_s: Option<f64>,
    pub left_s: Option<f64>,
}
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    File(FileError),
    OtherPlan { folder: PathBuf, there: String, ours: String },
    Taken { folder: PathBuf },
    Changed { path: PathBuf },
    OtherVersion { path: PathBuf, theirs: String, ours: String },
    Unfinished { missing: u64, blocks: u64, first: u64 },
    Table { path: PathBuf, problem: String },
    NoMap(String),
}
impl SweepError {
    pub fn is_bad_input(&self) -> bool {}
}
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Values {
    List { values: Vec<f64> },
    Range { from: f64, to: f64, count: u64, scale: Scale },
}
pub fn doubts(plan: &Plan, folder: &Path) -> Result<Vec<Doubt>, SweepError> {}
pub fn map(plan: &Plan, folder: &Path, slice: &Slice) -> Result<Map, SweepError> {}
pub fn merge(plan: &Plan, folder: &Path, table: &Path) -> Result<Merged, SweepError> {}
pub fn run(
    plan: &Plan,
    folder: &Path,
    running: &Running<'_>,
) -> Result<Ran, SweepError> {}
pub fn status(plan: &Plan, folder: &Path) -> Result<Status, SweepError> {}
pub fn time_limit(status: &Status, shards: u64, cores: u64) -> Option<u64> {}
