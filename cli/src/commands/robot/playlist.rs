//! `swimmer robot play --playlist`: gaits one after the other without a pause. All of it is held against the robot's limits, the
//! link and the tank before the first pulse.

use std::fmt;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use forecast::playlist::{self, PlaylistTable, Repeated};
use host_link::robot::{Leg, Sequence};
use host_link::{LinkError, Port as _};
use link_protocol::{Checked, Configuration, Flags, Status, crc32c};
use serde::Serialize;
use swimmer_files::{Playlist, SwimmerFile};
use swimmer_model::{Model, Pose};

use super::Play;
use super::access::{Access, RobotConnection};
use super::outputs::{cause, state};
use super::passive;
use super::playing::duration;
use super::port::Pace;
use super::preflight::{Player, TankOptions};
use super::rest::{nothing_under_way, ready, stopped_on_failure, wait_for_rest};
use super::upload::{MadeFor, send_table};
use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity;

/// Result of a playlist.
#[derive(Debug, Serialize)]
struct PlayedOutput {
    state: &'static str,
    cause: &'static str,
    /// Steps of the playlist, all played.
    steps: usize,
    /// Tables that were sent for them.
    tables: usize,
    duration_s: f64,
    /// Predicted final pose, in the frame of the middle link at the start.
    foretold: Foretold,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Foretold {
    x_m: f64,
    y_m: f64,
    rotation_rad: f64,
}

impl fmt::Display for PlayedOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Played {} steps in {}; the robot is {} ({}).",
            self.steps,
            duration(self.duration_s),
            self.state,
            self.cause
        )
    }
}

impl fmt::Display for Foretold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "({}, {}), turned by {}",
            quantity::length(self.x_m),
            quantity::length(self.y_m),
            quantity::angle(self.rotation_rad)
        )
    }
}

/// Plays it to its end.
pub(super) fn play(
    access: &Access,
    play: &Play,
    path: &Path,
    interrupt: &Interrupt,
    output: Output,
) -> Outcome {
    let playlist = Playlist::load(path)?;
    let owner = play.owner.swimmer.as_deref();
    let file = owner.map(load_swimmer).transpose()?;
    let tables = tables(&playlist, path)?;
    let mut line = access.connect("swimmer robot play", Pace::AsFastAsPossible)?;
    line.stops_on(interrupt);
    let status = line.robot.status()?;
    nothing_under_way(&status)?;
    let settings_crc32 = status.settings_crc32;
    let configuration = line.robot.configuration()?;
    if !play.owner.force {
        made_for_it(&playlist, &configuration, file.as_ref())?;
    }
    // A playlist drives both joints.
    passive::agree(
        &mut line,
        &path.display().to_string(),
        None,
        play.owner.force,
    )?;
    let player = Player::of_robot(line.robot.info(), &configuration, file.as_ref());
    let foretold = preflight(&tables, &player, &play.room)?;
    in_time(&tables, &line, None)?;
    output.line(&format!(
        "Playing {} steps in {}, which lead to {foretold} from the start. Ctrl-C stops.",
        playlist.steps.len(),
        duration(playlist.duration())
    ));
    if let Some(first) = tables.first() {
        let name = playlist.steps[0].gait.readable();
        let begun = line.robot.port().now();
        send_table(&mut line, &name, &first.table, interrupt)?;
        let took = line.robot.port().now().saturating_sub(begun);
        let measured = Sending {
            bytes: first.table.bytes().len(),
            took,
        };
        in_time(&tables, &line, Some(measured))?;
    }
    let status = through(&mut line, &tables, settings_crc32, interrupt)?;
    let status = ready(&mut line, status);
    output.print(&PlayedOutput {
        state: state(status.state),
        cause: cause(status.cause),
        steps: playlist.steps.len(),
        tables: tables.len(),
        duration_s: playlist.duration(),
        foretold,
    });
    line.close()
}

fn tables(playlist: &Playlist, path: &Path) -> Outcome<Vec<PlaylistTable>> {
    let steps: Vec<_> = playlist
        .steps
        .iter()
        .map(|step| Repeated {
            gait: &step.curve,
            cycles: step.cycles,
            period: step.period,
        })
        .collect();
    playlist::tables(&steps).map_err(|error| {
        Failure::BadInput(format!(
            "the gaits of {} make no tables for the robot: {error}",
            path.display()
        ))
    })
}

fn made_for_it(
    playlist: &Playlist,
    configuration: &Configuration,
    named: Option<&SwimmerFile>,
) -> Outcome {
    for step in &playlist.steps {
        if let Some((name, hash)) = &step.made_for {
            let made_for = MadeFor {
                name: name.clone().unwrap_or_else(|| "another swimmer".into()),
                hash: *hash,
            };
            made_for.check(&step.gait.readable(), configuration, named)?;
        }
    }
    Ok(())
}

