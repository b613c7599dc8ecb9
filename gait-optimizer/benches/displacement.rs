//! How long a displacement gait takes, from swimmer to certificate.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{DisplacementProblem, displacement};
use swimmer_model::Swimmer;

fn gaits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("displacement");
    let purcell = DisplacementProblem::new(Swimmer::purcell());
    group.bench_function("purcell, no bound (a)", |bench| {
        bench.iter(|| displacement(&purcell));
    });
    let robot = DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8);
    group.bench_function("robot, 2.8 rad (b)", |bench| {
        bench.iter(|| displacement(&robot));
    });
    // The paper's kind alone, without the scans for gaits that touch their own images.
    let simple = DisplacementProblem {
        simple: true,
        ..robot
    };
    group.bench_function("robot, 2.8 rad (b), simple", |bench| {
        bench.iter(|| displacement(&simple));
    });
    group.finish();
}

criterion_group!(benches, gaits);
criterion_main!(benches);
