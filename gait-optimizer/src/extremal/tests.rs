//! Tests with known optima, each solved as a quarter and as a closed curve.

use super::equations::Motion;
use super::*;
use crate::momentum::Momentum;
use crate::runge_kutta::{Point, StepControl, System, advance};
use crate::{Branch, EfficiencyError, EfficiencyProblem, OptimalGait, efficiency};
use swimmer_files::Bounds;
use swimmer_model::{Links, Swimmer, SymmetricFourier};

/// Initial curve with a few digits, and the efficiency of the optimum nearby (`None` if it is not published).
struct Case {
    swimmer: Swimmer<f64>,
    coefficients: [[f64; 2]; 3],
    efficiency: Option<f64>,
}

impl Case {
    fn model(&self) -> Model<f64> {
        Model::new(&self.swimmer.of_unit_length()).unwrap()
    }

    fn gait(&self) -> SymmetricFourier<[[f64; 2]; 3]> {
        SymmetricFourier {
            coefficients: self.coefficients,
        }
    }
}

fn cases() -> [Case; 4] {
    let case = |swimmer, coefficients, efficiency| Case {
        swimmer,
        coefficients,
        efficiency,
    };
    [
        case(
            Swimmer::purcell(),
            [[1.42, 1.32], [0.05, 0.14], [0.01, 0.005]],
            Some(0.012_364_154_624),
        ),
        case(
            Swimmer::purcell(),
            [[2.86, 4.06], [0.665, -0.046], [0.207, 0.048]],
            Some(0.018_102_560_47),
        ),
        case(
            Swimmer::robot(),
            [[1.68, 1.42], [0.216, 0.557], [0.02, 0.095]],
            None,
        ),
        case(
            Swimmer::robot(),
            [[3.2, 3.244], [0.39, -0.143], [0.172, 0.706]],
            None,
        ),
    ]
}

fn unbounded(model: &Model<f64>) -> Region {
    walls(&Bounds::default(), &model.swimmer().links)
}

#[test]
fn the_published_optima_are_reached_as_quarters_and_as_closed_curves() {
    let mut found = Vec::new();
    for case in cases() {
        let model = case.model();
        let [quarter, closed] = [true, false]
            .map(|quarter| polish(&model, &unbounded(&model), &case.gait(), quarter).unwrap());
        for extremal in [&quarter, &closed] {
            assert!(extremal.residual <= 1e-10);
            assert_eq!(extremal.chain.arcs.len(), 1);
        }
        let (xi, again) = (quarter.efficiency(&model), closed.efficiency(&model));
        assert!((xi / again - 1.0).abs() < 1e-11, "{xi} {again}");
        if let Some(known) = case.efficiency {
            assert!((xi / known - 1.0).abs() < 1e-9, "{xi} {known}");
        }
        found.push(xi);
    }
    // The paper: 1.46 and 1.45.
    assert!((found[1] / found[0] - 1.4641).abs() < 5e-5, "{found:?}");
    assert!((found[3] / found[2] - 1.453).abs() < 5e-4, "{found:?}");
}

#[test]
fn a_bound_is_followed_where_it_pushes_and_a_loose_one_changes_nothing() {
    let case = &cases()[0];
    let model = case.model();
    let at = |max_angle: f64, quarter: bool| {
        let walls = walls(&Bounds::within(max_angle), &case.swimmer.links);
        polish(&model, &walls, &case.gait(), quarter).unwrap()
    };
    let free = at(2.0, true);
    assert!((free.efficiency(&model) - 0.012_364_154_624).abs() < 1e-12);
    let mut before = free.efficiency(&model);
    for max_angle in [1.4, 1.35, 1.3] {
        let (quarter, closed) = (at(max_angle, true), at(max_angle, false));
        assert_eq!(quarter.chain.arcs.len(), 3, "free, bound, free");
        assert_eq!(closed.chain.arcs.len(), 8);
        let xi = quarter.efficiency(&model);
        assert!((xi / closed.efficiency(&model) - 1.0).abs() < 1e-11);
        assert!(xi < before, "a tighter bound costs efficiency");
        before = xi;
        let bound = quarter.chain.arcs[1];
        assert!(matches!(bound.motion, Motion::Along(_)) && bound.length > 0.0);
    }
}

