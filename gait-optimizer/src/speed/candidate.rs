//! From a start to a polished chain: polygon, arcs, polish, and an active-set update until the arcs fit.

use super::along_clearance;
use super::arc::MOST_BENDS;
use super::interior::{Polygon, best_polygon};
use super::polish::{Polished, polish};
use super::setting::Setting;
use super::structure::{Hold, Link, Motion, arcs, merge};
use super::widened;
use super::within_rates::within_rates;

/// Sides of a finished polygon for each of a rough one.
pub(super) const SIDES: usize = 2;
/// Largest number of active-set updates.
const MENDS: usize = 8;
/// By how much the second variation of a chain may be negative, for shapes of the scale of 1 rad.
const NEARLY: f64 = 1e-4;
/// A corner may overstep a bound by this \[rad, or over L\].
const OVERSTEPPED: f64 = 1e-10;

/// Shares of a polygon's speed that its chain may lose.
const LOST: f64 = 1e-4;
const LOST_ON_BOUNDS: f64 = 0.03;

/// First guesses of a singular arc, over half of any new arc's.
const LENGTHS: [f64; 3] = [1.0, 3.0, 9.0];

/// The chain that a rough polygon leads to, with `times` as many sides.
pub(crate) fn candidate(setting: &Setting, rough: &Polygon, times: usize) -> Option<Polished> {
    let polygon = best_polygon(setting, rough, times)?;
    let links = arcs(setting, &polygon)?;
    // A polish that lost what the polygon had went astray; but only the polygon's corners keep the bounds.
    let lost = if crosses_bounds(setting, &polygon) {
        LOST_ON_BOUNDS
    } else {
        LOST
    };
    let keeps = |chain: &Polished| chain.speed > polygon.speed * (1.0 - lost);
    let once = lap(setting, &links);
    let of_links = |links| mended(setting, links).filter(keeps);
    once.into_iter().chain([links]).find_map(of_links)
}

/// Returns `true` if a side of a polygon oversteps a bound between its corners.
fn crosses_bounds(setting: &Setting, polygon: &Polygon) -> bool {
    let middle = |side| {
        let [from, to] = polygon.layout.ends(&polygon.z, side);
        0.5 * (from + to)
    };
    (0..polygon.layout.arcs()).any(|side| setting.region.overstepped(&middle(side)) > OVERSTEPPED)
}

/// The links of one lap of a chain that runs a shorter one several times over.
fn lap(setting: &Setting, links: &[Link]) -> Option<Vec<Link>> {
    /// Over the scale of the shapes.
    const SAME: f64 = 1e-2;
    // A gait that joins others passes where they join once.
    if setting.asked.period.is_some() || setting.asked.anchor.is_some() {
        return None;
    }
    let count = links.len();
    let same = SAME * setting.region.scale();
    let repeats = |lap: &usize| {
        let later = links.iter().cycle().skip(*lap);
        let mut pairs = links.iter().zip(later);
        count.is_multiple_of(*lap)
            && pairs.all(|(a, b)| a.motion == b.motion && (a.corner - b.corner).norm() < same)
    };
    let lap = (3..=count / 2).find(repeats)?;
    Some(links[..lap].to_vec())
}

