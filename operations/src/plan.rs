//! Motion plans: gaits of one family that lead to a target one after the other.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use forecast::{Family, PlanError, PlanRequest, Scaled, Servos, Tank, check_ends, plan};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use swimmer_files::{
    AnyGait, GaitFile, GaitSpec, Playlist, PlaylistStep, SwimmerFile, SwimmerHash, parse_angle,
};
use swimmer_model::{Gait as _, Link, Pose};

use crate::context::Stage;
use crate::optimize::steer;
use crate::{Context, Error, Files, SwimmerSource, model};

/// Default distance to the walls \[m\].
pub const MARGIN_M: f64 = 0.005;
/// Gaits of a family, by the names of their files.
const FAMILY: [&str; 3] = ["forward", "left", "turn-left"];
/// Samples of a gait between two corners.
const SAMPLES_BETWEEN_CORNERS: usize = 48;

/// Search for a plan. Poses are those of the middle link with both joints straight, from the tank's centre.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Gaits of the plan: options of their search.
    #[serde(default)]
    pub steer: steer::Options,
    /// Folder of the six gaits, in place of their search.
    #[serde(default)]
    pub gaits: Option<PathBuf>,
    /// Start pose.
    #[serde(default)]
    pub from: Target,
    /// Target.
    pub to: Target,
    /// Inner measures of the tank \[m\]; `None` for open water.
    #[serde(default)]
    pub tank: Option<Tank>,
    /// Least distance to a wall \[m\].
    #[serde(default = "default_margin")]
    pub margin_m: f64,
}

fn default_margin() -> f64 {
    MARGIN_M
}

/// Place in the tank, with or without a heading.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Target {
    /// Along the tank \[m\].
    pub x_m: f64,
    /// Across the tank \[m\].
    pub y_m: f64,
    /// Heading \[rad\]; `None` for any, at the start for 0.
    #[serde(default)]
    pub heading_rad: Option<f64>,
}

impl FromStr for Target {
    type Err = String;

    /// Reads `X,Y` or `X,Y,ANGLE`: metres, and an angle with its unit.
    fn from_str(text: &str) -> Result<Self, String> {
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
            [x, y, heading] => (x, y, Some(heading)),
            _ => return Err(bad()),
        };
        let heading = heading.map(|text| parse_angle(text).map_err(|error| error.to_string()));
        Ok(Self {
            heading_rad: heading.transpose()?,
            x_m: metres(x)?,
            y_m: metres(y)?,
        })
    }
}

/// The quickest plan found. The JSON document of `swimmer plan`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PlanOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Steps in order.
    pub steps: Vec<StepOutput>,
    /// Duration \[s\], without the motion from and to the straight shape.
    pub duration_s: f64,
    /// End pose, with the joints straight again.
    pub reached: ReachedPose,
    /// Distance of the end pose to the target, in the model \[m\].
    pub off_m: f64,
    /// Angle between the heading of the end pose and that of the target \[rad\].
    pub off_rad: f64,
    /// Deviation from the end pose if χ is 5 % lower; missing outside a viscous fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_if_chi_is_5_percent_lower: Option<Deviation>,
    /// Deviation from the end pose if χ is 5 % higher; missing outside a viscous fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_if_chi_is_5_percent_higher: Option<Deviation>,
    /// Number of chains of legs that meet the target.
    pub chains: usize,
    /// Number of these chains that stay clear of the walls.
    pub chains_within_walls: usize,
    /// Playlist, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub playlist: Option<PathBuf>,
}

/// Cycles of one gait.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PlanStepOutput")
)]
pub struct StepOutput {
    /// Gait: forward, backward, left, right, turn-left or turn-right, or the name of its file next to the playlist.
    pub gait: String,
    /// Number of cycles.
    pub cycles: u32,
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Size of the gait: share of the way from the common shape.
    pub scale: f64,
    /// Gait file.
    #[serde(skip)]
    pub file: GaitFile,
}

/// End pose of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReachedPose {
    /// Along the tank \[m\].
    pub x_m: f64,
    /// Across the tank \[m\].
    pub y_m: f64,
    /// Heading \[rad\].
    pub heading_rad: f64,
}

