//! What the answers of all objectives share: arcs, certificate and the lines that people read.

use std::path::PathBuf;

use gait_optimizer::{Arc, Certificate, Condition, Method, Objective, OptimalGait};
use serde::Serialize;
use swimmer_files::{AnyGait, SwimmerFile};

use super::timing::TimingAnswer;
use crate::failure::{Failure, Outcome};
use crate::own_robot::PERIOD_S;
use crate::quantity::{self, Rows};

/// What every answer of a fastest gait tells first.
#[derive(Debug, Serialize)]
pub(super) struct Pace {
    pub(super) speed_over_length_per_s: f64,
    pub(super) speed_m_per_s: f64,
    /// |d| of a cycle.
    displacement_over_length: f64,
    pub(super) displacement_m: f64,
    pub(super) period_s: f64,
}

impl Pace {
    /// Of a swimmer with this speed \[1/s\] and way of a cycle, both over L, and this period \[s\].
    pub(super) fn new(file: &SwimmerFile, (speed, distance): (f64, f64), period: f64) -> Self {
        let length = file.swimmer.total_length();
        Self {
            speed_over_length_per_s: speed,
            speed_m_per_s: speed * length,
            displacement_over_length: distance,
            displacement_m: distance * length,
            period_s: period,
        }
    }

    pub(super) fn rows(&self, rows: &mut Rows) {
        rows.row(
            "speed",
            format!(
                "{} a second   |d|/(L T) = {:.10} 1/s",
                quantity::length(self.speed_m_per_s),
                self.speed_over_length_per_s
            ),
        )
        .row(
            "displacement",
            format!(
                "{} per cycle   |d|/L = {:.10}",
                quantity::length(self.displacement_m),
                self.displacement_over_length
            ),
        )
        .row("period", format!("{:.6} s", self.period_s));
    }
}

/// What every answer of a gait with the paper's symmetries tells of its quarter.
#[derive(Debug, Serialize)]
pub(crate) struct Quarter {
    displacement_over_length: f64,
    displacement_m: f64,
    start_angle_rad: f64,
    end_angle_rad: f64,
    /// In order.
    arcs: Vec<Arc>,
}

impl From<&OptimalGait> for Quarter {
    fn from(gait: &OptimalGait) -> Self {
        Self {
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.clone(),
        }
    }
}

impl Quarter {
    /// X > 0.
    pub(crate) fn forwards(&self) -> bool {
        self.displacement_m > 0.0
    }

    /// X/L of a local optimum that other gaits outdo.
    pub(super) fn outdone_row(&self, rows: &mut Rows) {
        rows.row(
            "outdone",
            format!(
                "a local optimum with X/L = {:.6}",
                self.displacement_over_length
            ),
        );
    }

    /// X with its unit and over L, where the quarter starts and ends, and its arcs.
    pub(crate) fn rows(&self, rows: &mut Rows) {
        rows.row(
            "displacement X",
            format!(
                "{} per cycle   X/L = {:.10}",
                quantity::length(self.displacement_m),
                self.displacement_over_length
            ),
        )
        .row(
            "starts at",
            format!("φ₁ = φ₂ = {}", quantity::angle(self.start_angle_rad)),
        )
        .row(
            "quarter ends at",
            format!("φ₂ = −φ₁ = {}", quantity::angle(self.end_angle_rad)),
        );
        arc_rows(rows, &self.arcs);
    }
}

/// What every answer ends with.
#[derive(Debug, Serialize)]
pub(crate) struct Closing {
    /// Share of the cycle in which links cross.
    links_cross: f64,
    /// Under the servos' limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    timing: Option<TimingAnswer>,
    certificate: Certificate,
    /// From the parsed swimmer to the certified gait.
    seconds: f64,
    /// The gait file that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

impl Closing {
    pub(crate) fn new(
        gait: &OptimalGait,
        timing: Option<TimingAnswer>,
        seconds: f64,
        file: Option<PathBuf>,
    ) -> Self {
        Self {
            links_cross: gait.links_cross,
            timing,
            certificate: gait.certificate.clone(),
            seconds,
            gait: file,
        }
    }

    /// The timing, crossing links, the certificate's verdict and the file written.
    pub(crate) fn rows(&self, rows: &mut Rows) {
        if let Some(timing) = &self.timing {
            timing.rows(rows);
        }
        rows.row("links cross", quantity::crossing(self.links_cross));
        let checks = self.certificate.checks().len();
        let verdict = if self.certificate.pass() {
            "hold"
        } else {
            "do not all hold"
        };
        rows.row("certificate", format!("{checks} conditions {verdict}"));
        if let Some(path) = &self.gait {
            rows.row("written to", path.display().to_string());
        }
    }
}

/// What gaits for efficiency have beside the others, where no solver tells it.
#[derive(Debug, Serialize)]
pub(crate) struct Figures {
    residual: Option<f64>,
    power_variation: Option<f64>,
    /// What led to the start of the polish.
    method: &'static str,
}

impl Figures {
    /// With this condition of the certificate as the residual; none for a gait that is not for efficiency. For gaits that were
    /// optimised as Fourier series first.
    pub(crate) fn of(
        gait: &OptimalGait,
        residual: Condition,
        power_variation: impl FnOnce(&OptimalGait) -> Option<f64>,
    ) -> Option<Self> {
        (gait.objective == Objective::Efficiency).then(|| Self {
            residual: gait.certificate.value(residual),
            power_variation: power_variation(gait),
            method: Method::Fourier.word(),
        })
    }
}

/// Says where the gait is beyond the robot of the file, at the period that it runs in unless told otherwise.
pub(super) fn say_if_beyond(file: &SwimmerFile, gait: &OptimalGait) {
    if let Ok(curve) = AnyGait::from_file(&gait.gait_file(&file.name)) {
        crate::own_robot::say_if_beyond(file, &curve, PERIOD_S);
    }
}

/// Refuses a gait that was to keep its links from crossing and lies with a side link folded on the middle one: the bound has
/// no best gait then, only ones that come ever nearer to it.
///
/// # Errors
/// [`Failure::Tried`].
pub(super) fn unfolded(gait: &OptimalGait) -> Outcome {
    if !gait.bounds.no_overlap || gait.links_cross <= 0.0 {
        return Ok(());
    }
    Err(Failure::Tried(format!(
        "the best gait whose links do not cross does not exist: those that come near to it run ever closer to |φ| = 180°, where a \
         side link lies on the middle one ({}); bound the joints (--max-angle 160deg) or keep the links apart (--clearance 0.005)",
        quantity::crossing(gait.links_cross)
    )))
}

/// Arcs in order, each with its ends.
pub(crate) fn arc_rows(rows: &mut Rows, arcs: &[Arc]) {
    for arc in arcs {
        let shape =
            |[one, two]: [f64; 2]| format!("({}, {})", quantity::angle(one), quantity::angle(two));
        rows.row(
            format!("{} arc", arc.kind.word()),
            format!("{} to {}", shape(arc.from), shape(arc.to)),
        );
    }
}
