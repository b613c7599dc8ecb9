//! The second-order test that any curve can be asked: is a neighbour better?
//!
//! The curve is pushed along its normal by a few smooth waves that vanish on bounds and at corners. The objective's Hessian in
//! these waves is exact ([`super::variation`]), and on the waves that turn nothing that of an optimum has no direction that
//! leads up.

use nalgebra::{DMatrix, DVector, Vector2};

use super::Subject;
use super::grid::{Along, Degree};
use super::variation::{Push, Variation};
use crate::certificate::{Check, Condition};

/// What is maximised, as far as the Hessian is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gain {
    /// |d|, without net rotation.
    Displacement,
    /// ln |d| − ln S, without net rotation.
    Efficiency,
    /// |Y|, across the heading at the start, without net rotation.
    Sideways,
    /// ± Δθ.
    Turning,
}

/// A curve and what it is optimal for.
pub(super) struct Neighbours<'a> {
    pub(super) subject: &'a Subject<'a>,
    pub(super) gain: Gain,
    /// Multiplier of rotation, in the units of the gain.
    pub(super) rotation: f64,
    /// Only waves that keep the paper's symmetries.
    pub(super) symmetric: bool,
}

/// Waves of a gait with the paper's symmetries, and of any other gait.
const WAVES: [usize; 2] = [10, 17];
/// Eigenvalues below this part of the largest are not told from zero.
const FLAT: f64 = 1e-5;
/// Rounding leaves less than this part of the Hessian open.
const ROUNDING: f64 = 1e-9;

/// The directions that lead up from a curve.
pub(super) struct Ascents {
    /// How many are independent.
    pub(super) count: usize,
    /// How many of these the samples leave open.
    unsure: usize,
    /// The steepest, as a push at every node; the farthest push is 1 rad. Empty where it is
    /// not known.
    pub(super) steepest: Vec<Vector2<f64>>,
}

impl Ascents {
    pub(super) fn check(&self) -> Check {
        Check {
            uncertainty: self.unsure as f64,
            ..Condition::NoAscent.check(self.count as f64)
        }
    }
}

impl Subject<'_> {
    /// How many pushes of the curve would gain, with this multiplier of the rotation: those that keep the paper's symmetries,
    /// where the curve has them, and those of any kind. None where no push is free.
    pub(super) fn ascents(&self, gain: Gain, rotation: f64) -> Vec<Check> {
        let of = |symmetric: bool| {
            let neighbours = Neighbours {
                subject: self,
                gain,
                rotation,
                symmetric,
            };
            Some(neighbours.ascents()?.check())
        };
        let mut checks = Vec::new();
        if self.symmetric && !self.limits.need_quarters() {
            checks.extend(of(false).map(|check| Check {
                condition: Condition::NoAscentWithoutSymmetry,
                ..check
            }));
        }
        checks.extend(of(self.symmetric));
        checks
    }
}

