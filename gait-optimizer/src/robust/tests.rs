//! Robust gaits against nominal ones, brute force and differences.

use super::*;
use swimmer_files::AnyGait;
use swimmer_model::{Gait, Tolerance, swim};

fn fit() -> Uncertainty {
    Uncertainty {
        sphere_radius_interval: [0.064, 0.0744],
        chi_interval: [3.3, 3.9],
        ..Uncertainty::none(0.0692, 3.598)
    }
}

fn bounded() -> DisplacementProblem {
    DisplacementProblem {
        simple: true,
        ..DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8)
    }
}

/// X/L by the model's own integration.
fn displacement_of(gait: &AnyGait, swimmer: &Swimmer<f64>) -> f64 {
    let model = Model::new(swimmer).unwrap();
    swim(&model, gait, &Tolerance::default())
        .displacement_over_length()
        .x
}

fn with(sphere_radius: f64, chi: f64) -> Swimmer<f64> {
    Swimmer {
        sphere_radius,
        chi,
        ..Swimmer::robot()
    }
}

#[test]
fn without_an_interval_it_is_the_nominal_optimum() {
    let exact = Uncertainty::none(0.0692, 3.598);
    let nominal = displacement(&bounded()).unwrap();
    for over in [Over::Worst, Over::Mean] {
        let robust = robust_displacement(&bounded(), &exact, over).unwrap();
        // Collocation and shooting share nothing but the maximum principle.
        let off = robust.values.nominal - nominal.displacement_over_length;
        assert!(off.abs() < 1e-10, "{off:e}");
        assert!((robust.gait.start_angle - nominal.start_angle).abs() < 1e-6);
        assert!((robust.gait.end_angle - nominal.end_angle).abs() < 1e-6);
        assert_eq!(
            (robust.values.worst, robust.values.mean),
            (robust.values.nominal, robust.values.nominal)
        );
    }
    let free = DisplacementProblem::new(Swimmer::purcell());
    let purcell = robust_displacement(&free, &Uncertainty::none(0.0, 2.0), Over::Worst).unwrap();
    assert!(
        (purcell.values.nominal - 0.103_532_240_0).abs() < 1e-10,
        "{}",
        purcell.values.nominal
    );
}

#[test]
fn robustness_pays_where_it_is_asked_for() {
    let worst = robust_displacement(&bounded(), &fit(), Over::Worst).unwrap();
    let mean = robust_displacement(&bounded(), &fit(), Over::Mean).unwrap();
    assert!(worst.values.worst > worst.nominal.worst + 1e-7, "{worst:?}");
    assert!(mean.values.mean > mean.nominal.mean + 1e-8);
    assert!(worst.values.worst >= mean.values.worst && mean.values.mean >= worst.values.mean);
    for robust in [&worst, &mean] {
        assert!(robust.values.nominal <= robust.nominal.nominal + 1e-12);
        assert!(robust.gait.certificate.pass());
    }
    // Brute force over a finer grid than the design's.
    let gait = worst.gait.gait().unwrap();
    let steps = 12;
    let mut least = f64::INFINITY;
    for i in 0..=steps {
        for j in 0..=steps {
            let (a, b) = (
                f64::from(i) / f64::from(steps),
                f64::from(j) / f64::from(steps),
            );
            least = least.min(displacement_of(
                &gait,
                &with(0.064 + 0.0104 * a, 3.3 + 0.6 * b),
            ));
        }
    }
    assert!(
        (least - worst.values.worst).abs() < 1e-8,
        "{least} {}",
        worst.values.worst
    );
}

