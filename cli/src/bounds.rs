//! Bounds on shapes, as every command takes them from the command line.

use operations::bounds::BoundsRequest;

use crate::arguments::{length, positive_angle};

/// Bounds that hold all round a gait.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct CycleBounds {
    /// No joint may turn further than this, either way
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    #[command(flatten)]
    links: LinkBounds,
}

/// The same, and the bounds that are defined on a quarter of the gait.
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
    /// Links may not cross; a side link keeps 1e-6 rad off the middle one, on which it would lie at 180°
    #[arg(long)]
    no_overlap: bool,
    /// Keep the centre lines of the side links this far apart, in metres; implies --no-overlap
    #[arg(long, value_name = "LENGTH_M", value_parser = length)]
    clearance: Option<f64>,
    /// Keep within the angle of the swimmer file's servos and the clearance that the robot keeps, as it plays the gait by its
    /// table and servos; other bounds may be tighter. The rate of the joints depends on the period: it is not bounded here, a
    /// warning says if 30 s a cycle are too short
    #[arg(long)]
    playable: bool,
}

impl CycleBounds {
    /// The limits of the robot alone (`--playable`).
    pub(crate) fn for_playing() -> Self {
        Self {
            max_angle: None,
            links: LinkBounds {
                no_overlap: false,
                clearance: None,
                playable: true,
            },
        }
    }
}

impl From<CycleBounds> for BoundsRequest {
    fn from(given: CycleBounds) -> Self {
        Self {
            max_angle: given.max_angle,
            ..given.links.into()
        }
    }
}

impl From<QuarterBounds> for BoundsRequest {
    fn from(given: QuarterBounds) -> Self {
        Self {
            max_angle: given.max_angle,
            min_angle: given.min_angle,
            sector: given.sector,
            ..given.links.into()
        }
    }
}

impl From<LinkBounds> for BoundsRequest {
    fn from(given: LinkBounds) -> Self {
        Self {
            no_overlap: given.no_overlap,
            clearance: given.clearance.unwrap_or(0.0),
            playable: given.playable,
            ..Self::default()
        }
    }
}
