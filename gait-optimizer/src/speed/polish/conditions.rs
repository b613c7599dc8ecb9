//! What a chain of known arcs must meet, and how far it is from that: values, slopes and curvatures over its unknowns.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::super::bordered;
use super::super::chain::{self, Layout, Net};
use super::super::ensemble;
use super::super::quadrature::Rule;
use super::super::setting::Setting;
use super::super::structure::{Hold, Link, Motion};
use crate::region::{Bound, Level};

/// One equation that is linear in the unknowns, or holds a corner.
pub(super) enum Equation {
    /// `way · (to − from) − rate · time`.
    Pace {
        arc: usize,
        joint: usize,
        way: f64,
    },
    Held {
        corner: usize,
        hold: Hold,
    },
    /// One angle of the corner at which gaits join.
    Anchored {
        corner: usize,
        joint: usize,
        angle: f64,
    },
}

pub(super) fn equations(setting: &Setting, links: &[Link]) -> Vec<Equation> {
    let mut equations = Vec::new();
    for (arc, link) in links.iter().enumerate() {
        match link.motion {
            Motion::Extreme(ways) => {
                for (joint, way) in ways.into_iter().enumerate() {
                    equations.push(Equation::Pace { arc, joint, way });
                }
            }
            motion => {
                let (joint, way) = motion.pace();
                equations.push(Equation::Pace { arc, joint, way });
            }
        }
        for &hold in &link.held {
            equations.push(Equation::Held { corner: arc, hold });
        }
        if let Some(anchor) = setting.asked.anchor.filter(|_| link.anchored) {
            for joint in 0..2 {
                equations.push(Equation::Anchored {
                    corner: arc,
                    joint,
                    angle: anchor[joint],
                });
            }
        }
    }
    equations
}

pub(super) struct Conditions<'a> {
    pub(super) setting: &'a Setting<'a>,
    pub(super) layout: &'a Layout,
    pub(super) rule: &'a Rule,
    pub(super) equations: &'a [Equation],
}

pub(super) struct Look {
    gradient: DVector<f64>,
    values: DVector<f64>,
    slopes: DMatrix<f64>,
    pub(super) hessian: DMatrix<f64>,
    /// Gradient of the objective alone.
    objective: DVector<f64>,
    multipliers_known: bool,
    pub(super) net: Net,
}

