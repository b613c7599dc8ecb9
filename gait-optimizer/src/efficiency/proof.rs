//! The certificate of a free efficiency gait.

use swimmer_model::Stroke;

use super::second_order::{SecondOrder, legendre};
use super::shooting::{Polished, RESIDUAL};
use super::trace::{Deviations, Trace};
use crate::certificate::{Certificate, Check, simple_and_turning_once, swum_again};
use crate::cycle::Cycle;

/// What the certificate is made from.
pub(crate) struct Evidence<'a> {
    pub(crate) polished: &'a Polished,
    pub(crate) trace: &'a Trace<'a>,
    pub(crate) deviations: &'a Deviations,
    pub(crate) second_order: Option<SecondOrder>,
    pub(crate) cycle: &'a Cycle,
    /// The cycle swum by the model, which shares no code with the extremal.
    pub(crate) stroke: &'a Stroke<f64>,
}

impl Evidence<'_> {
    /// All conditions: first order along the extremal and at its ends, second order, and those of the closed curve.
    pub(crate) fn certificate(&self) -> Certificate {
        let Deviations {
            h_u,
            hamiltonian,
            power_variation,
            rough_ends,
        } = *self.deviations;
        let (first, last) = (self.trace.states.first(), self.trace.states.last());
        let off_lines = match (first, last) {
            (Some(first), Some(last)) => (first[0] - first[1]).abs().max((last[0] + last[1]).abs()),
            _ => f64::NAN,
        };
        let off_end = last.map_or(f64::NAN, |last| {
            last[3].abs().max((last[4] - last[5]).abs())
        });
        let least = self
            .second_order
            .map_or(f64::NAN, |test| test.least_determinant);
        let bend = self
            .second_order
            .map_or(f64::NAN, |test| test.bend_at_start);
        let mut checks = vec![
            Check::at_most("shooting_residual", self.polished.residual, RESIDUAL),
            Check::at_most("off_symmetry_lines_rad", off_lines, 1e-9),
            Check::at_most("end_transversality", off_end, 1e-9),
            Check::at_most("h_u", h_u, 1e-8),
            Check::at_most("hamiltonian_off_efficiency", hamiltonian, 1e-7),
            Check::at_most("power_variation", power_variation, 1e-7),
            Check::at_most("rough_ends", rough_ends, 1e-7),
            Check::at_least(
                "legendre_least",
                legendre(&self.trace.flow, &self.trace.states),
                1e-6,
            ),
            Check::at_least("conjugate_determinant_least", least, 1e-9),
            Check::at_most("bend_at_start", bend, -1e-6),
        ];
        checks.extend(simple_and_turning_once(&self.cycle.phi, &self.cycle.phi));
        checks.extend(swum_again(self.stroke, 4.0 * self.polished.at_end[1]));
        let again = self.stroke.efficiency_constant_power() / self.polished.efficiency();
        checks.push(Check::at_most(
            "efficiency_swum_again",
            (again - 1.0).abs(),
            1e-7,
        ));
        Certificate::new(checks)
    }
}
