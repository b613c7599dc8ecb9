// What `forecast` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    pub power: f64,
    pub peak_power: f64,
    pub torque: [f64; 2],
    pub reynolds: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errand {
    pub from: Pose<f64>,
    pub to: Vector2<f64>,
    pub heading: Option<f64>,
    pub tank: Option<Tank>,
    pub margin: f64,
    pub servos: Servos,
}
#[derive(Debug, Clone)]
pub struct Family {
    pub gaits: [(AnyGait, f64); 3],
    pub mirrored: bool,
}
impl Family {
    pub fn shape(&self) -> Vector2<f64> {}
    #[must_use]
    pub fn mirror(&self) -> Self {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    pub played: Played,
    pub stages: Vec<Loss>,
    pub way: Polyline,
    pub reach: Reach,
    pub gap: Gap,
    pub designed_gap: Gap,
    pub thickness: f64,
    pub margin: f64,
    pub verdict: Verdict,
}
impl Forecast {
    pub fn displacement_error(
        &self,
        fitted: &Swimmer<f64>,
        sphere_radius: [f64; 2],
        chi: [f64; 2],
        correlation: Option<f64>,
    ) -> Result<f64, InvalidSwimmer> {}
}
impl Forecast {
    pub fn ends(&self) -> Option<(&Loss, &Loss)> {}
    pub fn total_loss(&self) -> f64 {}
    pub fn share(&self, loss: f64) -> Option<f64> {}
    pub fn turn_radius(&self) -> f64 {}
    pub fn warnings(&self) -> Vec<String> {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForecastError {
    Table(TableError),
    Knots(InvalidSamples),
    Range { reach: Reach, max_angle: f64 },
    Period { period: f64 },
    Servo { name: &'static str, value: f64, problem: &'static str },
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    Forward,
    Left,
    Turn,
}
impl Kind {
    pub const ALL: [Self; 3] = [Self::Forward, Self::Left, Self::Turn];
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    pub stage: Stage,
    pub displacement: Vector2<f64>,
    pub rotation: f64,
    pub delta_y: f64,
    pub delta_theta: f64,
    pub loss: f64,
    pub turned: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    pub cycles: f64,
    pub part: Part,
    pub at: Vector2<f64>,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    pub kind: Kind,
    pub backwards: bool,
    pub scale: f64,
}
impl Member {
    pub fn of(&self, family: &Family) -> Scaled {}
}
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NetMotion {
    pub displacement_over_length: f64,
    pub displacement_m: f64,
    pub lateral_over_length: f64,
    pub rotation_rad: f64,
    pub delta_y_over_length: f64,
    pub delta_theta_rad: f64,
    pub efficiency: f64,
    pub efficiency_constant_power: f64,
}
impl From<&Stroke<f64>> for NetMotion {}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Part {
    BackTip,
    BackJoint,
    FrontJoint,
    FrontTip,
    Sphere,
}
impl Part {
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub steps: Vec<Step>,
    pub mirrored: bool,
    pub duration: f64,
    pub reached: Pose<f64>,
    pub way: Polyline,
    pub off: [f64; 2],
    pub met: [usize; 2],
}
impl Plan {
    pub fn gaits(&self, family: &Family) -> Vec<Scaled> {}
    pub fn word(&self, step: &Step) -> &'static str {}
    pub fn reached_by(&self, model: &Model<f64>, from: &Pose<f64>) -> Pose<f64> {}
    pub fn apart_from(&self, pose: &Pose<f64>) -> [f64; 2] {}
}
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    Apart { apart: f64 },
    Outside { what: &'static str, pose: [f64; 3], margin: f64 },
    Refused { gait: &'static str, reason: String },
    Bent { what: &'static str, pose: [f64; 3], shape: [f64; 2], margin: f64 },
    NoWay { met: usize, within: usize, margin: f64 },
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Played {
    pub servos: Servos,
    pub period: f64,
    pub knots: usize,
}
#[derive(Debug, Clone, PartialEq)]
pub struct PlaylistTable {
    pub table: GaitTable,
    pub cycles: u32,
    pub period_us: u32,
    pub step: usize,
}
impl PlaylistTable {
    pub fn duration(&self) -> f64 {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    pub u: f64,
    pub joint: usize,
    pub angle: f64,
}
#[derive(Debug, Clone)]
pub struct Repeated<G> {
    pub gait: G,
    pub cycles: u32,
    pub period: f64,
}
#[derive(Debug, Clone)]
pub struct Scaled {}
impl Gait<f64> for Scaled {}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servos {
    pub file: ServoFile,
    pub pulse_step_ns: u32,
}
impl Servos {
    pub const ROBOT_PULSE_STEP_NS: u32 = 320;
    pub fn on_the_robot(file: ServoFile) -> Self {}
    #[must_use]
    pub fn within(self, max_angle: f32, max_rate: f32) -> Self {}
    pub fn largest_angle(&self) -> f64 {}
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    Designed,
    Interpolated,
    Rounded,
    Ticked,
    Pulsed,
    RateLimited,
    Played,
}
impl Stage {
    pub const ALL: [Self; 7] = [
        Self::Designed,
        Self::Interpolated,
        Self::Rounded,
        Self::Ticked,
        Self::Pulsed,
        Self::RateLimited,
        Self::Played,
    ];
    pub fn word(self) -> &'static str {}
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub member: Member,
    pub cycles: u32,
    pub period: f64,
}
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tank {
    pub length: f64,
    pub width: f64,
}
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Timing {
    pub period: f64,
    pub shortest_period: f64,
    pub max_rate: f64,
    pub rate_at_constant_power: f64,
    pub at_limit: f64,
    pub efficiency_loss: f64,
    pub energy: f64,
}
impl Timing {
    pub fn fraction_at(&self, u: f64) -> f64 {}
    #[must_use]
    pub fn retime_file(&self, file: &GaitFile) -> GaitFile {}
}
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TimingError {
    Rate { rate: f64 },
    Period { period: f64 },
    TooFast { period: f64, rate: f64, shortest: f64 },
    Still,
    Samples(InvalidSamples),
}
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    pub refused: Option<String>,
    pub min_period: f64,
}
pub fn demand<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    fluid: &Fluid,
    gait: &G,
    period: f64,
) -> Demand {}
pub fn forecast<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    played: &Played,
) -> Result<Forecast, ForecastError> {}
pub fn meets_wall(
    model: &Model<f64>,
    way: &Polyline,
    tank: &Tank,
    start: &Pose<f64>,
) -> Option<Meeting> {}
pub fn plan(
    model: &Model<f64>,
    family: &Family,
    errand: &Errand,
) -> Result<Plan, PlanError> {}
pub fn reach<G: Gait<f64> + ?Sized>(gait: &G) -> Reach {}
pub fn shortest_of_table(
    model: &Model<f64>,
    file: &GaitFile,
    max_rate: f64,
) -> Result<(Timing, GaitFile), TimingError> {}
pub fn shortest_period<G: Gait<f64> + ?Sized>(
    gait: &G,
    max_rates: [f64; 2],
) -> Result<f64, TimingError> {}
pub fn table<G: Gait<f64> + ?Sized>(
    gait: &G,
    knots: usize,
) -> Result<GaitTable, TableError> {}
pub fn timing_of_table(
    model: &Model<f64>,
    file: &GaitFile,
    period: f64,
    max_rate: f64,
) -> Result<(Timing, GaitFile), TimingError> {}
pub fn until_wall<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    tank: &Tank,
    start: &Pose<f64>,
) -> Option<Meeting> {}
pub mod fluid {
    pub use crate::Demand;
    pub use crate::demand;
}
pub mod losses {
    pub use crate::Forecast;
    pub use crate::ForecastError;
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Gap {
        pub distance: f64,
        pub phi: Vector2<f64>,
    }
    pub use crate::Loss;
    pub use crate::Played;
    pub use crate::Servos;
    pub use crate::Stage;
    pub use crate::Verdict;
    pub use crate::forecast;
}
pub mod net_motion {
    pub use crate::NetMotion;
}
pub mod path {
    #[derive(Debug, Clone, PartialEq)]
    pub struct Polyline {}
    impl Polyline {
        pub fn new(vertices: impl IntoIterator<Item = Vector2<f64>>) -> Self {}
        pub fn vertices(&self) -> &[Vector2<f64>] {}
    }
    impl Gait<f64> for Polyline {}
}
pub mod plan {
    pub use crate::Errand;
    pub use crate::Family;
    pub use crate::Kind;
    pub use crate::Member;
    pub use crate::Plan;
    pub use crate::PlanError;
    pub use crate::Scaled;
    pub use crate::Step;
    pub use crate::plan;
}
pub mod playlist {
    pub use crate::PlaylistTable;
    pub use crate::Repeated;
    pub const SHORTEST_S: f64 = 6.0;
    pub fn leads_to<G: Gait<f64> + ?Sized>(model: &Model<f64>, way: &G) -> Pose<f64> {}
    pub fn played(tables: &[PlaylistTable], servos: &Servos) -> Polyline {}
    pub fn refused(
        tables: &[PlaylistTable],
        servos: &Servos,
        links: &Links<f64>,
    ) -> Option<(usize, String)> {}
    pub fn step_period(shortest: f64, max_rate: f64) -> f64 {}
    pub fn tables<G: Gait<f64>>(
        steps: &[Repeated<G>],
    ) -> Result<Vec<PlaylistTable>, TableError> {}
}
pub mod reach {
    pub use crate::Reach;
    pub use crate::reach;
}
pub mod table {
    pub use crate::table;
}
pub mod tank {
    pub use crate::Meeting;
    pub use crate::Part;
    pub use crate::Tank;
    pub use crate::meets_wall;
    pub use crate::until_wall;
}
pub mod timing {
    pub use crate::Timing;
    pub use crate::TimingError;
    pub use crate::shortest_of_table;
    pub use crate::shortest_period;
    pub use crate::timing_of_table;
}
