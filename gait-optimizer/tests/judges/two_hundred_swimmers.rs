//! Swimmers and bounds of all kinds with every objective but displacement (see `displacement.rs`): a certified gait or a reason,
//! never a wrong gait, a hang or a panic.

use crate::swimmers;

use std::collections::BTreeMap;
use std::fmt::{Debug, Display};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use gait_optimizer::{
    AtlasProblem, Branch, EfficiencyProblem, Objective, OptimalGait, SidewaysProblem, SpeedProblem,
    TurningProblem, atlas, certify, efficiency, fastest, sideways, turning,
};
use nalgebra::Vector2;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Model, Tolerance, swim};
use swimmers::{Apart, Case};

/// The seed of the swimmers in the displacement tests.
const SEED: u64 = 20_260_703;
/// A case that takes longer hangs.
const PATIENCE: Duration = Duration::from_mins(1);

/// Result of a solver.
enum SolverOutcome {
    Gaits(Vec<OptimalGait>),
    Reason { kind: String, text: String },
    Wrong(String),
}

impl SolverOutcome {
    /// The reason's kind is the name of its variant.
    fn refused(error: &(impl Display + Debug)) -> Self {
        let kind = format!("{error:?}");
        let end = kind
            .find(|c: char| !c.is_alphanumeric())
            .unwrap_or(kind.len());
        Self::Reason {
            kind: kind[..end].to_owned(),
            text: error.to_string(),
        }
    }
}

fn most_efficient(case: &Case, branch: Branch) -> SolverOutcome {
    let problem = EfficiencyProblem {
        bounds: case.bounds,
        ..EfficiencyProblem::new(case.swimmer, branch)
    };
    let gait = match efficiency(&problem) {
        Ok(gait) => gait,
        Err(error) if error.is_bad_input() => {
            return SolverOutcome::Wrong(format!("bad input: {error}"));
        }
        Err(error) => return SolverOutcome::refused(&error),
    };
    // A size smaller is allowed by the bounds, and worse.
    let phi: Vec<_> = gait.phi().iter().map(|phi| phi * 0.99).collect();
    let corners: Vec<usize> = gait
        .corners()
        .iter()
        .filter_map(|corner| {
            gait.u()
                .iter()
                .position(|u| u.to_bits() == corner.to_bits())
        })
        .collect();
    let smaller = AnyGait::from_samples(gait.u(), &phi, &corners).unwrap();
    let model = Model::new(&case.swimmer).unwrap();
    let other = swim(&model, &smaller, &Tolerance::new(1e-9)).efficiency_constant_power();
    let signed = match branch {
        Branch::Small => gait.displacement,
        Branch::Large => -gait.displacement,
    };
    if signed <= 0.0 {
        return SolverOutcome::Wrong(format!("{branch} gait with X = {} m", gait.displacement));
    }
    if other > gait.efficiency {
        return SolverOutcome::Wrong(format!(
            "0.99 of its size has efficiency {other}, itself {}",
            gait.efficiency
        ));
    }
    SolverOutcome::Gaits(vec![gait])
}

fn most_turning(case: &Case) -> SolverOutcome {
    match turning(&TurningProblem {
        swimmer: case.swimmer,
        bounds: case.bounds,
    }) {
        Ok(found) if found.gait.rotation > 0.0 => SolverOutcome::Gaits(vec![found.gait]),
        Ok(found) => SolverOutcome::Wrong(format!("turns {} rad", found.gait.rotation)),
        Err(error) => SolverOutcome::refused(&error),
    }
}

/// With few starts.
fn most_sideways(case: &Case) -> SolverOutcome {
    let problem = SidewaysProblem {
        bounds: case.bounds,
        starts: 4,
        ..SidewaysProblem::new(case.swimmer)
    };
    match sideways(&problem, &|_| ()) {
        Ok(found) => {
            let own = found.gait.lateral_over_length.abs() - found.lateral_over_length;
            if own.abs() > 1e-12 || found.lateral_over_length <= 0.0 {
                return SolverOutcome::Wrong(format!(
                    "|Y|/L = {}, its gait {}",
                    found.lateral_over_length, found.gait.lateral_over_length
                ));
            }
            SolverOutcome::Gaits(vec![found.gait])
        }
        Err(error) => SolverOutcome::refused(&error),
    }
}

