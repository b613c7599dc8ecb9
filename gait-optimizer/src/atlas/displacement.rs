//! The atlas of displacement: simple closed loops of singular arcs and bounds.
//!
//! Displacement alone has no coarse optimum to run into: curves of a Fourier series curl ever more (the optima are weak).
//! So the starts are led to it through −ln |d|² + κ ln E with κ falling, as far as the curve stays simple; the last one
//! is close enough to close the exact loop from.

use nalgebra::DMatrix;
use swimmer_files::Objective;
use swimmer_model::{Model, Stroke};

use super::AtlasProblem;
use super::barrier::Barrier;
use super::distinct::Outline;
use super::newton::{Settings, Stationary};
use super::pipeline::{MultiStart, distance};
use super::sections::guesses;
use super::starts::through;
use crate::certificate::Condition;
use crate::certify::{certified, ways_up};
use crate::closed_curve::Functional;
use crate::displacement::{DisplacementProblem, Heading, best_symmetric};
use crate::loops::{ClosedOrbit, close, traced};
use crate::optimal_gait::OptimalGait;
use crate::region::Region;

/// Gaits that gain less than this over another, over L, are not on the way up from it.
const HIGHER: f64 = 1e-9;

pub(super) struct Displacement<'a> {
    pub(super) problem: &'a AtlasProblem,
    pub(super) model: &'a Model<f64>,
    pub(super) region: &'a Region,
}

impl MultiStart for Displacement<'_> {
    const ENERGY_WEIGHTS: &'static [f64] = &[0.6, 0.25, 0.1];
    const SETTINGS: Settings = Settings {
        iterations: 80,
        residual: 1e-7,
        barrier: (1e-2, 1e-5),
    };
    const SIMPLE: bool = true;

    fn value(gait: &OptimalGait) -> f64 {
        distance(gait)
    }

    fn value_of(stroke: &Stroke<f64>) -> f64 {
        stroke.displacement.norm()
    }

    fn known(&self, problem: &AtlasProblem) -> Vec<OptimalGait> {
        let quarters = DisplacementProblem {
            bounds: problem.bounds,
            quarter_samples: problem.samples.div_ceil(4),
            ..DisplacementProblem::new(problem.swimmer)
        };
        [Heading::Forwards, Heading::Backwards]
            .into_iter()
            .filter_map(|heading| best_symmetric(&quarters, heading, &|_| ()).ok())
            // Optimal among gaits of its symmetry; there it may be a saddle among all.
            .map(certified)
            .collect()
    }

    fn polished(
        &self,
        functional: &Functional<'_>,
        barrier: &Barrier,
        coarse: &Stationary,
    ) -> Option<OptimalGait> {
        let gait = self.extremals(functional, &coarse.coefficients).next()?;
        if gait.certificate.pass() {
            return Some(gait);
        }
        // A saddle. Where it is pushed up, a better extremal may be near.
        ways_up(self.model, &gait).iter().find_map(|pushed| {
            self.extremals(functional, &through(pushed, functional.basis, barrier))
                .filter(|there| distance(there) > distance(&gait) + HIGHER)
                .find(|there| there.certificate.pass())
        })
    }
}

impl Displacement<'_> {
    /// The closed extremals that a coarse curve leads to, saddles among them.
    fn extremals(
        &self,
        functional: &Functional<'_>,
        coarse: &DMatrix<f64>,
    ) -> impl Iterator<Item = OptimalGait> {
        let (model, region) = (self.model, self.region);
        guesses(functional, model, region, coarse)
            .into_iter()
            .filter_map(|guess| close(model, region, guess))
            .filter_map(|orbit| self.gait(&orbit))
            .map(certified)
            .filter(|gait| {
                gait.certificate
                    .holds_but(&[Condition::NoAscent, Condition::NoAscentWithoutSymmetry])
            })
    }

    /// A closed loop as a gait, not yet certified.
    fn gait(&self, orbit: &ClosedOrbit) -> Option<OptimalGait> {
        let (problem, model) = (self.problem, self.model);
        let cycle = traced(model, orbit, problem.samples)?;
        let stroke = cycle.swum(model)?;
        let symmetric =
            Outline::new(&cycle.phi).is_symmetric() && stroke.displacement.y.abs() < 1e-8;
        let of = (Objective::Displacement, &problem.swimmer, &problem.bounds);
        Some(OptimalGait::of_cycle(of, symmetric, cycle, &stroke))
    }
}
