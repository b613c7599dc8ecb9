//! Arcs along the clearance, split where the curve changes its piece and where the other servo becomes the one at full rate.
//!
//! Along a curved bound the servo at full rate is the one that turns faster. Where the curve's direction passes that of both rates, the
//! servos change over. If the allowed shapes are convex there, an extreme arc along a chord is faster: it saves time of second order in
//! its length, for an area of third order. Otherwise the chord is forbidden, and the servos change over on the curve. The time along the
//! curve is then the largest over all places of the change, so that a maximum of the speed does not determine it: an equation does
//! ([`transition`]).

use nalgebra::{Matrix2, Vector2};

use super::setting::Setting;
use super::structure::{Hold, Link, Motion};
use crate::numerics::halved;
use crate::region::{Bound, Clearance, Level, Piece};

/// Longest step along the curve \[rad\].
const STEP: f64 = 0.02;
const MOST_STEPS: usize = 1000;
/// Step over a transition \[rad\].
const OVER: f64 = 1e-9;
/// Farthest from the curve \[rad, or over L\].
const OFF: f64 = 1e-9;

/// What an arc along the clearance keeps from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    piece: Piece,
    pace: usize,
    way: f64,
}

/// A part of the curve in one state.
struct Span {
    from: Vector2<f64>,
    state: State,
    time: f64,
}

/// Splits every run of arcs along the clearance into arcs of one piece and one servo at full rate, with an extreme arc between them if
/// that is faster. Runs that are split right stay as they are.
pub(super) fn split(setting: &Setting, links: &mut Vec<Link>) {
    let index = |link: &Link| match link.motion {
        Motion::Along {
            bound: Hold(index, Some(_)),
            ..
        } => Some(index),
        _ => None,
    };
    let count = links.len();
    let begins = |&k: &usize| index(&links[k]) != index(&links[(k + count - 1) % count]);
    let Some(first) = (0..count).find(begins) else {
        return;
    };
    links.rotate_left(first);
    let old = std::mem::take(links);
    let mut at = 0;
    // Piece that holds the corner after a run.
    let mut ends_on: Option<Hold> = None;
    while let Some(link) = old.get(at) {
        let run = index(link).map_or(1, |own| {
            let rest = old.iter().skip(at);
            rest.take_while(|other| index(other) == Some(own)).count()
        });
        let end = old[(at + run) % count].corner;
        let spans = index(link).and_then(|index| spans(setting, index, link.corner, end));
        let before = links.len();
        match spans {
            Some(spans) if !spans.is_empty() && !is_split_so(&old[at..at + run], &spans) => {
                links.extend(cut_short(setting, arcs(link, &spans)));
            }
            _ => links.extend_from_slice(&old[at..at + run]),
        }
        if let (Some(hold), Some(next)) = (ends_on.take(), links.get_mut(before)) {
            held_by(next, hold);
        }
        ends_on = links.last().and_then(|last| last.motion.bound());
        at += run;
    }
    if let (Some(hold), Some(next)) = (ends_on, links.first_mut()) {
        held_by(next, hold);
    }
}

/// A corner that a bound holds is held by this piece of it.
fn held_by(link: &mut Link, by: Hold) {
    for hold in link.held.iter_mut().filter(|hold| hold.0 == by.0) {
        *hold = by;
    }
}

fn is_split_so(links: &[Link], spans: &[Span]) -> bool {
    let same = |(link, span): (&Link, &Span)| match link.motion {
        Motion::Along { bound, pace, way } => {
            let State {
                piece,
                pace: own,
                way: own_way,
            } = span.state;
            bound.1 == Some(piece) && pace == own && (way - own_way).abs() < 0.5
        }
        _ => false,
    };
    links.len() == spans.len() && links.iter().zip(spans).all(same)
}

/// Arcs in place of a run that begins with `first`.
fn arcs(first: &Link, spans: &[Span]) -> Vec<Link> {
    let Some(Hold(index, _)) = first.motion.bound() else {
        return Vec::new();
    };
    let mut links: Vec<Link> = Vec::with_capacity(spans.len());
    for span in spans {
        let State { piece, pace, way } = span.state;
        let bound = Hold(index, Some(piece));
        let motion = Motion::Along { bound, pace, way };
        let link = match links.last() {
            None => {
                let mut link = Link {
                    bends: Vec::new(),
                    between: Vec::new(),
                    motion,
                    time: span.time,
                    ..first.clone()
                };
                held_by(&mut link, bound);
                link
            }
            Some(before) => {
                let held = before.motion.bound().into_iter().collect();
                Link::new(span.from, held, motion, span.time)
            }
        };
        links.push(link);
    }
    links
}

/// Puts an extreme arc where the servos change over and its chord lies within the bound.
///
/// An arc of no length is stationary as well. The first guess is long, so that Newton's method does not converge to that.
fn cut_short(setting: &Setting, arcs: Vec<Link>) -> Vec<Link> {
    /// Share of the shorter neighbour that it takes.
    const TAKEN: f64 = 0.9;
    let mut links: Vec<Link> = Vec::with_capacity(arcs.len() + 2);
    for mut link in arcs {
        let extreme = links.last_mut().and_then(|before| {
            let Motion::Along {
                bound: held,
                pace: one,
                way: first,
            } = before.motion
            else {
                return None;
            };
            let (two, second) = link.motion.pace();
            if one == two || link.motion.bound() != Some(held) {
                return None;
            }
            let Bound::Clearance(clearance) = setting.region.bound(held.0)? else {
                return None;
            };
            let mut ways = [first; 2];
            ways[two] = second;
            let rate = Vector2::from(ways).component_mul(&Vector2::from(setting.rates));
            let bend = clearance.level(held.1?, &link.corner).hessian * rate;
            let half = TAKEN * before.time.min(link.time);
            if bend.dot(&rate) >= 0.0 {
                return None;
            }
            before.time -= half;
            link.time -= half;
            let from = link.corner - rate * half;
            link.corner += rate * half;
            link.held = vec![held];
            Some(Link::new(
                from,
                vec![held],
                Motion::Extreme(ways),
                2.0 * half,
            ))
        });
        links.extend(extreme);
        links.push(link);
    }
    links
}

