//! The proof that a gait carries: necessary conditions of an optimum, each with its number and tolerance.

mod closed_curve;
mod condition;

use serde::ser::{Serialize, SerializeStruct, Serializer};

pub use condition::Condition;

pub(crate) use closed_curve::{
    crossings, double_area, simple_and_turning_once, to_side, turning_number,
};

/// One condition, asked.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Check {
    /// Which condition.
    #[serde(rename = "name")]
    pub condition: Condition,
    /// What was found.
    pub value: f64,
    /// What it is held against: from above, or from below for the conditions whose name ends in `_least`.
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
    /// The same number, seen by something else than the curve.
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

    /// The number of a condition; `None` where it was not asked.
    pub fn value(&self, condition: Condition) -> Option<f64> {
        let mut checks = self.checks.iter();
        checks.find_map(|check| (check.condition == condition).then_some(check.value))
    }

    /// Whether all hold.
    pub fn pass(&self) -> bool {
        self.checks.iter().all(|check| check.pass)
    }

    /// Whether all holds among gaits with the paper's symmetries; among all closed curves it may be a saddle.
    pub(crate) fn holds_among_symmetric(&self) -> bool {
        self.holds_but(&[Condition::NoAscentWithoutSymmetry])
    }

    /// Whether all hold, these excepted.
    pub(crate) fn holds_but(&self, excepted: &[Condition]) -> bool {
        let mut checks = self.checks.iter();
        checks.all(|check| check.pass || excepted.contains(&check.condition))
    }

    /// What it says: where all hold, pass; else fail, unless the samples may be the reason of all that fails.
    pub fn verdict(&self) -> Verdict {
        self.verdict_but(&[])
    }

    /// The same, these excepted.
    pub(crate) fn verdict_but(&self, excepted: &[Condition]) -> Verdict {
        let mut asked = self
            .checks
            .iter()
            .filter(|check| !excepted.contains(&check.condition));
        if self.holds_but(excepted) {
            Verdict::Pass
        } else if asked.any(Check::fails_for_certain) {
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
                    check.condition.key(),
                    check.value,
                    check.tolerance
                )
            })
            .collect();
        words.join(", ")
    }
}

/// What two ways of swimming a gait may differ by, over L.
pub(crate) const SWUM_AGAIN: f64 = 1e-8;
/// The same over the displacement itself: a gait that moves by rounding only proves nothing.
pub(crate) const SHARE: f64 = 1e-3;

/// What two ways of swimming a gait that moves so far over L may differ by, over L.
pub(crate) fn again_within(over_length: f64) -> f64 {
    SWUM_AGAIN.min(SHARE * over_length.abs())
}
