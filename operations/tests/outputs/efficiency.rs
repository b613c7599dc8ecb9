//! Efficiency of a timed gait.

use operations::Context;
use operations::bounds::BoundsRequest;
use operations::optimize::efficiency::{self, Method, Optimum, Output, Request, Symmetric};
use operations::optimize::timing;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Swimmer, Tolerance, swim};

/// The gait with this timing, and the efficiency of its file as the model swims it.
fn found(timing: Option<timing::Request>) -> (Symmetric, f64) {
    let request = Request {
        swimmer: "purcell".into(),
        optimum: Optimum::Small,
        method: Method::Auto,
        bounds: BoundsRequest {
            max_angle: Some(1.5),
            ..BoundsRequest::default()
        },
        robust: None,
        order: None,
        timing,
    };
    let output = efficiency::run(&request, &mut Context::on_disk()).unwrap();
    let Output::Symmetric(found) = output else {
        panic!("Purcell's swimmer is symmetric: {output:?}")
    };
    let file = AnyGait::from_file(&found.gait.file).unwrap();
    let model = Model::new(&Swimmer::purcell()).unwrap();
    let swum = swim(&model, &file, &Tolerance::default()).efficiency();
    (found, swum)
}

/// Servos at their limit cost efficiency, and the reported value is that of the file.
#[test]
fn the_efficiency_is_that_of_the_gait_that_is_written() {
    let (free, swum) = found(None);
    assert!((free.efficiency / swum - 1.0).abs() < 1e-6);
    assert!(free.efficiency_constant_power.is_none());
    let (timed, swum) = found(Some(timing::Request {
        max_rate: 0.5,
        period: 15.12,
    }));
    assert!((timed.efficiency / swum - 1.0).abs() < 1e-9, "{swum}");
    assert!(timed.efficiency < 0.95 * free.efficiency);
    assert_eq!(timed.efficiency_constant_power, Some(free.efficiency));
}
