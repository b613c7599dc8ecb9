//! `swimmer swimmers` and `swimmer gaits`: what may stand for SWIMMER and GAIT without a file, and a file to start from.

use std::fmt;

use serde::Serialize;
use swimmer_files::SwimmerFile;

use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{self, Table};

/// List the swimmers that need no file, or print one as a commented file to start from
#[derive(Debug, clap::Args)]
pub(crate) struct Swimmers {
    /// Print this one, as the file that describes it: `swimmer swimmers robot > ours.toml`
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// List what may stand for GAIT
#[derive(Debug, clap::Args)]
pub(crate) struct Gaits;

/// What a preset's file does not have, to be filled in.
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

impl Swimmers {
    pub(crate) fn run(self, output: Output) -> Outcome {
        let Some(name) = self.name else {
            output.answer(&Presets::default());
            return Ok(());
        };
        let Some(preset) = SwimmerFile::preset(&name) else {
            return Err(Failure::BadInput(format!(
                "there is no swimmer `{name}`; there are {}",
                SwimmerFile::PRESETS.join(", ")
            )));
        };
        let toml = preset.to_toml() + OPTIONAL;
        output.answer(&Preset { name, toml });
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Preset {
    name: String,
    toml: String,
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.toml.trim_end())
    }
}

#[derive(Debug, Serialize)]
struct Presets {
    swimmers: Vec<Known>,
}

#[derive(Debug, Serialize)]
struct Known {
    name: &'static str,
    what: &'static str,
    links_m: [f64; 3],
    chi: f64,
    sphere_radius_m: f64,
}

impl Default for Presets {
    fn default() -> Self {
        let known = |name: &'static str| {
            let swimmer = SwimmerFile::preset(name)?.swimmer;
            Some(Known {
                name,
                what: match name {
                    "purcell" => "Purcell's swimmer, three equal slender links",
                    "robot" => "the paper's robot, its drag fitted",
                    _ => "the paper's robot as slender-body theory has it",
                },
                links_m: [
                    swimmer.links.front,
                    swimmer.links.middle,
                    swimmer.links.back,
                ],
                chi: swimmer.chi,
                sphere_radius_m: swimmer.sphere_radius,
            })
        };
        Self {
            swimmers: SwimmerFile::PRESETS.into_iter().filter_map(known).collect(),
        }
    }
}

impl fmt::Display for Presets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new(["swimmer", "front", "middle", "back", "χ", "sphere", "what"]);
        for known in &self.swimmers {
            let [front, middle, back] = known.links_m.map(quantity::length);
            table.line([
                known.name.to_owned(),
                front,
                middle,
                back,
                known.chi.to_string(),
                quantity::length(known.sphere_radius_m),
                known.what.to_owned(),
            ]);
        }
        write!(
            f,
            "{table}\n`swimmer swimmers NAME` prints one as a file to start from."
        )
    }
}

#[derive(Debug, Serialize)]
struct Forms {
    gaits: [Form; 4],
}

#[derive(Debug, Serialize)]
struct Form {
    form: &'static str,
    what: &'static str,
}

impl Gaits {
    #[allow(clippy::unused_self)] // as every command
    pub(crate) fn run(self, output: Output) {
        let form = |form, what| Form { form, what };
        output.answer(&Forms {
            gaits: [
                form(
                    "circle:70deg",
                    "joint angles on a circle of this radius, counter-clockwise",
                ),
                form(
                    "square:70deg",
                    "the square with corners at ±70° and ±70°, counter-clockwise",
                ),
                form(
                    "best.gait",
                    "a gait file, as `swimmer optimize … -o best.gait` writes it",
                ),
                form("circle:70deg:cw", "any of them the other way round"),
            ],
        });
    }
}

impl fmt::Display for Forms {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = quantity::Rows::default();
        for gait in &self.gaits {
            rows.row(gait.form, gait.what);
        }
        write!(f, "GAIT is one of\n{rows}")
    }
}
