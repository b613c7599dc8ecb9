//! Optional computations: nuisance parameters, and proposals for further runs.

use std::fmt;

use calibrate::{Advice, NuisanceFit, NuisanceParameter};
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use operations::calibrate::Output;

use crate::quantity::{self, Table};

/// Options for computations beyond the fit.
#[derive(Debug, Clone, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: r_s, not `r_s`
pub(super) struct BeyondFit {
    /// Fit more than r_s and χ: gain (actual over commanded angle of the servos; gains: each servo's), ct (c_t/μ), offsets (of
    /// both joints), deadband (of the servos), marker (position of the reflectors' middle on the link), scale (of the cameras),
    /// lengths (of the links), float (its rotational drag over a sphere's), tilt (of the cameras), distortion (of the lens), walls
    /// (of the tank, if the campaign states it). Warns if the runs cannot distinguish them
    #[arg(long, value_name = "WHAT,…", value_delimiter = ',', value_parser = PossibleValuesParser::new(NuisanceParameter::ALL.map(NuisanceParameter::word)).try_map(|word| further(&word)))]
    pub(super) fit_also: Vec<NuisanceParameter>,
    /// Rank what to measure next by how much one run of it would narrow the intervals
    #[arg(long)]
    pub(super) advise: bool,
}

/// Usual durations, seconds, as measured on nine runs.
pub(super) const FITTING: f64 = 1.6;
pub(super) const ADVISING: f64 = 0.9;

fn further(word: &str) -> Result<NuisanceParameter, String> {
    NuisanceParameter::of_word(word).ok_or_else(|| format!("there is no `{word}`"))
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

    /// Usual duration, seconds, as measured on nine runs.
    pub(super) fn weight(&self) -> f64 {
        let further = if self.fit_also.is_empty() {
            0.0
        } else {
            FITTING
        };
        further + if self.advise { ADVISING } else { 0.0 }
    }
}

/// One result as a table with notes, for the terminal and the report.
pub(crate) struct ResultTable {
    pub(crate) title: &'static str,
    pub(crate) table: Table,
    pub(crate) notes: Vec<String>,
}

/// Tables of the optional computations.
pub(crate) fn tables(output: &Output) -> impl Iterator<Item = ResultTable> {
    let further = output.further.as_ref().map(of_fit);
    let advice = output.advice.as_ref().map(of_advice);
    further.into_iter().chain(advice)
}

impl fmt::Display for ResultTable {
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

fn of_fit(fit: &NuisanceFit) -> ResultTable {
    let mut table = Table::new(["by likelihood", "before", "fitted", "from", "to"]);
    for p in &fit.parameters {
        let [from, to] = p.interval.map(|end| readable(p.unit, end));
        let (before, value) = (readable(p.unit, p.before), readable(p.unit, p.value));
        table.line([p.name.to_owned(), before, value, from, to]);
    }
    let mut notes = vec![format!(
        "intervals of {:.0} %; log-likelihood {:+.1} over r_s and chi alone",
        fit.level * 100.0,
        fit.log_likelihood_gain
    )];
    notes.extend(
        fit.warnings
            .iter()
            .map(|warning| format!("note: {warning}")),
    );
    ResultTable {
        title: "What else may be off",
        table,
        notes,
    }
}

/// Lines of advice that people read; JSON has all.
const SHOWN: usize = 8;

fn of_advice(advice: &Advice) -> ResultTable {
    let mut table = Table::new(["measure next", "interval of r_s", "of χ", "both"]);
    let percent = |width: f64| format!("{:+.1} %", 100.0 * (width - 1.0));
    for candidate in advice.candidates.iter().take(SHOWN) {
        table.line([
            candidate.gait.readable(),
            percent(candidate.sphere_radius),
            percent(candidate.chi),
            percent(candidate.both),
        ]);
    }
    let notes = vec![format!(
        "one run more with a cycle of {} s, and as many cycles and errors as the others",
        advice.period_s
    )];
    ResultTable {
        title: "What to measure next",
        table,
        notes,
    }
}
