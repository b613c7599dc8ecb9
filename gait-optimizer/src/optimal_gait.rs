//! Result of an optimisation: the gait, its figures and its certificate.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, GaitArc, GaitFile, Objective, SwimmerHash};
use swimmer_model::{InvalidSamples, Model, Stroke, Swimmer, Tolerance, trajectory, wrapped_angle};

use crate::certificate::{Certificate, double_area};
use crate::cycle::{Arc, Cycle};
use crate::displacement::Heading;

/// Numbers that only an efficiency gait has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyFigures {
    /// Max-norm of the shooting conditions: gaps between pieces and at both ends, angles in rad, momenta over |p|.
    pub residual: f64,
    /// (max − min)/mean of the power along the extremal.
    pub power_variation: f64,
    /// Origin of the initial guess: [`Method::word`](crate::Method::word), or the method's name for a [`Direct`](crate::Direct)
    /// gait.
    pub method: &'static str,
    /// ξ of the initial guess, if it is the result of a direct method of its own.
    pub direct_efficiency: Option<f64>,
}

/// An optimal gait with its certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalGait {
    /// Objective that it is optimal for.
    pub objective: Objective,
    /// Swimmer that it is computed for.
    pub swimmer: Swimmer<f64>,
    /// The bounds it obeys.
    pub bounds: Bounds,
    /// Period \[s\] in which it is the farthest gait; `None` if the period was free.
    pub optimal_period: Option<f64>,
    /// Net displacement X of a full cycle over L, signed, along the middle link's heading at the first sample.
    pub displacement_over_length: f64,
    /// The same in metres.
    pub displacement: f64,
    /// Net displacement Y of a full cycle over L, across that heading; zero for a gait with the paper's two symmetries.
    pub lateral_over_length: f64,
    /// Net rotation of a full cycle \[rad\].
    pub rotation: f64,
    /// Lighthill's efficiency ξ at constant power.
    pub efficiency: f64,
    /// `true` if the gait has the paper's two symmetries, so that a quarter determines it.
    pub symmetric: bool,
    /// φ₁ at the first sample \[rad\]; φ₁ = φ₂ there if the gait is symmetric.
    pub start_angle: f64,
    /// φ₂ at the end of the first quarter \[rad\]; φ₂ = −φ₁ there if the gait is symmetric.
    pub end_angle: f64,
    /// The arcs in order: of the quarter if the gait is symmetric, of the cycle otherwise. Of a clockwise displacement gait, as
    /// `start_angle` and `end_angle`, of the quarter that is run counter-clockwise.
    pub arcs: Vec<Arc>,
    /// Share of the cycle, as timed at constant power, with crossing links.
    pub links_cross: f64,
    /// The necessary conditions, each with its number.
    pub certificate: Certificate,
    /// Figures of efficiency gaits.
    pub efficiency_figures: Option<EfficiencyFigures>,
    /// Number of extremals that the search found in its class, this one included; it returned the best certified one. `None` for
    /// a solver that follows a single extremal.
    pub extremals: Option<usize>,
    pub(crate) cycle: Cycle,
    /// Net displacement over L as the model swims the samples.
    pub(crate) swum: Vector2<f64>,
}

impl OptimalGait {
    /// A gait with the figures of its cycle, integrated by the model of the swimmer with L = 1; its certificate is still empty.
    pub(crate) fn of_cycle(
        (objective, swimmer, bounds): (Objective, &Swimmer<f64>, &Bounds),
        symmetric: bool,
        cycle: Cycle,
        stroke: &Stroke<f64>,
    ) -> Self {
        let model = Model::new(&swimmer.of_unit_length());
        let over_length = stroke.displacement_over_length();
        let first = cycle.phi.first().copied().unwrap_or_default();
        let last = cycle.quarter().last().copied().unwrap_or_default();
        Self {
            objective,
            swimmer: *swimmer,
            bounds: *bounds,
            optimal_period: None,
            displacement_over_length: over_length.x,
            displacement: over_length.x * swimmer.total_length(),
            lateral_over_length: over_length.y,
            rotation: stroke.rotation,
            efficiency: stroke.efficiency_constant_power(),
            symmetric,
            start_angle: first.x,
            end_angle: last.y,
            arcs: cycle.arcs(symmetric),
            links_cross: model.map_or(f64::NAN, |model| cycle.links_cross(&model)),
            certificate: Certificate::new(Vec::new()),
            efficiency_figures: None,
            extremals: None,
            cycle,
            swum: over_length,
        }
    }

