//! A and W at 10 000 shapes a call; what is told is the time of one shape.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;
use gait_optimizer::{Batch, ConnectionsAndPowers};
use swimmer_model::Swimmer;

const SHAPES: u32 = 10_000;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let batch = Batch::new(&Swimmer::purcell()).expect("Purcell's swimmer is valid");
    let angles = |turn: f64| -> Vec<f64> {
        (0..SHAPES)
            .map(|shape| 2.8 * (turn * f64::from(shape)).sin())
            .collect()
    };
    let (phi1, phi2) = (angles(0.37), angles(0.73));
    let mut found = ConnectionsAndPowers::default();
    let mut group = criterion.benchmark_group("batch");
    group.measurement_time(Duration::from_secs(1));
    group.bench_function("connection and power, a shape", |b| {
        b.iter_custom(|shapes| {
            let calls = shapes.div_ceil(u64::from(SHAPES));
            let began = Instant::now();
            for _ in 0..calls {
                batch.connections_and_powers(black_box(&phi1), black_box(&phi2), &mut found);
                black_box(&found);
            }
            let share = shapes as f64 / (calls * u64::from(SHAPES)) as f64;
            began.elapsed().mul_f64(share)
        });
    });
    group.finish();
    criterion.final_summary();
}
