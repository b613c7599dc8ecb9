//! Bounds on shapes, as every command takes them from the command line.

use swimmer_files::Bounds;

use crate::arguments::{length, positive_angle};

/// Bounds that hold all round a gait.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct WholeBounds {
    /// No joint may turn further than this, either way
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    #[command(flatten)]
    links: LinkBounds,
}

/// The same, and those that are told of a quarter of the gait.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct QuarterBounds {
    /// No joint may turn further than this, either way
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    /// The leading joint of each quarter must turn at least this far
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    min_angle: Option<f64>,
    /// Each quarter stays in its sector, φ₂ ≥ |φ₁|
    #[arg(long)]
    sector: bool,
    #[command(flatten)]
    links: LinkBounds,
}

#[derive(Debug, Clone, Copy, clap::Args)]
struct LinkBounds {
    /// Links may not cross
    #[arg(long)]
    no_overlap: bool,
    /// Keep the centre lines of the side links this far apart, in metres; implies --no-overlap
    #[arg(long, value_name = "LENGTH_M", value_parser = length)]
    clearance: Option<f64>,
}

impl From<WholeBounds> for Bounds {
    fn from(told: WholeBounds) -> Self {
        Self {
            max_angle: told.max_angle,
            ..told.links.into()
        }
    }
}

impl From<QuarterBounds> for Bounds {
    fn from(told: QuarterBounds) -> Self {
        Self {
            max_angle: told.max_angle,
            min_angle: told.min_angle,
            sector: told.sector,
            ..told.links.into()
        }
    }
}

impl From<LinkBounds> for Bounds {
    fn from(told: LinkBounds) -> Self {
        Self {
            no_overlap: told.no_overlap || told.clearance.is_some(),
            clearance: told.clearance.unwrap_or(0.0),
            ..Self::default()
        }
    }
}
