//! The second-order test that any curve can be asked: is a neighbour better?
//!
//! The curve is pushed along its normal by waves over each of its free stretches, which end at bounds and corners. The objective's
//! Hessian in these waves is exact ([`super::variation`]), and on the waves that turn nothing that of an optimum has no direction that
//! leads up.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{DMatrix, DVector, Vector2};

use super::Subject;
use super::grid::{Along, Degree, Node};
use super::variation::{Gain, Push, Variation};
use crate::certificate::{Check, Condition};

/// A curve and what it is optimal for.
pub(super) struct Neighbours<'a> {
    pub(super) subject: &'a Subject<'a>,
    pub(super) gain: Gain,
    /// Multiplier of rotation, in the units of the gain.
    pub(super) rotation: f64,
    /// Only waves that keep the paper's symmetries.
    pub(super) symmetric: bool,
}

/// Half waves all round, and the fewest of a free stretch. Where effort counts, kinks are dear; where it does not, the best push need not
/// vanish towards bounds, which sines come to slowly.
const HALF_WAVES: [f64; 2] = [48.0, 96.0];
const FEWEST: usize = 3;
/// Places this close in u are the same.
const SAME: f64 = 1e-9;
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
        if self.symmetric
            && !self.limits.region.is_of_quarters()
            && let Some(of_any) = of(false)
        {
            checks.push(Check {
                condition: Condition::NoAscentWithoutSymmetry,
                ..of_any
            });
            // Those with the symmetries are among them.
            if of_any.pass {
                checks.push(of_any);
                return checks;
            }
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
        let nodes = || self.subject.grid.nodes.iter().zip(slopes);
        let pushes = |wave: &Wave| -> Vec<Vector2<f64>> {
            let push = |(node, slope): (&Node, &Vector2<f64>)| {
                let right = Vector2::new(slope.y, -slope.x);
                let height = if self.symmetric {
                    let images = [node.u, 0.5 - node.u, 0.5 + node.u, 1.0 - node.u];
                    images.map(|u| wave.at(u)).iter().sum()
                } else {
                    wave.at(node.u)
                };
                let speed = right.norm();
                if node.along == Along::Free && speed > 0.0 {
                    right * (height / speed)
                } else {
                    Vector2::zeros()
                }
            };
            nodes().map(push).collect()
        };
        let half_waves = HALF_WAVES[usize::from(self.gain != Gain::Efficiency)];
        let stretches = self.stretches(slopes);
        let stretches = stretches.iter().filter(|stretch| {
            // Of images one is enough.
            let middle = (stretch.from + 0.5 * stretch.width).rem_euclid(1.0);
            !self.symmetric || stretch.closed || middle <= 0.25 + SAME || middle >= 1.0 - SAME
        });
        stretches
            .flat_map(|stretch| stretch.waves(half_waves))
            .map(|wave| pushes(&wave))
            .filter(|wave| wave.iter().any(|push| push.norm() > 1e-3))
            .collect()
    }

    /// The free stretches of the curve between bounds and corners; the whole of it where it is free and smooth all round.
    fn stretches(&self, slopes: &[Vector2<f64>]) -> Vec<Stretch> {
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
        let Some(first) = (0..pieces.len()).find(|&i| !smooth_after(i)) else {
            return vec![Stretch {
                from: 0.0,
                width: 1.0,
                closed: true,
            }];
        };
        let u = |node: usize| self.subject.grid.nodes.get(node).map_or(0.0, |node| node.u);
        let mut stretches = Vec::new();
        let mut width = 0.0;
        for i in (1..=pieces.len()).map(|k| (first + k) % pieces.len()) {
            let (from, to) = (u(*pieces[i].nodes.start()), u(*pieces[i].nodes.end()));
            width += to - from;
            if !smooth_after(i) {
                if pieces[i].along == Along::Free {
                    stretches.push(Stretch {
                        from: to - width,
                        width,
                        closed: false,
                    });
                }
                width = 0.0;
            }
        }
        stretches
    }
}

/// A free stretch of the curve, in fractions of the period.
struct Stretch {
    from: f64,
    width: f64,
    /// Whether its ends are one.
    closed: bool,
}

/// A sine over a stretch: how many half waves, and where in the first it begins.
struct Wave<'a> {
    stretch: &'a Stretch,
    halves: usize,
    phase: f64,
}

impl Stretch {
    /// With so many half waves in a period.
    fn waves(&self, half_waves: f64) -> Vec<Wave<'_>> {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some tens
        let most = ((half_waves * self.width).round() as usize).max(FEWEST);
        let wave = |halves: usize, phase: f64| Wave {
            stretch: self,
            halves,
            phase,
        };
        if !self.closed {
            return (1..=most).map(|halves| wave(halves, 0.0)).collect();
        }
        let even = (0..=most).step_by(2);
        even.flat_map(|halves| [wave(halves, FRAC_PI_2), wave(halves, 0.0)])
            .collect()
    }
}

impl Wave<'_> {
    fn at(&self, u: f64) -> f64 {
        let part = (u - self.stretch.from).rem_euclid(1.0) / self.stretch.width;
        if part > 1.0 {
            return 0.0;
        }
        (PI * self.halves as f64 * part + self.phase).sin()
    }
}

/// The quadratic form on the plane across `direction`.
fn without(hessian: &DMatrix<f64>, direction: &DVector<f64>) -> DMatrix<f64> {
    let unit = direction / direction.norm();
    let across = DMatrix::identity(unit.len(), unit.len()) - &unit * unit.transpose();
    &across * hessian * &across
}