/// An extremal of Purcell's swimmer that satisfies all first-order conditions but is not a maximum.
#[test]
fn a_saddle_has_ways_up() {
    let model = Model::new(&Swimmer::purcell().of_unit_length()).unwrap();
    let from_ellipse = |[along, across]: [f64; 2]| {
        let gait = SymmetricFourier {
            coefficients: [[along, across]],
        };
        let curve = |s: f64| {
            let point = gait.at(s / std::f64::consts::TAU);
            (point.phi, point.rate / std::f64::consts::TAU)
        };
        solve(&model, guess::quarter_of_curve(&model, &curve, 8).unwrap()).unwrap()
    };
    let saddle = from_ellipse([1.6, 3.6]);
    assert!((saddle.efficiency(&model) - 0.005_709_875_641).abs() < 1e-11);
    assert!(saddle.ascents(&model).unwrap() > 0);
    assert_eq!(from_ellipse([1.2, 1.2]).ascents(&model), Some(0));
}

/// The cycle of a quarter has as many ascent directions as the closed curve that is solved without symmetry.
#[test]
fn a_quarter_knows_the_ascents_without_its_symmetry() {
    let without_symmetry = |quarter: &Extremal, model: &Model<f64>| {
        let cycle = quarter.cycle(model, ASCENTS_OF)?;
        Some(ascents_of_efficiency(model, &cycle, false))
    };
    for case in cases() {
        let model = case.model();
        let [quarter, closed] = [true, false]
            .map(|quarter| polish(&model, &unbounded(&model), &case.gait(), quarter).unwrap());
        let counts = [
            quarter.ascents(&model),
            without_symmetry(&quarter, &model),
            closed.ascents(&model),
        ];
        assert_eq!(counts, [Some(0); 3]);
    }
    let long_sides = Swimmer {
        links: Links {
            middle: 0.4,
            front: 1.0,
            back: 1.0,
        },
        chi: 2.6,
        ..Swimmer::purcell()
    };
    let model = Model::new(&long_sides.of_unit_length()).unwrap();
    let large = EfficiencyProblem::new(long_sides, Branch::Large);
    let Err(EfficiencyError::Saddle { gait, .. }) = efficiency(&large) else {
        panic!("a saddle");
    };
    let curve = gait.gait().unwrap();
    let [quarter, closed] =
        [true, false].map(|quarter| polish(&model, &unbounded(&model), &curve, quarter).unwrap());
    assert_eq!(quarter.ascents(&model), Some(0));
    assert_eq!(without_symmetry(&quarter, &model), Some(1));
    assert_eq!(closed.ascents(&model), Some(1));
}

/// Continuation in the bound to just before the fold of the robot's large gait: the gait is a local optimum, and the other
/// extremal at the fold is not.
#[test]
fn an_optimum_has_no_ascent_and_the_saddle_beyond_a_fold_has_one() {
    let case = &cases()[3];
    let model = case.model();
    let free = polish(&model, &unbounded(&model), &case.gait(), true).unwrap();
    let path = continuation::Path {
        model: &model,
        clearance: 0.0,
        keeps: &|_| Ok(()),
        watch: &|_| (),
    };
    let at = |max_angle: f64| continuation::Tightness {
        max_angle,
        share: 0.0,
    };
    let wide = path.follow(free, at(5.0), at(2.7302)).unwrap();
    let ascents = |extremal: &Extremal| extremal.ascents(&model).unwrap();
    assert_eq!(ascents(&wide), 0);
    let end = path.follow(wide.clone(), at(2.7302), at(2.7)).unwrap_err();
    let continuation::Ended::Fold { at: fold, other } = end else {
        panic!("{end:?}");
    };
    assert!((fold.max_angle - 2.730_041).abs() < 2e-6, "{fold:?}");
    assert!(other.residual <= 1e-10);
    assert!(other.orientation * wide.orientation < 0.0);
    assert_eq!(ascents(&other), 1);
}

/// Polishes a curve to a gait.
fn polished(
    swimmer: &Swimmer<f64>,
    bounds: &Bounds,
    curve: &impl Gait<f64>,
    quarter: bool,
) -> OptimalGait {
    let model = &Model::new(&swimmer.of_unit_length()).unwrap();
    let walls = walls(bounds, &swimmer.links);
    let extremal = polish(model, &walls, curve, quarter).unwrap();
    gait::gait((swimmer, model, bounds), &extremal, 1024).unwrap()
}

/// Free and bounded closed curves, solved without their symmetries, pass their certificates.
#[test]
fn closed_gaits_are_certified() {
    for (case, max_angle) in [(0, None), (0, Some(1.2)), (2, Some(1.6)), (3, None)] {
        let case = &cases()[case];
        let bounds = Bounds {
            max_angle,
            ..Bounds::default()
        };
        let [quarter, gait] =
            [true, false].map(|quarter| polished(&case.swimmer, &bounds, &case.gait(), quarter));
        assert!(gait.certificate.pass(), "{}", gait.certificate.failures());
        assert!(!gait.symmetric);
        assert!((gait.efficiency / quarter.efficiency - 1.0).abs() < 1e-11);
        let distance = gait
            .displacement_over_length
            .hypot(gait.lateral_over_length);
        assert!((distance / quarter.displacement_over_length.abs() - 1.0).abs() < 1e-9);
    }
}

