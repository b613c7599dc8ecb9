//! The end of a crash: a note for the next start, then a reset at once, which takes the pulses away.

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

// SAFETY: a fault may come at any instruction, so the attribute wants it unsafe. Nothing here relies on what was
// interrupted, and none of that runs again. (A stack that overflowed has no room for this: then the watchdog resets.)
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(|| CrashNote::faulted(frame.pc(), frame.lr()))
}

fn end(note: impl FnOnce() -> CrashNote) -> ! {
    static ENDING: AtomicBool = AtomicBool::new(false);
    cortex_m::interrupt::disable();
    // A crash while a crash is told has only the reset left.
    if !ENDING.swap(true, Ordering::Relaxed) {
        let note = note();
        retained_ram::leave(note);
        defmt::error!("crashed: {=str}", note.message().as_str());
    }
    // All but the oscillators is reset, the pins too.
    pac::PSM
        .wdsel()
        .write_value(pac::psm::regs::Wdsel(0x0001_FFFC));
    pac::WATCHDOG.ctrl().modify(|ctrl| ctrl.set_trigger(true));
    loop {
        cortex_m::asm::nop();
    }
}
