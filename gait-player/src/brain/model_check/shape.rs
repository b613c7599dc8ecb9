//! Equivalence relation of worlds.

use super::world::World;
use crate::TICK_US;
use crate::Transport;
use crate::brain::settings::Settings;
use crate::brain::state::State;
use crate::brain::tables::SwapWay;
use crate::brain::work::Work;

/// Aspect in which worlds are distinguished additionally. One aspect at a time: all together give too many states for the
/// search to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finer {
    Nothing,
    /// Cause of the last stop.
    Causes,
    /// Progress of a ramp or a cycle.
    Progress,
    /// Age of the last keep-alive, accumulated low-battery time, and time since the battery is well.
    Ages,
    /// Ages of the last resets.
    Resets,
    /// Settings that wait to be stored.
    Saving,
    /// Received parts of each table, with a key set.
    Keys,
    /// Presence and transport of the session; the battery is left out to limit the number of states.
    Presence,
}

impl World {
    /// Returns the equivalence class of the world.
    #[allow(clippy::too_many_lines)] // a plain list of fields
    pub(super) fn shape(&self, finer: Finer) -> Shape {
        let brain = &self.brain;
        let state = &brain.state;
        let since = |tick: u64| (brain.tick - tick) * u64::from(TICK_US);
        let bucket = |us: u64, of: u64, parts: u64| (us * parts / of.max(1)).min(parts) as u8;
        let parts = if finer == Finer::Progress { 4 } else { 2 };
        let progress = match *state {
            State::Stopped | State::EStopped | State::Holding { .. } => 0,
            State::Starting {
                ramp, since: at, ..
            }
            | State::Stopping { ramp, since: at } => {
                bucket(since(at), u64::from(ramp.duration_us()), parts)
            }
            State::Settling { since: at } => bucket(since(at), 500_000, parts),
            State::Playing { .. } => brain.last_play.map_or(0, |play| {
                let endless = play.request.cycles == 0;
                let within = bucket(u64::from(play.in_cycle_us()), 1_000_000, parts);
                if endless {
                    within
                } else {
                    within + 8 * play.cycles_done() as u8
                }
            }),
            State::Paused { since_us, .. } => bucket(self.now_us - since_us, 60_000_000, 1),
        };
        let age = |since: Option<u64>, of: u64| {
            since.map(|since| {
                bucket(
                    self.now_us - since,
                    of,
                    if finer == Finer::Ages { 2 } else { 1 },
                )
            })
        };
        let (word, resets) = (brain.resets.word(), &brain.resets);
        let aged = |shift: u32| finer == Finer::Resets && (word >> shift & 127) <= 60;
        let key = (
            brain.settings.key.is_some(),
            self.flash
                .settings
                .as_deref()
                .and_then(Settings::stored_key)
                .is_some(),
            self.seal.is_some(),
        );
        let without_key = key == (false, false, false);
        let presence = finer == Finer::Presence;
        Shape {
            state: state.name() as u8,
            cause: (finer == Finer::Causes).then_some(brain.cause as u8),
            progress,
            detached: state.detached(),
            cycles: state.play().map_or(0, |play| play.request.cycles),
            at_neutral: brain.commanded.iter().all(|angle| angle.abs() < 1e-6),
            session: (
                brain.session.number() != 0,
                brain.session.silent(self.now_us),
                finer == Finer::Ages && age(brain.session.fed_us, 460_000) == Some(0),
            ),
            present: presence.then(|| Present {
                usb: self.via == Transport::Usb,
                window: brain.bench.open(self.now_us),
                leaving: brain.bench.leaves(u64::MAX),
                passive: brain.settings.passive.is_some(),
                far: brain.settings.configuration.middle_m > 1.5 * brain.built.middle_m,
                servo: (
                    brain.settings.servos[1].reversed,
                    brain.settings.servos[1].trim,
                    brain.settings.at_bench[1].trim,
                ),
            }),
            starts: (finer == Finer::Resets)
                .then_some((brain.starts.runs.min(4), brain.resets.locked_by_starts())),
            key,
            repeat: (self.last_moves, self.asked, brain.session.kept().is_some()),
            battery: (!presence).then(|| {
                (
                    self.battery_mv,
                    brain.battery.low(),
                    brain.battery_stops,
                    (brain.battery.low_us > 0).then(|| {
                        let parts = if finer == Finer::Ages { 2 } else { 1 };
                        bucket(brain.battery.low_us, 1_000_000, parts)
                    }),
                    age(brain.battery.well_since, 5_000_000),
                )
            }),
            resets: (
                resets.estop,
                resets.wait_s().map(|left| left > 0),
                aged(17),
                aged(10),
            ),
            work: match brain.work {
                Work::Idle => 0,
                Work::Commit { follow: None, .. } => 1,
                Work::Commit {
                    follow: Some(_), ..
                } => 4,
                Work::Swap { .. } => 2,
                Work::Play { .. } => 3,
            },
            upload: (without_key || finer == Finer::Keys).then(|| Upload {
                came: brain.tables.uploaded().map(|bytes| bytes / 16),
                announced: self.begun,
                complete: brain.tables.complete(self.upload).is_ok(),
            }),
            tables: (
                brain
                    .tables
                    .swap()
                    .map(|swap| matches!(swap.way, SwapWay::Follow(_))),
                brain
                    .tables
                    .active()
                    .map(|_| brain.tables.facts().is_some()),
            ),
            unsaved: (
                finer == Finer::Saving && brain.persist.unsaved(),
                !brain.persist.table_stored(),
            ),
        }
    }
}

/// Facts that two equivalent worlds share.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[allow(clippy::struct_excessive_bools)] // facts, not states
pub(super) struct Shape {
    state: u8,
    cause: Option<u8>,
    progress: u8,
    detached: bool,
    cycles: u32,
    at_neutral: bool,
    session: (bool, bool, bool),
    present: Option<Present>,
    /// Number of short runs, and whether they lock arming.
    starts: Option<(u8, bool)>,
    /// Key set in the brain, stored in the flash, required by the open session.
    key: (bool, bool, bool),
    repeat: (bool, bool, bool),
    battery: Option<BatteryShape>,
    resets: (bool, Option<bool>, bool, bool),
    work: u8,
    upload: Option<Upload>,
    tables: (Option<bool>, Option<bool>),
    unsaved: (bool, bool),
}

/// Voltage, low, stopping because of it, time below the limit, time well.
type BatteryShape = (Option<u16>, bool, bool, Option<u8>, Option<u8>);

/// Session over USB, bench window open, boot loader requested, lengths far from those as built.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[allow(clippy::struct_excessive_bools)] // facts, not states
struct Present {
    usb: bool,
    window: bool,
    leaving: bool,
    far: bool,
    passive: bool,
    /// Direction, trim, and trim at the bench of the back servo.
    servo: (bool, i16, i16),
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Upload {
    came: Option<u16>,
    /// Announced checksum of the table; `complete` if the received bytes match it.
    announced: u32,
    complete: bool,
}
