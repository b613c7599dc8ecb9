//! Newton's method on a cycle of phases: elements, when they end, and all multipliers.

use nalgebra::{DMatrix, DVector, Vector4};

use super::super::arc::{MOST_PARAMETERS, Place};
use super::super::expansion::Expansion;
use super::super::quadrature::Rule;
use super::super::setting::Setting;
use super::equations::{Equation, Method, equations};
use super::{BENDS, Curve, Draft, Phase, side};
use crate::numerics::damped;

/// Quadrature points of the path on an element.
const POINTS: usize = 24;
const MOST_STEPS: usize = 40;
/// Longest step of a corner \[rad\] or a time.
const STRIDE: f64 = 0.2;
/// Residuals below this are rounding; where they come to rest below the second, the method has converged.
const ROUNDING: f64 = 1e-12;
const AT_REST: f64 = 1e-9;
/// An element loses no more than this share of its time in a step; a phase that is shorter than so much of the period has gone.
const SHRINKS: f64 = 0.7;
const GONE: f64 = 1e-5;
/// A step that would turn velocities to the other side at these places on elements is halved, at most so many times.
const SIDED_AT: [f64; 3] = [0.01, 0.5, 0.99];
const HALVINGS: usize = 5;

pub(super) enum Outcome {
    /// The curve, and the phases that it should have, node by node.
    Solved(Box<Curve>, Vec<Phase>),
    /// The phase of this number has no length where the method got to.
    Gone(usize, Box<Draft>),
    /// The method does not converge.
    Lost,
}

pub(super) fn solve(setting: &Setting, draft: Draft) -> Outcome {
    let method = Method {
        setting,
        limits: setting.limits(),
        nodes: Rule::new(BENDS + 1),
        inner: Rule::new(BENDS),
        path: Rule::new(POINTS),
        equations: equations(setting, &draft),
        draft,
    };
    method.run()
}

