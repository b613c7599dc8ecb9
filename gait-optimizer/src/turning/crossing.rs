//! Where two zero-level curves cross: the walk turns left onto the other one.

use nalgebra::{Matrix2, Vector2};

use super::error::TurningError;
use super::walk::Domain;
use crate::height_map::OnCurve;

impl<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)> Domain<'_, F> {
    /// A little way from a crossing along the other curve.
    pub(super) fn after(
        &self,
        node: Vector2<f64>,
        ahead: Vector2<f64>,
    ) -> Result<OnCurve, TurningError> {
        let mut step = self.step;
        for _ in 0..6 {
            let guess = node + ahead * step;
            if let Some(point) = self.level.corrected(&guess, Some(&ahead), 0.3 * step)
                && point.slope_left > 0.0
            {
                return Ok(point);
            }
            step *= 0.5;
        }
        Err(TurningError::lost(
            node,
            "zero-level curves cross too flatly",
        ))
    }

    /// The crossing of two zero-level curves between two points of one, and the direction to its left on the other.
    pub(super) fn node(
        &self,
        before: &OnCurve,
        after: &OnCurve,
    ) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let (a, b) = (before.slope_left.abs(), after.slope_left.abs());
        let guess = before.phi + (after.phi - before.phi) * (a / (a + b));
        let mut phi = guess;
        let mut hessian = Matrix2::zeros();
        for _ in 0..20 {
            hessian = self.hessian(&phi);
            let step = hessian.try_inverse()? * self.level.at(&phi).1;
            phi -= step;
            if step.norm() < 1e-13 {
                break;
            }
        }
        let apart = (after.phi - before.phi).norm();
        if self.level.at(&phi).0.abs() > 1e-12 || (phi - guess).norm() > apart {
            return None;
        }
        let eigen = hessian.symmetric_eigen();
        let (l1, l2) = (eigen.eigenvalues[0], eigen.eigenvalues[1]);
        if l1 * l2 >= 0.0 {
            return None;
        }
        let (e1, e2) = (eigen.eigenvectors.column(0), eigen.eigenvectors.column(1));
        let lines = [1.0, -1.0].map(|sign| {
            let line: Vector2<f64> = e1 * l2.abs().sqrt() + e2 * (sign * l1.abs().sqrt());
            line.normalize()
        });
        // The line that is not the one walked.
        let other = lines.into_iter().max_by(|a, b| {
            let across = |line: &Vector2<f64>| before.tangent.perp(line).abs();
            across(a).total_cmp(&across(b))
        })?;
        let left = if before.tangent.perp(&other) > 0.0 {
            other
        } else {
            -other
        };
        Some((phi, left))
    }

    fn hessian(&self, phi: &Vector2<f64>) -> Matrix2<f64> {
        let h = 1e-5;
        let column = |step: Vector2<f64>| {
            (self.level.at(&(phi + step)).1 - self.level.at(&(phi - step)).1) / (2.0 * h)
        };
        let raw =
            Matrix2::from_columns(&[column(Vector2::new(h, 0.0)), column(Vector2::new(0.0, h))]);
        (raw + raw.transpose()) * 0.5
    }
}
