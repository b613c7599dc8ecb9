//! `swimmer height-map`: the height function of a swimmer, its zero-level curves, and what it says of gaits.

pub(crate) mod picture;

use std::path::PathBuf;

use clap::ValueEnum;
use gait_optimizer::{AreaRule, HeightMap as Map, HeightMapError, LevelCurve, Row};
use serde::Serialize;
use swimmer_files::GaitSpec;

use crate::arguments::{gait, load_gait_for, load_swimmer, positive_angle};
use crate::csv_text::csv_text;
use crate::document::{Document, object};
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::{Output, verbose};
use crate::own_robot::{PERIOD_S, say_if_beyond};
use crate::picture_file::Kind;
use crate::quantity;

/// Map the height function, with its zero-level curves and gaits
///
/// In minimum-perturbation coordinates. A small loop run counter-clockwise displaces the swimmer by the height it encloses, times its area; a large one nearly
/// so (the area rule). A gait of most displacement goes round a region of one sign.
#[derive(Debug, clap::Args)]
pub(crate) struct HeightMap {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// Which displacement: along the swimmer, across it, or rotation
    #[arg(long, value_enum, default_value_t = Component::X)]
    row: Component,
    /// Map joint angles up to this, either way; the frame is the one that turns and sways least over just these
    #[arg(long, value_name = "ANGLE", default_value = "2.8", value_parser = positive_angle)]
    max_angle: f64,
    /// Lay this gait over the map and hold the area rule against what it swims; may be given several times
    #[arg(long = "gait", value_name = "GAIT", value_parser = gait)]
    gaits: Vec<GaitSpec>,
    /// Write the map: .svg or .png as a figure, .csv as a table of φ₁, φ₂, H at 201 × 201 nodes
    #[arg(short, long, value_name = "FILE.svg|.png|.csv")]
    output: Option<PathBuf>,
}

/// A component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Component {
    /// Along the swimmer, over L
    X,
    /// Across the swimmer, over L
    Y,
    /// Rotation
    Theta,
}

/// Nodes of the table in each direction.
const TABLE: usize = 201;

impl Component {
    fn row(self) -> Row {
        match self {
            Self::X => Row::X,
            Self::Y => Row::Y,
            Self::Theta => Row::Theta,
        }
    }

    /// As people write it.
    fn symbol(self) -> &'static str {
        match self {
            Self::X => "H_x",
            Self::Y => "H_y",
            Self::Theta => "H_θ",
        }
    }

    /// With its unit.
    fn quantity(self) -> &'static str {
        match self {
            Self::X => "H_x/L [rad⁻²]",
            Self::Y => "H_y/L [rad⁻²]",
            Self::Theta => "H_θ [rad⁻¹]",
        }
    }
}

