//! Short extreme arcs near the shape at which gaits join.
//!
//! There the costate may jump, so the neighbouring arcs do not determine the servo direction on the arcs that end there: a
//! polygon without a short arc polishes to a chain whose switching function has the wrong sign at the end at that shape, or whose
//! singular arc ends at a shape with nonzero height. Then a short extreme arc is faster, with that servo in the other direction
//! or, next to a singular arc, at full rate; the polish determines its length.

use nalgebra::Vector2;

use super::super::candidate::mended;
use super::super::polish::Polished;
use super::super::setting::Setting;
use super::super::structure::{Link, Motion};
use super::super::widened::SHORT;

/// Largest number of inserted switches.
pub(super) const MOST: usize = 3;
/// Initial lengths of a new arc, over the shortest.
const LENGTHS: [f64; 2] = [1.0, 16.0];

/// The fastest of the chains with one more extreme arc just before or just after the joint shape. Returns `None` if none is
/// faster.
pub(super) fn switched(setting: &Setting, chain: &Polished) -> Option<Polished> {
    let mut faster: Vec<Polished> = Vec::new();
    for length in LENGTHS {
        let short = length * SHORT * chain.layout.period(&chain.z);
        for end in [(true, 0), (true, 1), (false, 0), (false, 1)] {
            let links = with_switch(setting, chain, end, short);
            let polished = links.and_then(|links| mended(setting, links));
            faster.extend(polished.filter(|other| other.speed > chain.speed * (1.0 + 1e-12)));
        }
    }
    faster
        .into_iter()
        .max_by(|a, b| a.speed.total_cmp(&b.speed))
}

/// The arcs with an additional extreme one that begins or ends at the joint shape. Returns `None` if the arc there is too short,
/// or runs along a bound.
fn with_switch(
    setting: &Setting,
    chain: &Polished,
    (before, number): (bool, usize),
    short: f64,
) -> Option<Vec<Link>> {
    let mut links = chain.links.clone();
    let joint = links.iter().position(|link| link.anchored)?;
    links.rotate_left(joint);
    let old = if before {
        links.last_mut()?
    } else {
        links.first_mut()?
    };
    let ways = extreme(old.motion, number)?;
    let rest = old.time - short;
    if rest <= 0.0 {
        return None;
    }
    old.time = rest;
    let old = old.clone();
    let step = Vector2::from(ways).component_mul(&Vector2::from(setting.rates)) * short;
    let first = links.first_mut()?;
    let joint = first.corner;
    if before {
        links.push(Link::new(
            joint - step,
            Vec::new(),
            Motion::Extreme(ways),
            short,
        ));
    } else {
        (first.motion, first.time) = (Motion::Extreme(ways), short);
        let after = Link {
            bends: std::mem::take(&mut first.bends),
            ..Link::new(joint + step, Vec::new(), old.motion, rest)
        };
        links.insert(1, after);
    }
    Some(links)
}

/// One of the two extreme motions that an arc may lack at its end where gaits join.
fn extreme(motion: Motion, number: usize) -> Option<[f64; 2]> {
    match motion {
        Motion::Extreme(mut ways) => {
            ways[number] = -ways[number];
            Some(ways)
        }
        Motion::Singular { pace, way } => {
            let mut ways = [way; 2];
            ways[1 - pace] = [1.0, -1.0][number];
            Some(ways)
        }
        Motion::Along { .. } => None,
    }
}
