//! Duration of the search for a Lighthill gait, from swimmer to certificate, without a guess, free or continued to a bound.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{Bounds, Branch, EfficiencyProblem, efficiency};
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
    let bounded = EfficiencyProblem {
        bounds: Bounds::within(1.6),
        ..EfficiencyProblem::new(Swimmer::robot(), Branch::Small)
    };
    group.bench_function("robot, small, 1.6 rad", |bench| {
        bench.iter(|| efficiency(&bounded));
    });
    group.finish();
}

criterion_group!(benches, gaits);
criterion_main!(benches);
