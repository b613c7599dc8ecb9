//! The second variation of a gain, exactly: how the gain's gradient in pushes of the curve changes as the curve is pushed.
//!
//! The first variation is an integral of what stands at the nodes. A push changes the shapes there by itself, slopes and poses
//! linearly, connection and power by their exact derivatives; so the change of the gradient is one walk along the nodes, and
//! needs no model beyond the second derivatives at the unpushed shapes.

use nalgebra::{DMatrix, DVector, Matrix3x2, Vector2, Vector3};
use swimmer_model::SecondDerivatives;

use super::grid::{Degree, Grid};
use super::path::{Path, Place};
use crate::momentum::Momentum;

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

/// A push at every node \[rad\], and its slope there.
pub(super) struct Push {
    pub(super) by: Vec<Vector2<f64>>,
    pub(super) slopes: Vec<Vector2<f64>>,
}

/// A curve and its gain, ready to be varied.
pub(super) struct Variation<'a> {
    grid: &'a Grid,
    path: &'a Path,
    seconds: &'a [SecondDerivatives<f64>],
    degree: Degree,
    gain: Gain,
    momentum: Momentum,
    /// What each node counts for in an integral round the curve.
    weights: Vec<f64>,
    /// At every node μ, the curvature, and its derivatives by both angles.
    locals: Vec<[Vector3<f64>; 4]>,
}

/// How pushes change the gain to first order: what each node's push, and its slope, is multiplied by.
struct Change {
    by_push: Vec<Vector2<f64>>,
    by_slope: Vec<Vector2<f64>>,
}

/// The power's part at a node: what ∮√P gains by a slope and by a push.
#[derive(Clone, Copy)]
struct Dearer {
    by_slope: Vector2<f64>,
    by_push: Vector2<f64>,
}

impl<'a> Variation<'a> {
    /// `rotation` is the multiplier of rotation; `seconds` are the model's derivatives at the path's shapes.
    pub(super) fn new(
        grid: &'a Grid,
        path: &'a Path,
        seconds: &'a [SecondDerivatives<f64>],
        degree: Degree,
        (gain, rotation): (Gain, f64),
    ) -> Self {
        let d = path.displacement();
        let p = match gain {
            Gain::Displacement => d / d.norm(),
            Gain::Efficiency => d / d.norm_squared(),
            Gain::Sideways => Vector2::new(0.0, d.y.signum()),
            Gain::Turning => Vector2::zeros(),
        };
        let momentum = Momentum { p, c: rotation };
        let places = path.places.iter().zip(seconds);
        let locals = places.map(|(place, second)| {
            let [along1, along2] = second.d_curvature();
            let mu = momentum.at(&place.pose);
            [mu, place.first.curvature(), along1, along2]
        });
        Self {
            weights: grid.weights(degree),
            locals: locals.collect(),
            momentum,
            grid,
            path,
            seconds,
            degree,
            gain,
        }
    }

    /// First variation of Δθ under a push of the curve, each part of it taken as told.
    pub(super) fn turned(&self, push: &Push, part: fn(f64) -> f64) -> f64 {
        let places = self.path.places.iter().zip(&push.by);
        let places = places.zip(self.locals.iter().zip(&self.weights));
        let turned = places.map(|((place, by), ([_, curvature, ..], weight))| {
            weight * part(curvature.z * by.perp(&place.rate))
        });
        turned.sum()
    }

