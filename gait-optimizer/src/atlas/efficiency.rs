//! Atlas of efficiency gaits: closed extremals, free or along bounds, polished by multiple shooting.

use nalgebra::{DMatrix, Vector2};
use swimmer_model::{Fourier, Gait, GaitPoint, Harmonic, Model, Stroke};

use super::AtlasProblem;
use super::barrier::Barrier;
use super::distinct::Outline;
use super::newton::{Settings, Stationary};
use super::pipeline::MultiStart;
use crate::certificate::{Certificate, Condition};
use crate::closed_curve::Functional;
use crate::efficiency::{Branch, EfficiencyProblem, best_symmetric};
use crate::extremal::gait::gait;
use crate::extremal::polish;
use crate::numerics::halved;
use crate::optimal_gait::OptimalGait;
use crate::region::Region;

pub(super) struct Efficiency<'a> {
    pub(super) problem: &'a AtlasProblem,
    pub(super) model: &'a Model<f64>,
    pub(super) walls: &'a Region,
}

impl MultiStart for Efficiency<'_> {
    const ENERGY_WEIGHTS: &'static [f64] = &[1.0];
    const SETTINGS: Settings = Settings {
        iterations: 100,
        residual: 1e-9,
        barrier: (1e-2, 1e-6),
    };
    const SIMPLE: bool = false;

    fn value(gait: &OptimalGait) -> f64 {
        gait.efficiency
    }

    fn value_of(stroke: &Stroke<f64>) -> f64 {
        stroke.efficiency_constant_power()
    }

    fn known(&self, problem: &AtlasProblem) -> Vec<OptimalGait> {
        // The free gaits, scaled into the bounds, are additional starts.
        [Branch::Small, Branch::Large]
            .into_iter()
            .filter_map(|branch| {
                best_symmetric(&EfficiencyProblem::new(problem.swimmer, branch), &|_| ()).ok()
            })
            .collect()
    }

    fn polished(
        &self,
        _functional: &Functional<'_>,
        _fence: &Barrier,
        coarse: &Stationary,
    ) -> Option<OptimalGait> {
        let curve = series(&coarse.coefficients);
        let start = Shifted {
            by: home(&curve),
            curve,
        };
        let closed = self.solved(&start, false)?;
        if !closed.certificate.pass() {
            return None;
        }
        let symmetric = Outline::new(closed.phi()).is_symmetric();
        if symmetric && let Some(quarter) = self.of_quarter(&start, &closed) {
            return Some(quarter);
        }
        Some(OptimalGait {
            symmetric,
            ..closed
        })
    }
}

impl Efficiency<'_> {
    fn solved(&self, start: &Shifted, quarter: bool) -> Option<OptimalGait> {
        let extremal = polish(self.model, self.walls, start, quarter).ok()?;
        let problem = self.problem;
        let of = (&problem.swimmer, self.model, &problem.bounds);
        gait(of, &extremal, problem.samples).ok()
    }

    /// Solves a symmetric gait again from its quarter, so that it has the start and the arcs of the quarter solvers.
    fn of_quarter(&self, start: &Shifted, closed: &OptimalGait) -> Option<OptimalGait> {
        let quarter = self.solved(start, true)?;
        let same = (quarter.efficiency / closed.efficiency - 1.0).abs();
        let mut checks = quarter.certificate.checks().to_vec();
        checks.push(Condition::SameAsQuarter.check(same));
        let certificate = Certificate::new(checks);
        certificate.pass().then_some(OptimalGait {
            certificate,
            ..quarter
        })
    }
}

type Series = Fourier<f64, Vec<Harmonic<f64>>>;

fn series(coefficients: &DMatrix<f64>) -> Series {
    let column = |j: usize| Vector2::new(coefficients[(0, j)], coefficients[(1, j)]);
    Fourier {
        mean: column(0),
        harmonics: (1..=coefficients.ncols() / 2)
            .map(|k| Harmonic {
                cos: column(2 * k - 1),
                sin: column(2 * k),
            })
            .collect(),
    }
}

/// u of the outermost crossing of φ₁ = φ₂ > 0; 0 without a crossing.
fn home(curve: &Series) -> f64 {
    const LOOKS: u32 = 720;
    let place = |k: u32| f64::from(k) / f64::from(LOOKS);
    let off = |u: f64| {
        let phi = curve.at(u).phi;
        phi.x - phi.y
    };
    let mut best = (0.0, 0.0);
    for k in 0..LOOKS {
        let (low, high) = (place(k), place(k + 1));
        if off(low) * off(high) > 0.0 {
            continue;
        }
        let [low, _] = halved([low, high], 40, |u| off(low) * off(u) > 0.0);
        let out = curve.at(low).phi.sum();
        if out > best.1 {
            best = (low, out);
        }
    }
    best.0
}

/// Curve with another start.
struct Shifted {
    curve: Series,
    by: f64,
}

impl Gait<f64> for Shifted {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        self.curve.at(u + self.by)
    }
}
