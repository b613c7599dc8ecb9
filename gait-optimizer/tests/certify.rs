//! Certificates from the curve alone: every optimum passes, nothing else does.

use gait_optimizer::{
    AtlasProblem, Bounds, Branch, Certificate, DisplacementProblem, EfficiencyProblem, Heading,
    Objective, SidewaysProblem, TurningProblem, atlas, certify, displacement, efficiency, sideways,
    turning,
};
use nalgebra::Vector2;
use std::path::Path;
use swimmer_files::{AnyGait, ArcKind, GaitArc, GaitFile};
use swimmer_model::{Links, Swimmer};

fn certificate(swimmer: &Swimmer<f64>, file: &GaitFile) -> Certificate {
    certify(swimmer, file, file.objective, &file.bounds).unwrap()
}

fn show(certificate: &Certificate) {
    for check in certificate.checks() {
        println!(
            "{:32} {:10.2e} {:10.1e} {}",
            check.name, check.value, check.tolerance, check.pass
        );
    }
}

/// The four displacement gaits of the paper, and the other sign of each.
fn displacement_gaits() -> Vec<(Swimmer<f64>, GaitFile)> {
    let mut gaits = Vec::new();
    for (swimmer, max, min, sector) in [
        (Swimmer::purcell(), None, None, false),
        (Swimmer::robot(), Some(2.8), None, false),
        (Swimmer::robot(), Some(2.8), Some(1.5), false),
        (Swimmer::robot(), Some(2.8), None, true),
        (Swimmer::robot(), Some(1.2), None, false),
    ] {
        for heading in [Heading::Forwards, Heading::Backwards] {
            let problem = DisplacementProblem {
                bounds: Bounds {
                    max_angle: max,
                    min_angle: min,
                    sector,
                    ..Bounds::default()
                },
                heading: Some(heading),
                ..DisplacementProblem::new(swimmer)
            };
            if let Ok(gait) = displacement(&problem) {
                gaits.push((swimmer, gait.gait_file("a swimmer")));
            }
        }
    }
    // Along the bound that keeps links apart, and past its corner.
    for (swimmer, sector, heading) in [
        (Swimmer::robot_slender(), false, Heading::Backwards),
        (Swimmer::robot(), true, Heading::Backwards),
        (Swimmer::purcell(), false, Heading::Forwards),
    ] {
        let problem = DisplacementProblem {
            bounds: Bounds {
                max_angle: Some(2.8),
                sector,
                no_overlap: true,
                ..Bounds::default()
            },
            heading: Some(heading),
            ..DisplacementProblem::new(swimmer)
        };
        gaits.push((
            swimmer,
            displacement(&problem).unwrap().gait_file("a swimmer"),
        ));
    }
    assert!(gaits.len() >= 9, "{}", gaits.len());
    gaits
}

#[test]
fn every_displacement_gait_passes() {
    for (swimmer, file) in displacement_gaits() {
        let certificate = certificate(&swimmer, &file);
        println!("{:?} {:?}", file.bounds, certificate.pass());
        show(&certificate);
        assert!(
            certificate.pass(),
            "{:?}: {}",
            file.bounds,
            certificate.failures()
        );
        // Written, read, run the other way, or told without its arcs, it is the same gait.
        let read = GaitFile::parse(&file.to_text(), Path::new("g")).unwrap();
        assert_eq!(self::certificate(&swimmer, &read), certificate);
        let clockwise = self::certificate(&swimmer, &file.reversed());
        assert!(
            clockwise.pass(),
            "{:?}: {}",
            file.bounds,
            clockwise.failures()
        );
        let silent = GaitFile {
            arcs: Vec::new(),
            ..file.clone()
        };
        let silent = self::certificate(&swimmer, &silent);
        assert!(silent.pass(), "{:?}: {}", file.bounds, silent.failures());
    }
}

