//! Brain: the robot's state machine. It reads an unreliable link and drives the servos, without I/O of its own (sans-IO).
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
//!       any state ── e-stop ──► EStopped ── clear e-stop ──► Stopped
//! ```
//!
//! # Glossary
//!
//! - **set-point**: the two joint angles commanded in a tick; **pulse**: the servo map applied to a set-point.
//! - **tick**: 20 ms, the servo period. Motion counts ticks on a grid. A tick that comes up to 10 ms early or late changes no
//!   set-point, and nothing drifts.
//! - **lease**: a link is alive for 460 ms after a fresh keep-alive of the open session. Silence stops a powered robot. Two
//!   exceptions: a detached play of a finite number of cycles plays to its end, and a detached pause lasts 60 s.
//! - **fresh**: the host received a frame of the robot at most one second ago, later than at any keep-alive before. Only a
//!   fresh keep-alive renews the lease. Requests that power the servos are refused if the lease has run out, so buffered bytes
//!   of a dead host have no effect.
//! - **transport**: UART or USB, each with its own decoder and outbox. The session belongs to the transport of the last
//!   greeting.
//! - **presence**: a person is at the robot. Either the request came over USB, or the **bench window** is open: two minutes
//!   from when the jumper closes. A first key, lengths and limits beyond those as built, and the boot loader require it.
//! - **latched**: only an explicit arm leaves a stopped state. A returning link or battery, a reset, or a request of an earlier
//!   session resumes nothing.
//! - **active** and **staging** table: the table that plays, and the table that an upload fills. A commit checks the staging
//!   table and swaps: at once if nothing plays, otherwise at the end of the cycle, by a ramp.
//! - **passive joint**: a spring holds it in place of a servo. Its output stays low in every state.
//! - **clamp**: the last check before the servos, and the only place that limits angle, rate and pulse.
//!
//! # Order of severity
//!
//! E-stop (at once) > low battery > silent link > end of a detached pause > Stop > end of the last cycle. If several apply, the
//! most severe is reported as [`link_protocol::StopCause`]. All except e-stop end in the same ramp.

mod actions;
mod battery;
mod bench;
mod config;
#[cfg(test)]
mod model_check;
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

pub use config::{Boot, BrainConfig, Identity, Inputs, Output, Transport};

use crate::clamp::Clamp;
use crate::limits::Limits;
use crate::odometer::Odometer;
use crate::ramp::NEUTRAL;
use crate::storage::{MAX_SETTINGS, Storage};
use crate::{ShortStarts, TICK_US};
use battery::Battery;
use bench::Bench;
use link_protocol::{Configuration, Counters, Decoder, Joint, StopCause};
use outbox::Outbox;
use persist::Persist;
use resets::Resets;
use session::Session;
use settings::Settings;
use state::{Progress, State};
use swimmer_model::{Model, Swimmer};
use tables::Tables;
use work::Work;

/// State machine of the robot. About 7 kB, without heap. A clone continues independently from the same state, so a log replay
/// can try several arrival times.
#[derive(Clone)]
pub struct Brain {
    identity: Identity,
    boot: Boot,
    buffer: u16,
    /// The firmware's own limits, and those limits tightened by the configuration.
    firmware_limits: Limits,
    limits: Limits,
    /// The configuration as built.
    built: Configuration,
    settings: Settings,
    model: Model<f32>,

    /// One decoder per transport.
    decoders: [Decoder; 2],
    session: Session,
    outboxes: [Outbox; 2],
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
    /// E-stops since the start. A latch restored after a reset counts as one.
    estops: u32,
    /// Record of short starts to store, including the present run.
    starts: ShortStarts,
    bench: Bench,

    /// Time of the first tick: the origin of the tick grid.
    origin_us: Option<u64>,
    tick: u64,
    /// Last commanded joint angles, after the clamp.
    commanded: [f32; 2],
    clamp: Clamp,
    odometer: Odometer,
    output: Output,
}

