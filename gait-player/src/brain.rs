//! The brain: a pure state machine between a link that lies and servos that obey.
//!
//! ```text
//!                       arm                   play            ramp done
//!        ┌─────────┐ ─────────► ┌─────────┐ ───────► ┌──────────┐ ───────► ┌─────────┐
//!  boot ►│ Stopped │            │ Holding │          │ Starting │          │ Playing │
//!        └─────────┘            └─────────┘          └──────────┘ ◄─────── └─────────┘
//!             ▲    arm (too)     ▲     │                  │        swap     ▲   │   │
//!             │  ┌───────────────┘     │ stop, silence,   │         resume  │   │   │ last cycle
//!      0.5 s  │  │                     │ battery          │                 │   │   │ done, stop,
//!             │  │                     ▼                  ▼                 │   ▼   ▼ silence, battery
//!       ┌──────────┐ at neutral ┌──────────┐ ◄──────────────────────── ┌────────┐ (pause)
//!       │ Settling │ ◄───────── │ Stopping │                           │ Paused │
//!       └──────────┘            └──────────┘                           └────────┘
//!
//!       any state ── e-stop ──► EStopped ── arm with clear_estop ──► Holding
//! ```
//!
//! # Glossary
//!
//! - **set-point**: the two joint angles commanded in a tick; **pulse**: what the servo map makes of them.
//! - **tick**: 20 ms, the servo period. Motion counts ticks on a grid, so a tick that comes late or early within 10 ms
//!   changes no set-point, and nothing drifts.
//! - **lease**: a link is alive for 460 ms after a valid frame of the open session; silence stops what is powered, but
//!   for a detached play of a finite number of cycles (which goes on to its end) and a detached pause (60 s).
//! - **latched**: the stopped states are left by an explicit arm only. A link or a battery that comes back, a reset, a
//!   request of an earlier session resume nothing.
//! - **active** and **staging** table: the one that plays, and the one that an upload fills. A commit checks staging and
//!   swaps: at once while nothing plays, else at the end of the cycle, by a ramp.
//! - **clamp**: the last check before the servos, the only place where angle, rate and pulse are limited.
//!
//! # Order of severity
//!
//! E-stop (at once) > low battery > silent link > end of a detached pause > Stop > end of the last cycle. Where several
//! hold, the more severe is told as [`link_protocol::StopCause`]; all but e-stop end in the same ramp.

mod actions;
mod battery;
mod config;
#[cfg(test)]
mod enumeration;
mod motion;
mod outbox;
mod persist;
mod report;
mod requests;
mod resets;
mod session;
mod settings;
mod state;
mod tables;
mod work;

pub use config::{Boot, BrainConfig, Identity, Inputs, Output};

use crate::TICK_US;
use crate::clamp::Clamp;
use crate::limits::Limits;
use crate::odometer::Odometer;
use crate::ramp::NEUTRAL;
use crate::storage::{MAX_SETTINGS, Storage};
use battery::Battery;
use link_protocol::{Counters, Decoder, StopCause};
use outbox::Outbox;
use persist::Persist;
use resets::Resets;
use session::Session;
use settings::Settings;
use state::{Progress, State};
use swimmer_model::{Model, Swimmer};
use tables::{Swap, Tables};
use work::Work;

/// The brain. About 6 kB; no heap. A clone goes on by itself from the same state: whoever replays a log tries with it what
/// may have come when.
#[derive(Clone)]
pub struct Brain {
    identity: Identity,
    boot: Boot,
    buffer: u16,
    /// The firmware's own limits, and the same tightened by the configuration.
    firmware_limits: Limits,
    limits: Limits,
    settings: Settings,
    model: Model<f32>,

    decoder: Decoder,
    session: Session,
    outbox: Outbox,
    counted: Counters,
    telemetry_sequence: u16,

    state: State,
    cause: StopCause,
    last_play: Option<Progress>,
    tables: Tables,
    work: Work,
    persist: Persist,

    battery: Battery,
    battery_stops: bool,
    resets: Resets,

