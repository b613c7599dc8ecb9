//! Conditions of a chain of known arcs and their residuals: values, slopes and curvatures over its unknowns.

use nalgebra::{DVector, Matrix2, Vector2};

use super::super::along_clearance::transition;
use super::super::chain::Layout;
use super::super::expansion::Expansion;
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
    /// Change from one arc along the clearance to the next.
    Transition {
        corner: usize,
        motions: [Motion; 2],
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
        let before = &links[(arc + links.len() - 1) % links.len()].motion;
        if transition(setting, [before, &link.motion], &link.corner).is_some() {
            let (corner, motions) = (arc, [*before, link.motion]);
            equations.push(Equation::Transition { corner, motions });
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

impl Conditions<'_> {
    /// Number of equations of the whole chain: rotation, and heading and period if they are prescribed.
    pub(super) fn global(&self) -> usize {
        self.setting.equality_count()
    }

    pub(super) fn evaluate(&self, z: &DVector<f64>, y: Option<&DVector<f64>>) -> Option<Expansion> {
        let Self {
            setting,
            layout,
            rule,
            equations,
        } = self;
        let (of, at) = ((*layout, *rule), (z, y));
        let mut evaluate = Expansion::new(setting, of, at, equations.len())?;
        let Expansion {
            values,
            slopes,
            hessian,
            ..
        } = &mut evaluate;
        for (row, equation) in (self.global()..).zip(*equations) {
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
                Equation::Held { corner, .. } | Equation::Transition { corner, .. } => {
                    let phi = layout.corner(z, corner);
                    let at = layout.corner_index(corner);
                    let held = match equation {
                        Equation::Held { hold, .. } => held(setting, hold, &phi),
                        Equation::Transition { motions, .. } => {
                            transition(setting, motions.each_ref(), &phi)
                        }
                        _ => None,
                    }?;
                    let multiplier = y.map_or(0.0, |y| y[row]);
                    values[row] = held.value;
                    for i in 0..2 {
                        slopes[(row, at + i)] = held.gradient[i];
                        for j in 0..2 {
                            hessian[(at + i, at + j)] += multiplier * held.hessian[(i, j)];
                        }
                    }
                }
            }
        }
        Some(evaluate)
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
