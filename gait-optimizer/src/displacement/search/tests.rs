use super::*;
use crate::certificate::{Condition, turning_number};
use crate::displacement::best::candidates;
use crate::displacement::start_family::families;
use crate::displacement::tests::with;
use crate::displacement::{DisplacementProblem, Heading, certified};
use swimmer_files::{ArcKind, Bounds};
use swimmer_model::Swimmer;

/// If λ₃ x is larger for neighbouring extremals of a candidate, the second variation of its samples must agree, and vice versa:
/// two independent methods for the same verdict. One extremal is not a maximum: l₀ = l₁/2, χ = 1.2, backwards from 2.455 rad
/// within 6.2 rad; it must fail.
#[test]
fn the_second_variation_agrees_with_the_neighbours() {
    let (mut maxima, mut others) = (0, 0);
    for ratio in [0.5, 1.0, 2.5] {
        for chi in [1.2, 2.0, 3.6] {
            for (sphere, max_angle) in [(0.0, 3.0), (0.5, 2.8), (1.0, 3.0), (0.0, 6.2)] {
                let swimmer = Swimmer {
                    sphere_radius: sphere * ratio,
                    ..with(ratio, chi)
                }
                .of_unit_length();
                let model = Model::new(&swimmer).unwrap();
                let bounds = Bounds::within(max_angle);
                let region = Region::new(&bounds, &swimmer.links);
                let mut problem = DisplacementProblem::new(swimmer);
                problem.bounds = bounds;
                for sign in [1.0, -1.0] {
                    let search = Search {
                        model: &model,
                        region: &region,
                        sign,
                    };
                    let flow = search.flow(0.0, Motion::Singular);
                    for family in families(flow, &bounds, &region) {
                        let (found, _) =
                            search.candidates(std::slice::from_ref(&family), SCAN_POINTS, &|_| ());
                        for candidate in found {
                            let Some(gain) = neighbour_gain(&search, &family, &candidate) else {
                                continue;
                            };
                            let gait = certified(&problem, &model, &candidate).unwrap();
                            let up = gait.certificate.value(Condition::NoAscent).unwrap();
                            if gain < 0.0 {
                                maxima += 1;
                                assert!(up == 0.0, "{swimmer:?} {gain} {up}");
                            } else {
                                others += 1;
                                assert!(up > 0.0, "{swimmer:?} {gain} {up}");
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(maxima >= 40 && others >= 1, "{maxima} {others}");
}

/// The larger gain in λ₃ x of the two neighbours of a candidate on its family. Returns `None` if it is not on the family, or if
/// neither neighbour ends.
fn neighbour_gain(search: &Search<'_>, family: &StartFamily, candidate: &Candidate) -> Option<f64> {
    const BESIDE: f64 = 1e-3;
    let first = candidate
        .quarter
        .legs
        .iter()
        .find(|leg| leg.motion == Motion::Singular)?;
    let p = match family {
        StartFamily::StartLine { .. } => first.from[0],
        StartFamily::Bounds { .. } => candidate
            .quarter
            .legs
            .iter()
            .take_while(|leg| leg.motion != Motion::Singular)
            .map(|leg| leg.length)
            .sum(),
        StartFamily::EndLine { .. } => return None,
    };
    let x = |p: f64| {
        let line = QuarterBranch {
            family,
            touch: Touch::Ends,
        };
        Some(search.miss(line, p, FINE)?.carried)
    };
    let here = x(p)?;
    Some(x(p - BESIDE)?.max(x(p + BESIDE)?) - here)
}

fn runs_along_a_diagonal(candidate: &Candidate) -> bool {
    let mut kinds = nonempty_legs(&candidate.quarter.legs).map(|leg| leg.motion.kind());
    kinds.any(|kind| kind == ArcKind::Diagonal)
}

/// Quarters that touch their images and are kept go round once: what winds or crosses itself is given up where it does.
#[test]
fn what_touches_its_images_goes_round_once() {
    let mut touching = 0;
    for chi in [0.5, 2.0, 3.6] {
        for (middle, max_angle) in [(0.5, 2.8), (1.0, 2.2), (1.0, 3.0), (2.5, 2.8)] {
            let swimmer = with(middle, chi).of_unit_length();
            let model = Model::new(&swimmer).unwrap();
            let bounds = Bounds {
                sector: true,
                ..Bounds::within(max_angle)
            };
            let region = Region::new(&bounds, &swimmer.links);
            for heading in [Heading::Forwards, Heading::Backwards] {
                let of = (&model, &region);
                let (found, _) = candidates(&bounds, heading, of, SCAN_POINTS, &|_| ());
                for candidate in found {
                    let cycle = candidate.cycle(&model, 64).unwrap();
                    let turns = turning_number(&cycle.phi);
                    assert!((turns - 1.0).abs() < 1e-9, "{swimmer:?} {bounds:?} {turns}");
                    touching += usize::from(runs_along_a_diagonal(&candidate));
                }
            }
        }
    }
    assert!(touching >= 20, "{touching}");
}
