use super::*;
use proptest::prelude::*;
use swimmer_files::AnyGait;
use swimmer_model::{Swimmer, SymmetricFourier, Tolerance, swim};

fn robot() -> Model<f64> {
    Model::new(&Swimmer::robot()).unwrap()
}

fn lobed() -> SymmetricFourier<[[f64; 2]; 2]> {
    SymmetricFourier {
        coefficients: [[1.6, 1.1], [0.25, -0.2]],
    }
}

/// The best timing of the curve itself.
fn timing(gait: &impl Gait<f64>, period: f64, max_rate: f64) -> Timing {
    Curve::new(&robot(), gait).unwrap().timing(period, max_rate)
}

/// Fastest joint of a gait played with a period, by dense looks.
fn fastest(gait: &AnyGait, period: f64) -> f64 {
    (0..20_000)
        .map(|i| gait.at((f64::from(i) + 0.5) / 20_000.0).rate.amax() / period)
        .fold(0.0, f64::max)
}

/// A smooth gait as timed, from as many samples as there are cells.
fn retimed(timing: &Timing, gait: &impl Gait<f64>) -> AnyGait {
    let file = timing.retime_file(&GaitFile::sampled(gait, timing.cells.len() - 1));
    AnyGait::from_file(&file).unwrap()
}

/// A rate between the least that meets the period (share 0) and that of constant power (share 1).
fn between(gait: &impl Gait<f64>, free: &Timing, share: f64) -> f64 {
    let least = shortest_period(gait, [1.0; 2]).unwrap() / free.period;
    least + share * (free.rate_at_constant_power - least)
}

#[test]
fn without_a_limit_it_is_constant_power() {
    let (model, gait) = (robot(), lobed());
    let stroke = swim(&model, &gait, &Tolerance::default());
    let timing = timing(&gait, 7.0, f64::INFINITY);
    let least = stroke.power_length * stroke.power_length / 7.0;
    assert!(
        (timing.energy / least - 1.0).abs() < 1e-10,
        "{}",
        timing.energy
    );
    assert!(timing.efficiency_loss < 1e-10 && timing.shortest_period == 0.0);
    let again = swim(&model, &retimed(&timing, &gait), &Tolerance::default());
    assert!((again.efficiency() / stroke.efficiency_constant_power() - 1.0).abs() < 1e-6);
    assert!((again.displacement - stroke.displacement).norm() < 1e-9);
}

#[test]
fn a_circle_in_its_shortest_period() {
    // max(|cos|, |sin|) has the mean 2√2/π over a turn.
    let (rate, amplitude) = (0.8, 1.1);
    let gait = AnyGait::circle(amplitude);
    let shortest = shortest_period(&gait, [rate; 2]).unwrap();
    let exact = amplitude * 4.0 * 2.0_f64.sqrt() / rate;
    assert!((shortest / exact - 1.0).abs() < 1e-6, "{shortest} {exact}");
    let at_limit = timing(&gait, shortest * (1.0 + 1e-12), rate);
    assert!(at_limit.at_limit > 0.999, "{}", at_limit.at_limit);
}

#[test]
fn the_cap_is_kept_and_costs_what_it_says() {
    let (model, gait) = (robot(), lobed());
    let free = timing(&gait, 7.0, f64::INFINITY);
    let rate = between(&gait, &free, 0.7);
    let capped = timing(&gait, 7.0, rate);
    assert!(capped.at_limit > 0.0 && capped.at_limit < 0.5);
    assert!(capped.efficiency_loss > 1e-4);
    let played = retimed(&capped, &gait);
    let within = fastest(&played, 7.0);
    assert!(within < rate * 1.002, "{within} {rate}");
    assert!(
        (fastest(&retimed(&free, &gait), 7.0) / free.rate_at_constant_power - 1.0).abs() < 1e-3
    );
    // By the model's own integration of the retimed samples, which knows nothing of the cap.
    let stroke = swim(&model, &played, &Tolerance::default());
    let loss = 1.0 - stroke.efficiency() / stroke.efficiency_constant_power();
    assert!(
        (loss / capped.efficiency_loss - 1.0).abs() < 1e-3,
        "{loss} {}",
        capped.efficiency_loss
    );
}