    /// Angle of the displacement against the cycle's mean heading, timed as the samples are \[rad\], in (−π, π\]: independent of
    /// the first sample. Returns `None` if the gait cannot be integrated.
    pub fn heading(&self) -> Option<f64> {
        const LOOKS: usize = 2048;
        let model = Model::new(&self.swimmer.of_unit_length()).ok()?;
        let gait = self.gait().ok()?;
        let mut headings = 0.0;
        trajectory(&model, &gait, &Tolerance::new(1e-11), LOOKS, |point| {
            // The trapezoidal rule: both ends have the same heading.
            if point.u > 0.0 {
                headings += point.pose.theta;
            }
        });
        let off = self
            .lateral_over_length
            .atan2(self.displacement_over_length)
            - headings / LOOKS as f64;
        Some(wrapped_angle(off))
    }

    /// The gait of the mirrored swimmer, Φ → −Φ: as far across, to the other side; as much rotation, the other way.
    #[must_use]
    pub(crate) fn mirrored(mut self) -> Self {
        for phi in &mut self.cycle.phi {
            *phi = -*phi;
        }
        for arc in &mut self.arcs {
            arc.from = arc.from.map(|angle| -angle);
            arc.to = arc.to.map(|angle| -angle);
        }
        self.lateral_over_length = -self.lateral_over_length;
        self.swum.y = -self.swum.y;
        self.rotation = -self.rotation;
        self.start_angle = -self.start_angle;
        self.end_angle = -self.end_angle;
        self
    }

    /// The same curve run backwards if it swims backwards. A displacement gait with X < 0 becomes a clockwise one with X > 0; its
    /// arcs stay those of the counter-clockwise quarter.
    #[must_use]
    pub(crate) fn swum_forwards(mut self) -> Self {
        if self.displacement_over_length < 0.0 {
            self.cycle = self.cycle.reversed(|phi| *phi);
            self.displacement_over_length = -self.displacement_over_length;
            self.displacement = -self.displacement;
            self.lateral_over_length = -self.lateral_over_length;
            self.rotation = -self.rotation;
            self.swum = -self.swum;
        }
        self
    }

    /// `true` if the curve runs clockwise in the plane of (φ₁, φ₂).
    pub fn is_clockwise(&self) -> bool {
        double_area(self.phi()) < 0.0
    }

    /// The sense of X if the curve is run counter-clockwise.
    pub(crate) fn heading_counter_clockwise(&self) -> Heading {
        if (self.displacement_over_length < 0.0) == self.is_clockwise() {
            Heading::Forwards
        } else {
            Heading::Backwards
        }
    }

    /// Fractions of the period of the samples, 0 to 1, at constant power.
    pub fn u(&self) -> &[f64] {
        &self.cycle.u
    }

    /// Joint angles \[rad\] at each `u`; the last is the first again.
    pub fn phi(&self) -> &[Vector2<f64>] {
        &self.cycle.phi
    }

    /// Fractions of the period where the direction in the (φ₁, φ₂) plane jumps.
    pub fn corners(&self) -> &[f64] {
        &self.cycle.corners
    }

    /// The arcs of the whole cycle.
    pub fn cycle_arcs(&self) -> &[GaitArc] {
        &self.cycle.arcs
    }

    /// The samples as a gait that can be swum.
    ///
    /// # Errors
    /// Never for a gait that this crate made; see [`AnyGait::from_file`].
    pub fn gait(&self) -> Result<AnyGait, InvalidSamples> {
        self.cycle.gait()
    }

    /// Gait file of this gait; `swimmer_name` is a label for people.
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {
        GaitFile {
            objective: self.objective,
            swimmer_name: Some(swimmer_name.to_owned()),
            swimmer_hash: Some(SwimmerHash::of(&self.swimmer)),
            optimal_period: self.optimal_period,
            ..self.cycle.file(self.bounds)
        }
    }
}
