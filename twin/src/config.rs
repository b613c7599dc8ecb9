//! Configuration of a twin: the true parameters of the tank, and the initial settings of its brain.

use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use gait_player::storage::MemoryStorage;
use gait_player::{Boot, Brain, BrainConfig, Identity, Limits, Transport};
use link_protocol::{Board, Configuration, FirmwareVersion, ResetReason, ServoSettings};
use passive_joint::{PassiveJoint, over_viscosity};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{ServoFile, SwimmerFile};
use swimmer_model::{Model, Scalar, Swimmer, TangentialDrag, UncommonDrag};

use crate::camera::CameraConfig;

/// Range of pulses for servos of this kind, µs: beyond it a sail winch may spin on.
const PULSE_WINDOW_US: (f64, f64) = (600.0, 2400.0);
/// Angle by which the pulse window exceeds the largest angle, for the trim, rad.
const TRIM_ROOM: f64 = 0.4;

/// Parameters of a twin.
#[derive(Debug, Clone)]
pub struct TwinConfig {
    /// Swimmer in the tank.
    pub swimmer: Swimmer<f64>,
    /// Dynamics of the servos.
    pub plant: PlantParameters,
    /// Limits of the firmware.
    pub limits: Limits,
    /// Swimmer and limits that the brain assumes until it is configured.
    pub belief: Configuration,
    /// Servo maps of the brain, until others are set.
    pub servos: [ServoSettings; 2],
    /// True servo maps, from pulse to shaft angle. A robot that has not been set up yet does not know them.
    pub shafts: [ServoMap; 2],
    /// A joint with a spring in place of its servo, with κ over one second; its pulses have no effect.
    pub passive: Option<PassiveJoint>,
    /// Velocity of the fluid in the tank \[m/s\].
    pub current: [f64; 2],
    /// Battery voltage, mV; the low-battery limit is 4400.
    pub battery_mv: u16,
    /// Cameras over the tank.
    pub camera: CameraConfig,
    /// Non-volatile memory.
    pub flash: MemoryStorage,
    /// Transport that the port represents. The user of a twin is at the robot (USB), unless the twin simulates a robot over
    /// radio.
    pub transport: Transport,
    /// Cause of the start.
    pub reset_reason: ResetReason,
    /// Seed of noise, starting pose and boot nonce.
    pub seed: u64,
}

impl TwinConfig {
    /// Configuration for the swimmer of a file, with the servos of its `[servo]` table or, without one, those of
    /// [`ServoFile::default`].
    ///
    /// The brain is configured for that swimmer, like a robot that its laboratory has set up: a gait for the file can be
    /// uploaded at once. To simulate unknown drag, configure it otherwise over the link.
    pub fn new(file: &SwimmerFile, seed: u64) -> Self {
        Self {
            passive: spring(file),
            ..Self::from_parts(file.swimmer, &file.servo.unwrap_or_default(), seed)
        }
    }

    /// Configuration for any swimmer with any servos.
    pub fn from_parts(swimmer: Swimmer<f64>, servo: &ServoFile, seed: u64) -> Self {
        let away = (servo.max_angle + TRIM_ROOM) / servo.slope_rad_per_us;
        let (low, high) = PULSE_WINDOW_US;
        let limits = Limits {
            max_angle: single(servo.max_angle),
            max_rate: single(servo.max_rate),
            pulse_min_ns: nanoseconds((servo.centre_us - away).max(low)),
            pulse_max_ns: nanoseconds((servo.centre_us + away).min(high)),
            centre_ns: nanoseconds(servo.centre_us),
            slope_rad_per_us: single(servo.slope_rad_per_us),
            ..Limits::ROBOT
        };
        let settings = ServoSettings {
            centre_ns: nanoseconds(servo.centre_us),
            slope_rad_per_us: single(servo.slope_rad_per_us),
            reversed: false,
            trim: 0,
        };
        Self {
            plant: PlantParameters {
                max_rate: servo.max_rate,
                dead_band: servo.dead_band,
                pulse_step_ns: 0,
            },
            limits,
            // `Twin::new` refuses a swimmer that has no configuration.
            belief: configuration(&swimmer, servo).unwrap_or_else(|_| {
                let links = swimmer.links;
                common_configuration(
                    &Swimmer {
                        links,
                        ..Swimmer::robot()
                    },
                    servo,
                )
            }),
            swimmer,
            servos: [settings; 2],
            shafts: [settings.into(); 2],
            passive: None,
            current: [0.0; 2],
            battery_mv: 5_200,
            camera: CameraConfig::default(),
            flash: MemoryStorage::erased(),
            transport: Transport::Usb,
            reset_reason: ResetReason::PowerOn,
            seed,
        }
    }

