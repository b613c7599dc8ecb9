//! Guard below the stack: a region of the memory protection unit without read, write and execute permission.
//!
//! The stack grows down to the first byte of the RAM. Below it the bus has no memory, but it need not fault either: the addresses
//! belong to the flash controller's part of the map, which need not decode every bit. The guard faults whatever the bus does. It
//! is as long as the whole stack, so that no frame reaches past it, and costs no RAM.
//!
//! A fault here is a hard fault. The chip then stores its registers on the stack that has just run out, which faults again and
//! locks the core up; the watchdog ends that within its 430 ms, and the reason of the reset is `watchdog`. If a frame as a whole
//! is still above the guard, the crash handler runs, and the reason is `crash`. Within the handler the guard is off (HFNMIENA).

use cortex_m::peripheral::MPU;

/// First address of the stack's memory, which `memory.x` places at the start of the RAM.
const STACK_END: u32 = 0x2000_0000;
/// Length of the guard, bytes: a power of two of at least 256, to which its address is aligned.
const LENGTH: u32 = 32 * 1024;
const START: u32 = STACK_END - LENGTH;

/// `MPU_RBAR` (ARMv6-M, B3.5.8): address, with the number of the region (0) marked as valid.
const RBAR: u32 = START | 1 << 4;
/// `MPU_RASR` (B3.5.9): never executed (XN), access permission 0 (none, privileged or not), a size of 2^(SIZE + 1), enabled.
const RASR: u32 = 1 << 28 | (LENGTH.trailing_zeros() - 1) << 1 | 1;
/// `MPU_CTRL` (B3.5.5): on, with the default map for all that is not in a region (PRIVDEFENA).
const CTRL: u32 = 1 << 2 | 1;

const _: () = assert!(LENGTH.is_power_of_two() && LENGTH >= 256 && START.is_multiple_of(LENGTH));
const _: () = assert!(RBAR == 0x1FFF_8010 && RASR == 0x1000_001D && CTRL == 5);

/// Switches the guard on. Called once, before any task runs.
pub(crate) fn start() {
    // SAFETY: a static's own address; no task runs yet and nothing else uses the MPU. The region holds nothing of ours, so no
    // access that was right before is a fault now.
    #[allow(unsafe_code)]
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write(RBAR);
        mpu.rasr.write(RASR);
        mpu.ctrl.write(CTRL);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
