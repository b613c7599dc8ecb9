//! `swimmer plan`: gaits of one family strung together to a target.

mod output;
mod playlist;

use std::path::{Path, PathBuf};

use forecast::{Family, PlanError, PlanRequest, Servos, Tank, check_ends, plan};
use swimmer_files::{AnyGait, GaitFile, SwimmerFile};
use swimmer_model::{Gait as _, Link, Pose};

use self::output::answer;
use self::playlist::write_playlist;
use super::optimize::steer::{Steer, named};
use super::robot::preflight::tank;
use crate::arguments::{angle, length, load_swimmer};
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::Output;
use crate::progress::Progress;

/// String the gaits of `optimize steer` together so that the swimmer comes to a target
///
/// Poses are those of the middle link with both joints straight: x and y from the tank's centre in metres, the heading from its
/// length. The way from the straight shape to the one at which the gaits join, and back, belongs to the plan. The plan is the
/// quickest that was found, of chains of three legs and, next to walls, of ways out to where they fit; a leg is a
/// number of cycles of one gait, drawn in a little so that the legs together meet the target as the robot plays it: soft start,
/// tables, servos with their dead band. Where no plan is found with the gaits whose joining costs least, because the swimmer has no
/// space to bend, gaits are searched that join at the straight shape.
///
/// `swimmer robot play --playlist` plays what -o writes.
#[derive(Debug, clap::Args)]
pub(crate) struct Plan {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    steer: Steer,
    /// Where to go, metres; with a heading or without
    #[arg(long, value_name = "X,Y[,ANGLE]", value_parser = target, allow_hyphen_values = true)]
    to: Target,
    /// Where the swimmer is
    #[arg(long, value_name = "X,Y[,ANGLE]", value_parser = target, allow_hyphen_values = true, default_value = "0,0,0")]
    from: Target,
    /// Stay within the walls of this tank: length x width, m
    #[arg(long, value_name = "LENGTHxWIDTH", value_parser = tank)]
    tank: Option<Tank>,
    /// Come no nearer to a wall than this, m
    #[arg(long, value_name = "LENGTH_M", value_parser = length, default_value = "0.005")]
    margin: f64,
    /// Take the gaits from this folder, which `optimize steer -o` wrote, instead of looking for them
    #[arg(long, value_name = "DIR", conflicts_with = "shape")]
    gaits: Option<PathBuf>,
    /// Write the plan as a playlist, and its gaits next to it
    #[arg(short, long, value_name = "PLAYLIST")]
    output: Option<PathBuf>,
}

/// A place, perhaps with a heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Target {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) heading: Option<f64>,
}

pub(crate) fn target(text: &str) -> Result<Target, String> {
    let bad = || format!("`{text}` is no place: give X,Y or X,Y,ANGLE, as 0.2,-0.1,90deg");
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let metres = |part: &str| {
        let number: f64 = part.parse().map_err(|_| bad())?;
        if number.is_finite() {
            Ok(number)
        } else {
            Err(bad())
        }
    };
    let (x, y, heading) = match parts[..] {
        [x, y] => (x, y, None),
        [x, y, heading] => (x, y, Some(angle(heading)?)),
        _ => return Err(bad()),
    };
    Ok(Target {
        x: metres(x)?,
        y: metres(y)?,
        heading,
    })
}

