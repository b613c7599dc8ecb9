use super::*;
use swimmer_files::ArcKind;
use swimmer_model::Links;
use swimmer_model::TangentialDrag;

/// Three links without a sphere.
fn three_links(chi: f64) -> Swimmer<f64> {
    Swimmer {
        links: Links {
            middle: 1.0,
            front: 1.0,
            back: 1.0,
        },
        chi,
        tangential_drag: TangentialDrag::LogAspect(4.0),
        sphere_radius: 0.0,
        ..Swimmer::purcell()
    }
}

/// A drag that is the same in all directions moves nothing, and the height is pure rounding.
#[test]
fn isotropic_drag_has_no_gait() {
    for chi in [1.0, 1.0 + 1e-10, 1.0 - 1e-10] {
        for max_angle in [0.05, 2.8] {
            let problem = DisplacementProblem::new(three_links(chi)).with_max_angle(max_angle);
            let refused = displacement(&problem).unwrap_err().to_string();
            assert!(refused.contains("no gait moves this swimmer"), "{refused}");
        }
    }
}

/// Nearly isotropic drag moves the swimmer nearly in proportion to χ − 1.
#[test]
fn nearly_isotropic_drag_moves_a_little() {
    let of = |chi: f64| {
        let problem = DisplacementProblem::new(three_links(chi)).with_max_angle(1.2);
        displacement(&problem).unwrap().displacement_over_length
    };
    let (once, twice) = (of(1.001), of(1.002));
    assert!(
        once > 1e-6 && (twice / once - 2.0).abs() < 0.01,
        "{once} {twice}"
    );
}

/// Between rounding and weak anisotropy a gait may be refused, but displacements are in proportion to χ − 1, and no search runs
/// without end.
#[test]
fn what_is_found_beside_isotropic_drag_is_no_rounding() {
    let of = |off: f64| {
        let problem = DisplacementProblem::new(three_links(1.0 + off)).with_max_angle(1.2);
        displacement(&problem).map(|gait| gait.displacement_over_length / off)
    };
    let slope = of(1e-3).unwrap();
    for off in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, -1e-9, -1e-8] {
        let found = of(off);
        println!("{off:e} {found:?}");
        if let Ok(found) = found {
            assert!((found / slope - 1.0).abs() < 0.01, "{off}: {found} {slope}");
        }
    }
}

/// A simple gait keeps off the diagonals but for its ends; in the sector, where they are bounds, its certificate holds from its file
/// too.
#[test]
fn only_gaits_in_the_sector_run_along_a_diagonal() {
    let mut along = 0;
    for chi in [0.5, 2.0] {
        for max_angle in [1.6, 2.2, 2.8] {
            for heading in [Heading::Forwards, Heading::Backwards] {
                let free = DisplacementProblem::new(three_links(chi))
                    .with_max_angle(max_angle)
                    .heading(heading);
                let mut sector = free;
                sector.bounds.sector = true;
                let runs_along = |gait: &OptimalGait| {
                    let mut kinds = gait.arcs.iter().map(|arc| arc.kind);
                    kinds.any(|kind| kind == ArcKind::Diagonal)
                };
                assert!(!displacement(&free).is_ok_and(|gait| runs_along(&gait)));
                if let Ok(gait) = displacement(&sector) {
                    along += usize::from(runs_along(&gait));
                    let certificate = gait.certify().unwrap();
                    assert!(certificate.pass(), "{}", certificate.failures());
                }
            }
        }
    }
    assert!(along >= 3, "{along}");
}

/// A swimmer with L of its own and side links alike.
pub(super) fn with(middle: f64, chi: f64) -> Swimmer<f64> {
    let mut swimmer = three_links(chi);
    swimmer.links.middle = middle;
    swimmer
}

/// Either sense refuses, and so do both: the reason names none.
#[test]
fn neither_sense_has_an_optimum() {
    let free = DisplacementProblem::new(Swimmer::robot());
    let sent = |problem: &DisplacementProblem| match displacement(problem) {
        Err(DisplacementError::NoUnboundedOptimum { outcomes }) => outcomes.sent,
        other => panic!("{other:?}"),
    };
    let each = [Heading::Forwards, Heading::Backwards].map(|heading| sent(&free.heading(heading)));
    assert_eq!(sent(&free), each[0] + each[1]);
    let outcomes = ExtremalOutcomes::default();
    let no = |heading| DisplacementError::NoOptimum {
        heading: Some(heading),
        outcomes,
    };
    let neither = no(Heading::Forwards).or_backwards(no(Heading::Backwards));
    assert_eq!(
        neither,
        DisplacementError::NoOptimum {
            heading: None,
            outcomes
        }
    );
    // A gait that fails its certificate gives a more specific error than an empty search.
    let failed = DisplacementError::NotCertified {
        displacement_over_length: 0.1,
        failed: String::new(),
    };
    for reason in [
        failed.clone().or_backwards(no(Heading::Backwards)),
        no(Heading::Forwards).or_backwards(failed.clone()),
    ] {
        assert_eq!(reason, failed);
    }
}
