//! Last check before the servos, and the only place that enforces limits on angle, rate and pulse. Whatever its input, no pulse
//! leaves the window, and no step exceeds the slew limit while pulses are on.

use crate::Limits;
use crate::servo::ServoMap;
use link_protocol::PulseRange;

/// Limiter with the last pulses as its state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clamp {
    last: Option<[u32; 2]>,
}

/// Output of the limiter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clamped {
    /// Pulses, ns.
    pub(crate) pulses_ns: [u32; 2],
    /// Angles that these pulses command, rad, if they differ from the requested ones.
    pub(crate) cut: Option<[f32; 2]>,
}

impl Clamp {
    pub(crate) const fn new() -> Self {
        Self { last: None }
    }

    /// Resets the slew limit because pulses are off: the next pulse may be anywhere in the window.
    pub(crate) fn off(&mut self) {
        self.last = None;
    }

    /// Last pulses, ns. Returns `None` while they are off.
    pub(crate) fn last(&self) -> Option<[u32; 2]> {
        self.last
    }

    /// Pulses for requested angles \[rad\], within each servo's window.
    pub(crate) fn apply(
        &mut self,
        wanted: [f32; 2],
        maps: &[ServoMap; 2],
        windows: &[PulseRange; 2],
        limits: &Limits,
    ) -> Clamped {
        let (mut pulses_ns, mut angles, mut cut) = ([0; 2], wanted, false);
        for joint in 0..2 {
            let map = &maps[joint];
            // `max` and `min` drop a NaN: it becomes a limit, and the slew limit below bounds the step.
            let angle = wanted[joint].max(-limits.max_angle).min(limits.max_angle);
            let ideal = map.pulse_ns(angle);
            let mut pulse = ideal;
            if let Some(last) = self.last {
                let step = map.step_ns(limits.max_step());
                pulse = pulse.clamp(
                    last[joint].saturating_sub(step),
                    last[joint].saturating_add(step),
                );
            }
            // The window is applied last, so nothing overrides it. An empty window holds the pulse at its lower end.
            let window = windows[joint];
            pulse = pulse.min(window.longest_ns).max(window.shortest_ns);
            if pulse != ideal || (angle - wanted[joint]).abs() > 0.0 || wanted[joint].is_nan() {
                cut = true;
                angles[joint] = map.angle(pulse);
            }
            pulses_ns[joint] = pulse;
        }
        self.last = Some(pulses_ns);
        Clamped {
            pulses_ns,
            cut: cut.then_some(angles),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WINDOWS: [PulseRange; 2] = [PulseRange {
        shortest_ns: Limits::ROBOT.pulse_min_ns,
        longest_ns: Limits::ROBOT.pulse_max_ns,
    }; 2];

    fn any_angle() -> impl Strategy<Value = f32> {
        prop_oneof![
            any::<f32>(),
            -3.5_f32..3.5,
            Just(f32::NAN),
            Just(f32::INFINITY),
            Just(f32::NEG_INFINITY)
        ]
    }

    proptest! {
        /// Promise R4, for the limiter alone.
        #[test]
        fn no_pulse_outside_the_window_and_no_step_above_the_limit(
            wanted in prop::collection::vec([any_angle(), any_angle()], 1..50),
            centre_ns in any::<u32>(), slope_rad_per_us in 0.001_f32..1.0, trim in -0.5_f32..0.5, reversed in any::<bool>(),
        ) {
            let maps = [ServoMap { centre_ns, slope_rad_per_us, reversed, trim }, ServoMap::ROBOT];
            let limits = Limits::ROBOT;
            let mut clamp = Clamp::new();
            let mut last: Option<[u32; 2]> = None;
            for wanted in wanted {
                let pulses = clamp.apply(wanted, &maps, &WINDOWS, &limits).pulses_ns;
                for joint in 0..2 {
                    prop_assert!((limits.pulse_min_ns..=limits.pulse_max_ns).contains(&pulses[joint]));
                    if let Some(last) = last {
                        prop_assert!(pulses[joint].abs_diff(last[joint]) <= maps[joint].step_ns(limits.max_step()));
                    }
                }
                last = Some(pulses);
            }
        }
    }

    #[test]
    fn what_is_allowed_passes_unchanged() {
        let mut clamp = Clamp::new();
        let maps = [ServoMap::ROBOT; 2];
        let clamped = clamp.apply([2.0, -2.8], &maps, &WINDOWS, &Limits::ROBOT);
        assert_eq!(clamped.cut, None);
        assert_eq!(
            clamped.pulses_ns,
            [maps[0].pulse_ns(2.0), maps[1].pulse_ns(-2.8)]
        );
        assert_eq!(
            clamp
                .apply([2.07, -2.73], &maps, &WINDOWS, &Limits::ROBOT)
                .cut,
            None
        );
        let cut = clamp
            .apply([2.3, -2.73], &maps, &WINDOWS, &Limits::ROBOT)
            .cut
            .unwrap();
        assert!(
            (cut[0] - 2.14).abs() < 1e-4 && (cut[1] + 2.73).abs() < 1e-6,
            "{cut:?}"
        );
        clamp.off();
        assert_eq!(
            clamp
                .apply([-2.0, 2.0], &maps, &WINDOWS, &Limits::ROBOT)
                .cut,
            None
        );
    }

    /// If the window is wide, only the angle limit acts.
    #[test]
    fn an_angle_that_is_cut_is_told_although_its_pulse_is_the_limits_own() {
        let maps = [ServoMap::ROBOT; 2];
        for (wanted, limit) in [(2.9, 2.8), (-2.9, -2.8), (f32::NAN, -2.8)] {
            let clamped = Clamp::new().apply([0.1, wanted], &maps, &WINDOWS, &Limits::ROBOT);
            let cut = clamped.cut.unwrap();
            assert!((cut[0] - 0.1).abs() < 1e-6, "{cut:?}");
            assert!((cut[1] - limit).abs() < 1e-4, "{cut:?}");
            assert_eq!(clamped.pulses_ns[1], maps[1].pulse_ns(limit));
        }
    }
}
