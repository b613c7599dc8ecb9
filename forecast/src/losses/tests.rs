use super::*;
use gait_player::GaitTable;
use gait_player::table::Phase;
use proptest::prelude::*;
use swimmer_files::AnyGait;
use swimmer_model::{Swimmer, SymmetricFourier, swim};

fn robot() -> Model<f64> {
    Model::new(&Swimmer::robot()).unwrap()
}

fn ideal() -> ServoFile {
    ServoFile {
        dead_band: 0.0,
        max_rate: 1e9,
        ..ServoFile::default()
    }
}

/// Pulses in whole nanoseconds.
fn fine(file: ServoFile) -> Servos {
    Servos {
        file,
        pulse_step_ns: 0,
    }
}

fn asked(
    gait: &AnyGait,
    servos: Servos,
    period: f64,
    knots: usize,
) -> Result<Forecast, ForecastError> {
    let played = Played {
        servos,
        period,
        knots,
    };
    forecast(&robot(), gait, &played)
}

fn predicted(gait: &AnyGait, servos: Servos, period: f64, knots: usize) -> Forecast {
    asked(gait, servos, period, knots).unwrap()
}

fn stage(forecast: &Forecast, stage: Stage) -> Loss {
    *forecast
        .stages
        .iter()
        .find(|loss| loss.stage == stage)
        .unwrap()
}

/// A dead band makes every turning point fall short by its width: the circle of radius a is played as one of a − δ.
#[test]
fn a_dead_band_shrinks_the_gait() {
    let model = robot();
    let (amplitude, band) = (1.0, 0.1);
    let servos = fine(ServoFile {
        dead_band: band,
        ..ServoFile::default()
    });
    let forecast = predicted(&AnyGait::circle(amplitude), servos, 30.0, 512);
    let circle = AnyGait::circle(amplitude - band);
    let smaller = swim(&model, &circle, &Tolerance::default());
    let (designed, played) = forecast.ends().unwrap();
    // The play operator cuts the turning points off: between the smaller circle and the whole one, nearer to the former.
    let x = played.displacement.x;
    assert!(
        x < designed.displacement.x && x > 0.9 * smaller.displacement.x,
        "{x}"
    );
    assert!(stage(&forecast, Stage::Played).loss > 0.8 * forecast.total_loss());
    // Where φ₂ − φ₁ is largest both joints turn the same way and lag alike, so the yaw stays.
    assert!((played.delta_theta / designed.delta_theta - 1.0).abs() < 2e-3);
}

/// The table's cubic has slopes of fourth order: the loss by interpolation falls with the fourth power of the knots.
#[test]
fn interpolation_losses_fall_at_fourth_order() {
    let gait = AnyGait::circle(1.4);
    let servos = fine(ideal());
    let loss = |knots| stage(&predicted(&gait, servos, 30.0, knots), Stage::Interpolated).loss;
    let losses = [12, 24, 48, 96].map(loss);
    assert!(
        losses[0].abs() > 1e-6,
        "a coarse table's loss is seen: {losses:?}"
    );
    for [before, after] in losses.array_windows() {
        let order = (before / after).log2();
        assert!((3.7..4.4).contains(&order), "{order} {losses:?}");
    }
}

#[test]
fn the_curve_of_a_table_is_the_robots_interpolant() {
    for knots in [2, 3, 4, 5, 64, 512] {
        let gait = AnyGait::circle(1.9);
        let table = GaitTable::from_fn(knots, |u| gait.at(u).phi.into()).unwrap();
        let units = |i| Vector2::from(table.knot(i).map(|units| f64::from(units) * 1e-4));
        let curve = stages::through((0..knots).map(units)).unwrap();
        for i in 0..997_usize {
            let interval = i * knots / 997;
            let robot = table.at(Phase {
                interval,
                fraction: (i as f64 / 997.0 * knots as f64 - interval as f64) as f32,
            });
            let ours = curve.at(i as f64 / 997.0).phi;
            let off = Vector2::from(robot.angles.map(f64::from)) - ours;
            assert!(off.amax() < 2e-6, "{knots} {i}: {off}");
        }
    }
}

/// Loss of a coarse table by an independent integration: the polygon of the robot's interpolant through the same knots, finely
/// divided.
#[test]
fn a_coarse_table_by_another_integration() {
    let model = robot();
    let gait = AnyGait::circle(1.4);
    let servos = fine(ideal());
    let predicted = stage(&predicted(&gait, servos, 30.0, 16), Stage::Rounded);
    let table = GaitTable::from_fn(16, |u| gait.at(u).phi.into()).unwrap();
    let shape = |i: usize| {
        let phase = Phase {
            interval: i / 500,
            fraction: (i % 500) as f32 / 500.0,
        };
        Vector2::from(table.at(phase).angles.map(f64::from))
    };
    let mut pose = swimmer_model::Pose::identity();
    for i in 0..8000 {
        let (a, b) = (shape(i), shape(i + 1));
        let twist = model.local_connection(&((a + b) / 2.0)) * (b - a);
        pose = pose * swimmer_model::Pose::exp(&twist);
    }
    assert!(
        (pose.x - predicted.displacement.x).abs() < 1e-7,
        "{} {}",
        pose.x,
        predicted.displacement.x
    );
    assert!((pose.theta - predicted.rotation).abs() < 1e-5);
}

