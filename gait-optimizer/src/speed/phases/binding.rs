//! What should bind on a solved cycle, node by node, after what multipliers and limits say.

use nalgebra::{DVector, Vector2};

use super::super::arc::{MOST_PARAMETERS, Place};
use super::equations::Equation;
use super::equations::Method;
use super::{BENDS, Draft, PUT_IN, Phase, side};

/// Multipliers that are no more negative than this share, and limits overstepped by no more, are none the less in order.
const SLIGHT: f64 = 1e-7;
/// The same at an end of an element, where they are extrapolated to.
const AT_ENDS: f64 = 3e-6;
/// A limit is met where no more than this share of it is left.
const MET: f64 = 1e-6;
const NODES: usize = BENDS + 1;

/// Multipliers by what they belong to.
struct Multipliers {
    /// Of each element's nodes the share of each limit; NaN where it does not bind.
    shares: Vec<Vec<f64>>,
    /// Of each element's inner nodes what its bound pushes with.
    pushes: Vec<[f64; BENDS]>,
    /// Bounds that pull at an element's first corner.
    released: Vec<Vec<usize>>,
}

/// Weights of the values at these places in their polynomial's value at 0.
fn to_zero(nodes: &[f64]) -> Vec<f64> {
    let weight = |at: usize| {
        let others = (0..nodes.len()).filter(|other| *other != at);
        others
            .map(|other| nodes[other] / (nodes[other] - nodes[at]))
            .product()
    };
    (0..nodes.len()).map(weight).collect()
}