/// Another way to the same optimum: the time of each of 400 cells is moved between pairs while the energy falls.
#[test]
fn no_exchange_of_time_saves_energy() {
    let (model, gait) = (robot(), lobed());
    let free = timing(&gait, 7.0, f64::INFINITY);
    let rate = between(&gait, &free, 0.5);
    let best = timing(&gait, 7.0, rate);
    let count = 400;
    let cells: Vec<(f64, f64)> = (0..count)
        .map(|i| {
            let point = gait.at((f64::from(i) + 0.5) / f64::from(count));
            let power = point
                .rate
                .dot(&(model.power_matrix(&point.phi) * point.rate));
            (
                power / f64::from(count * count),
                point.rate.amax() / rate / f64::from(count),
            )
        })
        .collect();
    // Dual ascent: for a price of time λ each cell takes its own best, and λ is bisected for the period.
    let lasts = |price: f64| -> Vec<f64> {
        cells
            .iter()
            .map(|&(work, floor)| (work / price).sqrt().max(floor))
            .collect()
    };
    let (mut low, mut high) = (1e-12_f64, 1e6_f64);
    for _ in 0..200 {
        let middle = (low * high).sqrt();
        if lasts(middle).iter().sum::<f64>() > 7.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let energy: f64 = lasts(high)
        .iter()
        .zip(&cells)
        .map(|(time, (work, _))| work / time)
        .sum();
    assert!(
        (energy / best.energy - 1.0).abs() < 1e-4,
        "{energy} {}",
        best.energy
    );
}

#[test]
fn a_file_is_retimed_shape_by_shape() {
    let model = robot();
    let square = AnyGait::square(1.0);
    let u: Vec<f64> = (0..=64).map(|i| f64::from(i) / 64.0).collect();
    let mut phi: Vec<_> = u.iter().map(|&u| square.at(u).phi).collect();
    phi[64] = phi[0];
    let file = GaitFile {
        corners: vec![0.0, 0.25, 0.5, 0.75],
        u,
        phi,
        ..GaitFile::default()
    };
    let gait = AnyGait::from_file(&file).unwrap();
    let shortest = shortest_period(&gait, [1.0; 2]).unwrap();
    assert!((shortest - 8.0).abs() < 1e-12);
    let timing = timing(&gait, 1.1 * shortest, 1.0);
    let retimed = timing.retime_file(&file);
    assert_eq!(retimed.phi, file.phi);
    assert_eq!((retimed.u[0], retimed.u[64]), (0.0, 1.0));
    assert!(retimed.u.windows(2).all(|pair| pair[1] > pair[0]));
    let again = AnyGait::from_file(&retimed).unwrap();
    let mut corners = retimed.corners.iter();
    assert!(corners.all(|corner| retimed.u.contains(corner)));
    assert_eq!((0..64).filter(|&i| again.corner_at_end(i)).count(), 4);
    assert!(fastest(&again, 1.1 * shortest) < 1.003);
    let energy = |gait: &AnyGait| swim(&model, gait, &Tolerance::default()).energy;
    assert!(
        energy(&again) < energy(&gait),
        "the uniform timing is not the best"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A tighter cap never saves energy, and the period is met.
    #[test]
    fn a_tighter_cap_costs_more(a in 0.4_f64..2.0, b in 0.4_f64..2.0, c in -0.2_f64..0.2, slack in 1.001_f64..1.6) {
        let gait = SymmetricFourier { coefficients: [[a, b], [c, -c]] };
        let shortest = shortest_period(&gait, [1.0; 2]).unwrap();
        let tight = timing(&gait, slack * shortest, 1.0);
        let loose = timing(&gait, slack * shortest, 1.2);
        prop_assert!(tight.energy >= loose.energy * (1.0 - 1e-12));
        prop_assert!((tight.fraction_at(1.0) - 1.0).abs() < 1e-12);
        prop_assert!((0..200).all(|i| tight.fraction_at(f64::from(i) / 200.0) <= tight.fraction_at(f64::from(i + 1) / 200.0)));
    }
}
