//! How long it takes to polish a rough curve to a certified extremal of the efficiency, and to follow a gait to a bound.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{Bounds, Branch, EfficiencyProblem, Polish, efficiency, polish_efficiency};
use swimmer_model::{Swimmer, SymmetricFourier};

fn polishes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("extremal");
    let gait = SymmetricFourier {
        coefficients: [[1.68, 1.42], [0.216, 0.557], [0.02, 0.095]],
    };
    let closed = Polish::new(Swimmer::robot());
    let quarter = Polish {
        symmetric: true,
        ..closed
    };
    group.bench_function("robot, small: quarter", |bench| {
        bench.iter(|| polish_efficiency(&quarter, &gait));
    });
    group.bench_function("robot, small: closed curve", |bench| {
        bench.iter(|| polish_efficiency(&closed, &gait));
    });
    let bounded = EfficiencyProblem {
        bounds: Bounds {
            max_angle: Some(1.6),
            ..Bounds::default()
        },
        ..EfficiencyProblem::new(Swimmer::robot(), Branch::Small)
    };
    group.sample_size(20);
    group.bench_function("robot, small, 1.6 rad, without a guess", |bench| {
        bench.iter(|| efficiency(&bounded));
    });
    group.finish();
}

criterion_group!(benches, polishes);
criterion_main!(benches);
