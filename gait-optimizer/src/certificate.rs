//! The proof that a gait carries: necessary conditions of an optimum, each with its number and tolerance.

mod closed_curve;

use serde::ser::{Serialize, SerializeStruct, Serializer};
use swimmer_model::Stroke;

use crate::cycle::{Cycle, QuarterTrace};
use crate::region::Region;
pub(crate) use closed_curve::{crossings, simple_and_turning_once, turning_number};

/// One condition.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Check {
    /// Which condition.
    pub name: &'static str,
    /// What was found.
    pub value: f64,
    /// What it is held against: from above, or from below for the checks whose name ends in `_least`.
    pub tolerance: f64,
    /// Whether it holds.
    pub pass: bool,
    /// How much of a failed condition's value the samples leave open; 0 where it holds or was found by a solver.
    #[serde(skip)]
    pub uncertainty: f64,
    #[serde(skip)]
    pub(crate) seen_by: SeenBy,
}

/// What a condition is seen by, which tells what samples may leave open in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SeenBy {
    /// The curve through the samples: their spacing matters, and their rounding.
    Curve,
    /// Each sample, however far it is from the next: only rounding matters.
    Samples,
    /// How close the samples are: it says nothing against the gait.
    Spacing,
}

/// What a certificate says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Every condition holds.
    Pass,
    /// Some condition does not hold, whatever the samples leave open.
    Fail,
    /// Some conditions do not hold, and these samples, too few or rounded, may be the reason.
    Undecided,
}

impl Verdict {
    /// `pass`, `fail` or `undecided`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Undecided => "undecided",
        }
    }
}

impl Check {
    /// The value may be at most the tolerance. NaN fails.
    pub(crate) fn at_most(name: &'static str, value: f64, tolerance: f64) -> Self {
        Self {
            name,
            value,
            tolerance,
            pass: value <= tolerance,
            uncertainty: 0.0,
            seen_by: SeenBy::Curve,
        }
    }

    /// The same, seen by something else than the curve.
    pub(crate) fn seen_by(self, seen_by: SeenBy) -> Self {
        Self { seen_by, ..self }
    }

    /// Whether it fails whatever the samples leave open.
    fn fails_for_certain(&self) -> bool {
        !self.pass && {
            let by = (self.value - self.tolerance).abs();
            by.is_nan() || by > self.uncertainty
        }
    }

    /// The value must be at least the tolerance. NaN fails.
    pub(crate) fn at_least(name: &'static str, value: f64, tolerance: f64) -> Self {
        Self {
            name,
            value,
            tolerance,
            pass: value >= tolerance,
            uncertainty: 0.0,
            seen_by: SeenBy::Curve,
        }
    }
}

/// All conditions that a gait was held against.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    checks: Vec<Check>,
}

/// As every answer tells it: whether all holds, the verdict's word, the conditions.
impl Serialize for Certificate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut told = serializer.serialize_struct("Certificate", 3)?;
        told.serialize_field("pass", &self.pass())?;
        told.serialize_field("verdict", self.verdict().word())?;
        told.serialize_field("checks", &self.checks)?;
        told.end()
    }
}

impl Certificate {
    pub(crate) fn new(checks: Vec<Check>) -> Self {
        Self { checks }
    }

    /// The same with further conditions.
    pub(crate) fn with(mut self, checks: Vec<Check>) -> Self {
        self.checks.extend(checks);
        self
    }

    /// The conditions, one by one.
    pub fn checks(&self) -> &[Check] {
        &self.checks
    }

    /// The number of the condition of this name; `None` where there is none.
    pub fn value(&self, name: &str) -> Option<f64> {
        let mut named = self.checks.iter().filter(|check| check.name == name);
        named.next().map(|check| check.value)
    }

    /// Whether all hold.
    pub fn pass(&self) -> bool {
        self.checks.iter().all(|check| check.pass)
    }

    /// What it says: where all hold, pass; else fail, unless the samples may be the reason of all that fails.
    pub fn verdict(&self) -> Verdict {
        if self.pass() {
            Verdict::Pass
        } else if self.checks.iter().any(Check::fails_for_certain) {
            Verdict::Fail
        } else {
            Verdict::Undecided
        }
    }