/// A loop with bounds all round but for a sliver across a corner: there all pushes are one, which turns.
#[test]
fn a_sliver_between_bounds_leads_nowhere() {
    let problem = AtlasProblem {
        bounds: Bounds {
            max_angle: Some(2.45),
            ..Bounds::default()
        },
        starts: 4,
        ..AtlasProblem::new(Swimmer::purcell(), Objective::Displacement)
    };
    let found = atlas(&problem).unwrap();
    let mut slivers = 0;
    for one in &found.optima {
        let file = one.gait.gait_file("purcell");
        let brief = |arc: &GaitArc| arc.kind == ArcKind::Singular && arc.to - arc.from < 1e-6;
        slivers += file.arcs.iter().filter(|arc| brief(arc)).count();
        let certificate = certificate(&Swimmer::purcell(), &file);
        assert!(certificate.pass(), "{}", certificate.failures());
    }
    assert!(slivers > 0);
}

/// Pushed in by a thousandth of a radian, so that no bound notices.
fn bumped(file: &GaitFile, centre: f64) -> GaitFile {
    let push = |(phi, u): (&Vector2<f64>, &f64)| {
        let bump = 1e-3 * (-((u - centre) / 0.01).powi(2)).exp();
        phi - phi.try_normalize(1e-9).unwrap_or_default() * bump
    };
    GaitFile {
        phi: file.phi.iter().zip(&file.u).map(push).collect(),
        ..file.clone()
    }
}

#[test]
fn a_bump_fails() {
    for (swimmer, file) in displacement_gaits() {
        for centre in [0.03, 0.11, 0.2, 0.45, 0.77] {
            let bumped = bumped(&file, centre);
            let certificate = certificate(&swimmer, &bumped);
            assert!(!certificate.pass(), "{:?} at {centre}", file.bounds);
        }
    }
}

/// Small and large Lighthill gaits of both swimmers, written, read and run the other way; with a bump they fail.
#[test]
fn every_efficiency_gait_passes() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        for branch in [Branch::Small, Branch::Large] {
            let gait = efficiency(&EfficiencyProblem::new(swimmer, branch)).unwrap();
            let file = gait.gait_file("a swimmer");
            let certificate = certificate(&swimmer, &file);
            println!("{branch}");
            show(&certificate);
            assert!(certificate.pass(), "{branch}: {}", certificate.failures());
            let read = GaitFile::parse(&file.to_text(), Path::new("g")).unwrap();
            assert_eq!(self::certificate(&swimmer, &read), certificate);
            let clockwise = self::certificate(&swimmer, &file.reversed());
            assert!(clockwise.pass(), "{branch}: {}", clockwise.failures());
            for centre in [0.03, 0.2, 0.77] {
                let bumped = bumped(&file, centre);
                assert!(
                    !self::certificate(&swimmer, &bumped).pass(),
                    "{branch} at {centre}"
                );
            }
            // What is best for efficiency is not best for displacement.
            let other = certify(&swimmer, &file, Objective::Displacement, &Bounds::default());
            assert!(!other.unwrap().pass());
        }
    }
}

/// Bounded Lighthill gaits, the one bent round the corner of the forbidden shapes among them.
#[test]
fn bounded_efficiency_gaits_pass() {
    let bounds = |max_angle, no_overlap| Bounds {
        max_angle,
        no_overlap,
        ..Bounds::default()
    };
    for (swimmer, branch, bounds) in [
        (Swimmer::purcell(), Branch::Large, bounds(Some(2.8), false)),
        (Swimmer::purcell(), Branch::Large, bounds(None, true)),
        (Swimmer::robot(), Branch::Small, bounds(Some(1.2), false)),
    ] {
        let problem = EfficiencyProblem {
            bounds,
            ..EfficiencyProblem::new(swimmer, branch)
        };
        let file = efficiency(&problem).unwrap().gait_file("a swimmer");
        let certificate = certificate(&swimmer, &file);
        assert!(certificate.pass(), "{bounds:?}: {}", certificate.failures());
        for centre in [0.03, 0.2] {
            let bumped = self::certificate(&swimmer, &bumped(&file, centre));
            assert!(!bumped.pass(), "{bounds:?} at {centre}");
        }
    }
}

