//! The verdict and its reasons.

use std::fmt;

use super::agreement::Agreement;
use super::explanations::Explanation;
use super::goodness::Goodness;
use super::systematics::{CERTAIN_ODDS, Systematics};
use crate::evidence::{Evidence, Pair};
use crate::fit::parameter::Parameter;
use crate::fit::{CampaignFit, FitWarning, Intervals, short_name as short};
use crate::nuisance::scan::ALIKE;

/// Recommendation for the use of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing speaks against it.
    Trust,
    /// Usable, with regard to the reasons.
    Caution,
    /// First correct the errors that the reasons name.
    DoNotUse,
}

impl Verdict {
    /// The word that is printed.
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

/// Recommended estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Headline {
    /// Source: `paper`, or `systematics` if the paper's estimate or the likelihood's lies outside its intervals.
    pub by: &'static str,
    /// r_s and χ.
    pub estimate: Pair,
    /// Intervals with systematic errors; those of the paper's fit if there are too few runs for them.
    pub intervals: Intervals,
}

/// Widths by which the runs may contradict what is known: more is worth a caution, or too much.
const CAUTION_PULL: f64 = 2.5;
const HIGHEST_PULL: f64 = 3.0;
/// Standard errors of a run's length scale that are worth a caution.
const RUN_SCALE: f64 = 4.0;
/// Misfit of the largest value, as a share, that is worth a caution, and that makes an answer useless. Walls 20 cm away that no file
/// states leave .0035 to .0041 where nothing else warns (`campaigns::walls`); there the estimates are up to two half widths off.
const MISFITS: f64 = 0.003;
const HOPELESS: f64 = 0.03;
/// Half widths between an explanation's estimate and the recommended one that are worth a caution.
const FAR_OFF: f64 = 1.5;
/// Chance of a Y or a net turn common to all runs that is worth a caution.
const COMMON: f64 = 1e-3;
/// Velocity of the fluid \[m/s\] that is worth a caution.
const DRIFT: f64 = 8e-5;
/// An interval that is wider than this share of its middle says little.
const WIDE: f64 = 0.3;
/// Fewer runs leave little to test.
const FEW_RUNS: usize = 3;

/// Standard deviations of the difference between two estimates from which on they disagree, and from which on that with systematic
/// errors contradicts itself: the simpler one is then recommended.
const DISAGREE: f64 = 3.5;
const CONTRADICT: f64 = 30.0;

/// The paper's fit, unless it or the likelihood's estimate disagrees with what lets systematic errors move.
pub(super) fn headline(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
    systematics: Option<&Systematics>,
    agreement: Option<Agreement>,
) -> Headline {
    let fit = &found.fit;
    let paper = Pair {
        sphere_radius: fit.sphere_radius,
        chi: fit.chi,
    };
    let contradicts = agreement.is_some_and(|agreement| agreement.deviations > CONTRADICT);
    let Some(systematics) = systematics.filter(|_| !contradicts) else {
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

/// m as mm, rad as degrees, the rest as it is.
fn readable(unit: &str, value: f64) -> String {
    match unit {
        "m" => format!("{:.2} mm", 1e3 * value),
        "rad" => format!("{:.2}°", value.to_degrees()),
        "s" => format!("{:.0} ms", 1e3 * value),
        _ => format!("{value:.4}"),
    }
}

pub(super) fn verdict(
    found: &CampaignFit,
    evidence: Option<&Evidence>,
    goodness: &Goodness,
    systematics: Option<&Systematics>,
    explanations: &[Explanation],
    headline: &Headline,
    agreement: Option<Agreement>,
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
    of_agreement(agreement, headline, &mut say);
    of_widths(found, evidence, headline, &mut say);
    of_explanations(explanations, headline, &mut say);
    let verdict = reasons.iter().map(|(verdict, _)| *verdict).max();
    let verdict = verdict.unwrap_or(Verdict::Trust);
    name_the_best(explanations, verdict, &mut reasons);
    reasons.sort_by_key(|(verdict, _)| std::cmp::Reverse(*verdict));
    let misfit = goodness.misfit.filter(|misfit| misfit.share > MISFITS);
    let verdict = misfit.map_or(verdict, |misfit| {
        let of_misfit = if misfit.share > HOPELESS {
            Verdict::DoNotUse
        } else {
            Verdict::Caution
        };
        let tracked = found.runs.iter().any(|run| !run.is_reported());
        let reason = format!(
            "the model does not fit: {} of the runs misses it by {:.1} % of the largest, {:.0} times its scatter, although every known \
             error may vary{}",
            misfit.quantity,
            100.0 * misfit.share,
            misfit.ratio,
            if tracked && found.known.tank.is_none() {
                "; walls within 30 cm of the runs do this: if there are any, state the tank under [known]"
            } else {
                ""
            }
        );
        reasons.insert(0, (of_misfit, reason));
        verdict.max(of_misfit)
    });
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
                    "lengths of {} are {scale:.3} ± {error:.3} of those predicted from the other runs: a wall near by, or another scale",
                    short(&run.file)
                ),
            );
        }
    }
    for common in goodness
        .common
        .iter()
        .filter(|common| common.chance < COMMON)
    {
        let signed = |value: f64| {
            if common.quantity == "Y/X" {
                format!("{value:+.4}")
            } else {
                format!("{:+.3}°", value.to_degrees())
            }
        };
        say(
            Verdict::Caution,
            format!(
                "all runs have {} {} ± {} beyond the model: something is not symmetric that no file names (servos unlike each other, \
                 an axis of the cameras that is not square)",
                common.quantity,
                signed(common.mean),
                signed(common.error).trim_start_matches('+'),
            ),
        );
    }
    let repeated: usize = goodness
        .repeats
        .iter()
        .map(|same| same.runs.len() - 1)
        .sum();
    let gaits = found.runs.len() - repeated;
    if gaits < FEW_RUNS {
        let reason = if repeated > 0 {
            format!("{gaits} gait(s), repeated, leave nothing to test the model by")
        } else {
            format!("{gaits} run(s) leave nothing to test the model by")
        };
        say(Verdict::Caution, reason);
    }
}

