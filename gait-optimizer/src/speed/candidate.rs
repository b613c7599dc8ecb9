//! From a start to a polished chain: polygon, arcs, polish, and the arcs mended where the polish shows them wrong.

use nalgebra::Vector2;

use super::interior::{Polygon, best_polygon};
use super::polish::{Polished, polish};
use super::problem::Setting;
use super::structure::{Hold, Link, Motion, arcs, merge};

/// Times that the arcs are mended.
const MENDS: usize = 8;
/// A corner may overstep a bound by this \[rad, or over L\].
const OVERSTEPPED: f64 = 1e-10;

/// The chain that a rough polygon leads to.
pub(crate) fn candidate(setting: &Setting, rough: &Polygon) -> Option<Polished> {
    let polygon = best_polygon(setting, rough)?;
    let links = arcs(setting, &polygon)?;
    let polished = mended(setting, links)?;
    // A polish that lost what the polygon had went astray.
    (polished.speed > polygon.speed * (1.0 - 1e-4)).then_some(polished)
}

/// Polishes, and mends the arcs until they fit: arcs that run backwards go, bounds that pull let go, bounds that are overstepped
/// hold.
fn mended(setting: &Setting, mut links: Vec<Link>) -> Option<Polished> {
    for _ in 0..MENDS {
        let polished = polish(setting, &links)?;
        let backwards = polished
            .links
            .iter()
            .enumerate()
            .min_by(|a, b| a.1.time.total_cmp(&b.1.time))?;
        if backwards.1.time <= 0.0 {
            let gone = backwards.0;
            links.clone_from(&polished.links);
            links.remove(gone);
            merge(&mut links);
            if links.len() < 3 {
                return None;
            }
            continue;
        }
        let mut next = polished.links.clone();
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
                let keep = needed || push > -1e-9;
                changed |= !keep;
                keep
            });
        }
        if !changed {
            return (polished.convexity > 0.0).then_some(polished);
        }
        links = next;
    }
    None
}

/// The chain with short singular arcs in place of the corners between extreme arcs where that is faster; none where it is nowhere.
pub(crate) fn bent(setting: &Setting, chain: &Polished) -> Option<Polished> {
    /// Length of the first guess, over the period.
    const SHORT: f64 = 3e-3;
    let mut best: Option<Polished> = None;
    let mut corner = 0;
    loop {
        let here = best.as_ref().unwrap_or(chain);
        if corner >= here.links.len() {
            return best;
        }
        let short = SHORT * here.layout.period(&here.z);
        let faster = with_singular(&here.links, corner, short)
            .and_then(|links| mended(setting, links))
            .filter(|bent| {
                bent.speed > here.speed * (1.0 + 1e-14) && bent.links.len() > here.links.len()
            });
        if faster.is_some() {
            best = faster;
            corner += 1;
        }
        corner += 1;
    }
}

/// The arcs with a singular one in place of the corner between two extreme ones; none where it is another corner.
fn with_singular(links: &[Link], corner: usize, short: f64) -> Option<Vec<Link>> {
    let before = (corner + links.len() - 1) % links.len();
    let (Motion::Extreme(old), Motion::Extreme(new)) = (links[before].motion, links[corner].motion)
    else {
        return None;
    };
    let pace = (0..2).find(|&joint| (old[joint] - new[joint]).abs() < 0.5)?;
    if !links[corner].held.is_empty() {
        return None;
    }
    let rate = |before: usize, joint: usize| {
        // Radians a second of the arcs that are there.
        let next = (before + 1) % links.len();
        (links[next].corner[joint] - links[before].corner[joint]) / links[before].time
    };
    let mut longer = links.to_vec();
    let at = links[corner].corner;
    let off = |arc: usize, time: f64| Vector2::new(rate(arc, 0), rate(arc, 1)) * time;
    longer[before].time -= short;
    longer[corner].time -= short;
    longer[corner].corner = at + off(corner, short);
    longer.insert(
        corner,
        Link {
            corner: at - off(before, short),
            held: Vec::new(),
            motion: Motion::Singular {
                pace,
                way: new[pace],
            },
            time: 2.0 * short,
            bends: Vec::new(),
            between: Vec::new(),
        },
    );
    Some(longer)
}

/// Whether an arc runs along what holds a corner.
fn follows(motion: &Motion, hold: &Hold) -> bool {
    let Hold::On(held, _) = hold;
    matches!(motion, Motion::Straight { bound, .. } | Motion::Curved { bound, .. } if bound == held)
}

/// Holds a corner at the bounds that it oversteps; whether there are any.
fn overstepped(setting: &Setting, link: &mut Link) -> bool {
    let mut any = false;
    for (index, bound) in setting.region.bounds().enumerate() {
        let held = link
            .held
            .iter()
            .any(|hold| matches!(hold, Hold::On(at, _) if *at == index));
        if !held && bound.margin(&link.corner) < -OVERSTEPPED {
            link.held.push(Hold::On(index, bound.piece(&link.corner)));
            any = true;
        }
    }
    any
}
