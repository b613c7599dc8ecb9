//! How long direct collocation takes: one solve on a fixed mesh, its own re-integration included, and with refinement.

use collocation::{CollocationProblem, QuarterGuess, solve};
use criterion::{Criterion, criterion_group, criterion_main};
use swimmer_model::{Model, Swimmer};

/// The optimal gaits of third order, rounded: what a Fourier search hands on.
const PURCELL_SMALL: [[f64; 2]; 3] = [[1.4166, 1.3243], [0.05, 0.1409], [0.0102, 0.0049]];

fn solves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("collocation");
    let (Ok(purcell), Ok(robot)) = (
        Model::new(&Swimmer::purcell()),
        Model::new(&Swimmer::robot()),
    ) else {
        return;
    };
    let cases = [
        (
            "purcell small",
            &purcell,
            1.0,
            QuarterGuess::fourier(&PURCELL_SMALL),
        ),
        (
            "purcell large, circle",
            &purcell,
            -1.0,
            QuarterGuess::circle(3.3),
        ),
        (
            "robot small, circle",
            &robot,
            1.0,
            QuarterGuess::circle(1.3),
        ),
        (
            "robot large, circle",
            &robot,
            -1.0,
            QuarterGuess::circle(3.3),
        ),
    ];
    for (name, model, sign, guess) in cases {
        let Ok(guess) = guess else { continue };
        for (elements, degree) in [(20, 5), (40, 6)] {
            let mut problem = CollocationProblem::new(model, sign);
            (problem.elements, problem.degree, problem.tolerance) = (elements, degree, 0.0);
            group.bench_function(format!("{name}, {elements}x{degree}"), |bench| {
                bench.iter(|| solve(&problem, &guess));
            });
        }
        let refined = CollocationProblem::new(model, sign);
        group.bench_function(format!("{name}, refined to 1e-8"), |bench| {
            bench.iter(|| solve(&refined, &guess));
        });
    }
    let bounded = CollocationProblem::new(&robot, 1.0).with_max_angle(1.6);
    if let Ok(guess) = QuarterGuess::circle(1.3) {
        group.bench_function("robot small within 1.6 rad, refined to 1e-8", |bench| {
            bench.iter(|| solve(&bounded, &guess));
        });
    }
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
