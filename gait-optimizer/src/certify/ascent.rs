//! Gaits of most displacement asked by pushes of any symmetry.
//!
//! A gait with the paper's symmetries may be the best of those, and a saddle among all closed curves: pushed out of its
//! symmetry it gains. A gait file is asked within the class that it belongs to ([`super::certify`]); what lists the local
//! optima of all closed curves must ask for more.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::Subject;
use super::limits::Limits;
use super::second_variation::{Ascents, Gain, Neighbours};
use crate::OptimalGait;
use crate::certificate::{Check, turning_number};

/// Shapes along a closed curve, each with its u from 0 to 1.
pub(crate) type Curve = Vec<(f64, Vector2<f64>)>;

/// What lies round a gait.
pub(crate) struct Around {
    /// The check `ascent_directions`, of pushes of any symmetry.
    pub(crate) check: Check,
    /// The curve, run counter-clockwise, pushed either way along the steepest ascent, farther and farther; empty where no way
    /// leads up. Pushed curves need not obey the bounds, nor be without net rotation.
    pub(crate) up: Vec<Curve>,
}

/// How far the farthest shape is pushed \[rad\].
const PUSHES: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// Asks round a gait of most displacement; `model` is of its swimmer with L = 1. None where no push is free.
pub(crate) fn around(model: &Model<f64>, gait: &OptimalGait) -> Option<Around> {
    let mut file = gait.gait_file("");
    if turning_number(&file.phi) < 0.0 {
        file = file.reversed();
    }
    let limits = Limits::new(&gait.bounds, &gait.swimmer.links);
    let subject = Subject::new(model, &file, limits);
    let ascents = Neighbours {
        subject: &subject,
        gain: Gain::Displacement,
        rotation: subject.weak_momentum(Gain::Displacement)?.c,
        symmetric: false,
    }
    .ascents()?;
    let check = ascents.check();
    let pushes: &[f64] = if check.pass || ascents.steepest.is_empty() {
        &[]
    } else {
        &PUSHES
    };
    let both = pushes.iter().flat_map(|&by| [by, -by]);
    Some(Around {
        check,
        up: both.map(|by| pushed(&subject, &ascents, by)).collect(),
    })
}

fn pushed(subject: &Subject<'_>, ascents: &Ascents, by: f64) -> Curve {
    let shapes = subject.shapes.iter().zip(&ascents.steepest);
    let nodes = subject.grid.nodes.iter().zip(shapes);
    nodes
        .map(|(node, (shape, push))| (node.u, shape + push * by))
        .collect()
}