    /// Replaces the servos by ideal ones, whose angles equal the commands.
    #[must_use]
    pub fn with_ideal_servos(mut self) -> Self {
        self.plant = PlantParameters::IDEAL;
        self
    }

    /// Returns true if the port represents a radio, so that a sender need not be at the robot.
    pub fn is_by_radio(&self) -> bool {
        self.transport == Transport::Uart
    }

    /// Brain of this robot, before it has loaded its flash.
    pub(crate) fn brain(&self) -> Brain {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(1);
        Brain::new(BrainConfig {
            identity: Identity {
                firmware: FirmwareVersion {
                    major: env!("CARGO_PKG_VERSION_MAJOR").parse().unwrap_or(0),
                    minor: env!("CARGO_PKG_VERSION_MINOR").parse().unwrap_or(0),
                    patch: env!("CARGO_PKG_VERSION_PATCH").parse().unwrap_or(0),
                    commit: [0; 8],
                },
                board: Board::Twin,
            },
            limits: self.limits,
            configuration: self.belief,
            servos: self.servos,
            passive: self.passive.map(|passive| passive.joint),
            buffer: 2048,
            boot: Boot {
                reset_reason: self.reset_reason,
                ..Boot::power_on(rng.random(), rng.random())
            },
        })
    }
}

/// The passive joint of a file over one second. A file that was read has a fluid for a stiffness.
fn spring(file: &SwimmerFile) -> Option<PassiveJoint> {
    let passive = file.passive?;
    let model = Model::new(&file.swimmer).ok()?;
    let joint = passive.joint.0;
    let kappa = over_viscosity(passive.spring, &model, joint, file.fluid.as_ref()).ok()?;
    PassiveJoint::new(joint, kappa).ok()
}

/// Configuration message for a swimmer with the limits of its servos. The front and back links may differ.
///
/// # Errors
/// The message has one χ, one form of `c_t` and a sphere on the middle link; the swimmer needs others.
///
/// ```
/// use swimmer_files::{ServoFile, SwimmerFile};
///
/// let robot = SwimmerFile::preset("robot").unwrap().swimmer;
/// let configuration = twin::configuration(&robot, &ServoFile::default())?;
/// assert!((f64::from(configuration.chi) - 3.598).abs() < 1e-6);
/// # Ok::<(), swimmer_model::UncommonDrag>(())
/// ```
pub fn configuration(
    swimmer: &Swimmer<f64>,
    servo: &ServoFile,
) -> Result<Configuration, UncommonDrag> {
    swimmer.common_drag()?;
    Ok(common_configuration(swimmer, servo))
}

/// Configuration message for a swimmer with common drag.
fn common_configuration(swimmer: &Swimmer<f64>, servo: &ServoFile) -> Configuration {
    Configuration {
        middle_m: single(swimmer.links.middle),
        front_m: single(swimmer.links.front),
        back_m: single(swimmer.links.back),
        chi: single(swimmer.chi),
        tangential_drag: match swimmer.tangential_drag {
            TangentialDrag::LogAspect(value) => {
                link_protocol::TangentialDrag::LogAspect(single(value))
            }
            TangentialDrag::HalfThickness(value) => {
                link_protocol::TangentialDrag::HalfThickness(single(value))
            }
            TangentialDrag::OverViscosity(value) => {
                link_protocol::TangentialDrag::OverViscosity(single(value))
            }
            TangentialDrag::PerLink(_) => {
                link_protocol::TangentialDrag::OverViscosity(single(swimmer.side_drag()))
            }
        },
        sphere_radius_m: single(swimmer.sphere_radius),
        max_angle: single(servo.max_angle),
        max_rate: single(servo.max_rate),
    }
}

/// Returns true if a robot's configuration matches this swimmer's body, to the wire's precision; limits are ignored.
///
/// ```
/// use swimmer_files::{ServoFile, SwimmerFile};
///
/// let [robot, slender] = ["robot", "robot-slender"].map(|name| SwimmerFile::preset(name).unwrap().swimmer);
/// let configuration = twin::configuration(&robot, &ServoFile::default())?;
/// assert!(twin::is_configured_as(&configuration, &robot));
/// assert!(!twin::is_configured_as(&configuration, &slender));
/// # Ok::<(), swimmer_model::UncommonDrag>(())
/// ```
pub fn is_configured_as(present: &Configuration, swimmer: &Swimmer<f64>) -> bool {
    configuration(swimmer, &ServoFile::default()).is_ok_and(|of_swimmer| {
        let with_limits = Configuration {
            max_angle: present.max_angle,
            max_rate: present.max_rate,
            ..of_swimmer
        };
        with_limits == *present
    })
}

fn single(value: f64) -> f32 {
    <f32 as Scalar>::from_f64(value)
}

/// Converts µs inside the pulse window to whole ns.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn nanoseconds(us: f64) -> u32 {
    (us * 1000.0).round() as u32
}
