//! `swimmer certify`: every optimum that was written passes, a circle fails, and the whole document is printed either way.

use crate::binary::{swimmer, swimmer_in, typed};

#[test]
fn optima_pass_and_circles_fail() {
    let folder = tempfile::tempdir().unwrap();
    for (name, words) in [
        ("a.gait", vec!["--swimmer", "purcell"]),
        ("b.gait", vec!["--swimmer", "robot", "--max-angle", "2.8"]),
        (
            "c.gait",
            vec![
                "--swimmer",
                "robot",
                "--max-angle",
                "2.8",
                "--min-angle",
                "1.5",
            ],
        ),
        (
            "d.gait",
            vec!["--swimmer", "robot", "--max-angle", "2.8", "--sector"],
        ),
    ] {
        let swim = words[1];
        let mut optimize = vec!["optimize", "displacement", "-o", name];
        optimize.extend(words);
        swimmer_in(folder.path(), &optimize).with_status(0);
        for gait in [name.to_owned(), format!("{name}:cw")] {
            let certify = ["certify", "--json", "--swimmer", swim, "--gait", &gait];
            let document = swimmer_in(folder.path(), &certify).with_status(0).json();
            assert_eq!(document["pass"], true, "{gait}: {document:#}");
        }
    }
    // The bounds of the file count, unless others are named.
    let certify = [
        "certify",
        "--swimmer",
        "robot",
        "--gait",
        "b.gait",
        "--max-angle",
        "2.9",
    ];
    swimmer_in(folder.path(), &certify).with_status(1);
    // Another swimmer's gait is certified as well.
    let certify = [
        "certify",
        "--json",
        "--swimmer",
        "purcell",
        "--gait",
        "b.gait",
    ];
    let asked = swimmer_in(folder.path(), &certify).with_status(1);
    assert!(
        asked
            .stderr
            .contains("warning: b.gait was made for another swimmer"),
        "{asked}"
    );
    assert_eq!(asked.json()["pass"], false);
}

#[test]
fn a_circle_fails_with_its_whole_certificate() {
    for objective in ["displacement", "efficiency", "turning", "sideways", "speed"] {
        let words = [
            "certify",
            "--json",
            "--swimmer",
            "purcell",
            "--gait",
            "circle:1.2",
            "--objective",
            objective,
        ];
        let ran = swimmer(&words).with_status(1);
        let document = ran.json();
        assert_eq!(document["pass"], false);
        let checks = document["checks"].as_array().unwrap();
        assert!(checks.len() > 5, "{ran}");
        for check in checks {
            assert!(
                check["name"].is_string()
                    && check["value"].is_number()
                    && check["tolerance"].is_number()
                    && check["pass"].is_boolean()
            );
        }
        assert!(ran.stderr.contains("no certified optimum"), "{ran}");
    }
    swimmer(&["certify", "--swimmer", "purcell", "--gait", "circle:1.2"]).with_status(2);
}

/// Six digits of an optimum decide nothing, and a command with a request for a certificate reports that.
#[test]
fn rounded_samples_leave_a_gait_undecided() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| typed(folder.path(), line);
    run("optimize efficiency --swimmer purcell -o best.gait").with_status(0);
    let text = std::fs::read_to_string(folder.path().join("best.gait")).unwrap();
    let round = |line: &str| {
        let numbers: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        numbers.map_or(line.to_owned(), |numbers| {
            let words: Vec<String> = numbers
                .iter()
                .map(|number| format!("{number:.6}"))
                .collect();
            words.join(",")
        })
    };
    let rounded: Vec<String> = text.lines().map(round).collect();
    std::fs::write(folder.path().join("six.gait"), rounded.join("\n")).unwrap();
    let passed = run("certify --swimmer purcell --gait best.gait --json").with_status(0);
    assert_eq!(passed.json()["verdict"], "pass");
    let asked = run("certify --swimmer purcell --gait six.gait --json").with_status(1);
    assert_eq!(asked.json()["verdict"], "undecided");
    assert_eq!(asked.json()["pass"], false);
    assert!(
        asked.stderr.contains("undecided from these samples"),
        "{asked}"
    );
}
