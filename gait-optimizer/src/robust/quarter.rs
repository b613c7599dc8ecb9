//! A quarter gait swum by one member of the ensemble, with the height of its displacement along the way.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::nodes::Nodes;
use crate::member::Member;
use crate::momentum::{Height, Momentum};

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
            let turning: Vec<f64> = body.iter().map(|twist| twist.z).collect();
            let turned = nodes.integrals(&turning).into_iter();
            let turned: Vec<f64> = turned.map(|turn| theta + turn).collect();
            let rates = body.iter().zip(&turned);
            let rates = rates.map(|(twist, theta)| Rotation2::new(*theta) * twist.xy());
            let (along, across): (Vec<f64>, Vec<f64>) = rates.map(|rate| (rate.x, rate.y)).unzip();
            x += nodes.integrals(&along).last().copied().unwrap_or(0.0);
            let rise = nodes.integrals(&across).into_iter();
            swum.y.extend(rise.map(|step| y + step));
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

    /// Height at node `index`, counted over all arcs, for the shape there, and its gradient with the swimmer carried along: what
    /// a push of the curve to its right, a radian for a radian of its length, adds to a quarter's x.
    pub(super) fn height(&self, member: &Member, index: usize, phi: &Vector2<f64>) -> Height {
        let Member { model, gain } = member;
        let momentum = Momentum::of_quarter(1.0, self.final_y);
        let at = |values: &[f64]| values.get(index).copied().unwrap_or(f64::NAN);
        let pose = [0.0, at(&self.y), at(&self.theta)];
        let Height { value, gradient } = momentum.evaluate(model, &(phi * *gain), &pose).0;
        Height {
            value: value * gain.powi(2),
            gradient: gradient * gain.powi(3),
        }
    }
}
