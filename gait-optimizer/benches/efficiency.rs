//! How long a Lighthill gait takes, from swimmer to certificate, with no guess.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{Branch, EfficiencyProblem, efficiency};
use swimmer_model::Swimmer;

fn gaits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("efficiency");
    for (name, swimmer) in [("purcell", Swimmer::purcell()), ("robot", Swimmer::robot())] {
        for branch in [Branch::Small, Branch::Large] {
            let problem = EfficiencyProblem::new(swimmer, branch);
            group.bench_function(format!("{name}, {branch}"), |bench| {
                bench.iter(|| efficiency(&problem));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, gaits);
criterion_main!(benches);
