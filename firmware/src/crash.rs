//! Crash handler: stores a note for the next start, then resets at once, which ends the pulses.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use embassy_rp::pac;
use gait_player::CrashNote;
use portable_atomic::{AtomicBool, Ordering};

use crate::retained_ram;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let (file, line) = info
        .location()
        .map_or(("?", 0), |place| (place.file(), place.line()));
    end(|| CrashNote::panicked(file, line, info.message()))
}

// SAFETY: a fault may occur at any instruction, so the attribute requires `unsafe`. The handler does not rely on the
// interrupted code, which never continues. (After a stack overflow it may not run; then the watchdog resets.)
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(|| CrashNote::faulted(frame.pc(), frame.lr()))
}

fn end(note: impl FnOnce() -> CrashNote) -> ! {
    static ENDING: AtomicBool = AtomicBool::new(false);
    cortex_m::interrupt::disable();
    // After a crash within the crash handler, only the reset remains.
    if !ENDING.swap(true, Ordering::Relaxed) {
        let note = note();
        retained_ram::leave(note);
        defmt::error!("crashed: {=str}", note.message().as_str());
    }
    // Resets everything except the oscillators, including the pins.
    pac::PSM
        .wdsel()
        .write_value(pac::psm::regs::Wdsel(0x0001_FFFC));
    pac::WATCHDOG.ctrl().modify(|ctrl| ctrl.set_trigger(true));
    loop {
        cortex_m::asm::nop();
    }
}
