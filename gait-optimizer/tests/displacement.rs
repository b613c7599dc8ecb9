//! Displacement gaits against the paper, against an independent direct method, and over swimmers and bounds of all kinds.

mod direct;

use direct::{Direct, fan, row};
use gait_optimizer::{ArcKind, DisplacementError, DisplacementProblem, OptimalGait, displacement};
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Links, Swimmer, TangentialDrag, Tolerance, swim};

fn optimum(problem: &DisplacementProblem) -> OptimalGait {
    match displacement(problem) {
        Ok(gait) => gait,
        Err(error) => panic!("{problem:?}: {error}"),
    }
}

fn kinds(gait: &OptimalGait) -> Vec<ArcKind> {
    gait.arcs.iter().map(|arc| arc.kind).collect()
}

/// Gait (a): Purcell's swimmer without bounds.
#[test]
fn purcell_without_bounds() {
    let gait = optimum(&DisplacementProblem::new(Swimmer::purcell()));
    assert!(
        (gait.displacement_over_length - 0.103_532_240_0).abs() < 1e-9,
        "{}",
        gait.displacement_over_length
    );
    assert!(
        (gait.start_angle - 1.411_723_71).abs() < 5e-9,
        "{}",
        gait.start_angle
    );
    assert!(
        (gait.end_angle - 0.769_169_94).abs() < 5e-9,
        "{}",
        gait.end_angle
    );
    assert!((gait.displacement - 3.0 * gait.displacement_over_length).abs() < 1e-15);
    assert_eq!(kinds(&gait), [ArcKind::Singular]);
    assert!(gait.corners().is_empty());
    assert!(gait.certificate.pass());
}

/// Gait (b): the robot within 2.8 rad.
#[test]
fn robot_within_an_upper_bound() {
    let gait = optimum(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8));
    assert_eq!(
        kinds(&gait),
        [ArcKind::Singular, ArcKind::Upper, ArcKind::Singular]
    );
    assert!(
        gait.links_cross.abs() < 1e-15,
        "gait (b) never crosses its links"
    );
    assert_eq!(gait.corners().len(), 8);
    assert!((gait.displacement / 0.345 - gait.displacement_over_length).abs() < 1e-14);
}

#[test]
fn the_robot_has_no_optimum_without_bounds() {
    let error = displacement(&DisplacementProblem::new(Swimmer::robot())).unwrap_err();
    let DisplacementError::NoUnboundedOptimum { fates } = &error else {
        panic!("{error}");
    };
    assert!(fates.came_back > 0 && fates.sent > fates.ended);
    assert!(error.to_string().contains("give an upper bound"));
}

/// A bound that does not bind changes nothing; a tighter one costs displacement; a tight one makes a square.
#[test]
fn a_tightening_bound() {
    let free = optimum(&DisplacementProblem::new(Swimmer::purcell()));
    let bounded = |max| optimum(&DisplacementProblem::new(Swimmer::purcell()).with_max_angle(max));
    assert!((bounded(2.5).displacement_over_length - free.displacement_over_length).abs() < 1e-12);
    let mut last = free.displacement_over_length;
    for max in [
        1.9, 1.85, 1.8, 1.7, 1.6, 1.5, 1.45, 1.42, 1.3, 1.0, 0.8, 0.7, 0.5, 0.2,
    ] {
        let gait = bounded(max);
        assert!(gait.displacement_over_length <= last + 1e-12, "{max}");
        last = gait.displacement_over_length;
        assert!(
            gait.phi().iter().all(|phi| phi.amax() <= max + 1e-12),
            "{max}"
        );
    }
    let square = bounded(0.5);
    assert_eq!(kinds(&square), [ArcKind::Upper]);
    let model = swimmer_model::Model::new(&Swimmer::purcell()).unwrap();
    let swum = swim(
        &model,
        &swimmer_model::Square { amplitude: 0.5 },
        &Tolerance::default(),
    );
    assert!((square.displacement - swum.displacement.x).abs() < 1e-12);
}

/// The maximum principle and the direct method meet.
#[test]
fn the_direct_method_agrees_on_purcell() {
    let gait = optimum(&DisplacementProblem::new(Swimmer::purcell()));
    let guess = [[1.3, 1.3], [0.9, 1.7], [0.0, 1.8], [-0.6, 1.3], [-0.8, 0.8]];
    let direct = Direct::new(&Swimmer::purcell(), f64::INFINITY, fan(&guess, 0.0, 40)).climb();
    assert!(
        (direct - gait.displacement_over_length).abs() < 1e-6,
        "{direct} {}",
        gait.displacement_over_length
    );
}

