//! A quarter gait swum by one member of the ensemble, with the height of its displacement along the way.

use nalgebra::{Vector2, Vector3};
use swimmer_model::Model;

use super::nodes::Nodes;
use crate::member::Member;

/// One smooth arc: shapes and their derivative at the nodes.
#[derive(Debug, Clone)]
pub(super) struct ArcCurve {
    pub(super) phi: Vec<Vector2<f64>>,
    pub(super) slope: Vec<Vector2<f64>>,
}

/// A swimmer's way along a quarter gait. Lengths are over L.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    /// X of the full cycle, four times the quarter's.
    pub(super) displacement: f64,
    /// Heading and y at the nodes, arc after arc, and y at the quarter's end.
    theta: Vec<f64>,
    y: Vec<f64>,
    final_y: f64,
}

impl Trajectory {
    pub(super) fn new(member: &Member, nodes: &Nodes, arcs: &[ArcCurve]) -> Self {
        let Member { model, gain } = member;
        let (mut x, mut y, mut theta) = (0.0, 0.0, 0.0);
        let mut swum = Self {
            displacement: 0.0,
            theta: Vec::new(),
            y: Vec::new(),
            final_y: 0.0,
        };
        for arc in arcs {
            let body: Vec<Vector3<f64>> = arc
                .phi
                .iter()
                .zip(&arc.slope)
                .map(|(phi, slope)| model.local_connection(&(phi * *gain)) * slope * *gain)
                .collect();
            let column =
                |of: fn(&Vector3<f64>) -> f64| -> Vec<f64> { body.iter().map(of).collect() };
            let turned: Vec<f64> = nodes
                .integrals(&column(|twist| twist.z))
                .into_iter()
                .map(|turn| theta + turn)
                .collect();
            let rates: Vec<(f64, f64)> = body
                .iter()
                .zip(&turned)
                .map(|(twist, theta)| {
                    let (sin, cos) = theta.sin_cos();
                    (cos * twist.x - sin * twist.y, sin * twist.x + cos * twist.y)
                })
                .collect();
            let rise: Vec<f64> = rates.iter().map(|rate| rate.1).collect();
            swum.y
                .extend(nodes.integrals(&rise).into_iter().map(|step| y + step));
            x += nodes.whole(rates.iter().map(|rate| rate.0));
            (y, theta) = (
                swum.y.last().copied().unwrap_or(y),
                turned.last().copied().unwrap_or(theta),
            );
            swum.theta.extend(turned);
        }
        swum.displacement = 4.0 * x;
        swum.final_y = y;
        swum
    }

    /// Height at node `index`, counted over all arcs, for the shape there: what a push of the curve to its right, a radian
    /// for a radian of its length, adds to a quarter's x. With the body momentum μ = (cos θ, −sin θ, y − y_f) and the
    /// curvature of the connection F it is μ · F.
    pub(super) fn height(&self, member: &Member, index: usize, phi: &Vector2<f64>) -> f64 {
        let Member { model, gain } = member;
        let (theta, y) = self.pose(index);
        height(model, &(phi * *gain), theta, y - self.final_y) * gain.powi(2)
    }

    /// How the height changes along `direction`, the swimmer carried there too.
    pub(super) fn height_slope(
        &self,
        Member { model, gain }: &Member,
        index: usize,
        phi: &Vector2<f64>,
        direction: &Vector2<f64>,
    ) -> f64 {
        const STEP: f64 = 1e-5;
        let (theta, y) = self.pose(index);
        let (phi, direction) = (&(phi * *gain), &(direction * *gain));
        let twist = model.local_connection(phi) * direction;
        let rise = theta.sin() * twist.x + theta.cos() * twist.y;
        let at = |step: f64| {
            height(
                model,
                &(phi + direction * step),
                theta + twist.z * step,
                y + rise * step - self.final_y,
            )
        };
        (at(STEP) - at(-STEP)) / (2.0 * STEP) * gain.powi(2)
    }

    fn pose(&self, index: usize) -> (f64, f64) {
        (
            self.theta.get(index).copied().unwrap_or(f64::NAN),
            self.y.get(index).copied().unwrap_or(f64::NAN),
        )
    }
}

fn height(model: &Model<f64>, phi: &Vector2<f64>, theta: f64, above_end: f64) -> f64 {
    let f = model.first_derivatives(phi).curvature();
    let (sin, cos) = theta.sin_cos();
    cos * f.x - sin * f.y + above_end * f.z
}
