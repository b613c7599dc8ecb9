//! One experiment from its tracks to its drag: every run to cycles, all runs to one fit.

use swimmer_files::Campaign;
use swimmer_model::Swimmer;

use crate::cycles::{Cycles, Projection};
use crate::data::CampaignData;
use crate::error::{CalibrateError, FitError};
use crate::fit::errors::RunErrors;
use crate::fit::run_values::RunValues;
use crate::fit::{self, CampaignFit, ExcludedRun, FitOptions, FitWarning};
use crate::nuisance::scan;
use crate::prediction::{Played, first_of_repeats};
use crate::run::{EitherRun, Opposed, ReportedRun, Run, other_direction, same_recordings};

/// Rounds of fit and phase: the phase of a gait without the paper's symmetries hangs on the drag, a little.
const ROUNDS: usize = 4;
/// Phases that differ by less are the same, as a fraction of the period.
const SAME_PHASE: f64 = 1e-5;

/// All runs of a campaign and the fit of r_s and χ. The campaign's swimmer gives lengths, servos, the c_t form and a start. Runs that
/// the campaign excludes are not in `data`; those that swim against the model are left out, as long as the others are no fewer.
///
/// # Errors
/// [`CalibrateError`]: the first run that fails, or a fit that does.
pub fn calibrate_campaign(
    campaign: &Campaign,
    data: &CampaignData,
    options: FitOptions,
) -> Result<CampaignFit, CalibrateError> {
    let projection = Projection::new();
    let mut runs = begun(campaign, data)?;
    let mut swimmer = campaign.swimmer.clone();
    let mut starts = starts(&runs, &swimmer.swimmer, &projection)?;
    let mut round = 0;
    loop {
        round += 1;
        let mut cycles = Vec::with_capacity(runs.len());
        for (run, start_s) in runs.iter_mut().zip(&starts) {
            cycles.push(run.settled(*start_s, &swimmer.swimmer, &projection)?);
        }
        let before = opposed(&runs, &cycles, &swimmer.swimmer, &projection)?;
        check_signs(&runs, &before)?;
        let counts = |run: &usize| before[*run].is_none();
        let counting: Vec<usize> = (0..runs.len()).filter(counts).collect();
        let played: Vec<Played> = counting.iter().map(|run| runs[*run].played()).collect();
        let errors: Vec<RunErrors> = runs
            .iter()
            .zip(&cycles)
            .map(|(run, cycles)| run.errors(cycles, &swimmer.swimmer, &projection))
            .collect::<Result<_, _>>()?;
        let measured = counting.iter().map(|run| (&cycles[*run], errors[*run]));
        let values = RunValues::of(measured, &first_of_repeats(&played))?;
        let fit = fit::fit(&swimmer, played, &values, options.level)?;
        swimmer.swimmer = Swimmer {
            sphere_radius: fit.sphere_radius,
            chi: fit.chi,
            ..swimmer.swimmer
        };
        let next = self::starts(&runs, &swimmer.swimmer, &projection)?;
        let moved = |(run, (a, b)): (&EitherRun<'_>, (&f64, &f64))| {
            let cycles = (b - a) / run.period_s();
            (cycles - cycles.round()).abs() > SAME_PHASE
        };
        // The search's model was not the robot's yet.
        let after = opposed(&runs, &cycles, &swimmer.swimmer, &projection)?;
        let same = |(a, b): (&Option<Opposed>, &Option<Opposed>)| a.is_some() == b.is_some();
        let settled = !runs.iter().zip(starts.iter().zip(&next)).any(moved)
            && before.iter().zip(&after).all(same);
        if settled || round == ROUNDS {
            let named = campaign.runs.iter().enumerate();
            let mut excluded: Vec<ExcludedRun> = named
                .filter_map(|(index, run)| {
                    Some(ExcludedRun {
                        index,
                        file: run.track.clone(),
                        reason: run.exclude.clone()?,
                        by_sign: false,
                        result: None,
                    })
                })
                .collect();
            let mut finished = Vec::with_capacity(runs.len());
            for (((run, cycles), errors), (left_out, opposed)) in runs
                .into_iter()
                .zip(cycles)
                .zip(errors)
                .zip(before.iter().zip(after))
            {
                let run = run.finish(cycles, errors);
                match left_out.map(|before| opposed.unwrap_or(before)) {
                    None => finished.push(run),
                    Some(opposed) => excluded.push(ExcludedRun {
                        index: run.index,
                        file: run.file.clone(),
                        reason: opposed.to_string(),
                        by_sign: true,
                        result: Some(run),
                    }),
                }
            }
            excluded.sort_by_key(|run| run.index);
            let mut found = CampaignFit {
                start: campaign.swimmer.clone(),
                known: campaign.known,
                runs: finished,
                excluded,
                swimmer: campaign.swimmer.fitted(fit.sphere_radius, fit.chi),
                fit,
            };
            let unknown = scan::noticed(&found);
            found.fit.warnings.extend(unknown);
            let same = same_recordings(&found.runs).into_iter();
            let same = same.map(|runs| FitWarning::SameRecording {
                files: runs.map(|run| found.runs[run].file.clone()),
            });
            found.fit.warnings.extend(same);
            return Ok(found);
        }
        starts = next;
    }
}

