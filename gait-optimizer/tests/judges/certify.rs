//! Certificates from the curve alone: every optimum passes, nothing else does; and conditions that the samples leave undecided
//! are distinguished from failures.

use crate::changed;

use std::path::Path;

use changed::{Change, rounded};
use gait_optimizer::{
    AtlasProblem, Bounds, Branch, Certificate, CertifyError, DisplacementProblem,
    EfficiencyProblem, Heading, Objective, OptimalGait, SidewaysProblem, TurningProblem, Verdict,
    atlas, certify, displacement, efficiency, sideways, turning,
};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, ArcKind, GaitArc, GaitFile};
use swimmer_model::{Links, Swimmer};

fn certificate(swimmer: &Swimmer<f64>, file: &GaitFile) -> Certificate {
    certify(swimmer, file, file.objective, &file.bounds).unwrap()
}

/// A gait's name, whose it is and its file.
type NamedGait = (String, Swimmer<f64>, GaitFile);

fn told(gait: &OptimalGait) -> NamedGait {
    let OptimalGait {
        swimmer,
        objective,
        bounds,
        displacement,
        ..
    } = gait;
    let file = gait.gait_file("one");
    let name = format!("{swimmer:?} {objective} {bounds} {displacement:.3} m");
    (name, *swimmer, file)
}

/// Optima of three objectives, bounds of every kind.
fn gaits() -> Vec<NamedGait> {
    let mut gaits = Vec::new();
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        for (max_angle, min_angle, sector, no_overlap) in [
            (None, None, false, false),
            (Some(2.8), None, false, false),
            (Some(1.2), None, false, false),
            (Some(2.8), Some(1.5), false, false),
            (Some(2.8), None, true, false),
            (Some(2.8), None, false, true),
        ] {
            let bounds = Bounds {
                max_angle,
                min_angle,
                sector,
                no_overlap,
                ..Bounds::default()
            };
            gaits.extend([Heading::Forwards, Heading::Backwards].map(|heading| {
                displacement(&DisplacementProblem {
                    bounds,
                    heading: Some(heading),
                    ..DisplacementProblem::new(swimmer)
                })
                .ok()
            }));
            if min_angle.is_some() || sector {
                continue;
            }
            gaits.extend([Branch::Small, Branch::Large].map(|branch| {
                efficiency(&EfficiencyProblem {
                    bounds,
                    ..EfficiencyProblem::new(swimmer, branch)
                })
                .ok()
            }));
            let found = turning(&TurningProblem { swimmer, bounds });
            gaits.push(found.ok().map(|found| found.gait));
        }
    }
    gaits.iter().flatten().map(told).collect()
}

