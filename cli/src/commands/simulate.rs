//! `swimmer simulate`: swims a gait in the model.

pub(crate) mod played;

use std::fmt;
use std::path::{Path, PathBuf};

use operations::passive::{self, Drive};
use operations::{Context, Subject, SwimmerSource, simulate};
use swimmer_files::{AnyGait, write_atomically};
use swimmer_model::{Model, Pose, Tolerance, trajectory};

use crate::csv_text::csv_text;
use crate::failure::{Failure, Outcome};
use crate::in_fluid::fluid_rows;
use crate::new_file::may_be_written;
use crate::output::{Output, asides};
use crate::passive::{PassiveOptions, passive_row};
use crate::picture_file::{FigureOptions, FigureWidth, Kind};
use crate::quantity::{self, Rows};
use crate::report::style::number;
use crate::report::swimming::{ANIMATION_SIZE, FRAMES_PER_SECOND, Swimming, animation, snapshots};

use played::played_rows;

/// Swim a gait in the model and print the results of one cycle
#[derive(Debug, clap::Args)]
pub(crate) struct Simulate {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// circle:AMPLITUDE, square:AMPLITUDE or a gait file; add :cw to reverse it. With a passive joint only the other joint is
    /// driven, and sine:AMPLITUDE drives it with AMPLITUDE cos 2πu
    #[arg(long, value_name = "GAIT")]
    gait: Drive,
    /// Number of cycles of the trajectory and the snapshots; the printed values are always those of the first
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    cycles: u32,
    /// Write the path of the middle link as a table: cycle, u, joint angles, pose
    #[arg(long, value_name = "FILE.csv")]
    trajectory: Option<PathBuf>,
    /// Draw the swimmer: .svg, .png or .pdf for snapshots along its path over all cycles, .gif for the first cycle in motion
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOptions,
    #[command(flatten)]
    playing: played::Playing,
    #[command(flatten)]
    passive: PassiveOptions,
    /// Write the limit cycle of a passive joint as a gait file, which names the joint
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Output as text.
struct Text<'a> {
    title: &'a str,
    output: &'a simulate::Output,
    response: Option<passive::Response>,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let output = self.output;
        let net = &output.net;
        let mut rows = Rows::default();
        rows.row(
            "displacement X",
            format!(
                "{}   X/L = {:.10}",
                quantity::length(net.displacement_m),
                net.displacement_over_length
            ),
        )
        .row(
            "lateral",
            format!(
                "Y/L = {:.10}",
                (net.lateral_over_length * 1e10).round() / 1e10 + 0.0
            ),
        )
        .row("rotation", quantity::angle(net.rotation_rad))
        .row("sway ΔY", format!("ΔY/L = {:.8}", net.delta_y_over_length))
        .row("yaw Δθ", quantity::angle(net.delta_theta_rad))
        .row(
            "efficiency ξ",
            if net.efficiency.is_nan() {
                "not defined: it compares with drag, which only a viscous fluid has".to_owned()
            } else {
                format!(
                    "{:.8} as parametrised, {:.8} at constant power",
                    net.efficiency, net.efficiency_constant_power
                )
            },
        )
        .row(
            "links cross",
            quantity::crossing_or_folding(&output.crossing),
        );
        if let Some(response) = &self.response {
            passive_row(response, &mut rows);
        }
        if let Some(played) = &output.played {
            played_rows(played, &mut rows);
        }
        if let Some(load) = &output.fluid {
            fluid_rows(load, &mut rows);
        }
        if let Some(path) = &output.trajectory {
            rows.row("written to", path.display().to_string());
        }
        if let Some(path) = &output.gait {
            rows.row("gait written to", path.display().to_string());
        }
        if let Some(path) = &output.picture {
            rows.row("drawn to", drawn(path));
        }
        write!(f, "{}\n{rows}", self.title)
    }
}

/// Points of a cycle in the trajectory file.
const POINTS_A_CYCLE: usize = 500;

