//! Model of all runs: predicted values as functions of r_s, χ and the nuisance parameters.
//!
//! Cycles were cut where the heading matched a fitted model's; a model with other parameters has another heading, and its
//! cycles are cut in the same way before they are compared.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use swimmer_files::{ServoFile, SwimmerFile, TankWalls};
use swimmer_model::{InvalidSwimmer, Model as SwimmerModel, Pose, TangentialDrag};

use super::parameter::{Parameter, over_viscosity};
use crate::cycles::Projection;
use crate::least_squares::Model;
use crate::prediction::{JointPath, Observation, Played, PredictedCycle, SwumCycle, View};
use crate::quantities::{QUANTITIES, predicted};
use crate::run::RunResult;
use crate::walls;

/// Runs that swam nearer to each other than this \[m\] do not determine a lens.
const SAME_PLACE: f64 = 0.02;

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
        (fitted, tank): (&SwimmerFile, Option<&TankWalls>),
        scales: [f64; QUANTITIES],
        parameters: Vec<Parameter>,
    ) -> Result<Self, InvalidSwimmer> {
        let projection = Projection::new();
        let views = views(runs);
        let played = |(run, view): (&RunResult, Option<View>)| {
            // Walls change little: the fitted swimmer serves for all.
            let own = View::of(&run.cycles);
            let near = tank.zip(own).and_then(|(tank, own)| {
                walls::change(&fitted.swimmer, &run.played.gait, tank, &own)
            });
            let played = Played {
                walls: near,
                view,
                ..run.played.clone()
            };
            if played.sides.is_some() {
                return Ok(played);
            }
            let heading = played.path.predict(&fitted.swimmer, &projection)?.1;
            Ok(Played {
                cut_by: Some(heading),
                ..played
            })
        };
        let runs = runs
            .iter()
            .zip(views)
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

    /// Returns `true` if the parameter affects any run: servo parameters need runs without measured angles, camera parameters need
    /// tracked runs, and lens parameters need runs at different places.
    pub(crate) fn has_use_for(&self, parameter: Parameter) -> bool {
        let measured = |run: &Played| run.sides.is_some();
        let view = |run: &Played| run.view.is_some();
        let near_walls = |run: &Played| run.walls.is_some();
        let apart = |run: &Played| run.view.is_some_and(|view| view.place != Vector2::zeros());
        !(parameter.is_of_command() && self.runs.iter().all(measured)
            || parameter.is_of_side_links() && !self.runs.iter().any(measured)
            || parameter.is_of_view() && !self.runs.iter().all(view)
            || parameter == Parameter::Distortion && !self.runs.iter().any(apart)
            || parameter == Parameter::WallEffect && !self.runs.iter().any(near_walls))
    }

    /// The same model with ideal servos.
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
        let length = self.start.swimmer.total_length();
        let longer = |parameter: Parameter, link: &mut f64| {
            *link += length * self.value(at, parameter).unwrap_or(0.0);
        };
        longer(Parameter::MiddleLength, &mut swimmer.links.middle);
        longer(Parameter::FrontLength, &mut swimmer.links.front);
        longer(Parameter::BackLength, &mut swimmer.links.back);
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

    /// One cycle of every run; `None` if the swimmer cannot swim.
    pub(crate) fn cycles(&self, at: &[f64]) -> Option<Vec<PredictedCycle>> {
        Some(self.seen(at, &self.swum(at)?))
    }

    /// The poses of every run's cycle.
    fn swum(&self, at: &[f64]) -> Option<Vec<SwumCycle>> {
        let file = self.file(at);
        let turning = self.value(at, Parameter::FloatTurning).unwrap_or(0.0);
        let model = SwimmerModel::new(&file.swimmer).ok()?;
        let model = model.with_turning_drag(turning.exp());
        let dead_band = self.value(at, Parameter::DeadBand);
        let unlike = self.value(at, Parameter::DeadBandDifference);
        let or_none = |parameter: Parameter| self.value(at, parameter).unwrap_or(0.0);
        let [front, back] = [Parameter::FrontGain, Parameter::BackGain].map(or_none);
        let gain = Vector2::new(1.0 + front, 1.0 + back) * (1.0 + or_none(Parameter::Gain));
        let offset = [Parameter::FrontOffset, Parameter::BackOffset].map(or_none);
        let scale = or_none(Parameter::Scale);
        let marker = self.marker(at);
        let moves = |parameter: &Parameter| parameter.moves_joints();
        let moved = self.parameters.iter().any(moves);
        let links = [Parameter::FrontLink, Parameter::BackLink].map(or_none);
        let pace = self.value(at, Parameter::Period);
        let lag_s = self.value(at, Parameter::FrontLag);
        let swum = |run: &Played| {
            let mut path = Cow::Borrowed(&run.path);
            if let Some(sides) = &run.sides {
                let angle = |phi: &Vector2<f64>| sides.corrected(phi, marker, scale, links.into());
                path = Cow::Owned(path.with_vertices(angle));
            } else if dead_band.is_some() || pace.is_some() || unlike.is_some() {
                let period_s = run.period_s * (1.0 + pace.unwrap_or(0.0));
                let by_servo = |more: f64| {
                    let servo = unlike.map_or(file.servo, |_| {
                        let servo = file.servo.unwrap_or_else(ideal_servo);
                        Some(ServoFile {
                            dead_band: (servo.dead_band + more).max(0.0),
                            ..servo
                        })
                    });
                    JointPath::new(&run.gait, servo.as_ref(), period_s).ok()
                };
                let played = by_servo(0.5 * unlike.unwrap_or(0.0))?;
                path = Cow::Owned(match unlike {
                    None => played,
                    Some(unlike) => played.with_back_of(&by_servo(-0.5 * unlike)?),
                });
            }
            if let (Some(lag_s), None) = (lag_s, run.sides) {
                path = Cow::Owned(path.with_front_later(lag_s / run.period_s));
            }
            if moved && run.sides.is_none() {
                path = Cow::Owned(path.moved(gain, offset.into()));
            }
            Some(path.swum(&model))
        };
        self.runs.iter().map(swum).collect()
    }

    /// Place of the reflectors' middle, and their line's turn.
    fn marker(&self, at: &[f64]) -> Pose<f64> {
        let length = self.start.swimmer.total_length();
        let or_none = |parameter: Parameter| self.value(at, parameter).unwrap_or(0.0);
        Pose::new(
            or_none(Parameter::MarkerAlong) * length,
            or_none(Parameter::MarkerAcross) * length,
            or_none(Parameter::MarkerAngle),
        )
    }

    /// The cycles as the cameras see them.
    fn seen(&self, at: &[f64], swum: &[SwumCycle]) -> Vec<PredictedCycle> {
        let or_none = |parameter: Parameter| self.value(at, parameter).unwrap_or(0.0);
        let scale = 1.0 + or_none(Parameter::Scale);
        let [square, diagonal] =
            [Parameter::StretchSquare, Parameter::StretchDiagonal].map(or_none);
        let cameras = Matrix2::new(1.0 + square, diagonal, diagonal, 1.0 - square);
        let distortion = or_none(Parameter::Distortion);
        let is_viewed = self
            .parameters
            .iter()
            .any(|parameter| parameter.is_of_view());
        let wall_effect = or_none(Parameter::WallEffect);
        let marker = self.marker(at);
        let see = |(run, swum): (&Played, &SwumCycle)| {
            let view = run.view.filter(|_| is_viewed);
            let seen = Observation {
                marker,
                stretch: view
                    .map_or_else(Matrix2::identity, |view| view.stretch(cameras, distortion)),
            };
            let cycle = swum.as_cut(&self.projection, &seen, run.cut_by.as_ref());
            let cycle = match &run.walls {
                Some(change) => cycle.changed(change, wall_effect),
                None => cycle,
            };
            PredictedCycle {
                x_m: scale * cycle.x_m,
                y_m: scale * cycle.y_m,
                delta_y_m: scale * cycle.delta_y_m,
                ..cycle
            }
        };
        self.runs.iter().zip(swum).map(see).collect()
    }

    /// Returns `true` if the parameter changes only the view of the poses.
    fn is_only_seen(&self, parameter: Parameter) -> bool {
        let of_marker = matches!(
            parameter,
            Parameter::MarkerAlong
                | Parameter::MarkerAcross
                | Parameter::MarkerAngle
                | Parameter::Scale
        );
        let measured = |run: &Played| run.sides.is_some();
        parameter.is_of_view()
            || parameter == Parameter::WallEffect
            || of_marker && !self.runs.iter().any(measured)
    }

    /// The derivative of all values by one parameter; `swum` are the poses of this point, if they are known.
    pub(crate) fn column(
        &self,
        at: &[f64],
        column: usize,
        swum: Option<&[SwumCycle]>,
    ) -> Option<DVector<f64>> {
        let parameter = *self.parameters.get(column)?;
        let (low, high) = parameter.bounds(&self.start.swimmer);
        let look = |by: f64| {
            let mut z = at.to_vec();
            z[column] += by;
            match swum {
                Some(swum) if self.is_only_seen(parameter) => self.scaled(&self.seen(&z, swum)),
                _ => self.values(&z),
            }
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
        Some(DVector::from_vec(slopes))
    }

    /// Values of cycles, in units of their scales; `None` if one is not finite.
    fn scaled(&self, cycles: &[PredictedCycle]) -> Option<Vec<f64>> {
        let values = cycles.iter().flat_map(|cycle| {
            let values = predicted(cycle).into_iter().zip(self.scales);
            values.map(|(value, scale)| value / scale)
        });
        let values: Vec<f64> = values.collect();
        values
            .iter()
            .all(|value| value.is_finite())
            .then_some(values)
    }
}

/// Servos without a dead band, for runs whose swimmer file names none.
fn ideal_servo() -> ServoFile {
    ServoFile {
        dead_band: 0.0,
        ..ServoFile::default()
    }
}

/// Headings and places of runs, places from their centre in units of their mean distance from it; those of runs at one place are 0.
fn views(runs: &[RunResult]) -> Vec<Option<View>> {
    let views: Vec<Option<View>> = runs.iter().map(|run| View::of(&run.cycles)).collect();
    let count = views.iter().flatten().count().max(1) as f64;
    let places = || views.iter().flatten().map(|view| view.place);
    let centre = places().sum::<Vector2<f64>>() / count;
    let squares: f64 = places().map(|place| (place - centre).norm_squared()).sum();
    let distance = (squares / count).sqrt();
    let relative = |view: View| View {
        place: if distance > SAME_PLACE {
            (view.place - centre) / distance
        } else {
            Vector2::zeros()
        },
        ..view
    };
    views.into_iter().map(|view| view.map(relative)).collect()
}

impl Model for RunModel {
    fn bounds(&self) -> Vec<(f64, f64)> {
        let of = |parameter: &Parameter| parameter.bounds(&self.start.swimmer);
        self.parameters.iter().map(of).collect()
    }

    /// X, ΔY, Δθ, Y and net turn of every run, in units of their scales; `None` if the swimmer cannot swim.
    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        self.scaled(&self.cycles(at)?)
    }

    /// By differences of second order, wide for what is not smooth, one-sided next to a bound.
    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
        let is_only_seen = |parameter: &Parameter| self.is_only_seen(*parameter);
        let here = if self.parameters.iter().any(is_only_seen) {
            Some(self.swum(at)?)
        } else {
            None
        };
        let columns = (0..at.len())
            .map(|column| self.column(at, column, here.as_deref()))
            .collect::<Option<Vec<_>>>()?;
        Some(DMatrix::from_columns(&columns))
    }
}