impl Brain {
    /// Returns a brain in Stopped, or in e-stop if a reset preserved the latch. A configuration outside the limits is replaced
    /// by the paper's robot within them.
    #[inline] // builds the value in place: the chip's stack cannot hold several copies
    pub fn new(config: BrainConfig) -> Self {
        let BrainConfig {
            identity,
            limits: firmware_limits,
            configuration,
            servos,
            passive,
            buffer,
            boot,
        } = config;
        let mut settings = Settings {
            configuration,
            servos,
            at_bench: servos,
            ranges: [None; 2],
            key: None,
            passive,
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
            starts: ShortStarts::default(),
            boot_loader: false,
        };
        let before = boot.starts.unwrap_or_default();
        let mut brain = Self {
            session: Session::new(boot.session_seed, boot.nonce),
            identity,
            boot,
            buffer,
            firmware_limits,
            limits,
            built: settings.configuration,
            settings,
            model,
            decoders: [const { Decoder::new() }; 2],
            outboxes: [const { Outbox::new() }; 2],
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
            estops: u32::from(resets.estop),
            resets,
            starts: ShortStarts::default(),
            bench: Bench::default(),
            origin_us: None,
            tick: 0,
            commanded: NEUTRAL,
            clamp: Clamp::new(),
            odometer: Odometer::new(),
            output,
        };
        brain.count_start(before);
        brain
    }

    /// Adds this start to the count of short starts. Too many of them lock arming, as three resets do.
    fn count_start(&mut self, before: ShortStarts) {
        self.starts = before.start();
        self.output.starts = self.starts;
        if before.runs >= ShortStarts::MOST {
            self.resets.lock();
            self.output.kept = self.resets.word();
            if self.boot.crash_message.is_empty() {
                self.boot.crash_message = BROWN_OUT.try_into().unwrap_or_default();
            }
        }
    }

    /// Resets the count of short starts: this run is not a short one.
    fn clear_starts(&mut self) {
        if self.starts.runs > 0 {
            self.starts = ShortStarts::default();
            self.persist.starts_changed(self.starts);
        }
    }

