//! Ascent from a saddle of the displacement to curves with a greater displacement.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::Subject;
use super::second_variation::{Ascents, Neighbours};
use super::variation::Gain;
use crate::certificate::turning_number;
use crate::optimal_gait::OptimalGait;

/// Closed curve as shapes with their u from 0 to 1.
pub(crate) type Curve = Vec<(f64, Vector2<f64>)>;

/// Largest displacements of a shape \[rad\].
const PUSHES: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// Perturbs a displacement gait that is a saddle, run counter-clockwise, in both directions of the steepest ascent among closed
/// curves of any symmetry, by increasing amounts. `model` is that of the swimmer with L = 1. Returns an empty list if there is no
/// ascent. The perturbed curves may violate the bounds and may have a net rotation.
pub(crate) fn ways_up(model: &Model<f64>, gait: &OptimalGait) -> Vec<Curve> {
    let mut file = gait.gait_file("");
    if turning_number(&file.phi) < 0.0 {
        file = file.reversed();
    }
    let subject = Subject::new(model, &file, (&gait.bounds, &gait.swimmer.links));
    let Some(momentum) = subject.weak_momentum(Gain::Displacement) else {
        return Vec::new();
    };
    let neighbours = Neighbours {
        subject: &subject,
        gain: Gain::Displacement,
        momentum,
        symmetric: false,
    };
    let ascents = neighbours.ascents();
    let known = |ascents: &&Ascents| ascents.count > 0 && !ascents.steepest.is_empty();
    let ways = ascents.iter().filter(known).flat_map(|ascents| {
        let both = PUSHES.iter().flat_map(|&by| [by, -by]);
        both.map(|by| pushed(&subject, ascents, by))
    });
    ways.collect()
}

fn pushed(subject: &Subject<'_>, ascents: &Ascents, by: f64) -> Curve {
    let shapes = subject.shapes.iter().zip(&ascents.steepest);
    let nodes = subject.grid.nodes.iter().zip(shapes);
    nodes
        .map(|(node, (shape, push))| (node.u, shape + push * by))
        .collect()
}
