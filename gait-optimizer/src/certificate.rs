//! Certificate of a gait: necessary conditions of an optimum, each with its value and tolerance.

mod closed_curve;
mod condition;

use serde::{Serialize, Serializer};

pub use condition::Condition;

pub(crate) use closed_curve::{
    crossings, double_area, simple_and_turning_once, to_side, turning_number,
};

/// Result of one condition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// Condition.
    #[serde(rename = "name")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub condition: Condition,
    /// Computed value; null if it cannot be computed.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub value: f64,
    /// Limit of the value: an upper limit, or a lower limit if the name of the condition ends in `_least`.
    pub tolerance: f64,
    /// `true` if the condition holds.
    pub pass: bool,
    /// Uncertainty of a failed condition's value due to the samples; 0 if it holds or a solver computed it.
    #[serde(skip)]
    pub uncertainty: f64,
    #[serde(skip)]
    pub(crate) depends_on: Dependence,
}

/// Data on which a condition depends, which determines the uncertainty due to the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dependence {
    /// The curve through the samples: both their spacing and their rounding matter.
    Curve,
    /// The individual samples: only rounding matters.
    Samples,
    /// The spacing of the samples: it is no evidence against the gait.
    Spacing,
}

/// Verdict of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every condition holds.
    Pass,
    /// Some condition is violated by more than its uncertainty.
    Fail,
    /// Some conditions are violated, which coarse or rounded samples may explain.
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
    /// Sets the data on which the condition depends.
    pub(crate) fn depends_on(self, depends_on: Dependence) -> Self {
        Self { depends_on, ..self }
    }

    /// Returns `true` if the condition is violated by more than its uncertainty.
    fn fails_for_certain(&self) -> bool {
        !self.pass && {
            let by = (self.value - self.tolerance).abs();
            by.is_nan() || by > self.uncertainty
        }
    }
}

/// All conditions that were evaluated for a gait.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    checks: Vec<Check>,
}

/// JSON form of a certificate.
#[derive(Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Certificate")
)]
struct CertificateDocument<'a> {
    /// Every condition holds.
    pass: bool,
    /// Verdict.
    verdict: Verdict,
    /// Conditions in order.
    checks: &'a [Check],
}

impl Serialize for Certificate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let document = CertificateDocument {
            pass: self.pass(),
            verdict: self.verdict(),
            checks: &self.checks,
        };
        document.serialize(serializer)
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Certificate {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        CertificateDocument::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        CertificateDocument::json_schema(generator)
    }
}

impl Certificate {
    pub(crate) fn new(checks: Vec<Check>) -> Self {
        Self { checks }
    }

    /// Adds conditions.
    pub(crate) fn with(mut self, checks: Vec<Check>) -> Self {
        self.checks.extend(checks);
        self
    }

    /// Conditions in order.
    pub fn checks(&self) -> &[Check] {
        &self.checks
    }

    /// Value of a condition. Returns `None` if it was not evaluated.
    pub fn value(&self, condition: Condition) -> Option<f64> {
        let mut checks = self.checks.iter();
        checks.find_map(|check| (check.condition == condition).then_some(check.value))
    }

    /// Returns `true` if all conditions hold.
    pub fn pass(&self) -> bool {
        self.checks.iter().all(|check| check.pass)
    }

    /// Returns `true` if all conditions hold among gaits with the paper's symmetries; among all closed curves the gait may be a saddle.
    pub(crate) fn holds_among_symmetric(&self) -> bool {
        self.holds_but(&[Condition::NoAscentWithoutSymmetry])
    }

    /// Returns `true` if all conditions hold except for these.
    pub(crate) fn holds_but(&self, excepted: &[Condition]) -> bool {
        let mut checks = self.checks.iter();
        checks.all(|check| check.pass || excepted.contains(&check.condition))
    }

    /// Verdict: pass if all conditions hold; undecided if the samples may explain every violation; fail otherwise.
    pub fn verdict(&self) -> Verdict {
        self.verdict_but(&[])
    }

    /// Verdict without these conditions.
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

    /// Returns `true` if the spacing of the samples is too coarse for the conditions.
    pub(crate) fn is_too_coarse(&self) -> bool {
        let mut checks = self.checks.iter();
        checks.any(|check| check.depends_on == Dependence::Spacing && !check.pass)
    }

    /// Sets the uncertainty of each violated condition.
    pub(crate) fn with_uncertainty(mut self, of: impl Fn(&Check) -> f64) -> Self {
        for check in self.checks.iter_mut().filter(|check| !check.pass) {
            check.uncertainty = check.uncertainty.max(of(check));
        }
        self
    }

    /// Violated conditions with their values, for an error message.
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

/// Largest difference between two integrations of a gait, over L.
pub(crate) const SWUM_AGAIN: f64 = 1e-8;
/// Largest difference over the displacement itself, since a gait that moves only by rounding proves nothing.
pub(crate) const SHARE: f64 = 1e-3;

/// Largest difference between two integrations of a gait with this displacement, over L.
pub(crate) fn again_within(over_length: f64) -> f64 {
    SWUM_AGAIN.min(SHARE * over_length.abs())
}