impl Plan {
    pub(crate) fn run(self, output: Output) -> Outcome {
        if let Some(path) = &self.output {
            may_be_written(path)?;
        }
        let file = load_swimmer(&self.swimmer)?;
        let model = crate::arguments::model(&file)?;
        let regular = file.swimmer.check_regular();
        regular.map_err(|error| Failure::bad_input(&error))?;
        let swimmer = &file.swimmer;
        if self.tank.is_some() && swimmer.sphere_on != Link::Middle && swimmer.sphere_radius > 0.0 {
            return Err(Failure::BadInput(format!(
                "`{}` has its sphere on a side link ([sphere] on), and the distance to walls is that of a sphere on the middle \
                 link: leave --tank out",
                file.name
            )));
        }
        let request = PlanRequest {
            from: Pose::new(self.from.x, self.from.y, self.from.heading.unwrap_or(0.0)),
            to: nalgebra::Vector2::new(self.to.x, self.to.y),
            heading: self.to.heading,
            tank: self.tank,
            margin: self.margin,
            servos: Servos::on_the_robot(file.servo.unwrap_or_default()),
        };
        check_ends(&model, &request).map_err(|error| Failure::tried(&error))?;
        let mut family = self.family(&file)?;
        let plan = |family: &Family| {
            let progress = Progress::with_share("searching for a plan");
            plan(&model, family, &request, &|share| progress.at_share(share))
        };
        let mut found = plan(&family);
        let no_room = matches!(found, Err(PlanError::Bent { .. } | PlanError::NoWay { .. }));
        if no_room && self.gaits.is_none() && self.steer.shape.is_none() {
            // Next to a wall the straight swimmer may fit where the bent one does not.
            let mut straight = self.steer.clone();
            straight.shape = Some([0.0; 2]);
            family = joined(&straight, &file)?;
            found = plan(&family);
        }
        let found = found.map_err(|error| Failure::tried(&error))?;
        let off = |share: f64| -> Outcome<[f64; 2]> {
            let mut other = file.clone();
            other.swimmer.chi *= share;
            other.swimmer.side_chi = other
                .swimmer
                .side_chi
                .map(|both| both.map(|chi| chi * share));
            let model = crate::arguments::model(&other)?;
            let reached = found.reached_by(&model, &request.from);
            Ok(found.apart_from(&reached))
        };
        // χ has no effect in a perfect fluid.
        let is_viscous = file.swimmer.is_viscous();
        let wrong = if is_viscous {
            Some([off(0.95)?, off(1.05)?])
        } else {
            None
        };
        let gaits = match &self.output {
            Some(path) => Some(write_playlist(path, &file, &family, &found)?),
            None => None,
        };
        output.print(&answer(&file.name, &found, wrong, gaits, self.output));
        Ok(())
    }

    fn family(&self, file: &SwimmerFile) -> Outcome<Family> {
        let Some(folder) = &self.gaits else {
            return joined(&self.steer, file);
        };
        family_in(folder, self.steer.rates(file)?)
    }
}

/// The gaits of a folder that `optimize steer -o` wrote, as fast as servos of these rates \[rad/s\] turn.
///
/// # Errors
/// [`Failure::BadInput`] if a gait is missing or cannot be read.
pub(crate) fn family_in(folder: &Path, rates: [f64; 2]) -> Outcome<Family> {
    let mut all = Vec::new();
    for name in ["forward", "left", "turn-left"] {
        let path = folder.join(format!("{name}.gait"));
        let gait = GaitFile::load(&path)?;
        let curve = AnyGait::from_file(&gait)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
        // As fast as the servos turn.
        let period = (0..curve.pieces())
            .flat_map(|piece| {
                let end = curve.piece_end(piece);
                [end - 1e-9, end + 1e-9].map(|u| curve.at(u.rem_euclid(1.0)).rate)
            })
            .map(|rate| (rate.x.abs() / rates[0]).max(rate.y.abs() / rates[1]))
            .fold(0.0, f64::max);
        all.push((curve, period));
    }
    family_of(all)
}

/// The gaits that are found.
pub(crate) fn joined(steer: &Steer, file: &SwimmerFile) -> Outcome<Family> {
    let steering = steer.find(file)?;
    let gaits = [0, 2, 4].map(|at| {
        let (_, joined, _) = named(&steering)[at];
        let curve = AnyGait::from_file(&joined.gait_file(&file.name, false));
        curve.map(|curve| (curve, joined.period))
    });
    let all = gaits.into_iter().collect::<Result<Vec<_>, _>>();
    family_of(all.map_err(|error| Failure::Tried(error.to_string()))?)
}

fn family_of(gaits: Vec<(AnyGait, f64)>) -> Outcome<Family> {
    let gaits = gaits
        .try_into()
        .map_err(|_| Failure::Tried("a family has three gaits".to_owned()))?;
    Ok(Family {
        gaits,
        mirrored: false,
    })
}
