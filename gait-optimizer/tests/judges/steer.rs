//! Gaits to steer by against polygons that a climb of this test's own finds: it shares the local connection with the search, and nothing
//! else.

use gait_optimizer::{Bounds, SpeedProblem, SteerProblem, Steering, steer};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::{Model, Swimmer};

use crate::plane::Pose;
use crate::swimmers::apart::Apart;

/// Bounds, rates and clearance within which the robot plays.
const MAX_ANGLE: f64 = 2.8;
const MAX_RATE: f64 = 3.5;
const CLEARANCE: f64 = 2.52e-3;

fn found(shape: Option<[f64; 2]>) -> Steering {
    let of = SpeedProblem {
        bounds: Bounds::within(MAX_ANGLE).apart(CLEARANCE),
        threads: 2,
        ..SpeedProblem::new(Swimmer::robot(), [MAX_RATE; 2])
    };
    steer(&SteerProblem { of, shape }, &|_| ()).unwrap()
}

/// Closed polygons whose first corner stays.
struct Climb {
    model: Model<f64>,
    apart: Apart,
}

impl Climb {
    fn new() -> Self {
        let swimmer = Swimmer::robot();
        Self {
            model: Model::new(&swimmer).unwrap(),
            apart: Apart::new(swimmer.links, CLEARANCE),
        }
    }

    fn sides(corners: &[Vector2<f64>]) -> impl Iterator<Item = [Vector2<f64>; 2]> {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(from, to)| [*from, *to])
    }

    /// |Δθ| per second at full rate; 0 if a side leaves the bounds.
    fn rate(&self, corners: &[Vector2<f64>]) -> f64 {
        const LOOKS: u32 = 40;
        let allowed = Self::sides(corners).all(|[from, to]| {
            (0..LOOKS).all(|k| {
                let phi = from + (to - from) * (f64::from(k) / f64::from(LOOKS));
                phi.amax() <= MAX_ANGLE && self.apart.allows(&phi)
            })
        });
        if !allowed {
            return 0.0;
        }
        let time: f64 = Self::sides(corners)
            .map(|[from, to]| (to - from).amax() / MAX_RATE)
            .sum();
        let turned: f64 = Self::sides(corners)
            .map(|side| Pose::along(&self.model, side).theta)
            .sum();
        turned.abs() / time
    }

    /// Moves corners at random, all but the first, as long as the polygon turns faster.
    fn climbed(&self, shape: Vector2<f64>, seed: u64) -> (f64, Vec<Vector2<f64>>) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut best = (0.0, Vec::new());
        // A loop of some size on either side of the shape.
        while best.0 == 0.0 {
            let centre =
                shape + Vector2::new(rng.random_range(-1.5..1.5), rng.random_range(-1.5..1.5));
            let arm = shape - centre;
            let corners: Vec<_> = (0..8)
                .map(|k| {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 8.0).sin_cos();
                    centre + Vector2::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y)
                })
                .collect();
            best = (self.rate(&corners), corners);
        }
        let mut size = 0.5;
        for _ in 0..60 {
            let mut any = false;
            for _ in 0..60 {
                let mut corners = best.1.clone();
                let moved = 1 + rng.random_range(0..corners.len() - 1);
                corners[moved] +=
                    Vector2::new(rng.random_range(-size..size), rng.random_range(-size..size));
                let rate = self.rate(&corners);
                if rate > best.0 {
                    best = (rate, corners);
                    any = true;
                }
            }
            if !any {
                size *= 0.6;
            }
        }
        best
    }
}

/// The fastest polygon of several climbs, and the search.
#[track_caller]
fn turns_as_fast_as_polygons(steering: &Steering) -> f64 {
    let climb = Climb::new();
    let climbs = (0..6).map(|seed| climb.climbed(steering.shape.into(), seed));
    let (rate, corners) = climbs.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let turn = steering.turn.rate;
    println!(
        "{:?}: polygon {rate:.6}, search {turn:.6} rad/s, {corners:?}",
        steering.shape
    );
    assert!(rate < turn * (1.0 + 1e-6), "{rate} {turn}");
    rate
}

/// The turn uses the shapes beyond the square within which side links cannot meet.
#[test]
fn no_polygon_turns_faster_through_a_shape() {
    let polygon = turns_as_fast_as_polygons(&found(Some([0.94, -1.78])));
    // The climb itself is no weak one.
    assert!(polygon > 0.0702, "{polygon}");
}

#[test]
fn no_polygon_turns_faster_through_the_chosen_shape() {
    let steering = found(None);
    for joined in [&steering.forward, &steering.left, &steering.turn] {
        let certificate = &joined.gait.certificate;
        assert!(certificate.pass(), "{}", certificate.failures());
    }
    turns_as_fast_as_polygons(&steering);
}
