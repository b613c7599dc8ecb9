//! Initial guesses for the closed loop near a coarse displacement optimum: the point at which the loop is opened, and the momentum.

use nalgebra::{DMatrix, Vector2};
use swimmer_model::Model;

use crate::closed_curve::{Functional, column};
use crate::loops::{Guess, Section};
use crate::region::Region;

/// Distance from a bound below which a coarse node is on it \[rad\].
const ON_BOUND: f64 = 0.06;
/// Number of points at which a loop without a bound arc is opened.
const FREE_GATES: usize = 3;

/// Returns guesses for a coarse curve that runs counter-clockwise, the most promising first.
pub(crate) fn guesses(
    functional: &Functional<'_>,
    model: &Model<f64>,
    region: &Region,
    coarse: &DMatrix<f64>,
) -> Vec<Guess> {
    let mut work = functional.workspace();
    let values = functional.values(coarse, &mut work);
    let nodes = functional.basis.nodes();
    let shape = |node: usize| column(&work.phi, node % nodes);
    let length: f64 = (0..nodes)
        .map(|node| (shape(node + 1) - shape(node)).norm())
        .sum();
    let direction = values.displacement.y.atan2(values.displacement.x);
    let angle = |node: usize| {
        let heading = work.heading.get(node % nodes).copied().unwrap_or(0.0);
        direction - heading
    };
    let near = |node: usize| {
        let phi = shape(node);
        region
            .bounds()
            .enumerate()
            .map(|(index, bound)| {
                let slope = bound.gradient(&phi).norm().max(1e-9);
                (index, bound.margin(&phi) / slope)
            })
            .filter(|(_, margin)| *margin < ON_BOUND)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(index, _)| index)
    };
    let mut found = Vec::new();
    for node in 0..nodes {
        let (Some(index), None) = (near(node), near(node + 1)) else {
            continue;
        };
        let Some(bound) = region.bound(index) else {
            continue;
        };
        let at = bound.onto(&shape(node));
        found.push(Guess {
            section: Section {
                at,
                along: bound.tangent(&at),
                bound: Some(index),
            },
            angle: angle(node),
            length,
        });
    }
    if found.is_empty() {
        // c is most accurate where the row of the rotation is large.
        let mut order: Vec<(f64, usize)> = (0..nodes)
            .map(|node| {
                let f = model.first_derivatives(&shape(node)).curvature();
                (f.z.abs() / f.xy().norm().max(1e-12), node)
            })
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, node) in order
            .into_iter()
            .step_by(nodes.div_ceil(12))
            .take(FREE_GATES)
        {
            let ahead = shape(node + 1) - shape(node + nodes - 1);
            let ahead = ahead / ahead.norm();
            found.push(Guess {
                section: Section {
                    at: shape(node),
                    along: Vector2::new(-ahead.y, ahead.x),
                    bound: None,
                },
                angle: angle(node),
                length,
            });
        }
    }
    found
}
