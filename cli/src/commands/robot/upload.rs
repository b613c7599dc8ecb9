//! `swimmer robot upload`: a gait as a table of knots, sent and checked by the robot.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::{LinkError, Port as _};
use link_protocol::{Configuration, Joint, MAX_KNOTS, TableInfo};
use serde::Serialize;
use swimmer_files::{AnyGait, GaitFile, GaitSpec, GaitSpring, SwimmerFile, SwimmerHash};
use twin::is_configured_as;

use super::access::{Access, RobotConnection};
use super::outputs::{Gait, print_refusal};
use super::passive;
use super::port::Pace;
use super::preflight::{Player, Preflight};
use super::{Owner, Upload, preflight};
use crate::arguments::{load_gait, load_swimmer};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};
use crate::progress::Progress;

/// An upload over a link that loses frames may take this long.
const PATIENCE: Duration = Duration::from_mins(2);

/// Gait that the robot holds now.
#[derive(Debug, Serialize)]
pub(super) struct Uploaded {
    #[serde(flatten)]
    gait: Gait,
    bytes: usize,
    seconds: f64,
    /// Predicted duration of the upload.
    predicted_seconds: f64,
    /// `null` for a gait without a prediction.
    preflight: Option<Preflight>,
    #[serde(skip)]
    name: String,
}

impl fmt::Display for Uploaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Uploaded {}: {} knots in {:.2} s, CRC {}; a cycle takes at least {:.2} s.",
            self.name, self.gait.knots, self.seconds, self.gait.crc32, self.gait.min_period_s
        )
    }
}

/// A pre-flight alone.
#[derive(Debug, Serialize)]
struct Foretold {
    preflight: Preflight,
}

impl fmt::Display for Foretold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.preflight)
    }
}

/// `swimmer robot upload`.
pub(super) fn run(access: &Access, arguments: &Upload, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    arguments.preflight.check()?;
    let gait = Prepared::new(&arguments.gait)?;
    let file = arguments
        .owner
        .swimmer
        .as_deref()
        .map(load_swimmer)
        .transpose()?;
    if arguments.dry_run && !access.names_a_port() {
        let Some(file) = &file else {
            return Err(Failure::BadInput(
                "name the swimmer that shall play the gait: --swimmer, or --port of a robot"
                    .to_owned(),
            ));
        };
        return forecast_only(arguments, &gait, &Player::of_file(file), output);
    }
    let mut line = access.connect("swimmer robot upload", Pace::AsFastAsPossible)?;
    let configuration = line.robot.configuration()?;
    let player = Player::of_robot(line.robot.info(), &configuration, file.as_ref());
    if !arguments.owner.force {
        gait.check_swimmer(&configuration, file.as_ref())?;
    }
    if !arguments.dry_run {
        passive::agree(&mut line, &gait.name, gait.passive(), arguments.owner.force)?;
    }
    if let Some(file) = file.filter(|file| !is_configured_as(&configuration, &file.swimmer)) {
        aside(&format!(
            "note: the robot is configured as another swimmer than `{}`, which --swimmer names and this forecast is for; send it with `swimmer robot configure`, or leave --swimmer out",
            file.name
        ));
    }
    if arguments.dry_run {
        forecast_only(arguments, &gait, &player, output)?;
        return line.close();
    }
    let preflight =
        match arguments
            .preflight
            .foretell(&gait.name, &gait.gait, gait.spring.as_ref(), &player)
        {
            Ok(preflight) => {
                output.line(&preflight.to_string());
                Some(preflight)
            }
            Err(Failure::Tried(reason)) => {
                // The robot has the last word, and will say it.
                aside(&format!("No forecast is possible: {reason}."));
                None
            }
            Err(failure) => return Err(failure),
        };
    let force = arguments.owner.force;
    output.print(&send_forecast(
        &mut line, gait, preflight, force, &interrupt,
    )?);
    line.close()
}