impl Method<'_> {
    fn multipliers(&self, y: &DVector<f64>, global: usize) -> Multipliers {
        let Draft { layout, z, .. } = &self.draft;
        let (period, elements) = (layout.period(z), layout.arcs());
        let mut sorted = Multipliers {
            shares: vec![vec![f64::NAN; self.limits.len()]; elements * NODES],
            pushes: vec![[f64::NAN; BENDS]; elements],
            released: vec![Vec::new(); elements],
        };
        for (row, equation) in (global..).zip(&self.equations) {
            // Minimised: of a limit that pushes the multiplier is negative.
            let push = -y[row] * period;
            match *equation {
                Equation::Limit {
                    element,
                    node,
                    limit,
                } => {
                    let share = push / self.nodes.weights[node];
                    sorted.shares[element * NODES + node][limit] = share;
                }
                Equation::Along { element, node, .. } => sorted.pushes[element][node] = push,
                Equation::Corner { element, bound } if push < -SLIGHT => {
                    sorted.released[element].push(bound);
                }
                Equation::Corner { .. }
                | Equation::Even { .. }
                | Equation::Meets { .. }
                | Equation::Tangent { .. } => {}
            }
        }
        // At an end of an element a limit may pull that pushes at the nearest node.
        let weights = to_zero(&self.nodes.nodes);
        for own in sorted.shares.chunks_mut(NODES) {
            for limit in 0..self.limits.len() {
                let shares: Vec<f64> = own.iter().map(|node| node[limit]).collect();
                let term = |(weight, share): (&f64, &f64)| weight * share;
                let start: f64 = weights.iter().zip(&shares).map(term).sum();
                let end: f64 = weights.iter().zip(shares.iter().rev()).map(term).sum();
                for (node, beyond) in [(0, start), (BENDS, end)] {
                    if beyond < -AT_ENDS {
                        own[node][limit] = beyond;
                    }
                }
            }
        }
        sorted
    }

    /// Bounds that an element's first corner should rest on, where its phase begins or it oversteps them.
    fn touches(&self, element: usize, released: &[usize]) -> Vec<usize> {
        let Draft {
            phases,
            phase_of,
            layout,
            z,
            ..
        } = &self.draft;
        let number = phase_of[element];
        let mut touches = phases[number].touches.clone();
        if element > 0 && phase_of[element - 1] == number {
            touches.clear();
        }
        touches.retain(|bound| !released.contains(bound));
        let corner = layout.corner(z, element);
        for (index, bound) in self.setting.region.bounds().enumerate() {
            if bound.margin(&corner) < -SLIGHT && !touches.contains(&index) {
                touches.push(index);
            }
        }
        touches
    }

    /// Limits that should bind at a node, and the bound.
    fn binding(
        &self,
        (element, node): (usize, usize),
        phase: &Phase,
        (share, push): (&[f64], f64),
    ) -> (Vec<usize>, Option<usize>) {
        let time = self.draft.z[self.draft.layout.time_index(element)];
        let place = self.place(element, self.nodes.nodes[node]);
        // At an end of the element a limit may be overstepped that is not at the next node.
        let end = match node {
            0 => Some(self.place(element, 0.0)),
            BENDS => Some(self.place(element, 1.0)),
            _ => None,
        };
        let over = |limit: usize, place: &Place<MOST_PARAMETERS>| {
            let power = self.setting.model.power_matrix(&place.phi);
            self.limits[limit].value(&power, &place.rate) / time - 1.0
        };
        let most_over = |limit: usize| {
            let of_end = end.iter().map(|end| over(limit, end));
            of_end.fold(over(limit, &place), f64::max)
        };
        let bound = if phase.bound.is_some() {
            phase.bound.filter(|_| push > -SLIGHT)
        } else {
            let mut bounds = self.setting.region.bounds();
            bounds.position(|bound| bound.margin(&place.phi) < -SLIGHT)
        };
        let all = 0..self.limits.len();
        let pushing = all.clone().filter(|limit| share[*limit] > -SLIGHT);
        let mut limits: Vec<usize> = pushing.collect();
        limits.sort_by(|a, b| share[*b].total_cmp(&share[*a]));
        let most = if bound.is_some() { 1 } else { 2 };
        limits.truncate(most);
        let mut others = all.filter(|limit| share[*limit].is_nan());
        let worst = others.clone().map(|limit| (most_over(limit), limit));
        let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, enters)) = worst.filter(|(over, _)| *over > SLIGHT) {
            if limits.len() == most {
                let leaves = self.leaves(&place, enters, (&limits, share));
                limits.swap_remove(leaves);
            }
            limits.push(enters);
        } else if let Some(end) = end.filter(|_| limits.len() < phase.limits.len()) {
            // One that is met where another leaves takes its place: the costate left over is between it and the one that stays.
            limits.extend(others.find(|limit| over(*limit, &end).abs() < MET));
        }
        if limits.is_empty() {
            limits.clone_from(&phase.limits);
        }
        limits.sort_unstable();
        (limits, bound)
    }

    /// The place among limits that bind of the one that gives way to another: the first whose share vanishes as the costate is
    /// shared out with the other.
    fn leaves(
        &self,
        place: &Place<MOST_PARAMETERS>,
        enters: usize,
        (limits, share): (&[usize], &[f64]),
    ) -> usize {
        let &[one, two] = limits else { return 0 };
        let second = self.setting.model.second_derivatives(&place.phi);
        let normal = |limit: usize| {
            let slope = self.limits[limit].level(&second, &place.rate).slope;
            Vector2::new(slope[2], slope[3])
        };
        let [a, b, new] = [one, two, enters].map(normal);
        let parts = [new.perp(&b), a.perp(&new)].map(|part| part / a.perp(&b));
        let ratio = |k: usize| {
            if parts[k] > 0.0 {
                share[limits[k]] / parts[k]
            } else {
                f64::INFINITY
            }
        };
        usize::from(ratio(1) < ratio(0))
    }

    /// The phases that the cycle should have, one a node.
    pub(super) fn wanted(&self, y: &DVector<f64>, global: usize) -> Vec<Phase> {
        let Draft {
            phases,
            phase_of,
            layout,
            z,
            ..
        } = &self.draft;
        let period = layout.period(z);
        let sorted = self.multipliers(y, global);
        let mut cells = Vec::with_capacity(phase_of.len() * NODES);
        let mut begun = 0.0;
        for (element, &number) in phase_of.iter().enumerate() {
            let mut touches = self.touches(element, &sorted.released[element]);
            for node in 0..NODES {
                let share = &sorted.shares[element * NODES + node];
                let push = sorted.pushes[element][node.min(BENDS - 1)];
                let at = (element, node);
                let (limits, bound) = self.binding(at, &phases[number], (share, push));
                let time = z[layout.time_index(element)];
                let length = time * self.nodes.weights[node] / period;
                let place = self.place(element, self.nodes.nodes[node]);
                let side = side(self.setting, &limits, &place.phi, &place.rate);
                cells.push(Phase {
                    from: begun,
                    to: begun + length,
                    limits,
                    side,
                    bound,
                    touches: std::mem::take(&mut touches),
                    parts: phases[number].parts,
                });
                begun += length;
            }
        }
        let pulls = sorted.released.iter().enumerate();
        let between: Vec<Option<Phase>> = pulls
            .map(|(element, bounds)| self.leaves_bound(element, bounds, &cells))
            .collect();
        with_between(&cells, &between)
    }

    /// Where a bound pulls at the first corner of an element, the limits of both phases that border on each other there bind between
    /// them, off the bound: the costate may jump towards a bound alone, and would else have to jump away from it. The phase that is
    /// put in begins at 0; none where it makes no sense.
    fn leaves_bound(&self, element: usize, bounds: &[usize], cells: &[Phase]) -> Option<Phase> {
        let Draft {
            phases, phase_of, ..
        } = &self.draft;
        let (elements, count) = (phase_of.len(), cells.len());
        let numbers = [
            phase_of[(element + elements - 1) % elements],
            phase_of[element],
        ];
        let [before, after] = numbers.map(|number| &phases[number]);
        let held = [before, after]
            .iter()
            .any(|phase| phase.bound.is_some_and(|bound| bounds.contains(&bound)));
        let keep = before.binds_as(&cells[(element * NODES + count - 1) % count])
            && after.binds_as(&cells[element * NODES]);
        let mut limits = [before.limits.clone(), after.limits.clone()].concat();
        limits.sort_unstable();
        limits.dedup();
        if !held || !keep || limits.len() != 2 {
            return None;
        }
        let [one, two] = numbers.map(|number| self.draft.time_of(number) / self.draft.period());
        let place = self.place(element, 0.0);
        Some(Phase {
            from: 0.0,
            to: (3.0 * PUT_IN).min(0.3 * one).min(0.6 * two),
            side: side(self.setting, &limits, &place.phi, &place.rate),
            limits,
            bound: None,
            touches: Vec::new(),
            parts: 1,
        })
    }
}

/// The cells, one a node, with these phases put in before elements: each takes as much of both its neighbours.
fn with_between(cells: &[Phase], between: &[Option<Phase>]) -> Vec<Phase> {
    let put = |element: usize| between[element % between.len()].as_ref();
    let takes = |element: usize| put(element).map_or(0.0, |put| 0.5 * put.to);
    let mut all = Vec::with_capacity(cells.len());
    let mut until = 0.0;
    let mut push = |phase: &Phase, length: f64| {
        all.push(Phase {
            from: until,
            to: until + length,
            ..phase.clone()
        });
        until += length;
    };
    for (element, own) in cells.chunks(NODES).enumerate() {
        if let Some(put) = put(element) {
            push(put, put.to);
        }
        let whole: f64 = own.iter().map(|cell| cell.to - cell.from).sum();
        let left = 1.0 - (takes(element) + takes(element + 1)) / whole;
        for cell in own {
            push(cell, (cell.to - cell.from) * left);
        }
    }
    all
}
