//! Second-order test for any closed curve: does a neighbouring curve gain?
//!
//! The curve is perturbed along its normal by hat functions over knots on each free stretch; stretches end at bounds and corners.
//! At an optimum the second variation of the gain ([`super::variation`]), restricted to perturbations without rotation, has no
//! ascent direction.

mod mesh;

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_files::Bounds;
use swimmer_model::{GaussLegendre, Model};

use super::Subject;
use super::grid::Node;
use super::path::{CurveNode, CurvePoint, Path};
use super::variation::{Element, Form, Gain, Push};
use crate::certificate::{Check, Condition};
use crate::cycle::Cycle;
use crate::momentum::Momentum;
use mesh::{Knot, Mesh};

/// A curve and what it is optimal for.
pub(super) struct Neighbours<'a> {
    pub(super) subject: &'a Subject<'a>,
    pub(super) gain: Gain,
    pub(super) momentum: Momentum,
    /// Only pushes that keep the paper's symmetries: of the first quarter, which goes on into its images.
    pub(super) symmetric: bool,
}

/// Gauss points of a part, which is one unit long.
const PLACES: [f64; 2] = {
    let [first, last] = GaussLegendre::<2>::NODES;
    [0.5 + 0.5 * first, 0.5 + 0.5 * last]
};
/// Places this close in u are the same.
const SAME: f64 = 1e-9;
/// Curvatures below this fraction of the largest count as zero. If effort is part of the objective, the largest curvature is that
/// of the narrowest hat, and that of the widest is smaller by the square of the number of knots.
const FLAT: f64 = 1e-5;
const FLAT_OF_WIDEST: f64 = 1e-3;
/// Rounding leaves less than this part of the form open.
const ROUNDING: f64 = 1e-9;

