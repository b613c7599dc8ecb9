//! Three verdicts: what a gait's samples cannot decide is told from what is wrong.

use gait_optimizer::{
    Bounds, Branch, CertifyError, DisplacementProblem, EfficiencyProblem, Heading, TurningProblem,
    Verdict, certify, displacement, efficiency, turning,
};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{GaitArc, GaitFile};
use swimmer_model::Swimmer;

/// Optima of three objectives, bounds of every kind.
fn gaits() -> Vec<(String, Swimmer<f64>, GaitFile)> {
    let mut gaits = Vec::new();
    for (name, swimmer) in [("purcell", Swimmer::purcell()), ("robot", Swimmer::robot())] {
        for (max, min, sector, no_overlap) in [
            (None, None, false, false),
            (Some(2.8), None, false, false),
            (Some(1.2), None, false, false),
            (Some(2.8), Some(1.5), false, false),
            (Some(2.8), None, true, false),
            (Some(2.8), None, false, true),
        ] {
            let bounds = Bounds {
                max_angle: max,
                min_angle: min,
                sector,
                no_overlap,
                ..Bounds::default()
            };
            for heading in [Heading::Forwards, Heading::Backwards] {
                let problem = DisplacementProblem {
                    bounds,
                    heading: Some(heading),
                    ..DisplacementProblem::new(swimmer)
                };
                if let Ok(gait) = displacement(&problem) {
                    gaits.push((
                        format!("{name} displacement {bounds} {heading:?}"),
                        swimmer,
                        gait.gait_file(name),
                    ));
                }
            }
            if min.is_some() || sector {
                continue;
            }
            for branch in [Branch::Small, Branch::Large] {
                let problem = EfficiencyProblem {
                    bounds,
                    ..EfficiencyProblem::new(swimmer, branch)
                };
                if let Ok(gait) = efficiency(&problem) {
                    gaits.push((
                        format!("{name} efficiency {bounds} {branch}"),
                        swimmer,
                        gait.gait_file(name),
                    ));
                }
            }
            if let Ok(found) = turning(&TurningProblem { swimmer, bounds }) {
                gaits.push((
                    format!("{name} turning {bounds}"),
                    swimmer,
                    found.gait.gait_file(name),
                ));
            }
        }
    }
    gaits
}

fn rounded(file: &GaitFile, digits: i32) -> GaitFile {
    let scale = 10.0_f64.powi(digits);
    let round = |value: f64| (value * scale).round() / scale;
    GaitFile {
        u: file.u.iter().map(|&u| round(u)).collect(),
        phi: file.phi.iter().map(|phi| phi.map(round)).collect(),
        corners: file.corners.iter().map(|&u| round(u)).collect(),
        arcs: file
            .arcs
            .iter()
            .map(|arc| GaitArc {
                from: round(arc.from),
                to: round(arc.to),
                ..*arc
            })
            .collect(),
        ..file.clone()
    }
}

/// Begun at the knot nearest to a third of the cycle.
fn shifted(file: &GaitFile) -> GaitFile {
    let first = file.u.partition_point(|&u| u < 1.0 / 3.0);
    let by = file.u[first];
    let place = |u: f64| {
        let moved = u - by;
        if moved < 0.0 { moved + 1.0 } else { moved }
    };
    let last = file.u.len() - 1;
    let order = (first..last).chain(0..first);
    let mut u: Vec<f64> = order.clone().map(|at| place(file.u[at])).collect();
    let mut phi: Vec<_> = order.map(|at| file.phi[at]).collect();
    u.push(1.0);
    phi.push(phi[0]);
    let mut arcs = Vec::new();
    for arc in &file.arcs {
        if arc.from < by && by < arc.to {
            arcs.push(GaitArc {
                from: place(arc.from),
                to: 1.0,
                ..*arc
            });
            arcs.push(GaitArc {
                from: 0.0,
                to: place(arc.to),
                ..*arc
            });
        } else {
            let to = place(arc.to);
            arcs.push(GaitArc {
                from: place(arc.from),
                to: if to == 0.0 { 1.0 } else { to },
                ..*arc
            });
        }
    }
    arcs.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut corners: Vec<f64> = file.corners.iter().map(|&u| place(u)).collect();
    corners.sort_by(f64::total_cmp);
    corners.dedup();
    GaitFile {
        u,
        phi,
        arcs,
        corners,
        ..file.clone()
    }
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
        for (what, told) in [("as written", file.clone()), ("shifted", shifted(&file))] {
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
        let size = 10.0_f64.powf(rng.random_range(-4.0..-2.0));
        let (centre, width) = (rng.random_range(0.0..1.0), rng.random_range(0.01..0.1));
        let kind = rng.random_range(0..4);
        let mut perturbed = file.clone();
        let last = perturbed.u.len() - 1;
        for at in 0..=last {
            let (before, after) = (at.checked_sub(1).unwrap_or(last - 1), (at % last) + 1);
            let along = file.phi[after] - file.phi[before];
            let across = Vector2::new(-along.y, along.x).normalize();
            let away = (file.u[at] - centre + 0.5).rem_euclid(1.0) - 0.5;
            perturbed.phi[at] += match kind {
                0 => across * (-(away / width).powi(2)).exp(),
                1 => across * (0.5 + 0.5 * (std::f64::consts::TAU * away).sin()),
                2 => -file.phi[at],
                _ => across * rng.random_range(0.0..1.0),
            } * size;
        }
        perturbed.phi[last] = perturbed.phi[0];
        let certificate = certify(swimmer, &perturbed, file.objective, &file.bounds).unwrap();
        assert_eq!(
            certificate.verdict(),
            Verdict::Fail,
            "{name}, kind {kind}, size {size:e}, at {centre}, {width} wide: {}",
            certificate.failures()
        );
        asked += 1;
    }
}
