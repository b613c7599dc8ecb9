//! Any sane swimmer: a certified gait or a reason, never a wrong gait, a hang or a panic.

use gait_optimizer::{Branch, EfficiencyProblem, efficiency};
use swimmer_files::AnyGait;
use swimmer_model::{Links, Model, Swimmer, TangentialDrag, Tolerance, swim};

/// Link ratio 0.3–3, χ 1.3–5, sphere 0–1.2 l₀ (none for every fourth), all forms of `c_t`; spread evenly and always the same
/// (Roberts' sequence in four dimensions).
fn swimmer(i: u32) -> Swimmer<f64> {
    let root = 1.167_303_978_261_418_7_f64;
    let part = |power: i32| (0.5 + f64::from(i) / root.powi(power)).fract();
    let middle = 0.1;
    let side = middle / (0.3 * 10_f64.powf(part(1)));
    Swimmer {
        links: Links {
            middle,
            front: side,
            back: side,
        },
        chi: 1.3 + 3.7 * part(2),
        tangential_drag: match i % 3 {
            0 => TangentialDrag::LogAspect(3.0 + 3.0 * part(4)),
            1 => TangentialDrag::HalfThickness(0.02 * part(4).max(0.05) * middle.min(side)),
            _ => TangentialDrag::OverViscosity(0.5 + 2.0 * part(4)),
        },
        sphere_radius: if i.is_multiple_of(4) {
            0.0
        } else {
            1.2 * middle * part(3)
        },
    }
}

#[test]
fn every_swimmer_gets_a_certified_gait_or_a_reason() {
    let mut refused = Vec::new();
    for i in 0..64 {
        let swimmer = swimmer(i);
        let model = Model::new(&swimmer).unwrap();
        for branch in [Branch::Small, Branch::Large] {
            let gait = match efficiency(&EfficiencyProblem::new(swimmer, branch)) {
                Ok(gait) => gait,
                Err(error) => {
                    // An unusual swimmer is no bad input, and the reason has numbers.
                    assert!(!error.is_bad_input(), "{i}: {error}");
                    let told = format!("{error} {}", error.details().unwrap_or_default());
                    assert!(told.contains(|c: char| c.is_ascii_digit()), "{i}: {told}");
                    refused.push(format!("{i}: {error}"));
                    continue;
                }
            };
            assert!(gait.certificate.pass());
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
    // Large spheres bend the large gaits until they cross themselves: 14 of the 128. Others are one in a hundred.
    assert!(
        refused.len() <= 18,
        "{} refused:\n{}",
        refused.len(),
        refused.join("\n")
    );
}
