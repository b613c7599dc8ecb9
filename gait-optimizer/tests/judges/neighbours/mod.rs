//! Comparison of a closed gait with its neighbours by the model alone: second differences of |d| of a polygon through the gait's
//! samples, perturbed by hats along its free arcs. From the model it takes A(Φ), from the library the samples.

use gait_optimizer::{ArcKind, OptimalGait};
use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use crate::plane::Pose;

/// Differences are taken over this \[rad\].
const H: f64 = 1e-3;

/// By how much some corners are pushed along their normals, in order.
type Push = Vec<(usize, f64)>;

pub(crate) struct Neighbours {
    model: Model<f64>,
    /// Closed: the last corner is the first.
    corners: Vec<Vector2<f64>>,
    normals: Vec<Vector2<f64>>,
    sides: Vec<Pose>,
    /// Inner corners of each free arc.
    free: Vec<std::ops::Range<usize>>,
}

impl Neighbours {
    pub(crate) fn of(gait: &OptimalGait) -> Self {
        let model = Model::new(&gait.swimmer.of_unit_length()).unwrap();
        let file = gait.gait_file("");
        let corners = file.phi;
        let last = corners.len() - 1;
        let normal = |at: usize| {
            let way = corners[at % last + 1] - corners[(at + last - 1) % last];
            Vector2::new(way.y, -way.x).normalize()
        };
        let at = |u: f64| file.u.partition_point(|&there| there < u - 1e-12);
        let singular = file.arcs.iter().filter(|arc| arc.kind == ArcKind::Singular);
        let side = |side: &[Vector2<f64>; 2]| Pose::along(&model, *side);
        Self {
            normals: (0..=last).map(normal).collect(),
            free: singular.map(|arc| at(arc.from) + 1..at(arc.to)).collect(),
            sides: corners.array_windows().map(side).collect(),
            corners,
            model,
        }
    }

    /// |d| and Δθ of the polygon that is pushed by some of each.
    fn carried(&self, pushes: &[(&Push, f64)]) -> [f64; 2] {
        let mut by = vec![0.0; self.corners.len()];
        for (push, times) in pushes {
            for (at, share) in *push {
                by[*at] += share * times;
            }
        }
        let sides = self.sides.iter().enumerate().map(|(at, side)| {
            let ends = [at, at + 1];
            if ends.iter().all(|&end| by[end] == 0.0) {
                return *side;
            }
            let ends = ends.map(|end| self.corners[end] + self.normals[end] * by[end]);
            Pose::along(&self.model, ends)
        });
        let end = sides.fold(Pose::default(), |pose, side| pose * side);
        [end.x.hypot(end.y), end.theta]
    }

    /// First differences of |d| and Δθ.
    fn first(&self, push: &Push) -> [f64; 2] {
        let [more, less] = [H, -H].map(|times| self.carried(&[(push, times)]));
        [0, 1].map(|k| (more[k] - less[k]) / (2.0 * H))
    }

    /// c for which |d| − c Δθ gains nothing to first order.
    fn multiplier(&self, pushes: &[Push]) -> f64 {
        let firsts = pushes.iter().map(|push| self.first(push));
        let [above, below] = firsts.fold([0.0; 2], |sums, [gained, turned]| {
            [sums[0] + gained * turned, sums[1] + turned * turned]
        });
        above / below
    }

    /// The second difference of |d| − c Δθ over two pushes.
    fn second(&self, c: f64, one: &Push, other: &Push) -> f64 {
        let value = |a: f64, b: f64| {
            let [carried, turned] = self.carried(&[(one, a * H), (other, b * H)]);
            carried - c * turned
        };
        let alike = value(1.0, 1.0) + value(-1.0, -1.0);
        (alike - value(1.0, -1.0) - value(-1.0, 1.0)) / (4.0 * H * H)
    }

    /// About `count` hats: half of them spaced evenly along the free arcs, half by the softness of the curve.
    fn hats(&self, count: usize) -> Vec<Push> {
        let every: Vec<Push> = self
            .free
            .iter()
            .flat_map(|arc| arc.clone().map(|at| vec![(at, 1.0)]))
            .collect();
        let c = self.multiplier(&every);
        // Displacement of a corner that loses as much as that of the others.
        let loose = |at: usize| {
            let width = (self.corners[at + 1] - self.corners[at - 1]).norm();
            let push = vec![(at, 1.0)];
            width * width / -self.second(c, &push, &push).min(-1e-12)
        };
        let length = |at: usize| (self.corners[at] - self.corners[at - 1]).norm();
        let steps: Vec<Vec<[f64; 2]>> = self
            .free
            .iter()
            .map(|arc| arc.clone().map(|at| [length(at), loose(at)]).collect())
            .collect();
        let whole = [0, 1].map(|k| steps.iter().flatten().map(|step| step[k]).sum::<f64>());
        let mut hats = Vec::new();
        for (arc, steps) in self.free.iter().zip(&steps) {
            let way: Vec<f64> = steps
                .iter()
                .scan(0.0, |way, step| {
                    *way += 0.5 * (step[0] / whole[0] + step[1] / whole[1]) * count as f64;
                    Some(*way)
                })
                .collect();
            let knots = way.last().map_or(0.0, |way| way.ceil());
            let mut knot = 1.0;
            while knot < knots {
                let shares = way.iter().map(|way| 1.0 - (way - knot).abs());
                let hat: Push = arc
                    .clone()
                    .zip(shares)
                    .filter(|(_, share)| *share > 0.0)
                    .collect();
                hats.push(hat);
                knot += 1.0;
            }
        }
        hats.retain(|hat| !hat.is_empty());
        hats
    }

    /// The largest eigenvalue of the second differences among perturbations without rotation, each hat scaled by its own.
    /// Negative if no neighbour moves farther. Returns `None` with fewer than two hats.
    pub(crate) fn steepest(&self, count: usize) -> Option<f64> {
        let hats = self.hats(count);
        if hats.len() < 2 {
            return None;
        }
        let c = self.multiplier(&hats);
        let n = hats.len();
        let mut second = DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                second[(i, j)] = self.second(c, &hats[i], &hats[j]);
                second[(j, i)] = second[(i, j)];
            }
        }
        let scale = DVector::from_fn(n, |i, _| 1.0 / second[(i, i)].abs().sqrt());
        let scaled = DMatrix::from_fn(n, n, |i, j| second[(i, j)] * scale[i] * scale[j]);
        let turned = DVector::from_fn(n, |i, _| self.first(&hats[i])[1] * scale[i]).normalize();
        let turning = &turned * turned.transpose();
        let off = DMatrix::identity(n, n) - &turning;
        let reduced = &off * scaled * &off - turning;
        Some(reduced.symmetric_eigenvalues().max())
    }
}
