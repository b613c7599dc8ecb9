//! What the model says that the runs should have measured, where more than r_s and χ may differ from what the files say.
//!
//! Cycles were cut where the heading matched a fitted model's; a model with other parameters has another heading, and its
//! cycles are cut in the same way before they are compared.

use std::borrow::Cow;

use nalgebra::{DMatrix, Vector2};
use swimmer_files::{ServoFile, SwimmerFile};
use swimmer_model::{InvalidSwimmer, Pose, TangentialDrag};

use super::parameter::{Parameter, over_viscosity};
use crate::cycles::Projection;
use crate::least_squares::Model;
use crate::prediction::{JointPath, Played, PredictedCycle};
use crate::quantities::{QUANTITIES, predicted};
use crate::run::RunResult;

/// Runs, and the parameters that may differ.
pub(crate) struct RunModel {
    pub(crate) start: SwimmerFile,
    runs: Vec<Played>,
    projection: Projection,
    scales: [f64; QUANTITIES],
    pub(crate) parameters: Vec<Parameter>,
}

impl RunModel {
    pub(crate) fn new(
        start: SwimmerFile,
        runs: Vec<Played>,
        scales: [f64; QUANTITIES],
        parameters: Vec<Parameter>,
    ) -> Self {
        Self {
            start,
            runs,
            projection: Projection::new(),
            scales,
            parameters,
        }
    }

    /// For runs whose cycles were cut by `fitted`.
    pub(crate) fn of_runs(
        start: &SwimmerFile,
        runs: &[RunResult],
        fitted: &SwimmerFile,
        scales: [f64; QUANTITIES],
        parameters: Vec<Parameter>,
    ) -> Result<Self, InvalidSwimmer> {
        let projection = Projection::new();
        let played = |run: &RunResult| {
            if run.played.sides.is_some() {
                return Ok(run.played.clone());
            }
            let heading = run.played.path.predict(&fitted.swimmer, &projection)?.1;
            Ok(Played {
                cut_by: Some(heading),
                ..run.played.clone()
            })
        };
        let runs = runs
            .iter()
            .map(played)
            .collect::<Result<_, InvalidSwimmer>>()?;
        Ok(Self::new(start.clone(), runs, scales, parameters))
    }

    /// The same with other parameters.
    pub(crate) fn with(&self, parameters: Vec<Parameter>) -> Self {
        let (start, runs) = (self.start.clone(), self.runs.clone());
        Self::new(start, runs, self.scales, parameters)
    }

    /// The same with other runs.
    pub(crate) fn with_runs(&self, runs: Vec<Played>) -> Self {
        let parameters = self.parameters.clone();
        Self::new(self.start.clone(), runs, self.scales, parameters)
    }

    /// Whether a parameter moves anything: what is about servos does where a run has no measured angles.
    pub(crate) fn has_use_for(&self, parameter: Parameter) -> bool {
        let measured = |run: &Played| run.sides.is_some();
        !(parameter.is_of_command() && self.runs.iter().all(measured)
            || parameter.is_of_side_links() && !self.runs.iter().any(measured))
    }

    /// The same with servos that do as they are told.
    pub(crate) fn with_ideal_servos(&self) -> Self {
        let ideal = |run: &Played| match run.sides {
            Some(_) => run.clone(),
            None => Played {
                path: JointPath::Ideal(run.gait.clone()),
                ..run.clone()
            },
        };
        self.with_runs(self.runs.iter().map(ideal).collect())
    }

    /// A parameter's value, if it is one of these.
    fn value(&self, at: &[f64], parameter: Parameter) -> Option<f64> {
        let place = self.parameters.iter().position(|p| *p == parameter)?;
        at.get(place).copied()
    }

    /// The swimmer file at these parameters.
    pub(crate) fn file(&self, at: &[f64]) -> SwimmerFile {
        let mut file = self.start.clone();
        let swimmer = &mut file.swimmer;
        if let Some(radius) = self.value(at, Parameter::SphereRadius) {
            swimmer.sphere_radius = radius * swimmer.total_length();
        }
        if let Some(chi) = self.value(at, Parameter::Chi) {
            swimmer.chi = chi.exp();
        }
        if let Some(ratio) = self.value(at, Parameter::TangentialDrag) {
            let value = over_viscosity(&self.start.swimmer) * ratio.exp();
            swimmer.tangential_drag = TangentialDrag::OverViscosity(value);
        }
        if let Some(dead_band) = self.value(at, Parameter::DeadBand) {
            file.servo = Some(ServoFile {
                dead_band,
                ..file.servo.unwrap_or_default()
            });
        }
        file
    }

