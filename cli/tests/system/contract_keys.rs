//! Keys that scripts find in every answer of a command, whatever made it.

use std::path::Path;

use serde_json::Value;

use crate::binary::{number, swimmer};

/// The keys that only gaits for efficiency have.
#[track_caller]
fn has_efficiency_figures(gait: &Value, most_residual: f64, most_variation: f64) {
    assert!(number(gait, "residual").abs() <= most_residual, "{gait:#}");
    let variation = number(gait, "power_variation");
    assert!((0.0..=most_variation).contains(&variation), "{gait:#}");
    assert_eq!(gait["method"], "fourier");
}

#[test]
fn an_atlas_counts_the_starts_that_were_asked_for() {
    let atlas = |objective| {
        let words = [
            "atlas",
            "--swimmer",
            "purcell",
            "--objective",
            objective,
            "--starts",
            "1",
            "--json",
        ];
        swimmer(&words).with_status(0).json()
    };
    let found = atlas("efficiency");
    assert_eq!(
        (&found["starts"], &found["known_starts"]),
        (&1.into(), &2.into())
    );
    let optima = found["optima"].as_array().unwrap();
    assert!(!optima.is_empty());
    for optimum in optima {
        has_efficiency_figures(optimum, 1e-10, 1e-6);
    }
    let found = atlas("displacement");
    assert_eq!(found["starts"], 1);
    for optimum in found["optima"].as_array().unwrap() {
        assert!(optimum.get("residual").is_none(), "{optimum:#}");
    }
}

#[test]
fn a_robust_gait_has_the_keys_of_its_objective() {
    let fit = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cmd/robust.in/fit.json");
    let found = swimmer(&[
        "optimize",
        "efficiency",
        "--swimmer",
        "robot",
        "--order",
        "2",
        "--robust",
        fit.to_str().unwrap(),
        "--json",
    ])
    .with_status(0)
    .json();
    // Timed as the series runs, not at constant power.
    has_efficiency_figures(&found, 1e-8, 2.0);
    assert!(number(&found, "power_variation") > 1e-3, "{found:#}");
}

/// Keys of classes beyond simple gaits and of second searches are gone; the farther sense swims forwards.
#[test]
fn only_simple_gaits_are_printed() {
    let gone = [
        "exists",
        "supremum_over_length",
        "best_member",
        "priced",
        "bridged_supremum_rad",
        "bridged_supremum_over_length",
        "better",
        "outdone_over_length",
    ];
    let of = |words: &[&str]| {
        let within = ["--swimmer", "robot", "--max-angle", "2.8", "--json"];
        let found = swimmer(&[&["optimize"], words, &within].concat());
        let found = found.with_status(0).json();
        for key in gone {
            assert_eq!(found.get(key), None, "{words:?} {key}");
        }
        found
    };
    for words in [&["turning"][..], &["efficiency", "--gait=large"]] {
        of(words);
    }
    number(&of(&["sideways"]), "heading_rad");
    let timed = of(&["displacement", "--max-rate=3.5", "--period=7"]);
    assert_eq!(timed["timing"].get("known_to_be_faster"), None);
    let sector = |more: &[&str]| of(&[&["displacement", "--sector"], more].concat());
    let (papers, farthest) = (sector(&["--sign=-"]), sector(&[]));
    let x = |found: &Value| number(found, "displacement_over_length");
    assert!(x(&papers) < -0.1 && (x(&farthest) + x(&papers)).abs() < 1e-12);
    assert_eq!(
        (&papers["clockwise"], &farthest["clockwise"]),
        (&false.into(), &true.into())
    );
    assert_eq!(papers["arcs"], farthest["arcs"]);
}

#[test]
fn the_fastest_gait_has_the_keys_of_the_contract() {
    let words = [
        "optimize",
        "speed",
        "--swimmer",
        "purcell",
        "--max-rate",
        "1",
        "--max-angle",
        "2",
        "--json",
    ];
    let found = swimmer(&words).with_status(0).json();
    let (speed, far) = (
        number(&found, "speed_over_length_per_s"),
        number(&found, "displacement_over_length"),
    );
    assert!((speed - 0.012_915_416_912_7).abs() < 1e-12, "{found:#}");
    assert!((far / number(&found, "period_s") - speed).abs() < 1e-14);
    assert!(number(&found, "heading_rad").abs() < 1e-9);
    assert_eq!(number(&found, "links_cross").to_bits(), 0.0_f64.to_bits());
    let (arcs, corners) = (&found["arcs"], &found["corners"]);
    assert_eq!(arcs.as_array().unwrap().len(), 4);
    assert_eq!(corners.as_array().unwrap().len(), 4);
    assert_eq!(arcs[0]["kind"], "extreme");
    assert_eq!(found["certificate"]["pass"], true);
    assert_eq!(found["max_corners"], 16);
    assert!(found["seconds"].is_number());
}

#[test]
fn a_prescribed_heading_tells_the_limit_of_tacks() {
    let words = "optimize speed --swimmer robot --max-rate 1 --max-angle 2.4 --json";
    let words: Vec<&str> = words.split(' ').collect();
    let any = swimmer(&words).with_status(0).json();
    assert!(any["any_heading_speed_over_length_per_s"].is_null());
    let led = swimmer(&[&words[..], &["--heading", "forward"]].concat());
    let led = led.with_status(0).json();
    let limit = number(&led, "any_heading_speed_over_length_per_s");
    let speed = number(&any, "speed_over_length_per_s");
    assert!((limit / speed - 1.0).abs() < 1e-9, "{limit} {speed}");
    assert!(number(&led, "speed_over_length_per_s") < limit);
}