impl Simulate {
    /// Simulates the gait, writes trajectory and picture, and prints the output.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.trajectory.as_deref().map_or(Ok(()), may_be_written)?;
        self.output.as_deref().map_or(Ok(()), may_be_written)?;
        let picture = if let Some(path) = &self.picture {
            Some(Picture::new(path.clone(), self.figure)?)
        } else {
            self.figure.width(None)?;
            None
        };
        let mut context = Context::on_disk();
        let subject = Subject::load_driven(
            &SwimmerSource::from(self.swimmer.as_str()),
            &self.gait,
            &self.passive.options(),
            self.playing.period,
            &mut context,
        )
        .and_then(|subject| {
            let simulated = simulate::run(&subject, &self.playing.options(), &mut context)?;
            Ok((subject, simulated))
        });
        asides(&context);
        let (subject, mut simulated) = subject?;
        if let Some(path) = &self.output {
            let Some(samples) = &subject.samples else {
                return Err(Failure::BadInput(
                    "-o writes the limit cycle of a passive joint: name the joint by --passive, and its spring".to_owned(),
                ));
            };
            samples.save(path)?;
            simulated.gait = Some(path.clone());
        }
        let name = self.gait.readable();
        if let Some(path) = &self.trajectory {
            write_trajectory(path, &subject.model, &subject.gait, self.cycles)?;
            simulated.trajectory = Some(path.clone());
        }
        if let Some(picture) = &picture {
            picture.draw(&subject, &name, self.cycles, &mut simulated)?;
        }
        let title = format!("{}, {name}", subject.file.name);
        output.rendered(
            &simulated,
            &Text {
                title: &title,
                output: &simulated,
                response: subject.response,
            },
        );
        Ok(())
    }
}

/// New picture of a swimmer in motion.
#[derive(Debug)]
pub(crate) struct Picture {
    path: PathBuf,
    kind: Kind,
    width: FigureWidth,
}

impl Picture {
    /// The format is that of the file name, checked before anything is computed.
    pub(crate) fn new(path: PathBuf, options: FigureOptions) -> Outcome<Self> {
        let kind = Kind::of(&path, &[Kind::Svg, Kind::Png, Kind::Pdf, Kind::Gif])?;
        let width = options.width(Some(kind))?;
        may_be_written(&path)?;
        Ok(Self { path, kind, width })
    }

    /// Draws a simulated gait of this name, and names the file in the output.
    pub(crate) fn draw(
        &self,
        subject: &Subject,
        gait: &str,
        cycles: u32,
        simulated: &mut simulate::Output,
    ) -> Outcome {
        let Self { path, kind, width } = self;
        let cycles = if *kind == Kind::Gif { 1 } else { cycles };
        let over_length = number(simulated.net.displacement_over_length, 4);
        let caption = format!("{}, {gait}: X/L = {over_length} a cycle", subject.file.name);
        let swimming = Swimming::in_the_model(caption, &subject.model, &subject.gait, cycles);
        match kind {
            Kind::Gif => write_atomically(path, &animation(&swimming)?)?,
            kind => kind.write(path, &snapshots(&swimming, *width), *width)?,
        }
        simulated.picture = Some(path.clone());
        Ok(())
    }
}

/// Path of the picture; for an animation also its size and frame rate.
fn drawn(path: &Path) -> String {
    let place = path.display();
    match Kind::of(path, &[Kind::Gif]) {
        Ok(_) => {
            let (width, height) = ANIMATION_SIZE;
            format!("{place}: {width} × {height}, {FRAMES_PER_SECOND} images a second")
        }
        Err(_) => place.to_string(),
    }
}

/// Writes one row for each instant. The pose starts at the origin along x and continues from cycle to cycle.
fn write_trajectory(path: &Path, model: &Model<f64>, gait: &AnyGait, cycles: u32) -> Outcome {
    let mut rows = Vec::new();
    let mut start = Pose::identity();
    for cycle in 0..cycles {
        let mut end = start;
        trajectory(
            model,
            gait,
            &Tolerance::default(),
            POINTS_A_CYCLE,
            |point| {
                end = start * point.pose;
                // The last instant of a cycle is the first of the next.
                if point.u < 1.0 || cycle + 1 == cycles {
                    let (phi, u) = (point.phi, point.u);
                    rows.push((cycle, u, [phi.x, phi.y], [end.x, end.y, end.theta]));
                }
            },
        );
        start = end;
    }
    let heading = "cycle,u,phi1_rad,phi2_rad,x_m,y_m,theta_rad".split(',');
    Ok(write_atomically(path, csv_text(heading, rows)?.as_bytes())?)
}
