//! The whole loop through the binary: what it must recover, and what it must leave behind.

use super::figures::fits_a_telephone;
use std::path::Path;

use crate::binary::{number, swimmer_in};

/// Runs the demo and holds it to its promise: both parameters and the prediction within 3 %.
fn demo(folder: &Path, words: &[&str], truth: (f64, f64)) -> serde_json::Value {
    let ran =
        swimmer_in(folder, &[&["demo", "-o", "out", "--json"], words].concat()).with_status(0);
    let found = ran.json();
    let fit = &found["fit"];
    let (radius, chi) = (number(fit, "sphere_radius_m"), number(fit, "chi"));
    let (predicted, tracked) = (
        number(&found, "displacement_predicted_m"),
        number(&found, "displacement_tracked_m"),
    );
    eprintln!("{words:?}: r_s {radius}, χ {chi}, predicted {predicted} m, tracked {tracked} m");
    assert!(
        truth.0 <= 0.0 || (radius - truth.0).abs() <= 0.03 * truth.0,
        "r_s = {radius} m instead of {} m",
        truth.0
    );
    assert!(
        (chi - truth.1).abs() <= 0.03 * truth.1,
        "χ = {chi} instead of {}",
        truth.1
    );
    assert!(
        (predicted / tracked - 1.0).abs() <= 0.03,
        "predicted {predicted} m, tracked {tracked} m"
    );
    assert!(predicted > 0.0);
    // At the full rate of the servos, and still as predicted.
    let race = &found["race"];
    for gait in ["fastest", "farthest"] {
        let speed = |key: &str| number(&race[gait], key);
        let (predicted, tracked) = (
            speed("speed_predicted_m_per_s"),
            speed("speed_tracked_m_per_s"),
        );
        assert!((predicted / tracked - 1.0).abs() <= 0.01, "{race}");
    }
    assert!(number(race, "times_as_fast") > 1.0, "{race}");
    found
}

#[test]
fn the_papers_robot_and_what_the_demo_leaves_behind() {
    let folder = tempfile::tempdir().unwrap();
    let found = demo(folder.path(), &[], (0.0692, 3.598));
    let out = folder.path().join("out");
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.starts_with("<!doctype html>") && report.matches("<svg").count() >= 6);
    assert!(
        report.contains("The swimmer under the optimised gait") && report.contains("4 cycles<"),
        "the swimmer itself"
    );
    fits_a_telephone(&report);
    assert!(
        !report.contains("http://") || !report.contains("src="),
        "the report needs nothing from outside"
    );
    assert_eq!(found["report"], "out/report.html");
    for file in ["campaign.toml", "fitted.toml", "start.toml", "link.mcap"] {
        assert!(out.join(file).is_file(), "{file} is missing");
    }
    assert!(Path::new(found["gait"].as_str().unwrap()).is_relative());
    let bytes: u64 = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().metadata().unwrap().len())
        .sum();
    assert!(bytes < 15_000_000, "the folder has {bytes} bytes");
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        1,
        "nothing beside the folder"
    );

    // The campaign reproduces the fit.
    let again = swimmer_in(&out, &["calibrate", "campaign.toml", "--json"])
        .with_status(0)
        .json();
    for key in ["sphere_radius_m", "chi", "rmse"] {
        let (one, two) = (number(&found["fit"], key), number(&again, key));
        assert!(
            (one - two).abs() <= 1e-9 * one.abs(),
            "{key}: {one} in the demo, {two} from its campaign"
        );
    }
    what_a_calibration_leaves_behind(&out);
    fits_a_telephone(&std::fs::read_to_string(out.join("fit/report.html")).unwrap());
    wrong_gaits_are_named(&out);
}