impl Method<'_> {
    fn run(mut self) -> Outcome {
        let mut y: Option<DVector<f64>> = None;
        let mut best = f64::INFINITY;
        let mut stalls = 0;
        for _ in 0..MOST_STEPS {
            let Some(look) = self.look(y.as_ref()) else {
                return Outcome::Lost;
            };
            if let Some(y) = &y {
                let residual = look.residual(y);
                stalls = if residual < 0.5 * best { 0 } else { stalls + 1 };
                best = best.min(residual);
                if residual < ROUNDING || (stalls > 2 && residual < AT_REST) {
                    return self.solved(&look, y);
                }
                if stalls > 10 {
                    return Outcome::Lost;
                }
            }
            let Some((step, next)) = look.step() else {
                return Outcome::Lost;
            };
            if y.is_some() {
                self.go(&step);
            }
            y = Some(next);
            if let Some(phase) = self.gone() {
                return Outcome::Gone(phase, Box::new(self.so_far()));
            }
        }
        Outcome::Lost
    }

    /// Goes along a step, as far as no element loses more than so much of its time, and as velocities stay on their sides.
    fn go(&mut self, step: &DVector<f64>) {
        let times = self.draft.layout.times();
        let most = (step.rows(0, times.end).amax() / STRIDE).max(1.0);
        let shrinks = times.map(|at| -step[at] / (SHRINKS * self.draft.z[at]));
        let longest = 1.0 / shrinks.fold(most, f64::max);
        let (begun, sided) = (self.draft.z.clone(), self.sided());
        for scale in damped(longest).take(HALVINGS) {
            self.draft.z = &begun + step * scale;
            if self.sided() >= sided {
                break;
            }
        }
    }

    /// In how many places it is the phase's one of two velocities, where two limits leave these.
    fn sided(&self) -> usize {
        let places = self.draft.phase_of.iter().enumerate();
        let places = places.flat_map(|(element, number)| SIDED_AT.map(|s| (element, number, s)));
        let sided = places.filter(|&(element, number, s)| {
            let (phase, place) = (&self.draft.phases[*number], self.place(element, s));
            side(self.setting, &phase.limits, &place.phi, &place.rate) == phase.side
        });
        sided.count()
    }

    /// The phase that has lost its length.
    fn gone(&self) -> Option<usize> {
        let times = (0..self.draft.phases.len()).map(|phase| (phase, self.draft.time_of(phase)));
        let (phase, shortest) = times.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (shortest < GONE * self.draft.period()).then_some(phase)
    }

    pub(super) fn place(&self, element: usize, s: f64) -> Place<MOST_PARAMETERS> {
        self.draft.layout.place(&self.draft.z, element, s)
    }

    fn look(&self, y: Option<&DVector<f64>>) -> Option<Expansion> {
        let Self { setting, draft, .. } = self;
        let Draft { layout, z, .. } = draft;
        let mut look = Expansion::new(setting, (layout, &self.path), (z, y), self.equations.len())?;
        let Expansion {
            values,
            slopes,
            hessian,
            ..
        } = &mut look;
        let global = setting.equality_count();
        for (row, equation) in (global..).zip(&self.equations) {
            let Some((element, place, level)) = self.level(equation) else {
                if let Equation::Even { element } = *equation {
                    for (element, sign) in [(element, 1.0), (element + 1, -1.0)] {
                        let (at, share) = (layout.time_index(element), draft.spans[element].1);
                        values[row] += sign * z[at] / share;
                        slopes[(row, at)] = sign / share;
                    }
                }
                continue;
            };
            values[row] = level.value;
            let by = (0..4 + 2 * BENDS).map(|p| {
                let (phi, rate) = (place.d_phi[p], place.d_rate[p]);
                let by = Vector4::new(phi.x, phi.y, rate.x, rate.y);
                (layout.parameter_index(element, p), by)
            });
            let by: Vec<(usize, Vector4<f64>)> = by.collect();
            for (at, by) in &by {
                slopes[(row, *at)] += level.slope.dot(by);
            }
            if let Equation::Limit { .. } | Equation::Meets { .. } = equation {
                slopes[(row, layout.time_index(element))] += 1.0;
            }
            let Some(y) = y.filter(|_| equation.stands_in_at().is_none()) else {
                continue;
            };
            for (at, along) in &by {
                let curved = level.curved * along * y[row];
                for (other, by) in &by {
                    hessian[(*at, *other)] += curved.dot(by);
                }
            }
        }
        look.forces = Some(self.forces(&look.slopes, global));
        Some(look)
    }

    /// What each multiplier weighs in the stationarity.
    fn forces(&self, slopes: &DMatrix<f64>, global: usize) -> DMatrix<f64> {
        let mut forces = slopes.transpose();
        for (row, equation) in (global..).zip(&self.equations) {
            if let Some((element, s)) = equation.stands_in_at() {
                let way = self.place(element, s).rate.normalize();
                let corner = if s > 0.5 { element + 1 } else { element };
                let corner = self.draft.layout.corner_index(corner);
                forces.column_mut(row).fill(0.0);
                forces[(corner, row)] = way.x;
                forces[(corner + 1, row)] = way.y;
            }
        }
        forces
    }

    /// The draft, its phases told where they lie by now.
    fn so_far(mut self) -> Draft {
        let mut begun = 0.0;
        for number in 0..self.draft.phases.len() {
            let first = self.draft.elements_of(number).next();
            let place = first.map(|first| self.place(first, 0.5));
            let length = self.draft.time_of(number) / self.draft.period();
            let phase = &mut self.draft.phases[number];
            phase.from = begun;
            begun += length;
            phase.to = begun;
            if let Some(place) = place {
                phase.side = side(self.setting, &phase.limits, &place.phi, &place.rate);
            }
        }
        self.draft
    }

    fn solved(self, look: &Expansion, y: &DVector<f64>) -> Outcome {
        let wanted = self.wanted(y, look.values.len() - self.equations.len());
        let (draft, net) = (self.so_far(), look.net);
        let speed = net.distance() / draft.layout.period(&draft.z);
        Outcome::Solved(Box::new(Curve { draft, net, speed }), wanted)
    }
}
