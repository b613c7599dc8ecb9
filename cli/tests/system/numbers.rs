//! Numbers that are known to ten digits, through the binary's JSON.

use crate::binary::{number, swimmer, swimmer_in};

#[test]
fn the_best_circle_of_purcells_swimmer() {
    let swum = swimmer(&[
        "simulate",
        "--swimmer",
        "purcell",
        "--gait",
        "circle:1.6331625",
        "--json",
    ])
    .with_status(0)
    .json();
    let displacement = number(&swum, "displacement_over_length");
    assert!(
        (displacement - 0.082_285_393_1).abs() < 1e-9,
        "{displacement}"
    );
    assert!((number(&swum, "displacement_m") - 3.0 * displacement).abs() < 1e-12);
    assert!(
        number(&swum, "rotation_rad").abs() < 1e-9
            && number(&swum, "lateral_over_length").abs() < 1e-9
    );
    let constant_power = number(&swum, "efficiency_constant_power");
    assert!(
        constant_power >= number(&swum, "efficiency") && constant_power > 0.0,
        "{swum:#}"
    );
}

#[test]
fn circles_and_squares_of_the_reference_table() {
    for (gait, expected) in [
        ("circle:3.647415", -0.214_965_8),
        ("square:1.3906077", 0.078_260_826_4),
        ("square:1.3906077:cw", -0.078_260_826_4),
    ] {
        let swum = swimmer(&["simulate", "--json", "--swimmer", "purcell", "--gait", gait])
            .with_status(0)
            .json();
        let displacement = number(&swum, "displacement_over_length");
        assert!(
            (displacement - expected).abs() < 6e-8,
            "{gait}: {displacement} instead of {expected}"
        );
    }
}

#[test]
fn links_cross_on_the_share_that_is_known_in_closed_form() {
    // A circle crosses φ₁ = φ₂ twice, where Purcell's links cross from arccos(-1/2) = 2.0944 rad on, that is from an
    // amplitude of 2.0944 √2 = 2.962 on.
    let share = |amplitude: &str| {
        let gait = format!("circle:{amplitude}");
        number(
            &swimmer(&[
                "simulate",
                "--swimmer",
                "purcell",
                "--gait",
                &gait,
                "--json",
            ])
            .with_status(0)
            .json(),
            "links_cross",
        )
    };
    assert!(share("2.9").abs() < f64::EPSILON);
    let just_beyond = share("3.0");
    assert!(just_beyond > 0.005 && just_beyond < 0.25, "{just_beyond}");
}

#[test]
fn the_trajectory_ends_where_the_cycles_end() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "simulate",
        "--swimmer",
        "robot",
        "--gait",
        "circle:70deg",
        "--cycles",
        "3",
        "--trajectory",
        "path.csv",
        "--json",
    ];
    let swum = swimmer_in(folder.path(), &words).with_status(0).json();
    let text = std::fs::read_to_string(folder.path().join("path.csv")).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = header.iter().position(|name| *name == "x_m").unwrap();
    let last: f64 = text
        .lines()
        .last()
        .unwrap()
        .split(',')
        .nth(column)
        .unwrap()
        .parse()
        .unwrap();
    let displacement = number(&swum, "displacement_m");
    assert!(
        (last - 3.0 * displacement).abs() < 1e-9,
        "{last} after 3 cycles of {displacement}"
    );
}

#[test]
fn the_displacement_optimum_of_purcells_swimmer() {
    let best = swimmer(&["optimize", "displacement", "--swimmer", "purcell", "--json"])
        .with_status(0)
        .json();
    let displacement = number(&best, "displacement_over_length");
    assert!(
        (displacement - 0.103_532_240_0).abs() < 1e-9,
        "{displacement}"
    );
    assert!(
        (number(&best, "start_angle_rad") - 1.411_723_71).abs() < 1e-7,
        "{best:#}"
    );
    assert!(number(&best, "links_cross").abs() < f64::EPSILON);
    assert!(
        number(&best, "seconds") > 0.0 && best["certificate"].is_object(),
        "{best:#}"
    );
    assert_eq!(best["arcs"][0]["kind"], "singular");
    assert!(
        (best["arcs"][0]["to"][1].as_f64().unwrap() - 0.769_169_94).abs() < 1e-7,
        "{best:#}"
    );
}

#[test]
fn a_written_gait_swims_what_was_promised() {
    let folder = tempfile::tempdir().unwrap();
    for (swimmer, bound) in [
        ("purcell", None),
        ("robot", Some("2.8")),
        ("robot", Some("70deg")),
    ] {
        let mut words = vec![
            "optimize",
            "displacement",
            "--swimmer",
            swimmer,
            "-o",
            "best.gait",
            "--overwrite",
            "--json",
        ];
        words.extend(bound.iter().flat_map(|bound| ["--max-angle", bound]));
        let best = swimmer_in(folder.path(), &words).with_status(0).json();
        let swum = swimmer_in(
            folder.path(),
            &[
                "simulate",
                "--swimmer",
                swimmer,
                "--gait",
                "best.gait",
                "--json",
            ],
        )
        .with_status(0)
        .json();
        let (promised, found) = (
            number(&best, "displacement_over_length"),
            number(&swum, "displacement_over_length"),
        );
        assert!(
            (promised - found).abs() < 1e-7 * promised,
            "{swimmer} {bound:?}: {promised} promised, {found} swum"
        );
    }
}

#[test]
fn without_a_bound_the_robot_has_no_optimum_as_the_paper_says() {
    let ran = swimmer(&["optimize", "displacement", "--swimmer", "robot", "--json"]).with_status(1);
    assert!(
        ran.json()["error"]
            .as_str()
            .unwrap()
            .contains("without a bound on the joint angles"),
        "{ran}"
    );
}
