//! Ends of singular arcs at which the servo that is free would be too fast: extreme arcs take over there.

use super::arc::MOST_BENDS;
use super::polish::Polished;
use super::setting::Setting;
use super::structure::{Link, Motion, bend, merge};

/// A servo is too fast by more than this share of its rate.
const TOO_FAST: f64 = 1e-7;
/// Places of a singular arc that are looked at.
const LOOKS: usize = 40;

/// The arcs with extreme ones at such ends. Returns `None` without such an end.
pub(super) fn within_rates(setting: &Setting, chain: &Polished) -> Option<Vec<Link>> {
    let mut links = Vec::with_capacity(chain.links.len() + 2);
    let mut slower = false;
    for (arc, link) in chain.links.iter().enumerate() {
        let cut = cut(setting, chain, arc);
        slower |= cut.is_some();
        links.extend(cut.unwrap_or_else(|| vec![link.clone()]));
    }
    slower.then_some(())?;
    // Such an arc bends the more the nearer it comes to its end.
    bend(&mut links, MOST_BENDS);
    for link in &mut links {
        link.between.clear();
    }
    merge(&mut links);
    Some(links)
}

/// Replacement of a singular arc. Returns `None` if no end of it is too fast, or all of it.
fn cut(setting: &Setting, chain: &Polished, arc: usize) -> Option<Vec<Link>> {
    let link = &chain.links[arc];
    let Motion::Singular { pace, way } = link.motion else {
        return None;
    };
    let free = 1 - pace;
    let place = |s: f64| chain.layout.place(&chain.z, arc, s);
    let rate = |s: f64| place(s).rate[free] / link.time;
    let too_fast = |s: &f64| rate(*s).abs() > setting.rates[free] * (1.0 + TOO_FAST);
    let share = |looks: usize| looks as f64 / LOOKS as f64;
    let from_start = (0..LOOKS).map(share).take_while(too_fast).count();
    let from_end = (0..LOOKS).map(|look| 1.0 - share(look));
    let from_end = from_end.take_while(too_fast).count();
    if from_start + from_end == 0 || from_start + from_end >= LOOKS {
        return None;
    }
    let (first, last) = (share(from_start), share(from_end));
    let extreme = |s: f64| {
        let mut ways = [way; 2];
        ways[free] = rate(s).signum();
        Motion::Extreme(ways)
    };
    let mut rest = Link {
        time: link.time * (1.0 - first - last),
        bends: Vec::new(),
        between: (from_start + 1..LOOKS - from_end)
            .map(|look| place(share(look)).phi)
            .collect(),
        ..link.clone()
    };
    let mut links = Vec::with_capacity(3);
    if from_start > 0 {
        links.push(Link {
            motion: extreme(0.0),
            time: first * link.time,
            bends: Vec::new(),
            ..link.clone()
        });
        rest = Link {
            corner: place(first).phi,
            held: Vec::new(),
            anchored: false,
            ..rest
        };
    }
    links.push(rest);
    if from_end > 0 {
        let corner = place(1.0 - last).phi;
        links.push(Link::new(
            corner,
            Vec::new(),
            extreme(1.0),
            last * link.time,
        ));
    }
    Some(links)
}
