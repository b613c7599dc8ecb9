//! Output of the demo.

use std::fmt;
use std::path::Path;

use operations::calibrate;
use serde::Serialize;

use super::race::Race;
use super::{BEST, CYCLES, Finished, REPORT};
use crate::quantity::{self, Table};

/// Results of the round, and their files.
#[derive(Debug, Serialize)]
pub(super) struct DemoOutput {
    gait: String,
    played_cycles: u32,
    displacement_predicted_m: f64,
    displacement_tracked_m: f64,
    /// The fastest and the farthest gait, both at the servos' full rate.
    race: Race,
    fit: calibrate::Output,
    report: String,
    /// True parameters, for comparison with fit and prediction.
    truth: Truth,
    #[serde(skip)]
    tracked_sd_m: f64,
    #[serde(skip)]
    title: String,
}

#[derive(Debug, Serialize)]
struct Truth {
    sphere_radius_m: f64,
    chi: f64,
}

impl DemoOutput {
    pub(super) fn new(round: &Finished, place: &Path) -> Self {
        Self {
            gait: place.join(BEST).display().to_string(),
            played_cycles: CYCLES,
            displacement_predicted_m: round.predicted.x_m,
            displacement_tracked_m: round.swum.output.x_m,
            race: round.race.clone(),
            fit: round.fit.output.clone(),
            report: place.join(REPORT).display().to_string(),
            truth: Truth {
                sphere_radius_m: round.truth.swimmer.sphere_radius,
                chi: round.truth.swimmer.chi,
            },
            tracked_sd_m: round.swum.output.x_sd_m,
            title: format!(
                "Once round the loop with `{}`, seed {}",
                round.truth.name, round.seed
            ),
        }
    }
}

impl fmt::Display for DemoOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = self.fit.intervals.level * 100.0;
        let mut table = Table::new(["", "found", "interval", "truth", "deviation"]);
        let ([r_low, r_high], [chi_low, chi_high]) =
            (self.fit.intervals.sphere_radius, self.fit.intervals.chi);
        let (radius, chi) = (self.fit.sphere_radius_m, self.fit.chi);
        table.line([
            "r_s [mm]".into(),
            format!("{:.2}", radius * 1e3),
            format!("{:.2} … {:.2}", r_low * 1e3, r_high * 1e3),
            format!("{:.2}", self.truth.sphere_radius_m * 1e3),
            against(radius, self.truth.sphere_radius_m, 1e3, "mm"),
        ]);
        table.line([
            "χ".into(),
            format!("{chi:.3}"),
            format!("{chi_low:.3} … {chi_high:.3}"),
            format!("{:.3}", self.truth.chi),
            against(chi, self.truth.chi, 1.0, ""),
        ]);
        let (predicted, tracked) = (self.displacement_predicted_m, self.displacement_tracked_m);
        write!(f, "{} ({percent:.0} % intervals)\n{table}\n\n", self.title)?;
        writeln!(
            f,
            "  The optimised gait: {:.2} mm per cycle predicted, {:.2} ± {:.2} mm tracked over {} cycles ({})",
            predicted * 1e3,
            tracked * 1e3,
            self.tracked_sd_m * 1e3,
            self.played_cycles,
            against(predicted, tracked, 1e3, "mm"),
        )?;
        let Race { fastest, .. } = &self.race;
        writeln!(
            f,
            "  The fastest gait at the servos' full rate: {:.2} mm/s predicted, {:.2} mm/s tracked ({}), {:.2} times as fast as the optimised gait at that rate",
            fastest.speed_predicted_m_per_s * 1e3,
            fastest.speed_tracked_m_per_s * 1e3,
            against(
                fastest.speed_predicted_m_per_s,
                fastest.speed_tracked_m_per_s,
                1e3,
                "mm"
            ),
            self.race.times_as_fast,
        )?;
        write!(f, "  Report: {}", self.report)
    }
}

/// The deviation, in per cent where there is something to divide by.
fn against(value: f64, reference: f64, scale: f64, unit: &str) -> String {
    quantity::relative(value, reference).map_or_else(
        || {
            format!("{:+.2} {unit}", (value - reference) * scale)
                .trim_end()
                .to_owned()
        },
        quantity::deviation,
    )
}