/// With few starts; every optimum counts.
fn small_atlas(case: &Case, objective: Objective) -> SolverOutcome {
    let problem = AtlasProblem {
        bounds: case.bounds,
        starts: 4,
        order: 4,
        ..AtlasProblem::new(case.swimmer, objective)
    };
    let found = match atlas(&problem) {
        Ok(found) => found,
        Err(error) => return SolverOutcome::Wrong(format!("no atlas: {error}")),
    };
    let told: usize = found.optima.iter().map(|optimum| optimum.found).sum();
    let rest = found.unsettled + found.left + found.uncertified;
    if told + rest != found.starts {
        return SolverOutcome::Wrong(format!(
            "{told} + {rest} of {} starts accounted for",
            found.starts
        ));
    }
    if found.optima.is_empty() {
        return SolverOutcome::Reason {
            kind: "Empty".to_owned(),
            text: format!(
                "{} starts: {} unsettled, {} left, {} uncertified",
                found.starts, found.unsettled, found.left, found.uncertified
            ),
        };
    }
    SolverOutcome::Gaits(found.optima.into_iter().map(|one| one.gait).collect())
}

/// With few starts.
fn fastest_gait(case: &Case) -> SolverOutcome {
    let problem = SpeedProblem {
        bounds: case.bounds,
        starts: 8,
        ..SpeedProblem::new(case.swimmer, [1.0, 0.8])
    };
    match fastest(&problem) {
        Ok(found) if found.speed_over_length > 0.0 => SolverOutcome::Gaits(vec![found.gait]),
        Ok(found) => SolverOutcome::Wrong(format!("{} L a second", found.speed_over_length)),
        Err(error) => SolverOutcome::refused(&error),
    }
}

/// Objection of `certify` to a gait's file, if any.
fn refused(case: &Case, gait: &OptimalGait) -> Option<String> {
    let text = gait.gait_file("one").to_text();
    let read = GaitFile::parse(&text, Path::new("one.gait")).ok()?;
    match certify(&case.swimmer, &read, gait.objective, &case.bounds) {
        Ok(certificate) => (!certificate.pass()).then(|| certificate.failures()),
        Err(error) => Some(error.to_string()),
    }
}

/// Faults of a gait, by its file, the real swimmer's model and distances of segments alone.
fn faults(case: &Case, gait: &OptimalGait) -> Vec<String> {
    let mut faults = Vec::new();
    if !gait.certificate.pass() {
        faults.push(format!("its certificate: {}", gait.certificate.failures()));
    }
    let file = gait.gait_file("one");
    let read = match GaitFile::parse(&file.to_text(), Path::new("one.gait")) {
        Ok(read) => read,
        Err(error) => return vec![format!("its file: {error}")],
    };
    if read != file {
        faults.push("its file reads as another gait".to_owned());
    }
    let model = Model::new(&case.swimmer).unwrap();
    let curve = match AnyGait::from_file(&read) {
        Ok(curve) => curve,
        Err(error) => return vec![format!("its samples: {error}")],
    };
    let stroke = swim(&model, &curve, &Tolerance::new(1e-11));
    let length = case.swimmer.total_length();
    let swum = stroke.displacement_over_length();
    for (name, told, swum, tolerance) in [
        ("X/L", gait.displacement_over_length, swum.x, 1e-8),
        ("X in L", gait.displacement / length, swum.x, 1e-8),
        ("Y/L", gait.lateral_over_length, swum.y, 1e-8),
        ("rotation", gait.rotation, stroke.rotation, 1e-8),
        (
            "efficiency, relative",
            1.0,
            stroke.efficiency_constant_power() / gait.efficiency,
            1e-6,
        ),
    ] {
        let off = (told - swum).abs();
        if off.is_nan() || off > tolerance {
            faults.push(format!("{name}: told {told}, swum {swum}"));
        }
    }
    let widest = read.phi.iter().map(Vector2::amax).fold(0.0, f64::max);
    let max = case.bounds.max_angle.unwrap_or(f64::INFINITY);
    if widest > max + 1e-9 {
        faults.push(format!("{widest} rad, beyond {max}"));
    }
    if case.bounds.no_overlap {
        let apart = Apart::new(case.swimmer.links, case.bounds.clearance - 1e-9);
        let bad = read.phi.iter().filter(|phi| !apart.allows(phi)).count();
        if bad > 0 || gait.links_cross > 0.0 {
            faults.push(format!(
                "{bad} samples with links too near, crossing {} of the time",
                gait.links_cross
            ));
        }
    }
    faults
}

