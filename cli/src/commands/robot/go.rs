//! `swimmer robot go`: drives the robot to a pose by what the cameras see.

mod output;

use std::fs;
use std::path::{Path, PathBuf};

use experiment::{Controller, Goal, Options, Request};
use forecast::{Family, Planner, Step, Tank};
use nalgebra::Vector2;
use operations::plan::Target;
use swimmer_files::SwimmerFile;
use swimmer_model::{Gait as _, Pose};

use self::output::{GoOutput, RunOf};
use super::access::Access;
use super::bench::Bench;
use super::outputs::print_refusal;
use super::tracking::Tracked;
use crate::arguments::{angle, length, load_swimmer};
use crate::commands::optimize::steer::{Steer, write_straight};
use crate::commands::plan::{family_in, family_of_search};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::new_folder::NewFolder;
use crate::output::{Output, aside};

/// Seed of a fresh virtual robot.
const SEED: u64 = 1;

/// Drive the robot to a pose, or hold its heading, by what the cameras see
///
/// The robot plays one cycle at a time and rests, straight, after it. The cameras' pose at rest decides the next cycle, out of the
/// gaits forward, left and turn-left, their reverses and smaller ones; it also corrects the prediction of each gait and of the
/// drift in the tank. Poses are those of the middle link, in metres from the tank's centre. A robot that is not seen stays at
/// rest. A moving one is stopped at once if it comes nearer to a wall than --margin, or is not seen next to a wall. Exit status 1
/// if the goal is not reached; the reason is named.
///
/// `--port twin --track twin` drives a virtual robot, faster than real time.
#[derive(Debug, clap::Args)]
pub(super) struct Go {
    /// Pose to reach, metres; with a heading or without
    #[arg(
        long,
        value_name = "X,Y[,ANGLE]",
        allow_hyphen_values = true,
        required_unless_present = "hold"
    )]
    to: Option<Target>,
    /// Pose to pass before, as close as the target; may be given several times
    #[arg(
        long,
        value_name = "X,Y[,ANGLE]",
        allow_hyphen_values = true,
        requires = "to"
    )]
    via: Vec<Target>,
    /// Swim forward and hold this heading, instead of a target
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true, conflicts_with_all = ["to", "via"])]
    hold: Option<f64>,
    /// Forward cycles with --hold
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), default_value = "20")]
    cycles: u32,
    /// Inner measures of the tank, m
    #[arg(long, value_name = "LENGTHxWIDTH")]
    tank: Tank,
    /// Come no nearer to a wall than this, m
    #[arg(long, value_name = "LENGTH_M", value_parser = length, default_value = "0.01")]
    margin: f64,
    /// Distance and angle that count as reached
    #[arg(long, value_name = "LENGTH,ANGLE", value_parser = tolerance, default_value = "3mm,1deg")]
    within: Tolerance,
    /// Give up after this number of cycles
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), default_value = "400")]
    most_cycles: u32,
    /// Folder with the gaits. If it is missing, the gaits are searched for and kept there; the search takes a minute
    #[arg(long, value_name = "DIR")]
    gaits: Option<PathBuf>,
    /// The swimmer that this robot is: a preset or a swimmer file
    #[arg(long, value_name = "SWIMMER", default_value = "robot")]
    swimmer: String,
    #[command(flatten)]
    tracked: Tracked,
}

/// Distance and angle that count as reached.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tolerance {
    metres: f64,
    radians: f64,
}

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let bad = || format!("`{text}` is no tolerance: write LENGTH,ANGLE, as 3mm,1deg");
    let (distance, turn) = text.split_once(',').ok_or_else(bad)?;
    let distance = distance.trim();
    let metres = match distance.strip_suffix("mm") {
        Some(number) => number.trim().parse::<f64>().map(|number| number * 1e-3),
        None => distance.trim_end_matches('m').trim().parse(),
    };
    let metres = metres.map_err(|_| bad())?;
    let radians = angle(turn.trim())?;
    let positive = metres > 0.0 && metres.is_finite() && radians > 0.0;
    positive
        .then_some(Tolerance { metres, radians })
        .ok_or_else(bad)
}