    /// Restores settings, the newest valid table and the count of short starts, and stores the count with this start. Call it
    /// once, before the first tick. Invalid records count as missing; [`link_protocol::Flags::STORAGE_FAILED`] reports them
    /// until a record is stored again.
    ///
    /// # Errors
    /// A record could not be read. The brain works without it.
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
        outcome.and(self.load_starts(storage))
    }

    /// Merges the records of RAM and storage. RAM is newer; both must count this start before it can end.
    fn load_starts<S: Storage>(&mut self, storage: &mut S) -> Result<(), S::Error> {
        let mut bytes = [0; ShortStarts::LEN];
        if self.boot.starts.is_none()
            && storage.load_starts(&mut bytes)?
            && let Some(before) = ShortStarts::decode(&bytes)
        {
            self.count_start(before);
        }
        storage.save_starts(&self.starts.encode())
    }

    /// Restores stored settings. Returns false if they are invalid under the limits.
    fn restore(&mut self, bytes: &[u8]) -> bool {
        // The key is kept even if changed limits invalidate the rest; otherwise the robot would lose its protection.
        self.settings.key = Settings::stored_key(bytes);
        let Some(settings) = Settings::decode(bytes, &self.firmware_limits) else {
            return false;
        };
        let model = settings::check_configuration(&settings.configuration, &self.firmware_limits);
        let Ok(model) = model else { return false };
        self.settings = settings;
        self.model = model;
        self.limits = self.limits_now();
        true
    }

    /// The firmware's limits, tightened by the configuration and the servos' end stops.
    fn limits_now(&self) -> Limits {
        let limits = self.firmware_limits.tightened(&self.settings.configuration);
        let reach = self.settings.reach(&self.firmware_limits);
        Limits {
            // `set_pulse_range` and `change_servos` have checked that the ranges overlap.
            max_angle: limits.max_angle.min(reach.unwrap_or(f32::INFINITY)),
            ..limits
        }
    }

    /// Receives bytes of a transport, in any split. Requests act at once, but pulses change only in [`Self::tick`].
    pub fn receive(&mut self, now_us: u64, transport: Transport, bytes: &[u8]) {
        for &byte in bytes {
            let decoder = &mut self.decoders[transport.index()];
            if let Some(received) = decoder.push(byte) {
                let admission = self.session.admit(
                    transport,
                    received.header.session,
                    decoder.signed_bytes(),
                    received.signature.as_ref(),
                );
                self.handle(now_us, transport, received, admission);
            }
        }
    }

    /// Advances one servo period and returns the next pulses. Call it every [`TICK_US`]. A call less than half a period after
    /// the last one changes nothing.
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
        if self.resets.lasted() {
            self.clear_starts();
        }
        self.bench.sample(now_us, inputs.present);
        self.battery_stops =
            self.battery
                .measure(now_us, inputs.battery_mv, self.limits.battery_limit_mv);
        // A ramp that begins here moves in this tick: it counts from the previous one.
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
            led: self.led(now_us),
            cycle_flash: self.cycle_flash(),
            state: self.state.name(),
            kept: self.resets.word(),
            storage_wanted: self.state == State::Stopped && self.persist.wanted(now_us),
            starts: self.starts,
            boot_loader: self.leaves(now_us),
        };
        for (outbox, up) in self
            .outboxes
            .iter_mut()
            .zip([inputs.link_up, inputs.usb_up])
        {
            outbox.tick();
            if !up {
                outbox.clear();
            }
        }
        let up = self
            .session
            .transport()
            .is_some_and(|transport| match transport {
                Transport::Uart => inputs.link_up,
                Transport::Usb => inputs.usb_up,
            });
        if up {
            self.send_telemetry(now_us);
        }
        self.output
    }

    /// Returns true if the boot loader was requested, nothing moves and everything is stored.
    fn leaves(&mut self, now_us: u64) -> bool {
        if self.state != State::Stopped || !matches!(self.work, Work::Idle) {
            self.bench.stay();
        }
        self.bench.leaves(now_us) && self.persist.all_stored()
    }

    /// Clamps the set-point, advances the odometer and returns the pulses, ns. A passive joint follows the table in the odometer
    /// and gets no pulse.
    fn command(&mut self, wanted: [f32; 2]) -> [u32; 2] {
        let windows = [0, 1].map(|joint| self.settings.window(joint, &self.limits));
        let clamped = self
            .clamp
            .apply(wanted, &self.settings.maps(), &windows, &self.limits);
        if clamped.cut.is_some() {
            count(&mut self.counted.clamped);
        }
        let commanded = clamped.cut.unwrap_or(wanted);
        self.odometer.step(&self.model, self.commanded, commanded);
        self.commanded = commanded;
        let [front, back] = clamped.pulses_ns;
        match self.settings.passive {
            None => [front, back],
            Some(Joint::Front) => [0, back],
            Some(Joint::Back) => [front, 0],
        }
    }

    /// Current value of [`Output::kept`]. It contains an e-stop before the reply to that e-stop is sent.
    pub fn kept(&self) -> u32 {
        self.resets.word()
    }

    /// Copies pending bytes of a transport to `out`; returns their number.
    pub fn transmit(&mut self, transport: Transport, out: &mut [u8]) -> usize {
        self.outboxes[transport.index()].take(out)
    }

    /// Does one bounded storage step (an erase, a page, the settings). It does nothing unless Stopped.
    ///
    /// # Errors
    /// The storage's error. The step is tried again a second later.
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

/// Crash message of a robot that has restarted repeatedly after short runs.
const BROWN_OUT: &str = "3 starts in a row after less than 60 s each: a weak supply under the servos, or quick plug-ins";

/// Model of the paper's robot: the valid default swimmer.
fn robot_model() -> Model<f32> {
    let robot = Swimmer::robot();
    match Model::new(&robot) {
        Ok(model) => model,
        // The presets of the model are valid swimmers, as its own tests check.
        Err(_) => unreachable!("the paper's robot is a valid swimmer"),
    }
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
