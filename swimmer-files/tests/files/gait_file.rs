//! Gait files: exact round trips, documentation that Python can skip, a place for every mistake.

use std::fmt::Write as _;
use std::path::Path;

use link_protocol::Joint;
use nalgebra::Vector2;
use proptest::prelude::*;
use swimmer_files::{
    ArcKind, Bounds, FileError, GaitArc, GaitFile, GaitSpec, GaitSpring, JointName, Objective,
    SwimmerFile,
};

fn read(text: &str) -> Result<GaitFile, FileError> {
    GaitFile::parse(text, Path::new("b.gait"))
}

fn circle(samples: usize) -> GaitFile {
    let u: Vec<f64> = (0..=samples).map(|k| k as f64 / samples as f64).collect();
    let mut phi: Vec<_> = u
        .iter()
        .map(|u| {
            Vector2::new(
                (u * std::f64::consts::TAU).cos(),
                (u * std::f64::consts::TAU).sin(),
            )
        })
        .collect();
    phi[samples] = phi[0];
    GaitFile {
        objective: Objective::Displacement,
        swimmer_name: Some("robot".to_owned()),
        swimmer_hash: Some(SwimmerFile::preset("robot").unwrap().hash()),
        bounds: Bounds {
            max_angle: Some(2.8),
            ..Bounds::default()
        },
        arcs: vec![
            GaitArc {
                kind: ArcKind::Singular,
                from: 0.0,
                to: u[3],
            },
            GaitArc {
                kind: ArcKind::Upper,
                from: u[3],
                to: 1.0,
            },
        ],
        corners: vec![0.0, u[3]],
        u,
        phi,
        ..GaitFile::default()
    }
}

#[test]
fn a_file_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gait.csv");
    circle(16).save(&path).unwrap();
    assert_eq!(GaitFile::load(&path).unwrap(), circle(16));
}

#[test]
fn the_smallest_file() {
    let mut text = "# swimmer gait file, version 1\nu,phi1,phi2\n".to_owned();
    for k in 0..=8 {
        let (u, phi1) = (f64::from(k) / 8.0, f64::from((k % 8) - 4).abs());
        writeln!(text, "{u},{phi1},1").unwrap();
    }
    let file = read(&text).unwrap();
    assert_eq!(
        (file.objective, file.u.len(), file.arcs.len()),
        (Objective::Unspecified, 9, 0)
    );
}

#[test]
fn mistakes_have_a_place() {
    let text = circle(16).to_text();
    let line_of = |start: &str| {
        text.lines()
            .position(|line| line.starts_with(start))
            .unwrap()
            + 1
    };
    let samples = line_of("u,phi1,phi2");
    let cases = [
        ("version 1", "version 2", (1, 30), "version 2"),
        ("# swimmer gait file", "# gait", (1, 1), "not a gait file"),
        (
            "objective: displacement",
            "objective: haste",
            (line_of("# objective"), 14),
            "one of displacement",
        ),
        (
            "# objective:",
            "# aim:",
            (line_of("# objective"), 3),
            "unknown key `aim`",
        ),
        (
            "max_angle=2.8",
            "max_angle=x2.8",
            (line_of("# bounds"), 21),
            "not a finite number",
        ),
        (
            "sector=false",
            "sector=no",
            (line_of("# bounds"), 0),
            "neither true nor false",
        ),
        (
            "arc: singular",
            "arc: straight",
            (line_of("# arc"), 8),
            "singular, upper",
        ),
        (
            "# corner: 1.8",
            "# corner: 1.7",
            (line_of("# corner: 1.8"), 1),
            "no sample has the u",
        ),
        (
            "\n0.0000000000000000e0,",
            "\n0.1,",
            (samples + 1, 1),
            "must be 0",
        ),
        (
            "\n6.2500000000000000e-2,",
            "\n0,",
            (samples + 2, 1),
            "does not rise",
        ),
        (
            "\n1.2500000000000000e-1,",
            "\n1.25e-1;",
            (samples + 3, 1),
            "three numbers",
        ),
        (
            "\n1.0000000000000000e0,",
            "\n1,5,",
            (samples + 17, 1),
            "three numbers",
        ),
        (
            "\n1.0000000000000000e0,1.",
            "\n1,5.",
            (samples + 17, 1),
            "does not close",
        ),
        (
            "\n1.0000000000000000e0,1.",
            "\n.99,1.",
            (samples + 17, 1),
            "must be 1",
        ),
    ];
    for (good, bad, (line, column), message) in cases {
        let damaged = text.replacen(good, bad, 1);
        assert_ne!(damaged, text, "{good}");
        let error = read(&damaged).expect_err(bad);
        assert!(error.to_string().contains(message), "{bad}: {error}");
        let place = error.place().unwrap();
        assert_eq!(place.0, line, "{bad}: {error}");
        assert!(column == 0 || place.1 == column, "{bad}: {error}");
    }
    let short: String = text
        .lines()
        .take(samples + 5)
        .fold(String::new(), |text, line| text + line + "\n");
    assert!(read(&short).unwrap_err().to_string().contains("5 samples"));
}