/// Estimates that differ by more than the errors of both, systematic ones included.
fn of_agreement(
    agreement: Option<Agreement>,
    headline: &Headline,
    say: &mut impl FnMut(Verdict, String),
) {
    let Some(Agreement { deviations }) = agreement.filter(|a| a.deviations > DISAGREE) else {
        return;
    };
    if deviations > CONTRADICT {
        say(
            Verdict::DoNotUse,
            format!(
                "the estimate with systematic errors contradicts the others by {deviations:.0} times what all their errors allow: it \
                 is not recommended, and the paper's is not confirmed"
            ),
        );
        return;
    }
    say(
        Verdict::Caution,
        format!(
            "the estimates disagree: they differ by {deviations:.1} times what scatter and systematic errors allow; recommended is that {}",
            if headline.by == "paper" {
                "of the paper"
            } else {
                "with systematic errors"
            }
        ),
    );
}

/// Reasons by poorly determined parameters.
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
        match warning {
            FitWarning::Ridge { .. } | FitWarning::NoErrors => {
                say(Verdict::Caution, warning.to_string());
            }
            FitWarning::SameRecording { .. } => say(Verdict::DoNotUse, warning.to_string()),
            _ => {}
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

/// Reasons by contradictions of the priors.
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
        let signed = |value: f64| readable(nuisance.unit, value);
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
                signed(value),
                signed(deviation),
                signed(known),
                signed(width),
                if nuisance.stated { "stated" } else { "usual" }
            ),
        );
    }
}

/// Growth of the log-likelihood from which on an explanation is one.
const EXPLAINS: f64 = 10.0;

/// An explanation whose r_s and χ are not those that are recommended.
fn of_explanations(
    explanations: &[Explanation],
    headline: &Headline,
    say: &mut impl FnMut(Verdict, String),
) {
    let Some(best) = explanations.first().filter(|best| best.worth() > EXPLAINS) else {
        return;
    };
    let beyond = |[low, high]: [f64; 2], value: f64| {
        let half = (high - low) / 2.0;
        (value - f64::midpoint(low, high)).abs() / half
    };
    let Intervals {
        sphere_radius, chi, ..
    } = headline.intervals;
    let off =
        beyond(sphere_radius, best.estimate.sphere_radius).max(beyond(chi, best.estimate.chi));
    if off > FAR_OFF {
        say(
            Verdict::Caution,
            format!(
                "{}, which explains the runs best by itself, would have r_s {:.2} mm and chi {:.3}: {off:.1} half widths from the \
                 middle of the recommended intervals",
                described(best),
                1e3 * best.estimate.sphere_radius,
                best.estimate.chi
            ),
        );
    }
}

/// Returns `true` if one explanation is the other with separate servos: `gain` and `gain of each servo`.
fn are_kin(a: &Explanation, b: &Explanation) -> bool {
    a.name.starts_with(b.name) || b.name.starts_with(a.name)
}

/// An explanation with its values.
fn described(explanation: &Explanation) -> String {
    let values: Vec<String> = explanation
        .parameters
        .iter()
        .map(|parameter| readable(parameter.unit, parameter.value))
        .collect();
    format!(
        "{} ({}; log-likelihood +{:.0})",
        explanation.name,
        values.join(", "),
        explanation.gain
    )
}

/// Names the explanation that is likeliest by itself, and the next one, unless a reason does already.
fn name_the_best(
    explanations: &[Explanation],
    verdict: Verdict,
    reasons: &mut Vec<(Verdict, String)>,
) {
    let mut likely = explanations.iter().filter(|one| one.worth() > EXPLAINS);
    let Some(best) = likely.next().filter(|_| verdict > Verdict::Trust) else {
        return;
    };
    let next = likely.find(|other| !are_kin(best, other)).map_or_else(
        || "nothing else that was tried does".to_owned(),
        |next| format!("next comes {}", described(next)),
    );
    let reason = format!("the runs are explained best by {}; {next}", described(best));
    reasons.insert(0, (verdict, reason));
}

/// Explanations that the runs do not distinguish.
fn rivals(explanations: &[Explanation], say: &mut impl FnMut(Verdict, String)) {
    let Some(best) = explanations.first().filter(|best| best.gain > EXPLAINS) else {
        return;
    };
    let alike = |other: &&Explanation| best.gain - other.gain < ALIKE;
    let rivals: Vec<String> = explanations
        .iter()
        .skip(1)
        .filter(alike)
        .filter(|other| !are_kin(best, other))
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
