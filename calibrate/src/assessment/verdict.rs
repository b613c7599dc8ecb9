//! The verdict and its reasons.

use std::fmt;

use super::explanations::Explanation;
use super::goodness::Goodness;
use super::systematics::{CERTAIN_ODDS, Systematics};
use crate::evidence::{Evidence, Pair};
use crate::fit::parameter::Parameter;
use crate::fit::{CampaignFit, FitWarning, Intervals};
use crate::nuisance::scan::ALIKE;

/// What to do with an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing speaks against it.
    Trust,
    /// Use it with its reasons at hand.
    Caution,
    /// Mend what the reasons name first.
    DoNotUse,
}

impl Verdict {
    /// As it is told.
    pub fn word(self) -> &'static str {
        match self {
            Self::Trust => "trust",
            Self::Caution => "caution",
            Self::DoNotUse => "do not use",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// The answer that is recommended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Headline {
    /// By which estimate: `paper`, or `systematics` where that one and the likelihood's leave its intervals.
    pub by: &'static str,
    /// r_s and χ.
    pub estimate: Pair,
    /// Intervals with systematic errors where the runs suffice for them, else the paper's fit's.
    pub intervals: Intervals,
}

/// Widths by which the runs may contradict what is known: more is worth a caution, or too much.
const CAUTION_PULL: f64 = 2.5;
const HIGHEST_PULL: f64 = 3.0;
/// Standard errors of a run's length scale that are worth a caution.
const RUN_SCALE: f64 = 4.0;
/// Velocity of the fluid \[m/s\] that is worth a caution.
const DRIFT: f64 = 8e-5;
/// An interval that is wider than this share of its middle says little.
const WIDE: f64 = 0.3;
/// Fewer runs leave little to test.
const FEW_RUNS: usize = 3;

/// The paper's fit, unless it or the likelihood's estimate disagrees with what lets systematic errors move.
pub(super) fn headline(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
    systematics: Option<&Systematics>,
) -> Headline {
    let fit = &found.fit;
    let paper = Pair {
        sphere_radius: fit.sphere_radius,
        chi: fit.chi,
    };
    let Some(systematics) = systematics else {
        return Headline {
            by: "paper",
            estimate: paper,
            intervals: fit.intervals,
        };
    };
    let holds = |pair: &Pair| {
        let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
        within(systematics.intervals.sphere_radius, pair.sphere_radius)
            && within(systematics.intervals.chi, pair.chi)
    };
    let likelihood = evidence.map(|evidence| evidence.likelihood.estimate);
    let agree = holds(&paper) && likelihood.as_ref().is_none_or(holds);
    Headline {
        by: if agree { "paper" } else { "systematics" },
        estimate: if agree { paper } else { systematics.estimate },
        intervals: systematics.intervals,
    }
}

/// Whether both parameters' intervals have something in common.
fn overlap(a: &Intervals, b: &Intervals) -> bool {
    let common = |a: [f64; 2], b: [f64; 2]| a[0] <= b[1] && b[0] <= a[1];
    common(a.sphere_radius, b.sphere_radius) && common(a.chi, b.chi)
}

/// m as mm, rad as degrees, the rest as it is.
fn readable(unit: &str, value: f64) -> String {
    match unit {
        "m" => format!("{:.2} mm", 1e3 * value),
        "rad" => format!("{:.2}°", value.to_degrees()),
        "s" => format!("{:.0} ms", 1e3 * value),
        _ => format!("{value:.4}"),
    }
}

/// A file by its name.
fn short(file: &std::path::Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

pub(super) fn verdict(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
    goodness: &Goodness,
    systematics: Option<&Systematics>,
    explanations: &[Explanation],
    headline: &Headline,
) -> (Verdict, Vec<String>) {
    let mut reasons: Vec<(Verdict, String)> = Vec::new();
    let mut say = |verdict: Verdict, reason: String| reasons.push((verdict, reason));
    match systematics {
        None => say(
            Verdict::Caution,
            "these runs are too few to weigh systematic errors: the intervals hold random scatter only".to_owned(),
        ),
        Some(systematics) => of_systematics(found, systematics, &mut say),
    }
    rivals(explanations, &mut say);
    of_runs(found, goodness, &mut say);
    if systematics.is_some_and(|systematics| disagree(found, evidence, systematics)) {
        say(
            Verdict::Caution,
            format!(
                "the estimates disagree: the statistical intervals and those with systematic errors do not overlap; recommended is that {}",
                if headline.by == "paper" {
                    "of the paper"
                } else {
                    "with systematic errors"
                }
            ),
        );
    }
    of_widths(found, evidence, headline, &mut say);
    reasons.sort_by_key(|(verdict, _)| std::cmp::Reverse(*verdict));
    let verdict = reasons
        .first()
        .map_or(Verdict::Trust, |(verdict, _)| *verdict);
    (
        verdict,
        reasons.into_iter().map(|(_, reason)| reason).collect(),
    )
}

fn of_systematics(
    found: &CampaignFit,
    systematics: &Systematics,
    say: &mut impl FnMut(Verdict, String),
) {
    pulls(systematics, say);
    for unforeseen in &systematics.unforeseen {
        let certain = unforeseen.log_odds > CERTAIN_ODDS;
        let (verdict, asks) = if certain {
            (Verdict::DoNotUse, "the runs ask for")
        } else {
            (Verdict::Caution, "the runs may have")
        };
        let reason = format!(
            "{asks} a {} of {}, which no file names (log-likelihood +{:.0} over all that is known): {}",
            unforeseen.name,
            readable(unforeseen.unit, unforeseen.value),
            unforeseen.gain,
            unforeseen.remedy
        );
        say(verdict, reason);
    }
    for (run, quantity) in &systematics.outliers {
        let file = found
            .runs
            .get(*run)
            .map_or_else(String::new, |run| short(&run.file));
        say(
            Verdict::Caution,
            format!("{quantity} of {file} is unlike all else and was left out"),
        );
    }
}

/// Runs that were left out, drift, and lengths.
fn of_runs(found: &CampaignFit, goodness: &Goodness, say: &mut impl FnMut(Verdict, String)) {
    for excluded in found.excluded.iter().filter(|run| run.by_sign) {
        let file = short(&excluded.file);
        say(
            Verdict::Caution,
            format!("{file} was left out: {}", excluded.reason),
        );
    }
    let drifts: Vec<String> = found
        .runs
        .iter()
        .zip(&goodness.runs)
        .filter_map(|(run, of_run)| {
            let [along, across] = of_run.drift_m_per_s;
            let speed = along.hypot(across);
            (speed > DRIFT).then(|| format!("{} {:.2} mm/s", short(&run.file), 1e3 * speed))
        })
        .collect();
    if !drifts.is_empty() {
        say(
            Verdict::Caution,
            format!(
                "X and Y look as if the fluid drifted: {}",
                drifts.join(", ")
            ),
        );
    }
    for (run, of_run) in found.runs.iter().zip(&goodness.runs) {
        if let Some([scale, error]) = of_run.scale
            && (scale - 1.0).abs() > RUN_SCALE * error
        {
            say(
                Verdict::Caution,
                format!(
                    "lengths of {} are {scale:.3} ± {error:.3} of what the other runs foretell: a wall near by, or another scale",
                    short(&run.file)
                ),
            );
        }
    }
    if found.runs.len() < FEW_RUNS {
        say(
            Verdict::Caution,
            format!(
                "{} run(s) leave nothing to test the model by",
                found.runs.len()
            ),
        );
    }
}

/// Whether the statistical intervals have nothing in common with those with systematics.
fn disagree(found: &CampaignFit, evidence: Option<&Evidence>, systematics: &Systematics) -> bool {
    let statistical = [
        Some(&found.fit.intervals),
        evidence.map(|evidence| &evidence.likelihood.intervals),
    ];
    let mut others = statistical.into_iter().flatten();
    others.any(|other| !overlap(other, &systematics.intervals))
}

/// What is hardly known.
fn of_widths(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
    headline: &Headline,
    say: &mut impl FnMut(Verdict, String),
) {
    let Intervals {
        sphere_radius, chi, ..
    } = headline.intervals;
    for (what, [low, high]) in [("r_s", sphere_radius), ("chi", chi)] {
        let share = (high - low) / f64::midpoint(low, high);
        if share > WIDE {
            say(
                Verdict::Caution,
                format!("{what} is known to ± {:.0} % only", 50.0 * share),
            );
        }
    }
    for warning in &found.fit.warnings {
        if let FitWarning::Ridge { .. } = warning {
            say(Verdict::Caution, warning.to_string());
        }
    }
    let open = |evidence: &Evidence| evidence.profiles.iter().any(|p| p.open.contains(&true));
    if evidence.is_some_and(open) {
        say(
            Verdict::Caution,
            "a profile likelihood does not fall as far as it was followed: that parameter is hardly bounded".to_owned(),
        );
    }
}

/// What contradicts what is known.
fn pulls(systematics: &Systematics, say: &mut impl FnMut(Verdict, String)) {
    for nuisance in &systematics.nuisances {
        let pull = nuisance.pull.abs();
        if pull < CAUTION_PULL {
            continue;
        }
        let verdict = if pull > HIGHEST_PULL {
            Verdict::DoNotUse
        } else {
            Verdict::Caution
        };
        let [known, width] = nuisance.known;
        let [value, deviation] = nuisance.found;
        let told = |value: f64| readable(nuisance.unit, value);
        say(
            verdict,
            format!(
                "the runs ask for {}{} {} ± {}, {pull:.1} widths from {} ± {} as {}: look at it, state what is known under [known] in the \
                 campaign, or fit it by --fit-also",
                nuisance.name,
                // Walls that are as near to all runs make their lengths smaller, and nothing else.
                if nuisance.name == Parameter::Scale.name() {
                    " (or a wall as near to all runs)"
                } else {
                    ""
                },
                told(value),
                told(deviation),
                told(known),
                told(width),
                if nuisance.stated { "stated" } else { "usual" }
            ),
        );
    }
}

/// Growth of the log-likelihood from which on an explanation is one.
const EXPLAINS: f64 = 10.0;

/// Explanations that the runs do not tell apart.
fn rivals(explanations: &[Explanation], say: &mut impl FnMut(Verdict, String)) {
    let Some(best) = explanations.first().filter(|best| best.gain > EXPLAINS) else {
        return;
    };
    let alike = |other: &&Explanation| best.gain - other.gain < ALIKE;
    let rivals: Vec<String> = explanations
        .iter()
        .skip(1)
        .filter(alike)
        .filter(|other| !(best.name.starts_with("gain") && other.name.starts_with("gain")))
        .map(|other| format!("{} (+{:.1})", other.name, other.gain))
        .collect();
    if !rivals.is_empty() {
        say(
            Verdict::Caution,
            format!(
                "{} (log-likelihood +{:.1}) and {} explain the runs alike: these runs do not tell which is off",
                best.name,
                best.gain,
                rivals.join(", ")
            ),
        );
    }
}
