// What `gait-optimizer` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

pub use certificate::Condition;
pub use swimmer_files::ArcKind;
pub use swimmer_files::Bounds;
pub use swimmer_files::GaitArc;
pub use swimmer_files::Objective;
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Arc {
    pub kind: ArcKind,
    pub from: [f64; 2],
    pub to: [f64; 2],
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaRule {
    pub area: Vector3<f64>,
    pub swum: Vector3<f64>,
}
impl AreaRule {
    pub fn deviation(&self) -> Vector3<f64> {}
}
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Atlas {
    pub optima: Vec<Optimum>,
    pub starts: usize,
    pub unsettled: usize,
    pub left: usize,
    pub uncertified: usize,
    pub best_uncertified: Option<f64>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AtlasError {
    Problem(InvalidProblem),
    Immobile(Immobile),
    Objective { objective: Objective },
    Size { starts: usize, order: usize },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtlasProblem {
    pub swimmer: Swimmer<f64>,
    pub objective: Objective,
    pub bounds: Bounds,
    pub starts: usize,
    pub from: StartCurves,
    pub seed: u64,
    pub order: usize,
    pub threads: usize,
    pub samples: usize,
}
impl AtlasProblem {
    pub fn new(swimmer: Swimmer<f64>, objective: Objective) -> Self {}
}
#[derive(Debug, Clone, Copy)]
pub struct Batch {}
impl Batch {
    pub fn new(swimmer: &Swimmer<f64>) -> Result<Self, InvalidSwimmer> {}
    pub fn of(model: &Model<f64>) -> Self {}
    pub fn connections_and_powers(
        &self,
        phi1: &[f64],
        phi2: &[f64],
        found: &mut ConnectionsAndPowers,
    ) {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BestAmplitude {
    pub amplitude: f64,
    pub displacement_over_length: f64,
    pub efficiency: f64,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Branch {
    Small,
    Large,
}
impl Branch {
    pub fn sign(self) -> f64 {}
}
impl fmt::Display for Branch {}
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {}
impl Serialize for Certificate {}
impl Certificate {
    pub fn checks(&self) -> &[Check] {}
    pub fn value(&self, condition: Condition) -> Option<f64> {}
    pub fn pass(&self) -> bool {}
    pub fn verdict(&self) -> Verdict {}
    pub fn failures(&self) -> String {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CertifyError {
    Swimmer(InvalidSwimmer),
    Samples(InvalidSamples),
    TooFew { samples: usize },
    NoObjective,
}
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Check {
    pub condition: Condition,
    pub value: f64,
    pub tolerance: f64,
    pub pass: bool,
    pub uncertainty: f64,
}
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConnectionsAndPowers {
    pub connection: [Vec<f64>; 6],
    pub power: [Vec<f64>; 3],
}
#[derive(Debug, Clone, PartialEq)]
pub struct Continuation {
    pub points: Vec<Point>,
    pub events: Vec<Event>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContinuationError {
    Swimmer(InvalidSwimmer),
    Objective { objective: Objective },
    Range { parameter: Parameter, from: f64, to: f64, problem: &'static str },
    Size { steps: usize, starts: usize },
    NoStart { parameter: Parameter, from: f64, branch: usize, reason: String },
}
impl ContinuationError {
    pub fn is_bad_input(&self) -> bool {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuationProblem {
    pub swimmer: Swimmer<f64>,
    pub objective: Objective,
    pub bounds: Bounds,
    pub parameter: Parameter,
    pub from: f64,
    pub to: f64,
    pub starts: Vec<Start>,
    pub steps: usize,
    pub samples: usize,
}
impl ContinuationProblem {
    pub fn new(
        swimmer: Swimmer<f64>,
        parameter: Parameter,
        [from,
        to,
        ]: [f64; 2],
        start: Start,
    ) -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Convergence {
    pub order: usize,
    pub order_before: usize,
    pub inner_change: f64,
    pub change: f64,
}
#[derive(Debug, Clone, Copy)]
pub struct Direct<'a> {
    pub method: &'static str,
    pub gait: &'a AnyGait,
    pub efficiency: f64,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DisplacementError {
    Problem(InvalidProblem),
    Immobile(Immobile),
    NoUnboundedOptimum { fates: Fates },
    NoOptimum { heading: Heading, fates: Fates, outdone: Option<f64> },
    Saddle { gait: Box<OptimalGait> },
    NotCertified { displacement_over_length: f64, failed: String },
}
impl DisplacementError {
    pub fn details(&self) -> Option<String> {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementProblem {
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
    pub heading: Option<Heading>,
    pub quarter_samples: usize,
    pub simple: bool,
}
impl DisplacementProblem {
    pub fn new(swimmer: Swimmer<f64>) -> Self {}
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EfficiencyError {
    Problem(InvalidProblem),
    Immobile(Immobile),
    BranchEnds { branch: Branch, reached: Reached, reason: String },
    NotFollowed { branch: Branch, reason: String },
    NoStart { branch: Branch, best: f64 },
    RunsAway {
        branch: Branch,
        amplitude: f64,
        order: usize,
        efficiency: f64,
        farthest: f64,
    },
    CrossesItself { branch: Branch, order: usize, efficiency: f64, crossings: usize },
    NotConverged { branch: Branch, order: usize, efficiency: f64 },
    OtherBranch {
        branch: Branch,
        efficiency: f64,
        displacement_over_length: f64,
        start_angle: f64,
        definition: &'static str,
    },
    Saddle { branch: Branch, gait: Box<OptimalGait> },
    NotCertified { branch: Branch, efficiency: f64, failed: String },
}
impl EfficiencyError {
    pub fn details(&self) -> Option<String> {}
    pub fn is_bad_input(&self) -> bool {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyFigures {
    pub residual: f64,
    pub power_variation: f64,
    pub method: &'static str,
    pub direct_efficiency: Option<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyProblem {
    pub swimmer: Swimmer<f64>,
    pub branch: Branch,
    pub method: Method,
    pub bounds: Bounds,
    pub quarter_samples: usize,
}
impl EfficiencyProblem {
    pub fn new(swimmer: Swimmer<f64>, branch: Branch) -> Self {}
    pub fn validated(&self) -> Result<Model<f64>, InvalidProblem> {}
}
#[derive(Debug, Clone)]
pub struct EfficiencySeed {}
impl EfficiencySeed {
    pub fn new(gait: OptimalGait) -> Self {}
    pub fn gait(&self) -> &OptimalGait {}
    pub fn near(&self, problem: &EfficiencyProblem) -> Option<Self> {}
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Event {
    pub branch: usize,
    pub value: f64,
    pub within: f64,
    pub kind: EventKind,
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum EventKind {
    Structure { before: Vec<ArcKind>, after: Vec<ArcKind> },
    Fold(Fold),
    Jump { exponent: Option<f64>, apart: f64 },
    Merger { with: usize },
    Overtaken { by: usize },
    Symmetry { alone: bool },
    Lost { failed: String },
    Ended { exponent: Option<f64>, reason: String },
    Reached,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Fastest {
    pub speed_over_length: f64,
    pub distance_over_length: f64,
    pub period: f64,
    pub heading: f64,
    pub gait: OptimalGait,
    pub starts: usize,
    pub found: usize,
    pub longer: Option<f64>,
    pub uncertified: Option<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fates {
    pub sent: usize,
    pub ended: usize,
    pub nearest: Option<f64>,
    pub came_back: usize,
    pub left_horizon: usize,
    pub wrong_way: usize,
    pub lost: usize,
}
impl fmt::Display for Fates {}
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    pub other: Option<OtherSide>,
    pub exponent: Option<f64>,
}
impl Serialize for Fold {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    pub b: Vector3<f64>,
    pub slopes: [Vector3<f64>; 2],
}
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    pub fastest: Fastest,
    pub farthest: Vec<Option<Fastest>>,
    pub periods: Vec<f64>,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    pub angles: Vec<f64>,
    pub heights: DMatrix<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Heading {
    Forwards,
    Backwards,
}
impl fmt::Display for Heading {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HeadingRule {
    Any,
    Forward,
    Sideways,
}
#[derive(Debug, Clone)]
pub struct HeightMap {}
impl HeightMap {
    pub const WIDEST: f64 = 2.0 * std::f64::consts::TAU;
    pub const NARROWEST: f64 = 1e-3;
    pub fn new(swimmer: &Swimmer<f64>, half_width: f64) -> Result<Self, HeightMapError> {}
    pub fn half_width(&self) -> f64 {}
    pub fn convergence(&self) -> Convergence {}
    pub fn frame(&self, phi: &Vector2<f64>) -> Frame {}
    pub fn heights(&self, phi: &Vector2<f64>) -> Vector3<f64> {}
    pub fn height(&self, row: Row, phi: &Vector2<f64>) -> f64 {}
    pub fn height_and_gradient(
        &self,
        row: Row,
        phi: &Vector2<f64>,
    ) -> (f64, Vector2<f64>) {}
    pub fn grid(&self, row: Row, count: usize) -> Grid {}
    pub fn zero_curves(&self, row: Row) -> Vec<LevelCurve> {}
}
impl HeightMap {
    pub fn area_rule(&self, gait: &AnyGait) -> Result<AreaRule, HeightMapError> {}
}
impl HeightMap {
    pub fn zeros_on_diagonal(&self, row: Row) -> Vec<f64> {}
    pub fn zeros_on_antidiagonal(&self, row: Row) -> Vec<f64> {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeightMapError {
    Swimmer(InvalidSwimmer),
    HalfWidth { value: f64 },
    NotConverged { half_width: f64, order: usize },
    GaitBeyondMap { reach: f64, half_width: f64 },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Holder {
    pub sphere_radius: f64,
    pub chi: f64,
    pub gain: f64,
    pub multiplier: f64,
}
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub struct Immobile {
    pub chi: f64,
    pub contrast: f64,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidProblem {
    Swimmer(InvalidSwimmer),
    Asymmetric { front: f64, back: f64 },
    Bound { name: &'static str, value: f64, problem: &'static str },
    Clearance { value: f64, middle: f64 },
    QuarterBound { name: &'static str },
}
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    pub rate: f64,
    pub unjoined_rate: f64,
    pub period: f64,
    pub net: [f64; 3],
    pub gait: OptimalGait,
}
impl Joined {
    pub fn cost(&self) -> f64 {}
    pub fn gait_file(&self, swimmer_name: &str, backwards: bool) -> GaitFile {}
}
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LevelCurve {
    pub closed: bool,
    pub residual: f64,
    pub points: Vec<Vector2<f64>>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    Power,
    Rate,
    Torque,
}
impl Limit {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Limited {
    pub limits: Vec<(Limit, f64)>,
    pub speed_over_length: f64,
    pub distance_over_length: f64,
    pub period: f64,
    pub peak_power_over_viscosity: f64,
    pub peak_rates: [f64; 2],
    pub peak_torques_over_viscosity: [f64; 2],
    pub refinement: Option<f64>,
    pub uncertified: Option<f64>,
    pub gait: OptimalGait,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitedError {
    Power { power: f64 },
    Torque { torque: Torque },
    Unlimited,
    Problem(InvalidProblem),
    Atlas(AtlasError),
    Speed(SpeedError),
    NoGait { bounds: Bounds, between: Option<[f64; 2]>, uncertified: Option<f64> },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedProblem {
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
    pub power_over_viscosity: Option<f64>,
    pub rates: Option<[f64; 2]>,
    pub torque: Option<Torque>,
    pub threads: usize,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    pub gap: f64,
    pub displacement_over_length: f64,
    pub links_cross: f64,
    pub quarter: Vec<Vector2<f64>>,
}
impl Member {
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    Auto,
    Fourier,
    Shooting,
}
impl Method {
    pub fn word(self) -> &'static str {}
}
impl fmt::Display for Method {}
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalGait {
    pub objective: Objective,
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
    pub displacement_over_length: f64,
    pub displacement: f64,
    pub lateral_over_length: f64,
    pub rotation: f64,
    pub efficiency: f64,
    pub symmetric: bool,
    pub start_angle: f64,
    pub end_angle: f64,
    pub arcs: Vec<Arc>,
    pub links_cross: f64,
    pub certificate: Certificate,
    pub efficiency_figures: Option<EfficiencyFigures>,
    pub outdone_over_length: Option<f64>,
    pub extremals: Option<usize>,
}
impl OptimalGait {
    pub fn certify(&self) -> Result<Certificate, CertifyError> {}
}
impl OptimalGait {
    pub fn heading(&self) -> Option<f64> {}
    pub fn u(&self) -> &[f64] {}
    pub fn phi(&self) -> &[Vector2<f64>] {}
    pub fn corners(&self) -> &[f64] {}
    pub fn cycle_arcs(&self) -> &[GaitArc] {}
    pub fn gait(&self) -> Result<AnyGait, InvalidSamples> {}
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    pub gait: OptimalGait,
    pub distance_over_length: f64,
    pub simple: bool,
    pub found: usize,
}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OtherSide {
    pub value: f64,
    pub efficiency: f64,
    pub start_angle: f64,
    pub ascent_directions: Option<usize>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Over {
    Worst,
    Mean,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    MaxAngle,
    Chi,
    SphereRadius,
    LinkRatio,
}
impl Parameter {
    pub fn word(self) -> &'static str {}
    #[must_use]
    pub fn swimmer(self, swimmer: &Swimmer<f64>, value: f64) -> Swimmer<f64> {}
    #[must_use]
    pub fn bounds(self, bounds: &Bounds, value: f64) -> Bounds {}
}
impl fmt::Display for Parameter {}
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub branch: usize,
    pub value: f64,
    pub gait: OptimalGait,
    pub residual: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    pub max_angle: f64,
    pub tips_meet: Option<[f64; 2]>,
}
impl fmt::Display for Reached {}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobustError {
    Nominal(DisplacementError),
    NominalSpeed(SpeedError),
    Swimmer(InvalidSwimmer),
    Immobile(Immobile),
    Uncertainty { name: &'static str, value: f64, problem: &'static str },
    Order { order: usize },
    Structure { problem: &'static str },
    Arc { kind: ArcKind },
    Turns { rotation: f64 },
    Clearance,
    NotConverged { residual: f64 },
    Bound { by: f64, bounds: Bounds },
    NotCertified { failed: String },
}
#[derive(Debug, Clone, PartialEq)]
pub struct RobustGait {
    pub gait: OptimalGait,
    pub robustness: Robustness,
}
#[derive(Debug, Clone, PartialEq)]
pub struct RobustSpeed {
    pub fastest: Fastest,
    pub robustness: Robustness,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    pub over: Over,
    pub values: Values,
    pub nominal: Values,
    pub held_by: Vec<Holder>,
    pub members: (usize, usize),
    pub off_branch: bool,
    pub links_cross: [f64; 2],
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Row {
    X,
    Y,
    Theta,
}
impl Row {
    pub fn index(self) -> usize {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Sideways {
    pub gait: OptimalGait,
    pub lateral_over_length: f64,
    pub bridged_supremum_over_length: Option<f64>,
    pub outdone_over_length: Option<f64>,
    pub loops: usize,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SidewaysError {
    Problem(AtlasError),
    NoOptimum { bounds: Bounds, loops: usize },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SidewaysProblem {
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
    pub starts: usize,
    pub threads: usize,
    pub samples: usize,
}
impl SidewaysProblem {
    pub fn new(swimmer: Swimmer<f64>) -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SimpleShape {
    Circle,
    Square,
}
impl SimpleShape {
    pub fn gait(self, amplitude: f64) -> AnyGait {}
    pub fn swum(self, model: &Model<f64>, amplitude: f64) -> Stroke<f64> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedAtlas {
    pub optima: Vec<Fastest>,
    pub longer: usize,
    pub uncertified: usize,
    pub best_uncertified: Option<f64>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpeedError {
    Swimmer(InvalidSwimmer),
    Immobile(Immobile),
    Rate { rate: f64 },
    Period { period: f64 },
    OfQuarters { bounds: Bounds },
    Corners { corners: usize },
    Shape { shape: [f64; 2] },
    NoJoinedGait { kind: &'static str, bounds: Bounds, starts: usize, chains: usize },
    NoGait { bounds: Bounds, starts: usize, chains: usize, uncertified: Option<f64> },
}
impl From<Immobile> for SpeedError {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProblem {
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
    pub rates: [f64; 2],
    pub heading: HeadingRule,
    pub period: Option<f64>,
    pub max_corners: usize,
    pub starts: usize,
    pub seed: u64,
    pub threads: usize,
}
impl SpeedProblem {
    pub const MAX_CORNERS: usize = 16;
    pub const STARTS: usize = 64;
    pub const STARTS_OF_A_HEADING: usize = 256;
    pub const GUESSES: usize = 3;
    pub fn new(swimmer: Swimmer<f64>, rates: [f64; 2]) -> Self {}
    #[must_use]
    pub fn led(self, heading: HeadingRule) -> Self {}
}
impl SpeedProblem {
    pub fn watched(&self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {}
    pub fn atlas(&self, watch: Watch<'_>) -> Result<SpeedAtlas, SpeedError> {}
    pub fn near(&self, neighbour: &Fastest) -> Option<Fastest> {}
}
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    Efficiency(Branch),
    Displacement { heading: Option<Heading>, rank: usize },
    Gait(Box<OptimalGait>),
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartCurves {
    Random,
    OffCentre,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteerProblem {
    pub of: SpeedProblem,
    pub shape: Option<[f64; 2]>,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Steering {
    pub shape: [f64; 2],
    pub forward: Joined,
    pub left: Joined,
    pub turn: Joined,
    pub shapes: usize,
    pub turning_angle: Option<f64>,
}
#[derive(Debug, Default)]
pub struct Suprema {}
impl Suprema {
    pub fn new(threads: usize) -> Self {}
    pub fn of(
        &mut self,
        problem: &DisplacementProblem,
        found: Option<&OptimalGait>,
    ) -> Option<Supremum> {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Supremum {
    pub over_length: f64,
    pub uncertainty: f64,
    pub members: Vec<Member>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    pub stall_over_viscosity: f64,
    pub no_load_rate: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    pub gait: OptimalGait,
    pub bridged_supremum: f64,
    pub regions: usize,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TurningError {
    Problem(InvalidProblem),
    Border,
    Lost { near: [f64; 2], what: &'static str },
    NoRegion,
    NotCertified { rotation: f64, failed: String },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningProblem {
    pub swimmer: Swimmer<f64>,
    pub bounds: Bounds,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    pub sphere_radius: f64,
    pub chi: f64,
    pub sphere_radius_interval: [f64; 2],
    pub chi_interval: [f64; 2],
    pub gain_interval: [f64; 2],
    pub level: f64,
    pub correlation: Option<f64>,
}
impl Uncertainty {
    pub fn none(sphere_radius: f64, chi: f64) -> Self {}
    pub fn validate(&self) -> Result<(), RobustError> {}
}
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Values {
    pub nominal: f64,
    pub worst: f64,
    pub mean: f64,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Pass,
    Fail,
    Undecided,
}
impl Verdict {
    pub fn word(self) -> &'static str {}
}
pub type Watch<'a> = &'a (dyn Fn(f64) + Sync);
pub fn atlas(problem: &AtlasProblem) -> Result<Atlas, AtlasError> {}
pub fn atlas_watched(
    problem: &AtlasProblem,
    watch: Watch<'_>,
) -> Result<Atlas, AtlasError> {}
pub fn best_amplitudes(
    model: &Model<f64>,
    shape: SimpleShape,
    objective: Objective,
    largest: f64,
) -> Vec<BestAmplitude> {}
pub fn certify(
    swimmer: &Swimmer<f64>,
    gait: &GaitFile,
    objective: Objective,
    bounds: &Bounds,
) -> Result<Certificate, CertifyError> {}
pub fn continuation(
    problem: &ContinuationProblem,
    watch: Watch<'_>,
) -> Result<Continuation, ContinuationError> {}
pub fn displacement(
    problem: &DisplacementProblem,
) -> Result<OptimalGait, DisplacementError> {}
pub fn displacement_near(
    problem: &DisplacementProblem,
    neighbour: &OptimalGait,
) -> Option<OptimalGait> {}
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, EfficiencyError> {}
pub fn efficiency_from(
    problem: &EfficiencyProblem,
    direct: &Direct<'_>,
) -> Result<OptimalGait, EfficiencyError> {}
pub fn fastest_within(
    problem: &LimitedProblem,
    watch: Watch<'_>,
) -> Result<Limited, LimitedError> {}
pub fn robust_displacement(
    problem: &DisplacementProblem,
    uncertainty: &Uncertainty,
    over: Over,
) -> Result<RobustGait, RobustError> {}
pub fn robust_efficiency(
    swimmer: &Swimmer<f64>,
    (branch, order): (Branch, usize),
    bounds: &Bounds,
    uncertainty: &Uncertainty,
    over: Over,
) -> Result<RobustGait, RobustError> {}
pub fn robust_speed(
    problem: &SpeedProblem,
    uncertainty: &Uncertainty,
    over: Over,
    watch: Watch<'_>,
) -> Result<RobustSpeed, RobustError> {}
pub fn sideways(
    problem: &SidewaysProblem,
    watch: Watch<'_>,
) -> Result<Sideways, SidewaysError> {}
pub fn turning(problem: &TurningProblem) -> Result<Turning, TurningError> {}
pub mod closed_forms {
    pub fn along_the_point_symmetric_shapes(swimmer: &Swimmer<f64>, phi: f64) -> f64 {}
    pub fn along_the_symmetric_shapes(swimmer: &Swimmer<f64>, phi: f64) -> f64 {}
}
pub mod fastest {
    pub use crate::Fastest;
}
pub mod front {
    pub use crate::Front;
    pub fn front(problem: &SpeedProblem, watch: Watch<'_>) -> Result<Front, SpeedError> {}
}
pub mod region {
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Bound {
        Straight(Edge),
        Clearance(Clearance),
    }
    impl Bound {
        pub fn kind(&self) -> ArcKind {}
        pub fn margin(&self, phi: &Vector2<f64>) -> f64 {}
        pub fn level(&self, phi: &Vector2<f64>) -> Level {}
        pub fn smooth_level(&self, phi: &Vector2<f64>) -> Level {}
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Clearance {}
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Edge {
        pub normal: Vector2<f64>,
        pub offset: f64,
        pub kind: ArcKind,
    }
    #[derive(Debug, Clone, Copy)]
    pub struct Level {
        pub value: f64,
        pub gradient: Vector2<f64>,
        pub hessian: Matrix2<f64>,
    }
    #[derive(Debug, Clone, PartialEq)]
    pub struct Region {}
    impl Region {
        pub fn new(bounds: &Bounds, links: &Links<f64>) -> Self {}
        pub fn bounds(&self) -> impl Iterator<Item = Bound> + '_ {}
    }
}
pub mod steer {
    pub use crate::Joined;
    pub use crate::SteerProblem;
    pub use crate::Steering;
    pub fn steer(
        problem: &SteerProblem,
        watch: Watch<'_>,
    ) -> Result<Steering, SpeedError> {}
}