    /// Time of the first tick; the grid's origin.
    origin_us: Option<u64>,
    tick: u64,
    /// What the joints were last commanded, after the clamp.
    commanded: [f32; 2],
    clamp: Clamp,
    odometer: Odometer,
    output: Output,
}

impl Brain {
    /// A brain in Stopped (or e-stopped, where a reset found it so). A configuration that the limits do not allow is
    /// replaced by the paper's robot within them.
    pub fn new(config: BrainConfig) -> Self {
        let BrainConfig {
            identity,
            limits: firmware_limits,
            configuration,
            servos,
            buffer,
            boot,
        } = config;
        let mut settings = Settings {
            configuration,
            servos,
            key: None,
        };
        let model =
            settings::check_configuration(&configuration, &firmware_limits).unwrap_or_else(|_| {
                settings.configuration = BrainConfig::robot(identity, boot.clone()).configuration;
                settings.configuration.max_angle = firmware_limits.max_angle;
                settings.configuration.max_rate = firmware_limits.max_rate;
                robot_model()
            });
        let limits = firmware_limits.tightened(&settings.configuration);
        let resets = Resets::at_start(boot.kept, boot.reset_reason);
        let (state, cause) = if resets.estop {
            (State::EStopped, StopCause::EStop)
        } else {
            (State::Stopped, StopCause::Boot)
        };
        let output = Output {
            pulses_ns: None,
            setpoint: NEUTRAL,
            led: false,
            cycle_flash: false,
            state: state.name(),
            kept: resets.word(),
            storage_wanted: false,
        };
        Self {
            session: Session::new(boot.session_seed, boot.nonce),
            identity,
            boot,
            buffer,
            firmware_limits,
            limits,
            settings,
            model,
            decoder: Decoder::new(),
            outbox: Outbox::new(),
            counted: Counters::default(),
            telemetry_sequence: 0,
            state,
            cause,
            last_play: None,
            tables: Tables::new(),
            work: Work::Idle,
            persist: Persist::new(),
            battery: Battery::default(),
            battery_stops: false,
            resets,
            origin_us: None,
            tick: 0,
            commanded: NEUTRAL,
            clamp: Clamp::new(),
            odometer: Odometer::new(),
            output,
        }
    }

    /// Takes what was stored: settings and the newest whole table, each where it can be read. Call once, before the first
    /// tick. What is not valid is as if it were not there, and is told by [`link_protocol::Flags::STORAGE_FAILED`] until
    /// something is stored again.
    ///
    /// # Errors
    /// Something stored could not be read; the brain works without.
    pub fn load<S: Storage>(&mut self, storage: &mut S) -> Result<(), S::Error> {
        let mut bytes = [0; MAX_SETTINGS];
        let stored = storage.load_settings(&mut bytes);
        let settings = stored.map(|len| {
            if let Some(len) = len
                && !self.restore(bytes.get(..len).unwrap_or_default())
            {
                self.persist.lost();
            }
        });
        let (newest, slots) = self.persist.load(storage, self.tables.buffers());
        if let Some(index) = newest {
            self.tables.activate_loaded(index);
        }
        let outcome = settings.and(slots);
        if outcome.is_err() {
            self.persist.lost();
        }
        outcome
    }

    /// Takes stored settings; false where they are none that the limits allow.
    fn restore(&mut self, bytes: &[u8]) -> bool {
        // Limits that have changed must not open the robot.
        self.settings.key = Settings::stored_key(bytes);
        let Some(settings) = Settings::decode(bytes, &self.firmware_limits) else {
            return false;
        };
        let model = settings::check_configuration(&settings.configuration, &self.firmware_limits);
        let Ok(model) = model else { return false };
        self.settings = settings;
        self.model = model;
        self.limits = self.firmware_limits.tightened(&settings.configuration);
        true
    }

