//! Robust gaits against nominal ones, brute force and differences.

use super::*;
use crate::Condition;
use crate::displacement::displacement;
use crate::member::Member;
use crate::region::Region;
use crate::speed::certificate::{GaitRequirements, certificate};
use nalgebra::DVector;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Tolerance, swim};

fn fit() -> Uncertainty {
    Uncertainty {
        sphere_radius_interval: [0.064, 0.0744],
        chi_interval: [3.3, 3.9],
        ..Uncertainty::none(0.0692, 3.598)
    }
}

fn bounded() -> DisplacementProblem {
    DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8)
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
        let robust = robust_displacement(&bounded(), &exact, over, &|_| ()).unwrap();
        // Collocation and shooting share nothing but the maximum principle.
        let values = robust.robustness.values;
        let off = values.nominal - nominal.displacement_over_length;
        assert!(off.abs() < 1e-10, "{off:e}");
        assert!((robust.gait.start_angle - nominal.start_angle).abs() < 1e-6);
        assert!((robust.gait.end_angle - nominal.end_angle).abs() < 1e-6);
        assert_eq!(
            (values.worst, values.mean),
            (values.nominal, values.nominal)
        );
    }
    let free = DisplacementProblem::new(Swimmer::purcell());
    let purcell =
        robust_displacement(&free, &Uncertainty::none(0.0, 2.0), Over::Worst, &|_| ()).unwrap();
    let known = purcell.robustness.values.nominal;
    assert!((known - 0.103_532_240_0).abs() < 1e-10, "{known}");
}

#[test]
fn robustness_pays_where_it_is_asked_for() {
    let worst = robust_displacement(&bounded(), &fit(), Over::Worst, &|_| ()).unwrap();
    let mean = robust_displacement(&bounded(), &fit(), Over::Mean, &|_| ()).unwrap();
    let (a, b) = (&worst.robustness, &mean.robustness);
    assert!(a.values.worst > a.nominal.worst + 1e-7, "{worst:?}");
    assert!(b.values.mean > b.nominal.mean + 1e-8);
    assert!(a.values.worst >= b.values.worst && b.values.mean >= a.values.mean);
    for robust in [&worst, &mean] {
        assert!(robust.robustness.values.nominal <= robust.robustness.nominal.nominal + 1e-12);
        assert!(robust.gait.certificate.pass());
    }
    // Brute force over a finer grid than the design's.
    let gait = worst.gait.gait().unwrap();
    let steps = 12;
    let mut least = f64::INFINITY;
    for i in 0..=steps {
        for j in 0..=steps {
            let [r, chi] = [i, j].map(|k| f64::from(k) / f64::from(steps));
            let swimmer = with(0.064 + 0.0104 * r, 3.3 + 0.6 * chi);
            least = least.min(displacement_of(&gait, &swimmer));
        }
    }
    let told = a.values.worst;
    assert!((least - told).abs() < 1e-8, "{least} {told}");
}

/// A gait with a bump on each quarter: all four images, so that it stays in its class; only inwards and outwards along the rays.
fn bumped(gait: &OptimalGait, at: f64, size: f64) -> AnyGait {
    let bump = |u: f64| {
        let phase = 8.0 * std::f64::consts::PI * (u - at);
        1.0 + size * (phase.cos() * 12.0 - 12.0).exp()
    };
    let phi = gait.u().iter().zip(gait.phi());
    let cycle = Cycle {
        phi: phi.map(|(u, phi)| phi * bump(*u)).collect(),
        ..gait.cycle.clone()
    };
    cycle.gait().unwrap()
}

/// No gait near the robust one does better for the mean: bumps on its free arcs, within the bound.
#[test]
fn no_neighbour_has_a_better_mean() {
    let robust = robust_displacement(&bounded(), &fit(), Over::Mean, &|_| ()).unwrap();
    let members = fit().normal(&Swimmer::robot()).unwrap();
    let mean = |gait: &AnyGait| -> f64 {
        let of = |(member, weight): &(Member, f64)| {
            let stroke = swim(&member.model, gait, &Tolerance::new(1e-11));
            weight * stroke.displacement_over_length().x
        };
        members.iter().map(of).sum()
    };
    let gait = robust.gait.gait().unwrap();
    let best = mean(&gait);
    assert!((best - robust.robustness.values.mean).abs() < 1e-8);
    // At the middle of the first free arc and at the antidiagonal; bumps repeat with a quarter's period, so both images.
    for (at, size) in [(0.0, 0.02), (0.0, -0.02), (0.22, 0.02), (0.22, -0.02)] {
        let other = mean(&bumped(&robust.gait, at, size));
        assert!(other < best, "{at} {size}: {other} {best}");
    }
}