#[test]
fn the_direct_method_agrees_on_the_robot() {
    let gait = optimum(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8));
    // Up on the right, along the top, down on the left: sides slide sideways, the top up and down against its bound.
    let mut start = row([1.5, 1.5], [0.7, 2.8], [1.0, 0.0], 24);
    start.extend(row([0.7, 2.8], [0.6, 2.8], [1.0, 0.0], 1));
    start.extend(row([0.5, 2.75], [-1.2, 2.75], [0.0, 1.0], 5));
    start.extend(row([-1.3, 2.8], [-0.4, 1.3], [-1.0, 0.0], 30));
    start.extend(row([-0.4, 1.3], [-0.4, 0.5], [-1.0, 0.0], 12));
    start.extend(row([-0.5, 0.5], [0.0, 0.0], [-1.0, 1.0], 1));
    let direct = Direct::new(&Swimmer::robot(), 2.8, start).climb();
    assert!(
        (direct - gait.displacement_over_length).abs() < 1e-6,
        "{direct} {}",
        gait.displacement_over_length
    );
}

/// The samples: a closed curve at constant power that a file keeps exactly.
#[test]
fn the_samples_are_a_gait_at_constant_power() {
    let gait = optimum(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8));
    let model = swimmer_model::Model::new(&Swimmer::robot()).unwrap();
    let stroke = swim(&model, &gait.gait().unwrap(), &Tolerance::default());
    assert!((stroke.displacement.x - gait.displacement).abs() < 1e-10);
    assert!((stroke.efficiency() / stroke.efficiency_constant_power() - 1.0).abs() < 1e-6);
    let file = gait.gait_file("robot");
    let back = GaitFile::parse(&file.to_text(), std::path::Path::new("b.gait")).unwrap();
    assert_eq!(back, file);
    assert_eq!(file.arcs.len(), 9, "{:?}", file.arcs);
    assert!(
        file.arcs
            .windows(2)
            .all(|pair| pair[0].to.to_bits() == pair[1].from.to_bits())
    );
}

/// Lengths and drag only scale.
#[test]
fn the_optimum_does_not_depend_on_units() {
    let mut large = Swimmer::robot();
    large.links.middle *= 10.0;
    large.links.front *= 10.0;
    large.links.back *= 10.0;
    large.sphere_radius *= 10.0;
    let small = optimum(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8));
    let large = optimum(&DisplacementProblem::new(large).with_max_angle(2.8));
    assert!((small.displacement_over_length - large.displacement_over_length).abs() < 1e-12);
}

#[test]
fn impossible_problems_are_named() {
    let mut lopsided = Swimmer::purcell();
    lopsided.links.back = 0.9;
    let ask = |problem: DisplacementProblem| displacement(&problem).unwrap_err();
    assert!(matches!(
        ask(DisplacementProblem::new(lopsided)),
        DisplacementError::Asymmetric { .. }
    ));
    for max in [0.0, -1.0, f64::NAN, 7.0] {
        let error = ask(DisplacementProblem::new(Swimmer::purcell()).with_max_angle(max));
        assert!(
            matches!(
                error,
                DisplacementError::Bound {
                    name: "max_angle",
                    ..
                }
            ),
            "{max}"
        );
    }
    let broken = Swimmer {
        chi: -1.0,
        ..Swimmer::purcell()
    };
    assert!(matches!(
        ask(DisplacementProblem::new(broken)),
        DisplacementError::Swimmer(_)
    ));
}

