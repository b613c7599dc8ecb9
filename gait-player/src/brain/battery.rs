//! Low-battery latch (promise R8). A battery that is low for one second in total stops the robot, and arming is refused until
//! it has been well for five seconds. The time below the limit accumulates over dips until the battery has been well for a
//! minute: a weak pack recovers between strokes, so a single dip rarely lasts a second. A battery without samples is never low,
//! and a missing sample changes nothing.

use crate::TICK_US;

const LOW_FOR_US: u64 = 1_000_000;
const WELL_FOR_US: u64 = 5_000_000;
/// Dips further apart than this do not accumulate, µs. Longer than any stroke.
const FORGOTTEN_AFTER_US: u64 = 60_000_000;

/// State of the battery's low-voltage latch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Battery {
    last_mv: Option<u16>,
    /// Time of the last call of [`Battery::measure`].
    measured_us: Option<u64>,
    /// The last sample was below the limit.
    below: bool,
    /// Time below the limit since the battery was last well for a minute, at most [`LOW_FOR_US`].
    pub(super) low_us: u64,
    pub(super) well_since: Option<u64>,
    latched: bool,
}

impl Battery {
    /// Updates the latch with the lowest voltage since the last call. Returns true if the robot must stop.
    pub(crate) fn measure(&mut self, now_us: u64, measured_mv: Option<u16>, limit_mv: u16) -> bool {
        let passed_us = now_us.saturating_sub(self.measured_us.unwrap_or(now_us));
        self.measured_us = Some(now_us);
        self.last_mv = measured_mv;
        let Some(mv) = measured_mv else {
            return self.latched;
        };
        if mv < limit_mv {
            // A dip between two samples counts as one tick, however old the previous sample is.
            let low_us = if self.below {
                passed_us
            } else {
                passed_us.min(u64::from(TICK_US))
            };
            self.low_us = self.low_us.saturating_add(low_us).min(LOW_FOR_US);
            self.well_since = None;
            self.latched |= self.low_us >= LOW_FOR_US;
        } else {
            let since = *self.well_since.get_or_insert(now_us);
            let well_us = now_us.saturating_sub(since);
            if well_us >= FORGOTTEN_AFTER_US || self.latched && well_us >= WELL_FOR_US {
                self.low_us = 0;
                self.latched = false;
            }
        }
        self.below = mv < limit_mv;
        self.latched
    }

    /// Last measurement, mV. Returns `None` if none was made.
    pub(crate) fn mv(&self) -> Option<u16> {
        self.last_mv
    }

    /// Returns true if the battery is below its limit, or latched and not yet well for long enough.
    pub(crate) fn low(&self) -> bool {
        self.latched || self.below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT_MV: u16 = 4400;
    const LOW: Option<u16> = Some(LIMIT_MV - 1);
    const WELL: Option<u16> = Some(LIMIT_MV);

    /// Battery that is sampled at every tick.
    #[derive(Default)]
    struct Ticking {
        battery: Battery,
        now_us: u64,
        stops: bool,
    }

    impl Ticking {
        fn pass(&mut self, ms: u64, mv: Option<u16>) -> &mut Self {
            for _ in 0..ms * 1000 / u64::from(TICK_US) {
                self.now_us += u64::from(TICK_US);
                self.stops = self.battery.measure(self.now_us, mv, LIMIT_MV);
            }
            self
        }
    }

    #[test]
    fn low_for_a_second_latches_and_five_good_seconds_release() {
        let mut ticking = Ticking::default();
        assert!(!ticking.pass(1000, WELL).stops && !ticking.battery.low());
        assert!(!ticking.pass(980, LOW).stops && ticking.battery.low());
        assert!(ticking.pass(20, LOW).stops);
        assert!(ticking.pass(5000, WELL).stops && ticking.battery.low());
        assert!(!ticking.pass(20, WELL).stops && !ticking.battery.low());
        // After the latch is released, the accumulated time starts at zero.
        assert!(!ticking.pass(980, LOW).stops && ticking.pass(20, LOW).stops);
    }

    #[test]
    fn a_pack_that_dips_on_every_stroke_latches() {
        for (stroke_ms, dip_ms) in [(1_000, 100), (15_000, 40), (59_000, 20)] {
            let mut ticking = Ticking::default();
            let mut strokes = 0;
            while !ticking.stops {
                ticking.pass(stroke_ms - dip_ms, WELL).pass(dip_ms, LOW);
                strokes += 1;
                assert!(strokes <= 50, "{stroke_ms} ms, dips of {dip_ms} ms");
            }
            assert_eq!(strokes * dip_ms, 1000);
        }
    }

    #[test]
    fn dips_a_minute_apart_are_forgotten() {
        let mut ticking = Ticking::default();
        for _ in 0..20 {
            assert!(!ticking.pass(900, LOW).pass(60_020, WELL).stops);
        }
    }

    /// Ticks come late while a sector of flash is erased.
    #[test]
    fn late_samples_count_the_time_between_them() {
        let mut battery = Battery::default();
        assert!(!battery.measure(0, WELL, LIMIT_MV));
        // A dip after a long gap counts one tick; two low samples count the time between them.
        assert!(!battery.measure(30_000_000, LOW, LIMIT_MV));
        assert!(!battery.measure(30_900_000, LOW, LIMIT_MV));
        assert!(battery.measure(31_000_000, LOW, LIMIT_MV));
    }

    #[test]
    fn a_sample_that_is_missing_releases_nothing() {
        let mut ticking = Ticking::default();
        assert!(ticking.pass(1020, LOW).stops);
        assert!(ticking.pass(9000, None).stops && ticking.battery.low());
        assert!(ticking.pass(20, Some(5000)).stops && ticking.battery.low());
        assert_eq!(ticking.battery.mv(), Some(5000));
    }

    #[test]
    fn what_is_not_measured_is_never_low() {
        let mut ticking = Ticking::default();
        assert!(!ticking.pass(9000, None).stops && !ticking.battery.low());
        assert_eq!(ticking.battery.mv(), None);
    }
}
