// What `calibrate` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    pub period_s: f64,
    pub candidates: Vec<Candidate>,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Assessment {
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    pub headline: Headline,
    pub goodness: Goodness,
    pub systematics: Option<Systematics>,
    pub budget: Vec<BudgetLine>,
    pub explanations: Vec<Explanation>,
}
impl Assessment {
    pub fn document(
        &self,
        found: &CampaignFit,
        name: impl Fn(&Path) -> String,
    ) -> AssessmentDocument {}
}
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    Open { file: PathBuf, cause: String },
    Track(TrackError),
    File(FileError),
    Log(LinkLogError),
    Play { log: PathBuf, problem: String },
    Poses { file: PathBuf, cause: PoseError },
    Cycles { file: PathBuf, cause: CycleError },
    Prediction { file: PathBuf, cause: PredictionError },
    Fit(FitError),
}
impl CalibrateError {
    pub fn is_bad_input(&self) -> bool {}
}
impl From<InvalidSwimmer> for CalibrateError {}
#[derive(Debug, Clone, Default)]
pub struct CampaignData {
    pub runs: Vec<RunData>,
    pub told: Vec<AnyGait>,
    pub doubts: Vec<String>,
}
impl CampaignData {
    pub fn load(campaign: &Campaign) -> Result<Self, CalibrateError> {}
    pub fn load_by<R: Read>(
        campaign: &Campaign,
        open: impl Fn(&Path) -> io::Result<R>,
    ) -> Result<Self, CalibrateError> {}
}
#[derive(Debug, Clone)]
pub struct CampaignFit {
    pub start: SwimmerFile,
    pub known: Known,
    pub runs: Vec<RunResult>,
    pub excluded: Vec<ExcludedRun>,
    pub fit: Fit,
    pub swimmer: SwimmerFile,
}
impl CampaignFit {
    pub fn servos(&self) -> Option<[MeasuredServo; 2]> {}
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    pub gait: GaitSpec,
    pub sphere_radius: f64,
    pub chi: f64,
    pub both: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    pub start_s: f64,
    pub step: Option<Pose<f64>>,
    pub delta_y: f64,
    pub delta_theta: f64,
    pub missing: f64,
    pub residual_m: f64,
}
impl Cycle {
    pub fn at(&self, u: f64) -> Pose<f64> {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CycleError {
    NoMotion,
    TooShort { track_s: f64, period_s: f64 },
    TooQuick { samples: f64, period_s: f64 },
    NoCycle { from_s: f64, active_s: f64, period_s: f64, left_out: usize },
    NoPhase { period_s: f64 },
    OtherPeriod(Periodicity),
}
#[derive(Debug, Clone, PartialEq)]
pub enum CycleWarning {
    Period { commanded_s: f64, found_s: f64 },
    PeriodNotFound { commanded_s: f64 },
    OneCycle,
    StartUpKept,
    PhaseDiffers { by_s: f64, period_s: f64 },
    Repeats(Periodicity),
}
impl fmt::Display for CycleWarning {}
#[derive(Debug, Clone, PartialEq)]
pub struct Cycles {
    pub period_s: f64,
    pub cycles: Vec<Cycle>,
    pub left_out: Vec<(f64, LeftOut)>,
    pub x: Statistics,
    pub y: Statistics,
    pub rotation: Statistics,
    pub delta_y: Statistics,
    pub delta_theta: Statistics,
    pub phase: Phase,
    pub warnings: Vec<CycleWarning>,
}
impl Cycles {
    pub fn count(&self) -> Option<usize> {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    pub velocity_m_s: [f64; 2],
    pub error_m_s: f64,
    pub rest_s: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    pub likelihood: Likelihood,
    pub run_errors: Vec<[RunError; TELLING]>,
    pub profiles: [Profile; 2],
    pub ridge: Ridge,
    pub bootstrap: Option<CycleBootstrap>,
    pub without_run: Vec<WithoutRun>,
    pub outliers: Vec<Outlier>,
    pub start_curve: Vec<CurvePoint>,
    pub fitted_curve: Vec<CurvePoint>,
    pub surface_error: f64,
}
impl Evidence {
    pub fn document<'a>(&'a self, names: &'a [String]) -> EvidenceDocument<'a> {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EvidenceOptions {
    pub draws: usize,
    pub seed: u64,
}
impl Default for EvidenceOptions {}
#[derive(Debug, Clone)]
pub struct ExcludedRun {
    pub index: usize,
    pub file: PathBuf,
    pub reason: String,
    pub by_sign: bool,
    pub result: Option<RunResult>,
}
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    pub sphere_radius: f64,
    pub chi: f64,
    pub rmse: f64,
    pub intervals: Intervals,
    pub c_t_form: TangentialDrag<f64>,
    pub residuals: Vec<RunResidual>,
    pub condition: f64,
    pub correlation: f64,
    pub warnings: Vec<FitWarning>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    Swimmer(InvalidSwimmer),
    Level { level: f64 },
    NothingMeasured { quantity: &'static str },
    SignOpposes {
        opposed: usize,
        runs: usize,
        files: String,
        measured_m: f64,
        predicted_m: f64,
    },
    Undetermined { parameters: String },
    Measured { parameter: &'static str },
    NoConvergence { starts: usize },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    pub level: f64,
}
impl Default for FitOptions {}
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    Ridge { correlation: f64, condition: f64 },
    FewRuns { runs: usize },
    NoSphere,
    Outlier { run: usize, quantity: &'static str, standard_errors: f64 },
    DeadBand { known: f64, found: f64, gain: f64, rival: Option<(&'static str, f64)> },
    Gain { found: f64, gain: f64, rival: Option<(&'static str, f64)> },
    ModelMisfit { ratio: f64 },
}
impl std::fmt::Display for FitWarning {}
#[derive(Debug, Clone, PartialEq)]
pub struct FollowReport {
    pub followed: usize,
    pub missing: usize,
    pub frozen: usize,
    pub swaps_repaired: usize,
    pub swaps: Vec<Stretch>,
    pub ghosts_rejected: usize,
    pub ghosts: Vec<Stretch>,
    pub segments: usize,
    pub distance_m: f64,
    pub distance_sd_m: f64,
    pub expected_m: f64,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrontRule {
    Label,
    Place,
    Travel,
}
impl FrontRule {
    pub fn word(self) -> &'static str {}
}
impl fmt::Display for FrontRule {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Further {
    TangentialDrag,
    JointOffsets,
    DeadBand,
    MarkerOffset,
    Gain,
    Gains,
    Scale,
}
impl Further {
    pub const ALL: [Self; 7] = [
        Self::TangentialDrag,
        Self::JointOffsets,
        Self::DeadBand,
        Self::MarkerOffset,
        Self::Gain,
        Self::Gains,
        Self::Scale,
    ];
    pub const fn word(self) -> &'static str {}
    pub fn of_word(word: &str) -> Option<Self> {}
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FurtherFit {
    pub parameters: Vec<FittedParameter>,
    pub level: f64,
    pub correlations: Vec<Vec<f64>>,
    pub condition: f64,
    pub log_likelihood_gain: f64,
    pub swimmer: SwimmerFile,
    pub warnings: Vec<FurtherWarning>,
}
impl FurtherFit {
    pub fn parameter(&self, name: &str) -> Option<&FittedParameter> {}
    pub fn intervals(&self) -> Option<Intervals> {}
}
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Intervals {
    pub sphere_radius: [f64; 2],
    pub chi: [f64; 2],
    pub level: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    pub before_s: f64,
    pub after_s: f64,
    pub moved_m: f64,
    pub turned_rad: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeftOut {
    StartUp,
    Missing(f64),
    Unlike(f64),
    Unsteady,
    Jump,
    Step { by_m: f64, by_rad: f64 },
}
impl fmt::Display for LeftOut {}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    pub value: f64,
    pub error: f64,
}
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredJoints {
    pub seen: [f64; 2],
    pub scatter: [f64; 2],
    pub servos: Option<[MeasuredServo; 2]>,
}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeasuredServo {
    pub gain: Measured,
    pub dead_band: Measured,
    pub offset: Measured,
    pub lag: Option<Measured>,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    Seen,
    Tail,
    Smoothed,
    OneSeen,
    Filled,
}
impl Origin {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherGait {
    pub index: usize,
    pub sways_like_rad: f64,
    pub said_rad: f64,
}
impl fmt::Display for OtherGait {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periodicity {
    pub period_s: f64,
    pub share: f64,
    pub found_s: Option<f64>,
}
impl fmt::Display for Periodicity {}
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Heading,
    Flash,
    Log,
    LogAndHeading,
    Told,
}
impl Phase {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointKind {
    Marker,
    Unlabeled,
    RigidBody,
    RigidBodyMarker,
    Other,
}
impl PointKind {
    pub fn is_measured(self) -> bool {}
}
impl fmt::Display for PointKind {}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointPresence {
    pub name: String,
    pub kind: PointKind,
    pub id: String,
    pub present: usize,
    pub gaps: usize,
    pub longest_gap: usize,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseError {
    NoPoint { reflector: &'static str, wanted: String, points: String },
    NoScale { unit: crate::Unit, scale: Option<f64> },
    SamePlace,
    NoPair { expected_m: f64, tolerance_m: f64, frames: usize },
    SamePoint { point: String },
    Distance { measured_m: f64, expected_m: f64, scale: f64 },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseOptions {
    pub longest_fill_s: f64,
    pub distance_tolerance: f64,
}
impl Default for PoseOptions {}
impl PoseOptions {
    pub fn of_period(period_s: f64) -> Self {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSample {
    pub time_s: f64,
    pub pose: Pose<f64>,
    pub origin: Origin,
}
impl PoseSample {
    pub fn is_filled(&self) -> bool {}
}
#[derive(Debug, Clone)]
pub struct PoseTrack {
    pub samples: Vec<PoseSample>,
    pub frames: usize,
    pub rate_hz: f64,
    pub plane: Plane,
    pub report: FollowReport,
    pub jumps: Vec<Jump>,
    pub drift: Option<Drift>,
    pub front: FrontRule,
    pub warnings: Vec<PoseWarning>,
}
impl PoseTrack {
    pub fn seen(&self) -> impl Iterator<Item = &PoseSample> {}
    pub fn with(&self, origin: Origin) -> impl Iterator<Item = &PoseSample> {}
}
#[derive(Debug, Clone, PartialEq)]
pub enum PoseWarning {
    Distance { measured_m: f64, expected_m: f64 },
    OutOfPlane { rms_m: f64 },
    PlaneAssumed,
    AmbiguousGaps { segments: usize, rows: usize },
    Frozen { stretches: usize, rows: usize },
    Jumps(Vec<Jump>),
    LabelsContested { stretches: Vec<Stretch>, share: f64 },
}
impl fmt::Display for PoseWarning {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedCycle {
    pub x_m: f64,
    pub y_m: f64,
    pub rotation_rad: f64,
    pub delta_y_m: f64,
    pub delta_theta_rad: f64,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PredictionError {
    Swimmer(InvalidSwimmer),
    Table(TableError),
    Range { angle: f64, max_angle: f64 },
    Period { period_s: f64 },
}
#[derive(Debug, Clone)]
pub struct RunData {
    pub file: PathBuf,
    pub track: TrackFile,
    pub gait: AnyGait,
    pub gait_name: String,
    pub period_s: f64,
    pub front: Option<PointName>,
    pub timing: Timing,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunResidual {
    pub predicted: PredictedCycle,
    pub x_m: f64,
    pub delta_y_m: f64,
    pub delta_theta_rad: f64,
    pub share: f64,
}
#[derive(Debug, Clone)]
pub struct RunResult {
    pub index: usize,
    pub file: PathBuf,
    pub gait: String,
    pub poses: PoseTrack,
    pub cycles: Cycles,
    pub warnings: Vec<String>,
    pub reflector_distance_m: f64,
    pub joints: Option<MeasuredJoints>,
}
impl RunResult {
    pub fn is_told(&self) -> bool {}
}
impl RunResult {
    pub fn diagnoses(&self) -> Vec<String> {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    pub mean: f64,
    pub sd: f64,
    pub se: f64,
    pub lag1: f64,
    pub count: usize,
}
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Stretch {
    pub from_s: f64,
    pub until_s: f64,
    pub rows: usize,
}
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timing {
    pub cycle_start_s: Option<f64>,
    pub play: Option<Play>,
    pub clock_offset_s: Option<f64>,
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    Broken { place: Place, problem: TrackProblem },
    NotRead { file: PathBuf, format: String },
    Stream { file: PathBuf, line: usize, cause: String },
    Unrecognised { file: PathBuf, beginning: String },
    Empty { file: PathBuf },
}
impl TrackError {
    pub fn place(&self) -> Option<&Place> {}
}
#[derive(Debug, Clone)]
pub struct TrackFile {
    pub format: TrackFormat,
    pub rate_hz: f64,
    pub unit: Unit,
    pub frame_numbers: Vec<u64>,
    pub times: Vec<f64>,
    pub axes: Option<Axes>,
    pub points: Vec<TrackPoint>,
    pub warnings: Vec<TrackWarning>,
}
impl TrackFile {
    pub fn frames(&self) -> usize {}
    pub fn duration_s(&self) -> f64 {}
}
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackFormat {
    Motive(String),
    MotiveWithoutHeader,
    TrackingTools,
    Tracker,
    DeepLabCut,
    Trc,
    Qtm,
    Vicon,
    Sleap,
    Kinovea,
    Table,
}
impl fmt::Display for TrackFormat {}
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackOptions {
    pub metres_per_unit: Option<f64>,
    pub rate_hz: Option<f64>,
    pub axes: Option<Axes>,
    pub likelihood: Option<f64>,
    pub pairs: Vec<[String; 2]>,
}
#[derive(Debug, Clone)]
pub struct TrackPoint {
    pub name: String,
    pub kind: PointKind,
    pub id: String,
    pub columns: Vec<String>,
}
impl TrackPoint {
    pub fn position(&self, row: usize) -> Option<Vector3<f64>> {}
    pub fn present(&self) -> usize {}
    pub fn gaps(&self) -> usize {}
    pub fn longest_gap(&self) -> usize {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackProblem {
    UnclosedQuote,
    AfterQuote,
    NotANumber { text: String, cell: String },
    NotAFrameNumber { text: String },
    FrameOrder { previous: u64, frame: u64 },
    TimeOrder { previous: f64, time: f64 },
    RowLength { cells: usize, expected: usize },
    NoAxisRow,
    NoHeaderRow { row: &'static str },
    NoTimeColumn { text: String },
    NoKey { key: &'static str },
    UnknownUnit { text: String },
    Rate { text: String },
    CoordinateSpace { text: String },
    MissingAxis { point: String, axis: char },
    NoPoints,
    NoTime,
    NoColumn { name: String, columns: String },
    TwiceTheSameColumn { name: String },
    NoRate,
    MayBeCut,
    LineTooLong { megabytes: usize },
    FieldCount { word: String, fields: usize, expected: usize },
    UnknownRecord { text: String },
    NotACount { text: String, field: &'static str },
    RecordVersion { version: String },
    Triples { columns: usize },
    LooksLikeRotation,
    NoData,
}
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrackSurvey {
    pub format: TrackFormat,
    pub rate_hz: f64,
    pub unit: Unit,
    pub frames: usize,
    pub points: Vec<PointPresence>,
    pub warnings: Vec<TrackWarning>,
}
#[derive(Debug, Clone, PartialEq)]
pub enum TrackWarning {
    UnseenVersion(String),
    FrameJumps { jumps: usize, frames: u64 },
    FrameCount { header: u64, rows: usize },
    TimeColumn { header_hz: f64, column_hz: f64 },
    HalfBlank { count: usize, first_line: usize },
    LastLineCut { line: usize },
    NoHeader,
    LeftHanded,
    NoPositions { track: String, columns: String },
    Unlikely { count: usize, threshold: f64 },
    PixelsDown,
    UnitOverridden { unit: String },
    RateOverridden { file_hz: f64, used_hz: f64 },
    RoundedTimes { unit_s: f64, rate_hz: f64 },
    Renumbered { count: usize, first_line: usize },
    UnevenTimes { shortest: f64, longest: f64 },
}
impl fmt::Display for TrackWarning {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    Metre,
    Centimetre,
    Millimetre,
    Scaled(f64),
    Pixel,
    Unknown,
}
impl Unit {
    pub fn metres(self) -> Option<f64> {}
}
impl fmt::Display for Unit {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Trust,
    Caution,
    DoNotUse,
}
impl Verdict {
    pub fn word(self) -> &'static str {}
}
impl fmt::Display for Verdict {}
pub fn advise(campaign: &Campaign, found: &CampaignFit) -> Result<Advice, FitError> {}
pub fn amplitude_by_sway(
    run: &RunResult,
    gait: &GaitSpec,
    period_s: f64,
    swimmer: &SwimmerFile,
) -> Option<(f64, f64)> {}
pub fn assess(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
) -> Result<Assessment, FitError> {}
pub fn c_t_form(drag: &TangentialDrag<f64>) -> String {}
pub fn calibrate_campaign(
    campaign: &Campaign,
    data: &CampaignData,
    options: FitOptions,
) -> Result<CampaignFit, CalibrateError> {}
pub fn calibrate_run(
    run: &RunData,
    reflectors: &Reflectors,
    swimmer: &SwimmerFile,
) -> Result<RunResult, CalibrateError> {}
pub fn fit_further(
    found: &CampaignFit,
    further: &[Further],
) -> Result<FurtherFit, FitError> {}
pub fn joint_path(
    gait: &AnyGait,
    servo: Option<&ServoFile>,
    period_s: f64,
) -> Result<Vec<(f64, [f64; 2])>, PredictionError> {}
pub fn load_run(
    file: &Path,
    gait: &swimmer_files::GaitSpec,
    period_s: f64,
    options: &TrackOptions,
) -> Result<RunData, CalibrateError> {}
pub fn load_tracks(
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackFile, CalibrateError> {}
pub fn other_gaits(
    campaign: &Campaign,
    runs: &[RunResult],
    swimmer: &SwimmerFile,
) -> Vec<OtherGait> {}
pub fn poses(
    track: &TrackFile,
    reflectors: &Reflectors,
    options: &PoseOptions,
) -> Result<PoseTrack, PoseError> {}
pub fn predict(
    file: &SwimmerFile,
    gait: &AnyGait,
    period_s: f64,
) -> Result<PredictedCycle, PredictionError> {}
pub fn read_tracks(bytes: &[u8], file: &Path) -> Result<TrackFile, TrackError> {}
pub fn read_tracks_with(
    bytes: impl Read,
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackFile, TrackError> {}
pub fn survey_file(
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackSurvey, CalibrateError> {}
pub fn survey_tracks(
    bytes: impl Read,
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackSurvey, TrackError> {}
pub fn track_options(reflectors: &Reflectors, settings: &TrackSettings) -> TrackOptions {}
pub fn usual_reflectors(track: &TrackFile, swimmer: &Swimmer<f64>) -> Reflectors {}
pub fn weigh_evidence(
    found: &CampaignFit,
    options: EvidenceOptions,
) -> Result<Evidence, FitError> {}
pub mod assessment {
    pub use crate::Assessment;
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct AssessmentDocument {
        pub verdict: &'static str,
        pub reasons: Vec<String>,
        pub reduced_chi2: Option<f64>,
        pub intervals_with_systematics: Option<Intervals>,
        pub headline: HeadlinePart,
        pub goodness: GoodnessPart,
        pub systematics: Option<SystematicsPart>,
        pub budget: Vec<BudgetLine>,
        pub explanations: Vec<Explanation>,
        pub excluded: Vec<ExcludedPart>,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct BudgetLine {
        pub name: &'static str,
        pub by: f64,
        pub unit: &'static str,
        pub sphere_radius: f64,
        pub chi: f64,
        pub width: Option<f64>,
        pub stated: bool,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct ExcludedPart {
        pub file: String,
        pub reason: String,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct Explained {
        pub name: &'static str,
        pub unit: &'static str,
        pub before: f64,
        pub value: f64,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct Explanation {
        pub name: &'static str,
        pub parameters: Vec<Explained>,
        pub gain: f64,
        pub estimate: Pair,
    }
    #[derive(Debug, Clone, PartialEq)]
    pub struct Goodness {
        pub reduced_chi2: Option<f64>,
        pub freedom: usize,
        pub signs: Vec<SignTest>,
        pub runs: Vec<RunGoodness>,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct GoodnessPart {
        pub freedom: usize,
        pub reduced_chi2_with_systematics: Option<f64>,
        pub signs: Vec<SignTest>,
        pub runs: Vec<RunPart>,
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Headline {
        pub by: &'static str,
        pub estimate: Pair,
        pub intervals: Intervals,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct HeadlinePart {
        pub by: &'static str,
        pub estimate: Pair,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct Nuisance {
        pub name: &'static str,
        pub unit: &'static str,
        pub known: [f64; 2],
        pub stated: bool,
        pub found: [f64; 2],
        pub pull: f64,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct OutlierPart {
        pub file: String,
        pub quantity: &'static str,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct RunGoodness {
        pub y_over_x: [f64; 2],
        pub y_chance: f64,
        pub turn_rad: [f64; 2],
        pub turn_chance: f64,
        pub drift_m_per_s: [f64; 2],
        pub scale: Option<[f64; 2]>,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct RunPart {
        pub file: String,
        pub goodness: RunGoodness,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct SignTest {
        pub quantity: &'static str,
        pub signs: Vec<i8>,
        pub stretches: usize,
        pub chance: f64,
    }
    #[derive(Debug, Clone, PartialEq)]
    pub struct Systematics {
        pub estimate: Pair,
        pub intervals: Intervals,
        pub nuisances: Vec<Nuisance>,
        pub unforeseen: Vec<Unforeseen>,
        pub outliers: Vec<(usize, &'static str)>,
        pub reduced_chi2: Option<f64>,
    }
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct SystematicsPart {
        pub estimate: Pair,
        pub parameters: Vec<Nuisance>,
        pub unforeseen: Vec<Unforeseen>,
        pub outliers: Vec<OutlierPart>,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct Unforeseen {
        pub name: &'static str,
        pub unit: &'static str,
        pub value: f64,
        pub gain: f64,
        pub log_odds: f64,
        pub remedy: &'static str,
    }
    pub use crate::Verdict;
    pub use crate::assess;
}
pub mod cycles {
    pub use crate::Cycle;
    pub use crate::CycleError;
    pub use crate::CycleWarning;
    pub use crate::Cycles;
    pub use crate::LeftOut;
    pub use crate::Periodicity;
    pub use crate::Phase;
    pub use crate::Statistics;
    pub use crate::Timing;
}
pub mod evidence {
    #[derive(Debug, Clone, PartialEq, serde::Serialize)]
    pub struct Contour {
        pub level: f64,
        pub threshold: f64,
        pub corners: Vec<(f64, f64)>,
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct CurvePoint {
        pub amplitude_rad: f64,
        pub cycle: PredictedCycle,
    }
    #[derive(Debug, Clone, PartialEq)]
    pub struct CycleBootstrap {
        pub seed: u64,
        pub draws: usize,
        pub at_border: usize,
        pub intervals: Intervals,
        pub points: Vec<Pair>,
    }
    pub use crate::Evidence;
    #[derive(Debug, Serialize)]
    pub struct EvidenceDocument<'a> {}
    pub use crate::EvidenceOptions;
    #[derive(Debug, Clone, PartialEq, serde::Serialize)]
    pub struct Likelihood {
        pub estimate: Pair,
        pub intervals: Intervals,
        pub between_runs: [f64; 3],
        pub correlation: f64,
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Outlier {
        pub run: usize,
        pub quantity: Quantity,
        pub deviation: f64,
        pub standard_errors: f64,
        pub chance: f64,
    }
    #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
    pub struct Pair {
        pub sphere_radius: f64,
        pub chi: f64,
    }
    #[derive(Debug, Clone, PartialEq, serde::Serialize)]
    pub struct Profile {
        pub points: Vec<(f64, f64)>,
        pub threshold: f64,
        pub interval: [f64; 2],
        pub open: [bool; 2],
        pub freedom: f64,
    }
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Quantity {
        X,
        DeltaY,
        DeltaTheta,
    }
    impl Quantity {
        pub const ALL: [Self; 3] = [Self::X, Self::DeltaY, Self::DeltaTheta];
    }
    impl std::fmt::Display for Quantity {}
    #[derive(Debug, Clone, PartialEq, serde::Serialize)]
    pub struct Ridge {
        pub sphere_radius: Vec<f64>,
        pub chi: Vec<f64>,
        pub log_ratio: Vec<Vec<f64>>,
        pub contours: Vec<Contour>,
    }
    #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
    pub struct RunError {
        pub measured: f64,
        pub predicted: f64,
        pub within: f64,
        pub standard_error: f64,
        pub standardised: f64,
    }
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct WithoutRun {
        pub run: usize,
        pub paper: Pair,
        pub likelihood: Option<Pair>,
    }
    pub fn circle_curve(file: &SwimmerFile, period_s: f64) -> Vec<CurvePoint> {}
    pub use crate::weigh_evidence;
}
pub mod fit {
    pub use crate::CampaignFit;
    pub use crate::ExcludedRun;
    pub use crate::Fit;
    pub use crate::FitOptions;
    pub use crate::FitWarning;
    pub use crate::Intervals;
    pub use crate::RunResidual;
    pub use crate::c_t_form;
}
pub mod joints {
    pub use crate::Measured;
    pub use crate::MeasuredJoints;
    pub use crate::MeasuredServo;
    pub fn combined(values: &[Measured]) -> Option<Measured> {}
}
pub mod nuisance {
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct FittedParameter {
        pub name: &'static str,
        pub unit: &'static str,
        pub before: f64,
        pub value: f64,
        pub interval: [f64; 2],
        pub bounds: [f64; 2],
    }
    pub use crate::Further;
    pub use crate::FurtherFit;
    #[derive(Debug, Clone, PartialEq)]
    pub enum FurtherWarning {
        Alike { names: [&'static str; 2], correlation: f64 },
        Unbounded { name: &'static str },
        AtBound { name: &'static str, bound: f64 },
        IllConditioned { condition: f64 },
        NoBetter { gain: f64, parameters: usize },
    }
    impl std::fmt::Display for FurtherWarning {}
    impl Serialize for FurtherWarning {}
    pub use crate::fit_further;
}
pub mod poses {
    pub use crate::Drift;
    pub use crate::FollowReport;
    pub use crate::FrontRule;
    pub use crate::Jump;
    pub use crate::Origin;
    #[derive(Debug, Clone, PartialEq)]
    pub struct Plane {
        pub normal: Vector3<f64>,
        pub x: Vector3<f64>,
        pub y: Vector3<f64>,
        pub rms_m: f64,
        pub fitted: bool,
        pub map: String,
    }
    impl Plane {
        pub fn fit(points: &[Vector3<f64>], axes: Option<Axes>) -> Self {}
        pub fn project(&self, point: &Vector3<f64>) -> Vector2<f64> {}
    }
    pub use crate::PoseError;
    pub use crate::PoseOptions;
    pub use crate::PoseSample;
    pub use crate::PoseTrack;
    pub use crate::PoseWarning;
    pub use crate::Stretch;
    pub use crate::poses;
    pub use crate::usual_reflectors;
}
pub mod tracks {
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub struct Place {
        pub file: PathBuf,
        pub line: usize,
        pub column: usize,
    }
    impl fmt::Display for Place {}
    pub use crate::PointKind;
    pub use crate::PointPresence;
    pub use crate::TrackError;
    pub use crate::TrackFile;
    pub use crate::TrackFormat;
    pub use crate::TrackOptions;
    pub use crate::TrackPoint;
    pub use crate::TrackProblem;
    pub use crate::TrackSurvey;
    pub use crate::TrackWarning;
    pub use crate::Unit;
    pub use crate::read_tracks;
    pub use crate::read_tracks_with;
    pub use crate::survey_tracks;
}