/// Checks of limits, rates and walls, and the final pose.
fn preflight(tables: &[PlaylistTable], player: &Player, room: &TankOptions) -> Outcome<Foretold> {
    let swimmer = &player.swimmer;
    let model = Model::new(swimmer).map_err(|error| {
        Failure::BadInput(format!(
            "the swimmer `{}` cannot swim: {error}",
            player.name
        ))
    })?;
    if let Some((step, reason)) = playlist::refused(tables, &player.servos, &swimmer.links) {
        return Err(Failure::Tried(format!(
            "step {} of the playlist, or what goes with it: the robot would refuse it: {reason}",
            step + 1
        )));
    }
    let way = playlist::played(tables, &player.servos);
    if let Some(tank) = &room.tank
        && let Some(meeting) = forecast::meets_wall(&model, &way, tank, &room.start())
    {
        let whole: f64 = tables.iter().map(PlaylistTable::duration).sum();
        return Err(Failure::Tried(format!(
            "{} would meet a wall of the tank after about {}, {:.0} mm along and {:.0} mm across from the centre; start \
             elsewhere (--start, --heading), or plan again with --tank",
            meeting.part.word(),
            duration(meeting.cycles * whole),
            meeting.at.x * 1e3,
            meeting.at.y * 1e3
        )));
    }
    let Pose { x, y, theta } = playlist::leads_to(&model, &way);
    Ok(Foretold {
        x_m: x,
        y_m: y,
        rotation_rad: theta,
    })
}

/// Upload of a table over this link, as it went.
#[derive(Debug, Clone, Copy)]
struct Sending {
    bytes: usize,
    took: Duration,
}

/// Share by which a later upload may be slower than the one that was measured.
const SLOWER: f64 = 1.25;

/// Refuses a playlist of which a table would arrive after the end of the one before. The expectation of a link without faults
/// comes first; once a table was sent, its upload shows what this link carries.
fn in_time(tables: &[PlaylistTable], line: &RobotConnection, measured: Option<Sending>) -> Outcome {
    for pair in tables.windows(2) {
        let bytes = pair[1].table.bytes().len();
        let expected = line.robot.expected_upload_while_playing(bytes);
        let takes = measured.map_or(expected, |sending| {
            let checked = expected.saturating_sub(line.robot.expected_upload(bytes));
            let share = bytes as f64 / sending.bytes.max(1) as f64;
            expected.max(checked + sending.took.mul_f64(SLOWER * share))
        });
        if takes.as_secs_f64() > pair[0].duration() {
            return Err(Failure::Tried(format!(
                "step {} of the playlist is over after {:.1} s, and sending the next over this link takes about {:.1} s; \
                 give it more cycles",
                pair[0].step + 1,
                pair[0].duration(),
                takes.as_secs_f64()
            )));
        }
    }
    Ok(())
}

/// From the first pulse to the end of the last cycle; Ctrl-C and failures stop the robot.
fn through(
    line: &mut RobotConnection,
    tables: &[PlaylistTable],
    settings_crc32: u32,
    interrupt: &Interrupt,
) -> Outcome<Status> {
    let legs: Vec<Leg> = tables
        .iter()
        .map(|table| Leg {
            table: table.table.bytes().to_vec(),
            cycles: table.cycles,
            period: Duration::from_micros(table.period_us.into()),
        })
        .collect();
    let Some(first) = legs.first() else {
        return Err(Failure::BadInput("an empty playlist".to_owned()));
    };
    let (cycles, period, count) = (first.cycles, first.period, legs.len());
    let checked = Checked {
        table_crc32: crc32c(&first.table),
        settings_crc32,
    };
    match line.robot.arm(false) {
        // Nothing was powered by this, and what the robot does instead is not ours to stop.
        Err(refused @ LinkError::Refused { .. }) => return Err(refused.into()),
        armed => stopped_on_failure(&mut line.robot, armed)?,
    }
    let begun = line.robot.play_checked(cycles, period, false, checked);
    stopped_on_failure(&mut line.robot, begun)?;
    let mut sequence = Sequence::playing_first(legs, settings_crc32);
    let progress = Progress::with_share("");
    loop {
        let (robot, holder) = line.split();
        let gone_on = sequence.go_on(robot, |now| {
            if let Some(telemetry) = now.telemetry {
                let next = if telemetry.flags.contains(Flags::SWAP_PENDING) {
                    ", the next waits"
                } else {
                    ""
                };
                progress.doing(format!(
                    "table {} of {count}: cycle {} of {}{next}",
                    now.leg + 1,
                    telemetry.cycle + 1,
                    telemetry.cycles
                ));
                progress.at_share((now.leg as f64) / count as f64);
            }
            if interrupt.requested() || holder.asked() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match stopped_on_failure(robot, gone_on)? {
            Some(status) => return Ok(status),
            None if interrupt.requested() => {
                robot.stop()?;
                wait_for_rest(robot)?;
                return Err(Failure::Tried(format!(
                    "{}: the robot was stopped before the end of the playlist",
                    interrupt.pressed()
                )));
            }
            None => holder.serve(robot),
        }
    }
}