/// The directions that lead up from a curve.
#[derive(Default)]
pub(super) struct Ascents {
    /// Number of independent ascent directions.
    pub(super) count: usize,
    /// Number of those that the samples leave undecided.
    unsure: usize,
    /// The steepest, as a push at every node; the farthest push is 1 rad. Empty where it is not known, or none leads up.
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
    /// Counts the perturbations that gain with these multipliers: those that keep the paper's symmetries, if the curve has them,
    /// and those of any kind. The list is empty if the curve has no free stretch.
    pub(super) fn ascents(&self, gain: Gain, momentum: Momentum) -> Vec<Check> {
        let of = |symmetric: bool| {
            let neighbours = Neighbours {
                subject: self,
                gain,
                momentum,
                symmetric,
            };
            Some(neighbours.ascents()?.check())
        };
        let mut checks = Vec::new();
        if self.symmetric
            && !self.region.is_of_quarters()
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
    /// Ascent directions. Returns `None` if the curve has no free stretch.
    pub(super) fn ascents(&self) -> Option<Ascents> {
        let Subject { path, coarse, .. } = self.subject;
        let mesh = self.mesh();
        if mesh.count == 0 {
            return None;
        }
        let Some((reduced, before, far)) = self.second_variation(&mesh, path) else {
            // Nothing is known of any.
            return Some(Ascents {
                count: mesh.count,
                unsure: mesh.count,
                steepest: Vec::new(),
            });
        };
        // None at a maximum, which a factorisation shows sooner than the eigenvalues do.
        if (-&reduced).cholesky().is_some() {
            return Some(Ascents::default());
        }
        let eigen = reduced.clone().symmetric_eigen();
        let values = &eigen.eigenvalues;
        let flat = if self.gain.is_priced() {
            FLAT_OF_WIDEST / (mesh.count as f64).powi(2)
        } else {
            FLAT
        };
        // Where next to nothing is free all pushes are alike, and but for rounding none is left that turns nothing.
        let level = (flat * values.amax()).max(ROUNDING * before);
        let up = |level: f64| values.iter().filter(|&&value| value > level).count();
        let count = up(level);
        // Another matrix moves no eigenvalue by more than its distance.
        let unsure = if count == 0 {
            0
        } else {
            let other = self.second_variation(&mesh, coarse);
            let apart = other.map_or(f64::INFINITY, |(other, ..)| (&reduced - other).norm());
            count - up(level + apart)
        };
        Some(Ascents {
            count,
            unsure,
            steepest: self.steepest(
                &mesh,
                &eigen.eigenvectors.column(values.imax()).component_mul(&far),
            ),
        })
    }

    /// Half the second variation on the pushes that turn nothing, the largest entry of the whole one, and how far each knot is pushed; none
    /// where it is not finite.
    fn second_variation(
        &self,
        mesh: &Mesh,
        path: &Path,
    ) -> Option<(DMatrix<f64>, f64, DVector<f64>)> {
        let elements = self.elements(mesh, path);
        let form = Form::new(&elements, mesh.count, self.gain, &self.momentum);
        let (p, d) = (&self.momentum.p, &path.displacement());
        let form = if self.symmetric {
            form.of_quarter(0.25 * p.dot(d))
        } else {
            form.of_whole_cycle(self.gain, (p, d), &self.started(mesh))
        };
        if !form.half.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let Form {
            mut half,
            mut turned,
            mut reach,
            ..
        } = form;
        // Where effort counts all knots are alike; else each is pushed as far as makes its own part of the form one.
        let mut far = DVector::repeat(mesh.count, 1.0);
        if !self.gain.is_priced() {
            far = half
                .diagonal()
                .map(|own| own.abs().max(f64::MIN_POSITIVE).sqrt().recip());
            turned.component_mul_assign(&far);
            reach.component_mul_assign(&far);
            half.component_mul_assign(&(&far * far.transpose()));
        }
        let before = half.amax();
        // Images turn back what a quarter turns.
        let turns =
            !self.symmetric && self.gain != Gain::Turning && turned.norm() > 1e-9 * reach.amax();
        let reduced = if turns { without(half, &turned) } else { half };
        Some((reduced, before, far))
    }

    /// Rotation of the heading at the start per unit push of each knot.
    fn started(&self, mesh: &Mesh) -> DVector<f64> {
        let mut started = DVector::zeros(mesh.count);
        if let (Some(Some(knot)), Some(place)) = (
            mesh.knots.first().map(|knot| knot.number),
            self.subject.path.places.first(),
        ) {
            started[knot] = (place.first.connection * place.right()).z;
        }
        started
    }

    fn elements(&self, mesh: &Mesh, path: &Path) -> Vec<Element> {
        let Subject { grid, model, .. } = self.subject;
        let mut elements = Vec::with_capacity(PLACES.len() * mesh.knots.len());
        for [from, to] in mesh.knots.array_windows() {
            let width = to.u - from.u;
            // Two pieces meet in two knots.
            if width <= SAME {
                continue;
            }
            for share in PLACES {
                let Some(CurvePoint {
                    phi,
                    rate,
                    bend,
                    pose,
                }) = path.between(grid, from.u + share * width)
                else {
                    continue;
                };
                let second = model.second_derivatives(&phi);
                let speed = rate.norm();
                let right = Vector2::new(rate.y, -rate.x) / speed;
                let right_rate = rate * (rate.perp(&bend) / (speed * speed * speed));
                let scale = if self.gain.is_priced() {
                    rate.dot(&(second.first.power * rate)).sqrt()
                } else {
                    1.0
                };
                let slope = 1.0 / width;
                let hats = [
                    (from.number, 1.0 - share, -slope),
                    (to.number, share, slope),
                ];
                let pushes = hats.into_iter().filter_map(|(knot, value, slope)| {
                    Some(Push {
                        knot: knot?,
                        by: right * value,
                        slope: (right * slope + right_rate * value) / scale,
                    })
                });
                elements.push(Element {
                    pushes: pushes.collect(),
                    second,
                    rate: rate / scale,
                    pose,
                    length: width / PLACES.len() as f64 * scale,
                });
            }
        }
        elements
    }

    /// A direction as a push at every node.
    fn steepest(&self, mesh: &Mesh, weights: &DVector<f64>) -> Vec<Vector2<f64>> {
        let height = |u: f64| {
            let after = mesh.knots.partition_point(|knot| knot.u < u).max(1);
            let (from, to) = (mesh.knots.get(after - 1)?, mesh.knots.get(after)?);
            let share = (u - from.u) / (to.u - from.u);
            let at = |knot: &Knot| knot.number.map_or(0.0, |number| weights[number]);
            share
                .is_finite()
                .then(|| at(from) * (1.0 - share) + at(to) * share)
        };
        let nodes = self
            .subject
            .grid
            .nodes
            .iter()
            .zip(&self.subject.path.places);
        let push =
            |(node, place): (&Node, &CurveNode)| place.right() * height(node.u).unwrap_or(0.0);
        let pushes: Vec<Vector2<f64>> = nodes.map(push).collect();
        let farthest = pushes.iter().map(Vector2::norm).fold(0.0, f64::max);
        pushes.iter().map(|push| push / farthest).collect()
    }
}

/// Along how many directions the efficiency of a cycle grows to second order, by pushes that keep the paper's symmetries, which it then
/// has, or of any kind.
pub(crate) fn ascents_of_efficiency(model: &Model<f64>, cycle: &Cycle, symmetric: bool) -> usize {
    let bounds = Bounds::default();
    let within = (&bounds, &model.swimmer().links);
    let subject = Subject::new(model, &cycle.file(bounds), within);
    let neighbours = Neighbours {
        gain: Gain::Efficiency,
        momentum: subject.effort_momentum(),
        subject: &subject,
        symmetric,
    };
    neighbours.ascents().map_or(0, |ascents| ascents.count)
}

/// A form on the plane across a linear function; along that it is as far below zero as it is anywhere.
fn without(mut form: DMatrix<f64>, function: &DVector<f64>) -> DMatrix<f64> {
    let unit = function.normalize();
    let pulled = &form * &unit;
    let below = -form.amax();
    let along = below + unit.dot(&pulled);
    form.ger(-1.0, &unit, &pulled, 1.0);
    form.ger(-1.0, &pulled, &unit, 1.0);
    form.ger(along, &unit, &unit, 1.0);
    form
}
