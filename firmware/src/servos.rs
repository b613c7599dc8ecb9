//! Two servos on one PWM slice: pulses in nanoseconds in, compare values out.
//!
//! PWM rather than PIO: the README has the numbers. Its steps of 0.32 µs (0.50°) are inside what is promised and a small
//! part of what the servo itself loses, and the slice gives for nothing what a PIO program would have to earn: both compare
//! values sit in one register that is latched at the wrap, so both servos switch in the same period and no pulse is ever
//! cut or doubled.

use embassy_rp::Peri;
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

/// The PWM slice of both servos.
pub(crate) struct Servos {
    slice: Pwm<'static>,
}

impl Servos {
    /// Takes the pins with both outputs low and the counter stopped.
    pub(crate) fn new(
        slice: Peri<'static, PWM_SLICE0>,
        front: Peri<'static, PIN_16>,
        back: Peri<'static, PIN_17>,
    ) -> Self {
        Self {
            slice: Pwm::new_output_ab(slice, front, back, config(None, false)),
        }
    }

    /// Starts the counter, to be called at a control tick: from then on every wrap comes 12 ms after a tick, and as
    /// counter and ticks share one crystal they never drift apart.
    pub(crate) fn start(&mut self) {
        self.slice.set_counter(TOP - LEAD);
        self.slice.set_config(&config(None, true));
    }

    /// Sets both pulses [ns] from the next period on; `None` leaves both outputs low.
    pub(crate) fn set(&mut self, pulses_ns: Option<[u32; 2]>) {
        self.slice.set_config(&config(pulses_ns, true));
    }
}

fn config(pulses_ns: Option<[u32; 2]>, enable: bool) -> Config {
    let [compare_a, compare_b] = pulses_ns.map_or([0; 2], |pulses| pulses.map(counts));
    let mut config = Config::default();
    config.divider = DIVIDER.into();
    config.top = TOP;
    config.compare_a = compare_a;
    config.compare_b = compare_b;
    config.enable = enable;
    config
}

/// Nearest count; past the period's end the output would stay high, so the count is held below it.
fn counts(pulse_ns: u32) -> u16 {
    u16::try_from(pulse_ns.saturating_add(COUNT_NS / 2) / COUNT_NS)
        .map_or(TOP, |count| count.min(TOP))
}
