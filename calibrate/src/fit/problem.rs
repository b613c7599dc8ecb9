//! The weighted residuals as Levenberg–Marquardt wants them.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Dyn, OMatrix, OVector, U2, Vector2, storage::Owned};
use swimmer_model::Swimmer;

use super::Observation;
use crate::cycles::Projection;

/// Runs, and the swimmer whose r_s and χ are sought.
#[derive(Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub(crate) start: &'a Swimmer<f64>,
    pub(crate) runs: &'a [Observation],
    /// What multiplies the residuals of X, ΔY, Δθ, run by run.
    pub(crate) factors: &'a [[f64; 3]],
    pub(crate) projection: &'a Projection,
    /// Leaves the sphere out whatever p says. At p = 0 the derivative by p vanishes and Levenberg–Marquardt's scaling with
    /// it, so the border is fitted by itself: p becomes a residual of its own, whose optimum is 0.
    bare: bool,
    p: Vector2<f64>,
}

/// Step of the differences in (√(r_s/L), ln χ).
const STEP: f64 = 1e-3;

/// The swimmer at parameters (√(r_s/L), ln χ).
pub(crate) fn natural(start: &Swimmer<f64>, [p, k]: [f64; 2]) -> Swimmer<f64> {
    Swimmer {
        sphere_radius: start.total_length() * p * p,
        chi: k.exp(),
        ..*start
    }
}

impl<'a> Problem<'a> {
    pub(crate) fn new(
        start: &'a Swimmer<f64>,
        runs: &'a [Observation],
        factors: &'a [[f64; 3]],
        projection: &'a Projection,
    ) -> Self {
        Self {
            start,
            runs,
            factors,
            projection,
            bare: false,
            p: Vector2::zeros(),
        }
    }

    /// The same without a sphere: only χ is sought.
    pub(crate) fn without_sphere(&self) -> Self {
        Self {
            bare: true,
            ..*self
        }
    }

    /// The same for other runs, as many.
    pub(crate) fn of_runs<'b>(&self, runs: &'b [Observation]) -> Problem<'b>
    where
        'a: 'b,
    {
        Problem { runs, ..*self }
    }

    /// Weighted residuals, three a run; `None` where the swimmer cannot swim.
    pub(crate) fn residuals(&self, swimmer: &Swimmer<f64>) -> Option<Vec<f64>> {
        let mut out = Vec::with_capacity(3 * self.runs.len());
        for (run, factors) in self.runs.iter().zip(self.factors) {
            let cycle = run.path.predict(swimmer, self.projection).ok()?.0;
            let simulated = [cycle.x_m, cycle.delta_y_m, cycle.delta_theta_rad];
            for ((simulated, measured), factor) in simulated.iter().zip(run.measured).zip(factors) {
                out.push((simulated - measured.mean) * factor);
            }
        }
        out.iter().all(|r| r.is_finite()).then_some(out)
    }

    fn at(&self, p: [f64; 2]) -> Option<Vec<f64>> {
        if !self.bare {
            return self.residuals(&natural(self.start, p));
        }
        let mut out = self.residuals(&natural(self.start, [0.0, p[1]]))?;
        out.push(p[0]);
        Some(out)
    }

    /// The squared criterion.
    pub(crate) fn cost(&self, p: [f64; 2]) -> Option<f64> {
        Some(self.at(p)?.iter().map(|r| r * r).sum())
    }

    /// From a start to the nearest minimum.
    pub(crate) fn minimise(&self, p: [f64; 2]) -> Option<[f64; 2]> {
        let problem = Self {
            p: Vector2::from(p),
            ..*self
        };
        let solver = LevenbergMarquardt::new().with_tol(1e-12).with_patience(40);
        let (problem, report) = solver.minimize(problem);
        let end: [f64; 2] = problem.p.into();
        let usable = !report.termination.was_usage_issue() && report.objective_function.is_finite();
        (usable && end.iter().all(|v| v.is_finite())).then_some([end[0].abs(), end[1]])
    }
}

impl LeastSquaresProblem<f64, Dyn, U2> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U2>;
    type ParameterStorage = Owned<f64, U2>;

    fn set_params(&mut self, p: &Vector2<f64>) {
        self.p = *p;
    }

    fn params(&self) -> Vector2<f64> {
        self.p
    }

    fn residuals(&self) -> Option<OVector<f64, Dyn>> {
        self.at(self.p.into()).map(OVector::<f64, Dyn>::from_vec)
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U2>> {
        let column = |i: usize| {
            let at = |steps: f64| {
                let mut p: [f64; 2] = self.p.into();
                p[i] += steps * STEP;
                self.at(p)
            };
            difference(&at(-2.0)?, &at(-1.0)?, &at(1.0)?, &at(2.0)?, STEP)
        };
        let (a, b) = (column(0)?, column(1)?);
        Some(OMatrix::<f64, Dyn, U2>::from_columns(&[a, b]))
    }
}

/// The derivative from values one and two steps to either side: fourth order.
pub(crate) fn difference(
    m2: &[f64],
    m1: &[f64],
    p1: &[f64],
    p2: &[f64],
    step: f64,
) -> Option<OVector<f64, Dyn>> {
    let values = m2.iter().zip(m1).zip(p1.iter().zip(p2));
    let column: Vec<f64> = values
        .map(|((m2, m1), (p1, p2))| (8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * step))
        .collect();
    column
        .iter()
        .all(|v| v.is_finite())
        .then(|| OVector::<f64, Dyn>::from_vec(column))
}
