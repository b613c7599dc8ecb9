//! Bounds on the shapes of a gait, and those of the robot that shall play it.

use serde::Deserialize;
use swimmer_files::{ArcKind, Bounds, SwimmerFile};

/// Bounds on shapes, with the names of the command's options.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoundsRequest {
    /// Largest |φᵢ| \[rad\].
    pub max_angle: Option<f64>,
    /// Least angle of the leading joint of each quarter \[rad\].
    pub min_angle: Option<f64>,
    /// Each quarter stays in its sector, φ₂ ≥ |φ₁|.
    pub sector: bool,
    /// Links may not cross.
    pub no_overlap: bool,
    /// Least distance of the side links' centre lines \[m\]; above zero it implies `no_overlap`.
    pub clearance: f64,
    /// Also the bounds of the robot of the swimmer file, [`playable`].
    pub playable: bool,
}

impl BoundsRequest {
    /// The command's options by which a gait gets arcs of this kind; all options for `None`. Messages name them.
    pub(crate) fn options(&self, kind: Option<ArcKind>) -> Vec<&'static str> {
        let all = [
            (self.max_angle.is_some(), ArcKind::Upper, "--max-angle"),
            (self.min_angle.is_some(), ArcKind::Lower, "--min-angle"),
            (self.sector, ArcKind::Diagonal, "--sector"),
            (self.no_overlap, ArcKind::Clearance, "--no-overlap"),
            (self.clearance > 0.0, ArcKind::Clearance, "--clearance"),
            (self.playable, ArcKind::Clearance, "--playable"),
            (self.playable, ArcKind::Upper, "--playable"),
        ];
        let given = all
            .into_iter()
            .filter(|(given, of, _)| *given && kind.is_none_or(|kind| kind == *of));
        let mut names: Vec<&'static str> = given.map(|(.., name)| name).collect();
        names.dedup();
        names
    }

    /// The bounds for a swimmer.
    pub fn of(&self, file: &SwimmerFile) -> Bounds {
        let bounds = Bounds {
            max_angle: self.max_angle,
            min_angle: self.min_angle,
            sector: self.sector,
            no_overlap: self.no_overlap || self.clearance > 0.0,
            clearance: self.clearance,
        };
        if self.playable {
            playable(bounds, file)
        } else {
            bounds
        }
    }
}

/// Clearance of a search over the margin that the robot keeps, since the table and the servos' dead band cut corners.
const CLEARANCE_FACTOR: f64 = 1.05;

/// Tightens bounds to the largest angle of the file's servos and the clearance that the robot keeps.
pub fn playable(bounds: Bounds, file: &SwimmerFile) -> Bounds {
    let largest = file.servo.unwrap_or_default().max_angle;
    let links = &file.swimmer.links;
    let margin = f64::from(gait_player::clearance::MARGIN_TURN) * links.front.max(links.back);
    Bounds {
        max_angle: Some(bounds.max_angle.map_or(largest, |given| given.min(largest))),
        no_overlap: true,
        clearance: bounds.clearance.max(CLEARANCE_FACTOR * margin),
        ..bounds
    }
}
