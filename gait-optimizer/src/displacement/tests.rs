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
    }
}

/// A drag that is the same in all directions moves nothing, and what is left of the height is rounding.
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

/// Nearly isotropic drag moves the swimmer nearly in proportion to what is left.
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

/// Between rounding and a little a gait may be refused, but what is found is in proportion to what is left, and nothing is
/// followed without end.
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

/// What optimises and what certifies mean the same gaits, also where these touch their own images.
#[test]
fn gaits_that_touch_their_images_certify_from_their_file() {
    let mut touching = 0;
    for max_angle in [1.3, 1.6, 1.9, 2.2, 2.7, 2.8, 3.0] {
        let swimmer = three_links(0.5);
        let problem = DisplacementProblem::new(swimmer).with_max_angle(max_angle);
        let Ok(gait) = displacement(&problem) else {
            continue;
        };
        let runs_along = |arc: &crate::Arc| arc.kind == ArcKind::Diagonal;
        let touches = gait.arcs.iter().any(runs_along);
        touching += usize::from(touches);
        assert_eq!(gait.bounds.sector, touches);
        let certificate = gait.certify().unwrap();
        assert!(
            certificate.pass(),
            "{max_angle}: {}",
            certificate.failures()
        );
    }
    assert_eq!(touching, 7);
}

/// A swimmer with L of its own and side links alike.
pub(super) fn with(middle: f64, chi: f64) -> Swimmer<f64> {
    let mut swimmer = three_links(chi);
    swimmer.links.middle = middle;
    swimmer
}

/// What fits within a bound fits within a larger one, so the best that is known never falls: either the gait found carries
/// farther, or the answer says that it is outdone. Gaits of the swimmers that gain at the straight shape are never outdone.
#[test]
fn the_best_known_grows_with_the_bound() {
    let swimmers = [
        Swimmer::robot(),
        Swimmer::purcell(),
        three_links(2.0),
        three_links(5.0),
        three_links(0.5),
        with(2.0, 0.5),
        with(0.5, 2.0),
    ];
    let mut outdone = 0;
    for swimmer in swimmers {
        let mut best = 0.0;
        for step in 0..=17 {
            let max_angle = 1.3 + 0.1 * f64::from(step);
            let problem = DisplacementProblem::new(swimmer).with_max_angle(max_angle);
            let (found, farther) = match displacement(&problem) {
                Ok(gait) => (gait.displacement_over_length, gait.outdone_over_length),
                Err(DisplacementError::NoOptimum { outdone, .. }) => (0.0, outdone),
                Err(other) => panic!("{max_angle}: {other}"),
            };
            let known = found.max(farther.unwrap_or(0.0));
            assert!(
                known > best - 1e-9,
                "{swimmer:?} {max_angle}: {known} {best}"
            );
            assert!(farther.is_none() || swimmer.chi < 1.0, "{swimmer:?}");
            outdone += usize::from(farther.is_some());
            best = known;
        }
    }
    assert!(outdone > 0);
}

/// Round shapes that lie off all bounds, by a slit along φ₁ = −φ₂: farther than the bounds alone, which were the answer once.
#[test]
fn a_slit_leads_to_shapes_off_the_bounds() {
    let problem = DisplacementProblem::new(three_links(0.5)).with_max_angle(2.7);
    let gait = displacement(&problem).unwrap();
    let kinds: Vec<_> = gait.arcs.iter().map(|arc| arc.kind).collect();
    let [singular, upper, diagonal] = [ArcKind::Singular, ArcKind::Upper, ArcKind::Diagonal];
    assert_eq!(kinds, [singular, upper, diagonal, singular, diagonal]);
    let model = Model::new(&three_links(0.5).of_unit_length()).unwrap();
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    let (around, _) = best(&problem, &model, (&problem.bounds, &region));
    assert!(gait.displacement_over_length > 1.3 * around.unwrap().displacement_over_length);
}
