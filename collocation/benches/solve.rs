//! Benchmark of direct collocation, re-integration included.

use collocation::{CollocationProblem, solve};
use criterion::{Criterion, criterion_group, criterion_main};
use swimmer_model::{Circle, Model, Swimmer};

fn solves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("collocation");
    let (Ok(purcell), Ok(robot)) = (
        Model::new(&Swimmer::purcell()),
        Model::new(&Swimmer::robot()),
    ) else {
        return;
    };
    for (name, model, sign, amplitude) in [
        ("purcell small, circle", &purcell, 1.0, 1.3),
        ("purcell large, circle", &purcell, -1.0, 3.3),
        ("robot small, circle", &robot, 1.0, 1.3),
        ("robot large, circle", &robot, -1.0, 3.3),
    ] {
        let problem = CollocationProblem::new(model, sign);
        group.bench_function(name, |bench| {
            bench.iter(|| solve(&problem, &Circle { amplitude }));
        });
    }
    let bounded = CollocationProblem::new(&robot, 1.0).with_max_angle(1.6);
    group.bench_function("robot small within 1.6 rad", |bench| {
        bench.iter(|| solve(&bounded, &Circle { amplitude: 1.3 }));
    });
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