impl Neighbours<'_> {
    /// Which directions lead up; none where the curve cannot be pushed.
    pub(super) fn ascents(&self) -> Option<Ascents> {
        let slopes = self.subject.path.places.iter();
        let slopes: Vec<_> = slopes.map(|place| place.rate).collect();
        let waves = self.waves(&slopes);
        let size = waves.len();
        if size == 0 {
            return None;
        }
        let Some((reduced, before)) = self.second_variation(&waves, Degree::Fine) else {
            // Nothing is known of any.
            return Some(Ascents {
                count: size,
                unsure: size,
                steepest: Vec::new(),
            });
        };
        let eigen = reduced.clone().symmetric_eigen();
        let values = &eigen.eigenvalues;
        // Where next to nothing is free all waves are alike, and but for rounding none is left that turns nothing.
        let level = (FLAT * values.amax()).max(ROUNDING * before);
        let up = |level: f64| values.iter().filter(|&&value| value > level).count();
        let count = up(level);
        // Another matrix moves no eigenvalue by more than its distance.
        let unsure = if count == 0 {
            0
        } else {
            let other = self.second_variation(&waves, Degree::Coarse);
            let apart = other.map_or(f64::INFINITY, |(other, _)| (&reduced - other).norm());
            count - up(level + apart)
        };
        let weights = eigen.eigenvectors.column(values.imax());
        let mut steepest = vec![Vector2::zeros(); slopes.len()];
        for (wave, weight) in waves.iter().zip(&weights) {
            for (sum, push) in steepest.iter_mut().zip(wave) {
                *sum += push * *weight;
            }
        }
        let farthest = steepest.iter().map(Vector2::norm).fold(0.0, f64::max);
        for push in &mut steepest {
            *push /= farthest;
        }
        Some(Ascents {
            count,
            unsure,
            steepest,
        })
    }

    /// The Hessian on the pushes that turn nothing, and the largest entry of the whole one; none where it is not finite.
    fn second_variation(
        &self,
        waves: &[Vec<Vector2<f64>>],
        degree: Degree,
    ) -> Option<(DMatrix<f64>, f64)> {
        let size = waves.len();
        let Subject {
            grid, path, coarse, ..
        } = self.subject;
        let path = match degree {
            Degree::Fine => path,
            Degree::Coarse => coarse,
        };
        let gain = (self.gain, self.rotation);
        let variation = Variation::new(grid, path, self.subject.seconds(), degree, gain);
        let push = |wave: &Vec<Vector2<f64>>| Push {
            slopes: grid.slopes(wave, degree),
            by: wave.clone(),
        };
        let pushes: Vec<Push> = waves.iter().map(push).collect();
        let turned = pushes.iter().map(|push| variation.turned(push, |by| by));
        let turned = DVector::from_iterator(size, turned);
        let reach = pushes.iter().map(|push| variation.turned(push, f64::abs));
        let reach = reach.fold(0.0, f64::max);
        let hessian = variation.of_gradients(&pushes);
        let hessian = 0.5 * (&hessian + hessian.transpose());
        if !hessian.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let before = hessian.amax();
        let reduced = if self.gain == Gain::Turning || turned.norm() <= 1e-9 * reach {
            hessian
        } else {
            without(&hessian, &turned)
        };
        Some((reduced, before))
    }

    /// The pushes at every node.
    fn waves(&self, slopes: &[Vector2<f64>]) -> Vec<Vec<Vector2<f64>>> {
        let windows = self.windows(slopes);
        let count = WAVES[usize::from(!self.symmetric)];
        let wave = |k: usize| {
            let push = |(node, (slope, window)): (&super::grid::Node, (&Vector2<f64>, &f64))| {
                let right = Vector2::new(slope.y, -slope.x);
                let turn = std::f64::consts::TAU * node.u;
                let height = if self.symmetric {
                    (2.0 * k as f64 * turn).cos()
                } else if k.is_multiple_of(2) {
                    (0.5 * k as f64 * turn).cos()
                } else {
                    (0.5 * (k + 1) as f64 * turn).sin()
                };
                let speed = right.norm();
                if speed > 0.0 {
                    right * (height * window / speed)
                } else {
                    Vector2::zeros()
                }
            };
            let nodes = self.subject.grid.nodes.iter();
            nodes
                .zip(slopes.iter().zip(&windows))
                .map(push)
                .collect::<Vec<_>>()
        };
        (0..count)
            .map(wave)
            .filter(|wave| wave.iter().any(|push| push.norm() > 1e-3))
            .collect()
    }

    /// 1 on a curve that is free and smooth all round; else a half wave over each free stretch and 0 on bounds.
    fn windows(&self, slopes: &[Vector2<f64>]) -> Vec<f64> {
        let pieces = &self.subject.grid.pieces;
        let smooth_after = |i: usize| {
            let (piece, next) = (&pieces[i], &pieces[(i + 1) % pieces.len()]);
            let (Some(a), Some(b)) = (
                slopes.get(*piece.nodes.end()),
                slopes.get(*next.nodes.start()),
            ) else {
                return false;
            };
            piece.along == Along::Free
                && next.along == Along::Free
                && a.perp(b).atan2(a.dot(b)).abs() < super::SMOOTH
        };
        let mut windows = vec![0.0; self.subject.grid.nodes.len()];
        let Some(first) = (0..pieces.len()).find(|&i| !smooth_after(i)) else {
            return vec![1.0; self.subject.grid.nodes.len()];
        };
        let u = |node: usize| self.subject.grid.nodes.get(node).map_or(0.0, |node| node.u);
        let width = |i: usize| u(*pieces[i].nodes.end()) - u(*pieces[i].nodes.start());
        let order: Vec<usize> = (1..=pieces.len())
            .map(|k| (first + k) % pieces.len())
            .collect();
        let mut begun = 0;
        while begun < order.len() {
            let run = order[begun..]
                .iter()
                .position(|&i| !smooth_after(i))
                .map_or(order.len(), |last| begun + last + 1);
            let stretch = &order[begun..run];
            let total: f64 = stretch.iter().map(|&i| width(i)).sum();
            let mut passed = 0.0;
            for &i in stretch {
                if pieces[i].along == Along::Free {
                    let start = u(*pieces[i].nodes.start());
                    for node in pieces[i].nodes.clone() {
                        let part = (passed + u(node) - start) / total;
                        windows[node] = (std::f64::consts::PI * part).sin().max(0.0);
                    }
                }
                passed += width(i);
            }
            begun = run;
        }
        windows
    }
}

/// The quadratic form on the plane across `direction`.
fn without(hessian: &DMatrix<f64>, direction: &DVector<f64>) -> DMatrix<f64> {
    let unit = direction / direction.norm();
    let across = DMatrix::identity(unit.len(), unit.len()) - &unit * unit.transpose();
    &across * hessian * &across
}