    /// Whether the samples are further apart than the conditions ask for.
    pub(crate) fn is_too_coarse(&self) -> bool {
        let mut checks = self.checks.iter();
        checks.any(|check| check.seen_by == SeenBy::Spacing && !check.pass)
    }

    /// The same with what the samples leave open in each condition that fails.
    pub(crate) fn with_uncertainty(mut self, of: impl Fn(&Check) -> f64) -> Self {
        for check in self.checks.iter_mut().filter(|check| !check.pass) {
            check.uncertainty = check.uncertainty.max(of(check));
        }
        self
    }

    /// The failed conditions with their values, for an error message.
    pub fn failures(&self) -> String {
        let failed = self.checks.iter().filter(|check| !check.pass);
        let words: Vec<_> = failed
            .map(|check| {
                format!(
                    "{} = {:.3e} (against {:.1e})",
                    check.name, check.value, check.tolerance
                )
            })
            .collect();
        words.join(", ")
    }

    /// The conditions of paper section IV for a quarter gait, and those of the full cycle. Lengths are over L.
    pub(crate) fn of_displacement(
        region: &Region,
        trace: &QuarterTrace,
        cycle: &Cycle,
        displacement_over_length: f64,
        stroke: &Stroke<f64>,
    ) -> Self {
        let evidence = &trace.evidence;
        let mut checks = vec![
            Check::at_most("off_symmetry_lines_rad", evidence.off_symmetry_lines, 1e-9),
            Check::at_most("retraced_rad", evidence.retraced, 1e-8),
            Check::at_most("final_lambda4", evidence.final_lambda4, 1e-9),
            Check::at_most("start_transversality", evidence.start_transversality, 1e-9),
            Check::at_most("end_transversality", evidence.end_transversality, 1e-9),
            Check::at_most("h_u", evidence.h_u, 1e-9),
            Check::at_most("off_singular_condition_rad", evidence.off_zero, 1e-8),
        ];
        checks.extend(evidence.legendre_clebsch.map(|least| {
            Check::at_least("legendre_clebsch_least", least / evidence.steepest, 1e-4)
        }));
        checks.extend(
            evidence
                .multiplier
                .map(|least| Check::at_least("bound_multiplier_least", least, -1e-9)),
        );
        checks.extend(
            evidence
                .second_variation
                .map(|form| Check::at_least("conjugate_point_least", form.least, 1e-6)),
        );
        if region.bounds().next().is_some() {
            checks.push(Check::at_most(
                "bound_overstepped_rad",
                evidence.overstepped,
                1e-10,
            ));
        }
        // A gait that may run along the diagonals meets its own images there: then the quarter must be simple.
        let curve = if region.has_diagonals() {
            &trace.samples.phi
        } else {
            &cycle.phi
        };
        checks.extend(simple_and_turning_once(&cycle.phi, curve));
        checks.extend(swum_again(stroke, displacement_over_length));
        Self { checks }
    }
}

/// What two ways of swimming a gait may differ by, over L.
pub(crate) const SWUM_AGAIN: f64 = 1e-8;
/// The same over the displacement itself: a gait that moves by rounding only proves nothing.
pub(crate) const SHARE: f64 = 1e-3;

/// What two ways of swimming a gait that moves so far over L may differ by, over L.
pub(crate) fn again_within(over_length: f64) -> f64 {
    SWUM_AGAIN.min(SHARE * over_length)
}

/// The samples swum by the model's own cycle integration, which shares no code with the arcs.
pub(crate) fn swum_again(stroke: &Stroke<f64>, displacement_over_length: f64) -> [Check; 3] {
    let (x, y) = (stroke.displacement.x, stroke.displacement.y);
    let rotation = stroke.rotation;
    let tolerance = again_within(displacement_over_length.abs());
    [
        Check::at_most(
            "displacement_swum_again",
            (x - displacement_over_length).abs(),
            tolerance,
        ),
        Check::at_most("net_lateral", y.abs(), 1e-8),
        Check::at_most("net_rotation_rad", rotation.abs(), 1e-8),
    ]
}
