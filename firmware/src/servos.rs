//! Two servos on one PWM slice: pulses in nanoseconds in, compare values out.
//!
//! PWM rather than PIO: the README has the numbers. Its steps of 0.32 µs (0.50°) are inside what is promised and a small
//! part of what the servo itself loses, and the slice gives for nothing what a PIO program would have to earn: both compare
//! values sit in one register that is latched at the wrap, so both servos switch in the same period and no pulse is ever
//! cut or doubled.

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_16, PIN_17, PWM_SLICE0};
use embassy_rp::pwm::{Config, Pwm};

/// 125 MHz / 40 = 3.125 MHz: one count is 320 ns.
const DIVIDER: u8 = 40;
/// Nanoseconds a count.
const COUNT_NS: u32 = 320;
/// 62 500 counts of 320 ns are 20 ms exactly.
const TOP: u16 = 62_499;
/// Counts between the control tick and the wrap that latches what it wrote: 12 ms, so that a tick may take six times
/// its promised 2 ms of CPU before a set-point comes a period late.
const LEAD: u16 = 37_500;

/// The PWM slice of both servos. Divider, top and control are written once. From then on only the compare values are: what
/// a write of the divider does to the count that is under way is not in the datasheet, and a period must not depend on it.
pub(crate) struct Servos {
    /// Holds the pins: dropped, it gives them back.
    _slice: Pwm<'static>,
    /// Those of [`PWM_SLICE0`].
    registers: pac::pwm::Channel,
}

impl Servos {
    /// Takes the pins with both outputs low and the counter stopped.
    pub(crate) fn new(
        slice: Peri<'static, PWM_SLICE0>,
        front: Peri<'static, PIN_16>,
        back: Peri<'static, PIN_17>,
    ) -> Self {
        let mut config = Config::default();
        config.divider = DIVIDER.into();
        config.top = TOP;
        config.enable = false;
        Self {
            _slice: Pwm::new_output_ab(slice, front, back, config),
            registers: pac::PWM.ch(0),
        }
    }

    /// Starts the counter, to be called at a control tick: from then on every wrap comes 12 ms after a tick, and as
    /// counter and ticks share one crystal they never drift apart.
    pub(crate) fn start(&mut self) {
        self.registers.ctr().write(|ctr| ctr.set_ctr(TOP - LEAD));
        self.registers.csr().modify(|csr| csr.set_en(true));
    }

    /// Sets both pulses [ns] from the next period on; `None` leaves both outputs low.
    pub(crate) fn set(&mut self, pulses_ns: Option<[u32; 2]>) {
        let [front, back] = pulses_ns.map_or([0; 2], |pulses| pulses.map(counts));
        // One write for both: they are latched together.
        self.registers.cc().write(|compare| {
            compare.set_a(front);
            compare.set_b(back);
        });
    }
}

/// Nearest count; past the period's end the output would stay high, so the count is held below it.
fn counts(pulse_ns: u32) -> u16 {
    u16::try_from(pulse_ns.saturating_add(COUNT_NS / 2) / COUNT_NS)
        .map_or(TOP, |count| count.min(TOP))
}