/// A campaign that names a wrong amplitude, one recording twice, and a play of the link log that was another gait.
fn wrong_gaits_are_named(demo: &Path) {
    let named = std::fs::read_to_string(demo.join("campaign.toml")).unwrap();
    let wrong = named
        .replace(
            "gait = \"circle:60deg\"",
            "gait = \"circle:70deg\"\nlog = \"link.mcap\"\nplay = 4",
        )
        .replace("circle-080.csv", "circle-090.csv");
    std::fs::write(demo.join("wrong.toml"), wrong).unwrap();
    let ran = swimmer_in(demo, &["calibrate", "wrong.toml"]).with_status(0);
    for said in [
        "circle-090.csv and circle-090.csv hold the same recording",
        "circle-060.csv: it sways like a gait of 60.0",
        "circle-060.csv: the link log says otherwise: its joints were commanded up to 60.0",
        "circle-090.csv: it sways like a gait of 89.88",
    ] {
        assert!(ran.stdout.contains(said), "{said}: {ran}");
    }
    // A single recording is compared with the named swimmer.
    let single = |gait| {
        let words = [
            "calibrate",
            "circle-060.csv",
            "--gait",
            gait,
            "--period",
            "15",
        ];
        swimmer_in(demo, &[&words[..], &["--swimmer", "robot"]].concat()).with_status(0)
    };
    let (right, large, reversed) = (
        single("circle:60deg"),
        single("circle:70deg"),
        single("circle:60deg:cw"),
    );
    assert!(!right.stdout.contains("note:"), "{right}");
    assert!(
        large.stdout.contains("it sways like a gait of 60.1"),
        "{large}"
    );
    assert!(
        reversed.stdout.contains("take :cw off --gait"),
        "{reversed}"
    );
}

/// Verdict, and intervals with systematic errors.
fn is_assessed(answer: &serde_json::Value) {
    assert!(
        answer["verdict"].is_string() && answer["reasons"].is_array(),
        "{answer:#}"
    );
    assert!(number(answer, "reduced_chi2") > 0.0);
    let wide = answer["intervals_with_systematics"]["chi"]
        .as_array()
        .unwrap();
    let [low, high] = [0, 1].map(|end| wide[end].as_f64().unwrap());
    assert!(low < 3.598 && 3.598 < high, "{wide:?}");
    assert!(answer["budget"].as_array().unwrap().len() >= 9);
    assert_eq!(answer["explanations"].as_array().unwrap().len(), 14);
}

fn figures_are_named_and_details_folded(report: &str) {
    // r_s, χ, X, ΔY, Δθ, ridge, two profiles, residuals, without a run; three for each of nine runs.
    assert_eq!(report.matches("<svg").count(), 10 + 27);
    assert_eq!(
        report.matches("role=\"img\" aria-label=\"").count(),
        10 + 27
    );
    // The summary is open, the details of each run are folded.
    let fold = report.find("<details").expect("folded details");
    assert!(report.find("The runs</h2>").unwrap() < fold);
    assert!(fold < report.find("Tracks and cycles of each run").unwrap());
}

/// Report, tables and the fitted swimmer with the hashes of its inputs, from the demo's own campaign.
fn what_a_calibration_leaves_behind(demo: &Path) {
    let run = swimmer_in(
        demo,
        &[
            "calibrate",
            "campaign.toml",
            "--advise",
            "--fit-also",
            "deadband",
            "-o",
            "fit",
        ],
    )
    .with_status(0);
    assert!(
        run.stdout.contains("phase by heading; left out at"),
        "{run}"
    );
    let fit = demo.join("fit");
    let read = |name: &str| std::fs::read_to_string(fit.join(name)).unwrap();
    let report = read("report.html");
    for asked in ["What else may be off", "dead band", "What to measure next"] {
        assert!(report.contains(asked), "no `{asked}` on the page");
    }
    assert!(read("fitted-further.toml").contains("[[provenance.input]]"));
    figures_are_named_and_details_folded(&report);
    let first = report.find("Verdict: ").expect("a verdict");
    assert!(first < report.find("recommended").unwrap() && first < report.find("budget").unwrap());
    for outside in ["src=", "href=", "url(", "@import"] {
        assert!(
            !report.contains(outside),
            "the report needs nothing from outside: {outside}"
        );
    }
    for table in [
        "poses",
        "cycles",
        "runs",
        "residuals",
        "ridge",
        "profiles",
        "bootstrap",
        "without-run",
        "circles",
    ] {
        let text = read(&format!("{table}.csv"));
        let columns = |line: &str| line.matches(',').count();
        let mut lines = text.lines();
        let header = columns(lines.next().unwrap());
        assert!(lines.clone().count() > 1, "{table}.csv is empty");
        assert!(
            lines.all(|line| columns(line) == header),
            "{table}.csv is ragged"
        );
    }
    let answer: serde_json::Value = serde_json::from_str(&read("fit.json")).unwrap();
    let first = &answer["runs"][0];
    assert!(
        number(first, "x_se_m") > 0.0 && first["left_out"][0]["reason"].is_string(),
        "{first:#}"
    );
    assert_eq!(
        (&first["front_rule"], &first["phase"]),
        (&"label".into(), &"heading".into())
    );
    is_assessed(&answer);
    // The estimate by likelihood, in addition to the paper's.
    let likelihood = &answer["likelihood"];
    let chi = number(likelihood, "chi");
    assert!((chi / 3.598 - 1.0).abs() < 0.01, "{likelihood:#}");
    let interval = likelihood["intervals"]["chi"].as_array().unwrap();
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
    assert!(low < chi && chi < high, "{likelihood:#}");

    let evidence: serde_json::Value = serde_json::from_str(&read("evidence.json")).unwrap();
    assert_eq!(evidence["without_run"].as_array().unwrap().len(), 9);

    // The fitted swimmer is ready for use; a changed input is reported.
    let words = [
        "simulate",
        "--swimmer",
        "fit/fitted.toml",
        "--gait",
        "circle:70deg",
    ];
    let run = swimmer_in(demo, &words).with_status(0);
    assert!(!run.stderr.contains("changed"), "{run}");
    let track = demo.join("circle-050.csv");
    let text = std::fs::read_to_string(&track).unwrap();
    std::fs::write(&track, text + "\r\n").unwrap();
    let run = swimmer_in(demo, &words).with_status(0);
    assert!(
        run.stderr
            .contains("../circle-050.csv, which has changed since"),
        "{run}"
    );
    // A campaign that starts from it says so too.
    let campaign = std::fs::read_to_string(demo.join("campaign.toml")).unwrap();
    let again = campaign.replace("\"start.toml\"", "\"fit/fitted.toml\"");
    assert_ne!(again, campaign);
    std::fs::write(demo.join("again.toml"), again).unwrap();
    let run = swimmer_in(demo, &["calibrate", "again.toml"]).with_status(0);
    assert!(
        run.stderr.contains("fit/fitted.toml was fitted from"),
        "{run}"
    );
}

