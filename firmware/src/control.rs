//! The control task: the one place that calls the brain, at every servo period and whenever bytes came.

use embassy_futures::select::{Either, select};
use embassy_rp::gpio::Input;
use embassy_time::{Duration, Instant, Timer};
use gait_player::{Brain, Inputs, TICK_US};

use crate::battery;
use crate::led::Led;
use crate::servos::Servos;
use crate::storage::FlashStorage;
use crate::survivors;
use crate::uart::{RECEIVED, TO_SEND};
use crate::watchdog::Watchdog;

const TICK: Duration = Duration::from_micros(TICK_US as u64);

/// What the control task owns.
pub(crate) struct Control {
    pub(crate) brain: &'static mut Brain,
    pub(crate) servos: Servos,
    pub(crate) led: Led,
    pub(crate) watchdog: Watchdog,
    pub(crate) storage: FlashStorage,
    pub(crate) link_state: &'static Input<'static>,
}

/// Runs for ever in the interrupt executor.
#[embassy_executor::task]
pub(crate) async fn control(mut control: Control) {
    let mut bytes = [0; 64];
    let mut next_tick = Instant::now() + TICK;
    control.servos.start();
    loop {
        // The tick stands first: a flood of bytes cannot hold it up.
        match select(Timer::at(next_tick), RECEIVED.read(&mut bytes)).await {
            Either::First(()) => {
                control.tick();
                next_tick += TICK;
                // Erasing flash stops everything. Ticks missed meanwhile are left out; the others stay where they were.
                while next_tick < Instant::now() {
                    next_tick += TICK;
                }
            }
            Either::Second(count) => control
                .brain
                .receive(now_us(), bytes.get(..count).unwrap_or_default()),
        }
        // Before the answer leaves: an e-stop that was acknowledged outlives a reset that comes before the next tick.
        control.watchdog.keep(control.brain.kept());
        survivors::keep(control.brain.kept());
        control.hand_over_bytes();
    }
}

impl Control {
    /// A function of its own, for `memory.x` to put it into RAM.
    #[inline(never)]
    fn tick(&mut self) {
        let inputs = Inputs {
            battery_mv: battery::lowest_mv(),
            link_up: self.link_state.is_high(),
        };
        let output = self.brain.tick(now_us(), &inputs);
        self.servos.set(output.pulses_ns);
        self.led.set(output.led);
        self.watchdog.feed();
        if output.storage_wanted
            && let Err(error) = self
                .brain
                .serve_storage(now_us(), &mut self.storage.feeding(&mut self.watchdog))
        {
            defmt::warn!("storing gait or settings: {}; the brain tries again", error);
        }
    }

    /// Moves what the brain wants to send into the pipe of the UART task, as far as it has room.
    fn hand_over_bytes(&mut self) {
        let mut bytes = [0; 64];
        loop {
            let room = TO_SEND.free_capacity().min(bytes.len());
            let count = self.brain.transmit(&mut bytes[..room]);
            if count == 0 {
                return;
            }
            // There is room, for this task is the only writer; but one write ends where the pipe's ring wraps.
            let mut rest = &bytes[..count];
            while let Ok(written) = TO_SEND.try_write(rest)
                && written < rest.len()
            {
                rest = &rest[written..];
            }
        }
    }
}

fn now_us() -> u64 {
    Instant::now().as_micros()
}