/// The runs that the campaign does not exclude, with tracks or stated results.
fn begun<'a>(
    campaign: &Campaign,
    data: &'a CampaignData,
) -> Result<Vec<EitherRun<'a>>, CalibrateError> {
    let (mut tracked, mut gaits) = (data.runs.iter(), data.reported_gaits.iter());
    let swimmer = &campaign.swimmer;
    let begin = |index: usize| {
        let run = &campaign.runs[index];
        Some(if let Some(reported) = &run.reported {
            ReportedRun::begin(index, (run, reported), gaits.next()?, swimmer)
                .map(|run| EitherRun::Reported(Box::new(run)))
        } else {
            Run::begin(tracked.next()?, index, &campaign.reflectors, swimmer)
                .map(|run| EitherRun::Tracked(Box::new(run)))
        })
    };
    campaign.included().filter_map(begin).collect()
}

/// For each run, the evidence that it swims against this model.
fn opposed(
    runs: &[EitherRun<'_>],
    cycles: &[Cycles],
    swimmer: &Swimmer<f64>,
    projection: &Projection,
) -> Result<Vec<Option<Opposed>>, CalibrateError> {
    let pairs = runs.iter().zip(cycles);
    pairs
        .map(|(run, cycles)| run.opposes(cycles, swimmer, projection))
        .collect()
}

/// Runs that swim against the model can be left out while the others are no fewer.
fn check_signs(runs: &[EitherRun<'_>], opposed: &[Option<Opposed>]) -> Result<(), FitError> {
    let against: Vec<(&EitherRun<'_>, &Opposed)> = runs
        .iter()
        .zip(opposed)
        .filter_map(|(run, opposed)| Some((run, opposed.as_ref()?)))
        .collect();
    match against.first() {
        Some((_, first)) if 2 * against.len() > runs.len() || runs.len() < against.len() + 2 => {
            let names = against
                .iter()
                .map(|(run, _)| run.file().display().to_string());
            Err(FitError::SignOpposes {
                opposed: against.len(),
                runs: runs.len(),
                files: names.collect::<Vec<_>>().join(", "),
                measured_m: first.measured_m,
                predicted_m: first.predicted_m,
                direction: other_direction(first.is_clockwise),
            })
        }
        _ => Ok(()),
    }
}

fn starts(
    runs: &[EitherRun<'_>],
    swimmer: &Swimmer<f64>,
    projection: &Projection,
) -> Result<Vec<f64>, CalibrateError> {
    runs.iter()
        .map(|run| run.start(swimmer, projection))
        .collect()
}