/// Uploads a gait with its forecast. `force` uploads what must not be played.
fn send_forecast(
    line: &mut RobotConnection,
    gait: Prepared,
    preflight: Option<Preflight>,
    force: bool,
    interrupt: &Interrupt,
) -> Outcome<Uploaded> {
    // The robot itself refuses the problems that it can detect.
    let unseen = preflight
        .as_ref()
        .and_then(|forecast| forecast.unseen_by_robot.as_ref());
    if let Some(reason) = unseen.filter(|_| !force) {
        return Err(Failure::Tried(format!(
            "{} must not be played: {reason}; --force uploads it all the same",
            gait.name
        )));
    }
    let bytes = gait.table.bytes().len();
    let predicted = line.robot.expected_upload(bytes);
    let begun = line.robot.port().now();
    let info = send(line, &gait, interrupt)?;
    let seconds = line.robot.port().now().saturating_sub(begun).as_secs_f64();
    Ok(Uploaded {
        gait: Gait::new(&info),
        bytes,
        seconds,
        predicted_seconds: predicted.as_secs_f64(),
        preflight,
        name: gait.name,
    })
}

/// Checks, forecasts and uploads a gait. `swimmer` is the robot's, if no preset describes it.
///
/// # Errors
/// [`Failure::Tried`] if the gait is another swimmer's or must not be played, and the link's.
pub(super) fn upload(
    line: &mut RobotConnection,
    gait: Prepared,
    swimmer: Option<&SwimmerFile>,
    period_s: f64,
    interrupt: &Interrupt,
) -> Outcome<Uploaded> {
    let configuration = line.robot.configuration()?;
    gait.check_swimmer(&configuration, swimmer)?;
    passive::agree(line, &gait.name, gait.passive(), false)?;
    let player = Player::of_robot(line.robot.info(), &configuration, swimmer);
    let forecast = preflight::Arguments::at_period(period_s);
    let preflight = forecast.foretell(&gait.name, &gait.gait, gait.spring.as_ref(), &player)?;
    send_forecast(line, gait, Some(preflight), false, interrupt)
}

/// `--dry-run`: exit status 1 if the gait must not be played.
fn forecast_only(arguments: &Upload, gait: &Prepared, player: &Player, output: Output) -> Outcome {
    let preflight =
        arguments
            .preflight
            .foretell(&gait.name, &gait.gait, gait.spring.as_ref(), player)?;
    let refused = preflight.refusal();
    let refused = refused.map(|reason| format!("{} must not be played: {reason}", gait.name));
    let foretold = Foretold { preflight };
    if let Some(reason) = refused {
        return print_refusal(output, &foretold, reason);
    }
    output.print(&foretold);
    Ok(())
}

/// The gait of a play, read before any robot is met.
pub(super) struct BeforePlay {
    gait: Prepared,
    file: Option<SwimmerFile>,
    force: bool,
}

impl BeforePlay {
    /// Reads the gait, and the swimmer whose it is.
    ///
    /// # Errors
    /// [`Failure::BadInput`].
    pub(super) fn new(gait: &GaitSpec, owner: &Owner) -> Outcome<Self> {
        Ok(Self {
            gait: Prepared::new(gait)?,
            file: owner.swimmer.as_deref().map(load_swimmer).transpose()?,
            force: owner.force,
        })
    }

    /// Refuses a gait that was made for another swimmer than the robot is configured for.
    ///
    /// # Errors
    /// [`Failure::Tried`].
    pub(super) fn check(&self, configuration: &Configuration) -> Outcome {
        if self.force {
            return Ok(());
        }
        self.gait.check_swimmer(configuration, self.file.as_ref())
    }

    /// Returns `true` if the gait leaves a joint to a spring.
    pub(super) fn has_passive_joint(&self) -> bool {
        self.gait.passive().is_some()
    }

    /// Name and table of the gait.
    pub(super) fn table(&self) -> (&str, &GaitTable) {
        (&self.gait.name, &self.gait.table)
    }

    /// Uploads it; returns the checksum of its table.
    ///
    /// # Errors
    /// [`Failure::Tried`] if it is another swimmer's or the robot refuses it, and the link's.
    pub(super) fn send(&self, line: &mut RobotConnection, interrupt: &Interrupt) -> Outcome<u32> {
        if !self.force {
            self.check(&line.robot.configuration()?)?;
        }
        passive::agree(line, &self.gait.name, self.gait.passive(), self.force)?;
        send(line, &self.gait, interrupt)?;
        Ok(self.gait.table.crc32())
    }
}

