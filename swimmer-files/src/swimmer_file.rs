//! The swimmer file: one robot's lengths and drag, and, where known, its fluid and its servos.

mod per_link;
mod read;
mod write;

use std::path::Path;

use link_protocol::Joint;
use swimmer_model::{Link, Swimmer};

use crate::file_error::read_text;
use crate::{FileError, JointName, PassiveFile, Spring, SwimmerHash, write_atomically};

/// Contents of a swimmer file.
#[derive(Debug, Clone, PartialEq)]
pub struct SwimmerFile {
    /// Name of the swimmer for people.
    pub name: String,
    /// Links \[m\], drag and sphere.
    pub swimmer: Swimmer<f64>,
    /// The fluid, for watts and newtons; displacement and efficiency do not need it.
    pub fluid: Option<Fluid>,
    /// The servos; `None` means ideal ones.
    pub servo: Option<ServoFile>,
    /// A joint with a spring in place of its servo; `None` if both joints have servos.
    pub passive: Option<PassiveFile>,
}

/// The `[fluid]` table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fluid {
    /// Kinematic viscosity ν \[m²/s\].
    pub kinematic_viscosity: f64,
    /// Density ρ \[kg/m³\].
    pub density: f64,
}

impl Fluid {
    /// Dynamic viscosity μ = ν ρ \[Pa s\].
    pub fn viscosity(&self) -> f64 {
        self.kinematic_viscosity * self.density
    }
}

/// The `[servo]` table. A key that is left out takes the value of [`ServoFile::default`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoFile {
    /// Largest joint angle, either way \[rad\].
    pub max_angle: f64,
    /// Fastest turn \[rad/s\].
    pub max_rate: f64,
    /// Half-width of the dead band \[rad\]; 0 for none.
    pub dead_band: f64,
    /// Angle for a microsecond of pulse \[rad/µs\].
    pub slope_rad_per_us: f64,
    /// Pulse of the straight joint \[µs\].
    pub centre_us: f64,
    /// Largest torque at the joint \[N m\], where it is known.
    pub torque: Option<f64>,
    /// Rate without a load \[rad/s\], if it is known; the torque falls linearly to 0 at this rate.
    pub no_load_rate: Option<f64>,
}

impl Default for ServoFile {
    /// The servos that the twin and the demo take where the file names none: sail winches of the paper's robot, geared
    /// and trimmed, with a dead band of about one degree.
    fn default() -> Self {
        Self {
            max_angle: 2.8,
            max_rate: 3.5,
            dead_band: 0.017,
            slope_rad_per_us: 0.0274,
            centre_us: 1500.0,
            torque: None,
            no_load_rate: None,
        }
    }
}

impl SwimmerFile {
    /// The presets' names, as [`SwimmerFile::preset`] takes them.
    pub const PRESETS: [&'static str; 6] = [
        "purcell",
        "robot",
        "robot-slender",
        "perfect-fluid",
        "kinematic-snake",
        "elastic-tail",
    ];

    /// Returns a preset by its name, one of [`SwimmerFile::PRESETS`]; none of them names a fluid or servos.
    ///
    /// `elastic-tail` is Purcell's swimmer with a torsion spring at the back joint: E. Passov and Y. Or, *Dynamics of Purcell's
    /// three-link microswimmer with a passive elastic tail*, Eur. Phys. J. E 35, 78 (2012). Its stiffness over `c_t l³` is 1/s.
    pub fn preset(name: &str) -> Option<Self> {
        let mut passive = None;
        let swimmer = match name {
            "purcell" => Swimmer::purcell(),
            "robot" => Swimmer::robot(),
            "robot-slender" => Swimmer::robot_slender(),
            "perfect-fluid" => Swimmer::perfect_fluid(),
            "kinematic-snake" => Swimmer::kinematic_snake(),
            "elastic-tail" => {
                passive = Some(PassiveFile {
                    joint: JointName(Joint::Back),
                    // W₂₂ of the straight swimmer is 16/81 c_t l³.
                    spring: Spring::Relaxation(16.0 / 81.0),
                });
                Swimmer::purcell()
            }
            _ => return None,
        };
        Some(Self {
            name: name.to_owned(),
            swimmer,
            fluid: None,
            servo: None,
            passive,
        })
    }

