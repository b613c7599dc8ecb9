//! Bounds on shapes, as every command takes them from the command line.

use operations::bounds::BoundsRequest;
use swimmer_files::{ArcKind, Bounds, SwimmerFile};

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

/// The options that bounds were given by, so that a refusal names those that are there.
pub(crate) trait Given {
    /// Those by which a gait runs along arcs of this kind; of no kind, all.
    fn given(&self, kind: Option<ArcKind>) -> Vec<&'static str>;
}

impl LinkBounds {
    fn given(self) -> [(bool, ArcKind, &'static str); 4] {
        [
            (self.no_overlap, ArcKind::Clearance, "--no-overlap"),
            (self.clearance.is_some(), ArcKind::Clearance, "--clearance"),
            (self.playable, ArcKind::Clearance, "--playable"),
            (self.playable, ArcKind::Upper, "--playable"),
        ]
    }
}

fn of_kind(
    options: impl IntoIterator<Item = (bool, ArcKind, &'static str)>,
    kind: Option<ArcKind>,
) -> Vec<&'static str> {
    let options = options.into_iter();
    let those = options.filter(|(given, of, _)| *given && kind.is_none_or(|kind| kind == *of));
    let mut names: Vec<&'static str> = those.map(|(.., name)| name).collect();
    names.dedup();
    names
}

impl Given for CycleBounds {
    fn given(&self, kind: Option<ArcKind>) -> Vec<&'static str> {
        let own = [(self.max_angle.is_some(), ArcKind::Upper, "--max-angle")];
        of_kind(own.into_iter().chain(self.links.given()), kind)
    }
}

impl Given for QuarterBounds {
    fn given(&self, kind: Option<ArcKind>) -> Vec<&'static str> {
        let own = [
            (self.max_angle.is_some(), ArcKind::Upper, "--max-angle"),
            (self.min_angle.is_some(), ArcKind::Lower, "--min-angle"),
            (self.sector, ArcKind::Diagonal, "--sector"),
        ];
        of_kind(own.into_iter().chain(self.links.given()), kind)
    }
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

    /// `true` if the gait must be playable on the robot.
    pub(crate) fn playable(&self) -> bool {
        self.links.playable
    }

    /// The bounds for a swimmer.
    pub(crate) fn of(self, file: &SwimmerFile) -> Bounds {
        BoundsRequest::from(self).of(file)
    }
}

impl QuarterBounds {
    /// `true` if the gait must be playable on the robot.
    pub(crate) fn playable(&self) -> bool {
        self.links.playable
    }

    /// The bounds for a swimmer.
    pub(crate) fn of(self, file: &SwimmerFile) -> Bounds {
        BoundsRequest::from(self).of(file)
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
