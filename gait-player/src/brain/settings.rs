//! What an operator set and a power cut must not take: configuration and servo maps. Every value is checked where it
//! enters, from the wire as from storage: neither may put a number into the brain that it cannot live with.

use crate::storage::MAX_SETTINGS;
use crate::{Limits, servo::ServoMap};
use link_protocol::{Configuration, Key, PulseRange, Refusal, ServoSettings, TangentialDrag};
use serde::{Deserialize, Serialize};
use swimmer_model::{Links, Model, Swimmer};

/// Largest trim, 1e-4 rad.
const MAX_TRIM: i16 = 5_000;
/// Longest way to neutral, ms.
const MAX_TO_NEUTRAL_MS: f32 = 1_000.0;
/// Share by which a length may differ from that as built without anybody at the robot.
const LENGTH_ROOM: f32 = 0.1;
/// Smallest angle that a servo's end stops must leave to both sides, rad.
const MIN_REACH: f32 = 1e-2;

/// What is stored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) configuration: Configuration,
    pub(crate) servos: [ServoSettings; 2],
    /// Behind the rest of the record, and only where there is one, as the key after it: records without are from before.
    #[serde(skip)]
    pub(crate) ranges: [Option<PulseRange>; 2],
    #[serde(skip)]
    pub(crate) key: Option<Key>,
}

/// What stands behind the record, told apart by its length: nothing, a key, or ranges with or without a key.
struct Behind {
    ranges: [Option<PulseRange>; 2],
    key: Option<Key>,
}

impl Behind {
    const RANGE: usize = 8;
    const RANGES: usize = 2 * Self::RANGE;
    /// Tells ranges from a key, which has as many bytes.
    const TAG: u8 = b'R';

    fn read(bytes: &[u8]) -> Option<Self> {
        let (ranges, key) = match bytes.split_first() {
            Some((&Self::TAG, rest)) if bytes.len() != Key::LEN => {
                let (ranges, key) = rest.split_first_chunk::<{ Self::RANGES }>()?;
                (Some(ranges), key)
            }
            _ => (None, bytes),
        };
        let key = match key {
            [] => None,
            key => Some(Key(key.try_into().ok()?)),
        };
        let range = |joint: usize| {
            let ranges = ranges?;
            let word = |at: usize| {
                let at = joint * Self::RANGE + at;
                u32::from_le_bytes(core::array::from_fn(|i| ranges[at + i]))
            };
            let range = PulseRange {
                shortest_ns: word(0),
                longest_ns: word(4),
            };
            (range.longest_ns > 0).then_some(range)
        };
        Some(Self {
            ranges: [range(0), range(1)],
            key,
        })
    }
}

impl Settings {
    /// The record for storage.
    pub(crate) fn encode<'a>(&self, bytes: &'a mut [u8; MAX_SETTINGS]) -> Option<&'a mut [u8]> {
        let mut len = postcard::to_slice(self, bytes).ok()?.len();
        let mut put = |part: &[u8]| {
            let place = bytes.get_mut(len..len + part.len())?;
            place.copy_from_slice(part);
            len += part.len();
            Some(())
        };
        if self.ranges.iter().any(Option::is_some) {
            put(&[Behind::TAG])?;
            for range in self.ranges {
                let (shortest, longest) =
                    range.map_or((0, 0), |range| (range.shortest_ns, range.longest_ns));
                put(&shortest.to_le_bytes())?;
                put(&longest.to_le_bytes())?;
            }
        }
        if let Some(key) = &self.key {
            put(&key.0)?;
        }
        bytes.get_mut(..len)
    }

    /// The key of a record, whatever else it holds: limits that have changed must not open the robot.
    pub(crate) fn stored_key(bytes: &[u8]) -> Option<Key> {
        let (_, behind) = postcard::take_from_bytes::<Self>(bytes).ok()?;
        Behind::read(behind)?.key
    }

    /// Reads a record; `None` where it is none that these limits allow.
    pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Option<Self> {
        let (mut settings, behind) = postcard::take_from_bytes::<Self>(bytes).ok()?;
        let Behind { ranges, key } = Behind::read(behind)?;
        (settings.ranges, settings.key) = (ranges, key);
        check_configuration(&settings.configuration, limits).ok()?;
        settings
            .servos
            .iter()
            .try_for_each(|servo| check_servo(servo, limits))
            .ok()?;
        settings.reach(limits).ok()?;
        Some(settings)
    }

    /// The window of a servo's pulses, ns.
    pub(crate) fn window(&self, joint: usize, limits: &Limits) -> PulseRange {
        self.ranges[joint].unwrap_or(PulseRange {
            shortest_ns: limits.pulse_min_ns,
            longest_ns: limits.pulse_max_ns,
        })
    }

    /// The largest angle that the servos' end stops leave to both sides, rad; none where none are set.
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

