//! Gait prepared for certification: integrated along its samples, with its bounds. Includes the conditions that do not depend on the
//! objective.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, GaitFile};
use swimmer_model::{Links, Model, crossing_share};

use super::grid::{Along, Degree, Grid, along_arcs};
use super::limits::Limit;
use super::path::Path;
use super::resolution::Rounding;
use super::symmetry::is_symmetric;
use crate::certificate::{Check, Condition, Dependence, simple_and_turning_once};
use crate::numerics::worse;
use crate::region::Region;

/// Gait prepared for certification.
pub(super) struct Subject<'a> {
    pub(super) model: &'a Model<f64>,
    pub(super) bounds: &'a Bounds,
    pub(super) region: Region,
    pub(super) grid: Grid,
    pub(super) shapes: Vec<Vector2<f64>>,
    pub(super) path: Path,
    /// Path by the coarser polynomials.
    pub(super) coarse: Path,
    pub(super) symmetric: bool,
    /// Largest distance of a sample from a bound on which it is, due to rounding \[rad\].
    pub(super) written: f64,
}

/// Errors due to the sampling.
#[derive(Debug, Clone, Copy)]
pub(super) struct Openness {
    /// Relative error of slopes.
    pub(super) slope: f64,
    /// Error of poses, over L and in radians.
    pub(super) pose: f64,
}

impl<'a> Subject<'a> {
    /// Prepares a gait; `links` are those of the swimmer \[m\].
    pub(super) fn new(
        model: &'a Model<f64>,
        gait: &GaitFile,
        (bounds, links): (&'a Bounds, &Links<f64>),
    ) -> Self {
        let region = Region::new(bounds, links);
        let along = if gait.arcs.is_empty() {
            touching(&region, gait)
        } else {
            along_arcs(gait)
        };
        let (grid, shapes) = Grid::new(gait, &along);
        let path = Path::new(model, &grid, &shapes, Degree::Fine);
        Self {
            coarse: path.again(&grid, &shapes, Degree::Coarse),
            path,
            symmetric: is_symmetric(gait),
            written: 2.0 * Rounding::of(gait).phi,
            model,
            bounds,
            region,
            grid,
            shapes,
        }
    }

    pub(super) fn openness(&self) -> Openness {
        let slopes = self.path.places.iter().zip(&self.coarse.places);
        let slope = slopes
            .map(|(fine, coarse)| (fine.rate - coarse.rate).norm() / fine.rate.norm())
            .fold(0.0, worse);
        Openness {
            slope,
            pose: self.path.pose_distance(&self.coarse),
        }
    }

    /// Least gain of a gait that is no mere rounding. Small gaits gain as the square of their angles.
    pub(super) fn least_gain(&self) -> f64 {
        let reach = self.shapes.iter().map(Vector2::amax).fold(0.0, f64::max);
        Condition::Gains.tolerance() * reach.powi(2).min(1.0)
    }

    /// Conditions of closure and bounds. Samples that are too coarse do not prove symmetry.
    pub(super) fn of_the_curve(
        &self,
        gait: &GaitFile,
        curve: &AnyGait,
        coarse: bool,
    ) -> Vec<Check> {
        let at_samples = |check: Check| check.depends_on(Dependence::Samples);
        let gap = match (gait.phi.first(), gait.phi.last()) {
            (Some(first), Some(last)) => (last - first).norm(),
            _ => f64::NAN,
        };
        let mut checks = vec![at_samples(Condition::Closed.check(gap))];
        if self.region.is_of_quarters() {
            let off = if self.symmetric { 0.0 } else { 1.0 };
            let depends_on = if coarse {
                Dependence::Spacing
            } else {
                Dependence::Curve
            };
            let check = Condition::PapersSymmetries.check(off);
            checks.push(check.depends_on(depends_on));
        }
        let nodes = 0..self.grid.nodes.len();
        let limits = nodes.flat_map(|node| self.limits_at(node));
        let overstepped = limits.map(|limit| -limit.margin).reduce(worse);
        let overstepped = overstepped.map(|by| Condition::KeepsBounds.check(by));
        checks.extend(overstepped.map(at_samples));
        if self.bounds.no_overlap {
            let crosses = crossing_share(&self.model.swimmer().links, curve);
            let folds = if crosses.folds { 1.0 } else { 0.0 };
            checks.push(at_samples(Condition::NothingFolded.check(folds)));
        }
        for (curved, condition) in [(false, Condition::OnBound), (true, Condition::OnClearance)] {
            let off = (0..self.grid.nodes.len())
                .filter(|&node| self.along(node) == Along::Bound)
                .map(|node| self.bound_followed(node).map(|(_, limit)| limit))
                .filter(|limit| limit.is_some_and(|limit| limit.curved) == curved)
                .map(|limit| limit.map_or(f64::NAN, |limit| limit.margin.abs()))
                .reduce(worse);
            checks.extend(off.map(|off| at_samples(condition.check(off))));
        }
        checks
    }

    /// Conditions that the curve is simple and turns once.
    pub(super) fn of_its_loop(&self, gait: &GaitFile) -> [Check; 2] {
        // A gait that may follow the diagonals meets its own images there; then only the quarter must be simple.
        let quarter = gait.u.partition_point(|&u| u <= 0.25 + 1e-12);
        let simple = if self.region.has_diagonals() {
            gait.phi.get(..quarter).unwrap_or_default()
        } else {
            &gait.phi
        };
        simple_and_turning_once(&gait.phi, simple)
            .map(|check| check.depends_on(Dependence::Samples))
    }

    pub(super) fn along(&self, node: usize) -> Along {
        self.grid
            .nodes
            .get(node)
            .map_or(Along::Free, |node| node.along)
    }

    /// y over L at a quarter of the cycle.
    pub(super) fn y_at_the_quarter(&self) -> f64 {
        let y: Vec<f64> = self.path.places.iter().map(|place| place.pose[1]).collect();
        self.grid.interpolated(&y, 0.25)
    }
}

/// Detects the intervals between knots that are on a bound, for a gait without arcs.
fn touching(region: &Region, gait: &GaitFile) -> Vec<Along> {
    let written = 2.0 * Rounding::of(gait).phi;
    let on_bound = |[a, b]: &[Vector2<f64>; 2], u: f64| {
        let quarter = (0..3).find(|&q| u < 0.25 * (q + 1) as f64).unwrap_or(3);
        let [from, to] = [a, b].map(|phi| Limit::all(region, phi, quarter));
        let touches =
            |limit: &Limit| limit.margin.abs() <= Condition::OnBound.tolerance() + written;
        from.iter()
            .zip(&to)
            .any(|(from, to)| touches(from) && touches(to))
    };
    gait.phi
        .array_windows()
        .zip(gait.u.array_windows())
        .map(|(pair, &[from, to])| {
            if on_bound(pair, f64::midpoint(from, to)) {
                Along::Bound
            } else {
                Along::Free
            }
        })
        .collect()
}
