//! What should bind on a solved cycle, node by node, after what multipliers and limits say.

use nalgebra::DVector;

use super::super::arc::{MOST_PARAMETERS, Place};
use super::equations::Equation;
use super::newton::Method;
use super::{BENDS, Draft, Phase, side};

/// Multipliers that are no more negative than this share, and limits overstepped by no more, are none the less in order.
const SLIGHT: f64 = 1e-7;
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
        let over = |limit: usize| {
            let at = |place: &Place<MOST_PARAMETERS>| {
                let power = self.setting.model.power_matrix(&place.phi);
                self.limits[limit].value(&power, &place.rate) / time - 1.0
            };
            end.iter().map(at).fold(at(&place), f64::max)
        };
        let bound = if phase.bound.is_some() {
            phase.bound.filter(|_| push > -SLIGHT)
        } else {
            let mut bounds = self.setting.region.bounds();
            bounds.position(|bound| bound.margin(&place.phi) < -SLIGHT)
        };
        // Of those that are overstepped the worst first, then those that push the most.
        let worth = (0..self.limits.len()).filter_map(|limit| {
            if share[limit].is_nan() {
                let over = over(limit);
                (over > SLIGHT).then_some((10.0 + over, limit))
            } else {
                (share[limit] > -SLIGHT).then_some((share[limit], limit))
            }
        });
        let mut worth: Vec<(f64, usize)> = worth.collect();
        worth.sort_by(|a, b| b.0.total_cmp(&a.0));
        worth.truncate(if bound.is_some() { 1 } else { 2 });
        let mut limits: Vec<usize> = worth.into_iter().map(|(_, limit)| limit).collect();
        if limits.is_empty() {
            limits.clone_from(&phase.limits);
        }
        limits.sort_unstable();
        (limits, bound)
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
                });
                begun += length;
            }
        }
        cells
    }
}
