//! Integration of a quarter gait for one member of the ensemble, with the height along it.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::nodes::Nodes;
use crate::member::Member;
use crate::momentum::{Height, Momentum};

/// Smooth arc: shapes and their derivatives at the nodes.
#[derive(Debug, Clone)]
pub(super) struct ArcCurve {
    pub(super) phi: Vec<Vector2<f64>>,
    pub(super) slope: Vec<Vector2<f64>>,
}

/// Trajectory of a swimmer along a quarter gait. Lengths are over L.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    /// X of the full cycle, four times that of the quarter.
    pub(super) displacement: f64,
    /// y and heading at the nodes, arc by arc.
    places: Vec<[f64; 2]>,
}

impl Trajectory {
    pub(super) fn new(member: &Member, nodes: &Nodes, arcs: &[ArcCurve]) -> Self {
        let Member { model, gain, .. } = member;
        let mut x = 0.0;
        let mut places: Vec<[f64; 2]> = Vec::new();
        for arc in arcs {
            let [y, theta] = places.last().copied().unwrap_or_default();
            let moving = arc.phi.iter().zip(&arc.slope);
            let body: Vec<Vector3<f64>> = moving
                .map(|(phi, slope)| model.local_connection(&(phi * *gain)) * slope * *gain)
                .collect();
            let turning: Vec<f64> = body.iter().map(|twist| twist.z).collect();
            let mut turned = nodes.integrals(&turning);
            for turn in &mut turned {
                *turn += theta;
            }
            let rates = body.iter().zip(&turned);
            let rates = rates.map(|(twist, theta)| Rotation2::new(*theta) * twist.xy());
            let (along, across): (Vec<f64>, Vec<f64>) = rates.map(|rate| (rate.x, rate.y)).unzip();
            x += nodes.integrals(&along).last().copied().unwrap_or(0.0);
            let rise = nodes.integrals(&across).into_iter().zip(turned);
            places.extend(rise.map(|(step, theta)| [y + step, theta]));
        }
        Self {
            displacement: 4.0 * x,
            places,
        }
    }

    /// Height at node `index`, counted over all arcs, and its gradient: the change of the quarter's x per unit perturbation of the curve
    /// to its right.
    pub(super) fn height(&self, member: &Member, index: usize, phi: &Vector2<f64>) -> Height {
        let Member { model, gain, .. } = member;
        let place = |place: Option<&[f64; 2]>| place.copied().unwrap_or([f64::NAN; 2]);
        let [final_y, _] = place(self.places.last());
        let momentum = Momentum::of_quarter(1.0, final_y);
        let [y, theta] = place(self.places.get(index));
        let pose = [0.0, y, theta];
        let Height { value, gradient } = momentum.evaluate(model, &(phi * *gain), &pose).0;
        Height {
            value: value * gain.powi(2),
            gradient: gradient * gain.powi(3),
        }
    }
}
