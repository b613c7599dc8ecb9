//! `swimmer swimmers` and `swimmer gaits`: what may stand for SWIMMER and GAIT without a file, and a file to start from.

use swimmer_files::SwimmerFile;

use crate::document::{Document, object};
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

impl Swimmers {
    pub(crate) fn run(self, output: Output) -> Outcome {
        let Some(name) = self.name else {
            output.print(&presets());
            return Ok(());
        };
        let Some(preset) = SwimmerFile::preset(&name) else {
            return Err(Failure::BadInput(format!(
                "there is no swimmer `{name}`; there are {}",
                SwimmerFile::PRESETS.join(", ")
            )));
        };
        let mut toml = preset.to_toml();
        if preset.swimmer.is_viscous() {
            toml.push_str(OPTIONAL);
        }
        let mut answer = Document::new(toml.trim_end());
        output.print(answer.key("name", name).key("toml", toml));
        Ok(())
    }
}

/// Those that need no file.
fn presets() -> Document {
    let mut table = Table::new(["swimmer", "front", "middle", "back", "χ", "sphere", "what"]);
    let mut swimmers = Vec::new();
    for name in SwimmerFile::PRESETS {
        let Some(SwimmerFile { swimmer, .. }) = SwimmerFile::preset(name) else {
            continue;
        };
        let what = match name {
            "purcell" => "Purcell's swimmer, three equal slender links",
            "robot" => "the paper's robot, its drag fitted",
            "perfect-fluid" => "ellipses in a perfect fluid (Hatton, Choset 2013)",
            "kinematic-snake" => "links on wheels (Shammas, Choset, Rizzi 2007)",
            "elastic-tail" => {
                "Purcell's swimmer with a spring at the back joint (Passov and Or, 2012)"
            }
            _ => "the paper's robot as slender-body theory has it",
        };
        let links = &swimmer.links;
        let links = [links.front, links.middle, links.back];
        // Drag is that of a viscous fluid.
        let chi = swimmer.is_viscous().then_some(swimmer.chi);
        let [front, middle, back] = links.map(quantity::length);
        table.line([
            name.to_owned(),
            front,
            middle,
            back,
            chi.map_or_else(|| "–".to_owned(), |chi| chi.to_string()),
            quantity::length(swimmer.sphere_radius),
            what.to_owned(),
        ]);
        swimmers.push(object! {
            "name": name,
            "what": what,
            "links_m": links,
            "chi": chi,
            "sphere_radius_m": swimmer.sphere_radius,
        });
    }
    let mut answer = Document::new(table.to_string());
    answer
        .line("`swimmer swimmers NAME` prints one as a file to start from.")
        .key("swimmers", swimmers);
    answer
}

impl Gaits {
    #[allow(clippy::unused_self)] // as every command
    pub(crate) fn run(self, output: Output) {
        let mut answer = Document::new("GAIT is one of");
        let gaits = [
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
        let gaits = gaits.map(|(form, what)| {
            answer.row(form, what);
            object! {"form": form, "what": what}
        });
        output.print(answer.key("gaits", gaits));
    }
}
