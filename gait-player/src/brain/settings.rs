//! Persistent settings: configuration, servo maps, pulse ranges and key. Every value is checked on entry, from the link and
//! from storage.

use crate::storage::MAX_SETTINGS;
use crate::{Limits, servo::ServoMap};
use link_protocol::{
    Configuration, Joint, Key, PulseRange, Refusal, Request, ServoSettings, TangentialDrag,
};
use serde::{Deserialize, Serialize};
use swimmer_model::{Links, Model, Swimmer};

/// Largest trim, 1e-4 rad.
const MAX_TRIM: i16 = 5_000;
/// Longest ramp to neutral, ms.
const MAX_TO_NEUTRAL_MS: f32 = 1_000.0;
/// Smallest angle that a servo's end stops must leave on both sides, rad.
const MIN_REACH: f32 = 1e-2;
/// First of the two bytes at the end of a record with a passive joint; the second is the joint.
const HAS_PASSIVE: u8 = 1;
const FRONT: u8 = Joint::Front as u8;
const BACK: u8 = Joint::Back as u8;

/// Record of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) configuration: Configuration,
    pub(crate) servos: [ServoSettings; 2],
    /// Servo maps as last set with presence, or as built.
    pub(crate) at_bench: [ServoSettings; 2],
    /// Pulse ranges of the servos. `None` stands for the firmware's window.
    pub(crate) ranges: [Option<PulseRange>; 2],
    pub(crate) key: Option<Key>,
    /// Joint without a servo. In the record it follows the rest, and only if there is one: the record of a robot with two
    /// servos is that of earlier firmware.
    #[serde(skip)]
    pub(crate) passive: Option<Joint>,
}

impl Settings {
    /// Encodes the record for storage.
    #[cold] // not in a tick: memory.x leaves it in flash
    pub(crate) fn encode<'a>(&self, bytes: &'a mut [u8; MAX_SETTINGS]) -> Option<&'a mut [u8]> {
        let mut len = postcard::to_slice(self, bytes).ok()?.len();
        if let Some(joint) = self.passive {
            let tail = bytes.get_mut(len..)?.first_chunk_mut()?;
            *tail = [HAS_PASSIVE, joint as u8];
            len += tail.len();
        }
        bytes.get_mut(..len)
    }

    /// Key of a stored record, even if the rest is invalid: changed limits must not remove the protection.
    #[cold]
    pub(crate) fn stored_key(bytes: &[u8]) -> Option<Key> {
        postcard::from_bytes::<Self>(bytes).ok()?.key
    }

    /// Decodes a record. Returns `None` if it is invalid under these limits.
    #[cold]
    pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Option<Self> {
        let (mut settings, rest) = postcard::take_from_bytes::<Self>(bytes).ok()?;
        settings.passive = match *rest {
            [] => None,
            [HAS_PASSIVE, FRONT] => Some(Joint::Front),
            [HAS_PASSIVE, BACK] => Some(Joint::Back),
            _ => return None,
        };
        check_configuration(&settings.configuration, limits).ok()?;
        settings
            .servos
            .iter()
            .chain(&settings.at_bench)
            .try_for_each(|servo| check_servo(servo, limits))
            .ok()?;
        settings.reach(limits).ok()?;
        Some(settings)
    }

    /// Records the servo maps after a request with presence; later changes are measured from them.
    pub(crate) fn note_bench(&mut self, request: &Request) {
        if let Request::SetServo { joint, .. } | Request::Trim { joint, .. } = request {
            self.at_bench[joint.index()] = self.servos[joint.index()];
        }
    }

    /// Allowed pulses of a servo, ns.
    pub(crate) fn window(&self, joint: usize, limits: &Limits) -> PulseRange {
        self.ranges[joint].unwrap_or(PulseRange {
            shortest_ns: limits.pulse_min_ns,
            longest_ns: limits.pulse_max_ns,
        })
    }

    /// Largest angle that the servos' end stops leave on both sides, rad; infinite without end stops.
    pub(crate) fn reach(&self, limits: &Limits) -> Result<f32, Refusal> {
        let (maps, mut reach) = (self.maps(), f32::INFINITY);
        for (joint, range) in self.ranges.iter().enumerate() {
            let Some(range) = range else { continue };
            let inside = |field, inside| {
                if inside {
                    Ok(())
                } else {
                    Err(Refusal::BadValue { field })
                }
            };
            let neutral_ns = maps[joint].pulse_ns(0.0);
            inside(
                0,
                (limits.pulse_min_ns..=neutral_ns).contains(&range.shortest_ns),
            )?;
            inside(
                1,
                (neutral_ns..=limits.pulse_max_ns).contains(&range.longest_ns),
            )?;
            for (field, pulse_ns) in [(0, range.shortest_ns), (1, range.longest_ns)] {
                let angle = libm::fabsf(maps[joint].angle(pulse_ns));
                inside(field, angle >= MIN_REACH)?;
                reach = reach.min(angle);
            }
        }
        Ok(reach)
    }

    pub(crate) fn maps(&self) -> [ServoMap; 2] {
        self.servos.map(ServoMap::from)
    }
}