/// Polishes, and updates the active set until the arcs fit: violated bounds become active, corners that rest on a bound become
/// arcs along it, arcs of negative length are removed, ends of singular arcs at which a servo is too fast become extreme, and
/// bounds with a negative multiplier are released.
pub(crate) fn mended(setting: &Setting, mut links: Vec<Link>) -> Option<Polished> {
    for _ in 0..MENDS {
        widened::along_bounds(setting, &mut links);
        along_clearance::split(setting, &mut links);
        let polished = polish(setting, &links)?;
        let mut next = polished.links.clone();
        if widened::without_backwards(&mut next) {
            merge(&mut next);
            if next.len() < 3 {
                return None;
            }
            links = next;
            continue;
        }
        if let Some(slower) = within_rates(setting, &polished) {
            links = slower;
            continue;
        }
        let mut changed = false;
        for (k, link) in next.iter_mut().enumerate() {
            changed |= overstepped(setting, link);
            let pushes = &polished.hold_pushes[k];
            let before = &polished.links[(k + links.len() - 1) % links.len()].motion;
            let motion = link.motion;
            let mut at = 0;
            link.held.retain(|hold| {
                let push = pushes.get(at).copied().unwrap_or(0.0);
                at += 1;
                let needed = [&motion, before].iter().any(|motion| follows(motion, hold));
                let keep = needed || push * setting.region.scale() > -1e-9;
                changed |= !keep;
                keep
            });
        }
        if !changed {
            // Few bends may represent a long singular arc so loosely that its end hardly matters, and for joined gaits an arc may
            // remain that a slightly higher speed would remove: the certificate decides.
            let nearly = NEARLY / setting.region.scale().powi(2);
            return (polished.convexity > -nearly).then_some(polished);
        }
        links = next;
    }
    None
}

/// Certified form of a chain: the chain itself, or one with more bends.
pub(super) fn certified_closely<T>(
    setting: &Setting,
    chain: &Polished,
    passes: impl Fn(&Polished) -> Option<T>,
) -> Option<T> {
    let finer = || {
        let mut links = chain.links.clone();
        with_more_bends(&mut links).then(|| mended(setting, links))?
    };
    passes(chain).or_else(|| passes(&finer()?))
}

/// The same, or with short singular arcs that its polygon had no corners left for: that costs many a polish.
pub(super) fn certified<T>(
    setting: &Setting,
    chain: &Polished,
    passes: impl Fn(&Polished) -> Option<T>,
) -> Option<T> {
    certified_closely(setting, chain, &passes).or_else(|| passes(&bent(setting, chain)?))
}

/// Gives singular arcs as many bends as they may have; whether one had fewer.
fn with_more_bends(links: &mut [Link]) -> bool {
    let mut more = false;
    for link in links {
        if matches!(link.motion, Motion::Singular { .. }) && link.bends.len() < MOST_BENDS {
            link.bends.resize(MOST_BENDS, 0.0);
            more = true;
        }
    }
    more
}

/// The chain with short singular arcs at the corners of extreme arcs, between themselves or with arcs along bounds, if that is
/// faster. Returns `None` if no corner gains.
fn bent(setting: &Setting, chain: &Polished) -> Option<Polished> {
    let mut best: Option<Polished> = None;
    let mut corner = 0;
    loop {
        let here = best.as_ref().unwrap_or(chain);
        if corner >= here.links.len() {
            return best;
        }
        let short = widened::SHORT * here.layout.period(&here.z);
        let better = |links: Vec<Link>| {
            mended(setting, links).filter(|bent| {
                bent.speed > here.speed * (1.0 + 1e-14) && bent.links.len() > here.links.len()
            })
        };
        let faster = LENGTHS.into_iter().find_map(|length| {
            widened::with_singular(&here.links, corner, length * short).and_then(better)
        });
        if faster.is_some() {
            best = faster;
            corner += 1;
        }
        corner += 1;
    }
}

/// `true` if an arc runs along the bound that holds a corner.
fn follows(motion: &Motion, hold: &Hold) -> bool {
    motion.bound().is_some_and(|bound| bound.0 == hold.0)
}

/// Holds a corner at the bounds that it oversteps; whether there are any.
fn overstepped(setting: &Setting, link: &mut Link) -> bool {
    let mut any = false;
    for (index, bound) in setting.region.bounds().enumerate() {
        let held = link.held.iter().any(|hold| hold.0 == index);
        if !held && bound.margin(&link.corner) < -OVERSTEPPED {
            link.held.push(Hold(index, bound.piece(&link.corner)));
            any = true;
        }
    }
    any
}
