//! The servos that shall play a gait, as the robot's own arithmetic knows them.

use gait_player::Limits;
use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use link_protocol::{Board, Configuration, HelloReply};
use swimmer_files::ServoFile;

/// The servos that shall play a gait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servos {
    /// Angle, rate, dead band and the map between angle and pulse.
    pub file: ServoFile,
    /// One step of the timer that makes the pulses \[ns\]; 0 for whole nanoseconds.
    pub pulse_step_ns: u32,
}

impl Servos {
    /// One count of the robot's timer \[ns\] (firmware, 3.125 MHz).
    pub const ROBOT_PULSE_STEP_NS: u32 = 320;

    /// These servos behind the robot's timer.
    pub fn on_the_robot(file: ServoFile) -> Self {
        Self {
            file,
            pulse_step_ns: Self::ROBOT_PULSE_STEP_NS,
        }
    }

    /// These servos on a robot that reported `hello` and is configured so: within the limits of both, and behind its board's
    /// timer. The robot holds its limits in single precision; they become the decimal numbers that were meant.
    pub fn on_robot(file: ServoFile, hello: &HelloReply, configuration: &Configuration) -> Self {
        Self {
            file: ServoFile {
                max_angle: decimal(configuration.max_angle.min(hello.limits.max_angle)),
                max_rate: decimal(configuration.max_rate.min(hello.limits.max_rate)),
                ..file
            },
            pulse_step_ns: match hello.board {
                Board::Twin => 0,
                Board::NanoRp2040Connect | Board::Pico => Self::ROBOT_PULSE_STEP_NS,
            },
        }
    }

    /// The largest angle that servo and pulse window allow \[rad\].
    pub fn largest_angle(&self) -> f64 {
        self.file.max_angle
    }

    pub(crate) fn map(&self) -> ServoMap {
        ServoMap {
            centre_ns: (self.file.centre_us * 1000.0).round() as u32,
            slope_rad_per_us: self.file.slope_rad_per_us as f32,
            ..ServoMap::ROBOT
        }
    }

    pub(crate) fn limits(&self) -> Limits {
        Limits {
            max_angle: self.file.max_angle as f32,
            max_rate: self.file.max_rate as f32,
            ..Limits::ROBOT
        }
    }

    pub(crate) fn plant(&self) -> PlantParameters {
        PlantParameters {
            max_rate: self.file.max_rate,
            dead_band: self.file.dead_band,
            pulse_step_ns: self.pulse_step_ns,
        }
    }
}

/// The decimal number that was meant by one in single precision.
fn decimal(single: f32) -> f64 {
    single.to_string().parse().unwrap_or_else(|_| single.into())
}