impl HeightMap {
    /// Maps, writes and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.output.as_deref().map_or(Ok(()), may_be_written)?;
        let kinds = [Kind::Svg, Kind::Png, Kind::Csv];
        let kind = self.output.as_deref().map(|path| Kind::of(path, &kinds));
        let kind = kind.transpose()?;
        let file = load_swimmer(&self.swimmer)?;
        let gaits = self
            .gaits
            .iter()
            .map(|spec| Ok((spec.readable(), load_gait_for(&file, spec)?)))
            .collect::<Outcome<Vec<_>>>()?;
        for (_, gait) in &gaits {
            say_if_beyond(&file, gait, PERIOD_S);
        }
        let map = Map::new(&file.swimmer, self.max_angle)?;
        let row = self.row.row();
        let curves = map.zero_curves(row);
        let rules = gaits
            .iter()
            .map(|(_, gait)| Ok(map.area_rule(gait)?))
            .collect::<Outcome<Vec<_>>>()?;
        if let (Some(path), Some(kind)) = (&self.output, kind) {
            let text = match kind {
                Kind::Csv => table(&map, row)?,
                _ => picture::svg(&picture::Figure {
                    title: format!("{}, |φᵢ| ≤ {} rad", file.name, self.max_angle),
                    quantity: self.row.quantity(),
                    map: &map,
                    row,
                    curves: &curves,
                    gaits: &gaits,
                })?,
            };
            kind.write(path, &text)?;
        }
        let mut answer = Document::new(format!(
            "{}, {} on joint angles up to {} rad",
            file.name,
            self.row.symbol(),
            self.max_angle
        ));
        self.tell(&mut answer, &map, curves);
        let rules: Vec<_> = gaits
            .iter()
            .zip(&rules)
            .map(|((name, _), rule)| self.tell_rule(&mut answer, name, rule))
            .collect();
        answer.key("gaits", rules);
        if let Some(path) = self.output {
            answer.row("written to", path.display().to_string());
            answer.key("written", path);
        }
        output.answer(&answer);
        Ok(())
    }

    /// Adds what the map and its zero-level curves say.
    fn tell(&self, answer: &mut Document, map: &Map, curves: Vec<LevelCurve>) {
        let row = self.row.row();
        let per_length = match self.row {
            Component::X | Component::Y => "/L",
            Component::Theta => "",
        };
        let at_origin = map.height(row, &[0.0, 0.0].into());
        let (on_diagonal, on_antidiagonal) =
            (map.zeros_on_diagonal(row), map.zeros_on_antidiagonal(row));
        let zeros = |zeros: &[f64]| match zeros {
            [] => "none".to_owned(),
            zeros => zeros
                .iter()
                .map(|zero| format!("{zero:.8} rad ({})", quantity::angle(*zero)))
                .collect::<Vec<_>>()
                .join(", "),
        };
        let closed = curves.iter().filter(|curve| curve.closed).count();
        let open = curves.len() - closed;
        answer
            .row(
                "at the straight shape",
                format!(
                    "{}{per_length} = {:.10}",
                    self.row.symbol(),
                    // Adding zero turns a rounded -0 into 0.
                    (at_origin * 1e10).round() / 1e10 + 0.0
                ),
            )
            .row("zero where φ₁ = φ₂ > 0", zeros(&on_diagonal))
            .row("zero where −φ₁ = φ₂ > 0", zeros(&on_antidiagonal))
            .row(
                "zero-level curves",
                format!("{closed} closed, {open} from edge to edge"),
            );
        let convergence = map.convergence();
        if verbose() {
            answer.row(
                "frame",
                format!(
                    "order {}; from order {} it moved {:.0e} inside, {:.0e} at the corners",
                    convergence.order,
                    convergence.order_before,
                    convergence.inner_change,
                    convergence.change
                ),
            );
        }
        answer
            .key("row", self.row)
            // D: the frame is the best over |φᵢ| ≤ D.
            .key("max_angle_rad", self.max_angle)
            // For the row theta in rad/rad².
            .key("at_origin_over_length", at_origin)
            // φ₂ of the first zeros with φ₁ = φ₂ > 0 and with φ₁ = −φ₂ < 0, and of all.
            .key("zero_on_diagonal", on_diagonal.first().copied())
            .key("zero_on_antidiagonal", on_antidiagonal.first().copied())
            .key("zeros_on_diagonal", on_diagonal)
            .key("zeros_on_antidiagonal", on_antidiagonal)
            .key("convergence", convergence)
            .key("zero_curves", curves);
    }

    /// Adds the area rule for one gait; its keys, x and y over L and θ in rad.
    fn tell_rule(&self, answer: &mut Document, gait: &str, rule: &AreaRule) -> Document {
        let over_length = match self.row {
            Component::X | Component::Y => " L",
            Component::Theta => " rad",
        };
        let component = self.row.row().index();
        let [area, swum] = [rule.area, rule.swum].map(|values| values[component]);
        let off = quantity::relative(area, swum)
            .filter(|off| off.abs() < 10.0)
            .map(|off| format!(" ({})", quantity::deviation(off)))
            .unwrap_or_default();
        answer.row(
            gait,
            format!(
                "encloses {:.6}{over_length}, swims {:.6}{over_length}{off}",
                rounded(area),
                rounded(swum)
            ),
        );
        let of = |values: nalgebra::Vector3<f64>| <[f64; 3]>::from(values);
        object! {
            "gait": gait.to_owned(),
            // ∬ H over what the gait encloses, seen from the middle link at the gait's start, and the same as swum.
            "area": of(rule.area),
            "swum": of(rule.swum),
            "deviation": of(rule.deviation()),
        }
    }
}

fn table(map: &Map, row: Row) -> Outcome<String> {
    let grid = map.grid(row, TABLE);
    let mut rows = Vec::with_capacity(grid.heights.len());
    for (phi2, column) in grid.angles.iter().zip(grid.heights.column_iter()) {
        let nodes = grid.angles.iter().zip(column.iter());
        rows.extend(nodes.map(|(phi1, height)| [*phi1, *phi2, *height]));
    }
    csv_text("phi1,phi2,H".split(','), rows)
}

/// To six decimals, without a minus before zero.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

impl From<HeightMapError> for Failure {
    /// A swimmer, square or gait that makes no sense is bad input; one that does not converge was tried.
    fn from(error: HeightMapError) -> Self {
        match error {
            HeightMapError::NotConverged { .. } => Self::tried(&error),
            _ => Self::bad_input(&error),
        }
    }
}