    /// How the gradient of the gain in each of the `pushes` changes with each.
    pub(super) fn of_gradients(&self, pushes: &[Push]) -> DMatrix<f64> {
        let lengthened: Vec<f64> = match self.gain {
            Gain::Efficiency => pushes.iter().map(|push| self.lengthened(push)).collect(),
            _ => vec![0.0; pushes.len()],
        };
        let columns = pushes
            .iter()
            .map(|push| self.of_gradient(push, pushes, &lengthened));
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    /// How a push of the curve changes the gradient of the gain in each of the `pushes`, that gain so much of ∮√P.
    fn of_gradient(&self, push: &Push, pushes: &[Push], lengthened: &[f64]) -> DVector<f64> {
        let poses = self.pose_changes(push);
        let end = poses.last().copied().unwrap_or_default();
        let p = self.momentum_change(&end.xy());
        let mut change = self.of_height(push, &poses, &p);
        let longer = if self.gain == Gain::Efficiency {
            self.of_length(push, &mut change)
        } else {
            0.0
        };
        let sum = |(other, lengthened): (&Push, &f64)| {
            let by_push = change.by_push.iter().zip(&other.by);
            let by_slope = change.by_slope.iter().zip(&other.slopes);
            let inside = by_push.chain(by_slope).map(|(by, push)| by.dot(push));
            inside.sum::<f64>() + self.at_the_ends(push, other, (&end, &p)) + longer * lengthened
        };
        DVector::from_iterator(pushes.len(), pushes.iter().zip(lengthened).map(sum))
    }

    /// How x, y and θ change at every node.
    fn pose_changes(&self, push: &Push) -> Vec<Vector3<f64>> {
        let places = || {
            self.path
                .places
                .iter()
                .zip(push.by.iter().zip(&push.slopes))
        };
        let bodies: Vec<Vector3<f64>> = places()
            .map(|(place, (by, slope))| {
                connection_change(place, by) * place.rate + place.first.connection * slope
            })
            .collect();
        let turning: Vec<f64> = bodies.iter().map(|body| body.z).collect();
        let headings = self.grid.integrals(&turning, 0.0, self.degree);
        let velocities: Vec<Vector2<f64>> = self
            .path
            .places
            .iter()
            .zip(bodies.iter().zip(&headings))
            .map(|(place, (change, turn))| {
                let body = place.first.connection * place.rate;
                let (sin, cos) = place.heading;
                // R δv + R J v δθ
                let along = Vector2::new(change.x - body.y * turn, change.y + body.x * turn);
                Vector2::new(cos * along.x - sin * along.y, sin * along.x + cos * along.y)
            })
            .collect();
        let positions = self
            .grid
            .integrals(&velocities, Vector2::zeros(), self.degree);
        positions
            .iter()
            .zip(&headings)
            .map(|(position, theta)| Vector3::new(position.x, position.y, *theta))
            .collect()
    }

    /// How p changes with the net displacement.
    fn momentum_change(&self, by: &Vector2<f64>) -> Vector2<f64> {
        let d = self.path.displacement();
        let square = d.norm_squared();
        match self.gain {
            Gain::Displacement => (by - d * (d.dot(by) / square)) / square.sqrt(),
            Gain::Efficiency => (by - d * (2.0 * d.dot(by) / square)) / square,
            Gain::Sideways | Gain::Turning => Vector2::zeros(),
        }
    }

    /// How μ changes at a place, with the pose and with p.
    fn mu_change(&self, place: &Place, pose: &Vector3<f64>, by: &Vector2<f64>) -> Vector3<f64> {
        let Momentum { p, .. } = &self.momentum;
        let ([x, y, _], (sin, cos)) = (place.pose, place.heading);
        let turned = |v: &Vector2<f64>| (v.x * cos + v.y * sin, v.y * cos - v.x * sin);
        let ((along, across), (along_by, across_by)) = (turned(p), turned(by));
        Vector3::new(
            along_by + pose.z * across,
            across_by - pose.z * along,
            by.x * y - by.y * x + p.x * pose.y - p.y * pose.x,
        )
    }

    /// Of the height times the area that is swept.
    fn of_height(&self, push: &Push, poses: &[Vector3<f64>], p: &Vector2<f64>) -> Change {
        let mut by_push = Vec::with_capacity(push.by.len());
        let places = self.path.places.iter().zip(&self.locals).zip(poses);
        let pushes = push.by.iter().zip(&push.slopes).zip(&self.weights);
        for (((place, [mu, curvature, along1, along2]), pose), ((by, slope), weight)) in
            places.zip(pushes)
        {
            let higher = self.mu_change(place, pose, p).dot(curvature)
                + mu.dot(&(along1 * by.x + along2 * by.y));
            let swept = place.rate * higher + slope * mu.dot(curvature);
            by_push.push(Vector2::new(swept.y, -swept.x) * *weight);
        }
        Change {
            by_push,
            by_slope: Vec::new(),
        }
    }

    /// Of −ln ∮√P, added to a change; returns what it is by the length's own change, for each ∮√P gained.
    fn of_length(&self, push: &Push, change: &mut Change) -> f64 {
        let length = self.path.total_power_length();
        let mut longer = 0.0;
        let places = self.path.places.iter().zip(self.seconds);
        let pushes = push.by.iter().zip(&push.slopes).zip(&self.weights);
        let sums = change.by_push.iter_mut();
        for (((place, second), ((by, slope), weight)), sum) in places.zip(pushes).zip(sums) {
            let (root, Dearer { by_slope, by_push }) = dearer_change(place, second, by, slope);
            longer += weight * root;
            *sum -= by_push * (weight / length);
            change.by_slope.push(by_slope * (-weight / length));
        }
        longer / (length * length)
    }

    /// First variation of ∮√P under a push of the curve.
    fn lengthened(&self, push: &Push) -> f64 {
        let places = self.path.places.iter().zip(&self.weights);
        let longer =
            places
                .zip(push.by.iter().zip(&push.slopes))
                .map(|((place, weight), (by, slope))| {
                    let dearer = dearer(place);
                    weight * (dearer.by_slope.dot(slope) + dearer.by_push.dot(by))
                });
        longer.sum()
    }

    /// Of what the first and the last place add when the first shape is pushed.
    fn at_the_ends(
        &self,
        push: &Push,
        other: &Push,
        (end, p): (&Vector3<f64>, &Vector2<f64>),
    ) -> f64 {
        let (Some(first), Some(last)) = (self.path.places.first(), self.path.places.last()) else {
            return 0.0;
        };
        let (Some(by), Some(other)) = (push.by.first(), other.by.first()) else {
            return 0.0;
        };
        let mu = self.momentum.at(&last.pose) - self.momentum.at(&first.pose);
        let mu_change = self.mu_change(last, end, p) - self.mu_change(first, &Vector3::zeros(), p);
        mu_change.dot(&(first.first.connection * other))
            + mu.dot(&(connection_change(first, by) * other))
    }
}

/// How A changes with a push of the shape.
fn connection_change(place: &Place, by: &Vector2<f64>) -> Matrix3x2<f64> {
    let [d1, d2] = &place.first.d_connection;
    d1 * by.x + d2 * by.y
}

fn dearer(place: &Place) -> Dearer {
    let ([d1, d2], rate) = (&place.first.d_power, &place.rate);
    Dearer {
        by_slope: place.first.power * rate / place.root_power,
        by_push: Vector2::new(rate.dot(&(d1 * rate)), rate.dot(&(d2 * rate)))
            * (0.5 / place.root_power),
    }
}

/// How √P and [`dearer`] change with a push of the shape and its slope.
fn dearer_change(
    place: &Place,
    second: &SecondDerivatives<f64>,
    by: &Vector2<f64>,
    slope: &Vector2<f64>,
) -> (f64, Dearer) {
    let ([d1, d2], rate, w) = (&place.first.d_power, &place.rate, &place.first.power);
    let [d11, d12, d22] = &second.d2_power;
    let before = dearer(place);
    let root = before.by_slope.dot(slope) + before.by_push.dot(by);
    let shrunk = root / place.root_power;
    let power = (d1 * by.x + d2 * by.y) * rate + w * slope;
    let of_slopes = Vector2::new(rate.dot(&(d1 * slope)), rate.dot(&(d2 * slope)));
    let bent = [d11 * by.x + d12 * by.y, d12 * by.x + d22 * by.y];
    let of_shapes = Vector2::new(rate.dot(&(bent[0] * rate)), rate.dot(&(bent[1] * rate))) * 0.5;
    let change = Dearer {
        by_slope: power / place.root_power - before.by_slope * shrunk,
        by_push: (of_slopes + of_shapes) / place.root_power - before.by_push * shrunk,
    };
    (root, change)
}

#[cfg(test)]
mod tests {
    use super::super::grid::Along;
    use super::*;
    use swimmer_files::GaitFile;
    use swimmer_model::{Model, Swimmer};