    /// Resolves `--swimmer`: a preset's name, else the path of a swimmer file.
    ///
    /// # Errors
    /// [`FileError`] when it is neither, or the file is not a swimmer file.
    pub fn find(preset_or_path: &str) -> Result<Self, FileError> {
        Self::find_from(preset_or_path, Path::new(""))
    }

    /// The same, with paths relative to `folder` (a campaign's own folder).
    ///
    /// # Errors
    /// As [`SwimmerFile::find`].
    pub fn find_from(preset_or_path: &str, folder: &Path) -> Result<Self, FileError> {
        if let Some(preset) = Self::preset(preset_or_path) {
            return Ok(preset);
        }
        let path = folder.join(preset_or_path);
        Self::load(&path).map_err(|error| match error {
            FileError::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
                FileError::Read {
                    path,
                    source: std::io::Error::new(
                        source.kind(),
                        format!(
                            "{source}, and it is not one of the presets {}{}",
                            Self::PRESETS.join(", "),
                            meant(preset_or_path)
                        ),
                    ),
                }
            }
            other => other,
        })
    }

    /// Reads a swimmer file.
    ///
    /// # Errors
    /// [`FileError`] with line and column: unknown keys, missing keys, values out of range.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// Reads a swimmer file's text; `path` is only for the errors and, where the file has no name, for the name.
    ///
    /// # Errors
    /// As [`SwimmerFile::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        read::swimmer_file(text, path)
    }

    /// Writes a swimmer file; reading it again gives the same numbers to the last bit.
    ///
    /// # Errors
    /// [`FileError::Write`]; what was there before stays.
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        write_atomically(path, self.to_toml().as_bytes())
    }

    /// The file's text.
    pub fn to_toml(&self) -> String {
        write::swimmer_toml(self)
    }

    /// Possible but unlikely values, each in a sentence with its physics.
    pub fn doubts(&self) -> Vec<String> {
        let swimmer = &self.swimmer;
        let sphere_radius = swimmer.sphere_radius;
        let length = swimmer.total_length();
        let mut doubts = Vec::new();
        if !swimmer.is_viscous() {
            return doubts;
        }
        let chi = [Link::Middle, Link::Front, Link::Back]
            .map(|link| swimmer.chi_of(link))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        if sphere_radius > length {
            let link = match swimmer.sphere_on {
                Link::Middle => "middle",
                Link::Front => "front",
                Link::Back => "back",
            };
            doubts.push(format!(
                "a sphere of radius {sphere_radius} m holds the {link} link of a swimmer {length:.3} m long all but still, and its \
                 flow would reach the links, which this model leaves out; [sphere] radius is in metres"
            ));
        }
        if chi < 1.0 {
            doubts.push(format!(
                "chi = c_n/c_t = {chi} says that a link slides across more easily than along; a slender rod in a viscous fluid \
                 has chi above 1 (2 far from walls), and below 1 small gaits swim backwards: were the two exchanged?"
            ));
        }
        doubts
    }

    /// The fingerprint of the swimmer (not of its name, fluid or servos).
    pub fn hash(&self) -> SwimmerHash {
        SwimmerHash::of(&self.swimmer)
    }

    /// This file with the fitted sphere radius \[m\] and χ in place of its own, and a name that says so.
    #[must_use]
    pub fn fitted(&self, sphere_radius: f64, chi: f64) -> Self {
        let mut fitted = self.clone();
        fitted.swimmer.sphere_radius = sphere_radius;
        fitted.swimmer.chi = chi;
        if !fitted.name.ends_with(", fitted") {
            fitted.name.push_str(", fitted");
        }
        fitted
    }
}

/// The preset that was meant, where one is near.
fn meant(name: &str) -> String {
    let near = SwimmerFile::PRESETS
        .into_iter()
        .map(|preset| (strsim::jaro_winkler(preset, name), preset))
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .filter(|(near, _)| *near > 0.8);
    near.map_or_else(String::new, |(_, preset)| {
        format!(" (did you mean {preset}?)")
    })
}