/// Validates a configuration and prepares its model.
#[cold] // at the start, and while Stopped
pub(crate) fn check_configuration(
    wanted: &Configuration,
    limits: &Limits,
) -> Result<Model<f32>, Refusal> {
    let within = |field: u8, value: f32, low: f32, high: f32| {
        // The range check rejects NaN.
        if (low..=high).contains(&value) {
            Ok(())
        } else {
            Err(Refusal::BadValue { field })
        }
    };
    within(0, wanted.middle_m, 1e-3, 10.0)?;
    within(1, wanted.front_m, 1e-3, 10.0)?;
    within(2, wanted.back_m, 1e-3, 10.0)?;
    within(3, wanted.chi, 1.0, 100.0)?;
    let tangential_drag = match wanted.tangential_drag {
        TangentialDrag::LogAspect(value) => {
            within(4, value, 1e-2, 100.0)?;
            swimmer_model::TangentialDrag::LogAspect(value)
        }
        TangentialDrag::HalfThickness(value) => {
            within(4, value, 1e-6, 1.0)?;
            swimmer_model::TangentialDrag::HalfThickness(value)
        }
        TangentialDrag::OverViscosity(value) => {
            within(4, value, 1e-3, 1e3)?;
            swimmer_model::TangentialDrag::OverViscosity(value)
        }
    };
    within(5, wanted.sphere_radius_m, 0.0, 10.0)?;
    within(6, wanted.max_angle, 1e-2, limits.max_angle)?;
    within(7, wanted.max_rate, 1e-2, limits.max_rate)?;
    let needs_ms = wanted.max_angle / wanted.max_rate * 1e3;
    if needs_ms > MAX_TO_NEUTRAL_MS {
        return Err(Refusal::SlowToNeutral {
            needs_ms: needs_ms as u32,
        });
    }
    let swimmer = Swimmer {
        links: Links {
            middle: wanted.middle_m,
            front: wanted.front_m,
            back: wanted.back_m,
        },
        chi: wanted.chi,
        tangential_drag,
        sphere_radius: wanted.sphere_radius_m,
        ..Swimmer::purcell()
    };
    // The remaining error is a half thickness that exceeds a link's length.
    Model::new(&swimmer).map_err(|_| Refusal::BadValue { field: 4 })
}

/// Validates a servo map.
pub(crate) fn check_servo(wanted: &ServoSettings, limits: &Limits) -> Result<(), Refusal> {
    let bad = |field| Err(Refusal::BadValue { field });
    if !limits.allows_centre(wanted.centre_ns) {
        return bad(0);
    }
    if !limits.allows_slope(wanted.slope_rad_per_us) {
        return bad(1);
    }
    check_trim(wanted.trim).or(bad(3))
}