#[test]
fn fourier_gradients_are_exact() {
    let member = Member::new(&Swimmer::robot(), 1.0).unwrap();
    let family = FourierFamily::around(&member, 1, Branch::Small).unwrap();
    let x = family.start() + DVector::from_vec(vec![0.1, -0.07]);
    let member = Member {
        gain: 0.97,
        ..member
    };
    let checks = family.conditions(&x, &[(member, 1.0)]);
    let norm = checks[0].value;
    let value = |x: &DVector<f64>| family.value(x, &member).ln();
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
    let turned = FourierFamily::gait(&(&x * member.gain));
    let stroke = swim(&member.model, &turned, &Tolerance::default());
    assert!((value(&x).exp() / stroke.efficiency() - 1.0).abs() < 1e-10);
}

#[test]
fn purcells_small_gait_comes_out_of_the_series() {
    let exact = Uncertainty::none(0.0, 2.0);
    let robust = |order| {
        let (purcell, free) = (Swimmer::purcell(), Bounds::default());
        robust_efficiency(
            &purcell,
            (Branch::Small, order),
            &free,
            &exact,
            Over::Mean,
            &|_| (),
        )
        .unwrap()
    };
    let [third, sixth] = [3, 6].map(robust);
    let (less, best) = (third.robustness.values, sixth.robustness.values);
    let optimum = 0.012_364_154_624;
    assert!(less.nominal < best.nominal && best.nominal <= optimum);
    assert!(best.nominal / optimum > 1.0 - 1e-5, "{}", best.nominal);
    assert!((sixth.gait.efficiency / optimum - 1.0).abs() < 1e-5);
    assert_eq!((best.worst, best.mean), (best.nominal, best.nominal));
}

#[test]
fn robust_efficiency_pays_too() {
    for branch in [Branch::Small, Branch::Large] {
        let robust = |over| {
            let (robot, free) = (Swimmer::robot(), Bounds::default());
            robust_efficiency(&robot, (branch, 3), &free, &fit(), over, &|_| ()).unwrap()
        };
        let [worst, mean] = [Over::Worst, Over::Mean].map(robust);
        let (a, b) = (&worst.robustness, &mean.robustness);
        assert!(a.values.worst > a.nominal.worst, "{worst:?}");
        assert!(b.values.mean > b.nominal.mean);
        assert!(a.values.nominal < a.nominal.nominal);
        assert!(worst.gait.certificate.pass() && mean.gait.certificate.pass());
    }
}

/// An uncertain gain alone: a slightly larger angle gains more than a slightly smaller one loses, so both ends may be the worst
/// case.
#[test]
fn a_gain_in_doubt_is_designed_for() {
    let exact = Uncertainty {
        gain_interval: [0.9, 1.1],
        ..Uncertainty::none(0.0, 2.0)
    };
    let free = DisplacementProblem::new(Swimmer::purcell());
    let robust = robust_displacement(&free, &exact, Over::Worst, &|_| ()).unwrap();
    let Robustness {
        values,
        nominal,
        held_by,
        ..
    } = &robust.robustness;
    // The free optimum is one over all sizes, too: it loses either way, and there is a size at which both ends lose as much.
    assert!(values.worst > nominal.worst + 1e-6, "{robust:?}");
    assert_eq!(held_by.len(), 2, "{held_by:?}");
    let curve = robust.gait.gait().unwrap();
    let brings = |gain: f64| {
        let turned = robust.gait.cycle.turned(gain).gait().unwrap();
        displacement_of(&turned, &Swimmer::purcell())
    };
    assert!((brings(1.0) - displacement_of(&curve, &Swimmer::purcell())).abs() < 1e-12);
    let least = (0..=40).map(|i| brings(0.9 + 0.005 * f64::from(i)));
    let least = least.fold(f64::INFINITY, f64::min);
    assert!((least - values.worst).abs() < 1e-8, "{least} {values:?}");
}

/// The worst of an ellipse is a minimum over it, border and all within, not the lowest of the points where its search begins.
#[test]
fn the_worst_of_an_ellipse_is_a_minimum() {
    let tilted = Uncertainty {
        correlation: Some(0.83),
        ..fit()
    };
    let robust = robust_displacement(&bounded(), &tilted, Over::Worst, &|_| ()).unwrap();
    let gait = robust.gait.gait().unwrap();
    let steps = 720;
    let brings = |i: i32| {
        let turn = std::f64::consts::TAU * f64::from(i) / f64::from(steps);
        let member = tilted.at(&Swimmer::robot(), [1.0, turn, 0.0]);
        displacement_of(&gait, &member.unwrap().swimmer)
    };
    let on_border: Vec<f64> = (0..steps).map(brings).collect();
    let least = on_border.iter().copied().fold(f64::INFINITY, f64::min);
    let coarse = on_border.iter().copied().step_by(24);
    let coarse = coarse.fold(f64::INFINITY, f64::min);
    let worst = robust.robustness.values.worst;
    assert!(worst <= least + 1e-10, "{worst} {least}");
    assert!(least - worst < 1e-5 * worst, "{worst} {least}");
    assert!(
        coarse - worst > 1e-7,
        "the test cannot tell: {coarse} {worst}"
    );
}

