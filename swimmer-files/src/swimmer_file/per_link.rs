//! Value of a key that is one number, or a table with one number for each link.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use toml::Spanned;

/// One number for each link.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinkNumbers {
    pub(super) middle: Spanned<f64>,
    pub(super) front: Spanned<f64>,
    pub(super) back: Spanned<f64>,
}

/// One number, or one for each link.
pub(super) enum OneOrPerLink {
    One(f64),
    PerLink(LinkNumbers),
}

impl<'de> Deserialize<'de> for OneOrPerLink {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = OneOrPerLink;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("f64 or a table of middle, front and back")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
                Ok(OneOrPerLink::One(value))
            }

            #[allow(clippy::cast_precision_loss)] // as serde reads an f64
            fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
                Ok(OneOrPerLink::One(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                LinkNumbers::deserialize(MapAccessDeserializer::new(map)).map(OneOrPerLink::PerLink)
            }
        }

        deserializer.deserialize_any(Either)
    }
}
