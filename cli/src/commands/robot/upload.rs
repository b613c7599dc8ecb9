//! `swimmer robot upload`: a gait as a table of knots, sent and checked by the robot.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::{LinkError, Port as _, Robot};
use link_protocol::{MAX_KNOTS, TableInfo};
use serde::Serialize;
use swimmer_files::{AnyGait, GaitFile, GaitSpec, SwimmerFile, SwimmerHash};
use swimmer_model::Gait as _;

use super::access::{Access, Line};
use super::answers::Gait;
use super::configure::is_configured_as;
use super::port::{AnyPort, Pace};
use super::{Owner, Upload};
use crate::arguments::{load_gait, load_swimmer};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity;

/// An upload over a link that loses frames may take this long.
const PATIENCE: Duration = Duration::from_mins(2);

#[derive(Debug, Serialize)]
struct Uploaded {
    #[serde(flatten)]
    gait: Gait,
    bytes: usize,
    seconds: f64,
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

/// `swimmer robot upload`.
pub(super) fn run(access: &Access, arguments: &Upload, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let gait = Prepared::new(&arguments.gait)?;
    let mut line = access.connect("swimmer robot upload", Pace::AsFastAsPossible)?;
    arguments.owner.check(&gait, &mut line.robot)?;
    let begun = line.robot.port().now();
    let info = send(&mut line, &gait, &interrupt)?;
    let seconds = line.robot.port().now().saturating_sub(begun).as_secs_f64();
    let bytes = gait.table.bytes().len();
    output.answer(&Uploaded {
        gait: Gait::new(&info),
        bytes,
        seconds,
        name: gait.name,
    });
    line.close()
}

/// Uploads the gait of a play.
pub(super) fn before_play(
    line: &mut Line,
    gait: &GaitSpec,
    owner: &Owner,
    interrupt: &Interrupt,
) -> Outcome {
    let gait = Prepared::new(gait)?;
    owner.check(&gait, &mut line.robot)?;
    send(line, &gait, interrupt)?;
    Ok(())
}

impl Owner {
    fn check(&self, gait: &Prepared, robot: &mut Robot<AnyPort>) -> Outcome {
        if self.force {
            return Ok(());
        }
        let named = self.swimmer.as_deref().map(load_swimmer).transpose()?;
        gait.check_swimmer(robot, named.as_ref())
    }
}

/// A gait ready to be sent.
struct Prepared {
    name: String,
    table: GaitTable,
    /// Where the gait comes from a file that says so: whose it is.
    made_for: Option<MadeFor>,
}

struct MadeFor {
    name: String,
    hash: SwimmerHash,
}

impl Prepared {
    fn new(spec: &GaitSpec) -> Outcome<Self> {
        let made_for = match spec {
            GaitSpec::File { path, .. } => {
                let file = GaitFile::load(path)?;
                file.swimmer_hash.map(|hash| MadeFor {
                    name: file
                        .swimmer_name
                        .unwrap_or_else(|| "another swimmer".into()),
                    hash,
                })
            }
            GaitSpec::Circle { .. } | GaitSpec::Square { .. } => None,
        };
        let table = table_of(&load_gait(spec)?).map_err(|error| {
            Failure::BadInput(format!(
                "the gait {} makes no table for the robot: {error}",
                quantity::gait(spec)
            ))
        })?;
        Ok(Self {
            name: quantity::gait(spec),
            table,
            made_for,
        })
    }

    /// Whether the robot is the swimmer that the gait was made for, as far as its configuration tells.
    ///
    /// The robot knows its body in single precision, the gait file names the swimmer by a fingerprint: so the swimmer that
    /// both may mean is looked for among the presets and the one that the operator names.
    fn check_swimmer(&self, robot: &mut Robot<AnyPort>, named: Option<&SwimmerFile>) -> Outcome {
        let Some(made_for) = &self.made_for else {
            return Ok(());
        };
        let configuration = robot.configuration()?;
        let presets = SwimmerFile::PRESETS
            .iter()
            .filter_map(|name| SwimmerFile::preset(name));
        let known = presets.chain(named.cloned()).any(|file| {
            file.hash() == made_for.hash && is_configured_as(&configuration, &file.swimmer)
        });
        if known {
            return Ok(());
        }
        Err(Failure::Tried(format!(
            "the gait {} was made for `{}`, and nothing shows that this robot is that swimmer; name its file with --swimmer \
             and send it with `swimmer robot configure`, or upload anyway with --force",
            self.name, made_for.name
        )))
    }
}

/// The gait as the robot holds it: as many knots as fit, so that the interpolation adds nothing.
pub(crate) fn table_of(gait: &AnyGait) -> Result<GaitTable, gait_player::table::TableError> {
    GaitTable::from_fn(MAX_KNOTS, |u| {
        let phi = gait.at(u).phi;
        [phi.x, phi.y]
    })
}

fn send(line: &mut Line, gait: &Prepared, interrupt: &Interrupt) -> Outcome<TableInfo> {
    let bytes = gait.table.bytes();
    let progress = Progress::of_bytes(bytes.len() as u64);
    progress.doing(format!("uploading {}", gait.name));
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
            // Another process asks; the upload goes on where it was.
            Err(LinkError::Interrupted { .. }) if !interrupt.requested() => holder.serve(robot),
            sent => return Ok(sent?),
        }
    }
}
