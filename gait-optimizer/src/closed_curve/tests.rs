use nalgebra::{DMatrix, Vector2};
use swimmer_model::{Fourier, Harmonic, Model, Swimmer, Tolerance, swim};

use super::{Basis, Functional, Values, Weights};

/// Curve of order 3 without any symmetry.
fn lopsided() -> (DMatrix<f64>, Fourier<f64, [Harmonic<f64>; 3]>) {
    let mean = Vector2::new(0.2, -0.1);
    let harmonic = |a, b, c, d| Harmonic {
        cos: Vector2::new(a, b),
        sin: Vector2::new(c, d),
    };
    let harmonics = [
        harmonic(1.2, 0.9, -0.8, 1.1),
        harmonic(0.2, -0.15, 0.1, 0.05),
        harmonic(-0.05, 0.1, 0.08, 0.12),
    ];
    let mut columns = vec![mean];
    columns.extend(harmonics.iter().flat_map(|h| [h.cos, h.sin]));
    (
        DMatrix::from_fn(2, 7, |row, column| columns[column][row]),
        Fourier { mean, harmonics },
    )
}

fn listed(values: &Values) -> [f64; 4] {
    let d = values.displacement;
    [d.x, d.y, values.rotation, values.energy]
}

#[test]
fn values_are_those_of_the_swum_cycle() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        let model = Model::new(&swimmer).unwrap();
        let (coefficients, gait) = lopsided();
        let stroke = swim(&model, &gait, &Tolerance::default());
        let length = swimmer.total_length();
        let mut worst = Vec::new();
        for panels in [8, 16, 32, 64] {
            let basis = Basis::fourier(3, panels);
            let functional = Functional::new(&model, &basis);
            let mut work = functional.workspace();
            let values = functional.values(&coefficients, &mut work);
            assert_eq!(values, functional.gradients(&coefficients, &mut work));
            let off = [
                (values.displacement - stroke.displacement).norm() / length,
                (values.rotation - stroke.rotation).abs(),
                (values.energy / stroke.energy - 1.0).abs(),
                (values.power_length / stroke.power_length - 1.0).abs(),
            ];
            worst.push(off.into_iter().fold(0.0, f64::max));
        }
        // Faster than order 6 once the harmonics of the curve are resolved.
        assert!(worst[1] < 1e-4 && worst[3] < 1e-8, "{worst:?}");
        assert!(worst[2] / worst[3] > 40.0, "{worst:?}");
    }
}

#[test]
fn gradients_and_hessian_are_the_differences() {
    let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
    let (coefficients, _) = lopsided();
    for basis in [Basis::fourier(3, 16), Basis::quarter(3, 9)] {
        let functional = Functional::new(&model, &basis);
        let mut work = functional.workspace();
        let unknowns = functional.unknowns();
        let start = coefficients.columns(0, basis.functions()).into_owned();
        let weights = Weights {
            momentum: Vector2::new(0.7, -1.3),
            rotation: 0.4,
            energy: 0.9,
        };
        let weigh = |g: &DMatrix<f64>, i: usize| {
            0.7 * g[(i, 0)] - 1.3 * g[(i, 1)] + 0.4 * g[(i, 2)] + 0.9 * g[(i, 3)]
        };
        functional.gradients(&start, &mut work);
        functional.hessian(&weights, &[], &mut work);
        let (gradients, hessian) = (work.gradients.clone(), work.hessian.clone());
        let h = 1e-5;
        for i in 0..unknowns {
            let mut moved = |step: f64| {
                let mut there = start.clone();
                there[i] += step;
                let values = functional.gradients(&there, &mut work);
                (listed(&values), work.gradients.clone())
            };
            let ((up, slope_up), (down, slope_down)) = (moved(h), moved(-h));
            for quantity in 0..4 {
                let numeric = (up[quantity] - down[quantity]) / (2.0 * h);
                let exact = gradients[(i, quantity)];
                assert!(
                    (numeric - exact).abs() < 1e-8 * (1.0 + exact.abs()),
                    "{i} {quantity}: {numeric} {exact}"
                );
            }
            for j in 0..unknowns {
                let numeric = (weigh(&slope_up, j) - weigh(&slope_down, j)) / (2.0 * h);
                let exact = hessian[(j, i)];
                assert!(
                    (numeric - exact).abs() < 1e-7 * (1.0 + exact.abs()),
                    "{i} {j}: {numeric} {exact}"
                );
            }
        }
    }
}