/// Deviation from a pose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PoseDeviation")
)]
pub struct Deviation {
    /// Distance \[m\].
    pub distance_m: f64,
    /// Angle between the headings \[rad\].
    pub angle_rad: f64,
}

impl From<[f64; 2]> for Deviation {
    fn from([distance_m, angle_rad]: [f64; 2]) -> Self {
        Self {
            distance_m,
            angle_rad,
        }
    }
}

/// Finds a plan.
///
/// # Errors
/// The request is invalid, a gait cannot be read or found, or no plan leads to the target.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let swimmer_model = model(&file)?;
    let regular = file.swimmer.check_regular();
    regular.map_err(|error| Error::bad_input(&error))?;
    let swimmer = &file.swimmer;
    if request.tank.is_some() && swimmer.sphere_on != Link::Middle && swimmer.sphere_radius > 0.0 {
        return Err(Error::refused(format!(
            "`{}` has its sphere on a side link ([sphere] on), and the distance to walls is that of a sphere on the middle link: \
             leave --tank out",
            file.name
        )));
    }
    let (from, to) = (&request.from, &request.to);
    let problem = PlanRequest {
        from: Pose::new(from.x_m, from.y_m, from.heading_rad.unwrap_or(0.0)),
        to: Vector2::new(to.x_m, to.y_m),
        heading: to.heading_rad,
        tank: request.tank,
        margin: request.margin_m,
        servos: Servos::on_the_robot(file.servo.unwrap_or_default()),
    };
    check_ends(&swimmer_model, &problem)?;
    let mut family = match &request.gaits {
        Some(folder) => family_in(folder, request.steer.rates(&file)?, context.files)?,
        None => family_of_search(&file, &request.steer, context)?,
    };
    let search = |family: &Family| {
        let found = context.timed(Stage::Plan, |watch| {
            plan(&swimmer_model, family, &problem, watch)
        });
        found.result
    };
    let mut found = search(&family);
    let has_no_space = matches!(found, Err(PlanError::Bent { .. } | PlanError::NoWay { .. }));
    if has_no_space && request.gaits.is_none() && request.steer.shape.is_none() {
        // Next to a wall the straight swimmer may fit if the bent one does not.
        let straight = steer::Options {
            shape: Some([0.0; 2]),
            ..request.steer.clone()
        };
        family = family_of_search(&file, &straight, context)?;
        found = search(&family);
    }
    let found = found?;
    let off_if_chi_is = |share: f64| -> Result<Option<Deviation>, Error> {
        // χ has no effect in a perfect fluid.
        if !file.swimmer.is_viscous() {
            return Ok(None);
        }
        let mut other = file.clone();
        other.swimmer.chi *= share;
        other.swimmer.side_chi = other
            .swimmer
            .side_chi
            .map(|both| both.map(|chi| chi * share));
        let reached = found.reached_by(&model(&other)?, &problem.from);
        Ok(Some(found.apart_from(&reached).into()))
    };
    let steps = found.steps.iter().zip(found.gaits(&family));
    let [chains, chains_within_walls] = found.met;
    Ok(Output {
        name: file.name.clone(),
        steps: steps
            .map(|(step, cycle)| StepOutput {
                gait: found.word(step).to_owned(),
                cycles: step.cycles,
                period_s: step.period,
                scale: step.member.scale,
                file: sampled(&file, &cycle),
            })
            .collect(),
        duration_s: found.duration,
        reached: ReachedPose {
            x_m: found.reached.x,
            y_m: found.reached.y,
            heading_rad: found.reached.theta,
        },
        off_m: found.off[0],
        off_rad: found.off[1],
        off_if_chi_is_5_percent_lower: off_if_chi_is(0.95)?,
        off_if_chi_is_5_percent_higher: off_if_chi_is(1.05)?,
        chains,
        chains_within_walls,
        playlist: None,
    })
}

impl Output {
    /// Names playlist and gait files for a playlist at this path, and returns the playlist. The front end writes it, and the file of
    /// each step next to it.
    ///
    /// # Errors
    /// The path names no file.
    pub fn name_files(&mut self, path: &Path) -> Result<Playlist, Error> {
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let stem = stem.ok_or_else(|| {
            Error::refused(format!("{} names no file; give -o a name", path.display()))
        })?;
        for (number, step) in (1..).zip(&mut self.steps) {
            step.gait = format!("{stem}-{number}-{}.gait", step.gait);
        }
        self.playlist = Some(path.to_owned());
        let steps = self.steps.iter().map(StepOutput::of_playlist);
        Ok(Playlist {
            swimmer: Some(self.name.clone()),
            steps: steps.collect::<Result<_, _>>()?,
        })
    }
}

