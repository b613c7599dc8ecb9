//! What an operator set and a power cut must not take: configuration and servo maps. Every value is checked where it
//! enters, from the wire as from storage: neither may put a number into the brain that it cannot live with.

use crate::storage::MAX_SETTINGS;
use crate::{Limits, servo::ServoMap};
use link_protocol::{Configuration, Key, Refusal, ServoSettings, TangentialDrag};
use serde::{Deserialize, Serialize};
use swimmer_model::{Links, Model, Swimmer};

/// Largest trim, 1e-4 rad.
const MAX_TRIM: i16 = 5_000;
/// Longest way to neutral, ms.
const MAX_TO_NEUTRAL_MS: f32 = 1_000.0;

/// What is stored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) configuration: Configuration,
    pub(crate) servos: [ServoSettings; 2],
    /// Stands behind the rest of the record, and only where there is one: a record without is what it was before keys.
    #[serde(skip)]
    pub(crate) key: Option<Key>,
}

impl Settings {
    /// The record for storage.
    pub(crate) fn encode<'a>(&self, bytes: &'a mut [u8; MAX_SETTINGS]) -> Option<&'a mut [u8]> {
        match &self.key {
            Some(key) => postcard::to_slice(&(self, key), bytes).ok(),
            None => postcard::to_slice(self, bytes).ok(),
        }
    }

    /// The key of a record, whatever else it holds: limits that have changed must not open the robot.
    pub(crate) fn stored_key(bytes: &[u8]) -> Option<Key> {
        let (_, key) = postcard::take_from_bytes::<Self>(bytes).ok()?;
        key.try_into().ok().map(Key)
    }

    /// Reads a record; `None` where it is none that these limits allow.
    pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Option<Self> {
        let (mut settings, rest) = postcard::take_from_bytes::<Self>(bytes).ok()?;
        settings.key = Self::stored_key(bytes);
        if settings.key.is_none() && !rest.is_empty() {
            return None;
        }
        check_configuration(&settings.configuration, limits).ok()?;
        settings
            .servos
            .iter()
            .try_for_each(|servo| check_servo(servo, limits))
            .ok()?;
        Some(settings)
    }

    pub(crate) fn maps(&self) -> [ServoMap; 2] {
        self.servos.map(ServoMap::from)
    }
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