/// Whether somebody must be at the robot for this: lengths more than a tenth from those as built, or limits beyond those as
/// built. What holds already is no change.
pub(crate) fn needs_presence(
    wanted: &Configuration,
    held: &Configuration,
    built: &Configuration,
) -> bool {
    let lengths = |of: &Configuration| [of.middle_m, of.front_m, of.back_m];
    let same = |one: f32, other: f32| one.to_bits() == other.to_bits();
    let far = (0..3).any(|link| {
        let [wanted, held, built] = [wanted, held, built].map(|of| lengths(of)[link]);
        let near = ((1.0 - LENGTH_ROOM) * built..=(1.0 + LENGTH_ROOM) * built).contains(&wanted);
        !(near || same(wanted, held))
    });
    let beyond = |wanted: f32, held: f32, built: f32| wanted > built && !same(wanted, held);
    far || beyond(wanted.max_angle, held.max_angle, built.max_angle)
        || beyond(wanted.max_rate, held.max_rate, built.max_rate)
}

/// Checks a configuration and prepares its model.
pub(crate) fn check_configuration(
    wanted: &Configuration,
    limits: &Limits,
) -> Result<Model<f32>, Refusal> {
    let within = |field: u8, value: f32, low: f32, high: f32| {
        // A NaN is in no range.
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
    };
    // What is left to be wrong is a half thickness above a link's length.
    Model::new(&swimmer).map_err(|_| Refusal::BadValue { field: 4 })
}

/// Checks a servo's map.
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

/// Checks a trim.
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
            ranges: [None; 2],
            key: None,
        };
        (settings, config.limits)
    }

    proptest! {
        /// Ranges and key stand behind the record, told apart by length and tag: a key may begin with that tag.
        #[test]
        fn a_record_comes_back_with_its_ranges_and_its_key(
            room in [proptest::option::of((1_000_u32..50_000, 1_000_u32..50_000)), proptest::option::of((1_000_u32..50_000, 1_000_u32..50_000))],
            key in proptest::option::of(any::<[u8; Key::LEN]>()),
            tagged: bool,
        ) {
            let (mut settings, limits) = as_built();
            settings.key = key.map(|mut key| {
                if tagged {
                    key[0] = Behind::TAG;
                }
                Key(key)
            });
            for (joint, room) in room.into_iter().enumerate() {
                let neutral_ns = settings.maps()[joint].pulse_ns(0.0);
                settings.ranges[joint] = room.map(|(below, above)| PulseRange {
                    shortest_ns: neutral_ns - below,
                    longest_ns: neutral_ns + above,
                });
            }
            let mut bytes = [0; MAX_SETTINGS];
            let record = settings.encode(&mut bytes).unwrap();
            prop_assert_eq!(Settings::decode(record, &limits), Some(settings));
            prop_assert_eq!(Settings::stored_key(record), settings.key);
            // One byte less or more is another record, or none: never the same with less in it.
            let len = record.len();
            prop_assert_ne!(Settings::decode(&bytes[..len - 1], &limits), Some(settings));
        }
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
