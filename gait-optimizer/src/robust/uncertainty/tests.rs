//! Tests of the ensembles that follow from an uncertainty.

use super::*;

fn wide() -> Uncertainty {
    Uncertainty {
        sphere_radius_interval: [0.06, 0.08],
        chi_interval: [3.6 * (-0.15_f64).exp(), 3.6 * 0.15_f64.exp()],
        correlation: Some(0.7),
        ..Uncertainty::none(0.07, 3.6)
    }
}

/// Uncertainty as a calibration reports it: a factor about χ, a length about r_s, not below zero.
fn fitted(chi: f64, [low, high]: [f64; 2], correlation: Option<f64>) -> Uncertainty {
    Uncertainty {
        sphere_radius_interval: [0.0, 0.05],
        chi_interval: [low, high],
        correlation,
        ..Uncertainty::none(0.02, chi)
    }
}

#[test]
fn the_rule_has_the_moments_of_the_normal_distribution() {
    let members = wide().normal(&Swimmer::robot()).unwrap();
    let mean = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        members
            .iter()
            .map(|(s, w)| w * f(s.swimmer.sphere_radius - 0.07, (s.swimmer.chi / 3.6).ln()))
            .sum()
    };
    let quantile = 1.959_963_984_540_054;
    let (dr, dchi) = (0.01 / quantile, 0.15 / quantile);
    assert!((mean(&|_, _| 1.0) - 1.0).abs() < 1e-14);
    assert!(mean(&|r, c| r + c).abs() < 1e-14);
    assert!((mean(&|r, _| r * r) / (dr * dr) - 1.0).abs() < 1e-8);
    assert!((mean(&|_, c| c * c) / (dchi * dchi) - 1.0).abs() < 1e-8);
    assert!((mean(&|r, c| r * c) / (0.7 * dr * dchi) - 1.0).abs() < 1e-8);
    assert!((mean(&|_, c| c.powi(4)) / (3.0 * dchi.powi(4)) - 1.0).abs() < 1e-8);
    // With χ known to a factor of three no member has χ = 0 or a clamped value.
    let open = fitted(5.16, [1.55, 17.1], Some(-0.9))
        .normal(&Swimmer::robot())
        .unwrap();
    let logs = open.iter().map(|(s, w)| w * s.swimmer.chi.ln());
    assert!((logs.sum::<f64>() - 5.16_f64.ln()).abs() < 1e-12);
    // With an exact r_s, χ has its whole spread for any correlation.
    let alone = Uncertainty {
        sphere_radius_interval: [0.07; 2],
        ..wide()
    };
    let spread = alone.normal(&Swimmer::robot()).unwrap();
    let spread = spread
        .iter()
        .map(|(s, w)| w * (s.swimmer.chi / 3.6).ln().powi(2));
    assert!((spread.sum::<f64>() / (dchi * dchi) - 1.0).abs() < 1e-8);
}

/// Many swimmers of the ensemble.
fn fine(case: &Uncertainty) -> Vec<Swimmer<f64>> {
    let [first, second, _] = case.axes();
    let steps = 512;
    let along = |axis: Axis| {
        (0..=steps)
            .map(move |i| axis.from + (axis.to - axis.from) * f64::from(i) / f64::from(steps))
    };
    let border = if case.rho().is_some() { 1.0 } else { first.to };
    along(second)
        .flat_map(|two| along(first).step_by(32).map(move |one| [one, two, 0.0]))
        .chain(along(first).map(|one| [one, second.to, 0.0]))
        .chain(along(second).map(|two| [border, two, 0.0]))
        .map(|place| case.at(&Swimmer::robot(), place).unwrap().swimmer)
        .collect()
}

#[test]
fn the_swimmers_touch_the_intervals_and_never_leave_them() {
    let tilted = Uncertainty {
        sphere_radius_interval: [0.065, 0.09],
        chi_interval: [3.5, 6.0],
        ..wide()
    };
    let mut cases = vec![wide(), tilted];
    for correlation in [None, Some(0.0), Some(0.95), Some(-0.8), Some(1.0)] {
        cases.push(fitted(3.675, [2.437, 5.541], correlation));
        cases.push(fitted(5.16, [1.55, 17.1], correlation));
    }
    for case in cases {
        let points = fine(&case);
        let ends = |of: &dyn Fn(&Swimmer<f64>) -> f64| {
            let of = points.iter().map(of);
            of.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            })
        };
        let close = |[low, high]: [f64; 2], [from, to]: [f64; 2]| {
            let slack = 1e-3 * (to - from);
            low >= from * (1.0 - 1e-12)
                && high <= to * (1.0 + 1e-12)
                && low < from + slack
                && high > to - slack
        };
        let (r, chi) = (ends(&|s| s.sphere_radius), ends(&|s| s.chi));
        assert!(close(r, case.sphere_radius_interval), "{case:?} {r:?}");
        assert!(close(chi, case.chi_interval), "{case:?} {chi:?}");
    }
    let count = |case: Uncertainty| case.grid().len();
    let box_only = Uncertainty {
        correlation: None,
        ..wide()
    };
    assert_eq!(count(box_only), 25);
    assert_eq!(count(wide()), 33);
    assert_eq!(count(Uncertainty::none(0.07, 3.6)), 1);
    let exact = Uncertainty::none(0.07, 3.6)
        .normal(&Swimmer::robot())
        .unwrap();
    assert_eq!(exact.len(), 1);
}

#[test]
fn nonsense_is_refused() {
    assert!(wide().validate().is_ok());
    for wrong in [
        Uncertainty {
            chi_interval: [-1.0, 4.0],
            ..wide()
        },
        Uncertainty {
            chi_interval: [4.0, 3.0],
            ..wide()
        },
        Uncertainty {
            sphere_radius_interval: [f64::NAN, 0.1],
            ..wide()
        },
        Uncertainty {
            level: 1.0,
            ..wide()
        },
        Uncertainty {
            correlation: Some(1.5),
            ..wide()
        },
        Uncertainty { chi: 9.0, ..wide() },
        Uncertainty {
            sphere_radius: 0.01,
            ..wide()
        },
    ] {
        assert!(wrong.validate().is_err(), "{wrong:?}");
    }
}