impl Conditions<'_> {
    /// Equations of the whole chain: rotation, and heading and period where they are asked for.
    pub(super) fn global(&self) -> usize {
        self.setting.equality_count()
    }

    pub(super) fn look(&self, z: &DVector<f64>, y: Option<&DVector<f64>>) -> Option<Look> {
        let Self {
            setting,
            layout,
            rule,
            equations,
        } = self;
        let size = layout.size;
        let jets = layout.jets(setting.model, rule, z);
        let period = layout.period(z);
        let times = 2 * layout.arcs()..3 * layout.arcs();
        let (net, equalities, equality_slopes) = setting.equalities(layout, &jets, z);
        let measure = setting.measure(&net);
        if !measure.is_finite() || measure < 1e-9 {
            return None;
        }
        let (_, mut objective) = chain::gradient(layout, &jets, z, setting.weights(&net, None));
        let (slope, bend) = ensemble::expansion((layout, rule), z, setting.members);
        objective += slope;
        for index in times.clone() {
            objective[index] += 1.0 / period;
        }
        let global = self.global();
        let count = global + equations.len();
        let mut values = DVector::zeros(count);
        let mut slopes = DMatrix::zeros(count, size);
        for (row, (value, slope)) in equalities.iter().zip(&equality_slopes).enumerate() {
            values[row] = *value;
            slopes.set_row(row, &slope.transpose());
        }
        let multiplier = |row: usize| y.map_or(0.0, |y| y[row]);
        let mut hessian = chain::hessian(
            (layout, setting.model, rule),
            &jets,
            z,
            setting.weights(&net, y.map(DVector::as_slice)),
            true,
        );
        hessian += bend;
        if let Some(slope) = setting.of_the_log(&net, (layout, &jets), z) {
            hessian.ger(1.0, &slope, &slope, 1.0);
        }
        for one in times.clone() {
            for other in times.clone() {
                hessian[(one, other)] -= 1.0 / (period * period);
            }
        }
        for (k, equation) in equations.iter().enumerate() {
            let row = global + k;
            match *equation {
                Equation::Pace { arc, joint, way } => {
                    let (from, to) = (
                        layout.corner_index(arc) + joint,
                        layout.corner_index(arc + 1) + joint,
                    );
                    let time = layout.time_index(arc);
                    let rate = setting.rates[joint];
                    values[row] = way * (z[to] - z[from]) - rate * z[time];
                    slopes[(row, to)] += way;
                    slopes[(row, from)] -= way;
                    slopes[(row, time)] -= rate;
                }
                Equation::Anchored {
                    corner,
                    joint,
                    angle,
                } => {
                    let at = layout.corner_index(corner) + joint;
                    values[row] = z[at] - angle;
                    slopes[(row, at)] = 1.0;
                }
                Equation::Held { corner, hold } => {
                    let phi = layout.corner(z, corner);
                    let at = layout.corner_index(corner);
                    let held = held(setting, &hold, &phi)?;
                    values[row] = held.value;
                    for i in 0..2 {
                        slopes[(row, at + i)] = held.gradient[i];
                        for j in 0..2 {
                            hessian[(at + i, at + j)] += multiplier(row) * held.hessian[(i, j)];
                        }
                    }
                }
            }
        }
        let gradient = match y {
            Some(y) => &objective + slopes.tr_mul(y),
            None => objective.clone(),
        };
        Some(Look {
            gradient,
            values,
            slopes,
            hessian,
            objective,
            multipliers_known: y.is_some(),
            net,
        })
    }
}

/// Value, slope and bend of what holds a corner.
fn held(setting: &Setting, hold: &Hold, phi: &Vector2<f64>) -> Option<Level> {
    Some(match (setting.region.bound(hold.0)?, hold.1) {
        (Bound::Clearance(clearance), Some(piece)) => clearance.level(piece, phi),
        (bound, _) => Level {
            value: bound.margin(phi),
            gradient: bound.gradient(phi),
            hessian: Matrix2::zeros(),
        },
    })
}

impl Look {
    pub(super) fn residual(&self) -> f64 {
        self.gradient.amax().max(self.values.amax())
    }

    /// The step, and the multipliers after it.
    pub(super) fn newton(&self) -> Option<(DVector<f64>, DVector<f64>)> {
        if !self.multipliers_known {
            // First the multipliers that come nearest.
            let svd = self.slopes.transpose().svd(true, true);
            let y = svd.solve(&-&self.objective, 1e-12).ok()?;
            return Some((DVector::zeros(self.gradient.len()), y));
        }
        bordered::step(
            (&self.hessian, &self.objective),
            &self.slopes.transpose(),
            (&self.slopes, &self.values),
        )
    }

    /// Least eigenvalue of the second variation where all equations hold to first order, and its shift.
    pub(super) fn convexity(&self) -> (f64, DVector<f64>) {
        let size = self.gradient.len();
        // An orthonormal basis of the shifts: what is left of the unit vectors beside the slopes.
        let qr = self.slopes.transpose().qr();
        let q = qr.q();
        let projector = DMatrix::identity(size, size) - &q * q.transpose();
        let eigen = projector.symmetric_eigen();
        let free: Vec<usize> = (0..size).filter(|&k| eigen.eigenvalues[k] > 0.5).collect();
        if free.is_empty() {
            return (f64::INFINITY, DVector::zeros(size));
        }
        let basis = DMatrix::from_fn(size, free.len(), |i, j| eigen.eigenvectors[(i, free[j])]);
        let reduced = basis.tr_mul(&(&self.hessian * &basis));
        let eigen = reduced.symmetric_eigen();
        let (least, value) = eigen.eigenvalues.argmin();
        (value, basis * eigen.eigenvectors.column(least))
    }
}
