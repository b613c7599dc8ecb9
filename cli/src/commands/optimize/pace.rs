//! Output of gaits whose servos are limited: their pace, and their play on the robot.

use gait_optimizer::OptimalGait;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};

use crate::document::Document;
use crate::own_robot::{PlayedSpeed, say_if_beyond};
use crate::quantity;

/// Progress message of a search for the fastest gait.
pub(super) const SEARCHING: &str = "looking for the fastest gait";

/// First lines about a fastest gait, from its speed \[1/s\] and displacement of a cycle, both over L, and its period \[s\].
pub(super) fn at_pace(
    kind: &str,
    file: &SwimmerFile,
    (speed, distance): (f64, f64),
    period: f64,
) -> Document {
    let length = file.swimmer.total_length();
    let [pace, way] = [speed, distance].map(|one| quantity::length(one * length));
    let mut document = Document::new(format!(
        "{}: the {kind} gait swims {way} in {period:.2} s, {pace} a second",
        file.name
    ));
    document
        .key("speed_over_length_per_s", speed)
        .key("speed_m_per_s", speed * length)
        .key("displacement_over_length", distance)
        .key("displacement_m", distance * length)
        .key("period_s", period)
        .row(
            "speed",
            format!("{pace} a second   |d|/(L T) = {speed:.10} 1/s"),
        )
        .row(
            "displacement",
            format!("{way} per cycle   |d|/L = {distance:.10}"),
        )
        .row("period", format!("{period:.6} s"));
    document
}

/// Adds how a gait of this period is played by these servos, and says where it is beyond the robot of the file.
pub(super) fn add_as_played(
    document: &mut Document,
    file: &SwimmerFile,
    servo: Option<ServoFile>,
    (gait, period): (&OptimalGait, f64),
) {
    let Ok(curve) = AnyGait::from_file(&gait.gait_file(&file.name)) else {
        return;
    };
    let played = servo.and_then(|servo| PlayedSpeed::new(file, servo, &curve, period));
    let period = played.as_ref().map_or(period, |played| played.period_s);
    say_if_beyond(file, &curve, (period * 1e3).ceil() / 1e3);
    if let Some(played) = played {
        document.row(
            "as played",
            format!(
                "{} a second, a cycle in {:.3} s: table, ticks and servos take {:.2} %",
                quantity::length(played.speed_m_per_s),
                played.period_s,
                played.lost_share * 100.0
            ),
        );
        document.key("played", played);
    }
}
