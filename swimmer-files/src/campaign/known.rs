//! Prior knowledge of a laboratory with its uncertainty: the `[known]` table, whose values are written as `"1.00 ± 0.01"`.

use std::str::FromStr;

use serde::Deserialize;
use toml::Spanned;

use super::tank::{RawTank, TankWalls, tank};
use crate::FileError;

/// A value and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownValue {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub width: f64,
}

impl FromStr for KnownValue {
    type Err = String;

    /// `"1.00 ± 0.01"`; `+-` and `+/-` stand for ± where a keyboard has none.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = ["±", "+/-", "+-"]
            .iter()
            .find_map(|sign| text.split_once(sign));
        let numbers = parts.and_then(|(value, width)| {
            let number = |part: &str| part.trim().parse::<f64>().ok();
            Some((number(value)?, number(width)?))
        });
        match numbers {
            Some((value, width)) if value.is_finite() && width.is_finite() && width > 0.0 => {
                Ok(Self { value, width })
            }
            _ => Err(format!(
                "`{text}` is no value with its standard deviation; write it as \"1.00 ± 0.01\""
            )),
        }
    }
}

impl KnownValue {
    fn times(self, unit: f64) -> Self {
        Self {
            value: self.value * unit,
            width: self.width * unit,
        }
    }
}

/// Prior knowledge of the quantities that a fit otherwise assumes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Known {
    /// `gain`: actual over commanded angle of the servos.
    pub gain: Option<KnownValue>,
    /// `camera_scale`: lengths as the cameras give them over true ones.
    pub camera_scale: Option<KnownValue>,
    /// `reflector_mm`: how far the reflectors' middle is from where `at` says, along and across \[m\].
    pub reflector: Option<KnownValue>,
    /// `reflector_deg`: by how much the reflectors' line is turned against the link \[rad\].
    pub reflector_angle: Option<KnownValue>,
    /// `offset_deg`: where the joints' zeros are \[rad\].
    pub offset: Option<KnownValue>,
    /// `dead_band_deg`: the servos' \[rad\].
    pub dead_band: Option<KnownValue>,
    /// `c_t`: over that of the swimmer file.
    pub c_t: Option<KnownValue>,
    /// `period`: over `period_s`.
    pub period: Option<KnownValue>,
    /// `links_mm`: how much longer each link is than the swimmer file says \[m\].
    pub links: Option<KnownValue>,
    /// `float_turning`: the float's rotational drag over that of a sphere of the same drag against translation.
    pub float_turning: Option<KnownValue>,
    /// `camera_stretch`: lengths along the cameras' x over those along y, as their square root: tilt, pixels that are not square.
    pub camera_stretch: Option<KnownValue>,
    /// `lens_distortion`: stretch of lengths at the runs' mean distance from their centre over that at their centre.
    pub lens_distortion: Option<KnownValue>,
    /// `tank`: its walls.
    pub tank: Option<TankWalls>,
    /// `wall_effect`: over that of first order by the tank's walls.
    pub wall_effect: Option<KnownValue>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawKnown {
    gain: Option<Spanned<String>>,
    camera_scale: Option<Spanned<String>>,
    reflector_mm: Option<Spanned<String>>,
    reflector_deg: Option<Spanned<String>>,
    offset_deg: Option<Spanned<String>>,
    dead_band_deg: Option<Spanned<String>>,
    c_t: Option<Spanned<String>>,
    period: Option<Spanned<String>>,
    links_mm: Option<Spanned<String>>,
    float_turning: Option<Spanned<String>>,
    camera_stretch: Option<Spanned<String>>,
    lens_distortion: Option<Spanned<String>>,
    tank: Option<Spanned<RawTank>>,
    wall_effect: Option<Spanned<String>>,
}

pub(super) fn known(
    raw: RawKnown,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Known, FileError> {
    let read = |value: Option<Spanned<String>>, name: &str, unit: f64| {
        let Some(value) = value else { return Ok(None) };
        let place = value.span().start;
        let parsed: Result<KnownValue, String> = value.get_ref().parse();
        let known = parsed.map_err(|problem| error(place, format!("{name}: {problem}")))?;
        Ok(Some(known.times(unit)))
    };
    let ratio = |value: Option<Spanned<String>>, name: &str| {
        let place = value.as_ref().map_or(0, |value| value.span().start);
        let known = read(value, name, 1.0)?;
        match known {
            Some(KnownValue { value, .. }) if value <= 0.0 => {
                Err(error(place, format!("{name} is a ratio: above 0, near 1")))
            }
            known => Ok(known),
        }
    };
    let walls = raw.tank.map(|raw| {
        let place = raw.span().start;
        tank(raw.get_ref()).map_err(|problem| error(place, problem))
    });
    let (millimetre, degree) = (1e-3, 1.0_f64.to_radians());
    Ok(Known {
        gain: ratio(raw.gain, "gain")?,
        camera_scale: ratio(raw.camera_scale, "camera_scale")?,
        reflector: read(raw.reflector_mm, "reflector_mm", millimetre)?,
        reflector_angle: read(raw.reflector_deg, "reflector_deg", degree)?,
        offset: read(raw.offset_deg, "offset_deg", degree)?,
        dead_band: read(raw.dead_band_deg, "dead_band_deg", degree)?,
        c_t: ratio(raw.c_t, "c_t")?,
        period: ratio(raw.period, "period")?,
        links: read(raw.links_mm, "links_mm", millimetre)?,
        float_turning: ratio(raw.float_turning, "float_turning")?,
        camera_stretch: ratio(raw.camera_stretch, "camera_stretch")?,
        lens_distortion: ratio(raw.lens_distortion, "lens_distortion")?,
        tank: walls.transpose()?,
        wall_effect: read(raw.wall_effect, "wall_effect", 1.0)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_with_their_deviations() {
        for text in [
            "0.98 ± 0.01",
            "0.98±0.01",
            "0.98 +- 0.01",
            " 0.98 +/- 0.01 ",
        ] {
            let known: KnownValue = text.parse().unwrap();
            assert_eq!((known.value, known.width), (0.98, 0.01), "{text}");
        }
        for text in ["0.98", "± 0.1", "1 ± 0", "1 ± -1", "1 ± x", "nan ± 1", ""] {
            let problem = text.parse::<KnownValue>().unwrap_err();
            assert!(problem.contains("1.00 ± 0.01"), "{problem}");
        }
    }
}