/// `swimmer robot go`.
pub(super) fn go(access: &Access, go: &Go, output: Output) -> Outcome {
    let file = load_swimmer(&go.swimmer)?;
    let model = crate::arguments::model(&file)?;
    go.tracked.cameras().check(access.is_fresh())?;
    for target in go.via.iter().chain(&go.to) {
        inside(target, &file, &go.tank, go.margin)?;
    }
    let interrupt = Interrupt::install_with_a_robot()?;
    // Before the link is opened: the search takes a moment, in which nobody would listen to the robot.
    let family = family(go.gaits.as_deref(), &file)?;
    let cameras = go.tracked.cameras();
    let mut bench = Bench::open(access, "swimmer robot go", cameras, &file, SEED, interrupt)?;
    let walls = Some(go.tank);
    let planner = Planner::new(model, family, *bench.servos(), walls, go.margin)
        .map_err(|error| Failure::tried(&error))?;
    output.line("The cameras see the robot. Ctrl-C stops.");
    let begun_s = bench.now_s();
    let mut controller = Controller::new(planner.clone(), go.goal(), go.options(), begun_s);
    drive(&mut bench, &mut controller, &planner, output)?;
    let run = RunOf {
        duration_s: bench.now_s() - begun_s,
        camera_delay_s: bench.camera_delay_s(),
    };
    bench.close()?;
    let result = GoOutput::new(&controller, &run);
    match controller.ending() {
        Some(ending) if !ending.is_success() => print_refusal(output, &result, ending.to_string()),
        _ => {
            output.print(&result);
            Ok(())
        }
    }
}

/// Runs the controller to its end; the robot is at rest then, or lost.
fn drive(
    bench: &mut Bench,
    controller: &mut Controller,
    planner: &Planner,
    output: Output,
) -> Outcome {
    let decided = |controller: &Controller, step: Option<&Step>| {
        if let Some(row) = row(controller, step) {
            output.line(&row);
        }
    };
    while !controller.is_over() {
        for event in bench.advance()? {
            controller.event(&event);
        }
        let event = match controller.poll(bench.now_s()) {
            Some(Request::Play(step)) => {
                decided(controller, Some(&step));
                let table = planner.checked_table(&step);
                let table = table.map_err(|error| Failure::tried(&error))?;
                bench.play(step.member.word(false), &table)
            }
            Some(Request::Stop) => bench.stop(),
            Some(Request::Evaluate(evaluation)) => {
                bench.evaluate(evaluation)?;
                None
            }
            None => None,
        };
        if let Some(event) = event {
            controller.event(&event);
        }
    }
    decided(controller, None);
    Ok(())
}

impl Go {
    fn goal(&self) -> Goal {
        match self.hold {
            Some(heading_rad) => Goal::Hold {
                heading_rad,
                cycles: self.cycles,
            },
            None => Goal::Reach(
                self.via
                    .iter()
                    .chain(&self.to)
                    .map(|target| experiment::Target {
                        x_m: target.x_m,
                        y_m: target.y_m,
                        heading_rad: target.heading_rad,
                    })
                    .collect(),
            ),
        }
    }

    fn options(&self) -> Options {
        Options {
            within_m: self.within.metres,
            within_rad: self.within.radians,
            most_cycles: self.most_cycles,
            ..Options::default()
        }
    }
}

/// Refuses a target at which the straight swimmer would touch the margin.
fn inside(target: &Target, file: &SwimmerFile, tank: &Tank, margin: f64) -> Outcome {
    let pose = Pose::new(target.x_m, target.y_m, target.heading_rad.unwrap_or(0.0));
    let swimmer = &file.swimmer;
    let mut parts = vec![(pose.position(), swimmer.sphere_radius)];
    if target.heading_rad.is_some() {
        let ends = swimmer.links.outline(&Vector2::zeros());
        parts.extend(ends.map(|end| (pose.transform(&end), 0.0)));
    }
    let free = |(at, radius): &(Vector2<f64>, f64)| {
        let along = 0.5 * tank.length - at.x.abs();
        along.min(0.5 * tank.width - at.y.abs()) - radius
    };
    let least = parts.iter().map(free).fold(f64::INFINITY, f64::min);
    if least >= margin {
        return Ok(());
    }
    let reach = if least < 0.0 {
        format!(
            "the swimmer would reach {:.0} mm beyond a wall",
            -least * 1e3
        )
    } else {
        format!(
            "the swimmer would be {:.0} mm from a wall, less than the margin of {:.0} mm",
            least * 1e3,
            margin * 1e3
        )
    };
    Err(Failure::BadInput(format!(
        "the target {},{}: {reach}; the tank reaches ±{} m along and ±{} m across from its centre. Name a target farther inside",
        target.x_m,
        target.y_m,
        tank.length / 2.0,
        tank.width / 2.0
    )))
}