fn any_angle() -> impl Strategy<Value = Option<f64>> {
    proptest::option::of(0.01..4.0)
}

prop_compose! {
    fn any_gait()(
        steps in prop::collection::vec((1e-9f64..1.0, -6.2..6.2, -6.2..6.2), 8..40),
        objective in prop::sample::select(vec![Objective::Displacement, Objective::Efficiency, Objective::Turning,
            Objective::Sideways, Objective::Speed, Objective::JoinedForward, Objective::JoinedSideways,
            Objective::JoinedTurning, Objective::Unspecified]),
        kinds in prop::collection::vec(prop::sample::select(vec![ArcKind::Singular, ArcKind::Upper, ArcKind::Lower,
            ArcKind::Diagonal, ArcKind::Clearance, ArcKind::Regular, ArcKind::Extreme]), 0..5),
        max_angle in any_angle(), min_angle in any_angle(), sector in any::<bool>(), no_overlap in any::<bool>(), clearance in prop::sample::select(vec![0.0, 1e-3, 0.02]),
        name in proptest::option::of("[a-zé][a-z é]{0,10}[a-z]"),
        corner in any::<prop::sample::Index>(),
        optimal_period in proptest::option::of(1e-3f64..1e4),
    ) -> GaitFile {
        let total: f64 = steps.iter().map(|step| step.0).sum();
        let mut u = vec![0.0];
        let mut sum = 0.0;
        for step in &steps {
            sum += step.0;
            u.push((sum / total).min(1.0));
        }
        let last = u.len() - 1;
        u[last] = 1.0;
        let mut phi: Vec<_> = steps.iter().map(|step| Vector2::new(step.1, step.2)).collect();
        phi.push(phi[0]);
        let corners = vec![u[corner.index(last)]];
        let arcs = kinds.into_iter().map(|kind| GaitArc { kind, from: u[1], to: u[3] }).collect();
        let swimmer_name = name.map(|name| name.split_whitespace().collect::<Vec<_>>().join(" "));
        GaitFile {
            objective, swimmer_name, swimmer_hash: None, bounds: Bounds { max_angle, min_angle, sector, no_overlap, clearance },
            passive: sector.then(|| GaitSpring { joint: JointName(Joint::Front), relaxation: 0.1 + u[1] }),
            arcs, corners, u, phi, optimal_period,
        }
    }
}

proptest! {
    #[test]
    fn what_is_written_reads_back_exactly(gait in any_gait()) {
        prop_assume!(gait.u.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert_eq!(read(&gait.to_text()).unwrap(), gait);
    }

    #[test]
    fn no_text_panics(text in "(?s)(# swimmer gait file, version 1\n)?.{0,200}") {
        let _ = read(&text);
    }

    #[test]
    fn damaged_files(at in 0..3000usize, with in any::<char>(), cut in any::<bool>()) {
        let text = circle(16).to_text();
        let at = at.min(text.len() - 1);
        let damaged = if cut { text[..at].to_owned() } else { format!("{}{with}{}", &text[..at], &text[at + 1..]) };
        let _ = read(&damaged);
    }
}

#[test]
fn a_passive_joint_is_named_and_the_gait_is_not_reversed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tail.gait");
    let file = GaitFile {
        passive: Some("back relaxation=0.35".parse().unwrap()),
        ..circle(16)
    };
    file.save(&path).unwrap();
    assert_eq!(GaitFile::load(&path).unwrap(), file);
    let spec = |reversed| GaitSpec::File {
        path: path.clone(),
        reversed,
    };
    assert!(spec(false).load().is_ok());
    let error = spec(true).load().unwrap_err().to_string();
    assert!(error.contains("follows a spring"), "{error}");
    for wrong in [
        "back",
        "back relaxation=0",
        "side relaxation=1",
        "back relaxation=nan",
    ] {
        let named = "back relaxation=0.35";
        let text = file.to_text().replace(named, wrong);
        let error = GaitFile::parse(&text, "tail.gait".as_ref()).unwrap_err();
        assert!(error.to_string().contains("joint is"), "{error}");
    }
}
