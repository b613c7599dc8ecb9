//! `swimmer height-map`: the height function of a swimmer, its zero-level curves, and what it says of gaits.

pub(crate) mod picture;

use std::fmt;
use std::path::PathBuf;

use clap::ValueEnum;
use gait_optimizer::{HeightMap as Map, Row};
use operations::height_map::{self, GaitArea, NamedGait};
use operations::{Context, GaitSource, SwimmerSource, robot_limits};
use swimmer_files::{GaitSpec, SwimmerFile};

use crate::arguments::{gait, positive_angle};
use crate::csv_text::csv_text;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::{Output, asides, verbose};
use crate::picture_file::{FigureOptions, Kind};
use crate::quantity::{self, Rows};

/// Map the height function, with its zero-level curves and gaits
///
/// In minimum-perturbation coordinates. A small loop run counter-clockwise displaces the swimmer by the height it encloses, times its area; a large one nearly
/// so (the area rule). A gait of most displacement goes round a region of one sign.
#[derive(Debug, clap::Args)]
pub(crate) struct HeightMap {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// Component of the displacement: along the swimmer, across it, or rotation
    #[arg(long, value_enum, default_value_t = Component::X)]
    row: Component,
    /// Map joint angles up to this, either way; the frame is the one that turns and sways least over just these
    #[arg(long, value_name = "ANGLE", default_value = "2.8", value_parser = positive_angle)]
    max_angle: f64,
    /// Lay this gait over the map and hold the area rule against what it swims; may be given several times
    #[arg(long = "gait", value_name = "GAIT", value_parser = gait)]
    gaits: Vec<GaitSpec>,
    /// Write the map: .svg, .png or .pdf as a figure, .csv as a table of φ₁, φ₂, H at 201 × 201 nodes
    #[arg(short, long, value_name = "FILE.svg|.png|.pdf|.csv")]
    output: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOptions,
}

/// A component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
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

impl From<Component> for height_map::Component {
    fn from(component: Component) -> Self {
        match component {
            Component::X => Self::X,
            Component::Y => Self::Y,
            Component::Theta => Self::Theta,
        }
    }
}

impl Component {
    /// Symbol of the height.
    fn symbol(self) -> &'static str {
        match self {
            Self::X => "H_x",
            Self::Y => "H_y",
            Self::Theta => "H_θ",
        }
    }

    /// Height with its unit.
    fn quantity(self) -> &'static str {
        match self {
            Self::X => "height H_x/L [rad⁻²]",
            Self::Y => "height H_y/L [rad⁻²]",
            Self::Theta => "height H_θ [rad⁻¹]",
        }
    }
}

impl HeightMap {
    /// Computes the map, writes the figure or table, and prints the output.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.output.as_deref().map_or(Ok(()), may_be_written)?;
        let kinds = [Kind::Svg, Kind::Png, Kind::Pdf, Kind::Csv];
        let kind = self.output.as_deref().map(|path| Kind::of(path, &kinds));
        let kind = kind.transpose()?;
        let width = self.figure.width(kind)?;
        let mut context = Context::on_disk();
        let read = self.read(&mut context);
        asides(&context);
        let (file, gaits) = read?;
        let map = Map::new(&file.swimmer, self.max_angle).map_err(operations::Error::from)?;
        let mut described = height_map::run(&map, self.row.into(), &gaits)?;
        if let (Some(path), Some(kind)) = (&self.output, kind) {
            let row = described.row.row();
            let text = match kind {
                Kind::Csv => table(&map, row)?,
                _ => picture::svg(&picture::Figure {
                    title: format!(
                        "{}, |φᵢ| ≤ {}",
                        file.name,
                        quantity::radians(self.max_angle)
                    ),
                    quantity: self.row.quantity(),
                    map: &map,
                    row,
                    curves: &described.zero_curves,
                    gaits: &gaits,
                    width,
                })?,
            };
            kind.write(path, &text, width)?;
        }
        described.written = self.output;
        output.rendered(
            &described,
            &Text {
                swimmer_name: &file.name,
                component: self.row,
                output: &described,
            },
        );
        Ok(())
    }

    /// Reads the swimmer and the gaits.
    fn read(
        &self,
        context: &mut Context,
    ) -> Result<(SwimmerFile, Vec<NamedGait>), operations::Error> {
        let file = SwimmerSource::from(self.swimmer.as_str()).load(context)?;
        let mut gaits = Vec::with_capacity(self.gaits.len());
        for spec in &self.gaits {
            let gait = GaitSource::from(spec.clone()).load_for(&file, context)?;
            gaits.push(NamedGait {
                name: spec.readable(),
                gait,
            });
        }
        for NamedGait { gait, .. } in &gaits {
            let warning = robot_limits::warning(&file, gait, robot_limits::PERIOD_S);
            context.warnings.extend(warning);
        }
        Ok((file, gaits))
    }
}

/// Output as text.
struct Text<'a> {
    swimmer_name: &'a str,
    component: Component,
    output: &'a height_map::Output,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            swimmer_name,
            component,
            output,
        } = self;
        let symbol = component.symbol();
        let per_length = match component {
            Component::X | Component::Y => "/L",
            Component::Theta => "",
        };
        let zeros = |zeros: &[f64]| match zeros {
            [] => "none".to_owned(),
            zeros => zeros
                .iter()
                .map(|zero| format!("{zero:.8} rad ({})", quantity::angle(*zero)))
                .collect::<Vec<_>>()
                .join(", "),
        };
        let curves = &output.zero_curves;
        let closed = curves.iter().filter(|curve| curve.closed).count();
        let open = curves.len() - closed;
        let mut rows = Rows::default();
        rows.row(
            "at the straight shape",
            format!(
                "{symbol}{per_length} = {:.10}",
                // Adding zero turns a rounded -0 into 0.
                (output.at_origin_over_length * 1e10).round() / 1e10 + 0.0
            ),
        )
        .row("zero where φ₁ = φ₂ > 0", zeros(&output.zeros_on_diagonal))
        .row(
            "zero where −φ₁ = φ₂ > 0",
            zeros(&output.zeros_on_antidiagonal),
        )
        .row(
            "zero-level curves",
            format!("{closed} closed, {open} from edge to edge"),
        );
        if verbose() {
            let convergence = output.convergence;
            rows.row(
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
        for rule in &output.gaits {
            rows.row(rule.gait.as_str(), area_rule(rule, *component));
        }
        if let Some(path) = &output.written {
            rows.row("written to", path.display().to_string());
        }
        write!(
            f,
            "{swimmer_name}, {symbol} on joint angles up to {}\n{rows}",
            quantity::radians(output.max_angle_rad)
        )
    }
}

/// Area rule of a gait as text.
fn area_rule(rule: &GaitArea, component: Component) -> String {
    let unit = match component {
        Component::X | Component::Y => " L",
        Component::Theta => " rad",
    };
    let index = height_map::Component::from(component).row().index();
    let [area, swum] = [rule.area[index], rule.swum[index]];
    let off = quantity::relative(area, swum)
        .filter(|off| off.abs() < 10.0)
        .map(|off| format!(" ({})", quantity::deviation(off)))
        .unwrap_or_default();
    format!(
        "encloses {:.6}{unit}, swims {:.6}{unit}{off}",
        rounded(area),
        rounded(swum)
    )
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