    /// Takes bytes from the link: any bytes, in any split. Acts at once, but pulses change only in [`Self::tick`].
    pub fn receive(&mut self, now_us: u64, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(received) = self.decoder.push(byte) {
                let admission = self.session.admit(
                    received.header.session,
                    self.decoder.signed_bytes(),
                    received.signature.as_ref(),
                );
                self.handle(now_us, received, admission);
            }
        }
    }

    /// One servo period: decides the next pulses. Call every [`TICK_US`]; a call that comes less than half a period
    /// after the last changes nothing.
    pub fn tick(&mut self, now_us: u64, inputs: &Inputs) -> Output {
        let tick_us = u64::from(TICK_US);
        let origin_us = *self.origin_us.get_or_insert(now_us.saturating_sub(tick_us));
        let tick = now_us.saturating_sub(origin_us).saturating_add(tick_us / 2) / tick_us;
        if tick <= self.tick {
            return self.output;
        }
        let last = self.tick;
        if tick > last + 1 {
            count(&mut self.counted.late_ticks);
        }
        self.resets.up_for(now_us);
        self.battery_stops =
            self.battery
                .measure(now_us, inputs.battery_mv, self.limits.battery_limit_mv);
        // A ramp that begins here moves in this very tick: it counts from the last one.
        self.watch(now_us);
        self.advance_work();

        self.tick = tick;
        let first_start =
            matches!(self.state, State::Starting { play, .. } if play.elapsed_us == 0);
        let wanted = self.advance_motion(tick, last);
        let pulses_ns = wanted.map(|wanted| self.command(wanted));
        if pulses_ns.is_none() {
            self.clamp.off();
        }
        if first_start && matches!(self.state, State::Playing { .. }) {
            self.odometer.reset();
        }
        self.output = Output {
            pulses_ns,
            setpoint: self.commanded,
            led: self.led(),
            cycle_flash: self.cycle_flash(),
            state: self.state.name(),
            kept: self.resets.word(),
            storage_wanted: self.state == State::Stopped && self.persist.wanted(now_us),
        };
        self.outbox.tick();
        if inputs.link_up {
            self.send_telemetry(now_us);
        } else {
            self.outbox.clear();
        }
        self.output
    }

    /// Through the clamp to the pulses, with the swimmer following.
    fn command(&mut self, wanted: [f32; 2]) -> [u32; 2] {
        let clamped = self
            .clamp
            .apply(wanted, &self.settings.maps(), &self.limits);
        if clamped.cut.is_some() {
            count(&mut self.counted.clamped);
        }
        let commanded = clamped.cut.unwrap_or(wanted);
        self.odometer.step(&self.model, self.commanded, commanded);
        self.commanded = commanded;
        clamped.pulses_ns
    }

    /// [`Output::kept`] as it is now: an e-stop that was just received is in it before its answer is sent.
    pub fn kept(&self) -> u32 {
        self.resets.word()
    }

    /// Takes bytes to be sent; returns how many.
    pub fn transmit(&mut self, out: &mut [u8]) -> usize {
        self.outbox.take(out)
    }

    /// One bounded step of storing what is not stored yet (an erase, a page, the settings); nothing unless Stopped.
    ///
    /// # Errors
    /// The storage's; the step is tried again a second later.
    pub fn serve_storage<S: Storage>(
        &mut self,
        now_us: u64,
        storage: &mut S,
    ) -> Result<(), S::Error> {
        if self.state != State::Stopped || !self.persist.wanted(now_us) {
            return Ok(());
        }
        let mut bytes = [0; MAX_SETTINGS];
        let settings = self
            .settings
            .encode(&mut bytes)
            .map_or(&[][..], |bytes| bytes);
        self.persist
            .step(now_us, storage, self.tables.active(), settings)
    }
}

/// The paper's robot: a swimmer that is valid whatever was configured.
fn robot_model() -> Model<f32> {
    let robot = Swimmer::robot();
    match Model::new(&robot) {
        Ok(model) => model,
        // The presets of the model are valid swimmers: its own tests hold them to it.
        Err(_) => unreachable!("the paper's robot is a valid swimmer"),
    }
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
