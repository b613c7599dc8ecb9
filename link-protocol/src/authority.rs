//! Authority: the class of each request, and the conditions under which the robot executes a class. The robot checks them
//! before it evaluates the request. The tables in `docs/security.md` and `docs/reference/protocol.md` are generated from this
//! module.

use crate::{ANGLE_UNIT_RAD, Configuration, Joint, PulseRange, Request, ServoSettings, StateName};

/// Class of a request, by its possible harm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RequestClass {
    /// Reports without any change.
    Read,
    /// Ends motion.
    Stop,
    /// Changes a setting without giving the servos more freedom.
    Narrowing,
    /// Gives the servos more freedom, sets a first key, or enters the boot loader.
    Widening,
    /// Trims a servo by at most [`SettingsHeld::MAX_SHIFT_RAD`].
    Trim,
    /// Trims a servo by more than that.
    WideTrim,
    /// Clears a latch.
    Clearing,
    /// Fills or replaces the stored table.
    Storing,
    /// Switches pulses on, or changes the motion of a powered robot.
    Powering,
}

/// Conditions under which a class of requests is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools)] // the columns of a table
pub struct Needs {
    /// A frame of the open session, signed if the robot has a key.
    pub signature: bool,
    /// A fresh keep-alive of the same session within the lease.
    pub freshness: bool,
    /// A person at the robot: the USB cable, or the bench window.
    pub presence: bool,
    /// Required state of the brain.
    pub state: StateNeeded,
    /// Uses the wear budget of the flash, which limits the rate of writes.
    pub wear: bool,
}

/// State of the brain that a class of requests requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateNeeded {
    /// Any state.
    Any,
    /// No joint moves: pulses are off, or hold a pose.
    Still,
    /// Stopped.
    Stopped,
}

impl StateNeeded {
    /// Returns true if the state satisfies the requirement.
    pub fn includes(self, state: StateName) -> bool {
        match self {
            Self::Any => true,
            Self::Still => matches!(
                state,
                StateName::Stopped | StateName::EStopped | StateName::Holding | StateName::Paused
            ),
            Self::Stopped => state == StateName::Stopped,
        }
    }
}

impl RequestClass {
    /// All classes.
    pub const ALL: [Self; 9] = [
        Self::Read,
        Self::Stop,
        Self::Narrowing,
        Self::Widening,
        Self::Trim,
        Self::WideTrim,
        Self::Clearing,
        Self::Storing,
        Self::Powering,
    ];

    /// Conditions under which requests of this class are executed.
    pub fn needs(self) -> Needs {
        let read = Needs {
            signature: true,
            freshness: false,
            presence: false,
            state: StateNeeded::Any,
            wear: false,
        };
        let fresh = Needs {
            freshness: true,
            ..read
        };
        let setting = Needs {
            wear: true,
            ..fresh
        };
        match self {
            Self::Read => read,
            Self::Stop => Needs {
                signature: false,
                ..read
            },
            Self::Narrowing => Needs {
                state: StateNeeded::Stopped,
                ..setting
            },
            Self::Widening => Needs {
                state: StateNeeded::Stopped,
                presence: true,
                ..setting
            },
            Self::Trim => Needs {
                state: StateNeeded::Still,
                ..setting
            },
            Self::WideTrim => Needs {
                state: StateNeeded::Still,
                presence: true,
                ..setting
            },
            Self::Storing => Needs { wear: true, ..read },
            Self::Clearing | Self::Powering => fresh,
        }
    }
}

impl Request {
    /// Class of this request. `widens` is evaluated only for settings; see [`SettingsHeld::is_widened_by`].
    pub fn class(&self, widens: impl FnOnce() -> bool) -> RequestClass {
        match self {
            Self::Status
            | Self::Counters
            | Self::Configuration
            | Self::Servo(_)
            | Self::CrashMessage
            | Self::Table
            | Self::Bench
            | Self::PulseRange(_) => RequestClass::Read,
            Self::Stop | Self::EStop => RequestClass::Stop,
            Self::Configure(_)
            | Self::SetServo { .. }
            | Self::SetPulseRange { .. }
            | Self::SetPassive(_)
            | Self::SetKey(_) => {
                if widens() {
                    RequestClass::Widening
                } else {
                    RequestClass::Narrowing
                }
            }
            Self::Trim { .. } => {
                if widens() {
                    RequestClass::WideTrim
                } else {
                    RequestClass::Trim
                }
            }
            Self::EnterBootLoader => RequestClass::Widening,
            Self::ClearResets | Self::ClearEStop { .. } => RequestClass::Clearing,
            Self::Begin(_) | Self::Chunk(_) | Self::Commit { .. } => RequestClass::Storing,
            Self::Arm | Self::Play(_) | Self::Pause { .. } | Self::Resume | Self::Follow(_) => {
                RequestClass::Powering
            }
        }
    }
}