/// A closed curve around both corners at which the tips meet is the gait of the quarter, from its own samples.
#[test]
fn a_closed_gait_bends_round_the_forbidden_shapes() {
    let (swimmer, bounds) = (Swimmer::purcell(), Bounds::default().apart(0.0));
    let quarter = efficiency(&EfficiencyProblem {
        bounds,
        ..EfficiencyProblem::new(swimmer, Branch::Large)
    })
    .unwrap();
    let closed = polished(&swimmer, &bounds, &quarter.gait().unwrap(), false);
    assert!(
        closed.certificate.pass(),
        "{}",
        closed.certificate.failures()
    );
    assert!((closed.efficiency / quarter.efficiency - 1.0).abs() < 1e-11);
}

/// State φ₁, φ₂, x, y, θ, λ₁, λ₂ of the paper (section V), with λ₅ = −½.
struct PapersCostates<'a> {
    model: &'a Model<f64>,
    momentum: Momentum,
}

impl PapersCostates<'_> {
    /// Control that satisfies `H_u = 0`.
    fn control(&self, s: &[f64; 7]) -> Vector2<f64> {
        let (a, w) = self.model.connection_and_power(&Vector2::new(s[0], s[1]));
        let force =
            Vector2::new(s[5], s[6]) + a.transpose() * self.momentum.at(&[s[2], s[3], s[4]]);
        w.try_inverse().unwrap() * force
    }
}

impl System<7> for PapersCostates<'_> {
    fn rate(&self, s: &[f64; 7]) -> [f64; 7] {
        let u = self.control(s);
        let d = self.model.first_derivatives(&Vector2::new(s[0], s[1]));
        let (mu, body) = (self.momentum.at(&[s[2], s[3], s[4]]), d.connection * u);
        let (sin, cos) = s[4].sin_cos();
        let force = |joint: usize| {
            0.5 * u.dot(&(d.d_power[joint] * u)) - mu.dot(&(d.d_connection[joint] * u))
        };
        let [x, y] = [cos * body.x - sin * body.y, sin * body.x + cos * body.y];
        [u.x, u.y, x, y, body.z, force(0), force(1)]
    }
}

/// An extremal of the reduced flow satisfies the paper's costate equations, which use canonical momenta and the pose instead of
/// curvature and magnetic field.
#[test]
fn the_flow_is_the_papers_costate_system() {
    for (swimmer, z) in [
        (Swimmer::purcell(), [0.7, -1.3, 2.1, 3.0, -1.2, 0.4]),
        (Swimmer::robot(), [-2.4, 1.1, -0.6, -12.0, 5.0, 1.7]),
    ] {
        let model = &Model::new(&swimmer.of_unit_length()).unwrap();
        let mu = equations::momentum(&z);
        let momentum = Momentum {
            p: mu.xy(),
            c: mu.z,
        };
        let papers = PapersCostates { model, momentum };
        let (a, w) = model.connection_and_power(&shape(&z));
        let e = Vector2::new(z[2].cos(), z[2].sin());
        let costate = w * e / e.dot(&(w * e)).sqrt() - a.transpose() * mu;
        let start = [z[0], z[1], 0.0, 0.0, 0.0, costate.x, costate.y];
        let control = StepControl {
            tolerance: 1e-13,
            longest: f64::INFINITY,
        };
        let s = advance(&papers, Point::new(&papers, start), 0.6, control)
            .unwrap()
            .z;
        let (end, gain) = flow::flowed(model, &Motion::Free, &z, 0.6).unwrap();
        let (u, mu) = (papers.control(&s), momentum.at(&[s[2], s[3], s[4]]));
        let off = [
            s[0] - end[0],
            s[1] - end[1],
            (u.y.atan2(u.x) - end[2]).sin(),
        ];
        assert!(off.iter().all(|off| off.abs() < 1e-10), "{off:?}");
        assert!((mu - equations::momentum(&end)).amax() < 1e-10 * mu.norm());
        assert!((u.dot(&(model.power_matrix(&shape(&end)) * u)) - 1.0).abs() < 1e-9);
        assert!((momentum.p.dot(&Vector2::new(s[2], s[3])) - gain).abs() < 1e-10);
    }
}
