//! Runs that repeat a gait: the fit takes their mean for one run, and their scatter is shown here.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::Plain;
use crate::fit::CampaignFit;
use crate::prediction::first_of_repeats;
use crate::quantities::{QUANTITIES, TELLING};

/// Runs of one gait at one pace.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Repeats {
    /// The gait as the first of them names it.
    pub gait: String,
    /// The runs, by their places among the fitted ones.
    #[serde(skip)]
    pub runs: Vec<usize>,
    /// Mean X and its deviation from repeat to repeat \[m\].
    pub x_m: [f64; 2],
    /// The same of ΔY \[m\].
    pub delta_y_m: [f64; 2],
    /// The same of Δθ \[rad\].
    pub delta_theta_rad: [f64; 2],
    /// Probability of this scatter between repeats, if it were that of the cycles: of the quantity that scatters most.
    pub chance: f64,
}

pub(super) fn repeats(found: &CampaignFit, plain: &Plain) -> Vec<Repeats> {
    let played: Vec<_> = found.runs.iter().map(|run| &run.played).collect();
    let first = first_of_repeats(&played);
    let of = |leader: usize| {
        let runs: Vec<usize> = (0..first.len())
            .filter(|run| first[*run] == leader)
            .collect();
        if runs.len() < 2 {
            return None;
        }
        let values = [0, 1, 2].map(|q| scatter(plain, &runs, q));
        let worst = values.iter().map(|(_, chance)| *chance).fold(1.0, f64::min);
        Some(Repeats {
            gait: found.runs[leader].gait.clone(),
            runs,
            x_m: values[0].0,
            delta_y_m: values[1].0,
            delta_theta_rad: values[2].0,
            chance: (worst * TELLING as f64).min(1.0),
        })
    };
    (0..first.len()).filter_map(of).collect()
}

/// Mean and deviation of a quantity over repeats, and the probability of such a deviation by the scatter of their cycles.
fn scatter(plain: &Plain, runs: &[usize], q: usize) -> ([f64; 2], f64) {
    let data = &plain.data;
    let rows = runs.iter().map(|run| QUANTITIES * run + q);
    let rows: Vec<usize> = rows.filter(|row| data.is_there(*row)).collect();
    let count = rows.len() as f64;
    let mean = rows.iter().map(|row| data.own[*row]).sum::<f64>() / count;
    let squares = rows.iter().map(|row| (data.own[*row] - mean).powi(2));
    let variance = squares.sum::<f64>() / (count - 1.0);
    let within = rows.iter().map(|row| data.own_within[*row]);
    let expected = within.clone().map(|w| w.value).sum::<f64>() / count;
    let freedom = within.map(|w| w.freedom).sum::<f64>();
    let ratio = variance / expected;
    let chance = if ratio.is_finite() && freedom > 0.0 {
        FisherSnedecor::new(count - 1.0, freedom).map_or(f64::NAN, |f| f.sf(ratio))
    } else {
        f64::NAN
    };
    let scale = data.scales[q];
    ([mean * scale, variance.sqrt() * scale], chance)
}
