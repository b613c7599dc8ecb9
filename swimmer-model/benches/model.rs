//! Cost of a shape and of a cycle: connection and power, their derivatives, one stroke at 1e-10.

use criterion::Criterion;
use nalgebra::Vector2;
use std::hint::black_box;
use std::time::Duration;
use swimmer_model::reference::{BEST_CIRCLE, BEST_SQUARE, SHAPES};
use swimmer_model::{Circle, Model, Scalar, Square, Swimmer, Tolerance, swim};

fn shapes<T: Scalar>() -> [Vector2<T>; 4] {
    SHAPES.map(|case| Vector2::from(case.phi.map(T::from_f64)))
}

fn bench<T: Scalar>(criterion: &mut Criterion, name: &str) {
    let model = Model::<T>::new(&Swimmer::purcell()).expect("Purcell's swimmer is valid");
    let mut group = criterion.benchmark_group(name);
    group
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    let mut turn = shapes::<T>().into_iter().cycle();
    let mut next = move || turn.next().unwrap_or_else(Vector2::zeros);
    group.bench_function("connection and power", |b| {
        b.iter(|| model.connection_and_power(black_box(&next())));
    });
    group.bench_function("with first derivatives", |b| {
        b.iter(|| model.first_derivatives(black_box(&next())));
    });
    group.bench_function("with second derivatives", |b| {
        b.iter(|| model.second_derivatives(black_box(&next())));
    });
    let tolerance = Tolerance::new(1e-10);
    let circle = Circle {
        amplitude: T::from_f64(BEST_CIRCLE.amplitude),
    };
    let square = Square {
        amplitude: T::from_f64(BEST_SQUARE.amplitude),
    };
    group.bench_function("stroke of the best circle", |b| {
        b.iter(|| swim(black_box(&model), black_box(&circle), &tolerance));
    });
    group.bench_function("stroke of the best square", |b| {
        b.iter(|| swim(black_box(&model), black_box(&square), &tolerance));
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    bench::<f64>(&mut criterion, "f64");
    bench::<f32>(&mut criterion, "f32");
    criterion.final_summary();
}
