//! Comparison of two branches: points at which they merge, and points at which one overtakes the other.

use super::branch_point::BranchPoint;
use super::follow::{Family, Track, smallest, stop};
use super::{ContinuationProblem, Event, EventKind};

/// Largest distance of the curves of equal gaits \[rad\] (as polygons of 96 points); the next constant is the relative difference of
/// their gains.
const SAME_PLACE: f64 = 5e-3;
const SAME_GAIN: f64 = 1e-7;
/// Largest number of bisections for the place of a crossing.
const MOST_HALVINGS: usize = 24;

fn same(a: &BranchPoint, b: &BranchPoint) -> bool {
    (a.gain() - b.gain()).abs() <= SAME_GAIN * a.gain().max(b.gain()) && a.apart(b) < SAME_PLACE
}

/// Events between all pairs of branches.
pub(super) fn meetings<F: Family>(
    problem: &ContinuationProblem,
    family: &F,
    tracks: &[Track],
) -> Vec<Event> {
    let mut events = Vec::new();
    for (first, one) in tracks.iter().enumerate() {
        for (second, two) in tracks.iter().enumerate().skip(first + 1) {
            meeting(problem, family, [(first, one), (second, two)], &mut events);
        }
    }
    events
}

fn meeting<F: Family>(
    problem: &ContinuationProblem,
    family: &F,
    [(first, one), (second, two)]: [(usize, &Track); 2],
    events: &mut Vec<Event>,
) {
    // After a jump two points have the same value; the later one is used.
    let at = |track: &Track, value: f64| {
        let found = track.kept.iter().rev();
        let mut found = found.filter(|kept| kept.value.to_bits() == value.to_bits());
        found.next().cloned()
    };
    let mut last: Option<[BranchPoint; 2]> = None;
    for number in 0..=problem.steps {
        let value = stop(problem, number);
        let (Some(a), Some(b)) = (at(one, value), at(two, value)) else {
            return;
        };
        if same(&a, &b) {
            let (value, within) = match last {
                Some(last) => halved(problem, family, last, value, |[a, b]| !same(a, b)),
                None => (value, 0.0),
            };
            events.push(Event {
                branch: first,
                value,
                within,
                kind: EventKind::Merger { with: second },
            });
            return;
        }
        if let Some(last) = last.take() {
            let ahead = last[0].gain() > last[1].gain();
            if ahead != (a.gain() > b.gain()) {
                let (value, within) = halved(problem, family, last, value, |[a, b]| {
                    (a.gain() > b.gain()) == ahead
                });
                let (branch, by) = if ahead {
                    (first, second)
                } else {
                    (second, first)
                };
                events.push(Event {
                    branch,
                    value,
                    within,
                    kind: EventKind::Overtaken { by },
                });
            }
        }
        last = Some([a, b]);
    }
}

/// Bisects for the parameter at which a property of two gaits that `last` has is lost before `beyond`, and returns it with its
/// uncertainty.
fn halved<F: Family>(
    problem: &ContinuationProblem,
    family: &F,
    mut last: [BranchPoint; 2],
    mut beyond: f64,
    has: impl Fn(&[BranchPoint; 2]) -> bool,
) -> (f64, f64) {
    for _ in 0..MOST_HALVINGS {
        let here = last[0].value;
        if (beyond - here).abs() <= smallest(problem) {
            break;
        }
        let value = 0.5 * (here + beyond);
        let [a, b] = &last;
        let (Ok(a), Ok(b)) = (family.next(value, a, None), family.next(value, b, None)) else {
            break;
        };
        let middle = [a, b];
        if has(&middle) {
            last = middle;
        } else {
            beyond = value;
        }
    }
    let here = last[0].value;
    (0.5 * (here + beyond), 0.5 * (beyond - here).abs())
}
