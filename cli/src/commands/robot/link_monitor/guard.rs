//! Guard of a robot that plays: reasons to stop it, whether its cycles are compared or not.

use experiment::{NearWalls, Pose, TankWalls};
use link_protocol::{StateName, Telemetry};
use nalgebra::Vector2;
use swimmer_model::Model;

use super::super::tracked_play::{LONGEST_BLANK_S, NEAR_WALL, not_seen};

/// Guard of a swimmer, with the walls of its tank if they are known.
pub(super) struct Guard {
    model: Model<f64>,
    walls: Option<TankWalls>,
    plays: Option<Guarded>,
}

/// Play under way.
struct Guarded {
    /// Time of the last pose, at first the start \[s\].
    seen_s: f64,
    /// Commanded joint angles \[rad\].
    shape: Vector2<f64>,
    near: NearWalls,
    /// A stop was demanded.
    is_stopped: bool,
}

impl Guard {
    pub(super) fn new(model: &Model<f64>, walls: Option<TankWalls>) -> Self {
        Self {
            model: *model,
            walls,
            plays: None,
        }
    }

    /// Takes telemetry that arrived now.
    pub(super) fn telemetry(&mut self, now_s: f64, telemetry: &Telemetry) {
        if telemetry.state != StateName::Playing {
            self.plays = None;
            return;
        }
        let guarded = self.plays.get_or_insert_with(|| Guarded {
            seen_s: now_s,
            shape: Vector2::zeros(),
            near: NearWalls::default(),
            is_stopped: false,
        });
        guarded.shape = telemetry
            .setpoint
            .map(|angle| f64::from(angle) * 1e-4)
            .into();
    }

    /// The port went away, and the robot stops by itself.
    pub(super) fn port_gone(&mut self) {
        self.plays = None;
    }

    /// Takes poses of the cameras. Returns the reason if the robot must stop, once per play.
    pub(super) fn poses(&mut self, poses: &[Pose], now_s: f64) -> Option<String> {
        let Guarded {
            seen_s,
            shape,
            near,
            is_stopped,
        } = self.plays.as_mut()?;
        for pose in poses {
            *seen_s = seen_s.max(pose.time_s);
            near.pose(
                self.walls
                    .is_some_and(|walls| walls.are_near(&self.model, pose, shape)),
            );
        }
        let blank_s = now_s - *seen_s;
        let why = if near.are_confirmed() {
            NEAR_WALL.to_owned()
        } else if blank_s > LONGEST_BLANK_S {
            not_seen(blank_s)
        } else {
            return None;
        };
        (!std::mem::replace(is_stopped, true)).then_some(why)
    }
}
