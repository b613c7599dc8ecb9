// What `collocation` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Debug, Clone, PartialEq, Error)]
pub enum CollocationError {
    Problem { name: &'static str, value: f64, problem: &'static str },
    Guess { problem: &'static str },
    WrongWay { x: f64, wanted: f64 },
    Stalled { iterations: usize, efficiency: f64 },
    NoStart { branch: Branch },
    Polish(EfficiencyError),
    Spurious { efficiency: f64, again: f64, points: usize },
}
impl From<InvalidProblem> for CollocationError {}
#[derive(Debug, Clone, Copy)]
pub struct CollocationProblem<'a> {
    pub model: &'a Model<f64>,
    pub bounds: Bounds,
    pub sign: f64,
    pub elements: usize,
    pub degree: usize,
}
impl<'a> CollocationProblem<'a> {
    pub fn new(model: &'a Model<f64>, sign: f64) -> Self {}
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {}
}
#[derive(Debug, Clone)]
pub struct CollocationSolution {
    pub efficiency: f64,
    pub efficiency_again: f64,
    pub overstepped: f64,
}
impl CollocationSolution {
    pub fn phi(&self, t: f64) -> Vector2<f64> {}
    pub fn gait(&self) -> Result<AnyGait, CollocationError> {}
}
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, CollocationError> {}
pub fn solve<G: Gait<f64> + ?Sized>(
    problem: &CollocationProblem<'_>,
    guess: &G,
) -> Result<CollocationSolution, CollocationError> {}