    const COUNT: usize = 400;
    const ROTATION: f64 = 0.3;

    fn along(shape: impl Fn(f64) -> [f64; 2]) -> Vec<Vector2<f64>> {
        let u = |k: usize| k as f64 / COUNT as f64 * std::f64::consts::TAU;
        (0..=COUNT).map(|k| Vector2::from(shape(u(k)))).collect()
    }

    /// The value whose second variation is asked for, of a curve through these shapes.
    fn value(gain: Gain, model: &Model<f64>, grid: &Grid, shapes: &[Vector2<f64>]) -> f64 {
        let path = Path::new(model, grid, shapes, Degree::Fine);
        let d = path.displacement();
        let gained = match gain {
            Gain::Displacement => d.norm(),
            Gain::Efficiency => (d.norm() / path.total_power_length()).ln(),
            Gain::Sideways | Gain::Turning => 0.0,
        };
        gained + ROTATION * path.rotation()
    }

    /// Against mixed differences of the value itself, whose first variation is written nowhere. Not sideways, whose value is
    /// told by this multiplier of rotation only as far as pushes turn nothing.
    #[test]
    fn the_second_variation_is_that_of_the_value() {
        let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
        let shapes = along(|u| [1.3 * u.cos() + 0.1 * (2.0 * u).sin(), 1.1 * (u + 0.2).sin()]);
        let file = GaitFile {
            u: (0..=COUNT).map(|k| k as f64 / COUNT as f64).collect(),
            phi: shapes.clone(),
            ..GaitFile::default()
        };
        let (grid, shapes) = Grid::new(&file, &vec![Along::Free; COUNT]);
        let path = Path::new(&model, &grid, &shapes, Degree::Fine);
        let seconds: Vec<_> = shapes
            .iter()
            .map(|phi| model.second_derivatives(phi))
            .collect();
        let pushes: Vec<Push> = [
            along(|u| [0.7 * u.cos(), 0.2 + (2.0 * u).sin()]),
            along(|u| [(3.0 * u).cos(), -0.5 * u.sin()]),
        ]
        .into_iter()
        .map(|by| Push {
            slopes: grid.slopes(&by, Degree::Fine),
            by,
        })
        .collect();
        for gain in [Gain::Displacement, Gain::Efficiency, Gain::Turning] {
            let variation = Variation::new(&grid, &path, &seconds, Degree::Fine, (gain, ROTATION));
            for (one, exact) in variation.of_gradients(&pushes).column_iter().enumerate() {
                for (other, exact) in exact.iter().enumerate() {
                    let h = 1e-3;
                    let at = |a: f64, b: f64| {
                        let by = pushes[one].by.iter().zip(&pushes[other].by);
                        let pushed: Vec<_> = shapes
                            .iter()
                            .zip(by)
                            .map(|(phi, (x, y))| phi + x * (a * h) + y * (b * h))
                            .collect();
                        value(gain, &model, &grid, &pushed)
                    };
                    let mixed = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0))
                        / (4.0 * h * h);
                    assert!(
                        (mixed - exact).abs() < 1e-5 * (1.0 + exact.abs()),
                        "{gain:?} {one} {other}: {mixed} {exact}"
                    );
                }
            }
        }
    }
}
