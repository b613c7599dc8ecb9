//! Driver of both servos on one PWM slice: converts pulses in ns to compare values.
//!
//! PWM instead of PIO; the README has the figures. The steps of 0.32 µs (0.50°) meet the promise and are small against the
//! servo's own error. Both compare values are in one register that is latched at the wrap, so both servos switch in the same
//! period and no pulse is cut or doubled.

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_16, PIN_17, PWM_SLICE0};
use embassy_rp::pwm::{Config, Pwm};

/// 125 MHz / 40 = 3.125 MHz: one count is 320 ns.
const DIVIDER: u8 = 40;
/// Duration of a count, ns.
const COUNT_NS: u32 = 320;
/// 62 500 counts of 320 ns are 20 ms exactly.
const TOP: u16 = 62_499;
/// Counts between the control tick and the wrap that latches its pulses: 12 ms. A tick may take six times its promised 2 ms of
/// CPU before a set-point is one period late.
const LEAD: u16 = 37_500;

/// PWM slice of both servos. Divider, top and control are written once; later only the compare values. The datasheet does not
/// define the effect of a divider write on the present count, and the period must not depend on it.
pub(crate) struct Servos {
    /// Owns the pins and releases them when dropped.
    _slice: Pwm<'static>,
    /// Registers of [`PWM_SLICE0`].
    registers: pac::pwm::Channel,
}

impl Servos {
    /// Configures the pins, with both outputs low and the counter stopped.
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

    /// Starts the counter; called at a control tick. From then on every wrap comes 12 ms after a tick. Counter and ticks share
    /// one crystal, so they do not drift.
    pub(crate) fn start(&mut self) {
        self.registers.ctr().write(|ctr| ctr.set_ctr(TOP - LEAD));
        self.registers.csr().modify(|csr| csr.set_en(true));
    }

    /// Sets both pulses from the next period on, ns; `None` leaves both outputs low.
    pub(crate) fn set(&mut self, pulses_ns: Option<[u32; 2]>) {
        let [front, back] = pulses_ns.map_or([0; 2], |pulses| pulses.map(counts));
        // One write for both, so they are latched together.
        self.registers.cc().write(|compare| {
            compare.set_a(front);
            compare.set_b(back);
        });
    }
}

/// Nearest count, limited below the end of the period, beyond which the output would stay high.
fn counts(pulse_ns: u32) -> u16 {
    u16::try_from(pulse_ns.saturating_add(COUNT_NS / 2) / COUNT_NS)
        .map_or(TOP, |count| count.min(TOP))
}