/// Gaits of a folder, or found and kept there.
fn family(folder: Option<&Path>, file: &SwimmerFile) -> Outcome<Family> {
    let steer = Steer::straight();
    let family = match folder {
        Some(folder) if is_filled(folder) => family_in(folder, steer.rates(file)?)?,
        Some(folder) => {
            let draft = NewFolder::start(folder)?;
            write_straight(file, draft.draft())?;
            draft.publish()?;
            family_in(folder, steer.rates(file)?)?
        }
        None => {
            aside(
                "note: the gaits are searched for, which takes a minute; --gaits DIR keeps them for the next time.",
            );
            family_of_search(&steer, file)?
        }
    };
    let is_straight = |gait: &swimmer_files::AnyGait| gait.at(0.0).phi.norm() < 1e-6;
    if family.gaits.iter().all(|(gait, _)| is_straight(gait)) {
        return Ok(family);
    }
    Err(Failure::BadInput(
        "the gaits do not begin at the straight shape, in which the robot rests between cycles: find others by `swimmer optimize steer \
         --playable --shape 0,0 -o DIR`, or name a new folder"
            .to_owned(),
    ))
}

fn is_filled(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some())
}

/// Line for people: pose at the last rest, and the next cycle.
fn row(controller: &Controller, step: Option<&Step>) -> Option<String> {
    let rest = controller.last_rest()?;
    let off = controller
        .off()
        .map_or_else(String::new, |[metres, radians]| {
            format!(
                ", {:.1} mm and {:.1}° to go",
                metres * 1e3,
                radians.to_degrees()
            )
        });
    let next = step.map_or_else(String::new, |step| {
        format!(
            "; next {} × {:.2}",
            step.member.word(false),
            step.member.scale
        )
    });
    Some(format!(
        "after {:3} cycles at ({:.4}, {:.4}) m, {:.1}°{off}{next}",
        controller.cycles(),
        rest.x_m,
        rest.y_m,
        rest.heading_rad.to_degrees(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_read() {
        let read = |text| tolerance(text).map(|read| (read.metres, read.radians.to_degrees()));
        for text in ["3mm,1deg", "0.003,1deg", "0.003 m, 1deg"] {
            let (metres, degrees) = read(text).unwrap();
            assert!(
                (metres - 3e-3).abs() < 1e-15 && (degrees - 1.0).abs() < 1e-12,
                "{text}"
            );
        }
        for text in ["", "3mm", "0mm,1deg", "3mm,0deg", "x,1deg", "-1mm,1deg"] {
            assert!(tolerance(text).is_err(), "{text}");
        }
    }

    #[test]
    fn targets_outside_are_refused() {
        let file = SwimmerFile::preset("robot").unwrap();
        let tank = Tank {
            length: 1.0,
            width: 0.6,
        };
        let refused = |x_m, y_m, heading_rad: Option<f64>| {
            let target = Target {
                x_m,
                y_m,
                heading_rad,
            };
            inside(&target, &file, &tank, 0.01).is_err()
        };
        assert!(
            refused(0.6, 0.0, None) && refused(0.4, 0.0, Some(0.0)) && refused(0.0, 0.25, None)
        );
        assert!(!refused(0.4, 0.0, None) && !refused(0.3, 0.0, Some(0.0)));
        assert!(refused(0.0, 0.2, Some(1.5)) && !refused(0.0, 0.2, Some(0.0)));
    }
}
