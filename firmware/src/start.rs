//! Start-up: distributes the peripherals, creates the brain and starts the tasks, control with the highest priority.

use defmt::{info, unwrap};
use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use gait_player::Brain;
use static_cell::StaticCell;

use crate::board::Board;
use crate::control::{Control, control};
use crate::led::Led;
use crate::presence::Presence;
use crate::servos::Servos;
use crate::storage::FlashStorage;
use crate::watchdog::Watchdog;
use crate::{battery, boot, stack_guard, uart, usb, watchdog};

/// Executor of `control` in an interrupt, so that no other task delays it.
static ABOVE_THE_THREAD: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SWI_IRQ_1() {
    // SAFETY: called only from the interrupt with which the executor was started.
    #[allow(unsafe_code)]
    unsafe {
        ABOVE_THE_THREAD.on_interrupt();
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    stack_guard::start();
    let whole_chip = watchdog::whole_chip_was_reset();
    let board = Board::new(embassy_rp::init(embassy_rp::config::Config::default()));
    // The servo pins first: outputs low, counter stopped.
    let servos = Servos::new(board.servo_slice, board.servo_front, board.servo_back);
    let mut watchdog = Watchdog::new(board.watchdog);
    watchdog.start();
    // Its interrupt receives bytes during the rest of the start-up.
    let link_state = uart::start(
        spawner,
        board.uart,
        board.link_tx,
        board.link_rx,
        board.link_state,
    );

    usb::start(spawner, board.usb);

    static BRAIN: StaticCell<Brain> = StaticCell::new();
    let brain = BRAIN.init_with(|| Brain::new(boot::brain_config(&mut watchdog, whole_chip)));
    let mut storage = FlashStorage::new(board.flash);
    if let Err(error) = brain.load(&mut storage.feeding(&mut watchdog)) {
        defmt::warn!("loading gait and settings: {}; going on without", error);
    }
    info!(
        "swimmer firmware {}, commit {}",
        env!("CARGO_PKG_VERSION"),
        env!("SWIMMER_COMMIT")
    );

    spawner.spawn(unwrap!(battery::sample(board.adc, board.battery)));
    spawner.spawn(unwrap!(watchdog::beat()));
    #[cfg(feature = "pico")]
    spawner.spawn(unwrap!(crate::presence::button::watch(board.bootsel)));

    // UART and timer keep priority 0 above it: no bytes are lost while a tick is computed.
    interrupt::SWI_IRQ_1.set_priority(Priority::P1);
    ABOVE_THE_THREAD
        .start(interrupt::SWI_IRQ_1)
        .spawn(unwrap!(control(Control {
            brain,
            servos,
            led: Led::new(board.led),
            watchdog,
            storage,
            link_state,
            presence: Presence::new(board.presence),
        })));
}
