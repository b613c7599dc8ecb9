//! `swimmer optimize speed`: the fastest gait that servos can play.

use operations::optimize::GaitOutput;
use operations::optimize::speed::{self, Output, Request};
use operations::{Context, SwimmerSource};

use super::Objective;
use super::front::FrontFile;
use super::robust::{Robustly, add_robustness};
use super::text::{add_arcs, add_gait, titled};
use crate::arguments::{rate, seconds};
use crate::bounds::CycleBounds;
use crate::failure::Outcome;
use crate::picture_file::FigureOptions;
use crate::quantity::{self, Rows};

/// Find the fastest gait: most net displacement per unit of time, without net rotation, with servos that turn no faster than a
/// given rate
///
/// With --robust or --gain: with the worst swimmer of the uncertainty, or in the mean, compared with the fastest gait of the
/// estimates: along gaits that turn none of the swimmers, which is usual for the fastest gaits of equal side links.
///
/// Fastest means the best of all cycles of at most 16 corners: a chain of unlike cycles may always beat each of them, and a
/// longer cycle that is better by more than 1e-6 is reported. With a prescribed heading there often is one, as a cycle may tack:
/// lead to either side of the heading in turn, the faster the less often it turns, up to the speed of the fastest gait of any
/// heading, which is also reported. The gait is timed as it shall run, with its corners where a servo reverses.
#[derive(Debug, clap::Args)]
pub(crate) struct Speed {
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present = "playable")]
    max_rate: Vec<f64>,
    /// Direction of the displacement, relative to the mean heading of its cycle
    #[arg(long, value_name = "HEADING", value_enum, default_value = "any")]
    heading: Heading,
    /// The farthest gait in this many seconds, instead of the fastest: a cycle, several laps of one, or one and a rest
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    #[command(flatten)]
    bounds: CycleBounds,
    #[command(flatten)]
    robustly: Robustly,
    /// Also draw displacement per cycle against speed, of the farthest gaits in shorter and longer periods: a figure, or their
    /// table
    #[arg(long, value_name = "FILE.svg|.png|.pdf|.csv", conflicts_with_all = ["period", "robust", "gain"])]
    front: Option<FrontFile>,
    #[command(flatten)]
    figure: FigureOptions,
}

/// Direction of the displacement.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Heading {
    /// Wherever it is fastest
    Any,
    /// Along the mean heading
    Forward,
    /// Across it
    Sideways,
}

impl Objective for Speed {
    const WRITES: &'static str = "Write the gait, timed as it shall run, as a gait file";

    type Output = Output;

    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Output> {
        if let Some(front) = &self.front {
            front.may_be_written()?;
        }
        let width = self
            .figure
            .width(self.front.as_ref().map(FrontFile::kind))?;
        let request = Request {
            swimmer,
            max_rate: self.max_rate.clone(),
            heading: match self.heading {
                Heading::Any => speed::Heading::Any,
                Heading::Forward => speed::Heading::Forward,
                Heading::Sideways => speed::Heading::Sideways,
            },
            period: self.period,
            bounds: self.bounds.into(),
            robust: self.robustly.request()?,
            front: self.front.is_some(),
        };
        let mut output = speed::run(&request, context)?;
        if let Some(front) = &self.front {
            front.write(&mut output, width)?;
        }
        Ok(output)
    }

    fn gait(output: &mut Output) -> &mut GaitOutput {
        &mut output.gait
    }

    fn text(output: &Output) -> String {
        let kind = match output.robust {
            Some(_) => "robust fastest",
            None => "fastest",
        };
        let pace = quantity::length(output.speed_m_per_s);
        let way = quantity::length(output.displacement_m);
        let title = format!(
            "{}: the {kind} gait swims {way} in {:.2} s, {pace} a second",
            output.name, output.period_s
        );
        let mut rows = Rows::default();
        rows.row(
            "speed",
            format!(
                "{pace} a second   |d|/(L T) = {:.10} 1/s",
                output.speed_over_length_per_s
            ),
        )
        .row(
            "displacement",
            format!(
                "{way} per cycle   |d|/L = {:.10}",
                output.displacement_over_length
            ),
        )
        .row("period", format!("{:.6} s", output.period_s))
        .row(
            "leads",
            format!(
                "{} off the mean heading",
                quantity::angle(output.heading_rad)
            ),
        )
        .row(
            "found",
            format!("from {} of {} starts", output.found, output.starts),
        );
        add_search(&mut rows, output);
        if let Some(robustness) = &output.robust {
            add_robustness(&mut rows, robustness);
        }
        add_play(&mut rows, output);
        add_gait(&mut rows, &output.gait);
        titled(&title, &rows)
    }
}

/// Adds rest, arcs, and better gaits outside the class.
fn add_search(rows: &mut Rows, output: &Output) {
    if let (Some(rest), Some(moves)) = (output.rest_s, output.motion_s)
        && rest > 0.0
    {
        rows.row(
            "rests",
            format!("{rest:.6} s after a cycle of {moves:.6} s"),
        );
    }
    add_arcs(rows, &output.arcs);
    let speed = output.speed_over_length_per_s;
    let better = |other: f64| format!("{:.4} % faster", (other / speed - 1.0) * 100.0);
    if let Some(longer) = output.longer_speed_over_length_per_s {
        rows.row(
            "longer cycle",
            format!(
                "one of more than {} corners is {}",
                output.max_corners,
                better(longer)
            ),
        );
    }
    if let Some(uncertified) = output.uncertified_speed_over_length_per_s {
        rows.row(
            "not certified",
            format!(
                "another chain of arcs is {}, but meets not all conditions",
                better(uncertified)
            ),
        );
    }
}

/// Adds the fastest gait of any heading, the play on the robot, and the file of the farthest gaits.
fn add_play(rows: &mut Rows, output: &Output) {
    if let Some(any) = output.any_heading_speed_over_length_per_s {
        let more = any / output.speed_over_length_per_s - 1.0;
        if more > 1e-6 {
            rows.row(
                "any heading",
                format!(
                    "{:.2} % faster: long cycles that tack come near it",
                    more * 100.0
                ),
            );
        }
    }
    if let Some(played) = &output.played {
        rows.row(
            "as played",
            format!(
                "{} a second, a cycle in {:.3} s: table, ticks and servos take {:.2} %",
                quantity::length(played.speed_m_per_s),
                played.period_s,
                played.lost_share * 100.0
            ),
        );
    }
    if let Some(front) = &output.front {
        rows.row(
            "front",
            format!(
                "{}: the farthest gait in {} of {} periods",
                front.file.display(),
                front.periods_with_gait,
                front.periods
            ),
        );
    }
}
