//! Any sane swimmer: a certified gait or a reason, never a wrong gait, a hang or a panic.

use crate::swimmers;

use gait_optimizer::{Branch, EfficiencyError, EfficiencyProblem, Verdict, efficiency};
use swimmer_files::AnyGait;
use swimmer_model::{Model, Tolerance, swim};

#[test]
fn every_swimmer_gets_a_certified_gait_or_a_reason() {
    let mut refused = Vec::new();
    let mut saddles = 0;
    for (i, case) in swimmers::random(20_260_703, 64).into_iter().enumerate() {
        // Whatever the bounds are.
        let swimmer = case.swimmer;
        let model = Model::new(&swimmer).unwrap();
        for branch in [Branch::Small, Branch::Large] {
            let gait = match efficiency(&EfficiencyProblem::new(swimmer, branch)) {
                Ok(gait) => gait,
                Err(error) => {
                    if let EfficiencyError::Saddle { gait, .. } = &error {
                        let certificate = gait.certify().unwrap();
                        println!("{i}: {}", certificate.failures());
                        assert_eq!(certificate.verdict(), Verdict::Fail, "{i}");
                        saddles += 1;
                    }
                    // An unusual swimmer is no bad input, and the reason has numbers.
                    assert!(!error.is_bad_input(), "{i}: {error}");
                    let told = format!("{error} {}", error.details().unwrap_or_default());
                    assert!(told.contains(|c: char| c.is_ascii_digit()), "{i}: {told}");
                    refused.push(format!("{i}: {error}"));
                    continue;
                }
            };
            assert!(gait.certificate.pass());
            let certificate = gait.certify().unwrap();
            assert!(certificate.pass(), "{i}: {}", certificate.failures());
            // The samples of the real swimmer, not of the scaled one, swum by the model alone.
            let stroke = swim(&model, &gait.gait().unwrap(), &Tolerance::new(1e-11));
            let again = stroke.efficiency_constant_power() / gait.efficiency;
            assert!((again - 1.0).abs() < 1e-6, "{i}: {again}");
            let x = stroke.displacement.x;
            match branch {
                Branch::Small => assert!(x > 0.0),
                Branch::Large => assert!(x < 0.0 && gait.start_angle > 2.0),
            }
            // No gait of the same shape at another size is better: an optimum, and not only stationary by its own account.
            for size in [0.97, 1.03] {
                let phi: Vec<_> = gait.phi().iter().map(|phi| phi * size).collect();
                let scaled = AnyGait::from_samples(gait.u(), &phi, &[]).unwrap();
                let other = swim(&model, &scaled, &Tolerance::new(1e-9));
                assert!(other.efficiency_constant_power() < gait.efficiency, "{i}");
            }
        }
    }
    // Large spheres bend the large gaits until they cross themselves: 10 of the 128. Of 9 with short middle links or next to no
    // displacement the large gait is a saddle among curves without its symmetries.
    assert_eq!(saddles, 9);
    assert!(
        refused.len() <= 20,
        "{} refused:\n{}",
        refused.len(),
        refused.join("\n")
    );
}