/// A gait with a bump on each quarter.
struct Bumped<'a>(&'a AnyGait, f64, f64);
impl Gait<f64> for Bumped<'_> {
    fn at(&self, u: f64) -> swimmer_model::GaitPoint<f64> {
        // All four images, so that the gait stays in its class; only inwards and outwards along the rays.
        let mut point = self.0.at(u);
        let phase = 8.0 * std::f64::consts::PI * (u - self.1);
        let bump = (phase.cos() * 12.0 - 12.0).exp();
        let slope = -8.0 * std::f64::consts::PI * 12.0 * phase.sin() * bump;
        point.rate = point.rate * (1.0 + self.2 * bump) + point.phi * (self.2 * slope);
        point.phi *= 1.0 + self.2 * bump;
        point
    }
    fn pieces(&self) -> usize {
        self.0.pieces()
    }
    fn piece_end(&self, i: usize) -> f64 {
        self.0.piece_end(i)
    }
    fn corner_at_end(&self, i: usize) -> bool {
        self.0.corner_at_end(i)
    }
}

/// No gait near the robust one does better for the mean: bumps on its free arcs, within the bound.
#[test]
fn no_neighbour_has_a_better_mean() {
    let robust = robust_displacement(&bounded(), &fit(), Over::Mean).unwrap();
    let members = fit().normal(&Swimmer::robot());
    let mean = |gait: &dyn Gait<f64>| -> f64 {
        members
            .iter()
            .map(|(swimmer, weight)| {
                let model = Model::new(swimmer).unwrap();
                weight
                    * swim(&model, gait, &Tolerance::new(1e-11))
                        .displacement_over_length()
                        .x
            })
            .sum()
    };
    let gait = robust.gait.gait().unwrap();
    let best = mean(&gait);
    assert!((best - robust.values.mean).abs() < 1e-8);
    // At the middle of the first free arc and at the antidiagonal; bumps repeat with a quarter's period, so both images.
    for (at, size) in [(0.0, 0.02), (0.0, -0.02), (0.22, 0.02), (0.22, -0.02)] {
        let other = mean(&Bumped(&gait, at, size));
        assert!(other < best, "{at} {size}: {other} {best}");
    }
}

#[test]
fn fourier_gradients_are_exact() {
    let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
    let family = FourierFamily::around(&model, 1, Branch::Small).unwrap();
    let x = family.start() + DVector::from_vec(vec![0.1, -0.07]);
    let norm = family.gradient_norm(&x, &[(&model, 1.0)]);
    let value = |x: &DVector<f64>| family.values(x, &[model]).first().copied().unwrap().ln();
    let slopes = (0..2).map(|i| {
        let at = |step: f64| {
            let mut x = x.clone();
            x[i] += step;
            value(&x)
        };
        (8.0 * (at(1e-3) - at(-1e-3)) - at(2e-3) + at(-2e-3)) / 12e-3
    });
    let differences = slopes.map(|slope| slope * slope).sum::<f64>().sqrt();
    assert!(
        (norm / differences - 1.0).abs() < 1e-8,
        "{norm} {differences}"
    );
    // The value is that of the model's own integration.
    let stroke = swim(&model, &FourierFamily::gait(&x), &Tolerance::default());
    assert!((value(&x).exp() / stroke.efficiency() - 1.0).abs() < 1e-10);
}

#[test]
fn purcells_small_gait_comes_out_of_the_series() {
    let exact = Uncertainty::none(0.0, 2.0);
    let robust = |order| {
        robust_efficiency(
            &Swimmer::purcell(),
            (Branch::Small, order),
            &Bounds::default(),
            &exact,
            Over::Mean,
        )
        .unwrap()
    };
    let (third, sixth) = (robust(3), robust(6));
    let optimum = 0.012_364_154_624;
    assert!(third.values.nominal < sixth.values.nominal && sixth.values.nominal <= optimum);
    assert!(
        sixth.values.nominal / optimum > 1.0 - 1e-5,
        "{}",
        sixth.values.nominal
    );
    assert!((sixth.gait.efficiency / optimum - 1.0).abs() < 1e-5);
    assert!(
        (sixth.values.worst, sixth.values.mean) == (sixth.values.nominal, sixth.values.nominal)
    );
}

