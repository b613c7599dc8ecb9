//! What is computed only when it is asked for: further parameters, and what to measure next.

use std::fmt;

use calibrate::nuisance::FittedParameter;
use calibrate::{Advice, CampaignFit, Further, FurtherFit, advise, fit_further};
use serde::Serialize;
use swimmer_files::{Campaign, SwimmerFile};

use crate::failure::Outcome;
use crate::progress::Stages;
use crate::quantity::{self, Table};

/// Questions beyond the fit.
#[derive(Debug, Clone, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: r_s, not `r_s`
pub(super) struct BeyondFit {
    /// Fit more than r_s and χ: gain (what the servos turn over what they are told; gains: each servo's), ct (c_t/μ), offsets (of
    /// both joints), deadband (of the servos), marker (where the reflectors' middle sits on the link), scale (of the cameras).
    /// Warns where the runs cannot tell them apart
    #[arg(long, value_name = "WHAT,…", value_delimiter = ',')]
    fit_also: Vec<Also>,
    /// Rank what to measure next by how much one run of it would narrow the intervals
    #[arg(long)]
    advise: bool,
}

/// What they take, seconds as measured on nine runs.
const FITTING: f64 = 1.6;
const ADVISING: f64 = 0.9;

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Also {
    Ct,
    Offsets,
    Deadband,
    Marker,
    Gain,
    Gains,
    Scale,
}

impl From<Also> for Further {
    fn from(also: Also) -> Self {
        match also {
            Also::Ct => Self::TangentialDrag,
            Also::Offsets => Self::JointOffsets,
            Also::Deadband => Self::DeadBand,
            Also::Marker => Self::MarkerOffset,
            Also::Gain => Self::Gain,
            Also::Gains => Self::Gains,
            Also::Scale => Self::Scale,
        }
    }
}

impl BeyondFit {
    /// The first flag that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        match (self.fit_also.is_empty(), self.advise) {
            (false, _) => Some("--fit-also"),
            (true, true) => Some("--advise"),
            (true, false) => None,
        }
    }

    /// What [`Self::answer`] takes, seconds as measured on nine runs.
    pub(super) fn weight(&self) -> f64 {
        let further = if self.fit_also.is_empty() {
            0.0
        } else {
            FITTING
        };
        further + if self.advise { ADVISING } else { 0.0 }
    }

    /// Computes what was asked, and the swimmer with all further parameters that its file can hold.
    pub(super) fn answer(
        &self,
        campaign: &Campaign,
        found: &CampaignFit,
        stages: &mut Stages,
    ) -> Outcome<(FurtherAnswers, Option<SwimmerFile>)> {
        let wanted: Vec<Further> = self.fit_also.iter().map(|also| (*also).into()).collect();
        let further = if wanted.is_empty() {
            None
        } else {
            stages.next("fitting more parameters", FITTING);
            Some(fit_further(found, &wanted)?)
        };
        let advice = if self.advise {
            stages.next("weighing what to measure next", ADVISING);
            Some(advise(campaign, found)?)
        } else {
            None
        };
        let answer = FurtherAnswers {
            further: further.as_ref().map(FurtherAnswer::new),
            advice: advice.as_ref().map(AdviceAnswer::new),
        };
        Ok((answer, further.map(|further| further.swimmer)))
    }
}

/// The answers.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct FurtherAnswers {
    #[serde(skip_serializing_if = "Option::is_none")]
    further: Option<FurtherAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<AdviceAnswer>,
}

#[derive(Debug, Clone, Serialize)]
struct FurtherAnswer {
    parameters: Vec<ParameterAnswer>,
    level: f64,
    correlations: Vec<Vec<f64>>,
    condition: f64,
    log_likelihood_gain: f64,
    warnings: Vec<String>,
}

#[derive(Debug, Clone, Serialize)]
struct ParameterAnswer {
    name: &'static str,
    /// m, rad, or nothing.
    unit: &'static str,
    before: f64,
    value: f64,
    interval: [f64; 2],
    bounds: [f64; 2],
}