/// A gait ready to be sent.
pub(super) struct Prepared {
    name: String,
    gait: AnyGait,
    table: GaitTable,
    /// Swimmer that the gait was made for, if its file states one.
    made_for: Option<MadeFor>,
    /// Passive joint that its file names.
    spring: Option<GaitSpring>,
}

/// Swimmer that a gait file states.
pub(super) struct MadeFor {
    pub(super) name: String,
    pub(super) hash: SwimmerHash,
}

impl Prepared {
    fn new(spec: &GaitSpec) -> Outcome<Self> {
        let file = match spec {
            GaitSpec::File { path, .. } => GaitFile::load(path)?,
            GaitSpec::Circle { .. } | GaitSpec::Square { .. } => GaitFile::default(),
        };
        Self::of_file(spec.readable(), load_gait(spec)?, &file)
    }

    /// A curve with the swimmer and the spring that its file names.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a curve that makes no table.
    pub(super) fn of_file(name: String, gait: AnyGait, file: &GaitFile) -> Outcome<Self> {
        let table = table_of(&gait).map_err(|error| {
            Failure::BadInput(format!(
                "the gait {name} makes no table for the robot: {error}"
            ))
        })?;
        let made_for = file.swimmer_hash.map(|hash| MadeFor {
            name: file
                .swimmer_name
                .clone()
                .unwrap_or_else(|| "another swimmer".into()),
            hash,
        });
        Ok(Self {
            name,
            gait,
            table,
            made_for,
            spring: file.passive,
        })
    }

    /// The joint that the gait leaves to a spring.
    fn passive(&self) -> Option<Joint> {
        self.spring.map(|spring| spring.joint.0)
    }

    fn check_swimmer(&self, configuration: &Configuration, named: Option<&SwimmerFile>) -> Outcome {
        match &self.made_for {
            Some(made_for) => made_for.check(&self.name, configuration, named),
            None => Ok(()),
        }
    }
}

impl MadeFor {
    /// Checks that the robot is the swimmer that the gait was made for, as far as its configuration shows.
    ///
    /// The robot knows its body in single precision, the gait file names the swimmer by a fingerprint: so the swimmer that
    /// both may mean is looked for among the presets and the one that the operator names.
    pub(super) fn check(
        &self,
        gait: &str,
        configuration: &Configuration,
        named: Option<&SwimmerFile>,
    ) -> Outcome {
        let presets = SwimmerFile::PRESETS
            .iter()
            .filter_map(|name| SwimmerFile::preset(name));
        let known = presets
            .chain(named.cloned())
            .any(|file| file.hash() == self.hash && is_configured_as(configuration, &file.swimmer));
        if known {
            return Ok(());
        }
        Err(Failure::Tried(format!(
            "the gait {gait} was made for `{}`, and nothing shows that this robot is that swimmer; name its file with --swimmer \
             and send it with `swimmer robot configure` (a twin takes it as `--port twin:FILE`), or upload anyway with --force",
            self.name
        )))
    }
}

/// The gait as the robot holds it: as many knots as fit, so that the interpolation adds nothing.
pub(crate) fn table_of(gait: &AnyGait) -> Result<GaitTable, gait_player::table::TableError> {
    forecast::table(gait, MAX_KNOTS)
}

fn send(line: &mut RobotConnection, gait: &Prepared, interrupt: &Interrupt) -> Outcome<TableInfo> {
    send_table(line, &gait.name, &gait.table, interrupt)
}

/// Uploads a table, which becomes the active one.
///
/// # Errors
/// The link's, and the robot's refusal.
pub(super) fn send_table(
    line: &mut RobotConnection,
    name: &str,
    table: &GaitTable,
    interrupt: &Interrupt,
) -> Outcome<TableInfo> {
    let bytes = table.bytes();
    let progress = Progress::of_bytes(bytes.len() as u64);
    let time = line.robot.expected_upload(bytes.len());
    progress.doing(format!(
        "uploading {name}, about {:.1} s",
        time.as_secs_f64()
    ));
    loop {
        let (robot, holder) = line.split();
        let sent = robot.upload(bytes, PATIENCE, |step| {
            progress.at(step.done as u64);
            if interrupt.requested() || holder.asked() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match sent {
            // A request of another process: the upload continues.
            Err(LinkError::Interrupted { .. }) if !interrupt.requested() => holder.serve(robot),
            sent => return Ok(sent?),
        }
    }
}