/// Swimmers and bounds of all kinds: a certified gait or a reason. With a large sphere small loops carry backwards, and where
/// no circle or square goes forwards there need be no gait. Wide bounds can cut off a negative island that the best gait goes
/// round: then it touches its image along a diagonal. Wherever a circle or square goes forwards there is a gait, and none
/// is beaten by one.
#[test]
fn a_grid_of_swimmers_and_bounds() {
    let (mut forwards, mut refused, mut below) = (0, Vec::new(), Vec::new());
    for ratio in [0.3, 0.7, 1.0, 1.5, 3.0] {
        for chi in [1.3, 2.0, 3.6, 5.0] {
            for sphere in [0.0, 0.5, 1.2] {
                for max_angle in [1.0, 1.8, 2.4, 3.0] {
                    let swimmer = Swimmer {
                        links: Links {
                            middle: ratio,
                            front: 1.0,
                            back: 1.0,
                        },
                        chi,
                        tangential_drag: TangentialDrag::LogAspect(4.0),
                        sphere_radius: sphere * ratio,
                    };
                    let name =
                        format!("l0/l1 {ratio}, chi {chi}, sphere {sphere} l0, within {max_angle}");
                    let best = best_simple_gait(&swimmer, max_angle);
                    forwards += usize::from(best > 0.0);
                    match displacement(&DisplacementProblem::new(swimmer).with_max_angle(max_angle))
                    {
                        Ok(gait) => {
                            assert!(gait.certificate.pass() && gait.displacement > 0.0, "{name}");
                            if gait.displacement_over_length < best - 1e-9 {
                                below.push(format!(
                                    "{name}: {} < {best}",
                                    gait.displacement_over_length
                                ));
                            }
                        }
                        Err(error) => {
                            assert!(
                                matches!(error, DisplacementError::NoOptimum { .. }),
                                "{name}: {error}"
                            );
                            if best > 0.0 {
                                refused.push(format!("{name}: {error}"));
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(forwards > 150, "{forwards}");
    assert!(refused.is_empty(), "of {forwards}:\n{}", refused.join("\n"));
    assert!(below.is_empty(), "of {forwards}:\n{}", below.join("\n"));
}

/// The gaits (c) and (d), from the same search: their ratios to (b) are the paper's 1.55, 2.04 and 1.31.
#[test]
fn lower_bound_and_sector() {
    let within = DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8);
    let b = optimum(&within);
    let mut problem = within;
    problem.bounds.min_angle = Some(1.5);
    let c = optimum(&problem);
    assert_eq!(
        kinds(&c)[1..],
        [
            ArcKind::Upper,
            ArcKind::Singular,
            ArcKind::Lower,
            ArcKind::Singular,
            ArcKind::Upper
        ]
    );
    let mut problem = within;
    problem.bounds.sector = true;
    let d = optimum(&problem);
    assert!(kinds(&d).contains(&ArcKind::Diagonal), "{:?}", d.arcs);
    let ratio =
        |a: &OptimalGait, b: &OptimalGait| a.displacement_over_length / b.displacement_over_length;
    assert!((ratio(&c, &b) + 1.55).abs() < 0.0155, "{}", ratio(&c, &b));
    assert!((ratio(&d, &b) + 2.04).abs() < 0.0204, "{}", ratio(&d, &b));
    assert!((ratio(&d, &c) - 1.31).abs() < 0.0131, "{}", ratio(&d, &c));
}

/// What is left of the gaits (b), (c) and (d) when links may not cross: (b) is untouched, (c) and (d) run along the bound.
#[test]
fn the_papers_gaits_without_crossing_links() {
    let within = DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8);
    let mut lower = within;
    lower.bounds.min_angle = Some(1.5);
    let mut sector = within;
    sector.bounds.sector = true;
    let apart = |mut problem: DisplacementProblem, clearance| {
        problem.bounds.no_overlap = true;
        problem.bounds.clearance = clearance;
        optimum(&problem)
    };
    let b = optimum(&within).displacement_over_length;
    assert!((apart(within, 0.0).displacement_over_length - b).abs() < 1e-13);
    let mut last = [f64::NEG_INFINITY; 2];
    for clearance in [0.0, 0.002, 0.005, 0.01, 0.02] {
        for (problem, last) in [lower, sector].into_iter().zip(&mut last) {
            let free = optimum(&problem).displacement_over_length;
            let gait = apart(problem, clearance);
            assert!(gait.certificate.pass());
            assert!(kinds(&gait).contains(&ArcKind::Clearance));
            assert!(gait.links_cross.abs() < 1e-15, "{}", gait.links_cross);
            let x = gait.displacement_over_length;
            assert!(
                free < x && x < -0.05 && x > *last,
                "{clearance}: {x} {last}"
            );
            *last = x;
        }
    }
}

/// Largest X over L of circles and squares within the bound, up to the first maximum over the amplitude.
fn best_simple_gait(swimmer: &Swimmer<f64>, max_angle: f64) -> f64 {
    let model = swimmer_model::Model::new(swimmer).unwrap();
    let swum = |gait: &AnyGait| {
        swim(&model, gait, &Tolerance::new(1e-9)).displacement.x / swimmer.total_length()
    };
    let mut best: f64 = 0.0;
    for shape in [AnyGait::circle, AnyGait::square] {
        let mut last = 0.0;
        for step in 1..=20 {
            let x = swum(&shape(max_angle * f64::from(step) / 20.0));
            if x < last {
                break;
            }
            last = x;
            best = best.max(x);
        }
    }
    best
}