/// States along the clearance between two places on it. Returns `None` if the curve does not lead from one to the other.
fn spans(
    setting: &Setting,
    index: usize,
    from: Vector2<f64>,
    to: Vector2<f64>,
) -> Option<Vec<Span>> {
    let bound = setting.region.bound(index)?;
    let Bound::Clearance(clearance) = bound else {
        return None;
    };
    let on_curve = |phi: &Vector2<f64>| {
        let on = bound.onto(phi);
        (bound.margin(&on).abs() < OFF).then_some(on)
    };
    let (mut here, end) = (on_curve(&from)?, on_curve(&to)?);
    let sense = bound.tangent(&here).dot(&(end - here)).signum();
    let direction = |phi: &Vector2<f64>| bound.tangent(phi) * sense;
    let state = |phi: &Vector2<f64>| {
        let rate = direction(phi);
        let pace = pace(setting, &rate);
        State {
            piece: clearance.piece(phi),
            pace,
            way: rate[pace].signum(),
        }
    };
    let span = |from: Vector2<f64>, to: Vector2<f64>, state: State| Span {
        from,
        state,
        time: (to[state.pace] - from[state.pace]).abs() / setting.rates[state.pace],
    };
    let mut spans = Vec::new();
    let mut begun = here;
    let mut own = state(&on_curve(&(here + direction(&here) * OVER))?);
    for _ in 0..MOST_STEPS {
        let rate = direction(&here);
        let left = (end - here).dot(&rate);
        if left <= OVER {
            spans.push(span(begun, end, own));
            return Some(lasting(spans));
        }
        let there = |length: f64| on_curve(&(here + rate * length));
        let length = STEP.min(left);
        let next = there(length)?;
        if state(&next) == own {
            here = next;
            continue;
        }
        let keeps = |length: f64| there(length).is_some_and(|phi| state(&phi) == own);
        let [last, beyond] = halved([0.0, length], 40, keeps);
        let change = there(last)?;
        spans.push(span(begun, change, own));
        begun = change;
        here = there((beyond + OVER).min(length))?;
        own = state(&here);
    }
    None
}

/// Spans without those of no duration.
fn lasting(spans: Vec<Span>) -> Vec<Span> {
    /// \[rad\], as the faster servo turns by 1 rad per unit of time.
    const LEAST: f64 = 1e-7;
    let mut all: Vec<Span> = Vec::with_capacity(spans.len());
    for span in spans.into_iter().filter(|span| span.time > LEAST) {
        match all.last_mut().filter(|last| last.state == span.state) {
            Some(last) => last.time += span.time,
            None => all.push(span),
        }
    }
    all
}

/// Servo that turns faster, over its rate.
fn pace(setting: &Setting, rate: &Vector2<f64>) -> usize {
    let shares = [0, 1].map(|joint| rate[joint].abs() / setting.rates[joint]);
    usize::from(shares[1] > shares[0])
}

/// Function that vanishes where one arc along the clearance gives way to the next, at the corner between them. Returns `None` if the
/// arcs do not both run along it, or differ in nothing.
pub(super) fn transition(
    setting: &Setting,
    [before, after]: [&Motion; 2],
    phi: &Vector2<f64>,
) -> Option<Level> {
    /// Of the difference quotient.
    const DIFFERENCE: f64 = 1e-6;
    let at = |phi: &Vector2<f64>| function(setting, [before, after], phi);
    let (value, gradient) = at(phi)?;
    let mut hessian = Matrix2::zeros();
    for joint in 0..2 {
        let mut shift = Vector2::zeros();
        shift[joint] = DIFFERENCE;
        let ((_, up), (_, down)) = (at(&(phi + shift))?, at(&(phi - shift))?);
        hessian.set_column(joint, &((up - down) / (2.0 * DIFFERENCE)));
    }
    Some(Level {
        value,
        gradient,
        hessian: 0.5 * (hessian + hessian.transpose()),
    })
}

fn function(
    setting: &Setting,
    motions: [&Motion; 2],
    phi: &Vector2<f64>,
) -> Option<(f64, Vector2<f64>)> {
    let [before, after] = motions.map(|motion| match *motion {
        Motion::Along {
            bound: Hold(index, Some(piece)),
            pace,
            way,
        } => Some((index, piece, pace, way)),
        _ => None,
    });
    let ((index, piece, pace, way), (other, next, next_pace, next_way)) = (before?, after?);
    let Bound::Clearance(clearance) = setting.region.bound(index)? else {
        return None;
    };
    if index != other || (piece, pace) == (next, next_pace) {
        return None;
    }
    if piece != next {
        return Clearance::piece_end(&clearance, piece, phi);
    }
    // Both servos at full rate: the direction is along the curve.
    let mut ways = Vector2::zeros();
    ways[pace] = way * setting.rates[pace];
    ways[next_pace] = next_way * setting.rates[next_pace];
    let level = clearance.level(piece, phi);
    Some((level.gradient.dot(&ways), level.hessian * ways))
}
