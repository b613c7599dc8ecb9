//! Duration of the search for the fastest gait, from swimmer to certificate, on one thread.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{Bounds, SpeedProblem, fastest};
use swimmer_model::Swimmer;

fn gaits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("speed");
    group.sample_size(10);
    for (name, swimmer) in [("robot", Swimmer::robot()), ("purcell", Swimmer::purcell())] {
        for starts in [SpeedProblem::GUESSES, SpeedProblem::STARTS] {
            let problem = SpeedProblem {
                bounds: Bounds::within(2.8),
                starts,
                ..SpeedProblem::new(swimmer, [1.0; 2])
            };
            group.bench_function(format!("{name}, 2.8 rad, {starts} starts"), |bench| {
                bench.iter(|| fastest(&problem));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, gaits);
criterion_main!(benches);
