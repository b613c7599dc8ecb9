//! Priors: as the campaign states them, else the usual widths of a careful laboratory.

use swimmer_files::KnownValue;

use crate::fit::CampaignFit;
use crate::fit::REFLECTOR;
use crate::fit::parameter::Parameter;
use crate::fit::prior::Prior;
use crate::fit::run_model::RunModel;

/// Lengths of the links \[m\], unless the campaign states them.
const LINKS: f64 = 3e-4;
/// A servo's gain, joint offsets \[rad\] and the cameras' scale, unless the campaign states them.
const GAIN: f64 = 0.005;
const OFFSET: f64 = 0.3 * std::f64::consts::PI / 180.0;
const SCALE: f64 = 0.002;
/// Stretch of the image (tilted cameras, pixels that are not square) and lens distortion at the runs' mean distance from the image
/// centre, where the campaign says nothing.
const STRETCH: f64 = 0.001;
const DISTORTION: f64 = 0.003;
/// Effect of the walls of a tank that the campaign states, over that of first order: higher orders of radius over distance.
const WALL_EFFECT: f64 = 0.3;

/// Prior of one parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) prior: Prior,
    /// `true` if the campaign states it.
    pub(super) stated: bool,
}

/// All that has a width.
pub(super) fn priors(found: &CampaignFit, model: &RunModel) -> Vec<Known> {
    let (length, known) = (found.length(), &found.known);
    let distance = found
        .runs
        .iter()
        .find(|run| !run.is_reported())
        .map_or(length, |run| run.poses.report.distance_m);
    let reflector = known.reflector.map_or(REFLECTOR, |known| known.width);
    let usual = |value: f64, width: f64| KnownValue { value, width };
    // A side link's reflector shows its angle as well as it is placed, seen from the joint.
    let reaches = found
        .runs
        .iter()
        .find_map(|run| run.played.sides)
        .map(|sides| sides.reach);
    let link = |joint: usize| reaches.map(|reaches| usual(0.0, reflector / reaches[joint]));
    // Both reflectors are placed as well as their middle, to an unknown factor.
    let angle = usual(0.0, std::f64::consts::SQRT_2 * reflector / distance);
    let links = Some(usual(0.0, LINKS));
    let of = |parameter, stated: Option<KnownValue>, usual| {
        known_of(parameter, stated.or(usual)?, stated.is_some(), length)
    };
    [
        of(Parameter::Gain, known.gain, Some(usual(1.0, GAIN))),
        of(
            Parameter::Scale,
            known.camera_scale,
            Some(usual(1.0, SCALE)),
        ),
        of(
            Parameter::MarkerAlong,
            known.reflector,
            Some(usual(0.0, REFLECTOR)),
        ),
        of(
            Parameter::MarkerAcross,
            known.reflector,
            Some(usual(0.0, REFLECTOR)),
        ),
        of(Parameter::MarkerAngle, known.reflector_angle, Some(angle)),
        of(
            Parameter::FrontOffset,
            known.offset,
            Some(usual(0.0, OFFSET)),
        ),
        of(
            Parameter::BackOffset,
            known.offset,
            Some(usual(0.0, OFFSET)),
        ),
        of(Parameter::FrontLink, None, link(0)),
        of(Parameter::BackLink, None, link(1)),
        of(Parameter::DeadBand, known.dead_band, None),
        of(Parameter::TangentialDrag, known.c_t, None),
        of(Parameter::Period, known.period, None),
        of(Parameter::MiddleLength, known.links, links),
        of(Parameter::FrontLength, known.links, links),
        of(Parameter::BackLength, known.links, links),
        of(Parameter::FloatTurning, known.float_turning, None),
        of(
            Parameter::StretchSquare,
            known.camera_stretch,
            Some(usual(1.0, STRETCH)),
        ),
        of(
            Parameter::StretchDiagonal,
            known.camera_stretch,
            Some(usual(1.0, STRETCH)),
        ),
        of(
            Parameter::Distortion,
            known.lens_distortion,
            Some(usual(1.0, DISTORTION)),
        ),
        of(
            Parameter::WallEffect,
            known.wall_effect,
            known.tank.map(|_| usual(1.0, WALL_EFFECT)),
        ),
    ]
    .into_iter()
    .flatten()
    .filter(|known| model.has_use_for(known.prior.parameter))
    .collect()
}

/// Prior of a parameter in the fit's units; `None` without a width. `length` is L \[m\].
fn known_of(parameter: Parameter, known: KnownValue, stated: bool, length: f64) -> Option<Known> {
    let KnownValue { value, width } = known;
    let (centre, unit) = match parameter {
        Parameter::Gain
        | Parameter::Scale
        | Parameter::Period
        | Parameter::StretchSquare
        | Parameter::StretchDiagonal
        | Parameter::Distortion => (value - 1.0, 1.0),
        Parameter::TangentialDrag | Parameter::FloatTurning => (value.ln(), value),
        Parameter::MarkerAlong
        | Parameter::MarkerAcross
        | Parameter::MiddleLength
        | Parameter::FrontLength
        | Parameter::BackLength => (value / length, length),
        _ => (value, 1.0),
    };
    (width > 0.0).then_some(Known {
        prior: Prior {
            parameter,
            value: centre,
            width: width / unit,
        },
        stated,
    })
}
