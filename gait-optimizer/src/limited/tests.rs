//! Each limit alone, several together, and what is refused.

use super::*;
use crate::fastest;
use swimmer_model::{Circle, Stroke, Tolerance, swim};

fn asked(power: Option<f64>, rates: Option<[f64; 2]>) -> LimitedProblem {
    LimitedProblem {
        swimmer: Swimmer::robot(),
        bounds: Bounds::within(2.0),
        power_over_viscosity: power,
        rates,
        torque: None,
        threads: 2,
    }
}

fn swum<G: Gait<f64>>(gait: &G) -> Stroke<f64> {
    let model = Model::new(&Swimmer::robot()).unwrap();
    swim(&model, gait, &Tolerance::default())
}

fn told(name: &str, found: &Result<Limited, LimitedError>) {
    match found {
        Ok(found) => println!(
            "{name}: {:.14} {:?} refined {:?} {:?}",
            found.speed_over_length,
            found.limits,
            found.refinement,
            found.gait.certificate.failures()
        ),
        Err(error) => println!("{name}: {error}"),
    }
}

/// By the model's own integration of what is played: the power is used up and constant, and no circle is as fast on it.
#[test]
fn the_power_is_used_up() {
    let found = fastest_within(&asked(Some(2e-3), None), &|_| ()).unwrap();
    assert_eq!(found.limits[0].0, Limit::Power);
    assert!(found.gait.certificate.pass());
    let stroke = swum(&found.gait.gait().unwrap());
    let mean = stroke.energy / found.period.powi(2);
    assert!((mean / 2e-3 - 1.0).abs() < 1e-6, "{mean}");
    assert!((found.peak_power_over_viscosity / 2e-3 - 1.0).abs() < 1e-3);
    let speed = stroke.displacement.norm() / stroke.total_length / found.period;
    assert!(
        (speed / found.speed_over_length - 1.0).abs() < 1e-7,
        "{speed}"
    );
    for tenths in 1..20 {
        let circle = swum(&Circle {
            amplitude: f64::from(tenths) * 0.1,
        });
        let period = circle.power_length / 2e-3_f64.sqrt();
        let speed = circle.displacement.norm() / circle.total_length / period;
        assert!(speed < found.speed_over_length, "{tenths}: {speed}");
    }
}

/// The method for several limits, asked of one that binds alone, finds what the other two methods do.
#[test]
fn one_limit_alone_is_lighthills_gait_or_the_fastest_at_the_rates() {
    let on_power = asked(Some(1e-3), None);
    let lighthill = on_power.most_efficient(1e-3, &|_| ()).unwrap();
    let mixed = on_power.mixed(&[], &|_| ());
    told("power", &mixed);
    let ratio = mixed.unwrap().speed_over_length / lighthill.speed_over_length;
    println!("over Lighthill's: {:.2e}", ratio - 1.0);
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    let at_rate = asked(Some(1.0), Some([1.0; 2]));
    let fast = fastest(&SpeedProblem {
        bounds: at_rate.bounds,
        ..SpeedProblem::new(Swimmer::robot(), [1.0; 2])
    });
    let mixed = at_rate.mixed(&[], &|_| ());
    told("rate", &mixed);
    let ratio = mixed.unwrap().speed_over_length / fast.unwrap().speed_over_length;
    println!("over the fastest at the rates: {:.2e}", ratio - 1.0);
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
}

/// More power is never slower; each limit alone gives the answer where the other is far, and between them the answer lies between
/// the slower of the two, and either of them slowed down until it keeps within the other's limit.
#[test]
fn power_and_rate_together() {
    let rates = [1.0; 2];
    let alone = |power, rates| fastest_within(&asked(power, rates), &|_| ()).unwrap();
    let at_rate = alone(None, Some(rates));
    let mut before = 0.0;
    let mut kinds = Vec::new();
    for power in [2e-3, 3e-3, 3.5e-3, 5e-3, 6e-3, 1e-2] {
        let problem = asked(Some(power), Some(rates));
        let found = fastest_within(&problem, &|_| ());
        told(&format!("{power}"), &found);
        let found = found.unwrap();
        let on_power = alone(Some(power), None);
        let singles = [&at_rate, &on_power];
        let most = singles.map(|one| one.speed_over_length);
        let least =
            singles.map(|one| one.speed_over_length / problem.beyond(one, |_| true).max(1.0));
        let speed = found.speed_over_length;
        assert!(speed <= most[0].min(most[1]) * (1.0 + 1e-9), "{power}");
        assert!(speed >= least[0].max(least[1]) * (1.0 - 1e-9), "{power}");
        assert!(speed >= before * (1.0 - 1e-9), "{power}");
        assert!(problem.beyond(&found, |_| true) < 1.0 + 1e-5);
        assert!(found.gait.certificate.pass());
        assert!(found.refinement.is_none_or(|refined| refined < 1e-6));
        before = speed;
        kinds.push(found.limits.len());
    }
    assert_eq!(kinds, [1, 2, 2, 2, 2, 1]);
}

/// Stronger and quicker servos are never slower, and the gait keeps within what they give.
#[test]
fn the_torque_of_the_servos() {
    let mut before = 0.0;
    for (stall_over_viscosity, no_load_rate) in [(4e-3, 2.0), (6e-3, 2.0), (6e-3, 3.0)] {
        let problem = LimitedProblem {
            torque: Some(Torque {
                stall_over_viscosity,
                no_load_rate,
            }),
            ..asked(None, None)
        };
        let found = fastest_within(&problem, &|_| ());
        told(&format!("{stall_over_viscosity} {no_load_rate}"), &found);
        let found = found.unwrap();
        assert!(found.speed_over_length > before);
        assert!(problem.beyond(&found, |_| true) < 1.0 + 1e-5);
        assert!(found.gait.certificate.pass());
        before = found.speed_over_length;
    }
}

#[test]
fn what_is_no_limit_is_refused() {
    for power in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = fastest_within(&asked(Some(power), None), &|_| ());
        assert!(matches!(refused, Err(LimitedError::Power { .. })));
    }
    let refused = fastest_within(&asked(None, None), &|_| ());
    assert!(matches!(refused, Err(LimitedError::Unlimited)));
}
