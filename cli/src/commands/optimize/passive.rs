//! `swimmer optimize passive`: the best waveform of one servo while the other joint has a spring.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use operations::best_waveform::{self, Cycle, Request, RequestedSpring};
use operations::{Context, SwimmerSource};
use passive_joint::Objective;
use swimmer_files::{JointName, Spring};

use crate::arguments::{positive_angle, rate, seconds, stiffness};
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::{Output, asides};
use crate::quantity::{self, Rows};

/// Find the best waveform and frequency of one servo while the other joint has a spring
///
/// The waveform is an odd Fourier series: one stroke forth and back, the second half of the cycle mirroring the first, so the swimmer
/// does not turn. The best sinusoid under the same bounds is where the search begins, and what the result is compared with.
#[derive(Debug, clap::Args)]
pub(crate) struct Passive {
    /// A preset or a swimmer file; its [passive] and [servo] tables stand in for options that are left out
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// The joint with the spring
    #[arg(long = "passive", value_name = "front|back")]
    joint: Option<JointName>,
    /// Stiffness of the spring, N m/rad; it needs the viscosity of the swimmer file's [fluid]
    #[arg(long, value_name = "K", value_parser = stiffness, conflicts_with = "relaxation")]
    stiffness: Option<f64>,
    /// Relaxation time of the passive joint on the straight swimmer, or free: the best spring is part of the search
    #[arg(long, value_name = "SECONDS|free")]
    relaxation: Option<Relaxation>,
    /// Quantity to maximise: displacement per cycle, speed (displacement per second), or Lighthill's efficiency (displacement² per motor
    /// work and period)
    #[arg(long, value_name = "QUANTITY", default_value = "displacement", value_parser = objective)]
    most: Objective,
    /// Seconds a cycle takes; left out, the best period is part of the search
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    /// The driven joint may turn no further than this, either way
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    /// The driven joint may turn no faster than this, an angle a second
    #[arg(long, value_name = "RATE", value_parser = rate)]
    max_rate: Option<f64>,
    /// Odd harmonics of the waveform: 3 for the orders 1, 3 and 5
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=8))]
    harmonics: u8,
    /// Write the waveform with the response of the passive joint as a gait file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// `--relaxation`.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Relaxation {
    Seconds(f64),
    Free,
}

impl FromStr for Relaxation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "free" => Ok(Self::Free),
            time => seconds(time)
                .map(Self::Seconds)
                .map_err(|problem| format!("{problem}, or free")),
        }
    }
}

fn objective(text: &str) -> Result<Objective, String> {
    Objective::ALL
        .into_iter()
        .find(|objective| objective.word() == text)
        .ok_or_else(|| {
            let words = Objective::ALL.map(Objective::word);
            format!("write one of {}", words.join(", "))
        })
}

impl Passive {
    /// Finds the waveform, writes the gait and prints the output.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.output.as_deref().map_or(Ok(()), may_be_written)?;
        let stiffness = self
            .stiffness
            .map(|k| RequestedSpring::Given(Spring::Stiffness(k)));
        let relaxation = self.relaxation.map(|relaxation| match relaxation {
            Relaxation::Seconds(time) => RequestedSpring::Given(Spring::Relaxation(time)),
            Relaxation::Free => RequestedSpring::Free,
        });
        let request = Request {
            swimmer: SwimmerSource::from(self.swimmer.as_str()),
            joint: self.joint,
            spring: stiffness.or(relaxation),
            objective: self.most,
            period_s: self.period,
            max_angle: self.max_angle,
            max_rate: self.max_rate,
            harmonics: usize::from(self.harmonics),
        };
        let mut context = Context::on_disk();
        let found = best_waveform::run(&request, &mut context);
        asides(&context);
        let mut found = found?;
        if let Some(path) = &self.output {
            found.file.save(path)?;
            found.gait = Some(path.clone());
        }
        output.rendered(&found, &Text(&found));
        Ok(())
    }
}

/// Output as text.
struct Text<'a>(&'a best_waveform::Output);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(output) = self;
        let best = &output.best;
        let mut rows = Rows::default();
        rows.row("displacement", displacement(best))
            .row("speed", format!("{:.4} mm/s", best.speed_m_per_s * 1e3))
            .row("efficiency ξ", format!("{:.8}", best.efficiency))
            .row("period", format!("{:.4} s", best.period_s))
            .row("spring", spring(best))
            .row(
                "passive joint",
                format!(
                    "{}, starts at {}",
                    output.passive,
                    quantity::angle(best.passive_start_rad)
                ),
            );
        for harmonic in &best.waveform {
            rows.row(
                format!("harmonic {}", harmonic.order),
                format!(
                    "cos {}, sin {}",
                    quantity::angle(harmonic.cos_rad),
                    quantity::angle(harmonic.sin_rad)
                ),
            );
        }
        rows.row(
            "driven joint",
            format!(
                "within {}, at most {} a second",
                quantity::angle(best.largest_angle_rad),
                quantity::angle(best.largest_rate_rad_per_s)
            ),
        )
        .row(
            "best sinusoid",
            format!(
                "{}, {:.4} s: the waveform gains {:.2} %",
                displacement(&output.sine),
                output.sine.period_s,
                output.gain_over_sine * 100.0
            ),
        )
        .row(
            "links cross",
            quantity::crossing_or_folding(&output.crossing),
        )
        .row(
            "conditions",
            format!(
                "gradient {}, bounds {}, second variation {}",
                below(output.conditions.stationarity),
                below(output.conditions.complementarity),
                if output.conditions.second_variation_negative {
                    "negative"
                } else {
                    "not negative: no strict optimum"
                }
            ),
        );
        if let Some(path) = &output.gait {
            rows.row("written to", path.display().to_string());
        }
        write!(
            f,
            "{}, a local optimum of {} with one servo\n{rows}",
            output.name, output.objective
        )
    }
}

fn displacement(cycle: &Cycle) -> String {
    format!(
        "{} per cycle   X/L = {:.8}",
        quantity::length(cycle.displacement_m),
        cycle.displacement_over_length
    )
}

fn spring(cycle: &Cycle) -> String {
    let stiffness = cycle
        .stiffness_n_m
        .map_or_else(String::new, |k| format!(", {:.4} mN m/rad", k * 1e3));
    format!("relaxes in {:.4} s{stiffness}", cycle.relaxation_s)
}

/// A residual by its order of magnitude: its digits are rounding.
fn below(residual: f64) -> String {
    if residual <= 1e-8 {
        "below 1e-8".to_owned()
    } else {
        format!("{residual:.0e}")
    }
}