/// The loops that turn most; the border of Purcell's has a corner where two zero-level curves cross.
#[test]
fn turning_gaits_pass() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        let bounds = Bounds {
            max_angle: Some(2.8),
            no_overlap: true,
            ..Bounds::default()
        };
        let file = turning(&TurningProblem { swimmer, bounds })
            .unwrap()
            .gait
            .gait_file("a swimmer");
        let certificate = certificate(&swimmer, &file);
        assert!(certificate.pass(), "{}", certificate.failures());
        assert!(!self::certificate(&swimmer, &bumped(&file, 0.2)).pass());
    }
}

#[test]
fn circles_and_squares_fail() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        for amplitude in [0.3, 1.2, 1.633_162_5, 3.0] {
            for gait in [
                AnyGait::circle(amplitude),
                AnyGait::circle(amplitude).reversed_if(true),
            ] {
                for objective in [
                    Objective::Displacement,
                    Objective::Efficiency,
                    Objective::Turning,
                ] {
                    let file = GaitFile::sampled(&gait, 512);
                    let certificate =
                        certify(&swimmer, &file, objective, &Bounds::default()).unwrap();
                    assert!(!certificate.pass(), "{objective} {amplitude}");
                }
            }
        }
    }
}

/// A quarter of the samples: the tolerance follows, and the gait still passes.
#[test]
fn sparse_samples_are_enough_or_say_so() {
    let gait = displacement(&DisplacementProblem {
        quarter_samples: 48,
        ..DisplacementProblem::new(Swimmer::purcell())
    })
    .unwrap();
    let file = gait.gait_file("purcell");
    let passes = certificate(&Swimmer::purcell(), &file);
    show(&passes);
    assert!(passes.pass(), "{}", passes.failures());
    let few: Vec<usize> = (0..file.u.len()).step_by(16).collect();
    let sparse = GaitFile {
        u: few.iter().map(|&i| file.u[i]).collect(),
        phi: few
            .iter()
            .map(|&i| file.phi[i])
            .collect::<Vec<Vector2<f64>>>(),
        arcs: Vec::new(),
        ..file
    };
    let refused = certificate(&Swimmer::purcell(), &sparse);
    assert!(!refused.pass());
    assert!(
        refused.failures().contains("sampling"),
        "{}",
        refused.failures()
    );
}

/// Swimmers with a short middle link race through some shapes, and their gaits have as many samples as the certificate from the
/// file asks for.
#[test]
fn gaits_of_short_middle_links_are_sampled_as_closely_as_is_asked() {
    let with = |middle| Swimmer {
        links: Links {
            middle,
            front: 1.0,
            back: 1.0,
        },
        ..Swimmer::purcell()
    };
    let mut finer = 0;
    for middle in [0.02, 0.05, 0.1, 1.0] {
        let swimmer = with(middle);
        let gait = displacement(&DisplacementProblem::new(swimmer)).unwrap();
        let file = gait.gait_file("short");
        let certificate = certify(&swimmer, &file, file.objective, &file.bounds).unwrap();
        assert!(certificate.pass(), "{middle}: {}", certificate.failures());
        finer += usize::from(file.u.len() > 1024);
    }
    assert_eq!(finer, 2);
    let swimmer = with(0.1);
    let gait = sideways(&SidewaysProblem {
        bounds: Bounds {
            max_angle: Some(2.5),
            ..Bounds::default()
        },
        starts: 6,
        ..SidewaysProblem::new(swimmer)
    })
    .unwrap()
    .gait;
    let file = gait.gait_file("short");
    let certificate = certify(&swimmer, &file, file.objective, &file.bounds).unwrap();
    assert!(certificate.pass(), "{}", certificate.failures());
}