#[test]
fn robust_efficiency_pays_too() {
    for branch in [Branch::Small, Branch::Large] {
        let robust = |over| {
            robust_efficiency(
                &Swimmer::robot(),
                (branch, 3),
                &Bounds::default(),
                &fit(),
                over,
            )
            .unwrap()
        };
        let (worst, mean) = (robust(Over::Worst), robust(Over::Mean));
        assert!(worst.values.worst > worst.nominal.worst, "{worst:?}");
        assert!(mean.values.mean > mean.nominal.mean);
        assert!(worst.values.nominal < worst.nominal.nominal);
        assert!(worst.gait.certificate.pass() && mean.gait.certificate.pass());
    }
}

/// A worst case that two members share: one of them gains where the other loses, so the design weighs both.
#[test]
fn two_members_can_hold_the_worst_case() {
    let model = |middle: f64, chi: f64| {
        let mut swimmer = Swimmer::<f64>::purcell();
        swimmer.links.middle = middle;
        swimmer.chi = chi;
        Model::new(&swimmer.of_unit_length()).unwrap()
    };
    let family = FourierFamily::around(&model(1.0, 2.0), 2, Branch::Small).unwrap();
    let ours = |chi| [model(0.5, 2.0), model(1.8, chi)];
    // The χ at which both are equal at a gait between their optima: there they must share.
    let (mut low, mut high) = (1.5, 3.0);
    for _ in 0..40 {
        let chi = 0.5 * (low + high);
        let values = family.values(&family.start(), &ours(chi));
        if values[1] < values[0] {
            low = chi;
        } else {
            high = chi;
        }
    }
    let members = ours(0.5 * (low + high));
    let held = worst::worst(&family, &members).unwrap();
    assert_eq!(held.active.len(), 2, "{held:?}");
    assert!(
        held.active
            .iter()
            .all(|(_, weight)| *weight > 0.0 && *weight < 1.0)
    );
    let values = family.values(&held.x, &members);
    assert!((values[0] / values[1] - 1.0).abs() < 1e-9);
    let before = family.values(&family.start(), &members);
    assert!(values[0] > before[0].min(before[1]));
}

#[test]
fn nonsense_is_refused() {
    let efficiency = |order, max_angle, uncertainty: &Uncertainty| {
        robust_efficiency(
            &Swimmer::robot(),
            (Branch::Large, order),
            &Bounds {
                max_angle,
                ..Bounds::default()
            },
            uncertainty,
            Over::Mean,
        )
    };
    assert!(matches!(
        efficiency(0, None, &fit()),
        Err(RobustError::Order { .. })
    ));
    assert!(matches!(
        efficiency(99, None, &fit()),
        Err(RobustError::Order { .. })
    ));
    assert!(matches!(
        efficiency(2, Some(2.0), &Uncertainty::none(0.0692, 3.598)),
        Err(RobustError::Bound { .. })
    ));
    let wrong = Uncertainty {
        level: 2.0,
        ..fit()
    };
    assert!(matches!(
        efficiency(2, None, &wrong),
        Err(RobustError::Uncertainty { .. })
    ));
    let free = DisplacementProblem::new(Swimmer::robot());
    assert!(matches!(
        robust_displacement(&free, &fit(), Over::Mean),
        Err(RobustError::Nominal(_))
    ));
}

/// At the corner of these intervals the small gait's branch has ended (by shooting, too: X/L = 0.094, not 0.05), and the best
/// worst case lies on another one, better for the estimates as well. That is said.
#[test]
fn a_branch_that_ends_is_told() {
    let on = |order| {
        robust_efficiency(
            &Swimmer::robot(),
            (Branch::Small, order),
            &Bounds::default(),
            &fit(),
            Over::Worst,
        )
        .unwrap()
    };
    assert!(!on(3).off_branch());
    let off = on(4);
    assert!(off.off_branch() && off.values.worst > off.nominal.worst);
}
