// What `validation` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

pub const LARGEST: f64 = 4.5;
#[derive(Debug)]
pub struct Lighthill {
    pub small: OptimalGait,
    pub large: OptimalGait,
}
#[derive(Debug, Clone, Copy, Serialize)]
pub enum Printed {
    Number(f64),
    Words(&'static str),
}
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub id: &'static str,
    pub quantity: &'static str,
    pub paper: Printed,
    pub ours: f64,
    pub deviation: f64,
    pub pass: Option<bool>,
    pub note: &'static str,
}
#[derive(Debug)]
pub struct Simple {
    pub displacement: [Vec<BestAmplitude>; 2],
    pub efficiency: [Vec<BestAmplitude>; 2],
    pub curves: [Vec<(f64, Stroke<f64>)>; 2],
}
#[derive(Debug)]
pub struct Study {
    pub purcell: Model<f64>,
    pub robot: Model<f64>,
    pub slender: Model<f64>,
    pub purcell_simple: Simple,
    pub robot_simple: Simple,
    pub slender_simple: Simple,
    pub purcell_displacement: OptimalGait,
    pub robot_displacement: [OptimalGait; 3],
    pub robot_unbounded: bool,
    pub purcell_lighthill: Lighthill,
    pub robot_lighthill: Lighthill,
    pub robot_map: HeightMap,
    pub purcell_map: HeightMap,
}
impl Study {
    pub fn new(watch: &dyn Fn(f64)) -> Result<Self, StudyError> {}
}
#[derive(Debug, Clone, thiserror::Error)]
pub enum StudyError {
    NoGait { gait: String, reason: String },
    Swimmer(InvalidSwimmer),
    HeightMap(HeightMapError),
}
pub const UPPER: f64 = 2.8;
pub fn rows(study: &Study) -> Vec<Row> {}
