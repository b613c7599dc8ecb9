//! `swimmer swimmers` and `swimmer gaits`: swimmers and gaits that need no file, and a file to start from.

use operations::catalogue;

use crate::failure::Outcome;
use crate::output::Output;
use crate::quantity::{self, Rows, Table};

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

impl Swimmers {
    pub(crate) fn run(self, output: Output) -> Outcome {
        if let Some(name) = self.name {
            let preset = catalogue::swimmer(&name)?;
            output.rendered(&preset, &preset.toml.trim_end());
        } else {
            let presets = catalogue::swimmers();
            output.rendered(&presets, &text(&presets));
        }
        Ok(())
    }
}

/// Presets as a table.
fn text(output: &catalogue::SwimmersOutput) -> String {
    let mut table = Table::new(["swimmer", "front", "middle", "back", "χ", "sphere", "what"]);
    for preset in &output.swimmers {
        let [front, middle, back] = preset.links_m.map(quantity::length);
        table.line([
            preset.name.to_owned(),
            front,
            middle,
            back,
            preset
                .chi
                .map_or_else(|| "–".to_owned(), |chi| chi.to_string()),
            quantity::length(preset.sphere_radius_m),
            preset.what.to_owned(),
        ]);
    }
    format!("{table}\n`swimmer swimmers NAME` prints one as a file to start from.")
}

impl Gaits {
    #[allow(clippy::unused_self)] // as every command
    pub(crate) fn run(self, output: Output) {
        let forms = catalogue::gaits();
        let mut rows = Rows::default();
        for form in &forms.gaits {
            rows.row(form.form, form.what);
        }
        output.rendered(&forms, &format!("GAIT is one of\n{rows}"));
    }
}