impl StepOutput {
    /// The step in a playlist next to its gait file.
    fn of_playlist(&self) -> Result<PlaylistStep, Error> {
        Ok(PlaylistStep {
            gait: GaitSpec::File {
                path: self.gait.clone().into(),
                reversed: false,
            },
            curve: AnyGait::from_file(&self.file).map_err(|error| Error::failed(&error))?,
            made_for: None,
            cycles: self.cycles,
            period: self.period_s,
        })
    }
}

/// The gaits of a folder that `optimize steer -o` wrote, as fast as servos of these rates \[rad/s\] turn.
///
/// # Errors
/// A gait is missing or cannot be read.
pub fn family_in(folder: &Path, rates: [f64; 2], files: Files) -> Result<Family, Error> {
    if files == Files::Unavailable {
        return Err(Error::refused(format!(
            "cannot read the gaits in {}: there is no file system",
            folder.display()
        )));
    }
    let read = |name| -> Result<(AnyGait, f64), Error> {
        let path = folder.join(format!("{name}.gait"));
        let curve = AnyGait::from_file(&GaitFile::load(&path)?)
            .map_err(|error| Error::refused(format!("{}: {error}", path.display())))?;
        let period = (0..curve.pieces())
            .flat_map(|piece| {
                let end = curve.piece_end(piece);
                [end - 1e-9, end + 1e-9].map(|u| curve.at(u.rem_euclid(1.0)).rate)
            })
            .map(|rate| (rate.x.abs() / rates[0]).max(rate.y.abs() / rates[1]))
            .fold(0.0, f64::max);
        Ok((curve, period))
    };
    let [forward, left, turn] = FAMILY.map(read);
    Ok(Family {
        gaits: [forward?, left?, turn?],
        mirrored: false,
    })
}

/// The gaits that [`steer`] finds.
///
/// # Errors
/// Those of the search.
pub fn family_of_search(
    file: &SwimmerFile,
    options: &steer::Options,
    context: &Context,
) -> Result<Family, Error> {
    let (steering, _) = steer::find(file, options, context)?;
    let curve = |joined: &gait_optimizer::Joined| -> Result<(AnyGait, f64), Error> {
        let curve = AnyGait::from_file(&joined.gait_file(&file.name, false));
        let curve = curve.map_err(|error| Error::failed(&error))?;
        Ok((curve, joined.period))
    };
    Ok(Family {
        gaits: [
            curve(&steering.forward)?,
            curve(&steering.left)?,
            curve(&steering.turn)?,
        ],
        mirrored: false,
    })
}

/// Samples of one cycle of a step, with its corners.
fn sampled(file: &SwimmerFile, gait: &Scaled) -> GaitFile {
    let mut ends: Vec<f64> = (0..gait.pieces())
        .filter(|&piece| gait.corner_at_end(piece))
        .map(|piece| gait.piece_end(piece))
        .filter(|end| *end < 1.0 - 1e-12)
        .collect();
    ends.insert(0, 0.0);
    let corners = ends.clone();
    ends.push(1.0);
    let (mut u, mut phi) = (Vec::new(), Vec::new());
    for pair in ends.windows(2) {
        for k in 0..SAMPLES_BETWEEN_CORNERS {
            let at = pair[0] + (pair[1] - pair[0]) * k as f64 / SAMPLES_BETWEEN_CORNERS as f64;
            u.push(at);
            phi.push(gait.at(at).phi);
        }
    }
    u.push(1.0);
    phi.extend(phi.first().copied());
    GaitFile {
        swimmer_name: Some(file.name.clone()),
        swimmer_hash: Some(SwimmerHash::of(&file.swimmer)),
        corners,
        u,
        phi,
        ..GaitFile::default()
    }
}

impl From<PlanError> for Error {
    /// Every failure is a target that no plan leads to.
    fn from(error: PlanError) -> Self {
        Self::failed(&error)
    }
}