/// Gaits along the bound that keeps links apart, past its corner, and bent round that.
fn more_gaits() -> [NamedGait; 3] {
    let apart = Bounds::within(2.8).apart(0.0);
    let sector = Bounds {
        sector: true,
        ..apart
    };
    let backwards = |swimmer, bounds| {
        displacement(&DisplacementProblem {
            bounds,
            heading: Some(Heading::Backwards),
            ..DisplacementProblem::new(swimmer)
        })
    };
    let bent = efficiency(&EfficiencyProblem {
        bounds: Bounds::default().apart(0.0),
        ..EfficiencyProblem::new(Swimmer::purcell(), Branch::Large)
    });
    [
        backwards(Swimmer::robot_slender(), apart).unwrap(),
        backwards(Swimmer::robot(), sector).unwrap(),
        bent.unwrap(),
    ]
    .map(|gait| told(&gait))
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

/// Written, read, reversed, or (displacement) without its arcs, it is the same gait; with a bump it fails.
#[test]
fn every_optimum_passes_and_with_a_bump_fails() {
    let gaits = gaits();
    assert!(gaits.len() >= 38, "{}", gaits.len());
    for (name, swimmer, file) in gaits.into_iter().chain(more_gaits()) {
        let certificate = |file: &GaitFile| certificate(&swimmer, file);
        let passes = |what: &str, file: &GaitFile| {
            let certificate = certificate(file);
            assert!(
                certificate.pass(),
                "{name}, {what}: {}",
                certificate.failures()
            );
        };
        passes("as written", &file);
        let read = GaitFile::parse(&file.to_text(), Path::new("g")).unwrap();
        assert_eq!(certificate(&read), certificate(&file), "{name}");
        let free = file.bounds == Bounds::default();
        let centres: &[f64] = match file.objective {
            Objective::Displacement => &[0.03, 0.11, 0.2, 0.45, 0.77],
            Objective::Efficiency if free => &[0.03, 0.2, 0.77],
            Objective::Efficiency => &[0.03, 0.2],
            _ => &[0.2],
        };
        for &centre in centres {
            let bumped = certificate(&bumped(&file, centre));
            assert!(!bumped.pass(), "{name} with a bump at {centre}");
        }
        if file.objective != Objective::Turning {
            passes("clockwise", &file.reversed());
        }
        if file.objective == Objective::Displacement {
            let mut silent = file.clone();
            silent.arcs.clear();
            passes("silent", &silent);
        }
        if file.objective == Objective::Efficiency && free {
            // The best gait for efficiency is not the best for displacement.
            let other = certify(&swimmer, &file, Objective::Displacement, &file.bounds);
            assert!(!other.unwrap().pass(), "{name}");
        }
    }
}

/// A loop with bounds all round but for a sliver across a corner: there all pushes are one, which turns.
#[test]
fn a_sliver_between_bounds_leads_nowhere() {
    let problem = AtlasProblem {
        bounds: Bounds::within(2.45),
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

/// If the only bound is that links may not cross, gaits run close to the shape in which a side link lies on the middle one, at a
/// tiny distance, so that nothing crosses and every listed gait passes.
#[test]
fn gaits_that_fold_a_link_keep_it_off_the_middle_one() {
    let long_sides = Swimmer {
        links: Links {
            middle: 0.6,
            front: 1.0,
            back: 1.0,
        },
        ..Swimmer::purcell()
    };
    let bounds = Bounds::default().apart(0.0);
    let mut folded = 0;
    for swimmer in [Swimmer::purcell(), long_sides] {
        for objective in [Objective::Displacement, Objective::Efficiency] {
            let found = atlas(&AtlasProblem {
                bounds,
                starts: 6,
                order: 4,
                ..AtlasProblem::new(swimmer, objective)
            })
            .unwrap();
            for one in found.optima.iter().filter(|one| one.simple) {
                let certificate = certificate(&swimmer, &one.gait.gait_file(""));
                assert!(certificate.pass(), "{}", certificate.failures());
                assert!(one.gait.links_cross <= 0.0);
                let widest = one.gait.phi().iter().map(Vector2::amax);
                folded += usize::from(widest.fold(0.0, f64::max) > std::f64::consts::PI - 1e-3);
            }
        }
    }
    assert!(folded > 0);
}

#[test]
fn circles_and_squares_fail() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        for amplitude in [0.3, 1.2, 1.633_162_5, 3.0] {
            for clockwise in [false, true] {
                let gait = AnyGait::circle(amplitude).reversed_if(clockwise);
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
    assert!(passes.pass(), "{}", passes.failures());
    let few: Vec<usize> = (0..file.u.len()).step_by(16).collect();
    let sparse = GaitFile {
        u: few.iter().map(|&i| file.u[i]).collect(),
        phi: few.iter().map(|&i| file.phi[i]).collect(),
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

/// Swimmers with a short middle link move fast through some shapes, and their gaits have as many samples as the certificate from
/// the file needs.
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
        let certificate = gait.certify().unwrap();
        assert!(certificate.pass(), "{middle}: {}", certificate.failures());
        finer += usize::from(gait.u().len() > 1024);
    }
    assert_eq!(finer, 2);
    let swimmer = with(0.1);
    let problem = SidewaysProblem {
        bounds: Bounds::within(2.5),
        starts: 6,
        ..SidewaysProblem::new(swimmer)
    };
    let gait = sideways(&problem, &|_| ()).unwrap().gait;
    let certificate = gait.certify().unwrap();
    assert!(certificate.pass(), "{}", certificate.failures());
}

fn thinned(file: &GaitFile, by: usize) -> GaitFile {
    let fixed = |u: f64| {
        file.arcs
            .iter()
            .flat_map(|a| [a.from, a.to])
            .chain(file.corners.iter().copied())
            .chain([0.0, 0.25, 0.5, 0.75, 1.0])
            .any(|e| (e - u).abs() < 1e-12)
    };
    let kept: Vec<usize> = (0..file.u.len())
        .filter(|&at| at % by == 0 || fixed(file.u[at]))
        .collect();
    GaitFile {
        u: kept.iter().map(|&at| file.u[at]).collect(),
        phi: kept.iter().map(|&at| file.phi[at]).collect(),
        ..file.clone()
    }
}

#[test]
fn a_gait_passes_wherever_it_begins_and_is_never_failed_for_its_samples() {
    for (name, swimmer, file) in gaits() {
        let verdict = |file: &GaitFile| match certify(&swimmer, file, file.objective, &file.bounds)
        {
            Ok(certificate) => (certificate.verdict(), certificate.failures()),
            Err(CertifyError::TooFew { .. }) => (Verdict::Undecided, String::new()),
            Err(error) => panic!("{name}: {error}"),
        };
        // Begun at the knot nearest to a third of the cycle.
        let shifted = file.begun_at(file.u.partition_point(|&u| u < 1.0 / 3.0));
        for (what, told) in [("as written", file.clone()), ("shifted", shifted)] {
            let (said, why) = verdict(&told);
            assert_eq!(said, Verdict::Pass, "{name}, {what}: {why}");
        }
        let mut undecided = 0;
        for told in [9, 6]
            .map(|digits| rounded(&file, digits))
            .into_iter()
            .chain([4, 16, 32].map(|by| thinned(&file, by)))
        {
            let (said, why) = verdict(&told);
            assert_ne!(
                said,
                Verdict::Fail,
                "{name}, {} samples: {why}",
                told.u.len()
            );
            undecided += usize::from(said == Verdict::Undecided);
        }
        assert!(
            undecided > 0,
            "{name}: a thirty-second of its samples decides"
        );
    }
}

/// Smooth waves and bumps, another size, and noise at every sample, all at full precision.
#[test]
fn perturbed_gaits_fail_for_certain() {
    let mut rng = ChaCha8Rng::seed_from_u64(20_261_123);
    let gaits = gaits();
    let mut asked = 0;
    while asked < 100 {
        let (name, swimmer, file) = &gaits[rng.random_range(0..gaits.len())];
        let change = Change::drawn(&mut rng);
        let kind = rng.random_range(0..Change::KINDS);
        let perturbed = change.of(file, kind, &mut rng);
        let certificate = certify(swimmer, &perturbed, file.objective, &file.bounds).unwrap();
        assert_eq!(
            certificate.verdict(),
            Verdict::Fail,
            "{name}, kind {kind}, {change:?}: {}",
            certificate.failures()
        );
        asked += 1;
    }
}
