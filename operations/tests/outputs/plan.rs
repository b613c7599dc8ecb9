//! Motion plans.

use std::path::Path;

use operations::plan::{self, MARGIN_M, Request, Target};
use operations::{Context, ErrorKind};

/// The least request of a page or a script.
fn request() -> Request {
    let text = r#"{ "swimmer": "robot", "to": { "x_m": 0.06, "y_m": 0.04 } }"#;
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_request_has_defaults() {
    let request = request();
    assert_eq!(request.margin_m.to_bits(), MARGIN_M.to_bits());
    assert_eq!(request.from, Target::default());
    assert_eq!((request.tank, request.to.heading_rad), (None, None));
}

/// The refusal comes before the search of the gaits, for which the request lacks a rate.
#[test]
fn a_target_beyond_a_wall_is_refused_at_once() {
    let request = Request {
        tank: Some(forecast::Tank {
            length: 0.5,
            width: 0.4,
        }),
        to: Target {
            x_m: 0.3,
            ..Target::default()
        },
        ..request()
    };
    let error = plan::run(&request, &mut Context::on_disk()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Failed);
    assert!(error.message.contains("does not fit"), "{error}");
}

#[test]
fn a_plan_meets_its_target_and_names_its_files() {
    let mut request = Request {
        gaits: Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiment/tests/straight")),
        ..request()
    };
    request.steer.bounds.playable = true;
    let mut output = plan::run(&request, &mut Context::on_disk()).unwrap();
    let reached = &output.reached;
    let off = (reached.x_m - 0.06).hypot(reached.y_m - 0.04);
    // The planner accepts half a millimetre.
    assert!(off <= 5e-4 && (off - output.off_m).abs() < 1e-9, "{off}");
    let lasts: f64 = output
        .steps
        .iter()
        .map(|step| f64::from(step.cycles) * step.period_s)
        .sum();
    assert!((lasts - output.duration_s).abs() < 1e-9);
    let first = output.steps[0].gait.clone();
    let playlist = output.name_files(Path::new("way/there.playlist")).unwrap();
    assert_eq!(output.steps[0].gait, format!("there-1-{first}.gait"));
    assert_eq!(playlist.steps.len(), output.steps.len());
    assert!((playlist.duration() - output.duration_s).abs() < 1e-9);
}

#[test]
fn targets_are_read() {
    let read = |text: &str| {
        let target: Result<Target, String> = text.parse();
        target.map(|target| (target.x_m, target.y_m, target.heading_rad))
    };
    assert_eq!(read("0.2, -0.1"), Ok((0.2, -0.1, None)));
    let half_turn = Some(180f64.to_radians());
    assert_eq!(read("-1,0,180deg"), Ok((-1.0, 0.0, half_turn)));
    for text in ["", "1", "1,", "inf,0", "1,nan", "1,2,90", "1,2,3,4", "1,2,"] {
        assert!(read(text).is_err(), "{text}");
    }
}
