//! Control task: the only caller of the brain, at every servo period and whenever bytes arrive.

use embassy_futures::select::{Either3, select3};
use embassy_rp::gpio::Input;
use embassy_rp::rom_data::reset_to_usb_boot;
use embassy_time::{Duration, Instant, Timer};
use gait_player::{Brain, Inputs, Output, TICK_US, Transport};

use crate::led::Led;
use crate::presence::{Presence, button};
use crate::servos::Servos;
use crate::storage::FlashStorage;
use crate::watchdog::Watchdog;
use crate::{battery, board, retained_ram, uart, usb};

const TICK: Duration = Duration::from_micros(TICK_US as u64);

/// Resources of the control task.
pub(crate) struct Control {
    pub(crate) brain: &'static mut Brain,
    pub(crate) servos: Servos,
    pub(crate) led: Led,
    pub(crate) watchdog: Watchdog,
    pub(crate) storage: FlashStorage,
    pub(crate) link_state: &'static Input<'static>,
    pub(crate) presence: Presence,
}

/// Runs forever in the interrupt executor.
#[embassy_executor::task]
pub(crate) async fn control(mut control: Control) {
    let (mut over_uart, mut over_usb) = ([0; 64], [0; 64]);
    let mut next_tick = Instant::now() + TICK;
    control.servos.start();
    loop {
        // The tick has priority: a flood of bytes cannot delay it.
        let event = select3(
            Timer::at(next_tick),
            uart::BUFFERS.received.read(&mut over_uart),
            usb::BUFFERS.received.read(&mut over_usb),
        );
        match event.await {
            Either3::First(()) => {
                control.tick();
                next_tick += TICK;
                // Erasing flash blocks everything. Missed ticks are skipped; the grid does not move.
                while next_tick < Instant::now() {
                    next_tick += TICK;
                }
            }
            Either3::Second(count) => control.receive(Transport::Uart, over_uart.get(..count)),
            Either3::Third(count) => control.receive(Transport::Usb, over_usb.get(..count)),
        }
        // Before the reply is sent: an acknowledged e-stop survives a reset before the next tick.
        control.watchdog.keep(control.brain.kept());
        retained_ram::keep(control.brain.kept());
        control.hand_over_bytes();
    }
}

impl Control {
    /// A separate function in RAM; `memory.x` gives the reason.
    // SAFETY of the section: it holds code of the chip, and is copied to RAM before any of our code runs.
    #[allow(unsafe_code)]
    #[unsafe(link_section = ".fast.tick")]
    #[inline(never)]
    fn tick(&mut self) {
        let inputs = Inputs {
            battery_mv: battery::lowest_mv(),
            link_up: self.link_state.is_high(),
            usb_up: usb::is_up(),
            present: self.presence.shows(),
        };
        let output = self.brain.tick(now_us(), &inputs);
        self.servos.set(output.pulses_ns);
        self.led.set(output.led);
        self.watchdog.feed();
        button::allow_sampling(output.pulses_ns.is_none());
        retained_ram::keep_starts(output.starts);
        if output.storage_wanted || output.boot_loader {
            self.while_stopped(&output);
        }
    }

    /// Slow work, done while the robot is stopped.
    #[inline(never)]
    fn while_stopped(&mut self, output: &Output) {
        if output.storage_wanted
            && let Err(error) = self
                .brain
                .serve_storage(now_us(), &mut self.storage.feeding(&mut self.watchdog))
        {
            defmt::warn!("storing gait or settings: {}; the brain tries again", error);
        }
        if output.boot_loader {
            defmt::info!("leaving for the boot loader");
            self.watchdog.hand_over();
            reset_to_usb_boot(1 << board::LED, 0);
        }
    }

    fn receive(&mut self, transport: Transport, bytes: Option<&[u8]>) {
        let bytes = bytes.unwrap_or_default();
        self.brain.receive(now_us(), transport, bytes);
    }

    /// Copies the brain's outgoing bytes to the transmitters, as far as they have space.
    fn hand_over_bytes(&mut self) {
        let brain = &mut *self.brain;
        uart::BUFFERS.fill(|bytes| brain.transmit(Transport::Uart, bytes));
        usb::BUFFERS.fill(|bytes| brain.transmit(Transport::Usb, bytes));
    }
}

fn now_us() -> u64 {
    Instant::now().as_micros()
}
