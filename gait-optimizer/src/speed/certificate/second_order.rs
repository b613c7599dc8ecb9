//! The second-order condition over shifts of corners, times and bends of singular arcs, from the curve alone.

use swimmer_files::ArcKind;

use super::super::polish::{BENDS, second_variation};
use super::super::setting::Setting;
use super::super::structure::{Hold, Link, Motion, bend, holds, merge};
use super::legs::Legs;
use super::switching::along;
use super::{RESTS, on_bound};

/// The least eigenvalue of the second variation of ln T − ln |d| on the tangent space of the arcs' equations. Returns `None` for
/// invalid arcs.
pub(super) fn least(setting: &Setting, legs: &Legs) -> Option<f64> {
    let links: Option<Vec<Link>> = legs
        .all
        .iter()
        .map(|leg| {
            let pace = legs.pace(leg);
            let way = leg.ways[pace];
            let motion = if leg.kind == ArcKind::Extreme {
                Motion::Extreme(leg.ways)
            } else if on_bound(leg) {
                let middle = leg.panels.get(leg.panels.len() / 2)?.first()?;
                let (index, bound) = along(setting.region, middle)?;
                Motion::Along {
                    bound: Hold(index, bound.piece(&middle.phi)),
                    pace,
                    way,
                }
            } else {
                Motion::Singular { pace, way }
            };
            Some(Link {
                corner: leg.from,
                held: holds(setting, &leg.from, RESTS),
                anchored: setting.asked.joins(&leg.from),
                motion,
                time: leg.share,
                bends: Vec::new(),
                between: leg.panels.iter().flatten().map(|node| node.phi).collect(),
            })
        })
        .collect();
    let mut links = links?;
    // Where the samples begin within an arc, a shift of that place changes nothing.
    merge(&mut links);
    bend(&mut links, BENDS);
    second_variation(setting, &links)
}
