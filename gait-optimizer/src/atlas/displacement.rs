//! The atlas of displacement: simple closed loops of singular arcs and bounds.
//!
//! Displacement alone has no coarse optimum to run into: curves of a Fourier series curl ever more (the optima are weak).
//! So the starts are led to it through −ln |d|² + κ ln E with κ falling, as far as the curve stays simple; the last one
//! is close enough to close the exact loop from.

use swimmer_files::Objective;
use swimmer_model::Model;

use super::AtlasProblem;
use super::distinct::Outline;
use super::gates::guesses;
use super::newton::{Settings, Stationary};
use super::pipeline::{Seek, distance};
use crate::closed_curve::Functional;
use crate::loops::{Closed, LoopTrace, close};
use crate::optimal_gait::Solution;
use crate::region::Region;
use crate::{Certificate, DisplacementProblem, Heading, OptimalGait};

/// Curves are symmetric to within this, the sag of the outline that they are compared by \[rad\].
const SYMMETRIC: f64 = 0.01;

pub(super) struct Displacement<'a> {
    pub(super) problem: &'a AtlasProblem,
    pub(super) model: &'a Model<f64>,
    pub(super) region: &'a Region,
}

impl Seek for Displacement<'_> {
    const THRIFT: &'static [f64] = &[0.6, 0.25, 0.1];
    const SETTINGS: Settings = Settings {
        iterations: 80,
        residual: 1e-7,
        barrier: (1e-2, 1e-5),
    };
    const SIMPLE: bool = true;

    fn value(gait: &OptimalGait) -> f64 {
        distance(gait)
    }

    fn known(&self, problem: &AtlasProblem) -> Vec<OptimalGait> {
        [Heading::Forwards, Heading::Backwards]
            .into_iter()
            .filter_map(|heading| {
                crate::displacement(&DisplacementProblem {
                    bounds: problem.bounds,
                    heading: Some(heading),
                    quarter_samples: problem.samples.div_ceil(4),
                    ..DisplacementProblem::new(problem.swimmer)
                })
                .ok()
            })
            .collect()
    }

    fn polished(&self, functional: &Functional<'_>, coarse: &Stationary) -> Option<OptimalGait> {
        let (model, region) = (self.model, self.region);
        guesses(functional, model, region, coarse)
            .into_iter()
            .filter_map(|guess| close(model, region, guess.gate, guess.from, guess.length))
            .find_map(|closed| self.certified(&closed))
    }
}

impl Displacement<'_> {
    /// A closed loop as a gait, where its certificate holds.
    fn certified(&self, closed: &Closed) -> Option<OptimalGait> {
        let (problem, model) = (self.problem, self.model);
        let trace = LoopTrace::new(model, self.region, closed, problem.samples)?;
        let stroke = trace.cycle.swum(model)?;
        let certificate = Certificate::new(trace.checks(self.region, &stroke));
        if !certificate.pass() {
            return None;
        }
        let links_cross = trace.cycle.links_cross(model);
        let symmetric = Outline::new(&trace.cycle.phi).asymmetry() < SYMMETRIC
            && stroke.displacement.y.abs() < 1e-8;
        Some(OptimalGait::new(Solution {
            objective: Objective::Displacement,
            swimmer: problem.swimmer,
            bounds: problem.bounds,
            symmetric,
            arcs: if symmetric {
                trace.quarter_arcs()
            } else {
                trace.arcs.clone()
            },
            cycle: trace.cycle,
            stroke,
            links_cross,
            certificate,
        }))
    }
}
