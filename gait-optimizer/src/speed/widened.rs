//! Corners in whose place a short arc is faster.

use nalgebra::Vector2;

use super::setting::Setting;
use super::structure::{Hold, Link, Motion, remove};

/// Half of a new arc's first guess, over the period.
pub(super) const SHORT: f64 = 3e-3;

/// Puts an arc along the bound in place of every corner that rests on one, between arcs that do not run along bounds.
///
/// Such a corner is never the fastest: pushed over the bound by δ it gains in proportion to δ, and what the bound then cuts off is
/// an area in proportion to δ², round which the servos go in no more time than round its tip.
pub(super) fn along_bounds(setting: &Setting, links: &mut Vec<Link>) {
    let period: f64 = links.iter().map(|link| link.time).sum();
    let short = SHORT * period;
    let old = std::mem::take(links);
    for (corner, link) in old.iter().enumerate() {
        let before = &old[(corner + old.len() - 1) % old.len()];
        let after = &old[(corner + 1) % old.len()];
        let off_bounds = [before, link]
            .iter()
            .all(|link| link.motion.bound().is_none());
        let arc = match link.held[..] {
            [hold] if off_bounds => {
                along(setting, hold, [before, link, after].map(|link| link.corner))
            }
            _ => None,
        };
        let Some((motion, way)) = arc else {
            links.push(link.clone());
            continue;
        };
        let (from, to) = (link.corner - way * short, link.corner + way * short);
        links.push(Link::new(from, link.held.clone(), motion, 2.0 * short));
        links.push(Link {
            corner: to,
            anchored: false,
            ..link.clone()
        });
    }
}

/// The arc along a bound past the second of three corners, and the joint rates on it. Returns `None` if the other two corners do
/// not lie inside.
fn along(
    setting: &Setting,
    hold: Hold,
    [before, at, after]: [Vector2<f64>; 3],
) -> Option<(Motion, Vector2<f64>)> {
    let inwards = setting.region.bound(hold.0)?.gradient(&at);
    if inwards.dot(&(before - at)) <= 0.0 || inwards.dot(&(after - at)) <= 0.0 {
        return None;
    }
    let tangent = Vector2::new(-inwards.y, inwards.x);
    let tangent = tangent * tangent.dot(&(after - before)).signum();
    let turning = tangent / setting.time(&tangent);
    let shares = [0, 1].map(|joint| turning[joint].abs() / setting.rates[joint]);
    let pace = usize::from(shares[1] > shares[0]);
    let motion = Motion::Along {
        bound: hold,
        pace,
        way: turning[pace].signum(),
    };
    Some((motion, turning))
}

/// Removes arcs of negative length: those along bounds between free arcs all at once, and they release their corner; of others
/// the worst. Returns `true` if there were any.
pub(super) fn without_backwards(links: &mut Vec<Link>) -> bool {
    let count = links.len();
    let on_bound = |k: usize| links[k % count].motion.bound().is_some();
    let touches: Vec<usize> = (0..count)
        .filter(|&k| {
            links[k].time <= 0.0
                && !links[k].anchored
                && on_bound(k)
                && !on_bound(k + count - 1)
                && !on_bound(k + 1)
        })
        .collect();
    for &k in touches.iter().rev() {
        links[(k + 1) % count].held.clear();
    }
    if !touches.is_empty() {
        let mut at = 0;
        links.retain(|_| {
            at += 1;
            !touches.contains(&(at - 1))
        });
        return true;
    }
    let worst = (0..count).min_by(|&a, &b| links[a].time.total_cmp(&links[b].time));
    match worst {
        Some(worst) if links[worst].time <= 0.0 => {
            remove(links, worst);
            true
        }
        _ => false,
    }
}

/// The arcs with a singular one at a corner between two arcs of which one is extreme and the other extreme or along a bound; none
/// where it is another corner.
pub(super) fn with_singular(links: &[Link], corner: usize, short: f64) -> Option<Vec<Link>> {
    let before = (corner + links.len() - 1) % links.len();
    let (old, new) = (links[before].motion, links[corner].motion);
    if links[corner].anchored {
        return None;
    }
    // Reach of the new arc before and after the corner, and the bounds that hold its ends.
    let (back, ahead, held, (pace, way)) = match (old, new) {
        (Motion::Extreme(old), Motion::Extreme(new)) if links[corner].held.is_empty() => {
            let pace = (0..2).find(|&joint| (old[joint] - new[joint]).abs() < 0.5)?;
            (short, short, [None, None], (pace, new[pace]))
        }
        (along, Motion::Extreme(_)) => {
            (2.0 * short, 0.0, [Some(along.bound()?), None], along.pace())
        }
        (Motion::Extreme(_), along) => {
            (0.0, 2.0 * short, [None, Some(along.bound()?)], along.pace())
        }
        _ => return None,
    };
    let rate = |before: usize, joint: usize| {
        // Radians a second of the arcs that are there.
        let next = (before + 1) % links.len();
        (links[next].corner[joint] - links[before].corner[joint]) / links[before].time
    };
    let off = |arc: usize, time: f64| Vector2::new(rate(arc, 0), rate(arc, 1)) * time;
    let [from, to] = held.map(|hold| hold.into_iter().collect());
    let mut longer = links.to_vec();
    let at = links[corner].corner;
    longer[before].time -= back;
    longer[corner].time -= ahead;
    longer[corner].corner = at + off(corner, ahead);
    longer[corner].held = to;
    let (start, motion) = (at - off(before, back), Motion::Singular { pace, way });
    longer.insert(corner, Link::new(start, from, motion, back + ahead));
    Some(longer)
}