/// The same with the real firmware in the middle.
#[test]
#[ignore = "emulates a quarter of an hour of the chip: minutes"]
fn the_papers_robot_with_its_firmware() {
    let board = crate::emulated::board();
    let folder = tempfile::tempdir().unwrap();
    let mut words = vec!["--robot", "emulator"];
    words.extend(board.iter().map(String::as_str));
    let found = demo(folder.path(), &words, (0.0692, 3.598));
    assert_eq!(found["played_cycles"], 8);
}

#[test]
fn another_seed_and_another_swimmer() {
    let folder = tempfile::tempdir().unwrap();
    demo(folder.path(), &["--seed", "20"], (0.0692, 3.598));
    std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    let other = "name = \"small float\"\n[links]\nmiddle = 0.10\nside = 0.12\n[drag]\nchi = 2.6\n\
                 c_t = { half_thickness = 0.0025 }\n[sphere]\nradius = 0.035\n\
                 [servo]\nmax_angle = 2.4\nmax_rate = 3.0\ndead_band = 0.01\nslope_rad_per_us = 0.0274\ncentre_us = 1500.0\n";
    std::fs::write(folder.path().join("other.toml"), other).unwrap();
    demo(folder.path(), &["--swimmer", "other.toml"], (0.035, 2.6));
}

/// The fitted sphere is compared with zero in millimetres, since a relative error is undefined.
#[test]
fn a_swimmer_without_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let found = demo(
        folder.path(),
        &["--swimmer", "purcell", "--seed", "3"],
        (0.0, 2.0),
    );
    let radius = number(&found["fit"], "sphere_radius_m");
    assert!(
        radius < 0.003,
        "r_s = {radius} m of a swimmer of 3 m without a sphere"
    );
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let child = crate::binary::command(folder.path(), &["demo", "-o", "out"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let patience = std::time::Instant::now() + std::time::Duration::from_secs(20);
    // A track under way shows that the loop is.
    let begun = || {
        let drafts = std::fs::read_dir(folder.path()).unwrap().flatten();
        drafts
            .flat_map(|draft| {
                std::fs::read_dir(draft.path())
                    .into_iter()
                    .flatten()
                    .flatten()
            })
            .any(|file| file.file_name().to_string_lossy().contains("circle-"))
    };
    while !begun() {
        assert!(
            std::time::Instant::now() < patience,
            "the demo began nothing"
        );
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    crate::binary::interrupt(&child);
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    let said = String::from_utf8(ended.stderr).unwrap();
    assert!(said.contains("nothing was kept"), "{said}");
    // The log went with the folder.
    assert!(!said.contains("link log"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