#[test]
fn nonsense_is_refused() {
    let efficiency = |order, max_angle, uncertainty: &Uncertainty| {
        let bounds = Bounds {
            max_angle,
            ..Bounds::default()
        };
        let large = (Branch::Large, order);
        robust_efficiency(
            &Swimmer::robot(),
            large,
            &bounds,
            uncertainty,
            Over::Mean,
            &|_| (),
        )
    };
    for order in [0, 99] {
        let refused = efficiency(order, None, &fit());
        assert!(matches!(refused, Err(RobustError::Order { .. })));
    }
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
        robust_displacement(&free, &fit(), Over::Mean, &|_| ()),
        Err(RobustError::Nominal(_))
    ));
    let mut sector = bounded();
    sector.bounds.sector = true;
    assert!(matches!(
        robust_displacement(&sector, &fit(), Over::Mean, &|_| ()),
        Err(RobustError::Arc { .. })
    ));
    let slipping = Uncertainty {
        gain_interval: [0.95, 1.05],
        ..fit()
    };
    let mut apart = bounded();
    apart.bounds.no_overlap = true;
    assert!(matches!(
        robust_displacement(&apart, &slipping, Over::Mean, &|_| ()),
        Err(RobustError::Clearance)
    ));
}

/// At the corner of these intervals the small gait's branch has ended (by shooting, too: X/L = 0.094, not 0.05), and the best
/// worst case lies on another one, better for the estimates as well. That is said.
#[test]
fn a_branch_that_ends_is_told() {
    let on = |order| {
        let (robot, small, free) = (Swimmer::robot(), (Branch::Small, order), Bounds::default());
        let found = robust_efficiency(&robot, small, &free, &fit(), Over::Worst, &|_| ());
        found.unwrap().robustness
    };
    assert!(!on(3).off_branch);
    let off = on(4);
    assert!(off.off_branch && off.values.worst > off.nominal.worst);
}

fn fast(max_angle: f64) -> crate::SpeedProblem {
    crate::SpeedProblem {
        bounds: Bounds::within(max_angle),
        starts: 6,
        ..crate::SpeedProblem::new(Swimmer::robot(), [1.0; 2])
    }
}

/// Without an interval the fastest gait; with one a gait that gives up some of its speed for the worst case or the mean.
#[test]
fn robust_speed_pays_too() {
    let exact = Uncertainty::none(0.0692, 3.598);
    let same = robust_speed(&fast(2.8), &exact, Over::Worst, &|_| ()).unwrap();
    assert!((same.fastest.speed_over_length - 0.007_533_853_203_8).abs() < 1e-12);
    let wide = Uncertainty {
        gain_interval: [0.97, 1.03],
        ..fit()
    };
    let of = |over| robust_speed(&fast(2.8), &wide, over, &|_| ()).unwrap();
    let (worst, mean) = (of(Over::Worst), of(Over::Mean));
    let (a, b) = (&worst.robustness, &mean.robustness);
    assert!(a.values.worst > a.nominal.worst * (1.0 + 1e-6), "{a:?}");
    assert!(b.values.mean > b.nominal.mean * (1.0 + 1e-9), "{b:?}");
    assert!(a.values.worst >= b.values.worst && b.values.mean >= a.values.mean);
    for one in [&worst, &mean] {
        assert!(one.fastest.gait.certificate.pass());
        assert!(one.robustness.values.nominal <= one.robustness.nominal.nominal * (1.0 + 1e-12));
        assert!((one.fastest.speed_over_length - one.robustness.values.nominal).abs() < 1e-12);
        assert!(!one.robustness.off_branch);
    }
}

/// With unlike side links a gait is free of rotation for one swimmer only, and what others swim depends on where its cycle begins.
#[test]
fn a_gait_that_turns_others_is_refused() {
    let mut problem = fast(2.0);
    problem.swimmer.links.front *= 1.2;
    let found = robust_speed(&problem, &fit(), Over::Mean, &|_| ());
    let turns = |rotation: f64| rotation > 1e-8;
    assert!(
        matches!(found, Err(RobustError::Turns { rotation }) if turns(rotation)),
        "{found:?}"
    );
}

/// The certificate is that of the curve and the ensemble: the nominal optimum fails it.
#[test]
fn the_nominal_optimum_is_not_robust() {
    let problem = fast(2.0);
    let uncertainty = fit();
    let found = robust_speed(&problem, &uncertainty, Over::Mean, &|_| ()).unwrap();
    let optimum = crate::fastest(&problem).unwrap();
    let members = uncertainty.normal(&Swimmer::robot()).unwrap();
    let residual = |gait: &OptimalGait| {
        let file = gait.gait_file("");
        let curve = gait.gait().unwrap();
        let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
        let region = Region::new(&problem.bounds, &model.swimmer().links);
        let asked = GaitRequirements::default();
        let certificate = certificate((&model, &members), &region, asked, &file, &curve);
        certificate.value(Condition::SwitchIntegrals).unwrap()
    };
    assert!(residual(&found.fastest.gait) < 1e-8);
    assert!(
        residual(&optimum.gait) > 1e-5,
        "{}",
        residual(&optimum.gait)
    );
}