    /// A parameter's value in units of people.
    pub(crate) fn natural(&self, parameter: Parameter, value: f64) -> f64 {
        parameter.natural(value, &self.start.swimmer)
    }

    /// One cycle of every run; `None` where the swimmer cannot swim.
    pub(crate) fn cycles(&self, at: &[f64]) -> Option<Vec<PredictedCycle>> {
        let file = self.file(at);
        let length = self.start.swimmer.total_length();
        let dead_band = self.value(at, Parameter::DeadBand);
        let or_none = |parameter: Parameter| self.value(at, parameter).unwrap_or(0.0);
        let [front, back] = [Parameter::FrontGain, Parameter::BackGain].map(or_none);
        let gain = Vector2::new(1.0 + front, 1.0 + back) * (1.0 + or_none(Parameter::Gain));
        let offset = [Parameter::FrontOffset, Parameter::BackOffset].map(or_none);
        let [along, across] = [Parameter::MarkerAlong, Parameter::MarkerAcross].map(or_none);
        let marker = Pose::new(
            along * length,
            across * length,
            or_none(Parameter::MarkerAngle),
        );
        let scale = 1.0 + or_none(Parameter::Scale);
        let moves = |parameter: &Parameter| parameter.moves_joints();
        let moved = self.parameters.iter().any(moves);
        let links = [Parameter::FrontLink, Parameter::BackLink].map(or_none);
        let pace = self.value(at, Parameter::Period);
        let lag_s = self.value(at, Parameter::FrontLag);
        let cycle = |run: &Played| {
            let mut path = Cow::Borrowed(&run.path);
            if let Some(sides) = &run.sides {
                let angle =
                    |phi: &Vector2<f64>| sides.corrected(phi, marker, scale - 1.0, links.into());
                path = Cow::Owned(path.with_vertices(angle));
            } else if dead_band.is_some() || pace.is_some() {
                let period_s = run.period_s * (1.0 + pace.unwrap_or(0.0));
                path = Cow::Owned(JointPath::new(&run.gait, file.servo.as_ref(), period_s).ok()?);
            }
            if let (Some(lag_s), None) = (lag_s, run.sides) {
                path = Cow::Owned(path.with_front_later(lag_s / run.period_s));
            }
            if moved && run.sides.is_none() {
                path = Cow::Owned(path.moved(gain, offset.into()));
            }
            let cut_by = run.cut_by.as_ref();
            let cycle = path.predict_as_cut(&file.swimmer, &self.projection, marker, cut_by);
            let cycle = cycle.ok()?;
            Some(PredictedCycle {
                x_m: scale * cycle.x_m,
                y_m: scale * cycle.y_m,
                delta_y_m: scale * cycle.delta_y_m,
                ..cycle
            })
        };
        self.runs.iter().map(cycle).collect()
    }
}

impl Model for RunModel {
    fn bounds(&self) -> Vec<(f64, f64)> {
        let of = |parameter: &Parameter| parameter.bounds(&self.start.swimmer);
        self.parameters.iter().map(of).collect()
    }

    /// X, ΔY, Δθ, Y and net turn of every run, in units of their scales; `None` where the swimmer cannot swim.
    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut out = Vec::with_capacity(QUANTITIES * self.runs.len());
        for cycle in self.cycles(at)? {
            out.extend(
                predicted(&cycle)
                    .iter()
                    .zip(self.scales)
                    .map(|(v, scale)| v / scale),
            );
        }
        out.iter().all(|value| value.is_finite()).then_some(out)
    }

    /// By differences of second order, wide for what is not smooth, one-sided next to a bound.
    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(QUANTITIES * self.runs.len(), at.len());
        for (column, (parameter, (low, high))) in
            self.parameters.iter().zip(self.bounds()).enumerate()
        {
            let look = |by: f64| {
                let mut z = at.to_vec();
                z[column] += by;
                self.values(&z)
            };
            let step = parameter.step();
            let (h, centred) = if at[column] - step < low {
                (step, false)
            } else {
                (-step, (at[column] + step) <= high)
            };
            let slopes: Vec<f64> = if centred {
                let (behind, ahead) = (look(-step)?, look(step)?);
                let pairs = behind.iter().zip(&ahead);
                pairs.map(|(b, a)| (a - b) / (2.0 * step)).collect()
            } else {
                let (here, one, two) = (look(0.0)?, look(h)?, look(2.0 * h)?);
                let values = here.iter().zip(&one).zip(&two);
                values
                    .map(|((c, a), b)| (4.0 * a - b - 3.0 * c) / (2.0 * h))
                    .collect()
            };
            for (row, slope) in slopes.into_iter().enumerate() {
                jacobian[(row, column)] = slope;
            }
        }
        Some(jacobian)
    }
}
