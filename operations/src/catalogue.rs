//! Swimmers and gaits that need no file.

use serde::Serialize;
use swimmer_files::SwimmerFile;

use crate::Error;

/// Optional keys that the file of a viscous preset lacks, as comments.
const OPTIONAL: &str = "
# What follows is optional; take the # away where you know it.
#[fluid]                      # for newtons and watts
#kinematic_viscosity = 0.06   # m^2/s
#density = 976.0              # kg/m^3

#[servo]                      # `swimmer robot setup` measures these
#max_angle = 2.8              # rad
#max_rate = 3.5               # rad/s
#dead_band = 0.017            # rad, half its width
#slope_rad_per_us = 0.0274    # joint angle for a microsecond of pulse
#centre_us = 1500.0           # pulse of the straight joint
#torque_n_m = 0.6             # what the servo has at the joint, standing still
#no_load_rate = 5.2           # rad/s, where that torque has fallen to 0
";

/// All presets. The JSON document of `swimmer swimmers`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SwimmersOutput {
    /// The presets.
    pub swimmers: Vec<PresetOutput>,
}

/// A preset.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PresetOutput {
    /// Name.
    pub name: &'static str,
    /// Description.
    pub what: &'static str,
    /// Lengths of the front, the middle and the back link \[m\].
    pub links_m: [f64; 3],
    /// Drag ratio; null outside a viscous fluid.
    pub chi: Option<f64>,
    /// Radius of the sphere \[m\].
    pub sphere_radius_m: f64,
}

/// A preset as a file to start from. The JSON document of `swimmer swimmers NAME`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PresetFileOutput")
)]
pub struct SwimmerOutput {
    /// Name.
    pub name: String,
    /// Text of the file, with comments.
    pub toml: String,
}

/// Forms of gaits. The JSON document of `swimmer gaits`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaitsOutput {
    /// The forms.
    pub gaits: Vec<GaitFormOutput>,
}

/// A form of gaits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaitFormOutput {
    /// Example.
    pub form: &'static str,
    /// Description.
    pub what: &'static str,
}

/// Lists the presets.
pub fn swimmers() -> SwimmersOutput {
    let presets = SwimmerFile::PRESETS.into_iter();
    let swimmers = presets.filter_map(|name| {
        let SwimmerFile { swimmer, .. } = SwimmerFile::preset(name)?;
        let links = &swimmer.links;
        Some(PresetOutput {
            name,
            what: description(name),
            links_m: [links.front, links.middle, links.back],
            chi: swimmer.is_viscous().then_some(swimmer.chi),
            sphere_radius_m: swimmer.sphere_radius,
        })
    });
    SwimmersOutput {
        swimmers: swimmers.collect(),
    }
}

fn description(name: &str) -> &'static str {
    match name {
        "purcell" => "Purcell's swimmer, three equal slender links",
        "robot" => "the paper's robot, its drag fitted",
        "perfect-fluid" => "ellipses in a perfect fluid (Hatton, Choset 2013)",
        "kinematic-snake" => "links on wheels (Shammas, Choset, Rizzi 2007)",
        "elastic-tail" => "Purcell's swimmer with a spring at the back joint (Passov and Or, 2012)",
        _ => "the paper's robot as slender-body theory has it",
    }
}

/// Returns a preset as a file to start from.
///
/// # Errors
/// There is no preset of this name.
pub fn swimmer(name: &str) -> Result<SwimmerOutput, Error> {
    let preset = SwimmerFile::preset(name).ok_or_else(|| {
        Error::refused(format!(
            "there is no swimmer `{name}`; there are {}",
            SwimmerFile::PRESETS.join(", ")
        ))
    })?;
    let mut toml = preset.to_toml();
    if preset.swimmer.is_viscous() {
        toml.push_str(OPTIONAL);
    }
    Ok(SwimmerOutput {
        name: name.to_owned(),
        toml,
    })
}

/// Lists the forms of gaits.
pub fn gaits() -> GaitsOutput {
    let forms = [
        (
            "circle:70deg",
            "joint angles on a circle of this radius, counter-clockwise",
        ),
        (
            "square:70deg",
            "the square with corners at ±70° and ±70°, counter-clockwise",
        ),
        (
            "best.gait",
            "a gait file, as `swimmer optimize … -o best.gait` writes it",
        ),
        ("circle:70deg:cw", "any of them the other way round"),
    ];
    GaitsOutput {
        gaits: forms
            .map(|(form, what)| GaitFormOutput { form, what })
            .into(),
    }
}
