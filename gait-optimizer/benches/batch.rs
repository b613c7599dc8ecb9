//! A and W at 10 000 shapes a call, and with their derivatives one by one; the result is the time per shape.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;
use gait_optimizer::{Batch, ConnectionsAndPowers};
use nalgebra::Vector2;
use swimmer_model::{Model, Swimmer};

const SHAPES: u32 = 10_000;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let model = Model::new(&Swimmer::purcell()).expect("Purcell's swimmer is valid");
    let batch = Batch::of(&model);
    let angles = |turn: f64| -> Vec<f64> {
        (0..SHAPES)
            .map(|shape| 2.8 * (turn * f64::from(shape)).sin())
            .collect()
    };
    let (phi1, phi2) = (angles(0.37), angles(0.73));
    let one_by_one = || phi1.iter().zip(&phi2).map(|(a, b)| Vector2::new(*a, *b));
    let mut group = criterion.benchmark_group("batch");
    group
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    let mut bench = |name: &str, call: &mut dyn FnMut()| {
        group.bench_function(name, |b| {
            b.iter_custom(|shapes| {
                let calls = shapes.div_ceil(u64::from(SHAPES));
                let began = Instant::now();
                for _ in 0..calls {
                    call();
                }
                let share = shapes as f64 / (calls * u64::from(SHAPES)) as f64;
                began.elapsed().mul_f64(share)
            });
        });
    };
    let mut found = ConnectionsAndPowers::default();
    bench("connection and power, a shape", &mut || {
        batch.connections_and_powers(black_box(&phi1), black_box(&phi2), &mut found);
        black_box(&found);
    });
    bench("connection and power, one by one", &mut || {
        for phi in one_by_one() {
            black_box(model.connection_and_power(black_box(&phi)));
        }
    });
    bench("with first derivatives, one by one", &mut || {
        for phi in one_by_one() {
            black_box(model.first_derivatives(black_box(&phi)));
        }
    });
    bench("with second derivatives, one by one", &mut || {
        for phi in one_by_one() {
            black_box(model.second_derivatives(black_box(&phi)));
        }
    });
    group.finish();
    criterion.final_summary();
}