/// Asks for the gaits of `every`-th of the swimmers, prints what comes, and fails where anything is wrong, or where `certify`
/// refuses the file of a gait that its solver certifies.
fn ask((objective, solve): Kind, every: usize) {
    let (mut certified, mut gaits, mut asked) = (0, 0, 0);
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let (mut wrong, mut refusals) = (Vec::new(), Vec::new());
    let mut slowest = (0.0, String::new());
    for case in swimmers::random(SEED, 200).into_iter().step_by(every) {
        asked += 1;
        let begun = Instant::now();
        let (send, receive) = channel();
        let (name, of) = (case.name.clone(), case.clone());
        // A thread that hangs cannot be stopped, but abandoned: the test fails at once.
        let solver = std::thread::spawn(move || send.send(solve(&of)));
        let answer = match receive.recv_timeout(PATIENCE) {
            Ok(answer) => answer,
            Err(RecvTimeoutError::Timeout) => {
                println!("{objective} HANGS {name}");
                wrong.push(format!("{name}: hangs"));
                continue;
            }
            Err(RecvTimeoutError::Disconnected) => {
                wrong.push(format!("{name}: panics: {}", solver.join().is_err()));
                continue;
            }
        };
        let seconds = begun.elapsed().as_secs_f64();
        if seconds > slowest.0 {
            slowest = (seconds, name.clone());
        }
        match answer {
            SolverOutcome::Gaits(found) => {
                let faults: Vec<String> =
                    found.iter().flat_map(|gait| faults(&case, gait)).collect();
                gaits += found.len();
                for why in found.iter().filter_map(|gait| refused(&case, gait)) {
                    println!("{objective} REFUSED {name}: {why}");
                    refusals.push(format!("{name}: {why}"));
                }
                if faults.is_empty() {
                    certified += 1;
                } else {
                    println!("{objective} WRONG {name}: {}", faults.join("; "));
                    wrong.push(format!("{name}: {}", faults.join("; ")));
                }
            }
            SolverOutcome::Reason { kind, text } => {
                assert!(!text.is_empty(), "{name}: no reason given");
                println!("{objective} {seconds:.2} s, {kind}: {text} ({name})");
                *reasons.entry(kind).or_default() += 1;
            }
            SolverOutcome::Wrong(what) => {
                println!("{objective} WRONG {name}: {what}");
                wrong.push(format!("{name}: {what}"));
            }
        }
    }
    println!(
        "TABLE {objective}: {asked} asked, {certified} certified ({gaits} gaits), {} refused by certify, reasons \
         {reasons:?}, {} wrong, slowest {:.2} s ({})",
        refusals.len(),
        wrong.len(),
        slowest.0,
        slowest.1
    );
    assert!(certified > 0, "{objective}: not one gait");
    assert!(wrong.is_empty(), "{objective}:\n{}", wrong.join("\n"));
    assert!(
        refusals.is_empty(),
        "{objective}: {} refused:\n{}",
        refusals.len(),
        refusals.join("\n")
    );
}

/// Kind of gait, with its solver.
type Kind = (&'static str, fn(&Case) -> SolverOutcome);
const SMALL: Kind = ("small", |case| most_efficient(case, Branch::Small));
const LARGE: Kind = ("large", |case| most_efficient(case, Branch::Large));
const TURNING: Kind = ("turning", most_turning);
const SIDEWAYS: Kind = ("sideways", most_sideways);
const SPEED: Kind = ("speed", fastest_gait);
const FAR: Kind = ("displacement atlas", |case| {
    small_atlas(case, Objective::Displacement)
});
const THRIFTY: Kind = ("efficiency atlas", |case| {
    small_atlas(case, Objective::Efficiency)
});

/// One swimmer in so many, for every change; primes, so that bounds of all kinds are among them.
#[test]
fn some_of_each() {
    ask(SMALL, 29);
    ask(LARGE, 41);
    ask(TURNING, 13);
    ask(SIDEWAYS, 99);
    ask(SPEED, 67);
    ask(FAR, 67);
    ask(THRIFTY, 67);
}

/// A soak test over all swimmers for each kind of gait: minutes each.
macro_rules! of_all {
    ($($name:ident: $kind:expr;)*) => { $(
        #[test]
        #[ignore = "minutes: part of the soak"]
        fn $name() {
            ask($kind, 1);
        }
    )* };
}

// `certify` refuses none of the files: sharp turns are sampled as closely as its slopes need. For three swimmers (115, 117, 144)
// the few starts here find only saddles, which the atlas does not list; more starts find optima.
of_all! {
    small_gaits_of_all: SMALL;
    large_gaits_of_all: LARGE;
    turning_gaits_of_all: TURNING;
    fastest_gaits_of_all: SPEED;
    sideways_gaits_of_all: SIDEWAYS;
    displacement_atlases_of_all: FAR;
    efficiency_atlases_of_all: THRIFTY;
}
