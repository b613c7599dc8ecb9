//! Promise R8: a battery that is low for a second stops the robot, and keeps it from being armed until it has been well
//! for five. What was never measured is never low; a sample that is missing changes nothing.

const LOW_FOR_US: u64 = 1_000_000;
const WELL_FOR_US: u64 = 5_000_000;

/// What is known of the battery.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Battery {
    last_mv: Option<u16>,
    pub(super) below_since: Option<u64>,
    pub(super) well_since: Option<u64>,
    latched: bool,
}

impl Battery {
    /// Takes a measurement; true where the robot must stop.
    pub(crate) fn measure(&mut self, now_us: u64, measured_mv: Option<u16>, limit_mv: u16) -> bool {
        self.last_mv = measured_mv;
        let Some(mv) = measured_mv else {
            return self.latched;
        };
        if mv < limit_mv {
            self.well_since = None;
            let since = *self.below_since.get_or_insert(now_us);
            self.latched |= now_us.saturating_sub(since) >= LOW_FOR_US;
        } else {
            self.below_since = None;
            let since = *self.well_since.get_or_insert(now_us);
            self.latched &= now_us.saturating_sub(since) < WELL_FOR_US;
        }
        self.latched
    }

    /// Last measurement, mV; `None`: not measured.
    pub(crate) fn mv(&self) -> Option<u16> {
        self.last_mv
    }

    /// Below its limit, or not well for long enough yet.
    pub(crate) fn low(&self) -> bool {
        self.latched || self.below_since.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_for_a_second_latches_and_five_good_seconds_release() {
        let mut battery = Battery::default();
        let at = |seconds: f64| (seconds * 1e6) as u64;
        assert!(!battery.measure(at(0.0), Some(5000), 4400) && !battery.low());
        assert!(!battery.measure(at(1.0), Some(4399), 4400) && battery.low());
        assert!(!battery.measure(at(1.999), Some(4399), 4400));
        // A moment of recovery starts the second again.
        assert!(!battery.measure(at(1.9995), Some(4400), 4400) && !battery.low());
        assert!(!battery.measure(at(2.0), Some(4000), 4400));
        assert!(battery.measure(at(3.0), Some(4000), 4400));
        assert!(battery.measure(at(3.1), Some(5000), 4400) && battery.low());
        assert!(battery.measure(at(8.0), Some(5000), 4400));
        assert!(!battery.measure(at(8.1), Some(5000), 4400) && !battery.low());
    }

    #[test]
    fn a_sample_that_is_missing_releases_nothing() {
        let mut battery = Battery::default();
        battery.measure(0, Some(4000), 4400);
        assert!(battery.measure(1_000_000, Some(4000), 4400));
        assert!(battery.measure(1_020_000, None, 4400) && battery.low());
        assert!(battery.measure(1_040_000, Some(5000), 4400) && battery.low());
        assert_eq!(battery.mv(), Some(5000));
    }

    #[test]
    fn what_is_not_measured_is_never_low() {
        let mut battery = Battery::default();
        assert!(!battery.measure(0, None, 4400));
        assert!(!battery.measure(9_000_000, None, 4400) && !battery.low());
        assert_eq!(battery.mv(), None);
    }
}