#[derive(Debug, Clone, Serialize)]
struct AdviceAnswer {
    period_s: f64,
    candidates: Vec<CandidateAnswer>,
}

/// Widths with one run of it more, over the widths now.
#[derive(Debug, Clone, Serialize)]
struct CandidateAnswer {
    gait: String,
    sphere_radius_width: f64,
    chi_width: f64,
    both: f64,
}

impl FurtherAnswer {
    fn new(fit: &FurtherFit) -> Self {
        let parameter = |p: &FittedParameter| ParameterAnswer {
            name: p.name,
            unit: p.unit,
            before: p.before,
            value: p.value,
            interval: p.interval,
            bounds: p.bounds,
        };
        Self {
            parameters: fit.parameters.iter().map(parameter).collect(),
            level: fit.level,
            correlations: fit.correlations.clone(),
            condition: fit.condition,
            log_likelihood_gain: fit.log_likelihood_gain,
            warnings: fit.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl AdviceAnswer {
    fn new(advice: &Advice) -> Self {
        let candidates = advice.candidates.iter().map(|candidate| CandidateAnswer {
            gait: quantity::gait(&candidate.gait),
            sphere_radius_width: candidate.sphere_radius,
            chi_width: candidate.chi,
            both: candidate.both(),
        });
        Self {
            period_s: advice.period_s,
            candidates: candidates.collect(),
        }
    }
}

/// One answer as people read it, in the terminal and on the page.
pub(crate) struct Shown {
    pub(crate) title: &'static str,
    pub(crate) table: Table,
    pub(crate) notes: Vec<String>,
}

impl FurtherAnswers {
    pub(crate) fn shown(&self) -> Vec<Shown> {
        let further = self.further.as_ref().map(FurtherAnswer::shown);
        let advice = self.advice.as_ref().map(AdviceAnswer::shown);
        further.into_iter().chain(advice).collect()
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.table)?;
        let mut notes = self.notes.iter();
        notes.try_for_each(|note| write!(f, "\n  {note}"))
    }
}

/// A value as people read it: mm, degrees, or the number.
pub(super) fn readable(unit: &str, value: f64) -> String {
    match unit {
        "m" => quantity::length(value),
        "rad" => quantity::angle(value),
        "s" => format!("{:.0} ms", 1e3 * value),
        _ => format!("{value:.4}"),
    }
}

impl FurtherAnswer {
    fn shown(&self) -> Shown {
        let mut table = Table::new(["by likelihood", "before", "fitted", "from", "to"]);
        for p in &self.parameters {
            let [from, to] = p.interval.map(|end| readable(p.unit, end));
            let (before, value) = (readable(p.unit, p.before), readable(p.unit, p.value));
            table.line([p.name.to_owned(), before, value, from, to]);
        }
        let mut notes = vec![format!(
            "intervals of {:.0} %; log-likelihood {:+.1} over r_s and chi alone",
            self.level * 100.0,
            self.log_likelihood_gain
        )];
        notes.extend(
            self.warnings
                .iter()
                .map(|warning| format!("note: {warning}")),
        );
        Shown {
            title: "What else may be off",
            table,
            notes,
        }
    }
}

/// Lines of advice that people read; JSON has all.
const SHOWN: usize = 8;

impl AdviceAnswer {
    fn shown(&self) -> Shown {
        let mut table = Table::new(["measure next", "interval of r_s", "of χ", "both"]);
        let percent = |width: f64| format!("{:+.1} %", 100.0 * (width - 1.0));
        for candidate in self.candidates.iter().take(SHOWN) {
            table.line([
                candidate.gait.clone(),
                percent(candidate.sphere_radius_width),
                percent(candidate.chi_width),
                percent(candidate.both),
            ]);
        }
        let notes = vec![format!(
            "one run more with a cycle of {} s, and as many cycles and errors as the others",
            self.period_s
        )];
        Shown {
            title: "What to measure next",
            table,
            notes,
        }
    }
}
