//! Closed polygons to start from: circles first, then random curves of any centre, aspect, order and symmetry.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::region::Region;

/// Corners of a start.
const CORNERS: usize = 12;
/// Centres and radii of the first circles, over the largest angle. A swimmer's mirror image swims as far, so one of two opposite
/// centres is enough.
const CIRCLES: [([f64; 2], f64); 12] = [
    ([0.62, -0.62], 0.33),
    ([0.0, 0.0], 0.6),
    ([0.0, 0.0], 0.95),
    ([0.62, 0.62], 0.33),
    ([0.55, 0.0], 0.4),
    ([0.0, 0.55], 0.4),
    ([0.0, 0.0], 0.35),
    ([0.4, -0.4], 0.55),
    ([0.4, 0.4], 0.55),
    ([0.5, -0.5], 0.2),
    ([0.3, 0.6], 0.3),
    ([0.6, -0.3], 0.3),
];
/// A map of shapes.
pub(super) type Image = fn(&Vector2<f64>) -> Vector2<f64>;

/// The mirror images of a body: along it, across it, and both. The last two are of the same swimmer where its side links are alike.
pub(super) const IMAGES: [Image; 3] = [
    |phi| -phi,
    |phi| Vector2::new(phi.y, phi.x),
    |phi| Vector2::new(-phi.y, -phi.x),
];

/// The largest angle looked at where nothing bounds it.
const REACH: f64 = 3.5;

/// The start of this number. Each random one has its own stream of the generator, so none depends on another.
pub(crate) fn start(region: &Region, seed: u64, index: usize) -> Vec<Vector2<f64>> {
    let reach = region
        .edges()
        .iter()
        .map(|edge| edge.offset)
        .fold(REACH, f64::min);
    let curve: Box<dyn Fn(f64) -> Vector2<f64>> = match CIRCLES.get(index) {
        Some((centre, radius)) => {
            let (centre, radius) = (Vector2::from(*centre) * reach, radius * reach);
            Box::new(move |s: f64| centre + Vector2::new(s.cos(), s.sin()) * radius)
        }
        None => random(reach, seed, index),
    };
    let points: Vec<Vector2<f64>> = (0..CORNERS)
        .map(|k| curve(TAU * (k as f64 + 0.25) / CORNERS as f64))
        .collect();
    within(region, points)
}

/// A Fourier series of order 1 to 3.
fn random(reach: f64, seed: u64, index: usize) -> Box<dyn Fn(f64) -> Vector2<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index as u64);
    let order = rng.random_range(1..=3_usize);
    let size = reach * rng.random_range(0.15..0.95_f64);
    let free = reach - 0.8 * size;
    // A third of them are symmetric about the origin: odd orders alone.
    let odd = index.is_multiple_of(3);
    let mut draw = |largest: f64| rng.random_range(-largest..=largest);
    let centre = if odd {
        Vector2::zeros()
    } else {
        Vector2::new(draw(free), draw(free))
    };
    let mut waves = Vec::new();
    for k in 1..=order {
        let part = size / (k * k) as f64;
        if odd && k == 2 {
            continue;
        }
        let mut wave = [Vector2::zeros(); 2];
        for half in &mut wave {
            *half = Vector2::new(draw(part), draw(part));
        }
        if k == 1 {
            // Neither a line nor tiny.
            let (turn, aspect) = (draw(TAU), 0.6 + draw(0.4));
            let (sin, cos) = turn.sin_cos();
            wave = [
                Vector2::new(cos, sin) * size,
                Vector2::new(-sin, cos) * (size * aspect),
            ];
        }
        waves.push((k as f64, wave));
    }
    Box::new(move |s: f64| {
        waves.iter().fold(centre, |sum, (k, [cos, sin])| {
            sum + cos * (k * s).cos() + sin * (k * s).sin()
        })
    })
}

/// Each corner drawn towards the straight shape until it lies well within the bounds.
pub(crate) fn within(region: &Region, mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    /// Over the scale of the shapes.
    const MARGIN: f64 = 0.02;
    let margin = MARGIN * region.scale();
    for point in &mut points {
        for _ in 0..200 {
            if region.overstepped(point) < -margin {
                break;
            }
            *point *= 0.97;
        }
    }
    points
}
