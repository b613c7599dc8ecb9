//! hp refinement: elements whose error is too large get a higher degree where the solution is smooth; where it is not, as
//! at the ends of a stay on a bound, an element's end is put where the kink is.
//!
//! After M. A. Patterson, W. W. Hager, A. V. Rao, *A ph mesh refinement method for optimal control*, Optim. Control Appl.
//! Meth. 36 (2015): the degree is raised by what an error of order d^−d promises, up to a limit. Kinks are no guess here:
//! the multiplier of the bound jumps there, and the margin before it grows as a square.

use super::mesh::{Element, Mesh};
use super::newton::Optimum;
use super::reintegration::Reintegration;
use super::walls::Wall;

/// What to do with a mesh.
#[derive(Debug)]
pub(crate) enum Verdict {
    Good,
    Finer(Mesh),
}

/// Above this degree an element is split instead.
const SMOOTH_DEGREE: usize = 10;
/// A tolerance of 10⁻⁸ lets a bound be overstepped by 10⁻⁵ rad between nodes.
const OVERSTEPPED: f64 = 10.0;
/// Degree of the parts of an element that was split.
const SPLIT_DEGREE: usize = 5;
/// A kink nearer to an end than this share of its element draws the end to it; one farther off splits the element.
const NEAR_END: f64 = 0.25;
/// An end this near to a kink, over its element's length, is as good as on it.
const ON_KINK: f64 = 1e-4;
/// At this distance it may still move, but is no excuse for an error that is elsewhere.
const AT_KINK: f64 = 0.02;

/// Where stays on bounds begin and end, in order of time.
pub(crate) fn kinks(mesh: &Mesh, walls: &[Wall], optimum: &Optimum) -> Vec<f64> {
    let mut kinks = Vec::new();
    let count = walls.len();
    for (k, wall) in walls.iter().enumerate() {
        let multiplier = |point: usize| optimum.multipliers[point * count + k];
        let largest = (0..mesh.len()).map(multiplier).fold(0.0, f64::max);
        if largest < super::ACTIVE_AT_ALL {
            continue;
        }
        let active = |point: usize| multiplier(point) > super::ACTIVE * largest;
        let root = |point: usize| wall.value(&optimum.path.phi[point]).max(0.0).sqrt();
        // From the two last points off the wall: √margin falls to zero almost as a straight line.
        let kink = |off: [usize; 2], on: usize| {
            let (t, r) = (off.map(|point| mesh.times[point]), off.map(root));
            let zero = t[0] + (t[0] - t[1]) * r[0] / (r[1] - r[0]);
            let (low, high) = (t[0].min(mesh.times[on]), t[0].max(mesh.times[on]));
            if zero.is_finite() {
                zero.clamp(low, high)
            } else {
                0.5 * (low + high)
            }
        };
        for point in 2..mesh.len() {
            if active(point) && !active(point - 1) {
                kinks.push(kink([point - 1, point - 2], point));
            }
        }
        for point in 0..mesh.len().saturating_sub(2) {
            if active(point) && !active(point + 1) {
                kinks.push(kink([point + 1, point + 2], point));
            }
        }
    }
    kinks.sort_by(f64::total_cmp);
    kinks
}

/// Compares the errors with the tolerance. Efficiency is lost as the square of the unevenness of the power.
/// Ends near a kink move by `pace` times the way to it: an end beyond a kink is told to come back too far, about as much
/// as one before it is told to go on.
pub(crate) fn judge(
    mesh: &Mesh,
    kinks: &[f64],
    pace: f64,
    again: &Reintegration,
    tolerance: f64,
) -> Verdict {
    let uneven = again.uneven_power().powi(2);
    let beyond = |overstepped: f64| (OVERSTEPPED * overstepped).powi(2);
    if again.error().max(uneven).max(beyond(again.overstepped())) <= tolerance {
        return Verdict::Good;
    }
    // A kink inside an element lets the power differ before and after it: everywhere, not only there.
    let local: Vec<f64> = again
        .errors
        .iter()
        .zip(&again.power)
        .zip(&again.overstepped)
        .map(|((&error, &[low, high]), &overstepped)| {
            error.max((high - low).powi(2)).max(beyond(overstepped))
        })
        .collect();
    let off_kink = mesh
        .elements
        .iter()
        .filter_map(|element| kink_within(element, kinks))
        .any(|place| (AT_KINK..=1.0 - AT_KINK).contains(&place));
    let global = (!off_kink && local.iter().all(|&off| off <= tolerance)).then_some(uneven);
    let mut ends = vec![0.0];
    let mut degrees = Vec::new();
    let mut moved: Vec<(usize, f64)> = Vec::new();
    for (element, &local) in mesh.elements.iter().zip(&local) {
        let degree = element.rule.degree;
        // A kink is placed as well as its surroundings are known.
        let better = (degree + 1).min(SMOOTH_DEGREE);
        let mut parts = vec![degree];
        let mut cut = 0.5;
        let (first, last) = (element.first == 0, element.end() >= 1.0);
        let off = global.unwrap_or(local);
        match kink_within(element, kinks) {
            Some(place) if place < NEAR_END && !first => {
                let to = place * pace;
                moved.push((ends.len() - 1, element.start + to * element.length));
                parts = vec![better];
            }
            Some(place) if place > 1.0 - NEAR_END && !last => {
                let to = 1.0 - (1.0 - place) * pace;
                moved.push((ends.len(), element.start + to * element.length));
                parts = vec![better];
            }
            Some(place) => {
                cut = place;
                parts = vec![better; 2];
            }
            None if off > tolerance => parts = raised(degree, off / tolerance),
            None => {}
        }
        if parts.len() == 2 {
            ends.push(element.start + cut * element.length);
        }
        ends.push(element.end());
        degrees.extend(parts);
    }
    for (end, to) in moved {
        if let Some(end) = ends.get_mut(end) {
            *end = to;
        }
    }
    if let Some(last) = ends.last_mut() {
        *last = 1.0;
    }
    Verdict::Finer(Mesh::new(&ends, &degrees))
}

/// Where in an element, 0 to 1, the first kink lies that is not at one of its ends.
fn kink_within(element: &Element, kinks: &[f64]) -> Option<f64> {
    kinks
        .iter()
        .map(|kink| (kink - element.start) / element.length)
        .find(|place| (ON_KINK..=1.0 - ON_KINK).contains(place))
}

/// Degrees of the parts of an element that is smooth, and this many times off.
fn raised(degree: usize, off: f64) -> Vec<usize> {
    let more = (off.ln() / (degree as f64).ln()).ceil();
    // Compared as they are, so that no number is too large to convert.
    let raised = (degree + 1..=SMOOTH_DEGREE).find(|&raised| (raised - degree) as f64 >= more);
    raised.map_or_else(|| vec![degree.min(SPLIT_DEGREE); 2], |raised| vec![raised])
}