/// Validates a trim.
pub(crate) fn check_trim(trim: i16) -> Result<(), Refusal> {
    if (-MAX_TRIM..=MAX_TRIM).contains(&trim) {
        Ok(())
    } else {
        Err(Refusal::BadValue { field: 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brain::BrainConfig;
    use proptest::prelude::*;

    fn as_built() -> (Settings, Limits) {
        let config = BrainConfig::in_tests();
        let settings = Settings {
            configuration: config.configuration,
            servos: config.servos,
            at_bench: config.servos,
            ranges: [None; 2],
            key: None,
            passive: None,
        };
        (settings, config.limits)
    }

    proptest! {
        #[test]
        fn a_record_is_read_as_it_was_written(
            widths in [proptest::option::of((1_000_u32..50_000, 1_000_u32..50_000)), proptest::option::of((1_000_u32..50_000, 1_000_u32..50_000))],
            key in proptest::option::of(any::<[u8; Key::LEN]>()),
            trim in -MAX_TRIM..=MAX_TRIM,
            passive in prop_oneof![Just(None), Just(Some(Joint::Front)), Just(Some(Joint::Back))],
        ) {
            let (mut settings, limits) = as_built();
            settings.key = key.map(Key);
            settings.passive = passive;
            settings.at_bench[1].trim = trim;
            for (joint, width) in widths.into_iter().enumerate() {
                let neutral_ns = settings.maps()[joint].pulse_ns(0.0);
                settings.ranges[joint] = width.map(|(below, above)| PulseRange {
                    shortest_ns: neutral_ns - below,
                    longest_ns: neutral_ns + above,
                });
            }
            let mut bytes = [0; MAX_SETTINGS];
            let record = settings.encode(&mut bytes).unwrap();
            prop_assert_eq!(Settings::decode(record, &limits), Some(settings));
            prop_assert_eq!(Settings::stored_key(record), settings.key);
            // A record with a missing or an extra byte is invalid.
            let len = record.len();
            prop_assert_eq!(Settings::decode(&bytes[..len - 1], &limits), None);
            prop_assert_eq!(Settings::decode(&bytes[..=len], &limits), None);
        }
    }

    #[test]
    fn the_longest_record_fits() {
        let (mut settings, _) = as_built();
        let servo = ServoSettings {
            centre_ns: u32::MAX,
            trim: i16::MIN,
            ..settings.servos[0]
        };
        let range = PulseRange {
            shortest_ns: u32::MAX,
            longest_ns: u32::MAX,
        };
        settings.servos = [servo; 2];
        settings.at_bench = [servo; 2];
        settings.ranges = [Some(range); 2];
        settings.key = Some(Key([0xFF; Key::LEN]));
        settings.passive = Some(Joint::Back);
        let mut bytes = [0; MAX_SETTINGS];
        assert_eq!(
            settings.encode(&mut bytes).map(|record| record.len()),
            Some(126)
        );
    }

    /// Record of firmware that knows no passive joint: of the paper's robot with a key.
    const RECORD_OF_1_0: [u8; 88] = [
        0x73, 0x68, 0x91, 0x3D, 0xBA, 0x49, 0x0C, 0x3E, 0xBA, 0x49, 0x0C, 0x3E, 0xA2, 0x45, 0x66,
        0x40, 0x00, 0x42, 0x60, 0x91, 0x40, 0xBB, 0xB8, 0x8D, 0x3D, 0x33, 0x33, 0x33, 0x40, 0x00,
        0x00, 0x60, 0x40, 0xE0, 0xC6, 0x5B, 0xF7, 0x75, 0xE0, 0x3C, 0x00, 0x00, 0xE0, 0xC6, 0x5B,
        0xF7, 0x75, 0xE0, 0x3C, 0x00, 0x00, 0xE0, 0xC6, 0x5B, 0xF7, 0x75, 0xE0, 0x3C, 0x00, 0x00,
        0xE0, 0xC6, 0x5B, 0xF7, 0x75, 0xE0, 0x3C, 0x00, 0x00, 0x00, 0x00, 0x01, 0x6E, 0x6F, 0x74,
        0x20, 0x61, 0x20, 0x73, 0x65, 0x63, 0x72, 0x65, 0x74, 0x20, 0x6B, 0x65, 0x79,
    ];

    #[test]
    fn a_record_of_earlier_firmware_is_read_and_written_as_it_was() {
        let (mut settings, limits) = as_built();
        settings.key = Some(Key(*b"not a secret key"));
        let mut bytes = [0; MAX_SETTINGS];
        assert_eq!(settings.encode(&mut bytes).unwrap(), RECORD_OF_1_0);
        assert_eq!(Settings::decode(&RECORD_OF_1_0, &limits), Some(settings));
    }

    /// Earlier firmware refuses the record of a passive joint, whose output it would drive, and keeps the key.
    #[test]
    fn the_record_of_a_passive_joint_is_that_record_and_its_joint() {
        let (mut settings, _) = as_built();
        settings.key = Some(Key(*b"not a secret key"));
        settings.passive = Some(Joint::Back);
        let mut bytes = [0; MAX_SETTINGS];
        let record = settings.encode(&mut bytes).unwrap();
        assert_eq!(*record, [&RECORD_OF_1_0[..], &[1, 1]].concat());
        assert_eq!(Settings::stored_key(record), settings.key);
    }

    #[test]
    fn a_range_beyond_what_was_built_or_without_neutral_is_no_settings() {
        let (settings, limits) = as_built();
        let neutral_ns = settings.maps()[0].pulse_ns(0.0);
        for (shortest_ns, longest_ns) in [
            (limits.pulse_min_ns - 1, limits.pulse_max_ns),
            (limits.pulse_min_ns, limits.pulse_max_ns + 1),
            (neutral_ns + 1, limits.pulse_max_ns),
            (limits.pulse_min_ns, neutral_ns - 1),
            (neutral_ns, limits.pulse_max_ns),
        ] {
            let mut wrong = settings;
            wrong.ranges[0] = Some(PulseRange {
                shortest_ns,
                longest_ns,
            });
            let mut bytes = [0; MAX_SETTINGS];
            let record = wrong.encode(&mut bytes).unwrap();
            assert_eq!(Settings::decode(record, &limits), None, "{wrong:?}");
        }
    }
}