#[test]
fn good_servos_lose_nothing() {
    let servos = fine(ideal());
    let forecast = predicted(&AnyGait::circle(1.0), servos, 200.0, 512);
    let share = forecast.share(forecast.total_loss()).unwrap();
    assert!(share.abs() < 1e-4, "{share}");
    // Joints that end a tick's step one after the other go round a corner of 1e-4 rad²: next to nothing, and seen.
    assert!(
        stage(&forecast, Stage::RateLimited).loss.abs() < 1e-7,
        "{forecast:?}"
    );
    assert!(stage(&forecast, Stage::Played).loss.abs() < 1e-12);
    assert!(forecast.turn_radius() > 100.0);
}

/// Slow servos lag behind and cut the gait: seen in the stage of the rate, and the robot would not play it.
#[test]
fn slow_servos_are_told() {
    let servos = fine(ServoFile {
        max_rate: 0.2,
        dead_band: 0.0,
        ..ServoFile::default()
    });
    let forecast = predicted(&AnyGait::circle(1.2), servos, 30.0, 512);
    assert!(stage(&forecast, Stage::RateLimited).loss > 0.02 * forecast.stages[0].displacement.x);
    assert!(forecast.verdict.min_period > 30.0);
    assert!(forecast.verdict.refused.is_some());
    let warnings = forecast.warnings();
    assert!(warnings.iter().any(|text| text.contains("refuse")));
}

#[test]
fn close_links_are_told() {
    let servos = Servos::on_the_robot(ServoFile::default());
    let wide = predicted(&AnyGait::circle(1.83 * 2.0_f64.sqrt()), servos, 60.0, 512);
    assert!(wide.gap.distance < wide.margin, "{:?}", wide.gap);
    assert!(!wide.warnings().is_empty());
    let links = Swimmer::<f64>::robot().links;
    // Tip to tip at φ₁ = φ₂ = φ: l₀ + 2 l₁ cos φ.
    let shape = 1.78;
    let close = predicted(&AnyGait::circle(shape * 2.0_f64.sqrt()), servos, 60.0, 512);
    let tips = links.middle + 2.0 * links.front * shape.cos();
    assert!(
        (close.designed_gap.distance - tips).abs() < 1e-4,
        "{:?} {tips}",
        close.designed_gap
    );
    assert!(
        (predicted(&AnyGait::circle(0.5), servos, 30.0, 512)
            .gap
            .distance
            - links.middle)
            .abs()
            < 0.02
    );
}

#[test]
fn what_no_robot_plays_is_refused() {
    let servos = Servos::on_the_robot(ServoFile::default());
    let with = |amplitude, period, knots| {
        asked(&AnyGait::circle(amplitude), servos, period, knots).unwrap_err()
    };
    let range = with(2.9, 30.0, 512);
    assert!(matches!(range, ForecastError::Range { .. }));
    for period in [1e9, f64::NAN] {
        let refused = with(1.0, period, 512);
        assert!(matches!(refused, ForecastError::Period(_)));
    }
    for knots in [513, 1] {
        let refused = with(1.0, 30.0, knots);
        assert!(matches!(refused, ForecastError::Table(_)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Stages are consistent for any gait, and nothing panics.
    #[test]
    fn any_gait_is_told(
        a in 0.3_f64..1.5, b in 0.3_f64..1.5, c in -0.2_f64..0.2, period in 2.0_f64..40.0, knots in 2_usize..=512,
        step in 0_u32..1000, band in 0.0_f64..0.2
    ) {
        let gait = SymmetricFourier { coefficients: [[a, b], [c, -c]] };
        let servos = Servos { file: ServoFile { dead_band: band, ..ServoFile::default() }, pulse_step_ns: step };
        let forecast = forecast(&robot(), &gait, &Played { servos, period, knots }).unwrap();
        let (designed, played) = forecast.ends().unwrap();
        let along = designed.displacement.normalize();
        prop_assert!((forecast.total_loss() - along.dot(&(designed.displacement - played.displacement))).abs() < 1e-12);
        prop_assert!(forecast.stages.iter().all(|loss| loss.displacement.x.is_finite() && loss.rotation.is_finite()));
        prop_assert!(forecast.gap.distance >= 0.0 && forecast.verdict.min_period > 0.0);
    }
}
