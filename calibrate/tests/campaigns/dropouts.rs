//! Dropouts and noise: the fit bridges the gaps, or the message names the cause. The simulated laboratory (`lab`) shares no code with
//! the workspace.

use crate::judged;
use crate::lab;

use calibrate::{CalibrateError, FitOptions, calibrate_campaign};
use judged::Judged;
use lab::{Cameras, Lab};

/// Coverage with a reflector missing in a tenth of the frames, and with noise of a twentieth of the reflectors' distance.
#[test]
fn lost_frames_and_noise_are_fitted_through() {
    for (name, dropout, noise) in [
        ("6 % of each reflector", 0.06, 3e-4),
        ("12 % of each reflector", 0.12, 3e-4),
        ("3 mm of noise", 0.0, 3e-3),
        ("both", 0.06, 2e-3),
    ] {
        for seed in [21, 22] {
            let lab = Lab {
                cameras: Cameras {
                    noise,
                    dropout,
                    ..Cameras::FULL
                },
                ..Lab::new(seed)
            };
            let judged = Judged::of(&lab).unwrap_or_else(|error| panic!("{name}: {error}"));
            println!("{name}: {}", judged.line());
            for run in &judged.found.runs {
                // Six cycles were played, of which the first is never used.
                assert!(
                    run.cycles.cycles.len() >= 4,
                    "{name}: {:?}",
                    run.cycles.left_out
                );
            }
            assert_eq!(judged.holds(), [true; 2], "{name}");
        }
    }
}

/// Loss and noise beyond the limit are named, and the period is not blamed.
#[test]
fn too_many_lost_frames_and_too_much_noise_are_named() {
    let refused = |dropout, noise| {
        let lab = Lab {
            cameras: Cameras {
                noise,
                dropout,
                ..Cameras::FULL
            },
            ..Lab::new(5)
        };
        let (campaign, data) = lab.campaign();
        match calibrate_campaign(&campaign, &data, FitOptions::default()) {
            Err(error @ CalibrateError::Cycles { .. }) => error.to_string(),
            other => panic!("{dropout}, {noise}: {other:?}"),
        }
    };
    let message = refused(0.5, 3e-4);
    assert!(
        message.contains("are lost") && !message.contains("period_s"),
        "{message}"
    );
    let message = refused(0.35, 6e-3);
    assert!(
        message.contains("noise") && !message.contains("period_s"),
        "{message}"
    );
}

/// A heading that does not repeat with the campaign's period stops the calibration.
#[test]
fn a_wrong_period_stops_the_calibration() {
    for factor in [0.37, 0.6, 0.7, 0.85, 0.9, 1.1, 1.2, 1.35, 1.5, 1.7, 2.4] {
        let lab = Lab::new(9);
        let (mut campaign, mut data) = lab.campaign();
        for run in &mut campaign.runs {
            run.period_s *= factor;
        }
        for run in &mut data.runs {
            run.period_s *= factor;
        }
        let error = calibrate_campaign(&campaign, &data, FitOptions::default());
        let error = error.err().unwrap_or_else(|| panic!("{factor}: fitted"));
        println!("{factor}: {error}");
        assert!(
            matches!(error, CalibrateError::Cycles { .. }),
            "{factor}: {error}"
        );
        assert!(error.to_string().contains("period_s"), "{factor}: {error}");
    }
}
