//! Battery monitor: minimum of the servo pack's voltage between two control ticks, so that a dip of a millisecond is detected.

use embassy_rp::Peri;
use embassy_rp::adc::{Adc, Blocking, Channel, Config};
use embassy_rp::gpio::Pull;
use embassy_rp::peripherals::{ADC, PIN_26};
use embassy_time::{Duration, Ticker};
use portable_atomic::{AtomicU16, Ordering};

use crate::build_setting::number;

/// Ratio of the pack's voltage to the pin's, in thousandths (3200 = 22 kΩ over 10 kΩ). Without a divider (`None`) the pin is
/// not read and the battery is reported as not measured.
const DIVIDER_MILLI: Option<u32> = number(option_env!("SWIMMER_BATTERY_DIVIDER_MILLI"));
const _: () = assert!(
    match DIVIDER_MILLI {
        Some(milli) => milli >= 1000,
        None => true,
    },
    "SWIMMER_BATTERY_DIVIDER_MILLI must be 1000 or more: a divider does not raise the voltage"
);
/// ADC reference [mV]: the boards' 3.3 V rail.
const REFERENCE_MV: u64 = 3300;
/// Marker for no sample; the 12-bit ADC never returns it.
const NONE: u16 = u16::MAX;
/// Sampling rate: twenty samples per control tick, each 2 µs of the CPU.
const RATE_HZ: u64 = 1000;

static LOWEST: AtomicU16 = AtomicU16::new(NONE);

/// Samples the pin forever and stores the minimum.
#[embassy_executor::task]
pub(crate) async fn sample(adc: Peri<'static, ADC>, pin: Peri<'static, PIN_26>) {
    if DIVIDER_MILLI.is_none() {
        return;
    }
    let mut adc: Adc<'static, Blocking> = Adc::new_blocking(adc, Config::default());
    let mut channel = Channel::new_pin(pin, Pull::None);
    let mut ticker = Ticker::every(Duration::from_hz(RATE_HZ));
    loop {
        ticker.next().await;
        if let Ok(reading) = adc.blocking_read(&mut channel) {
            LOWEST.fetch_min(reading, Ordering::Relaxed);
        }
    }
}

/// Lowest pack voltage since the last call, mV. Returns `None` without a divider or before the first sample.
pub(crate) fn lowest_mv() -> Option<u16> {
    let reading = LOWEST.swap(NONE, Ordering::Relaxed);
    if reading == NONE {
        return None;
    }
    let pack_uv = u64::from(reading) * REFERENCE_MV * u64::from(DIVIDER_MILLI?) / 4096;
    u16::try_from(pack_uv / 1000).ok()
}