/// Settings of the robot, with which a request is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettingsHeld {
    /// Configuration in force.
    pub configuration: Configuration,
    /// Configuration as built.
    pub built: Configuration,
    /// Servo maps in force.
    pub servos: [ServoSettings; 2],
    /// Servo maps as last set with presence, or as built.
    pub at_bench: [ServoSettings; 2],
    /// Pulse ranges in force.
    pub ranges: [PulseRange; 2],
    /// Joint without a servo.
    pub passive: Option<Joint>,
    /// A key is set.
    pub has_key: bool,
}

impl SettingsHeld {
    /// Largest rotation of a joint at constant pulses without presence, summed over centre, slope and trim: 1°.
    pub const MAX_SHIFT_RAD: f32 = core::f32::consts::PI / 180.0;
    /// Largest relative deviation of a length from that as built without presence.
    pub const MAX_LENGTH_SHARE: f32 = 0.1;

    /// Returns true if a request gives the servos more freedom than is allowed without presence. Repeating the present setting
    /// does not.
    pub fn is_widened_by(&self, request: &Request) -> bool {
        match request {
            Request::Configure(new) => self.is_configuration_wider(new),
            Request::SetServo { joint, settings } => self.is_map_far(*joint, settings),
            Request::Trim { joint, trim } => {
                let settings = ServoSettings {
                    trim: *trim,
                    ..self.servos[joint.index()]
                };
                self.is_map_far(*joint, &settings)
            }
            Request::SetPulseRange { joint, range } => {
                let held = self.ranges[joint.index()];
                range.shortest_ns < held.shortest_ns || range.longest_ns > held.longest_ns
            }
            // A joint that was passive is driven again.
            Request::SetPassive(joint) => self.passive.is_some() && *joint != self.passive,
            Request::SetKey(key) => key.is_some() && !self.has_key,
            _ => false,
        }
    }

    /// Returns true for lengths far from those as built, or limits beyond those as built.
    fn is_configuration_wider(&self, new: &Configuration) -> bool {
        let lengths = |of: &Configuration| [of.middle_m, of.front_m, of.back_m];
        let same = |one: f32, other: f32| one.to_bits() == other.to_bits();
        let share = Self::MAX_LENGTH_SHARE;
        let far = (0..3).any(|link| {
            let [new, held, built] =
                [new, &self.configuration, &self.built].map(|of| lengths(of)[link]);
            let near = ((1.0 - share) * built..=(1.0 + share) * built).contains(&new);
            !(near || same(new, held))
        });
        let beyond = |limit: fn(&Configuration) -> f32| {
            limit(new) > limit(&self.built) && !same(limit(new), limit(&self.configuration))
        };
        far || beyond(|of| of.max_angle) || beyond(|of| of.max_rate)
    }

    /// Returns true for another direction, or a shift of more than [`Self::MAX_SHIFT_RAD`].
    fn is_map_far(&self, joint: Joint, new: &ServoSettings) -> bool {
        if *new == self.servos[joint.index()] {
            return false;
        }
        let bench = &self.at_bench[joint.index()];
        let centre_us = new.centre_ns.abs_diff(bench.centre_ns) as f32 * 1e-3;
        let centre = centre_us * bench.slope_rad_per_us.max(new.slope_rad_per_us);
        let trim = (f32::from(new.trim) - f32::from(bench.trim)).abs() * ANGLE_UNIT_RAD;
        let slope = (new.slope_rad_per_us / bench.slope_rad_per_us - 1.0).abs()
            * self.configuration.max_angle;
        // The comparison also rejects a NaN.
        let near = centre + trim + slope <= Self::MAX_SHIFT_RAD;
        new.reversed != bench.reversed || !near
    }
}
