//! Time to a certified displacement gait.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{DisplacementProblem, Heading, displacement};
use swimmer_model::Swimmer;

fn gaits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("displacement");
    let purcell = DisplacementProblem::new(Swimmer::purcell()).heading(Heading::Forwards);
    group.bench_function("purcell, no bound (a)", |bench| {
        bench.iter(|| displacement(&purcell));
    });
    let farthest = DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8);
    let robot = farthest.heading(Heading::Forwards);
    group.bench_function("robot, 2.8 rad (b)", |bench| {
        bench.iter(|| displacement(&robot));
    });
    group.bench_function("robot, 2.8 rad, either sense", |bench| {
        bench.iter(|| displacement(&farthest));
    });
    group.finish();
}

criterion_group!(benches, gaits);
criterion_main!(benches);
