//! Swimmers and bounds of all kinds, for every objective: sampled with a seed, with simple gaits for comparison.

pub(crate) mod apart;

pub(crate) use apart::Apart;
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, Bounds};
use swimmer_model::{Gait, Links, Model, Swimmer, TangentialDrag, Tolerance, swim};

/// A swimmer within bounds.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) swimmer: Swimmer<f64>,
    pub(crate) bounds: Bounds,
}

/// Link ratio l₀/l₁ 0.3–3, χ 1.3–5, sphere 0–1.2 l₀ (one in three without), all forms of `c_t`, bounds 1.8–3.0 rad, every second
/// one without crossing links, half of those with a clearance up to l₀/10.
pub(crate) fn random(seed: u64, count: usize) -> Vec<Case> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|i| {
            let ratio: f64 = rng.random_range(0.3_f64.ln()..3.0_f64.ln()).exp();
            let side = 1.0;
            let middle = ratio * side;
            let sphere = if rng.random_bool(1.0 / 3.0) {
                0.0
            } else {
                rng.random_range(0.0..1.2)
            };
            let tangential_drag = match rng.random_range(0..3) {
                0 => TangentialDrag::LogAspect(rng.random_range(2.5..6.0)),
                1 => {
                    TangentialDrag::HalfThickness(rng.random_range(0.005..0.05) * middle.min(side))
                }
                _ => TangentialDrag::OverViscosity(rng.random_range(1.0..2.5)),
            };
            let no_overlap = i % 2 == 1;
            let clearance = if no_overlap && rng.random_bool(0.5) {
                rng.random_range(0.0..0.1) * middle
            } else {
                0.0
            };
            let swimmer = Swimmer {
                links: Links {
                    middle,
                    front: side,
                    back: side,
                },
                chi: rng.random_range(1.3..5.0),
                tangential_drag,
                sphere_radius: sphere * middle,
                ..Swimmer::purcell()
            };
            let bounds = Bounds {
                max_angle: Some(rng.random_range(1.8..3.0)),
                no_overlap,
                clearance,
                ..Bounds::default()
            };
            Case {
                name: format!("{i}: {swimmer:?}, {bounds}"),
                swimmer,
                bounds,
            }
        })
        .collect()
}

/// Circles and squares within the bounds, amplitude by amplitude.
pub(crate) fn simple_gaits(case: &Case) -> Vec<Vec<AnyGait>> {
    let max = case.bounds.max_angle.unwrap_or(std::f64::consts::PI);
    let apart = case
        .bounds
        .no_overlap
        .then(|| Apart::new(case.swimmer.links, case.bounds.clearance));
    let allowed = |gait: &AnyGait| {
        apart
            .as_ref()
            .is_none_or(|apart| (0..400).all(|k| apart.allows(&shape(gait, f64::from(k) / 400.0))))
    };
    [AnyGait::circle, AnyGait::square]
        .into_iter()
        .map(|make| {
            (1..=20)
                .map(|step| make(max * f64::from(step) / 20.0))
                .take_while(allowed)
                .collect()
        })
        .collect()
}

fn shape(gait: &AnyGait, u: f64) -> Vector2<f64> {
    gait.at(u).phi
}

/// Largest X over L of circles and squares within the bounds, up to the first maximum over the amplitude; 0 where none goes
/// forwards.
pub(crate) fn best_simple_displacement(case: &Case) -> f64 {
    let model = Model::new(&case.swimmer).unwrap();
    let mut best: f64 = 0.0;
    for family in simple_gaits(case) {
        let mut last = 0.0;
        for gait in &family {
            let x = swim(&model, gait, &Tolerance::new(1e-9)).displacement.x
                / case.swimmer.total_length();
            if x < last {
                break;
            }
            last = x;
            best = best.max(x);
        }
    }
    best
}
