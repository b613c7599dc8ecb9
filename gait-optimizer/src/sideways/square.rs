//! Loops of most displacement, started where the heading is square to it or, where none is, as near to it as it gets.

use swimmer_files::GaitFile;
use swimmer_model::{Gait, Model, Tolerance, trajectory};

use super::SidewaysProblem;
use crate::cycle::Cycle;
use crate::numerics::halved;
use crate::optimal_gait::OptimalGait;
use crate::simple_shapes::top;

/// Instants that headings are looked at.
const LOOKS: usize = 720;

/// The gait from the start with most of its displacement across the heading.
pub(super) fn turned(
    problem: &SidewaysProblem,
    model: &Model<f64>,
    gait: &OptimalGait,
) -> Option<OptimalGait> {
    let any = gait.gait().ok()?;
    let d = (gait.displacement_over_length, gait.lateral_over_length);
    // |d · heading| at every instant: the less, the more of d is across.
    let mut along: Vec<(f64, f64)> = Vec::with_capacity(LOOKS + 1);
    trajectory(model, &any, &Tolerance::new(1e-12), LOOKS, |point| {
        let (sin, cos) = point.pose.theta.sin_cos();
        along.push((point.u, d.0 * cos + d.1 * sin));
    });
    let mut looks = along.array_windows();
    let crossing = looks.find(|[a, b]| a.1 * b.1 <= 0.0);
    let start = if let Some([low, high]) = crossing {
        let [low, high] = halved([low.0, high.0], 60, |u| {
            along_at(model, &any, u, d) * low.1 > 0.0
        });
        f64::midpoint(low, high)
    } else {
        let least = along
            .iter()
            .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let width = 1.0 / LOOKS as f64;
        let less_along = |u: f64| -along_at(model, &any, u.rem_euclid(1.0), d).abs();
        top(&less_along, (least.0 - width, least.0 + width), 1e-13)
    };
    let cycle = begun_at(gait, &any, start.rem_euclid(1.0));
    super::gait((problem, model), cycle)
}

/// d · heading at one instant.
fn along_at(model: &Model<f64>, gait: &impl Gait<f64>, u: f64, d: (f64, f64)) -> f64 {
    let mut found = f64::NAN;
    for panel in swimmer_model::Panels::new(model, gait, &Tolerance::new(1e-12)) {
        if u <= panel.end() {
            let (sin, cos) = panel.pose(u).theta.sin_cos();
            found = d.0 * cos + d.1 * sin;
            break;
        }
    }
    found
}

/// The cycle from another start, which becomes a sample; one that is all but there already is the start.
pub(super) fn begun_at(gait: &OptimalGait, curve: &impl Gait<f64>, start: f64) -> Cycle {
    const CLOSE: f64 = 1e-6;
    let mut file = gait.gait_file("");
    let close = file.u.iter().position(|u| (u - start).abs() < CLOSE);
    let at = close.unwrap_or_else(|| file.u.partition_point(|&u| u < start));
    if close.is_none() {
        file.u.insert(at, start);
        file.phi.insert(at, curve.at(start).phi);
    }
    let GaitFile {
        u,
        phi,
        corners,
        arcs,
        ..
    } = file.begun_at(at);
    Cycle {
        u,
        phi,
        corners,
        arcs,
    }
}
