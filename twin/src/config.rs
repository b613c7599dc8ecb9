//! What a twin is: the truth that only the tank knows, and what its brain believes at first.

use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use gait_player::storage::MemoryStorage;
use gait_player::{Boot, Brain, BrainConfig, Identity, Limits, Transport};
use link_protocol::{Board, Configuration, FirmwareVersion, ResetReason, ServoSettings};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{ServoFile, SwimmerFile};
use swimmer_model::{Scalar, Swimmer, TangentialDrag};

use crate::camera::CameraConfig;

/// Pulses outside are never sent by any servo of this kind, µs: beyond, a sail winch may spin on.
const PULSE_WINDOW_US: (f64, f64) = (600.0, 2400.0);
/// Angle by which the pulse window exceeds the largest angle, for the trim, rad.
const TRIM_ROOM: f64 = 0.4;

/// Everything a twin is made of.
#[derive(Debug, Clone)]
pub struct TwinConfig {
    /// The swimmer that swims in the tank.
    pub swimmer: Swimmer<f64>,
    /// Its servos' shafts.
    pub plant: PlantParameters,
    /// The limits of its firmware.
    pub limits: Limits,
    /// What the brain believes of swimmer and limits until it is configured.
    pub belief: Configuration,
    /// The servos' maps in the brain, until others are set.
    pub servos: [ServoSettings; 2],
    /// The same in truth: what a pulse turns them to. A robot that nobody has set up yet does not know.
    pub shafts: [ServoMap; 2],
    /// Its battery, mV; the limits' own is 4400.
    pub battery_mv: u16,
    /// The cameras over the tank.
    pub camera: CameraConfig,
    /// Its non-volatile memory.
    pub flash: MemoryStorage,
    /// What its port is to it. Whoever runs a twin sits beside it: USB, until it is to play a robot across the room.
    pub transport: Transport,
    /// How it came up.
    pub reset_reason: ResetReason,
    /// Where noise, starting pose and the boot nonce come from.
    pub seed: u64,
}

impl TwinConfig {
    /// A twin of the swimmer of a file, with the servos of its `[servo]` table or, without one, those of
    /// [`ServoFile::default`].
    ///
    /// The brain is configured for that swimmer, as a robot is that its laboratory has set up: a gait made for the file can be
    /// uploaded at once. Who plays a laboratory that does not know the drag yet configures it otherwise, over the link.
    pub fn new(file: &SwimmerFile, seed: u64) -> Self {
        Self::from_parts(file.swimmer, &file.servo.unwrap_or_default(), seed)
    }

    /// A twin of any swimmer with any servos.
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
            belief: configuration(&swimmer, servo),
            swimmer,
            servos: [settings; 2],
            shafts: [settings.into(); 2],
            battery_mv: 5_200,
            camera: CameraConfig::default(),
            flash: MemoryStorage::erased(),
            transport: Transport::Usb,
            reset_reason: ResetReason::PowerOn,
            seed,
        }
    }

    /// Servos that are where they are told to be.
    #[must_use]
    pub fn with_ideal_servos(mut self) -> Self {
        self.plant = PlantParameters::IDEAL;
        self
    }

    /// Returns true if the robot's port counts as a radio, so that whoever speaks there need not be at the robot.
    pub fn is_by_radio(&self) -> bool {
        self.transport == Transport::Uart
    }

    /// The brain of such a robot, before it has loaded its flash.
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
            buffer: 2048,
            boot: Boot {
                reset_reason: self.reset_reason,
                ..Boot::power_on(rng.random(), rng.random())
            },
        })
    }
}

/// The configuration message for a swimmer with the limits of its servos.
///
/// ```
/// use swimmer_files::{ServoFile, SwimmerFile};
///
/// let robot = SwimmerFile::preset("robot").unwrap().swimmer;
/// let told = twin::configuration(&robot, &ServoFile::default());
/// assert!((f64::from(told.chi) - 3.598).abs() < 1e-6);
/// ```
pub fn configuration(swimmer: &Swimmer<f64>, servo: &ServoFile) -> Configuration {
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
        },
        sphere_radius_m: single(swimmer.sphere_radius),
        max_angle: single(servo.max_angle),
        max_rate: single(servo.max_rate),
    }
}

/// Whether a robot's configuration is this swimmer's body, to the wire's precision; its limits do not matter.
///
/// ```
/// use swimmer_files::{ServoFile, SwimmerFile};
///
/// let [robot, slender] = ["robot", "robot-slender"].map(|name| SwimmerFile::preset(name).unwrap().swimmer);
/// let told = twin::configuration(&robot, &ServoFile::default());
/// assert!(twin::is_configured_as(&told, &robot));
/// assert!(!twin::is_configured_as(&told, &slender));
/// ```
pub fn is_configured_as(present: &Configuration, swimmer: &Swimmer<f64>) -> bool {
    let told = configuration(swimmer, &ServoFile::default());
    Configuration {
        max_angle: present.max_angle,
        max_rate: present.max_rate,
        ..told
    } == *present
}

fn single(value: f64) -> f32 {
    <f32 as Scalar>::from_f64(value)
}

/// Whole nanoseconds of microseconds inside the pulse window, which fit.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn nanoseconds(us: f64) -> u32 {
    (us * 1000.0).round() as u32
}
