//! Forecast of a gait on the robot before it is sent, as `swimmer robot upload` prints it.

use forecast::{Played, Servos, forecast, table};
use link_protocol::{Configuration, HelloReply, MAX_KNOTS, crc32c};
use operations::{Files, GaitSource};
use serde::Deserialize;
use serde_json::{Value, json};
use swimmer_model::{Tolerance, trajectory};
use twin::is_configured_as;

use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ForecastRequest {
    swimmer: SwimmerText,
    gait: GaitSource,
    /// Period of a cycle.
    period_s: f64,
    /// Configuration of the connected robot, if any.
    robot: Option<Connected>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Connected {
    hello: HelloReply,
    configuration: Configuration,
}

/// Steps of the path of one cycle: the page draws it.
const PATH_INTERVALS: usize = 120;

/// Rounds to a millionth of a metre or radian.
fn to_micro(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// Computes the forecast of a gait.
pub(super) fn preflight(_lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: ForecastRequest = parsed(bytes)?;
    let (file, model) = request.swimmer.model()?;
    let servo = file.servo.unwrap_or_default();
    let servos = match &request.robot {
        None => Servos::on_the_robot(servo),
        Some(Connected {
            hello,
            configuration,
        }) => Servos::on_robot(servo, hello, configuration),
    };
    let played = Played {
        servos,
        period: request.period_s,
        knots: MAX_KNOTS,
    };
    let gait = request.gait.read(Files::Unavailable)?;
    let predicted = forecast(&model, &gait, &played).map_err(|why| why.to_string())?;
    let crc32 = table(&gait, MAX_KNOTS)
        .map(|table| crc32c(table.bytes()))
        .map_err(|why| why.to_string())?;
    let played = predicted.ends().map(|(_, played)| *played);
    let mut path: Vec<[f64; 5]> = Vec::with_capacity(PATH_INTERVALS + 1);
    trajectory(
        &model,
        &predicted.way,
        &Tolerance::default(),
        PATH_INTERVALS,
        |point| {
            let (pose, phi) = (point.pose, point.phi);
            path.push([pose.x, pose.y, pose.theta, phi.x, phi.y].map(to_micro));
        },
    );
    let losses: Vec<Value> = predicted
        .stages
        .iter()
        .map(|stage| json!({ "by": stage.stage.word(), "loss_share": predicted.share(stage.loss) }))
        .collect();
    json(&json!({
        // Checksum of the table that an upload sends; the robot reports the checksum of its own table.
        "crc32": crc32,
        "period_s": request.period_s,
        "min_period_s": predicted.verdict.min_period,
        "displacement_m": played.map(|played| [played.displacement.x, played.displacement.y]),
        "rotation_rad": played.map(|played| played.rotation),
        "loss_share": predicted.share(predicted.total_loss()),
        "losses": losses,
        // Path of one cycle as played: x, y, θ of the middle link from the cycle's start, and both joint angles.
        "path": path,
        "refused": predicted.refusal(),
        "warnings": predicted.warnings(),
        // `true` if the values of a good servo are assumed.
        "servo_assumed": file.servo.is_none(),
        "configured_as": request.robot.map(|robot| is_configured_as(&robot.configuration, &file.swimmer)),
    }))
}
